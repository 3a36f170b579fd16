"""Equilibrium in exact friction cones, in the form that kilter's own interior-point method solves.

    max t:  A f = b + t d,   0 <= t <= T,   f in K

Each free part is a block of equations, and all rows between two parts are one link. A row with
friction has the unknowns (f_n, f_u / mu, f_v / mu) times the root of 1 + mu^2, in the cone
x_0 >= |x_1..|. A row without friction has a single unknown: a half line, or a whole line if the row
may also pull. The equations are scaled as in `kilter.mechanics.forms`, forces and torques / radius
over the weight of each part. The columns are built directly from the rows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Index, across, cross
from kilter.mechanics.program import Program
from kilter.solvers.linked_cones import LinkedCones


@dataclass(frozen=True, slots=True, eq=False)
class ConeBalance:
    """Equilibrium with friction cones as a `LinkedCones` problem, and the data to decode it."""

    program: Program
    cones: LinkedCones
    rows: Index
    """Row of the program for each cone, shape (K,)."""
    directions: Array
    """Force vector per unit of each unknown, in multiples of `unit` [-], shape (d, K, 3)."""
    unit: float
    """Unit of force: the geometric mean of the weights of the free parts [N]."""

    def with_more(self, wrenches: Array, most: float) -> ConeBalance:
        """Copy of the problem for other additional wrenches, shape (N, 6), up to `most` times."""
        free = np.flatnonzero(self.program.free)
        along = -_over_weight(self.program, free, wrenches)
        return replace(self, cones=self.cones.with_more(along, most))

    def decoded(self, x: Array) -> tuple[Array, Array]:
        """Normal forces, (K,), and friction forces, (K, 3) [N], of the rows from unknowns x."""
        count = len(self.program.part_a)
        normal_force, friction = np.zeros(count), np.zeros((count, 3))
        normal = self.program.normal[self.rows]
        normal_size = np.einsum("ki,ki->k", self.directions[0], normal)
        normal_force[self.rows] = x[0] * normal_size * self.unit * self.program.arm[self.rows]
        friction[self.rows] = np.einsum("dk,dki->ki", x[1:], self.directions[1:]) * self.unit
        return normal_force, friction

    def motion(self, y: Array) -> Array:
        """Motion of all parts, shape (N, 6), from the problem's multipliers of balance, (N', n)."""
        program = self.program
        full = np.zeros((len(program.names), 6))
        free = np.flatnonzero(program.free)
        full[np.ix_(free, program.freedoms)] = y / program.weight[free][:, None]
        full[:, 3:] /= program.radius[:, None]
        return full

    def multipliers(self, motion: Array) -> Array:
        """Multipliers y, shape (N', n), whose motion is the given one, shape (N, 6)."""
        program = self.program
        scaled = motion * program.weight[:, None]
        scaled[:, 3:] *= program.radius[:, None]
        result: Array = scaled[np.ix_(program.free, program.freedoms)]
        return result


def load_share(program: Program) -> ConeBalance:
    """Problem for the largest fraction (0 to 1) of the load that contact forces balance."""
    return balance_in_cones(program, np.zeros((len(program.names), 6)), program.load, 1.0)


def balance_in_cones(program: Program, load: Array, more: Array, most: float) -> ConeBalance:
    """Problem for the largest multiple of extra wrenches that contacts balance beside a load.

    Arguments: `load`, `more` (N, 6): force [N] and torque about the centre of mass [N x length
    unit] on each part; `more` holds the further wrenches; `most`: upper bound of the share [-].
    """
    free = np.flatnonzero(program.free)
    number = np.full(len(program.names) + 1, -1)
    number[free] = np.arange(len(free))
    a, b = number[program.part_a], number[program.part_b]
    rows = np.flatnonzero((a >= 0) | (b >= 0))
    a, b = a[rows], b[rows]
    first, second = np.where(a >= 0, a, b), np.where((a >= 0) & (b >= 0), b, -1)
    both_free = second >= 0
    first, second = (
        np.where(both_free, np.minimum(first, second), first),
        np.where(both_free, np.maximum(first, second), second),
    )
    # rows between the same two parts form a link
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
        _transfer_matrices(program, free, link_first, link_second),
        program.two_sided[rows],
        program.center[free],
        -_over_weight(program, free, load),
        -_over_weight(program, free, more),
        most,
    )
    return ConeBalance(program, cones, rows, directions, unit)


def _over_weight(program: Program, free: Index, wrench: Array) -> Array:
    """Wrenches of the free parts over their weights, torques also over radii, shape (N', n)."""
    scaled = wrench[free] / program.weight[free][:, None]
    scaled[:, 3:] /= program.radius[free][:, None]
    result: Array = scaled[:, program.freedoms]
    return result


def _directions(program: Program, rows: Index) -> Array:
    """Direction of the force of each unknown of a row, over the unit of force, shape (d, K, 3)."""
    normal, mu = program.normal[rows], program.mu[rows]
    if not mu.any():
        return normal[None]
    if program.planar:
        raise ValueError("in a plane the cones of friction are pairs of rays: `pyramid`")
    size = 1.0 / np.sqrt(1.0 + mu * mu)
    tangents = [direction * (mu * size)[:, None] for direction in across(normal)]
    return np.stack([normal * size[:, None], *tangents])


def _columns(program: Program, rows: Index, owner: Index, directions: Array, sign: Array) -> Array:
    """Columns of the equilibrium matrix: wrenches on the row's part `owner`, shape (6, d, K)."""
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


def _transfer_matrices(program: Program, free: Index, first: Index, second: Index) -> Array:
    """Matrices that move the wrench on the first part of each link to its second part, (L, n, n).

    Between scaled wrenches. It is zero for a link to a held part or the ground
    (`second` < 0).
    """
    part_a, part_b = free[first], free[second]
    ratio = program.weight[part_a] / program.weight[part_b]
    radius, radius_b = program.radius[part_a], program.radius[part_b]
    arm = program.center[part_a] - program.center[part_b]
    transfer = np.zeros((len(first), 6, 6))
    each = np.arange(3)
    transfer[:, each, each] = -ratio[:, None]
    transfer[:, each + 3, each + 3] = -(ratio * radius / radius_b)[:, None]
    for axis in range(3):
        transfer[:, 3:, axis] = cross(arm, np.eye(3)[axis]) * -(ratio / radius_b)[:, None]
    transfer[second < 0] = 0.0
    result: Array = transfer[:, program.freedoms][:, :, program.freedoms]
    return result
