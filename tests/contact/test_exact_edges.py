"""Edges, corners and tips on curved faces, and tori: exact points and normals, and their limits."""

from __future__ import annotations

import numpy as np
import pytest
from solids import bore, cone_frustum, cone_socket, peg, revolved, torus
from solids import line as straight

from kilter import Assembly, Box, Part, Pose, Sphere, check, contacts, margin
from kilter.scenes.pieces import turn
from kilter.scenes.transform import moved


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
