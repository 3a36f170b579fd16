"""What bears what: rows by which an upper part stands on a lower one, across gravity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across
from kilter.mechanics.program import Program

__all__ = ["Bearing", "bearing_of", "by_depth", "in_footing", "level_axes", "sums_by_part"]


@dataclass(frozen=True, slots=True, eq=False)
class Bearing:
    """Rows in which an upper part stands on a lower one, and how deep the parts stand.

    `rows`, `upper`, `lower`: (k,). `depth`, shape (N + 1,): of a part, one more than of the
    deepest that bears it; 0 of what is held; the last is the ground.
    """

    rows: Index
    upper: Index
    lower: Index
    depth: Index

    def footings(self, program: Program) -> tuple[Array, Array]:
        """(1, u, v) about the centres of the upper and of the lower parts, each (k, 2 or 3).

        Over the radius of the part; of the ground, which bears whatever it has to, as of any part.
        """
        axes = level_axes(program).T
        point, center, radius = program.point[self.rows], program.center, program.radius[:, None]
        above, below = (
            np.column_stack([np.ones(len(part)), (point - center[part]) / radius[part] @ axes])
            for part in (self.upper, self.lower)
        )
        return above, below


def bearing_of(program: Program, rows: Mask) -> Bearing | None:
    """What bears what by these rows; None where parts bear one another around."""
    own = np.flatnonzero(rows)
    up = program.normal[own] @ program.down < 0  # a bears b
    a, b = program.part_a[own], program.part_b[own]
    upper, lower = np.where(up, b, a), np.where(up, a, b)
    free = np.append(program.free, False)
    own, upper, lower = (x[free[upper]] for x in (own, upper, lower))
    count = len(free)
    pairs = np.unique(upper * count + lower % count)
    above, below = pairs // count, pairs % count
    depth = free.astype(np.int64)
    for _ in range(count):
        deeper = depth.copy()
        np.maximum.at(deeper, above, depth[below] + 1)
        if (deeper == depth).all():
            return Bearing(own, upper, lower, depth)
        depth = deeper
    return None


def by_depth(depth: Index) -> list[Index]:
    """Places of each depth, the deepest last, from the highest on."""
    order = np.argsort(depth, kind="stable")
    _, first = np.unique(depth[order], return_index=True)
    return np.split(order, first[1:])[::-1]


def in_footing(program: Program, wrench: Array) -> Array:
    """Forces up and their (1, u, v), of wrenches about the centres of mass, shape (N, 3 or 2)."""
    up = -program.down
    moment = np.cross(up, wrench[:, 3:]) / program.radius[:, None]
    return np.column_stack([wrench[:, :3] @ up, moment @ level_axes(program).T])


def level_axes(program: Program) -> Array:
    """Unit directions across gravity in which parts move, as rows."""
    if program.planar:
        return np.cross(program.down, [0.0, 1.0, 0.0])[None]
    return np.array(across(program.down))


def sums_by_part(part: Index, values: Array, count: int) -> Array:
    """Values (k, ...) summed by part, shape (count, ...)."""
    flat = values.reshape(len(part), int(np.prod(values.shape[1:])))
    total = np.empty((count, flat.shape[1]))
    for k, column in enumerate(flat.T):
        total[:, k] = np.bincount(part, column, minlength=count)
    return total.reshape(count, *values.shape[1:])
