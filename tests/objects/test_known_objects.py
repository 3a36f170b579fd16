"""Arrays and objects of other libraries become parts; one body of several shapes."""

import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, InputError, Mesh, Part, Pose
from kilter.files.meshes.placed import distinct
from kilter.files.robots.one_body import one_body
from kilter.scenes import scene
from kilter.shape.primitives import Box, surface

CORNERS, TRIANGLES = surface(Box([1, 1, 1]))


JOINED = Assembly([kilter.Part("a", Box([1, 1, 1]))], joints=[kilter.Joint(("a", "ground"))])


def moved(*step: float) -> tuple[Any, Any]:
    return CORNERS + step, TRIANGLES


def test_arrays_by_name_are_parts():
    made = {"table": (CORNERS, TRIANGLES), "cube": moved(0.2, 0, 1)}
    found = Assembly.of(made, units="mm", ground="table", density=7850)
    assert (found.names, found.units) == (("table", "cube"), "mm")
    assert found["cube"].density == 7850
    assert kilter.check(found).stable
    assert not kilter.check(Assembly.of({**made, "cube": moved(0.6, 0, 1)}, ground="table")).stable


def test_the_same_arrays_as_parts_of_ones_own_give_the_same_answer():
    own = Assembly(
        [
            kilter.Part("table", kilter.Mesh(CORNERS, TRIANGLES), grounded=True),
            kilter.Part("cube", kilter.Mesh(*moved(0.6, 0, 1))),
        ]
    )
    other = kilter.load({"table": moved(0, 0, 0), "cube": moved(0.6, 0, 1)}, ground="table")
    one, two = kilter.check(own).to_dict(), kilter.check(other).to_dict()
    assert {**one, "seconds": 0} == {**two, "seconds": 0}


def test_a_list_of_arrays_is_numbered():
    assert kilter.load([moved(0, 0, 0), moved(0, 0, 1)]).names == ("part_1", "part_2")


def test_a_pair_of_lists_is_a_surface_and_its_bodies_are_parts():
    both = np.vstack([CORNERS, moved(0, 0, 1)[0]]).tolist()
    faces = np.vstack([TRIANGLES, TRIANGLES + 8]).tolist()
    assert kilter.load((both, faces)).names == ("part_1", "part_2")


def test_what_has_vertices_and_faces_is_a_mesh():
    class Surface:
        vertices, faces = CORNERS, TRIANGLES

    assert kilter.load(Surface()).geometry.mass.tolist() == [1000.0]


def test_an_assembly_is_one_already():
    made = scene("tower")
    assert kilter.load(made) is made
    assert kilter.load(made, friction=0.5).friction == 0.5


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (3, r"^an assembly cannot be made of int; give a path, \(vertices, faces\), an object"),
        (None, "^an assembly cannot be made of NoneType; give a path"),
        ([], "^an assembly cannot be made of list; give a path"),
        ({"a": 3}, "^part 'a': an assembly cannot be made of int; give a path"),
        ([moved(0, 0, 0), 3], "^part 'part_2': an assembly cannot be made of int; give a path"),
        ((CORNERS, [[0, 1, 99]]), "^face 0 names vertex 99 of 8; use indices 0 to 7"),
        ({"a": JOINED}, "^part 'a': it has joints, contacts, loads or friction pairs"),
    ],
    ids=["int", "None", "empty", "in a dict", "in a list", "bad face", "with joints"],
)
def test_what_it_cannot_be_made_of_is_told_in_one_sentence(value, words):
    with pytest.raises(InputError, match=words):
        kilter.load(value)


@pytest.mark.slow
def test_nothing_is_imported_for_it():
    code = (
        "import sys, kilter;"
        "kilter.load(([[0,0,0],[1,0,0],[0,1,0],[0,0,1]],[[0,2,1],[0,1,3],[1,2,3],[0,3,2]]));"
        "print(*{'trimesh','compas','mujoco','build123d','cadquery','OCP'}.intersection(sys.modules))"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == ""


VERTICES, TETRAHEDRON = surface(Box([1, 1, 1]))
OPEN = Mesh(VERTICES, TETRAHEDRON[:-2])
FLAT = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])


def volume_of(shape: object) -> float:
    return float(Assembly([Part("p", shape)]).geometry.volume[0])  # type: ignore[arg-type]


def test_shapes_that_overlap_count_once():
    notes: list[str] = []
    shape, pose = one_body(
        [(Box([1, 1, 1]), Pose()), (Box([1, 1, 1]), Pose([0.5, 0, 0]))], "p", notes
    )
    assert volume_of(shape) == pytest.approx(1.5)
    assert np.array(pose.position) == pytest.approx(0)
    assert notes == []


def test_the_hull_replaces_an_open_mesh_among_several_shapes():
    notes: list[str] = []
    away = Pose([0, 0, 9])
    shape, _ = one_body(
        [(Box([1, 1, 1]), Pose([3, 0, 0])), (OPEN, Pose()), (OPEN, away)], "p", notes
    )
    assert volume_of(shape) == pytest.approx(3.0)
    assert notes == ["part 'p': open shapes replaced by their convex hulls: 2 of 3"]


def test_a_flat_mesh_among_several_shapes_is_left_out():
    notes: list[str] = []
    shape, _ = one_body([(Box([1, 1, 1]), Pose([3, 0, 0])), (FLAT, Pose())], "p", notes)
    assert volume_of(shape) == pytest.approx(1.0)
    assert notes == ["part 'p': flat shapes left out: 1 of 2"]
    with pytest.raises(InputError, match="all of its meshes are flat"):
        one_body([(FLAT, Pose()), (FLAT, Pose([1, 0, 0]))], "p", notes)


def test_a_file_may_name_a_part_ground():
    assert distinct(["ground", "ground_2", "box", "ground"]) == [
        "ground_3",
        "ground_2",
        "box",
        "ground_4",
    ]
