// Vectors of three numbers, as plain arrays.

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1],
  a[2] * b[0] - a[0] * b[2],
  a[0] * b[1] - a[1] * b[0],
];
export const norm = (a) => Math.hypot(a[0], a[1], a[2]);

/** A vector scaled to length 1; the zero vector stays zero. */
export function unit(a) {
  const length = norm(a);
  return length > 0 ? scaled(a, 1 / length) : [0, 0, 0];
}

/** The angle between two vectors [rad], exact near 0 and near a half turn. */
export function angleBetween(a, b) {
  return Math.atan2(norm(cross(a, b)), dot(a, b));
}

/** A vector without its component along a unit vector. */
export const without = (a, u) => add(a, scaled(u, -dot(a, u)));

/** A vector turned about a unit axis by an angle [rad]. */
export function turnedAbout(v, axis, angle) {
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  const along = scaled(axis, dot(axis, v) * (1 - c));
  return add(add(scaled(v, c), scaled(cross(axis, v), s)), along);
}

/** A unit vector perpendicular to a unit vector. */
export function across(u) {
  const k = [0, 1, 2].reduce((best, i) => (Math.abs(u[i]) < Math.abs(u[best]) ? i : best), 0);
  const axis = [0, 0, 0];
  axis[k] = 1;
  return unit(cross(u, axis));
}
