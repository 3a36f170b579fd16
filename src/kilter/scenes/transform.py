"""Rigid motion of a whole assembly, which changes no verdict."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.assembly import Assembly, Feature, GivenContact, Joint, Load, Part
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.scenes.pieces import compose

__all__ = ["moved", "moved_features", "require_about_y"]


def moved(
    assembly: Assembly, rotation: ArrayLike = (1, 0, 0, 0), shift: ArrayLike = (0, 0, 0)
) -> Assembly:
    """Rotate an assembly about the origin, then shift it, with its gravity, loads and contacts.

    Arguments: `rotation` (4,): quaternion (w, x, y, z); `shift` (3,): shift, world frame [length
    unit]. Raises `InputError` if the assembly is planar and the rotation is not about y.

    Examples
    --------
    >>> from kilter.scenes.pieces import turn
    >>> from kilter.scenes.stacks import tower
    >>> moved(tower(1), turn([0, 1, 0], 90)).down.round(12) + 0
    array([-1.,  0.,  0.])
    """
    pose = Pose(shift, rotation)
    matrix = pose.matrix
    if assembly.planar:
        require_about_y(matrix)
    gravity = matrix @ assembly.gravity
    if assembly.planar:
        gravity[1] = 0.0
    return dataclasses.replace(
        assembly,
        parts=[_moved_part(part, pose) for part in assembly.parts],
        gravity=gravity,
        loads=[_moved_load(load, pose) for load in assembly.loads],
        contacts=[
            dataclasses.replace(
                c,
                points=pose.apply(c.points),
                normal=matrix @ c.normal,
                feature=moved_features(c, lambda v: matrix @ v, lambda p: pose.apply([p])[0], 1.0),
            )
            for c in assembly.contacts
        ],
        joints=[_moved_joint(joint, pose) for joint in assembly.joints],
        bonds=[
            bond
            if bond.points is None
            else dataclasses.replace(
                bond, points=pose.apply(bond.points), normal=matrix @ bond.normal
            )
            for bond in assembly.bonds
        ],
        straps=[
            dataclasses.replace(
                strap,
                path=list(zip(strap.parts, pose.apply(strap.points), strict=True)),
            )
            for strap in assembly.straps
        ],
    )


def require_about_y(matrix: Array) -> None:
    """Raise `InputError` if a rotation matrix is not about y, for a planar assembly."""
    if abs(matrix[1, 1] - 1.0) > 1e-12:
        raise InputError("the turn leaves the x-z plane of a planar assembly", hint="turn about y")


def _moved_part(part: Part, pose: Pose) -> Part:
    position = pose.apply([part.pose.position])[0]
    return dataclasses.replace(
        part, pose=Pose(position, compose(pose.rotation, part.pose.rotation))
    )


def _moved_load(load: Load, pose: Pose) -> Load:
    point = None if load.point is None else pose.apply([load.point])[0]
    return Load(load.part, pose.matrix @ load.force, pose.matrix @ load.torque, point)


def _moved_joint(joint: Joint, pose: Pose) -> Joint:
    point = None if joint.point is None else pose.apply([joint.point])[0]
    axis = None if joint.axis is None else pose.matrix @ joint.axis
    return dataclasses.replace(joint, point=point, axis=axis)


def moved_features(
    contact: GivenContact,
    turned: Callable[[Array], Array],
    moved: Callable[[Array], Array],
    factor: float,
) -> tuple[Feature, Feature] | None:
    """Touching features of a contact after a rotation, shift and scaling; None without features.

    `turned` maps directions, `moved` maps points; the surfaces are `factor` times as large.
    """
    if contact.feature is None:
        return None
    a, b = (
        Feature(
            feature.kind,
            None if feature.along is None else turned(feature.along),
            feature.curvature / factor,
            None if feature.point is None else moved(feature.point),
            None if feature.axis is None else turned(feature.axis),
        )
        for feature in contact.feature
    )
    return a, b
