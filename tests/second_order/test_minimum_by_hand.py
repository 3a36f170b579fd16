"""The judge of a minimum for problems of a few numbers: forged proofs and each limit.

Unknowns are x, y (neutral), g (free) and the height z, which carries the weight. The energy curves
by a matrix over (x, y, g). Another contact without force may open along x or y.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

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


def test_it_holds_as_it_is() -> None:
    assert word() == ""
    assert word(splits=(None, None), leaves=[np.zeros((2, 2))] * 2) == ""
    assert "curve upward" in word(curvature=SADDLE)


def test_forces_are_of_the_contacts_push_and_balance() -> None:
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
def test_motions_are_those_that_the_forces_leave_neutral(over: float) -> None:
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
def test_the_energy_is_level_along_what_is_free(
    over: float, size: float, place: tuple[int, int]
) -> None:
    for sign in (1, -1):
        matrix = size * np.array(BOWL) / 3
        matrix[place] = matrix[place[::-1]] = sign * over * LEVEL * max(1.0, size)
        assert ("energy changes" in word(curvature=matrix)) == (over > 1)


def test_a_side_is_the_row_of_a_contact_that_carries_nothing() -> None:
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
def test_a_contact_that_all_but_opens_nothing_is_no_side(over: float) -> None:
    """Rounding has any direction: with sides y >= 0 and -y >= 0 every state would be a minimum."""
    rounding = over * ACROSS * Y
    found = word(
        curvature=SADDLE,
        others=(rounding, -rounding),
        sides=(Y[:2], -Y[:2]),
        weights=[[0, 1.0], [1.0, 0]],
    )
    assert ("not belong to a contact" in found) == (over < 1)


def test_weights_of_sides_make_up_for_what_curves_downward_only_within_them() -> None:
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


def test_weights_too_large_to_count_with_prove_nothing() -> None:
    saddle = {"curvature": SADDLE, "splits": (None, None)}
    assert "curve upward" in word(**saddle, leaves=[np.full((2, 2), 1e308)] * 2)


def test_weights_of_one_half_of_a_matrix_prove_nothing() -> None:
    """The energy falls along x + y, at the edge of the cone |y| <= x."""
    energy = ((5.0, -5.5, 0), (-5.5, 5.0, 0), (0, 0, 0))
    edges = np.array([[1.0, -1, 0, 0], [1, 1, 0, 0]]) / np.sqrt(2)
    for weights in ([[0, 2.0], [0, 0]], [[0, 0], [2.0, 0]]):
        found = word(curvature=energy, others=edges, sides=edges[:, :2], weights=weights)
        assert "curve upward" in found


def test_cones_are_a_tree_with_one_leaf_each() -> None:
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


def test_beside_sides_both_halves_are_asked() -> None:
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
def test_orthants_and_their_halves_cover_the_space(dimension: int) -> None:
    for half in (True, False):
        cones = orthants(dimension, half=half)
        assert len(cones) == 2 ** (dimension - half)
        signs = {tuple(np.diag(one)) for one in cones}
        assert len(signs) == len(cones)
        assert all((np.abs(one) == 1).all() for one in signs)
        if half:
            assert all(one[0] == 1 for one in signs)


def test_a_cone_is_split_in_the_middle_of_two_rays() -> None:
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
def test_definite_is_more_than_rounding(over: float, size: float) -> None:
    least = over * CURVED * max(1.0, size)
    assert definite(np.diag([size, least])) == (over > 1)
    assert not definite(-np.diag([size, least]))


def test_definite_reads_all_of_a_matrix_and_only_numbers() -> None:
    assert definite(np.zeros((0, 0)))
    for value in (np.nan, np.inf, -np.inf):
        assert definite(np.full((1, 1), value)) is False
        assert not definite(np.array([[1.0, value], [0.0, 1.0]]))
    assert not definite(np.array([[1.0, 4.0], [0.0, 1.0]]))
    assert not definite(np.array([[1.0, 0.0], [4.0, 1.0]]))
    assert definite(np.array([[1.0, 4.0], [-4.0, 1.0]]))


def test_the_limits_themselves_are_within() -> None:
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
def test_rows_are_of_rank_beyond_the_blur_of_the_largest(over: float) -> None:
    thin = 100 * 1e-9 * over * G
    rows = {"rows": (100 * Z,), "others": (thin,), "load": -100 * Z - thin, "forces": [1.0, 1.0]}
    assert ("leave other motions neutral" in word(**rows, free=np.zeros((4, 0)))) == (over < 1)


def test_a_contact_carries_where_the_forces_of_any_cone_do() -> None:
    rows, form = np.array([Z, Z]), np.zeros((2, 12, 12))
    form[:, :3, :3] = -np.array(BOWL)
    places = np.tile(np.append(np.arange(4), np.full(8, -1)), (2, 1))
    leaves = tuple(Leaf(one, np.zeros((2, 2))) for one in np.eye(2))
    proof = MinimumProof(XY, np.zeros((0, 2)), G[:, None], (None, None), leaves)
    assert judge_minimum(Stationary(rows, -Z, form, places), proof) == ""


def test_all_of_the_forces_are_numbers() -> None:
    assert "a finite force for each contact" in word(others=(Y,), forces=[1.0, np.nan])


@pytest.mark.parametrize("blur", [1e-9, 1e-6])
@pytest.mark.parametrize("weight", [1.0, 1e-3, 1e3])
@pytest.mark.parametrize("over", JUST)
def test_what_carries_less_than_may_be_out_of_balance_leaves_its_motions(
    over: float, weight: float, blur: float
) -> None:
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


def test_forces_beside_which_the_load_is_rounding_balance_nothing() -> None:
    """A self-stress of any size does not hide an imbalance, which could make a contact count."""
    walls = {"others": (G, -G), "free": np.zeros((4, 0))}
    assert "do not balance" in word(**walls, forces=[3.0, 1e12, 1e12])
    assert word(**walls, forces=[1.0, 1e6, 1e6]) == ""


@pytest.mark.parametrize("lever", [0.1, 0.01, 1e-4])
@pytest.mark.parametrize("over", JUST)
def test_forces_at_short_levers_carry_by_rounding(lever: float, over: float) -> None:
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
def test_a_corner_that_carries_neither_turns_nor_slips_where_it_is_flush(over: float) -> None:
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
def test_what_a_basis_opens_a_little_curves_nothing(
    tilt: float, curves: float, holds: bool
) -> None:
    """Between two walls y is no motion, however strongly it would curve the energy with x."""
    tilted = (X + tilt * Y)[:, None]
    form = ((curves, 1.0, 0), (1.0, 0, 0), (0, 0, 0))
    found = word(curvature=form, rows=(Z, Y, -Y), forces=(1, 1, 1), basis=tilted)
    assert found == ("" if holds else "the energy does not curve upward under its forces")
