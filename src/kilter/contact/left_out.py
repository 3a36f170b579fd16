"""Records of contacts that have no patch: overlaps, unmodelled contacts, possible forces.

A pair with such a record is open (`kilter.contact.open_pairs`): the geometry does not determine the
forces between its parts.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, read_only
from kilter.tell.record import InPython, Record, key

__all__ = [
    "INTERFERE",
    "SAME_BODY",
    "Overlap",
    "PairRecord",
    "PossibleContacts",
    "UnsupportedContact",
]


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
