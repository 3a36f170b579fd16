// The axis of a round contact between two parts, for the joint that the user adds. No drawing.

import { add, cross, dot, norm, scaled, unit } from "../vector.js";

const at3 = (array, k) => [array[3 * k], array[3 * k + 1], array[3 * k + 2]];
const LEANS = 1e-3; // normals whose cross product is shorter than this do not define an axis [-]

/**
 * Axis and point of the contact of two parts: {point, axis}, in the frame of the file. The normals
 * n of a round contact are perpendicular to its axis, and the lines p + t n meet on the axis. A flat
 * contact has the mean of its points and no axis; without a contact both are null.
 */
export function roundAxis(page, [first, second]) {
  const { parts, start, points, normals, normal } = page.patches;
  const found = [];
  for (let p = 0; p + 1 < start.length; p += 1) {
    const [a, b] = [parts[2 * p], parts[2 * p + 1]];
    if (!((a === first && b === second) || (a === second && b === first))) continue;
    for (let k = start[p]; k < start[p + 1]; k += 1) {
      found.push({ at: at3(points, k), n: normals ? at3(normals, k) : at3(normal, p) });
    }
  }
  if (!found.length) return { point: null, axis: null };
  const middle = scaled(found.reduce((sum, { at }) => add(sum, at), [0, 0, 0]), 1 / found.length);
  const place = (point) => add(point, page.center);
  const axis = found.reduce((sum, { n }) => {
    const across = cross(found[0].n, n);
    return add(sum, scaled(across, dot(across, sum) < 0 ? -1 : 1));
  }, [0, 0, 0]);
  if (norm(axis) < LEANS) return { point: place(middle), axis: null };
  const along = unit(axis);
  if (found.some(({ n }) => Math.abs(dot(n, along)) > LEANS)) return { point: place(middle), axis: null };
  // two lines along normals meet at the axis: p + s n = q + t m, in the plane across the axis
  const [one, other] = [found[0], found.find(({ n }) => norm(cross(found[0].n, n)) > LEANS)];
  const apart = add(other.at, scaled(one.at, -1));
  const turned = cross(other.n, along);
  const share = dot(apart, turned) / dot(one.n, turned);
  const on = add(one.at, scaled(one.n, share));
  return { point: place(add(on, scaled(along, dot(add(middle, scaled(on, -1)), along)))), axis: along };
}
