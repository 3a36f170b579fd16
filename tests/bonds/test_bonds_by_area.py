"""Bonds by area: shares of corners, mortar in bending, forces, rejected input."""

from __future__ import annotations

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import kilter
from kilter import Assembly, Bond, Box, Part, Pose, Prism
from kilter.analysis.margins.uncertainty import Ranges
from kilter.mechanics.area_shares import area_shares

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
