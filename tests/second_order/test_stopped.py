"""Parts that a stop keeps from tipping: as found, and the proof number by number."""

from dataclasses import replace
from typing import Any

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
from kilter.second_order.motions.free_motions import find_free_motions, free_span
from kilter.second_order.proofs.stopped import Stopped, judge_stopped, level_contacts, level_motions
from kilter.second_order.second_order_tolerances import ACROSS, BEARS, CURVED, DROPS, LEVEL

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
def test_a_stop_holds_up_to_twice_its_height():
    for off in (0.1, 1e-3):
        assert state(overhanging(2 * STOP - off)) == "free"
        assert state(overhanging(2 * STOP + off)) in {"balanced", "open" if off < 0.01 else ""}
        assert state(overhanging(2 * STOP - off, stop=None)) == "balanced"
    assert state(overhanging(0.6, slid=0.1)) == "free"
    assert state(overhanging(0.6, slid=0.1, stop=None)) == "free"


@pytest.mark.quick(1)
@pytest.mark.parametrize("height", [-0.4, -0.01, 0.01, 0.4])
def test_exact_places_of_a_box_over_an_edge_agree(height):
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


@pytest.mark.quick(2)
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
def test_what_rolls_on_a_table_is_free_beside_a_wall(parts, neutral):
    assembly = on_table(*parts)
    found = kilter.check(assembly)
    second = found.second_order_answer
    assert second is not None
    assert (second.state, second.neutral, second.free) == ("free", neutral, neutral)
    assert kilter.verify(assembly, found.proof()).holds


def test_between_two_walls_that_press_nothing_it_rolls_along():
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
def test_level_contacts_are_of_level_planes_or_straight_edges(number, level):
    assert (asked(case_of(number).build(0.2))[1] == level).all()


def test_surfaces_that_fit_are_level_where_one_is_a_level_plane():
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


def test_level_motions_are_across_gravity():
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


COUPLED, CURVES = 6.0, 5.0
X, Y, G, Z = np.eye(4)
TWICE = ((0, COUPLED, 0), (COUPLED, 2 * CURVES, 0), (0, 0, 0))
JUST = (0.9, 1.1)
"""Factors of a limit, on both sides of it [-]."""


def word(
    *,
    stops: Any = (3 * X + Y,),
    rises: Any = (2 * Y,),
    weights: Any = ((1.0,),),
    bears: Any = Z,
    load: Any = -Z,
    curvature: Any = ((0, COUPLED / 2, 0), (COUPLED / 2, CURVES, 0), (0, 0, 0)),
    opening: Any = X,
    motions: Any = X[:, None],
    free: Any = G[:, None],
    forces: Any = None,
    blur: float = 1e-9,
    slips: Any = None,
) -> str:
    """The word of the judge, with some numbers replaced; empty if the proof holds."""
    rows = np.array([bears, *rises, *stops], dtype=float)
    form = np.zeros((len(rows), 12, 12))
    form[0, :3, :3] = -np.array(curvature, dtype=float)
    places = np.tile(np.append(np.arange(4), np.full(8, -1)), (len(rows), 1))
    problem = Stationary(rows, np.array(load, dtype=float), form, places, blur, slips=slips)
    level = np.arange(len(rows)) <= len(rises)
    own = np.eye(len(rows))[0] if forces is None else np.array(forces, dtype=float)
    proof = Stopped(own, np.array(weights, dtype=float), np.array(opening, dtype=float))
    return judge_stopped(problem, level, np.array(motions), np.array(free), proof)


def test_it_holds_as_it_is():
    assert word() == ""
    assert word(opening=1e-7 * X) == ""
    assert word(forces=[1.0, 1e-10, 0.0], bears=Z - 1e-10 * 2 * Y) == ""  # it carries nothing


def test_forces_are_of_level_contacts_and_balance():
    assert "do not match the parts" in word(forces=[1.0, 0.0])
    assert "do not match the parts" in word(opening=[1.0, 0.0, 0.0])
    assert "contact that is not horizontal" in word(forces=[1.0, 0.0, 1e-12])
    assert "contact that is not horizontal" in word(forces=[1.0, -1e-12, 0.0])
    assert "do not balance" in word(forces=[1.0 + 2e-9, 0.0, 0.0])
    assert word(forces=[1.0 + 0.5e-9, 0.0, 0.0]) == ""
    assert word(forces=[1.0 + 2e-9, 0.0, 0.0], blur=3e-9) == ""
    assert "do not balance" in word(forces=[1.0 + 4e-9, 0.0, 0.0], blur=3e-9)
    two = {"stops": (3 * X + Y, 3 * X + Y), "weights": [[0.5], [0.5]]}
    assert word(**two) == ""
    assert "contact that is not horizontal" in word(**two, forces=[1.0, 0.0, 0.0, 1e-12])


@pytest.mark.parametrize("weight", [1.0, 1e3])
@pytest.mark.parametrize("over", JUST)
def test_what_carries_less_than_rounding_counts_as_a_rise(over, weight):
    """A second rise with force removes the tilt, so no motion has to be stopped."""
    own = over * BEARS * 1e-9 * weight
    matrix = np.array([[0, 3.0, 0], [3.0, CURVES, 0], [0, 0, 0]]) / weight
    found = word(
        forces=[weight, own, 0.0], load=-weight * Z - own * 2 * Y, curvature=matrix, weights=[[-1]]
    )
    assert ("not positive" in found) == (over < 1)


@pytest.mark.parametrize("what", ["weights", "opening", "forces"])
def test_numbers_are_finite(what):
    given = {"weights": [[np.inf]], "opening": np.nan * X, "forces": [np.nan, 0.0, 0.0]}[what]
    assert "not finite" in word(**{what: given})


@pytest.mark.parametrize("over", JUST)
def test_level_motions_open_no_level_contact_and_cost_nothing(over):
    wrong = "opens a horizontal contact, or costs energy"
    tilted = over * ACROSS * X
    both = np.column_stack([X, G])
    assert wrong in word(motions=both, load=-Z - 2 * ACROSS * G, bears=Z + 2 * ACROSS * G)
    heavy = word(motions=both, load=-Z - 2 * ACROSS * G, blur=1e-6)
    assert wrong in heavy
    assert word(rises=(2 * Y + ACROSS * X,)) == ""  # the limit itself
    for changes in ({"rises": (2 * Y + tilted,)}, {"bears": Z + tilted, "load": -Z - tilted}):
        assert (wrong in word(**changes)) == (over > 1)


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_the_motion_is_level_and_opens_every_stop(over, size):
    off = size * (X + over * ACROSS * Y)
    assert ("not horizontal" in word(opening=off)) == (over > 1)
    assert "not horizontal" in word(opening=0 * X)
    assert word(opening=X + ACROSS * Y) == ""
    assert "not open every stop" in word(stops=(DROPS * X,))
    near = (3 * X + Y, over * DROPS * X)
    two = word(stops=near, weights=[[1.0], [1.0]], opening=size * X)
    assert ("not open every stop" in two) == (over < 1)
    assert "not open every stop" in word(opening=-size * X)
    assert "not open every stop" in word(stops=(3 * X + Y, -X), weights=[[1.0], [1.0]])


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize("place", [(0, 0), (2, 2), (0, 2), (1, 2)])
def test_the_energy_is_level_along_level_motions_and_symmetries(over, place):
    matrix = np.array([[0, COUPLED / 2, 0], [COUPLED / 2, CURVES, 0], [0, 0, 0]])
    matrix[place] += over * LEVEL * COUPLED
    matrix[place[::-1]] = matrix[place]
    assert ("changes along" in word(curvature=matrix)) == (over > 1)
    matrix[place] = matrix[place[::-1]] = LEVEL * COUPLED
    if place != (1, 2):
        assert word(curvature=matrix) == ""


def test_weights_are_positive_one_of_each_pair():
    for weights in ([[-1.0]], [[0.0]], [1.0], [[1.0, 1.0]], [[1.0], [1.0]], []):
        assert "not positive" in word(weights=weights)
    both = {"stops": (3 * X + Y, 3 * X - Y)}
    assert word(**both, weights=[[0.5], [0.5]]) == ""
    assert "not positive" in word(**both, weights=[[1.0], [0.0]])
    assert "not positive" in word(**both, weights=[[1.5], [-0.5]])


@pytest.mark.parametrize("over", JUST)
def test_weights_are_those_of_the_energy(over):
    off = 1.0 + over * LEVEL * COUPLED / (3 * 2)
    assert ("not match the curvature" in word(weights=[[off]])) == (over > 1)
    assert ("not match the curvature" in word(weights=[[2.0 - off]])) == (over > 1)
    off = 1.0 + over * LEVEL / (0.3 * 0.2)  # numbers below 1 are of size 1
    small = ((0, 0.03, 0), (0.03, 0.5, 0), (0, 0, 0))
    found = word(stops=(0.3 * X,), rises=(0.2 * Y,), weights=[[off]], curvature=small)
    assert ("not match the curvature" in found) == (over > 1)


@pytest.mark.parametrize("over", JUST)
def test_what_is_left_of_the_tilt_curves_upward(over):
    leans = (CURVES - over * CURVED) / 2  # what is left is over CURVED, of size 1
    assert ("does not curve upward" in word(stops=(3 * X + leans * Y,))) == (over < 1)
    assert word(stops=(3 * X - leans * Y,)) == ""


@pytest.mark.parametrize("over", JUST)
def test_stops_and_rises_are_one_to_one(over):
    """The least weight times the singular values of stops and rises is above rounding."""
    reach = over * LEVEL * COUPLED
    small = reach / 2
    coupled = ((0, 3.0, 0), (3.0, CURVES, 0), (0, 0, 0))
    found = word(
        stops=(small * X,), weights=[[COUPLED / (2 * small)]], curvature=coupled, opening=X
    )
    assert found == ""  # few, but with a great weight
    weak = word(
        stops=(3 * X, 3 * X),
        weights=[[1.0 - reach / (2 * 3 * np.sqrt(2))], [reach / (2 * 3 * np.sqrt(2))]],
    )
    assert ("do not keep the parts" in weak) == (over < 1)
    off = word(weights=[[reach / 6 * 1.5]])  # far from those of the energy, which counts too
    assert "do not keep the parts" in off
    second = np.eye(4)[[2]].T
    both = np.hstack([X[:, None], second])  # another level motion, that no stop takes
    assert "do not keep the parts" in word(motions=both, free=np.zeros((4, 0)))


def test_without_tilts_nothing_is_coupled():
    held = {"rises": (), "weights": np.zeros((1, 0)), "curvature": np.zeros((3, 3))}
    both = np.column_stack([Y, G])
    assert word(**held, free=both, stops=(3 * X,)) == ""
    assert "not open every stop" in word(**held, free=both, stops=(-3 * X,))
    assert "not positive" in word(**{**held, "weights": [[1.0]]})


@pytest.mark.parametrize("over", JUST)
def test_a_corner_that_carries_does_not_slip_off_an_edge_of_both_parts(over):
    slips = np.zeros((3, 4, 12))
    slips[0, 0, 0], slips[0, 3, 1] = 1.0, over * ACROSS
    assert ("may slip off" in word(slips=slips)) == (over > 1)
    assert word(slips=slips[[1, 0, 2]]) == ""  # it carries nothing
    two = {"rises": (Z, 2 * Y), "forces": [0.5, 0.5, 0.0, 0.0], "curvature": TWICE}
    both = np.concatenate([slips, np.zeros((1, 4, 12))])
    assert word(**two) == ""
    assert ("may slip off" in word(**two, slips=both)) == (over > 1)


def test_forces_at_short_levers_carry_by_rounding():
    """A second level contact would remove the tilt by a negligible torque."""
    far, lever = 1.1e-8, 0.01
    found = word(
        rises=(Z + lever * Y, 2 * Y),
        forces=[1 - far, far, 0.0, 0.0],
        load=-Z - far * lever * Y,
        weights=((1.0,),),
    )
    assert found == "its forces are no larger than rounding errors"
