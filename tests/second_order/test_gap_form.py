"""The second derivative of gaps against differences of exact gaps, with both parts moving."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import exact_gaps as exact
import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, GivenContact, Part, Pose
from kilter.arrays import Array, across
from kilter.mechanics.program import Program, build_program
from kilter.second_order.gaps.features import EDGE, FACE, OPEN, VERTEX, Features
from kilter.second_order.gaps.gap_form import corner_slips, formed, gap_forms

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
def test_a_gap_is_its_series_to_second_order(
    case: tuple[str, Array, Array, Side, Side, exact.Gap],
) -> None:
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


def test_what_has_no_form_has_no_number() -> None:
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


def test_a_point_within_a_line_stays_where_it_is_along_it() -> None:
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


def test_a_corner_that_has_slipped_off_an_edge_of_both_parts_has_the_other_form() -> None:
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
