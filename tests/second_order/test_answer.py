"""Answers of second order for the reference cases, on both sides of their limits."""

from __future__ import annotations

import numpy as np
import pytest
from balance_cases import CASES, Case
from places import moved

import kilter
from kilter import Assembly, Part, Pose
from kilter.shape.primitives import Box, Cylinder, Sphere


def state_of(assembly: Assembly) -> str:
    verdict = kilter.check(assembly)
    assert verdict.first_order == "stable"
    assert verdict.second_order_answer is not None
    return verdict.second_order_answer.state


def sides(case: Case, off: float) -> list[tuple[float, str]]:
    """Parameters on both sides of a limit, with their states."""
    if case.limit is None or case.above is None:
        return [(0.0, case.state)]
    return [(case.limit - off, case.state), (case.limit + off, case.above)]


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.number)
def test_a_known_case_has_its_state(case: Case) -> None:
    for off in (1e-6, 1e-2) if case.limit is not None else (0.0,):
        for parameter, state in sides(case, off):
            assert state_of(case.build(parameter)) == state


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.number)
def test_free_motions_are_those_of_the_reference(case: Case) -> None:
    for parameter, state in sides(case, 0.05):
        verdict = kilter.check(case.build(parameter))
        second = verdict.second_order_answer
        assert second is not None
        assert second.neutral >= second.free + second.blocked
        if state != "balanced":
            assert second.free == case.free
            assert second.undecided == 0


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "number", ["02", "03", "05", "07", "14", "19", "21", "24b", "26", "34", "37", "38", "39"]
)
def test_turned_moved_scaled_and_renamed_it_is_the_same(number: str) -> None:
    case = next(case for case in CASES if case.number == number)
    turn = Pose([3.0, -2.0, 5.0], [0.5, 0.3, -0.7, 0.41])
    for parameter, state in sides(case, 0.02):
        assert state_of(moved(case.build(parameter), turn, 37.0)) == state


def test_a_balanced_assembly_says_so_at_once() -> None:
    verdict = kilter.check(next(case for case in CASES if case.number == "02").build(0.0))
    assert verdict.sentence.startswith("Balanced: ")
    assert "makes b fall, unless friction holds it" in verdict.sentence
    second = verdict.to_dict()["second_order"]
    assert second["state"] == "balanced"
    # a pendulum upside down of length R + r; the ball slides without a turn
    assert second["rate"] == pytest.approx(np.sqrt(9.81 / 2.0), rel=1e-6)
    assert set(second["motion"]) == {"b"}


def test_a_ball_in_a_bowl_swings_as_a_pendulum_does() -> None:
    """Without friction the ball does not roll: a pendulum of length R - r."""
    case = next(case for case in CASES if case.number == "03")
    second = kilter.check(case.build(0.0)).second_order_answer
    assert second is not None
    assert second.rate == pytest.approx(np.sqrt(9.81 / 0.6), rel=1e-6)


def test_a_large_wall_does_not_wait() -> None:
    wall = kilter.example("wall", size=(6, 5))
    top = float(wall.geometry.part_boxes[1][:, 2].max())
    ball = Part("ball", Sphere(0.05), Pose([0.01, 0, top + 0.05]))
    second = kilter.check(Assembly([*wall.parts, ball])).second_order_answer
    assert second is not None
    assert second.state == "open"
    assert "free parts touch each other" in second.why


def test_bonds_and_loads_beside_a_centre_leave_it_open() -> None:
    ball = next(case for case in CASES if case.number == "03").build(0.0)

    def of(**more: object) -> str:
        return state_of(Assembly(ball.parts, contacts=ball.contacts, detect=False, **more))

    weight = [0.0, 0.0, -1.0]
    assert of(loads=[kilter.Load("b", force=weight, point=[0, 0, 0.7])]) == "minimum"
    twisted = kilter.Load("b", force=weight, torque=[0, 0, 1e-12], point=[0, 0, 0.7])
    assert of(loads=[twisted]) == "open"
    bond = kilter.Bond(("base", "b"), 5.0, points=[[0, 0, 0]], normal=[0, 0, 1])
    assert of(bonds=[bond]) == "open"


@pytest.mark.slow
def test_what_was_not_looked_at_is_not_counted() -> None:
    """A post that all but touches is left open; a second part beside it changes nothing."""
    table = Part("table", Box([9, 9, 1]), Pose([0, 0, -0.5]), grounded=True)
    can = Part("can", Cylinder(0.5, 1.0), Pose([0, 0, 0.5]))
    ball = Part("ball", Sphere(0.5), Pose([3, 0, 0.5]))
    post = Part("post", Box([1, 1, 1]), Pose([-1.0 - 2e-4, 0, 0.5]), grounded=True)
    for parts in ([table, can, post], [table, can, post, ball]):
        second = kilter.check(Assembly(parts)).to_dict()["second_order"]
        assert second["state"] == "open"
        assert [second[key] for key in ("neutral", "free", "blocked", "undecided")] == 4 * [None]
    second = kilter.check(Assembly([table, ball])).to_dict()["second_order"]
    assert [second[key] for key in ("neutral", "free", "blocked", "undecided")] == [5, 5, 0, 0]
