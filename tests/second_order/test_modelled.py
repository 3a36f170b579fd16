"""Contacts that second order models: rims of flat faces, and no open pairs."""

import copy
from dataclasses import replace

import numpy as np
import pytest
from balance_cases import CASES

import kilter
from kilter import Assembly, Bond, Box, Cylinder, Joint, Load, Mesh, Part, Pose, Sphere
from kilter.mechanics.program import build_program
from kilter.mechanics.proof import digest_of
from kilter.second_order.proofs.second_order_recheck import (
    OFF_CENTRE,
    loads_off_centre,
    unmodelled_pairs,
    why_beyond,
    why_unmodelled,
)
from kilter.second_order.second_order_tolerances import KEEPS
from kilter.shape.primitives import surface

TABLE = Part("table", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
CAN = Part("can", Cylinder(0.5, 1.0), Pose([0, 0, 0.5]))
BLOCK = Assembly([TABLE, Part("block", Box([1, 1, 1]), Pose([0, 0, 0.5]))])
PILE = Assembly([*BLOCK.parts, Part("high", Box([1, 1, 1]), Pose([0, 0, 1.5]))])
LOW = Part("low", Sphere(0.5), Pose([0, 0, 0.5]), grounded=True)
BALLS = Assembly([LOW, Part("block", Sphere(0.5), Pose([0, 0, 1.5]))])
DOWN, RIGHT = np.array([0, 0, -1000.0]), np.array([1000.0, 0, 0])
POLE = Joint(("ground", "block"), "cylindrical", point=[0, 0, 0.5], axis=[0, 0, 1])
SQUEEZE = [
    Load("block", RIGHT, point=[-0.5, 0, 0.5]),
    Load("block", -RIGHT, point=[0.5, 0, 0.5]),
]


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("more", "neutral"),
    [
        ([], 3),
        ([Part("plate", Box([3, 3, 0.2]), Pose([0.2, 0, 1.1]))], 6),
        ([Part("can on can", Cylinder(0.3, 1.0), Pose([0.1, 0, 1.5]))], 6),
        ([Part("ball", Sphere(0.5), Pose([0.2, 0, 1.5]))], 8),
    ],
)
def test_what_stands_on_a_round_face_is_free(more, neutral):
    assembly = Assembly([TABLE, CAN, *more])
    assert len(kilter.contacts(assembly).possible)  # corners around the rim
    found = kilter.check(assembly)
    second = found.second_order_answer
    assert second is not None
    assert (second.state, second.neutral, second.free) == ("free", neutral, neutral)
    assert kilter.verify(assembly, found.proof()).holds


def unmodelled(assembly: Assembly, contacts: kilter.ContactSet) -> str:
    return why_unmodelled(assembly, unmodelled_pairs(assembly, contacts))


def test_a_ball_on_a_can_on_a_ball_is_balanced():
    ball = Part("ball", Sphere(0.5), Pose([0, 0, 0.5]))
    can = Part("can", Cylinder(0.5, 1.0), Pose([0, 0, 1.5]))
    found = kilter.check(Assembly([TABLE, ball, can]))
    assert found.second_order_answer is not None
    assert found.second_order_answer.state == "balanced"


def test_of_pairs_that_are_left_open_nothing_is_said_or_proved():
    assembly = Assembly([TABLE, CAN])
    proof = kilter.check(assembly).proof()
    near = Part("near", Box([1, 1, 1]), Pose([1.0 + 2e-4, 0, 0.5]), grounded=True)
    more = Assembly([TABLE, CAN, near])
    contacts = kilter.contacts(more)
    assert contacts.open_pairs
    assert "is open" in unmodelled(more, contacts)
    found = kilter.check(more)
    assert found.second_order_answer is not None
    assert found.second_order_answer.state == "open"
    own = copy.deepcopy(found.proof())
    own["second_order"] = proof["second_order"]
    own["digest"] = digest_of(own)
    refused = kilter.verify(more, own)
    assert not refused.holds
    assert any("is open" in reason for reason in refused.reasons)


def test_what_is_possible_out_of_the_plane_of_a_face_is_not_its_rim():
    ball = Part("ball", Sphere(0.5), Pose([3, 0, 0.5]))
    contacts = kilter.contacts(Assembly([TABLE, CAN, ball]))
    assert unmodelled(contacts.assembly, contacts) == ""
    possible = contacts.possible
    for name, value in (
        ("points", possible.points + 0.01),
        ("normals", np.tile([0.6, 0, 0.8], (len(possible), 1))),
        ("two_sided", ~possible.two_sided),
        ("part_b", possible.part_b + 1),
    ):
        fields = {key: getattr(possible, key) for key in possible.__slots__}
        other = type(possible)(**{**fields, name: value})
        assert "not modelled" in unmodelled(contacts.assembly, contacts_with(contacts, other)), name


def test_each_face_of_a_pair_has_its_own_rim():
    """A can that touches the same part above and below, and another can."""
    corners, faces = surface(Box([2, 2, 1]))
    both = np.vstack([corners, corners + 2 * np.eye(3)[2]])
    frame = Part("frame", Mesh(both, np.vstack([faces, faces + 8])), Pose([9, 0, 2.5]), True)
    held = Part("held", Cylinder(0.5, 1.0), Pose([9, 0, 3.5]))
    assembly = Assembly([TABLE, CAN, frame, held])
    contacts = kilter.contacts(assembly)
    assert (contacts.patch_kind == "plane").sum() == 3
    assert unmodelled(assembly, contacts) == ""


def test_pairs_left_open_for_another_reason_than_their_edges_are_not_known():
    boxes = [Part(f"at {x}", Box([1, 1, 1]), Pose([x, x, 0.5])) for x in (-0.5, 0.5)]
    assembly = Assembly([TABLE, *boxes])
    contacts = kilter.contacts(assembly)
    assert [pair.kind for pair in contacts.open_pairs] == ["degenerate"]
    assert unmodelled(assembly, contacts) == ""
    unknown = replace(contacts, open_pairs=[replace(contacts.open_pairs[0], kind="curved")])
    none = replace(contacts, possible=contacts.possible.take(np.zeros(0, dtype=np.int64)))
    for changed in (unknown, none):
        assert "is open" in unmodelled(assembly, changed)


def refused(assembly: Assembly, of: Assembly, state: str = "open") -> tuple[str, ...]:
    """The reasons against the proof of an assembly for another, which has no proof of its own."""
    verdict = kilter.check(assembly)
    second, proof = verdict.second_order_answer, verdict.proof()
    assert second is not None
    assert (second.state, proof["second_order"]) == (state, None)
    data = copy.deepcopy(kilter.check(of).proof()["second_order"])
    if "level" in data:  # with forces that balance the loads, and a way past what else there is
        data["level"] = [force[2] for force in proof["forces"]]
        data["motion"]["block"] = [0.7, -0.7, 0, 0, 0, 0]
    proof["second_order"] = data
    proof["digest"] = digest_of(proof)
    return kilter.verify(assembly, proof).reasons


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("plain", "more", "why"),
    [
        (BALLS, {"bonds": [Bond(("low", "block"), pull=0.0, shear=50.0)]}, "bonds"),
        (BALLS, {"bonds": [Bond(("low", "block"), pull=9.0, kind="mortar")]}, "bonds"),
        (BLOCK, {"loads": [Load("block", DOWN / 200, point=[0.2, 0, 1])]}, OFF_CENTRE),
        (BLOCK, {"loads": [Load("block", DOWN / 200, point=[0, 0.2, 1])]}, OFF_CENTRE),
        (BLOCK, {"loads": SQUEEZE}, OFF_CENTRE),
        (PILE, {"loads": SQUEEZE}, OFF_CENTRE),
    ],
)
def test_of_bonds_and_loads_nothing_is_said_or_proved(plain, more, why):
    assert any(why in one for one in refused(replace(plain, **more), plain))


def test_a_rest_on_level_faces_is_no_proof_beside_a_joint():
    poled = replace(BLOCK, joints=[POLE])
    proof = kilter.check(poled).proof()
    data = copy.deepcopy(kilter.check(BLOCK).proof()["second_order"])
    data["level"] = [force[2] for force in proof["forces"]] + [0.0] * 4
    data["motion"]["block"] = [0.7, -0.7, 0, 0, 0, 0]
    proof["second_order"] = data
    proof["digest"] = digest_of(proof)
    assert "its second order: it does not model joints" in kilter.verify(poled, proof).reasons


def test_a_weight_above_the_centre_may_tip_what_is_a_minimum_without_it():
    """The ball in a bowl turns about its centre, and so its load comes down."""
    bowl = next(case for case in CASES if case.number == "03").build(0.0)
    center = bowl.geometry.center[1]
    above = replace(bowl, loads=[Load("b", DOWN, point=center + DOWN / -1e4)])
    assert any(OFF_CENTRE in one for one in refused(above, bowl, "balanced"))
    through = kilter.check(replace(bowl, loads=[Load("b", DOWN, point=center)]))
    assert through.second_order_answer is not None
    assert through.second_order_answer.state == "minimum"
    assert kilter.verify(through.assembly, through.proof()).holds


@pytest.mark.slow
def test_a_load_on_the_mast_of_a_weeble_is_above_the_centre_of_both():
    ball = Part("ball", Sphere(0.5), Pose([0, 0, 0.5]), mass=10.0)
    low = Part("low", Box([0.1] * 3), Pose([0, 0, 0.4]), mass=3.0)
    mast = Part("mast", Cylinder(0.1, 1.0), Pose([0, 0, 1.5]), mass=0.01)
    tied = [Joint(("ball", one), "fixed") for one in ("low", "mast")]
    weeble = Assembly([TABLE, ball, low, mast], joints=tied)
    assert refused(replace(weeble, loads=[Load("mast", DOWN)]), weeble, "balanced")
    second = kilter.check(weeble).second_order_answer
    assert second is not None
    assert second.state == "free"


def test_a_weight_on_top_of_what_stands_on_a_level_face_leaves_it_free():
    found = kilter.check(replace(BLOCK, loads=[Load("block", DOWN, point=[0, 0, 1])]))
    assert found.second_order_answer is not None
    assert found.second_order_answer.state == "free"
    assert kilter.verify(found.assembly, found.proof()).holds


@pytest.mark.parametrize("over", [0.9, 1.1])
def test_a_load_is_off_the_centre_or_the_vertical_by_more_than_rounding(over):
    radius = BLOCK.geometry.radius[1]
    for arm, force, given in (
        ([0, 0, over * KEEPS * radius], DOWN, (over > 1, False)),
        ([0, 0, 0.1], DOWN + over * KEEPS * RIGHT, (True, over > 1)),
        ([0, 0, 0.1], 0 * DOWN, (False, False)),
    ):
        load = Load("block", force, point=BLOCK.geometry.center[1] + arm)
        assembly = replace(BLOCK, loads=[load, Load("block", DOWN)])
        program = build_program(assembly, kilter.contacts(assembly))
        off, slanted = loads_off_centre(assembly, program)
        assert [one.tolist() for one in (off, slanted)] == [[False, one] for one in given]


def test_a_load_at_the_limit_is_at_the_centre_and_vertical():
    floor = Part("floor", Box([4, 4, 1]), Pose([0, 0, -1]), grounded=True)
    block = Part("block", Box([1, 1, 1]), Pose([0, 0, 0]))
    plain = Assembly([floor, block])
    most = KEEPS * plain.geometry.radius[1]
    for more, off, slanted in ((1.0, False, False), (2.0, True, False)):
        down = Load("block", [0, 0, -1.0], point=[0, 0, more * most])
        assembly = replace(plain, loads=[down])
        program = build_program(assembly, kilter.contacts(assembly)).frictionless
        assert why_beyond(program, assembly) == ""
        found = loads_off_centre(assembly, program)
        assert [bool(one[1]) for one in found] == [off, slanted]
    for aside, slanted in ((KEEPS, False), (2 * KEEPS, True)):
        assembly = replace(plain, loads=[Load("block", [aside, 0, -1.0], point=[0, 0, 0.1])])
        program = build_program(assembly, kilter.contacts(assembly)).frictionless
        assert bool(loads_off_centre(assembly, program)[1][1]) == slanted


def contacts_with(contacts: kilter.ContactSet, possible: object) -> kilter.ContactSet:
    return replace(contacts, possible=possible)
