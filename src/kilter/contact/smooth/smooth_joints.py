"""Smooth faces of two meshes that lie on each other, cut differently on both sides.

Two triangulations of one curved face enter each other by their sagittas, and their corners and
edges interlock, which the faces do not. So where facets of two smooth faces do not lie on each
other one by one, no facet, edge or corner of theirs is asked: the faces touch where the surfaces
that they stand for do, with the normals of these, within the gap tolerance and a quarter of both
sagittas (of the surfaces, which are better known than their triangles). Facets that do lie on
each other one by one stay facets: those are the faces.

Free forms of exact solids have no formula either. Where a clearance closes what lies between two
of them they touch in the same way, all over, with the normals of the surfaces fitted to them.

The normals are fitted. A straight direction that both faces leave free within what the normals
of the two sides differ by is set free exactly; and beside each normal those tilted by as much
are possible. Where the sides differ by more than `SMOOTH_UNSURE` a point is left out.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across, starts, unit_rows
from kilter.contact.broad import joins
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import (
    GAP,
    ONE_DIRECTION,
    PATCH_ANGLE,
    SMOOTH_FACING,
    SMOOTH_GAP,
    SMOOTH_LEAST,
    SMOOTH_UNSURE,
)
from kilter.contact.left_out import PossibleContacts, Unsupported
from kilter.contact.patches import Patches
from kilter.contact.planar.facet_overlays import facet_frames, overlaps_of
from kilter.contact.smooth.matching import Matches, matches
from kilter.contact.smooth.smooth_faces import SmoothFace, smooth_faces
from kilter.contact.triangle_distance import surface_distance

__all__ = ["SmoothJoint", "SmoothJoints", "find_smooth"]


MOST = 96
"""Points of one joint, at most: those farthest from each other."""
DIRECTIONS = 4
"""Straight directions that are tried, at most."""
SIDES = 8
"""Of the pyramid about the forces that a point may bring."""
FEWEST = 6
"""Points of one joint, at least."""
FACETS = 0.999
"""Share of the common area on which facets must lie on each other to be the faces."""


@dataclass(frozen=True, slots=True, eq=False)
class SmoothJoint:
    """Two smooth faces that touch.

    Attributes
    ----------
    pair : int
        Row of the pair of parts.
    corners : pair of ndarray, shape (n, 3, 3)
        Triangles of the face of part a, and of part b.
    facets : pair of ndarray of int
        Their facets.
    found : Matches
        The points of contact.
    area : float
        [length unit^2]
    reach : float
        Triangles may touch within so far of the surfaces [length unit].
    tilt : float
        How well the normals are known [rad].
    """

    pair: int
    corners: tuple[Array, Array]
    facets: tuple[Index, Index]
    found: Matches
    area: float
    reach: float
    tilt: float


@dataclass(frozen=True, slots=True, eq=False)
class SmoothJoints:
    """The smooth joints of a search, in order of the pairs."""

    search: ContactSearch
    joints: tuple[SmoothJoint, ...] = ()

    @property
    def patches(self) -> Patches:
        """One patch a joint."""
        found, search = self.joints, self.search
        if not found:
            return Patches.none()
        pair = np.array([joint.pair for joint in found], dtype=np.int64)
        parts = search.pairs[pair]
        size = np.array([float(np.ptp(one.found.point, axis=0).max()) for one in found])
        every = Matches.join(one.found for one in found)
        start = starts([len(one.found) for one in found])
        gap = [(float(one.found.gap.min()), float(one.found.gap.max())) for one in found]
        return Patches(
            pair=pair,
            parts=parts,
            kind=np.full(len(found), "smooth", dtype="<U11"),
            normal=unit_rows(np.add.reduceat(every.normal, start[:-1], axis=0)),
            area=np.array([one.area for one in found]),
            gap=np.array(gap),
            accuracy=search.geometry.accuracy[parts].sum(axis=1) / size,
            start=start,
            points=every.point,
            normals=every.normal,
        )

    def possible(self, mu: Array) -> PossibleContacts:
        """Pushes that hold every force of normals off by the tilt, with friction `mu` of the pairs.

        Such a force lies within mu + tilt of the fitted normal; the pushes are the corners of
        the pyramid about that cone.
        """
        blocks = []
        angle = np.arange(SIDES) * 2 * np.pi / SIDES
        for joint in self.joints:
            found, parts = joint.found, self.search.pairs[joint.pair]
            u, v = across(found.normal)
            wide = (joint.tilt + mu[joint.pair]) / np.cos(np.pi / SIDES)
            tilted = [
                unit_rows(found.normal + wide * (np.cos(t) * u + np.sin(t) * v)) for t in angle
            ]
            count = SIDES * len(found)
            none = np.zeros(count)
            blocks.append(
                PossibleContacts(
                    np.full(count, parts[0]),
                    np.full(count, parts[1]),
                    np.tile(found.point, (SIDES, 1)),
                    np.concatenate(tilted),
                    none > 0,
                    none,
                    np.full(count, -1),
                )
            )
        return PossibleContacts.join(blocks)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the normals rest on."""
        if not self.joints:
            return ()
        pairs = len({joint.pair for joint in self.joints})
        worst = float(np.degrees(max(joint.tilt for joint in self.joints)))
        many = "1 pair" if pairs == 1 else f"{pairs} pairs"
        return (
            f"curved faces without a formula, {many}: they touch with the normals of surfaces "
            f"fitted to their corners, known to {worst:.1g} degrees",
        )

    @property
    def unsure(self) -> tuple[Unsupported, ...]:
        """The pairs of the joints: fitted normals are never certain."""
        found: dict[tuple[int, int], Unsupported] = {}
        for joint in self.joints:
            a, b = (int(k) for k in self.search.pairs[joint.pair])
            x, y, z = joint.found.point[0].tolist()
            found.setdefault((a, b), Unsupported((a, b), "curved", (x, y, z)))
        return tuple(found.values())

    def between(self, pair: Index, i: Index, j: Index) -> Mask:
        """Facets i of a and j of b, of pairs, that belong to the two faces of a joint."""
        found = np.zeros(len(pair), dtype=bool)
        for joint in self.joints:
            mine = np.flatnonzero(pair == joint.pair)
            both = np.isin(i[mine], joint.facets[0]) & np.isin(j[mine], joint.facets[1])
            found[mine[both]] = True
        return found

    def explains(self, pair: Index, points: Array) -> Mask:
        """Points of pairs, shape (n, 3), that lie on both faces of a joint."""
        found = np.zeros(len(points), dtype=bool)
        for joint in self.joints:
            mine = np.flatnonzero((pair == joint.pair) & ~found)
            for corners in joint.corners:
                far = np.full(len(mine), 2 * joint.reach)
                mine = mine[surface_distance(points[mine], corners, far) <= joint.reach]
            found[mine] = True
        return found


def find_smooth(search: ContactSearch) -> SmoothJoints:
    """The smooth joints of the pairs of a search: of meshes, and where a clearance closes."""
    convex, (a, b) = search.facets.convex_part, search.pairs.T
    mesh, closes = search.meshes, search.limits.closed > search.limits.gap
    rows = np.flatnonzero((mesh[a] & mesh[b] | closes) & ~(convex[a] & convex[b]))
    faces: dict[int, list[SmoothFace]] = {}
    found: list[SmoothJoint] = []
    for row in rows.tolist():
        parts = (int(a[row]), int(b[row]))
        for part in parts:
            if part not in faces:
                faces[part] = smooth_faces(search.geometry, part, mesh=bool(mesh[part]))
        for one in faces[parts[0]]:
            for other in faces[parts[1]]:
                found += _joint(search, row, (one, other))
    return SmoothJoints(search, tuple(found))


def _joint(
    search: ContactSearch, row: int, faces: tuple[SmoothFace, SmoothFace]
) -> list[SmoothJoint]:
    """The joint of two faces, if they touch and their facets do not lie on each other."""
    one, other = faces
    gap, closed = float(search.limits.gap[row]), float(search.limits.closed[row])
    sagitta = one.sagitta + other.sagitta
    reach = max(gap, closed) + sagitta
    low = np.maximum(one.points.min(axis=0), other.points.min(axis=0))
    if (low > np.minimum(one.points.max(axis=0), other.points.max(axis=0)) + reach).any():
        return []
    every = matches(one, other, reach, gap)
    near = (every.gap >= -gap - SMOOTH_GAP * sagitta) & (every.gap <= closed + SMOOTH_GAP * sagitta)
    sure = near & (every.apart <= SMOOTH_UNSURE)
    if int(sure.sum()) < FEWEST or 2 * int(near.sum()) < len(every):
        return []
    facets = (_facets_of(search, one), _facets_of(search, other))
    area, flush = _common_area(search, row, facets, reach)
    facets_are_faces = bool(search.meshes[search.pairs[row]].all())
    if facets_are_faces and flush >= FACETS * area:
        return []
    found = every.take(np.flatnonzero(sure))
    tilt = 2 * float(np.sqrt((found.apart**2).mean()))
    corners = (one.points[one.triangles], other.points[other.triangles])
    found = _spread(_with_sliding(found, faces, tilt), reach)
    return [SmoothJoint(row, corners, facets, found, area, reach, max(tilt, SMOOTH_LEAST))]


def _facets_of(search: ContactSearch, face: SmoothFace) -> Index:
    """The facets that a smooth face consists of."""
    facets, geometry = search.facets, search.geometry
    rows = np.arange(facets.start[face.part], facets.start[face.part + 1])
    first = facets.corner_start[rows]
    count = len(geometry.vertices)
    # the first side of a facet is a side of one triangle only
    side = facets.corners[first] * count + facets.corners[first + 1]
    triangles = geometry.triangles[face.rows]
    sides: Index = (triangles * count + triangles[:, [1, 2, 0]]).ravel()
    return rows[np.isin(side, sides)]


def _common_area(
    search: ContactSearch, row: int, facets: tuple[Index, Index], reach: float
) -> tuple[float, float]:
    """The area in which facets lie over each other, and that of those that are flush.

    Flush by the default tolerance: a wider one says nothing of what the faces are.
    """
    geometry, boxes = search.geometry, search.boxes
    i, j = facets
    owner = [np.zeros(len(rows), dtype=np.int64) for rows in facets]
    around = [(boxes.facet_low[rows], boxes.facet_high[rows]) for rows in facets]
    size = float(geometry.size[search.pairs[row]].min())
    gap = max(GAP * size, float(search.limits.rounding[row]))
    area = flush = 0.0
    for _, x, y in joins(owner[0], around[0], owner[1], around[1], np.array([reach])):
        opposed = np.einsum("ij,ij->i", search.facets.normal[i[x]], search.facets.normal[j[y]])
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


def _with_sliding(found: Matches, faces: Iterable[SmoothFace], tilt: float) -> Matches:
    """The points with normals that leave straight directions free which they nearly do."""
    normal = found.normal
    for direction in _directions(faces):
        along = normal @ direction
        if float(np.sqrt((along**2).mean())) <= max(tilt, PATCH_ANGLE):
            normal = unit_rows(normal - np.outer(along, direction))
    return Matches(found.point, normal, found.gap, found.apart, found.doubt)


def _directions(faces: Iterable[SmoothFace]) -> list[Array]:
    """Directions of the edges of rims, those of the greatest length in all first."""
    step = np.concatenate(
        [face.points[face.rim[:, 1]] - face.points[face.rim[:, 0]] for face in faces]
    )
    length = np.linalg.norm(step, axis=1)
    along = unit_rows(step)
    first = np.take_along_axis(along, np.abs(along).argmax(axis=1)[:, None], axis=1)
    along = along * np.sign(first)
    groups: list[Array] = []
    left = np.ones(len(along), dtype=bool)
    for k in np.argsort(-length, kind="stable"):
        if left[k]:
            same = np.linalg.norm(along - along[k], axis=1) <= ONE_DIRECTION
            left &= ~same
            groups.append(length[same] @ along[same])
    groups.sort(key=lambda total: -float(np.linalg.norm(total)))
    return [unit_rows(total) for total in groups[:DIRECTIONS]]


def _spread(found: Matches, reach: float) -> Matches:
    """The points farthest from each other, so many as count."""
    point = found.point
    chosen = [int(np.linalg.norm(point - point.mean(axis=0), axis=1).argmax())]
    far = np.linalg.norm(point - point[chosen[0]], axis=1)
    least = min(reach, float(far.max()) / MOST)
    while len(chosen) < MOST and float(far.max()) > least:
        chosen.append(int(far.argmax()))
        far = np.minimum(far, np.linalg.norm(point - point[chosen[-1]], axis=1))
    return found.take(np.sort(chosen))
