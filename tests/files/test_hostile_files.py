"""Damaged and hostile files: exit 2, one sentence, no file left, little time and memory."""

import json
import os
import time
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter.cli import main
from kilter.errors import InputError
from kilter.files import limits
from kilter.files.meshes.glb import read_glb
from kilter.scenes import scene

SECONDS = 5.0
"""Largest CPU time of a case [s]."""
MEMORY = 300_000
"""Largest growth of the memory of this process in a case [kB]."""
BOX = {"name": "b", "box": [1, 1, 1], "pose": {"position": [0, 0, 1]}}
STACK = {"kilter": 1, "parts": [{"name": "a", "box": [1, 1, 1], "grounded": True}, BOX]}
HEADER = "name,length,width,height,mass,x,y,z\n"
ITEM = {"article": "x", "length/mm": 1, "width/mm": 1, "height/mm": 1, "weight/kg": 1}
LARGE = 10**309
"""An integer beyond the largest float."""
UNIT = "1 0 0 0 1 0 0 0 1"
LONG = "a" * 4000


def order(item: dict[str, Any] | None = None, **entry: Any) -> str:
    """BED-BPP data of one order with one item."""
    item = {**ITEM, **(item or {})}
    return json.dumps({"o": [{"item": item, "flb_coordinates": [0, 0, 0], **entry}]})


def doubling(last: str, levels: int = 40) -> str:
    """An LDraw file whose models contain the next model twice."""
    lines = []
    for k in range(levels):
        lines += [f"0 FILE m{k}.ldr", *[f"1 16 0 0 0 {UNIT} m{k + 1}.ldr"] * 2]
    return "\n".join([*lines, f"0 FILE m{levels}.ldr", last])


LISTS = [
    ("cell.csv", HEADER + f"{'a' * 140_000},1,1,1,1,0,0,0\n", "line 2: field larger than field"),
    ("cr.csv", HEADER + "a\rb,1,1,1,1,0,0,0\n", "line 2: length is ''"),
    ("long.csv", HEADER + "\n" * 2 * limits.MOST_LISTED, "make 200,001 boxes; the limit is"),
    ("bytes.csv", b"\xff", "not UTF-8 at byte 0"),
    ("infinity.json", order(orientation=float("inf")), "item 1: orientation is inf; give 0 or 1"),
    ("true.json", order(orientation=True), "item 1: orientation is True"),
    ("share.json", order(orientation=0.9), "item 1: orientation is 0.9"),
    ("text.json", order({"length/mm": "000"}), "item 1: length/mm is '000'"),
    ("bool.json", order({"weight/kg": True}), "item 1: weight/kg is True"),
    ("large.json", order({"width/mm": LARGE}), "item 1: width/mm is 1000"),
    ("place.json", order(flb_coordinates=[LARGE, 0, 0]), "item 1: flb_coordinates is 1000"),
    ("point.json", order(flb_coordinates=5), "item 1 has no item or no place"),
    ("name.json", order({"article": [1]}), "item 1: its name is no text"),
    ("half.json", order({"article": "\ud800"}), "half of a surrogate pair, near"),
]
PATHS = [
    ("", "the file is empty"),
    ("time,ax,ay,az\n", "the path has no samples"),
    ("time,x,y,z\n0,0,0,0\n1e-300,1,0,0\n2e-300,1e300,0,0\n", "no finite accelerations"),
    ("time,x,y,z\n0,0,0,0\n1,1e308,0,0\n2,-1e308,0,0\n", "no finite accelerations"),
    ("time,x,x,y,z\n0,0,0,0,0\n1,1,0,0,0\n2,2,0,0,0\n", "two columns 'x'"),
    (f"time,x,y,z\n{'1' * 140_000},0,0,0\n", "field larger than field limit"),
]
SEQUENCES = [
    ("s.json", '{"steps": true}', "the file has no sequence"),
    ("s.json", '{"steps": 3}', "the file has no sequence"),
    ("s.csv", f"part\n{'a' * 140_000}\n", "field larger than field limit"),
    ("s.csv", "part\rb\rx\r", "no part is named 'x'"),
]
BRICKS = [
    ("m.ldr", doubling(f"1 4 0 0 0 {UNIT} 3001.dat"), "make 1,099,511,627,776 parts; the limit is"),
    ("m.ldr", doubling("0 end"), "the file has no bricks"),
    ("m.ldr", doubling(f"1 4 0 0 0 {UNIT} x.dat"), "make 1,099,511,627,776 parts; the limit is"),
    ("m.ldr", doubling("", 300), "is nested too deeply"),
    ("m.json", '{"1": {"x": 0, "y": 0, "z": 0, "brick_id": 2, "ori": true}}', "has ori True"),
    ("m.json", f'{{"1": {{"x": {LARGE}, "y": 0, "z": 0, "brick_id": 2, "ori": 0}}}}', "has x 1000"),
]  # fmt: skip
BRICKS += [
    (
        "m.txt",
        "1x1 (0,0,0)\n" * (limits.MOST_LISTED + 1),
        "make 100,001 parts; the limit is 100,000",
    ),
]
OTHERS = [
    ("choices.json", json.dumps({"kilter": 1, "file": LONG + ".step"}), "is not in the folder"),
    ("choices.json", '{"kilter": 1, "file": "\\ud800.step"}', "half of a surrogate pair"),
    ("mesh.json", json.dumps({"kilter": 1, "parts": [{"name": "m", "mesh": LONG + ".stl"}]}),
     "cannot be read"),
    ("many.json", "[" + "0," * 1200 + "0]", "its JSON has 1,201 values; the limit is 1,000"),
]  # fmt: skip


@pytest.fixture(autouse=True)
def soon(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Little time and memory; the working folder is the folder of the files."""
    monkeypatch.chdir(tmp_path)
    resource = pytest.importorskip("resource", reason="it measures memory on POSIX only")
    before, started = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss, time.process_time()
    yield
    assert time.process_time() - started < SECONDS
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < MEMORY


def refused(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    """The sentence of a command that refuses its file; no file is left."""
    before = set(os.listdir())
    assert main(list(words)) == 2
    answer = capsys.readouterr()
    assert answer.out == ""
    assert answer.err.count("\n") == 1
    assert answer.err.startswith("kilter: ")
    assert len(answer.err) < 600
    assert set(os.listdir()) == before
    return answer.err


def write(name: str, content: str | bytes) -> str:
    data = content if isinstance(content, bytes) else content.encode()
    Path(name).write_bytes(data)
    return name


@pytest.mark.parametrize(("name", "text", "words"), LISTS, ids=[row[0] for row in LISTS])
def test_packing_lists(name, text, words, capsys):
    assert words in refused(capsys, "check-plan", write(name, text))


def test_an_order_that_is_no_list(capsys):
    data = {**json.loads(order()), "second": 5}
    write("orders.json", json.dumps(data))
    words = refused(capsys, "check-plan", "orders.json", "--order", "second")
    assert "the order 'second' has no items" in words


def test_a_table_may_end_its_lines_with_cr():
    rows = (HEADER + "a,1,1,1,1,0,0,0\n").replace("\n", "\r")
    assert kilter.check_plan(write("plan.csv", rows)).stands


@pytest.mark.parametrize(("text", "words"), PATHS, ids=range(len(PATHS)))
def test_paths_of_carriers(text, words, capsys):
    write("stack.json", json.dumps(STACK))
    write("path.csv", text)
    assert words in refused(capsys, "transport", "stack.json", "--path", "path.csv")


ROBOT = """<robot name="r"><link name="base"/><link name="tool"/><joint name="q" type="prismatic">
<parent link="base"/><child link="tool"/><axis xyz="0 0 1"/>
<limit lower="-1e305" upper="1e305" effort="1" velocity="1"/></joint></robot>"""


def test_paths_of_robots(capsys):
    write("stack.json", json.dumps(STACK))
    write("robot.urdf", ROBOT)
    write("path.csv", "time,q\n0,0\n1e-5,1e304\n2e-5,-1e304\n")
    words = ("--path", "path.csv", "--robot", "robot.urdf", "--flange", "tool")
    assert "no finite accelerations" in refused(capsys, "transport", "stack.json", *words)


@pytest.mark.parametrize(("name", "text", "words"), SEQUENCES, ids=range(len(SEQUENCES)))
def test_sequences(name, text, words, capsys):
    write("stack.json", json.dumps(STACK))
    write(name, text)
    assert words in refused(capsys, "plan", "stack.json", "--sequence", name)


@pytest.mark.parametrize(("name", "text", "words"), BRICKS, ids=range(len(BRICKS)))
def test_models_of_bricks(name, text, words, capsys):
    assert words in refused(capsys, "check", write(name, text))


def test_models_without_bricks_may_be_placed_without_end():
    text = doubling("0 end").replace("0 FILE m1.ldr", f"1 4 0 0 0 {UNIT} 3001.dat\n0 FILE m1.ldr")
    assert len(kilter.load(write("m.ldr", text)).parts) == 2


@pytest.mark.parametrize(("name", "text", "words"), OTHERS, ids=range(len(OTHERS)))
def test_kilter_files(name, text, words, capsys, monkeypatch):
    monkeypatch.setattr("kilter.files.complaints.MOST_VALUES", 1000)
    assert words in refused(capsys, "check", write(name, text))


def test_a_name_of_70000_letters_is_cut(capsys):
    data = json.loads(json.dumps(STACK).replace('"b"', f'"{"b" * 70_000}"'))
    data["parts"][1]["pose"]["position"] = [0, 0, 1.4]
    assert main(["check", write("stack.json", json.dumps(data))]) == 1
    answer = capsys.readouterr()
    assert "touches nothing: 'bbbb" in answer.err
    assert len(answer.out) + len(answer.err) < 1200


def test_a_path_of_a_file_of_4000_letters(capsys):
    assert "File name too long" in refused(capsys, "check", LONG + ".json")


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="no endless file")
@pytest.mark.parametrize("words", [["transport", "stack.json", "--path", "/dev/zero"],
                                   ["batch", "/dev/zero", "-o", "tables"]])  # fmt: skip
def test_an_endless_file(words, capsys):
    write("stack.json", json.dumps(STACK))
    assert "larger than 50 MB, the largest size that is read" in refused(capsys, *words)


def chain(count: int, name: str = "node {}") -> bytes:
    """A GLB whose nodes form a chain, each with a name and the same tetrahedron, side by side."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "<f4")
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    binary = corners[faces.reshape(-1)].tobytes()
    nodes = [{"name": name.format(k), "mesh": 0, "children": [k + 1]} for k in range(count - 1)]
    header = {
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [*nodes, {"name": name.format(count), "mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 12, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(binary)}],
        "buffers": [{"byteLength": len(binary)}],
    }
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    chunks = [
        len(data).to_bytes(4, "little") + kind + data
        for kind, data in ((b"JSON", text), (b"BIN\0", binary))
    ]
    size = (12 + sum(map(len, chunks))).to_bytes(4, "little")
    return b"".join([b"glTF", (2).to_bytes(4, "little"), size, *chunks])


@pytest.mark.quick(1)
@pytest.mark.parametrize("count", [8000, 30_000])
def test_nodes_in_a_chain(count, capsys):
    message = refused(capsys, "check", write("a.glb", chain(count)), "--floor")
    assert f"nodes of the GLB are nested deeper than {limits.DEEPEST}" in message


def test_nodes_of_one_name_in_a_chain_keep_all_their_names():
    """Only the whole path tells a node from the others."""
    solids, _ = read_glb(chain(limits.DEEPEST, "n"))
    assert [name for name, _ in solids] == ["/".join("n" * k) for k in range(1, len(solids) + 1)]


MODEL = (
    '<model><resources><object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/>'
    '<vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices>'
    '<triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>'
    '<triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles></mesh></object>'
    '<object id="2"><mesh><vertices/><triangles/></mesh></object></resources>'
    '<build><item objectid="1"/><item objectid="2"/></build></model>'
)


@pytest.mark.parametrize("packing", [zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2, zipfile.ZIP_DEFLATED])
def test_a_damaged_member_of_a_3mf(packing, capsys):
    with zipfile.ZipFile("a.3mf", "w", packing) as archive:
        archive.writestr("3D/3dmodel.model", MODEL)
    data = bytearray(Path("a.3mf").read_bytes())
    data[60:120] = bytes(255 - byte for byte in data[60:120])
    message = refused(capsys, "check", write("a.3mf", bytes(data)), "--floor")
    assert "the file is damaged: " in message


def test_an_object_of_a_3mf_without_triangles_is_told(capsys):
    with zipfile.ZipFile("a.3mf", "w") as archive:
        archive.writestr("3D/3dmodel.model", MODEL)
    assert kilter.load("a.3mf").notes == ("1 objects without triangles are ignored",)


def components(levels: int) -> str:
    """Objects of a 3MF, each of which contains the next."""
    rows = [
        f'<object id="{k}"><components><component objectid="{k + 1}"/></components></object>'
        for k in range(levels)
    ]
    return (
        f'<model><resources>{"".join(rows)}</resources><build><item objectid="0"/></build></model>'
    )


@pytest.mark.slow
def test_components_of_a_3mf_in_a_chain(capsys):
    with zipfile.ZipFile("a.3mf", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("3D/3dmodel.model", components(30_000))
    assert "nested deeper than 200" in refused(capsys, "check", "a.3mf", "--floor")


@pytest.mark.parametrize("text", ["[1]", "[" * 100_000, '{"form": 5, "rows": "x"}', ""])
def test_a_folder_of_another_batch(text, capsys):
    write("stack.json", json.dumps(STACK))
    write("list.txt", "stack.json\n")
    Path("tables").mkdir()
    write("tables/batch.json", text)
    assert "has another batch" in refused(capsys, "batch", "list.txt", "-o", "tables")
    assert os.listdir("tables") == ["batch.json"]


@pytest.mark.slow
def test_a_batch_with_names_that_no_encoder_writes(capsys):
    """One such name ended the batch, and left its folder without a table."""
    write("stack.json", json.dumps(STACK))
    write("half.json", '{"kilter": 1, "file": "\\ud800.step"}')
    write("list.txt", f"stack.json\nhalf.json\n{LONG}.json\n")
    assert main(["batch", "list.txt", "-o", "tables", "--processes", "1"]) == 1
    assert "2 error, 1 stable" in capsys.readouterr().out
    assert "half of a surrogate pair" in Path("tables/part-000000.csv").read_text("utf-8")


STATES: list[dict[str, Any]] = [
    {"ground": [5]},
    {"ground": None},
    {"contacts": 5},
    {"time_limit": "x"},
    {"accelerations": 5},
    {"accelerations": "abc"},
    {"accelerations": [[1, 2]]},
    {"accelerations": [None]},
]


@pytest.mark.parametrize("options", STATES, ids=str)
def test_states_with_wrong_types(options):
    with pytest.raises(InputError):
        kilter.states(scene("tower"), **options)


@pytest.mark.parametrize(
    "names", [5, None, [5], [["cube-1"]], b"x", [b"x"], object()], ids=lambda n: type(n).__name__
)
def test_names_of_a_state_with_wrong_types(names):
    with pytest.raises(InputError, match="is no text; give a name, or a list"):
        kilter.states(scene("tower")).of(names)


def test_places_on_two_bodies_at_the_same_place():
    """No smaller cell of the map can be decided, so it is not halved: 27 s became 1 s."""
    data = json.loads(json.dumps(STACK))
    del data["parts"][1]["pose"]
    answer = kilter.place(write("same.json", json.dumps(data)), kilter.box_to_place([1, 1, 1], 1.0))
    assert answer.undecided
    assert answer.programs < 40  # each load asks the parts near it first
