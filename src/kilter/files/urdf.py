"""URDF robots: links as parts, at the zero of every joint.

A link is one part, of its collision shapes (of what is seen where it has none); its mass and
centre are those of its `inertial`. Fixed joints join links firmly; revolute, continuous and
prismatic ones are free to move, since motors are not in the file. Links without shapes are frames.
The root is held, unless its base is floating. Lengths are metres, z is up.

References
----------
ROS, urdf/XML: link, joint; roll, pitch and yaw are about fixed axes, in this order.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.assembly.interactions import Joint
from kilter.errors import InputError, some_names
from kilter.files.choices import Choices
from kilter.files.formats import MESHES, read_bodies
from kilter.files.limits import Tally, named_path
from kilter.files.one_body import combined, one_body
from kilter.files.placed import joined, placed
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Cylinder, Mesh, Shape, Sphere

__all__ = ["BASES", "read_urdf"]

BASES = ("fixed", "floating")
MOVING = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}
Element = ElementTree.Element


def read_urdf(root: Element, path: Path, choices: Choices) -> Assembly:
    """The assembly of a robot.

    Raises
    ------
    InputError
        If a link or a joint is not as the format has it; it names it.
    """
    if choices.units not in (None, "m"):
        raise InputError(
            f"URDF is in m, {choices.units} were asked for", hint="leave the units out"
        )
    robot = _Robot(root, path)
    return robot.assembly(held=choices.base != "floating", source=str(path))


class _Robot:
    """Links and joints by name, and where each link is."""

    def __init__(self, root: Element, path: Path) -> None:
        self.folder = path.parent
        self.links = {_text(link, "name"): link for link in root.findall("link")}
        if not self.links:
            raise InputError("a robot without links", hint="give it one link or more")
        self.joints = root.findall("joint")
        self.leads = {self._end(joint, "child"): joint for joint in self.joints}
        """The joint that leads to a link."""
        self.frames: dict[str, Pose] = {}
        for name in self.links:
            self._place(name)
        self.tally = Tally()

    def _end(self, joint: Element, end: str) -> str:
        """The link at an end of a joint."""
        found = joint.find(end)
        name = "" if found is None else found.get("link", "")
        if name not in self.links:
            raise InputError(
                f"the joint {joint.get('name')!r} names {name!r} as its {end}, which is no link",
                hint=f"there are: {some_names(list(self.links))}",
            )
        return name

    def _place(self, name: str) -> None:
        """The pose of a link in the world, at the zero of every joint, and of those above it."""
        chain: dict[str, Element | None] = {}
        while name not in self.frames:
            if name in chain:
                raise InputError("its joints run in a circle", part=name, hint="a robot is a tree")
            joint = chain[name] = self.leads.get(name)
            if joint is None:
                break
            name = self._end(joint, "parent")
        for below, joint in reversed(chain.items()):
            if joint is None:
                self.frames[below] = Pose()
            else:
                parent = self.frames[self._end(joint, "parent")]
                self.frames[below] = combined(parent, _origin(joint))

    def assembly(self, *, held: bool, source: str) -> Assembly:
        """All of it."""
        roots = [name for name in self.links if name not in self.leads]
        shapes = {name: self._shapes(link) for name, link in self.links.items()}
        solid = {name for name, found in shapes.items() if found}
        parts = [
            self._part(name, shapes[name], held=held and name in roots)
            for name in self.links
            if name in solid
        ]
        if not parts:
            raise InputError("no link has a shape", hint="give its links <collision> or <visual>")
        joints = [found for name in self.links for found in self._joint(name, solid, held)]
        moving = sum(joint.kind != "fixed" for joint in joints)
        notes = [f"{moving} joints are free to move: motors and limits are not counted"]
        return Assembly(
            parts, units="m", joints=joints, source=source, notes=notes if moving else []
        )

    def _part(self, name: str, shapes: list[tuple[Shape, Pose]], *, held: bool) -> Part:
        inertial = self.links[name].find("inertial")
        mass = center = None
        try:
            shape, inner = one_body(shapes)
            if inertial is not None:
                mass = _numbers(inertial.find("mass"), "value", 1, "0")[0] or None
            if mass is not None and inertial is not None:
                center = (_origin(inertial).position - inner.position) @ inner.matrix
            pose = combined(self.frames[name], inner)
            return Part(name, shape, pose, grounded=held, mass=mass, center_of_mass=center)
        except InputError as error:
            raise error.located(part=name) from None

    def _joint(self, name: str, solid: set[str], held: bool) -> list[Joint]:
        """The joint that leads to a link that is a part; across frames that are fixed."""
        joint = self.leads.get(name)
        if joint is None or name not in solid:
            return []
        chain = [joint]
        above = self._end(joint, "parent")
        while above not in solid and above in self.leads:
            chain.append(self.leads[above])
            above = self._end(chain[-1], "parent")
        moving = [one for one in chain if one.get("type") != "fixed"]
        if any(one.get("type") == "floating" for one in moving):
            return []
        if above not in solid:
            if not held:
                return []
            above = "ground"
        if not moving:
            return [Joint((name, above))]
        kind = MOVING.get(moving[0].get("type", ""))
        if len(moving) > 1 or kind is None:
            words = " and ".join(str(one.get("type")) for one in moving)
            raise InputError(
                f"a joint of kind {words} leads to it",
                part=name,
                hint="one of fixed, floating, revolute, continuous, prismatic is read",
            )
        frame = self.frames[self._end(moving[0], "child")]
        axis = frame.matrix @ _numbers(moving[0].find("axis"), "xyz", 3, "1 0 0")
        return [Joint((name, above), kind, point=frame.position, axis=axis)]  # type: ignore[arg-type]

    def _shapes(self, link: Element) -> list[tuple[Shape, Pose]]:
        rows = link.findall("collision") or link.findall("visual")
        try:
            return [(self._shape(row), _origin(row)) for row in rows]
        except InputError as error:
            raise error.located(part=link.get("name")) from None

    def _shape(self, row: Element) -> Shape:
        geometry = row.find("geometry")
        inner = geometry[0] if geometry is not None and len(geometry) else None
        kind = "" if inner is None else inner.tag
        if inner is None or kind not in ("box", "sphere", "cylinder", "mesh"):
            raise InputError(
                f"a shape is {kind!r}" if kind else "a geometry has no shape",
                hint="give a box, cylinder, sphere or mesh",
            )
        if kind == "box":
            return Box(_numbers(inner, "size", 3))
        if kind == "mesh":
            return self._mesh(inner)
        radius = _numbers(inner, "radius", 1)[0]
        if kind == "sphere":
            return Sphere(radius)
        return Cylinder(radius, _numbers(inner, "length", 1)[0])

    def _mesh(self, row: Element) -> Mesh:
        path = self._found(_text(row, "filename"))
        if path.suffix.lower() not in MESHES:
            raise InputError(
                f"a mesh is a {path.suffix or 'file without ending'}",
                hint=f"write it as {', '.join(MESHES)}",
            )
        bodies = [mesh for mesh, _ in read_bodies(path).in_units("m")]
        mesh = joined([one for one in bodies if isinstance(one, Mesh)])
        self.tally.add(len(mesh.triangles))
        return placed(mesh, np.diag([*_numbers(row, "scale", 3, "1 1 1"), 1.0]))

    def _found(self, name: str) -> Path:
        """The file of a mesh; of a package: in the nearest folder above that has it."""
        plain = name.removeprefix("file://").removeprefix("package://")
        if not name.startswith("package://"):
            return named_path(self.folder, plain, self.folder.resolve().parent)
        for folder in (self.folder, *self.folder.resolve().parents):
            for inner in (plain, plain.partition("/")[2]):
                if (folder / inner).is_file():
                    return named_path(folder, inner)
        return self.folder / plain


def _text(element: Element, key: str) -> str:
    value = element.get(key, "")
    if not value:
        raise InputError(f"a {element.tag} has no {key}", hint=f'give {key}="..."')
    return value


def _numbers(element: Element | None, key: str, count: int, default: str = "") -> list[float]:
    words = (default if element is None else element.get(key, default)).split()
    try:
        values = [float(word) for word in words]
    except ValueError:
        values = []
    if len(values) != count or not np.isfinite(values).all():
        tag = "element" if element is None else element.tag
        raise InputError(
            f"{key} of a {tag} is {' '.join(words)!r:.60}", hint=f"give {count} numbers"
        )
    return values


def _origin(element: Element) -> Pose:
    """The pose that an element states: first roll, then pitch, then yaw, then the step."""
    found = element.find("origin")
    r, p, y = _numbers(found, "rpy", 3, "0 0 0")
    cos, sin = np.cos([r, p, y]), np.sin([r, p, y])
    about_x = np.array([[1, 0, 0], [0, cos[0], -sin[0]], [0, sin[0], cos[0]]])
    about_y = np.array([[cos[1], 0, sin[1]], [0, 1, 0], [-sin[1], 0, cos[1]]])
    about_z = np.array([[cos[2], -sin[2], 0], [sin[2], cos[2], 0], [0, 0, 1]])
    turn = Pose.of(about_z @ about_y @ about_x)
    return Pose(_numbers(found, "xyz", 3, "0 0 0"), turn.rotation)
