"""Assemblies at random, far from anything that a person would draw."""

from collections.abc import Callable

import numpy as np

from kilter import Assembly, Box, Cylinder, Load, Mesh, Part, Pose, Prism, Sphere

Random = np.random.Generator
CROWDED = 0.001
"""Share of scenes of a thousand and more tiny parts."""


def random_scene(rng: Random) -> Callable[[], Assembly]:
    """What makes a few parts of any size: piled, apart, coincident, slivers; one at least is held.

    It may raise `InputError`: numbers are drawn first, so that a case is the same either way.
    """
    size = 10.0 ** rng.uniform(-12, 12) if rng.random() < 0.3 else 10.0 ** rng.uniform(-3, 3)
    if rng.random() < CROWDED:
        return _crowd(rng, size)
    count = int(rng.choice([1, 2, 2, 3, 3, 4, 5, 6]))
    rows, height, last = [], 0.0, [0.0, 0.0, 0.0]
    for k in range(count):
        shape, tall = _shape(rng, size)
        at = [*(rng.normal(size=2) * 0.2 * size), height + tall / 2]
        chance = rng.random()
        if chance < 0.1 and rows:
            at = last
        elif chance < 0.2:
            at[2] += rng.normal() * 10.0 ** rng.uniform(-12, -1) * size
        else:
            height += tall
        last = at
        turn = _turn(rng) if rng.random() < 0.15 else (1.0, 0.0, 0.0, 0.0)
        held = k == 0 or rng.random() < 0.1
        rows.append((f"part-{k}", shape, at, turn, held, _masses(rng)))
    gravity = np.array([0, 0, -9.81]) if rng.random() < 0.6 else rng.normal(size=3) * 9.81
    if rng.random() < 0.1:
        gravity = gravity * 10.0 ** rng.uniform(-12, 12)
    friction = float(rng.choice([0.0, 0.0, 0.3, 0.7, 1.5, 1e-9, 1e3, 1e12]))
    force = rng.normal(size=3) * 10.0 ** rng.uniform(-6, 6)
    laden = count > 1 and rng.random() < 0.15 and not rows[1][4]

    def made() -> Assembly:
        parts = [
            Part(name, shape(), Pose(at, turn), grounded=held, **masses)
            for name, shape, at, turn, held, masses in rows
        ]
        loads = (Load("part-1", point=[0, 0, 0], force=force),) if laden else ()
        return Assembly(parts, gravity=gravity, friction=friction, loads=loads)

    return made


def _masses(rng: Random) -> dict[str, float]:
    chance = rng.random()
    if chance < 0.15:
        return {"mass": 10.0 ** rng.uniform(-9, 9)}
    if chance < 0.2:
        return {"mass": 10.0 ** rng.uniform(-90, 90)}
    return {"density": 10.0 ** rng.uniform(-30, 30)} if chance < 0.25 else {}


def _shape(rng: Random, size: float) -> tuple[Callable[[], object], float]:
    """What makes a shape, and how tall it is; one edge in ten is a sliver's."""
    edges = size * rng.uniform(0.2, 2, 3)
    if rng.random() < 0.1:
        edges[rng.integers(3)] *= 10.0 ** rng.uniform(-12, -2)
    width, depth, tall = (float(edge) for edge in edges)
    kind = int(rng.integers(7))
    if kind == 0:
        return lambda: Cylinder(radius=width / 2, height=tall), tall
    if kind == 1:
        return lambda: Sphere(radius=width / 2), width
    if kind == 2:
        corner = [width * float(rng.random()), tall]
        return lambda: Prism([[0, 0], [width, 0], corner], depth=depth), 0.0
    if kind == 3:
        return _tetrahedron(rng, edges), tall
    if kind == 4:
        corners = rng.normal(size=(int(rng.integers(3, 7)), 2)) * edges[:2]
        return lambda: Prism(corners, depth=tall), 0.0
    return lambda: Box(edges), tall


def _tetrahedron(rng: Random, edges: np.ndarray) -> Callable[[], Mesh]:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 1]]) * edges - edges / 2
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    chance = rng.random()
    if chance < 0.1:
        faces = faces[:, ::-1]
    elif chance < 0.15:
        faces = faces[1:]
    elif chance < 0.2:
        corners[int(rng.integers(4))] = corners[int(rng.integers(4))]
    return lambda: Mesh(corners, faces)


def _crowd(rng: Random, size: float) -> Callable[[], Assembly]:
    """A heap of a thousand tiny boxes and more, on a lattice or anywhere, on a held slab."""
    count = int(rng.integers(1000, 2000))
    side = int(np.ceil(count ** (1 / 3)))
    at = np.stack(np.unravel_index(np.arange(count), (side, side, side)), axis=1) * size
    if rng.random() < 0.5:
        at = at + rng.normal(size=at.shape) * 0.3 * size
    slab = Part("slab", Box([4 * side * size, 4 * side * size, size]), Pose([0, 0, -size]), True)

    def made() -> Assembly:
        tiny = [Part(f"tiny-{k}", Box([size] * 3), Pose(row)) for k, row in enumerate(at)]
        return Assembly([slab, *tiny])

    return made


def _turn(rng: Random) -> tuple[float, ...]:
    quaternion = rng.normal(size=4)
    return tuple((quaternion / np.linalg.norm(quaternion)).tolist())
