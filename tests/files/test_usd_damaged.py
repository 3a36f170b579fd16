"""USD files that are damaged or hostile: a sentence, exit 2, and nothing else."""

import os
from pathlib import Path

import pytest

import kilter
from kilter import InputError
from kilter.cli import main

POSIX = pytest.mark.skipif(os.name != "posix", reason="pipes, links or signals of POSIX")

pytest.importorskip("pxr")

HEAD = '#usda 1.0\n(\n    defaultPrim = "World"\n    upAxis = "Z"\n    metersPerUnit = 1\n)\n'
BODY = 'prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"]'
SOLID = 'prepend apiSchemas = ["PhysicsCollisionAPI"]'
FLOOR = f'def Cube "floor" ({SOLID})\n{{\ndouble size = 1\n}}\n'


def stage(inside: str, head: str = HEAD) -> str:
    return head + f'def Xform "World"\n{{\n{inside}}}\n'


def body(name: str = "a", inside: str = "", shape: str = "double size = 1") -> str:
    """A rigid body with a cube; `inside` are attributes of the body, `shape` of the cube."""
    return (
        f'def Xform "{name}" ({BODY})\n{{\n{inside}\ndouble3 xformOp:translate = (0, 0, 1)\n'
        'uniform token[] xformOpOrder = ["xformOp:translate"]\n'
        f'def Cube "c" ({SOLID})\n{{\n{shape}\n}}\n}}\n'
    )


def joint(kind: str, inside: str) -> str:
    return f'def Physics{kind}Joint "j"\n{{\n{inside}\n}}\n'


def shape(kind: str, inside: str) -> str:
    return f'def {kind} "s" ({SOLID})\n{{\n{inside}\n}}\n'


def instancer(inside: str, prototypes: str = "</World/i/p>") -> str:
    return (
        f'def PointInstancer "i"\n{{\nrel prototypes = {prototypes}\n{inside}\n'
        f'def Cube "p" ({SOLID})\n{{\ndouble size = 1\n}}\n}}\n'
    )


ONE = "rel physics:body0 = </World/floor>\n"
TWO = ONE + "rel physics:body1 = </World/a>\n"
TRIANGLE = "point3f[] points = [(0,0,0), (1,0,0), (0,1,0)]\n"
LAID = "int[] protoIndices = [0, 0]\npoint3f[] positions = [(0,0,0), (3,0,0)]\n"
MATERIAL = (
    'def Material "m" (prepend apiSchemas = ["PhysicsMaterialAPI"])\n{\n'
    "float physics:staticFriction = nan\n}\n"
)
BOUND = (
    f'def Cube "b" ({SOLID[:-1]}, "MaterialBindingAPI"])\n{{\n'
    "rel material:binding:physics = </World/m>\n}\n"
)
DAMAGED = {
    "a mistyped body": (
        FLOOR + body() + joint("Fixed", ONE + "rel physics:body1 = </World/aa>"),
        "/World/j.physics:body1 names /World/aa, which does not exist; correct its path",
    ),
    "a property as a body": (
        FLOOR + body() + joint("Fixed", ONE + "rel physics:body1 = </World/a.visibility>"),
        "which does not exist",
    ),
    "two bodies at an end": (
        FLOOR + body() + joint("Fixed", "rel physics:body0 = [</World/floor>, </World/a>]"),
        "names 2 bodies; name a single body",
    ),
    "a body without a shape": (
        FLOOR + body() + f'def Xform "e" ({BODY})\n{{\n}}\n'
        + joint("Fixed", ONE + "rel physics:body1 = </World/e>"),
        "names /World/e, which has no shape; give it a shape",
    ),
    "an axis of a joint": (
        FLOOR + body() + joint("Revolute", TWO + 'uniform token physics:axis = "W"'),
        "/World/j.physics:axis is 'W'; use X, Y, Z",
    ),
    "the type of an axis": (
        FLOOR + body() + joint("Revolute", TWO + "double physics:axis = 3"),
        "/World/j.physics:axis is '3.*'; use X, Y, Z",
    ),
    "a place of a joint": (
        FLOOR + body() + joint("Revolute", TWO + 'string physics:localPos0 = "here"'),
        "localPos0 has a value that is no point3f; give a value of this type",
    ),
    "a rotation of a joint": (
        FLOOR + body() + joint("Revolute", TWO + "float physics:localRot0 = 1"),
        "localRot0 has a value that is no quatf",
    ),
    "a rotation that is not finite": (
        FLOOR + body() + joint("Revolute", TWO + "quatf physics:localRot0 = (nan, 0, 0, 1)"),
        "localRot0 has a number that is not finite",
    ),
    "an axis of a cylinder": (shape("Cylinder", 'uniform token axis = "w"'), "axis is 'w'; use X"),
    "a radius as a word": (
        shape("Sphere", 'string radius = "big"'),
        "radius has a value that is no double",
    ),
    "a radius as a file": (
        shape("Sphere", "asset radius = @r@"),
        "radius has a value that is no double",
    ),
    "a size without a number": (shape("Cube", "double size = nan"), "size has a number that is"),
    "a negative height": (shape("Capsule", "double height = -1"), "height is -1; give a length"),
    "a negative cone": (shape("Cone", "double height = -1"), "height is -1; give a length"),
    "no radius": (shape("Cylinder", "double radius = 0"), "radius is 0; give a length above zero"),
    "an endless radius": (shape("Sphere", "double radius = inf"), "radius is inf; give a length"),
    "a mesh without faces": (shape("Mesh", TRIANGLE), "the mesh 's' has no faces"),
    "a face of other corners": (
        shape("Mesh", TRIANGLE + "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0,1,9]"),
        "the faces of the mesh 's' are inconsistent",
    ),
    "no corners": (
        shape("Mesh", "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]"),
        "the faces of the mesh 's' are inconsistent",
    ),
    "points of another type": (
        shape("Mesh", "double points = 3\nint[] faceVertexCounts = [3]"),
        "points has a value that is no point3f",
    ),
    "no indices": (
        instancer("point3f[] positions = [(0,0,0)]"),
        "protoIndices has no value; give the attribute a value",
    ),
    "fewer positions": (
        instancer("int[] protoIndices = [0, 0]\npoint3f[] positions = [(0,0,0)]"),
        "point instancer /World/i has 2 indices and 1 positions; give all its attributes",
    ),
    "positions of another type": (
        instancer(LAID.replace("point3f[] positions", "asset positions").replace(
            "[(0,0,0), (3,0,0)]", "@a@"
        )),
        "positions has a value that is no point3f",
    ),
    "an index too large": (
        instancer(LAID.replace("[0, 0]", "[0, 7]")),
        "has the index 7, but 1 prototypes; correct its protoIndices",
    ),
    "a negative index": (instancer(LAID.replace("[0, 0]", "[0, -1]")), "has the index -1, but 1"),
    "a prototype that does not exist": (
        instancer(LAID, "</World/i/q>"),
        "has the prototype /World/i/q, which does not exist",
    ),
    "prototypes in a loop": (
        instancer(LAID, "</World/i.prototypes>"),
        "has the index 0, but 0 prototypes",
    ),
    "an orientation that is not finite": (
        instancer(LAID + "quath[] orientations = [(nan,0,0,0), (1,0,0,0)]"),
        "not finite|singular",
    ),
    "a transform that is not finite": (
        FLOOR + body(inside="quatf xformOp:orient = (nan, 0, 0, 0)").replace(
            '["xformOp:translate"]', '["xformOp:translate", "xformOp:orient"]'
        ),
        "/World/a.xformOp:orient has a number that is not finite",
    ),
    "a mass that is no number": (
        body(inside="float physics:mass = nan"),
        "mass has a number that is not finite",
    ),
    "an infinite inertia": (
        body(inside="float3 physics:diagonalInertia = (inf, 1, 1)"),
        "diagonalInertia is .*; give finite numbers",
    ),
    "a mode of friction": (
        BOUND + 'def Material "m" (prepend apiSchemas = ["PhysicsMaterialAPI"])\n{\n'
        'uniform token physxMaterial:frictionCombineMode = "most"\n}\n',
        "frictionCombineMode is 'most'; use average, min, multiply, max",
    ),
    "a negative mass": (body(inside="float physics:mass = -1"), "mass"),
    "a mass as a word": (
        body(inside='string physics:mass = "1"'),
        "mass has a value that is no float",
    ),
    "a friction that is no number": (
        FLOOR + MATERIAL + BOUND,
        "staticFriction has a number that is not finite",
    ),
    "a gravity that is no number": (
        'def PhysicsScene "p"\n{\nfloat physics:gravityMagnitude = nan\n}\n' + body(),
        "gravityMagnitude has a number that is not finite",
    ),
    "a direction that is no number": (
        'def PhysicsScene "p"\n{\nvector3f physics:gravityDirection = (nan, 0, 0)\n}\n' + body(),
        "gravityDirection has a number that is not finite",
    ),
}  # fmt: skip
HEADS = {
    "another axis": (HEAD.replace('"Z"', '"W"'), "upAxis is 'W'; use Y or Z"),
    "x upwards": (HEAD.replace('"Z"', '"X"'), "upAxis is 'X'; use Y or Z"),
    "no length": (HEAD.replace("= 1\n", "= 0\n"), "metersPerUnit is 0"),
    "no mass": (
        HEAD.replace("= 1\n", "= 1\n    kilogramsPerUnit = nan\n"),
        "kilogramsPerUnit is nan",
    ),
    "a length as a word": (HEAD.replace("= 1\n", '= "one"\n'), "metersPerUnit|the USD is invalid"),
}


def refused(path: Path, words: str, capfd: pytest.CaptureFixture[str]) -> None:
    """The command ends with exit 2 and a single sentence; USD has not written to a stream."""
    assert main(["check", str(path)]) == 2
    out, error = capfd.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert error.startswith(f"kilter: {path}: ")
    with pytest.raises(InputError, match=words):
        kilter.load(path)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", DAMAGED)
def test_a_damaged_stage_is_a_sentence(name, tmp_path, capfd):
    inside, words = DAMAGED[name]
    path = tmp_path / "scene.usda"
    path.write_text(stage(inside))
    refused(path, words, capfd)


@pytest.mark.parametrize("name", HEADS)
def test_damaged_metadata_is_a_sentence(name, tmp_path, capfd):
    head, words = HEADS[name]
    path = tmp_path / "scene.usda"
    path.write_text(stage(body(), head))
    refused(path, words, capfd)


def test_text_that_is_not_utf_8_is_a_sentence(tmp_path, capfd):
    path = tmp_path / "scene.usda"
    path.write_bytes(stage(FLOOR + body()).encode().replace(b'"a"', b'"\xff\xfe"'))
    refused(path, "the USD is invalid: |the file is damaged: ", capfd)
    path.write_bytes(stage(shape("Cube", 'uniform token purpose = "\xff"')).encode("latin-1"))
    assert main(["check", str(path), "--floor", "--quiet"]) in (0, 2)
    assert "Traceback" not in capfd.readouterr().err


def test_joints_to_the_world_and_defaults_are_read(tmp_path):
    path = tmp_path / "scene.usda"
    hinge = joint("Revolute", 'rel physics:body1 = </World/a>\nuniform token physics:axis = "Y"')
    path.write_text(stage(FLOOR + body() + hinge))
    [found] = kilter.load(path).joints
    assert (found.parts, found.kind, found.axis.tolist()) == (
        ("ground", "a"), "revolute", [0, 1, 0]
    )  # fmt: skip
    path.write_text(stage(FLOOR + body() + joint("Fixed", "")))
    assert kilter.load(path).notes == ("ignored joints: 1",)


def bomb(levels: int, arc: str) -> str:
    """Prims with two children each, which both name the prim before: 2^n cubes."""
    text = '#usda 1.0\nclass Xform "r0"\n{\ndef Cube "c"\n{\n}\n}\n'
    for k in range(1, levels):
        arcs = f"prepend {arc} = </r{k - 1}>"
        text += f'class Xform "r{k}"\n{{\ndef "x" ({arcs})\n{{\n}}\ndef "y" ({arcs})\n{{\n}}\n}}\n'
    return text + f'def Xform "World" (prepend {arc} = </r{levels - 1}>)\n{{\n}}\n'


@pytest.mark.parametrize("arc", ["references", "payload", "inherits", "specializes"])
def test_arcs_that_double_the_prims_are_counted_before(arc, tmp_path, capfd):
    path = tmp_path / "bomb.usda"
    path.write_text(bomb(20, arc))
    refused(path, r"the file would make [\d,]{7,9} parts; the limit is 50,000", capfd)
    path.write_text(bomb(50, arc))
    refused(path, "the file would make more than 10.15 parts", capfd)


def test_files_that_double_one_another_are_counted_before(tmp_path, capfd):
    for k in range(20):
        arcs = f"(prepend references = @./m{k + 1}.usda@)"
        inside = f'def "x" {arcs}\n{{\n}}\ndef "y" {arcs}\n{{\n}}\n'
        (tmp_path / f"m{k}.usda").write_text(stage(inside))
    (tmp_path / "m20.usda").write_text(stage(FLOOR))
    refused(tmp_path / "m0.usda", "the file would make 1,048,576 parts; the limit", capfd)


def test_files_that_name_one_another_in_a_loop_are_no_bomb(tmp_path):
    path = tmp_path / "scene.usda"
    again = 'def "x" (prepend references = @./scene.usda@)\n{\n}\n'
    sub = HEAD.replace("upAxis", "subLayers = [@./scene.usda@]\n    upAxis")
    path.write_text(stage(FLOOR + body() + again, sub))
    found = kilter.load(path)
    assert len(found.parts) == 4
    assert any("USD reports" in note for note in found.notes)


@POSIX
@pytest.mark.parametrize("arc", ["references", "payload", "subLayers"])
def test_a_pipe_is_not_opened(arc, tmp_path, capfd):
    os.mkfifo(tmp_path / "pipe.usda")
    path = tmp_path / "scene.usda"
    head = HEAD.replace("upAxis", "subLayers = [@./pipe.usda@]\n    upAxis")
    named = f'def "x" (prepend {arc} = @./pipe.usda@)\n{{\n}}\n'
    path.write_text(stage(FLOOR, head) if arc == "subLayers" else stage(FLOOR + named))
    refused(path, "'pipe.usda' is not a regular file; name a file", capfd)


def test_warnings_of_usd_are_a_single_note_with_their_number(tmp_path, capfd):
    missing = "".join(
        f'def Xform "m{k}" (prepend references = </Nowhere{k}>)\n{{\n}}\n' for k in range(73)
    )
    path = tmp_path / "scene.usda"
    path.write_text(stage(FLOOR + missing))
    [note] = [note for note in kilter.load(path).notes if "USD" in note]
    assert note.startswith("USD reports 73 faults, such as: ")
    assert capfd.readouterr() == ("", "")
