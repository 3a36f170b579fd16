"""STEP files that are damaged, real, or read by a process of their own."""

import pytest

pytest.importorskip("OCP")


import importlib
import os
import re
import sys
import time
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
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

import kilter
from kilter.analysis.check import check
from kilter.assembly import Assembly, Part
from kilter.cli import main
from kilter.contact import detect
from kilter.contact.common.gaps import UNKNOWN
from kilter.contact.detect import contacts
from kilter.errors import InputError
from kilter.files import from_dict, to_dict
from kilter.files.cad import step_faces, step_process
from kilter.files.cad.step import read_step
from kilter.files.cad.step_document import step_bodies
from kilter.files.cad.step_solids import read_solid, stand_in
from kilter.files.cad.step_surfaces import inside
from kilter.loading import load
from kilter.rigid import Pose
from kilter.shape.closed import open_edges
from kilter.shape.primitives import Box
from kilter.shape.recognition import recognise
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
def test_faces_cut_here_meet_those_cut_by_occt(name, monkeypatch):
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
def test_a_solid_whose_faces_are_all_cut_here(name, monkeypatch):
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


def test_a_face_that_nothing_can_cut_is_a_hole(monkeypatch):
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


def test_faces_that_share_no_edges_are_sewn(tmp_path):
    assembly = load(write_step(tmp_path / "a.step", [("loose", apart(drilled()), None)]))
    (part,) = assembly.parts
    assert isinstance(part.shape, Solid)
    assert not len(part.shape.holes)
    sound = read_solid(drilled()).solid
    assert sound is not None
    assert part.shape.volume == pytest.approx(sound.volume, rel=1e-9)
    assert part.shape.centroid == pytest.approx(sound.centroid)


def test_a_shell_that_closes_is_a_solid_and_an_open_one_is_not(tmp_path):
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


def test_a_solid_with_a_hole_reads_with_a_note(tmp_path):
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
def test_what_stands_on_it_is_certain_beside_the_hole_only(missing, known, tmp_path):
    tub = load(open_box(tmp_path / "a.step", missing)).parts[0]
    cube = Part("cube", Box([1, 1, 1]), Pose([1, 1.5, 4.5]))
    assembly = Assembly([Part("tub", tub.shape, grounded=True), cube], units="mm")
    found = contacts(assembly)
    assert bool(len(found)) == known
    assert [pair.why for pair in found.open_pairs] == ([] if known else [UNKNOWN])
    assert (check(assembly, contacts=found).verdict == "stable") == known


# stand-ins --------------------------------------------------------------------------------------


def test_a_stand_in_is_the_hull_of_what_is_known():
    solid, note = stand_in(box(2.0, 3.0, 4.0))
    assert solid is not None
    assert solid.stand_in
    assert "those of their convex hull" in note
    assert solid.volume == pytest.approx(24)
    assert solid.second_moment == pytest.approx(2 * np.diag([4.0, 9.0, 16.0]))


@pytest.mark.slow
def test_a_solid_over_which_occt_breaks_down_gets_one(tmp_path):
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


def test_a_solid_without_faces_has_no_volume():
    solid = TopoDS_Solid()
    BRep_Builder().MakeSolid(solid)
    assert read_solid(solid) == (None, "")


# left out before it is read ---------------------------------------------------------------------


def test_without_leaves_solids_out_before_they_are_cut(tmp_path):
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


def box_process(path, *size):
    """Write a STEP file of a box."""
    write_step(path, [("block", BRepPrimAPI_MakeBox(*size).Shape(), placement())])
    return path


def depth(found):
    return float(found.shapes[0].vertices[:, 2].max())


@pytest.fixture
def fresh():
    step_process._end()
    yield
    step_process._end()


@pytest.mark.slow
def test_what_is_read_ahead_is_what_is_asked_for(fresh, tmp_path):
    path = box_process(tmp_path / "one.step", 1.0, 2.0, 3.0)
    step_process.begin_early(path)
    process = step_process._kept[0]
    assert process.ahead is not None
    assert depth(read_step(path)) == pytest.approx(3.0)
    assert step_process._kept == [process]
    assert process.ahead is None
    assert depth(read_step(path)) == pytest.approx(3.0)  # the file is requested again


@pytest.mark.slow
def test_another_file_and_another_state_of_it_are_read_anew(fresh, tmp_path):
    one, other = (box_process(tmp_path / f"{n}.step", 1.0, 2.0, n) for n in (3.0, 4.0))
    step_process.begin_early(one)
    assert depth(read_step(other)) == pytest.approx(4.0)
    step_process._end()
    step_process.begin_early(one)
    box_process(one, 1.0, 2.0, 5.0)
    os.utime(one, ns=(1, 1))
    assert depth(read_step(one)) == pytest.approx(5.0)
    step_process._end()
    step_process.begin_early(one)
    left_out = read_step(one, without=("block",))
    assert left_out.left_out == ("block",)


@pytest.mark.slow
def test_a_file_that_is_refused_leaves_nothing_behind(fresh, tmp_path):
    bad, good = tmp_path / "bad.step", box_process(tmp_path / "good.step", 1.0, 2.0, 3.0)
    bad.write_text(good.read_text().replace("END-ISO-10303-21", ""))
    step_process.begin_early(bad)
    with pytest.raises(InputError, match="incomplete"):
        read_step(bad)
    assert depth(read_step(good)) == pytest.approx(3.0)


@pytest.mark.parametrize("word", ["missing.step", "x" * 5000 + ".step"])
def test_a_name_that_is_no_file_starts_nothing(fresh, word, capsys):
    assert main(["check", word, "--floor"]) == 2
    assert step_process._kept == []
    assert "Traceback" not in capsys.readouterr().err


@pytest.mark.slow
def test_what_comes_to_no_end_is_tried_once_more_and_refused(fresh, tmp_path, monkeypatch):
    path = box_process(tmp_path / "one.step", 1.0, 2.0, 3.0)
    made = []
    start = step_process.ReaderProcess
    monkeypatch.setattr(
        step_process, "ReaderProcess", lambda module: made.append(module) or start(module)
    )
    with monkeypatch.context() as short:
        short.setattr(step_process, "STALLS", 1e-4)
        short.setattr(step_process, "STALLS_PER_MEGABYTE", 0.0)
        with pytest.raises(InputError, match="OCCT crashes on it"):
            read_step(path)
    assert len(made) == 2
    assert depth(read_step(path)) == pytest.approx(3.0)


FILE = Path(__file__).resolve().parents[3] / "shared" / "data" / "cax-if" / "as1-oc-214.stp"


FACES = {
    "plate": {"plane": 6, "hollow cylinder": 6},
    "l-bracket": {"plane": 8, "hollow cylinder": 4},
    "bolt": {"plane": 3, "cylinder": 2},
    "nut": {"plane": 6, "hollow cylinder": 1},
    "rod": {"plane": 2, "cylinder": 1},
}
SPLINES = 1e-6
"""Relative difference in volume between the file's splines and cylinders (2.6e-5 mm of 5 mm)."""


@pytest.fixture(scope="module")
def assembly() -> Assembly:
    return load(FILE)


def solid_of(assembly: Assembly, product: str) -> Solid:
    name = next(n for n in assembly.names if n.split("/")[-1].split("_")[0] == product)
    shape = assembly.parts[assembly.index_of(name)].shape
    assert isinstance(shape, Solid)
    return shape


@pytest.mark.skipif(not FILE.is_file(), reason="real data is not here")
def test_names_units_and_instances(assembly):
    below = [f"nut-bolt-assembly_{k}/{part}" for k in (1, 2, 3) for part in ("bolt", "nut")]
    sides = [f"l-bracket-assembly_{k}/{n}" for k in (1, 2) for n in [*below, "l-bracket"]]
    rods = ["nut_1", "nut_2", "rod"]  # the only nut in the rod assembly
    assert sorted(assembly.names) == sorted(["plate", *rods, *sides])
    assert assembly.units == "mm"
    assert assembly.notes == ()
    assert len({id(part.shape) for part in assembly.parts}) == 5


@pytest.mark.skipif(not FILE.is_file(), reason="real data is not here")
@pytest.mark.parametrize("product", FACES)
def test_every_face_is_known(product, assembly):
    solid = solid_of(assembly, product)
    found = Counter(f"hollow {s.kind}" if s.hollow else s.kind for s in solid.surfaces)
    assert found == FACES[product]
    assert (solid.triangle_surface >= 0).all()
    assert solid.accuracy < 3e-5
    radii = {round(s.radius, 5) for s in solid.surfaces if s.kind == "cylinder"}
    assert radii == ({5.0, 7.5} if product == "bolt" else {5.0})
    on_mesh = recognise(solid.vertices, solid.triangles, solid.accuracy)[0]
    assert Counter(f"hollow {s.kind}" if s.hollow else s.kind for s in on_mesh) == FACES[product]


@pytest.mark.skipif(not FILE.is_file(), reason="real data is not here")
def test_volumes_by_formula(assembly):
    def between(solid: Solid, normal: list[float]) -> np.ndarray:
        """Heights of the planes perpendicular to a direction."""
        planes = [s for s in solid.surfaces if s.kind == "plane"]
        return np.sort([s.point @ normal for s in planes if abs(s.axis @ normal) > 0.999])

    rod = solid_of(assembly, "rod")
    assert rod.volume == pytest.approx(np.pi * 25 * 200, rel=SPLINES)
    across, along = rod.volume * 25 / 4, rod.volume * 200**2 / 12
    assert rod.second_moment == pytest.approx(
        np.diag([across, across, along]), rel=SPLINES, abs=SPLINES * across
    )
    bolt = solid_of(assembly, "bolt")
    low, middle, high = between(bolt, bolt.surfaces[0].axis.tolist())
    head, shank = sorted((middle - low, high - middle))
    assert bolt.volume == pytest.approx(np.pi * (7.5**2 * head + 25 * shank), rel=SPLINES)
    plate = solid_of(assembly, "plate")
    x, y, z = np.ptp(plate.vertices, axis=0)
    assert plate.volume == pytest.approx(x * y * z - 6 * np.pi * 25 * z, rel=SPLINES)


@pytest.mark.skipif(not FILE.is_file(), reason="real data is not here")
@pytest.mark.slow
def test_it_is_read_quickly_and_written_exactly(assembly):
    start = time.process_time()
    load(FILE)
    assert time.process_time() - start < 4.0  # 0.5 s on a free core
    written = to_dict(assembly)
    assert to_dict(from_dict(written)) == written


SPACESHIP = FILE.parent / "s1-tu-203" / "s1-tu-203.stp"
OVERLAPS = {
    ("foot_2/footback", "mainbodyback"): 97.4,
    ("foot_2/footback", "mainbodyfront"): 81.3,
    ("foot_2/footfront", "mainbodyfront"): 152.3,
}
"""Overlap volumes by exact Boolean operations of the faces [mm^3]."""


@pytest.mark.skipif(not FILE.is_file(), reason="real data is not here")
@pytest.mark.slow
@pytest.mark.skipif(not SPACESHIP.is_file(), reason="real data is not here")
def test_shells_on_one_axis_do_not_interfere_and_what_overlaps_does():
    # mainbodyback has a solid cylinder of radius 73, mainbodyfront holes of 67 and 72 on its axis
    assembly = load(SPACESHIP)
    contacts = detect.contacts(assembly)
    found = {tuple(sorted(overlap.parts)): overlap for overlap in contacts.overlaps}
    assert set(found) == set(OVERLAPS)
    for parts, volume in OVERLAPS.items():
        assert found[parts].volume == pytest.approx(volume, rel=0.02)
    # both are parts of the same foot, whose copy is placed correctly
    asked = next(word for word in contacts.warnings if "in the right place" in word)
    assert "is 'foot_2/footback' in the right place?" in asked
    assert "its copy 'foot_1/footfront' overlaps nothing" in asked


CLIPS = FILE.parents[1] / "voron" / "SKR_3_Din_Mount.step"


@pytest.mark.skipif(not FILE.is_file(), reason="real data is not here")
@pytest.mark.slow
@pytest.mark.skipif(not CLIPS.is_file(), reason="real data is not here")
def test_a_file_with_faces_that_the_mesher_leaves_out_is_read_whole():
    assembly = load(CLIPS)
    assert Counter(name[:-2] for name in assembly.names) == {"DIN Clips (3)": 2, "SKR Bracket": 2}
    for part in assembly.parts:
        shape = part.shape
        assert isinstance(shape, Solid)
        assert len(shape.holes) == 0
        assert not shape.stand_in
        assert len(open_edges(shape.vertices, shape.triangles)) == 0
        corners = shape.vertices[shape.triangles]
        cut = np.einsum("ni,ni->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
        assert shape.volume == pytest.approx(cut, rel=0.01)


@pytest.mark.skipif(not FILE.is_file(), reason="real data is not here")
@pytest.mark.slow
def test_with_its_bolts_joined_it_is_stable_although_shafts_turn_in_their_bores():
    held = load(FILE, ground=["plate"], friction=0.3)
    verdict = kilter.check(kilter.fastened(held, suggested=True))
    assert (verdict.verdict, verdict.level) == ("stable", "proved")


BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"
PLAYS = (20071, 20129, 20156, 20236, 20240, 20260)
"""A cover hangs on snap hooks with play, beside threads, press fits and O-rings."""
COPIES = (20120,)
"""Drawing with a cover, an O-ring that overlaps its pin, and a block inside its variant."""
MIRRORED = (20094, 20170)
"""A mirrored sub-assembly; a part of it was drawn in inches."""


@pytest.fixture
def census(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module of the census."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    monkeypatch.setattr(sys, "path", [*sys.path])
    return importlib.import_module("cad_census")


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*PLAYS, *COPIES, *MIRRORED])
def test_the_known_outcome_follows_from_two_proposed_commands(seed, census, tmp_path):
    case = census.examine(seed, tmp_path)
    assert case.fault == ""
    assert case.is_useful()
    assert case.judgement() == "right"


@pytest.mark.slow
@pytest.mark.parametrize("seed", MIRRORED)
def test_the_image_of_a_sub_assembly_has_its_volumes_and_lies_on_the_base(seed, census, tmp_path):
    file = census.write_drawn(census.draw(seed), tmp_path / "drawn.step")
    assembly = kilter.load(file)
    geometry = assembly.geometry
    volumes = dict(zip(assembly.names, geometry.volume, strict=True))
    images = [name for name in assembly.names if "far_side" in name]
    assert images
    for name in images:
        assert volumes[name] == pytest.approx(volumes[name.replace("far_side/", "")], rel=1e-9)
    low, high = (dict(zip(assembly.names, ends, strict=True)) for ends in geometry.part_boxes)
    for name in images:
        assert (low[name][:2] >= low["base"][:2]).all()
        assert (high[name][:2] <= high["base"][:2]).all()
