"""Known answers with friction, on both sides of every limit; each verdict is verified again."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from judged import judged

from kilter.assembly import Assembly, GivenContact
from kilter.scenes import friction, rounds, stacks
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block
from sampled import sampled


def planar(assembly):
    return dataclasses.replace(assembly, planar=True)


@pytest.mark.quick(1)
@pytest.mark.parametrize("azimuth", [0.0, 22.5, 45.0])
@pytest.mark.parametrize(("angle", "word"), [(28.0, "unstable"), (26.0, "stable")])
def test_w4_w5_slope_to_every_side(angle, word, azimuth):
    slope = stacks.block_on_slope(angle, azimuth=azimuth, friction=0.5)
    assert judged(slope).verdict == word


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize("name", sampled(1, PILES))
def test_r1_r2_piles_of_round_parts(name):
    for pile in piles(name, 0.98):
        assert judged(pile).verdict == "unstable"
    for pile in piles(name, 1 / 0.98):
        # cylinders in space may yaw while they slide, by which friction along their way is less
        held = judged(planar(pile) if name == "cylinders" else pile, effort=1)
        assert held.level in ("settles", "proved")
        assert name != "cylinders" or judged(pile, effort=1).level is not None


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


@pytest.mark.slow
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


@pytest.mark.slow
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
