"""Options of reading: the axis that points up, and the source of the contacts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kilter.analysis.check import check
from kilter.assembly import Assembly, GivenContact, Part
from kilter.errors import InputError
from kilter.files import dump, load
from kilter.files.reading import Reading
from kilter.rigid import Pose
from kilter.shape.primitives import Box, surface

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
def test_up_is_down_turned_round(axis: str, sign: int, tmp_path: Path) -> None:
    path = obj(tmp_path / "a.obj", [([1, 1, 1], [0, 0, 0])])
    name = axis if sign > 0 else f"-{axis}"
    assert load(path, up=name).down.tolist() == [-sign * x for x in AXES[axis]]


@pytest.mark.parametrize(("options", "words"), [
    ({"up": "Y"}, "up is 'Y'; use x, y, z"),
    ({"up": "y", "down": (0, -1, 0)}, "up and down are both given"),
    ({"contacts": "mesh"}, "contacts are 'mesh'; use file or geometry"),
])  # fmt: skip
def test_options_that_make_no_sense(options: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        load("a.obj", **options)


def test_a_proof_s_options_carry_them() -> None:
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
def test_a_hint_where_another_axis_seems_up(turn: list[int], up: str | None, tmp_path) -> None:
    path = obj(tmp_path / "a.obj", toppled(turn))
    notes = [note for note in load(path).notes if "--up" in note]
    assert len(notes) == (up is not None)
    if up is not None:
        assert f"--up {up} " in notes[0]
        assert not load(path, up=up).notes
        assert not load(path, down=[0, 0, -1]).notes


def test_the_way_up_decides_the_verdict(tmp_path: Path) -> None:
    path = obj(tmp_path / "a.obj", [([2, 1, 2], [0, 0, 0]), ([1, 1, 1], [0, 1, 0])])
    assert check(load(path, ground="box0")).verdict == "unstable"
    assert check(load(path, ground="box0", up="y")).verdict == "stable"


# source of the contacts --------------------------------------------------------------------

CUBES = [
    Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True),
    Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5])),
]
ASIDE = GivenContact(("table", "cube"), [[0.4, 0, 0], [0.4, 0.1, 0], [0.5, 0, 0]], [0, 0, 1])


def test_contacts_of_a_kilter_file(tmp_path: Path) -> None:
    """The cube tips on the points of the file, beside its centre of mass, but not on its faces."""
    dump(Assembly(CUBES, contacts=[ASIDE]), tmp_path / "a.kilter.json")
    verdicts = {
        which: check(load(tmp_path / "a.kilter.json", contacts=which)).verdict
        for which in (None, "file", "geometry")
    }
    assert verdicts == {None: "unstable", "file": "unstable", "geometry": "stable"}
    assert not load(tmp_path / "a.kilter.json", contacts="file").detect


def test_a_file_without_contacts_has_none_to_take(tmp_path: Path) -> None:
    dump(Assembly(CUBES), tmp_path / "a.kilter.json")
    with pytest.raises(InputError, match="lists no contacts; leave contacts='file' out"):
        load(tmp_path / "a.kilter.json", contacts="file")


def test_a_floor_touches_nothing_in_the_file(tmp_path: Path) -> None:
    dump(Assembly(CUBES, contacts=[ASIDE]), tmp_path / "a.kilter.json")
    with pytest.raises(InputError, match="the file lists none with the floor"):
        load(tmp_path / "a.kilter.json", contacts="file", floor=True)
