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

import itertools
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from kilter.arrays import Array, Index
from kilter.assembly import Part
from kilter.assembly.geometry import MassProperties
from kilter.assembly.interactions import FrictionPair
from kilter.assembly.part import inertia_fault, inertia_numbers
from kilter.errors import InputError
from kilter.files.usd.usd_objects import UsdObject
from kilter.files.usd.usd_shapes import rigid_part
from kilter.files.usd.usd_stage import UsdScene
from kilter.files.usd.usd_values import number_of, paths_above, quaternion_of, token_of, vector_of
from kilter.rigid import Pose
from kilter.shape.primitives import Shape, surface
from kilter.validate import finite

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


# Friction between USD objects, from the physics materials of their colliders.


REACH = 1.0
"""Distance of two parts up to which their friction is read [sizes of the smaller box]."""
MODES: dict[str, Callable[[float, float], float]] = {
    "average": lambda a, b: (a + b) / 2,
    "min": min,
    "multiply": lambda a, b: a * b,
    "max": max,
}
"""Functions of two coefficients, by the mode, in order of precedence."""
MODE = "physxMaterial:frictionCombineMode"


@dataclass(frozen=True, slots=True)
class FrictionMaterial:
    """Static friction coefficient of a material [-], and its position in `MODES`."""

    mu: float
    mode: int


Materials = Sequence[FrictionMaterial | None]
"""Material of each piece of a part; None without any."""


def collider_pieces(
    entry: UsdObject, filtered: Collection[str] = ()
) -> tuple[list[int], Materials]:
    """The piece to which each collider of an object belongs, and the material of each piece.

    Colliders with equal friction belong to the same piece, if the same `filtered` paths name them.
    """
    found = [
        (
            _material(shape.prim),
            tuple(path for path in paths_above(str(shape.prim.GetPath())) if path in filtered),
        )
        for shape in entry.chosen
    ]
    distinct = list(dict.fromkeys(found))
    return [distinct.index(key) for key in found], [material for material, _ in distinct]


def _material(prim: Any) -> FrictionMaterial | None:
    """The friction of the physics material of a collider; None without any.

    The dynamic coefficient replaces a static coefficient that is not stated.
    """
    material = bound_material(prim)
    if material is None:
        return None
    static, dynamic = material.GetStaticFrictionAttr(), material.GetDynamicFrictionAttr()
    mode = token_of(material.GetPrim().GetAttribute(MODE), MODES, "average")
    mu = number_of(static if static.HasAuthoredValue() else dynamic, 0)
    return FrictionMaterial(mu, list(MODES).index(mode))


def _combined(a: FrictionMaterial | None, b: FrictionMaterial | None) -> float | None:
    """The friction coefficient of two materials [-]; None without any."""
    if a is None or b is None:
        single = a or b
        return None if single is None else single.mu
    return list(MODES.values())[max(a.mode, b.mode)](a.mu, b.mu)


def friction_of_parts(
    parts: Sequence[Part], materials: Sequence[Materials]
) -> tuple[float, list[FrictionPair]]:
    """The most frequent friction coefficient, and the near pairs with another coefficient."""
    distinct = {material for pieces in materials for material in pieces}
    if len(distinct) == 1:
        material = distinct.pop()
        return _combined(material, material) or 0.0, []
    entries: list[tuple[float | None, int, int, tuple[int, int] | None]] = []
    for i, k in _near_pairs(parts).tolist():
        if parts[i].grounded and parts[k].grounded:
            continue
        table = {
            (m, n): _combined(a, b)
            for (m, a), (n, b) in itertools.product(
                enumerate(materials[i]), enumerate(materials[k])
            )
        }
        if len(set(table.values())) == 1:
            entries.append((table[0, 0], i, k, None))
        else:
            entries += [(mu, i, k, pieces) for pieces, mu in table.items()]
    known = [mu for mu, *_ in entries if mu is not None]
    bare = len(known) < len(entries)  # pairs without any material have the friction of the assembly
    usual = 0.0 if bare or not known else Counter(known).most_common(1)[0][0]
    return usual, [
        FrictionPair((parts[i].name, parts[k].name), mu, pieces)
        for mu, i, k, pieces in entries
        if mu is not None and mu != usual
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
