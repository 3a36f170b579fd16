// One force per patch: the resultant of the forces at its points, at its centre of pressure.
//
//   R = sum f_k      c = sum n.f_k x_k / sum n.f_k      use = |R - N| / (mu sum (n.f_k + T_k))
//
// with n the normal at each point, N the part of the resultant along the normals and T the strength
// of a bond at the point, as in `contact_forces` in Python. For a bonded patch the centre is
// weighted by |n.f_k|, and `bond` is the largest -n.f_k / T_k. Without patches (`patch` is null),
// or with `each`, every point is a patch of its own. If the data have the use that the points of a
// patch need, which is at least that of the resultant, it is taken instead.

import { add, dot, norm, scaled } from "./vector.js";

const PRESSES = 1e-6; // smaller forces carry no thrust [largest force]

/**
 * Resultants of the loaded patches: {parts, at, force, use, bond}. `use` is null without friction,
 * `bond` is null without a bond.
 */
export function resultants(page, { points, parts, forces, patch, pull = null, use = null }, each = false) {
  const { normals, normal, mu } = page.patches;
  const bonded = new Set(patch && pull ? [...patch].filter((_, k) => pull[k] > 0) : []);
  const alone = each || !patch;
  const patches = new Map();
  const at3 = (array, k) => [array[3 * k], array[3 * k + 1], array[3 * k + 2]];
  for (let k = 0; k < points.length / 3; k += 1) {
    const p = patch ? patch[k] : -1;
    const key = alone ? k : p;
    if (!patches.has(key)) patches.set(key, empty([parts[2 * k], parts[2 * k + 1]], alone ? 0 : mu[p]));
    const sum = patches.get(key);
    const force = at3(forces, k);
    const n = !patch ? null : normals ? at3(normals, k) : at3(normal, p);
    const along = n ? dot(force, n) : norm(force);
    const most = bonded.has(p) ? pull[k] : 0;
    const weight = alone ? norm(force) : bonded.has(p) ? Math.abs(along) : along;
    sum.force = add(sum.force, force);
    if (use && !alone) sum.needed = use[k];
    if (n) sum.across = add(sum.across, add(force, scaled(n, -along)));
    sum.moment = add(sum.moment, scaled(at3(points, k), weight));
    sum.size += weight;
    sum.pressed += along + most;
    if (most > 0) sum.bond = Math.max(sum.bond || 0, -along / most);
  }
  return [...patches.values()]
    .filter((sum) => sum.size > 0)
    .map(({ parts: pair, force, across, size, moment, mu: rough, pressed, bond, needed }) => ({
      parts: pair,
      force,
      at: scaled(moment, 1 / size),
      use: useOf(rough > 0 && pressed > 0 ? (needed ?? norm(across) / (rough * pressed)) : NaN),
      bond,
    }));
}

/** A share, or null if it is no number. */
const useOf = (share) => (Number.isNaN(share) ? null : share);

/** The sums of a patch before its points are added. */
const empty = (parts, mu) => ({
  parts,
  mu,
  force: [0, 0, 0],
  across: [0, 0, 0],
  moment: [0, 0, 0],
  size: 0,
  pressed: 0,
  needed: null,
  bond: null,
});

/**
 * The line of thrust as segments {part, from, to}. In a free part with two pressing patches it
 * joins their centres of pressure. With one patch it starts at the centre of mass, where the weight
 * acts. With more patches, each is joined to their force-weighted mean. Bonded patches are left
 * out, because their force need not act within the patch.
 */
export function thrust(page, forces) {
  const near = new Map();
  const most = forces.reduce((m, { force }) => Math.max(m, norm(force)), 0);
  for (const patch of forces) {
    if (norm(patch.force) < PRESSES * most || Number.isFinite(patch.bond)) continue;
    for (const part of patch.parts) {
      if (page.parts.grounded[part]) continue;
      if (!near.has(part)) near.set(part, []);
      near.get(part).push(patch);
    }
  }
  const pieces = [];
  for (const [part, all] of near) {
    if (all.length === 2) {
      pieces.push({ part, from: all[0].at, to: all[1].at });
      continue;
    }
    const { center } = page.parts;
    const hub = all.length === 1 ? [0, 1, 2].map((i) => center[3 * part + i]) : middle(all);
    for (const { at } of all) pieces.push({ part, from: hub, to: at });
  }
  return pieces;
}

/** Mean of the centres of pressure, weighted by the size of the forces. */
function middle(all) {
  const whole = all.reduce((sum, { force }) => sum + norm(force), 0);
  return all.reduce((sum, { at, force }) => add(sum, scaled(at, norm(force) / whole)), [0, 0, 0]);
}
