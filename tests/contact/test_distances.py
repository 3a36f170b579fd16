"""Near boxes, distances of triangles, coverings, refined bodies and copies."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from solids import bolt, bore, cone_frustum, mesh_of, peg, pin, socket, torus, trough

import kilter
from kilter import Assembly, Box, Cylinder, Part, Pose, Sphere
from kilter.arrays import Array
from kilter.assembly.geometry import refine
from kilter.assembly.mesh_surface import polyhedron_moments
from kilter.contact import ContactSet, Tolerance, contacts, detect, pair_findings
from kilter.contact.common import broad, distances
from kilter.contact.common import facets as planar_facets
from kilter.contact.common.broad import make_boxes, part_pairs
from kilter.contact.common.distances import (
    PartSolids,
    TriangleTrees,
    near_triangles,
    nearest_to_group,
    surface_distance,
)
from kilter.contact.common.facets import find_facets
from kilter.contact.common.patches import SAME_BODY
from kilter.contact.contact_tolerances import SAME_PLACE
from kilter.contact.kept_contacts import KeptContacts
from kilter.contact.overlap import _farthest, _inside_solid, inside_part
from kilter.errors import InputError
from kilter.scenes.pieces import block, tube
from kilter.shape import closed
from kilter.shape.covering import FaceCover, covered
from kilter.shape.shape_tolerances import GRAZING


def crowd(rng, owners):
    """Boxes of some owners, of any size, anywhere."""
    count = int(rng.integers(1, 200))
    owner = np.sort(rng.integers(0, owners, count))
    low = rng.random((count, 3))
    return owner, low, low + rng.random((count, 3)) * rng.choice([0.0, 0.02, 0.4], (count, 1))


@pytest.mark.slow
@pytest.mark.parametrize("most", [0, 100, 10**9], ids=["trees", "both", "products"])
def test_joins_of_random_boxes_are_those_of_all_pairs(most, monkeypatch):
    rng = np.random.default_rng(7)
    monkeypatch.setattr(broad, "MANY", most)
    monkeypatch.setattr(broad, "TREE", 150)
    for _ in range(60):
        owners = int(rng.integers(1, 6))
        scale, shift = 10.0 ** rng.uniform(-6, 4), rng.normal(size=3) * 10.0 ** rng.uniform(-2, 6)
        sides = [crowd(rng, owners), crowd(rng, owners)]
        (one, low_a, high_a), (other, low_b, high_b) = (
            (owner, low * scale + shift, high * scale + shift) for owner, low, high in sides
        )
        margin = rng.random(owners) * scale * 0.02
        found = []
        for owner, x, y in broad.joins(one, (low_a, high_a), other, (low_b, high_b), margin):
            found += list(zip(owner.tolist(), x.tolist(), y.tolist(), strict=True))
        grow = margin[one][:, None]
        meets = one[:, None] == other
        meets &= ((low_a - grow)[:, None] <= high_b).all(axis=2)
        meets &= (low_b <= (high_a + grow)[:, None]).all(axis=2)
        x, y = np.nonzero(meets)
        expected = zip(one[x].tolist(), x.tolist(), y.tolist(), strict=True)
        assert sorted(found) == sorted(expected)


def sampled(triangle, rng, count=4000):
    """Points of a triangle, its corners and sides among them."""
    weights = rng.dirichlet([0.6, 0.6, 0.6], count)
    weights[:3] = np.eye(3)
    weights[3:300, 0] = 0.0
    weights /= weights.sum(axis=1)[:, None]
    return weights @ triangle


@pytest.mark.slow
def test_distance_from_a_surface_is_that_of_its_nearest_point():
    rng = np.random.default_rng(3)
    for _ in range(20):
        soup = rng.normal(size=(12, 3, 3)) * rng.choice([0.1, 1.0], (12, 1, 1))
        points = rng.normal(size=(30, 3)) * 2
        exact = surface_distance(points, soup)
        cloud = np.concatenate([sampled(triangle, rng) for triangle in soup])
        rough = np.linalg.norm(points[:, None] - cloud, axis=2).min(axis=1)
        assert (exact <= rough + 1e-12).all()
        assert (rough - exact <= 0.1).all()


@pytest.mark.slow
def test_triangles_that_come_near_are_those_whose_points_do():
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(5)
    seen = {True: 0, False: 0}
    for _ in range(50):
        one, other = rng.normal(size=(2, 3, 3))
        other += rng.normal(size=3) * 1.5
        cloud = cKDTree(sampled(one, rng))
        least = float(cloud.query(sampled(other, rng))[0].min())
        for reach in (0.05, 0.3, 1.0):
            near = near_triangles(one[None], other[None], reach)
            if least <= reach:
                assert len(near) == 1
                off = surface_distance(near, one[None])[0], surface_distance(near, other[None])[0]
                assert max(off) <= reach / 2 + 1e-9
            elif least > reach + 0.1:
                assert len(near) == 0
            seen[bool(len(near))] += 1
    assert min(seen.values()) > 10


def piled(count: int, apart: float, floor: bool = False) -> kilter.Assembly:
    """Cubes in a row, on a floor that comes first."""
    parts = [
        kilter.Part(f"c{k}", kilter.Box([1, 1, 1]), kilter.Pose([k * apart, 0, 0.5]))
        for k in range(count)
    ]
    size = [2 * count * max(apart, 1), 3, 1]
    held = [kilter.Part("floor", kilter.Box(size), kilter.Pose([0, 0, -0.5]), grounded=True)]
    return kilter.Assembly([*(held if floor else []), *parts])


def pairs_of(assembly: kilter.Assembly) -> int:
    geometry = assembly.geometry
    boxes = make_boxes(geometry, find_facets(geometry))
    return len(part_pairs(boxes, geometry.grounded, np.zeros(len(assembly))))


@pytest.mark.slow
def test_parts_that_all_lie_in_one_another_are_refused():
    """Before their pairs are listed: a file of 1 MB could ask for all of the memory."""
    assert pairs_of(piled(1000, 0.0)) == 1000 * 999 // 2
    for count in (1002, 5000):
        with pytest.raises(InputError, match="overlap: too many"):
            pairs_of(piled(count, 0.0))


@pytest.mark.slow
def test_a_floor_under_many_parts_is_no_crowd():
    assert pairs_of(piled(20_000, 2.0, floor=True)) == 20_000


def test_sides_of_boxes_are_the_facets_that_their_triangles_give(monkeypatch):
    rng = np.random.default_rng(3)
    parts = [
        kilter.Part(
            f"box-{k}",
            kilter.Box(10.0 ** rng.uniform(-2, 2, 3)),
            kilter.Pose(rng.normal(size=3) * 10, rng.normal(size=4)),
            grounded=k == 0,
        )
        for k in range(30)
    ]
    geometry = kilter.Assembly(parts).geometry
    closed = find_facets(geometry)
    blocks = [planar_facets._convex_block(closed.part, closed.corners.reshape(-1, 4))]
    general = planar_facets._assemble_facets(geometry, blocks, geometry.is_box.copy())
    for name in planar_facets.Facets.__slots__:
        one, other = getattr(closed, name), getattr(general, name)
        assert one.dtype == other.dtype
        assert np.allclose(one, other, rtol=1e-12, atol=1e-12), name
    wedge = kilter.Part("wedge", kilter.Prism([(0, 0), (1, 0), (0, 1)], 1), [50, 0, 0])
    both = find_facets(kilter.Assembly([*parts, wedge]).geometry)
    assert np.array_equal(both.normal[:180], closed.normal)
    assert np.array_equal(both.origin[:180], closed.origin)


def _scene(seed: int) -> tuple[Array, Array]:
    """Random points, and triangles whose sizes differ by a factor of up to 10,000."""
    rng = np.random.default_rng(seed)
    count, number = rng.integers(1, 60, 2)
    size = 10.0 ** rng.uniform(-4, 0, (number, 1, 1))
    triangles = rng.normal(size=(number, 3, 3)) * size + rng.normal(size=(number, 1, 3))
    return 2 * rng.normal(size=(count, 3)), triangles


def _least_by_sampling(point: Array, triangle: Array) -> float:
    """Distance of a point from a triangle by a search over its barycentric coordinates."""
    low, step = np.zeros(2), 1.0
    for _ in range(60):
        grid = low + step * np.stack(np.meshgrid(*[np.linspace(-1, 1, 9)] * 2), -1).reshape(-1, 2)
        grid = grid[(grid >= 0).all(axis=1) & (grid.sum(axis=1) <= 1)]
        places = triangle[0] + grid @ (triangle[1:] - triangle[0])
        off = np.linalg.norm(places - point, axis=1)
        low, step = grid[off.argmin()], step * 0.7
    return float(off.min())


@pytest.mark.quick(6)
@pytest.mark.parametrize("seed", range(20))
def test_the_nearest_of_all_triangles_counts(seed):
    points, triangles = _scene(seed)
    each = np.array([surface_distance(points, triangle[None]) for triangle in triangles])
    assert surface_distance(points, triangles) == pytest.approx(each.min(axis=0), rel=1e-14)


def test_the_distance_from_a_triangle_agrees_with_a_search_over_its_points():
    points, triangles = _scene(3)
    for point, triangle in zip(points[:12], triangles[:12], strict=False):
        exact = surface_distance(point[None], triangle[None])[0]
        assert exact == pytest.approx(_least_by_sampling(point, triangle), rel=1e-6)


@pytest.mark.parametrize("seed", range(20))
def test_points_within_a_distance_agree_with_the_distances(seed):
    points, triangles = _scene(seed)
    distance = surface_distance(points, triangles)
    for reach in np.quantile(distance, [0.0, 0.3, 0.8]).tolist():
        clear = np.abs(distance - reach) > 1e-12
        within = TriangleTrees(triangles).within(points, reach)
        assert (within == (distance <= reach))[clear].all()


def test_an_upper_bound_is_never_exceeded():
    points, triangles = _scene(5)
    bound = np.full(len(points), 0.1)
    distance = surface_distance(points, triangles, bound)
    assert distance == pytest.approx(np.minimum(surface_distance(points, triangles), 0.1))


@pytest.mark.parametrize("seed", range(20))
def test_distances_above_the_sufficient_one_are_exact(seed):
    points, triangles = _scene(seed)
    exact = surface_distance(points, triangles)
    bound = exact + np.random.default_rng(seed).random(len(points))
    for enough in np.quantile(exact, [0.0, 0.5, 1.0]).tolist():
        distance = TriangleTrees(triangles).distance(points, bound, enough=enough)
        above = exact > enough
        assert distance[above] == pytest.approx(exact[above], rel=1e-14)
        assert (distance[~above] <= bound[~above]).all()
        assert (distance[~above] >= exact[~above] * (1 - 1e-14)).all()


def around_a_ring() -> Assembly:
    """A wide ring, with small boxes in it and beside it, within the box around the ring."""
    places = [(0, 0, 0), (1, 0.5, 0), (-1.5, 1, 0.2), (3.5, 3.5, 0), (-3.5, 3.6, 0)]
    boxes = [Part(f"box {k}", Box([0.3, 0.4, 0.5]), Pose(at)) for k, at in enumerate(places)]
    return Assembly([Part("ring", mesh_of(torus(4.0, 0.5, sides=12, pieces=8))), *boxes])


def test_gaps_are_searched_below_the_distance_of_the_nearest_corners(monkeypatch):
    geometry, limits = around_a_ring().geometry, []
    solids, measure = PartSolids(geometry), distances._gap

    def recorded(*given):
        limits.append(given[3])
        return measure(*given)

    monkeypatch.setattr(distances, "_gap", recorded)
    for group in ([1], [4], [2, 3], [0, 5]):
        near = nearest_to_group(solids, np.array(group), geometry.part_boxes)
        others = np.setdiff1d(np.arange(6), group).tolist()
        gaps = {(a, b): measure(solids, a, b, np.inf) for a in group for b in others}
        assert (near.part, near.other) == min(gaps, key=gaps.get)
        assert near.gap == pytest.approx(min(gaps.values()), rel=1e-12)
    assert np.isfinite(limits).all()


@pytest.mark.parametrize(
    "shape", [mesh_of(torus(sides=24, pieces=12)), Box([2, 1, 1]), mesh_of(socket())]
)
def test_rays_find_the_points_that_a_surface_winds_about(shape):
    geometry = Assembly([Part("a", shape, Pose([5, 0, 0]))]).geometry
    low, high = (side[0] for side in geometry.part_boxes)
    points = low + (high - low) * np.random.default_rng(6).uniform(-0.1, 1.1, (60, 3))
    points = np.concatenate([points, (low + high)[None] / 2, np.round(points, 1) + 1e-6])
    inside, doubtful = _inside_solid(PartSolids(geometry).of(0), points - geometry.center[0])
    assert doubtful.sum() < 5
    assert 10 < inside.sum() < 110
    assert np.array_equal(inside[~doubtful], inside_part(geometry, 0, points)[~doubtful])


def test_rounding_decides_only_about_points_on_the_surface():
    solid = PartSolids(Assembly([Part("a", Box([2, 2, 2]))]).geometry).of(0)
    points = np.array([[0.3, 0.4, z] for z in (1 - 1e-6, 1.0, 1 + 1e-6)])
    inside, doubtful = _inside_solid(solid, points)
    assert doubtful.tolist() == [False, True, False]
    assert inside[[0, 2]].tolist() == [True, False]


def test_open_edges_are_searched_only_in_meshes_that_are_open(monkeypatch):
    searched = []
    monkeypatch.setattr(
        closed, "_boundary_edges", lambda rows: searched.append(len(rows)) or rows[:0, :2]
    )
    geometry = Assembly([Part("a", Box([1, 1, 1]))]).geometry
    vertices, triangles, notes = closed.weld(geometry.vertices, geometry.triangles)
    assert (len(vertices), len(triangles), notes, searched) == (8, 12, [], [])
    closed.weld(geometry.vertices, geometry.triangles[1:])
    assert searched[0] == 11


def covered_by_all(triangles, points, normals, reach, grow):
    """The definition: the line x + t n meets a triangle with sides moved outwards by `grow`."""
    result = np.zeros(len(points), dtype=bool)
    for k, (x, n) in enumerate(zip(points, normals, strict=True)):
        for corners in triangles:
            upright = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            upright /= np.linalg.norm(upright)
            along = n @ upright
            if abs(along) < GRAZING:
                continue
            t = (corners[0] - x) @ upright / along
            foot = x + t * n
            inside = abs(t) <= reach + grow
            for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
                inward = np.cross(upright, end - start)
                inside &= (foot - start) @ inward / np.linalg.norm(inward) >= -grow
            result[k] |= inside
    return result


@pytest.mark.quick(1)
@pytest.mark.parametrize("grow", [0.0, 0.02, 0.3])
@pytest.mark.parametrize("flatness", [1.0, 0.02])
@pytest.mark.slow
def test_pruned_triangles_cover_what_all_triangles_cover(flatness, grow):
    """Also for slivers, whose tips move outwards by many times `grow`."""
    rng = np.random.default_rng(7)
    triangles = rng.normal(size=(40, 3, 3)) * [1.0, flatness, 0.1]
    points = rng.normal(size=(200, 3)) * [1.5, 2 * flatness + grow, 0.1]
    normals = rng.normal(size=(200, 3)) * [0.2, 0.2, 1.0]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    expected = covered_by_all(triangles, points, normals, 0.5, grow)
    assert 0 < expected.sum() < len(points)
    # a point far away widens the box of all points, so that only the pairs are pruned
    far = np.vstack([points, [50.0, 0, 0], [-50.0, 0, 0]])
    lines = np.vstack([normals, np.eye(3)[[2, 2]]])
    assert covered(triangles, far, lines, 0.5, grow)[:-2].tolist() == expected.tolist()


def test_the_tip_of_a_sliver_moves_by_its_pointedness():
    """The sides of a right isosceles triangle moved by s move its sharp tips by s / sin(pi / 8)."""
    cover = FaceCover.of(np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]]))
    assert cover.pointed[0] >= 1 / np.sin(np.pi / 8)
    assert cover.pointed[0] == pytest.approx(np.sqrt(2) * (2 + np.sqrt(2)))


SHAPES = {
    "ball": (Sphere(1.0), 4 / 3 * np.pi),
    "cylinder": (Cylinder(1.0, 3.0), 3 * np.pi),
    "ring": (bore(), 16 * np.pi),
    "torus": (torus(), 2 * np.pi**2 * 2.0 * 0.25),
    "frustum": (cone_frustum(), np.pi / 3 * np.tan(0.4) ** 2 * 26),
    "bolt": (bolt(), np.pi * (3 + 1.5**2 * 0.5)),
    "trough": (trough(), None),
    "socket": (socket(rim=-0.3), None),
}


def volume_of(vertices, triangles):
    return float(polyhedron_moments(vertices, triangles, np.array([0, len(triangles)]))[0][0])


@pytest.mark.slow
@pytest.mark.parametrize("name", SHAPES)
def test_finer_triangles_close_in_on_the_exact_body_and_stay_closed(name):
    shape, exact = SHAPES[name]
    turn = Rotation.from_rotvec([0.3, -0.7, 0.4]).as_quat()[[3, 0, 1, 2]]
    geometry = Assembly([Part("other", Box([1, 1, 1])), Part("a", shape, Pose([5, 6, 7], turn))])
    geometry = geometry.geometry
    whole = np.full(3, -99.0), np.full(3, 99.0)
    volumes = []
    for rounds in range(3):
        vertices, triangles = refine(geometry, 1, rounds, whole)
        sides = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        there = {tuple(side) for side in sides.tolist()}
        assert len(there) == len(sides)
        assert {(q, p) for p, q in there} == there
        volumes.append(volume_of(vertices, triangles))
    if exact is not None:
        off = np.abs(np.array(volumes) - exact)
        assert off[2] < off[0] / 12
    else:  # each round leaves a quarter of the missing volume
        assert volumes[1] - volumes[0] == pytest.approx(4 * (volumes[2] - volumes[1]), rel=0.1)


def test_only_what_comes_within_the_box_is_cut():
    geometry = Assembly([Part("a", Cylinder(1.0, 3.0))]).geometry
    none = np.array([2.0, 0, 0]), np.array([3.0, 1, 1])
    vertices, triangles = refine(geometry, 0, 2, none)
    assert len(triangles) == len(geometry.triangles)
    some = np.array([0.9, -0.1, 1.4]), np.array([1.1, 0.1, 1.6])
    vertices, triangles = refine(geometry, 0, 2, some)
    assert len(geometry.triangles) < len(triangles) < 3 * len(geometry.triangles)
    assert np.hypot(*vertices[:, :2].T).max() == pytest.approx(1.0, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("apart", [0.5, 1.5, 1.9])
def test_lens_of_two_balls(apart):
    parts = [Part("a", Sphere(1.0), grounded=True), Part("b", Sphere(1.0), Pose([0, 0, apart]))]
    (overlap,) = detect.contacts(Assembly(parts)).overlaps
    lens = np.pi / 12 * (4 + apart) * (2 - apart) ** 2
    assert overlap.volume == pytest.approx(lens, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("depth", [0.05, 0.3])
def test_cap_of_a_ball_and_segment_of_a_cylinder_in_a_slab(depth):
    slab = Part("slab", Box([9, 9, 2]), Pose([0, 0, -1]), grounded=True)
    ball = Part("part", Sphere(1.0), Pose([0, 0, 1 - depth]))
    bar = Part("part", peg(), Pose([0, 0, 1 - depth], [np.sqrt(0.5), np.sqrt(0.5), 0, 0]))
    cap = np.pi * depth**2 * (3 - depth) / 3
    half = np.arccos(1 - depth)
    segment = (half - np.sin(half) * np.cos(half)) * 4.0
    for part, volume in ((ball, cap), (bar, segment)):
        (overlap,) = detect.contacts(Assembly([slab, part])).overlaps
        assert overlap.volume == pytest.approx(volume, rel=0.01)


def test_meshes_are_measured_as_they_are():
    mesh = mesh_of(peg(sides=12))
    geometry = Assembly([Part("a", mesh)]).geometry
    whole = np.full(3, -99.0), np.full(3, 99.0)
    finer = volume_of(*refine(geometry, 0, 2, whole))
    assert finer == pytest.approx(float(geometry.volume[0]), rel=1e-12)


BASE = block("base", [-5, -5, -1], [5, 5, 0], grounded=True)
RADIUS, HEIGHT = 0.7, 2.0


def twice(off: float = 0.0) -> Assembly:
    """A tube with a pin and its copy, which is moved by `off`, on a base."""
    ring = tube("ring", 1.0, 2.0, 2.0, at=[0, 0, 1])
    pins = [pin(name, RADIUS, HEIGHT, [x, 0, 1]) for name, x in (("pin", 0.0), ("copy", off))]
    return Assembly([BASE, ring, *pins])


def of_pair(found: ContactSet) -> int:
    """Number of patches and records, except overlaps, of the pair pin and copy."""
    names = found.assembly.names
    pair = {names.index("pin"), names.index("copy")}
    records = [*found.patch_parts.tolist(), *(r.parts for r in found.unsupported)]
    records += [r.parts for r in found.rejected]
    return sum(set(parts) == pair for parts in records)


def written(found: ContactSet) -> str:
    return json.dumps(found.to_dict())


def test_the_copy_of_a_round_pin_is_an_overlap_with_its_exact_volume():
    found = contacts(twice())
    (overlap,) = found.overlaps
    assert overlap.why == SAME_BODY
    assert overlap.volume == pytest.approx(np.pi * RADIUS**2 * HEIGHT, rel=1e-12)
    assert overlap.share == 1.0
    assert of_pair(found) == 0
    kinds = {frozenset(pair.parts): pair.kind for pair in found.open_pairs}
    assert kinds[frozenset(overlap.parts)] == "overlap"


def test_other_contacts_are_those_without_the_copy():
    assembly = twice()
    alone = contacts(assembly.without(["copy"]))
    found = contacts(assembly)
    kept = ~(found.patch_parts == assembly.names.index("copy")).any(axis=1)
    assert kept.sum() == len(alone.patch_area)
    assert np.array_equal(found.patch_area[kept], alone.patch_area)


@pytest.mark.slow
def test_both_sides_of_the_limit_between_a_copy_and_an_overlap():
    size = float(twice().geometry.size[2])
    near, far = (contacts(twice(share * SAME_PLACE * size)) for share in (0.5, 2.0))
    assert [overlap.why for overlap in near.overlaps] == [SAME_BODY]
    assert [overlap.why for overlap in far.overlaps] == ["overlap"]


def test_a_copy_thinner_than_the_tolerance_is_no_overlap():
    sheets = [block(name, [0, 0, 0], [1, 1, 0.01]) for name in ("one", "two")]
    assembly = Assembly([BASE, *sheets])
    assert [o.why for o in contacts(assembly, tolerance=Tolerance(gap=0.009)).overlaps] == [
        SAME_BODY
    ]
    assert contacts(assembly, tolerance=Tolerance(gap=0.011)).overlaps == ()


@pytest.mark.slow
def test_a_copy_under_a_time_limit_and_in_kept_contacts(monkeypatch):
    assembly, tolerance = twice(), Tolerance()
    more = Assembly([*assembly.parts, Part("third", assembly["pin"].shape, Pose([0, 0, 1]))])
    kept = KeptContacts.find(more, tolerance)
    for other in (more, more.without(["pin"]), more.with_grounded(["base", "pin", "copy"])):
        assert written(kept.contacts(other)) == written(detect.contacts(other, tolerance=tolerance))
    monkeypatch.setattr(pair_findings, "FIRST_BATCH", 1)
    monkeypatch.setattr(pair_findings, "GROWTH", 1.0)
    in_time = contacts(more, time_limit=1000.0)
    assert in_time.to_dict()["overlaps"] == contacts(more).to_dict()["overlaps"]
    assert len(in_time.overlaps) == 3


@pytest.mark.parametrize("least", [0.0, 0.9, 5.0])
def test_the_farthest_of_many_points_from_long_narrow_triangles(least):
    ends = np.linspace(0.0, 1.0, 60)
    tips = np.column_stack([ends, np.full(60, 30.0), 0 * ends])
    fan = np.stack([np.zeros((59, 3)), tips[1:], tips[:-1]], axis=1)
    points = np.random.default_rng(2).uniform([-1, -1, -1], [2, 31, 1], (3000, 3))
    farthest = surface_distance(points, fan).max()
    assert 0.9 < farthest < 5.0
    for patch in (fan[:0], fan[:7], fan):
        assert _farthest(points, patch, fan, least) == max(least, farthest)
    assert _farthest(points[:0], fan, fan, least) == least


def test_boxes_of_a_large_part_are_compared_as_those_of_small_parts(monkeypatch):
    rng = np.random.default_rng(3)
    least, start = rng.random((90, 3)), np.array([0, 20, 20, 90])
    boxes = least, least + rng.random((90, 3)) / 4
    low, part = rng.random((30, 3)), rng.integers(0, 3, 30)
    both = [broad.boxes_in(start, part, (low, low + 0.2), boxes)]
    monkeypatch.setattr(broad, "LARGE", 25)
    both.append(broad.boxes_in(start, part, (low, low + 0.2), boxes))
    assert len(both[0][0])
    assert np.array_equal(*both)


def test_endless_lines_meet_the_triangles_that_a_search_of_all_finds():
    rng = np.random.default_rng(4)
    triangles = rng.random((200, 3, 3)) / 4 + rng.random((200, 1, 3))
    triangles[7, 2] = triangles[7, 1]  # without an area: its tips are infinitely pointed
    points, normals = rng.random((80, 3)) * 4, rng.normal(size=(80, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    cover, every = FaceCover.of(triangles), np.arange(200)
    met = [
        cover._hits(every, np.tile(x, (200, 1)), np.tile(n, (200, 1)), 1e300, 1e-6).any()
        for x, n in zip(points, normals, strict=True)
    ]
    assert any(met)
    assert not all(met)
    assert cover.covers(points, normals, 1e300, 1e-6).tolist() == met
