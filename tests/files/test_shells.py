"""Shells and open meshes."""

from typing import Any

import numpy as np
import pytest

from kilter.analysis.check import check
from kilter.assembly import Assembly, Part
from kilter.assembly.array_geometry import arrays_side_by_side
from kilter.assembly.assembly_arrays import AssemblyArrays
from kilter.contact.common.gaps import UNKNOWN
from kilter.contact.detect import contacts
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.shape.closed import open_edges, orient_faces
from kilter.shape.primitives import Box, Cylinder, Mesh, surface

Shell = tuple[np.ndarray, np.ndarray]
HOLLOW = "part 'a': hollows whose faces pointed outwards: 1, reversed"
APART = "part 'a': separate shells whose faces pointed inwards: 1, reversed"
UNITED = "part 'a': overlapping shells: 2, united"
TURNED = "the faces pointed inwards and were reversed: 'a'"


def cube(size: Any, at: Any = (0, 0, 0), turn: int = 1) -> Shell:
    """A box; `turn` -1: inside out."""
    corners, faces = surface(Box(np.ones(3) * size))
    return corners + np.array(at), faces[:, ::turn]


def mesh_of(*shells: Shell) -> Mesh:
    """One mesh of several shells."""
    first = np.cumsum([0, *(len(corners) for corners, _ in shells)])
    return Mesh(
        np.vstack([corners for corners, _ in shells]),
        np.vstack([faces + k for (_, faces), k in zip(shells, first, strict=False)]),
    )


@pytest.mark.parametrize(
    ("shells", "volume", "notes"),
    [
        ([cube(2), cube(1)], 7.0, [HOLLOW]),
        ([cube(2), cube(1, turn=-1)], 7.0, []),
        ([cube(2, turn=-1), cube(1)], 7.0, [TURNED]),
        ([cube(2, turn=-1), cube(1, turn=-1)], 7.0, [APART]),
        ([cube(3), cube(2), cube(1)], 27 - 8 + 1, [HOLLOW]),
        ([cube(1), cube(1, (0.4, 0.4, 0))], 2 - 0.36, [UNITED]),
        ([cube(1, turn=-1), cube(1, (0.4, 0.4, 0), -1)], 2 - 0.36, [UNITED]),
        ([cube(1), cube(1, (5, 0, 0), -1)], 2.0, [APART]),
        ([cube(1, turn=-1), cube(1, (5, 0, 0), -1)], 2.0, [TURNED]),
        ([cube(2), cube(1, (0, 0, 1), -1)], 8 - 0.5, [UNITED]),
        ([cube(2), cube(0.6, (-0.1, 0, 0)), cube(0.6, (0.1, 0, 0))], 8 - 0.288, [UNITED]),
    ],
    ids=["nested", "hollow", "hollow-inside-out", "all-inwards", "three", "overlapping",
         "overlapping-inside-out", "one-inwards", "apart-inside-out", "drilled", "two-hollows"],
)  # fmt: skip
def test_shells_bound_matter_once(shells, volume, notes):
    geometry = Assembly([Part("a", mesh_of(*shells))]).geometry
    assert geometry.mass[0] == pytest.approx(1000 * volume, rel=1e-12)
    assert list(geometry.warnings) == notes


def body_of_cells(boxes: list[np.ndarray], outward: list[bool], size: int) -> np.ndarray:
    """Mask of the unit cells of a body of boxes, by the depth and the winding of each box."""
    cells = [np.zeros((size,) * 3, dtype=bool) for _ in boxes]
    for mask, ((a, b, c), (p, q, r)) in zip(cells, boxes, strict=True):
        mask[a:p, b:q, c:r] = True
    contains = [[(m & n).sum() == n.sum() and m is not n for n in cells] for m in cells]
    crosses = [
        any((m & n).any() and not contains[i][j] and not contains[j][i]
            for j, n in enumerate(cells) if i != j)
        for i, m in enumerate(cells)
    ]  # fmt: skip
    body = np.zeros((size,) * 3, dtype=bool)
    depth = [sum(row[j] for row in contains) for j in range(len(cells))]
    for level in range(max(depth) + 1):
        here = [j for j in range(len(cells)) if depth[j] == level]
        hollow = [j for j in here if level % 2 or (crosses[j] and not outward[j])]
        for j in [j for j in here if j not in hollow]:
            body |= cells[j]
        for j in hollow:
            body &= ~cells[j]
    return body


@pytest.mark.quick(3)
@pytest.mark.parametrize("seed", range(60))
def test_volume_and_centre_are_those_of_the_cells(seed):
    """Boxes at random with corners on a grid, of which no two share a coordinate."""
    rng = np.random.default_rng(seed)
    count = 2 + seed % 4
    steps = np.sort(np.array([rng.permutation(2 * count).reshape(count, 2) for _ in range(3)]))
    boxes = [steps[:, k].T for k in range(count)]
    outward = [bool(k == 0 or rng.random() < 0.7) for k in range(count)]
    shells = [
        cube(high - low, (low + high) / 2, 1 if out else -1)
        for (low, high), out in zip(boxes, outward, strict=True)
    ]
    body = body_of_cells(boxes, outward, 2 * count)
    if not body.any():
        pytest.skip("the hollows leave nothing")
    geometry = Assembly([Part("a", mesh_of(*shells))]).geometry
    assert geometry.volume[0] == pytest.approx(body.sum(), rel=1e-12)
    assert np.allclose(geometry.center[0], np.argwhere(body).mean(axis=0) + 0.5, atol=1e-12)


@pytest.mark.parametrize("shells", [1, 2])
def test_arrays_with_several_shells_are_read_one_by_one(shells):
    """The fast way for many plain meshes leaves them to the careful way."""
    tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    small = 0.1 * corners + 0.2
    mesh = mesh_of((corners, tetrahedron), (small, tetrahedron))
    vertices, faces = mesh.vertices[: 4 * shells], mesh.triangles[: 4 * shells]
    arrays = AssemblyArrays(vertices, faces, [0, 4 * shells], [0, 4 * shells], [0, 1], [True])
    joined, which = arrays_side_by_side(arrays)
    assert (joined is None) == (shells == 2)
    assert len(which) == (shells == 1)


def test_a_shell_that_crosses_itself_is_refused():
    """A prism over a bow tie whose far wing has a negative volume."""
    outline = [(0, -1), (0, 1), (10, -0.5), (10, 0.5)]
    corners = [(x, y, z) for z in (0, 1) for x, y in outline]
    caps = [(0, 1, 2), (0, 2, 3), (6, 5, 4), (7, 6, 4)]
    sides = [(k, k + 4, (k + 1) % 4 + 4, (k + 1) % 4) for k in range(4)]
    mesh = Mesh(corners, [*caps, *sides])
    with pytest.raises(InputError, match=r"part .a.: its faces intersect .*; repair"):
        _ = Assembly([Part("a", mesh)]).geometry


def fine(size: float = 1.0, cells: int = 8) -> tuple[np.ndarray, np.ndarray]:
    """A box of many triangles: vertices and triangles."""
    ends = np.linspace(-size / 2, size / 2, cells + 1)
    corners, faces = [], []
    for axis in range(3):
        for side in (-1, 1):
            u, v = np.meshgrid(ends, ends, indexing="ij")
            grid = np.full((cells + 1, cells + 1, 3), side * size / 2)
            grid[..., (axis + 1) % 3], grid[..., (axis + 2) % 3] = u, v
            n = sum(len(c) for c in corners)
            corners.append(grid.reshape(-1, 3))
            at = n + np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
            quad = [at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]]
            for k in (1, 2):
                rows = np.stack([quad[0], quad[k], quad[k + 1]], axis=-1).reshape(-1, 3)
                faces.append(rows if side > 0 else rows[:, ::-1])
    return np.vstack(corners), np.vstack(faces)


def without_face_at(point: tuple[float, float, float]) -> Mesh:
    """The fine box without the triangle whose centroid is nearest to a point."""
    vertices, faces = fine()
    k = np.linalg.norm(vertices[faces].mean(axis=1) - point, axis=1).argmin()
    return Mesh(vertices, np.delete(faces, k, axis=0))


# mixed winding ------------------------------------------------------------------------------


@pytest.mark.quick(6)
@pytest.mark.parametrize("shape", [Box([1, 2, 3]), Cylinder(1, 2)], ids=["box", "cylinder"])
@pytest.mark.parametrize("seed", range(6))
def test_mixed_winding_is_turned_with_a_warning(shape, seed):
    vertices, faces = surface(shape)
    rng = np.random.default_rng(seed)
    mixed = faces.copy()
    wrong = rng.random(len(faces)) < rng.choice([0.05, 0.5, 0.95])
    wrong[0] = True
    wrong[1] = False
    mixed[wrong] = mixed[wrong][:, ::-1]
    turned, count = orient_faces(vertices, mixed)
    assert np.array_equal(turned, faces)
    assert count == wrong.sum()
    mesh = Mesh(vertices, mixed)
    assert Assembly([Part("first", mesh)]).geometry.warnings  # they name the part
    geometry = Assembly([Part("stone", mesh)]).geometry
    true = Assembly([Part("stone", Mesh(vertices, faces))]).geometry
    assert geometry.warnings == (
        f"part 'stone': {count} faces had the wrong winding and were reversed",
    )
    assert np.array_equal(geometry.mass, true.mass)
    assert np.array_equal(geometry.inertia, true.inertia)


def test_a_hole_inside_stays_a_hole():
    vertices, faces = surface(Box([4, 4, 4]))
    inner, _ = surface(Box([2, 2, 2]))
    hole = faces[:, ::-1].copy()
    hole[3] = hole[3, ::-1]
    mesh = Mesh(np.vstack([vertices, inner]), np.vstack([faces, hole + 8]))
    assert Assembly([Part("shell", mesh)]).geometry.volume == pytest.approx([64 - 8])


def test_what_is_sound_is_left_alone():
    vertices, faces = fine()
    turned, count = orient_faces(vertices, faces)
    assert turned is faces or np.array_equal(turned, faces)
    assert count == 0


def test_a_moebius_strip_is_not_turned():
    n = 12
    angle = np.arange(n) * 2 * np.pi / n
    out = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    width = np.cos(angle / 2)[:, None] * out + np.sin(angle / 2)[:, None] * [0, 0, 1]
    vertices = np.vstack([3 * out - width / 2, 3 * out + width / 2])
    k = np.arange(n - 1)
    faces = [[a, a + 1, a + n] for a in k] + [[a + 1, a + 1 + n, a + n] for a in k]
    faces += [[n - 1, n, 2 * n - 1], [n, 0, 2 * n - 1]]
    assert orient_faces(vertices, np.array(faces))[1] == 0
    (warning,) = Assembly([Part("strip", Mesh(vertices, faces))]).geometry.warnings
    assert warning.startswith("part 'strip': the mesh is open")
    assert "its contacts are unknown" in warning


# holes -----------------------------------------------------------------------------------------

TOP = (0.0, 0.0, 0.5)
SIDE = (0.5, 0.0, 0.0)


def on(base: Part) -> Assembly:
    return Assembly([base, Part("cube", Box([0.5, 0.5, 0.5]), Pose([0, 0, 0.75]))])


def test_a_held_open_mesh_holds():
    """The hole is far from all contacts: the verdict is that of the closed mesh."""
    assembly = on(Part("base", without_face_at(SIDE), grounded=True))
    (warning,) = assembly.geometry.warnings
    assert warning.startswith("part 'base': the mesh is open: 3 edges have a face on a single side")
    assert warning.endswith("a held part needs no closed mesh")
    found = check(assembly)
    assert found.verdict == "stable"
    assert not [r for r in found.contact_set.rejected if r.why == UNKNOWN]
    assert assembly.geometry.volume[0] == pytest.approx(1.0, rel=1e-2)


def test_what_comes_near_a_hole_is_listed():
    assembly = on(Part("base", without_face_at(TOP), grounded=True))
    found = contacts(assembly)
    assert [r.ends for r in found.rejected if r.why == UNKNOWN] == [(0, 1)]
    assert [(pair.ends, pair.kind, pair.why) for pair in found.open_pairs] == [
        ((0, 1), "near", UNKNOWN)
    ]
    assert len(found)  # the rest of the face still has contacts


def test_a_held_sheet_is_a_table():
    """A sheet of two triangles supports a part above; facing down, its contacts are undecided."""
    corners = [[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]]
    cube = Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    for faces, verdict in (
        ([[0, 1, 2], [0, 2, 3]], "stable"),
        ([[0, 2, 1], [0, 3, 2]], "undecided"),
    ):
        sheet = Part("sheet", Mesh(corners, faces), grounded=True)
        assert check(Assembly([sheet, cube])).verdict == verdict


def test_a_free_mesh_with_a_small_hole_uses_the_given_mass_and_centre():
    mesh = without_face_at(SIDE)
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -1]), grounded=True)
    stone = Part("stone", mesh, mass=2.0, center_of_mass=[0.1, 0, 0])
    assembly = Assembly([table, stone])
    assert assembly.geometry.mass[1] == 2.0
    assert assembly.geometry.center[1] == pytest.approx([0.1, 0, 0])
    assert assembly.geometry.inertia[1] == pytest.approx(np.eye(3) * 2 / 6, abs=1e-2)
    assert check(assembly).verdict == "stable"
    beyond = Part("stone", mesh, mass=2.0, center_of_mass=[0.6, 0, 0])
    assert check(Assembly([table, beyond])).verdict == "unstable"


def test_a_small_hole_is_closed_for_the_mass_of_a_free_part():
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -1]), grounded=True)
    closed = check(Assembly([table, Part("stone", Box([1, 1, 1]))]))
    for given in ({}, {"density": 1000.0}, {"mass": 2.0}):
        assembly = Assembly([table, Part("stone", without_face_at(SIDE), **given)])
        assert assembly.geometry.volume[1] == pytest.approx(1.0, rel=1e-2)
        assert assembly.geometry.center[1] == pytest.approx([0, 0, 0], abs=1e-2)
        (warning,) = [w for w in assembly.geometry.warnings if "open" in w]
        assert warning.endswith("its small holes were closed to compute its mass")
        assert check(assembly).verdict == closed.verdict == "stable"


LID = Mesh(surface(Box([1, 1, 1]))[0], surface(Box([1, 1, 1]))[1][:-2])
"""A cube without the two triangles of a face."""


def test_a_large_hole_is_accepted_with_mass_and_centre():
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -1]), grounded=True)
    lid = Part("lid", LID, mass=1.0, center_of_mass=[0, 0, 0])
    assembly = Assembly([table, lid])
    assert assembly.geometry.mass[1] == 1.0
    assert assembly.geometry.center[1] == pytest.approx([0, 0, 0])
    assert not assembly.geometry.unknown.whole.any()


def test_the_hull_replaces_a_free_mesh_with_a_large_hole_and_its_contacts_are_open():
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -1]), grounded=True)
    assembly = Assembly([table, Part("lid", LID)])
    assert assembly.geometry.volume[1] == pytest.approx(1.0)
    (warning,) = [w for w in assembly.geometry.warnings if "open" in w]
    assert "mass and centre are those of its convex hull" in warning
    answer = check(assembly)
    assert answer.verdict == "undecided"
    assert [pair.ends for pair in answer.contact_set.open_pairs] == [(0, 1)]
    beside = Assembly([table, Part("lid", LID), Part("cube", Box([1, 1, 1]), Pose([1.5, 0, 0]))])
    assert {pair.ends for pair in check(beside).contact_set.open_pairs} == {(0, 1)}


def test_a_flat_open_mesh_is_refused_by_name():
    flat = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    with pytest.raises(InputError, match=r"part 'sheet': the mesh is open: 3 edges .*leave"):
        _ = Assembly([Part("sheet", flat)]).geometry


def test_the_hole_is_where_it_is_after_a_turn():
    pose = Pose([1, 2, 3], [np.sqrt(0.5), 0, np.sqrt(0.5), 0])  # x to -z
    geometry = Assembly([Part("base", without_face_at(SIDE), pose, grounded=True)]).geometry
    assert len(geometry.unknown) == 1
    assert not geometry.unknown.whole.any()
    middle = (geometry.unknown.low[0] + geometry.unknown.high[0]) / 2
    assert middle == pytest.approx(np.array([1, 2, 2.5]), abs=0.1)
    assert len(open_edges(geometry.vertices, geometry.triangles)) == 3
