"""Random files with known contents and known damage."""

import re
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import trimesh

FORMATS = ("stl", "obj", "glb", "3mf")


@dataclass
class Made:
    """A random file, its contents and its damage.

    Attributes
    ----------
    path : Path
    volumes, centers : dict
        Volume and centre of each body by name, from a second program [length unit of the file].
    spoilt : set of str
        Names of bodies that lost a face.
    turned : set of str
        Names of bodies with faces of the wrong winding.
    """

    path: Path
    volumes: dict[str, float] = field(default_factory=dict)
    centers: dict[str, np.ndarray] = field(default_factory=dict)
    spoilt: set[str] = field(default_factory=set)
    turned: set[str] = field(default_factory=set)


# meshes -------------------------------------------------------------------------------------


def mesh_file(rng: np.random.Generator, folder: Path) -> Made:
    """A mesh file of several bodies: some open or of mixed winding, with repeated or flat faces."""
    kind = str(rng.choice(FORMATS))
    made = Made(folder / f"a.{kind}")
    scene = trimesh.Scene()
    for k in range(1 if kind == "stl" else int(rng.integers(1, 5))):
        name = "a" if kind == "stl" else f"body{k}"
        mesh = _body(rng)
        mesh.apply_transform(trimesh.transformations.random_rotation_matrix(rng.random(3)))
        mesh.apply_translation(rng.normal(size=3) * 5 + [12 * k, 0, 0])
        made.volumes[name], made.centers[name] = float(mesh.volume), np.array(mesh.center_mass)
        faces = mesh.faces.copy()
        if rng.random() < 0.3:
            wrong = rng.random(len(faces)) < 0.2
            wrong[0], wrong[1] = True, False
            faces[wrong] = faces[wrong][:, ::-1]
            made.turned.add(name)
        if rng.random() < 0.2:
            faces = np.vstack([faces, faces[:2]])  # a repeated face
        if rng.random() < 0.2:
            faces = np.vstack([faces, faces[:1, [0, 0, 1]]])  # a face without area
        if rng.random() < 0.2:
            faces = np.delete(faces, int(rng.integers(2, len(mesh.faces))), axis=0)
            made.spoilt.add(name)
        spoilt = trimesh.Trimesh(mesh.vertices, faces, process=False)
        scene.add_geometry(spoilt, geom_name=name, node_name=name)
    data = next(iter(scene.geometry.values())) if kind in ("stl", "obj") else scene
    if kind == "obj":
        made.path.write_text(_obj(scene))
    else:
        made.path.write_bytes(data.export(file_type=kind))
    return made


def _body(rng: np.random.Generator) -> trimesh.Trimesh:
    size = rng.uniform(0.5, 4, 3)
    which = int(rng.integers(4))
    if which == 0:
        return trimesh.creation.box(size)
    if which == 1:
        return trimesh.creation.icosphere(2, float(size[0]))
    if which == 2:
        return trimesh.creation.cylinder(float(size[0]), float(size[1]), sections=24)
    return trimesh.Trimesh(rng.normal(size=(30, 3)) * size).convex_hull


def _obj(scene: trimesh.Scene) -> str:
    lines, first = [], 1
    for name, mesh in scene.geometry.items():
        lines.append(f"o {name}")
        lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (mesh.faces + first).tolist()]
        first += len(mesh.vertices)
    return "\n".join(lines) + "\n"


# STEP ---------------------------------------------------------------------------------------


def step_file(rng: np.random.Generator, folder: Path) -> Made:
    """A nested STEP file in a random unit; some of its solids lack a face."""
    from step_maker import placement, write_step

    made = Made(folder / "a.step")
    units = str(rng.choice(["mm", "cm", "m", "in"]))
    count = int(rng.integers(1, 6))
    nodes: list[Any] = []
    for k in range(count):
        name = f"solid{k}"
        turn = rng.normal(size=4)
        move = placement(rng.normal(size=3) * 20, turn / np.linalg.norm(turn))
        shape = _shape(rng)
        if rng.random() < 0.25:
            shape = _with_wires(shape)
        if nodes and rng.random() < 0.4:
            above = placement(rng.normal(size=3) * 9)
            nodes = [(f"level{k}", [*nodes, (name, shape, move)], above)]
        else:
            nodes.append((name, shape, move))
    _measure(made, nodes, [])
    write_step(made.path, [("all", nodes, None)], units)
    if rng.random() < 0.35:
        _lose_a_face(rng, made)
    return made


def _shape(rng: np.random.Generator) -> Any:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
    from OCP.BRepPrimAPI import (
        BRepPrimAPI_MakeBox,
        BRepPrimAPI_MakeCone,
        BRepPrimAPI_MakeCylinder,
        BRepPrimAPI_MakeSphere,
        BRepPrimAPI_MakeTorus,
    )
    from step_maker import as_splines, moved, placement

    def primitive() -> Any:
        a, b, c = rng.uniform(1, 6, 3).tolist()
        return [
            lambda: BRepPrimAPI_MakeBox(a, b, c).Shape(),
            lambda: BRepPrimAPI_MakeCylinder(a, b).Shape(),
            lambda: BRepPrimAPI_MakeCone(a, a * 0.3, c).Shape(),
            lambda: BRepPrimAPI_MakeSphere(a).Shape(),
            lambda: BRepPrimAPI_MakeTorus(a + 3, a / 3).Shape(),
        ][int(rng.integers(5))]()

    shape = primitive()
    if rng.random() < 0.4:
        turn = rng.normal(size=4)
        other = moved(primitive(), placement(rng.normal(size=3), turn / np.linalg.norm(turn)))
        way = BRepAlgoAPI_Cut if rng.random() < 0.5 else BRepAlgoAPI_Fuse
        joined = way(shape, other).Shape()
        shape = joined if _is_sound(joined) else shape
    splines = as_splines(shape) if rng.random() < 0.2 else shape
    for whole in (splines, shape):
        if _is_sound(whole) and _is_written_as_it_is(whole):
            return whole
    return BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape()


def _is_written_as_it_is(shape: Any) -> bool:
    """Whether OCCT reads its own file with the same volume; it misreads some trimmed faces."""
    from OCP.STEPControl import (
        STEPControl_Reader,
        STEPControl_StepModelType,
        STEPControl_Writer,
    )

    from kilter.files.cad.step_surfaces import quiet

    with quiet(), TemporaryDirectory() as folder:
        path = f"{folder}/a.step"
        writer, reader = STEPControl_Writer(), STEPControl_Reader()
        writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
        writer.Write(path)
        reader.ReadFile(path)
        reader.TransferRoots()
        again = _volume(reader.OneShape())[0]
    return abs(again - _volume(shape)[0]) < 1e-6 * again


def _is_sound(shape: Any) -> bool:
    """A solid whose volumes from its faces and from triangles agree.

    The union of OCCT may be invalid.
    """
    from OCP.BRepMesh import BRepMesh_IncrementalMesh
    from OCP.StlAPI import StlAPI_Writer

    volume = _volume(shape)[0]
    if _solids(shape) != 1 or volume < 0.1:
        return False
    BRepMesh_IncrementalMesh(shape, 0.01, False, 0.1)
    with TemporaryDirectory() as folder:
        path = f"{folder}/a.stl"
        StlAPI_Writer().Write(shape, path)
        by_triangles = float(trimesh.load_mesh(path).volume)
    return abs(by_triangles - volume) < 0.02 * volume


def _solids(shape: Any) -> int:
    from OCP.TopAbs import TopAbs_ShapeEnum

    from kilter.files.cad.step_surfaces import inside

    return len(list(inside(shape, TopAbs_ShapeEnum.TopAbs_SOLID)))


def _with_wires(shape: Any) -> Any:
    """The shape in a compound with an edge, which the reader ignores."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.gp import gp_Pnt
    from step_maker import compound

    return compound([shape, BRepBuilderAPI_MakeEdge(gp_Pnt(0, 0, 0), gp_Pnt(9, 9, 9)).Shape()])


def _volume(shape: Any) -> tuple[float, np.ndarray]:
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    found = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape, found, 1e-12)
    return float(found.Mass()), np.array(found.CentreOfMass().Coord())


def _measure(made: Made, nodes: list[Any], above: list[Any]) -> None:
    for name, content, move in nodes:
        moves = [*above, *([move] if move is not None else [])]
        if isinstance(content, list):
            _measure(made, content, moves)
            continue
        volume, center = _volume(content)
        for step in reversed(moves):
            matrix = np.array([[step.Value(i, j) for j in range(1, 5)] for i in range(1, 4)])
            center = matrix[:, :3] @ center + matrix[:, 3]
        made.volumes[name], made.centers[name] = volume, center


def _lose_a_face(rng: np.random.Generator, made: Made) -> None:
    """Remove a face of a solid from the list of its shell, in the text of the file."""
    text = made.path.read_text()
    shells = list(re.finditer(r"CLOSED_SHELL\('[^']*',\(([^)]*)\)\)", text))
    shell = shells[int(rng.integers(len(shells)))]
    faces = shell[1].split(",")
    if len(faces) < 2:
        return
    del faces[int(rng.integers(len(faces)))]
    start, end = shell.span(1)
    made.path.write_text(text[:start] + ",".join(faces) + text[end:])
    made.spoilt = set(made.volumes)  # the text does not show which solid has lost it
