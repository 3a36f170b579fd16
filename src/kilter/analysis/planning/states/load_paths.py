"""Forces along gravity that hold the states of a layered structure, without a solver.

In a wall, a tower or a frame each part passes its weight and the loads on it to its supports. Let
all contact forces be parallel to gravity. A force is then a number F >= 0 at a point x of the plane
across gravity, and a part is in balance if

    sum of F over its supports  =  its weight + sum of F over the loads on it
    sum of F x                  =  the same sum of moments

For a load of size 1 at x, weights l of the supports with sum l = 1 and sum l x_k = x solve both.
They do not depend on the state, so with a matrix T of the weights of all loads and T_0 of those of
the centres of mass, the forces of any state S are linear in the weights of its parts:

    F = T F + T_0 w_S

T is triangular if the parts are ordered from above, and is factorised once. The weights are
nonnegative where x is within the convex hull of the supports. Otherwise some of them are negative,
and other loads may make up for that. A force along gravity is in its friction cone if its contact
is flat enough; without friction only level contacts carry.

The forces are candidates only: each state verifies them by itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array, eye_array
from scipy.sparse.linalg import SuperLU, splu

from kilter.arrays import Array, Index, Mask, across
from kilter.mechanics.nonnegative import nonnegative
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT

LEVEL = 1e-10
"""Largest sine of the angle between gravity and the normal of a contact without friction [-]."""
WITHIN = 1e-9
"""Largest error of nonnegative weights, relative to the load and the size of the part [-]."""
SAME = 1e-12
"""Distance up to which a load is at a support, relative to the size of the part [-]."""


class LoadPaths:
    """Forces along gravity for the states of an assembly, from its program with all parts.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> program = build_program(tower, contacts(tower))
    >>> forces, _ = LoadPaths(program).forces(program.free)
    >>> round(float(forces.sum() / program.weight[program.free].sum()), 9)
    3.0
    """

    def __init__(self, whole: Program) -> None:
        self._whole = whole
        up = -whole.down
        slope = whole.normal @ up
        across_gravity = np.sqrt(np.maximum(1.0 - slope**2, 0.0))
        flat = (across_gravity <= np.maximum(whole.mu * np.abs(slope), LEVEL)) & (slope != 0.0)
        rows = np.flatnonzero((whole.kind == CONTACT) & ~whole.two_sided & ~whole.tied & flat)
        rises = slope[rows] > 0
        a, b = whole.part_a[rows], whole.part_b[rows]
        self._rows = rows
        self._upper, self._lower = np.where(rises, b, a), np.where(rises, a, b)
        # force on part b per unit of the force along gravity, along and across the row
        self._along = np.abs(slope[rows])
        tangent = np.where(rises, 1.0, -1.0)[:, None] * (
            up - slope[rows, None] * whole.normal[rows]
        )
        self._across = np.where(across_gravity[rows, None] > LEVEL, tangent, 0.0)
        self._plane = np.stack(across(up))

    def forces(self, free: Mask) -> tuple[Array, Array | None] | None:
        """Forces along and across all rows, (K,) and (K, 3) [N], that may balance the free parts.

        Arguments: `free` (N,): free parts of a state without held parts beside the grounded parts.
        Returns None if loads other than weights act, or parts support each other in a circle; and
        no forces across the rows if all supports are level.
        """
        whole, flows = self._whole, self._flows
        if flows is None:
            return None
        size = np.zeros(len(self._rows))
        size[flows.order] = flows.factor.solve(flows.own @ np.where(free, whole.mass, 0.0))
        size *= whole.g
        forces = np.zeros(len(whole.part_a))
        forces[self._rows] = size * self._along
        if not self._across.any():
            return forces, None
        friction = np.zeros((len(forces), 3))
        friction[self._rows] = size[:, None] * self._across
        return forces, friction

    @cached_property
    def _flows(self) -> _Flows | None:
        """The factorised equations of all forces; None if they do not exist."""
        whole, depth = self._whole, self._depths()
        if depth is None or whole.applied.any() or whole.clamp.any():
            return None
        order = np.argsort(depth[self._upper], kind="stable")
        loads = self._weights()
        count, parts = len(self._rows), len(whole.names)
        if not loads:
            return None
        weight, support, load = (np.concatenate(column) for column in zip(*loads, strict=True))
        place = np.empty(count + parts, dtype=int)
        place[np.append(order, count + np.arange(parts))] = np.arange(count + parts)
        matrix = csc_array((weight, (place[support], place[load])), shape=(count, count + parts))
        factor = splu(
            (eye_array(count, format="csc") - matrix[:, :count]).tocsc(),
            permc_spec="NATURAL",
            diag_pivot_thresh=0.0,
        )
        return _Flows(order, matrix[:, count:], factor)

    def _depths(self) -> Index | None:
        """Largest number of parts above each part, shape (N + 1,); None without rows or an order.

        The last entry belongs to the ground.
        """
        depth = np.zeros(len(self._whole.names) + 1, dtype=int)
        if not len(self._rows):
            return None
        inner = np.append(self._whole.free, False)[self._lower]
        upper, lower = np.unique(np.stack([self._upper, self._lower])[:, inner], axis=1)
        for _ in range(len(depth)):
            below = depth.copy()
            np.maximum.at(below, lower, depth[upper] + 1)
            if np.array_equal(below, depth):
                return depth
            depth = below
        return None

    def _weights(self) -> list[tuple[Array, Index, Index]]:
        """Weights of the supports of each load, as arrays of weights, supports and loads.

        A support is a number of a row, a load that of a row, or of a part after all rows.
        """
        whole, count = self._whole, len(self._rows)
        point = whole.point[self._rows] @ self._plane.T
        center = whole.center @ self._plane.T
        parts = len(whole.names)
        supports, loads = _by_part(self._upper, parts), _by_part(self._lower, parts)
        weights = []
        for part in np.flatnonzero(whole.free).tolist():
            on, by = loads[part], supports[part]
            if len(by):
                at = np.vstack([point[on], center[part]])
                share = support_weights(point[by], at, float(whole.radius[part]))
                load, support = np.nonzero(share)
                number = np.append(on, count + part)
                weights.append((share[load, support], by[support], number[load]))
        return weights


@dataclass(frozen=True, slots=True, eq=False)
class _Flows:
    """Equations of the forces along gravity: order of the rows, weights of parts, and factor."""

    order: Index
    own: csc_array
    factor: SuperLU


def _by_part(part: Index, count: int) -> list[Index]:
    """Indices of the rows of each part; rows of the ground (-1) are left out."""
    order = np.argsort(part, kind="stable")
    ends = np.searchsorted(part[order], np.arange(count + 1))
    return [order[ends[k] : ends[k + 1]] for k in range(count)]


def support_weights(supports: Array, loads: Array, size: float) -> Array:
    """Weights of supports, shape (m, 2), that carry unit loads at points, (n, 2); shape (n, m).

    They are nonnegative for a load within the convex hull of the supports. Arguments: `size`:
    length of the part [length unit].

    Examples
    --------
    >>> support_weights(np.array([[0.0, 0], [2, 0]]), np.array([[0.5, 0], [3, 0]]), 1.0).round(9)
    array([[ 0.75,  0.25],
           [-0.5 ,  1.5 ]])
    """
    middle = supports.mean(axis=0)
    base = np.column_stack([np.ones(len(supports)), (supports - middle) / size])
    wanted = np.column_stack([np.ones(len(loads)), (loads - middle) / size])
    weights: Array = wanted @ np.linalg.pinv(base, rcond=WITHIN)
    for k in np.flatnonzero(weights.min(axis=1) < 0.0).tolist():
        away = np.linalg.norm(base - wanted[k], axis=1)
        if away.min() <= SAME:
            weights[k] = np.arange(len(away)) == away.argmin()
            continue
        pushing, distance = nonnegative(base, wanted[k])
        if distance <= WITHIN:
            weights[k] = pushing
    return weights
