"""The order of the tolerances of solvers, checks and answers."""

from itertools import pairwise

import pytest

from kilter.analysis import analysis_tolerances as told
from kilter.mechanics import mechanics_tolerances as judged
from kilter.solvers import solver_tolerances as asked

LADDERS = {
    "asked of HiGHS, and believed": [
        asked.WIDE,
        asked.NEAR_BOUND,
        asked.BELIEVED,
        asked.BOUNDED_FEASIBLE,
        asked.FEASIBLE,
        asked.NEGLIGIBLE_ENTRY,
        asked.EPSILON,
    ],
    "asked of Clarabel, and believed": [
        asked.BELIEVED,
        asked.QUADRATIC_GOOD,
        asked.CONIC,
        asked.CONIC_FIRST,
        asked.EPSILON,
    ],
    "exact data": [judged.TOLERANCE, asked.FEASIBLE],
    "a witness": [
        judged.WITNESS_SLIVER,
        judged.WITNESS_POWER,
        judged.WITNESS_EXACT,
        judged.CONE_ROUNDING,
    ],
    "rounding": [judged.TOLERANCE, judged.MIRROR_ROWS, judged.MIRROR, judged.ZERO_ENTRY],
    "what moves": [
        told.MOVES,
        told.MOTION_ENOUGH,
        told.MOTION_ASKED,
        told.MOTION_GOOD,
        told.ZERO_MOTION,
    ],
}


@pytest.mark.parametrize("name", LADDERS)
def test_each_is_below_the_one_before(name):
    assert all(coarse > fine for coarse, fine in pairwise(LADDERS[name]))


def test_forces_and_a_motion_never_prove_both():
    # rounding of the largest forces stays below the tolerance (`test_never_both`)
    assert judged.UNITS_IN_LAST_PLACE * judged.RULED_OUT < judged.TOLERANCE
    assert judged.UNITS_IN_LAST_PLACE < judged.EXCESS < judged.TOLERANCE
    # the judges ask for no more than programs, scaled to one weight, are solved to
    assert asked.LARGEST_POINT >= judged.RULED_OUT


def test_nothing_is_told_finer_than_it_is_judged():
    assert min(told.ENTERS, told.RANK, told.PRESSES) >= judged.TOLERANCE
    assert judged.AGREES <= judged.TOLERANCE
    assert judged.TOLERANCE < judged.NORMAL_ANGLE <= judged.STILL


@pytest.mark.parametrize("module", [judged, told])
def test_every_tolerance_is_listed(module):
    assert {name for name in vars(module) if name.isupper()} == set(module.__all__)
