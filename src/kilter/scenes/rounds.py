"""Piles of cylinders and spheres of radius 1 on a held floor."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from kilter.assembly import Assembly, FrictionPair, Part
from kilter.rigid import Pose
from kilter.scenes.pieces import floor, turn
from kilter.scenes.registry import listed
from kilter.shape.primitives import Cylinder, Shape, Sphere


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
