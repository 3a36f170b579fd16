"""A plate of joined tiles feels friction at the points of all tiles, also against a spin.

If the middle tile carries the weight, friction resists a spin with the arm of its corners alone.
"""

from __future__ import annotations

import numpy as np
import pytest

import kilter
from kilter import Assembly, Joint, Load
from kilter.scenes.pieces import block, floor

MU, WEIGHT = 0.5, 4 * 0.1 * 1000 * 9.81


def plate(tiles: int, torque: float) -> Assembly:
    """A plate 2 x 2 x 0.1 of joined tiles on a floor, with a torque about the vertical axis."""
    edge = np.linspace(-1.0, 1.0, tiles + 1)
    parts = [
        block(f"tile-{i}-{j}", [edge[i], edge[j], 0], [edge[i + 1], edge[j + 1], 0.1])
        for i in range(tiles)
        for j in range(tiles)
    ]
    first = parts[0].name
    joints = [Joint((first, part.name)) for part in parts[1:]]
    load = Load(first, torque=[0, 0, torque])
    return Assembly([floor([-3, -3], [3, 3]), *parts], friction=MU, joints=joints, loads=[load])


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.35, 0.6])
def test_a_plate_that_may_spin_about_its_middle_tile_is_not_proved(share: float) -> None:
    """The corners of the middle tile resist a fifth of what the corners of the plate resist."""
    found = kilter.check(plate(5, share * MU * WEIGHT * np.sqrt(2)))
    assert found.level in ("settles", "equilibrium")


def test_a_single_tile_is_proved() -> None:
    assert kilter.check(plate(1, 0.35 * MU * WEIGHT * np.sqrt(2))).level == "proved"
