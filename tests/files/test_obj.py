"""OBJ: polygons, names, and faults by line and object."""

from __future__ import annotations

import pytest

from kilter.errors import InputError
from kilter.files import load

TIP = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"


def test_objects_keep_their_names(write, obj_box) -> None:
    text = "mtllib absent.mtl\no base plate\n" + obj_box(2) + "usemtl red\no Bolzen Ä\n"
    assembly = load(write("a.obj", text + obj_box(1, (5, 0, 0), 9)))
    assert assembly.names == ("base plate", "Bolzen Ä")
    assert assembly.geometry.volume == pytest.approx([8, 1])
    assert assembly.units == "m"
    assert not any(part.grounded for part in assembly.parts)
    assert assembly.source.endswith("a.obj")


def test_nothing_is_printed_about_an_absent_material(write, capfd) -> None:
    load(write("a.obj", "mtllib absent.mtl\nusemtl red\n" + TIP))
    assert capfd.readouterr() == ("", "")


def test_objects_of_one_name_are_numbered(write, obj_box) -> None:
    text = "".join(f"o bolt\n{obj_box(1, (3 * k, 0, 0), 8 * k + 1)}" for k in range(3))
    assert load(write("a.obj", text)).names == ("bolt", "bolt_2", "bolt_3")


def test_a_group_that_is_taken_up_again_goes_on(write) -> None:
    vertices, faces = TIP.split("f", 1)
    faces = ("f" + faces).strip().split("\n")
    text = f"g a\n{vertices}{faces[0]}\ng b\ng a\n" + "\n".join(faces[1:])
    assembly = load(write("a.obj", text))
    assert assembly.names == ("a",)
    assert assembly.geometry.volume == pytest.approx([1 / 6])


def test_groups_within_objects_are_no_parts(write, obj_box) -> None:
    head, tail = obj_box().split("f ", 1)
    assert load(write("a.obj", f"o box\n{head}g bottom\nf {tail}")).names == ("box",)


def test_a_file_without_names_takes_its_own(write, obj_box) -> None:
    assert load(write("Block 7.obj", obj_box())).names == ("Block 7",)


def test_separate_bodies_without_names_are_taken_apart(write, obj_box) -> None:
    assembly = load(write("wall.obj", obj_box() + obj_box(1, (0, 0, 1), 9)))
    assert assembly.names == ("wall_1", "wall_2")
    assert assembly.geometry.volume == pytest.approx([1, 1])


def test_every_form_of_a_corner(write) -> None:
    text = "v 0 0 0 1 0 0\nv 1 0 0 1.0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvn 0 0 1\nvp 0\ns off\n"
    text += "f -4 -2 -3\nf 1/1 2/1 4/1\nf 2/1/1 3/1/1 4/1/1\nf 1//1 4//1 \\\n 3//1 # last\nl 1 2\n"
    assembly = load(write("a.OBJ", text.replace("\n", "\r\n")))
    assert assembly.geometry.volume == pytest.approx([1 / 6])


def test_a_concave_polygon_is_cut_right(write) -> None:
    corners = [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)]
    rows = [f"v {x} {y} {z}" for z in (0, 1) for x, y in corners]
    sides = [f"f {k + 1} {(k + 1) % 5 + 1} {(k + 1) % 5 + 6} {k + 6}" for k in range(5)]
    text = "\n".join([*rows, "f 5 4 3 2 1", "f 6 7 8 9 10", *sides])
    assert load(write("a.obj", text)).geometry.volume == pytest.approx([8])


def test_vertices_may_follow_the_faces(write) -> None:
    vertices, faces = TIP.split("f", 1)
    assert load(write("a.obj", "f" + faces + vertices)).names == ("a",)


def test_a_file_that_is_not_utf8(write) -> None:
    assert load(write("a.obj", b"o Gr\xfc\xdfe\n" + TIP.encode())).names == ("Grüße",)


def test_a_name_with_the_sign_of_a_comment(write) -> None:
    assert load(write("a.obj", "# made by hand\no part #3\n" + TIP)).names == ("part #3",)


FAULTS = [
    (
        "v nan 0 0\n" + TIP.replace("f 1 3 2", "f 1 3 2"),
        "line 2: vertex 1 is [nan, 0.0, 0.0]; give",
    ),
    (TIP + "v 0 inf 0\n", "line 10: vertex 5 is [0.0, inf, 0.0]; give finite"),
    (TIP + "f 1 2 9\n", "line 10: the face names vertex 9, the file has 4; vertices are numbered"),
    (TIP + "f 1 2 0\n", "line 10: the face names vertex 0, the file has 4"),
    (TIP + "f 1 2 -5\n", "line 10: the face names vertex -5, the file has 4"),
    (TIP + "f 1 2\n", "line 10: face is '1 2'; name three or more"),
    (TIP + "f 1 2 x\n", "line 10: face is '1 2 x'; name three"),
    (TIP + "f 1 2 1.5\n", "line 10: face is '1 2 1.5'"),
    ("v 1 2\n" + TIP, "line 2: vertex is '1 2'; give three numbers"),
    ("v 1,5 2 3\n" + TIP, "line 2: vertex is '1,5 2 3'; give three"),
]


@pytest.mark.parametrize(("text", "message"), FAULTS)
def test_a_fault_names_file_object_and_line(text: str, message: str, write) -> None:
    path = write("a.obj", "o tip\n" + text)
    with pytest.raises(InputError) as caught:
        load(path)
    said = str(caught.value)
    assert said.startswith(f"{path}: ")
    assert message in said
    assert caught.value.part in ("tip", None)
    assert caught.value.part == "tip" or "vertex 5" in said  # a vertex that no face uses


@pytest.mark.parametrize("text", ["# nothing\n", "v 0 0 0\n", "hello world\n"])
def test_a_file_without_faces(text: str, write) -> None:
    with pytest.raises(InputError, match=r"a\.obj: no faces; export solids"):
        load(write("a.obj", text))
