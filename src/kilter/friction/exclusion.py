"""The exclusion of motions: no motion that obeys Coulomb's contact law can start.

    a = M^-1 (w + J^T f),  un >= 0,  f in Coulomb's cone,  fn un = 0,  ft.ut = -mu fn |ut|

Here w are the loads and u = J a the accelerations at the contact points. The law may have many
solutions: different forces, and different motions. Where a = 0 in all of them, friction of
this size holds the assembly, and no squeeze beforehand can change that. This is proved by
programs that contain all solutions: in space first by moments (`kilter.friction.moments`), whose
bound needs no cases; what they leave, and all in the plane, by linear programs and cases
(`kilter.friction.relaxation`). No bound trusts a solver, and each step can be repeated without
one (`kilter.friction.exclusion_check`). What is not proved is open: that is no refutation; the
bound then says how fast a motion could start at most.

A power counts as none if it is below 1e-8 (coarser for coarse data) of that of the lightest
part in free fall, so that no small part vanishes beside large ones.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from kilter.arrays import Array
from kilter.friction.contraction import ProofAttempt, contract, power_bound, shrunk
from kilter.friction.enclosure import Enclosure, rescaled
from kilter.friction.exclusion_bounds import FORCES, first_bounds, largest_forces, no_power
from kilter.friction.exclusion_cases import CasesLeft, divided
from kilter.friction.exclusion_steps import ExclusionStep
from kilter.friction.friction_tolerances import LARGEST_FORCE
from kilter.friction.moments import moment_proof
from kilter.friction.opening_motion import opening_motion
from kilter.friction.reduced_law import ReducedLaw, reduced_law, refusal
from kilter.friction.relaxation import Relaxation
from kilter.mechanics.program import Program
from kilter.solvers.highs import bounding
from kilter.threads import on_one_thread
from kilter.work import Work

__all__ = ["Exclusion", "prove_no_motion", "start_proof"]

Kind = Literal["moments", "contraction", "modes", "sectors"]

FIRST = 0.5
"""Fraction of the work for modes before anything is contracted."""
FORCES_FIRST = 0.1
"""In space, fraction of the work for the bounds of forces."""
SECOND = 0.4
"""Fraction of what is left then for contraction."""
LIMIT = f"contact forces up to {LARGEST_FORCE:g} times the weight"
"""What a proof supposes where nothing bounds the forces."""
CASES, CASE_ENTRY = 5, 3.0
"""In space cases are begun if so many can be paid; units of an entry of the relaxation in each."""
CLOSE_BY, MANY, GLANCE = 1e-5, 300, 0.1
"""Of what moments leave, powers above the first were not closed by fewer than so many cases: where
they cannot be paid, cases may take the third fraction of what is left, for a better bound."""
BY_MOMENTS = 0.8
"""Fraction of the work after which moments begin no further step."""


@dataclass(frozen=True, slots=True, eq=False)
class Exclusion:
    """Whether it is proved that no motion can start.

    Attributes
    ----------
    proved : bool
    kind : {"moments", "contraction", "modes", "sectors", None}
        How: by products of the law; by bounds alone; by the modes of contacts in the plane; by
        sectors of sliding.
    programs, nodes : int
        Programs solved; cases that were bounded.
    bound : float
        Largest power w.a of a motion that is not excluded, in units of |w|^2 in the metric of
        the masses [-]: 1 is free fall.
    assumes : str
        What the proof supposes, or "".
    work : float
        Units spent (`kilter.work`).
    why : str
        Why nothing could be asked, or "".
    opening : ndarray or None
        The motion that bounds all forces.
    steps : tuple of ExclusionStep
        All that it takes to repeat the proof.
    """

    proved: bool
    kind: Kind | None
    programs: int
    nodes: int
    bound: float
    assumes: str
    work: float
    why: str = ""
    opening: Array | None = None
    steps: tuple[ExclusionStep, ...] = ()


@on_one_thread
def prove_no_motion(program: Program, *, work: Work | float = 1.0) -> Exclusion:
    """Try to prove that no motion obeying Coulomb's contact law can start.

    Parameters
    ----------
    program : Program
        With modelled contacts only: possible rows are refused.
    work : Work or float
        Or an effort (`kilter.work`).

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
    why = refusal(program)
    if why:
        return Exclusion(False, None, 0, 0, 1.0, "", work.spent, why)
    law = reduced_law(program)
    opening = opening_motion(law, work=work)
    attempt, bounds = start_proof(law, no_power(program), opening, work)
    kind, left = _tried(attempt, bounds, opening)
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


def start_proof(
    law: ReducedLaw, tolerance: float, opening: Array | None, work: Work
) -> tuple[ProofAttempt, Enclosure]:
    """Relaxation and solver of a law, and what is known before anything is asked."""
    attempt = ProofAttempt(law, Relaxation(law), bounding(), work, tolerance)
    return attempt, first_bounds(law, attempt.relaxation, opening)


def _tried(
    attempt: ProofAttempt, bounds: Enclosure, opening: Array | None
) -> tuple[Kind, CasesLeft]:
    """In space by moments, then by sectors of what they leave; in the plane by modes."""
    if attempt.law.directions == 1:
        return _in_the_plane(attempt, bounds)
    least = 1.0
    if opening is not None:
        part = attempt.work.until(BY_MOMENTS)
        found = moment_proof(attempt.law, opening, attempt.tolerance, work=part)
        attempt.steps.extend(found.steps)
        if found.power <= attempt.tolerance:
            return "moments", CasesLeft(found.power, 0, True)
        least = found.power
        bounds = rescaled(attempt.relaxation.fastest, bounds, least)
    cost = CASE_ENTRY * attempt.relaxation.program(bounds).matrix.nnz
    if attempt.work.over or CASES * cost > attempt.work.left:
        return "sectors", CasesLeft(least, 0, False)
    hopeless = least > CLOSE_BY and MANY * cost > attempt.work.left
    work = attempt.work.fraction_left(GLANCE) if hopeless else attempt.work
    if not hopeless:
        _, _, answer, _ = power_bound(attempt, bounds)
        bounds = shrunk(attempt, bounds, answer, FORCES, attempt.work.until(FORCES_FIRST))
    left = _kept(attempt, divided(attempt, bounds, work))
    return "sectors", replace(left, power=min(left.power, least))


def _in_the_plane(attempt: ProofAttempt, bounds: Enclosure) -> tuple[Kind, CasesLeft]:
    """Modes for a while; then contraction; then modes within its bounds.

    In space only the bounds of forces are contracted: those of motions take longer to
    contract than they save.
    """
    work = attempt.work
    modes: Kind = "modes"
    first = _kept(attempt, divided(attempt, bounds, work.until(FIRST)))
    if first.ended or work.over:
        return modes, first
    tight, power = contract(attempt, bounds, work.fraction_left(SECOND))
    if power <= attempt.tolerance:
        return "contraction", replace(first, power=power)
    if work.over:
        return modes, replace(first, power=min(first.power, power))
    last = _kept(attempt, divided(attempt, tight))
    best = last if last.power <= first.power else first
    return modes, replace(best, nodes=first.nodes + last.nodes)


def _kept(attempt: ProofAttempt, left: CasesLeft) -> CasesLeft:
    """What a division left, its tree a step of the proof where it closed all."""
    if left.step is not None:
        attempt.steps.append(left.step)
    return left
