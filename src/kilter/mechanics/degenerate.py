"""Rows that a given motion must satisfy at degenerate contact points (edge on edge, corner).

At a degenerate point p (an edge on a parallel edge, a corner on an edge) a velocity v of part b
relative to part a makes the parts penetrate to first order iff v.m < 0 for every extreme normal m
of the planes that separate them at p (`kilter.contact.sharp.normals`). So a motion is admissible
at p iff its opening along at least one m is not negative. The admissible motions are a union of
cones, each for a choice of m at every point.

Along a line of degenerate points from p to q, the separating planes include those of both ends, and
the opening along each m is linear. The largest opening is convex along the line, so it suffices to
check the points at which two openings are equal.
"""

from __future__ import annotations

from itertools import combinations
from typing import NamedTuple

import numpy as np

from kilter.arrays import Array, Index, cross
from kilter.assembly import Assembly
from kilter.contact.common.patches import PossibleContacts
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.mechanics_tolerances import NORMAL_ANGLE
from kilter.mechanics.program import Program, bounding_program
from kilter.mechanics.rows import POSSIBLE, ForceRows, pushing_rows

MOST = 64
"""Largest number of degenerate points for which a normal is chosen at each point; with more points,
all normals count. A larger value admits more motions at more cost.
"""


def with_pushes(program: Program, pushes: PossibleContacts) -> Program:
    """Copy of a program with extra one-sided rows: pushes that unmodelled contacts may exert."""
    return program.with_force_rows(ForceRows.join([program.force_rows, pushing_rows(pushes)]))


def without_degenerate(assembly: Assembly, contacts: ContactSet) -> Program:
    """Program of all possible contact forces, but no pushes at points without a unique normal.

    Points that are degenerate only within the tolerance keep their forces.
    """
    outer = bounding_program(assembly, contacts)
    exact = np.append(contacts.degenerate.exact, False)[contacts.possible.degenerate]
    pushes = np.flatnonzero((outer.kind == POSSIBLE) & ~outer.two_sided)
    return outer.taking(np.delete(np.arange(len(outer.kind)), pushes[exact[outer.source[pushes]]]))


def openings(program: Program, pushes: PossibleContacts, motion: Array) -> Array:
    """Opening velocity along each possible push if the parts move by `motion`, shape (n,).

    Arguments: `motion` (N, 6): displacements, or accelerations, of all parts: (dr, dtheta).
    """
    velocity = np.zeros((len(pushes), 3))
    for part, sign in ((pushes.part_b, 1.0), (pushes.part_a, -1.0)):
        arm = pushes.points - program.center[part]
        velocity += sign * (motion[part, :3] + cross(motion[part, 3:], arm))
    opening: Array = np.einsum("ij,ij->i", velocity, pushes.normals)
    return opening


def between(program: Program, contacts: ContactSet, motion: Array) -> list[PossibleContacts]:
    """Points inside contact lines that a motion may penetrate, with pushes along each normal.

    A line of contact is assumed between two points of a pair if it is perpendicular to all normals
    of its start. Each result holds a push for every normal of either end, at the same point.

    Parameters
    ----------
    program : Program
    contacts : ContactSet
    motion : ndarray, shape (N, 6)
        Displacements, or accelerations, of all parts: (dr, dtheta).
    """
    lines = _contact_lines(contacts)
    if not lines:
        return []
    sizes = [len(line.normals) for line in lines]
    normals = np.concatenate([line.normals for line in lines])
    parts = np.repeat([line.pair for line in lines], sizes, axis=0)
    opening = [
        np.split(
            openings(
                program, _pushes_along(parts.T, np.repeat(ends, sizes, axis=0), normals), motion
            ),
            np.cumsum(sizes)[:-1],
        )
        for ends in ([line.here for line in lines], [line.end for line in lines])
    ]
    crossings: list[PossibleContacts] = []
    for line, here, end in zip(lines, *opening, strict=True):
        for k, m in combinations(range(len(here)), 2):
            difference = here[k] - here[m], end[k] - end[m]
            # two openings are equal inside the line: a possible minimum of the largest opening
            if difference[0] * difference[1] < 0:
                share = difference[0] / (difference[0] - difference[1])
                point = line.here + share * (line.end - line.here)
                crossings.append(_pushes_along(line.pair, point, line.normals))
    return crossings


class _Line(NamedTuple):
    """A line of contact that starts at a degenerate point: its ends, and the normals at both."""

    pair: Index
    here: Array
    end: Array
    normals: Array


def _contact_lines(contacts: ContactSet) -> list[_Line]:
    """Lines of contact from degenerate points, perpendicular to every normal at the start."""
    points = contacts.degenerate
    point_pairs = np.column_stack([points.part_a, points.part_b])
    pairs = np.concatenate([point_pairs[points.owner], points.held_parts])
    ends = np.concatenate([points.points[points.owner], points.held_points])
    normals = np.concatenate([points.normals, points.held_normals])
    lines = []
    for k in np.flatnonzero(points.exact).tolist():
        here, start_normals = (
            points.points[k],
            points.normals[points.start[k] : points.start[k + 1]],
        )
        along = ends - here
        length = np.linalg.norm(along, axis=1)
        perpendicular = np.abs(along @ start_normals.T).max(axis=1) <= NORMAL_ANGLE * length
        perpendicular &= (pairs == point_pairs[k]).all(axis=1) & (length > 0)
        for end in np.unique(ends[perpendicular], axis=0):
            end_normals = normals[perpendicular & (ends == end).all(axis=1)]
            lines.append(_Line(point_pairs[k], here, end, np.vstack([start_normals, end_normals])))
    return lines


def _pushes_along(pair: Index, point: Array, normals: Array) -> PossibleContacts:
    """Possible pushes along `normals`, shape (n, 3), at a common point or at a point for each."""
    count = len(normals)
    zeros = np.zeros(count)
    points = np.array(np.broadcast_to(point, (count, 3)))
    return PossibleContacts(
        np.full(count, pair[0]), np.full(count, pair[1]), points, normals, zeros > 0, zeros,
        np.full(count, -1),
    )  # fmt: skip


def allowed_program(assembly: Assembly, contacts: ContactSet, motion: Array) -> Program | None:
    """Program that keeps at each degenerate point only the normal along which a motion opens most.

    At each degenerate point, and at each intermediate point of a line, the row is that of the
    normal along which the motion opens most: a motion that violates none of these rows is
    admissible. Returns None if there are more than `MOST` points.
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
    for crossing in between(program, contacts, motion):
        widest = int(openings(program, crossing, motion).argmax())
        program = with_pushes(program, crossing.take(np.array([widest])))
    return program
