// The fall of a balanced assembly without friction: positions along its path, graph of its energy.

import { turn } from "./pose.js";
import { energy, number } from "./words.js";

const WIDE = 360; // width of the graph in its own units; the page scales it
const HIGH = 112;
const EDGE = { left: 8, right: 8, top: 20, bottom: 20 };
const FRICTION = {
  open: "The drawing shows the fall without friction.",
  holds: "The drawing shows how the parts would slide without friction.",
  falls: "The drawing shows the parts sliding without friction; with friction they roll.",
};

/** Locate a share of the path: [index of the next place, share between the places, length]. */
function between(lengths, share) {
  const last = lengths.length - 1;
  const length = Math.max(0, Math.min(1, share)) * lengths[last];
  let k = 1;
  while (k < last && lengths[k] < length) k += 1;
  const step = lengths[k] - lengths[k - 1];
  return [k, step > 0 ? (length - lengths[k - 1]) / step : 1, length];
}

/**
 * Positions of the falling parts after a share of the path: `shifts` of the centres of mass and
 * `turns` as quaternions, in the order of `fall.parts`; also the length and the energy [J].
 */
export function fallen(fall, share) {
  const { motions, energies, lengths } = fall.places;
  const [k, part, length] = between(lengths, share);
  const count = 6 * fall.parts.length;
  const at = (i) => motions[count * (k - 1) + i] * (1 - part) + motions[count * k + i] * part;
  const three = (i) => [at(i), at(i + 1), at(i + 2)];
  return {
    length,
    energy: energies[k - 1] * (1 - part) + energies[k] * part,
    shifts: fall.parts.map((_, m) => three(6 * m)),
    turns: fall.parts.map((_, m) => turn(...three(6 * m + 3))),
  };
}

/** How far displaced parts reach out of the view's box, which they do not leave at rest, per axis. */
export function overhang(parts, { center, radius }, extent, shifts) {
  const beyond = (k, i, shift) => {
    const half = Math.min(radius[k], Math.max(0, extent[i] - Math.abs(center[3 * k + i])));
    return Math.abs(center[3 * k + i] + shift) + half - extent[i];
  };
  return [0, 1, 2].map((i) => Math.max(0, ...parts.map((k, m) => beyond(k, i, shifts[m][i]))));
}

/** Words for a place of the path: its length and its energy. */
export const placeWords = (units, { length, energy: joules }) =>
  `${number(length, 3)} ${units} along the path, energy ${energy(joules).replace("-", "−")}`;

export const frictionWords = (fall) => FRICTION[fall.friction];

/** The energy over the path in units of the graph: `points`, and `place`, which maps a point. */
export function line({ energies, lengths }) {
  const last = lengths.length - 1;
  const least = energies[last];
  const [wide, high] = [WIDE - EDGE.left - EDGE.right, HIGH - EDGE.top - EDGE.bottom];
  const place = (length, joules) => [
    EDGE.left + (wide * length) / lengths[last],
    EDGE.top + (high * joules) / least,
  ];
  return { place, points: Array.from(lengths, (length, k) => place(length, energies[k])) };
}

/** The graph of the energy during the fall, with a mark at the current position. */
export class Graph {
  constructor(svg, fall, units) {
    const { energies, lengths } = fall.places;
    const last = lengths.length - 1;
    const { place, points } = line(fall.places);
    const put = (name, d) => svg.querySelector(name).setAttribute("d", d);
    const say = (name, words) => {
      svg.querySelector(name).textContent = words;
    };
    const end = { length: lengths[last], energy: energies[last] };
    const { left, top } = EDGE;
    const path = points.map((p) => p.map((c) => c.toFixed(2)).join(" ")).join("L");
    this.place = place;
    this.mark = svg.querySelector(".mark");
    svg.setAttribute("aria-label", `Energy during the fall; at the end: ${placeWords(units, end)}`);
    put(".axis", `M${left} ${HIGH - EDGE.bottom}V${top}H${WIDE - EDGE.right}`);
    put(".under", `M${path}V${top}H${left}Z`);
    put(".energy", `M${path}`);
    say(".far", `${number(end.length, 3)} ${units} along the path`);
    say(".least", energy(end.energy).replace("-", "−"));
  }

  /** Move the mark to a position of the fall. */
  show({ length, energy: joules }) {
    const [x, y] = this.place(length, joules);
    this.mark.setAttribute("cx", x);
    this.mark.setAttribute("cy", y);
  }
}
