// One force a patch: the resultant of the forces at its points, at its centre of pressure.
//
//   R = sum f_k      c = sum n.f_k x_k / sum n.f_k      use = |R - N| / (mu sum (n.f_k + T_k))
//
// with n the normal at each point, N the part of the resultant along the normals and T what a bond
// pulls by at most: the numbers of `contact_forces` in Python. Where a bond may pull, the middle is
// that of the sizes |n.f_k|, and `bond` is the most of -n.f_k / T_k. Where forces have no patches
// (`patch` is null), or `each` is asked for, each point is one.

import { add, dot, norm, scaled } from "./vector.js";

const PRESSES = 1e-6; // of the greatest force: what presses less carries no thrust

/** Resultants of what presses or pulls: {parts, at, force, use, bond}; null where there is none. */
export function resultants(page, { points, parts, forces, patch, pull = null }, each = false) {
  const { normals, normal, mu } = page.patches;
  const bonded = new Set(patch && pull ? [...patch].filter((_, k) => pull[k] > 0) : []);
  const alone = each || !patch;
  const found = new Map();
  const at3 = (array, k) => [array[3 * k], array[3 * k + 1], array[3 * k + 2]];
  for (let k = 0; k < points.length / 3; k += 1) {
    const p = patch ? patch[k] : -1;
    const key = alone ? k : p;
    if (!found.has(key)) found.set(key, empty([parts[2 * k], parts[2 * k + 1]], alone ? 0 : mu[p]));
    const one = found.get(key);
    const force = at3(forces, k);
    const n = !patch ? null : normals ? at3(normals, k) : at3(normal, p);
    const along = n ? dot(force, n) : norm(force);
    const most = bonded.has(p) ? pull[k] : 0;
    const weight = alone ? norm(force) : bonded.has(p) ? Math.abs(along) : along;
    one.force = add(one.force, force);
    if (n) one.across = add(one.across, add(force, scaled(n, -along)));
    one.moment = add(one.moment, scaled(at3(points, k), weight));
    one.size += weight;
    one.pressed += along + most;
    if (most > 0) one.bond = Math.max(one.bond || 0, -along / most);
  }
  return [...found.values()]
    .filter((one) => one.size > 0)
    .map(({ parts: pair, force, across, size, moment, mu: rough, pressed, bond }) => ({
      parts: pair,
      force,
      at: scaled(moment, 1 / size),
      use: rough > 0 && pressed > 0 ? norm(across) / (rough * pressed) : null,
      bond,
    }));
}

/** A patch before its points are counted. */
const empty = (parts, mu) => ({
  parts,
  mu,
  force: [0, 0, 0],
  across: [0, 0, 0],
  moment: [0, 0, 0],
  size: 0,
  pressed: 0,
  bond: null,
});

/**
 * The line of thrust, pieces {part, from, to}: within a free part with two pressing patches from
 * centre of pressure to centre of pressure. With one patch it begins at the centre of mass, where
 * the weight comes in; with more, every patch is joined to their middle, weighted by force. It
 * leaves out patches that a bond may pull: their force need not act within them.
 */
export function thrust(page, found) {
  const near = new Map();
  const most = found.reduce((m, one) => Math.max(m, norm(one.force)), 0);
  for (const one of found) {
    if (norm(one.force) < PRESSES * most || Number.isFinite(one.bond)) continue;
    for (const part of one.parts) {
      if (page.parts.grounded[part]) continue;
      if (!near.has(part)) near.set(part, []);
      near.get(part).push(one);
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
    for (const one of all) pieces.push({ part, from: hub, to: one.at });
  }
  return pieces;
}

function middle(all) {
  const whole = all.reduce((sum, one) => sum + norm(one.force), 0);
  return all.reduce((sum, one) => add(sum, scaled(one.at, norm(one.force) / whole)), [0, 0, 0]);
}
