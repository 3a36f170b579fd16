"""Candidate contact points between convex pieces of parts.

Each pair of pieces has one normal n from a to b: along the segment between the nearest points, or
the direction of the least overlap. Points lie along n between the surfaces: corners of a surface
over the other, and crossings of edges, each with its own gap along n.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, across, columns, counted, distinct_rows, ragged
from kilter.contact.convex_distance import (
    edge_separations,
    face_separations,
    nearest_points,
    products,
)
from kilter.contact.convex_pieces import ConvexPieces, Cores, Placed, placed

FACE_ANGLE = 0.06
"""Largest angle between the nearest points and a face normal that replaces it [rad]."""
FACE_SHARE = 0.998
"""Least separation along such a normal, over the distance [-]."""
EXACT = 1e-12
"""Rounding of a separation, over the size of a pair [-]."""
BESIDE = 1e-9
"""Distance beside a face at which a corner still lies over it, over the size of a pair [-]."""
SLOPE = 1e-6
"""A face counts as parallel to a direction if the cosine of their angle is below this [-]."""
CLASSES = (8, 16, 32, 64, 128, 256, 512, 1024, 4096)
"""Limits of the numbers of vertices of pairs that are handled together."""
ENTRIES = 20_000_000
"""Largest number of entries of an array over vertices and faces of pairs."""
SUNK = 1e-6
"""Depth in another piece of the same part at which a point is no point of the surface, over the
size of the piece [-]."""
CLOSED = 1e-3
"""Points whose gap exceeds the least gap of their pair by less than this, over the size of the
pair, are reduced to the extreme points among each other [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class PiecePoints(Rows):
    """Candidate contact points between convex pieces; world frame."""

    part_a: Index
    part_b: Index
    piece_a: Index
    piece_b: Index
    """Parts and pieces of each point, shape (K,)."""
    point: Array = columns(3)
    normal: Array = columns(3)
    """Point half-way between the surfaces [length unit], and unit normal from a to b, (K, 3)."""
    gap: Array = columns()
    """Distance of the surfaces along the normal [length unit], shape (K,); negative: overlap."""
    bears: Mask = columns()
    """False for points that only prevent penetration, shape (K,)."""


def near_points(
    pieces: ConvexPieces, rotation: Array, position: Array, reach: float, ignore: Index
) -> PiecePoints:
    """Find the candidate contact points within a reach between pieces of different parts.

    Arguments: `rotation` (N, 3, 3), `position` (N, 3): part k is at rotation[k] x + position[k];
    `reach`: largest gap of a point [length unit]; `ignore` (n, 2): pairs of parts without contact.
    """
    scene = placed(pieces, rotation, position)
    a, b = piece_pairs(scene, reach, ignore)
    width = np.maximum(np.diff(pieces.vertex_start), 1)
    group = np.searchsorted(CLASSES, np.maximum(width[a], width[b]))
    blocks = []
    for each in np.unique(group):
        rows = np.flatnonzero(group == each)
        faces = np.diff(pieces.face_start)
        block = max(1, int(ENTRIES / (CLASSES[each] * max(int(faces.max(initial=1)), 1) * 2)))
        blocks += [
            _points_of_pairs(scene, a[rows[k : k + block]], b[rows[k : k + block]], reach)
            for k in range(0, len(rows), block)
        ]
    return _distinct(_on_surface(scene, PiecePoints.join(blocks)), pieces)


# near pairs of boxes -----------------------------------------------------------------------


def piece_pairs(scene: Placed, reach: float, ignore: Index) -> tuple[Index, Index]:
    """Pairs of pieces of different parts whose boxes are within reach; a is of the lower part."""
    pieces = scene.pieces
    count = len(pieces.whole)
    start = np.searchsorted(pieces.part, np.arange(count + 1))
    has = np.flatnonzero(np.diff(start) > 0)
    if not len(has):
        return np.empty(0, np.int64), np.empty(0, np.int64)
    lower, upper = scene.low - reach / 2, scene.high + reach / 2
    low, high = np.minimum.reduceat(lower, start[has]), np.maximum.reduceat(upper, start[has])
    i, j = box_pairs(low, high)
    i, j = np.minimum(i, j), np.maximum(i, j)
    ignored = np.sort(np.asarray(ignore, dtype=np.int64).reshape(-1, 2), axis=1)
    kept = ~np.isin(has[i] * count + has[j], ignored @ np.array([count, 1]))
    i, j = i[kept], j[kept]
    lists = []
    for own, other in ((i, j), (j, i)):
        row, place = counted(np.diff(start)[has[own]])
        piece = start[has[own]][row] + place
        near = _boxes_meet(lower, upper, piece, low, high, other[row])
        lists.append((row[near], piece[near]))
    _, a, b = products(len(i), *lists)
    near = _boxes_meet(lower, upper, a, lower, upper, b)
    return a[near], b[near]


def box_pairs(low: Array, high: Array) -> tuple[Index, Index]:
    """Pairs of overlapping boxes with the corners `low` and `high`, shape (n, 3)."""
    axis = int(np.argmax(np.ptp(low + high, axis=0)))
    order = np.argsort(low[:, axis], kind="stable")
    low, high = low[order], high[order]
    last = np.searchsorted(low[:, axis], high[:, axis], side="right")
    i, place = counted(last - np.arange(len(low)) - 1)
    j = i + 1 + place
    near = _boxes_meet(low, high, i, low, high, j)
    return order[i[near]], order[j[near]]


def _boxes_meet(low: Array, high: Array, i: Index, lower: Array, upper: Array, j: Index) -> Index:
    """Rows at which box i of (low, high) meets box j of (lower, upper)."""
    rows = np.arange(len(i))
    for axis in range(3):
        meet = low[i, axis] <= upper[j, axis]
        meet &= lower[j, axis] <= high[i, axis]
        kept = np.flatnonzero(meet)
        rows, i, j = rows[kept], i[kept], j[kept]
    return rows


# the normal of each pair -------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class _Normals:
    """Normal of each pair, the distance of the cores along it, and nearest points."""

    normal: Array
    separation: Array
    on_a: Array
    on_b: Array


def _points_of_pairs(scene: Placed, piece_a: Index, piece_b: Index, reach: float) -> PiecePoints:
    """Points of pairs of pieces of similar numbers of vertices."""
    pieces = scene.pieces
    a, b = scene.cores(piece_a), scene.cores(piece_b)
    radius = pieces.radius[piece_a] + pieces.radius[piece_b]
    faces = face_separations(a, b)
    upper = np.maximum(faces[0].max(axis=1), faces[1].max(axis=1))
    near = np.flatnonzero(upper - radius <= reach)
    piece_a, piece_b, radius = piece_a[near], piece_b[near], radius[near]
    a, b, faces = a.take(near), b.take(near), (faces[0][near], faces[1][near])
    size = np.minimum(pieces.size[piece_a], pieces.size[piece_b])
    found = _normals(scene, (piece_a, piece_b), (a, b), faces, size)
    near = np.flatnonzero(found.separation - radius <= reach)
    a, b = a.take(near), b.take(near)
    piece_a, piece_b, radius, size = piece_a[near], piece_b[near], radius[near], size[near]
    n, separation = found.normal[near], found.separation[near]
    row, point, gap = points_along(a, b, n, separation, reach + radius, size)
    chosen = reduced(row, point, gap, n, size)
    row, point, gap = row[chosen], point[chosen], gap[chosen]
    alone = np.ones(len(near), dtype=bool)
    alone[row] = False
    alone = np.flatnonzero(alone)
    middle = (found.on_a[near[alone]] + found.on_b[near[alone]]) / 2
    bears = np.concatenate([np.ones(len(row), dtype=bool), radius[alone] > 0])
    row = np.concatenate([row, alone])
    point = np.concatenate([point, middle])
    gap = np.concatenate([gap, separation[alone]]) - radius[row]
    shift = (pieces.radius[piece_a] - pieces.radius[piece_b])[row] / 2
    point += shift[:, None] * n[row]
    a, b = piece_a[row], piece_b[row]
    return PiecePoints(pieces.part[a], pieces.part[b], a, b, point, n[row], gap, bears)


def _normals(
    scene: Placed,
    piece: tuple[Index, Index],
    cores: tuple[Cores, Cores],
    faces: tuple[Array, Array],
    size: Array,
) -> _Normals:
    """Normals of pairs of cores."""
    a, b = cores
    count = len(size)
    rows = np.arange(count)
    first, second = _outer_faces(scene, piece, faces)
    i, j = first.argmax(axis=1), second.argmax(axis=1)
    of_a = first[rows, i] >= second[rows, j]
    normal = np.where(of_a[:, None], a.normal[rows, i], -b.normal[rows, j])
    face = np.where(of_a, first[rows, i], second[rows, j])
    nearest = nearest_points(a, b, size)
    step = nearest.on_b - nearest.on_a
    apart = np.linalg.norm(step, axis=1)
    along = step / np.where(apart > 0, apart, 1.0)[:, None]
    # the support functions give the separation along the direction exactly
    found = nearest.apart
    sharp = scene.pieces.radius[piece[0]] + scene.pieces.radius[piece[1]] == 0
    cosine = np.einsum("ki,ki->k", along, normal)
    near_face = sharp & (cosine >= np.cos(FACE_ANGLE)) & (face >= FACE_SHARE * apart)
    by_face = ~found | (face >= apart - EXACT * size) | (near_face & (face > 0))
    result = np.where(by_face[:, None], normal, along)
    separation = np.where(by_face, face, apart)
    on_a, on_b = nearest.on_a.copy(), nearest.on_b.copy()
    doubt = np.flatnonzero(~found & (face < 0) | (found & ~by_face & (apart < 1e-4 * size)))
    if len(doubt):
        bound = np.where(np.isfinite(face), np.abs(face), size)[doubt]
        edges = edge_separations(a.take(doubt), b.take(doubt), bound)
        row = doubt[edges.row]
        best = np.full(count, -np.inf)
        np.maximum.at(best, row, edges.separation)
        least = np.where(found, apart - EXACT * size, face + EXACT * size)
        take = (edges.separation == best[row]) & (edges.separation > least[row])
        result[row[take]] = edges.normal[take]
        separation[row[take]] = edges.separation[take]
    none = ~np.isfinite(separation)
    result[none], separation[none] = [0.0, 0.0, 1.0], 0.0
    support = np.flatnonzero(~found)
    height = (a.vertex[support] @ result[support, :, None])[..., 0].argmax(axis=1)
    on_a[support] = a.vertex[support, height]
    on_b[support] = on_a[support] + separation[support, None] * result[support]
    return _Normals(result, separation, on_a, on_b)


def _outer_faces(
    scene: Placed, piece: tuple[Index, Index], faces: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Separations along face normals; faces inside of a compound do not count in overlaps."""
    pieces = scene.pieces
    result = []
    for which, separation in zip(piece, faces, strict=True):
        if not len(pieces.inner):
            result.append(separation)
            continue
        k = pieces.face_start[which][:, None] + np.arange(separation.shape[1])
        inner = pieces.inner[np.minimum(k, len(pieces.inner) - 1)]
        result.append(np.where(inner & (separation < 0), -np.inf, separation))
    lost = np.maximum(result[0].max(axis=1), result[1].max(axis=1)) == -np.inf
    for own, separation in zip(result, faces, strict=True):
        own[lost] = separation[lost]
    return result[0], result[1]


# points along the normal -------------------------------------------------------------------


def points_along(
    a: Cores, b: Cores, n: Array, separation: Array, reach: Array, size: Array
) -> tuple[Index, Array, Array]:
    """Points between surfaces that lie over each other along n: row, middle, gap.

    Arguments: `n` (K, 3); `separation` (K,): gap of the support planes; `reach` (K,); `size` (K,).
    """
    slack = BESIDE * size
    cos_a, cos_b = ((core.normal @ n[..., None])[..., 0] for core in (a, b))
    blocks = [
        _corners_over(b, a, cos_b, cos_a, n, slack, -1.0),
        _corners_over(a, b, cos_a, cos_b, n, slack, 1.0),
        _crossings(a, b, (cos_a, cos_b), n, reach - separation, slack),
    ]
    bare = ~(np.isfinite(a.offset).any(axis=1) & np.isfinite(b.offset).any(axis=1))
    if bare.any():
        blocks += [_corners_on_edges(b, a, bare, n, slack, -1.0)]
        blocks += [_corners_on_edges(a, b, bare, n, slack, 1.0)]
    row, point, gap = (np.concatenate([block[k] for block in blocks]) for k in range(3))
    kept = gap <= reach[row]
    return row[kept], point[kept], gap[kept]


def _corners_over(
    own: Cores, other: Cores, cos_own: Array, cos: Array, n: Array, slack: Array, sign: float
) -> tuple[Index, Array, Array]:
    """Corners of a surface over the other: row, middle of the gap, gap.

    `sign`: 1 if n points from `own` to `other`, else -1.
    """
    cos, cos_own = sign * cos, sign * cos_own
    touches = own.offset[:, None] - own.vertex @ own.normal.transpose(0, 2, 1)
    on = (touches <= slack[:, None, None]) & (cos_own > SLOPE)[:, None]
    bare = ~np.isfinite(own.offset).any(axis=1)
    facing = on.any(axis=2) | bare[:, None]
    facing &= np.isfinite(other.offset).any(axis=1)[:, None]
    row, k = np.nonzero(facing)
    x = own.vertex[row, k]
    room = other.offset[row] - np.einsum("kfi,ki->kf", other.normal[row], x)
    c, wide = cos[row], room + slack[row, None]
    into, out = c < -SLOPE, c > SLOPE
    safe = np.where(into | out, c, 1.0)
    enter = np.where(into, wide / safe, -np.inf).max(axis=1)
    leave = np.where(out, wide / safe, np.inf).min(axis=1)
    inside = (enter <= leave) & (into | out | (wide >= 0)).all(axis=1)
    row, x = row[inside], x[inside]
    gap = np.where(into, room / safe, -np.inf).max(axis=1)[inside]
    return row, x + (sign * gap / 2)[:, None] * n[row], gap


def _plane(n: Array, x: Array) -> tuple[Array, Array, Array]:
    """Coordinates of points across n and along n."""
    u, v = across(n)
    return tuple(np.einsum("...i,...i->...", x, y) for y in (u, v, n))  # type: ignore[return-value]


def _facing_edges(core: Cores, cos: Array, n: Array, sign: float, room: Array) -> Mask:
    """Edges of a surface that faces along sign n, not lower than `room` below its top, (K, E)."""
    rows = np.arange(len(n))[:, None]
    height = sign * (core.vertex @ n[..., None])[..., 0]
    high = np.maximum(height[rows, core.edge[..., 0]], height[rows, core.edge[..., 1]])
    beside = sign * np.maximum(
        sign * cos[rows, core.edge_face[..., 0]], sign * cos[rows, core.edge_face[..., 1]]
    )
    facing = (sign * beside > SLOPE) | (core.edge_face[..., 0] < 0)
    return core.edges & facing & (high >= height.max(axis=1)[:, None] - room[:, None])


def _crossings(
    a: Cores, b: Cores, cos: tuple[Array, Array], n: Array, room: Array, slack: Array
) -> tuple[Index, Array, Array]:
    """Crossings of edges of both surfaces seen along n: row, middle of the gap, gap."""
    lists = []
    for core, other, c, sign in ((a, b, cos[0], 1.0), (b, a, cos[1], -1.0)):
        facing = _facing_edges(core, c, n, sign, room)
        row, k = np.nonzero(facing)
        ends = core.edge[row, k]
        p, q = core.vertex[row, ends[:, 0]], core.vertex[row, ends[:, 1]]
        lists.append((row, k, p, q))
    row, i, j = products(
        len(n),
        (lists[0][0], np.arange(len(lists[0][0]))),
        (lists[1][0], np.arange(len(lists[1][0]))),
    )
    u, v = across(n)
    flat = []
    for own, _, p, q in lists:
        flat.append([np.einsum("ki,ki->k", x, y[own]) for x in (p, q) for y in (u, v)])
    pu, pv, qu, qv = (x[i] for x in flat[0])
    ru, rv, su, sv = (x[j] for x in flat[1])
    du, dv, eu, ev = qu - pu, qv - pv, su - ru, sv - rv
    det = du * ev - dv * eu
    length, width = np.hypot(du, dv), np.hypot(eu, ev)
    crossing = np.abs(det) > BESIDE * length * width
    safe = np.where(crossing, det, 1.0)
    s = ((ru - pu) * ev - (rv - pv) * eu) / safe
    t = ((ru - pu) * dv - (rv - pv) * du) / safe
    tol = slack[row]
    crossing &= (s * length >= -tol) & ((1 - s) * length >= -tol)
    crossing &= (t * width >= -tol) & ((1 - t) * width >= -tol)
    rows = np.flatnonzero(crossing)
    row, i, j = row[rows], i[rows], j[rows]
    s, t = np.clip(s[rows], 0, 1)[:, None], np.clip(t[rows], 0, 1)[:, None]
    on_a = lists[0][2][i] * (1 - s) + lists[0][3][i] * s
    on_b = lists[1][2][j] * (1 - t) + lists[1][3][j] * t
    gap = np.einsum("ki,ki->k", on_b - on_a, n[row])
    return row, (on_a + on_b) / 2, gap


def _corners_on_edges(
    own: Cores, other: Cores, which: Mask, n: Array, slack: Array, sign: float
) -> tuple[Index, Array, Array]:
    """Corners over edges of the other core where a core has no faces: row, middle, gap."""
    pick = np.flatnonzero(which)
    row, e, k = products(
        len(n),
        tuple(x[np.isin(np.nonzero(other.edges)[0], pick)] for x in np.nonzero(other.edges)),  # type: ignore[arg-type]
        (np.repeat(pick, own.vertex.shape[1]), np.tile(np.arange(own.vertex.shape[1]), len(pick))),
    )
    ends = other.edge[row, e]
    p, q = other.vertex[row, ends[:, 0]], other.vertex[row, ends[:, 1]]
    x, d, m = own.vertex[row, k], q - p, n[row]
    flat = d - np.einsum("ki,ki->k", d, m)[:, None] * m
    square = np.einsum("ki,ki->k", flat, flat)
    share = np.einsum("ki,ki->k", x - p, flat) / np.where(square > 0, square, 1.0)
    at = p + share[:, None] * d
    off = at - x
    gap = sign * np.einsum("ki,ki->k", off, m)
    beside = np.linalg.norm(off - (sign * gap)[:, None] * m, axis=1)
    length = np.sqrt(square)
    good = (square > 0) & (beside <= slack[row])
    good &= (share * length >= -slack[row]) & ((1 - share) * length >= -slack[row])
    return row[good], ((x + at) / 2)[good], gap[good]


def reduced(row: Index, point: Array, gap: Array, n: Array, size: Array) -> Index:
    """Extreme points of each pair: in eight directions across n, of all and of the closed points."""
    if not len(row):
        return np.empty(0, dtype=np.int64)
    order = np.argsort(row, kind="stable")
    row, point, gap = row[order], point[order], gap[order]
    first = np.flatnonzero(np.diff(row, prepend=-1))
    of = counted(np.diff(np.append(first, len(row))))[0]
    u, v = across(n[row[first]])
    flat = np.stack([np.einsum("ki,ki->k", point, y[of]) for y in (u, v)], axis=1)
    least = np.minimum.reduceat(gap, first)
    closed = gap <= (least + CLOSED * size[row[first]])[of]
    kept = [gap.copy()]
    angle = np.arange(8) * (np.pi / 4) + 0.1
    ahead = flat @ np.stack([np.cos(angle), np.sin(angle)])
    # of points at the same place, the one with the least gap
    ahead -= 1e-3 * gap[:, None]
    kept = np.concatenate([gap[:, None], -ahead, np.where(closed[:, None], -ahead, np.inf)], axis=1)
    best = np.minimum.reduceat(kept, first)
    chosen = np.zeros(len(row), dtype=bool)
    for value, low in zip(kept.T, best.T, strict=True):
        hit = np.flatnonzero(value == low[of])
        chosen[hit[np.diff(of[hit], prepend=-1) > 0]] = True
    return order[chosen]


# points of compounds -------------------------------------------------------------------------


def _on_surface(scene: Placed, points: PiecePoints) -> PiecePoints:
    """The points that do not lie inside another piece of either part."""
    hidden = np.zeros(len(points), dtype=bool)
    for piece, sign in ((points.piece_a, -0.5), (points.piece_b, 0.5)):
        on = points.point + (sign * points.gap)[:, None] * points.normal
        hidden |= inside_others(scene, piece, on)
    return points.take(~hidden)


def inside_others(scene: Placed, piece: Index, x: Array) -> Mask:
    """Whether points of pieces lie inside another piece of the same part."""
    pieces = scene.pieces
    row, place = ragged(pieces.beside_start, piece)
    other = pieces.beside[place]
    for axis in range(3):
        at = x[row, axis]
        near = np.flatnonzero((at > scene.low[other, axis]) & (at < scene.high[other, axis]))
        row, other = row[near], other[near]
    result = np.zeros(len(piece), dtype=bool)
    result[row[depth_in(scene, other, x[row]) > SUNK * pieces.size[other]]] = True
    return result


def depth_in(scene: Placed, piece: Index, x: Array) -> Array:
    """Depth of each point in a piece [length unit], shape (K,); negative outside."""
    pieces = scene.pieces
    owner, place = counted(np.diff(pieces.face_start)[piece])
    face = pieces.face_start[piece][owner] + place
    room = scene.offset[face] - np.einsum("ki,ki->k", scene.normal[face], x[owner])
    depth = np.full(len(piece), np.inf)
    np.minimum.at(depth, owner, room)
    bare = np.flatnonzero(np.isinf(depth))
    if len(bare):
        first = pieces.vertex_start[piece[bare]]
        last = pieces.vertex_start[piece[bare] + 1] - 1
        p, d = scene.vertex[first], scene.vertex[last] - scene.vertex[first]
        square = np.einsum("ki,ki->k", d, d)
        share = np.einsum("ki,ki->k", x[bare] - p, d) / np.where(square > 0, square, 1.0)
        off = x[bare] - p - np.clip(share, 0, 1)[:, None] * d
        depth[bare] = pieces.radius[piece[bare]] - np.linalg.norm(off, axis=1)
    return depth


def _distinct(points: PiecePoints, pieces: ConvexPieces) -> PiecePoints:
    """Points without repetitions: the same parts, place and normal."""
    if not len(points):
        return points
    size = float(pieces.size.max())
    keys = np.column_stack(
        [
            points.part_a,
            points.part_b,
            np.round(points.point / (1e-8 * size)),
            np.round(points.normal * 1e6),
        ]
    )
    order = np.lexsort((points.gap, ~points.bears))
    _, inverse = distinct_rows(keys[order])
    first = np.full(int(inverse.max()) + 1, len(points))
    np.minimum.at(first, inverse, np.arange(len(points)))
    return points.take(np.sort(order[first]))
