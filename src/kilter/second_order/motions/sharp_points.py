"""Edges and corners that meet and have no one normal: they push by no form, and may be opened.

Where four boxes meet in a line, two of them touch by their edges alone. They enter each other to
first order iff they come nearer along every extreme normal of the planes that separate them there
(`kilter.mechanics.degenerate`): with such points less is allowed than without. So

    what is a minimum by the certain contacts alone is one with them
    a motion that opens one normal at all points of a pair parts the two: openings are linear along
    a line from point to point, where the planes of its ends separate them, too

Their rows are of kind POSSIBLE: no force of a proof is theirs.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, read_only
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import POSSIBLE, ForceRows, pushing_rows
from kilter.second_order.gaps.stationary import stationary
from kilter.second_order.motions.free_span import scaled_columns
from kilter.second_order.second_order_tolerances import DROPS

__all__ = [
    "SharpPoints",
    "opens_points",
    "sharp_points",
    "sharp_pushes",
    "with_sharp",
]

SAME_NORMAL = 9
"""Decimals of unit normals that are one."""


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

    `pair`: of its two parts; `along`: of the rows of this pair and this normal, where every point
    of the pair has that normal.
    """

    pair: Index
    along: Index

    def __post_init__(self) -> None:
        read_only(self)

    def opened(self, opens: Mask) -> Mask:
        """Rows that open, shape (K,), or are of a pair of which one normal opens at all points."""
        closed = np.isin(self.along, self.along[~opens])
        parted = np.isin(self.pair, self.pair[(self.along >= 0) & ~closed])
        found: Mask = opens | ((self.pair >= 0) & parted)
        return found


def sharp_points(program: Program, contacts: ContactSet) -> SharpPoints:
    """The points of the rows of a program; of those by and large every row is to be opened."""
    pair, along = np.full((2, len(program.kind)), -1)
    rows = np.flatnonzero(program.kind == POSSIBLE)
    number = contacts.possible.degenerate[program.source[rows]]
    exact = contacts.degenerate.exact[number]
    rows, number = rows[exact], number[exact]
    if not len(rows):
        return SharpPoints(pair, along)
    a, b = program.part_a[rows], program.part_b[rows]
    pair[rows] = np.minimum(a, b) * len(program.names) + np.maximum(a, b)
    normal = np.round(program.normal[rows], SAME_NORMAL)
    of_pair = _numbered(pair[rows][:, None])
    of_normal = _numbered(np.column_stack([of_pair, normal]))
    all_have_it = _different(number, of_normal) == _different(number, of_pair)
    along[rows] = np.where(all_have_it, of_normal, -1)
    return SharpPoints(pair, along)


def _numbered(rows: Array | Index) -> Index:
    """A number for each row, shape (k, m), the same for those that are equal, shape (k,)."""
    return np.asarray(np.unique(rows, axis=0, return_inverse=True)[1]).reshape(-1)


def _different(values: Index, group: Index) -> Index:
    """How many different values the group of each row has, shape (k,)."""
    first = np.unique(_numbered(np.column_stack([group, values])), return_index=True)[1]
    return np.bincount(group[first])[group]


def opens_points(program: Program, contacts: ContactSet, motion: Array) -> bool:
    """Whether a motion of all parts, shape (N, 6), parts every pair at every such point.

    `program`: with their rows.
    """
    problem = stationary(program, np.zeros((len(program.kind), 12, 12)))
    columns = scaled_columns(program, problem, motion[None])[:, 0]
    opens = problem.rows @ columns > DROPS * float(np.linalg.norm(columns))
    found = sharp_points(program, contacts).opened(opens)
    return bool(found[program.kind == POSSIBLE].all())
