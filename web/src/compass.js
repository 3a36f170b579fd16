// The view cube and the axes triad over the picture, in the axes of the file.

import { add, cross, scaled } from "./vector.js";

/** Standard views by name: the direction from the assembly to the eye. */
export const VIEWS = {
  front: [0, -1, 0],
  back: [0, 1, 0],
  left: [-1, 0, 0],
  right: [1, 0, 0],
  top: [0, 0, 1],
  bottom: [0, 0, -1],
  isometric: [1, -1, 1],
};
/** Keys of the standard views. */
export const VIEW_KEYS = Object.fromEntries(Object.keys(VIEWS).map((name, k) => [String(k + 1), name]));

// faces of the cube: outward normal and the direction in which the label reads
const FACES = [
  ["front", [1, 0, 0]],
  ["back", [-1, 0, 0]],
  ["left", [0, -1, 0]],
  ["right", [0, 1, 0]],
  ["top", [1, 0, 0]],
  ["bottom", [1, 0, 0]],
];
const CUTS = [-1, -0.58, 0.58, 1]; // limits of the cells of a face: rim, middle, rim
const HALF = 25; // half edge of the cube in units of its picture
const FRONT = 0.02; // a face is drawn if its normal leans to the eye by more than this [-]
const READABLE = 0.3; // a face at a larger angle to the screen shows no name: cosine of this angle [-]

/**
 * Cells of the cube: {name, normal, corners, toward, label}. A cell in the middle of a face leads
 * to that face, a cell at its rim to the edge or the corner that it touches.
 */
export function cells() {
  return FACES.flatMap(([name, along]) => {
    const normal = VIEWS[name];
    const up = cross(normal, along);
    const at = (u, v) => add(normal, add(scaled(along, u), scaled(up, v)));
    return [0, 1, 2].flatMap((i) =>
      [0, 1, 2].map((j) => ({
        name,
        normal,
        along,
        up,
        toward: at(i - 1, j - 1),
        middle: i === 1 && j === 1,
        corners: [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(([a, b]) => at(CUTS[a], CUTS[b])),
      })),
    );
  });
}

export class Compass {
  /** `go(direction)` shows the assembly from a direction, given in the axes of the file. */
  constructor(cube, triad, go) {
    const make = (kind) => document.createElementNS(cube.namespaceURI, kind);
    this.cells = cells().map((cell) => {
      const polygon = make("polygon");
      polygon.classList.toggle("rim", !cell.middle);
      polygon.addEventListener("click", () => go(cell.toward));
      return { ...cell, polygon };
    });
    this.labels = this.cells
      .filter((cell) => cell.middle)
      .map((cell) => {
        const text = make("text");
        text.textContent = cell.name.charAt(0).toUpperCase() + cell.name.slice(1);
        return { ...cell, text, outline: make("path") };
      });
    cube.replaceChildren(...this.cells.map(({ polygon }) => polygon));
    cube.append(...this.labels.flatMap(({ outline, text }) => [outline, text]));
    this.axes = ["x", "y", "z"].map((name) => {
      const text = make("text");
      text.textContent = name;
      return { text, path: make("path") };
    });
    triad.replaceChildren(...this.axes.flatMap(({ path, text }) => [path, text]));
  }

  /** Draw for the axes of the file on the screen: each as right, up, and towards the eye. */
  paint(axes) {
    const turn = (v) => [0, 1, 2].map((i) => v[0] * axes[0][i] + v[1] * axes[1][i] + v[2] * axes[2][i]);
    const place = (v) => {
      const [x, y] = turn(v);
      return [HALF * x, -HALF * y];
    };
    const seen = new Map(this.labels.map(({ name, normal }) => [name, turn(normal)[2] > FRONT]));
    const show = (element, visible) => element.setAttribute("display", visible ? "inline" : "none");
    for (const { name, corners, polygon } of this.cells) {
      show(polygon, seen.get(name));
      if (seen.get(name)) polygon.setAttribute("points", corners.map((v) => place(v).join()).join(" "));
    }
    for (const { name, normal, along, up, text, outline } of this.labels) {
      show(outline, seen.get(name));
      show(text, turn(normal)[2] > READABLE);
      if (!seen.get(name)) continue;
      const corner = (u, v) => place(add(normal, add(scaled(along, u), scaled(up, v)))).join(" ");
      outline.setAttribute("d", `M${corner(-1, -1)}L${corner(1, -1)}L${corner(1, 1)}L${corner(-1, 1)}Z`);
      const [a, b, at] = [turn(along), turn(up), place(normal)];
      text.setAttribute("transform", `matrix(${[a[0], -a[1], -b[0], b[1], ...at].map((c) => c.toFixed(4)).join()})`);
    }
    this.axes.forEach(({ path, text }, k) => {
      const [x, y, z] = axes[k];
      path.setAttribute("d", `M0 0L${26 * x} ${-26 * y}`);
      text.setAttribute("x", 33 * x);
      text.setAttribute("y", -33 * y);
      for (const element of [path, text]) element.setAttribute("opacity", z < -0.3 ? 0.45 : 1);
    });
  }
}
