"""Sets of parts as integers, with bit k for part k, for fast comparison of many sets.

A is among B where A & ~B = 0; they have no part in common where A & B = 0.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Index, Mask

__all__ = ["bits_of", "mask_of", "members"]


def bits_of(parts: Mask) -> int:
    """Bit set of the parts in a mask, shape (N,).

    Examples
    --------
    >>> bits_of(np.array([True, False, True]))
    5
    """
    return int.from_bytes(np.packbits(parts, bitorder="little").tobytes(), "little")


def mask_of(bits: int, count: int) -> Mask:
    """Mask, shape (count,), of the parts in a bit set.

    Examples
    --------
    >>> mask_of(5, 3)
    array([ True, False,  True])
    """
    data = np.frombuffer(bits.to_bytes((count + 7) // 8, "little"), dtype=np.uint8)
    return np.unpackbits(data, count=count, bitorder="little").astype(bool)


def members(bits: int, count: int) -> Index:
    """Indices of the parts in a bit set, ascending."""
    return np.flatnonzero(mask_of(bits, count))
