"""Distance that a film shows of the impending motion, before a part would enter another part.

A motion of first order gives initial accelerations, not final positions. To make it visible, it is
enlarged: each part follows the screw of its acceleration (`kilter.rigid.screwed`). The motion ends
before a part would penetrate another part deeper than at rest.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from kilter.arrays import TINY, Array
from kilter.contact import contacts
from kilter.errors import InputError
from kilter.rigid import Pose, matrix_to_quaternion, quaternion_to_matrix, screwed
from kilter.units import metres_per_unit

if TYPE_CHECKING:
    from kilter.analysis.verdict.verdict import Verdict
    from kilter.assembly import Assembly


REACH = 0.35
"""Largest travel of the fastest part over the extent of the assembly [-]."""
ENTERS = 1e-3
"""Penetration beyond that at rest that is accepted, over the size of the smaller part [-]."""
STEPS, HALVINGS = 12, 6
"""Number of equal steps that are tried in turn, and of bisections within the first blocked step."""
MOST = 3000
"""Largest number of parts, since each step detects all contacts."""


def free_travel(verdict: Verdict) -> Array:
    """Displacement of each part along its impending motion until a part would enter another part.

    If no accelerations are known, the parts follow the motion of the proof.

    Returns (N, 6): screw of each part in the world frame: shift of its centre of mass [length unit]
    and rotation about it [rad]; 0 for parts at rest. Raises `InputError` if no part is known to
    move, or if there are more than 3,000 parts.
    """
    assembly, motion = verdict.assembly, verdict.motion
    screws = motion.screws(metres_per_unit(assembly.units))
    if not screws.any():
        raise InputError(
            f"no part is known to move: {verdict.sentence.removesuffix('.')}",
            hint="a film shows how parts start to move; kilter.draw makes a figure",
            option="a film shows how parts start to move; -o figure.svg is a figure",
        )
    return travel_along(assembly, screws)


def travel_along(assembly: Assembly, screws: Array) -> Array:
    """Displacement of each part along given motions until a part would enter another part.

    Arguments: `screws` (N, 6): motion of each part in the world frame, of any common size: of its
    centre of mass [length unit] and rotation vector [rad]. Returns (N, 6). Raises `InputError` if
    there are more than 3,000 parts.
    """
    if len(assembly) > MOST:
        raise InputError(
            f"a film of {len(assembly)} parts is too large: the limit is {MOST} parts",
            hint="leave parts out with assembly.without(...)",
            option="leave parts out with --without NAME",
        )
    speed = np.linalg.norm(screws[:, :3], axis=1)
    speed = speed + assembly.geometry.radius * np.linalg.norm(screws[:, 3:], axis=1)
    extent = float(np.ptp(assembly.geometry.vertices, axis=0).max())
    travel: Array = screws * _free_amount(assembly, screws, REACH * extent / float(speed.max()))
    return travel


def _displace(assembly: Assembly, screws: Array, amount: float) -> Assembly:
    """The assembly after a multiple of each part's motion, without joints, bonds and loads."""
    center, parts = assembly.geometry.center, []
    for k, part in enumerate(assembly.parts):
        pose = part.pose
        if screws[k].any():
            turns, shifts = screwed(screws[k], np.array([amount]))
            at = center[k] + turns[0] @ (pose.position - center[k]) + shifts[0]
            rotation = matrix_to_quaternion(turns[0] @ quaternion_to_matrix(pose.rotation))
            pose = Pose(at, rotation)
        parts.append(replace(part, pose=pose))
    return type(assembly)(parts, units=assembly.units, gravity=assembly.gravity)


def _depths(assembly: Assembly) -> dict[tuple[int, int], float]:
    """Penetration depth of each overlapping pair, over the size of the smaller part [-]."""
    size = assembly.geometry.size
    overlaps = contacts(assembly).overlaps
    return {pair.ends: pair.depth / max(size[list(pair.ends)].min(), TINY) for pair in overlaps}


def _free_amount(assembly: Assembly, screws: Array, most: float) -> float:
    """Largest factor, up to `most`, of the parts' motions that causes no new penetration [-]."""
    rest = _depths(_displace(assembly, screws, 0.0))

    def is_free(amount: float) -> bool:
        deep = _depths(_displace(assembly, screws, amount))
        return all(depth <= rest.get(pair, 0.0) + ENTERS for pair, depth in deep.items())

    low = 0.0
    for k in range(1, STEPS + 1):
        high = most * k / STEPS
        if is_free(high):
            low = high
            continue
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if is_free(middle) else (low, middle)
        return low
    return most
