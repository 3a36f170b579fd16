"""The direction of least kappa, and its bound."""

from __future__ import annotations

import numpy as np
import pytest
from turning import UNSTABLE, directions, program_of, slot_and_float

from kilter.analysis.turning.least_instability import least_instability
from kilter.analysis.turning.nearest import nearest
from kilter.mechanics.forms import impending_motion, scaled_problem
from kilter.scenes import stacks
from kilter.solvers.clarabel import solve_quadratic
from sampled import sampled


def kappa_at(program, direction):
    """Kappa of one direction, by a program built for it alone."""
    quadratic = impending_motion(scaled_problem(program.turned(direction)))
    answer = solve_quadratic(quadratic, tolerance=1e-10)
    assert answer.residual < 1e-7
    mass = program.mass[program.free]
    return np.sqrt(answer.x @ (quadratic.quadratic @ answer.x) / (mass.sum() / mass.max()))


@pytest.mark.slow
@pytest.mark.parametrize("name", sampled(8, UNSTABLE))
def test_value_and_bound_meet_and_no_direction_is_below(name):
    program = program_of(name)
    best = least_instability(program)
    assert best.value - best.bound <= 1e-3
    assert best.bound <= best.value
    there = kappa_at(program, best.direction)
    assert there == pytest.approx(best.value, abs=1e-6)
    sample = np.vstack(
        [
            directions(program, 60),
            best.direction + 0.03 * directions(program, 20, seed=1),
        ]
    )
    kappa = [kappa_at(program, g) for g in sample]
    assert min(kappa) >= best.bound - 1e-7


@pytest.mark.parametrize("planar", [False, True])
def test_a_slider_and_a_floater_of_twice_its_mass(planar):
    # the slider falls only along x: kappa^2 = (2 + g_x^2) / 3, least on a whole circle
    assembly = slot_and_float(planar)
    best = least_instability(program_of(assembly))
    assert best.value == pytest.approx(np.sqrt(2 / 3), abs=1e-3)
    assert best.bound == pytest.approx(np.sqrt(2 / 3), abs=1e-3)
    assert abs(best.direction[0]) < 0.06


def test_where_a_direction_is_stable_it_is_0():
    best = least_instability(program_of(stacks.tower(2)))
    assert best.value == pytest.approx(0.0, abs=1e-6)
    assert best.direction == pytest.approx([0, 0, -1], abs=1e-6)


def test_nothing_is_free():
    best = least_instability(program_of(stacks.tower(2).with_grounded(["*"])))
    assert (best.value, best.bound, best.programs) == (0.0, 0.0, 0)


def test_a_limit_leaves_a_bound_that_holds():
    program = program_of("slot-and-float")
    best = least_instability(program, gap=0.0, limit=12)
    assert best.programs <= 12
    assert best.bound <= np.sqrt(2 / 3) <= best.value + 1e-9


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["wedge-on-wedge", "arch", "floating-block"])
def test_the_motion_that_remains_is_the_one_of_that_direction(name):
    program = program_of(name)
    near = nearest(program)
    for sense in (near.diamond, near.sphere):
        g = sense.direction / (np.abs(sense.direction).sum() if sense is near.diamond else 1.0)
        work = -(program.mass[:, None] * sense.motion[:, :3]).sum(axis=0) @ g
        assert work == pytest.approx(sense.value, rel=1e-7)
        assert program.velocities(sense.motion).min(initial=0.0) > -1e-7
    energy = program.mass @ (near.kappa.motion[:, :3] ** 2).sum(axis=1)
    assert energy > 0
    assert near.kappa.bound <= near.kappa.value
