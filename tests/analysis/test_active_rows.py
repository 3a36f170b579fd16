"""Quadratic programs whose active rows far outnumber the unknowns: the condensed system."""

import numpy as np
import pytest
from scipy.sparse import csc_array

from kilter.solvers import clarabel
from kilter.solvers.problem import ConicProgram


def program(seed: int, rows: int, unknowns: int = 8) -> ConicProgram:
    """The nearest point to a random one in a cone of many half-spaces, a quarter of them twice."""
    rng = np.random.default_rng(seed)
    matrix = rng.normal(size=(rows, unknowns))
    matrix[: rows // 4] = matrix[rows // 4 : 2 * (rows // 4)]
    return ConicProgram(
        quadratic=csc_array(np.diag(rng.uniform(0.5, 2.0, unknowns))),
        cost=rng.normal(size=unknowns),
        matrix=csc_array(matrix),
        bound=np.zeros(rows),
        equal=0,
        positive=rows,
        cones=np.empty(0, dtype=np.int64),
    )


@pytest.mark.parametrize("seed", range(4))
def test_both_systems_give_the_same_point(seed, monkeypatch):
    built = program(seed, 400)
    condensed = []
    once = clarabel._condensed
    monkeypatch.setattr(
        clarabel, "_condensed", lambda *a: condensed.append(once(*a)) or condensed[-1]
    )
    start = clarabel.solve_conic(built)
    rows = np.arange(200)
    x, y = clarabel._solve_active_set(built, rows, start)
    assert len(condensed) == 1
    monkeypatch.setattr(clarabel, "DENSE", 0)
    other, z = clarabel._solve_active_set(built, rows, start)
    assert len(condensed) == 1
    assert x == pytest.approx(other, abs=1e-9)
    active = built.matrix.toarray()[rows]
    assert active.T @ y == pytest.approx(active.T @ z, abs=1e-8)  # y itself is not unique


@pytest.mark.parametrize(("rows", "condensed"), [(80, False), (81, True)])
def test_only_rows_that_far_outnumber_the_unknowns_are_eliminated(rows, condensed, monkeypatch):
    built = program(1, 400)
    used = []
    monkeypatch.setattr(clarabel, "_condensed", lambda *a: used.append(a))  # None: the other way
    clarabel._solve_active_set(built, np.arange(rows), clarabel.solve_conic(built))
    assert bool(used) is condensed


def test_a_quadratic_function_that_is_not_convex_is_left_to_the_other_system():
    indefinite, row = csc_array(np.diag([1.0, -1e12])), csc_array(np.array([[1.0, 0.0]]))
    assert clarabel._condensed(indefinite, row, 1e-9) is None
