"""Margins with known values, and worked by hand."""

import dataclasses
import json
import math

import numpy as np
import pytest
from judged import judged
from margins import by_points, leaning, program_of, small_assembly

import kilter
from kilter import Assembly, Box, Load, Part, Pose, Prism
from kilter.analysis import load_limit
from kilter.analysis.decision.judge import judge
from kilter.analysis.load_limit import (
    Limit,
    LimitSides,
    NoLimit,
    find_limit,
    gravity_wrench,
    with_more,
)
from kilter.analysis.margins import margin_steps
from kilter.analysis.margins.least_friction import find_least_friction
from kilter.analysis.margins.margin_steps import HELD_TRIED
from kilter.analysis.margins.part_limits import find_push, find_weakest_push
from kilter.analysis.margins.tilt import find_nearest_held, find_tilt_margin
from kilter.analysis.margins.uncertainty import Ranges
from kilter.mechanics import clusters as clusters_module
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.scenes import arches, friction, scene, stacks, walls
from kilter.scenes import traps as rounds
from kilter.scenes.pieces import block
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
    answer = kilter.margin(block, push=[1, 0, 0], pushes=True, effort=0)
    pushed = f"push of {program.names[1]}"
    assert {"tilt", "load_factor", pushed} <= set(answer.missing)
    assert answer.missing[pushed] == "failed"
    assert any("the solver failed" in text for text in answer.warnings)


def test_a_push_that_is_not_resisted_says_why():
    slope = stacks.block_on_slope(50.0, friction=0.3)
    answer = kilter.margin(slope, pushes=True, effort=0)
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
    tower = stacks.tower(HELD_TRIED + 1, friction=0.8)
    silent = kilter.margin(tower, improve=True, effort=0)
    assert not silent.pushes
    assert "hold" not in {one.what for one in silent.improvements}
    assert any("--part NAME" in text for text in silent.warnings)
    lowest = min(tower.parts[1:], key=lambda part: part.pose.position[2]).name
    asked = kilter.margin(tower, pushed=[lowest], improve=True, effort=0)
    assert [push.part for push in asked.pushes] == [lowest]
    held = [one for one in asked.improvements if one.what == "hold"]
    assert [one.parts for one in held] == [(lowest,)]
    # the rest of the tower is one lower
    gain = np.arctan(1 / HELD_TRIED) - np.arctan(1 / (HELD_TRIED + 1))
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


G = 9.81
WEIGHT = 0.1 * 0.2 * 0.3 * 2000 * G
MU = 0.8
BASE = block("base", [-500, -500, -10], [500, 500, 0], grounded=True)
BOX = Part("box", Box([100, 200, 300]), [0, 0, 150], density=2000.0)
TIPS = math.degrees(math.atan(50 / 150))


def answered(*parts: Part, **more: object) -> dict:
    assembly = Assembly([BASE, *parts], units="mm", friction=MU)
    return kilter.margin(assembly, **more).to_dict()


def near(limit: dict) -> dict[str, float]:
    """Tolerance of a value that has been proved from both sides: the distance of these sides."""
    assert limit["residual"] <= 1e-9
    assert 0 <= limit["gap"] <= 2e-7
    return {"rel": limit["gap"] + limit["residual"]}


@pytest.mark.slow
def test_a_box_tips_over_its_lower_edge():
    """The edge is 50 mm from the centre of mass, which is 150 mm above it."""
    answer = answered(BOX, push=[1, 0, 0], about=[0, 1, 0], pushes=True)
    limit = answer["tilt_limit"]
    assert answer["tilt_deg"] == pytest.approx(TIPS, **near(limit))
    assert TIPS * (1 - 1e-6) <= answer["tilt_lower_deg"] <= TIPS * (1 + 1e-9)
    sine, down = math.sin(math.radians(TIPS)), answer["tilt_down"]
    assert [abs(down[0]), down[1]] == pytest.approx([sine, 0], abs=1e-8)
    assert down[2] == pytest.approx(-math.cos(math.radians(TIPS)))
    assert answer["about"]["tilt_deg"] == pytest.approx(TIPS, **near(answer["about"]["limit"]))
    assert answer["load_factor"] == pytest.approx([-1 / 3, 1 / 3], rel=2e-7)
    (push,) = answer["pushes"]
    # the shortest push is across the arm from the edge to the centre
    arm = math.hypot(50, 150)
    assert push["force"] == pytest.approx(WEIGHT * 50 / arm, **near(push["limit"]))
    assert push["lower"] == pytest.approx(push["force"], rel=1e-6)
    assert push["lower"] <= WEIGHT * 50 / arm * (1 + 1e-9)
    assert np.abs(push["direction"]) == pytest.approx([150 / arm, 0, 50 / arm], abs=1e-6)
    assert push["direction"][2] > 0
    # mechanisms turn about the edge; shift and turn times radius have the length 1 mm together
    turn = 1 / math.hypot(arm, math.hypot(50, 100, 150))
    about = answer["about"]["limit"]
    for limit in (answer["tilt_limit"], push["limit"], about, *answer["load_limits"]):
        near(limit)
        moved = np.array(limit["mechanism"]["box"])
        sense = math.copysign(1, moved[4])
        expected = turn * np.array([150 * sense, 0, 50, 0, sense, 0])
        assert moved == pytest.approx(expected, abs=1e-6)
    # it stands without friction
    assert (answer["friction"], answer["friction_limit"]["lower"]) == (0, 0)


def test_a_box_that_lies_over_by_45_degrees_has_its_way_back_as_a_negative_tilt():
    answer = answered(BOX, down=[1, 0, -1])
    assert answer["down"] == pytest.approx([math.sqrt(0.5), 0, -math.sqrt(0.5)])
    assert answer["tilt_deg"] == pytest.approx(TIPS - 45, rel=1e-6)
    assert TIPS - 45 - 1e-6 <= answer["tilt_upper_deg"] <= TIPS - 45 + 1e-5
    # the nearest direction that holds is at the angle at which the box tips
    assert answer["tilt_down"][0] == pytest.approx(math.sin(math.radians(TIPS)), rel=1e-6)


@pytest.mark.slow
def test_the_worst_case_of_a_box_has_the_least_base_and_the_greatest_height():
    ranges = Ranges(mass=(0.9, 1.1), center=5.0, mu=(0.5, 1.2))
    answer = answered(BOX, push=[1, 0, 0], pushed=[], ranges=ranges)["uncertainty"]
    least = (50 - 5) / (150 + 5)
    assert math.tan(math.radians(answer["tilt_deg"])) == pytest.approx(least, rel=1e-6)
    assert answer["load_factor"] == pytest.approx([-least, least], rel=1e-6)
    x, _, z = answer["worst"]["box"]["shift"]
    assert (abs(x), z) == (5, 5)
    assert answer["worst"]["box"]["mass_factor"] in (0.9, 1.1)  # the tilt is the same for both
    assert answer["corners"] == 2 * 2**3  # two masses and two shifts along each axis
    assert (answer["mass"], answer["com"], answer["mu"]) == ([0.9, 1.1], 5.0, [0.5, 1.2])


@pytest.mark.slow
def test_the_worst_case_of_normals_takes_their_angle_from_that_of_friction():
    low = Part("low", Box([100, 100, 50]), [0, 0, 25])
    ranges = Ranges(mass=(1.0, 1.0), center=0.0, mu=(0.5, 1.0), normal_deg=2.0)
    answer = answered(low, pushed=[], ranges=ranges)["uncertainty"]
    expected = math.degrees(math.atan(0.5 * MU)) - 2
    assert answer["normal_deg"] == 2
    assert 0 < answer["tilt_deg"] <= expected + 1e-6
    assert answer["tilt_deg"] == pytest.approx(expected, rel=0.02)


@pytest.mark.slow
def test_a_slab_that_slides_has_mu_as_its_limit_and_a_bracket_from_zero():
    slab = Part("slab", Box([200, 200, 20]), [0, 0, 10])
    answer = answered(slab, push=[1, 0, 0], pushed=[], bracket=True)
    assert answer["load_factor"] == pytest.approx([-MU, MU], rel=1e-6)
    # without dilation it slides at mu, too, and without friction at once
    assert answer["load_factor_bracket"]["least"] == pytest.approx([-MU, 0], abs=1e-6)
    assert answer["load_factor_bracket"]["greatest"] == pytest.approx([0, MU], abs=1e-6)
    leaning = answered(slab, down=[0.3, 0, -1], pushed=[])
    assert leaning["friction"] == pytest.approx(0.3, rel=1e-6)
    assert leaning["friction_limit"]["lower"] == pytest.approx(0.3, rel=1e-3)
    assert leaning["friction_limit"]["lower"] <= 0.3 * (1 + 1e-9)
    assert leaning["friction_limit"]["residual"] <= 1e-9


@pytest.mark.slow
def test_the_load_at_the_end_of_a_plank():
    """A plank reaches 200 mm beyond the edge of its table, and a cube stands with 150 mm beyond."""
    plank = Part("plank", Box([1000, 100, 20]), [200, 0, 10], density=500.0)  # up to x = 700
    cube = Part("cube", Box([50, 50, 50]), [650, 0, 45], mass=0.1)
    answer = answered(plank, cube, loads=True, require="settles")
    found = {one["part"]: one for one in answer["loads"]}
    # about the edge at x = 500
    limit = (1.0 * 0.1 * 0.02 * 500 * G * 300 - 0.1 * G * 150) / 150
    assert found["cube"]["load"] == pytest.approx(limit, rel=1e-6)
    assert found["cube"]["mass"] == pytest.approx(limit / G, rel=1e-6)
    assert limit <= found["cube"]["beyond"] * (1 + 1e-9) <= limit * 1.001
    assert found["cube"]["residual"] <= 1e-9
    settles = answer["at_level"]["loads"]["cube"]
    assert settles["inside"] <= limit * (1 + 1e-6)
    assert limit * (1 - 1e-3) <= settles["outside"]
    assert settles["inside"] == pytest.approx(limit, rel=1e-2)
    # straight down on the plank itself means at its centre, which the table carries
    assert found["plank"]["load"] is None


@pytest.mark.slow
def test_a_box_settles_up_to_each_limit_of_equilibrium():
    """A box on a table has a single way to stand: forces of equilibrium are those of rest."""
    asked = {"push": [1, 0, 0], "about": [0, 1, 0], "pushes": True, "loads": True}
    answer = answered(BOX, require="settles", **asked)
    limits, arm = answer["at_level"], math.hypot(50, 150)
    expected = {
        "tilt_deg": TIPS, "about_deg": TIPS, "pushes": WEIGHT * 50 / arm, "load_factor": 1 / 3,
    }  # fmt: skip
    for key, value in expected.items():
        found = limits[key]
        found = found[1] if key == "load_factor" else found["box"] if key == "pushes" else found
        assert found["inside"] == pytest.approx(value, rel=1e-3), key
        assert found["inside"] <= value * (1 + 1e-9), key
        assert found["outside"] >= value * (1 - 1e-9), key
    assert limits["friction"]["inside"] == 0


@pytest.mark.parametrize("angle", [1e-3, 2e-5, 5e-6])
def test_a_push_above_a_hundred_thousand_weights_is_unlimited(angle):
    """A board that is pushed up a slope of this angle less than that at which friction jams it."""
    steep = math.pi / 2 - math.atan(MU) - angle
    high, aside = 200.0, 200.0 / math.tan(steep)
    board = Prism([(0, 0), (1000, 0), (1000 + aside, high), (0, high)], 1000)
    wall = Prism([(1000, 0), (4000, 0), (4000, high), (1000 + aside, high)], 1000)
    parts = [
        block("base", [-5000, -5000, -10], [5000, 5000, 0], grounded=True),
        Part("board", board, density=2000.0),
        Part("wall", wall, grounded=True),
    ]
    assembly = Assembly(parts, units="mm", friction=MU)
    push = find_push(program_of(assembly), 1, np.array([1.0, 0.0, 0.0]))
    most = 1 / math.tan(angle)
    expected = most * assembly["board"].mass * G if most < 1e5 else math.inf
    assert push.force == pytest.approx(expected, rel=1e-6)


def boxes_on_a_table(sizes, **options):
    """Boxes of the given sizes side by side on a table, too far apart to touch."""
    table = Part("table", Box(10 * len(sizes), 10, 1), [0, 0, -0.5], grounded=True)
    boxes = [
        Part(f"box-{k}", Box(*size), [4 * k - 2 * len(sizes), 0, size[2] / 2])
        for k, size in enumerate(sizes)
    ]
    return Assembly([table, *boxes], **options)


SLENDER = [(1.0, 1.0, 2.0), (1.0, 1.2, 3.0), (1.0, 1.0, 2.5), (1.0, 1.2, 3.0)]


def test_the_limits_of_groups_that_do_not_touch_are_those_of_the_first_to_fail():
    """A box tips at tan = width / height; the gain of fixing one ends at the next."""
    slender = boxes_on_a_table(SLENDER[:3], friction=0.9)
    answer = kilter.margin(slender, push=[0, 1, 0], improve=True)
    assert answer.tilt_deg == pytest.approx(np.degrees(np.arctan(1 / 3.0)), abs=1e-6)
    assert answer.tilt.closed
    assert answer.tilt_limit.moves == ["box-1"]
    assert answer.load_factor == pytest.approx((-0.4, 0.4), abs=1e-7)  # across y box-2 fails first
    (hold,) = [one for one in answer.improvements if one.what == "hold"]
    assert hold.parts == ("box-1",)
    gain = np.degrees(np.arctan(1 / 2.5) - np.arctan(1 / 3.0))
    assert hold.gain == pytest.approx(gain, abs=1e-5)
    twice = kilter.margin(boxes_on_a_table(SLENDER, friction=0.9), improve=True)
    assert twice.tilt_deg == pytest.approx(answer.tilt_deg, abs=1e-9)
    assert not twice.improvements  # another box is as slender


def test_separate_groups_are_the_same_whether_split_or_not(monkeypatch):
    sizes = [(1.0, 1.1, 0.8 + 0.1 * k) for k in range(6)]
    whole = kilter.margin(boxes_on_a_table(sizes, friction=0.5), push=[1, 0, 0])
    monkeypatch.setattr(clusters_module, "PARTED", 0)
    monkeypatch.setattr(clusters_module, "GROUP", 6)
    split = kilter.margin(boxes_on_a_table(sizes, friction=0.5), push=[1, 0, 0])
    assert split.tilt_deg == pytest.approx(whole.tilt_deg, abs=1e-6)
    assert split.load_factor == pytest.approx(whole.load_factor, abs=1e-6)
    assert split.friction == whole.friction


def test_a_load_factor_that_no_group_shares_is_none():
    """One box is held from a factor on that the other does not bear."""
    wall = Part("wall", Box(1, 4, 4), [0, 0, 2], grounded=True)
    table = Part("table", Box(9, 9, 1), [7, 0, -0.5], grounded=True)
    pressed = Part("pressed", Box(1, 1, 1), [1, 0, 2])
    slid = Part("slid", Box(1, 1, 1), [8, 0, 0.5])
    weight = 9810.0
    loads = [
        Load("pressed", force=[-weight, 0, 0]),  # held by the wall from a factor of 1 / mu on
        Load("slid", force=[0, weight, 0]),  # slides at a factor of mu
    ]
    answer = kilter.margin(Assembly([wall, table, pressed, slid], friction=0.4, loads=loads))
    assert answer.load_factor is None
    assert answer.missing["load_factor"] == "none"


def test_equal_boxes_have_equal_pushes_with_proofs_of_their_own(tmp_path):
    assembly = boxes_on_a_table([(1.0, 1.1, 0.8)] * 3, friction=0.3)
    answer = kilter.margin(assembly, pushes=True, effort=0)
    expected = 1.0 * 1.1 * 0.8 * 9810 * 0.3 / math.hypot(1, 0.3)
    assert [push.part for push in answer.pushes] == ["box-0", "box-1", "box-2"]
    assert [push.force for push in answer.pushes] == pytest.approx([expected] * 3, rel=1e-5)
    assert [push.limit.moves for push in answer.pushes] == [["box-0"], ["box-1"], ["box-2"]]
    assert kilter.verify(assembly, answer.proof()).holds


@pytest.mark.slow
def test_of_many_parts_those_are_pushed_that_move_most_easily(monkeypatch):
    monkeypatch.setattr(margin_steps, "PUSHED", 2)
    sizes = [(1.0, 1.0, 0.3), (1.0, 1.0, 0.9), (1.0, 1.0, 0.5)]
    answer = kilter.margin(boxes_on_a_table(sizes, friction=0.3), pushes=True, effort=0)
    assert [push.part for push in answer.pushes] == ["box-0", "box-2"]
    assert any("pushes: 2 of 3 parts" in text for text in answer.warnings)
    named = kilter.margin(boxes_on_a_table(sizes, friction=0.3), pushed=["box-1"], effort=0)
    assert [push.part for push in named.pushes] == ["box-1"]
    assert not kilter.margin(boxes_on_a_table(sizes, friction=0.3), effort=0).pushes
