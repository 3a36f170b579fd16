"""Travel of parts along their first motion until a part enters another part.

A motion of first order describes how parts start, not where they end. A picture enlarges it, as a
screw of each part (`kilter.rigid.screwed`), and ends if a part would be deeper in another part than
it is at rest.
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

__all__ = ["free_travel"]

REACH = 0.35
"""How far the fastest part goes at most [size of the assembly]."""
ENTERS = 1e-3
"""How much deeper than at rest a part may be in another [size of the smaller]."""
STEPS, HALVINGS = 12, 6
"""Places that are looked at in turn; then between the last free one and the one after."""
MOST = 3000
"""Parts whose contacts are looked at so often."""


def free_travel(verdict: Verdict) -> Array:
    """The motion of all parts, as far as it is free: shifts and turns of their screws, (N, 6).

    Returns
    -------
    ndarray, shape (N, 6)
        Of the centre of mass [length unit] and about it [rad], world frame; 0 for a part at rest.

    Raises
    ------
    InputError
        If nothing is known to move, or there are more than 3,000 parts.
    """
    assembly, motion = verdict.assembly, verdict.motion
    if not (motion.known and motion.moves.any()):
        raise InputError(
            f"no part is known to move: {verdict.sentence.removesuffix('.')}",
            hint="a film shows how parts start to move; kilter.draw makes a figure",
            option="a film shows how parts start to move; -o figure.svg is a figure",
        )
    if len(assembly) > MOST:
        raise InputError(
            f"a film of {len(assembly)} parts is too large: the limit is {MOST} parts",
            hint="leave parts out with assembly.without(...)",
            option="leave parts out with --without NAME",
        )
    screws = np.where(motion.moves[:, None], motion.acceleration, 0.0)
    screws[:, :3] /= metres_per_unit(assembly.units)
    speed = np.linalg.norm(screws[:, :3], axis=1)
    speed = speed + assembly.geometry.radius * np.linalg.norm(screws[:, 3:], axis=1)
    extent = float(np.ptp(assembly.geometry.vertices, axis=0).max())
    travel: Array = screws * _free_amount(assembly, screws, REACH * extent / float(speed.max()))
    return travel


def _moved(assembly: Assembly, screws: Array, amount: float) -> Assembly:
    """The parts along their screws, with no more than their shapes."""
    center, parts = assembly.geometry.center, []
    for k, part in enumerate(assembly.parts):
        pose = part.pose
        if screws[k].any():
            turns, shifts = screwed(screws[k], np.array([amount]))
            at = center[k] + turns[0] @ (pose.position - center[k]) + shifts[0]
            turned = matrix_to_quaternion(turns[0] @ quaternion_to_matrix(pose.rotation))
            pose = Pose(at, turned)
        parts.append(replace(part, pose=pose))
    return type(assembly)(parts, units=assembly.units, gravity=assembly.gravity)


def _depths(assembly: Assembly) -> dict[tuple[int, int], float]:
    """How deep parts are in each other [size of the smaller]."""
    size = assembly.geometry.size
    found = contacts(assembly).overlaps
    return {one.parts: one.depth / max(size[list(one.parts)].min(), TINY) for one in found}


def _free_amount(assembly: Assembly, screws: Array, most: float) -> float:
    """Length of the motion, up to `most`, before a part enters another part."""
    rest = _depths(_moved(assembly, screws, 0.0))

    def is_free(amount: float) -> bool:
        deep = _depths(_moved(assembly, screws, amount))
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
