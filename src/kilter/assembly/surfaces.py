"""Exact curved surfaces of all parts, world frame, as a struct of arrays; one row per surface.

A cylinder has the points at the distance `radius` from the line through `point` along `axis`. A
sphere has the points at `radius` from `point`. A torus has the points at `tube` from the circle of
`radius` about `point`, across `axis`. A cone has the points x with angle(x - point, axis) =
`half_angle`. With rho the distance from the axis and t the height along it, the signed distance is

    cylinder  rho - radius                      sphere  |x - point| - radius
    cone      rho cos(half_angle) - t sin(half_angle)
    torus     |(rho - radius, t)| - tube,

positive outside of a solid. The triangles of a part determine only the extent of each surface.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Mask,
    Rows,
    columns,
    cross,
    lengths,
    ratio,
    read_only,
    unit_rows,
)
from kilter.assembly.assembly_tolerances import BESIDE_SEAM, COPLANAR, CREASE, SAME_SURFACE, SMOOTH
from kilter.shape.closed import shared_edges
from kilter.shape.primitives import CYLINDER_SIDES, Cylinder, Mesh, Shape, Sphere
from kilter.shape.primitives import surface as triangulated
from kilter.shape.solid import Solid, Surface, height, move_surface, same_surface

KINDS = ("sphere", "cylinder", "cone", "torus", "free")
"""Kinds of curved surfaces; a "free" surface has no formula here."""
SPHERE, CYLINDER, CONE, TORUS, FREE = range(5)

FEWEST = 16
"""Least number of triangles of a mesh that may represent a curved surface. At least half as many
edges must be smooth."""
MEMBER = 1e-6
"""Largest difference between the radii of a surface recognised in a compound and of that of its
member, relative [-]: the mesh of the compound may be in single precision."""
BESIDE_MEMBER = 1e-4
"""Largest distance of a corner of a compound from a surface of a member on which its triangles may
lie, over the radius [-]; the recognition itself is stricter."""
RECENT_MESHES = 256
"""Largest number of meshes whose curved surfaces are kept; more need more memory."""


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """Curved surfaces of N parts, ordered by part; world frame."""

    part: Index
    """Part of each surface, shape (S,)."""
    start: Index
    """The surfaces of part i are rows ``start[i]`` to ``start[i + 1]``, shape (N + 1,)."""
    kind: Index
    """Index in `KINDS`, shape (S,)."""
    point: Array
    axis: Array
    """Shape (S, 3)."""
    radius: Array
    tube: Array
    half_angle: Array
    """As in `kilter.shape.solid.Surface` [length unit, length unit, rad], shape (S,)."""
    hollow: Mask
    """Whether the material lies outside, as around a hole or socket, shape (S,)."""
    sagitta: Array
    """Largest distance of a triangle from its surface [length unit], shape (S,)."""
    doubt: Array
    """Largest error of the surface itself, shape (S,): 0 if exact, the sagitta if recognised in
    a mesh [length unit]."""
    triangle_start: Index
    triangle: Index
    """The triangles of surface k are ``triangle[triangle_start[k] : triangle_start[k + 1]]``, as
    rows of the geometry's triangles, shape (S + 1,)."""

    def __len__(self) -> int:
        return len(self.part)

    def __repr__(self) -> str:
        return f"<Surfaces: {len(self)}>"

    def triangles_of(self, row: int) -> Index:
        """Indices of the triangles that lie on the surface with index `row`."""
        return self.triangle[self.triangle_start[row] : self.triangle_start[row + 1]]

    def polar(self, rows: Index, points: Array) -> tuple[Array, Array, Array]:
        """Polar coordinates of points about the axis of each surface, or a sphere's centre.

        Arguments: `rows` (n,): surface of each point; `points` (n, 3). Returns `height, distance`
        (n,): height along the axis (0 for a sphere), distance from the axis or centre; `away` (n,
        3): unit direction away from the axis or centre.
        """
        apart = points - self.point[rows]
        axis = np.where((self.kind[rows] == SPHERE)[:, None], 0.0, self.axis[rows])
        height = np.einsum("ij,ij->i", apart, axis)
        away = apart - height[:, None] * axis
        distance = lengths(away)
        return height, distance, ratio(away, distance[:, None])

    def distance(self, rows: Index, points: Array) -> Array:
        """Signed distance of points from their surfaces, shape (n,); infinite for free forms.

        It is positive outside of the material: outside of a solid, inside of a hole.

        Arguments: `rows` (n,): surface of each point; `points` (n, 3).
        """
        return self._distance_at(rows, self.polar(rows, points))

    def outward(self, rows: Index, points: Array) -> Array:
        """Unit normals of surfaces at points, out of the material, shape (n, 3).

        Arguments: `rows` (n,): surface of each point; `points` (n, 3).
        """
        return self._outward_at(rows, self.polar(rows, points))

    def distance_and_outward(self, rows: Index, points: Array) -> tuple[Array, Array]:
        """Signed distances as `distance`, and unit normals as `outward`, in less time."""
        polar = self.polar(rows, points)
        return self._distance_at(rows, polar), self._outward_at(rows, polar)

    def _distance_at(self, rows: Index, polar: tuple[Array, Array, Array]) -> Array:
        """Signed distances of points, given by their polar coordinates."""
        height, rho, _ = polar
        kind = self.kind[rows]
        off = rho - self.radius[rows]
        k = np.flatnonzero(kind == CONE)
        alpha = self.half_angle[rows[k]]
        off[k] = rho[k] * np.cos(alpha) - height[k] * np.sin(alpha)
        k = np.flatnonzero(kind == TORUS)
        off[k] = np.hypot(off[k], height[k]) - self.tube[rows[k]]
        off = np.where(self.hollow[rows], -off, off)
        result: Array = np.where(kind == FREE, np.inf, off)
        return result

    def _outward_at(self, rows: Index, polar: tuple[Array, Array, Array]) -> Array:
        """Unit normals at points, given by their polar coordinates."""
        height, rho, away = polar
        kind, normal = self.kind[rows], away.copy()
        k = np.flatnonzero(kind == CONE)
        alpha = self.half_angle[rows[k]][:, None]
        normal[k] = np.cos(alpha) * away[k] - np.sin(alpha) * self.axis[rows[k]]
        k = np.flatnonzero(kind == TORUS)
        out = (rho[k] - self.radius[rows[k]])[:, None]
        normal[k] = unit_rows(out * away[k] + height[k][:, None] * self.axis[rows[k]])
        result: Array = np.where(self.hollow[rows][:, None], -normal, normal)
        return result


@dataclass(frozen=True, slots=True, eq=False)
class PartSurfaces:
    """Curved surfaces of a part in its own frame, and the surface of each triangle."""

    surfaces: tuple[Surface, ...]
    triangle_surface: Index
    """Row of `surfaces`, -1 for a flat face, ``len(surfaces)`` for a free form, shape (T,)."""
    exact: bool
    """Whether the surfaces are given, and not recognised in a mesh."""
    sagitta: float = 0.0
    """Largest distance of a triangle from the free form [length unit]."""
    off: Array | None = None
    """Largest distance of a triangle from each surface [length unit]; None: not yet measured."""


def surfaces_of(
    shape: Shape, vertices: Array, triangles: Index, accuracy: float
) -> PartSurfaces | None:
    """Curved surfaces of a shape, exact or recognised; None if all faces are flat.

    Arguments: `accuracy`: largest error of a coordinate [length unit].
    """
    if isinstance(shape, Cylinder):
        label = np.full(len(triangles), -1)
        label[-2 * CYLINDER_SIDES :] = 0
        return PartSurfaces((Surface("cylinder", np.zeros(3), radius=shape.radius),), label, True)
    if isinstance(shape, Sphere):
        label = np.zeros(len(triangles), dtype=np.int64)
        return PartSurfaces((Surface("sphere", np.zeros(3), radius=shape.radius),), label, True)
    if isinstance(shape, Solid):
        return _surfaces_of_solid(shape)
    if isinstance(shape, Mesh) and _may_be_curved(vertices, triangles):
        if shape.members:
            return _recognise_in_compound(shape, vertices, triangles, accuracy)
        return _recognise_curved(vertices, triangles, accuracy)
    return None


@lru_cache(maxsize=RECENT_MESHES)
def _surfaces_of_solid(shape: Solid) -> PartSurfaces | None:
    """Curved surfaces of a solid without repetitions, measured once for all copies and poses."""
    given = _curved_only(shape.surfaces, shape.triangle_surface, shape.sagitta, exact=True)
    if given is None:
        return None
    names, kept = _merge_equal(given)
    label = np.where(given.triangle_surface >= 0, names[given.triangle_surface], -1)
    merged = replace(given, surfaces=tuple(kept), triangle_surface=label)
    pose, start = (np.eye(3)[None], np.zeros((1, 3))), np.array([0, len(shape.triangles)])
    alone, _ = join_surfaces({0: merged}, *pose, shape.vertices, shape.triangles, start)
    return replace(merged, off=alone.sagitta[: len(kept)])


def _recognise_in_compound(
    shape: Mesh, vertices: Array, triangles: Index, accuracy: float
) -> PartSurfaces | None:
    """The surfaces recognised in a compound that one of its members has; None without such ones.

    Flat pieces around a bowl approximate no surface: the members are the exact shape. Only
    triangles on the surfaces of members are examined, since the recognition would else take most of
    the time of a scene.
    """
    own, on_own = [], np.zeros(len(triangles), dtype=bool)
    for member, pose in shape.members:
        of_member = surfaces_of(member, *triangulated(member), accuracy)
        for surface in of_member.surfaces if of_member else ():
            own.append(move_surface(surface, pose))
            on = np.abs(height(own[-1], vertices)) <= BESIDE_MEMBER * surface.radius
            on_own |= on[triangles].all(axis=1)
    found = _recognise_curved(vertices, triangles[on_own], accuracy) if own else None
    if found is None:
        return None
    label = np.full(len(triangles), -1)
    label[on_own] = found.triangle_surface
    kept = [
        any(s.kind == o.kind and abs(s.radius - o.radius) <= MEMBER * o.radius for o in own)
        for s in found.surfaces
    ]
    if not any(kept):
        return None
    number = np.append(np.where(kept, np.cumsum(kept) - 1, -1), -1)
    surfaces = tuple(s for s, keep in zip(found.surfaces, kept, strict=True) if keep)
    return replace(found, surfaces=surfaces, triangle_surface=number[label])


def _curved_only(
    surfaces: Sequence[Surface], label: Index, sagitta: float, *, exact: bool
) -> PartSurfaces | None:
    """Drop the planes among surfaces, and adapt the labels; None if only planes are left.

    Triangles of an exact solid on no surface are labelled as free forms.
    """
    curved = [k for k, s in enumerate(surfaces) if s.kind != "plane"]
    number = np.full(len(surfaces) + 1, -1)
    number[curved] = np.arange(len(curved))
    number[-1] = len(curved) if exact else -1
    renamed = number[label]
    if not (renamed >= 0).any():
        return None
    return PartSurfaces(tuple(surfaces[k] for k in curved), renamed, exact, float(sagitta))


def _may_be_curved(vertices: Array, triangles: Index) -> bool:
    """Whether many triangles meet their neighbours at a small angle, as on a curved face."""
    if len(triangles) < FEWEST:
        return False
    points = vertices[triangles]
    normal = unit_rows(cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]))
    first, second = (edge // 3 for edge in shared_edges(triangles))
    cosine = np.einsum("ij,ij->i", normal[first], normal[second])
    bent = (cosine > np.cos(SMOOTH)) & (cosine < 1 - COPLANAR)
    return int(bent.sum()) >= FEWEST // 2


def _recognise_curved(vertices: Array, triangles: Index, accuracy: float) -> PartSurfaces | None:
    """Curved surfaces that the triangles of a mesh approximate; None without such surfaces.

    Copies of an assembly (with other joints, loads or held parts) and copies of a part have the
    same meshes, so the surfaces of recent meshes are kept by the content of the mesh.
    """
    digest = hashlib.blake2b(vertices.tobytes(), digest_size=16)
    digest.update(triangles.tobytes())
    key = digest.digest(), float(accuracy)
    try:
        return _RECENT[key]
    except KeyError:
        pass
    # imported late: only meshes need these modules
    from kilter.shape.recognition import recognise

    surfaces, label, _ = recognise(vertices, triangles, accuracy, planes=False)
    result = _curved_only(surfaces, label, 0.0, exact=False)
    if len(_RECENT) >= RECENT_MESHES:
        _RECENT.clear()
    _RECENT[key] = result
    return result


_RECENT: dict[tuple[bytes, float], PartSurfaces | None] = {}
"""Curved surfaces of recent meshes, by a digest of the mesh and its accuracy."""


def join_surfaces(
    by_part: Mapping[int, PartSurfaces],
    rotation: Array,
    position: Array,
    vertices: Array,
    triangles: Index,
    triangle_start: Index,
) -> tuple[Surfaces, Index]:
    """Join the curved surfaces of all parts in the world frame, with a label for each triangle.

    Arguments: `rotation`, `position` (N, 3, 3): poses of the parts. Returns `label` (T,): surface
    of each triangle, or -1.
    """
    label = np.full(len(triangles), -1)
    rows: list[tuple[int, Surface | None, bool, float]] = []
    for part in sorted(by_part):
        own = by_part[part]
        names, kept = _merge_equal(own)
        local = own.triangle_surface
        span = slice(triangle_start[part], triangle_start[part + 1])
        label[span] = np.where(local >= 0, names[local] + len(rows), -1)
        free = bool((local == len(own.surfaces)).any())
        off = np.full(len(kept), -1.0) if own.off is None else own.off
        distinct: list[Surface | None] = [*kept, None] if free else [*kept]
        rows += [
            (part, surface, own.exact, own.sagitta if surface is None else float(far))
            for surface, far in zip(distinct, [*off, 0.0], strict=False)
        ]
    owner = np.array([row[0] for row in rows], dtype=np.int64)
    given = [surface or Surface("sphere", np.zeros(3)) for _, surface, _, _ in rows]
    kind = np.array(
        [FREE if s is None else KINDS.index(s.kind) for _, s, _, _ in rows], dtype=np.int64
    )
    count = len(rows)
    turn = rotation[owner]
    point = np.array([s.point for s in given]).reshape(count, 3)
    axis = np.array([s.axis for s in given]).reshape(count, 3)
    order = np.argsort(label, kind="stable")
    order = order[np.searchsorted(label[order], 0) :]
    surfaces = Surfaces(
        part=owner,
        start=np.searchsorted(owner, np.arange(len(position) + 1)),
        kind=kind,
        point=np.einsum("nij,nj->ni", turn, point) + position[owner],
        axis=np.einsum("nij,nj->ni", turn, axis),
        radius=np.array([s.radius for s in given]),
        tube=np.array([s.tube for s in given]),
        half_angle=np.array([s.half_angle for s in given]),
        hollow=np.array([s.hollow for s in given], dtype=bool),
        sagitta=np.maximum([row[3] for row in rows], 0.0),
        doubt=np.zeros(count),
        triangle_start=np.searchsorted(label[order], np.arange(count + 1)),
        triangle=order,
    )
    exact, measured = np.array([(row[2], row[3] >= 0) for row in rows], dtype=bool).reshape(-1, 2).T
    _measure(surfaces, vertices, triangles, label, measured)
    surfaces.doubt[~exact] = surfaces.sagitta[~exact]
    read_only(surfaces)
    return surfaces, label


def _merge_equal(local_surfaces: PartSurfaces) -> tuple[Index, list[Surface]]:
    """Merge surfaces of a part that are pieces of the same surface, unless they are measured.

    Returns `names` (number of surfaces + 1,): new number of each surface, and of the free form,
    which comes after them; `kept`: the distinct surfaces.
    """
    surfaces = local_surfaces.surfaces
    if local_surfaces.off is not None:
        return np.arange(len(surfaces) + 1), list(surfaces)
    kept: list[int] = []
    names = np.zeros(len(surfaces) + 1, dtype=np.int64)
    kind = np.array([2 * KINDS.index(s.kind) + s.hollow for s in surfaces])
    point = np.array([s.point for s in surfaces]).reshape(-1, 3)
    sizes = np.array([[s.radius, s.tube, s.half_angle] for s in surfaces]).reshape(-1, 3)
    for k, surface in enumerate(surfaces):
        step = point[kept] - surface.point
        far = np.abs(step).max(axis=1, initial=0.0)
        length = SAME_SURFACE * np.maximum(np.maximum(sizes[kept, 0], surface.radius), far)
        if surface.kind == "cylinder":
            step -= (step @ surface.axis)[:, None] * surface.axis
        near = (kind[kept] == kind[k]) & (lengths(step) <= length)
        near &= (np.abs(sizes[kept] - sizes[k])[:, :2] <= length[:, None]).all(axis=1)
        alike = [n for n in np.flatnonzero(near).tolist() if _is_same(surface, surfaces[kept[n]])]
        names[k] = alike[0] if alike else len(kept)
        if not alike:
            kept.append(k)
    names[-1] = len(kept)
    return names, [surfaces[k] for k in kept]


def _is_same(first: Surface, second: Surface) -> bool:
    """Whether two surfaces of a part are pieces of the same cylinder, sphere or other surface."""
    sizes = (first.radius, second.radius, float(np.abs(first.point - second.point).max()))
    return same_surface(first, second, length=SAME_SURFACE * max(sizes), angle=SAME_SURFACE)


def _measure(
    surfaces: Surfaces, vertices: Array, triangles: Index, label: Index, measured: Mask
) -> None:
    """Compute, in place, the sagittas of surfaces: the distance of their triangles from them.

    The distance is measured at corners, at middles of sides, and at centroids of triangles.

    Arguments: `measured` (S,): surfaces whose sagitta is known.
    """
    owner = label[surfaces.triangle]
    chosen = ~measured[owner]
    if not chosen.any():
        return
    owner, p = owner[chosen], vertices[triangles[surfaces.triangle[chosen]]]
    sites = [p[:, 0], p[:, 1], p[:, 2], p.mean(axis=1)]
    sites += [(p[:, k] + p[:, k - 1]) / 2 for k in range(3)]
    off = np.max([np.abs(surfaces.distance(owner, site)) for site in sites], axis=0)
    np.maximum.at(surfaces.sagitta, owner, off)


# Find points on the edge curves between two faces, starting from their chords.


STEPS = 4
"""Number of Newton steps from a chord to its edge; more steps reach strongly curved edges."""


@dataclass(frozen=True, slots=True, eq=False)
class Chords(Rows):
    """Straight edges of a mesh that stand for n curved edges, each between two exact faces."""

    p: Array = columns(3)
    q: Array = columns(3)
    """Ends of the chords, on both faces, shape (n, 3)."""
    surface: Index = columns(2)
    """Exact surface of each face, or -1 for the plane of a triangle, shape (n, 2)."""
    origin: Array = columns(2, 3)
    normal: Array = columns(2, 3)
    """A point and the unit normal of that plane, shape (n, 2, 3)."""

    def rising(self, side: int, points: Array, s: Surfaces) -> tuple[Array, Array]:
        """Signed distance of points from one of the two faces at each edge, and its gradient.

        Arguments: `points` (n, 3). Returns `value` (n,); `gradient` (n, 3).
        """
        row = self.surface[:, side]
        normal = self.normal[:, side].copy()
        value = np.einsum("ij,ij->i", points - self.origin[:, side], normal)
        curved = np.flatnonzero(row >= 0)
        value[curved] = s.distance(row[curved], points[curved])
        normal[curved] = s.outward(row[curved], points[curved])
        return value, normal

    def on_edge(self, share: Array, s: Surfaces) -> tuple[Array, Mask]:
        """Points on the true curved edges above points of the chords, and a mask of success.

        Arguments: `share` (n,): position along each chord, from 0 at p to 1 at q. Returns `points`
        (n, 3); `converged` (n,): False if the faces meet smoothly, or Newton's method has not
        converged.
        """
        along = unit_rows(self.q - self.p)
        points = self.p + share[:, None] * (self.q - self.p)
        for _ in range(STEPS):
            (f, m), (g, n) = (self.rising(side, points, s) for side in (0, 1))
            sine = np.einsum("ij,ij->i", cross(m, n), along)
            crease = np.abs(sine) > CREASE
            step = f[:, None] * cross(along, n) - g[:, None] * cross(along, m)
            points = points + step / np.where(crease, sine, np.inf)[:, None]
        length = np.linalg.norm(self.q - self.p, axis=1)
        off = np.maximum(*(np.abs(self.rising(side, points, s)[0]) for side in (0, 1)))
        return points, crease & (off <= BESIDE_SEAM * length)
