"""Second order takes a fixed amount of work, and names the questions that it leaves open."""

from __future__ import annotations

import numpy as np
import pytest
from balance_cases import CASES, ROLLING

import kilter
from kilter import Assembly, Box, Feature, GivenContact, Part, Pose, Sphere
from kilter.second_order.answer.second_order_answer import LATE, SPENT
from kilter.second_order.answer.whole import find_second_order
from kilter.second_order.searches.opening_contacts import opening_motion
from kilter.work import Work


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


def test_without_work_it_is_open_and_states_why() -> None:
    verdict = kilter.check(case("03"), effort=0.0)
    second = verdict.second_order_answer
    assert second is not None
    assert (second.state, second.why) == ("open", SPENT)
    phrase = f"whether a small push makes b fall: {SPENT}"
    assert second.left_open(verdict.program.names) == phrase
    assert second.to_dict(verdict.program.names)["left_open"] == phrase
    assert verdict.to_dict()["level"] != "strict"


def test_without_time_it_is_open_and_states_why() -> None:
    """The check itself has no time limit: a busy machine would end its first program, too."""
    verdict = kilter.check(case("03"))
    second = find_second_order(
        verdict.assembly, verdict.contact_set, verdict.program, work=Work(1e6, time_limit=0.0)
    )
    assert second is not None
    assert (second.state, second.why) == ("open", LATE)
    phrase = f"whether a small push makes b fall: {LATE}"
    assert second.left_open(verdict.program.names) == phrase


def test_parts_on_level_faces_are_free_without_any_work() -> None:
    verdict = kilter.check(kilter.example("tower"), effort=0)
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.state == "free"
    assert verdict.second_order_answer.left_open(verdict.program.names) == ""


@pytest.mark.slow
def test_many_clusters_share_the_work_and_level_strict_does_more() -> None:
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


def test_parts_with_fewer_contact_rows_than_freedoms_cost_no_search_for_forces(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    balls = bowls(3)
    monkeypatch.setattr("kilter.second_order.searches.held_search.judge_held", None)
    second = kilter.check(balls).second_order_answer
    assert second is not None
    assert [cluster.state for cluster in second.clusters] == ["minimum"] * 3


@pytest.mark.slow
def test_near_a_limit_the_usual_work_is_enough() -> None:
    """The hardest known case, as near to its limit as its proof resolves."""
    verdict = kilter.check(case("39", 0.5 - 1e-6))
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.state == "minimum"


def test_friction_that_is_left_open_is_named() -> None:
    verdict = kilter.check(next(one for one in ROLLING if one.number == "R2").build(0.9))
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.rolling is not None
    assert (verdict.second_order_answer.state, verdict.second_order_answer.rolling.state) == (
        "balanced",
        "open",
    )
    left = verdict.second_order_answer.left_open(verdict.program.names)
    assert left.startswith("whether friction holds ")


def test_no_program_is_solved_once_the_work_is_over() -> None:
    work = Work(1.0)
    assert opening_motion(np.eye(2), work) is not None
    assert work.over
    assert opening_motion(np.eye(2), work) is None
