"""Input that all families of contacts share: parts, facets, boxes and near pairs.

A check searches the same bodies again when it tries an option. With another tolerance the facets,
boxes, solids, smooth faces and curves of the bodies stay the same. With other friction all findings
stay the same. So these values are kept, until bodies of another geometry are searched.

All corners, edges and faces of such a pair touch, but none of them carries a force: the pair is an
overlap. So its contacts are not searched.
"""

from __future__ import annotations

import atexit
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from kilter.arrays import Array, Index, Mask, nearest
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.common.broad import Boxes, make_boxes, pairs_apart, part_pairs
from kilter.contact.common.distances import PartSolids
from kilter.contact.common.facets import Facets, find_facets
from kilter.contact.common.gaps import GapLimits, Tolerance, gap_limits, reach_of, unknown_pairs
from kilter.contact.contact_tolerances import SAME_PLACE
from kilter.shape.primitives import Mesh

MOST_TRIANGLES = 300_000
"""Largest number of triangles of a geometry whose searches are kept; more need more memory."""
MOST_FINDINGS = 4
"""Largest number of searches whose findings are kept."""


@dataclass(slots=True, eq=False)
class RecentSearches:
    """Values of searches of a geometry."""

    geometry: Geometry | None = None
    search: Any = None
    """A search of this geometry, for the values that do not depend on its tolerance."""
    findings: dict[Hashable, tuple[Any, Any]] = field(default_factory=dict)
    """Complete findings (search, `PairFindings`) by the conditions of their search."""

    def keep(self, conditions: Hashable, findings: tuple[Any, Any]) -> None:
        """Keep complete findings, in place of the oldest ones."""
        if len(self.findings) >= MOST_FINDINGS:
            del self.findings[next(iter(self.findings))]
        self.findings[conditions] = findings


def recent_searches(geometry: Geometry) -> RecentSearches:
    """The recent searches of a geometry; empty if another geometry was searched last."""
    global _recent
    if len(geometry.triangles) > MOST_TRIANGLES:
        return RecentSearches(geometry)
    recent = _recent
    if recent.geometry is not geometry:
        recent = _recent = RecentSearches(geometry)
    return recent


@atexit.register
def forget() -> None:
    """Release the values before the interpreter ends.

    Solids that live longer than their library make it print a list of leaks.
    """
    global _recent
    _recent = RecentSearches()


_recent = RecentSearches()


def coincide(geometry: Geometry, a: int, b: int) -> bool:
    """Whether two parts have the same corners in the same places."""
    corners_a, corners_b = (
        geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]
        for part in (a, b)
    )
    if corners_a.shape != corners_b.shape:
        return False
    close = SAME_PLACE * geometry.size[a] + geometry.accuracy[a] + geometry.accuracy[b]
    if np.abs(corners_a.mean(axis=0) - corners_b.mean(axis=0)).max() > close:
        return False
    return bool(nearest(corners_a, corners_b)[0].max() <= close)


def deep_boxes(geometry: Geometry, boxes: Boxes, pairs: Index, limits: GapLimits) -> Mask:
    """Mask of pairs whose boxes overlap by more than the gap limit along each axis, shape (n,).

    The limit includes the distances of both parts from their triangles. Other pairs do not overlap.
    """
    a, b = pairs.T
    grow = (limits.gap + geometry.slack[a] + geometry.slack[b])[:, None]
    deep: Mask = (boxes.part_high[a] - boxes.part_low[b] > grow).all(axis=1)
    deep &= (boxes.part_high[b] - boxes.part_low[a] > grow).all(axis=1)
    return deep


def same_bodies(geometry: Geometry, boxes: Boxes, pairs: Index, limits: GapLimits) -> Mask:
    """Mask of pairs that are the same body twice, shape (n,)."""
    a, b = pairs.T
    close = (SAME_PLACE * geometry.size[a] + geometry.accuracy[a] + geometry.accuracy[b])[:, None]
    corners = np.diff(geometry.vertex_start)
    same: Mask = corners[a] == corners[b]
    for bound in (boxes.part_low, boxes.part_high):
        same &= (np.abs(bound[a] - bound[b]) <= close).all(axis=1)
    same &= deep_boxes(geometry, boxes, pairs, limits)
    rows = np.flatnonzero(same)
    same[rows] = [coincide(geometry, i, j) for i, j in pairs[rows].tolist()]
    return same


@dataclass(frozen=True, slots=True, eq=False)
class ContactSearch:
    """Input of a contact search: the parts with their facets and boxes, and the near pairs."""

    geometry: Geometry
    facets: Facets
    boxes: Boxes
    pairs: Index
    """Parts a < b whose boxes come near and whose contacts are not given, shape (n, 2)."""
    limits: GapLimits
    """Gap limits, a row for each pair."""
    angle: float
    """Angle tolerance [rad]."""
    unknown: Index
    """Pairs that may touch at a place at which the surface of a part is unknown, shape (m, 2)."""
    meshes: Mask
    """True for parts that are triangle meshes, shape (N,)."""
    solids: PartSolids
    """Solids of the parts, which are created on first use."""
    same_bodies: Index
    """Parts a < b that are the same body twice, and no pairs of the search, shape (k, 2)."""
    smooth_faces: dict[int, list[Any]] = field(default_factory=dict)
    """Smooth faces of parts (`kilter.contact.smooth`), which are found on first use."""
    part_curves: dict[int, Any] = field(default_factory=dict)
    """Curves of the edges of parts (`kilter.contact.common.edges`), found on first use."""

    def of_rows(self, rows: Index, *, first: bool) -> ContactSearch:
        """The same search for only some of its pairs.

        The `first` pairs include those that are the same body twice.
        """
        twice = self.same_bodies[: None if first else 0]
        return replace(
            self, pairs=self.pairs[rows], limits=self.limits.take(rows), same_bodies=twice
        )

    def without_same_bodies(self) -> ContactSearch:
        """The same search without the pairs that are the same body twice."""
        same = same_bodies(self.geometry, self.boxes, self.pairs, self.limits)
        if not same.any():
            return self
        rows = np.flatnonzero(~same)
        return replace(
            self,
            pairs=self.pairs[rows],
            limits=self.limits.take(rows),
            same_bodies=self.pairs[same],
        )

    def face(self, row: int) -> Array:
        """Triangles of the curved surface with index `row`, shape (m, 3, 3)."""
        geometry = self.geometry
        return geometry.vertices[geometry.triangles[geometry.surfaces.triangles_of(row)]]

    def flat(self, facet: int) -> Array:
        """Triangles of the flat facet with index `facet`, shape (m, 3, 3)."""
        facets = self.facets
        corners = facets.corners[facets.corner_start[facet] : facets.corner_start[facet + 1]]
        points = self.geometry.vertices[corners]
        if not facets.convex[facet]:
            return points.reshape(-1, 3, 3)
        k = np.arange(1, len(points) - 1)
        return points[np.column_stack([0 * k, k, k + 1])]


def begin_search(
    assembly: Assembly,
    tolerance: Tolerance,
    progress: Callable[[str], None],
    *,
    start: Index | None = None,
) -> ContactSearch:
    """Prepare the contact search of an assembly: facets, boxes, near pairs and their gap limits.

    `start`, shape (M + 1,), holds the first part of each of several independent assemblies; parts
    of different assemblies form no pair.
    """
    geometry = assembly.geometry
    recent = recent_searches(geometry) if start is None else RecentSearches()
    last: ContactSearch | None = recent.search
    progress("facets")
    facets = find_facets(geometry) if last is None else last.facets
    progress("near pairs")
    boxes = make_boxes(geometry, facets, start) if last is None else last.boxes
    near = _pairs_to_detect(assembly, boxes, tolerance, start)
    pairs, unknown = near, near[:0]
    if len(geometry.unknown):
        pairs, unknown = unknown_pairs(geometry, near, reach_of(geometry, tolerance))
    limits = gap_limits(geometry, facets, pairs, tolerance)
    if last is not None:
        return replace(last, pairs=pairs, limits=limits, angle=tolerance.angle, unknown=unknown)
    meshes = np.array([isinstance(part.shape, Mesh) for part in assembly.parts])
    search = ContactSearch(
        geometry,
        facets,
        boxes,
        pairs,
        limits,
        tolerance.angle,
        unknown,
        meshes,
        PartSolids(geometry),
        np.empty((0, 2), dtype=np.int64),
    )
    recent.search = search
    return search


def _pairs_to_detect(
    assembly: Assembly, boxes: Boxes, tolerance: Tolerance, start: Index | None
) -> Index:
    """Pairs of near parts, without the pairs whose contacts the file lists."""
    if not assembly.detect:
        return np.empty((0, 2), dtype=np.int64)
    geometry = assembly.geometry
    reach = reach_of(geometry, tolerance)
    if start is not None:
        return pairs_apart(boxes, geometry.grounded, reach, start)
    pairs = part_pairs(boxes, geometry.grounded, reach)
    given = given_pairs(assembly)
    if given:
        keep = [frozenset(pair) not in given for pair in pairs.tolist()]
        pairs = pairs[np.array(keep, dtype=bool)]
    return pairs


def given_pairs(assembly: Assembly) -> frozenset[frozenset[int]]:
    """Pairs of parts whose contacts the file lists, and not only for some of their pieces."""
    return frozenset(
        frozenset(assembly.index_of(name) for name in contact.parts)
        for contact in assembly.contacts
        if contact.pieces is None
    )
