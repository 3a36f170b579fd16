"""Census of `kilter.scene`: irregular scenes with inserted faults, whose states are known.

    python benchmarks/scene_census.py             100 scenes
    python benchmarks/scene_census.py 300 1000    300 scenes, from seed 1000 on

A scene has 6 to 40 places on held tables of different heights, far from each other, and at each a
group of objects: convex polyhedra, boxes, prisms, balls and cylinders, alone or in stacks of up to
four. Half of the scenes are turned in space with their gravity. Each fault is inserted with a size
of 1e-4 to 0.1 of the object:

    floats     a group is lifted, or an object above a group
    overlaps   the lowest object is sunk into its table, or an upper object into the lower
    leans      a box is tilted about its lower edge
    falls      the upper box of two overhangs by more than a half, or a box is on a slope whose
               tangent exceeds the friction

The expected states, heights and depths follow from the construction. Besides, `kilter.check` judges
each group without a fault alone with its table. The command prints counts, contradictions, the
largest error of a height and CPU times; the exit code is 1 if there are contradictions.
"""

from __future__ import annotations

import collections
import sys
import time
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

import kilter
from kilter import Assembly, Box, Cylinder, Mesh, Part, Pose, Prism, Sphere

Array = NDArray[np.float64]
FRICTION = 0.3
APART = 6.0
"""Distance of neighbouring places; a group is narrower than half of it."""
ALIKE = 1e-6
"""Largest relative error of a height or depth, beside 1e-9 of the length unit."""


@dataclass
class Group:
    """Objects of a place in the frame of its table, their expected states, and the held parts."""

    parts: list[Part] = field(default_factory=list)
    held: list[Part] = field(default_factory=list)
    expected: dict[str, tuple[str, float | None]] = field(default_factory=dict)
    faulty: bool = False


def polyhedron(rng: np.random.Generator) -> tuple[Mesh, float]:
    """A random convex polyhedron on a face that holds it, and its height above its origin."""
    while True:
        points = rng.normal(size=(int(rng.integers(6, 20)), 3)) * rng.uniform(0.4, 1.0, 3)
        hull = ConvexHull(points)
        corners = hull.points[hull.vertices]
        center = Assembly([Part("a", _mesh(hull))]).geometry.center[0]
        order = rng.permutation(len(hull.equations))
        for k in order.tolist():
            normal, offset = hull.equations[k, :3], hull.equations[k, 3]
            face = hull.points[hull.simplices[k]]
            below = center - (center @ normal + offset) * normal
            # inside of the triangle by a margin, so that the verdict is not critical
            weights = np.linalg.lstsq(np.vstack([face.T, np.ones(3)]), np.append(below, 1), None)[0]
            if weights.min() < 0.1 or -(center @ normal + offset) < 0.05:
                continue
            turn = Rotation.align_vectors([[0, 0, -1]], [normal])[0].as_matrix()
            placed = (corners - below) @ turn.T
            placed[:, 2] -= placed[:, 2].min()
            return _mesh(ConvexHull(placed)), float(np.ptp(placed[:, 2]))


def _mesh(hull: ConvexHull) -> Mesh:
    corners, faces = hull.points, hull.simplices.copy()
    triangles = corners[faces]
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    inward = np.einsum("ij,ij->i", normal, hull.equations[:, :3]) < 0
    faces[inward] = faces[inward][:, ::-1]
    return Mesh(corners, faces)


def single(rng: np.random.Generator, name: str) -> tuple[Part, float]:
    """An object that stands on z = 0 at the origin, and its size."""
    kind = int(rng.integers(5))
    turn = Rotation.from_euler("z", rng.uniform(0, 6)).as_matrix()
    if kind == 0:
        mesh, height = polyhedron(rng)
        return Part(name, mesh, Pose.of(turn)), height
    if kind == 1:
        size = rng.uniform(0.3, 1.2, 3)
        return Part(name, Box(size), Pose([0, 0, size[2] / 2], Pose.of(turn).rotation)), size.min()
    if kind == 2:
        angles = np.arange(5) * 2 * np.pi / 5
        outline = rng.uniform(0.3, 0.7) * np.column_stack([np.cos(angles), np.sin(angles)])
        upright = Rotation.from_euler("x", 90, degrees=True).as_matrix()
        depth = float(rng.uniform(0.3, 1.0))
        pose = Pose([0, 0, depth / 2], Pose.of(turn @ upright).rotation)
        return Part(name, Prism(outline, depth), pose), depth
    radius = float(rng.uniform(0.2, 0.6))
    if kind == 3:
        return Part(name, Sphere(radius), Pose([0, 0, radius], Pose.of(turn).rotation)), radius
    height = float(rng.uniform(0.3, 1.2))
    return Part(name, Cylinder(radius, height), [0, 0, height / 2]), min(radius, height)


def stack(rng: np.random.Generator, name: str) -> tuple[list[Part], float]:
    """Boxes of which each has its centre well over the box below, and their least size."""
    parts, top, center, least = [], 0.0, np.zeros(2), 9.0
    width = np.array([1.4, 1.4])
    for k in range(int(rng.integers(2, 5))):
        size = np.array([*rng.uniform(0.5, 1.4, 2), rng.uniform(0.2, 0.6)])
        # the centre of mass of all upper boxes stays over each box below
        shift = rng.uniform(-0.04, 0.04, 2) * np.minimum(size[:2], width)
        center = center + shift
        parts.append(Part(f"{name}.{k}", Box(size), [*center, top + size[2] / 2]))
        top, width, least = top + size[2], size[:2], min(least, float(size.min()))
    return parts, least


def moved(part: Part, step: Array, turn: Array | None = None) -> Part:
    """A part after a turn about the origin and a step."""
    turn = np.eye(3) if turn is None else turn
    pose = Pose(turn @ part.pose.position + step, Pose.of(turn @ part.pose.matrix).rotation)
    return replace(part, pose=pose)


def group(rng: np.random.Generator, name: str) -> Group:
    """A random group, with a fault in one of three cases."""
    made = Group()
    whole = bool(rng.integers(2))
    if whole:
        part, size = single(rng, name)
        made.parts = [part]
    else:
        made.parts, size = stack(rng, name)
    fault = ("floats", "overlaps", "leans", "falls")[int(rng.integers(4))]
    made.expected = {part.name: ("at-rest", None) for part in made.parts}
    if rng.random() > 1 / 3:
        return made
    made.faulty = True
    shift = float(size * 10 ** rng.uniform(-4, -1))
    up = np.array([0, 0, shift])
    last = made.parts[-1]
    if fault == "floats" and (whole or rng.random() < 0.5):
        made.parts = [moved(part, up) for part in made.parts]
        made.expected = {part.name: ("floats", shift) for part in made.parts}
    elif fault == "floats":
        made.parts[-1] = moved(last, up)
        made.expected[last.name] = ("floats", shift)
    elif fault == "overlaps" and (whole or rng.random() < 0.5):
        made.parts = [moved(part, -up) for part in made.parts]
        made.expected[made.parts[0].name] = ("overlaps", -shift)
    elif fault == "overlaps":
        made.parts[-1] = moved(last, -up)
        made.expected[last.name] = ("overlaps", -shift)
    elif fault == "leans":
        size = rng.uniform(0.4, 1.0, 3)
        angle = float(rng.uniform(0.05, 0.5))
        turn = Rotation.from_euler("y", angle).as_matrix()
        box = Part(name, Box(size), [-size[0] / 2, 0, size[2] / 2])
        made.parts = [moved(box, np.zeros(3), turn)]  # turned about its lower edge x = 0
        critical = np.arctan(size[0] / size[2])
        made.expected = {name: ("falls", None)}
        if abs(angle - critical) < 0.02:
            made.expected = {name: ("any", None)}
    elif rng.random() < 0.5:
        low = Part(f"{name}.low", Box([1, 1, 0.5]), [0, 0, 0.25])
        over = float(0.5 + rng.uniform(1e-3, 0.4))
        high = Part(f"{name}.high", Box([1, 1, 0.5]), [over, 0, 0.75])
        made.parts = [low, high]
        made.expected = {low.name: ("at-rest", None), high.name: ("falls", None)}
    else:
        slope = FRICTION + float(rng.choice([-1, 1]) * 10 ** rng.uniform(-3, -1))
        turn = Rotation.from_euler("y", np.arctan(slope)).as_matrix()
        wedge = Part(f"{name}.slope", Box([2, 2, 0.2]), Pose.of(turn), grounded=True)
        box = Part(name, Box([0.5, 0.5, 0.3]), [0, 0, 0.25])
        made.held = [moved(wedge, np.array([0, 0, 1.5]))]
        made.parts = [moved(box, np.array([0, 0, 1.5]), turn)]
        made.expected = {name: ("falls" if slope > FRICTION else "at-rest", None)}
        made.faulty = slope > FRICTION
    return made


def scene_of(seed: int) -> tuple[Assembly, list[Group], Array]:
    """A random scene, its groups, and the turn of the scene."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(6, 41))
    turn = np.eye(3)
    if seed % 2:
        turn = Rotation.random(random_state=np.random.RandomState(seed)).as_matrix()
    groups = []
    parts: list[Part] = []
    for k in range(count):
        made = group(rng, f"g{k}")
        place = np.array([APART * (k % 7), APART * (k // 7), float(rng.uniform(-1, 1))])
        table = Part(f"table{k}", Box([4, 4, 0.3]), [0, 0, -0.15], grounded=True)
        made.held.append(table)
        made.held = [moved(moved(part, place), np.zeros(3), turn) for part in made.held]
        made.parts = [moved(moved(part, place), np.zeros(3), turn) for part in made.parts]
        parts += made.held + made.parts
        groups.append(made)
    gravity = turn @ np.array([0, 0, -9.81])
    return Assembly(parts, gravity=gravity, friction=FRICTION), groups, gravity


def main() -> int:
    """Run the census; return 1 if there is a contradiction."""
    numbers = [int(word) for word in sys.argv[1:]]
    scenes, first = (*numbers, 100)[0], (*numbers, 0, 0)[1] if len(numbers) > 1 else 0
    counts: collections.Counter[str] = collections.Counter()
    wrong: list[str] = []
    seconds, objects, worst_error = [], 0, 0.0
    for seed in range(first, first + scenes):
        assembly, groups, gravity = scene_of(seed)
        began = time.process_time()
        report = kilter.scene(assembly)
        seconds.append((time.process_time() - began, len(assembly)))
        for made in groups:
            for name, (state, gap) in made.expected.items():
                entry = report[name]
                objects += 1
                counts[f"{state} -> {entry.state}"] += 1
                if state != "any" and entry.state != state:
                    wrong.append(f"seed {seed}: {name} {state}, but the scene says {entry}")
                elif gap is not None and entry.gap is not None:
                    error = abs(entry.gap - gap)
                    worst_error = max(worst_error, error)
                    if error > ALIKE * abs(gap) + 1e-9:
                        wrong.append(f"seed {seed}: {name} {gap}, but the scene says {entry.gap}")
            if not made.faulty:
                alone = Assembly(made.held + made.parts, gravity=gravity, friction=FRICTION)
                level = kilter.check(alone).level
                found = {report[part.name].level for part in made.parts}
                if found != {level}:
                    wrong.append(f"seed {seed}: levels {found}, but check says {level}")
    for line in wrong:
        print(line)
    for key, number in sorted(counts.items()):
        print(f"{number:6}  {key}")
    (slowest, size), total = max(seconds), sum(each for each, _ in seconds)
    print(f"largest error of a height or depth: {worst_error:.1e}")
    print(f"CPU s per scene: worst {slowest:.2f} ({size} parts), all {total:.0f}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
