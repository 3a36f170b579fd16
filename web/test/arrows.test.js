import assert from "node:assert/strict";
import test from "node:test";
import { ball, round, straight } from "../src/arrows.js";

/** Six times the volume inside a closed surface whose triangles turn left seen from outside. */
function volume(geometry) {
  const p = geometry.getAttribute("position");
  const at = (k) => [p.getX(k), p.getY(k), p.getZ(k)];
  const index = geometry.getIndex().array;
  let sum = 0;
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [at(index[t]), at(index[t + 1]), at(index[t + 2])];
    sum +=
      a[0] * (b[1] * c[2] - b[2] * c[1]) +
      a[1] * (b[2] * c[0] - b[0] * c[2]) +
      a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum;
}

test("triangles of arrows face outwards, so that the halo lies behind the arrow", () => {
  assert.ok(volume(straight()) > 0.01);
  assert.ok(volume(round()) > 0.01);
  assert.ok(volume(ball()) > 0.9 * 8 * Math.PI * (Math.SQRT2 / 2) * 0.9);
  assert.ok(volume(ball()) < 8 * Math.PI);
});

test("the round arrow is right-handed about y: its head continues the turn of its tail", () => {
  const p = round().getAttribute("position");
  const angle = (k) => Math.atan2(p.getX(k), p.getZ(k));
  assert.ok(Math.abs(angle(0)) < 1e-6);
  const next = angle(6);
  assert.ok(next > 0.1 && next < 0.3);
});
