"""Paths along which the energy falls: their places, and the proof number by number."""

from typing import Any

import numpy as np
import pytest
from places import case_of
from random_balances import disjoint, overlap, random_balance
from scipy.spatial.transform import Rotation
from test_figures_in_space import TURNED, least_gap

import kilter
from kilter import Assembly, Box, Cylinder, Part, Pose, Sphere
from kilter.arrays import Array
from kilter.scenes import scene
from kilter.second_order.answer.path_places import PathPlaces, find_path_places
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.paths import Path, judge_path
from kilter.second_order.second_order_tolerances import ACROSS, DROPS, KEEPS, LASTS, REACHES, SLIPS
from kilter.work import Work

LYING = Pose.of([[1, 0, 0], [0, 0, -1], [0, 1, 0]]).rotation
SURE = 1e-6
"""Gaps above this are beyond the rounding of the linear programs of the test [length unit]."""


def balls(scale: float = 1.0) -> Assembly:
    base = Part("base", Sphere(scale), grounded=True)
    return Assembly([base, Part("ball", Sphere(0.5 * scale), Pose([0, 0, 1.5 * scale]), mass=2.0)])


def logs() -> Assembly:
    base = Part("base", Cylinder(1.0, 3.0), Pose([0, 0, 0], LYING), grounded=True)
    return Assembly([base, Part("log", Cylinder(0.5, 2.0), Pose([0, 0, 1.5], LYING), mass=2.0)])


def path_of(assembly: Assembly, work: Work | None = None) -> tuple[SecondOrder, PathPlaces]:
    verdict = kilter.check(assembly)
    found = verdict.second_order_answer
    assert found is not None
    assert found.state == "balanced"
    path = find_path_places(verdict.assembly, found, work=work)
    assert path is not None
    assert (np.diff(path.energies) < 0).all()
    assert (np.diff(path.lengths) > 0).all()
    assert (path.apart > 0).all()
    return found, path


@pytest.mark.slow
@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e3])
def test_a_ball_slides_down_a_ball(scale):
    """Its centre stays on a sphere about the other centre: E = m g (R + r)(cos a - 1)."""
    _, path = path_of(balls(scale))
    centre = path.motions[:, 1, :3] / scale + np.array([0, 0, 1.5])
    angle = np.arctan2(np.linalg.norm(centre[:, :2], axis=1), centre[:, 2])
    weight = 2.0 * np.linalg.norm(balls().gravity)
    energy = path.energies / scale / weight
    assert np.degrees(angle[-1]) > 35
    np.testing.assert_allclose(np.linalg.norm(centre, axis=1), 1.5, atol=1e-4)
    np.testing.assert_allclose(energy, 1.5 * np.cos(angle) - 1.5, atol=1e-4)
    np.testing.assert_allclose(path.lengths[-1] / scale, 1.5 * angle[-1], rtol=0.02)
    assert np.abs(path.motions[:, 1, 3:]).max() < 1e-2  # nothing turns it


@pytest.mark.slow
def test_a_log_slides_down_a_log_until_it_leaves_it():
    _, path = path_of(logs())
    x, y, z = (path.motions[:, 1, :3] + np.array([0, 0, 1.5])).T
    on = z > 0.3
    assert not on.all()
    np.testing.assert_allclose(np.hypot(x, z)[on], 1.5, atol=3e-4)
    assert np.abs(y).max() < 0.05
    assert np.ptp(x[z < -0.1]) < 1e-3  # straight down beside it
    assert path.apart[-1] > 0.001


def corners(assembly: Assembly, part: int, motion: Array) -> Array:
    """The corners of a displaced part."""
    geometry = assembly.geometry
    points = np.unique(geometry.corners_of(part).reshape(-1, 3), axis=0) - geometry.center[part]
    return Rotation.from_rotvec(motion[3:]).apply(points) + geometry.center[part] + motion[:3]


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [TURNED[0], *(pytest.param(one, marks=pytest.mark.slow) for one in TURNED[1:])]
)
def test_blocks_of_the_figures_twist_and_sink(name):
    """They are apart from each triangle of the wall and from each other."""
    assembly = scene(name)
    found, path = path_of(assembly)
    program = found.program
    assert program is not None
    gaps = [least_gap(assembly, program, motion) for motion in path.motions[1:6]]
    np.testing.assert_allclose(gaps, path.apart[:5], rtol=1e-6, atol=1e-12)
    assert path.apart.max() < 1e-3  # they stay in contact, up to gaps too small to see
    held, (one, other) = int(np.flatnonzero(~program.free)[0]), np.flatnonzero(program.free)
    for motion in path.motions[-1:2:-6]:
        first, second = (corners(assembly, k, motion[k]) for k in (one, other))
        walls = assembly.geometry.corners_of(held)
        assert disjoint(first, 0.0, second, 0.0)
        assert all(disjoint(block, 0.0, wall, 0.0) for block in (first, second) for wall in walls)
    turns = np.linalg.norm(path.motions[-1, :, 3:], axis=1)[program.free]
    assert turns.min() > 0.7
    assert path.motions[-1, program.free, 2].sum() < -1.0


def test_there_is_none_of_what_is_at_rest_or_of_given_contacts():
    verdict = kilter.check(case_of("02").build(0.0))
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.state == "balanced"
    assert find_path_places(verdict.assembly, verdict.second_order_answer) is None
    upright = kilter.check(scene("tower"))
    assert upright.second_order_answer is not None
    assert find_path_places(upright.assembly, upright.second_order_answer) is None


@pytest.mark.slow
def test_a_box_tips_over_the_edge_of_its_table():
    table = Part("table", Box([2, 2, 1]), grounded=True)
    assembly = Assembly([table, Part("box", Box([1, 0.8, 0.6]), Pose([1, 0, 0.8]))])
    _, path = path_of(assembly)
    x, _, z, _, turn, _ = path.motions[-1, 1]
    assert turn > 1
    assert x > 0.3
    assert z < -0.4
    assert not any(overlap(assembly, motion, outside=True) for motion in path.motions[3:])


@pytest.mark.slow
def test_balls_between_walls_fall_along_them():
    """No configuration opens a wall: their centres stay half way between, and they never turn."""
    walls = [Part(f"wall {x}", Box([1, 10, 10]), Pose([x, 0, 5]), grounded=True) for x in (-1, 1)]
    floor = Part("floor", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
    upright = [Part(f"ball {k}", Sphere(0.5), Pose([0, 0, 0.5 + k]), mass=1.0) for k in range(2)]
    _, path = path_of(Assembly([floor, *walls, *upright]))
    assert np.abs(path.motions[:, 3:, 0]).max() < 1e-12
    assert np.abs(path.motions[:, 3:, 3:]).max() < 1e-12
    low, high = path.motions[:, 3, :3], path.motions[:, 4, :3] + np.array([0, 0, 1.0])
    apart = np.linalg.norm(high - low, axis=1)
    assert apart.min() >= 1.0
    assert apart.max() < 1.002
    assert np.ptp(low[:, 2]) < 1e-3  # the lower one slides on the floor
    assert high[-1, 2] < 0.9
    energy = 9.81 * (path.motions[:, 3, 2] + path.motions[:, 4, 2])
    np.testing.assert_allclose(path.energies, energy, rtol=1e-9, atol=1e-12)


def followed(seed: int) -> float | None:
    """Length of the fall of a random assembly without overlaps [width of the part], or None."""
    assembly = random_balance(seed)
    verdict = kilter.check(assembly)
    second = verdict.second_order_answer
    if second is None or second.state != "balanced" or second.decision is None:
        return None  # some fall by rule, without a path
    found, path = path_of(assembly)
    assert found.program is not None
    for motion, apart in zip(path.motions[1:], path.apart, strict=True):
        if apart > SURE:
            assert not overlap(assembly, motion, outside=apart > 10 * SURE)
    far = np.linalg.norm(path.motions[-1, :, :3], axis=1) / found.program.radius
    return float(np.maximum(far, np.linalg.norm(path.motions[-1, :, 3:], axis=1)).max())


@pytest.mark.slow
@pytest.mark.parametrize("block", range(2))
def test_random_ones_fall_and_none_overlaps(block):
    far = [followed(seed) for seed in range(10 * block, 10 * block + 10)]
    falls = [one for one in far if one is not None]
    assert len(falls) >= 5
    assert min(falls) > 1


X, Y, Z = np.eye(3)
JUST = (0.9, 1.1)
"""Factors of a limit, on both sides of it [-]."""
BOWL, BALL = -1.0, 1.0


def path(
    first: Any,
    second: Any,
    *,
    bends: float = BALL,
    others: Any = (),
    load: Any = -Z,
    blur: float = 1e-9,
    planes: Any = None,
    turns: Any = (),
    slips: Any = None,
) -> Path:
    """The judged path of given derivatives."""
    rows = np.array([Z, *others], dtype=float)
    form = np.zeros((len(rows), 12, 12))
    form[0, 0, 0] = bends
    place = np.full(12, -1)
    place[:3] = range(3)
    for at, unknown in turns:
        place[at] = unknown
    flat = None if planes is None else np.array(planes)
    places = np.tile(place, (len(rows), 1))
    problem = Stationary(rows, np.array(load), form, places, blur, on_plane=flat, slips=slips)
    return judge_path(problem, np.array(first, dtype=float), np.array(second, dtype=float))


def test_what_is_on_a_ball_falls_and_not_in_a_bowl():
    found = path(X, -0.5 * Z)
    assert found.falls
    assert (found.opens, found.power, found.slips) == (0.5, 0.5, 0.0)
    assert not path(X, -0.5 * Z, bends=BOWL).falls
    assert not path(X, 0 * Z, bends=BOWL).falls
    assert not path(Y, -0.5 * Z).falls


@pytest.mark.parametrize("over", JUST)
def test_it_opens_and_falls_by_more_than_rounding(over):
    assert path(X, -(1 - over * DROPS) * Z).falls == (over > 1)
    assert path(X, -over * DROPS * Z).falls == (over > 1)


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize("sign", [1, -1])
def test_what_it_enters_or_costs_at_once_is_little_beside_what_it_opens(over, sign):
    slip, rough = over * SLIPS * 0.5, 1e-3
    assert not path(X, -0.5 * Z, others=(Y - slip * X,), blur=rough).falls  # y is not opened either
    entered = path(X, -0.5 * Z + Y, others=(Y - slip * X,), blur=rough)
    assert entered.falls == (over < 1)
    assert entered.slips == pytest.approx(slip)
    loaded = path(X, -0.5 * Z, load=-Z + sign * slip * X, blur=rough)
    assert loaded.slips == pytest.approx(slip)
    assert loaded.falls == (over < 1)


@pytest.mark.parametrize("over", JUST)
@pytest.mark.parametrize(("blur", "slack"), [(1e-9, ACROSS), (1e-6, 1e-6)])
def test_what_it_enters_at_once_is_rounding_of_the_data_however_much_it_opens(over, blur, slack):
    """A small ball in a hollow of smaller ones: the gaps curve much, and it stays."""
    slip = over * slack
    assert path(X, -50 * Z, bends=100.0, load=-Z + slip * X, blur=blur).falls == (over < 1)
    entered = path(X, -50 * Z + Y, bends=100.0, others=(Y - slip * X,), blur=blur)
    assert entered.falls == (over < 1)


@pytest.mark.parametrize("lift", [1.01 * DROPS, 1e-7, 1e-6, 1e-5])
@pytest.mark.parametrize("drop", [0.1, 1.0, 100.0])
def test_a_lift_by_next_to_nothing_lets_nothing_fall_in_a_bowl(lift, drop):
    """The gap opens to first order for a moment, then the second derivative closes it."""
    first = (X + lift * Z) / np.hypot(1, lift)
    assert not path(first, -drop * Z, bends=BOWL).falls


@pytest.mark.parametrize("over", JUST)
def test_what_opens_at_once_stays_open_far_beyond_where_the_path_begins_to_fall(over):
    """Another gap opens by a t - t^2 / 2, and the path falls from t = 2 slip / 0.5 on."""
    slip = 1e-8
    opens = LASTS * 2 * slip / 0.5 / 2 * over
    found = path(X, -0.5 * Z - Y, others=(Y + opens * X, Y + DROPS / 2 * X), load=-Z - slip * X)
    assert not found.falls  # the last one closes
    found = path(X, -0.5 * Z - Y, others=(Y + opens * X,), load=-Z - slip * X)
    assert found.lasts == pytest.approx(2 * opens)
    assert found.falls == (over > 1)
    assert path(X, -0.5 * Z + Y, others=(Y + opens * X,)).lasts == np.inf


@pytest.mark.parametrize("over", JUST)
def test_second_derivatives_are_those_of_a_path_and_more_than_the_blur_of_the_data(over):
    """Far enough along a neutral motion, the rounding of the rows would open any gap."""
    most = REACHES[-1] * np.sqrt(3) * (1 + over * ACROSS)
    assert path(X, -0.5 * Z + np.sqrt(most**2 - 0.25) * Y).falls == (over < 1)
    blurred = path(X, -0.5 * Z + 100 * Y, blur=over * 0.5 / 100)
    assert blurred.falls == (over < 1)


def test_tilted_rows_within_rounding_make_no_path_in_a_bowl():
    tilt = 1e-10
    second = 3.0 / tilt * X - Z
    assert not path(X, second, bends=BOWL, others=(Z + tilt * X,), load=-Z).falls
    assert not path(X, second, bends=BOWL, others=(), load=-Z + tilt * X).falls


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_no_number_does_not_fall(value):
    for place in range(3):
        for k in range(2):
            both = [X.copy(), -0.5 * Z]
            both[k][place] = value
            with np.errstate(invalid="ignore"):
                assert not path(*both).falls
    with np.errstate(invalid="ignore"):
        assert not path(Z, [value, 0, 0], load=0 * Z).falls


def test_contacts_with_a_plane_may_be_kept_by_what_only_shifts():
    pressed = {"others": (Y, -Y)}
    assert not path(X, -0.5 * Z, **pressed).falls
    assert path(X, -0.5 * Z, **pressed, planes=[False, True, True]).falls
    assert not path(X, -0.5 * Z, **pressed, planes=[False, True, False]).falls
    for over in JUST:
        for moved in (
            {"first": X + over * KEEPS * Y, "second": -0.5 * Z},
            {"first": X, "second": -0.5 * Z - over * KEEPS * Y},
        ):
            found = path(**moved, **pressed, planes=[False, True, True])
            assert found.falls == (over < 1)
    for at in (3, 4, 5, 9, 10, 11):  # x turns a part
        found = path(X, -0.5 * Z, **pressed, planes=[False, True, True], turns=[(at, 0)])
        assert not found.falls
    for at in (6, 7, 8):
        found = path(X, -0.5 * Z, **pressed, planes=[False, True, True], turns=[(at, 1)])
        assert found.falls


def test_what_is_at_a_limit_is_on_the_side_of_no():
    assert not path(X, -DROPS * Z).falls
    assert not path(X, -0.5 * Z - Y, others=(Y + DROPS * X,)).falls  # it stays closed, and closes
    walls = {"others": (Y, -Y), "planes": [False, True, True]}
    assert not path(X + KEEPS * Y, -0.5 * Z, **walls).falls
    assert path(X, -0.5 * Z, load=-Z + ACROSS * X).falls


def test_what_a_path_says_of_itself():
    for second in (-0.5 * Z, -0.5 * Z + 0.5 * X):  # a wall that it leaves, not to come back
        assert path(X, second, others=(X,)).lasts == np.inf
    assert path(X, -0.5 * Z).rounding == 0.5e-9
    assert path((X + Z) / 2, -0.5 * Z, load=X - Z).opens == 1.0  # all gaps open at once
    assert path(X, -0.5 * Z).one_form
    slips = np.zeros((2, 4, 12))
    assert path(X, -0.5 * Z, others=(Y,), slips=slips).one_form
    slips[1, [0, 2], 0] = 1.0  # it turns at a corner, and slips
    assert not path(X, -0.5 * Z, others=(Y,), slips=slips).one_form
