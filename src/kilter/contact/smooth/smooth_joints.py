"""Contacts of smooth faces that lie on each other but have different triangles.

Two triangulations of the same curved face penetrate each other by their sagittas, and their corners
and edges interlock, although the faces do not. If the facets of two smooth faces do not lie on each
other pairwise, their facets, edges and corners are ignored. Instead the faces touch if the fitted
surfaces do, with the normals of these surfaces, within the gap tolerance plus a quarter of both
sagittas: the surfaces are known better than their triangles. Facets that do lie on each other
pairwise remain facets: then the flat faces are real.

Free forms of exact solids have no formula either. If a clearance closes the gap between two of
them, they touch in the same way, all over, with the normals of the fitted surfaces.

Fitted normals have an error. A straight direction in which both faces nearly slide, within the
difference of their normals, is set exactly free; and besides each normal, normals tilted by that
difference are possible. Points at which the sides differ by more than `SMOOTH_UNSURE` are dropped.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import product

import numpy as np

from kilter.arrays import Array, Index, across, starts, unit_rows
from kilter.contact.common.broad import joins
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.distances import TriangleTrees
from kilter.contact.common.findings import (
    FacePatches,
    Matches,
    SmoothFindings,
    SmoothJoint,
    may_be_smooth,
)
from kilter.contact.common.patches import Patches, PossibleContacts, UnsupportedContact
from kilter.contact.common.polygons import facet_frames, overlaps_of
from kilter.contact.contact_tolerances import (
    DISTANCE_ROUNDING,
    GAP,
    ONE_DIRECTION,
    PATCH_ANGLE,
    SMOOTH_FACING,
    SMOOTH_GAP,
    SMOOTH_LEAST,
    SMOOTH_UNSURE,
)
from kilter.contact.smooth.smooth_faces import SmoothFace, matches, smooth_faces
from kilter.work import stop_if_late

MOST = 96
"""Largest number of contact points of a smooth contact; those farthest apart are kept."""
DIRECTIONS = 4
"""Largest number of straight sliding directions that are tried."""
SIDES = 8
"""Sides of the pyramid around the cone of possible forces at a point."""
FEWEST = 6
"""Least number of contact points of a smooth contact."""
FACETS = 0.999
"""Fraction of the common area on which facets must lie flush to count as truly flat [-]."""


def find_smooth(so_far: FacePatches) -> SmoothFindings:
    """Find contacts of smooth faces: of two meshes, or where a clearance was closed."""
    search = so_far.search
    faces: dict[int, list[SmoothFace]] = search.smooth_faces
    joints: list[SmoothJoint] = []
    for row in np.flatnonzero(may_be_smooth(search)).tolist():
        parts = tuple(search.pairs[row].tolist())
        for part in parts:
            if part not in faces:
                mesh = bool(search.meshes[part])
                faces[part] = smooth_faces(search.geometry, part, mesh=mesh)
        for face_a in faces[parts[0]]:
            for face_b in faces[parts[1]]:
                stop_if_late()
                joints += _joint(search, row, (face_a, face_b))
    return SmoothFindings(
        patches=_patches(search, joints), unsupported=_unsure(search, joints), joints=tuple(joints)
    )


def _patches(search: ContactSearch, joints: Sequence[SmoothJoint]) -> Patches:
    """Contacts of smooth faces as contact patches, in order."""
    if not joints:
        return Patches.none()
    pair = np.array([joint.pair for joint in joints], dtype=np.int64)
    parts = search.pairs[pair]
    size = np.array([float(np.ptp(joint.matches.point, axis=0).max()) for joint in joints])
    every = Matches.join(joint.matches for joint in joints)
    start = starts([len(joint.matches) for joint in joints])
    gap = [(float(joint.matches.gap.min()), float(joint.matches.gap.max())) for joint in joints]
    return Patches(
        pair=pair,
        parts=parts,
        kind=np.full(len(joints), "smooth", dtype="<U11"),
        normal=unit_rows(np.add.reduceat(every.normal, start[:-1], axis=0)),
        area=np.array([joint.area for joint in joints]),
        gap=np.array(gap),
        accuracy=search.geometry.accuracy[parts].sum(axis=1) / size,
        doubt=np.array([joint.tilt for joint in joints]),
        mu=np.full(len(joints), np.nan),
        start=start,
        points=every.point,
        normals=every.normal,
    )


def _unsure(search: ContactSearch, joints: Sequence[SmoothJoint]) -> tuple[UnsupportedContact, ...]:
    """An `UnsupportedContact` for each smooth contact: fitted normals are never certain."""
    records: dict[tuple[int, int], UnsupportedContact] = {}
    for joint in joints:
        a, b = (int(k) for k in search.pairs[joint.pair])
        x, y, z = joint.matches.point[0].tolist()
        records.setdefault((a, b), UnsupportedContact((a, b), "curved", (x, y, z)))
    return tuple(records.values())


def possible_forces_of(joints: Sequence[SmoothJoint], pairs: Index, mu: Array) -> PossibleContacts:
    """Forces that smooth contacts may exert, with friction, given the error of their normals.

    `mu` is the friction coefficient of each pair of parts [-]. Such a force lies within mu +
    tilt of the fitted normal; the forces are the corners of the pyramid around that cone.
    """
    blocks = []
    angle = np.arange(SIDES) * 2 * np.pi / SIDES
    for joint in joints:
        points, parts = joint.matches, pairs[joint.pair]
        u, v = across(points.normal)
        half_width = (joint.tilt + mu[joint.pair]) / np.cos(np.pi / SIDES)
        directions = [
            unit_rows(points.normal + half_width * (np.cos(t) * u + np.sin(t) * v)) for t in angle
        ]
        count = SIDES * len(points)
        zeros = np.zeros(count)
        blocks.append(
            PossibleContacts(
                np.full(count, parts[0]),
                np.full(count, parts[1]),
                np.tile(points.point, (SIDES, 1)),
                np.concatenate(directions),
                zeros > 0,
                zeros,
                np.full(count, -1),
            )
        )
    return PossibleContacts.join(blocks)


def smooth_warning(joints: Sequence[SmoothJoint]) -> str:
    """Warning that states the error of the fitted normals of smooth contacts."""
    pairs = len({joint.pair for joint in joints})
    worst = float(np.degrees(max(joint.tilt for joint in joints)))
    many = "1 pair" if pairs == 1 else f"{pairs} pairs"
    return (
        f"curved faces without a formula, {many}: their normals are those of surfaces "
        f"fitted to their corners, accurate to {worst:.1g} degrees"
    )


def _joint(
    search: ContactSearch, row: int, faces: tuple[SmoothFace, SmoothFace]
) -> list[SmoothJoint]:
    """The contact of two smooth faces; an empty list if they do not touch or are flat.

    Flat faces are facets that lie flush.
    """
    face_a, face_b = faces
    gap, closed = float(search.limits.gap[row]), float(search.limits.closed[row])
    low = np.maximum(face_a.box[0], face_b.box[0])
    apart = float((low - np.minimum(face_a.box[1], face_b.box[1])).max())
    # most pairs of faces are apart, and need no fitted normals
    if apart > max(gap, closed) + face_a.most_sagitta + face_b.most_sagitta:
        return []
    sagitta = face_a.sagitta + face_b.sagitta
    reach = max(gap, closed) + sagitta
    if apart > reach:
        return []
    matched = matches(face_a, face_b, reach, gap)
    is_near = (matched.gap >= -gap - SMOOTH_GAP * sagitta) & (
        matched.gap <= closed + SMOOTH_GAP * sagitta
    )
    is_sure = is_near & (matched.apart <= SMOOTH_UNSURE)
    # faces that meet in part only, or cross, are not a joint
    if int(is_sure.sum()) < FEWEST or 2 * int(is_near.sum()) < len(matched):
        return []
    facets = (_facets_of(search, face_a), _facets_of(search, face_b))
    area, flush = _common_area(search, row, facets, reach)
    facets_are_faces = bool(search.meshes[search.pairs[row]].all())
    # facets that lie on each other are real flat faces, which the flat search finds
    if facets_are_faces and flush >= FACETS * area:
        return []
    points = matched.take(np.flatnonzero(is_sure))
    # `apart` is half the angle between the normals of both sides
    tilt = 2 * float(np.sqrt((points.apart**2).mean()))
    surfaces = (
        TriangleTrees(face_a.points[face_a.triangles]),
        TriangleTrees(face_b.points[face_b.triangles]),
    )
    points = _spread_subset(_free_sliding_directions(points, faces, tilt), reach)
    return [SmoothJoint(row, surfaces, facets, points, area, reach, max(tilt, SMOOTH_LEAST))]


def _facets_of(search: ContactSearch, face: SmoothFace) -> Index:
    """Indices of the facets of which a smooth face consists."""
    facets, geometry = search.facets, search.geometry
    rows = np.arange(facets.start[face.part], facets.start[face.part + 1])
    first = facets.corner_start[rows]
    count = len(geometry.vertices)
    # the first side of a facet identifies it: it is a side of a single triangle
    side = facets.corners[first] * count + facets.corners[first + 1]
    triangles = geometry.triangles[face.rows]
    sides: Index = (triangles * count + triangles[:, [1, 2, 0]]).ravel()
    return rows[np.isin(side, sides)]


def _common_area(
    search: ContactSearch, row: int, facets: tuple[Index, Index], reach: float
) -> tuple[float, float]:
    """Area over which facets overlap, and area over which they also lie flush [length unit^2].

    Flush means within the default gap tolerance: a wider tolerance does not show whether the flat
    faces are real.
    """
    geometry, boxes, normal = search.geometry, search.boxes, search.facets.normal
    # facets are compared only if their normals lie in neighbouring cells of directions
    (i, owner_i), (j, owner_j), cells = _facing_cells(facets, normal)
    box_i, box_j = ((boxes.facet_low[rows], boxes.facet_high[rows]) for rows in (i, j))
    margin = np.full(cells, reach)
    size = float(geometry.size[search.pairs[row]].min())
    gap = max(GAP * size, float(search.limits.rounding[row]))
    area = flush = 0.0
    for _, x, y in joins(owner_i, box_i, owner_j, box_j, margin):
        opposed = np.einsum("ij,ij->i", normal[i[x]], normal[j[y]])
        keep = opposed <= -np.cos(SMOOTH_FACING)
        x, y = x[keep], y[keep]
        pair = np.full(len(x), row)
        frames = facet_frames(search.facets, pair, i[x], j[y], np.full(len(x), reach))
        for block in overlaps_of(geometry, search.facets, frames):
            near = (block.gap[:, 0] <= reach) & (block.gap[:, 1] >= -reach)
            level = (np.abs(block.gap) <= gap).all(axis=1)
            area += float(block.area[near].sum())
            flush += float(block.area[near & level].sum())
    return area, flush


def _facing_cells(
    facets: tuple[Index, Index], normal: Array
) -> tuple[tuple[Index, Index], tuple[Index, Index], int]:
    """Facets of both faces by cells of directions, so that facing facets share a cell.

    Returns `first`, `second`: facets, and the cell of each, ascending; a facet of the second face
    is in the cells around the reverse of its normal; `cells`: number of cells.
    """
    i, j = facets
    # the difference of facing unit vectors is at most a side of a cell along each axis
    side = 2 * np.sin(SMOOTH_FACING / 2) * (1 + DISTANCE_ROUNDING)
    most = int(np.ceil(1 / side)) + 2
    weights = np.array([(2 * most) ** 2, 2 * most, 1])
    cell_i = (np.floor(normal[i] / side) + most).astype(np.int64) @ weights
    around = np.array(list(product((-1, 0, 1), repeat=3))) @ weights
    near_j = ((np.floor(-normal[j] / side) + most).astype(np.int64) @ weights)[:, None] + around
    used = np.unique(cell_i)
    row, column = np.nonzero(np.isin(near_j, used))
    owner_i, owner_j = np.searchsorted(used, cell_i), np.searchsorted(used, near_j[row, column])
    order_i, order_j = (np.argsort(owner, kind="stable") for owner in (owner_i, owner_j))
    return (i[order_i], owner_i[order_i]), (j[row][order_j], owner_j[order_j]), len(used)


def _free_sliding_directions(points: Matches, faces: Iterable[SmoothFace], tilt: float) -> Matches:
    """Make nearly perpendicular normals exactly perpendicular to straight edges of the faces.

    A face can then slide along its straight edges.
    """
    normal = points.normal
    for direction in _straight_directions(faces):
        along = normal @ direction
        if float(np.sqrt((along**2).mean())) <= max(tilt, PATCH_ANGLE):
            normal = unit_rows(normal - np.outer(along, direction))
    return Matches(points.point, normal, points.gap, points.apart, points.doubt)


def _straight_directions(faces: Iterable[SmoothFace]) -> list[Array]:
    """Unit directions of the edges at the rim of faces, the greatest total length first."""
    from scipy.spatial import cKDTree

    step = np.concatenate(
        [face.points[face.rim[:, 1]] - face.points[face.rim[:, 0]] for face in faces]
    )
    length = np.linalg.norm(step, axis=1)
    along = unit_rows(step)
    leading = np.take_along_axis(along, np.abs(along).argmax(axis=1)[:, None], axis=1)
    along = along * np.sign(leading)
    groups: list[Array] = []
    remaining = np.ones(len(along), dtype=bool)
    parallel = cKDTree(along).query_ball_point(along, ONE_DIRECTION, return_sorted=True)
    for k in np.argsort(-length, kind="stable").tolist():
        if remaining[k]:
            remaining[parallel[k]] = False
            groups.append(length[parallel[k]] @ along[parallel[k]])
    groups.sort(key=lambda total: -float(np.linalg.norm(total)))
    return [unit_rows(total) for total in groups[:DIRECTIONS]]


def _spread_subset(points: Matches, reach: float) -> Matches:
    """Reduce contact points to at most `MOST`, as far from each other as possible."""
    point = points.point
    chosen = [int(np.linalg.norm(point - point.mean(axis=0), axis=1).argmax())]
    distance = np.linalg.norm(point - point[chosen[0]], axis=1)
    stop_distance = min(reach, float(distance.max()) / MOST)
    while len(chosen) < MOST and float(distance.max()) > stop_distance:
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(point - point[chosen[-1]], axis=1))
    return points.take(np.sort(chosen))
