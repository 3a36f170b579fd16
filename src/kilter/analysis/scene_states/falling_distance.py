"""Distance that objects fall straight down until they meet another part.

The objects of a group move together. For each pair of a moving part and a part below it, the
distance is the least height between a face that looks down and a face that looks up, over the
area in which they overlap in projection (`kilter.analysis.planning.order.sweeps`). It is exact for
flat faces. For round faces, the lowest part of the motion is computed again on the exact surfaces:

    h <- h + min gap_i / |n_i . up|,    gap_i, n_i: gaps and normals of contacts after the fall h

This is Newton's method for the first contact. Its steps are at most the error of the triangles.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.planning.order.sweeps import Direction, Sweeps
from kilter.arrays import Array, Index
from kilter.assembly import Assembly
from kilter.contact import Tolerance, detect
from kilter.rigid import Pose

__all__ = ["StraightFall", "falling_distance"]

ROUNDS = 6
"""Largest number of Newton steps to the first contact of round faces."""
UPRIGHT = 0.05
"""Least component of a contact normal along the vertical for a step [-]."""
EXACT = 1e-12
"""Newton step that ends the search [sizes of the part]."""


@dataclass(frozen=True, slots=True)
class StraightFall:
    """A straight fall until the first contact."""

    distance: float
    """Length of the fall [length unit]."""
    part: int
    """The falling part that meets another part first."""
    other: int
    """The part that it meets."""


def falling_distance(
    assembly: Assembly, sweeps: Sweeps, parts: Index, down: Array
) -> StraightFall | None:
    """Find the first part that a group of parts meets if it falls straight down.

    Arguments: `parts` (n,): the falling parts; they move together; `down` (3,): unit direction of
    gravity. Returns None if nothing is below the parts.
    """
    x, y, z = down.tolist()
    direction: Direction = (x, y, z)
    slack = assembly.geometry.slack
    # contacts without points: the pair never touches
    apart = {frozenset(entry.parts) for entry in assembly.contacts if not len(entry.points)}
    best: StraightFall | None = None
    for other, bound in zip(*(a.tolist() for a in sweeps.under(parts, direction)), strict=True):
        spare = float(slack[parts].max() + slack[other])
        if best is not None and bound - spare >= best.distance:
            break
        for part in parts.tolist():
            if frozenset((assembly.names[part], assembly.names[other])) in apart:
                continue
            distance = sweeps.clearance(part, other, direction)
            if not np.isfinite(distance):
                continue
            if slack[part] + slack[other] > 0:
                distance = _on_surfaces(assembly, part, other, down, distance)
            if best is None or distance < best.distance:
                best = StraightFall(distance, part, other)
    return best


def _on_surfaces(assembly: Assembly, part: int, other: int, down: Array, distance: float) -> float:
    """Length of the fall on the exact surfaces, from the length on the triangles [length unit]."""
    geometry = assembly.geometry
    slack = float(geometry.slack[part] + geometry.slack[other])
    size = float(min(geometry.size[part], geometry.size[other]))
    falling = replace(assembly.parts[part], grounded=False)
    still = replace(assembly.parts[other], grounded=True)
    found = distance
    for _ in range(ROUNDS):
        pose = falling.pose
        moved = replace(falling, pose=Pose(pose.position + found * down, pose.rotation))
        pair = Assembly([moved, still], units=assembly.units, gravity=assembly.gravity)
        near = detect.contacts(pair, tolerance=Tolerance(gap=4 * slack))
        steep = np.abs(near.patch_normal @ down)
        usable = steep > UPRIGHT
        if not usable.any():
            break
        step = float((near.patch_gap[usable, 0] / steep[usable]).min())
        found += step
        if abs(step) <= EXACT * size:
            break
    return found if abs(found - distance) <= 4 * slack / UPRIGHT else distance
