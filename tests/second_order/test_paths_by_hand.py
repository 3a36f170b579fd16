"""The judge of paths that lead down for problems of a few numbers: forged paths, each limit.

Unknowns are x and y (neutral) and the height z, which carries the weight 1. The gap opens by

    z + H x^2 / 2,      H < 0 in a bowl (a minimum), and H > 0 on a ball
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.paths import Path, judge_path
from kilter.second_order.second_order_tolerances import (
    ACROSS,
    DROPS,
    KEEPS,
    LASTS,
    REACHES,
    SLIPS,
)

X, Y, Z = np.eye(3)
JUST = (0.9, 1.1)
"""Factors of a limit, on both sides of it [-]."""
BOWL, BALL = -1.0, 1.0


def path(
    first: Any,
    second: Any,
    *,
    bends: float = BALL,
    others: Any = (),
    load: Any = -Z,
    blur: float = 1e-9,
    planes: Any = None,
    turns: Any = (),
    slips: Any = None,
) -> Path:
    """The judged path of given derivatives."""
    rows = np.array([Z, *others], dtype=float)
    form = np.zeros((len(rows), 12, 12))
    form[0, 0, 0] = bends
    place = np.full(12, -1)
    place[:3] = range(3)
    for at, unknown in turns:
        place[at] = unknown
    flat = None if planes is None else np.array(planes)
    places = np.tile(place, (len(rows), 1))
    problem = Stationary(rows, np.array(load), form, places, blur, on_plane=flat, slips=slips)
    return judge_path(problem, np.array(first, dtype=float), np.array(second, dtype=float))


def test_what_is_on_a_ball_falls_and_not_in_a_bowl() -> None:
    found = path(X, -0.5 * Z)
    assert found.falls
    assert (found.opens, found.power, found.slips) == (0.5, 0.5, 0.0)
    assert not path(X, -0.5 * Z, bends=BOWL).falls
    assert not path(X, 0 * Z, bends=BOWL).falls
    assert not path(Y, -0.5 * Z).falls


@pytest.mark.parametrize("over", JUST)
def test_it_opens_and_falls_by_more_than_rounding(over: float) -> None:
    assert path(X, -(1 - over * DROPS) * Z).falls == (over > 1)
    assert path(X, -over * DROPS * Z).falls == (over > 1)


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize("sign", [1, -1])
def test_what_it_enters_or_costs_at_once_is_little_beside_what_it_opens(
    over: float, sign: int
) -> None:
    slip, rough = over * SLIPS * 0.5, 1e-3
    assert not path(X, -0.5 * Z, others=(Y - slip * X,), blur=rough).falls  # y is not opened either
    entered = path(X, -0.5 * Z + Y, others=(Y - slip * X,), blur=rough)
    assert entered.falls == (over < 1)
    assert entered.slips == pytest.approx(slip)
    loaded = path(X, -0.5 * Z, load=-Z + sign * slip * X, blur=rough)
    assert loaded.slips == pytest.approx(slip)
    assert loaded.falls == (over < 1)


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize(("blur", "slack"), [(1e-9, ACROSS), (1e-6, 1e-6)])
def test_what_it_enters_at_once_is_rounding_of_the_data_however_much_it_opens(
    over: float, blur: float, slack: float
) -> None:
    """A small ball in a hollow of smaller ones: the gaps curve much, and it stays."""
    slip = over * slack
    assert path(X, -50 * Z, bends=100.0, load=-Z + slip * X, blur=blur).falls == (over < 1)
    entered = path(X, -50 * Z + Y, bends=100.0, others=(Y - slip * X,), blur=blur)
    assert entered.falls == (over < 1)


@pytest.mark.parametrize("lift", [1.01 * DROPS, 1e-7, 1e-6, 1e-5])
@pytest.mark.parametrize("drop", [0.1, 1.0, 100.0])
def test_a_lift_by_next_to_nothing_lets_nothing_fall_in_a_bowl(lift: float, drop: float) -> None:
    """The gap opens to first order for a moment, then the second derivative closes it."""
    first = (X + lift * Z) / np.hypot(1, lift)
    assert not path(first, -drop * Z, bends=BOWL).falls


@pytest.mark.parametrize("over", JUST)
def test_what_opens_at_once_stays_open_far_beyond_where_the_path_begins_to_fall(
    over: float,
) -> None:
    """Another gap opens by a t - t^2 / 2, and the path falls from t = 2 slip / 0.5 on."""
    slip = 1e-8
    opens = LASTS * 2 * slip / 0.5 / 2 * over
    found = path(X, -0.5 * Z - Y, others=(Y + opens * X, Y + DROPS / 2 * X), load=-Z - slip * X)
    assert not found.falls  # the last one closes
    found = path(X, -0.5 * Z - Y, others=(Y + opens * X,), load=-Z - slip * X)
    assert found.lasts == pytest.approx(2 * opens)
    assert found.falls == (over > 1)
    assert path(X, -0.5 * Z + Y, others=(Y + opens * X,)).lasts == np.inf


@pytest.mark.parametrize("over", JUST)
def test_second_derivatives_are_those_of_a_path_and_more_than_the_blur_of_the_data(
    over: float,
) -> None:
    """Far enough along a neutral motion, the rounding of the rows would open any gap."""
    most = REACHES[-1] * np.sqrt(3) * (1 + over * ACROSS)
    assert path(X, -0.5 * Z + np.sqrt(most**2 - 0.25) * Y).falls == (over < 1)
    blurred = path(X, -0.5 * Z + 100 * Y, blur=over * 0.5 / 100)
    assert blurred.falls == (over < 1)


def test_tilted_rows_within_rounding_make_no_path_in_a_bowl() -> None:
    tilt = 1e-10
    second = 3.0 / tilt * X - Z
    assert not path(X, second, bends=BOWL, others=(Z + tilt * X,), load=-Z).falls
    assert not path(X, second, bends=BOWL, others=(), load=-Z + tilt * X).falls


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_no_number_does_not_fall(value: float) -> None:
    for place in range(3):
        for k in range(2):
            both = [X.copy(), -0.5 * Z]
            both[k][place] = value
            with np.errstate(invalid="ignore"):
                assert not path(*both).falls
    with np.errstate(invalid="ignore"):
        assert not path(Z, [value, 0, 0], load=0 * Z).falls


def test_contacts_with_a_plane_may_be_kept_by_what_only_shifts() -> None:
    pressed = {"others": (Y, -Y)}
    assert not path(X, -0.5 * Z, **pressed).falls
    assert path(X, -0.5 * Z, **pressed, planes=[False, True, True]).falls
    assert not path(X, -0.5 * Z, **pressed, planes=[False, True, False]).falls
    for over in JUST:
        for moved in (
            {"first": X + over * KEEPS * Y, "second": -0.5 * Z},
            {"first": X, "second": -0.5 * Z - over * KEEPS * Y},
        ):
            found = path(**moved, **pressed, planes=[False, True, True])
            assert found.falls == (over < 1)
    for at in (3, 4, 5, 9, 10, 11):  # x turns a part
        found = path(X, -0.5 * Z, **pressed, planes=[False, True, True], turns=[(at, 0)])
        assert not found.falls
    for at in (6, 7, 8):
        found = path(X, -0.5 * Z, **pressed, planes=[False, True, True], turns=[(at, 1)])
        assert found.falls


def test_what_is_at_a_limit_is_on_the_side_of_no() -> None:
    assert not path(X, -DROPS * Z).falls
    assert not path(X, -0.5 * Z - Y, others=(Y + DROPS * X,)).falls  # it stays closed, and closes
    walls = {"others": (Y, -Y), "planes": [False, True, True]}
    assert not path(X + KEEPS * Y, -0.5 * Z, **walls).falls
    assert path(X, -0.5 * Z, load=-Z + ACROSS * X).falls


def test_what_a_path_says_of_itself() -> None:
    for second in (-0.5 * Z, -0.5 * Z + 0.5 * X):  # a wall that it leaves, not to come back
        assert path(X, second, others=(X,)).lasts == np.inf
    assert path(X, -0.5 * Z).rounding == 0.5e-9
    assert path((X + Z) / 2, -0.5 * Z, load=X - Z).opens == 1.0  # all gaps open at once
    assert path(X, -0.5 * Z).one_form
    slips = np.zeros((2, 4, 12))
    assert path(X, -0.5 * Z, others=(Y,), slips=slips).one_form
    slips[1, [0, 2], 0] = 1.0  # it turns at a corner, and slips
    assert not path(X, -0.5 * Z, others=(Y,), slips=slips).one_form
