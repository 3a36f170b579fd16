import assert from "node:assert/strict";
import test from "node:test";
import { answer, balanceAt, nearestHeld, verdictAt } from "../src/answer.js";
import { unpack, unpacked } from "../src/data.js";
import { farthest, movers, zOverMass } from "../src/map.js";
import { basis, degrees, direction, marginWords, movingWords, short } from "../src/words.js";
import { cones, pyramid } from "./cones.js";

const DOWN = [0, 0, -1];
const words = { none: "none is held", basis: "Live: by the cone.", nearest: "stable direction" };

function page(more = {}) {
  const region = { ...pyramid, inside: "stable", outside: "unstable", words };
  return {
    planar: false,
    given: {
      down: DOWN,
      verdict: "stable",
      sentence: "Stable: it cannot start to move.",
      moves: new Uint8Array(2),
      motion: null,
      words: {},
      forces: null,
      instability: 0,
      z: 0,
    },
    recommended: null,
    region,
    rays: null,
    map: {
      vertices: new Float64Array([0, 0, 0, 2, 0, 0, -2, 0, 0]),
      mass: 2,
      motions: new Float32Array(36).fill(0, 0).map((_, k) => (k === 18 ? 1 : k === 30 ? -1 : 0)),
    },
    parts: { names: ["base", "cube"], tails: ["base", "cube"], radius: new Float32Array([1, 1]), grounded: [1, 0] },
    ...more,
  };
}

test("the given direction has a full answer, other directions are answered by the cone", () => {
  assert.equal(answer(page(), DOWN).from, "given");
  const inside = answer(page(), [0.5, 0, -1]);
  assert.deepEqual([inside.verdict, inside.from, inside.moving], ["stable", "cone", []]);
  const outside = answer(page(), [2, 0, -1]);
  assert.equal(outside.verdict, "unstable");
  assert.deepEqual(outside.moving, [1]);
  assert.equal(outside.z, -4);
});

test("a balanced assembly has its contact forces, an unstable one has none", () => {
  const forces = { points: new Float32Array(3) };
  const given = { ...page().given, forces };
  const shown = (verdict) => answer({ ...page(), given: { ...given, verdict } }, given.down).forces;
  assert.equal(shown("balanced"), forces);
  assert.equal(shown("unstable"), null);
});

test("the verdict flips between directions just inside and just outside a facet", () => {
  assert.equal(answer(page(), [1 - 1e-6, 0, -1]).verdict, "stable");
  assert.equal(answer(page(), [1 + 1e-6, 0, -1]).verdict, "unstable");
});

test("without a region only the given direction has an answer", () => {
  const loaded = page({ region: null, map: null });
  assert.equal(answer(loaded, DOWN).verdict, "stable");
  assert.equal(answer(loaded, [1, 0, -1]).verdict, "unknown");
  assert.match(basis(loaded, answer(loaded, [1, 0, -1])), /Only the given/);
});

test("directions outside an inner region are undecided", () => {
  const region = { ...page().region, outside: "undecided" };
  assert.equal(answer(page({ region }), [3, 0, -1]).verdict, "undecided");
  assert.match(basis(page({ region }), answer(page({ region }), [3, 0, -1])), /by the cone/);
});

test("directions between the inner and the outer cone are undecided", () => {
  const wide = pyramid.facets.map(([x, y, z]) => {
    const v = [0.6 * x, 0.6 * y, z];
    const n = Math.hypot(...v);
    return v.map((c) => c / n);
  });
  const region = {
    ...pyramid,
    facets: wide,
    inner: { facets: pyramid.facets, blur: -1e-5 },
    center: DOWN,
    inside: "potentially-stable",
    outside: "unstable",
  };
  assert.equal(verdictAt(region, [0.9, 0, -1]), "potentially-stable");
  // the direction nearest to an inner cone lies inside by its blur
  assert.equal(verdictAt(region, [1 - 1e-6, 0, -1]), "undecided");
  assert.equal(verdictAt(region, nearestHeld(region, [3, 1, -1])), "potentially-stable");
  assert.equal(verdictAt(region, [1.2, 0, -1]), "undecided");
  assert.equal(verdictAt(region, [2, 0, -1]), "unstable");
});

test("directions between two wedges are undecided", () => {
  const region = {
    ...cones.wedge,
    facets: [
      [1, 0.2, 0],
      [0.2, 1, 0],
    ].map((v) => v.map((c) => c / Math.hypot(1, 0.2))),
    inner: { facets: cones.wedge.facets, blur: 1e-8 },
    inside: "stable",
    outside: "unstable",
  };
  assert.equal(verdictAt(region, [1, 0.01, -3]), "stable");
  assert.equal(verdictAt(region, [1, -0.01, 3]), "undecided");
  assert.equal(verdictAt(region, [1, -0.3, 0]), "unstable");
});

test("neighbours of a thin inner cone are undecided, not unstable", () => {
  const region = {
    ...cones.fan,
    facets: cones.cone.facets,
    inner: { facets: cones.fan.facets, blur: 1e-8 },
    inside: "potentially-stable",
    outside: "unstable",
  };
  assert.equal(verdictAt(region, [1, 0, 1]), "potentially-stable");
  assert.equal(verdictAt(region, [1, 0.1, 1]), "undecided");
  assert.equal(verdictAt(region, [1, -0.1, 1]), "unstable");
});

test("a thin region has margin 0 out of it, and the words report it", () => {
  const region = { ...cones.fan, inside: "stable", outside: "unstable", words };
  const fan = page({ region, map: null });
  const found = answer(fan, [1, 0, 1]);
  assert.equal(found.margin, 0);
  assert.match(marginWords(fan, found), /45\.0° within the fan/);
  const off = answer(fan, [1, 0.1, 1]);
  assert.equal(off.verdict, "unstable");
  assert.match(marginWords(fan, off), /4\.04° away/);
  assert.match(movingWords(fan, off), /not known/);
});

test("forces for a direction inside combine those of the rays with the same weights", () => {
  const rays = {
    downs: [
      [1, 0, 0],
      [0, 0, -1],
    ],
    points: new Float32Array(3),
    parts: new Uint16Array([0, 1]),
    forces: new Float32Array([1, 0, 0, 0, 0, 5]),
  };
  const { forces } = balanceAt(rays, [0.6, 0, -0.8]);
  assert.deepEqual([...forces].map((f) => Number(f.toFixed(6))), [0.6, 0, 4]);
  assert.equal(balanceAt(rays, [0, 0, 1]), null);
  assert.equal(balanceAt(null, DOWN), null);
});

test("the farthest vertex gives z and the moving parts", () => {
  const { map } = page();
  assert.deepEqual(farthest(map.vertices, [-1, 0, 0]), [2, 2]);
  assert.equal(zOverMass(map, [1, 0, 0]), -1);
  assert.equal(zOverMass(map, [0, 0, 1]) + 0, 0);
  const motion = new Float32Array(12);
  motion[9] = 0.5; // the second part turns
  assert.deepEqual(movers(motion, new Float32Array([1, 2])), [1]);
  assert.deepEqual(movers(new Float32Array(12), new Float32Array([1, 2])), []);
});

test("arrays are unpacked at any depth", () => {
  assert.deepEqual(unpack({ type: "u2", data: "AQACAA==" }), new Uint16Array([1, 2]));
  // zlib.compress(bytes([1, 0, 2, 0]) * 300, 9) in Python
  const twice = unpack({ type: "u2", zlib: "eNpjZGBiYBzFo3gUj+IhgAFE4AOF" });
  assert.deepEqual(twice, Uint16Array.from({ length: 600 }, (_, k) => 1 + (k % 2)));
  const found = unpacked({ a: [{ type: "f4", data: "AACAPw==" }], type: "x", data: "y" });
  assert.deepEqual(found, { a: [new Float32Array([1])], type: "x", data: "y" });
});

test("words for one moving part, and for motions that further forces may prevent", () => {
  const found = { verdict: "unstable", moving: [1] };
  assert.equal(movingWords(page(), found), "1 of 1 free part moves: \u2068cube\u2069");
  assert.match(movingWords(page(), { ...found, verdict: "undecided" }), /^with the frictionless/);
  assert.equal(movingWords(page(), { verdict: "stable", moving: [] }), "no part moves");
});

test("the words of the region report that no direction holds", () => {
  const region = { ...cones.none, words, inside: "stable", outside: "unstable" };
  const found = answer(page({ region }), [1, 0, 0]);
  assert.equal(marginWords(page({ region }), found), "none is held");
});

test("with friction, the words state that the motion of the map ignores friction", () => {
  const region = { ...page().region, friction: true };
  const found = { verdict: "unstable", from: "cone", moving: [1] };
  assert.match(movingWords(page({ region }), found), /^with the frictionless contacts alone, 1 of 1/);
  assert.match(movingWords(page({ region }), { ...found, from: "given" }), /^1 of 1/);
});

test("words: angles, directions and names", () => {
  assert.equal(degrees(0), "0°");
  assert.equal(degrees(Math.PI / 4), "45.0°");
  assert.equal(direction([0, -1e-9, -1]), "(0, 0, −1)");
  assert.equal(short("<script>"), "\u2068<script>\u2069");
  assert.equal([...short("x".repeat(10000))].length, 42);
});
