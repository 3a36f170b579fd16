"""Proof that no motion that obeys Coulomb's contact law can start.

    a = M^-1 (w + J^T f),  un >= 0,  f in Coulomb's cone,  fn un = 0,  ft.ut = -mu fn |ut|

Here w are the loads and u = J a the accelerations at the contact points. The law may have many
solutions, with different forces and different motions. If a = 0 in all of them, friction of this
size holds the assembly, and no previous squeeze can change that. The proof uses programs that
contain all solutions: in space first moments (`kilter.friction.moment_bound`), whose bound needs no
cases; for the rest, and in the plane, linear programs and cases (`kilter.friction.relaxation`). No
bound trusts a solver, and each step can be repeated without a solver
(`kilter.friction.exclusion_file`). Without a proof the question is open, which is no refutation;
the bound then limits how fast a motion could start.

A power counts as zero if it is below 1e-8 (coarser for coarse data) of that of the lightest part in
free fall, so that small parts count beside large parts.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from kilter.arrays import Array
from kilter.friction.canonical import canonical
from kilter.friction.contraction import ProofAttempt, contract, power_bound, shrunk
from kilter.friction.enclosure import Enclosure, rescaled
from kilter.friction.exclusion_bounds import (
    FORCES,
    TOTALS,
    ExclusionStep,
    first_bounds,
    largest_forces,
    no_power,
)
from kilter.friction.exclusion_cases import CasesLeft, divide_cases
from kilter.friction.friction_tolerances import LARGEST_FORCE
from kilter.friction.moments import FORMS_OF_POINT, MOST_FORMS, moment_proof
from kilter.friction.opening_motion import opening_motion
from kilter.friction.reduced_law import ReducedLaw, reduced_law, refusal
from kilter.friction.relaxation import Relaxation
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.solvers.highs import bounding
from kilter.tell.record import InPython, Record
from kilter.threads import on_one_thread
from kilter.work import Work

Kind = Literal["moments", "contraction", "modes", "sectors"]

FIRST = 0.05
"""In the plane, fraction of the work for contact modes before the bounds are contracted. Easy
proofs need no contraction; the others rarely succeed before it, whatever the work."""
FORCES_FIRST = 0.1
"""In space, fraction of the work for shrinking the bounds of forces."""
SECOND = 0.3
"""Fraction of the remaining work for the contraction of bounds."""
LIMIT = f"contact forces up to {LARGEST_FORCE:g} times the weight"
"""Assumption that a proof states if no motion bounds the contact forces."""
CASES, CASE_ENTRY = 5, 3.0
"""In space, cases are examined only if at least the first number of them is affordable; the second
is the work units per relaxation entry of each.
"""
CLOSE_BY, MANY, GLANCE = 1e-5, 300, 0.1
"""If moments leave a power above the first number, fewer cases than the second never closed it. If
so many are not affordable, cases get the third fraction of the remaining work, to improve the
bound.
"""
ROW_ENTRIES = 160
"""In space, number of relaxation entries of each contact point."""
BY_MOMENTS = 0.8
"""Fraction of the work limit after which no further moment relaxation is started [-]."""


class Exclusion(Record, kw_only=False):
    """Result of the attempt to prove that no motion can start from rest."""

    proved: bool
    """Whether no motion can start."""
    kind: Kind | None
    """Method of the proof: products of the law; bounds alone; contact modes in the plane; sectors
    of sliding directions."""
    programs: int
    """Number of solved programs."""
    nodes: InPython[int]
    """Number of bounded cases."""
    bound: float
    """Largest power w.a of a motion that is not excluded, in units of |w|^2 in the metric of the
    masses [-]; free fall has 1."""
    assumes: str
    """Assumption of the proof, or an empty text."""
    work: InPython[float]
    """Units of work spent (`kilter.work`)."""
    why: InPython[str] = ""
    """Reason if the law does not apply to the program, or an empty text."""
    opening: InPython[Array | None] = None
    """The motion that bounds all forces."""
    steps: InPython[tuple[ExclusionStep, ...]] = ()
    """All data needed to repeat the proof."""


@on_one_thread
def prove_no_motion(program: Program, *, work: Work | float = 1.0) -> Exclusion:
    """Try to prove that no motion that obeys Coulomb's contact law can start.

    Arguments: `program`: contains only modelled contacts; a program with possible rows is refused.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes.stacks import block_on_slope
    >>> for friction in (0.5, 0.3):
    ...     slope = block_on_slope(20.0, friction=friction)
    ...     prove_no_motion(build_program(slope, contacts(slope))).proved
    True
    False
    """
    work = Work.of(work).fraction_left(1.0)
    if not program.free.any() or not program.load[program.free].any():
        return Exclusion(True, "contraction", 0, 0, 0.0, "", work.spent)
    program = canonical(program)
    why = refusal(program)
    if why:
        return Exclusion(False, None, 0, 0, 1.0, "", work.spent, why)
    # fixed joints may leave no free body: nothing is excluded by power then
    if not program.free.any() or _out_of_reach(program, work):
        return Exclusion(False, None, 0, 0, 1.0, "", work.spent)
    law = reduced_law(program)
    opening = opening_motion(law, work=work)
    attempt, bounds = start_proof(law, no_power(program), opening, work)
    kind, left = _prove(attempt, bounds, opening)
    proved = left.power <= attempt.tolerance
    return Exclusion(
        proved,
        kind if proved else None,
        attempt.solver.solves + len(attempt.steps),
        left.nodes,
        left.power,
        "" if not proved or np.isfinite(largest_forces(law, opening)) else LIMIT,
        work.spent,
        opening=opening,
        steps=tuple(attempt.steps) if proved else (),
    )


def _out_of_reach(program: Program, work: Work) -> bool:
    """Whether a proof in space is too expensive: too many points for moments, and costly cases.

    The proof is then not begun: its data alone take longer than the verdict of equilibrium.
    """
    points = int((program.kind == CONTACT).sum())
    forms = points * FORMS_OF_POINT + int(program.free.sum()) * len(program.freedoms)
    cost = CASE_ENTRY * ROW_ENTRIES * points
    return not program.planar and forms > MOST_FORMS and MANY * cost > work.left


def start_proof(
    law: ReducedLaw, tolerance: float, opening: Array | None, work: Work
) -> tuple[ProofAttempt, Enclosure]:
    """Create the relaxation and the first bounds of a proof that no motion can start."""
    attempt = ProofAttempt(law, Relaxation(law), bounding(), work, tolerance)
    return attempt, first_bounds(law, attempt.relaxation, opening)


def _prove(
    attempt: ProofAttempt, bounds: Enclosure, opening: Array | None
) -> tuple[Kind, CasesLeft]:
    """Try the kinds of proof in turn: in space moments then sectors, in the plane modes."""
    if attempt.law.directions == 1:
        return _prove_in_plane(attempt, bounds)
    least = 1.0
    if opening is not None:
        budget = attempt.work.until(BY_MOMENTS)
        moments = moment_proof(attempt.law, opening, attempt.tolerance, work=budget)
        attempt.steps.extend(moments.steps)
        if moments.power <= attempt.tolerance:
            return "moments", CasesLeft(moments.power, 0, True)
        least = moments.power
        bounds = rescaled(attempt.relaxation.fastest, bounds, least)
    cost = CASE_ENTRY * attempt.relaxation.program(bounds).matrix.nnz
    if attempt.work.over or CASES * cost > attempt.work.left:
        return "sectors", CasesLeft(least, 0, False)
    hopeless = least > CLOSE_BY and MANY * cost > attempt.work.left
    work = attempt.work.fraction_left(GLANCE) if hopeless else attempt.work
    if not hopeless:
        _, _, answer, _ = power_bound(attempt, bounds)
        bounds = shrunk(attempt, bounds, answer, FORCES, attempt.work.until(FORCES_FIRST))
    left = _record_step(attempt, divide_cases(attempt, bounds, work))
    return "sectors", replace(left, power=min(left.power, least))


def _prove_in_plane(attempt: ProofAttempt, bounds: Enclosure) -> tuple[Kind, CasesLeft]:
    """Prove in the plane: divide into contact modes, contract the bounds, then divide again.

    Only the bounds of force sums are contracted (`TOTALS`), in space only those of forces:
    contracting those of motions takes longer than it saves.
    """
    work = attempt.work
    modes: Kind = "modes"
    first = _record_step(attempt, divide_cases(attempt, bounds, work.until(FIRST)))
    if first.ended or work.over:
        return modes, first
    tight, power = contract(attempt, bounds, TOTALS, work.fraction_left(SECOND))
    if power <= attempt.tolerance:
        return "contraction", replace(first, power=power)
    if work.over:
        return modes, replace(first, power=min(first.power, power))
    last = _record_step(attempt, divide_cases(attempt, tight))
    best = last if last.power <= first.power else first
    return modes, replace(best, nodes=first.nodes + last.nodes)


def _record_step(attempt: ProofAttempt, left: CasesLeft) -> CasesLeft:
    """Append a complete division into cases to the steps of the proof; return `left` unchanged."""
    if left.step is not None:
        attempt.steps.append(left.step)
    return left
