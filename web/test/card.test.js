import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { factsOf, pressed, touching } from "../src/card.js";
import { force, plainly } from "../src/words.js";

const page = {
  units: "mm",
  center: [10, 0, 0],
  patches: { parts: new Uint16Array([0, 1, 1, 2, 0, 1]) },
  parts: {
    names: ["base", "<b>", "top"],
    tails: ["base", "<b>", "top"],
    grounded: [1, 0, 0],
    mass: new Float64Array([1, 2.5, 3]),
    volume: new Float64Array([1, 8, 3]),
    center: new Float32Array([0, 0, 0, 1, 2, 3, 0, 0, 0]),
  },
};
const forces = { parts: new Uint16Array([0, 1, 1, 2]), forces: new Float32Array([0, 0, 3, 0, 4, 0]) };

test("a part's numbers: in the frame of the file, with its neighbours once each", () => {
  const facts = Object.fromEntries(factsOf(page, { moving: [], forces }, 1));
  assert.equal(facts.mass, "2.5 kg");
  assert.equal(facts.centre, "(11, 2, 3) mm");
  assert.equal(facts.touches, "\u2068base\u2069, \u2068top\u2069");
  assert.deepEqual([facts.state, facts.pressed], ["stays", "7 N in all"]);
  assert.deepEqual(touching(page.patches.parts, 0), [1]);
  assert.equal(pressed(forces, 2), 4);
});

test("what a part does is not known where that is so, and held is held", () => {
  const state = (found, k) => Object.fromEntries(factsOf(page, found, k)).state;
  assert.equal(state({ moving: null }, 2), "not known");
  assert.equal(state({ moving: [2] }, 2), "moves");
  assert.equal(state({ moving: null }, 0), "held");
});

test("a sentence stands without the verdict above it", () => {
  assert.equal(plainly("Stable: it stays.", "Stable"), "It stays.");
  assert.equal(plainly("Stable within limits: x.", "Stable"), "Stable within limits: x.");
});

test("a force has a unit that suits its size", () => {
  // the table that `kilter.tell.force` is tested by too: page and command say the same
  const table = JSON.parse(readFileSync(new URL("../../tests/show/forces.json", import.meta.url)));
  for (const [newtons, words] of table) assert.equal(force(newtons), words);
});
