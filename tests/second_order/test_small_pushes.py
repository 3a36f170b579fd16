"""Stable means that a small push topples nothing: closed forms, each on both sides of its limit."""

import copy
from typing import Any

import numpy as np
import pytest
from lathe import turned_part

import kilter
from kilter import (
    Assembly,
    Box,
    Cylinder,
    Joint,
    Load,
    Part,
    Pose,
    Prism,
    Sphere,
    Tolerance,
    Verdict,
)
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.second_order.motions.bending import bending_bodies, steady_parts
from kilter.second_order.parts.rigid_groups import RigidGroups

TABLE = Part("table", Box([60, 60, 1]), Pose([0, 0, -0.5]), grounded=True)
ALONG_Y = [2**-0.5, 2**-0.5, 0, 0]
GRIPS = (0.1, 0.5, 1.0)
R = 0.5


def pushed(parts: list[Part], mu: float, joints: list[Joint] | None = None, **more: Any) -> Verdict:
    """The verdict on parts on a table; its proof holds, and no stronger verdict holds with it."""
    assembly = Assembly([TABLE, *parts], friction=mu, joints=joints or [], **more)
    verdict = kilter.check(assembly)
    proof = verdict.proof()
    assert kilter.verify(assembly, proof).holds
    assert verdict.stable == (verdict.verdict == "stable")
    if verdict.verdict != "stable":
        stronger = copy.deepcopy(proof)
        stronger["verdict"], stronger["second_order"] = "stable", None
        stronger["digest"] = digest_of(stronger)
        assert not kilter.verify(assembly, stronger).holds
    return verdict


def roller(radius: float, *, held: bool) -> Part:
    return Part("roller", Cylinder(radius, 2), Pose([0, 0, radius], rotation=ALONG_Y), held)


def slab(radius: float, thickness: float) -> Part:
    return Part("slab", Box([1, 1, thickness]), Pose([0, 0, 2 * radius + thickness / 2]))


def balls(*, held: bool = False, at: tuple[float, float] = (0, 0), on: float = 0.0) -> list[Part]:
    return [
        Part("ball1", Sphere(R), Pose([*at, on + R]), grounded=held),
        Part("ball2", Sphere(R), Pose([*at, on + 3 * R])),
    ]


@pytest.mark.quick(1)
@pytest.mark.parametrize("mu", [0.0, *GRIPS])
@pytest.mark.parametrize("held", [False, True])
def test_a_ball_falls_off_a_ball(mu, held):
    verdict = pushed(balls(held=held), mu)
    assert (verdict.verdict, verdict.level, verdict.why) == ("balanced", "equilibrium", "balanced")
    assert verdict.second_order_answer is not None
    assert (verdict.second_order_answer.rolling is None) == (mu == 0)
    if mu:
        assert "friction cannot hold" in verdict.sentence


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.5])
def test_a_ball_falls_off_two_balls_and_lies_in_a_bowl_and_in_a_groove(mu):
    two = [Part(f"low {s}", Sphere(R), Pose([0, s * 0.6, R]), True) for s in (-1, 1)]
    up = R + np.sqrt(1.0 - 0.36)
    assert pushed([*two, Part("ball", Sphere(R), Pose([0, 0, up]))], mu).verdict == "balanced"
    bowl = turned_part(
        "bowl", [(0, 0), (3, 0), (3, 1.4), (2, 1.4), (0, 0.4, 0, 2.9)], grounded=True
    )
    ball = Part("ball", Sphere(R), Pose([0, 0, 0.4 + R]))
    assert pushed([bowl, ball], mu).verdict == "stable"
    log = Part("log", Cylinder(R, 2), Pose([0, 0, 1.5 + R * 2**0.5], rotation=ALONG_Y))
    for rolling in (log, Part("ball", Sphere(R), log.pose)):
        found = pushed([wing(-1), wing(1), rolling], mu)
        assert found.verdict == "stable"


def wing(side: int) -> Part:
    """One side of a groove of 90 degrees along y, whose lowest line is at z = 1.5."""
    s = 2**-0.5
    normal, slope = np.array([-side * s, 0, s]), np.array([side * s, 0, s])
    turn = [np.cos(np.pi / 8), 0, -side * np.sin(np.pi / 8), 0]
    at = np.array([0, 0, 1.5]) - normal / 2 + 2 * slope
    return Part(f"wing {side}", Box([4, 4, 1]), Pose(at, turn), grounded=True)


@pytest.mark.quick(2)
@pytest.mark.parametrize("thickness", [0.01, 0.1, 0.5])
@pytest.mark.parametrize("mu", [0.0, 0.5])
def test_a_slab_tips_about_a_free_roller_whatever_its_thickness(thickness, mu):
    verdict = pushed([roller(0.1, held=False), slab(0.1, thickness)], mu)
    assert (verdict.verdict, verdict.level) == ("balanced", "equilibrium")


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("radius", "state"),
    [
        (0.25 + 1e-5, "holds"),
        (1.0, "holds"),
        (0.25, "open"),
        (0.25 - 1e-5, "falls"),
        (0.1, "falls"),
    ],
)
def test_friction_holds_a_slab_on_a_held_roller_if_it_is_thinner_than_the_roller(radius, state):
    """B / 2 < R; at equality it falls, at fourth order."""
    verdict = pushed([roller(radius, held=True), slab(radius, 0.5)], 0.5)
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.rolling is not None
    assert verdict.second_order_answer.rolling.state == state
    assert verdict.verdict == ("stable" if state == "holds" else "balanced")
    assert pushed([roller(radius, held=True), slab(radius, 0.5)], 0.0).verdict == "balanced"


@pytest.mark.quick(2)
@pytest.mark.parametrize(("off", "verdict"), [(-1e-4, "stable"), (1e-4, "balanced")])
@pytest.mark.parametrize("rho", [0.2, 0.5, 0.8])
@pytest.mark.parametrize("mu", [0.0, 0.5])
def test_a_roly_poly_toy_stands_up_if_its_mast_is_short(off, verdict, rho, mu):
    """A half ball with a cylinder (rho, H) on it, of one density: rho H < R^2 / sqrt 2."""
    height = (1 + off) / (rho * np.sqrt(2.0))
    toy = turned_part("toy", [(0, 0), (1, 1, 0, 1), (rho, 1), (rho, 1 + height), (0, 1 + height)])
    assert pushed([toy], mu).verdict == verdict


@pytest.mark.parametrize(
    ("above", "state"), [(-0.1, "balanced"), (-1e-4, "balanced"), (0, "free"), (1e-4, "minimum")]
)
def test_a_seesaw_stays_level_if_its_pivot_is_above_its_centre(above, state):
    beam = Part("beam", Box([4, 0.3, 0.2]), Pose([0, 0, 2]))
    pivot = Joint(("beam", "ground"), "revolute", point=[0, 0, 2 + above], axis=[0, 1, 0])
    verdict = pushed([beam], 0.5, [pivot])
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.state == state
    assert verdict.verdict == ("balanced" if state == "balanced" else "stable")


def crowd(count: int, on: float) -> list[Part]:
    return [
        Part(f"box{k}", Box([R, R, R]), Pose([0.7 * (k % 6) - 4, 0.7 * (k // 6) - 6, on + R / 2]))
        for k in range(count)
    ]


@pytest.mark.quick(1)
@pytest.mark.parametrize("count", [3, 25])
@pytest.mark.parametrize("mu", [0.0, 0.5])
def test_balls_fall_alike_whatever_stands_beside_them(count, mu):
    """All stand on one free base, so that they touch each other through it."""
    base = Part("base", Box([16, 16, 1]), Pose([0, 0, 0.5]))
    verdict = pushed([base, *balls(on=1), *crowd(count, 1)], mu)
    assert verdict.verdict == "balanced"
    assert "makes ball1 and ball2 fall" in verdict.sentence


@pytest.mark.quick(1)
@pytest.mark.parametrize("count", [3, 25])
def test_a_ball_in_a_bowl_stays_whatever_stands_beside_it(count):
    base = Part("base", Box([16, 16, 1]), Pose([0, 0, 0.5]))
    bowl = turned_part("bowl", [(0, 0), (3, 0), (3, 1.4), (2, 1.4), (0, 0.4, 0, 2.9)], [4, 4, 1])
    ball = Part("ball", Sphere(R), Pose([4, 4, 1.4 + R]))
    assert pushed([base, bowl, ball, *crowd(count, 1)], 0.5).verdict == "stable"


def ramp() -> list[Part]:
    """A block on a slope, which only friction holds; it touches nothing else."""
    slope = [np.cos(0.1), 0, np.sin(0.1), 0]
    up = np.array([np.sin(0.2), 0, np.cos(0.2)])
    held = Part("ramp", Box([4, 4, 1]), Pose([9, 0, 3], slope), grounded=True)
    return [held, Part("sliding", Box([1, 1, 1]), Pose(np.array([9, 0, 3]) + up, slope))]


def wedge() -> list[Part]:
    """A wedge that friction holds on a slope; its top is level, at the height 5."""
    fall = 4 * np.tan(0.2)
    slope = Prism([(-4, 1), (4, 1), (4, 4 - fall), (-4, 4 + fall)], 4)
    top = Prism([(-2, 4 + fall / 2), (2, 4 - fall / 2), (2, 5), (-2, 5)], 4)
    return [Part("slope", slope, grounded=True), Part("wedge", top)]


def pin(radius: float, at: tuple[float, float, float] = (0, 0, 2)) -> Part:
    profile = [(0, -1), (radius, -1), (radius, 1), (0, 1)]
    return Part("pin", turned_part("pin", profile).shape, Pose(at, ALONG_Y))


def bearing() -> Part:
    """A held ring of inner radius .1 about an axis along y at the height 2."""
    ring = [(0.1, 0), (0.5, 0), (0.5, 0.5), (0.1, 0.5), (0.1, 0)]
    return Part("bearing", turned_part("b", ring).shape, Pose([0, 0, 2], ALONG_Y), grounded=True)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("height", "verdict"), [(0.2, "balanced"), (0, "stable"), (-0.2, "stable")]
)
@pytest.mark.parametrize("radius", [0.1, 0.09])
def test_a_crank_turns_down_in_a_bore_with_or_without_play(height, verdict, radius):
    """A weight on a shaft falls if it is above the axis; play of .01 counts as closed."""
    weight = Part("weight", Box([0.3, 0.2, 0.3]), Pose([0, 0.9, 2 + height]))
    parts, tied = [bearing(), pin(radius), weight], [Joint(("pin", "weight"), "fixed")]
    found = pushed(parts, 0, tied, tolerance=Tolerance(clearance=0.02))
    assert found.verdict == verdict


@pytest.mark.slow
@pytest.mark.parametrize(("height", "verdict"), [(0.05, "balanced"), (-0.05, "stable")])
def test_a_load_beside_the_centre_turns_round_and_jointed_parts_down(height, verdict):
    load = Load("pin", [0, 0, -100.0], point=[0, 0, 2 + height])
    assert pushed([bearing(), pin(0.1)], 0, loads=[load]).verdict == verdict
    axle = [Joint(("pin", "ground"), "revolute", point=[0, 0, 2], axis=[0, 1, 0])]
    for beside in ([], ramp()):
        assert pushed([pin(0.1), *beside], 0.5, axle, loads=[load]).verdict == verdict
    ball = Part("pin", Sphere(R), Pose([0, 0, R]))
    high = Load("pin", [0, 0, -100.0], point=[0, 0, R + height])
    assert pushed([ball], 0.5, loads=[high]).verdict == verdict


def test_a_slider_with_loads_keeps_its_height():
    rail = [Joint(("block", "ground"), "prismatic", point=[0, 0, 2], axis=[1, 0, 0])]
    block = Part("block", Box([1, 1, 1]), Pose([0, 0, 2]))
    load = Load("block", [0, 50.0, -100.0], point=[0.4, 0.4, 2.5])
    for beside in ([], ramp()):
        assert pushed([block, *beside], 0.5, rail, loads=[load]).verdict == "stable"


@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.0, 0.5])
def test_cones_lie_and_balls_sit_in_cones_and_on_rims(mu):
    """The apex of a lying cone has no curvature; a ball touches a cone and a rim along circles."""
    half = np.arctan(0.25)
    turn = (np.pi / 2 + half) / 2
    for tip in (0.0, 0.15):
        profile = [(0, 0), (0.5, 0), *([(tip, 2 - 4 * tip)] if tip else []), (0, 2 - 4 * tip)]
        lying = Pose([0, 0, 0.5 * np.cos(half)], [np.cos(turn), 0, np.sin(turn), 0])
        cone = Part("cone", turned_part("cone", profile).shape, lying)
        assert pushed([cone], mu).verdict == "stable"
    cup = turned_part("cup", [(0, 0), (3, 0), (3, 3), (1.5, 3), (0, 1)], grounded=True)
    ball = Part("ball", Sphere(R), Pose([0, 0, 1 + R * np.hypot(1.5, 2) / 1.5]))
    assert pushed([cup, ball], mu).verdict == "stable"
    ring = turned_part("ring", [(0.3, 0), (1, 0), (1, R), (0.3, R), (0.3, 0)], grounded=True)
    assert pushed([ring, Part("ball", Sphere(R), Pose([0, 0, R + 0.4]))], mu).verdict == "stable"


@pytest.mark.parametrize("gap", [0.0, 0.01])
def test_a_pin_that_lies_in_a_wider_hole_rolls_back(gap):
    """Rolled by phi, its axis rises by (r phi)^2 / 2 (R - r)."""
    assert pushed([bearing(), pin(0.1 - gap, (0, -0.25, 2 - gap))], 0.3).verdict == "stable"


@pytest.mark.quick(1)
@pytest.mark.parametrize(("off", "verdict"), [(-1e-4, "stable"), (1e-4, "balanced")])
@pytest.mark.parametrize("count", [1, 2])
def test_friction_holds_boxes_on_a_plank_on_a_held_roller(off, verdict, count):
    """All roll as one body if its centre is less than R above the roller, here at the height h."""
    places = [0.0] if count == 1 else [-0.3, 0.3]
    boxes = [Part(f"box{k}", Box([0.2] * 3), Pose([x, 0, 2.3])) for k, x in enumerate(places)]
    plank = Part("plank", Box([1, 1, 0.2]), Pose([0, 0, 2.1]))
    weights = np.array([0.2, *[0.008] * count])
    height = weights @ [0.1, *[0.3] * count] / weights.sum()
    radius = height * (1 - off)
    down = [
        Part(part.name, part.shape, Pose(np.add(part.pose.position, [0, 0, 2 * radius - 2])))
        for part in (plank, *boxes)
    ]
    assert pushed([roller(radius, held=True), *down], 0.5).verdict == verdict


@pytest.mark.slow
@pytest.mark.parametrize("beside", [True, False])
def test_a_part_decided_without_friction_stays_so_beside_friction(beside):
    """Exactly above an edge a box is balanced, and inside the edge it stands."""
    more = ramp() if beside else []
    shelf = Part("shelf", Box([4, 4, 1]), Pose([-2, 0, 4]), grounded=True)
    for place, verdict in ((0.0, "balanced"), (-1e-3, "stable")):
        box = Part("box", Box([1, 1, 1]), Pose([place, 0, 5]))
        found = kilter.check(Assembly([shelf, box, *more], friction=0.5))
        assert found.verdict == verdict
        assert kilter.verify(found.assembly, found.proof()).holds


@pytest.mark.slow
@pytest.mark.parametrize(("sense", "falls"), [(1, True), (-1, False)])
def test_a_plate_on_a_hinge_falls_beside_a_wall_that_presses_nothing(sense, falls):
    """The hinge can carry the force of the wall, so no friction there is certain."""
    wall = Part("wall", Box([2, 0.2, 2]), Pose([0, 0, 2]), grounded=True)
    plate = Part("plate", Box([0.2, 0.2, 1]), Pose([0, 0.2, 2 + 0.4 * sense]))
    hinge = [Joint(("plate", "wall"), "revolute", point=[0, 0.1, 2], axis=[0, 1, 0])]
    assert pushed([wall, plate, *ramp()], 0.5, hinge).stable != falls


@pytest.mark.slow
def test_parts_on_a_wedge_that_friction_holds_are_decided_as_on_level_ground():
    bowl = turned_part("bowl", [(0, 0), (3, 0), (3, 1.4), (2, 1.4), (0, 0.4, 0, 2.9)], [0, 0, 5])
    ball = Part("ball", Sphere(R), Pose([0, 0, 5.4 + R]))
    assert pushed([*wedge(), bowl, ball], 0.5).verdict == "stable"
    assert pushed([*wedge(), *balls(on=5)], 0.5).verdict == "balanced"
    hinge = [Joint(("rod", "wedge"), "revolute", point=[0, 0, 6], axis=[0, 1, 0])]
    for sense, verdict in ((1, "balanced"), (-1, "stable")):
        rod = Part("rod", Box([0.1, 0.1, 0.6]), Pose([0, 0, 6 + 0.4 * sense]))
        assert pushed([*wedge(), rod], 0.5, hinge).verdict == verdict


@pytest.mark.slow
def test_an_inverted_pendulum_falls_beside_a_block_that_friction_holds():
    hinge = Joint(("rod", "ground"), "revolute", point=[0, 0, 1], axis=[0, 1, 0])
    for sense, verdict in ((1, "balanced"), (-1, "stable")):
        rod = Part("rod", Box([0.1, 0.1, 0.8]), Pose([0, 0, 1 + 0.4 * sense]))
        found = pushed([*ramp(), rod], 0.5, [hinge])
        assert found.verdict == verdict
        assert ("makes rod fall" in found.sentence) == (sense > 0)


def test_a_wall_of_bricks_says_nothing_about_second_order():
    wall = [
        Part(
            f"b{row}-{k}",
            Box([0.4, 0.2, 0.2]),
            Pose([0.4 * k + 0.19 * (row % 2), 0, 0.1 + 0.2 * row]),
        )
        for row in range(10)
        for k in range(10)
    ]
    verdict = kilter.check(Assembly([TABLE, *wall], friction=0.6))
    assert verdict.verdict == "stable"
    assert "second order" not in str(verdict)
    assert "open" not in verdict.sentence


@pytest.mark.slow
def test_a_shaft_in_its_bore_and_a_roller_on_a_wall_do_not_bend():
    ring = [(0.1, 0), (0.5, 0), (0.5, 0.5), (0.1, 0.5), (0.1, 0)]
    block = turned_part("block", ring)
    log = Part("log", Cylinder(0.2, 1.0), Pose([3, 0, 0.2], rotation=ALONG_Y))
    pin = turned_part("pin", [(0, 0), (0.1, 0), (0.1, 0.9), (0, 0.9)])
    assembly = Assembly([TABLE, block, pin, log])
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    verdict = kilter.check(assembly, contacts=contacts)
    proof = verdict.judgement.forces
    assert proof is not None
    groups = RigidGroups.of(assembly)
    whole = groups.merged(program, assembly)
    assert not bending_bodies(assembly, contacts, whole, proof.forces, curves=True).bending.any()
    flat = np.ones(len(program.kind), dtype=bool)
    assert steady_parts(program, proof.forces, flat)[1]
