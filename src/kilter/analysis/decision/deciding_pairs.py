"""Smallest set of open pairs whose joining makes an equilibrium possible.

A set S of open pairs *holds* if the certain contacts have forces of equilibrium after the parts
of each pair of S are merged into a body (`kilter.mechanics.locked_parts`). If S holds, every
larger set holds, too.

For few open pairs the smallest set is computed by hitting sets (`kilter.analysis.smallest_set`). If
S does not hold, a motion remains, and every holding set contains a pair that this motion moves.

For many open pairs the search begins with the pairs that the motion must be stopped by
(`joining_wrenches`). This set is reduced by halves until no pair can be left out. Only the pairs of
a spanning forest are examined, since joining two parts of the same body changes nothing.

The work is counted in rows of programs, and is at most that of `JUDGEMENTS` judgements of the
assembly. If the search stops there, the set so far is reported; it holds, but may be reducible.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, hstack, vstack

from kilter.analysis.decision.judge import Judgement, judge
from kilter.analysis.smallest_set import first_hitting_set, irreducible_subset, reduced_by_halves
from kilter.arrays import Array, Index, Mask, connected, cross
from kilter.contact.open_pairs import KINDS, OpenPair
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.coulomb_cones import ConeProblem, cone_problem
from kilter.mechanics.locked_parts import merge_parts
from kilter.mechanics.mechanics_tolerances import STILL
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram
from kilter.work import Work

# Least wrenches between the parts of open pairs that, with the contact forces, balance the parts.


COARSE = 1e-5
"""Requested gap of the conic program. It only proposes pairs, whose sets are judged afterwards; a
smaller gap takes up to five times as long and proposes the same pairs.
"""


def joining_wrenches(program: Program, ends: Index, *, work: Work | None = None) -> Array | None:
    """Size of the smallest wrench that each pair must transmit so that all parts balance.

    None if the solver fails.

    Arguments: `ends` (P, 2): the two parts of each pair. Returns (P,): in multiples of the typical
    weight of a part [-]; None if the solver found no optimum.
    """
    from kilter.solvers.clarabel import solve_conic

    wide = cone_problem(program)
    answer = solve_conic(_least_wrenches(wide, ends), tolerance=COARSE, work=work)
    if not answer.found:
        return None
    wrenches = answer.x[wide.problem.matrix.shape[1] :][: 6 * len(ends)]
    norms: Array = np.linalg.norm(wrenches.reshape(-1, 6), axis=1)
    return norms


def _least_wrenches(wide: ConeProblem, ends: Index) -> ConicProgram:
    """The conic program for the least joining wrenches; x = (f, u of each pair, |u| of each pair).

    f are the contact forces, u the wrench between the parts of a pair.
    """
    problem, count = wide.problem, len(ends)
    total = problem.matrix.shape[1]
    cone_matrix, positive, sizes = wide.cone_rows()
    size = total + 7 * count
    wrenches = _wrench_columns(wide, ends)
    balance, equal = wide.balance(wrenches, csc_array((wrenches.shape[0], count)))
    conic = hstack([-cone_matrix, csc_array((cone_matrix.shape[0], 7 * count))])
    # the cone of pair p: its norm, then its wrench
    norms = total + 6 * count + np.arange(count)[:, None]
    column = np.hstack([norms, total + np.arange(6 * count).reshape(-1, 6)]).reshape(-1)
    rows = np.arange(7 * count)
    norm_rows = csc_array((np.full(7 * count, -1.0), (rows, column)), shape=(7 * count, size))
    matrix = vstack([balance, conic, norm_rows], format="csc")
    bound = np.concatenate([problem.right, np.zeros(equal), wide.heads, np.zeros(7 * count)])
    cost = np.zeros(size)
    cost[total + 6 * count :] = 1.0 + np.arange(count) / count
    cones = np.concatenate([sizes, np.full(count, 7, dtype=sizes.dtype)])
    no_quadratic = csc_array((size, size))
    return ConicProgram(no_quadratic, cost, matrix, bound, balance.shape[0], positive, cones)


def _wrench_columns(wide: ConeProblem, ends: Index) -> csc_array:
    """Matrix W, shape (freedoms, 6 P), of a unit wrench of each pair on its second part.

    The wrench acts at the centre of the smaller part, whose radius is rho, in the frame of the
    scaled problem.
    """
    problem, program = wide.problem, wide.program
    free, per = program.free, len(program.freedoms)
    place = np.full(len(free), -1)
    place[free] = np.arange(int(free.sum()))
    a, b = ends.T
    smaller = np.where(program.radius[a] <= program.radius[b], a, b)
    rho = program.radius[smaller]
    row, column, value = [], [], []
    for part, sign in ((a, -1.0), (b, 1.0)):
        pairs = np.flatnonzero(place[part] >= 0)
        i = part[pairs]
        arm = (program.center[smaller[pairs]] - program.center[i]) @ problem.frame.T
        block = np.zeros((len(pairs), 6, 6))
        block[:, np.arange(6), np.arange(6)] = 1.0
        for axis in range(3):
            block[:, 3:, axis] = cross(arm, np.broadcast_to(np.eye(3)[axis], arm.shape))
        block[:, 3:, 3:] *= rho[pairs, None, None]
        block[:, 3:] /= program.radius[i, None, None]
        block *= (sign * problem.unit / program.weight[i])[:, None, None]
        block = block[:, program.freedoms]
        rows = place[i][:, None] * per + np.arange(per)
        columns = pairs[:, None] * 6 + np.arange(6)
        row.append(np.broadcast_to(rows[:, :, None], block.shape).reshape(-1))
        column.append(np.broadcast_to(columns[:, None, :], block.shape).reshape(-1))
        value.append(block.reshape(-1))
    shape = (problem.matrix.shape[0], 6 * len(ends))
    index = np.concatenate(row), np.concatenate(column)
    return csc_array((np.concatenate(value), index), shape=shape)


MOST = 12
"""Largest number of open pairs for which the smallest set is computed. With more open pairs, a set
from which no pair can be left out is computed."""
JUDGEMENTS = 3
"""Largest work of a search, in judgements of the whole assembly."""
PROGRAMS = 3
"""Programs of a judgement: without friction, with friction, and with the forces of open pairs."""
LEAST_ROWS = 100
"""Cost of building a program, expressed as a number of contact rows."""
FREE_ROWS = 50_000
"""Rows that each search may solve, however small the assembly; they take about a second."""
WIDE_CLEARANCE = 0.02
"""A clearance is too wide for a fit above this fraction of the radius of the smaller part [-]. The
loosest fit H11/c11 of ISO 286 has a radial clearance of 2 to 4 % of the radius of a shaft of 6 to
30 mm, and parts are at least as long as wide."""
WRENCHES = (1e-2, 1e-6)
"""Pairs with a wrench above this are joined, in multiples of the typical weight [-]. The second
value serves if the first set does not hold."""


@dataclass(frozen=True, slots=True)
class DecidingPairs:
    """Open pairs that make an equilibrium possible if their parts are joined.

    `smallest` and `irreducible` state what is proved: that no smaller set suffices, and that none
    of the pairs can be left out. `programs` is the number of programs solved.
    """

    pairs: tuple[OpenPair, ...]
    smallest: bool
    irreducible: bool
    programs: int


def find_deciding(
    program: Program, group: Index, pairs: Sequence[OpenPair], *, work: Work | None = None
) -> DecidingPairs | None:
    """Find open pairs whose joining holds an assembly that its certain contacts do not hold.

    None if there are no open pairs, or if all pairs joined are not proved to hold. `program` has
    the certain contacts; parts that are joined share a number in `group`, shape (N,).
    """
    ranked = sorted(pairs, key=lambda pair: _unlikeliness(pair, program.radius))
    ends = np.array([pair.ends for pair in ranked]).reshape(-1, 2)
    search = _PairSearch(program, group, ends, work)
    if not pairs or search.holds(range(len(ranked))) is not True:
        return None
    chosen = search.smallest() if len(ranked) <= MOST else None
    smallest = chosen is not None and not search.doubtful
    irreducible = smallest
    if chosen is None:
        search.doubtful = False
        chosen = search.irreducible()
        irreducible = not search.ended and not search.doubtful
    deciding = tuple(ranked[k] for k in sorted(chosen))
    return DecidingPairs(deciding, smallest, irreducible, search.programs)


def _unlikeliness(pair: OpenPair, radius: Array) -> tuple[bool, int, float]:
    """Key that sorts open pairs from the likeliest contact to the least likely.

    A clearance too wide for a fit comes last: a shaft there touches its hole only by chance.
    """
    gap = abs(pair.gap or 0.0)
    wide = pair.kind == "clearance" and gap > WIDE_CLEARANCE * radius[list(pair.ends)].min()
    return bool(wide), KINDS.index(pair.kind), gap


class _PairSearch:
    """Search over sets of open pairs; each program with joined parts is solved once.

    Pairs are numbered from the likeliest to the least likely contact; `ends` has shape (n, 2).
    `doubtful` is set if a program could not be decided: the set may then not be the smallest.
    `rows_left`: rows of programs that may still be solved.
    """

    def __init__(self, program: Program, group: Index, ends: Index, work: Work | None) -> None:
        self.program, self.ends, self.work = program, ends, work
        self.first, self.second = np.arange(len(group)), np.unique(group, return_index=True)[1]
        self.second = self.second[np.unique(group, return_inverse=True)[1]]
        self.known: dict[bytes, Judgement] = {}
        self.doubtful = False
        judgement = PROGRAMS * len(program.part_a) + 6 * len(ends)
        self.rows_left = max(JUDGEMENTS * judgement, FREE_ROWS)

    @property
    def programs(self) -> int:
        return len(self.known)

    @property
    def ended(self) -> bool:
        """Whether the work or the time limit is used up."""
        return self.rows_left <= 0 or (self.work is not None and self.work.late)

    def bodies(self, chosen: Iterable[int]) -> Index:
        """Index of each part's body, from 0, if the chosen pairs are joined; shape (N,)."""
        joined = self.ends[sorted(chosen)].reshape(-1, 2)
        label = connected(
            len(self.program.names),
            np.concatenate([self.first, joined[:, 0]]),
            np.concatenate([self.second, joined[:, 1]]),
        )
        return np.unique(label, return_inverse=True)[1].reshape(-1)

    def judgement_of(self, bodies: Index) -> Judgement:
        """Judge the program with parts merged into bodies; each merging is judged once."""
        key = bodies.tobytes()
        if key not in self.known:
            merged = merge_parts(self.program, bodies)
            self.rows_left -= len(merged.part_a) + LEAST_ROWS
            self.known[key] = judge(merged, work=self.work)
        return self.known[key]

    def holds(self, chosen: Iterable[int]) -> bool | None:
        """Whether forces can balance the parts with the chosen pairs joined; None if undecided."""
        return self.judgement_of(self.bodies(chosen)).stable

    def smallest(self) -> frozenset[int] | None:
        """The smallest set of pairs that holds the assembly if joined; None if unfinished.

        Among sets of equal size, likelier pairs are preferred.
        """
        to_hit: list[frozenset[int]] = []
        every = frozenset(range(len(self.ends)))
        while not self.ended:
            chosen = first_hitting_set(to_hit, len(every)) or frozenset()
            holds = self.holds(chosen)
            if holds:
                return chosen
            self.doubtful |= holds is None
            # without a proof that the set fails, it only serves to exclude its own subsets
            to_hit.append(self._stopping(every - chosen) if holds is False else every - chosen)
        return None

    def _stopping(self, absent: frozenset[int]) -> frozenset[int]:
        """Few of the absent pairs, of which a holding set contains one: they stop a motion."""
        every = frozenset(range(len(self.ends)))

        def stopped(absent: set[int], joined: list[int]) -> set[int] | None:
            left = absent.difference(joined)
            return None if self.ended or self.holds(every - left) is not False else left

        moved = absent & self._pairs_in_motion(every - absent)
        # pairs that the motion leaves at rest cannot stop it; the numbers may still not prove it
        start = moved if self.holds(every - moved) is False else absent
        return frozenset(reduced_by_halves(set(start), stopped))

    def _pairs_in_motion(self, chosen: frozenset[int]) -> frozenset[int]:
        """Pairs that move apart if only the chosen pairs are joined; all pairs without a proof."""
        bodies = self.bodies(chosen)
        proof = self.judgement_of(bodies).motion
        if proof is None:
            return frozenset(range(len(self.ends)))
        moves = _moves_apart(merge_parts(self.program, bodies), proof.motion, bodies[self.ends])
        return frozenset(np.flatnonzero(moves).tolist())

    def irreducible(self) -> frozenset[int]:
        """A set of pairs that holds if joined, none of which can be left out.

        Some can, if the search ended early.
        """

        def suffices(chosen: list[int]) -> bool:
            holds = self.holds(chosen)
            self.doubtful |= holds is None
            return holds is True

        return frozenset(irreducible_subset(self._start(), suffices, lambda: self.ended))

    def _start(self) -> list[int]:
        """A set of pairs that holds if joined, to be reduced: pairs with wrenches, else all."""
        norms = None
        if not self.ended:
            self.rows_left -= len(self.program.part_a) + 6 * len(self.ends)
            norms = joining_wrenches(self.program, self.ends, work=self.work)
        if norms is not None:
            for least in WRENCHES:
                forest = self._forest(np.flatnonzero(norms > least).tolist())
                if self.holds(forest):
                    return forest
        return self._forest(range(len(self.ends)))

    def _forest(self, pairs: Iterable[int]) -> list[int]:
        """The given pairs without those whose two bodies are already joined by earlier pairs."""
        root = self.bodies([]).tolist()

        def body(part: int) -> int:
            while root[part] != part:
                root[part] = root[root[part]]
                part = root[part]
            return part

        # each part points to a part of its body, which points to itself
        root = np.unique(root, return_index=True)[1][root].tolist()
        forest = []
        for k in pairs:
            a, b = (body(part) for part in self.ends[k].tolist())
            if a != b:
                root[b] = a
                forest.append(k)
        return forest


def _moves_apart(program: Program, motion: Array, ends: Index) -> Mask:
    """Mask of pairs of bodies, shape (n,), whose two bodies move relative to each other.

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
