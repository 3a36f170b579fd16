"""Answers of second order for reference cases, of clusters, beside idle contacts, within work."""

import copy
from typing import Any

import numpy as np
import pytest
from balance_cases import CASES, ROLLING, Case
from places import case_of, moved, side_by_side

import kilter
from kilter import Assembly, Box, Feature, GivenContact, Part, Pose, Sphere
from kilter.mechanics.proof import digest_of
from kilter.second_order.answer.second_order_answer import LATE, SPENT, SecondOrder
from kilter.second_order.answer.whole import find_second_order
from kilter.second_order.parts.cluster_states import joined_state
from kilter.second_order.searches.level_rest_search import opening_motion
from kilter.work import Work


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
def test_a_known_case_has_its_state(case):
    for off in (1e-6, 1e-2) if case.limit is not None else (0.0,):
        for parameter, state in sides(case, off):
            assert state_of(case.build(parameter)) == state


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.number)
def test_free_motions_are_those_of_the_reference(case):
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
def test_turned_moved_scaled_and_renamed_it_is_the_same(number):
    case = next(case for case in CASES if case.number == number)
    turn = Pose([3.0, -2.0, 5.0], [0.5, 0.3, -0.7, 0.41])
    for parameter, state in sides(case, 0.02):
        assert state_of(moved(case.build(parameter), turn, 37.0)) == state


def test_a_balanced_assembly_says_so_at_once():
    verdict = kilter.check(next(case for case in CASES if case.number == "02").build(0.0))
    assert verdict.sentence.startswith("Balanced: ")
    assert "makes b fall, unless friction holds it" in verdict.sentence
    second = verdict.to_dict()["second_order"]
    assert second["state"] == "balanced"
    # a pendulum upside down of length R + r; the ball slides without a turn
    assert second["rate"] == pytest.approx(np.sqrt(9.81 / 2.0), rel=1e-6)
    assert set(second["motion"]) == {"b"}


def test_a_ball_in_a_bowl_swings_as_a_pendulum_does():
    """Without friction the ball does not roll: a pendulum of length R - r."""
    case = next(case for case in CASES if case.number == "03")
    second = kilter.check(case.build(0.0)).second_order_answer
    assert second is not None
    assert second.rate == pytest.approx(np.sqrt(9.81 / 0.6), rel=1e-6)


def test_a_large_wall_does_not_wait():
    wall = kilter.example("wall", size=(6, 5))
    top = float(wall.geometry.part_boxes[1][:, 2].max())
    ball = Part("ball", Sphere(0.05), Pose([0.01, 0, top + 0.05]))
    second = kilter.check(Assembly([*wall.parts, ball])).second_order_answer
    assert second is not None
    assert second.state == "open"
    assert "free parts touch each other" in second.why


def test_bonds_and_loads_beside_a_centre_leave_it_open():
    ball = next(case for case in CASES if case.number == "03").build(0.0)

    def of(**more: object) -> str:
        return state_of(Assembly(ball.parts, contacts=ball.contacts, detect=False, **more))

    weight = [0.0, 0.0, -1.0]
    assert of(loads=[kilter.Load("b", force=weight, point=[0, 0, 0.7])]) == "minimum"
    twisted = kilter.Load("b", force=weight, torque=[0, 0, 1e-12], point=[0, 0, 0.7])
    assert of(loads=[twisted]) == "open"
    bond = kilter.Bond(("base", "b"), 5.0, points=[[0, 0, 0]], normal=[0, 0, 1])
    assert of(bonds=[bond]) == "open"


KNOWN = ["02", "03", "07", "25", "26", "34", "35", "37", "38"]
"""Cases whose state is known on both sides of their limits."""


def answer(assembly: Assembly, *, effort: float = 1.0) -> SecondOrder:
    second = kilter.check(assembly, effort=effort).second_order_answer
    assert second is not None
    return second


def drawn(seed: int, count: int = 4) -> tuple[list[Assembly], list[str]]:
    """Random known cases with their states."""
    random = np.random.default_rng(seed)
    made, states = [], []
    for number in random.choice(KNOWN, count):
        case = case_of(number)
        above = case.limit is not None and random.random() < 0.5
        limit = 0.0 if case.limit is None else case.limit
        made.append(case.build(limit + (0.05 if above else -0.05)))
        states.append(case.above if above else case.state)
    return made, states


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_a_row_of_known_cases_has_the_state_of_the_worst(seed):
    made, states = drawn(seed)
    alone = [answer(one) for one in made]
    row = side_by_side(made)
    second = answer(row)
    assert [one.state for one in second.clusters] == states
    assert second.state == joined_state(states)
    for count in ("neutral", "free", "blocked", "undecided"):
        assert getattr(second, count) == sum(getattr(one, count) for one in alone)
    elsewhere = moved(row, Pose([3.0, -2.0, 5.0], [0.5, 0.3, -0.7, 0.41]), 37.0)
    assert answer(elsewhere).state == second.state
    names = [one.names[k] for one, s in zip(made, alone, strict=True) for k in s.moving]
    if all(state == second.state for state in states):
        assert len(second.moving) == len(names)


FLOOR = Part("floor", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
WALL = Part("wall", Box([1, 10, 10]), Pose([-1.5, 0, 5]), grounded=True)
BALL = Part("ball", Sphere(1.0), Pose([0, 0, 1]))


def second_of(assembly: Assembly) -> SecondOrder:
    second = kilter.check(assembly).second_order_answer
    assert second is not None
    return second


def test_a_ball_beside_a_wall_is_free_away_from_it():
    second = second_of(Assembly([FLOOR, WALL, BALL]))
    assert (second.state, second.neutral, second.free, len(second.idle)) == ("free", 5, 5, 1)
    assert second.motion is not None
    assert second.motion[2, 0] > 0.1  # the wall is to its left


def changed(proof: dict[str, Any], **entries: Any) -> dict[str, Any]:
    other = copy.deepcopy(proof)
    other["second_order"] |= entries
    other["digest"] = digest_of(other)
    return other


@pytest.mark.slow
def test_what_shifts_as_a_whole_is_free_past_contacts_that_it_does_not_open():
    """A ball in a box whose walls all touch it: the walls move along with it."""
    walls = [
        Part(f"wall {k}", Box([0.2, 3, 1] if k < 2 else [1.6, 0.2, 1]), Pose([*at, 0.5]))
        for k, at in enumerate([(-0.9, 0), (0.9, 0), (0, -0.9), (0, 0.9)])
    ]
    ball = Part("ball", Sphere(0.8), Pose([0, 0, 0.8]))
    for parts in ([FLOOR, *walls, ball], [FLOOR, WALL, *walls[1:2], ball]):
        assembly = Assembly(parts)
        found = kilter.check(assembly)
        assert found.second_order_answer is not None
        assert found.second_order_answer.state == "free", found.second_order_answer.why
        assert kilter.verify(assembly, found.proof()).holds


def test_contacts_of_unknown_features_are_left_out_too():
    """A part on given contacts without features, on a part at rest: both slide together."""
    touch = kilter.GivenContact(("low", "high"), [[0.3, 0, 1]], [1, 0, 0])
    low = Part("low", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    high = Part("high", Box([1, 1, 1]), Pose([1.0, 0, 0.5]))
    assembly = Assembly([FLOOR, low, high], contacts=[touch])
    found = kilter.check(assembly)
    assert found.second_order_answer is not None
    assert found.second_order_answer.state == "free", found.second_order_answer.why
    proof = found.proof()
    assert kilter.verify(assembly, proof).holds
    if "motion" in proof["second_order"] and "idle" in proof["second_order"]:
        apart = {"low": [1.0, 0, 0, 0, 0, 0], "high": [0.5, 0, 0, 0, 0, 0]}
        assert not kilter.verify(assembly, changed(proof, motion=apart)).holds


def case(number: str, parameter: float = 0.0) -> Assembly:
    return next(case for case in CASES if case.number == number).build(parameter)


def bowls(count: int) -> Assembly:
    """Balls, each in a bowl of its own."""
    parts, contacts = [Part("base", Box([1, 1, 1]), Pose([0, 0, -2]), grounded=True)], []
    feature = (Feature("face", curvature=-1 / 1.3), Feature("face", curvature=1 / 0.7))
    for k in range(count):
        x, y = 3.0 * (k % 10), 3.0 * (k // 10)
        parts.append(Part(f"{k}", Sphere(0.7), Pose([x, y, 0.7]), mass=1.0))
        contacts.append(GivenContact(("base", f"{k}"), [[x, y, 0]], [0, 0, 1], feature=feature))
    return Assembly(parts, contacts=contacts, detect=False)


def test_without_work_it_is_open_and_states_why():
    verdict = kilter.check(case("03"), effort=0.0)
    second = verdict.second_order_answer
    assert second is not None
    assert (second.state, second.why) == ("open", SPENT)
    phrase = f"whether a small push makes b fall: {SPENT}"
    assert second.left_open(verdict.program.names) == phrase
    assert second.summary(verdict.program.names).to_dict()["left_open"] == phrase
    assert verdict.to_dict()["level"] != "strict"


def test_without_time_it_is_open_and_states_why():
    """The check itself has no time limit: a busy machine would end its first program, too."""
    verdict = kilter.check(case("03"))
    second = find_second_order(
        verdict.assembly, verdict.contact_set, verdict.program, work=Work(1e6, time_limit=0.0)
    )
    assert second is not None
    assert (second.state, second.why) == ("open", LATE)
    phrase = f"whether a small push makes b fall: {LATE}"
    assert second.left_open(verdict.program.names) == phrase


def test_parts_on_level_faces_are_free_without_any_work():
    verdict = kilter.check(kilter.example("tower"), effort=0)
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.state == "free"
    assert verdict.second_order_answer.left_open(verdict.program.names) == ""


@pytest.mark.slow
def test_many_clusters_share_the_work_and_level_strict_does_more():
    balls = bowls(60)
    usual, strict = kilter.check(balls), kilter.check(balls, require="strict")
    assert usual.second_order_answer is not None
    assert strict.second_order_answer is not None
    states = [cluster.state for cluster in usual.second_order_answer.clusters]
    decided = states.index("open")
    assert states == ["minimum"] * decided + ["open"] * (60 - decided)
    assert 5 < decided < 30
    assert usual.second_order_answer.why == SPENT
    left = usual.second_order_answer.left_open(usual.program.names)
    first = " or ".join([f"{decided}, {decided + 1}, {decided + 2}", f"{57 - decided} more"])
    assert left == f"whether a small push makes {first} fall: {SPENT}"
    assert strict.second_order_answer.state == "minimum"


def test_parts_with_fewer_contact_rows_than_freedoms_cost_no_search_for_forces(monkeypatch):
    balls = bowls(3)
    monkeypatch.setattr("kilter.second_order.searches.level_rest_search.judge_held", None)
    second = kilter.check(balls).second_order_answer
    assert second is not None
    assert [cluster.state for cluster in second.clusters] == ["minimum"] * 3


@pytest.mark.slow
def test_near_a_limit_the_usual_work_is_enough():
    """The hardest known case, as near to its limit as its proof resolves."""
    verdict = kilter.check(case("39", 0.5 - 1e-6))
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.state == "minimum"


def test_friction_that_is_left_open_is_named():
    verdict = kilter.check(next(one for one in ROLLING if one.number == "R2").build(0.9))
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.rolling is not None
    assert (verdict.second_order_answer.state, verdict.second_order_answer.rolling.state) == (
        "balanced",
        "open",
    )
    left = verdict.second_order_answer.left_open(verdict.program.names)
    assert left.startswith("whether friction holds ")


def test_no_program_is_solved_once_the_work_is_over():
    work = Work(1.0)
    assert opening_motion(np.eye(2), work) is not None
    assert work.over
    assert opening_motion(np.eye(2), work) is None
