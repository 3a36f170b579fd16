"""Contacts that carry force beyond rounding: a beam on two supports."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_array

from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.carrying import all_carry, carry_beyond_doubt, carrying_rows
from kilter.second_order.second_order_tolerances import BEARS

JUST = (0.9, 1.1)
"""Factors of a limit, on both sides of it [-]."""
NOTHING = np.zeros((2, 0))


def beam(lever: float, *more: tuple[float, float]) -> np.ndarray:
    """Rows of (height, tilt): a support under the centre and a support beside it."""
    return np.array([(1.0, 0.0), (1.0, lever), *more])


@pytest.mark.parametrize("lever", [1.0, 0.1, 0.01])
@pytest.mark.parametrize("force", [1e-2, 1e-4])
@pytest.mark.parametrize("over", JUST)
def test_a_support_carries_where_its_torque_is_more_than_what_is_missing(
    lever: float, force: float, over: float
) -> None:
    """For f small beside 1 the least eigenvalue is f l^2, so f m > r^2 is f l > r."""
    missing = force * lever / over
    forces = np.array([1.0, force])
    assert all_carry(csr_array(beam(lever)), forces, missing) == (over > 1.0 + force)


@pytest.mark.parametrize("seed", range(20))
def test_forces_that_balance_to_the_last_digit_push_on_all_that_carry(seed: int) -> None:
    random = np.random.default_rng(seed)
    rows = random.normal(size=(7, 4))
    forces = 10.0 ** random.uniform(-6, 0, 7)
    miss = random.normal(size=4)
    miss /= np.linalg.norm(miss)
    gram = rows.T @ (forces[:, None] * rows)
    change = np.abs(rows @ np.linalg.solve(gram, miss)).max()
    least = np.sqrt(forces.min() * np.linalg.eigvalsh(gram)[0])  # of what may be missing
    assert all_carry(csr_array(rows), forces, 0.99 * least)
    assert not all_carry(csr_array(rows), forces, 1.01 * least)
    assert least * change < 1


def test_what_they_do_not_hold_is_neutral_or_they_do_not_carry_it() -> None:
    row, one = csr_array(np.array([[1.0, 0.0]])), np.ones(1)
    tilt = np.array([[0.0], [1.0]])
    assert not all_carry(row, one, 1e-9)
    assert all_carry(row, one, 1e-9, tilt)
    assert not all_carry(row, one, 1e-9, tilt[::-1])
    assert not all_carry(row[:0], one[:0], 1e-9)
    assert not all_carry(row, one, 1e-9)
    for size in (1e3, 1e-3):  # what is lost in the rounding of the rest
        for lever in (0.9e-3, 1.1e-3):
            forces = size * np.array([1.0, 1e-7])
            found = all_carry(csr_array(beam(lever)), forces, 0.0)
            assert found == (lever > 1e-3)


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize("size", [1.0, 0.01, 100.0])
def test_of_a_problem_what_is_missing_and_what_may_be_counts(over: float, size: float) -> None:
    def carries(force: float, *, load: float = 0.0, blur: float = 1e-9) -> bool:
        rows = beam(0.5)
        forces = size * np.array([1.0, force])
        borne = -rows.T @ forces + size * load * np.eye(2)[1]
        problem = Stationary(rows, borne, np.zeros((2, 12, 12)), np.full((2, 12), -1), blur)
        every = np.ones(2, dtype=bool)
        return carry_beyond_doubt(problem, forces, every, NOTHING, problem.load)

    rounding = 1e-9 * np.sqrt(2)
    assert carries(over * 2 * rounding) == (over > 1)
    assert carries(over * 20 * rounding, blur=1e-8) == (over > 1)
    assert carries(over * 2e-3, load=1e-3) == (over > 1)


@pytest.mark.parametrize("over", JUST)
def test_a_row_carries_where_its_force_is_more_than_what_may_be_out_of_balance(
    over: float,
) -> None:
    for blur, size in ((1e-9, 3.0), (1e-8, 0.5), (1e-12, 1.0)):
        problem = Stationary(
            np.eye(2), np.ones(2), np.zeros((2, 12, 12)), np.full((2, 12), -1), blur
        )
        small = over * BEARS * max(blur, 1e-9) * size
        assert carrying_rows(problem, np.array([size, small])).tolist() == [True, over > 1]
    assert not carrying_rows(problem, np.zeros(2)).any()
    limit = 2.0**-20  # exact in binary
    exact = Stationary(np.eye(2), np.ones(2), np.zeros((2, 12, 12)), np.full((2, 12), -1), limit)
    assert carrying_rows(exact, np.array([1.0, BEARS * limit])).tolist() == [True, False]
