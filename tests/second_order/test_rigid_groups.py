"""Parts that fixed joints tie are a single body to second order."""

from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np
import pytest
from balance_cases import CASES, Case

import kilter
from kilter import Assembly, Box, Cylinder, Joint, Part, Pose, Sphere
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.scenes.transform import moved
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.parts.rigid_groups import RigidGroups

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
def test_a_known_case_of_two_halves_has_its_state(case: Case) -> None:
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
def test_a_weeble_stands_while_its_centre_is_below_the_middle_of_its_ball(off: float) -> None:
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
def test_what_falls_has_a_place_where_the_parts_of_a_group_moved_as_one() -> None:
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


def test_the_program_of_a_group_is_that_of_one_part() -> None:
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
def test_what_is_tied_to_the_held_is_held_and_a_hinge_beside_friction_leaves_it_open() -> None:
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
def test_what_is_tied_to_the_ground_is_held() -> None:
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
