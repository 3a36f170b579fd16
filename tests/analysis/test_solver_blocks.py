"""Small independent equilibria: each block has the answer of a second solver, and a valid proof."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import block_diag, csc_array

from kilter.solvers.blocks import Blocks, solve_blocks


def random_blocks(seed: int, count: int) -> tuple[Blocks, list[np.ndarray]]:
    """Random equilibria; about half of them are solvable, and every seventh has no rows."""
    rng = np.random.default_rng(seed)
    matrices, sides = [], []
    for k in range(count):
        rows, columns = (
            (0, 3) if k % 7 == 6 else (int(rng.integers(2, 9)), int(rng.integers(3, 13)))
        )
        matrix = rng.normal(size=(rows, columns))
        inside = matrix @ rng.uniform(0.1, 1.0, columns)
        matrices.append(matrix)
        sides.append(inside if rng.random() < 0.5 else rng.normal(size=rows))
    start = [np.cumsum([0, *(m.shape[axis] for m in matrices)]) for axis in (0, 1)]
    two_sided = rng.random(start[1][-1]) < 0.1
    whole = csc_array(block_diag([m for m in matrices if m.size] or [np.zeros((0, 0))]))
    wide = csc_array((start[0][-1], start[1][-1])).tolil()
    kept = np.concatenate(
        [
            np.arange(a, b)
            for a, b, m in zip(start[1], start[1][1:], matrices, strict=False)
            if m.size
        ]
    )
    wide[:, kept] = whole.tolil()
    return Blocks(csc_array(wide), np.concatenate(sides), two_sided, *start), matrices


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.quick(1)
def test_each_block_has_the_answer_of_a_second_solver(seed: int) -> None:
    """A second solver decides each block; forces and multipliers are verified from the numbers."""
    blocks, matrices = random_blocks(seed, 40)
    which = np.flatnonzero(np.random.default_rng(seed).random(40) < 0.8)
    answers = solve_blocks(blocks, which)
    skipped = np.setdiff1d(np.arange(40), which)
    assert np.isnan(answers.factor[skipped]).all()
    outcomes = set()
    for k in which.tolist():
        rows, columns = (slice(*s[k : k + 2]) for s in (blocks.row_start, blocks.column_start))
        matrix, right = matrices[k], blocks.right[rows]
        free = blocks.two_sided[columns]
        bounds = [(None, None) if two else (0, None) for two in free]
        holds = (
            not len(right)
            or linprog(np.zeros(matrix.shape[1]), A_eq=matrix, b_eq=right, bounds=bounds).success
        )
        assert (answers.factor[k] > 0.5) == holds
        outcomes.add(holds)
        if holds:
            forces = answers.forces[columns]
            assert np.abs(matrix @ forces - right).max(initial=0.0) < 1e-7
            assert forces[~free].min(initial=0.0) > -1e-9
        else:
            y = answers.multipliers[rows]
            assert right @ y > 0
            assert (matrix.T @ y)[~free].max(initial=0.0) < 1e-7
            assert np.abs((matrix.T @ y)[free]).max(initial=0.0) < 1e-7
    assert outcomes == {True, False}
