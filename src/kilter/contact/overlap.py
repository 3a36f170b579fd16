"""Overlaps: parts that share volume, with depth, volume, and share of the smaller part.

Two convex parts share no volume if the plane of a facet of one has the other in front of it (within
tolerance). If no facet's plane separates them, the largest ball inside both decides; it also
recognises parts that only an edge against an edge separates.

The surface of the intersection of A and B consists of the part of the surface of A inside B and the
part of the surface of B inside A. The depth of the overlap follows from it:

    depth = max over points x of either piece of |x - surface of the other part|,

computed at the corners and at the middles of sides and triangles. The distance from the nearest
corner of the other surface is an upper bound. So the points with the largest bounds are computed
first, and the rest only until the bound falls below the largest distance.

Curved faces count as their inscribed polyhedra, refined as requested.

The library manifold3d intersects the triangles of other parts. Triangles that bound no body (an
edge with one face, or with four) have no volume. Then rays show which corners of such a part lie
inside a closed part, and winding numbers show which corners of the other part lie inside it.

References
----------
A. van Oosterom, J. Strackee, The solid angle of a plane triangle, 1983, equation 8.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import (
    TINY,
    Array,
    Index,
    Mask,
    across,
    cross,
    distinct_rows,
    extents,
    lengths,
    nearest,
    ragged,
    unit_rows,
)
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import FREE
from kilter.contact.common.broad import boxes_in
from kilter.contact.common.contact_search import coincide, deep_boxes
from kilter.contact.common.distances import (
    PartSolids,
    TriangleTrees,
    at_most,
)
from kilter.contact.common.findings import FacePatches, in_patch, is_settled
from kilter.contact.common.gaps import Tolerance
from kilter.contact.common.patches import INTERFERE, SAME_BODY, Overlap
from kilter.contact.curved.coaxial_faces import coaxial_fits
from kilter.solvers.problem import LinearProgram
from kilter.work import stop_if_late

PROBES = 300
"""Largest number of points of a part that are tested."""
RAY = unit_rows(np.sqrt([[2.0, 3.0, 5.0]]))[0]
"""Direction of rays; hardly a face of a drawn part is parallel to it."""
EDGE_ON = 1e-9
"""Share of the largest volume of a tetrahedron with its sides up to which rounding may decide on
which side of a triangle its corner lies [-]."""
BATCH = 100_000
"""Largest number of pairs (point, triangle) computed at once; more leave the processor's cache."""


def depth_by_winding(
    solids: PartSolids,
    parts: tuple[int, int],
    tolerance: float,
    without: Callable[[Array], Mask],
) -> float:
    """Depth to which two parts overlap, at corners and edge middles [length unit]; 0: none."""
    a, b = parts
    return max(_depth_inside(solids, *pair, tolerance, without) for pair in ((a, b), (b, a)))


def _depth_inside(
    solids: PartSolids,
    a: int,
    b: int,
    tolerance: float,
    without: Callable[[Array], Mask],
) -> float:
    """Largest depth of points of part a inside part b, if above the tolerance [length unit]."""
    geometry, solid = solids.geometry, solids.of(b)
    corners, surface = geometry.corners_of(a), solids.surface_of(b)
    sides = (corners + np.roll(corners, -1, axis=1)).reshape(-1, 3) / 2
    probes = np.concatenate([corners.reshape(-1, 3), corners.mean(axis=1), sides])
    vertices = _corners(geometry, b)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    probes = probes[((probes > low + tolerance) & (probes < high - tolerance)).all(axis=1)]
    probes = _some_without(distinct_rows(probes)[0], without)
    if not len(probes):
        return 0.0
    bound = surface.at_most(probes)
    probes, bound = probes[bound > tolerance], bound[bound > tolerance]
    if solid is None:
        inside = inside_part(geometry, b, probes)
    else:
        inside, doubtful = _inside_solid(solid, probes - geometry.center[b])
        inside[doubtful] = inside_part(geometry, b, probes[doubtful])
    return float(surface.distance(probes[inside], bound[inside]).max(initial=0.0))


def inside_part(geometry: Geometry, part: int, points: Array) -> Mask:
    """Mask of points inside the surface of a part, shape (n,)."""
    return _winding_numbers(points, geometry.corners_of(part)) > 0.5


def _inside_solid(solid: Any, points: Array) -> tuple[Mask, Mask]:
    """Masks of points inside a solid, and of points about which rounding may decide.

    A ray from a point inside leaves the solid more often than it enters it. Triangles that share an
    edge agree in which of them a ray crosses, so that none is counted twice or missed.
    """
    mesh = solid.to_mesh64()
    to_ray = np.stack([*across(RAY), RAY])
    vertices, start = (
        sum(x[:, k, None] * to_ray[:, k] for k in range(3))  # not a product: equal rows stay equal
        for x in (np.asarray(mesh.vert_properties), points)
    )
    corners = vertices[np.asarray(mesh.tri_verts)]
    ray = start, np.where([False, False, True], np.inf, start)
    of_all = np.array([0, len(corners)]), np.zeros(len(points), dtype=np.int64)
    point, row = boxes_in(*of_all, ray, extents(corners))
    corner = corners[row] - start[point, None]
    (u, v), (u_next, v_next) = (
        (x[..., 0], x[..., 1]) for x in (corner, np.roll(corner, -1, axis=1))
    )
    side = u * v_next - u_next * v
    upward = (v <= 0) & (v_next > 0) & (side > 0)
    downward = (v > 0) & (v_next <= 0) & (side < 0)
    turns = upward.sum(axis=1) - downward.sum(axis=1)
    a, b, c = corner.transpose(1, 0, 2)
    volume = np.einsum("ij,ij->i", a, cross(b, c))
    count = np.bincount(point, weights=turns * (turns * volume > 0), minlength=len(points))
    flat = np.abs(volume) <= EDGE_ON * lengths(a) * lengths(b) * lengths(c)
    return count > 0.5, np.isin(np.arange(len(points)), point[flat & (turns != 0)])


def _some_without(probes: Array, without: Callable[[Array], Mask]) -> Array:
    """About `PROBES` points, evenly spread over the given ones, for which `without` is False."""
    step = len(probes) // PROBES + 1
    chosen = probes[:0]
    for k in range(step):  # one round is enough unless `without` removes many points
        batch = probes[k::step]
        chosen = np.concatenate([chosen, batch[~without(batch)]])
        if len(chosen) >= PROBES // 2:
            break
    return chosen


def _winding_numbers(points: Array, triangles: Array) -> Array:
    """Winding number of a closed surface about each point: 1 inside, 0 outside, shape (n,)."""
    middle = triangles.mean(axis=(0, 1))
    # products of two or three of a - x, b - x, c - x are linear in x, except for |x|^2: expanded,
    # they need no array of points times triangles times coordinates
    corners = (triangles - middle).transpose(1, 0, 2)
    a, b, c = corners
    bc = cross(b, c)
    volume, area = np.einsum("ti,ti->t", a, bc), (bc + cross(c, a) + cross(a, b)).T
    squares_of = [(corner**2).sum(axis=1) for corner in corners]
    pairs = [(np.einsum("ti,ti->t", p, q), (p + q).T) for p, q in ((a, b), (b, c), (c, a))]
    winding = []
    for x in np.array_split(points - middle, 1 + len(points) * len(triangles) // BATCH):
        square = (x**2).sum(axis=1)[:, None]
        la, lb, lc = (
            np.sqrt(np.maximum(square + own - 2 * (x @ corner.T), 0.0))
            for own, corner in zip(squares_of, corners, strict=True)
        )
        bottom = la * lb * lc
        for (product, total), length in zip(pairs, (lc, la, lb), strict=True):
            bottom += (product - x @ total + square) * length
        angles = np.arctan2(volume - x @ area, bottom)
        winding.append(angles.sum(axis=1) / (2 * np.pi))
    return np.concatenate(winding)


CELLS = 200
"""Number of cells of the grid; the distance of a point in each is computed in each round."""
HALVINGS = 8
"""Largest number of grids that are tried, each with cells of half the size."""


@dataclass(frozen=True, slots=True, eq=False)
class SharedBody:
    """The intersection of two overlapping parts, as a mesh in the world frame."""

    volume: float
    """Volume [length unit^3]."""
    corners: Array
    """Triangles of its surface, shape (T, 3, 3)."""
    of_first: Mask
    """True if a triangle lies on the surface of the first part, else on that of the second,
    shape (T,)."""


def shared_body(solids: PartSolids, a: int, b: int) -> SharedBody | None:
    """The intersection of parts a and b, empty if they are apart; None if a part is not closed.

    Returns None if the triangles of a part bound no body: an edge with one face, or with four.
    """
    solid_a, solid_b = solids.of(a), solids.of(b)
    if solid_a is None or solid_b is None:
        return None
    # the larger solid stays in its frame: a shifted copy of it is sorted anew
    center, fixed = solids.geometry.center, a if solid_a.num_tri() >= solid_b.num_tri() else b
    solid_a, solid_b = (
        solid if part == fixed else solid.translate(tuple((center[part] - center[fixed]).tolist()))
        for part, solid in ((a, solid_a), (b, solid_b))
    )
    common = solid_a ^ solid_b
    mesh = common.to_mesh64()
    length = np.diff(np.asarray(mesh.run_index, dtype=np.int64)) // 3
    first = np.repeat(np.array(mesh.run_original_id) == a + 1, length.astype(np.int64))
    corners = np.asarray(mesh.vert_properties)[:, :3][np.asarray(mesh.tri_verts)] + center[fixed]
    return SharedBody(float(common.volume()), corners, first)


def depth_of(
    solids: PartSolids,
    parts: tuple[int, int],
    body: SharedBody,
    *,
    least: float,
    without: Callable[[Array], Mask],
) -> float:
    """Depth to which two parts overlap, at least `least` [length unit].

    Returns `least` if the overlap is not deeper.
    """
    deepest = least
    for part, on_other in ((parts[1], body.of_first), (parts[0], ~body.of_first)):
        points = _probes(body.corners[on_other])
        points = points[~without(points)]
        surface = solids.geometry.corners_of(part)
        deepest = _farthest(points, body.corners[~on_other], surface, deepest)
    return deepest


def _probes(corners: Array) -> Array:
    """Corners, edge middles and centres of triangles, each point once."""
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    points = np.concatenate([corners.reshape(-1, 3), middles.reshape(-1, 3), corners.mean(axis=1)])
    return distinct_rows(points)[0]


def _farthest(points: Array, patch: Array, surface: Array, least: float) -> float:
    """Largest distance of points from a surface; `least` if all points are nearer than that.

    `patch` is a part of the surface, which bounds the distances from above. A distance exceeds that
    of another point by at most the distance of the two points. So each round computes the distances
    of some points in cells of a grid, which bound those of all points around them.
    """
    if not len(points):
        return least
    bound = at_most(points, patch if len(patch) else surface)
    left = np.flatnonzero(bound > least)
    if not len(left):
        return least
    # the nearest point of the surface is no farther than the bound
    points, bound = points[left], bound[left]
    low, high = points.min(axis=0) - bound.max(), points.max(axis=0) + bound.max()
    least_of, greatest_of = extents(surface)
    near = (least_of <= high).all(axis=1) & (greatest_of >= low).all(axis=1)
    trees = TriangleTrees(surface[near])
    while len(points):
        chosen = _highest_of_cells(points, bound, CELLS)
        distance = trees.distance(points[chosen], bound[chosen], enough=least)
        least = max(least, float(distance.max()))
        rest = np.delete(np.arange(len(points)), chosen)
        points, bound, known = points[rest], bound[rest], points[chosen]
        apart, number = nearest(known, points, 1)
        bound = np.minimum(bound, distance[number.ravel()] + apart.ravel())
        left = np.flatnonzero(bound > least)
        points, bound = points[left], bound[left]
    return least


def _highest_of_cells(points: Array, bound: Array, count: int) -> Index:
    """The point with the largest bound in each cell of a grid of about `count` cells that are used.

    All points are chosen if there are at most `count`.
    """
    if len(points) <= count:
        return np.arange(len(points))
    low, size = points.min(axis=0), np.ptp(points, axis=0)
    cell = max(float(size.max()) / np.sqrt(count), TINY)  # the points lie on a surface
    order = np.argsort(-bound, kind="stable")
    for _ in range(HALVINGS):
        number = np.floor((points - low) / cell).astype(np.int64)
        along = int(number.max()) + 1
        _, first = np.unique(number[order] @ [along * along, along, 1], return_index=True)
        if len(first) > count / 4:
            break
        cell /= 2  # the points fill few cells, as on the circles where a rod enters a plate
    chosen: Index = order[first]
    return chosen


def find_overlaps(
    assembly: Assembly, faces: FacePatches, tolerances: Tolerance
) -> tuple[Overlap, ...]:
    """Find the pairs of parts that occupy the same space, with the shared volume."""
    search = faces.search
    geometry, facets, boxes = search.geometry, search.facets, search.boxes
    a, b = search.pairs.T
    both_convex = facets.convex_part[a] & facets.convex_part[b]
    # triangulations of touching curved faces penetrate each other by their sagittas
    tolerance = search.limits.gap + geometry.slack[a] + geometry.slack[b]
    deep = deep_boxes(geometry, boxes, search.pairs, search.limits)
    # convex parts with a patch lie on either side of its plane
    rows = np.flatnonzero(deep & ~(is_settled(faces)))
    overlaps = list({overlap.ends: overlap for overlap in faces.curved.overlaps}.values())
    overlaps += [_same_body(geometry, (i, j)) for i, j in search.same_bodies.tolist()]
    recorded = {overlap.ends for overlap in overlaps}
    if not overlaps and not len(rows):
        return ()
    bodies: dict[tuple[int, int], SharedBody] = {}
    for row in rows.tolist():
        parts = (int(a[row]), int(b[row]))
        if parts in recorded:
            continue
        stop_if_late()
        if both_convex[row]:
            overlap = _convex_overlap(faces, parts, float(tolerance[row]))
        else:
            overlap = _general_overlap(faces, row, parts, float(tolerance[row]), bodies)
        if overlap is not None:
            overlaps.append(overlap)
    overlaps = _with_interference(assembly, overlaps, tolerances)
    round_boxes = _surface_boxes(geometry, {part for overlap in overlaps for part in overlap.ends})
    return tuple(_with_volume(faces, each, tolerances, round_boxes, bodies) for each in overlaps)


FINER = range(1, 6)
"""Rounds of refinement of triangles for the volume of an overlap; each halves the sides."""
BEHIND = 0.01
"""Volume between triangles and their surfaces, as a share of the overlap, up to which it is added
[-]. The error of the sum is about half the square of this share."""
MOST_FINER = 100_000
"""Largest number of triangles of two parts that are refined; each round makes up to four of one."""


def _with_interference(
    assembly: Assembly, overlaps: list[Overlap], tolerance: Tolerance
) -> list[Overlap]:
    """Mark overlaps of shafts that are thicker than their holes, with the reason INTERFERE."""
    fits = coaxial_fits(assembly, [overlap.ends for overlap in overlaps], tolerance)
    tight = {frozenset(fit.ends) for fit in fits if fit.tight}
    return [
        replace(overlap, why=INTERFERE) if frozenset(overlap.ends) in tight else overlap
        for overlap in overlaps
    ]


def _with_volume(
    faces: FacePatches, overlap: Overlap, tolerance: Tolerance, boxes: _Boxes,
    bodies: dict[tuple[int, int], SharedBody],
) -> Overlap:  # fmt: skip
    """The overlap with its shared volume, also as a fraction of the smaller part's volume.

    The share is None if the smaller part is thinner than the gap tolerance. `bodies`: the known
    shared bodies of pairs.
    """
    volume, geometry, both = overlap.volume, faces.search.geometry, list(overlap.ends)
    exact = overlap.why == SAME_BODY or not (geometry.slack[both] > 0).any()
    if volume is None or not exact:
        body = bodies.get(overlap.ends) or shared_body(faces.search.solids, *overlap.ends)
        volume = _exact_volume(geometry, overlap.ends, body, boxes) if body is not None else volume
    smaller = int(both[int(np.argmin(geometry.volume[both]))])
    thinnest = float(tolerance.gap_of(geometry.size[[smaller]])[0])
    share = None
    if volume is not None and _thickness(geometry, smaller) > thinnest:
        share = volume / float(geometry.volume[smaller])
    return replace(overlap, volume=volume, share=share)


def _thickness(geometry: Geometry, part: int) -> float:
    """Mean thickness of a part, twice its volume over its surface [length unit]."""
    rows = slice(*geometry.triangle_start[part : part + 2].tolist())
    a, b, c = geometry.vertices[geometry.triangles[rows]].transpose(1, 0, 2)
    surface = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
    return float(2 * geometry.volume[part] / surface) if surface > 0 else 0.0


def _exact_volume(
    geometry: Geometry, parts: tuple[int, int], body: SharedBody, boxes: _Boxes
) -> float:
    """Volume that two parts share, within exact curved surfaces [length unit^3].

    The volume between the triangles and their surfaces is added. If it is not small, the triangles
    are refined, which leaves a quarter of it.
    """
    slack = float(geometry.slack[list(parts)].sum())
    if not slack or not len(body.corners):
        return body.volume
    corners = body.corners.reshape(-1, 3)
    box = corners.min(axis=0) - slack, corners.max(axis=0) + slack
    for rounds in FINER:
        sides = zip(parts, (body.of_first, ~body.of_first), strict=True)
        behind = np.concatenate(
            [_behind_surfaces(geometry, p, body.corners[x], boxes) for p, x in sides]
        )
        volume = body.volume + float(behind.sum())
        if np.abs(behind).sum() <= BEHIND * body.volume:
            break
        solids = PartSolids(geometry, (rounds, box))
        finer = shared_body(solids, *parts)
        if finer is None or sum(solids.of(part).num_tri() for part in parts) > MOST_FINER:
            break
        body = finer
    return volume


_Boxes = tuple[Array, Array]
"""Lower and upper corners of the boxes of all surfaces, each of shape (S, 3) [length unit]."""


def _surface_boxes(geometry: Geometry, parts: Iterable[int]) -> _Boxes:
    """Boxes of the exact curved surfaces of the given parts, grown by the errors of triangles.

    Those of all other surfaces are empty: their lower corners are infinite.
    """
    s = geometry.surfaces
    low, high = np.full((len(s), 3), np.inf), np.full((len(s), 3), -np.inf)
    rows = np.flatnonzero(np.isin(s.part, list(parts)) & (s.kind != FREE) & (s.doubt <= 0))
    owner, place = ragged(s.triangle_start, rows)
    if len(owner):
        corners = geometry.vertices[geometry.triangles[s.triangle[place]]]
        first = np.flatnonzero(np.diff(owner, prepend=-1))
        grow = (s.sagitta + geometry.accuracy[s.part])[rows, None]
        least, greatest = extents(corners)
        low[rows] = np.minimum.reduceat(least, first) - grow
        high[rows] = np.maximum.reduceat(greatest, first) + grow
    return low, high


def _behind_surfaces(geometry: Geometry, part: int, corners: Array, boxes: _Boxes) -> Array:
    """Volumes between triangles of a part, shape (n, 3, 3), and its true surface, shape (n,).

    They are positive where the surface bulges out. The distance from a surface is a quadratic
    function on a small triangle, whose integral follows from the middles of the sides.
    """
    s, off = geometry.surfaces, np.zeros((len(corners), 3))
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    across = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    low, high = extents(corners)
    least, most = (side[s.start[part] : s.start[part + 1]] for side in boxes)
    meets = least <= high.max(axis=0, initial=-np.inf)
    meets &= most >= low.min(axis=0, initial=np.inf)
    for k in np.flatnonzero(meets.all(axis=1)).tolist():
        row = int(s.start[part]) + k
        near = (low <= most[k]) & (high >= least[k])
        chosen = np.flatnonzero(near.all(axis=1))
        points = np.concatenate([corners[chosen], middles[chosen]], axis=1).reshape(-1, 3)
        distance, outward = s.distance_and_outward(np.full(len(points), row), points)
        distance, outward = distance.reshape(-1, 6), outward.reshape(-1, 6, 3)[:, 0]
        lies = (np.abs(distance) <= s.sagitta[row] + geometry.accuracy[part]).all(axis=1)
        lies &= np.einsum("ij,ij->i", outward, across[chosen]) > 0
        off[chosen[lies]] = distance[lies, 3:]
    behind: Array = -off.mean(axis=1) * lengths(across) / 2
    return behind


def _general_overlap(
    faces: FacePatches, row: int, parts: tuple[int, int], tolerance: float,
    bodies: dict[tuple[int, int], SharedBody],
) -> Overlap | None:  # fmt: skip
    """Overlap of two parts of any shape; None if its depth is within the tolerance.

    Points on curved faces that touch over an area are ignored: only triangulations overlap there.
    The shared body of an overlap is added to `bodies`.
    """
    geometry, (a, b) = faces.search.geometry, parts
    if coincide(geometry, a, b):
        return _same_body(geometry, parts)

    def on_patch(points: Array) -> Mask:
        return in_patch(faces, row, points, 2 * tolerance)

    body = shared_body(faces.search.solids, a, b)
    if body is None:
        volume, depth = None, depth_by_winding(faces.search.solids, parts, tolerance, on_patch)
    else:
        depth = depth_of(faces.search.solids, parts, body, least=tolerance, without=on_patch)
        volume = body.volume
    if depth <= tolerance:
        return None
    if body is not None:
        bodies[parts] = body
    return Overlap(parts, volume, depth, "overlap")


def _same_body(geometry: Geometry, parts: tuple[int, int]) -> Overlap:
    """The overlap of two identical bodies in the same place."""
    size = float(geometry.size[list(parts)].min())
    return Overlap(parts, float(geometry.volume[parts[0]]), size, SAME_BODY)


def _corners(geometry: Geometry, part: int) -> Array:
    return geometry.vertices[geometry.vertex_start[part] : geometry.vertex_start[part + 1]]


def _convex_overlap(faces: FacePatches, parts: tuple[int, int], tolerance: float) -> Overlap | None:
    """Overlap of two convex parts; None if they are apart or only touch."""
    geometry, facets, (a, b) = faces.search.geometry, faces.search.facets, parts
    if coincide(geometry, a, b):
        return _same_body(geometry, parts)
    middle = geometry.center[a]
    # separation by the planes of the facets, relative to the centre of a to keep digits
    normals, offsets, separation = [], [], -np.inf
    for part, other in ((a, b), (b, a)):
        span = slice(facets.start[part], facets.start[part + 1])
        n, origin = facets.normal[span], facets.origin[span]
        offset = np.einsum("ij,ij->i", n, origin - middle)
        nearest = (n @ (_corners(geometry, other) - middle).T).min(axis=1) - offset
        separation = max(separation, float(nearest.max()))
        normals.append(n)
        offsets.append(offset)
    if separation >= -tolerance:
        return None
    overlap, away = _ball_overlap(
        np.concatenate(normals), np.concatenate(offsets), parts, -separation, tolerance
    )
    if overlap is None or away is None:
        return overlap
    # between edges or corners no facet separates the parts, but this direction does
    outwards = away[: len(normals[0])] @ normals[0]
    length = float(np.linalg.norm(outwards))
    if length <= TINY:
        return overlap
    heights = [(_corners(geometry, part) - middle) @ (outwards / length) for part in parts]
    return replace(overlap, depth=min(overlap.depth, float(heights[0].max() - heights[1].min())))


def _ball_overlap(
    normals: Array, offsets: Array, parts: tuple[int, int], depth: float, tolerance: float
) -> tuple[Overlap | None, Array | None]:
    """Overlap of two convex parts from the largest ball inside both; None if that is small.

    `depth` is the least depth to any facet's plane [length unit]. The ball is the solution of a
    linear program; for parts that are apart its radius is negative, so that no tolerance of the
    solver makes them overlap. Also the pressures of the facets on the ball, which are in balance,
    shape (m,); None if they are unknown.
    """
    from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

    from kilter.solvers.highs import solve_linear

    scale = max(float(np.abs(offsets).max()), TINY)
    no_limit = np.full(4, np.inf)
    ball = solve_linear(
        LinearProgram(
            np.array([0.0, 0.0, 0.0, -1.0]),
            csc_array(np.column_stack([normals, np.ones(len(normals))])),
            np.full(len(normals), -np.inf),
            offsets / scale,
            -no_limit,
            no_limit,
        )
    )
    if ball.optimal and ball.x[3] * scale <= tolerance / 2:
        return None, None
    if not ball.optimal:  # undecided: report an overlap, so that none is missed
        return Overlap(parts, None, depth, "overlap"), None
    try:
        halfspaces = np.column_stack([normals, -offsets / scale])
        corners = HalfspaceIntersection(halfspaces, ball.x[:3]).intersections
        volume = float(ConvexHull(corners).volume) * scale**3
    except QhullError:  # too flat for a volume
        volume = None
    return Overlap(parts, volume, depth, "overlap"), np.abs(ball.multipliers)
