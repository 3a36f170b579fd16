"""Invalid meshes: mixed winding, holes, sheets; which are accepted, and the messages."""

from __future__ import annotations

import numpy as np
import pytest

from kilter.analysis.check import check
from kilter.assembly import Assembly, Part
from kilter.contact.common.gaps import UNKNOWN
from kilter.contact.detect import contacts
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.shape.closed import open_edges, orient_faces
from kilter.shape.primitives import Box, Cylinder, Mesh, surface


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
def test_mixed_winding_is_turned_with_a_warning(shape, seed: int) -> None:
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
    geometry = Assembly([Part("stone", Mesh(vertices, mixed))]).geometry
    true = Assembly([Part("stone", Mesh(vertices, faces))]).geometry
    assert geometry.warnings == (
        f"part 'stone': {count} faces had the wrong winding and were reversed",
    )
    assert np.array_equal(geometry.mass, true.mass)
    assert np.array_equal(geometry.inertia, true.inertia)


def test_a_hole_inside_stays_a_hole() -> None:
    vertices, faces = surface(Box([4, 4, 4]))
    inner, _ = surface(Box([2, 2, 2]))
    hole = faces[:, ::-1].copy()
    hole[3] = hole[3, ::-1]
    mesh = Mesh(np.vstack([vertices, inner]), np.vstack([faces, hole + 8]))
    assert Assembly([Part("shell", mesh)]).geometry.volume == pytest.approx([64 - 8])


def test_what_is_sound_is_left_alone() -> None:
    vertices, faces = fine()
    turned, count = orient_faces(vertices, faces)
    assert turned is faces or np.array_equal(turned, faces)
    assert count == 0


def test_a_moebius_strip_is_not_turned() -> None:
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


def test_a_held_open_mesh_holds() -> None:
    """The hole is far from all contacts: the verdict is that of the closed mesh."""
    assembly = on(Part("base", without_face_at(SIDE), grounded=True))
    (warning,) = assembly.geometry.warnings
    assert warning.startswith("part 'base': the mesh is open: 3 edges have a face on a single side")
    assert warning.endswith("a held part needs no closed mesh")
    found = check(assembly)
    assert found.verdict == "stable"
    assert not [r for r in found.contact_set.rejected if r.why == UNKNOWN]
    assert assembly.geometry.volume[0] == pytest.approx(1.0, rel=1e-2)


def test_what_comes_near_a_hole_is_listed() -> None:
    assembly = on(Part("base", without_face_at(TOP), grounded=True))
    found = contacts(assembly)
    assert [r.ends for r in found.rejected if r.why == UNKNOWN] == [(0, 1)]
    assert [(pair.ends, pair.kind, pair.why) for pair in found.open_pairs] == [
        ((0, 1), "near", UNKNOWN)
    ]
    assert len(found)  # the rest of the face still has contacts


def test_a_held_sheet_is_a_table() -> None:
    """A sheet of two triangles supports a part above; facing down, its contacts are undecided."""
    corners = [[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]]
    cube = Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    for faces, verdict in (
        ([[0, 1, 2], [0, 2, 3]], "stable"),
        ([[0, 2, 1], [0, 3, 2]], "undecided"),
    ):
        sheet = Part("sheet", Mesh(corners, faces), grounded=True)
        assert check(Assembly([sheet, cube])).verdict == verdict


def test_a_free_mesh_with_a_small_hole_uses_the_given_mass_and_centre() -> None:
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


def test_a_small_hole_is_closed_for_the_mass_of_a_free_part() -> None:
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


def test_a_large_hole_is_accepted_with_mass_and_centre() -> None:
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -1]), grounded=True)
    lid = Part("lid", LID, mass=1.0, center_of_mass=[0, 0, 0])
    assembly = Assembly([table, lid])
    assert assembly.geometry.mass[1] == 1.0
    assert assembly.geometry.center[1] == pytest.approx([0, 0, 0])
    assert not assembly.geometry.unknown.whole.any()


def test_the_hull_replaces_a_free_mesh_with_a_large_hole_and_its_contacts_are_open() -> None:
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


def test_a_flat_open_mesh_is_refused_by_name() -> None:
    flat = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    with pytest.raises(InputError, match=r"part 'sheet': the mesh is open: 3 edges .*leave"):
        _ = Assembly([Part("sheet", flat)]).geometry


def test_the_hole_is_where_it_is_after_a_turn() -> None:
    pose = Pose([1, 2, 3], [np.sqrt(0.5), 0, np.sqrt(0.5), 0])  # x to -z
    geometry = Assembly([Part("base", without_face_at(SIDE), pose, grounded=True)]).geometry
    assert len(geometry.unknown) == 1
    assert not geometry.unknown.whole.any()
    middle = (geometry.unknown.low[0] + geometry.unknown.high[0]) / 2
    assert middle == pytest.approx(np.array([1, 2, 2.5]), abs=0.1)
    assert len(open_edges(geometry.vertices, geometry.triangles)) == 3
