"""Poses at rest in closed form: play, sunk and floating parts, tipping, sliding and rolling."""

import itertools
import math

import numpy as np
import pytest
from compared_rest import rest_error
from play_scenes import EXACT, KnownRest, ball_in_groove, sunk_stack

import kilter
from kilter import Assembly, Box, Cylinder, FrictionPair, Mesh, Part, Pose
from kilter.files.robots.one_body import one_body
from kilter.rigid import rotation_between
from kilter.scenes.pieces import block, floor, moved, prism, turn
from kilter.shape.primitives import hull_surface

TABLE = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
KNOWN = [build() for build in EXACT]
BOTH = pytest.mark.parametrize("nearest", [False, True], ids=["default", "nearest"])


def ways(answer: kilter.Settled, name: str) -> list[str]:
    """Kinds of the movements of a part, in time."""
    (part,) = [each for each in answer.to_dict()["moved"] if each["part"] == name]
    return [step["how"] for step in part["way"]]


def shift_of(answer: kilter.Settled, name: str) -> np.ndarray:
    return answer.movement[answer.drawn.index[name], :3]


def angle_of(answer: kilter.Settled, name: str) -> float:
    """Angle of the rotation of a part [rad]."""
    return float(np.linalg.norm(answer.movement[answer.drawn.index[name], 3:]))


@pytest.mark.quick(10)
@pytest.mark.parametrize("known", KNOWN, ids=[known.name for known in KNOWN])
def test_parts_that_are_drawn_with_play_come_to_rest_where_geometry_says(known: KnownRest):
    assert rest_error(known, kilter.settle(known.assembly, require="equilibrium")) == ""


@pytest.mark.slow
@pytest.mark.parametrize("known", KNOWN, ids=[known.name for known in KNOWN])
def test_units_and_directions_do_not_change_the_pose_at_rest(known: KnownRest):
    """The same scene about a general axis: the shifts turn with it."""
    rotation = turn([1, 2, 3], 77)
    matrix = Pose(rotation=rotation).matrix
    shift = {name: tuple(matrix @ np.array(by)) for name, by in known.shift.items()}
    scene = moved(known.assembly, rotation)
    turned = KnownRest(known.name, scene, shift, known.leaves, known.angle)
    assert rest_error(turned, kilter.settle(scene, require="equilibrium")) == ""


def test_the_way_of_a_part_that_falls_and_of_one_that_is_sunk():
    hanging = kilter.settle(Assembly([TABLE, Part("box", Box(1, 1, 1), [0, 0, 0.6])]))
    assert ways(hanging, "box") == ["fell"]
    (part,) = hanging.to_dict()["moved"]
    assert part["way"][0]["distance"] == pytest.approx(0.1, abs=1e-9)
    assert part["way"][0]["angle_deg"] == pytest.approx(0, abs=1e-6)
    sunk = kilter.settle(sunk_stack(2).assembly)
    assert ways(sunk, "box-1") == ["pushed-out"]


@pytest.mark.parametrize("yaw", [0.0, 0.3])
def test_a_can_rests_on_its_flat_end_however_it_is_turned(yaw: float):
    """Its rim lies beyond the sides of the polygon that its triangles form."""
    can = Part("can", Cylinder(0.03, 0.1), Pose([0, 0, 0.15], turn([0, 0, 1], np.degrees(yaw))))
    answer = kilter.settle(Assembly([TABLE, can], friction=0.5), require="equilibrium")
    assert answer.state == "at-rest"
    assert answer.movement[1] == pytest.approx([0, 0, -0.1, 0, 0, 0], abs=1e-9)


def test_a_compound_rests_on_the_exact_rim_of_a_member():
    """A saucer of a simulator: a disc with two boxes; its triangles form a polygon."""
    members = [(Cylinder(0.04, 0.006), Pose([0, 0, 0.003])),
               *((Box(0.004, 0.02, 0.03), Pose([x, 0, 0.018])) for x in (-0.03, 0.03))]  # fmt: skip
    shape, _ = one_body(members, "saucer", [])
    cup = Part("saucer", shape, Pose([0, 0, -1e-5], turn([0, 0, 1], 17)))
    answer = kilter.settle(Assembly([TABLE, cup], friction=0.5), require="equilibrium")
    assert answer.state == "at-rest"
    assert answer.movement[1] == pytest.approx([0, 0, 1e-5, 0, 0, 0], abs=1e-9)


@pytest.mark.parametrize("width", [0.0, 1e-6, 1e-5])
@pytest.mark.parametrize(("place", "rests"), [(0.079, True), (0.03, False)])
@pytest.mark.slow
def test_a_plate_rests_on_a_ridge_of_any_width_beyond_its_centre(width, place, rests):
    """A strip of 1e-6 is too thin for faces that overlap, and too wide for an edge."""
    ridge = [(place - 1e-3, 2e-4), (place, 0), (place + width, 0), (place + 1e-3, 2e-3)]
    profile = [(0, 0), *ridge, (0.081, 2e-3), (0.081, 0.01), (0, 0.01)]
    answer = kilter.settle(Assembly([prism("plate", profile, 0.03)]).with_floor())
    assert (answer.state, answer.level) == ("at-rest", "proved")
    assert bool(answer.distance.max() < 1e-9) is rests


@pytest.mark.parametrize("sunk", [0.0, 1e-5])
@pytest.mark.slow
def test_a_bowl_of_flat_wedges_rests_on_their_corners(sunk: float):
    """A sphere through the corners would reach 1.5 mm into the table."""
    angles, low = np.radians(np.arange(0, 361, 15)), np.radians(10)
    wedges = []
    for heights in ([low, 2 * low], [2 * low, 3 * low]):
        for pair in itertools.pairwise(angles):
            outer = [[np.sin(h) * np.cos(a), np.sin(h) * np.sin(a), -np.cos(h)]
                     for h in heights for a in pair]  # fmt: skip
            corners = 0.1 * np.vstack([outer, 0.9 * np.array(outer)])
            wedges.append((Mesh(*hull_surface(corners)), Pose()))
    shape, at = one_body(wedges, "bowl", [])
    lift = np.array([0, 0, 0.1 * np.cos(low) - sunk])
    bowl = Part("bowl", shape, Pose(at.position + lift, at.rotation))
    drawn = Assembly([TABLE, bowl], friction=0.5)
    assert not len(drawn.geometry.surfaces)
    answer = kilter.settle(drawn, require="equilibrium")
    assert answer.state == "at-rest"
    assert answer.movement[1] == pytest.approx([0, 0, sunk, 0, 0, 0], abs=1e-8)


@pytest.mark.parametrize("over", [0.49, 0.51])
@pytest.mark.slow
def test_a_sunk_stack_topples_if_its_upper_box_overhangs_by_more_than_half(over: float):
    """Answer 12: a sunk contact is no joint."""
    e, size = 3e-4, 0.1
    lower = Part("lower", Box(size, size, size), [0, 0, size / 2 - e], grounded=False)
    upper = Part("upper", Box(size, size, size), [over * size, 0, 1.5 * size - 2 * e])
    ground = floor([-1, -1], [1, 1])
    stack = Assembly([ground, lower, upper], friction=0.6)
    answer = kilter.settle(stack, require="equilibrium")
    assert answer.state == "at-rest"
    assert shift_of(answer, "lower") == pytest.approx([0, 0, e], abs=1e-7)
    if over < 0.5:
        assert shift_of(answer, "upper") == pytest.approx([0, 0, 2 * e], abs=1e-7)
    else:
        assert angle_of(answer, "upper") > 0.5
        assert "tipped" in ways(answer, "upper")
    closest = kilter.settle(stack, require="equilibrium", nearest=True)
    assert closest.state == ("at-rest" if over < 0.5 else "falls")


def test_three_boxes_that_float_above_each_other():
    """Answer 13."""
    gaps, boxes, low = (0.1, 0.05, 0.02), [], 0.0
    for k, gap in enumerate(gaps):
        low += gap
        boxes.append(block(f"box-{k}", [-0.1, -0.1, low], [0.1, 0.1, low + 0.2]))
        low += 0.2
    answer = kilter.settle(Assembly([TABLE, *boxes], friction=0.5))
    assert answer.state == "at-rest"
    assert answer.distance[1:] == pytest.approx([0.1, 0.15, 0.17], abs=1e-9)
    assert answer.angle == pytest.approx(0, abs=1e-6)


def rod_on_an_edge(length: float, beyond: float, high: float, friction: float) -> Assembly:
    """A thin rod on the top of a step that ends at x = 0, with its centre beyond the edge."""
    thin = 1e-3 * length
    step = block("step", [-2, -1, 0], [0, 1, high], grounded=True)
    rod = Part("rod", Box(length, 0.05 * length, thin), [beyond, 0, high + thin / 2])
    return Assembly([floor([-3, -2], [3, 2]), step, rod], friction=friction)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("length", "beyond", "high", "friction"),
    [(1.0, 0.2, 0.35, 1.0), (1.0, 0.05, 0.2, 0.5), (0.3, 0.03, 0.08, 0.9)],
)
def test_a_rod_turns_about_an_edge_until_its_end_meets_the_floor(length, beyond, high, friction):
    """Answer 14: friction prevents a slip on the way, and holds the leaning rod."""
    arm = length / 2 + beyond
    angle = math.asin(high / arm)
    cone = math.atan(friction)
    assert friction > 1.05 * math.tan(angle) * (1 + 12 * beyond**2 / length**2)
    leans = math.tan(angle) - beyond / arm * math.tan(angle + cone)
    assert angle + cone >= math.pi / 2 or leans < 0.95 * friction * (1 - beyond / arm)
    answer = kilter.settle(rod_on_an_edge(length, beyond, high, friction), require="equilibrium")
    assert answer.state == "at-rest"
    assert ways(answer, "rod") == ["tipped"]
    assert angle_of(answer, "rod") == pytest.approx(angle, abs=1e-6)
    half = 0.5e-3 * length
    center = np.array([beyond * math.cos(angle) + half * math.sin(angle), 0,
                       high - beyond * math.sin(angle) + half * math.cos(angle)])  # fmt: skip
    rest = shift_of(answer, "rod") + np.array([beyond, 0, high + half])
    assert rest == pytest.approx(center, abs=1e-6 * length)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_rod_that_slips_on_its_way_ends_at_rest_or_leaves(friction: float):
    """Answer 14, below the friction that prevents a slip: .854."""
    answer = kilter.settle(rod_on_an_edge(1.0, 0.2, 0.35, friction), require="equilibrium")
    assert (answer.state, answer.leaves) in [("at-rest", ()), ("falls", ("rod",))]
    assert shift_of(answer, "rod")[2] < -0.01


@pytest.mark.slow
@pytest.mark.parametrize("aside", [0.4, -0.7])
def test_a_ball_above_a_side_of_a_groove_rolls_to_its_middle(aside: float):
    """Answer 15."""
    radius = 0.02
    known = ball_in_groove(radius, 40.0, 0.01)
    parts = list(known.assembly.parts)
    place = parts[1].pose.position + np.array([aside * radius, 0, radius])
    parts[1] = Part("ball", parts[1].shape, place)
    answer = kilter.settle(Assembly(parts, friction=0.5), require="equilibrium")
    assert answer.state == "at-rest"
    middle = [-aside * radius, 0, -0.01 - radius]
    assert shift_of(answer, "ball") == pytest.approx(middle, abs=1e-6 * radius)
    assert ways(answer, "ball")[0] == "fell"
    assert "rolled" in ways(answer, "ball")


BETWEEN, GROUND = 2 - math.sqrt(3), (2 - math.sqrt(3)) / 3


def three_cylinders(between: float, ground: float, *, held: bool = False) -> Assembly:
    """A cylinder drawn .1 above its rest on two equal ones that touch, on a floor."""
    upright = turn([1, 0, 0], 90)
    places = {"left": (-1, 1), "right": (1, 1), "top": (0, 1 + math.sqrt(3) + 0.1)}
    parts = [
        Part(name, Cylinder(1, 3), Pose([x, 0, z], upright), grounded=held and name != "top")
        for name, (x, z) in places.items()
    ]
    pairs = [FrictionPair(("floor", name), ground) for name in ("left", "right")]
    ground_part = floor([-20, -20], [20, 20])
    return Assembly([ground_part, *parts], friction=between, friction_pairs=pairs)


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("between", "ground", "rests"),
    [(1.01, 1.01, True), (0.99, 1.5, False), (1.5, 0.99, False)],
)
@pytest.mark.slow
def test_a_cylinder_on_two_free_ones_rests_above_both_limits_of_friction(between, ground, rests):
    """Answer 16: they part below either limit."""
    drawn = three_cylinders(between * BETWEEN, ground * GROUND)
    answer = kilter.settle(drawn, require="equilibrium")
    aside = shift_of(answer, "right")[0] - shift_of(answer, "left")[0]
    if rests:
        assert answer.state == "at-rest"
        assert aside == pytest.approx(0, abs=1e-6)
        assert shift_of(answer, "top") == pytest.approx([0, 0, -0.1], abs=1e-6)
    else:
        assert aside > 0.1
        assert shift_of(answer, "top")[2] < -0.2


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 0.1, 1.0])
def test_a_cylinder_on_two_held_ones_rests_for_every_friction(friction: float):
    answer = kilter.settle(three_cylinders(friction, friction, held=True), require="equilibrium")
    assert answer.state == "at-rest"
    assert shift_of(answer, "top") == pytest.approx([0, 0, -0.1], abs=1e-6)


def plate_on_a_step(beyond: float) -> Assembly:
    """A plate .12 long on a step .1 wide and .05 high, its centre beyond the edge at x = 0."""
    step = block("step", [-0.1, -0.1, 0], [0, 0.1, 0.05], grounded=True)
    plate = Part("plate", Box(0.12, 0.12, 0.005), [beyond, 0, 0.0525])
    return Assembly([floor([-1, -1], [1, 1]), step, plate], friction=1.0)


@pytest.mark.slow
@pytest.mark.parametrize("beyond", [-0.001, 0.01, 0.03, 0.045])
def test_a_plate_tips_over_the_edge_of_a_step_and_leans_on_it(beyond: float):
    """Answer 17."""
    answer = kilter.settle(plate_on_a_step(beyond), require="equilibrium")
    assert answer.state == "at-rest"
    if beyond < 0:
        assert answer.distance == pytest.approx(0, abs=1e-9)
        return
    carries = {name for pair in answer.to_dict()["carries"] for name in pair}
    assert carries == {"floor", "step", "plate"}
    assert "tipped" in ways(answer, "plate")
    # the lower end is on the floor, and the lower side leans on the edge
    matrix = answer["plate"].pose.matrix
    low = answer["plate"].pose.apply([[0.06, 0, -0.0025]])[0]
    assert low[2] == pytest.approx(0, abs=1e-7)
    assert matrix[:, 2] @ (np.array([0, 0, 0.05]) - low) == pytest.approx(0, abs=1e-7)
    assert matrix[2, 1] == pytest.approx(0, abs=1e-6)


def test_a_plate_with_its_centre_above_the_edge_is_in_equilibrium_and_not_stable():
    verdict = kilter.check(plate_on_a_step(0.0))
    assert verdict.level == "equilibrium"


# answers of both modes ------------------------------------------------------------------------


@BOTH
def test_a_box_above_a_table_moves_down_without_a_rotation(nearest: bool):
    drawn = Assembly([TABLE, Part("box", Box(1, 1, 1), [0.3, 0.2, 0.51])])
    answer = kilter.settle(drawn, nearest=nearest)
    assert answer.state == "at-rest"
    assert answer.movement[1] == pytest.approx([0, 0, -0.01, 0, 0, 0], abs=1e-9)


@pytest.mark.quick("0.5-default", "0.0-nearest")
@BOTH
@pytest.mark.parametrize("friction", [0.5, 0.0])
def test_a_bar_on_blocks_of_different_height_tilts_and_without_friction_slides(nearest, friction):
    high = 1e-2
    left, right = (
        block(name, [x - 0.5, -0.5, 0], [x + 0.5, 0.5, top])
        for name, x, top in (("left", -1, 1), ("right", 1, 1 + high))
    )
    bar = Part("bar", Box(4, 1, 0.2), [0, 0, 1.1 + high])
    drawn = Assembly([TABLE, left, right, bar], friction=friction)
    answer = kilter.settle(drawn, nearest=nearest, require="equilibrium")
    if friction:
        assert answer.state == "at-rest"
        assert math.tan(angle_of(answer, "bar")) == pytest.approx(high / 2, rel=1e-6)
    elif nearest:
        assert answer.state == "falls"
        assert "bar" in answer.parts
    else:
        assert shift_of(answer, "bar")[2] < -0.1


@pytest.mark.quick("0.05-nearest", "-0.05-default")
@BOTH
@pytest.mark.parametrize("side", [0.05, -0.05])
def test_a_plate_on_four_posts_rests_on_three(nearest: bool, side: float):
    high = 1e-3
    posts = []
    for x in (-1, 1):
        for y in (-1, 1):
            top = high * ((x, y) == (1, -1))
            low = [x - 0.01, y - 0.01, -1]
            posts.append(block(f"{x:+d}{y:+d}", low, [x + 0.01, y + 0.01, top], grounded=True))
    shape = Box(2.4, 2.4, 0.1)
    plate = Part("plate", shape, [0, 0, 0.05 + high], mass=1.0, center_of_mass=[side, side, 0])
    answer = kilter.settle(Assembly([*posts, plate], friction=0.5), nearest=nearest)
    assert answer.state == "at-rest"
    normal = answer["plate"].pose.matrix[:, 2]
    slope = [0, -high / 2] if side > 0 else [high / 2, 0]
    assert -normal[:2] / normal[2] == pytest.approx(slope, abs=1e-8)


@pytest.mark.quick("0.51-default", "0.49-nearest")
@BOTH
@pytest.mark.parametrize("friction", [0.51, 0.49])
@pytest.mark.slow
def test_a_box_on_a_slope_rests_or_slides_off(nearest: bool, friction: float):
    rotation = rotation_between([0, 0, 1], [-0.5, 0, 1])
    normal = np.array([-0.5, 0, 1]) / math.hypot(0.5, 1)
    slope = Part("slope", Box(4, 4, 1), Pose(-0.5 * normal, rotation), grounded=True)
    on_it = Part("box", Box(1, 1, 1), Pose(0.501 * normal, rotation))
    answer = kilter.settle(Assembly([slope, on_it], friction=friction), nearest=nearest)
    assert answer.state == ("at-rest" if friction > 0.5 else "falls")
    if friction > 0.5 and nearest:
        assert shift_of(answer, "box") == pytest.approx(-1e-3 * normal, abs=1e-8)
    elif friction > 0.5:  # it falls straight down onto the slope
        assert shift_of(answer, "box") == pytest.approx([0, 0, -1e-3 / normal[2]], abs=1e-8)
    elif not nearest:
        assert answer.leaves == ("box",)


@BOTH
@pytest.mark.parametrize("over", [0.499, 0.501])
def test_a_box_over_the_edge_of_a_table_rests_or_falls_off(nearest: bool, over: float):
    drawn = Assembly([TABLE, Part("box", Box(1, 1, 1), [1.5 + over, 0, 0.5001])], friction=0.5)
    answer = kilter.settle(drawn, nearest=nearest)
    assert answer.state == ("at-rest" if over < 0.5 else "falls")
    if not nearest:
        assert answer.leaves == (() if over < 0.5 else ("box",))


@BOTH
@pytest.mark.parametrize("width", [1.001, 0.999])
def test_a_block_in_a_slot_fits_if_it_is_narrower(nearest: bool, width: float):
    walls = [
        block(name, [x - 0.5, -0.5, 0], [x + 0.5, 0.5, 1], grounded=True)
        for name, x in (("left", -1), ("right", 1))
    ]
    inner = Part("block", Box(width, 1, 1), [0, 0, 0.499])
    answer = kilter.settle(Assembly([TABLE, *walls, inner], friction=0.3), nearest=nearest)
    if width < 1:
        assert answer.state == "at-rest"
        assert answer.movement[3] == pytest.approx([0, 0, 1e-3, 0, 0, 0], abs=1e-8)
    else:
        assert answer.state == "does-not-fit"
        assert set(answer.parts) >= {"left", "right", "block"}
