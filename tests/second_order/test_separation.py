"""Separation of bodies against closed forms, and of random polyhedra against a linear program."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

from kilter import Assembly, Cylinder, Mesh, Part, Pose, Sphere
from kilter.arrays import Array
from kilter.mechanics.program import build_program
from kilter.rigid import matrix_to_quaternion, turn_of
from kilter.second_order.parts.separation import (
    bodies_of,
    least_separation,
    separation,
    separation_of_point,
)
from kilter.shape.primitives import Box

NO_HINT = np.empty((0, 3))


def body(shape: object, at: tuple[float, float, float], turn: Array | None = None):
    pose = Pose(at) if turn is None else Pose(at, matrix_to_quaternion(turn))
    found = bodies_of(Assembly([Part("a", shape, pose)]), 0)
    assert found is not None
    assert len(found) == 1
    return found[0]


def hull(points: Array) -> Mesh:
    found = ConvexHull(points)
    faces = found.simplices.copy()
    first, second, third = np.swapaxes(points[faces], 0, 1)
    normal = np.cross(second - first, third - first)
    inward = (normal * found.equations[:, :3]).sum(axis=1) < 0
    faces[inward] = faces[inward][:, ::-1]
    return Mesh(points, faces)


def disjoint(a: Array, b: Array) -> bool:
    """Whether two hulls have no common point, by a linear program in weights."""
    rows = np.vstack(
        [
            np.hstack([a.T, -b.T]),
            np.hstack([np.ones(len(a)), np.zeros(len(b))]),
            np.hstack([np.zeros(len(a)), np.ones(len(b))]),
        ]
    )
    return linprog(np.zeros(rows.shape[1]), A_eq=rows, b_eq=[0, 0, 0, 1, 1]).status == 2


def test_two_balls_are_as_far_apart_as_their_centres_less_both_radii() -> None:
    a, b = body(Sphere(1.0), (0, 0, 0)), body(Sphere(0.5), (0, 3, 4))
    assert separation(a, b, NO_HINT) == pytest.approx(3.5)


@pytest.mark.parametrize("gap", [1e-6, -1e-6])
def test_a_cylinder_over_a_box_is_apart_iff_it_is_above(gap: float) -> None:
    lying = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    box = body(Box([4, 4, 2]), (0, 0, -1))
    cylinder = body(Cylinder(0.5, 2.0), (0.3, 0.1, 0.5 + gap), lying)
    assert (separation(box, cylinder, np.array([[0.0, 0, 1]])) > 0) == (gap > 0)


@pytest.mark.parametrize("gap", [1e-6, -1e-6])
def test_crossed_cylinders(gap: float) -> None:
    along_x = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    along_y = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    a = body(Cylinder(1.0, 4.0), (0, 0, -1), along_x)
    b = body(Cylinder(0.5, 4.0), (0, 0, 0.5 + gap), along_y)
    assert (separation(a, b, np.array([[0.0, 0, 1]])) > 0) == (gap > 0)


@pytest.mark.slow
def test_polyhedra_are_apart_where_a_linear_program_says_so() -> None:
    random = np.random.default_rng(3)
    seen = set()
    for _ in range(60):
        clouds = [random.normal(size=(8, 3)) for _ in range(2)]
        clouds[1] += random.normal(size=3) * 1.6
        apart = disjoint(*clouds)
        a, b = (body(hull(cloud), (0, 0, 0)) for cloud in clouds)
        assert (separation(a, b, NO_HINT) > 0) == apart
        seen.add(apart)
    assert seen == {True, False}


def test_a_point_is_as_far_from_a_box_as_its_nearest_point() -> None:
    random = np.random.default_rng(4)
    box = body(Box([2, 4, 6]), (0, 0, 0))
    for point in random.uniform(-5, 5, size=(200, 3)):
        off = np.abs(point) - [1, 2, 3]
        inside = off.max() <= 0
        known = off.max() if inside else np.linalg.norm(np.maximum(off, 0))
        assert separation_of_point(box, point) == pytest.approx(known, abs=1e-12)


def test_a_block_in_a_notch_that_is_not_convex() -> None:
    """A U as a mesh: a block inside is apart until it is moved into a wall."""
    profile = np.array([[-2, 0], [2, 0], [2, 3], [1, 3], [1, 1], [-1, 1], [-1, 3], [-2, 3]], float)
    from kilter import Prism

    parts = [
        Part("u", Prism(profile, 2.0), grounded=True),
        Part("block", Box([1.9, 1, 1]), Pose([0, 0, 1.6])),
    ]
    assembly = Assembly(parts, detect=False)
    program = build_program(assembly, assembly_contacts(assembly))
    motion = np.zeros((2, 6))
    assert least_separation(assembly, program, motion, beyond=0.2) == pytest.approx(0.05)
    motion[1, 0] = 0.04
    assert least_separation(assembly, program, motion, beyond=0.2) == pytest.approx(0.01)
    motion[1, 0] = 0.06
    found = least_separation(assembly, program, motion, beyond=0.2)
    assert found is not None
    assert found < 0
    motion[1] = [0, 0, 0, 0, 0.3, 0]
    found = least_separation(assembly, program, motion, beyond=0.2)
    assert found is not None
    assert found < 0


def assembly_contacts(assembly: Assembly):
    import kilter

    return kilter.contacts(assembly)


def test_a_turn_keeps_lengths_and_its_axis() -> None:
    rotation = np.array([0.3, -1.0, 0.5])
    turn = turn_of(rotation)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-15)
    np.testing.assert_allclose(turn @ rotation, rotation, atol=1e-15)
    assert np.trace(turn) == pytest.approx(1 + 2 * np.cos(np.linalg.norm(rotation)))
