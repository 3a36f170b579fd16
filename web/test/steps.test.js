import assert from "node:assert/strict";
import test from "node:test";
import { carried } from "../src/pose.js";
import { clipped, lengthOf, pictureTime, placeOn, sceneAt, stepAt } from "../src/steps.js";

const near = (a, b) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) < 1e-9, `${a} is not ${b}`));
const bent = [[10, 0, 3], [0, 0, 3], [0, 0, 0]];
const plan = {
  base: [0],
  steps: [
    { parts: [1], path: [[0, 0, 50], [0, 0, 0]], held: [], over: null, thread: 0 },
    { parts: [2], path: bent, held: [1], over: null, thread: 0 },
    { parts: [3], path: [[0, 0, 50], [0, 0, 0]], held: [], over: 2, thread: 2 },
  ],
};

test("a path is cut to a reach before its first corner, and not after it", () => {
  assert.deepEqual(clipped(bent, 4), [[4, 0, 3], [0, 0, 3], [0, 0, 0]]);
  assert.deepEqual(clipped(bent, 40), bent);
  assert.equal(lengthOf(clipped(bent, 4)), 7);
});

test("positions on a path of two segments are measured from the seat", () => {
  near(placeOn(bent, 0).place, [0, 0, 0]);
  near(placeOn(bent, 2).place, [0, 0, 2]);
  near(placeOn(bent, 2).heading, [0, 0, -1]);
  near(placeOn(bent, 5).place, [2, 0, 3]);
  near(placeOn(bent, 5).heading, [-1, 0, 0]);
  assert.equal(placeOn(bent, 5).ahead, 2);
  near(placeOn(bent, 99).place, [10, 0, 3]);
});

test("a part is present from the beginning of its step, and at rest before its end", () => {
  assert.deepEqual([...sceneAt(plan, 0, 20).present], [0]);
  const begun = sceneAt(plan, 1e-9, 20);
  assert.deepEqual([...begun.present], [0, 1]);
  near(begun.on.place, [0, 0, 20]);
  near(sceneAt(plan, 0.9, 20).on.place, [0, 0, 0]);
  assert.deepEqual(sceneAt(plan, 0.9, 20).moving, [1]);
  assert.deepEqual([...sceneAt(plan, 3, 20).present], [0, 1, 2, 3]);
  assert.deepEqual(sceneAt(plan, 3, 20).moving, []);
});

test("held parts are gripped before the part arrives, and until it rests", () => {
  for (const time of [1, 1.5, 1.99]) assert.deepEqual(sceneAt(plan, time, 20).gripped, [1]);
  assert.deepEqual(sceneAt(plan, 0.99, 20).gripped, []);
  assert.deepEqual(sceneAt(plan, 2, 20).gripped, []);
});

test("the distance of a part from its seat decreases", () => {
  const left = Array.from({ length: 40 }, (_, k) => Math.hypot(...sceneAt(plan, (k + 0.5) / 40, 20).on.place));
  left.slice(1).forEach((far, k) => assert.ok(far <= left[k]));
});

test("a nut turns only on its thread, and ends in its drawn pose", () => {
  assert.equal(sceneAt(plan, 2.01, 20).turn, -6 * Math.PI);
  assert.equal(sceneAt(plan, 2.9, 20).turn, -0);
  const on = sceneAt(plan, 2.7, 20);
  assert.ok(on.turn < 0 && on.turn > -6 * Math.PI);
  assert.equal(sceneAt(plan, 1.5, 20).turn, 0);
});

test("the picture of a step shows its part near its seat, but not in it", () => {
  for (const [k, far] of [[0, 1.2], [1, 1.2]]) {
    const time = pictureTime(plan, k, 1, 20);
    assert.equal(stepAt(plan.steps, time)[0], k);
    assert.ok(Math.abs(Math.hypot(...sceneAt(plan, time, 20).on.place) - far) < 1e-6);
  }
});

test("a part is rotated about its centre of mass, then shifted", () => {
  const parts = {
    position: new Float64Array([1, 0, 0]),
    center: new Float64Array([2, 0, 0]),
    rotation: new Float64Array([1, 0, 0, 0]),
  };
  const half = Math.SQRT1_2;
  const [q, p] = carried(parts, 0, [0, 0, 5], [0, 0, half, half]); // a quarter about z
  near(p, [2, -1, 5]);
  near(q, [0, 0, half, half]);
  near(carried(parts, 0, null, null)[1], [1, 0, 0]);
});
