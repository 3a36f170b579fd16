import assert from "node:assert/strict";
import test from "node:test";
import { spotFor } from "../src/names.js";

/** Cells drawn as text: a digit is a part counted from 1, a dot is background. */
function drawn(...rows) {
  const cells = new Uint32Array(rows.join("").split("").map((c) => Number(c.replace(".", "0"))));
  const ask = (part, at, wide, high, taken = new Uint8Array(cells.length)) =>
    spotFor(cells, rows[0].length, rows.length, part, at, wide, high, taken);
  return ask;
}

test("a name lies on its own part, as near to the middle as it can", () => {
  const ask = drawn("11112222", "11112222", "11112222");
  assert.deepEqual(ask(0, [2, 1.5], 2, 1), [2, 1.5]);
  // wanted on the border, the label stays off it
  assert.deepEqual(ask(0, [4, 1.5], 2, 1), [3, 1.5]);
  assert.deepEqual(ask(1, [4, 1.5], 2, 1), [5, 1.5]);
});

test("a label may cover the background by half, never another part", () => {
  const ask = drawn(".......", "..11...", ".......", "..22...");
  assert.deepEqual(ask(0, [3, 1.5], 4, 1), [3, 1.5]);
  assert.equal(ask(0, [3, 1.5], 5, 1), null);
  assert.equal(ask(0, [3, 1.5], 2, 3), null);
  assert.equal(drawn("2222222", "2211222")(0, [3, 1.5], 3, 1), null);
});

test("no position for an invisible part, and none on another label", () => {
  const ask = drawn("1111", "1111");
  assert.equal(ask(4, [0, 0], 1, 1), null);
  const taken = new Uint8Array(8).fill(1, 0, 4);
  assert.deepEqual(ask(0, [2, 0.5], 2, 1, taken), [2, 1.5]);
  assert.equal(ask(0, [2, 0.5], 2, 2, taken), null);
});
