// The page of a report: gravity, and what follows from it. Words from the data are set as text.

import { answer, nearestHeld } from "./answer.js";
import { Ball } from "./ball.js";
import { ramp, rampOf, themeOf } from "./colours.js";
import { distance, isThin } from "./cone.js";
import { Look, id, on } from "./look.js";
import { deepest } from "./map.js";
import { bondUse, forceArrows, motionArrows, thrustRods } from "./overlay.js";
import { keepPlace } from "./place.js";
import { reachOf } from "./pose.js";
import { clearAmount } from "./sweep.js";
import { angleBetween, unit } from "./vector.js";
import { basis, gapWords, degrees, direction, force, marginWords, movingWords, number, plainly, pullWords } from "./words.js";

const SIGNS = {
  stable: "✓",
  settles: "✓",
  "potentially-stable": "≈",
  unstable: "✕",
  undecided: "?",
  unknown: "?",
};
const TONES = {
  stable: "stable",
  settles: "stable",
  "potentially-stable": "stable",
  unstable: "unstable",
  undecided: "undecided",
};
const SNAP = (3 * Math.PI) / 180; // a thin region draws the arrow in from so near
const QUIET = 1200; // forces at more points are not shown from the start

export class Report extends Look {
  constructor(page) {
    super(page);
    this.down = page.given.down;
    this.amount = 0;
    this.ball = new Ball(id("ball"), page, (u, how, step) => this.pull(u, how, step));
    this.look();
    this.controls();
    this.turn(this.down);
    this.begin();
    if (location.protocol === "http:") keepPlace(this);
  }

  // gravity ---------------------------------------------------------------------------

  /** Gravity as the ball's arrow asks: drawn in by a region too thin to be hit by hand. */
  pull(wanted, how, step = 0) {
    const { region, planar } = this.page;
    let u = unit(wanted);
    if (region && region.dimension && isThin(region, planar)) {
      const reach = how === "key" ? step / 2 : SNAP;
      if (distance(region, u) < reach) u = nearestHeld(region, u);
    }
    for (const known of [this.page.given, this.page.recommended]) {
      if (known && angleBetween(known.down, u) < 1e-7) u = known.down;
    }
    this.turn(u, { follow: how === "key" });
  }

  /** Gravity along a direction: everything follows. */
  turn(u, { exactly = false, follow = false } = {}) {
    this.down = u;
    this.found = answer(this.page, u);
    this.ball.tone = TONES[this.found.verdict];
    this.ball.set(u, follow);
    if (this.stage) {
      this.stage.turnTo(u, exactly);
      this.stage.parts.moving.fill(0);
      for (const k of this.found.moving || []) this.stage.parts.moving[k] = 1;
      this.stage.parts.states();
    }
    this.repose();
    this.tell();
  }

  /** Parts, arrows and names as the sliders have them. */
  repose() {
    if (!this.stage) return;
    const { parts } = this.stage;
    const { motion } = this.found;
    parts.pose(motion, motion && this.amount ? this.amount * this.farthest() : 0, this.apart);
    // the brick to add has a place among parts at rest
    this.stage.ghost.group.visible = Boolean(this.added && !this.amount && !this.apart);
    this.arrows();
    this.names.place();
    this.stage.draw();
  }

  /** The brick to add in its place, or the one to take away picked; or neither any more. */
  showChange() {
    const { part, shape, at } = this.page.change;
    this.changed = !this.changed;
    id("show-change").setAttribute("aria-pressed", String(this.changed));
    if (part !== null) {
      this.select(this.changed ? part : -1);
    } else if (this.stage) {
      this.added = this.changed;
      this.stage.ghost.set(shape, at);
      this.repose();
    }
  }

  /** The amount of the motion at the end of its slider: before any part enters another. */
  farthest() {
    const { found, page } = this;
    if (found.farthest === undefined) {
      // as far as the moving parts are large: more would say nothing
      const sizes = (found.moving || []).map((k) => page.parts.radius[k]);
      sizes.sort((a, b) => a - b);
      const reach = reachOf(found.motion, page.parts.radius, 1.1 * (sizes[sizes.length >> 1] || 0));
      found.farthest = clearAmount(page, found.motion, reach);
    }
    return found.farthest;
  }

  arrows() {
    const { stage, found } = this;
    const moving = found.motion && id("show-motion").checked ? found.moving : [];
    // many arrows are drawn shorter
    const long = this.long * (moving.length > 20 ? 0.5 : 1);
    stage.motion.set(moving.length ? motionArrows(stage, found.motion, moving, long) : {});
    let label = found.forces ? "contact forces" : "contact forces: none to show here";
    const forces = found.forces && id("show-forces").checked;
    if (forces) {
      const size = this.forceLength() * Number(id("force-size").value);
      const each = id("force-mode").value === "point";
      const { straight, most, shown, all } = forceArrows(stage, found.forces, size, each);
      const rod = id("show-thrust").checked ? thrustRods(stage, all, 0.5 * this.long) : [];
      stage.forces.set({ straight, rod });
      this.shown = shown;
      this.useKey(all);
      label = `contact forces ${found.forceWords || `at points up to ${force(most)}`}`;
    } else {
      stage.forces.set({});
      this.shown = [];
      id("use-key").hidden = true;
    }
    id("force-label").textContent = label;
    this.paint();
    this.marks();
  }

  /** What the colour of forces says: the friction or the bond that they use. */
  useKey(all) {
    const [rubs, pulls] = ["use", "bond"].map((name) => all.some((one) => one[name] !== null));
    id("use-key").hidden = !rubs && !pulls;
    id("use-words").textContent = [...(rubs ? ["friction"] : []), ...(pulls ? ["bond"] : [])].join(" or ");
  }

  /** Parts in their own colours, or in that of the bond that each uses most. */
  paint() {
    const { stage, found, page } = this;
    if (found.bondUse === undefined) found.bondUse = bondUse(page, found.forces);
    const use = found.bondUse;
    id("colour-row").hidden = !use;
    const shown = use && id("colour-of").value === "bond" ? use : null;
    id("bond-key").hidden = !shown;
    if (shown === this.painted) return;
    this.painted = shown;
    const colour = page.parts.colour.slice();
    const table = rampOf(themeOf(document.body));
    (shown || []).forEach((share, k) => {
      if (!page.parts.grounded[k]) colour.set(ramp(share, table).map(Math.round), 3 * k);
    });
    stage.parts.paint(colour);
  }

  /** Of the longest arrow of a force: within a part or two, so that each is seen by itself. */
  forceLength() {
    const { radius, parts } = this.page;
    const largest = parts.radius.reduce((most, r, k) => (parts.grounded[k] ? most : Math.max(most, r)), 0);
    return Math.min(0.4 * radius, 1.8 * largest || radius);
  }

  /** Verdict, margin and moving parts in words. */
  tell() {
    const { page, found } = this;
    const banner = id("banner");
    banner.dataset.verdict = found.verdict;
    id("sign").textContent = SIGNS[found.verdict] || "?";
    id("verdict").textContent = page.words[found.verdict] || found.verdict;
    id("sentence").textContent = found.sentence
      ? plainly(found.sentence, page.words[found.verdict])
      : marginWords(page, found);
    const lines = [movingWords(page, found)];
    if (found.sentence) lines.unshift(marginWords(page, found));
    id("moving").textContent = lines.filter(Boolean).join("; ");
    id("basis").textContent = basis(page, found);
    id("down").textContent = direction(this.down);
    const away = angleBetween(this.down, page.given.down);
    id("turned").textContent = away ? `turned by ${degrees(away)}` : "as given";
    const [sign, value] = (found.instability ?? null) === null ? ["z", found.z] : ["κ", found.instability];
    id("level").textContent = found.level ? `level: ${found.level}` : "";
    id("figure").title =
      found.verdict === "undecided" ? "of the frictionless contacts that are modelled" : "";
    const said = TONES[found.verdict] !== "stable" && (value ?? null) !== null;
    id("figure").textContent = said ? `${sign} ${number(value)}` : "";
    const at = (name) => page[name] && angleBetween(page[name].down, this.down) < 1e-9;
    id("go-given").setAttribute("aria-pressed", String(Boolean(at("given"))));
    id("go-recommended").setAttribute("aria-pressed", String(Boolean(at("recommended"))));
    const label = `gravity along ${direction(this.down, 2)}: ${page.words[found.verdict]}`;
    this.ball.canvas.setAttribute("aria-valuetext", label);
    this.ball.canvas.setAttribute("aria-valuenow", String(Math.round((away * 180) / Math.PI)));
    id("motion").disabled = !found.motion;
    id("play").disabled = !found.motion;
    id("motion-label").textContent = found.motion ? "motion" : "motion: none";
    if (this.selected >= 0) this.showPart(this.selected);
  }

  // controls --------------------------------------------------------------------------

  controls() {
    const { page } = this;
    on("go-given", "click", () => this.turn(page.given.down, { exactly: true, follow: true }));
    on("go-recommended", "click", () => this.turn(page.recommended.down, { follow: true }));
    id("go-recommended").disabled = !page.recommended;
    id("go-recommended").hidden = page.coincide;
    if (page.coincide) id("go-given").textContent = "Given, and recommended";
    const held = page.recommended && ["stable", "settles", "potentially-stable"].includes(page.recommended.verdict);
    if (page.recommended && !held) id("go-recommended").textContent = "Nearest to stable";
    on("go-nearest", "click", () =>
      this.turn(nearestHeld(page.region, this.down), { follow: true }),
    );
    id("go-nearest").disabled = !page.region || !page.region.dimension;
    const { region } = page;
    const known = region && region.outside === "unstable";
    id("no-map").hidden = Boolean(page.map) || !region || !region.equations.length + region.facets.length;
    id("no-map").dataset.known = String(known);
    id("no-map-words").textContent = known
      ? "unstable; how much is not mapped at this size"
      : "undecided: further forces may hold it";
    id("ramp-words").textContent = known
      ? "unstable, a little to much"
      : "unstable by its frictionless contacts alone, a little to much";
    id("ramp").hidden = !page.map || deepest(page.map) === 0;
    this.keys();
    on("motion", "input", () => this.slide("amount", "motion"));
    on("play", "click", () => this.play());
    if (page.change) on("show-change", "click", () => this.showChange());
    on("colour-of", "change", () => this.repose());
    id("bond-pull").textContent = pullWords(page.given.forces && page.given.forces.pull);
    const points = page.given.forces ? page.given.forces.points.length / 3 : 0;
    if (this.stage) id("show-forces").checked = points <= QUIET;
  }

  /** What the ball asks, and what its colours say. */
  keys() {
    const { region } = this.page;
    id("question").hidden = !region;
    id("stable-key").hidden = !region || region.kind === "none";
    id("gap-key").hidden = !region || !region.inner;
    if (!region) return;
    id("question").textContent = region.words.question;
    id("stable-words").textContent = region.words.inside;
    if (region.inner) id("gap-words").textContent = gapWords(region.gap_deg);
  }

  /** The motion once forth and back, or stopped. */
  play() {
    if (this.playing) {
      this.playing = null;
      id("play").textContent = "Play";
      return;
    }
    const started = performance.now();
    this.playing = started;
    id("play").textContent = "Stop";
    const step = (now) => {
      if (this.playing !== started) return;
      const t = (now - started) / 2600;
      id("motion").value = String(0.5 - 0.5 * Math.cos(2 * Math.PI * Math.min(t, 1)));
      this.slide("amount", "motion");
      if (t < 1 && this.found.motion) requestAnimationFrame(step);
      else this.play();
    };
    requestAnimationFrame(step);
  }

  theme() {
    super.theme();
    this.ball.draw();
  }

  /** Verdict and words for a direction, as the page shows them. */
  ask(direction_) {
    this.turn(unit(direction_));
    return { verdict: id("verdict").textContent, margin: this.found.margin, moving: this.found.moving };
  }
}
