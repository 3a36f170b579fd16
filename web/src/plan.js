// The page of a plan: its steps as a film and as a strip of pictures, with the facts of each step.

import { id, listFacts, on } from "./dom.js";
import { Film } from "./film.js";
import { Look } from "./look.js";
import { Strip } from "./strip.js";
import { force } from "./words.js";

const PACE = 1250; // duration of a step at normal speed [ms]
const SIGNS = { found: "✓", impossible: "✕", fails: "✕", "none-found": "?" };
const TONES = { found: "stable", impossible: "unstable", fails: "unstable" };

export class Plan extends Look {
  constructor(page) {
    super(page);
    const { plan } = page;
    this.film = new Film(this, plan);
    this.count = this.film.count;
    this.time = 0;
    this.atFirst = true; // the film is at its opening picture, and plays from the beginning
    this.outside = this.film.overhang();
    if (this.stage) this.stage.spread(this.spreading());
    this.found = { moving: [], motion: null, forces: null };
    this.look();
    this.tell();
    this.controls();
    this.theme();
    if (this.count) this.go(this.film.pictureAt(0));
    else this.go(0);
    this.begin();
    if (this.stage && this.count) this.strip.renew();
  }

  /** Write the verdict of the plan and its sentence. */
  tell() {
    const { plan } = this.page;
    id("banner").dataset.verdict = TONES[plan.verdict] || "undecided";
    id("sign").textContent = SIGNS[plan.verdict] || "?";
    id("verdict").textContent = plan.word;
    id("sentence").textContent = plan.sentence;
    id("moving").textContent = plan.more;
  }

  controls() {
    const { plan } = this.page;
    for (const name of ["force-mode", "thrust"]) id(`${name}-row`).hidden = true; // only for reports
    const falls = plan.falls.length || plan.steps.some((step) => step.hands.some((hand) => hand.motion));
    id("motion-check").hidden = !falls;
    id("motion-key-words").textContent = this.count ? "insertion, or motion without the hand" : "motion of the falling parts";
    id("force-key-words").textContent = "support force";
    id("show-forces").parentElement.hidden = !this.count;
    for (const name of ["player", "step-card"]) id(name).hidden = !this.count;
    if (!this.count) {
      id("motion-word").textContent = "motion of the falling parts";
      return;
    }
    id("motion-word").textContent = "motion without the hand";
    id("show-motion").checked = false;
    id("scrub").max = String(this.count);
    on("scrub", "input", () => this.go(Number(id("scrub").value), true));
    on("play", "click", () => this.play());
    on("back", "click", () => this.jump(-1));
    on("forward", "click", () => this.jump(1));
    on("pace", "change", () => this.playing && this.start());
    const paint = (k, canvas) => this.paint(k, canvas);
    this.strip = new Strip(id("strip"), this.page, (k) => this.show(k), paint);
    document.body.addEventListener("click", (e) => {
      const target = e.target.closest && e.target.closest("[data-step]");
      if (target) this.show(Number(target.dataset.step));
    });
    this.nodes = [...document.querySelectorAll("#graph [data-step]")];
    if (plan.steps.length > 60) id("pace").value = "2";
  }

  spreading() {
    const { explode } = this.page.plan;
    const most = [0, 1, 2].map((i) => explode.reduce((m, c, k) => (k % 3 === i ? Math.max(m, Math.abs(c)) : m), 0));
    return this.page.extent.map((e, i) => e + Math.max(this.apart * most[i], this.outside[i]));
  }

  key(key) {
    if (!this.count) return false;
    if (key === " ") this.play();
    else if (key === ",") this.jump(-1);
    else if (key === ".") this.jump(1);
    else if (key === "Home") this.go(0, true);
    else if (key === "End") this.go(this.count, true);
    else return false;
    return true;
  }

  // time ------------------------------------------------------------------------------

  /** Go to the picture of step k, in which its part is close to its seat. */
  show(k) {
    this.go(this.film.pictureAt(k), true);
  }

  /** Go one step back (-1) or forward (1), from picture to picture. */
  jump(step) {
    this.go(this.film.jumped(this.time, step), true);
  }

  /** Show the film at a time [steps]. */
  go(time, stop = false) {
    if (stop && this.playing) this.pause();
    if (stop) this.atFirst = false;
    this.time = Math.max(0, Math.min(this.count, time));
    if (this.count) {
      id("scrub").value = String(this.time);
      const [k] = this.film.stepAt(this.time);
      if (k !== this.told) this.tellStep(k);
      const word = this.time >= this.count ? "assembled" : `step ${k + 1} of ${this.count}`;
      id("when").textContent = word;
      id("scrub").setAttribute("aria-valuetext", word);
    }
    this.repose();
  }

  play() {
    if (this.playing) this.pause();
    else this.start();
  }

  start() {
    if (this.time >= this.count || this.atFirst) this.time = 0;
    this.atFirst = false;
    const pace = PACE / Number(id("pace").value);
    const [began, from] = [performance.now(), this.time];
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.playing = began;
    id("play").textContent = "Pause";
    const step = (now) => {
      if (this.playing !== began) return;
      let time = Math.min(this.count, from + Math.max(0, now - began) / pace);
      const over = time >= this.count;
      // with reduced motion, one picture per step
      if (still && !over) time = this.film.pictureAt(Math.floor(time));
      this.go(time);
      if (over) this.pause();
      else requestAnimationFrame(step);
    };
    requestAnimationFrame(step);
  }

  pause() {
    this.playing = null;
    id("play").textContent = "Play";
  }

  // one step --------------------------------------------------------------------------

  tellStep(k) {
    const step = this.page.plan.steps[k];
    this.told = k;
    id("step-title").textContent = `Step ${k + 1} of ${this.count}`;
    id("step-name").textContent = step.parts.map((part) => this.page.parts.names[part]).join(", ");
    listFacts(id("step-facts"), step.facts);
    this.strip.mark(k);
    this.nodes.forEach((node) => node.classList.toggle("now", Number(node.dataset.step) === k));
    if (this.stage) this.stage.turnTo(step.down);
  }

  /** Place parts, states and arrows for the current time of the film. */
  repose() {
    if (!this.stage) return;
    this.film.place(this.time, this.apart);
    const most = this.film.arrows(this.time);
    id("force-label").textContent = most ? `support forces, up to ${force(most)}` : "support forces";
    this.drawLines();
    this.marks();
    this.names.place();
    this.stage.draw();
  }

  /** Draw a line from each displaced part to its seat. */
  drawLines() {
    const { stage, page } = this;
    const points = [];
    if (this.apart > 0) {
      const shifts = this.film.spread(this.apart);
      for (let k = 0; k < stage.parts.count; k += 1) {
        const at = page.parts.center.subarray(3 * k, 3 * k + 3);
        if (!stage.parts.shown(k) || !Math.hypot(...shifts[k])) continue;
        points.push(...at, ...shifts[k].map((c, i) => c + at[i]));
      }
    }
    stage.drawLines(points);
  }

  /** Paint the small picture of step k; the large picture is restored afterwards. */
  paint(k, canvas) {
    if (!this.stage) return;
    this.film.paint(k, canvas);
    this.repose();
  }

  showPart(k) {
    super.showPart(k);
    const { steps, base } = this.page.plan;
    const step = steps.findIndex((candidate) => candidate.parts.includes(k));
    const word = base.includes(k) ? "in place from the start" : step < 0 ? "not in the plan" : `step ${step + 1}`;
    [...id("part-facts").querySelectorAll("dt")]
      .filter((term) => term.textContent === "state")
      .forEach((term) => {
        term.textContent = "inserted";
        term.nextSibling.textContent = word;
      });
  }

  theme() {
    super.theme();
    if (this.stage && this.strip) this.strip.renew();
  }
}
