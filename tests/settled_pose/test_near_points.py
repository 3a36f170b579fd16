"""Candidate points of parts of any shape: gaps, normals and positions in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from play_scenes import (
    EXACT,
    KnownRest,
    button,
    pin_in_through_hole,
    random_scene,
    ring_on_bar,
    tray,
    turned,
)
from scipy.spatial.transform import Rotation
from translations import sink

import kilter
from kilter import Assembly, Box, Cylinder, Mesh, Part, Pose, Prism, Sphere
from kilter.analysis.settled_pose.candidate_points import CandidatePoints
from kilter.analysis.settled_pose.clear_segments import _crosses, are_clear
from kilter.analysis.settled_pose.near_points import (
    FEW_TRIANGLES,
    NearPoints,
    find_near_points,
    surface_gaps,
)
from kilter.analysis.settled_pose.rest_proof import closed_gap, closed_points
from kilter.analysis.settled_pose.rigid_bodies import rigid_bodies
from kilter.contact.common.contact_search import begin_search
from kilter.contact.common.distances import surface_distance
from kilter.contact.common.facets import warps
from kilter.contact.common.gaps import Tolerance
from kilter.files.robots.one_body import one_body
from kilter.scenes.pieces import block, cells, floor, tube, turn
from kilter.shape.primitives import BOX_CORNERS, hull_surface, surface


def sinks_as_known(scene: KnownRest) -> None:
    geometry = scene.assembly.geometry
    size = float(np.median(geometry.size[~geometry.grounded]))
    farthest = max(float(np.linalg.norm(by)) for by in scene.shift.values())
    found, _ = sink(scene.assembly, max(1.2 * farthest, 0.05 * size))
    down = scene.assembly.down
    for name, by in scene.shift.items():
        assert found[name] @ down == pytest.approx(np.array(by) @ down, abs=1e-9 * size)


SINKING = [scene for scene in (make() for make in EXACT) if scene.shift and not scene.angle]


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    "scene", SINKING, ids=lambda scene: scene.name + f"-{len(scene.assembly.geometry.vertices)}"
)
def test_parts_with_play_sink_to_their_rest(scene):
    """The boards of a cabinet may also slide without friction, so only the others are compared."""
    if scene.name == "cabinet":
        scene = replace(scene, shift={"bottom": (0.0, 0.0, 0.0)})
    sinks_as_known(scene)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_parts_with_play_sink_to_their_rest_in_any_direction(seed):
    scene = random_scene(np.random.default_rng(seed))
    if scene.shift and not scene.angle and scene.name != "cabinet":
        sinks_as_known(scene)


@pytest.mark.parametrize(
    "scene",
    [pin_in_through_hole(), button(flanged=False), button(square=True, flanged=False)],
    ids=["pin", "round", "square"],
)
def test_nothing_carries_a_body_in_a_through_hole(scene):
    points = find_near_points(scene.assembly, 1e-3, 1e-3)
    assert len(points)
    assert np.abs(points.normal @ scene.assembly.down).max() < 1e-9


# walls ----------------------------------------------------------------------------------------


def halves(sunk: float) -> Assembly:
    """A case of two halves, 1.8 thick, whose edges touch or are sunk into each other."""
    low = tray("low", [60, 40, 15], 1.8, [-30, -20, 0], grounded=True)
    mesh = low.shape
    high = Part("high", mesh, Pose([0, 0, 30 - sunk], turn([1, 0, 0], 180)))
    return Assembly([low, high], units="mm", gravity=[0, 0, -9810])


@pytest.mark.parametrize("sunk", [0.0, 0.05])
@pytest.mark.parametrize("reach", [1.0, 3.0, 5.0, 12.0])
def test_no_reach_sees_through_a_wall(sunk, reach):
    points = find_near_points(halves(sunk), reach, reach)
    assert points.gap.min() == pytest.approx(-sunk, abs=1e-12)
    near = points.gap < 1e-9
    assert np.abs(points.normal[near] - [0, 0, 1]).max() < 1e-12
    corners = points.point[near, :2]
    assert np.ptp(corners, axis=0) == pytest.approx([60, 40])


@pytest.mark.parametrize("reach", [0.015, 0.2])
def test_rings_have_no_depth_through_their_holes(reach):
    """The outer ends of two rings face away from each other, and their middles lie in the holes."""
    low, high = (tube(name, 0.03, 0.1, 0.02, [0, 0, z]) for name, z in (("a", 0.0), ("b", 0.03)))
    points = find_near_points(Assembly([low, high]), reach, reach)
    assert points.gap.min() == pytest.approx(0.01, abs=1e-12)


def test_a_penetration_that_is_deeper_than_the_reach_stays_known():
    ring = tube("ring", 0.03, 0.1, 0.05, [0, 0, 0.025])
    bodies = rigid_bodies(Assembly([floor([-1, -1], [1, 1]), ring]), ())
    candidates = CandidatePoints.of(bodies)
    for k in range(6):
        points = candidates.near(bodies, 1e-3)
        assert points.gap.min() == pytest.approx(-0.002 * k, abs=1e-12)
        bodies = bodies.moved(np.array([[0.0] * 6, [0, 0, -0.002, 0, 0, 0]]))


@pytest.mark.parametrize(("height", "clear"), [(0.5, True), (2.5, False)])
def test_a_segment_is_clear_if_no_wall_is_in_between(height, clear):
    """A plate of thickness 1 over a slab, and a lid of the same part above the plate."""
    solid = np.zeros((1, 1, 3), dtype=bool)
    solid[0, 0, [0, 2]] = True
    shelf = Part("shelf", cells([0, 1], [0, 1], [0.5, 1.5, 2.5, 3.5], solid))
    assembly = Assembly([floor([-1, -1], [2, 2]), shelf])
    search = begin_search(assembly, Tolerance(gap=1.0), lambda stage: None)
    start, end = np.array([[0.3, 0.4, 0.0]]), np.array([[0.3, 0.4, height]])
    assert are_clear(search, np.array([0]), start, end).tolist() == [clear]
    assert are_clear(search, np.array([0]), end, start).tolist() == [clear]


def warped(name: str, half: float, low: float, drop: float, grounded: bool = False) -> Part:
    """A block up to the plane z = 0, of which a corner is lower by `drop`."""
    vertices, triangles = surface(Box([2 * half, 2 * half, -low]))
    vertices = np.add(vertices, [0, 0, low / 2])
    vertices[np.isclose(vertices, [half, half, 0]).all(axis=1), 2] -= drop
    return Part(name, Mesh(vertices, triangles), grounded=grounded)


@pytest.mark.parametrize("sunk", [2e-6, 1e-5])
@pytest.mark.parametrize("drop", [1e-6, -1e-6])
def test_a_warped_face_hides_no_penetration(drop, sunk):
    """The triangles of a warped face lie between its plane and the face that is sunk into it."""
    high = Part("high", Box([1, 1, 1]), [0, 0, 0.5 - sunk])
    points = find_near_points(Assembly([warped("low", 0.5, -1, drop, True), high]), 1e-4, 1e-4)
    assert len(points) == 4
    assert np.abs(points.gap + sunk).max() <= abs(drop)


@pytest.mark.parametrize(("share", "clear"), [(0.5, True), (2.0, False)])
def test_a_wall_within_the_warp_of_an_end_hides_nothing(share, clear):
    plate = warped("plate", 1.0, -0.5, 1e-6)
    floor_below = floor([-1, -1], [2, 2])
    search = begin_search(Assembly([floor_below, plate]), Tolerance(gap=1.0), lambda stage: None)
    warp = float(warps(search.geometry, search.facets).max())
    assert warp > 1e-7
    end = np.array([[0.3, 0.4, -0.5 + 10 * warp]])
    start = np.array([[0.3, 0.4, -0.5 - share * warp]])
    assert are_clear(search, np.array([0]), start, end).tolist() == [clear]


# edges that cross faces, corners --------------------------------------------------------------


def knives(gap: float = 0.0, at: float = 0.5) -> Assembly:
    """A beam .2 wide across two knife edges .4 wide."""
    edge = [[-0.05, 0], [0.05, 0], [0, 0.1]]
    held = [
        Part(name, Prism(edge, 0.4), [x, 0, 0], grounded=True)
        for name, x in (("left", -0.5), ("right", at))
    ]
    beam = Part("beam", Box([1.4, 0.2, 0.1]), [0, 0, 0.15 + gap])
    return Assembly([*held, beam], friction=0.5)


@pytest.mark.parametrize("gap", [0.0, 3e-3, -3e-3])
def test_edges_that_cross_a_face_without_a_corner_count(gap):
    points = find_near_points(knives(gap), 0.01, 0.01)
    assert points.bears.all()
    assert points.gap == pytest.approx(gap, abs=1e-15)
    assert np.abs(points.normal - [0, 0, 1]).max() < 1e-12
    places = sorted(map(tuple, points.point[:, :2].round(12).tolist()))
    assert places == [(-0.5, -0.1), (-0.5, 0.1), (0.5, -0.1), (0.5, 0.1)]


@pytest.mark.parametrize(("at", "count"), [(0.699, 4), (0.701, 2)])
def test_an_edge_beside_a_face_carries_nothing(at, count):
    assert find_near_points(knives(at=at), 1e-4, 1e-4).bears.sum() == count


def test_a_beam_on_knife_edges_is_at_rest():
    answer = kilter.settle(knives())
    assert answer.state == "at-rest"
    assert np.abs(answer.movement).max() < 1e-12


# one depth ------------------------------------------------------------------------------------


def table(*, legs: bool) -> Part:
    """A table of a top and four legs, or its top alone; the top ends at z = 0."""
    lines = [-0.5, -0.45, 0.45, 0.5], [-0.3, -0.25, 0.25, 0.3]
    solid = np.zeros((3, 3, 2), dtype=bool)
    solid[:, :, 1] = True
    if legs:
        solid[::2, ::2, 0] = True
    return Part("table", cells(*lines, [-0.5, -0.04, 0.0], solid), grounded=True)


def can(kind: str, tilt: float, depth: float, at: tuple[float, float] = (0.1, 0.05)) -> Part:
    """A body whose lowest point lies at -depth."""
    angle = np.arange(32) * np.pi / 16
    rings = [
        np.column_stack([r * np.cos(angle), r * np.sin(angle), 0 * angle + z])
        for r, z in ((0.027, -0.05), (0.03, -0.047), (0.03, 0.047), (0.027, 0.05))
    ]
    hull = Mesh.convex_hull(np.concatenate(rings))
    shape = {"hull": hull, "box": Box([0.06, 0.06, 0.1]), "cylinder": Cylinder(0.03, 0.1)}[kind]
    rotation = turn([1, 0.3, 0], tilt)
    lowest = float(Pose([0, 0, 0], rotation).apply(surface(shape)[0])[:, 2].min())
    if kind == "cylinder":
        lean = np.radians(tilt)
        lowest = -0.05 * float(np.cos(lean)) - 0.03 * float(np.sin(lean))
    return Part("can", shape, Pose([*at, -depth - lowest], rotation))


@pytest.mark.slow
@pytest.mark.parametrize("legs", [True, False], ids=["table", "top"])
@pytest.mark.parametrize("depth", [5e-4, 0.014])
@pytest.mark.parametrize("tilt", [0.0, 1.0, 5.0, 30.0])
@pytest.mark.parametrize("kind", ["box", "hull", "cylinder"])
def test_an_overlap_has_one_depth(kind, tilt, depth, legs):
    """The depth of detection uses triangles, which end short of the rim of a cylinder."""
    assembly = Assembly([table(legs=legs), can(kind, tilt, depth)], friction=0.5)
    (overlap,) = kilter.contacts(assembly).overlaps
    slack = float(assembly.geometry.slack.sum()) if kind == "cylinder" else 0.0
    assert overlap.depth == pytest.approx(depth, abs=1e-12 + slack)
    bodies = rigid_bodies(assembly, ())
    points = CandidatePoints.of(bodies).near(bodies, 2 * depth)
    deepest = int(points.gap.argmin())
    assert -points.gap[deepest] == pytest.approx(depth, abs=1e-12)
    assert points.normal[deepest] == pytest.approx([0, 0, 1], abs=1e-9)


@pytest.mark.parametrize(("aside", "normal"), [(0.004, [0, 0, 1]), (0.001, [1, 0, 0])])
def test_an_overlap_beside_an_edge_opens_in_the_shallower_direction(aside, normal):
    """A box .002 deep in the top of a table, and `aside` within its side."""
    side = 0.5 + 0.03 - aside
    assembly = Assembly([table(legs=True), can("box", 0.0, 0.002, (side, 0.0))])
    points = find_near_points(assembly, 0.01, 0.01)
    deep = points.gap < 0
    assert points.gap.min() == pytest.approx(-min(aside, 0.002), abs=1e-12)
    assert np.abs(points.normal[deep] - normal).max() < 1e-9


def test_two_overlaps_of_a_pair_count_both():
    """A box is sunk by .001 into the ground and by .002 into the wall of the same part."""
    solid = np.ones((2, 1, 2), dtype=bool)
    solid[1, 0, 1] = False
    corner = Part("corner", cells([-1, 0, 2], [-1, 1], [-1, 0, 2], solid), grounded=True)
    box = block("box", [-0.002, -0.5, -0.001], [0.998, 0.5, 0.999])
    points = find_near_points(Assembly([corner, box]), 0.01, 0.01)
    for normal, depth in (([0, 0, 1], 0.001), ([1, 0, 0], 0.002)):
        along = np.abs(points.normal - normal).max(axis=1) < 1e-9
        assert points.gap[along].min() == pytest.approx(-depth, abs=1e-12)


# holes ----------------------------------------------------------------------------------------


def on_both(points: NearPoints, axes: list[Part], radii: list[float]) -> None:
    """The point is the middle between points of two cylinders, along the normal."""
    half = points.gap[:, None] / 2 * points.normal
    for part, radius, sense in zip(axes, radii, (-1.0, 1.0), strict=True):
        x = points.point + sense * half - part.pose.position
        axis = part.pose.matrix[:, 2]
        across = x - (x @ axis)[:, None] * axis
        assert np.linalg.norm(across, axis=1) == pytest.approx(radius, abs=1e-13)


@pytest.mark.parametrize("tilt", [0.0, 0.01, 1.0])
@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), (1e-4, -5e-5, 2e-3), (0.0, 2.9e-4, 0.0)])
@pytest.mark.slow
def test_points_of_a_pin_in_a_hole_lie_between_the_exact_cylinders(tilt, shift):
    hole = tube("hole", 0.0103, 0.02, 0.025, grounded=True)
    pin = Part("pin", Cylinder(0.01, 0.05), Pose(shift, turn([1, 2, 0], tilt)))
    points = find_near_points(Assembly([hole, pin], gravity=[0, -9.81, 0]), 1e-3, 1e-3)
    on_both(points, [hole, pin], [0.0103, 0.01])
    # the hole is below the pin, at both sides and above; its normals differ by the play
    angle = np.degrees(np.arctan2(points.normal[:, 0], points.normal[:, 1]))
    for side in (0, -90, 90, 180):
        off = np.abs((angle - side + 180) % 360 - 180).min()
        assert off < np.degrees(2 * np.linalg.norm(shift[:2]) / 0.01) + 2 * tilt + 1e-9


@pytest.mark.parametrize("tilt", [5.0, 20.0])
def test_a_pin_that_is_tilted_in_its_hole_has_points_at_the_walls(tilt):
    """In the plane of the tilt, an end of the wall is R cos - h sin from the axis of the pin."""
    hole = tube("hole", 0.0103, 0.02, 0.01, grounded=True)
    pin = Part("pin", Cylinder(0.005, 0.05), Pose([0, 0, 0], turn([1, 0, 0], tilt)))
    points = find_near_points(Assembly([hole, pin], gravity=[0, -9.81, 0]), 5e-3, 5e-3)
    for side in (-1, 1):
        near = points.normal[:, 1] * side > 0.9
        angle = np.radians(tilt)
        known = 0.0103 * np.cos(angle) - 0.005 - 0.005 * np.sin(angle)
        assert points.gap[near].min() == pytest.approx(known, abs=1e-12)


def test_a_ring_around_a_bar_has_points_at_any_play():
    scene = turned(ring_on_bar(0.01, 0.03), turn([1, 2, 3], 40))
    points = find_near_points(scene.assembly, 0.0101, 0.0101)
    assert points.gap == pytest.approx(0.01, abs=1e-12)
    assert (points.normal @ -scene.assembly.down).max() == pytest.approx(1.0, abs=1e-12)
    assert not len(find_near_points(scene.assembly, 0.0099, 0.0099))


# the judge, and pairs that move ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("point", "normal", "sound"),
    [
        ([0.2, 0.1, 0.0], [0, 0, 1], True),
        ([0.2, 0.1, 0.0], [0.002, 0, 1], False),  # no face looks that way
        ([0.5, 0.1, 0.0], [0, 0, 1], True),  # on an edge of the box
        ([0.5, 0.1, 0.0], [-0.3, 0, 1], False),  # in the cone of the box, not of the floor
        ([0.2, 0.1, 1e-7], [0, 0, 1], False),  # off both faces
    ],
)
def test_a_closed_point_lies_on_faces_that_its_normal_fits(point, normal, sound):
    assembly = Assembly([floor([-2, -2], [2, 2]), block("box", [-0.5, -0.5, 0], [0.5, 0.5, 1])])
    unit = np.array([normal]) / np.linalg.norm(normal)
    apart, found = closed_points(assembly, np.array([[0, 1]]), np.array([point]), unit, 1e-8)
    assert apart[0] == pytest.approx(2 * point[2], abs=1e-15)
    assert found.tolist() == [sound]


@pytest.mark.parametrize(("share", "sound"), [(0.5, True), (2.0, False)])
def test_the_normal_of_a_curved_surface_turns_within_the_gap_that_counts_as_closed(share, sound):
    """Two crossed cylinders touch at a point; its normal is that of a point beside it."""
    gap, radius = 1e-8, 0.3
    low = Part("low", Cylinder(radius, 1), Pose([0, 0, -radius], turn([1, 0, 0], 90)))
    high = Part("high", Cylinder(radius, 1), Pose([0, 0, radius], turn([0, 1, 0], 90)))
    tilted = np.array([[share * gap / radius, 0, 1.0]])
    pair = np.array([[0, 1]])
    _, found = closed_points(Assembly([low, high]), pair, np.zeros((1, 3)), tilted, gap)
    assert found.tolist() == [sound]


@pytest.mark.parametrize(("share", "sound"), [(0.9, True), (3.0, False)])
def test_the_normal_of_a_warped_face_is_uncertain_by_its_tilt(share, sound):
    """A corner of the upper face is lowered by `drop`."""
    drop = 1e-7
    vertices, triangles = surface(Box([1, 1, 1]))
    lowered = vertices - [[0, 0, drop]] * np.isclose(vertices, [0.5, 0.5, 0.5]).all(axis=1)[:, None]
    table = Part("table", Mesh(lowered, triangles))
    ball = Part("ball", Sphere(1e3), Pose([0, 0, 0.5 + 1e3]))
    tilted = np.array([[share * drop / np.sqrt(2), share * drop / np.sqrt(2), 1.0]])
    pair, point = np.array([[0, 1]]), np.array([[0, 0, 0.5]])
    _, found = closed_points(Assembly([table, ball]), pair, point, tilted, drop)
    assert found.tolist() == [sound]


@pytest.mark.parametrize("tilt", [0.0, 3e-9, -1e-8])
@pytest.mark.parametrize("yaw", [0.05, 0.2, 0.5])
def test_all_points_of_faces_that_are_parallel_to_rounding_have_a_normal_that_fits(yaw, tilt):
    """The normal across two edges of such faces deviates by their tilt over the sine of the yaw."""
    beam = Part("beam", Box([0.2, 0.02, 0.02]), [0, 0, -0.01], grounded=True)
    low = np.array([[-1, -0.3, 0], [1, -0.3, 0], [1, 0.3, 0], [-1, 0.3, 0]]) * 0.05
    corners = np.vstack([low, 0.7 * low + [0, 0, 0.03]])
    leans = Rotation.from_rotvec([tilt, -tilt, 0]) * Rotation.from_rotvec([0, 0, yaw])
    pose = Pose([0, 0, 0], leans.as_quat(scalar_first=True))
    assembly = Assembly([beam, Part("frustum", Mesh(*hull_surface(corners)), pose)])
    bodies = rigid_bodies(assembly, ())
    points = CandidatePoints.of(bodies).near(bodies, 1e-5)
    pairs = np.column_stack([points.part_a, points.part_b])
    gap = closed_gap(assembly)
    apart, sound = closed_points(assembly, pairs, points.point, points.normal, gap)
    assert len(points) >= 4
    assert (apart <= gap).all()
    assert sound.all()


def test_closed_points_of_a_compound_have_the_distance_of_its_nearest_member():
    """Members that lie near are compared first: the distances are those from all members."""
    rng = np.random.default_rng(5)
    turns = Rotation.random(12, random_state=5).as_quat(scalar_first=True)
    placed = [
        (Box(rng.uniform(0.05, 0.2, 3)), Pose(rng.uniform(-0.5, 0.5, 3), turn)) for turn in turns
    ]
    cloud = Part("cloud", *one_body(placed, "cloud", []))
    assembly = Assembly([cloud, Part("ball", Sphere(2.0), [0, 0, 5])])
    points = rng.uniform(-0.6, 0.6, (60, 3))
    points[:20] = [pose.apply(BOX_CORNERS[[k % 8]] * box.size)[0] for k in range(20)
                   for box, pose in placed[k % 12 : k % 12 + 1]]  # fmt: skip
    local = [np.abs((points - pose.position) @ pose.matrix) - box.size / 2 for box, pose in placed]
    signed = [
        np.linalg.norm(np.maximum(x, 0), axis=1) + np.minimum(x.max(axis=1), 0) for x in local
    ]
    known = np.abs(signed).min(axis=0) + np.abs(np.linalg.norm(points - [0, 0, 5], axis=1) - 2.0)
    pairs = np.tile([0, 1], (len(points), 1))
    for gap in (1e-9, 0.02, 1.0):
        apart, _ = closed_points(assembly, pairs, points, np.tile([0, 0, 1.0], (60, 1)), gap)
        assert apart == pytest.approx(known, abs=1e-12)


@pytest.mark.parametrize("corners", [FEW_TRIANGLES // 2 + 2, FEW_TRIANGLES // 2 + 3])
def test_parts_of_few_and_of_many_triangles_have_the_same_distances(corners):
    rng = np.random.default_rng(corners)
    points = rng.normal(size=(corners, 3))
    hull = Mesh(*hull_surface(points / np.linalg.norm(points, axis=1)[:, None]))
    assert len(hull.triangles) == 2 * corners - 4
    geometry = Assembly([Part("hull", hull), Part("ball", Sphere(0.5), [3, 0, 0])]).geometry
    places = rng.uniform(-2, 2, (40, 3))
    expected = surface_distance(places, geometry.corners_of(0))
    ball = np.abs(np.linalg.norm(places - [3, 0, 0], axis=1) - 0.5)
    parts = np.tile([0, 1], (len(places), 1))
    assert surface_gaps(geometry, parts[:, :1], places) == pytest.approx(expected, abs=1e-14)
    assert surface_gaps(geometry, parts, places) == pytest.approx(expected + ball, abs=1e-14)


@pytest.mark.parametrize(("x", "crosses"), [(0.2, True), (-0.1, False)])
def test_a_segment_crosses_a_triangle_from_both_sides(x, crosses):
    corners = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    low, high = np.array([[x, 0.2, -1.0]]), np.array([[x, 0.2, 1.0]])
    along = high, high + 1e-3 * np.eye(3)[:1]
    for start, end in ((low, high), (high, low)):
        assert _crosses(start, end, corners, np.array([1e-9])).tolist() == [crosses]
    assert not _crosses(*along, corners, np.array([1e-9])).any()


@pytest.mark.slow
def test_pairs_that_stay_keep_the_points_of_a_new_search():
    parts = []
    for k, x in enumerate((0.0, 0.1)):
        for part in button(h=2e-4 * (k + 1)).assembly.parts:
            place = Pose(part.pose.position + np.array([x, 0, 0]))
            parts.append(replace(part, name=f"{part.name}-{k}", pose=place))
    bodies = rigid_bodies(Assembly(parts, friction=0.3), ())
    kept = CandidatePoints.of(bodies)
    for k, reach in enumerate((1e-3, 5e-4, 2e-3)):
        step = np.zeros((3, 6))
        step[1 + k % 2, 2] = -1e-5
        bodies = bodies.moved(step)
        old, new = kept.near(bodies, reach), CandidatePoints.of(bodies).near(bodies, reach)
        rows = [
            {tuple(row) for row in np.column_stack([p.part_a, p.point, p.normal, p.gap, p.mu])}
            for p in (old, new)
        ]
        assert rows[1]
        assert rows[0] >= rows[1]  # points of a wider reach stay


def test_bodies_with_a_reach_of_their_own_keep_the_points_of_a_new_search():
    cubes = [Part(str(k), Box([1, 1, 1]), [0.1 * k, 0, 1.01 * k]) for k in range(5)]
    bodies = rigid_bodies(Assembly(cubes, friction=0.3), ())
    kept = CandidatePoints.of(bodies)
    rng = np.random.default_rng(3)
    for _ in range(6):
        step = np.zeros((6, 6))
        step[rng.integers(1, 6)] = 1e-3 * rng.normal(size=6)
        bodies = bodies.moved(step)
        reach = rng.choice([0.0, 0.005, 0.05], 6)
        rows = [
            sorted(tuple(row) for row in np.column_stack([p.part_a, p.point, p.normal, p.gap]))
            for p in (kept.near(bodies, reach), CandidatePoints.of(bodies).near(bodies, reach))
        ]
        assert rows[0] == rows[1]
