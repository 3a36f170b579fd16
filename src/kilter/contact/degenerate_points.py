"""Contact points without a unique normal, with the cones of their normals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import (
    TINY,
    Array,
    Index,
    Mask,
    across,
    angle_between,
    read_only,
    starts,
    unit_rows,
)
from kilter.contact.contact_tolerances import MEAN_NORMAL
from kilter.contact.left_out import PossibleContacts

__all__ = ["DegeneratePoints"]


@dataclass(frozen=True, slots=True, eq=False)
class DegeneratePoints:
    """Contact points without a unique normal: a ridge on a ridge, a corner on an edge.

    A motion is allowed at point k if it does not close the gap along at least one of the normals
    of the point.

    Attributes
    ----------
    part_a, part_b : ndarray of int, shape (n,)
        Parts of each point.
    points : ndarray, shape (n, 3)
        Positions, world frame [length unit].
    start, normals : ndarray, shape (n + 1,) and (m, 3)
        Extreme rays of the cone of normals of the planes that separate the parts at point k,
        unit, from a to b: rows ``start[k]`` to ``start[k + 1]``.
    exact : ndarray of bool, shape (n,)
        False if the point is degenerate only within the tolerance: the literal coordinates may
        have a unique normal.
    held_parts, held_points, held_normals : ndarray, shape (h, 2), (h, 3) and (h, 3)
        Contact points of the same pairs of parts that have a unique normal, including points
        within a patch. Lines of degenerate points may end there.
    """

    part_a: Index
    part_b: Index
    points: Array
    start: Index
    normals: Array
    exact: Mask
    held_parts: Index
    held_points: Array
    held_normals: Array

    def __post_init__(self) -> None:
        read_only(self)

    def __len__(self) -> int:
        return len(self.part_a)

    @classmethod
    def none(cls) -> DegeneratePoints:
        """A set without degenerate points."""
        empty, index = np.empty((0, 3)), np.empty(0, dtype=np.int64)
        no, pairs = np.empty(0, dtype=bool), np.empty((0, 2), dtype=np.int64)
        return cls(index, index, empty, np.zeros(1, np.int64), empty, no, pairs, empty, empty)

    @classmethod
    def join(cls, blocks: Sequence[DegeneratePoints]) -> DegeneratePoints:
        """Concatenate sets of degenerate points, in order."""
        if len(blocks) == 1:
            return blocks[0]
        names = [name for name in cls.__slots__ if name != "start"]
        counts = [np.diff(block.start) for block in (cls.none(), *blocks)]
        return cls(
            **{name: np.concatenate([getattr(cls.none(), name),
                                     *(getattr(block, name) for block in blocks)])
               for name in names},
            start=starts(np.concatenate(counts)),
        )  # fmt: skip

    @property
    def owner(self) -> Index:
        """Index of the degenerate point to which each row of `normals` belongs, shape (m,)."""
        return np.repeat(np.arange(len(self)), np.diff(self.start))

    @property
    def centers(self) -> Array:
        """Central direction of the cone of normals of each degenerate point, unit, shape (n, 3).

        The paper uses this direction as the only normal of the point, in two dimensions.

        The centre of two normals is their bisector; of more normals it is the centroid of their
        polygon on the sphere, sum of angle(m, n) (m x n) / |m x n| / 2 over its sides.

        References
        ----------
        The paper, section 2.1, Figure 3 (d).
        """
        centers = np.zeros((len(self), 3))
        for k in range(len(self)):
            centers[k] = _center(self.normals[self.start[k] : self.start[k + 1]])
        return centers

    def pushes(self) -> PossibleContacts:
        """Possible contact forces along every normal of every degenerate point."""
        owner = self.owner
        none = np.zeros(len(owner))
        return PossibleContacts(
            self.part_a[owner],
            self.part_b[owner],
            self.points[owner],
            self.normals,
            none > 0,
            none,
            owner,
        )


def _center(normals: Array) -> Array:
    """Central unit direction of the convex cone that unit normals, shape (k, 3), span."""
    mean = unit_rows(normals.sum(axis=0))
    if len(normals) > 2:
        u, v = across(mean)
        order = np.argsort(np.arctan2(normals @ v, normals @ u))
        around = normals[order]
        following = np.roll(around, -1, axis=0)
        turns = np.cross(around, following)
        sine = np.linalg.norm(turns, axis=1)
        total = (angle_between(around, following) / np.maximum(sine, TINY)) @ turns
        size = float(np.linalg.norm(total))
        if size > MEAN_NORMAL:  # else the sides cancel: keep the mean
            mean = total / size
    return mean
