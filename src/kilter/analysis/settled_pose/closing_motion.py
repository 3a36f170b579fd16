"""The least motion that brings bodies to rest that overlap or are apart by little.

Bodies of a simulator are sunk into each other by little, so the search for the least motion comes
first. It comes last, too: the engine regards a body as still before its gaps are closed to the
tolerance of the verification.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from kilter.analysis.chosen_parts import chosen_parts
from kilter.analysis.settled_pose.candidate_points import CandidatePoints
from kilter.analysis.settled_pose.near_points import NearPoints
from kilter.analysis.settled_pose.rest import RestResult
from kilter.analysis.settled_pose.rest_search import SearchResult, search_rest
from kilter.analysis.settled_pose.rest_verification import parts_without_rest
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies, rigid_bodies
from kilter.arrays import Array
from kilter.assembly import Assembly

REACH = 1e-3
"""Reach of the last search, over the median size of the parts [-]."""
SHALLOW = 0.1
"""Least sunk depth of a chain that makes a body hard to move, over the median of all [-]."""
FAR = 3.0
"""Movement of a body over its sunk depth up to which the least motion is not repeated [-]."""
REPEATS, EASIER = 3, 0.3
"""Largest number of repetitions, and least share of `FAR` by which the inertia changes [-]."""
MANY = 100
"""Number of bodies from which a least motion is not repeated: it takes as long as all the rest."""


def least_motion(
    bodies: RigidBodies,
    reach: float,
    near: Callable[[RigidBodies, float | Array], NearPoints],
    depth: Array | None = None,
) -> SearchResult:
    """Search for a pose at rest within a reach [length unit] of bodies; heavy ones move less.

    Arguments: `depth` (B,): sunk depths of the bodies [length unit]. The deeper bodies move more: a
    body on the floor stays where it is although others press against its sides. If a body moves by
    more than `FAR` times its depth, the search is repeated with a larger inertia of this body,
    unless the bodies are `MANY`.
    """

    def around(moved: RigidBodies, widest: float) -> NearPoints:
        """The points of these bodies, without those of the ground."""
        return near(moved, np.where(moved.free, widest, 0.0))

    def search(inertia: Array) -> SearchResult:
        return search_rest(
            bodies, reach=reach, most=None, progress=lambda stage: None, near=around,
            inertia=inertia,
        )  # fmt: skip

    usual = 0.0 if depth is None else float(np.median(depth[bodies.moves]))
    if depth is None or not usual:
        return search(bodies.mass)
    depth = np.maximum(depth / usual, SHALLOW) * usual
    inertia = bodies.mass * (usual / depth) ** 2
    best, least = search(inertia), np.inf
    result = best
    for _ in range(REPEATS if bodies.moves.sum() < MANY else 0):
        shift = np.linalg.norm(result.bodies.center - bodies.center, axis=1)
        share = np.where(bodies.moves, shift / (FAR * depth), 0.0)
        if result.state != "at-rest" or share.max() >= least:
            break
        best, least = result, float(share.max())
        if least <= 1.0:
            break
        inertia = inertia * np.maximum(share, EASIER) ** 2
        result = search(inertia)
    return best


def sunk_depths(bodies: RigidBodies, points: NearPoints) -> Array:
    """Depths of the overlaps on the way from each body down to the ground, shape (B,).

    The sum [length unit] belongs to the shortest way, by number of bodies, with the deepest
    overlaps, and includes the deepest overlap with a body on the same level.
    """
    ends = bodies.of_part[np.column_stack([points.part_a, points.part_b])]
    ends, depth = np.vstack([ends, ends[:, ::-1]]), np.tile(-points.gap, 2)
    ends, depth = ends[depth > 0], depth[depth > 0]
    level = np.where(bodies.moves, -1, 0)
    total = np.zeros(len(level))
    for number in range(1, len(level)):
        below = ends[(level[ends[:, 0]] < 0) & (level[ends[:, 1]] == number - 1), 0]
        if not len(below):
            break
        level[below] = number
        down = (level[ends[:, 0]] == number) & (level[ends[:, 1]] == number - 1)
        np.maximum.at(total, ends[down, 0], depth[down] + total[ends[down, 1]])
        beside, aside = np.zeros(len(level)), (level[ends] == number).all(axis=1)
        np.maximum.at(beside, ends[aside, 0], depth[aside])
        total += beside
    return total


def closed_up(rest: RestResult, settled: Assembly) -> RestResult | None:
    """The result after the least motion that brings its resting bodies to rest; None without one.

    Bodies that leave the scene or have no pose do not take part. `settled`: the assembly in the
    pose of the result.
    """
    bodies = rest.bodies
    chosen = np.flatnonzero(~parts_without_rest(rest))
    free = ~settled.geometry.grounded[chosen]
    if not free.any():
        return None
    sub = settled if len(chosen) == len(settled) else chosen_parts(settled, chosen, [])
    still = ~bodies.moves[bodies.of_part[chosen]] & free
    small = rigid_bodies(sub, [sub.names[k] for k in np.flatnonzero(still).tolist()])
    reach = REACH * float(np.median(sub.geometry.size[free]))
    found = least_motion(small, reach, CandidatePoints.of(small).near)
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
