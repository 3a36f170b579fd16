"""Joints against statics and dynamics by hand: what they hold, what they leave free."""

import copy
import dataclasses

import numpy as np
import pytest
from independent import dense_rows
from judged import judged, program_of, reloaded, verified
from transformations import tilted

import kilter
from kilter import InputError
from kilter.analysis.turning.orientation import orient
from kilter.assembly import Assembly, Joint, Load
from kilter.mechanics.proof import digest_of
from kilter.rigid import unit
from kilter.scenes.pieces import block

G = 9.81
KINDS = {"fixed": 0, "revolute": 1, "prismatic": 1, "cylindrical": 2, "spherical": 3}
EACH = pytest.mark.parametrize("kind", KINDS)
Y = [0, 1, 0]
OFF = 1e-6


def joint(kind, parts=("ground", "box"), point=(0, 0, 0), axis=(0, 1, 0)):
    """A joint with no more than its kind needs."""
    needs = {"fixed": (), "prismatic": ("axis",), "spherical": ("point",)}
    given = {"point": point, "axis": axis}
    return Joint(parts, kind, **{key: given[key] for key in needs.get(kind, given)})


def box(low, high, name="box", **options):
    return block(name, low, high, **{"mass": 1.0, **options})


# what each kind leaves free ---------------------------------------------------------------


@pytest.mark.quick(5)
@EACH
@pytest.mark.parametrize("other", ["ground", "held", "free"])
def test_freedoms_of_each_kind_are_those_of_mechanics(kind, other):
    random = np.random.default_rng(list(KINDS).index(kind))
    parts = [box([0, 0, 0], [1, 2, 3])]
    if other != "ground":
        parts.append(box([2, 2, 2], [3, 3, 4], name=other, grounded=other == "held"))
    point, axis = random.normal(size=3), unit(random.normal(size=3))
    for pair in ((other, "box"), ("box", other)):
        assembly = Assembly(parts, joints=[joint(kind, pair, point, axis)])
        program = program_of(assembly)
        rows = dense_rows(program)[:, :6]  # of the box against the other, which stays
        assert np.linalg.matrix_rank(rows, tol=1e-9) == 6 - KINDS[kind] == len(rows)
        free = np.linalg.svd(rows)[2][6 - KINDS[kind] :]
        for twist in _free_twists(kind, point - program.center[0], axis):
            # in the span of what is free
            assert np.allclose(free.T @ (free @ twist), twist, atol=1e-9)


def _free_twists(kind, arm, axis):
    """Twists (about the centre) that a joint at `arm` from it leaves free."""
    turns = {"revolute": [axis], "cylindrical": [axis], "spherical": np.eye(3)}.get(kind, [])
    slides = [axis] if kind in ("prismatic", "cylindrical") else []
    return [np.concatenate([-np.cross(w, arm), w]) for w in turns] + [
        np.concatenate([v, np.zeros(3)]) for v in slides
    ]


@pytest.mark.quick(1)
@EACH
def test_loads_along_what_is_held_are_carried_both_ways_and_others_are_not(kind):
    random = np.random.default_rng(10 + list(KINDS).index(kind))
    point, axis = np.array([0.3, -2.0, 1.0]), unit(random.normal(size=3))
    assembly = Assembly([box([0, 0, 0], [1, 2, 3])], joints=[joint(kind, point=point, axis=axis)])
    center = assembly.geometry.center[0]
    free = _free_twists(kind, point - center, axis)
    basis = np.linalg.qr(np.array(free).T)[0].T if free else np.empty((0, 6))
    weight = np.array([0, 0, -G, 0, 0, 0])
    for sign in (1, -1):
        load = sign * 20 * random.normal(size=6)
        held = load - basis.T @ (basis @ (load + weight))
        case = Load("box", held[:3], held[3:])
        verdict = judged(dataclasses.replace(assembly, loads=[case]))
        assert verdict.first_order == "stable"
        wrench = np.array(verdict.proof()["joints"][0]["wrench"])
        about = np.array(verdict.proof()["joints"][0]["point"])
        total = held + weight
        by_hand = [*-total[:3], *-(total[3:] + np.cross(center - about, total[:3]))]
        assert np.allclose(wrench, by_hand, atol=1e-9)
        for twist in basis:
            more = held + OFF * 20 * twist
            off = dataclasses.replace(assembly, loads=[Load("box", more[:3], more[3:])])
            assert judged(off).verdict == "unstable"


# closed forms -----------------------------------------------------------------------------


def pendulum(kind="revolute", **options):
    """A rod 2 m long that hangs from its upper end at the origin."""
    return Assembly([box([-0.1, -0.1, -2], [0.1, 0.1, 0])], joints=[joint(kind)], **options)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["revolute", "spherical", "cylindrical"])
@pytest.mark.parametrize("planar", [False, True])
def test_pendulum_hangs_and_falls_sideways_as_a_compound_pendulum(kind, planar):
    hanging = pendulum(kind, planar=planar)
    assert judged(hanging).verdict == "stable"
    upright = judged(tilted(hanging, Y, 180))
    assert (upright.verdict, upright.first_order) == ("balanced", "stable")
    for degrees in (OFF, -OFF, 90.0):
        off = judged(tilted(hanging, Y, degrees))
        assert off.verdict == "unstable"
    inertia = (0.2**2 + 2.0**2) / 12 + 1.0
    alpha = off.motion.acceleration[0, 4]
    assert abs(alpha) == pytest.approx(G / inertia, rel=1e-8)
    assert np.allclose(off.motion.acceleration[0, :3], np.cross([0, alpha, 0], [0, 0, -1]))


@pytest.mark.quick(1)
@pytest.mark.parametrize("degrees", [OFF, 1.0, 30.0, 90.0])
@pytest.mark.parametrize("planar", [False, True])
def test_slider_runs_along_its_rail_at_g_times_the_sine(degrees, planar):
    slope = np.radians(degrees)
    rail = [np.cos(slope), 0, -np.sin(slope)]
    slider = Assembly(
        [box([3, -1, 0], [4, 1, 1])], joints=[joint("prismatic", axis=rail)], planar=planar
    )
    verdict = judged(slider)
    assert verdict.verdict == "unstable"
    expected = G * np.sin(slope) * np.array([*rail, 0, 0, 0])
    assert np.allclose(verdict.motion.acceleration[0], expected, atol=1e-9)
    level = dataclasses.replace(slider, joints=[joint("prismatic", axis=[1, 0, 0])])
    assert judged(level).verdict == "stable"
    wrench = judged(level).proof()["joints"][0]["wrench"]
    assert np.allclose(wrench, [0, 0, G, 0, 0, 0], atol=1e-9)


def test_sleeve_on_a_shaft_falls_along_it_and_turns_about_it():
    sleeve = box([-0.5, -0.5, -0.5], [0.5, 0.5, 0.5])
    upright = Assembly([sleeve], joints=[joint("cylindrical", axis=[0, 0, 1])])
    falling = judged(upright)
    assert np.allclose(falling.motion.acceleration[0], [0, 0, -G, 0, 0, 0], atol=1e-9)
    level = Assembly([sleeve], joints=[joint("cylindrical")])
    assert judged(level).verdict == "stable"
    aside = Assembly([sleeve], joints=[joint("cylindrical", point=[OFF, 0, 0])])
    assert judged(aside).verdict == "unstable"


def door(kinds=("spherical", "spherical"), width=0.9, height=1.2, **options):
    """A door about the z axis with hinges at 0.3 and 0.3 + height."""
    leaf = box([0, -0.02, 0], [width, 0.02, 2.0], name="box", mass=25.0)
    heights = {"low": 0.3, "high": 0.3 + height}
    joints = [
        joint(kind, point=[0, 0, z], axis=[0, 0, 1])
        for kind, z in zip(kinds, heights.values(), strict=True)
    ]
    return Assembly([leaf], joints=joints, **options)


def test_door_on_two_hinges_pulls_above_and_pushes_below():
    verdict = judged(door())
    assert verdict.verdict == "stable"
    low, high = (np.array(entry["wrench"]) for entry in verdict.proof()["joints"])
    lever = 25 * G * 0.45 / 1.2
    assert low[0] == pytest.approx(lever, rel=1e-9)
    assert high[0] == pytest.approx(-lever, rel=1e-9)
    assert low[2] + high[2] == pytest.approx(25 * G, rel=1e-9)
    assert np.allclose([low[1], high[1], *low[3:], *high[3:]], 0, atol=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("kinds", [("revolute", "revolute"), ("cylindrical", "revolute")])
def test_door_swings_when_its_axis_leans_and_only_then(kinds):
    assert judged(door(kinds)).verdict == "stable"
    for degrees in (1e-4, -1e-4, 5.0):
        # leaning in its own plane does not swing it; to one side a small push does
        leaning = judged(tilted(door(kinds), Y, degrees))
        assert leaning.first_order == "stable"
        verdict = judged(tilted(door(kinds), [1, 0, 0], degrees))
        assert verdict.verdict == "unstable"
    inertia = 0.9**2 / 3 + 0.04**2 / 12
    spin = verdict.motion.acceleration[0, 5]
    assert abs(spin) == pytest.approx(G * np.sin(np.radians(5)) * 0.45 / inertia, rel=1e-7)


def test_overconstrained_door_has_the_region_of_one_hinge():
    region = kilter.region(door(("revolute", "revolute")))
    # gravity in the plane of the leaf and its axis holds, either way
    assert region.kind == "plane"
    assert np.allclose(np.abs(region.equations), [[0, 1, 0]], atol=1e-9)
    assert region.proved
    for proof in region.proofs():  # of forces: a door also swings to another place
        found = verified(reloaded(proof.assembly), proof.data)
        assert found.reasons == ()


def four_bar(reach=2.0, planar=False):
    """A swing: two rods 1 m long hang `reach` apart and carry a bar between their ends."""
    parts = [
        box([-0.05, -0.05, -1], [0.05, 0.05, 0], name="left"),
        box([reach - 0.05, -0.05, -1], [reach + 0.05, 0.05, 0], name="right"),
        box([0, -0.05, -1.05], [reach, 0.05, -0.95], name="bar", mass=2.0),
    ]
    pins = [
        joint("revolute", ("ground", "left")),
        joint("revolute", ("ground", "right"), [reach, 0, 0]),
        joint("revolute", ("left", "bar"), [0, 0, -1]),
        joint("revolute", ("bar", "right"), [reach, 0, -1]),
    ]
    return Assembly(parts, joints=pins, planar=planar, detect=False)


@pytest.mark.parametrize("planar", [False, True])
def test_four_bar_linkage_hangs_swings_and_carries_half_at_each_pin(planar):
    verdict = judged(four_bar(planar=planar))
    assert verdict.verdict == "stable"
    assert verdict.neutral.two_sided == 1
    assert verdict.neutral.one_sided == 0
    wrench = [np.array(entry["wrench"]) for entry in verdict.proof()["joints"]]
    for number, size in enumerate([2 * G, 2 * G, G, -G]):  # on rods; on bar; on the right rod
        assert wrench[number][2] == pytest.approx(size, rel=1e-8)
    swinging = judged(tilted(four_bar(planar=planar), Y, 10.0))
    assert swinging.verdict == "unstable"
    # by Lagrange: (2 I + m_bar) alpha = (2 m/2 + m_bar) g sin, I about the upper pin
    inertia = 2 * ((0.1**2 + 1) / 12 + 0.25) + 2.0
    alpha = 3 * G * np.sin(np.radians(10)) / inertia
    found = swinging.motion.acceleration
    assert np.allclose(np.abs(found[:2, 4]), alpha, rtol=1e-7)
    assert np.allclose(found[2, [0, 2, 4]], [found[2, 0], 0, 0], atol=1e-8)
    assert abs(found[2, 0]) == pytest.approx(alpha, rel=1e-7)


def test_crane_pulls_at_its_hook_and_pushes_at_its_heel():
    # a beam on a heel at x = 0, held by a rod that hangs from above at x = 1; load at x = 3
    parts = [
        box([0, -0.1, -0.1], [4, 0.1, 0.1], name="beam", mass=40.0),
        box([0.95, -0.05, 0], [1.05, 0.05, 2], name="rod", mass=1e-6),
    ]
    pins = [
        joint("revolute", ("ground", "beam")),
        joint("spherical", ("beam", "rod"), [1, 0, 0]),
        joint("spherical", ("rod", "ground"), [1, 0, 2]),
    ]
    verdict = judged(
        Assembly(parts, joints=pins, loads=[Load("beam", [0, 0, -100], point=[3, 0, 0])])
    )
    assert verdict.verdict == "stable"
    heel, hook, _ = (np.array(entry["wrench"]) for entry in verdict.proof()["joints"])
    tension = 40 * G * 2 + 100 * 3
    assert hook[2] == pytest.approx(-tension, rel=1e-6)  # on the rod: it is pulled down
    assert heel[2] == pytest.approx(40 * G + 100 - tension, rel=1e-6)
    assert heel[2] < 0 < tension


# the same under turns, scale, order and point ----------------------------------------------


SCENES = {
    "pendulum": (pendulum, "stable"),
    "pendulum-off": (lambda: tilted(pendulum(), Y, 1e-4), "unstable"),
    "door": (lambda: door(("revolute", "revolute")), "stable"),
    "door-off": (lambda: tilted(door(("revolute", "revolute")), [1, 0, 0], 1e-3), "unstable"),
    "swing": (four_bar, "stable"),
    "swing-off": (lambda: tilted(four_bar(), Y, 1e-4), "unstable"),
    "slider": (lambda: pendulum("prismatic"), "stable"),
    "slider-off": (lambda: tilted(pendulum("prismatic"), [1, 0, 0], 1e-4), "unstable"),
}


def test_point_far_along_the_axis_or_anywhere_of_a_fixed_joint_costs_nothing():
    far = 1e7
    for kind, point in (("revolute", [0, far, 0]), ("cylindrical", [0, -far, 0])):
        hanging = dataclasses.replace(pendulum(), joints=[joint(kind, point=point)])
        assert judged(hanging).verdict == "stable"
        assert judged(tilted(hanging, Y, 1e-4)).verdict == "unstable"
    fixed = Joint(("ground", "box"), point=[far, far, far])
    assert judged(dataclasses.replace(pendulum(), joints=[fixed])).verdict == "stable"


def test_joint_of_two_held_parts_carries_nothing():
    parts = [box([0, 0, 0], [1, 1, 1], name=n, grounded=n != "box") for n in ("a", "b", "box")]
    pins = [Joint(("a", "b")), Joint(("a", "ground")), Joint(("b", "box"))]
    verdict = judged(Assembly(parts, joints=pins, detect=False))
    assert verdict.verdict == "stable"
    first, second, third = (entry["wrench"] for entry in verdict.proof()["joints"])
    assert first == second == [0.0] * 6
    assert third[2] == pytest.approx(G)


# turning ----------------------------------------------------------------------------------


def test_orientation_of_a_pendulum_is_found_hanging_or_along_its_axis():
    answer = orient(tilted(pendulum("spherical"), Y, 70.0))
    assert answer.found
    assert abs(answer.down[2]) == pytest.approx(1.0, abs=1e-9)


# proofs -----------------------------------------------------------------------------------


def numbers_of(joints):
    for number, entry in enumerate(joints):
        for key in ("point", "axis", "wrench"):
            for place in range(len(entry[key] or ())):
                yield number, key, place


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SCENES)
def test_flipped_number_of_a_joint_is_refused(name):
    assembly = SCENES[name][0]()
    proof = judged(assembly).proof()
    for number, key, place in numbers_of(proof["joints"]):
        other = copy.deepcopy(proof)
        values = other["joints"][number][key]
        values[place] = values[place] * 1.001 if abs(values[place]) > 1e-6 else 1e-3
        other["digest"] = digest_of(other)
        assert not verified(reloaded(assembly), other).holds, (number, key, place)


@pytest.mark.quick(3)
@EACH
def test_wrench_that_its_kind_cannot_carry_is_refused_by_name(kind):
    # the box hangs below the joint and is held by a fixed one beside: balance stays
    point, axis = [0.0, 0.0, 0.0], unit([0.6, 0.0, 0.8])
    pins = [joint(kind, point=point, axis=axis), Joint(("ground", "box"), point=point)]
    assembly = dataclasses.replace(pendulum(), joints=pins)
    proof = judged(assembly).proof()
    free = _free_twists(kind, np.zeros(3), axis)
    assert len(free) == KINDS[kind]
    for twist in free:
        other = copy.deepcopy(proof)
        for number, sign in ((0, 1), (1, -1)):
            entry = other["joints"][number]
            entry["wrench"] = (np.array(entry["wrench"]) + sign * twist).tolist()
        other["digest"] = digest_of(other)
        answer = verified(reloaded(assembly), other)
        assert not answer.holds
        assert any(f"the {kind} joint of" in reason for reason in answer.reasons)


def test_wrench_out_of_the_plane_is_refused():
    assembly = pendulum(planar=True)
    proof = judged(assembly).proof()
    for place in (1, 3, 5):
        other = copy.deepcopy(proof)
        other["joints"][0]["wrench"][place] = 1e3
        other["digest"] = digest_of(other)
        assert not verified(reloaded(assembly), other).holds


# wrong input ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "given", "missing"),
    [
        ("revolute", {"axis": Y}, "revolute joint of 'a' and 'b' has no point"),
        ("revolute", {"point": Y}, "revolute joint of 'a' and 'b' has no axis"),
        ("prismatic", {}, "prismatic joint of 'a' and 'b' has no axis"),
        ("cylindrical", {"axis": Y}, "cylindrical joint of 'a' and 'b' has no point"),
        ("spherical", {}, "spherical joint of 'a' and 'b' has no point"),
        ("revolutte", {}, "did you mean 'revolute'"),
        ("revolute", {"point": Y, "axis": [0, 0, 0]}, "axis of the revolute joint of 'a' and 'b'"),
        ("spherical", {"point": [0, float("nan"), 0]}, "point of the spherical joint"),
    ],
)
def test_joint_without_what_it_needs_is_refused(kind, given, missing):
    with pytest.raises(InputError, match=missing):
        Joint(("a", "b"), kind, **given)


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("kind", "axis", "fits"),
    [
        ("revolute", [0, -1, 0], True),
        ("revolute", [1, 0, 0], False),
        ("revolute", [0, 1, 1e-3], False),
        ("prismatic", [1, 0, 2], True),
        ("prismatic", [0, 1, 0], False),
        ("prismatic", [1, 1e-3, 0], False),
        ("cylindrical", [0, 1, 0], True),
        ("cylindrical", [1, 0, 1], True),
        ("cylindrical", [1, 1, 0], False),
    ],
)
def test_joints_of_planar_assemblies_act_in_the_plane(kind, axis, fits):
    pins = [joint(kind, axis=axis)]
    rod = box([-0.1, -0.1, -2], [0.1, 0.1, 0])
    assert judged(Assembly([rod], joints=pins)).verdict
    if not fits:
        with pytest.raises(InputError, match=f"{kind} joint of 'ground' and 'box'.*planar"):
            Assembly([rod], joints=pins, planar=True)
        return
    program = program_of(Assembly([rod], joints=pins, planar=True))
    rows = dense_rows(program)[:, [0, 2, 4]]
    assert np.linalg.matrix_rank(rows) == 2 == len(rows)
