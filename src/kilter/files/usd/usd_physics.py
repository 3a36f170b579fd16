"""Joints of USD objects and pairs that do not touch, by the schemas of UsdPhysics.

Drives and limits of joints are ignored.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from kilter.assembly.interactions import GivenContact, Joint
from kilter.assembly.part import GROUND
from kilter.errors import InputError, visible
from kilter.files.usd.usd_objects import UsdObject, matrix_of
from kilter.files.usd.usd_shapes import AXES, rigid_part
from kilter.files.usd.usd_stage import UsdScene
from kilter.files.usd.usd_values import paths_above, place_of, quaternion_of, token_of, vector_of
from kilter.rigid import Pose

KINDS = {
    "PhysicsFixedJoint": "fixed",
    "PhysicsRevoluteJoint": "revolute",
    "PhysicsPrismaticJoint": "prismatic",
    "PhysicsSphericalJoint": "spherical",
}
"""Kind of `Joint` for each type of joint in USD."""


def find_joints(scene: UsdScene, objects: Mapping[str, UsdObject], notes: list[str]) -> list[Joint]:
    """Joints of the stage between its objects."""
    from pxr import UsdPhysics

    joints, ignored = [], 0
    for prim in scene.stage.Traverse():
        if not prim.IsA(UsdPhysics.Joint):
            continue
        entry = UsdPhysics.Joint(prim)
        if entry.GetJointEnabledAttr().Get() is False:
            continue
        kind = KINDS.get(str(prim.GetTypeName()))
        targets = [
            _bodies(scene, rel, objects) for rel in (entry.GetBody0Rel(), entry.GetBody1Rel())
        ]
        ends = [_owner(str(found[0]), objects) if found else None for found in targets]
        names = [GROUND if end is None else end.name for end in ends]
        if kind is None or names[0] == names[1]:
            ignored += 1
            continue
        joints.append(_joint(scene, prim, entry, kind, names, targets))
    moving = sum(joint.kind != "fixed" for joint in joints)
    if moving:
        notes.append(f"joints that move freely, without their drives and limits: {moving}")
    if ignored:
        notes.append(f"ignored joints: {ignored}")
    return joints


def _bodies(scene: UsdScene, relation: Any, objects: Mapping[str, UsdObject]) -> list[Any]:
    """Path of the body that a relation of a joint names; empty for the world.

    Raises `InputError` if there is no such prim, if it is a body without a shape, or if several are
    named.
    """
    from pxr import UsdPhysics

    targets = list(relation.GetTargets())
    where = f"{place_of(relation)} names"
    if len(targets) > 1:
        raise InputError(f"{where} {len(targets)} bodies", hint="name a single body")
    for target in targets:
        prim = scene.stage.GetPrimAtPath(target.GetPrimPath())
        path = visible(str(target))
        if not prim or not target.IsPrimPath():
            raise InputError(f"{where} {path:.80}, which does not exist", hint="correct its path")
        if prim.HasAPI(UsdPhysics.RigidBodyAPI) and _owner(str(target), objects) is None:
            raise InputError(f"{where} {path:.80}, which has no shape", hint="give it a shape")
    return targets


def filtered_ends(scene: UsdScene) -> list[tuple[str, str]]:
    """Paths of the prims that never touch each other in the stage.

    These are the bodies of a joint, unless it enables their collision, and filtered pairs of bodies
    or of single colliders.
    """
    from pxr import UsdPhysics

    ends: list[tuple[str, str]] = []
    for prim in scene.stage.Traverse():
        if prim.IsA(UsdPhysics.Joint):
            entry = UsdPhysics.Joint(prim)
            if not entry.GetCollisionEnabledAttr().Get():
                first, second = entry.GetBody0Rel().GetTargets(), entry.GetBody1Rel().GetTargets()
                ends += [(str(a), str(b)) for a in first for b in second]
        if prim.HasAPI(UsdPhysics.FilteredPairsAPI):
            targets = UsdPhysics.FilteredPairsAPI(prim).GetFilteredPairsRel().GetTargets()
            ends += [(str(prim.GetPath()), str(path)) for path in targets]
    return ends


def filtered_pairs(
    ends: Sequence[tuple[str, str]],
    objects: Mapping[str, UsdObject],
    pieces: Mapping[str, Sequence[int]],
) -> list[GivenContact]:
    """Pairs of parts, or of their pieces, that never touch, as contacts without points."""
    found: set[tuple[str, str, tuple[int, int] | None]] = set()
    for each in ends:
        a, b = (_owner(path, objects) for path in each)
        if a is None or b is None or a is b:
            continue
        sides = sorted(
            (
                entry.name,
                _named_pieces(entry, path, pieces[entry.path]),
                len(set(pieces[entry.path])),
            )
            for entry, path in zip((a, b), each, strict=True)
        )
        (first, left, most), (second, right, count) = sides
        if len(left) == most and len(right) == count:
            found.add((first, second, None))
        else:
            found |= {(first, second, (i, k)) for i in left for k in right}
    whole = {entry[:2] for entry in found if entry[2] is None}
    rows = [entry for entry in found if entry[2] is None or entry[:2] not in whole]
    return [
        GivenContact((first, second), [], [0, 0, 1], pieces=pair)
        for first, second, pair in sorted(rows, key=lambda row: (row[:2], row[2] or ()))
    ]


def _named_pieces(entry: UsdObject, path: str, pieces: Sequence[int]) -> list[int]:
    """Pieces of the colliders at or below a path; all pieces if it is that of the object."""
    return sorted(
        {
            piece
            for shape, piece in zip(entry.chosen, pieces, strict=True)
            if path == entry.path or path in paths_above(str(shape.prim.GetPath()))
        }
    )


def _owner(path: str, objects: Mapping[str, UsdObject]) -> UsdObject | None:
    """The object to which a prim belongs: that of its path, or of a path above it."""
    return next((objects[above] for above in paths_above(path) if above in objects), None)


def _joint(
    scene: UsdScene,
    prim: Any,
    entry: Any,
    kind: str,
    names: list[str],
    targets: list[list[Any]],
) -> Joint:
    """A joint, with its point and axis from its frame on the first body that it names."""
    from pxr import Usd, UsdGeom

    side = 0 if targets[0] else 1
    place = vector_of((entry.GetLocalPos0Attr, entry.GetLocalPos1Attr)[side](), 3, (0, 0, 0))
    turn = quaternion_of((entry.GetLocalRot0Attr, entry.GetLocalRot1Attr)[side]())
    body = scene.stage.GetPrimAtPath(targets[side][0])
    matrix = matrix_of(UsdGeom.XformCache(Usd.TimeCode.Default()).GetLocalToWorldTransform(body))
    point = (matrix @ np.append(place, 1.0))[:3] * scene.scale
    local = Pose([0, 0, 0], turn)
    token = "Z"
    if kind in ("revolute", "prismatic"):
        token = token_of(prim.GetAttribute("physics:axis"), AXES, "X")
    axis = rigid_part(matrix).matrix @ local.matrix @ AXES[token][:, 2]
    first, second = names
    if kind == "fixed":
        return Joint((first, second))
    if kind == "prismatic":
        return Joint((first, second), "prismatic", axis=axis)
    if kind == "spherical":
        return Joint((first, second), "spherical", point=point)
    return Joint((first, second), "revolute", point=point, axis=axis)
