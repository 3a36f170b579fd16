"""The least friction: closed forms, few programs, proofs of both sides, what a squeeze holds."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from margins import program_of
from random_turned import random_turned

from kilter.analysis.decision.cohesion import find_cohesion
from kilter.analysis.decision.judge import judge
from kilter.analysis.margins.least_friction import find_least_friction
from kilter.analysis.margins.squeeze import held_by_squeeze, squeeze
from kilter.assembly import Assembly, GivenContact
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.coulomb_cones import cone_problem
from kilter.mechanics.mechanics_tolerances import RULED_OUT, TOLERANCE
from kilter.scenes import friction, scene, stacks
from kilter.scenes.pieces import block, floor


@pytest.mark.slow
def test_a_wall_over_an_opening_needs_a_fifth():
    """Its closed form, and the verdict a millionth beside it."""
    opening = scene("wall-with-opening")
    assert find_least_friction(program_of(opening)).value == pytest.approx(0.2, rel=1e-7)
    for share, holds in ((1 + 1e-6, True), (1 - 1e-6, False)):
        program = program_of(opening).with_friction(0.2 * share)
        cohesion = find_cohesion(cone_problem(program))
        assert (cohesion.value < 0) is holds
        assert check_forces(program, cohesion.forces, cohesion.friction).holds is holds


def sides_wrong(program, found, least):
    """What is wrong of a least friction of a closed form, and of verdicts on either side of it."""
    wrong = [] if found.lower < least <= found.value * (1 + 1e-15) else ["the truth lies outside"]
    if found.value > least * (1 + 1e-7) + TOLERANCE / 10:
        wrong.append(f"{found.value / least - 1} too much")
    if found.forces.residual > 1e-12:
        wrong.append(f"forces leave {found.forces.residual}")
    for mu, holds in ((found.lower, False), (found.value, True)):
        if judge(program.with_friction(mu)).stable is not holds:
            wrong.append(f"the verdict at {mu}")
    return wrong


@pytest.mark.quick(1)
@pytest.mark.parametrize("tangent", [1e-2, 1e-4, 1e-5, 3e-6])
def test_the_truth_lies_within_however_tiny_the_coefficient(tangent):
    """A slope: what a certificate lets forces leave is 1e-9 of the weight, 1e-4 of the last."""
    slope = program_of(stacks.block_on_slope(float(np.degrees(np.arctan(tangent)))))
    found = find_least_friction(slope)
    assert sides_wrong(slope, found, tangent) == []
    assert found.value - found.lower < 4 * TOLERANCE + 1e-7 * tangent
    off = dataclasses.replace(found, value=found.value * (1 - 2 * TOLERANCE / tangent - 2e-7))
    assert "the truth lies outside" in sides_wrong(slope, off, tangent)


def test_a_block_between_leaning_plates_that_slides_along_them():
    """Normals carry it, friction what gravity has along the trough; it leans, so that they grow."""
    program = program_of(random_turned("wedge", 72))
    across, _, up = np.abs(program.normal[0])
    _, along, down = np.abs(program.down)
    least = up * along / np.hypot(down, across * along)
    assert least < 1e-4
    assert sides_wrong(program, find_least_friction(program), least) == []


def test_both_sides_of_a_tiny_coefficient_of_three_wedges():
    """No closed form: forces that balance to rounding, a motion, and what the cohesion says."""
    program = program_of(random_turned("wedge", 60))
    found = find_least_friction(program)
    assert found.value < 1e-3
    assert check_forces(program.with_friction(found.value), found.forces.forces,
                        found.forces.friction).residual < 1e-12  # fmt: skip
    assert check_motion(program.with_friction(found.lower), found.motion.motion).holds
    above = find_cohesion(cone_problem(program.with_friction(found.value * (1 + 1e-6))))
    below = find_cohesion(cone_problem(program.with_friction(found.value * (1 - 1e-6))))
    assert above.value < 0 < below.value
    assert find_cohesion(cone_problem(program.with_friction(found.lower))).value < 2 * TOLERANCE


@pytest.mark.slow
def test_data_that_no_forces_balance_to_rounding_are_held_as_far_as_a_certificate_lets_them():
    """One point under a block, a little beside its centre: a torque is left, whatever forces do."""
    lean = np.array([np.sin(0.1), 0.0, np.cos(0.1)])
    point = GivenContact(("floor", "block"), [[3e-10, 0.0, 0.0]], lean)
    parts = [floor([-1, -1], [1, 1]), block("block", [-0.5, -0.5, 0.0], [0.5, 0.5, 1.0])]
    found = find_least_friction(program_of(Assembly(parts, contacts=[point], detect=False)))
    assert found.value == pytest.approx(np.tan(0.1), rel=1e-6)
    assert 1e-10 < found.forces.residual <= TOLERANCE
    assert found.forces.holds


@pytest.mark.parametrize("degrees", [5.0, 20.0, 40.0])
def test_the_cohesion_of_a_block_on_a_slope(degrees):
    """Its four contacts share what its weight needs along the slope beyond mu of that across."""
    angle, mu = np.radians(degrees), 0.3
    found = find_cohesion(cone_problem(program_of(stacks.block_on_slope(degrees, friction=mu))))
    needed = (np.sin(angle) - mu * np.cos(angle)) / 4
    assert found.value == pytest.approx(needed, abs=1e-8)
    assert found.slope == pytest.approx(np.cos(angle) / 4, abs=1e-6)
    assert mu + found.rise == pytest.approx(np.tan(angle), abs=1e-7)


def test_any_friction_holds_what_is_squeezed_however_indirectly():
    """The plate that presses the books slides in guides: they jam it first, then it presses."""
    books = program_of(friction.books())
    pressed = squeeze(books.frictionless) > 0
    guides = {"guide-below", "guide-above", "guide-front", "guide-back"}
    for row in np.flatnonzero(pressed):
        assert books.names[books.part_a[row]] in guides or books.names[books.part_b[row]] in guides
    found = find_least_friction(books)
    assert (found.value, found.attained) == (0.0, False)
    assert found.forces.holds
    assert all(judge(books.with_friction(mu)).stable for mu in (1e-3, 1e-2, 0.1))


@pytest.mark.slow
def test_no_squeeze_holds_what_gravity_takes_out_of_it():
    """A block between plates that lean by an angle slips out below its tangent.

    The forces grow with the inverse of the distance from this limit, up to `RULED_OUT` weights.
    """
    leaning = program_of(friction.a_block(10.0))
    assert held_by_squeeze(leaning) is None
    limit, found = np.tan(np.radians(10.0)), find_least_friction(leaning)
    assert limit < found.value < limit + 2 / RULED_OUT
