import assert from "node:assert/strict";
import test from "node:test";
import { along, arcs, contains, distance, margin, nearest, outline, shares } from "../src/cone.js";
import { add, angleBetween, dot, norm, scaled, turnedAbout, unit } from "../src/vector.js";
import { cones, directions, pyramid } from "./cones.js";

const near = (a, b, within = 1e-9) => assert.ok(Math.abs(a - b) < within, `${a} is not ${b}`);

for (const [kind, cone] of Object.entries({ ...cones, pyramid })) {
  test(`${kind}: rays, lines and their sums are in it, the far side of each facet is not`, () => {
    for (const ray of cone.rays) assert.ok(contains(cone, ray));
    for (const line of cone.lines) {
      assert.ok(contains(cone, line));
      assert.ok(contains(cone, scaled(line, -3)));
    }
    const all = [...cone.rays, ...cone.lines];
    if (all.length) assert.ok(contains(cone, all.reduce(add)));
    for (const facet of cone.facets) assert.ok(!contains(cone, scaled(facet, -1)));
    for (const e of cone.equations) {
      assert.ok(!contains(cone, e));
      assert.ok(!contains(cone, scaled(e, -1)));
    }
    assert.ok(!contains(cone, [0, 0, 0]));
  });

  test(`${kind}: every arc lies on the boundary, and just beside it both answers are met`, () => {
    for (const arc of arcs(cone)) {
      for (let t = 0; t <= arc.angle; t += arc.angle / 16 || 1) {
        const p = along(arc, t);
        near(norm(p), 1);
        assert.ok(contains(cone, p), `${p}`);
        if (cone.facets.length && cone.dimension === 3) near(margin(cone, p), 0, 1e-7);
      }
    }
  });

  test(`${kind}: the nearest direction is in it, and no sampled one is nearer`, () => {
    for (const u of directions(60)) {
      const foot = nearest(cone, u);
      if (foot === null) {
        assert.equal(kind, "none");
        continue;
      }
      assert.ok(contains({ ...cone, blur: 1e-7 }, foot));
      near(distance(cone, u), contains(cone, u) ? 0 : angleBetween(u, foot));
      for (const other of directions(200, 3)) {
        if (contains(cone, other)) {
          assert.ok(angleBetween(u, other) > angleBetween(u, foot) - 1e-6);
        }
      }
    }
  });
}

test("the arcs of a solid cone close a loop, those of a wedge and a cone share their ends", () => {
  for (const kind of ["cone", "wedge"]) {
    const all = arcs(cones[kind]);
    all.forEach((arc, k) => {
      const end = along(arc, arc.angle);
      const start = all[(k + 1) % all.length].u;
      near(angleBetween(end, start), 0);
    });
  }
});

test("the margin is the angle to the nearest facet: a slightly smaller turn stays inside, a larger one leaves", () => {
  for (const u of directions(400)) {
    if (!contains(pyramid, u)) continue;
    const m = margin(pyramid, u);
    const facet = pyramid.facets.reduce((a, b) => (dot(a, u) < dot(b, u) ? a : b));
    // towards the nearest facet: the rotation that takes u straight at it
    const axis = unit([
      u[1] * -facet[2] - u[2] * -facet[1],
      u[2] * -facet[0] - u[0] * -facet[2],
      u[0] * -facet[1] - u[1] * -facet[0],
    ]);
    assert.ok(contains(pyramid, turnedAbout(u, axis, m - 1e-6)));
    assert.ok(!contains(pyramid, turnedAbout(u, axis, m + 1e-6)));
  }
});

test("margins: 45 degrees at the axis of the pyramid, 90 in half-spaces, 180 in the whole space", () => {
  near(margin(pyramid, [0, 0, -1]), Math.PI / 4);
  near(margin(cones["half-space"], [0, 0, -1]), Math.PI / 2);
  near(margin(cones.all, [0, 0, -1]), Math.PI);
});

test("directions within the blur count as on the boundary, beyond it as outside", () => {
  const tilted = (angle) => [Math.sin(angle), 0, -Math.cos(angle)];
  assert.ok(contains(cones.ray, tilted(0.9e-8)));
  assert.ok(!contains(cones.ray, tilted(1.1e-8)));
});

test("the outline from facets equals the boundary from rays", () => {
  const length = (all) => all.reduce((sum, arc) => sum + arc.angle, 0);
  for (const cone of [pyramid, cones.cone, cones.wedge, cones["half-space"]]) {
    const found = outline(cone.facets);
    assert.ok(Math.abs(length(found) - length(arcs(cone))) < 1e-9);
    for (const arc of found) {
      for (const share of [0.01, 0.5, 0.99]) {
        const u = along(arc, share * arc.angle);
        assert.ok(margin(cone, u) < 1e-9 && contains({ ...cone, blur: 1e-9 }, u));
      }
    }
  }
  const corner = cones.cone.facets;
  assert.deepEqual(outline([...corner, corner[0].map((c) => -c)]).length, 2);
});

test("weights of rays reproduce every direction inside, and no direction outside", () => {
  const { rays } = pyramid;
  for (const u of directions(300)) {
    const found = shares(rays, u);
    assert.equal(found !== null, contains(pyramid, u));
    if (!found) continue;
    const sum = found.reduce((p, [k, s]) => add(p, scaled(rays[k], s)), [0, 0, 0]);
    near(norm(add(sum, scaled(u, -1))), 0, 1e-7);
    assert.ok(found.every(([, s]) => s >= 0));
  }
  assert.deepEqual(shares([[0, 0, -1]], [0, 0, -1]), [[0, 1]]);
  assert.equal(shares([[0, 0, -1]], [0, 0, 1]), null);
});
