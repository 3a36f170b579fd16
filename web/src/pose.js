// Poses in which parts are drawn: moved along a motion, pulled apart. Quaternions are x, y, z, w.

import { size } from "./map.js";
import { cross, norm } from "./vector.js";

/** The quaternion of a rotation vector [rad]. */
export function turn(x, y, z) {
  const angle = Math.hypot(x, y, z);
  if (angle === 0) return [0, 0, 0, 1];
  const s = Math.sin(angle / 2) / angle;
  return [x * s, y * s, z * s, Math.cos(angle / 2)];
}

/** The product of two quaternions: the rotation b followed by a. */
export function times(a, b) {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
}

/** A vector turned by a quaternion. */
export function turned(q, v) {
  const [x, y, z, w] = q;
  const a = 2 * (y * v[2] - z * v[1]);
  const b = 2 * (z * v[0] - x * v[2]);
  const c = 2 * (x * v[1] - y * v[0]);
  return [
    v[0] + w * a + y * c - z * b,
    v[1] + w * b + z * a - x * c,
    v[2] + w * c + x * b - y * a,
  ];
}

/**
 * The factor that scales the largest motion to the length `reach`. A motion is of first order, so
 * the drawn length has no physical meaning.
 */
export function reachOf(motion, radius, reach) {
  let most = 0;
  for (let k = 0; k < radius.length; k += 1) most = Math.max(most, size(motion, k, radius[k]));
  return most > 0 ? reach / most : 0;
}

/**
 * Displacement of the centre of mass by a finite screw motion. Parts with one common screw keep
 * their relative positions.
 *
 *   shift = a v + (1 - cos t)/t^2 a^2 w x v + (t - sin t)/t^3 a^3 w x (w x v)      t = a |w|
 */
export function screwed(v, w, amount) {
  const t = amount * norm(w);
  const [b, c] = t > 1e-4 ? [(1 - Math.cos(t)) / t ** 2, (t - Math.sin(t)) / t ** 3] : [1 / 2, 1 / 6];
  const once = cross(w, v);
  const twice = cross(w, once);
  return v.map((x, i) => amount * x + b * amount ** 2 * once[i] + c * amount ** 3 * twice[i]);
}

/**
 * Quaternion and position of part k, moved by `amount` times its screw motion and pulled away
 * from the middle by `apart` times its distance.
 */
export function posed(parts, k, motion, amount, apart) {
  const at = parts.position.subarray(3 * k, 3 * k + 3);
  const center = parts.center.subarray(3 * k, 3 * k + 3);
  const [w, x, y, z] = parts.rotation.subarray(4 * k, 4 * k + 4);
  let q = [x, y, z, w];
  const p = [0, 1, 2].map((i) => at[i] + apart * center[i]);
  if (motion && amount) {
    const m = motion.subarray(6 * k, 6 * k + 6);
    if (m[3] || m[4] || m[5]) {
      const r = turn(amount * m[3], amount * m[4], amount * m[5]);
      const arm = [at[0] - center[0], at[1] - center[1], at[2] - center[2]];
      const after = turned(r, arm);
      q = times(r, q);
      for (let i = 0; i < 3; i += 1) p[i] += after[i] - arm[i];
    }
    const shift = screwed([...m.subarray(0, 3)], [...m.subarray(3, 6)], amount);
    for (let i = 0; i < 3; i += 1) p[i] += shift[i];
  }
  return [q, p];
}

/** Quaternion and position of part k, shifted by a vector and rotated about its centre of mass. */
export function carried(parts, k, shift, rotation) {
  const at = parts.position.subarray(3 * k, 3 * k + 3);
  const [w, x, y, z] = parts.rotation.subarray(4 * k, 4 * k + 4);
  let q = [x, y, z, w];
  let p = [...at];
  if (rotation) {
    const center = parts.center.subarray(3 * k, 3 * k + 3);
    const after = turned(rotation, [0, 1, 2].map((i) => at[i] - center[i]));
    q = times(rotation, q);
    p = after.map((c, i) => c + center[i]);
  }
  if (shift) p = p.map((c, i) => c + shift[i]);
  return [q, p];
}

/** Coordinates of a world point at rest in the frame of the shape of part k. */
export function local(parts, k, point) {
  const [w, x, y, z] = parts.rotation.subarray(4 * k, 4 * k + 4);
  const at = parts.position.subarray(3 * k, 3 * k + 3);
  return turned([-x, -y, -z, w], [point[0] - at[0], point[1] - at[1], point[2] - at[2]]);
}
