"""What would raise a margin, against the margin found anew after a small change."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from margins import program_of

from kilter.analysis.margins.load_limit import find_limit, gravity_wrench
from kilter.analysis.margins.tilt import find_tilt_margin
from kilter.analysis.margins.what_helps import what_helps
from kilter.assembly import Assembly, Load
from kilter.scenes import stacks, walls
from kilter.scenes.pieces import block, floor

X = np.array([1.0, 0.0, 0.0])
STEP = 1e-5


def by_kind(helps):
    return {one.what: one for one in helps}


def offset_pair(mu=(0.35, 0.3), above=700.0) -> Assembly:
    """A light block on a heavy one, with two coefficients of friction, not symmetric."""
    parts = [
        floor([-3, -3], [3, 3]),
        block("low", [-0.5, -0.7, 0], [0.6, 0.7, 0.5], density=1500.0),
        block("high", [-0.4, -0.5, 0.5], [0.35, 0.5, 1.5], density=above),
    ]
    from kilter.assembly import FrictionPair

    pairs = [FrictionPair(("floor", "low"), mu[0]), FrictionPair(("low", "high"), mu[1])]
    return Assembly(parts, friction_pairs=pairs)


def degrees(program) -> float:
    return float(np.degrees(find_tilt_margin(program).angle))


def with_mu(program, parts, more):
    a, b = (program.names.index(name) for name in parts)
    rows = (program.part_a == a) & (program.part_b == b)
    return program.with_rows(mu=program.mu + more * rows)


def with_mass(program, part, share):
    mass = program.mass.copy()
    mass[program.names.index(part)] *= 1 + share
    return program.with_rows(mass=mass)


@pytest.mark.slow
def test_friction_that_helps_the_tilt_by_finite_differences():
    program = program_of(offset_pair())
    found = by_kind(what_helps(program, find_tilt_margin(program), None, None, held=()))["friction"]
    assert found.parts == ("low", "high")
    slope = (
        degrees(with_mu(program, found.parts, STEP)) - degrees(with_mu(program, found.parts, -STEP))
    ) / (2 * STEP)
    assert slope == pytest.approx(found.gain, rel=1e-4)
    assert found.gain == pytest.approx(np.degrees(1 / (1 + 0.3**2)), rel=1e-6)


@pytest.mark.slow
def test_mass_that_helps_the_tilt_by_finite_differences():
    """The pair topples together: more weight below makes it safer."""
    program = program_of(offset_pair(mu=(2.0, 2.0), above=7000.0))
    found = by_kind(what_helps(program, find_tilt_margin(program), None, None, held=()))["mass"]
    one, other = (degrees(with_mass(program, found.parts[0], s)) for s in (STEP, -STEP))
    assert (one - other) / (2 * STEP) == pytest.approx(found.gain, rel=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("number", [1, 3])
def test_what_helps_the_load_factor_of_a_wall_by_finite_differences(number):
    wall = walls.ferris_tin_loi(number)
    program = program_of(wall)

    def factor(changed):
        return find_limit(changed, gravity_wrench(changed, X)).value

    limit = find_limit(program, gravity_wrench(program, X))
    found = by_kind(what_helps(program, None, limit, X, held=()))
    for kind, changed in (("friction", with_mu), ("mass", with_mass)):
        if kind not in found:
            continue
        one = found[kind]
        parts = one.parts if kind == "friction" else one.parts[0]
        up, down = (factor(changed(program, parts, s)) - limit.value for s in (1e-4, -1e-4))
        # the derivative where there is one, else a bound from above on both sides
        assert up <= 1e-4 * one.gain + 1e-8
        assert down <= -1e-4 * one.gain + 1e-8
    assert found


def test_what_helps_against_a_given_load():
    """A load at the middle of a block that slides: its mass and its friction help alike."""
    slab = stacks.block_on_slope(0.0, friction=0.4)
    program = program_of(dataclasses.replace(slab, loads=[Load("block", force=[100.0, 0, 0])]))
    base = program.with_rows(applied=np.zeros_like(program.applied))
    limit = find_limit(base, program.applied)
    found = by_kind(what_helps(program, None, limit, None, held=[1]))
    weight = 9810.0
    assert limit.value == pytest.approx(0.4 * weight / 100, rel=1e-8)
    assert found["friction"].gain == pytest.approx(weight / 100, rel=1e-6)
    assert found["mass"].gain == pytest.approx(0.4 * weight / 100, rel=1e-6)
    assert np.isinf(found["hold"].gain)


@pytest.mark.slow
def test_holding_a_part_gains_what_it_says():
    tower = stacks.tower(4, friction=2.0)
    program = program_of(tower)
    before = find_tilt_margin(program)
    found = by_kind(
        what_helps(program, before, None, None, held=np.flatnonzero(program.free).tolist())
    )["hold"]
    parts = [
        dataclasses.replace(p, grounded=p.grounded or p.name in found.parts) for p in tower.parts
    ]
    after = find_tilt_margin(program_of(dataclasses.replace(tower, parts=parts)))
    gained = np.degrees(after.angle - before.angle)
    assert gained == pytest.approx(found.gain, abs=1e-6)
    assert gained > 0
