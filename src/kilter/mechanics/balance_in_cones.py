"""Balance in exact cones, for kilter's own interior point: a program as `LinkedCones`.

    max t:  A f = b + t d,   0 <= t <= T,   f in K

Parts are blocks, and all rows between two parts are one link. The unknowns of a row with
friction are (f_n, f_u / mu, f_v / mu) times the root of 1 + mu^2, in the cone x_0 >= |x_1..|;
a row without is a half line, one that may also pull a whole line. Equations are scaled as those
of `kilter.mechanics.forms`: forces and torques / radius over the weight of each part, whose
columns are built here straight from the rows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Index, across, cross
from kilter.mechanics.program import Program
from kilter.solvers.linked_cones import LinkedCones

__all__ = ["ConeBalance", "balance_in_cones", "load_share"]


@dataclass(frozen=True, slots=True, eq=False)
class ConeBalance:
    """A program with the columns of its cones.

    Attributes
    ----------
    program : Program
    cones : LinkedCones
    rows : ndarray of int, shape (K,)
        Row of the program of each cone.
    directions : ndarray, shape (d, K, 3)
        Force of a unit of each unknown, in `unit` [-].
    unit : float
        [N]
    """

    program: Program
    cones: LinkedCones
    rows: Index
    directions: Array
    unit: float

    def with_more(self, more: Array, most: float) -> ConeBalance:
        """The same with other further wrenches, shape (N, 6), and their largest share."""
        free = np.flatnonzero(self.program.free)
        along = -_over_weight(self.program, free, more)
        return replace(self, cones=self.cones.with_more(along, most))

    def decoded(self, x: Array) -> tuple[Array, Array]:
        """Forces along the rows, shape (K,), and across them, (K, 3) [N], of unknowns (d, K)."""
        count = len(self.program.part_a)
        along, aside = np.zeros(count), np.zeros((count, 3))
        normal = self.program.normal[self.rows]
        size = np.einsum("ki,ki->k", self.directions[0], normal)
        along[self.rows] = x[0] * size * self.unit * self.program.arm[self.rows]
        aside[self.rows] = np.einsum("dk,dki->ki", x[1:], self.directions[1:]) * self.unit
        return along, aside

    def motion(self, y: Array) -> Array:
        """The motion of all parts, shape (N, 6), of multipliers of the blocks, shape (N', n)."""
        program = self.program
        full = np.zeros((len(program.names), 6))
        free = np.flatnonzero(program.free)
        full[np.ix_(free, program.freedoms)] = y / program.weight[free][:, None]
        full[:, 3:] /= program.radius[:, None]
        return full


def load_share(program: Program) -> ConeBalance:
    """The largest share of the load that forces hold, 0 to 1."""
    return balance_in_cones(program, np.zeros((len(program.names), 6)), program.load, 1.0)


def balance_in_cones(program: Program, load: Array, more: Array, most: float) -> ConeBalance:
    """The largest share of further wrenches beside a load that forces hold, 0 to `most`.

    Parameters
    ----------
    load, more : ndarray, shape (N, 6)
        Force [N] and torque about the centre of mass [N x length unit] on each part.
    most : float
    """
    free = np.flatnonzero(program.free)
    number = np.full(len(program.names) + 1, -1)
    number[free] = np.arange(len(free))
    a, b = number[program.part_a], number[program.part_b]
    rows = np.flatnonzero((a >= 0) | (b >= 0))
    a, b = a[rows], b[rows]
    first, second = np.where(a >= 0, a, b), np.where((a >= 0) & (b >= 0), b, -1)
    swapped = second >= 0
    first, second = (
        np.where(swapped, np.minimum(first, second), first),
        np.where(swapped, np.maximum(first, second), second),
    )
    key = first * (len(free) + 1) + second + 1
    order = np.argsort(key, kind="stable")
    _, start = np.unique(key[order], return_index=True)
    rows, first, second = rows[order], first[order], second[order]
    weight = program.weight[free]
    unit = float(np.exp(np.log(weight).mean()))
    directions = _directions(program, rows)
    sign = np.where(number[program.part_b[rows]] == first, 1.0, -1.0)
    columns = _columns(program, rows, free[first], directions, sign * unit)
    link_first, link_second = first[start], second[start]
    cones = LinkedCones(
        np.ascontiguousarray(columns[program.freedoms]),
        start,
        link_first,
        link_second,
        _carried(program, free, link_first, link_second),
        program.two_sided[rows],
        program.center[free],
        -_over_weight(program, free, load),
        -_over_weight(program, free, more),
        most,
    )
    return ConeBalance(program, cones, rows, directions, unit)


def _over_weight(program: Program, free: Index, wrench: Array) -> Array:
    """Wrenches of the free parts, torques / radius, over the weights, shape (N', n)."""
    scaled = wrench[free] / program.weight[free][:, None]
    scaled[:, 3:] /= program.radius[free][:, None]
    result: Array = scaled[:, program.freedoms]
    return result


def _directions(program: Program, rows: Index) -> Array:
    """Force of a unit of each unknown, shape (d, K, 3)."""
    normal, mu = program.normal[rows], program.mu[rows]
    if not mu.any():
        return normal[None]
    if program.planar:
        raise ValueError("in a plane the cones of friction are pairs of rays: `pyramid`")
    size = 1.0 / np.sqrt(1.0 + mu * mu)
    aside = [direction * (mu * size)[:, None] for direction in across(normal)]
    return np.stack([normal * size[:, None], *aside])


def _columns(program: Program, rows: Index, owner: Index, directions: Array, sign: Array) -> Array:
    """Columns of the equilibrium matrix in the rows of one part, shape (6, d, K)."""
    arm, angular = program.arm[rows], program.angular[rows]
    lever = program.point[rows] - program.center[owner]
    scale = sign / program.weight[owner]
    columns = np.zeros((6, len(directions), len(rows)))
    for k, direction in enumerate(directions):
        moment = np.where(angular[:, None], direction, cross(lever, direction))
        force = np.where(angular[:, None], 0.0, direction)
        columns[:3, k] = (force * (arm * scale)[:, None]).T
        columns[3:, k] = (moment * (arm * scale / program.radius[owner])[:, None]).T
    return columns


def _carried(program: Program, free: Index, first: Index, second: Index) -> Array:
    """What turns a wrench on the first part of a link into the opposite one on its second."""
    one, other = free[first], free[second]
    ratio = program.weight[one] / program.weight[other]
    radius, length = program.radius[one], program.radius[other]
    arm = program.center[one] - program.center[other]
    carried = np.zeros((len(first), 6, 6))
    each = np.arange(3)
    carried[:, each, each] = -ratio[:, None]
    carried[:, each + 3, each + 3] = -(ratio * radius / length)[:, None]
    for axis in range(3):
        carried[:, 3:, axis] = cross(arm, np.eye(3)[axis]) * -(ratio / length)[:, None]
    carried[second < 0] = 0.0
    result: Array = carried[:, program.freedoms][:, :, program.freedoms]
    return result
