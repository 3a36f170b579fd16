"""Random bodies balanced on others, and an independent test of their separation.

A ball, a log, a block or a crystal (the hull of random points with a flat face below) rests on a
held ball, log or two, so that its centre of mass is above its support. It may carry another body.
"""

import numpy as np
from scipy.optimize import linprog, nnls
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from kilter import Assembly, Box, Cylinder, Mesh, Part, Pose, Sphere
from kilter.arrays import Array

Random = np.random.Generator
GON = 1024
"""Number of corners of the prisms inside and around a cylinder."""


def random_balance(seed: int) -> Assembly:
    """The assembly of a seed."""
    random = np.random.default_rng(seed)
    height, parts = 0.0, []
    count = int(random.integers(2, 4))
    for k in range(count):
        made, tall = _body(random, f"p{k}", height, lowest=k == 0)
        parts.append(made)
        height += tall
    return Assembly(parts)


def _body(random: Random, name: str, at: float, *, lowest: bool) -> tuple[Part, float]:
    """A part with its lowest point or face at a height above the origin, and its own height."""
    size = float(random.uniform(0.6, 1.4)) if lowest else float(random.uniform(0.3, 0.8))
    turn = Rotation.from_euler("z", random.uniform(0, np.pi))
    kind = random.choice(["ball", "log"] if lowest else ["ball", "log", "block", "crystal"])
    if kind == "ball":
        shape, tall = Sphere(size), 2 * size
    elif kind == "log":
        shape, tall = Cylinder(size, float(random.uniform(1.5, 3.0)) * size), 2 * size
        turn = turn * Rotation.from_euler("y", np.pi / 2)
    elif kind == "block":
        sides = size * random.uniform(0.5, 1.5, 3)
        shape, tall = Box(sides), float(sides[2])
    else:
        shape, tall = _crystal(random, size)
    x, y, z, w = turn.as_quat()
    pose = Pose([0, 0, at + tall / 2], [w, x, y, z])
    return Part(name, shape, pose, grounded=lowest, density=1000.0), tall


def _crystal(random: Random, size: float) -> tuple[Mesh, float]:
    """A hull about its centre of mass with flat faces below and above, and its height."""
    ring = 2 * np.pi * (np.arange(6) + random.uniform(-0.3, 0.3, 6)) / 6
    wide = size * random.uniform(0.6, 1.0, 3)
    half = float(size * random.uniform(0.2, 0.5))
    flat = np.column_stack([np.cos(ring), np.sin(ring)])
    layers = [
        np.column_stack([w * flat, np.full(6, z)])
        for w, z in zip(wide, (-half, 0, half), strict=True)
    ]
    points = np.vstack([*layers, *(one * [-1, -1, 1] for one in layers)])  # so it is balanced
    found = ConvexHull(points)
    faces = found.simplices.copy()
    first, second, third = np.swapaxes(points[faces], 0, 1)
    inward = (np.cross(second - first, third - first) * found.equations[:, :3]).sum(axis=1) < 0
    faces[inward] = faces[inward][:, ::-1]
    used, corners = np.unique(faces, return_inverse=True)
    return Mesh(points[used], corners.reshape(-1, 3)), 2 * half


def overlap(assembly: Assembly, motion: Array, *, outside: bool) -> list[tuple[str, str]]:
    """Pairs of parts that share a point, with cylinders as prisms around or inside them.

    Balls are compared by distances, other shapes by linear programs in weights of corners, without
    any code of kilter.
    """
    geometry = assembly.geometry
    clouds = [
        _cloud(part, geometry.center[k], motion[k], outside)
        for k, part in enumerate(assembly.parts)
    ]
    return [
        (assembly.names[i], assembly.names[j])
        for i in range(len(clouds))
        for j in range(i + 1, len(clouds))
        if not disjoint(*clouds[i], *clouds[j])
    ]


def _cloud(part: Part, center: Array, motion: Array, outside: bool) -> tuple[Array, float]:
    """Points whose hull, rounded by a radius, is the displaced part."""
    shape, radius = part.shape, 0.0
    if isinstance(shape, Sphere):
        points, radius = np.zeros((1, 3)), shape.radius
    elif isinstance(shape, Cylinder):
        angle = 2 * np.pi * np.arange(GON) / GON
        r = shape.radius / (np.cos(np.pi / GON) if outside else 1.0)
        rim = np.column_stack([r * np.cos(angle), r * np.sin(angle), 0 * angle])
        points = np.vstack(
            [rim + np.array([0, 0, z]) for z in (-shape.height / 2, shape.height / 2)]
        )
    elif isinstance(shape, Box):
        points = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T * shape.size
    else:
        points = np.asarray(shape.vertices)
    w, x, y, z = part.pose.rotation
    placed = Rotation.from_quat([x, y, z, w]).apply(points.copy()) + part.pose.position
    return Rotation.from_rotvec(motion[3:]).apply(placed - center) + center + motion[:3], radius


def disjoint(a: Array, ra: float, b: Array, rb: float) -> bool:
    """Whether a plane separates two rounded hulls; it is verified at every point."""
    n = _nearest(a[0], b) if len(a) == 1 else -_nearest(b[0], a) if len(b) == 1 else _widest(a, b)
    length = float(np.linalg.norm(n))
    return length > 0 and bool(((b @ n).min() - (a @ n).max()) / length > ra + rb)


def _nearest(point: Array, cloud: Array) -> Array:
    """The vector from a point to a hull, by least squares in weights with sum 1."""
    heavy = 1e4
    rows = np.vstack([(cloud - point).T, np.full(len(cloud), heavy)])
    weights, _ = nnls(rows, np.append(np.zeros(3), heavy), maxiter=100 * len(cloud))
    return np.asarray((cloud - point).T @ weights / weights.sum())


def _widest(a: Array, b: Array) -> Array:
    """The normal n with entries of at most 1 and the largest n.(b - a), by a linear program."""
    rows = np.vstack(
        [
            np.column_stack([a, -np.ones(len(a)), np.ones(len(a))]),
            np.column_stack([-b, np.ones(len(b)), np.ones(len(b))]),
        ]
    )
    bounds = [(-1, 1)] * 3 + [(None, None)] * 2
    found = linprog([0, 0, 0, 0, -1], rows, np.zeros(len(rows)), bounds=bounds)
    assert found.status == 0
    return np.asarray(found.x[:3])
