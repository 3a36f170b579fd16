"""Convex pieces of parts in the frames of the parts, and their arrays in the world.

A part is covered by convex pieces if its shape is a box, a cylinder, a sphere, a convex prism, a
convex mesh, a convex solid with flat faces, or a mesh of such members. A piece is a polytope, a
cylinder, or a point or segment with a rounding radius: a sphere or a capsule.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np

from kilter.arrays import Array, Index, Mask, connected, counted, cross, starts
from kilter.assembly import Assembly
from kilter.contact.convex_tolerances import (
    CONVEX_VOLUME,
    INNER,
    LEVEL,
    NO_AREA,
    ON_PLANE,
    SAME_PLANE,
)
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.shape.closed import signed_volume
from kilter.shape.primitives import (
    BOX_CORNERS,
    Box,
    Cylinder,
    Mesh,
    Shape,
    Sphere,
    hull_surface,
    surface,
)
from kilter.shape.solid import Solid

SIDES = 32
"""Number of sides of the prism that starts the search for the nearest points of a cylinder."""
EVEN_ANGLES: Array = np.linspace(0.0, 2 * np.pi, SIDES, endpoint=False)
"""Angles of the corners of this prism [rad], shape (SIDES,)."""
ROUNDED = 2.0
"""The same, over the volume between the hull and its offset by the errors of coordinates [-]."""
LYING = 0.3
"""Cosine of the angle between a normal and the axis of a cylinder below which it lies [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Polytope:
    """A convex polytope, or a point or segment, with a rounding radius."""

    vertex: Array
    normal: Array
    offset: Array
    """Faces: normal . x <= offset; shapes (F, 3), (F,)."""
    edge: Index
    """Vertices of each edge, shape (E, 2), and faces on both sides; -1 without faces. The edge
    points along normal[face 0] x normal[face 1]."""
    edge_face: Index
    radius: float = 0.0
    disc: float = 0.0
    """Radius of a cylinder, 0 for all other pieces [length unit]."""
    axis: Array | None = None
    """Half the axis of a cylinder, from its middle to the middle of its cap, shape (3,)."""
    middle: Array | None = None


@dataclass(frozen=True, slots=True, eq=False)
class ConvexPieces:
    """Convex pieces of the parts of an assembly, in the frames of the parts."""

    part: Index
    """Part of each piece, shape (P,)."""
    whole: Mask
    """Whether convex pieces cover a part completely, shape (N,)."""
    radius: Array
    """Rounding radius of each piece [length unit], shape (P,)."""
    disc: Array
    """Radius of the cylinders, 0 for other pieces [length unit], shape (P,)."""
    axis: Array
    middle: Array
    """Half the axis of each cylinder, and the middle of each piece, shape (P, 3)."""
    size: Array
    """Diagonal of the box around each piece [length unit], shape (P,)."""
    vertex_start: Index
    face_start: Index
    edge_start: Index
    """First row of each piece, shape (P + 1,)."""
    vertex: Array
    normal: Array
    offset: Array
    inner: Mask
    """Faces that other pieces of the part cover, shape (F,)."""
    edge: Index
    """Vertices of each edge, counted within the piece, shape (E, 2)."""
    edge_face: Index
    """Faces on both sides of each edge, counted within the piece, shape (E, 2); -1: none."""
    beside_start: Index
    beside: Index
    """Pieces of the same part near each piece: rows beside_start[p] to beside_start[p + 1]."""

    @property
    def several(self) -> Mask:
        """Parts that consist of more than one piece, shape (N,)."""
        return np.bincount(self.part, minlength=len(self.whole)) > 1

    def __len__(self) -> int:
        return len(self.part)


MOST_SHAPES = 500
"""Number of shapes whose pieces are kept."""
_known: dict[int, tuple[Shape, list[Polytope] | None]] = {}
"""The last shapes and their pieces, by the identity of the shape: states of a scene share theirs.
"""


def convex_pieces(assembly: Assembly) -> ConvexPieces:
    """Divide the parts of an assembly into convex pieces, in the frames of the parts."""
    blocks: list[Polytope] = []
    owner: list[int] = []
    whole = np.zeros(len(assembly.parts), dtype=bool)
    for k, part in enumerate(assembly.parts):
        pieces = _known_pieces(part.shape)
        whole[k] = pieces is not None
        blocks += pieces or []
        owner += [k] * len(pieces or [])
    return _joined(blocks, np.array(owner, dtype=np.int64), whole)


def _known_pieces(shape: Shape) -> list[Polytope] | None:
    """The pieces of a shape, as `_pieces_of`, which are computed once."""
    if id(shape) not in _known:
        if len(_known) >= MOST_SHAPES:
            _known.clear()
        _known[id(shape)] = shape, _pieces_of(shape)
    return _known[id(shape)][1]


def _joined(blocks: Sequence[Polytope], part: Index, whole: Mask) -> ConvexPieces:
    """Arrays of all pieces."""
    zero = np.zeros(3)

    def stacked(name: str, *row: int, kind: type = float) -> Array:
        empty: Array = np.empty((0, *row), dtype=kind)
        result: Array = np.concatenate([empty, *(getattr(block, name) for block in blocks)])
        return result

    vertex, normal, offset = stacked("vertex", 3), stacked("normal", 3), stacked("offset")
    vertex_start = starts([len(block.vertex) for block in blocks])
    face_start = starts([len(block.normal) for block in blocks])
    middle = [
        block.vertex.mean(axis=0) if block.middle is None else block.middle for block in blocks
    ]
    size = [
        float(np.linalg.norm(np.ptp(block.vertex, axis=0))) + 2 * block.radius for block in blocks
    ]
    beside_start, beside = _beside(blocks, part)
    pieces = ConvexPieces(
        part,
        whole,
        np.array([block.radius for block in blocks]),
        np.array([block.disc for block in blocks]),
        np.array([zero if block.axis is None else block.axis for block in blocks]).reshape(-1, 3),
        np.array(middle).reshape(-1, 3),
        np.array(size),
        vertex_start,
        face_start,
        starts([len(block.edge) for block in blocks]),
        vertex,
        normal,
        offset,
        np.zeros(len(normal), dtype=bool),
        stacked("edge", 2, kind=np.int64),  # type: ignore[arg-type]
        stacked("edge_face", 2, kind=np.int64),  # type: ignore[arg-type]
        beside_start,
        beside,
    )
    pieces.inner[:] = _inner_faces(pieces)
    return pieces


def _beside(blocks: Sequence[Polytope], part: Index) -> tuple[Index, Index]:
    """Pieces of the same part whose boxes meet, as rows of each piece: start, pieces."""
    if not blocks:
        return np.zeros(1, dtype=np.int64), np.empty(0, dtype=np.int64)
    grow = [
        block.radius + INNER * float(np.ptp(block.vertex, axis=0).max()) + block.disc / 100
        for block in blocks
    ]
    low = np.array([block.vertex.min(axis=0) - g for block, g in zip(blocks, grow, strict=True)])
    high = np.array([block.vertex.max(axis=0) + g for block, g in zip(blocks, grow, strict=True)])
    first, count = np.searchsorted(part, part), np.bincount(part)[part]
    row, place = counted(count)
    other = first[row] + place
    near = other != row
    for axis in range(3):
        near[near] = (low[row[near], axis] <= high[other[near], axis]) & (
            low[other[near], axis] <= high[row[near], axis]
        )
    return starts(np.bincount(row[near], minlength=len(part))), other[near]


def _pieces_of(shape: Shape) -> list[Polytope] | None:
    """Convex pieces of a shape in its own frame; None if they do not cover it."""
    if isinstance(shape, Sphere):
        return [_rounded(np.zeros((1, 3)), shape.radius)]
    if isinstance(shape, Cylinder):
        return [_cylinder(shape)]
    if isinstance(shape, Box):
        return [_box(shape.size)]
    if isinstance(shape, Mesh) and shape.members:
        ends = _capsule_ends(shape)
        if ends is not None:
            return [_rounded(*ends)]
        found = [(_pieces_of(member), pose) for member, pose in shape.members]
        if any(pieces is None for pieces, _ in found):
            return None
        return [_moved(piece, pose) for pieces, pose in found for piece in pieces or []]
    if isinstance(shape, Solid) and any(surface.kind != "plane" for surface in shape.surfaces):
        return None
    vertices, triangles = surface(shape)
    hull = _hull(vertices)
    if hull is None:
        return None
    piece, filled, area = hull
    content = shape.volume if isinstance(shape, Solid) else abs(signed_volume(vertices, triangles))
    error = ROUNDED * area * shape.accuracy if isinstance(shape, Mesh | Solid) else 0.0
    return [piece] if abs(content - filled) <= max(CONVEX_VOLUME * filled, error) else None


def _capsule_ends(mesh: Mesh) -> tuple[Array, float] | None:
    """Ends of the axis of a capsule, shape (2, 3), and its radius; None for other meshes."""
    if len(mesh.members) != 3:
        return None
    bars = [(shape, pose) for shape, pose in mesh.members if isinstance(shape, Cylinder)]
    balls = [(shape, pose) for shape, pose in mesh.members if isinstance(shape, Sphere)]
    if len(bars) != 1 or len(balls) != 2:
        return None
    bar, pose = bars[0]
    ends = pose.apply(np.array([[0.0, 0.0, -bar.height / 2], [0.0, 0.0, bar.height / 2]]))
    given = np.array([pose.position for _, pose in balls])
    slack = CONVEX_VOLUME * (bar.radius + bar.height)
    equal = all(abs(ball.radius - bar.radius) <= slack for ball, _ in balls)
    if equal and min(np.abs(ends - given).max(), np.abs(ends - given[::-1]).max()) <= slack:
        return ends, bar.radius
    return None


def _rounded(ends: Array, radius: float) -> Polytope:
    """A sphere about a point, shape (1, 3), or a capsule about a segment, shape (2, 3)."""
    edge = np.array([[0, 1]] * (len(ends) - 1), dtype=np.int64).reshape(-1, 2)
    none = np.empty((0, 3)), np.empty(0)
    return Polytope(ends, *none, edge, np.full_like(edge, -1), radius)


def _box(size: Array) -> Polytope:
    """A box about the origin."""
    normal = np.repeat(np.eye(3), 2, axis=0) * np.tile([-1.0, 1.0], 3)[:, None]
    bits = np.arange(8)
    pairs = [(k, k | 1 << axis) for axis in range(3) for k in bits if not k >> axis & 1]
    edge = np.array(pairs, dtype=np.int64)
    face = np.array(
        [
            [2 * other + (low >> other & 1) for other in range(3) if not (low ^ high) >> other & 1]
            for low, high in pairs
        ]
    )
    return _oriented(BOX_CORNERS * size, normal, np.repeat(size / 2, 2), edge, face)


def _oriented(vertex: Array, normal: Array, offset: Array, edge: Index, face: Index) -> Polytope:
    """A polytope whose edges point along the cross product of the normals beside them."""
    along = np.einsum(
        "ei,ei->e",
        cross(normal[face[:, 0]], normal[face[:, 1]]),
        vertex[edge[:, 1]] - vertex[edge[:, 0]],
    )
    edge = np.where((along < 0)[:, None], edge[:, ::-1], edge)
    return Polytope(vertex, normal, offset, edge, face)


def _cylinder(shape: Cylinder) -> Polytope:
    """The prism inscribed in a cylinder, with the exact radius and axis."""
    axis = np.array([[0.0, 0.0, shape.height / 2]])
    vertex, normal, offset = prism_of(
        np.zeros((1, 3)), axis, np.array([shape.radius]), EVEN_ANGLES[None]
    )
    prism = _oriented(vertex[0], normal[0], offset[0], *_prism_edges())
    return replace(prism, disc=shape.radius, axis=axis[0], middle=np.zeros(3))


def prism_of(middle: Array, axis: Array, radius: Array, angle: Array) -> tuple[Array, Array, Array]:
    """Vertices, normals and offsets of prisms inscribed in cylinders.

    Arguments: `middle`, `axis` (K, 3): middle, and half the axis; `radius` (K,); `angle` (K, n):
    ascending angles of the corners. Returns shapes (K, 2 n, 3), (K, n + 2, 3), (K, n + 2).
    """
    half = np.linalg.norm(axis, axis=1)
    along = axis / half[:, None]
    u, v = across_axis(along)
    corner = np.cos(angle)[..., None] * u[:, None] + np.sin(angle)[..., None] * v[:, None]
    rim = corner * radius[:, None, None] + middle[:, None]
    vertex = np.concatenate([rim - axis[:, None], rim + axis[:, None]], axis=1)
    turn = np.roll(angle, -1, axis=1) - angle
    turn[:, -1] += 2 * np.pi
    mean = angle + turn / 2
    side = np.cos(mean)[..., None] * u[:, None] + np.sin(mean)[..., None] * v[:, None]
    normal = np.concatenate([side, -along[:, None], along[:, None]], axis=1)
    level = np.einsum("ki,ki->k", along, middle)
    apart = np.einsum("kni,ki->kn", side, middle) + radius[:, None] * np.cos(turn / 2)
    offset = np.concatenate([apart, (half - level)[:, None], (half + level)[:, None]], axis=1)
    return vertex, normal, offset


def across_axis(along: Array) -> tuple[Array, Array]:
    """Unit vectors u, v across unit vectors, each of shape (K, 3); u x v = along."""
    u = cross(np.eye(3)[np.abs(along).argmin(axis=-1)], along)
    u /= np.linalg.norm(u, axis=-1, keepdims=True)
    return u, cross(along, u)


def _prism_edges() -> tuple[Index, Index]:
    """Edges of the prism of a cylinder, and the faces beside them; each of shape (3 n, 2)."""
    k = np.arange(SIDES)
    following, before = (k + 1) % SIDES, (k - 1) % SIDES
    low, up = np.column_stack([k, following]), np.column_stack([k, k + SIDES])
    beside = [np.full(SIDES, SIDES), np.full(SIDES, SIDES + 1), before]
    edge = np.concatenate([low, low + SIDES, up])
    return edge, np.column_stack([np.tile(k, 3), np.concatenate(beside)])


def _hull(points: Array) -> tuple[Polytope, float, float] | None:
    """Convex hull of points with coplanar triangles united, its volume and area; None without."""
    try:
        vertex, triangles = hull_surface(points)
    except InputError:
        return None
    p, q, r = (vertex[triangles[:, k]] for k in range(3))
    normal = cross(q - p, r - p)
    area = np.linalg.norm(normal, axis=1)
    normal = normal / np.maximum(area, np.finfo(float).tiny)[:, None]
    size = float(np.linalg.norm(np.ptp(vertex, axis=0)))
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    owner = np.tile(np.arange(len(triangles)), 3)
    order = np.lexsort(np.sort(sides, axis=1).T)
    first, second = order[::2], order[1::2]
    i, j = owner[first], owner[second]
    sine = np.linalg.norm(cross(normal[i], normal[j]), axis=1)
    # a sliver has no sure normal: it joins the face beside it
    thin = np.minimum(area[i], area[j]) <= NO_AREA * size * size
    flat = (sine <= SAME_PLANE) | thin
    label = connected(len(triangles), i[flat], j[flat])
    face_count = int(label.max()) + 1
    largest = np.lexsort((-area, label))[np.searchsorted(np.sort(label), np.arange(face_count))]
    normals = normal[largest]
    height = np.einsum("tki,ti->tk", vertex[triangles], normals[label]).max(axis=1)
    offset = np.full(face_count, -np.inf)
    np.maximum.at(offset, label, height)
    sharp = ~flat & (label[i] != label[j])
    edge, face = sides[first[sharp]], np.column_stack([label[i], label[j]])[sharp]
    used, compact = np.unique(edge, return_inverse=True)
    piece = _oriented(vertex[used], normals, offset, compact.reshape(-1, 2), face)
    return piece, abs(signed_volume(vertex, triangles)), float(area.sum()) / 2


def _moved(piece: Polytope, pose: Pose) -> Polytope:
    """A piece in the frame of the compound."""
    turn, step = pose.matrix, pose.position
    normal = piece.normal @ turn.T
    return Polytope(
        piece.vertex @ turn.T + step,
        normal,
        piece.offset + normal @ step,
        piece.edge,
        piece.edge_face,
        piece.radius,
        piece.disc,
        None if piece.axis is None else turn @ piece.axis,
        None if piece.middle is None else turn @ piece.middle + step,
    )


def _inner_faces(pieces: ConvexPieces) -> Mask:
    """Faces whose corners and middle, moved outwards a little, lie in other pieces of the part."""
    inner = np.zeros(len(pieces.normal), dtype=bool)
    faced = np.diff(pieces.face_start) > 0
    for k in np.flatnonzero(faced & (np.diff(pieces.beside_start) > 0)).tolist():
        others = pieces.beside[pieces.beside_start[k] : pieces.beside_start[k + 1]]
        covered = _covered(pieces, k, others[faced[others]])
        inner[pieces.face_start[k] : pieces.face_start[k + 1]] = covered
    return inner


def _covered(pieces: ConvexPieces, piece: int, others: Index) -> Mask:
    """Faces of a piece that other pieces cover, shape (F,)."""
    span = slice(pieces.face_start[piece], pieces.face_start[piece + 1])
    normal, offset = pieces.normal[span], pieces.offset[span]
    vertex = pieces.vertex[pieces.vertex_start[piece] : pieces.vertex_start[piece + 1]]
    size = pieces.size[piece]
    on = np.abs(vertex @ normal.T - offset) <= ON_PLANE * size
    face, corner = np.nonzero(on.T)
    middle = on.T.astype(float) @ vertex / np.maximum(on.sum(axis=0), 1)[:, None]
    # corners a little inwards, since neighbours may end at the same edge
    points = vertex[corner] + INNER * (middle[face] - vertex[corner])
    points = np.concatenate([points, middle])
    face = np.concatenate([face, np.arange(len(normal))])
    points = points + INNER * size * normal[face]
    inside = np.zeros(len(points), dtype=bool)
    for other in others.tolist():
        rows = slice(pieces.face_start[other], pieces.face_start[other + 1])
        inside |= (points @ pieces.normal[rows].T <= pieces.offset[rows]).all(axis=1)
    free: Index = np.bincount(face[~inside], minlength=len(normal))
    return np.equal(free, 0)


@dataclass(frozen=True, slots=True, eq=False)
class Cores:
    """Cores of K pieces in the world frame, padded to equal numbers.

    A vertex may be repeated. A face that only fills the array has the normal 0 and the offset inf.
    """

    vertex: Array
    """Shape (K, V, 3)."""
    normal: Array
    offset: Array
    """Shapes (K, F, 3), (K, F)."""
    edge: Index
    edge_face: Index
    """Shape (K, E, 2)."""
    edges: Mask
    """Edges that exist, shape (K, E)."""
    sides: Index
    """Number of the first faces that stand for the side of a cylinder, shape (K,)."""

    @property
    def bare(self) -> Mask:
        """Whether a core is a point or a line without faces, shape (K,)."""
        return np.asarray(~np.isfinite(self.offset).any(axis=1))

    def take(self, rows: Index | Mask) -> Cores:
        """The cores of some rows."""
        return Cores(*(getattr(self, f.name)[rows] for f in fields(self)))


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """All pieces in the world frame."""

    pieces: ConvexPieces
    vertex: Array
    normal: Array
    offset: Array
    axis: Array
    middle: Array
    low: Array
    high: Array
    """Corners of the box around each piece, shape (P, 3)."""

    def cores(self, which: Index, direction: Array | None = None) -> Cores:
        """Padded cores of pieces.

        `direction` (K, 3): a corner of the prism of each cylinder lies along it or against it.
        """
        pieces = self.pieces
        vertex = padded_rows(pieces.vertex_start, which)[0]
        face, has = padded_rows(pieces.face_start, which)
        edge, edges = padded_rows(pieces.edge_start, which)
        if not len(self.normal):
            normal, offset = np.zeros((*face.shape, 3)), np.full(face.shape, np.inf)
        else:
            normal = np.where(has[..., None], self.normal[face], 0.0)
            offset = np.where(has, self.offset[face], np.inf)
        if not len(pieces.edge):
            ends = sides = np.zeros((*edge.shape, 2), dtype=np.int64)
        else:
            ends = np.where(edges[..., None], pieces.edge[edge], 0)
            sides = np.where(edges[..., None], pieces.edge_face[edge], -1)
        number = np.where(pieces.disc[which] > 0, SIDES, 0)
        result = Cores(self.vertex[vertex], normal, offset, ends, sides, edges, number)
        if direction is not None:
            self._turn_prisms(result, which, direction)
        return result

    def _turn_prisms(self, cores: Cores, which: Index, direction: Array) -> None:
        """Turn the prisms of cylinders to directions, shape (K, 3)."""
        rows = np.flatnonzero(cores.sides)
        if not len(rows):
            return
        piece = which[rows]
        axis = self.axis[piece]
        u, v = across_axis(axis / np.linalg.norm(axis, axis=1, keepdims=True))
        x, y = (np.einsum("ki,ki->k", e, direction[rows]) for e in (u, v))
        # for a direction along the axis, the prism stays as it is in the frame of the part
        first = np.where(np.hypot(x, y) > LEVEL, np.arctan2(y, x), 0.0)
        angle = first[:, None] + EVEN_ANGLES
        prism = prism_of(self.middle[piece], axis, self.pieces.disc[piece], angle)
        vertex, normal, offset = prism
        cores.vertex[rows, : vertex.shape[1]] = vertex
        cores.normal[rows, : normal.shape[1]] = normal
        cores.offset[rows, : offset.shape[1]] = offset


def with_generators(cores: Cores, slope: Array, sign: float) -> None:
    """Replace prisms on their side by their line farthest along `sign` times the direction.

    A cylinder on its side meets other pieces at this line only. `slope` (K,): cosine of the angle
    between direction and axis.
    """
    rows = np.flatnonzero((cores.sides > 0) & (np.abs(slope) < LYING))
    if not len(rows):
        return
    k = 0 if sign > 0 else SIDES // 2
    ends = cores.vertex[rows, k], cores.vertex[rows, k + SIDES]
    cores.vertex[rows] = ends[0][:, None]
    cores.vertex[rows, 1] = ends[1]
    cores.normal[rows], cores.offset[rows] = 0.0, np.inf
    cores.edges[rows] = False
    cores.edges[rows, 0] = True
    cores.edge[rows, 0], cores.edge_face[rows, 0] = [0, 1], -1


def padded_rows(start: Index, which: Index) -> tuple[Index, Mask]:
    """Rows of each of some groups, padded with the last row, and a mask of the real rows."""
    first, count = start[which], start[which + 1] - start[which]
    k = np.arange(max(int(count.max(initial=0)), 1))
    rows = first[:, None] + np.minimum(k, np.maximum(count - 1, 0)[:, None])
    return np.minimum(rows, max(int(start[-1]) - 1, 0)), k < count[:, None]


def placed(pieces: ConvexPieces, rotation: Array, position: Array) -> Placed:
    """Place all pieces: x -> rotation[k] x + position[k] for part k."""
    of_vertex = pieces.part[counted(np.diff(pieces.vertex_start))[0]]
    of_face = pieces.part[counted(np.diff(pieces.face_start))[0]]
    vertex = np.einsum("vij,vj->vi", rotation[of_vertex], pieces.vertex) + position[of_vertex]
    normal = np.einsum("vij,vj->vi", rotation[of_face], pieces.normal)
    offset = pieces.offset + np.einsum("vi,vi->v", normal, position[of_face])
    axis = np.einsum("pij,pj->pi", rotation[pieces.part], pieces.axis)
    middle = np.einsum("pij,pj->pi", rotation[pieces.part], pieces.middle) + position[pieces.part]
    first = pieces.vertex_start[:-1]
    if not len(first):
        return Placed(pieces, vertex, normal, offset, axis, middle, middle, middle)
    low = np.minimum.reduceat(vertex, first) - pieces.radius[:, None]
    high = np.maximum.reduceat(vertex, first) + pieces.radius[:, None]
    round_ = pieces.disc > 0
    if round_.any():
        half = np.linalg.norm(axis[round_], axis=1, keepdims=True)
        wide = np.sqrt(np.maximum(1 - (axis[round_] / half) ** 2, 0))
        reach = np.abs(axis[round_]) + wide * pieces.disc[round_, None]
        low[round_], high[round_] = middle[round_] - reach, middle[round_] + reach
    return Placed(pieces, vertex, normal, offset, axis, middle, low, high)
