import assert from "node:assert/strict";
import test from "node:test";
import { restAt, signOf } from "../src/rests.js";

const rests = [
  { down: [0, 0, -1], state: "minimum", words: "strict" },
  { down: [1, 0, 0], state: "balanced", words: "falls" },
];

test("the place of rest under a pointer is the nearest, and null far from all signs", () => {
  assert.equal(restAt(rests, [Math.sin(0.07), 0, -Math.cos(0.07)]).words, "strict");
  assert.equal(restAt(rests, [Math.sin(0.09), 0, -Math.cos(0.09)]), null);
  assert.equal(restAt(rests, [Math.cos(0.01), Math.sin(0.01), 0]).words, "falls");
  assert.equal(restAt([], [0, 0, -1]), null);
});

test("each state has its sign, and only the sign of a minimum is filled", () => {
  const signs = ["minimum", "free", "balanced", "open"].map(signOf);
  assert.equal(new Set(signs.map((sign) => JSON.stringify(sign))).size, 4);
  assert.deepEqual(signs.map((sign) => sign.filled), [true, false, false, false]);
});
