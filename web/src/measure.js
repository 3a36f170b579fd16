// The measuring tool: two points on parts, or two selected parts.

import { copyText } from "./clipboard.js";
import { id, on } from "./dom.js";
import { corners, measured } from "./surface.js";
import { degrees, direction, number, short } from "./words.js";

const SNAP = 9; // a click within this distance of a corner measures from the corner [CSS px]

export class Measure {
  constructor(look) {
    this.look = look;
    this.ends = [];
    this.on = false;
    on("measure", "click", () => this.toggle());
    on("end-measure", "click", () => this.toggle(false));
    on("copy-measured", "click", () => copyText(this.words, id("copy-measured")));
  }

  /** Begin to measure, or end it. Two selected parts are measured at once. */
  toggle(on_ = !this.on) {
    const { look } = this;
    this.on = on_;
    this.ends = [];
    if (on_ && look.selection.size === 2) this.ends = [...look.selection].map((k) => this.middle(k));
    id("measure").setAttribute("aria-pressed", String(on_));
    document.body.classList.toggle("measuring", on_);
    this.show();
  }

  /** The centre of mass of a part as an end of a measured distance. */
  middle(part) {
    const at = [...this.look.page.parts.center.subarray(3 * part, 3 * part + 3)];
    return { part, at, what: "centre of " };
  }

  /** Take the point under the pointer [CSS px] as the next end. */
  click(x, y) {
    const end = this.end(x, y);
    if (!end) return;
    if (this.ends.length > 1) this.ends = [];
    this.ends.push(end);
    this.show();
  }

  end(x, y) {
    const { stage } = this.look;
    const hit = stage.hit(x, y);
    if (!hit) return null;
    const shape = stage.shapeOf(hit.part);
    let [best, least] = [null, SNAP];
    for (const corner of corners(shape)) {
      const now = stage.parts.carried(hit.part, corner);
      const seen = stage.onScreen(now);
      const away = seen ? Math.hypot(seen[0] - x, seen[1] - y) : Infinity;
      if (away < least) [best, least] = [corner, away];
    }
    const { part } = hit;
    if (best) return { part, at: stage.parts.rest(part, best), what: "corner of " };
    const [from, to] = [hit.local, hit.local.map((c, i) => c + hit.normal[i])].map((p) => stage.parts.rest(part, p));
    return { part, at: from, normal: to.map((c, i) => c - from[i]), what: "" };
  }

  /** Write the distance, and mark its ends. */
  show() {
    const { page, stage } = this.look;
    id("measured").hidden = !this.on;
    id("copy-measured").hidden = this.ends.length < 2;
    this.words = this.ends.length < 2 ? "" : this.tell();
    const next = this.ends.length
      ? `From ${this.name(this.ends[0])}. Click the second point.`
      : "Click two points of parts. Near a corner, the corner counts. Two selected parts are measured between their centres.";
    id("measured-words").textContent = this.words || next;
    stage.gauge.set(this.on ? this.marks(page, stage) : {});
    stage.draw();
    this.look.legend();
  }

  name({ part, at, what }) {
    const { page } = this.look;
    const place = direction(at.map((c, i) => c + page.center[i]), 5);
    return `${what}${short(page.parts.tails[part])} at ${place}`;
  }

  tell() {
    const { units } = this.look.page;
    const { distance, step, angle, between } = measured(...this.ends);
    const [dx, dy, dz] = step.map((c) => number(c, 6).replace("-", "−"));
    const lines = [`distance ${number(distance, 6)} ${units}; dx ${dx}, dy ${dy}, dz ${dz} ${units}`];
    if (between !== null) lines.push(`parallel faces, ${number(between, 6)} ${units} apart`);
    else if (angle !== null) lines.push(`angle between the surfaces there ${degrees(angle)}`);
    lines.push(`from ${this.name(this.ends[0])} to ${this.name(this.ends[1])}`);
    return lines.join("\n");
  }

  /** Balls at the ends and a rod between them, at the current positions of the parts. */
  marks(page, stage) {
    const size = 0.014 * page.radius;
    const at = this.ends.map((end) => stage.parts.placeOf(end.part, end.at));
    const ball = at.map((place) => ({ at: place, along: [0, 1, 0], size }));
    if (at.length < 2) return { ball };
    const along = at[1].map((c, i) => c - at[0][i]);
    const length = Math.hypot(...along);
    return { ball, rod: length ? [{ at: at[0], along, size: length, wide: 8 * size }] : [] };
  }

  /** Place the marks again, after the parts have moved. */
  follow() {
    if (this.on) this.look.stage.gauge.set(this.marks(this.look.page, this.look.stage));
  }

  /** Forget the measured points, because the parts were replaced. */
  clear() {
    this.ends = [];
    if (this.on) this.show();
  }
}
