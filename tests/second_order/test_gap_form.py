"""Second derivatives of gaps: of each pair of features, given ones, springs and revolved ones."""

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import exact_gaps as exact
import numpy as np
import pytest
from transformations import scaled

import kilter
from kilter import Assembly, Box, Feature, GivenContact, InputError, Joint, Part, Pose
from kilter.arrays import Array, across
from kilter.files import from_dict
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.rows import DRAG, STOP
from kilter.scenes.pieces import moved, turn
from kilter.second_order.gaps.features import EDGE, FACE, OPEN, VERTEX, Features
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.fits import _revolved_surface
from kilter.second_order.gaps.gap_form import corner_slips, formed, gap_forms
from kilter.second_order.gaps.joint_forms import (
    joint_errors,
    joint_forms,
    of_joints,
    spring_excess,
    spring_form,
)
from kilter.second_order.gaps.touched_surfaces import LINE

Side = tuple[int, Array, Array]
"""Kind, edge and curvature of the feature of a part."""
NONE, FLAT = np.zeros(3), np.zeros((3, 3))
VERTEX_SIDE: Side = (VERTEX, NONE, FLAT)


def program_of(point: Array, normal: Array, center_a: Array, center_b: Array) -> Program:
    """A program of two free parts and a contact."""
    parts = [Part(name, Box([1, 1, 1]), Pose([4 * k, 0, 0])) for k, name in enumerate("ab")]
    given = GivenContact(("a", "b"), [point], normal)
    assembly = Assembly(parts, contacts=[given], detect=False)
    program = build_program(assembly, kilter.contacts(assembly))
    return replace(program, center=np.array([center_a, center_b]))


def features(
    a: Side, b: Side, fibre: Array = NONE, *, conformal: bool = False, flush: bool = False
) -> Features:
    kinds = [np.array([side[0]]) for side in (a, b)]
    return Features(
        *kinds, a[1][None], b[1][None], a[2][None], b[2][None], fibre[None],
        np.array([conformal]), np.zeros((1, 6)), np.zeros((1, 6)), np.zeros(1, dtype=np.int64),
        np.zeros(1), np.zeros(1), np.array([flush]),
    )  # fmt: skip


def face(curvature: Array = FLAT) -> Side:
    return FACE, NONE, curvature


def round_face(n: Array, t: Array, along: float, across_: float) -> Side:
    """Principal curvatures along t and across it."""
    u = np.cross(n, t)
    return face(along * np.outer(t, t) + across_ * np.outer(u, u))


def edge(e: Array, k: float = 0.0) -> Side:
    return EDGE, e, k * np.outer(e, e)


def quadric(x: Array, n: Array, curvature: Array, cubic: Array) -> exact.Surface:
    """Z + s . K s / 2 + a cubic, curved as K at x, and with third derivatives of every kind."""
    frame = np.stack(across(n))

    def surface(p: Array) -> tuple[float, Array]:
        s, z = frame @ (p - x), float(n @ (p - x))
        bent = np.array([s[0] ** 3, s[0] ** 2 * s[1], s[0] * s[1] ** 2, s[1] ** 3])
        value = z + s @ curvature @ s / 2 + cubic @ bent + 0.3 * z * z + 0.2 * z * s[0] * s[1]
        slope = curvature @ s + 0.2 * z * s[::-1]
        slope += cubic[0] * np.array([3 * s[0] ** 2, 0])
        slope += cubic[1] * np.array([2 * s[0] * s[1], s[0] ** 2])
        slope += cubic[2] * np.array([s[1] ** 2, 2 * s[0] * s[1]])
        slope += cubic[3] * np.array([0, 3 * s[1] ** 2])
        return float(value), frame.T @ slope + (1 + 0.6 * z + 0.2 * s[0] * s[1]) * n

    return surface


def kinds() -> Iterator[tuple[str, Array, Array, Side, Side, exact.Gap]]:
    """(name, x, n, feature of a, feature of b, exact gap)."""
    rng = np.random.default_rng(1)
    n, x = exact.unit(rng.normal(size=3)), rng.normal(size=3)
    t, u = across(n)
    ea, eb = t, exact.unit(0.4 * t + u)
    r, big = 0.7, 1.3
    ball, cylinder = round_face(n, t, 1 / r, 1 / r), round_face(n, ea, 0, 1 / big)
    above, below = x + r * n, x - big * n
    yield "vertex on face", x, n, face(), VERTEX_SIDE, exact.vertex_plane(x, x, n)
    yield "face on vertex", x, n, VERTEX_SIDE, face(), exact.swapped(exact.vertex_plane(x, x, -n))
    yield "edge on edge", x, n, edge(ea), edge(eb), exact.lines(x, ea, x, eb, n)
    yield "sphere on plane", x, n, face(), ball, exact.sphere_plane(above, r, x, n)
    yield (
        "spheres",
        x,
        n,
        round_face(n, t, 1 / big, 1 / big),
        ball,
        exact.spheres(below, big, above, r),
    )
    yield (
        "sphere in sphere",
        x,
        n,
        round_face(n, t, -1 / big, -1 / big),
        ball,
        exact.spheres(x + big * n, -big, above, r),
    )
    yield (
        "sphere on cylinder",
        x,
        n,
        cylinder,
        ball,
        exact.sphere_cylinder(above, r, below, ea, big),
    )
    yield (
        "sphere in cylinder",
        x,
        n,
        round_face(n, ea, 0, -1 / big),
        ball,
        exact.sphere_cylinder(above, r, x + big * n, ea, -big),
    )
    half, length = 0.5, 1.7
    k = 1 / (length * np.tan(half))
    apex = x - length * t
    axis = exact.unit(np.cos(half) * t - np.sin(half) * n)
    cone = round_face(n, t, 0, k)
    yield "sphere on cone", x, n, cone, ball, exact.sphere_cone(above, r, apex, axis, half)
    inner = exact.unit(np.cos(half) * t + np.sin(half) * n)
    yield (
        "sphere in cone",
        x,
        n,
        round_face(n, t, 0, -k),
        ball,
        exact.sphere_cone(above, r, apex, inner, half, inside=True),
    )
    tube, ring, angle = 0.4, 1.5, 0.8
    away = exact.unit(np.cos(angle) * n + np.sin(angle) * t)
    around = exact.unit(np.sin(angle) * n - np.cos(angle) * t)
    rho = ring + tube * np.cos(angle)
    meridian = exact.unit(np.cross(n, np.cross(around, away)))
    center = x - rho * away - tube * np.sin(angle) * around
    torus = round_face(n, meridian, 1 / tube, np.cos(angle) / rho)
    yield (
        "sphere on torus",
        x,
        n,
        torus,
        ball,
        exact.sphere_torus(above, r, center, around, ring, tube),
    )
    other = round_face(n, eb, 0, 1 / r)
    yield "crossed cylinders", x, n, cylinder, other, exact.lines(below, ea, above, eb, n, big + r)
    round_a = round_face(n, t, 1 / big, 1 / big)
    yield "edge on sphere", x, n, round_a, edge(eb), exact.line_sphere(x, eb, below, big)
    yield "edge on cylinder", x, n, cylinder, edge(eb), exact.lines(below, ea, x, eb, n, big)
    yield (
        "vertex on cylinder",
        x,
        n,
        cylinder,
        VERTEX_SIDE,
        exact.sphere_cylinder(x, 0, below, ea, big),
    )
    yield "vertex on cone", x, n, cone, VERTEX_SIDE, exact.sphere_cone(x, 0, apex, axis, half)
    rim = edge(np.cross(ea, n), 1 / r)
    yield "rim on plane", x, n, face(), rim, exact.rim_plane(above, ea, r, x, n)
    lean = exact.unit(np.cos(0.6) * n + np.sin(0.6) * t)
    tilted = edge(u, np.cos(0.6) / r)
    yield (
        "tilted rim on plane",
        x,
        n,
        face(),
        tilted,
        exact.rim_plane(x + r * lean, exact.unit(np.cross(u, lean)), r, x, n),
    )
    axes = np.array([1.2, 0.8, 0.5])
    reach = float(np.linalg.norm(axes * n))
    middle = x + axes**2 * n / reach
    off = np.eye(3) - np.outer(n, n)
    slope = float(np.linalg.norm((x - middle) / axes**2))
    bent = off @ np.diag(1 / axes**2) @ off / slope
    yield "ellipsoid on plane", x, n, face(), face(bent), exact.ellipsoid_plane(middle, axes, x, n)
    pair = []
    for normal, curvature in ((n, [[0.9, 0.3], [0.3, -0.2]]), (-n, [[0.5, -0.4], [-0.4, 1.1]])):
        frame = np.stack(across(normal))
        surface = quadric(x, normal, np.array(curvature), 0.3 * rng.normal(size=4))
        pair.append((face(frame.T @ np.array(curvature) @ frame), surface))
    (on_a, fa), (on_b, fb) = pair
    yield "saddle on a free form", x, n, on_a, on_b, exact.implicit(fa, fb, x)


CASES = list(kinds())


@pytest.mark.quick(4)
@pytest.mark.parametrize("case", CASES, ids=[case[0] for case in CASES])
def test_a_gap_is_its_series_to_second_order(case):
    """Richardson's differences: the first to 4e-7, the second to 3e-8, both parts moving."""
    _, x, n, on_a, on_b, gap = case
    rng = np.random.default_rng(2)
    ca, cb = rng.normal(size=(2, 3))
    program = program_of(x, n, ca, cb)
    form = gap_forms(program, features(on_a, on_b))[0]
    row = np.array([0])
    slope = np.hstack([-program.lever(row, np.array([0])), program.lever(row, np.array([1]))])[0]
    assert abs(gap(exact.pose(ca, np.zeros(6)), exact.pose(cb, np.zeros(6)))) < 1e-12
    np.testing.assert_array_equal(form, form.T)
    for _ in range(12):
        z = exact.unit(rng.normal(size=12))

        def f(t: float, z: Array = z) -> float:
            return gap(exact.pose(ca, t * z[:6]), exact.pose(cb, t * z[6:]))

        def first(h: float) -> float:
            return (f(h) - f(-h)) / (2 * h)

        def second(h: float) -> float:
            return (f(h) + f(-h) - 2 * f(0.0)) / h**2

        h = 4e-3
        assert abs((4 * first(h / 2) - first(h)) / 3 - slope @ z) < 4e-7
        curved = (64 * second(h / 4) - 20 * second(h / 2) + second(h)) / 45
        assert abs(curved - z @ form @ z) < 3e-8


def test_what_has_no_form_has_no_number():
    """Open features, vertex on vertex, edge along edge, and plane on plane have no form."""
    x, n = np.zeros(3), np.array([0.0, 0, 1])
    t = np.array([1.0, 0, 0])
    program = program_of(x, n, -n, n)
    ball = round_face(n, t, 2.0, 2.0)
    open_side: Side = (OPEN, NONE, FLAT)
    without = [
        (open_side, ball), (ball, open_side), (VERTEX_SIDE, VERTEX_SIDE), (edge(t), edge(t)),
        (edge(t), VERTEX_SIDE), (face(), face()), (round_face(n, t, 0, 1), round_face(n, t, 0, 1)),
        (round_face(n, t, -2, -2), ball), (round_face(n, t, -3, 0), ball),
        (face(), round_face(n, t, 1e-9, 1e-9)), (face(), edge(t, 1e-17)),
    ]  # fmt: skip
    for a, b in without:
        assert not formed(program, features(a, b)).any()
        assert np.isnan(gap_forms(program, features(a, b))).all()
    assert formed(program, features(face(), face(), conformal=True)).all()
    assert formed(program, features(round_face(n, t, -1.9, -1.9), ball)).all()


def test_a_point_within_a_line_stays_where_it_is_along_it():
    """Yaw of a cylinder on a parallel cylinder: (psi s)^2 / (R + r), s along the line."""
    n, t = np.array([0.0, 0, 1]), np.array([1.0, 0, 0])
    big, r, s = 1.3, 0.7, 0.4
    program = program_of(s * t, n, -big * n, r * n)
    a, b = round_face(n, t, 0, 1 / big), round_face(n, t, 0, 1 / r)
    form = gap_forms(program, features(a, b, fibre=t))[0]
    assert form[11, 11] == pytest.approx(s**2 / (big + r), rel=1e-12)
    trough = round_face(n, t, 0, -1 / big)
    form = gap_forms(program, features(trough, b, fibre=t))[0]
    assert form[11, 11] == pytest.approx(-(s**2) / (big - r), rel=1e-12)


def test_a_corner_that_has_slipped_off_an_edge_of_both_parts_has_the_other_form():
    """A corner of b on the face of a, and one of a on the face of b: -2 sigma . v_t apart."""
    random = np.random.default_rng(5)
    n, x, c_a, c_b = exact.unit(random.normal(size=3)), *random.normal(size=(3, 3))
    program = program_of(x, n, c_a, c_b)
    flush = features(face(), face(), conformal=True, flush=True)
    stays = gap_forms(program, flush)[0]
    np.testing.assert_allclose(stays, gap_forms(program, features(face(), VERTEX_SIDE))[0])
    slipped = gap_forms(program, features(VERTEX_SIDE, face()))[0]
    turn, slip = np.split(corner_slips(program, flush)[0], 2)
    np.testing.assert_allclose(slipped - stays, -turn.T @ slip - slip.T @ turn, atol=1e-12)
    assert not corner_slips(program, features(face(), VERTEX_SIDE)).any()
    line = across(n)[0]
    ends = features(face(), round_face(n, line, 0, 1.0), fibre=line, flush=True)
    along = corner_slips(program, ends)[0]
    turn, slip = np.split(along, 2)
    assert np.linalg.matrix_rank(turn) == np.linalg.matrix_rank(slip) == 1
    shift = np.concatenate([np.zeros(6), across(n)[1], np.zeros(3)])
    np.testing.assert_allclose(along @ shift, 0.0, atol=1e-12)


UP = [0.0, 0, 1]
CYLINDER = Feature("face", [0, 3, 0], (0, 0.5))


def assembly(*features: tuple[Feature, Feature] | None) -> Assembly:
    """A part on a held part, with a contact for each pair of features."""
    base = Part("base", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    part = Part("part", Box([1, 1, 2]), Pose([0.1, 0.2, 1]))
    given = [
        GivenContact(("base", "part"), [[0.1 * k, 0, 0], [0, 0.3, 0]], UP, feature=feature)
        for k, feature in enumerate(features)
    ]
    return Assembly([base, part], contacts=given, detect=False)


def found(given: Assembly) -> tuple[Features, Array]:
    contacts = kilter.contacts(given)
    program = build_program(given, contacts)
    features = features_of(program, contacts)
    forms = gap_forms(program, features)
    np.testing.assert_array_equal(np.isnan(forms).any(axis=(1, 2)), ~formed(program, features))
    return features, forms


def test_a_feature_is_read_to_its_rows():
    features, _ = found(
        assembly(
            (CYLINDER, Feature("edge", [1, 0, 0], 2)), None, (Feature("vertex"), Feature("face"))
        )
    )
    assert features.kind_a.tolist() == [FACE, FACE, OPEN, OPEN, VERTEX, VERTEX]
    assert features.kind_b.tolist() == [EDGE, EDGE, OPEN, OPEN, FACE, FACE]
    assert features.group.tolist() == [0, 0, 1, 1, 2, 2]
    np.testing.assert_allclose(features.curvature_a[0], np.diag([0.5, 0, 0]))
    np.testing.assert_allclose(features.curvature_b[0], np.diag([2.0, 0, 0]))
    np.testing.assert_allclose(features.edge_b[0], [1, 0, 0])
    assert features.open.tolist() == [False, False, True, True, False, False]


def test_a_sphere_needs_no_direction():
    features, _ = found(assembly((Feature("face"), Feature("face", curvature=2))))
    np.testing.assert_allclose(features.curvature_b[0], np.diag([2.0, 2, 0]))


def around(axis: Array, radius: float, up: float, tube: float = np.inf) -> Feature:
    """A torus above the origin, with the lowest circle of its tube at the origin."""
    other = np.cross(UP, axis)
    curvature = (1 / radius, 1 / tube if np.isfinite(tube) else 0.0)
    return Feature("face", other, curvature, [0, 0, up], axis)


def test_an_axis_turns_moves_and_scales_with_its_part():
    given = assembly((Feature("face"), around(np.array([0.0, 1, 0]), 2.0, 2.0, tube=0.3)))
    at = replace(given, contacts=[replace(given.contacts[0], points=[[0.0, 0, 0], [0, 0.5, 0]])])
    pose = Pose([3, -4, 5], turn([1, 2, 3], 50))
    for other, factor in ((moved(at, pose.rotation, pose.position), 1.0), (scaled(at, 7.0), 7.0)):
        features, _ = found(other)
        line, points = features.axis_b, other.contacts[0].points
        away = np.linalg.norm(np.cross(points - line[:, :3], line[:, 3:]), axis=1)
        np.testing.assert_allclose(away, 2.0 * factor)
        assert not features.axis_a.any()


@pytest.mark.parametrize("off", [0.0, 1e-3])
def test_a_surface_is_of_revolution_about_its_axis_or_refused(off):
    y = np.array([0.0, 1, 0])
    lean = np.array([0.3, 0, np.sqrt(1 - 0.09)])  # a rim whose plane leans from the normal
    rim = 2.0 * np.array([0.0, 0, 1])
    tries = [
        lambda e: around(y, 2.0, 2.0 + e, tube=0.3),  # radius
        lambda e: Feature("face", [1, 0, 0], (0.5, 3), rim, [e, 1, 0]),  # direction
        lambda e: Feature("face", curvature=2, point=[e, 0, 1], axis=UP),  # a pole
        lambda e: Feature("face", curvature=2, point=[0, 0, 1], axis=[e, 0, 1]),
        lambda e: Feature("face", [1, 0, 0], (2, 2 + e), point=[0, 0, 1], axis=UP),
        lambda e: Feature("face", point=[5, 6, 0], axis=[e, 0, 1]),  # a plane, upright
        lambda e: Feature("edge", y, lean[2] / 2 + e, 2 * lean, np.cross(lean, y)),
        lambda e: Feature("edge", [e, 1, 0], 0.5, rim, [1, 0, 0]),
    ]
    for make in tries:
        one = make(off)
        if off:
            with pytest.raises(InputError, match="not a surface of revolution about its axis"):
                at_origin(one)
        else:
            at_origin(one)


def at_origin(feature: Feature) -> GivenContact:
    return GivenContact(("base", "part"), [[0, 0, 0]], UP, feature=(Feature("face"), feature))


def test_contacts_of_other_lists_are_open():
    given = assembly((Feature("face"), Feature("vertex")))
    contacts = kilter.contacts(given)
    program = build_program(given, contacts)
    without = replace(contacts, assembly=replace(given, contacts=()))
    assert features_of(program, without).open.all()


@pytest.mark.parametrize(
    ("build", "words"),
    [
        (lambda: Feature("fase"), "did you mean 'face'"),  # type: ignore[arg-type]
        (lambda: Feature("edge"), 'give "along"'),
        (lambda: Feature("face", curvature=(1, 2)), 'give "along"'),
        (lambda: Feature("edge", [1, 0, 0], (1, 2)), "give only that along the edge"),
        (lambda: Feature("vertex", curvature=1), "remove it"),
        (lambda: Feature("face", curvature=np.nan), "finite"),
        (lambda: Feature("face", axis=UP), 'give both "point" and "axis"'),
        (lambda: Feature("vertex", point=UP, axis=UP), "remove it"),
        (lambda: Feature("face", point=UP, axis=[0, 0, 0]), "axis of a face"),
        (lambda: assembly((Feature("face"), Feature("edge", UP))), "not perpendicular to"),
        (lambda: assembly((Feature("face"),)), "pair of kilter.Feature"),  # type: ignore[arg-type]
        (lambda: assembly(("face", "face")), "pair of kilter.Feature"),  # type: ignore[arg-type]
    ],
)
def test_what_is_no_feature_is_refused(build, words):
    with pytest.raises(InputError, match=words) as caught:
        build()  # type: ignore[operator]
    assert "\n" not in str(caught.value)


def test_shown_in_one_line():
    given = assembly((CYLINDER, Feature("edge", [1, 0, 0], 2))).contacts[0]
    assert repr(given).endswith("face on edge)")
    assert repr(CYLINDER) == "Feature('face', along=(0, 1, 0), curvature=(0, 0.5))"


@pytest.mark.slow
def test_the_contact_of_the_page_is_a_ball_in_a_bowl():
    page = (Path(__file__).parents[2] / "docs" / "explanation/contacts.md").read_text(
        encoding="utf-8"
    )
    [text] = re.findall(r"```json\n(.*?)```", page, flags=re.S)
    contact = json.loads(text)
    parts = [
        {"name": "bowl", "box": [1, 1, 1], "pose": {"position": [0, 0, -1]}, "grounded": True},
        {"name": "ball", "sphere": {"radius": 0.8}, "pose": {"position": [0, 0, 0.8]}},
    ]
    for hollow, state in ((-0.5, "minimum"), (0.5, "balanced"), (-2.0, "open")):
        contact["feature"][0]["curvature"] = hollow
        whole = {"kilter": 1, "parts": parts, "contacts": [contact], "detect": False}
        second = kilter.check(from_dict(whole, folder=".", source="page")).second_order_answer
        assert second is not None
        assert second.state == state
        if state != "open":  # the ball may spin
            assert second.free == 3


STEP = 1e-4


def linked(seed: int, kind: str) -> tuple[Assembly, Program]:
    """Two free parts in random poses with a joint that has stops, friction and a spring."""
    rng = np.random.default_rng(seed)
    parts = [
        Part(name, Box(rng.uniform(0.5, 2, 3)), Pose(rng.normal(size=3), rng.normal(size=4)))
        for name in ("a", "b")
    ]
    joint = Joint(
        ("a", "b"), kind, rng.normal(size=3), rng.normal(size=3), limits=(0.0, 0.0), friction=2.0,
        stiffness=float(rng.uniform(1, 5)), rest=float(rng.normal()),
    )  # type: ignore[arg-type]  # fmt: skip
    assembly = Assembly(
        parts, joints=[joint], contacts=[kilter.GivenContact(("a", "b"), [], [1, 0, 0])]
    )
    return assembly, build_program(assembly, kilter.contacts(assembly))


def second_difference(value: object, along: Array) -> Array:
    """Second derivative of a function of motions, (2, 6), along one of them."""
    assert callable(value)
    sides = value(STEP * along), value(0 * along), value(-STEP * along)
    return np.asarray((sides[0] - 2 * sides[1] + sides[2]) / STEP**2)


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
@pytest.mark.parametrize("seed", range(4))
def test_forms_are_the_second_derivatives_of_exact_gaps_and_energies(seed, kind):
    assembly, program = linked(seed, kind)
    joints = assembly.joints
    assert [int((program.kind == of).sum()) for of in (STOP, DRAG)] == [2, 1]
    forms, energy = joint_forms(program, joints), spring_form(program, joints)
    assert energy is not None
    rng = np.random.default_rng(seed + 100)
    for _ in range(3):
        motion = rng.normal(size=(2, 6))
        motion /= np.abs(motion).max()
        flat = motion.reshape(-1)
        gaps = second_difference(lambda z: joint_errors(program, joints, z), motion)
        assert of_joints(program).all()
        assert gaps == pytest.approx(np.einsum("i,kij,j->k", flat, forms, flat), abs=1e-5)
        cost = second_difference(lambda z: np.array(spring_excess(program, joints, z)), motion)
        assert cost == pytest.approx(flat @ energy @ flat, rel=1e-5, abs=1e-5)


def test_a_spring_is_a_load_in_the_drawn_pose():
    """The first derivative of its energy k (g + rest)^2 / 2, g the motion of b past a."""
    for kind in ("revolute", "prismatic"):
        assembly, program = linked(1, kind)
        joint, row = assembly.joints[0], int(np.flatnonzero(program.kind == DRAG)[0])
        motion = np.random.default_rng(3).normal(size=(2, 6))
        speed = -float(program.velocities(motion)[row])  # the row is along minus the axis
        power = float((program.clamp * motion).sum())
        assert power == pytest.approx(-joint.stiffness * joint.rest * speed)


def rings(rng: np.random.Generator, tilts: list[float], pitch: float = 0.0) -> tuple[Array, Array]:
    """Points and normals on rings about z, whose normals lean from the horizontal by `tilts`."""
    points, normals = [], []
    for k, tilt in enumerate(tilts):
        for angle in rng.uniform(0, 2 * np.pi, 3) + np.array([0, 2, 4]):
            away = np.array([np.cos(angle), np.sin(angle), 0.0])
            around = np.array([-np.sin(angle), np.cos(angle), 0.0])
            normal = np.cos(tilt) * away + np.sin(tilt) * np.array([0, 0, 1.0]) + pitch * around
            points.append((2.0 + 0.1 * k) * away + [0, 0, 0.5 * k])
            normals.append(normal / np.linalg.norm(normal))
    return np.array(points), np.array(normals)


@pytest.mark.parametrize("seed", range(4))
def test_the_axis_and_the_curvature_of_a_thread_of_rings(seed):
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    shift = rng.normal(size=3)
    tilts = [0.5, -0.5, 0.5]
    points, normals = rings(rng, tilts)
    found = _revolved_surface(points @ turn.T + shift, normals @ turn.T)
    assert found is not None
    kind, place, axis, curvature = found
    assert kind == LINE
    assert abs(axis @ turn[:, 2]) == pytest.approx(1.0, abs=1e-9)
    aside = (place - shift) - ((place - shift) @ axis) * axis
    assert np.abs(aside).max() < 1e-8
    # Meusnier: the circle of radius r bends by 1 / r, its normal curvature is cos(tilt) / r
    radius = np.repeat([2.0, 2.1, 2.2], 3)
    around = np.cross(axis, points @ turn.T + shift - place)
    around /= np.linalg.norm(around, axis=1)[:, None]
    bent = np.einsum("ki,kij,kj->k", around, curvature, around)
    assert bent == pytest.approx(np.cos(0.5) / radius, rel=1e-9)


@pytest.mark.parametrize(
    ("tilts", "pitch"),
    [
        pytest.param([0.0, 0.0], 0.0, id="cylinder: it slides, too"),
        pytest.param([0.5, -0.5, 0.5], 0.1, id="normals past the axis: nothing moves, or a screw"),
    ],
)
def test_other_surfaces_are_none(tilts, pitch):
    points, normals = rings(np.random.default_rng(0), tilts, pitch)
    assert _revolved_surface(points, normals) is None
