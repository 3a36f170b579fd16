"""Problem 1: is there an equilibrium? Solve, then judge; never believe a solver.

Without friction an equilibrium is all that stability needs. An order that ends where exactly
one certificate passes:

1. the load factor by simplex (small), or equilibrium by interior point (large);
2. the load factor by the other method;
3. the least imbalance, which gives the strongest of both proofs, where the data are coarse;
4. tighter, without presolve.

Then `undecided`, with the two figures. Programs with friction go by
`kilter.analysis.equilibrium`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypedDict, Unpack

import numpy as np

from kilter.analysis.candidates import Candidate
from kilter.analysis.equilibrium import in_cones
from kilter.errors import SolverError
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.forms import (
    Scaled,
    equilibrium,
    least_imbalance,
    load_factor,
    scaled,
)
from kilter.mechanics.program import Program
from kilter.solvers.problem import LinearProgram

if TYPE_CHECKING:
    from kilter.solvers.linear import LinearSolution, Method

__all__ = ["SIMPLEX_ROWS", "Judgement", "judge"]


SIMPLEX_ROWS = 1500
"""Programs with up to this many freedoms are solved by simplex first."""
TINY_ROWS = 200
"""Programs with up to this many freedoms are solved without presolve first."""


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """Which of the two proofs holds.

    Attributes
    ----------
    stable : bool or None
        There are forces of equilibrium; None: the numbers do not carry a proof.
    forces : ForceProof or None
        The best forces found; they prove it where `stable` is True.
    motion : MotionProof or None
        The best motion found; it proves it where `stable` is False.
    solvers : tuple of str
        What was run, in order.
    """

    stable: bool | None
    forces: ForceProof | None
    motion: MotionProof | None
    solvers: tuple[str, ...]


class _Options(TypedDict, total=False):
    """Options of `solve_linear`."""

    method: Method
    presolve: bool
    forces_only: bool


def judge(program: Program) -> Judgement:
    """Decide a program by a certificate.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import find_contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("tower")
    >>> judge(build_program(assembly, find_contacts(assembly))).stable
    True
    """
    best_forces: ForceProof | None = None
    best_motion: MotionProof | None = None
    tried: list[str] = []
    if not program.free.any():
        return Judgement(True, check_forces(program, np.zeros(len(program.part_a))), None, ())
    candidates = in_cones(program) if program.mu.any() else _candidates(program)
    for word, forces, friction, motion in candidates:
        tried.append(word)
        if forces is not None:
            proof = check_forces(program, forces, friction)
            if best_forces is None or proof.residual < best_forces.residual:
                best_forces = proof
        if motion is not None:
            judged = check_motion(program, motion)
            if best_motion is None or _better(judged, best_motion):
                best_motion = judged
        stable = bool(best_forces and best_forces.holds)
        unstable = bool(best_motion and best_motion.holds)
        if stable != unstable:
            return Judgement(stable, best_forces, best_motion, tuple(tried))
    return Judgement(None, best_forces, best_motion, tuple(tried))


def _better(one: MotionProof, other: MotionProof) -> bool:
    return (one.holds, one.ratio) > (other.holds, other.ratio)


def _candidates(program: Program) -> Iterator[Candidate]:
    """Candidate forces and motions, the cheapest way first."""
    problem = scaled(program)
    small = len(problem.right) <= SIMPLEX_ROWS
    if small:
        # presolve costs a tiny program more than it saves; the other way is the second try
        first = len(problem.right) > TINY_ROWS
        for presolve in (first, not first):
            yield from _by_load_factor(problem, method="simplex", presolve=presolve)
            yield from _by_least_imbalance(problem, method="simplex", presolve=presolve)
        yield from _by_load_factor(problem, method="interior")
        return
    yield from _by_equilibrium(problem)
    yield from _by_load_factor(problem, method="interior")
    yield from _by_least_imbalance(problem, method="interior")
    if len(problem.right) <= 20 * SIMPLEX_ROWS:
        yield from _by_load_factor(problem, method="simplex")


def _solved(
    lp: LinearProgram, word: str, **options: Unpack[_Options]
) -> tuple[LinearSolution | None, str]:
    """The answer, None where the solver broke down, and a word about it."""
    from kilter.solvers.linear import solve_linear

    try:
        answer = solve_linear(lp, **options)
    except SolverError as error:
        return None, f"{word}: {error.status}"
    return answer, f"{word}: {answer.solver}, {answer.iterations} iterations, {answer.outcome}"


def _by_equilibrium(problem: Scaled) -> Iterator[Candidate]:
    answer, word = _solved(equilibrium(problem), "equilibrium", method="interior", forces_only=True)
    if answer is not None and len(answer.x):
        yield Candidate(word, problem.forces(answer.x))


def _by_load_factor(problem: Scaled, **options: Unpack[_Options]) -> Iterator[Candidate]:
    answer, word = _solved(load_factor(problem), "load factor", **options)
    if answer is None or not len(answer.x):
        return
    factor = float(answer.x[-1])
    forces = problem.forces(answer.x[:-1]) / factor if factor > 0.5 else None
    motion = problem.motion(problem.over_weight(-answer.multipliers)) if factor < 0.5 else None
    yield Candidate(word, forces, motion=motion)


def _by_least_imbalance(problem: Scaled, **options: Unpack[_Options]) -> Iterator[Candidate]:
    answer, word = _solved(least_imbalance(problem), "least imbalance", **options)
    if answer is None or not len(answer.x):
        return
    rows = len(problem.right)
    multipliers = answer.multipliers[:rows] + answer.multipliers[rows:]
    motion = problem.motion(problem.over_weight(-multipliers))
    yield Candidate(word, problem.forces(answer.x[:-1]), motion=motion)
