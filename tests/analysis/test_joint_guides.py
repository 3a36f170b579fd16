"""Limits, friction and springs of joints beside closed forms, on both sides of each limit."""

from __future__ import annotations

import copy
import dataclasses
import math
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, InputError, Joint, Part, Pose, Tolerance, Verdict
from kilter.mechanics.proof import digest_of

G = 9.81
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


def judged(assembly: Assembly) -> Verdict:
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


@pytest.mark.parametrize("name", CASES)
def test_a_joint_holds_exactly_within_its_limits_friction_and_spring(name: str) -> None:
    assembly, word = CASES[name]
    verdict = judged(assembly)
    assert verdict.verdict == word
    assert (verdict.level == "proved") == (word == "stable")


@pytest.mark.parametrize("degrees", [25.0, 100.0])
def test_a_leaning_rod_on_a_spring_is_a_minimum_if_the_stiffness_exceeds_that_of_gravity(
    degrees: float,
) -> None:
    """V = k (q - rest)^2 / 2 + M cos(lean): V'' = k - M cos(lean)."""
    needed = MOMENT * math.cos(math.radians(degrees))
    for share, word in ((1.01, "stable"), (0.99, "balanced")):
        stiffness = share * needed if needed > 0 else 0.01
        spring = {"stiffness": stiffness, "rest": -leaning(degrees) / stiffness}
        assert judged(rod(degrees, **spring)).verdict == (word if needed > 0 else "stable")


def test_two_links_on_springs_are_a_minimum_exactly_if_their_stiffness_matrix_is_positive() -> None:
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
        assert judged(assembly).verdict == ("stable" if least > 0 else "balanced")


def test_the_answer_states_the_forces_of_stop_friction_and_spring() -> None:
    guide = {"limits": [-0.3, 0], "friction": 0.5, "stiffness": 50.0, "rest": 0.01}
    answer = judged(drawer(**guide)).to_dict()
    (joint,) = answer["forces"]["joints"]
    assert joint["spring"] == pytest.approx(0.5)
    assert joint["stop"] < 0
    assert abs(joint["friction"]) <= 0.5
    total = joint["stop"] + joint["friction"] + joint["spring"]
    assert total == pytest.approx(-DOWNHILL)
    assert answer["joints"][0]["limits"] == [-0.3, 0]
    (other,) = judged(rod(-20, limits=[0, 2])).to_dict()["forces"]["joints"]
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
def test_a_proof_with_a_force_beyond_the_joint_is_refused(
    guide: dict[str, Any], shift: float
) -> None:
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
def test_a_proof_of_a_joint_with_other_numbers_is_refused(key: str) -> None:
    guide = {"limits": (-0.3, 0.0), "friction": 0.5, "stiffness": 50.0, "rest": 0.01}
    assembly = drawer(**guide)
    proof = kilter.check(assembly).proof()
    other = {"limits": (-0.4, 0.0)}.get(key, 0.02)
    joint = dataclasses.replace(assembly.joints[0], **{key: other})
    changed = dataclasses.replace(assembly, joints=[joint])
    assert "its joints differ from those of the file" in kilter.verify(changed, proof).reasons


def test_second_order_does_not_count_friction_at_its_limit() -> None:
    """At the limit a small push makes the drawer slide on, so the level is below proved."""
    verdict = judged(drawer(friction=DOWNHILL))
    assert verdict.verdict in ("potentially-stable", "undecided")


@pytest.mark.parametrize(
    ("assembly", "distance"),
    [
        (drawer(limits=[-0.3, -1e-3]), "0.001 m"),
        (rod(100, limits=[-1.7, -1e-3]), "0.001 rad"),
    ],
)
def test_a_joint_beyond_its_limits_has_no_stop_and_a_note(
    assembly: Assembly, distance: str
) -> None:
    """The gap of the note is the least, to its digits, that counts the stop."""
    verdict = judged(assembly)
    assert verdict.verdict == "unstable"
    (note,) = [words for words in verdict.warnings if f"drawn {distance} beyond" in words]
    gap = float(note.split("--gap ")[1].split()[0])
    for share, word in ((1.0, "stable"), (0.98, "unstable")):
        again = kilter.check(assembly, tolerance=Tolerance(gap=share * gap))
        assert again.verdict == word


def test_the_stop_counts_within_the_tolerance_of_gaps() -> None:
    """A turn counts by the radius of the rod."""
    box, lean = drawer(), rod(100)
    slack = Tolerance().relative_gap * box.geometry.size[0]
    turn = Tolerance().relative_gap * lean.geometry.size[0] / lean.geometry.radius[0]
    for share, word in ((0.99, "stable"), (1.01, "unstable")):
        assert judged(drawer(limits=[-0.3, share * slack])).verdict == word
        assert judged(rod(100, limits=[-1.7, share * turn])).verdict == word


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
def test_wrong_limits_friction_and_springs_are_refused(given: dict[str, Any], words: str) -> None:
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


def test_a_forged_second_order_of_springs_and_friction_is_refused() -> None:
    soft, stiff = (rod(0, stiffness=share * MOMENT) for share in (0.99, 1.01))
    assert forged(stiff, stiff) == ""
    assert "the energy does not curve upward" in forged(soft, stiff)
    rough, limp = (drawer(friction=share * DOWNHILL) for share in (1.5, 1 + 1e-9))
    assert forged(rough, rough) == ""
    assert "the friction of a joint is at its limit" in forged(limp, rough)
    assert "joints may not be left out" in forged(stiff, stiff, idle=[0])
