"""The largest further load straight down on a part that contact forces can balance.

    max t:  J^T f + w + t d = 0,  f in the cones          d: along gravity at a centre of mass

There is a limit for each part, by itself: the forces there hold it, and the motion beyond shows
that no forces do. The first unit is the weight or the strength of bonds, then the load found, so
that its two sides are near as seen from the load.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.load_limit import Limit, NoLimit, find_limit
from kilter.analysis.turning_tolerances import SIDES_NEAR
from kilter.mechanics.coulomb_cones import cone_problem
from kilter.mechanics.opening import Opening
from kilter.mechanics.program import Program
from kilter.tell.record import InPython, OrNull, Record, key

__all__ = ["PartLoad", "find_part_load"]


class PartLoad(Record):
    """Additional load straight down, at its centre of mass, that a part carries."""

    part: str
    """Name of the part."""
    load: OrNull
    """Load that is proved to be held [N]; infinite without a limit."""
    mass: OrNull
    """Mass with this weight [kg]."""
    beyond: OrNull
    """Load that is proved not to be held [N]; infinite if that proof is missing."""
    limit: InPython[Limit]
    """Forces and mechanism at the limit, in units of `unit`."""
    unit: InPython[float]
    """Unit of the multiples [N]."""

    @property
    @key
    def residual(self) -> float:
        """Largest imbalance of a part at the limit, divided by its weight [-]."""
        return self.limit.residual

    @property
    @key
    def moves(self) -> list[str]:
        """Parts that move beyond the limit."""
        return self.limit.moves

    def __repr__(self) -> str:
        return f"PartLoad({self.part!r}, {self.load:.6g} N)"


def find_part_load(
    program: Program, part: int, *, opening: Opening | None = None
) -> PartLoad | NoLimit:
    """The largest load straight down on a part; no limit if the weight alone is not balanced.

    Examples
    --------
    A cube that hangs under another cube by a bond takes the strength of the bond, less its weight.

    >>> from kilter import Assembly, Bond, Box, Part, Pose
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> top = Part("top", Box([1, 1, 1]), Pose([0, 0, 1]), grounded=True)
    >>> bond = Bond(("low", "top"), pull=9810)
    >>> hung = Assembly([top, Part("low", Box([1, 1, 1]))], bonds=[bond])
    >>> round(find_part_load(build_program(hung, contacts(hung)), 1).load, 3)
    29430.0
    """
    opening = opening or Opening(cone_problem(program))
    unit = float(program.weight[program.free].sum() + program.pull.sum())
    limit = _largest_load(program, part, unit, opening)
    if isinstance(limit, NoLimit) or not 0 < limit.load < np.inf:
        return limit
    if limit.beyond - limit.load <= SIDES_NEAR * limit.load:
        return limit
    nearer = _largest_load(program, part, limit.load, opening)
    better = isinstance(nearer, PartLoad) and nearer.beyond < limit.beyond
    return nearer if better else limit


def _largest_load(program: Program, part: int, unit: float, opening: Opening) -> PartLoad | NoLimit:
    """The largest load straight down on a part, computed in multiples of `unit`."""
    wrench = np.zeros((len(program.names), 6))
    wrench[part, :3] = unit * program.down
    limit = find_limit(program, wrench, opening=opening)
    if isinstance(limit, NoLimit) or limit.value < 0:
        return limit if isinstance(limit, NoLimit) else NoLimit("none")
    beyond = limit.value + limit.gap * max(limit.value, 1.0)
    load = limit.value * unit
    return PartLoad(
        part=program.names[part],
        load=load,
        mass=load / program.g,
        beyond=max(beyond * unit, load),
        limit=limit,
        unit=unit,
    )
