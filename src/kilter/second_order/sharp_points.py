"""Edges and corners that meet and have no one normal: they push by no form, and may be opened.

Where four boxes meet in a line, two of them touch by their edges alone. They enter each other to
first order iff they come nearer along every extreme normal of the planes that separate them there
(`kilter.mechanics.degenerate`): with such points less is allowed than without. So

    what is a minimum by the certain contacts alone is one with them
    a motion that opens one of the normals at a point parts the two there; and all along a line of
    such points where they do not turn against each other, or one normal is opened at both ends

Their rows are of kind POSSIBLE: no force of a proof is theirs.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, read_only
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import POSSIBLE, ForceRows, pushing_rows
from kilter.second_order.free_span import scaled_columns
from kilter.second_order.second_order_tolerances import DROPS, KEEPS
from kilter.second_order.stationary import stationary

__all__ = [
    "SharpPoints",
    "opens_points",
    "sharp_points",
    "sharp_pushes",
    "turn_alike",
    "with_sharp",
]

SAME_NORMAL = 9
"""Decimals of unit normals that are one."""
MOST_CHOICES = 64
"""Choices of normals that are tried, one of each pair."""


def sharp_pushes(contacts: ContactSet) -> Mask:
    """Those of what is possible that are normals of such points, shape (k,)."""
    pushes: Mask = (contacts.possible.degenerate >= 0) & ~contacts.possible.two_sided
    return pushes


def with_sharp(program: Program, contacts: ContactSet) -> Program:
    """A program of contacts, also with a row for each normal of such points."""
    possible = contacts.possible
    moves = program.free[possible.part_a] | program.free[possible.part_b]
    pushes = np.flatnonzero(sharp_pushes(contacts) & moves)
    if not len(pushes):
        return program
    rows = pushing_rows(possible.take(pushes), pushes)
    return program.with_force_rows(ForceRows.join([program.force_rows, rows]))


@dataclass(frozen=True, slots=True, eq=False)
class SharpPoints(Rows):
    """Such points by the K rows of a program, each (K,); -1 of other rows.

    `point`: the number of the point, where it is one exactly; `pair`: of its two parts; `along`: of
    the rows of this pair and this normal, where every point of the pair has that normal.
    """

    point: Index
    pair: Index
    along: Index

    def __post_init__(self) -> None:
        read_only(self)

    def opened(self, opens: Mask, alike: Mask | bool) -> Mask:
        """Rows that open, or are of points that others open enough, shape (K,).

        Parameters
        ----------
        opens : ndarray of bool, shape (K,)
        alike : ndarray of bool, shape (K,)
            Whether the parts of the row turn alike.
        """
        by_one = alike & (self.point >= 0) & np.isin(self.point, self.point[opens])
        closed = np.isin(self.along, self.along[~opens])
        by_normal = (self.pair >= 0) & np.isin(self.pair, self.pair[(self.along >= 0) & ~closed])
        found: Mask = opens | by_one | by_normal
        return found

    def choices(self, rows: Mask) -> Iterator[Mask]:
        """Some of these rows that it is enough to open: of each pair those of one normal.

        Of up to `MOST_CHOICES` such choices.
        """
        pairs = np.unique(self.pair[rows & (self.along >= 0)])
        normals = [
            np.unique(self.along[rows & (self.pair == one) & (self.along >= 0)]) for one in pairs
        ]
        others = rows & ~np.isin(self.pair, pairs)
        for chosen in itertools.islice(itertools.product(*normals), MOST_CHOICES):
            yield others | (rows & np.isin(self.along, chosen))


def sharp_points(program: Program, contacts: ContactSet) -> SharpPoints:
    """The points of the rows of a program; of those by and large every row is to be opened."""
    point, pair, along = np.full((3, len(program.kind)), -1)
    rows = np.flatnonzero(program.kind == POSSIBLE)
    number = contacts.possible.degenerate[program.source[rows]]
    exact = contacts.degenerate.exact[number]
    rows, number = rows[exact], number[exact]
    point[rows] = number
    parts = np.sort([program.part_a[rows], program.part_b[rows]], axis=0)
    pair[rows] = parts[0] * len(program.names) + parts[1]
    own = np.column_stack([pair[rows], np.round(program.normal[rows], SAME_NORMAL)])
    _, group = np.unique(own, axis=0, return_inverse=True)
    at_each = np.unique(np.column_stack([group, number]), axis=0)[:, 0]
    _, which = np.unique(pair[rows], return_inverse=True)
    ends = np.unique(np.column_stack([which, number]), axis=0)[:, 0]
    everywhere = np.bincount(at_each)[group] == np.bincount(ends)[which] if len(rows) else rows > 0
    along[rows] = np.where(everywhere, group, -1)
    return SharpPoints(point, pair, along)


def opens_points(program: Program, contacts: ContactSet, motion: Array) -> bool:
    """Whether a motion of all parts, shape (N, 6), parts every pair at every such point.

    `program`: with their rows.
    """
    problem = stationary(program, np.zeros((len(program.kind), 12, 12)))
    columns = scaled_columns(program, problem, motion[None])[:, 0]
    opens = problem.rows @ columns > DROPS * float(np.linalg.norm(columns))
    found = sharp_points(program, contacts).opened(opens, turn_alike(program, motion))
    return bool(found[program.kind == POSSIBLE].all())


def turn_alike(program: Program, motion: Array) -> Mask:
    """Rows of contacts whose parts turn alike in a motion (N, 6), to rounding, shape (K,)."""
    a, b = program.part_a, program.part_b
    most = KEEPS * float(np.abs(motion[:, :3]).max(initial=0.0))
    off = np.abs(motion[a, 3:] - motion[b, 3:]).max(axis=1, initial=0.0)
    found: Mask = off * np.maximum(program.radius[a], program.radius[b]) <= most
    return found
