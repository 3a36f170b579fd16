"""Objects of trimesh: the same answer as through the file that trimesh writes."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import InputError
from kilter.rigid import Pose
from kilter.scenes import scene

trimesh = pytest.importorskip("trimesh")
Agree = Callable[..., kilter.Assembly]


def box(size: Any) -> Any:
    return trimesh.creation.box(size)


def at(x: float = 0, y: float = 0, z: float = 0, turn: float = 0.0) -> np.ndarray:
    place = trimesh.transformations.rotation_matrix(turn, [0, 1, 0])
    place[:3, 3] = x, y, z
    return place


def stack(*nodes: tuple[str, Any, np.ndarray], units: str | None = None) -> Any:
    made = trimesh.Scene()
    for name, mesh, place in nodes:
        made.add_geometry(mesh, node_name=name, geom_name=name, transform=place)
    if units:
        made.units = units
    return made


def test_a_tower_stands(agree):
    made = stack(("low", box([1, 1, 1]), at()), ("high", box([1, 1, 1]), at(z=1)))
    found = agree(made, made.export, "tower.glb", "stable", ground="low")
    assert set(found.names) == {"low", "high"}


@pytest.mark.parametrize(("reach", "verdict"), [(0.49, "stable"), (0.51, "unstable")])
def test_a_box_tips_where_its_centre_passes_the_edge(agree, reach, verdict):
    made = stack(("table", box([1, 1, 1]), at()), ("book", box([1, 1, 0.25]), at(reach, z=0.625)))
    agree(made, made.export, "book.glb", verdict, ground="table")


@pytest.mark.slow
def test_a_block_slides_down_a_plane_that_is_turned(agree):
    tilt = 0.2
    up = np.array([np.sin(tilt), 0, np.cos(tilt)])
    made = stack(
        ("ramp", box([4, 1, 1]), at(turn=tilt)), ("block", box([1, 1, 1]), at(*up, turn=tilt))
    )
    agree(made, made.export, "ramp.glb", "unstable", ground="ramp")
    friction = kilter.check(kilter.load(made, ground="ramp", friction=0.3))
    assert friction.stable


def test_one_mesh_of_two_bodies_is_taken_apart(agree):
    both = trimesh.util.concatenate([box([1, 1, 1]), box([1, 1, 1]).apply_translation([0.2, 0, 1])])
    found = agree(both, both.export, "part.stl", "stable", floor=True, units="m")
    assert len(found.parts) == 3


def test_a_mesh_in_millimetres_says_so(agree):
    mesh = box([40, 20, 10])
    mesh.metadata["name"] = "brick"
    mesh.units = "mm"
    made = stack(("brick", mesh, at()), units="mm")
    found = agree(mesh, made.export, "brick.3mf", "stable", floor=True)
    assert (found.units, found.names[0]) == ("mm", "brick")
    assert found.geometry.mass[0] == pytest.approx(0.008)
    message = "the object is in mm, but the units given are m; leave the units"
    with pytest.raises(InputError, match=message):
        kilter.load(mesh, units="m")


def test_primitives_keep_their_exact_faces():
    place = at(z=2.5)
    made = stack(
        ("table", trimesh.primitives.Box([4, 4, 1]), at()),
        ("post", trimesh.primitives.Cylinder(radius=0.5, height=4), place),
        ("ball", trimesh.primitives.Sphere(radius=1), at(z=5.5)),
    )
    found = kilter.load(made, ground="table")
    kinds = {part.name: type(part.shape) for part in found.parts}
    assert kinds == {"table": kilter.Box, "post": kilter.Cylinder, "ball": kilter.Sphere}
    assert found.geometry.mass[found.index_of("post")] == pytest.approx(1000 * np.pi, rel=1e-12)
    assert kilter.check(found).verdict == "stable"
    scaled = stack(("post", trimesh.primitives.Cylinder(radius=0.5, height=4), 2 * at()))
    [part] = kilter.load(scaled).parts
    assert isinstance(part.shape, kilter.Mesh)


def test_a_scene_comes_back_as_it_was():
    made = scene("tower")
    scene_of = made.to_trimesh()
    again = kilter.load(scene_of, ground=[part.name for part in made.parts if part.grounded])
    assert set(again.names) == set(made.names)
    for part in made.parts:
        k = again.index_of(part.name)
        assert again.geometry.mass[k] == pytest.approx(made.geometry.mass[made.index[part.name]])
        assert np.allclose(again.geometry.center[k], made.geometry.center[made.index[part.name]])
    assert kilter.check(again).verdict == kilter.check(made).verdict


def test_numbers_that_all_are_float32_are_taken_for_such():
    corners = box([0.1, 0.1, 0.1])
    exact = kilter.load(corners).parts[0].shape.accuracy
    corners.vertices = corners.vertices.astype(np.float32)
    assert kilter.load(corners).parts[0].shape.accuracy > 1e6 * exact


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (lambda: trimesh.PointCloud([[0, 0, 0]]), "a trimesh PointCloud is not a mesh; give a"),
        (lambda: trimesh.Scene(), "the trimesh Scene has no faces; give a"),
    ],
)
def test_what_is_no_solid_is_refused(value, words):
    with pytest.raises(InputError, match=words):
        kilter.load(value())


def test_parts_are_where_their_pose_says(tmp_path):
    pose = Pose([1, 2, 3], [0.5, 0.5, 0.5, 0.5])
    made = kilter.Assembly([kilter.Part("a", kilter.Box([1, 2, 3]), pose)], units="cm")
    again = kilter.load(made.to_trimesh())
    assert again.units == "cm"
    assert np.allclose(np.sort(again.geometry.vertices, axis=0),
                       np.sort(made.geometry.vertices, axis=0))  # fmt: skip
