// Points on the surfaces of parts: where a line of sight meets a part. No drawing.

import { add, cross, dot, norm, scaled, unit } from "./vector.js";

const at3 = (array, k) => [array[3 * k], array[3 * k + 1], array[3 * k + 2]];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];

/**
 * First point at which a ray meets a shape, in the frame of the shape: {point, normal, far}, with
 * `far` in lengths of `along`; null without such a point. `counts(point)` may reject points.
 */
export function meet(shape, from, along, counts = () => true) {
  const { positions, triangles } = shape;
  let best = null;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((i) => at3(positions, triangles[t + i]));
    const [u, v] = [minus(b, a), minus(c, a)];
    const across = cross(along, v);
    const scale = dot(u, across);
    if (Math.abs(scale) < 1e-300) continue;
    const start = minus(from, a);
    const x = dot(start, across) / scale;
    if (x < 0 || x > 1) continue;
    const turned = cross(start, u);
    const y = dot(along, turned) / scale;
    if (y < 0 || x + y > 1) continue;
    const far = dot(v, turned) / scale;
    if (far <= 0 || (best && far >= best.far)) continue;
    const point = add(from, scaled(along, far));
    if (counts(point)) best = { point, normal: unit(cross(u, v)), far };
  }
  return best;
}

/** Corners of a shape: the distinct ends of its drawn edges, in its frame. */
export function corners(shape) {
  const seen = new Set();
  const result = [];
  for (const k of shape.edges) {
    const point = at3(shape.positions, k);
    const key = point.join();
    if (!seen.has(key)) result.push(point);
    seen.add(key);
  }
  return result;
}

/**
 * Measure from one point to another: {distance, step, angle, between}. `angle` is between the
 * planes at the points [rad], null without two normals; `between` is the distance of parallel
 * planes, null for other planes. Lengths of the size of rounding errors are 0.
 */
export function measured(first, second) {
  const given = minus(second.at, first.at);
  const least = EXACT * Math.max(...first.at.map(Math.abs), ...second.at.map(Math.abs));
  const rounded = (length) => (Math.abs(length) < least ? 0 : length);
  const step = given.map(rounded);
  const result = { distance: norm(step), step, angle: null, between: null };
  if (!first.normal || !second.normal) return result;
  const sine = norm(cross(first.normal, second.normal));
  result.angle = Math.atan2(sine, Math.abs(dot(first.normal, second.normal)));
  if (sine < PARALLEL) result.between = Math.abs(rounded(dot(given, first.normal)));
  return result;
}

const EXACT = 1e-6; // lengths below this fraction of the coordinates are their rounding error [-]
const PARALLEL = 1e-4; // planes are parallel if the sine of their angle is less than this [-]
