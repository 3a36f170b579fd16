"""Contacts between exact curved faces: positions, free motions, and the forces they hold."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from solids import (
    as_solid,
    ball,
    bolt,
    bore,
    cone_frustum,
    cone_socket,
    mesh_of,
    peg,
    socket,
    torus,
    trough,
)

from kilter import Assembly, Box, Cylinder, Mesh, Part, Pose, Prism, Sphere, check
from kilter.contact import Tolerance, detect
from kilter.contact.common.contact_search import begin_search
from kilter.contact.common.findings import explained, triangles_on_flat
from kilter.contact.curved.contact_points import AROUND, unrolled_overlap
from kilter.contact.pair_findings import find_families
from kilter.mechanics.program import build_program
from kilter.scenes.pieces import floor, turn
from kilter.scenes.traps import four_spheres, three_cylinders
from kilter.shape.primitives import BOX_CORNERS, BOX_TRIANGLES
from sampled import sampled

FLOOR = floor([-5, -5], [5, 5])
LYING = turn([1, 0, 0], 90)
G = 9.81


def held(shape, pose=None):
    return Part("base", shape, pose or Pose(), grounded=True)


def motions(assembly):
    """Dimension of {J dp = 0}, and of the span of {J dp >= 0} if forces can cancel."""
    jacobian = build_program(assembly, detect.contacts(assembly)).jacobian().toarray()
    values = np.linalg.svd(jacobian, compute_uv=False)
    return jacobian.shape[1] - int((values > 1e-7 * values[0]).sum())


def contacts_of(*parts, **options):
    return detect.contacts(Assembly(list(parts)), **options)


# pegs in holes ------------------------------------------------------------------------

PAIRS = {
    "exact": (bore(), peg(phase=0.1)),
    "two tessellations": (bore(sides=17), peg(sides=30, phase=0.1)),
    "primitive": (bore(sides=40), Cylinder(1.0, 4.0)),
    "turned against": (bore(), peg(phase=0.3)),
    "flush": (bore(), peg(low=-1.0, high=1.0, phase=0.2)),
    "mesh": (mesh_of(bore(sides=32)), mesh_of(peg(sides=24, phase=0.1))),
    "mesh in exact": (bore(), mesh_of(peg(sides=36, phase=0.1))),
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", PAIRS)
def test_peg_slides_and_spins_in_its_hole_and_nothing_else(name):
    hole, shape = PAIRS[name]
    assembly = Assembly([held(hole), Part("peg", shape)])
    contacts = detect.contacts(assembly)
    assert contacts.patch_kind.tolist() == ["cylinder"]
    assert contacts.unsupported == ()
    assert contacts.overlaps == ()
    assert contacts.patch_area[0] == pytest.approx(2 * np.pi * 2.0, rel=1e-9)
    assert motions(assembly) == 2
    raised = [w for w in contacts.warnings if "recognised" in w]
    assert len(raised) == int("mesh" in name)


@pytest.mark.slow
@pytest.mark.parametrize("name", PAIRS)
def test_peg_falls_along_its_axis_and_is_held_across(name):
    hole, shape = PAIRS[name]
    parts = [held(hole), Part("peg", shape)]
    assert check(Assembly(parts, gravity=[0, 0, -G])).first_order == "unstable"
    assert check(Assembly(parts, gravity=[0, 0, G])).first_order == "unstable"
    assert check(Assembly(parts, gravity=[G, 0, 0])).first_order == "stable"
    assert check(Assembly(parts, gravity=[G, 0, -1e-6])).first_order == "unstable"


def tolerance(gap):
    from kilter import Tolerance

    return Tolerance(gap=gap)


@pytest.mark.slow
def test_loose_peg_lies_in_its_hole_along_a_line():
    # radius 1 in 1.2, resting at the bottom: axis down by the clearance
    base = held(bore(radius=1.2, low=-1, high=1), Pose([0, 0, 0], LYING))
    parts = [base, Part("peg", peg(), Pose([0, 0, -0.2], LYING))]
    verdict = check(Assembly(parts))
    assert verdict.first_order == "stable"
    assert verdict.contact_set.patch_kind.tolist() == ["cylinder"]
    assert np.sort(verdict.contact_set.points[:, 1]) == pytest.approx([-1, 1])
    assert verdict.contact_set.points[:, 2] == pytest.approx([-1.2, -1.2])
    assert check(Assembly(parts, gravity=[1e-6, 0, -G])).first_order == "unstable"


def test_two_halves_of_a_face_are_one():
    whole = bore()
    halves = halved(whole)
    contacts = contacts_of(held(halves), Part("peg", peg(phase=0.1)))
    assert contacts.patch_area.tolist() == pytest.approx([4 * np.pi])


def halved(solid):
    """A solid whose cylinder is listed twice, half of its triangles each."""
    from kilter.shape.solid import Solid

    label = solid.triangle_surface.copy()
    mine = np.flatnonzero([solid.surfaces[k].kind == "cylinder" for k in label])
    hollow = [k for k in mine if solid.surfaces[label[k]].hollow]
    label[hollow[: len(hollow) // 2]] = len(solid.surfaces)
    twin = solid.surfaces[solid.triangle_surface[hollow[0]]]
    return Solid(
        solid.vertices, solid.triangles, (*solid.surfaces, twin), label,
        solid.volume, solid.centroid, solid.second_moment,
    )  # fmt: skip


# arcs ---------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("half", [0.3, 1.0, np.pi / 2, 2.0, 2.8])
def test_cylinder_in_a_groove_holds_to_the_ends_of_the_arc(half):
    # a force toward an angle is held iff it lies within the arc of normals
    parts = [held(trough(half=half, pieces=31)), Part("bar", peg(), Pose([0, 0, 0], LYING))]
    limit = half if half < np.pi / 2 else np.pi
    for angle, word in ((limit - 1e-6, "stable"), (limit + 1e-6, "unstable")):
        for side in (1, -1):
            gravity = [side * G * np.sin(angle), 0, -G * np.cos(angle)]
            if half < np.pi / 2:
                assert check(Assembly(parts, gravity=gravity)).first_order == word
            elif half > np.pi / 2:
                assert check(Assembly(parts, gravity=gravity)).first_order == "stable"
    area = 2 * half * 2.0
    assert detect.contacts(Assembly(parts)).patch_area[0] == pytest.approx(area, rel=1e-9)


@pytest.mark.parametrize("reach", [0.999999, 1.000001])
def test_bar_in_a_groove_tips_beyond_its_end(reach):
    # the groove ends at y = 1: centre of mass inside or beyond
    bar = Part("bar", peg(), Pose([0, 0, 0], LYING), center_of_mass=[0, 0, reach])
    verdict = check(Assembly([held(trough()), bar]))
    assert verdict.first_order == ("stable" if reach < 1 else "unstable")


# balls --------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("exact", [True, False])
def test_ball_in_a_cone_touches_around_a_circle(exact):
    alpha, radius = 0.4, 0.6
    centre = np.array([0, 0, radius / np.sin(alpha)])
    shapes = [cone_socket(alpha), ball(radius)]
    hole, sphere = shapes if exact else [mesh_of(s) for s in shapes]
    parts = [held(hole), Part("ball", sphere, Pose(centre))]
    contacts = detect.contacts(Assembly(parts))
    assert contacts.patch_kind.tolist() == ["sphere"]
    assert len(contacts.points) == AROUND
    x = contacts.points - centre
    assert np.linalg.norm(x, axis=1) == pytest.approx(np.full(AROUND, radius), rel=1e-6)
    assert x[:, 2] == pytest.approx(np.full(AROUND, -radius * np.sin(alpha)), abs=1e-6)
    assert np.abs(contacts.normals + x / radius).max() < 1e-6
    assert motions(Assembly(parts)) == 3
    lean = np.pi / 2 - alpha  # forces reach so far from the axis
    for side in (-1, 1):
        angle = lean * (1 + side * 2e-3)
        gravity = [G * np.sin(angle), 0, -G * np.cos(angle)]
        word = check(Assembly(parts, gravity=gravity)).first_order
        assert word == ("stable" if side < 0 else "unstable")


@pytest.mark.slow
@pytest.mark.parametrize("step", [9, 3])
def test_verdict_between_the_inner_and_the_outer_cone_is_not_given(step):
    """Tested over points and half-way between them in turn."""
    alpha = 0.4
    centre = [0, 0, 1 / np.sin(alpha)]
    parts = [held(cone_socket(alpha, high=4)), Part("ball", Sphere(1.0), Pose(centre))]
    half = np.pi / AROUND  # half-way between two points
    inner = np.arctan(np.tan(np.pi / 2 - alpha) * np.cos(half))
    outer = np.arctan(np.tan(np.pi / 2 - alpha) / np.cos(half))
    words = []
    for angle in (inner - 1e-7, inner + 1e-7, outer + 1e-6):
        worst = set()
        for turned in np.linspace(0, 2 * np.pi, 2 * AROUND, endpoint=False)[::step]:
            away = np.array([np.cos(turned), np.sin(turned), 0])
            gravity = G * (np.sin(angle) * away - [0, 0, np.cos(angle)])
            worst.add(check(Assembly(parts, gravity=gravity)).first_order)
        words.append(worst)
    assert words[0] == {"stable"}
    assert "unstable" not in words[1]
    assert words[2] == {"unstable"}


@pytest.mark.slow
@pytest.mark.parametrize("rim", [-0.7, -0.3, 0.0, 0.4])
@pytest.mark.parametrize("exact", sampled(1, [True, False]))
def test_ball_in_a_socket_is_held_as_far_as_the_socket_reaches(rim, exact):
    shapes = [socket(rim=rim, phase=0.03, sides=60), ball()]
    base, sphere = shapes if exact else [mesh_of(s) for s in shapes]
    parts = [held(base), Part("ball", sphere, Pose([0, 0, 0], turn([1, 2, 0], 50)))]
    contacts = detect.contacts(Assembly(parts))
    assert contacts.patch_kind.tolist() == ["sphere"]
    assert contacts.unsupported == ()
    assert contacts.overlaps == ()
    lean = np.arccos(-rim) if rim <= 0 else np.pi
    assert contacts.patch_area[0] == pytest.approx(2 * np.pi * (1 + rim), rel=1e-2)
    for side in (-1, 1):
        angle = lean * (1 + side * 3e-3)
        gravity = [G * np.sin(angle), 0, -G * np.cos(angle)]
        expected = "stable" if side < 0 or rim > 0 else "unstable"
        assert check(Assembly(parts, gravity=gravity)).first_order == expected
    assert motions(Assembly(parts)) == 3


@pytest.mark.slow
def test_ball_of_the_bore_touches_it_around_a_great_circle():
    parts = [held(bore()), Part("ball", Sphere(1.0), Pose([0, 0, 0.3], turn([1, 1, 0], 40)))]
    contacts = detect.contacts(Assembly(parts))
    assert contacts.patch_kind.tolist() == ["sphere"]
    assert np.abs(contacts.points[:, 2] - 0.3).max() < 1e-12
    assert motions(Assembly(parts)) == 4
    assert check(Assembly(parts)).first_order == "unstable"
    assert check(Assembly(parts, gravity=[0, G, 0])).first_order == "stable"


@pytest.mark.slow
def test_four_spheres_roll_apart_without_friction_and_touch_where_they_should():
    assembly = four_spheres(friction_between=0, friction_ground=0)
    verdict = check(assembly)
    assert verdict.verdict == "unstable"
    contacts = verdict.contact_set
    centers = np.array([part.pose.position for part in assembly.parts])
    assert len(contacts) == 6 + 3
    for (a, b), x in zip(contacts.patch_parts, contacts.points, strict=True):
        expected = (centers[a] + centers[b]) / 2 if min(a, b) else centers[b] - [0, 0, 1]
        assert x == pytest.approx(expected, abs=1e-12)
    # held together by a ring around the three, they stay
    verdict = check(three_cylinders(friction_between=0, friction_ground=0))
    assert verdict.verdict == "unstable"
    assert len(verdict.contact_set) == 3 + 2


# cones, tori, bars --------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("exact", [True, False])
def test_cone_in_its_socket_only_spins(exact):
    shapes = [cone_socket(phase=0.05), cone_frustum(sides=32)]
    base, plug = shapes if exact else [mesh_of(s) for s in shapes]
    parts = [held(base), Part("plug", plug)]
    assert motions(Assembly(parts)) == 1
    assert check(Assembly(parts)).first_order == "stable"
    assert check(Assembly(parts, gravity=[0, 0, G])).first_order == "unstable"
    contacts = detect.contacts(Assembly(parts))
    assert contacts.patch_kind.tolist() == ["cone"]
    alpha = 0.4
    area = np.pi * np.sin(alpha) * (9 - 1) / np.cos(alpha) ** 2
    assert contacts.patch_area[0] == pytest.approx(area, rel=1e-6)
    if exact:  # from the base to the plug
        away = contacts.points * [1, 1, 0]
        away /= np.linalg.norm(away, axis=1)[:, None]
        assert contacts.normals == pytest.approx(
            np.array([0, 0, np.sin(alpha)]) - np.cos(alpha) * away
        )


def test_cone_lies_on_a_plane_along_a_line():
    alpha = 0.4
    pose = Pose([0, 0, 0], turn([0, 1, 0], 90 - np.degrees(alpha)))
    contacts = contacts_of(FLOOR, Part("cone", cone_frustum(alpha), pose))
    assert contacts.patch_kind.tolist() == ["cone"]
    assert contacts.normals == pytest.approx(np.array([[0, 0, 1.0]] * 2), abs=1e-12)
    ends = np.sort(np.abs(contacts.points[:, 0]))
    assert ends == pytest.approx(np.array([1, 3]) / np.cos(alpha))
    assert np.abs(contacts.points[:, 2]).max() < 1e-12


@pytest.mark.slow
def test_torus_lies_on_a_circle_and_stands_on_a_point():
    lying = contacts_of(FLOOR, Part("ring", torus(2.0, 0.5), Pose([0, 0, 0.5])))
    assert lying.patch_kind.tolist() == ["torus"]
    assert np.hypot(*lying.points[:, :2].T) == pytest.approx(np.full(AROUND, 2.0))
    assert lying.normals == pytest.approx(np.tile([0, 0, 1.0], (AROUND, 1)))
    standing = contacts_of(FLOOR, Part("ring", torus(2.0, 0.5), Pose([0, 0, 2.5], LYING)))
    assert standing.points == pytest.approx(np.zeros((1, 3)), abs=1e-12)
    parts = [FLOOR, Part("ring", torus(2.0, 0.5), Pose([0, 0, 0.5]), center_of_mass=[1.99, 0, 0])]
    assert check(Assembly(parts)).first_order == "stable"


def v_block(x=0.0, opening=45.0):
    """Two half-planes that meet at a V along y, at the origin."""
    tilt = np.radians(opening)
    parts = []
    for side in (1, -1):
        out = np.array([-side * np.sin(tilt), 0, np.cos(tilt)])
        along = np.array([side * np.cos(tilt), 0, np.sin(tilt)])
        centre = 2.5 * along - 0.5 * out + np.array([0, x, 0])
        pose = Pose(centre, turn([0, 1, 0], side * (90 - opening)))
        parts.append(Part(f"v{side}{x}", Box([1, 1, 5]), pose, grounded=True))
    return parts


@pytest.mark.slow
@pytest.mark.parametrize("exact", [True, False])
def test_shaft_on_two_v_blocks(exact):
    shape = peg(1.0, -4, 4, sides=32) if exact else mesh_of(peg(1.0, -4, 4, sides=32))
    shaft = Part("shaft", shape, Pose([0, 0, np.sqrt(2)], LYING))
    parts = [*v_block(-2), *v_block(2), shaft]
    contacts = detect.contacts(Assembly(parts))
    assert contacts.patch_kind.tolist() == ["cylinder"] * 4
    assert motions(Assembly(parts)) == 2
    for degrees, word in ((44.99, "stable"), (45.01, "unstable")):
        lean = np.radians(degrees)
        gravity = [G * np.sin(lean), 0, -G * np.cos(lean)]
        assert check(Assembly(parts, gravity=gravity)).first_order == word
    one = [*v_block(-2), shaft]
    assert check(Assembly(one)).first_order == "unstable"
    assert np.abs(contacts.points[:, 1]).max() == pytest.approx(2.5)


# discs --------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("sides", [16, 48])
def test_bolt_hangs_by_its_head(sides):
    parts = [held(bore()), Part("bolt", bolt(head=2, sides=sides), Pose([0, 0, 1]))]
    contacts = detect.contacts(Assembly(parts))
    assert sorted(contacts.patch_kind) == ["cylinder", "plane"]
    assert contacts.unsupported == ()
    assert contacts.overlaps == ()
    assert motions(Assembly(parts)) == 1
    assert check(Assembly(parts)).first_order == "stable"
    assert check(Assembly(parts, gravity=[0, 0, G])).first_order == "unstable"


@pytest.mark.parametrize("sides", [12, 48])
def test_disc_of_few_sides_is_undecided_only_inside_its_circle(sides):
    inner = np.cos(np.pi / sides)
    middle = np.pi / sides
    for reach, word in (
        (inner - 1e-6, "stable"),
        (0.5 + inner / 2, "undecided"),
        (1 / inner + 1e-6, "unstable"),
    ):
        at = [reach * np.cos(middle), reach * np.sin(middle), 0]
        disc = Part(
            "disc", peg(1.0, -0.5, 0.5, sides=sides), Pose([0, 0, 0.5]), mass=1.0, center_of_mass=at
        )
        assert check(Assembly([FLOOR, disc])).first_order == word


def test_fillet_tangent_to_a_flat_bottom_adds_nothing():
    from solids import arc, extruded, line

    profile = [*line((-1, 0), (1, 0)), *arc((1, 0.5), (1, 0), (1.5, 0.5), 8, left=True),
               *line((1.5, 2), (-1, 2))]  # fmt: skip
    contacts = contacts_of(FLOOR, Part("b", extruded(profile, 2.0)))
    assert contacts.patch_kind.tolist() == ["plane"]
    assert contacts.patch_area[0] == pytest.approx(4.0)
    assert contacts.unsupported == ()


def on_its_corner(height):
    """A cube on a corner over the flat ring of `bore()`, `height` above it."""
    tip = Rotation.align_vectors([[0, 0, -1]], [[-1, -1, -1]])[0]
    x, y, z, w = tip.as_quat()
    centre = [2.0, 0.0, 1.0 + 0.15 * np.sqrt(3) + height]
    return Part("cube", Box([0.3, 0.3, 0.3]), Pose(centre, [w, x, y, z]))


def test_corner_on_a_flat_face_of_a_round_part_is_a_contact_within_the_gap_only():
    # the ring's triangles lie up to 6e-3 off its cylinders: no reason to reach further elsewhere
    base = held(bore())
    touching = contacts_of(base, on_its_corner(0.0))
    assert touching.patch_kind.tolist() == ["vertex-face"]
    assert touching.points == pytest.approx(np.array([[2.0, 0.0, 1.0]]))
    assert np.abs(touching.normals[:, 2]) == pytest.approx(1.0)
    assert touching.unsupported == ()
    apart = contacts_of(base, on_its_corner(3e-3))
    assert (len(apart), apart.unsupported, len(apart.possible)) == (0, (), 0)


@pytest.mark.slow
def test_rims_of_one_axis_touch_only_where_their_circles_do():
    # a washer in a bore, its rim .01 short of that of the hole: chords come nearer than circles
    for gap, kinds in ((0.01, []), (0.0, ["cylinder"])):
        inner = peg(1.0 - gap, 0.5, 1.0, sides=12)
        contacts = contacts_of(held(bore(sides=12, phase=0.2)), Part("p", inner))
        assert contacts.patch_kind.tolist() == kinds
        assert contacts.unsupported == ()


# what stays without a formula ---------------------------------------------------------


@pytest.mark.slow
def test_ball_beside_the_middle_of_a_hole_touches_one_point_of_the_rim_and_falls():
    centre = [1e-3, 0, 1 + np.sqrt(1.5**2 - (1 + 1e-3) ** 2)]
    parts = [held(bore()), Part("ball", Sphere(1.5), Pose(centre))]
    verdict = check(Assembly(parts))
    assert verdict.verdict == "unstable"
    assert len(verdict.contact_set) == 1
    assert verdict.contact_set.unsupported == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("gap", "kinds"), [(3.3e-5, ["clearance"]), (2.7e-3, ["clearance"]), (3.3e-3, [])]
)
def test_ball_just_above_the_rim_of_a_hole_is_open_as_far_as_loose_data_would_reach(gap, kinds):
    # the size of the ball is 3: a gap tolerance of 3e-5; loose data reach to 3e-3
    centre = [0, 0, 1 + np.sqrt((1.5 + gap) ** 2 - 1)]
    parts = [held(bore()), Part("ball", Sphere(1.5), Pose(centre))]
    verdict = check(Assembly(parts))
    assert len(verdict.contact_set) == 0
    assert [pair.kind for pair in verdict.contact_set.open_pairs] == kinds
    assert verdict.verdict == ("undecided" if kinds else "unstable")


@pytest.mark.slow
@pytest.mark.parametrize(("lean", "count"), [(0.0, AROUND), (0.1, 1)])
def test_rings_have_a_circle_of_contact_only_about_a_common_axis(lean, count):
    """Within a wide gap, the gaps of a leaning ring differ by less than the tolerance."""
    quaternion = np.roll(Rotation.from_rotvec([lean, lean / 2, 0]).as_quat(), 1)
    ring = Part("ring", torus(2.0, 0.5), Pose([0, 0, 1.5], quaternion))
    contacts = contacts_of(held(torus(2.0, 0.5)), ring, tolerance=Tolerance(gap=1.0))
    assert len(contacts.points) == count
    assert np.linalg.norm(contacts.normals, axis=1) == pytest.approx(1.0, abs=1e-12)


def test_torus_on_a_torus_touches_along_a_circle():
    parts = [held(torus(2, 0.5)), Part("ring", torus(2, 0.5), Pose([0, 0, 1.0]))]
    contacts = detect.contacts(Assembly(parts))
    assert contacts.unsupported == ()
    assert set(contacts.patch_kind.tolist()) == {"torus"}
    assert np.allclose(contacts.points[:, 2], 0.5)
    assert np.allclose(np.hypot(*contacts.points[:, :2].T), 2.0)


@pytest.mark.slow
def test_free_form_is_listed_and_not_taken_for_its_triangles():
    from kilter.shape.solid import Solid

    solid = ball(0.5, sides=24, rings=12)
    free = Solid(
        solid.vertices, solid.triangles, (), np.full(len(solid.triangles), -1),
        solid.volume, solid.centroid, solid.second_moment, sagitta=5e-3,
    )  # fmt: skip
    verdict = check(Assembly([FLOOR, Part("blob", free, Pose([0, 0, 0.5]))]))
    assert verdict.verdict == "undecided"
    assert [u.kind for u in verdict.contact_set.unsupported] == ["curved"]
    far = check(Assembly([FLOOR, Part("blob", free, Pose([0, 0, 0.6]))]))
    assert far.verdict == "unstable"
    assert far.contact_set.unsupported == ()


def beside_a_wall(gap):
    """A block with a free-form side, on the ground of an L-shaped part, at a gap from its wall."""
    ell = Prism([[-1, -1], [2, -1], [2, 0], [0, 0], [0, 2], [-1, 2]], 3.0)
    cube = Mesh(BOX_CORNERS, BOX_TRIANGLES)
    left = (cube.vertices[cube.triangles][:, :, 0] < 0).all(axis=1)
    block = Part("block", as_solid(cube, left, sagitta=1e-3), Pose([0.5 + gap, 0, 0.5]))
    return Assembly([Part("base", ell, grounded=True), block])


def test_points_of_a_triangle_on_a_flat_patch_are_explained_by_it():
    faces = find_families(begin_search(beside_a_wall(0.1), Tolerance(), lambda stage: None))
    low, high = faces.flat.patches.points.min(axis=0), faces.flat.patches.points.max(axis=0)
    assert (low, high) == (pytest.approx([0.1, -0.5, 0.0]), pytest.approx([1.1, 0.5, 0.0]))
    rng, slack, room = np.random.default_rng(5), 0.05, np.array([0.2, 0.2, 0.1])
    first = rng.uniform(low - room, high + room, size=(2000, 1, 3))
    triangles = first + rng.uniform(-0.06, 0.06, size=(2000, 3, 3))
    lies = triangles_on_flat(faces, 0, triangles, slack)
    assert 100 < lies.sum() < 1900
    shares = rng.dirichlet([0.3, 0.3, 0.3], size=50)
    points = np.einsum("ks,nsi->nki", shares, triangles)
    known = explained(faces, 0, points.reshape(-1, 3), slack).reshape(2000, 50).all(axis=1)
    assert known[lies].all()
    corners = explained(faces, 0, triangles.reshape(-1, 3), slack).reshape(2000, 3).all(axis=1)
    assert np.array_equal(corners, lies)


@pytest.mark.parametrize("gap", [0.0, 0.1])
def test_families_without_unmodelled_contacts_have_the_same_patches(gap):
    search = begin_search(beside_a_wall(gap), Tolerance(), lambda stage: None)
    every, modelled = find_families(search), find_families(search, unmodelled=False)
    assert bool(every.sharp.unsupported) == (gap == 0.0)
    assert modelled.sharp.unsupported == ()
    assert np.array_equal(every.sharp.patches.points, modelled.sharp.patches.points)
    assert np.array_equal(every.sharp.patches.normals, modelled.sharp.patches.normals)


def unrolled_band(sides, low, high, phase=0.0, levels=1):
    """Angles and heights of the triangles of a whole band, shape (m, 3) each."""
    angle = phase + 2 * np.pi * np.arange(sides + 1) / sides
    height = np.linspace(low, high, levels + 1)
    angles, heights = [], []
    for row in range(levels):
        a, b = height[row : row + 2]
        for p, q in itertools.pairwise(angle):
            angles += [(p, q, q), (p, q, p)]
            heights += [(a, a, b), (a, b, b)]
    return np.array(angles), np.array(heights)


@pytest.mark.parametrize("sides", [24, 63])
def test_overlap_of_a_shaft_with_the_holes_of_both_ends_of_a_board_is_known_as_bands(sides):
    shaft = unrolled_band(24, 0.0, 10.0)
    ends = [unrolled_band(sides, -1.0, 2.0, 0.03, levels=3), unrolled_band(sides, 7.0, 12.0)]
    holes = tuple(np.concatenate(rows) for rows in zip(*ends, strict=True))
    _, heights, area, bands = unrolled_overlap(shaft, holes, 1.0)
    assert bands
    assert area == pytest.approx(2 * np.pi * (2.0 + 3.0), rel=1e-9)
    assert (heights.min(), heights.max()) == (0.0, 10.0)
    opened = tuple(np.delete(rows, 2 * sides, axis=0) for rows in holes)
    assert not unrolled_overlap(shaft, opened, 1.0)[3]
