"""Bounds on the memory, time and paths that a file may demand; the message states the bound."""

import json
import os
import time
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter.errors import InputError
from kilter.files import limits
from kilter.files import limits as raw
from kilter.files.meshes.placed import natural_key

MODEL = '<?xml version="1.0"?><model unit="millimeter">{}</model>'
TETRAHEDRON = (
    '<mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>'
    '<vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles>'
    '<triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>'
    '<triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles></mesh>'
)
SECONDS = 10.0
"""CPU time [s]: without its bound each case took minutes, or all of the memory."""


@pytest.fixture(autouse=True)
def soon() -> Any:
    started = time.process_time()
    yield
    assert time.process_time() - started < SECONDS


def refused(path: Path, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        kilter.load(path)
    assert len(str(caught.value)) < 400


def threemf(path: Path, body: str) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", MODEL.format(body))
    return path


def doubled(mesh: str, levels: int) -> str:
    """A 3MF object with two copies of an object with two copies ... of a mesh."""
    objects = [f'<object id="0">{mesh}</object>']
    for k in range(1, levels + 1):
        two = f'<component objectid="{k - 1}"/>' * 2
        objects.append(f'<object id="{k}"><components>{two}</components></object>')
    return f'<resources>{"".join(objects)}</resources><build><item objectid="{levels}"/></build>'


@pytest.mark.slow
def test_a_zip_unfolds_to_no_more_than_its_size_allows(tmp_path):
    refused(threemf(tmp_path / "a.3mf", " " * 100_000_000), "a zip of 0.1 MB unpacks to 100 MB")


def test_a_zip_may_unfold_as_far_as_meshes_do(tmp_path):
    """Both sides of the limit: 16 MB for any zip, and a multiple of its size."""
    limits.require_unfolded(limits.SMALL, 1)
    limits.require_unfolded(limits.MOST_FOLD * 10**6, 10**6)
    for size, held in ((limits.SMALL + 1, 1), (limits.MOST_FOLD * 10**6 + 1, 10**6)):
        with pytest.raises(InputError, match=r"a zip of .* MB unpacks to"):
            limits.require_unfolded(size, held)
    with pytest.raises(InputError, match="the limit is 1,000 MB"):
        limits.require_unfolded(limits.MOST_BYTES + 1, limits.MOST_BYTES)


@pytest.mark.parametrize("mesh", [TETRAHEDRON, "<mesh/>"], ids=["meshes", "nothing"])
def test_components_do_not_double_for_ever(mesh, tmp_path, monkeypatch):
    few = threemf(tmp_path / "few.3mf", doubled(TETRAHEDRON, 4))
    assert len(kilter.load(few, keep_copies=True)) == 16
    assert len(kilter.load(few)) == 1
    monkeypatch.setattr(limits.Tally.__init__, "__defaults__", ("triangles", 10_000))
    refused(threemf(tmp_path / "many.3mf", doubled(mesh, 40)), "more than 10,000 triangles")


def test_an_xml_has_no_more_entries_than_are_read(tmp_path, monkeypatch):
    path = threemf(tmp_path / "a.3mf", doubled(TETRAHEDRON, 0))
    with zipfile.ZipFile(path) as archive:
        text = archive.read("3D/3dmodel.model")
    count = text.count(b"<") + text.count(b"=")
    monkeypatch.setattr(limits, "MOST_ENTRIES", count)
    assert len(kilter.load(path)) == 1
    monkeypatch.setattr(limits, "MOST_ENTRIES", count - 1)
    refused(path, f"{count} tags and attributes; the limit is {count - 1}")


def test_entities_are_not_read(tmp_path):
    entities = "".join(f'<!ENTITY e{k + 1} "{f"&e{k};" * 10}">' for k in range(9))
    laughs = (
        f'<!DOCTYPE r [<!ENTITY e0 "ha">{entities}]><robot name="&e9;"><link name="a"/></robot>'
    )
    path = tmp_path / "a.urdf"
    path.write_text(laughs, "utf-8")
    refused(path, "its XML has a document type definition")
    path.write_bytes(laughs.encode("utf-16"))  # kilter's own check misses it, expat does not
    refused(path, "the XML is invalid")


@pytest.mark.slow
@pytest.mark.parametrize("many", ["nodes", "primitives"])
def test_one_mesh_of_a_glb_does_not_stand_a_million_times(many, tmp_path):
    count, corners = 20_000, 3000
    primitive = {"attributes": {"POSITION": 0}}
    header = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 12 * corners}],
        "bufferViews": [{"buffer": 0, "byteLength": 12 * corners}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": corners, "type": "VEC3"}],
        "meshes": [{"primitives": [primitive] * (count if many == "primitives" else 1)}],
        "nodes": [{"mesh": 0}] * (count if many == "nodes" else 1),
    }
    binary = np.random.default_rng(0).random((corners, 3)).astype("<f4").tobytes()
    path = tmp_path / "a.glb"
    path.write_bytes(glb(header, binary))
    refused(path, "the file has more than 10,000,000 triangles")


def glb(header: dict[str, Any], binary: bytes) -> bytes:
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    chunks = [(b"JSON", text), (b"BIN\0", binary)]
    body = b"".join(len(data).to_bytes(4, "little") + kind + data for kind, data in chunks)
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body


def test_one_mesh_file_does_not_stand_a_million_times(tmp_path, monkeypatch):
    (tmp_path / "tip.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", "utf-8"
    )
    parts = [{"name": f"p{k}", "mesh": "tip.obj"} for k in range(10)]
    path = tmp_path / "a.kilter.json"
    path.write_text(json.dumps({"kilter": 1, "parts": parts}), "utf-8")
    monkeypatch.setattr(limits.Tally.__init__, "__defaults__", ("triangles", 40))
    assert len(kilter.load(path)) == 10
    monkeypatch.setattr(limits.Tally.__init__, "__defaults__", ("triangles", 39))
    refused(path, "part 'p9': the file has more than 39 triangles")


def test_a_file_larger_than_is_read_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "a.kilter.json"
    path.write_text('{"kilter": 1, "parts": [{"name": "a", "box": [1, 1, 1]}]}', "utf-8")
    size = path.stat().st_size
    monkeypatch.setattr(raw.read_bytes, "__kwdefaults__", {"most": size})
    assert len(kilter.load(path)) == 1
    monkeypatch.setattr(raw.read_bytes, "__kwdefaults__", {"most": size - 1})
    refused(path, "the largest size that is read")


STEP = "ISO-10303-21;\n{}\nEND-ISO-10303-21;"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.step", STEP.format("/* " * 300_000), "damaged STEP|needs OCCT|not installed"),
        ("b.step", STEP.format("'" + "/* " * 300_000), "damaged STEP|not installed"),
        ("c.step", STEP.format(f"#1=A(#{'9' * 5000});"), r"such as #9{20};"),
        ("a.kilter.json", "[" * 200_000 + "]" * 200_000, "nested too deeply"),
        ("b.kilter.json", '{"kilter": 1, "parts": ' + "[" * 900 + "]" * 900 + "}", "is a list"),
        ("a.obj", "v 0 0 0\n" + "\\\n" * 500_000, "no faces"),
        ("a.urdf", '<robot name="r">' + "<a>" * 200_000 + "</a>" * 200_000 + "</robot>", "link"),
    ],
    ids=lambda value: value if len(value) < 20 else "",
)
def test_text_that_asks_for_much_time(name, text, words, tmp_path):
    path = tmp_path / name
    path.write_text(text, "utf-8")
    refused(path, words)


def compas(vertex: dict[str, Any], node: str = "0") -> dict[str, Any]:
    corners = {
        str(k): {"x": x, "y": y, "z": z} for k, (x, y, z) in enumerate(np.eye(4, 3).tolist())
    }
    faces = {"0": [0, 2, 1], "1": [0, 1, 3], "2": [1, 2, 3], "3": [0, 3, 2]}
    block = {"dtype": "compas.datastructures/Mesh", "data": {"vertex": corners, "face": faces}}
    corners["0"] |= vertex
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": {node: {"block": block}}}}
    return {"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": graph}}


def test_numbers_of_thousands_of_digits(tmp_path):
    """A long number is rejected as a coordinate, and accepted in a name."""
    path = tmp_path / "a.json"
    path.write_text(json.dumps(compas({"x": 10**400})), "utf-8")
    refused(path, "vertex 0 is .*; give three numbers")
    path.write_text(json.dumps(compas({}, node="9" * 5000)), "utf-8")
    assert kilter.load(path).names == ("9" * 5000,)
    assert natural_key("a2") < natural_key("a10") < natural_key("a" + "9" * 5000)
    assert natural_key("a2") < natural_key("a010") < natural_key("a11")


@pytest.mark.slow
def test_a_robot_of_a_long_chain(tmp_path):
    """A chain written from its tip to its root: the parent of each link comes last."""
    links = [f'<link name="l{k}"/>' for k in range(5000)]
    links[-1] = (
        '<link name="l4999"><visual><geometry><box size="1 1 1"/></geometry></visual></link>'
    )
    joints = [
        f'<joint name="j{k}" type="fixed"><parent link="l{k}"/><child link="l{k + 1}"/>'
        '<origin xyz="0 0 0.5"/></joint>'
        for k in range(4999)
    ]
    path = tmp_path / "a.urdf"
    path.write_text(f'<robot name="r">{"".join([*joints, *links][::-1])}</robot>', "utf-8")
    assert kilter.load(path).parts[0].pose.position.tolist() == [0, 0, 4999 / 2]


def named(path: Path, mesh: str) -> Path:
    if path.suffix == ".urdf":
        shape = f'<geometry><mesh filename="{mesh}"/></geometry>'
        text = f'<robot name="r"><link name="a"><visual>{shape}</visual></link></robot>'
    else:
        text = json.dumps({"kilter": 1, "parts": [{"name": "a", "mesh": mesh}]})
    path.write_text(text, "utf-8")
    return path


@pytest.fixture
def folders(tmp_path: Path) -> Path:
    """Meshes in a folder, below it, beside it, and elsewhere."""
    obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    for folder in ("far", "package/meshes", "package/own/below"):
        (tmp_path / folder).mkdir(parents=True)
    for place in ("far", "package/meshes", "package/own", "package/own/below"):
        (tmp_path / place / "tip.obj").write_text(obj, "utf-8")
    return tmp_path / "package" / "own"


@pytest.mark.parametrize("file", ["a.kilter.json", "a.urdf"])
@pytest.mark.parametrize("mesh", ["tip.obj", "below/tip.obj", "below/../tip.obj", "./tip.obj"])
def test_a_file_names_files_of_its_folder(file, mesh, folders):
    assert len(kilter.load(named(folders / file, mesh))) == 1


@pytest.mark.parametrize("file", ["a.kilter.json", "a.urdf"])
def test_a_file_names_none_beyond_its_folder(file, folders):
    far = folders.parents[1] / "far" / "tip.obj"
    for mesh in ("../../far/tip.obj", str(far), "below/../../../far/tip.obj"):
        refused(named(folders / file, mesh), "leads out of the folder of the file")
    beside = named(folders / file, "../meshes/tip.obj")
    if file == "a.urdf":  # the usual place of the meshes of robots
        assert len(kilter.load(beside)) == 1
    else:
        refused(beside, "leads out of the folder of the file")


@pytest.mark.skipif(os.name != "posix", reason="links and pipes of POSIX")
@pytest.mark.parametrize("file", ["a.kilter.json", "a.urdf"])
def test_links_lead_nowhere_else(file, folders):
    (folders / "in.obj").symlink_to("below/tip.obj")
    (folders / "out.obj").symlink_to("../../far/tip.obj")
    (folders / "zero.obj").symlink_to("/dev/zero")
    os.mkfifo(folders / "pipe.obj")
    assert len(kilter.load(named(folders / file, "in.obj"))) == 1
    refused(named(folders / file, "out.obj"), "leads out of the folder")
    refused(named(folders / file, "zero.obj"), "leads out of the folder")
    refused(named(folders / file, "pipe.obj"), "is not a regular file")


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="limits of POSIX")
def test_too_little_memory_is_one_sentence(tmp_path):
    import subprocess
    import sys

    program = (
        "import resource, sys, kilter.cli, kilter.cli.judging, kilter.files.own.kilter_json\n"
        "import kilter.analysis.check\n"
        "held = int(open('/proc/self/statm').read().split()[0]) * resource.getpagesize()\n"
        "resource.setrlimit(resource.RLIMIT_AS, (held + 2**26,) * 2)\n"
        "sys.exit(kilter.cli.main(['check', sys.argv[1]]))\n"
    )
    path = tmp_path / "a.kilter.json"
    parts = [{"name": f"p{k}", "box": [1, 1, 1]} for k in range(100_000)]
    path.write_text(json.dumps({"kilter": 1, "parts": parts}), "utf-8")
    command = [sys.executable, "-c", program, str(path)]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stderr.count("\n")) == (2, 1)
    assert ended.stderr.startswith("kilter: not enough memory; ")
