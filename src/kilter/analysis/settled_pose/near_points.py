"""Candidate contact points: points at which two parts touch or may come to touch within a reach.

Each point has a unit normal n from part a to part b, and a gap g. If the parts move by small
displacements, the gap changes by n . (v_b(x) - v_a(x)). Three families give the points:

- Opposed flat faces: the corners of the polygon in which the faces overlap. A corner of a part is
  compared with the plane of the other face. At a crossing of edges the normal lies across both; for
  parallel faces it is the mean normal.
- Pairs of convex flat parts without such a polygon: the distances of convex pieces
  (`kilter.contact.convex_points`).
- All other pairs: kilter's own detection of curved faces, edges and corners with a gap tolerance
  as large as the reach, and the points of round bodies in holes (`bore_points`).

A point counts only if its surfaces see each other: the segment between them lies outside of both
parts, or, where they penetrate each other, inside of both (`clear_segments`). So no reach sees
through a wall.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from kilter.analysis.settled_pose.bore_points import Shafts, bore_points, shafts_in_holes
from kilter.analysis.settled_pose.clear_segments import are_clear
from kilter.analysis.settled_pose.feature_points import feature_points
from kilter.analysis.settled_pose.settle_tolerances import (
    BESIDE,
    COINCIDES,
    CROSSING,
    FACING,
    INSIDE,
    LEVEL,
    THINNEST,
)
from kilter.arrays import (
    TINY,
    Array,
    Index,
    Mask,
    Rows,
    across,
    columns,
    distinct_rows,
    group_sums,
    ragged,
    unit_rows,
)
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.common.broad import facet_pairs
from kilter.contact.common.contact_search import ContactSearch, begin_search
from kilter.contact.common.distances import surface_distance, triangle_distance
from kilter.contact.common.findings import CurvedFindings, FacePatches, may_be_smooth
from kilter.contact.common.gaps import Tolerance
from kilter.contact.common.patches import Patches
from kilter.contact.common.polygons import (
    FacetFrame,
    convex_hull,
    facet_frames,
    overlaps_of,
    padded,
)
from kilter.contact.contact_tolerances import CLUSTER, SAME_PLACE
from kilter.contact.convex_pieces import convex_pieces
from kilter.contact.convex_points import near_points
from kilter.contact.curved.curved_contacts import find_curved
from kilter.contact.flat_contacts import find_flat
from kilter.contact.friction_coefficients import friction_coefficients
from kilter.contact.overlap import inside_part
from kilter.contact.sharp.sharp_contacts import find_sharp
from kilter.contact.smooth.smooth_joints import find_smooth

BETWEEN = np.array([0.0, -0.2, 0.2, -0.4, 0.4])
"""Places along the normal of a penetrating point that are examined, over its penetration [-]."""
STAGES = (0, 4, 20)
"""Numbers of places beside a point between which the later places are examined only if no earlier
place has material."""
FEW_TRIANGLES, PAIRS = 100, 500_000
"""Largest number of triangles of a part that are all compared with each point, and about the
number of pairs that are compared at once."""
TWICE = 1e-7
"""Distance within which a corner or edge is a known point, over the size of the smallest part
[-]."""
SHARP = 0.01
"""Largest gap of edges and corners on curved faces, over the size of the smaller part [-]."""
UNIT = 1e-6
"""Largest error of the square of the length of a normal [-]; points with others have none."""
SAME_WAY = 0.3
"""Largest angle between the normals of penetrating points that one motion opens [rad]."""
OBLIQUE = 0.6
"""Slope of the directions beside a point to its tangents [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class NearPoints(Rows):
    """Candidate contact points; world frame."""

    part_a: Index
    part_b: Index
    """Parts of each point, shape (K,)."""
    point: Array = columns(3)
    normal: Array = columns(3)
    """Position [length unit] and unit normal from a to b, shape (K, 3)."""
    gap: Array = columns()
    """Distance of the surfaces along the normal [length unit], shape (K,); negative:
    penetration."""
    mu: Array = columns()
    """Friction coefficient [-], shape (K,)."""
    bears: Mask = columns()
    """False for points that only prevent penetration and carry no force, shape (K,)."""


def find_near_points(
    assembly: Assembly, reach: float, fine_reach: float, *, pairs: Index | None = None
) -> NearPoints:
    """Find the points of an assembly that lie within a reach of contact.

    Arguments: `reach`: largest gap of a point between convex parts with flat faces [length unit];
    `fine_reach`: the same for all other pairs [length unit]; `pairs` (n, 2): parts a < b of the
    pairs that are examined; None: all.
    """
    search = begin_search(assembly, Tolerance(gap=reach / CLUSTER), lambda stage: None)
    facets, geometry = search.facets, search.geometry
    if pairs is not None:
        keys = np.array([len(geometry.mass), 1])
        search = _restricted(search, np.isin(search.pairs @ keys, pairs @ keys), reach)
    plain = facets.convex_part & (np.diff(geometry.surfaces.start) == 0)
    simple = both_of(plain, search.pairs)
    flat, faced = _flat_points(_restricted(search, simple, reach), reach)
    blocks = [flat]
    alone = np.flatnonzero(simple)[~faced]
    if len(alone):
        apart, found = _convex_points(assembly, search.pairs[alone], reach)
        blocks.append(apart)
        simple[alone[~found]] = False
    if not simple.all():
        others = _restricted(search, ~simple, fine_reach)
        blocks += _general_points(others, fine_reach, assembly.down)
    points = NearPoints.join(blocks)
    parts, pair = distinct_rows(np.column_stack([points.part_a, points.part_b]))
    points = replace(points, mu=friction_coefficients(assembly, parts)[pair])
    return points.take(np.abs(points.gap) <= reach)


def _convex_points(assembly: Assembly, pairs: Index, reach: float) -> tuple[NearPoints, Mask]:
    """Points of pairs of parts by the distances of convex pieces, and a mask of convex pairs.

    Arguments: `pairs` (n, 2): parts a < b.
    """
    used, number = np.unique(pairs, return_inverse=True)
    number = number.reshape(-1, 2)
    parts = [assembly.parts[k] for k in used.tolist()]
    pieces = convex_pieces(Assembly(parts, units=assembly.units))
    a, b = np.triu_indices(len(used), 1)
    wanted = np.isin(a * len(used) + b, number @ np.array([len(used), 1]))
    rotation = np.array([part.pose.matrix for part in parts])
    position = np.array([part.pose.position for part in parts])
    ignored = np.column_stack([a, b])[~wanted]
    found = near_points(pieces, rotation, position, reach, ignored)
    columns = (found.point, found.normal, found.gap, found.bears)
    points = _points((used[found.part_a], used[found.part_b], *columns))
    return points, both_of(pieces.whole, number)


def both_of(of_part: Mask, pairs: Index) -> Mask:
    """Mask of pairs of which both parts are marked, shape (n,)."""
    a, b = pairs.T
    both: Mask = of_part[a] & of_part[b]
    return both


def _restricted(search: ContactSearch, rows: Mask, reach: float | Array) -> ContactSearch:
    """The search for only some pairs, with the reach as the largest gap of a contact."""
    limits = search.limits.take(np.flatnonzero(rows))
    wide = np.full(len(limits), reach)
    limits = replace(limits, gap=wide, closed=wide, margin=wide)
    return replace(search, pairs=search.pairs[rows], limits=limits, angle=FACING)


def _points(
    values: tuple[Index, Index, Array, Array, Array, Mask] | None,
) -> NearPoints:
    """Points from their columns, without friction."""
    if values is None or not len(values[0]):
        return NearPoints.none()
    part_a, part_b, point, normal, gap, bears = values
    points = NearPoints(part_a, part_b, point, normal, gap, np.zeros(len(gap)), bears)
    sound = np.isfinite(gap) & (np.abs(np.einsum("ki,ki->k", normal, normal) - 1) < UNIT)
    return points if sound.all() else points.take(sound)


# opposed flat faces ----------------------------------------------------------------------


def _flat_points(
    search: ContactSearch, reach: float, skip: FacePatches | None = None
) -> tuple[NearPoints, Mask]:
    """Corners of the overlaps of opposed flat faces, and a mask of the pairs that have some."""
    facets = search.facets
    margin = search.limits.margin
    pair, i, j = facet_pairs(facets, search.boxes, search.pairs, margin, float(np.cos(FACING)))
    flat = ~(facets.curved[i] | facets.curved[j])
    if skip is not None:
        flat &= ~skip.smooth.between(pair, i, j)
    pair, i, j = pair[flat], i[flat], j[flat]
    frames = facet_frames(facets, pair, i, j, margin[pair])
    frame, corner, count, bears = _overlap_polygons(search, frames, reach)
    faced = np.zeros(len(search.pairs), dtype=bool)
    faced[frames.pair[frame]] = True
    owner = np.repeat(frame, count)
    crossing = _crossing_normals(search, frames, frame, corner, count)
    points = _corner_points(search, frames, owner, corner, crossing)
    return replace(points, bears=np.repeat(bears, count)), faced


def _overlap_polygons(
    search: ContactSearch, frames: FacetFrame, reach: float
) -> tuple[Index, Array, Index, Mask]:
    """Overlap of each pair of faces as a convex polygon: its frame, corners (u, v) and their count.

    Polygons thinner than twice their gap are dropped, gaps wider than the reach, and faces that do
    not see each other. The hull of several pieces stands for them, since the gap is affine over
    both faces. The mask is false for strips that are too thin to count as an area of contact.
    """
    frame, count, corner = _hulls(*_seen_pieces(search, frames, reach))
    first = np.concatenate([[0], np.cumsum(count)[:-1]]).astype(np.int64)
    if not len(frame):
        return frame, corner, count, np.zeros(0, dtype=bool)
    gaps = frames.gaps(corner[:, None], np.repeat(frame, count))[:, 0]
    least = np.minimum.reduceat(np.abs(gaps), first)
    deep = np.maximum(least, -np.minimum.reduceat(gaps, first))
    size = search.geometry.size[search.pairs[frames.pair[frame]]].min(axis=1)
    width = _widths(corner, first, count)
    kept = (least <= reach) & (width >= np.maximum(2 * deep, SAME_PLACE * size))
    return (
        frame[kept], corner[np.repeat(kept, count)], count[kept],
        width[kept] >= THINNEST * size[kept],
    )  # fmt: skip


def _seen_pieces(
    search: ContactSearch, frames: FacetFrame, reach: float
) -> tuple[Index, Index, Array]:
    """Pieces of the overlaps of faces that see each other: frame, corner count, corners (u, v).

    A face that sees the other at the middle of a piece sees it everywhere, up to smaller faces in
    between. Convex parts hide no face with a gap.
    """
    blocks = overlaps_of(search.geometry, search.facets, frames)
    frame = np.concatenate([*(block.frame for block in blocks), np.empty(0, dtype=np.int64)])
    count = np.concatenate([*(block.count for block in blocks), np.empty(0, dtype=np.int64)])
    inner = [np.arange(block.points.shape[1]) < block.count[:, None] for block in blocks]
    corner = [block.points[mask] for block, mask in zip(blocks, inner, strict=True)]
    corners = np.concatenate([*corner, np.empty((0, 2))])
    if not len(frame):
        return frame, count, corners
    owner = np.repeat(np.arange(len(frame)), count)
    middle = group_sums(owner, corners, len(frame)) / count[:, None]
    gap = frames.gaps(middle[:, None], frame)[:, 0]
    convex = search.facets.convex_part[search.pairs[frames.pair[frame]]].all(axis=1)
    near = np.concatenate([np.abs(block.gap).min(axis=1) for block in blocks]) <= reach
    rows = np.flatnonzero(near & ~(convex & (gap >= 0)))
    point = frames.middle(middle[rows, None], frame[rows])[:, 0]
    half = gap[rows, None] / 2 * frames.normal[frame[rows]]
    seen = near
    seen[rows] = are_clear(search, frames.pair[frame[rows]], point - half, point + half)
    visible = np.zeros(len(frames), dtype=bool)
    visible[frame[seen]] = True
    kept = visible[frame]
    return frame[kept], count[kept], corners[kept[owner]]


def _hulls(frame: Index, count: Index, corners: Array) -> tuple[Index, Index, Array]:
    """The convex hull of all pieces of each frame, ordered by frame: as the arguments."""
    order = np.argsort(frame, kind="stable")
    start = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
    rows, first, pieces = np.unique(frame[order], return_index=True, return_counts=True)
    single = order[first[pieces == 1]]
    hulls = {
        int(k): convex_hull(corners[ragged(start, order[at : at + number])[1]])
        for k, at, number in zip(rows, first, pieces, strict=True)
        if number > 1
    }
    united = np.array(sorted(hulls), dtype=np.int64)
    frames = np.concatenate([frame[single], united])
    counts = np.concatenate([count[single], np.array([len(hulls[k]) for k in united], np.int64)])
    values = np.concatenate([corners[ragged(start, single)[1]], *(hulls[k] for k in united)])
    place = np.argsort(frames, kind="stable")
    begin = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    return frames[place], counts[place], values[ragged(begin, place)[1]]


def _widths(corners: Array, first: Index, count: Index) -> Array:
    """Twice the least standard deviation of the corners of each polygon [length unit]."""
    number = count.astype(np.float64)
    middle = np.add.reduceat(corners, first) / number[:, None]
    x, y = (corners - np.repeat(middle, count, axis=0)).T
    a, b, c = (np.add.reduceat(v, first) for v in (x * x, y * y, x * y))
    least = (a + b) / 2 - np.hypot((a - b) / 2, c)
    widths: Array = 2 * np.sqrt(np.maximum(least, 0.0) / number)
    return widths


def _crossing_normals(
    search: ContactSearch, frames: FacetFrame, frame: Index, corner: Array, count: Index
) -> Array:
    """Normal across both edges that cross at each corner of the overlaps of tilted faces, (n, 3).

    The sides of an overlap lie on edges of either face. For nearly parallel edges the normal is
    that of the face on which the other face closes first: of both sides that meet at the corner,
    the side with the smaller gap. NaN: the faces are nearly parallel.
    """
    normal = np.full((len(corner), 3), np.nan)
    start = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
    chosen = np.flatnonzero(frames.angle[frame] > LEVEL)
    owner, rows = ragged(start, chosen)
    if not len(rows):
        return normal
    place = np.arange(len(rows)) - np.searchsorted(owner, owner)
    size = count[chosen][owner]
    after = np.arange(len(rows)) + np.where(place + 1 < size, 1, 1 - size)
    before = np.arange(len(rows)) + np.where(place > 0, -1, size - 1)
    polygon, row = corner[rows], frame[chosen][owner]
    gaps = frames.gaps(polygon[:, None], row)[:, 0]
    along = polygon[after] - polygon
    off = [_boundary_distance(search, frames, row, side, polygon + along / 2) for side in (0, 1)]
    face = np.where(off[0] < off[1], 0, 1)  # of the side that begins at each corner
    rise = np.einsum("ki,ki->k", along, frames.slope[row, face])
    in_plane = along[:, :1] * frames.u[row] + along[:, 1:] * frames.v[row]
    lifted = unit_rows(in_plane + rise[:, None] * frames.normal[row])
    across = np.cross(lifted[before], lifted)
    across *= np.sign(np.einsum("ki,ki->k", across, frames.normal[row]))[:, None]
    sine = np.linalg.norm(across, axis=1)
    lower = np.where(gaps[after] < gaps[before], face, face[before])
    facets = search.facets
    planes = np.where(
        lower[:, None] == 0, -facets.normal[frames.j[row]], facets.normal[frames.i[row]]
    )
    skew = (sine > CROSSING) & (face != face[before])
    normal[rows] = np.where(skew[:, None], across / np.maximum(sine, TINY)[:, None], planes)
    return normal


def _boundary_distance(
    search: ContactSearch, frames: FacetFrame, row: Index, side: int, points: Array
) -> Array:
    """Distance of points (u, v) of frames `row` from the boundary of a face of the frame, (n,)."""
    facets = search.facets
    facet = (frames.i, frames.j)[side][row]
    owner, begin = ragged(facets.corner_start, facet)
    first = facets.corner_start[facet][owner]
    loop = np.where(facets.convex[facet], np.diff(facets.corner_start)[facet], 3)[owner]
    place = (begin - first) % loop
    end = begin + np.where(place + 1 < loop, 1, 1 - loop)
    vertices = search.geometry.vertices
    start, stop = (
        frames.flat(vertices[facets.corners[k]][:, None], row[owner])[:, 0] for k in (begin, end)
    )
    along, from_start = stop - start, points[owner] - start
    share = np.einsum("ki,ki->k", from_start, along)
    share = np.clip(share / np.maximum(np.einsum("ki,ki->k", along, along), TINY), 0.0, 1.0)
    off = np.linalg.norm(from_start - share[:, None] * along, axis=1)
    distance: Array = np.minimum.reduceat(off, np.searchsorted(owner, np.arange(len(facet))))
    return distance


def _corner_points(
    search: ContactSearch, frames: FacetFrame, owner: Index, corner: Array, crossing: Array
) -> NearPoints:
    """The candidate point of each corner (u, v) of an overlap, in the frame `owner`."""
    if not len(owner):
        return NearPoints.none()
    facets, geometry = search.facets, search.geometry
    i, j = frames.i[owner], frames.j[owner]
    gap = frames.gaps(corner[:, None, :], owner)[:, 0]
    point = frames.middle(corner[:, None, :], owner)[:, 0]
    normal = frames.normal[owner].copy()
    done = np.zeros(len(owner), dtype=bool)
    # a corner of a part over the plane of the other face: exact for finite angles too
    for facet, other, sign in ((i, j, 1.0), (j, i, -1.0)):
        vertex, found = _corner_at(search, facet, point - sign * gap[:, None] / 2 * normal)
        rows = np.flatnonzero(found & ~done)
        at = geometry.vertices[vertex[rows]]
        n = facets.normal[other[rows]]
        gap[rows] = np.einsum("ij,ij->i", at - facets.origin[other[rows]], n)
        point[rows], normal[rows] = at, -sign * n
        done[rows] = True
    rows = np.flatnonzero(~done & np.isfinite(crossing[:, 0]))
    gap[rows] *= np.einsum("ij,ij->i", normal[rows], crossing[rows])
    normal[rows] = crossing[rows]
    a, b = search.pairs[frames.pair[owner]].T
    return _points((a, b, point, normal, gap, np.ones(len(a), dtype=bool)))


def _corner_at(search: ContactSearch, facet: Index, at: Array) -> tuple[Index, Mask]:
    """The corner of each facet that is nearest to a point, and whether it lies there."""
    facets, geometry = search.facets, search.geometry
    count = np.where(facets.convex[facet], np.diff(facets.corner_start)[facet], 0)
    rows = padded(facets.corners, facets.corner_start[facet], count)
    off = np.linalg.norm(geometry.vertices[rows] - at[:, None, :], axis=2)
    nearest = off.argmin(axis=1)
    k = np.arange(len(facet))
    close = COINCIDES * geometry.size[facets.part[facet]]
    return rows[k, nearest], (off[k, nearest] <= close) & (count > 0)


# curved faces, edges and corners ---------------------------------------------------------


def _general_points(search: ContactSearch, reach: float, down: Array) -> list[NearPoints]:
    """Points of pairs of parts of any shape: flat faces, curved faces, edges and corners."""
    geometry = search.geometry
    pair, point, middle, normal, gap = feature_points(search, reach)
    a, b = search.pairs[pair].T
    features = _points((a, b, middle, normal, gap, np.ones(len(a), dtype=bool)))
    sound = _truly_inside(geometry, features)
    sound &= _share_material(geometry, features)
    features = replace(features, point=point).take(sound)
    curved = np.diff(geometry.surfaces.start) > 0
    a, b = search.pairs.T
    with_curves = curved[a] | curved[b]
    blocks = []
    if with_curves.any():
        blocks += _curved_points(_restricted(search, with_curves, reach), reach, down)
    if not with_curves.all():
        flat = _restricted(search, ~with_curves, reach)
        found = FacePatches(flat)
        if may_be_smooth(flat).any():
            found = replace(found, smooth=find_smooth(found))
        points = _flat_points(flat, reach, found)[0]
        blocks += [points.take(_share_material(geometry, points))]
        blocks += [_patches_of(flat, found.smooth.patches)]
    faces = NearPoints.join(blocks)
    points = NearPoints.join([faces, features.take(_not_among(geometry, features, faces))])
    return [points.take(~_beside_least_depth(geometry, points))]


def _curved_points(search: ContactSearch, reach: float, down: Array) -> list[NearPoints]:
    """Points of pairs of parts with curved faces."""
    geometry = search.geometry
    found = _families(search, reach)
    flat = _flat_points(search, reach, found)[0]
    flat = flat.take(_share_material(geometry, flat))
    blocks = [_patches_of(search, found.smooth.patches)]
    shafts = shafts_in_holes(geometry, search.pairs)
    curved = _without(found.curved, shafts)
    surface = np.repeat(curved.surface, np.diff(curved.patches.start), axis=0)
    gap = _curved_gaps(geometry, curved.patches, surface)
    points = _seen(search, _patch_points(curved.patches, gap))
    blocks.append(points.take(_share_material(geometry, points)))
    row, point, normal, gap = bore_points(geometry, shafts, down, reach)
    a, b = search.pairs[shafts.pair[row]].T
    blocks.append(_seen(search, _points((a, b, point, normal, gap, np.ones(len(a), dtype=bool)))))
    blocks.append(_patches_of(search, found.sharp.patches))
    exact = np.zeros(len(geometry.mass), dtype=bool)
    exact[geometry.surfaces.part[geometry.surfaces.doubt == 0.0]] = True
    # the corners of a mesh penetrate by another depth than the round faces recognised in it
    points = NearPoints.join(blocks)
    sure = (points.gap >= 0.0) | exact[points.part_a] | exact[points.part_b]
    return [flat, points.take(sure)]


def _families(search: ContactSearch, reach: float) -> FacePatches:
    """The families of contacts of parts with curved faces.

    Edges and corners on curved faces are searched for within a smaller reach, since most of their
    work grows with it: a longer step may lead into them, and is taken back.
    """
    found = FacePatches(search)
    if may_be_smooth(search).any():
        found = replace(found, smooth=find_smooth(found))
    found = replace(found, curved=find_curved(found))
    size = search.geometry.size[search.pairs].min(axis=1, initial=np.inf)
    limit = np.minimum(reach, SHARP * size)
    every = np.ones(len(search.pairs), dtype=bool)
    near = replace(found, search=_restricted(search, every, limit))
    near = replace(near, flat=find_flat(near))
    return replace(found, sharp=find_sharp(near, unmodelled=False))


def _patches_of(search: ContactSearch, patches: Patches) -> NearPoints:
    """Points of patches whose surfaces see each other, without false penetrations."""
    geometry = search.geometry
    points = _seen(search, _patch_points(patches, _sharp_gaps(geometry, patches)))
    points = points.take(_truly_inside(geometry, points))
    return points.take(_share_material(geometry, points))


def _not_among(geometry: Geometry, points: NearPoints, known: NearPoints) -> Mask:
    """Mask of points that are no known point of the same pair with a similar normal."""
    new = np.ones(len(points), dtype=bool)
    if not len(points) or not len(known):
        return new
    from scipy.spatial import cKDTree

    near = TWICE * float(geometry.size.min())
    for k, rows in enumerate(cKDTree(known.point).query_ball_point(points.point, near)):
        same = known.part_a[rows] == points.part_a[k]
        same &= known.part_b[rows] == points.part_b[k]
        new[k] = not (same & (known.normal[rows] @ points.normal[k] > np.cos(2 * FACING))).any()
    return new


def _beside_least_depth(geometry: Geometry, points: NearPoints) -> Mask:
    """Mask of penetrating points of a pair that a shallower direction opens as well.

    Points of a pair with similar normals form a group; its depth is that of its deepest point. Of
    two groups whose penetrations lie in the same place, only the shallower one counts.
    """
    beside = np.zeros(len(points), dtype=bool)
    deep = np.flatnonzero(points.gap < -SAME_PLACE * geometry.size.min())
    pairs, pair = distinct_rows(np.column_stack([points.part_a[deep], points.part_b[deep]]))
    for k in range(len(pairs)):
        rows = deep[pair == k]
        groups = _groups(points.normal[rows])
        if groups.max(initial=0) == 0:
            continue
        half = points.gap[rows, None] / 2 * points.normal[rows]
        ends = np.stack([points.point[rows] - half, points.point[rows] + half], axis=1)
        members = [np.flatnonzero(groups == g) for g in range(int(groups.max()) + 1)]
        members.sort(key=lambda group: -float(points.gap[rows[group]].min()))
        kept: list[tuple[Array, Array]] = []
        for group in members:
            low, high = ends[group].min(axis=(0, 1)), ends[group].max(axis=(0, 1))
            depth = -float(points.gap[rows[group]].min())
            if any(
                (np.minimum(high, top) - np.maximum(low, bottom) > -SAME_PLACE * depth).all()
                and _crosses_box(ends[group], bottom, top)
                for bottom, top in kept
            ):
                beside[rows[group]] = True
            else:
                kept.append((low, high))
    return beside


def _crosses_box(ends: Array, low: Array, high: Array) -> bool:
    """Whether a segment runs inside of a box over more than a part of its length."""
    share = np.linspace(0.0, 1.0, 9)[1:-1, None, None]
    inner = ends[:, 0] + share * (ends[:, 1] - ends[:, 0])
    grow = SAME_PLACE * float(np.ptp(ends, axis=1).max())
    return bool(((inner > low - grow) & (inner < high + grow)).all(axis=2).any())


def _groups(normals: Array) -> Index:
    """Group of each unit normal: those within the angle `SAME_WAY` of the first of a group."""
    group = np.full(len(normals), -1)
    number, left = 0, np.arange(len(normals))
    while len(left):
        alike = normals[left] @ normals[left[0]] > np.cos(SAME_WAY)
        alike[0] = True
        group[left[alike]] = number
        number, left = number + 1, left[~alike]
    return group


def _without(found: CurvedFindings, shafts: Shafts) -> CurvedFindings:
    """Patches of curved faces without those between shafts and wider holes."""
    count = int(max(shafts.body.max(initial=0), shafts.hole.max(initial=0))) + 2
    both = np.sort(found.surface, axis=1)
    known = np.sort(np.column_stack([shafts.body, shafts.hole]), axis=1)
    covered = np.isin(both[:, 0] * count + both[:, 1], known[:, 0] * count + known[:, 1])
    kept = np.flatnonzero(~covered)
    return CurvedFindings(found.patches.take(kept), surface=found.surface[kept])


def _seen(search: ContactSearch, points: NearPoints) -> NearPoints:
    """The points whose surfaces see each other (`clear_segments`)."""
    count = len(search.geometry.mass)
    keys = search.pairs[:, 0] * count + search.pairs[:, 1]
    order = np.argsort(keys, kind="stable")
    wanted = np.minimum(points.part_a, points.part_b) * count
    wanted = wanted + np.maximum(points.part_a, points.part_b)
    pair = order[np.searchsorted(keys[order], wanted)]
    half = points.gap[:, None] / 2 * points.normal
    return points.take(are_clear(search, pair, points.point - half, points.point + half))


def _share_material(geometry: Geometry, points: NearPoints) -> Mask:
    """Mask of points that do not penetrate, or that have material of both parts beside them.

    Faces of hollow parts may pass each other without sharing material: a shell inside the bore of
    another shell, or a half shell beside the missing half of another. Places beside the normal of a
    point are examined, since the point itself may lie in the rims of both faces. Triangulations of
    touching faces penetrate each other by their sagittas, so smaller penetrations are not examined.
    """
    sound = np.ones(len(points), dtype=bool)
    slack = geometry.slack[points.part_a] + geometry.slack[points.part_b]
    parts = np.column_stack([points.part_a, points.part_b])
    rows = np.flatnonzero(-points.gap > 2 * slack + SAME_PLACE * geometry.size.min())
    for a, b in distinct_rows(parts[rows])[0].tolist():
        k = rows[(parts[rows] == (a, b)).all(axis=1)]
        u, v = across(points.normal[k])
        u, v = u + OBLIQUE * v, v - OBLIQUE * u  # rims often run along a tangent
        sides = BESIDE * np.stack([u, -u, v, -v], axis=1)
        along = BETWEEN[:, None] * points.normal[k][:, None]
        offset = points.gap[k, None, None, None] * (along[:, :, None] + sides[:, None])
        places = points.point[k, None, None] + offset
        sound[k] = _any_inside(geometry, (a, b), places.reshape(len(k), -1, 3))
    return sound


def _any_inside(geometry: Geometry, parts: tuple[int, int], places: Array) -> Mask:
    """Mask of the rows of places (n, m, 3) of which one lies inside of both parts.

    Later places of a row are tested only if no earlier place is inside.
    """
    corners = [geometry.corners_of(part) for part in parts]
    low = np.maximum(*(triangles.min(axis=(0, 1)) for triangles in corners))
    high = np.minimum(*(triangles.max(axis=(0, 1)) for triangles in corners))
    near = ((places >= low) & (places <= high)).all(axis=2)
    found = np.zeros(len(places), dtype=bool)
    for begin, end in pairwise(STAGES):
        row, k = np.nonzero(near[:, begin:end] & ~found[:, None])
        for part in parts:
            inside = inside_part(geometry, part, places[row, begin + k])
            row, k = row[inside], k[inside]
        found[row] = True
    return found


def _truly_inside(geometry: Geometry, points: NearPoints) -> Mask:
    """Mask of points that do not penetrate, or whose features lie inside the other part.

    Parts that slide along a face show edges at right angles to it that seem to penetrate each
    other, although both lie on the face.
    """
    sound = np.ones(len(points), dtype=bool)
    rows = np.flatnonzero(points.gap < -SAME_PLACE * geometry.size.min())
    if len(rows):
        half = points.gap[rows, None] / 2 * points.normal[rows]
        deepest = np.zeros(len(rows))
        for part, side in ((points.part_a, 1.0), (points.part_b, -1.0)):
            at = points.point[rows] + side * half
            deepest = np.maximum(deepest, surface_gaps(geometry, part[rows, None], at))
        sound[rows] = deepest >= INSIDE * np.abs(points.gap[rows])
    return sound


def _patch_points(patches: Patches, gap: Array) -> NearPoints:
    """The points of patches as candidate points with the given gaps."""
    a, b = np.repeat(patches.parts, np.diff(patches.start), axis=0).T
    return _points((a, b, patches.points, patches.normals, gap, np.ones(len(a), dtype=bool)))


def _range_of(patches: Patches) -> tuple[Array, Array]:
    """Least and greatest gap of the patch of each point [length unit]."""
    low, high = np.repeat(patches.gap, np.diff(patches.start), axis=0).T
    return low, high


def _curved_gaps(geometry: Geometry, patches: Patches, surface: Index) -> Array:
    """Gap at each point of curved patches, from the exact surfaces [length unit].

    A contact point lies half-way in its gap, so the distance from a single surface is half of it.
    """
    gap = np.zeros(len(patches.points))
    for k in (0, 1):
        rows = np.flatnonzero(surface[:, k] >= 0)
        apart = geometry.surfaces.distance(surface[rows, k], patches.points[rows])
        gap[rows] += np.where(surface[rows, 1 - k] >= 0, apart, 2 * apart)
    low, high = _range_of(patches)
    single = (surface < 0).any(axis=1)
    return np.where(single, np.clip(gap, low, high), gap)


def _sharp_gaps(geometry: Geometry, patches: Patches) -> Array:
    """Gap at each point of patches of edges and corners, within the range of the patch."""
    low, high = _range_of(patches)
    gap = (low + high) / 2
    rows = np.flatnonzero(high - low > SAME_PLACE * geometry.size.min())
    if len(rows):
        parts = np.repeat(patches.parts, np.diff(patches.start), axis=0)[rows]
        apart = surface_gaps(geometry, parts, patches.points[rows])
        gap[rows] = np.clip(np.where(gap[rows] < 0, -apart, apart), low[rows], high[rows])
    return gap


def surface_gaps(geometry: Geometry, parts: Index, points: Array) -> Array:
    """Sum of the distances of each point from the surfaces of two parts [length unit], shape (n,).

    For a point half-way between two surfaces it is the absolute value of their gap. Exact curved
    surfaces count as well as triangles, whichever is nearer.

    Arguments: `parts` (n, 2), or (n, 1) for a single surface; `points` (n, 3).
    """
    total = np.zeros(len(points))
    for part in parts.T:
        total += _part_distance(geometry, part, points)
    return total


def _part_distance(geometry: Geometry, part: Index, points: Array) -> Array:
    """Distance of each point from the surface of its part [length unit], shape (n,)."""
    apart = np.full(len(points), np.inf)
    few = np.diff(geometry.triangle_start)[part] <= FEW_TRIANGLES
    rows = np.flatnonzero(few)
    for batch in np.array_split(rows, 1 + len(rows) * FEW_TRIANGLES // PAIRS):
        owner, triangle = ragged(geometry.triangle_start, part[batch])
        exact = geometry.triangle_surface[triangle] < 0
        row, corners = batch[owner[exact]], geometry.triangles[triangle[exact]]
        np.minimum.at(apart, row, triangle_distance(points[row], geometry.vertices[corners]))
    for each in np.unique(part[~few]).tolist():
        rows = np.flatnonzero(part == each)
        span = slice(geometry.triangle_start[each], geometry.triangle_start[each + 1])
        many = geometry.corners_of(each)[geometry.triangle_surface[span] < 0]
        if len(many):
            apart[rows] = surface_distance(points[rows], many)
    row, surface = ragged(geometry.surfaces.start, part)
    np.minimum.at(apart, row, np.abs(geometry.surfaces.distance(surface, points[row])))
    return apart
