"""The judge of locked turns for a plate between two faces: forged proofs and each limit.

Unknowns are (x, y, z) and the turns about them. The plate is held at pairs of points from below and
from above, so that a pair may press without a load. It shifts along x and y. A turn about z is
neutral, and self-stress locks it by the given forms.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.mechanics.program import build_program
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.stationary import Stationary, problem_of
from kilter.second_order.proofs.locked import Faces, LockedTurns, faces_of, judge_locked, shifts
from kilter.second_order.second_order_tolerances import ACROSS, BEARS, CURVED

X, Y, Z, TURN = np.eye(6)[[0, 1, 2, 5]]
JUST = (0.9, 1.1)
"""Factors of a limit, on both sides of it [-]."""
POINTS = ((-1.0, 0.0), (1.0, 0.0), (0.0, 1.0), (0.0, -1.0))


def word(
    *,
    points: Any = POINTS,
    locks: float = 1.0,
    load: Any = -Z,
    forces: Any = None,
    stress: Any = None,
    blur: float = 1e-9,
    flat: Any = None,
    size: float = 1.0,
    at: Any = None,
) -> str:
    """The word of the judge, with some numbers replaced; empty if the proof holds.

    Forces and stress are those of each pair of points, below and above; `at` replaces the places of
    the points, over the length.
    """
    places = np.array(points, dtype=float)
    below = np.column_stack([np.tile([0.0, 0, 1], (len(places), 1)), places[:, 1], -places[:, 0],
                             np.zeros(len(places))])  # fmt: skip
    rows = np.vstack([below, -below])
    form = np.zeros((len(rows), 12, 12))
    form[:, 5, 5] = -locks / len(rows)
    columns = np.tile(np.append(np.arange(6), np.full(6, -1)), (len(rows), 1))
    problem = Stationary(rows, np.array(load, dtype=float), form, columns, blur)
    count = len(places)
    share = np.repeat([1 / count, 0.0], count) if forces is None else np.array(forces, dtype=float)
    press = np.ones(2 * count) if stress is None else np.array(stress, dtype=float)
    on = np.ones(len(rows), dtype=bool) if flat is None else np.array(flat)
    said = places if at is None else np.array(at, dtype=float)
    where = np.column_stack([np.resize(said, (len(rows), 2)), np.zeros(len(rows))])
    faces = Faces(np.repeat([0, 1], count), on, where)
    return judge_locked(problem, faces, LockedTurns(share, size * press))


def test_it_holds_as_it_is() -> None:
    """Contacts may be without force, and self-stress has no scale."""
    assert word() == ""
    assert word(size=1e3) == word(size=1e-3) == ""
    assert "every turn" in word(locks=-1.0)


@pytest.mark.parametrize("over", JUST)
def test_every_turn_is_locked(over: float) -> None:
    assert ("every turn" in word(locks=over * CURVED)) == (over < 1)
    assert ("every turn" in word(locks=over * CURVED, size=1e3)) == (over < 1)


def test_numbers_are_those_of_the_contacts() -> None:
    eight = np.full(8, 0.125)
    assert "a finite force for each contact" in word(forces=eight[1:])
    assert "a finite force for each contact" in word(stress=eight[1:])
    for bad in (np.nan, np.inf):
        for name in ("forces", "stress"):
            assert word(**{name: [bad, *eight[1:]]}) == "its numbers are not finite"


@pytest.mark.parametrize("over", JUST)
def test_forces_push_and_balance(over: float) -> None:
    pull = [-0.25, -0.25, 0.75, 0.75, 0, 0, 0, 0]
    assert "do not balance" in word(forces=pull)
    for blur in (1e-9, 1e-6, 1e-12):
        off = over * max(blur, 1e-9) / 4
        forces = np.repeat([0.25 + off, 0.0], 4)
        assert ("do not balance" in word(forces=forces, blur=blur)) == (over > 1)


@pytest.mark.parametrize("size", [1.0, 1e4])
@pytest.mark.parametrize("over", JUST)
def test_self_stress_presses_on_every_contact_and_balances(over: float, size: float) -> None:
    least = np.ones(8)
    least[[0, 4]] = over * BEARS * 1e-9
    assert ("press on every" in word(stress=least, size=size)) == (over < 1)
    uneven = np.ones(8)
    uneven[:4] += over * 1e-9 / 4
    assert ("does not balance" in word(stress=uneven, size=size)) == (over > 1)


def test_limits_themselves() -> None:
    """Numbers that are exact in binary: an imbalance and a stress at their limits."""
    limit = 2.0**-20
    assert word(forces=np.repeat([0.25 + limit / 4, 0.0], 4), blur=limit) == ""
    uneven = np.repeat([1.0, 1.0 - limit / 4], 4)
    assert word(stress=uneven, blur=limit) == ""
    least = np.ones(8)
    least[[0, 4]] = BEARS * limit
    assert "press on every" in word(stress=least, blur=limit)


@pytest.mark.parametrize("lever", [0.3, 0.01])
def test_self_stress_at_short_levers_presses_by_rounding(lever: float) -> None:
    """Two pairs on a line hold no turn about it, and the third presses too little."""
    three = ((-1.0, 0.0), (1.0, 0.0), (0.0, lever))
    for press, holds in ((2e-8, False), (1e-3, True)):
        if press * lever > 3e-9 and not holds:
            press = 1.1 * BEARS * 1e-9 * 0.1 / lever
        stress = np.tile([1.0, 1.0, press], 2)
        found = word(points=three, stress=stress, forces=[0.5, 0.5, 0, 0, 0, 0])
        assert (found == "") == holds
        assert ("no larger than rounding" in found or "press on every" in found) != holds


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize("along", [X, Y, -X])
def test_shifts_cost_nothing(over: float, along: Any) -> None:
    found = word(load=-Z + over * ACROSS * along, blur=2 * ACROSS)
    assert ("cost energy" in found) == (over > 1)


@pytest.mark.parametrize("over", JUST)
def test_faces_lie_on_faces_at_points_on_no_line(over: float) -> None:
    assert "faces" in word(flat=[True] * 7 + [False])
    least = over * np.sqrt(1e-10 / 2)
    thin = np.array([(-1.0, 0.0), (1.0, 0.0), (0.0, least), (0.0, -least)])
    assert ("faces" in word(at=thin)) == (over < 1)
    assert ("faces" in word(at=thin + 100.0)) == (over < 1)
    assert "faces" in word(at=np.zeros((4, 2)))
    assert "faces" in word(at=[*POINTS, *np.zeros((4, 2))])
    one = ((0.0, 0.0),)
    assert "faces" in word(points=one, forces=[1.0, 0.0], stress=[1.0, 1.0])


def test_where_faces_are_has_no_unit() -> None:
    found = []
    for size in (1.0, 1e3):
        parts = [Part(name, Box(size * np.ones(3)), Pose([0, 0, size * z]), grounded=z == 0)
                 for z, name in enumerate("ab")]  # fmt: skip
        assembly = Assembly(parts)
        contacts = kilter.contacts(assembly)
        program = build_program(assembly, contacts)
        problem = problem_of(program, features_of(program, contacts))
        found.append(faces_of(program, contacts, problem))
    assert found[0].flat.all()
    np.testing.assert_allclose(found[0].point, found[1].point, rtol=1e-12)
    np.testing.assert_allclose(np.ptp(found[0].point, axis=0), [1 / np.sqrt(0.75)] * 2 + [0])


def test_a_proof_is_not_written_to() -> None:
    proof = LockedTurns(np.ones(2), np.ones(2))
    with pytest.raises(ValueError, match="read-only"):
        proof.stress[0] = 2.0


def test_shifts_turn_nothing() -> None:
    rows = np.zeros((1, 12))
    rows[0, 2] = 1.0
    problem = Stationary(
        rows, np.zeros(12), np.zeros((1, 12, 12)), np.tile(np.arange(12), (1, 1)), 1e-9
    )
    free, across = shifts(problem)
    assert free.shape == (12, 5)
    assert across.shape == (12, 6)
    assert not free[[3, 4, 5, 9, 10, 11]].any()
    np.testing.assert_allclose(free.T @ across, 0.0, atol=1e-12)
    assert np.linalg.matrix_rank(across[[3, 4, 5, 9, 10, 11]]) == 6
