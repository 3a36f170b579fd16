"""Normal of each pair of convex pieces: along the nearest points, or the least overlap.

A cylinder is first a prism of 32 sides. Then directions on the exact surfaces improve the normal:
caps and faces, radial directions of the side, and stationary directions at the rims by Newton's
method. The separation along each direction is exact, so that a wrong direction never counts.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from kilter.arrays import Array, Index, Mask, across, cross
from kilter.contact.convex_distance import edge_separations, face_separations, nearest_points
from kilter.contact.convex_pieces import Cores, Placed, padded_rows
from kilter.contact.convex_tolerances import EXACT, NEAR, OPPOSED

FACE_ANGLE = 0.06
"""Largest angle between the nearest points and a face normal that replaces it [rad]."""
FACE_SHARE = 0.998
"""Least separation along such a normal, over the distance [-]."""
ALIKE = 0.99
"""Cosine of the angle to a direction that was tried above which a direction is the same [-]."""
ROUNDS = 2
"""Number of times that the prisms of cylinders are turned to the normal."""
STEPS = 12
"""Number of steps of Newton's method."""
LONGEST = 0.4
"""Longest step of a direction [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class PairNormals:
    """Normals of K pairs of cores."""

    normal: Array
    """Unit vectors from a to b, shape (K, 3)."""
    separation: Array
    """Distance of the support planes across the normal [length unit], shape (K,)."""
    on_a: Array
    on_b: Array
    """Nearest points, or a support point and its place on the other core, shape (K, 3)."""
    regular: Mask
    """False where a corner is nearest to a corner or an edge: no force along such a normal."""

    def take(self, rows: Index) -> PairNormals:
        """Normals of some of the pairs."""
        names = ("normal", "separation", "on_a", "on_b", "regular")
        return PairNormals(*(getattr(self, name)[rows] for name in names))


@dataclass(frozen=True, slots=True, eq=False)
class Excluded:
    """Directions that do not lead out of an overlap."""

    inner: tuple[Mask, Mask]
    """Faces of each piece inside of its compound, shapes (K, Fa), (K, Fb)."""
    tried: Array
    """Directions from a to b that lead into other pieces, shape (K, m, 3)."""

    def take(self, rows: Index) -> Excluded:
        """Excluded directions of some of the pairs."""
        return Excluded((self.inner[0][rows], self.inner[1][rows]), self.tried[rows])

    def near(self, n: Array, rows: Index | slice = slice(None)) -> Mask:
        """Whether directions, shape (K, n, 3), are near one that was tried, shape (K, n)."""
        cosine = n @ self.tried[rows].transpose(0, 2, 1)
        result: Mask = cosine.max(axis=2, initial=-1.0) > ALIKE
        return result

    def faces(self, a: Cores, b: Cores) -> tuple[Mask, Mask]:
        """Excluded faces of each core, shapes (K, Fa), (K, Fb)."""
        # fewer pairs have shorter padded rows
        of_a, of_b = (
            inner[:, : core.normal.shape[1]] for inner, core in zip(self.inner, (a, b), strict=True)
        )
        return of_a | self.near(a.normal), of_b | self.near(-b.normal)


def pair_normals(
    scene: Placed,
    pair: tuple[Index, Index],
    cores: tuple[Cores, Cores],
    separations: tuple[Array, Array],
    excluded: Excluded,
    limit: Array,
) -> PairNormals:
    """Normals of pairs of pieces.

    Arguments: `pair`: pieces a and b, shape (K,) each; `cores`: their cores; `separations`: those
    of `face_separations`; `limit` (K,): distance of the cores beyond which the normal does not
    matter. The separation is infinite if all directions of an overlap are excluded.
    """
    pieces = scene.pieces
    size = np.minimum(*(pieces.size[piece] for piece in pair))
    curved = [pieces.radius[piece] + pieces.disc[piece] for piece in pair]
    sharp = curved[0] + curved[1] == 0
    a, b = cores
    result = _core_normals(a, b, separations, (size, limit), sharp, excluded)
    left = np.flatnonzero((pieces.disc[pair[0]] > 0) | (pieces.disc[pair[1]] > 0))
    a, b = a.take(left), b.take(left)
    for turn in range(ROUNDS + 1):
        if not len(left):
            break
        some, own = (pair[0][left], pair[1][left]), excluded.take(left)
        found = result.take(left)
        if turn:
            a, b = (scene.cores(piece, found.normal) for piece in some)
            faces = face_separations(a, b)
            found = _core_normals(a, b, faces, (size[left], limit[left]), sharp[left], own)
        normal, separation, left_open = _exact_normals(scene, some, (a, b), found, size[left], own)
        slack = EXACT * size[left]
        better = np.isfinite(separation) & (separation > result.separation[left] + slack)
        rows = np.flatnonzero(better | (turn == 0))
        result.normal[left[rows]], result.separation[left[rows]] = normal[rows], separation[rows]
        result.on_b[left] = found.on_b
        result.on_a[left] = found.on_b - result.separation[left, None] * result.normal[left]
        left = left[rows[left_open[rows]]]
    return result


def _core_normals(
    a: Cores,
    b: Cores,
    separations: tuple[Array, Array],
    sizes: tuple[Array, Array],
    sharp: Mask,
    excluded: Excluded,
) -> PairNormals:
    """Normals of pairs of polytopes; of pairs with a rounded core (not `sharp`), of the cores.

    `separations`: those of `face_separations`; `sizes`: size of each pair, and the distance beyond
    which the normal does not matter.
    """
    size = sizes[0]
    rows = np.arange(len(size))
    first, second = (
        np.where(mask & (separation < 0), -np.inf, separation)
        for mask, separation in zip(excluded.faces(a, b), separations, strict=True)
    )
    i, j = first.argmax(axis=1), second.argmax(axis=1)
    of_a = first[rows, i] >= second[rows, j]
    normal = np.where(of_a[:, None], a.normal[rows, i], -b.normal[rows, j])
    face = np.where(of_a, first[rows, i], second[rows, j])
    near = nearest_points(a, b, *sizes)
    step = near.on_b - near.on_a
    apart = np.linalg.norm(step, axis=1)
    along = step / np.where(apart > 0, apart, 1.0)[:, None]
    level = np.einsum("ki,ki->k", along, normal) >= np.cos(FACE_ANGLE)
    level &= sharp & (face >= FACE_SHARE * apart) & (face > 0)
    by_face = ~near.apart | level | (face >= apart - EXACT * size)
    none = by_face & ~np.isfinite(face)
    normal[none] = [0.0, 0.0, 1.0]
    lost = np.inf if excluded.tried.shape[1] else 0.0
    result = PairNormals(
        np.where(by_face[:, None], normal, along),
        np.where(none, lost, np.where(by_face, face, apart)),
        near.on_a,
        near.on_b,
        by_face | ~near.at_corner | ~sharp,
    )
    _try_edges(a, b, result, near.apart & ~by_face, ~near.apart, size, excluded)
    support = np.flatnonzero(~near.apart)
    height = (b.vertex[support] @ result.normal[support, :, None])[..., 0].argmin(axis=1)
    result.on_b[support] = b.vertex[support, height]
    step = result.separation[support, None] * result.normal[support]
    result.on_a[support] = result.on_b[support] - step
    return result


def _try_edges(
    a: Cores,
    b: Cores,
    result: PairNormals,
    apart: Mask,
    overlap: Mask,
    size: Array,
    excluded: Excluded,
) -> None:
    """Replace normals of overlaps, and of pairs that are almost in touch, by those across edges."""
    separation = result.separation
    lost = overlap & np.isinf(separation)
    doubt = np.flatnonzero(
        (overlap & (separation < 0)) | lost | (apart & (separation < NEAR * size))
    )
    if not len(doubt):
        return
    bound = np.where(lost, size, np.abs(separation))[doubt]
    edges = edge_separations(a.take(doubt), b.take(doubt), bound)
    row = doubt[edges.row]
    shut = overlap[row] & excluded.near(edges.normal[:, None], row)[:, 0]
    value = np.where(shut, -np.inf, edges.separation)
    best = np.full(len(size), -np.inf)
    np.maximum.at(best, row, value)
    least = np.where(apart, separation - EXACT * size, separation + EXACT * size)
    least[lost] = -np.inf
    take = (value == best[row]) & (value > least[row])
    row = row[take]
    result.normal[row], separation[row] = edges.normal[take], value[take]
    result.regular[row] = True


# exact directions of cylinders ---------------------------------------------------------------


def _exact_normals(
    scene: Placed,
    pair: tuple[Index, Index],
    cores: tuple[Cores, Cores],
    found: PairNormals,
    size: Array,
    excluded: Excluded,
) -> tuple[Array, Array, Mask]:
    """The direction of the largest exact separation of pairs with cylinders, and its separation.

    The mask marks the pairs that another direction may separate more: no direction separates
    cylinders more than the prisms inside them, or more than two of their points.
    """
    faces, allowed, widths = _face_directions(cores)
    tries = np.concatenate([faces, found.normal[:, None]], axis=1)
    # the rows of a few pairs may be shorter than those of all
    faces_inside = [mask[:, :width] for mask, width in zip(excluded.inner, widths, strict=True)]
    inner = np.concatenate([*faces_inside, np.zeros((len(size), 1), dtype=bool)], axis=1)
    allowed = np.concatenate([allowed, np.ones((len(size), 1), dtype=bool)], axis=1)
    normal, best = _best_direction(scene, pair, tries, (allowed, inner | excluded.near(tries)))
    slack = EXACT * size
    may_grow = (best < found.separation - slack) & ~_attained(scene, pair, cores, normal, best)
    rows = np.flatnonzero(may_grow)
    if len(rows):
        some, own = (pair[0][rows], pair[1][rows]), excluded.take(rows)
        few = cores[0].take(rows), cores[1].take(rows)
        tries = _rim_directions(scene, some, few, found.take(rows))
        masks = np.ones(tries.shape[:2], dtype=bool), own.near(tries)
        other, value = _best_direction(scene, some, tries, masks)
        better = value > best[rows] + slack[rows]
        normal[rows[better]], best[rows[better]] = other[better], value[better]
        may_grow[rows] = best[rows] < (found.separation - slack)[rows]
        may_grow[rows] &= ~_attained(scene, some, few, normal[rows], best[rows])
    return normal, np.where(np.isfinite(best), best, np.inf), may_grow


def _attained(
    scene: Placed, pair: tuple[Index, Index], cores: tuple[Cores, Cores], n: Array,
    separation: Array,
) -> Mask:  # fmt: skip
    """Whether the support point of a rim has a point of the other core at the separation along n.

    No direction then separates a pair that is apart more than n, shape (K, 3).
    """
    size = np.minimum(*(scene.pieces.size[piece] for piece in pair))
    shown = np.zeros(len(n), dtype=bool)
    for k, sign in enumerate((1.0, -1.0)):
        own, other, core = pair[k], pair[1 - k], cores[1 - k]
        axis, frame = scene.axis[own], np.stack(across(_unit(scene.axis[own])), axis=1)
        flat = (frame @ n[..., None])[..., 0]
        length = np.linalg.norm(flat, axis=1, keepdims=True)
        flat *= scene.pieces.disc[own, None] / np.where(length > 0, length, 1.0)
        end = np.sign(np.einsum("ki,ki->k", axis, n))[:, None] * axis
        out = end + np.einsum("ka,kai->ki", flat, frame)
        at = scene.middle[own] + sign * (out + separation[:, None] * n)
        inside = (_room(core, at) >= -EXACT * size[:, None]).all(axis=1) & ~core.bare
        off = np.linalg.norm(cross(at - scene.middle[other], _unit(scene.axis[other])), axis=1)
        disc = scene.pieces.disc[other]
        inside &= (disc == 0) | (off <= disc + EXACT * size)
        shown |= inside & (scene.pieces.disc[own] > 0)
    return shown & (separation > 0)


def _room(core: Cores, x: Array) -> Array:
    """Depth of points (K, 3) below the faces of their cores; inf for sides of prisms, (K, F)."""
    room = core.offset - np.einsum("kfi,ki->kf", core.normal, x)
    return np.where(np.arange(room.shape[1]) < core.sides[:, None], np.inf, room)


def _best_direction(
    scene: Placed, pair: tuple[Index, Index], tries: Array, masks: tuple[Mask, Mask]
) -> tuple[Array, Array]:
    """Direction with the largest separation of each pair, and this separation.

    Arguments: `tries` (K, m, 3); `masks`: directions that count, and directions that do not count
    in an overlap, shape (K, m).
    """
    separation = exact_separation(scene, pair, tries)
    allowed = masks[0] & ~(masks[1] & (separation < 0))
    separation = np.where(allowed, separation, -np.inf)
    k = separation.argmax(axis=1)
    rows = np.arange(len(k))
    return tries[rows, k], separation[rows, k]


def _face_directions(cores: tuple[Cores, Cores]) -> tuple[Array, Mask, tuple[int, int]]:
    """Face normals of both pieces, from a to b, (K, Fa + Fb, 3), whether exact, and Fa, Fb."""
    normals, exact = [], []
    for core, sign in zip(cores, (1.0, -1.0), strict=True):
        real = np.isfinite(core.offset)
        side = np.arange(real.shape[1]) < core.sides[:, None]
        normals.append(sign * core.normal)
        exact.append(real & ~side)
    widths = exact[0].shape[1], exact[1].shape[1]
    return np.concatenate(normals, axis=1), np.concatenate(exact, axis=1), widths


def exact_separation(scene: Placed, pair: tuple[Index, Index], n: Array) -> Array:
    """Separation of the exact cores along unit directions n, shape (K, m, 3); shape (K, m)."""
    return -_support(scene, pair[0], n) - _support(scene, pair[1], -n)


def _support(scene: Placed, piece: Index, n: Array) -> Array:
    """Height of the support plane of each core along directions n, shape (K, m, 3)."""
    vertex = scene.vertex[padded_rows(scene.pieces.vertex_start, piece)[0]]
    flat: Array = (n @ vertex.transpose(0, 2, 1)).max(axis=2)
    disc = scene.pieces.disc[piece]
    round_ = np.flatnonzero(disc > 0)
    if not len(round_):
        return flat
    axis, m, disc = scene.axis[piece[round_]], n[round_], disc[round_]
    half = np.linalg.norm(axis, axis=1)
    along = np.einsum("kmi,ki->km", m, axis)
    across_ = np.linalg.norm(cross(m, (axis / half[:, None])[:, None]), axis=2)
    middle = np.einsum("kmi,ki->km", m, scene.middle[piece[round_]])
    flat[round_] = middle + np.abs(along) + disc[:, None] * across_
    return flat


@dataclass(frozen=True, slots=True, eq=False)
class _Features:
    """Features of one core of K pairs, m for each pair: a corner, an edge, a rim or a side."""

    point: Array
    """Shape (K, m, 3): the corner, a point of the edge or axis, the centre of the rim."""
    along: Array
    """Unit vector of an edge or a side, else 0, shape (K, m, 3)."""
    axis: Array
    """Unit normal of the plane of a rim, else 0, shape (K, m, 3)."""
    radius: Array
    """Radius of a rim, else 0, shape (K, m)."""
    new: Mask
    """False for a repetition of an earlier feature, shape (K, m)."""

    def at(self, row: Index, k: Index) -> _Features:
        """Feature k of each row."""
        return _Features(*(getattr(self, each.name)[row, k] for each in fields(self)))


def _features(scene: Placed, piece: Index, core: Cores, n: Array) -> _Features:
    """Four features of each core near its support plane across n, shape (K, 3).

    Polytope: the support corner and the three edges there that are most nearly across n. Cylinder:
    the side and both rims.
    """
    rows = np.arange(len(piece))
    corner = (core.vertex @ n[..., None])[..., 0].argmax(axis=1)
    p = core.vertex[rows, corner]
    ends = core.edge
    step = core.vertex[rows[:, None], ends[..., 1]] - core.vertex[rows[:, None], ends[..., 0]]
    d = _unit(step)
    slope = np.abs(d @ n[..., None])[..., 0]
    at = core.edges & (ends == corner[:, None, None]).any(axis=2)
    slope = np.where(at, slope, np.inf)
    order = np.argsort(slope, axis=1)[:, :3]
    order = np.pad(order, ((0, 0), (0, 3 - order.shape[1])), mode="edge")
    beside = np.isfinite(np.take_along_axis(slope, order, axis=1))
    zero = np.zeros((len(piece), 1, 3))
    edges = np.where(beside[..., None], np.take_along_axis(d, order[..., None], axis=1), 0.0)
    point, along = np.repeat(p[:, None], 4, axis=1), np.concatenate([zero, edges], axis=1)
    axis, radius = np.zeros_like(point), np.zeros((len(piece), 4))
    round_ = np.flatnonzero(scene.pieces.disc[piece] > 0)
    middle, half = scene.middle[piece[round_]], scene.axis[piece[round_]]
    point[round_] = np.stack([middle, middle + half, middle - half, middle], axis=1)
    along[round_] = axis[round_] = _unit(half)[:, None]
    along[round_, 1:3] = axis[round_, 0] = axis[round_, 3] = 0.0
    radius[round_, 1:3] = scene.pieces.disc[piece[round_], None]
    new = np.concatenate([np.ones((len(piece), 1), dtype=bool), beside], axis=1)
    new[round_] = [True, True, True, False]
    return _Features(point, along, axis, radius, new)


def _rim_directions(
    scene: Placed, pair: tuple[Index, Index], cores: tuple[Cores, Cores], found: PairNormals
) -> Array:
    """Stationary directions of the separation of pairs of features, shape (K, 32, 3).

    Half of them come from Newton's method for the direction, the others from Newton's method for
    the nearest points of the features: near the axis of a rim, or near touch, only one is sure.
    """
    i, j = (x.ravel() for x in np.indices((4, 4)))
    tries = np.repeat(found.normal[:, None], 2 * len(i), axis=1)
    away = found.normal, -found.normal
    sides = [_features(scene, *side) for side in zip(pair, cores, away, strict=True)]
    row, place = np.nonzero(sides[0].new[:, i] & sides[1].new[:, j])
    a, b = (x.at(row, k[place]) for x, k in zip(sides, (i, j), strict=True))
    start = found.normal[row]
    both = cross(a.along, b.along)
    two = np.linalg.norm(both, axis=1) > OPPOSED
    one = np.where((np.abs(a.along).max(axis=1) > 0)[:, None], a.along, b.along)
    n = start - np.einsum("ki,ki->k", start, one)[:, None] * one
    n[two] = both[two] * np.sign(np.einsum("ki,ki->k", both[two], n[two]))[:, None]
    n = _unit(n)
    moving = np.flatnonzero(~two)
    rims = [(x.axis[moving], x.radius[moving]) for x in (a, b)]
    n[moving] = _stationary(n[moving], (b.point - a.point)[moving], one[moving], rims)
    step = _between_curves(a, b, found.on_a[row], found.on_b[row])
    step *= np.sign(np.einsum("ki,ki->k", step, start))[:, None]
    tries[row, place], tries[row, len(i) + place] = n, _unit(step)
    return tries


def _between_curves(a: _Features, b: _Features, on_a: Array, on_b: Array) -> Array:
    """Steps from a to b between points of two features at which the distance is stationary, (K, 3).

    Arguments: `a`, `b`: one feature for each row; `on_a`, `on_b` (K, 3): points near the start.
    """
    frames = [across(_unit(x.axis)) for x in (a, b)]
    value: list[Array] = []
    for x, (u, v), on in zip((a, b), frames, (on_a, on_b), strict=True):
        off = on - x.point
        y = [np.einsum("ki,ki->k", off, e) for e in (u, v, x.along)]
        value.append(np.where(x.radius > 0, np.arctan2(y[1], y[0]), y[2]))
    w, left = on_b - on_a, np.arange(len(on_a))
    size = np.linalg.norm(b.point - a.point, axis=1) + a.radius + b.radius
    for _ in range(STEPS):
        points, slopes, bends = [], [], []
        for x, frame, t in zip((a, b), frames, value, strict=True):
            u, v, t, radius, along = (y[left] for y in (*frame, t, x.radius, x.along))
            c, s = (radius * f(t) for f in (np.cos, np.sin))
            out, turn = c[:, None] * u + s[:, None] * v, c[:, None] * v - s[:, None] * u
            round_ = (radius > 0)[:, None]
            points.append(x.point[left] + np.where(round_, out, t[:, None] * along))
            slopes.append(np.where(round_, turn, along))
            bends.append(np.where(round_, -out, 0.0))
        w[left] = apart = points[1] - points[0]

        def dot(x: Array, y: Array) -> Array:
            result: Array = np.einsum("ki,ki->k", x, y)
            return result

        g, h = -dot(apart, slopes[0]), dot(apart, slopes[1])
        p = dot(slopes[0], slopes[0]) - dot(apart, bends[0])
        q = dot(slopes[1], slopes[1]) + dot(apart, bends[1])
        m = -dot(slopes[0], slopes[1])
        still = [np.abs(slope).max(axis=1) == 0 for slope in slopes]
        p, q = np.where(still[0], 1.0, p), np.where(still[1], 1.0, q)
        det = p * q - m * m
        safe = np.where(det != 0, det, 1.0)
        far = np.zeros(len(left))
        for k, change in enumerate(((m * h - q * g) / safe, (m * g - p * h) / safe)):
            radius = (a, b)[k].radius[left]
            step = np.where(radius > 0, np.clip(change, -LONGEST, LONGEST), change)
            value[k][left] += step
            far = np.maximum(far, np.abs(step) * np.where(radius > 0, radius, 1.0))
        left = left[far >= EXACT * size[left]]
        if not len(left):
            break
    return w


def _unit(n: Array) -> Array:
    length = np.linalg.norm(n, axis=-1, keepdims=True)
    result: Array = np.where(length > 0, n / np.where(length > 0, length, 1.0), [0.0, 0.0, 1.0])
    return result


def _stationary(n: Array, w: Array, along: Array, rims: list[tuple[Array, Array]]) -> Array:
    """Unit vectors n across `along` at which n.w - sum r |n - (n.u) u| is stationary.

    Arguments: `n` (K, 3): start; `w` (K, 3); `along` (K, 3): unit vector or 0; `rims`: normal u
    (K, 3) and radius r (K,) of each rim.
    """
    n, bound, left = n.copy(), np.abs(along).max(axis=1) > 0, np.arange(len(n))
    for _ in range(STEPS):
        m, fixed = n[left], bound[left]
        x, y = across(m)
        x = np.where(fixed[:, None], cross(m, along[left]), x)
        basis = np.stack([x, y], axis=1)
        gradient, h = w[left], np.zeros((len(m), 2, 2))
        for u, r in ((axis[left], radius[left]) for axis, radius in rims):
            flat = m - np.einsum("ki,ki->k", m, u)[:, None] * u
            length = np.linalg.norm(flat, axis=1)
            safe = np.where(length > 0, length, 1.0)
            out = flat / safe[:, None]
            gradient = gradient - r[:, None] * out
            p = basis - np.einsum("kai,ki->ka", basis, u)[..., None] * u[:, None]
            q = np.einsum("kai,ki->ka", basis, out)
            h -= (r / safe)[:, None, None] * (p @ p.transpose(0, 2, 1) - q[:, :, None] * q[:, None])
        value = np.einsum("ki,ki->k", gradient, m)
        h[:, [0, 1], [0, 1]] -= value[:, None]
        g = np.einsum("kai,ki->ka", basis, gradient)
        g[fixed, 1] = 0.0
        h[fixed, 0, 1] = h[fixed, 1, 0] = 0.0
        h[fixed, 1, 1] = -1.0
        det = h[:, 0, 0] * h[:, 1, 1] - h[:, 0, 1] * h[:, 1, 0]
        peak = (h[:, 0, 0] < 0) & (det > 0)
        safe = np.where(peak, det, 1.0)
        # uphill where the function is not concave
        s = np.where(peak, (h[:, 0, 1] * g[:, 1] - h[:, 1, 1] * g[:, 0]) / safe, g[:, 0])
        t = np.where(peak, (h[:, 1, 0] * g[:, 0] - h[:, 0, 0] * g[:, 1]) / safe, g[:, 1])
        far = np.hypot(s, t)
        limit = np.minimum(1.0, LONGEST / np.where(far > 0, far, 1.0))
        n[left] = _unit(m + ((s * limit)[:, None] * x + (t * limit)[:, None] * y))
        left = left[far >= EXACT]
        if not len(left):
            break
    return n
