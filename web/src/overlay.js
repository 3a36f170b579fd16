// What lies over the parts: arrows of motion and of forces, names.

import { reachOf } from "./pose.js";
import { local } from "./pose.js";
import { short } from "./words.js";

const MANY = 1500; // arrows of forces; above, the largest are shown

/** Arrows along the motion of each moving part: straight, and round where it turns. */
export function motionArrows(stage, motion, moving, long) {
  const lists = { straight: [], round: [] };
  const { radius } = stage.page.parts;
  const scale = reachOf(motion, radius, long);
  for (const k of moving) {
    if (!stage.parts.shown(k)) continue;
    const m = motion.subarray(6 * k, 6 * k + 6);
    const at = stage.parts.centre(k);
    const far = scale * Math.hypot(m[0], m[1], m[2]);
    const swing = scale * radius[k] * Math.hypot(m[3], m[4], m[5]);
    const least = 0.02 * long;
    if (far > least) {
      const size = Math.max(far, 0.3 * long);
      lists.straight.push({ at, along: m.subarray(0, 3), size, wide: Math.max(size, 0.6 * long) });
    }
    if (swing > least) {
      lists.round.push({ at, along: m.subarray(3, 6), size: 0.45 * radius[k] });
    }
  }
  return lists;
}

/** Arrows of contact forces, all to one scale: each on its second part. Returns the largest [N]. */
export function forceArrows(stage, forces, long) {
  const { points, parts, forces: f } = forces;
  const sizes = Array.from({ length: points.length / 3 }, (_, k) =>
    Math.hypot(f[3 * k], f[3 * k + 1], f[3 * k + 2]),
  );
  const most = sizes.reduce((a, b) => Math.max(a, b), 0);
  const order = sizes.map((_, k) => k).filter((k) => sizes[k] > 0.004 * most);
  order.sort((a, b) => sizes[b] - sizes[a]);
  const straight = [];
  for (const k of order.slice(0, MANY)) {
    const second = parts[2 * k + 1];
    if (!stage.parts.shown(second)) continue;
    const rest = points.subarray(3 * k, 3 * k + 3);
    const at = stage.parts.carried(second, local(stage.page.parts, second, rest));
    const size = (long * sizes[k]) / most;
    straight.push({
      at,
      along: f.subarray(3 * k, 3 * k + 3),
      size,
      wide: Math.max(0.8 * size, 0.15 * long),
    });
  }
  return { straight, most };
}

/** A ball where each open pair meets; it goes with the second part. */
export function openMarks(stage) {
  const { at, parts } = stage.page.open;
  const size = 0.03 * stage.page.radius;
  const balls = [];
  for (let k = 0; k < parts.length / 2; k += 1) {
    const [first, second] = parts.subarray(2 * k, 2 * k + 2);
    if (!stage.parts.shown(first) && !stage.parts.shown(second)) continue;
    const rest = at.subarray(3 * k, 3 * k + 3);
    const carried = stage.parts.carried(second, local(stage.page.parts, second, rest));
    balls.push({ at: carried, along: [0, 1, 0], size });
  }
  return { ball: balls };
}

/** Names over the parts, as text. */
export class Names {
  constructor(element, stage) {
    Object.assign(this, { element, stage });
    this.tags = new Map();
  }

  /** Names for these parts. */
  show(list) {
    this.element.replaceChildren();
    this.element.hidden = !list.length;
    this.tags = new Map(
      list.map((k) => {
        const tag = document.createElement("span");
        tag.textContent = short(this.stage.page.parts.names[k], 24);
        this.element.append(tag);
        return [k, tag];
      }),
    );
    this.place();
  }

  place() {
    for (const [k, tag] of this.tags) {
      const at = this.stage.parts.shown(k) && this.stage.onScreen(this.stage.parts.centre(k));
      tag.hidden = !at;
      if (at) tag.style.transform = `translate(${at[0]}px, ${at[1]}px) translate(-50%, -50%)`;
    }
  }
}
