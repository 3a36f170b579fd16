// The stability map: z(g) = -max over the vertices q of q.g; each vertex stores the motion.

/** The vertex farthest along a direction g: [its index, q.g]. */
export function farthest(vertices, g) {
  let best = -1;
  let most = -Infinity;
  for (let k = 0; k < vertices.length; k += 3) {
    const reach = vertices[k] * g[0] + vertices[k + 1] * g[1] + vertices[k + 2] * g[2];
    if (reach > most) {
      most = reach;
      best = k / 3;
    }
  }
  return [best, most];
}

/** z over the mass of the free parts, never above 0. */
export const zOverMass = (map, g) => Math.min(0, -farthest(map.vertices, g)[1] / map.mass);

/** The largest -z/mass over all directions: the length of the longest vertex over the mass. */
export function deepest(map) {
  let most = 0;
  for (let k = 0; k < map.vertices.length; k += 3) {
    most = Math.max(most, Math.hypot(...map.vertices.subarray(k, k + 3)));
  }
  return most / map.mass;
}

/**
 * Indices of the parts that move by more than `share` of the largest motion.
 * `radius`: bounding radius of each part.
 */
export function movers(motion, radius, share = 1e-4) {
  const sizes = radius.map((r, k) => size(motion, k, r));
  const most = sizes.reduce((a, b) => Math.max(a, b), 0);
  const moving = [];
  sizes.forEach((s, k) => {
    if (most > 0 && s > share * most) moving.push(k);
  });
  return moving;
}

/** Size of a part's motion: the larger of translation and radius x rotation [length unit]. */
export function size(motion, part, radius) {
  const m = motion.subarray(6 * part, 6 * part + 6);
  return Math.max(Math.hypot(m[0], m[1], m[2]), radius * Math.hypot(m[3], m[4], m[5]));
}
