"""Edges and corners that meet and have no one normal: they push by no form, and may be opened.

Where four boxes meet in a line, two of them touch by their edges alone. They enter each other to
first order iff they come nearer along every extreme normal of the planes that separate them there
(`kilter.mechanics.degenerate`): with such points less is allowed than without. So

    what is a minimum by the certain contacts alone is one with them
    a motion that opens one of the normals at a point parts the two there, and all along a line
    of such points where the two do not turn against each other; else it has to open all

Their rows are of kind POSSIBLE: no force of a proof is theirs.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import POSSIBLE, ForceRows, pushing_rows
from kilter.second_order.second_order_tolerances import KEEPS

__all__ = ["opened", "sharp_points", "sharp_pushes", "turn_alike", "with_sharp"]


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


def sharp_points(program: Program, contacts: ContactSet) -> Index:
    """The point of each row, shape (K,); -1 of certain contacts and of points by and large."""
    found = np.full(len(program.kind), -1)
    rows = np.flatnonzero(program.kind == POSSIBLE)
    point = contacts.possible.degenerate[program.source[rows]]
    found[rows] = np.where(contacts.degenerate.exact[point], point, -1)
    return found


def opened(opens: Mask, points: Index, alike: Mask | bool) -> Mask:
    """Rows that open, or are of a point that another normal opens, shape (K,).

    Parameters
    ----------
    opens : ndarray of bool, shape (K,)
    points : ndarray of int, shape (K,)
        As `sharp_points` has them.
    alike : ndarray of bool, shape (K,)
        Whether the parts of the row turn alike.
    """
    by_one: Mask = (points >= 0) & np.isin(points, points[opens])
    return opens | (alike & by_one)


def turn_alike(program: Program, motion: Array) -> Mask:
    """Rows of contacts whose parts turn alike in a motion (N, 6), to rounding, shape (K,)."""
    a, b = program.part_a, program.part_b
    most = KEEPS * float(np.abs(motion[:, :3]).max(initial=0.0))
    off = np.abs(motion[a, 3:] - motion[b, 3:]).max(axis=1, initial=0.0)
    found: Mask = off * np.maximum(program.radius[a], program.radius[b]) <= most
    return found
