// Places of rest on the gravity ball: a sign at each direction, its description on hover.

import { angleBetween } from "./vector.js";

const SIZE = 5; // half size of a sign [CSS px]
const WITHIN = 0.08; // a pointer within this angle is on a sign [rad]

/** Corners of the sign of a state about its middle, null for a circle; only a minimum is filled. */
export function signOf(state) {
  const diamond = [[0, -SIZE], [SIZE, 0], [0, SIZE], [-SIZE, 0]];
  const cross = [[-SIZE, -SIZE], [SIZE, SIZE], [0, 0], [SIZE, -SIZE], [-SIZE, SIZE], [0, 0]];
  const corners = { minimum: diamond, balanced: cross, open: diamond }[state] ?? null;
  return { corners, filled: state === "minimum", dashed: state === "open" };
}

/** The place of rest nearest to `direction`, or null if the pointer is on no sign. */
export function restAt(rests, direction) {
  let best = null;
  let least = WITHIN;
  for (const rest of rests) {
    const away = angleBetween(rest.down, direction);
    if (away <= least) [best, least] = [rest, away];
  }
  return best;
}

/** Paint all signs; `place` maps a direction to canvas coordinates, z towards the eye. */
export function paintRests(c, rests, place, style) {
  for (const rest of rests) {
    const [x, y, z] = place(rest.down);
    if (z < 0) continue;
    const { corners, filled, dashed } = signOf(rest.state);
    c.beginPath();
    if (corners) corners.forEach(([dx, dy], k) => (k ? c.lineTo(x + dx, y + dy) : c.moveTo(x + dx, y + dy)));
    else c.arc(x, y, SIZE, 0, 2 * Math.PI);
    c.closePath();
    c.setLineDash(dashed ? [2, 2] : []);
    c.lineWidth = 4;
    c.strokeStyle = style("surface");
    c.stroke();
    c.lineWidth = 1.75;
    c.strokeStyle = style("ink");
    c.fillStyle = filled ? style("ink") : "transparent";
    c.fill();
    c.stroke();
  }
  c.setLineDash([]);
}
