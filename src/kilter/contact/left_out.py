"""Records of contacts that have no patch: overlaps, unmodelled contacts, possible forces.

A pair with such a record is open (`kilter.contact.open_pairs`): the geometry does not determine the
forces between its parts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, read_only

__all__ = ["INTERFERE", "SAME_BODY", "Overlap", "PossibleContacts", "UnsupportedContact"]


INTERFERE = "interfere"
"""Reason of an overlap between a shaft and a thinner hole: a thread or a press fit."""
SAME_BODY = "are the same body twice"
"""Reason of an overlap between two bodies in the same place."""


@dataclass(frozen=True, slots=True)
class Overlap:
    """Two parts that occupy the same space: their indices, the shared volume and its depth.

    Attributes
    ----------
    parts : pair of int
    volume : float or None
        Shared volume of their triangles [length unit^3]; None if the triangles of a part do not
        bound a body.
    depth : float
        Largest depth to which the parts enter each other [length unit].
    why : str
        Kind of the overlap, in words.
    share : float or None
        Shared volume divided by the volume of the smaller part [-].
    """

    parts: tuple[int, int]
    volume: float | None
    depth: float
    why: str
    share: float | None = None


@dataclass(frozen=True, slots=True)
class UnsupportedContact:
    """A contact of two parts that the contact model cannot describe, such as a corner on an edge.

    `kind` is "edge", "vertex" or "curved"; `point` is a point of the contact, world frame.
    """

    parts: tuple[int, int]
    kind: str
    point: tuple[float, float, float]


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
