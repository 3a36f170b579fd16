"""Smallest sets that suffice, by implicit hitting sets: held parts, supports, straps, open pairs.

A motion proves that a set of members is not enough. It also excludes every other set that does not
take up its power: member k takes up the share a_k, and a set is excluded if its shares sum to less
than the motion needs. Members without a share cannot stop the motion.

    S = smallest set that no known motion excludes;  is S enough?
        yes: S is the answer          no: another motion, which excludes S

The loop ends, since each motion is new. That S is enough is proved by forces, that no smaller set
is by the motions. Before use, the members of a motion are reduced: others are added to the set as
long as a motion remains.

A set that suffices can also be reduced by halves until no member can be left out.

References
----------
U. Junker, QuickXplain: preferred explanations and relaxations for over-constrained problems, 2004.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

Shares = Mapping[int, float]
"""For each member, by number, the share of a motion's power that it takes up."""
ENOUGH = 1 - 1e-3
"""Sum of shares from which members may stop a motion; the remaining power proves nothing [-]."""
Cover = frozenset[int] | None


class _Motion(NamedTuple):
    """A motion that a set must stop: its members with the largest share first, and its need.

    `bits` is the bit set of the members that have a share and are not chosen yet.
    """

    bits: int
    shares: Shares
    members: Sequence[int]
    need: float

    def least(self, closed: int, most: int) -> float:
        """Least number of members outside the bit set `closed` that stop it; inf above `most`."""
        need, count, usable = self.need, 0, self.bits & ~closed
        for k in self.members:
            if need <= 0.0:
                return count
            if usable >> k & 1:
                if count == most:
                    break
                need -= self.shares[k]
                count += 1
        return count if need <= 0.0 else math.inf

    def after(self, member: int) -> _Motion:
        """The motion with a further member chosen."""
        share = self.shares.get(member, 0.0)
        return self._replace(bits=self.bits & ~(1 << member), need=self.need - share)


class TooManySets(Exception):
    """The search for a smallest cover took too many steps; no set below `fewest` is one."""

    def __init__(self, fewest: int) -> None:
        super().__init__(fewest)
        self.fewest = fewest


def least_cover(
    motions: Sequence[Shares],
    most: int,
    *,
    needs: Sequence[float] | None = None,
    fewest: int = 0,
    steps: float = math.inf,
) -> frozenset[int] | None:
    """A smallest set that may stop every given motion; None if it has more than `most` members.

    A motion needs `ENOUGH` or its entry of `needs`; sets below `fewest` are known to be excluded.
    More than `steps` sets raise `TooManySets`.

    Examples
    --------
    >>> sorted(least_cover([{0: 1.0, 1: 1.0}, {1: 1.0, 2: 1.0}], 2))
    [1]
    >>> sorted(least_cover([{k: 0.4 for k in range(5)}], 5))
    [0, 1, 2]
    >>> least_cover([{k: 0.4 for k in range(5)}], 2) is None, least_cover([{}], 3) is None
    (True, True)
    >>> sorted(least_cover([{0: 3.0, 1: -2.0}, {1: 5.0}], 3, needs=[1.0, 2.0]))
    [0, 1]
    """
    rows = []
    for shares, need in zip(motions, needs or [ENOUGH] * len(motions), strict=True):
        helping = sorted((-share, k) for k, share in shares.items() if share > 0.0)
        members = [k for _, k in helping]
        rows.append(_Motion(sum(1 << k for k in members), shares, members, need))
    for size in range(fewest, most + 1):

        def cover(motions: list[_Motion], size: int, closed: int, total: int = size) -> Cover:
            """At most `size` further members outside the bits `closed` that stop all motions."""
            nonlocal steps
            steps -= 1
            if steps < 0:
                raise TooManySets(total)
            left = [motion for motion in motions if motion.need > 0.0]
            if not left:
                return frozenset()
            if _bound(left, size, closed) > size:
                return None
            branch = min(left, key=lambda motion: (motion.bits.bit_count(), motion.bits))
            for member in branch.members:
                if branch.bits & ~closed & (1 << member):
                    rest = cover([motion.after(member) for motion in motions], size - 1, closed)
                    if rest is not None:
                        return rest | {member}
                    closed |= 1 << member
            return None

        found = cover(rows, size, 0)
        if found is not None:
            return found
    return None


def _bound(motions: list[_Motion], size: int, closed: int) -> float:
    """Number of members that motions need, at least; those without common members need their own.

    Infinite if a motion needs more than `size`.
    """
    seen, needed = 0, 0.0
    for motion in sorted(motions, key=lambda motion: motion.bits.bit_count()):
        least = motion.least(closed, size)
        if math.isinf(least):
            return least
        if not motion.bits & seen:
            seen |= motion.bits
            needed += least
    return needed


def least_hitting_set(sets: Sequence[int], most: int) -> int | None:
    """A smallest bit set that shares a bit with every given set; None if it exceeds `most`.

    Examples
    --------
    >>> least_hitting_set([0b011, 0b110], 2), least_hitting_set([0b01, 0b10], 2)
    (2, 3)
    >>> least_hitting_set([0b01, 0b10], 1) is None, least_hitting_set([], 0)
    (True, 0)
    """
    found = least_cover([dict.fromkeys(_members(bits), 1.0) for bits in sets], most)
    return None if found is None else sum(1 << k for k in found)


def _members(bits: int) -> Iterator[int]:
    """The members of a bit set, ascending."""
    while bits:
        yield (bits & -bits).bit_length() - 1
        bits &= bits - 1


def first_hitting_set(sets: Sequence[frozenset[int]], count: int) -> frozenset[int] | None:
    """The first smallest set of 0 ... count - 1, by order, that shares a member with every set.

    Examples
    --------
    >>> sorted(first_hitting_set([frozenset({1, 3}), frozenset({2, 3}), frozenset({0, 1, 2})], 4))
    [0, 3]
    """
    every = [dict.fromkeys(sorted(members), 1.0) for members in sets]
    least = least_cover(every, count)
    if least is None:
        return None
    chosen: frozenset[int] = frozenset()
    for k in range(count):
        hit = chosen | {k}
        left = [{m: 1.0 for m in row if m > k} for row in every if not row.keys() & hit]
        if least_cover(left, len(least) - len(chosen) - 1) is not None:
            chosen = hit
    return chosen


def reduced_by_halves(
    members: set[int], stopped: Callable[[set[int], list[int]], set[int] | None]
) -> set[int]:
    """Reduce the members of which a motion needs one: some stop while a motion remains.

    Arguments: `stopped`: function of the members and those of them that no longer help: the members
    of a motion that remains, a subset of the others; None if none is proved.
    """
    needed: set[int] = set()
    size = max(len(members) // 2, 1)
    while len(members) > 1 and (left := sorted(members - needed)):
        size = min(size, max(len(left) // 2, 1))
        fewer = stopped(members, left[:size])
        if fewer is not None and fewer < members:
            members = fewer
        elif size == 1:
            needed.add(left[0])
        else:
            size //= 2
    return members


def irreducible_subset(
    candidates: list[int], suffices: Callable[[list[int]], bool], ended: Callable[[], bool]
) -> list[int]:
    """Reduce a sufficient set to a sufficient subset of which no member can be left out.

    First the second half is reduced beside the whole first half, then the first half beside the
    rest of the second. The empty set must not suffice, and supersets of sufficient sets must. After
    `ended`, members may be left that are not needed.

    Examples
    --------
    >>> irreducible_subset(list(range(9)), lambda chosen: {2, 5} <= set(chosen), lambda: False)
    [2, 5]
    >>> irreducible_subset([4, 7], lambda chosen: bool(chosen), lambda: True)
    [4, 7]
    """

    def reduced(base: list[int], members: list[int], base_changed: bool) -> list[int]:
        """Members needed beside `base`; an unchanged `base` was found insufficient before."""
        if ended():
            return members
        if base_changed and suffices(base):
            return []
        if len(members) == 1:
            return members
        half = (len(members) + 1) // 2
        first, second = members[:half], members[half:]
        later = reduced([*base, *first], second, bool(first))
        return reduced([*base, *later], first, bool(later)) + later

    return reduced([], candidates, False)
