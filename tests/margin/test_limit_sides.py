"""Limits from both sides: exact linear programs beside the conic one, and mended motions."""

from __future__ import annotations

import numpy as np
import pytest
from margins import program_of
from random_turned import random_turned, springer_arch

from kilter.analysis import load_limit
from kilter.analysis.decision.judge import judge
from kilter.analysis.limit_sides import limit_sides
from kilter.analysis.load_limit import (
    EXACT,
    Limit,
    SharedCones,
    find_limit,
    gravity_wrench,
    with_more,
)
from kilter.analysis.margins.tilt import across_gravity
from kilter.mechanics.certificate import check_motion
from kilter.mechanics.coulomb_cones import cone_problem
from kilter.mechanics.opening import Opening
from kilter.scenes import stacks, walls
from kilter.threads import on_one_thread

limit_of = on_one_thread(find_limit)
"""As `margin` asks: threads that wait for one another take ten times as long."""
CASES = [("arch", 1), ("arch", 2), ("pile", 6), ("pile", 12), ("wedge", 3), ("round", 5)]


@pytest.mark.quick(1)
@pytest.mark.parametrize(("family", "seed"), CASES)
def test_both_ways_find_one_limit_and_judge_agrees(family: str, seed: int) -> None:
    program = program_of(random_turned(family, seed))
    basis = across_gravity(program)
    for angle in (0.3, 2.0):
        aside = np.cos(angle) * basis[0] + np.sin(angle) * basis[-1]
        wrench = gravity_wrench(program, aside / np.linalg.norm(aside))
        limit = find_limit(program, wrench, most=10.0)
        sides = limit_sides(program, wrench, 10.0)
        if not isinstance(limit, Limit) or not np.isfinite(limit.value):
            assert sides.none or sides.held > 9.999 or sides.forces is None
            continue
        assert limit.forces.holds
        assert limit.motion.holds
        assert sides.held <= limit.value + limit.gap + 1e-7
        assert sides.beyond >= limit.value - 1e-7
        size = max(abs(limit.value), 1.0)
        assert judge(with_more(program, wrench, limit.value - 1e-6 * size)).stable is not False
        assert judge(with_more(program, wrench, limit.value + 1e-5 * size)).stable is not True


def test_a_plane_is_exact_in_one_round() -> None:
    program = program_of(springer_arch(7, 0.2, planar=True))
    wrench = gravity_wrench(program, np.array([1.0, 0, 0]))
    sides = limit_sides(program, wrench, 10.0)
    assert sides.closed
    assert sides.start - sides.held < 1e-12


def test_it_is_proved_that_no_share_is_held() -> None:
    program = program_of(stacks.block_on_slope(40.0, friction=0.2))
    across = gravity_wrench(program, np.array([0.0, 1.0, 0.0]))
    sides = limit_sides(program, across, 10.0)
    assert sides.none
    assert sides.forces is None


def test_a_share_up_to_the_most_is_unlimited() -> None:
    program = program_of(stacks.block_on_slope(0.0, friction=0.5))
    down = gravity_wrench(program, np.array([0.0, 0.0, -1.0]))
    assert limit_sides(program, down, 1e6).held == pytest.approx(1e6)
    assert find_limit(program, down).value == np.inf


@pytest.mark.parametrize(("family", "seed"), [("arch", 1), ("pile", 6), ("wedge", 2)])
def test_a_mended_motion_is_admissible(family: str, seed: int) -> None:
    program = program_of(random_turned(family, seed))
    opening = Opening(cone_problem(program))
    assert opening.m0 is not None
    random = np.random.default_rng(seed)
    noise = random.normal(size=opening.m0.shape) * program.free[:, None]
    assert check_motion(program, noise).violation > 1e-3
    mended = opening.mended(noise)
    assert check_motion(program, mended).violation < 1e-15
    assert (opening.mended(mended) == mended).all()


def test_a_share_that_is_held_whole_takes_no_linear_program(monkeypatch):
    """The most that is looked at is proved by one conic program; the limit beyond it is not."""

    def unasked(*_: object) -> None:
        raise AssertionError("linear programs were asked")

    monkeypatch.setattr("kilter.analysis.load_limit.limit_sides", unasked)
    program = program_of(stacks.block_on_slope(0.0, friction=0.5))
    aside = gravity_wrench(program, np.array([0.28, 0.96, 0.0]))
    for most, value in ((0.4, np.inf), (1.0, pytest.approx(0.5, abs=1e-8))):
        assert find_limit(program, aside, most=most).value == value


def unasked(*_: object, **__: object) -> None:
    raise AssertionError("another solver was asked")


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.25, 0.7])
def test_limits_of_one_program_share_their_start(monkeypatch, mu):
    """As from the middle of the cones, in fewer steps; and alike where the wall mirrors itself."""
    monkeypatch.setattr(load_limit, "_in_cones", unasked)
    program = program_of(walls.wall_of(50, friction=mu))
    assert len(program.part_a) > EXACT
    taken: list[int] = []
    steps = load_limit.iterates

    def counted(*given):
        for step in steps(*given):
            taken.append(step.number)
            yield step

    monkeypatch.setattr(load_limit, "iterates", counted)
    shared, numbers, values = SharedCones(program), [], []
    for aside in ([0.6, 0.8, 0.0], [0.6, -0.8, 0.0], [-0.6, 0.8, 0.0]):
        wrench = gravity_wrench(program, np.array(aside))
        taken.clear()
        alone, cold = limit_of(program, wrench, most=10.0), len(taken)
        taken.clear()
        found = limit_of(program, wrench, most=10.0, shared=shared)
        numbers.append(len(taken))
        values.append(found.value)
        assert found.value == pytest.approx(alone.value, abs=2e-9)
        assert found.forces.holds
        assert found.motion.holds
        assert len(taken) < cold
    assert len(set(numbers)) == 1
    assert values == pytest.approx([values[0]] * 3, abs=1e-9)
