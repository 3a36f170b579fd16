// The stability map: z(g) = -max over the vertices q of q.g; the vertex says what moves.

/** The vertex farthest along a direction, and how far: [position, q.g]. */
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

/** The largest -z/mass of any direction: the longest vertex. */
export function deepest(map) {
  let most = 0;
  for (let k = 0; k < map.vertices.length; k += 3) {
    most = Math.max(most, Math.hypot(...map.vertices.subarray(k, k + 3)));
  }
  return most / map.mass;
}

/** Which parts move by more than a small part of the largest motion; `radius` a part. */
export function movers(motion, radius, share = 1e-4) {
  const sizes = radius.map((r, k) => size(motion, k, r));
  const most = sizes.reduce((a, b) => Math.max(a, b), 0);
  const moving = [];
  sizes.forEach((s, k) => {
    if (most > 0 && s > share * most) moving.push(k);
  });
  return moving;
}

/** How far the outermost point of a part goes: translation, or radius x rotation. */
export function size(motion, part, radius) {
  const m = motion.subarray(6 * part, 6 * part + 6);
  return Math.max(Math.hypot(m[0], m[1], m[2]), radius * Math.hypot(m[3], m[4], m[5]));
}
