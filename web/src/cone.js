// The cone of stable directions: C = {g : e.g = 0, q.g >= 0} = lines + sums of rays.
// A direction within `blur` [rad] of the boundary counts as on it, as in the Python package.

import { across, add, angleBetween, cross, dot, norm, scaled, unit, without } from "./vector.js";

/** Whether a direction lies in the span of the cone. */
const inSpan = (cone, u) => cone.equations.every((e) => Math.abs(dot(e, u)) <= cone.blur);

/** Whether a direction, of any length but zero, lies in the cone. */
export function contains(cone, direction) {
  const u = unit(direction);
  if (norm(u) === 0 || cone.dimension === 0) return false;
  return inSpan(cone, u) && cone.facets.every((q) => dot(q, u) >= -cone.blur);
}

/**
 * The angle from a direction inside to the nearest facet, within the span [rad]; a half turn
 * if the cone has no facet. The foot point on the nearest facet of a convex cone lies on the
 * cone, so this is the distance to the boundary.
 */
export function margin(cone, direction) {
  const u = unit(direction);
  if (!cone.facets.length) return Math.PI;
  const least = Math.min(...cone.facets.map((q) => dot(q, u)));
  return Math.asin(Math.min(1, Math.max(0, least)));
}

/** Whether the cone has a lower dimension than the space of directions. */
export const isThin = (cone, planar) => cone.dimension < (planar ? 2 : 3);

/** The unit direction of the cone nearest to a direction; null if the cone is empty. */
export function nearest(cone, direction) {
  if (cone.dimension === 0) return null;
  const u = unit(direction);
  const flat = cone.equations.reduce((g, e) => without(g, e), u);
  const faces = [flat, ...cone.facets.map((q) => without(flat, q))];
  const onLines = cone.lines.reduce((g, l) => add(g, scaled(l, dot(l, u))), [0, 0, 0]);
  for (const ray of cone.rays) faces.push(add(onLines, scaled(ray, Math.max(0, dot(ray, u)))));
  const inside = faces.filter((p) => norm(p) > 1e-12 && contains(cone, p));
  if (inside.length) {
    return unit(inside.reduce((best, p) => (norm(p) > norm(best) ? p : best)));
  }
  // more than a right angle from the whole cone: the nearest ray, or sense of a line
  const ends = [...cone.rays, ...cone.lines, ...cone.lines.map((l) => scaled(l, -1))];
  return ends.reduce((best, p) => (dot(p, u) > dot(best, u) ? p : best));
}

/** The angle from a direction to the cone [rad], 0 inside; null if the cone is empty. */
export function distance(cone, direction) {
  if (contains(cone, direction)) return 0;
  const foot = nearest(cone, direction);
  return foot && angleBetween(foot, direction);
}

/**
 * The boundary on the unit sphere, exactly, as arcs of great circles: p(t) = cos(t) u + sin(t) v
 * for t from 0 to `angle`. A ray is an arc of angle 0. Arcs of a solid cone close a loop.
 */
export function arcs(cone) {
  const [l, m] = cone.lines;
  const [r, s] = cone.rays;
  switch (cone.kind) {
    case "ray":
      return [point(r)];
    case "line":
      return [point(l), point(scaled(l, -1))];
    case "fan":
      return [between(r, s)];
    case "half-plane":
      return [{ u: l, v: r, angle: Math.PI }];
    case "plane":
      return [{ u: l, v: m, angle: 2 * Math.PI }];
    case "cone":
      return cone.rays.map((ray, k) => between(ray, cone.rays[(k + 1) % cone.rays.length]));
    case "wedge":
      return [
        { u: l, v: r, angle: Math.PI },
        { u: scaled(l, -1), v: s, angle: Math.PI },
      ];
    case "half-space":
      return [{ u: l, v: m, angle: 2 * Math.PI }];
    default:
      return [];
  }
}

const point = (u) => ({ u, v: across(u), angle: 0 });

/** The short arc from one unit vector to another. */
export function between(a, b) {
  const v = unit(without(b, a));
  return { u: a, v: norm(v) ? v : across(a), angle: angleBetween(a, b) };
}

/** The point of an arc at parameter t [rad]. */
export const along = (arc, t) => add(scaled(arc.u, Math.cos(t)), scaled(arc.v, Math.sin(t)));

/**
 * The boundary of {g : q.g >= 0 for all q} on the unit sphere as arcs: of each facet's great
 * circle a + b turned by t, the interval that meets every other facet.
 */
export function outline(facets) {
  return facets.flatMap((facet) => {
    const a = across(facet);
    const b = cross(facet, a);
    let [middle, half] = [0, Math.PI]; // of the interval
    for (const q of facets) {
      const [c, s] = [dot(q, a), dot(q, b)];
      if (q === facet || Math.hypot(c, s) < 1e-12) continue; // the same plane
      const centre = Math.atan2(s, c); // the half circle about it meets q
      if (half === Math.PI) [middle, half] = [centre, Math.PI / 2];
      else {
        const off = Math.atan2(Math.sin(centre - middle), Math.cos(centre - middle));
        const [low, high] = [Math.max(-half, off - Math.PI / 2), Math.min(half, off + Math.PI / 2)];
        [middle, half] = [middle + (low + high) / 2, (high - low) / 2];
      }
      if (half <= 0) return [];
    }
    const at = (t) => add(scaled(a, Math.cos(t)), scaled(b, Math.sin(t)));
    return [{ u: at(middle - half), v: at(middle - half + Math.PI / 2), angle: 2 * half }];
  });
}

/**
 * Weights s >= 0 with sum s_k d_k = direction, as pairs [k, s_k]; null if no weights exist.
 * At most three of the directions d_k get a weight; the first combination that fits is returned.
 */
export function shares(downs, direction) {
  const u = unit(direction);
  const weightsOf = (chosen, weights) => {
    const sum = chosen.reduce((p, k, i) => add(p, scaled(downs[k], weights[i])), [0, 0, 0]);
    const off = norm(add(sum, scaled(u, -1)));
    return weights.every((s) => s >= -1e-9) && off < 1e-7
      ? chosen.map((k, i) => [k, Math.max(0, weights[i])])
      : null;
  };
  const n = downs.length;
  for (let i = 0; i < n; i += 1) {
    const single = weightsOf([i], [dot(downs[i], u)]);
    if (single) return single;
  }
  for (let i = 0; i < n; i += 1) {
    for (let j = i + 1; j < n; j += 1) {
      const c = dot(downs[i], downs[j]);
      const det = 1 - c * c;
      if (det < 1e-12) continue;
      const [a, b] = [dot(downs[i], u), dot(downs[j], u)];
      const pair = weightsOf([i, j], [(a - c * b) / det, (b - c * a) / det]);
      if (pair) return pair;
    }
  }
  for (let i = 0; i < n; i += 1) {
    for (let j = i + 1; j < n; j += 1) {
      const w = cross(downs[i], downs[j]);
      for (let k = j + 1; k < n; k += 1) {
        const det = dot(w, downs[k]);
        if (Math.abs(det) < 1e-9) continue;
        const a = dot(cross(downs[j], downs[k]), u) / det;
        const b = dot(cross(downs[k], downs[i]), u) / det;
        const triple = weightsOf([i, j, k], [a, b, dot(w, u) / det]);
        if (triple) return triple;
      }
    }
  }
  return null;
}
