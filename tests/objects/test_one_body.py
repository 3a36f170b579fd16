"""Several shapes that are united to the single shape of a part."""

from __future__ import annotations

import numpy as np
import pytest

from kilter import Assembly, Box, InputError, Mesh, Part, Pose
from kilter.files.naming import distinct
from kilter.files.one_body import one_body
from kilter.shape.primitives import surface

VERTICES, TRIANGLES = surface(Box([1, 1, 1]))
OPEN = Mesh(VERTICES, TRIANGLES[:-2])
FLAT = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])


def volume_of(shape: object) -> float:
    return float(Assembly([Part("p", shape)]).geometry.volume[0])  # type: ignore[arg-type]


def test_shapes_that_overlap_count_once() -> None:
    notes: list[str] = []
    shape, pose = one_body(
        [(Box([1, 1, 1]), Pose()), (Box([1, 1, 1]), Pose([0.5, 0, 0]))], "p", notes
    )
    assert volume_of(shape) == pytest.approx(1.5)
    assert np.array(pose.position) == pytest.approx(0)
    assert notes == []


def test_the_hull_replaces_an_open_mesh_among_several_shapes() -> None:
    notes: list[str] = []
    away = Pose([0, 0, 9])
    shape, _ = one_body(
        [(Box([1, 1, 1]), Pose([3, 0, 0])), (OPEN, Pose()), (OPEN, away)], "p", notes
    )
    assert volume_of(shape) == pytest.approx(3.0)
    assert notes == ["part 'p': open shapes replaced by their convex hulls: 2 of 3"]


def test_a_flat_mesh_among_several_shapes_is_left_out() -> None:
    notes: list[str] = []
    shape, _ = one_body([(Box([1, 1, 1]), Pose([3, 0, 0])), (FLAT, Pose())], "p", notes)
    assert volume_of(shape) == pytest.approx(1.0)
    assert notes == ["part 'p': flat shapes left out: 1 of 2"]
    with pytest.raises(InputError, match="all of its meshes are flat"):
        one_body([(FLAT, Pose()), (FLAT, Pose([1, 0, 0]))], "p", notes)


def test_a_file_may_name_a_part_ground() -> None:
    assert distinct(["ground", "ground_2", "box", "ground"]) == [
        "ground_3",
        "ground_2",
        "box",
        "ground_4",
    ]
