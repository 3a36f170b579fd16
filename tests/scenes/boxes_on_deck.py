"""Stacks of boxes on a held deck, whose limits of acceleration are closed forms."""

from collections.abc import Sequence

import numpy as np

from kilter.assembly import Assembly
from kilter.assembly.part import Part
from kilter.rigid import Pose
from kilter.shape.primitives import Box

WIDE = 40.0
"""Width of the deck [m]."""


def stack_on_deck(
    sizes: Sequence[Sequence[float]],
    friction: float,
    *,
    shifts: Sequence[Sequence[float]] | None = None,
    at: Sequence[float] = (0.0, 0.0),
) -> Assembly:
    """Boxes, the lowest first, on a deck whose top is z = 0; each shifted from `at` by x and y."""
    parts = [Part("deck", Box([WIDE, WIDE, 1.0]), Pose([0, 0, -0.5]), grounded=True)]
    height = 0.0
    for k, size in enumerate(sizes):
        shift = (0.0, 0.0) if shifts is None else shifts[k]
        center = [at[0] + shift[0], at[1] + shift[1], height + size[2] / 2]
        parts.append(Part(f"box-{k}", Box(list(size)), Pose(center)))
        height += size[2]
    return Assembly(parts, friction=friction)


def portal(post: Sequence[float], *, friction: float, clear: float = 0.2) -> Assembly:
    """Two posts and a lintel flush with their outer faces: post (width, height) in x and z."""
    wide, high = post
    parts = [Part("deck", Box([WIDE, WIDE, 1.0]), Pose([0, 0, -0.5]), grounded=True)]
    offset = (clear + wide) / 2
    for name, sign in (("left", -1), ("right", 1)):
        parts.append(Part(name, Box([wide, 0.05, high]), Pose([sign * offset, 0, high / 2])))
    lintel = Box([2 * wide + clear, 0.05, wide])
    parts.append(Part("lintel", lintel, Pose([0, 0, high + wide / 2])))
    return Assembly(parts, friction=friction)


def random_stack(seed: int) -> Assembly:
    """Two to six boxes of random sizes, shifts, densities and friction, under random gravity."""
    rng = np.random.default_rng([38, seed])
    count = int(rng.integers(2, 7))
    parts = [Part("deck", Box([WIDE, WIDE, 1.0]), Pose([0, 0, -0.5]), grounded=True)]
    height, place = 0.0, np.zeros(2)
    for k in range(count):
        size = rng.uniform([0.4, 0.4, 0.2], [1.2, 1.2, 0.9])
        place = place + rng.uniform(-0.12, 0.12, 2)
        turn = rng.uniform(0, np.pi)
        pose = Pose([*place, height + size[2] / 2], [np.cos(turn / 2), 0, 0, np.sin(turn / 2)])
        parts.append(Part(f"box-{k}", Box(size), pose, density=rng.uniform(300, 3000)))
        height += size[2]
    gravity = [0, 0, -rng.uniform(1.6, 12)]
    return Assembly(parts, friction=float(rng.uniform(0.15, 0.9)), gravity=gravity)
