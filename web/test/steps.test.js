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

test("a way is cut to a reach before its first turn, and no further", () => {
  assert.deepEqual(clipped(bent, 4), [[4, 0, 3], [0, 0, 3], [0, 0, 0]]);
  assert.deepEqual(clipped(bent, 40), bent);
  assert.equal(lengthOf(clipped(bent, 4)), 7);
});

test("places on a way of two pieces are counted from the seat", () => {
  near(placeOn(bent, 0).place, [0, 0, 0]);
  near(placeOn(bent, 2).place, [0, 0, 2]);
  near(placeOn(bent, 2).heading, [0, 0, -1]);
  near(placeOn(bent, 5).place, [2, 0, 3]);
  near(placeOn(bent, 5).heading, [-1, 0, 0]);
  assert.equal(placeOn(bent, 5).ahead, 2);
  near(placeOn(bent, 99).place, [10, 0, 3]);
});

test("a part is there from the beginning of its step, and at rest before its end", () => {
  assert.deepEqual([...sceneAt(plan, 0, 20).present], [0]);
  const begun = sceneAt(plan, 1e-9, 20);
  assert.deepEqual([...begun.present], [0, 1]);
  near(begun.on.place, [0, 0, 20]);
  near(sceneAt(plan, 0.9, 20).on.place, [0, 0, 0]);
  assert.deepEqual(sceneAt(plan, 0.9, 20).moving, [1]);
  assert.deepEqual([...sceneAt(plan, 3, 20).present], [0, 1, 2, 3]);
  assert.deepEqual(sceneAt(plan, 3, 20).moving, []);
});

test("what is held is gripped before the part comes, and until it rests", () => {
  for (const time of [1, 1.5, 1.99]) assert.deepEqual(sceneAt(plan, time, 20).gripped, [1]);
  assert.deepEqual(sceneAt(plan, 0.99, 20).gripped, []);
  assert.deepEqual(sceneAt(plan, 2, 20).gripped, []);
});

test("a part comes ever nearer", () => {
  const left = Array.from({ length: 40 }, (_, k) => Math.hypot(...sceneAt(plan, (k + 0.5) / 40, 20).on.place));
  left.slice(1).forEach((far, k) => assert.ok(far <= left[k]));
});

test("a nut turns on its thread alone, and ends as it is drawn", () => {
  assert.equal(sceneAt(plan, 2.01, 20).turn, -6 * Math.PI);
  assert.equal(sceneAt(plan, 2.9, 20).turn, -0);
  const on = sceneAt(plan, 2.7, 20);
  assert.ok(on.turn < 0 && on.turn > -6 * Math.PI);
  assert.equal(sceneAt(plan, 1.5, 20).turn, 0);
});

test("the picture of a step shows its part near its seat, and not in it", () => {
  for (const [k, far] of [[0, 1.7], [1, 1.7]]) {
    const time = pictureTime(plan, k, 1, 20);
    assert.equal(stepAt(plan.steps, time)[0], k);
    assert.ok(Math.abs(Math.hypot(...sceneAt(plan, time, 20).on.place) - far) < 1e-6);
  }
});

test("a part turns about its centre of mass, and then moves", () => {
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
