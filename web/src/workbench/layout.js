// The layout of the workbench: the tree at the left, panels at the right, edges that can be dragged.

import { id } from "../dom.js";
import { button } from "./entries.js";

const PANELS = {
  answer: ["Answer", ["assumptions", "decide", "left-out-card", "answer-title"]],
  gravity: ["Gravity", ["tilt", "ball"]],
  forces: ["Friction, loads", ["friction"]],
  display: ["Display", ["explode"]],
};
const NUDGE = 24; // an arrow key moves an edge by this much [CSS px]
const EDGES = {
  left: { label: "width of the list of parts", panel: ".parts-column", least: 170, most: 520, sign: 1, upright: true },
  right: { label: "width of the panels", panel: "aside", least: 280, most: 640, sign: -1, upright: true },
  sheet: { label: "height of the analysis", panel: "#sheet", least: 120, most: 640, sign: -1, upright: false },
};

export class Layout {
  constructor() {
    this.now = "answer";
    const columns = document.querySelector(".columns");
    const side = document.querySelector("aside");
    const left = document.createElement("div");
    left.className = "parts-column";
    left.append(id("part-card"));
    columns.insertBefore(left, columns.querySelector(".left").nextSibling);
    this.list = document.createElement("div");
    this.list.id = "panel-list";
    this.list.setAttribute("role", "tablist");
    this.list.setAttribute("aria-label", "panels");
    this.buttons = Object.entries(PANELS).map(([name, [label, sections]]) => this.panel(side, name, label, sections));
    this.list.append(...this.buttons);
    side.prepend(this.list);
    id("cards").hidden = true; // of a report
    this.list.addEventListener("keydown", (e) => roveTabs(this.buttons, e));
    for (const name of ["left", "right"]) columns.append(edge(name));
    id("tabs").prepend(edge("sheet"));
    this.show("answer");
    this.opened = () => {};
  }

  /** A panel of the side with the sections of these elements, and its button. */
  panel(side, name, label, members) {
    const box = document.createElement("div");
    box.id = `panel-${name}`;
    box.className = "panel";
    box.setAttribute("role", "tabpanel");
    box.setAttribute("aria-labelledby", `open-${name}`);
    box.append(...members.map((member) => id(member).closest("section")));
    side.append(box);
    const element = button(label, () => this.show(name));
    element.id = `open-${name}`;
    element.dataset.panel = name;
    element.setAttribute("role", "tab");
    element.setAttribute("aria-controls", box.id);
    return element;
  }

  /** Show a panel; the others are hidden. */
  show(name) {
    this.now = name;
    for (const element of this.buttons) {
      const shown = element.dataset.panel === name;
      element.setAttribute("aria-selected", String(shown));
      element.tabIndex = shown ? 0 : -1;
      id(`panel-${element.dataset.panel}`).hidden = !shown;
    }
    this.opened?.(name);
  }

  /** Write the number of open questions beside the name of the first panel. */
  count(questions) {
    this.buttons[0].textContent = questions ? `Answer (${questions})` : "Answer";
    id("panel-answer").dataset.empty = String(!questions);
  }
}

/** Move the focus among the buttons of a list of tabs by the arrow keys, Home and End. */
export function roveTabs(buttons, event) {
  const k = buttons.indexOf(event.target);
  const last = buttons.length - 1;
  const next = { ArrowRight: k === last ? 0 : k + 1, ArrowLeft: k ? k - 1 : last, Home: 0, End: last }[event.key];
  if (k < 0 || next === undefined) return;
  event.preventDefault();
  buttons.forEach((element, j) => (element.tabIndex = j === next ? 0 : -1));
  buttons[next].focus();
}

/** An edge between two panels that is dragged, or moved by the arrow keys. */
function edge(name) {
  const { label, panel, least, most, sign, upright } = EDGES[name];
  const element = document.createElement("div");
  element.id = `edge-${name}`;
  element.className = "edge";
  element.tabIndex = 0;
  const attributes = { role: "separator", "aria-label": label, "aria-orientation": upright ? "vertical" : "horizontal", "aria-valuemin": least, "aria-valuemax": most };
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  const variable = `--${name}`;
  const size = () => document.querySelector(panel)[upright ? "offsetWidth" : "offsetHeight"];
  const set = (value) => {
    const now = Math.round(Math.max(least, Math.min(most, value)));
    document.body.style.setProperty(variable, `${now}px`);
    element.setAttribute("aria-valuenow", String(now));
  };
  element.setAttribute("aria-valuenow", String(Math.max(least, size())));
  element.addEventListener("focus", () => element.setAttribute("aria-valuenow", String(Math.max(least, size()))));
  let from = null;
  element.addEventListener("pointerdown", (e) => {
    element.setPointerCapture(e.pointerId);
    from = [upright ? e.clientX : e.clientY, size()];
    e.preventDefault();
  });
  element.addEventListener("pointermove", (e) => from && set(from[1] + sign * ((upright ? e.clientX : e.clientY) - from[0])));
  for (const kind of ["pointerup", "pointercancel"]) element.addEventListener(kind, () => (from = null));
  element.addEventListener("keydown", (e) => {
    const way = { ArrowRight: upright ? 1 : 0, ArrowLeft: upright ? -1 : 0, ArrowDown: upright ? 0 : 1, ArrowUp: upright ? 0 : -1 }[e.key];
    if (!way) return;
    e.preventDefault();
    set(size() + sign * way * NUDGE);
  });
  return element;
}
