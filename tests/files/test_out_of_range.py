"""Numbers out of range and flat faces: rejected with a single message, without numpy warnings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter.errors import InputError
from kilter.validate import LARGEST

TETRAHEDRON = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
FACES = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
BEYOND = 1e101


@pytest.mark.parametrize("size", [1e308, BEYOND])
@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda size: kilter.Box([size, 1, 1]), "box"),
        (lambda size: kilter.Mesh(np.array(TETRAHEDRON) * size, FACES), "a vertex"),
        (lambda size: kilter.Prism([[0, 0], [size, 0], [0, size]], 1), "polygon"),
        (lambda size: kilter.Pose([size, 0, 0]), "position of the pose"),
        (lambda size: kilter.Pose([0, 0, 0], [size, 0, 0, size]), "rotation of the pose"),
        (lambda size: kilter.Cylinder(size, 1), "radius of the cylinder"),
    ],
)
def test_what_is_too_large_is_refused(make: Any, what: str, size: float) -> None:
    make(LARGEST / 10)
    with pytest.raises(InputError, match=f"{what} is of size|pose has a number that is not finite"):
        make(size)


@pytest.mark.parametrize("place", [0.0, 5e-324, 1e-150])
def test_a_place_may_be_as_near_to_zero_as_it_likes(place: float) -> None:
    assert kilter.Pose([place, 0, 0]).position[0] == place
    assert kilter.Mesh(np.add(TETRAHEDRON, [place, 0, 0]), FACES).vertices[0, 0] == place


@pytest.mark.parametrize("face", [[0, 0, 0, 0], [0, 1, 1, 0], [0, 1, 0, 1], [0, 1, 2, 1, 0]])
def test_a_polygon_of_no_area_is_no_fault(face: list[int]) -> None:
    """The flat face is dropped, and the mesh is closed without it."""
    mesh = kilter.Mesh(TETRAHEDRON, [*FACES, face])
    part = kilter.Part("one", mesh)
    assert kilter.Assembly([part]).geometry.volume == pytest.approx(1 / 6)


def test_an_obj_of_nothing_but_such_faces_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "flat.obj"
    path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2 1\nf 1 2 1 2\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"closed solid|no faces"):
        _ = kilter.load(path).geometry
