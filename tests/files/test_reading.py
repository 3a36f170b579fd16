"""Reading: options, folders, wrong files of kilter, damaged entries, real data."""

import csv
import dataclasses
import json
import lzma
import struct
import zipfile
import zlib
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import trimesh
from pydantic import BaseModel, ValidationError

import kilter
from kilter.analysis.assumptions.upward import better_up
from kilter.analysis.check import check
from kilter.assembly import Assembly, GivenContact, Part
from kilter.contact import contacts
from kilter.errors import InputError, TimeLimitReached
from kilter.files import dump, from_dict
from kilter.files.meshes.placed import distinct
from kilter.files.own.kilter_json import to_dict
from kilter.files.own.models import AssemblyFile
from kilter.files.own.plain_entries import MOST_VALUES, plain_entries
from kilter.files.reader_guard import reader_guard
from kilter.files.reading import Reading
from kilter.loading import load
from kilter.rigid import Pose
from kilter.scenes import example
from kilter.shape.primitives import Box, surface
from sampled import sampled

AXES = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}


def obj(path: Path, boxes: list[tuple[Any, Any]]) -> Path:
    """An OBJ file of boxes with given sizes and positions."""
    lines, first = [], 1
    for k, (size, at) in enumerate(boxes):
        vertices, faces = surface(Box(size))
        lines.append(f"o box{k}")
        lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in (vertices + np.array(at)).tolist()]
        lines += [f"f {a} {b} {c}" for a, b, c in (faces + first).tolist()]
        first += len(vertices)
    path.write_text("\n".join(lines))
    return path


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("axis", AXES)
def test_up_is_down_turned_round(axis, sign, tmp_path):
    path = obj(tmp_path / "a.obj", [([1, 1, 1], [0, 0, 0])])
    name = axis if sign > 0 else f"-{axis}"
    assert load(path, up=name).down.tolist() == [-sign * x for x in AXES[axis]]


@pytest.mark.parametrize(("options", "words"), [
    ({"up": "Y"}, "up is 'Y'; use x, y, z"),
    ({"up": "y", "down": (0, -1, 0)}, "up and down are both given"),
    ({"contacts": "mesh"}, "contacts are 'mesh'; use file or geometry"),
])  # fmt: skip
def test_options_that_make_no_sense(options, words):
    with pytest.raises(InputError, match=words):
        load("a.obj", **options)


def test_a_proof_s_options_carry_them():
    reading = Reading(up="y", contacts="file")
    assert reading.options() == {"up": "y", "contacts": "file"}
    assert Reading.from_options(reading.options()) == reading


def toppled(turn: Any) -> list[tuple[Any, Any]]:
    """An L-shape that stands only with z up, with its axes permuted by `turn`."""
    size, at = np.array([[1, 1, 4], [3, 1, 0.5]]), np.array([[0, 0, 2], [2, 0, 3.75]])
    foot, there = np.array([[4, 3, 0.5]]), np.array([[0.5, 0.2, -0.25]])
    rows = zip(np.vstack([size, foot]), np.vstack([at, there]), strict=True)
    return [(s[turn].tolist(), c[turn].tolist()) for s, c in rows]


@pytest.mark.parametrize(("turn", "up"), [([0, 1, 2], None), ([1, 2, 0], "y"), ([2, 0, 1], "x")])
def test_another_axis_is_proposed_if_the_file_falls_with_z_up(turn, up, tmp_path):
    path = obj(tmp_path / "a.obj", toppled(turn))
    read = load(path)
    assert not read.notes
    assert better_up(read, contacts(read)) == up
    for stated in (load(path, up="z"), load(path, down=[0, 0, -1])):
        assert better_up(stated, contacts(stated)) is None


def test_the_way_up_decides_the_verdict(tmp_path):
    path = obj(tmp_path / "a.obj", [([2, 1, 2], [0, 0, 0]), ([1, 1, 1], [0, 1, 0])])
    assert check(load(path, ground="box0")).verdict == "unstable"
    assert check(load(path, ground="box0", up="y")).verdict == "stable"


# source of the contacts --------------------------------------------------------------------

CUBES = [
    Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True),
    Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5])),
]
ASIDE = GivenContact(("table", "cube"), [[0.4, 0, 0], [0.4, 0.1, 0], [0.5, 0, 0]], [0, 0, 1])


def test_contacts_of_a_kilter_file(tmp_path):
    """The cube tips on the points of the file, beside its centre of mass, but not on its faces."""
    dump(Assembly(CUBES, contacts=[ASIDE]), tmp_path / "a.kilter.json")
    verdicts = {
        which: check(load(tmp_path / "a.kilter.json", contacts=which)).verdict
        for which in (None, "file", "geometry")
    }
    assert verdicts == {None: "unstable", "file": "unstable", "geometry": "stable"}
    assert not load(tmp_path / "a.kilter.json", contacts="file").detect


def test_a_file_without_contacts_has_none_to_take(tmp_path):
    dump(Assembly(CUBES), tmp_path / "a.kilter.json")
    with pytest.raises(InputError, match="lists no contacts; leave contacts='file' out"):
        load(tmp_path / "a.kilter.json", contacts="file")


def test_a_floor_touches_nothing_in_the_file(tmp_path):
    dump(Assembly(CUBES, contacts=[ASIDE]), tmp_path / "a.kilter.json")
    with pytest.raises(InputError, match="the file lists none with the floor"):
        load(tmp_path / "a.kilter.json", contacts="file", floor=True)


EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
CUBE = {"name": "a", "box": [1, 2.5, 1e-3]}


def plain(entry: Any) -> Any:
    """The values of an entry of either kind, with the type of each number."""
    if isinstance(entry, BaseModel):
        return {key: plain(getattr(entry, key)) for key in type(entry).model_fields}
    if isinstance(entry, SimpleNamespace):
        return {key: plain(value) for key, value in vars(entry).items()}
    if isinstance(entry, list):
        return [plain(value) for value in entry]
    return type(entry), entry


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.kilter.json")), ids=lambda p: p.stem)
def test_the_entries_of_an_example_are_those_of_the_models(path):
    data = json.loads(path.read_text("utf-8"))
    entries = plain_entries(data)
    assert entries is not None
    assert plain(entries) == plain(AssemblyFile.model_validate(data))


@pytest.mark.parametrize("name", ["arch", "tower", "paper-figure-8"])
def test_the_entries_of_a_scene_are_those_of_the_models(name):
    data = json.loads(json.dumps(to_dict(example(name))))
    entries = plain_entries(data)
    assert entries is not None
    assert plain(entries) == plain(AssemblyFile.model_validate(data))


@pytest.mark.parametrize(
    "change",
    [
        {"units": "km"},
        {"gravity": [0, 0]},
        {"gravity": [0, 0, True]},
        {"gravity": [0, 0, "-9.81"]},
        {"gravity": [0, 0, float("nan")]},
        {"friction": -0.1},
        {"planar": 1},
        {"parts": []},
        {"parts": {}},
        {"parts": [CUBE | {"densty": 1}]},
        {"parts": [CUBE | {"density": 0}]},
        {"parts": [CUBE | {"name": ""}]},
        {"parts": [CUBE | {"name": "\ud800"}]},
        {"parts": [{"box": [1, 1, 1]}]},
        {"parts": [CUBE | {"brick": {"cells": [2.0, 4]}}]},
        {"bonds": [{"parts": ["a", "b"], "shear": "mo"}]},
        {"joints": [{"parts": ["a", "b"], "kind": "ball"}]},
        {"loads": [{"part": "a", "force": None}]},
    ],
    ids=str,
)
def test_what_the_models_reject_is_left_to_them(change):
    data = {"kilter": 1, "parts": [CUBE]} | change
    with pytest.raises(ValidationError):
        AssemblyFile.model_validate(data)
    assert plain_entries(data) is None


def test_many_values_and_solids_are_left_to_the_models():
    many = [CUBE | {"name": f"part {k}"} for k in range(MOST_VALUES)]
    assert plain_entries({"kilter": 1, "parts": many}) is None
    assert plain_entries({"kilter": 1, "parts": [{"name": "a", "solid": {}}]}) is None
    assert plain_entries([]) is None


def deep(depth: int = 0) -> int:
    return deep(depth + 1)


DAMAGED: dict[str, Callable[[], object]] = {
    "no number": lambda: int("x"),
    "no index": lambda: [0][1],
    "no encoding": lambda: b"x".decode("no-such-encoding"),
    "no text": lambda: b"\xff".decode(),
    "an overflow": lambda: int(float("inf")),
    "no axis": lambda: np.sum(np.zeros(3), axis=2),
    "an inverse": lambda: np.linalg.inv(np.zeros((2, 2))),
    "too deep": deep,
    "csv": lambda: list(csv.reader(["a\rb"])),
    "zlib": lambda: zlib.decompress(b"x"),
    "lzma": lambda: lzma.decompress(b"x"),
    "struct": lambda: struct.unpack("<f", b"x"),
    "zip": lambda: zipfile.ZipFile(__file__),
    "a name too long": lambda: Path("a" * 5000).read_bytes(),
}
FAULTS: dict[str, Callable[[], object]] = {
    "type": lambda: len(3),  # type: ignore[arg-type]
    "attribute": lambda: (3).size,  # type: ignore[attr-defined]
    "pipe": lambda: (_ for _ in ()).throw(BrokenPipeError),
    "runtime": lambda: (_ for _ in ()).throw(RuntimeError),
    "time": lambda: (_ for _ in ()).throw(TimeLimitReached),
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damaged_data_is_a_sentence_with_the_reason(name):
    with (
        pytest.raises(InputError, match=r"^a\.x: the file is damaged: .{4,160}; export it anew$"),
        reader_guard("a.x"),
    ):
        DAMAGED[name]()


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_of_kilter_stays_a_fault(name):
    faults = (TypeError, AttributeError, RuntimeError, OSError, TimeLimitReached)
    with pytest.raises(faults), reader_guard("a.x"):
        FAULTS[name]()


def test_a_reader_names_further_exceptions_and_its_own_errors_keep_their_words():
    with (
        pytest.raises(InputError, match="damaged: out of rooms"),
        reader_guard("a.x", also=("builtins.RuntimeError",)),
    ):
        raise RuntimeError("out of rooms.")
    own = pytest.raises(InputError, match=r"^a\.x: part 'b': its mass is -1$")
    with own, reader_guard("a.x"):
        raise InputError("its mass is -1", part="b")


def refused(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        load(path)
    assert str(caught.value).startswith(str(path))
    assert caught.value.hint
    return str(caught.value)


def test_one_part_a_file_in_the_order_people_count(write, obj_box):
    for k in (10, 2, 1):
        write(f"w/{k}.obj", "mtllib x.mtl\no object_1\n" + obj_box(1, (0, 0, k)))
    assembly = load(write("w/b.OBJ", obj_box()).parent)
    assert assembly.names == ("1", "2", "10", "b")
    assert assembly.geometry.center[:, 2] == pytest.approx([1, 2, 10, 0])
    assert assembly.source.endswith("w")
    assert assembly.notes == ()


def test_several_objects_of_a_file_have_its_name_before_theirs(write, obj_box):
    write("w/a.obj", "o x\n" + obj_box() + "o x\n" + obj_box(1, (3, 0, 0), 9))
    assembly = load(write("w/b.obj", obj_box()).parent)
    assert assembly.names == ("a/x", "a/x_2", "b")


def test_files_of_one_stem_have_names_of_their_own(write, obj_box):
    trimesh.creation.box().export(write("w/a.obj", obj_box()).with_suffix(".stl"))
    assert load(write("w/a.obj", obj_box()).parent).names == ("a", "a_2")


def test_separate_bodies_of_a_nameless_file_are_one_part(write, obj_box):
    path = write("w/a.obj", obj_box() + obj_box(1, (5, 0, 0), 9))
    assembly = load(path.parent)
    assert assembly.names == ("a",)
    assert assembly.notes == ("a.obj: 2 separate bodies, read as a single part",)


def test_files_of_other_kinds_are_named_in_a_note(write, obj_box):
    write("w/readme.txt", "x")
    write("w/a.kilter.json", "x")
    write("w/sub/b.obj", obj_box())
    write("w/.hidden.obj", "x")
    note = load(write("w/a.obj", obj_box()).parent).notes
    assert note == ("ignored, not mesh or STEP files: 'a.kilter.json', 'readme.txt', 'sub'",)


def test_many_ignored_files_are_counted(write, obj_box):
    for k in range(20):
        write(f"w/{k}.txt", "x")
    assert "'7.txt' and 12 more" in load(write("w/a.obj", obj_box()).parent).notes[0]


def test_a_folder_without_meshes(write):
    path = write("w/readme.txt", "x").parent
    assert "no mesh or STEP file in the folder; put files of .obj, .stl" in refused(path)
    write("w/a.kilter.json", "{}")
    assert "in the folder; give the file itself: 'a.kilter.json'" in refused(path)


def test_a_damaged_file_is_named(write):
    path = write("w/a.obj", "v 0 0 0\nf 1 2 3\n")
    assert f"{path}: line 2: the face names vertex 3, the file has 1" in refused(path.parent)


def test_a_folder_without_rights(tmp_path, monkeypatch):
    def refuse(_: Path) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "iterdir", refuse)  # the superuser may read every file
    assert "cannot be read: Permission denied; check" in refused(tmp_path)


def test_units_of_files_that_state_theirs(write, tmp_path, obj_box):
    folder = write("w/a.obj", obj_box()).parent
    trimesh.creation.box().export(folder / "b.3mf")
    assert load(folder).units == "mm"  # the only units that a file states
    assert load(folder, units="cm").geometry.volume == pytest.approx([1, 1e-3])
    trimesh.creation.box().export(folder / "c.glb")
    assert "files are in m and mm, 'a.obj' states no units; give the units" in refused(folder)
    (folder / "a.obj").unlink()
    assert load(folder).geometry.volume == pytest.approx([1e-9, 1])


def test_distinct_names_keep_those_that_are_there():
    assert distinct(["a", "a", "a_2", "a", "b"]) == ["a", "a_3", "a_2", "a_4", "b"]


DATA = Path(__file__).resolve().parents[3] / "shared" / "data"


COUNTS = {"A": 3, "H": 3, "bridge": 16, "cube-curve-short": 2, "cubes": 3}
COUNTS |= {"shelf-stable": 9, "type-a": 3, "type-c": 3}


@pytest.mark.skipif(
    not DATA.is_dir(), reason="real data is not here: ../shared/data beside the checkout"
)
@pytest.mark.quick(2)
@pytest.mark.parametrize(("name", "count"), COUNTS.items(), ids=COUNTS)
def test_compas(name, count):
    assembly = load(DATA / "compas_cra" / f"{name}.json", density=2000)
    assert assembly.names == tuple(str(k) for k in range(count))
    assert (assembly.geometry.volume > 0).all()
    assert not assembly.geometry.warnings
    assert assembly.geometry.single.all() == (name not in ("type-a", "type-c"))
    assert bool(assembly.notes) == (name == "cube-curve-short")  # 72 interfaces
    written = to_dict(assembly)
    assert to_dict(from_dict(written, folder=".", source="")) == written


@pytest.mark.skipif(
    not DATA.is_dir(), reason="real data is not here: ../shared/data beside the checkout"
)
@pytest.mark.parametrize(
    ("name", "count", "accuracy"), [("tetris-2", 17, 1e-7), ("dome", 73, 5e-9)]
)
def test_folders(name, count, accuracy, capfd):
    assembly = load(DATA / "learn2assemble" / name)
    assert assembly.names == tuple(str(k) for k in range(count))
    assert assembly.notes == ("ignored, not mesh or STEP files: 'rbe_admm.json'",)
    assert assembly.geometry.accuracy.max() == pytest.approx(accuracy, rel=0.6)
    assert capfd.readouterr() == ("", "")


# COMPAS ---------------------------------------------------------------------------------


@pytest.mark.skipif(
    not DATA.is_dir(), reason="real data is not here: ../shared/data beside the checkout"
)
@pytest.mark.parametrize("old", ["2db5a65-cubes", "84da9ff-cubes"])
def test_files_of_2021_equal_what_they_were_made_into(old):
    first, second = (load(DATA / "compas_cra" / f"{n}.json") for n in (f"old/{old}", "cubes"))
    assert to_dict(first) == to_dict(second)


@pytest.mark.skipif(
    not DATA.is_dir(), reason="real data is not here: ../shared/data beside the checkout"
)
def test_densities_turn_the_verdict_over():
    assembly = load(DATA / "compas_cra" / "densities.json", ground="0")
    assert assembly.geometry.mass / assembly.geometry.volume == pytest.approx([1, 1, 10])
    assert check(assembly).verdict == "stable"
    alike = [dataclasses.replace(part, density=None) for part in assembly.parts]
    assert check(dataclasses.replace(assembly, parts=alike)).verdict == "unstable"


@pytest.mark.skipif(
    not DATA.is_dir(), reason="real data is not here: ../shared/data beside the checkout"
)
@pytest.mark.slow
@pytest.mark.parametrize(
    ("mu", "forces"), sampled(2, [(0, False), (0.04, False), (0.02, False), (0.84, True)])
)
def test_curved_blocks_on_the_interfaces_of_the_file(mu, forces):
    """The friction limit is near .051; below it, the blocks slide along -x."""
    path = DATA / "compas_cra" / "curve-3-blocks.json"
    found = check(load(path, ground="0", contacts="file", friction=mu))
    assert (found.verdict != "unstable") == forces
    assert len(found.contact_set) == 40
    assert found.evidence is not None


@pytest.mark.skipif(
    not DATA.is_dir(), reason="real data is not here: ../shared/data beside the checkout"
)
@pytest.mark.slow
def test_crossvault_on_the_interfaces_of_the_file():
    path = DATA / "compas_assembly" / "crossvault.json"
    assembly = load(path, contacts="file", friction=0.84)
    assert [part.name for part in assembly.parts if part.grounded] == ["180", "181", "182", "183"]
    found = check(assembly)
    assert len(found.contact_set) == 488
    assert found.verdict not in ("unstable", "undecided")


@pytest.mark.skipif(
    not DATA.is_dir(), reason="real data is not here: ../shared/data beside the checkout"
)
@pytest.mark.slow
@pytest.mark.parametrize("mu", [0.5, 0.84])
def test_the_warped_blocks_of_crossvault_come_to_rest_by_the_least_motion(mu):
    path = DATA / "compas_assembly" / "crossvault.json"
    drawn = load(path, contacts="geometry", friction=mu)
    answer = kilter.settle(drawn, nearest=True, require="equilibrium")
    assert answer.state == "at-rest"
    assert answer.rounds <= 8
    assert answer.distance.max() < 1e-3
    assert kilter.verify(answer.assembly, answer.proof()).holds


@pytest.mark.slow
@pytest.mark.skipif(
    not DATA.is_dir(), reason="real data is not here: ../shared/data beside the checkout"
)
def test_a_mount_with_coordinates_far_from_the_origin_is_proved():
    """Rounding errors of 1e-12 in the rows made every simplex fail: no motion, no forces."""
    pytest.importorskip("OCP")
    verdict = check(load(DATA / "voron" / "MiniSB_adxl_mount.step", floor=True))
    assert verdict.verdict == "unstable"
    assert verdict.decision.judgement.motion.holds
