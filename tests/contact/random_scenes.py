"""Random assemblies whose parts touch face to face, by family and seed, for the contact tests."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull, Voronoi

from kilter.assembly import Assembly, Part
from kilter.rigid import Pose, quaternion_to_matrix
from kilter.shape.primitives import Box, Mesh, Prism, Shape, fan, surface

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Piece = tuple[Shape, Array]
"""A shape and the position of its origin; families never rotate parts, the pose of the scene
does."""

Family = Callable[[Generator], list[Piece]]
FAMILIES: dict[str, Family] = {}


def family(make: Family) -> Family:
    """Register a family under its function's name."""
    FAMILIES[make.__name__] = make
    return make


@dataclass(frozen=True)
class Wrap:
    """Placement of a scene: rotation, scale, shift, and the storage of its coordinates."""

    rotation: Array
    scale: float
    shift: Array
    storage: str


FINE = ("split_faces", "gaps", "tilts")
"""Families that need more digits than float32 has."""
STORAGE = ("pose", "mesh", "soup", "float32")


def random_scene(seed: int, name: str | None = None, storage: str | None = None) -> Assembly:
    """The assembly of a seed; `source` names its family, storage and seed."""
    rng = np.random.default_rng(seed)
    names = sorted(FAMILIES)
    name = names[int(rng.integers(len(names)))] if name is None else name
    pieces = FAMILIES[name](rng)
    wrap = random_wrap(rng, pieces, storage, fine=name in FINE)
    return placed(pieces, wrap, rng, source=f"{name}/{wrap.storage}/{seed}")


def placed(pieces: Iterable[Piece], wrap: Wrap, rng: Generator, source: str = "") -> Assembly:
    """Pieces as an assembly in the pose and storage of `wrap`."""
    parts = [Part(f"p{k}", *_placed(*piece, wrap, rng)) for k, piece in enumerate(pieces)]
    return Assembly(parts, source=source)


def random_wrap(
    rng: Generator, pieces: Iterable[Piece], storage: str | None, *, fine: bool
) -> Wrap:
    """A random pose of the scene; `fine` scenes need more digits than float32 has."""
    if storage is None:
        storage = str(rng.choice(STORAGE[:3] if fine else STORAGE))
    q = rng.normal(size=4) if rng.random() < 0.7 else np.array([1.0, 0, 0, 0])
    scale = float(10 ** rng.uniform(-3, 3)) if rng.random() < 0.5 else 1.0
    size = max(float(np.abs(surface(s)[0] + o).max()) for s, o in pieces) * scale
    furthest = 100 if storage == "float32" else 1000
    far = float(rng.choice([0, 1, furthest])) * rng.random()
    return Wrap(quaternion_to_matrix(q), scale, rng.normal(size=3) * far * size / 2, storage)


def _placed(shape: Shape, origin: Array, wrap: Wrap, rng: Generator) -> tuple[Shape, Pose]:
    if wrap.storage == "pose":
        position = wrap.scale * (wrap.rotation @ origin) + wrap.shift
        return scaled(shape, wrap.scale), Pose(position, _quaternion(wrap.rotation))
    vertices, faces = surface(shape)
    vertices = wrap.scale * (vertices + origin) @ wrap.rotation.T + wrap.shift
    if wrap.storage == "soup":
        vertices, faces = soup(vertices, faces, rng)
    if wrap.storage == "float32":
        vertices = vertices.astype(np.float32)
    return Mesh(vertices, faces), Pose()


def _quaternion(rotation: Array) -> Array:
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(rotation).as_quat()[[3, 0, 1, 2]]


def scaled(shape: Shape, scale: float) -> Shape:
    """The shape enlarged by the factor `scale`."""
    if isinstance(shape, Box):
        return Box(shape.size * scale)
    if isinstance(shape, Prism):
        return Prism(shape.polygon * scale, shape.depth * scale)
    return Mesh(shape.vertices * scale, shape.triangles)


def soup(vertices: Array, faces: Index, rng: Generator) -> tuple[Array, Index]:
    """Triangles with unshared or doubled vertices, in random order, with zeros of either sign."""
    if rng.random() < 0.5:
        vertices, faces = vertices[faces].reshape(-1, 3), np.arange(faces.size).reshape(-1, 3)
    else:
        count = len(vertices)
        vertices = np.vstack([vertices, vertices])
        faces = faces + count * rng.integers(2, size=faces.shape)
    faces = rng.permutation(faces)
    turn = rng.integers(3, size=len(faces))[:, None] + np.arange(3)
    faces = np.take_along_axis(faces, turn % 3, axis=1)
    sign = rng.choice([-1.0, 1.0], size=vertices.shape)
    return np.where(vertices == 0, 0.0 * sign, vertices), faces


def block(low: ArrayLike, high: ArrayLike) -> Piece:
    """A box between two corners."""
    low, high = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    return Box(high - low), (low + high) / 2


# boxes -------------------------------------------------------------------------------


@family
def guillotine(rng: Generator) -> list[Piece]:
    """A box of 8 x 8 x 8 cut again and again along a grid: whole, part and T-shaped faces."""
    boxes = [(np.zeros(3), np.full(3, 8.0))]
    for _ in range(int(rng.integers(1, 8))):
        low, high = boxes.pop(int(rng.integers(len(boxes))))
        axis = int(rng.integers(3))
        if high[axis] - low[axis] < 2:
            boxes.append((low, high))
            continue
        at = float(rng.integers(low[axis] + 1, high[axis]))
        middle_high, middle_low = high.copy(), low.copy()
        middle_high[axis] = middle_low[axis] = at
        boxes += [(low, middle_high), (middle_low, high)]
    return [block(*box) for box in boxes]


@family
def stacks(rng: Generator) -> list[Piece]:
    """Boxes of any size set on each other with offsets, some clear of those below."""
    pieces, z = [], 0.0
    for _ in range(int(rng.integers(2, 9))):
        size = rng.uniform(0.3, 3, size=3)
        low = np.array([*rng.uniform(-1.5, 1.5, size=2), z])
        pieces.append(block(low, low + size))
        z += size[2]
    return pieces


@family
def gaps(rng: Generator) -> list[Piece]:
    """A stack with gaps of 0, +-0.3 tolerances (touching) and 30 (not)."""
    sizes = rng.uniform(0.5, 2, size=(int(rng.integers(2, 9)), 3))
    tolerance = 1e-5 * np.linalg.norm(sizes, axis=1)
    pieces, z = [], 0.0
    for size in sizes:
        low = np.array([*rng.uniform(-0.4, 0.4, size=2), z])
        pieces.append(block(low, low + size))
        share = float(rng.choice([0.0, 0.3, -0.3, 30.0]))
        z += size[2] + share * (tolerance.max() if share > 1 else tolerance.min())
    return pieces


@family
def sizes(rng: Generator) -> list[Piece]:
    """Small boxes and one large slab."""
    pieces = [block([-50, -50, -20], [50, 50, 0])]
    for k in range(int(rng.integers(1, 7))):
        size = rng.uniform(0.3, 3, size=3)
        low = np.array([8.0 * k - 24, rng.uniform(-52, 50), 0.0])
        pieces.append(block(low, low + size))
    return pieces


@family
def tilts(rng: Generator) -> list[Piece]:
    """Boxes on a slab, turned about an edge or their middle by 1e-6 to 1e-2 rad."""
    pieces = [block([-2, -2, -1], [24, 4, 0])]
    for k in range(int(rng.integers(1, 7))):
        size = rng.uniform(0.5, 2, size=3)
        vertices, faces = surface(Box(size))
        pivot = size * [rng.choice([0.0, -0.5, 0.5]), 0, -0.5]
        angle = float(rng.choice([1e-6, 1e-4, -9e-4, 9e-4, 1.2e-3, 1e-2]))
        c, s = np.cos(angle), np.sin(angle)
        turned = (vertices - pivot) @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]).T
        pieces.append((Mesh(turned, faces), np.array([4.0 * k, rng.uniform(-2, 4), 0])))
    return pieces


# prisms ------------------------------------------------------------------------------


@family
def l_shapes(rng: Generator) -> list[Piece]:
    """L prisms that hold a box in their corner, in a row along y."""
    pieces, y = [], 0.0
    for _ in range(int(rng.integers(1, 4))):
        width, height, wall, depth = rng.integers(2, 7, size=4) * np.array([2.0, 2, 0.5, 1])
        polygon = [[0, 0], [width, 0], [width, wall], [wall, wall], [wall, height], [0, height]]
        if wall >= min(width, height):
            polygon = [[0, 0], [width, 0], [width, height], [0, height]]
            pieces.append((Prism(polygon, depth), np.array([0, y + depth / 2, 0])))
        else:
            pieces.append((Prism(polygon, depth), np.array([0, y + depth / 2, 0])))
            high = [wall + rng.integers(1, 9) / 2, y + depth, wall + rng.integers(1, 9) / 2]
            pieces.append(block([wall, y, wall], high))
        y += depth
    return pieces


@family
def u_shapes(rng: Generator) -> list[Piece]:
    """A U with its feet on a slab (one pair, two pieces), a tenant between its legs."""
    width, leg, wall, depth = rng.integers(1, 5, size=4).astype(float)
    total = width + 2 * leg
    inner, top = 3.0, 3.0 + wall
    polygon = [[0, 0], [leg, 0], [leg, inner], [leg + width, inner], [leg + width, 0]]
    polygon += [[total, 0], [total, top], [0, top]]
    pieces: list[Piece] = [(Prism(polygon, depth), np.zeros(3))]
    offset = rng.uniform(-1, 1, size=2)
    pieces.append(block([offset[0], offset[1] - depth, -1], [offset[0] + total, offset[1], 0]))
    if rng.random() < 0.7:
        high = [leg + width, depth, float(rng.choice([1.5, 3.0]))]
        pieces.append(block([leg, 0, 0], high))
    if rng.random() < 0.5:
        low = np.array([rng.uniform(0, total), rng.uniform(-depth, 0), top])
        pieces.append(block(low, low + 2))
    return pieces


@family
def rings(rng: Generator) -> list[Piece]:
    """A ring of 4 to 11 sides with a plug in its hole, a lid over it or a base under it.

    12 even sides or more count as round.
    """
    n = int(rng.integers(4, 12))
    turn = np.pi / n if rng.random() < 0.5 else float(rng.uniform(0, 1))
    circle = np.arange(n) * (2 * np.pi / n) + turn
    circle = np.column_stack([np.cos(circle), np.sin(circle)])
    outer, inner = 2 * circle, float(rng.uniform(0.4, 1.6)) * circle
    pieces: list[Piece] = [(ring(outer, inner, 1.0), np.zeros(3))]
    if rng.random() < 0.7:
        low, high = rng.choice([-0.5, -1.0, 0.25]), rng.choice([0.5, 1.5])
        pieces.append((column(inner, low, high), np.zeros(3)))
    elif rng.random() < 0.7:
        pieces.append((ring(outer, inner, 1.0), np.array([0, 0, 1.0])))
    if rng.random() < 0.7 or len(pieces) == 1:
        low = np.array([*rng.uniform(-3, 0, size=2), -1.5])
        pieces.append(block(low - [0, 0, 1], [*rng.uniform(0.2, 3, size=2), -1.0]))
        if len(pieces) == 2:
            pieces[-1] = block([*low[:2], 0.5], [*(low[:2] + 3), 1.5])
    return pieces


def ring(outer: Array, inner: Array, height: float) -> Mesh:
    """A prism with a hole, centred on z = 0; `outer` and `inner` turn left, shape (n, 2)."""
    n = len(outer)
    loops = [np.column_stack([p, np.full(n, z)]) for z in (-0.5, 0.5) for p in (outer, inner)]
    vertices = np.vstack(loops) * [1, 1, height]
    k = np.arange(n)
    j = (k + 1) % n

    def quads(p: int, q: int) -> Index:
        a, b, c, d = k + p * n, j + p * n, j + q * n, k + q * n
        return np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])

    # loops: 0 outer low, 1 inner low, 2 outer high, 3 inner high
    return Mesh(vertices, np.vstack([quads(0, 2), quads(2, 3), quads(3, 1), quads(1, 0)]))


def column(polygon: Array, low: float, high: float) -> Mesh:
    """A convex polygon, shape (n, 2), turning left, between two heights."""
    n = len(polygon)
    vertices = np.vstack([np.column_stack([polygon, np.full(n, z)]) for z in (low, high)])
    cap, k = fan(n), np.arange(n)
    j = (k + 1) % n
    sides = [np.column_stack([k, j, j + n]), np.column_stack([k, j + n, k + n])]
    return Mesh(vertices, np.vstack([cap[:, ::-1], cap + n, *sides]))


@family
def star_layers(rng: Generator) -> list[Piece]:
    """Layers of prisms of star-shaped polygons with whole-number corners."""
    pieces, y = [], 0.0
    for _ in range(int(rng.integers(2, 5))):
        depth = float(rng.integers(1, 4))
        for x in (0.0, 12.0)[: int(rng.integers(1, 3))]:
            pieces.append((Prism(star(rng), depth), np.array([x, y + depth / 2, 0])))
        y += depth
    return pieces


def star(rng: Generator) -> Array:
    """A polygon with whole-number corners, seen whole from its middle, not crossing itself."""
    while True:
        n = int(rng.integers(3, 11))
        angle = np.sort(rng.uniform(0, 2 * np.pi, n))
        radius = rng.uniform(2, 6, n)
        points = np.rint(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]))
        points = points[(points != np.roll(points, 1, axis=0)).any(axis=1)]
        try:
            if len(points) >= 3:
                return Prism(points, 1.0).polygon
        except ValueError:
            continue
        except Exception as error:
            if "polygon" not in str(error):
                raise


@family
def polyominoes(rng: Generator) -> list[Piece]:
    """A grid of uneven cells shared out among 2 to 5 prisms, most of them not convex."""
    lines = [np.cumsum(np.concatenate([[0], rng.choice([1.0, 1.5, 0.7], 4)])) for _ in range(2)]
    while True:
        loops = _outlines(_shared_out(rng, 4, int(rng.integers(2, 6))))
        if loops is not None:
            break
    pieces = []
    for loop in loops:
        polygon = np.column_stack([lines[0][loop[:, 0]], lines[1][loop[:, 1]]])
        depth = float(rng.choice([1.0, 2.0]))
        pieces.append((Prism(polygon, depth), np.array([0, depth / 2, 0])))
    if rng.random() < 0.5:
        pieces.append(block([0.3, -1, 0.2], [3.0, 0, 2.5]))
    return pieces


def _shared_out(rng: Generator, n: int, parts: int) -> Index:
    """Owners of n x n cells: regions that grow from random cells."""
    owner = np.full((n, n), -1)
    starts = rng.permutation(n * n)[:parts]
    owner.flat[starts] = np.arange(parts)
    while (owner < 0).any():
        i, j = rng.integers(n, size=2)
        di, dj = [(0, 1), (1, 0), (0, -1), (-1, 0)][int(rng.integers(4))]
        k, m = i + di, j + dj
        if owner[i, j] >= 0 and 0 <= k < n and 0 <= m < n and owner[k, m] < 0:
            owner[k, m] = owner[i, j]
    return owner


def _outlines(owner: Index) -> list[Index] | None:
    """The outline of each region by grid corners; None where one has a hole or a pinch."""
    padded = np.pad(owner, 1, constant_values=-1)
    loops = []
    for part in range(owner.max() + 1):
        following: dict[tuple[int, int], tuple[int, int]] = {}
        count = 0
        for i, j in np.argwhere(owner == part).tolist():
            sides = [((i, j), (i + 1, j), (0, -1)), ((i + 1, j), (i + 1, j + 1), (1, 0))]
            sides += [((i + 1, j + 1), (i, j + 1), (0, 1)), ((i, j + 1), (i, j), (-1, 0))]
            for start, end, (di, dj) in sides:
                if padded[i + 1 + di, j + 1 + dj] != part:
                    following[start] = end
                    count += 1
        loop = [next(iter(following))]
        while following[loop[-1]] != loop[0]:
            loop.append(following[loop[-1]])
        if len(loop) < count:
            return None
        loops.append(np.array(loop))
    return loops


# convex cells ------------------------------------------------------------------------


@family
def voronoi(rng: Generator) -> list[Piece]:
    """Voronoi cells of random points in a box; mirrored points bound them."""
    points = rng.uniform(0.1, 0.9, size=(int(rng.integers(2, 9)), 3))
    mirrored = [points]
    for axis in range(3):
        for wall in (0.0, 1.0):
            image = points.copy()
            image[:, axis] = 2 * wall - image[:, axis]
            mirrored.append(image)
    diagram = Voronoi(np.vstack(mirrored))
    cells = [diagram.vertices[diagram.regions[diagram.point_region[k]]] for k in range(len(points))]
    return [(convex(cell), np.zeros(3)) for cell in cells]


def convex(points: Array) -> Mesh:
    """The convex hull of points as a closed mesh."""
    hull = ConvexHull(points)
    faces = hull.simplices.copy()
    p, q, r = (hull.points[faces[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(q - p, r - p), hull.equations[:, :3]) < 0
    faces[inwards] = faces[inwards, ::-1]
    used, compact = np.unique(faces, return_inverse=True)
    return Mesh(hull.points[used], compact.reshape(-1, 3))


@family
def cut_box(rng: Generator) -> list[Piece]:
    """A box cut again and again by random planes: faces that overlap in part."""
    cells = [np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)]
    for _ in range(int(rng.integers(1, 7))):
        cells.sort(key=lambda cell: -ConvexHull(cell).volume)
        cell = cells.pop(int(rng.integers(min(2, len(cells)))))
        normal = rng.normal(size=3)
        normal /= np.linalg.norm(normal)
        at = normal @ (cell.T @ rng.dirichlet(np.full(len(cell), 3.0)))
        height = cell @ normal - at
        if np.abs(height).min() < 0.02:
            cells.append(cell)
            continue
        section = _section(cell, height, normal)
        cells += [np.vstack([cell[height > 0], section]), np.vstack([cell[height < 0], section])]
    return [(convex(cell), np.zeros(3)) for cell in cells]


def _section(cell: Array, height: Array, normal: Array) -> Array:
    """Corners of a convex cell's section by the plane where `height` is zero."""
    hull = ConvexHull(cell)
    crossed = set()
    for k, simplex in enumerate(hull.simplices):
        for side, other in enumerate(hull.neighbors[k]):
            if hull.equations[k, :3] @ hull.equations[other, :3] < 1 - 1e-9:
                i, j = sorted(np.delete(simplex, side).tolist())
                if height[i] * height[j] < 0:
                    crossed.add((i, j))
    return np.array(
        [
            cell[i] + height[i] / (height[i] - height[j]) * (cell[j] - cell[i])
            for i, j in sorted(crossed)
        ]
    )


@family
def arch(rng: Generator) -> list[Piece]:
    """Voussoirs of a half ring, each a hexahedron; a course of them may stand on another."""
    count = int(rng.integers(3, 9))
    angle = np.concatenate([[0], np.sort(rng.uniform(0.2, 2.9, count - 1)), [np.pi]])
    angle = angle[np.concatenate([[True], np.diff(angle) > 0.05])]
    depth = float(rng.uniform(0.3, 2))
    pieces = []
    for start, end in pairwise(angle):
        ray = np.array([[np.cos(start), np.sin(start)], [np.cos(end), np.sin(end)]])
        polygon = np.vstack([ray, (2.0 + rng.choice([0, 0.5])) * ray[::-1]])
        pieces.append((Prism(polygon, depth), np.zeros(3)))
    return pieces


# faces cut up ------------------------------------------------------------------------


@family
def split_faces(rng: Generator) -> list[Piece]:
    """Parts of another family with their triangles split at random, T-junctions included."""
    sources = [guillotine, l_shapes, u_shapes, rings, cut_box, star_layers]
    pieces = sources[int(rng.integers(len(sources)))](rng)
    return [(split(shape, rng, int(rng.integers(0, 30))), origin) for shape, origin in pieces]


def split(shape: Shape, rng: Generator, times: int) -> Mesh:
    """Triangles split at a point inside, or on an edge: of both triangles or of one alone."""
    vertices, faces = surface(shape)
    points, triangles = vertices.tolist(), [tuple(t) for t in faces.tolist()]
    for _ in range(times):
        a, b, c = triangles.pop(int(rng.integers(len(triangles))))
        p, q, r = (np.array(points[k]) for k in (a, b, c))
        new = len(points)
        if rng.random() < 0.4:
            share = rng.dirichlet([2, 2, 2])
            points.append((share[0] * p + share[1] * q + share[2] * r).tolist())
            triangles += [(a, b, new), (b, c, new), (c, a, new)]
            continue
        t = float(rng.choice([0.5, 0.25, rng.uniform(0.1, 0.9)]))
        points.append((p + t * (q - p)).tolist())
        triangles += [(a, new, c), (new, b, c)]
        if rng.random() < 0.6:
            _split_neighbour(triangles, (b, a), new)
    return Mesh(np.array(points), np.array(triangles))


def _split_neighbour(triangles: list, edge: tuple[int, int], new: int) -> None:
    """Split the triangle on the other side of an edge at the same point, if it has one whole."""
    for k, triangle in enumerate(triangles):
        for s in range(3):
            if (triangle[s], triangle[(s + 1) % 3]) == edge:
                apex = triangle[(s + 2) % 3]
                triangles[k] = (edge[0], new, apex)
                triangles.append((new, edge[1], apex))
                return
