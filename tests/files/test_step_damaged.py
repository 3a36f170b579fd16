"""Damaged STEP files: which solids are read, and with which notes."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("OCP")

from OCP.BRep import BRep_Builder
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
)
from OCP.GProp import GProp_GProps
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopoDS import TopoDS, TopoDS_Shell, TopoDS_Solid
from step_maker import as_splines, placement, write_step
from test_step import drilled

from kilter.analysis.check import check
from kilter.assembly import Assembly, Part
from kilter.contact.common.gaps import UNKNOWN
from kilter.contact.detect import contacts
from kilter.errors import InputError
from kilter.files import from_dict, load, step_faces, to_dict
from kilter.files.occt import inside
from kilter.files.step_bodies import step_bodies
from kilter.files.step_solids import read_solid, stand_in
from kilter.rigid import Pose
from kilter.shape.closed import open_edges
from kilter.shape.primitives import Box
from kilter.shape.solid import Solid


def box(*size: float) -> Any:
    return BRepPrimAPI_MakeBox(*size).Shape()


def faces_of(shape: Any) -> list[Any]:
    return [TopoDS.Face(f) for f in inside(shape, TopAbs_ShapeEnum.TopAbs_FACE)]


def shell_of(faces: list[Any]) -> Any:
    builder, shell = BRep_Builder(), TopoDS_Shell()
    builder.MakeShell(shell)
    for face in faces:
        builder.Add(shell, face)
    return shell


def apart(shape: Any) -> Any:
    """The shape as a shell whose faces share no edges."""
    return shell_of([TopoDS.Face(BRepBuilderAPI_Copy(face).Shape()) for face in faces_of(shape)])


# faces that the mesher leaves out ---------------------------------------------------------------

SHAPES = {
    "box": box(2.0, 3.0, 4.0),
    "cylinder": BRepPrimAPI_MakeCylinder(2.0, 9.0).Shape(),
    "flat cylinder": BRepPrimAPI_MakeCylinder(9.0, 0.5).Shape(),
    "cone": BRepPrimAPI_MakeCone(3.0, 1.0, 2.0).Shape(),
    "tip": BRepPrimAPI_MakeCone(3.0, 0.0, 2.0).Shape(),
    "sphere": BRepPrimAPI_MakeSphere(2.0).Shape(),
    "torus": BRepPrimAPI_MakeTorus(5.0, 1.0).Shape(),
    "drilled": drilled(),
    "splines": as_splines(drilled()),
}


def area_of(face: Any) -> float:
    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(face, found)
    return float(found.Mass())


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SHAPES)
def test_faces_cut_here_meet_those_cut_by_occt(name: str, monkeypatch: Any) -> None:
    """With each face in turn triangulated by kilter, the surface is closed with the same volume."""
    shape = SHAPES[name]
    whole = read_solid(shape).solid
    assert whole is not None
    count = len(faces_of(shape))
    for left_out in range(count):
        turn = iter(range(10 * count))
        own = step_faces._occt_mesh

        def meshed(face: Any, own: Any = own, turn: Any = turn, k: int = left_out) -> Any:
            return None if next(turn) == k else own(face)

        monkeypatch.setattr(step_faces, "_occt_mesh", meshed)
        found, lost = step_faces.cut_faces(shape, 1e-3, 0.2)
        monkeypatch.undo()
        assert (len(found), lost) == (count, 0)
        cut = found[left_out]
        p, q, r = (cut.nodes[cut.triangles[:, k]] for k in range(3))
        area = np.linalg.norm(np.cross(q - p, r - p), axis=1).sum() / 2
        assert area == pytest.approx(area_of(faces_of(shape)[left_out]), rel=0.02)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", SHAPES)
def test_a_solid_whose_faces_are_all_cut_here(name: str, monkeypatch: Any) -> None:
    exact = read_solid(SHAPES[name]).solid
    monkeypatch.setattr(step_faces, "_occt_mesh", lambda face: None)
    found, note = read_solid(SHAPES[name])
    assert found is not None
    assert note == ""
    assert not len(found.holes)
    assert not len(open_edges(found.vertices, found.triangles))
    assert exact is not None
    assert found.volume == exact.volume
    assert sorted(s.kind for s in found.surfaces) == sorted(s.kind for s in exact.surfaces)


def test_a_face_that_nothing_can_cut_is_a_hole(monkeypatch: Any) -> None:
    shape = box(2.0, 3.0, 4.0)
    own = step_faces._occt_mesh

    def meshed(face: Any) -> Any:
        return None if face.IsSame(faces_of(shape)[5]) else own(face)

    monkeypatch.setattr(step_faces, "_occt_mesh", meshed)
    monkeypatch.setattr(step_faces, "cut_face", lambda *_: None)
    found, note = read_solid(shape)
    assert found is not None
    assert "faces do not close" in note
    assert len(found.holes) == 1
    assert found.volume == pytest.approx(24)
    assert found.centroid == pytest.approx(np.array([1, 1.5, 2]))


# solids that do not close -----------------------------------------------------------------------


def test_faces_that_share_no_edges_are_sewn(tmp_path: Path) -> None:
    assembly = load(write_step(tmp_path / "a.step", [("loose", apart(drilled()), None)]))
    (part,) = assembly.parts
    assert isinstance(part.shape, Solid)
    assert not len(part.shape.holes)
    sound = read_solid(drilled()).solid
    assert sound is not None
    assert part.shape.volume == pytest.approx(sound.volume, rel=1e-9)
    assert part.shape.centroid == pytest.approx(sound.centroid)


def test_a_shell_that_closes_is_a_solid_and_an_open_one_is_not(tmp_path: Path) -> None:
    faces = faces_of(box(2.0, 3.0, 4.0))
    skins = [("whole", shell_of(faces), None), ("lid", shell_of(faces[:4]), None)]
    assembly = load(write_step(tmp_path / "a.step", skins))
    assert assembly.names == ("whole",)
    assert assembly.geometry.volume == pytest.approx([24])
    assert assembly.notes == ("ignored, not solids: 'lid' (1 shell)",)


def open_box(path: Path, missing: int) -> Path:
    """A box of 2 x 3 x 4 that lacks a face: that at x = 0, x = 2, ... z = 4."""
    text = write_step(path, [("tub", box(2.0, 3.0, 4.0), None)]).read_text()
    found = re.search(r"CLOSED_SHELL\(\'[^']*\',\(([^)]*)\)\)", text)
    assert found is not None
    faces = found[1].split(",")
    assert len(faces) == 6
    del faces[missing]
    path.write_text(text.replace(found[1], ",".join(faces)))
    return path


def test_a_solid_with_a_hole_reads_with_a_note(tmp_path: Path) -> None:
    assembly = load(open_box(tmp_path / "a.step", 1))
    (part,) = assembly.parts
    (note,) = assembly.notes
    assert note.startswith("'tub': its faces do not close: its volume is that of the")
    assert isinstance(part.shape, Solid)
    assert part.shape.holes.tolist() == [[[2, 0, 0], [2, 3, 4]]]
    assert part.shape.volume == pytest.approx(24)
    assert assembly.geometry.mass == pytest.approx([24e-6])
    written = to_dict(assembly)
    assert to_dict(from_dict(written)) == written


@pytest.mark.parametrize(("missing", "known"), [(0, True), (5, False)], ids=["side", "top"])
def test_what_stands_on_it_is_certain_beside_the_hole_only(
    missing: int, known: bool, tmp_path: Path
) -> None:
    tub = load(open_box(tmp_path / "a.step", missing)).parts[0]
    cube = Part("cube", Box([1, 1, 1]), Pose([1, 1.5, 4.5]))
    assembly = Assembly([Part("tub", tub.shape, grounded=True), cube], units="mm")
    found = contacts(assembly)
    assert bool(len(found)) == known
    assert [pair.why for pair in found.open_pairs] == ([] if known else [UNKNOWN])
    assert (check(assembly, contacts=found).verdict == "stable") == known


# stand-ins --------------------------------------------------------------------------------------


def test_a_stand_in_is_the_hull_of_what_is_known() -> None:
    solid, note = stand_in(box(2.0, 3.0, 4.0))
    assert solid is not None
    assert solid.stand_in
    assert "those of their convex hull" in note
    assert solid.volume == pytest.approx(24)
    assert solid.second_moment == pytest.approx(2 * np.diag([4.0, 9.0, 16.0]))


@pytest.mark.slow
def test_a_solid_over_which_occt_breaks_down_gets_one(tmp_path: Path) -> None:
    roots = [("base", box(4.0, 4.0, 1.0), None), ("stone", box(1, 1, 1), placement([1, 1, 1]))]
    path = write_step(tmp_path / "a.step", roots)
    steps: list[tuple[str, int]] = []
    step_bodies(path, (), lambda *step: steps.append(step))
    assert [word for word, _ in steps] == [
        "reading STEP", "cutting faces of solid 1 of 2", "cutting faces of solid 2 of 2",
    ]  # fmt: skip
    found = step_bodies(path, (), lambda *_: None, {steps[2][1]})
    assert found.names == ("base", "stone")
    assert found.notes[0].startswith("'stone': its faces cannot be used")
    parts = [
        Part(*one, grounded=one[0] == "base")
        for one in zip(found.names, found.shapes, found.places, strict=True)
    ]
    touching = contacts(Assembly(parts))
    assert not len(touching)
    assert not touching.overlaps
    assert [(pair.ends, pair.kind) for pair in touching.open_pairs] == [((0, 1), "near")]


def test_a_solid_without_faces_has_no_volume() -> None:
    solid = TopoDS_Solid()
    BRep_Builder().MakeSolid(solid)
    assert read_solid(solid) == (None, "")


# left out before it is read ---------------------------------------------------------------------


def test_without_leaves_solids_out_before_they_are_cut(tmp_path: Path) -> None:
    roots = [(name, box(1.0, 1.0, 1.0 + k), None) for k, name in enumerate(("base", "a", "ab"))]
    path = write_step(tmp_path / "a.step", roots)
    steps: list[str] = []
    found = step_bodies(path, ("a*",), lambda word, _: steps.append(word))
    assert (found.names, found.left_out) == (("base",), ("a", "ab"))
    assert steps[1:] == ["cutting faces of solid 1 of 1"]
    assert load(path, without="a*").names == ("base",)
    assert load(path, without=["a", "ab"]).names == ("base",)
    with pytest.raises(InputError, match="all parts are left out"):
        load(path, without="*")
    with pytest.raises(InputError, match="no part is named 'abc'"):
        load(path, without=["a", "abc"])
