"""Patches: the common record of contacts between flat, curved, sharp and given features.

Each stage of the contact search returns `Patches`; the search joins them to a `ContactSet`, with
friction and the unmodelled contacts. Every point of a patch has a normal; on a flat patch it is
that of the patch.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from kilter.arrays import Array, Index, Labels, ragged, starts

__all__ = ["Patches"]

BY_PATCH = ("pair", "parts", "kind", "normal", "area", "gap", "accuracy", "doubt", "mu", "pieces")
BY_POINT = ("points", "normals")


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Contact patches of a search with their points; world frame, length unit of the file.

    Attributes
    ----------
    pair : ndarray of int, shape (P,)
        Row of the pair of parts in the search; -1 for contacts that the file lists.
    parts : ndarray of int, shape (P, 2)
        Parts a and b.
    kind : ndarray of str, shape (P,)
        Kind of contact: see `ContactSet.patch_kind`.
    normal : ndarray, shape (P, 3)
        Unit normal, from a to b.
    area : ndarray, shape (P,)
        Area of contact [length unit^2].
    gap : ndarray, shape (P, 2)
        Least and greatest gap [length unit].
    accuracy : ndarray, shape (P,)
        Accuracy of the coordinates, as a fraction of the size of the touching features [-].
    doubt : ndarray, shape (P,)
        Largest error of fitted normals; 0 for exact normals [rad].
    mu : ndarray, shape (P,)
        Friction coefficient that the file gives for the contact; NaN: that of its pair [-].
    start : ndarray of int, shape (P + 1,)
        The points of patch p are rows ``start[p]`` to ``start[p + 1]``.
    pieces : ndarray of int, shape (P, 2), optional
        Pieces of the parts that touch; -1, the default, if only the points show them.
    points, normals : ndarray, shape (K, 3)
        Contact points and the unit normal at each, from a to b.
    """

    pair: Index
    parts: Index
    kind: Labels
    normal: Array
    area: Array
    gap: Array
    accuracy: Array
    doubt: Array
    mu: Array
    start: Index
    points: Array
    normals: Array
    pieces: Index = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))

    def __post_init__(self) -> None:
        if len(self.pieces) < len(self.pair):
            object.__setattr__(self, "pieces", np.full((len(self.pair), 2), -1))

    def __len__(self) -> int:
        return len(self.pair)

    def of_pair(self, pair: int) -> range:
        """Range of the patches that belong to a pair; the patches must be ordered by pair."""
        return range(*(int(k) for k in np.searchsorted(self.pair, [pair, pair + 1])))

    def corners(self, patch: int) -> Array:
        """Contact points of the patch with the index `patch`, shape (n, 3)."""
        return self.points[self.start[patch] : self.start[patch + 1]]

    def take(self, rows: Index) -> Patches:
        """The patches with the given indices, and their points."""
        _, points = ragged(self.start, rows)
        return Patches(
            **{name: getattr(self, name)[rows] for name in BY_PATCH},
            **{name: getattr(self, name)[points] for name in BY_POINT},
            start=starts(np.diff(self.start)[rows]),
        )

    @staticmethod
    def join(blocks: Iterable[Patches]) -> Patches:
        """Concatenate blocks of patches, in order."""
        blocks = [block for block in blocks if len(block)]
        if len(blocks) <= 1:
            return blocks[0] if blocks else Patches.none()
        names = (*BY_PATCH, *BY_POINT)
        return Patches(
            **{name: np.concatenate([getattr(b, name) for b in blocks]) for name in names},
            start=starts(np.concatenate([np.diff(b.start) for b in blocks])),
        )

    def after(self, rows: int) -> Patches:
        """These patches, with pairs that lie that many rows further in their search."""
        return replace(self, pair=self.pair + rows) if rows else self

    @staticmethod
    def none() -> Patches:
        """A value without patches."""
        return Patches(
            pair=np.empty(0, dtype=np.int64),
            parts=np.empty((0, 2), dtype=np.int64),
            kind=np.empty(0, dtype="<U11"),
            normal=np.empty((0, 3)),
            area=np.empty(0),
            gap=np.empty((0, 2)),
            accuracy=np.empty(0),
            doubt=np.empty(0),
            mu=np.empty(0),
            start=np.zeros(1, dtype=np.int64),
            points=np.empty((0, 3)),
            normals=np.empty((0, 3)),
        )

    def ordered(self) -> Patches:
        """These patches sorted by pair; the order within a pair is kept."""
        return self.take(np.argsort(self.pair, kind="stable"))
