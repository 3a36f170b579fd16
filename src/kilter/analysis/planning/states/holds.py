"""Smallest set of parts to hold so that a half-built assembly stands, by minimum hitting sets.

A set of held parts must hit (share a part with) the moving parts of every motion.

A motion of the parts M that no contact resists continues unless a part of M is held. So the held
parts hit every such set M. A minimum hitting set of the known sets is a lower bound:

    H = least set that hits all M found;  does (S, H) hold?  yes: H is the answer
                                          no: another M, without any part of H

Each M is reduced before use: its parts are held in turn as long as a motion remains. The loop ends
because every M is new. Forces prove that the state holds with H; the motions prove that fewer
held parts are not enough.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from kilter.analysis.planning.states.part_sets import bits_of, mask_of
from kilter.arrays import Mask

__all__ = ["Cut", "Holds", "find_fewest_holds", "least_hitting_set"]


class Judged(Protocol):
    """Interface of a verdict on a state: whether it holds, and which parts move."""

    @property
    def stable(self) -> bool | None:
        """Whether the parts in this state hold; None if undecided."""

    @property
    def moves(self) -> Mask:
        """Mask of the parts that move in a state that falls, shape (N,)."""


Found = TypeVar("Found", bound=Judged)
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

    Parameters
    ----------
    judge : callable
        Function of the masks of present and held parts that returns a state.
    names : tuple of str
    present : ndarray of bool, shape (N,)
        Present parts.
    movable : ndarray of bool, shape (N,)
        Parts that may be held.
    most : int, optional
        Largest number of held parts to consider.
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
    """Reduce the moving parts of a falling state: hold some while the others still fall.

    The first attempt holds half of the untried parts, later attempts a quarter, and so on.
    """
    moves = state.moves.copy()
    needed = np.zeros(len(moves), dtype=bool)
    size = max(int(moves.sum()) // 2, 1)
    while True:
        left = np.flatnonzero(moves & ~needed)
        if not len(left) or moves.sum() < 2:
            break
        size = min(size, max(len(left) // 2, 1))
        held = present & ~moves
        held[left[:size]] = True
        other = judge(present, held)
        if other.stable is False:
            moves = other.moves.copy()
        elif size == 1:
            needed[left[0]] = True
        else:
            size //= 2
    return Cut(moves, judge(present, present & ~moves))


def least_hitting_set(sets: Sequence[int], most: int) -> int | None:
    """A smallest bit set that shares a bit with every given set; None if it exceeds `most`.

    Parameters
    ----------
    sets : sequence of int
        Bit sets (`kilter.analysis.planning.states.part_sets`).
    most : int
        Largest number of members. No set is returned if a given set is empty.

    Examples
    --------
    >>> least_hitting_set([0b011, 0b110], 2), least_hitting_set([0b01, 0b10], 2)
    (2, 3)
    >>> least_hitting_set([0b01, 0b10], 1) is None, least_hitting_set([], 0)
    (True, 0)
    """
    for size in range(most + 1):
        chosen = _hitting(list(sets), size)
        if chosen is not None:
            return chosen
    return None


def _hitting(sets: list[int], size: int) -> int | None:
    """A bit set of at most `size` bits that shares a bit with every given set; else None."""
    if not sets:
        return 0
    if _disjoint(sets) > size:
        return None
    branch = min(sets, key=lambda parts: (parts.bit_count(), parts))
    while branch:
        member = branch & -branch
        branch &= ~member
        rest = _hitting([parts for parts in sets if not parts & member], size - 1)
        if rest is not None:
            return rest | member
    return None


def _disjoint(sets: list[int]) -> int:
    """Number of disjoint sets in a greedy selection: a lower bound for the size of hitting sets."""
    seen = count = 0
    for parts in sorted(sets, key=int.bit_count):
        if not parts & seen:
            seen |= parts
            count += 1
    return count
