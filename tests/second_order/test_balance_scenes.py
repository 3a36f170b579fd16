"""The cases of second order are in equilibrium, and every gap has a form."""

from __future__ import annotations

import numpy as np
import pytest
from balance_cases import CASES, ROLLING, Case
from scipy.optimize import nnls

import kilter
from kilter.arrays import Array
from kilter.mechanics.program import build_program
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import formed, gap_forms

ALL = [*CASES, *ROLLING]


def parameters(case: Case) -> list[float]:
    """Two parameters on both sides of the limit, or a single one without a limit."""
    return [0.0] if case.limit is None else [case.limit - 0.1, case.limit + 0.1]


def lagrangian(case: Case, parameter: float) -> tuple[Array, Array, Array, float]:
    """Rows J, -lambda . phi'' with forces lambda >= 0, the load, and the imbalance."""
    given = case.build(parameter)
    contacts = kilter.contacts(given)
    program = build_program(given, contacts)
    features = features_of(program, contacts)
    assert formed(program, features).all()
    forms = gap_forms(program, features)
    rows = program.jacobian().toarray()
    load = program.load[program.free].reshape(-1)
    forces, off = nnls(rows.T, -load)
    place = np.cumsum(program.free) - 1
    second = np.zeros((rows.shape[1], rows.shape[1]))
    for k, force in enumerate(forces):
        ends = [(6 * e, int(p)) for e, p in enumerate((program.part_a[k], program.part_b[k]))]
        ends = [(e, 6 * int(place[p])) for e, p in ends if p >= 0 and program.free[p]]
        for e, p in ends:
            for f, q in ends:
                second[p : p + 6, q : q + 6] -= force * forms[k][e : e + 6, f : f + 6]
    return rows, second, load, off


def test_there_are_as_many_as_the_reference_has() -> None:
    assert len({case.number.rstrip("b") for case in CASES}) == 39
    assert len({case.number for case in ROLLING}) == 9


@pytest.mark.quick(5)
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.number)
def test_a_case_is_in_balance(case: Case) -> None:
    for parameter in parameters(case):
        _, second, load, off = lagrangian(case, parameter)
        assert off < 1e-12 * np.abs(load).max()
        np.testing.assert_allclose(second, second.T, atol=1e-12 * np.abs(load).max())


SINGLE = [case for case in CASES if case.number not in ("11", "13", "14", "24", "24b", "39")]
"""Cases that a single set of forces and both signs of every neutral motion decide."""


@pytest.mark.quick(3)
@pytest.mark.parametrize("case", SINGLE, ids=lambda case: case.number)
def test_the_energy_falls_where_it_is_known_to(case: Case) -> None:
    """The sign of the least eigenvalue on the neutral motions, and the number of zeros."""
    states = [case.state] if case.above is None else [case.state, case.above]
    for parameter, state in zip(parameters(case), states, strict=True):
        rows, second, load, _ = lagrangian(case, parameter)
        _, sizes, axes = np.linalg.svd(rows)
        neutral = axes[int((sizes > 1e-9 * sizes[0]).sum()) :].T
        values = np.linalg.eigvalsh(neutral.T @ second @ neutral) / np.abs(load).max()
        if state == "balanced":
            assert values[0] < -1e-3
        else:
            assert values[0] > -1e-9
            assert int((values < 1e-9).sum()) == case.free


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", ROLLING, ids=lambda case: case.number)
def test_what_rolls_stands_by_friction_to_first_order(case: Case) -> None:
    for parameter in parameters(case):
        given = case.build(parameter)
        assert kilter.check(given, effort=1, require="equilibrium").stable
