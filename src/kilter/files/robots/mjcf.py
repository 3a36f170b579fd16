"""Convert an assembly to an MJCF scene, to watch an answer in MuJoCo.

Held parts become fixed bodies, other parts free bodies, with the same names, masses, centres and
inertia, in metres. Boxes, cylinders, spheres and capsules are exact. A compound has a geom for each
of its shapes. Other meshes are copied, but MuJoCo collides with their convex hulls. Friction pairs
become contact pairs; pieces of a part without a geom of their own have the least friction of their
pair. Pairs of parts that never touch are excluded. Fixed and spherical joints become
equalities, a revolute joint two connections on its axis. Contacts in MuJoCo are soft: a barely
stable assembly may creep.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations, product
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array, Index
from kilter.assembly import Assembly, Part
from kilter.assembly.interactions import FrictionPair, Joint
from kilter.assembly.part import GROUND
from kilter.errors import InputError, some_names
from kilter.files.meshes.placed import distinct
from kilter.files.robots.one_body import compose
from kilter.rigid import Pose, matrix_to_quaternion
from kilter.shape.primitives import Box, Cylinder, Mesh, Shape, Sphere, hull_surface, surface
from kilter.units import metres_per_unit

LEAST = 1e-5
"""Least friction coefficient that MuJoCo accepts [-]."""
SMALL = 1e-9
"""Least ratio of the smallest to the largest principal inertia that MuJoCo accepts [-]."""
CONVEX = 1e-6
"""Largest share by which the hull of a mesh that counts as convex has more volume [-]."""
Element = ElementTree.Element


class Geom(NamedTuple):
    """A geom of a body: its shape, its pose in the frame of the part, its name and its piece.

    The piece is None for a geom that has several pieces.
    """

    name: str
    shape: Shape
    pose: Pose
    piece: int | None


def to_mjcf(assembly: Assembly) -> str:
    """The text of an MJCF file (a scene for MuJoCo) with all parts of an assembly.

    Raises
    ------
    InputError
        If the assembly has loads or sliding joints; MJCF has neither between free bodies.

    Examples
    --------
    >>> from kilter.assembly import Part
    >>> text = to_mjcf(Assembly([Part("cube", Box([1, 1, 1]), grounded=True)]))
    >>> '<geom name="cube" type="box" size="0.5 0.5 0.5"' in text
    True
    """
    if assembly.loads or assembly.straps:
        raise InputError(
            "MJCF has no loads and no straps of known tension",
            hint="remove them, and set data.xfrc_applied in the simulation",
        )
    metres = metres_per_unit(assembly.units)
    root = Element("mujoco", model="kilter")
    ElementTree.SubElement(root, "compiler", angle="radian", balanceinertia="true")
    ElementTree.SubElement(root, "option", gravity=_words(assembly.gravity))
    assets = ElementTree.SubElement(root, "asset")
    world = ElementTree.SubElement(root, "worldbody")
    geoms = _geoms(assembly)
    for k, part in enumerate(assembly.parts):
        body = _body(world, assembly, k, part, metres)
        for geom in geoms[part.name]:
            _add_geom(body, assets, geom, _friction(assembly.friction), metres)
    _pairs(root, assembly, geoms)
    equalities = ElementTree.SubElement(root, "equality")
    for joint in assembly.joints:
        _equality(equalities, assembly, joint, metres)
    for note in hull_notes(assembly):
        root.insert(0, ElementTree.Comment(f" {note.replace('--', '- -')} "))
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def hull_notes(assembly: Assembly) -> list[str]:
    """A sentence about the parts whose hollows MuJoCo fills; an empty list without such parts."""
    filled = [
        part.name
        for part in assembly.parts
        if not all(_is_convex(shape) for shape, _, _ in _members(part.shape))
    ]
    if not filled:
        return []
    return [f"MuJoCo closes the hollows of meshes without convex pieces: {some_names(filled)}"]


def _is_convex(shape: Shape) -> bool:
    """Whether the convex hull of a shape has no more volume than the shape."""
    if isinstance(shape, Box | Cylinder | Sphere) or capsule_size(shape) is not None:
        return True
    vertices, triangles = surface(shape)
    try:
        hull = _volume(*hull_surface(vertices))
    except InputError:
        return True  # a flat mesh
    return hull <= (1 + CONVEX) * _volume(vertices, triangles)


def _volume(vertices: Array, triangles: Index) -> float:
    """Volume inside a closed surface of triangles."""
    a, b, c = np.moveaxis((vertices - vertices.mean(axis=0))[triangles], 1, 0)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def capsule_size(shape: Shape) -> tuple[float, float] | None:
    """Radius and length of the cylinder of a capsule about z; None for another shape."""
    members = shape.members if isinstance(shape, Mesh) else ()
    if [type(member) for member, _ in members] != [Cylinder, Sphere, Sphere]:
        return None
    (rod, middle), *balls = members
    assert isinstance(rod, Cylinder)
    ends = [pose.position.tolist() for _, pose in balls]
    half = rod.height / 2
    fits = all(getattr(ball, "radius", None) == rod.radius for ball, _ in balls)
    fits = fits and middle == Pose() and ends == [[0, 0, -half], [0, 0, half]]
    return (rod.radius, rod.height) if fits else None


def _members(shape: Shape, outer: Pose | None = None) -> Iterator[tuple[Shape, Pose, int | None]]:
    """Shapes of which a shape is the union, with their poses in its frame and their pieces."""
    place = Pose() if outer is None else outer
    if not isinstance(shape, Mesh) or not shape.members or capsule_size(shape) is not None:
        several = isinstance(shape, Mesh) and shape.pieces is not None
        yield shape, place, None if several else 0
        return
    for (member, pose), piece in zip(shape.members, shape.member_pieces, strict=True):
        for inner, at, _ in _members(member, compose(place, pose)):
            yield inner, at, piece


def _geoms(assembly: Assembly) -> dict[str, list[Geom]]:
    """The geoms of each part by its name; the only geom of a part has the part's name."""
    members = {part.name: list(_members(part.shape)) for part in assembly.parts}
    wanted = list(members) + [
        f"{name}/{k}" for name, each in members.items() for k in range(len(each)) if len(each) > 1
    ]
    names = iter(distinct(wanted)[len(members) :])
    return {
        name: [Geom(name if len(each) == 1 else next(names), *member) for member in each]
        for name, each in members.items()
    }


def _body(world: Element, assembly: Assembly, k: int, part: Part, metres: float) -> Element:
    """Add part k to the MJCF world as a body without geoms, and return the body."""
    body = ElementTree.SubElement(
        world,
        "body",
        name=part.name,
        pos=_words(part.pose.position * metres),
        quat=_words(part.pose.rotation),
    )
    if not part.grounded:
        ElementTree.SubElement(body, "freejoint", name=f"{part.name}/free")
    ElementTree.SubElement(body, "inertial", _inertial(assembly, k, part, metres))
    return body


def _add_geom(body: Element, assets: Element, geom: Geom, friction: str, metres: float) -> None:
    """Add a geom to a body, and its mesh to the assets."""
    shape, capsule = geom.shape, capsule_size(geom.shape)
    words = {"name": geom.name}
    if geom.pose != Pose():
        words |= {"pos": _words(geom.pose.position * metres), "quat": _words(geom.pose.rotation)}
    if isinstance(shape, Box):
        words |= {"type": "box", "size": _words(shape.size / 2 * metres)}
    elif isinstance(shape, Cylinder):
        size = _words([shape.radius * metres, shape.height / 2 * metres])
        words |= {"type": "cylinder", "size": size}
    elif isinstance(shape, Sphere):
        words |= {"type": "sphere", "size": _words([shape.radius * metres])}
    elif capsule is not None:
        size = _words([capsule[0] * metres, capsule[1] / 2 * metres])
        words |= {"type": "capsule", "size": size}
    else:
        vertices, triangles = surface(shape)
        corners = {"vertex": _words((vertices * metres).ravel()), "face": _words(triangles.ravel())}
        ElementTree.SubElement(assets, "mesh", {"name": geom.name, **corners})
        words |= {"type": "mesh", "mesh": geom.name}
    ElementTree.SubElement(body, "geom", words, friction=friction)


def _inertial(assembly: Assembly, k: int, part: Part, metres: float) -> dict[str, str]:
    """XML attributes for the mass, centre and principal inertia of a part, in the body's frame."""
    geometry = assembly.geometry
    turn = part.pose.matrix
    center = turn.T @ (geometry.center[k] - part.pose.position) * metres
    inertia: Array = turn.T @ geometry.inertia[k] @ turn * metres**2
    sizes, axes = np.linalg.eigh((inertia + inertia.T) / 2)
    axes[:, 2] = np.cross(axes[:, 0], axes[:, 1])
    return {
        "mass": _words([geometry.mass[k]]),
        "pos": _words(center),
        "quat": _words(matrix_to_quaternion(axes)),
        "diaginertia": _words(np.maximum(sizes, SMALL * sizes.max())),
    }


def _pairs(root: Element, assembly: Assembly, geoms: dict[str, list[Geom]]) -> None:
    """Add friction pairs to the MJCF scene, and exclude contact between jointed parts.

    Pairs of parts that never touch are excluded, too.
    """
    contact = ElementTree.SubElement(root, "contact")
    entries: dict[tuple[str, str], list[FrictionPair]] = {}
    for entry in assembly.friction_pairs:
        ordered = _in_order(assembly, entry)
        entries.setdefault(ordered.parts, []).append(ordered)
    for parts, given in entries.items():
        for a, b in product(geoms[parts[0]], geoms[parts[1]]):
            mu = f"{max(_pair_friction(given, (a.piece, b.piece), assembly.friction), LEAST):.17g}"
            ElementTree.SubElement(
                contact,
                "pair",
                geom1=a.name,
                geom2=b.name,
                friction=f"{mu} {mu} {LEAST} {LEAST} {LEAST}",
            )
    connected = {frozenset(joint.parts) for joint in assembly.joints if GROUND not in joint.parts}
    apart = [given for given in assembly.contacts if not len(given.points)]
    connected |= {frozenset(given.parts) for given in apart if given.pieces is None}
    held = {part.name for part in assembly.parts if part.grounded}
    for one, other in combinations(assembly.names, 2) if connected else ():
        if {one, other} in connected and not {one, other} <= held:
            ElementTree.SubElement(contact, "exclude", body1=one, body2=other)


def _in_order(assembly: Assembly, entry: FrictionPair) -> FrictionPair:
    """A friction pair with its parts in the order of the assembly."""
    if assembly.index_of(entry.parts[0]) <= assembly.index_of(entry.parts[1]):
        return entry
    pieces = None if entry.pieces is None else entry.pieces[::-1]
    return FrictionPair(entry.parts[::-1], entry.mu, pieces)


def _pair_friction(
    entries: list[FrictionPair], pieces: tuple[int | None, int | None], usual: float
) -> float:
    """Friction coefficient of two geoms with given pieces, from the entries of their parts.

    Entries of pieces that a geom contains beside others count with the least value.
    """
    whole = [entry.mu for entry in entries if entry.pieces is None]
    own = [
        entry.mu
        for entry in entries
        if entry.pieces is not None
        and all(p is None or p == q for p, q in zip(pieces, entry.pieces, strict=True))
    ]
    if None not in pieces and own:
        return min(own)
    return min([*own, *(whole or [usual])])


def _equality(equalities: Element, assembly: Assembly, joint: Joint, metres: float) -> None:
    """Add a joint to the MJCF scene: a weld, or connections at one or two points of its axis."""
    first, second = joint.parts if joint.parts[0] != GROUND else joint.parts[::-1]
    ends = {"body1": first, **({} if second == GROUND else {"body2": second})}
    if joint.kind == "fixed":
        ElementTree.SubElement(equalities, "weld", ends)
        return
    if joint.kind not in ("revolute", "spherical"):
        raise InputError(
            f"MJCF has no {joint.kind} joint between free bodies",
            hint="fasten the two parts, or remove the joint",
        )
    if joint.guide:
        raise InputError(
            "MJCF has no limits, friction and springs of joints between free bodies",
            hint="remove them: joint.without('limits', 'friction', 'stiffness')",
        )
    pose = assembly[first].pose
    size = float(assembly.geometry.radius[assembly.index_of(first)])
    points = [joint.point]
    if joint.kind == "revolute":
        points = [joint.point - joint.axis * size / 2, joint.point + joint.axis * size / 2]
    for point in points:
        local = pose.matrix.T @ (point - pose.position) * metres
        ElementTree.SubElement(equalities, "connect", ends, anchor=_words(local))


def _friction(mu: float) -> str:
    """XML attribute with the sliding, torsional and rolling friction of a geom."""
    return f"{max(mu, LEAST):.17g} {LEAST} {LEAST}"


def _words(values: ArrayLike) -> str:
    """Numbers as text with all digits, separated by blanks."""
    return " ".join(f"{value:.17g}" for value in np.asarray(values).ravel().tolist())
