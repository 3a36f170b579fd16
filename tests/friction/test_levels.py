"""Limits of known cases, on both sides, in the words of levels.

A case is built at a share of its limit: inside at .98, outside at 1.02, where no forces of
equilibrium are left and the level is None. Closed forms are those of each function.
"""

from __future__ import annotations

import dataclasses
from functools import partial

import numpy as np
import pytest
from judged import judged
from transformations import tilted

from kilter.scenes import arches, friction, stacks, walls

INSIDE, OUTSIDE = 0.98, 1.02
THINNEST = 0.10743
"""Thickness of a semicircle of 40 voussoirs over the radius of its middle line."""


def degrees(tangent):
    return float(np.degrees(np.arctan(tangent)))


def slope(share, mu, width):
    """S1: tan = min(mu, width / height)."""
    return stacks.block_on_slope(degrees(share * min(mu, width)), width=width, friction=mu)


def tower(share, count, planar=False):
    """S2: tan = 1 / count; it does not slide before."""
    made = tilted(stacks.tower(count).with_friction(0.9), [0, 1, 0], degrees(share / count))
    return dataclasses.replace(made, planar=planar)


def ladder(share, mu_wall, planar=False):
    """S4: tan = (1 - mu_floor mu_wall) / (2 mu_floor); steeper is safer."""
    least = degrees((1 - 0.4 * mu_wall) / 0.8 / share)
    return friction.ladder(least, friction_wall=mu_wall, planar=planar)


def bracket(share):
    """S5: the load stands off by h / (2 mu) at least."""
    return friction.bracket(1 / (2 * 0.6) / share, friction=0.6, pad=1e-4)


def books(share, count, thickness):
    """S6: pressed by n w / (2 mu) and n^2 w t / (8 h) at least."""
    weight, height, mu = 9.81, 0.25, 0.5
    least = max(count * weight / (2 * mu), count**2 * weight * thickness / (8 * height))
    return friction.books(
        count, force=least / share, friction=mu, thickness=thickness, height=height
    )


def leaning_wall(share, mu, limit):
    """S7: nine courses overturn at atan W / 9 H, or slide at atan mu."""
    return walls.tilted_wall(share * limit, friction=mu, per_course=2)


def between_plates(share):
    """I2: mu = tan of the half angle."""
    return friction.a_block(10.0, friction=float(np.tan(np.radians(10.0))) / share)


def between_walls(share):
    """I1: any mu above 0."""
    return friction.h_block(friction=max(1.0 - share, 0.0))


def arch(share):
    """A1: the least thickness of a semicircle."""
    return arches.arch(40, ratio=THINNEST / share, friction=0.7, planar=True)


def ring(share):
    """A2: the same as sectors of a ring, with friction just above the least that suffices."""
    return arches.arch(80, ratio=THINNEST / share, friction=0.4, sectors=True, planar=True)


LIMITS = {
    "S1 slides": (partial(slope, mu=0.5, width=2.0), {"proved"}),
    "S1 slides soon": (partial(slope, mu=0.2, width=1.0), {"proved"}),
    "S1 tips": (partial(slope, mu=0.9, width=0.5), {"proved"}),
    "S2 of 3": (partial(tower, count=3), {"proved"}),
    "S2 of 10, plane": (partial(tower, count=10, planar=True), {"proved"}),
    "S4": (partial(ladder, mu_wall=0.0), {"proved"}),
    "S4 rough wall, plane": (partial(ladder, mu_wall=0.3, planar=True), {"proved"}),
    "S5": (bracket, {"equilibrium"}),
    "S6 slip": (partial(books, count=4, thickness=0.05), {"equilibrium"}),
    "I1": (between_walls, {"equilibrium"}),
    "I2": (between_plates, {"equilibrium"}),
}
"""Builder of a share of the limit; the level inside."""
LONG = {
    "S2 of 10": (partial(tower, count=10), {"settles"}),
    "S4 rough wall": (partial(ladder, mu_wall=0.3), {"settles"}),
    "S6 sag": (partial(books, count=12, thickness=0.25), {"settles"}),
    "S7 overturns": (partial(leaning_wall, mu=0.6, limit=degrees(0.1 / 0.54)), {"settles"}),
    "S7 slides": (partial(leaning_wall, mu=0.15, limit=degrees(0.15)), {"settles"}),
    "A1": (arch, {"settles", "proved"}),
    "A2": (ring, {"settles", "proved"}),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [*LIMITS, *(pytest.param(name, marks=pytest.mark.slow) for name in LONG)]
)
def test_both_sides_of_a_limit_have_their_levels(name):
    build, levels = {**LIMITS, **LONG}[name]
    inside, outside = judged(build(INSIDE)), judged(build(OUTSIDE))
    assert inside.level in levels
    assert (outside.verdict, outside.level) == ("unstable", None)
    if inside.level == "equilibrium":
        assert inside.why == "refuted"
        # books settle, though a motion of small power exists
        assert inside.tries.passed == (8 if name.startswith("S6") else 0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tilt", "level"),
    [(44.126 - 0.05, "proved"), (44.126 + 0.05, "equilibrium"), (47.961 - 0.05, "equilibrium"),
     (47.961 + 0.05, None)],
)  # fmt: skip
def test_i3_a_trough_passes_through_three_levels(tilt, level):
    """It slips at tan = mu / cos beta; forces exist up to tan = mu / (cos^2 - mu^2 sin^2)^1/2."""
    assert judged(friction.trough(30.0, tilt=tilt, friction=0.84)).level == level


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "thickness"),
    [(12, 0.5), *(pytest.param(*more, marks=pytest.mark.slow) for more in (
        (12, 1.0), (12, 2.0), (20, 0.5), (20, 2.0), (6, 2.0)))],
)  # fmt: skip
def test_w6_arches_settle(count, thickness):
    held = arches.arch_with_held_ends(count, thickness=thickness, friction=0.7)
    assert judged(held).level in ("settles", "proved")
