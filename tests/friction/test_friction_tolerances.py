"""The order of the tolerances of friction."""

from itertools import pairwise

import pytest

from kilter.friction import friction_tolerances as t
from kilter.mechanics import mechanics_tolerances as judged

LADDERS = {
    "a motion, or none": [
        judged.WITNESS_POWER,
        t.COARSEST_NO_POWER,
        t.NO_POWER,
        t.OBEYED,
    ],
    "exact": [judged.WITNESS_EXACT, t.EXACTLY, t.SHARP, t.SOLVED],
    "first guesses": [t.CLEAR, t.NODE_GAP, t.SHARP],
    "sides of a mode": [t.SLOW, t.CLEAR, t.SLACK, t.SOLVED],
    "creeping": [t.CLEAR, t.CREEP, t.SLACK],
    "rounding": [t.FLAT, t.JOINT_RANK, t.CONE_ROUNDING, t.ZERO_ENTRY],
    "cones": [t.WIDEST_SECTOR, t.NARROWEST_CONE, t.POINT_AT_REST, t.CONE_ROUNDING],
    "seats": [t.BALANCED, t.GOAL],
    "converged": [t.GONE, t.STEADY, t.SHARP],
}


@pytest.mark.parametrize("name", LADDERS)
def test_each_is_below_the_one_before(name):
    ladder = LADDERS[name]
    assert all(coarse > fine for coarse, fine in pairwise(ladder))


def test_a_witness_has_a_thousand_times_the_power_that_counts_as_none():
    assert judged.WITNESS_POWER >= 1e3 * t.NO_POWER * (1 - 1e-12)


def test_a_seat_is_a_proof_of_equilibrium():
    assert t.BALANCED <= judged.TOLERANCE


def test_every_tolerance_is_listed_and_says_what_it_is():
    names = {name for name in vars(t) if name.isupper()}
    assert names == set(t.__all__)
