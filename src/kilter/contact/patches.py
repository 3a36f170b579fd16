"""Patches: the one currency of contacts, whichever family of faces they come from.

Flat faces, edges and corners, curved faces and the file's own contacts each make `Patches`;
the detection joins them, and a `ContactSet` is that, with friction and what is not modelled.
The points of a patch carry a normal each, that of the patch where it is flat.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Labels, ragged, starts

__all__ = ["Patches"]

BY_PATCH = ("pair", "parts", "kind", "normal", "area", "gap", "accuracy")
BY_POINT = ("points", "normals")


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Contact patches and their points; world frame, length unit of the file.

    Attributes
    ----------
    pair : ndarray of int, shape (P,)
        Row of the pair of parts in the search; -1 for contacts that the file gives.
    parts : ndarray of int, shape (P, 2)
        Parts a and b.
    kind : ndarray of str, shape (P,)
        See `ContactSet.patch_kind`.
    normal : ndarray, shape (P, 3)
        Unit, from a to b.
    area : ndarray, shape (P,)
        [length unit^2]
    gap : ndarray, shape (P, 2)
        Least and greatest [length unit].
    accuracy : ndarray, shape (P,)
        Of the coordinates, as a fraction of the size of what touches [-].
    start : ndarray of int, shape (P + 1,)
        The points of patch p are rows ``start[p]`` to ``start[p + 1]``.
    points, normals : ndarray, shape (K, 3)
    """

    pair: Index
    parts: Index
    kind: Labels
    normal: Array
    area: Array
    gap: Array
    accuracy: Array
    start: Index
    points: Array
    normals: Array

    def __len__(self) -> int:
        return len(self.pair)

    def of_pair(self, pair: int) -> range:
        """Rows of the patches of one pair, where they are ordered by pair."""
        return range(*(int(k) for k in np.searchsorted(self.pair, [pair, pair + 1])))

    def corners(self, patch: int) -> Array:
        """Points of one patch, shape (n, 3)."""
        return self.points[self.start[patch] : self.start[patch + 1]]

    def take(self, rows: Index) -> Patches:
        """These patches alone, with their points."""
        _, points = ragged(self.start, rows)
        return Patches(
            **{name: getattr(self, name)[rows] for name in BY_PATCH},
            **{name: getattr(self, name)[points] for name in BY_POINT},
            start=starts(np.diff(self.start)[rows]),
        )

    @staticmethod
    def join(blocks: Iterable[Patches]) -> Patches:
        """The patches of all blocks, in their order."""
        blocks = [block for block in blocks if len(block)]
        if len(blocks) <= 1:
            return blocks[0] if blocks else Patches.none()
        names = (*BY_PATCH, *BY_POINT)
        return Patches(
            **{name: np.concatenate([getattr(b, name) for b in blocks]) for name in names},
            start=starts(np.concatenate([np.diff(b.start) for b in blocks])),
        )

    @staticmethod
    def none() -> Patches:
        """No patch."""
        return Patches(
            pair=np.empty(0, dtype=np.int64),
            parts=np.empty((0, 2), dtype=np.int64),
            kind=np.empty(0, dtype="<U11"),
            normal=np.empty((0, 3)),
            area=np.empty(0),
            gap=np.empty((0, 2)),
            accuracy=np.empty(0),
            start=np.zeros(1, dtype=np.int64),
            points=np.empty((0, 3)),
            normals=np.empty((0, 3)),
        )

    def ordered(self) -> Patches:
        """Ordered by pair, those of one pair as they are."""
        return self.take(np.argsort(self.pair, kind="stable"))
