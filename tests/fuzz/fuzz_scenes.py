"""Assemblies at random, far from anything that a person would draw."""

from __future__ import annotations

import numpy as np

from kilter import Assembly, Box, Cylinder, Load, Mesh, Part, Pose, Prism, Sphere

Random = np.random.Generator


def random_scene(rng: Random) -> Assembly:
    """A few parts of any size: piled, apart, coincident, slivers; at least one is held."""
    size = 10.0 ** rng.uniform(-12, 12) if rng.random() < 0.3 else 10.0 ** rng.uniform(-3, 3)
    count = int(rng.integers(1, 7))
    parts, height = [], 0.0
    for k in range(count):
        shape, tall = _shape(rng, size)
        at = [*(rng.normal(size=2) * 0.2 * size), height + tall / 2]
        chance = rng.random()
        if chance < 0.1 and parts:
            at = parts[-1].pose.position.tolist()
        elif chance < 0.2:
            at[2] += rng.normal() * 1e-4 * size
        else:
            height += tall
        turn = _turn(rng) if rng.random() < 0.15 else (1.0, 0.0, 0.0, 0.0)
        mass = {"mass": 10.0 ** rng.uniform(-9, 9)} if rng.random() < 0.2 else {}
        held = k == 0 or rng.random() < 0.1
        parts.append(Part(f"part-{k}", shape, Pose(at, turn), grounded=held, **mass))
    gravity = np.array([0, 0, -9.81]) if rng.random() < 0.6 else rng.normal(size=3) * 9.81
    friction = float(rng.choice([0.0, 0.0, 0.3, 0.7, 1.5]))
    loads = ()
    if count > 1 and rng.random() < 0.15 and not parts[1].grounded:
        loads = (Load("part-1", point=[0, 0, 0], force=rng.normal(size=3)),)
    return Assembly(parts, gravity=gravity, friction=friction, loads=loads)


def _shape(rng: Random, size: float) -> tuple[object, float]:
    """A shape and how tall it is; one edge in ten is a sliver's."""
    edges = size * rng.uniform(0.2, 2, 3)
    if rng.random() < 0.1:
        edges[rng.integers(3)] *= 10.0 ** rng.uniform(-7, -2)
    kind = int(rng.integers(6))
    if kind == 0:
        return Cylinder(radius=edges[0] / 2, height=edges[2]), edges[2]
    if kind == 1:
        return Sphere(radius=edges[0] / 2), edges[0]
    if kind == 2:
        width, depth, tall = edges
        return Prism([[0, 0], [width, 0], [width * rng.random(), tall]], depth=depth), 0.0
    if kind == 3:
        return _tetrahedron(rng, edges), edges[2]
    return Box(edges), edges[2]


def _tetrahedron(rng: Random, edges: np.ndarray) -> Mesh:
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 1]]) * edges - edges / 2
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    return Mesh(corners, faces[:, ::-1] if rng.random() < 0.1 else faces)


def _turn(rng: Random) -> tuple[float, ...]:
    quaternion = rng.normal(size=4)
    return tuple((quaternion / np.linalg.norm(quaternion)).tolist())
