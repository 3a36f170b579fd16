"""Point of a cone that is farthest in a given direction, by a linear program.

The oracle keeps the linear program and changes only its cost.

    max c.g :  A f + B g = 0,  f >= 0 on one-sided columns,  g cut off at a length of about 1

If it is 0, the multipliers z of the rows are the witness: A^T z >= 0 with B^T z = c.

Rounded data. A price on imbalance, A f + B g = s with cost P |s|, limits the witnesses: those
larger than P do not count. And two plates that are parallel but for rounding would jam a part
between them with forces of the inverse of that rounding: forces over 1e6 weights, or over a
tenth of the inverse of the tolerance, are computed again with a small price on force. Then
witnesses with A^T z as little below 0 as that price count.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import csc_array, diags_array, eye_array, hstack, vstack

from kilter.analysis.analysis_tolerances import (
    BLUR_OVER_TOLERANCE,
    NO_DIRECTION,
)
from kilter.analysis.regions.growth import Reach, grow
from kilter.analysis.regions.polyhedral_cone import Cone, make_cone
from kilter.arrays import Array, Mask
from kilter.mechanics.mechanics_tolerances import RULED_OUT, TOLERANCE
from kilter.solvers.problem import LinearProgram

if TYPE_CHECKING:
    from kilter.solvers.problem import Solution


FORCE_PRICES = (0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0)
"""Prices of a force of one weight if forces jam, over the tolerance; the search takes the
lowest price that ends the jam [-]."""
FAR = 10.0
"""Bound of each coordinate of a point of the cone that is truncated across an axis [-]."""


class ConeOracle:
    """Farthest points of the cone {g : A f + B g = 0 for some f >= 0}, from one linear program.

    The program is kept between queries.

    Arguments: `matrix` (m, n); `loads` (m, d); `two_sided` (n,); `price`: None: no imbalance;
    `tolerance` [-]; `spread` [-].

    Examples
    --------
    >>> from scipy.sparse import csc_array, eye_array
    >>> quadrant = ConeOracle(-eye_array(2).tocsc(), eye_array(2).tocsc(), np.zeros(2, bool), None)
    >>> quadrant.support(np.array([-0.8, -0.6])).angle
    0.0
    >>> quadrant.support(np.array([1.0, 0.0])).point
    array([ 1., -0.])
    """

    def __init__(
        self,
        matrix: csc_array,
        loads: csc_array,
        two_sided: Mask,
        price: float | None,
        tolerance: float = TOLERANCE,
        spread: float = 1.0,
    ) -> None:
        from kilter.solvers.highs import KeptProgram

        self.dimension = loads.shape[1]
        self._rows, self._forces = matrix.shape
        size = np.zeros(self._forces)
        for column in range(self._forces):
            entries = matrix.data[matrix.indptr[column] : matrix.indptr[column + 1]]
            size[column] = np.abs(entries).max(initial=0.0)
        # forces over the weight of the lighter part they act on
        self._size = np.where(size > 0, size, 1.0)
        self._pushes = np.flatnonzero(~two_sided)
        self._tolerance = tolerance
        # exact data jam by rounding alone, far beyond what any part may have to carry
        self._jam = 0.1 / tolerance if tolerance > TOLERANCE else RULED_OUT * spread
        self._columns = np.arange(self._forces, self._forces + self.dimension)
        self._kept = KeptProgram(self._program(matrix, loads, two_sided, price))

    def _program(
        self,
        matrix: csc_array,
        loads: csc_array,
        two_sided: Mask,
        price: float | None,
    ) -> LinearProgram:
        """The linear program of the oracle: unknowns f, g and imbalance; rows of equilibrium.

        A last row bounds g.
        """
        rows, count, d = self._rows, self._forces, self.dimension
        slack = 0 if price is None else rows
        blocks = [matrix @ diags_array(1 / self._size), loads]
        if slack:
            blocks += [eye_array(rows), -eye_array(rows)]
        # entries that are to change are stored as ones: the row is slack until `focus`
        last = [csc_array((1, count)), csc_array(np.ones((1, d))), csc_array((1, 2 * slack))]
        body = vstack([hstack(blocks), hstack(last[: 2 + bool(slack)])], format="csc")
        ones, none = np.ones(d), np.zeros(2 * slack)
        return LinearProgram(
            cost=np.concatenate([np.zeros(count + d), none + (price or 0.0)]),
            matrix=body,
            row_lower=np.append(np.zeros(rows), -np.inf),
            row_upper=np.append(np.zeros(rows), float(d)),
            lower=np.concatenate([np.where(two_sided, -np.inf, 0.0), -ones, none]),
            upper=np.concatenate([np.full(count, np.inf), ones, none + np.inf]),
        )

    @property
    def programs(self) -> int:
        """Number of linear programs that the oracle solved."""
        return self._kept.solves

    def support(self, direction: Array) -> Reach:
        """Farthest direction of the cone along a unit direction, and the cosine between them."""
        self._kept.change_cost(self._columns, -direction)
        solution = self._optimum()
        for share in FORCE_PRICES:
            if not self._jams(solution):
                break
            price = np.full(len(self._pushes), share * self._tolerance)
            self._kept.change_cost(self._pushes, price)
            solution = self._optimum()
            self._kept.change_cost(self._pushes, np.zeros(len(self._pushes)))
        return self._reach(direction, solution)

    def _optimum(self) -> Solution:
        """Optimum of the linear program; if it fails, a feasible point, which is judged later."""
        solution = self._kept.solve()
        return (
            solution
            if solution.found and len(solution.multipliers)
            else solution.required("the region")
        )

    def _jams(self, solution: Solution) -> bool:
        """Whether forces of a solution are so large that only rounding of the data allows them."""
        size = float(np.linalg.norm(solution.x[self._columns]))
        largest = float(np.abs(solution.x[: self._forces]).max(initial=0.0))
        return largest > size * self._jam

    def _reach(self, direction: Array, solution: Solution) -> Reach:
        g = solution.x[self._columns]
        length = float(np.linalg.norm(g))
        witness = -solution.multipliers[: self._rows]
        if length < NO_DIRECTION:
            return Reach(0.0, np.zeros(len(g)), np.zeros(self._forces), witness)
        forces = solution.x[: self._forces] / self._size / length
        return Reach(max(float(direction @ g) / length, 0.0), g / length, forces, witness)

    def focus(self, axis: Array) -> None:
        """Truncate the cone by a plane across the given axis, at distance 1."""
        self._kept.change_row(self._rows, self._columns, axis * self.dimension)
        far = np.full(self.dimension, FAR)
        self._kept.change_bounds(self._columns, -far, far)

    def forces(self, direction: Array) -> Array:
        """Forces that balance a given direction of gravity as well as they can, shape (n,)."""
        self._kept.change_cost(self._columns, np.zeros(self.dimension))
        self._kept.change_bounds(self._columns, direction, direction)
        solution = self._optimum()
        far = np.full(self.dimension, FAR)
        self._kept.change_bounds(self._columns, -far, far)
        forces: Array = solution.x[: self._forces] / self._size
        return forces


def intersection(cones: Sequence[Cone], first: Array) -> tuple[Cone, int]:
    """Intersection of several cones, and the number of linear programs that were solved.

    Found as a stable cone is, with distances to facets in place of forces,

        e.g = 0,   q.g - f = 0,   f >= 0

    so that knife edges that agree up to rounding remain knife edges.

    Arguments: `first` (3,): a direction to ask first.
    """
    blur = max(cone.blur for cone in cones)
    equations = np.vstack([cone.equations for cone in cones])
    facets = np.vstack([cone.facets for cone in cones])
    if not len(equations) + len(facets):
        return make_cone(equations, facets, np.empty((0, 3)), blur), 0
    count = len(facets)
    distances = csc_array(np.vstack([np.zeros((len(equations), count)), -np.eye(count)]))
    loads = vstack([csc_array(equations), csc_array(facets)], format="csc")
    coarse = blur > BLUR_OVER_TOLERANCE * TOLERANCE
    oracle = ConeOracle(
        distances, loads, np.zeros(count, dtype=bool), 0.1 / blur if coarse else None
    )
    grown = grow(oracle, first, blur, lambda: None)
    cone = make_cone(
        np.array([e for e, _, _ in grown.equations]),
        np.array([q for q, _ in grown.facets]),
        np.array([reach.point for reach in grown.points]),
        blur,
    )
    return cone, oracle.programs
