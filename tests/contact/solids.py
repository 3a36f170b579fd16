"""Exact solids with round and free faces, and what their points and normals are by formula."""

import dataclasses
import itertools
from dataclasses import dataclass

import numpy as np

from kilter.assembly import Assembly, Part
from kilter.assembly.mesh_surface import polyhedron_moments
from kilter.rigid import Pose
from kilter.shape.primitives import Cylinder, Mesh
from kilter.shape.solid import Solid, Surface


def arc(center, start, end, pieces, *, left):
    """Corners of an arc from start (left out) to end, and its centre, as sides of a profile."""
    center, start, end = (np.array(x, dtype=float) for x in (center, start, end))
    a0 = np.arctan2(*(start - center)[::-1])
    a1 = np.arctan2(*(end - center)[::-1])
    turn = (a1 - a0) % (2 * np.pi) if left else -((a0 - a1) % (2 * np.pi))
    angle = a0 + turn * np.arange(1, pieces + 1) / pieces
    radius = np.linalg.norm(start - center)
    points = center + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    points[-1] = end
    return [(tuple(p), tuple(center)) for p in points.tolist()]


def _sides(profile):
    """Corners (n, 2) and for each side from corner k to k + 1 the centre of its arc or None."""
    corners = np.array([p for p, _ in profile], dtype=float)
    centers = [profile[(k + 1) % len(profile)][1] for k in range(len(profile))]
    return corners, centers


def line(*points):
    """Straight sides to each of the points."""
    return [(tuple(p), None) for p in points]


def revolved(profile, sides=48, phase=0.0):
    """A profile (r, z), r >= 0, turned about z."""
    corners, centers = _sides(profile)
    angle = phase + np.arange(sides) * 2 * np.pi / sides
    vertices, rows = [], []
    for r, z in corners:
        on_axis = abs(r) < 1e-12
        around = [0.0] if on_axis else angle
        first = len(vertices)
        vertices += [(r * np.cos(t), r * np.sin(t), z) for t in around]
        rows.append(np.full(sides, first) if on_axis else first + np.arange(sides))
    triangles, labels, surfaces, names = [], [], [], {}
    for k, center in enumerate(centers):
        m = (k + 1) % len(corners)
        one, two = rows[k], rows[m]
        surface = _turned(corners[k], corners[m], center)
        if surface is None:
            continue
        key = k if center is None else ("arc", center, surface.hollow)
        if key not in names:
            names[key] = len(surfaces)
            surfaces.append(surface)
        for n in range(sides):
            o = (n + 1) % sides
            for triangle in ((one[n], one[o], two[o]), (one[n], two[o], two[n])):
                if len(set(triangle)) == 3:
                    triangles.append(triangle)
                    labels.append(names[key])
    return _solid(vertices, triangles, surfaces, labels)


def _turned(p, q, center):
    (r, z), (s, w) = p, q
    if r < 1e-12 and s < 1e-12:
        return None
    out = np.array([w - z, -(s - r)])
    if center is not None:
        c = np.array(center)
        radius = float(np.hypot(*(p - c)))
        hollow = bool(out @ ((p + q) / 2 - c) < 0)
        if abs(c[0]) < 1e-12:
            return Surface("sphere", (0, 0, c[1]), radius=radius, hollow=hollow)
        return Surface("torus", (0, 0, c[1]), radius=float(c[0]), tube=radius, hollow=hollow)
    if z == w:
        return Surface("plane", (0, 0, z), (0, 0, np.sign(out[1])))
    if r == s:
        return Surface("cylinder", (0, 0, z), radius=float(r), hollow=bool(out[0] < 0))
    slope = (s - r) / (w - z)
    apex = z - r / slope
    up = 1.0 if slope > 0 else -1.0
    return Surface(
        "cone", (0, 0, apex), (0, 0, up), half_angle=float(np.arctan(abs(slope))),
        hollow=bool(out[0] < 0),
    )  # fmt: skip


def extruded(profile, depth):
    """A profile (x, z), extruded along y, centred on y = 0."""
    import shapely

    corners, centers = _sides(profile)
    n = len(corners)
    half = depth / 2
    vertices = [(x, y, z) for y in (-half, half) for x, z in corners]
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(shapely.Polygon(corners)))
    where = {tuple(p): k for k, p in enumerate(corners.tolist())}
    surfaces = [
        Surface("plane", (0, -half, 0), (0, -1, 0)),
        Surface("plane", (0, half, 0), (0, 1, 0)),
    ]
    triangles, labels, names = [], [], {}
    for piece in pieces:
        a, b, c = (where[tuple(p)] for p in shapely.get_coordinates(piece)[:3].tolist())
        (x0, z0), (x1, z1), (x2, z2) = corners[[a, b, c]]
        if (x1 - x0) * (z2 - z0) - (x2 - x0) * (z1 - z0) < 0:
            b, c = c, b
        triangles += [(a, b, c), (a + n, c + n, b + n)]  # seen from -y, x right and z up
        labels += [0, 1]
    for k, center in enumerate(centers):
        m = (k + 1) % n
        p, q = corners[k], corners[m]
        step = q - p
        out = np.array([step[1], -step[0]]) / np.hypot(*step)
        key = k if center is None else ("arc", center, round(float(np.hypot(*(p - center))), 9))
        if key not in names:
            names[key] = len(surfaces)
            if center is None:
                surfaces.append(Surface("plane", (p[0], 0, p[1]), (out[0], 0, out[1])))
            else:
                c = np.array(center)
                surfaces.append(Surface(
                    "cylinder", (c[0], 0, c[1]), (0, 1, 0), radius=float(np.hypot(*(p - c))),
                    hollow=bool(out @ ((p + q) / 2 - c) < 0),
                ))  # fmt: skip
        triangles += [(k, k + n, m + n), (k, m + n, m)]
        labels += [names[key]] * 2
    return _solid(vertices, triangles, surfaces, labels)


def _solid(vertices, triangles, surfaces, labels):
    vertices, triangles = np.array(vertices, dtype=float), np.array(triangles)
    volume, center, second, _ = polyhedron_moments(
        vertices, triangles, np.array([0, len(triangles)])
    )
    if volume[0] < 0:
        triangles, volume, second = triangles[:, ::-1], -volume, -second
    return Solid(vertices, triangles, surfaces, labels, volume[0], center[0], second[0])


def mesh_of(solid):
    """The same shape as a mesh, without its surfaces."""
    return Mesh(solid.vertices, solid.triangles)


def with_scale(solid, scale):
    """A solid grown or shrunk about its origin."""
    surfaces = [
        Surface(
            s.kind,
            s.point * scale,
            s.axis,
            s.radius * scale,
            s.tube * scale,
            s.half_angle,
            s.hollow,
        )
        for s in solid.surfaces
    ]
    return Solid(
        solid.vertices * scale, solid.triangles, surfaces, solid.triangle_surface,
        solid.volume * scale**3, solid.centroid * scale, solid.second_moment * scale**5,
    )  # fmt: skip


# common pieces ------------------------------------------------------------------------


def peg(radius=1.0, low=-2.0, high=2.0, sides=48, phase=0.0):
    """A cylinder about z."""
    return revolved(line((0, low), (radius, low), (radius, high), (0, high)), sides, phase)


def bore(radius=1.0, outer=3.0, low=-1.0, high=1.0, sides=48, phase=0.0):
    """A ring with a hole about z."""
    return revolved(line((radius, low), (outer, low), (outer, high), (radius, high)), sides, phase)


def bolt(radius=1.0, head=1.5, length=3.0, thick=0.5, sides=48):
    """A shank below z = 0 and a head above."""
    return revolved(
        line((0, -length), (radius, -length), (radius, 0), (head, 0), (head, thick), (0, thick)),
        sides,
    )


def ball(radius=1.0, sides=48, rings=24):
    """A sphere about the origin."""
    top, bottom = (0.0, radius), (0.0, -radius)
    profile = [(bottom, None), *arc((0, 0), bottom, top, rings, left=True)]
    return revolved(profile, sides)


def socket(radius=1.0, outer=2.0, depth=2.0, rim=0.0, sides=48, rings=12, phase=0.0):
    """A block with a hollow sphere about the origin, open above the height `rim`."""
    edge = (float(np.sqrt(radius**2 - rim**2)), rim)
    bottom = (0.0, -radius)
    return revolved(
        [*line((0, -depth), (outer, -depth), (outer, rim), edge),
         *arc((0, 0), edge, bottom, rings, left=False)], sides, phase,
    )  # fmt: skip


def cone_frustum(half_angle=0.4, low=1.0, high=3.0, sides=48, phase=0.0):
    """A cone with its apex at the origin, opening upwards, between two heights."""
    t = np.tan(half_angle)
    corners = [(0, low), (low * t, low), (high * t, high), (0, high)]
    return revolved(line(*(corners if low > 0 else corners[1:])), sides, phase)


def cone_socket(half_angle=0.4, low=0.5, high=3.0, outer=4.0, sides=48, phase=0.0):
    """A block with a conical hole through it, apex at the origin, opening upwards."""
    t = np.tan(half_angle)
    return revolved(
        line((low * t, low), (outer, low), (outer, high), (high * t, high)), sides, phase
    )


def torus(radius=2.0, tube=0.5, sides=48, pieces=24):
    """A ring of round section about z."""
    start = (radius + tube, 0.0)
    middle = (radius - tube, 0.0)
    halves = [arc((radius, 0.0), start, middle, pieces, left=True),
              arc((radius, 0.0), middle, start, pieces, left=True)]  # fmt: skip
    sides_of = list(itertools.chain(*halves))
    return revolved([sides_of[-1], *sides_of[:-1]], sides)


def trough(radius=1.0, half=np.pi / 3, depth=2.0, pieces=24, wall=0.5):
    """A block with a cylindrical groove along y about the origin, `half` to either side of down."""
    x, z = radius * np.sin(half), -radius * np.cos(half)
    low = -radius - wall
    wide = radius + wall
    return extruded(
        [*line((-wide, low), (wide, low), (wide, z), (x, z)),
         *arc((0, 0), (x, z), (-x, z), pieces, left=False), *line((-wide, z))], depth,
    )  # fmt: skip


def pin(name, radius, height, at=(0, 0, 0), **options):
    """A solid cylinder about z."""
    return Part(name, Cylinder(radius, height), Pose(at), **options)


def as_solid(mesh: Mesh, free: np.ndarray, sagitta: float) -> Solid:
    """A mesh as a solid: `free` triangles lie on a free form, the others on planes."""
    corners = mesh.vertices[mesh.triangles]
    out = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    out /= np.linalg.norm(out, axis=1)[:, None]
    labels = np.full(len(corners), -1)
    planes: list[Surface] = []
    for k in np.flatnonzero(~free).tolist():
        if labels[k] >= 0:
            continue
        level = np.abs((corners - corners[k, 0]) @ out[k]).max(axis=1) < 1e-9
        labels[level & (out @ out[k] > 1 - 1e-9) & ~free] = len(planes)
        planes.append(Surface("plane", corners[k, 0], out[k]))
    starts = np.array([0, len(corners)])
    volume, center, second, _ = polyhedron_moments(mesh.vertices, mesh.triangles, starts)
    return Solid(
        mesh.vertices,
        mesh.triangles,
        tuple(planes),
        labels,
        volume[0],
        center[0],
        second[0],
        sagitta,
    )


def as_solids(assembly: Assembly, sagitta: float) -> Assembly:
    """Blocks of a joint as solids whose joint is a free form."""
    parts = []
    for part in assembly.parts:
        corners = part.shape.vertices[part.shape.triangles]
        out = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        far = np.abs(part.shape.vertices[:, 2]).max()
        level = (np.abs(corners[..., 2]) > far - 1e-9).all(axis=1)
        free = (np.abs(out[:, 2]) > 1e-9) & ~level
        parts.append(dataclasses.replace(part, shape=as_solid(part.shape, free, sagitta)))
    return dataclasses.replace(assembly, parts=tuple(parts))


def oval(sides: int, out: float = 0.0, *, a: float = 2.0, b: float = 1.0, phase: float = 0.0):
    """Corners (n, 2) of an ellipse, moved out along its normals."""
    t = phase + np.arange(sides) * 2 * np.pi / sides
    normal = np.column_stack([b * np.cos(t), a * np.sin(t)])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return np.column_stack([a * np.cos(t), b * np.sin(t)]) + out * normal


def rings(*levels: tuple[np.ndarray, float]) -> np.ndarray:
    """Outlines (n, 2) at heights, in order."""
    return np.concatenate([np.column_stack([p, np.full(len(p), z)]) for p, z in levels])


def band(low: int, high: int, sides: int) -> np.ndarray:
    """Triangles between two outlines, given by their first corners, turned outwards."""
    k = np.arange(sides)
    m = (k + 1) % sides
    one = np.column_stack([low + k, low + m, high + m])
    return np.concatenate([one, np.column_stack([low + k, high + m, high + k])])


def oval_plug(sides: int = 48, low: float = -1.0, high: float = 1.0, **outline: float) -> Solid:
    """A plug over an oval; its side is a free form."""
    points = oval(sides, **outline)
    vertices = np.concatenate([rings((points, low), (points, high)), [[0, 0, low], [0, 0, high]]])
    k = np.arange(sides)
    m = (k + 1) % sides
    bottom = np.column_stack([m, k, np.full(sides, 2 * sides)])
    top = np.column_stack([k + sides, m + sides, np.full(sides, 2 * sides + 1)])
    faces = np.concatenate([band(0, sides, sides), bottom, top])
    free = np.arange(len(faces)) < 2 * sides
    return as_solid(Mesh(vertices, faces), free, _sagitta(points))


def oval_hole(sides: int = 48, low: float = -1.0, high: float = 1.0, **outline: float) -> Solid:
    """A hole over an oval in an oval plate; its side and the rim of the plate are free forms."""
    inner, outer = oval(sides, **outline), oval(sides, a=4.0, b=3.0)
    vertices = rings((inner, low), (inner, high), (outer, low), (outer, high))
    n = sides
    hole, rim = band(0, n, n)[:, ::-1], band(2 * n, 3 * n, n)
    faces = np.concatenate([hole, rim, band(2 * n, 0, n)[:, ::-1], band(3 * n, n, n)])
    free = np.arange(len(faces)) < 4 * n
    return as_solid(Mesh(vertices, faces), free, _sagitta(outer))


def _sagitta(points: np.ndarray) -> float:
    """Lower bound of the height of the outline over its chords: that of the most curved circle."""
    step = np.roll(points, -1, axis=0) - points
    bend = np.roll(step, -1, axis=0) - step
    return float(np.linalg.norm(bend, axis=1).max() / 8)


@dataclass(frozen=True)
class Joint:
    """z = f(x, y), its slopes, and whether it is ruled along y."""

    height: object
    slope: object
    ruled: bool


def wave(rng, lean=0.0):
    """Half a wave or more along x."""
    size, number = rng.uniform(0.05, 0.15), rng.uniform(2.5, 5.0)
    phase = rng.uniform(0, 2 * np.pi)
    return Joint(
        lambda x, y: size * np.sin(number * x + phase) + lean * x,
        lambda x, y: (size * number * np.cos(number * x + phase) + lean, 0 * x),
        True,
    )


def arc_joints(rng, lean=0.0):
    """A piece of an ellipse, which no cylinder fits."""
    width, height = rng.uniform(1.6, 3.0), rng.uniform(0.3, 0.6)
    sign = rng.choice([-1.0, 1.0])
    middle = rng.uniform(0.3, 0.7)

    def root(x):
        return np.sqrt(1 - ((x - middle) / width) ** 2)

    return Joint(
        lambda x, y: sign * height * root(x) + lean * x,
        lambda x, y: (-sign * height * (x - middle) / width**2 / root(x) + lean, 0 * x),
        True,
    )


def saddle(rng, lean=0.0):
    """A surface with curvature in both directions."""
    a, b, c = rng.uniform(0.1, 0.25), -rng.uniform(0.1, 0.25), rng.uniform(-0.1, 0.1)

    def slope(x, y):
        return 2 * a * (x - 0.5) + c * (y - 0.5) + lean, 2 * b * (y - 0.5) + c * (x - 0.5)

    return Joint(
        lambda x, y: a * (x - 0.5) ** 2 + b * (y - 0.5) ** 2 + c * (x - 0.5) * (y - 0.5) + lean * x,
        slope,
        False,
    )


JOINTS = {"wave": wave, "arc": arc_joints, "saddle": saddle}


def cut(rng, span, count):
    """Positions along a side, including its ends, moved at random between."""
    step = (span[1] - span[0]) / count
    places = np.linspace(*span, count + 1)
    places[1:-1] += rng.uniform(-0.25, 0.25, count - 1) * step
    return places


def body(rng, joint, span, level, count):
    """A block over `span` in x and 0 to 1 in y, from the joint to the plane z = level."""
    x, y = cut(rng, span, count), cut(rng, (0.0, 1.0), count)
    rows, columns = len(x), len(y)
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=2).reshape(-1, 2)
    index = np.arange(rows * columns).reshape(rows, columns)
    inner = index[1:-1, 1:-1].ravel()
    grid[inner] += rng.uniform(-0.2, 0.2, (len(inner), 2)) / count
    face = np.column_stack([grid, joint.height(*grid.T)])
    far = np.column_stack([grid, np.full(len(grid), level)])
    a, b, c, d = (
        q.ravel() for q in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])
    )
    turned = rng.random(len(a)) < 0.5
    one = np.where(turned[:, None], np.column_stack([a, b, c]), np.column_stack([a, b, d]))
    two = np.where(turned[:, None], np.column_stack([a, c, d]), np.column_stack([b, c, d]))
    up = np.concatenate([one, two])
    loop = np.concatenate([index[:, 0], index[-1, 1:], index[-2::-1, -1], index[0, -2:0:-1]])
    after, n = np.roll(loop, -1), len(grid)
    side = np.concatenate(
        [np.column_stack([loop, loop + n, after + n]), np.column_stack([loop, after + n, after])]
    )
    # the joint faces up, the far plane down; a block above its joint is turned inside out
    faces = np.concatenate([up, up[:, ::-1] + n, side])
    return Mesh(np.concatenate([face, far]), faces if level < face[:, 2].min() else faces[:, ::-1])


def blocks(rng, joint, *, count=(12, 15), pose=None, alike=False, lift=0.0):
    """A held block below and a free block above, equally deep but less wide.

    `alike`: both have the same triangles; `lift`: height of the upper block over the joint.
    """
    pose = pose or Pose()
    seed, span = int(rng.integers(1 << 30)), (0.0, 1.0) if alike else (-0.2, 1.2)
    below = body(np.random.default_rng(seed), joint, span, -1.5, count[0])
    again = np.random.default_rng(seed + (not alike))
    above = body(again, joint, (0.0, 1.0), 1.5, count[0 if alike else 1])
    up = Pose(pose.apply([[0.0, 0.0, lift]])[0], pose.rotation)
    return Assembly([Part("below", below, pose, grounded=True), Part("above", above, up)])


def exact_normals(joint, points, pose):
    """Exact unit normals, from below to above, at contact points in the world."""
    local = (points - pose.position) @ pose.matrix
    x, y = local[:, 0], local[:, 1]
    slope_x, slope_y = joint.slope(x, y)
    normal = np.column_stack([-slope_x, -slope_y, np.ones(len(x))])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    return normal @ pose.matrix.T
