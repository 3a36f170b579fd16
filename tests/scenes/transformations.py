"""Transformations of assemblies for tests, with a known effect on the answer.

Scaling, reordering and renaming change no verdict. `tilted` rotates only gravity. `as_single`
rounds the coordinates to those of a binary STL file. `kilter.scenes.pieces` has rigid motions.
"""

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.assembly import GROUND, Assembly, Joint, Load, Part
from kilter.assembly.part import inertia_matrix, inertia_numbers
from kilter.errors import InputError
from kilter.rigid import Pose, quaternion_to_matrix
from kilter.scenes.pieces import moved_features, require_about_y, turn
from kilter.shape.primitives import Box, Cylinder, Mesh, Prism, Shape, Sphere, surface


def tilted(assembly: Assembly, axis: ArrayLike, degrees: float) -> Assembly:
    """Rotate only gravity, right-handed about `axis` [deg]; about +y it leans toward -x.

    Raises
    ------
    InputError
        If the assembly is planar and the axis is not y.

    Examples
    --------
    >>> from kilter.scenes.stacks import tower
    >>> tilted(tower(1), [0, 1, 0], 90).down.round(12) + 0
    array([-1.,  0.,  0.])
    """
    matrix = quaternion_to_matrix(turn(axis, degrees))
    gravity = matrix @ assembly.gravity
    if assembly.planar:
        require_about_y(matrix)
        gravity[1] = 0.0
    return dataclasses.replace(assembly, gravity=gravity)


def scaled(assembly: Assembly, factor: float) -> Assembly:
    """Multiply every length by `factor` and keep the densities, so that no verdict changes.

    Given masses and forces grow by factor^3, as weights do, and torques by factor^4.

    Examples
    --------
    >>> from kilter.scenes.stacks import tower
    >>> scaled(tower(1), 10.0).geometry.mass[-1] / tower(1).geometry.mass[-1]
    np.float64(1000.0)
    """
    factor = float(factor)
    if not (np.isfinite(factor) and factor > 0):
        raise InputError(f"factor is {factor:g}", hint="give a number above zero")

    def times(value: Any, power: int = 1) -> Any:
        return None if value is None else value * factor**power

    parts = [
        dataclasses.replace(
            part,
            shape=_scaled_shape(part.shape, factor),
            pose=Pose(part.pose.position * factor, part.pose.rotation),
            mass=times(part.given_mass, 3),
            center_of_mass=times(part.center_of_mass),
            inertia=times(part.inertia, 5),
        )
        for part in assembly.parts
    ]
    loads = [
        Load(load.part, times(load.force, 3), times(load.torque, 4), times(load.point))
        for load in assembly.loads
    ]
    return dataclasses.replace(
        assembly,
        parts=parts,
        loads=loads,
        contacts=[
            dataclasses.replace(
                c,
                points=times(c.points),
                feature=moved_features(c, lambda v: v, times, factor),
            )
            for c in assembly.contacts
        ],
        joints=[_scaled_joint(joint, factor) for joint in assembly.joints],
        bonds=[
            dataclasses.replace(
                bond,
                pull=times(bond.pull, 3),
                pull_per_area=times(bond.pull_per_area, 1),
                shear=bond.shear if isinstance(bond.shear, str) else times(bond.shear, 3),
                points=times(bond.points),
            )
            for bond in assembly.bonds
        ],
    )


def as_single(assembly: Assembly) -> Assembly:
    """Replace every shape by a mesh in world coordinates rounded to float32, as in a binary STL.

    Densities, masses and centres of mass are kept. Cylinders and spheres become inscribed
    polyhedra.

    Examples
    --------
    >>> from kilter.scenes.stacks import tower
    >>> as_single(tower(1)).parts[0].shape
    Mesh(8 vertices, 12 triangles)
    """
    return dataclasses.replace(assembly, parts=[_single(part) for part in assembly.parts])


def _scaled_joint(joint: Joint, factor: float) -> Joint:
    """A joint whose lengths are multiplied by `factor`, and its forces by its cube."""
    length = 1.0 if joint.kind == "revolute" else factor
    return dataclasses.replace(
        joint,
        point=None if joint.point is None else joint.point * factor,
        limits=None if joint.limits is None else [limit * length for limit in joint.limits],
        friction=joint.friction * factor**4 / length,
        stiffness=joint.stiffness * factor**4 / length**2,
        rest=joint.rest * length,
    )


def mirrored(assembly: Assembly) -> Assembly:
    """Reflect an assembly of polyhedra, without loads, contacts and joints, in the plane x = 0.

    Examples
    --------
    >>> from kilter.scenes.stacks import staircase
    >>> one, other = staircase(), mirrored(staircase())
    >>> bool((one.geometry.center[-1] * [-1, 1, 1] == other.geometry.center[-1]).all())
    True
    """
    if assembly.loads or assembly.contacts or assembly.joints or assembly.straps:
        raise InputError("only parts are mirrored")
    sign = np.array([-1.0, 1.0, 1.0])
    parts = []
    for part in assembly.parts:
        vertices, triangles = surface(part.shape)
        center = part.center_of_mass
        parts.append(
            dataclasses.replace(
                part,
                shape=Mesh(part.pose.apply(vertices) * sign, triangles[:, ::-1]),
                pose=Pose(),
                center_of_mass=None if center is None else part.pose.apply([center])[0] * sign,
                inertia=_world_inertia(part, sign),
            )
        )
    return dataclasses.replace(assembly, parts=parts, gravity=assembly.gravity * sign)


def split(assembly: Assembly) -> Assembly:
    """Cut the first free box without a given mass into two halves along its x, joined rigidly.

    Raises
    ------
    InputError
        If the assembly has no such box.

    Examples
    --------
    >>> from kilter.scenes.stacks import tower
    >>> split(tower(1)).names
    ('base', 'cube-1', 'cube-1-half')
    """
    boxes = [k for k, part in enumerate(assembly.parts) if _is_free_box(part)]
    if not boxes:
        raise InputError("no part is a free box without a given mass")
    part = assembly.parts[boxes[0]]
    assert isinstance(part.shape, Box)
    size = part.shape.size * [0.5, 1, 1]
    halves = [
        dataclasses.replace(
            part,
            name=name,
            shape=Box(size),
            pose=Pose(part.pose.apply(np.array([[at, 0.0, 0.0]]))[0], part.pose.rotation),
        )
        for name, at in ((part.name, -size[0] / 2), (f"{part.name}-half", size[0] / 2))
    ]
    parts = [*assembly.parts[: boxes[0]], halves[0], *assembly.parts[boxes[0] + 1 :], halves[1]]
    joint = Joint((halves[0].name, halves[1].name))
    return dataclasses.replace(assembly, parts=parts, joints=[*assembly.joints, joint])


def has_box(assembly: Assembly) -> bool:
    """Whether an assembly has a part that `split` can cut."""
    return any(_is_free_box(part) for part in assembly.parts)


def _is_free_box(part: Part) -> bool:
    return isinstance(part.shape, Box) and not part.grounded and part.given_mass is None


def permuted(assembly: Assembly, order: Sequence[int]) -> Assembly:
    """Reorder the parts: new part k is old part ``order[k]``.

    Raises
    ------
    InputError
        If `order` does not list every part once.
    """
    if sorted(int(k) for k in order) != list(range(len(assembly.parts))):
        raise InputError(f"order is not a permutation of {len(assembly.parts)} parts")
    return dataclasses.replace(assembly, parts=[assembly.parts[int(k)] for k in order])


def renamed(assembly: Assembly, name: Callable[[str], str]) -> Assembly:
    """Rename the parts by a function, also in loads, contacts, joints, bonds and friction pairs."""

    def pair(parts: tuple[str, str]) -> tuple[str, str]:
        a, b = (GROUND if part == GROUND else name(part) for part in parts)
        return a, b

    def entries(values: Sequence[Any]) -> list[Any]:
        return [dataclasses.replace(entry, parts=pair(entry.parts)) for entry in values]

    return dataclasses.replace(
        assembly,
        parts=[dataclasses.replace(part, name=name(part.name)) for part in assembly.parts],
        loads=[dataclasses.replace(load, part=name(load.part)) for load in assembly.loads],
        friction_pairs=entries(assembly.friction_pairs),
        contacts=entries(assembly.contacts),
        joints=entries(assembly.joints),
        bonds=entries(assembly.bonds),
    )


def _scaled_shape(shape: Shape, factor: float) -> Shape:
    """A shape whose lengths are multiplied by `factor`."""
    if isinstance(shape, Box):
        return Box(shape.size * factor)
    if isinstance(shape, Cylinder):
        return Cylinder(shape.radius * factor, shape.height * factor)
    if isinstance(shape, Sphere):
        return Sphere(shape.radius * factor)
    if isinstance(shape, Prism):
        return Prism(shape.polygon * factor, shape.depth * factor)
    return Mesh(shape.vertices * factor, shape.triangles, accuracy=shape.accuracy * factor)


def _world_inertia(part: Part, sign: Any = (1.0, 1.0, 1.0)) -> Any:
    """The given inertia of a part along the world axes, mirrored by `sign`; None without one."""
    if part.inertia is None:
        return None
    turn = np.diag(sign) @ part.pose.matrix
    return inertia_numbers(turn @ inertia_matrix(part.inertia) @ turn.T)


def _single(part: Part) -> Part:
    """A part as a mesh in world coordinates, rounded to float32."""
    vertices, triangles = surface(part.shape)
    world = part.pose.apply(vertices).astype(np.float32)
    center = part.center_of_mass
    return dataclasses.replace(
        part,
        shape=Mesh(world, triangles),
        pose=Pose(),
        center_of_mass=None if center is None else part.pose.apply([center])[0],
        inertia=_world_inertia(part),
    )
