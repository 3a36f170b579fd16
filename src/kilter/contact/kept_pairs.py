"""Selection of pairs of parts, and new numbers for the records of a contact search.

A contact between two parts does not depend on other parts. So the contacts of an assembly without
some parts, or with other held parts, are those of the remaining pairs.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from kilter.arrays import Index, Mask, ragged, starts
from kilter.contact.degenerate_points import DegeneratePoints
from kilter.contact.left_out import PossibleContacts
from kilter.contact.patches import Patches

__all__ = ["KeptPairs"]

OfPair = TypeVar("OfPair", bound=Any)


@dataclass(frozen=True, slots=True, eq=False)
class KeptPairs:
    """The pairs of parts that remain, and the new numbers of their parts and rows.

    Attributes
    ----------
    new_part : ndarray of int, shape (N,)
        New position of each part; -1 for parts that do not remain.
    new_row : ndarray of int, shape (n,)
        New row of each pair of the search; -1 for pairs that do not remain.
    removed : frozenset of frozenset of int
        Pairs of parts that do not remain although both parts do, by the old positions.
    """

    new_part: Index
    new_row: Index
    removed: frozenset[frozenset[int]] = frozenset()

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
