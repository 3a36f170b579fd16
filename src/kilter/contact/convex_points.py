"""Candidate contact points between convex pieces of parts.

Each pair of pieces has one normal n from a to b: along the segment between the nearest points, or
the direction of the least overlap. Points lie along n between the surfaces: corners of a surface
over the other, and crossings of edges, each with its own gap along n.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, across, columns, counted, distinct_rows, ragged
from kilter.contact.convex_distance import face_separations, product_blocks, products
from kilter.contact.convex_normals import FACE_ANGLE, Excluded, exact_separation, pair_normals
from kilter.contact.convex_pieces import (
    ConvexPieces,
    Cores,
    Placed,
    padded_rows,
    placed,
    with_generators,
)
from kilter.contact.convex_tolerances import (
    BESIDE,
    CLOSED,
    INWARDS,
    ROUND,
    SAME_POINT,
    SLOPE,
    STEP_BACK,
    SUNK,
    TILT,
)

BEYOND = 0.15
"""Faces look along a direction if they deviate by at most this more than the nearest one [rad]."""
LAYER = 0.1
"""Depth of the layer of pieces of a compound that are compared with another part, over the size of
the smaller part [-]; pieces behind it follow when the parts come nearer."""
DIRECTIONS = 16
"""Number of directions across a normal in which points of a pair are extreme [-]."""
FEW = 12
"""Number of points of a pair that all stay [-]."""
CLASSES = (8, 16, 32, 64, 128, 256, 512, 1024, 4096)
"""Limits of the numbers of vertices of pairs that are handled together."""
ENTRIES = 20_000_000
"""Largest number of entries of an array over vertices and faces of pairs."""
TRIES = 5
"""Number of directions along which an overlap of pieces of compounds is left."""
STAYS = 0.5
"""Share of an overlap that may stay when a known overlap of the same parts opens [-]."""


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
    pieces: ConvexPieces,
    rotation: Array,
    position: Array,
    reach: float | Array,
    ignore: Index,
    body: Index | None = None,
    moved: Mask | None = None,
) -> PiecePoints:
    """Find the candidate contact points within a reach between pieces of different parts.

    Arguments: `rotation` (N, 3, 3), `position` (N, 3): part k is at rotation[k] x + position[k];
    `reach`: largest gap of a point [length unit], or that of each part (N,), of which the larger
    counts for a pair; `ignore` (n, 2): pairs of parts without contact; `body` (N,): parts with the
    same number move as one, and have no points between them; `moved` (N,): pairs without one of
    these parts are left out; None: all count.
    """
    scene = placed(pieces, rotation, position)
    reach = np.broadcast_to(np.asarray(reach, dtype=np.float64), len(pieces.whole))
    pair = piece_pairs(scene, reach, ignore, body, moved)
    tried = np.empty((len(pair[0]), 0, 3))
    kept, hidden = [], PiecePoints.none()
    for turn in range(TRIES):
        points, row = _points_in_groups(scene, pair, tried, reach)
        shown = _shown_points(scene, points, row)
        if turn:
            shown &= _meets_surfaces(scene, points)
        else:
            hidden = points.take(~shown)
        kept.append(points.take(shown))
        again = _hidden_pairs(pieces, pair, (points, row, shown), PiecePoints.join(kept))
        if not len(again):
            break
        normal = np.zeros((len(pair[0]), 3))
        normal[row] = points.normal
        pair = pair[0][again], pair[1][again]
        tried = np.concatenate([tried[again], normal[again, None]], axis=1)
    found = PiecePoints.join(kept)
    return distinct_points(PiecePoints.join([found, _lost(scene, hidden, found)]), pieces)


def _lost(scene: Placed, hidden: PiecePoints, found: PiecePoints) -> PiecePoints:
    """Points near contact that count although another piece of their compound hides them.

    First the nearest of two parts that have no other points near contact: its direction may lead
    into the compound, but no overlap is ever left out. Then the pairs of pieces that may still
    overlap when the points found are closed: in a corner between two pieces, the point on each may
    lie inside of the other.
    """
    pieces = scene.pieces

    def near_contact(points: PiecePoints) -> PiecePoints:
        """Points of pairs that touch or overlap."""
        size = np.minimum(pieces.size[points.piece_a], pieces.size[points.piece_b])
        return points.take(points.gap <= CLOSED * size)

    hidden, known = near_contact(hidden), near_contact(found)
    if not len(hidden):
        return hidden
    parts, known_parts = (x.part_a * len(pieces.whole) + x.part_b for x in (hidden, known))
    alone = ~np.isin(parts, known_parts)
    lost = _deepest(hidden.take(alone), parts[alone])
    known = PiecePoints.join([known, lost])
    known = _deepest(known, known.piece_a * len(pieces) + known.piece_b)
    code = hidden.piece_a * len(pieces) + hidden.piece_b
    own = _deepest(hidden, code)
    kept = PiecePoints.join([lost, own.take(~_open_with(scene, own, known))])
    return hidden.take(np.isin(code, kept.piece_a * len(pieces) + kept.piece_b))


def _deepest(points: PiecePoints, code: Index) -> PiecePoints:
    """The point with the least gap of each code, shape (K,)."""
    order = np.argsort(points.gap, kind="stable")
    return points.take(order[np.unique(code[order], return_index=True)[1]])


def _open_with(scene: Placed, own: PiecePoints, known: PiecePoints) -> Mask:
    """Whether pairs of pieces do not overlap if a known point of the same parts has no gap.

    Such a point keeps the pair apart along its own normal. At a seam of a wall of many pieces, a
    small share of an overlap stays.
    """
    pieces = scene.pieces
    own_row = np.argsort(own.part_a * len(pieces.whole) + own.part_b, kind="stable")
    known = known.take(np.argsort(known.part_a * len(pieces.whole) + known.part_b, kind="stable"))
    parts = [x.part_a * len(pieces.whole) + x.part_b for x in (own.take(own_row), known)]
    codes, row = np.unique(np.concatenate(parts), return_inverse=True)
    i, j = products(len(codes), row[: len(own)], row[len(own) :])
    i = own_row[i]
    slack = SUNK * pieces.size[own.piece_a]
    some = known.gap[j] <= own.gap[i] + slack[i]
    i, j = i[some], j[some]
    pair = own.piece_a[i], own.piece_b[i]
    after = exact_separation(scene, pair, known.normal[j][:, None])[:, 0] - known.gap[j]
    after -= pieces.radius[pair[0]] + pieces.radius[pair[1]]
    best = np.full(len(own), -np.inf)
    np.maximum.at(best, i, after)
    opens: Mask = best >= STAYS * np.minimum(own.gap, 0.0) - slack
    return opens


def _shown_points(scene: Placed, points: PiecePoints, row: Index) -> Mask:
    """Points on the surfaces of both parts, of pairs whose nearest points are among them.

    A pair whose nearest points are at a seam has a normal that is none of the whole part.
    """
    shown = on_surface(scene, points)
    count = int(row.max(initial=-1)) + 1
    least = np.full(count, np.inf)
    np.minimum.at(least, row, points.gap)
    slack = BESIDE * scene.pieces.size[points.piece_a]
    nearest = shown & (points.gap <= least[row] + slack)
    sound = np.zeros(count, dtype=bool)
    sound[row[nearest]] = True
    return shown & sound[row]


def _meets_surfaces(scene: Placed, points: PiecePoints) -> Mask:
    """Whether both ends of the gap belong to the pieces.

    Along a direction that is not the least overlap, the support features of both pieces may lie
    beside each other: the pieces do not meet there.
    """
    shown = np.ones(len(points), dtype=bool)
    for piece, sign in ((points.piece_a, -0.5), (points.piece_b, 0.5)):
        on = points.point + (sign * points.gap)[:, None] * points.normal
        slack = SUNK * scene.pieces.size[piece] + ROUND * scene.pieces.disc[piece]
        shown &= depth_in(scene, piece, on) >= -slack
    return shown


def _hidden_pairs(
    pieces: ConvexPieces,
    pair: tuple[Index, Index],
    last: tuple[PiecePoints, Index, Mask],
    found: PiecePoints,
) -> Index:
    """Overlaps whose points are all hidden and that are deeper than others of both parts.

    Arguments: `last`: points of the pairs, their pairs, and whether they are shown; `found`: points
    that are shown.
    """
    points, row, shown = last
    depth, seen = np.zeros(len(pair[0])), np.zeros(len(pair[0]), dtype=bool)
    np.maximum.at(depth, row, -points.gap)
    seen[row[shown]] = True
    count = len(pieces.whole)
    code = pieces.part[pair[0]] * count + pieces.part[pair[1]]
    parts, of = np.unique(np.append(code, found.part_a * count + found.part_b), return_inverse=True)
    deepest = np.zeros(len(parts))
    np.maximum.at(deepest, of[len(code) :], -found.gap)
    return np.flatnonzero(~seen & (depth > deepest[of[: len(code)]]))


def _points_in_groups(
    scene: Placed, pair: tuple[Index, Index], tried: Array, reach: Array
) -> tuple[PiecePoints, Index]:
    """Points of pairs of pieces, in groups of similar numbers of vertices, and their pairs."""
    pieces = scene.pieces
    width = np.maximum(*(np.diff(pieces.vertex_start)[piece] for piece in pair))
    group = np.searchsorted(CLASSES, width)
    faces = max(int(np.diff(pieces.face_start).max(initial=1)), 1)
    blocks, owners = [], []
    for each in np.unique(group).tolist():
        rows = np.flatnonzero(group == each)
        step = max(1, ENTRIES // (2 * CLASSES[each] * faces))
        for k in range(0, len(rows), step):
            some = rows[k : k + step]
            part = pair[0][some], pair[1][some]
            points, row = _points_of_pairs(scene, part, tried[some], reach)
            blocks.append(points)
            owners.append(some[row])
    return PiecePoints.join(blocks), np.concatenate([np.empty(0, dtype=np.int64), *owners])


# near pairs of boxes -----------------------------------------------------------------------


def piece_pairs(
    scene: Placed, reach: Array, ignore: Index, body: Index | None, moved: Mask | None
) -> tuple[Index, Index]:
    """Pairs of pieces of different parts whose boxes are within reach; a is of the lower part."""
    pieces = scene.pieces
    count = len(pieces.whole)
    start = np.searchsorted(pieces.part, np.arange(count + 1))
    has = np.flatnonzero(np.diff(start) > 0)
    if not len(has):
        return np.empty(0, np.int64), np.empty(0, np.int64)
    low = np.minimum.reduceat(scene.low, start[has])
    high = np.maximum.reduceat(scene.high, start[has])
    ends = box_pairs(low, high, reach[has])
    i, j = np.minimum(*ends), np.maximum(*ends)
    ignored = np.sort(np.asarray(ignore, dtype=np.int64).reshape(-1, 2), axis=1)
    kept = ~np.isin(has[i] * count + has[j], ignored @ np.array([count, 1]))
    if body is not None:
        kept &= body[has[i]] != body[has[j]]
    if moved is not None:
        kept &= moved[has[i]] | moved[has[j]]
    i, j = i[kept], j[kept]
    limit = np.maximum(reach[has[i]], reach[has[j]])
    lists = []
    for own, other in ((i, j), (j, i)):
        row, place = counted(np.diff(start)[has[own]])
        piece = start[has[own]][row] + place
        near = _boxes_meet(scene.low, scene.high, piece, low, high, other[row], limit[row])
        lists.append((row[near], piece[near]))
    k, m = products(len(i), lists[0][0], lists[1][0])
    a, b = lists[0][1][k], lists[1][1][m]
    k = lists[0][0][k]
    near = _boxes_meet(scene.low, scene.high, a, scene.low, scene.high, b, limit[k])
    a, b = a[near], b[near]
    size = np.linalg.norm(high - low, axis=1)
    first = _first_layer(scene, a, b, k[near], LAYER * np.minimum(size[i], size[j]))
    return a[first], b[first]


def _first_layer(scene: Placed, a: Index, b: Index, pair: Index, depth: Array) -> Mask:
    """Pairs of pieces that no nearer pieces of the same parts hide in their direction.

    The signs of the gaps between both boxes along x, y and z divide the pairs of pieces of two
    parts into 27 directions; those that are farther than the nearest pair by more than `depth` are
    hidden until the parts come nearer.

    Arguments: `a`, `b`: pieces; `pair`: pair of parts of each; `depth`: for each pair of parts.
    """
    after, before = scene.low[b] - scene.high[a], scene.low[a] - scene.high[b]
    distance = np.linalg.norm(np.maximum(np.maximum(after, before), 0), axis=1)
    side = (after > 0).astype(np.int64) - (before > 0) + 1
    key = pair * 27 + side @ np.array([9, 3, 1])
    least = np.full(27 * len(depth), np.inf)
    np.minimum.at(least, key, distance)
    hidden: Mask = distance > least[key] + depth[pair]
    return ~hidden


def box_pairs(low: Array, high: Array, reach: Array) -> tuple[Index, Index]:
    """Pairs of boxes whose distance along each axis is at most the larger reach of both.

    Arguments: `low`, `high` (n, 3): corners of the boxes; `reach` (n,).
    """
    axis = int(np.argmax(np.ptp(low + high, axis=0)))
    order = np.argsort((low - reach[:, None])[:, axis], kind="stable")
    low, high, reach = low[order], high[order], reach[order]
    ends = high[:, axis] + reach
    last = np.searchsorted(low[:, axis] - reach, ends, side="right")
    i, place = counted(last - np.arange(len(low)) - 1)
    j = i + 1 + place
    near = _boxes_meet(low, high, i, low, high, j, np.maximum(reach[i], reach[j]))
    return order[i[near]], order[j[near]]


def _boxes_meet(
    low: Array, high: Array, i: Index, lower: Array, upper: Array, j: Index, reach: Array
) -> Index:
    """Rows at which box i of (low, high) is within a reach of box j of (lower, upper)."""
    rows = np.arange(len(i))
    for axis in range(3):
        meet = low[i, axis] - reach <= upper[j, axis]
        meet &= lower[j, axis] - reach <= high[i, axis]
        kept = np.flatnonzero(meet)
        rows, i, j, reach = rows[kept], i[kept], j[kept], reach[kept]
    return rows


# points of each pair -------------------------------------------------------------------------


def _points_of_pairs(
    scene: Placed, pair: tuple[Index, Index], tried: Array, reach: Array
) -> tuple[PiecePoints, Index]:
    """Points of pairs of pieces of similar numbers of vertices, and the pair of each point."""
    pieces = scene.pieces
    reach = np.maximum(*(reach[pieces.part[piece]] for piece in pair))
    radius = pieces.radius[pair[0]] + pieces.radius[pair[1]]
    a, b = (scene.cores(piece) for piece in pair)
    faces = face_separations(a, b)
    upper = np.maximum(faces[0].max(axis=1), faces[1].max(axis=1))
    # a prism lies inside its cylinder
    loose = radius + ROUND * (pieces.disc[pair[0]] + pieces.disc[pair[1]])
    near = np.flatnonzero(upper - loose <= reach)
    excluded = Excluded(_inner(pieces, pair), tried).take(near)
    pair, reach = (pair[0][near], pair[1][near]), reach[near]
    cores, separations = (a.take(near), b.take(near)), (faces[0][near], faces[1][near])
    found = pair_normals(scene, pair, cores, separations, excluded, reach + loose[near])
    last = np.flatnonzero(found.separation - radius[near] <= reach)
    pair, found, near = (pair[0][last], pair[1][last]), found.take(last), near[last]
    reach = reach[last]
    n = found.normal
    a, b = (_lying(scene, piece, n, sign) for piece, sign in zip(pair, (1.0, -1.0), strict=True))
    radius = pieces.radius[pair[0]] + pieces.radius[pair[1]]
    size = np.minimum(pieces.size[pair[0]], pieces.size[pair[1]])
    row, point, gap, normal = points_along(a, b, n, found.separation, reach + radius, size)
    chosen = reduced(row, point, gap, n, size)
    row, point, gap, normal = row[chosen], point[chosen], gap[chosen], normal[chosen]
    without = np.ones(len(near), dtype=bool)
    without[row] = False
    alone = np.flatnonzero(without)
    row = np.concatenate([row, alone])
    point = np.concatenate([point, (found.on_a + found.on_b)[alone] / 2])
    gap = np.concatenate([gap, found.separation[alone]]) - radius[row]
    normal = np.concatenate([normal, n[alone]])
    bears = found.regular[row]
    bears[len(row) - len(alone) :] &= radius[alone] > 0
    shift = (pieces.radius[pair[0]] - pieces.radius[pair[1]])[row] / 2
    point += shift[:, None] * n[row]
    i, j = pair[0][row], pair[1][row]
    points = PiecePoints(pieces.part[i], pieces.part[j], i, j, point, normal, gap, bears)
    return points, near[row]


def _lying(scene: Placed, piece: Index, n: Array, sign: float) -> Cores:
    """Cores turned to normals n; cylinders on their side become lines."""
    cores = scene.cores(piece, n)
    axis = scene.axis[piece]
    length = np.linalg.norm(axis, axis=1)
    slope = np.einsum("ki,ki->k", axis, n) / np.where(length > 0, length, 1.0)
    with_generators(cores, slope, sign)
    return cores


def _inner(pieces: ConvexPieces, pair: tuple[Index, Index]) -> tuple[Mask, Mask]:
    """Faces inside of compounds, of each piece, padded; none of a piece with inner faces only."""
    masks = []
    for piece in pair:
        face, has = padded_rows(pieces.face_start, piece)
        inner = np.zeros_like(has)
        if len(pieces.inner):
            inner = np.logical_and(has, pieces.inner[face])
        outer = np.asarray(np.logical_and(has, ~inner).any(axis=1))
        masks.append(np.logical_and(inner, outer[:, None]))
    return masks[0], masks[1]


# points along the normal -------------------------------------------------------------------


def points_along(
    a: Cores, b: Cores, n: Array, separation: Array, reach: Array, size: Array
) -> tuple[Index, Array, Array, Array]:
    """Points between surfaces that lie over each other along n: row, middle, gap, normal.

    A corner that almost touches a face across n has the normal of this face, and its distance from
    it as the gap.

    Arguments: `n` (K, 3); `separation` (K,): gap of the support planes; `reach` (K,); `size` (K,).
    """
    slack = BESIDE * size
    cos_a, cos_b = ((core.normal @ n[..., None])[..., 0] for core in (a, b))
    blocks: list[tuple[Any, ...]] = [
        _corners_over(b, a, cos_b, cos_a, n, slack, -1.0),
        _corners_over(a, b, cos_a, cos_b, n, slack, 1.0),
        _crossings(a, b, (cos_a, cos_b), n, reach - separation, slack),
    ]
    bare = np.logical_or(a.bare, b.bare)
    if bare.any():
        blocks += [_corners_on_edges(b, a, bare, n, slack, -1.0)]
        blocks += [_corners_on_edges(a, b, bare, n, slack, 1.0)]
    row, point, gap = (np.concatenate([block[k] for block in blocks]) for k in range(3))
    normal = np.concatenate([block[3] if len(block) > 3 else n[block[0]] for block in blocks])
    kept = gap <= reach[row]
    return row[kept], point[kept], gap[kept], normal[kept]


def _corners_over(
    own: Cores, other: Cores, cos_own: Array, cos: Array, n: Array, slack: Array, sign: float
) -> tuple[Index, Array, Array, Array]:
    """Corners of a surface over the other: row, middle of the gap, gap, normal.

    `sign`: 1 if n points from `own` to `other`, else -1.
    """
    cos, cos_own = sign * cos, sign * cos_own
    touches = own.offset[:, None] - own.vertex @ own.normal.transpose(0, 2, 1)
    # corners of all faces that look along n, however little: a small turn may bring them nearest
    on = (touches <= slack[:, None, None]) & (cos_own > SLOPE)[:, None]
    height = sign * (own.vertex @ n[..., None])[..., 0]
    facing: Mask = on.any(axis=2) | (height >= height.max(axis=1, keepdims=True) - slack[:, None])
    facing |= own.bare[:, None]
    facing &= ~other.bare[:, None]
    row, k = np.nonzero(facing)
    x = own.vertex[row, k]
    room = other.offset[row] - np.einsum("kfi,ki->kf", other.normal[row], x)
    c, wide = cos[row], room + slack[row, None]
    into, out = c < -SLOPE, c > SLOPE
    safe = np.where(into | out, c, 1.0)
    enter = np.where(into, wide / safe, -np.inf).max(axis=1)
    leave = np.where(out, wide / safe, np.inf).min(axis=1)
    inside = (enter <= leave) & (into | out | (wide >= 0)).all(axis=1)
    height = np.where(into, room / safe, -np.inf)
    # a corner beside a face lies over the steep face next to it, which it does not meet along n
    top = height.argmax(axis=1)
    inside &= -c[np.arange(len(c)), top] >= least_cosine(-cos)[row]
    row, x, top = row[inside], x[inside], top[inside]
    normal = -sign * other.normal[row, top]
    cosine = np.einsum("ki,ki->k", normal, n[row])
    gap = height.max(axis=1)[inside]
    near = np.abs(gap) <= CLOSED / BESIDE * slack[row]
    level = near & (cosine >= np.cos(FACE_ANGLE))
    normal = np.where(level[:, None], normal, n[row])
    gap = gap * np.where(level, cosine, 1.0)
    return row, x + (sign * gap / 2)[:, None] * normal, gap, normal


def least_cosine(cosines: Array) -> Array:
    """Least cosine to a direction of the faces that look along it, from those of all faces (K, F).

    These are the face nearest to the direction and those that deviate from it by little more;
    other faces meet another piece from the side.
    """
    best = np.clip(cosines.max(axis=1, initial=-1.0), -1.0, 1.0)
    return np.asarray(np.cos(np.minimum(np.arccos(best) + BEYOND, np.pi / 2 - SLOPE)))


def _facing_edges(core: Cores, cos: Array, n: Array, sign: float, room: Array) -> Mask:
    """Edges of a surface that faces along sign n, not lower than `room` below its top, (K, E)."""
    rows = np.arange(len(n))[:, None]
    height = sign * (core.vertex @ n[..., None])[..., 0]
    high = np.maximum(height[rows, core.edge[..., 0]], height[rows, core.edge[..., 1]])
    upwards = sign * cos
    beside = np.maximum(
        upwards[rows, core.edge_face[..., 0]], upwards[rows, core.edge_face[..., 1]]
    )
    facing = np.logical_or(beside >= least_cosine(upwards)[:, None], core.edge_face[..., 0] < 0)
    near = np.logical_and(core.edges, high >= height.max(axis=1)[:, None] - room[:, None])
    return np.asarray(np.logical_and(facing, near))


def _crossings(
    a: Cores, b: Cores, cos: tuple[Array, Array], n: Array, room: Array, slack: Array
) -> tuple[Index, Array, Array, Array]:
    """Crossings of edges of both surfaces seen along n: row, middle of the gap, gap, normal.

    Nearly parallel faces have the normal of a face: corners that are off their plane by rounding
    turn a normal across two edges by far more than the face.
    """
    u, v = across(n)
    frame = np.stack([u, v, n], axis=1)
    rows: list[Index] = []
    starts_, steps = [], []
    for core, c, sign in ((a, cos[0], 1.0), (b, cos[1], -1.0)):
        row, k = np.nonzero(_facing_edges(core, c, n, sign, room))
        p, q = (core.vertex[row, core.edge[row, k, end]] for end in range(2))
        rows.append(row)
        starts_.append(np.einsum("kai,ki->ka", frame[row], p))
        steps.append(np.einsum("kai,ki->ka", frame[row], q - p))
    blocks = []
    for i, j in product_blocks(len(n), *rows):
        row = rows[0][i]
        hit, s, t = _crossing_shares(
            (starts_[1][j] - starts_[0][i])[:, :2], steps[0][i, :2], steps[1][j, :2], slack[row]
        )
        i, j, row = i[hit], j[hit], row[hit]
        on_a = starts_[0][i] + s[:, None] * steps[0][i]
        on_b = starts_[1][j] + t[:, None] * steps[1][j]
        middle = np.einsum("kai,ka->ki", frame[row], (on_a + on_b) / 2)
        blocks.append((row, middle, on_b[:, 2] - on_a[:, 2]))
    row, middle, gap = (np.concatenate([block[k] for block in blocks]) for k in range(3))
    normal = n.copy()
    for core, c, sign in ((a, cos[0], 1.0), (b, cos[1], -1.0)):
        nearest = (sign * c).argmax(axis=1)
        face = sign * core.normal[np.arange(len(n)), nearest]
        level = np.linalg.norm(face - n, axis=1) <= TILT
        normal[level] = face[level]
    return row, middle, gap, normal[row]


def _crossing_shares(w: Array, d: Array, e: Array, slack: Array) -> tuple[Index, Array, Array]:
    """Crossings of segments p + s d and p + w + t e in the plane: rows, s, t.

    Arguments: `w`, `d`, `e` (K, 2); `slack` (K,): distance beyond an end that still counts.
    """
    det = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
    length, width = np.hypot(d[:, 0], d[:, 1]), np.hypot(e[:, 0], e[:, 1])
    crossing = np.abs(det) > BESIDE * length * width
    safe = np.where(crossing, det, 1.0)
    s = (w[:, 0] * e[:, 1] - w[:, 1] * e[:, 0]) / safe
    t = (w[:, 0] * d[:, 1] - w[:, 1] * d[:, 0]) / safe
    for share, size in ((s, length), (t, width)):
        crossing &= (share * size >= -slack) & ((1 - share) * size >= -slack)
    rows = np.flatnonzero(crossing)
    return rows, np.clip(s[rows], 0, 1), np.clip(t[rows], 0, 1)


def _corners_on_edges(
    own: Cores, other: Cores, which: Mask, n: Array, slack: Array, sign: float
) -> tuple[Index, Array, Array]:
    """Corners over edges of the other core where a core has no faces: row, middle, gap."""
    rows, edges = np.nonzero(other.edges & which[:, None])
    corners = np.repeat(np.flatnonzero(which), own.vertex.shape[1])
    i, j = products(len(n), rows, corners)
    row, e, k = rows[i], edges[i], j % own.vertex.shape[1]
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
    """Extreme points of each pair in directions across n, of all and of closed points."""
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
    angle = np.arange(DIRECTIONS) * (2 * np.pi / DIRECTIONS) + 0.1
    ahead = flat @ np.stack([np.cos(angle), np.sin(angle)])
    # of points at the same place, the one with the least gap
    ahead -= STEP_BACK * gap[:, None]
    rank = np.concatenate([gap[:, None], -ahead, np.where(closed[:, None], -ahead, np.inf)], axis=1)
    best = np.minimum.reduceat(rank, first)
    count = np.diff(np.append(first, len(row)))
    # each corner of a contact counts: without it, a body would rock over it
    chosen = np.repeat(count <= FEW, count)
    for value, low in zip(rank.T, best.T, strict=True):
        hit = np.flatnonzero(value == low[of])
        chosen[hit[np.diff(of[hit], prepend=-1) > 0]] = True
    return order[chosen]


# points of compounds -------------------------------------------------------------------------


def on_surface(scene: Placed, points: PiecePoints) -> Mask:
    """Whether points lie on the surfaces of both parts, and not at a seam of their pieces.

    A point of an overlap may lie in another piece that the other part overlaps as deep, if the
    normal leads along the surface of that piece: the part is sunk into a corner between both.
    """
    hidden = np.zeros(len(points), dtype=bool)
    sunk = _sunk_into(scene, points)
    several = np.bincount(scene.pieces.part)[scene.pieces.part] > 1
    sides = (points.piece_a, -1.0), (points.piece_b, 1.0)
    for pieces, sign in sides:
        some = np.flatnonzero(several[pieces])
        piece, gap = pieces[some], points.gap[some]
        n = -sign * points.normal[some]
        on = points.point[some] - (gap / 2)[:, None] * n
        size = scene.pieces.size[piece]
        row, other = others_at(scene, piece, on, SUNK * size)
        # a corner of a face counts as covered if the face beside it is
        faced = _along_face(scene, piece, n)
        inwards = scene.middle[piece] - on
        inwards -= np.einsum("ki,ki->k", inwards, n)[:, None] * n
        ahead = on + (3 * SUNK * size)[:, None] * n
        ahead += (faced * INWARDS)[:, None] * inwards
        inside = depth_in(scene, other, on[row])
        deep = depth_in(scene, other, ahead[row]) > SUNK * size[row]
        deep |= inside > SUNK * size[row]
        corner = np.flatnonzero(deep & (gap[row] < 0))
        whose = scene.pieces.part[(points.piece_b if sign < 0 else points.piece_a)[some]]
        k, step = row[corner], (3 * SUNK * size)[:, None] * n
        before, after = (depth_in(scene, other[corner], x[k]) for x in (ahead - step, ahead))
        rises = after > before + SUNK * size[k]
        as_deep = inside[corner] <= sunk(other[corner], whose[k]) + SUNK * size[k]
        deep[corner] = rises | ~as_deep
        # at an edge, another piece that contains the point and is farther along n is nearer
        touching = inside >= -BESIDE * size[row]
        beside = np.flatnonzero(touching & ~deep & ~faced[row])
        height = support_height(scene, other[beside], n[row[beside]])
        level = np.einsum("ki,ki->k", on[row[beside]], n[row[beside]])
        deep[beside] |= height > level + SUNK * size[row[beside]]
        hidden[some[row[deep]]] = True
    return ~hidden


def _sunk_into(scene: Placed, points: PiecePoints) -> Callable[[Index, Index], Array]:
    """Function of pieces and parts (K,): how deep each part overlaps the piece [length unit]."""
    count, part = len(scene.pieces.whole), scene.pieces.part
    code = np.append(points.piece_a * count + part[points.piece_b],
                     points.piece_b * count + part[points.piece_a])  # fmt: skip
    known, of = np.unique(np.append(code, -1), return_inverse=True)
    depth = np.zeros(len(known))
    np.maximum.at(depth, of[:-1], np.tile(-points.gap, 2))

    def sunk(piece: Index, other: Index) -> Array:
        place = np.searchsorted(known, piece * count + other).clip(max=len(known) - 1)
        return np.where(known[place] == piece * count + other, depth[place], 0.0)

    return sunk


def _along_face(scene: Placed, piece: Index, n: Array) -> Mask:
    """Whether directions are normals of a face of their piece, shape (K,)."""
    row, face = ragged(scene.pieces.face_start, piece)
    result = np.zeros(len(piece), dtype=bool)
    result[row[np.einsum("ki,ki->k", scene.normal[face], n[row]) > 1 - BESIDE]] = True
    return result


def support_height(scene: Placed, piece: Index, n: Array) -> Array:
    """Greatest height of each piece along a direction [length unit], shape (K,)."""
    row, vertex = ragged(scene.pieces.vertex_start, piece)
    height = np.einsum("ki,ki->k", scene.vertex[vertex], n[row])
    result = np.full(len(piece), -np.inf)
    first = np.flatnonzero(np.diff(row, prepend=-1))
    result[row[first]] = np.maximum.reduceat(height, first) if len(first) else height
    return result + scene.pieces.radius[piece]


def others_at(scene: Placed, piece: Index, x: Array, slack: Array) -> tuple[Index, Index]:
    """Pieces of the same part whose boxes contain the points x, shape (K, 3): rows, pieces."""
    pieces = scene.pieces
    row, place = ragged(pieces.beside_start, piece)
    other = pieces.beside[place]
    for axis in range(3):
        at = x[row, axis]
        near = at >= scene.low[other, axis] - slack[row]
        near &= at <= scene.high[other, axis] + slack[row]
        row, other = row[near], other[near]
    return row, other


def depth_in(scene: Placed, piece: Index, x: Array) -> Array:
    """Depth of each point in a piece [length unit], shape (K,); negative outside."""
    pieces = scene.pieces
    owner, face = ragged(pieces.face_start, piece)
    room = scene.offset[face] - np.einsum("ki,ki->k", scene.normal[face], x[owner])
    depth = np.full(len(piece), np.inf)
    first = np.flatnonzero(np.diff(owner, prepend=-1))
    depth[owner[first]] = np.minimum.reduceat(room, first) if len(first) else room
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


def distinct_points(points: PiecePoints, pieces: ConvexPieces) -> PiecePoints:
    """Points without repetitions: the same parts, place and normal."""
    if not len(points):
        return points
    size = float(pieces.size.max())
    keys = np.column_stack(
        [
            points.part_a,
            points.part_b,
            np.round(points.point / (SAME_POINT * size)),
            np.round(points.normal * 1e6),
        ]
    )
    order = np.lexsort((points.gap, ~points.bears))
    _, inverse = distinct_rows(keys[order])
    first = np.full(int(inverse.max()) + 1, len(points))
    np.minimum.at(first, inverse, np.arange(len(points)))
    return points.take(np.sort(order[first]))
