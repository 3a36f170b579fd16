"""Recognition of round faces in meshes: round faces, flat faces, and the accuracy."""

import time
from collections import Counter

import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from kilter.shape import first_fits
from kilter.shape.primitives import Box, Cylinder, Sphere, surface
from kilter.shape.recognition import recognise
from kilter.shape.round_region import FacetMesh
from kilter.shape.solid import Surface, height, outward
from round_meshes import Mesh, bar, circle, moved, revolved, rounded_bar

ARC = np.linspace(0, np.pi / 2, 13)[1:-1]
COUNTERSUNK = [(2, 0), (6, 0), (6, 4), (3, 4), (2, 3)]
DOME = [(0, 0), (3, 0), *((3 * np.cos(t), 3 * np.sin(t)) for t in ARC), (0, 3)]
CAPSULE = [
    *[(0, -3), *((3 * np.cos(t), -3 * np.sin(t)) for t in ARC[::-1]), (3, 0)],
    *[(3, 5), *((3 * np.cos(t), 5 + 3 * np.sin(t)) for t in ARC), (0, 8)],
]


def judged(mesh: Mesh, accuracy: float = 0.0) -> tuple[tuple[Surface, ...], np.ndarray, np.ndarray]:
    """The surfaces recognised in a mesh, after checks that must always hold."""
    vertices, triangles = mesh
    surfaces, which, sagitta = recognise(vertices, triangles, accuracy)
    assert len(which) == len(triangles)
    assert len(sagitta) == len(surfaces)
    assert np.unique(which).tolist() == list(range(len(surfaces)))
    p, q, r = (vertices[triangles[:, k]] for k in range(3))
    normal = np.cross(q - p, r - p)
    size = np.ptp(vertices, axis=0).max()
    for k, one in enumerate(surfaces):
        own = triangles[which == k]
        assert np.abs(height(one, vertices[own].reshape(-1, 3))).max() <= 4 * accuracy + 1e-7 * size
        middle = vertices[own].mean(axis=1)
        assert np.abs(height(one, middle)).max() <= sagitta[k] + 1e-12 * size
        facing = (outward(one, middle) * normal[which == k]).sum(axis=1)
        assert ((facing < 0) == one.hollow).all()
    return surfaces, which, sagitta


def kinds(mesh: Mesh, accuracy: float = 0.0) -> dict[str, int]:
    found = judged(mesh, accuracy)[0]
    return dict(Counter(f"hollow {s.kind}" if s.hollow else s.kind for s in found))


def accuracy_of(mesh: Mesh) -> float:
    return float(np.abs(mesh[0]).max()) * 2.0**-24


# where a prism becomes round -----------------------------------------------------------


@pytest.mark.parametrize("sides", [3, 4, 6, 8, 11])
def test_a_prism_of_few_sides_stays_flat(sides):
    assert kinds(bar(circle(sides))) == {"plane": sides + 2}


@pytest.mark.parametrize("sides", [12, 16, 96, 2000])
def test_a_prism_of_twelve_sides_or_more_is_round(sides):
    surfaces, which, sagitta = judged(bar(circle(sides, 2.0)))
    assert [s.kind for s in surfaces] == ["cylinder", "plane", "plane"]
    assert surfaces[0].radius == pytest.approx(2.0, rel=1e-13)
    assert np.bincount(which).tolist() == [2 * sides, sides - 2, sides - 2]
    assert sagitta[0] == pytest.approx(2.0 * (1 - np.cos(np.pi / sides)), rel=1e-6)


@pytest.mark.quick(3)
@pytest.mark.parametrize(("pieces", "cylinders"), [(1, 0), (2, 0), (4, 0), (5, 4), (8, 4), (30, 4)])
def test_a_rounded_edge_has_five_pieces_or_more(pieces, cylinders):
    found = kinds(rounded_bar(pieces))
    assert found.get("cylinder", 0) == cylinders
    assert found["plane"] == 6 + (0 if cylinders else 4 * pieces)


def test_the_flat_of_a_shaft_stays_flat():
    angle = np.radians(np.arange(20, 341, 5))  # the corners lie on the circle as well
    surfaces, which, _ = judged(bar(np.column_stack([np.cos(angle), np.sin(angle)])))
    assert Counter(s.kind for s in surfaces) == {"cylinder": 1, "plane": 3}
    assert (which == 0).sum() == 2 * 64


@pytest.mark.slow
def test_a_bar_on_an_ellipse_stays_flat():
    angle = np.arange(400) * (2 * np.pi / 400)
    assert kinds(bar(np.column_stack([3 * np.cos(angle), 2 * np.sin(angle)]))) == {"plane": 402}


@pytest.mark.slow
def test_bands_of_a_face_that_is_curved_both_ways_are_no_cones():
    ring = [(5 + 2 * np.cos(t), 2 * np.sin(t)) for t in np.arange(24) * (2 * np.pi / 24)]
    assert set(kinds(revolved(ring, 48))) == {"plane"}
    ball = trimesh.creation.icosphere(subdivisions=3)
    assert set(kinds((ball.vertices * [1, 1, 1.3], ball.faces))) == {"plane"}


def test_a_box_has_six_planes():
    surfaces, _, sagitta = judged(surface(Box([1, 2, 3])))
    assert [s.kind for s in surfaces] == ["plane"] * 6
    assert sagitta.max() == 0.0
    assert sum(s.axis for s in surfaces).tolist() == [0, 0, 0]


def test_nothing_gives_nothing():
    assert recognise(np.empty((0, 3)), np.empty((0, 3)))[0] == ()


# recognised surfaces --------------------------------------------------------------------

PAN = [(0, -3.5), (4, -3.5), (4, 0), (3, 0), *((3 * np.cos(t), -3 * np.sin(t)) for t in ARC)]
PARTS = {
    "tube": (revolved([(2, 0), (6, 0), (6, 4), (2, 4)], 48), ["cylinder", "hollow cylinder"]),
    "countersunk": (revolved(COUNTERSUNK, 48), ["cylinder", "hollow cone", "hollow cylinder"]),
    "tip": (revolved([(0, 0), (4, 0), (0, 7)], 32), ["cone"]),
    "taper": (revolved([(0, 0), (4, 0), (4, 6), (3, 10), (0, 10)], 40), ["cone", "cylinder"]),
    "dome": (revolved(DOME, 40), ["sphere"]),
    "capsule": (revolved(CAPSULE, 40), ["cylinder", "sphere", "sphere"]),
    "ball": (surface(Sphere(2)), ["sphere"]),
    "pan": (revolved([*PAN, (0, -3)], 40), ["cylinder", "hollow sphere"]),
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("single", [False, True], ids=["double", "single"])
@pytest.mark.parametrize("name", PARTS)
def test_round_faces_in_any_pose(name, single):
    mesh, expected = PARTS[name]
    for seed, scale in ((1, 1.0), (2, 1e-3), (3, 1e3)):
        there = moved(mesh, seed, scale, single)
        found = kinds(there, accuracy_of(there) if single else 0.0)
        found.pop("plane", None)
        assert sorted(Counter(found).elements()) == expected


@pytest.mark.parametrize("level", [1, 2, 4])
def test_balls_of_triangles(level):
    ball = trimesh.creation.icosphere(subdivisions=level, radius=3.0)
    (one,), _, sagitta = judged((np.array(ball.vertices) + 7, np.array(ball.faces)))
    assert (one.kind, one.hollow) == ("sphere", False)
    assert one.radius == pytest.approx(3.0, rel=1e-12)
    assert one.point == pytest.approx([7, 7, 7], rel=1e-12)
    middles = np.linalg.norm(ball.vertices[ball.faces].mean(axis=1), axis=1)
    assert sagitta[0] == pytest.approx(3 - middles.min(), rel=1e-9)


def test_the_twenty_sided_die_stays_flat():
    ball = trimesh.creation.icosphere(subdivisions=0)
    assert kinds((np.array(ball.vertices), np.array(ball.faces))) == {"plane": 20}


def test_a_countersunk_hole_to_the_last_digits():
    surfaces = judged(revolved(COUNTERSUNK, 48))[0]
    cone = next(s for s in surfaces if s.kind == "cone")
    assert cone.point == pytest.approx([0, 0, 1], abs=1e-12)
    assert cone.axis == pytest.approx([0, 0, 1], abs=1e-12)
    assert cone.half_angle == pytest.approx(np.pi / 4, rel=1e-13)
    hole = next(s for s in surfaces if s.kind == "cylinder" and s.hollow)
    assert hole.radius == pytest.approx(2, rel=1e-13)
    assert hole.axis[:2] == pytest.approx([0, 0], abs=1e-13)


@pytest.mark.parametrize("single", [False, True], ids=["double", "single"])
def test_peg_and_hole_of_two_tessellations_agree(single):
    peg = revolved([(0, 0), (2, 0), (2, 9), (0, 9)], 31, phase=0.1)
    hole = revolved([(2, 0), (6, 0), (6, 4), (2, 4)], 52)
    found = []
    for mesh in (peg, hole):
        there = moved(mesh, 5, 1.0, single)
        surfaces = judged(there, accuracy_of(there) if single else 0.0)[0]
        found.append(next(s for s in surfaces if s.kind == "cylinder" and s.radius < 3))
    pin, bore = found
    within = 3e-6 if single else 1e-12
    assert (pin.hollow, bore.hollow) == (False, True)
    assert pin.radius == pytest.approx(bore.radius, abs=within)
    assert np.linalg.norm(np.cross(pin.axis, bore.axis)) < within
    assert np.linalg.norm(np.cross(bore.point - pin.point, pin.axis)) < within


def test_rounded_bar_in_single_precision():
    there = moved(rounded_bar(8), 4, single=True)
    surfaces = judged(there, accuracy_of(there))[0]
    radii = [s.radius for s in surfaces if s.kind == "cylinder"]
    assert radii == pytest.approx([1.0] * 4, abs=3e-6)


def test_a_soup_of_triangles_is_welded_where_corners_are_equal():
    vertices, triangles = surface(Cylinder(2, 5))
    soup = vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)
    assert kinds(soup) == {"cylinder": 1, "plane": 2}


def test_faces_of_no_area_do_no_harm():
    vertices, triangles = surface(Cylinder(2, 5))
    with_flat = np.vstack([triangles, [[0, 0, 1], [5, 5, 5]]])
    surfaces, which, _ = recognise(vertices, with_flat)
    assert all(np.linalg.norm(s.axis) == pytest.approx(1) for s in surfaces)
    assert which[-2:].tolist() == [-1, -1]
    assert Counter(s.kind for s in surfaces)["cylinder"] == 1


def test_a_box_with_chamfers_in_two_steps_stays_flat():
    corners = []
    for x, z, start in ((3, 2, 0), (-3, 2, 90), (-3, -2, 180), (3, -2, 270)):
        for t in np.radians(start + np.array([0, 45, 90])):
            corners.append([x + np.cos(t), z + np.sin(t)])
    assert kinds(bar(np.array(corners))) == {"plane": 14}


def test_one_corner_off_the_circle_leaves_its_facets_flat():
    vertices, triangles = bar(circle(60))
    for step, others in ((1e-12, 0), (1e-4, 4)):
        bent = vertices.copy()
        bent[[0, 60], 0] += step  # both ends of a line along the side
        surfaces, which, _ = judged((bent, triangles))
        assert Counter(s.kind for s in surfaces) == {"cylinder": 1, "plane": 2 + others // 2}
        assert (which == 0).sum() == 120 - others


@pytest.mark.slow
def test_a_short_arc_within_a_smooth_face_is_no_evidence():
    """Each piece of a spline of slowly changing curvature is an arc to within rounding."""
    t = np.linspace(0, 1, 400)
    top = np.column_stack([t * 4, 1 + 0.1 * t**2 * (1 - t) ** 2])
    there = bar(np.vstack([top[::-1], [[0, 0], [4, 0]]]))
    assert "cylinder" not in kinds(there)
    single = (there[0].astype(np.float32).astype(float), there[1])
    assert "cylinder" not in kinds(single, accuracy_of(single))


@pytest.mark.slow
def test_a_hundred_thousand_triangles_take_about_a_second():
    ball = trimesh.creation.icosphere(subdivisions=6)
    wavy = ball.vertices * (1 + 0.05 * np.sin(3 * ball.vertices[:, :1]))
    for vertices, most in ((ball.vertices, 1), (wavy, 81920)):
        start = time.process_time()
        surfaces = recognise(vertices, ball.faces)[0]
        assert time.process_time() - start < 6.0  # 0.4 s and 1.4 s on a free core
        assert len(surfaces) == most


def capsule(rings: int, sides: int) -> Mesh:
    """A capsule whose cap and wall meet without an edge, each with `rings` rings of facets."""
    turn = np.linspace(0, np.pi / 2, rings + 1)[1:-1]
    wall = np.linspace(0, 5, rings + 1)
    lower = [(3 * np.cos(t), -3 * np.sin(t)) for t in turn[::-1]]
    upper = [(3 * np.cos(t), 5 + 3 * np.sin(t)) for t in turn]
    return revolved([(0, -3), *lower, *((3, z) for z in wall), *upper, (0, 8)], sides)


@pytest.mark.slow
@pytest.mark.parametrize("rings", [12, 24])
def test_the_growth_of_a_surface_reads_each_corner_a_few_times(rings, monkeypatch):
    """Twice as many rings of twice as many facets: the work grows fourfold, not eightfold."""
    counted = []
    points = FacetMesh.points

    def counting(mesh: FacetMesh, facets: np.ndarray) -> np.ndarray:
        counted[-1] += len(facets)
        return points(mesh, facets)

    monkeypatch.setattr(FacetMesh, "points", counting)
    shares = []
    for size in (rings, 2 * rings):
        vertices, triangles = capsule(size, 4 * size)
        counted.append(0)
        surfaces, _, _ = recognise(vertices, triangles)
        assert [s.kind for s in surfaces].count("sphere") == 2
        assert [s.kind for s in surfaces].count("cylinder") == 1
        shares.append(counted[-1] / len(triangles))
    assert shares[1] < 1.5 * shares[0]


def test_starts_that_are_left_out_change_no_surface(monkeypatch):
    vertices, triangles = moved(capsule(4, 16), 0)
    dented = vertices.copy()
    dented[2] *= 1.02  # its region is no longer round as a whole
    for corners in (vertices, dented):
        found = recognise(corners, triangles)
        monkeypatch.setattr(
            first_fits, "_may_grow", lambda mesh, middles, tried, free: np.full(len(tried), True)
        )
        every = recognise(corners, triangles)
        monkeypatch.undo()
        assert [(s.kind, s.radius) for s in found[0]] == [(s.kind, s.radius) for s in every[0]]
        assert found[1].tolist() == every[1].tolist()
        assert {"sphere", "cylinder"} & {s.kind for s in found[0]}


def test_planes_can_be_left_out():
    vertices, triangles = surface(Cylinder(2, 5))
    surfaces, which, sagitta = recognise(vertices, triangles, planes=False)
    assert [s.kind for s in surfaces] == ["cylinder"]
    assert len(sagitta) == 1
    assert which.tolist() == np.where(recognise(vertices, triangles)[1] == 0, 0, -1).tolist()


def fan(rays: int, jitter: float) -> tuple[np.ndarray, np.ndarray]:
    """A part of a cone about z as triangles at its apex, closed below; corners off by `jitter`."""
    rng = np.random.default_rng(4)
    angle = np.radians(20.0) * np.arange(rays)
    length = rng.uniform(1.0, 2.0, rays)  # corners of a cone lie anywhere on its rays
    rim = np.column_stack([length * np.cos(angle), length * np.sin(angle), -0.4 * length])
    rim += jitter * rng.normal(size=rim.shape)
    low = rim.mean(axis=0) - np.array([0.0, 0.0, 3.0])
    vertices = np.concatenate([[[0.0, 0.0, 0.0]], rim, [low]])
    apex, bottom = 0, rays + 1
    side = [[apex, k, k + 1] for k in range(1, rays)]
    below = [[bottom, k + 1, k] for k in range(1, rays)]
    ends = [[apex, bottom, 1], [apex, rays, bottom]]
    return vertices, np.array([*side, *below, *ends])


@pytest.mark.parametrize(("jitter", "round_faces"), [(0.0, 1), (1e-3, 0)])
def test_seven_corners_of_a_cone_are_evidence(jitter, round_faces):
    surfaces, _, _ = recognise(*fan(6, jitter))
    assert sum(surface.kind == "cone" for surface in surfaces) == round_faces


def test_a_cone_through_six_corners_is_no_evidence():
    """Facets of a random convex polyhedron: a cone passes through any six of its corners."""
    corners = np.array(
        [
            [0.5757, 0.8901, 0.6854], [-0.0513, 0.9681, 0.0], [0.8498, 0.0353, 0.0425],
            [-0.0791, -0.6296, 1.8563], [0.4214, -0.6503, 0.0], [-0.8163, 1.7095, 0.3761],
            [0.0894, 1.573, 0.4561], [0.3909, 1.5006, 0.9303], [-0.9436, -0.8668, 0.0],
            [1.0273, -1.6531, 0.6294], [-0.6133, -0.4095, 1.0712],
        ]
    )  # fmt: skip
    hull = ConvexHull(corners)
    triangles = hull.simplices.copy()
    p, q, r = (corners[triangles[:, k]] for k in range(3))
    inward = np.einsum("ij,ij->i", np.cross(q - p, r - p), hull.equations[:, :3]) < 0
    triangles[inward] = triangles[inward][:, [0, 2, 1]]
    surfaces, _, _ = recognise(corners, triangles)
    assert {surface.kind for surface in surfaces} == {"plane"}
