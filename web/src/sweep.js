// The largest amount of a motion without overlap of parts, by stepping along the motion.
//
// A part overlaps another if one of its edges lies deeper in it than DEEP. For a convex part the
// test is exact: the edge is clipped by the planes of the part, moved inwards by DEEP. For other
// parts, the depth of sample points of the edge between its crossings of the surface is computed.

import { size } from "./map.js";
import { posed, turned } from "./pose.js";
import { add, cross, dot, norm, scaled } from "./vector.js";

const DEEP = 4e-4; // tolerated depth, for rounding and facets [radius of the smaller part]
const STEPS = 24;
const HALVINGS = 10;
const WORK = 3e7; // limit on edge-plane and edge-triangle tests; beyond it the sweep stops
const SAMPLES = 5; // sample points of an edge between two crossings

const less = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const forms = new WeakMap();

/** Corners, edges, triangles, box and (for a convex shape) planes of a shape; cached. */
export function formOf(shape) {
  if (!forms.has(shape)) forms.set(shape, buildForm(shape));
  return forms.get(shape);
}

function buildForm({ positions, triangles }) {
  const corners = [];
  for (let k = 0; k < positions.length; k += 3) corners.push([...positions.subarray(k, k + 3)]);
  const [edges, planes, reach] = [new Map(), new Map(), Math.max(...corners.map(norm))];
  for (let t = 0; t < triangles.length; t += 3) {
    const three = [...triangles.subarray(t, t + 3)];
    for (let i = 0; i < 3; i += 1) {
      const pair = [three[i], three[(i + 1) % 3]].sort((a, b) => a - b);
      edges.set(pair.join(), pair);
    }
    const [a, b, c] = three.map((k) => corners[k]);
    const normal = cross(less(b, a), less(c, a));
    if (!(norm(normal) > 1e-12 * reach * reach)) continue;
    const n = scaled(normal, 1 / norm(normal));
    const plane = { n, d: dot(n, a) };
    planes.set([...n, plane.d / reach].map((v) => Math.round(v * 1e4)).join(), plane);
  }
  const sides = [...planes.values()];
  const convex = sides.every(({ n, d }) => corners.every((x) => dot(n, x) < d + 1e-5 * reach));
  const low = [0, 1, 2].map((i) => Math.min(...corners.map((x) => x[i])));
  const high = [0, 1, 2].map((i) => Math.max(...corners.map((x) => x[i])));
  return { corners, edges: [...edges.values()], triangles, planes: convex ? sides : null, low, high };
}

/**
 * The largest amount of a motion, up to `most`, without overlap. The depth at rest plus DEEP is
 * tolerated, so that parts that overlap at rest can move.
 */
export function clearAmount(page, motion, most) {
  const work = { left: WORK };
  const pairs = nearPairs(page, motion, most).map(([a, b]) => {
    let deep = DEEP * Math.min(page.parts.radius[a], page.parts.radius[b]);
    for (let k = 0; k < 24 && enters(page, null, 0, a, b, deep, work); k += 1) deep *= 2;
    return [a, b, deep];
  });
  const free = (amount) =>
    pairs.every(([a, b, deep]) => !enters(page, motion, amount, a, b, deep, work)) && work.left > 0;
  let low = 0;
  for (let k = 1; k <= STEPS; k += 1) {
    let high = (k * most) / STEPS;
    if (free(high)) {
      low = high;
      continue;
    }
    for (let n = 0; n < HALVINGS; n += 1) {
      const middle = (low + high) / 2;
      if (free(middle)) low = middle;
      else high = middle;
    }
    return low;
  }
  return most;
}

/** Pairs of parts with at least one moving part whose swept bounding spheres meet. */
function nearPairs(page, motion, most) {
  const { center, radius, position } = page.parts;
  const far = Array.from(radius, (r, k) => most * size(motion, k, r));
  const wide = Array.from(radius, (r, k) => r + far[k]);
  const order = [...radius.keys()].sort((a, b) => center[3 * a] - wide[a] - center[3 * b] + wide[b]);
  const pairs = [];
  let open = [];
  for (const k of order) {
    open = open.filter((j) => center[3 * j] + wide[j] >= center[3 * k] - wide[k]);
    for (const j of open) {
      if (!far[j] && !far[k]) continue;
      const apart = [0, 1, 2].map((i) => center[3 * j + i] - center[3 * k + i]);
      if (norm(apart) < wide[j] + wide[k]) pairs.push([j, k]);
    }
    open.push(k);
  }
  return position.length ? pairs : [];
}

/** Whether an edge of one of two parts lies deeper in the other than `deep`. */
export function enters(page, motion, amount, a, b, deep, work = { left: Infinity }) {
  const [formA, formB] = [a, b].map((k) => formOf(page.shapes[page.parts.shape[k]]));
  const [placeA, placeB] = [a, b].map((k) => posed(page.parts, k, motion, amount, 0));
  return (
    into(formA, placeA, formB, placeB, deep, work) || into(formB, placeB, formA, placeA, deep, work)
  );
}

/** Whether an edge of the first shape lies deeper in the second than `deep`. */
function into(form, [q, p], other, [turnBack, origin], deep, work) {
  const [x, y, z, w] = turnBack;
  const inverse = [-x, -y, -z, w];
  const corners = form.corners.map((c) => turned(inverse, less(add(turned(q, c), p), origin)));
  const near = form.edges.filter(([i, j]) =>
    [0, 1, 2].every(
      (k) =>
        Math.max(corners[i][k], corners[j][k]) > other.low[k] + deep &&
        Math.min(corners[i][k], corners[j][k]) < other.high[k] - deep,
    ),
  );
  work.left -= form.corners.length + near.length * (other.planes || other.triangles).length;
  if (work.left < 0) return true;
  const test = other.planes ? clipped : crossed;
  return near.some(([i, j]) => test(corners[i], corners[j], other, deep));
}

/** Whether a piece of a segment lies behind all planes of a convex shape, moved inwards by `deep`. */
function clipped(a, b, { planes }, deep) {
  let [from, to] = [0, 1];
  for (const { n, d } of planes) {
    const [ha, hb] = [dot(n, a) - d + deep, dot(n, b) - d + deep];
    if (ha >= 0 && hb >= 0) return false;
    if (ha > 0) from = Math.max(from, ha / (ha - hb));
    else if (hb > 0) to = Math.min(to, ha / (ha - hb));
    if (from >= to) return false;
  }
  return true;
}

/** Whether a sample point of a segment lies deeper than `deep` in a shape that is not convex. */
function crossed(a, b, form, deep) {
  const along = less(b, a);
  const cuts = [0, 1, ...eachTriangle(form, (p, q, r) => crossing(a, along, p, q, r))]
    .filter((t) => t !== null)
    .sort((s, t) => s - t);
  for (let k = 0; k + 1 < cuts.length; k += 1) {
    for (let n = 0; n < SAMPLES; n += 1) {
      const t = cuts[k] + ((cuts[k + 1] - cuts[k]) * n) / (SAMPLES - 1);
      if (isDeep(add(a, scaled(along, t)), form, deep)) return true;
    }
  }
  return false;
}

/** Whether a point is inside a shape and farther than `deep` from every triangle. */
function isDeep(x, form, deep) {
  let turns = 0;
  let close = false;
  eachTriangle(form, (...three) => {
    close = close || distanceTo(x, ...three) < deep;
    turns += close ? 0 : solidAngle(x, ...three);
  });
  return !close && turns > 2 * Math.PI;
}

function eachTriangle({ corners, triangles }, action) {
  const results = [];
  for (let t = 0; t < triangles.length; t += 3) {
    results.push(action(...[0, 1, 2].map((i) => corners[triangles[t + i]])));
  }
  return results;
}

/** The t with 0 < t < 1 at which a + t along crosses a triangle; null without a crossing. */
function crossing(a, along, p, q, r) {
  const n = cross(less(q, p), less(r, p));
  const slope = dot(n, along);
  if (slope === 0) return null;
  const t = dot(n, less(p, a)) / slope;
  if (!(t > 0 && t < 1)) return null;
  const x = add(a, scaled(along, t));
  const sides = [[p, q], [q, r], [r, p]].map(([u, v]) => dot(n, cross(less(v, u), less(x, u))));
  return sides.every((side) => side >= -1e-9 * dot(n, n)) ? t : null;
}

/** Solid angle of a triangle seen from a point, after van Oosterom and Strackee. */
function solidAngle(x, ...three) {
  const [a, b, c] = three.map((corner) => less(corner, x));
  const [la, lb, lc] = [norm(a), norm(b), norm(c)];
  const below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return 2 * Math.atan2(dot(a, cross(b, c)), below);
}

/** Distance of a point from a triangle: over its face, or to its nearest edge. */
export function distanceTo(x, p, q, r) {
  const n = cross(less(q, p), less(r, p));
  const pairs = [[p, q], [q, r], [r, p]];
  const over = pairs.every(([u, v]) => dot(n, cross(less(v, u), less(x, u))) >= 0);
  if (over && norm(n) > 0) return Math.abs(dot(n, less(x, p))) / norm(n);
  return Math.min(
    ...pairs.map(([u, v]) => {
      const side = less(v, u);
      const share = Math.max(0, Math.min(1, dot(less(x, u), side) / (dot(side, side) || 1)));
      return norm(less(x, add(u, scaled(side, share))));
    }),
  );
}
