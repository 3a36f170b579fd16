import assert from "node:assert/strict";
import test from "node:test";
import { clearAmount, distanceTo, enters, formOf } from "../src/sweep.js";

/** A box about its middle, in the form of the page's shapes. */
function box([x, y, z]) {
  const corners = [];
  for (let k = 0; k < 8; k += 1) corners.push(k & 4 ? x : -x, k & 2 ? y : -y, k & 1 ? z : -z);
  const quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
  const triangles = quads.flatMap(([a, b, c, d]) => [a, b, c, a, c, d]);
  return { positions: new Float32Array(corners.map((v) => v / 2)), triangles: new Uint16Array(triangles) };
}

/** An L: not convex. Its foot reaches from 0 to 3, its leg stands over 0 to 1. */
function corner() {
  const line = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]];
  const positions = [-1, 1].flatMap((y) => line.flatMap(([x, z]) => [x, y, z]));
  const cap = [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]];
  const triangles = cap.flatMap(([a, b, c]) => [a, b, c, a + 6, c + 6, b + 6]);
  line.forEach((_, k) => {
    const j = (k + 1) % 6;
    triangles.push(k, k + 6, j, j, k + 6, j + 6);
  });
  return { positions: new Float32Array(positions), triangles: new Uint16Array(triangles) };
}

const pageOf = (shapes, places) => ({
  shapes,
  parts: {
    shape: shapes.map((_, k) => k),
    position: new Float32Array(places.flat()),
    center: new Float32Array(places.flat()),
    rotation: new Float32Array(shapes.flatMap(() => [1, 0, 0, 0])),
    radius: new Float32Array(shapes.map(() => Math.sqrt(3) / 2)),
  },
});
const cubes = (...places) => pageOf(places.map(() => box([1, 1, 1])), places);
const moving = (...motions) => new Float32Array(motions.flat());
const still = [0, 0, 0, 0, 0, 0];
const near = (a, b, within = 2e-3) => assert.ok(Math.abs(a - b) < within, `${a} is not ${b}`);

test("a part stops where it meets another, not before", () => {
  const page = cubes([0, 0, 0], [3, 0, 0]);
  near(clearAmount(page, moving([1, 0, 0, 0, 0, 0], still), 5), 2);
  assert.equal(clearAmount(page, moving([-1, 0, 0, 0, 0, 0], still), 5), 5);
  assert.equal(clearAmount(page, moving([0, 1, 0, 0, 0, 0], still), 5), 5);
});

test("touching parts slide along each other, and move together without limit", () => {
  const page = cubes([0, 0, 0], [0.4, 0, 1]);
  assert.equal(clearAmount(page, moving(still, [1, 0, 0, 0, 0, 0]), 3), 3);
  // both about the lower edge of the lower one at x = .5: v = w x (c - e)
  const about = (x, z) => [z + 0.5, 0, -(x - 0.5), 0, 1, 0];
  assert.equal(clearAmount(page, moving(about(0, 0), about(0.4, 1)), 1.5), 1.5);
});

test("a cube that turns in a slot of its own width stops at once", () => {
  const page = cubes([0, 0, 0], [1, 0, 0], [-1, 0, 0]);
  const turning = moving([0, 0, 0, 0, 1, 0], still, still);
  assert.ok(clearAmount(page, turning, 1) < 2e-3);
});

test("a bar through a bar is detected, though no corner is inside", () => {
  const page = pageOf([box([6, 1, 1]), box([1, 6, 1])], [[0, 0, 0], [0, 0, 0.99]]);
  assert.ok(enters(page, null, 0, 0, 1, 0.005));
  assert.ok(!enters(page, null, 0, 0, 1, 0.02));
});

test("a cube moves down beside the leg of an L as far as its foot", () => {
  assert.equal(formOf(corner()).planes, null);
  const page = pageOf([corner(), box([1, 1, 1])], [[0, 0, 0], [1.6, 0, 3]]);
  near(clearAmount(page, moving(still, [0, 0, -1, 0, 0, 0]), 4), 1.5);
  near(clearAmount(page, moving(still, [-1, 0, -1, 0, 0, 0]), 4), 0.1);
});

test("an overlap at rest is tolerated, but may not get deeper", () => {
  const page = cubes([0, 0, 0], [0.9, 0, 0]);
  assert.equal(clearAmount(page, moving(still, [1, 0, 0, 0, 0, 0]), 2), 2);
  assert.ok(clearAmount(page, moving(still, [-1, 0, 0, 0, 0, 0]), 2) < 0.11);
});

test("the distance of a point from a triangle: face, edge, corner", () => {
  const three = [[0, 0, 0], [4, 0, 0], [0, 4, 0]];
  assert.equal(distanceTo([1, 1, 2], ...three), 2);
  assert.equal(distanceTo([1, -3, 0], ...three), 3);
  assert.equal(distanceTo([-3, -4, 0], ...three), 5);
});
