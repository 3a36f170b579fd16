"""Known answers of second order, by hand: rows, forms and load of a single round part."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from kilter.arrays import Array
from kilter.rigid import skew
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.minimum_proof import (
    MinimumProof,
    judge_minimum,
)
from kilter.second_order.proofs.paths import Path, judge_path
from kilter.second_order.searches.decide import decide

UP = np.array([0.0, 0.0, 1.0])
BEYOND = 1e-6
"""Distance from a limit at which both sides are decided [-]."""


def point_on_surface(at: Array, surface: Array, center: Array) -> tuple[Array, Array]:
    """Row and form of a corner at `at` of a part over z = x.S x / 2: exact to second order.

    gap = z - s.S s / 2 with p the corner's place: J = (n, p x n), H from p'' and -S along p'.
    """
    arm = at - center
    row = np.append(UP, np.cross(arm, UP))
    moved = np.hstack([np.eye(3), -skew(arm)])
    form = np.zeros((6, 6))
    form[3:, 3:] = (np.outer(UP, arm) + np.outer(arm, UP)) / 2 - (UP @ arm) * np.eye(3)
    bowl = np.zeros((3, 3))
    bowl[:2, :2] = surface
    return row, form - moved.T @ bowl @ moved


def one_part(contacts: list[tuple[Array, Array]], load: Array | None = None) -> Stationary:
    """A part of weight 1 on fixed surfaces."""
    forms = np.zeros((len(contacts), 12, 12))
    forms[:, 6:, 6:] = [form for _, form in contacts]
    columns = np.tile(np.append(np.full(6, -1), np.arange(6)), (len(contacts), 1))
    weight = np.array([0.0, 0, -1, 0, 0, 0]) if load is None else load
    return Stationary(np.array([row for row, _ in contacts]), weight, forms, columns)


def pivot(height: float, surface: Array) -> Stationary:
    """A corner in a bowl, the centre of mass above it."""
    return one_part([point_on_surface(np.zeros(3), surface, height * UP)])


def six_feet(shift: float, arm: float = 2.0) -> Stationary:
    """Six feet on patches z = v.(K_j - shift) v / 2 with traceless K_j, turned by 120 degrees."""
    contacts = []
    for turn in 2 * np.pi * np.arange(3) / 3:
        patch = np.array([[np.cos(turn), np.sin(turn)], [np.sin(turn), -np.cos(turn)]])
        along = np.array([np.cos(turn / 2), np.sin(turn / 2), 0.0])
        for sign in (1.0, -1.0):
            foot = sign * arm * np.cross(along, UP)
            contacts.append(point_on_surface(foot, patch - shift * np.eye(2), np.zeros(3)))
    return one_part(contacts)


SPIN = np.array([[0.0, 0, 0, 0, 0, 1]]).T
BOWL = np.diag([1.0, 2.0])


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_pivot_is_a_minimum_iff_its_centre_is_below_its_corner(side: float) -> None:
    found = decide(pivot(side * BEYOND, BOWL), SPIN)
    assert found.state == ("balanced" if side > 0 else "minimum")
    assert (found.neutral, found.free) == (5, 1)
    if side < 0:
        assert (found.blocked, found.undecided) == (4, 0)


@pytest.mark.slow
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_six_feet_need_forces_of_their_own_for_each_direction(side: float) -> None:
    """A single set of forces has the least curvature -shift; separate forces have 1/2 - shift."""
    shift = 0.5 + side * 1e-3
    problem = six_feet(shift)
    found = decide(problem)
    assert found.neutral == 3
    assert found.state == ("balanced" if side > 0 else "minimum")
    if side < 0:
        assert isinstance(found.proof, MinimumProof)
        assert len(found.proof.leaves) > 1
        assert judge_minimum(problem, found.proof) == ""


@pytest.mark.slow
def test_a_corner_pressed_between_two_bowls_is_held_by_its_squeeze() -> None:
    """Self-stress between a bowl above and a hump below blocks the fall."""
    row, form = point_on_surface(np.zeros(3), -0.5 * np.eye(2), np.zeros(3))
    ceiling_row, ceiling = point_on_surface(np.zeros(3), -np.eye(2), np.zeros(3))
    turns = np.eye(3)
    held = [
        (np.append(sign * axis * 0, sign * axis), np.zeros((6, 6)))
        for axis in turns
        for sign in (1.0, -1.0)
    ]
    squeezed = one_part([(row, form), (-ceiling_row, -ceiling), *held])
    assert decide(squeezed).state == "minimum"
    assert decide(one_part([(row, form), *held])).state != "minimum"


def corner_on(surface: Array, *stops: int) -> Stationary:
    """A corner that only slides, on z = x.S x / 2, with stops that bar -x and -y."""
    rows = np.array([[0.0, 0, 1], *np.eye(3)[list(stops)]])
    forms = np.zeros((len(rows), 12, 12))
    forms[0, 6:8, 6:8] = -surface
    columns = np.tile(np.array([*[-1] * 6, 0, 1, 2, *[-1] * 3]), (len(rows), 1))
    return Stationary(rows, np.array([0.0, 0, -1]), forms, columns)


SADDLE = np.array([[0.1, 1.0], [1.0, 0.1]])


def test_stops_make_a_minimum_of_a_saddle_that_rises_between_them() -> None:
    """x.S x > 0 for all x, y >= 0: a copositive matrix that is not positive definite."""
    assert decide(corner_on(SADDLE)).state == "balanced"
    assert decide(corner_on(SADDLE, 0, 1)).state == "minimum"


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_both_sides_of_the_limit_of_a_copositive_saddle(side: float) -> None:
    """[[1, b], [b, 4]] is copositive iff b > -2."""
    found = decide(corner_on(np.array([[1.0, -2 + side * BEYOND], [-2 + side * BEYOND, 4]]), 0, 1))
    assert found.state == ("minimum" if side > 0 else "balanced")


def test_the_path_of_a_pivot_falls_as_its_formula_says() -> None:
    """Along a turn by t the energy is at least -h t^2 / 2, half the power of d2."""
    height = 0.3
    path = decide(pivot(height, BOWL), SPIN).proof
    assert isinstance(path, Path)
    turn = float(np.linalg.norm(path.first[3:5]))
    assert 0 < path.power <= height * turn**2 + 1e-9


def pressed_between_plates() -> Stationary:
    """A point that shifts and turns on a hump along y, between planes across x that stay closed."""
    rows = np.zeros((3, 6))
    rows[0, 2], rows[1, 0], rows[2, 0] = 1.0, 1.0, -1.0
    forms = np.zeros((3, 12, 12))
    forms[0, 7, 7] = 1.0
    forms[1, 6, 9] = forms[1, 9, 6] = 1.0  # a turn opens a plane and closes the other
    forms[2] = -forms[1]
    columns = np.tile(np.append(np.full(6, -1), np.arange(6)), (3, 1))
    load = np.array([0.0, 0, -1, 0, 0, 0])
    return Stationary(rows, load, forms, columns, on_plane=np.array([False, True, True]))


def test_what_is_pressed_between_planes_falls_along_them() -> None:
    problem = pressed_between_plates()
    spins = np.eye(6)[:, 3:]
    found = decide(problem, spins)
    assert found.state == "balanced"
    assert isinstance(found.proof, Path)
    first, second = found.proof.first, found.proof.second
    assert judge_path(problem, first, second).falls
    assert not judge_path(dataclasses.replace(problem, on_plane=None), first, second).falls
    for k in (0, 3):  # off the planes, or turning against them
        for bent in (first, second):
            path = [first.copy(), second.copy()]
            path[0 if bent is first else 1][k] += 1e-9
            assert not judge_path(problem, *path).falls
    assert decide(dataclasses.replace(problem, on_plane=None), spins).state == "open"
