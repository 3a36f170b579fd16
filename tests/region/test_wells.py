"""Directions in which an assembly rests, and how far it may be tipped."""

import numpy as np
import pytest
from balance_cases import CASES
from lathe import turned_part
from scipy.spatial import ConvexHull

import kilter
from kilter import Assembly, Cylinder, InputError, Mesh, Part, Pose, Sphere
from kilter.analysis.regions.tipping import find_tipping
from kilter.analysis.regions.well import Well
from kilter.assembly.changed_copies import lowest_heights
from kilter.scenes.pieces import block, floor, turn
from kilter.shape.solid import Solid, Surface

G = 9.81
DOWN = np.array([0.0, 0.0, -1.0])


def on_table(part: Part, units: str = "m") -> Assembly:
    size = 20.0
    return Assembly([floor([-size, -size], [size, size]), part], units=units)


def well_of(part: Part, units: str = "m") -> Well | None:
    (rest,) = kilter.region(on_table(part, units), rests=True).rests
    return rest.well


def lathed(*profile: tuple[float, ...], **properties: float) -> Part:
    return turned_part("b", profile, **properties)


def roly_poly(height: float) -> Part:
    """A half ball of radius 1 that goes on as a cylinder."""
    return lathed((0, 0), (1, 1, 0, 1), (1, 1 + height), (0, 1 + height))


def half_cylinder(sides: int = 24) -> Part:
    """Of radius 1 and length 3 along y, its round side down."""
    angle = np.linspace(np.pi, 2 * np.pi, sides + 1)
    arc = np.column_stack([np.cos(angle), np.zeros(sides + 1), 1 + np.sin(angle)])
    near, far = (arc + np.array([0, y, 0]) for y in (-1.5, 1.5))
    n, k = sides + 1, np.arange(sides)
    halves = (k, k + 1 + n, k + 1), (k, k + n, k + 1 + n)
    round_ = np.vstack([np.column_stack(half) for half in halves])
    ends = np.column_stack([0 * k[1:], k[1:], k[1:] + 1])
    flat = np.array([[0, sides, sides + n], [0, sides + n, n]])
    triangles = np.vstack([round_[:, ::-1], ends, (ends + n)[:, ::-1], flat[:, ::-1]])
    label = np.repeat([0, 1, 2, 3], [2 * sides, sides - 1, sides - 1, 2])
    area, drop = np.pi / 2, 4 / (3 * np.pi)
    volume = 3 * area
    surfaces = (
        Surface("cylinder", [0, 0, 1], [0, 1, 0], radius=1.0),
        Surface("plane", [0, -1.5, 0], [0, -1, 0]),
        Surface("plane", [0, 1.5, 0], [0, 1, 0]),
        Surface("plane", [0, 0, 1], [0, 0, 1]),
    )
    second = np.diag([volume / 4, volume * 9 / 12, volume * (0.25 - drop**2)])
    shape = Solid(
        np.vstack([near, far]), triangles, surfaces, label, volume, [0, 0, 1 - drop], second,
        sagitta=1 - np.cos(np.pi / (2 * sides)),
    )  # fmt: skip
    return Part("b", shape)


# boxes ------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("units", "metres"), [("m", 1.0), ("mm", 1e-3)])
def test_a_box_tips_over_its_nearest_edge(units, metres):
    well = well_of(block("b", [0, 0, 0], [1.0, 1.4, 3.0], mass=2.0), units)
    assert well is not None
    assert well.over_deg == pytest.approx(np.degrees(np.arctan2(0.5, 1.5)), rel=1e-12)
    assert well.barrier == pytest.approx(2 * G * (np.hypot(1.5, 0.5) - 1.5) * metres, rel=1e-12)
    assert (well.stiffness, well.axis, well.period) == (None, None, None)


def test_a_turned_box_has_the_same_well():
    straight = block("b", [0, 0, 0], [1.0, 1.4, 3.0])
    assembly = on_table(straight)
    expected = find_tipping(assembly.geometry, 1, DOWN)
    rotation = turn([1, 2, -1], 77.0)
    turned = Assembly([Part("b", straight.shape, Pose([3, 1, 2], rotation))])
    down = Pose([0, 0, 0], rotation).matrix[:3, :3] @ DOWN
    found = find_tipping(turned.geometry, 0, down)
    assert expected is not None
    assert found is not None
    assert found.angle == pytest.approx(expected.angle, rel=1e-9)
    assert found.rise == pytest.approx(expected.rise, rel=1e-9)


def test_what_rolls_on_to_a_face_it_cannot_rest_on_goes_over_later():
    """A chamfer beside its base takes the tilt, and the next edge is what it goes over."""
    chamfer = np.array([[-1, 0], [0.8, 0], [1.1, 0.15], [1.1, 2], [-1, 2]])
    corners = np.vstack([np.insert(chamfer, 1, y, axis=1) for y in (-1.0, 1.0)])
    hull = ConvexHull(corners)
    legs = corners[hull.simplices[:, 1:]] - corners[hull.simplices[:, :1]]
    out = np.einsum("ij,ij->i", np.cross(legs[:, 0], legs[:, 1]), hull.equations[:, :3]) > 0
    faces = np.where(out[:, None], hull.simplices, hull.simplices[:, ::-1])
    center = np.array([0.5, 0.0, 0.4])
    part = Part("b", Mesh(corners, faces), center_of_mass=center)
    tipping = find_tipping(Assembly([part]).geometry, 0, DOWN)
    assert tipping is not None
    assert tipping.angle == pytest.approx(np.arctan2(0.3, 0.4))  # over the edge of its base
    assert tipping.rise == pytest.approx(np.hypot(0.6, 0.25) - 0.4)  # over that of the chamfer


# rounds -----------------------------------------------------------------------------------------


@pytest.mark.slow
def test_a_half_ball_rights_itself_by_three_eighths():
    well = well_of(lathed((0, 0), (1, 1, 0, 1), (0, 1), mass=2.0))
    assert well is not None
    assert well.stiffness == pytest.approx(2 * G * 3 / 8, rel=1e-12)
    assert well.period == pytest.approx(2 * np.pi * np.sqrt(83 / 320 / (G * 3 / 8)), rel=1e-12)
    assert well.over_deg == pytest.approx(np.degrees(np.arctan2(1, -3 / 8)), rel=1e-12)
    assert well.barrier == pytest.approx(2 * G * (np.hypot(1, 3 / 8) - 5 / 8), rel=1e-12)
    assert well.axis is not None
    assert abs(well.axis[2]) < 1e-12


@pytest.mark.slow
def test_a_half_ball_on_its_flat_side():
    well = well_of(lathed((0, 0), (1, 0), (0, 1, 0, 0), mass=2.0))
    assert well is not None
    assert well.over_deg == pytest.approx(np.degrees(np.arctan(8 / 3)), rel=1e-12)
    assert well.barrier == pytest.approx(2 * G * (np.hypot(1, 3 / 8) - 3 / 8), rel=1e-12)


@pytest.mark.slow
def test_a_half_cylinder_rights_itself_about_its_length_only():
    part = half_cylinder()
    mass = 1000 * 1.5 * np.pi
    well = well_of(part)
    drop = 4 / (3 * np.pi)
    assert well is not None
    assert well.stiffness == pytest.approx(mass * G * drop, rel=1e-9)
    assert np.abs(well.axis) == pytest.approx([0, 1, 0], abs=1e-9)
    about = 0.5 - drop**2  # the inertia about its centre of mass, over its mass
    assert well.period == pytest.approx(2 * np.pi * np.sqrt(about / (G * drop)), rel=1e-9)
    assert (well.over_deg, well.barrier) == (None, None)  # not of revolution about the vertical


@pytest.mark.slow
@pytest.mark.parametrize("beside", [-1e-3, 1e-3])
def test_a_roly_poly_of_one_density_stands_up_to_r_over_root_two(beside):
    height = 1 / np.sqrt(2) + beside
    well = well_of(roly_poly(height))
    assert (well is not None) == (beside < 0)
    if well is not None:
        volume = 2 / 3 + height
        center = (2 / 3 * 5 / 8 + height * (1 + height / 2)) / volume
        assert well.stiffness == pytest.approx(1000 * np.pi * volume * G * (1 - center), rel=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("rise", [-1e-4, 1e-4])
def test_a_weeble_stands_where_its_centre_of_mass_is_low(rise):
    ball = Part("b", Sphere(1.0), Pose([0, 0, 1]), mass=3.0, center_of_mass=[0, 0, rise])
    well = well_of(ball)
    assert (well is not None) == (rise < 0)
    if well is not None:
        assert (well.over_deg, well.barrier) == (180.0, None)
        assert well.stiffness == pytest.approx(-3.0 * G * rise, rel=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("part", "base", "center"),
    [
        (Part("coin", Cylinder(1.0, 0.1), Pose([0, 0, 0.05])), 1.0, 0.05),
        (Part("post", Cylinder(0.2, 3.0), Pose([0, 0, 1.5])), 0.2, 1.5),
        (turned_part("cone", [(0, 0), (1, 0), (0, 2)]), 1.0, 0.5),
        (turned_part("ring", [(0.5, 0), (1, 0), (1, 1), (0.5, 1), (0.5, 0)]), 1.0, 0.5),
    ],
    ids=["coin", "post", "cone", "ring"],
)
def test_what_stands_on_a_round_base_tips_over_its_rim(part, base, center):
    well = well_of(part)
    assert well is not None
    assert well.over_deg == pytest.approx(np.degrees(np.arctan2(base, center)), rel=1e-9)
    assert well.stiffness is None


@pytest.mark.slow
def test_what_only_rolls_or_balances_has_no_well():
    assert well_of(Part("ball", Sphere(1.0), Pose([0, 0, 1]))) is None
    lying = Part("log", Cylinder(1.0, 3.0), Pose([0, 0, 1], turn([1, 0, 0], 90)))
    assert well_of(lying) is None
    assert find_tipping(Assembly([lathed((0, 0), (1, 2), (0, 2))]).geometry, 0, DOWN) is None


# a second method: the heights of the exact hull ---------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize(
    "part",
    [
        lathed((0, 0), (1, 1, 0, 1), (0, 1)),
        roly_poly(0.6),
        lathed((0, 0), (0.5, 0), (1, 0.5, 0.5, 0.5), (0.3, 2), (0, 2)),
        lathed((0, 0), (1, 0), (1, 2), (0.9, 2), (0.9, 0.1), (0, 0.1)),
        block("b", [0, 0, 0], [1, 2, 1.5]),
    ],
    ids=["half ball", "roly-poly", "bottle", "cup", "box"],
)
def test_the_height_of_its_centre_rises_up_to_its_tilt_and_falls_beyond(part):
    geometry = Assembly([part]).geometry
    tipping = find_tipping(geometry, 0, DOWN)
    assert tipping is not None
    assert tipping.rise is not None

    def height(angle: float, way: float) -> float:
        level = np.array([np.cos(way), np.sin(way), 0])
        up = -(np.cos(angle) * DOWN + np.sin(angle) * level)
        return float(geometry.center[0] @ up - lowest_heights(geometry, up)[0])

    turned = len(geometry.surfaces) > 0
    for way in [0.3] if turned else np.linspace(0, 2 * np.pi, 8, endpoint=False):
        rising = [height(angle, way) for angle in np.linspace(0, tipping.angle, 6)]
        assert np.all(np.diff(rising) > 0)
    top = height(tipping.angle, 0.0)
    assert top - height(0.0, 0.0) == pytest.approx(tipping.rise, rel=1e-9)
    assert height(tipping.angle + 1e-3, 0.0) < top


def corner(mu: float = 0.0) -> Assembly:
    """A cube in the corner of three walls."""
    walls = [
        block("floor", [-1, -1, -1], [2, 2, 0], grounded=True),
        block("left", [-1, -1, 0], [0, 2, 2], grounded=True),
        block("back", [0, -1, 0], [2, 0, 2], grounded=True),
    ]
    return Assembly([*walls, block("cube", [0, 0, 0], [1, 1, 1])]).with_friction(mu)


@pytest.mark.slow
def test_a_cube_in_a_corner_is_v_shaped_about_its_axis():
    """The nearest wall is arcsin(1 / sqrt 3) away; no curvature is asked for."""
    axis, *edges = kilter.region(corner(), rests=True).rests
    assert axis.down == pytest.approx(-np.ones(3) / np.sqrt(3))
    assert (axis.state, axis.rate) == ("minimum", None)
    assert axis.tilt_deg == pytest.approx(np.degrees(np.arcsin(1 / np.sqrt(3))))
    assert len(edges) == 3
    for edge in edges:
        assert (edge.state, edge.tilt_deg, edge.moving) == ("free", pytest.approx(0), ("cube",))


@pytest.mark.slow
@pytest.mark.parametrize("wall", [[1, 0, 0], [0, 1, 0], [0, 0, 1]])
def test_up_to_its_tilt_it_stays_and_beyond_it_moves(wall):
    rest = kilter.region(corner(), rests=True).rests[0]
    assert rest.tilt_deg is not None
    across = wall - (wall @ rest.down) * rest.down
    across /= np.linalg.norm(across)
    for by, verdict in ((-1e-3, "stable"), (1e-3, "unstable")):
        angle = np.radians(rest.tilt_deg) + by
        down = np.cos(angle) * rest.down + np.sin(angle) * across
        assert kilter.check(corner().with_down(down)).verdict == verdict


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "state"), [("01", "free"), ("02", "balanced"), ("03", "minimum"), ("05", "free")]
)
def test_what_is_round_rests_as_a_check_says(number, state):
    assembly = next(case for case in CASES if case.number == number).build(0.0)
    rests = kilter.region(assembly, rests=True).rests
    at = [rest for rest in rests if np.allclose(rest.down, assembly.down, atol=1e-9)]
    straight = at or [rests[0]]
    assert straight[0].state == state
    assert straight[0].strict == (state == "minimum")


def test_a_ball_in_a_bowl_has_no_width_but_swings_as_a_pendulum_does():
    """A pendulum of length R - r: the well is curved, and to first order any tilt is too much."""
    bowl = next(case for case in CASES if case.number == "03").build(0.0)
    (rest,) = kilter.region(bowl, rests=True).rests
    assert (rest.tilt_deg, rest.moving) == (0.0, ())
    assert rest.rate == pytest.approx(np.sqrt(9.81 / 0.6), rel=1e-6)


def test_friction_is_refused():
    with pytest.raises(InputError, match="only without friction"):
        kilter.region(corner(0.3), rests=True)


def test_nothing_is_told_that_was_not_asked():
    assert kilter.region(corner()).to_dict()["rests"] == []


def test_where_no_direction_is_stable_there_is_no_rest():
    floating = [
        block("held", [0, 0, 0], [1, 1, 1], grounded=True),
        block("b", [3, 0, 0], [4, 1, 1]),
    ]
    answer = kilter.region(Assembly(floating), rests=True)
    assert (answer.kind, answer.rests) == ("none", ())
