"""Limits of the questions of friction for large assemblies, counted in work."""

import pytest
from held_or_not import program

from kilter.friction.answer import ask_friction
from kilter.friction.exclusion import Exclusion, prove_no_motion
from kilter.scenes import walls


@pytest.fixture(scope="module")
def tilted():
    """A leaning wall of 16 bricks."""
    return walls.tilted_wall(8.0, friction=0.6, courses=4, per_course=4)


def test_only_the_search_of_a_motion_is_left_out_if_one_program_exceeds_the_limit(
    tilted, monkeypatch
):
    monkeypatch.setattr("kilter.friction.answer.CONIC_STEPS", 10_000_000)
    monkeypatch.setattr("kilter.friction.answer.SEARCHED", 100)
    monkeypatch.setattr("kilter.friction.answer.find_coulomb_motion", None)  # a call of it fails
    answer = ask_friction(program(tilted), work=2.0)
    assert (answer.guarantee, answer.seating.seated, answer.settles) == ("open", "yes", True)


def test_an_assembly_that_settles_is_searched_for_a_motion_if_it_is_small_or_on_request(
    tilted, monkeypatch
):
    monkeypatch.setattr("kilter.friction.answer.SEARCHED", 100)
    built, searched = program(tilted), []
    unproved = Exclusion(False, None, 0, 0, 1.0, "", 0.0)
    monkeypatch.setattr("kilter.friction.answer.prove_no_motion", lambda *_, **__: unproved)
    monkeypatch.setattr(
        "kilter.friction.answer.find_coulomb_motion", lambda *_, only, **__: searched.append(only)
    )
    assert ask_friction(built).settles
    assert searched == []
    ask_friction(built, work=1.5)
    assert searched == ["starts", "modes"]
    ask_friction(program(walls.tilted_wall(8.0, friction=0.6, courses=2, per_course=2)))
    assert searched == ["starts", "modes"] * 2


def test_a_proof_whose_cases_cost_too_much_is_not_begun(tilted, monkeypatch):
    built = program(tilted)
    monkeypatch.setattr("kilter.friction.exclusion.reduced_law", None)  # a call of it fails
    exclusion = prove_no_motion(built)
    assert (exclusion.proved, exclusion.bound, exclusion.programs) == (False, 1.0, 0)
    with pytest.raises(TypeError):
        prove_no_motion(built, work=5.0)
