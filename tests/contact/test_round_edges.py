"""Parts that tip over round edges: the tilt, and limits of a carrier, against the circle."""

from __future__ import annotations

import numpy as np
import pytest
from solids import bore, cone_frustum, peg

import kilter
from kilter import Assembly, Box, Cylinder, Part, Pose
from kilter.analysis.margins.margin_answer import Margin
from kilter.analysis.margins.turned_forces import held_distance
from kilter.analysis.transport.carried_set import CarriedSet, LeastAcceleration
from kilter.contact import contacts
from kilter.contact.round_edges import round_edges
from kilter.mechanics.program import build_program
from kilter.scenes.pieces import turn
from kilter.scenes.transform import moved
from kilter.shape.primitives import Mesh

TABLE = Part("table", Box(20, 20, 1), [0, 0, -0.5], grounded=True)


def standing(shape: object, low: float, center: list[float], mu: float = 9.0) -> Assembly:
    """A part whose lowest level is `low` on a table, with a centre of mass over this level."""
    own = [center[0], center[1], center[2] + low]
    body = Part("body", shape, Pose([0, 0, -low]), center_of_mass=own, mass=1.0)  # type: ignore[arg-type]
    return Assembly([TABLE, body], friction=mu)


def tilt_of(assembly: Assembly) -> Margin:
    return kilter.margin(assembly, pushed=[])


BODIES = {
    "cylinder": lambda: (Cylinder(1, 4), -2.0, 1.0),
    "ring": lambda: (bore(), -1.0, 3.0),
    "frustum": lambda: (cone_frustum(), 1.0, float(np.tan(0.4))),
    "coarse": lambda: (peg(radius=2.0, low=0.0, high=1.0, sides=17), 0.0, 2.0),
}
CENTERS = [[0.0, 0.0, 1.7], [0.12, -0.2, 1.1]]


@pytest.mark.slow
@pytest.mark.parametrize("center", CENTERS, ids=["0", "1"])
@pytest.mark.parametrize("name", BODIES)
def test_a_part_tips_over_the_circle(name: str, center: list[float]) -> None:
    shape, low, radius = BODIES[name]()
    body = standing(shape, low, center)
    aside = np.array(center[:2])
    found = tilt_of(body)
    expected = np.degrees(np.arctan((radius - np.hypot(*aside)) / center[2]))
    assert found.tilt_deg == pytest.approx(expected, abs=2e-6)
    assert found.tilt is not None
    assert np.degrees(found.tilt.lower) == pytest.approx(expected, abs=1e-4)
    assert found.tilt.lower <= np.radians(expected) + 1e-12
    assert found.exact
    if name == "coarse":  # the polygons are farther from the circle than any proof is tried
        with pytest.raises(kilter.InputError, match="no proof"):
            found.proof()
    else:
        assert kilter.verify(body, found.proof()).holds


@pytest.mark.quick(1)
@pytest.mark.parametrize("angle", [0.3, 2.0, 4.4])
def test_a_carrier_tips_it_over_the_circle_in_each_direction(angle: float) -> None:
    aside, height = np.array([0.12, -0.2]), 1.1
    body = standing(Cylinder(1, 4), -2.0, [*aside, height], mu=3.0)
    touching = contacts(body)
    carried = CarriedSet(build_program(body, touching), edges=round_edges(body, touching))
    direction = np.array([np.cos(angle), np.sin(angle)])
    along = aside @ direction  # inertia presses against the acceleration
    reach = -along + np.sqrt(along**2 - aside @ aside + 1.0)
    found = carried.along([*-direction, 0.0])
    assert found.value == pytest.approx(reach / height, rel=1e-7)


@pytest.mark.slow
def test_an_edge_ends_where_its_table_ends() -> None:
    """The table ends at x = 0.4, so the part tips over a line there, and else over the circle."""
    table = Part("table", Box(10, 10, 1), [-4.6, 0, -0.5], grounded=True)
    stand = standing(Cylinder(1, 4), -2.0, [-0.25, 0.0, 2.0])
    cut = Assembly([table, stand.parts[1]], friction=9.0)
    edge = round_edges(cut, contacts(cut))[0]
    points = [[np.cos(angle), np.sin(angle), 0.0] for angle in (2.0, 3.0, 4.0, 0.0, 0.9)]
    on = edge.contains(np.array([edge.angle(np.array(point)) for point in points]))
    assert on.tolist() == [True, True, True, False, False]
    assert tilt_of(cut).tilt_deg == pytest.approx(np.degrees(np.arctan(0.65 / 2)), abs=1e-6)
    nearer = Assembly(
        [table, standing(Cylinder(1, 4), -2.0, [-0.5, 0, 2.0]).parts[1]], friction=9.0
    )
    assert tilt_of(nearer).tilt_deg == pytest.approx(np.degrees(np.arctan(0.25)), abs=1e-6)
    assert not tilt_of(nearer).exact  # two chords remain beside the cut


@pytest.mark.slow
def test_the_circle_is_that_of_the_smaller_face() -> None:
    for upper, lower, radius, height in ((1.0, 0.7, 0.7, 3.0), (1.0, 1.0, 1.0, 5.0)):
        parts = [
            TABLE,
            Part("lower", Cylinder(lower, 4), [0, 0, 2], grounded=height == 3.0),
            Part("upper", Cylinder(upper, 6), [0, 0, 7]),
        ]
        found = tilt_of(Assembly(parts, friction=1.0 if height == 3.0 else 3.0))
        expected = np.degrees(np.arctan(radius / height))
        assert found.tilt_deg == pytest.approx(expected, abs=2e-6)


@pytest.mark.slow
def test_a_mesh_remains_a_polygon_and_says_so() -> None:
    vertices, triangles = kilter.shape.primitives.surface(Cylinder(1, 4))
    found = tilt_of(standing(Mesh(vertices, triangles), -2.0, [0, 0, 2.0]))
    assert not found.exact
    assert found.tilt_deg < np.degrees(np.arctan(0.5)) - 1e-3


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(4))
def test_a_slip_in_all_directions_is_bracketed(seed: int) -> None:
    """Boxes in a column slip at mu g whatever their heights and offsets."""
    rng = np.random.default_rng([55, seed])
    parts, height = [TABLE], 0.0
    for k in range(3):
        aside = np.array([-2.0 + 0.3 * k, -1.8 + 0.2 * k]) + rng.uniform(0, 0.1, 2)
        low = np.array([*aside, height])
        size = np.array([3.6 - 0.5 * k, 3.4 - 0.5 * k, rng.uniform(0.3, 0.8)])
        parts.append(Part(f"box-{k}", Box(*size), low + size / 2))
        height += size[2]
    load = moved(Assembly(parts, friction=0.27), turn([0.2, 0.4, 1.0], 33.0))
    found = CarriedSet(build_program(load, contacts(load))).least()
    assert isinstance(found, LeastAcceleration)
    assert found.value == pytest.approx(0.27, rel=1e-7)
    assert found.lower == pytest.approx(0.27, rel=2e-6)
    assert found.lower <= 0.27 + 1e-12


def test_no_distance_is_proved_beyond_the_limit() -> None:
    body = standing(Cylinder(1, 4), -2.0, [0.0, 0.0, 1.0], mu=0.4)
    touching = contacts(body)
    program, edges = build_program(body, touching), round_edges(body, touching)
    carried = CarriedSet(program, edges=edges)
    angle = 2 * np.pi * np.arange(16) / 16
    directions = np.column_stack([np.cos(angle), np.sin(angle)])
    known = [(d, carried.along([*d, 0.0])) for d in directions]
    assert held_distance(program, edges, known, 0.4 * (1 - 1e-9)) == pytest.approx(0.4, rel=1e-6)
    assert held_distance(program, edges, known, 0.4 * (1 + 1e-6)) == 0.0
    assert held_distance(program, edges, known[:8], 0.39) == 0.0  # a half of the directions
    twice = [*known, known[3]]
    assert held_distance(program, edges, twice, 0.4 * (1 - 1e-9)) == pytest.approx(0.4, rel=1e-6)
