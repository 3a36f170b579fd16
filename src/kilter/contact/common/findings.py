"""Findings of a family of contacts about the pairs of a search.

The families are walked in order (`kilter.contact.pair_findings`): smooth, flat and curved faces,
then edges and corners. Near a point that the patches of the faces explain, no further contact of
the pair is searched for.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, columns, cross, ragged, ratio
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.distances import TriangleTrees
from kilter.contact.common.gaps import RejectedPair
from kilter.contact.common.known_pairs import MovedPairs
from kilter.contact.common.patches import (
    DegeneratePoints,
    KeptPairs,
    Overlap,
    Patches,
    PossibleContacts,
    UnsupportedContact,
)
from kilter.contact.contact_tolerances import BESIDE, BESIDE_CIRCLE, NORMAL_SNAP


def _no_rows(width: int) -> Callable[[], Index]:
    """Factory of an array without rows, shape (0, width)."""
    return lambda: np.empty((0, width), dtype=np.int64)


def _at_rows(entries: Index, rows: Index) -> Index:
    """Entries, shape (n, k), whose first column is a pair of a block, with the row of the pair."""
    return np.column_stack([rows[entries[:, 0]], entries[:, 1:]])


@dataclass(frozen=True, slots=True, eq=False)
class Matches(Rows):
    """Contact points of two smooth faces, with their normals, gaps and errors."""

    point: Array = columns(3)
    normal: Array = columns(3)
    """Points half-way between the surfaces, shape (n, 3); unit normals from the first face to
    the second."""
    gap: Array = columns()
    """Gap between the surfaces [length unit], shape (n,)."""
    apart: Array = columns()
    """Half the angle between the normals of the two surfaces [rad], shape (n,)."""
    doubt: Array = columns()
    """Error of the more accurate of the two normals [rad], shape (n,)."""


@dataclass(frozen=True, slots=True, eq=False)
class SmoothJoint:
    """A contact of two smooth faces: their triangles, contact points, area and error."""

    pair: int
    """Row of the pair of parts."""
    surfaces: tuple[TriangleTrees, TriangleTrees]
    """Triangles of the face of part a, and of part b."""
    facets: tuple[Index, Index]
    """Facets of both faces."""
    matches: Matches
    """Contact points."""
    area: float
    """Common area [length unit^2]."""
    reach: float
    """Distance from the surfaces within which triangles may touch [length unit]."""
    tilt: float
    """Error of the normals [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Findings:
    """Findings of a family about the pairs of a search; the default is that of an absent family."""

    patches: Patches = field(default_factory=Patches.none)
    """Contact patches, ordered by pair."""
    rejected: tuple[RejectedPair, ...] = ()
    """Near features that do not count as touching."""
    unsupported: tuple[UnsupportedContact, ...] = ()
    """Contacts that are not modelled."""
    possible: PossibleContacts = field(default_factory=PossibleContacts.none)
    """Forces that these may exert, except those along the normals of degenerate points."""
    degenerate: DegeneratePoints = field(default_factory=DegeneratePoints.none)
    gaps: Index = field(default_factory=_no_rows(2))
    """Row of the pair, and interval of `GAP_EDGES`, of each gap between opposed flat faces,
    shape (n, 2)."""
    raised: Index = field(default_factory=_no_rows(1))
    """Rows of the pairs whose gap tolerance was raised for surfaces recognised in meshes, shape
    (k, 1)."""
    joints: tuple[SmoothJoint, ...] = ()

    @staticmethod
    def join(blocks: Sequence[tuple[Index, Findings]]) -> Findings:
        """Findings about pairs; a block gives the rows of its pairs, and its findings."""
        found = [block for _, block in blocks]
        patches = [replace(each.patches, pair=rows[each.patches.pair]) for rows, each in blocks]
        return Findings(
            patches=Patches.join(patches).ordered(),
            rejected=tuple(chain.from_iterable(block.rejected for block in found)),
            unsupported=tuple(chain.from_iterable(block.unsupported for block in found)),
            possible=PossibleContacts.join(block.possible for block in found),
            degenerate=DegeneratePoints.join([block.degenerate for block in found]),
            gaps=np.concatenate([_at_rows(block.gaps, rows) for rows, block in blocks]),
            raised=np.concatenate([_at_rows(block.raised, rows) for rows, block in blocks]),
            joints=tuple(
                replace(joint, pair=int(rows[joint.pair]))
                for rows, block in blocks
                for joint in block.joints
            ),
        )

    def among(self, kept: KeptPairs) -> Findings:
        """The findings about some of the pairs, with new numbers."""
        row = kept.new_row
        return Findings(
            patches=kept.patches(self.patches),
            rejected=kept.records(self.rejected),
            unsupported=kept.records(self.unsupported),
            possible=kept.possible(self.possible),
            degenerate=kept.degenerate(self.degenerate)[0],
            gaps=kept.rows(self.gaps),
            raised=kept.rows(self.raised),
            joints=tuple(
                replace(joint, pair=int(row[joint.pair]))
                for joint in self.joints
                if row[joint.pair] >= 0
            ),
        )

    def moved(self, moved: MovedPairs) -> Findings:
        """The findings of pairs that have the findings of these pairs, without smooth joints."""
        return Findings(
            patches=moved.patches(self.patches),
            rejected=moved.records(self.rejected),
            unsupported=moved.records(self.unsupported),
            possible=moved.possible(self.possible),
            degenerate=moved.degenerate(self.degenerate),
            gaps=moved.entries(self.gaps),
            raised=moved.entries(self.raised),
        )


@dataclass(frozen=True, slots=True, eq=False)
class CurvedFindings(Findings):
    """Findings about curved faces, with their surfaces."""

    surface: Index = field(default_factory=_no_rows(2))
    """Curved surfaces of part a and b of each patch, shape (P, 2); -1: a flat face."""
    zone: Array = field(default_factory=lambda: np.empty(0))
    """Distance from the contact within which triangles may touch [length unit], shape (P,)."""
    unknown: Index = field(default_factory=_no_rows(3))
    """Row of the pair, and curved surfaces of a and b (-1: flat faces) without a formula, shape
    (m, 3)."""
    overlaps: tuple[Overlap, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class SmoothFindings(Findings):
    """Findings about smooth faces, with tests of facets and points for belonging to them."""

    def between(self, pair: Index, i: Index, j: Index) -> Mask:
        """Mask of facet pairs (i of part a, j of b) that belong to a smooth contact of the pair."""
        is_between = np.zeros(len(pair), dtype=bool)
        for joint in self.joints:
            of_pair = np.flatnonzero(pair == joint.pair)
            both = np.isin(i[of_pair], joint.facets[0]) & np.isin(j[of_pair], joint.facets[1])
            is_between[of_pair[both]] = True
        return is_between

    def explains(self, pair: Index, points: Array) -> Mask:
        """Mask of points, shape (n, 3), on both faces of a smooth contact of their pair."""
        is_explained = np.zeros(len(points), dtype=bool)
        for joint in self.joints:
            rows = np.flatnonzero((pair == joint.pair) & ~is_explained)
            for surface in joint.surfaces:
                rows = rows[surface.within(points[rows], joint.reach)]
            is_explained[rows] = True
        return is_explained


@dataclass(frozen=True, slots=True, eq=False)
class FacePatches:
    """A contact search with the findings of each family so far."""

    search: ContactSearch
    smooth: SmoothFindings = field(default_factory=SmoothFindings)
    flat: Findings = field(default_factory=Findings)
    curved: CurvedFindings = field(default_factory=CurvedFindings)
    sharp: Findings = field(default_factory=Findings)

    @property
    def has_patch(self) -> Mask:
        """Whether each pair of parts has a contact patch of faces, shape (n,)."""
        is_covered = np.zeros(len(self.search.pairs), dtype=bool)
        for family in (self.flat, self.curved, self.smooth):
            is_covered[family.patches.pair] = True
        return is_covered


def may_be_smooth(search: ContactSearch) -> Mask:
    """Whether smooth faces of each pair may meet: two meshes, or faces that a clearance closes."""
    convex, (a, b) = search.facets.convex_part, search.pairs.T
    mesh, closes = search.meshes, search.limits.closed > search.limits.gap
    may: Mask = (mesh[a] & mesh[b] | closes) & ~(convex[a] & convex[b])
    return may


def is_settled(face_patches: FacePatches) -> Mask:
    """Whether each pair is complete without edges and corners: two convex parts with a patch."""
    convex, (a, b) = face_patches.search.facets.convex_part, face_patches.search.pairs.T
    settled: Mask = convex[a] & convex[b] & face_patches.has_patch
    return settled


POINTS = 50_000
"""Number of points whose patches are searched at once; each takes a number for each corner."""


def explained(face_patches: FacePatches, pair: int, points: Array, slack: float) -> Mask:
    """Mask of points, shape (n, 3), within `slack` of a flat or curved patch of a pair."""
    if len(points) > POINTS:
        parts = np.array_split(points, 1 + len(points) // POINTS)
        return np.concatenate([explained(face_patches, pair, some, slack) for some in parts])
    is_explained = np.zeros(len(points), dtype=bool)
    for patch in face_patches.curved.patches.of_pair(pair):
        is_explained |= _on_curved_patch(face_patches, patch, points, slack)
    flat = face_patches.flat.patches
    for patch in flat.of_pair(pair):
        is_explained |= on_flat(points, flat.corners(patch), flat.normal[patch], slack)
    return is_explained


def in_patch(face_patches: FacePatches, pair: int, points: Array, slack: float) -> Mask:
    """Mask of points, shape (n, 3), on a curved face of a pair that touches over an area."""
    is_in_patch = face_patches.smooth.explains(np.full(len(points), pair), points)
    patches = face_patches.curved.patches
    for patch in patches.of_pair(pair):
        if patches.area[patch] > 0:
            is_in_patch |= _on_curved_patch(face_patches, patch, points, slack)
    return is_in_patch


def _on_curved_patch(face_patches: FacePatches, patch: int, points: Array, slack: float) -> Mask:
    """Mask of points, shape (n, 3), within `slack` of a given curved patch."""
    curved = face_patches.curved
    corners = curved.patches.corners(patch)
    zone = max(float(curved.zone[patch]), slack)
    if curved.patches.area[patch] > 0:  # an area: points of the surface near the patch
        rows = np.full(len(points), curved.surface[patch].max())
        size = float(np.ptp(corners, axis=0).max())
        low, high = corners.min(axis=0) - BESIDE * size, corners.max(axis=0) + BESIDE * size
        surfaces = face_patches.search.geometry.surfaces
        near: Mask = np.abs(surfaces.distance(rows, points)) <= slack
        near &= ((points >= low) & (points <= high)).all(axis=1)
        return near
    if len(corners) > 2:  # a circle, given by chords
        zone += BESIDE_CIRCLE * float(np.ptp(corners, axis=0).max())
    # a point, line or circle: distance from the segments between successive points
    following = np.roll(corners, -1, axis=0)
    step = following - corners
    t = np.einsum("nki,ki->nk", points[:, None] - corners, step)
    t = np.clip(ratio(t, (step**2).sum(axis=1)), 0, 1)
    foot = corners + t[..., None] * step
    beside: Mask = np.linalg.norm(points[:, None] - foot, axis=2).min(axis=1) <= zone
    return beside


def on_patches(face_patches: FacePatches, pair: Index, points: Array, normal: Array) -> Mask:
    """Mask of points on a flat patch of their pair that has the same normal, shape (n,).

    `pair`, shape (n,): row of the pair of each point. `points`, `normal`, shape (n, 3): points with
    their unit normals, from a to b.
    """
    patches, limits = face_patches.flat.patches, face_patches.search.limits
    start = np.searchsorted(patches.pair, np.arange(len(limits) + 1))
    owner, patch = ragged(start, pair)
    near = np.linalg.norm(patches.normal[patch] - normal[owner], axis=1) <= NORMAL_SNAP
    owner, patch = owner[near], patch[near]
    patch_of_corner, corner = ragged(patches.start, patch)
    following = corner + 1
    last = following == patches.start[patch + 1][patch_of_corner]
    following[last] = patches.start[patch][patch_of_corner[last]]
    tolerance = 2 * limits.gap[patches.pair[patch]]
    p = points[owner]
    level = (p - patches.points[patches.start[patch]]) * patches.normal[patch]
    inside = np.abs(level.sum(axis=1)) <= tolerance + np.abs(patches.gap[patch]).max(axis=1)
    along = patches.points[following] - patches.points[corner]
    arm = cross(along, p[patch_of_corner] - patches.points[corner])
    arm = ratio(arm, np.linalg.norm(along, axis=1)[:, None])
    side = np.einsum("ij,ij->i", arm, patches.normal[patch][patch_of_corner])
    # corners may run either way around: inside the hull all sides have the same sign
    outside = np.zeros((len(patch), 2), dtype=bool)
    for k, sign in enumerate((1.0, -1.0)):
        outside[patch_of_corner[sign * side < -tolerance[patch_of_corner]], k] = True
    is_on_patch = np.zeros(len(points), dtype=bool)
    is_on_patch[owner[inside & ~outside.all(axis=1)]] = True
    return is_on_patch


def on_flat(points: Array, corners: Array, normal: Array, slack: float) -> Mask:
    """Mask of points, shape (n, 3), within `slack` of a flat convex polygon."""
    level = np.abs((points - corners[0]) @ normal) <= slack
    along = np.roll(corners, -1, axis=0) - corners
    across = ratio(cross(normal[None], along), np.linalg.norm(along, axis=1)[:, None])
    from_corner = corners - corners[0]
    side = (points - corners[0]) @ across.T - np.einsum("ij,ij->i", from_corner, across)
    if float((cross(along, corners.mean(axis=0) - corners) @ normal).sum()) < 0:
        side = -side  # the corners run clockwise
    inside: Mask = level & (side >= -slack).all(axis=1)
    return inside


def triangles_on_flat(face_patches: FacePatches, pair: int, triangles: Array, slack: float) -> Mask:
    """Mask of triangles, shape (n, 3, 3), that lie within `slack` of a single flat patch of a pair.

    All their points do, because the points within `slack` of a patch form a convex body.
    """
    flat = face_patches.flat.patches
    lies = np.zeros(len(triangles), dtype=bool)
    for patch in flat.of_pair(pair):
        rest = np.flatnonzero(~lies)
        near = on_flat(
            triangles[rest].reshape(-1, 3), flat.corners(patch), flat.normal[patch], slack
        )
        lies[rest] = near.reshape(-1, 3).all(axis=1)
    return lies
