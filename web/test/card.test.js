import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import test from "node:test";
import { factsOf, labelsOf, pressed, touching } from "../src/card.js";
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

test("facts of a part: in the frame of the file, each neighbour once", () => {
  const facts = Object.fromEntries(factsOf(page, { moving: [], forces }, 1));
  assert.equal(facts.mass, "2.5 kg");
  assert.equal(facts.centre, "(11, 2, 3) mm");
  assert.equal(facts.touches, "\u2068base\u2069, \u2068top\u2069");
  assert.deepEqual([facts.state, facts["contact forces"]], ["stays", "7 N in total"]);
  assert.deepEqual(touching(page.patches.parts, 0), [1]);
  assert.equal(pressed(forces, 2), 4);
});

test("the state of a part is unknown without an answer, and held for a held part", () => {
  const state = (found, k) => Object.fromEntries(factsOf(page, found, k)).state;
  assert.equal(state({ moving: null }, 2), "unknown");
  assert.equal(state({ moving: [2] }, 2), "moves");
  assert.equal(state({ moving: null }, 0), "held");
});

test("a sentence is shown without its leading verdict", () => {
  assert.equal(plainly("Stable: it stays.", "Stable"), "It stays.");
  assert.equal(plainly("Stable within limits: x.", "Stable"), "Stable within limits: x.");
});

test("a force has a suitable SI prefix", () => {
  // the same table tests `kilter.tell.force`, so that page and command print the same
  const table = JSON.parse(readFileSync(new URL("../../tests/show/forces.json", import.meta.url)));
  for (const [newtons, words] of table) assert.equal(force(newtons), words);
});

test("material and layer are listed only if the file states them", () => {
  assert.deepEqual(labelsOf({}, 0), []);
  const parts = { material: ["steel", null], layer: ["walls", "roof"] };
  assert.deepEqual(labelsOf(parts, 0), [["material", "steel"], ["layer", "walls"]]);
  assert.deepEqual(labelsOf(parts, 1), [["layer", "roof"]]);
});
