"""Candidate line contacts of cylinders and cones that touch along a common generator.

A cone j with the axis a and the half angle alpha has the generators g = a cos(alpha) + w
sin(alpha) with the normals N = w cos(alpha) - a sin(alpha), w any direction across a. Surface i
touches it along a whole generator if it has a generator along the line of g, and the outward normal
+N (inside a hollow cone) or -N (beside a solid cone). The axis of i, in the sense in which it opens
along g (s = 1) or against g (s = -1), then lies in the plane of a and w, at the angle

    alpha_j -+ s alpha_i     from a towards w     (-: inside, +: beside; alpha_i = 0 of a cylinder).

Two equal cones with parallel axes have this angle 0; then w leads to the axis of i.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Index, cross, unit_rows
from kilter.assembly.surfaces import CONE, Surfaces
from kilter.contact.curved.candidates import (
    LINE,
    Candidates,
    FormLimits,
    dot,
    make_candidates,
    without_along,
)

__all__ = ["lines_on_cone"]


def lines_on_cone(s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits) -> Candidates:
    """Candidate line contacts of solid cylinders or cones `i` with cones `j`, solid or hollow.

    Normals lead from i to j.
    """
    return Candidates.join([_lines(s, row, i, j, limits, sense) for sense in (1.0, -1.0)])


def _lines(
    s: Surfaces, row: Index, i: Index, j: Index, limits: FormLimits, sense: float
) -> Candidates:
    """Candidate line contacts of surfaces `i` that open along (1) or against (-1) the generator."""
    inside = np.where(s.hollow[j], 1.0, -1.0)
    own = np.where(s.kind[i] == CONE, s.half_angle[i], 0.0)
    alpha, axis = s.half_angle[j], s.axis[j]
    lean = alpha - sense * inside * own
    opening = sense * s.axis[i]
    aside = without_along(opening, axis)
    angle = np.arctan2(np.linalg.norm(aside, axis=1), dot(opening, axis))
    parallel = np.abs(lean) <= limits.angle
    offset = without_along(s.point[i] - s.point[j], axis)
    out = unit_rows(np.where(parallel[:, None], offset, np.sign(lean)[:, None] * aside))
    cosine, sine = np.cos(alpha)[:, None], np.sin(alpha)[:, None]
    generator = cosine * axis + sine * out
    normal = inside[:, None] * (cosine * out - sine * axis)
    # a point of the generator of i: its apex, or the point of a cylinder farthest along the normal
    point = s.point[i] + np.where(s.kind[i] == CONE, 0.0, s.radius[i])[:, None] * normal
    gap = dot(s.point[j] - point, normal)
    beside = np.abs(dot(point - s.point[j], cross(axis, out)))
    touches = (np.abs(angle - np.abs(lean)) <= limits.angle) & (beside <= limits.gap)
    touches &= np.linalg.norm(out, axis=1) > 0
    # the generator of i with the same normal, by its own axis
    own_axis = s.axis[i]
    own_out = unit_rows(without_along(normal, own_axis))
    line = np.cos(own)[:, None] * own_axis + np.sin(own)[:, None] * own_out
    slope = dot(generator - sense * line, normal)
    k = np.flatnonzero(touches)
    return make_candidates(
        row[k], LINE, (point + (gap / 2)[:, None] * normal)[k], normal[k], gap[k],
        along=generator[k], slope=slope[k],
    )  # fmt: skip
