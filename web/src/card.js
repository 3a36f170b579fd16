// The facts of one part for the current direction of gravity.

import { direction, force, number, short } from "./words.js";

const LISTED = 12; // touching parts that are listed by name

/** Terms and values of part k, as text; lengths are in the units of the file. */
export function factsOf(page, found, k) {
  const { parts, units, center } = page;
  const at = [0, 1, 2].map((i) => parts.center[3 * k + i] + center[i]);
  const moves = Boolean(found.moving && found.moving.includes(k));
  const state = moves ? "moves" : found.moving ? "stays" : "unknown";
  const near = touching(page.patches.parts, k);
  const names = near.slice(0, LISTED).map((j) => short(parts.tails[j]));
  if (near.length > LISTED) names.push(`${near.length - LISTED} more`);
  const rows = [
    ["mass", `${number(parts.mass[k], 6)} kg`],
    ["volume", `${number(parts.volume[k], 6)} ${units}³`],
    ...labelsOf(parts, k),
    ["centre", `${direction(at)} ${units}`],
    ["touches", names.join(", ") || "nothing"],
    ["state", parts.grounded[k] ? "held" : state],
  ];
  if (moves && found.words) rows.push(["motion", found.words[k]]);
  else if (moves && found.motion) {
    const m = found.motion.subarray(6 * k, 6 * k + 6);
    rows.push(["dr", `${direction([...m.subarray(0, 3)])} ${units}`]);
    rows.push(["dθ", `${direction([...m.subarray(3, 6)])} rad`]);
  }
  if (found.forces) rows.push(["contact forces", `${force(pressed(found.forces, k))} in total`]);
  return rows;
}

/** Material and layer of part k, as the file states them. */
export function labelsOf(parts, k) {
  return ["material", "layer"].filter((key) => parts[key]?.[k]).map((key) => [key, parts[key][k]]);
}

/** Indices of the parts that share a contact patch with part k. */
export function touching(pairs, k) {
  const neighbours = new Set();
  for (let p = 0; p < pairs.length; p += 2) {
    if (pairs[p] === k) neighbours.add(pairs[p + 1]);
    if (pairs[p + 1] === k) neighbours.add(pairs[p]);
  }
  return [...neighbours];
}

/** Sum of the magnitudes of the contact forces on part k [N]. */
export function pressed({ parts, forces }, k) {
  let sum = 0;
  for (let p = 0; p < parts.length / 2; p += 1) {
    if (parts[2 * p] === k || parts[2 * p + 1] === k) {
      sum += Math.hypot(forces[3 * p], forces[3 * p + 1], forces[3 * p + 2]);
    }
  }
  return sum;
}

/** Terms and values of several selected parts, as text. */
export function factsOfSeveral(page, list) {
  const { parts, patches } = page;
  const names = list.slice(0, LISTED).map((k) => short(parts.tails[k]));
  if (list.length > LISTED) names.push(`${list.length - LISTED} more`);
  const mass = list.reduce((sum, k) => sum + parts.mass[k], 0);
  const held = list.filter((k) => parts.grounded[k]).length;
  const rows = [
    ["parts", names.join(", ")],
    ["mass", `${number(mass, 6)} kg in total`],
    ["held", held ? `${held} of ${list.length}` : "none"],
  ];
  if (list.length === 2) {
    const between = [...Array(patches.parts.length / 2).keys()].filter(
      (p) => list.includes(patches.parts[2 * p]) && list.includes(patches.parts[2 * p + 1]),
    );
    const rough = [...new Set(between.map((p) => number(patches.mu[p])))];
    rows.push(["contact", between.length ? `${between.length} patch${between.length > 1 ? "es" : ""}, friction ${rough.join(", ")}` : "none"]);
  }
  return rows;
}
