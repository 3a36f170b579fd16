"""The exclusion of motions: no motion that obeys Coulomb's contact law can start.

    a = M^-1 (w + J^T f),  un >= 0,  f in Coulomb's cone,  fn un = 0,  ft.ut = -mu fn |ut|

Here w are the loads and u = J a the accelerations at the contact points. The law may have many
solutions: different forces, and different motions. Where a = 0 in all of them, friction of
this size holds the assembly, and no squeeze beforehand can change that. This is proved by
linear programs that contain all solutions (`kilter.friction.relaxation`), with bounds that do
not trust the solver. What is not proved is open: that is no refutation.

A power counts as none if it is below 1e-8 (coarser for coarse data) of that of the lightest
part in free fall, so that no small part vanishes beside large ones.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from kilter.friction.contraction import (
    FORCES,
    ProofAttempt,
    contract,
    forces_bounded,
    power_bound,
    shrunk,
)
from kilter.friction.enclosure import Enclosure, first_enclosure
from kilter.friction.exclusion_cases import CasesLeft, divided
from kilter.friction.friction_tolerances import COARSEST_NO_POWER, LARGEST_FORCE, NO_POWER
from kilter.friction.reduced_law import reduced_law, refusal
from kilter.friction.relaxation import TANGENTS, Relaxation
from kilter.mechanics.program import Program
from kilter.solvers.highs import bounding
from kilter.threads import on_one_thread
from kilter.work import Work

__all__ = ["Exclusion", "prove_no_motion", "start_proof"]

Kind = Literal["contraction", "modes", "sectors"]

FIRST = 0.1
"""Fraction of the work for modes before anything is contracted; in space, for the forces."""
SECOND = 0.4
"""Fraction of what is left then for contraction."""


@dataclass(frozen=True, slots=True, eq=False)
class Exclusion:
    """Whether it is proved that no motion can start.

    Attributes
    ----------
    proved : bool
    kind : {"contraction", "modes", "sectors", None}
        How: by bounds alone; by the modes of contacts in the plane; by sectors of sliding.
    programs, nodes : int
        Linear programs solved; cases that were bounded.
    bound : float
        Largest power w.a of a motion that is not excluded, in units of |w|^2 in the metric of
        the masses [-]: 1 is free fall.
    assumes : str
        What the proof supposes, or "".
    work : float
        Units spent (`kilter.work`).
    why : str
        Why nothing could be asked, or "".
    """

    proved: bool
    kind: Kind | None
    programs: int
    nodes: int
    bound: float
    assumes: str
    work: float
    why: str = ""


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
    attempt, bounds = start_proof(program, work)
    bounded = forces_bounded(attempt, bounds)
    kind, left = _tried(attempt, replace(bounds, cuts=True))
    proved = left.power <= attempt.tolerance
    limit = f"contact forces up to {LARGEST_FORCE:g} times the weight"
    return Exclusion(
        proved,
        kind if proved else None,
        attempt.solver.solves,
        left.nodes,
        left.power,
        "" if bounded or not proved else limit,
        work.spent,
    )


def start_proof(program: Program, work: Work) -> tuple[ProofAttempt, Enclosure]:
    """Law, relaxation and solver of a program, and what is known before anything is asked."""
    law = reduced_law(program)
    attempt = ProofAttempt(law, Relaxation(law), bounding(), work, _tolerance(program))
    force = np.full(len(law.group), LARGEST_FORCE)
    return attempt, first_enclosure(law, attempt.relaxation.fastest, force, TANGENTS)


def _tolerance(program: Program) -> float:
    """The power that counts as none: that of the data, for the lightest part on its own."""
    mass = program.mass[program.free]
    coarse = min(max(NO_POWER, float(program.tolerance[program.free].max())), COARSEST_NO_POWER)
    return coarse * float(mass.min() / mass.sum())


def _tried(attempt: ProofAttempt, bounds: Enclosure) -> tuple[Kind, CasesLeft]:
    """Modes for a while; then contraction; then modes within its bounds.

    In space only the bounds of forces are contracted: those of motions take longer to
    contract than they save.
    """
    work = attempt.work
    if attempt.law.directions == 2:
        _, _, answer = power_bound(attempt, bounds)
        bounds = shrunk(attempt, bounds, answer, FORCES, work.until(FIRST))
        return "sectors", divided(attempt, bounds)
    modes: Kind = "modes"
    first = divided(attempt, bounds, work.until(FIRST))
    if first.ended or work.over:
        return modes, first
    tight, power = contract(attempt, bounds, work.fraction_left(SECOND))
    if power <= attempt.tolerance:
        return "contraction", replace(first, power=power)
    if work.over:
        return modes, replace(first, power=min(first.power, power))
    last = divided(attempt, tight)
    best = last if last.power <= first.power else first
    return modes, replace(best, nodes=first.nodes + last.nodes)
