"""Programs above the size of the simplex: HiPO, or its substitute, and both verdicts."""

from __future__ import annotations

import numpy as np
import pytest
from judged import judged

from kilter.analysis.decision.judge import SIMPLEX_ROWS, judge
from kilter.contact import detect
from kilter.mechanics.forms import equilibrium, load_factor, scaled_problem
from kilter.mechanics.program import build_program
from kilter.scenes import walls
from kilter.scenes.transform import moved
from kilter.solvers import highs

TURN = np.array([0.3, -0.5, 0.7, 0.4])


def large(assembly):
    program = build_program(assembly, detect.contacts(assembly))
    assert len(scaled_problem(program).right) > SIMPLEX_ROWS
    return program


@pytest.mark.slow
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("build", "verdict"),
    [
        (lambda: walls.wall(17, 17), "stable"),
        (lambda: walls.short_base(17, 17, held=8.0), "unstable"),
        (lambda: walls.hanging_brick(17, 17), "unstable"),
        (lambda: walls.wall(17, 17).with_down([0, 1e-6, -1]), "unstable"),
        (lambda: walls.wall(17, 17).with_down([1e-6, 0, -1]), "unstable"),
    ],
)
def test_large_walls_are_judged_either_way(build, verdict, turned):
    assembly = build()
    if turned:
        assembly = moved(assembly, TURN / np.linalg.norm(TURN), [10.0, -20.0, 5.0])
    assert judged(assembly).verdict == verdict


def test_a_large_program_goes_to_hipo_first():
    judgement = judge(large(walls.wall(17, 17)))
    assert judgement.stable
    assert judgement.solvers[0].startswith("equilibrium: hipo")


@pytest.mark.slow
def test_without_its_extra_package_another_solver_is_named_and_judged(monkeypatch):
    monkeypatch.setattr(highs, "hipo_available", lambda: False)
    judgement = judge(large(walls.wall(17, 17)))
    assert judgement.stable
    assert judgement.solvers[0].startswith("equilibrium: ipx")


def test_the_extra_package_that_hipo_needs_is_installed():
    assert highs.hipo_available()


def test_interior_point_and_simplex_give_the_same_load_factor():
    for build in (lambda: walls.wall(8, 8), lambda: walls.short_base(8, 8, held=4.0)):
        problem = scaled_problem(build_program(build(), detect.contacts(build())))
        factors = [
            highs.solve_linear(load_factor(problem), method=method).x[-1]
            for method in ("simplex", "interior")
        ]
        assert factors[0] == pytest.approx(factors[1], abs=1e-6)


def test_a_status_is_mapped_to_words():
    problem = scaled_problem(large(walls.short_base(17, 17, held=8.0)))
    answer = highs.solve_linear(equilibrium(problem), method="interior", forces_only=True)
    assert answer.outcome == "infeasible"
