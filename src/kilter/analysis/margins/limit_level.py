"""The verdict just beyond a margin, and the margin of a higher verdict level.

A limit of equilibrium is the end of an interval in which forces that hold the assembly exist.
Friction guarantees less, so a higher level may end earlier. `find_level_end` finds the value up to
which the decision of `kilter.check` reaches that level, by bisection. Both ends of the bracket are
decided. The total work of the decisions is bounded.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import nan

import numpy as np

from kilter.analysis.decision.cascade import decide
from kilter.analysis.load_limit import Why
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.tell.levels import holds
from kilter.tell.record import OrNull, Record
from kilter.work import Work

OUTSIDE = 1e-4
"""Turn beyond a tilt limit at which the verdict is decided [rad]; a larger turn may miss a thin
sector of another verdict."""
NEAR = 1e-4
"""Distance below a limit at which its level is decided first, as a share of the limit [-]."""
BELOW = (0.5, 0.9, 0.99, 0.999)
"""Shares of a limit at which its level is decided again; more shares find more failures [-]."""
ROUNDS = 3
"""Largest number of bisections, each below the value at which the level was missed."""
STEPS = 12
"""Bisections of a value; each further one halves the bracket and costs one decision."""
GROWTH = (1.0, 10.0, 100.0)
"""Values that are decided without a limit of equilibrium, as shares of a given size [-]."""
JUDGED_STEPS = 30
"""Iterations that are charged for the equilibrium of a decision."""
DECISION = 50_000.0
"""Units that each decision is charged in addition: the programs and contacts of few parts."""


class LevelLimit(Record):
    """A limit at a level of stability: values on both sides of it, or why they are unknown.

    It is the largest change of an assembly (tilt, load, ...) at which the level is reached. Changes
    start from the assembly as drawn.
    """

    inside: OrNull = nan
    """The farthest value up to which every decided value reaches the level, in the unit of the
    limit."""
    outside: OrNull = nan
    """The nearest value that was decided and does not reach it. It equals `inside` if every
    decided value up to the limit of equilibrium reaches the level, and is infinite if no
    such limit exists either."""
    why: Why | None = None
    """Why the values are unknown."""


@dataclass(frozen=True, slots=True, eq=False)
class LevelDecisions:
    """Decisions, to first order, whether assemblies reach a level; their work is counted."""

    level: str
    """"settles" or "proved"."""
    units: float
    """Work of each decision, as in a check."""
    work: Work
    """Work of all decisions together, and the time limit."""

    def reach(self, assembly: Assembly, contacts: ContactSet) -> bool:
        """Whether an assembly with these contacts reaches the verdict level."""
        before = self.work.total
        decision = decide(
            assembly,
            contacts.of(assembly),
            require=self.level,
            work=self.work.beside(self.units),
            second_order=False,
            question=False,
            level_only=True,
        )
        # the seat, the tries and the proof have budgets of their own: charge their work here
        self.work.charge(DECISION + self.work.total - before)
        # equilibrium is not charged by the decision itself
        self.work.conic(JUDGED_STEPS, 12 * len(decision.program.part_a))
        return holds(decision.level, self.level)

    def share(self, fraction: float) -> LevelDecisions:
        """Copy of these decisions with a fraction of the remaining work."""
        return LevelDecisions(self.level, self.units, self.work.fraction_left(fraction))

    def no_limit(self) -> LevelLimit:
        """The limit of a level that was not decided: the time limit, or no work left."""
        return LevelLimit(why="time" if self.work.late else "effort")


def verdict_outside(
    assembly: Assembly, contacts: ContactSet, angle: float, toward: Array, work: Work
) -> str:
    """The verdict of `kilter.check` just beyond a tilt limit.

    Arguments: `angle`: the limit [rad]; `toward` (3,): horizontal direction of the tilt, unit,
    world frame.
    """
    turned = assembly.with_down(turned_toward(assembly.down, toward, angle + OUTSIDE))
    return decide(
        turned,
        contacts.of(turned),
        require="equilibrium",
        work=work.beside(work.allowed),
        second_order=False,
        question=False,
    ).verdict


def find_level_end(
    decisions: LevelDecisions,
    reaches: Callable[[float], bool],
    end: float,
    *,
    size: float = 1.0,
) -> LevelLimit:
    """Find the value, between 0 and a limit, up to which an assembly reaches a verdict level.

    The assembly reaches the level at 0.

    Examples
    --------
    >>> decisions = LevelDecisions("settles", 0.0, Work())
    >>> limit = find_level_end(decisions, lambda value: value <= 0.7, 1.0)
    >>> 0.699 < limit.inside <= 0.7 < limit.outside < 0.701
    True
    >>> limit = find_level_end(decisions, lambda value: True, 1.0)
    >>> limit.inside, limit.outside
    (1.0, 1.0)
    """
    work = decisions.work
    lower, upper = 0.0, end
    if end == float("inf"):
        for share in GROWTH:
            if work.over:
                break
            if not reaches(share * size):
                upper = share * size
                break
            lower = share * size
        if upper == end:
            return LevelLimit(inside=lower, outside=upper)
    elif end == 0.0 or work.over:
        return LevelLimit(inside=0.0, outside=end)
    elif reaches(end * (1 - NEAR)):
        miss = _first_miss(reaches, end, work)
        if miss is None:
            return LevelLimit(inside=end, outside=end)
        upper = miss
    for _ in range(ROUNDS):  # again below every miss that the samples find
        for _ in range(STEPS):
            if work.over:
                break
            middle = 0.5 * (lower + upper)
            lower, upper = (middle, upper) if reaches(middle) else (lower, middle)
        miss = _first_miss(reaches, lower, work)
        if miss is None:
            break
        lower, upper = 0.0, miss
    return LevelLimit(inside=lower, outside=upper)


def _first_miss(reaches: Callable[[float], bool], end: float, work: Work) -> float | None:
    """Least sampled value below a limit that misses the verdict level; None if all reach it.

    A motion that refutes the level may be found at a smaller value although it was not found at a
    larger value: the search for motions is not exhaustive.
    """
    for share in BELOW:
        if work.over:
            return None
        if not reaches(share * end):
            return share * end
    return None


def turned_toward(start: Array, end: Array, angle: float) -> Array:
    """The unit vector `start` turned toward the unit vector `end` by an angle [rad]."""
    across = end - (end @ start) * start
    size = float(np.linalg.norm(across))
    if size == 0.0:
        return start
    turned: Array = np.cos(angle) * start + np.sin(angle) * across / size
    return turned
