"""What a solver offers as a proof, before it is judged."""

from __future__ import annotations

from typing import NamedTuple

from kilter.arrays import Array

__all__ = ["Candidate"]


class Candidate(NamedTuple):
    """Forces along the rows (K,) and across them (K, 3) [N], or a motion (N, 6), or both."""

    word: str
    forces: Array | None = None
    friction: Array | None = None
    motion: Array | None = None
