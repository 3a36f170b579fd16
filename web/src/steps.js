// The plan as a film: where every part is at a time, counted in steps. No drawing.

const MOVES = 0.82; // of a step; then the part rests in its seat
const NEAR = 1.7; // radii of the part: how far from its seat a picture of a step shows it
const TURNS = 3; // of a nut on its thread: for the picture alone

/** Which step a time is in, and how much of it is done: from 0 to 1. */
export function stepAt(steps, time) {
  const k = Math.max(0, Math.min(steps.length - 1, Math.floor(time)));
  return [k, Math.max(0, Math.min(1, time - k))];
}

/** Lengths of the pieces of a way, given by its places, the seat last. */
const lengths = (path) =>
  path.slice(1).map((place, k) => Math.hypot(...place.map((c, i) => c - path[k][i])));

/** A way that begins no farther from where it first turns than `reach`. */
export function clipped(path, reach) {
  const first = lengths(path)[0];
  if (!(first > reach)) return path;
  const share = reach / first;
  return [path[1].map((c, i) => c + share * (path[0][i] - c)), ...path.slice(1)];
}

export const lengthOf = (path) => lengths(path).reduce((a, b) => a + b, 0);

/** The place on a way so far before its end, how far the next turn is, and the way there. */
export function placeOn(path, left) {
  const sizes = lengths(path);
  for (let k = sizes.length - 1; k >= 0; k -= 1) {
    if (left <= sizes[k] || k === 0) {
      const share = sizes[k] ? Math.min(1, left / sizes[k]) : 0;
      const [from, to] = [path[k], path[k + 1]];
      return {
        place: to.map((c, i) => c + share * (from[i] - c)),
        heading: to.map((c, i) => (c - from[i]) / (sizes[k] || 1)),
        ahead: share * sizes[k],
      };
    }
    left -= sizes[k];
  }
  return { place: [0, 0, 0], heading: [0, 0, 0], ahead: 0 };
}

/** From 0 to 1, gently at both ends. */
const gently = (t) => t * t * (3 - 2 * t);

/**
 * What is there at a time: `present` parts, the `moving` ones, those that hands hold, and where
 * the moving ones are before their seat. Nothing of a step is there before it begins.
 */
export function sceneAt(plan, time, reach) {
  const { steps, base } = plan;
  const [k, done] = stepAt(steps, time);
  const step = steps[k];
  const present = new Set(base);
  steps.slice(0, k).forEach((one) => one.parts.forEach((part) => present.add(part)));
  const path = clipped(step.path, reach);
  const left = lengthOf(path) * (1 - gently(Math.min(1, done / MOVES)));
  if (done > 0) step.parts.forEach((part) => present.add(part));
  return {
    step: k,
    done,
    present,
    moving: done > 0 && done < 1 ? step.parts : [],
    gripped: done < 1 ? step.held : [],
    on: done > 0 ? placeOn(path, left) : null,
    turn: step.over === null ? 0 : turnLeft(step, left),
  };
}

/** How far a nut still has to turn [rad]; it advances along a right-handed thread. */
function turnLeft(step, left) {
  const thread = step.thread || 0;
  return thread ? -2 * Math.PI * TURNS * Math.min(1, left / thread) : 0;
}

/** The time at which a picture of a step is taken: the part is close to its seat. */
export function pictureTime(plan, k, radius, reach) {
  const path = clipped(plan.steps[k].path, reach);
  const whole = lengthOf(path);
  const wanted = Math.min(0.9 * whole, NEAR * radius);
  let [low, high] = [0, 1];
  for (let n = 0; n < 30; n += 1) {
    const middle = (low + high) / 2;
    if (whole * (1 - gently(middle)) > wanted) low = middle;
    else high = middle;
  }
  return k + MOVES * high;
}
