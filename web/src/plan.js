// The page of a plan: its steps as a film and as a strip of pictures, with the facts of each step.

import { id, listFacts, on } from "./dom.js";
import { overhang } from "./fall.js";
import { Look } from "./look.js";
import { forceArrows, motionArrows } from "./overlay.js";
import { turn } from "./pose.js";
import { pictureTime, sceneAt, stepAt } from "./steps.js";
import { Strip } from "./strip.js";
import { force } from "./words.js";

const PACE = 1250; // duration of a step at normal speed [ms]
const REACH = 1.9; // a part starts at most this far from its seat [radius of the picture]
const SIGNS = { found: "✓", impossible: "✕", fails: "✕", "none-found": "?" };
const TONES = { found: "stable", impossible: "unstable", fails: "unstable" };

export class Plan extends Look {
  constructor(page) {
    super(page);
    const { plan } = page;
    this.count = plan.steps.length;
    this.time = 0;
    this.atFirst = true; // the film is at its opening picture, and plays from the beginning
    this.reach = REACH * page.radius;
    this.outside = this.overhang();
    if (this.stage) this.stage.spread(this.spreading());
    this.found = { moving: [], motion: null, forces: null };
    this.look();
    this.tell();
    this.controls();
    this.theme();
    if (this.count) this.go(this.pictureAt(0));
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

  /** How much farther the incoming parts of all pictures reach out of the view's box, per axis. */
  overhang() {
    const { plan, parts, extent } = this.page;
    const each = plan.steps.map((step, k) => {
      const { place } = sceneAt(plan, this.pictureAt(k), this.reach).on;
      return overhang(step.parts, parts, extent, step.parts.map(() => place));
    });
    return [0, 1, 2].map((i) => Math.max(0, ...each.map((beyond) => beyond[i])));
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
    this.go(this.pictureAt(k), true);
  }

  pictureAt(k) {
    const { plan, parts } = this.page;
    const radius = Math.max(...plan.steps[k].parts.map((part) => parts.radius[part]));
    return pictureTime(plan, k, radius, this.reach);
  }

  /** Go one step back (-1) or forward (1), from picture to picture. */
  jump(step) {
    const [k] = stepAt(this.page.plan.steps, this.time);
    if (step > 0 && this.time < this.pictureAt(k) - 1e-6) this.show(k);
    else if (step > 0 && k + 1 === this.count) this.go(this.count, true);
    else if (step < 0 && this.time > this.pictureAt(k) + 1e-6) this.show(k);
    else this.show(Math.max(0, k + step));
  }

  /** Show the film at a time [steps]. */
  go(time, stop = false) {
    if (stop && this.playing) this.pause();
    if (stop) this.atFirst = false;
    this.time = Math.max(0, Math.min(this.count, time));
    if (this.count) {
      id("scrub").value = String(this.time);
      const [k] = stepAt(this.page.plan.steps, this.time);
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
      if (still && !over) time = this.pictureAt(Math.floor(time));
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
    this.place(this.time);
    this.arrows(this.time);
    this.marks();
    this.names.place();
    this.stage.draw();
  }

  place(time) {
    const { parts } = this.stage;
    const { plan } = this.page;
    const shifts = this.spread();
    const turns = [];
    parts.moving.fill(0);
    parts.gripped.fill(0);
    parts.present.fill(1);
    for (const { part } of plan.falls) parts.moving[part] = 1;
    if (this.count) {
      const now = sceneAt(plan, time, this.reach);
      const { direction } = plan.steps[now.step];
      for (let k = 0; k < parts.count; k += 1) parts.present[k] = now.present.has(k) ? 1 : 0;
      for (const part of now.gripped) parts.gripped[part] = 1;
      for (const part of now.moving) parts.moving[part] = 1;
      if (now.on) {
        for (const part of plan.steps[now.step].parts) {
          shifts[part] = now.on.place.map((c, i) => c + shifts[part][i]);
          if (now.turn) turns[part] = turn(...direction.map((c) => c * now.turn));
        }
      }
      this.now = now;
    }
    parts.carry(shifts, turns);
    parts.states();
  }

  /** Displacement of each part by the explode slider: back along its path. */
  spread() {
    const { explode } = this.page.plan;
    const apart = this.apart;
    return Array.from({ length: this.page.parts.radius.length }, (_, k) =>
      [0, 1, 2].map((i) => apart * explode[3 * k + i]),
    );
  }

  arrows(time, small = false) {
    const { stage, page } = this;
    const { plan } = page;
    const [k, done] = this.count ? stepAt(plan.steps, time) : [0, 1];
    const step = plan.steps[k];
    const under = this.count && done < 1;
    stage.motion.set(this.motions(under && step, small));
    const long = 0.5 * page.radius * Number(id("force-size").value);
    let [label, most] = ["support forces", 0];
    const forces = !small && under && id("show-forces").checked && step.support;
    if (!small) id("size-row").hidden = !forces;
    if (forces && forces.points.length) {
      const drawn = forceArrows(stage, forces, long);
      most = drawn.most;
      stage.forces.set({ straight: drawn.straight });
      label = `support forces, up to ${force(most)}`;
    } else stage.forces.set({});
    stage.hands.set(forces ? this.handArrows(step, long, most) : {});
    id("force-label").textContent = label;
    this.drawLines();
  }

  /** Arrows of the part that is being inserted, or of the parts that would fall. */
  motions(step, small) {
    const { stage, page } = this;
    const falls = step ? step.hands.filter((hand) => hand.motion).slice(0, 1) : page.plan.falls;
    if (!small && id("show-motion").checked && falls.length) {
      const lists = falls.map((fall) => motionArrows(stage, fall.motion, fall.moves, 0.6 * this.long));
      return {
        straight: lists.flatMap((list) => list.straight),
        round: lists.flatMap((list) => list.round),
      };
    }
    const { on } = this.now || {};
    if (!step || !on || !(on.ahead > 0)) return {};
    const straight = step.parts.map((part) => {
      const wide = Math.max(1.3 * page.parts.radius[part], 0.3 * this.long);
      const size = Math.min(on.ahead, 2.6 * wide);
      return { at: stage.parts.centre(part), along: on.heading, size, wide: Math.min(wide, 2.5 * size) };
    });
    return { straight };
  }

  /** Arrows of the hand forces, to the scale of the contact forces, at most twice the longest. */
  handArrows(step, long, most) {
    const straight = step.hands
      .filter((hand) => hand.force && Math.hypot(...hand.force) > 0)
      .map((hand) => {
        const share = most ? Math.hypot(...hand.force) / most : 1;
        const size = long * Math.max(0.12, Math.min(2, share));
        return { at: this.stage.parts.centre(hand.part), along: hand.force, size, wide: Math.max(0.8 * size, 0.3 * long) };
      });
    return { straight };
  }

  /** Draw a line from each displaced part to its seat. */
  drawLines() {
    const { stage, page } = this;
    const points = [];
    if (this.apart > 0) {
      for (let k = 0; k < stage.parts.count; k += 1) {
        const at = page.parts.center.subarray(3 * k, 3 * k + 3);
        const shift = [0, 1, 2].map((i) => this.apart * page.plan.explode[3 * k + i]);
        if (!stage.parts.shown(k) || !Math.hypot(...shift)) continue;
        points.push(...at, ...shift.map((c, i) => c + at[i]));
      }
    }
    stage.drawLines(points);
  }

  /** Paint the small picture of step k; the large picture is restored afterwards. */
  paint(k, canvas) {
    if (!this.stage) return;
    const [apart, time] = [this.apart, this.pictureAt(k)];
    const { stage } = this;
    const were = [stage.parts.patches, stage.parts.edges].map((object) => object.visible);
    const { selected } = stage.parts;
    this.apart = 0;
    stage.parts.selected = new Set();
    stage.parts.patches.visible = false;
    stage.parts.edges.visible = true;
    this.place(time);
    this.arrows(time, true);
    stage.loads.set({});
    stage.open.set({});
    stage.snap(canvas);
    this.apart = apart;
    stage.parts.selected = selected;
    [stage.parts.patches.visible, stage.parts.edges.visible] = were;
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
