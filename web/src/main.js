// The page: what the controls do. All words from the data are set as text, never as HTML.

import { answer } from "./answer.js";
import { Ball } from "./ball.js";
import { themeOf } from "./colours.js";
import { factsOf } from "./card.js";
import { distance, isThin, nearest } from "./cone.js";
import { pageData } from "./data.js";
import { deepest } from "./map.js";
import { Names, forceArrows, motionArrows, openMarks } from "./overlay.js";
import { keepPlace } from "./place.js";
import { reachOf } from "./pose.js";
import { Stage } from "./stage.js";
import { angleBetween, unit } from "./vector.js";
import { basis, degrees, direction, force, marginWords, movingWords, number, plainly } from "./words.js";

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
const NAMED = 14; // up to so many parts bear their names from the start
const QUIET = 1200; // forces at more points are not shown from the start

const id = (name) => document.getElementById(name);

class Page {
  constructor(page) {
    this.page = page;
    this.down = page.given.down;
    this.long = 0.42 * page.radius;
    this.amount = 0;
    this.apart = 0;
    try {
      this.stage = new Stage(id("picture"), page);
    } catch (error) {
      id("no-picture").hidden = false;
      id("no-picture").textContent = `No picture: ${error.message}`;
    }
    this.ball = new Ball(id("ball"), page, (u, how, step) => this.pull(u, how, step));
    this.names = this.stage && new Names(id("names"), this.stage);
    this.controls();
    this.tables();
    this.theme();
    this.turn(this.down);
    if (this.stage) {
      this.stage.drawn = () => this.names.place();
      this.stage.render();
    }
    this.firstPicture = performance.now();
    if (location.protocol === "http:") keepPlace(this);
  }

  // gravity ---------------------------------------------------------------------------

  /** Gravity as the ball's arrow asks: drawn in by a region too thin to be hit by hand. */
  pull(wanted, how, step = 0) {
    const { region, planar } = this.page;
    let u = unit(wanted);
    if (region && region.dimension && isThin(region, planar)) {
      const reach = how === "key" ? step / 2 : SNAP;
      if (distance(region, u) < reach) u = nearest(region, u);
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
    // as far as the moving parts are large: more would say nothing
    const sizes = (this.found.moving || []).map((k) => this.page.parts.radius[k]);
    sizes.sort((a, b) => a - b);
    const reach = 1.1 * (sizes[sizes.length >> 1] || 0);
    const amount = motion ? this.amount * reachOf(motion, this.page.parts.radius, reach) : 0;
    parts.pose(motion, amount, this.apart);
    this.arrows();
    this.names.place();
    this.stage.draw();
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
      const share = found.forces.points.length > 300 ? 0.3 : 0.5;
      const size = share * this.page.radius * Number(id("force-size").value);
      const { straight, most } = forceArrows(stage, found.forces, size);
      stage.forces.set({ straight });
      label = `contact forces ${found.forceWords || `at points up to ${force(most)}`}`;
    } else stage.forces.set({});
    id("force-label").textContent = label;
    stage.loads.set(this.loads());
    stage.open.set(id("show-open").checked ? openMarks(stage) : {});
  }

  loads() {
    const { loads } = this.page;
    const most = loads.reduce((m, load) => Math.max(m, Math.hypot(...load.force)), 0);
    const straight = loads
      .filter((load) => Math.hypot(...load.force) > 0)
      .map((load) => ({
        at: load.point || this.stage.parts.centre(load.part),
        along: load.force,
        size: (this.long * Math.hypot(...load.force)) / most,
        wide: this.long,
      }));
    return { straight };
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
    const figure = found.instability ?? null;
    id("figure").title =
      found.verdict === "undecided" ? "of the frictionless contacts that are modelled" : "";
    id("figure").textContent =
      figure !== null
        ? `κ ${number(figure)}`
        : found.z === undefined || found.z === null
          ? ""
          : `z ${number(found.z)}`;
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
    const on = (name, type, action) => id(name).addEventListener(type, action);
    on("go-given", "click", () => this.turn(page.given.down, { exactly: true, follow: true }));
    on("go-recommended", "click", () => this.turn(page.recommended.down, { follow: true }));
    id("go-recommended").disabled = !page.recommended;
    const held = page.recommended && ["stable", "settles", "potentially-stable"].includes(page.recommended.verdict);
    if (page.recommended && !held) id("go-recommended").textContent = "Nearest to stable";
    on("go-nearest", "click", () =>
      this.turn(nearest(page.region, this.down), { follow: true }),
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
    id("stable-key").hidden = !page.region || page.region.kind === "none";
    on("motion", "input", () => this.slide("amount", "motion"));
    on("explode", "input", () => this.slide("apart", "explode", 1.6));
    on("section-axis", "change", () => this.section());
    on("section", "input", () => this.section());
    on("see-through", "input", () => {
      this.stage.parts.seeThrough(Number(id("see-through").value));
      this.stage.draw();
    });
    on("force-size", "input", () => this.repose());
    on("show-forces", "change", () => this.repose());
    on("show-motion", "change", () => this.repose());
    on("show-contacts", "change", () => {
      this.stage.parts.patches.visible = id("show-contacts").checked;
      this.stage.draw();
    });
    on("show-open", "change", () => this.repose());
    const pairs = page.open.parts.length / 2;
    id("open-row").hidden = !pairs;
    id("open-label").textContent = `${pairs} open pair${pairs > 1 ? "s" : ""}`;
    on("show-names", "change", () => this.label());
    on("play", "click", () => this.play());
    on("home", "click", () => this.stage.home());
    on("theme", "click", () => this.nextTheme());
    on("hide", "click", () => this.hide());
    on("isolate", "click", () => this.isolate());
    on("show-all", "click", () => this.showAll());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.theme());
    if (!this.stage) {
      for (const one of document.querySelectorAll(".tools input, .tools select, .tools button")) one.disabled = true;
      return;
    }
    const few = page.parts.names.length <= NAMED;
    id("show-names").checked = few;
    const points = page.given.forces ? page.given.forces.points.length / 3 : 0;
    id("show-forces").checked = points <= QUIET;
    id("show-contacts").checked = page.patches.start.length - 1 <= 40;
    this.stage.parts.patches.visible = id("show-contacts").checked;
    this.label();
    this.picking();
  }

  slide(key, name, most = 1) {
    this[key] = most * Number(id(name).value);
    this.repose();
  }

  label() {
    const all = this.page.parts.names.map((_, k) => k);
    this.names.show(id("show-names").checked ? all.slice(0, 400) : []);
  }

  /** Cut away one side of a plane: that of +x, −x and so on. */
  section() {
    const side = id("section-axis").value;
    const axis = "xyz".indexOf(side.charAt(side.length - 1) || " ");
    const sign = side.startsWith("-") ? -1 : 1;
    id("section").disabled = axis < 0;
    const normal = axis < 0 ? null : [0, 1, 2].map((k) => (k === axis ? sign : 0));
    this.stage.parts.section(normal, sign * this.page.radius * Number(id("section").value));
    this.stage.draw();
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

  picking() {
    const canvas = id("picture");
    let from = null;
    canvas.addEventListener("pointerdown", (e) => (from = [e.clientX, e.clientY]));
    canvas.addEventListener("pointerup", (e) => {
      const still = from && Math.hypot(e.clientX - from[0], e.clientY - from[1]) < 4;
      from = null;
      if (!still || e.button) return;
      const box = canvas.getBoundingClientRect();
      this.select(this.stage.pick(e.clientX - box.left, e.clientY - box.top));
    });
    canvas.addEventListener("keydown", (e) => {
      const turns = {
        ArrowLeft: [-0.1, 0],
        ArrowRight: [0.1, 0],
        ArrowUp: [0, -0.1],
        ArrowDown: [0, 0.1],
        "+": [0, 0, 0.9],
        "-": [0, 0, 1.1],
      };
      if (e.ctrlKey || e.metaKey || e.altKey) return;
      const { count } = this.stage.parts;
      if (turns[e.key]) this.stage.orbit(...turns[e.key]);
      else if (e.key === "n" || e.key === "p") {
        const step = e.key === "n" ? 1 : count - 1;
        this.select(this.selected < 0 ? 0 : (this.selected + step) % count);
      } else if (e.key === "h") this.hide();
      else if (e.key === "i") this.isolate();
      else if (e.key === "a") this.showAll();
      else if (e.key === "Escape") this.select(-1);
      else return;
      e.preventDefault();
    });
  }

  selected = -1;

  select(part) {
    this.selected = part;
    if (this.stage) {
      this.stage.parts.selected = part;
      this.stage.parts.states();
      this.stage.draw();
    }
    for (const name of ["hide", "isolate"]) id(name).disabled = part < 0;
    id("part").hidden = part < 0;
    id("no-part").hidden = part >= 0;
    if (part >= 0) this.showPart(part);
  }

  showPart(k) {
    id("part-name").textContent = this.page.parts.names[k];
    id("part-facts").replaceChildren(
      ...factsOf(this.page, this.found, k).flatMap(([term, value]) => {
        const [dt, dd] = [document.createElement("dt"), document.createElement("dd")];
        dt.textContent = term;
        dd.textContent = value;
        return [dt, dd];
      }),
    );
  }

  hide() {
    if (this.selected < 0) return;
    this.stage.parts.visible[this.selected] = 0;
    this.select(-1);
    this.repose();
  }

  isolate() {
    if (this.selected < 0) return;
    this.stage.parts.visible.fill(0);
    this.stage.parts.visible[this.selected] = 1;
    this.stage.parts.states();
    this.repose();
  }

  showAll() {
    this.stage.parts.visible.fill(1);
    this.stage.parts.states();
    this.repose();
  }

  tables() {
    document.body.addEventListener("click", (e) => {
      const button = e.target.closest && e.target.closest("button[data-part]");
      if (!button) return;
      this.select(Number(button.dataset.part));
      id("picture").scrollIntoView({ block: "nearest" });
    });
  }

  // light and dark --------------------------------------------------------------------

  nextTheme() {
    const root = document.documentElement;
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const now = root.dataset.theme || (dark ? "dark" : "light");
    root.dataset.theme = now === "dark" ? "light" : "dark";
    this.theme();
  }

  theme() {
    const style = themeOf(document.documentElement);
    this.ball.draw();
    if (!this.stage) return;
    this.stage.parts.theme(style);
    this.stage.motion.theme(style("unstable"), style("surface"));
    this.stage.forces.theme(style("force"), style("surface"));
    this.stage.loads.theme(style("ink"), style("surface"));
    this.stage.open.theme(style("open"), style("ink"));
    this.stage.draw();
  }

  // for tests and for the curious -----------------------------------------------------

  /** Pictures a second over some pictures, each drawn in full from another side. */
  speed(pictures = 20) {
    const { renderer } = this.stage;
    const pixel = new Uint8Array(4);
    const gl = renderer.getContext();
    const finish = () => gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
    finish();
    const started = performance.now();
    for (let k = 0; k < pictures; k += 1) {
      this.stage.orbit(0.05, 0);
      this.stage.render();
      finish();
    }
    return (1000 * pictures) / (performance.now() - started);
  }

  /** Verdict and words for a direction, as the page shows them. */
  ask(direction_) {
    this.turn(unit(direction_));
    return { verdict: id("verdict").textContent, margin: this.found.margin, moving: this.found.moving };
  }
}

const page = pageData(id("data").textContent);
if (page) {
  id("show").hidden = false;
  window.kilter = new Page(page);
}
