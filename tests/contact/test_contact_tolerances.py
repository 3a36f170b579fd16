"""The tolerances of contacts are defined in a single file, and in the order that it states."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from kilter.assembly import Assembly, Part
from kilter.contact import Tolerance
from kilter.contact import contact_tolerances as t
from kilter.contact.common.gaps import nearest_gap, reach_of, touches
from kilter.shape.primitives import Box
from literals import unnamed

CHAINS = [
    ("PATCH_ANGLE", "ANGLE", "LOOSE_ANGLE", "LOOKED_AT_ANGLE"),
    ("SAME_PLACE", "FACET_FLATNESS", "GAP", "ONE_POINT", "LOOSE_GAP"),
    ("CLUSTER", "LOOKED_AT_GAPS"),
    ("CONE_ANGLE", "NORMAL_SNAP", "NORMAL_ANGLE"),
    ("EXACT_ANGLE", "LITERAL_ANGLE", "CONE_ANGLE"),
    ("MEETS_EXACTLY", "SAME_PLACE", "VERTEX_ON_EDGE", "FACET_FLATNESS"),
    ("EDGE_PARALLEL", "EDGE_NEARLY_PARALLEL", "SMOOTH_ANGLE", "FACETED_ANGLE"),
]


@pytest.mark.parametrize("chain", CHAINS, ids=lambda chain: " < ".join(chain))
def test_tolerances_are_ordered(chain: tuple[str, ...]) -> None:
    values = [getattr(t, name) for name in chain]
    assert all(low < high for low, high in pairwise(values))


def test_one_true_normal_found_from_both_sides_is_one() -> None:
    # faces tilted by the angle tolerance, directions off by what counts as a plane, both ways
    assert t.ANGLE <= t.CONE_ANGLE
    assert t.ANGLE + t.CONE_ANGLE <= t.NORMAL_SNAP
    assert 2 * t.NORMAL_SNAP < t.NORMAL_ANGLE
    assert t.EDGE_STRAIGHTNESS == t.NORMAL_SNAP


def test_gaps_that_are_looked_at_hold_the_cluster() -> None:
    assert 1 < t.CLUSTER < t.LOOKED_AT_GAPS


def test_a_gap_tolerance_as_wide_as_a_play_adds_little_to_the_reach() -> None:
    # its limit lies above the reach of the default tolerance, and that of narrow ones grows with it
    assert t.LOOKED_AT_GAPS * t.GAP < t.LOOKED_AT_SIZE
    geometry = Assembly([Part("cube", Box([1, 1, 1]))]).geometry
    size = float(geometry.size[0])
    for gap, reach in (
        (1e-5, t.LOOKED_AT_GAPS * 1e-5),
        (1e-3, t.LOOKED_AT_SIZE * size),
        (0.02, t.CLUSTER * 0.02),
    ):
        assert reach_of(geometry, Tolerance(gap=gap)) == pytest.approx([reach / 2])


@pytest.mark.slow
def test_no_small_number_of_the_contacts_goes_without_a_name() -> None:
    assert unnamed("contact", but="contact_tolerances.py") == []


def test_a_gap_is_a_contact_up_to_its_limits() -> None:
    gap = np.array([[0.9, 2.0], [1.1, 2.0], [-2.0, -0.4], [-2.0, -0.6], [-9.0, 9.0]])
    closed, deepest = np.full(5, 1.0), np.full(5, 0.5)
    assert touches(gap, deepest, closed).tolist() == [True, False, True, False, True]
    assert nearest_gap(gap).tolist() == [0.9, 1.1, -0.4, -0.6, 0.0]


def test_gap_tolerance_is_given_or_follows_the_size() -> None:
    size = np.array([1.0, 20.0])
    assert Tolerance().gap_of(size).tolist() == [t.GAP, 20 * t.GAP]
    assert Tolerance(gap=0.5).gap_of(size).tolist() == [0.5, 0.5]
