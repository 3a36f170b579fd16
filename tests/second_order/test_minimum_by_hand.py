"""Minima of the energy: decided by closed forms, and the proof number by number."""

import dataclasses
from typing import Any

import numpy as np
import pytest

from kilter.arrays import Array
from kilter.rigid import skew
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.minimum_proof import (
    Leaf,
    MinimumProof,
    definite,
    judge_minimum,
    leaf_cones,
    orthants,
    sides_of_cone,
    split,
)
from kilter.second_order.proofs.paths import Path, judge_path
from kilter.second_order.searches.decide import decide
from kilter.second_order.second_order_tolerances import ACROSS, BEARS, CURVED, LEVEL

X, Y, G, Z = np.eye(4)
XY = np.column_stack([X, Y])
JUST = (0.9, 1.1)
"""Factors of a limit, on both sides of it [-]."""
BOWL = ((2.0, 0, 0), (0, 3.0, 0), (0, 0, 0))
SADDLE = ((1.0, 0, 0), (0, -1.0, 0), (0, 0, 0))


def word(
    *,
    curvature: Any = BOWL,
    others: Any = (),
    rows: Any = (Z,),
    load: Any = -Z,
    basis: Any = XY,
    free: Any = G[:, None],
    sides: Any = (),
    splits: Any = (),
    forces: Any = (1.0,),
    weights: Any = None,
    leaves: Any = None,
    blur: float = 1e-9,
    slips: Any = None,
) -> str:
    """The word of the judge, with some numbers replaced; empty if the proof holds."""
    every = np.array([*rows, *others], dtype=float)
    form = np.zeros((len(every), 12, 12))
    form[0, :3, :3] = -np.array(curvature, dtype=float)
    places = np.tile(np.append(np.arange(4), np.full(8, -1)), (len(every), 1))
    problem = Stationary(every, np.array(load, dtype=float), form, places, blur, slips=slips)
    own = np.zeros(len(every)) if len(forces) < len(every) else np.array(forces, dtype=float)
    if len(forces) < len(every):
        own[: len(forces)] = forces
    own_sides = np.array(sides, dtype=float).reshape(-1, np.shape(basis)[1])
    given = np.zeros((len(own_sides),) * 2) if weights is None else np.array(weights, dtype=float)
    leaf = Leaf(own, given)
    proof = MinimumProof(
        np.array(basis, dtype=float),
        own_sides,
        np.array(free, dtype=float),
        tuple(splits),
        (leaf,) if leaves is None else tuple(Leaf(own, np.array(one)) for one in leaves),
    )
    return judge_minimum(problem, proof)


def test_it_holds_as_it_is():
    assert word() == ""
    assert word(splits=(None, None), leaves=[np.zeros((2, 2))] * 2) == ""
    assert "curve upward" in word(curvature=SADDLE)


def test_forces_are_of_the_contacts_push_and_balance():
    assert word(leaves=()) == "it has no forces"
    assert "a finite force for each contact" in word(forces=[1.0, 0.0])
    assert "a finite force for each contact" in word(forces=[np.nan])
    assert "pulls" in word(others=(Y,), forces=[1.0, -1e-12])
    for size in (1.0, 1e6):
        given = {"load": -size * Z, "curvature": np.array(BOWL) / size}
        assert word(**given, forces=[size * (1 + 0.5e-9)]) == ""
        assert "do not balance" in word(**given, forces=[size * (1 + 2e-9)])
        assert word(**given, forces=[size * (1 + 2e-9)], blur=3e-9) == ""
        assert "do not balance" in word(**given, forces=[size * (1 + 4e-9)], blur=3e-9)


@pytest.mark.parametrize("over", JUST)
def test_motions_are_those_that_the_forces_leave_neutral(over):
    assert "not those of the free parts" in word(basis=np.nan * XY)
    assert "not those of the free parts" in word(basis=XY[:3], free=G[:3, None])
    assert "leave other motions neutral" in word(basis=X[:, None])
    assert "leave other motions neutral" in word(free=np.zeros((4, 0)))
    assert "leave other motions neutral" in word(free=np.column_stack([G, Z]))
    longer = word(basis=XY * (1 + over * ACROSS / 2))
    assert ("length 1" in longer) == (over > 1)
    bent = X + over * ACROSS * Y
    assert ("length 1" in word(basis=np.column_stack([bent, Y]))) == (over > 1)
    lifted = X + over * ACROSS * Z
    assert ("leave other motions neutral" in word(basis=np.column_stack([lifted, Y]))) == (over > 1)
    opening = word(others=(over * ACROSS * G,))
    assert ("a free motion opens" in opening) == (over > 1)
    assert ("a free motion opens" in word(others=(-over * ACROSS * G,))) == (over > 1)


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize("size", [0.5, 1.0, 50.0])
@pytest.mark.parametrize("place", [(2, 2), (0, 2), (1, 2)])
def test_the_energy_is_level_along_what_is_free(over, size, place):
    for sign in (1, -1):
        matrix = size * np.array(BOWL) / 3
        matrix[place] = matrix[place[::-1]] = sign * over * LEVEL * max(1.0, size)
        assert ("energy changes" in word(curvature=matrix)) == (over > 1)


def test_a_side_is_the_row_of_a_contact_that_carries_nothing():
    wall = {"others": (2.5 * X,), "sides": (X[:2],)}
    assert word(**wall) == ""
    wrong = "not belong to a contact"
    assert wrong in word(**(wall | {"others": ()}))
    for side in (-X[:2], Y[:2], 2 * X[:2], 0.5 * X[:2], 0 * X[:2], np.nan * X[:2]):
        assert wrong in word(**(wall | {"sides": (side,)})), side
    assert wrong in word(others=(X,), sides=(X[:2], Y[:2]))
    for over in JUST:
        near = X[:2] + over * ACROSS * Y[:2]
        assert (wrong in word(**(wall | {"sides": (near,)}))) == (over > 1)


@pytest.mark.parametrize("over", JUST)
def test_a_contact_that_all_but_opens_nothing_is_no_side(over):
    """Rounding has any direction: with sides y >= 0 and -y >= 0 every state would be a minimum."""
    rounding = over * ACROSS * Y
    found = word(
        curvature=SADDLE,
        others=(rounding, -rounding),
        sides=(Y[:2], -Y[:2]),
        weights=[[0, 1.0], [1.0, 0]],
    )
    assert ("not belong to a contact" in found) == (over < 1)


def test_weights_of_sides_make_up_for_what_curves_downward_only_within_them():
    coupled = ((1.0, 2.0, 0), (2.0, 1.0, 0), (0, 0, 0))
    corner = {"curvature": coupled, "others": (X, Y), "sides": (X[:2], Y[:2])}
    assert "curve upward" in word(**corner)
    assert word(**corner, weights=[[0, 1.5], [1.5, 0]]) == ""
    assert word(**corner, weights=[[0, 3.0], [0, 0]]) == ""  # the same form
    for weights in ([[0, -1.5], [-1.5, 0]], [[0, np.nan], [1.5, 0]], [[np.nan] * 2] * 2):
        assert "not positive" in word(**corner, weights=weights)
    for weights in ([[np.inf] * 2] * 2, [[1.5]], [[0, 1.5, 0], [1.5, 0, 0]]):
        assert "not positive" in word(**corner, weights=weights)
    assert "not positive" in word(**corner, weights=[[-1e-9, 1.5], [1.5, 0]])


def test_weights_too_large_to_count_with_prove_nothing():
    saddle = {"curvature": SADDLE, "splits": (None, None)}
    assert "curve upward" in word(**saddle, leaves=[np.full((2, 2), 1e308)] * 2)


def test_weights_of_one_half_of_a_matrix_prove_nothing():
    """The energy falls along x + y, at the edge of the cone |y| <= x."""
    energy = ((5.0, -5.5, 0), (-5.5, 5.0, 0), (0, 0, 0))
    edges = np.array([[1.0, -1, 0, 0], [1, 1, 0, 0]]) / np.sqrt(2)
    for weights in ([[0, 2.0], [0, 0]], [[0, 0], [2.0, 0]]):
        found = word(curvature=energy, others=edges, sides=edges[:, :2], weights=weights)
        assert "curve upward" in found


def test_cones_are_a_tree_with_one_leaf_each():
    none = np.zeros((2, 2))
    assert "cones are left over" in word(splits=(None,), leaves=[none])
    assert "more splits than cones" in word(splits=(None,) * 3, leaves=[none] * 3)
    assert "a set of forces for each" in word(splits=(None, None), leaves=[none])
    assert "a set of forces for each" in word(leaves=[none[:0, :0]] * 2)
    assert word(splits=((0, 1), None, None, None), leaves=[none] * 3) == ""
    assert word(splits=((1, 0), None, None, None), leaves=[none] * 3) == ""
    for pair in ((0, 0), (0, 2), (2, 0), (-1, 1), (1, -1)):
        assert "rays that do not exist" in word(splits=(pair, None, None, None), leaves=[none] * 3)
    with pytest.raises(ValueError, match="left over"):
        list(leaf_cones(2, (None, None, None), half=False))


def test_beside_sides_both_halves_are_asked():
    """Sides distinguish a motion from its opposite."""
    none = np.zeros((3, 3))
    wall = {"others": (X,), "sides": (X[:2],)}
    assert "left over" in word(**wall, splits=(None, None), leaves=[none] * 2)
    assert word(**wall, splits=(None,) * 4, leaves=[none] * 4) == ""
    coupled = ((1.0, 2.0, 0), (2.0, 1.0, 0), (0, 0, 0))
    corner = {"curvature": coupled, "others": (X, Y), "sides": (X[:2], Y[:2])}
    own = np.zeros((4, 4))  # rays of the cone come before sides
    own[2, 3] = own[3, 2] = 1.5
    assert word(**corner, splits=(None,) * 4, leaves=[own] * 4) == ""
    assert "curve upward" in word(**corner, splits=(None,) * 4, leaves=[own] * 3 + [0 * own])


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_orthants_and_their_halves_cover_the_space(dimension):
    for half in (True, False):
        cones = orthants(dimension, half=half)
        assert len(cones) == 2 ** (dimension - half)
        signs = {tuple(np.diag(one)) for one in cones}
        assert len(signs) == len(cones)
        assert all((np.abs(one) == 1).all() for one in signs)
        if half:
            assert all(one[0] == 1 for one in signs)


def test_a_cone_is_split_in_the_middle_of_two_rays():
    rays = np.eye(3)
    first, second = split(rays, 0, 2)
    middle = np.array([1.0, 0, 1]) / np.sqrt(2)
    assert np.allclose(first, np.column_stack([middle, rays[:, 1], rays[:, 2]]))
    assert np.allclose(second, np.column_stack([rays[:, 0], rays[:, 1], middle]))
    for cone in (first, second):
        sides = sides_of_cone(cone)
        assert np.allclose(np.linalg.norm(sides, axis=1), 1)
        opened = sides @ cone
        assert np.allclose(opened - np.diag(np.diag(opened)), 0)
        assert (np.diag(opened) > 0).all()
    got = list(leaf_cones(3, ((0, 2), None, None, *[None] * 3), half=True))
    assert np.allclose(got[0], first)
    assert np.allclose(got[1], second)


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize("size", [0.5, 1.0, 1e3])
def test_definite_is_more_than_rounding(over, size):
    least = over * CURVED * max(1.0, size)
    assert definite(np.diag([size, least])) == (over > 1)
    assert not definite(-np.diag([size, least]))


def test_definite_reads_all_of_a_matrix_and_only_numbers():
    assert definite(np.zeros((0, 0)))
    for value in (np.nan, np.inf, -np.inf):
        assert definite(np.full((1, 1), value)) is False
        assert not definite(np.array([[1.0, value], [0.0, 1.0]]))
    assert not definite(np.array([[1.0, 4.0], [0.0, 1.0]]))
    assert not definite(np.array([[1.0, 0.0], [4.0, 1.0]]))
    assert definite(np.array([[1.0, 4.0], [-4.0, 1.0]]))


def test_the_limits_themselves_are_within():
    assert word(basis=np.column_stack([X + ACROSS * Y, Y])) == ""
    assert word(basis=np.column_stack([X + ACROSS * Z, Y])) == ""
    assert word(others=(ACROSS * G,)) == ""
    matrix = np.array(BOWL) / 3
    matrix[2, 2] = LEVEL
    assert word(curvature=matrix) == ""
    wrong = "not belong to a contact"
    assert wrong in word(others=(ACROSS * Y,), sides=(Y[:2],))
    assert wrong in word(others=(2.5 * X,), sides=(X[:2] + ACROSS * Y[:2],))


@pytest.mark.parametrize("over", JUST)
def test_rows_are_of_rank_beyond_the_blur_of_the_largest(over):
    thin = 100 * 1e-9 * over * G
    rows = {"rows": (100 * Z,), "others": (thin,), "load": -100 * Z - thin, "forces": [1.0, 1.0]}
    assert ("leave other motions neutral" in word(**rows, free=np.zeros((4, 0)))) == (over < 1)


def test_a_contact_carries_where_the_forces_of_any_cone_do():
    rows, form = np.array([Z, Z]), np.zeros((2, 12, 12))
    form[:, :3, :3] = -np.array(BOWL)
    places = np.tile(np.append(np.arange(4), np.full(8, -1)), (2, 1))
    leaves = tuple(Leaf(one, np.zeros((2, 2))) for one in np.eye(2))
    proof = MinimumProof(XY, np.zeros((0, 2)), G[:, None], (None, None), leaves)
    assert judge_minimum(Stationary(rows, -Z, form, places), proof) == ""


def test_all_of_the_forces_are_numbers():
    assert "a finite force for each contact" in word(others=(Y,), forces=[1.0, np.nan])


@pytest.mark.parametrize("blur", [1e-9, 1e-6])
@pytest.mark.parametrize("weight", [1.0, 1e-3, 1e3])
@pytest.mark.parametrize("over", JUST)
def test_what_carries_less_than_may_be_out_of_balance_leaves_its_motions(over, weight, blur):
    """A tilted wall without force would otherwise remove motions that it admits."""
    wall = (X + Y + G) / np.sqrt(3)
    own = over * BEARS * blur * weight
    given = {
        "blur": blur,
        "load": -weight * Z,
        "others": (wall,),
        "curvature": np.array(BOWL) / weight,
    }
    found = word(**given, forces=[weight, own])
    assert found != ""
    assert ("do not balance" in found) == (own / np.sqrt(3) > blur * weight)
    carried = word(**(given | {"load": -weight * Z - own * wall}), forces=[weight, own])
    assert ("leave other motions neutral" in carried) == (over > 1)


def test_forces_beside_which_the_load_is_rounding_balance_nothing():
    """A self-stress of any size does not hide an imbalance, which could make a contact count."""
    walls = {"others": (G, -G), "free": np.zeros((4, 0))}
    assert "do not balance" in word(**walls, forces=[3.0, 1e12, 1e12])
    assert word(**walls, forces=[1.0, 1e6, 1e6]) == ""


@pytest.mark.parametrize("lever", [0.1, 0.01, 1e-4])
@pytest.mark.parametrize("over", JUST)
def test_forces_at_short_levers_carry_by_rounding(lever, over):
    """A second contact would keep x closed by a torque that is lost in the imbalance."""
    bowl = ((-1.0, 0, 0), (0, 3.0, 0), (0, 0, 0))
    far = over * 2e-9 / lever  # four unknowns may each be out of balance by 1e-9
    found = word(
        rows=(Z, Z + lever * X),
        curvature=bowl,
        basis=Y[:, None],
        load=-Z - far * lever * X,
        forces=[1 - far, far],
    )
    assert ("no larger than rounding" in found) == (over < 1)
    assert (found == "") == (over > 1)


@pytest.mark.parametrize("over", JUST)
def test_a_corner_that_carries_neither_turns_nor_slips_where_it_is_flush(over):
    """Its gap has another form if a neutral or free motion makes it slip off its edge."""

    def slips(turn: int, slip: int, row: int = 0) -> Any:
        both = np.zeros((2, 4, 12))
        both[row, 1, turn], both[row, 2, slip] = 1.0, over * ACROSS
        return both

    beside = {"others": (Y,), "sides": (Y[:2],)}
    for turn, slip in ((0, 0), (0, 1), (2, 1)):
        assert ("may slip off" in word(**beside, slips=slips(turn, slip))) == (over > 1)
        assert word(**beside, slips=slips(turn, slip, row=1)) == ""  # it carries nothing
    two = {"rows": (Z, Z), "forces": (0.5, 0.5)}
    assert ("may slip off" in word(**two, slips=slips(0, 1))) == (over > 1)
    assert word(**beside, slips=slips(3, 0)) == word(**beside, slips=slips(0, 3)) == ""


@pytest.mark.parametrize("tilt", [0.9 * ACROSS, 0.0, -0.9 * ACROSS])
@pytest.mark.parametrize(("curves", "holds"), [(0.5e-7, True), (-0.5e-7, False)])
def test_what_a_basis_opens_a_little_curves_nothing(tilt, curves, holds):
    """Between two walls y is no motion, however strongly it would curve the energy with x."""
    tilted = (X + tilt * Y)[:, None]
    form = ((curves, 1.0, 0), (1.0, 0, 0), (0, 0, 0))
    found = word(curvature=form, rows=(Z, Y, -Y), forces=(1, 1, 1), basis=tilted)
    assert found == ("" if holds else "the energy does not curve upward under its forces")


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
BOWL_DECIDE = np.diag([1.0, 2.0])


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_pivot_is_a_minimum_iff_its_centre_is_below_its_corner(side):
    found = decide(pivot(side * BEYOND, BOWL_DECIDE), SPIN)
    assert found.state == ("balanced" if side > 0 else "minimum")
    assert (found.neutral, found.free) == (5, 1)
    if side < 0:
        assert (found.blocked, found.undecided) == (4, 0)


@pytest.mark.slow
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_six_feet_need_forces_of_their_own_for_each_direction(side):
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
def test_a_corner_pressed_between_two_bowls_is_held_by_its_squeeze():
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


SADDLE_DECIDE = np.array([[0.1, 1.0], [1.0, 0.1]])


def test_stops_make_a_minimum_of_a_saddle_that_rises_between_them():
    """x.S x > 0 for all x, y >= 0: a copositive matrix that is not positive definite."""
    assert decide(corner_on(SADDLE_DECIDE)).state == "balanced"
    assert decide(corner_on(SADDLE_DECIDE, 0, 1)).state == "minimum"


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_both_sides_of_the_limit_of_a_copositive_saddle(side):
    """[[1, b], [b, 4]] is copositive iff b > -2."""
    found = decide(corner_on(np.array([[1.0, -2 + side * BEYOND], [-2 + side * BEYOND, 4]]), 0, 1))
    assert found.state == ("minimum" if side > 0 else "balanced")


def test_the_path_of_a_pivot_falls_as_its_formula_says():
    """Along a turn by t the energy is at least -h t^2 / 2, half the power of d2."""
    height = 0.3
    path = decide(pivot(height, BOWL_DECIDE), SPIN).proof
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


def test_what_is_pressed_between_planes_falls_along_them():
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
