"""A kept program: the same optimum as one solved afresh, and never believed unseen."""

import numpy as np
import pytest
from scipy.sparse import csc_array, random_array

from kilter.solvers.kept import KeptProgram, KeptSolution
from kilter.solvers.linear import solve_linear
from kilter.solvers.problem import LinearProgram


def random_program(seed: int, rows: int = 15, columns: int = 30) -> LinearProgram:
    random = np.random.default_rng(seed)
    matrix = csc_array(random_array((rows, columns), density=0.3, rng=random, format="csc"))
    middle = matrix @ random.random(columns)
    return LinearProgram(
        random.normal(size=columns),
        matrix,
        middle - random.random(rows),
        middle + random.random(rows),
        np.zeros(columns),
        np.full(columns, 2.0),
    )


@pytest.mark.parametrize("seed", range(5))
def test_a_new_cost(seed: int) -> None:
    program = random_program(seed)
    kept = KeptProgram(program)
    random = np.random.default_rng(seed)
    for _ in range(10):
        cost = random.normal(size=len(program.cost))
        kept.change_cost(np.arange(len(cost)), cost)
        found = kept.solve()
        fresh = solve_linear(kept.program)
        assert found.holds
        assert found.objective == pytest.approx(fresh.objective, abs=1e-9)
    assert kept.solves == 10
    assert program.cost is not kept.program.cost


def test_new_bounds_and_entries() -> None:
    kept = KeptProgram(random_program(1))
    kept.solve()
    kept.change_bounds([0, 3], [0.5, 0.25], [0.5, 0.25])
    row = int(kept.program.matrix.indices[kept.program.matrix.indptr[2]])
    kept.change_row(row, [2], [0.125])
    found = kept.solve()
    assert found.x[[0, 3]].tolist() == [0.5, 0.25]
    assert kept.program.matrix[row, 2] == 0.125
    assert found.objective == pytest.approx(solve_linear(kept.program).objective, abs=1e-9)


def test_a_wrong_answer_is_solved_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """A warm answer that is not optimal, whatever its status said, is not given out."""
    kept = KeptProgram(random_program(2))
    right = kept.solve()
    run, told = KeptProgram._run, []

    def wrong_once(self: KeptProgram, strategy: int, steps: int) -> KeptSolution:
        found = run(self, strategy, steps)
        told.append(found.gap)
        if len(told) == 1:
            return KeptSolution(found.x, found.multipliers, found.reduced, found.objective, 1.0)
        return found

    monkeypatch.setattr(KeptProgram, "_run", wrong_once)
    again = kept.solve()
    assert len(told) == 2
    assert again.objective == pytest.approx(right.objective)


def test_the_gap_sees_what_is_wrong() -> None:
    from kilter.solvers.kept import _recomputed

    kept = KeptProgram(random_program(3))
    found = kept.solve()
    program = kept.program
    worse = found.x.copy()
    inner = int(np.argmin(np.abs(worse - 1.0)))
    worse[inner] = 3.0  # beyond its bound
    assert not _recomputed(program, worse, found.multipliers).holds
    assert not _recomputed(program, found.x, found.multipliers * 1.01 + 0.01).holds
    assert not _recomputed(program, found.x * np.nan, found.multipliers).holds


def test_infeasible_and_unbounded_do_not_hold() -> None:
    one = np.ones(1)
    matrix = csc_array(one[None])
    infeasible = LinearProgram(one, matrix, 5 * one, 6 * one, 0 * one, one)
    assert not KeptProgram(infeasible).solve().holds
    unbounded = LinearProgram(-one, matrix, -np.inf * one, np.inf * one, 0 * one, np.inf * one)
    assert not KeptProgram(unbounded).solve().holds
