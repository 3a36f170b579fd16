import assert from "node:assert/strict";
import test from "node:test";
import { paced } from "../src/clip.js";
import { fallen, frictionWords, line, overhang, placeWords } from "../src/fall.js";
import { turned } from "../src/pose.js";
import { energy } from "../src/words.js";

const near = (a, b) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) < 1e-6, `${a} is not ${b}`));
const quarter = Math.PI / 2;
const fall = {
  parts: [2, 5],
  friction: "open",
  places: {
    // two parts, three places: part 2 shifts, part 5 turns on from the second place
    motions: new Float32Array([
      ...[0, 0, 0, 0, 0, 0], ...[0, 0, 0, 0, 0, 0],
      ...[1, 0, 0, 0, 0, 0], ...[0, 0, 0, 0, 0, 0],
      ...[1, 0, -2, 0, 0, 0], ...[0, 0, 0, 0, 0, quarter],
    ]),
    energies: new Float64Array([0, -1, -9]),
    lengths: new Float64Array([0, 1, 3]),
  },
};

test("a fall begins at rest and ends at its last place", () => {
  const [rest, end] = [fallen(fall, 0), fallen(fall, 1)];
  assert.equal(rest.energy, 0);
  near(rest.shifts[0], [0, 0, 0]);
  near(rest.turns[1], [0, 0, 0, 1]);
  assert.equal(end.energy, -9);
  assert.equal(end.length, 3);
  near(end.shifts[0], [1, 0, -2]);
  near(turned(end.turns[1], [1, 0, 0]), [0, 1, 0]);
});

test("positions match the lengths of the path, and are interpolated linearly between them", () => {
  near(fallen(fall, 1 / 3).shifts[0], [1, 0, 0]);
  const half = fallen(fall, 2 / 3);
  near(half.shifts[0], [1, 0, -1]);
  near([half.energy, half.length], [-5, 2]);
  near(turned(half.turns[1], [1, 0, 0]), [Math.SQRT1_2, Math.SQRT1_2, 0]);
  assert.equal(fallen(fall, 2).energy, -9);
  assert.equal(fallen(fall, -1).energy, 0);
});

test("the graph goes down from rest to the least energy", () => {
  const { points, place } = line(fall.places);
  const [first, second, last] = points;
  assert.ok(first[0] < second[0] && second[0] < last[0]);
  assert.ok(first[1] < second[1] && second[1] < last[1]);
  near([(second[0] - first[0]) / (last[0] - first[0])], [1 / 3]);
  near([(second[1] - first[1]) / (last[1] - first[1])], [1 / 9]);
  near(place(2, -5), [(second[0] + last[0]) / 2, (second[1] + last[1]) / 2]);
});

test("the fall accelerates", () => {
  assert.deepEqual([paced(-1, 2), paced(0, 2), paced(0.5, 2), paced(1, 2), paced(3, 2), paced(0.5, 1)], [0, 0, 0.25, 1, 1, 0.5]);
});

test("words for a place with its unit, and for friction", () => {
  assert.equal(placeWords("mm", { length: 12.345, energy: -0.00321 }), "12.3 mm along the path, energy −3.21 mJ");
  assert.equal(energy(0), "0 J");
  assert.equal(energy(-4.2e6), "-4.2 MJ");
  assert.match(frictionWords(fall), /without friction/);
  assert.match(frictionWords({ friction: "holds" }), /would slide without/);
});

test("the view makes room for parts that fall out of it, and stays the same at rest", () => {
  const parts = { center: new Float32Array([0, 0, 0, 2, 0, 1]), radius: [9, 1] };
  const two = [1];
  near(overhang(two, parts, [3, 1, 2], [[0, 0, 0]]), [0, 0, 0]);
  near(overhang(two, parts, [3, 1, 2], [[0.5, 0, -4]]), [0.5, 0, 2]);
  near(overhang(two, parts, [9, 9, 9], [[0.5, 0, -4]]), [0, 0, 0]);
});
