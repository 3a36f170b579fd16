"""Brute-force oracle for planar contacts: every triangle of a part against every other part.

Shares nothing with `kilter.contact`: faces are found greedily by their plane, triangles are clipped
pair by pair (Sutherland-Hodgman in float64), gaps are measured at the corners of each clipped
piece. Regions that rounding could decide are kept apart: a correct search must find `Region.sure`,
and may find `Region.maybe`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.common.gaps import Tolerance
from kilter.contact.contact_set import ContactSet

Array = NDArray[np.float64]
Index = NDArray[np.int64]

THICK = 4.0
"""A piece thicker than this many gap tolerances must be found."""
THIN = 0.25
"""A region thinner than this many gap tolerances must not be found."""
AREA = 1e-11
"""Relative error of areas in addition to the rounding of coordinates."""


@dataclass(frozen=True)
class Region:
    """Contact of two parts in a plane; `sure` and `maybe` are corners of its pieces."""

    parts: tuple[int, int]
    normal: Array
    area: float
    slack: float
    sure: Array
    maybe: Array
    gap: tuple[float, float]
    gap_error: float
    area_error: float
    noise: float
    accuracy: float
    tolerance: float

    @property
    def borderline(self) -> bool:
        """True if finding no contact is also correct."""
        return not len(self.sure)

    @property
    def points(self) -> Array:
        """All corners that a correct search may find, shape (n, 3)."""
        return np.vstack([self.sure, self.maybe])


@dataclass(frozen=True)
class Surface:
    """Triangles of a part, with the plane of the face of each."""

    corners: Array
    normal: Array
    face: Index
    face_normal: Array
    flatness: Array
    low: Array
    high: Array


@dataclass(frozen=True)
class Pieces:
    """Overlaps of triangle pairs: polygons padded to equal length with their last corner."""

    points: Array
    area: Array
    perimeter: Array
    gap: Array
    face: Index

    @property
    def thickness(self) -> Array:
        """Area divided by half the perimeter."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(self.perimeter > 0, 2 * self.area / self.perimeter, 0.0)

    def __getitem__(self, rows: NDArray[np.bool_]) -> Pieces:
        return Pieces(
            self.points[rows],
            self.area[rows],
            self.perimeter[rows],
            self.gap[rows],
            self.face[rows],
        )


def oracle(assembly: Assembly, tolerance: Tolerance | None = None) -> list[Region]:
    """Every region of contact of an assembly, a single region for each pair and plane."""
    tolerance = tolerance or Tolerance()
    geometry = assembly.geometry
    surfaces = [_surface(geometry, k) for k in range(len(assembly.parts))]
    regions: list[Region] = []
    for a in range(len(surfaces)):
        for b in range(a + 1, len(surfaces)):
            regions.extend(_pair(geometry, surfaces, (a, b), tolerance))
    return regions


def gap_tolerance(geometry: Geometry, a: int, b: int, tolerance: Tolerance) -> tuple[float, float]:
    """Least and greatest interpretation of the gap tolerance of a pair [length unit]."""
    if tolerance.gap is not None:
        return tolerance.gap, tolerance.gap
    value = tolerance.relative_gap * float(min(geometry.size[a], geometry.size[b]))
    floors = [1e-7 * largest(geometry, k) for k in (a, b) if geometry.single[k]]
    if not floors:
        return value, value
    return max(value, min(floors)), max(value, *floors)


def largest(geometry: Geometry, k: int) -> float:
    """Largest coordinate of a part."""
    start, end = geometry.vertex_start[k : k + 2]
    return float(np.abs(geometry.vertices[start:end]).max())


def rounding(geometry: Geometry, a: int, b: int) -> float:
    """Error of a position computed in float64 from the coordinates of two parts.

    Coordinates are taken as given: the coarser float32 coordinates change the scene, not the
    contacts that are in it.
    """
    return 8 * 2.0**-52 * max(largest(geometry, a), largest(geometry, b))


# faces -------------------------------------------------------------------------------


def _surface(geometry: Geometry, k: int) -> Surface:
    start, end = geometry.triangle_start[k : k + 2]
    corners = geometry.vertices[geometry.triangles[start:end]]
    flat = 1e-6 * float(geometry.size[k])
    if geometry.single[k]:
        flat = max(flat, 2e-7 * largest(geometry, k))
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    face, face_normal, flatness = _faces(corners, cross, flat)
    with np.errstate(divide="ignore", invalid="ignore"):
        normal = np.nan_to_num(cross / np.linalg.norm(cross, axis=1)[:, None])
    low, high = corners.min(axis=1), corners.max(axis=1)
    return Surface(corners, normal, face, face_normal, flatness, low, high)


def _faces(corners: Array, cross: Array, flat: float) -> tuple[Index, Array, Array]:
    """Label, plane normal and flatness; the largest triangle takes all triangles in its plane."""
    twice = np.linalg.norm(cross, axis=1)
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    narrow = twice <= 4 * flat * edges
    label = np.full(len(corners), -1)
    normals, flatness = [], []
    for seed in np.argsort(-twice, kind="stable"):
        if label[seed] >= 0:
            continue
        n = cross[seed] / twice[seed]
        height = (corners - corners[seed, 0]) @ n
        along = cross @ n
        member = (label < 0) & (np.abs(height).max(axis=1) <= flat)
        member &= (along >= 0.999999 * twice) | narrow
        member[seed] = True
        label[member] = len(normals)
        mean = cross[member].sum(axis=0)
        mean /= np.linalg.norm(mean)
        normals.append(mean)
        flatness.append(float(np.ptp(corners[member] @ mean - corners[seed, 0] @ mean)))
    return label, np.array(normals), np.array(flatness)


# clipping ----------------------------------------------------------------------------


def _frames(normal: Array) -> tuple[Array, Array]:
    """Two directions that complete each normal, shape (K, 3), to a right-handed frame."""
    helper = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    u = np.cross(helper, normal)
    u /= np.linalg.norm(u, axis=1)[:, None]
    return u, np.cross(normal, u)


def _turned(triangles: Array) -> Array:
    """Triangles in the plane, shape (K, 3, 2), with corners in anticlockwise order."""
    p, q, r = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    right = _cross2(q - p, r - p) < 0
    return np.where(right[:, None, None], triangles[:, ::-1], triangles)


def _cross2(p: Array, q: Array) -> Array:
    return p[..., 0] * q[..., 1] - p[..., 1] * q[..., 0]


def clip_triangles(first: Array, second: Array) -> Array:
    """Overlaps of K pairs of anticlockwise triangles, shape (K, m, 2); nan without overlap."""
    polygons = first
    for k in range(3):
        polygons = _cut(polygons, second[:, k], second[:, (k + 1) % 3])
    return polygons


def _cut(polygons: Array, start: Array, end: Array) -> Array:
    """The part of each convex polygon to the left of the line from `start` to `end`."""
    along = end - start
    with np.errstate(invalid="ignore", divide="ignore"):
        along = along / np.linalg.norm(along, axis=1)[:, None]
        height = _cross2(along[:, None], polygons - start[:, None])
        inside = height >= 0
        following, height_next = np.roll(polygons, -1, axis=1), np.roll(height, -1, axis=1)
        crosses = inside != np.roll(inside, -1, axis=1)
        share = np.where(crosses, height / (height - height_next), 0.0)
    crossing = polygons + share[..., None] * (following - polygons)
    count, m, _ = polygons.shape
    corners = np.stack([polygons, crossing], axis=2).reshape(count, 2 * m, 2)
    keep = np.stack([inside, crosses], axis=2).reshape(count, 2 * m)
    order = np.argsort(~keep, axis=1, kind="stable")
    number = keep.sum(axis=1)
    column = np.minimum(np.arange(max(int(number.max(initial=1)), 1)), number[:, None] - 1)
    chosen = np.take_along_axis(order, np.maximum(column, 0), axis=1)
    result = np.take_along_axis(corners, chosen[..., None], axis=1)
    result[number == 0] = np.nan
    return result


def _height(corners: Array, normal: Array, frame: tuple[Array, Array, Array], flat: Array) -> Array:
    """Height of each triangle's plane over the frame's plane at points `flat`, shape (K, m)."""
    u, v, n = frame
    level = np.einsum("kci,ki->kc", corners, n)
    steep = np.einsum("ki,ki->k", normal, n)
    usable = np.abs(steep) > 0.5
    steep = np.where(usable, steep, 1.0)
    nu, nv = np.einsum("ki,ki->k", normal, u), np.einsum("ki,ki->k", normal, v)
    base = np.einsum("ki,ki->k", normal, corners[:, 0])
    height = base[:, None] - nu[:, None] * flat[..., 0] - nv[:, None] * flat[..., 1]
    height = np.where(usable[:, None], height / steep[:, None], level.mean(axis=1)[:, None])
    return np.clip(height, level.min(axis=1)[:, None], level.max(axis=1)[:, None])


def _candidates(one: Surface, two: Surface, reach: float, angle: float) -> tuple[Index, Index]:
    """Triangle pairs of opposing faces whose boxes come within `reach`."""
    turn = np.linalg.norm(one.face_normal[:, None] + two.face_normal[None], axis=2)
    opposing = turn <= 2 * np.sin(angle / 2)
    pairs = opposing[one.face[:, None], two.face[None]]
    for axis in range(3):
        pairs &= one.low[:, None, axis] <= two.high[None, :, axis] + reach
        pairs &= two.low[None, :, axis] <= one.high[:, None, axis] + reach
    i, j = np.nonzero(pairs)
    return i, j


def _pieces(one: Surface, two: Surface, i: Index, j: Index) -> Pieces:
    """Overlap of each pair of triangles, projected along the mean normal of their faces."""
    n = one.face_normal[one.face[i]] - two.face_normal[two.face[j]]
    n /= np.linalg.norm(n, axis=1)[:, None]
    u, v = _frames(n)
    origin = one.corners[i].mean(axis=1)
    local_one, local_two = one.corners[i] - origin[:, None], two.corners[j] - origin[:, None]
    basis = np.stack([u, v], axis=2)
    polygons = clip_triangles(_turned(local_one @ basis), _turned(local_two @ basis))
    found = ~np.isnan(polygons[:, 0, 0])
    i, j, n, u, v, origin, polygons = (x[found] for x in (i, j, n, u, v, origin, polygons))
    local_one, local_two = local_one[found], local_two[found]
    low = _height(local_one, one.normal[i], (u, v, n), polygons)
    high = _height(local_two, two.normal[j], (u, v, n), polygons)
    points = origin[:, None] + polygons @ np.stack([u, v], axis=1)
    points += ((low + high) / 2)[..., None] * n[:, None]
    area, perimeter = polygon_measures(polygons)
    gaps = high - low
    gap = np.stack([gaps.min(axis=1), gaps.max(axis=1)], axis=1)
    return Pieces(points, area, perimeter, gap, np.stack([one.face[i], two.face[j]], axis=1))


def polygon_measures(polygons: Array) -> tuple[Array, Array]:
    """Areas and perimeters of polygons in the plane, shape (K, m, 2)."""
    if not len(polygons):
        return np.empty(0), np.empty(0)
    relative = polygons - polygons[:, :1]
    following = np.roll(relative, -1, axis=1)
    area = np.abs(_cross2(relative, following).sum(axis=1)) / 2
    return area, np.linalg.norm(following - relative, axis=2).sum(axis=1)


# judgement ---------------------------------------------------------------------------


def _pair(
    geometry: Geometry, surfaces: list[Surface], pair: tuple[int, int], tolerance: Tolerance
) -> list[Region]:
    one, two = surfaces[pair[0]], surfaces[pair[1]]
    least, greatest = gap_tolerance(geometry, *pair, tolerance)
    noise = rounding(geometry, *pair)
    accuracy = float(geometry.accuracy[list(pair)].max())
    # a tilted face is measured to its far end, so that all of its pieces are judged together
    reach = 2 * greatest + 8 * noise + tolerance.angle * float(min(geometry.size[list(pair)]))
    if (one.low.min(axis=0) > two.high.max(axis=0) + reach).any():
        return []
    if (two.low.min(axis=0) > one.high.max(axis=0) + reach).any():
        return []
    i, j = _candidates(one, two, reach, tolerance.angle * 1.02 + 1e-6)
    if not len(i):
        return []
    pieces = _pieces(one, two, i, j)
    pieces = pieces[pieces.thickness > noise]
    found = [
        region
        for faces in np.unique(pieces.face, axis=0)
        for region in _face_pair(
            (one, two),
            pieces[(pieces.face == faces).all(axis=1)],
            pair,
            (least, greatest, noise, accuracy, tolerance.angle),
        )
    ]
    return list(_merged(found))


def _face_pair(
    surfaces: tuple[Surface, Surface],
    pieces: Pieces,
    pair: tuple[int, int],
    limits: tuple[float, float, float, float, float],
) -> Iterator[Region]:
    """The certain or possible contact of two faces, if any."""
    least, greatest, noise, accuracy, angle = limits
    f, g = pieces.face[0]
    normal = surfaces[0].face_normal[f] - surfaces[1].face_normal[g]
    normal /= np.linalg.norm(normal)
    turn = float(np.linalg.norm(surfaces[0].face_normal[f] + surfaces[1].face_normal[g]))
    flatness = float(surfaces[0].flatness[f] + surfaces[1].flatness[g])
    error = noise + 2 * flatness
    low, high = pieces.gap[:, 0], pieces.gap[:, 1]
    if _convex(pieces, normal):  # a single patch: judged as a whole, even if its end is far off
        low, high = np.full_like(low, low.min()), np.full_like(high, high.max())
    near = (low <= least - error) & (high >= error - least)
    far = (low > greatest + error) | (high < -greatest - error)
    all_points = pieces.points.reshape(-1, 3)
    extent = float(np.linalg.norm(np.ptp(all_points, axis=0)))
    if far.all() or pieces.area.sum() < THIN * least * extent:
        return
    thick = pieces.thickness > THICK * greatest
    sure = thick & bool(near.all() and turn < 0.98 * angle)
    tilt = turn + (flatness + noise) / extent
    gap = pieces.gap[sure] if sure.any() else pieces.gap
    yield Region(
        parts=pair,
        normal=normal,
        area=float(pieces.area[sure].sum()),
        slack=float(pieces.area[~sure].sum()),
        sure=pieces.points[sure].reshape(-1, 3),
        maybe=pieces.points[~sure].reshape(-1, 3),
        gap=(float(gap[:, 0].min()), float(gap[:, 1].max())),
        gap_error=error + (float(np.ptp(pieces.gap)) if (~sure).any() else 0.0),
        area_error=AREA * float(pieces.area.sum())
        + (noise + accuracy) * float(pieces.perimeter.sum())
        + float(pieces.area.sum()) * tilt**2,
        noise=noise + (flatness + float(np.abs(gap).max())) * tilt,
        accuracy=accuracy,
        tolerance=greatest,
    )


def _convex(pieces: Pieces, normal: Array) -> bool:
    """True if the pieces fill their hull, so that they are a single patch."""
    flat = pieces.points.reshape(-1, 3)
    u, v = (x[0] for x in _frames(normal[None]))
    hull = _hull((flat - flat[0]) @ np.stack([u, v], axis=1))
    whole, total = polygon_measures(hull[None])[0][0], pieces.area.sum()
    return bool(abs(whole - total) <= 1e-6 * whole)


def _merged(regions: list[Region]) -> Iterator[Region]:
    """Regions of a pair, with those in the same plane merged."""
    normals = [region.normal for region in regions]
    points = [region.points for region in regions]
    for group in planes(normals, points, [2 * r.tolerance for r in regions], angle=1e-3):
        members = [regions[k] for k in group]
        yield members[0] if len(members) == 1 else _union(members)


def _union(members: list[Region]) -> Region:
    weight = np.array([region.area + region.slack for region in members])
    normal = weight @ np.array([region.normal for region in members])
    certain = [region for region in members if not region.borderline] or members
    lean = max(float(np.linalg.norm(r.normal - members[0].normal)) for r in members)
    low, high = min(r.gap[0] for r in members), max(r.gap[1] for r in members)
    low_sure, high_sure = min(r.gap[0] for r in certain), max(r.gap[1] for r in certain)
    extra = max(low_sure - low, high - high_sure, 0.0)
    return Region(
        parts=members[0].parts,
        normal=normal / np.linalg.norm(normal),
        area=sum(r.area for r in members),
        slack=sum(r.slack for r in members),
        sure=np.vstack([r.sure for r in members]),
        maybe=np.vstack([r.maybe for r in members]),
        gap=(low_sure, high_sure),
        gap_error=max(r.gap_error for r in members) + extra,
        area_error=sum(r.area_error for r in members),
        noise=max(r.noise + lean * max(map(abs, r.gap)) for r in members),
        accuracy=members[0].accuracy,
        tolerance=members[0].tolerance,
    )


def planes(
    normals: list[Array], points: list[Array], offsets: list[float], *, angle: float
) -> list[list[int]]:
    """Groups of point sets in the same plane, by normal and distance at their middles."""
    count = len(normals)
    label = list(range(count))
    middles = [p.mean(axis=0) for p in points]
    for i in range(count):
        for j in range(i):
            if np.linalg.norm(normals[i] - normals[j]) > angle:
                continue
            apart = abs((normals[i] + normals[j]) @ (middles[i] - middles[j])) / 2
            reach = max(offsets[i], offsets[j])
            reach += angle / 4 * float(np.linalg.norm(middles[i] - middles[j]))
            if apart <= reach and label[i] != label[j]:
                old = label[i]
                label = [label[j] if k == old else k for k in label]
    return [[k for k in range(count) if label[k] == g] for g in sorted(set(label))]


# comparison --------------------------------------------------------------------------


def discrepancies(
    assembly: Assembly, contacts: ContactSet, regions: list[Region] | None = None
) -> list[str]:
    """Descriptions of lost, invented or wrong patches of a ContactSet."""
    regions = oracle(assembly, contacts.searched) if regions is None else regions
    found = _found(contacts)
    pairs = {tuple(r.parts) for r in regions} | {f[0] for f in found}
    wrong: list[str] = []
    for pair in sorted(pairs):
        expected = [r for r in regions if tuple(r.parts) == pair]
        patches = [f for f in found if f[0] == pair]
        wrong.extend(_pair_discrepancies(pair, expected, patches))
    return wrong


def _found(contacts: ContactSet) -> list[tuple[tuple[int, int], Array, float, Array, Array]]:
    """Pair, normal, area, gap and points of each patch, parts in ascending order."""
    result = []
    for k, (a, b) in enumerate(contacts.patch_parts.tolist()):
        if contacts.patch_kind[k] != "plane":
            continue  # edges and corners have another oracle
        sign = 1.0 if a < b else -1.0
        points = contacts.points[contacts.patch_start[k] : contacts.patch_start[k + 1]]
        pair = (min(a, b), max(a, b))
        normal = sign * contacts.patch_normal[k]
        result.append((pair, normal, float(contacts.patch_area[k]), contacts.patch_gap[k], points))
    return result


def _pair_discrepancies(pair: tuple[int, int], expected: list[Region], found: list) -> list[str]:
    normals = [r.normal for r in expected] + [f[1] for f in found]
    points = [r.points for r in expected] + [f[4] for f in found]
    tolerance = max((r.tolerance for r in expected), default=0.0)
    offsets = [8 * tolerance] * len(normals)
    wrong: list[str] = []
    for group in planes(normals, points, offsets, angle=4e-3):
        regions = [expected[k] for k in group if k < len(expected)]
        patches = [found[k - len(expected)] for k in group if k >= len(expected)]
        wrong.extend(f"parts {pair}: {text}" for text in _compared(regions, patches))
    return wrong


def _compared(regions: list[Region], patches: list) -> list[str]:
    if not regions:
        areas = [f"{f[2]:.6g}" for f in patches]
        return [f"invented, normal {patches[0][1]}, areas {areas}, gaps {patches[0][3]}"]
    sure = [r for r in regions if not r.borderline]
    if not patches:
        return [
            f"lost, normal {r.normal}, area {r.area:.6g}, gap {r.gap[0]:.3g} to {r.gap[1]:.3g}"
            for r in sure
        ]
    return [
        *_area_wrong(regions, patches),
        *_gap_wrong(regions, patches),
        *_support_wrong(regions, patches),
    ]


def _area_wrong(regions: list[Region], patches: list) -> list[str]:
    area, error = sum(f[2] for f in patches), sum(r.area_error for r in regions)
    low = sum(r.area for r in regions) - error
    high = sum(r.area + r.slack for r in regions) + error
    if low <= area <= high:
        return []
    return [f"area {area!r} is not in {low!r} to {high!r} (bound {error:.3g})"]


def _gap_wrong(regions: list[Region], patches: list) -> list[str]:
    sure = [r for r in regions if not r.borderline] or regions
    extra = 0.0 if len(sure) == len(regions) else np.inf
    error = max(r.gap_error for r in regions) + extra
    low, high = min(r.gap[0] for r in sure), max(r.gap[1] for r in sure)
    found_low, found_high = min(f[3][0] for f in patches), max(f[3][1] for f in patches)
    if abs(found_low - low) <= error and abs(found_high - high) <= error:
        return []
    return [
        f"gap {found_low:.4g} to {found_high:.4g}, expected {low:.4g} to {high:.4g} +- {error:.3g}"
    ]


def _support_wrong(regions: list[Region], patches: list) -> list[str]:
    """Support functions of the hulls in 32 directions of the plane, and the plane's offset."""
    normal = regions[0].normal
    u, v = (x[0] for x in _frames(normal[None]))
    upper = np.vstack([r.points for r in regions])
    lower = np.vstack([np.empty((0, 3)), *[r.sure for r in regions]])
    points = np.vstack([f[4] for f in patches])
    middle = upper.mean(axis=0)
    angles = np.random.default_rng(0).uniform(0, 2 * np.pi, 32)
    directions = np.cos(angles)[:, None] * u + np.sin(angles)[:, None] * v
    bound = _corner_error(regions, (upper - middle) @ np.stack([u, v], axis=1))
    reach = ((points - middle) @ directions.T).max(axis=0)
    wrong = []
    over = float((reach - ((upper - middle) @ directions.T).max(axis=0)).max())
    if over > bound:
        wrong.append(f"hull reaches {over:.3g} too far (bound {bound:.3g})")
    if len(lower):
        under = float((((lower - middle) @ directions.T).max(axis=0) - reach).max())
        if under > bound + 2 * regions[0].accuracy:  # closer corners are merged
            wrong.append(f"hull falls {under:.3g} short (bound {bound:.3g})")
    heights, allowed = (points - middle) @ normal, (upper - middle) @ normal
    slack = max(r.gap_error + max(abs(r.gap[0]), abs(r.gap[1])) for r in regions) + bound
    if heights.max() > allowed.max() + slack or heights.min() < allowed.min() - slack:
        wrong.append(f"points {heights.min():.3g} to {heights.max():.3g} off the plane")
    return wrong


def _corner_error(regions: list[Region], flat: Array) -> float:
    """Error of a corner: the rounding over the sine of half the sharpest angle of the hull."""
    noise = max(r.noise for r in regions)
    hull = _hull(flat)
    back, ahead = np.roll(hull, 1, axis=0) - hull, np.roll(hull, -1, axis=0) - hull
    lengths = np.linalg.norm(back, axis=1), np.linalg.norm(ahead, axis=1)
    usable = (lengths[0] > 100 * noise) & (lengths[1] > 100 * noise)
    cosine = (back * ahead).sum(axis=1)[usable] / (lengths[0] * lengths[1])[usable]
    half = np.arccos(np.clip(cosine, -1, 1)) / 2
    return 16 * noise / max(float(np.sin(half).min(initial=1.0)), 1e-6)


def _hull(points: Array) -> Array:
    """Convex hull in the plane (monotone chain), anticlockwise."""
    order = points[np.lexsort((points[:, 1], points[:, 0]))].tolist()
    chains = []
    for sequence in (order, order[::-1]):
        chain: list[list[float]] = []
        for p in sequence:
            while len(chain) > 1 and _turn(chain[-2], chain[-1], p) <= 0:
                chain.pop()
            chain.append(p)
        chains.extend(chain[:-1])
    return np.array(chains if chains else order[:1])


def _turn(p: list[float], q: list[float], r: list[float]) -> float:
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])
