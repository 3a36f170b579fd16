"""The guarantee: no motion that obeys Coulomb's contact law can start.

    a = M^-1 (w + J^T f),  un >= 0,  f in Coulomb's cone,  fn un = 0,  ft.ut = -mu fn |ut|

has a = 0 alone as its accelerations, whatever the contact forces: then friction of this size
holds the assembly, and no squeeze beforehand can change that. Proved by linear programs that
contain all solutions (`kilter.friction.relaxation`), with bounds that do not trust the
solver. What is not proved is open: that is no refutation.

A power counts as none if it is below 1e-8 (coarser for coarse data) of that of the lightest
part in free fall, so that no small part vanishes beside large ones.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from kilter.arrays import Array
from kilter.friction.contact_law import contact_law, refusal
from kilter.friction.contraction import (
    FORCES,
    Clock,
    Search,
    contract,
    forces_bounded,
    power_bound,
    shrunk,
)
from kilter.friction.enclosure import Enclosure, first_enclosure
from kilter.friction.relaxation import POOL, Relaxation
from kilter.friction.sectors import Branched, branch
from kilter.mechanics.program import Program

__all__ = ["Guarantee", "prove_no_motion"]

Kind = Literal["contraction", "modes", "sectors"]

FORCE = 1000.0
"""Largest force of a contact point that is thought of, over the weight of the free parts."""
NOTHING = 1e-8
"""Power that counts as none, over |w|^2 of the lightest part: above what rounding leaves of the
bound of a case with nothing left to divide (1.2e-9 of it at 18 parts), and a thousandth of the
least that a witness must have (`kilter.mechanics.law_check.POWER`)."""
COARSEST = 1e-6
"""Power that is never taken for none, over that of the part in free fall."""
FIRST = 0.1
"""Part of the budget for branching before anything is contracted; in space, for the forces."""
SECOND = 0.4
"""Part of what is left then for contraction."""


@dataclass(frozen=True, slots=True, eq=False)
class Guarantee:
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
    open_motion : ndarray or None, shape (N, 6)
        Accelerations of the relaxed motion with the largest power, over the size of the load
        in the metric of the masses: a hint where to look for a motion, no more.
    seconds : float
    why : str
        Why nothing could be asked, or "".
    """

    proved: bool
    kind: Kind | None
    programs: int
    nodes: int
    bound: float
    assumes: str
    open_motion: Array | None
    seconds: float
    why: str = ""


def prove_no_motion(
    program: Program, *, budget: float = 10.0, tell: Callable[[str], None] | None = None
) -> Guarantee:
    """Try to prove that no motion obeying Coulomb's contact law can start.

    Parameters
    ----------
    program : Program
        With modelled contacts only: possible rows are refused.
    budget : float
        Seconds.
    tell : callable, optional
        Called with a word of progress about once a second.

    Examples
    --------
    >>> from kilter.contact import find_contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes.stacks import block_on_slope
    >>> for friction in (0.5, 0.3):
    ...     slope = block_on_slope(20.0, friction=friction)
    ...     prove_no_motion(build_program(slope, find_contacts(slope))).proved
    True
    False
    """
    clock = Clock(budget, tell)
    if not program.free.any() or not program.load[program.free].any():
        return Guarantee(True, "contraction", 0, 0, 0.0, "", None, clock.spent)
    why = refusal(program)
    if why:
        return Guarantee(False, None, 0, 0, 1.0, "", None, clock.spent, why)
    tolerance = _tolerance(program)
    search = make_search(program, clock, tolerance)
    bounds = first_enclosure(search.law, search.relaxation.reach, FORCE, POOL)
    bounded = forces_bounded(search, bounds)
    kind, out = _tried(search, replace(bounds, cuts=True))
    proved = out.power <= tolerance
    motion = None
    if out.motion is not None:
        motion = program.full(np.asarray(search.law.back @ out.motion).ravel())
    assumes = "" if bounded or not proved else f"contact forces up to {FORCE:g} times the weight"
    return Guarantee(
        proved, kind if proved else None, search.solver.programs, out.nodes, out.power, assumes,
        motion, clock.spent,
    )  # fmt: skip


def _tolerance(program: Program) -> float:
    """The power that counts as none: that of the data, for the lightest part on its own."""
    mass = program.mass[program.free]
    coarse = min(max(NOTHING, float(program.tolerance[program.free].max())), COARSEST)
    return coarse * float(mass.min() / mass.sum())


def make_search(program: Program, clock: Clock, tolerance: float) -> Search:
    """Law, relaxation and solver of a program."""
    from kilter.solvers.bounded import BoundedSolver

    law = contact_law(program)
    return Search(law, Relaxation(law), BoundedSolver(), clock, tolerance)


def _tried(search: Search, bounds: Enclosure) -> tuple[Kind, Branched]:
    """Branching for a while; then contraction; then branching within its bounds.

    In space contraction takes longer than it saves, but for that of the forces.
    """
    clock = search.clock
    if search.law.directions == 2:
        _, _, answer = power_bound(search, bounds)
        bounds = shrunk(search, bounds, answer, FORCES, FIRST * clock.budget)
        return "sectors", branch(search, bounds)
    modes: Kind = "modes"
    first = branch(search, bounds, FIRST * clock.budget)
    if first.ended or clock.over:
        return modes, first
    tight, power = contract(search, bounds, clock.spent + SECOND * clock.left)
    if power <= search.tolerance:
        return "contraction", replace(first, power=power, motion=None)
    if clock.over:
        return modes, replace(first, power=min(first.power, power))
    last = branch(search, tight)
    nodes = first.nodes + last.nodes
    best = last if last.power <= first.power else first
    return modes, replace(best, nodes=nodes)
