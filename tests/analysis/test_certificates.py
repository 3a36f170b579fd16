"""Exactly one certificate passes, and neither accepts a small error. Rows, columns, J."""

import dataclasses

import numpy as np
import pytest
from builders import falling_pair, hanging_pair, pressed_box, toppled_box
from independent import dense_rows
from judged import judged, program_of
from transformations import tilted

from kilter.analysis.decision.judge import judge
from kilter.assembly import Assembly
from kilter.assembly.straps import Strap
from kilter.mechanics.certificate import (
    check_forces,
    check_motion,
    needed_power,
    part_sizes,
    violations,
)
from kilter.mechanics.forms import least_imbalance, load_factor, scaled_problem
from kilter.mechanics.mechanics_tolerances import (
    EXCESS,
    RULED_OUT,
    TOLERANCE,
    UNITS_IN_LAST_PLACE,
)
from kilter.mechanics.rows import CONTACT, JOINT, STICKING
from kilter.scenes import friction, paper, scene, stacks, walls
from kilter.scenes import random_bricks as packings
from kilter.scenes.pieces import block, floor
from kilter.solvers.highs import solve_linear

SCENES = {
    "tower": stacks.tower,
    "staircase": stacks.staircase,
    "staircase-fails": lambda: stacks.staircase(3, offset=0.25 * (1 + 1e-6)),
    "figure-8": paper.figure_8,
    "figure-8-planar": lambda: paper.figure_8(planar=True),
    "figure-9": paper.figure_9,
    "figure-9-planar": lambda: paper.figure_9(planar=True),
    "figure-11": lambda: paper.figure_11("b"),
    "figure-11-off": lambda: tilted(paper.figure_11("b"), [0, 1, 0], 0.01),
    "wall": lambda: walls.wall(4, 4),
    "opening": lambda: walls.wall_with_opening(5, 6, opening=(2, 4, 1, 3)),
    "pile": lambda: packings.box_pile(8, seed=2),
    "loose-pile": lambda: packings.box_pile(8, seed=2, level=False),
    "wedges": lambda: scene("corner-wedges"),
    "hanging": hanging_pair,
    "falling": falling_pair,
    "pressed": pressed_box,
    "toppled": toppled_box,
}
EACH = pytest.mark.parametrize("name", SCENES)


@pytest.mark.quick(4)
@EACH
@pytest.mark.parametrize("method", ["simplex", "interior"])
def test_exactly_one_certificate_passes(name, method):
    program = program_of(SCENES[name]())
    problem = scaled_problem(program)
    stable = judged(SCENES[name]()).first_order == "stable"
    answer = solve_linear(load_factor(problem), method=method)
    factor = float(answer.x[-1])
    forces = check_forces(
        program, problem.forces(answer.x[:-1]) / (factor if factor > 0.5 else 1.0)
    )
    motion = check_motion(program, problem.motion(problem.over_weight(-answer.multipliers)))
    if method == "simplex":  # an interior point may need the next attempt
        assert (forces.holds, motion.holds) == (stable, not stable)
    assert not (forces.holds and motion.holds)


@pytest.mark.quick(3)
@EACH
def test_least_imbalance_gives_the_same_answer(name):
    program = program_of(SCENES[name]())
    problem = scaled_problem(program)
    stable = judged(SCENES[name]()).first_order == "stable"
    answer = solve_linear(least_imbalance(problem))
    rows = len(problem.right)
    y = answer.multipliers[:rows] + answer.multipliers[rows:]
    motion = check_motion(program, problem.motion(problem.over_weight(-y)))
    forces = check_forces(program, problem.forces(answer.x[:-1]))
    assert (forces.holds, motion.holds) == (stable, not stable)


@pytest.mark.quick(5)
@EACH
def test_certificate_of_the_other_kind_never_passes(name):
    program = program_of(SCENES[name]())
    judgement = judge(program)
    random = np.random.default_rng(0)
    for _ in range(50):
        if judgement.stable:
            trial = random.normal(size=(len(program.names), 6))
            assert not check_motion(program, trial).holds
        else:
            trial = random.exponential(size=len(program.part_a)) * program.weight.max()
            assert not check_forces(program, trial).holds


@pytest.mark.parametrize("name", ["tower", "figure-9", "wall", "hanging", "pressed"])
def test_forces_a_little_off_prove_nothing(name):
    program = program_of(SCENES[name]())
    proof = judge(program).forces
    assert proof.holds
    random = np.random.default_rng(1)
    pushed = np.flatnonzero(proof.forces > 1e-6 * program.weight.min())
    for k in random.choice(pushed, size=min(10, len(pushed)), replace=False):
        forces = proof.forces.copy()
        part = [p for p in (program.part_a[k], program.part_b[k]) if p >= 0 and program.free[p]]
        weight = min(program.weight[part])
        forces[k] += 3 * TOLERANCE * weight
        assert not check_forces(program, forces).holds
        forces[k] = proof.forces[k] + 1e-3 * TOLERANCE * weight
        assert check_forces(program, forces).holds


def test_forces_that_pull_are_clipped_before_they_are_judged():
    program = program_of(stacks.tower(1))
    forces = np.full(len(program.part_a), program.weight[1] / 4)
    assert check_forces(program, forces).holds
    forces[0] *= -1
    judged_forces = check_forces(program, forces)
    assert judged_forces.forces.min() == 0.0
    assert not judged_forces.holds
    assert judged_forces.residual == pytest.approx(np.hypot(0.25, 0.25 * np.sqrt(0.5 / 0.75)))


def test_forces_that_are_no_numbers_prove_nothing():
    program = program_of(stacks.tower(1))
    for bad in (np.nan, np.inf, -np.inf):
        assert not check_forces(program, np.full(len(program.part_a), bad)).holds
        assert not check_motion(program, np.full((2, 6), bad)).holds
    assert not check_motion(program, np.full((2, 6), 1e200)).holds  # its squares overflow
    assert not check_motion(program, np.zeros((2, 6))).holds


@pytest.mark.parametrize("gain", [1e-12, 1e-9, 1e-6, 1e-3, 1.0])
def test_box_at_rest_has_no_motion_that_violates_a_little_and_gains_a_little(gain):
    program = program_of(stacks.tower(1))
    motion = np.zeros((2, 6))
    motion[1] = [1.0, 0, -gain, 0, 0, 0]  # slides, and sinks into the table by as much as it gains
    proof = check_motion(program, motion)
    assert not proof.holds
    assert proof.violation == pytest.approx(gain / np.hypot(1, gain))
    assert proof.ratio < 1.1 / RULED_OUT


def test_small_gain_without_violation_is_a_proof_down_to_the_tolerance():
    # gravity leans by a hair: sliding gains, and violates nothing
    for lean, holds in ((1.02e-9, True), (0.99e-9, False)):
        program = program_of(stacks.tower(1).with_down([lean, 0, -1]))
        motion = np.zeros((2, 6))
        motion[1, 0] = 1.0
        assert check_motion(program, motion).holds == holds


def test_ratio_of_a_motion_bounds_the_forces_that_could_hold_it():
    # balanced forces need at least P / v: a thin lever holds with large forces, and they exist
    for past in (1e-5, 1e-8):
        table = floor([-3, -1], [0, 1])
        box = block("box", [past - 0.5, -0.5, 0], [past + 0.5, 0.5, 1])
        program = program_of(Assembly([table, box]))
        proof = judge(program).motion
        assert proof.holds
        assert proof.ratio > 1.0


@pytest.mark.quick(5)
@EACH
def test_jacobian_is_velocities_and_wrenches(name):
    program = program_of(SCENES[name](), possible=True, sticking=True)
    random = np.random.default_rng(2)
    columns = random.normal(size=len(program.columns))
    forces = random.normal(size=len(program.part_a))
    motion = program.full(columns)
    rows = program.jacobian()
    assert rows.shape == (len(program.part_a), len(program.columns))
    assert np.allclose(rows @ columns, program.velocities(motion), atol=1e-12)
    assert np.allclose(rows @ columns, dense_rows(program) @ motion.ravel(), atol=1e-12)
    wrenches = program.wrenches(forces)
    power = float(forces @ (rows @ columns))
    assert power == pytest.approx(float((wrenches * motion).sum()), abs=1e-9)
    back = wrenches[np.ix_(program.free, program.freedoms)].ravel()
    assert np.allclose(rows.T @ forces, back, atol=1e-10)


def test_labels_name_rows_and_columns():
    program = program_of(hanging_pair())
    freedoms = ["dx", "dy", "dz", "rx", "ry", "rz"]
    assert program.columns == [(n, f) for n in ("post", "arm", "lamp") for f in freedoms]
    assert program.kind.tolist() == [CONTACT] * 4 + [JOINT] * 12
    names = [*program.names, "ground"]  # -1 is the ground
    ends = [(names[a], names[b]) for a, b in zip(program.part_a, program.part_b, strict=True)]
    assert set(ends[0]) == {"floor", "post"}
    assert (ends[4], ends[-1]) == (("post", "arm"), ("ground", "lamp"))
    assert program.source[[0, 4, -1]].tolist() == [0, 0, 1]
    assert program.two_sided.tolist() == [False] * 4 + [True] * 12
    assert program.angular.tolist() == [False] * 4 + ([False] * 3 + [True] * 3) * 2


def test_planar_program_has_three_freedoms_a_part():
    flat, space = program_of(paper.figure_9(planar=True)), program_of(paper.figure_9())
    assert [f for _, f in flat.columns[:3]] == ["dx", "dz", "ry"]
    assert 2 * len(flat.columns) == len(space.columns)
    motion = np.ones((5, 6))
    assert np.array_equal(check_motion(flat, motion).motion[1] != 0, [1, 0, 1, 0, 1, 0])


def test_possible_rows_come_after_and_are_named():
    program = program_of(stacks.tower(1).with_friction(0.5), possible=True, sticking=True)
    assert program.kind.tolist() == [CONTACT] * 4 + [STICKING] * 8
    assert program.source[4:].tolist() == program.source[:4].tolist() * 2
    tangents = program.normal[4:]
    assert np.allclose(tangents @ [0, 0, 1], 0)
    assert np.allclose(np.linalg.norm(tangents, axis=1), 1)


def test_solvers_are_not_believed():
    # forces and motion of another program of the same shape: judged, and refused
    good, bad = program_of(stacks.staircase(3)), program_of(stacks.staircase(3, offset=0.26))
    assert not check_forces(bad, judge(good).forces.forces).holds
    assert not check_motion(good, judge(bad).motion.motion).holds


def test_small_part_in_a_large_assembly_does_not_vanish():
    # a speck of dust beside a house: its fall is a verdict, and all that moves
    house = block("house", [-5, -5, 0], [5, 5, 10])
    speck = block("speck", [20, 0, 1], [20.0001, 0.0001, 1.0001])
    verdict = judged(Assembly([floor([-10, -10], [30, 10]), house, speck]))
    assert verdict.verdict == "unstable"
    assert verdict.moving == ["speck"]


def test_speck_just_past_the_edge_of_a_house_falls():
    house = block("house", [-10, -5, 0], [0, 5, 10])
    for past, word in ((-1e-6, "stable"), (1e-6, "unstable")):
        size = 1e-3
        x = past * size
        speck = block("speck", [x - size / 2, 0, 10], [x + size / 2, size, 10 + size])
        verdict = judged(Assembly([floor([-20, -10], [20, 10]), house, speck]))
        assert verdict.verdict == word


def test_program_of_nothing_free_is_stable():
    assembly = stacks.tower(1)
    parts = [dataclasses.replace(part, grounded=True) for part in assembly.parts]
    assert judge(program_of(Assembly(parts))).stable


# both sides of each limit ------------------------------------------------------------------------


def resting(mu=0.0, planar=False):
    """A block on a table, and the forces of a quarter of its weight at each corner."""
    built = program_of(stacks.block_on_slope(0.0, friction=mu)._replace(planar=planar))
    return built, np.full(len(built.part_a), built.weight[built.free][0] / len(built.part_a))


@pytest.mark.parametrize(("off", "holds"), [(0.99, True), (1.01, False)])
def test_forces_balance_up_to_the_tolerance(off, holds):
    built, forces = resting()
    for sign in (1.0, -1.0):
        proof = check_forces(built, (1 + sign * off * TOLERANCE) * forces)
        assert proof.residual == pytest.approx(off * TOLERANCE, rel=1e-5)
        assert proof.holds == holds


def test_no_forces_leave_the_whole_weight():
    built, forces = resting()
    nothing = check_forces(built, 0 * forces)
    assert (nothing.residual, nothing.holds) == (1.0, False)
    assert check_forces(built, forces).residual == pytest.approx(0.0, abs=1e-14)


@pytest.mark.parametrize(
    ("pinch", "left", "holds"),
    [
        (1.0, 0.9 * TOLERANCE, True),
        (1.0, 1.1 * TOLERANCE, False),
        (0.4 * RULED_OUT, 0.9 * TOLERANCE, True),
        (0.4 * RULED_OUT, 2.0 * TOLERANCE, False),
        (0.6 * RULED_OUT, 0.0, False),
    ],
)
def test_a_pinch_hides_no_weight(pinch, left, holds):
    """Two walls press a block: its imbalance counts over its weight, however hard they press."""
    built = program_of(friction.h_block())
    lift = np.zeros((len(built.part_a), 3))
    [k] = np.flatnonzero(built.free)
    side = np.where(built.part_b == k, 1.0, -1.0)
    toward = (side[:, None] * built.normal)[:, 0]
    walls_ = np.abs(toward) > 0.9
    pushed = toward[walls_] > 0
    forces = np.zeros(len(built.part_a))
    share = np.where(pushed, 1 / pushed.sum(), 1 / (~pushed).sum())
    forces[walls_] = pinch * built.weight[k] * share
    lift[walls_, 2] = (1 - left) * built.weight[k] / walls_.sum() * side[walls_]
    proof = check_forces(built, forces, lift)
    if left:
        assert proof.residual == pytest.approx(left, rel=0.1)
    assert proof.holds == holds


@pytest.mark.parametrize(("slope", "verdict"), [(1e-5, "stable"), (1e-8, "none"), (1e-12, "none")])
def test_walls_that_lean_by_rounding_hold_no_block(slope, verdict):
    """A block between walls that overhang its sides by a slope: forces of weight / (2 slope)."""
    base = program_of(friction.h_block())
    [k] = np.flatnonzero(base.free)
    side = np.where(base.part_b == k, 1.0, -1.0)
    walls_ = np.abs(base.normal[:, 0]) > 0.9
    normal = base.normal.copy()
    normal[walls_, 2] = slope * side[walls_]
    built = dataclasses.replace(base.frictionless, normal=normal)
    forces = np.zeros(len(built.part_a))
    toward = (side[:, None] * built.normal)[:, 0]
    for sign in (1, -1):
        rows = walls_ & (sign * toward > 0)
        forces[rows] = built.weight[k] / (2 * slope) / rows.sum()
    assert check_forces(built, forces).holds == (verdict == "stable")
    fall = np.zeros((len(built.names), 6))
    fall[k, 2] = -1.0
    # in the band between 1e-9 and 1e-6 neither holds
    assert check_motion(built, fall).holds == (slope < 1e-7)


def speck_under_a_weight(sizes=(1.0, 1e-3, 1e3)):
    """A light plate between a table and a heavy block that rests on it."""
    side, thin, mass = sizes
    plate = block("plate", [0, 0, 0], [side, side, thin], mass=1e-3)
    heavy = block("heavy", [0, 0, thin], [side, side, thin + side], mass=mass)
    return program_of(Assembly([floor([-3, -3], [5, 5]), plate, heavy]))


@pytest.mark.parametrize(("units", "holds"), [(0.5, True), (2.0, False)])
def test_rounding_of_large_forces_is_excused_and_no_more(units, holds):
    """The plate carries 1e10 of its weight: rounding of this is 1e-6 of its weight."""
    built = speck_under_a_weight((1.0, 1e-3, 1e7))
    plate, heavy = (built.names.index(name) for name in ("plate", "heavy"))
    weight = built.weight
    forces = np.zeros(len(built.part_a))
    upper = (built.part_a == heavy) | (built.part_b == heavy)
    forces[upper] = weight[heavy] / upper.sum()
    forces[~upper] = (weight[heavy] + weight[plate]) / (~upper).sum()
    sums = built.force_sums(forces)[plate]
    # off by units in the last place of all forces, beyond the tolerance of the weight
    off = TOLERANCE * weight[plate] + units * UNITS_IN_LAST_PLACE * sums
    forces[~upper] += off / (~upper).sum()
    assert off > 100 * TOLERANCE * weight[plate]
    assert off < EXCESS * weight.sum()
    assert check_forces(built, forces).holds == holds


def test_friction_is_cut_to_its_cone_and_to_the_plane():
    for planar in (False, True):
        built, forces = resting(0.5, planar)
        given = np.zeros((len(forces), 3))
        given[:, 0], given[:, 2] = 2 * forces, 7.0  # too much across, and some along the normal
        given[:, 1] = 0.1 * forces
        proof = check_forces(built, forces, given)
        sizes = np.linalg.norm(proof.friction, axis=1)
        assert np.allclose(sizes, 0.5 * forces, rtol=1e-12)
        assert (proof.friction[:, 2] == 0).all()
        assert (proof.friction[:, 1] == 0).all() == planar
        small = check_forces(built, forces, 0.01 * given)
        assert np.allclose(small.friction[:, 0], 0.02 * forces, rtol=1e-12)
    assert not check_forces(resting()[0], forces, given).friction.any()


def slid(sunk, tilt=20.0, mu=0.0):
    """A block pushed along its slope, and into it by a share of that; its motion judged."""
    built = program_of(stacks.block_on_slope(tilt, friction=mu))
    [k] = np.flatnonzero(built.free)
    n = built.normal[0] * (1.0 if built.part_b[0] == k else -1.0)
    along = built.down - (built.down @ n) * n
    along /= np.linalg.norm(along)
    motion = np.zeros((len(built.names), 6))
    motion[k, :3] = along - sunk * n
    return built, k, check_motion(built, motion)


@pytest.mark.parametrize(("share", "holds"), [(0.99, True), (1.01, False)])
def test_a_motion_may_sink_in_by_a_millionth_of_its_power(share, holds):
    sunk = share * np.sin(np.radians(20.0)) / RULED_OUT
    built, k, proof = slid(sunk)
    assert proof.violation == pytest.approx(sunk, rel=1e-9)
    assert proof.power == pytest.approx(built.weight[k] * np.sin(np.radians(20.0)), rel=1e-5)
    assert proof.ratio == pytest.approx(1 / share, rel=1e-4)
    assert proof.holds == holds


@pytest.mark.parametrize(("lifted", "violation"), [(0.5, 0.0), (0.4, 0.1), (-0.1, 0.6), (0.6, 0.0)])
def test_with_friction_a_motion_opens_by_mu_times_its_slip(lifted, violation):
    _, _, proof = slid(-lifted, tilt=60.0, mu=0.5)
    size = np.hypot(1.0, lifted)
    assert proof.violation == pytest.approx(violation / size, abs=1e-12)
    assert proof.holds == (violation == 0.0)


def test_the_sizes_of_parts_are_arms_times_turns():
    built = program_of(scene("staircase"))
    six = np.random.default_rng(3).normal(size=(len(built.names), 6))
    for k, radius in enumerate(built.radius):
        straight, turn = np.linalg.norm(six[k, :3]), np.linalg.norm(six[k, 3:])
        twist = part_sizes(built, six, per_radius=False)[k]
        wrench = part_sizes(built, six, per_radius=True)[k]
        assert twist == pytest.approx(np.hypot(straight, turn * radius))
        assert wrench == pytest.approx(np.hypot(straight, turn / radius))
    flat = program_of(paper.figure_8(planar=True))
    six = np.random.default_rng(4).normal(size=(len(flat.names), 6))
    found = part_sizes(flat, six, per_radius=True)
    for k, radius in enumerate(flat.radius):
        assert found[k] == pytest.approx(np.linalg.norm([*six[k, [0, 2]], six[k, 4] / radius]))


def test_of_a_motion_what_is_held_out_of_the_plane_or_no_number_is_left_out():
    built = program_of(paper.figure_8(planar=True))
    motion = np.ones((len(built.names), 6))
    motion[-1, 0] = np.nan
    judged_ = check_motion(built, motion)
    assert not judged_.motion[~built.free].any()
    assert not judged_.motion[:, [1, 3, 5]].any()
    assert judged_.motion[-1, 0] == 0.0
    free = built.free.copy()
    free[-1] = False
    kept = judged_.motion[free][:, [0, 2, 4]]  # two ways and a turn, all as they were to each other
    assert len(kept)
    assert (kept == kept[0, 0]).all()
    assert part_sizes(built, judged_.motion, per_radius=False).max() == pytest.approx(1.0)
    nothing = check_motion(built, 0 * motion)
    assert (nothing.power, nothing.violation, nothing.ratio, nothing.holds) == (0, 0, 0, False)


def test_forces_that_are_no_numbers_are_none():
    built, forces = resting(0.5)
    broken = forces.copy()
    broken[1] = np.nan
    assert check_forces(built, broken).forces[1] == 0.0
    aside = np.full((len(forces), 3), 1e-3)
    aside[2, 0] = np.inf
    assert check_forces(built, forces, aside).friction[2, 0] == 0.0
    assert check_forces(built, forces).holds  # without friction where there might be some


def test_friction_is_cut_to_mu_times_the_force_and_the_shear_limit_of_the_bond():
    built, forces = resting(0.5)
    bonded = dataclasses.replace(built, shear=np.full(len(forces), 0.1 * forces[0]))
    aside = np.zeros((len(forces), 3))
    aside[:, 0] = [0.4, 0.5, 0.6, 2.0] * forces
    cut = check_forces(bonded, forces, aside).friction
    assert cut[:, 0] == pytest.approx([0.4, 0.5, 0.6, 0.6] * forces)


def test_where_nothing_touches_nothing_is_violated():
    built, _ = resting()
    alone = built.taking(np.arange(0))
    motion = np.where(alone.free[:, None], [0.0, 0, -2, 0, 0, 0], 0.0)
    proof = check_motion(alone, motion)
    assert proof.violation == 0.0
    assert proof.holds
    assert proof.power == pytest.approx(built.weight[built.free][0])


def test_what_a_row_is_violated_by_is_a_length_or_none():
    """Of angular rows the turn times their arm; of rows that may pull either way, at most 0."""
    built = program_of(hanging_pair())
    assert built.angular.any()
    assert (built.arm[built.angular] != 1.0).any()
    motion = np.random.default_rng(5).normal(size=(len(built.names), 6))
    opening = np.array(built.velocities(motion)) * built.arm
    expected = [
        -abs(one) if tied else min(one, 0.0)
        for one, tied in zip(opening, built.two_sided, strict=True)
    ]
    found = violations(built, motion)
    assert found == pytest.approx(expected)
    assert (found <= 0).all()
    lifted = np.where(built.free[:, None], [0.0, 0, 1, 0, 0, 0], 0.0)
    open_ = violations(built, lifted)[~built.two_sided]
    assert (open_ == 0.0).all()


def two_blocks():
    """Two blocks side by side on a table; the second is small and heavy."""
    first = block("first", [0, 0, 0], [1, 1, 1], mass=2.0)
    second = block("second", [2, 0, 0], [2.2, 0.1, 0.1], mass=30.0)
    return program_of(Assembly([floor([-3, -3], [5, 5]), first, second]))


def test_only_clusters_that_move_count_in_the_needed_power():
    """The second block stands beside the first and does not touch it."""
    built = two_blocks()
    first, second = (built.names.index(name) for name in ("first", "second"))
    for turn in (0.0, 1e-7):
        motion = np.zeros((len(built.names), 6))
        motion[first, 0], motion[first, 2] = 1.0, -1e-3  # it violates its contacts
        motion[second, 4] = turn / built.radius[second]
        proof = check_motion(built, motion)
        weight = built.weight[first] + (built.weight[second] if turn else 0.0)
        needed = TOLERANCE * (built.weight[first] + turn * built.weight[second])
        needed += (EXCESS + RULED_OUT * proof.violation) * weight
        assert needed_power(built, proof) == pytest.approx(needed, rel=1e-12)
        assert proof.ratio == pytest.approx(proof.power / needed, rel=1e-12)


def test_the_needed_power_for_several_loads_is_enough_for_each():
    built = two_blocks()
    free = np.flatnonzero(built.free)
    weights = np.random.default_rng(6).uniform(1.0, 9.0, (3, len(built.names)))
    for sunk in (0.0, 1e-3):
        motion = np.zeros((len(built.names), 6))
        motion[free, 0], motion[free, 2] = 1.0, -sunk
        proof = check_motion(built, motion)
        assert (proof.violation > 0) == (sunk > 0)
        each = [needed_power(built, proof, weight[None]) for weight in weights]
        assert needed_power(built, proof, weights) == pytest.approx(max(each), rel=1e-12)
        least = TOLERANCE + EXCESS + RULED_OUT * proof.violation
        assert each == pytest.approx(least * weights[:, free].sum(axis=1), rel=1e-12)
        assert proof.holds == (proof.power > needed_power(built, proof))


def test_sizes_of_several_motions_are_those_of_each_motion():
    built = two_blocks()
    six = np.random.default_rng(7).normal(size=(4, len(built.names), 6))
    for per_radius in (False, True):
        each = [part_sizes(built, one, per_radius=per_radius) for one in six]
        assert np.array_equal(part_sizes(built, six, per_radius=per_radius), each)


def test_a_strap_of_limited_pull_may_lengthen():
    """A box of 2 kg hangs on a strap: its fall is a proof if the strap carries less than that."""
    deck = block("deck", [-9, -9, -9], [9, 9, -8], grounded=True)
    box = block("box", [-0.5, -0.5, 0], [0.5, 0.5, 1], mass=2.0)
    path = [("ground", [0, 0, 5]), ("box", [0, 0, 1])]
    for capacity, falls in ((10.0, True), (30.0, False)):
        strap = Strap(path, capacity=capacity)
        built = program_of(Assembly([deck, box], straps=[strap]))
        assert len(built.bounded) == 1
        fall = np.where(built.free[:, None], [0.0, 0, -1, 0, 0, 0], 0.0)
        proof = check_motion(built, fall)
        assert violations(built, fall).tolist() == [0.0]
        assert proof.violation == 0.0
        assert proof.power == pytest.approx(built.weight[built.free].sum() - capacity)
        assert proof.holds == falls
