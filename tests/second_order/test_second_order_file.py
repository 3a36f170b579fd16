"""Proofs of second order in proof files: what holds, and that every changed number is refused."""

from __future__ import annotations

import copy
from typing import Any

import pytest

import kilter
from kilter.mechanics.proof import digest_of
from kilter.scenes import scene
from kilter.scenes.balance import CASES

Place = tuple[str | int, ...]


def numbers(data: Any, place: Place = ()) -> list[Place]:
    """Where the numbers of a proof are."""
    if isinstance(data, dict):
        return [one for key, value in data.items() for one in numbers(value, (*place, key))]
    if isinstance(data, list):
        return [one for k, value in enumerate(data) for one in numbers(value, (*place, k))]
    return [place] if isinstance(data, float | int) and not isinstance(data, bool) else []


def changed(proof: dict[str, Any], place: Place, by: float) -> dict[str, Any]:
    """The proof with one number of its second order another, and a digest that fits."""
    other = copy.deepcopy(proof)
    at = other["second_order"]
    for key in place[:-1]:
        at = at[key]
    at[place[-1]] += by
    other["digest"] = digest_of(other)
    return other


def proof_of(number: str) -> tuple[kilter.Assembly, dict[str, Any]]:
    case = next(case for case in CASES if case.number == number)
    assembly = case.build(0.0 if case.limit is None else case.limit - 0.05)
    return assembly, kilter.check(assembly).proof()


@pytest.mark.parametrize("number", ["01", "02", "03", "17", "19", "22", "26", "34", "38", "39"])
def test_the_proof_of_a_state_is_judged_again(number: str) -> None:
    assembly, proof = proof_of(number)
    found = kilter.verify(assembly, proof)
    assert found.holds, found.reasons
    assert f"second order: {proof['second_order']['state']}" in found.notes


@pytest.mark.parametrize("number", ["03", "26", "38"])
def test_a_changed_number_of_a_minimum_is_refused(number: str) -> None:
    assembly, proof = proof_of(number)
    for place in numbers(proof["second_order"]):
        assert not kilter.verify(assembly, changed(proof, place, 0.37)).holds, place


@pytest.mark.parametrize("name", ["paper-figure-1-turned", "paper-figure-12-turned"])
def test_the_paths_of_the_papers_figures_are_judged_again(name: str) -> None:
    assembly = scene(name)
    verdict = kilter.check(assembly)
    proof = verdict.proof()
    assert proof["second_order"]["state"] == "balanced"
    assert proof["second_order"]["configuration"] is not None
    assert kilter.verify(assembly, proof).holds
    lifted = copy.deepcopy(proof)
    place = lifted["second_order"]["configuration"]
    for six in place.values():
        six[:3] = (-x for x in six[:3])
    lifted["digest"] = digest_of(lifted)
    assert not kilter.verify(assembly, lifted).holds
    nowhere = copy.deepcopy(proof)
    nowhere["second_order"]["configuration"] = None
    nowhere["digest"] = digest_of(nowhere)
    assert not kilter.verify(assembly, nowhere).holds


@pytest.mark.parametrize("state", ["minimum", "free", "balanced", "sure", 3, None])
def test_a_state_that_it_has_not_is_refused(state: Any) -> None:
    assembly, proof = proof_of("03")
    proof["second_order"]["state"] = state
    proof["digest"] = digest_of(proof)
    assert kilter.verify(assembly, proof).holds == (state == "minimum")


def test_a_proof_without_its_parts_is_refused() -> None:
    assembly, proof = proof_of("26")
    for key in proof["second_order"]:
        short = copy.deepcopy(proof)
        del short["second_order"][key]
        short["digest"] = digest_of(short)
        assert not kilter.verify(assembly, short).holds, key


@pytest.mark.parametrize("word", ["nan", "inf", "1.0", True, None])
def test_words_in_the_place_of_numbers_make_no_ball_on_a_ball_a_minimum(word: Any) -> None:
    """Two motions are neutral beside the spins: cones of two sides each, whose weights are none."""
    assembly, proof = proof_of("02")
    bowl = proof_of("03")[1]["second_order"]
    one = [[word, word], [word, word]]
    forged = bowl | {"splits": [None, None], "weights": [one, one], "forces": bowl["forces"] * 2}
    assert not kilter.verify(assembly, with_second_order(proof, forged)).holds


def test_a_lift_by_next_to_nothing_makes_no_ball_in_a_bowl_balanced() -> None:
    assembly, proof = proof_of("03")
    first = [0.7, 0, 0.7e-7, 0, 0, 0]
    for lift in ([0, 0, -0.7, 0, 0, 0], [0, 0, -7, 0, 0, 0]):
        forged = {"state": "balanced", "configuration": None}
        forged |= {"first": {"b": first}, "second": {"b": lift}}
        assert not kilter.verify(assembly, with_second_order(proof, forged)).holds


def with_second_order(proof: dict[str, Any], data: Any) -> dict[str, Any]:
    """The proof with another second order, and a digest that fits."""
    other = copy.deepcopy(proof) | {"second_order": data}
    other["digest"] = digest_of(other)
    return other


def test_what_falls_counts_no_motions() -> None:
    """How many motions are neutral needs all forces of equilibrium: a path does not prove it."""
    assembly, proof = proof_of("02")
    assert kilter.verify(assembly, proof).holds
    for key in ("neutral", "free"):
        assert key not in proof["second_order"]
        other = copy.deepcopy(proof)
        other["second_order"][key] = 5
        other["digest"] = digest_of(other)
        assert not kilter.verify(assembly, other).holds
