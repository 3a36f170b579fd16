import assert from "node:assert/strict";
import test from "node:test";
import { VIEWS, VIEW_KEYS, cells } from "../src/compass.js";
import { matcher, nest, rowsOf } from "../src/grove.js";
import { corners, measured, meet } from "../src/surface.js";
import { cross, dot, norm } from "../src/vector.js";

const near = (a, b, within = 1e-9) => assert.ok(Math.abs(a - b) < within, `${a} is not ${b}`);

test("the cells of the view cube lead to 6 faces, 12 edges and 8 corners", () => {
  const toward = new Map();
  for (const cell of cells()) {
    const key = cell.toward.join();
    toward.set(key, (toward.get(key) || 0) + 1);
    for (const corner of cell.corners) near(dot(corner, cell.normal), 1); // on its face
    assert.ok(cell.corners.every((corner) => Math.max(...corner.map(Math.abs)) <= 1));
    near(norm(cross(cross(cell.normal, cell.along), cell.up)), 0);
    // seen from outside, the label reads from left to right
    assert.deepEqual(cross(cell.along, cell.up).map((c) => c + 0), [...cell.normal].map((c) => c + 0));
  }
  assert.equal(toward.size, 26);
  assert.deepEqual([...toward.values()].sort(), [...Array(6).fill(1), ...Array(12).fill(2), ...Array(8).fill(3)]);
  assert.equal(VIEW_KEYS[5], "top");
  assert.deepEqual(VIEWS.front, [0, -1, 0]);
});

test("names with slashes are nested, and single children are merged", () => {
  const nodes = nest(["a/b/bolt", "a/b/nut", "plate", "c/d/rod", "a/pin", "/", ""]);
  assert.deepEqual(nodes.map(({ label }) => label), ["a", "plate", "c/d/rod", "/", ""]);
  assert.deepEqual(nodes[0].children.map(({ label }) => label), ["b", "pin"]);
  assert.deepEqual(nodes[0].parts, [0, 1, 4]);
  assert.equal(nodes[2].part, 3);
  const closed = rowsOf(nodes, new Set(), 9);
  assert.deepEqual(closed.map(([{ label }]) => label), ["a", "plate", "c/d/rod", "/", ""]);
  const open = rowsOf(nodes, new Set(["a", "a/b"]), 9);
  assert.deepEqual(open.slice(0, 4).map(([{ label }, level]) => [label, level]), [["a", 1], ["b", 2], ["bolt", 3], ["nut", 3]]);
  assert.equal(rowsOf(nodes, new Set(), 2).at(-1)[0].more, 3);
});

test("a search is a substring or a pattern, without case", () => {
  const names = ["left/nut_1", "left/Bolt_1", "rod(a)"];
  const matched = (text) => names.filter(matcher(text));
  assert.deepEqual(matched("NUT"), ["left/nut_1"]);
  assert.deepEqual(matched("bolt_?"), ["left/Bolt_1"]);
  assert.deepEqual(matched("left/*_1"), ["left/nut_1", "left/Bolt_1"]);
  assert.deepEqual(matched("*(a)"), ["rod(a)"]);
  assert.deepEqual(matched("nut*x"), []);
});

const square = {
  positions: new Float32Array([0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0]),
  triangles: new Uint32Array([0, 1, 2, 0, 2, 3]),
  edges: new Uint32Array([0, 1, 1, 2, 2, 3, 3, 0]),
};

test("a line of sight meets the nearest surface that counts", () => {
  const hit = meet(square, [0.5, 1.5, 3], [0, 0, -2]);
  assert.deepEqual(hit.point, [0.5, 1.5, 0]);
  near(hit.far, 1.5);
  assert.deepEqual(hit.normal.map(Math.abs), [0, 0, 1]);
  assert.equal(meet(square, [0.5, 1.5, 3], [0, 0, 1]), null);
  assert.equal(meet(square, [2.5, 1.5, 3], [0, 0, -1]), null);
  assert.equal(meet(square, [0.5, 1.5, 3], [0, 0, -1], () => false), null);
  assert.equal(corners(square).length, 4);
});

test("distances, angles and the gap of parallel faces", () => {
  const end = (at, normal) => ({ at, normal });
  const plain = measured(end([0, 0, 0]), end([1, 2, 2]));
  near(plain.distance, 3);
  assert.deepEqual([plain.step, plain.angle, plain.between], [[1, 2, 2], null, null]);
  near(measured(end([0, 0, 0], [0, 0, 1]), end([5, 1, 2], [0, 0, -1])).between, 2);
  const tilted = measured(end([0, 0, 0], [0, 0, 1]), end([5, 1, 2], [0, Math.SQRT1_2, -Math.SQRT1_2]));
  near(tilted.angle, Math.PI / 4);
  assert.equal(tilted.between, null);
  // rounding errors are no lengths, and small lengths at small coordinates are kept
  const same = measured(end([1.8, -0.5, 1.9], [0, 1, 0]), end([2.8, -0.5 - 1.8e-15, 1.4], [0, 1, 0]));
  assert.deepEqual([same.step[1], same.between], [0, 0]);
  near(measured(end([0, 0, 0], [0, 0, 1]), end([0, 0, 1e-8], [0, 0, 1])).between, 1e-8, 1e-20);
});
