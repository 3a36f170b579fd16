"""Derivatives of limits: closed forms, differences of limits, one-sided slopes, wrong input."""

import importlib.util
import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Load, Part, Pose
from kilter.errors import InputError
from kilter.scenes import arches, stacks
from kilter.shape.primitives import Prism

B, H = 0.5, 1.0
"""Half base and half height of the box."""


def table(size: float = 9.0) -> Part:
    return Part("table", Box(size, size, 1), [0, 0, -0.5], grounded=True)


def box(friction: float, wide: float = 2 * B, shift: float = 0.1, **more: object) -> Assembly:
    part = Part("box", Box(wide, 3, 2 * H), [shift, 0, H], **more)
    return Assembly([table(), part], friction=friction)


def degrees_by_tangent(angle: float) -> float:
    return math.degrees(math.cos(math.radians(angle)) ** 2)


def test_a_box_that_tips_has_the_slopes_of_its_base_and_height():
    """The tangent b/h: 1/h by b, -b/h^2 by h, the same to both sides."""
    gradient = kilter.margin(box(0.9)).gradient("tilt")
    unit = degrees_by_tangent(gradient.value)
    assert gradient.value == pytest.approx(math.degrees(math.atan(B / H)))
    # the centre of the box rises by half of its growth
    assert gradient.sizes("box")["x"] == pytest.approx((unit / H / 2,) * 2)
    assert gradient.sizes("box")["y"] == pytest.approx((0, 0), abs=1e-8)
    assert gradient.center[1, 2] == pytest.approx([-B / H**2 * unit] * 2)
    assert gradient.mass == pytest.approx(np.zeros((2, 2)), abs=1e-9)
    assert gradient.friction == pytest.approx(np.zeros((1, 2)), abs=1e-9)
    assert all(unique.all() for unique in gradient.unique.values())


def test_a_box_that_slides_has_the_slope_of_its_friction():
    gradient = kilter.margin(box(0.3)).gradient("tilt")
    assert gradient.friction == pytest.approx(
        np.full((1, 2), degrees_by_tangent(gradient.value)), rel=1e-6
    )
    assert gradient.center == pytest.approx(np.zeros((2, 3, 2)), abs=1e-7)


def test_a_box_between_sliding_and_tipping_has_two_slopes():
    """At mu = b/h more friction gains nothing, and less friction loses 1."""
    given = box(0.5)
    gradient = kilter.margin(given).gradient("tilt")
    slope, unit = gradient.along(given.with_friction(1.5)), degrees_by_tangent(gradient.value)
    assert slope.left == pytest.approx(unit, rel=1e-6)
    assert slope.right == pytest.approx(0, abs=1e-6)
    left, right = gradient.sizes("box")["x"]
    assert left == pytest.approx(unit / 2, rel=1e-6)
    assert right == pytest.approx(0, abs=1e-6)


def test_a_plank_over_an_edge():
    """Factor = m d / (M e), d and e: distances of its centre and of the load from the edge."""
    mass, weight, over, reach = 8.0, 60.0, 0.4, 1.1
    bench = Part("bench", Box(4, 2, 1), [-2, 0, -0.5], grounded=True)
    plank = Part("plank", Box(3, 1, 0.1), [-over, 0, 0.05], mass=mass)
    load = Load("plank", force=[0, 0, -weight], point=[reach, 0, 0.1])
    given = Assembly([bench, plank], friction=0.5, loads=[load])
    gradient = kilter.margin(given).gradient("load factor")
    factor = mass * 9.81 * over / (weight * reach)
    assert gradient.value == pytest.approx(factor)
    assert gradient.mass[1] == pytest.approx([factor / mass] * 2)
    # the load stays where it is
    assert gradient.position[1, 0] == pytest.approx([-factor / over] * 2)
    heavier = replace(load, force=1.001 * load.force)
    slope = gradient.along(replace(given, loads=[heavier]))
    assert slope.right == pytest.approx(-factor * 0.001)


def test_a_seesaw_is_lost_to_its_heavier_side():
    """The tangent (b - x)/z, with the common centre (x, z)."""
    half, masses, arms = 0.3, (5.0, 6.0), (-1.0, 0.9)
    fulcrum = Part("fulcrum", Box(2 * half, 1, 1), [0, 0, -0.5], grounded=True)
    plank = Part("plank", Box(2.4, 1, 0.1), [0, 0, 0.05], mass=4.0)
    boxes = [
        Part(f"box{k}", Box(0.4, 0.4, 0.1), [arm, 0, 0.15], mass=mass)
        for k, (arm, mass) in enumerate(zip(arms, masses, strict=True))
    ]
    gradient = kilter.margin(Assembly([fulcrum, plank, *boxes], friction=3.0)).gradient("tilt")

    def tangent(values: np.ndarray) -> float:
        total = 4.0 + values.sum()
        x = values @ arms / total
        z = (4.0 * 0.05 + values.sum() * 0.15) / total
        return (half - abs(x)) / z

    first, step = np.array(masses), 1e-4
    for k in range(2):
        more = np.eye(2)[k] * step
        slope = (tangent(first + more) - tangent(first - more)) / (2 * step)
        expected = slope * degrees_by_tangent(gradient.value)
        assert gradient.mass[2 + k] == pytest.approx([expected] * 2, rel=1e-6)


def harmonic(count: int, moved: int = 0, by: float = 0.0) -> Assembly:
    """A harmonic stack at its exact offsets over the edge x = 0; one block is moved."""
    parts, edge = [Part("table", Box(3, 2, 1), [-1.5, 0, -0.5], grounded=True)], 0.0
    for k, above in enumerate(range(count, 0, -1), 1):
        x = edge - (above - 1) * 0.5 / above
        parts.append(Part(f"{k}", Box(1, 1, 0.25), [x + by * (k == moved), 0, 0.25 * (k - 0.5)]))
        edge = x + 0.5
    return Assembly(parts, friction=0.5)


def test_a_harmonic_stack_has_different_slopes_to_both_sides():
    """Two blocks, all edges at their limit: tan = x/z for the lower edge, or for the upper."""
    gradient = kilter.margin(harmonic(2)).gradient("tilt")
    assert gradient.value == pytest.approx(0, abs=1e-9)
    unit, step = math.degrees(1), 1e-6
    lower = gradient.along(harmonic(2, 1, step))
    # outwards: half of the movement over z = 1/4; inwards: the upper block over z = 1/8
    assert lower.right / step == pytest.approx(-2 * unit, rel=1e-5)
    assert lower.left / step == pytest.approx(8 * unit, rel=1e-5)
    upper = gradient.along(harmonic(2, 2, step))
    assert upper.right / step == pytest.approx(-8 * unit, rel=1e-5)
    assert upper.left / step == pytest.approx(-2 * unit, rel=1e-5)


def moved(pose: Pose, turn: np.ndarray) -> np.ndarray:
    """The pose of a part after a turn about the origin, as a matrix."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn @ pose.matrix, turn @ pose.position
    return matrix


def test_a_block_on_a_slope_needs_the_tangent_of_its_angle():
    """The slope by a turn of all parts about the horizontal axis across the slope."""
    given = stacks.block_on_slope(20.0, friction=0.7)
    gradient = kilter.margin(given).gradient("friction")
    assert gradient.value == pytest.approx(math.tan(math.radians(20)), rel=1e-6)
    step = 1e-7
    turn = np.array([[1, 0, step], [0, 1, 0], [-step, 0, 1]])
    turned = given.with_poses({part.name: moved(part.pose, turn) for part in given.parts})
    slope = gradient.along(turned)
    assert abs(slope.right) / step == pytest.approx(1 / math.cos(math.radians(20)) ** 2, rel=1e-6)
    assert slope.left == pytest.approx(slope.right, rel=1e-6)


def leaning_wall(mass: float = 3.0, height: float = 2.0) -> Assembly:
    """A wall whose foot is cut, with its centre beside the middle of the foot."""
    outline = [[0, 0], [0.6, 0], [0.6 + 0.2, height], [0.2, height]]
    return Assembly([table(), Part("wall", Prism(outline, 1.0), mass=mass)], friction=0.9)


def test_a_leaning_wall():
    """The tangent (b - x)/z with b = .6, x = .4, z = h/2: a vertex of the foot moves b, x and z."""
    given = leaning_wall()
    gradient = kilter.margin(given).gradient("tilt")
    unit = degrees_by_tangent(gradient.value)
    assert math.tan(math.radians(gradient.value)) == pytest.approx(0.2 / 1.0)
    slopes = gradient.vertices("wall")
    corners = given.geometry.vertices[given.geometry.vertex_start[1] :]
    right = (np.abs(corners[:, 0] - 0.6) < 1e-9) & (np.abs(corners[:, 2]) < 1e-9)
    step = 1e-4

    def tangent(x: float) -> float:
        polygon = np.array([[0, 0], [x, 0], [0.8, 2], [0.2, 2]])
        following = np.roll(polygon, -1, axis=0)
        cross = polygon[:, 0] * following[:, 1] - polygon[:, 1] * following[:, 0]
        middle = ((polygon + following) * cross[:, None]).sum(axis=0) / (3 * cross.sum())
        return (x - middle[0]) / middle[1]

    expected = unit * (tangent(0.6 + step) - tangent(0.6 - step)) / (2 * step)
    assert slopes[right, 0].sum(axis=0) == pytest.approx([expected] * 2, rel=1e-6)


def test_least_friction_of_an_arch_by_its_thickness():
    """Central differences of the least friction, each to rounding, agree to 1e-8."""

    def thick(ratio: float) -> kilter.analysis.gradients.gradient.Gradient:
        return kilter.margin(arches.arch(ratio=ratio)).gradient("friction")

    step = 1e-5
    gradient = thick(0.15)
    slope = gradient.along(arches.arch(ratio=0.15 + step))
    values = [thick(0.15 + sign * step)._cases.cases[0].solved.value for sign in (1, -1)]
    back = gradient.along(arches.arch(ratio=0.15 - step))
    assert slope.right - back.right == pytest.approx(values[0] - values[1], rel=1e-8)
    assert slope.left == pytest.approx(slope.right)
    assert slope.reach == math.inf


def calls_of(action):
    """Number of calls of functions by an action, a measure of work that no other load changes."""
    calls = 0

    def count(frame, event, argument):
        nonlocal calls
        calls += event in ("call", "c_call")

    sys.setprofile(count)
    try:
        action()
    finally:
        sys.setprofile(None)
    return calls


@pytest.mark.slow
def test_the_gradient_costs_less_than_the_limit():
    answer = kilter.margin(arches.arch())
    limit = calls_of(lambda: kilter.margin(arches.arch()))
    for name in ("tilt", "friction"):
        assert calls_of(lambda name=name: answer.gradient(name)) <= limit


def test_flush_boxes_lose_their_edge_only_when_it_moves_inwards():
    """The upper of two equal cubes: the foot that it has follows to one side alone."""
    cubes = [Part(f"{k}", Box(1, 1, 1), [0, 0, k + 0.5]) for k in range(2)]
    given = Assembly([table(), *cubes], friction=0.9)
    gradient = kilter.margin(given).gradient("tilt")
    step = 1e-7
    slope = gradient.along(given.with_pose("1", [step, 0, 1.5]))
    # tan = (1/2 - |x|/2)/1, toward both sides
    assert slope.right / step == pytest.approx(-degrees_by_tangent(gradient.value) / 2, rel=1e-5)
    assert slope.left == pytest.approx(-slope.right, rel=1e-5)


def test_equal_parts_elsewhere_keep_the_limit():
    """Two equal boxes: no change of only one of them raises the tilt, a worse one lowers it."""
    boxes = [Part(f"{k}", Box(1, 3, 2), [4 * k - 2, 0, 1]) for k in range(2)]
    gradient = kilter.margin(Assembly([table(20), *boxes], friction=0.9)).gradient("tilt")
    assert (gradient.center[..., 1] <= 0).all()
    assert gradient.center[..., 1].min() < -20
    assert (gradient.center[..., 0] >= 0).all()


def test_a_push_and_a_load_have_gradients():
    """A push of mu m at the centre slides the box: mu g by mass, m g by friction."""
    given = box(0.2, mass=50.0)
    answer = kilter.margin(given, pushes=True, loads=False)
    gradient = answer.gradient("push", part="box")
    mu = 0.2 / math.sqrt(1 + 0.2**2)
    assert gradient.value == pytest.approx(mu * 50 * 9.81, rel=1e-4)
    assert gradient.mass[1] == pytest.approx([mu * 9.81] * 2, rel=1e-4)


@pytest.mark.parametrize(
    ("request_", "words"),
    [
        (("speed",), "there is no limit 'speed'"),
        (("load factor",), "there is no finite limit 'load factor'"),
        (("push",), "the answer has no push of None"),
    ],
)
def test_a_limit_that_the_answer_lacks_is_an_error(request_, words):
    with pytest.raises(InputError, match=words):
        kilter.margin(box(0.9)).gradient(*request_)


def test_another_assembly_must_have_the_same_parts():
    gradient = kilter.margin(box(0.9)).gradient("tilt")
    with pytest.raises(InputError, match="other parts"):
        gradient.along(Assembly([table()]))
    with pytest.raises(InputError, match="other vertices"):
        gradient.along(Assembly([table(), Part("box", kilter.Cylinder(0.5, 2), [0, 0, 1])]))
    with pytest.raises(InputError, match="no part"):
        gradient.sizes("bow")


FILE = Path(__file__).resolve().parents[2] / "benchmarks" / "gradient_census.py"


def loaded(file: Path) -> object:
    spec = importlib.util.spec_from_file_location(file.stem, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
def test_an_optimiser_widens_the_tilt_of_a_tower():
    example = loaded(FILE.parents[1] / "examples" / "optimise_a_tower.py")
    before, slopes = example.tilt(example.START)
    assert slopes.sum() == pytest.approx(0, abs=1e-6)  # all boxes together on a wide table
    assert example.tilt(example.by_scipy(4))[0] > before + 5
    pytest.importorskip("torch")
    assert example.by_torch() == pytest.approx(slopes)


@pytest.mark.slow
@pytest.mark.parametrize("family", ["stack", "arch", "pile", "wedge", "voronoi"])
def test_irregular_assemblies_agree_with_differences(family, monkeypatch):
    """The first cases of benchmarks/gradient_census.py."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    census = loaded(FILE)
    monkeypatch.setattr(sys, "argv", [str(FILE), "3", "--first", "60", "--family", family])
    assert census.main() == 0


@pytest.mark.parametrize("family", ["stack", "arch", "pile", "wedge", "voronoi"])
def test_an_unchanged_copy_of_the_census_changes_no_limit(family, monkeypatch):
    """The copies of the census keep all data: a lost friction pair hides errors of the slopes."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    census = loaded(FILE)
    given = census.assembly_of(family, 52)
    count = len(given.parts)
    none = np.zeros((3, 3)), 0.0, np.zeros(count), np.zeros((count, 3)), 0.0
    assert census.changed(given, *none) == given


def test_differences_of_a_limit_have_the_digits_of_its_slope(monkeypatch):
    """A load factor of -0.02, whose differences had five digits: Newton's method ended too soon."""
    monkeypatch.setattr(sys, "path", list(sys.path))
    census = loaded(FILE)
    monkeypatch.setattr(sys, "argv", [str(FILE), "1", "--first", "42", "--family", "pile"])
    assert census.main() == 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("family", "seed"),
    [("pile", 106), ("pile", 114), ("stack", 55), ("arch", 191)],
)
def test_cases_that_once_contradicted_their_differences(family, seed, monkeypatch):
    """Piles: the direction settles slowly. Stack: forces are not unique in each direction of slip.

    Arch: the limits of a copy beside it are not refined, so that a smaller step is needed.
    """
    monkeypatch.setattr(sys, "path", list(sys.path))
    census = loaded(FILE)
    monkeypatch.setattr(sys, "argv", [str(FILE), "1", "--first", str(seed), "--family", family])
    assert census.main() == 0
