"""Friction and joints of USD objects, by the schemas of UsdPhysics.

USD does not state how the friction of two materials combines. The
coefficient of a pair is here the mean of the static coefficients, as in PhysX without a combine
mode. A pair with a single material has its coefficient. Drives and limits of joints are ignored.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import shapely

from kilter.arrays import Index
from kilter.assembly import Part
from kilter.assembly.interactions import FrictionPair, GivenContact, Joint
from kilter.assembly.part import GROUND
from kilter.errors import InputError, visible
from kilter.files.usd.usd_masses import bound_material
from kilter.files.usd.usd_objects import UsdObject, matrix_of
from kilter.files.usd.usd_shapes import AXES, rigid_part
from kilter.files.usd.usd_stage import UsdScene
from kilter.files.usd.usd_values import number_of, place_of, quaternion_of, token_of, vector_of
from kilter.rigid import Pose
from kilter.shape.primitives import surface

__all__ = [
    "filtered_pairs",
    "find_joints",
    "friction_of_parts",
    "static_friction",
]

REACH = 1.0
"""Distance of two parts up to which their friction is read [sizes of the smaller box]."""
KINDS = {
    "PhysicsFixedJoint": "fixed",
    "PhysicsRevoluteJoint": "revolute",
    "PhysicsPrismaticJoint": "prismatic",
    "PhysicsSphericalJoint": "spherical",
}
"""Kind of `Joint` for each type of joint in USD."""


def static_friction(entry: UsdObject) -> float | None:
    """Least static friction coefficient of the shapes of an object [-]; None without a material.

    The dynamic coefficient replaces a static coefficient that is not stated.
    """
    found = []
    for shape in entry.chosen:
        material = bound_material(shape.prim)
        if material is not None:
            static, dynamic = material.GetStaticFrictionAttr(), material.GetDynamicFrictionAttr()
            chosen = static if static.HasAuthoredValue() else dynamic
            found.append(number_of(chosen, 0))
    return min(found) if found else None


def friction_of_parts(
    parts: Sequence[Part], own: Sequence[float | None]
) -> tuple[float, list[FrictionPair]]:
    """The most frequent friction coefficient, and the near pairs with another coefficient.

    Parameters
    ----------
    parts : sequence of Part
    own : sequence of float or None
        Static friction coefficient of each part [-].
    """
    value = np.array([math.nan if mu is None else mu for mu in own])
    if np.isnan(value).all():
        return 0.0, []
    if not np.isnan(value).any() and np.ptp(value) == 0.0:
        return float(value[0]), []
    first, second = _near_pairs(parts).T
    free = np.array([not part.grounded for part in parts])
    counts = free[first] | free[second]
    first, second = first[counts], second[counts]
    a, b = value[first], value[second]
    mu = np.where(np.isnan(a), b, np.where(np.isnan(b), a, (a + b) / 2))
    known = ~np.isnan(mu)
    first, second, mu = first[known], second[known], mu[known]
    bare = not known.all()  # pairs without any material have the friction of the assembly
    usual = 0.0 if bare or not len(mu) else Counter(mu.tolist()).most_common(1)[0][0]
    return usual, [
        FrictionPair((parts[i].name, parts[k].name), mu)
        for i, k, mu in zip(first.tolist(), second.tolist(), mu.tolist(), strict=True)
        if mu != usual
    ]


def _near_pairs(parts: Sequence[Part]) -> Index:
    """Pairs of parts whose boxes are nearer than `REACH` sizes of the smaller box, (n, 2)."""
    corners = [part.pose.apply(surface(part.shape)[0]) for part in parts]
    low = np.array([points.min(axis=0) for points in corners])
    high = np.array([points.max(axis=0) for points in corners])
    reach = REACH * np.linalg.norm(high - low, axis=1)
    flat = shapely.box(*low[:, :2].T, *high[:, :2].T)
    wide = shapely.box(*(low[:, :2] - reach[:, None]).T, *(high[:, :2] + reach[:, None]).T)
    a, b = shapely.STRtree(flat).query(wide, predicate="intersects")
    near = (a != b) & (reach[a] <= reach[b])
    a, b = a[near], b[near]
    near = (low[a, 2] - reach[a] <= high[b, 2]) & (high[a, 2] + reach[a] >= low[b, 2])
    pairs: Index = np.unique(np.sort(np.column_stack([a[near], b[near]]), axis=1), axis=0)
    return pairs


def find_joints(scene: UsdScene, objects: Mapping[str, UsdObject], notes: list[str]) -> list[Joint]:
    """Joints of the stage between its objects.

    Parameters
    ----------
    scene : UsdScene
    objects : mapping from str to UsdObject
        Objects by the path of their prim.
    notes : list of str
        A note is appended for joints of other kinds.
    """
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
        notes.append(f"{moving} joints are free to move: drives and limits are ignored")
    if ignored:
        notes.append(f"ignored joints: {ignored}")
    return joints


def _bodies(scene: UsdScene, relation: Any, objects: Mapping[str, UsdObject]) -> list[Any]:
    """Path of the body that a relation of a joint names; empty for the world.

    Raises
    ------
    InputError
        If there is no such prim, if it is a body without a shape, or if several are named.
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


def filtered_pairs(scene: UsdScene, objects: Mapping[str, UsdObject]) -> list[GivenContact]:
    """Pairs of objects that never touch in the stage, as contacts without points.

    These are the bodies of a joint, unless it enables their collision, and filtered pairs.
    """
    from pxr import UsdPhysics

    pairs: set[tuple[str, str]] = set()
    for prim in scene.stage.Traverse():
        ends: list[tuple[str, str]] = []
        if prim.IsA(UsdPhysics.Joint):
            entry = UsdPhysics.Joint(prim)
            if not entry.GetCollisionEnabledAttr().Get():
                first, second = entry.GetBody0Rel().GetTargets(), entry.GetBody1Rel().GetTargets()
                ends = [(str(a), str(b)) for a in first for b in second]
        if prim.HasAPI(UsdPhysics.FilteredPairsAPI):
            targets = UsdPhysics.FilteredPairsAPI(prim).GetFilteredPairsRel().GetTargets()
            ends += [(str(prim.GetPath()), str(path)) for path in targets]
        for each in ends:
            a, b = (_owner(path, objects) for path in each)
            if a is not None and b is not None and a is not b:
                pairs.add((min(a.name, b.name), max(a.name, b.name)))
    return [GivenContact(pair, [], [0, 0, 1]) for pair in sorted(pairs)]


def _owner(path: str, objects: Mapping[str, UsdObject]) -> UsdObject | None:
    """The object to which a prim belongs: that of its path, or of a path above it."""
    while path:
        if path in objects:
            return objects[path]
        path = path.rpartition("/")[0]
    return None


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
