// Cones of all ten kinds, with their known properties.

const BLUR = 1e-8;
const cone = (kind, dimension, lines, rays, equations, facets) => ({
  kind,
  dimension,
  lines,
  rays,
  equations,
  facets,
  blur: BLUR,
});
const [x, y, z] = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
];
const h = Math.SQRT1_2;

export const cones = {
  none: cone("none", 0, [], [], [x, y, z], []),
  ray: cone("ray", 1, [], [[0, 0, -1]], [x, y], [[0, 0, -1]]),
  line: cone("line", 1, [z], [], [x, y], []),
  fan: cone("fan", 2, [], [x, z], [y], [x, z]),
  "half-plane": cone("half-plane", 2, [x], [[0, 0, -1]], [y], [[0, 0, -1]]),
  plane: cone("plane", 2, [x, z], [], [y], []),
  cone: cone("cone", 3, [], [x, y, z], [], [x, y, z]),
  wedge: cone("wedge", 3, [z], [x, y], [], [x, y]),
  "half-space": cone("half-space", 3, [x, y], [[0, 0, -1]], [], [[0, 0, -1]]),
  all: cone("all", 3, [x, y, z], [], [], []),
};

/** A square pyramid about -z: its rays and facets lean by 45 degrees. */
export const pyramid = cone(
  "cone",
  3,
  [],
  [
    [1, 1, -1],
    [-1, 1, -1],
    [-1, -1, -1],
    [1, -1, -1],
  ].map((v) => v.map((c) => c / Math.sqrt(3))),
  [],
  [
    [-h, 0, -h],
    [0, -h, -h],
    [h, 0, -h],
    [0, h, -h],
  ],
);

/** Pseudo-random numbers from a fixed seed. */
export function numbers(seed = 1) {
  let state = seed;
  return () => {
    state = (1664525 * state + 1013904223) % 4294967296;
    return state / 4294967296;
  };
}

/** Random directions over the whole sphere. */
export function directions(count, seed = 7) {
  const next = numbers(seed);
  return Array.from({ length: count }, () => {
    const c = 2 * next() - 1;
    const a = 2 * Math.PI * next();
    const s = Math.sqrt(1 - c * c);
    return [s * Math.cos(a), s * Math.sin(a), c];
  });
}
