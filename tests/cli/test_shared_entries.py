"""Entries that several answers have, open pairs and joints: the drawn numbers in each answer."""

from __future__ import annotations

import pytest

import kilter
from kilter import Assembly, Box, Joint, Part
from kilter.scenes.pieces import block

TABLE = block("table", [-50, -50, -10], [50, 50, 0], grounded=True)
OPEN = Assembly(
    [
        TABLE,
        block("sunk", [-40, -40, -2], [-20, -30, 8]),
        block("near", [0, 0, 0.01], [20, 30, 10]),
    ],
    units="mm",
)
"""A part that is sunk by 2 mm over 20 x 10, and a part that hangs by a hundredth."""
MORE = {"limits": [-0.5, 0.25], "friction": 70.0, "stiffness": 3.0, "rest": 0.125}
HINGE = Joint(("arm", "ground"), "revolute", point=[0, 0, 5], axis=[0, 1, 0], **MORE)
ARM = Part("arm", Box([10, 10, 10]), [0, 0, 5])
JOINED = Assembly([TABLE, ARM], units="mm", joints=[HINGE])


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    "verb", ["contacts", "check", "hold", "margin", "orient", "plan", "region", "transport"]
)
def test_open_pairs_have_the_depth_and_the_gap_of_the_drawing(verb: str) -> None:
    pairs = getattr(kilter, verb)(OPEN).to_dict()["open_pairs"]
    found = {tuple(one["parts"]): (one["gap"], one["depth"], one["volume"]) for one in pairs}
    assert found["table", "near"] == (pytest.approx(0.01), None, None)
    assert found["table", "sunk"] == (None, pytest.approx(2), pytest.approx(2 * 20 * 10))


@pytest.mark.quick(2)
@pytest.mark.parametrize("verb", ["contacts", "check", "margin", "orient", "region", "transport"])
def test_joints_have_the_limits_the_friction_and_the_spring_of_the_file(verb: str) -> None:
    """Regions and orientations leave out friction and springs, as their warnings state."""
    (entry,) = getattr(kilter, verb)(JOINED).to_dict()["joints"]
    kept = ("limits",) if verb in ("orient", "region") else tuple(MORE)
    assert {key: entry[key] for key in MORE if key in entry} == {key: MORE[key] for key in kept}
