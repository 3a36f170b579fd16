"""Bodies have the mass, centre and inertia of closed forms; wrong input is refused in words."""

import dataclasses

import numpy as np
import pytest
from judged import judged, random_turn
from transformations import mirrored, scaled

from kilter import (
    Assembly,
    Box,
    Cylinder,
    FrictionPair,
    GivenContact,
    InputError,
    Joint,
    Load,
    Mesh,
    Part,
    Pose,
    Prism,
    Sphere,
    check,
    contacts,
)
from kilter.assembly.mesh_surface import reweighed
from kilter.assembly.part import inertia_matrix
from kilter.files.reading_steps import with_density, with_masses
from kilter.scenes import stacks
from kilter.scenes.pieces import block, cells, floor, moved, turn
from kilter.shape.primitives import surface
from kilter.tell.numbers import plain

RHO = 1000.0


def body(shape, pose=None, **properties):
    """Volume, mass, centre and inertia of one part."""
    part = Part("body", shape, pose or Pose(), grounded=True, **properties)
    g = Assembly([part]).geometry
    return float(g.volume[0]), float(g.mass[0]), g.center[0], g.inertia[0]


def as_mesh(shape):
    return Mesh(*surface(shape))


def test_box_is_its_closed_form():
    a, b, c = 2.0, 3.0, 5.0
    volume, mass, center, inertia = body(Box([a, b, c]))
    assert volume == pytest.approx(30.0)
    assert mass == pytest.approx(30e3)
    assert np.allclose(center, 0)
    expected = mass / 12 * np.array([b**2 + c**2, a**2 + c**2, a**2 + b**2])
    assert np.allclose(inertia, np.diag(expected), rtol=1e-14)


def test_cylinder_is_its_closed_form():
    r, h = 2.0, 3.0
    volume, mass, center, inertia = body(Cylinder(r, h))
    assert volume == pytest.approx(np.pi * r**2 * h)
    across = mass * (3 * r**2 + h**2) / 12
    assert np.allclose(inertia, np.diag([across, across, mass * r**2 / 2]), rtol=1e-14)
    assert np.allclose(center, 0)


def test_sphere_is_its_closed_form():
    volume, mass, center, inertia = body(Sphere(1.5))
    assert volume == pytest.approx(4 / 3 * np.pi * 1.5**3)
    assert np.allclose(inertia, np.eye(3) * 0.4 * mass * 1.5**2, rtol=1e-14)
    assert np.allclose(center, 0)


@pytest.mark.parametrize(
    "shape",
    [
        Box([1.0, 2.0, 3.0]),
        Prism([[0, 0], [4, 0], [4, 3]], 1.0),
        Prism([[0, 0], [2, 0], [2, 1], [1, 1], [1, 3], [0, 3]], 0.5),
        Prism([[0, 0], [0, 3], [1, 3], [1, 1], [2, 1], [2, 0]], 0.5),
    ],
)
def test_shape_and_its_mesh_are_the_same_body(shape):
    one, other = body(shape), body(as_mesh(shape))
    for mine, theirs in zip(one, other, strict=True):
        assert np.allclose(mine, theirs, rtol=1e-13, atol=1e-13)


def test_triangular_prism_is_its_closed_form():
    volume, mass, center, inertia = body(Prism([[0, 0], [3, 0], [0, 6]], 2.0))
    assert volume == pytest.approx(18.0)
    assert np.allclose(center, [1, 0, 2])
    # second moments of a right triangle about its centroid: b^2 / 18 and h^2 / 18 a mass
    xx, yy, zz = mass * 9 / 18, mass * 4 / 12, mass * 36 / 18
    xz = -mass * 3 * 6 / 36
    expected = [[yy + zz, 0, -xz], [0, xx + zz, 0], [-xz, 0, xx + yy]]
    assert np.allclose(inertia, expected, rtol=1e-13)


def test_non_convex_l_is_the_sum_of_two_boxes():
    polygon = [[0, 0], [3, 0], [3, 1], [1, 1], [1, 4], [0, 4]]
    volume, mass, center, inertia = body(Prism(polygon, 2.0))
    boxes = [((1.5, 0, 0.5), (3, 2, 1)), ((0.5, 0, 2.5), (1, 2, 3))]
    masses = np.array([np.prod(size) * RHO for _, size in boxes])
    middle = (masses[:, None] * np.array([c for c, _ in boxes])).sum(axis=0) / masses.sum()
    total = np.zeros((3, 3))
    for m, (c, size) in zip(masses, boxes, strict=True):
        second = np.diag(np.square(size)) / 12
        arm = np.array(c) - middle
        total += m * (np.trace(second) * np.eye(3) - second)
        total += m * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    assert (volume, mass) == pytest.approx((12.0, 12e3))
    assert np.allclose(center, middle, atol=1e-14)
    assert np.allclose(inertia, total, rtol=1e-13)


def test_body_with_a_hole_is_a_difference():
    solid = np.ones((3, 3, 1), dtype=bool)
    solid[1, 1, 0] = False
    lines = [-2.0, -1.0, 1.0, 2.0]
    volume, _, _, inertia = body(cells(lines, lines, [0.0, 1.0], solid))
    assert volume == pytest.approx(12.0)
    assert inertia[2, 2] == pytest.approx(RHO * (16 * 32 - 4 * 8) / 12, rel=1e-13)


@pytest.mark.parametrize("distance", [1e2, 1e4])
def test_mesh_far_from_the_origin_keeps_its_digits(distance):
    shape = Prism([[0, 0], [3, 0], [3, 1], [1, 1], [1, 4], [0, 4]], 2.0)
    near = body(as_mesh(shape))
    vertices, triangles = surface(shape)
    shift = distance * np.array([1.0, -0.7, 0.3])
    far = body(Mesh(vertices + shift, triangles))
    assert np.allclose(far[2] - shift, near[2], atol=1e-15 * distance * 10)
    assert np.allclose(far[3], near[3], rtol=1e-15 * distance * 100)


def test_mass_and_centre_given_override_the_geometry():
    pose = Pose([1, 2, 3], turn([0, 0, 1], 90))
    _, mass, center, inertia = body(Box([1, 1, 1]), pose, mass=5.0, center_of_mass=[0.2, 0, 0])
    assert mass == 5.0
    assert np.allclose(center, [1, 2.2, 3])
    assert np.allclose(inertia, np.eye(3) * 5 / 6)


def test_density_is_per_cubic_metre_in_every_unit():
    for units, metres in (("m", 1), ("cm", 1e-2), ("mm", 1e-3), ("in", 0.0254)):
        part = Part("box", Box([1 / metres] * 3), density=7850.0, grounded=True)
        assert Assembly([part], units=units).geometry.mass[0] == pytest.approx(7850.0)


@pytest.mark.slow
def test_given_mass_decides_and_the_default_beside_it_brings_a_warning():
    # a lever: the weight at its end decides
    table = block("table", [-1, -1, -1], [0, 1, 0], grounded=True)
    plank = block("plank", [-1, -0.5, 0], [0.9, 0.5, 0.1])
    weight = block("weight", [0.7, -0.1, 0.1], [0.9, 0.1, 0.2], mass=1.0)
    # plank 190 kg at -0.05 balances w at 0.8: 11.875 kg
    for mass, word in ((11.87, "stable"), (11.88, "unstable")):
        heavy = dataclasses.replace(weight, mass=mass)
        verdict = judged(Assembly([table, plank, heavy]))
        assert verdict.verdict == word
        assert any(
            "density 1000 kg/m^3 assumed" in text and "--density" in text
            for text in verdict.warnings
        )


# wrong input ----------------------------------------------------------------------------

CUBE = as_mesh(Box([1, 1, 1]))


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 0, -1, "heavy", None, True])
@pytest.mark.parametrize("key", ["density", "mass"])
def test_w10_weight_that_is_no_number_above_zero_is_refused(key, value):
    if value is None:
        assert Part("C", CUBE, **{key: value}).name == "C"
        return
    with pytest.raises((InputError, ValueError)) as error:
        Part("C", CUBE, **{key: value})
    assert isinstance(error.value, InputError)
    assert "part 'C'" in str(error.value)
    assert key in str(error.value)


def test_w10_nan_in_a_vertex_is_refused_by_number():
    vertices = CUBE.vertices.copy()
    vertices[3, 1] = np.nan
    with pytest.raises(InputError, match="vertex 3"):
        Mesh(vertices, CUBE.triangles)


def test_w10_open_mesh_is_named_in_a_warning():
    part = Part("lid", Mesh(CUBE.vertices, CUBE.triangles[:-1]))
    (warning,) = Assembly([part]).geometry.warnings
    assert warning.startswith("part 'lid': the mesh is open: 3 edges")


def test_w10_flat_part_is_refused_by_name():
    flat = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 1]])
    with pytest.raises(InputError, match=r"part 'sheet'.*flat"):
        _ = Assembly([Part("sheet", flat, grounded=True)]).geometry


def test_w10_face_of_no_area_is_dropped_and_counted():
    vertices = np.vstack([CUBE.vertices, [[0.0, 0.0, 0.0]]])
    triangles = np.vstack([CUBE.triangles, [[0, 0, 1], [2, 2, 2]]])
    parts = [
        block("table", [-2, -2, -1.5], [2, 2, -0.5], grounded=True),
        Part("cube", Mesh(vertices, triangles)),
    ]
    verdict = judged(Assembly(parts))
    assert verdict.verdict == "stable"
    assert any("part 'cube': 2 faces of zero area dropped" in t for t in verdict.warnings)


def test_w10_same_geometry_under_two_names_is_named():
    parts = [floor([-2, -2], [2, 2]), *(block(n, [0, 0, 0], [1, 1, 1]) for n in ("one", "two"))]
    warnings = check(Assembly(parts)).warnings
    assert any(text.startswith("'one' and 'two' are the same body twice") for text in warnings)
    assert any("same body twice" in text for text in contacts(Assembly(parts)).warnings)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Box([1, 0, 1]), "above zero"),
        (lambda: Box([1, np.nan, 1]), "above zero"),
        (lambda: Cylinder(-1, 1), "radius"),
        (lambda: Cylinder(1, float("inf")), "height"),
        (lambda: Sphere(0), "radius"),
        (lambda: Prism([[0, 0], [1, 0]], 1), "fewer than 3"),
        (lambda: Prism([[0, 0], [1, 0], [2, 0]], 1), "no area"),
        (lambda: Prism([[0, 0], [2, 2], [2, 0], [0, 1]], 1), "crosses itself"),
        (lambda: Mesh([[0, 0, 0]], [[0, 0, 1]]), "vertex 1 of 1"),
        (lambda: Pose([0, 0, np.inf]), "not finite"),
        (lambda: Pose(rotation=[0, 0, 0, 0]), "zero quaternion"),
        (lambda: Part("", CUBE), "name"),
        (lambda: Part("ground", CUBE), "reserved"),
        (lambda: Part("C", "cube"), "shape is of type str"),
        (lambda: Load("C", force=[0, 0, np.nan]), "force"),
        (lambda: FrictionPair(("A", "B"), -0.1), "friction"),
        (lambda: GivenContact(("A", "B"), [[0, 0, np.nan]], [0, 0, 1]), "no valid points|finite"),
        (lambda: GivenContact(("A", "B"), [[0, 0, 0]], [0, 0, 0]), "normal"),
    ],
)
def test_wrong_value_is_refused_in_words(make, words):
    with pytest.raises(InputError, match=words):
        make()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"gravity": [0, 0, 0]}, "gravity"),
        ({"gravity": [0, np.nan, 0]}, "gravity"),
        ({"gravity": [0, 1, -9], "planar": True}, "x-z plane"),
        ({"units": "ft"}, "unknown units"),
        ({"friction": -1}, "friction"),
        ({"loads": [Load("cub-1")]}, "did you mean 'cube-1'"),
        ({"joints": [Joint(("cube-1", "cube-1"))]}, "joint names"),
        ({"friction_pairs": [FrictionPair(("base", "nobody"), 0.1)]}, "no part is named"),
    ],
)
def test_wrong_assembly_is_refused_in_words(options, words):
    with pytest.raises(InputError, match=words):
        Assembly(stacks.tower(2).parts, **options)


def test_names_must_differ_and_parts_exist():
    cube = block("cube", [0, 0, 0], [1, 1, 1])
    with pytest.raises(InputError, match="two parts are named 'cube'"):
        Assembly([cube, cube])
    with pytest.raises(InputError, match="no parts"):
        Assembly([])


def test_nothing_held_is_refused_and_the_largest_part_named():
    with pytest.raises(InputError, match="nothing is held") as error:
        judged(Assembly([block("bolt", [0, 0, 0], [1, 1, 1]), block("b", [0, 0, 1], [1, 1, 3])]))
    assert "with_grounded('b'), or put a table under them" in str(error.value)


def test_joint_without_its_point_is_refused_in_words():
    with pytest.raises(InputError, match="revolute"):
        Assembly(stacks.tower(1).parts, joints=[Joint(("base", "cube-1"), "revolute")])


def test_a_name_that_an_answer_shortened_is_accepted_as_typed():
    paths = [f"bracket-assembly_{k}/nut-bolt-assembly_{j}/nut" for k in (1, 2) for j in (1, 2)]
    parts = [Part(path, Box([1, 1, 1]), [2 * k, 0, 0]) for k, path in enumerate(paths)]
    assembly = Assembly(parts)
    for path in paths:
        short = plain(path)
        assert "..." in short
        assert assembly.matching(short) == {path}
    with pytest.raises(InputError, match=r"no part is named 'bracket\.\.\.nut'"):
        assembly.matching("bracket...nut")  # four parts: it is no shortened name of one part


SIX = [3.0, 4.0, 5.0, 0.3, -0.4, 0.5]
G = 9.81


def body_inertia(**more):
    """A turned box with a given inertia."""
    random = np.random.default_rng(4)
    return Part("body", Box([1, 2, 3]), Pose([1, -2, 3], random_turn(random)), inertia=SIX, **more)


@pytest.mark.parametrize("more", [{}, {"mass": 3.0}, {"mass": 3.0, "center_of_mass": [0.1, 0, 2]}])
def test_the_world_inertia_is_the_given_tensor_turned(more):
    part = body_inertia(**more)
    turned = part.pose.matrix @ inertia_matrix(np.array(SIX)) @ part.pose.matrix.T
    assert np.allclose(Assembly([part]).geometry.inertia[0], turned, atol=1e-14)


def test_copies_keep_the_inertia_of_the_body():
    """A turn Q I Q^T, a mirror image M I M, and lengths times k with masses times k^3: k^5 I."""
    assembly = Assembly([body_inertia(mass=3.0)])
    inertia = assembly.geometry.inertia[0]
    turn = Pose([0, 0, 0], random_turn(np.random.default_rng(8)))
    q, m = turn.matrix, np.diag([-1.0, 1, 1])
    copies = {
        "moved": (moved(assembly, turn.rotation, [1, 2, 3]), q @ inertia @ q.T),
        "mirrored": (mirrored(assembly), m @ inertia @ m),
        "scaled": (scaled(assembly, 2.0), 32 * inertia),
    }
    for name, (copy, expected) in copies.items():
        assert np.allclose(copy.geometry.inertia[0], expected, rtol=1e-13, atol=1e-12), name


def test_another_mass_changes_a_given_inertia_in_proportion():
    heavy = Assembly([body_inertia(mass=3.0)])
    assert np.allclose(with_masses(heavy, [("body", 6.0)])["body"].inertia, np.multiply(SIX, 2))
    light = Assembly([body_inertia()])  # 6 m^3 of the default density
    assert np.allclose(with_density(light, 500.0)["body"].inertia, np.divide(SIX, 2))
    assert np.allclose(
        reweighed(body_inertia(density=500.0), mass=6000.0).inertia, np.multiply(SIX, 2)
    )


@pytest.mark.parametrize("given", [5.0, None])
def test_inertia_in_millimetres_is_that_of_the_same_body_in_metres(given):
    """A plate tips about an edge by m g d / (I + m d^2); without I, by that of its shape."""
    m, d = 10.0, 0.2
    table = Part("table", Box([2000] * 3), [-1000, 0, -1000], grounded=True)
    inertia = None if given is None else np.array([given, given, given, 0, 0, 0]) * 1e6
    plate = Part("plate", Box([1000, 1000, 200]), [200, 0, 100], mass=m, inertia=inertia)
    verdict = judged(Assembly([table, plate], units="mm"))
    about = m * (1 + 0.2**2) / 12 if given is None else given
    assert verdict.motion.acceleration[1, 4] == pytest.approx(m * G * d / (about + m * d**2))
