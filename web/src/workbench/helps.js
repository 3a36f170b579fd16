// The tab "What helps": changes that were tried, each in the picture, as choices or as a file.

import { id } from "../dom.js";
import { button, entered, numbersOf } from "./entries.js";

const KINDS = { move: "movements", mass: "masses", size: "sizes", friction: "friction" };

export class Helps {
  constructor(bench, onStage) {
    Object.assign(this, { bench, onStage, allowed: new Set(["move", "mass"]), tilt: "" });
  }

  /** Buttons that try changes, or find the least change of the allowed kinds. */
  controls(ask) {
    const { bench } = this;
    const parts = () => bench.parts.names();
    const boxes = Object.entries(KINDS).map(([kind, words]) => {
      const [label, box] = [document.createElement("label"), document.createElement("input")];
      Object.assign(box, { type: "checkbox", id: `allow-${kind}`, checked: this.allowed.has(kind) });
      box.addEventListener("change", () => this.allowed[box.checked ? "add" : "delete"](kind));
      label.append(box, ` ${words}`);
      return label;
    });
    const tilt = document.createElement("input");
    Object.assign(tilt, { id: "stand-tilt", placeholder: "2", value: this.tilt });
    tilt.setAttribute("aria-label", "tilt up to which it stands [deg]");
    tilt.addEventListener("input", () => (this.tilt = tilt.value));
    const stand = () => {
      const degrees = numbersOf(entered(tilt), 1);
      if (!degrees) bench.complain("Give the tilt in degrees: a number.");
      else if (!this.allowed.size) bench.complain("Allow a kind of change.");
      else ask({ allow: Object.keys(KINDS).filter((kind) => this.allowed.has(kind)), tilt: degrees[0] });
    };
    const words = document.createElement("span");
    words.textContent = "deg of tilt, by";
    return [
      button("Try changes", () => ask({})),
      button("Try to hold selected parts", () => (parts().length ? ask({ parts: parts() }) : bench.complain("Select the parts that may be held."))),
      button("Make it stand", stand, "find the least change after which it stands up to this tilt"),
      tilt,
      words,
      ...boxes,
    ];
  }

  /** Give the buttons of the table their actions: show a change on the stage, or make it. */
  tell(body, { changes }) {
    const links = [...body.querySelectorAll("[data-change]")];
    const mark = () => links.forEach((link, k) => link.setAttribute("aria-pressed", String(k === this.onStage.changed)));
    links.forEach((link, k) => {
      link.addEventListener("click", () => {
        this.onStage.change(k, changes);
        mark();
        id("picture").scrollIntoView({ block: "nearest" });
      });
    });
    body.querySelectorAll("[data-make]").forEach((element, k) => element.addEventListener("click", () => this.make(changes[k], k)));
    mark();
  }

  /** Make the choice of a change, or download the changed assembly. */
  make({ action }, k) {
    const { bench } = this;
    if (action) bench.act(action);
    else bench.export(`changed-${k}.kilter.json`, `${bench.session.file.replace(/(\.kilter)?\.[^.]*$/, "")}.changed.kilter.json`);
  }
}
