"""Smallest set of open pairs that decides: if its pairs are joined, equilibrium exists.

A set S of open pairs *holds* if the certain contacts have forces of equilibrium after the parts
of each pair of S are merged into a body (`kilter.mechanics.merged_parts`). If S holds, every
larger set holds, too.

For few open pairs the smallest set is computed by hitting sets. If S does not hold, a motion
remains, and an open pair that this motion moves must stop it. So the pairs that it moves are a
set that every holding set must *hit*: it must contain at least one of them. The next S is the
smallest set that hits all these sets. The first S that holds is therefore the smallest possible.
To make the sets to hit small, pairs are added to S as long as it does not hold.

For many open pairs the result is a set from which no pair can be left out. Only the pairs of a
spanning forest are examined, since joining two parts of the same body changes nothing.
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
"""Largest number of open pairs for which the smallest set is computed. With more open pairs, a set
from which no pair can be left out is computed."""


@dataclass(frozen=True, slots=True)
class DecidingPairs:
    """Open pairs with which equilibrium exists if their parts are joined.

    Attributes
    ----------
    pairs : tuple of OpenPair
    smallest : bool
        Whether it is proved that no smaller set of pairs suffices.
    programs : int
        Number of programs solved.
    """

    pairs: tuple[OpenPair, ...]
    smallest: bool
    programs: int


def find_deciding(
    program: Program, group: Index, pairs: Sequence[OpenPair], *, work: Work | None = None
) -> DecidingPairs | None:
    """Find the open pairs that decide a program whose certain contacts do not hold it.

    Parameters
    ----------
    program : Program
        Program of the certain contacts.
    group : ndarray of int, shape (N,)
        Number of the rigid group of each part; parts that are joined share a number.
    pairs : sequence of OpenPair
        The open pairs.
    work : Work, optional
        The time limit applies.

    Returns
    -------
    DecidingPairs or None
        None if there are no open pairs, if all pairs joined are not proved to hold, or if the
        time limit ended the search.
    """
    ranked = sorted(pairs, key=lambda pair: (KINDS.index(pair.kind), abs(pair.gap or 0.0)))
    search = _Search(program, group, np.array([pair.parts for pair in ranked]).reshape(-1, 2), work)
    everything = frozenset(range(len(ranked)))
    if not pairs or search.holds(everything) is not True:
        return None
    few = len(ranked) <= MOST
    chosen = search.smallest() if few else search.irreducible()
    if chosen is None:
        return None
    deciding = tuple(ranked[k] for k in sorted(chosen))
    return DecidingPairs(deciding, few and not search.doubtful, search.programs)


class _Search:
    """Search over sets of open pairs; each program of merged parts is solved once.

    Pairs are numbered from the likeliest to the least likely contact; `ends` has shape (n, 2).
    `doubtful` is set if a program could not be decided: the set may then not be the smallest.
    """

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
        """Number of the body of each part, from 0, if the chosen pairs are joined; shape (N,)."""
        joined = self.ends[sorted(chosen)].reshape(-1, 2)
        label = connected(
            len(self.program.names),
            np.concatenate([self.first, joined[:, 0]]),
            np.concatenate([self.second, joined[:, 1]]),
        )
        return np.unique(label, return_inverse=True)[1].reshape(-1)

    def judgement_of(self, bodies: Index) -> Judgement:
        """The judgement of the program with merged parts, computed once for each merging."""
        key = bodies.tobytes()
        if key not in self.known:
            self.known[key] = judge(merge_parts(self.program, bodies), work=self.work)
        return self.known[key]

    def holds(self, chosen: Iterable[int]) -> bool | None:
        """Whether forces of equilibrium exist with the chosen pairs joined; None if undecided."""
        return self.judgement_of(self.bodies(chosen)).stable

    def smallest(self) -> frozenset[int] | None:
        """The smallest set that holds, with the likeliest pairs; None if time ran out."""
        to_hit: list[frozenset[int]] = []
        every = frozenset(range(len(self.ends)))
        while self.work is None or not self.work.late:
            chosen = _least_hitting(sorted(every), to_hit)
            holds = self.holds(chosen)
            if holds:
                return chosen
            self.doubtful |= holds is None
            # without a proof that the set fails, it only serves to exclude its own subsets
            to_hit.append(
                every - self._maximal_superset(chosen) if holds is False else every - chosen
            )
        return None

    def _maximal_superset(self, chosen: frozenset[int]) -> frozenset[int]:
        """A maximal superset of a set that does not hold, which does not hold either."""
        every = frozenset(range(len(self.ends)))
        larger = chosen | (every - self._pairs_in_motion(chosen))
        # pairs that the motion leaves at rest cannot stop it; the numbers may still not prove it
        if self.holds(larger) is not False:
            larger = chosen
        for pair in sorted(every - larger):
            if self.holds(larger | {pair}) is False:
                larger |= {pair}
        return larger

    def _pairs_in_motion(self, chosen: frozenset[int]) -> frozenset[int]:
        """Pairs whose parts move relative to each other in the motion that a set leaves."""
        bodies = self.bodies(chosen)
        proof = self.judgement_of(bodies).motion
        if proof is None:
            return frozenset(range(len(self.ends)))
        moves = _moves_apart(merge_parts(self.program, bodies), proof.motion, bodies[self.ends])
        return frozenset(np.flatnonzero(moves).tolist())

    def irreducible(self) -> frozenset[int] | None:
        """A set that holds, but fails if any of its pairs is left out; None if time ran out."""
        forest: list[int] = []
        for k in range(len(self.ends)):  # a spanning forest of the likeliest pairs
            bodies = self.bodies(forest)
            if bodies[self.ends[k, 0]] != bodies[self.ends[k, 1]]:
                forest.append(k)
        chosen = self._irreducible_part([], forest, False)
        return None if self.work is not None and self.work.late else frozenset(chosen)

    def _irreducible_part(
        self, base: list[int], candidates: list[int], base_changed: bool
    ) -> list[int]:
        """An irreducible subset of `candidates` that holds together with `base`.

        First the second half is reduced with the whole first half in the base. Then the first
        half is reduced with the rest of the second. This solves few programs if few pairs are
        needed (U. Junker, QuickXplain, 2004). An unchanged base is known not to hold.
        """
        if base_changed and self.holds(base):
            return []
        if len(candidates) == 1 or (self.work is not None and self.work.late):
            return candidates
        half = (len(candidates) + 1) // 2
        first, second = candidates[:half], candidates[half:]
        later = self._irreducible_part([*base, *first], second, bool(first))
        return self._irreducible_part([*base, *later], first, bool(later)) + later


def _least_hitting(every: Sequence[int], to_hit: Sequence[frozenset[int]]) -> frozenset[int]:
    """The smallest subset of `every` that meets each set, the first in lexicographic order."""
    for size in range(len(every) + 1):
        for members in combinations(every, size):
            chosen = frozenset(members)
            if all(chosen & target for target in to_hit):
                return chosen
    return frozenset(every)


def _moves_apart(program: Program, motion: Array, ends: Index) -> Mask:
    """Mask of the pairs of bodies `ends`, (n, 2), that move relative to each other; shape (n,).

    `motion` has shape (bodies, 6).
    """
    a, b = ends.T
    turn = motion[b, 3:] - motion[a, 3:]
    arm = program.center[b] - program.center[a]
    shift = motion[b, :3] - motion[a, :3] - np.cross(motion[a, 3:], arm)
    size = np.linalg.norm(shift, axis=1) + np.linalg.norm(turn, axis=1) * np.minimum(
        program.radius[a], program.radius[b]
    )
    largest = float(part_sizes(program, motion, per_radius=False).max(initial=0.0))
    moves: Mask = size > STILL * largest
    return moves
