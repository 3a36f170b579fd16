"""Decisions if solvers fail, and of programs that count as large: never wrong."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from judged import program_of, sides

import kilter
from kilter import Assembly, Bond, Box, Part, Pose
from kilter.analysis.decision import judge as judging
from kilter.analysis.decision.judge import judge
from kilter.scenes import arches, scene, stacks
from kilter.solvers import clarabel, highs


def glued(pull: float, shear: float | str = "mu", friction: float = 0.0) -> Assembly:
    """A block of 981 N beside a wall, held by glue at its whole face."""
    wall = Part("wall", Box([1, 1, 1]), Pose((1.0, 0.0, 0.0)), grounded=True)
    block = Part("block", Box([1, 1, 1]), density=100.0)
    table = Part("table", Box([1, 1, 1]), Pose((0.0, 0.0, -1.0)), grounded=True)
    parts = [wall, block] if friction else [wall, block, table]
    bond = Bond(("wall", "block"), pull=pull, shear=shear)
    return Assembly(parts, friction=friction, bonds=[bond])


SCENES: dict[str, Callable[[], Assembly]] = {
    "arch": lambda: arches.arch(5, friction=0.7, planar=False),
    "falling arch": lambda: arches.arch(5, friction=0.05, planar=False),
    "block": lambda: stacks.block_on_slope(20.0, friction=0.5),
    "smooth tower": lambda: scene("tower").with_friction(0.0),
    "smooth figure": lambda: scene("paper-figure-8").with_friction(0.0),
    "glue without friction": lambda: glued(100.0),
    "strong glue": lambda: glued(1e4, 1e4, 0.5),
    "weak glue": lambda: glued(10.0, 10.0, 0.5),
    "mortar": lambda: scene("mortared-corbel"),
}


def failing(solve: Callable[..., Any]) -> Callable[..., Any]:
    """The solver, but each of its answers is marked as failed."""

    def failed(*problem: Any, **options: Any) -> Any:
        none = np.zeros(0)
        answer = solve(*problem, **options)
        return dataclasses.replace(answer, outcome="failed", x=none, multipliers=none)

    return failed


@pytest.mark.parametrize("name", sorted(SCENES))
def test_a_program_that_counts_as_large_is_decided_alike(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = program_of(SCENES[name]())
    known = judge(program).stable
    monkeypatch.setattr(judging, "SIMPLEX_ROWS", 0)
    assert judge(program).stable is known
    monkeypatch.setattr(judging, "_by_equilibrium", lambda problem, work: iter(()))
    assert judge(program).stable is known


@pytest.mark.quick(3)
@pytest.mark.parametrize("name", sorted(SCENES))
@pytest.mark.parametrize("simplex_rows", [0, 1000])
def test_without_an_answer_of_a_solver_nothing_wrong_is_decided(
    name: str, simplex_rows: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = program_of(SCENES[name]())
    known = judge(program).stable
    monkeypatch.setattr(judging, "SIMPLEX_ROWS", simplex_rows)
    monkeypatch.setattr(highs, "solve_linear", failing(highs.solve_linear))
    assert judge(program).stable in (known, None)
    monkeypatch.setattr(clarabel, "solve_conic", failing(clarabel.solve_conic))
    judgement = judge(program)
    assert judgement.stable in (known, None)
    assert judgement.solvers[0] == "least forces of bonds" or any(
        "failed" in word for word in judgement.solvers
    )


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", sorted(SCENES))
def test_no_solver_alone_proves_the_other_side(name: str) -> None:
    program = program_of(SCENES[name]())
    known = judge(program).stable
    assert set(sides(program).values()) <= {known, None}


@pytest.mark.parametrize("solver", [None, "clarabel"])
@pytest.mark.parametrize("name", ["arch", "falling arch", "block", "strong glue"])
def test_least_cohesion_decides_without_a_load_factor(
    name: str, solver: judging.Solver | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    program = program_of(SCENES[name]())
    known = judge(program).stable
    monkeypatch.setattr(judging, "_by_strength", lambda wide, work: judging._Candidate("none"))
    monkeypatch.setattr(judging, "_by_cones", lambda wide, work: judging._Candidate("none"))
    judgement = judge(program, solver=solver)
    assert judgement.stable is known
    assert judgement.solvers[-1].startswith("least cohesion")


def test_glue_without_friction_is_decided_without_its_least_forces(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    program = program_of(glued(100.0))
    monkeypatch.setattr(judging, "SIMPLEX_ROWS", 0)
    zero = np.zeros(len(program.part_a))
    monkeypatch.setattr(judging, "least_forces", lambda problem: (zero, None))
    judgement = judge(program)
    assert judgement.stable
    assert judgement.solvers[1].startswith("total imbalance")


def test_a_friction_pyramid_that_is_too_large_is_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    program = program_of(SCENES["arch"]())
    monkeypatch.setattr(judging, "LARGEST_PYRAMID", 0)
    assert judge(program, solver="highs").stable is None


def test_if_every_solver_fails_the_answer_states_its_best_figures(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(judging, "_candidates", lambda *_: iter(()))
    verdict = kilter.check(SCENES["falling arch"]())
    assert verdict.verdict == "undecided"
    assert "numerical errors prevent a proof" in str(verdict.to_dict())
