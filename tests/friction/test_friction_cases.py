"""Cases with friction: known levels on both sides of limits."""

import dataclasses
from functools import partial

import numpy as np
import pytest
from cases import program
from judged import judged
from random_friction import random_assembly
from transformations import tilted

import kilter
from kilter import Assembly, FrictionPair, GivenContact, Joint, Load, Pose, check
from kilter.contact import detect
from kilter.friction.answer import ask_friction
from kilter.friction.exclusion import Exclusion, prove_no_motion
from kilter.friction.motion_search import MOST_POINTS
from kilter.friction.seating import find_seating
from kilter.mechanics.law_check import check_law
from kilter.mechanics.program import build_program
from kilter.scenes import arches, friction, stacks, walls
from kilter.scenes import traps as rounds
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block, floor
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


SEEDS = range(20)
EFFORT = 0.5


def rougher(assembly, factor):
    """The assembly with every coefficient raised."""
    pairs = [FrictionPair(pair.parts, factor * pair.mu) for pair in assembly.friction_pairs]
    contacts = [
        dataclasses.replace(c, mu=None if c.mu is None else factor * c.mu)
        for c in assembly.contacts
    ]
    return dataclasses.replace(
        assembly,
        friction=factor * assembly.friction,
        friction_pairs=pairs,
        contacts=contacts,
    )


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", SEEDS)
def test_a_verdict_and_its_opposite_never_both(seed):
    _, assembly = random_assembly(seed)
    verdict = judged(assembly, effort=EFFORT)
    assert verdict.verdict != "undecided"
    if verdict.friction is None:
        return
    if verdict.guarantee == "proved":
        assert find_seating(verdict.program).holds
    if verdict.guarantee == "refuted":
        witness = verdict.friction.witness
        assert witness.law.holds
        # a.M a <= w.a for every solution of the law, in units of |w|^2 of the parts that move
        assert witness.law.size <= witness.law.power * (1 + 1e-6) + 1e-9
        assert not prove_no_motion(verdict.program, work=EFFORT).proved


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_more_friction_never_takes_equilibrium_away(seed):
    _, assembly = random_assembly(seed)
    words = [check(rougher(assembly, f), effort=0).verdict for f in (0.0, 0.5, 1.0, 2.0)]
    held = [word in ("stable", "settles", "potentially-stable") for word in words]
    assert held == sorted(held)
    if words[0] == "stable":
        assert set(words) == {"stable"}


@pytest.mark.slow
def test_forces_shown_balance_and_stay_in_their_cones():
    for seed in SEEDS[:20]:
        _, assembly = random_assembly(seed)
        verdict = check(assembly, effort=0)
        if verdict.level is None:
            continue
        found = verdict.forces
        program = build_program(assembly, detect.contacts(assembly))
        mu = verdict.program.mu[found.rows]
        normal = verdict.program.normal[found.rows]
        push = np.einsum("ij,ij->i", found.force, normal)
        aside = np.linalg.norm(found.force - push[:, None] * normal, axis=1)
        assert (push >= 0).all()
        assert (aside <= mu * push + 1e-9 * np.abs(push) + 1e-12).all()
        assert found.residual <= float(program.tolerance.max())
        assert np.nanmax(found.utilisation, initial=0.0) <= 1 + 1e-6


INSIDE, OUTSIDE = 0.98, 1.02
THINNEST = 0.10743
"""Thickness of a semicircle of 40 voussoirs over the radius of its middle line."""


def degrees(tangent):
    return float(np.degrees(np.arctan(tangent)))


def slope(share, mu, width):
    """S1: tan = min(mu, width / height)."""
    return stacks.block_on_slope(degrees(share * min(mu, width)), width=width, friction=mu)


def tower(share, count, planar=False):
    """S2: tan = 1 / count; it does not slide before."""
    made = tilted(stacks.tower(count).with_friction(0.9), [0, 1, 0], degrees(share / count))
    return dataclasses.replace(made, planar=planar)


def ladder(share, mu_wall, planar=False):
    """S4: tan = (1 - mu_floor mu_wall) / (2 mu_floor); steeper is safer."""
    least = degrees((1 - 0.4 * mu_wall) / 0.8 / share)
    return friction.ladder(least, friction_wall=mu_wall, planar=planar)


def bracket(share):
    """S5: the load stands off by h / (2 mu) at least."""
    return friction.bracket(1 / (2 * 0.6) / share, friction=0.6, pad=1e-4)


def books(share, count, thickness):
    """S6: pressed by n w / (2 mu) and n^2 w t / (8 h) at least."""
    weight, height, mu = 9.81, 0.25, 0.5
    least = max(count * weight / (2 * mu), count**2 * weight * thickness / (8 * height))
    return friction.books(
        count, force=least / share, friction=mu, thickness=thickness, height=height
    )


def leaning_wall(share, mu, limit):
    """S7: nine courses overturn at atan W / 9 H, or slide at atan mu."""
    return walls.tilted_wall(share * limit, friction=mu, per_course=2)


def between_plates(share):
    """I2: mu = tan of the half angle."""
    return friction.a_block(10.0, friction=float(np.tan(np.radians(10.0))) / share)


def between_walls(share):
    """I1: any mu above 0."""
    return friction.h_block(friction=max(1.0 - share, 0.0))


def arch_levels(share):
    """A1: the least thickness of a semicircle."""
    return arches.arch(40, ratio=THINNEST / share, friction=0.7, planar=True)


def ring(share):
    """A2: the same as sectors of a ring, with friction just above the least that suffices."""
    return arches.arch(80, ratio=THINNEST / share, friction=0.4, sectors=True, planar=True)


LIMITS = {
    "S1 slides": (partial(slope, mu=0.5, width=2.0), {"proved"}),
    "S1 slides soon": (partial(slope, mu=0.2, width=1.0), {"proved"}),
    "S1 tips": (partial(slope, mu=0.9, width=0.5), {"proved"}),
    "S2 of 3": (partial(tower, count=3), {"proved"}),
    "S2 of 10, plane": (partial(tower, count=10, planar=True), {"proved"}),
    "S4": (partial(ladder, mu_wall=0.0), {"proved"}),
    "S4 rough wall, plane": (partial(ladder, mu_wall=0.3, planar=True), {"proved"}),
    "S5": (bracket, {"equilibrium"}),
    "S6 slip": (partial(books, count=4, thickness=0.05), {"equilibrium"}),
    "I1": (between_walls, {"equilibrium"}),
    "I2": (between_plates, {"equilibrium"}),
}
"""Builder of a share of the limit; the level inside."""
LONG = {
    "S2 of 10": (partial(tower, count=10), {"settles"}),
    "S4 rough wall": (partial(ladder, mu_wall=0.3), {"settles"}),
    "S6 sag": (partial(books, count=12, thickness=0.25), {"settles"}),
    "S7 overturns": (partial(leaning_wall, mu=0.6, limit=degrees(0.1 / 0.54)), {"settles"}),
    "S7 slides": (partial(leaning_wall, mu=0.15, limit=degrees(0.15)), {"settles"}),
    "A1": (arch_levels, {"settles", "proved"}),
    "A2": (ring, {"settles", "proved"}),
}


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [*LIMITS, *(pytest.param(name, marks=pytest.mark.slow) for name in LONG)]
)
def test_both_sides_of_a_limit_have_their_levels(name):
    build, levels = {**LIMITS, **LONG}[name]
    inside, outside = judged(build(INSIDE)), judged(build(OUTSIDE))
    assert inside.level in levels
    assert (outside.verdict, outside.level) == ("unstable", None)
    if inside.level == "equilibrium":
        assert inside.why == "refuted"
        # books settle, though a motion of small power exists
        assert inside.tries.passed == (8 if name.startswith("S6") else 0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tilt", "level"),
    [(44.126 - 0.05, "proved"), (44.126 + 0.05, "equilibrium"), (47.961 - 0.05, "equilibrium"),
     (47.961 + 0.05, None)],
)  # fmt: skip
def test_i3_a_trough_passes_through_three_levels(tilt, level):
    """It slips at tan = mu / cos beta; forces exist up to tan = mu / (cos^2 - mu^2 sin^2)^1/2."""
    assert judged(friction.trough(30.0, tilt=tilt, friction=0.84)).level == level


MU, WEIGHT = 0.5, 4 * 0.1 * 1000 * 9.81


def plate(tiles: int, torque: float) -> Assembly:
    """A plate 2 x 2 x 0.1 of joined tiles on a floor, with a torque about the vertical axis."""
    edge = np.linspace(-1.0, 1.0, tiles + 1)
    parts = [
        block(f"tile-{i}-{j}", [edge[i], edge[j], 0], [edge[i + 1], edge[j + 1], 0.1])
        for i in range(tiles)
        for j in range(tiles)
    ]
    first = parts[0].name
    joints = [Joint((first, part.name)) for part in parts[1:]]
    load = Load(first, torque=[0, 0, torque])
    return Assembly([floor([-3, -3], [3, 3]), *parts], friction=MU, joints=joints, loads=[load])


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.35, 0.6])
def test_a_plate_that_may_spin_about_its_middle_tile_is_not_proved(share):
    """The corners of the middle tile resist a fifth of what the corners of the plate resist."""
    found = kilter.check(plate(5, share * MU * WEIGHT * np.sqrt(2)))
    assert found.level in ("settles", "equilibrium")


def test_a_single_tile_is_proved():
    assert kilter.check(plate(1, 0.35 * MU * WEIGHT * np.sqrt(2))).level == "proved"


@pytest.fixture(scope="module")
def tilted_friction():
    """A leaning wall of 16 bricks."""
    return walls.tilted_wall(8.0, friction=0.6, courses=4, per_course=4)


def test_only_the_search_of_a_motion_is_left_out_if_one_program_exceeds_the_limit(
    tilted_friction, monkeypatch
):
    monkeypatch.setattr("kilter.friction.answer.CONIC_STEPS", 10_000_000)
    monkeypatch.setattr("kilter.friction.answer.SEARCHED", 100)
    monkeypatch.setattr("kilter.friction.answer.find_coulomb_motion", None)  # a call of it fails
    answer = ask_friction(program(tilted_friction), work=2.0)
    assert (answer.guarantee, answer.seating.seated, answer.settles) == ("open", "yes", True)


def test_an_assembly_that_settles_is_searched_for_a_motion_if_it_is_small_or_on_request(
    tilted_friction, monkeypatch
):
    monkeypatch.setattr("kilter.friction.answer.SEARCHED", 100)
    built, searched = program(tilted_friction), []
    unproved = Exclusion(False, None, 0, 0, 1.0, "", 0.0)
    monkeypatch.setattr("kilter.friction.answer.prove_no_motion", lambda *_, **__: unproved)
    monkeypatch.setattr(
        "kilter.friction.answer.find_coulomb_motion", lambda *_, only, **__: searched.append(only)
    )
    assert ask_friction(built).settles
    assert searched == []
    ask_friction(built, work=1.5)
    assert searched == ["starts", "modes"]
    ask_friction(program(walls.tilted_wall(8.0, friction=0.6, courses=2, per_course=2)))
    assert searched == ["starts", "modes"] * 2


def test_a_proof_whose_cases_cost_too_much_is_not_begun(tilted_friction, monkeypatch):
    built = program(tilted_friction)
    monkeypatch.setattr("kilter.friction.exclusion.reduced_law", None)  # a call of it fails
    exclusion = prove_no_motion(built)
    assert (exclusion.proved, exclusion.bound, exclusion.programs) == (False, 1.0, 0)
    with pytest.raises(TypeError):
        prove_no_motion(built, work=5.0)


COPIES = 24
SLIPS_AT = float(np.degrees(np.arctan(0.84 / np.cos(np.radians(30.0)))))
"""Tilt of a trough of 30 deg at which its prism slips [deg]; equilibrium forces exist to 46.6."""


def troughs(tilts: list[float]) -> Assembly:
    """Separate troughs side by side; gravity leans as for the first, the others are turned."""
    parts = []
    for k, tilt in enumerate(tilts):
        half = np.radians(tilts[0] - tilt) / 2
        turn = [np.cos(half), np.sin(half), 0.0, 0.0]
        pose = Pose([5.0 * k, 0.0, 0.0], turn)
        for part in friction.trough(30.0).parts:
            placed = pose @ part.pose
            parts.append(dataclasses.replace(part, name=f"{part.name}-{k}", pose=placed))
    angle = np.radians(tilts[0])
    gravity = [0.0, 9.81 * np.sin(angle), -9.81 * np.cos(angle)]
    return Assembly(parts, gravity=gravity, friction=0.84)


@pytest.mark.slow
@pytest.mark.parametrize(("which", "over"), [(0, 0.05), (13, 0.05), (5, 1.0)])
def test_one_prism_that_slips_among_many_limits_the_level(which, over):
    """Whether its motion is found or not, the verdict must not exclude it."""
    tilts = [SLIPS_AT - 2.0] * COPIES
    tilts[which] = SLIPS_AT + over
    verdict = kilter.check(troughs(tilts))
    assert len(verdict.program.part_a) > MOST_POINTS
    assert (verdict.verdict, verdict.level) == ("potentially-stable", "equilibrium")
    witness = verdict.friction.witness
    if witness is not None:
        assert check_law(verdict.program, witness.acceleration, witness.forces).holds


@pytest.mark.slow
def test_many_prisms_that_cannot_slip_are_not_refuted():
    verdict = kilter.check(troughs([SLIPS_AT - 0.05] * COPIES))
    assert len(verdict.program.part_a) > MOST_POINTS
    assert verdict.guarantee != "refuted"
    assert verdict.level in ("settles", "proved", "strict")
