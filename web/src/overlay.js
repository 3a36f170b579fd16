// Drawings over the parts: arrows of motion and of forces, lines of thrust, marks of open pairs.

import { reachOf } from "./pose.js";
import { resultants, thrust } from "./resultant.js";
import { norm, scaled } from "./vector.js";

const MANY = 6000; // with more force arrows, only the largest are shown

/** Arrows of the moving parts: straight for translation, round for rotation. */
export function motionArrows(stage, motion, moving, long) {
  const lists = { straight: [], round: [] };
  const { radius } = stage.page.parts;
  const scale = reachOf(motion, radius, long);
  for (const k of moving) {
    const m = motion.subarray(6 * k, 6 * k + 6);
    const at = stage.parts.centre(k);
    if (!stage.parts.seen(k, at)) continue;
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

/**
 * Arrows of the contact forces, all to one scale. An arrow acts on the second part of its pair;
 * if that part is hidden or cut away, the opposite force on the first part is drawn. `each`: one
 * arrow per point instead of one per patch. Returns `straight`, the arrows; `most`, the largest
 * force [N]; `shown`, the forces that are drawn [N]; `all`, the resultants of all patches.
 */
export function forceArrows(stage, forces, long, each = false) {
  const all = resultants(stage.page, forces, each);
  const sizes = all.map((resultant) => norm(resultant.force));
  const most = sizes.reduce((a, b) => Math.max(a, b), 0);
  const order = sizes.map((_, k) => k).filter((k) => sizes[k] > 1e-9 * most);
  order.sort((a, b) => sizes[b] - sizes[a]);
  const [straight, shown] = [[], []];
  for (const k of order.slice(0, MANY)) {
    const { at: rest, parts, force, use, bond } = all[k];
    for (const [part, sign] of [[parts[1], 1], [parts[0], -1]]) {
      const at = stage.parts.placeOf(part, rest);
      if (!stage.parts.seen(part, at)) continue;
      const size = (long * sizes[k]) / most;
      const along = scaled(force, sign);
      straight.push({ at, along, size, wide: Math.max(0.8 * size, 0.15 * long), tint: Math.max(use || 0, bond || 0) });
      shown.push({ part, other: parts[sign > 0 ? 0 : 1], force: along, at, use, bond });
      break;
    }
  }
  return { straight, most, shown, all };
}

/** Rods along the line of thrust; each moves with its part. */
export function thrustRods(stage, all, long) {
  const rod = [];
  for (const { part, from, to } of thrust(stage.page, all)) {
    const [a, b] = [stage.parts.placeOf(part, from), stage.parts.placeOf(part, to)];
    const along = b.map((c, i) => c - a[i]);
    const size = norm(along);
    if (size > 0 && stage.parts.seen(part, a) && stage.parts.seen(part, b)) {
      rod.push({ at: a, along, size, wide: 0.35 * long, tint: 0 });
    }
  }
  return rod;
}

/** A ball at each open pair; it moves with the second part. */
export function openMarks(stage) {
  const { at, parts } = stage.page.open;
  const size = 0.03 * stage.page.radius;
  const balls = [];
  for (let k = 0; k < parts.length / 2; k += 1) {
    const [first, second] = parts.subarray(2 * k, 2 * k + 2);
    if (stage.page.open.decides && !stage.page.open.decides[k]) continue; // it does not change the verdict
    const now = stage.parts.placeOf(second, at.subarray(3 * k, 3 * k + 3));
    if (!stage.parts.seen(first, now) && !stage.parts.seen(second, now)) continue;
    balls.push({ at: now, along: [0, 1, 0], size });
  }
  return { ball: balls };
}

/** Rods along the straps of a page: polylines in the frame of the assembly. */
export function strapRods({ straps = [], radius }) {
  const rod = straps.flatMap((points) =>
    points.slice(1).map((to, k) => {
      const along = to.map((c, i) => c - points[k][i]);
      return { at: points[k], along, size: norm(along), wide: 0.1 * radius };
    }),
  );
  return { rod: rod.filter(({ size }) => size > 0) };
}

/** Largest bond use of each part, pull over strength, 0 to 1; null without bonds or forces. */
export function bondUse(page, forces) {
  if (!forces || !forces.pull) return null;
  const most = new Float32Array(page.parts.names.length);
  for (const { parts, bond } of resultants(page, forces)) {
    for (const part of parts) most[part] = Math.max(most[part], bond || 0);
  }
  return most;
}
