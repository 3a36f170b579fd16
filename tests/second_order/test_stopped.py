"""Parts that a stop keeps from sliding off and falling: a box over the edge of its table."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from places import case_of, moved
from scipy.spatial.transform import Rotation

import kilter
from kilter import Assembly, Box, Cylinder, Part, Pose, Sphere
from kilter.arrays import Array, Mask
from kilter.mechanics.program import build_program
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.gap_form import gap_forms
from kilter.second_order.gaps.stationary import Stationary, stationary
from kilter.second_order.gaps.touched_surfaces import UNKNOWN, Touched, touched_surfaces
from kilter.second_order.motions.free_motions import find_free_motions
from kilter.second_order.motions.free_span import free_span
from kilter.second_order.proofs.stopped import level_contacts, level_motions
from kilter.second_order.searches.stopping_weights import find_stopped

STOP = 0.15
"""Height of the stop: it also keeps the box from tipping, so its centre may be twice as high
(E = STOP t^2 - h t^2 / 2 if it tips by t and stays at the stop).
"""


def overhanging(height: float, *, stop: float | None = STOP, slid: float = 0.0) -> Assembly:
    """A box on a table that ends below its centre of mass, which is `height` above the table."""
    parts = [
        Part("table", Box([2, 2, 1]), Pose([-1, 0, -0.5]), grounded=True),
        Part("box", Box([2, 1, 1]), Pose([-slid, 0, 0.5]), mass=1.0,
             center_of_mass=[0, 0, height - 0.5]),
    ]  # fmt: skip
    if stop is not None:
        at = Pose([1.5 - slid, 0, stop - 1])
        parts.append(Part("stop", Box([1, 2, 2]), at, grounded=True))
    return Assembly(parts)


def state(assembly: Assembly) -> str:
    second = kilter.check(assembly).second_order_answer
    assert second is not None
    return second.state


@pytest.mark.slow
def test_a_stop_holds_up_to_twice_its_height() -> None:
    for off in (0.1, 1e-3):
        assert state(overhanging(2 * STOP - off)) == "free"
        assert state(overhanging(2 * STOP + off)) in {"balanced", "open" if off < 0.01 else ""}
        assert state(overhanging(2 * STOP - off, stop=None)) == "balanced"
    assert state(overhanging(0.6, slid=0.1)) == "free"
    assert state(overhanging(0.6, slid=0.1, stop=None)) == "free"


@pytest.mark.quick(1)
@pytest.mark.parametrize("height", [-0.4, -0.01, 0.01, 0.4])
def test_exact_places_of_a_box_over_an_edge_agree(height: float) -> None:
    """The height of the centre over random places, with the box on the table x <= 0."""
    rng = np.random.default_rng(5)
    bottom = np.array([[x, y, -height] for x, y in ((-1, -0.5), (1, -0.5), (1, 0.5), (-1, 0.5))])
    rises = []
    for _ in range(2_000):
        size = abs(height) * 10 ** rng.uniform(-3, -1)  # E = -h t^2 / 2 + O(t^3)
        share = 10 ** np.array([rng.uniform(-8, 0), 0, rng.uniform(-8, 0)])  # mostly about y
        turn = Rotation.from_rotvec(rng.normal(size=3) * size * share).as_matrix()
        corners = bottom @ turn.T
        room = 1 - corners[1:3, 0].max()  # both low corners at the stop, or one
        corners[:, 0] += room - size * abs(rng.normal()) * rng.integers(2)
        rises.append(-lowest_on_table(corners) - height)
    case = case_of("24b").build(height)
    assert state(case) == ("free" if height < 0 else "balanced")
    assert (min(rises) >= -1e-12) == (height < 0)


def lowest_on_table(corners: Array) -> float:
    """The least height of a plane polygon's points with x <= 0."""
    inside = corners[corners[:, 0] <= 0]
    following = np.roll(corners, -1, axis=0)
    crosses = (corners[:, 0] <= 0) != (following[:, 0] <= 0)
    a, b = corners[crosses], following[crosses]
    share = a[:, 0] / (a[:, 0] - b[:, 0])
    cut = a + share[:, None] * (b - a)
    return float(np.vstack([inside, cut])[:, 2].min())


def on_table(*parts: Part) -> Assembly:
    return Assembly([Part("table", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True), *parts])


WALLS = [
    Part("left", Box([1, 10, 10]), Pose([-1.5, 0, 5]), grounded=True),
    Part("behind", Box([10, 1, 10]), Pose([0, -1.5, 5]), grounded=True),
]


@pytest.mark.parametrize(
    ("parts", "neutral"),
    [
        ([Part("ball", Sphere(1.0), Pose([0, 0, 1])), WALLS[0]], 5),
        ([Part("ball", Sphere(1.0), Pose([0, 0, 1])), *WALLS], 5),
        ([Part(f"ball {k}", Sphere(1.0), Pose([2 * k, 0, 1])) for k in range(3)], 15),
        ([Part("can", Cylinder(1.0, 2.0), Pose([0, 0, 1])), WALLS[0]], 3),
        ([Part("log", Cylinder(1.0, 2.0), Pose([0, 0, 1], [1, 1, 0, 0])), WALLS[0]], 4),
    ],
)
def test_what_rolls_on_a_table_is_free_beside_a_wall(parts: list[Part], neutral: int) -> None:
    assembly = on_table(*parts)
    found = kilter.check(assembly)
    second = found.second_order_answer
    assert second is not None
    assert (second.state, second.neutral, second.free) == ("free", neutral, neutral)
    assert kilter.verify(assembly, found.proof()).holds


def test_between_two_walls_that_press_nothing_it_rolls_along() -> None:
    right = Part("right", Box([1, 10, 10]), Pose([1.5, 0, 5]), grounded=True)
    ball = Part("ball", Sphere(1.0), Pose([0, 0, 1]))
    second = kilter.check(on_table(ball, WALLS[0], right)).second_order_answer
    assert second is not None
    assert (second.state, second.neutral, second.free) == ("free", 4, 4)


# the proof ---------------------------------------------------------------------------------

Question = tuple[Stationary, Mask, Array, Array]


def asked(assembly: Assembly) -> Question:
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    features = features_of(program, contacts)
    problem = stationary(program, np.nan_to_num(gap_forms(program, features)))
    touched = touched_surfaces(program, features, contacts)
    free = find_free_motions(program, features, touched)
    span = free_span(program, problem, free.symmetries)
    return problem, level_contacts(program, features, touched), level_motions(program), span


@pytest.mark.parametrize(
    ("number", "level"),
    [
        ("01", True),  # a ball on a plane
        ("02", False),  # on a ball
        ("05", False),  # in a V
        ("10", True),  # rims on a plane
        ("11", False),  # edges on a cylinder
        ("24", True),  # edges across edges
        ("32", True),  # a rim on a plane
        ("33", True),  # corners on a plane
    ],
)
def test_level_contacts_are_of_level_planes_or_straight_edges(number: str, level: bool) -> None:
    assert (asked(case_of(number).build(0.2))[1] == level).all()


def test_surfaces_that_fit_are_level_where_one_is_a_level_plane() -> None:
    can = Part("can", Cylinder(0.5, 1.0), Pose([0, 0, 0.5]))
    assert asked(on_table(can))[1].all()
    assembly = case_of("24").build(-0.3)
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    features = features_of(program, contacts)
    nothing = Touched(np.full(4, UNKNOWN), program.point, program.normal)
    assert level_contacts(program, features, (nothing, nothing)).all()
    fits = replace(features, conformal=np.array([True, False, True, False]))
    found = level_contacts(program, fits, (nothing, nothing))
    assert found.tolist() == [False, True, False, True]


def test_level_motions_are_across_gravity() -> None:
    case = case_of("35").build(0.0)
    turned = moved(case, Pose([1, 2, 3], [0.5, 0.3, -0.7, 0.41]), 3.0)
    for assembly in (case, turned):
        program = build_program(assembly, kilter.contacts(assembly))
        motions = level_motions(program)
        np.testing.assert_allclose(motions.T @ motions, np.eye(6), atol=1e-12)
        by_part = motions.T.reshape(6, 2, 6)
        np.testing.assert_allclose(by_part[:, :, :3] @ program.down, 0, atol=1e-12)
        np.testing.assert_allclose(np.cross(by_part[:, :, 3:], program.down), 0, atol=1e-12)
    box = Part("box", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    flat = Assembly(on_table(box).parts, planar=True)
    for down in ([0, 0, -1], [0.6, 0, -0.8]):
        program = build_program(flat.with_down(down), kilter.contacts(flat))
        level = np.abs(level_motions(program))
        np.testing.assert_allclose(level, [[-down[2]], [down[0]], [0]], atol=1e-12)


def test_stops_that_leave_a_way_are_no_proof() -> None:
    """With a low stop in the middle the box turns about it, and a corner slides out."""
    assembly = case_of("24b").build(-0.3)
    table, stops = assembly.contacts[:4], assembly.contacts[4:]
    middle = replace(stops[0], points=[[1, 0, 0]])
    for given in ((*table, middle), table, (*table, stops[0])):
        question = asked(Assembly(assembly.parts, contacts=given, detect=False))
        assert find_stopped(*question) is None
