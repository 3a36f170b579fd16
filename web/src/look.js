// The common base of all pages: picture, controls, name labels, selection, light and dark.

import { factsOf } from "./card.js";
import { themeOf } from "./colours.js";
import { Names } from "./names.js";
import { openMarks } from "./overlay.js";
import { Stage } from "./stage.js";

const NAMED = 14; // names are shown at first for up to this many parts
const PATCHES = 40; // contacts are shown at first for up to this many patches

export const id = (name) => document.getElementById(name);
export const on = (name, type, action) => id(name).addEventListener(type, action);

/** A page; its `repose` places parts, arrows and names for the current controls. */
export class Look {
  constructor(page) {
    this.page = page;
    this.apart = 0;
    this.long = 0.42 * page.radius;
    try {
      this.stage = new Stage(id("picture"), page);
    } catch (error) {
      id("no-picture").hidden = false;
      id("no-picture").textContent = `No picture can be drawn: ${error.message}`;
    }
    this.names = this.stage && new Names(id("names"), this.stage);
  }

  /** Draw for the first time, when the set-up is complete. */
  begin() {
    this.theme();
    if (this.stage) {
      this.stage.drawn = () => this.names.place();
      this.stage.render();
    }
    this.firstPicture = performance.now();
  }

  // controls --------------------------------------------------------------------------

  /** Connect the controls that all pages have. */
  look() {
    const { page } = this;
    on("explode", "input", () => this.slide("apart", "explode", 1.6));
    on("section-axis", "change", () => this.section());
    on("section", "input", () => this.section());
    on("see-through", "input", () => {
      this.stage.parts.seeThrough(Number(id("see-through").value));
      this.stage.draw();
    });
    on("force-size", "input", () => this.repose());
    for (const name of ["show-forces", "force-mode", "show-thrust"]) on(name, "change", () => this.repose());
    on("show-motion", "change", () => this.repose());
    on("show-contacts", "change", () => {
      this.stage.parts.patches.visible = id("show-contacts").checked;
      this.repose();
    });
    on("show-open", "change", () => this.repose());
    const pairs = page.open.parts.length / 2;
    id("open-row").hidden = !pairs;
    id("open-label").textContent = `${pairs} open pair${pairs > 1 ? "s" : ""}`;
    id("load-key").hidden = !page.loads.length;
    on("show-names", "change", () => this.label());
    on("home", "click", () => this.stage.home());
    on("theme", "click", () => this.nextTheme());
    on("hide", "click", () => this.hide());
    on("isolate", "click", () => this.isolate());
    on("show-all", "click", () => this.showAll());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.theme());
    document.body.addEventListener("click", (e) => {
      const button = e.target.closest && e.target.closest("button[data-part]");
      if (!button) return;
      this.select(Number(button.dataset.part));
      id("picture").scrollIntoView({ block: "nearest" });
    });
    if (!this.stage) {
      for (const control of document.querySelectorAll(".tools input, .tools select, .tools button")) control.disabled = true;
      return;
    }
    id("show-names").checked = page.parts.names.length <= NAMED;
    const { start, kinds } = page.patches;
    // the contact points of studs would hide the bricks
    id("show-contacts").checked = start.length - 1 <= PATCHES && kinds.join() !== "bond";
    this.stage.parts.patches.visible = id("show-contacts").checked;
    this.label();
    this.picking();
  }

  /** Take over the value of a slider, scaled to `most`. */
  slide(key, name, most = 1) {
    this[key] = most * Number(id(name).value);
    if (key === "apart" && this.stage) this.stage.spread(this.spreading());
    this.repose();
  }

  /** Half lengths of the box around the parts, pulled apart by the explode slider. */
  spreading() {
    return this.page.extent.map((e) => (1 + this.apart) * e);
  }

  label() {
    const all = this.page.parts.names.map((_, k) => k);
    this.names.show(id("show-names").checked ? all.slice(0, 400) : []);
  }

  /** Draw loads and open pairs at the current positions of the parts. */
  marks() {
    const { stage } = this;
    const { loads } = this.page;
    const most = loads.reduce((m, load) => Math.max(m, Math.hypot(...load.force)), 0);
    const straight = loads
      .filter((load) => Math.hypot(...load.force) > 0)
      .map((load) => ({ ...load, at: stage.parts.placeOf(load.part, load.point) }))
      .filter((load) => stage.parts.seen(load.part, load.at))
      .map((load) => ({
        at: load.at,
        along: load.force,
        size: (this.long * Math.hypot(...load.force)) / most,
        wide: this.long,
      }));
    stage.loads.set({ straight });
    stage.open.set(id("show-open").checked ? openMarks(stage) : {});
  }

  /** Cut away one side of a plane: that of +x, −x and so on. */
  section() {
    const side = id("section-axis").value;
    const axis = "xyz".indexOf(side.charAt(side.length - 1) || " ");
    const sign = side.startsWith("-") ? -1 : 1;
    id("section").disabled = axis < 0;
    const normal = axis < 0 ? null : [0, 1, 2].map((k) => (k === axis ? sign : 0));
    this.stage.parts.section(normal, sign * this.page.radius * Number(id("section").value));
    this.repose();
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
      else if (!this.key(e.key)) return;
      e.preventDefault();
    });
  }

  /** Handle a further key in the picture; returns whether the page uses it. */
  key() {
    return false;
  }

  // one part --------------------------------------------------------------------------

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
    listFacts(id("part-facts"), factsOf(this.page, this.found, k));
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

  // light and dark --------------------------------------------------------------------

  nextTheme() {
    const root = document.documentElement;
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const now = root.dataset.theme || (dark ? "dark" : "light");
    root.dataset.theme = now === "dark" ? "light" : "dark";
    this.theme();
  }

  theme() {
    if (this.stage) this.stage.theme(themeOf(document.documentElement));
  }

  // measurement -----------------------------------------------------------------------

  /** Pictures per second over `pictures` pictures, each drawn in full from another side. */
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
}

/** Fill a description list with terms and values, set as text. */
export function listFacts(list, facts) {
  list.replaceChildren(
    ...facts.flatMap(([term, value]) => {
      const [dt, dd] = [document.createElement("dt"), document.createElement("dd")];
      dt.textContent = term;
      dd.textContent = value;
      return [dt, dd];
    }),
  );
}
