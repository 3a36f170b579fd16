"""Tolerances of regions, orientations and margins in the order that their places rely on."""

from __future__ import annotations

import numpy as np
import pytest

from kilter.analysis import turning_tolerances as of
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.solvers import solver_tolerances as solvers

ORDERED = [
    # rounding of a hull, optimal displacements, same optimum, beyond a facet, on the boundary
    ("HULL_ROUNDING", "OPTIMAL_FACE", "OPTIMAL", "OUTSIDE_HULL"),
    # on a plane, one ray, no projection, on a facet
    ("ON_PLANE", "SAME_RAY", "NO_PROJECTION", "RAY_BLUR", "NO_DIRECTION"),
    ("CONIC_SHARP", "TILT_AGREES", "PUSH_AGREES", "FOLLOWING_AGREES"),
    ("KAPPA_RESIDUAL", "KAPPA_GAP"),
    ("ENTRY_ROUNDING", "HULL_ROUNDING", "OPPOSITE", "SAME_POINT"),
]


@pytest.mark.parametrize("names", ORDERED)
def test_each_lies_below_the_next(names: tuple[str, ...]) -> None:
    values = [getattr(of, name) for name in names]
    assert values == sorted(set(values))


@pytest.mark.parametrize("name", ["PULLED_IN", "BEYOND_FACET", "BEYOND_CONE", "BEYOND_LIMIT"])
def test_steps_go_outwards(name: str) -> None:
    steps = getattr(of, name)
    assert list(steps) == sorted(set(steps))


def test_widths_lie_above_what_the_solvers_leave() -> None:
    assert of.BLUR_OVER_TOLERANCE * TOLERANCE > of.OUTSIDE_HULL
    assert of.CONIC_SHARP <= solvers.CONIC < of.LIMIT_AGREES < of.SIDES_APART
    # the gap that is asked for leaves room for the width of the rays and of the facets
    assert 2 * (of.RAY_BLUR + of.BEYOND_FACET[-1]) < np.radians(of.GAP_DEG)
    assert of.PULLED_IN[-1] <= of.RAY_BLUR
