"""Scenes that are easily answered wrongly: floating, overlapping, split and inverted parts."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from kilter.assembly import Assembly, FrictionPair, Part
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.scenes.pieces import block, cells, floor, prism, tube, turn
from kilter.scenes.registry import listed
from kilter.shape.primitives import Cylinder, Mesh, Shape, Sphere, surface

# Scene of a typical CAD export: threads as cylinders, intended gaps, a misplaced part.


@listed(
    "cad-export",
    "a lamp exported from CAD: a thread, a gap, a pin with play, a loose switch",
    source="open pairs",
    answer="unstable",
)
def cad_export() -> Assembly:
    """A lamp as exported from CAD: base, post, shade, screw, ring, pin, and a switch beside; in mm.

    - `screw` in `post`: the screw has the radius of the thread, 2 mm, and the hole that of the
      core, 1.65 mm. They overlap, and as drawn no contact carries a force.
    - `shade` on `post`: 0.02 mm above it, more than the gap tolerance.
    - `pin` in `ring`: 0.2 mm of play; the pin stands on the base.
    - `switch`: 3 mm above the base. It touches nothing and falls, whatever the other parts do.
    """
    parts = [
        block("base", [-40, -30, -10], [40, 30, 0], grounded=True),
        tube("post", 1.65, 6, 30, [0, 0, 15], density=7850.0),
        block("shade", [-20, -15, 30.02], [20, 15, 34], density=2700.0),
        Part("screw", Cylinder(2, 10), Pose([0, 0, 24.5]), density=7850.0),
        tube("ring", 4.2, 7, 4, [-28, 0, 2], density=7850.0),
        Part("pin", Cylinder(4, 14), Pose([-28, 0, 7]), density=7850.0),
        block("switch", [24, -5, 3], [34, 5, 9], density=1200.0),
    ]
    return Assembly(parts, units="mm")


@listed("floating-block", "a row of blocks with a floating block", source="W1", answer="unstable")
def floating_block(index: int = 2, *, count: int = 5) -> Assembly:
    """Case W1: cubes on a floor and a single cube 1 m above them, which falls freely.

    Arguments: `index`: index of the floating cube, from 0, or negative from the end; it is part
    `index` + 1.
    """
    if not -count <= index < count:
        raise InputError(f"there is no cube {index} of {count}", hint=f"give 0 to {count - 1}")
    heights = np.zeros(count)
    heights[index] = 1.0
    cubes = [
        block(f"cube-{k}", [2.0 * k, 0, z], [2.0 * k + 1, 1, z + 1])
        for k, z in enumerate(heights.tolist())
    ]
    return Assembly([floor([-1, -1], [2.0 * count, 2]), *cubes])


def penetrating_cube(depth: float = 0.1) -> Assembly:
    """Case W2: a unit cube in mid-air that overlaps a held cube sideways by `depth` [m].

    No contact carries the cube, but the overlap might be a joint. The verdict is undecided and
    must name the pair.
    """
    return Assembly(
        [
            block("held", [0, 0, 0], [1, 1, 1], grounded=True),
            block("cube", [1 - depth, 0, 0], [2 - depth, 1, 1]),
        ]
    )


@listed("laden-slab", "a slab that carries 125 cubes", source="W7", answer="stable")
def laden_slab() -> Assembly:
    """Case W7: a held slab with 25 unit cubes and 100 cubes of side 0.1; stable, 125 patches."""
    large = [
        block(f"large-{i}-{j}", [2.0 * i, 2.0 * j, 0], [2.0 * i + 1, 2.0 * j + 1, 1])
        for i in range(5)
        for j in range(5)
    ]
    small = [
        block(f"small-{i}-{j}", [10 + i, j, 0], [10.1 + i, j + 0.1, 0.1])
        for i in range(10)
        for j in range(10)
    ]
    return Assembly([floor([-1, -1], [21, 11], name="slab"), *large, *small])


def bridge_on_slab() -> Assembly:
    """Case W8: a bridge on a held slab with two coplanar patches of 1 x 1; area 2, stable."""
    polygon = [[0, 0], [1, 0], [1, 1], [3, 1], [3, 0], [4, 0], [4, 2], [0, 2]]
    return Assembly([floor([-1, -1], [5, 1], name="slab"), prism("bridge", polygon)])


def ring_on_slab() -> Assembly:
    """Case W8: a square ring flat on a held slab, 4 x 4 minus 2 x 2; area 12, stable."""
    lines = [-2.0, -1.0, 1.0, 2.0]
    solid = np.ones((3, 3, 1), dtype=bool)
    solid[1, 1, 0] = False
    shape = cells(lines, lines, [0.0, 1.0], solid)
    return Assembly([floor([-3, -3], [3, 3], name="slab"), Part("ring", shape)])


def inward_base() -> Assembly:
    """Case W9: a unit cube on a held mesh with inverted faces; stable, with a warning."""
    base = floor([-1, -1], [1, 1], name="base")
    vertices, triangles = surface(base.shape)
    shape = Mesh(base.pose.apply(vertices), triangles[:, ::-1])
    return Assembly(
        [
            Part("base", shape, Pose(), grounded=True),
            block("cube", [-0.5, -0.5, 0], [0.5, 0.5, 1]),
        ]
    )


# Piles of cylinders and spheres of radius 1 on a held floor.


@listed("three-cylinders", "a cylinder on two cylinders", source="R1", answer="settles")
def three_cylinders(*, friction_between: float = 0.3, friction_ground: float = 0.1) -> Assembly:
    """Case R1: two cylinders along y and a third on them; all touch each other.

    The pile holds if the friction between cylinders is at least 2 - sqrt 3 = 0.267949, and that
    on the ground at least a third of this.
    """
    centers = [[-1.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1 + np.sqrt(3)]]
    return _pile("cylinder", Cylinder(1.0, 2.0), centers, friction_between, friction_ground)


def four_spheres(*, friction_between: float = 0.33, friction_ground: float = 0.09) -> Assembly:
    """Case R2: three spheres and a fourth on them; all touch each other.

    The pile holds if the friction between spheres is at least sqrt 3 - sqrt 2 = 0.317837, and that
    on the ground at least a quarter of this.
    """
    side = 2 / np.sqrt(3)
    angles = np.radians([90, 210, 330])
    centers = [[side * np.cos(a), side * np.sin(a), 1.0] for a in angles]
    centers.append([0.0, 0.0, 1 + np.sqrt(8 / 3)])
    return _pile("sphere", Sphere(1.0), centers, friction_between, friction_ground)


def _pile(
    name: str, shape: Shape, centers: list[list[float]], between: float, ground: float
) -> Assembly:
    rotation = turn([1, 0, 0], 90) if isinstance(shape, Cylinder) else (1, 0, 0, 0)
    parts = [Part(f"{name}-{k}", shape, Pose(x, rotation)) for k, x in enumerate(centers)]
    pairs = [FrictionPair((a.name, b.name), between) for a, b in combinations(parts, 2)]
    return Assembly([floor([-4, -4], [4, 4]), *parts], friction=ground, friction_pairs=pairs)
