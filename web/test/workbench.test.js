import assert from "node:assert/strict";
import test from "node:test";
import { entered, frictionOf, numbersOf } from "../src/workbench/entries.js";
import { roundAxis } from "../src/workbench/round_axis.js";

const near = (a, b, within = 1e-6) => a.forEach((c, k) => assert.ok(Math.abs(c - b[k]) < within, `${a} is not ${b}`));

/** Contact of parts 3 and 1 at `points` with `normals`; the file has its origin at (10, 0, 0). */
const page = (points, normals) => ({
  center: [10, 0, 0],
  patches: {
    parts: new Uint32Array([0, 1, 3, 1]),
    start: new Uint32Array([0, 0, points.length]),
    points: new Float32Array(points.flat()),
    normals: new Float32Array(normals.flat()),
    normal: new Float32Array(6),
  },
});

test("the axis of a round contact goes through its middle", () => {
  const angles = [0.2, 1.1, 2.5, 4];
  const normals = angles.map((a) => [Math.cos(a), Math.sin(a), 0]);
  const points = angles.map((a, k) => [1 + 2 * Math.cos(a), -3 + 2 * Math.sin(a), k]);
  const { point, axis } = roundAxis(page(points, normals), [1, 3]);
  near(axis.map(Math.abs), [0, 0, 1]);
  near(point, [11, -3, 1.5], 1e-5);
});

test("a flat contact has its middle and no axis; without a contact there is neither", () => {
  const points = [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]];
  const flat = page(points, points.map(() => [0, 0, 1]));
  assert.deepEqual(roundAxis(flat, [3, 1]), { point: [11, 1, 0], axis: null });
  assert.deepEqual(roundAxis(flat, [0, 3]), { point: null, axis: null });
  // the normals of a cone lean towards its axis
  const cone = page(points, [[1, 0, 1], [0, 1, 1], [-1, 0, 1], [0, -1, 1]]);
  assert.equal(roundAxis(cone, [3, 1]).axis, null);
});

test("numbers are separated by spaces or commas, and there are as many as wanted", () => {
  assert.deepEqual(numbersOf(" 1, -2e3  .5 ", 3), [1, -2000, 0.5]);
  assert.equal(numbersOf("1 2", 3), null);
  assert.equal(numbersOf("1 2 x", 3), null);
  assert.equal(numbersOf("", 1), null);
});

test("fields take what the command line takes, and their grey default if they are left alone", () => {
  assert.deepEqual(numbersOf(".5g 0 -1", 3, 10), [5, 0, -1]);
  assert.equal(numbersOf(".5g 0 0", 3), null);
  assert.equal(numbersOf("g 0 0", 3, 10), null);
  assert.equal(frictionOf(" 0.3 "), 0.3);
  assert.equal(frictionOf("30%"), 0.3);
  assert.ok(Math.abs(frictionOf("45deg") - 1) < 1e-12);
  for (const text of ["", "%", "much", "deg"]) assert.ok(Number.isNaN(frictionOf(text)), text);
  assert.equal(entered({ value: " ", placeholder: "6" }), "6");
  assert.equal(entered({ value: "7", placeholder: "6" }), "7");
});
