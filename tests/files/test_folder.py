"""A folder of meshes: names, order, units, and ignored files."""

from __future__ import annotations

from pathlib import Path

import pytest
import trimesh

from kilter.errors import InputError
from kilter.files import load
from kilter.files.naming import distinct


def refused(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        load(path)
    assert str(caught.value).startswith(str(path))
    assert caught.value.hint
    return str(caught.value)


def test_one_part_a_file_in_the_order_people_count(write, obj_box) -> None:
    for k in (10, 2, 1):
        write(f"w/{k}.obj", "mtllib x.mtl\no object_1\n" + obj_box(1, (0, 0, k)))
    assembly = load(write("w/b.OBJ", obj_box()).parent)
    assert assembly.names == ("1", "2", "10", "b")
    assert assembly.geometry.center[:, 2] == pytest.approx([1, 2, 10, 0])
    assert assembly.source.endswith("w")
    assert assembly.notes == ()


def test_several_objects_of_a_file_have_its_name_before_theirs(write, obj_box) -> None:
    write("w/a.obj", "o x\n" + obj_box() + "o x\n" + obj_box(1, (3, 0, 0), 9))
    assembly = load(write("w/b.obj", obj_box()).parent)
    assert assembly.names == ("a/x", "a/x_2", "b")


def test_files_of_one_stem_have_names_of_their_own(write, obj_box) -> None:
    trimesh.creation.box().export(write("w/a.obj", obj_box()).with_suffix(".stl"))
    assert load(write("w/a.obj", obj_box()).parent).names == ("a", "a_2")


def test_separate_bodies_of_a_nameless_file_are_one_part(write, obj_box) -> None:
    path = write("w/a.obj", obj_box() + obj_box(1, (5, 0, 0), 9))
    assembly = load(path.parent)
    assert assembly.names == ("a",)
    assert assembly.notes == ("a.obj: 2 separate bodies, read as a single part",)


def test_files_of_other_kinds_are_named_in_a_note(write, obj_box) -> None:
    write("w/readme.txt", "x")
    write("w/a.kilter.json", "x")
    write("w/sub/b.obj", obj_box())
    write("w/.hidden.obj", "x")
    note = load(write("w/a.obj", obj_box()).parent).notes
    assert note == ("ignored, not mesh or STEP files: 'a.kilter.json', 'readme.txt', 'sub'",)


def test_many_ignored_files_are_counted(write, obj_box) -> None:
    for k in range(20):
        write(f"w/{k}.txt", "x")
    assert "'7.txt' and 12 more" in load(write("w/a.obj", obj_box()).parent).notes[0]


def test_a_folder_without_meshes(write) -> None:
    path = write("w/readme.txt", "x").parent
    assert "no mesh or STEP file in the folder; put files of .obj, .stl" in refused(path)
    write("w/a.kilter.json", "{}")
    assert "in the folder; give the file itself: 'a.kilter.json'" in refused(path)


def test_a_damaged_file_is_named(write) -> None:
    path = write("w/a.obj", "v 0 0 0\nf 1 2 3\n")
    assert f"{path}: line 2: the face names vertex 3, the file has 1" in refused(path.parent)


def test_a_folder_without_rights(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_: Path) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "iterdir", refuse)  # the superuser may read every file
    assert "cannot be read: Permission denied; check" in refused(tmp_path)


def test_units_of_files_that_state_theirs(write, tmp_path: Path, obj_box) -> None:
    folder = write("w/a.obj", obj_box()).parent
    trimesh.creation.box().export(folder / "b.3mf")
    assert load(folder).units == "mm"  # the only units that a file states
    assert load(folder, units="cm").geometry.volume == pytest.approx([1, 1e-3])
    trimesh.creation.box().export(folder / "c.glb")
    assert "files are in m and mm, 'a.obj' states no units; give the units" in refused(folder)
    (folder / "a.obj").unlink()
    assert load(folder).geometry.volume == pytest.approx([1e-9, 1])


def test_distinct_names_keep_those_that_are_there() -> None:
    assert distinct(["a", "a", "a_2", "a", "b"]) == ["a", "a_3", "a_2", "a_4", "b"]
