"""Bonds by area and mortar."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from judged import judged

import kilter
from kilter import Assembly, Bond, Box, Part, Pose, Prism
from kilter.analysis.margins.uncertainty import Ranges
from kilter.mechanics.area_shares import area_shares
from kilter.scenes.mortar import BLOCK, DENSITY, N_PER_MM2, corbel, eccentric_pier, pier_in_wind

G, WEIGHT = 9.81, 9810.0
BOTH = pytest.mark.parametrize("share", [0.999, 1.001])


def cube(name, x=0.0, z=0.0, **more):
    return Part(name, Box([1, 1, 1]), Pose([x, 0, z]), **more)


def area_and_centroid(x, y):
    """Area and centroid of a polygon by the shoelace formula."""
    cross = x * np.roll(y, -1) - y * np.roll(x, -1)
    area = cross.sum() / 2
    middle = [((c + np.roll(c, -1)) * cross).sum() / (6 * area) for c in (x, y)]
    return area, np.array(middle)


ANGLES = st.lists(st.floats(0, 6.28), min_size=3, max_size=9, unique=True)


@pytest.mark.slow
@given(ANGLES, st.randoms(use_true_random=False))
def test_shares_have_the_area_and_its_centroid(angles, random):
    angles = np.sort(angles)
    if np.diff(angles, append=angles[0] + 2 * np.pi).min() < 1e-3:
        return
    x, y = 3 * np.cos(angles), 2 * np.sin(angles)
    area, middle = area_and_centroid(x, y)
    order = random.sample(range(len(x)), len(x))
    turn = np.linalg.qr(np.array([[1.0, 2, 3], [0, 1, 4], [5, 6, 0]]))[0]
    points = np.column_stack([x, y, np.full(len(x), 0.7)]) @ turn.T
    twice = np.concatenate([points[order], points])
    patch = np.repeat([0, 1], len(x))
    shares = area_shares(twice, patch, np.tile(turn[:, 2] * np.sign(np.linalg.det(turn)), (2, 1)))
    assert (shares >= 0).all()
    for own in (patch == 0, patch == 1):
        assert shares[own].sum() == pytest.approx(area, rel=1e-9)
        centroid = (shares[own] @ twice[own] / shares[own].sum()) @ turn
        assert np.allclose(centroid[:2], middle, atol=1e-9)


@pytest.mark.quick(2)
@BOTH
@pytest.mark.parametrize("kind", ["glue", "mortar"])
def test_a_mortar_joint_in_bending_takes_its_tension_times_half_its_height(share, kind):
    """Equilibrium W L / 2 = p (b h) h / 2 about the lower edge, where compression is unlimited."""
    length, height = 2.0, 0.5
    beam = Part("beam", Box([length, 1, height]), Pose([0.5 + length / 2, 0, 0]))
    weight = WEIGHT * length * height
    stress = share * (weight * length / 2) / (height * height / 2)
    mortar = Bond(("wall", "beam"), pull_per_area=stress, kind=kind)
    assembly = Assembly([cube("wall", grounded=True), beam], friction=5.0, bonds=[mortar])
    verdict = kilter.check(assembly, effort=0)
    assert (verdict.verdict == "unstable") is (share < 1)
    assert kilter.verify(assembly, json.loads(json.dumps(verdict.proof()))).holds


@BOTH
def test_a_prism_hangs_by_the_area_of_its_triangle(share):
    corners = [[0, 0], [1, 0], [0, 1]]
    low = Part("low", Prism(corners, 1.0))
    roof = Part("roof", Box([4, 1, 4]), Pose([0, 1, 0]), grounded=True)
    bond = Bond(("low", "roof"), pull_per_area=share * WEIGHT)
    verdict = kilter.check(Assembly([roof, low], gravity=[0, -G, 0], bonds=[bond]))
    assert verdict.verdict == ("unstable" if share < 1 else "stable")


def test_forces_tell_how_much_of_a_bond_they_use():
    parts = [cube("top", z=1.0, grounded=True), cube("low")]
    bond = Bond(("low", "top"), pull=WEIGHT)
    patch = kilter.check(Assembly(parts, bonds=[bond])).to_dict()["forces"]["patches"][0]
    assert patch["bond_utilisation"] == pytest.approx(0.25, abs=1e-6)
    parts = [cube("base", grounded=True), cube("top", z=1.0)]
    bond = Bond(("base", "top"), pull=WEIGHT)
    patch = kilter.check(Assembly(parts, bonds=[bond])).to_dict()["forces"]["patches"][0]
    assert patch["bond_utilisation"] == 0.0


def test_a_bond_by_area_of_what_is_not_flat_and_convex_is_refused():
    corners = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
    first = Part("first", Prism(corners, 1.0), grounded=True)
    second = Part("second", Prism(corners, 1.0), Pose([0, 1, 0]))
    bond = Bond(("first", "second"), pull_per_area=1.0)
    with pytest.raises(kilter.InputError, match="flat convex area"):
        kilter.check(Assembly([first, second], bonds=[bond]))


@pytest.mark.parametrize("options", [{"about": [0, 1, 0]}, {"ranges": Ranges(mass=(0.9, 1.1))}])
def test_a_margin_that_takes_gravity_for_all_there_is_takes_no_bonds(options):
    parts = [cube("top", z=1.0, grounded=True), cube("low")]
    with pytest.raises(kilter.InputError, match="does not support bonds"):
        kilter.margin(Assembly(parts, bonds=[Bond(("low", "top"), pull=WEIGHT)]), **options)


LENGTH, DEPTH, HEIGHT = BLOCK
AREA = LENGTH * DEPTH
WEIGHT_MORTAR = DENSITY * AREA * HEIGHT * 9.81


def corbel_strength(count, step):
    """The least tensile strength of the lowest joint [N/mm2]; negative if none is needed."""
    moment = count * WEIGHT_MORTAR * ((count + 1) * step - LENGTH) / 2
    return moment / (DEPTH * (LENGTH - step) ** 2 / 2) / N_PER_MM2


def greatest_wind(count, strength):
    """The largest wind pressure that the foot resists [N/m2]."""
    moment = (count * WEIGHT_MORTAR + strength * N_PER_MM2 * AREA) * DEPTH / 2
    return moment / (LENGTH * (count * HEIGHT) ** 2 / 2)


def greatest_eccentricity(load, strength):
    """The largest eccentricity that the upper joint resists [m]."""
    return LENGTH / 2 * (1 + (WEIGHT_MORTAR + strength * N_PER_MM2 * AREA) / load)


@pytest.mark.slow
@BOTH
@pytest.mark.parametrize(("count", "step"), [(1, 0.3), (5, 0.1), (8, 0.1), (12, 0.05)])
def test_courses_cantilever_by_the_tension_of_the_lowest_joint(count, step, share):
    assembly = corbel(count, step=step, strength=share * corbel_strength(count, step))
    assert judged(assembly).verdict == ("unstable" if share < 1 else "stable")


@pytest.mark.quick(1)
@BOTH
@pytest.mark.parametrize("count", [3, 7])
def test_dry_courses_cantilever_up_to_the_edge(count, share):
    """The limit (n + 1) step = b without tension."""
    assembly = corbel(count, step=share * LENGTH / (count + 1), strength=0.0)
    assert judged(assembly).verdict == ("stable" if share < 1 else "unstable")


@pytest.mark.slow
@BOTH
@pytest.mark.parametrize("strength", [0.0, 0.1])
def test_a_pier_in_wind_overturns_about_its_foot(strength, share):
    assembly = pier_in_wind(3, wind=share * greatest_wind(3, strength), strength=strength)
    verdict = judged(assembly, effort=0)
    assert (verdict.verdict == "unstable") is (share > 1)


@pytest.mark.quick(1)
@BOTH
@pytest.mark.parametrize("strength", [0.0, 0.1])
def test_a_resultant_leaves_the_section_by_what_the_mortar_bears(strength, share):
    limit = greatest_eccentricity(5000.0, strength)
    assembly = eccentric_pier(eccentricity=share * limit, strength=strength)
    assert judged(assembly).verdict == ("unstable" if share > 1 else "stable")


@pytest.mark.slow
def test_margins_say_the_closed_forms():
    """Margins of the examples: share of the tensile strength, and load factor."""
    options = {"pushed": [], "effort": 0}
    share = corbel_strength(8, 0.1) / 0.1
    assert kilter.margin(corbel(), **options).bond == pytest.approx(share, rel=1e-7)
    wind = kilter.margin(pier_in_wind(), **options)
    limit = greatest_wind(4, 0.1) / 2000
    assert wind.load_factor[1] == pytest.approx(limit, rel=1e-6)
    assert wind.bond == pytest.approx(
        (2000 / greatest_wind(4, 0.0) - 1) * 4 * WEIGHT_MORTAR / (0.1 * N_PER_MM2 * AREA), rel=1e-6
    )
    assert wind.bond_limit.opens[0].parts == wind.assembly.bonds[0].parts  # at the foot
    load = kilter.margin(eccentric_pier(), **options)
    beside = 0.25 - LENGTH / 2
    limit = (WEIGHT_MORTAR + 0.1 * N_PER_MM2 * AREA) * LENGTH / 2 / beside / 5000
    assert load.load_factor[1] == pytest.approx(limit, rel=1e-6)
    assert load.bond_limit.opens[0].parts == load.assembly.bonds[2].parts  # the upper joint


@pytest.mark.quick(1)
@BOTH
def test_a_pier_slides_where_friction_on_what_the_mortar_adds_is_too_little(share):
    """The wind on n courses against mu (n W + p A); the foot slides first."""
    strength, wind = 0.01, 2000.0
    slips = wind * LENGTH * HEIGHT * 3 / (3 * WEIGHT_MORTAR + strength * N_PER_MM2 * AREA)
    assembly = pier_in_wind(3, wind=wind, strength=strength, friction=share * slips)
    assert greatest_wind(3, strength) > wind
    verdict = judged(assembly, effort=0)
    assert (verdict.verdict == "unstable") is (share < 1)
