"""Masonry with tension: closed forms of corbels and piers, on both sides, and as margins."""

from __future__ import annotations

import pytest
from judged import judged

import kilter
from kilter.scenes.mortar import BLOCK, DENSITY, N_PER_MM2, corbel, eccentric_pier, pier_in_wind

LENGTH, DEPTH, HEIGHT = BLOCK
AREA = LENGTH * DEPTH
WEIGHT = DENSITY * AREA * HEIGHT * 9.81
BOTH = pytest.mark.parametrize("share", [0.999, 1.001])


def corbel_strength(count, step):
    """The least tensile strength of the lowest joint [N/mm2]; negative if none is needed."""
    moment = count * WEIGHT * ((count + 1) * step - LENGTH) / 2
    return moment / (DEPTH * (LENGTH - step) ** 2 / 2) / N_PER_MM2


def greatest_wind(count, strength):
    """The largest wind pressure that the foot resists [N/m2]."""
    moment = (count * WEIGHT + strength * N_PER_MM2 * AREA) * DEPTH / 2
    return moment / (LENGTH * (count * HEIGHT) ** 2 / 2)


def greatest_eccentricity(load, strength):
    """The largest eccentricity that the upper joint resists [m]."""
    return LENGTH / 2 * (1 + (WEIGHT + strength * N_PER_MM2 * AREA) / load)


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
        (2000 / greatest_wind(4, 0.0) - 1) * 4 * WEIGHT / (0.1 * N_PER_MM2 * AREA), rel=1e-6
    )
    assert wind.bond_limit.opens[0].parts == wind.assembly.bonds[0].parts  # at the foot
    load = kilter.margin(eccentric_pier(), **options)
    beside = 0.25 - LENGTH / 2
    limit = (WEIGHT + 0.1 * N_PER_MM2 * AREA) * LENGTH / 2 / beside / 5000
    assert load.load_factor[1] == pytest.approx(limit, rel=1e-6)
    assert load.bond_limit.opens[0].parts == load.assembly.bonds[2].parts  # the upper joint


@pytest.mark.quick(1)
@BOTH
def test_a_pier_slides_where_friction_on_what_the_mortar_adds_is_too_little(share):
    """The wind on n courses against mu (n W + p A); the foot slides first."""
    strength, wind = 0.01, 2000.0
    slips = wind * LENGTH * HEIGHT * 3 / (3 * WEIGHT + strength * N_PER_MM2 * AREA)
    assembly = pier_in_wind(3, wind=wind, strength=strength, friction=share * slips)
    assert greatest_wind(3, strength) > wind
    verdict = judged(assembly, effort=0)
    assert (verdict.verdict == "unstable") is (share < 1)
