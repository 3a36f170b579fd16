"""Decide whether forces of equilibrium exist, and prove the answer by a certificate.

Solvers only offer candidates: forces, or a motion. `kilter.mechanics.certificate` verifies each
candidate independently of the solver. The search ends when exactly one of the two certificates
holds. If none does, the answer is undecided, with the best forces and the best motion.

Without friction, an equilibrium suffices for stability. Small programs (`SIMPLEX_ROWS`) are
solved by simplex, with and without presolve: each time the load factor, then the least
imbalance. The load factor by interior point follows. Large programs are solved for

1. the equilibrium, by interior point;
2. the load factor, by interior point;
3. the least imbalance, which gives the strongest of both proofs for coarse data;
4. the load factor by simplex, if the program is not too large.

The last candidates of programs of any size come from the least imbalance without the smallest
entries of the rows, since these entries may be rounding errors.

If there are bonds, their least forces are tried first; a large program then adds the total
imbalance.

With friction the order is:

1. planar assemblies: the cone has two rays, so a linear program without friction is exact;
2. for more than `OWN_ROWS` freedoms, the load factor in exact cones by kilter's interior point;
3. the load factor in exact cones by Clarabel;
4. the least cohesion, which decides nearer to the limit of stability;
5. pyramids with more and more sides, and with rays along the friction of earlier solutions.
   Inner pyramids give forces, outer pyramids give a motion. They are solved by simplex, which
   is exact even if the set of equilibria has an empty interior.

Large programs are divided into groups of clusters (`kilter.mechanics.clusters`), which are judged
one after the other.

If the shear of a bond or the pull of a strap is limited by a force, planar or not, the order is:
the least share of the strength of bonds and straps that suffices, then 3 and 4.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple, TypedDict, Unpack

import numpy as np

from kilter.analysis.decision.cohesion import find_cohesion
from kilter.analysis.decision.refined_proofs import balanced_proof, opened_proof
from kilter.arrays import Array
from kilter.mechanics.certificate import ForceProof, MotionProof, check_forces, check_motion
from kilter.mechanics.clusters import Cluster, cluster_groups
from kilter.mechanics.coulomb_cones import (
    ConeProblem,
    angles_across,
    cone_problem,
    least_strength,
    load_factor_in_cones,
    pyramid,
    pyramid_forces,
)
from kilter.mechanics.forms import (
    ScaledProblem,
    equilibrium,
    least_forces,
    least_imbalance,
    load_factor,
    scaled_problem,
    total_imbalance,
)
from kilter.mechanics.mechanics_tolerances import ROUNDED_ENTRY
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program
from kilter.solvers.problem import LinearProgram
from kilter.work import Work

if TYPE_CHECKING:
    from kilter.solvers.highs import Method
    from kilter.solvers.problem import Solution


# Least fraction of the strength of bonds and straps with which contact forces balance the parts.


@dataclass(frozen=True, slots=True, eq=False)
class Strength:
    """The least fraction of bond strength that balances the parts, with forces and a motion.

    The forces and the motion are offered as proofs.
    """

    share: float
    """s, at least 0 [-]; infinite if no share suffices."""
    forces: Array
    friction: Array
    """Contact forces along and across the rows [N] that balance the parts at that share. Zero if
    the share is infinite."""
    motion: Array
    """Motion that starts if the strength falls below that share, shape (N, 6)."""
    word: str
    """Description of the solver run."""


def find_strength(wide: ConeProblem, *, work: Work | None = None) -> Strength | None:
    """Compute the least fraction of the strength of all bonds that balances the parts.

    None if the solver finds no solution.

    Returns None if the solver fails.

    Examples
    --------
    >>> from kilter import Assembly, Bond, Box, Part, Pose
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.coulomb_cones import cone_problem
    >>> from kilter.mechanics.program import build_program
    >>> wall = Part("wall", Box([1, 1, 1]), Pose([1, 0, 0]), grounded=True)
    >>> glue = Bond(("block", "wall"), pull=1e5, shear=9810 / 4)
    >>> glued = Assembly([wall, Part("block", Box([1, 1, 1]))], bonds=[glue])
    >>> found = find_strength(cone_problem(build_program(glued, contacts(glued))))
    >>> round(found.share, 6)  # four corners, the weight in the middle: all bear alike
    1.0
    """
    from kilter.solvers.clarabel import solve_conic

    program = wide.program
    unit = float(program.weight[program.free].sum()) / program.strength  # keeps s / unit near 1
    answer = solve_conic(least_strength(wide, unit), work=work)
    none = answer.proves_none
    if not (answer.found or none):
        return None
    problem = wide.problem
    x = np.zeros(problem.matrix.shape[1] + 1) if none else answer.x
    multipliers = answer.multipliers[: len(problem.right)]
    return Strength(
        np.inf if none else max(float(x[-1]), 0.0) * unit,
        *wide.decoded(x[:-1]),
        problem.motion(problem.over_weight(multipliers)),
        f"least strength: clarabel, {answer.iterations} iterations, {answer.outcome}",
    )


Solver = Literal["kilter", "clarabel", "highs"]
SOLVERS: tuple[Solver, ...] = ("kilter", "clarabel", "highs")
"""Names of the solvers that can be selected: kilter's own interior point and two packages."""

SIMPLEX_ROWS = 1500
"""Programs with up to this many freedoms are solved by simplex first."""
MANY_POINTS = 10_000
"""Number of contact points above which the smallest entries are rounded to zero at first: between
free-form parts they are 40 % of all entries, and a simplex takes minutes without a result."""
TINY_ROWS = 200
"""Programs with up to this many freedoms are solved without presolve first."""
OWN_ROWS = 120
"""Programs with friction and more freedoms than this are first solved by kilter's own interior
point. Clarabel solves smaller programs in less time."""
SIDES = (4, 16, 64)
"""Numbers of sides of the pyramids, from coarse to fine."""
LARGEST_PYRAMID = 20_000
"""Pyramids with more rays than this, over all rough contacts, are not tried."""


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """Answer of `judge`: whether contact forces can balance every part, with its proof."""

    stable: bool | None
    """True if forces of equilibrium exist, False if not, None if the numbers permit no proof."""
    forces: ForceProof | None
    """The forces with the least residual; the proof if `stable` is True."""
    motion: MotionProof | None
    """The best motion; the proof if `stable` is False."""
    solvers: tuple[str, ...]
    """A description of each solver run, in order."""


class _Candidate(NamedTuple):
    """Forces or a motion that a solver proposes as a proof, before verification.

    `forces` along the normals have shape (K,) [N], `friction` across them (K, 3) [N], and
    `motion` (N, 6). `word` describes the solver run.
    """

    word: str
    forces: Array | None = None
    friction: Array | None = None
    motion: Array | None = None


class _Options(TypedDict, total=False):
    """Keyword arguments that are passed on to `solve_linear`."""

    method: Method
    presolve: bool
    forces_only: bool
    work: Work


def judge(program: Program, *, work: Work | None = None, solver: Solver | None = None) -> Judgement:
    """Decide whether contact forces can balance every part, and prove the answer.

    Returns `stable` is None if no certificate holds.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> assembly = scene("tower")
    >>> judge(build_program(assembly, contacts(assembly))).stable
    True
    """
    if not program.free.any():
        return Judgement(True, check_forces(program, np.zeros(len(program.part_a))), None, ())
    work = Work() if work is None else work.beside()
    groups = cluster_groups(program)
    if len(groups) > 1:
        return _judge_groups(program, groups, work, solver)
    best_forces: ForceProof | None = None
    best_motion: MotionProof | None = None
    tried: list[str] = []
    for word, forces, friction, motion in _candidates(program, work, solver):
        tried.append(word)
        if forces is not None:
            proof = balanced_proof(program, check_forces(program, forces, friction))
            if best_forces is None or proof.residual < best_forces.residual:
                best_forces = proof
        if motion is not None:
            judged = opened_proof(program, check_motion(program, motion))
            if best_motion is None or _is_better(judged, best_motion):
                best_motion = judged
        stable = bool(best_forces and best_forces.holds)
        unstable = bool(best_motion and best_motion.holds)
        if stable != unstable:
            return Judgement(stable, best_forces, best_motion, tuple(tried))
        if work.late:
            break
    return Judgement(None, best_forces, best_motion, tuple(tried))


def _judge_groups(
    program: Program, groups: list[Cluster], work: Work, solver: Solver | None
) -> Judgement:
    """Judge a program group by group of its clusters; the proof is one of the whole program.

    The search ends at the first group that moves. A group without a proof leaves the answer open,
    unless another group moves.
    """
    forces, friction = np.zeros(len(program.part_a)), np.zeros((len(program.part_a), 3))
    motion: MotionProof | None = None
    solvers: tuple[str, ...] = ()
    stable: bool | None = True
    for number, group in enumerate(groups):
        if number and work.late:
            stable = None
            break
        judged = judge(group.program, work=work, solver=solver)
        solvers = max(solvers, judged.solvers, key=len)
        if judged.forces is not None:
            forces[group.rows] = judged.forces.forces
            friction[group.rows] = judged.forces.friction
        if judged.motion is not None:
            moved = check_motion(program, judged.motion.motion)
            if motion is None or _is_better(moved, motion):
                motion = moved
        if judged.stable is False:
            stable = False
            break
        if judged.stable is None:
            stable = None
    word = f"{len(groups)} groups of clusters, the longest search:"
    proof = check_forces(program, forces, friction)
    if (stable and not proof.holds) or (stable is False and not (motion and motion.holds)):
        stable = None
    return Judgement(stable, proof, motion, (word, *solvers))


def _is_better(first: MotionProof, other: MotionProof) -> bool:
    return (first.holds, first.ratio) > (other.holds, other.ratio)


def _candidates(program: Program, work: Work, solver: Solver | None) -> Iterator[_Candidate]:
    """Yield candidate proofs, the cheapest first, from all solvers or from `solver` alone."""
    rough = bool(program.mu.any())
    if program.has_limits:
        yield from _candidates_with_limits(program, work)
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
        yield from _candidates_without_friction(program, work)
    elif solver == "highs":
        yield from _by_pyramids(program, [], work)
    else:
        yield from _candidates_in_cones(program, work)


def _candidates_with_limits(program: Program, work: Work) -> Iterator[_Candidate]:
    """Yield candidate proofs for bonds of limited shear, or straps with a capacity."""
    wide = cone_problem(program)
    yield _by_strength(wide, work)
    yield _by_cones(wide, work)
    yield _by_cohesion(wide, work)


def _candidates_without_friction(program: Program, work: Work) -> Iterator[_Candidate]:
    """Yield candidate proofs for contacts without friction, the cheapest first."""
    problem = scaled_problem(program)
    bonded = least_forces(problem)
    if bonded is not None:
        yield _Candidate("least forces of bonds", bonded[0], motion=bonded[1])
    small = len(problem.right) <= SIMPLEX_ROWS
    if small:
        if problem.matrix.shape[1] > MANY_POINTS:
            rounded = problem.rounded(ROUNDED_ENTRY)
            yield from _by_least_imbalance(rounded, method="simplex", presolve=False, work=work)
        # presolve costs a tiny program more time than it saves; the second try inverts the choice
        first = len(problem.right) > TINY_ROWS
        for presolve in (first, not first):
            yield from _by_load_factor(problem, method="simplex", presolve=presolve, work=work)
            yield from _by_least_imbalance(problem, method="simplex", presolve=presolve, work=work)
        yield from _by_load_factor(problem, method="interior", work=work)
        # of all motions with parts of at most size 1, the one of greatest power
        yield from _by_total_imbalance(problem, work)
        yield from _by_rounded_rows(problem, work)
        return
    if bonded is not None:
        yield from _by_total_imbalance(problem, work)
    yield from _by_equilibrium(problem, work)
    yield from _by_load_factor(problem, method="interior", work=work)
    yield from _by_least_imbalance(problem, method="interior", work=work)
    if len(problem.right) <= 20 * SIMPLEX_ROWS:
        yield from _by_load_factor(problem, method="simplex", work=work)
    yield from _by_rounded_rows(problem, work)


def _by_rounded_rows(problem: ScaledProblem, work: Work) -> Iterator[_Candidate]:
    """Yield candidate proofs from the problem after its smallest entries were rounded to zero.

    Coordinates far from the origin make entries of 1e-12 that are rounding errors. A simplex that
    scales rows and columns makes them as large as other entries, and fails.
    """
    rounded = problem.rounded(ROUNDED_ENTRY)
    if len(problem.right) <= SIMPLEX_ROWS:
        yield from _by_least_imbalance(rounded, method="simplex", presolve=False, work=work)
    yield from _by_least_imbalance(rounded, method="interior", work=work)


def _solve_with_word(
    lp: LinearProgram, word: str, **options: Unpack[_Options]
) -> tuple[Solution, str]:
    """Solve a linear program; return its solution and a description of the solver run."""
    from kilter.solvers.highs import solve_linear

    answer = solve_linear(lp, **options)
    work, entries = options["work"], lp.matrix.nnz
    if options["method"] == "interior":
        work.conic(answer.iterations, entries)
    else:
        work.loaded(entries)
        work.linear(answer.iterations, entries)
    return answer, f"{word}: {answer.solver}, {answer.iterations} iterations, {answer.outcome}"


def _by_equilibrium(problem: ScaledProblem, work: Work) -> Iterator[_Candidate]:
    """Yield candidate forces that balance every part exactly, by a linear program."""
    lp = equilibrium(problem)
    answer, word = _solve_with_word(
        lp, "equilibrium", method="interior", forces_only=True, work=work
    )
    yield _Candidate(word, problem.forces(answer.x) if answer.found else None)


def _by_load_factor(problem: ScaledProblem, **options: Unpack[_Options]) -> Iterator[_Candidate]:
    """Yield a candidate proof from the greatest fraction (0 to 1) of the load that is balanced."""
    answer, word = _solve_with_word(load_factor(problem), "load factor", **options)
    if not answer.found:
        yield _Candidate(word)
        return
    factor = float(answer.x[-1])
    # the factor is 1 if an equilibrium exists and 0 if not, except for rounding
    forces = problem.forces(answer.x[:-1]) / factor if factor > 0.5 else None
    motion = None
    if factor < 0.5 and len(answer.multipliers):
        motion = problem.motion(problem.over_weight(-answer.multipliers))
    yield _Candidate(word, forces, motion=motion)


def _by_least_imbalance(
    problem: ScaledProblem, **options: Unpack[_Options]
) -> Iterator[_Candidate]:
    """Yield the forces of the smallest maximum imbalance, and a motion from the multipliers."""
    answer, word = _solve_with_word(least_imbalance(problem), "least imbalance", **options)
    if not answer.found:
        yield _Candidate(word)
        return
    rows, motion = len(problem.right), None
    if len(answer.multipliers):
        multipliers = answer.multipliers[:rows] + answer.multipliers[rows:]
        motion = problem.motion(problem.over_weight(-multipliers))
    yield _Candidate(word, problem.forces(answer.x[:-1]), motion=motion)


def _by_total_imbalance(problem: ScaledProblem, work: Work) -> Iterator[_Candidate]:
    """Yield candidate forces of the least sum of imbalances, and a motion from the multipliers."""
    answer, word = _solve_with_word(
        total_imbalance(problem), "total imbalance", method="interior", work=work
    )
    if not answer.found:
        yield _Candidate(word)
        return
    motion = None
    if len(answer.multipliers):
        motion = problem.motion(problem.over_weight(-answer.multipliers))
    yield _Candidate(word, problem.forces(answer.x[: len(problem.program.part_a)]), motion=motion)


def _candidates_in_cones(program: Program, work: Work) -> Iterator[_Candidate]:
    """Yield candidate proofs for contacts with friction, the cheapest first."""
    if int(program.free.sum()) * len(program.freedoms) > OWN_ROWS:
        yield from _by_own_cones(program, work)
    wide = cone_problem(program)
    fitted: list[Array] = []
    for in_cones in (_by_cones, _by_cohesion):
        candidate = in_cones(wide, work)
        yield candidate
        fitted += _friction_angles(program, candidate)
    yield from _by_pyramids(program, fitted, work)


def _by_pyramids(program: Program, fitted: list[Array], work: Work) -> Iterator[_Candidate]:
    """Yield candidate proofs with pyramids, which become finer, in place of the friction cones.

    `fitted` holds directions of friction at the rough contacts [rad]. They are added as rays,
    together with the directions of each new candidate.
    """
    for sides in SIDES:
        if (sides + len(fitted)) * len(program.rough) > LARGEST_PYRAMID:
            return
        even = [np.full(len(program.rough), 2 * np.pi * k / sides) for k in range(sides)]
        # beside 64 even rays a fitted ray gains nothing and makes two columns nearly parallel
        angles = np.column_stack([*even, *(fitted if sides < SIDES[-1] else [])])
        for outer in (False, True):
            candidate = _by_pyramid(program, sides, work, outer=outer, angles=angles)
            yield candidate
            fitted = fitted + _friction_angles(program, candidate)


def _friction_angles(program: Program, candidate: _Candidate) -> list[Array]:
    """Directions of friction [rad] at each rough contact, from a candidate's forces and slips."""
    directions = []
    if candidate.friction is not None:
        directions.append(angles_across(program, candidate.friction))
    if candidate.motion is not None:
        slips = np.zeros((len(program.part_a), 3))
        slips[program.rough] = -program.slips(candidate.motion, program.rough)
        directions.append(angles_across(program, slips))
    return directions


def _by_pyramid(
    program: Program,
    sides: int,
    work: Work,
    *,
    outer: bool = False,
    angles: Array | None = None,
    solver: Solver | None = None,
) -> _Candidate:
    """Candidate proof with pyramids in place of friction cones.

    Inner pyramids give forces, outer pyramids give a motion.

    An inner pyramid lies within the friction cone, so its forces obey the cone. An outer pyramid
    contains the cone, so its motion opposes every force of the cone. In a planar assembly the
    pyramid is the cone itself, and both proofs are taken.
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
    """Yield candidate proofs from the load factor in exact cones, by kilter's own solver."""
    # imported late: only friction needs these modules
    from kilter.mechanics.balance_in_cones import load_share
    from kilter.solvers.cone_interior_point import iterates

    balance = load_share(program)
    word, steps = "load factor in cones: kilter, {} iterations, {}", 0
    for step in iterates(balance.cones):
        work.conic(step.number - steps, balance.cones.columns.size)
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
    """Candidate proof from the load factor in exact friction cones, by the solver Clarabel."""
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
    """Candidate proof from the least fraction of the strength of all bonds that balances the parts.

    A share of at most 1 gives forces, a larger share gives a motion.
    """
    strength = find_strength(wide, work=work)
    if strength is None:
        return _Candidate("least strength: clarabel, failed")
    if strength.share > 1.0:
        return _Candidate(strength.word, motion=strength.motion)
    forces = strength.forces + (1.0 - strength.share) * wide.program.pull
    return _Candidate(strength.word, forces, strength.friction)


def _by_cohesion(wide: ConeProblem, work: Work) -> _Candidate:
    """Candidate proof from the least tension that contacts in exact friction cones need.

    A cohesion of at most 0 gives forces. A positive cohesion gives a motion, which is corrected
    so that it violates no contact.
    """
    cohesion = find_cohesion(wide, work=work)
    if cohesion is None:
        return _Candidate("least cohesion: clarabel, failed")
    if cohesion.value <= 0.0:
        return _Candidate(cohesion.word, cohesion.forces, cohesion.friction)
    return _Candidate(cohesion.word, motion=Opening(wide).mended(cohesion.motion))
