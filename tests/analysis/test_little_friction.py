"""A slope that is a rounding error of the drawing: little friction is offered as the remedy."""

from __future__ import annotations

import numpy as np
import pytest

from kilter import Assembly, Box, Part, Pose, check


def sloping(slope: float) -> Assembly:
    """A cube on a held block that leans by a slope."""
    angle = float(np.arctan(slope))
    turn = [np.cos(angle / 2), 0.0, float(np.sin(angle / 2)), 0.0]
    away = np.array([np.sin(angle), 0.0, np.cos(angle)])
    base = Part("base", Box([10, 10, 1]), Pose((-0.5 * away).tolist(), turn), grounded=True)
    return Assembly([base, Part("cube", Box([1, 1, 1]), Pose((0.5 * away).tolist(), turn))])


@pytest.mark.parametrize(("slope", "option"), [(1e-4, "--friction 0.01"), (0.1, "--friction 0.3")])
def test_the_least_of_two_coefficients_is_offered(slope: float, option: str) -> None:
    answer = check(sloping(slope))
    assert answer.verdict == "unstable"
    assert [remedy.option for remedy in answer.remedies] == [option]
    held = check(sloping(slope), friction=float(option.split()[1]))
    assert held.level is not None
    assert check(sloping(slope), friction=0.9 * slope).level is None
