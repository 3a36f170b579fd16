"""Round bodies on a table: their lowest points, their contacts, and their free motions."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from solids import (
    arc,
    ball,
    bolt,
    bore,
    cone_frustum,
    line,
    mesh_of,
    peg,
    revolved,
    socket,
    torus,
    trough,
)

from kilter import Assembly, Box, Cylinder, Part, Pose, Sphere, check, fastened
from kilter.assembly.changed_copies import lowest_heights
from kilter.contact import detect
from sampled import sampled

ALPHA = 0.4
G = 9.81


def capsule(sides=40, pieces=9):
    """A cylinder of radius .7 with a half ball at either end, about z."""
    top = arc((0, 1.0), (0.7, 1.0), (0, 1.7), pieces, left=True)
    bottom = arc((0, -1.0), (0, -1.7), (0.7, -1.0), pieces, left=True)
    return revolved([*line((0.7, 1.0)), *top, *line((0, -1.7)), *bottom], sides)


def pill(sides=24, pieces=7):
    """A disc with a rounded edge below, about z."""
    edge = arc((1.5, -0.6), (1.5, -1.0), (1.9, -0.6), pieces, left=True)
    return revolved([*line((0, -1.0), (1.5, -1.0)), *edge, *line((1.9, 1.0), (0, 1.0))], sides)


# the body, and the same with its outline cut so finely that its corners are lowest to 1e-6
BODIES = {
    "ball": lambda: (Sphere(1.0), ball(1.0, 3, 3000)),
    "cylinder": lambda: (Cylinder(1.0, 3.0), peg(1.0, -1.5, 1.5)),
    "cone": lambda: (cone_frustum(ALPHA, 0.0), cone_frustum(ALPHA, 0.0)),
    "frustum": lambda: (cone_frustum(ALPHA), cone_frustum(ALPHA)),
    "torus": lambda: (torus(), torus(2.0, 0.5, 3, 3000)),
    "bolt": lambda: (bolt(), bolt()),
    "ring": lambda: (bore(sides=17), bore()),
    "socket": lambda: (socket(rim=-0.3), socket(rim=-0.3, sides=3, rings=900)),
    "trough": lambda: (trough(), trough(pieces=900)),
    "capsule": lambda: (capsule(), capsule(3, 3000)),
    "pill": lambda: (pill(), pill(3, 3000)),
}


def lowest_point(name, fine, up):
    """The lowest point of a body along a unit `up` (3,), in its own frame, by its outline."""
    corners = fine.vertices
    if name != "trough":
        aside = np.hypot(*up[:2])
        away = -up[:2] / aside if aside else np.array([1.0, 0.0])
        corners = np.column_stack([np.hypot(*corners[:, :2].T)[:, None] * away, corners[:, 2]])
    return corners[(corners @ up).argmin()]


@pytest.mark.slow
@pytest.mark.parametrize("name", sampled(5, BODIES))
def test_lowest_point_is_that_of_the_exact_surface(name):
    shape, fine = BODIES[name]()
    geometry = Assembly([Part("body", shape)]).geometry
    rng = np.random.default_rng(len(name))
    level = [[0, 0, 1.0], [0, 0, -1.0], [1.0, 0, 0], [0.6, 0.8, 0]]
    for up in [*rng.normal(size=(8, 3)), *np.array(level)]:
        up = up / np.linalg.norm(up)
        finest = float(lowest_point(name, fine, up) @ up)
        found = float(lowest_heights(geometry, up)[0])
        assert finest - 1e-6 <= found <= finest + 1e-12


def test_meshes_are_lowest_in_their_corners():
    geometry = Assembly([Part("a", mesh_of(peg(sides=24))), Part("b", Sphere(1.0))]).geometry
    up = np.array([0.0, 0.6, 0.8])
    corners = geometry.vertices[geometry.vertex_part == 0] @ up
    assert lowest_heights(geometry, up) == pytest.approx([corners.min(), -1.0], abs=1e-15)


# resting ------------------------------------------------------------------------------------

# name: shape, a unit direction of the body that points down, neutral motions
CONE_SIDE = [np.cos(ALPHA), 0.0, -np.sin(ALPHA)]
RESTING = {
    "ball": (Sphere(1.0), [0.3, -0.5, 0.7], 5),
    "ball of many faces": (ball(), [0.3, -0.5, 0.7], 5),
    "cylinder, lying": (Cylinder(1.0, 3.0), [0.6, -0.8, 0], 4),
    "peg, lying": (peg(), [0.6, -0.8, 0], 4),
    "capsule, lying": (capsule(), [0.6, -0.8, 0], 4),
    "cylinder, standing": (Cylinder(1.0, 3.0), [0, 0, -1], 3),
    "peg, standing": (peg(), [0, 0, 1], 3),
    "capsule, standing": (capsule(), [0, 0, 1], 5),
    "pill": (pill(), [0, 0, -1], 3),
    "cone, on its base": (cone_frustum(ALPHA, 0.0), [0, 0, 1], 3),
    "cone, lying": (cone_frustum(ALPHA, 0.0), CONE_SIDE, 4),
    "cone, on its tip": (cone_frustum(ALPHA, 0.0), [0, 0, -1], 5),
    "torus, lying": (torus(), [0, 0, -1], 3),
    "torus, standing": (torus(), [0.6, 0.8, 0], 5),
}


def on_table(shape, down, seed, **more):
    """The body in a random pose, gravity along its direction `down`, a table below."""
    rng = np.random.default_rng(seed)
    turn = Rotation.random(rng=rng)
    pose = Pose(rng.normal(size=3) * 5, turn.as_quat()[[3, 0, 1, 2]])
    down = turn.apply(np.array(down, float) / np.linalg.norm(down))
    return Assembly([Part("body", shape, pose, **more)], gravity=G * down).with_floor()


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", RESTING)
@pytest.mark.parametrize("seed", range(2))
def test_body_on_a_table_is_in_equilibrium_and_moves_as_derived(name, seed):
    shape, down, count = RESTING[name]
    verdict = check(on_table(shape, down, seed))
    assert verdict.first_order == "stable"
    assert (verdict.verdict == "balanced") == (name in ("capsule, standing", "torus, standing"))
    assert verdict.contact_set.unsupported == ()
    assert np.abs(verdict.contact_set.patch_gap).max() < 1e-13
    assert verdict.to_dict()["neutral"] == {"two_sided": count, "one_sided": 0}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("shape", "down", "inside", "outside"),
    [
        (Sphere(1.0), [0, 0, -1], [0, 0, 0.5], [1e-3, 0, 0]),
        (peg(), [1, 0, 0], [0.3, 0, 1.999], [0.3, 0, 2.001]),
        (Cylinder(1.0, 3.0), [0, 0, -1], [0.99, 0, 0], [1.01, 0, 0]),
        (cone_frustum(ALPHA, 0.0), [0, 0, 1], [0, 1.26, 2], [0, 1.28, 2]),
        (torus(), [0, 0, -1], [1.99, 0, 0], [2.01, 0, 0]),
        (torus(), [1, 0, 0], [0.2, 0, 0], [0, 1e-3, 0]),
    ],
)
def test_body_falls_where_its_centre_is_beyond_its_foot(shape, down, inside, outside):
    for centre, word in ((inside, "stable"), (outside, "unstable")):
        verdict = check(on_table(shape, down, 3, mass=1.0, center_of_mass=centre))
        assert verdict.first_order == word


@pytest.mark.slow
def test_lying_cone_tips_over_its_rim():
    # the generator at the bottom runs from the tip to the rim at h / cos(alpha)
    along = np.array([np.sin(ALPHA), 0, np.cos(ALPHA)])
    for share, word in ((0.001, "stable"), (0.999, "stable"), (1.001, "unstable")):
        centre = share * 3 / np.cos(ALPHA) * along
        verdict = check(
            on_table(cone_frustum(ALPHA, 0.0), CONE_SIDE, 4, mass=1.0, center_of_mass=centre)
        )
        assert verdict.first_order == word


# at any tilt --------------------------------------------------------------------------------


@pytest.mark.slow
@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("seed", range(3))
def test_at_any_tilt_a_body_touches_in_one_exact_point_and_falls_unless_it_is_a_ball(name, seed):
    shape, fine = BODIES[name]()
    down = np.random.default_rng(seed).normal(size=3)
    assembly = on_table(shape, down, seed)
    verdict = check(assembly)
    contacts = verdict.contact_set
    assert contacts.unsupported == ()
    assert len(contacts.points) == 1
    assert verdict.verdict == ("stable" if name == "ball" else "unstable")
    # to the length of the sides of its arcs
    pose = assembly.parts[0].pose
    lowest = pose.apply(lowest_point(name, fine, -pose.matrix.T @ assembly.down)[None])[0]
    assert np.linalg.norm(contacts.points[0] - lowest) < 2e-3
    sense = 1.0 if contacts.patch_parts[0, 0] == 0 else -1.0
    assert sense * contacts.normals[0] == pytest.approx(assembly.down, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("shape", [Cylinder(1.0, 3.0), cone_frustum(ALPHA), bolt()])
def test_tilted_end_carries_what_stands_above_its_lowest_point_alone(shape):
    # a body balances on a rim where its centre of mass is straight above the point it touches in
    down = np.array([0.3, -0.4, -1.0])
    down /= np.linalg.norm(down)
    touched = check(on_table(shape, down, 0)).contact_set
    pose = touched.assembly.parts[0].pose
    foot = pose.matrix.T @ (touched.points[0] - pose.position)
    for aside, word in ((0.0, "stable"), (1e-3, "unstable")):
        centre = foot - 0.5 * down + aside * np.array([0.8, 0.6, 0])
        verdict = check(on_table(shape, down, 0, mass=1.0, center_of_mass=centre))
        assert verdict.first_order == word


@pytest.mark.slow
def test_rim_above_the_table_by_more_than_the_tolerance_is_no_contact():
    for height, count in ((0.9e-5, 1), (1.1e-5, 0)):
        assembly = on_table(Cylinder(1.0, 3.0), [0.3, -0.4, -1.0], 1)
        size = float(assembly.geometry.size[0])
        low = float(lowest_heights(assembly.geometry, -assembly.down)[0])
        body = Assembly(assembly.parts[:1], gravity=assembly.gravity)
        contacts = detect.contacts(body.with_floor(low - height * size))
        assert len(contacts) == count
        assert contacts.unsupported == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    "foot", [Cylinder(1.0, 2.0), mesh_of(peg(1.0, -1, 1)), cone_frustum(ALPHA)]
)
@pytest.mark.parametrize(("reach", "word"), [(1.0, "stable"), (4.0, "unstable")])
def test_joining_all_to_all_never_holds_a_round_foot_to_the_table(foot, reach, word):
    # a bar on the foot whose weight is beyond it tips both over, however they are joined
    turn = (0, 1, 0, 0)
    top = float(np.max(-Assembly([Part("foot", foot)]).geometry.vertices[:, 2]))
    bar = Part("bar", Box([2 * reach, 0.2, 0.2]), Pose([0.7 * reach, 0, top + 0.1]), mass=1.0)
    parts = [Part("foot", foot, Pose([0, 0, 0], turn), mass=0.1), bar]
    joined = fastened(Assembly(parts).with_floor(), [("*", "*")])
    assert [joint.parts for joint in joined.joints] == [("foot", "bar")]
    assert check(joined).verdict == word
