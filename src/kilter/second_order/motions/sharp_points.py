"""Sharp points: edges and corners that touch without a unique normal.

If four boxes meet in a line, two of them touch with their edges only. To first order they
penetrate each other iff they approach along every extreme normal of the planes that separate them
there (`kilter.mechanics.degenerate`). Sharp points only forbid motions. So

    a minimum with the certain contacts alone is a minimum with the sharp points
    a motion that opens a normal at all points of a pair separates the pair: openings are linear
    from point to point, and the planes of both ends also separate the parts between them

Their rows are of kind POSSIBLE: a proof has no forces on them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, read_only
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import POSSIBLE, ForceRows, pushing_rows
from kilter.second_order.gaps.stationary import stationary
from kilter.second_order.second_order_tolerances import DROPS

SAME_NORMAL = 9
"""Unit normals are equal if they agree to this number of decimals."""


def sharp_pushes(contacts: ContactSet) -> Mask:
    """Mask of the possible contacts that are normals of sharp points (edges, corners), (k,)."""
    pushes: Mask = (contacts.possible.degenerate >= 0) & ~contacts.possible.two_sided
    return pushes


def with_sharp(program: Program, contacts: ContactSet) -> Program:
    """Copy of a program with extra rows for the normals of sharp points (edges, corners)."""
    possible = contacts.possible
    moves = program.free[possible.part_a] | program.free[possible.part_b]
    pushes = np.flatnonzero(sharp_pushes(contacts) & moves)
    if not len(pushes):
        return program
    rows = pushing_rows(possible.take(pushes), pushes)
    return program.with_force_rows(ForceRows.join([program.force_rows, rows]))


@dataclass(frozen=True, slots=True, eq=False)
class SharpPoints(Rows):
    """Numbers of pair and normal of the sharp points (edges, corners) at K rows; or -1.

    `pair`, shape (K,): number of the pair of parts. `along`, shape (K,): number of the pair and the
    normal, if every sharp point of the pair has that normal, else -1.
    """

    pair: Index
    along: Index

    def __post_init__(self) -> None:
        read_only(self)

    def opened(self, opens: Mask) -> Mask:
        """Mask of rows that open, or whose two parts are separated at a sharp point, shape (K,)."""
        closed = np.isin(self.along, self.along[~opens])
        separated = np.isin(self.pair, self.pair[(self.along >= 0) & ~closed])
        opened: Mask = opens | ((self.pair >= 0) & separated)
        return opened


def sharp_points(program: Program, contacts: ContactSet) -> SharpPoints:
    """Number the sharp points (edges, corners without a unique normal) of a program's rows.

    Points that are only sharp within tolerance have no number: a motion has to open each row.
    """
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
    of_pair = _number_rows(pair[rows][:, None])
    of_normal = _number_rows(np.column_stack([of_pair, normal]))
    at_all_points = _different(number, of_normal) == _different(number, of_pair)
    along[rows] = np.where(at_all_points, of_normal, -1)
    return SharpPoints(pair, along)


def _number_rows(rows: Array | Index) -> Index:
    """Numbers for the rows of an array; equal rows have equal numbers, shape (k,)."""
    return np.asarray(np.unique(rows, axis=0, return_inverse=True)[1]).reshape(-1)


def _different(values: Index, group: Index) -> Index:
    """For each entry, the number of different values in its group, shape (k,)."""
    first = np.unique(_number_rows(np.column_stack([group, values])), return_index=True)[1]
    return np.bincount(group[first])[group]


def opens_points(program: Program, contacts: ContactSet, motion: Array) -> bool:
    """True if a motion, shape (N, 6), separates each pair of parts at all its sharp points.

    `program` has the rows of the sharp points.
    """
    # imported late: only sharp points need these modules
    from kilter.second_order.motions.free_motions import scaled_columns

    problem = stationary(program, np.zeros((len(program.kind), 12, 12)))
    columns = scaled_columns(program, problem, motion[None])[:, 0]
    opens = problem.rows @ columns > DROPS * float(np.linalg.norm(columns))
    opened = sharp_points(program, contacts).opened(opens)
    return bool(opened[program.kind == POSSIBLE].all())
