// Dragging the tip of the arrow of a load: the force follows, in the plane of the screen.

import { add, norm, scaled } from "../vector.js";

const REACH = 12; // a pointer within this distance of a tip takes the arrow [CSS px]
const DIGITS = 3; // digits of a dragged force

export class LoadDrag {
  constructor(bench, canvas) {
    Object.assign(this, { bench, canvas, taken: null });
    canvas.addEventListener("pointerdown", (e) => this.press(e), { capture: true });
    canvas.addEventListener("pointermove", (e) => this.move(e), { capture: true });
    canvas.addEventListener("pointerup", (e) => this.release(e), { capture: true });
    canvas.addEventListener("pointercancel", () => this.drop());
  }

  place(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  /** Loads that the user added: {load, index, from, tip}, with the ends of their arrows. */
  arrows() {
    const { report, session } = this.bench;
    const { loads } = report.page;
    const own = session.choices.loads ?? [];
    const first = loads.length - own.length; // the loads of the file come first
    const scale = report.loadScale();
    return loads.slice(first).map((load, index) => {
      const from = report.stage.parts.placeOf(load.part, load.point);
      return { load, index, from, tip: add(from, scaled(load.force, scale)) };
    });
  }

  press(event) {
    if (event.button || event.shiftKey || this.bench.report.measure.on) return;
    const { stage } = this.bench.report;
    const [x, y] = this.place(event);
    const near = ({ tip }) => {
      const seen = stage.onScreen(tip);
      return seen ? Math.hypot(seen[0] - x, seen[1] - y) : Infinity;
    };
    const [best] = this.arrows().sort((a, b) => near(a) - near(b));
    if (!best || near(best) > REACH) return;
    event.stopImmediatePropagation(); // the view does not turn
    this.canvas.setPointerCapture(event.pointerId);
    const scale = this.bench.report.loadScale();
    this.bench.report.fixedScale = scale;
    this.taken = { ...best, scale, force: [...best.load.force], moved: false };
  }

  move(event) {
    if (!this.taken) return;
    event.stopImmediatePropagation();
    const { report } = this.bench;
    const { load, from, tip, scale } = this.taken;
    const at = report.stage.underPlane(this.place(event), tip);
    const force = scaled(add(at, scaled(from, -1)), 1 / scale);
    const round = 10 ** (Math.floor(Math.log10(norm(force) || 1)) + 1 - DIGITS);
    this.taken.force = force.map((c) => Number((Math.round(c / round) * round).toPrecision(DIGITS + 3)));
    this.taken.moved = true;
    load.force = this.taken.force;
    report.repose();
  }

  /** Let the arrow go. */
  drop() {
    this.taken = null;
    this.bench.report.fixedScale = 0;
  }

  release(event) {
    if (!this.taken) return;
    event.stopImmediatePropagation();
    const { index, force, moved } = this.taken;
    this.drop();
    if (!moved || !norm(force)) return;
    const load = this.bench.session.choices.loads[index];
    this.bench.act({ ...load, do: "load", force, index });
  }
}
