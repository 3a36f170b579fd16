// The answer for any direction of gravity, from the data of the page; nothing is solved here.

import { contains, distance, isThin, margin, nearest, shares } from "./cone.js";
import { farthest, movers } from "./map.js";
import { add, angleBetween, scaled, unit } from "./vector.js";

export const HELD = ["stable", "settles", "potentially-stable", "balanced"]; // verdicts with equilibrium forces
const DEEPER = 20; // depth of a direction inside a narrow cone [blur]
const SAME = 1e-9; // directions closer than this are equal [rad]

/**
 * Verdict, words, margin, motion and forces for a direction of gravity.
 *
 * `page` is the decoded data: `given` and `recommended` hold answers in full, `region` the cone,
 * `map` the stability map, `rays` forces for the rays of the cone.
 */
export function answer(page, down) {
  for (const name of ["given", "recommended", "probed"]) {
    const known = page[name];
    if (known && angleBetween(known.down, down) < SAME) return known_(page, name, known, down);
  }
  const { region } = page;
  if (!region) return { verdict: "unknown", from: "none", margin: null, moving: null };
  const verdict = verdictAt(region, down);
  const held = verdict === region.inside;
  const result = { verdict, from: "cone", ...marginAt(page, down, held), moving: null };
  if (held) {
    result.moving = [];
    result.forces = balanceAt(page.rays, down);
  } else if (page.map) {
    const [vertex, reach] = farthest(page.map.vertices, down);
    const count = page.parts.radius.length;
    result.motion = page.map.motions.subarray(6 * count * vertex, 6 * count * (vertex + 1));
    result.moving = movers(result.motion, page.parts.radius);
    result.z = Math.min(0, -reach);
    if (!result.moving.length) result.motion = null;
  }
  return result;
}

/** The cone of proved directions: the region, or its inner cone if friction makes it round. */
export const innerOf = (region) => ({ ...region, ...region.inner });

/** The cone outside which no direction holds; an outer cone is given by its facets only. */
export const outerOf = (region) =>
  region.inner ? { ...region, equations: [], dimension: 3 } : region;

/** The verdict of a direction according to the cone. */
export function verdictAt(region, down) {
  if (contains(innerOf(region), down)) return region.inside;
  return region.inner && contains(outerOf(region), down) ? "undecided" : region.outside;
}

/** The proved direction nearest to a direction. */
export function nearestHeld(region, down) {
  const cone = innerOf(region);
  // the foot is on the boundary; an inner cone with a negative blur needs a point inside
  const within = Math.max(0, -cone.blur);
  const foot = nearest({ ...cone, blur: Math.abs(cone.blur) }, down);
  return foot && within && region.center
    ? unit(add(foot, scaled(region.center, DEEPER * within)))
    : foot;
}

function known_(page, name, known, down) {
  const held = HELD.includes(known.verdict);
  const moving = [];
  known.moves.forEach((m, k) => m && moving.push(k));
  const inCone = page.region
    ? marginAt(page, down, contains(innerOf(page.region), down))
    : { margin: null };
  return {
    ...inCone,
    verdict: known.verdict,
    from: name,
    moving,
    motion: known.motion || (known.fall && !known.fall.places ? known.fall.begins : null),
    z: known.z,
    instability: known.instability,
    sentence: known.sentence,
    level: known.level,
    words: known.words,
    forceWords: known.force_words,
    forces: held ? known.forces : null,
    fall: known.fall || null,
  };
}

/** The margin inside the region, or the angle to the region outside [rad]. */
function marginAt(page, down, held) {
  const { region } = page;
  const cone = innerOf(region);
  if (!held) {
    return { margin: null, away: distance({ ...cone, blur: Math.abs(cone.blur) }, down) };
  }
  const within = margin(cone, down);
  return { margin: isThin(region, page.planar) ? 0 : within, within, away: 0 };
}

/** Forces for a direction inside: the forces of the rays with the weights of the direction. */
export function balanceAt(rays, down) {
  const weights = rays && shares(rays.downs, down);
  if (!weights) return null;
  const size = rays.points.length;
  const forces = new Float32Array(size);
  for (const [k, share] of weights) {
    for (let i = 0; i < size; i += 1) forces[i] += share * rays.forces[k * size + i];
  }
  return { points: rays.points, parts: rays.parts, patch: rays.patch, forces };
}
