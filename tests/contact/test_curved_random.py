"""Curved contacts in any pose, at any scale, with and without a gap: none lost, none invented."""

import importlib.util
import json
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation
from solids import (
    ball,
    bore,
    cone_frustum,
    cone_socket,
    mesh_of,
    peg,
    revolved,
    socket,
    torus,
    trough,
    with_scale,
)

from kilter import Assembly, Box, Part, Pose, Tolerance, load
from kilter.contact import detect
from kilter.shape.primitives import Mesh
from kilter.shape.solid import Solid

ALPHA = 0.4
LYING = [np.sqrt(0.5), np.sqrt(0.5), 0, 0]
SLAB = Box([8, 8, 1])
DOWN = np.array([0, 0, -0.5])

# name: base shape and its place, part and its place, direction that opens a gap (None: no
# single one), kind, number of patches, rate at which the gap opens
ORIGIN = 0 * DOWN
UP = [0, 0, 1]
STILL = (1, 0, 0, 0)
CONE = cone_socket(ALPHA)
CASES = {
    "ball on slab": (SLAB, DOWN,
        ball(), [0, 0, 1], STILL, UP, "sphere", 1.0),
    "bar on slab": (SLAB, DOWN,
        peg(), [0, 0, 1], LYING, UP, "cylinder", 1.0),
    "ring on slab": (SLAB, DOWN,
        torus(), [0, 0, 0.5], STILL, UP, "torus", 1.0),
    "ring upright": (SLAB, DOWN,
        torus(), [0, 0, 2.5], LYING, UP, "torus", 1.0),
    "ball on ball": (ball(), ORIGIN,
        ball(0.5), [0.9, 0, 1.2], STILL, [0.6, 0, 0.8], "sphere", 1.0),
    "ball on bar": (peg(), ORIGIN,
        ball(0.5), [1.5, 0, 0.3], STILL, [1, 0, 0], "sphere", 1.0),
    "crossed bars": (peg(), ORIGIN,
        peg(0.5), [1.5, 0, 0.3], LYING, [1, 0, 0], "cylinder", 1.0),
    "bars": (peg(), ORIGIN,
        peg(0.5), [1.5, 0, 0.3], STILL, [1, 0, 0], "cylinder", 1.0),
    "ball in cone": (CONE, ORIGIN,
        ball(0.6), [0, 0, 0.6 / np.sin(ALPHA)], STILL, UP, "sphere", np.sin(ALPHA)),
    "cone in cone": (CONE, ORIGIN,
        cone_frustum(ALPHA, sides=37), [0, 0, 0], STILL, UP, "cone", np.sin(ALPHA)),
    "bar in groove": (trough(half=0.7), ORIGIN,
        peg(), [0, 0, 0], LYING, None, "cylinder", 1.0),
    "ball in groove": (trough(), ORIGIN,
        ball(0.5), [0, 0.2, -0.5], STILL, UP, "sphere", 1.0),
    "ball in socket": (socket(rim=-0.3), ORIGIN,
        ball(), [0, 0, 0], (0.9, 0.1, 0.3, 0.2), None, "sphere", 1.0),
    "peg in hole": (bore(sides=23), ORIGIN,
        peg(sides=30), [0, 0, 0], STILL, None, "cylinder", 1.0),
    "ball in bowl": (socket(rim=-0.2), ORIGIN,
        ball(0.5), [0, 0, -0.5], STILL, UP, "sphere", 1.0),
}  # fmt: skip


def posed(case, rng, scale, gap, *, mesh=False):
    base, at, part, place, quaternion, opening, _, _ = CASES[case]
    turn = Rotation.random(rng=rng)
    shift = rng.normal(size=3) * 3 * scale
    place = np.array(place) + (gap * np.array(opening) if opening is not None else 0)
    parts = []
    for name, shape, x, q in (("base", base, at, (1, 0, 0, 0)), ("part", part, place, quaternion)):
        shape = scaled(shape, scale)
        if mesh and isinstance(shape, Solid):
            shape = mesh_of(shape)
        q = np.array(q) / np.linalg.norm(q)
        whole = turn * Rotation.from_quat(q[[1, 2, 3, 0]])
        pose = Pose(turn.apply(np.array(x) * scale) + shift, whole.as_quat()[[3, 0, 1, 2]])
        parts.append(Part(name, shape, pose, grounded=name == "base"))
    order = parts if rng.integers(2) else parts[::-1]
    return Assembly(order), turn, shift


def scaled(shape, scale):
    return Box(shape.size * scale) if isinstance(shape, Box) else with_scale(shape, scale)


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("seed", range(3))
def test_contact_is_found_in_any_pose_and_scale(case, seed):
    rng = np.random.default_rng([seed, len(case)])
    scale = 10.0 ** rng.uniform(-3, 3)
    gap = rng.choice([0.0, 1e-8, 1e-6, -1e-6])
    assembly, turn, shift = posed(case, rng, scale, gap)
    contacts = detect.contacts(assembly)
    _, _, _, _, _, opening, kind, rate = CASES[case]
    assert contacts.patch_kind.tolist() == [kind]
    assert contacts.unsupported == ()
    assert contacts.overlaps == ()
    expected = gap * rate * scale if opening is not None else 0.0
    assert contacts.patch_gap.mean() == pytest.approx(expected, abs=1e-11 * scale)
    still = detect.contacts(posed(case, np.random.default_rng(5), 1.0, 0.0)[0])
    assert contacts.patch_area * scale**-2 == pytest.approx(still.patch_area, rel=1e-6)
    # points, taken back, lie on both surfaces
    back = turn.inv().apply(contacts.points - shift) / scale
    assert np.abs(IMPLICIT[case](back)).max() < 2e-6
    sign = 1.0 if assembly.names[contacts.patch_parts[0, 0]] == "base" else -1.0
    normals = sign * turn.inv().apply(contacts.normals.copy())
    step = 1e-3
    slope = IMPLICIT[case](back + step * normals) - IMPLICIT[case](back - step * normals)
    assert slope / (2 * step) == pytest.approx(np.ones(len(back)), abs=1e-5)


# distance out of the base's material, positive outside, written apart from the package
IMPLICIT = {
    "ball on slab": lambda x: x[:, 2],
    "bar on slab": lambda x: x[:, 2],
    "ring on slab": lambda x: x[:, 2],
    "ring upright": lambda x: x[:, 2],
    "ball on ball": lambda x: np.linalg.norm(x, axis=1) - 1,
    "ball on bar": lambda x: np.hypot(x[:, 0], x[:, 1]) - 1,
    "crossed bars": lambda x: np.hypot(x[:, 0], x[:, 1]) - 1,
    "bars": lambda x: np.hypot(x[:, 0], x[:, 1]) - 1,
    "ball in cone": lambda x: x[:, 2] * np.sin(ALPHA) - np.hypot(x[:, 0], x[:, 1]) * np.cos(ALPHA),
    "cone in cone": lambda x: x[:, 2] * np.sin(ALPHA) - np.hypot(x[:, 0], x[:, 1]) * np.cos(ALPHA),
    "bar in groove": lambda x: 1 - np.hypot(x[:, 0], x[:, 2]),
    "ball in groove": lambda x: 1 - np.hypot(x[:, 0], x[:, 2]),
    "ball in socket": lambda x: 1 - np.linalg.norm(x, axis=1),
    "peg in hole": lambda x: 1 - np.hypot(x[:, 0], x[:, 1]),
    "ball in bowl": lambda x: 1 - np.linalg.norm(x, axis=1),
}


OPENING = [name for name, case in CASES.items() if case[5] is not None]


@pytest.mark.slow
@pytest.mark.parametrize("case", OPENING)
@pytest.mark.parametrize("seed", range(2))
def test_gap_beyond_the_tolerance_is_no_contact(case, seed):
    rng = np.random.default_rng([seed, 7])
    scale = 10.0 ** rng.uniform(-3, 3)
    rate = CASES[case][7]
    tolerance = Tolerance(gap=1e-4 * scale)
    for share, count in ((0.9, 1), (1.1, 0), (30.0, 0)):
        assembly, _, _ = posed(case, np.random.default_rng(seed), scale, share * 1e-4 / rate)
        contacts = detect.contacts(assembly, tolerance=tolerance)
        assert len(contacts) == count
        assert contacts.overlaps == ()
        if not count:
            assert contacts.unsupported == ()
            gaps = [r.gap for r in contacts.rejected]
            assert min(gaps) == pytest.approx(share * 1e-4 * scale, rel=1e-2)


@pytest.mark.quick(1)
@pytest.mark.parametrize("case", [c for c in CASES if "ring" not in c])
def test_meshes_of_the_faces_give_the_same_contacts(case):
    exact = detect.contacts(posed(case, np.random.default_rng(3), 1.0, 0.0)[0])
    assembly, _, _ = posed(case, np.random.default_rng(3), 1.0, 0.0, mesh=True)
    contacts = detect.contacts(assembly)
    assert contacts.patch_kind.tolist() == exact.patch_kind.tolist()
    assert contacts.unsupported == ()
    assert contacts.overlaps == ()
    assert contacts.patch_area == pytest.approx(exact.patch_area, rel=1e-6, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("case", OPENING)
def test_gap_agrees_with_dense_samples(case):
    _, _, part, place, quaternion, opening, _, _ = CASES[case]
    gap = 3e-6
    place = np.array(place) + gap * np.array(opening)
    q = np.array(quaternion) / np.linalg.norm(quaternion)
    fine = refined(part)
    points = Rotation.from_quat(q[[1, 2, 3, 0]]).apply(fine) + place
    least = IMPLICIT[case](points).min()
    assembly, _, _ = posed(case, np.random.default_rng(2), 1.0, gap)
    found = float(detect.contacts(assembly, tolerance=Tolerance(gap=1e-4)).patch_gap.mean())
    # samples lie up to the sagitta of their spacing away from the nearest point
    assert found <= least + 1e-12
    assert found == pytest.approx(least, abs=2e-3)


def refined(part):
    """Corners of a part, and points of its triangles lifted to its surfaces."""
    corners = part.vertices[part.triangles]
    weights = np.random.default_rng(0).dirichlet([1, 1, 1], size=300)
    inner = np.einsum("wk,tki->wti", weights, corners).reshape(-1, 3)
    label = np.tile(part.triangle_surface, len(weights))
    for k, surface in enumerate(part.surfaces):
        mine = inner[label == k] - surface.point
        along = mine @ surface.axis
        away = mine - np.outer(along, surface.axis)
        if surface.kind == "sphere":
            mine = surface.radius * mine / np.linalg.norm(mine, axis=1)[:, None]
        elif surface.kind == "cylinder":
            mine = mine + away * (surface.radius / np.linalg.norm(away, axis=1) - 1)[:, None]
        elif surface.kind == "cone":
            reach = along * np.tan(surface.half_angle)
            mine = mine + away * (reach / np.linalg.norm(away, axis=1) - 1)[:, None]
        elif surface.kind == "torus":
            core = surface.radius * away / np.linalg.norm(away, axis=1)[:, None]
            out = mine - core
            mine = core + surface.tube * out / np.linalg.norm(out, axis=1)[:, None]
        inner[label == k] = mine + surface.point
    return np.concatenate([part.vertices, inner])


# the cone of forces -------------------------------------------------------------------


def wrenches(points, normals):
    """Force and torque about the origin of unit forces along normals, shape (n, 6)."""
    rows = np.hstack([normals, np.cross(points, normals)])
    return rows / np.linalg.norm(rows, axis=1)[:, None]


def furthest(rows, cone):
    """Greatest distance of unit rows from a cone of rows."""
    return max(nnls(cone.T, row, maxiter=20000)[1] for row in rows)


def shell_points(apex, tangent, heights, angles):
    """Points and inward normals of a cone (`tangent` of its half angle) or cylinder of radius 1."""
    t, h = (x.ravel() for x in np.meshgrid(angles, heights))
    reach = 1.0 if tangent is None else h * tangent
    points = np.column_stack([reach * np.cos(t), reach * np.sin(t), h])
    slope = 0.0 if tangent is None else tangent
    normals = np.column_stack([-np.cos(t), -np.sin(t), 0 * t + slope])
    return points + apex, normals / np.linalg.norm(normals, axis=1)[:, None]


FINE = np.linspace(0, 2 * np.pi, 720, endpoint=False)
TRUE = {
    "peg in hole": shell_points(0.0, None, [-1, 0, 1], FINE[::20]),
    "cone in cone": shell_points(0.0, np.tan(ALPHA), [1, 3], FINE[::4]),
}


@pytest.mark.parametrize("case", TRUE)
def test_cone_of_forces_is_that_of_the_whole_face(case):
    base, _, part, _, _, _, _, _ = CASES[case]
    contacts = detect.contacts(Assembly([Part("base", base, grounded=True), Part("part", part)]))
    inner = wrenches(contacts.points, contacts.normals)
    true = wrenches(*TRUE[case])
    outer = np.vstack([inner, wrenches(contacts.possible.points, contacts.possible.normals)])
    bound = 1e-9 if case == "peg in hole" else 1e-3
    assert furthest(true[::7], inner) < bound
    assert furthest(true[::7], outer) < 1e-9
    assert furthest(inner[::5], true) < 1e-3  # the samples lie inside as well


def test_arc_of_a_groove_is_its_two_ends():
    half = 0.7
    base, _, bar, _, _, _, _, _ = CASES["bar in groove"]
    parts = [Part("base", base, grounded=True), Part("bar", bar, Pose([0, 0, 0], LYING))]
    contacts = detect.contacts(Assembly(parts))
    angle = np.arctan2(contacts.points[:, 0], -contacts.points[:, 2])
    ends = np.abs(np.abs(angle) - half) < 1e-9
    least = wrenches(contacts.points[ends], contacts.normals[ends])
    assert ends.sum() == 4
    t, y = (x.ravel() for x in np.meshgrid(np.linspace(-half, half, 101), [-1, -0.3, 1]))
    away = np.column_stack([np.sin(t), 0 * t, -np.cos(t)])
    true = wrenches(away + np.outer(y, [0, 1, 0]), -away)
    assert furthest(true[::3], least) < 1e-12


def test_facets_of_a_very_fine_mesh_leave_the_same_motions():
    # 400 flat sides of hole and peg as plain prisms: their planar patches, side by side
    sides = 200
    angle = np.arange(sides) * 2 * np.pi / sides
    x = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    n = np.column_stack([-np.cos(angle + np.pi / sides), -np.sin(angle + np.pi / sides), 0 * angle])
    facets = wrenches(np.concatenate([x - np.eye(3)[2], x + np.eye(3)[2]]), np.concatenate([n, n]))
    contacts = detect.contacts(Assembly([Part("b", bore(), grounded=True), Part("p", peg())]))
    rows = wrenches(contacts.points, contacts.normals)
    # a wrench across the axis is in both cones; one along it or about it is in neither
    for wrench, within in (
        ([1, 0, 0, 0, 0, 0], True), ([0, 0, 0, 1, 0, 0], True),
        ([0, 0, 1, 0, 0, 0], False), ([0.6, -0.8, 0, 0.1, 0.3, 0], True),
    ):  # fmt: skip
        for cone in (rows, facets):
            left = nnls(cone.T, np.array(wrench, float))[1]
            assert left < 2 * np.pi / sides if within else left > 0.5


@pytest.mark.slow
def test_two_tessellations_of_one_bore_show_no_overlap_at_any_phase():
    for sides, other, phase in ((12, 12, 0.26), (16, 90, 0.01), (60, 61, 0.0)):
        parts = [
            Part("b", bore(sides=sides), grounded=True),
            Part("p", peg(sides=other, phase=phase)),
        ]
        for shapes in (parts, [Part(p.name, mesh_of(p.shape), grounded=p.grounded) for p in parts]):
            contacts = detect.contacts(Assembly(shapes))
            assert contacts.patch_kind.tolist() == ["cylinder"]
            assert contacts.overlaps == ()
            assert contacts.unsupported == ()


@pytest.mark.slow
def test_hexagonal_bar_in_a_round_hole_is_no_peg():
    hexagon = mesh_of(peg(sides=6))
    contacts = detect.contacts(Assembly([Part("b", bore(), grounded=True), Part("p", hexagon)]))
    assert isinstance(hexagon, Mesh)
    assert "cylinder" not in contacts.patch_kind.tolist()


@pytest.mark.slow
def test_interrupted_face_reaches_as_far_as_its_pieces():
    # a bore with a groove around its middle: two bands, the outer ends decide
    from solids import line

    base = revolved(
        line((1, -1), (3, -1), (3, 1), (1, 1), (1, 0.5), (1.5, 0.5), (1.5, -0.5), (1, -0.5))
    )
    contacts = detect.contacts(Assembly([Part("b", base, grounded=True), Part("p", peg())]))
    assert contacts.patch_area.sum() == pytest.approx(2 * np.pi, rel=1e-6)
    assert np.ptp(contacts.points[:, 2]) == pytest.approx(2.0)


DATA = Path(__file__).resolve().parents[3] / "shared" / "data" / "compas_cra"


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="real data is not here")
def test_faceted_curved_interface_is_found_from_end_to_end():
    # a free form, cut into triangles in two ways: facets of both, tilted to .014 and more
    path = DATA / "cube-curve-short.json"
    listed = [interface["data"]["points"] for interface in interfaces(json.loads(path.read_text()))]
    contacts = detect.contacts(load(path), tolerance=Tolerance.loose())
    assert len(listed) == 72
    assert contacts.pairs == 1
    assert contacts.overlaps == ()
    corners = np.concatenate(listed)
    # the patches reach as far as the interface does, to within one facet's length
    assert contacts.points.min(axis=0) == pytest.approx(corners.min(axis=0), abs=0.07)
    assert contacts.points.max(axis=0) == pytest.approx(corners.max(axis=0), abs=0.07)
    assert contacts.patch_area.sum() > 0.6 * sum(area(np.array(points)) for points in listed)


def interfaces(value):
    """Every entry of a list named "interfaces", however deep."""
    if isinstance(value, dict):
        yield from value.get("interfaces") or []
        value = [v for k, v in value.items() if k != "interfaces"]
    if isinstance(value, list):
        for entry in value:
            yield from interfaces(entry)


def area(points):
    local = points - points[0]
    return 0.5 * np.linalg.norm(np.cross(local[:-1], local[1:]).sum(axis=0))


FILE = Path(__file__).resolve().parents[2] / "benchmarks" / "round_census.py"


@pytest.fixture(scope="module")
def census():
    pytest.importorskip("OCP")
    spec = importlib.util.spec_from_file_location("round_census", FILE)
    module = importlib.util.module_from_spec(spec)
    sys.modules["round_census"] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(80))
def test_round_bodies_touch_and_stay_as_closed_forms_say(census, seed):
    _, _, wrong = census.asked(seed)
    assert wrong == []


FOLDER = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture(scope="module")
def tangents():
    pytest.importorskip("OCP")
    sys.path.append(str(FOLDER))
    spec = importlib.util.spec_from_file_location("tangent_census", FOLDER / "tangent_census.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["tangent_census"] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(60))
def test_the_contact_point_of_two_bodies_is_that_of_their_nearest_points(tangents, seed):
    scene = tangents.random_scene(np.random.default_rng(seed))
    assert scene is None or tangents.judged(scene) == []
