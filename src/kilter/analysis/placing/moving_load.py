"""Places of a prism on several tops, with contacts that move with it: one program for a rectangle.

Without friction, the contact forces on the top i have a resultant n_i at a point p_i of the contact

    K_i(x) = T_i with  A (p - x) <= b  for the edges of the footprint.

With the moments m_i = n_i p_i, balance is linear in n, m and x, and only the edges of the footprint
are not,  A (m_i - n_i x) <= n_i b.  About shares s_i of the weight W and the middle x_0 of a
rectangle with |A (x - x_0)| <= r, the product n_i A x is linear up to a remainder of second order:

    n_i A x = n_i A x_0 + s_i W A (x - x_0) + (n_i - s_i W) A (x - x_0),
    A (m_i - n_i x_0) - s_i W A (x - x_0) + r |n_i - s_i W| <= n_i b.

Forces that keep this condition hold the part at their place, and by its convexity also at all
places between. Only resultants count, so the program has forces at the corners of the area that
the part may touch. The shares are those with the most room at the middle.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.sparse import coo_array, csc_array

from kilter.analysis.placing.polygon_sets import both, moved
from kilter.analysis.placing.shifted_load import CarriedPlaces, CarriedPoint, ShiftedLoad
from kilter.analysis.placing.upright_prisms import PlacedLoads, PlacedPrism, Top, places_left
from kilter.arrays import Array, Index
from kilter.mechanics.certificate import ForceProof
from kilter.solvers.problem import LinearProgram

if TYPE_CHECKING:
    from kilter.solvers.highs import KeptProgram


ROUNDING = 1e-9
"""Moment by which resultants may lie beyond the contact [weight x size of the part]; as large as
the imbalance that a proof by forces may have."""
MOST_ROOM = 1.0
"""Limit of the room at the middle of a rectangle [sizes of the part], so that it is bounded."""


@dataclass(frozen=True, eq=False)
class ContactRoom:
    """The condition that resultants of forces lie in the contact, at all places of a rectangle.

    Arguments: `areas`; `low`, `high` (2,) [length unit].
    """

    part: PlacedPrism
    areas: dict[int, shapely.Geometry]
    low: Array
    high: Array

    @cached_property
    def top_of(self) -> Index:
        """Number of the area of each force, shape (n,)."""
        count = [len(shapely.get_coordinates(area)) - 1 for area in self.areas.values()]
        return np.repeat(np.arange(len(count)), count)

    @cached_property
    def room(self) -> Array:
        """Distance of forces from edges of the footprint at the middle, (n, edges) [sizes]."""
        normals, offsets = self.part.edges
        corners = [shapely.get_coordinates(area)[:-1] for area in self.areas.values()]
        places = np.concatenate(corners) - (self.low + self.high) / 2
        room: Array = (offsets - places @ normals.T) / self.part.size
        return room

    @cached_property
    def reach(self) -> Array:
        """Largest motion of each edge from the middle, across itself, shape (edges,) [sizes]."""
        reach: Array = np.abs(self.part.edges[0]) @ (self.high - self.low) / 2 / self.part.size
        return reach

    @cached_property
    def pairs(self) -> tuple[Index, Index]:
        """Area and edge of each condition: edges that cut the area at some place."""
        least = np.full((len(self.areas), len(self.reach)), np.inf)
        np.minimum.at(least, self.top_of, self.room)
        area, edge = np.nonzero(least < self.reach)
        return area.astype(np.int64), edge.astype(np.int64)

    @cached_property
    def conditions(self) -> tuple[Array, Array, Array]:
        """Coefficients of the conditions: of forces, of shifts for each share, and of |n - s W|.

        Shapes (conditions, n), (conditions, 2) and (conditions,).
        """
        area, edge = self.pairs
        forces = np.where(self.top_of[None] == area[:, None], self.room[:, edge].T, 0.0)
        return forces, self.part.edges[0][edge] / self.part.size, self.reach[edge]

    def sums(self, forces: Array) -> Array:
        """Sum of forces on each area, shape (areas,)."""
        sums: Array = np.bincount(self.top_of, forces, len(self.areas)).astype(float)
        return sums

    def holds(self, shares: Array, weight: float, shift: Array, forces: Array) -> bool:
        """Whether forces at a shift from the middle keep the conditions about given shares.

        Arguments: `shares` (areas,): shares of the weight on each area [-]; `weight`: weight of the
        part [N]; `shift` (2,) [length unit]; `forces` (n,) [N].
        """
        area, _ = self.pairs
        along, slope, reach = self.conditions
        apart = np.abs(self.sums(forces) - shares * weight)
        room = along @ forces + (shares * weight)[area] * (slope @ shift) - reach * apart[area]
        return bool((room >= -ROUNDING * weight).all())


@dataclass(frozen=True, slots=True, eq=False)
class Footing:
    """Tops that a part may touch at one height, if its centre is in a rectangle."""

    tops: Sequence[Top]
    areas: dict[int, shapely.Geometry]
    """Area that it may touch on each top, by the number of the part with this top."""
    height: float
    low: Array
    high: Array
    """The rectangle of centres [length unit], shape (2,)."""

    @property
    def middle(self) -> Array:
        """Middle of the rectangle [length unit], shape (2,)."""
        middle: Array = (self.low + self.high) / 2
        return middle

    def renumbered(self, numbers: Mapping[int, int]) -> Footing:
        """The same with other numbers of the parts."""
        tops = [replace(top, part=numbers[top.part]) for top in self.tops]
        areas = {numbers[part]: area for part, area in self.areas.items()}
        return replace(self, tops=tops, areas=areas)


@dataclass(eq=False)
class MovingLoad(ShiftedLoad):
    """A part without friction on several tops, whose place varies in a rectangle (`moving_load`).

    Shifts are those from the middle of the rectangle. `program` has contacts at the corners of the
    areas that the part may touch.
    """

    loads: PlacedLoads = field(kw_only=True)
    footing: Footing = field(kw_only=True)
    contact: ContactRoom = field(kw_only=True)
    shares: Array = field(kw_only=True, default_factory=lambda: np.empty(0))

    @classmethod
    def of_areas(cls, loads: PlacedLoads, footing: Footing) -> MovingLoad:
        """The load in a rectangle of centres, on areas that the part may touch."""
        half = (footing.high - footing.low) / 2
        program, wrenches = loads.on_areas(footing.areas, footing.height, footing.middle)
        return cls(
            program,
            wrenches,
            -half,
            half,
            known=loads.alone,
            loads=loads,
            footing=footing,
            contact=ContactRoom(loads.part, footing.areas, footing.low, footing.high),
        )

    def places_of(self, accuracy: float, within: shapely.Geometry) -> CarriedPlaces:
        """Places that stand and places that are not excluded, of an area in the rectangle.

        Both in the coordinates of the map. The middle decides first, and gives the shares.
        """
        middle = self.footing.middle
        area = moved(within, -middle)
        shares, motion = self._at_middle()
        motion = None if self.proofs == "forces" else motion
        motions = [] if motion is None else [motion]
        left = area if motion is None else self._left(area, motion, area)
        if shares is None or left.is_empty:
            found = CarriedPlaces(shapely.Polygon(), left, 1, (), tuple(motions))
        else:
            self.shares = shares
            found = self.places(accuracy, within=left)
            found = replace(found, programs=found.programs + 1, motions=(*motions, *found.motions))
        return found.shifted(middle)

    @property
    def _weight(self) -> float:
        """Weight of the part, in the unit of the program [-]."""
        return self.loads.part.mass * self.program.g / self._problem.unit

    def _at_middle(self) -> tuple[Array | None, Array | None]:
        """Shares of the weight with the most room in the contact, and a motion that excludes it.

        The room may be negative. No shares if no forces at all balance the load; no motion if the
        part stands at the middle.
        """
        from kilter.solvers.highs import KeptProgram

        along, _, _ = self.contact.conditions
        count, known = len(self.program.part_a), len(self.loads.program.part_a)
        slack = np.full((len(along), 1), -self._weight)
        program = self._extended(np.hstack([along, slack]), np.empty((0, 1)), known)
        lower = np.append(program.lower[:count], -np.inf if len(along) else 0.0)
        upper = np.append(program.upper[:count], MOST_ROOM)
        cost = np.append(np.zeros(count), -1.0)
        answer = KeptProgram(
            replace(program, cost=cost, lower=lower, upper=upper), goal="proof"
        ).solve()
        columns = -answer.multipliers[: len(self._problem.right)]
        motion = self._motion(columns, infeasible=not answer.optimal)
        if not answer.optimal:
            return None, motion
        shares = self.contact.sums(answer.x[known:count]) / self._weight
        return shares, motion if answer.x[count] < 0 else None

    @cached_property
    def _kept(self) -> KeptProgram:
        """The linear program for forces f, shift d, and distance t from the shares."""
        from kilter.solvers.highs import KeptProgram

        along, slope, reach = self.contact.conditions
        area, _ = self.contact.pairs
        count, known = len(self.program.part_a), len(self.loads.program.part_a)
        areas = len(self.contact.areas)
        goal = self.shares * self._weight
        to_area = np.arange(areas)[:, None]
        apart = np.where(area[:, None] == to_area.T, -reach[:, None], 0.0)
        rows = np.hstack([along, goal[area, None] * slope, apart])
        total = (self.contact.top_of[None] == to_area).astype(float)
        none, eye = np.zeros((areas, 2)), np.eye(areas)
        rows = np.vstack([rows, np.hstack([-total, none, eye]), np.hstack([total, none, eye])])
        balance = np.array([-self._problem.scaled_load(wrench) for wrench in self.wrenches]).T
        program = self._extended(rows, balance, known)
        right = np.concatenate([np.zeros(len(along)), -goal, goal])
        program = replace(
            program,
            row_lower=np.append(self._problem.right, right),
            lower=np.concatenate([program.lower[:count], self.low, np.zeros(areas)]),
            upper=np.concatenate([program.upper[:count], self.high, np.full(areas, np.inf)]),
        )
        return KeptProgram(program, goal="proof")

    def _extended(self, rows: Array, balance: Array, known: int) -> LinearProgram:
        """The balance with further rows >= 0, which begin at the column `known`.

        `balance` are the entries of the columns after the forces in the rows of the balance.
        """
        matrix = self._problem.matrix.tocoo()
        equal, count = self._problem.matrix.shape
        total = known + rows.shape[1]
        below, after = np.nonzero(rows), np.nonzero(balance)
        entries = coo_array(
            (
                np.concatenate([matrix.data, rows[below], balance[after]]),
                (
                    np.concatenate([matrix.row, below[0] + equal, after[0]]),
                    np.concatenate([matrix.col, below[1] + known, after[1] + count]),
                ),
            ),
            shape=(equal + len(rows), total),
        )
        right = self._problem.right
        lower = np.where(self.program.two_sided, -np.inf, 0.0)
        return LinearProgram(
            np.zeros(total),
            csc_array(entries),
            np.append(right, np.zeros(len(rows))),
            np.append(right, np.full(len(rows), np.inf)),
            lower,
            np.full(count, np.inf),
        )

    def _left(
        self, outer: shapely.Geometry, motion: Array, whole: shapely.Geometry
    ) -> shapely.Geometry:
        """The places of an area, as shifts, that a motion does not exclude."""
        on = self.footing
        left = places_left(self.loads, on.tops, on.height, on.low, on.high, motion)
        return both(outer, moved(left, -on.middle))

    def _proved(self, points: list[CarriedPoint]) -> tuple[tuple[Array, ForceProof], ...]:
        """Points that hold, of which all places between stand."""
        known = len(self.loads.program.part_a)
        weight = self.loads.part.mass * self.program.g
        return tuple(
            (shift, proof)
            for shift, proof in super()._proved(points)
            if self.contact.holds(self.shares, weight, shift, proof.forces[known:])
        )
