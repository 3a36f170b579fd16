"""Degenerate points in a program: which pushes a given motion must be held against.

At a degenerate point p (a ridge on a ridge, a corner on an edge) a velocity v of part b
relative to part a makes them enter each other to first order iff v.m < 0 for every extreme
normal m of the planes that separate them there (`kilter.contact.sharp.spanning`). So a motion is
allowed at p iff its opening along at least one m is not below zero, and the allowed motions
are a union of cones, one a choice of m at every point.

Along a line of such points from p to q the planes that separate the parts include those of
both ends, and the opening along each m is linear: the greatest of them is convex, so that
it is enough to ask where two of them are equal.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from kilter.arrays import Array, Index, cross
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet, PossibleContacts
from kilter.mechanics.mechanics_tolerances import NORMAL_ANGLE
from kilter.mechanics.program import Program, bounding_program
from kilter.mechanics.rows import POSSIBLE, ForceRows, pushing_rows

__all__ = ["MOST", "allowed_program", "between", "openings", "with_pushes", "without_degenerate"]


MOST = 64
"""With more degenerate points than this their pushes are all counted, none is chosen."""


def with_pushes(program: Program, pushes: PossibleContacts) -> Program:
    """The program with further rows that push, of kind POSSIBLE."""
    return program.with_force_rows(ForceRows.join([program.force_rows, pushing_rows(pushes)]))


def without_degenerate(assembly: Assembly, contacts: ContactSet) -> Program:
    """Every force there may be but those at degenerate points that are so exactly."""
    outer = bounding_program(assembly, contacts)
    exact = np.append(contacts.degenerate.exact, False)[contacts.possible.degenerate]
    pushes = np.flatnonzero((outer.kind == POSSIBLE) & ~outer.two_sided)
    return outer.taking(np.delete(np.arange(len(outer.kind)), pushes[exact[outer.source[pushes]]]))


def openings(program: Program, pushes: PossibleContacts, motion: Array) -> Array:
    """Opening of each push for a motion of all parts, shape (n,).

    Parameters
    ----------
    program : Program
    pushes : PossibleContacts
    motion : ndarray, shape (N, 6)
        Displacements, or accelerations, of all parts: (dr, dtheta).
    """
    velocity = np.zeros((len(pushes), 3))
    for part, sign in ((pushes.part_b, 1.0), (pushes.part_a, -1.0)):
        arm = pushes.points - program.center[part]
        velocity += sign * (motion[part, :3] + cross(motion[part, 3:], arm))
    opening: Array = np.einsum("ij,ij->i", velocity, pushes.normals)
    return opening


def between(program: Program, contacts: ContactSet, motion: Array) -> list[PossibleContacts]:
    """Points between a degenerate point and the ends of its lines where a motion might enter.

    Wherever two points of a pair lie across all normals of one of them, a line of contact is
    thought between. At each point found: a push along each normal of either end.

    Parameters
    ----------
    program : Program
    contacts : ContactSet
    motion : ndarray, shape (N, 6)
        Displacements, or accelerations, of all parts: (dr, dtheta).
    """
    lines = _lines(contacts)
    if not lines:
        return []
    sizes = [len(line.normals) for line in lines]
    normals = np.concatenate([line.normals for line in lines])
    parts = np.repeat([line.pair for line in lines], sizes, axis=0)
    opening = [
        np.split(
            openings(program, _at(parts.T, np.repeat(ends, sizes, axis=0), normals), motion),
            np.cumsum(sizes)[:-1],
        )
        for ends in ([line.here for line in lines], [line.end for line in lines])
    ]
    found: list[PossibleContacts] = []
    for line, here, end in zip(lines, *opening, strict=True):
        for k, m in combinations(range(len(here)), 2):
            apart = here[k] - here[m], end[k] - end[m]
            if apart[0] * apart[1] < 0:
                share = apart[0] / (apart[0] - apart[1])
                point = line.here + share * (line.end - line.here)
                found.append(_at(line.pair, point, line.normals))
    return found


class _Line(NamedTuple):
    """A line of contact from one degenerate point, and the normals of both its ends."""

    pair: Index
    here: Array
    end: Array
    normals: Array


def _lines(contacts: ContactSet) -> list[_Line]:
    """Where two points of a pair lie across all normals of one of them."""
    points = contacts.degenerate
    own = np.column_stack([points.part_a, points.part_b])
    pairs = np.concatenate([own[points.owner], points.held_parts])
    ends = np.concatenate([points.points[points.owner], points.held_points])
    normals = np.concatenate([points.normals, points.held_normals])
    found = []
    for k in np.flatnonzero(points.exact).tolist():
        here, mine = points.points[k], points.normals[points.start[k] : points.start[k + 1]]
        along = ends - here
        length = np.linalg.norm(along, axis=1)
        level = np.abs(along @ mine.T).max(axis=1) <= NORMAL_ANGLE * length
        level &= (pairs == own[k]).all(axis=1) & (length > 0)
        for end in np.unique(ends[level], axis=0):
            there = normals[level & (ends == end).all(axis=1)]
            found.append(_Line(own[k], here, end, np.vstack([mine, there])))
    return found


def _at(pair: Index, point: Array, normals: Array) -> PossibleContacts:
    """Pushes along each of some normals: of one pair at one point, or of one of each a push."""
    count = len(normals)
    none = np.zeros(count)
    where = np.array(np.broadcast_to(point, (count, 3)))
    return PossibleContacts(
        np.full(count, pair[0]), np.full(count, pair[1]), where, normals, none > 0, none,
        np.full(count, -1),
    )  # fmt: skip


def allowed_program(assembly: Assembly, contacts: ContactSet, motion: Array) -> Program | None:
    """The pushes that a motion, shape (N, 6), must be held against; None: too many points.

    At each degenerate point, and between those of a line, the one of its normals along
    which the motion opens most: if it enters along none of these rows, it is allowed.
    """
    points = contacts.degenerate
    if len(points) > MOST:
        return None
    program = without_degenerate(assembly, contacts)
    pushes = points.pushes()
    opening = openings(program, pushes, motion)
    rows = [
        int(start + opening[start:end].argmax())
        for start, end, exact in zip(points.start[:-1], points.start[1:], points.exact, strict=True)
        if exact
    ]
    program = with_pushes(program, pushes.take(np.array(rows, dtype=np.int64)))
    for some in between(program, contacts, motion):
        best = int(openings(program, some, motion).argmax())
        program = with_pushes(program, some.take(np.array([best])))
    return program
