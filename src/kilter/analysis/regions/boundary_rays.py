"""Boundary points of the cone of held directions along arcs from a direction inside, with facets.

From a direction p inside the cone C towards a direction q outside of it,

    max t:  g = p + t (q - p),   A f + B g = 0,  f in K

gives both sides by a single conic program: forces that hold g, and a motion whose facet touches C
near g. The programs differ only in q, so they are solved side by side
(`kilter.solvers.many_shares`). They are programs of the smaller assembly in which locked parts
are bodies (`kilter.mechanics.locked_parts`): without a squeeze, forces and motions are bounded.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.load_limit import gravity_wrench
from kilter.analysis.turning_tolerances import SHARE_AGREES, WIDEST_ARC
from kilter.arrays import Array, unit_rows
from kilter.mechanics.balance_in_cones import ConeBalance, balance_in_cones
from kilter.mechanics.locked_parts import LockedParts
from kilter.mechanics.opening import Opening
from kilter.solvers.many_shares import SharePoint, first_point, many_shares

__all__ = ["BoundaryRay", "BoundaryRays"]

ENTRIES = 60_000
"""Entries of the columns of all programs that are solved side by side; more are solved in turn."""
LEAST = 4
"""Least number of programs that are solved side by side."""


@dataclass(frozen=True, slots=True, eq=False)
class BoundaryRay:
    """A direction near the boundary of the cone of held directions, with candidates for proofs."""

    down: Array
    """Unit, shape (3,)."""
    forces: tuple[Array, Array]
    """Forces along and across the rows that hold it [N]."""
    motion: Array
    """Motion that starts beyond it, shape (N, 6)."""


class BoundaryRays:
    """Search for boundary directions of the cone of held directions of a program."""

    def __init__(self, locked: LockedParts, opening: Opening) -> None:
        self._locked, self._opening = locked, opening
        self._middles: list[tuple[Array, SharePoint]] = []
        program = locked.program
        none = np.zeros((len(program.names), 6))
        self._balance: ConeBalance = balance_in_cones(program, none, none, 1.0)
        wrenches = [gravity_wrench(program, axis) for axis in np.eye(3)]
        self._loads = np.array(
            [self._balance.with_more(wrench, 1.0).cones.along for wrench in wrenches]
        )

    @property
    def together(self) -> int:
        """Number of programs that are solved side by side."""
        return max(ENTRIES // int(self._balance.cones.columns[0].size), LEAST)

    def towards(self, start: Array, targets: Array) -> list[BoundaryRay | None]:
        """Boundary direction on the arc from a start inside the cone to each target outside.

        Arguments: `start` (3,); `targets` (D, 3): unit, not opposite to the start. Returns None if
        the search fails on an arc.
        """
        ways = _ways(start, targets)
        right = np.tensordot(start, self._loads, axes=1)
        along = np.tensordot(ways, self._loads, axes=1)
        starts = [self._start(target) for target in targets]
        shares = many_shares(self._balance.cones, right, along, starts, agree=SHARE_AGREES)
        found: list[BoundaryRay | None] = []
        for way, share in zip(ways, shares, strict=True):
            if share is None:
                found.append(None)
                continue
            reached = start + share.share * way
            size = float(np.linalg.norm(reached))
            down = reached / size
            self._middles.append((down, share.middle))
            forces = self._locked.forces(down, *self._balance.decoded(share.x / size))
            motion = self._locked.motion(self._balance.motion(-share.y))
            found.append(BoundaryRay(down, forces, motion))
        return found

    def _start(self, target: Array) -> SharePoint:
        """First point of the search towards a target, from the nearest known boundary direction."""
        if self._middles:
            return max(self._middles, key=lambda known: float(known[0] @ target))[1]
        m0 = self._opening.m0
        opening = None if m0 is None else -self._balance.multipliers(m0)
        return first_point(self._balance.cones, opening)


def _ways(start: Array, targets: Array) -> Array:
    """Vectors from a start towards targets, shortened to arcs of at most `WIDEST_ARC`."""
    aside = unit_rows(targets - np.outer(targets @ start, start))
    wide = np.cos(WIDEST_ARC) * start + np.sin(WIDEST_ARC) * aside
    far = targets @ start < np.cos(WIDEST_ARC)
    result: Array = np.where(far[:, None], wide, targets) - start
    return result
