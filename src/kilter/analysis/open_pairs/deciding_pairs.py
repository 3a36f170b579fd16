"""The smallest set of open pairs that decides: joined, and nothing else, forces exist.

A set S of open pairs *holds* if the certain contacts have forces of equilibrium once the parts
of each of its pairs are the same body (`kilter.mechanics.merged_parts`). A larger set holds, too.

Few open pairs: the smallest set, by hitting sets. A motion that S leaves must be stopped by an
open pair that it moves. So each S that does not hold gives a set of pairs of which every S that
holds has at least one pair; the next S is the smallest that hits all of these, and the first S
that holds is the smallest of all. A set to be hit is made small: pairs are added to S as long as
it does not hold.

Many: a set of which no pair can be left out. Cycles need no search, since joining two parts that
are one body changes nothing: only the pairs of a spanning forest are tried.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from kilter.analysis.decision.judge import Judgement, judge
from kilter.arrays import Array, Index, Mask, connected
from kilter.contact.open_pairs import KINDS, OpenPair
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.mechanics_tolerances import STILL
from kilter.mechanics.merged_parts import merge_parts
from kilter.mechanics.program import Program
from kilter.work import Work

__all__ = ["MOST", "DecidingPairs", "find_deciding"]

MOST = 12
"""Up to so many open pairs the set is the smallest; of more, no pair can be left out."""


@dataclass(frozen=True, slots=True)
class DecidingPairs:
    """Open pairs that, joined, give forces of equilibrium.

    Attributes
    ----------
    pairs : tuple of OpenPair
    smallest : bool
        No smaller set does; else no pair of this set can be left out.
    programs : int
        How many were solved.
    """

    pairs: tuple[OpenPair, ...]
    smallest: bool
    programs: int


def find_deciding(
    program: Program, group: Index, pairs: Sequence[OpenPair], *, work: Work | None = None
) -> DecidingPairs | None:
    """The deciding set of a program that its certain contacts do not hold.

    Parameters
    ----------
    program : Program
        Program of the certain contacts, without open pairs.
    group : ndarray of int, shape (N,)
        Number of the body of each part; parts of the same body share a number.
    pairs : sequence of OpenPair
        Those that are open.
    work : Work, optional
        Its time limit is kept.

    Returns
    -------
    DecidingPairs or None
        None if not even all of them give forces, or the time limit was reached.
    """
    ranked = sorted(pairs, key=lambda one: (KINDS.index(one.kind), abs(one.gap or 0.0)))
    search = _Search(program, group, np.array([one.parts for one in ranked]).reshape(-1, 2), work)
    everything = frozenset(range(len(ranked)))
    if not pairs or search.holds(everything) is not True:
        return None
    few = len(ranked) <= MOST
    chosen = search.smallest() if few else search.irreducible()
    if chosen is None:
        return None
    found = tuple(ranked[k] for k in sorted(chosen))
    return DecidingPairs(found, few and not search.doubtful, search.programs)


class _Search:
    """Programs of merged parts, each solved once."""

    def __init__(self, program: Program, group: Index, ends: Index, work: Work | None) -> None:
        self.program, self.ends, self.work = program, ends, work
        self.first, self.second = np.arange(len(group)), np.unique(group, return_index=True)[1]
        self.second = self.second[np.unique(group, return_inverse=True)[1]]
        self.known: dict[bytes, Judgement] = {}
        self.doubtful = False

    @property
    def programs(self) -> int:
        return len(self.known)

    def bodies(self, chosen: Iterable[int]) -> Index:
        """The body of each part, numbered from 0, when the chosen pairs are joined."""
        joined = self.ends[sorted(chosen)].reshape(-1, 2)
        label = connected(
            len(self.program.names),
            np.concatenate([self.first, joined[:, 0]]),
            np.concatenate([self.second, joined[:, 1]]),
        )
        return np.unique(label, return_inverse=True)[1].reshape(-1)

    def judged(self, bodies: Index) -> Judgement:
        key = bodies.tobytes()
        if key not in self.known:
            self.known[key] = judge(merge_parts(self.program, bodies), work=self.work)
        return self.known[key]

    def holds(self, chosen: Iterable[int]) -> bool | None:
        return self.judged(self.bodies(chosen)).stable

    def smallest(self) -> frozenset[int] | None:
        """The smallest set that holds, the likeliest of them first."""
        to_hit: list[frozenset[int]] = []
        every = frozenset(range(len(self.ends)))
        while self.work is None or not self.work.late:
            chosen = _least_hitting(sorted(every), to_hit)
            holds = self.holds(chosen)
            if holds:
                return chosen
            self.doubtful |= holds is None
            to_hit.append(every - self._grown(chosen) if holds is False else every - chosen)
        return None

    def _grown(self, chosen: frozenset[int]) -> frozenset[int]:
        """The set with as many more pairs as leave it without forces."""
        every = frozenset(range(len(self.ends)))
        grown = chosen | (every - self._stopping(chosen))
        if self.holds(grown) is not False:
            grown = chosen
        for one in sorted(every - grown):
            if self.holds(grown | {one}) is False:
                grown |= {one}
        return grown

    def _stopping(self, chosen: frozenset[int]) -> frozenset[int]:
        """The pairs that the motion of a set moves against each other."""
        bodies = self.bodies(chosen)
        proof = self.judged(bodies).motion
        if proof is None:
            return frozenset(range(len(self.ends)))
        moved = _moved(merge_parts(self.program, bodies), proof.motion, bodies[self.ends])
        return frozenset(np.flatnonzero(moved).tolist())

    def irreducible(self) -> frozenset[int] | None:
        """A set that holds, and does not hold if any of its pairs is left out."""
        kept: list[int] = []
        for k in range(len(self.ends)):  # a spanning forest, of the likeliest pairs
            bodies = self.bodies(kept)
            if bodies[self.ends[k, 0]] != bodies[self.ends[k, 1]]:
                kept.append(k)
        chosen = self._needed([], kept, False)
        return None if self.work is not None and self.work.late else frozenset(chosen)

    def _needed(self, base: list[int], some: list[int], grown: bool) -> list[int]:
        """A subset of `some` that holds with `base` and of which no pair can be left out.

        Divide by halves: the pairs that the second half needs beside the first, then those that the
        first needs beside them: few programs for few pairs (U. Junker, QuickXplain, 2004).
        """
        if grown and self.holds(base):
            return []
        if len(some) == 1 or (self.work is not None and self.work.late):
            return some
        half = (len(some) + 1) // 2
        first, second = some[:half], some[half:]
        later = self._needed([*base, *first], second, bool(first))
        return self._needed([*base, *later], first, bool(later)) + later


def _least_hitting(every: Sequence[int], to_hit: Sequence[frozenset[int]]) -> frozenset[int]:
    """The smallest set with a member of each set, the first in order of its members."""
    for size in range(len(every) + 1):
        for some in combinations(every, size):
            chosen = frozenset(some)
            if all(chosen & one for one in to_hit):
                return chosen
    return frozenset(every)


def _moved(program: Program, motion: Array, ends: Index) -> Mask:
    """Which pairs of bodies, shape (n, 2), a motion moves against each other."""
    a, b = ends.T
    turn = motion[b, 3:] - motion[a, 3:]
    arm = program.center[b] - program.center[a]
    shift = motion[b, :3] - motion[a, :3] - np.cross(motion[a, 3:], arm)
    size = np.linalg.norm(shift, axis=1) + np.linalg.norm(turn, axis=1) * np.minimum(
        program.radius[a], program.radius[b]
    )
    largest = float(part_sizes(program, motion, per_radius=False).max(initial=0.0))
    moved: Mask = size > STILL * largest
    return moved
