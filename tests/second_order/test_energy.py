"""Answers of second order against the energy of exact places, and the separation of bodies."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from random_grids import elsewhere, random_grid
from random_rests import random_rest
from rest_energy import LOWER, contradicts, least_beside
from round_energy import compared
from scipy.linalg import eigh
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

import kilter
from kilter import Assembly, Box, Cylinder, Mesh, Part, Pose, Sphere
from kilter.arrays import Array
from kilter.mechanics.program import build_program
from kilter.rigid import matrix_to_quaternion, turn_of
from kilter.scenes.pieces import block, turn
from kilter.second_order.parts.separation import (
    bodies_of,
    least_separation,
    separation,
    separation_of_point,
)


@pytest.mark.slow
def test_a_descent_comes_lower_than_what_balances_and_no_lower_than_a_minimum() -> None:
    floor = Part("floor", Box([9, 9, 1]), Pose([0, 0, -0.5]), grounded=True)
    ball = Part("ball", Sphere(0.5), Pose([0, 0, 0.5]))
    box = Part("box", Box([1, 1, 1]), Pose([0, 0, 1.5]))
    assert least_beside(Assembly([floor, ball, box]), 0, 0.02) < -0.01
    can = Part("box below", Box([0.6, 0.6, 1]), Pose([0, 0, 0.5]))
    assert least_beside(Assembly([floor, can, box]), 0, 0.02) > -LOWER


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*range(1000, 1021), "grid 0", "grid 7", "grid 11", "grid 13"])
def test_random_rests_have_no_contradiction(seed: int | str) -> None:
    grid = isinstance(seed, str)
    number = int(str(seed).split()[-1])
    assembly = random_grid(number) if grid else random_rest(number)[1]
    verdict = kilter.check(assembly)
    second = verdict.second_order_answer
    assert kilter.verify(assembly, verdict.proof()).holds
    if second is not None and second.state != "open":
        assert contradicts(assembly, second, number)[0] == ""
    for other in (Assembly(assembly.parts[::-1]), elsewhere(assembly)) if grid else ():
        there = kilter.check(other)
        assert kilter.verify(other, there.proof()).holds
        told = [one.second_order_answer.state if one.second_order_answer else one.verdict
                for one in (verdict, there)]  # fmt: skip
        assert told[0] == told[1] or "open" in told


@pytest.mark.slow
@pytest.mark.parametrize("block", range(3))
def test_random_rounds_have_no_contradiction(block: int) -> None:
    states = Counter(compared(seed) for seed in range(100 + 30 * block, 130 + 30 * block))
    assert min(states["minimum"], states["balanced"]) >= 3
    assert states["open"] == 0


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


G = 9.81


def rate_of(assembly: kilter.Assembly) -> float:
    second = kilter.check(assembly, require="equilibrium").second_order_answer
    assert second is not None
    assert second.state == "balanced"
    assert second.rate is not None
    return second.rate


@pytest.mark.parametrize(
    ("under", "upper", "raised"),
    [(1.0, 0.2, 0.0), (0.5, 0.7, 0.0), (0.4, 0.3, 0.1), (2.0, 0.3, 0.25), (0.3, 0.8, -0.2)],
)
@pytest.mark.quick(1)
def test_a_ball_on_a_ball(under: float, upper: float, raised: float) -> None:
    ball = kilter.Part(
        "ball", kilter.Sphere(upper), [0, 0, under + upper], center_of_mass=[0, 0, raised]
    )
    held = kilter.Part("held", kilter.Sphere(under), [0, 0, 0], grounded=True)
    assembly = kilter.Assembly([held, ball])
    geometry = assembly.geometry
    mass, inertia = geometry.mass[1], geometry.inertia[1][0, 0]
    length = under + upper
    kinetic = mass * np.array([[length**2, length * raised], [length * raised, raised**2]])
    kinetic += np.diag([0.0, inertia])
    values = eigh(-mass * G * np.diag([length, raised]), kinetic, eigvals_only=True)
    assert rate_of(assembly) == pytest.approx(np.sqrt(-values.min()), rel=1e-5)
    if not raised:
        assert rate_of(assembly) == pytest.approx(np.sqrt(G / length), rel=1e-5)


@pytest.mark.parametrize("raised", [0.05, 0.3])
@pytest.mark.quick(1)
def test_a_curved_foot_turns_in_place(raised: float) -> None:
    """Without friction no force moves the centre of mass aside: I q'' = m g e q."""
    roller = kilter.Part(
        "foot",
        kilter.Cylinder(0.5, 1.0),
        kilter.Pose([0, 0, 0.5], turn([1, 0, 0], 90)),
        center_of_mass=[0, raised, 0],
    )
    table = block("table", [-2, -2, -1], [2, 2, 0], grounded=True)
    assembly = kilter.Assembly([table, roller])
    geometry = assembly.geometry
    rise = geometry.center[1][2] - 0.5
    expected = np.sqrt(geometry.mass[1] * G * rise / geometry.inertia[1][1, 1])
    assert rise == pytest.approx(raised)
    assert rate_of(assembly) == pytest.approx(expected, rel=1e-5)
