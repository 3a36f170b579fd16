"""Bonds with limited shear: closed forms on both sides, and proofs."""

from __future__ import annotations

import copy
import json

import numpy as np
import pytest
from judged import judged

import kilter
from kilter import Assembly, Bond, Box, Part, Pose
from kilter.mechanics.mechanics_tolerances import AGREES
from kilter.mechanics.proof import digest_of

G, WEIGHT = 9.81, 9810.0
STRONG = 1e6
BOTH = pytest.mark.parametrize("share", [0.999, 1.001])


def cube(name, x=0.0, **more):
    return Part(name, Box([1, 1, 1]), Pose([x, 0, 0]), **more)


def cup(share, pull=STRONG):
    """A cube bonded to a wall; its weight makes it slide down and turn about the lower edge."""
    bond = Bond(("cube", "wall"), pull=pull, shear=share * WEIGHT / 4, kind="suction")
    return Assembly([cube("wall", x=1.0, grounded=True), cube("cube")], bonds=[bond])


def falls(share):
    return "unstable" if share < 1 else "stable"


@pytest.mark.parametrize("share", [0.999, 1 - 1e-7, 1 + 1e-7, 1.001])
def test_a_suction_cup_bears_its_weight_by_shear_alone(share):
    assembly = cup(share)
    assert kilter.check(assembly).verdict == falls(share)
    if abs(share - 1) > 1e-4:
        judged(assembly)
    factor = kilter.margin(assembly, pushed=[]).bond
    assert factor * share == pytest.approx(1.0, abs=1e-8)


@BOTH
def test_a_suction_cup_needs_its_pull_too(share):
    """Moment W / 2 about the lower edge, borne by two points at height 1."""
    assert judged(cup(2.0, pull=share * WEIGHT / 4)).verdict == falls(share)


@BOTH
@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("degrees", [20.0, 60.0])
def test_glue_on_a_smooth_slope(share, planar, degrees):
    turn = np.radians(degrees)
    glue = Bond(("slope", "plate"), pull=0.0, shear=share * 10 * G * np.sin(turn) / 4)
    thin = Part("plate", Box([1, 1, 0.01]), Pose([0, 0, 0.505]))
    assembly = Assembly(
        [cube("slope", grounded=True), thin],
        gravity=[G * np.sin(turn), 0, -G * np.cos(turn)],
        bonds=[glue],
        planar=planar,
    )
    assert judged(assembly).verdict == falls(share)


@BOTH
@pytest.mark.parametrize("off", [0.0, 0.3, 1.0])
def test_two_pins_beside_which_a_weight_hangs(share, off):
    """Pins at x = d and -d, weight at x = e: the nearer pin bears W (1 + e / d) / 2."""
    d = 0.5
    needed = WEIGHT / 2 * max(1 + off / d, off / d - 1)
    pins = Bond(
        ("wall", "plate"),
        pull=STRONG,
        shear=share * needed,
        points=[[-d - off, 0.0, 0], [d - off, 0.0, 0]],
        normal=[0, -1, 0],
    )
    wall = Part("wall", Box([4, 1, 4]), Pose([0, 1.0, 0]), grounded=True)
    plate = Part("plate", Box([4, 1, 4]), mass=1000.0)
    assembly = Assembly([wall, plate], bonds=[pins], detect=False)
    verdict = judged(assembly)
    assert verdict.verdict == falls(share)


def test_no_shear_is_a_smooth_contact_and_much_is_any():
    for shear, verdict in ((0.0, "unstable"), (STRONG, "stable"), (None, "stable")):
        bond = Bond(("cube", "wall"), pull=STRONG, shear=shear)
        parts = [cube("wall", x=1.0, grounded=True), cube("cube")]
        assert judged(Assembly(parts, friction=0.9, bonds=[bond])).verdict == verdict


def test_friction_beside_it_is_asked_for_balance_only():
    """A cube on a wedge with friction, weakly glued to a wall."""
    turn = np.radians(20)
    bond = Bond(("cube", "wall"), pull=0.0, shear=100.0)
    floor = Part("floor", Box([3, 1, 1]), Pose([0, 0, -1]), grounded=True)
    assembly = Assembly(
        [floor, cube("wall", x=1.0, grounded=True), cube("cube")],
        friction=0.5,
        gravity=[-G * np.sin(turn), 0, -G * np.cos(turn)],
        bonds=[bond],
    )
    verdict = kilter.check(assembly)
    assert (verdict.verdict, verdict.guarantee) == ("potentially-stable", "open")
    assert any("limited shear" in warning for warning in verdict.warnings)
    assert kilter.verify(assembly, json.loads(json.dumps(verdict.proof()))).holds
    assert not kilter.check(Assembly(assembly.parts, friction=0.3, gravity=assembly.gravity)).stable


def test_forces_use_their_limit_and_a_changed_one_is_refused():
    assembly = cup(1.25)
    verdict = kilter.check(assembly)
    assert verdict.forces.bond_utilisation == pytest.approx([0.8])
    proof = json.loads(json.dumps(verdict.proof()))
    assert proof["points"][0]["shear"] == pytest.approx(1.25 * WEIGHT / 4)
    assert kilter.verify(assembly, proof).holds
    assert not kilter.verify(cup(1.26), proof).holds
    more = copy.deepcopy(proof)
    for sign, force in zip((1, -1, 1, -1), more["forces"], strict=True):
        force[1] += sign * 0.9 * WEIGHT / 4
    more["digest"] = digest_of(more)
    assert "a force across a bond exceeds its shear limit" in kilter.verify(assembly, more).reasons
    for value in (None, 9.0):
        other = copy.deepcopy(proof)
        other["points"][0]["shear"] = value
        other["digest"] = digest_of(other)
        assert "its bonds differ from those of the file" in kilter.verify(assembly, other).reasons


def test_a_motion_proves_only_what_bonds_do_not_take_up():
    """Sliding down under its weight is no proof of instability if the bond bears more."""
    proof = json.loads(json.dumps(kilter.check(cup(0.9)).proof()))
    assert kilter.verify(cup(0.9), proof).holds
    for point in proof["points"]:
        point["shear"] = 1.1 * WEIGHT / 4
    proof["digest"] = digest_of(proof)
    found = kilter.verify(cup(1.1), proof)
    assert any("proves nothing" in reason for reason in found.reasons)


def test_limits_of_margin_are_proved_on_both_sides():
    assembly = cup(2.0)
    found = kilter.margin(assembly, push=[0, 0, -1], pushed=["cube"])
    assert found.bond == pytest.approx(0.5, abs=1e-8)
    assert found.load_factor[1] == pytest.approx(1.0, abs=1e-7)
    bundle = json.loads(json.dumps(found.proof()))
    assert {(one["about"], one["held"]) for one in bundle["proofs"]} >= {
        ("bond", True), ("bond", False), ("load factor", True), ("load factor", False)
    }  # fmt: skip
    assert kilter.verify(assembly, bundle).holds


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9])
def test_how_it_slips(share):
    """The cube accelerates downwards by g minus the deceleration by the bond."""
    verdict = judged(cup(share))
    assert verdict.moving == ["cube"]
    assert verdict.motion.residual < 1e-7
    acceleration = verdict.motion.acceleration[1]
    assert acceleration == pytest.approx([0, 0, -G * (1 - share), 0, 0, 0], abs=1e-6)


def test_how_it_slips_is_the_least_of_gausss_principle():
    """Comparison with all nearby motions of two glued cubes on a steep slope without friction."""
    turn = np.radians(70)
    bonds = [
        Bond(("slope", "low"), pull=0.0, shear=500.0),
        Bond(("low", "high"), pull=100.0, shear=900.0),
    ]
    parts = [
        Part("slope", Box([3, 1, 1]), grounded=True),
        Part("low", Box([1, 1, 0.2]), Pose([0, 0, 0.6])),
        Part("high", Box([1, 1, 0.2]), Pose([0.1, 0, 0.8])),
    ]
    gravity = G * np.array([np.sin(turn), 0.0, -np.cos(turn)])
    assembly = Assembly(parts, gravity=gravity, bonds=bonds)
    verdict = judged(assembly)
    program, motion = verdict.program, verdict.motion.acceleration

    def cost(a):
        kinetic = program.mass @ (a[:, :3] ** 2).sum(axis=1) / 2
        kinetic += np.einsum("ni,nij,nj->", a[:, 3:], program.inertia, a[:, 3:]) / 2
        return kinetic - program.power(a)

    random = np.random.default_rng(5)
    assert verdict.motion.residual < 1e-6
    least, tried = cost(motion), 0
    while tried < 300:
        other = motion + random.normal(size=motion.shape) * 10 ** random.uniform(-4, 0)
        other[0] = 0.0
        worst = program.velocities(other).min()
        # lift both cubes as far as needed to prevent penetration
        other[1:, 2] += max(-worst, 0.0) * np.array([1.0, 2.0])
        if program.velocities(other).min() >= -1e-12:
            tried += 1
            assert cost(other) >= least - 1e-6 * abs(least)


def said(assembly, change):
    """The reasons for rejecting its proof after a change, with a new signature."""
    proof = json.loads(json.dumps(kilter.check(assembly).proof()))
    change(proof)
    proof["digest"] = digest_of(proof)
    return kilter.verify(assembly, proof).reasons


def beside_a_stone(pull, **more):
    """A suction cup, and a stone on the ground: contact points with and without a bond."""
    bond = Bond(("cube", "wall"), pull=pull, **more)
    table = Part("table", Box([1, 1, 1]), Pose([9, 0, 0]), grounded=True)
    stone = Part("stone", Box([1, 1, 1]), Pose([9, 0, 1]))
    light = Part("cube", Box([1, 1, 1]), mass=1e-5)
    return Assembly([cube("wall", x=1.0, grounded=True), light, table, stone], bonds=[bond])


@pytest.mark.parametrize("key", ["pull", "shear"])
@pytest.mark.parametrize(("off", "refused"), [(0.5, False), (3.0, True)])
def test_the_strength_of_a_bond_agrees_to_rounding_of_itself(key, off, refused):
    """Also for forces far below 1 N."""

    def change(proof):
        (point, *_) = (one for one in proof["points"] if key in one)
        point[key] *= 1 + off * AGREES

    reasons = said(beside_a_stone(1e-3, shear=2e-3), change)
    assert ("its bonds differ from those of the file" in reasons) == refused


@pytest.mark.parametrize("tied", [True, False])
def test_what_bears_shear_is_asked_even_where_the_pull_agrees(tied):
    assembly = beside_a_stone(1e-3, shear=None if tied else 2e-3)

    def change(proof):
        point = next(one for one in proof["points"] if "pull" in one)
        point["tied"] = not tied

    assert "its bonds differ from those of the file" in said(assembly, change)


def test_a_push_of_less_than_a_newton_bears_friction_of_less_than_that():
    """A block of 1 g on a slope; shear forces that exceed friction are added to the proof."""
    turn = np.radians(20)
    thin = Part("thin", Box([1, 1, 0.01]), Pose([0, 0, 0.505]), mass=1e-3)
    gravity = [G * np.sin(turn), 0, -G * np.cos(turn)]
    assembly = Assembly([cube("slope", grounded=True), thin], friction=0.5, gravity=gravity)

    def change(proof):
        for sign, force in zip((1, -1, 1, -1), proof["forces"], strict=True):
            force[1] += sign * 0.3

    reasons = said(assembly, change)
    assert "a force leaves its cone: its friction exceeds mu times its normal force" in reasons
