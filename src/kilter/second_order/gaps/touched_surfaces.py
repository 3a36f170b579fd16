"""Exact surface of each part at a contact: plane, sphere, cylinder, axis of revolution.

    PLANE      through a point, across a direction
    POINT      a sphere about it, or a corner
    LINE       a cylinder about it, or a straight edge
    AXIS       a cone, a torus, or any other surface of revolution about a line, with a point of it
    RAIL       the guide of a joint that slides along a line and does not turn

A joint has such a surface on both parts: POINT for a ball joint, AXIS for a hinge, LINE for a joint
that turns about and slides along an axis.

A screw with the velocity v(x) = v + omega x (x - o) keeps such a surface in place under

    PLANE   omega along n, n.v(p) = 0            3 dimensions
    POINT   v(p) = 0                             3
    LINE    omega along d, v(p) along d          2
    AXIS    omega along d, v(p) = 0              1
    RAIL    omega = 0, v(p) along d              1

Each condition is linear in (v, omega), and the screws that satisfy it generate a group of motions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across, cross
from kilter.assembly import Joint
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER, FREE, SPHERE
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import JOINT
from kilter.rigid import skew
from kilter.second_order.gaps.features import EDGE, FACE, VERTEX, Features
from kilter.second_order.gaps.joint_forms import of_joints

UNKNOWN, PLANE, POINT, LINE, AXIS, RAIL = range(-1, 5)
OF_JOINT = {"spherical": POINT, "revolute": AXIS, "cylindrical": LINE, "prismatic": RAIL}
"""Surface of each kind of joint that moves."""
ON = 1e-7
"""Largest distance of a point on a surface, over the size of the part [-]."""
FACES = 1e-9
"""Normals agree if 1 minus their cosine is below this [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Touched:
    """Exact surfaces of the first, or of the second, part at K contact rows; world frame.

    `kind`, shape (K,); `point`, shape (K, 3) [length unit]; `direction`, unit, shape (K, 3).
    """

    kind: Index
    point: Array
    direction: Array

    def conditions(self, origin: Array, length: float) -> list[Array]:
        """Linear conditions, (c, 6), on a screw motion that maps the surface of each row to itself.

        C (v, L omega) = 0, the velocity v at `origin`.
        """
        none = np.zeros((len(self.kind), 2, 3))
        sides = np.stack(across(self.direction), axis=1)
        turns = np.concatenate([none, sides], axis=2)
        at = np.concatenate(
            [np.tile(np.eye(3), (len(none), 1, 1)), -skew((self.point - origin) / length)], axis=2
        )
        no_turn = np.tile(np.hstack([np.zeros((3, 3)), np.eye(3)]), (len(none), 1, 1))
        along, beside = self.direction[:, None] @ at, sides @ at
        blocks = {
            UNKNOWN: np.tile(np.eye(6), (len(none), 1, 1)),
            PLANE: np.concatenate([turns, along], axis=1),
            POINT: at,
            LINE: np.concatenate([turns, beside], axis=1),
            AXIS: np.concatenate([turns, at], axis=1),
            RAIL: np.concatenate([no_turn, beside], axis=1),
        }
        return [blocks[int(kind)][k] for k, kind in enumerate(self.kind)]

    def level(self, down: Array) -> Mask:
        """Mask of the rows whose surface is a horizontal plane, shape (K,)."""
        level: Mask = (self.kind == PLANE) & (np.abs(self.direction @ down) > 1 - FACES)
        return level


def touched_surfaces(
    program: Program, features: Features, contacts: ContactSet, joints: Sequence[Joint] = ()
) -> tuple[Touched, Touched]:
    """Exact surfaces of parts a and of parts b at each contact row.

    A patch of kind "plane" is a plane. For a given contact, a face without curvature is a plane, a
    face with equal curvatures a sphere, and a face with a single nonzero curvature a cylinder; any
    other face, or a rim, counts by its stated axis of revolution.
    """
    joined = of_joints(program)
    patch = np.where(joined, -1, program.source)
    kinds = np.append(contacts.patch_kind, "joint")[patch]
    parts = np.vstack([contacts.patch_parts, [-1, -1]])[patch]
    sides = (
        (parts[:, 0], program.normal, features.kind_a, features.edge_a, features.curvature_a),
        (parts[:, 1], -program.normal, features.kind_b, features.edge_b, features.curvature_b),
    )
    flat, given, geometry = kinds == "plane", kinds == "given", contacts.assembly.geometry
    first, second = (_surfaces_of_side(program.point, *side, geometry, given) for side in sides)
    for side, axis in ((first, features.axis_a), (second, features.axis_b)):
        stated = (side.kind == UNKNOWN) & axis[:, 3:].any(axis=1)
        side.kind[stated] = AXIS
        side.point[stated], side.direction[stated] = axis[stated, :3], axis[stated, 3:]
        side.kind[flat], side.direction[flat] = PLANE, program.normal[flat]
        side.point[flat] = program.point[flat]
        for row in np.flatnonzero(joined):
            joint = joints[program.source[row]]
            # along a stop, friction or a spring no motion leaves forces and energy as they are
            moves = program.kind[row] == JOINT and not joint.stiffness
            side.kind[row] = OF_JOINT.get(joint.kind, UNKNOWN) if moves else UNKNOWN
            side.point[row] = program.point[row]
            side.direction[row] = program.normal[row] if joint.axis is None else joint.axis
    return first, second


def planes_of(touched: tuple[Touched, Touched]) -> Mask:
    """Mask of rows in which the surface of at least one part is a plane, shape (K,)."""
    planes: Mask = (touched[0].kind == PLANE) | (touched[1].kind == PLANE)
    return planes


def _surfaces_of_side(
    at: Array,
    part: Index,
    out: Array,
    kind: Index,
    edge: Array,
    curvature: Array,
    geometry: Geometry,
    given: Mask,
) -> Touched:
    """Exact surfaces of the parts on one side of the contacts, from normals and features."""
    touched = Touched(np.full(len(at), UNKNOWN), at.copy(), out.copy())
    bent = np.abs(curvature).max(axis=(1, 2), initial=0.0)
    on_surface = np.zeros(len(at), dtype=bool)
    for row in range(len(at)):
        if kind[row] == VERTEX:
            touched.kind[row] = POINT
        elif kind[row] == EDGE and not bent[row]:
            touched.kind[row], touched.direction[row] = LINE, edge[row]
        elif given[row] and kind[row] == FACE:
            _fill_stated_curvature(touched, row, curvature[row])
        elif part[row] >= 0 and not given[row]:
            on_surface[row] = True
    for k in np.unique(part[on_surface]):
        _on_surfaces(touched, np.flatnonzero(on_surface & (part == k)), int(k), geometry)
    return touched


def _fill_stated_curvature(touched: Touched, row: int, curvature: Array) -> None:
    """Replace a row's surface by the plane, sphere or cylinder of a stated curvature, (3, 3)."""
    frame = np.array(across(touched.direction[row][None]))[:, 0]
    values, vectors = np.linalg.eigh(frame @ curvature @ frame.T)
    size = np.abs(values).max()
    if size == 0:
        touched.kind[row] = PLANE
        return
    zero = np.abs(values) < FACES * size
    steepest = float(values[int(np.abs(values).argmax())])
    if zero.any():
        touched.point[row] -= touched.direction[row] / steepest
        touched.direction[row] = vectors[:, int(zero.argmax())] @ frame
        touched.kind[row] = LINE
    elif values[1] - values[0] < FACES * size:
        touched.point[row] -= touched.direction[row] / steepest
        touched.kind[row] = POINT


def _on_surfaces(touched: Touched, rows: Index, part: int, geometry: Geometry) -> None:
    """Fill in the surfaces of a part that pass through the contact points of its rows.

    A surface counts if its outward normal agrees with the direction of the row; a curved one goes
    before a plane.
    """
    surfaces, at, out = geometry.surfaces, touched.point[rows], touched.direction[rows]
    near = ON * geometry.size[part]
    candidates = np.arange(surfaces.start[part], surfaces.start[part + 1])
    candidates = candidates[surfaces.kind[candidates] != FREE]
    curved = np.full(len(rows), -1)
    for surface in candidates[::-1]:
        same = np.full(len(rows), surface)
        agrees = np.einsum("ij,ij->i", surfaces.outward(same, at), out) > 1 - FACES
        curved[(np.abs(surfaces.distance(same, at)) < near) & agrees] = surface
    on = curved >= 0
    kinds = np.full(max(SPHERE, CYLINDER, int(surfaces.kind.max(initial=0))) + 1, AXIS)
    kinds[SPHERE], kinds[CYLINDER] = POINT, LINE
    touched.kind[rows[on]] = kinds[surfaces.kind[curved[on]]]
    touched.point[rows[on]] = surfaces.point[curved[on]]
    axial = rows[on][touched.kind[rows[on]] != POINT]
    touched.direction[axial] = surfaces.axis[curved[np.isin(rows, axial)]]
    span = slice(geometry.triangle_start[part], geometry.triangle_start[part + 1])
    corners = geometry.vertices[geometry.triangles[span]][geometry.triangle_surface[span] < 0]
    normal = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    for k in np.flatnonzero(~on):
        faces = (normal @ out[k] > (1 - FACES) * size) & (size > 0)
        if (np.abs((corners[faces, 0] - at[k]) @ out[k]) < near).any():
            touched.kind[rows[k]] = PLANE
