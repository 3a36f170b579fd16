"""Read SDF models and worlds (Gazebo, Drake): links as parts, in the drawn pose of every joint.

A link is one part with its collision shapes, or else its visual shapes. The links of a static model
are held. Joints move within their limits, against their friction; motors are no part of the file.
Links of one model do not touch each other, unless the model states `self_collide`. The friction of
two links is the lesser of their coefficients. Lengths are metres.

References
----------
SDFormat, specification 1.4 to 1.12: link, collision, geometry, surface, joint, physics.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly import Assembly, Part
from kilter.assembly.geometry import MassProperties
from kilter.assembly.interactions import FrictionPair, GivenContact, Joint
from kilter.assembly.part import GROUND, inertia_fault, inertia_matrix
from kilter.errors import InputError
from kilter.files.formats import MESHES, read_bodies
from kilter.files.limits import Tally, is_file, require_regular
from kilter.files.meshes.placed import join_meshes, transform_mesh
from kilter.files.robots.one_body import (
    REACH,
    capsule,
    ellipsoid,
    near_pairs,
    one_body,
    plane_table,
)
from kilter.files.robots.sdf_document import (
    Document,
    Element,
    Model,
    named_paths,
    pose_of,
    read_document,
    relative_to,
    scoped,
    values_of,
    words_of,
)
from kilter.files.robots.urdf import KEYS
from kilter.rigid import Pose, rotation_between
from kilter.shape.primitives import Box, Cylinder, Mesh, Shape, Sphere

USUAL_FRICTION = 1.0
"""Friction coefficient of a collision without one, by the specification [-]."""
USUAL_GRAVITY = "0 0 -9.8"
"""Gravity of a world by default [m/s^2]."""
UNLIMITED = 1e15
"""Limits of joints beyond this size are none [rad or m]."""
KINDS = {
    "fixed": "fixed",
    "revolute": "revolute",
    "continuous": "revolute",
    "prismatic": "prismatic",
    "ball": "spherical",
    "universal": "general",
    "revolute2": "general",
}
"""Kind of `Joint` for each type of joint."""


@dataclass(slots=True)
class _Plane:
    """A plane of a link, which has no end in a simulator, and its pose in the world."""

    link: str
    name: str
    pose: Pose
    mu: float


@dataclass(slots=True)
class _Scene:
    """The parts and joints of a document during its conversion."""

    document: Document
    parts: list[Part] = field(default_factory=list)
    mu: list[float] = field(default_factory=list)
    """Friction coefficient of each part."""
    model: list[str] = field(default_factory=list)
    """Outermost model of each part; "" if its links may touch each other."""
    planes: list[_Plane] = field(default_factory=list)
    part_of: dict[str, str] = field(default_factory=dict)
    """Name of the part of each link by its scoped name; "ground" for a link of planes."""
    left: Counter[str] = field(default_factory=Counter)
    """How often each kind of thing is left out."""
    tally: Tally = field(default_factory=Tally)
    names: set[str] = field(default_factory=lambda: {GROUND})
    """Names of the parts, and the reserved one."""

    def free_name(self, name: str) -> str:
        """The name, with a number if another part has it or it is reserved."""
        label, count = name, 1
        while label in self.names:
            count += 1
            label = f"{name}_{count}"
        self.names.add(label)
        return label


def read_sdf(root: Element, path: Path) -> Assembly:
    """Build an assembly from the XML of an SDF file, a world or a model.

    Raises `InputError` if a pose, a link or a joint is invalid, or no link has a shape.
    """
    document = read_document(root, path)
    scene = _Scene(document)
    for model in document.models:
        links = model.element.findall("link")
        for link in links:
            _add_link(scene, model, link, alone=len(links) == 1)
    _add_planes(scene)
    if not scene.parts:
        why = "; ".join(["", *document.notes, *_left_words(scene)])
        raise InputError(f"no link has a shape{why}", hint="give its links <collision>")
    joints = [joint for model in document.models for joint in _joints(scene, model)]
    near = near_pairs(scene.parts, REACH)
    apart = _apart(scene, joints, near)
    friction, pairs = _friction(scene, near)
    down = values_of(words_of(root.find("world"), "gravity", USUAL_GRAVITY), 3, "gravity")
    notes = [*document.notes, *_left_words(scene)]
    if not down.any():
        down = values_of(USUAL_GRAVITY, 3, "gravity")
        notes.append("the world has no gravity: 9.8 m/s^2 along -z is assumed")
    if apart:
        notes.append(
            f"links of the same model do not touch each other, as in the simulator: {len(apart)} "
            "pairs; --contacts geometry lets them touch"
        )
    return Assembly(
        scene.parts,
        units="m",
        gravity=down,
        joints=joints,
        contacts=apart,
        friction=friction,
        friction_pairs=pairs,
        source=str(path),
        notes=notes,
    )


def _left_words(scene: _Scene) -> list[str]:
    """A note that counts the things that are left out; an empty list if there are none."""
    words = ", ".join(f"{what} ({count})" for what, count in scene.left.items())
    return [f"left out: {words}"] if words else []


def _add_link(scene: _Scene, model: Model, link: Element, *, alone: bool) -> None:
    """Add the part of a link; `alone`: whether it is the only link of its model."""
    name = scoped(model.name, link.get("name", ""))
    frame = scene.document.pose(name)
    rows = link.findall("collision")
    collides = bool(rows)
    shapes, mus = [], []
    for row in rows or link.findall("visual"):
        try:
            inner = scene.document.pose(relative_to(row, model.name, name)) @ pose_of(row)
            mu = _mu(row)
            shape = _shape(scene, model, name, row, inner, mu)
        except InputError as error:
            raise error.located(part=name) from None
        if shape is not None:
            shapes.append((shape, inner))
            mus.append(mu)
    if not shapes:
        if any(plane.link == name for plane in scene.planes):
            scene.part_of[name] = GROUND
        elif not model.static:
            scene.left["links without shapes"] += 1
        return
    try:
        shape, pose = one_body(shapes, name, scene.document.notes)
        part = Part(
            scene.free_name(model.name if alone and model.name else name),
            shape,
            pose,
            grounded=model.static,
            geometry="collider" if collides else "visual",
        )
        part = replace(part, **_inertia(scene, link, frame, pose, name))
    except InputError as error:
        raise error.located(part=name) from None
    if len(set(mus)) > 1:
        scene.document.notes.append(
            f"{name!r:.80} has friction of {min(mus):g} to {max(mus):g}; {min(mus):g} is used"
        )
    scene.parts.append(part)
    scene.mu.append(min(mus))
    touching = words_of(model.element, "self_collide") in ("true", "1")
    scene.model.append("" if touching or model.static else model.top)
    scene.part_of[name] = part.name


def _mu(row: Element) -> float:
    """Friction coefficient of a collision: the lesser of both directions."""
    ode = row.find("surface/friction/ode")
    values = [
        float(values_of(words_of(ode, tag), 1, tag)[0])
        for tag in ("mu", "mu2")
        if words_of(ode, tag)
    ]
    return max(min([*values] or [USUAL_FRICTION]), 0.0)


def _inertia(scene: _Scene, link: Element, frame: Pose, pose: Pose, name: str) -> dict[str, Any]:
    """Mass, centre and inertia of a link, as fields of its part with this pose."""
    inertial = link.find("inertial")
    if inertial is None or inertial.get("auto") in ("true", "1"):
        density = "" if inertial is None else words_of(inertial, "density")
        return {"density": float(values_of(density, 1, "density")[0])} if density else {}
    mass = float(values_of(words_of(inertial, "mass", "1"), 1, "mass")[0])
    if mass <= 0:
        scene.document.notes.append(f"the mass of {name!r:.80} is {mass:g}, so it has its density")
        return {}
    own = pose_of(inertial)
    tensor = inertial.find("inertia")
    usual = {"ixx": "1", "iyy": "1", "izz": "1"}
    moments = [
        float(values_of(words_of(tensor, key, usual.get(key, "0")), 1, key)[0]) for key in KEYS
    ]
    matrix = inertia_matrix(np.array(moments))
    fault = "" if tensor is None else inertia_fault(matrix)
    if fault:
        scene.document.notes.append(
            f"no body has the inertia of {name!r:.80}, so that of its shape is used: {fault}"
        )
    turned = own.matrix @ matrix @ own.matrix.T
    fields: dict[str, Any] = MassProperties(mass, own.position, turned).outside(frame).fields(pose)
    if tensor is None or fault:
        del fields["inertia"]
    return fields


def _shape(
    scene: _Scene, model: Model, link: str, row: Element, place: Pose, mu: float
) -> Shape | None:
    """The shape of a collision or a visual; None for a plane, and for shapes that are left out."""
    geometry = row.find("geometry")
    inner = geometry[0] if geometry is not None and len(geometry) else None
    kind = "" if inner is None else inner.tag
    if kind == "box":
        return Box(values_of(words_of(inner, "size", "1 1 1"), 3, "size"))
    if kind == "sphere":
        return Sphere(float(values_of(words_of(inner, "radius", "1"), 1, "radius")[0]))
    if kind in ("cylinder", "capsule"):
        radius, length = (
            float(values_of(words_of(inner, tag, "1"), 1, tag)[0]) for tag in ("radius", "length")
        )
        return capsule(radius, length) if kind == "capsule" else Cylinder(radius, length)
    if kind == "ellipsoid":
        return ellipsoid(values_of(words_of(inner, "radii", "1 1 1"), 3, "radii"))
    if kind == "plane" and row.tag == "collision":
        normal = values_of(words_of(inner, "normal", "0 0 1"), 3, "normal")
        upright = place @ Pose([0, 0, 0], rotation_between([0, 0, 1], normal))
        scene.planes.append(_Plane(link, model.name or link, upright, mu))
        return None
    if kind == "mesh" and inner is not None:
        return _mesh(scene, model, inner)
    if kind not in ("empty", "plane"):
        scene.left[f"shapes of type {kind or 'nothing'}"] += 1
    return None


def _mesh(scene: _Scene, model: Model, row: Element) -> Shape | None:
    """The mesh that a `mesh` element names; None if its file is absent or of an unknown type."""
    uri = words_of(row, "uri")
    paths = list(named_paths(uri, model.folder))
    path = next((path for path in paths if is_file(path)), None)
    if path is None:
        scene.left[f"shapes whose mesh file is absent ({uri.rpartition('/')[2]!r:.60})"] += 1
        return None
    if path.suffix.lower() not in MESHES:
        scene.left[f"meshes of type {path.suffix}"] += 1
        return None
    require_regular(path)
    bodies = read_bodies(path)
    chosen = words_of(row.find("submesh"), "name")
    rows = list(zip(bodies.names, bodies.in_units("m"), strict=True))
    if chosen and any(name == chosen for name, _ in rows):
        rows = [each for each in rows if each[0] == chosen]
    mesh = join_meshes([mesh for _, (mesh, _) in rows if isinstance(mesh, Mesh)])
    scene.tally.add(len(mesh.triangles))
    scale = values_of(words_of(row, "scale", "1 1 1"), 3, "scale")
    return transform_mesh(mesh, np.diag([*scale, 1.0]))


def _add_planes(scene: _Scene) -> None:
    """Add a held table for each plane, large enough for all parts."""
    parts = list(scene.parts)
    for plane in scene.planes:
        scene.parts.append(plane_table(scene.free_name(plane.name), plane.pose, np.zeros(2), parts))
        scene.mu.append(plane.mu)
        scene.model.append("")


def _joints(scene: _Scene, model: Model) -> list[Joint]:
    """The joints of a model between links with parts, or the ground."""
    found = []
    for row in model.element.findall("joint"):
        ends = [words_of(row, end) for end in ("child", "parent")]
        child, parent = (
            GROUND if end == "world" else scene.part_of.get(scoped(model.name, end), "")
            for end in ends
        )
        kind = KINDS.get(row.get("type", ""))
        if kind is None:
            scene.left[f"joints of type {row.get('type', '')!r:.40}"] += 1
        elif not child or not parent or child == parent:
            scene.left["joints of links without shapes"] += 1
        elif child == GROUND:
            scene.left["joints whose child is the world"] += 1
        else:
            name = scoped(model.name, row.get("name", ""))
            try:
                found.append(_joint(scene, model, row, (child, parent), kind))
            except InputError as error:
                raise error.located(part=name) from None
    return found


def _joint(scene: _Scene, model: Model, row: Element, parts: tuple[str, str], kind: str) -> Joint:
    """The joint of two parts that an element states."""
    if kind == "fixed":
        return Joint(parts)
    name = scoped(model.name, row.get("name", ""))
    frame = scene.document.pose(name)
    if kind == "spherical":
        return Joint(parts, "spherical", point=frame.position)
    first = _axis(scene, model, row, "axis", frame)
    if kind == "general":
        second = _axis(scene, model, row, "axis2", frame)
        return Joint(parts, "general", point=frame.position, turns=[second, first])
    axis = row.find("axis")
    limit, dynamics = (None if axis is None else axis.find(tag) for tag in ("limit", "dynamics"))
    low, high = (
        float(values_of(words_of(limit, tag, usual), 1, tag)[0])
        for tag, usual in (("lower", "-1e16"), ("upper", "1e16"))
    )
    guide: dict[str, Any] = {
        key: float(values_of(words_of(dynamics, tag, "0"), 1, tag)[0])
        for key, tag in (
            ("friction", "friction"),
            ("stiffness", "spring_stiffness"),
            ("rest", "spring_reference"),
        )
    }
    if row.get("type") != "continuous" and min(-low, high) < UNLIMITED:
        guide["limits"] = (low, high)
        if low > high:
            scene.document.notes.append(f"the limits of the joint {name!r:.80} are ignored")
            del guide["limits"]
    return Joint(parts, kind, point=frame.position, axis=first, **guide)  # type: ignore[arg-type]


def _axis(scene: _Scene, model: Model, row: Element, tag: str, frame: Pose) -> Array:
    """Direction of an axis of a joint in the world, from the frame that expresses it."""
    axis = row.find(tag)
    xyz = values_of(words_of(axis, "xyz", "0 0 1"), 3, "xyz")
    element = None if axis is None else axis.find("xyz")
    name = "" if element is None else element.get("expressed_in", "")
    if words_of(axis, "use_parent_model_frame") in ("true", "1"):
        name = "__model__"
    turn = scene.document.pose(scoped(model.name, name)) if name else frame
    direction: Array = turn.matrix @ xyz
    return direction


def _apart(scene: _Scene, joints: list[Joint], near: tuple[Index, Index]) -> list[GivenContact]:
    """Pairs of near links that do not touch: of the same model, or with a common joint."""
    a, b = near
    names = [part.name for part in scene.parts]
    joined = {frozenset(joint.parts) for joint in joints}
    found = []
    for i, j in zip(a.tolist(), b.tolist(), strict=True):
        pair = names[i], names[j]
        same = scene.model[i] and scene.model[i] == scene.model[j]
        if same or frozenset(pair) in joined:
            found.append(GivenContact(pair, [], [0, 0, 1]))
    return found


def _friction(scene: _Scene, near: tuple[Index, Index]) -> tuple[float, list[FrictionPair]]:
    """The most frequent friction coefficient, and pairs of near parts with another one."""
    a, b = near
    mu = np.array(scene.mu)
    lesser = np.minimum(mu[a], mu[b])
    if not len(lesser):
        return float(mu.min()), []
    values, count = np.unique(lesser, return_counts=True)
    usual = float(values[np.argmax(count)])
    names = [part.name for part in scene.parts]
    other = np.flatnonzero(lesser != usual)
    pairs = [FrictionPair((names[a[k]], names[b[k]]), float(lesser[k])) for k in other]
    return usual, pairs
