"""The worst case over intervals: every assembly within them is at least as safe."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from margins import program_of, small_assembly

import kilter
from kilter.analysis.decision.judge import judge
from kilter.analysis.load_limit import NoLimit, find_limit, gravity_wrench
from kilter.analysis.margins import following_forces, uncertainty
from kilter.analysis.margins.tilt import find_tilt_margin
from kilter.analysis.margins.uncertainty import Ranges, corner, find_uncertainty
from kilter.arrays import cross
from kilter.mechanics.rows import CONTACT
from kilter.scenes import stacks, walls
from kilter.tell.facts import facts

X = np.array([1.0, 0.0, 0.0])


def planar(assembly):
    return dataclasses.replace(assembly, planar=True)


def sampled(program, ranges, random):
    """A program within the intervals."""
    count = len(program.names)
    free = program.free
    mass = np.where(free, random.uniform(*ranges.mass, size=count), 1.0)
    shift = random.uniform(-ranges.center, ranges.center, size=(count, 3)) * free[:, None]
    if program.planar:
        shift[:, 1] = 0.0
    other = corner(program, mass, shift)
    mu = program.mu * random.uniform(*ranges.mu, size=len(program.mu))
    turn = random.normal(size=(len(program.mu), 3))
    if program.planar:
        turn *= [0, 1, 0]
    turn /= np.linalg.norm(turn, axis=1)[:, None]
    aside = cross(turn, program.normal)
    aside /= np.maximum(np.linalg.norm(aside, axis=1), 1e-12)[:, None]
    angle = np.radians(ranges.normal_deg) * random.uniform(0, 1, size=(len(program.mu), 1))
    normal = np.cos(angle) * program.normal + np.sin(angle) * aside
    normal = np.where((program.kind == CONTACT)[:, None], normal, program.normal)
    return other.with_rows(mu=mu, normal=normal)


def is_at_least_as_safe(program, ranges, worst, random):
    """One sample, at a random turn as far as the worst case allows, and a random load factor."""
    other = sampled(program, ranges, random)
    angle = random.uniform(0, 2 * np.pi)
    aside = np.array([np.cos(angle), 0.0 if program.planar else np.sin(angle), 0.0])
    aside /= np.linalg.norm(aside)
    tilt = np.radians(worst.tilt_deg) * (1 - 1e-6)
    size = float(np.linalg.norm(program.gravity))
    down = size * (np.cos(tilt) * np.array([0, 0, -1.0]) + np.sin(tilt) * aside)
    assert judge(other.with_rows(gravity=down)).stable is True
    for end in worst.load_factor:
        share = np.clip(end, -9, 9) * (1 - 1e-6)
        more = other.applied + share * gravity_wrench(other, X)
        assert judge(other.with_rows(applied=more)).stable is True


CASES = {
    "masses": (lambda: stacks.tower(3, friction=0.3), Ranges(mass=(0.7, 1.2))),
    "one-block": (
        lambda: stacks.block_on_slope(0.0, friction=0.9),
        Ranges(mass=(0.9, 1.1), center=0.1, mu=(0.7, 1.3)),
    ),
    "planar": (
        lambda: planar(stacks.tower(2, friction=0.4)),
        Ranges(mass=(0.8, 1.2), center=0.05, mu=(0.9, 1.1)),
    ),
    "normals": (
        lambda: planar(small_assembly(3)),
        Ranges(mass=(0.9, 1.1), center=0.02, mu=(0.9, 1.0), normal_deg=2.0),
    ),
    "many": (
        lambda: planar(walls.wall(3, 2, friction=0.6)),
        Ranges(mass=(0.8, 1.2), center=0.003, mu=(0.8, 1.0)),
    ),
    "in-space": (
        lambda: stacks.tower(2, friction=0.8),
        Ranges(mass=(0.9, 1.1), center=0.03, normal_deg=1.0),
    ),
}


def all_are_safe(name, count):
    make, ranges = CASES[name]
    program = program_of(make())
    worst = find_uncertainty(program, ranges, push=X)
    assert worst.held
    random = np.random.default_rng(7)
    for _ in range(count):
        is_at_least_as_safe(program, ranges, worst, random)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_samples_within_the_intervals_are_at_least_as_safe(name):
    all_are_safe(name, 120 // len(CASES) + 1)


@pytest.mark.slow
def test_an_exact_worst_case_is_the_margin_of_the_assembly_it_names():
    program = program_of(planar(stacks.tower(2, friction=2.0)))
    ranges = Ranges(mass=(0.8, 1.2))
    worst = find_uncertainty(program, ranges, push=X)
    assert worst.kind == "exact"
    mass, shift = np.ones(len(program.names)), np.zeros((len(program.names), 3))
    for name, at in worst.worst.items():
        k = program.names.index(name)
        mass[k], shift[k] = at.mass_factor, at.shift
    one = corner(program, mass, shift)
    assert np.degrees(find_tilt_margin(one).angle) == pytest.approx(worst.tilt_deg, abs=1e-9)
    # light below, heavy above: arm .5 of the pile over the height of its centre of mass
    height = (0.8 * 0.5 + 1.2 * 1.5) / 2.0
    assert np.tan(np.radians(worst.tilt_deg)) == pytest.approx(0.5 / height, rel=1e-8)
    assert worst.load_factor[1] == pytest.approx(0.5 / height, rel=1e-8)


def test_a_shifted_centre_of_mass_of_one_block():
    program = program_of(planar(stacks.block_on_slope(0.0, friction=2.0)))
    worst = find_uncertainty(program, Ranges(center=0.1))
    assert (worst.kind, worst.corners) == ("exact", 4)
    assert np.tan(np.radians(worst.tilt_deg)) == pytest.approx(0.4 / 0.6, rel=1e-8)


@pytest.mark.slow
def test_normals_take_their_angle_from_that_of_friction():
    program = program_of(stacks.block_on_slope(0.0, friction=0.5))
    worst = find_uncertainty(program, Ranges(normal_deg=3.0))
    assert worst.kind == "inner"
    assert worst.tilt_deg == pytest.approx(np.degrees(np.arctan(0.5)) - 3.0, abs=1e-6)
    smooth = program_of(stacks.block_on_slope(0.0))
    assert not find_uncertainty(smooth, Ranges(normal_deg=3.0)).held


def test_intervals_too_wide_are_not_held():
    program = program_of(planar(stacks.block_on_slope(0.0, friction=2.0)))
    worst = find_uncertainty(program, Ranges(center=0.6))
    assert (worst.held, worst.tilt_deg) == (False, None)
    assert worst.missing == {"held": "none", "tilt": "none"}


@pytest.mark.parametrize("corners", [0, uncertainty.CORNERS])
def test_a_failure_is_not_taken_for_what_is_not_held(monkeypatch, corners):
    def failed(*_, **__):
        return NoLimit("failed")

    monkeypatch.setattr(uncertainty, "CORNERS", corners)
    monkeypatch.setattr(uncertainty, "find_limit", failed)
    monkeypatch.setattr(uncertainty, "find_tilt_margin", failed)
    monkeypatch.setattr(following_forces, "BALANCED", -1.0)
    block = planar(stacks.block_on_slope(0.0, friction=0.5))
    answer = kilter.margin(block, push=X, ranges=Ranges(mass=(0.9, 1.1)), effort=0)
    worst = answer.uncertainty
    assert worst.kind == "inner"
    assert worst.missing == {"held": "failed", "tilt": "failed", "load_factor": "failed"}
    assert (worst.held, worst.tilt_deg, worst.load_factor) == (False, None, None)
    said = dict(facts(answer.to_dict()))
    assert said["worst case"] == "not known: the solver failed"


@pytest.mark.slow
def test_without_intervals_the_worst_case_is_the_margin():
    program = program_of(small_assembly(1))
    worst = find_uncertainty(program, Ranges(), push=X)
    found = find_tilt_margin(program)
    assert worst.tilt_deg == pytest.approx(float(np.degrees(found.angle)), abs=1e-8)
    limit = find_limit(program, gravity_wrench(program, X))
    assert worst.load_factor[1] == pytest.approx(limit.value, abs=1e-8)
