"""Where the surface of a part is not known: at the holes of an open mesh, all over a stand-in.

What another part meets there nobody can say, so its contacts are open: that is for
`kilter.contact` to say.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, read_only

__all__ = ["UnknownSurfaces"]


@dataclass(frozen=True, slots=True, eq=False)
class UnknownSurfaces(Rows):
    """Boxes, world frame, in which surfaces of parts are not known; one row a place.

    Attributes
    ----------
    part : ndarray of int, shape (n,)
    low, high : ndarray, shape (n, 3)
        Corners of the box [length unit].
    whole : ndarray of bool, shape (n,)
        Nothing of the part's surface is known: its shape is a stand-in.
    """

    part: Index
    low: Array = columns(3)
    high: Array = columns(3)
    whole: Mask = columns()

    def __post_init__(self) -> None:
        read_only(self)

    @classmethod
    def none(cls) -> UnknownSurfaces:
        """No such place."""
        empty = np.empty((0, 3))
        return cls(np.empty(0, np.int64), empty, empty, np.empty(0, dtype=bool))

    def stand_ins(self, count: int) -> Mask:
        """Which of `count` parts are stand-ins, shape (count,)."""
        found = np.zeros(count, dtype=bool)
        found[self.part[self.whole]] = True
        return found
