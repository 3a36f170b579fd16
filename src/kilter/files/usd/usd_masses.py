"""Mass, centre and inertia of USD objects, by the rules of `PhysicsMassAPI`.

    mass       of the body, else the sum of the masses of its colliders
    of a collider   its own mass, else density times volume
    density    of the collider, else of the body, else of its physics material
    centre     of the body, else of the sum over the colliders
    inertia    `diagonalInertia` along `principalAxes`, of the body, else of the sum over the
               colliders about the centre of the body, in proportion to the mass

A zero mass, density or inertia, and an infinite centre, count as not stated.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Part
from kilter.assembly.inertia import inertia_fault, inertia_numbers
from kilter.assembly.mass_properties import MassProperties
from kilter.errors import InputError
from kilter.files.usd.usd_objects import UsdObject
from kilter.files.usd.usd_shapes import rigid_part
from kilter.files.usd.usd_stage import UsdScene
from kilter.files.usd.usd_values import number_of, quaternion_of, vector_of
from kilter.rigid import Pose
from kilter.shape.primitives import Shape
from kilter.validate import finite

__all__ = ["bound_material", "mass_of_object"]

NOT_STATED = (-np.inf, -np.inf, -np.inf)
"""Centre of mass in USD for "not stated"."""


@dataclass(frozen=True, slots=True, eq=False)
class _StatedMass:
    """Values of a `PhysicsMassAPI`, in the units of the assembly and the world frame.

    Zero or None stands for a value that is not stated.
    """

    mass: float = 0.0
    density: float = 0.0
    center: Array | None = None
    inertia: Array | None = None

    @property
    def is_only_density(self) -> bool:
        """Whether neither mass nor centre nor inertia is stated."""
        return not self.mass and self.center is None and self.inertia is None


def mass_of_object(
    scene: UsdScene,
    entry: UsdObject,
    pose: Pose,
    shapes: Sequence[tuple[Shape, Pose]],
    notes: list[str],
) -> dict[str, Any]:
    """Mass, density, centre of mass and inertia of an object, as fields of a part.

    Values that the stage does not state are left to the shape of the part, if that gives the same.

    Arguments: `pose`: frame of the part [length unit]; `shapes`: shapes of ``entry.chosen`` in the
    world [length unit].
    """
    body = _StatedMass()
    if entry.body is not None:
        body = _stated(scene, entry.body, entry.matrix, entry.name, notes)
    own = [_stated(scene, shape.prim, shape.matrix, entry.name, notes) for shape in entry.chosen]
    densities = [
        stated.density or body.density or _material_density(scene, shape.prim)
        for stated, shape in zip(own, entry.chosen, strict=True)
    ]
    plain = all(stated.is_only_density for stated in own) and len(set(densities)) == 1
    turn = pose.matrix
    if plain and (body.center is None or body.inertia is not None):
        fields: dict[str, Any] = {
            "mass": body.mass or None,
            "density": None if body.mass else densities[0] or None,
        }
        if body.center is not None:
            fields["center_of_mass"] = turn.T @ (body.center - pose.position)
    else:
        total = _sum(entry.name, own, densities, shapes, scene.units)
        if body.mass:
            share = body.mass / total.mass
            total = MassProperties(body.mass, total.center, share * total.inertia)
        fields = (total if body.center is None else total.about(body.center)).fields(pose)
    if body.inertia is not None:
        fields["inertia"] = inertia_numbers(turn.T @ body.inertia @ turn)
    return fields


def _sum(
    name: str,
    own: Sequence[_StatedMass],
    densities: Sequence[float],
    shapes: Sequence[tuple[Shape, Pose]],
    units: str,
) -> MassProperties:
    """Sum of the mass properties of colliders, world frame; flat meshes are left out.

    Raises `InputError` if all colliders are flat.
    """
    pieces = []
    for stated, density, (shape, pose) in zip(own, densities, shapes, strict=True):
        mass = stated.mass or None
        part = Part(name, shape, pose, density=density or None, mass=mass, units=units)
        try:
            piece = MassProperties.of_part(part)
        except InputError:
            continue
        if stated.center is not None:
            piece = piece.about(stated.center)
        inertia = piece.inertia if stated.inertia is None else stated.inertia
        pieces.append(MassProperties(piece.mass, piece.center, inertia))
    if not pieces:
        raise InputError("all of its shapes are flat", hint="give closed solids")
    return MassProperties.sum(pieces)


def _stated(scene: UsdScene, prim: Any, matrix: Array, name: str, notes: list[str]) -> _StatedMass:
    """The values of the `PhysicsMassAPI` of a prim whose transform to the world is `matrix`."""
    from pxr import UsdPhysics

    if not prim.HasAPI(UsdPhysics.MassAPI):
        return _StatedMass()
    values = UsdPhysics.MassAPI(prim)
    center = vector_of(values.GetCenterOfMassAttr(), 3, NOT_STATED)
    moments = finite(
        vector_of(values.GetDiagonalInertiaAttr(), 3, (0, 0, 0)), (3,), "diagonalInertia"
    )
    inertia = None
    if moments.any():
        axes = quaternion_of(values.GetPrincipalAxesAttr())
        own = Pose([0, 0, 0], axes).matrix if axes.any() else np.eye(3)
        turn = rigid_part(matrix).matrix @ own
        inertia = turn @ np.diag(moments * scene.kilograms * scene.scale**2) @ turn.T
        fault = inertia_fault(inertia)
        if fault:
            notes.append(
                f"no body has the inertia of {name!r}, so that of its shapes is used: {fault}"
            )
            inertia = None
    return _StatedMass(
        number_of(values.GetMassAttr(), 0) * scene.kilograms,
        number_of(values.GetDensityAttr(), 0) * scene.kilograms / scene.metres**3,
        scene.scale * (matrix @ [*center, 1.0])[:3] if np.isfinite(center).all() else None,
        inertia,
    )


def bound_material(prim: Any) -> Any:
    """The physics material that is bound to a shape; None without any."""
    from pxr import UsdPhysics, UsdShade

    found, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")
    if not found or not found.GetPrim().HasAPI(UsdPhysics.MaterialAPI):
        return None
    return UsdPhysics.MaterialAPI(found.GetPrim())


def _material_density(scene: UsdScene, prim: Any) -> float:
    """Density of the physics material of a shape [kg/m^3]; 0 without any."""
    material = bound_material(prim)
    density = 0.0 if material is None else number_of(material.GetDensityAttr(), 0)
    return density * scene.kilograms / scene.metres**3
