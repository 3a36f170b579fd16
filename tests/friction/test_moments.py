"""Moments: every true motion satisfies every product, and no bound falls below its power."""

import dataclasses

import numpy as np
import pytest
from cases import program
from witnessed import witnessed

from kilter.friction.force_bound import force_bound
from kilter.friction.moment_bound import MomentStep, power_left
from kilter.friction.moment_forms import moment_forms
from kilter.friction.moment_products import law_products, monomials
from kilter.friction.moments import moment_program, moment_proof
from kilter.friction.opening_motion import opening_motion
from kilter.friction.reduced_law import reduced_law
from kilter.scenes import friction, stacks
from kilter.solvers.clarabel import solve_semidefinite
from kilter.work import Work, units_of
from sampled import sampled

KINDS = {
    "points": {},
    "one part": {"parts": 1, "patches": 4},
    "edges": {"corners": 2},
    "faces": {"corners": 4, "patches": 2},
}


def true_motion(law, found):
    """Motion, forces along the normals and across them, in the units of the law."""
    scaled, owner = law.law, found.program
    size = np.linalg.norm(law.allowed.T @ scaled.load)
    pushes = np.einsum("kij,kj->ki", scaled.basis, found.forces)
    pushes /= scaled.strength * size * np.sqrt(owner.mass[owner.free].sum())
    motion = law.allowed.T @ scaled.columns(found.motion) / size
    rough = law.rows[law.group >= 0]
    return motion, pushes[law.rows, 0], pushes[rough, 1 : 1 + law.directions]


def sums(forms, rows, values):
    products = rows.weight * values[rows.left] * values[rows.right]
    return np.bincount(rows.row, products, minlength=rows.count)


def known(seed, kind):
    found = witnessed(seed, **KINDS[kind])
    if found is None:
        return None
    law = reduced_law(found.program)
    return law, *true_motion(law, found)


@pytest.mark.quick(1)
@pytest.mark.parametrize("kind", KINDS)
def test_a_true_motion_satisfies_every_product(kind):
    tried = 0
    for seed in range(6):
        one = known(seed, kind)
        if one is None:
            continue
        law, motion, along, across = one
        tried += 1
        scale = float(np.linalg.norm(motion)) * 1.01
        forms = moment_forms(law, scale)
        slip = np.linalg.norm((law.tangent @ motion).reshape(-1, law.directions), axis=1)
        z = np.concatenate([[1.0], motion / scale, along, across.ravel(), slip / scale])
        values, place = forms.rows @ z, monomials(forms)
        rows = law_products(forms, place)
        size = 1e-7 * (1.0 + np.abs(values).max()) ** 2
        assert np.abs(sums(forms, rows.equal, values)).max() < size
        assert sums(forms, rows.positive, values).min() > -size
        cones = sums(forms, rows.cones, values).reshape(-1, 1 + law.directions)
        assert (np.linalg.norm(cones[:, 1:], axis=1) - cones[:, 0]).max() < size
    assert tried >= 3


@pytest.mark.slow
@pytest.mark.parametrize("kind", sampled(2, KINDS))
def test_no_bound_falls_below_a_true_motion(kind):
    tried = 0
    for seed in range(6):
        one = known(seed, kind)
        if one is None:
            continue
        law, motion, along, _ = one
        work = Work(units_of(2))
        opening = opening_motion(law, work=work)
        if opening is None or not np.isfinite(force_bound(law, opening)):
            continue
        tried += 1
        assert along.sum() <= force_bound(law, opening) * (1 + 1e-7)
        answer = moment_proof(law, opening, 1e-9, work=work)
        assert answer.power >= (law.load @ motion) * (1 - 1e-7)
    assert tried >= 2


def test_any_multipliers_give_a_bound():
    """Randomly changed multipliers of a solver give worse bounds, but never too low."""
    law, motion, _, _ = next(filter(None, (known(seed, "one part") for seed in range(9))))
    work, rng = Work(), np.random.default_rng(0)
    forces = force_bound(law, opening_motion(law, work=work))
    found = solve_semidefinite(moment_program(moment_forms(law, 1.0), "pairs"), work=work)
    power = law.load @ motion
    for size in (0.0, 1e-6, 1e-3, 1.0):
        spoilt = [one + size * rng.normal(size=one.shape) for one in (
            found.equal, found.positive, found.cones)]  # fmt: skip
        squares = tuple(one + size * rng.normal(size=one.shape) for one in found.squares)
        equal, positive, cones = spoilt
        wrong = dataclasses.replace(
            found, equal=equal, positive=positive, cones=cones, squares=squares
        )
        step = MomentStep(1.0, "pairs", wrong)
        assert power_left(law, step, forces) >= power * (1 - 1e-7)


@pytest.mark.slow
def test_multipliers_that_do_not_fit_bound_nothing():
    law = reduced_law(program(stacks.block_on_slope(20.0, friction=0.5)))
    work = Work()
    opening = opening_motion(law, work=work)
    (step, *_) = moment_proof(law, opening, 1e-8, work=work).steps
    forces = force_bound(law, opening)
    assert power_left(law, step, forces) < 1e-6
    short = dataclasses.replace(step.multipliers, equal=step.multipliers.equal[1:])
    assert power_left(law, dataclasses.replace(step, multipliers=short), forces) == 1.0
    wrong = step.multipliers.positive.copy()
    wrong[0] = np.nan
    wrong = dataclasses.replace(step.multipliers, positive=wrong)
    assert power_left(law, dataclasses.replace(step, multipliers=wrong), forces) == 1.0
    assert power_left(law, step, np.inf) == 1.0


@pytest.mark.slow
@pytest.mark.parametrize(("tilt", "closed"), [(44.0, True), (44.15, False), (45.0, False)])
def test_trough_on_both_sides_of_its_limit(tilt, closed):
    law = reduced_law(program(friction.trough(30.0, tilt=tilt)))
    work = Work(units_of(2))
    answer = moment_proof(law, opening_motion(law, work=work), 1e-8, work=work)
    assert (answer.power <= 1e-8) == closed


def test_forces_of_parts_that_jam_have_no_bound():
    jammed = reduced_law(program(friction.h_block()))
    opening = opening_motion(jammed, work=Work())
    assert opening is None or not np.isfinite(force_bound(jammed, opening))
    free = reduced_law(program(stacks.tower(2, friction=0.5)))
    bound = force_bound(free, opening_motion(free, work=Work()))
    assert 1.0 <= bound < 10.0  # two of the same weight carry 1.5 of both
    assert force_bound(free, np.zeros(len(free.load))) == np.inf
