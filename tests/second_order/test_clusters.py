"""Clusters that do not touch each other: each alone, and joined."""

from __future__ import annotations

import copy

import numpy as np
import pytest
from places import case_of, moved, side_by_side
from test_second_order_file import changed, numbers

import kilter
from kilter import Assembly, Feature, GivenContact, Part, Pose, Sphere
from kilter.mechanics.proof import digest_of
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.parts.cluster_states import joined_state
from kilter.shape.primitives import Box

KNOWN = ["02", "03", "07", "25", "26", "34", "35", "37", "38"]
"""Cases whose state is known on both sides of their limits."""
Z = np.array([0.0, 0.0, 1.0])


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
def test_a_row_of_known_cases_has_the_state_of_the_worst(seed: int) -> None:
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


def bowls(count: int, last: float) -> Assembly:
    """Balls of radius .7 in bowls of radius 1.3, the last ball on a surface of given curvature."""
    parts, contacts = [Part("base", Box([1, 1, 1]), Pose([0, 0, -2]), grounded=True)], []
    for k in range(count):
        at = np.array([3.0 * (k % 10), 3.0 * (k // 10), 0])
        ground = Feature("face", curvature=last if k == count - 1 else -1 / 1.3)
        parts.append(Part(f"{k}", Sphere(0.7), Pose(at + 0.7 * Z), mass=1 + 0.1 * (k % 3)))
        feature = (ground, Feature("face", curvature=1 / 0.7))
        contacts.append(GivenContact(("base", f"{k}"), [at], [0, 0, 1], feature=feature))
    return Assembly(parts, contacts=contacts, detect=False)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("count", "curvature", "state"),
    [(15, -1 / 1.3, "minimum"), (15, 0.0, "free"), (100, 1 / 1.3, "balanced")],
)
def test_balls_are_decided_one_by_one(count: int, curvature: float, state: str) -> None:
    # a hundred clusters exceed the share of second order at effort 2
    second = answer(bowls(count, curvature), effort=3.0)
    assert second.state == state
    assert len(second.clusters) == count
    assert (second.neutral, second.undecided) == (5 * count, 0)
    assert second.free == 3 * count + (2 if state == "free" else 0)
    if state == "minimum":  # a pendulum of length R - r
        assert second.rate == pytest.approx(np.sqrt(9.81 / 0.6), rel=1e-6)
    else:
        assert second.moving.tolist() == [count]


@pytest.mark.slow
def test_what_falls_falls_beside_what_is_not_known() -> None:
    """A contact with unknown features leaves only its own cluster open."""
    known, unknown = bowls(2, 1 / 1.3), bowls(2, 1 / 1.3)
    first, last = known.contacts
    blank = GivenContact(first.parts, first.points, first.normal)
    second = answer(Assembly(known.parts, contacts=[blank, last], detect=False))
    assert [one.state for one in second.clusters] == ["open", "balanced"]
    assert second.state == "balanced"
    first, last = unknown.contacts
    blank = GivenContact(last.parts, last.points, last.normal)
    second = answer(Assembly(known.parts, contacts=[first, blank], detect=False))
    assert second.state == "open"
    assert "curvature" in second.why


@pytest.mark.slow
def test_a_proof_of_clusters_is_judged_again_and_no_other() -> None:
    row = side_by_side([case_of(number).build(0.0) for number in ("03", "38", "35", "03")])
    proof = kilter.check(row).proof()
    assert kilter.verify(row, proof).holds
    places = numbers(proof["second_order"])
    random = np.random.default_rng(0)
    for k in random.choice(len(places), 30, replace=False):
        if places[k][-2:] != ("splits",):
            assert not kilter.verify(row, changed(proof, places[k], 0.37)).holds, places[k]
    for state in ("minimum", "balanced", "open"):
        other = copy.deepcopy(proof)
        other["second_order"]["state"] = state
        other["digest"] = digest_of(other)
        assert not kilter.verify(row, other).holds
    short = copy.deepcopy(proof)
    short["second_order"]["clusters"].pop()
    short["digest"] = digest_of(short)
    assert not kilter.verify(row, short).holds
