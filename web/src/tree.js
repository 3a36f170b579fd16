// The tree of parts with search: a click selects, the word at the right hides and shows.

import { labelsOf } from "./card.js";
import { id, on } from "./dom.js";
import { matcher, nest, rowsOf } from "./grove.js";
import { number } from "./words.js";

const OPEN = 60; // groups are open at first up to this many parts
const STEP = 200; // rows of a group that are listed at first, and with each "more"

export class Tree {
  constructor(look) {
    Object.assign(this, { look, box: id("tree"), open: new Set(), most: STEP, at: 0 });
    this.box.addEventListener("click", (e) => this.click(e));
    this.box.addEventListener("keydown", (e) => this.key(e));
    on("find", "input", () => this.search());
    on("find", "keydown", (e) => {
      if (e.key === "Enter") this.selectFound();
      if (e.key === "ArrowDown") this.focus(0);
    });
    on("select-found", "click", () => this.selectFound());
  }

  /** List the parts of a new page; open groups stay open. */
  set(page) {
    const first = !this.nodes;
    this.page = page;
    this.nodes = nest(page.parts.names);
    if (first && page.parts.names.length <= OPEN) this.openAll(this.nodes);
    this.search();
  }

  openAll(nodes) {
    for (const node of nodes.filter(({ part }) => part === null)) {
      this.open.add(node.path);
      this.openAll(node.children);
    }
  }

  search() {
    const text = id("find").value;
    const { names, tails } = this.page.parts;
    this.found = null;
    if (text.trim()) {
      const matches = matcher(text);
      const all = names.map((_, k) => k).filter((k) => matches(names[k]));
      // parts whose own name matches come before parts of a group that matches
      const own = (k) => matches(names[k].slice(names[k].lastIndexOf("/") + 1));
      this.found = [...all.filter(own), ...all.filter((k) => !own(k))];
    }
    this.most = STEP;
    const some = Boolean(this.found && this.found.length);
    id("select-found").hidden = !some;
    id("found").textContent = this.found ? `${this.found.length} of ${names.length}` : "";
    this.list = this.found && this.found.map((k) => ({ label: tails[k], path: names[k], part: k, children: [], parts: [k] }));
    this.draw();
  }

  selectFound() {
    if (this.found && this.found.length) this.look.choose(this.found);
  }

  /** Build the rows that the open groups show. */
  draw() {
    this.rows = rowsOf(this.list || this.nodes, this.open, this.most);
    this.at = Math.min(this.at, this.rows.length - 1);
    this.box.replaceChildren(...this.rows.map(([node, level], k) => this.row(node, level, k)));
    this.mark();
  }

  row(node, level, k) {
    const element = document.createElement("div");
    const put = (kind, name, text) => {
      const child = document.createElement(kind);
      child.className = name;
      child.textContent = text;
      element.append(child);
      return child;
    };
    element.setAttribute("role", "treeitem");
    element.setAttribute("aria-level", String(Math.min(level, 5)));
    element.dataset.row = String(k);
    if (node.more) {
      put("bdi", "label", `${node.more} more`);
      return element;
    }
    const group = node.part === null;
    if (group) element.setAttribute("aria-expanded", String(this.open.has(node.path)));
    put("span", "caret", group ? (this.open.has(node.path) ? "▾" : "▸") : "").setAttribute("aria-hidden", "true");
    const { mass, grounded, tails } = this.page.parts;
    const label = this.list || (node.label.includes("/") && !group) ? tails[node.part] : node.label;
    const labels = group ? [] : labelsOf(this.page.parts, node.part).map(([key, text]) => `${key} ${text}`);
    put("bdi", "label", label).title = [node.path, ...labels].join("\n");
    if (this.list && node.path.includes("/")) put("bdi", "path soft", node.path.slice(0, node.path.lastIndexOf("/")));
    const held = node.parts.filter((part) => grounded[part]).length;
    const marks = held ? (group && held < node.parts.length ? `${held} held` : "held") : "";
    put("span", "soft", marks);
    const sum = node.parts.reduce((total, part) => total + mass[part], 0);
    put("span", "soft", `${number(sum, 3)} kg`);
    const eye = put("button", "eye", "");
    eye.type = "button";
    eye.tabIndex = -1;
    return element;
  }

  /** Mark selected and hidden parts on the rows. */
  mark() {
    const { selection, stage } = this.look;
    [...this.box.children].forEach((element, k) => {
      const [node] = this.rows[k];
      element.tabIndex = k === this.at ? 0 : -1;
      if (node.more) return;
      element.setAttribute("aria-selected", String(node.parts.every((part) => selection.has(part))));
      const seen = !stage || node.parts.some((part) => stage.parts.visible[part]);
      element.classList.toggle("gone", !seen);
      const eye = element.lastChild;
      eye.replaceChildren(eyeIcon(seen));
      eye.title = seen ? "hide (v)" : "show (v)";
      eye.hidden = !stage;
      eye.setAttribute("aria-label", `${seen ? "hide" : "show"} ${node.path}`);
    });
  }

  click(event) {
    const element = event.target.closest("[data-row]");
    if (!element) return;
    const k = Number(element.dataset.row);
    const [node] = this.rows[k];
    this.at = k;
    if (node.more) this.more();
    else if (event.target.closest(".eye")) this.eye(node);
    else if (event.target.closest(".caret") && node.part === null) this.toggle(node);
    else this.pick(k, event);
    this.focus(this.at);
  }

  more() {
    this.most += STEP;
    this.draw();
  }

  toggle(node) {
    if (!this.open.delete(node.path)) this.open.add(node.path);
    this.draw();
  }

  eye(node) {
    const { look } = this;
    const seen = node.parts.some((part) => look.stage.parts.visible[part]);
    look.setVisible(node.parts, !seen);
  }

  /** Select the parts of row k; with shift from the last row on, with ctrl in addition. */
  pick(k, { shiftKey, ctrlKey, metaKey }) {
    const parts = this.rows[k][0].parts;
    if (shiftKey && this.anchor !== undefined) {
      const [low, high] = [Math.min(k, this.anchor), Math.max(k, this.anchor)];
      this.look.choose(this.rows.slice(low, high + 1).flatMap(([node]) => node.parts));
      return;
    }
    this.anchor = k;
    this.look.choose(parts, ctrlKey || metaKey ? "toggle" : "only");
  }

  key(event) {
    const element = event.target.closest("[data-row]");
    if (!element || event.altKey) return;
    const k = Number(element.dataset.row);
    const [node, level] = this.rows[k];
    const last = this.rows.length - 1;
    const moves = { ArrowDown: k + 1, ArrowUp: k - 1, Home: 0, End: last };
    const isOpen = node.part === null && this.open.has(node.path);
    if (event.key in moves) {
      const next = Math.max(0, Math.min(last, moves[event.key]));
      if (event.shiftKey && !this.rows[next][0].more) {
        this.anchor ??= k;
        this.pick(next, event);
      }
      this.focus(next);
    } else if (event.key === "ArrowRight" && node.part === null && !isOpen) this.toggle(node);
    else if (event.key === "ArrowLeft" && isOpen) this.toggle(node);
    else if (event.key === "ArrowLeft") {
      let up = k;
      while (up > 0 && this.rows[up][1] >= level) up -= 1;
      this.focus(up);
    } else if (event.key === "Enter" || event.key === " ") {
      if (node.more) this.more();
      else this.pick(k, event.key === " " ? { ctrlKey: true } : event);
    } else if (event.key === "v" && !node.more) this.eye(node);
    else return;
    event.preventDefault();
    if (!(event.key in moves)) this.focus(Math.min(this.at, this.rows.length - 1));
  }

  focus(k) {
    const element = this.box.children[k];
    if (!element) return;
    this.box.children[this.at]?.setAttribute("tabindex", "-1");
    this.at = k;
    element.tabIndex = 0;
    element.focus({ preventScroll: true });
    element.scrollIntoView({ block: "nearest" });
  }
}

const EYE = ["M1 8 C4 3 12 3 15 8 C12 13 4 13 1 8 Z", "M8 6 A2 2 0 1 0 8 10 A2 2 0 1 0 8 6 Z"];
const CLOSED = ["M1 8 C4 3 12 3 15 8 C12 13 4 13 1 8 Z", "M3 14 L13 2"];

/** The icon of a visible or of a hidden part. */
function eyeIcon(seen) {
  const make = (kind, attributes) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", kind);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return element;
  };
  const icon = make("svg", { viewBox: "0 0 16 16", width: "15", height: "15", "aria-hidden": "true" });
  icon.append(...(seen ? EYE : CLOSED).map((d) => make("path", { d })));
  return icon;
}
