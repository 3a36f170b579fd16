"""Whole small files of every format that kilter reads: what mutations start from."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import trimesh

from kilter.files import to_text
from kilter.scenes import scene

SCENES = ("paper-figure-8", "trapped-wedge", "tower", "slope-with-friction", "three-cylinders")
MESHES = ("stl", "obj", "glb", "3mf")


@cache
def corpus() -> dict[str, bytes]:
    """Files by name; the name's ending says the format."""
    found = {f"{name}.kilter.json": to_text(scene(name)).encode() for name in SCENES}
    found["joined.kilter.json"] = _joined()
    found |= {f"pile.{ending}": _meshes(ending) for ending in MESHES}
    found["ascii.stl"] = _ascii_stl()
    found["blocks.json"] = _compas()
    found |= _step()
    return found


def _boxes() -> dict[str, trimesh.Trimesh]:
    boxes = {}
    for k, name in enumerate(("base", "middle", "top")):
        boxes[name] = trimesh.creation.box([2 - k / 2, 2 - k / 2, 1])
        boxes[name].apply_translation([0, 0, k])
    return boxes


def _joined() -> bytes:
    """Every key of the kilter file at once."""
    data = {
        "kilter": 1,
        "units": "mm",
        "gravity": [0, 0, -9.81],
        "friction": 0.3,
        "parts": [
            {"name": "table", "box": [400, 400, 100], "grounded": True},
            {
                "name": "block",
                "box": [100, 100, 100],
                "pose": {"position": [0, 0, 100], "rotation": [1, 0, 0, 0]},
                "density": 7850,
            },
            {
                "name": "wedge",
                "polygon": [[0, 0], [40, 0], [40, 30]],
                "depth": 10,
                "pose": {"position": [100, 0, 50]},
            },
            {
                "name": "pin",
                "cylinder": {"radius": 20, "height": 50},
                "pose": {"position": [-100, 0, 75]},
                "mass": 0.25,
                "center_of_mass": [0, 0, 1],
            },
            {"name": "ball", "sphere": {"radius": 20}, "pose": {"position": [-100, 100, 70]}},
        ],
        "friction_pairs": [{"parts": ["table", "block"], "mu": 0.5}],
        "loads": [
            {"part": "block", "point": [0, 0, 150], "force": [0, 0, -5], "torque": [0, 0, 0]}
        ],
        "joints": [{"parts": ["table", "pin"], "kind": "fixed"}],
        "contacts": [
            {"parts": ["table", "wedge"], "points": [[100, 0, 50]], "normal": [0, 0, 1], "mu": 0.2}
        ],
    }
    return json.dumps(data).encode()


def _meshes(ending: str) -> bytes:
    pile = trimesh.Scene(_boxes())
    if ending in ("stl", "obj"):
        return bytes(
            _encoded(trimesh.util.concatenate(list(_boxes().values())).export(None, ending))
        )
    return bytes(_encoded(pile.export(None, ending)))


def _encoded(content: str | bytes) -> bytes:
    return content.encode() if isinstance(content, str) else content


def _ascii_stl() -> bytes:
    mesh = trimesh.util.concatenate(list(_boxes().values()))
    return _encoded(mesh.export(None, "stl_ascii"))


def _compas() -> bytes:
    """Two blocks as COMPAS 2 writes them: a graph whose nodes hold meshes."""
    nodes = {}
    for k, box in enumerate(_boxes().values()):
        vertices = {
            str(v): dict(zip("xyz", p, strict=True)) for v, p in enumerate(box.vertices.tolist())
        }
        faces = {str(f): [int(v) for v in face] for f, face in enumerate(box.faces)}
        mesh = {"dtype": "compas.datastructures/Mesh", "data": {"vertex": vertices, "face": faces}}
        nodes[str(k)] = {"block": mesh, "is_support": k == 0}
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": nodes, "edge": {}}}
    assembly = {"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": graph}}
    return json.dumps(assembly).encode()


def _step() -> dict[str, bytes]:
    """A STEP file of one box, where OCCT is installed."""
    try:
        from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
        from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer
    except ImportError:
        return {}
    from kilter.files.occt import quiet

    with TemporaryDirectory() as folder, quiet():
        path = Path(folder) / "box.step"
        writer = STEPControl_Writer()
        whole = STEPControl_StepModelType.STEPControl_AsIs
        writer.Transfer(BRepPrimAPI_MakeBox(10.0, 20.0, 30.0).Shape(), whole)
        writer.Write(str(path))
        return {"box.step": path.read_bytes()}


def numbers(rng: np.random.Generator) -> str:
    """A number as a file may hold it: ordinary, extreme or none at all."""
    extreme = "0 -0 1e308 -1e308 1e-308 nan inf -1 2147483648 1e39 4294967295 0.1 1e12 1e-12"
    if rng.random() < 0.3:
        return repr(float(rng.normal() * 10.0 ** rng.integers(-6, 7)))
    return str(rng.choice([*extreme.split(), "99999999999999999999", "", "x", "1,5"]))
