"""Loads, joints, and the limits, friction and springs of joints."""

import copy
import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from judged import judged, program_of

import kilter
from kilter import (
    Assembly,
    Box,
    FrictionPair,
    GivenContact,
    InputError,
    Joint,
    Load,
    Part,
    Pose,
    Tolerance,
    Verdict,
)
from kilter.analysis.decision.judge import judge
from kilter.mechanics.certificate import check_motion
from kilter.mechanics.proof import digest_of
from kilter.scenes import stacks, traps
from kilter.scenes.pieces import block, floor

G = 9.81
FLOOR = floor([-5, -5], [5, 5])
BOX = block("box", [-0.5, -0.5, 0], [0.5, 0.5, 1], mass=1.0)
SIDES = [1 - 1e-6, 1 + 1e-6]


def word(share):
    return "stable" if share < 1 else "unstable"


@pytest.mark.quick(3)
@pytest.mark.parametrize("share", SIDES)
@pytest.mark.parametrize("arm", [0.6, 1.0, 5.0])
def test_load_past_the_edge_topples_a_box(share, arm):
    # about the edge x = 0.5: weight m g at 0.5, load P at arm - 0.5 past it
    push = share * G * 0.5 / (arm - 0.5)
    assembly = Assembly([FLOOR, BOX], loads=[Load("box", [0, 0, -push], point=[arm, 0, 1])])
    assert judged(assembly).verdict == word(share)


@pytest.mark.parametrize("share", SIDES)
def test_torque_topples_a_box_at_its_weight_times_its_half_width(share):
    for torque in ([0, share * G / 2, 0], [-share * G / 2, 0, 0]):
        assembly = Assembly([FLOOR, BOX], loads=[Load("box", torque=torque)])
        assert judged(assembly).verdict == word(share)


@pytest.mark.parametrize("share", SIDES)
def test_torque_about_a_corner_topples_at_the_corner(share):
    # along the diagonal the half width is that of the corner projected on it
    torque = share * G / 2 * np.array([-1.0, 1.0, 0])
    assembly = Assembly([FLOOR, BOX], loads=[Load("box", torque=torque)])
    assert judged(assembly).verdict == word(share)


@pytest.mark.parametrize("share", SIDES)
def test_load_that_lifts(share):
    # straight up by more than its weight: it rises
    assembly = Assembly([FLOOR, BOX], loads=[Load("box", [0, 0, share * G])])
    assert judged(assembly).verdict == word(share)


@pytest.mark.slow
@pytest.mark.parametrize("share", SIDES)
@pytest.mark.parametrize("angle", [5.0, 30.0])
def test_load_that_holds_a_box_on_a_slope_against_a_stop(share, angle):
    # pushed uphill against nothing: only the exact force holds; with a stop uphill, any more
    slope = stacks.block_on_slope(angle)
    up = np.array([-np.cos(np.radians(angle)), 0, np.sin(np.radians(angle))])
    mass = float(slope.geometry.mass[1])
    size = mass * G * np.sin(np.radians(angle))
    middle = slope.geometry.center[1]
    exact = dataclasses.replace(slope, loads=[Load("block", up * size, point=middle)])
    assert judged(exact).verdict == "stable"
    off = dataclasses.replace(slope, loads=[Load("block", up * size * share, point=middle)])
    assert judged(off).verdict == "unstable"
    corners = slope.geometry.vertices[8:16]
    low = corners[corners @ up > (corners @ up).max() - 1e-9]
    stop = GivenContact(("slope", "block"), low, -up)
    normal = np.cross(up, [0, 1, 0])
    normal *= np.sign(normal[2])
    face = corners[corners @ normal < (corners @ normal).min() + 1e-9]
    rest = GivenContact(("slope", "block"), face, normal)
    held = dataclasses.replace(off, contacts=[rest, stop])
    assert judged(held).verdict == ("unstable" if share < 1 else "stable")


@pytest.mark.parametrize("share", SIDES)
def test_load_that_holds_a_floating_block_from_below_a_ceiling(share):
    ceiling = block("ceiling", [-2, -2, 1], [2, 2, 2], grounded=True)
    push = G / share
    assembly = Assembly([ceiling, BOX], loads=[Load("box", [0, 0, push])])
    assert judged(assembly).verdict == word(share)


def test_loads_on_one_part_add_up():
    one = Assembly([FLOOR, BOX], loads=[Load("box", [0, 0, -3.0], point=[2, 0, 1])])
    two = [Load("box", [0, 0, -1.0], point=[2, 0, 1])] * 3
    other = Assembly([FLOOR, BOX], loads=two)
    assert np.allclose(program_of(one).load, program_of(other).load)
    # in the middle: no point means the centre of mass
    free = Assembly([FLOOR, BOX], loads=[Load("box", [1, 2, 3])])
    at = Assembly([FLOOR, BOX], loads=[Load("box", [1, 2, 3], point=[0, 0, 0.5])])
    assert np.allclose(program_of(free).load, program_of(at).load)


def test_load_on_a_held_part_is_refused_by_name():
    loads = [Load("floor", [0, 0, 1e6])]
    with pytest.raises(InputError, match="part 'floor': a load acts on a held part"):
        Assembly([FLOOR, BOX], loads=loads)
    free = Assembly([FLOOR, BOX], loads=[Load("box", [0, 0, -1])])
    with pytest.raises(InputError, match="part 'box': a load acts on a held part"):
        free.with_grounded(["b*"])


# joints ---------------------------------------------------------------------------------


def lamp(**options):
    """A lamp 2 m beside the middle of a post 2 m wide."""
    post = block("post", [-1, -1, 0], [1, 1, 4], mass=options.pop("post", 10.0))
    shade = block("lamp", [2.5, -0.5, 3], [3.5, 0.5, 4], mass=options.pop("shade", 1.0))
    return Assembly([FLOOR, post, shade], **options)


@pytest.mark.slow
def test_part_in_the_air_falls_and_joined_to_a_standing_one_does_not():
    assert judged(lamp()).verdict == "unstable"
    assert judged(lamp(joints=[Joint(("post", "lamp"))])).verdict == "stable"
    assert judged(lamp(joints=[Joint(("lamp", "post"), point=[9, 9, 9])])).verdict == "stable"
    assert judged(lamp(joints=[Joint(("ground", "lamp"))])).verdict == "stable"
    assert judged(lamp(joints=[Joint(("lamp", "ground"))])).verdict == "stable"
    assert judged(lamp(joints=[Joint(("lamp", "floor"))])).verdict == "stable"


@pytest.mark.quick(1)
@pytest.mark.parametrize("share", SIDES)
@pytest.mark.parametrize("planar", [True, False])
def test_joined_parts_topple_as_one_body(share, planar):
    # about x = 1: post 10 at 0, lamp at 3: 10 * 1 = m * 2
    assembly = lamp(shade=5.0 * share, joints=[Joint(("post", "lamp"))], planar=planar)
    assert judged(assembly).verdict == word(share)


def test_joint_carries_force_and_torque_about_its_point():
    assembly = lamp(joints=[Joint(("post", "lamp"), point=[1.0, 0.0, 3.5])])
    proof = judged(assembly).proof()
    wrench = np.array(proof["joints"][0]["wrench"])
    # on the lamp: its weight, and the torque of 2 m of it about the point
    assert np.allclose(wrench, [0, 0, G, 0, -2.0 * G, 0], atol=1e-9)


def test_joint_to_the_ground_holds_without_any_held_part():
    assembly = Assembly([BOX], joints=[Joint(("ground", "box"))])
    verdict = judged(assembly)
    assert verdict.verdict == "stable"
    wrench = np.array(verdict.proof()["joints"][0]["wrench"])
    assert np.allclose(wrench, [0, 0, G, 0, 0, 0], atol=1e-9)


def test_chain_of_joints_holds_as_long_as_its_first_link():
    links = [block(f"link-{k}", [2.0 * k, 0, 0], [2.0 * k + 1, 1, 1]) for k in range(6)]
    joints = [Joint((f"link-{k}", f"link-{k + 1}")) for k in range(5)]
    held = Joint(("ground", "link-0"))
    assert judged(Assembly(links, joints=[held, *joints])).verdict == "stable"
    verdict = judged(Assembly(links, joints=[held, *joints[:2], *joints[3:]]))
    assert verdict.verdict == "unstable"
    assert verdict.moving == ["link-3", "link-4", "link-5"]
    assert np.allclose(verdict.motion.acceleration[3:, 2], -G, atol=1e-9)
    assert verdict.neutral is not None


def test_joined_parts_fall_as_one():
    verdict = judged(lamp(shade=50.0, joints=[Joint(("post", "lamp"))]))
    a = verdict.motion.acceleration
    assert np.allclose(a[1, 3:], a[2, 3:], atol=1e-9)
    shift = np.cross(a[1, 3:], verdict.program.center[2] - verdict.program.center[1])
    assert np.allclose(a[2, :3], a[1, :3] + shift, atol=1e-8)


def test_motion_that_breaks_a_joint_is_no_proof():
    program = program_of(lamp(joints=[Joint(("post", "lamp"))]))
    motion = np.zeros((3, 6))
    motion[2, 2] = -1.0
    turning = np.zeros((3, 6))
    turning[2, 4] = 1.0
    for way in (motion, turning, -turning, motion + turning):
        assert not check_motion(program, way).holds


# contacts that are given ----------------------------------------------------------------


def feet(points, **options):
    return GivenContact(("floor", "box"), points, [0, 0, 1], **options)


def test_given_contacts_are_used_instead_of_detection():
    assert judged(Assembly([FLOOR, BOX])).verdict == "stable"
    # all three feet to the left of the centre: it tips, though the faces touch
    left = [[-0.5, -0.5, 0], [-0.1, -0.5, 0], [-0.2, 0.5, 0]]
    verdict = judged(Assembly([FLOOR, BOX], contacts=[feet(left)]))
    assert verdict.verdict == "unstable"
    assert verdict.contact_set.patch_kind.tolist() == ["given"]
    assert len(verdict.contact_set.points) == 3
    right = [[-0.5, -0.5, 0], [0.5, -0.5, 0], [0, 0.5, 0]]
    assert judged(Assembly([FLOOR, BOX], contacts=[feet(right)])).verdict == "stable"


@pytest.mark.parametrize("past", [-1e-6, 1e-6])
def test_given_triangle_carries_to_its_edge(past):
    tip = [[past, -0.5, 0], [past, 0.5, 0], [-0.5, 0, 0]]
    verdict = judged(Assembly([FLOOR, BOX], contacts=[feet(tip)]))
    assert verdict.verdict == ("stable" if past > 0 else "unstable")


def test_given_contact_the_other_way_round_is_the_same():
    points = [[-0.5, -0.5, 0], [0.5, -0.5, 0], [0, 0.5, 0]]
    turned = GivenContact(("box", "floor"), points, [0, 0, -1])
    assert judged(Assembly([FLOOR, BOX], contacts=[turned])).verdict == "stable"
    wrong = GivenContact(("box", "floor"), points, [0, 0, 1])
    assert judged(Assembly([FLOOR, BOX], contacts=[wrong])).verdict == "unstable"


def test_without_detection_only_given_contacts_count():
    assembly = dataclasses.replace(stacks.tower(2), detect=False)
    verdict = judged(assembly)
    assert verdict.verdict == "unstable"
    assert len(verdict.contact_set) == 0
    points = [[-0.5, -0.5, 0], [0.5, -0.5, 0], [0, 0.5, 0]]
    lower = GivenContact(("base", "cube-1"), points, [0, 0, 1])
    one = judged(dataclasses.replace(assembly, contacts=[lower]))
    assert one.moving == ["cube-2"]
    upper = GivenContact(("cube-1", "cube-2"), np.add(points, [0, 0, 1]), [0, 0, 1])
    assert judged(dataclasses.replace(assembly, contacts=[lower, upper])).verdict == "stable"


# friction pairs -------------------------------------------------------------------------


@pytest.mark.slow
def test_friction_is_the_contacts_own_else_the_pairs_else_the_assemblys():
    # tan 20 degrees is .364
    slope = stacks.block_on_slope(20.0, friction=0.4)
    pair = FrictionPair(("block", "slope"), 0.3)
    assert judged(slope).verdict == "stable"
    assert judged(dataclasses.replace(slope, friction_pairs=[pair])).verdict == "unstable"
    rough = FrictionPair(("slope", "block"), 0.4)
    smooth = dataclasses.replace(slope, friction=0.0)
    assert judged(smooth).verdict == "unstable"
    assert judged(dataclasses.replace(smooth, friction_pairs=[rough])).verdict == "stable"
    points = judged(slope).contact_set.points
    normal = judged(slope).contact_set.patch_normal[0]
    parts = [slope.names[k] for k in judged(slope).contact_set.patch_parts[0]]
    for mu, answer in ((0.0, "unstable"), (0.36, "unstable"), (0.37, "stable")):
        own = GivenContact(tuple(parts), points, normal, mu=mu)
        case = dataclasses.replace(slope, contacts=[own], friction_pairs=[rough])
        assert judged(case).verdict == answer


def test_friction_elsewhere_does_not_hold_what_slides_on_ice():
    # the block slides on ice; another stands on rough ground: friction there changes nothing
    slope = stacks.block_on_slope(20.0)
    post = block("post", [-0.5, 3, 5], [0.5, 4, 6])
    terrace = block("terrace", [-1, 2.5, 4], [1, 4.5, 5], grounded=True)
    parts = [*slope.parts, terrace, post]
    pair = [FrictionPair(("terrace", "post"), 0.5)]
    verdict = judged(dataclasses.replace(slope, parts=parts, friction_pairs=pair))
    assert verdict.verdict == "unstable"
    assert verdict.moving == ["block"]


def test_floating_block_is_unstable_whatever_the_friction():
    assert judged(traps.floating_block().with_friction(0.9)).verdict == "unstable"


def test_judgement_says_what_was_run():
    judgement = judge(program_of(stacks.tower(2)))
    assert judgement.solvers
    assert judgement.solvers[0].startswith("load factor: simplex")


WEIGHT = 2.0 * G
SLOPE = math.radians(10.0)
DOWNHILL = WEIGHT * math.sin(SLOPE)
"""Weight of the drawer along its rails [N]."""
MOMENT = WEIGHT * 0.5
"""Torque of the level rod about its hinge [N m]."""


def drawer(**guide: Any) -> Assembly:
    """A drawer of 2 kg on rails that fall by 10 degrees along their axis."""
    along = [math.cos(SLOPE), 0, -math.sin(SLOPE)]
    box = Part("drawer", Box([0.4, 0.4, 0.1]), mass=2.0)
    return Assembly([box], joints=[Joint(("drawer", "ground"), "prismatic", axis=along, **guide)],
                    units="m")  # fmt: skip


def rod(degrees: float, *, swapped: bool = False, **guide: Any) -> Assembly:
    """A rod of 1 m and 2 kg on a hinge about y at its lower end, leant from the vertical."""
    lean = math.radians(degrees)
    middle = [0.5 * math.sin(lean), 0, 0.5 * math.cos(lean)]
    pose = Pose(middle, [0, math.sin(lean / 2), 0, math.cos(lean / 2)])
    ends = ("ground", "rod") if swapped else ("rod", "ground")
    hinge = Joint(ends, "revolute", point=[0, 0, 0], axis=[0, 1, 0], **guide)
    return Assembly([Part("rod", Box([0.1, 0.1, 1.0]), pose, mass=2.0)], joints=[hinge], units="m")


def judged_guides(assembly: Assembly) -> Verdict:
    """The verdict, after its proof was recomputed at the level that it claims."""
    verdict = kilter.check(assembly)
    result = kilter.verify(assembly, verdict.proof())
    assert result.holds, result.reasons
    return verdict


def leaning(degrees: float) -> float:
    """Torque of a leaning rod about its hinge, towards a greater lean [N m]."""
    return MOMENT * math.sin(math.radians(degrees))


NEAR = 1e-6
"""Distance of both sides of a limit [-]."""
CASES = {
    "drawer without a stop": (drawer(), "unstable"),
    "drawer at its front stop": (drawer(limits=[-0.3, 0]), "stable"),
    "drawer at its back stop": (drawer(limits=[0, 0.3]), "unstable"),
    "drawer between its stops": (drawer(limits=[-0.1, 0.3]), "unstable"),
    "drawer locked between both stops": (drawer(limits=[0, 0]), "stable"),
    "drawer above its friction": (drawer(friction=DOWNHILL * (1 - NEAR)), "unstable"),
    "drawer below its friction": (drawer(friction=DOWNHILL * (1 + 2 * NEAR)), "stable"),
    "drawer on a spring": (drawer(stiffness=50.0, rest=-DOWNHILL / 50), "stable"),
    "drawer on a loose spring": (drawer(stiffness=50.0, rest=-DOWNHILL / 51), "unstable"),
    "spring and friction are enough": (
        drawer(stiffness=50.0, rest=-0.9 * DOWNHILL / 50, friction=0.101 * DOWNHILL), "stable"),
    "spring and friction are not enough": (
        drawer(stiffness=50.0, rest=-0.9 * DOWNHILL / 50, friction=0.099 * DOWNHILL), "unstable"),
    "spring pulls from the stop": (
        drawer(limits=[-0.3, 0], stiffness=50.0, rest=-1.01 * DOWNHILL / 50), "unstable"),
    "spring pulls less than the weight": (
        drawer(limits=[-0.3, 0], stiffness=50.0, rest=-0.99 * DOWNHILL / 50), "stable"),
    "stop and friction": (drawer(limits=[-0.3, 0], friction=0.5 * DOWNHILL), "stable"),
    "lid at the end of its hinge": (rod(100, limits=[-1.7, 0]), "stable"),
    "lid short of the end of its hinge": (rod(100, limits=[-1.7, 0.1]), "unstable"),
    "hinge of the other sense": (rod(100, swapped=True, limits=[0, 1.7]), "stable"),
    "knee loaded into its stop": (rod(-20, limits=[0, 2]), "stable"),
    "knee loaded out of its stop": (rod(20, limits=[0, 2]), "unstable"),
    "upright rod on its stop": (rod(0, limits=[0, 1]), "balanced"),
    "upright rod locked": (rod(0, limits=[0, 0]), "stable"),
    "upright rod with friction": (rod(0, friction=1e-3), "stable"),
    "hinge above its friction": (rod(30, friction=leaning(30) * (1 - NEAR)), "unstable"),
    "hinge below its friction": (rod(30, friction=leaning(30) * (1 + 1e-5)), "stable"),
    "inverted pendulum on a stiff spring": (rod(0, stiffness=MOMENT * 1.001), "stable"),
    "inverted pendulum on a soft spring": (rod(0, stiffness=MOMENT * 0.999), "balanced"),
    "inverted pendulum at the limit": (rod(0, stiffness=MOMENT), "potentially-stable"),
    "hanging rod": (rod(180, stiffness=0.1), "stable"),
    "soft spring and friction": (rod(0, stiffness=MOMENT * 0.9, friction=0.1), "stable"),
}  # fmt: skip


@pytest.mark.quick(12)
@pytest.mark.parametrize("name", CASES)
def test_a_joint_holds_exactly_within_its_limits_friction_and_spring(name):
    assembly, word = CASES[name]
    verdict = judged_guides(assembly)
    assert verdict.verdict == word
    assert (verdict.level == "proved") == (word == "stable")


@pytest.mark.parametrize("degrees", [25.0, 100.0])
def test_a_leaning_rod_on_a_spring_is_a_minimum_if_the_stiffness_exceeds_that_of_gravity(degrees):
    """V = k (q - rest)^2 / 2 + M cos(lean): V'' = k - M cos(lean)."""
    needed = MOMENT * math.cos(math.radians(degrees))
    for share, word in ((1.01, "stable"), (0.99, "balanced")):
        stiffness = share * needed if needed > 0 else 0.01
        spring = {"stiffness": stiffness, "rest": -leaning(degrees) / stiffness}
        assert judged_guides(rod(degrees, **spring)).verdict == (word if needed > 0 else "stable")


def test_two_links_on_springs_are_a_minimum_exactly_if_their_stiffness_matrix_is_positive():
    """Two upright rods of weight W and length l: K = [[k1 - 2 W l, ...]] in absolute angles.

    V = k1 a^2 / 2 + k2 (b - a)^2 / 2 + W l (3 cos a + cos b) / 2, so K = [[k1 + k2 - 3 W l / 2,
    -k2], [-k2, k2 - W l / 2]].
    """
    wl = WEIGHT * 1.0
    for first, second in ((2.0, 2.0), (3.0, 2.0), (2.4, 1.2), (4.0, 1.0)):
        k1, k2 = first * wl, second * wl
        matrix = np.array([[k1 + k2 - 1.5 * wl, -k2], [-k2, k2 - 0.5 * wl]])
        least = float(np.linalg.eigvalsh(matrix)[0])
        assert abs(least) > 0.01 * wl
        rods = [Part(name, Box([0.1, 0.1, 1.0]), Pose([0, y, z]), mass=2.0)
                for name, y, z in (("lower", 0, 0.5), ("upper", 0.3, 1.5))]  # fmt: skip
        hinges = [
            Joint(("lower", "ground"), "revolute", [0, 0, 0], [0, 1, 0], stiffness=k1),
            Joint(("upper", "lower"), "revolute", [0, 0, 1], [0, 1, 0], stiffness=k2),
        ]
        assembly = Assembly(rods, joints=hinges, units="m")
        assert judged_guides(assembly).verdict == ("stable" if least > 0 else "balanced")


def test_the_answer_states_the_forces_of_stop_friction_and_spring():
    guide = {"limits": [-0.3, 0], "friction": 0.5, "stiffness": 50.0, "rest": 0.01}
    answer = judged_guides(drawer(**guide)).to_dict()
    (joint,) = answer["forces"]["joints"]
    assert joint["spring"] == pytest.approx(0.5)
    assert joint["stop"] < 0
    assert abs(joint["friction"]) <= 0.5
    total = joint["stop"] + joint["friction"] + joint["spring"]
    assert total == pytest.approx(-DOWNHILL)
    assert answer["joints"][0]["limits"] == [-0.3, 0]
    (other,) = judged_guides(rod(-20, limits=[0, 2])).to_dict()["forces"]["joints"]
    assert other["stop"] == pytest.approx(MOMENT * math.sin(math.radians(20)))


@pytest.mark.parametrize(
    ("guide", "shift"),
    [
        ({"limits": [-0.3, 0]}, -2.5 * DOWNHILL),
        ({"friction": 1.5 * DOWNHILL}, -3 * DOWNHILL),
        ({"friction": 1.5 * DOWNHILL}, 3 * DOWNHILL),
        ({"stiffness": 50.0, "rest": -DOWNHILL / 50}, 1.0),
    ],
)
def test_a_proof_with_a_force_beyond_the_joint_is_refused(guide, shift):
    assembly = drawer(**guide)
    proof = copy.deepcopy(kilter.check(assembly).proof())
    axis = assembly.joints[0].axis
    wrench = np.array(proof["joints"][0]["wrench"])
    wrench[:3] += shift * axis
    proof["joints"][0]["wrench"] = wrench.tolist()
    proof["digest"] = digest_of(proof)
    result = kilter.verify(assembly, proof)
    assert not result.holds


@pytest.mark.parametrize("key", ["limits", "friction", "stiffness", "rest"])
def test_a_proof_of_a_joint_with_other_numbers_is_refused(key):
    guide = {"limits": (-0.3, 0.0), "friction": 0.5, "stiffness": 50.0, "rest": 0.01}
    assembly = drawer(**guide)
    proof = kilter.check(assembly).proof()
    other = {"limits": (-0.4, 0.0)}.get(key, 0.02)
    joint = dataclasses.replace(assembly.joints[0], **{key: other})
    changed = dataclasses.replace(assembly, joints=[joint])
    assert "its joints differ from those of the file" in kilter.verify(changed, proof).reasons


def test_second_order_does_not_count_friction_at_its_limit():
    """At the limit a small push makes the drawer slide on, so the level is below proved."""
    verdict = judged_guides(drawer(friction=DOWNHILL))
    assert verdict.verdict in ("potentially-stable", "undecided")


@pytest.mark.parametrize(
    ("assembly", "distance"),
    [
        (drawer(limits=[-0.3, -1e-3]), "0.001 m"),
        (rod(100, limits=[-1.7, -1e-3]), "0.001 rad"),
    ],
)
def test_a_joint_beyond_its_limits_has_no_stop_and_a_note(assembly, distance):
    """The gap of the note is the least, to its digits, that counts the stop."""
    verdict = judged_guides(assembly)
    assert verdict.verdict == "unstable"
    (note,) = [words for words in verdict.warnings if f"drawn {distance} beyond" in words]
    gap = float(note.split("--gap ")[1].split()[0])
    for share, word in ((1.0, "stable"), (0.98, "unstable")):
        again = kilter.check(assembly, tolerance=Tolerance(gap=share * gap))
        assert again.verdict == word


def test_the_stop_counts_within_the_tolerance_of_gaps():
    """A turn counts by the radius of the rod."""
    box, lean = drawer(), rod(100)
    slack = Tolerance().relative_gap * box.geometry.size[0]
    turn = Tolerance().relative_gap * lean.geometry.size[0] / lean.geometry.radius[0]
    for share, word in ((0.99, "stable"), (1.01, "unstable")):
        assert judged_guides(drawer(limits=[-0.3, share * slack])).verdict == word
        assert judged_guides(rod(100, limits=[-1.7, share * turn])).verdict == word


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"limits": [1, 0]}, "limits of the prismatic joint of 'drawer' and 'ground' are 1 and 0"),
        ({"limits": [0, math.inf]}, "limits of the prismatic joint"),
        ({"limits": [0, 1, 2]}, "limits of the prismatic joint"),
        ({"friction": -1}, "friction of the prismatic joint"),
        ({"stiffness": math.nan}, "stiffness of the prismatic joint"),
        ({"rest": "low"}, "rest of the prismatic joint"),
    ],
)
def test_wrong_limits_friction_and_springs_are_refused(given, words):
    with pytest.raises(InputError, match=words):
        drawer(**given)
    with pytest.raises(InputError, match="the spherical joint of 'a' and 'b' has friction"):
        Joint(("a", "b"), "spherical", point=[0, 0, 0], friction=1.0)


def forged(assembly: Assembly, other: Assembly, **second: Any) -> str:
    """The first reason against the proof of `other` as a proof about `assembly`; empty if valid."""
    proof = copy.deepcopy(kilter.check(other).proof())
    for entry, joint in zip(proof["joints"], assembly.joints, strict=True):
        entry.update(joint.guide)
    proof["second_order"].update(second)
    proof["digest"] = digest_of(proof)
    return "; ".join(kilter.verify(assembly, proof).reasons)


def test_a_forged_second_order_of_springs_and_friction_is_refused():
    soft, stiff = (rod(0, stiffness=share * MOMENT) for share in (0.99, 1.01))
    assert forged(stiff, stiff) == ""
    assert "the energy does not curve upward" in forged(soft, stiff)
    rough, limp = (drawer(friction=share * DOWNHILL) for share in (1.5, 1 + 1e-9))
    assert forged(rough, rough) == ""
    assert "the friction of a joint is at its limit" in forged(limp, rough)
    assert "joints may not be left out" in forged(stiff, stiff, idle=[0])
