import assert from "node:assert/strict";
import test from "node:test";
import { bondUse } from "../src/overlay.js";
import { resultants, thrust } from "../src/resultant.js";

const near = (a, b) => a.forEach((c, k) => assert.ok(Math.abs(c - b[k]) < 1e-9, `${a} is not ${b}`));

// two corners of one patch, 3 N and 1 N up, 1 N aside; a patch without force; mu 0.5
const page = {
  parts: { grounded: [1, 0, 0], center: [0, 0, 0, 9, 9, 9, 0, 0, 5] },
  patches: { mu: [0.5, 0], normal: [0, 0, 1, 0, 0, 1], normals: null },
};
const forces = {
  points: [0, 0, 0, 4, 0, 0, 0, 0, 1],
  parts: [0, 1, 0, 1, 1, 2],
  forces: [1, 0, 3, 0, 0, 1, 0, 0, 0],
  patch: [0, 0, 1],
};

test("a patch has one force at its centre of pressure, and its friction use", () => {
  const [one, ...more] = resultants(page, forces);
  assert.equal(more.length, 0); // nothing presses on the other
  near(one.force, [1, 0, 4]);
  near(one.at, [1, 0, 0]);
  assert.ok(Math.abs(one.use - 1 / (0.5 * 4)) < 1e-12);
});

test("a given use is that of the patch, also if the forces across it cancel", () => {
  const turned = { ...forces, forces: [0, 1, 2, 0, -1, 2, 0, 0, 0], use: [0.9, 0.9, NaN] };
  assert.equal(resultants(page, turned)[0].use, 0.9);
  assert.equal(resultants(page, turned, true)[0].use, null);
  assert.equal(resultants(page, { ...turned, use: [NaN, NaN, NaN] })[0].use, null);
});

test("without patches, each point has its force", () => {
  const found = resultants(page, { ...forces, patch: null });
  assert.equal(found.length, 2);
  near(found[1].at, [4, 0, 0]);
  assert.equal(found[0].use, null);
});

test("a curved patch uses the normals of its points", () => {
  const curved = { ...page, patches: { ...page.patches, normals: [1, 0, 0, 0, 0, 1, 0, 0, 1] } };
  const [one] = resultants(curved, forces);
  near(one.at, [2, 0, 0]); // 1 N along the first normal, 1 N along the second
  assert.ok(Math.abs(one.use - 3 / (0.5 * 2)) < 1e-12);
});

test("the force of a bond acts where the bond pulls, and has its bond use", () => {
  // 2 N down at one point and 1 N up at the other, strength 4 N each; friction counts the pull
  const moved = { ...forces, forces: [1, 0, -2, 0, 0, 1, 0, 0, 0] };
  const pulled = { ...moved, pull: [4, 4, 0] };
  const [one, ...more] = resultants(page, pulled);
  assert.equal(more.length, 0);
  near(one.force, [1, 0, -1]);
  near(one.at, [4 / 3, 0, 0]);
  assert.equal(one.bond, 0.5);
  assert.ok(Math.abs(one.use - 1 / (0.5 * (-1 + 8))) < 1e-12);
  assert.equal(resultants(page, moved).length, 0); // nothing pulls without a bond
  assert.deepEqual(resultants(page, pulled, true).map((point) => point.bond), [0.5, 0]);
  const names = { ...page, parts: { names: ["a", "b", "c"] } };
  assert.deepEqual([...bondUse(names, pulled)], [0.5, 0.5, 0]);
  assert.equal(bondUse(names, moved), null);
  assert.equal(thrust(page, [one]).length, 0);
});

test("the line of thrust joins two patches, starts at a centre of mass, or meets in the mean", () => {
  const at = (parts, point, size) => ({ parts, at: point, force: [0, 0, size] });
  const two = [at([0, 1], [0, 0, 0], 2), at([1, 2], [2, 0, 1], 1)];
  const pieces = thrust(page, two);
  assert.deepEqual(pieces[0], { part: 1, from: [0, 0, 0], to: [2, 0, 1] });
  assert.deepEqual(pieces[1], { part: 2, from: [0, 0, 5], to: [2, 0, 1] });
  const three = [...two, at([0, 1], [4, 0, 0], 1)];
  const star = thrust(page, three).filter((piece) => piece.part === 1);
  assert.equal(star.length, 3);
  near(star[0].from, [1.5, 0, 0.25]);
});
