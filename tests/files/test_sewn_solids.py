"""Separate faces that sew to closed solids, in STEP, IGES and FreeCAD, and IGES files."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("OCP")

from freecad_maker import Maker, at
from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from OCP.IGESControl import IGESControl_Controller, IGESControl_Writer
from OCP.TopoDS import TopoDS
from step_maker import compound, moved, placement, write_step
from test_step import drilled
from test_step_damaged import faces_of, shell_of

from kilter.analysis.check import check
from kilter.errors import InputError
from kilter.files.cad import step_process
from kilter.files.cad.step_surfaces import quiet
from kilter.loading import load


def box(x: float, y: float, z: float, *at: float) -> Any:
    solid = BRepPrimAPI_MakeBox(float(x), float(y), float(z)).Shape()
    return moved(solid, placement(at)) if at else solid


def loose_faces(*shapes: Any) -> list[Any]:
    """The faces of shapes, none of which shares an edge with another one."""
    return [
        TopoDS.Face(BRepBuilderAPI_Copy(face).Shape())
        for shape in shapes
        for face in faces_of(shape)
    ]


def write_iges(path: Path, shapes: list[Any], unit: str = "MM", mode: int = 0) -> Path:
    """Write an IGES file; `mode`: 0 for separate faces, 1 for solids."""
    with quiet():
        IGESControl_Controller.Init_s()
        writer = IGESControl_Writer(unit, mode)
        for shape in shapes:
            writer.AddShape(shape)
        writer.ComputeModel()
        assert writer.Write(str(path))
    return path


STACK = [box(9, 9, 3), box(4, 4, 5, 1, 1, 3), moved(drilled(), placement((0, 0, 30)))]


@pytest.mark.parametrize("apart", [False, True], ids=["one product", "a product each"])
@pytest.mark.slow
def test_shells_of_one_face_are_sewn_to_the_solids_that_they_bound(apart, tmp_path):
    shells = [shell_of([face]) for face in loose_faces(*STACK)]
    whole = [(f"skin{k}", shell, None) for k, shell in enumerate(shells)]
    roots = whole if apart else [("skin", compound(shells), None)]
    sewn = load(write_step(tmp_path / "a.step", roots))
    exact = load(write_step(tmp_path / "b.step", [(f"s{k}", s, None) for k, s in enumerate(STACK)]))
    order = np.argsort(sewn.geometry.center[:, 2])
    assert sewn.geometry.volume[order] == pytest.approx(exact.geometry.volume, rel=1e-9)
    assert sewn.geometry.center[order] == pytest.approx(exact.geometry.center, abs=1e-9)
    assert sewn.names == (("a_1", "a_2", "a_3") if apart else ("skin_1", "skin_2", "skin_3"))
    (note,) = sewn.notes
    assert note.endswith(
        f"{len(shells)} separate {'products' if apart else 'faces'} are sewn to 3 closed solids"
    )
    assert check(sewn, floor=True).verdict == check(exact, floor=True).verdict


def test_a_shell_inside_another_one_is_a_hollow(tmp_path):
    nested = [box(10, 10, 10), box(6, 6, 6, 2, 2, 2), box(2, 2, 2, 4, 4, 4), box(1, 1, 1, 20, 0, 0)]
    shells = [shell_of([face]) for face in loose_faces(*nested)]
    assembly = load(write_step(tmp_path / "a.step", [("skin", compound(shells), None)]))
    assert sorted(assembly.geometry.volume) == pytest.approx([1, 8, 1000 - 216])


def test_faces_that_do_not_close_are_refused_by_name(tmp_path):
    faces = loose_faces(box(9, 9, 3), box(4, 4, 5, 20, 0, 0))
    shells = [shell_of([face]) for face in faces[:-1]]
    path = write_step(tmp_path / "a.step", [("skin", compound(shells), None)])
    with pytest.raises(InputError, match="no solid, only 'skin' "):
        load(path)
    whole = [("cube", box(1, 1, 1), None), ("skin", compound(shells), None)]
    assembly = load(write_step(path, whole))
    assert assembly.names == ("cube",)
    assert "ignored, not solids: 'skin' (1 shell)" in assembly.notes


def test_faces_of_a_freecad_document_are_sewn(tmp_path):
    maker = Maker()
    faces = compound(loose_faces(box(1, 2, 3), box(1, 1, 1, 5, 5, 5)))
    maker.add("Part::Feature", "skin", maker.shape(faces, at(10)))
    assembly = load(maker.write(tmp_path / "a.FCStd"))
    assert assembly.names == ("skin_1", "skin_2")
    assert assembly.geometry.center[:, 0] == pytest.approx([10.5, 15.5])
    assert assembly.notes == ("'skin': 12 separate faces are sewn to 2 closed solids",)


@pytest.mark.parametrize("mode", [0, 1], ids=["faces", "solids"])
@pytest.mark.parametrize(
    ("unit", "units", "size"),
    [("MM", "mm", 1), ("IN", "in", 1 / 25.4), ("FT", "mm", 1), ("M", "mm", 1)],
)
def test_iges_has_the_parts_of_step(mode, unit, units, size, tmp_path):
    found = load(write_iges(tmp_path / "pile.igs", STACK, unit, mode))
    exact = load(write_step(tmp_path / "b.step", [(f"s{k}", s, None) for k, s in enumerate(STACK)]))
    assert found.units == units
    assert found.names == ("pile_1", "pile_2", "pile_3")
    assert found.geometry.volume == pytest.approx(exact.geometry.volume * size**3, rel=1e-7)
    assert found.geometry.center == pytest.approx(exact.geometry.center * size, rel=1e-6)
    assert bool(found.notes) == (mode == 0)
    assert check(found, floor=True).verdict == check(exact, floor=True).verdict


def test_iges_of_round_faces_is_exact(tmp_path):
    found = load(write_iges(tmp_path / "a.iges", [BRepPrimAPI_MakeCylinder(2.0, 5.0).Shape()]))
    assert found.geometry.volume == pytest.approx([20 * np.pi], rel=1e-9)
    assert sorted(surface.kind for surface in found.parts[0].shape.surfaces) == [
        "cylinder",
        "plane",
        "plane",
    ]


def test_iges_of_open_faces_and_other_files_are_refused(tmp_path):
    path = write_iges(tmp_path / "a.igs", faces_of(box(1, 2, 3))[:4])
    with pytest.raises(InputError, match="no solid, only 'a_1' "):
        load(path)
    path.write_bytes(b"ISO-10303-21;\n")
    with pytest.raises(InputError, match="not an IGES file"):
        load(path)


def test_a_solid_of_iges_without_a_shape_is_counted(tmp_path):
    """The entity of the first solid names a solid in place of its shell, which remains."""
    path = write_iges(tmp_path / "a.igs", STACK[:2], mode=1)
    lines = path.read_bytes().split(b"\n")
    (row,) = [k for k, line in enumerate(lines) if line.startswith(b"186,")][:1]
    lines[row] = b"186,1,".ljust(64) + lines[row][64:]
    path.write_bytes(b"\n".join(lines))
    assembly = load(path)
    assert "damaged: 1 solids or faces of the file give no shape" in assembly.notes


@pytest.mark.quick(1)
@pytest.mark.parametrize("seed", range(40))
def test_damaged_iges_is_rejected_or_read(seed, tmp_path, monkeypatch):
    """200 files."""
    monkeypatch.setattr(step_process, "STALLS", 1.0)
    rng = np.random.default_rng(seed)
    whole = write_iges(tmp_path / "whole.igs", STACK[:2], mode=seed % 2).read_bytes()
    for k in range(5):
        path, data = tmp_path / f"{k}.igs", bytearray(whole)
        for _ in range(int(rng.integers(1, 4))):
            start = int(rng.integers(80, len(data)))
            count = int(rng.integers(1, 5))  # columns have a meaning, so few files are shifted
            put = rng.choice(list(b"0123456789.,D-;H "), count).astype(np.uint8).tobytes()
            data[start : start + (count if k else count - 1)] = put
        path.write_bytes(bytes(data))
        try:
            load(path)
        except InputError as error:
            message = str(error)
        else:
            message = f"{path}: "
        assert message.startswith(f"{path}: ")
