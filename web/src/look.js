// The common base of all pages: picture, controls, name labels, selection, light and dark.

import { factsOf, factsOfSeveral } from "./card.js";
import { copyText } from "./clipboard.js";
import { themeOf } from "./colours.js";
import { Compass, VIEWS, VIEW_KEYS } from "./compass.js";
import { id, listFacts, on } from "./dom.js";
import { Measure } from "./measure.js";
import { Names } from "./names.js";
import { openMarks, strapRods } from "./overlay.js";
import { Stage } from "./stage.js";
import { Tree } from "./tree.js";

const NAMED = 14; // names are shown at first for up to this many parts
const PATCHES = 40; // contacts are shown at first for up to this many patches
const NEAR = 0.1; // least part of the assembly that is in view with selected parts [-]
const HOVER = 40; // least time between two searches for the part under the pointer [ms]
const TURNS = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1], "+": [0, 0, 0.9], "-": [0, 0, 1.1] }; // of the keys
const STILL = 4; // a pointer that moves less than this has clicked [CSS px]

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
    this.tree = new Tree(this);
  }

  /** A tool that takes the clicks in the picture; null: a click selects. */
  tool = null;

  /** Draw for the first time, when the set-up is complete. */
  begin() {
    this.theme();
    if (this.stage) {
      this.compass = new Compass(id("cube"), id("triad"), (direction) => this.stage.view(direction));
      this.stage.drawn = () => {
        this.names.place();
        this.compass.paint(this.stage.axes());
      };
      this.stage.render();
    }
    this.firstPicture = performance.now();
  }

  /** Show the data of another page; view, selection, hidden parts and controls are kept. */
  replace(page) {
    const { names } = this.page.parts;
    const named = (list) => new Set([...list].map((k) => names[k]));
    const selected = named(this.selection);
    const gone = this.stage ? named([...names.keys()].filter((k) => !this.stage.parts.visible[k])) : new Set();
    this.page = page;
    this.long = 0.42 * page.radius;
    this.selection = new Set([...page.parts.names.keys()].filter((k) => selected.has(page.parts.names[k])));
    if (this.stage) {
      this.stage.replace(page);
      const { parts } = this.stage;
      page.parts.names.forEach((name, k) => (parts.visible[k] = gone.has(name) ? 0 : 1));
      parts.selected = this.selection;
      parts.patches.visible = id("show-contacts").checked;
      this.cut();
      this.measure.clear();
      this.stage.spread(this.spreading());
      this.theme();
    }
    this.offer();
    this.label();
    this.tree.set(page);
    this.renewed();
    this.showSelection();
  }

  /** Answer the data after a replacement; called before the selection is shown again. */
  renewed() {}

  // controls --------------------------------------------------------------------------

  /** Connect the controls that all pages have; called once. */
  look() {
    on("explode", "input", () => this.slide("apart", "explode", 1.6));
    for (const axis of "xyz") {
      on(`section-${axis}-side`, "change", () => this.section());
      on(`section-${axis}`, "input", () => this.section());
    }
    on("flat", "click", () => this.flatten());
    for (const [name, kind] of [["see-through", "input"], ["see-through-of", "change"]]) {
      on(name, kind, () => {
        this.seeThrough();
        this.legend();
        this.stage.draw();
      });
    }
    on("force-size", "input", () => this.repose());
    for (const name of ["show-forces", "force-mode", "show-thrust"]) on(name, "change", () => this.repose());
    on("show-motion", "change", () => this.repose());
    on("show-contacts", "change", () => {
      this.stage.parts.patches.visible = id("show-contacts").checked;
      this.repose();
    });
    on("show-open", "change", () => this.repose());
    on("show-names", "change", () => this.label());
    on("home", "click", () => this.stage.home());
    on("view", "change", () => {
      const direction = VIEWS[id("view").value];
      id("view").value = "";
      if (direction) this.stage.view(direction);
    });
    on("theme", "click", () => this.nextTheme());
    on("hide", "click", () => this.hide());
    on("isolate", "click", () => this.isolate());
    on("zoom", "click", () => this.stage.zoomTo([...this.selection]));
    on("show-all", "click", () => this.showAll());
    on("copy-name", "click", () => {
      copyText([...this.selection].map((k) => this.page.parts.names[k]).join("\n"), id("copy-name"));
    });
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.theme());
    document.body.addEventListener("click", (e) => {
      const button = e.target.closest && e.target.closest("button[data-part]");
      if (!button) return;
      this.select(Number(button.dataset.part));
      id("picture").scrollIntoView({ block: "nearest" });
    });
    this.offer();
    this.tree.set(this.page);
    if (!this.stage) {
      const drawing = ".tools, .views, #cube, #triad, #legend, .gravity, #part .buttons";
      for (const part of document.querySelectorAll(drawing)) part.hidden = true;
      return;
    }
    this.measure = new Measure(this);
    const { page } = this;
    id("show-names").checked = page.parts.names.length <= NAMED;
    const { start, kinds } = page.patches;
    // the contact points of studs would hide the bricks
    id("show-contacts").checked = start.length - 1 <= PATCHES && kinds.join() !== "bond";
    this.stage.parts.patches.visible = id("show-contacts").checked;
    this.label();
    this.picking();
  }

  /** Show the controls that apply to the data of the page. */
  offer() {
    if (!this.stage) return;
    const { page } = this;
    const pairs = page.open.decides ? page.open.decides.filter(Boolean).length : page.open.parts.length / 2;
    id("open-row").hidden = !pairs;
    id("open-label").textContent = `${pairs} open pair${pairs > 1 ? "s" : ""}`;
    id("contacts-row").hidden = page.patches.start.length < 2;
    id("explode-row").hidden = page.parts.names.length < 2;
  }

  /** Take over the value of a slider, scaled to `most`. */
  slide(key, name, most = 1) {
    this[key] = most * Number(id(name).value);
    if (key === "apart" && this.stage) this.stage.spread(this.spreading());
    this.repose();
  }

  /** Switch between a view with perspective and one without. */
  flatten() {
    const flat = id("flat").getAttribute("aria-pressed") !== "true";
    id("flat").setAttribute("aria-pressed", String(flat));
    this.stage.flatten(flat);
  }

  seeThrough() {
    const share = Number(id("see-through").value);
    const rest = id("see-through-of").value === "rest";
    id("see-through-row").hidden = !share || !this.movers().length;
    this.stage.parts.seeThrough(share, rest);
  }

  /** Indices of the parts that move. */
  movers() {
    return [];
  }

  /** Half lengths of the box around the parts, pulled apart by the explode slider. */
  spreading() {
    return this.page.extent.map((e) => (1 + this.apart) * e);
  }

  label() {
    if (!this.names) return;
    const all = this.page.parts.names.map((_, k) => k);
    this.names.show(id("show-names").checked ? all.slice(0, 400) : []);
  }

  /** Length of the arrow of a load per newton [length unit/N]; the largest has the length `long`. */
  loadScale() {
    if (this.fixedScale) return this.fixedScale; // while an arrow is dragged
    const most = this.page.loads.reduce((m, load) => Math.max(m, Math.hypot(...load.force)), 0);
    return most ? this.long / most : 0;
  }

  /** Draw loads and open pairs at the current positions of the parts. */
  marks() {
    const { stage } = this;
    const { loads } = this.page;
    const scale = this.loadScale();
    const straight = loads
      .filter((load) => Math.hypot(...load.force) > 0)
      .map((load) => ({ ...load, at: stage.parts.placeOf(load.part, load.point) }))
      .filter((load) => stage.parts.seen(load.part, load.at))
      .map((load) => ({
        at: load.at,
        along: load.force,
        size: scale * Math.hypot(...load.force),
        wide: this.long,
      }));
    stage.loads.set({ straight });
    // the straps lie on the parts at rest
    stage.straps.set(this.apart || this.amount || this.fell || this.shifted ? {} : strapRods(this.page));
    stage.open.set(id("show-open").checked ? openMarks(stage) : {});
    this.measure.follow();
    this.legend();
  }

  /** List the marks that are drawn now, and no others. */
  legend() {
    const { stage, page } = this;
    if (!stage) return;
    const { parts } = stage;
    const some = (arrows) => arrows.group.children.length > 0;
    const shown = page.parts.names.map((_, k) => k).filter((k) => parts.shown(k));
    const drawn = {
      base: shown.some((k) => page.parts.grounded[k] && !page.parts.table?.[k]),
      moving: shown.some((k) => parts.moving[k] && !parts.gripped[k]),
      picked: shown.some((k) => this.selection.has(k)),
      grip: shown.some((k) => parts.gripped[k]),
      faint: parts.anyFaint && parts.sparing,
      motion: some(stage.motion),
      force: some(stage.forces),
      hand: some(stage.hands),
      patch: parts.patches.visible && page.patches.start.length > 1,
      open: some(stage.open),
      load: some(stage.loads),
      strap: some(stage.straps),
      hinge: some(stage.hinges),
      added: stage.ghost.group.visible,
      seat: stage.lines.visible,
      gauge: some(stage.gauge),
      grid: !page.planar,
    };
    id("grid-step").textContent = `${Number(stage.ground.step.toPrecision(3))} ${page.units}`;
    for (const [name, on_] of Object.entries(drawn)) id(`${name}-key`).hidden = !on_;
  }

  /** Cut away one side of up to three planes, across the axes of the file. */
  section() {
    this.cut();
    this.repose();
  }

  cut() {
    const cuts = [];
    "xyz".split("").forEach((axis, k) => {
      const side = id(`section-${axis}-side`).value;
      id(`section-${axis}`).hidden = !side;
      if (!side) return;
      const sign = side === "-" ? -1 : 1;
      cuts.push([[0, 1, 2].map((i) => (i === k ? sign : 0)), sign * this.page.radius * Number(id(`section-${axis}`).value)]);
    });
    this.stage.parts.section(cuts);
  }

  picking() {
    const canvas = id("picture");
    let from = null;
    const place = (e) => {
      const box = canvas.getBoundingClientRect();
      return [e.clientX - box.left, e.clientY - box.top];
    };
    canvas.addEventListener(
      "pointerdown",
      (e) => {
        from = place(e);
        this.framing = e.shiftKey && !e.button;
        if (!this.framing) return;
        e.stopImmediatePropagation(); // a frame is drawn; the view does not turn
        canvas.setPointerCapture(e.pointerId);
        canvas.focus({ preventScroll: true });
      },
      { capture: true },
    );
    canvas.addEventListener("pointermove", (e) => this.framing && from && this.frame(from, place(e)));
    canvas.addEventListener("pointerup", (e) => {
      if (!from || e.button) return;
      const to = place(e);
      const still = Math.hypot(to[0] - from[0], to[1] - from[1]) < STILL;
      const framed = this.framing && !still && this.frame(from, to);
      from = null;
      this.framing = false;
      id("frame").hidden = true;
      if (framed) this.choose(this.stage.within(framed), "add");
      else if (still && this.tool) this.tool.click(...to);
      else if (still && this.measure.on) this.measure.click(...to);
      else if (still) {
        const part = this.stage.pick(...to);
        const several = e.shiftKey || e.ctrlKey || e.metaKey;
        if (part >= 0 && several) this.choose([part], "toggle");
        else if (!several) this.select(part);
      }
    });
    canvas.addEventListener("pointercancel", () => {
      [from, this.framing] = [null, false];
      id("frame").hidden = true;
    });
    canvas.addEventListener("pointermove", (e) => e.buttons || this.hover(place(e)));
    canvas.addEventListener("pointerleave", () => this.hovered(-1));
    document.addEventListener("keydown", (e) => this.hotkey(e));
  }

  /** Mark the part under the pointer, as often as the pictures allow. */
  hover(at) {
    this.pointer = at;
    if (this.hovering) return;
    this.hovering = setTimeout(() => {
      const started = performance.now();
      this.hovered(this.stage.pick(...this.pointer));
      this.pause = Math.max(HOVER, 8 * (performance.now() - started));
      this.hovering = 0;
    }, this.pause ?? HOVER);
  }

  hovered(part) {
    const { parts } = this.stage;
    if (parts.hovered === part) return;
    parts.hovered = part;
    id("picture").title = part < 0 ? "" : this.page.parts.tails[part];
    parts.states();
    this.stage.draw();
  }

  /** Keys of the picture: letters work wherever no text is written, the others in the picture. */
  hotkey(event) {
    const { target, key } = event;
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (target.matches?.("input:not([type=range], [type=checkbox], [type=file]), textarea, select") || document.querySelector("dialog[open]")) return;
    const inPicture = target === id("picture");
    const everywhere = /^[a-z?]$/i.test(key) || key === "Escape" || (target === document.body && /^[-+0-9]$/.test(key));
    if ((inPicture || everywhere) && this.press(key, event.shiftKey)) event.preventDefault();
  }

  /** Do what a key of the picture stands for; returns whether there is such a key. */
  press(key, shift) {
    const { stage } = this;
    const { count } = stage.parts;
    const letter = key.toLowerCase();
    if (this.key(key)) return true;
    if (TURNS[key]) stage.orbit(...TURNS[key]);
    else if (VIEW_KEYS[key]) stage.view(VIEWS[VIEW_KEYS[key]]);
    else if (key === "0") stage.home();
    else if (letter === "n" || letter === "p") {
      const next = this.selected < 0 ? 0 : (this.selected + (letter === "n" ? 1 : count - 1)) % count;
      this.choose([next], shift ? "add" : "only");
    } else if (key === "f") this.fit();
    else if (key === "v") this.hide();
    else if (key === "i") this.isolate();
    else if (key === "a") this.showAll();
    else if (key === "m") this.measure.toggle();
    else if (key === "Escape" && this.measure.on) this.measure.toggle(false);
    else if (key === "Escape") this.select(-1);
    else return false;
    return true;
  }

  /** Show the selected parts in the middle of the picture; without a selection, all parts. */
  fit() {
    if (this.selection.size) this.stage.zoomTo([...this.selection]);
    else this.stage.home();
  }

  /** Draw the frame of a selection; returns its left, top, right and bottom [CSS px]. */
  frame(from, to) {
    const [left, right] = [Math.min(from[0], to[0]), Math.max(from[0], to[0])];
    const [top, bottom] = [Math.min(from[1], to[1]), Math.max(from[1], to[1])];
    const element = id("frame");
    element.hidden = false;
    const style = { left, top, width: right - left, height: bottom - top };
    for (const [name, value] of Object.entries(style)) element.style[name] = `${value}px`;
    return [left, top, right, bottom];
  }

  /** Handle a further key in the picture; returns whether the page uses it. */
  key() {
    return false;
  }

  // selected parts --------------------------------------------------------------------

  selection = new Set();

  /** The part that was selected last; -1 without a selection. */
  get selected() {
    return [...this.selection].at(-1) ?? -1;
  }

  /** Select a single part; -1 selects none. */
  select(part) {
    this.choose(part < 0 ? [] : [part]);
  }

  /** Select parts: `only` these, `add` them, or `toggle` them (off if all are selected). */
  choose(parts, how = "only") {
    if (how === "only") this.selection = new Set(parts);
    else {
      const off = how === "toggle" && parts.every((k) => this.selection.has(k));
      for (const k of parts) this.selection.delete(k);
      if (!off) for (const k of parts) this.selection.add(k);
    }
    this.showSelection();
  }

  /** Select parts by their indices, and bring them into view. */
  bring(parts) {
    this.choose(parts);
    if (this.stage) this.stage.zoomTo(parts, NEAR * this.page.radius);
  }

  /** Show the selection in the picture, the tree and the card. */
  showSelection() {
    if (this.stage) {
      this.stage.parts.selected = this.selection;
      this.stage.parts.states();
      this.stage.draw();
      this.legend();
    }
    const some = this.selection.size > 0;
    id("part").hidden = !some;
    id("no-part").hidden = some;
    this.tree.mark();
    if (some) this.showPart(this.selected);
  }

  showPart(k) {
    const { names, tails } = this.page.parts;
    const several = this.selection.size > 1;
    id("part-name").textContent = several ? `${this.selection.size} parts` : tails[k];
    id("part-name").title = several ? "" : names[k];
    id("copy-name").dataset.label = several ? "Copy full names" : "Copy full name";
    id("copy-name").textContent = id("copy-name").dataset.label;
    const facts = several ? factsOfSeveral(this.page, [...this.selection]) : factsOf(this.page, this.found, k);
    listFacts(id("part-facts"), facts);
  }

  /** Show or hide parts. */
  setVisible(list, visible) {
    for (const k of list) this.stage.parts.visible[k] = visible ? 1 : 0;
    this.seen();
  }

  /** Redraw after parts were hidden or shown. */
  seen() {
    const { parts } = this.stage;
    parts.states();
    id("show-all").hidden = parts.visible.every(Boolean);
    this.tree.mark();
    this.repose();
  }

  hide() {
    if (!this.selection.size) return;
    const list = [...this.selection];
    this.select(-1);
    this.setVisible(list, false);
  }

  isolate() {
    if (!this.selection.size) return;
    this.stage.parts.visible.fill(0);
    this.setVisible(this.selection, true);
  }

  showAll() {
    this.stage.parts.visible.fill(1);
    this.seen();
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
