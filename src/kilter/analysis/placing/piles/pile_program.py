"""The program of a place: how much of a box's weight does a pile carry there?

    max s <= 1:   forces at the contacts of the pile and of the box balance all weights,
                  with s times the weight of the box

At s = 0 the forces of the pile alone are a start, so the simplex method continues from its basis.
Below 1 the multipliers are a motion: the box falls there. A pile that falls by itself has the load
factor s for all weights, which is 0 or 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csc_array

from kilter.analysis.placing.piles.pile_statics import PileStatics
from kilter.arrays import Array, Index
from kilter.solvers.highs import KeptProgram, longer_basis
from kilter.solvers.problem import LinearProgram


@dataclass(frozen=True, slots=True, eq=False)
class PlaceAnswer:
    """Forces, or a motion, that a program proposes for a place; the caller checks them."""

    share: float
    """Share of the weight that is carried [-]; nan if the solver failed."""
    forces: Array
    """At the corners of the contacts of the pile [N], shape (4 c,)."""
    pushes: Array
    """At the points under the box [N], shape (q,)."""
    motion: Array
    """Fields of heights of the boxes of the pile, shape (n, 3)."""
    plane: Array
    """Field of heights of the new box, shape (3,)."""


class PlaceProgram:
    """Programs of the places of boxes on one pile."""

    def __init__(self, statics: PileStatics, stands: bool, possible: bool = False) -> None:
        self.statics = statics
        self.stands = stands
        free = statics.weight[1:]
        self.unit = float(np.exp(np.log(free).mean())) if len(free) else 1.0
        self._per_row = np.repeat(self.unit / free, 3)
        rows, columns, values = statics.entries(possible)
        used, position = np.unique(columns, return_inverse=True)
        self._used = used
        self._entries = rows, position.reshape(-1), values * self._per_row[rows]
        self._kept = KeptProgram(goal="point")
        self._basis: Any = None
        self.solves = 0

    def solve(
        self, box: Index, point: Array, center: Array, radius: float, weight: float
    ) -> PlaceAnswer:
        """Solve the program of a box that lies on points of boxes of the pile.

        Arguments: `box` (q,); `point` (q, 2); `center` (2,): centre of the new box [length unit];
        `radius`, `weight`: its bounding radius [length unit] and weight [N].
        """
        basis = None
        if self.stands and len(self.statics.weight) > 1:
            if self._basis is None:
                self._basis = self._run(self._program(*_NOTHING, 1.0, 1.0), None).basis
            if self._basis is not None:
                basis = longer_basis(self._basis, len(box), 0 if len(box) == 0 else 3)
        program = self._program(box, point, center, radius, weight)
        return self._read(self._run(program, basis), box, center, radius, weight)

    def _run(self, program: LinearProgram, basis: Any) -> Any:
        self.solves += 1
        self._kept.load(program, basis)
        return self._kept.solve()

    def _program(
        self, box: Index, point: Array, center: Array, radius: float, weight: float
    ) -> LinearProgram:
        """The linear program; x = (share, forces, pushes)."""
        statics, unit = self.statics, self.unit
        pile_rows, used, q = 3 * (len(statics.boxes) - 1), len(self._used), len(box)
        rows, columns, values = self._entries
        below = np.flatnonzero(box > 0)
        down = -statics.levers(box[below], point[below])
        row = 3 * (box[below] - 1)[:, None] + np.arange(3)
        arm = np.concatenate([np.ones((q, 1)), (point - center) / radius], axis=1)
        parts = [
            (rows, 1 + columns, values),
            (
                row.ravel(),
                np.repeat(1 + used + below, 3),
                down.ravel() * self._per_row[row.ravel()],
            ),
        ]
        new_rows = 3 if q else 0
        if q:
            parts.append(
                (
                    np.tile(pile_rows + np.arange(3), q),
                    np.repeat(1 + used + np.arange(q), 3),
                    arm.ravel() * unit / weight,
                )
            )
            parts.append((np.array([pile_rows]), np.array([0]), np.array([-1.0])))
        right = np.zeros(pile_rows + new_rows)
        if self.stands:
            right[:pile_rows:3] = 1.0
        else:
            force_rows = np.arange(0, pile_rows, 3)
            parts.append((force_rows, 0 * force_rows, np.full(len(force_rows), -1.0)))
        row, column, value = (np.concatenate(pieces) for pieces in zip(*parts, strict=True))
        shape = (len(right), 1 + used + q)
        matrix = csc_array((value, (row, column)), shape=shape)
        cost = np.zeros(shape[1])
        cost[0] = -1.0
        upper = np.full(shape[1], np.inf)
        upper[0] = 1.0
        return LinearProgram(cost, matrix, right, right, np.zeros(shape[1]), upper)

    def _read(
        self, solution: Any, box: Index, center: Array, radius: float, weight: float
    ) -> PlaceAnswer:
        """Forces in N and fields of heights from the solution of a program."""
        statics, used = self.statics, len(self._used)
        count = len(statics.boxes)
        forces = np.zeros(statics.columns)
        motion, plane = np.zeros((count, 3)), np.zeros(3)
        pushes = np.zeros(len(box))
        share = float("nan")
        if solution.optimal:
            share = float(solution.x[0])
            x = np.maximum(solution.x, 0.0) * self.unit
            forces[self._used] = x[1 : 1 + used]
            pushes = x[1 + used :]
        if len(solution.multipliers) == 3 * (count - 1) + (3 if len(box) else 0):
            y = -solution.multipliers.reshape(-1, 3)
            scale = np.append(self.unit / statics.weight[1:], [self.unit / weight][: len(box)])
            y = y * scale[: len(y), None]
            middle = np.concatenate([statics.center[1:, :2], center[None]])[: len(y)]
            reach = np.append(statics.radius[1:], radius)[: len(y), None]
            fields = _fields(y, middle, reach)
            motion[1:] = fields[: count - 1]
            if len(box):
                plane = fields[-1]
        return PlaceAnswer(share, forces, pushes, motion, plane)


_NOTHING = (np.empty(0, np.int64), np.empty((0, 2)), np.zeros(2))


def _fields(y: Array, center: Array, radius: Array) -> Array:
    """Fields of heights from the speed of each centre and turns x radius, shape (k, 3)."""
    slope = y[:, 1:] / radius
    return np.concatenate([(y[:, 0] - (slope * center).sum(axis=1))[:, None], slope], axis=1)
