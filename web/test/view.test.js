import assert from "node:assert/strict";
import test from "node:test";
import { ramp } from "../src/colours.js";
import { local, posed, reachOf, times, turn, turned } from "../src/pose.js";
import { eyeFor, inPlane, onDisc, sphereView, underPoint } from "../src/sphere.js";
import { angleBetween, cross, dot, norm } from "../src/vector.js";
import { directions } from "./cones.js";

const near = (a, b, within = 1e-9) => assert.ok(Math.abs(a - b) < within, `${a} is not ${b}`);

test("projection to the disc and back reproduces directions on the near and the far side", () => {
  for (const above of directions(10, 5)) {
    const view = sphereView(above, 0.7, -0.4);
    near(norm(view.right), 1);
    near(dot(view.right, view.up), 0);
    near(angleBetween(cross(view.right, view.up), view.front), 0);
    for (const u of directions(50)) {
      const [x, y, z] = onDisc(view, u);
      if (z < 0) continue;
      near(angleBetween(underPoint(view, x, y), u), 0, 1e-6);
    }
    near(angleBetween(underPoint(view, 2, 0), view.front), Math.PI, 1e-6);
    near(angleBetween(underPoint(view, 0, 1.5), view.front), 0.75 * Math.PI, 1e-6);
  }
});

test("an eye from which a direction is well visible", () => {
  const above = [0, 0, 1];
  for (const u of directions(60)) {
    assert.ok(dot(sphereView(above, ...eyeFor(above, u)).front, u) > 0.8);
  }
});

test("planar directions stay in the plane", () => {
  near(angleBetween(inPlane([3, 2, -4]), [0.6, 0, -0.8]), 0);
  assert.deepEqual(inPlane([0, 1, 0]), [0, 0, -1]);
});

test("colours get darker as instability grows, so that they are readable without hue", () => {
  const table = [[255, 246, 222], [243, 161, 75], [140, 48, 6]];
  const light = (share) => {
    const [r, g, b] = ramp(share, table);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  for (let k = 0; k < 40; k += 1) assert.ok(light(k / 40) > light((k + 1) / 40));
  assert.deepEqual(ramp(2, table), ramp(1, table));
});

const s = Math.SQRT1_2;
const parts = {
  radius: new Float32Array([2]),
  position: new Float32Array([1, 0, 0]),
  center: new Float32Array([1, 1, 0]),
  rotation: new Float32Array([s, 0, 0, s]), // w first: a quarter turn about z
};

test("a part at rest keeps its place; points transform back to its frame", () => {
  const [q, p] = posed(parts, 0, null, 1, 0);
  assert.deepEqual(p, [1, 0, 0]);
  const back = local(parts, 0, [1, 3, 0]);
  near(back[0], 3, 1e-6);
  const again = turned(q, back).map((c, k) => c + p[k]);
  near(again[1], 3, 1e-6);
});

test("motion turns about the centre of mass and moves it", () => {
  const motion = new Float32Array([0, 0, 1, 0, 0, Math.PI / 2]);
  const [q, p] = posed(parts, 0, motion, 1, 0);
  // the middle of the shape is at (0, -1, 0) from the centre; a quarter turn brings it to (1, 0, 0)
  [2, 1, 1].forEach((c, k) => near(p[k], c, 1e-6));
  near(Math.abs(q[2]), 1, 1e-6);
});

test("parts with one common screw keep their relative position", () => {
  const two = {
    position: new Float32Array([1, 0, 0, 4, 0, 0]),
    center: new Float32Array([1, 1, 0, 4, 2, 0]),
    rotation: new Float32Array([1, 0, 0, 0, 1, 0, 0, 0]),
  };
  // about z through the origin, and along it: v = w x c + 2 z
  const motion = new Float32Array([-1, 1, 2, 0, 0, 1, -2, 4, 2, 0, 0, 1]);
  for (const amount of [0, 1e-5, 0.3, 2]) {
    const places = [0, 1].map((k) => posed(two, k, motion, amount, 0)[1]);
    [0, 1].forEach((k) => {
      const r = k ? 4 : 1;
      near(places[k][0], r * Math.cos(amount), 1e-6);
      near(places[k][1], r * Math.sin(amount), 1e-6);
      near(places[k][2], 2 * amount, 1e-6);
    });
  }
});

test("exploded parts move away from the middle by their distance", () => {
  assert.deepEqual(posed(parts, 0, null, 0, 0.5)[1], [1.5, 0.5, 0]);
});

test("rotations multiply, and the largest motion has the given length", () => {
  const q = times(turn(0, 0, 0.3), turn(0, 0, 0.4));
  near(2 * Math.asin(q[2]), 0.7);
  assert.equal(reachOf(new Float32Array([0, 0, 0, 0, 3, 0]), parts.radius, 12), 2);
  assert.equal(reachOf(new Float32Array(6), parts.radius, 12), 0);
});
