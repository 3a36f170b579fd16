"""Solids with exact faces for tests: profiles revolved about z, or extruded along y.

A profile is a closed list of corners, anticlockwise; two corners are connected by a straight side
or, if a centre is given, by an arc. Sides become planes, cylinders and cones, arcs spheres and tori
(revolved) or cylinders (extruded).
"""

import itertools

import numpy as np

from kilter.assembly.polyhedra import polyhedron_moments
from kilter.shape.primitives import Mesh
from kilter.shape.solid import Solid, Surface

__all__ = [
    "arc", "ball", "bolt", "bore", "cone_frustum", "cone_socket", "extruded", "mesh_of", "peg",
    "revolved", "socket", "torus", "trough",
]  # fmt: skip


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
