"""Which part stands on which: contacts at which an upper part is supported by a lower part."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across
from kilter.mechanics.program import Program


@dataclass(frozen=True, slots=True, eq=False)
class Bearing:
    """Contacts at which a part stands on another, and the level of each part in this order.

    `rows`, `upper`, `lower`, shape (k,): each row with its upper and its lower part. `depth`, shape
    (N + 1,): 0 for held parts, else 1 plus the largest depth of the supporting parts. The last
    entry of `depth` is the ground.
    """

    rows: Index
    upper: Index
    lower: Index
    depth: Index

    def footings(self, program: Program) -> tuple[Array, Array]:
        """Contact points as (1, u, v) from the upper and the lower centre, (k, 2 or 3) each.

        u and v are over the radius of the part [-]. Those of the ground are not used.
        """
        axes = level_axes(program).T
        point, center, radius = program.point[self.rows], program.center, program.radius[:, None]
        above, below = (
            np.column_stack([np.ones(len(part)), (point - center[part]) / radius[part] @ axes])
            for part in (self.upper, self.lower)
        )
        return above, below


def bearing_of(program: Program, rows: Mask) -> Bearing | None:
    """Find which part stands on which, by the given contacts; None if parts support each other."""
    places = np.flatnonzero(rows)
    up = program.normal[places] @ program.down < 0  # part a supports part b
    a, b = program.part_a[places], program.part_b[places]
    upper, lower = np.where(up, b, a), np.where(up, a, b)
    free = np.append(program.free, False)
    places, upper, lower = (x[free[upper]] for x in (places, upper, lower))
    count = len(free)
    pairs = np.unique(upper * count + lower % count)
    above, below = pairs // count, pairs % count
    depth = free.astype(np.int64)
    for _ in range(count):
        deeper = depth.copy()
        np.maximum.at(deeper, above, depth[below] + 1)
        if (deeper == depth).all():
            return Bearing(places, upper, lower, depth)
        depth = deeper
    return None


def by_depth(depth: Index) -> list[Index]:
    """Groups of indices of equal depth; the group of largest depth comes first."""
    order = np.argsort(depth, kind="stable")
    _, first = np.unique(depth[order], return_index=True)
    return np.split(order, first[1:])[::-1]


def in_footing(program: Program, wrench: Array) -> Array:
    """Vertical force of wrenches and its two moments, per part, shape (N, 3 or 2) [N].

    From wrenches (N, 6) about the centres of mass; the moments are over the radius of the part.
    """
    up = -program.down
    moment = np.cross(up, wrench[:, 3:]) / program.radius[:, None]
    return np.column_stack([wrench[:, :3] @ up, moment @ level_axes(program).T])


def level_axes(program: Program) -> Array:
    """Horizontal unit directions in which parts can move, as rows: two, or one in the plane."""
    if program.planar:
        return np.cross(program.down, [0.0, 1.0, 0.0])[None]
    return np.array(across(program.down))


def sums_by_part(part: Index, values: Array, count: int) -> Array:
    """Sums of values (k, ...) over the rows of each part, shape (count, ...)."""
    flat = values.reshape(len(part), int(np.prod(values.shape[1:])))
    total = np.empty((count, flat.shape[1]))
    for k, column in enumerate(flat.T):
        total[:, k] = np.bincount(part, column, minlength=count)
    return total.reshape(count, *values.shape[1:])
