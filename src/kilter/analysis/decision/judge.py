"""Problem 1: is there an equilibrium? Solve, then judge; never believe a solver.

Without friction an equilibrium is all that stability needs. The methods, in an order that ends if
exactly one certificate passes; with bonds after least forces and, if large, total imbalance:

1. the load factor by simplex (small), or equilibrium by interior point (large);
2. the load factor by the other method;
3. the least imbalance, which gives the stronger of both proofs, if the data are coarse;
4. tighter, without presolve.

Then `undecided`, with the two figures. With friction an order of its own:

1. planar: the cone has two rays, so the program is linear and is judged as such;
2. the load factor in exact cones, by kilter's own interior point;
3. the same by Clarabel, if that has no proof: near the limit;
4. the least cohesion, which decides nearer to the limit;
5. pyramids with more and more sides, some along the friction of earlier solutions; the
   inner pyramids for forces, the outer pyramids for a motion:
   by simplex, which is exact if the set of equilibria has no interior.

If bonds bear shear up to a force, planar or not: the least share of their strength that is
enough, then 3 and 4.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple, TypedDict, Unpack

import numpy as np

from kilter.analysis.decision.cohesion import find_cohesion
from kilter.analysis.decision.strength import find_strength
from kilter.arrays import Array
from kilter.mechanics.balance_in_cones import load_share
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.coulomb_cones import (
    ConeProblem,
    angles_across,
    cone_problem,
    load_factor_in_cones,
    pyramid,
    pyramid_forces,
)
from kilter.mechanics.forms import (
    ScaledProblem,
    equilibrium,
    least_imbalance,
    load_factor,
    scaled_problem,
    total_imbalance,
)
from kilter.mechanics.least_forces import least_forces
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program
from kilter.solvers.cone_interior_point import iterates
from kilter.solvers.problem import LinearProgram
from kilter.work import Work

if TYPE_CHECKING:
    from kilter.solvers.highs import Method
    from kilter.solvers.solution import Solution

__all__ = ["SIMPLEX_ROWS", "SOLVERS", "Judgement", "Solver", "judge"]

Solver = Literal["kilter", "clarabel", "highs"]
SOLVERS: tuple[Solver, ...] = ("kilter", "clarabel", "highs")
"""Who may offer a proof: kilter's own interior point and two others."""

SIMPLEX_ROWS = 1500
"""Programs with up to this many freedoms are solved by simplex first."""
TINY_ROWS = 200
"""Programs with up to this many freedoms are solved without presolve first."""
OWN_ROWS = 120
"""Programs with friction and more freedoms than this are solved by kilter's own interior point
first: smaller ones Clarabel solves in less time."""
SIDES = (4, 16, 64)
"""Sides of the pyramids, in turn."""
LARGEST_PYRAMID = 20_000
"""Rays above which finer pyramids are left out."""


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """Which of the two proofs holds.

    Attributes
    ----------
    stable : bool or None
        There are forces of equilibrium; None: the numbers do not carry a proof.
    forces : ForceProof or None
        The best forces found; they are the proof if `stable` is True.
    motion : MotionProof or None
        The best motion found; it is the proof if `stable` is False.
    solvers : tuple of str
        Names of the solvers and their outcomes, in order.
    """

    stable: bool | None
    forces: ForceProof | None
    motion: MotionProof | None
    solvers: tuple[str, ...]


class _Candidate(NamedTuple):
    """Candidate for a proof from a solver, before it is judged.

    Forces along the rows (K,) and across them (K, 3) [N], or a motion (N, 6), or both.
    """

    word: str
    forces: Array | None = None
    friction: Array | None = None
    motion: Array | None = None


class _Options(TypedDict, total=False):
    """Options of `solve_linear`."""

    method: Method
    presolve: bool
    forces_only: bool
    work: Work


def judge(program: Program, *, work: Work | None = None, solver: Solver | None = None) -> Judgement:
    """Decide a program by a certificate.

    Parameters
    ----------
    program : Program
    work : Work, optional
        Its time limit is kept; nothing is charged, since there is no verdict without this.
    solver : {"kilter", "clarabel", "highs"}, optional
        The only solver to use, for comparisons; by default they are used in turn.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("tower")
    >>> judge(build_program(assembly, contacts(assembly))).stable
    True
    """
    best_forces: ForceProof | None = None
    best_motion: MotionProof | None = None
    tried: list[str] = []
    if not program.free.any():
        return Judgement(True, check_forces(program, np.zeros(len(program.part_a))), None, ())
    work = Work() if work is None else work.beside()
    for word, forces, friction, motion in _candidates(program, work, solver):
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
        if work.late:
            break
    return Judgement(None, best_forces, best_motion, tuple(tried))


def _better(one: MotionProof, other: MotionProof) -> bool:
    return (one.holds, one.ratio) > (other.holds, other.ratio)


def _candidates(program: Program, work: Work, solver: Solver | None) -> Iterator[_Candidate]:
    """Candidates of all solvers, the cheapest method first, or those of the given solver."""
    rough = bool(program.mu.any())
    if program.cohesion.any():
        yield from _with_limited_shear(program, work)
    elif rough and program.planar:
        yield _by_pyramid(program, 2, work, solver=solver)
    elif solver == "kilter":
        yield from _by_own_cones(program, work)
    elif solver == "clarabel":
        wide = cone_problem(program)
        yield _by_cones(wide, work)
        if rough:
            yield _by_cohesion(wide, work)
    elif not rough:
        yield from _without_friction(program, work)
    elif solver == "highs":
        yield from _by_pyramids(program, [], work)
    else:
        yield from _in_cones(program, work)


def _with_limited_shear(program: Program, work: Work) -> Iterator[_Candidate]:
    """Candidates if bonds bear shear up to a force."""
    wide = cone_problem(program)
    yield _by_strength(wide, work)
    yield _by_cones(wide, work)
    yield _by_cohesion(wide, work)


def _without_friction(program: Program, work: Work) -> Iterator[_Candidate]:
    """Candidate forces and motions, the cheapest way first."""
    problem = scaled_problem(program)
    bonded = least_forces(problem)
    if bonded is not None:
        yield _Candidate("least forces of bonds", bonded[0], motion=bonded[1])
    small = len(problem.right) <= SIMPLEX_ROWS
    if small:
        # presolve costs a tiny program more than it saves; the other way is the second try
        first = len(problem.right) > TINY_ROWS
        for presolve in (first, not first):
            yield from _by_load_factor(problem, method="simplex", presolve=presolve, work=work)
            yield from _by_least_imbalance(problem, method="simplex", presolve=presolve, work=work)
        yield from _by_load_factor(problem, method="interior", work=work)
        return
    if bonded is not None:
        yield from _by_total_imbalance(problem, work)
    yield from _by_equilibrium(problem, work)
    yield from _by_load_factor(problem, method="interior", work=work)
    yield from _by_least_imbalance(problem, method="interior", work=work)
    if len(problem.right) <= 20 * SIMPLEX_ROWS:
        yield from _by_load_factor(problem, method="simplex", work=work)


def _solved(lp: LinearProgram, word: str, **options: Unpack[_Options]) -> tuple[Solution, str]:
    """The answer, and a word about it."""
    from kilter.solvers.highs import solve_linear

    answer = solve_linear(lp, **options)
    return answer, f"{word}: {answer.solver}, {answer.iterations} iterations, {answer.outcome}"


def _by_equilibrium(problem: ScaledProblem, work: Work) -> Iterator[_Candidate]:
    lp = equilibrium(problem)
    answer, word = _solved(lp, "equilibrium", method="interior", forces_only=True, work=work)
    yield _Candidate(word, problem.forces(answer.x) if answer.found else None)


def _by_load_factor(problem: ScaledProblem, **options: Unpack[_Options]) -> Iterator[_Candidate]:
    answer, word = _solved(load_factor(problem), "load factor", **options)
    if not answer.found:
        yield _Candidate(word)
        return
    factor = float(answer.x[-1])
    forces = problem.forces(answer.x[:-1]) / factor if factor > 0.5 else None
    motion = None
    if factor < 0.5 and len(answer.multipliers):
        motion = problem.motion(problem.over_weight(-answer.multipliers))
    yield _Candidate(word, forces, motion=motion)


def _by_least_imbalance(
    problem: ScaledProblem, **options: Unpack[_Options]
) -> Iterator[_Candidate]:
    answer, word = _solved(least_imbalance(problem), "least imbalance", **options)
    if not answer.found:
        yield _Candidate(word)
        return
    rows, motion = len(problem.right), None
    if len(answer.multipliers):
        multipliers = answer.multipliers[:rows] + answer.multipliers[rows:]
        motion = problem.motion(problem.over_weight(-multipliers))
    yield _Candidate(word, problem.forces(answer.x[:-1]), motion=motion)


def _by_total_imbalance(problem: ScaledProblem, work: Work) -> Iterator[_Candidate]:
    answer, word = _solved(
        total_imbalance(problem), "total imbalance", method="interior", work=work
    )
    if not answer.found:
        yield _Candidate(word)
        return
    motion = None
    if len(answer.multipliers):
        motion = problem.motion(problem.over_weight(-answer.multipliers))
    yield _Candidate(word, problem.forces(answer.x[: len(problem.program.part_a)]), motion=motion)


def _in_cones(program: Program, work: Work) -> Iterator[_Candidate]:
    """Candidates for a program with friction, the cheapest way first."""
    if int(program.free.sum()) * len(program.freedoms) > OWN_ROWS:
        yield from _by_own_cones(program, work)
    wide = cone_problem(program)
    fitted: list[Array] = []
    for in_cones in (_by_cones, _by_cohesion):
        candidate = in_cones(wide, work)
        yield candidate
        fitted += _angles(program, candidate)
    yield from _by_pyramids(program, fitted, work)


def _by_pyramids(program: Program, fitted: list[Array], work: Work) -> Iterator[_Candidate]:
    """Finer and finer pyramids, with rays at some angles of the friction at each rough contact."""
    for sides in SIDES:
        if (sides + len(fitted)) * len(program.rough) > LARGEST_PYRAMID:
            return
        even = [np.full(len(program.rough), 2 * np.pi * k / sides) for k in range(sides)]
        # many even rays need no fitted ones beside them, which only make them nearly parallel
        angles = np.column_stack([*even, *(fitted if sides < SIDES[-1] else [])])
        for outer in (False, True):
            candidate = _by_pyramid(program, sides, work, outer=outer, angles=angles)
            yield candidate
            fitted = fitted + _angles(program, candidate)


def _angles(program: Program, candidate: _Candidate) -> list[Array]:
    """Directions of friction at each rough contact, by forces and by slips [rad]."""
    found = []
    if candidate.friction is not None:
        found.append(angles_across(program, candidate.friction))
    if candidate.motion is not None:
        slips = np.zeros((len(program.part_a), 3))
        slips[program.rough] = -program.slips(candidate.motion, program.rough)
        found.append(angles_across(program, slips))
    return found


def _by_pyramid(
    program: Program,
    sides: int,
    work: Work,
    *,
    outer: bool = False,
    angles: Array | None = None,
    solver: Solver | None = None,
) -> _Candidate:
    """The proof that a pyramid carries: forces of an inner pyramid, a motion of an outer pyramid.

    A planar pyramid is the cone itself and is both.
    """
    rays = pyramid(program, sides, outer=outer, angles=angles)
    judged = judge(rays, work=work, solver=solver)
    count = sides if angles is None else angles.shape[1]
    word = f"{'outer' if outer else 'inner'} pyramid of {count} sides"
    words = "; ".join((word, *judged.solvers))
    both = program.planar
    forces = friction = None
    if judged.forces is not None and (both or not outer):
        forces, friction = pyramid_forces(program, rays, judged.forces.forces)
    motion = judged.motion.motion if judged.motion is not None and (both or outer) else None
    return _Candidate(words, forces, friction, motion)


def _by_own_cones(program: Program, work: Work) -> Iterator[_Candidate]:
    """Candidates from the load factor in exact cones, by kilter's own interior point."""
    balance = load_share(program)
    word, steps = "load factor in cones: kilter, {} iterations, {}", 0
    for step in iterates(balance.cones):
        steps = step.number
        x, y = step.balanced(), step.against()
        if x is not None:
            yield _Candidate(word.format(steps, "forces"), *balance.decoded(x / step.share))
        if y is not None:
            yield _Candidate(word.format(steps, "motion"), motion=balance.motion(-y))
        if work.late:
            return
    yield _Candidate(word.format(steps, "no proof"))


def _by_cones(wide: ConeProblem, work: Work) -> _Candidate:
    """The load factor in exact cones."""
    from kilter.solvers.clarabel import solve_conic

    problem = wide.problem
    answer = solve_conic(load_factor_in_cones(wide), work=work)
    word = f"load factor in cones: clarabel, {answer.iterations} iterations, {answer.outcome}"
    if not answer.found:
        return _Candidate(word)
    factor = float(answer.x[-1])
    if factor > 0.5:
        forces, friction = wide.decoded(answer.x[:-1] / factor)
        return _Candidate(word, forces, friction)
    motion = problem.motion(problem.over_weight(answer.multipliers[: len(problem.right)]))
    return _Candidate(word, motion=motion)


def _by_strength(wide: ConeProblem, work: Work) -> _Candidate:
    """The least share of the strength of bonds: forces if it is below 1, above it a motion."""
    found = find_strength(wide, work=work)
    if found is None:
        return _Candidate("least strength: clarabel, failed")
    if found.share > 1.0:
        return _Candidate(found.word, motion=found.motion)
    forces = found.forces + (1.0 - found.share) * wide.program.pull
    return _Candidate(found.word, forces, found.friction)


def _by_cohesion(wide: ConeProblem, work: Work) -> _Candidate:
    """The least cohesion in exact cones: forces below 0, above it a motion, made admissible."""
    found = find_cohesion(wide, work=work)
    if found is None:
        return _Candidate("least cohesion: clarabel, failed")
    if found.value <= 0.0:
        return _Candidate(found.word, found.forces, found.friction)
    return _Candidate(found.word, motion=Opening(wide).mended(found.motion))
