"""Second order of joints, of linkages, and of groups that move as one."""

import copy
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from balance_cases import CASES
from jointed_energy import expected, linkage
from random_linkages import random_linkage

import kilter
from kilter import Assembly, Box, Cylinder, Joint, Part, Pose, Sphere
from kilter.assembly.interactions import JointKind
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes.pieces import moved
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.gaps.joint_forms import joint_errors, joint_forms
from kilter.second_order.parts.rigid_groups import RigidGroups

Y = np.array([0.0, 1.0, 0.0])
OFF = 1e-4
MOVING: tuple[JointKind, ...] = ("revolute", "prismatic", "cylindrical", "spherical")


def bar(name: str, start: tuple[float, ...], end: tuple[float, ...], **more: float) -> Part:
    """A thin upright bar in the plane y = start[1], from one point to the other."""
    first, last = np.array(start), np.array(end)
    along = last - first
    turn = np.arctan2(along[0], along[2]) / 2
    pose = Pose((first + last) / 2, rotation=[np.cos(turn), 0, np.sin(turn), 0])
    return Part(name, Box([0.04, 0.04, float(np.linalg.norm(along))]), pose, **more)


def hinge(parts: tuple[str, str], at: tuple[float, ...]) -> Joint:
    return Joint(parts, "revolute", point=at, axis=Y)


def second(assembly: Assembly) -> SecondOrder:
    """The answer of second order; its proof holds, too."""
    verdict = kilter.check(assembly)
    assert kilter.verify(assembly, verdict.proof()).holds
    assert verdict.second_order_answer is not None
    return verdict.second_order_answer


@pytest.mark.parametrize("kind", MOVING)
@pytest.mark.parametrize("planar", [False, True])
def test_the_forms_of_a_joint_are_the_second_derivatives_of_its_equations(kind, planar):
    random = np.random.default_rng(MOVING.index(kind))
    axis = Y if planar and kind != "prismatic" else random.normal(size=3) * ([1, not planar, 1])
    parts = [bar("a", (0, 0, 0), (0.3, 0, 1)), bar("b", (0.3, 0.1, 1), (1, 0.1, 1.4))]
    joint = Joint(("a", "b"), kind, point=[0.3, 0.05, 1], axis=axis)
    held = Part("held", Box([1, 1, 1]), Pose([9, 9, 9]), grounded=True)
    require_second_derivatives(Assembly([*parts, held], joints=[joint], planar=planar), random)


@pytest.mark.parametrize("slides", range(4))
@pytest.mark.parametrize("turns", range(4))
def test_the_forms_of_a_general_joint_are_the_second_derivatives_of_its_equations(slides, turns):
    random = np.random.default_rng(10 * slides + turns)
    parts = [bar("a", (0, 0, 0), (0.3, 0, 1)), bar("b", (0.3, 0.1, 1), (1, 0.1, 1.4))]
    directions = {
        "slides": random.normal(size=(slides, 3)),
        "turns": random.normal(size=(turns, 3)),
    }
    joint = Joint(("a", "b"), "general", point=[0.3, 0.05, 1], **directions)
    held = Part("held", Box([1, 1, 1]), Pose([9, 9, 9]), grounded=True)
    require_second_derivatives(Assembly([*parts, held], joints=[joint]), random)


def require_second_derivatives(assembly: Assembly, random: np.random.Generator) -> None:
    """The forms of the rows of joints are second derivatives, by differences in five directions."""
    program = build_program(assembly, kilter.contacts(assembly))
    forms = joint_forms(program, assembly.joints)
    step = 1e-3
    for _ in range(5):
        motion = program.full(random.normal(size=len(program.columns)))
        ahead, behind = (
            joint_errors(program, assembly.joints, sense * step * motion) for sense in (1, -1)
        )
        both = np.concatenate([motion[0], motion[1]])
        rate = program.velocities(motion) * program.arm
        assert (ahead - behind) / (2 * step) == pytest.approx(rate, abs=1e-4)
        bend = np.einsum("i,kij,j->k", both, forms, both)
        assert (ahead + behind) / step**2 == pytest.approx(bend, abs=1e-4)


@pytest.mark.quick(5)
@pytest.mark.parametrize("kind", ["revolute", "spherical", "cylindrical"])
@pytest.mark.parametrize(
    ("below", "state"), [(-1, "balanced"), (-OFF, "balanced"), (0, "free"), (OFF, ""), (1, "")]
)
def test_a_pendulum_falls_above_its_joint_and_swings_below_it(kind, below, state):
    rod = bar("rod", (0, 0, -below - 0.5), (0, 0, -below + 0.5))
    joint = Joint(("rod", "ground"), kind, point=[0, 0, 0], axis=Y)
    found = second(Assembly([rod], joints=[joint]))
    # a ball joint also turns about the vertical, and a cylindrical joint also slides
    expected = state or ("minimum" if kind == "revolute" else "free")
    assert found.state == expected
    if kind == "revolute":
        inertia = float(Assembly([rod], joints=[joint]).geometry.inertia[0, 1, 1])
        mass = float(Assembly([rod], joints=[joint]).geometry.mass[0])
        rate = np.sqrt(mass * 9.81 * abs(below) / (inertia + mass * below**2))
        assert found.rate == (pytest.approx(rate, rel=1e-3) if below else None)


@pytest.mark.parametrize("slope", [0.0, 30.0, 60.0])
def test_an_axis_that_a_ball_joint_does_not_use_changes_nothing(slope):
    """A rod hangs below its ball joint, whatever axis the joint also names."""
    axis = [np.cos(np.radians(slope)), 0, np.sin(np.radians(slope))]
    rod = bar("rod", (0, 0, -1), (0, 0, 0))
    joint = Joint(("rod", "ground"), "spherical", point=[0, 0, 0], axis=axis)
    assert second(Assembly([rod], joints=[joint])).state == "free"
    aside = replace(joint, point=[0.1, 0, 0])
    assert kilter.check(Assembly([rod], joints=[aside])).verdict == "unstable"


def test_a_pendulum_on_a_level_rail_slides_and_swings():
    for below, state in ((0.5, "free"), (-0.5, "balanced")):
        cart = Part("cart", Box([0.2, 0.2, 0.2]), Pose([0, 1, 0]))
        rod = bar("rod", (0, 0, -below - 0.5), (0, 0, -below + 0.5))
        rail = Joint(("cart", "ground"), "prismatic", axis=[1, 0, 0])
        assembly = Assembly([cart, rod], joints=[rail, hinge(("rod", "cart"), (0, 0, 0))])
        assert second(assembly).state == state


@pytest.mark.parametrize("first", [1, -1])
@pytest.mark.parametrize("last", [1, -1])
def test_of_a_double_pendulum_only_down_and_down_is_stable(first, last):
    upper = bar("upper", (0, 0, 0), (0, 0, first))
    lower = bar("lower", (0, 0.1, first), (0, 0.1, first + last))
    joints = [hinge(("upper", "ground"), (0, 0, 0)), hinge(("lower", "upper"), (0, 0, first))]
    found = second(Assembly([upper, lower], joints=joints))
    assert found.state == ("minimum" if first == last == -1 else "balanced")
    assert (found.neutral, found.free) == (2, 0)


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("above", "state"), [(0.5, "balanced"), (OFF, "balanced"), (0, "free"), (-OFF, "minimum")]
)
def test_a_lever_with_a_counterweight_stands_if_the_common_centre_is_below_the_hinge(above, state):
    lever = bar("lever", (-1, 0, 0), (1, 0, 0), mass=1.0)
    weights = [
        Part("left", Box([0.1, 0.1, 0.1]), Pose([-1, 0, 0]), mass=3.0),
        Part("right", Box([0.1, 0.1, 0.1]), Pose([1, 0, 0]), mass=3.0),
    ]
    ties = [Joint(("lever", name)) for name in ("left", "right")]
    beam = Assembly([lever, *weights], joints=[*ties, hinge(("lever", "ground"), (0, 0, -above))])
    assert second(beam).state == state


def four_bar(width: float, side: float, load: float = 0.0) -> Assembly:
    """A coupler on two bars of length `side` that stand (or hang, if negative) on two hinges."""
    left = bar("left", (0, 0, 0), (0, 0, side))
    right = bar("right", (width, 0, 0), (width, 0, side))
    coupler = bar("coupler", (0, 0.1, side), (width, 0.1, side), mass=1.0 + load)
    joints = [
        hinge(("left", "ground"), (0, 0, 0)),
        hinge(("right", "ground"), (width, 0, 0)),
        hinge(("coupler", "left"), (0, 0, side)),
        hinge(("coupler", "right"), (width, 0, side)),
    ]
    return Assembly([left, right, coupler], joints=joints)


def test_a_parallelogram_falls_if_it_stands_and_swings_if_it_hangs():
    """A closed chain whose rows depend on one another: four parallel hinges of a planar linkage."""
    assert second(four_bar(2.0, 1.0)).state == "balanced"
    hanging = second(four_bar(2.0, -1.0))
    assert (hanging.state, hanging.neutral) == ("minimum", 1)


def test_a_stretched_chain_is_locked_by_its_self_stress():
    """Two collinear bars between fixed hinges move to first order, but not to second order."""
    bars = [bar("left", (0, 0, 0), (1, 0, 0)), bar("right", (1, 0.1, 0), (2, 0.1, 0))]
    at = [(0, 0, 0), (1, 0, 0), (2, 0, 0)]
    names = [("left", "ground"), ("left", "right"), ("right", "ground")]
    stretched = Assembly(bars, joints=[hinge(*both) for both in zip(names, at, strict=True)])
    level = stretched.with_down([0, 1, 0])  # no load acts along the motion
    found = second(level)
    assert (found.state, found.neutral, found.free) == ("minimum", 1, 0)


def test_a_proof_about_joints_fails_for_another_pose():
    down, up = (
        Assembly([bar("rod", (0, 0, 0), (0, 0, s))], joints=[hinge(("rod", "ground"), (0, 0, 0))])
        for s in (-1.0, 1.0)
    )
    hanging, standing = kilter.check(down).proof(), kilter.check(up).proof()
    forged = copy.deepcopy(standing)
    forged["second_order"], forged["verdict"] = hanging["second_order"], "stable"
    forged["digest"] = digest_of(forged)
    assert not kilter.verify(up, forged).holds
    opened = copy.deepcopy(standing)
    place = opened["second_order"]["configuration"]["rod"]
    opened["second_order"]["configuration"]["rod"] = [place[0] + 1e-6, *place[1:]]
    opened["digest"] = digest_of(opened)
    assert any("a joint is open" in reason for reason in kilter.verify(up, opened).reasons)


@pytest.mark.slow
def test_verdicts_agree_with_the_energy_along_exact_motions():
    results = Counter(linkage(seed) for seed in range(1000, 1030))
    assert results["wrong"] == 0
    assert results["right"] >= 28


def test_the_random_cases_fall_and_stay():
    states = Counter(expected(random_linkage(seed).curvatures()) for seed in range(12))
    assert states["balanced"] >= 2
    assert states["free"] + states["minimum"] >= 2


FLOOR = Part("floor", Box([20, 20, 1]), Pose([0, 0, -0.5]), grounded=True)
BALL = Part("ball", Sphere(0.5), Pose([0, 0, 0.5]), mass=1.0)
SINGLE = [case for case in CASES if {one.name for one in case.build(0.1).parts} == {"base", "b"}]


def tie(*names: str) -> list[Joint]:
    return [Joint((names[0], one), "fixed") for one in names[1:]]


def second_of(assembly: Assembly) -> SecondOrder:
    second = kilter.check(assembly).second_order_answer
    assert second is not None
    return second


def in_two(assembly: Assembly) -> Assembly:
    """The free part as two tied parts with the same total mass and centre."""
    base, body = assembly.parts
    off = np.array([0.3, -0.7, 0.2])
    halves = [
        replace(
            body, name=name, mass=share * body.mass, pose=Pose(body.pose.position + by * off),
            center_of_mass=None,
        )
        for name, share, by in (("b", 0.4, 0.6), ("other", 0.6, -0.4))
    ]  # fmt: skip
    return replace(assembly, parts=[base, *halves], joints=tie("b", "other"))


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", SINGLE, ids=lambda case: case.number)
def test_a_known_case_of_two_halves_has_its_state(case):
    limit = case.limit
    for at, state in [(0.0, case.state)] if limit is None else [
        (limit - 1e-6, case.state),
        (limit + 1e-6, case.above),
    ]:  # fmt: skip
        second = second_of(in_two(case.build(at)))
        spun = "free" if state == "minimum" and case.free else state  # a spin is seen now
        assert second.state in (state, spun)
        if state != "balanced":
            assert second.free == case.free
        assert set(second.moving.tolist()) in ({1, 2}, set())


@pytest.mark.slow
@pytest.mark.parametrize("off", [1e-4, -1e-4])
def test_a_weeble_stands_while_its_centre_is_below_the_middle_of_its_ball(off):
    weight = Part("weight", Box([0.1] * 3), Pose([0, 0, 0.5 - off]), mass=3.0)
    for assembly in (
        Assembly([FLOOR, BALL, weight], joints=tie("ball", "weight")),
        moved(
            Assembly([FLOOR, BALL, weight], joints=tie("ball", "weight")),
            np.array([0.5, 0.3, -0.7, 0.41]), [3.0, -2.0, 5.0],
        ),
    ):  # fmt: skip
        found = kilter.check(assembly)
        second = found.second_order_answer
        assert second is not None
        assert second.state == ("free" if off > 0 else "balanced")
        assert (second.neutral, second.free, second.blocked) == (5, 3, 2)
        assert kilter.verify(assembly, found.proof()).holds


@pytest.mark.slow
def test_what_falls_has_a_place_where_the_parts_of_a_group_moved_as_one():
    rod = Part("rod", Cylinder(0.1, 1.0), Pose([0, 0, 1.5]))
    assembly = Assembly([FLOOR, BALL, rod], joints=tie("ball", "rod"))
    found = kilter.check(assembly)
    second = found.second_order_answer
    assert second is not None
    assert second.state == "balanced"
    assert second.configuration is not None
    proof = found.proof()
    assert kilter.verify(assembly, proof).holds
    groups = RigidGroups.of(assembly)
    placed = groups.placed(second.configuration.motion)
    geometry = assembly.geometry
    before = geometry.center[2] - geometry.center[1]
    after = geometry.center[2] + placed[2, :3] - geometry.center[1] - placed[1, :3]
    assert np.linalg.norm(after) == pytest.approx(np.linalg.norm(before), abs=1e-15)
    np.testing.assert_array_equal(placed[1, 3:], placed[2, 3:])
    small = 1e-6 * second.configuration.motion
    np.testing.assert_allclose(groups.placed(small), groups.spread(small), atol=1e-14)
    for axis, by in ((2, -0.01), (2, 1.0)):  # into the floor; higher
        other = copy.deepcopy(proof)
        other["second_order"]["configuration"]["ball"][axis] += by
        other["digest"] = digest_of(other)
        assert not kilter.verify(assembly, other).holds


def test_the_program_of_a_group_is_that_of_one_part():
    """A box as two tied halves has mass, centre, inertia and loads of the whole box."""
    low = Part("low", Box([1, 2, 1]), Pose([0, 0, 0.5]), mass=1.0)
    high = Part("high", Box([1, 2, 2]), Pose([0, 0, 2]), mass=2.0)
    load = kilter.Load("high", force=[1.0, 2, 3], point=[0.3, 0.1, 2.5])
    tied = Assembly([FLOOR, low, high], joints=tie("low", "high"), loads=[load])
    whole = Part("low", Box([1, 2, 3]), Pose([0, 0, 1.5]), mass=3.0)
    one = Assembly([FLOOR, whole], loads=[replace(load, part="low")])
    programs = []
    for assembly in (tied, one):
        program = build_program(assembly, kilter.contacts(assembly))
        programs.append(RigidGroups.of(assembly).merged(program, assembly))
    a, b = programs
    assert a.free.tolist() == [False, True, False]
    for name in ("mass", "center", "inertia", "applied"):
        np.testing.assert_allclose(getattr(a, name)[1], getattr(b, name)[1], atol=1e-12)
    np.testing.assert_allclose(a.jacobian().toarray(), b.jacobian().toarray(), atol=1e-12)
    assert a.radius[1] >= b.radius[1] - 1e-12


@pytest.mark.slow
def test_what_is_tied_to_the_held_is_held_and_a_hinge_beside_friction_leaves_it_open():
    top = Part("top", Box([2, 2, 0.3]), Pose([0, 0, 1.15]))
    held = second_of(Assembly([FLOOR, BALL, top], joints=tie("floor", "ball")))
    assert (held.state, held.neutral, held.moving.tolist()) == ("balanced", 5, [2])
    hat = Part("hat", Box([1, 1, 0.3]), Pose([0, 0, 1.45]))
    both = tie("floor", "ball") + tie("top", "hat")
    assert second_of(Assembly([FLOOR, BALL, top, hat], joints=both)).moving.tolist() == [2, 3]
    hinge = Joint(("top", "hat"), "revolute", [0, 0, 1.3], [1, 0, 0])
    hinged = Assembly([FLOOR, BALL, top, hat], joints=[*tie("floor", "ball"), hinge])
    assert second_of(hinged).moving.tolist() == [2, 3]
    verdict = kilter.check(hinged, friction=0.5)
    assert (verdict.why, verdict.level) == ("push-open", "equilibrium")
    assert "a small push may make top and hat roll, rock or swing on: " in verdict.sentence


@pytest.mark.slow
def test_what_is_tied_to_the_ground_is_held():
    hand = Part("hand", Box([1, 1, 1]), Pose([0, 0, 5]))
    arm = Part("arm", Box([1, 1, 1]), Pose([0, 0, 6]))
    joints = [Joint(("arm", "ground"), "fixed"), *tie("arm", "hand")]
    for parts in ([FLOOR, BALL, hand, arm], [hand, arm]):
        assembly = Assembly(parts, joints=joints)
        groups = RigidGroups.of(assembly)
        assert groups.held[-2:].all()
        program = build_program(assembly, kilter.contacts(assembly))
        merged = groups.merged(program, assembly)
        assert not merged.free[-2:].any()
        second = kilter.check(assembly).second_order_answer
        assert (None if second is None else second.moving.tolist()) == (
            [1] if len(parts) == 4 else None
        )
