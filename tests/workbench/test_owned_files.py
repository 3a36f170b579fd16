"""The workbench writes only its own files, and reads only the opened folder."""

from __future__ import annotations

import csv
import io
import os
import re
import urllib.request
from collections.abc import Callable
from pathlib import Path

import pytest
from driver import Page

import kilter
from kilter.errors import InputError
from kilter.files.writing import write_text
from kilter.scenes import scene
from kilter.workbench.history import autosave_path, upload_autosave_path
from kilter.workbench.server import Workbench

POSIX = pytest.mark.skipif(os.name != "posix", reason="links and pipes of POSIX")
VICTIM = b"export PATH=/usr/bin\n"


def to_file(link: Path, victim: Path) -> None:
    link.symlink_to(victim)


def to_nothing(link: Path, victim: Path) -> None:
    link.symlink_to(victim.with_name("gone"))


def to_folder(link: Path, victim: Path) -> None:
    link.symlink_to(victim.parent, target_is_directory=True)


def pipe(link: Path, victim: Path) -> None:
    os.mkfifo(link)


@pytest.fixture
def victim(tmp_path: Path) -> Path:
    path = tmp_path / "home" / "profile"
    path.parent.mkdir()
    path.write_bytes(VICTIM)
    return path


TRAPS = [to_file, to_nothing, to_folder, pipe]


@POSIX
@pytest.mark.parametrize("trap", TRAPS)
def test_an_owned_file_replaces_no_link(
    trap: Callable[[Path, Path], None], victim: Path, tmp_path: Path
) -> None:
    place = tmp_path / "owned.json"
    trap(place, victim)
    before = sorted(os.listdir(tmp_path)), sorted(os.listdir(victim.parent))
    with pytest.raises(InputError, match=r"owned\.json: is (a link|no regular file)"):
        write_text(place, "text", links=False)
    assert (sorted(os.listdir(tmp_path)), sorted(os.listdir(victim.parent))) == before
    assert victim.read_bytes() == VICTIM


@pytest.mark.quick(1)
@POSIX
@pytest.mark.parametrize("trap", TRAPS)
def test_a_click_writes_through_no_link(
    trap: Callable[[Path, Path], None], victim: Path, page: Page, folder: Path
) -> None:
    trap(autosave_path(folder / "f8.kilter.json"), victim)
    trap(folder / "f8.choices.kilter.json", victim)
    page.after(do="hold", parts=["C3"], on=True)
    said = page.last["session"]["message"]
    assert re.search("not kept beside the file.* is (a link|no regular file).*remove it", said)
    reply = page.say(do="save")
    assert not reply["ok"]
    assert re.search("is (a link|no regular file)|something other", reply["error"])
    assert victim.read_bytes() == VICTIM
    assert os.listdir(victim.parent) == [victim.name]


@pytest.mark.slow
def test_a_file_with_the_longest_name_keeps_its_changes(page: Page, folder: Path) -> None:
    name = f"{'n' * 240}.kilter.json"
    kilter.dump(scene("paper-figure-8"), folder / name)
    assert page.say(do="open", file=name)["ok"]
    page.answer()
    page.after(do="hold", parts=["C3"], on=True)
    assert page.last["session"]["message"] == ""
    assert page.say(do="open", file=name)["ok"]
    assert "1 change of the earlier session restored" in page.last["session"]["message"]


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "content",
    [
        b"[" * 100_000,
        b"\xff\xfe",
        b'{"kilter_workbench": 1, "base": {}, "changes": [5], "undone": []}',
        b'{"kilter_workbench": 1, "base": {}, "changes": [{"do": "go", "x": NaN}], "undone": []}',
        b'{"kilter_workbench": 1, "base": [], "changes": {"a": 1}, "undone": 3}',
        b'{"kilter_workbench": 1, "base": {}, "undone": [], "changes": [' + b"1," * 9999 + b"1]}",
    ],
)
def test_a_damaged_autosave_is_a_sentence(content: bytes, page: Page, folder: Path) -> None:
    autosave_path(folder / "f8.kilter.json").write_bytes(content)
    assert page.say(do="open", file="f8.kilter.json")["ok"]
    assert "could not be restored" in page.last["session"]["message"]
    assert page.answer()["is"] == "answer"


@POSIX
def test_changes_of_a_dropped_file_follow_no_link(
    bench: Workbench, page: Page, victim: Path
) -> None:
    assert page.say(do="open", example="paper-figure-8")["ok"]
    page.answer()
    digest = page.last["session"]["choices"]["sha256"]
    place = upload_autosave_path(digest)
    place.parent.mkdir(parents=True)
    place.symlink_to(victim)
    page.after(do="hold", parts=["C3"], on=True)
    assert "is a link" in page.last["session"]["message"]
    assert victim.read_bytes() == VICTIM


def test_the_table_of_contacts_begins_no_cell_with_a_formula(
    page: Page, bench: Workbench, folder: Path
) -> None:
    base = kilter.Part("=1+1", kilter.Box([2, 2, 1]), [0, 0, 0], grounded=True)
    top = kilter.Part("@SUM(A1)\x1b", kilter.Box([1, 1, 1]), [0, 0, 1])
    kilter.dump(kilter.Assembly([base, top]), folder / "names.kilter.json")
    assert page.say(do="open", file="names.kilter.json")["ok"]
    page.answer()
    address = bench.url.replace("/?", "/export/contacts.csv?")
    with urllib.request.urlopen(address, timeout=60) as answer:
        _, row = csv.reader(io.StringIO(answer.read().decode()))
    assert row[:2] == ["'=1+1", "'@SUM(A1)\\x1b"]
    assert all(cell[0] != "'" for cell in row[3:])
    assert float(row[-1]) in (-1.0, 1.0)


# the opened folder -----------------------------------------------------------------------------

TETRAHEDRON = """v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 2 3 4
f 1 4 3
"""
MESH = '<mujoco><asset><mesh name="m" file="{}"/></asset><worldbody><geom type="mesh" mesh="m"/>'
MESH += '<body><freejoint/><geom size="1"/></body></worldbody></mujoco>'
INCLUDE = '<mujoco><include file="{}"/></mujoco>'
URDF = '<robot name="r"><link name="a"><collision><geometry><mesh filename="{}"/></geometry>'
URDF += "</collision></link></robot>"
USD = '#usda 1.0\n(\n    subLayers = [@{}@]\n)\ndef Xform "a" {{}}\n'
SCENES = {
    "MJCF mesh": ("scene.xml", MESH, "t.obj"),
    "MJCF include": ("scene.xml", INCLUDE, "inc.xml"),
    "URDF mesh": ("robot.urdf", URDF, "t.obj"),
    "USD layer": ("stage.usda", USD, "layer.usda"),
}


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A folder with meshes, beside the folder of the scenes."""
    (tmp_path / "project" / "meshes").mkdir(parents=True)
    (tmp_path / "project" / "scenes").mkdir()
    meshes = tmp_path / "project" / "meshes"
    (meshes / "t.obj").write_text(TETRAHEDRON)
    (meshes / "inc.xml").write_text("<mujoco><worldbody><geom size='1'/></worldbody></mujoco>")
    (meshes / "layer.usda").write_text('#usda 1.0\ndef Cube "c" {}\n')
    return tmp_path / "project"


@pytest.mark.slow
@pytest.mark.parametrize("absolute", [False, True])
@pytest.mark.parametrize("kind", SCENES)
def test_a_named_file_outside_is_refused_with_the_folder_to_open(
    kind: str, absolute: bool, project: Path
) -> None:
    """With the folder above as the opened folder, the refusal ends."""
    name, text, named = SCENES[kind]
    modules = {"MJCF mesh": "mujoco", "MJCF include": "mujoco", "USD layer": "pxr"}
    if kind in modules:
        pytest.importorskip(modules[kind])
    target = project / "meshes" / named
    scheme = "file://" if absolute and kind == "URDF mesh" else ""
    (project / "scenes" / name).write_text(
        text.format(scheme + target.as_posix() if absolute else f"../meshes/{named}")
    )
    with Workbench(None, folder=project / "scenes") as bench:
        page = Page(bench)
        reply = page.say(do="open", file=name)
        page.close()
    assert not reply["ok"]
    assert "outside of the opened folder" in reply["error"]
    assert reply["hint"].endswith(f"--folder {os.path.realpath(project)}")
    with Workbench(None, folder=project) as bench:
        page = Page(bench)
        reply = page.say(do="open", file=f"scenes/{name}")
        page.close()
    assert "opened folder" not in str(reply)


@POSIX
def test_a_link_to_a_file_outside_is_refused(page: Page, folder: Path, project: Path) -> None:
    meshes = folder / "meshes"
    meshes.mkdir()
    (meshes / "a.obj").symlink_to(project / "meshes" / "t.obj")
    reply = page.say(do="open", file="meshes")
    assert not reply["ok"]
    assert "outside of the opened folder" in reply["error"]
    (meshes / "a.obj").unlink()
    meshes.rmdir()


@pytest.mark.slow
@POSIX
def test_the_whole_disk_is_never_proposed(page: Page, folder: Path) -> None:
    (folder / "all.obj").symlink_to("/etc/hostname")
    with Workbench(folder / "all.obj", folder=folder) as bench:
        other = Page(bench)
        other.hear(lambda m: "outside of the opened folder" in m.get("message", ""))
        assert "copy it" in other.last["session"]["message"]
        other.close()


def test_the_option_names_the_opened_folder(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such folder"):
        kilter.view(folder=tmp_path / "gone", browser=False)
