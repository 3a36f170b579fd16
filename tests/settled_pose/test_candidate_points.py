"""Candidate points of settling: which penetrations of curved faces count."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Cylinder, Part
from kilter.analysis.settled_pose.near_points import (
    NearPoints,
    _share_material,
    find_near_points,
)
from kilter.contact.overlap import inside_part
from kilter.scenes.pieces import tube

SPACESHIP = Path(__file__).parents[3] / "shared/data/cax-if/s1-tu-203/s1-tu-203.stp"


@pytest.mark.parametrize(("sunk", "shares"), [(0.0, False), (-0.1, False), (0.5, True)])
def test_a_shaft_shares_material_with_a_narrower_bore_only_if_it_reaches_into_it(
    sunk: float, shares: bool
) -> None:
    """A shaft of radius 1 below a tube with a bore of .8: their faces overlap by .2 as solids."""
    shaft = Part("shaft", Cylinder(1, 1), [0, 0, 0.5], grounded=True)
    assembly = Assembly([shaft, tube("tube", 0.8, 2, 1, [0, 0, 1.5 - sunk])])
    angle = np.linspace(0, 2 * np.pi, 12, endpoint=False) + 0.1
    normal = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(12)])
    point = 0.9 * normal + [0, 0, 1.0]  # the rim of the shaft
    shaft_row, tube_row = np.zeros(12, dtype=np.int64), np.ones(12, dtype=np.int64)
    bears = np.ones(12, dtype=bool)
    points = NearPoints(shaft_row, tube_row, point, normal, np.full(12, -0.2), np.zeros(12), bears)
    assert (_share_material(assembly.geometry, points) == shares).all()


def test_points_inside_a_part() -> None:
    geometry = Assembly([Part("box", Box(2, 2, 2), [1, 0, 0], grounded=True)]).geometry
    points = np.array([[1.0, 0, 0], [1.99, 0.99, -0.99], [2.01, 0, 0], [-0.01, 0, 0]])
    assert inside_part(geometry, 0, points).tolist() == [True, True, False, False]


@pytest.mark.slow
@pytest.mark.skipif(not SPACESHIP.is_file(), reason="real data is not here")
def test_half_shells_on_one_axis_have_no_penetrating_points() -> None:
    """A solid half of radius 73 and holes of 67 on its axis, over other angles: no overlap."""
    drawn = kilter.load(SPACESHIP)
    shells = [part for part in drawn.parts if not part.name.startswith("foot")]
    assembly = Assembly(shells, units=drawn.units)
    assert not kilter.contacts(assembly).overlaps
    assert find_near_points(assembly, 12.0, 12.0).gap.min() > -0.01
