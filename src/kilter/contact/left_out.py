"""What touches, or may touch, but is no contact: overlaps, kinds that are not modelled, and forces.

A pair of these is open (`kilter.contact.open_pairs`): the geometry does not say what acts there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, read_only

__all__ = ["INTERFERE", "SAME_BODY", "Overlap", "PossibleContacts", "Unsupported"]


INTERFERE = "interfere"
"""What is said of a shaft that is thicker than its hole: a thread, a press fit."""
SAME_BODY = "are the same body twice"
"""What is said of two bodies in one place."""


@dataclass(frozen=True, slots=True)
class Overlap:
    """Two parts that share volume.

    Attributes
    ----------
    parts : pair of int
    volume : float or None
        Of their triangles [length unit^3]; None where the triangles of one bound no body.
    depth : float
        How deep they enter each other [length unit].
    why : str
    share : float or None
        The volume over that of the smaller part [-].
    """

    parts: tuple[int, int]
    volume: float | None
    depth: float
    why: str
    share: float | None = None


@dataclass(frozen=True, slots=True)
class Unsupported:
    """A pair that touches in a way that is not modelled yet.

    `kind` is "edge", "vertex" or "curved".
    """

    parts: tuple[int, int]
    kind: str
    point: tuple[float, float, float]


@dataclass(frozen=True, slots=True, eq=False)
class PossibleContacts(Rows):
    """Every force that contacts which are not modelled could bring; one row a force.

    Used to bound a verdict from the other side: what is unstable although all of these
    may push is unstable. Rows with `two_sided` may also pull. `mu` is the friction
    coefficient of the pair; `degenerate` the number of the degenerate point that the row is a
    normal of, -1 for other rows.
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
        """Without the two-sided forces between the parts of some pairs."""
        ends = zip(self.part_a.tolist(), self.part_b.tolist(), strict=True)
        among = np.array([frozenset(pair) in pairs for pair in ends], dtype=bool)
        return self.take(np.flatnonzero(~(among & self.two_sided)))
