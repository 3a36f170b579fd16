// The ladder of assumptions about a file: its rows, the chosen rung, and the bodies of joined parts.

import { bodyColour, themeOf } from "./colours.js";
import { id } from "./dom.js";
import { shortened } from "./words.js";
import { button, entry, fill, refill } from "./workbench/entries.js";

const LISTED = 60; // bodies in a list; all of them are coloured
const JOINED = "joined"; // the rung whose bodies are coloured
const HOLDS = "✓"; // sign of a rung on which the assembly holds

/** The card of the ladder; with `choose`, its rows and the control beside the verdict choose a rung. */
export class Ladder {
  constructor(report) {
    this.report = report;
    this.choose = null;
    this.coloured = false;
    this.warned = "[]";
  }

  /** Show the ladder of an answer, and its bodies; null: of an answer without a ladder. */
  tell(data) {
    const { assume = null, rows = [], bodies = [] } = data ?? {};
    mark(assume, rows);
    id("assumptions").hidden = !rows.length && !bodies.length;
    refill(id("ladder"), ...rows.map((row) => this.row(row, assume)));
    const loose = bodies.filter((body) => body.loose);
    const standing = bodies.filter((body) => !body.loose);
    this.list("loose-bodies", "Loose bodies", loose);
    this.list("bodies", "Bodies on the floor, or held", standing);
    this.colour(assume === JOINED && bodies.length > 0);
    const warned = JSON.stringify(loose.map(({ parts }) => parts));
    if (this.coloured && warned !== this.warned) this.report.blink(loose.flatMap(({ parts }) => parts));
    if (this.coloured) this.warned = warned;
  }

  /** Colour the parts by their bodies, or no longer; a choice of the user between them stays. */
  colour(on) {
    const of = id("colour-of");
    if (on === this.coloured) return;
    this.coloured = on;
    if (on) of.value = "body";
    else if (of.value === "body") of.value = "own";
    this.report.repose();
  }

  /** A row of the ladder: rung, verdict, and the parts that fall. */
  row(row, assume) {
    const item = document.createElement("li");
    const words = [element("b", signed(row)), element("span", shortened(this.report.page, row.words))];
    if (this.choose) {
      const line = button("", () => this.choose(row), row.condition);
      line.className = "rung";
      line.setAttribute("aria-pressed", String(row.assume === assume && row.friction === null));
      line.append(...words);
      item.append(line);
    } else {
      item.className = "rung";
      item.title = row.condition;
      if (row.assume === assume && row.friction === null) item.setAttribute("aria-current", "true");
      item.append(...words);
    }
    return item;
  }

  /** A list of bodies; a click selects the parts of a body and brings them into view. */
  list(name, title, bodies) {
    const { report } = this;
    const all = bodies.flatMap(({ parts }) => parts);
    fill(
      id(name),
      `${title} (${bodies.length})`,
      bodies.slice(0, LISTED).map((body) => {
        const item = entry("");
        const swatch = element("i", "");
        swatch.className = "swatch";
        const number = report.page.given.assumption.bodies.indexOf(body);
        swatch.style.background = `rgb(${bodyColour(themeOf(document.body), number)})`;
        const show = button(shortened(report.page, body.words), () => report.bring(body.parts), "select the parts of this body");
        show.className = "link";
        item.firstChild.append(swatch, show);
        return item;
      }),
      ...(bodies.length > 1 ? [button("Select all of them", () => report.choose(all))] : []),
    );
  }
}

/** Press the button of a rung in the control of the workbench; the others are released. */
export function press(rung) {
  for (const one of controls()) one.setAttribute("aria-pressed", String(one.dataset.rung === rung));
}

/** The buttons of the control of the workbench; none on other pages. */
export const controls = () => [...document.querySelectorAll("#rungs button")];

/** Press the present rung, and mark the rungs on which the assembly holds. */
function mark(assume, rows) {
  press(assume);
  for (const one of controls()) {
    const row = rows.find(({ assume: rung, friction }) => rung === one.dataset.rung && friction === null);
    one.textContent = row ? signed(row) : one.dataset.rung;
    one.setAttribute("aria-label", row ? `${one.dataset.rung}: ${row.words}` : one.dataset.rung);
  }
}

/** The name of a row with its sign. */
const signed = (row) => `${row.holds ? `${HOLDS} ` : ""}${row.name}`;

function element(kind, words) {
  const made = document.createElement(kind);
  made.textContent = words;
  return made;
}
