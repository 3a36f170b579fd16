// Sentences for a live answer. Names come in as text and leave as text.

import { isThin } from "./cone.js";

const NO_ANGLE = 1e-9; // degrees, as in `kilter.tell.numbers`

/** An angle [rad] in degrees with sensible digits. */
export function degrees(angle) {
  const d = (angle * 180) / Math.PI;
  // what rounding leaves of none is none
  return `${Math.abs(d) < NO_ANGLE ? "0" : d < 0.01 ? number(d, 2) : d < 10 ? d.toFixed(2) : d.toFixed(1)}°`;
}

/** What lies between the inner and the outer cone. */
export const gapWords = (gap) => `open: neither is proved; at most ${number(gap, 2)}° wide`;

export const number = (value, digits = 4) =>
  Number.isFinite(value) ? String(Number(Number(value).toPrecision(digits))) : "–";

/** A force with a unit that suits its size, as `kilter.tell` shows it: `tests/show/forces.json`. */
export function force(newtons) {
  const units = [[1e6, "MN"], [1e3, "kN"], [1, "N"], [1e-3, "mN"]];
  const [size, unit] = units.find(([least]) => Math.abs(newtons) >= least) || [1, "N"];
  return `${number(newtons / size)} ${unit}`;
}

/** An energy with a unit that suits its size. */
export function energy(joules) {
  const units = [[1e6, "MJ"], [1e3, "kJ"], [1, "J"], [1e-3, "mJ"], [1e-6, "µJ"]];
  const [size, unit] = units.find(([least]) => Math.abs(joules) >= least) || [1, "J"];
  return `${number(joules / size, 3)} ${unit}`;
}

/** What bonds pull by at most at a point, from the strength of each point [N]. */
export function pullWords(pull) {
  const bonded = pull ? [...pull].filter((most) => most > 0) : [];
  const [low, high] = bonded.reduce(([a, b], most) => [Math.min(a, most), Math.max(b, most)], [Infinity, 0]);
  if (!bonded.length) return "";
  return low === high ? `${force(low)} a point` : `${force(low)} to ${force(high)} a point`;
}

/** A direction as text: (0, 0, −1). */
export const direction = (u, digits = 4) =>
  `(${u.map((c) => (Math.abs(c) < 5e-7 ? 0 : Number(c.toFixed(digits)))).join(", ")})`.replaceAll("-", "−");

/** How far it may tilt, or how far it is from holding. */
export function marginWords(page, found) {
  const { region } = page;
  if (!region) return "no stable region is known for this assembly";
  if (region.kind === "none") {
    return region.words.none;
  }
  if (found.margin === null || found.margin === undefined) {
    if (found.away === undefined || found.away === null) return "";
    if (!found.away) return "on the edge of the region that surely holds";
    return `${degrees(found.away)} away from the nearest ${region.words.nearest}`;
  }
  if (!region.facets.length && !region.equations.length) return "every direction holds";
  if (isThin(region, page.planar)) {
    if (region.dimension < 2) return "margin 0°: it may not tilt at all (a knife edge)";
    const within = region.facets.length ? degrees(found.within) : "any turn";
    return `margin ${within} within the ${region.kind}, none out of it (a knife edge)`;
  }
  if (!region.facets.length) return "every direction in the plane holds";
  return `margin ${degrees(found.margin)}: it may tilt so far in any direction`;
}

/** Which parts move, as text. */
export function movingWords(page, found, limit = 8) {
  const free = page.parts.grounded.filter((held) => !held).length;
  if (found.moving === null || found.moving === undefined) {
    return found.verdict === "unknown" ? "" : "which parts move is not known for this direction";
  }
  if (!found.moving.length) {
    return found.verdict === "undecided" ? "" : "no part moves";
  }
  const names = found.moving.slice(0, limit).map((k) => short(page.parts.tails[k]));
  const more = found.moving.length > limit ? ` and ${found.moving.length - limit} more` : "";
  const rough = page.region && page.region.friction && found.from === "cone";
  const alone = rough || found.verdict === "undecided" ? "by the frictionless contacts alone " : "";
  const count = `${found.moving.length} of ${free} free ${free === 1 ? "part moves" : "parts move"}`;
  return `${alone}${count}: ${names.join(", ")}${more}`;
}

/** A name cut to a length that fits a line; isolated, so that it turns no text around it. */
export const short = (name, length = 40) =>
  `\u2068${name.length > length ? `${name.slice(0, length - 1)}…` : name}\u2069`;

/** What a live answer rests on. */
export function basis(page, found) {
  const { region } = page;
  if (found.from === "given") {
    return `Answered in full: gravity as given${page.coincide ? ", which is recommended" : ""}.`;
  }
  if (found.from === "recommended") return "Answered in full: the recommended direction.";
  if (!region) return "Only the given direction is answered.";
  const cone = region.words.basis;
  if (found.motion) return `${cone} Motion: displacement of LP (9), without friction, from the stability map.`;
  if (found.forces) return `${cone} Forces: those of the cone's rays, mixed as the direction is.`;
  return cone;
}

/** A sentence without the verdict that it begins with, where that stands above it. */
export function plainly(sentence, verdict) {
  const rest = sentence.replace(`${verdict}: `, "");
  return rest.charAt(0).toUpperCase() + rest.slice(1);
}
