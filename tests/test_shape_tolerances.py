"""The tolerances of shapes are in a single file, and in the order that it states."""

from itertools import pairwise

import numpy as np
import pytest

from kilter.shape import shape_tolerances as t
from literals import unnamed

CHAINS = [
    ("NO_AREA", "PLANE_FLATNESS", "WELD"),
    ("LEAST_TURN", "FACET_NORMAL", "STEEPEST_EDGE"),
    ("PLANE_ROUNDINGS", "EVIDENCE", "GROWING"),
    ("STEP_RANK", "FIT_RANK", "BEHIND_APEX", "NARROWEST_CONE", "WIDEST_CONE"),
]


@pytest.mark.parametrize("chain", CHAINS, ids=lambda chain: " < ".join(chain))
def test_tolerances_are_ordered(chain):
    values = [getattr(t, name) for name in chain]
    assert all(low < high for low, high in pairwise(values))


def test_prism_of_twelve_sides_is_round_and_one_of_eleven_is_not():
    assert 2 * np.pi / 12 < t.STEEPEST_EDGE < 2 * np.pi / 11


def test_what_is_welded_fits_a_surface():
    assert t.WELD == t.SURFACE_FIT


def test_no_small_number_of_the_shapes_goes_without_a_name():
    assert unnamed("shape", but="shape_tolerances.py") == []
