"""Whole small files of every format that kilter reads: what mutations start from."""

import io
import json
import re
import zipfile
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import trimesh

from kilter.files import to_text
from kilter.files.robots.mjcf import to_mjcf
from kilter.scenes import scene
from kilter.scenes.stacks import tower

SCENES = {
    "paper-figure-8": "paper-figure-8",
    "trapped-wedge": "trapped-wedge",
    "slope": "slope-with-friction",
    "three-cylinders": "three-cylinders",
}
MESHES = ("stl", "obj", "glb", "3mf")
PRINTED = ("box.step", "boxes.FCStd")
"""Files whose reader is a process of its own: too slow for options by the thousand."""


@cache
def corpus() -> dict[str, bytes]:
    """Files by name; the name's ending says the format."""
    found = {f"{name}.kilter.json": to_text(scene(of)).encode() for name, of in SCENES.items()}
    found["tower.kilter.json"] = to_text(tower(2)).encode()
    found["joined.kilter.json"] = _joined()
    found["robot.urdf"] = ROBOT
    if find_spec("mujoco") is not None:
        found["scene.xml"] = to_mjcf(tower(2)).encode()
    found |= {f"pile.{ending}": _meshes(ending) for ending in MESHES}
    found["ascii.stl"] = _ascii_stl()
    found["blocks.json"] = _compas()
    found["model.json"] = _compas_model()
    found |= _step()
    return found


ROBOT = b"""<?xml version="1.0"?>
<robot name="arm">
  <link name="base"><collision><geometry><box size="1 1 0.2"/></geometry></collision></link>
  <link name="arm">
    <inertial><mass value="2"/><origin xyz="0 0 0.2"/></inertial>
    <collision>
      <origin xyz="0 0 0.3" rpy="0 0.1 0"/>
      <geometry><cylinder radius="0.1" length="0.5"/></geometry>
    </collision>
  </link>
  <link name="ball"><visual><geometry><sphere radius="0.1"/></geometry></visual></link>
  <joint name="hinge" type="revolute">
    <parent link="base"/><child link="arm"/><origin xyz="0 0 0.1"/><axis xyz="0 1 0"/>
  </joint>
  <joint name="tip" type="fixed">
    <parent link="arm"/><child link="ball"/><origin xyz="0 0 0.7" rpy="0 0 0"/>
  </joint>
</robot>
"""


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
                "inertia": [60, 70, 80, 5, -5, 2],
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


def _compas_model() -> bytes:
    """A model of compas_dem with two blocks, and a problem with loads about it."""
    graph = json.loads(_compas())["data"]["graph"]
    turn = [[0, -1, 0, 1], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    elements = {}
    for key, node in graph["data"]["node"].items():
        place = {"dtype": "compas.geometry/Transformation", "data": {"matrix": turn}}
        data = {"geometry": node["block"], "transformation": place, "material": "m"}
        data["is_support"] = node["is_support"]
        elements[f"e{key}"] = {"dtype": "compas_dem.elements/Block", "data": data}
    graph["data"]["node"] = {key: {"element": f"e{key}"} for key in graph["data"]["node"]}
    stone = {"dtype": "compas_dem.material/Stone", "data": {"density": 2000.0}}
    children = [{"element": key, "children": []} for key in elements]
    content = {"elements": elements, "graph": graph["data"], "materials": {"m": stone}}
    content |= {"tree": {"root": {"children": children}}, "transformation": None}
    model = {"dtype": "compas_dem.models/BlockModel", "data": content, "guid": "model"}
    loads = {
        "body_forces": [{"data": {"acceleration": [0.1, 0, 0]}, "dtype": "compas_dem.x/B"}],
        "point_loads": [{"data": {"block_index": 1, "force": [0, 0, -1.0]}, "dtype": "compas.x/P"}],
        "surface_loads": [
            {"data": {"block_index": 1, "face_index": 0, "load": [0, 1, 0]}, "dtype": "compas.x/S"}
        ],
    }
    law = {"dtype": "compas_dem.interactions/MohrCoulomb", "data": {"mu": 0.5, "c": None}}
    problem = {
        "dtype": "compas_dem.problem/Problem",
        "data": {
            "model_id": "model",
            "boundary_conditions": [{"dtype": "compas_dem.problem/Group", "data": loads}],
            "contact_properties": {"dtype": "compas.x/C", "data": {"contact_model": law}},
        },
    }
    return json.dumps([model, problem]).encode()


def _step() -> dict[str, bytes]:
    """A STEP file of one box, and a FreeCAD document of two, where OCCT is installed."""
    try:
        from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox
        from OCP.BRepTools import BRepTools
        from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer
    except ImportError:
        return {}
    from kilter.files.cad.step_surfaces import quiet

    box, shape, document = BRepPrimAPI_MakeBox(10.0, 20.0, 30.0).Shape(), io.BytesIO(), io.BytesIO()
    BRepTools.Write_s(box, shape)
    with zipfile.ZipFile(document, "w") as archive:
        archive.writestr(zipfile.ZipInfo("Document.xml"), FREECAD)
        archive.writestr(zipfile.ZipInfo("box.brp"), shape.getvalue())
    with TemporaryDirectory() as folder, quiet():
        path = Path(folder) / "box.step"
        writer = STEPControl_Writer()
        whole = STEPControl_StepModelType.STEPControl_AsIs
        writer.Transfer(box, whole)
        writer.Write(str(path))
        # without the time at which it was written: a case is the same at any other
        step = re.sub(rb"\d{4}-\d\d-\d\dT[\d:]+", b"", path.read_bytes())
    return {"box.step": step, "boxes.FCStd": document.getvalue()}


FREECAD = b"""<?xml version='1.0' encoding='utf-8'?>
<Document FileVersion="1">
  <Objects>
    <Object type="Assembly::AssemblyObject" name="Assembly"/>
    <Object type="Part::Box" name="Box"/>
    <Object type="App::Link" name="Copy"/>
    <Object type="App::FeaturePython" name="Held"/>
    <Object type="App::FeaturePython" name="Joint"/>
  </Objects>
  <ObjectData>
    <Object name="Assembly"><Properties><Property name="Group"><LinkList count="4">
      <Link value="Box"/><Link value="Copy"/><Link value="Held"/><Link value="Joint"/>
    </LinkList></Property></Properties></Object>
    <Object name="Box"><Properties>
      <Property name="Shape"><Part file="box.brp"/></Property>
      <Property name="Placement"><PropertyPlacement Px="1" Q3="1"/></Property>
    </Properties></Object>
    <Object name="Copy"><Properties>
      <Property name="LinkedObject"><XLink file="" name="Box"/></Property>
      <Property name="Placement"><PropertyPlacement Pz="30" Q2="0.6" Q3="0.8"/></Property>
    </Properties></Object>
    <Object name="Held"><Properties>
      <Property name="ObjectToGround"><Link value="Box"/></Property>
    </Properties></Object>
    <Object name="Joint"><Properties>
      <Property name="JointType"><Integer value="3"/></Property>
      <Property name="Reference1"><XLink name="Copy"><Sub value="Face1"/></XLink></Property>
      <Property name="Reference2"><XLink name="Box"><Sub value="Face2"/></XLink></Property>
      <Property name="Placement1"><PropertyPlacement Px="1" Q3="1"/></Property>
    </Properties></Object>
  </ObjectData>
</Document>"""


def numbers(rng: np.random.Generator) -> str:
    """A number as a file may hold it: ordinary, extreme or none at all."""
    extreme = "0 -0 1e308 -1e308 1e-308 nan inf -1 2147483648 1e39 4294967295 0.1 1e12 1e-12"
    if rng.random() < 0.3:
        return repr(float(rng.normal() * 10.0 ** rng.integers(-6, 7)))
    return str(rng.choice([*extreme.split(), "99999999999999999999", "", "x", "1,5"]))
