"""Facets: flat faces of parts, each a group of coplanar triangles connected over edges.

Two triangles that share an edge belong to the same facet if the far corner of the smaller lies
within the facet tolerance of the larger triangle's plane and their normals agree. A facet that then
drifts from its own plane (the side of a finely divided cylinder) is divided again with a finer
tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import (
    TINY,
    Array,
    Index,
    Mask,
    angle_between,
    connected,
    counted,
    cross,
    ragged,
    squares,
    starts,
    unit_rows,
)
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_tolerances import (
    FACET_BEND,
    FACET_FLATNESS,
    FACET_REFLEX,
    ROUNDINGS,
    SAME_PLACE,
    THICKNESS,
)
from kilter.shape.closed import shared_edges
from kilter.shape.primitives import BOX_QUADS

Block = dict[str, NDArray[Any]]

CHUNK = 60_000
"""Triangles processed at once; larger chunks are limited by memory bandwidth."""
LONG_LOOP = 256
"""Number of corners above which a facet is stored as triangles."""
SLIVER = 1e-9
"""Area of a sliver, over the square of its reach [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Facets:
    """Flat facets of all parts (connected coplanar triangles), as arrays ordered by part."""

    part: Index
    start: Index
    """Part of each facet, shape (F,); the facets of part i are rows ``start[i]`` to ``start[i +
    1]``."""
    normal: Array
    """Unit normal, outwards, shape (F, 3)."""
    origin: Array
    """Centroid [length unit], shape (F, 3)."""
    area: Array
    """Area [length unit^2], shape (F,)."""
    reach: Array
    """Largest distance of a corner from the centroid [length unit], shape (F,)."""
    convex: Mask
    """True, shape (F,): `corners` is the boundary, anticlockwise; False: `corners` are the
    facet's triangles, three by three."""
    surface: Index
    """Row of the curved surface that the facet approximates, shape (F,); -1: a flat face."""
    piece: Index
    """Piece of its part to which the facet belongs, shape (F,)."""
    curved: Mask
    """True if the facet approximates a part of a curved surface, shape (F,)."""
    corner_start: Index
    corners: Index
    """Corners by row of the geometry's vertices, shape (F + 1,)."""
    convex_part: Mask
    """True for connected parts without a reflex edge, shape (N,)."""

    def __len__(self) -> int:
        return len(self.part)


def warps(geometry: Geometry, facets: Facets) -> Array:
    """Largest distance of a corner of each facet from its plane [length unit], shape (F,).

    It is 0 on curved surfaces, and for slivers, which have no plane.
    """
    owner = np.repeat(np.arange(len(facets)), np.diff(facets.corner_start))
    offset = geometry.vertices[facets.corners] - facets.origin[owner]
    warp = np.zeros(len(facets))
    np.maximum.at(warp, owner, np.abs(np.einsum("ij,ij->i", offset, facets.normal[owner])))
    return np.where(facets.curved | (facets.area <= SLIVER * facets.reach**2), 0.0, warp)


MOST_KEPT = 100_000
"""Largest number of triangles of a geometry whose facets are kept."""
_last: tuple[Geometry, Facets] | None = None


def find_facets(geometry: Geometry) -> Facets:
    """Find the flat facets of every part; those of boxes have closed forms.

    Those of the last geometry are kept.
    """
    global _last
    last = _last
    if last is None or last[0] is not geometry:
        last = geometry, _find_facets(geometry)
        _last = last if len(geometry.triangles) <= MOST_KEPT else None
    return last[1]


def _find_facets(geometry: Geometry) -> Facets:
    blocks: list[Block] = []
    boxes = np.flatnonzero(geometry.is_box)
    if len(boxes) == len(geometry.mass):
        return _facets_of_boxes(geometry)
    if len(boxes):
        quads = BOX_QUADS + geometry.vertex_start[boxes][:, None, None]
        blocks.append(_convex_block(np.repeat(boxes, 6), quads.reshape(-1, 4)))
    by_triangles = np.flatnonzero(~geometry.is_box)
    convex_part = geometry.is_box.copy()
    keys = _outline_keys(geometry, by_triangles)
    first = {key: part for part, key in reversed(keys.items()) if key not in _outlines}
    repeated = np.isin(by_triangles, [k for k in keys if first.get(keys[k]) != k])
    fresh = by_triangles[~repeated]
    chunk = np.cumsum(np.diff(geometry.triangle_start)[fresh]) // CHUNK
    for chunk_number in np.unique(chunk):
        of_chunk = fresh[chunk == chunk_number]
        blocks.extend(_facets_from_triangles(geometry, of_chunk, convex_part))
    if keys:
        _keep_outlines(geometry, blocks, convex_part, first)
        outlines = {part: _outlines[keys[part]] for part in by_triangles[repeated].tolist()}
        blocks += [outline.of_copy(geometry, part) for part, outline in outlines.items()]
        convex_part[list(outlines)] = [outline.convex_part for outline in outlines.values()]
    facets = _assemble_facets(geometry, blocks, convex_part)
    if len(boxes):
        rows = facets.start[boxes][:, None] + np.arange(6)
        planes = facets.normal, facets.origin, facets.area, facets.reach
        for values, of_boxes in zip(planes, _planes_of_boxes(geometry, boxes), strict=True):
            values[rows] = of_boxes
    return facets


@dataclass(frozen=True, slots=True, eq=False)
class _Outlines:
    """Facets of a shape, with the numbers of its own vertices and surfaces, for all its copies."""

    block: Block
    convex_part: bool
    shape: Any
    """The shape, kept so that its identity stays its own."""

    def of_copy(self, geometry: Geometry, part: int) -> Block:
        """The facets of a part with this shape."""
        surface = self.block["surface"]
        return {
            **self.block,
            "part": np.full(len(surface), part),
            "corners": self.block["corners"] + geometry.vertex_start[part],
            "surface": np.where(surface < 0, -1, surface + geometry.surfaces.start[part]),
        }


MANY = 100
"""Least number of triangles of a shape whose facets are kept for its copies."""
MOST_SHAPES = 500
"""Largest number of shapes whose facets are kept."""
_outlines: dict[tuple[int, int], _Outlines] = {}


def _outline_keys(geometry: Geometry, parts: Index) -> dict[int, tuple[int, int]]:
    """Keys of parts with many triangles, which are equal for copies with equal facets."""
    if not geometry.shapes:
        return {}
    if len(_outlines) > MOST_SHAPES:
        _outlines.clear()
    chosen = parts[np.diff(geometry.triangle_start)[parts] >= MANY].tolist()
    # the accuracy of coordinates far from the origin widens the tolerance of facets
    accuracy = np.frexp(geometry.accuracy)[1].tolist()
    keys = {part: (id(geometry.shapes[part]), accuracy[part]) for part in chosen}
    return keys if len(set(keys.values())) <= MOST_SHAPES else {}


def _keep_outlines(
    geometry: Geometry, blocks: list[Block], convex_part: Mask, first: dict[tuple[int, int], int]
) -> None:
    """Keep the facets of the first part of each key; `blocks`: facets of these and other parts."""
    names = ("part", "convex", "length", "corners", "surface", "piece")
    part, convex, length, corners, surface, piece = (
        np.concatenate([block[name] for block in blocks]) if blocks else np.empty(0, np.int64)
        for name in names
    )
    order = np.argsort(part, kind="stable")
    begin = np.searchsorted(part[order], np.arange(len(geometry.mass) + 1))
    start = starts(length)
    for key, number in first.items():
        rows = order[begin[number] : begin[number + 1]]
        own = surface[rows]
        _outlines[key] = _Outlines(
            {
                "convex": convex[rows],
                "length": length[rows],
                "corners": corners[ragged(start, rows)[1]] - geometry.vertex_start[number],
                "surface": np.where(own < 0, -1, own - geometry.surfaces.start[number]),
                "piece": piece[rows],
            },
            bool(convex_part[number]),
            geometry.shapes[number],
        )


def _facets_of_boxes(geometry: Geometry) -> Facets:
    """The facets of parts that are all boxes."""
    count = len(geometry.mass)
    part = np.repeat(np.arange(count), 6)
    normal, origin, area, reach = _planes_of_boxes(geometry, np.arange(count))
    return Facets(
        part=part,
        start=6 * np.arange(count + 1),
        normal=normal.reshape(-1, 3),
        origin=origin.reshape(-1, 3),
        area=area.reshape(-1),
        reach=reach.reshape(-1),
        convex=np.ones(len(part), dtype=bool),
        surface=np.full(len(part), -1),
        piece=np.zeros(len(part), dtype=np.int64),
        curved=np.zeros(len(part), dtype=bool),
        corner_start=4 * np.arange(len(part) + 1),
        corners=(BOX_QUADS + geometry.vertex_start[:-1, None, None]).reshape(-1),
        convex_part=np.ones(count, dtype=bool),
    )


def _planes_of_boxes(geometry: Geometry, boxes: Index) -> tuple[Array, Array, Array, Array]:
    """Unit normals, centroids, areas and reaches of the sides of boxes, in the order `BOX_QUADS`.

    Opposite sides have opposite normals, and the centroid is the middle of a diagonal. Shapes:
    (n, 6, 3), (n, 6, 3), (n, 6), (n, 6).
    """
    corners = geometry.vertices[geometry.vertex_start[boxes][:, None] + np.arange(8)]
    u, v, w = (corners[:, k] - corners[:, 0] for k in (1, 2, 4))
    pairs = (u, v), (w, u), (v, w)  # the edges of the sides -z and +z, then y, then x
    normal, area, reach = np.empty((len(boxes), 6, 3)), *np.empty((2, len(boxes), 6))
    for k, (a, b) in enumerate(pairs):
        turn = cross(a, b)
        size = np.maximum(np.sqrt(squares(turn)), TINY)
        normal[:, 2 * k + 1] = turn / size[:, None]
        normal[:, 2 * k] = -normal[:, 2 * k + 1]
        area[:, 2 * k] = area[:, 2 * k + 1] = size
        diagonal = np.maximum(squares(a + b), squares(a - b))
        reach[:, 2 * k] = reach[:, 2 * k + 1] = np.sqrt(diagonal) / 2
    origin = (corners[:, BOX_QUADS[:, 0]] + corners[:, BOX_QUADS[:, 2]]) / 2
    return normal, origin, area, reach


def _convex_block(part: Index, loops: Index, of: tuple[Index, Index] | None = None) -> Block:
    """A block of convex facets that have the same number of corners.

    `of` holds the curved surface and the piece of each facet, by default -1 and 0.
    """
    count, corners = loops.shape
    surface, piece = of or (np.full(count, -1), np.zeros(count, dtype=np.int64))
    return {
        "part": part,
        "convex": np.ones(count, dtype=bool),
        "length": np.full(count, corners),
        "corners": loops.reshape(-1),
        "surface": surface,
        "piece": piece,
    }


def _assemble_facets(geometry: Geometry, blocks: list[Block], convex_part: Mask) -> Facets:
    """Sort blocks of facets by part, and compute the plane and size of each facet."""
    part, convex, length, corners, surface, piece = (
        np.concatenate([block[key] for block in blocks])
        for key in ("part", "convex", "length", "corners", "surface", "piece")
    )
    order = np.argsort(part, kind="stable")
    corners = corners[ragged(starts(length), order)[1]]
    part, convex, length, surface = part[order], convex[order], length[order], surface[order]
    first = starts(length)
    owner, triangles = facet_triangles(first, convex, np.arange(len(part)))
    normal, origin, area = _planes(geometry.vertices[corners[triangles]], owner, len(part))
    offset = geometry.vertices[corners] - np.repeat(origin, length, axis=0)
    return Facets(
        part=part,
        start=np.searchsorted(part, np.arange(len(geometry.mass) + 1)),
        normal=normal,
        origin=origin,
        area=area,
        reach=np.sqrt(np.maximum.reduceat(np.einsum("ij,ij->i", offset, offset), first[:-1])),
        convex=convex,
        surface=surface,
        piece=piece[order],
        curved=surface >= 0,
        corner_start=first,
        corners=corners,
        convex_part=convex_part,
    )


def facet_triangles(corner_start: Index, convex: Mask, which: Index) -> tuple[Index, Index]:
    """Triangles of the facets `which`, and for each triangle the position of its facet.

    Returns `place`, shape (T,): position in `which` of the facet of each triangle; `corners`, shape
    (T, 3): positions in the list of corners of all facets.
    """
    length = np.diff(corner_start)[which]
    count = np.where(convex[which], length - 2, length // 3)
    place, k = counted(count)
    base, fan = corner_start[which][place], convex[which][place]
    corners = np.column_stack(
        [
            np.where(fan, base, base + 3 * k),
            np.where(fan, base + k + 1, base + 3 * k + 1),
            np.where(fan, base + k + 2, base + 3 * k + 2),
        ]
    )
    return place, corners


def _planes(points: Array, owner: Index, count: int) -> tuple[Array, Array, Array]:
    """Unit normal, centroid and area of each group of triangles."""
    first = np.searchsorted(owner, np.arange(count))
    base = points[first, 0]  # relative coordinates: no cancellation far from the origin
    p, q, r = (points[:, k] - base[owner] for k in range(3))
    twice = cross(q - p, r - p)
    total = np.add.reduceat(twice, first, axis=0)
    size = np.maximum(np.linalg.norm(total, axis=1), TINY)
    normal = total / size[:, None]
    weight = np.einsum("ij,ij->i", twice, normal[owner])
    moment = np.add.reduceat(weight[:, None] * (p + q + r), first, axis=0)
    return normal, base + moment / (3 * size)[:, None], size / 2


# triangles to facets ------------------------------------------------------------------


def _facets_from_triangles(geometry: Geometry, parts: Index, convex_part: Mask) -> list[Block]:
    """Find the facets of parts given by triangles; also set `convex_part` for convex parts."""
    owner, rows = ragged(geometry.triangle_start, parts)
    triangles, curved = geometry.triangles[rows], geometry.triangle_surface[rows]
    piece = geometry.triangle_piece[rows]
    part = parts[owner]
    points = geometry.vertices[triangles]
    area = cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    surface = np.bincount(part, np.linalg.norm(area, axis=1) / 2, minlength=len(geometry.mass))
    thickness = np.zeros(len(geometry.mass))
    thickness[parts] = 2 * geometry.volume[parts] / surface[parts]
    # flat up to the tolerance, not through thin parts, and not below the coordinates' rounding
    flat = np.minimum(FACET_FLATNESS * geometry.size, THICKNESS * thickness)
    tolerance = np.maximum(flat, np.minimum(ROUNDINGS * geometry.accuracy, thickness / 2))[part]
    rounding = (ROUNDINGS * geometry.accuracy + SAME_PLACE * geometry.size)[part]
    edges = shared_edges(triangles)
    first, second = edges[0] // 3, edges[1] // 3
    convex = _convex_parts(geometry.vertices, triangles, part, tolerance, rounding, first, second)
    convex_part[parts] = convex[parts]
    alike = (curved[first] == curved[second]) & (piece[first] == piece[second])
    group = _coplanar_groups(geometry.vertices, triangles, tolerance, first[alike], second[alike])
    inner = np.zeros(triangles.size, dtype=bool)
    within = group[first] == group[second]
    inner[edges[0][within]] = inner[edges[1][within]] = True
    owners = part, curved, piece
    return _boundaries(geometry.vertices, triangles, owners, group, tolerance, inner)


def _convex_parts(
    vertices: Array,
    triangles: Index,
    part: Index,
    tolerance: Array,
    rounding: Array,
    first: Index,
    second: Index,
) -> Mask:
    """Mask of the parts that are connected, closed and convex, shape (N,)."""
    points = vertices[triangles]
    area = cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normal = unit_rows(area)
    rise = np.einsum("nki,ni->nk", points[second] - points[first, 0][:, None, :], normal[first])
    rise_back = np.einsum(
        "nki,ni->nk", points[first] - points[second, 0][:, None, :], normal[second]
    )
    inwards = np.minimum(rise.max(axis=1), rise_back.max(axis=1))
    sine = np.linalg.norm(cross(normal[first], normal[second]), axis=1)
    # a warped face bends little; the sides of a fine hole bend more, but rise little
    reflex = (inwards > 2 * tolerance[first]) | ((inwards > rounding[first]) & (sine > FACET_BEND))
    count = int(part.max()) + 1
    has_reflex = np.bincount(part[first[reflex]], minlength=count) > 0
    # a closed surface has three shared edges for every two triangles
    open_somewhere = np.bincount(part[first], minlength=count) * 2 != 3 * np.bincount(
        part, minlength=count
    )
    label = connected(len(triangles), first, second)
    pieces = np.bincount(part[np.unique(label, return_index=True)[1]], minlength=count)
    convex: Mask = ~has_reflex & ~open_somewhere & (pieces == 1)
    return convex


def _coplanar_groups(
    vertices: Array, triangles: Index, tolerance: Array, first: Index, second: Index
) -> Index:
    """Facet number of each triangle; connected coplanar triangles have the same number.

    Groups that drift from their mean plane are divided again with a tolerance 30 times smaller, in
    at most 6 rounds; after that their triangles are facets of their own.
    """
    points = vertices[triangles]
    area = cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    twice = np.maximum(np.linalg.norm(area, axis=1), TINY)
    normal = area / twice[:, None]
    bend, drop = _bend_and_drop(points, normal, twice, first, second)
    group = np.arange(len(triangles))
    active = np.ones(len(triangles), dtype=bool)
    fineness = tolerance.copy()
    for _ in range(6):
        limit = np.minimum(fineness[first], fineness[second])
        # the angle alone fails on slivers, the distance alone on small triangles
        joined = (drop <= limit) & (
            bend <= FACET_BEND + 4 * limit / _least_height(points, twice, first, second)
        )
        joined &= active[first] & active[second]
        group = _renumber_active(
            group, active, connected(len(triangles), first[joined], second[joined])
        )
        drifting = _leaves_plane(points, group, tolerance) & active
        if not drifting.any():
            break
        active = drifting
        fineness[drifting] /= 30
    else:
        group = _renumber_active(group, active, np.arange(len(triangles)))
    return group


def _renumber_active(group: Index, active: Mask, fresh: Index) -> Index:
    """Group numbers with new numbers for the groups of active triangles."""
    group = np.where(active, fresh + len(group), group)
    _, compact = np.unique(group, return_inverse=True)
    result: Index = compact.reshape(-1)
    return result


def _bend_and_drop(
    points: Array, normal: Array, twice: Array, first: Index, second: Index
) -> tuple[Array, Array]:
    """Angle between neighbouring triangles [rad], and distance of the smaller from the plane.

    The plane is that of the larger triangle.
    """
    larger = np.where(twice[first] >= twice[second], first, second)
    smaller = np.where(twice[first] >= twice[second], second, first)
    away = points[smaller] - points[larger, 0][:, None, :]
    drop = np.abs(np.einsum("nki,ni->nk", away, normal[larger])).max(axis=1)
    return angle_between(normal[first], normal[second]), drop


def _least_height(points: Array, twice: Array, first: Index, second: Index) -> Array:
    """Least height of the narrower of each two neighbouring triangles [length unit]."""
    edges = np.linalg.norm(points - np.roll(points, -1, axis=1), axis=2).max(axis=1)
    height = twice / np.maximum(edges, TINY)
    lowest: Array = np.maximum(np.minimum(height[first], height[second]), TINY)
    return lowest


def _leaves_plane(points: Array, group: Index, tolerance: Array) -> Mask:
    """Mask of triangles whose group is not flat: twice the tolerance off its mean plane."""
    order = np.argsort(group, kind="stable")
    owner = group[order]
    normal, origin, _ = _planes(points[order], owner, int(owner[-1]) + 1)
    away = points[order] - origin[owner][:, None, :]
    distance = np.abs(np.einsum("nki,ni->nk", away, normal[owner])).max(axis=1)
    is_off = np.zeros(int(owner[-1]) + 1, dtype=bool)
    is_off[owner[distance > 2 * tolerance[order]]] = True
    several = np.bincount(owner) > 1
    drifting: Mask = (is_off & several)[group]
    return drifting


def _boundaries(
    vertices: Array,
    triangles: Index,
    owners: tuple[Index, Index, Index],
    group: Index,
    tolerance: Array,
    inner: Mask,
) -> list[Block]:
    """Build facets from groups of triangles: boundary loops if convex, else triangles.

    `owners` holds part, curved surface and piece of each triangle; `inner` marks half-edges inside
    a facet.
    """
    order = np.argsort(group, kind="stable")
    triangles, group = triangles[order], group[order]
    (part, surface, piece), tolerance = (owner[order] for owner in owners), tolerance[order]
    inner = inner.reshape(-1, 3)[order].ravel()
    count = int(group[-1]) + 1
    first = np.searchsorted(group, np.arange(count))
    loops, length, whole = _loops(triangles, group, count, inner)
    normal, _, _ = _planes(vertices[triangles], group, count)
    convex = whole.copy()
    for low, high in ((2, 4), (4, 12), (12, 48), (48, 1 << 62)):  # similar lengths: little padding
        k = np.flatnonzero(whole & (length > low) & (length <= high))
        width = int(length[k].max(initial=3))
        convex[k] = _is_convex_loop(
            vertices, loops[k, :width], length[k], normal[k], tolerance[first[k]]
        )
    blocks: list[Block] = []
    for size in np.unique(length[convex]):
        chosen = np.flatnonzero(convex & (length == size))
        of = first[chosen]
        blocks.append(_convex_block(part[of], loops[chosen, :size], (surface[of], piece[of])))
    rest = np.flatnonzero(~convex)
    if len(rest):
        number = np.diff(np.append(first, len(group)))
        rows = ragged(np.append(first, len(group)), rest)[1]
        blocks.append(
            {
                "part": part[first[rest]],
                "convex": np.zeros(len(rest), dtype=bool),
                "length": 3 * number[rest],
                "corners": triangles[rows].reshape(-1),
                "surface": surface[first[rest]],
                "piece": piece[first[rest]],
            }
        )
    return blocks


def _loops(triangles: Index, group: Index, count: int, inner: Mask) -> tuple[Index, Index, Mask]:
    """Boundary corners of each group, their number, and a mask of groups with a single loop."""
    start = triangles.ravel()[~inner]
    end = triangles[:, [1, 2, 0]].ravel()[~inner]
    owner = np.repeat(group, 3)[~inner]
    stride = int(triangles.max()) + 1
    order = np.lexsort((start, owner))
    start, end, owner = start[order], end[order], owner[order]
    length = np.bincount(owner, minlength=count)
    key, next_key = owner * stride + start, owner * stride + end
    is_simple = np.ones(count, dtype=bool)
    is_simple[owner[1:][np.diff(key) == 0]] = (
        False  # two edges leave a vertex: the boundary touches itself
    )
    following = np.minimum(np.searchsorted(key, next_key), len(key) - 1)
    is_simple[owner[key[following] != next_key]] = False
    is_simple &= length <= LONG_LOOP
    is_simple &= length >= 3
    width = int(length[is_simple].max(initial=3))
    first = np.cumsum(length) - length
    loops = np.zeros((count, width), dtype=np.int64)
    current = first.copy()
    returned = np.zeros(count, dtype=bool)
    for k in range(width):
        active = is_simple & (k < length)
        rows = np.flatnonzero(active)
        loops[rows, k] = start[current[rows]]
        current[rows] = following[current[rows]]
        returned[rows] |= (current[rows] == first[rows]) & (k + 1 < length[rows])
    return loops, length, is_simple & ~returned


def _is_convex_loop(
    vertices: Array, loops: Index, length: Index, normal: Array, tolerance: Array
) -> Mask:
    """Mask of boundary loops that are convex within the tolerance."""
    k = np.arange(loops.shape[1])
    length = np.minimum(length, len(k))  # longer boundaries are not loops: their result is unused
    inside = k < length[:, None]
    following = np.where(k + 1 < length[:, None], k + 1, 0)
    rows = np.arange(len(loops))[:, None]
    corner, next_corner = vertices[loops], vertices[loops[rows, following]]
    second_next = vertices[loops[rows, following[rows, following]]]
    turn = np.einsum("nki,ni->nk", cross(next_corner - corner, second_next - next_corner), normal)
    chord = np.linalg.norm(second_next - corner, axis=2)
    # the cross product is the depth of the corner below the chord, times the chord
    reflex = inside & (turn < -FACET_REFLEX * tolerance[:, None] * np.maximum(chord, TINY))
    result: Mask = ~reflex.any(axis=1)
    return result
