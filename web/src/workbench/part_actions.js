// Actions on the selected parts: hold, leave out, material, mass, load; and on a pair of parts.

import { id, on } from "../dom.js";
import { roundAxis } from "./round_axis.js";
import { button, entry, numbersOf, refill } from "./entries.js";
import { number } from "../words.js";

const POINT = ["revolute", "cylindrical", "spherical"]; // joints that need a point
const ROUNDING = 1e-6; // relative rounding error of the coordinates of a page [-]
const AXIS = ["revolute", "cylindrical", "prismatic"]; // joints that need an axis

export class PartActions {
  constructor(bench) {
    this.bench = bench;
    this.edited = null;
    const parts = () => this.names();
    on("do-hold", "click", () => this.hold());
    on("do-leave-out", "click", () => this.leaveOut());
    on("do-material", "change", () => this.material());
    this.form("density-form", "do-density", 1, ([density]) => ({ do: "material", parts: parts(), density }));
    this.form("mass-form", "do-mass", 1, ([mass]) => ({ do: "mass", part: parts()[0], mass }));
    this.form("load-form", "do-load", 3, (force) => {
      const { index, load } = this.edited ?? {};
      this.edited = null;
      return index === undefined ? { do: "load", part: parts()[0], force } : { ...load, do: "load", force, index };
    });
    this.form("move-form", "do-move", 3, (way) => bench.tabs.moveSupport(parts()[0], way));
    on("do-join", "click", () => this.join());
    for (const [name, as] of [["do-touching", "touching"], ["do-apart", "apart"], ["do-undecided", null]]) {
      on(name, "click", () => bench.act({ do: "pair", pairs: [parts()], as }));
    }
    this.form("pair-friction-form", "do-pair-friction", 1, ([mu]) => ({ do: "pair_friction", parts: parts(), mu }));
    this.form("bond-form", "do-bond", 1, ([pull]) => ({ do: "bond", parts: parts(), pull, shear: null }));
    on("do-joint", "change", () => this.jointRows());
    on("joint-form", "submit", (e) => {
      e.preventDefault();
      this.joint();
    });
  }

  /** Connect a form with a field of `count` numbers to an action; it may be none. */
  form(form, field, count, action) {
    on(form, "submit", (event) => {
      event.preventDefault();
      const numbers = numbersOf(id(field).value, count);
      const done = numbers && action(numbers);
      if (done) this.bench.act(done);
      else if (!numbers) this.bench.complain(count > 1 ? `Give ${count} numbers, separated by spaces.` : "Give a number.");
    });
  }

  /** Hold the selected parts, or release them if all are held. */
  hold() {
    return this.bench.act({ do: "hold", parts: this.names(), on: !this.allHeld() });
  }

  leaveOut() {
    return this.bench.act({ do: "leave_out", parts: this.names(), on: true });
  }

  join() {
    return this.bench.act({ do: "fasten", parts: this.names(), on: true });
  }

  /** Names of the selected parts in the file. */
  names() {
    const { report } = this.bench;
    return [...report.selection].map((k) => report.page.parts.full_names[k]);
  }

  /** Selected parts that the user can hold or release. */
  allHeld() {
    const { report } = this.bench;
    return [...report.selection].every((k) => report.page.parts.grounded[k]);
  }

  /** Show the actions that apply to the selection. */
  tell() {
    const { report, session } = this.bench;
    const list = [...report.selection];
    if (!list.length) return;
    const { parts } = report.page;
    const by = new Set(list.map((k) => parts.held_by?.[k]));
    const fixed = by.has("file") || by.has("floor") || by.has("assumed");
    id("do-hold").textContent = this.allHeld() ? "Release" : "Hold";
    id("do-hold").hidden = this.allHeld() && fixed;
    id("hold-note").hidden = !fixed;
    id("hold-note").textContent = by.has("floor")
      ? "The floor is held, and can be switched off below."
      : by.has("assumed")
        ? "A floor is assumed, since nothing is held: hold a part instead."
        : "The file itself holds this part.";
    id("do-leave-out").hidden = by.has("floor") || by.has("assumed");
    const single = list.length === 1;
    for (const name of ["mass-form", "load-form"]) id(name).hidden = !single || parts.grounded[list[0]];
    id("move-form").hidden = !single || !parts.grounded[list[0]] || by.has("assumed");
    id("pair-actions").hidden = list.length !== 2;
    this.materials(session.materials);
    if (!this.busy("density-form")) id("do-density").value = single && parts.density?.[list[0]] ? number(parts.density[list[0]], 6) : "";
    if (!this.busy("mass-form")) id("do-mass").value = single ? number(parts.mass[list[0]], 6) : "";
    if (list.length === 2) this.suggestJoint(list);
    this.jointRows();
  }

  busy(form) {
    return id(form).contains(document.activeElement);
  }

  materials(list) {
    const select = id("do-material");
    if (select.options.length !== list.length + 2) {
      select.replaceChildren(
        new Option("choose…", ""),
        ...list.map(({ name, density, source }) => {
          const option = new Option(`${name}, ${density} kg/m³`, name);
          option.title = source;
          return option;
        }),
        new Option("as in the file", "file"),
      );
    }
    const { report, session } = this.bench;
    const named = new Map((session.choices.materials ?? []).map((one) => [one.parts, one.name]));
    const names = new Set([...report.selection].map((k) => named.get(report.page.parts.full_names[k]) ?? ""));
    select.value = names.size === 1 ? [...names][0] : "";
  }

  material() {
    const name = id("do-material").value;
    if (!name) return;
    const found = this.bench.session.materials.find((one) => one.name === name);
    this.bench.act({ do: "material", parts: this.names(), density: found?.density ?? null, name: found?.name ?? null });
  }

  // loads -----------------------------------------------------------------------------

  /** Bring a load into the form, to change its force. */
  editLoad(load, index) {
    const { report } = this.bench;
    const k = report.page.parts.full_names.indexOf(load.part);
    if (k >= 0) report.select(k);
    this.edited = { index, load };
    id("do-load").value = load.force.join(" ");
    id("do-load").focus();
  }

  // joints ----------------------------------------------------------------------------

  /** Fill in the axis of the round face between two parts, or the middle of their contact. */
  suggestJoint(list) {
    const key = list.join();
    if (this.suggested === key) return;
    this.suggested = key;
    const found = roundAxis(this.bench.report.page, list);
    const { radius } = this.bench.report.page;
    // coordinates below the rounding error of the arrays are written as 0
    const write = (v, size) => (v ? v.map((c) => (Math.abs(c) < ROUNDING * size ? "0" : number(c, 6))).join(" ") : "");
    id("joint-point").value = write(found.point, radius);
    id("joint-axis").value = write(found.axis, 1);
    if (found.axis) id("do-joint").value = "revolute";
  }

  jointRows() {
    const kind = id("do-joint").value;
    id("joint-point-row").hidden = !POINT.includes(kind);
    id("joint-axis-row").hidden = !AXIS.includes(kind);
  }

  joint() {
    const kind = id("do-joint").value;
    const action = { do: "joint", parts: this.names(), kind };
    for (const [needed, name] of [[POINT, "point"], [AXIS, "axis"]]) {
      if (!needed.includes(kind)) continue;
      action[name] = numbersOf(id(`joint-${name}`).value, 3);
      if (!action[name]) {
        this.bench.complain(`Give the ${name} of the joint: 3 numbers, separated by spaces.`);
        return;
      }
    }
    this.bench.act(action);
  }

  // parts that are left out ------------------------------------------------------------

  tellLeftOut(names) {
    id("left-out-card").hidden = !names.length;
    refill(
      id("left-out"),
      ...names.map((name) => entry(this.bench.shortName(name), button("Bring back", () => this.bench.act({ do: "leave_out", parts: [name], on: false })))),
    );
  }
}
