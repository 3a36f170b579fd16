"""The assembly in the poses that a proof states; its verification loads no solver."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from kilter.analysis.settled_pose.rigid_bodies import rigid_bodies
from kilter.assembly import Assembly
from kilter.files.own.saved_entries import with_bodies


def at_poses(assembly: Assembly, poses: Mapping[str, Any]) -> Assembly:
    """The assembly with the poses of a proof; joints and points of loads and bonds follow."""
    if not poses:
        return assembly
    parts = with_bodies(assembly, {"poses": dict(poses)}).parts
    bodies = rigid_bodies(assembly, ())
    rotation, center = bodies.rotation.copy(), bodies.center.copy()
    for old, new, body in zip(assembly.parts, parts, bodies.of_part.tolist(), strict=True):
        if new.pose == old.pose:
            continue
        turn = new.pose.matrix @ old.pose.matrix.T
        rotation[body] = turn
        center[body] = new.pose.position + turn @ (bodies.drawn_center[body] - old.pose.position)
    moved = replace(bodies, rotation=rotation, center=center).assembly()
    return replace(moved, parts=parts)
