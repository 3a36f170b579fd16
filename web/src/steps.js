// The plan as a film: positions of the parts at a time [steps]. No drawing.

const MOVES = 0.82; // the part moves during this share of a step, then rests in its seat
const NEAR = 1.2; // distance of the part from its seat in the picture of a step [part radius]
const TURNS = 3; // turns of a nut on its thread, for illustration

/** The step of a time [steps], and the share of the step that is done, from 0 to 1. */
export function stepAt(steps, time) {
  const k = Math.max(0, Math.min(steps.length - 1, Math.floor(time)));
  return [k, Math.max(0, Math.min(1, time - k))];
}

/** Lengths of the segments of a path; the last point of the path is the seat. */
const lengths = (path) =>
  path.slice(1).map((place, k) => Math.hypot(...place.map((c, i) => c - path[k][i])));

/** A path whose first segment is cut to at most `reach`. */
export function clipped(path, reach) {
  const first = lengths(path)[0];
  if (!(first > reach)) return path;
  const share = reach / first;
  return [path[1].map((c, i) => c + share * (path[0][i] - c)), ...path.slice(1)];
}

export const lengthOf = (path) => lengths(path).reduce((a, b) => a + b, 0);

/** A point at distance `left` before the end of a path: its place, the direction and the distance to the next corner. */
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

/** Smoothstep from 0 to 1. */
const gently = (t) => t * t * (3 - 2 * t);

/**
 * State of the film at a time: `present`, `moving` and `gripped` parts, and the position of the
 * moving parts relative to their seat (`on`). The parts of a step are absent before it begins.
 */
export function sceneAt(plan, time, reach) {
  const { steps, base } = plan;
  const [k, done] = stepAt(steps, time);
  const step = steps[k];
  const present = new Set(base);
  steps.slice(0, k).forEach(({ parts }) => parts.forEach((part) => present.add(part)));
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

/** Remaining rotation of a nut before its seat [rad]; the thread is right-handed. */
function turnLeft(step, left) {
  const thread = step.thread || 0;
  return thread ? -2 * Math.PI * TURNS * Math.min(1, left / thread) : 0;
}

/** Time of the picture of step k [steps], when the part is close to its seat; by bisection. */
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
