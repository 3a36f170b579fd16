"""Limits of the questions of friction for large assemblies, counted in work."""

import pytest
from held_or_not import program

from kilter import check
from kilter.analysis.check import TOO_LARGE
from kilter.friction.answer import ask_friction
from kilter.friction.exclusion import prove_no_motion
from kilter.scenes import walls


@pytest.fixture(scope="module")
def tilted():
    """A leaning wall of 16 bricks."""
    return walls.tilted_wall(8.0, friction=0.6, courses=4, per_course=4)


def test_questions_that_exceed_the_work_limit_are_not_examined(tilted, monkeypatch):
    monkeypatch.setattr("kilter.friction.answer.CONIC_STEPS", 10_000)
    answer = ask_friction(program(tilted))
    assert (answer.why, answer.examined, answer.work) == ("not-asked", False, 0.0)
    verdict = check(tilted)
    assert (verdict.verdict, verdict.level) == ("potentially-stable", "equilibrium")
    assert TOO_LARGE in verdict.warnings
    assert TOO_LARGE not in check(tilted, require="equilibrium").warnings


def test_a_proof_whose_cases_cost_too_much_is_not_begun(tilted, monkeypatch):
    built = program(tilted)
    monkeypatch.setattr("kilter.friction.exclusion.reduced_law", None)  # a call of it fails
    exclusion = prove_no_motion(built)
    assert (exclusion.proved, exclusion.bound, exclusion.programs) == (False, 1.0, 0)
    with pytest.raises(TypeError):
        prove_no_motion(built, work=5.0)
