"""True exclusions are proved, possible motions are not; both sides of closed-form limits."""

import numpy as np
import pytest
from cases import cylinders, planar, program, slope, spheres
from modes_oracle import greatest_power, standing
from witnessed import jointed

from kilter.friction.exclusion import prove_no_motion
from kilter.friction.friction_tolerances import NO_POWER
from kilter.mechanics.rows import POSSIBLE
from kilter.scenes import arches, friction, stacks
from kilter.work import Work, units_of
from sampled import sampled

LADDER, LADDER_WALL = 1.25, (1 - 0.4 * 0.3) / 0.8  # tan of the least angle
LEAN = float(np.degrees(np.arctan(0.1)))  # of ten cubes, at their limit


def steep(tangent):
    return float(np.degrees(np.arctan(tangent)))


def asked(assembly, effort=3):
    return prove_no_motion(program(assembly), work=effort)


PROVED = {
    "slope, slides": lambda: slope(0.98, 0.5, 1.0),
    "slope, tips": lambda: slope(0.98, 0.8, 2.0),
    "slope in the plane": lambda: planar(slope(0.98, 0.5, 1.0)),
    "ladder": lambda: friction.ladder(steep(LADDER / 0.98)),
    "ladder, rough wall": lambda: friction.ladder(steep(LADDER_WALL / 0.98), friction_wall=0.3),
    "ladder in space": lambda: friction.ladder(steep(LADDER / 0.98), planar=False),
    "cylinders": lambda: cylinders(0.98),
    "ten cubes": lambda: planar(stacks.tower(10, tilt=0.98 * LEAN, friction=0.7)),
    "arch of 7": lambda: arches.arch(7),
    "arch of 12": lambda: arches.arch(12),
    "two cubes": lambda: stacks.tower(2, tilt=10.0, friction=0.5),
    "trough": lambda: friction.trough(tilt=20.0),
}

REFUTED = {
    "slope, slides": lambda: slope(1.02, 0.5, 1.0),
    "slope, tips": lambda: slope(1.02, 0.8, 2.0),
    "ladder": lambda: friction.ladder(steep(LADDER * 0.98)),
    "cylinders": lambda: cylinders(1.02),
    "spheres": lambda: spheres(1.02),
    "ten cubes": lambda: planar(stacks.tower(10, tilt=1.02 * LEAN, friction=0.7)),
    "thin arch": lambda: arches.arch(20, ratio=0.106),
    "H": lambda: friction.h_block(),
    "H in the plane": lambda: friction.h_block(planar=True),
    "A": lambda: friction.a_block(),
    "A in the plane": lambda: friction.a_block(planar=True),
    "bracket": lambda: friction.bracket(1.1 / 1.2),
    "trough past its limit": lambda: friction.trough(tilt=44.2),
    "trough, forces exist": lambda: friction.trough(tilt=47.0),
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", PROVED)
def test_proved(name):
    answer = asked(PROVED[name]())
    assert answer.proved
    assert answer.bound <= NO_POWER
    assert answer.assumes == ""
    assert answer.kind is not None


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", sampled(8, REFUTED))
def test_never_proved(name):
    answer = asked(REFUTED[name](), effort=1)
    assert not answer.proved
    assert answer.kind is None
    assert answer.bound > NO_POWER


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_against_all_modes_in_the_plane(seed):
    one = standing(seed, planar=True, parts=1 + seed % 2, points=3)
    power = greatest_power(one)
    assert power < 1e-9 or power > 1e-5
    assert prove_no_motion(one, work=2).proved == (power < 1e-9)


@pytest.mark.slow
def test_joined_parts_are_one():
    """Two cubes side by side on a slope; the joint carries the cube without friction."""
    cubes = program(stacks.tower(2, tilt=10.0, friction=0.5))
    top = cubes.part_b == 2
    slippery = cubes.with_rows(mu=np.where(top, 0.0, cubes.mu))
    assert not prove_no_motion(slippery, work=1).proved
    held = jointed(slippery, 1, 2, [0.0, 0.0, 1.0])
    assert prove_no_motion(held, work=2).proved


def test_refuses_what_is_not_modelled():
    cubes = program(stacks.tower(1, tilt=10.0, friction=0.5))
    answer = prove_no_motion(cubes.with_rows(kind=np.full(len(cubes.kind), POSSIBLE)))
    assert not answer.proved
    assert "not modelled" in answer.why


@pytest.mark.quick(2)
@pytest.mark.parametrize("ratio", [1.0, 1e-3, 1e-6])
def test_a_pebble_does_not_vanish(ratio):
    """The upper of two cubes, however light, slips if its friction is too low."""
    cubes = program(planar(stacks.tower(2, tilt=10.0, friction=0.5)))
    share = np.where(np.arange(3) == 2, ratio, 1.0)
    light = cubes.with_rows(mass=cubes.mass * share, inertia=cubes.inertia * share[:, None, None])
    assert ratio < 1e-3 or prove_no_motion(light).proved  # a lighter one may stay open
    smooth = light.with_rows(mu=np.where(light.part_b == 2, 0.17, light.mu))
    assert not prove_no_motion(smooth, work=1).proved  # tan 10 deg = 0.176


def test_nothing_to_move_is_proved():
    bare = program(stacks.tower(1, tilt=10.0, friction=0.5))
    nothing = bare.with_rows(gravity=np.zeros(3))
    assert prove_no_motion(nothing).proved


@pytest.mark.slow
def test_the_work_is_kept_to_and_comes_out_the_same_again():
    leaning = program(planar(stacks.tower(10, tilt=6.0, friction=0.7)))
    one, two = (prove_no_motion(leaning, work=0.2) for _ in range(2))
    assert not one.proved
    assert units_of(0.2) <= one.work <= 1.2 * units_of(0.2)
    assert (one.bound, one.nodes, one.programs) == (two.bound, two.nodes, two.programs)


@pytest.mark.slow
def test_cases_that_would_not_do_are_not_gone_through():
    """Ten cubes: moments leave much power, and few cases are affordable."""
    answer = prove_no_motion(program(stacks.tower(10, tilt=2.5, friction=0.5)), work=1)
    assert not answer.proved
    assert answer.work < 0.3 * units_of(1)
    assert answer.bound < 0.02


def test_a_time_limit_ends_it_at_once():
    words = []
    work = Work(time_limit=0.0, progress=words.append)
    answer = prove_no_motion(program(stacks.tower(6, tilt=3.0, friction=0.5)), work=work)
    assert not answer.proved
    assert work.cut
    assert answer.nodes <= 3


def test_says_what_it_assumes_where_parts_can_be_squeezed():
    """Any force may press a wedge into a V, so the proof names its assumed bound."""
    answer = asked(friction.v_block(friction=0.5, planar=True))
    assert answer.proved
    assert "1000 times the weight" in answer.assumes


def test_one_number_flips_it():
    assembly = planar(slope(0.98, 0.5, 1.0))
    one = program(assembly)
    assert prove_no_motion(one).proved
    assert not prove_no_motion(one.with_rows(mu=0.96 * one.mu)).proved
