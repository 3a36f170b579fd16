"""Changes that raise a margin, against closed forms and the margin of the changed assembly."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from margins import program_of

from kilter.analysis.load_limit import find_limit, gravity_wrench
from kilter.analysis.margins.tilt import find_tilt_margin
from kilter.analysis.margins.what_helps import what_helps
from kilter.assembly import Assembly, Load
from kilter.scenes import arches, rounds, stacks, walls
from kilter.scenes.pieces import block, floor

X = np.array([1.0, 0.0, 0.0])


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
def test_friction_that_helps_the_tilt_is_that_of_the_law():
    """The upper block slides at atan mu until the lower one does."""
    program = program_of(offset_pair())
    found = by_kind(what_helps(program, find_tilt_margin(program), None, None, held=()))["friction"]
    assert found.parts == ("low", "high")
    gain = np.degrees(np.arctan(0.35) - np.arctan(0.3))
    assert found.gain == pytest.approx(gain, rel=1e-6)


@pytest.mark.slow
def test_mass_that_helps_the_tilt_moves_the_centre():
    """The pair topples together over x = -0.5: tan is the lever over the height of the centre."""
    program = program_of(offset_pair(mu=(2.0, 2.0), above=7000.0))
    found = by_kind(what_helps(program, find_tilt_margin(program), None, None, held=()))["mass"]
    assert (found.parts, found.by) == (("low",), 0.1)
    low, high = 1500 * 1.1 * 1.4 * 0.5, 7000 * 0.75 * 1.0 * 1.0

    def tilt(below):
        moment = below * np.array([0.05, 0.25]) + high * np.array([-0.025, 1.0])
        center = moment / (below + high)
        return np.degrees(np.arctan((center[0] + 0.5) / center[1]))

    assert found.gain == pytest.approx(tilt(1.1 * low) - tilt(low), rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("build", "push"),
    [
        (lambda: arches.arch(20), None),
        (lambda: two_slabs(), None),
        (lambda: rounds.three_cylinders(), None),
        (lambda: walls.ferris_tin_loi(1), X),
        (lambda: walls.ferris_tin_loi(3), X),
    ],
    ids=["arch", "two slabs", "cylinders", "wall 1", "wall 3"],
)
def test_a_gain_is_that_of_the_changed_assembly(build, push):
    """Several mechanisms start at each of these limits: the derivatives of one are wrong."""
    assembly = build()
    program = program_of(assembly)

    def margin(changed):
        if push is None:
            return degrees(changed)
        return find_limit(changed, gravity_wrench(changed, push)).value

    tilt = find_tilt_margin(program) if push is None else None
    factor = None if push is None else find_limit(program, gravity_wrench(program, push))
    for one in what_helps(program, tilt, factor, push, held=()):
        changed = (
            with_mu(program, one.parts, one.by)
            if one.what == "friction"
            else with_mass(program, one.parts[0], one.by)
        )
        assert one.gain > 0
        assert margin(changed) - margin(program) == pytest.approx(one.gain, rel=1e-6)


def test_more_friction_under_one_of_two_equal_slabs_is_not_listed():
    program = program_of(two_slabs())
    helps = what_helps(program, find_tilt_margin(program), None, None, held=())
    assert "friction" not in by_kind(helps)


def two_slabs() -> Assembly:
    """Two equal slabs side by side, which start to slide at the same tilt."""
    parts = [floor([-5, -5], [5, 5])]
    parts += [block(f"slab-{k}", [3 * k, 0, 0], [3 * k + 1, 1, 0.2]) for k in range(2)]
    return Assembly(parts, friction=0.3)


def test_what_helps_against_a_given_load():
    """A load at the middle of a block that slides: its mass and its friction help alike."""
    slab = stacks.block_on_slope(0.0, friction=0.4)
    program = program_of(dataclasses.replace(slab, loads=[Load("block", force=[100.0, 0, 0])]))
    base = program.with_rows(applied=np.zeros_like(program.applied))
    limit = find_limit(base, program.applied)
    found = by_kind(what_helps(program, None, limit, None, held=[1]))
    weight = 9810.0
    assert limit.value == pytest.approx(0.4 * weight / 100, rel=1e-8)
    assert found["friction"].gain == pytest.approx(0.1 * weight / 100, rel=1e-6)
    assert found["mass"].gain == pytest.approx(0.1 * 0.4 * weight / 100, rel=1e-6)
    assert np.isinf(found["hold"].gain)
