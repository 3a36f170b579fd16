"""The last least motion: bodies that the engine left out of balance, or in a slight overlap.

The engine regards a body as still before its gaps are closed to the tolerance of the verification.
The search for the least motion, within a small reach, closes these gaps.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.analysis.chosen_parts import chosen_parts
from kilter.analysis.settled_pose.candidate_points import CandidatePoints
from kilter.analysis.settled_pose.rest import RestResult
from kilter.analysis.settled_pose.rest_search import search_rest
from kilter.analysis.settled_pose.rest_verification import parts_without_rest
from kilter.analysis.settled_pose.rigid_bodies import rigid_bodies

REACH = 1e-3
"""Reach of the search, over the median size of the parts [-]."""


def closed_up(rest: RestResult) -> RestResult | None:
    """The result after the least motion that brings its resting bodies to rest; None without one.

    Bodies that leave the scene or have no pose do not take part.
    """
    bodies, settled = rest.bodies, rest.bodies.assembly()
    chosen = np.flatnonzero(~parts_without_rest(rest))
    free = ~settled.geometry.grounded[chosen]
    if not free.any():
        return None
    sub = settled if len(chosen) == len(settled) else chosen_parts(settled, chosen, [])
    still = ~bodies.moves[bodies.of_part[chosen]] & free
    small = rigid_bodies(sub, [sub.names[k] for k in np.flatnonzero(still).tolist()])
    reach = REACH * float(np.median(sub.geometry.size[free]))
    found = search_rest(
        small, reach=reach, most=None, progress=lambda stage: None,
        near=CandidatePoints.of(small).near,
    )  # fmt: skip
    if found.state != "at-rest" or found.points is None:
        return None
    center, rotation = bodies.center.copy(), bodies.rotation.copy()
    ours, theirs = bodies.of_part[chosen], small.of_part
    moved = small.moves[theirs]
    center[ours[moved]] = found.bodies.center[theirs[moved]]
    rotation[ours[moved]] = found.bodies.rotation[theirs[moved]] @ bodies.rotation[ours[moved]]
    points = found.points
    points = replace(points, part_a=chosen[points.part_a], part_b=chosen[points.part_b])
    return replace(rest, bodies=replace(bodies, center=center, rotation=rotation), points=points)
