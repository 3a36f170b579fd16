// Parallel projection of the unit sphere: directions to points of the disc and back, exactly.

import { add, cross, dot, norm, scaled, unit, without } from "./vector.js";

/**
 * The view of a sphere: `front` points to the eye, `up` and `right` span the disc; all in the
 * frame of the assembly. `azimuth` turns about `above`, `elevation` lifts the eye [rad].
 */
export function sphereView(above, azimuth, elevation) {
  const ahead = Math.abs(above[1]) > 0.9 ? [0, 0, 1] : [0, -1, 0];
  const first = unit(without(ahead, above));
  const second = cross(above, first);
  const level = add(scaled(first, Math.cos(azimuth)), scaled(second, Math.sin(azimuth)));
  const front = add(scaled(level, Math.cos(elevation)), scaled(above, Math.sin(elevation)));
  const right = unit(cross(above, level));
  return { front, right, up: cross(front, right) };
}

/** Coordinates of a direction on the disc: x right, y up, z towards the eye. */
export const onDisc = (view, u) => [dot(u, view.right), dot(u, view.up), dot(u, view.front)];

/**
 * The direction under a point of the disc. Beyond the edge it continues on the far side: at
 * twice the radius it points away from the eye.
 */
export function underPoint(view, x, y) {
  const r = Math.hypot(x, y);
  const [s, c] =
    r <= 1
      ? [r, Math.sqrt(Math.max(0, 1 - r * r))]
      : [Math.cos((Math.PI / 2) * Math.min(r - 1, 1)), -Math.sin((Math.PI / 2) * Math.min(r - 1, 1))];
  const side = r > 0 ? add(scaled(view.right, x / r), scaled(view.up, y / r)) : [0, 0, 0];
  return unit(add(scaled(side, s), scaled(view.front, c)));
}

/** A direction projected into the x-z plane. */
export function inPlane(u) {
  const flat = [u[0], 0, u[2]];
  return norm(flat) > 1e-9 ? unit(flat) : [0, 0, -1];
}

/** Azimuth and elevation of an eye from which a direction is well visible [rad]. */
export function eyeFor(above, u) {
  const { front, right } = sphereView(above, 0, 0);
  const azimuth = Math.atan2(dot(u, right), dot(u, front));
  const elevation = Math.asin(Math.max(-1, Math.min(1, dot(u, above))));
  return [azimuth, 0.7 * elevation];
}
