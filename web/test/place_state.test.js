import assert from "node:assert/strict";
import test from "node:test";
import { inPolygon, stateAt } from "../src/place_state.js";

const square = (low, high) => [[low, low], [high, low], [high, high], [low, high], [low, low]];

test("a polygon has an outline and holes", () => {
  const ring = [square(0, 4), square(1, 2)];
  assert.equal(inPolygon(ring, 0.5, 0.5), true);
  assert.equal(inPolygon(ring, 1.5, 1.5), false);
  assert.equal(inPolygon(ring, 5, 0.5), false);
});

test("a place has the state and the height of the polygon that contains it", () => {
  const levels = [
    { height: 1, stands: [[square(0, 1)]], falls: [[square(2, 3)]], open: [] },
    { height: 2, stands: [], falls: [], open: [[square(4, 5)]] },
  ];
  assert.deepEqual(stateAt(levels, 0.5, 0.5), { state: "stands", height: 1 });
  assert.deepEqual(stateAt(levels, 2.5, 2.5), { state: "falls", height: 1 });
  assert.deepEqual(stateAt(levels, 4.5, 4.5), { state: "open", height: 2 });
  assert.equal(stateAt(levels, 9, 9), null);
});
