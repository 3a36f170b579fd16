"""The surface that each side of a contact touches, as far as it is known to all orders.

    PLANE      through a point, across a direction
    POINT      a sphere about it, or a corner
    LINE       a cylinder about it, or a straight edge
    AXIS       a cone, a torus, or any other surface of revolution about a line, with a point of it

What matters is which screws leave it where it is: a velocity v + omega x (x - o) everywhere does

    PLANE   omega along n, n.v(p) = 0            3 dimensions
    POINT   v(p) = 0                             3
    LINE    omega along d, v(p) along d          2
    AXIS    omega along d, v(p) = 0              1

Each is a linear condition on (v, omega), and each set of screws a group of motions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across, cross
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER, FREE, SPHERE
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.rigid import skew
from kilter.second_order.gaps.features import EDGE, FACE, VERTEX, Features

__all__ = [
    "AXIS",
    "LINE",
    "PLANE",
    "POINT",
    "UNKNOWN",
    "Touched",
    "planes_of",
    "touched_surfaces",
]

UNKNOWN, PLANE, POINT, LINE, AXIS = range(-1, 4)
ON = 1e-7
"""A point lies on a surface, over the size of the part."""
FACES = 1e-9
"""Less than 1 minus the cosine of normals that agree."""


@dataclass(frozen=True, slots=True, eq=False)
class Touched:
    """Of one side of K rows: kind (K,), point (K, 3) and unit direction (K, 3), world frame."""

    kind: Index
    point: Array
    direction: Array

    def conditions(self, row: int, origin: Array, length: float) -> Array:
        """Rows C, shape (c, 6): C (v, L omega) = 0 where a screw about `origin` leaves it be."""
        kind, d = int(self.kind[row]), self.direction[row]
        if kind == UNKNOWN:
            return np.eye(6)
        turn = np.hstack([np.zeros((3, 3)), np.eye(3)])
        at = np.hstack([np.eye(3), -skew(((self.point[row] - origin) / length)[None])[0]])
        sides = np.array(across(d[None]))[:, 0] if kind != POINT else np.eye(3)
        if kind == PLANE:
            return np.vstack([sides @ turn, d @ at])
        if kind == POINT:
            return at
        return np.vstack([sides @ turn, sides @ at if kind == LINE else at])

    def level(self, row: int | np.integer, down: Array) -> bool:
        """Whether it is a plane across gravity."""
        return bool(self.kind[row] == PLANE and abs(self.direction[row] @ down) > 1 - FACES)


def touched_surfaces(
    program: Program, features: Features, contacts: ContactSet
) -> tuple[Touched, Touched]:
    """The surfaces of parts a and b at each row.

    Planes of patches of the kind "plane". Of those that are "given" a face without curvature is a
    plane, one that curves alike all around a sphere, one that curves one way a cylinder; of any
    other, or a rim, what counts is the axis that it is said to be of revolution about.

    Parameters
    ----------
    program : Program
        Of contacts only.
    features : Features
        Of its rows.
    contacts : ContactSet
        That its rows are of.
    """
    parts, kinds = contacts.patch_parts[program.source], contacts.patch_kind[program.source]
    sides = (
        (parts[:, 0], program.normal, features.kind_a, features.edge_a, features.curvature_a),
        (parts[:, 1], -program.normal, features.kind_b, features.edge_b, features.curvature_b),
    )
    flat, given, geometry = kinds == "plane", kinds == "given", contacts.assembly.geometry
    first, second = (_touched(program.point, *one, geometry, given) for one in sides)
    for side, axis in ((first, features.axis_a), (second, features.axis_b)):
        said = (side.kind == UNKNOWN) & axis[:, 3:].any(axis=1)
        side.kind[said] = AXIS
        side.point[said], side.direction[said] = axis[said, :3], axis[said, 3:]
        side.kind[flat], side.direction[flat] = PLANE, program.normal[flat]
        side.point[flat] = program.point[flat]
    return first, second


def planes_of(touched: tuple[Touched, Touched]) -> Mask:
    """Rows in which a part touches by a plane, shape (K,)."""
    planes: Mask = (touched[0].kind == PLANE) | (touched[1].kind == PLANE)
    return planes


def _touched(
    at: Array,
    part: Index,
    out: Array,
    kind: Index,
    edge: Array,
    curvature: Array,
    geometry: Geometry,
    given: Mask,
) -> Touched:
    found = Touched(np.full(len(at), UNKNOWN), at.copy(), out.copy())
    bent = np.abs(curvature).max(axis=(1, 2), initial=0.0)
    for row in range(len(at)):
        if kind[row] == VERTEX:
            found.kind[row] = POINT
        elif kind[row] == EDGE and not bent[row]:
            found.kind[row], found.direction[row] = LINE, edge[row]
        elif given[row] and kind[row] == FACE:
            _as_stated(found, row, curvature[row])
        elif part[row] >= 0 and not given[row]:
            _on_surface(found, row, int(part[row]), geometry)
    return found


def _as_stated(found: Touched, row: int, curvature: Array) -> None:
    """The plane, sphere or cylinder of a stated curvature."""
    frame = np.array(across(found.direction[row][None]))[:, 0]
    values, vectors = np.linalg.eigh(frame @ curvature @ frame.T)
    size = np.abs(values).max()
    if size == 0:
        found.kind[row] = PLANE
        return
    zero = np.abs(values) < FACES * size
    steepest = float(values[int(np.abs(values).argmax())])
    if zero.any():
        found.point[row] -= found.direction[row] / steepest
        found.direction[row] = vectors[:, int(zero.argmax())] @ frame
        found.kind[row] = LINE
    elif values[1] - values[0] < FACES * size:
        found.point[row] -= found.direction[row] / steepest
        found.kind[row] = POINT


def _on_surface(found: Touched, row: int, part: int, geometry: Geometry) -> None:
    """What of a part's surface passes through the point of a row, across its direction."""
    surfaces, at, out = geometry.surfaces, found.point[row], found.direction[row]
    near = ON * geometry.size[part]
    own = np.arange(surfaces.start[part], surfaces.start[part + 1])
    own = own[surfaces.kind[own] != FREE]
    points = np.tile(at, (len(own), 1))
    agrees = np.einsum("ij,j->i", surfaces.outward(own, points), out) > 1 - FACES
    on = own[(np.abs(surfaces.distance(own, points)) < near) & agrees]
    if len(on):
        one = on[0]
        names = {SPHERE: POINT, CYLINDER: LINE}
        found.kind[row] = names.get(int(surfaces.kind[one]), AXIS)
        found.point[row] = surfaces.point[one]
        found.direction[row] = surfaces.axis[one] if found.kind[row] != POINT else out
        return
    span = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    corners = geometry.vertices[geometry.triangles[span]]
    flat = geometry.triangle_surface[span] < 0
    normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    faces = flat & (normal @ out > (1 - FACES) * size) & (size > 0)
    if (np.abs((corners[faces, 0] - at) @ out) < near).any():
        found.kind[row] = PLANE
