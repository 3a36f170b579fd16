"""Small valid samples of every format that a command reads, with the command that reads it.

A sample has files by name. The first file is the one that is damaged; the others lie beside it.
The words of the command name files as ``{folder}/name``.
"""

import json
from dataclasses import dataclass, field
from functools import cache
from importlib.util import find_spec

from fuzz_corpus import corpus

from kilter.files import to_text
from kilter.scenes.stacks import tower


@dataclass(frozen=True)
class Sample:
    """Files by name, the damaged file first, and commands as words."""

    files: dict[str, bytes]
    commands: tuple[str, ...]
    share: int = field(default=8)
    """Number of cases of this sample among those of all samples."""

    @property
    def damaged(self) -> str:
        """Name of the file that is damaged."""
        return next(iter(self.files))


@cache
def samples() -> dict[str, Sample]:
    """Samples by the name of their format."""
    tower_file = {"tower.kilter.json": to_text(tower(2)).encode()}
    on_tower = "{folder}/tower.kilter.json"
    carried = (
        "transport {folder}/tower.kilter.json --path {folder}/path.csv --friction 0.5 --effort 0.2"
    )
    robot = carried + " --robot {folder}/robot.urdf --flange tool"
    found = {
        "choices": Sample(
            _choices(), ("check {folder}/choices.json", "contacts {folder}/choices.json")
        ),
        "straps": Sample(
            {"straps.json": STRAPS, **tower_file},
            (f"transport {on_tower} --straps {{folder}}/straps.json --accelerate 0.1g 0 0",
             f"hold {on_tower} --straps {{folder}}/straps.json"),
        ),
        "candidates": Sample(
            {"supports.json": SUPPORTS, **tower_file},
            (f"hold {on_tower} --candidates {{folder}}/supports.json --effort 0.2",),
        ),
        "packing CSV": Sample(
            {"plan.csv": PACKING},
            ("check-plan {folder}/plan.csv", "check {folder}/plan.csv --floor"),
        ),
        "BED-BPP": Sample(
            {"plan.json": _bed_bpp()},
            ("check-plan {folder}/plan.json", "check {folder}/plan.json --floor"),
        ),
        "sequence CSV": Sample(
            {"steps.csv": b"step,part\n1,cube-1\n2,cube-2\n", **tower_file},
            (f"plan {on_tower} --sequence {{folder}}/steps.csv",),
        ),
        "sequence JSON": Sample(
            {"steps.json": STEPS, **tower_file},
            (f"plan {on_tower} --sequence {{folder}}/steps.json",),
        ),
        "sequence text": Sample(
            {"steps.txt": b"# order\ncube-1\ncube-2\n", **tower_file},
            (f"plan {on_tower} --sequence {{folder}}/steps.txt",), 2,
        ),
        "carrier path": Sample({"path.csv": _poses(), **tower_file}, (carried,)),
        "acceleration path": Sample({"path.csv": ACCELERATIONS, **tower_file}, (carried,)),
        "robot path": Sample({"path.csv": JOINTS, "robot.urdf": ARM, **tower_file}, (robot,)),
        "robot": Sample({"robot.urdf": ARM, "path.csv": JOINTS, **tower_file}, (robot,)),
        "LDraw": Sample({"model.mpd": LDRAW}, ("check {folder}/model.mpd",)),
        "BrickGPT": Sample({"model.txt": b"2x4 (0,0,0)\n4x2 (0,1,1)\n1x1 (3,0,1)\n"},
                           ("check {folder}/model.txt",)),
        "StableLego": Sample({"model.json": STABLE_LEGO}, ("check {folder}/model.json",)),
        "COMPAS interfaces": Sample({"blocks.json": _interfaces()},
                                    ("check {folder}/blocks.json --contacts file",)),
        "placed part": Sample(
            {"part.kilter.json": PART, **tower_file},
            (f"place {on_tower} --part {{folder}}/part.kilter.json",
             "place {folder}/part.kilter.json --box 1x1x1 --mass 1 --floor"), 2,
        ),
        "settled scene": Sample(
            {"scene.kilter.json": PART},
            ("settle {folder}/scene.kilter.json --floor",
             "scene {folder}/scene.kilter.json --floor"), 2,
        ),
        "batch list": Sample({"list.txt": b"# files\ntower.kilter.json\n", **tower_file},
                             ("batch {folder}/list.txt -o {folder}/tables --processes 1",), 1),
        "batch manifest": Sample(
            {"tables/batch.json": MANIFEST, "list.txt": b"tower.kilter.json\n", **tower_file},
            ("batch {folder}/list.txt -o {folder}/tables --processes 1",), 1,
        ),
    }  # fmt: skip
    if find_spec("pxr") is not None:
        found["USD"] = Sample(
            {"room.usda": USD}, ("check {folder}/room.usda", "scene {folder}/room.usda"), 6
        )
    return found


def _choices() -> dict[str, bytes]:
    """Saved choices about a mesh file."""
    keys = {
        "kilter": 1,
        "file": "ascii.stl",
        "units": "mm",
        "floor": True,
        "held": ["ascii_1"],
        "left_out": ["ascii_3"],
        "friction": 0.3,
        "materials": [{"parts": "ascii*", "density": 2700, "name": "aluminium"}],
        "joined": [["ascii_1", "ascii_2"]],
        "open_pairs": [{"parts": ["ascii_1", "ascii_2"], "as": "touching"}],
        "loads": [{"part": "ascii_2", "point": [0, 0, 1], "force": [0, 0, -1]}],
        "poses": {"ascii_2": {"position": [0, 0, 0], "rotation": [1, 0, 0, 0]}},
        "tolerance": {"gap": 1e-3, "angle_deg": 0.1},
    }
    return {"choices.json": json.dumps(keys).encode(), "ascii.stl": corpus()["ascii.stl"]}


STEPS = b'{"steps": [{"parts": ["cube-1"]}, {"parts": ["cube-2"]}]}'
STRAPS = json.dumps(
    [
        {
            "name": "belt",
            "tension": 50.0,
            "mu": 0.2,
            "tensioned": "first",
            "path": [
                ["ground", [-2, 0, 0]],
                ["cube-2", [-0.5, 0, 2.0]],
                ["cube-2", [0.5, 0, 2.0]],
                ["ground", [2, 0, 0]],
            ],
        },
        {"capacity": 80.0, "path": [["ground", [0, 0, 6]], ["cube-2", [0, 0, 2.0]]]},
    ]
).encode()
SUPPORTS = json.dumps(
    [
        {"kind": "grip", "part": "cube-1"},
        {"kind": "finger", "part": "cube-2", "point": [0.5, 0, 1.5], "direction": [-1, 0, 0]},
    ]
).encode()
PACKING = b"""name;length/mm;width/mm;height/mm;mass/kg;x/mm;y/mm;z/mm;turned;max_load
crate;600;400;200;8;0;0;0;0;50
"box, small";300;200;150;2.5;0;0;200;90;
# a remark
lid;600;400;20;1;0;0;350;0;5
"""


def _bed_bpp() -> bytes:
    """Two orders of packed items."""

    def item(name: str, size: tuple[int, int, int], place: list[int], turned: int) -> object:
        lengths = dict(zip(("length/mm", "width/mm", "height/mm"), size, strict=True))
        entry = {"article": name, "id": name, **lengths, "weight/kg": 4.2, "sequence": 1}
        return {"item": entry, "flb_coordinates": place, "orientation": turned}

    first = [item("a", (600, 400, 220), [0, 0, 0], 0), item("b", (300, 200, 100), [0, 0, 220], 1)]
    return json.dumps({"order-1": first}).encode()


def _poses() -> bytes:
    """A carrier that starts, turns and stops."""
    rows = ["time,x,y,z,qw,qx,qy,qz"]
    for k in range(6):
        turn = 0.02 * k
        rows.append(f"{k * 0.2:g},{0.02 * k**2:g},0,{0.01 * k:g},{(1 - turn**2) ** 0.5},0,0,{turn}")
    return "\n".join(rows).encode()


ACCELERATIONS = b"""time,ax,ay,az,ox,oy,oz,alx,aly,alz,vx,vy,vz
0,0.1,0,0,0,0,0.1,0,0,0.2,0,0,0
0.5,0.2,0.1,0,0,0,0.2,0,0,0.1,0.1,0,0
1,0,0,0.3,0,0,0.1,0,0,0,0.2,0,0
"""
JOINTS = b"time,turn,lift\n0,0,0\n0.5,0.1,0.02\n1,0.3,0.05\n1.5,0.4,0.06\n"
ARM = b"""<robot name="arm">
  <link name="base"/><link name="upper"/><link name="tool"/>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.4" rpy="0 0 0.1"/>
    <axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
  <joint name="lift" type="prismatic">
    <parent link="upper"/><child link="tool"/><origin xyz="0.3 0 0"/>
    <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
</robot>
"""
LDRAW = b"""0 FILE house.ldr
0 Name: house
1 4 0 0 0 1 0 0 0 1 0 0 0 1 wall.ldr
1 16 0 -24 0 0 0 1 0 1 0 -1 0 0 3001.dat
2 24 0 0 0 1 1 1
0 FILE wall.ldr
1 16 0 0 0 1 0 0 0 1 0 0 0 1 3001.dat
1 2 80 0 0 1 0 0 0 1 0 0 0 1 3001.dat
"""
STABLE_LEGO = json.dumps(
    {
        "1": {"x": 0, "y": 0, "z": 0, "brick_id": 2, "ori": 0},
        "2": {"x": 1, "y": 0, "z": 1, "brick_id": 3, "ori": 1},
        "3": {"x": 0, "y": 1, "z": 2, "brick_id": 2, "ori": 1},
    }
).encode()


def _interfaces() -> bytes:
    """COMPAS blocks with an interface of each form."""
    data = json.loads(corpus()["blocks.json"])
    points = [[-0.5, -0.5, 0.5], [0.5, -0.5, 0.5], [0.5, 0.5, 0.5], [-0.5, 0.5, 0.5]]
    above = [[x, y, z + 1] for x, y, z in points]
    frame = {"point": points[0], "xaxis": [1, 0, 0], "yaxis": [0, 1, 0]}
    data["data"]["graph"]["data"]["edge"] = {
        "0": {"1": {"interfaces": [{"points": points, "frame": frame}]}},
        "1": {"2": {"interface_points": above, "interface_uvw": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}},
    }
    return json.dumps(data).encode()


PART = b'{"kilter": 1, "parts": [{"name": "crate", "box": [0.6, 0.4, 0.3], "mass": 3}]}'
MANIFEST = b"""{"kilter_batch": 1, "files": 1, "listed": "00", "question": {"require": "proved",
 "effort": 1, "time_limit": null, "tolerance": [0, 1e-5, 0.001, 0]}, "rows": 1000, "form": "csv"}
"""
USD = b"""#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    upAxis = "Z"
)

def Xform "World"
{
    def PhysicsScene "Physics"
    {
        vector3f physics:gravityDirection = (0, 0, -1)
        float physics:gravityMagnitude = 9.81
    }

    def Cube "Table" (prepend apiSchemas = ["PhysicsCollisionAPI"])
    {
        double size = 1
        float3 xformOp:scale = (4, 4, 0.2)
        double3 xformOp:translate = (0, 0, -0.1)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]
    }

    def Xform "Crate" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
    {
        float physics:mass = 2.5
        double3 xformOp:translate = (0, 0, 0.5)
        quatf xformOp:orient = (1, 0, 0, 0)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]

        def Cube "Shape" (prepend apiSchemas = ["PhysicsCollisionAPI"])
        {
            double size = 1
        }
    }

    def Xform "Can" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])
    {
        double3 xformOp:translate = (1.2, 0, 0.4)
        uniform token[] xformOpOrder = ["xformOp:translate"]

        def Cylinder "Shape" (prepend apiSchemas = ["PhysicsCollisionAPI"])
        {
            uniform token axis = "Z"
            double height = 0.8
            double radius = 0.2
        }

        def Mesh "Handle" (prepend apiSchemas = ["PhysicsCollisionAPI", "PhysicsMeshCollisionAPI"])
        {
            int[] faceVertexCounts = [3, 3, 3, 3]
            int[] faceVertexIndices = [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2]
            point3f[] points = [(0.2, 0, 0), (0.4, 0, 0), (0.2, 0.2, 0), (0.2, 0, 0.2)]
            uniform token physics:approximation = "convexHull"
        }
    }

    def PhysicsFixedJoint "Screw"
    {
        rel physics:body0 = </World/Crate>
        rel physics:body1 = </World/Can>
        point3f physics:localPos0 = (0.5, 0, 0)
        quatf physics:localRot0 = (1, 0, 0, 0)
    }

    def PointInstancer "Balls"
    {
        point3f[] positions = [(-1, 0, 0.1), (-1.4, 0, 0.1)]
        int[] protoIndices = [0, 0]
        rel prototypes = [</World/Balls/Ball>]

        def Sphere "Ball" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsCollisionAPI"])
        {
            double radius = 0.1
        }
    }
}
"""
