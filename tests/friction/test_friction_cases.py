"""Known answers with friction, on both sides of every limit; each verdict rechecked."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from judged import judged

from kilter.assembly import Assembly, GivenContact
from kilter.scenes import friction, rounds, stacks, wedges
from kilter.scenes.arches import arch, arch_with_held_ends
from kilter.scenes.pieces import block
from kilter.scenes.transform import tilted
from kilter.scenes.walls import wall
from sampled import sampled

SIDES = (0.98, 1.02)


def guaranteed(verdict):
    return verdict.verdict == "stable" and verdict.guarantee == "proved"


def planar(assembly):
    return dataclasses.replace(assembly, planar=True)


@pytest.mark.parametrize(("mu", "ratio"), [(0.5, 2.0), (0.9, 0.5), (0.2, 1.0)])
def test_s1_block_on_an_incline_slides_or_tips(mu, ratio):
    limit = np.degrees(np.arctan(min(mu, ratio)))
    below, above = (
        judged(stacks.block_on_slope(limit * side, width=ratio, friction=mu)) for side in SIDES
    )
    assert guaranteed(below)
    assert above.verdict == "unstable"


@pytest.mark.parametrize("azimuth", [0.0, 22.5, 45.0])
@pytest.mark.parametrize(("angle", "word"), [(28.0, "unstable"), (26.0, "stable")])
def test_w4_w5_slope_to_every_side(angle, word, azimuth):
    slope = stacks.block_on_slope(angle, azimuth=azimuth, friction=0.5)
    assert judged(slope).verdict == word


@pytest.mark.parametrize(("mu_wall", "limit"), [(0.0, 51.3402), (0.3, 47.7263)])
def test_s4_ladder(mu_wall, limit):
    exact = np.degrees(np.arctan((1 - 0.4 * mu_wall) / 0.8))
    assert exact == pytest.approx(limit, abs=1e-4)
    # steeper is safer; 0.98 of the limit in the tangent of the angle
    for side, word in ((1 / 0.98, "stable"), (1 / 1.02, "unstable")):
        angle = np.degrees(np.arctan(np.tan(np.radians(exact)) * side))
        verdict = judged(friction.ladder(angle, friction_wall=mu_wall))
        assert verdict.verdict == word


def test_s5_bracket_is_refuted_and_seated_above_its_limit():
    # thin pads: their pressure has no height of its own
    limit = 1.0 / (2 * 0.6)
    below = judged(friction.bracket(0.98 * limit, friction=0.6, pad=1e-3))
    assert below.verdict == "unstable"
    above = judged(friction.bracket(1.1 * limit, friction=0.6, pad=1e-3))
    assert (above.verdict, above.guarantee, above.seated) == (
        "potentially-stable",
        "refuted",
        "yes",
    )
    assert (above.level, above.why, above.tries) == ("equilibrium", "refuted", (0, 8))
    assert not above.stable


@pytest.mark.parametrize(("count", "thickness"), [(4, 0.05), (12, 0.25)])
def test_s6_books_need_their_press(count, thickness):
    # few books slip, many sag
    weight, height, mu = 9.81, 0.25, 0.5
    slips, sags = count * weight / (2 * mu), count**2 * weight * thickness / (8 * height)
    assert (slips > sags) == (count == 4)
    for side, word in ((1.02, "potentially-stable"), (0.98, "unstable")):
        row = friction.books(
            count, force=side * max(slips, sags), friction=mu, thickness=thickness, height=height
        )
        verdict = judged(row, effort=1)
        assert (verdict.verdict == "unstable") == (word == "unstable")
        assert verdict.tries in ((8, 8), None)  # they settle, though a motion of small power exists


@pytest.mark.parametrize("planar", [False, True])
def test_i1_block_between_walls_is_held_by_squeeze_only(planar):
    verdict = judged(friction.h_block(friction=0.01, planar=planar))
    assert (verdict.verdict, verdict.guarantee) == ("potentially-stable", "refuted")
    assert verdict.seated == "runs-away"
    assert "squeeze" in verdict.sentence
    assert verdict.moving == ["block"]


@pytest.mark.parametrize("angle", [5.0, 10.0, 20.0])
def test_i2_trapezoid_between_plates_that_lean_inwards(angle):
    limit = np.tan(np.radians(angle))
    assert judged(friction.a_block(angle, friction=0.98 * limit)).verdict == "unstable"
    held = judged(friction.a_block(angle, friction=1.02 * limit))
    assert (held.verdict, held.guarantee, held.seated) == (
        "potentially-stable",
        "refuted",
        "runs-away",
    )
    for mu in (0.0, 0.3, 1.0):
        assert guaranteed(judged(friction.v_block(angle, friction=mu)))


def test_i3_trough_is_guaranteed_only_below_where_it_slips():
    static, true = 47.961, 44.126
    cosine = np.cos(np.radians(30.0))
    assert np.degrees(np.arctan(0.84 / cosine)) == pytest.approx(true, abs=1e-3)
    assert np.degrees(np.arctan(0.84 / np.sqrt(cosine**2 - 0.84**2 / 4))) == pytest.approx(
        static, abs=1e-3
    )
    shallow = friction.trough(30.0, tilt=20.0, friction=0.84)
    assert guaranteed(judged(shallow, effort=3))
    for angle in (true + 0.05, 46.0, static - 0.05):
        verdict = judged(friction.trough(30.0, tilt=angle, friction=0.84))
        assert (verdict.verdict, verdict.guarantee) == ("potentially-stable", "refuted")
        assert verdict.seated == "runs-away"
    near = judged(friction.trough(30.0, tilt=true - 0.05, friction=0.84), effort=1)
    assert near.guarantee != "refuted"
    assert near.level in ("settles", "proved")
    assert judged(friction.trough(30.0, tilt=static + 0.05, friction=0.84)).verdict == "unstable"


@pytest.mark.slow
def test_i3_trough_is_guaranteed_at_35_degrees():
    assert guaranteed(judged(friction.trough(30.0, tilt=35.0, friction=0.84), effort=3))


@pytest.mark.parametrize(
    ("count", "thickness"),
    sampled(2, [(12, 0.5), (6, 2.0), (12, 1.0), (12, 2.0), (20, 0.5), (20, 2.0)]),
)
def test_w6_arches_have_an_equilibrium(count, thickness):
    held = arch_with_held_ends(count, thickness=thickness, friction=0.7)
    assert judged(held, effort=1).verdict in ("stable", "settles", "potentially-stable")


@pytest.mark.parametrize("count", [3, 10])
def test_s2_stack_topples_as_one(count):
    limit = np.degrees(np.arctan(1 / count))
    for side, words in ((0.98, ("stable", "settles", "potentially-stable")), (1.02, ("unstable",))):
        stack = tilted(stacks.tower(count), [0, 1, 0], limit * side)
        assert judged(planar(stack.with_friction(0.9)), effort=2).verdict in words


@pytest.mark.parametrize("side", [0.5, 1.0])
def test_upright_walls_need_no_friction(side):
    upright = judged(wall(20, 20, friction=0.6 * side))
    assert guaranteed(upright)
    assert upright.friction is None


def test_stable_without_friction_is_stable_for_every_mu():
    for build in (stacks.tower, wedges.corner_boxes, wall):
        for mu in (0.0, 0.1, 0.5, 2.0):
            assert guaranteed(judged(build().with_friction(mu)))


@pytest.mark.parametrize("size", [1e-3, 1.0, 9.81, 1e3])
def test_verdict_does_not_depend_on_the_size_of_gravity(size):
    for build, word in (
        (lambda: stacks.block_on_slope(26.0, friction=0.5), "stable"),
        (lambda: stacks.block_on_slope(27.0, friction=0.5), "unstable"),
        (friction.h_block, "potentially-stable"),
    ):
        assembly = build()
        assembly = dataclasses.replace(assembly, gravity=assembly.down * size)
        assert judged(assembly).verdict == word


def test_raising_mu_never_takes_equilibrium_away():
    words = [
        judged(stacks.block_on_slope(20.0, friction=mu)).verdict
        for mu in (0.1, 0.3, 0.36, 0.37, 0.5, 1.0, 3.0)
    ]
    assert words == ["unstable"] * 3 + ["stable"] * 4


def test_mu_zero_on_one_contact_still_pushes_only():
    # the ladder's wall has no friction: its force may not pull either
    verdict = judged(friction.ladder(60.0, friction_wall=0.0))
    assert verdict.verdict == "stable"
    program = verdict.program
    smooth = (program.kind == 0) & (program.mu == 0)
    assert smooth.any()
    assert (verdict.judgement.forces.forces[smooth] >= 0).all()
    assert not verdict.judgement.forces.friction[smooth].any()
    pulled = dataclasses.replace(friction.ladder(60.0), gravity=-friction.ladder(60.0).gravity)
    assert judged(pulled).verdict == "unstable"


PILES = {
    "cylinders": (rounds.three_cylinders, 2 - np.sqrt(3), (2 - np.sqrt(3)) / 3),
    "spheres": (rounds.four_spheres, np.sqrt(3) - np.sqrt(2), (np.sqrt(3) - np.sqrt(2)) / 4),
}
"""Builder, least friction between the parts and on the ground."""


def piles(name, side):
    """At `side` of the limit between the parts, and of that on the ground."""
    build, between, ground = PILES[name]
    return (
        build(friction_between=between * side, friction_ground=2 * ground),
        build(friction_between=2 * between, friction_ground=ground * side),
    )


@pytest.mark.parametrize("name", PILES)
def test_r1_r2_piles_of_round_parts(name):
    for pile in piles(name, 0.98):
        assert judged(pile).verdict == "unstable"
    for pile in piles(name, 1 / 0.98):
        # cylinders in space may yaw while they slide, by which friction along their way is less
        held = judged(planar(pile) if name == "cylinders" else pile, effort=1)
        assert held.level in ("settles", "proved")
        assert name != "cylinders" or judged(pile, effort=1).level is not None


@pytest.mark.slow
@pytest.mark.parametrize("name", PILES)
def test_r1_r2_piles_are_guaranteed(name):
    for pile in piles(name, 1 / 0.98):
        # lines of contact between cylinders are points in their plane
        asked = planar(pile) if name == "cylinders" else pile
        assert guaranteed(judged(asked, effort=3))


def rock_wedge(phi):
    """Case I4: a part on two planes, dip / dip direction 40/130 and 60/220, the same phi [deg]."""
    block_ = block("wedge", [-1, -1, -1], [1, 1, 1])
    held = [
        block(name, [9 + k, 9, 9], [9.5 + k, 10, 10], grounded=True)
        for k, name in enumerate(("east", "south"))
    ]
    contacts = []
    for name, dip, toward in (("east", 40.0, 130.0), ("south", 60.0, 220.0)):
        d, a = np.radians([dip, toward])
        normal = np.array([np.sin(d) * np.sin(a), np.sin(d) * np.cos(a), np.cos(d)])
        u = np.array([np.cos(a), -np.sin(a), 0.0])
        v = np.cross(normal, u)
        # around the centre of mass, so that all forces can pass through it
        points = [0.5 * (np.cos(t) * u + np.sin(t) * v) for t in 2 * np.pi * np.arange(3) / 3]
        contacts.append(GivenContact((name, "wedge"), points, normal))
    mu = float(np.tan(np.radians(phi)))
    return Assembly([*held, block_], contacts=contacts, friction=mu, detect=False)


def test_i4_rock_wedge():
    static, true = 31.0744, 33.3572
    assert judged(rock_wedge(static - 0.01)).verdict == "unstable"
    for phi in (static + 0.01, 32.0, true - 0.05):
        verdict = judged(rock_wedge(phi))
        assert (verdict.verdict, verdict.guarantee) == ("potentially-stable", "refuted")
        assert verdict.seated == "runs-away"
    above = judged(rock_wedge(true + 0.05), effort=1)
    assert above.guarantee != "refuted"
    assert above.level in ("settles", "proved")


@pytest.mark.parametrize(
    ("ratio", "mu", "held"),
    [
        (0.200637, 0.98 * 0.309215, False),
        (0.200637, 1.02 * 0.309215, True),
        (0.15, 0.98 * 0.309215, False),
        (0.25, 0.98 * 0.309215, False),
        (0.98 * 0.107426, 1.02 * 0.395832, False),
        (1.02 * 0.107426, 1.02 * 0.395832, True),
    ],
)
def test_a2_arch_with_limited_friction(ratio, mu, held):
    # Cocchetti and Rizzi 2020, Table 3: rings of many sectors, in the plane
    verdict = judged(arch(80, ratio=ratio, friction=mu, sectors=True), effort=0)
    assert (verdict.verdict in ("stable", "settles", "potentially-stable")) == held
    assert (verdict.verdict == "unstable") != held
