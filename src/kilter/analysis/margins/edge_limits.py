"""Load limits of parts that tip over round edges, with contact points of the circle as needed.

The corners of a flat contact are an inscribed polygon of its round edge. At a limit at which a part
tips over this edge, the resultant of the contact presses on a chord. The limit is repeated with the
point of the circle at the angle of the resultant, and with two points close beside it, which fix
the tangent. The resultant then lies on the chord between two of these points, at a distance

    r (1 - cos(BESIDE / 2)) = r BESIDE^2 / 8

from the circle, unless the angle has changed; then the limit is repeated again.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from kilter.analysis.load_limit import Limit, NoLimit
from kilter.arrays import Array
from kilter.contact.round_edges import RoundEdge
from kilter.mechanics.certificate import ForceProof
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, ForceRows

__all__ = ["limit_on_circles", "with_edge_points"]

BESIDE = 5e-5
"""Angle between a point of a circle and the points beside it [rad]; larger: a coarser circle."""
STEPS = 6
"""Largest number of repetitions of a limit; the distance to the circle falls with each."""
NEAR_EDGE = 0.9
"""A resultant farther out than this share of the radius presses on the edge [-]; the chords of a
circle of 16 corners are at 0.98."""


def limit_on_circles(
    program: Program, edges: Sequence[RoundEdge], find: Callable[[Program], Limit | NoLimit]
) -> Limit | NoLimit:
    """Compute a load limit, with points of round edges where the resultants press on them."""
    limit = find(program)
    for _ in range(STEPS):
        if isinstance(limit, NoLimit) or limit.motion is None:
            break
        finer = with_edge_points(program, edges, limit.forces)
        if finer is None:
            break
        program, limit = finer, find(finer)
    return limit


def with_edge_points(
    program: Program, edges: Sequence[RoundEdge], proof: ForceProof
) -> Program | None:
    """The program with points of the round edges on which forces press; None if it has them."""
    more = []
    for edge in edges:
        rows = np.flatnonzero((program.kind == CONTACT) & (program.source == edge.patch))
        pressed = proof.forces[rows] if len(rows) else np.zeros(0)
        total = float(pressed.sum())
        if not total > 0.0:
            continue
        arm = pressed @ (program.point[rows] - edge.center) / total
        angle = np.arctan2(arm @ edge.v, arm @ edge.u) + BESIDE * np.array([0.0, 1.0, -1.0])
        if np.linalg.norm(arm) < NEAR_EDGE * edge.radius or not edge.contains(angle).all():
            continue
        if _known(edge, program.point[rows], float(angle[0])):
            continue
        row = program.force_rows.take(rows[:1].repeat(3))
        more.append(replace(row, point=edge.points(angle)))
    if not more:
        return None
    return program.with_force_rows(ForceRows.join([program.force_rows, *more]))


def _known(edge: RoundEdge, points: Array, angle: float) -> bool:
    """Whether points of the circle lie close to an angle, on both sides of it or at it."""
    arm = points - edge.center
    on = np.abs(np.linalg.norm(arm, axis=1) - edge.radius) <= BESIDE * BESIDE * edge.radius
    away = (np.arctan2(arm[on] @ edge.v, arm[on] @ edge.u) - angle + np.pi) % (2 * np.pi) - np.pi
    close = away[np.abs(away) <= 1.01 * BESIDE]
    return bool((close >= 0).any() and (close <= 0).any()) and len(close) > 1
