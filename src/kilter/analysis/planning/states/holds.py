"""The fewest parts that must be held for a state to hold: hitting sets of motions.

A motion of the parts M that nothing resists goes on unless one of M is held. So the parts to
hold hit every such set, and the least hitting set of the sets found is no more than the answer:

    H = least set that hits all M found;  does (S, H) hold?  yes: H is the answer
                                          no: another M, without any part of H

Each M is made smaller first: parts of it are held one by one while a motion is left. The loop
ends, since every M is new; and none of its answers is a guess: that H holds is proved by forces,
that fewer are not enough by the motions.
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
    """What is asked of a state."""

    @property
    def stable(self) -> bool | None:
        """Whether it holds; None: undecided."""

    @property
    def moves(self) -> Mask:
        """Parts that move where it does not, shape (N,)."""


Found = TypeVar("Found", bound=Judged)
Judge = Callable[[Mask, Mask], Found]


@dataclass(frozen=True, slots=True, eq=False)
class Cut(Generic[Found]):
    """Parts of which one must be held, and why.

    Attributes
    ----------
    parts : ndarray of bool, shape (N,)
    state : State
        With these parts alone free: it falls.
    """

    parts: Mask
    state: Found


@dataclass(frozen=True, slots=True, eq=False)
class Holds(Generic[Found]):
    """The fewest parts to hold in a state.

    Attributes
    ----------
    names : tuple of str
        Of all N parts.
    held : ndarray of bool, shape (N,), or None
        A set of fewest parts with which it holds; None where there is none.
    least : int
        No fewer are enough, that is proved. Where `held` is None as well, and no number of the
        parts that may be held is enough, the number of these and one more.
    state : State or None
        The state with them held.
    cuts : tuple of Cut
        Of each set one part must be held.
    undecided : tuple of State
        States that were passed over since they are undecided.
    """

    names: tuple[str, ...]
    held: Mask | None
    least: int
    state: Found | None
    cuts: tuple[Cut[Found], ...]
    undecided: tuple[Found, ...] = ()

    @property
    def parts(self) -> list[str] | None:
        """Names of the parts to hold; None where none are enough."""
        if self.held is None:
            return None
        return [name for name, held in zip(self.names, self.held, strict=True) if held]

    @property
    def fewest(self) -> bool:
        """Whether it is proved that no fewer parts are enough."""
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
    """The fewest parts to hold so that a state holds.

    Parameters
    ----------
    judge : callable
        From the masks of parts present and held to a state.
    names : tuple of str
    present : ndarray of bool, shape (N,)
    movable : ndarray of bool, shape (N,)
        Parts that may be held.
    most : int, optional
        More than these are not asked for.
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
    """The parts of a motion, held while one is left: half of those not tried, a quarter, ..."""
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
    """A smallest set with a member of each of some sets; the first by its members of several.

    Parameters
    ----------
    sets : sequence of int
        As `kilter.analysis.planning.states.part_sets` has them.
    most : int
        Members it may have; None where more are needed, or a set is empty.

    Examples
    --------
    >>> least_hitting_set([0b011, 0b110], 2), least_hitting_set([0b01, 0b10], 2)
    (2, 3)
    >>> least_hitting_set([0b01, 0b10], 1) is None, least_hitting_set([], 0)
    (True, 0)
    """
    for size in range(most + 1):
        found = _hitting(list(sets), size)
        if found is not None:
            return found
    return None


def _hitting(sets: list[int], size: int) -> int | None:
    """A hitting set of at most so many members."""
    if not sets:
        return 0
    if _disjoint(sets) > size:
        return None
    branch = min(sets, key=lambda one: (one.bit_count(), one))
    while branch:
        member = branch & -branch
        branch &= ~member
        rest = _hitting([one for one in sets if not one & member], size - 1)
        if rest is not None:
            return rest | member
    return None


def _disjoint(sets: list[int]) -> int:
    """How many of the sets, taken one after the other, have no member in common."""
    seen = count = 0
    for one in sorted(sets, key=int.bit_count):
        if not one & seen:
            seen |= one
            count += 1
    return count
