// The help of the workbench: its keys, a tour in five steps, and where to read on.

import { button } from "./entries.js";

const KEYS = [
  ["h", "hold or release the selected parts"],
  ["x, Delete", "leave out the selected parts"],
  ["j", "join two selected parts, or the selected part with the next one that is clicked"],
  ["f", "fit the view to the selected parts, or to all"],
  ["v, i, a", "hide, show alone, show all"],
  ["n, p", "next part, previous part"],
  ["m", "measure"],
  ["1 to 7, 0, o", "standard views, first view, view without perspective"],
  ["Ctrl+Z, Ctrl+Y, Ctrl+S", "undo, redo, save"],
  ["Escape", "end measuring or joining, select nothing"],
  ["?", "this help"],
];
const TOUR = [
  ["#banner", "The answer", "The verdict with its reason, and the row of assumptions: the parts as drawn, with their play, with fastened pairs, or all joined."],
  [".stage", "The picture", "Parts that move have a coloured outline and an arrow. Click a part to act on it; drag to turn the view."],
  ["#part-card", "The parts", "Search, hide and select parts; below are the facts of the selected part, its material, mass and loads."],
  ["#panel-list", "Your decisions", "Questions that change the verdict, the direction of gravity, friction and loads, and the display."],
  ["#tabs", "Your questions", "Which way up, how far it may tilt, in which order it can be built, which parts to hold. Each answer has its command line."],
];
const MORE = "Each command explains itself: kilter --help, kilter check --help. A terminal prints these pages by kilter help.";

export class Help {
  /** `guides`: name and title of each page of the documentation; `address`: as of a link. */
  constructor(guides, address) {
    this.dialog = make("dialog", "", { id: "help", "aria-label": "help" });
    const list = make("dl", "");
    for (const [keys, words] of KEYS) list.append(make("dt", keys), make("dd", words));
    const close = button("Close", () => this.dialog.close());
    const tour = button("Show the tour", () => this.step(0));
    const buttons = make("div", "", { class: "buttons" });
    buttons.append(tour, close);
    const pages = make("ul", "", { class: "guides" });
    for (const [name, title] of guides) {
      const item = make("li", "");
      item.append(make("a", title, { href: address(`guide/${name}`), target: "_blank", rel: "noopener" }));
      pages.append(item);
    }
    const read = guides.length ? [make("h2", "Guides"), pages] : [];
    this.dialog.append(make("h2", "Keys"), list, ...read, make("p", MORE, { class: "small" }), buttons);
    this.card = make("div", "", { id: "tour", role: "dialog", "aria-label": "tour", hidden: "" });
    document.body.append(this.dialog, this.card);
  }

  show() {
    this.dialog.showModal();
  }

  /** Show a step of the tour beside the element that it is about; after the last step, end it. */
  step(k) {
    if (this.dialog.open) this.dialog.close();
    document.querySelector(".toured")?.classList.remove("toured");
    this.card.hidden = k >= TOUR.length;
    if (this.card.hidden) return;
    const [selector, title, words] = TOUR[k];
    const about = document.querySelector(selector);
    about.classList.add("toured");
    const next = button(k + 1 < TOUR.length ? `Next (${k + 1} of ${TOUR.length})` : "Done", () => this.step(k + 1));
    const buttons = make("div", "", { class: "buttons" });
    buttons.append(next, button("End the tour", () => this.step(TOUR.length)));
    this.card.replaceChildren(make("h2", title), make("p", words), buttons);
    const box = about.getBoundingClientRect();
    const { offsetWidth: wide, offsetHeight: high } = this.card;
    const left = box.left + wide + 24 < innerWidth / 2 + box.width ? box.right - wide - 16 : box.left - wide - 16;
    this.card.style.left = `${Math.max(8, Math.min(innerWidth - wide - 8, left))}px`;
    this.card.style.top = `${Math.max(8, Math.min(innerHeight - high - 8, box.top + 24))}px`;
    next.focus();
  }
}

function make(kind, words, attributes = {}) {
  const element = document.createElement(kind);
  element.textContent = words;
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return element;
}
