"""The bound of a linear program holds for any multipliers."""

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import csc_array

from kilter.solvers.highs import bounding
from kilter.solvers.problem import LinearProgram


def drawn(seed):
    """A feasible program with rows of all kinds, and its optimum."""
    rng = np.random.default_rng(seed)
    rows, columns = int(rng.integers(2, 9)), int(rng.integers(2, 9))
    matrix = rng.normal(size=(rows, columns)) * (rng.random((rows, columns)) < 0.7)
    inside = rng.uniform(-1, 1, columns)
    low, high = matrix @ inside - rng.random(rows), matrix @ inside + rng.random(rows)
    kind = rng.integers(0, 3, rows)
    low = np.where(kind == 0, matrix @ inside, np.where(kind == 1, -np.inf, low))
    high = np.where(kind == 0, matrix @ inside, np.where(kind == 2, np.inf, high))
    cost = rng.normal(size=columns)
    program = LinearProgram(
        cost, csc_array(matrix), low, high, -2 * np.ones(columns), 2 * np.ones(columns)
    )
    below, above = np.isfinite(low), np.isfinite(high)
    answer = linprog(
        cost, A_ub=np.vstack([matrix[above], -matrix[below]]),
        b_ub=np.concatenate([high[above], -low[below]]), bounds=(-2, 2),
    )  # fmt: skip
    return program, float(answer.fun), rng


@pytest.mark.quick(11)
@pytest.mark.parametrize("seed", range(20))
def test_bound_is_near_the_optimum_and_never_above(seed):
    program, optimum, rng = drawn(seed)
    solver = bounding()
    solver.load(program)
    answer = solver.solve()
    assert optimum - 1e-7 < answer.bound < optimum + 1e-9
    assert answer.objective == pytest.approx(optimum, abs=1e-7)
    for _ in range(20):  # whatever the multipliers are
        assert program.safe_bound(rng.normal(size=len(program.row_lower))) <= optimum + 1e-9
    turned = rng.normal(size=len(program.cost))
    again = solver.solve(turned)
    assert turned @ answer.x >= again.bound - 1e-9


def test_no_multipliers_no_bound():
    program, _, _ = drawn(0)
    assert program.safe_bound(np.empty(0)) == -np.inf
    assert program.safe_bound(np.full(len(program.row_lower), np.nan)) == -np.inf
