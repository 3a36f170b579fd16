"""MJCF files that are damaged or hostile: a sentence, exit 2, and nothing else."""

import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

import kilter
from kilter import InputError
from kilter.cli import main
from kilter.files.robots import scene_process

POSIX = pytest.mark.skipif(os.name != "posix", reason="pipes, links or signals of POSIX")

mujoco = pytest.importorskip("mujoco")


def mjcf(world: str = "", rest: str = "") -> str:
    return f"<mujoco>{rest}<worldbody>{world}</worldbody></mujoco>"


BOX = '<body><freejoint/><geom type="box" size=".5 .5 .5"/></body>'
MANY = '<replicate count="1000" offset="1 0 0">'
END = "</replicate>"
COUNTED = {
    "a replicate": (mjcf(f'<replicate count="1e6" offset="1 0 0">{BOX}{END}'), "1,000,000 parts"),
    "nested replicates": (mjcf(MANY * 2 + BOX + END * 2), "1,000,000 parts"),
    "geoms of the world": (mjcf(MANY * 2 + '<geom size="1"/>' + END * 2), "1,000,000 parts"),
    "many replicates": (mjcf(MANY * 9 + BOX + END * 9), "more than 10^15 parts"),
    "sites": (mjcf(BOX + MANY * 2 + '<site size="1"/>' + END * 2), r"1,00\d,\d{3} elements"),
    "a flexible grid": (
        mjcf('<flexcomp name="f" type="grid" count="1000 1000 1000" spacing="1 1 1"/>'),
        "1,000,000,001 elements",
    ),
    "keyframes": (mjcf(BOX, '<size nkey="100000000"/>'), "100,000,000 keyframes"),
    "a height field": (
        mjcf(BOX, '<asset><hfield name="h" nrow="50000" ncol="50000" size="1 1 1 1"/></asset>'),
        "2,500,000,000 points of height fields",
    ),
    "a generated mesh": (
        mjcf(BOX, '<asset><mesh builtin="supertorus" params="9000 .5 1 1"/></asset>'),
        "81,000,000 triangles",
    ),
    "a plate": (
        mjcf(BOX, '<asset><mesh builtin="plate" params="30000 1000"/></asset>'),
        "30,000,000 triangles",
    ),
    "a texture": (
        mjcf(BOX, '<asset><texture builtin="flat" width="90000" height="90000"/></asset>'),
        "8,100,000,000 pixels of textures",
    ),
}
EMPTY = "the file has no bodies: it is made to be included; give the scene that includes it"
DAMAGED = {
    "an empty world": (mjcf(), EMPTY),
    "assets only": (mjcf(rest='<asset><material name="m"/></asset>'), EMPTY),
    "no replica": (mjcf(f'<replicate count="-1">{BOX}{END}'), "[Nn]o|MuJoCo rejects"),
    "a body without a geom": (
        mjcf('<body><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body>'),
        "no body has a geom; give its bodies geoms",
    ),
    "an unknown encoding": (
        '<?xml version="1.0" encoding="none-such"?>' + mjcf(BOX),
        "the XML is invalid: unknown encoding",
    ),
    "a wrong size": (mjcf('<geom size="-1"/>'), "MuJoCo rejects it"),
    "a height field in use": (
        mjcf(
            '<geom type="hfield" hfield="h"/>',
            '<asset><hfield name="h" nrow="600" ncol="600" size="1 1 1 1"/></asset>',
        ),
        "the file has more than 250,000 points of height fields; make it coarser",
    ),
    "a mesh without volume": (
        mjcf(
            '<geom type="mesh" mesh="m"/>',
            '<asset><mesh name="m" vertex="0 0 0  1 0 0  0 1 0  1 1 0"/></asset>',
        ),
        "MuJoCo rejects it",
    ),
    "too large an array": (mjcf(BOX, '<size nuserdata="2000000000"/>'), "memory"),
    "deep nesting": (
        mjcf("<body>" * 3000 + '<geom size="1"/>' + "</body>" * 3000),
        "the file is damaged: maximum recursion depth|MuJoCo rejects it",
    ),
}


def refused(path: Path, words: str, capfd: pytest.CaptureFixture[str]) -> None:
    """The command ends with exit 2 and a single sentence; no library has written to a stream."""
    before = sorted(os.listdir())
    assert main(["check", str(path)]) == 2
    out, error = capfd.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert error.startswith(f"kilter: {path}: ")
    with pytest.raises(InputError, match=words):
        kilter.load(path)
    assert capfd.readouterr() == ("", "")
    assert sorted(os.listdir()) == before


@pytest.mark.parametrize("name", COUNTED)
def test_counts_are_limited_before_anything_is_built(name, tmp_path, capfd):
    text, count = COUNTED[name]
    path = tmp_path / "bomb.xml"
    path.write_text(text)
    refused(path, rf"^{path}: the file would make {count.replace('^', '.')}; the limit is ", capfd)


@pytest.mark.parametrize("name", DAMAGED)
@pytest.mark.slow
def test_a_damaged_scene_is_a_sentence(name, tmp_path, capfd):
    text, words = DAMAGED[name]
    path = tmp_path / "scene.xml"
    path.write_text(text)
    refused(path, words, capfd)


@pytest.mark.parametrize(
    "element",
    [
        '<asset><mesh file="pipe.stl"/></asset>',
        '<asset><mesh file="/somewhere/pipe.stl"/></asset><compiler strippath="true"/>',
        '<compiler meshdir="."/><asset><texture type="2d" file="pipe.stl"/></asset>',
        '<include file="pipe.stl"/>',
        '<asset><model name="m" file="pipe.stl"/></asset>',
    ],
)
@POSIX
def test_a_pipe_is_not_opened(element, tmp_path, capfd):
    os.mkfifo(tmp_path / "pipe.stl")
    path = tmp_path / "scene.xml"
    path.write_text(mjcf(BOX, element))
    refused(path, "'pipe.stl' is not a regular file; name a file", capfd)


@POSIX
def test_a_pipe_in_a_folder_of_meshes_is_not_opened(tmp_path, capfd):
    os.mkfifo(tmp_path / "pipe.stl")
    refused(tmp_path, "'pipe.stl' is not a regular file; name a file", capfd)


def attaching(name: str, body: str = "") -> str:
    """A scene that attaches a model, or a body of it, twice."""
    named = f'body="{body}"' if body else ""
    twice = "".join(f'<attach model="m" {named} prefix="{k}_"/>' for k in "ab")
    return mjcf(BOX + twice, f'<asset><model name="m" file="{name}"/></asset>')


def test_a_model_that_attaches_itself_is_refused_and_the_next_one_is_read(tmp_path, capfd):
    """It crashed MuJoCo."""
    one, two, good = (tmp_path / f"{name}.xml" for name in ("one", "two", "good"))
    one.write_text(attaching("one.xml"))
    refused(one, "the model 'one.xml' attaches itself; remove the element <attach>", capfd)
    one.write_text(attaching("two.xml"))
    two.write_text(attaching("one.xml"))
    refused(one, "the model 'one.xml' attaches itself", capfd)
    good.write_text(mjcf(BOX))
    assert kilter.load(good).names == ("body_1",)


def test_models_that_attach_one_another_are_counted_as_a_product(tmp_path, capfd):
    files = [tmp_path / f"m{k}.xml" for k in range(21)]
    for path, below in pairwise(files):
        path.write_text(attaching(below.name))
    files[-1].write_text(mjcf(BOX))
    refused(files[0], r"would make [34],\d{3},\d{3} parts; the limit is 50,000", capfd)


def test_a_scene_that_includes_itself_is_refused(tmp_path, capfd):
    path = tmp_path / "scene.xml"
    path.write_text(mjcf(BOX + '<include file="scene.xml"/>'))
    refused(path, "MuJoCo rejects it: .*already included", capfd)


def test_valid_scenes_with_includes_replicas_and_attached_models_are_read(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "one.xml").write_text(f"<mujoco>{BOX}</mujoco>")
    (tmp_path / "two.xml").write_text(mjcf(BOX.replace("<body>", '<body name="b">')))
    path = tmp_path / "scene.mjcf"
    path.write_text(
        mjcf(
            '<include file="parts/one.xml"/>'
            f'<replicate count="3" offset="2 0 0"><frame pos="0 5 0">{BOX}</frame></replicate>'
            '<frame><attach model="m" body="b" prefix="a_"/></frame>',
            '<asset><model name="m" file="two.xml"/></asset>',
        )
    )
    assert len(kilter.load(path).parts) == 5
    assert len(kilter.load(path.rename(path.with_suffix(".xml"))).parts) == 5


# the process --------------------------------------------------------------------------------

CRASHES = {
    "segv": ("os.kill(os.getpid(), signal.SIGSEGV)", "MuJoCo crashes on it; simplify it"),
    "exit": ("os._exit(3)", "MuJoCo crashes on it; simplify it"),
    "spin": ("\n    while True: pass", "MuJoCo does not finish within 0 s; simplify it"),
    "memory": ("raise MemoryError", "takes too much memory; leave parts out"),
}


@pytest.mark.slow
@pytest.mark.parametrize("how", CRASHES)
def test_the_end_of_the_process_is_a_sentence(how, tmp_path, monkeypatch):
    code, words = CRASHES[how]
    (tmp_path / f"reader_{how}.py").write_text(
        "import os, signal\n"
        "from kilter.files.reader_guard import serve_requests\n"
        "def serve(): serve_requests(lambda: read)\n"
        f"def read(*_): {code}\n"
    )
    path = tmp_path / "scene.xml"
    path.write_text(mjcf(BOX))
    with monkeypatch.context() as broken:
        scene_process._end()
        start = scene_process.ReaderProcess
        broken.syspath_prepend(tmp_path)
        broken.setattr(scene_process, "ReaderProcess", lambda _: start(f"reader_{how}"))
        broken.setattr(scene_process, "STALLS", 0.4)
        with pytest.raises(InputError, match=words):
            kilter.load(path)
        scene_process._end()
    assert kilter.load(path).names == ("body_1",)


def test_a_fault_in_the_process_stays_a_fault_of_kilter(tmp_path, capsys, monkeypatch):
    path = tmp_path / "scene.xml"
    path.write_text(mjcf(BOX))
    monkeypatch.setattr(
        scene_process, "_request", lambda *_: (9.0, ("mjcf", (3, "a", ()), None, None, None))
    )
    assert main(["check", str(path)]) == 70
    assert "ReaderFault: TypeError" in capsys.readouterr().err


def test_all_arrays_of_the_parts_are_read_only(tmp_path):
    path = tmp_path / "scene.xml"
    path.write_text(
        mjcf(
            BOX + '<body><freejoint/><geom type="mesh" mesh="m"/></body>',
            '<asset><mesh name="m" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/></asset>',
        )
    )
    box, mesh = kilter.load(path).parts
    arrays = [mesh.shape.vertices, mesh.shape.triangles, mesh.pose.position, box.shape.size]
    assert not any(array.flags.writeable for array in arrays)


@pytest.mark.slow
def test_no_log_and_no_text_of_a_library_is_left(tmp_path):
    """MuJoCo writes a log into the current folder and a warning to the error stream."""
    nan = '<body pos="nan 0 0"><freejoint/><geom size="1"/></body>'
    (tmp_path / "nan.xml").write_text(mjcf(nan))
    command = [sys.executable, "-m", "kilter", "check", "nan.xml", "--quiet"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("kilter: nan.xml: pose has a number that is not finite")
    assert done.stderr.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["nan.xml"]
    direct = f"import mujoco; mujoco.MjModel.from_xml_string({mjcf(nan)!r})"
    done = subprocess.run([sys.executable, "-c", direct], cwd=tmp_path, capture_output=True)
    assert b"NaN" in done.stderr
    assert (tmp_path / "MUJOCO_LOG.TXT").exists()
    os.remove(tmp_path / "MUJOCO_LOG.TXT")


def test_memory_that_is_used_is_measured(tmp_path, monkeypatch):
    path = tmp_path / "scene.xml"
    side = 1000
    plate = f'<mesh name="m" builtin="plate" params="{side} {side}"/>'
    path.write_text(mjcf('<geom type="mesh" mesh="m"/>', f"<asset>{plate}</asset>"))
    monkeypatch.setattr(scene_process, "MEMORY", 100_000_000)
    with pytest.raises(InputError, match=r"MuJoCo takes more than 0\.1 GB of memory for it"):
        kilter.load(path)
