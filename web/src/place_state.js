// Does the next part stand at a place? Decided from the polygons of the answer of `kilter place`.

const NAMES = ["stands", "falls", "open"];

/** Whether a point lies in a ring of points, by crossings of a ray. */
function inRing(ring, x, y) {
  let inside = false;
  for (let k = 0, j = ring.length - 1; k < ring.length; j = k, k += 1) {
    const [[a, b], [c, d]] = [ring[k], ring[j]];
    if (b > y !== d > y && x < ((c - a) * (y - b)) / (d - b) + a) inside = !inside;
  }
  return inside;
}

/** Whether a point lies in a polygon: within its outline and outside of its holes. */
export function inPolygon([outline, ...holes], x, y) {
  return inRing(outline, x, y) && !holes.some((hole) => inRing(hole, x, y));
}

/**
 * State of the part with its centre at a place: {state, height}, where the state is "stands",
 * "falls" or "open" and the height is that of its centre; null beside all polygons.
 */
export function stateAt(levels, x, y) {
  for (const level of levels) {
    for (const state of NAMES) {
      if (level[state].some((polygon) => inPolygon(polygon, x, y))) return { state, height: level.height };
    }
  }
  return null;
}
