"""Shapes of parts: box, cylinder, sphere, prism, mesh; each in the part's own frame.

Every shape is a value: frozen, arrays copied in and read-only. Lengths are in the unit of
the assembly. `surface(shape)` gives the closed triangulated surface of a shape, its
triangles turning counter-clockwise seen from outside.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from typing import Any

import numpy as np

from kilter.arrays import Array, Index, Mask, across, cross
from kilter.errors import InputError
from kilter.rigid import in_brackets
from kilter.shape.shape_tolerances import CUT_AREA, POLYGON_AREA, WHOLE_TURN
from kilter.shape.solid import Solid
from kilter.validate import frozen, in_range, number

__all__ = ["Box", "Cylinder", "Mesh", "Prism", "Shape", "Sphere", "surface"]


CYLINDER_SIDES = 96
"""Sides of the polygon inscribed in a cylinder's circle, a multiple of 4."""
SPHERE_RINGS = 24
"""Rings of the polyhedron inscribed in a sphere."""

BOX_QUADS: Index = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
)
"""Faces of a box, shape (6, 4): -z, +z, -y, +y, -x, +x; corner k has bits x=1, y=2, z=4."""
BOX_CORNERS: Array = np.array(
    [[x - 0.5, y - 0.5, z - 0.5] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float
)


def _positive(value: Any, what: str) -> float:
    return number(value, what, lowest=0, above=True)


@dataclass(frozen=True, slots=True, eq=False)
class Box:
    """A box, centred on the origin.

    Parameters
    ----------
    size : array_like, shape (3,)
        Its lengths along x, y, z [length unit].

    Raises
    ------
    InputError
        If one of them is not above zero.

    Examples
    --------
    >>> Box([40, 20, 10]).size
    array([40., 20., 10.])
    """

    size: Any

    def __post_init__(self) -> None:
        size = frozen(self.size, (3,))
        if not (np.isfinite(size).all() and (size > 0).all()):
            raise InputError(f"box is {size.tolist()}", hint="give three lengths above zero")
        in_range(size, "box")
        object.__setattr__(self, "size", size)

    def __repr__(self) -> str:
        return f"Box{in_brackets(self.size)}"


@dataclass(frozen=True, slots=True, eq=False)
class Cylinder:
    """A solid cylinder about the z axis, centred on the origin.

    Parameters
    ----------
    radius, height : float
        [length unit]

    Raises
    ------
    InputError
        If one of them is not above zero.
    """

    radius: float
    height: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", _positive(self.radius, "radius of the cylinder"))
        object.__setattr__(self, "height", _positive(self.height, "height of the cylinder"))


@dataclass(frozen=True, slots=True, eq=False)
class Sphere:
    """A solid sphere, centred on the origin.

    Parameters
    ----------
    radius : float
        [length unit]

    Raises
    ------
    InputError
        If it is not above zero.
    """

    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", _positive(self.radius, "radius of the sphere"))


@dataclass(frozen=True, slots=True, eq=False)
class Prism:
    """A polygon in the x-z plane, extruded along y, centred on y = 0.

    Parameters
    ----------
    polygon : array_like, shape (n, 2)
        Corners (x, z) in order, either way round [length unit].
    depth : float
        Along y [length unit].

    Raises
    ------
    InputError
        If the polygon has fewer than three corners, no area, or crosses itself.

    Examples
    --------
    >>> len(Prism([[0, 0], [4, 0], [4, 3]], depth=1).polygon)
    3
    """

    polygon: Any
    depth: float

    def __post_init__(self) -> None:
        polygon = frozen(self.polygon, (-1, 2))
        if len(polygon) < 3:
            raise InputError("polygon has fewer than 3 corners", hint="list 3 or more")
        if not np.isfinite(polygon).all():
            raise InputError("polygon has a number that is not finite", hint="give finite numbers")
        in_range(polygon, "polygon", tiny=True)
        area = _signed_area(polygon)
        if abs(area) <= POLYGON_AREA * float(np.ptp(polygon, axis=0).max()) ** 2:
            raise InputError("polygon has no area", hint="list its corners around its edge")
        if not _is_convex(polygon) and not _is_simple(polygon):
            raise InputError("polygon crosses itself", hint="list its corners around its edge")
        object.__setattr__(self, "polygon", polygon)
        object.__setattr__(self, "depth", _positive(self.depth, "depth of the polygon"))

    def __repr__(self) -> str:
        return f"Prism({len(self.polygon)} corners, depth={self.depth:g})"


class Mesh:
    """A closed surface of triangles.

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
        Corners [length unit].
    faces : array_like, shape (m, 3), or sequence of sequences of int
        Corners of each face by index; faces of more than three corners are cut into
        triangles.
    accuracy : float, optional
        How far a coordinate may be from the truth [length unit]. The default is the
        rounding of the numbers' own type (float32 or float64).

    Raises
    ------
    InputError
        If a vertex is not finite, an index is out of range, or a face has fewer than
        three corners. Whether the surface is closed is asked when the assembly is built.

    Examples
    --------
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> tetrahedron.triangles.shape
    (4, 3)
    """

    __slots__ = ("accuracy", "triangles", "vertices")

    vertices: Array
    triangles: Index
    accuracy: float

    def __init__(self, vertices: Any, faces: Any, *, accuracy: float | None = None) -> None:
        single = getattr(vertices, "dtype", None) == np.float32
        self.vertices = frozen(vertices, (-1, 3)) if len(vertices) else frozen(np.empty((0, 3)))
        bad = np.flatnonzero(~np.isfinite(self.vertices).all(axis=1))
        if len(bad):
            raise InputError(
                f"vertex {bad[0]} is {self.vertices[bad[0]].tolist()}",
                hint="give finite coordinates",
            )
        in_range(self.vertices, "a vertex", tiny=True)
        self.triangles = _triangles(self.vertices, faces)
        self.triangles.flags.writeable = False
        largest = float(np.abs(self.vertices).max(initial=0.0))
        self.accuracy = (
            largest * (2.0**-24 if single else 2.0**-53) if accuracy is None else float(accuracy)
        )

    def __repr__(self) -> str:
        return f"Mesh({len(self.vertices)} vertices, {len(self.triangles)} triangles)"


Shape = Box | Cylinder | Sphere | Prism | Mesh | Solid


def surface(shape: Shape) -> tuple[Array, Index]:
    """Vertices, shape (n, 3), and triangles, shape (m, 3), in the part's own frame.

    Cylinders and spheres are given as inscribed polyhedra.

    Examples
    --------
    >>> vertices, triangles = surface(Box([1, 1, 1]))
    >>> vertices.shape, triangles.shape
    ((8, 3), (12, 3))
    """
    if isinstance(shape, Mesh | Solid):
        return shape.vertices, shape.triangles
    if isinstance(shape, Box):
        return BOX_CORNERS * shape.size, BOX_TRIANGLES
    if isinstance(shape, Cylinder):
        angle = np.arange(CYLINDER_SIDES) * (2 * np.pi / CYLINDER_SIDES)
        circle = shape.radius * np.column_stack([np.cos(angle), np.sin(angle)])
        low = np.column_stack([circle, np.full(len(circle), -shape.height / 2)])
        return np.vstack([low, low + np.array([0, 0, shape.height])]), _extruded(CYLINDER_SIDES)
    if isinstance(shape, Sphere):
        vertices, triangles = _unit_sphere()
        return vertices * shape.radius, triangles
    polygon = shape.polygon
    if _signed_area(polygon) > 0:  # seen from -y, where x is right and z is up, it turns left
        polygon = polygon[::-1]
    n = len(polygon)
    flat = np.column_stack([polygon[:, 0], np.zeros(n), polygon[:, 1]])
    step = np.array([0, shape.depth / 2, 0])
    cap = None if _is_convex(polygon) else _cut(polygon)
    return np.vstack([flat - step, flat + step]), _extruded(n, cap)


def fan(n: int) -> Index:
    """Triangles of a convex polygon of n corners, shape (n - 2, 3)."""
    k = np.arange(1, n - 1)
    return np.column_stack([np.zeros_like(k), k, k + 1])


BOX_TRIANGLES: Index = BOX_QUADS[:, fan(4)].reshape(-1, 3)


def _extruded(n: int, cap: Index | None = None) -> Index:
    """A prism's triangles: corners 0..n-1 below, n..2n-1 above, turning left from above."""
    cap = fan(n) if cap is None else cap
    k = np.arange(n)
    j = (k + 1) % n
    sides = np.vstack([np.column_stack([k, j, j + n]), np.column_stack([k, j + n, k + n])])
    return np.vstack([cap[:, ::-1], cap + n, sides])


@lru_cache(maxsize=1)
def _unit_sphere() -> tuple[Array, Index]:
    rings, n = SPHERE_RINGS, 2 * SPHERE_RINGS
    polar = np.arange(1, rings) * (np.pi / rings)
    around = np.arange(n) * (2 * np.pi / n)
    grid = np.stack(
        [
            np.outer(np.sin(polar), np.cos(around)),
            np.outer(np.sin(polar), np.sin(around)),
            np.outer(np.cos(polar), np.ones(n)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    top, bottom = len(grid), len(grid) + 1
    k = np.arange(n)
    j = (k + 1) % n
    last = (rings - 2) * n
    bands = [
        np.vstack([np.column_stack([k, k + n, j + n]), np.column_stack([k, j + n, j])]) + r * n
        for r in range(rings - 2)
    ]
    caps = [
        np.column_stack([np.full(n, top), k, j]),
        np.column_stack([np.full(n, bottom), last + j, last + k]),
    ]
    return np.vstack([grid, [[0, 0, 1], [0, 0, -1]]]), np.vstack([*bands, *caps])


def _triangles(vertices: Array, faces: Any) -> Index:
    """Triangles of faces of three corners, or of mixed faces, cut."""
    if not isinstance(faces, np.ndarray):
        faces = list(faces)
    if isinstance(faces, np.ndarray) and faces.ndim == 2 and faces.shape[1] == 3:
        owner = np.repeat(np.arange(len(faces)), 3)
        return _checked(faces.reshape(-1), owner, len(vertices)).reshape(-1, 3)
    length = np.array([len(face) for face in faces], dtype=np.int64)
    if len(length) and length.min() < 3:
        k = int(length.argmin())
        raise InputError(f"face {k} has {length[k]} corners", hint="give 3 or more")
    owner = np.repeat(np.arange(len(length)), length)
    corners = _checked(list(chain.from_iterable(faces)), owner, len(vertices))
    first = np.cumsum(length) - length
    pieces = [np.empty((0, 3), dtype=np.int64)]
    for n in np.unique(length):
        which = np.flatnonzero(length == n)
        pieces += _cut_alike(vertices, corners[first[which][:, None] + np.arange(n)], which)
    return np.concatenate(pieces)


def _checked(corners: Any, face: Index, count: int) -> Index:
    """Corners as indices below `count`; an error names the face of the first wrong one."""
    try:
        array = np.asarray(corners)
        indices: Index = array.astype(np.int64)
        exact = array.dtype.kind in "iu" or bool((indices == array).all())
    except (TypeError, ValueError, OverflowError):
        exact = False
    if not exact:
        raise InputError(
            "a face has a corner that is not a whole number", hint="name corners by index"
        )
    wrong = np.flatnonzero((indices < 0) | (indices >= count))
    if len(wrong):
        raise InputError(
            f"face {face[wrong[0]]} names vertex {indices[wrong[0]]} of {count}",
            hint=f"use indices 0 to {count - 1}",
        )
    return indices


def _cut_alike(vertices: Array, faces: Index, number: Index) -> list[Index]:
    """Triangles of faces, shape (m, n); the convex ones in one go."""
    convex = _convex_in_space(vertices[faces])
    pieces = [faces[convex][:, fan(faces.shape[1])].reshape(-1, 3)]
    for k in np.flatnonzero(~convex):
        try:
            pieces.append(faces[k][_cut(_flattened(vertices[faces[k]]))])
        except InputError as error:
            raise InputError(f"face {number[k]} {error.what}", hint=error.hint) from None
    return pieces


def _convex_in_space(polygons: Array) -> Mask:
    """Which polygons, shape (m, n, 3), are convex about their mean normal."""
    following = np.arange(1, polygons.shape[1] + 1) % polygons.shape[1]
    step = polygons[:, following] - polygons
    turn = cross(step, step[:, following])
    local = polygons - polygons[:, :1]
    normal = cross(local, local[:, following]).sum(axis=1)
    along = np.einsum("mnk,mk->mn", turn, normal)
    # three or four corners that never turn back are convex; more could wind twice
    convex: Mask = (along > 0).all(axis=1)
    if polygons.shape[1] > 4:
        rows = np.flatnonzero(convex)
        convex[rows] = [_is_convex(_flattened(polygons[k])) for k in rows]
    return convex


def _flattened(points: Array) -> Array:
    """A polygon in space, shape (n, 3), in coordinates of its mean plane, turning left."""
    normal = 0.5 * np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    length = np.linalg.norm(normal)
    if length == 0.0:
        return np.array(points[:, :2])
    normal = normal / length
    u, v = across(normal)
    relative = points - points.mean(axis=0)
    return np.column_stack([relative @ u, relative @ v])


def _cut(polygon: Array) -> Index:
    """Triangles, by corner, of a polygon in its plane; turning as the polygon turns."""
    n = len(polygon)
    if n == 3 or _is_convex(polygon):
        return fan(n)
    import shapely

    # corners given back by their coordinates, so two corners in one place are not lost
    try:
        pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(shapely.Polygon(polygon)))
    except shapely.errors.GEOSException:
        raise InputError("crosses or touches itself", hint="cut it into triangles") from None
    corners = shapely.get_coordinates(pieces).reshape(-1, 4, 2)[:, :3]
    where = {tuple(p): k for k, p in enumerate(polygon.tolist())}
    rows = [[where[tuple(p)] for p in piece] for piece in corners.tolist()]
    cut = np.array(rows, dtype=np.int64).reshape(-1, 3)  # of a polygon of no area none
    areas = np.array([_signed_area(polygon[t]) for t in cut])
    whole = _signed_area(polygon)
    # an outline that rounding lets touch itself is cut all the same, if its area comes out
    if abs(np.abs(areas).sum() - abs(whole)) > CUT_AREA * abs(whole):
        raise InputError("crosses or touches itself", hint="cut it into triangles")
    turned = areas * whole < 0
    cut[turned] = cut[turned][:, ::-1]
    return cut


def _signed_area(polygon: Array) -> float:
    x, y = (polygon - polygon[0]).T
    return float(0.5 * (x @ np.roll(y, -1) - np.roll(x, -1) @ y))


def _is_convex(polygon: Array) -> bool:
    edge = np.roll(polygon, -1, axis=0) - polygon
    following = np.roll(edge, -1, axis=0)
    turn = edge[:, 0] * following[:, 1] - edge[:, 1] * following[:, 0]
    if not ((turn >= 0).all() or (turn <= 0).all()):
        return False
    angles = np.arctan2(turn, (edge * following).sum(axis=1))
    return bool(abs(abs(float(angles.sum())) - 2 * np.pi) < WHOLE_TURN)


def _is_simple(polygon: Array) -> bool:
    import shapely

    return bool(shapely.Polygon(polygon).is_valid)
