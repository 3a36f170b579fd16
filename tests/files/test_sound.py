"""Welding many valid meshes at once gives the same result as welding each of them."""

from __future__ import annotations

import numpy as np
import pytest

from kilter.shape import sound
from kilter.shape.closed import open_edges, weld
from kilter.shape.primitives import Box, Cylinder, surface
from kilter.shape.sound import weld_valid_meshes

Corners = tuple[np.ndarray, np.ndarray]


def soup(corners: Corners) -> Corners:
    """Triangles without shared vertices, as in STL."""
    vertices, triangles = corners
    return vertices[triangles].reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


def damaged(corners: Corners, how: int, rng: np.random.Generator) -> Corners:
    """A valid mesh (`kind` 0 to 2) or an invalid mesh (3 to 8)."""
    vertices, triangles = (array.copy() for array in corners)
    k = int(rng.integers(len(triangles)))
    match how:
        case 1:
            return soup(corners)
        case 2:
            order = rng.permutation(len(vertices))
            return vertices[order], np.argsort(order)[triangles]
        case 3:
            return vertices, np.delete(triangles, k, axis=0)
        case 4:
            return vertices, np.vstack([triangles, triangles[k]])
        case 5:
            triangles[k] = triangles[k, ::-1]
        case 6:
            return np.vstack([vertices, [9.0, 9, 9]]), triangles
        case 7:
            return vertices, np.vstack([triangles, triangles[k, [0, 0, 1]]])
        case 8:  # a slightly displaced corner: the edge is open unless close corners are merged
            vertices, triangles = soup(corners)
            vertices[k] += 1e-12
    return vertices, triangles


@pytest.mark.parametrize("batch", [1, 40, 10**6])
def test_many_at_once_as_one_by_one(batch: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sound, "BATCH", batch)
    rng = np.random.default_rng(0)
    kinds = [surface(Box([1, 2, 3])), surface(Cylinder(1.0, 2.0))]
    how = rng.integers(0, 9, size=60)
    meshes = [damaged(kinds[k % 2], int(one), rng) for k, one in enumerate(how)]
    found = weld_valid_meshes(meshes)
    assert [one is not None for one in found] == (how < 3).tolist()
    for (vertices, triangles), one in zip(meshes, found, strict=True):
        if one is None:
            continue
        alone, faces, notes = weld(vertices, triangles)
        assert notes == []
        assert len(open_edges(alone, faces)) == 0
        assert np.array_equal(alone, one[0])
        assert np.array_equal(faces, one[1])


def test_none_at_all() -> None:
    assert weld_valid_meshes([]) == []
