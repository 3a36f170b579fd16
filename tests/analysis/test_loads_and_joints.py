"""Loads, fixed joints, given contacts and friction pairs."""

import dataclasses

import numpy as np
import pytest
from judged import judged, program_of
from transformations import scaled

from kilter import InputError
from kilter.analysis.decision.judge import judge
from kilter.assembly import Assembly, FrictionPair, GivenContact, Joint, Load
from kilter.mechanics.certificate import check_motion
from kilter.scenes import stacks, traps
from kilter.scenes.pieces import block, floor, turn
from kilter.scenes.transform import moved

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


@pytest.mark.slow
def test_loads_scale_and_turn_with_their_assembly():
    for share in SIDES:
        push = share * G * 0.5 / 0.5
        assembly = Assembly([FLOOR, BOX], loads=[Load("box", [0, 0, -push], point=[1, 0, 1])])
        for changed in (scaled(assembly, 1e-2), moved(assembly, turn([1, 2, 3], 50), [4, 5, 6])):
            assert judged(changed).verdict == word(share)


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
    points = judged(slope).contacts.points
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
