"""A scene for each way in which contact searches have failed before."""

from collections import defaultdict
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from oracle import discrepancies
from random_scenes import FAMILIES, Piece, Wrap, block, column, placed, split
from scipy.spatial.transform import Rotation

import kilter.contact
from kilter.assembly import Assembly, Part
from kilter.contact.common.gaps import Tolerance
from kilter.contact.contact_set import ContactSet
from kilter.rigid import Pose
from kilter.shape.primitives import BOX_CORNERS, Box, Mesh, Prism, surface
from sampled import sampled

Array = NDArray[np.float64]

P = [
    [0.32599860322670504, 1.6681168423054569],
    [-0.8156548093098657, -1.1061627913370513],
    [0.4896562060831605, -0.5619540509684056],
]
Q = [
    [0.32599860322670504, 1.6681168423054569],
    [-0.05455253428548508, 0.7433569644246211],
    [-0.9793124121663216, 1.1239081019368111],
]
"""Triangles with disjoint interiors for whose overlap GEOS 3.14.1 gives the area 0.5."""


def scene(*pieces: Piece) -> Assembly:
    return Assembly([Part(f"p{k}", s, Pose(o)) for k, (s, o) in enumerate(pieces)])


def contacts_of(*pieces: Piece, tolerance: Tolerance | None = None) -> ContactSet:
    return kilter.contact.contacts(scene(*pieces), tolerance=tolerance or Tolerance())


def at_origin(shape) -> Piece:
    return shape, np.zeros(3)


def areas(contacts: ContactSet) -> dict[tuple[int, int], float]:
    """Area of contact of each pair of parts."""
    total: dict[tuple[int, int], float] = defaultdict(float)
    faces = contacts.patch_kind == "plane"
    for (a, b), area in zip(
        contacts.patch_parts[faces].tolist(), contacts.patch_area[faces], strict=True
    ):
        total[min(a, b), max(a, b)] += float(area)
    return dict(total)


def extruded(points: Array, triangles: Array, low: float, high: float) -> Mesh:
    """A flat mesh, triangles turning left, between two heights; it may have holes."""
    points, triangles, count = np.asarray(points), np.asarray(triangles), len(points)
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    inner = np.isin(edges @ [count, 1], edges @ [1, count])
    rim = edges[~inner]
    p, q = rim.T
    sides = [np.column_stack([p, q, q + count]), np.column_stack([p, q + count, p + count])]
    vertices = [np.column_stack([points, np.full(count, z)]) for z in (low, high)]
    return Mesh(np.vstack(vertices), np.vstack([triangles[:, ::-1], triangles + count, *sides]))


def from_quads(points: Array, quads: Array, low: float, high: float) -> Mesh:
    """As `extruded`, of quadrilaterals."""
    quads = np.asarray(quads)
    return extruded(points, np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]), low, high)


def cells(mask: NDArray[np.bool_], low: float, high: float) -> Mesh:
    """The unit cells [i, i+1] x [j, j+1] of a mask between two heights."""
    n, m = mask.shape
    points = np.array(list(product(range(n + 1), range(m + 1))), dtype=float)
    corner = [[i * (m + 1) + j for i, j in product((i, i + 1), (j, j + 1))] for i, j in
              np.argwhere(mask).tolist()]  # fmt: skip
    return from_quads(points, np.array(corner)[:, [0, 2, 3, 1]], low, high)


def annulus(sectors: int, inner: float, outer: float, low: float, high: float, turn=0.0) -> Mesh:
    angle = turn + np.arange(sectors) * (2 * np.pi / sectors)
    circle = np.column_stack([np.cos(angle), np.sin(angle)])
    k = np.arange(sectors)
    j = (k + 1) % sectors
    quads = np.column_stack([k, k + sectors, j + sectors, j])
    return from_quads(np.vstack([inner * circle, outer * circle]), quads, low, high)


def comb(teeth: int, low: float, high: float) -> Mesh:
    """A bar along x with `teeth` teeth of width 1, 1 apart, that hang down; depth 2 along y."""
    x = np.arange(2 * teeth)
    points = np.array([[i, z] for i in x for z in (low, (low + high) / 2, high)], dtype=float)
    bars = [[3 * i + 1, 3 * i + 4, 3 * i + 5, 3 * i + 2] for i in x[:-1]]
    hanging = [[3 * i, 3 * i + 3, 3 * i + 4, 3 * i + 1] for i in x[:-1:2]]
    flat = from_quads(points, np.array(bars + hanging), -1.0, 1.0)
    return Mesh(flat.vertices[:, [0, 2, 1]], flat.triangles[:, ::-1])


# wrong areas -------------------------------------------------------------------------


@pytest.mark.quick(3)
@pytest.mark.parametrize("splits", [0, 60])
@pytest.mark.parametrize("order", [1, -1])
def test_disjoint_triangles_that_geos_overlaps_do_not_touch(splits, order):
    below, above = (np.array(polygon)[::-1] for polygon in (P, Q)[::order])
    if np.linalg.det(below[1:] - below[0]) < 0:
        below = below[::-1]
    if np.linalg.det(above[1:] - above[0]) < 0:
        above = above[::-1]
    rng = np.random.default_rng(0)
    pieces = [
        at_origin(split(column(polygon, low, low + 1), rng, splits))
        for polygon, low in ((below, -1.0), (above, 0.0))
    ]
    assert len(contacts_of(*pieces)) == 0


@pytest.mark.parametrize("twice", ["faces", "vertices too"])
def test_mesh_listed_twice_counts_once(twice):
    vertices, faces = surface(Box([1, 1, 1]))
    if twice == "faces":
        doubled = Mesh(vertices, np.vstack([faces, faces]))
    else:
        doubled = Mesh(np.vstack([vertices, vertices]), np.vstack([faces, faces + 8]))
    contacts = contacts_of(block([-2, -2, -2], [2, 2, -0.5]), at_origin(doubled))
    assert areas(contacts) == {(0, 1): pytest.approx(1.0, rel=1e-12)}


def test_inside_out_mesh_touches_all_the_same():
    vertices, faces = surface(Box([1, 1, 1]))
    contacts = contacts_of(
        block([-2, -2, -2], [2, 2, -0.5]), at_origin(Mesh(vertices, faces[:, ::-1]))
    )
    assert areas(contacts) == {(0, 1): pytest.approx(1.0, rel=1e-12)}
    (normal,) = contacts.patch_normal * np.sign(np.diff(contacts.patch_parts))
    assert normal == pytest.approx([0, 0, 1], abs=1e-12)


@pytest.mark.quick(3)
@pytest.mark.parametrize("seed", range(6))
def test_quads_split_in_two_facets_by_rounding_keep_their_area(seed):
    # 10-digit files rounded to 1e-3 of their unit: blocks of 50 to 100 with bent quads
    rng = np.random.default_rng(seed)
    turn = Rotation.random(rng=rng).as_matrix()
    boxes = [block([0, 0, 0], [100, 80, 50]), block([30, -20, 50], [90, 50, 100])]
    pieces = []
    for box, origin in boxes:
        vertices, faces = surface(box)
        pieces.append(at_origin(Mesh(np.round((vertices + origin) @ turn.T, 3), faces)))
    contacts = contacts_of(*pieces)
    assert areas(contacts) == {(0, 1): pytest.approx(60 * 50, rel=5e-5)}
    assert discrepancies(scene(*pieces), contacts) == []


@pytest.mark.quick(1)
@pytest.mark.parametrize("size", [4, 12])
@pytest.mark.parametrize("seed", range(5))
def test_interface_with_holes_and_pinches_has_the_right_area(size, seed):
    # up to 32 triangles and more take different ways
    rng = np.random.default_rng(seed)
    below, above = rng.random((2, size, size)) < 0.6
    slab = block([-1, -1, 1], [size + 1, size + 1, 2])
    pieces = [at_origin(cells(below, -1, 0)), at_origin(cells(above, 0, 1)), slab]
    contacts = contacts_of(*pieces)
    expected = {(0, 1): float((below & above).sum()), (1, 2): float(above.sum())}
    assert areas(contacts) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("size", [4, 12])
def test_interface_with_holes_shifted_by_half_a_cell(size):
    below, above = np.random.default_rng(7).random((2, size, size)) < 0.6
    shift = np.array([0.5, 0.25, 0.0])
    pieces = [at_origin(cells(below, -1, 0)), (cells(above, 0, 1), shift)]
    fine = [np.kron(mask, np.ones((2, 4), dtype=bool)) for mask in (below, above)]
    overlap = (fine[0][1:, 1:] & fine[1][:-1, :-1]).sum() / 8
    contacts = contacts_of(*pieces)
    assert areas(contacts) == {(0, 1): pytest.approx(overlap, rel=1e-12)}
    assert discrepancies(scene(*pieces), contacts) == []


def turned(pieces: list[Piece], seed: int) -> Assembly:
    """The pieces in a random pose: edges that met along a line now miss by a rounding."""
    rng = np.random.default_rng(seed)
    rotation, shift = Rotation.random(rng=rng).as_matrix(), rng.normal(size=3) * 10
    return placed(pieces, Wrap(rotation, 1.0, shift, str(rng.choice(["pose", "mesh"]))), rng)


@pytest.mark.quick(3)
@pytest.mark.parametrize("seed", range(12))
def test_faces_that_meet_along_a_bent_line_are_no_patch(seed):
    # slivers of 1e-16 along both lines have a hull of their own, as wide as the bend
    bend = Prism([[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4]], 2)
    pieces = [(bend, np.array([0, -1.0, 0])), block([1, 0, 1], [3, 2, 3])]
    assert len(kilter.contact.contacts(turned(pieces, seed))) == 0


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(12))
def test_line_of_contact_beside_a_patch_does_not_widen_its_hull(seed):
    # an arm of the upper part runs along the rim of the lower one, outside of it
    polygon = [[0, 0.5], [0.5, 0.5], [0.5, 1], [2, 1], [2, 1.5], [0, 1.5]]
    pieces = [(Prism(polygon, 1), np.array([0, 0.5, 0])), block([0, -1, 0], [2, 0, 1])]
    assembly = turned(pieces, seed)
    contacts = kilter.contact.contacts(assembly)
    assert areas(contacts) == {(0, 1): pytest.approx(0.25, rel=1e-12)}
    extent = np.linalg.norm(contacts.points - contacts.points[0], axis=1).max()
    assert extent == pytest.approx(np.sqrt(0.5), rel=1e-9)
    assert discrepancies(assembly, contacts) == []


# slivers -----------------------------------------------------------------------------


def chevron(slices: int, low: float, high: float) -> Mesh:
    """A bent strip of width 1, cut into `slices` thin quads, not convex."""
    x = np.linspace(0, 1, slices + 1)
    bend = np.abs(x - 0.5)
    points = np.vstack([np.column_stack([x, bend]), np.column_stack([x, bend + 1])])
    k = np.arange(slices)
    quads = np.column_stack([k, k + 1, k + 2 + slices, k + 1 + slices])
    return from_quads(points, quads, low, high)


@pytest.mark.quick(1)
@pytest.mark.parametrize("slices", [14, 200])
def test_region_of_thin_triangles_is_not_dropped(slices):
    # every clipped piece is thinner than the tolerance, their union is not
    tolerance = Tolerance(gap=0.04)
    slab = block([-1, -1, -2], [2, 3, 0])
    contacts = contacts_of(at_origin(chevron(slices, 0, 2)), slab, tolerance=tolerance)
    assert areas(contacts) == {(0, 1): pytest.approx(1.0, rel=1e-12)}
    shifted = (chevron(slices, -2, 0), np.array([0.01, 0, 0]))
    contacts = contacts_of(at_origin(chevron(slices, 0, 2)), shifted, tolerance=tolerance)
    assert areas(contacts)[0, 1] == pytest.approx(0.99 - 0.01 * 0.99, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("sectors", [300, pytest.param(1000, marks=pytest.mark.slow)])
def test_two_rings_of_thin_triangles_touch(sectors):
    pieces = [at_origin(annulus(sectors, 1, 1.2, low, low + 2, turn)) for low, turn in
              ((0, 0.0), (-2, np.pi / sectors))]  # fmt: skip
    contacts = contacts_of(*pieces, tolerance=Tolerance(gap=0.01))
    assert areas(contacts) == {(0, 1): pytest.approx(np.pi * 0.44, rel=3e-4)}


def test_strip_thinner_than_the_tolerance_is_no_patch():
    tolerance = Tolerance(gap=1e-3)
    pair = block([0, 0, 0], [1, 1, 1]), block([1 - 1e-3, 0, 1], [2, 1, 2])
    assert len(contacts_of(*pair, tolerance=tolerance)) == 0
    pair = block([0, 0, 0], [1, 1, 1]), block([1 - 4e-3, 0, 1], [2, 1, 2])
    assert areas(contacts_of(*pair, tolerance=tolerance)) == {(0, 1): pytest.approx(4e-3)}


# overlap -----------------------------------------------------------------------------


def test_identical_parts_are_reported_as_overlap():
    contacts = contacts_of(block([0, 0, 0], [1, 1, 1]), block([0, 0, 0], [1, 1, 1]))
    assert len(contacts) == 0
    assert [tuple(sorted(o.ends)) for o in contacts.overlaps] == [(0, 1)]


@pytest.mark.parametrize("inner_first", [True, False])
def test_contained_part_is_reported_as_overlap(inner_first):
    pair = [block([1, 1, 1], [2, 2, 2]), block([0, 0, 0], [3, 3, 3])]
    contacts = contacts_of(*pair[:: 1 if inner_first else -1])
    assert len(contacts) == 0
    assert [tuple(sorted(o.ends)) for o in contacts.overlaps] == [(0, 1)]


def test_part_in_the_hole_of_another_is_no_overlap():
    tube = at_origin(annulus(8, 2, 3, 0, 1))
    contacts = contacts_of(tube, block([-0.5, -0.5, 0], [0.5, 0.5, 1]))
    assert len(contacts) == 0
    assert contacts.overlaps == ()


# thin, small, round, far -------------------------------------------------------------


def test_thin_plates_touch_only_their_neighbours():
    thick = 1e-5
    plates = [block([0, 0, k * thick], [1, 1, (k + 1) * thick]) for k in range(10)]
    found = areas(contacts_of(*plates))
    assert found == {(k, k + 1): pytest.approx(1.0, rel=1e-9) for k in range(9)}


def test_part_below_the_resolution_of_its_neighbour_brings_a_warning():
    vertices, faces = surface(Box([100, 100, 1]))
    slab = Mesh((vertices + np.array([50, 50, -0.5])).astype(np.float32), faces)
    vertices, faces = surface(Box([1e-5, 1e-5, 1e-5]))
    cube = Mesh((vertices + 5e-6).astype(np.float32), faces)
    assert contacts_of(at_origin(slab), at_origin(cube)).warnings


@pytest.mark.slow
def test_cylinder_of_many_sides_is_not_one_facet():
    sides = 20_000
    angle = (np.arange(sides) + 0.5) * (2 * np.pi / sides)
    cylinder = column(np.column_stack([np.cos(angle), np.sin(angle)]), 0.0, 1.0)
    reach = np.cos(np.pi / sides)
    contacts = contacts_of(at_origin(cylinder), block([reach, -1, 0], [reach + 1, 1, 1]))
    if len(contacts):  # the facet that lies in the plane and its neighbours within the angle
        assert np.abs(contacts.points[:, 1]).max() < 5e-3
        assert contacts.patch_area.sum() < 1e-2


@pytest.mark.quick(2)
@pytest.mark.parametrize("seed", range(3))
def test_float32_boxes_a_hundred_sizes_away_all_touch(seed):
    rng = np.random.default_rng(seed)
    turn = Rotation.random(rng=rng).as_matrix()
    grid = list(product(range(3), repeat=3))
    pieces = []
    for where in grid:
        vertices, faces = surface(Box([1, 1, 1]))
        moved = (vertices + where) @ turn.T + 100.0
        pieces.append(at_origin(Mesh(moved.astype(np.float32), faces)))
    neighbours = {
        (i, j)
        for i, p in enumerate(grid)
        for j, q in enumerate(grid)
        if i < j and sum(abs(a - b) for a, b in zip(p, q, strict=True)) == 1
    }
    found = areas(contacts_of(*pieces))
    assert set(found) == neighbours
    assert list(found.values()) == pytest.approx([1.0] * len(neighbours), rel=1e-4)


# many --------------------------------------------------------------------------------


@pytest.mark.slow
def test_twenty_five_thousand_patches_on_one_pair():
    teeth = 25_000
    slab = block([-1, -2, -1], [2 * teeth + 1, 2, 0])
    # tall teeth, so that the tolerance of so long a part stays below a tenth of a tooth
    contacts = contacts_of(at_origin(comb(teeth, 0, 100)), slab, tolerance=Tolerance(gap=1e-3))
    assert areas(contacts) == {(0, 1): pytest.approx(2 * teeth, rel=1e-9)}
    assert len(contacts) == 1


@pytest.mark.slow
@pytest.mark.parametrize("teeth", [300, pytest.param(2_000, marks=pytest.mark.slow)])
def test_comb_on_comb(teeth):
    below = comb(teeth, 0, 100)
    below = Mesh(below.vertices * [1, 1, -1], below.triangles[:, ::-1])
    pieces = (comb(teeth, 0, 100), np.array([0.5, 0, 0])), at_origin(below)
    contacts = contacts_of(*pieces, tolerance=Tolerance(gap=1e-3))
    assert areas(contacts) == {(0, 1): pytest.approx(teeth, rel=1e-9)}


@pytest.mark.slow
@pytest.mark.parametrize("sectors", sampled(1, [300, 1_000, 10_000]))
@pytest.mark.parametrize("turn", [0.0, 0.5])
def test_two_annuli_of_thin_triangles(turn, sectors):
    step = 2 * np.pi / sectors
    pieces = [at_origin(annulus(sectors, 1, 2, 0, 1)),
              at_origin(annulus(sectors, 1, 2, -1, 0, turn * step))]  # fmt: skip
    alone = sectors / 2 * np.sin(step)  # area of the polygon in the unit circle
    # that polygon and the same turned by half a step share one of twice the corners
    shared = 2 * sectors * np.cos(step / 2) ** 2 * np.tan(step / 4) if turn else alone
    exact = 4 * shared - (2 * alone - shared)
    contacts = contacts_of(*pieces)
    assert areas(contacts) == {(0, 1): pytest.approx(exact, rel=1e-11)}


def cube_of_squares(n: int) -> Mesh:
    """The unit cube, each of its sides n x n squares."""
    step = np.arange(n + 1)
    u, v = (x.ravel() for x in np.meshgrid(step, step, indexing="ij"))
    i, j = (x.ravel() for x in np.meshgrid(step[:-1], step[:-1], indexing="ij"))
    at = i * (n + 1) + j
    square = np.column_stack([at, at + n + 1, at + n + 2, at + 1])
    vertices, faces = [], []
    for axis, side in product(range(3), (0, n)):
        points = np.empty((len(u), 3), dtype=np.int64)
        points[:, axis], points[:, axis - 2], points[:, axis - 1] = side, u, v
        faces.append((square if side else square[:, ::-1]) + len(u) * len(vertices))
        vertices.append(points)
    quads = np.vstack(faces)
    triangles = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Mesh(np.vstack(vertices) / n, triangles)


@pytest.mark.parametrize("n", [20, pytest.param(290, marks=pytest.mark.slow)])
def test_mesh_of_a_million_faces_on_a_slab(n):
    slab = block([-0.5, 0.25, -1], [1.5, 2, 0])
    contacts = contacts_of(at_origin(cube_of_squares(n)), slab)
    assert areas(contacts) == {(0, 1): pytest.approx(0.75, rel=1e-9)}


# tolerances --------------------------------------------------------------------------


@pytest.mark.quick(8)
@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(
    ("share", "touches"), [(0.9, True), (1.1, False), (-0.9, True), (-1.1, False)]
)
def test_gap_is_judged_at_the_tolerance(scale, share, touches):
    gap = share * 1e-5 * np.sqrt(3) * scale
    plate = block([-2 * scale, -2 * scale, -scale], [2 * scale, 2 * scale, 0])
    contacts = contacts_of(plate, (Box([scale] * 3), np.array([0, 0, scale / 2 + gap])))
    assert len(contacts) == int(touches)
    if touches:
        assert contacts.patch_gap[0] == pytest.approx([gap, gap], rel=1e-9)
    elif share > 0:
        (near,) = contacts.rejected
        assert tuple(sorted(near.ends)) == (0, 1)
        assert near.gap == pytest.approx(gap, rel=1e-9)
        assert "gap" in near.why
    else:
        assert contacts.rejected or contacts.overlaps


@pytest.mark.parametrize(("angle", "touches"), [(0.9e-3, True), (1.1e-3, False)])
def test_tilt_is_judged_at_the_tolerance(angle, touches):
    turn = Rotation.from_euler("y", -angle)
    center = turn.apply([0.5, 0, 0.5])
    cube = Part("cube", Box([1, 1, 1]), Pose(center, turn.as_quat()[[3, 0, 1, 2]]))
    slab = Part("slab", Box([4, 4, 1]), Pose([0, 0, -0.5]))
    contacts = kilter.contact.contacts(Assembly([slab, cube]))
    # beyond the tolerance it stands on an edge
    assert contacts.patch_kind.tolist() == ["plane" if touches else "edge-face"]
    if touches:  # the whole face counts, its far end too
        assert contacts.patch_area[0] == pytest.approx(1.0, rel=1e-6)
        assert contacts.patch_gap[0] == pytest.approx([0, np.sin(angle)], rel=1e-3, abs=1e-12)
    else:
        (near,) = contacts.rejected
        assert near.angle == pytest.approx(angle, rel=1e-3)
        assert "angle" in near.why or "tilt" in near.why


def test_loose_tolerance_takes_what_the_default_rejects():
    pair = block([0, 0, 0], [1, 1, 1]), block([0, 0, 1.0005], [1, 1, 2])
    assert len(contacts_of(*pair)) == 0
    assert areas(contacts_of(*pair, tolerance=Tolerance.loose())) == {(0, 1): pytest.approx(1.0)}


def test_verdict_on_a_gap_does_not_depend_on_the_pose():
    gap = 0.95e-5 * np.linalg.norm([3, 0.2, 0.2])
    pieces = [block([-2, -2, -1], [2, 2, 0]), block([-1.5, -0.1, gap], [1.5, 0.1, 0.2 + gap])]
    rng = np.random.default_rng(3)
    for rotation in Rotation.random(12, rng=rng).as_matrix():
        assembly = placed(pieces, Wrap(rotation, 1.0, np.zeros(3), "pose"), rng)
        assert len(kilter.contact.contacts(assembly)) == 1


# what changes nothing ----------------------------------------------------------------


def compared(seed: int, name: str, wrap: Wrap) -> None:
    """Areas of a family's scene before and after it is moved."""
    rng = np.random.default_rng(seed)
    pieces = FAMILIES[name](rng)
    still = placed(pieces, Wrap(np.eye(3), 1.0, np.zeros(3), "pose"), rng)
    moved = placed(pieces, wrap, rng)
    before = areas(kilter.contact.contacts(still))
    after = areas(kilter.contact.contacts(moved))
    expected = {pair: area * wrap.scale**2 for pair, area in before.items()}
    assert after == pytest.approx(expected, rel=1e-9), moved.source


EXACT = sorted(set(FAMILIES) - {"gaps", "tilts"})


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), name=st.sampled_from(EXACT), turn=st.integers(0, 10**6))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_rigid_motion_changes_no_area(seed, name, turn):
    rng = np.random.default_rng(turn)
    rotation, shift = Rotation.random(rng=rng).as_matrix(), rng.normal(size=3) * 100
    compared(seed, name, Wrap(rotation, 1.0, shift, str(rng.choice(["pose", "mesh"]))))


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), name=st.sampled_from(EXACT), exponent=st.integers(-20, 20))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_scale_changes_areas_by_its_square(seed, name, exponent):
    compared(seed, name, Wrap(np.eye(3), 2.0**exponent, np.zeros(3), "pose"))


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), name=st.sampled_from(sorted(FAMILIES)))
@settings(max_examples=40, deadline=None, derandomize=True)
def test_order_of_the_parts_changes_nothing(seed, name):
    rng = np.random.default_rng(seed)
    pieces = FAMILIES[name](rng)
    last = len(pieces) - 1
    before = areas(contacts_of(*pieces))
    after = areas(contacts_of(*pieces[::-1]))
    expected = {(last - b, last - a): area for (a, b), area in before.items()}
    assert after == pytest.approx(expected, rel=1e-12)


@pytest.mark.slow
@given(seed=st.integers(0, 10**6), name=st.sampled_from(sorted(FAMILIES)))
@settings(max_examples=30, deadline=None, derandomize=True)
def test_contact_set_is_consistent(seed, name):
    contacts = contacts_of(*FAMILIES[name](np.random.default_rng(seed)))
    count = len(contacts)
    assert contacts.patch_start[0] == 0
    assert contacts.patch_start[-1] == len(contacts.points)
    face = contacts.patch_kind == "plane"
    assert (np.diff(contacts.patch_start)[face] >= 3).all()
    assert (np.diff(contacts.patch_start) >= 1).all()
    assert np.linalg.norm(contacts.patch_normal, axis=1) == pytest.approx(np.ones(count))
    assert ((contacts.patch_area > 0) == face).all()
    assert np.linalg.norm(contacts.normals, axis=1) == pytest.approx(np.ones(len(contacts.points)))
    assert (contacts.patch_gap[:, 0] <= contacts.patch_gap[:, 1]).all()
    assert set(contacts.patch_kind) <= {"plane", "edge-edge", "edge-face", "vertex-face"}
    for k in range(count):
        points = contacts.points[contacts.patch_start[k] : contacts.patch_start[k + 1]]
        height = (points - points.mean(axis=0)) @ contacts.patch_normal[k]
        assert np.ptp(height) <= np.ptp(contacts.patch_gap[k]) + 1e-3 * contacts.gap


@pytest.mark.parametrize(("lifted", "overlaps"), [(0.0, False), (-3.87e-7, True)])
def test_bricks_that_only_the_cross_product_of_two_edges_separates(lifted, overlaps):
    """No face separates them; the gap of 1.937e-7 along the edges' normal is by the closed form."""
    low = Pose([0.300254361, -1.86558497e-4, 0.03], [0.999998385, 0, 0, -1.79719825e-3])
    place = [0.399968348, 3.67350484e-4, 0.0900987233 + lifted]
    high = Pose(place, [0.999999176, -9.92430210e-4, -8.08368271e-7, 8.14612508e-4])
    size = [0.2, 0.1, 0.06]
    assembly = Assembly([Part("low", Box(size), low), Part("high", Box(size), high)])
    corners = [pose.apply(BOX_CORNERS * size) for pose in (low, high)]
    normal = np.cross(low.matrix[:, 0], high.matrix[:, 1])
    normal /= np.linalg.norm(normal)
    gap = (corners[1] @ normal).min() - (corners[0] @ normal).max()
    assert gap == pytest.approx(1.937e-7 + lifted, abs=1e-9)
    found = kilter.contact.detect.contacts(assembly, tolerance=Tolerance(gap=2.3e-9))
    assert [overlap.ends for overlap in found.overlaps] == [(0, 1)] * overlaps
