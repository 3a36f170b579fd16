"""Read URDF robots: links as parts, in the zero position of every joint.

A link is one part with the collision shapes of the link, or else its visual shapes. Mass and
centre are those of its `inertial` element. Fixed joints fasten links. Revolute, continuous and
prismatic joints are free to move, since the file has no motors. Links without shapes are frames.
The root is held, unless the base is floating. Lengths are metres, z is up.

References
----------
ROS, urdf/XML: link, joint. Roll, pitch and yaw are rotations about fixed axes, in this order.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.assembly.interactions import Joint
from kilter.errors import InputError, some_names
from kilter.files.format_options import FormatOptions
from kilter.files.formats import MESHES, read_bodies
from kilter.files.limits import Tally, named_path, require_regular
from kilter.files.one_body import compose, one_body
from kilter.files.placed import join_meshes, transform_mesh
from kilter.files.urdf_elements import (
    Element,
    joints_by_child,
    numbers_of,
    origin_of,
    text_of,
)
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Cylinder, Mesh, Shape, Sphere

__all__ = ["read_urdf"]

MOVING = {"revolute": "revolute", "continuous": "revolute", "prismatic": "prismatic"}
"""Kind of `Joint` for each type of URDF joint that moves."""


def read_urdf(root: Element, path: Path, choices: FormatOptions) -> Assembly:
    """Build an assembly from the XML of a URDF robot.

    Parameters
    ----------
    root : Element
        Root element of the file.
    path : Path
        Path of the file, which mesh paths are relative to.
    choices : FormatOptions
        The options `units` and `base`.

    Raises
    ------
    InputError
        If a link or a joint is invalid; the error names it.
    """
    if choices.units not in (None, "m"):
        raise InputError(
            f"URDF is in m, but the units given are {choices.units}", hint="leave the units out"
        )
    robot = _Robot(root, path)
    return robot.assembly(held=choices.base != "floating", source=str(path))


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
        roots = [name for name in self.links if name not in self.leads]
        if len(roots) > 1:
            raise InputError(
                f"the robot has {len(roots)} roots: {some_names(roots)}",
                hint="join them to a single root",
            )
        self.frames: dict[str, Pose] = {}
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

    def assembly(self, *, held: bool, source: str) -> Assembly:
        """The robot as a kilter assembly; `held` states whether its root link is held."""
        roots = [name for name in self.links if name not in self.leads]
        shapes = {name: self._shapes(link) for name, link in self.links.items()}
        solid = {name for name, link_shapes in shapes.items() if link_shapes}
        parts = [
            self._part(name, shapes[name], held=held and name in roots)
            for name in self.links
            if name in solid
        ]
        if not parts:
            raise InputError("no link has a shape", hint="give its links <collision> or <visual>")
        joints = [joint for name in self.links for joint in self._joint(name, solid, held)]
        moving = sum(joint.kind != "fixed" for joint in joints)
        if moving:
            self.notes.append(f"{moving} joints are free to move: motors and limits are ignored")
        return Assembly(parts, units="m", joints=joints, source=source, notes=self.notes)

    def _part(self, name: str, shapes: list[tuple[Shape, Pose]], *, held: bool) -> Part:
        """Build the part of a link from its shapes."""
        inertial = self.links[name].find("inertial")
        mass = center = None
        try:
            shape, inner = one_body(shapes, name, self.notes)
            if inertial is not None:
                mass = self._mass(name, inertial)
            if mass is not None and inertial is not None:
                center = (origin_of(inertial).position - inner.position) @ inner.matrix
            pose = compose(self.frames[name], inner)
            collides = self.links[name].find("collision") is not None
            return Part(
                name,
                shape,
                pose,
                grounded=held,
                mass=mass,
                center_of_mass=center,
                geometry="collider" if collides else "visual",
            )
        except InputError as error:
            raise error.located(part=name) from None

    def _mass(self, name: str, inertial: Element) -> float | None:
        """Mass in the `inertial` element of a link [kg]; None if it is 0 or not stated."""
        element = inertial.find("mass")
        if element is None:
            return None
        mass = numbers_of(element, "value", 1, "0")[0]
        if mass == 0:
            self.notes.append(f"the mass of {name!r:.80} is 0, so it has its density")
        return mass or None

    def _joint(self, name: str, solid: set[str], held: bool) -> list[Joint]:
        """The joint between a link and the nearest carrying link with a shape, or the ground.

        That is the link that carries it, its ancestor in the tree of links.

        Links without shapes in between are passed. The list is empty for a link without shapes,
        for a root, and for a link that floats.
        """
        joint = self.leads.get(name)
        if joint is None or name not in solid:
            return []
        chain = [joint]
        above = self._end(joint, "parent")
        while above not in solid and above in self.leads:
            chain.append(self.leads[above])
            above = self._end(chain[-1], "parent")
        moving = [element for element in chain if element.get("type") != "fixed"]
        if any(element.get("type") == "floating" for element in moving):
            return []
        if above not in solid:
            if not held:
                return []
            above = "ground"
        if not moving:
            return [Joint((name, above))]
        kind = MOVING.get(moving[0].get("type", ""))
        if len(moving) > 1 or kind is None:
            words = " and ".join(str(element.get("type")) for element in moving)
            raise InputError(
                f"its joint has the type {words}",
                part=name,
                hint="use one of fixed, floating, revolute, continuous, prismatic",
            )
        frame = self.frames[self._end(moving[0], "child")]
        axis = frame.matrix @ numbers_of(moving[0].find("axis"), "xyz", 3, "1 0 0")
        return [Joint((name, above), kind, point=frame.position, axis=axis)]  # type: ignore[arg-type]

    def _shapes(self, link: Element) -> list[tuple[Shape, Pose]]:
        """Collision shapes of a link, else its visual shapes, with their poses in its frame."""
        rows = link.findall("collision") or link.findall("visual")
        try:
            return [(self._shape(row), origin_of(row)) for row in rows]
        except InputError as error:
            raise error.located(part=link.get("name")) from None

    def _shape(self, row: Element) -> Shape:
        """The shape in a `collision` or `visual` element of the XML."""
        geometry = row.find("geometry")
        inner = geometry[0] if geometry is not None and len(geometry) else None
        kind = "" if inner is None else inner.tag
        if inner is None or kind not in ("box", "sphere", "cylinder", "mesh"):
            raise InputError(
                f"a shape has the type {kind!r}" if kind else "a geometry has no shape",
                hint="give a box, cylinder, sphere or mesh",
            )
        if kind == "box":
            return Box(numbers_of(inner, "size", 3))
        if kind == "mesh":
            return self._mesh(inner)
        radius = numbers_of(inner, "radius", 1)[0]
        if kind == "sphere":
            return Sphere(radius)
        return Cylinder(radius, numbers_of(inner, "length", 1)[0])

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
