"""Patches: the common record of contacts, and records of contacts that have no patch.

A pair with such a record is open (`kilter.contact.open_pairs`): the geometry does not determine the
forces between its parts.

Each stage of the contact search returns `Patches`; the search joins them to a `ContactSet`, with
friction and the unmodelled contacts. Every point of a patch has a normal; on a flat patch it is
that of the patch.

A contact between two parts does not depend on other parts. So the contacts of an assembly without
some parts, or with other held parts, are those of the remaining pairs.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np

from kilter.arrays import (
    TINY,
    Array,
    Index,
    Labels,
    Mask,
    Rows,
    across,
    angle_between,
    columns,
    ragged,
    read_only,
    starts,
    unit_rows,
)
from kilter.contact.contact_tolerances import MEAN_NORMAL
from kilter.tell.record import InPython, Lines, Record, Vector, key

INTERFERE = "interfere"
"""Reason of an overlap between a shaft and a thinner hole: a thread or a press fit."""
SAME_BODY = "are the same body twice"
"""Reason of an overlap between two bodies in the same place."""


class PairRecord(Record, kw_only=False):
    """A pair of parts, from the contact search."""

    ends: InPython[tuple[int, int]]
    """Positions of the parts in the assembly."""
    names: InPython[tuple[str, ...]] = field(default=(), kw_only=True)
    """Names of all parts, which the set of contacts supplies."""

    @property
    @key
    def parts(self) -> tuple[str, str]:
        """Names of the parts."""
        return self.names[self.ends[0]], self.names[self.ends[1]]

    def __repr__(self) -> str:
        parts = self.parts if self.names else self.ends
        return f"<{type(self).__name__}: {parts[0]!r} and {parts[1]!r}>"


class Overlap(PairRecord, kw_only=False):
    """Two parts that occupy the same space."""

    volume: float | None
    """Shared volume of their triangles [length unit^3]; null if those of a part bound no body."""
    depth: float
    """Largest depth to which the parts enter each other [length unit]."""
    why: str
    """Kind of the overlap, in words."""
    share: float | None = None
    """Shared volume divided by the volume of the smaller part [-]."""


class UnsupportedContact(PairRecord, kw_only=False):
    """A contact that the contact model cannot describe, such as a corner on an edge."""

    kind: str
    """Kind of the contact: "edge", "vertex" or "curved"."""
    point: tuple[float, float, float]
    """A point of the contact [length unit], world frame."""


@dataclass(frozen=True, slots=True, eq=False)
class PossibleContacts(Rows):
    """Forces that may act at contacts outside the patches; a row for each force.

    They bound a verdict from the other side: an assembly that is unstable although all of these
    forces may act is unstable. Rows with `two_sided` may also pull. `mu` is the friction
    coefficient of the pair [-]. `degenerate` is the row of the degenerate point whose normal the
    force follows, -1 for other forces.
    """

    part_a: Index
    part_b: Index
    points: Array = columns(3)
    normals: Array = columns(3)
    two_sided: Mask = columns()
    mu: Array = columns()
    degenerate: Index = columns()

    def __post_init__(self) -> None:
        read_only(self)

    def without_wrenches(self, pairs: set[frozenset[int]]) -> PossibleContacts:
        """These forces without the two-sided forces between the given pairs of parts."""
        ends = zip(self.part_a.tolist(), self.part_b.tolist(), strict=True)
        of_pair = np.array([frozenset(pair) in pairs for pair in ends], dtype=bool)
        return self.take(np.flatnonzero(~(of_pair & self.two_sided)))


class Patch(Record):
    """An area, edge or point at which two parts touch; world frame, arrays read-only."""

    parts: tuple[str, str]
    """Names of the parts a and b."""
    kind: str
    """Kind of the contact, as in `ContactSet.patch_kind`."""
    area: float
    """Area of contact [length unit^2]."""
    gap_range: tuple[float, float]
    """Least and greatest gap [length unit]; negative = penetration."""
    normal: Vector
    """Unit normal from the first part to the second."""
    mu: float
    """Friction coefficient [-]."""
    pieces: tuple[int, int] | None = None
    """Pieces of the parts that touch (`Mesh.pieces`); null if they are unknown."""
    pull: float | None = None
    """Largest tension of a bond [N]; null without a bond."""
    points: Lines
    """Contact points [length unit]."""
    normals: InPython[Array]
    """Unit normal from a to b at each point, shape (k, 3)."""

    @property
    @key
    def gap(self) -> float:
        """Largest gap [length unit]; negative if the parts overlap."""
        return max(self.gap_range, key=abs)

    def __repr__(self) -> str:
        a, b = self.parts
        return f"<Patch: {self.kind}, {a!r} to {b!r}, area {self.area:.6g}>"


BY_PATCH = ("pair", "parts", "kind", "normal", "area", "gap", "accuracy", "doubt", "mu", "pieces")
BY_POINT = ("points", "normals")


@dataclass(frozen=True, slots=True, eq=False)
class Patches:
    """Contact patches of a search with their points; world frame, length unit of the file."""

    pair: Index
    """Row of the pair of parts in the search, shape (P,); -1 for contacts that the file lists."""
    parts: Index
    """Parts a and b, shape (P, 2)."""
    kind: Labels
    """Kind of contact, shape (P,): see `ContactSet.patch_kind`."""
    normal: Array
    """Unit normal, from a to b, shape (P, 3)."""
    area: Array
    """Area of contact [length unit^2], shape (P,)."""
    gap: Array
    """Least and greatest gap [length unit], shape (P, 2)."""
    accuracy: Array
    """Accuracy of the coordinates, as a fraction of the size of the touching features [-], shape
    (P,)."""
    doubt: Array
    """Largest error of fitted normals, shape (P,); 0 for exact normals [rad]."""
    mu: Array
    """Friction coefficient that the file gives for the contact, shape (P,); NaN: that of its
    pair [-]."""
    start: Index
    """The points of patch p are rows ``start[p]`` to ``start[p + 1]``, shape (P + 1,)."""
    points: Array
    normals: Array
    """Contact points and the unit normal at each, from a to b, shape (K, 3)."""
    pieces: Index = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    """Pieces of the parts that touch, shape (P, 2); -1, the default, if only the points show
    them."""

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


@dataclass(frozen=True, slots=True, eq=False)
class DegeneratePoints:
    """Contact points without a unique normal: a ridge on a ridge, a corner on an edge.

    A motion is allowed at point k if it does not close the gap along at least one of the normals
    of the point.
    """

    part_a: Index
    part_b: Index
    """Parts of each point, shape (n,)."""
    points: Array
    """Positions, world frame [length unit], shape (n, 3)."""
    start: Index
    normals: Array
    """Extreme rays of the cone of normals of the planes that separate the parts at point k,
    unit, from a to b, shape (n + 1,): rows ``start[k]`` to ``start[k + 1]``."""
    exact: Mask
    """False if the point is degenerate only within the tolerance, shape (n,): the literal
    coordinates may have a unique normal."""
    held_parts: Index
    held_points: Array
    held_normals: Array
    """Contact points of the same pairs of parts that have a unique normal, including points
    within a patch, shape (h, 2). Lines of degenerate points may end there."""

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


OfPair = TypeVar("OfPair", bound=Any)


@dataclass(frozen=True, slots=True, eq=False)
class KeptPairs:
    """The pairs of parts that remain, and the new numbers of their parts and rows."""

    new_part: Index
    """New position of each part, shape (N,); -1 for parts that do not remain."""
    new_row: Index
    """New row of each pair of the search, shape (n,); -1 for pairs that do not remain."""
    removed: frozenset[frozenset[int]] = frozenset()
    """Pairs of parts that do not remain although both parts do, by the old positions."""

    def records(self, records: Iterable[OfPair]) -> tuple[OfPair, ...]:
        """Records of the remaining pairs, with the new positions of their parts."""
        kept = []
        new = self.new_part.tolist()  # a list is read much faster than an array
        for record in records:
            first, second = record.ends
            a, b = new[first], new[second]
            if a < 0 or b < 0:
                continue
            if not self.removed or frozenset(record.ends) not in self.removed:
                kept.append(record if record.ends == (a, b) else replace(record, ends=(a, b)))
        return tuple(kept)

    def rows_of(self, pair: Index) -> Index:
        """Positions of the entries whose pair remains, from the row of the pair of each entry."""
        return np.flatnonzero(self.new_row[pair] >= 0)

    def rows(self, entries: Index) -> Index:
        """Entries of the remaining pairs; their first column is the row of the pair, (n, m)."""
        kept = entries[self.rows_of(entries[:, 0])]
        return np.column_stack([self.new_row[kept[:, 0]], kept[:, 1:]])

    def pairs_of_parts(self, pairs: Index) -> Index:
        """Pairs of parts that remain, with new positions, (m, 2)."""
        kept = pairs[self.of_parts(pairs[:, 0], pairs[:, 1])]
        return self.new_part[kept]

    def patches(self, given: Patches) -> Patches:
        """Contact patches of the remaining pairs."""
        kept = given.take(self.rows_of(given.pair))
        return replace(kept, pair=self.new_row[kept.pair], parts=self.new_part[kept.parts])

    def of_parts(self, a: Index, b: Index) -> Mask:
        """Mask of the pairs of parts (a, b) that remain; the part -1, the ground, remains."""
        ends = np.append(self.new_part, -1)
        keep: Mask = ((ends[a] >= 0) | (a < 0)) & ((ends[b] >= 0) | (b < 0))
        if self.removed:
            pairs = zip(a.tolist(), b.tolist(), strict=True)
            keep &= np.array([frozenset(pair) not in self.removed for pair in pairs], dtype=bool)
        return keep

    def possible(self, given: PossibleContacts, new_point: Index | None = None) -> PossibleContacts:
        """Possible forces between the remaining pairs.

        `new_point`, shape (m + 1,), has the new row of each degenerate point, and -1 at its end.
        """
        ends = np.append(self.new_part, -1)
        kept = given.take(np.flatnonzero(self.of_parts(given.part_a, given.part_b)))
        row = kept.degenerate if new_point is None else new_point[kept.degenerate]
        return replace(kept, part_a=ends[kept.part_a], part_b=ends[kept.part_b], degenerate=row)

    def degenerate(self, given: DegeneratePoints) -> tuple[DegeneratePoints, Index]:
        """Degenerate points of the remaining pairs, and the new row of every point, (n + 1,).

        The row is -1 for points that are dropped; the last entry is -1 too, for rows -1.
        """
        points = np.flatnonzero(self.of_parts(given.part_a, given.part_b))
        _, normals = ragged(given.start, points)
        held = self.of_parts(given.held_parts[:, 0], given.held_parts[:, 1])
        new_row = np.full(len(given) + 1, -1)
        new_row[points] = np.arange(len(points))
        return DegeneratePoints(
            self.new_part[given.part_a[points]],
            self.new_part[given.part_b[points]],
            given.points[points],
            starts(np.diff(given.start)[points]),
            given.normals[normals],
            given.exact[points],
            self.new_part[given.held_parts[held]],
            given.held_points[held],
            given.held_normals[held],
        ), new_row
