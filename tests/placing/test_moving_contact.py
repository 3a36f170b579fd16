"""Contacts that move with a placed prism: rates, forces between places, maps, spikes."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from planks import bridge

import kilter
from kilter import Assembly, Box, Part, Pose, Prism
from kilter.analysis.placing.case_maps import case_prism
from kilter.analysis.placing.landings import Landings
from kilter.analysis.placing.moving_contact import least_rates, places_left
from kilter.analysis.placing.moving_load import MovingLoad
from kilter.analysis.placing.place import place
from kilter.analysis.placing.placed_loads import PlacedLoads
from kilter.analysis.placing.polygon_sets import both, cleaned, without
from kilter.analysis.placing.upright_prisms import edges_of, find_tops, shifted
from kilter.contact import detect
from kilter.mechanics.program import build_program

PENTAGON = np.array([[0.42, 0.05], [0.1, 0.4], [-0.38, 0.2], [-0.3, -0.25], [0.16, -0.4]])
LOW, HIGH = np.array([-0.03, -0.05]), np.array([0.07, 0.06])


def convex(rng: np.random.Generator) -> np.ndarray:
    """Corners of a random convex polygon about the origin."""
    angles = np.sort(rng.uniform(0, 2 * np.pi, 6))
    return np.column_stack([np.cos(angles), np.sin(angles)]) * rng.uniform(0.5, 1.5)


def pentagon() -> Part:
    """An irregular prism with its axis along the vertical."""
    return Part("prism", Prism(PENTAGON, 0.2), Pose([0, 0, 0], [0.5**0.5, 0.5**0.5, 0, 0]), mass=3)


def load_on_bridge(low: np.ndarray = LOW, high: np.ndarray = HIGH) -> MovingLoad:
    """The prism on the two planks of a bridge, in a rectangle of places."""
    assembly = bridge()
    prism, _ = case_prism(pentagon(), "m")
    tops = [top for top in find_tops(assembly) if "plank" in assembly.names[top.part]]
    loads = PlacedLoads(build_program(assembly, detect.contacts(assembly)), prism, 0.0)
    areas = Landings(tops, prism, 1e-6).areas(tops, low, high, any_place=True)
    return MovingLoad.of_areas(loads, tops, areas, 0.1, low, high)


@pytest.mark.parametrize("seed", range(20))
def test_the_least_rate_in_a_contact_is_that_at_a_corner_of_the_overlap(seed: int) -> None:
    rng = np.random.default_rng(seed)
    top, part = convex(rng), convex(rng)
    constant, gradient = rng.normal(), rng.normal(size=2)
    rows = least_rates(edges_of(top), edges_of(part), constant, gradient)
    for _ in range(20):
        place_ = rng.uniform(-1, 1, 2)
        overlap = both(shapely.Polygon(top), shapely.Polygon(part + place_))
        if overlap.area < 1e-6:
            continue
        least = (constant + shapely.get_coordinates(overlap) @ gradient).min()
        assert (rows @ [1, *place_]).max() == pytest.approx(least, abs=1e-9)


def test_forces_between_proved_places_press_within_the_contact() -> None:
    load = load_on_bridge()
    found = load.places_of(1e-3, shapely.box(*LOW, *HIGH))
    known = len(load.loads.program.part_a)
    places = np.array([at for at, _ in found.points])
    forces = np.array([proof.forces[known:] for _, proof in found.points])
    assert found.inner.area > 0
    corners = np.concatenate([shapely.get_coordinates(a)[:-1] for a in load.contact.areas.values()])
    rng = np.random.default_rng(1)
    for weights in rng.dirichlet(np.full(len(places), 0.3), 200):
        at, force = weights @ places, weights @ forces
        under = shifted(load.loads.part.footprint, at.tolist())
        for k, area in enumerate(load.contact.areas.values()):
            on = load.contact.top_of == k
            if force[on].sum() < 1e-6:
                continue
            center = force[on] @ corners[on] / force[on].sum()
            assert shapely.distance(shapely.Point(center), both(area, under)) < 1e-7


def test_forces_that_press_beside_the_contact_are_no_proof() -> None:
    load = load_on_bridge()
    found = load.places_of(1e-3, shapely.box(*LOW, *HIGH))
    at, proof = found.points[0]
    shift = at - (LOW + HIGH) / 2
    forces = proof.forces[len(load.loads.program.part_a) :]
    weight = load.loads.part.mass * load.program.g
    assert load.contact.holds(load.shares, weight, shift, forces)
    assert not load.contact.holds(np.array([2.0, -1.0]), weight, shift, forces)
    outer = load.contact.room.min(axis=1).argmin()
    beside = np.where(np.arange(len(forces)) == outer, weight, 0.0)
    assert not load.contact.holds(load.shares, weight, shift, beside)


@pytest.mark.parametrize(
    ("low", "high"), [((0.06, -0.05), (0.1, 0.05)), ((0.07, -0.3), (0.12, 0.3))]
)
def test_a_motion_excludes_no_place_that_stands(
    low: tuple[float, float], high: tuple[float, float]
) -> None:
    """Each motion excludes some places of the rectangle, and at each of them check finds a fall."""
    least, most = np.array(low), np.array(high)
    load, whole = load_on_bridge(least, most), shapely.box(*least, *most)
    motions = load.places_of(1e-3, whole).motions
    assert motions
    rng = np.random.default_rng(2)
    for motion in motions:
        left = places_left(load.loads, load.tops, 0.1, least, most, motion)
        beyond = without(whole, left.buffer(1e-6))
        points = rng.uniform(least, most, (200, 2))
        outside = points[shapely.contains_xy(beyond, points[:, 0], points[:, 1])][:5]
        assert len(outside) == 5
        for point in outside:
            at = place(bridge(), pentagon(), at=point, require="equilibrium").at
            assert at is not None
            assert at.verdict == "unstable"


def test_the_map_of_a_prism_on_two_planks_agrees_with_check_on_both_sides() -> None:
    places = place(bridge(), pentagon(), accuracy=0.04)
    assert kilter.verify(bridge(), places.proof()).holds
    level = places.levels[-1]
    rng = np.random.default_rng(3)
    low, high = np.array([-0.2, -0.6]), np.array([0.2, 0.6])
    points = rng.uniform(low, high, (30, 2))
    seen = set()
    for point in points:
        here = shapely.Point(point)
        stands, falls = level.stands.contains(here), level.falls.contains(here)
        assert not (stands and falls)
        if stands or falls:
            at = place(bridge(), pentagon(), at=point, require="equilibrium").at
            assert at is not None
            assert (at.verdict != "unstable") == stands
            seen.add(stands)
    assert seen == {True, False}


@pytest.mark.parametrize("accuracy", [0.05, pytest.param(0.005, marks=pytest.mark.slow)])
def test_the_open_strip_is_thinner_than_the_accuracy(accuracy: float) -> None:
    for level in place(bridge(), pentagon(), accuracy=accuracy).levels:
        for piece in shapely.get_parts(level.open):
            assert piece.buffer(-accuracy / 2).is_empty


def test_a_prism_on_a_third_top_of_the_same_height() -> None:
    """Three held tables: a prism stands exactly if its centre is in the hull of its contact."""
    centers = ((-0.45, 0.3), (0.45, 0.3), (0.0, -0.5))
    tables = [
        Part(f"table-{k}", Box([0.5, 0.4, 1]), Pose([x, y, -0.5]), grounded=True)
        for k, (x, y) in enumerate(centers)
    ]
    assembly = Assembly(tables)
    prism, _ = case_prism(pentagon(), "m")
    places = place(assembly, pentagon(), accuracy=0.03)
    [level] = places.levels
    rng, seen = np.random.default_rng(4), set()
    tops = shapely.MultiPolygon([top.polygon for top in find_tops(assembly)])
    for point in rng.uniform(-0.5, 0.5, (300, 2)):
        contact = shapely.intersection(tops, shifted(prism.footprint, point.tolist()))
        here = shapely.Point(point)
        if contact.is_empty or level.open.contains(here):
            continue
        inside = shapely.convex_hull(contact).contains(here)
        assert level.stands.contains(here) == inside
        assert level.falls.contains(here) == (not inside)
        seen.add(inside)
    assert seen == {True, False}


def test_a_spike_of_an_area_of_places_vanishes() -> None:
    """A piece of a map in which the difference of areas left two spikes of no width.

    GEOS calls it valid, but its intersection with the rectangle lies outside of it.
    """
    spiked = shapely.Polygon(
        [
            (-0.2092163637050465, -2.599366285572575), (-0.8431427351196501, -3.0934141445739893),
            (-0.2092163637050466, -2.599366285572575), (-0.2466630848282979, -2.570043740680293),
            (0.2182935762119457, -1.5843588687687042), (0.5124906915523475, -0.9606756951535974),
            (0.361612689199225, -1.696584478873781), (-0.0889511395625211, -2.505638087505422),
            (-0.2092163637050465, -2.599366285572575), (1.1455337699205863, -3.6601993951074183),
        ]
    )  # fmt: skip
    clean = cleaned(spiked)
    assert clean.is_valid
    assert clean.bounds[1] == pytest.approx(-2.599366285572575, abs=1e-9)
    rectangle = shapely.box(-0.85, -3.21, -0.58, -3.04)
    assert both(clean, rectangle).is_empty
    assert shapely.contains(clean, shapely.Point(0.1, -2.0))
