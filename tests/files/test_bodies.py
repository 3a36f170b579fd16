"""Splitting a mesh into bodies: touching bodies are separated, and holes stay with their body."""

from __future__ import annotations

import numpy as np
import pytest

from kilter.assembly.polyhedra import polyhedron_moments
from kilter.files.bodies import split_bodies
from kilter.shape.primitives import Box, Mesh, surface


def boxes(*places: tuple[float, float, float], size: float = 1.0, turned: bool = False) -> Mesh:
    """Several boxes as a single mesh."""
    return merged(*[box(place, size, turned) for place in places])


def box(at: tuple[float, float, float], size: float = 1.0, turned: bool = False) -> Mesh:
    vertices, faces = surface(Box([size] * 3))
    return Mesh(vertices + np.array(at), faces[:, ::-1] if turned else faces)


def merged(*meshes: Mesh) -> Mesh:
    start = np.cumsum([0, *[len(m.vertices) for m in meshes]])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.triangles + s for m, s in zip(meshes, start[:-1], strict=True)]),
    )


def volumes(mesh: Mesh) -> list[float]:
    return [
        float(polyhedron_moments(m.vertices, m.triangles, np.array([0, len(m.triangles)]))[0][0])
        for m in split_bodies(mesh)
    ]


TOUCHING = {
    "apart": [(0, 0, 0), (3, 0, 0)],
    "face on face": [(0, 0, 0), (0, 0, 1)],
    "edge on edge": [(0, 0, 0), (1, 0, 1)],
    "corner on corner": [(0, 0, 0), (1, 1, 1)],
    "shifted": [(0, 0, 0), (0.5, 0, 1)],
    "four around an edge": [(0, 0, 0), (1, 0, 0), (0, 0, 1), (1, 0, 1)],
    "eight around a corner": [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)],
    "a row": [(k, 0, 0) for k in range(20)],
}


@pytest.mark.parametrize("places", TOUCHING.values(), ids=TOUCHING)
@pytest.mark.parametrize("turned", [False, True], ids=["", "inside out"])
def test_boxes_that_touch(places: list[tuple[float, float, float]], turned: bool) -> None:
    expected = [-1.0 if turned else 1.0] * len(places)
    assert volumes(boxes(*places, turned=turned)) == pytest.approx(expected)


@pytest.mark.parametrize("seed", range(8))
def test_turned_and_rounded_to_float32(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    mesh = boxes((0, 0, 0), (0, 0, 1), (1, 0, 1), (0, 1, 0))
    single = (mesh.vertices @ turn.T + 5).astype(np.float32)
    order = rng.permutation(len(mesh.triangles))
    assert volumes(Mesh(single, mesh.triangles[order])) == pytest.approx([1] * 4, rel=1e-5)


def test_a_hole_stays_with_the_body_around_it() -> None:
    hollow = merged(box((0, 0, 0), 4), box((0, 0, 0), 2, turned=True))
    both = merged(hollow, box((0, 0, 0), 1), box((9, 0, 0), 1))
    assert volumes(both) == pytest.approx([64 - 8, 1, 1])


def test_a_body_whose_faces_share_no_corners_is_one() -> None:
    whole = box((0, 0, 0))
    soup = Mesh(whole.vertices[whole.triangles].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    assert len(split_bodies(soup)) == 1


def test_pieces_that_are_open_stay_together_where_they_share_a_corner() -> None:
    whole = box((0, 0, 0))
    lid = merged(Mesh(whole.vertices, whole.triangles[:2]), box((5, 0, 0)))
    assert len(split_bodies(lid)) == 2
    # the lid has an extra corner in the middle of its edge, so the sides have no such edge
    vertices = np.vstack([whole.vertices, (whole.vertices[4:8].sum(axis=0) / 4)[None]])
    fan = np.array([[4, 5, 8], [5, 7, 8], [7, 6, 8], [6, 4, 8]])
    sides = np.delete(whole.triangles, [2, 3], axis=0)
    assert len(split_bodies(Mesh(vertices, np.vstack([sides, fan])))) == 1


def test_accuracy_and_empty_meshes_pass_through() -> None:
    mesh = boxes((0, 0, 0), (3, 0, 0))
    parts = split_bodies(Mesh(mesh.vertices, mesh.triangles, accuracy=0.25))
    assert [part.accuracy for part in parts] == [0.25, 0.25]
    assert len(split_bodies(Mesh([], np.empty((0, 3), dtype=int)))) == 1


def test_a_face_of_two_corners_is_no_body() -> None:
    vertices, faces = surface(Box([1, 1, 1]))
    for extra in ([[0, 0, 1]], [[3, 2, 2], [5, 5, 5]]):
        (body,) = split_bodies(Mesh(vertices, np.vstack([faces, extra])))
        assert len(body.triangles) == 12
