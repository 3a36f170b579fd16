"""Contacts at edges and corners without a normal, and cases that once had a wrong verdict."""

from __future__ import annotations

import numpy as np
import pytest
from judged import judged

from kilter import Assembly, Box, Cylinder, Joint, Mesh, Part, Pose, Prism, Sphere, check
from kilter.contact import detect
from kilter.contact.common.facets import find_facets
from kilter.mechanics.certificate import check_forces
from kilter.scenes import arches
from kilter.scenes.pieces import block, compose, floor, prism, turn
from kilter.shape.primitives import CYLINDER_SIDES

FLOOR = floor([-5, -5], [5, 5])
SPARE = block("spare", [3, 3, 1], [4, 4, 2])
"""Floats beside the rest: falls whatever else is held."""
G = 9.81
UP = np.array([0.0, 0.0, 1.0])


def on_edge():
    """A unit cube that stands on one of its edges."""
    return Part("cube", Box([1, 1, 1]), Pose([0, 0, np.sqrt(0.5)], turn([0, 1, 0], 45)))


def on_corner():
    """A unit cube that stands on one of its corners."""
    tip = compose(turn([0, 1, 0], -np.degrees(np.arctan(np.sqrt(0.5)))), turn([1, 0, 0], 45))
    return Part("cube", Box([1, 1, 1]), Pose([0, 0, np.sqrt(0.75)], tip))


def tetrahedron():
    """A tetrahedron that stands on its tip."""
    vertices = [[0, 0, 0], [1, 0, 1], [-0.5, 0.8, 1], [-0.5, -0.8, 1]]
    return Part("cube", Mesh(vertices, [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]]))


def lying_cylinder():
    return Part("cube", Cylinder(1.0, 2.0), Pose([0, 0, 1], turn([1, 0, 0], 90)))


def ball():
    return Part("cube", Sphere(1.0), Pose([0, 0, 1]))


def crossed_prisms():
    """A ridge that lies across another: edge on edge."""
    ridge = prism("ridge", [[-1, 0], [1, 0], [0, 1]], 4.0, grounded=True)
    other = Part(
        "cube",
        prism("p", [[0, 0], [1, 1], [-1, 1]], 4.0).shape,
        Pose([0, 0, 1], turn([0, 0, 1], 90)),
    )
    return [ridge, other]


STANDING = {
    "edge": ([FLOOR, on_edge()], "edge-face"),
    "corner": ([FLOOR, on_corner()], "vertex-face"),
    "tetrahedron": ([FLOOR, tetrahedron()], "vertex-face"),
    "cylinder": ([FLOOR, lying_cylinder()], "cylinder"),
    "ball": ([FLOOR, ball()], "sphere"),
    "crossed": (crossed_prisms(), "edge-edge"),
}
EACH = pytest.mark.parametrize("name", STANDING)
ROUND = pytest.mark.parametrize("name", ["cylinder", "ball"])
SHARP = pytest.mark.parametrize("name", ["edge", "corner", "tetrahedron", "crossed"])


def rim_along_a_ridge():
    """The round edge of a cylinder runs along a straight edge: no single normal."""
    ridge = prism("ridge", [[0, 0], [-1, -1], [1, -1]], 2.0, grounded=True)
    return [ridge, Part("cube", Cylinder(0.5, 1.0), Pose([0.5, 0, 0.5]))]


def test_a_ball_balances_on_a_ridge():
    ridge, _ = rim_along_a_ridge()
    verdict = judged(Assembly([ridge, Part("ball", Sphere(0.5), Pose([0, 0, 0.5]))]))
    assert verdict.first_order == "stable"
    assert verdict.contact_set.patch_kind.tolist() == ["edge-face"]
    assert verdict.contact_set.points == pytest.approx(np.zeros((1, 3)), abs=1e-12)


def test_contact_that_could_hold_it_is_listed_and_undecided():
    verdict = judged(Assembly(rim_along_a_ridge()))
    assert verdict.verdict == "undecided"
    assert [u.kind for u in verdict.contact_set.unsupported] == ["curved"]
    assert set(verdict.unsupported[0].parts) == {"ridge", "cube"}
    assert "not modelled yet" in verdict.sentence
    assert "'cube'" in verdict.sentence
    assert "curved" in verdict.sentence
    assert [one.kind for one in verdict.contact_set.open_pairs] == ["free-form"]


@pytest.mark.quick(2)
@SHARP
def test_what_balances_on_an_edge_or_corner_is_stable_and_neutral(name):
    parts, kind = STANDING[name]
    verdict = judged(Assembly(parts))
    assert (verdict.verdict, verdict.first_order) == ("balanced", "stable")
    assert verdict.contact_set.unsupported == ()
    assert verdict.contact_set.patch_kind.tolist() == [kind]
    assert verdict.contact_set.patch_area.tolist() == [0.0]
    points = 2 if kind == "edge-face" else 1
    assert len(verdict.contact_set.points) == points
    assert verdict.contact_set.normals == pytest.approx(np.tile(UP, (points, 1)))
    # it may slide two ways and spin; on an edge it rolls about it, on a point also across it
    assert verdict.neutral.two_sided == (4 if points == 2 else 5)


@pytest.mark.quick(4)
@SHARP
@pytest.mark.parametrize("past", [1e-3, 1e-6, 1e-7])
def test_what_stands_past_its_edge_or_corner_is_unstable(name, past):
    parts, _ = STANDING[name]
    cube = parts[1]
    shape = cube.shape
    own = np.zeros(3) if isinstance(shape, Box) else np.array(Assembly(parts).geometry.center[1])
    if name == "crossed":
        own = np.array([0, 0, 2 / 3])
    moved = own + past * np.array([1.0, 0, 0])
    moved = Part("cube", shape, cube.pose, center_of_mass=moved)
    assert judged(Assembly([parts[0], moved])).verdict == "unstable"


@pytest.mark.quick("edge", "ball")
@EACH
def test_what_cannot_depend_on_such_a_contact_is_decided(name):
    parts, _ = STANDING[name]
    spare = judged(Assembly([*parts, SPARE]))  # another part floats
    assert spare.verdict == "unstable"
    assert spare.proof()["motion"]["spare"][2] < 0
    cube = parts[1]
    raised = Part("cube", cube.shape, Pose(cube.pose.position + 0.01 * UP, cube.pose.rotation))
    above = judged(Assembly([parts[0], raised]))  # it touches nothing
    assert above.verdict == "unstable"
    assert len(above.contact_set) == 0
    assert above.contact_set.unsupported == ()
    joined = judged(Assembly(parts, joints=[Joint(("ground", "cube"))]))
    assert joined.verdict == "stable"
    hung = judged(Assembly(parts, gravity=[0, 0, G]))  # an edge, a corner pushes only
    assert hung.verdict == "unstable"


@ROUND
def test_round_part_rests_on_the_table_to_first_order(name):
    # its centre of mass lies over its point or line of contact: rolling costs no energy
    parts, kind = STANDING[name]
    verdict = judged(Assembly(parts))
    assert verdict.verdict == "stable"
    assert verdict.contact_set.unsupported == ()
    assert verdict.contact_set.patch_kind.tolist() == [kind]
    # slides two ways and spins; a ball rolls two ways, a cylinder one
    assert verdict.neutral.two_sided == (5 if name == "ball" else 4)


@pytest.mark.quick(2)
@ROUND
@pytest.mark.parametrize("lean", [1e-6, 1e-3])
def test_round_part_rolls_where_gravity_leans(name, lean):
    verdict = judged(Assembly(STANDING[name][0], gravity=[G * lean, 0, -G]))
    assert verdict.verdict == "unstable"


def test_wedge_on_its_edge_between_two_walls_is_held():
    wedge = prism("cube", [[0, 0], [1, 2], [-1, 2]], 1.0)
    left = prism("left", [[0, 0], [-1, 2], [-2, 2], [-2, 0]], 1.0, grounded=True)
    right = prism("right", [[0, 0], [2, 0], [2, 2], [1, 2]], 1.0, grounded=True)
    assert judged(Assembly([FLOOR, left, right, wedge])).verdict == "stable"
    # on the floor by its edge, with a wall on one side only: it tips away or slides out
    one_sided = judged(Assembly([FLOOR, left, wedge]))
    assert one_sided.contact_set.unsupported == ()
    assert "edge-face" in one_sided.contact_set.patch_kind
    assert one_sided.verdict == "balanced"  # upright over its edge
    center = [1e-6, 0, 4 / 3]
    leaning = Part("cube", wedge.shape, wedge.pose, center_of_mass=center)
    assert judged(Assembly([FLOOR, left, leaning])).verdict == "unstable"
    against = Part("cube", wedge.shape, wedge.pose, center_of_mass=[-1e-6, 0, 4 / 3])
    # it leans on the wall, whose push away nothing takes up: its edge slides out
    assert judged(Assembly([FLOOR, left, against])).verdict == "unstable"


def test_wedge_on_an_edge_between_upright_walls():
    # walls at x = -1 and 1 touch its two upright sides; it stands on its lower edge
    wedge = prism("cube", [[0, 0], [1, 1], [1, 2], [-1, 2], [-1, 1]], 1.0)
    walls = [
        block("left", [-2, -1, 0], [-1, 1, 3], grounded=True),
        block("right", [1, -1, 0], [2, 1, 3], grounded=True),
    ]
    verdict = judged(Assembly([FLOOR, *walls, wedge]))
    assert verdict.verdict == "stable"
    assert sorted(verdict.contact_set.patch_kind) == ["edge-face", "plane", "plane"]
    without_floor = judged(Assembly([*walls, wedge]))
    assert without_floor.verdict == "unstable"


def test_box_on_a_table_that_also_touches_an_edge_of_a_wall_is_stable():
    box = block("cube", [0, 0, 0], [1, 1, 1])
    # a held prism whose sharp edge touches the middle of the box's side
    knife = prism("knife", [[1, 0.5], [2, 0.2], [2, 0.8]], 4.0, grounded=True)
    verdict = judged(Assembly([FLOOR, box, knife]))
    assert verdict.verdict == "stable"
    assert verdict.contact_set.unsupported == ()
    assert sorted(verdict.contact_set.patch_kind) == ["edge-face", "plane"]


def test_edge_that_pushes_the_wrong_way_leaves_it_unstable():
    # a box that hangs over the table's edge; a knife touches its far side: it cannot lift it
    table = floor([-3, -1], [0, 1], name="table")
    box = block("cube", [-0.4, -0.5, 0], [0.6, 0.5, 1])
    for z, word in ((0.5, "unstable"), (0.0, "stable")):
        if z:
            knife = prism("knife", [[0.6, z], [2, 0.2], [2, 0.8]], 4.0, grounded=True)
        else:  # from below, under the overhang: it could
            knife = prism("knife", [[0.5, 0], [0.8, -1], [0.2, -1]], 4.0, grounded=True)
        assert judged(Assembly([table, box, knife])).verdict == word


def test_ball_beside_a_stable_stack_changes_nothing_of_it():
    tower = [block(f"cube-{k}", [2, 2, k], [3, 3, k + 1]) for k in range(3)]
    held = Part("ball", Sphere(1.0), Pose([0, 0, 1]), grounded=True)
    touching = Part("ball", Sphere(0.5), Pose([1.5, 2.5, 0.5]), grounded=True)
    assert judged(Assembly([FLOOR, held, *tower])).verdict == "stable"
    verdict = judged(Assembly([FLOOR, touching, *tower]))
    assert verdict.verdict == "stable"
    assert verdict.contact_set.unsupported == ()
    assert (verdict.contact_set.patch_kind == "sphere").sum() == 1


# a cylinder on its flat end --------------------------------------------------------------


def standing_cylinder(x=0.0, **properties):
    return Part("cylinder", Cylinder(1.0, 2.0), Pose([x, 0, 1]), **properties)


def test_cylinder_on_its_end_is_stable_and_its_contact_planar():
    verdict = judged(Assembly([FLOOR, standing_cylinder()]))
    assert verdict.verdict == "stable"
    assert verdict.contact_set.unsupported == ()
    assert verdict.contact_set.patch_area[0] == pytest.approx(np.pi, rel=1e-12)


INNER = np.cos(np.pi / CYLINDER_SIDES)
"""Nearest side of the inscribed polygon of a unit circle; of the other it is 1."""


def off_centre(reach, angle):
    """A cylinder whose centre of mass is `reach` from its axis, toward `angle`."""
    center = [reach * np.cos(angle), reach * np.sin(angle), 0]
    return Assembly([FLOOR, standing_cylinder(mass=1.0, center_of_mass=center)])


@pytest.mark.quick(1)
@pytest.mark.parametrize("k", [0.5, 7.5, 40.5])
def test_cylinder_is_undecided_only_between_the_two_polygons(k):
    # toward the middle of a side: inscribed at INNER, circle at 1, circumscribed beyond
    angle = 2 * np.pi * k / CYLINDER_SIDES
    assert judged(off_centre(INNER - 1e-6, angle)).verdict == "stable"
    between = judged(off_centre((INNER + 1) / 2, angle))
    assert between.verdict == "undecided"
    assert judged(off_centre(1 - 1e-7, angle)).verdict == "undecided"
    outermost = 1 / INNER
    assert judged(off_centre(outermost + 1e-6, angle)).verdict == "unstable"


@pytest.mark.quick(1)
@pytest.mark.parametrize("k", [0, 5, 31])
def test_cylinder_toward_a_corner_of_its_polygon_is_stable_to_the_circle(k):
    angle = 2 * np.pi * k / CYLINDER_SIDES
    assert judged(off_centre(1 - 1e-6, angle)).verdict == "stable"
    assert judged(off_centre(1 / INNER + 1e-6, angle)).verdict == "unstable"


@pytest.mark.quick(1)
@pytest.mark.parametrize("past", [1e-3, 1e-6, 1e-7])
def test_cylinder_at_the_end_of_a_table_stands_to_its_axis(past):
    # the edge of the table passes under the middle of the end: no rim is near
    for side, word in ((-1, "stable"), (1, "unstable")):
        table = floor([-5, -5], [0, 5], name="table")
        verdict = judged(Assembly([table, standing_cylinder(side * past)]))
        assert verdict.verdict == word


def test_cylinder_on_a_strip_under_its_rim_is_undecided_only_where_the_rim_decides():
    # a narrow strip under the rim at x in [0.9, 2]: its weight is at 0: it falls whatever the rim
    strip = block("strip", [0.9, -2, -1], [2, 2, 0], grounded=True)
    assert judged(Assembly([strip, standing_cylinder()])).verdict == "unstable"


def test_two_round_parts_on_their_ends_stack():
    parts = [standing_cylinder(), Part("upper", Cylinder(0.5, 1), Pose([0.2, 0.1, 2.5]))]
    verdict = judged(Assembly([FLOOR, *parts]))
    assert verdict.verdict == "stable"
    assert verdict.contact_set.unsupported == ()


def test_proof_with_possible_contacts_counts_them():
    # unstable although the rim may push: the motion obeys that push too
    verdict = judged(Assembly([*rim_along_a_ridge(), SPARE]))
    assert (verdict.program.kind == 1).any()
    moves = verdict.program.velocities(verdict.evidence.motion)
    assert moves.min() >= -1e-9


FLOOR_HUNTED = Part("floor", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
RIDGE = Part("ridge", Prism([[-1, -1], [1, -1], [0, 0]], 2), grounded=True)


@pytest.mark.slow
@pytest.mark.parametrize("degrees", [0, 0.3, 1, 2, 45])
@pytest.mark.parametrize("axis", [[1, 0, 0], [1, 2, 3]])
def test_a_ball_rests_however_its_polyhedron_is_turned(axis, degrees):
    ball = Part("ball", Sphere(0.5), Pose([0, 0, 0.5], turn(axis, degrees)))
    verdict = judged(Assembly([FLOOR_HUNTED, ball]))
    assert verdict.verdict == "stable"
    assert np.allclose(verdict.contact_set.points, 0.0, atol=1e-12)


@pytest.mark.quick(1)
@pytest.mark.parametrize("spin", [0.0, 0.02, np.pi / 96, 1.0])
def test_a_lying_cylinder_rests_however_it_is_rolled(spin):
    lying = Part("c", Cylinder(0.5, 2), Pose([0, 0, 0.5], rolled(spin)))
    assert judged(Assembly([FLOOR_HUNTED, lying])).verdict == "stable"


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
    rests = Assembly([FLOOR_HUNTED, ball], gravity=slope, friction=side * np.tan(0.2))
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
