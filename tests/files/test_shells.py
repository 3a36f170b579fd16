"""Meshes of several shells in one part: hollows, overlapping shells, shells inside out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from kilter.assembly import Assembly, Part
from kilter.assembly.array_geometry import arrays_side_by_side
from kilter.assembly.assembly_arrays import AssemblyArrays
from kilter.errors import InputError
from kilter.shape.primitives import Box, Mesh, surface

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
def test_shells_bound_matter_once(shells: list[Shell], volume: float, notes: list[str]) -> None:
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
def test_volume_and_centre_are_those_of_the_cells(seed: int) -> None:
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
def test_arrays_with_several_shells_are_read_one_by_one(shells: int) -> None:
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


def test_a_shell_that_crosses_itself_is_refused() -> None:
    """A prism over a bow tie whose far wing has a negative volume."""
    outline = [(0, -1), (0, 1), (10, -0.5), (10, 0.5)]
    corners = [(x, y, z) for z in (0, 1) for x, y in outline]
    caps = [(0, 1, 2), (0, 2, 3), (6, 5, 4), (7, 6, 4)]
    sides = [(k, k + 4, (k + 1) % 4 + 4, (k + 1) % 4) for k in range(4)]
    mesh = Mesh(corners, [*caps, *sides])
    with pytest.raises(InputError, match=r"part .a.: its faces intersect .*; repair"):
        _ = Assembly([Part("a", mesh)]).geometry
