"""Distances, depths and candidate points of convex pieces: closed forms and second methods."""

from itertools import pairwise

import clarabel
import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import minimize
from scipy.spatial import ConvexHull
from scipy.spatial.transform import Rotation

from kilter.arrays import Array
from kilter.assembly import Assembly, Part
from kilter.contact.convex_normals import _attained
from kilter.contact.convex_pieces import convex_pieces, placed
from kilter.contact.convex_points import PiecePoints, near_points
from kilter.files.robots.one_body import capsule, one_body
from kilter.rigid import Pose
from kilter.shape.primitives import Box, Cylinder, Mesh, Prism, Shape, Sphere, hull_surface, surface

CUBE = Box([1, 1, 1])
LYING = Rotation.from_euler("x", 90, degrees=True)
NONE = np.empty((0, 2), dtype=np.int64)


def pose(position: object, turn: Rotation | None = None) -> Pose:
    """A pose from a position and a rotation."""
    quaternion = np.array([1.0, 0, 0, 0]) if turn is None else np.roll(turn.as_quat(), 1)
    return Pose(position, quaternion)


def scene(*parts: tuple[Shape, Pose]) -> tuple[Assembly, Array, Array]:
    """An assembly of shapes in poses, with the rotations and positions of its parts."""
    assembly = Assembly(
        [Part(name=str(k), shape=shape, pose=at) for k, (shape, at) in enumerate(parts)]
    )
    rotation = np.array([at.matrix for _, at in parts])
    return assembly, rotation, np.array([at.position for _, at in parts])


def points(*parts: tuple[Shape, Pose], reach: float = 0.05) -> PiecePoints:
    """The candidate points of shapes in poses, in the order of their places."""
    assembly, rotation, position = scene(*parts)
    pieces = convex_pieces(assembly)
    assert pieces.whole.all()
    found = near_points(pieces, rotation, position, reach, NONE)
    return found.take(np.lexsort(found.point.round(9).T[::-1]))


def random_pose(rng: np.random.Generator, low: float, high: float) -> Pose:
    """A pose at a random distance between limits."""
    away = rng.normal(size=3)
    away *= rng.uniform(low, high) / np.linalg.norm(away)
    return pose(away, Rotation.random(random_state=int(rng.integers(1 << 30))))


# faces, edges and corners --------------------------------------------------------------------


@pytest.mark.parametrize("gap", [0.01, 0.0, -0.01])
def test_faces_meet_at_the_corners_of_their_overlap(gap: float) -> None:
    found = points((CUBE, pose([0, 0, 0])), (CUBE, pose([0.3, 0.2, 1 + gap])))
    middle = 0.5 + gap / 2
    expected = [[x, y, middle] for x in (-0.2, 0.5) for y in (-0.3, 0.5)]
    np.testing.assert_allclose(found.point, expected, atol=1e-14)
    np.testing.assert_allclose(found.normal, np.tile([0.0, 0, 1], (4, 1)), atol=1e-15)
    np.testing.assert_allclose(found.gap, gap, atol=1e-15)
    assert found.bears.all()


def test_points_beyond_the_reach_are_left_out() -> None:
    for gap, count in ((0.0499, 4), (0.0501, 0)):
        assert len(points((CUBE, pose([0, 0, 0])), (CUBE, pose([0, 0, 1 + gap])))) == count


def test_corner_over_face() -> None:
    down = Rotation.align_vectors([[0, 0, -1]], [[1, 1, 1]])[0]
    half = np.sqrt(0.75)
    found = points(
        (Box([4, 4, 1]), pose([0, 0, 0])), (CUBE, pose([0.2, 0.1, 0.5 + half + 0.01], down))
    )
    assert len(found) == 1
    np.testing.assert_allclose(found.point, [[0.2, 0.1, 0.505]], atol=1e-9)
    np.testing.assert_allclose(found.gap, 0.01, atol=1e-14)


@pytest.mark.parametrize("seed", [0, 217, 246, 307, 348])
def test_the_lowest_corner_of_a_polyhedron_counts_wherever_its_faces_look(seed: int) -> None:
    """The face that looks down most does not always contain the lowest corner."""
    corners = np.random.default_rng(seed).normal(size=(10, 3))
    corners *= np.array([1.0, 0.4, 0.3]) / np.linalg.norm(corners, axis=1)[:, None]
    corners = Rotation.random(random_state=seed).apply(corners)
    lowest = float(corners[:, 2].min())
    for gap in (0.01, -0.01):
        plate = (Box([20, 20, 2]), pose([0, 0, lowest - gap - 1]))
        found = points(plate, (Mesh.convex_hull(corners), Pose()))
        assert found.gap.min() == pytest.approx(gap, abs=1e-9)


@pytest.mark.parametrize("gap", [0.01, -0.01])
def test_edges_that_cross(gap: float) -> None:
    ridge = Rotation.from_euler("x", 45, degrees=True)
    other = Rotation.from_euler("y", 45, degrees=True)
    height = 2 * np.sqrt(0.5) + gap
    found = points((CUBE, pose([0, 0, 0], ridge)), (CUBE, pose([0, 0, height], other)))
    assert len(found) == 1
    np.testing.assert_allclose(found.point, [[0, 0, height / 2]], atol=1e-14)
    np.testing.assert_allclose(found.normal, [[0, 0, 1]], atol=1e-14)
    np.testing.assert_allclose(found.gap, gap, atol=1e-14)
    assert found.bears.all()


def test_beam_across_knife_edges_wider_than_it() -> None:
    knife = Prism([[-0.1, -0.1], [0.1, -0.1], [0, 0]], 0.4)
    found = points(
        (Box([1, 0.2, 0.05]), pose([0, 0, 0.025])),
        (knife, pose([-0.3, 0, 0])),
        (knife, pose([0.3, 0, 0])),
    )
    expected = [[x, y, 0] for x in (-0.3, 0.3) for y in (-0.1, 0.1)]
    np.testing.assert_allclose(found.point, expected, atol=1e-15)
    np.testing.assert_allclose(found.gap, 0, atol=1e-15)
    assert found.bears.all()


def test_corner_beside_corner_only_prevents_penetration() -> None:
    found = points((CUBE, pose([0, 0, 0])), (CUBE, pose([1.01, 1.01, 1.01])))
    assert len(found) == 1
    np.testing.assert_allclose(found.normal, [np.ones(3) / np.sqrt(3)], atol=1e-14)
    np.testing.assert_allclose(found.gap, 0.01 * np.sqrt(3), atol=1e-15)
    assert not found.bears.any()


def test_plate_over_the_edge_of_a_step_may_tip() -> None:
    plate = Box([0.12, 0.05, 0.01])
    found = points((Box([0.1, 0.2, 0.05]), pose([0, 0, 0])), (plate, pose([0.06, 0, 0.03])))
    assert found.point[:, 0].max() <= 0.05 + 1e-15
    np.testing.assert_allclose(found.point[:, 0].min(), 0.0, atol=1e-15)


# round pieces --------------------------------------------------------------------------------


def test_spheres() -> None:
    away = np.array([0.3, 0.2, 1.0])
    found = points((Sphere(0.3), pose([0, 0, 0])), (Sphere(0.5), pose(away)), reach=0.5)
    length = np.linalg.norm(away)
    np.testing.assert_allclose(found.gap, length - 0.8, atol=1e-15)
    np.testing.assert_allclose(found.normal, [away / length], atol=1e-15)
    np.testing.assert_allclose(found.point, [away / length * (0.3 + length - 0.5) / 2], atol=1e-15)
    assert found.bears.all()


@pytest.mark.parametrize(
    ("center", "gap", "normal"),
    [
        ([0.3, 0.2, 1.01], 0.01, [0, 0, 1]),
        ([0.8, 0.1, 0.9], 0.0, [0.6, 0, 0.8]),
        ([0.7, 0.8, 1.1], 0.2, [2 / 7, 3 / 7, 6 / 7]),
        ([0.3, 0.2, 0.45], -0.55, [0, 0, 1]),
    ],
)
def test_sphere_at_face_edge_corner_and_inside(center: list, gap: float, normal: list) -> None:
    found = points((CUBE, pose([0, 0, 0])), (Sphere(0.5), pose(center)), reach=0.3)
    assert len(found) == 1
    np.testing.assert_allclose(found.gap, gap, atol=1e-15)
    np.testing.assert_allclose(found.normal, [normal], atol=1e-14)
    assert found.bears.all()


def test_capsules_touch_along_lines() -> None:
    bar = capsule(0.1, 1.0)
    on_table = points((Box([4, 4, 1]), pose([0, 0, 0])), (bar, pose([0.2, 0.1, 0.61], LYING)))
    np.testing.assert_allclose(on_table.point[:, 1], [-0.4, 0.6], atol=1e-14)
    np.testing.assert_allclose(on_table.gap, 0.01, atol=1e-15)
    side = points((bar, pose([0, 0, 0])), (bar, pose([0.2, 0, 0.3])))
    np.testing.assert_allclose(side.point, [[0.1, 0, -0.2], [0.1, 0, 0.5]], atol=1e-14)
    np.testing.assert_allclose(side.gap, 0, atol=1e-15)


def test_cylinder_on_its_base_and_on_its_side() -> None:
    floor, can = (Box([4, 4, 1]), pose([0, 0, 0])), Cylinder(0.5, 1)
    base = points(floor, (can, pose([0.2, 0, 1.01])))
    np.testing.assert_allclose(base.gap, 0.01, atol=1e-15)
    rim = np.linalg.norm(base.point[:, :2] - [0.2, 0], axis=1)
    np.testing.assert_allclose(rim, 0.5, atol=1e-14)
    assert len(base) >= 8
    for turn in range(3):
        spun = LYING * Rotation.from_euler("z", 7 * turn, degrees=True)
        side = points(floor, (can, pose([0.1, 0.2, 1.01], spun)))
        np.testing.assert_allclose(side.point, [[0.1, y, 0.505] for y in (-0.3, 0.7)], atol=1e-13)
        np.testing.assert_allclose(side.gap, 0.01, atol=1e-15)


@pytest.mark.parametrize("tilt", [0.3, 1.0, 1.4])
def test_tilted_cylinder_touches_with_its_rim(tilt: float) -> None:
    turn = Rotation.from_euler("x", tilt)
    height = 0.5 * np.cos(tilt) + 0.5 * np.sin(tilt)
    found = points(
        (Box([4, 4, 1]), pose([0, 0, 0])),
        (Cylinder(0.5, 1), pose([0.1, 0.2, 0.5 + height + 0.02], turn)),
        reach=0.03,
    )
    lowest = found.take([int(found.gap.argmin())])
    np.testing.assert_allclose(lowest.gap, 0.02, atol=1e-15)
    np.testing.assert_allclose(
        lowest.point, [[0.1, 0.2 - 0.5 * np.cos(tilt) + 0.5 * np.sin(tilt), 0.51]], atol=1e-12
    )


def test_two_cylinders() -> None:
    can = Cylinder(0.5, 1)
    side = points((can, pose([0, 0, 0], LYING)), (can, pose([0.6, 0.3, 0.8], LYING)))
    np.testing.assert_allclose(side.point, [[0.3, -0.2, 0.4], [0.3, 0.5, 0.4]], atol=1e-14)
    np.testing.assert_allclose(side.gap, 0, atol=1e-15)
    crossed = Rotation.from_euler("y", 90, degrees=True)
    for gap in (0.02, -0.02):
        found = points((can, pose([0, 0, 0], LYING)), (can, pose([0.1, 0.3, 1 + gap], crossed)))
        assert len(found) == 1
        np.testing.assert_allclose(found.point, [[0, 0.3, 0.5 + gap / 2]], atol=1e-14)
        np.testing.assert_allclose(found.gap, gap, atol=1e-14)


@pytest.mark.parametrize(
    ("height", "gap"),
    [
        (0.1, np.hypot(0.9, 0.4) - 0.8),
        (0.8, np.hypot(np.hypot(0.9, 0.4) - 0.5, 0.3) - 0.3),
    ],
)
def test_sphere_beside_a_cylinder_and_at_its_rim(height: float, gap: float) -> None:
    found = points(
        (Cylinder(0.5, 1), pose([0, 0, 0])), (Sphere(0.3), pose([0.9, 0.4, height])), reach=0.3
    )
    assert len(found) == 1
    np.testing.assert_allclose(found.gap, gap, atol=1e-14)


@pytest.mark.parametrize(
    ("shape", "at", "normal", "separation", "attained"),
    [
        (CUBE, [0, 0, -1.1], [0, 0, -1], 0.1, True),  # the rim over the face
        (CUBE, [0, 0, -0.9], [0, 0, -1], -0.1, False),  # an overlap, which may be less elsewhere
        (CUBE, [2, 0, -1.1], [0, 0, -1], 0.1, False),  # the rim beside the face
        (CUBE, [1.0, 0, 0], [1, 0, 0], 0.2, True),  # the middle of a line of the side
        (CUBE, [1.0, 0, 1.5], [1, 0, 0], 0.2, False),  # its middle below the face
        (Cylinder(0.5, 1), [0, 0, -1.1], [0, 0, -1], 0.1, True),
        (Cylinder(0.5, 1), [0, 0, -1.1], [0, 0, -1], 0.05, False),
        (Cylinder(0.5, 1), [0.6, 0, -1.1], [0, 0, -1], 0.1, False),
    ],
)
def test_a_point_of_both_pieces_shows_that_no_direction_separates_them_more(
    shape: Shape, at: list, normal: list, separation: float, attained: bool
) -> None:
    cylinder = Cylinder(0.3, 1.0)
    assembly, rotation, position = scene((cylinder, pose([0, 0, 0])), (shape, pose(at)))
    pieces = placed(convex_pieces(assembly), rotation, position)
    pair = np.array([0]), np.array([1])
    cores = pieces.cores(pair[0]), pieces.cores(pair[1])
    n = np.array([normal], dtype=np.float64)
    found = _attained(pieces, pair, cores, n, np.array([separation]))
    turned = _attained(pieces, pair[::-1], cores[::-1], -n, np.array([separation]))
    assert found.tolist() == turned.tolist() == [attained]


def test_cylinder_on_the_edge_of_a_box() -> None:
    found = points((CUBE, pose([0, 0, 0])), (Cylinder(0.5, 1), pose([0.8, 0, 0.9], LYING)))
    np.testing.assert_allclose(found.point, [[0.5, y, 0.5] for y in (-0.5, 0.5)], atol=1e-14)
    np.testing.assert_allclose(found.normal, np.tile([0.6, 0, 0.8], (2, 1)), atol=1e-14)
    np.testing.assert_allclose(found.gap, 0, atol=1e-15)


# second methods ------------------------------------------------------------------------------


def hull_distance(first: Array, second: Array) -> float:
    """Distance of two convex hulls by a quadratic program."""
    m, n = len(first), len(second)
    quadratic = sparse.block_diag([sparse.csc_matrix((m + n, m + n)), sparse.eye(3)]).tocsc()
    sums = np.zeros((2, m + n + 3))
    sums[0, :m], sums[1, m : m + n] = 1, 1
    step = np.hstack([first.T, -second.T, -np.eye(3)])
    least = np.hstack([-np.eye(m + n), np.zeros((m + n, 3))])
    rows = sparse.csc_matrix(np.vstack([step, sums, least]))
    right = np.concatenate([np.zeros(3), np.ones(2), np.zeros(m + n)])
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-14
    cones = [clarabel.ZeroConeT(5), clarabel.NonnegativeConeT(m + n)]
    solver = clarabel.DefaultSolver(quadratic, np.zeros(m + n + 3), rows, right, cones, settings)
    return float(np.linalg.norm(np.array(solver.solve().x)[-3:]))


def least_overlap(first: Array, second: Array) -> float:
    """Largest separation over all face normals and all products of edges; negative: depth."""
    directions, edges = [], []
    for vertices, sign in ((first, 1), (second, -1)):
        hull = ConvexHull(vertices)
        directions.append(sign * hull.equations[:, :3])
        loops = hull.simplices[:, [0, 1, 2, 0]]
        edges.append(
            np.concatenate(
                [vertices[loops[:, k]] - vertices[loops[:, j]] for j, k in pairwise(range(4))]
            )
        )
    both = np.cross(edges[0][:, None], edges[1][None]).reshape(-1, 3)
    length = np.linalg.norm(both, axis=1)
    both = both[length > 1e-9] / length[length > 1e-9, None]
    n = np.concatenate([*directions, both, -both])
    return float(((n @ second.T).min(axis=1) - (n @ first.T).max(axis=1)).max())


def polytopes(rng: np.random.Generator) -> list[Shape]:
    """Convex shapes with flat faces."""
    hulls: list[Shape] = [
        Mesh.convex_hull(rng.normal(size=(count, 3)) * 0.4) for count in (5, 9, 30)
    ]
    return [Box([1, 0.7, 0.4]), Prism([[-0.5, -0.4], [0.5, -0.4], [0, 0.4]], 0.6), *hulls]


@pytest.mark.slow
def test_random_polytopes_against_programs() -> None:
    rng = np.random.default_rng(5)
    shapes = polytopes(rng)
    apart = 0
    for _ in range(60):
        first, second = (shapes[k] for k in rng.integers(len(shapes), size=2))
        at = random_pose(rng, 0, 0.1), random_pose(rng, 0.3, 1.4)
        found = points((first, at[0]), (second, at[1]), reach=9.0)
        corners = at[0].apply(surface(first)[0]), at[1].apply(surface(second)[0])
        n = found.normal[0]
        separation = (corners[1] @ n).min() - (corners[0] @ n).max()
        expected = least_overlap(*corners)
        if expected > 0:
            apart += 1
            expected = hull_distance(*corners)
            # the normal of a face within its angle may stand for the nearest points
            assert 0.998 * expected - 1e-9 <= separation <= expected + 1e-9
            assert found.gap.min() >= separation - 1e-12
        else:
            np.testing.assert_allclose([separation, found.gap.min()], expected, atol=1e-12)
    assert 20 <= apart <= 50


def height_along(shape: Shape, at: Pose, n: Array) -> float:
    """Height of the support plane of a shape."""
    m = at.matrix.T @ n
    if isinstance(shape, Cylinder):
        own = shape.radius * np.hypot(m[0], m[1]) + shape.height / 2 * abs(m[2])
    elif isinstance(shape, Sphere):
        own = shape.radius
    else:
        own = (surface(shape)[0] @ m).max()
    return float(own + n @ at.position)


@pytest.mark.slow
def test_random_cylinders_against_a_search_of_directions() -> None:
    rng = np.random.default_rng(7)
    others = [Cylinder(0.1, 1.5), Sphere(0.3), *polytopes(rng)[:4]]
    for _ in range(12):
        first, second = Cylinder(0.5, 0.6), others[rng.integers(len(others))]
        at = random_pose(rng, 0, 0.1), random_pose(rng, 0.3, 1.2)
        found = points((first, at[0]), (second, at[1]), reach=9.0)

        def overlap(x: Array, first=first, second=second, at=at) -> float:
            n = x / np.linalg.norm(x)
            return height_along(first, at[0], n) + height_along(second, at[1], -n)

        starts = [found.normal[0], at[1].position - at[0].position]
        options = {"xatol": 1e-9, "fatol": 1e-12, "maxiter": 400}
        best = min(minimize(overlap, x, method="Nelder-Mead", options=options).fun for x in starts)
        assert overlap(found.normal[0]) <= best + 1e-8
        np.testing.assert_allclose(found.gap.min(), -overlap(found.normal[0]), atol=1e-9)


# steps that keep the points open do not penetrate ------------------------------------------------


def touching(rng: np.random.Generator, first: Shape, second: Shape) -> tuple[Pose, Pose]:
    """Random poses at which two polytopes touch."""
    at = random_pose(rng, 0, 0.1), random_pose(rng, 0.8, 1.0)
    found = points((first, at[0]), (second, at[1]), reach=9.0)
    step = found.gap.min() * found.normal[0]
    return at[0], Pose(at[1].position - step, at[1].rotation)


def test_steps_that_open_all_points_do_not_penetrate() -> None:
    rng = np.random.default_rng(9)
    shapes = polytopes(rng)[:4]
    tilts = [None, Rotation.from_euler("z", 0.3), Rotation.from_euler("xyz", [0.01, -0.02, 0.4])]
    cases = [((CUBE, pose([0, 0, 0])), (CUBE, pose([0.3, 0.2, 1.0], turn))) for turn in tilts[:2]]
    for _ in range(10):
        first, second = (shapes[k] for k in rng.integers(len(shapes), size=2))
        at = touching(rng, first, second)
        cases.append(((first, at[0]), (second, at[1])))
    for one, other in cases:
        found = points(one, other, reach=0.02)
        arm = found.point - other[1].position
        rows = np.concatenate([found.normal, np.cross(arm, found.normal)], axis=1)
        for _ in range(10):
            twist = rng.normal(size=6)
            twist -= np.linalg.pinv(rows) @ np.minimum(rows @ twist, 0)
            if (rows @ twist < -1e-12).any():
                continue
            for length in (1e-3, 1e-4):
                moved = pose(
                    other[1].position + length * twist[:3],
                    Rotation.from_rotvec(length * twist[3:])
                    * Rotation.from_matrix(other[1].matrix),
                )
                corners = one[1].apply(surface(one[0])[0]), moved.apply(surface(other[0])[0])
                assert least_overlap(*corners) >= -30 * length**2


# compounds -------------------------------------------------------------------------------------


def table() -> Mesh:
    """A table top of three boxes side by side, .02 thick, its top at z = 0."""
    boards = [(Box([0.4, 0.4, 0.02]), pose([x, 0, -0.01])) for x in (-0.4, 0, 0.4)]
    shape, at = one_body(boards, "table", [])
    assert isinstance(shape, Mesh)
    assert at == Pose()
    return shape


@pytest.mark.parametrize("x", [0.0, 0.19, 0.2, 0.225])
@pytest.mark.parametrize("shape", [Box([0.06, 0.06, 0.1]), Cylinder(0.03, 0.1)])
def test_sunk_objects_leave_a_compound_through_its_top(shape: Shape, x: float) -> None:
    found = points((table(), pose([0, 0, 0])), (shape, pose([x, 0.01, 0.05 - 0.014])))
    np.testing.assert_allclose(found.normal, np.tile([0.0, 0, 1], (len(found), 1)), atol=1e-12)
    np.testing.assert_allclose(found.gap, -0.014, atol=1e-15)
    assert np.ptp(found.point[:, 0]) > 0.02


def test_a_frustum_sunk_into_a_corner_of_a_compound_leaves_both_of_its_faces() -> None:
    """Its lowest corner on each face lies inside of the other piece, which it overlaps as deep.

    The far side of the thin plate is no exit.
    """
    base = Box([0.4, 0.4, 0.02]), pose([0, 0, 0.01])
    wall = Box([0.02, 0.4, 0.15]), pose([-0.19, 0, 0.075])
    shape, at = one_body([base, wall], "bin", [])
    turn = Rotation.from_euler("xyz", [-1e-3, -2e-3, 1e-3])
    corners = np.array([[x, y, z] for z, a in ((-0.05, 0.03), (0.05, 0.02))
                        for x in (-a, a) for y in (-a, a)])  # fmt: skip
    low = turn.apply(corners).min(axis=0)
    place = pose([-0.18 - 6e-5 - low[0], 0, 0.02 - 1e-4 - low[2]], turn)
    found = points((shape, at), (Mesh(*hull_surface(corners)), place), reach=1e-4)
    up, aside = found.normal[:, 2] > 0.9, found.normal[:, 0] > 0.9
    assert (up | aside).all()
    assert found.gap[up].min() == pytest.approx(-1e-4, rel=1e-2)
    assert found.gap[aside].min() == pytest.approx(-6e-5, rel=1e-2)


def test_seams_hold_nothing_up() -> None:
    block = Box([0.06, 0.06, 0.1])
    for x in (0.165, 0.18, 0.2, 0.21):
        for height in (0.05, 0.051):
            found = points((table(), pose([0, 0, 0])), (block, pose([x, 0, height])))
            assert (found.normal[:, 2] > 1 - 1e-12).all()
            np.testing.assert_allclose(np.ptp(found.point[:, 0]), 0.06, atol=1e-12)


@pytest.mark.slow
def test_tiles_of_a_slab_give_the_points_of_the_slab() -> None:
    rng = np.random.default_rng(3)
    boards = [
        (Box([0.4, 0.3, 0.1]), pose([0.4 * i, 0.3 * j, -0.05]))
        for i in (-1, 0, 1)
        for j in (-1, 0, 1)
    ]
    tiles = one_body(boards, "tiles", [])[0]
    shapes = [Box([0.3, 0.2, 0.1]), Sphere(0.1), Cylinder(0.1, 0.2)]
    for _ in range(25):
        shape, turn = shapes[rng.integers(3)], Rotation.random(random_state=int(rng.integers(1000)))
        place = [rng.uniform(-0.4, 0.4), rng.uniform(-0.3, 0.3), 0]
        low = height_along(shape, pose([0, 0, 0], turn), np.array([0, 0, -1.0]))
        place[2] = low + rng.uniform(-0.02, 0.02)
        whole = points((Box([1.2, 0.9, 0.1]), pose([0, 0, -0.05])), (shape, pose(place, turn)))
        parts = points((tiles, pose([0, 0, 0])), (shape, pose(place, turn)))
        np.testing.assert_allclose(parts.gap.min(), whole.gap.min(), atol=1e-12)
        np.testing.assert_allclose(parts.gap.min(), place[2] - low, atol=1e-12)
        np.testing.assert_allclose(parts.normal[:, 2], 1, atol=1e-12)


def test_block_in_the_corner_of_a_tray() -> None:
    boards = [(Box([0.4, 0.4, 0.02]), pose([0, 0, -0.01]))]
    boards += [(Box([0.02, 0.4, 0.1]), pose([x, 0, 0.03])) for x in (-0.21, 0.21)]
    tray = one_body(boards, "tray", [])[0]
    found = points((tray, pose([0, 0, 0])), (Box([0.06, 0.06, 0.1]), pose([0.17, 0, 0.05])))
    assert len(found) == 8
    np.testing.assert_allclose(found.gap, 0, atol=1e-15)
    up = found.normal[:, 2] > 0.5
    assert up.sum() == 4
    np.testing.assert_allclose(found.normal[~up], np.tile([-1.0, 0, 0], (4, 1)), atol=1e-15)


@pytest.mark.parametrize("gap", [-1e-4, 0.0, 1e-9])
def test_an_edge_over_the_corner_of_two_walls_stays_apart_from_both(gap: float) -> None:
    """The edge of a wedge leaves the corner over the rims of both walls, which cross there."""
    walls = [(Box([0.02, 0.4, 0.1]), pose([-0.01, 0.18, -0.05])),
             (Box([0.4, 0.02, 0.1]), pose([0.18, -0.01, -0.05]))]  # fmt: skip
    tray = one_body(walls, "walls", [])[0]
    edge = 0.02 * np.array([-1, -1, 2])
    wedge = Mesh(*hull_surface(np.array([edge, -edge, [0.1, 0.03, 0.06], [0.03, 0.1, 0.06]])))
    found = points((tray, pose([0, 0, 0])), (wedge, pose([gap, gap, 0])), reach=1e-3)
    normals = np.array([[2, 0, 1], [0, 2, 1]]) / np.sqrt(5)
    for towards in 1e-3 * np.array([[-1, 1, 0], [1, -1, 0]]):
        assert (found.gap + found.normal @ towards).min() < -4e-4
    away = 2 * abs(gap) * normals.sum(axis=0)
    assert (found.gap + found.normal @ away).min() > -1e-12


def test_far_pieces_in_other_directions_are_kept() -> None:
    boards = [
        (Box([0.6, 0.02, 0.6]), pose([0, 0.31, 0])),
        (Box([0.6, 0.6, 0.02]), pose([0, 0, -0.31])),
    ]
    shelf = one_body(boards, "shelf", [])[0]
    block = (Box([0.1, 0.1, 0.1]), pose([0, 0.245, -0.05]))
    found = points((shelf, pose([0, 0, 0])), block, reach=0.3)
    up = found.normal[:, 2] > 1 - 1e-12
    np.testing.assert_allclose(found.gap[up], 0.2, atol=1e-15)
    np.testing.assert_allclose(found.gap[~up], 0.005, atol=1e-15)
    assert up.sum() == 4
    assert (~up).sum() == 4


def test_pieces_behind_others_wait_until_the_parts_come_nearer() -> None:
    boards = [(Box([0.6, 0.6, 0.02]), pose([0, 0, -0.2 * k])) for k in range(3)]
    shelf = Mesh(*surface(CUBE), members=boards)
    block = Box([0.1, 0.1, 0.1])
    for height, gap in ((0.1, 0.04), (-0.1, 0.04)):
        found = points((shelf, pose([0, 0, 0])), (block, pose([0, 0, height])), reach=1.0)
        below = found.normal[:, 2] > 0
        np.testing.assert_allclose(found.gap[below], gap, atol=1e-15)
        assert below.sum() == 4


def test_bowl_of_boxes_over_a_ramekin_of_boxes() -> None:
    def ring(count: int, radius: float, height: float) -> list[tuple[Shape, Pose]]:
        wall = Box([0.008, 2.1 * np.pi * radius / count, height])
        turns = [Rotation.from_euler("z", 2 * np.pi * k / count) for k in range(count)]
        return [(wall, pose(turn.apply([radius, 0, height / 2]), turn)) for turn in turns]

    floor = (Box([0.1, 0.1, 0.006]), pose([0, 0, 0.003]))
    upper = one_body([floor, *ring(39, 0.08, 0.05)], "bowl", [])[0]
    lower = one_body([floor, *ring(24, 0.06, 0.04)], "ramekin", [])[0]
    found = points((lower, pose([0, 0, 0])), (upper, pose([0, 0, 0.0401])), reach=0.002)
    carrying = found.bears & (np.abs(found.gap - 1e-4) < 1e-12)
    assert carrying.any()
    assert found.gap.min() > 0
    assert (found.normal[carrying, 2] > 1 - 1e-12).all()


def test_parts_that_convex_pieces_do_not_cover() -> None:
    ell = Prism([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], 1.0)
    assembly, _, _ = scene((ell, pose([0, 0, 0])), (CUBE, pose([5, 0, 0])))
    pieces = convex_pieces(assembly)
    assert pieces.whole.tolist() == [False, True]
    assert pieces.part.tolist() == [1]


def test_coplanar_triangles_become_faces() -> None:
    mesh = Mesh(*surface(CUBE))
    pieces = convex_pieces(scene((mesh, pose([0, 0, 0])))[0])
    assert len(pieces.normal) == 6
    assert len(pieces.edge) == 12


@pytest.mark.parametrize(("dent", "whole"), [(0.0, True), (1e-6, True), (1e-4, False)])
def test_a_mesh_in_single_precision_may_be_dented_by_its_rounding(dent: float, whole: bool) -> None:
    """A frustum whose sides are divided along the lower diagonal by the dent of a corner."""
    ring = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])
    low, high = (np.column_stack([r * ring, np.full(4, z)]) for r, z in ((2.0, 0.0), (1.0, 1.0)))
    middle = (low[0] + high[1]) / 2 + np.array([0, dent, 0])
    corners = np.vstack([low, high, middle]).astype(np.float32)
    sides = [[0, 1, 8], [1, 5, 8], [5, 4, 8], [4, 0, 8]]
    sides += [[a, b, c] for k in (1, 2, 3) for a, b, c in
              ((k, (k + 1) % 4, 4 + (k + 1) % 4), (k, 4 + (k + 1) % 4, 4 + k))]  # fmt: skip
    mesh = Mesh(corners, np.array([*sides, [0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7]]))
    assert convex_pieces(scene((mesh, pose([0, 0, 0])))[0]).whole.tolist() == [whole]


def test_the_larger_reach_of_two_parts_counts_and_pairs_that_have_not_moved_are_left_out() -> None:
    stack = [(CUBE, pose([0, 0, 1.01 * k])) for k in range(4)]
    assembly, rotation, position = scene(*stack)
    pieces = convex_pieces(assembly)

    def pairs(reach: list[float], moved: list[bool] | None = None) -> set[tuple[int, int]]:
        which = None if moved is None else np.array(moved)
        found = near_points(pieces, rotation, position, np.array(reach), NONE, None, which)
        return set(zip(found.part_a.tolist(), found.part_b.tolist(), strict=True))

    assert pairs([0.0099, 0.0101, 0, 0]) == {(0, 1), (1, 2)}
    assert pairs([0.0099] * 4) == set()
    assert pairs([0.02] * 4, [False, False, False, True]) == {(2, 3)}


def test_no_pieces() -> None:
    ell = Prism([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], 1.0)
    assembly, rotation, position = scene((ell, pose([0, 0, 0])))
    assert len(near_points(convex_pieces(assembly), rotation, position, 1.0, NONE)) == 0


def test_ignored_pairs() -> None:
    parts = [(CUBE, pose([0, 0, k])) for k in range(3)]
    assembly, rotation, position = scene(*parts)
    pieces = convex_pieces(assembly)
    found = near_points(pieces, rotation, position, 0.01, np.array([[1, 0]]))
    assert set(zip(found.part_a.tolist(), found.part_b.tolist(), strict=True)) == {(1, 2)}
