import assert from "node:assert/strict";
import test from "node:test";
import { tailsOf } from "../src/tails.js";

test("a long name becomes its shortest unique tail; a short name stays", () => {
  const names = [
    "plate",
    "l-bracket-assembly_1/nut-bolt-assembly_1/bolt",
    "l-bracket-assembly_2/nut-bolt-assembly_1/bolt",
    "l-bracket-assembly_2/l-bracket",
    "voussoir-1",
    "voussoir-11",
  ];
  const tails = tailsOf(names);
  assert.deepEqual(tails.slice(0, 3), [
    "plate",
    "…1/nut-bolt-assembly_1/bolt",
    "…2/nut-bolt-assembly_1/bolt",
  ]);
  assert.deepEqual(tails.slice(4), ["voussoir-1", "voussoir-11"]);
  assert.equal(new Set(tails).size, names.length);
});

test("a name that is the end of another name stays distinguishable", () => {
  const names = ["assembly of frames/left/bolt", "left/bolt"];
  assert.deepEqual(tailsOf(names), ["…frames/left/bolt", "left/bolt"]);
});
