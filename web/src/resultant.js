// One force a patch: the resultant of the forces at its points, at its centre of pressure.
//
//   R = sum f_k      c = sum n.f_k x_k / sum n.f_k      use = |R - N| / (mu sum n.f_k)
//
// with n the normal at each point and N the part of the resultant along the normals: the numbers
// of `contact_forces` in Python. Where forces have no patches (`patch` is null), each point is one.

import { add, dot, norm, scaled } from "./vector.js";

const PRESSES = 1e-6; // of the greatest force: what presses less carries no thrust

/** Resultants that press: {parts, at, force, use}; `use` is null where nothing rubs. */
export function resultants(page, { points, parts, forces, patch }) {
  const count = points.length / 3;
  const found = new Map();
  const at3 = (array, k) => [array[3 * k], array[3 * k + 1], array[3 * k + 2]];
  for (let k = 0; k < count; k += 1) {
    const key = patch ? patch[k] : k;
    const force = at3(forces, k);
    let one = found.get(key);
    if (!one) {
      one = { parts: [parts[2 * k], parts[2 * k + 1]], force: [0, 0, 0], across: [0, 0, 0], sum: 0, moment: [0, 0, 0], mu: 0 };
      if (patch) one.mu = page.patches.mu[key];
      found.set(key, one);
    }
    const { normals, normal } = page.patches;
    const n = !patch ? null : normals ? at3(normals, k) : at3(normal, key);
    const along = n ? dot(force, n) : norm(force);
    one.force = add(one.force, force);
    if (n) one.across = add(one.across, add(force, scaled(n, -along)));
    one.moment = add(one.moment, scaled(at3(points, k), along));
    one.sum += along;
  }
  return [...found.values()]
    .filter((one) => one.sum > 0)
    .map(({ parts: pair, force, across, sum, moment, mu }) => ({
      parts: pair,
      force,
      at: scaled(moment, 1 / sum),
      use: mu > 0 ? norm(across) / (mu * sum) : null,
    }));
}

/**
 * The line of thrust, pieces {part, from, to}: within a free part with two pressing patches from
 * centre of pressure to centre of pressure. With one patch it begins at the centre of mass, where
 * the weight comes in; with more, every patch is joined to their middle, weighted by force.
 */
export function thrust(page, found) {
  const near = new Map();
  const most = found.reduce((m, one) => Math.max(m, norm(one.force)), 0);
  for (const one of found) {
    if (norm(one.force) < PRESSES * most) continue;
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
