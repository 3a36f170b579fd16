"""Shapes of parts: box, cylinder, sphere, prism, mesh; each in the part's own frame.

Shapes are immutable; they copy their arrays and make them read-only. Lengths are in the unit of
the assembly. `surface(shape)` returns the triangulated surface of a shape; its triangles are
counterclockwise seen from outside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array, Index, Mask, across, cross
from kilter.errors import InputError
from kilter.rigid import Pose, in_brackets
from kilter.shape.shape_tolerances import CUT_AREA, POLYGON_AREA, WHOLE_TURN
from kilter.shape.solid import Solid
from kilter.validate import finite, frozen, in_range, number
from kilter.values.guesses import guarded
from kilter.values.value import Value

# The surface of the convex hull of points, as a closed mesh.


def hull_surface(points: Array) -> tuple[Array, Index]:
    """Vertices, shape (V, 3), and outward triangles, shape (T, 3), of the convex hull of points.

    Raises `InputError` if the points lie in a plane.

    Examples
    --------
    >>> vertices, triangles = hull_surface(np.vstack([np.eye(3), np.zeros(3), np.full(3, 0.1)]))
    >>> len(vertices), len(triangles)
    (4, 4)
    """
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):
        raise InputError(
            "the solid has no volume", hint="repair it in the program that made it"
        ) from None
    used, compact = np.unique(hull.simplices, return_inverse=True)
    triangles = compact.reshape(-1, 3).astype(np.int64)
    vertices = points[used]
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", cross(q - p, r - p), hull.equations[:, :3]) < 0
    triangles[inwards] = triangles[inwards][:, ::-1]
    return vertices, triangles


CYLINDER_SIDES = 96
"""Number of sides of the polygon inscribed in the circle of a cylinder, a multiple of 4."""
SPHERE_RINGS = 24
"""Number of rings of the polyhedron inscribed in a sphere."""

BOX_QUADS: Index = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
)
"""Faces of a box, shape (6, 4): -z, +z, -y, +y, -x, +x; corner k has bits x=1, y=2, z=4."""
BOX_CORNERS: Array = np.array(
    [[x - 0.5, y - 0.5, z - 0.5] for z in (0, 1) for y in (0, 1) for x in (0, 1)], dtype=float
)
"""Corners of the unit box, shape (8, 3), in the order of `BOX_QUADS`."""


def _positive(value: Any, what: str) -> float:
    """The value as a positive number; raises `InputError`, in which `what` names the value."""
    return number(value, what, lowest=0, above=True)


@guarded
@dataclass(frozen=True, slots=True, eq=False, init=False)
class Box(Value):
    """A solid box, centred on the origin.

    Parameters
    ----------
    size : array_like, shape (3,), or three numbers
        Lengths along x, y, z [length unit].

    Raises
    ------
    InputError
        If a length is not positive.

    Examples
    --------
    >>> Box([40, 20, 10]).size
    array([40., 20., 10.])
    >>> Box(40, 20, 10) == Box([40, 20, 10])
    True
    """

    size: Any

    def __init__(self, size: ArrayLike, *others: float) -> None:
        lengths: Any = (size, *others) if others else size
        size = frozen(lengths, (3,))
        if not (np.isfinite(size).all() and (size > 0).all()):
            raise InputError(
                f"the size of the box is {size.tolist()}", hint="give three lengths above zero"
            )
        in_range(size, "box")
        object.__setattr__(self, "size", size)

    def __repr__(self) -> str:
        return f"Box{in_brackets(self.size)}"


@guarded
@dataclass(frozen=True, slots=True, eq=False)
class Cylinder(Value):
    """A solid cylinder about the z axis, centred on the origin.

    Parameters
    ----------
    radius, height : float
        Radius, and length along z [length unit].

    Raises
    ------
    InputError
        If radius or height is not positive.
    """

    radius: float
    height: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", _positive(self.radius, "radius of the cylinder"))
        object.__setattr__(self, "height", _positive(self.height, "height of the cylinder"))


@guarded
@dataclass(frozen=True, slots=True, eq=False)
class Sphere(Value):
    """A solid sphere, centred on the origin.

    Parameters
    ----------
    radius : float
        Radius [length unit].

    Raises
    ------
    InputError
        If the radius is not positive.
    """

    radius: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "radius", _positive(self.radius, "radius of the sphere"))


@guarded
@dataclass(frozen=True, slots=True, eq=False)
class Prism(Value):
    """A solid prism: a polygon in the x-z plane, extruded along y, centred on y = 0.

    Parameters
    ----------
    polygon : array_like, shape (n, 2), or shapely.Polygon
        Corners (x, z) in order, in either sense [length unit].
    depth : float
        Length along y [length unit].

    Raises
    ------
    InputError
        If the polygon has fewer than three corners, no area, or crosses itself.

    Examples
    --------
    >>> len(Prism([[0, 0], [4, 0], [4, 3]], depth=1).polygon)
    3
    >>> import shapely
    >>> Prism(shapely.box(0, 0, 4, 3), 1) == Prism([[4, 0], [4, 3], [0, 3], [0, 0]], 1)
    True
    """

    polygon: Any
    depth: float

    def __post_init__(self) -> None:
        polygon = frozen(_outline(self.polygon), (-1, 2))
        if len(polygon) < 3:
            raise InputError("the polygon has fewer than 3 corners", hint="give 3 or more")
        if not np.isfinite(polygon).all():
            raise InputError(
                "the polygon has a number that is not finite", hint="give finite numbers"
            )
        in_range(polygon, "polygon", tiny=True)
        area = _signed_area(polygon)
        if abs(area) <= POLYGON_AREA * float(np.ptp(polygon, axis=0).max()) ** 2:
            raise InputError("the polygon has no area", hint="list its corners in order around it")
        if not _is_convex(polygon) and not _is_simple(polygon):
            raise InputError(
                "the polygon crosses itself", hint="list its corners in order around it"
            )
        object.__setattr__(self, "polygon", polygon)
        object.__setattr__(self, "depth", _positive(self.depth, "depth of the polygon"))

    def __repr__(self) -> str:
        return f"Prism({len(self.polygon)} corners, depth={self.depth:g})"


@guarded
class Mesh(Value):
    """A closed surface of triangles, as the shape of a part.

    Parameters
    ----------
    vertices : array_like, shape (n, 3)
        Vertices [length unit].
    faces : array_like, shape (m, 3), or sequence of sequences of int
        Vertices of each face by index; a face with more than three corners is divided into
        triangles.
    accuracy : float, optional
        Largest error of a coordinate [length unit]. The default is the rounding of the type of
        the numbers (float32 or float64).
    pieces : array_like of int, shape (m,), optional
        Number of the piece to which each triangle belongs. Contacts of different pieces may have
        different friction (`FrictionPair`). By default all triangles belong to piece 0.
    members : sequence of (shape, pose), optional
        Shapes of which the surface is the union, each with its pose in the frame of the mesh: a
        table of five boxes. They are exact where the triangles are not, and files of simulators
        keep them. They do not count in comparisons.
    member_pieces : sequence of int, optional
        Number of the piece to which each member belongs; by default piece 0.

    Raises
    ------
    InputError
        If a vertex is not finite, an index is out of range, a face has fewer than three corners, or
        there is not a piece for each triangle. The geometry of the assembly verifies later that
        the surface is closed.

    Examples
    --------
    >>> tetrahedron = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ...                    [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    >>> tetrahedron.triangles.shape
    (4, 3)
    """

    __slots__ = ("accuracy", "member_pieces", "members", "pieces", "triangles", "vertices")

    vertices: Array
    triangles: Index
    accuracy: float
    pieces: Index | None
    members: tuple[tuple[Shape, Pose], ...]
    member_pieces: tuple[int, ...]

    def __init__(
        self,
        vertices: Any,
        faces: Any,
        *,
        accuracy: float | None = None,
        pieces: Any = None,
        members: Sequence[tuple[Shape, Pose]] = (),
        member_pieces: Sequence[int] = (),
    ) -> None:
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
        self.pieces = None if pieces is None else _piece_numbers(pieces, len(self.triangles))
        self.members = tuple(members)
        self.member_pieces = tuple(member_pieces) or (0,) * len(self.members)

    @classmethod
    def convex_hull(cls, points: ArrayLike) -> Mesh:
        """The convex hull of points as a mesh.

        Parameters
        ----------
        points : array_like, shape (n, 3)
            Points [length unit].

        Raises
        ------
        InputError
            If the points lie in a plane, or a number is not finite.

        Examples
        --------
        >>> len(Mesh.convex_hull([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]).triangles)
        4
        """
        corners = finite(points, (-1, 3), "points")
        try:
            return cls(*hull_surface(corners))
        except InputError:
            raise InputError(
                "the points lie in a plane", hint="give four points or more that enclose a volume"
            ) from None

    def _content(self) -> tuple[Any, ...]:
        pieces = () if self.pieces is None else (self.pieces,)
        return self.vertices, self.triangles, self.accuracy, *pieces

    def __repr__(self) -> str:
        return f"Mesh({len(self.vertices)} vertices, {len(self.triangles)} triangles)"


def _piece_numbers(pieces: Any, count: int) -> Index | None:
    """Piece of each of `count` triangles; None if all belong to piece 0.

    Raises `InputError` if the numbers are not `count` integers from 0 on.
    """
    try:
        given = np.asarray(pieces)
        numbers: Index = given.astype(np.int64)
        sound = numbers.shape == (count,) and bool((numbers == given).all())
        sound = sound and bool((numbers >= 0).all())
    except (TypeError, ValueError, OverflowError):
        sound = False
    if not sound:
        raise InputError(
            "the pieces of the mesh are invalid",
            hint=f"give an integer from 0 on for each of the {count} triangles",
        )
    if not numbers.any():
        return None
    numbers.flags.writeable = False
    return numbers


def _outline(polygon: Any) -> Any:
    """Corners of a polygon, which may be a polygon of shapely without holes."""
    if not hasattr(polygon, "exterior"):
        return polygon
    if len(polygon.interiors):
        raise InputError(
            f"the polygon has {len(polygon.interiors)} holes", hint="give a mesh of the solid"
        )
    corners = np.asarray(polygon.exterior.coords)
    return corners[:-1, :2]  # the first corner is repeated at the end


Shape = Box | Cylinder | Sphere | Prism | Mesh | Solid


def piece_count(shape: Shape) -> int:
    """Number of pieces of a shape; only meshes have several."""
    several = isinstance(shape, Mesh) and shape.pieces is not None
    return int(shape.pieces.max()) + 1 if several else 1  # type: ignore[union-attr]


def surface(shape: Shape) -> tuple[Array, Index]:
    """Vertices, shape (n, 3), and triangles, shape (m, 3), of the surface of any shape.

    The frame is that of the part. Cylinders and spheres become inscribed polyhedra.

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
        return np.vstack([low, low + np.array([0, 0, shape.height])]), _prism_triangles(
            CYLINDER_SIDES
        )
    if isinstance(shape, Sphere):
        vertices, triangles = _unit_sphere()
        return vertices * shape.radius, triangles
    polygon = shape.polygon
    if _signed_area(polygon) > 0:  # counterclockwise seen from -y, with x right and z up
        polygon = polygon[::-1]
    n = len(polygon)
    flat = np.column_stack([polygon[:, 0], np.zeros(n), polygon[:, 1]])
    step = np.array([0, shape.depth / 2, 0])
    cap = None if _is_convex(polygon) else _triangulate(polygon)
    return np.vstack([flat - step, flat + step]), _prism_triangles(n, cap)


def fan(n: int) -> Index:
    """Triangles of a convex polygon with n corners, as corner numbers, shape (n - 2, 3)."""
    k = np.arange(1, n - 1)
    return np.column_stack([np.zeros_like(k), k, k + 1])


BOX_TRIANGLES: Index = BOX_QUADS[:, fan(4)].reshape(-1, 3)
"""Triangles of a box, shape (12, 3)."""


def _prism_triangles(n: int, cap: Index | None = None) -> Index:
    """Triangles of a prism whose corners are 0 to n - 1 below and n to 2 n - 1 above.

    The corners are counterclockwise seen from above. `cap`: triangles of the polygon, shape
    (m, 3); default a fan.
    """
    cap = fan(n) if cap is None else cap
    k = np.arange(n)
    j = (k + 1) % n
    sides = np.vstack([np.column_stack([k, j, j + n]), np.column_stack([k, j + n, k + n])])
    return np.vstack([cap[:, ::-1], cap + n, sides])


@lru_cache(maxsize=1)
def _unit_sphere() -> tuple[Array, Index]:
    """Vertices and triangles of a polyhedron inscribed in the unit sphere."""
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
    """Triangles, shape (m, 3), into which faces with any number of corners are divided."""
    if not isinstance(faces, np.ndarray):
        faces = list(faces)
    if isinstance(faces, np.ndarray) and faces.ndim == 2 and faces.shape[1] == 3:
        owner = np.repeat(np.arange(len(faces)), 3)
        return _vertex_indices(faces.reshape(-1), owner, len(vertices)).reshape(-1, 3)
    length = np.array([len(face) for face in faces], dtype=np.int64)
    if len(length) and length.min() < 3:
        k = int(length.argmin())
        raise InputError(f"face {k} has {length[k]} corners", hint="give 3 or more")
    owner = np.repeat(np.arange(len(length)), length)
    corners = _vertex_indices(list(chain.from_iterable(faces)), owner, len(vertices))
    first = np.cumsum(length) - length
    pieces = [np.empty((0, 3), dtype=np.int64)]
    for n in np.unique(length):
        which = np.flatnonzero(length == n)
        same_length = corners[first[which][:, None] + np.arange(n)]
        pieces += _triangulate_faces(vertices, same_length, which)
    return np.concatenate(pieces)


def _vertex_indices(corners: Any, face: Index, count: int) -> Index:
    """Corners of a face as vertex numbers; raises `InputError` for numbers from `count` on.

    `face`: the face of each corner.
    """
    try:
        array = np.asarray(corners)
        indices: Index = array.astype(np.int64)
        exact = array.dtype.kind in "iu" or bool((indices == array).all())
    except (TypeError, ValueError, OverflowError):
        exact = False
    if not exact:
        raise InputError(
            "a face has a corner that is not an integer", hint="give the indices of vertices"
        )
    wrong = np.flatnonzero((indices < 0) | (indices >= count))
    if len(wrong):
        raise InputError(
            f"face {face[wrong[0]]} names vertex {indices[wrong[0]]} of {count}",
            hint=f"use indices 0 to {count - 1}",
        )
    return indices


def _triangulate_faces(vertices: Array, faces: Index, number: Index) -> list[Index]:
    """Triangles of m faces with n corners each; convex faces are divided without a search.

    `number`: the number of each face, for messages.
    """
    convex = _convex_in_space(vertices[faces])
    pieces = [faces[convex][:, fan(faces.shape[1])].reshape(-1, 3)]
    for k in np.flatnonzero(~convex):
        try:
            pieces.append(faces[k][_triangulate(_plane_coordinates(vertices[faces[k]]))])
        except InputError as error:
            raise InputError(f"face {number[k]} {error.what}", hint=error.hint) from None
    return pieces


def _convex_in_space(polygons: Array) -> Mask:
    """Mask of polygons, shape (m, n, 3), that are convex in their mean plane, shape (m,)."""
    following = np.arange(1, polygons.shape[1] + 1) % polygons.shape[1]
    step = polygons[:, following] - polygons
    turn = cross(step, step[:, following])
    local = polygons - polygons[:, :1]
    normal = cross(local, local[:, following]).sum(axis=1)
    along = np.einsum("mnk,mk->mn", turn, normal)
    # a polygon with more than four corners may turn by 720 degrees
    convex: Mask = (along > 0).all(axis=1)
    if polygons.shape[1] > 4:
        rows = np.flatnonzero(convex)
        convex[rows] = [_is_convex(_plane_coordinates(polygons[k])) for k in rows]
    return convex


def _plane_coordinates(points: Array) -> Array:
    """Coordinates of a polygon's corners in its mean plane, counterclockwise, shape (n, 2)."""
    normal = 0.5 * np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0)
    length = np.linalg.norm(normal)
    if length == 0.0:
        return np.array(points[:, :2])
    normal = normal / length
    u, v = across(normal)
    relative = points - points.mean(axis=0)
    return np.column_stack([relative @ u, relative @ v])


def _triangulate(polygon: Array) -> Index:
    """Triangles of a plane polygon, as corner numbers, with the winding of the polygon.

    Raises `InputError` if the polygon crosses or touches itself.
    """
    n = len(polygon)
    if n == 3 or _is_convex(polygon):
        return fan(n)
    import shapely

    # corners are identified by their coordinates, which shapely does not change
    try:
        pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(shapely.Polygon(polygon)))
    except shapely.errors.GEOSException:
        raise InputError("crosses or touches itself", hint="divide it into triangles") from None
    corners = shapely.get_coordinates(pieces).reshape(-1, 4, 2)[:, :3]
    index = {tuple(p): k for k, p in enumerate(polygon.tolist())}
    rows = [[index[tuple(p)] for p in piece] for piece in corners.tolist()]
    cut = np.array(rows, dtype=np.int64).reshape(-1, 3)  # empty for a polygon without area
    areas = np.array([_signed_area(polygon[t]) for t in cut])
    whole = _signed_area(polygon)
    # an outline that touches itself only by rounding is accepted if the area agrees
    if abs(np.abs(areas).sum() - abs(whole)) > CUT_AREA * abs(whole):
        raise InputError("crosses or touches itself", hint="divide it into triangles")
    turned = areas * whole < 0
    cut[turned] = cut[turned][:, ::-1]
    return cut


def _signed_area(polygon: Array) -> float:
    """Area of a plane polygon, positive if its corners run counterclockwise."""
    x, y = (polygon - polygon[0]).T
    return float(0.5 * (x @ np.roll(y, -1) - np.roll(x, -1) @ y))


def _is_convex(polygon: Array) -> bool:
    """Whether a plane polygon is convex: it turns in one sense only, by 360 degrees."""
    edge = np.roll(polygon, -1, axis=0) - polygon
    following = np.roll(edge, -1, axis=0)
    turn = edge[:, 0] * following[:, 1] - edge[:, 1] * following[:, 0]
    if not ((turn >= 0).all() or (turn <= 0).all()):
        return False
    angles = np.arctan2(turn, (edge * following).sum(axis=1))
    return bool(abs(abs(float(angles.sum())) - 2 * np.pi) < WHOLE_TURN)


def _is_simple(polygon: Array) -> bool:
    """Whether a plane polygon does not cross itself."""
    import shapely

    return bool(shapely.Polygon(polygon).is_valid)
