"""Verdicts that were wrong once: each with what is true, and why."""

from __future__ import annotations

import numpy as np
import pytest
from judged import judged

from kilter import Assembly, Box, Cylinder, Mesh, Part, Pose, Prism, Sphere, check
from kilter.contact import detect
from kilter.contact.common.facets import find_facets
from kilter.mechanics.certificate import check_forces
from kilter.scenes import arches
from kilter.scenes.pieces import turn

FLOOR = Part("floor", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
RIDGE = Part("ridge", Prism([[-1, -1], [1, -1], [0, 0]], 2), grounded=True)


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [0, 0.3, 1, 2, 45])
@pytest.mark.parametrize("axis", [[1, 0, 0], [1, 2, 3]])
def test_a_ball_rests_however_its_polyhedron_is_turned(axis, degrees):
    ball = Part("ball", Sphere(0.5), Pose([0, 0, 0.5], turn(axis, degrees)))
    verdict = judged(Assembly([FLOOR, ball]))
    assert verdict.verdict == "stable"
    assert np.allclose(verdict.contact_set.points, 0.0, atol=1e-12)


@pytest.mark.quick(1)
@pytest.mark.parametrize("spin", [0.0, 0.02, np.pi / 96, 1.0])
def test_a_lying_cylinder_rests_however_it_is_rolled(spin):
    lying = Part("c", Cylinder(0.5, 2), Pose([0, 0, 0.5], rolled(spin)))
    assert judged(Assembly([FLOOR, lying])).verdict == "stable"


def rolled(spin):
    """A cylinder's axis laid along x, after a turn about itself."""
    half, quarter = spin / 2, np.pi / 4
    return [
        np.cos(quarter) * np.cos(half),
        np.sin(quarter) * np.sin(half),
        np.sin(quarter) * np.cos(half),
        np.cos(quarter) * np.sin(half),
    ]


SIDES = pytest.mark.parametrize(("side", "word"), [(1 / 0.98, "stable"), (0.98, "unstable")])


@pytest.mark.slow
@SIDES
def test_friction_holds_a_bar_on_a_ridge(side, word):
    # tilted by .2 with the centre of mass over the ridge: forces hold it where mu > tan .2, but a
    # small push makes it rock on
    lean = 0.2
    pose = Pose([0.1 * np.sin(lean), 0, 0.1 * np.cos(lean)], turn([0, 1, 0], np.degrees(lean)))
    off = [-0.1 * np.tan(lean), 0, 0]
    bar = Part("bar", Box([3, 1, 0.2]), pose, center_of_mass=off)
    found = judged(Assembly([RIDGE, bar], friction=side * np.tan(lean)))
    assert found.first_order == word
    assert found.level == ("equilibrium" if word == "stable" else None)
    assert judged(Assembly([RIDGE, bar])).verdict == "unstable"


@pytest.mark.slow
@SIDES
def test_friction_holds_a_ball_on_a_slope(side, word):
    # its centre of mass lies over the point of contact: forces hold it where mu > tan .2, but it
    # lies above the centre of the ball, so that it rolls on
    ball = Part("ball", Sphere(0.5), Pose([0, 0, 0.5]), center_of_mass=[-0.5 * np.tan(0.2), 0, 0])
    slope = [9.81 * np.sin(0.2), 0, -9.81 * np.cos(0.2)]
    rests = Assembly([FLOOR, ball], gravity=slope, friction=side * np.tan(0.2))
    found = judged(rests)
    assert found.first_order == word
    assert found.level == ("equilibrium" if word == "stable" else None)


@pytest.mark.slow
@SIDES
def test_friction_holds_a_cylinder_along_a_leaning_strip(side, word):
    # it may slide along its axis, where mu < .5 / 9.7; it would tip where .5 / 9.7 > .25 / .5
    strip = Part("strip", Box([0.5, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    lying = Part("c", Cylinder(0.5, 3), Pose([0, 0, 0.5], rolled(0.0)))
    gravity = [0.5, 0, -9.7]
    along = Assembly([strip, lying], gravity=gravity, friction=side * 0.5 / 9.7)
    assert judged(along).verdict == word


TOP = Prism([[0, 0], [1, 2], [-1, 2]], 2)


@pytest.mark.quick(2)
@pytest.mark.parametrize("angle", [2e-5, 1e-4, 3e-4, 9e-4])
def test_ridges_that_nearly_run_side_by_side_may_cross_or_not(angle):
    upper = Part("top", TOP, Pose([0, 0, 0], turn([0, 0, 1], np.degrees(angle))))
    verdict = judged(Assembly([RIDGE, upper]))
    assert verdict.verdict == "undecided"
    assert "with the paper's planar approximation it would be stable" in verdict.sentence


@pytest.mark.slow
def test_ridges_side_by_side_slide_off_each_other():
    # it slides down either slope: to first order nothing stops it
    verdict = judged(Assembly([RIDGE, Part("top", TOP)]))
    assert verdict.verdict == "unstable"
    motion = verdict.evidence.motion[1]
    assert abs(motion[0]) == pytest.approx(-motion[2], rel=1e-6)


@pytest.mark.slow
def test_ridges_that_cross_balance():
    upper = Part("top", TOP, Pose([0, 0, 0], turn([0, 0, 1], np.degrees(2e-3))))
    verdict = judged(Assembly([RIDGE, upper]))
    assert verdict.verdict == "balanced"
    assert verdict.contact_set.patch_kind.tolist() == ["edge-edge"]


def test_the_true_circle_reaches_beyond_the_side_of_its_polygon():
    # a plank under a side of the polygon, the centre of mass between polygon and circle
    quaternion = turn([0, 0, 1], 180 / 96)
    angle = np.pi / 96
    center = 0.9995 * np.array([np.cos(angle), -np.sin(angle), 0])
    cylinder = Part("c", Cylinder(1, 1), Pose([0, 0, 0.5], quaternion), center_of_mass=center)
    plank = Part("plank", Box([10, 0.04, 1]), Pose([0, 0, -0.5]), grounded=True)
    assert judged(Assembly([plank, cylinder])).verdict == "undecided"


@pytest.mark.slow
def test_a_foil_is_two_faces_not_one_of_no_direction():
    foil = Box([4, 4, 3e-6])
    corners = [[x, y, z] for z in (-3e-6, 0.0) for y in (-2, 2) for x in (-2, 2)]
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    block = Part("block", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    for shape, height in ((foil, -1.5e-6), (Mesh(corners, quads), 0.0)):
        plate = Part("foil", shape, Pose([0, 0, height]), grounded=True)
        assert judged(Assembly([plate, block])).verdict == "stable"


def test_a_pinch_however_hard_hides_no_weight():
    walls = [Part(f"w{x}", Box([1, 2, 2]), Pose([x, 0, 0]), grounded=True) for x in (-1, 1)]
    assembly = Assembly([*walls, Part("box", Box([1, 1, 1]))])
    verdict = judged(assembly)
    assert verdict.verdict == "unstable"
    for pinch in (1e3, 1e10, 1e14):
        forces = np.full(len(verdict.program.part_a), pinch * 9810)
        assert not check_forces(verdict.program, forces).holds


@pytest.mark.parametrize("sides", [12, 60, 300])
def test_a_fine_notch_makes_a_large_plate_no_convex_part(sides):
    angle = np.arange(sides) * 2 * np.pi / sides
    circle = 0.5 * np.column_stack([np.cos(angle), np.sin(angle)])
    plate = Part("plate", Prism(slotted(circle), 2), grounded=True)
    assert not find_facets(Assembly([plate]).geometry).convex_part[0]


def slotted(circle):
    """A large square with a round notch at the middle of its right side."""
    half = circle[circle[:, 0] <= 1e-9] + [200.0, 0.0]
    half = half[np.argsort(half[:, 1])]
    square = [[200.0, 200.0], [-200.0, 200.0], [-200.0, -200.0], [200.0, -200.0]]
    return np.vstack([square, half])


def test_an_arch_has_no_edges_beside_its_patches():
    assert not detect.contacts(arches.arch(20)).unsupported
    assert check(arches.arch(20, friction=0.0)).verdict == "unstable"
