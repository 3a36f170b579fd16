"""Read URDF robots: links as parts, in the zero position of every joint.

A link is one part with the collision shapes of the link, or else its visual shapes. Mass, centre
and inertia are those of its `inertial` element. Fixed joints fasten links. Revolute, continuous and
prismatic joints move within their limits, against their friction, since the file has no motors.
A joint whose `limit` states neither end has none. Links without shapes are frames;
their mass belongs to a link with a shape to which fixed joints connect them. The root is held,
unless the base is floating. Lengths are metres, z is up.

References
----------
ROS, urdf/XML: link, joint. Roll, pitch and yaw are rotations about fixed axes, in this order.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.assembly.geometry import MassProperties
from kilter.assembly.interactions import GivenContact, Joint
from kilter.assembly.part import GROUND, inertia_fault, inertia_matrix
from kilter.errors import InputError, some_names
from kilter.files.format_options import FormatOptions
from kilter.files.formats import MESHES, read_bodies
from kilter.files.limits import Tally, named_path, require_regular
from kilter.files.meshes.placed import join_meshes, transform_mesh
from kilter.files.robots.one_body import capsule, compose, held_note, one_body
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Cylinder, Mesh, Shape, Sphere
from kilter.validate import number

# Attributes of the XML elements of a URDF robot: text, numbers and poses.


Element = ElementTree.Element


def text_of(element: Element, key: str) -> str:
    """The value of a required XML attribute; raises `InputError` without it."""
    value = element.get(key, "")
    if not value:
        raise InputError(f"a {element.tag} has no {key}", hint=f'give {key}="..."')
    return value


def numbers_of(element: Element | None, key: str, count: int, default: str = "") -> list[float]:
    """The `count` numbers in an XML attribute; raises `InputError` if they are invalid."""
    words = (default if element is None else element.get(key, default)).split()
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = []
    if len(values) != count or not np.isfinite(values).all():
        tag = "element" if element is None else element.tag
        raise InputError(
            f"{key} of <{tag}> is {' '.join(words)!r:.60}", hint=f"give {count} numbers"
        )
    return values


def has_size(row: Element) -> bool:
    """Whether a shape is no mere point, such as a box of size 0 0 0 that marks a frame."""
    inner = row.find("geometry/*")
    words = [] if inner is None else f"{inner.get('size', '')} {inner.get('radius', '')}".split()
    return not words or any(word.strip("+-0.") for word in words)


def origin_of(element: Element) -> Pose:
    """The pose in the `origin` element of a URDF element."""
    origin = element.find("origin")
    r, p, y = numbers_of(origin, "rpy", 3, "0 0 0")
    cos, sin = np.cos([r, p, y]), np.sin([r, p, y])
    about_x = np.array([[1, 0, 0], [0, cos[0], -sin[0]], [0, sin[0], cos[0]]])
    about_y = np.array([[cos[1], 0, sin[1]], [0, 1, 0], [-sin[1], 0, cos[1]]])
    about_z = np.array([[cos[2], -sin[2], 0], [sin[2], cos[2], 0], [0, 0, 1]])
    turn = Pose.of(about_z @ about_y @ about_x)
    return Pose(numbers_of(origin, "xyz", 3, "0 0 0"), turn.rotation)


def joints_by_child(
    joints: Sequence[Element], child: Callable[[Element], str]
) -> dict[str, Element]:
    """The joint that carries each link; `child` returns the link that a joint carries.

    Raises `InputError` if two joints carry the same link.
    """
    leads: dict[str, Element] = {}
    for joint in joints:
        name = child(joint)
        if name in leads:
            raise InputError("it is the child of two joints", part=name, hint="a robot is a tree")
        leads[name] = joint
    return leads


# Mass, centre and inertia in the `inertial` elements of URDF links.


KEYS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
"""Attributes of an `inertia` element, in the order of `inertia_matrix`."""


@dataclass(frozen=True, slots=True, eq=False)
class Inertial:
    """Mass [kg], centre [m], and inertia about it [kg m^2] or None, in the frame of a link."""

    mass: float
    center: Array
    inertia: Array | None

    def placed(self, frame: Pose) -> MassProperties:
        """The mass properties in the world, without an inertia as those of a point mass."""
        inertia = np.zeros((3, 3)) if self.inertia is None else self.inertia
        return MassProperties(self.mass, self.center, inertia).outside(frame)


def read_inertial(link: Element, notes: list[str]) -> Inertial | None:
    """The mass, centre and inertia that a link states; None if it states no mass.

    A note is appended for a mass of zero, and for an inertia that no body has. An inertia of zeros
    counts as not stated.

    Raises `InputError` if a number is invalid or the mass is negative; the error names the link.
    """
    try:
        return _inertial(link, notes)
    except InputError as error:
        raise error.located(part=link.get("name")) from None


def _inertial(link: Element, notes: list[str]) -> Inertial | None:
    """The result of `read_inertial`; errors do not name the link."""
    inertial = link.find("inertial")
    element = None if inertial is None else inertial.find("mass")
    if inertial is None or element is None:
        return None
    mass = number(numbers_of(element, "value", 1, "0")[0], "mass", lowest=0)
    name = f"{link.get('name', '')!r:.80}"
    if mass == 0:
        notes.append(f"the mass of {name} is 0, so it has its density")
        return None
    frame = origin_of(inertial)
    tensor = inertial.find("inertia")
    own = inertia_matrix(np.array([numbers_of(tensor, key, 1, "0")[0] for key in KEYS]))
    fault = inertia_fault(own) if own.any() else ""
    if fault:
        notes.append(f"no body has the inertia of {name}, so that of its shape is used: {fault}")
    turned = frame.matrix @ own @ frame.matrix.T
    return Inertial(mass, frame.position, None if fault or not own.any() else turned)


MOVING = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}
"""Kind of `Joint` for each type of URDF joint that moves."""


def read_urdf(root: Element, path: Path, choices: FormatOptions) -> Assembly:
    """Build an assembly from the XML of a URDF robot.

    Raises `InputError` if a link or a joint is invalid; the error names it.
    """
    if choices.units not in (None, "m"):
        raise InputError(
            f"URDF is in m, but the units given are {choices.units}", hint="leave the units out"
        )
    _require_expanded(root)
    robot = _Robot(root, path)
    return robot.assembly(
        held=choices.base != "floating", loose=choices.loose_robots, source=str(path)
    )


def _require_expanded(root: Element) -> None:
    """Raise `InputError` if a robot is a template of xacro: its macros are not expanded."""
    for element in root.iter():
        values = element.attrib.values()
        if "xacro" in str(element.tag) or any(value.startswith(("${", "$(")) for value in values):
            raise InputError(
                "the robot is a template of xacro, whose macros are not expanded",
                hint="expand it first (xacro robot.xacro > robot.urdf), and give the result",
            )


class _Robot:
    """A URDF robot during its conversion: links, joints, and the pose of each link."""

    def __init__(self, root: Element, path: Path) -> None:
        self.folder = path.parent
        self.links: dict[str, Element] = {}
        for link in root.findall("link"):
            name = text_of(link, "name")
            if name in self.links:
                raise InputError("two links have this name", part=name, hint="rename a link")
            self.links[name] = link
        if not self.links:
            raise InputError("the robot has no links", hint="give it at least one link")
        self.leads = joints_by_child(root.findall("joint"), lambda joint: self._end(joint, "child"))
        """The joint whose child is a link."""
        self.motors = {
            text_of(joint, "name") for joint in root.findall("transmission/joint[@name]")
        }
        """Names of the joints with motors."""
        roots = [name for name in self.links if name not in self.leads]
        if len(roots) > 1:
            raise InputError(
                f"the robot has {len(roots)} roots: {some_names(roots)}",
                hint="join them to a single root",
            )
        self.root = roots[0] if roots else ""
        self.frames: dict[str, Pose] = {}
        """World pose of each link; a parent stands before its children."""
        for name in self.links:
            self._place(name)
        self.tally = Tally()
        self.notes: list[str] = []

    def _end(self, joint: Element, end: str) -> str:
        """Name of the link at an end ("parent" or "child") of a joint."""
        element = joint.find(end)
        name = "" if element is None else element.get("link", "")
        if name not in self.links:
            raise InputError(
                f"the {end} {name!r} of the joint {joint.get('name')!r} is not a link",
                hint=f"the links are {some_names(list(self.links))}",
            )
        return name

    def _place(self, name: str) -> None:
        """Compute the world poses of a link and of the links that carry it, in zero position."""
        chain: dict[str, Element | None] = {}
        while name not in self.frames:
            if name in chain:
                raise InputError("its joints form a loop", part=name, hint="a robot is a tree")
            joint = chain[name] = self.leads.get(name)
            if joint is None:
                break
            name = self._end(joint, "parent")
        for below, joint in reversed(chain.items()):
            if joint is None:
                self.frames[below] = Pose()
            else:
                parent = self.frames[self._end(joint, "parent")]
                self.frames[below] = compose(parent, origin_of(joint))

    def _driven(self, held: bool) -> set[str]:
        """Links of the kinematic trees that motors move; a held root belongs to none."""
        top: dict[str, str] = {}
        for name in self.frames:
            joint = self.leads.get(name)
            if joint is None:
                top[name] = "" if held else name
                continue
            top[name] = top[self._end(joint, "parent")]
            if not top[name] and joint.get("type") != "fixed":
                top[name] = name
        moved = {
            top[link]
            for link, joint in self.leads.items()
            if joint.get("name") in self.motors and joint.get("type") in MOVING
        }
        return {name for name in self.links if top[name] and top[name] in moved}

    def assembly(self, *, held: bool, loose: bool, source: str) -> Assembly:
        """The robot as a kilter assembly.

        Arguments: `held`: whether its root link is held; `loose`: whether motors hold nothing.
        """
        shapes = {name: self._shapes(link) for name, link in self.links.items()}
        solid = [name for name in self.links if shapes[name]]
        if not solid:
            raise InputError("no link has a shape", hint="give its links <collision> or <visual>")
        driven = set[str]() if loose else self._driven(held)
        if driven:
            self.notes.append(held_note(1, len(driven)))
        bearers = self._bearers(solid, held)
        carried = self._carried(bearers)
        parts = [
            self._part(
                name,
                shapes[name],
                carried.get(name, []),
                held=(held and name == self.root) or name in driven,
            )
            for name in solid
        ]
        joints = [joint for name in solid for joint in self._joint(name, bearers)]
        moving = sum(j.kind != "fixed" and not set(j.parts) & driven for j in joints)
        if moving:
            self.notes.append(
                f"joints without motors, which move within their limits: {moving}; "
                "links of a joint do not touch each other without --contacts geometry"
            )
        if held and len(parts) == 1:
            self.notes.append("the robot is its held root link: --base floating frees it")
        apart = [GivenContact(pair, [], [0, 0, 1]) for pair in _near_pairs(solid, joints)]
        joints = [joint for joint in joints if joint.parts[0] not in driven]
        return Assembly(
            parts, units="m", joints=joints, contacts=apart, source=source, notes=self.notes
        )

    def _fixed_above(self, name: str) -> str | None:
        """The link to which a fixed joint connects a link; None without one."""
        joint = self.leads.get(name)
        fixed = joint is not None and joint.get("type") == "fixed"
        return self._end(joint, "parent") if fixed and joint is not None else None

    def _bearers(self, solid: list[str], held: bool) -> dict[str, str]:
        """For each link, a link with a shape that moves with it, if there is one.

        It is the link itself, or the nearest link above it under fixed joints, or else the first
        link of the file that fixed joints connect to it. For a held root it is the ground.
        """
        shaped = set(solid)
        tops: dict[str, str] = {}
        for name in self.frames:
            above = self._fixed_above(name)
            tops[name] = name if name in shaped or above is None else tops[above]
        below = {self.root: GROUND} if held else {}
        for name in solid:
            above = self._fixed_above(name)
            if above is not None:
                below.setdefault(tops[above], name)
        found = {name: link if link in shaped else below.get(link) for name, link in tops.items()}
        return {name: link for name, link in found.items() if link is not None}

    def _carried(self, bearers: dict[str, str]) -> dict[str, list[MassProperties]]:
        """Masses of links without a shape, by the link with a shape that moves with them."""
        carried: dict[str, list[MassProperties]] = {}
        lost = []
        for name, link in self.links.items():
            inertial = read_inertial(link, []) if bearers.get(name) != name else None
            if inertial is None:
                continue
            if name in bearers:
                carried.setdefault(bearers[name], []).append(inertial.placed(self.frames[name]))
            else:
                lost.append(name)
        if lost:
            self.notes.append(
                f"no shape moves with these links, so their mass is ignored: {some_names(lost)}"
            )
        return carried

    def _part(
        self,
        name: str,
        shapes: list[tuple[Shape, Pose]],
        carried: list[MassProperties],
        *,
        held: bool,
    ) -> Part:
        """Build the part of a link from its shapes, with the masses that move with it."""
        try:
            shape, inner = one_body(shapes, name, self.notes)
            pose = compose(self.frames[name], inner)
            collides = self.links[name].find("collision") is not None
            geometry = "collider" if collides else "visual"
            part = Part(name, shape, pose, grounded=held, geometry=geometry)
            own = read_inertial(self.links[name], self.notes)
            if own is not None:
                stated: dict[str, Any] = own.placed(self.frames[name]).fields(pose)
                if own.inertia is None:
                    del stated["inertia"]
                part = replace(part, **stated)
            if carried and not held:
                total = MassProperties.sum([MassProperties.of_part(part), *carried])
                part = replace(part, **total.fields(pose))
            return part
        except InputError as error:
            raise error.located(part=name) from None

    def _joint(self, name: str, bearers: dict[str, str]) -> list[Joint]:
        """The joint of a link with the nearest link with a shape that carries it, or the ground.

        Links without shapes in between are passed. The list is empty for a root, and for a link
        that floats.
        """
        chain: list[Element] = []
        link, above = name, name
        while link in self.leads and above == name:
            chain.append(self.leads[link])
            link = self._end(chain[-1], "parent")
            above = bearers.get(link, name)
        moving = [element for element in chain if element.get("type") != "fixed"]
        if above == name or any(element.get("type") == "floating" for element in moving):
            return []
        if not moving:
            return [Joint((name, above))]
        kind = MOVING.get(moving[0].get("type", ""))
        if len(moving) > 1:
            raise InputError(
                f"{len(moving)} moving joints connect it to {above!r:.60} "
                "over links without shapes",
                part=name,
                hint="give these links shapes, or fix all joints but one",
            )
        if kind is None:
            raise InputError(
                f"its joint has the type {moving[0].get('type')}",
                part=name,
                hint="use one of fixed, floating, revolute, continuous, prismatic",
            )
        frame = self.frames[self._end(moving[0], "child")]
        axis = frame.matrix @ numbers_of(moving[0].find("axis"), "xyz", 3, "1 0 0")
        try:
            guide = self._guide(moving[0])
            joint = Joint((name, above), kind, point=frame.position, axis=axis, **guide)  # type: ignore[arg-type]
        except InputError as error:
            raise error.located(part=name) from None
        return [joint]

    def _guide(self, element: Element) -> dict[str, Any]:
        """Limits and friction of a joint, as arguments of `Joint`; its drawn position is 0."""
        limit, dynamics = element.find("limit"), element.find("dynamics")
        guide: dict[str, Any] = {"friction": numbers_of(dynamics, "friction", 1, "0")[0]}
        stated = limit is not None and {"lower", "upper"} & set(limit.keys())
        if stated and element.get("type") != "continuous":
            low, high = (numbers_of(limit, end, 1, "0")[0] for end in ("lower", "upper"))
            if low > high:
                self.notes.append(
                    f"the limits of the joint {element.get('name')!r:.80} are ignored: the lower "
                    "is above the upper"
                )
            else:
                guide["limits"] = (low, high)
        return guide

    def _shapes(self, link: Element) -> list[tuple[Shape, Pose]]:
        """Collision shapes of a link, else its visual shapes, with their poses in its frame."""
        rows = [row for row in link.findall("collision") or link.findall("visual") if has_size(row)]
        try:
            return [(self._shape(row), origin_of(row)) for row in rows]
        except InputError as error:
            raise error.located(part=link.get("name")) from None

    def _shape(self, row: Element) -> Shape:
        """The shape in a `collision` or `visual` element of the XML."""
        geometry = row.find("geometry")
        inner = geometry[0] if geometry is not None and len(geometry) else None
        kind = "" if inner is None else inner.tag
        if inner is None or kind not in ("box", "sphere", "cylinder", "capsule", "mesh"):
            raise InputError(
                f"a shape has the type {kind!r}" if kind else "a geometry has no shape",
                hint="give a box, cylinder, capsule, sphere or mesh",
            )
        if kind == "box":
            return Box(numbers_of(inner, "size", 3))
        if kind == "mesh":
            return self._mesh(inner)
        radius = numbers_of(inner, "radius", 1)[0]
        if kind == "sphere":
            return Sphere(radius)
        length = numbers_of(inner, "length", 1)[0]
        return capsule(radius, length) if kind == "capsule" else Cylinder(radius, length)

    def _mesh(self, row: Element) -> Mesh:
        """Read the mesh file that a `mesh` element names."""
        path = self._mesh_path(text_of(row, "filename"))
        if path.suffix.lower() not in MESHES:
            raise InputError(
                f"mesh files of type {path.suffix or '(no ending)'} cannot be read",
                hint=f"write it as {', '.join(MESHES)}",
            )
        bodies = [mesh for mesh, _ in read_bodies(path).in_units("m")]
        mesh = join_meshes([body for body in bodies if isinstance(body, Mesh)])
        self.tally.add(len(mesh.triangles))
        return transform_mesh(mesh, np.diag([*numbers_of(row, "scale", 3, "1 1 1"), 1.0]))

    def _mesh_path(self, name: str) -> Path:
        """Path of a mesh file; ``package://`` names are looked up in the folders above."""
        plain = name.removeprefix("file://").removeprefix("package://")
        if not name.startswith("package://"):
            return named_path(self.folder, plain, self.folder.resolve().parent)
        for folder in (self.folder, *self.folder.resolve().parents):
            for inner in (plain, plain.partition("/")[2]):
                if (folder / inner).is_file():
                    return named_path(folder, inner)
        require_regular(self.folder / plain)
        return self.folder / plain


def _near_pairs(links: list[str], joints: list[Joint]) -> list[tuple[str, str]]:
    """Pairs of links of the same rigid group, or of two groups that a joint connects.

    Fixed joints connect the links of a group. Simulators let such pairs not touch.
    """
    above = dict(joint.parts for joint in joints if joint.kind == "fixed")
    top = {}
    for link in [*links, GROUND]:
        first = link
        while first in above:
            first = above[first]
        top[link] = first
    groups: dict[str, list[str]] = {}
    for link in links:
        groups.setdefault(top[link], []).append(link)
    pairs: list[tuple[str, str]] = []
    for a, b in dict.fromkeys(
        (top[child], top[parent]) for child, parent in (j.parts for j in joints)
    ):
        pairs += combinations(groups[a], 2) if a == b else product(groups[a], groups.get(b, []))
    return pairs
