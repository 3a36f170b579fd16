"""Margins with closed forms or published values, and disturbances on both sides of them."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
from judged import judged
from margins import by_points, force_of, leaning, program_of, small_assembly

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis import load_limit
from kilter.analysis.decision.judge import judge
from kilter.analysis.limit_sides import LimitSides
from kilter.analysis.load_limit import Limit, NoLimit, find_limit, gravity_wrench, with_more
from kilter.analysis.margins.least_friction import find_least_friction
from kilter.analysis.margins.margin_question import PUSHED
from kilter.analysis.margins.pushes import find_weakest_push
from kilter.analysis.margins.tilt import (
    find_nearest_held,
    find_tilt_margin,
)
from kilter.assembly import Load
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.scenes import arches, friction, rounds, scene, stacks, walls
from kilter.tell.facts import facts
from sampled import sampled

HOLDS = ("stable", "settles", "potentially-stable")
X = np.array([1.0, 0.0, 0.0])


def factor(assembly, along=X) -> float:
    """The greatest body force in a direction, in weights."""
    program = program_of(assembly)
    limit = find_limit(program, gravity_wrench(program, np.asarray(along, dtype=float)))
    assert isinstance(limit, Limit)
    assert limit.forces.holds
    assert limit.motion is not None
    assert limit.motion.holds
    return limit.value


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("number", "published"),
    [
        (1, 0.64286),
        (2, 0.58000),
        (3, 0.40369),
        (4, 0.33195),
        (5, 0.23964),
        pytest.param(6, 0.34782, marks=pytest.mark.slow),
    ],
)
def test_load_factor_of_the_walls_of_ferris_and_tin_loi(number, published):
    assert factor(walls.ferris_tin_loi(number)) == pytest.approx(published, abs=6e-6)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("number", "local"), [(1, 0.6007), (2, 0.5573), (3, 0.35581), (4, 0.26373), (5, 0.20859)]
)
def test_bracket_of_sliding_that_does_not_dilate_contains_the_published_local_value(number, local):
    program = program_of(walls.ferris_tin_loi(number))
    wrench = gravity_wrench(program, np.array([1.0, 0.0, 0.0]))
    sure, most = find_limit(program.frictionless, wrench), find_limit(program, wrench)
    assert sure.value - 1e-9 <= local <= most.value
    # what is sure is sure by the frictionless verdict, and nothing holds above the other end
    assert judge(program.frictionless).stable
    assert judge(with_more(program, wrench, most.value * 1.0001)).stable is False


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("count", "sectors", "known"),
    [
        (7, True, 0.370010),
        (13, True, 0.358076),
        (28, True, 0.354686),
        (7, False, 0.373612),
        (13, False, 0.358857),
        (28, False, 0.354868),
        pytest.param(100, True, 0.353489, marks=pytest.mark.slow),
        pytest.param(100, False, 0.353503, marks=pytest.mark.slow),
    ],
)
def test_load_factor_of_the_arch_of_oppenheim(count, sectors, known):
    assert factor(arches.oppenheim_arch(count, sectors=sectors)) == pytest.approx(known, abs=6e-7)


@pytest.mark.parametrize(
    ("count", "ratio", "sectors", "known"),
    [
        (27, 0.15, True, 0.145104),
        (27, 0.15, False, 0.145338),
        pytest.param(100, 0.2, True, 0.283792, marks=pytest.mark.slow),
        pytest.param(100, 0.2, False, 0.283809, marks=pytest.mark.slow),
    ],
)
def test_load_factor_of_a_semicircle(count, ratio, sectors, known):
    arch = arches.arch(count, ratio=ratio, sectors=sectors, friction=10.0)
    assert factor(arch) == pytest.approx(known, abs=6e-7)


@pytest.mark.parametrize(("sectors", "least"), [(True, 0.10746), (False, 0.10735)])
def test_least_thickness_of_a_semicircle(sectors, least):
    """Held just above the least thickness, with nothing left for a push; not held below."""
    below, above = (
        program_of(arches.arch(20, ratio=least + step, sectors=sectors)) for step in (-2e-5, 2e-5)
    )
    assert judge(below).stable is False
    assert judge(above).stable is True
    assert find_limit(below, gravity_wrench(below, X)) == NoLimit("none")
    spare = find_limit(above, gravity_wrench(above, X))
    assert isinstance(spare, Limit)
    assert 0.0 < spare.value < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("count", [1, 2, 5])
def test_a_tower_topples_at_one_over_its_height(count):
    tower = stacks.tower(count, friction=2.0)
    found = find_tilt_margin(program_of(tower))
    assert np.tan(found.angle) == pytest.approx(1 / count, rel=1e-8)
    assert found.lower == pytest.approx(found.angle, rel=1e-8)
    aside = found.down - (found.down @ tower.down) * tower.down
    aside = aside / np.linalg.norm(aside)
    degrees = float(np.degrees(found.angle))
    assert judged(leaning(tower, aside, degrees - 0.01), effort=0.5).verdict in HOLDS
    assert judged(leaning(tower, aside, degrees + 0.01), effort=0.5).verdict == "unstable"


@pytest.mark.parametrize("count", [2, 4])
def test_a_staircase_is_at_its_limit_where_nothing_is_left_to_lean(count):
    """Case S3: held up to an offset of 1 / (n + 1), and there the margin ends."""
    limit = 1 / (count + 1)
    program = program_of(dataclasses.replace(stacks.staircase(count, offset=limit), friction=2.0))
    at = find_limit(program, gravity_wrench(program, X))
    assert isinstance(at, Limit)
    assert at.value == pytest.approx(0.0, abs=1e-7)
    share = 0.9
    inside = dataclasses.replace(stacks.staircase(count, offset=share * limit), friction=2.0)
    # the pile of n cubes leans on the edge of the base: arm of its centre over its height
    arm = 0.5 - share * limit * (count + 1) / 2
    assert factor(inside) == pytest.approx(arm / (count / 2), abs=1e-7)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("pile", "least"),
    [
        (rounds.three_cylinders(), 2 - np.sqrt(3)),
        (rounds.four_spheres(), np.sqrt(3) - np.sqrt(2)),
    ],
    ids=["three-cylinders", "four-spheres"],
)
def test_least_friction_of_piles_of_round_things(pile, least):
    found = find_least_friction(program_of(by_points(pile)))
    assert found.value == pytest.approx(least, abs=1e-6)
    assert found.lower == pytest.approx(least, abs=1e-6)
    assert found.forces.holds
    assert found.motion.holds


def test_least_friction_of_a_squeezed_block_is_any_above_zero():
    found = find_least_friction(program_of(friction.h_block()))
    assert (found.value, found.attained) == (0.0, False)
    assert find_least_friction(program_of(friction.v_block())).attained


@pytest.mark.slow
def test_a_push_a_little_less_is_held_and_a_little_more_is_not():
    """The enclosure of the weakest push is a percent wide where the limits are round."""
    tower = stacks.tower(2, friction=0.3)
    for part in (1, 2):
        push = find_weakest_push(program_of(tower), part)
        assert 0.99 * push.force <= push.lower <= push.force
        assert push.force < force_of(tower, tower.names[part])
        for force, verdicts in ((0.999 * push.lower, HOLDS), (1.001 * push.force, ("unstable",))):
            load = Load(tower.names[part], force=force * push.direction)
            pushed = dataclasses.replace(tower, loads=[load])
            assert judged(pushed, effort=0.5).verdict in verdicts


@pytest.mark.parametrize("number", [1, 5])
def test_a_load_a_little_less_is_held_and_a_little_more_is_not(number):
    wall = walls.ferris_tin_loi(number)
    limit = factor(wall)
    program = program_of(wall)
    for step, stable in ((-1e-4, True), (1e-4, False)):
        more = with_more(program, gravity_wrench(program, X), limit + step)
        assert judge(more).stable is stable


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", sampled(12, 50))
def test_the_conic_limit_is_where_the_verdict_changes(seed):
    """`judge` on both sides of it, and by bisection from far away."""
    program = program_of(small_assembly(seed))
    random = np.random.default_rng(seed)
    along = random.normal(size=3) * [1, 1, 0.3]
    wrench = gravity_wrench(program, along / np.linalg.norm(along))
    limit = find_limit(program, wrench)
    if judge(program).stable is False:
        assert limit == NoLimit("none")
        return
    low, high = 0.0, 4.0
    if judge(with_more(program, wrench, high)).stable:  # pressed down more than aside
        assert limit.value > high
        return
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        verdict = judge(with_more(program, wrench, middle)).stable
        assert verdict is not None
        low, high = (middle, high) if verdict else (low, middle)
    assert low - 1e-6 <= limit.value <= high + 1e-6
    for step, stable in ((-1e-6, True), (1e-6, False)):
        assert judge(with_more(program, wrench, limit.value + step)).stable is stable


@pytest.mark.parametrize("planar", [False, True])
def test_what_is_not_held_as_given_has_no_tilt_margin_but_a_way_back(planar):
    """A block past its edge: the distance to the nearest held direction, negative."""
    slope = dataclasses.replace(stacks.block_on_slope(50.0, friction=3.0), planar=planar)
    program = program_of(slope)
    assert find_tilt_margin(program) == NoLimit("none")
    assert find_weakest_push(program, 1) == NoLimit("none")
    nearest = find_nearest_held(program)
    assert np.degrees(nearest.angle) == pytest.approx(5.0, abs=1e-7)
    assert np.degrees(nearest.lower) == pytest.approx(5.0, abs=1e-6)
    assert judge(program.turned(nearest.down)).stable is not False


@pytest.mark.slow
def test_the_nearest_held_direction_carries_its_proof_on_both_sides():
    """Friction of 10 degrees on a slope of 12: forces from a turn of 2 on, a motion before it."""
    slope = stacks.block_on_slope(12.0, friction=float(np.tan(np.radians(10.0))))
    proofs = json.loads(json.dumps(kilter.margin(slope).proof()))
    turns = {p["held"]: p["value"] for p in proofs["proofs"] if p["about"] == "nearest held"}
    limit = np.radians(2.0)
    assert limit - 1e-8 < turns[False] < limit < turns[True] + TOLERANCE < limit + 1e-8
    assert kilter.verify(slope, proofs).holds
    held = next(p for p in proofs["proofs"] if p["about"] == "nearest held" and p["held"])
    turned = held["change"]["down"]
    held["change"]["down"] = [turned[0] * 1.01, turned[1], turned[2]]
    assert not kilter.verify(slope, proofs).holds


@pytest.mark.slow
@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("off", [0.0, 1e-12, 3e-9, 1e-8, 5e-8, 1e-6, 1e-3])
def test_beside_the_limit_a_tilt_has_the_sign_of_the_verdict_and_the_truth_between_its_sides(
    planar, off
):
    """A slope with a little more friction than it takes, or less: the angle left over."""
    turn = np.radians(20.0)
    for sign in (1.0, -1.0):
        slope = stacks.block_on_slope(20.0, friction=float(np.tan(turn + sign * off)))
        answer = kilter.margin(dataclasses.replace(slope, planar=planar), effort=0, pushed=[])
        if answer.nearest is None:
            low, high = answer.tilt.lower, answer.tilt.angle
        else:
            low, high = -answer.nearest.angle, -answer.nearest.lower
        assert np.radians(answer.tilt_deg) in (pytest.approx(low), pytest.approx(high))
        if off < TOLERANCE:
            assert (low, high) == (0.0, 0.0)
            continue
        assert low - TOLERANCE / 100 <= sign * off <= high + TOLERANCE / 100
        assert high - low <= 3 * TOLERANCE
        assert (answer.nearest is not None) is (sign < 0)
        assert (answer.verdict == "unstable") is (sign < 0)


def failing(monkeypatch, at):
    """The conic solver fails at these calls, and at no other."""
    from kilter.solvers import clarabel

    real, calls = clarabel.solve_conic, [0]

    def broken(problem, **options):
        calls[0] += 1
        answer = real(problem, **options)
        if not at(calls[0]):
            return answer
        return dataclasses.replace(answer, outcome="failed", x=np.empty(0), multipliers=np.empty(0))

    monkeypatch.setattr(clarabel, "solve_conic", broken)


def without_linear_programs(monkeypatch):
    """Nothing takes over where the conic solver fails."""
    monkeypatch.setattr(load_limit, "limit_sides", lambda *_: LimitSides())


@pytest.mark.parametrize("at", [1, 2])
def test_a_first_failure_is_asked_again(monkeypatch, at):
    program = program_of(stacks.block_on_slope(0.0, friction=0.5))
    without_linear_programs(monkeypatch)
    failing(monkeypatch, lambda call: call == at)
    limit = find_limit(program, gravity_wrench(program, X))
    assert isinstance(limit, Limit)
    assert limit.value == pytest.approx(0.5, abs=1e-7)


def test_a_nearest_direction_that_fails_is_asked_again(monkeypatch):
    program = program_of(stacks.block_on_slope(20.0))
    for fails, found in ((lambda call: call == 1, True), (lambda call: True, False)):
        with monkeypatch.context() as patch:
            failing(patch, fails)
            nearest = find_nearest_held(program)
        if found:
            assert np.degrees(nearest.angle) == pytest.approx(20.0, abs=1e-7)
        else:
            assert nearest == NoLimit("failed")


def test_linear_programs_take_over_where_the_conic_one_fails(monkeypatch):
    program = program_of(stacks.block_on_slope(0.0, friction=0.5))
    failing(monkeypatch, lambda call: True)
    limit = find_limit(program, gravity_wrench(program, X))
    assert isinstance(limit, Limit)
    assert limit.value == pytest.approx(0.5, abs=1e-7)
    assert limit.forces.holds
    assert limit.motion.holds
    assert limit.gap < 2e-7


def test_a_failure_is_not_taken_for_none_and_is_said(monkeypatch):
    block = stacks.block_on_slope(0.0, friction=0.5)
    program = program_of(block)
    without_linear_programs(monkeypatch)
    failing(monkeypatch, lambda call: True)
    assert find_limit(program, gravity_wrench(program, X)) == NoLimit("failed")
    assert find_tilt_margin(program) == NoLimit("failed")
    assert find_weakest_push(program, 1) == NoLimit("failed")
    answer = kilter.margin(block, push=[1, 0, 0], effort=0)
    pushed = f"push of {program.names[1]}"
    assert {"tilt", "load_factor", pushed} <= set(answer.missing)
    assert answer.missing[pushed] == "failed"
    assert any("the solver failed" in text for text in answer.warnings)


def test_a_push_that_is_not_resisted_says_why():
    slope = stacks.block_on_slope(50.0, friction=0.3)
    answer = kilter.margin(slope, effort=0)
    assert set(answer.missing.values()) == {"none"}
    assert any("it resists no push" in text for text in answer.warnings)


@pytest.mark.parametrize("name", ["pit", "closed-frame"])
def test_where_no_tilt_fails_there_is_no_direction_that_does(name):
    answer = kilter.margin(scene(name), effort=0)
    assert (answer.tilt_deg, answer.tilt_down) == (90.0, None)
    assert answer.to_dict()["tilt_down"] is None
    assert "at least 90 deg" in str(facts(answer.to_dict()))


@pytest.mark.slow
def test_parts_above_the_limit_are_asked_for_by_name():
    tower = stacks.tower(PUSHED + 1, friction=0.8)
    silent = kilter.margin(tower, effort=0)
    assert not silent.pushes
    assert "hold" not in {one.what for one in silent.helps}
    assert any("--part NAME" in text for text in silent.warnings)
    lowest = min(tower.parts[1:], key=lambda part: part.pose.position[2]).name
    asked = kilter.margin(tower, pushed=[lowest], effort=0)
    assert [push.part for push in asked.pushes] == [lowest]
    held = [one for one in asked.helps if one.what == "hold"]
    assert [one.parts for one in held] == [(lowest,)]
    # the rest of the tower is one lower
    gain = np.arctan(1 / PUSHED) - np.arctan(1 / (PUSHED + 1))
    assert held[0].gain == pytest.approx(np.degrees(gain), abs=1e-5)


@pytest.mark.quick(3)
@pytest.mark.parametrize("small", [0.5, 0.05, 1e-3, 1e-5])
def test_loads_that_hold_only_many_times_over_have_both_ends(small):
    """A cube at a wall, pressed and lifted at an angle a: s k (sin a -+ mu cos a) = 1."""
    angle, mu = np.radians(60), 0.3
    wall = Part("wall", Box([1, 3, 3]), Pose([-1, 0, 0]), grounded=True)
    cube = Part("cube", Box([1, 1, 1]))
    force = small * 9810 * np.array([-np.cos(angle), 0, np.sin(angle)])
    held = Assembly([wall, cube], friction=mu, loads=[Load("cube", force)])
    found = kilter.margin(held, pushed=[], effort=0).to_dict()["load_factor"]
    ends = [1 / (small * (np.sin(angle) + side * mu * np.cos(angle))) for side in (1, -1)]
    assert found == pytest.approx(ends, rel=1e-6)
