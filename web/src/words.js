// Sentences for a live answer. Names come in as text and leave as text.

import { isThin } from "./cone.js";

const SHORTENED = 500; // most parts whose names are shortened in a sentence
const NO_ANGLE = 1e-9; // degrees, as in `kilter.tell.numbers`

/** An angle [rad] in degrees with sensible digits. */
export function degrees(angle) {
  const d = (angle * 180) / Math.PI;
  // an angle below the rounding error prints as 0
  return `${Math.abs(d) < NO_ANGLE ? "0" : d < 0.01 ? number(d, 2) : d < 10 ? d.toFixed(2) : d.toFixed(1)}°`;
}

/** Words for the band between the inner and the outer cone; `gap`: its width [deg]. */
export const gapWords = (gap) => `undecided: neither is proved; at most ${number(gap, 2)}° wide`;

export const number = (value, digits = 4) =>
  Number.isFinite(value) ? String(Number(Number(value).toPrecision(digits))) : "–";

/** A force with a suitable SI prefix, as `kilter.tell` prints it (`tests/show/forces.json`). */
export function force(newtons) {
  const units = [[1e6, "MN"], [1e3, "kN"], [1, "N"], [1e-3, "mN"]];
  const [size, unit] = units.find(([least]) => Math.abs(newtons) >= least) || [1, "N"];
  return `${number(newtons / size)} ${unit}`;
}

/** An energy with a suitable SI prefix. */
export function energy(joules) {
  const units = [[1e6, "MJ"], [1e3, "kJ"], [1, "J"], [1e-3, "mJ"], [1e-6, "µJ"]];
  const [size, unit] = units.find(([least]) => Math.abs(joules) >= least) || [1, "J"];
  return `${number(joules / size, 3)} ${unit}`;
}

/** Range of the bond strengths of single points, in words; `pull`: strength of each point [N]. */
export function pullWords(pull) {
  const bonded = pull ? [...pull].filter((most) => most > 0) : [];
  const [low, high] = bonded.reduce(([a, b], most) => [Math.min(a, most), Math.max(b, most)], [Infinity, 0]);
  if (!bonded.length) return "";
  return low === high ? `${force(low)} per point` : `${force(low)} to ${force(high)} per point`;
}

/** A direction as text: (0, 0, −1). */
export const direction = (u, digits = 4) =>
  `(${u.map((c) => (Math.abs(c) < 5e-7 ? 0 : Number(c.toFixed(digits)))).join(", ")})`.replaceAll("-", "−");

/** Words for the tilt margin inside the stable region, or for the angle to it outside. */
export function marginWords(page, found) {
  const { region } = page;
  if (!region) return page.left_out ? "" : "the stable region of this assembly was not computed";
  if (region.kind === "none") {
    return region.words.none;
  }
  if (found.margin === null || found.margin === undefined) {
    if (found.away === undefined || found.away === null) return "";
    if (!found.away) return "on the boundary of the region in which holding is proved";
    return `${degrees(found.away)} away from the nearest ${region.words.nearest}`;
  }
  if (!region.facets.length && !region.equations.length) return "the parts hold for every direction of gravity";
  if (isThin(region, page.planar)) {
    if (region.dimension < 2) return "margin 0°: no tilt is allowed (a knife edge)";
    const within = region.facets.length ? degrees(found.within) : "unlimited";
    return `margin ${within} within the ${region.kind}, 0° out of it (a knife edge)`;
  }
  if (!region.facets.length) return "the parts hold for every direction of gravity in the plane";
  return `margin ${degrees(found.margin)}: the tilt that is allowed in every direction`;
}

/** Number and names of the moving parts, as text; `hidden` of them are not shown in the picture. */
export function movingWords(page, found, hidden = 0, limit = 8) {
  const free = page.parts.grounded.filter((held) => !held).length;
  if (found.moving === null || found.moving === undefined) {
    return found.verdict === "unknown" ? "" : "the moving parts are not known for this direction";
  }
  if (!found.moving.length) {
    return found.verdict === "undecided" ? "" : "no part moves";
  }
  const names = found.moving.slice(0, limit).map((k) => short(page.parts.tails[k]));
  const more = found.moving.length > limit ? ` and ${found.moving.length - limit} more` : "";
  const rough = page.region && page.region.friction && found.from === "cone";
  const alone = rough || found.verdict === "undecided" ? "with the frictionless contacts alone, " : "";
  const count = `${found.moving.length} of ${free} free ${free === 1 ? "part moves" : "parts move"}`;
  const gone = hidden ? ` (${hidden === found.moving.length ? "hidden" : `${hidden} of them hidden`} in the picture)` : "";
  return `${alone}${count}: ${names.join(", ")}${more}${gone}`;
}

/** A name cut to `length` characters, in Unicode isolates: its writing direction stays inside. */
export const short = (name, length = 40) =>
  `\u2068${name.length > length ? `${name.slice(0, length - 1)}…` : name}\u2069`;

/** Words for the origin of an answer: a full analysis, or the cone of stable directions. */
export function basis(page, found) {
  const { region } = page;
  if (found.from === "given") {
    return `Full analysis of gravity as given${page.coincide ? ", which is also the recommended direction" : ""}.`;
  }
  if (found.from === "recommended") return "Full analysis of the recommended direction.";
  if (!region) return "Only the given direction was analysed.";
  const cone = region.words.basis;
  if (found.motion) return `${cone} Motion: solution of the displacement program without friction, from the stability map.`;
  if (found.forces) return `${cone} Forces: the forces of the cone's rays, combined with the same weights as the direction.`;
  return cone;
}

/** A sentence in which the names of parts in groups are short; long lists of parts are left alone. */
export function shortened(page, sentence) {
  const { names, tails } = page.parts;
  if (names.length > SHORTENED) return sentence;
  const grouped = names.map((name, k) => [name, tails[k]]).filter(([name, tail]) => name.includes("/") && name !== tail);
  grouped.sort(([a], [b]) => b.length - a.length);
  return grouped.reduce((text, [name, tail]) => text.replaceAll(name, tail), sentence);
}

/** A sentence without its leading verdict, because the banner already shows the verdict. */
export function plainly(sentence, verdict) {
  const rest = sentence.replace(`${verdict}: `, "");
  return rest.charAt(0).toUpperCase() + rest.slice(1);
}
