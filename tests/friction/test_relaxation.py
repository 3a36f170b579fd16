"""Every motion that obeys the law satisfies every row, at the root and in at least one case."""

import dataclasses

import numpy as np
import pytest
from witnessed import witnessed

from kilter.friction.contraction import contract, power_bound, shrunk
from kilter.friction.enclosure import cases, rescaled
from kilter.friction.exclusion import prove_no_motion, start_proof
from kilter.friction.exclusion_cases import breach
from kilter.friction.opening_motion import opening_motion
from kilter.friction.reduced_law import reduced_law
from kilter.work import Work, units_of

ROUNDING = 1e-7


def point_of(attempt, found, scale):
    """The columns of the true solution (a, f)."""
    law, program = attempt.law, found.program
    at = attempt.relaxation.columns
    scaled = law.law
    size = np.linalg.norm(law.allowed.T @ scaled.load)
    b = law.allowed.T @ scaled.columns(found.motion) / size / scale
    pushes = np.einsum("kij,kj->ki", scaled.basis, found.forces)
    pushes /= scaled.strength * size * np.sqrt(program.mass[program.free].sum())
    x = np.zeros(attempt.relaxation.width)
    fn, rough = pushes[:, 0], np.flatnonzero(program.mu > 0)
    ft = pushes[rough, 1 : 1 + law.directions]
    if program.planar:  # the points of a patch share it
        fn_group = np.bincount(law.group[rough], fn[rough], minlength=len(law.mu))
        ft = np.bincount(law.group[rough], ft[:, 0], minlength=len(law.mu))[:, None]
    else:
        fn_group = fn[rough]
    ut = (law.tangent @ b).reshape(-1, law.directions)
    slip = np.linalg.norm(ut, axis=1)
    x[at["motion"]], x[at["one"]], x[at["square"]] = b, 1.0, b @ b
    x[at["fn"]], x[at["un"]], x[at["ft"]] = fn, law.normal @ b, ft.ravel()
    x[at["ut"]], x[at["slip"]], x[at["loss"]] = ut.ravel(), slip, fn_group * slip
    x[at["total"]] = fn_group
    x[at["rest"]] = (
        (law.mu * fn_group)[:, None].repeat(len(attempt.relaxation.directions), 1).ravel()
    )
    x[at["rest"]] += (ft @ attempt.relaxation.directions.T).ravel()
    for columns, rows in zip(attempt.relaxation.twist_columns, law.twist, strict=True):
        x[columns] = rows @ b
    return x


def outside(attempt, bounds, found):
    """The worst violation of a row or bound by the true solution."""
    x = point_of(attempt, found, bounds.scale)
    program = attempt.relaxation.program(bounds)
    rows = program.matrix @ x
    worst = [program.row_lower - rows, rows - program.row_upper]
    worst += [program.lower - x, x - program.upper]
    return max(float(one.max(initial=0.0)) for one in worst)


def begun(program):
    law, work = reduced_law(program), Work(units_of(2))
    return start_proof(law, 1e-9, opening_motion(law, work=work), work)


KINDS = {
    "plane": {"planar": True},
    "plane, patches": {"planar": True, "corners": 2},
    "points": {},
    "one part": {"parts": 1, "patches": 4},
    "edges": {"corners": 2},
    "faces": {"corners": 4, "patches": 2},
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_true_motions_are_contained_and_never_excluded(kind):
    tried = moved = 0
    for seed in range(9):
        found = witnessed(seed, **KINDS[kind])
        if found is None:
            continue
        attempt, bounds = begun(found.program)
        tried += 1
        assert outside(attempt, bounds, found) < ROUNDING
        bounds = dataclasses.replace(bounds, cuts=True)
        assert outside(attempt, bounds, found) < ROUNDING
        bounds, power, answer, _ = power_bound(attempt, bounds)
        bounds = rescaled(attempt.relaxation.fastest, bounds, power)
        assert outside(attempt, bounds, found) < ROUNDING
        tight = shrunk(attempt, bounds, answer)
        moved += bool((tight.un < 0.99 * bounds.un).any())
        assert outside(attempt, tight, found) < ROUNDING
        for _ in range(25):  # down the tree, always in a case that contains it
            tight, power, answer, _ = power_bound(attempt, tight)
            where = breach(attempt.law, attempt.relaxation, tight, answer.x)
            if where.largest <= 0.0:
                break
            kept = [
                case
                for case in cases(attempt.law, tight, where.point, where.patch)
                if outside(attempt, case, found) < ROUNDING
            ]
            assert kept
            tight = kept[0]
        else:
            power = np.inf
        assert not attempt.closed(tight, power)
    assert tried >= 4
    assert moved


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_never_a_proof_where_a_motion_is_built_in(kind):
    for seed in range(100, 112):
        found = witnessed(seed, **KINDS[kind])
        if found is not None:
            answer = prove_no_motion(found.program, work=0.5)
            assert not answer.proved
            assert answer.bound > 1e-9


@pytest.mark.slow
def test_contraction_keeps_the_motion():
    found = witnessed(3, planar=True, corners=2)
    attempt, bounds = begun(found.program)
    bounds, power = contract(attempt, dataclasses.replace(bounds, cuts=True))
    assert power > 1e-9
    assert outside(attempt, bounds, found) < ROUNDING
