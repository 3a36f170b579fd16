// Friction of all contacts, loads, floor and gravity; and the lists of joints, bonds and pairs.

import { id, on } from "../dom.js";
import { direction, force, number } from "../words.js";
import { norm, turnedAbout, unit } from "../vector.js";
import { button, entered, entry, frictionOf, numbersOf, refill } from "./entries.js";

const PAUSE = 120; // least time between two messages of a dragged slider [ms]

export class Forces {
  constructor(bench) {
    this.bench = bench;
    this.start = Date.now(); // drags of two pages differ
    this.drags = 0;
    on("friction", "input", () => this.drag(Number(id("friction").value)));
    // the positions until the slider is released are one change
    on("friction", "change", () => (this.drags += 1));
    on("friction-number", "change", () => {
      const text = id("friction-number").value.trim();
      this.entered = id("friction-number").value; // no longer being typed
      const mu = text === "" ? null : frictionOf(text);
      if (Number.isNaN(mu)) bench.complain("Give a coefficient, a share or an angle: 0.3, 30% or 17deg.");
      else bench.act({ do: "friction", mu });
    });
    on("friction-file", "click", () => bench.act({ do: "friction", mu: null }));
    on("scale-loads", "input", () => (id("scale-words").textContent = number(this.factor(), 3)));
    on("scale-loads", "change", async () => {
      const factor = this.factor();
      id("scale-loads").value = "0";
      id("scale-words").textContent = "1";
      if (factor !== 1) await bench.act({ do: "scale_loads", factor });
    });
    on("floor", "change", () => bench.act({ do: "floor", on: id("floor").checked }));
    on("up", "change", () => bench.act({ do: "gravity", ...(id("up").value ? { up: id("up").value } : { down: null }) }));
    on("tilt-form", "submit", (event) => {
      event.preventDefault();
      this.tilt(entered(id("tilt")));
    });
    on("use-gravity", "click", () => {
      const down = [...bench.report.down];
      bench.act({ do: "gravity", down });
    });
  }

  /** Show a typed direction of gravity: an angle [deg] and an axis, or a direction. */
  tilt(text) {
    const { report } = this.bench;
    const axis = { x: "1 0 0", y: "0 1 0", z: "0 0 1" };
    const numbers = numbersOf(text.replace(/[xyz]/i, (letter) => axis[letter.toLowerCase()]), 4) ?? numbersOf(text, 3);
    if (!numbers || !norm(numbers.slice(-3))) {
      this.bench.complain("Give an angle in degrees and an axis, as 10 x, or a direction of gravity of three numbers.");
      return;
    }
    const [along, angle] = [unit(numbers.slice(-3)), numbers.length === 4 ? numbers[0] : null];
    // the assembly turns by the angle, so gravity turns back in its frame
    report.pull(angle === null ? along : turnedAbout(report.page.given.down, along, (-angle * Math.PI) / 180), "typed");
  }

  factor() {
    return Number((10 ** Number(id("scale-loads").value)).toPrecision(3));
  }

  /** Send the position of the friction slider, at most once in a while. */
  drag(mu) {
    id("friction-number").value = String(mu);
    this.wanted = mu;
    if (this.sending) return;
    this.sending = true;
    const next = async () => {
      const mu_ = this.wanted;
      this.wanted = null;
      await this.bench.act({ do: "friction", mu: mu_, live: `${this.start}-${this.drags}` });
      setTimeout(() => {
        if (this.wanted !== null) next();
        else this.sending = false;
      }, PAUSE);
    };
    next();
  }

  tell({ choices }) {
    const { bench } = this;
    const { friction, floor, up } = choices;
    const given = friction !== undefined;
    if (!this.sending) {
      const own = bench.report?.page.friction; // of the file, as long as no choice replaces it
      id("friction").value = String(friction ?? own ?? 0);
      const typed = document.activeElement === id("friction-number") && id("friction-number").value !== this.entered;
      if (!typed) id("friction-number").value = given ? String(friction) : "";
      id("friction-number").placeholder = own === undefined ? "file" : String(own);
    }
    id("friction-file").hidden = !given;
    id("floor").checked = Boolean(floor);
    id("up").value = up ?? "";
    this.lists(choices);
  }

  /** List the loads, joints, bonds and decided pairs of the choices. */
  lists(choices) {
    const { bench } = this;
    const short = (name) => bench.shortName(name);
    const loads = choices.loads ?? [];
    id("scale-row").hidden = !loads.length;
    refill(
      id("loads"),
      ...loads.map((load, index) => {
        const size = Math.hypot(...load.force);
        const words = `load ${index + 1}: ${force(size)} along ${direction(load.force.map((c) => c / (size || 1)), 3)} on ${short(load.part)}`;
        const edit = button("Edit", () => bench.parts.editLoad(load, index));
        return entry(words, edit, button("Remove", () => bench.act({ do: "load_off", index })));
      }),
    );
    const pair = ({ parts }) => parts.map(short).join(" and ");
    const items = [
      ...(choices.joined ?? []).map((parts) =>
        entry(`joined: ${parts.map(short).join(" and ")}`, button("Remove", () => bench.act({ do: "fasten", parts, on: false }))),
      ),
      ...(choices.open_pairs ?? []).map((one) =>
        entry(`${one.as}: ${pair(one)}`, button("Remove", () => bench.act({ do: "pair", pairs: [one.parts], as: null }))),
      ),
      ...(choices.joints ?? []).map((one, index) =>
        entry(`${one.kind} joint: ${pair(one)}`, button("Remove", () => bench.act({ do: "joint_off", index }))),
      ),
      ...(choices.bonds ?? []).map((one, index) =>
        entry(`bond of ${force(one.pull)} per point: ${pair(one)}`, button("Remove", () => bench.act({ do: "bond_off", index }))),
      ),
      ...(choices.straps ?? []).map((one, index) =>
        entry(`strap of ${force(one.tension)}: ${one.path.map(([part]) => short(part)).join(", ")}`, button("Remove", () => bench.act({ do: "strap_off", index }))),
      ),
      ...(choices.friction_pairs ?? []).map((one) =>
        entry(`friction ${one.mu}: ${pair(one)}`, button("Remove", () => bench.act({ do: "pair_friction", parts: one.parts, mu: null }))),
      ),
      ...(choices.poses
        ? [entry(`moved: ${Object.keys(choices.poses).map(short).join(", ")}`, button("Remove", () => bench.act({ do: "poses", poses: null }), "places these parts as in the file"))]
        : []),
      ...["fasten_suggested", "fasten_overlaps", "loose"]
        .filter((name) => choices[name])
        .map((name) => entry(SWITCHES[name], button("Remove", () => bench.act({ do: name, on: false })))),
    ];
    refill(id("joined"), ...items);
  }
}

const SWITCHES = {
  fasten_suggested: "joined: all pairs that look fastened",
  fasten_overlaps: "joined: all pairs that overlap",
  loose: "loose tolerances",
};
