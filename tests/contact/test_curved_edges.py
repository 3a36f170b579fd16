"""Edges on curves, balls on rims and round edges, against circles and closed forms."""

import numpy as np
import pytest
from solids import bore, cone_frustum, cone_socket, peg, revolved, torus
from solids import line as straight

import kilter
from kilter import Assembly, Box, Cylinder, Part, Pose, Sphere, Tolerance, check, contacts, margin
from kilter.analysis.margins.margin_answer import Margin
from kilter.analysis.margins.turned_forces import held_distance
from kilter.analysis.transport.carried_set import CarriedSet, LeastAcceleration
from kilter.contact.common.contact_search import begin_search
from kilter.contact.common.edges import part_curves
from kilter.contact.round_edges import round_edges
from kilter.contact.sharp.edges_with_edges import corner_rays
from kilter.mechanics.program import build_program
from kilter.scenes.pieces import moved, tube, turn
from kilter.shape.primitives import Mesh

RADIUS, SIDES = 2.0, 40


@pytest.fixture
def rim():
    """The curves of a cylinder, and the edges of its upper rim."""
    assembly = Assembly([Part("peg", peg(RADIUS, 0.0, 1.0, sides=SIDES))])
    search = begin_search(assembly, Tolerance(), lambda stage: None)
    curves = part_curves(search, 0)
    p, q = curves.edges.ends(curves.geometry, np.arange(curves.edges.start[1]))
    upper = np.flatnonzero((p[:, 2] > 0.9) & (q[:, 2] > 0.9))
    upper = upper[curves.exact(upper)]
    assert len(upper) == SIDES
    return curves, upper


def test_the_nearest_point_of_an_arc_lies_in_the_direction_of_the_point(rim):
    """Off the plane of a rim too: the nearest point has the same angle about the axis."""
    curves, upper = rim
    rng = np.random.default_rng(1)
    share = rng.uniform(0.05, 0.95, len(upper))
    on_curve = curves.points(upper, share).at
    points = on_curve * [1.1, 1.1, 1.0]
    points[:, 2] += 0.1
    nearest = curves.points(upper, curves.nearest_share(upper, points)).at
    assert np.hypot(*nearest.T[:2]) == pytest.approx(np.full(len(upper), RADIUS), rel=1e-13)
    assert nearest == pytest.approx(on_curve, abs=1e-9)


def test_the_nearest_point_beyond_an_arc_is_its_end(rim):
    curves, upper = rim
    p, q = curves.edges.ends(curves.geometry, upper)
    assert curves.nearest_share(upper, q + 3 * (q - p)).tolist() == [1.0] * len(upper)
    assert curves.nearest_share(upper, p - 3 * (q - p)).tolist() == [0.0] * len(upper)


def test_rows_do_not_depend_on_other_rows(rim):
    """A row that needs many steps changes no digit of the others."""
    curves, upper = rim
    rng = np.random.default_rng(2)
    points = rng.normal(size=(len(upper), 3)) * 3
    together = curves.nearest_share(upper, points)
    alone = [curves.nearest_share(upper[[k]], points[[k]])[0] for k in range(len(upper))]
    np.testing.assert_allclose(together, alone, rtol=0, atol=1e-15)
    at = curves.points(upper, together).at
    each = [curves.points(upper[[k]], together[[k]]).at[0] for k in range(len(upper))]
    np.testing.assert_allclose(at, each, rtol=0, atol=1e-15)


def test_repeated_corners_and_edges_have_the_answer_of_each(rim):
    curves, upper = rim
    assert curves.sharp(upper[[3, 0, 3]]).tolist() == [True] * 3
    vertex = curves.edges.ends_of[upper[:3], 0]
    repeated = vertex[[2, 0, 2, 1]]
    owner, away, normals, unknown = corner_rays(curves, repeated)
    assert unknown.tolist() == [False] * 4
    for row, one in enumerate(repeated):
        _, single, both, _ = corner_rays(curves, np.array([one]))
        np.testing.assert_allclose(away[owner == row], single, rtol=0, atol=1e-15)
        np.testing.assert_allclose(normals[owner == row], both, rtol=0, atol=1e-15)


def seated(radius: float, hole: float, lift: float = 0.0, aside: float = 0.0) -> Assembly:
    """A ball over the hole of a held ring whose upper face is at z = 2."""
    seat = tube("seat", hole, 3 * radius, 4.0, grounded=True)
    top = float(seat.pose.position[2]) + 2.0
    height = top + np.sqrt(radius**2 - hole**2) + lift
    return Assembly([seat, Part("ball", Sphere(radius), Pose([aside, 0, height]))])


@pytest.mark.parametrize("seed", range(6))
def test_the_ball_touches_the_whole_rim_with_its_own_normals(seed):
    rng = np.random.default_rng(seed)
    radius = float(rng.uniform(0.5, 2.0))
    hole = radius * float(rng.uniform(0.2, 0.95))
    assembly = moved(seated(radius, hole), turn(rng.normal(size=3), 70.0), rng.normal(size=3))
    found = contacts(assembly)
    assert found.open_pairs == ()
    assert found.patch_kind.tolist() == ["sphere"]
    assert found.patch_gap == pytest.approx(0, abs=1e-12)
    center = np.array(assembly["ball"].pose.position)
    away = (found.points - center) / radius
    assert np.linalg.norm(away, axis=1) == pytest.approx(1.0)
    sense = 1.0 if found.patch_parts[0, 0] == 1 else -1.0
    assert sense * found.normals == pytest.approx(away, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_the_ball_stays_up_to_the_tilt_at_which_its_weight_passes_the_rim(seed):
    """Its weight passes through the rim at the angle whose sine is the ratio of the radii."""
    rng = np.random.default_rng(seed)
    radius = float(rng.uniform(0.5, 2.0))
    hole = radius * float(rng.uniform(0.2, 0.9))
    assembly = seated(radius, hole)
    limit = float(np.degrees(np.arcsin(hole / radius)))
    assert check(assembly).verdict == "stable"
    tilt = margin(assembly).tilt_deg
    assert 0.995 * limit <= tilt <= limit * (1 + 1e-9)
    for share, verdict in ((0.99, "stable"), (1.01, "unstable")):
        turn = np.radians(share * limit)
        turned = check(assembly, down=[float(np.sin(turn)), 0, -float(np.cos(turn))])
        assert turned.verdict == verdict


def test_a_ball_that_is_not_over_the_middle_of_the_hole_is_open():
    found = contacts(seated(1.0, 0.5, aside=0.01))
    assert not len(found)


def test_a_ball_above_or_in_the_rim_does_not_touch_it():
    assert not len(contacts(seated(1.0, 0.5, lift=0.01)))
    sunk = contacts(seated(1.0, 0.5, lift=-0.05))
    assert [pair.kind for pair in sunk.open_pairs] == ["overlap"]


def test_a_ball_under_a_ceiling_with_a_hole_falls():
    assert check(seated(1.0, 0.5), down=[0, 0, 1]).verdict == "unstable"


def touching(held, free, pose=None, center=None, seed=0):
    """Contacts of a held and a free body, in a random pose of the whole assembly."""
    rng = np.random.default_rng(seed)
    assembly = pair(held, free, pose, center)
    return contacts(moved(assembly, turn(rng.normal(size=3), 50.0), rng.normal(size=3)))


def pair(held, free, pose=None, center=None):
    """A held body and a free body."""
    more = {} if center is None else {"mass": 1.0, "center_of_mass": center}
    return Assembly([Part("held", held, grounded=True), Part("free", free, pose or Pose(), **more)])


def only(found):
    """Points and normals of contacts without open pairs and without a gap."""
    assert found.open_pairs == ()
    assert found.unsupported == ()
    assert found.patch_gap == pytest.approx(0, abs=1e-9)
    return found.points, found.normals


def on_a_cone(half_angle, countersunk):
    """A peg whose end stands in a conical hole, or a ring whose hole rests on a cone."""
    height, meet = 1 / np.tan(half_angle), np.tan(half_angle)
    if countersunk:
        upside_down = Pose([0, 0, 0], turn([1, 0, 0], 180.0))
        held = Part("held", cone_frustum(half_angle, 0.0, 3 * height), upside_down, grounded=True)
        shape, place, center = bore(1.0, 3.0, 0.0, 1.0, sides=64), [0, 0, -height], [0, 0, -meet]
    else:
        hole = cone_socket(half_angle, 0.3 * height, 2 * height, 20.0)
        held = Part("held", hole, grounded=True)
        shape, place, center = peg(1.0, 0.0, 5.0, sides=64), [0, 0, height], [0, 0, meet]
    return Assembly([held, Part("free", shape, Pose(place), mass=1.0, center_of_mass=center)])


@pytest.mark.quick(2)
@pytest.mark.parametrize("countersunk", [False, True])
@pytest.mark.parametrize("half_angle", [0.3, 1.1])
def test_a_round_edge_on_a_cone_bears_the_tilt_of_its_normals(half_angle, countersunk):
    """The normals lean from the axis by 90 degrees less the half angle."""
    assembly = on_a_cone(half_angle, countersunk)
    found = contacts(assembly)
    assert found.patch_kind.tolist() == ["cone"]
    only(found)
    for share, verdict in ((0.99, "stable"), (1.01, "unstable")):
        angle = share * (np.pi / 2 - half_angle)
        down = [float(np.sin(angle)), 0, -float(np.cos(angle))]
        # its normals meet in a point, about which it may rock: a small push is open
        assert check(assembly, down=down).first_order == verdict


@pytest.mark.slow
@pytest.mark.parametrize("countersunk", [False, True])
def test_the_tilt_limit_of_a_round_edge_on_a_cone_is_that_of_its_normals(countersunk):
    limit = 90 - np.degrees(0.7)
    assert 0.995 * limit <= margin(on_a_cone(0.7, countersunk)).tilt_deg <= limit * (1 + 1e-9)


@pytest.mark.parametrize("seed", range(3))
def test_the_edge_of_a_box_lies_on_a_cylinder_along_its_length(seed):
    free = Box([1.0, 1.0, 1.0])
    stand = Pose([1.0 + np.sqrt(0.5), 0, 0.3], turn([0, 0, 1], 45.0))
    points, normals = only(touching(peg(), free, stand, seed=seed))
    assert len(points) == 2
    assert np.linalg.norm(points[1] - points[0]) == pytest.approx(1.0)
    assert normals[0] == pytest.approx(normals[1])


def test_the_corner_of_a_box_on_a_sphere_and_on_a_torus_has_the_normal_of_the_face():
    corner = np.array([0.5, 0.5, 0.5])
    diagonal = corner / np.linalg.norm(corner)
    down = np.array([0, 0, 1.0])
    axis, angle = np.cross(diagonal, -down), np.degrees(np.arccos(-diagonal @ down))
    upright = turn(axis, angle)
    high = np.linalg.norm(corner)
    for held, place in ((Sphere(1.0), [0, 0, 1.0]), (torus(2.0, 0.5), [2.0, 0, 0.5])):
        free = Pose(np.array(place) + high * down, upright)
        found = contacts(pair(held, Box([1.0, 1.0, 1.0]), free))
        points, normals = only(found)
        assert found.patch_kind.tolist() == ["vertex-face"]
        assert points == pytest.approx(np.array([place]), abs=1e-9)
        assert normals == pytest.approx(down[None], abs=1e-9)


def test_rims_that_touch_without_crossing_have_no_single_normal():
    """The lowest point of the end of a leaning peg touches the rim of an upright peg from above."""
    tilt = np.radians(100)
    along = np.array([np.sin(tilt), 0, np.cos(tilt)])
    low = np.array([along[2], 0, -along[0]])
    place = Pose(np.array([1.0, 0, 0]) - 2.0 * along - low, turn([0, 1, 0], 100.0))
    found = contacts(pair(peg(1.0, -2.0, 0.0), peg(), place))
    assert not len(found.points)
    assert found.open_pairs[0].kind == "free-form"


def test_rims_that_cross_have_the_normal_of_both_tangents():
    """Two discs on edge stand across each other: rim on rim, with the normal from axis to axis."""
    thin = 0.3
    upright = turn([0, 1, 0], 90.0)
    across = turn([1, 0, 0], 90.0)
    held = Part("held", peg(1.0, -thin, thin), Pose([0, 0, 0], upright), grounded=True)
    # the lowest points of the rims of the upper disc cross the upper side of the lower disc
    free = Part("free", peg(1.0, -thin, thin), Pose([thin + 0.2, 0, 2.0], across))
    points, normals = only(contacts(Assembly([held, free])))
    assert points[:, 2] == pytest.approx(1.0)
    assert normals == pytest.approx(np.tile([0, 0, 1.0], (len(normals), 1)))


def test_a_tip_stands_on_a_cylinder_with_the_normal_of_the_cylinder():
    lying = Pose([0, 0, 0], turn([1, 0, 0], 90.0))
    assembly = Assembly(
        [
            Part("held", peg(), lying, grounded=True),
            Part("free", cone_frustum(0.4, 0.0, 2.0), Pose([0, 0.5, 1.0])),
        ]
    )
    points, normals = only(contacts(assembly))
    assert points == pytest.approx(np.array([[0, 0.5, 1.0]]), abs=1e-9)
    assert normals == pytest.approx(np.array([[0, 0, 1.0]]), abs=1e-9)


def test_a_tip_on_the_edge_of_a_cylinder_has_no_single_normal():
    found = contacts(pair(peg(), cone_frustum(0.4, 0.0, 2.0), Pose([1.0, 0, 2.0])))
    assert not len(found.points)
    assert [p.kind for p in found.open_pairs] == ["free-form"]


def test_tori_side_by_side_touch_in_a_point():
    small = torus(2.0, 0.5, 24, 12)
    free = Pose([5.0, 0, 0], turn([1, 0, 0], 65.0))
    points, normals = only(contacts(pair(small, small, free)))
    assert points == pytest.approx(np.array([[2.5, 0, 0]]), abs=1e-9)
    assert normals == pytest.approx(np.array([[1.0, 0, 0]]), abs=1e-9)


def test_a_torus_lies_on_a_torus_along_a_circle():
    points, normals = only(
        contacts(pair(torus(2.0, 0.5), torus(2.4, 0.7), Pose([0, 0, np.sqrt(1.28)])))
    )
    away = np.hypot(points[:, 0], points[:, 1])
    assert away == pytest.approx(2.0 + 0.5 * 0.4 / 1.2)
    assert normals[:, 2] == pytest.approx(np.sqrt(1.28) / 1.2)


def test_a_torus_leans_on_a_cylinder_in_its_nearest_point():
    """A ring that stands upright beside a post touches it at the middle of its side."""
    standing = Pose([1.5, 0, 0], turn([0, 1, 0], 90.0))
    points, normals = only(contacts(pair(peg(1.0, -4.0, 4.0), torus(2.0, 0.5), standing)))
    order = np.argsort(points[:, 2])
    assert points[order] == pytest.approx(np.array([[1, 0, -2.0], [1, 0, 2.0]]), abs=1e-9)
    assert normals == pytest.approx(np.tile([1.0, 0, 0], (2, 1)), abs=1e-9)


def test_a_peg_lies_in_a_conical_hole_along_a_generator():
    half_angle, radius = 0.4, 0.3
    held = cone_socket(half_angle, 1.5, 4.0)
    wall = np.array([np.sin(half_angle), 0, np.cos(half_angle)])
    inwards = np.array([-np.cos(half_angle), 0, np.sin(half_angle)])
    place = 3.0 * wall + radius * inwards
    lean = Pose(place, turn([0, 1, 0], np.degrees(half_angle)))
    points, normals = only(contacts(pair(held, peg(radius, -0.5, 0.5), lean)))
    order = np.argsort(points[:, 2])
    ends = np.array([2.5, 3.5])[:, None] * wall
    assert points[order] == pytest.approx(ends, abs=1e-9)
    assert normals == pytest.approx(np.tile(inwards, (2, 1)), abs=1e-9)


def test_a_face_ends_at_the_curve_of_its_edge_and_not_at_the_chord():
    """A tip beside a coarse hole: outside of the circle it stands on the plate, inside it falls."""
    plate = bore(1.0, 3.0, 0.0, 1.0, sides=12)
    between = np.array([np.cos(np.pi / 12), np.sin(np.pi / 12)])
    for away, stands in ((1.001, True), (0.99, False)):
        place = Pose([*(away * between), 1.0])
        found = contacts(pair(plate, cone_frustum(0.4, 0.0, 2.0), place))
        assert bool(len(found.points)) is stands


def test_the_sharp_end_of_a_tube_stands_on_a_plane_along_a_circle():
    tube = revolved(straight((1.0, 0.0), (1.5, 1.0), (1.5, 2.0), (0.5, 2.0), (0.5, 1.0)))
    points, normals = only(contacts(pair(Box([6, 6, 2]), tube, Pose([0, 0, 1.0]))))
    assert np.hypot(points[:, 0], points[:, 1]) == pytest.approx(1.0)
    assert normals == pytest.approx(np.tile([0, 0, 1.0], (len(normals), 1)))


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
def test_a_part_tips_over_the_circle(name, center):
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
    proof = found.proof()
    assert kilter.verify(body, proof).holds
    if name == "coarse":  # the polygons are farther from the circle than any proof is tried
        assert [(entry["value"], entry["held"]) for entry in proof["proofs"]] == [(0.0, True)]


@pytest.mark.quick(1)
@pytest.mark.parametrize("angle", [0.3, 2.0, 4.4])
def test_a_carrier_tips_it_over_the_circle_in_each_direction(angle):
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
def test_an_edge_ends_where_its_table_ends():
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
def test_the_circle_is_that_of_the_smaller_face():
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
def test_a_mesh_remains_a_polygon_and_says_so():
    vertices, triangles = kilter.shape.primitives.surface(Cylinder(1, 4))
    found = tilt_of(standing(Mesh(vertices, triangles), -2.0, [0, 0, 2.0]))
    assert not found.exact
    assert found.tilt_deg < np.degrees(np.arctan(0.5)) - 1e-3


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(4))
def test_a_slip_in_all_directions_is_bracketed(seed):
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


def test_no_distance_is_proved_beyond_the_limit():
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
