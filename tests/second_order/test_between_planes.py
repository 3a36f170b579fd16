"""Parts pressed between planes: no motion opens both, so a path keeps them."""

from __future__ import annotations

import copy

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part, Pose, Sphere
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.second_order.parts.separation import least_separation

WALLS = [
    Part("left", Box([1, 10, 10]), Pose([-1, 0, 5]), grounded=True),
    Part("right", Box([1, 10, 10]), Pose([1, 0, 5]), grounded=True),
]
ENDS = [
    Part("behind", Box([1, 1, 10]), Pose([0, -1, 5]), grounded=True),
    Part("before", Box([1, 1, 10]), Pose([0, 1, 5]), grounded=True),
]
FLOOR = Part("floor", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
BALLS = [Part(f"ball {k}", Sphere(0.5), Pose([0, 0, 0.5 + k])) for k in range(2)]


@pytest.mark.slow
def test_balls_upright_between_two_walls_fall_along_them() -> None:
    assembly = Assembly([FLOOR, *WALLS, *BALLS])
    found = kilter.check(assembly)
    second = found.second_order_answer
    assert second is not None
    assert second.state == "balanced"
    proof = found.proof()
    assert kilter.verify(assembly, proof).holds
    across = second.configuration
    assert across is not None
    assert np.abs(across.motion[4:, 0]).max() < 1e-15
    for axis, by in ((0, 1e-9), (0, -1e-9), (1, 1e-9)):  # into a wall, or off the path
        other = copy.deepcopy(proof)
        other["second_order"]["configuration"]["ball 1"][axis] += by
        other["digest"] = digest_of(other)
        assert not kilter.verify(assembly, other).holds, (axis, by)


@pytest.mark.slow
def test_balls_upright_in_a_square_tube_stay() -> None:
    assembly = Assembly([FLOOR, *WALLS, *ENDS, *BALLS])
    found = kilter.check(assembly)
    second = found.second_order_answer
    assert second is not None
    assert (second.state, second.neutral, second.free) == ("minimum", 6, 6)
    assert kilter.verify(assembly, found.proof()).holds


@pytest.mark.parametrize(("shift", "apart"), [(0.0, 0.1), (1e-10, None), (-1e-10, None)])
def test_only_what_shifts_along_a_plane_counts_as_parted_by_it(
    shift: float, apart: float | None
) -> None:
    assembly = Assembly([FLOOR, *WALLS, BALLS[0]])
    program = build_program(assembly, kilter.contacts(assembly))
    motion = np.zeros((4, 6))
    motion[3, :3] = [shift, 0.3, 0.2]
    every = np.ones(len(program.normal), dtype=bool)
    found = least_separation(assembly, program, motion, beyond=0.1, planes=every)
    assert found == (pytest.approx(-1e-10, rel=1e-4) if apart is None else apart)
    without = least_separation(assembly, program, motion, beyond=0.1)
    assert without is not None
    assert without <= 0
