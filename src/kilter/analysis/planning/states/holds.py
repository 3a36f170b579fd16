"""Smallest set of parts to hold so that a half-built assembly stands, by minimum hitting sets.

A motion of the parts M that no contact resists continues unless a part of M is held. So the held
parts must hit (share a part with) every such set M (`kilter.analysis.smallest_set`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from kilter.analysis.smallest_set import least_hitting_set, reduced_by_halves
from kilter.arrays import Index, Mask

# Sets of parts as integers, with bit k for part k, for fast comparison of many sets.


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


class JudgedParts(Protocol):
    """Interface of a verdict on a state: whether it holds, and which parts move."""

    @property
    def stable(self) -> bool | None:
        """Whether the parts in this state hold; None if undecided."""

    @property
    def moves(self) -> Mask:
        """Mask of the parts that move in a state that falls, shape (N,)."""


Found = TypeVar("Found", bound=JudgedParts)
Judge = Callable[[Mask, Mask], Found]


@dataclass(frozen=True, slots=True, eq=False)
class Cut(Generic[Found]):
    """Parts of which at least one must be held, with the falling state that proves this.

    Attributes
    ----------
    parts : ndarray of bool, shape (N,)
    state : State
        State in which only these parts are free; it falls.
    """

    parts: Mask
    state: Found


@dataclass(frozen=True, slots=True, eq=False)
class Holds(Generic[Found]):
    """Fewest parts to hold so that a half-built assembly stands, with the proof of the minimum.

    Attributes
    ----------
    names : tuple of str
        Names of all N parts.
    held : ndarray of bool, shape (N,), or None
        Smallest set of parts with which the state holds; None if no set was found.
    least : int
        Proved lower bound of the number of held parts. If even holding all holdable parts is not
        enough, this is their number plus 1.
    state : State or None
        State with these parts held.
    cuts : tuple of Cut
        Sets of parts; at least one part of each set must be held.
    undecided : tuple of State
        Undecided states that the search skipped.
    """

    names: tuple[str, ...]
    held: Mask | None
    least: int
    state: Found | None
    cuts: tuple[Cut[Found], ...]
    undecided: tuple[Found, ...] = ()

    @property
    def parts(self) -> list[str] | None:
        """Names of the parts to hold; None if no set was found."""
        if self.held is None:
            return None
        return [name for name, held in zip(self.names, self.held, strict=True) if held]

    @property
    def fewest(self) -> bool:
        """Whether it is proved that holding fewer parts is not enough."""
        return self.held is not None and int(self.held.sum()) == self.least

    def __repr__(self) -> str:
        if self.held is None:
            return f"<Holds: none, {self.least} or more are needed>"
        return f"<Holds: {', '.join(self.parts or []) or 'nothing'}>"


def find_fewest_holds(
    judge: Judge[Found],
    names: tuple[str, ...],
    present: Mask,
    movable: Mask,
    *,
    most: int | None = None,
) -> Holds[Found]:
    """Find the fewest parts to hold so that the present parts stand.

    Arguments: `present` (N,): present parts; `movable` (N,): parts that may be held.
    """
    allowed = bits_of(present & movable)
    limit = allowed.bit_count() if most is None else min(most, allowed.bit_count())
    cuts: list[Cut[Found]] = []
    unclear: list[Found] = []
    sets: list[int] = []
    proved: list[int] = []
    while True:
        chosen = least_hitting_set(sets, limit)
        least = least_hitting_set(proved, limit) if unclear else chosen
        bound = limit + 1 if least is None else least.bit_count()
        if chosen is None:
            return Holds(names, None, bound, None, tuple(cuts), tuple(unclear))
        held = mask_of(chosen, len(names))
        state = judge(present, held)
        if state.stable:
            return Holds(names, held, bound, state, tuple(cuts), tuple(unclear))
        if state.stable is None:
            unclear.append(state)
            sets.append(allowed & ~chosen)
            continue
        cut = _smaller(judge, present, state)
        cuts.append(cut)
        sets.append(bits_of(cut.parts) & allowed)
        proved.append(sets[-1])


def _smaller(judge: Judge[Found], present: Mask, state: Found) -> Cut[Found]:
    """Reduce the moving parts of a falling state: hold some while the others still fall."""

    def stopped(moves: set[int], held: list[int]) -> set[int] | None:
        other = judge(present, _but(present, moves.difference(held)))
        return _moving(other) if other.stable is False else None

    moves = reduced_by_halves(_moving(state), stopped)
    held = _but(present, moves)
    free = np.zeros(len(present), dtype=bool)
    free[list(moves)] = True
    return Cut(free, judge(present, held))


def _moving(state: JudgedParts) -> set[int]:
    """Indices of the parts that move in a state that falls."""
    return set(np.flatnonzero(state.moves).tolist())


def _but(present: Mask, moves: set[int]) -> Mask:
    """Mask of the present parts without the given ones."""
    held = present.copy()
    held[list(moves)] = False
    return held
