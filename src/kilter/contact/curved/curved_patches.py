"""Contact patches of curved faces.

Depth of the material that two overlapping faces share.

Faces i and j of two parts overlap by d along a normal n: part i begins at d/2 and extends
backwards, part j begins at -d/2 and extends forwards. They share the interval

    from max(-d/2, the end of i behind its face)   to min(d/2, the end of j in front of its face)

of the line, if it is not empty. Two shells about the same axis, one inside the bore of the other,
share nothing, although the outer shell as a solid shaft would overlap the inner shell.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, cross, extents, ratio, starts
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import KINDS
from kilter.contact.common.broad import joins
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.findings import CurvedFindings, FacePatches, on_flat
from kilter.contact.common.gaps import APART, PENETRATES, RejectedPair
from kilter.contact.common.patches import INTERFERE, Overlap, Patches, PossibleContacts
from kilter.contact.contact_tolerances import MEAN_NORMAL, RIM_NORMAL, WALL_RIM
from kilter.contact.curved.contact_points import PatchPoints


def shared_depth(
    geometry: Geometry, parts: tuple[int, int], points: Array, normals: Array, depth: Array
) -> float:
    """Longest interval on the given lines that lies inside both parts [length unit]; 0: none.

    `parts`: the part that the outward normals belong to, and the other part. `depth`, shape (n,):
    overlap of the faces along each normal; lines without overlap are skipped [length unit].
    """
    slack = float(geometry.slack[list(parts)].max())
    overlapping = depth > 0
    points, normals, half = points[overlapping], normals[overlapping], depth[overlapping] / 2
    ends = points - half[:, None] * normals, points + half[:, None] * normals
    boxes = np.minimum(*ends), np.maximum(*ends)
    low, high = -half, half.copy()
    for line, t in _crossings(geometry, parts[0], points, normals, boxes):
        is_end = t < half[line] - slack
        np.maximum.at(low, line[is_end], t[is_end])
    for line, t in _crossings(geometry, parts[1], points, normals, boxes):
        is_end = t > slack - half[line]
        np.minimum.at(high, line[is_end], t[is_end])
    return float((high - low).max(initial=0.0))


def _crossings(
    geometry: Geometry, part: int, points: Array, normals: Array, boxes: tuple[Array, Array]
) -> Iterator[tuple[Index, Array]]:
    """Yield batches of pairs (line, t): a line passes through a triangle of a part at t.

    Line k is ``points[k] + t normals[k]``. All crossings inside its box are among the yielded ones.
    """
    span = slice(int(geometry.triangle_start[part]), int(geometry.triangle_start[part + 1]))
    corners = geometry.vertices[geometry.triangles[span]]
    lowest, highest = extents(corners)
    # only triangles near a line: the rim of a triangle, and the rounding of coordinates
    all_boxes = boxes[0].min(axis=0, initial=np.inf), boxes[1].max(axis=0, initial=-np.inf)
    rim = 2 * WALL_RIM * (np.abs(lowest) + np.abs(highest) + highest - lowest).max(initial=0.0)
    is_near = ((highest >= all_boxes[0] - rim) & (lowest <= all_boxes[1] + rim)).all(axis=1)
    corners, lowest, highest = corners[is_near], lowest[is_near], highest[is_near]
    owners = (np.zeros(len(rows), dtype=np.int64) for rows in (points, corners))
    of_lines, of_triangles = owners
    for _, line, k in joins(of_lines, boxes, of_triangles, (lowest, highest), np.array([rim])):
        hit, t = _line_through(corners[k], points[line], normals[line])
        yield line[hit], t[hit]


def _line_through(corners: Array, x: Array, n: Array) -> tuple[Mask, Array]:
    """Mask of triangles through which the line x + t n passes, and the parameter t, shape (m,)."""
    p, q, r = corners.transpose(1, 0, 2)
    # Moeller and Trumbore 1997: t and the barycentric weights of q and r by Cramer's rule
    edge_q, edge_r = q - p, r - p
    normal = cross(edge_q, edge_r)
    determinant = -np.einsum("ij,ij->i", normal, n)
    divisor = np.where(determinant == 0, np.inf, determinant)
    offset = x - p
    offset_cross_n = cross(offset, n)
    share_q = np.einsum("ij,ij->i", edge_r, offset_cross_n) / divisor
    share_r = -np.einsum("ij,ij->i", edge_q, offset_cross_n) / divisor
    t = np.einsum("ij,ij->i", offset, normal) / divisor
    inside = (share_q >= -WALL_RIM) & (share_r >= -WALL_RIM) & (share_q + share_r <= 1 + WALL_RIM)
    return inside & (determinant != 0), t


NAMED = ("sphere", "torus", "cone", "cylinder")
"""Kinds of surface in order of precedence: a patch has the name of the first kind in it."""


@dataclass(frozen=True, slots=True, eq=False)
class SurfacePairs(Rows):
    """Pairs of surfaces of two parts whose bounding boxes meet.

    `pair` is the row of the pair of parts, `i` a curved surface, `j` its partner (a curved surface
    or a flat facet), and `turned` is True if i belongs to part b.
    """

    pair: Index
    i: Index
    j: Index
    turned: Mask


@dataclass(frozen=True, slots=True, eq=False)
class CandidateLimits:
    """Gap tolerance and widest accepted clearance of each candidate contact."""

    gap: Array
    closed: Array

    def of(self, row: int) -> tuple[float, float]:
        """Gap tolerance and widest accepted clearance of a candidate [length unit]."""
        return float(self.gap[row]), float(self.closed[row])


@dataclass(frozen=True, slots=True, eq=False)
class CurvedPatch:
    """A possible contact patch between two curved faces, or a curved and a flat face."""

    pair: int
    """Row of the pair of parts."""
    names: tuple[int, int]
    """The surface that the normals leave, and its partner (-1: a flat face)."""
    gap: tuple[float, float]
    """Least and greatest gap [length unit]."""
    limit: float
    """Gap tolerance [length unit]."""
    spots: PatchPoints
    """Contact points and normals."""
    zone: float
    """Distance from the contact within which triangles may touch [length unit]."""
    turned: bool
    """The first surface belongs to part b."""
    closed: float = 0.0
    """Widest gap that counts as closed; 0: the gap tolerance [length unit]."""
    play: float = 0.0
    """Gap all around a fit wider than the tolerance; 0: no such fit [length unit]."""
    inside: tuple[Array, Array] | None = None
    """Points within the region of contact, with the normals there; None: the contact points."""

    @property
    def key(self) -> tuple[int, int, int]:
        """Row of the pair of parts, then the rows of both surfaces in ascending order."""
        return self.pair, min(self.names), max(self.names)

    @property
    def surface(self) -> tuple[int, int]:
        """Row of the surface of part a and of part b; -1 for a flat face."""
        return self.names[::-1] if self.turned else self.names

    @property
    def sense(self) -> float:
        """1 if the normals of the patch's points lead from part a to part b, else -1."""
        return -1.0 if self.turned else 1.0


@dataclass(slots=True, eq=False)
class PatchBuilder:
    """Curved patches collected during a search, sorted into touching, near and overlapping.

    `pressed` has the depth of each overlap [length unit]; `rejected` has faces that are too thin.
    """

    touching: list[CurvedPatch] = field(default_factory=list)
    apart: list[CurvedPatch] = field(default_factory=list)
    pressed: list[tuple[CurvedPatch, float]] = field(default_factory=list)
    rejected: list[RejectedPair] = field(default_factory=list)


def classify(search: ContactSearch, builder: PatchBuilder, patch: CurvedPatch) -> None:
    """Sort a patch by its gap into the touching, overlapping or near patches of `builder`.

    A fit with play touches only if a clearance closes it. Faces that overlap without material
    behind them are dropped.
    """
    low, high = patch.gap
    if patch.play > 0:
        # the gap of a fit is its play all around; only penetration by a tilted axis is tested
        touches, high = low >= -patch.limit and patch.play <= patch.closed, low
    else:
        touches = low <= max(patch.limit, patch.closed) and high >= -patch.limit
    if touches:
        gap = (patch.play, patch.play) if patch.play > 0 else patch.gap
        builder.touching.append(dataclasses.replace(patch, gap=gap))
    elif high < -patch.limit:
        depth = _overlap_depth(search, patch)
        # faces of hollow parts may pass each other without any shared material
        if depth > patch.limit:
            builder.pressed.append((patch, depth))
    else:
        builder.apart.append(patch)


def _overlap_depth(search: ContactSearch, patch: CurvedPatch) -> float:
    """Depth of the material that two faces share [length unit]; 0 if they do not overlap."""
    s, (i, j) = search.geometry.surfaces, patch.names
    points, normals = patch.inside or (patch.spots.points, patch.spots.normals)
    depth = np.full(len(points), -patch.gap[1])
    if j >= 0:
        rows = np.ones(len(points), dtype=np.int64)
        depth = -(s.distance(i * rows, points) + s.distance(j * rows, points))
    a, b = (int(k) for k in search.pairs[patch.pair])
    parts = (b, a) if patch.turned else (a, b)
    return shared_depth(search.geometry, parts, points, normals, depth)


def _resolve(
    search: ContactSearch, builder: PatchBuilder
) -> tuple[list[RejectedPair], list[Overlap]]:
    """Near pairs and overlaps of a search, with at most one record for two surfaces.

    Surfaces with a closed fit have no line or point in addition, and no near pair or overlap.
    Surfaces that touch or press along a line are not listed as a fit with play.
    """
    closed = {patch.key for patch in builder.touching if patch.play > 0}
    builder.touching = [
        patch for patch in builder.touching if patch.play > 0 or patch.key not in closed
    ]
    in_contact = {patch.key for patch in builder.touching}
    in_contact |= {patch.key for patch, _ in builder.pressed}
    fits = {patch.key for patch in builder.apart if patch.play > 0} - in_contact
    rejected, overlaps = list(builder.rejected), []
    for patch in builder.apart:
        if (patch.key in fits) if patch.play > 0 else (patch.key not in fits | closed):
            rejected.append(_rejected_pair(search, patch))
    for patch, depth in builder.pressed:
        if patch.key not in closed:
            parts = _parts(search, patch)
            overlaps.append(Overlap(parts, None, depth, INTERFERE))
            rejected.append(RejectedPair(parts, -depth, 0.0, PENETRATES))
    return rejected, overlaps


def _rejected_pair(search: ContactSearch, patch: CurvedPatch) -> RejectedPair:
    """The `RejectedPair` of a patch whose faces are too far apart for contact."""
    hollow = search.geometry.surfaces.hollow
    i, j = patch.names
    fit = patch.play > 0 or (j >= 0 and bool(hollow[i] != hollow[j]))
    return RejectedPair(_parts(search, patch), patch.play or patch.gap[0], 0.0, APART, fit)


def _parts(search: ContactSearch, patch: CurvedPatch) -> tuple[int, int]:
    a, b = (int(k) for k in search.pairs[patch.pair])
    return a, b


def without_repeats(curved: CurvedFindings, faces: FacePatches) -> CurvedFindings:
    """Curved contacts without lines and points that lie in a flat patch of the same pair.

    These lie on the rim of the flat patch.

    Such a repeat is the seam of a fillet.
    """
    patches, flat, tolerance = curved.patches, faces.flat.patches, faces.search.limits.gap
    keep = np.ones(len(patches), dtype=bool)
    for patch in np.flatnonzero(np.isin(patches.pair, flat.pair)):
        pair, slack = int(patches.pair[patch]), 2 * tolerance[patches.pair[patch]]
        points = patches.corners(int(patch))
        normals = patches.normals[patches.start[patch] : patches.start[patch + 1]]
        for k in flat.of_pair(pair):
            alike = np.abs(normals - flat.normal[k]).max() <= RIM_NORMAL
            if alike and on_flat(points, flat.corners(k), flat.normal[k], slack).all():
                keep[patch] = False
    if keep.all():
        return curved
    rows = np.flatnonzero(keep)
    return dataclasses.replace(
        curved, patches=patches.take(rows), surface=curved.surface[rows], zone=curved.zone[rows]
    )


def pack(
    search: ContactSearch, builder: PatchBuilder, unknown: Index, raised: Index
) -> CurvedFindings:
    """Convert the patches of a builder to arrays, ordered by pair, with normals from a to b.

    `unknown`, shape (m, 3): pairs of surfaces without a formula: see `CurvedFindings`.
    """
    rejected, overlaps = _resolve(search, builder)
    touching = sorted(builder.touching, key=lambda patch: patch.pair)
    pair = np.array([patch.pair for patch in touching], dtype=np.int64)
    parts = search.pairs[pair]
    surface = np.array([patch.surface for patch in touching], dtype=np.int64).reshape(-1, 2)
    start = starts([len(patch.spots.points) for patch in touching])
    normals = _stack_rows([patch.sense * patch.spots.normals for patch in touching])
    size = np.array([_size(search, patch) for patch in touching])
    patches = Patches(
        pair=pair,
        parts=parts,
        kind=np.array([_kind(search, row) for row in surface.tolist()], dtype="<U11"),
        normal=_mean_normals_of(normals, start),
        area=np.array([patch.spots.area for patch in touching]),
        gap=np.array([patch.gap for patch in touching]).reshape(-1, 2),
        accuracy=search.geometry.accuracy[parts].sum(axis=1) / size,
        doubt=np.zeros(len(touching)),
        mu=np.full(len(touching), np.nan),
        start=start,
        points=_stack_rows([patch.spots.points for patch in touching]),
        normals=normals,
    )
    outer = np.repeat(parts, [len(patch.spots.outer_points) for patch in touching], axis=0)
    possible = PossibleContacts(
        part_a=outer[:, 0],
        part_b=outer[:, 1],
        points=_stack_rows([patch.spots.outer_points for patch in touching]),
        normals=_stack_rows([patch.sense * patch.spots.outer_normals for patch in touching]),
        two_sided=np.zeros(len(outer), dtype=bool),
        mu=np.zeros(len(outer)),
        degenerate=np.full(len(outer), -1),
    )
    return CurvedFindings(
        patches=patches,
        surface=surface,
        zone=np.array([patch.zone for patch in touching]),
        unknown=unknown,
        possible=possible,
        rejected=tuple(rejected),
        overlaps=tuple(overlaps),
        raised=raised[:, None],
    )


def _stack_rows(rows: list[Array]) -> Array:
    """Concatenate arrays of 3-vectors to an array of shape (n, 3), also if the list is empty."""
    return np.concatenate([np.empty((0, 3)), *rows])


def _size(search: ContactSearch, patch: CurvedPatch) -> float:
    """Size of a patch [length unit], by which its accuracy is divided."""
    radius = float(search.geometry.surfaces.radius[patch.names[0]])
    size = max(radius, float(np.ptp(patch.spots.points, axis=0).max()))
    return size or float(search.geometry.radius[search.pairs[patch.pair]].min())


def _mean_normals_of(normals: Array, start: Index) -> Array:
    """Mean unit normal of each patch; its first normal if the normals cancel."""
    if len(start) == 1:
        return np.empty((0, 3))
    total = np.add.reduceat(normals, start[:-1], axis=0)
    count = np.diff(start)[:, None]
    length = np.linalg.norm(total, axis=1)[:, None]
    mean: Array = np.where(length > MEAN_NORMAL * count, ratio(total, length), normals[start[:-1]])
    return mean


def _kind(search: ContactSearch, surface: list[int]) -> str:
    """Name of the kind of contact between two surfaces, such as "cylinder"; -1: a flat face."""
    kinds = {KINDS[search.geometry.surfaces.kind[k]] for k in surface if k >= 0}
    return next(name for name in NAMED if name in kinds)


def raised_warning(count: int) -> str:
    """Warning about pairs of parts whose gap tolerance was raised."""
    pairs = "1 pair" if count == 1 else f"{count} pairs"
    return (
        f"curved faces recognised in meshes: the gap tolerance of {pairs} was raised to the "
        "height of the arcs over their triangles; a smaller clearance or interference is not "
        "detected"
    )
