// How what is balanced falls: places along its path, and the graph of its energy. Without friction.

import { turn } from "./pose.js";
import { energy, number } from "./words.js";

const WIDE = 360; // of the graph, in its own units; the page scales it
const HIGH = 112;
const EDGE = { left: 8, right: 8, top: 20, bottom: 20 };
const FRICTION = {
  open: "Drawn as it slides without friction.",
  holds: "Drawn as it would slide without.",
  falls: "Drawn as it slides without friction; with friction it rolls.",
};

/** Between which places a share of the way lies, and how far between them. */
function between(lengths, share) {
  const last = lengths.length - 1;
  const length = Math.max(0, Math.min(1, share)) * lengths[last];
  let k = 1;
  while (k < last && lengths[k] < length) k += 1;
  const step = lengths[k] - lengths[k - 1];
  return [k, step > 0 ? (length - lengths[k - 1]) / step : 1, length];
}

/**
 * Where the parts are after a share of the way: `shifts` of their centres of mass and `turns`, as
 * quaternions, one for each of `fall.parts`; how far, and the energy there [J].
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

/** By how much parts that have fallen reach farther out of a box about the middle than at rest. */
export function overhang(fall, { center, radius }, extent, shifts) {
  const beyond = (k, i, shift) => Math.max(0, Math.abs(center[3 * k + i] + shift) + radius[k] - extent[i]);
  return [0, 1, 2].map((i) =>
    Math.max(0, ...fall.parts.map((k, m) => beyond(k, i, shifts[m][i]) - beyond(k, i, 0))),
  );
}

/** How far it has fallen after a share of the time: ever faster. */
export const paced = (time) => Math.min(1, Math.max(0, time)) ** 2;

/** What is said of a place, or of the whole way. */
export const placeWords = (units, { length, energy: joules }) =>
  `${number(length, 3)} ${units} along, energy ${energy(joules).replace("-", "−")}`;

export const frictionWords = (fall) => FRICTION[fall.friction];

/** Points of the line of energy over the way, and where one of them is, in units of the graph. */
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

/** The graph of energy as it falls, with a mark that goes along it. */
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
    svg.setAttribute("aria-label", `Energy as it falls: at its end ${placeWords(units, end)}`);
    put(".axis", `M${left} ${HIGH - EDGE.bottom}V${top}H${WIDE - EDGE.right}`);
    put(".under", `M${path}V${top}H${left}Z`);
    put(".energy", `M${path}`);
    say(".far", `${number(end.length, 3)} ${units} along`);
    say(".least", energy(end.energy).replace("-", "−"));
  }

  /** Put the mark where it has fallen to. */
  show({ length, energy: joules }) {
    const [x, y] = this.place(length, joules);
    this.mark.setAttribute("cx", x);
    this.mark.setAttribute("cy", y);
  }
}
