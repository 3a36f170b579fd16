"""Convert an assembly to an MJCF scene, to watch an answer in MuJoCo.

Held parts become fixed bodies, other parts free bodies, with the same names, masses, centres and
inertia, in metres. Boxes, cylinders and spheres are exact. Meshes are copied, but MuJoCo collides
with their convex hulls. Friction pairs become contact pairs; pieces of a part have the least
friction of their pair. Fixed and spherical joints become
equalities, a revolute joint two connections on its axis. Contacts in MuJoCo are soft: a barely
stable assembly may creep.
"""

from __future__ import annotations

from itertools import combinations
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.assembly.interactions import Joint
from kilter.assembly.part import GROUND
from kilter.errors import InputError
from kilter.rigid import matrix_to_quaternion
from kilter.shape.primitives import Box, Cylinder, Sphere, surface
from kilter.units import metres_per_unit

LEAST = 1e-5
"""Least friction coefficient that MuJoCo accepts [-]."""
SMALL = 1e-9
"""Least ratio of the smallest to the largest principal inertia that MuJoCo accepts [-]."""
Element = ElementTree.Element


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
    for k, part in enumerate(assembly.parts):
        _body(world, assets, assembly, k, part, metres)
    _pairs(root, assembly)
    equalities = ElementTree.SubElement(root, "equality")
    for joint in assembly.joints:
        _equality(equalities, assembly, joint, metres)
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode") + "\n"


def _body(
    world: Element, assets: Element, assembly: Assembly, k: int, part: Part, metres: float
) -> None:
    """Add part k to the MJCF world as a body with a geom, and its mesh to the assets."""
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
    shape = part.shape
    kind, size = "mesh", ""
    if isinstance(shape, Box):
        kind, size = "box", _words(shape.size / 2 * metres)
    elif isinstance(shape, Cylinder):
        kind, size = "cylinder", _words([shape.radius * metres, shape.height / 2 * metres])
    elif isinstance(shape, Sphere):
        kind, size = "sphere", _words([shape.radius * metres])
    geom = {"name": part.name, "type": kind, **({"size": size} if size else {})}
    if kind == "mesh":
        vertices, triangles = surface(shape)
        ElementTree.SubElement(
            assets,
            "mesh",
            name=part.name,
            vertex=_words((vertices * metres).ravel()),
            face=_words(triangles.ravel()),
        )
        geom["mesh"] = part.name
    ElementTree.SubElement(body, "geom", geom, friction=_friction(assembly.friction))


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


def _pairs(root: Element, assembly: Assembly) -> None:
    """Add friction pairs to the MJCF scene, and exclude contact between jointed parts."""
    contact = ElementTree.SubElement(root, "contact")
    least: dict[frozenset[str], float] = {}
    whole = {frozenset(entry.parts) for entry in assembly.friction_pairs if entry.pieces is None}
    for entry in assembly.friction_pairs:
        pair = frozenset(entry.parts)
        usual = entry.mu if pair in whole else assembly.friction
        least[pair] = min(entry.mu, least.get(pair, usual))
    for pair, value in least.items():
        first, second = sorted(pair, key=assembly.index_of)
        mu = f"{max(value, LEAST):.17g}"
        ElementTree.SubElement(
            contact,
            "pair",
            geom1=first,
            geom2=second,
            friction=f"{mu} {mu} {LEAST} {LEAST} {LEAST}",
        )
    connected = {frozenset(joint.parts) for joint in assembly.joints if GROUND not in joint.parts}
    held = {part.name for part in assembly.parts if part.grounded}
    for first, second in combinations(assembly.names, 2) if connected else ():
        if {first, second} in connected and not {first, second} <= held:
            ElementTree.SubElement(contact, "exclude", body1=first, body2=second)


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
