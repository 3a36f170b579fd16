"""Contacts of curved faces without a contact formula, and bounds on their forces.

Free forms, a torus in a groove of the same size, and edges and corners on curved faces of meshes
have no formula. Edges and corners of exact solids (`kilter.contact.curved.edges_with_faces`,
`edges_with_edges`) may touch without a single normal. Such pairs are listed as unsupported.
A frictionless sphere is pushed through its centre, and the side of a cylinder across its axis;
every force and torque is possible for the other kinds. Rims of flat faces are given as inscribed
polygons; the circumscribed polygons bound the answer from the other side
(`kilter.contact.curved.rims`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across, ragged
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER, FREE, SPHERE
from kilter.contact.broad import joins
from kilter.contact.contact_set import PossibleContacts, UnsupportedContact
from kilter.contact.curved.edges_on_curves import edges_on_faces
from kilter.contact.curved.rims import Force, possible_forces
from kilter.contact.face_patches import FacePatches, explained
from kilter.contact.kept_pairs import KeptPairs
from kilter.contact.sharp.edges import Edges
from kilter.contact.triangle_distance import near_triangles

NearFaces = tuple[Index, Index, Index]
"""Rows of pairs of parts, curved surfaces, and edges of the other part that come near them."""

__all__ = ["RoundContacts", "beside_curved", "explained_points", "no_round_contacts",
           "round_contacts"]  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class RoundContacts:
    """Contacts at curved surfaces without a contact formula, with the forces they may exert.

    Attributes
    ----------
    unsupported : tuple of UnsupportedContact
        A record for each pair of parts.
    possible : PossibleContacts
    parts, points : ndarray, shape (n, 2) and (n, 3)
        All points of these contacts, with the parts that may touch there; world frame.
    """

    unsupported: tuple[UnsupportedContact, ...]
    possible: PossibleContacts
    parts: Index
    points: Array

    @staticmethod
    def join(blocks: Sequence[RoundContacts]) -> RoundContacts:
        """Concatenate contacts, in order."""
        return RoundContacts(
            tuple(contact for block in blocks for contact in block.unsupported),
            PossibleContacts.join(block.possible for block in blocks),
            np.concatenate([block.parts for block in blocks]),
            np.concatenate([block.points for block in blocks]),
        )

    def among(self, kept: KeptPairs) -> RoundContacts:
        """The contacts of some of the pairs, with new numbers."""
        rows = np.flatnonzero(kept.of_parts(*self.parts.T))
        return RoundContacts(
            kept.records(self.unsupported),
            kept.possible(self.possible),
            kept.new_part[self.parts[rows]],
            self.points[rows],
        )


def no_round_contacts() -> RoundContacts:
    """A value of `RoundContacts` without contacts."""
    none = np.empty((0, 2), dtype=np.int64), np.empty((0, 3))
    return RoundContacts((), possible_forces([], two_sided=True), *none)


def beside_curved(geometry: Geometry, parts: Index, points: Array, slack: Array) -> Mask:
    """Mask of points, shape (n, 3), within `slack` of a curved surface of either part."""
    s = geometry.surfaces
    is_near = np.zeros(len(points), dtype=bool)
    for side in parts.T:
        owner, row = ragged(s.start, side)
        off = np.abs(s.distance(row, points[owner]))
        near = (off <= slack[owner]) | (s.kind[row] == FREE)
        is_near[owner[near]] = True
    return is_near


def round_contacts(
    face_patches: FacePatches,
    edges: Edges,
    rows: Index,
    rims: tuple[Index, Array],
    on_faces: tuple[NearFaces, NearFaces],
    reach: Array,
) -> RoundContacts:
    """Contacts at curved surfaces of the pairs `rows` that no contact patch explains.

    Parameters
    ----------
    face_patches : FacePatches
    edges : Edges
        Edges of all parts of these pairs.
    rows : ndarray of int, shape (n,)
        Pairs to search.
    rims : (pair, point)
        Points at which corners and edges beside curved faces touch the other part.
    on_faces : pair of (pair, surface, edge)
        Edges of part b, and edges of part a, that come near curved faces of the other part.
    reach : ndarray, shape (number of pairs,)
        Largest gap at which the parts touch, or may touch [length unit].
    """
    search, curved = face_patches.search, face_patches.curved
    geometry, pairs = search.geometry, search.pairs
    points_of_pair: dict[int, list[tuple[Array, int]]] = {}

    def add_points(pair: Index, point: Array, surface: Index) -> None:
        """Add points that lie on no contact patch of their pair to `points_of_pair`."""
        for k in np.flatnonzero(~explained_points(face_patches, pair, point, reach)):
            points_of_pair.setdefault(int(pair[k]), []).append((point[k], int(surface[k])))

    add_points(rims[0], rims[1], np.full(len(rims[0]), -1))
    for turn, near in zip((False, True), on_faces, strict=True):
        add_points(*edges_on_faces(face_patches, edges, near, reach, turn=turn))
    chosen = curved.unknown[np.isin(curved.unknown[:, 0], rows)]
    patched = np.column_stack([curved.patches.pair, curved.surface]).tolist()
    patched = {tuple(row) for row in patched}
    chosen = chosen[[tuple(row) not in patched for row in chosen.tolist()]]
    for pair, i, j in chosen.tolist():
        point = _close_triangles(geometry, pairs[pair], (i, j), float(reach[pair]))
        add_points(np.full(len(point), pair), point, np.full(len(point), -1))
    return _round_contacts_of(geometry, pairs, points_of_pair)


def explained_points(face_patches: FacePatches, pair: Index, points: Array, reach: Array) -> Mask:
    """Mask of points on contact patches of their pairs, shape (n,).

    `reach` is the largest gap at which the parts of each pair may touch [length unit].
    """
    geometry, pairs = face_patches.search.geometry, face_patches.search.pairs
    pair = np.asarray(pair, dtype=np.int64)  # joined with an empty block it may be a float
    result = np.zeros(len(pair), dtype=bool)
    for name in np.unique(pair).tolist():
        of_pair = np.flatnonzero(pair == name)
        slack = float(reach[name] + 2 * geometry.slack[pairs[name]].max())
        result[of_pair] = explained(face_patches, name, points[of_pair], slack)
    return result | face_patches.smooth.explains(pair, points)


def _round_contacts_of(
    geometry: Geometry, pairs: Index, points_of_pair: dict[int, list[tuple[Array, int]]]
) -> RoundContacts:
    """Records of contacts without a formula, from the points and surfaces of each pair."""
    unsupported = []
    forces: list[Force] = []
    for pair in sorted(points_of_pair):
        if not points_of_pair[pair]:
            continue
        a, b = (int(k) for k in pairs[pair])
        point, _ = points_of_pair[pair][0]
        x, y, z = point.tolist()
        unsupported.append(UnsupportedContact((a, b), "curved", (x, y, z)))
        surfaces = {surface for _, surface in points_of_pair[pair]}
        if all(geometry.surfaces.kind[k] in (SPHERE, CYLINDER) for k in surfaces if k >= 0) and (
            min(surfaces) >= 0
        ):
            pair_forces = [force for k in sorted(surfaces) for force in _forces(geometry, k)]
        else:
            pair_forces = _any_wrench(point, float(geometry.radius[[a, b]].min()))
        forces.extend((a, b, force_point, normal) for force_point, normal in pair_forces)
    owner = [pair for pair, points in points_of_pair.items() for _ in points]
    points = [point for points in points_of_pair.values() for point, _ in points]
    return RoundContacts(
        tuple(unsupported),
        possible_forces(forces, two_sided=True),
        pairs[np.array(owner, dtype=np.int64)],
        np.array(points).reshape(-1, 3),
    )


def _any_wrench(point: Array, arm: float) -> list[tuple[Array, Array]]:
    """Six forces, as (point, direction), that together produce any force and any torque."""
    x, y, z = np.eye(3)
    at_point = [(point, x), (point, y), (point, z)]
    return [*at_point, (point + arm * x, y), (point + arm * x, z), (point + arm * y, z)]


def _forces(geometry: Geometry, surface: int) -> list[tuple[Array, Array]]:
    """Forces (point, direction) that a frictionless sphere or cylinder can exert at a contact."""
    s = geometry.surfaces
    center, axis = s.point[surface], s.axis[surface]
    if s.kind[surface] == SPHERE:
        return [(center, direction) for direction in np.eye(3)]
    corners = geometry.vertices[geometry.triangles[s.triangles_of(surface)]].reshape(-1, 3)
    along = (corners - center) @ axis
    ends = (center + along.min() * axis, center + along.max() * axis)
    return [(end, d) for end in ends for d in across(axis)]


# faces without a formula: near triangles ---------------------------------------------------


def _close_triangles(
    geometry: Geometry, parts: Index, surfaces: tuple[int, int], tolerance: float
) -> Array:
    """Points, shape (n, 3), at which two triangulated faces come within the tolerance.

    The tolerance includes the sagittas, the distances of triangles from true surfaces.
    """
    s = geometry.surfaces
    sides = []
    for part, surface in zip(parts.tolist(), surfaces, strict=True):
        if surface >= 0:
            rows = s.triangles_of(surface)
        else:
            span = np.arange(geometry.triangle_start[part], geometry.triangle_start[part + 1])
            rows = span[geometry.triangle_surface[span] < 0]
        sides.append(geometry.vertices[geometry.triangles[rows]])
    grow = tolerance + float(sum(s.sagitta[k] for k in surfaces if k >= 0))
    boxes = [(side.min(axis=1), side.max(axis=1)) for side in sides]
    owners = [np.zeros(len(side), dtype=np.int64) for side in sides]
    blocks = [np.empty((0, 3))]
    for _, i, j in joins(owners[0], boxes[0], owners[1], boxes[1], np.array([grow])):
        blocks.append(near_triangles(sides[0][i], sides[1][j], grow))
    return np.concatenate(blocks)
