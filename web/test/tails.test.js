import assert from "node:assert/strict";
import test from "node:test";
import { tailsOf } from "../src/tails.js";

test("the last component comes first, and equal ones have what distinguishes them", () => {
  const names = [
    "plate",
    "l-bracket-assembly_1/nut-bolt-assembly_1/bolt",
    "l-bracket-assembly_1/nut-bolt-assembly_12/bolt",
    "l-bracket-assembly_2/nut-bolt-assembly_1/bolt",
    "l-bracket-assembly_2/l-bracket",
    "voussoir-1",
    "voussoir-11",
  ];
  assert.deepEqual(tailsOf(names), ["plate", "bolt (1/1)", "bolt (1/12)", "bolt (2/1)", "l-bracket", "voussoir-1", "voussoir-11"]);
});

test("seventeen leaves of one name have seventeen short names", () => {
  const names = Array.from({ length: 17 }, (_, k) => `box/leaf_${k}/solid`);
  assert.deepEqual(tailsOf(names), names.map((_, k) => `solid (${k})`));
});

test("a name that is the end of another name stays distinguishable", () => {
  const names = ["assembly of frames/left/bolt", "left/bolt", "bolt"];
  assert.deepEqual(tailsOf(names), ["bolt (assembly of frames/left)", "bolt (left)", "bolt"]);
});

test("a long flat name becomes its shortest unique tail", () => {
  assert.deepEqual(tailsOf(["a_very_long_name_of_a_part_7", "b"]), ["…part_7", "b"]);
});
