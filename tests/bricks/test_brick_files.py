"""Files of toy bricks: StableLego JSON, BrickGPT text, LDraw; faults are reported with the line."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter.assembly.bricks.brick_assembly import bricks_of
from kilter.assembly.bricks.brick_library import LDRAW, STABLE_LEGO, brick_mass
from kilter.cli import main

SHARED = Path(__file__).resolve().parents[3] / "shared" / "data"
STAIR = {
    "1": {"x": 3, "y": 5, "z": 0, "brick_id": 2, "ori": 1},
    "2": {"x": 5, "y": 5, "z": 1, "brick_id": 2, "ori": 1},
    "3": {"x": 8, "y": 6, "z": 2, "brick_id": 9, "ori": 0},
}
TEXT = "4x2 (3,5,0)\n4x2 (5,5,1)\n1x2 (8,6,2)\n"
LDR = """0 a stair
1 4 60 -24 40 1 0 0 0 1 0 0 0 1 3001.dat
1 2 100 -48 40 1 0 0 0 1 0 0 0 1 3001.DAT
1 0x2FF8000 130 -72 60 0 0 1 0 1 0 -1 0 0 3004.dat
"""


def loaded(path: Path, text: str, **options: object) -> kilter.Assembly:
    path.write_text(text, encoding="utf-8")
    return kilter.load(path, **options)


def refused(path: Path, text: str) -> str:
    with pytest.raises(kilter.InputError) as caught:
        loaded(path, text)
    assert path.name in str(caught.value)
    return str(caught.value)


def cells(assembly: kilter.Assembly) -> list[tuple[float, ...]]:
    """Boxes of the free parts in cells and layers, relative to their lowest corner."""
    free = [part for part in assembly.parts if not part.grounded]
    size = np.array([part.shape.size for part in free])
    low = np.array([part.pose.position for part in free]) - size / 2
    cell = free[0].shape.size[0] / free[0].brick.cells[0]
    rows = np.hstack([low - low.min(axis=0), size]) / [cell, cell, 9.6, cell, cell, 9.6]
    return [tuple(row) for row in rows.round(9).tolist()]


def test_one_model_in_three_formats(tmp_path):
    given = loaded(tmp_path / "a.json", json.dumps(STAIR))
    text = loaded(tmp_path / "a.txt", TEXT)
    ldraw = loaded(tmp_path / "a.ldr", LDR)
    assert given.names == text.names == ldraw.names == ("2x4-1", "2x4-2", "1x2-3", "baseplate")
    # LDraw's z is opposite to kilter's y
    assert cells(given) == cells(text)
    # four studs of three points, a stud of four points under a narrow brick, eight on the baseplate
    for one in (given, text, ldraw):
        assert [len(bond.points) for bond in one.bonds] == [12, 4, 24]
    assert given.units == "mm"
    assert given.gravity.tolist() == [0, 0, -9.8]
    assert [part.mass for part in given.parts[:3]] == [0.00216, 0.00216, 0.00081]
    colors = [part.brick.color for part in ldraw.parts]
    assert colors == [4, 2, 0x2FF8000, None]
    assert not any(kilter.check(one).verdict != "stable" for one in (given, text, ldraw))


def test_every_brick_and_weight_of_the_library_is_read(tmp_path):
    for number, (across, along, mass) in STABLE_LEGO.items():
        for turned in (0, 1):
            brick = {"x": 0, "y": 0, "z": 0, "brick_id": number, "ori": turned}
            part = loaded(tmp_path / "one.json", json.dumps({"7": brick})).parts[0]
            size = (along, across) if turned else (across, along)
            assert part.brick.cells == size
            assert part.shape.size.tolist() == [7.8 * size[0], 7.8 * size[1], 9.6]
            assert part.mass == mass
    assert part.name == "2x2-7"


@pytest.mark.slow
def test_every_part_of_ldraw_is_read(tmp_path):
    for number, (across, along, plates) in LDRAW.items():
        line = f"1 4 0 0 0 1 0 0 0 1 0 0 0 1 {number}.dat\n"
        # a file must have a brick beside a baseplate
        x, z = 10 * (1 - along % 2), 10 * (1 - across % 2)
        far = "" if plates else f"1 4 {x} -24 {z} 1 0 0 0 1 0 0 0 1 3005.dat\n"
        part = loaded(tmp_path / "one.ldr", line + far).parts[0]
        assert part.brick.cells == (along, across)
        assert part.grounded == (plates == 0)
        assert part.brick.plates == max(plates, 1)
        if plates:
            assert part.mass == brick_mass(across, along, plates)


@pytest.mark.skipif(not SHARED.is_dir(), reason="no shared data")
def test_the_libraries_are_those_of_the_sources():
    given = json.loads((SHARED / "stablelego" / "lego_library.json").read_text())
    found = {int(k): (b["height"], b["width"], b["mass"]) for k, b in given.items()}
    assert found == STABLE_LEGO
    for k, brick in json.loads((SHARED / "brickgpt" / "brick_library.json").read_text()).items():
        across, along = brick["height"], brick["width"]
        assert STABLE_LEGO[int(k)] == (across, along, brick["mass"])
        assert LDRAW[brick["partID"].split(".")[0]] == (across, along, 3)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"brick_id": 77}, r"line 3: brick '2' has the unknown brick_id 77; .* 1, 2, 3"),
        ({"z": -1}, "line 3: brick '2' is in layer -1; layers are counted from 0"),
        ({"x": 1.5}, "line 3: brick '2' has x 1.5; give a whole number"),
        ({"ori": 2}, "line 3: brick '2' has ori 2; give 0 for along x"),
        (
            {"x": 6, "z": 0},
            r"line 3: cell \(6, 5\) is occupied by the brick in line 2; move either",
        ),
    ],
)
def test_wrong_bricks_of_stable_lego(change, message, tmp_path):
    data = {**STAIR, "2": {**STAIR["2"], **change}}
    lines = ",\n".join(f' "{key}": {json.dumps(brick)}' for key, brick in data.items())
    assert re.search(message, refused(tmp_path / "bad.json", f"{{\n{lines}\n}}"))


def test_a_brick_of_stable_lego_that_is_none(tmp_path):
    text = '{\n "1": {"x": 0, "y": 0, "z": 0, "brick_id": 2, "ori": 0},\n\n "2": 5\n}'
    said = refused(tmp_path / "b.json", text)
    assert "line 4: brick '2' is 5; give an object with x, y, z" in said
    assert "not JSON: Expecting" in refused(tmp_path / "b.json", text[:-3] + ",}")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("3x5 (0,0,0)", "line 3: a brick of 3x5 is unknown; known sizes are 1x1, 1x2, 1x4"),
        ("2x4 (0,0,-2)", "line 3: the brick is in layer -2; layers are counted from 0"),
        ("2x4 (0,0)", r"line 3: '2x4 \(0,0\)' is not a brick; write a brick like 2x4 \(10,3,0\)"),
        ("1x1 (4,6,0)", r"line 3: cell \(4, 6\) is occupied by the brick in line 1"),
        ("1x1 (99999999,6,0)", "line 3: .* is not a brick"),
    ],
)
def test_wrong_lines_of_text(line, message, tmp_path):
    text = TEXT.splitlines()[0] + "\n\n" + line + "\n"
    assert re.search(message, refused(tmp_path / "bad.txt", text))


def test_text_without_a_brick_and_of_other_bytes(tmp_path):
    assert "the file has no bricks" in refused(tmp_path / "bad.txt", "\n \n")
    (tmp_path / "bad.txt").write_bytes(b"2x4 (0,0,0)\n\xff\n")
    with pytest.raises(kilter.InputError, match="line 2: not UTF-8"):
        kilter.load(tmp_path / "bad.txt")


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("1 4 0 0 0 1 0 0 0 1 0 0 0 3001.dat", "line 5: .* does not place a part; write 1, a col"),
        ("1 4 0 nan 0 1 0 0 0 1 0 0 0 1 3001.dat", "line 5: .* does not place a part"),
        ("1 -4 0 0 0 1 0 0 0 1 0 0 0 1 3001.dat", "line 5: .* does not place a part"),
        ("1 0x100000000 0 0 0 1 0 0 0 1 0 0 0 1 3001.dat", "line 5: .* does not place a part"),
        ("2x4 (0,0,0)", r"line 5: '2x4 \(0,0,0\)' is not a line of LDraw"),
        ("0 FILE a\n0 FILE a", "line 6: two models are named 'a'"),
    ],
)
def test_wrong_lines_of_ldraw(line, message, tmp_path):
    assert re.search(message, refused(tmp_path / "bad.ldr", LDR + line + "\n"))


def test_models_in_models_inherit_colours_and_turns(tmp_path):
    text = """0 FILE house.ldr
1 4 0 0 0 1 0 0 0 1 0 0 0 1 Side One.ldr
1 1 70 -24 10 0 0 1 0 1 0 -1 0 0 side one.ldr
0 FILE side one.ldr
1 16 0 -24 0 1 0 0 0 1 0 0 0 1 3010.dat
1 14 0 -32 0 1 0 0 0 1 0 0 0 1 3710.dat
2 24 0 0 0 1 1 1
"""
    found = loaded(tmp_path / "house.mpd", text)
    assert found.names == ("1x4-1", "plate-1x4-2", "1x4-3", "plate-1x4-4", "baseplate")
    assert [part.brick.color for part in found.parts] == [4, 14, 1, 14, None]
    assert [part.brick.cells for part in found.parts[:4]] == [(4, 1), (4, 1), (1, 4), (1, 4)]
    assert found.parts[1].shape.size == pytest.approx([32, 8, 3.2])
    assert any("drawn edges and faces" in note for note in found.notes)
    assert any("masses of these bricks are estimates: 1x4 plate" in note for note in found.notes)
    circle = text + "1 4 0 0 0 1 0 0 0 1 0 0 0 1 house.ldr\n"
    assert "line 8: the model 'house.ldr' contains itself" in refused(tmp_path / "c.mpd", circle)


@pytest.mark.parametrize(
    ("line", "note"),
    [
        ("1 4 0 0 0 1 0 0 0 1 0 0 0 1 3176.dat", r"kilter knows no such part\): 3176.dat \(1\)"),
        ("1 4 0 0 0 .8 0 .6 0 1 0 -.6 0 .8 3001.dat", r"tilted, or off the grid\): 3001.dat \(1\)"),
        ("1 4 0 0 0 1 0 0 0 -1 0 0 0 -1 3001.dat", "tilted, or off the grid"),
        ("1 4 0 -23 0 1 0 0 0 1 0 0 0 1 3001.dat", "tilted, or off the grid"),
        ("1 4 60 -32 40 1 0 0 0 1 0 0 0 1 3001.dat", "in the cells of an earlier part"),
        ("1 4 1e30 0 0 1 0 0 0 1 0 0 0 1 3001.dat", "tilted, or off the grid"),
    ],
)
def test_other_parts_are_left_out_with_a_note(line, note, tmp_path):
    found = loaded(tmp_path / "odd.ldr", LDR + line + "\n")
    assert found.names == loaded(tmp_path / "plain.ldr", LDR).names
    assert re.search(rf"^1 part is left out \({note}", "\n".join(found.notes), re.MULTILINE)
    if "-23" in line or "-32" in line:  # another part is the reason
        return
    only = refused(tmp_path / "only.ldr", line + "\n")
    assert "the file has no bricks that kilter knows" in only


def test_a_named_model_of_several(tmp_path):
    text = """0 FILE small.ldr
1 4 0 0 0 1 0 0 0 1 0 0 0 1 3004.dat
0 FILE Large Part.ldr
1 4 0 0 0 1 0 0 0 1 0 0 0 1 3001.dat
1 4 0 -24 0 1 0 0 0 1 0 0 0 1 3001.dat
"""
    first = loaded(tmp_path / "two.mpd", text)
    assert len(first) == 2
    assert any("--model NAME reads another: 'large part.ldr'" in note for note in first.notes)
    other = kilter.load(tmp_path / "two.mpd", model="Large part.LDR")
    assert other.names == ("2x4-1", "2x4-2", "baseplate")
    with pytest.raises(kilter.InputError, match=r"no model 'lage part.ldr'; did you mean 'large p"):
        kilter.load(tmp_path / "two.mpd", model="lage part.ldr")
    (tmp_path / "one.txt").write_text(TEXT)
    with pytest.raises(kilter.InputError, match="only LDraw files"):
        kilter.load(tmp_path / "one.txt", model="a")


QUARTERS = ("1 0 0 0 1 0 0 0 1", "0 0 1 0 1 0 -1 0 0", "-1 0 0 0 1 0 0 0 -1", "0 0 -1 0 1 0 1 0 0")
"""Matrices of quarter turns about the vertical."""


@pytest.mark.parametrize("turn", QUARTERS)
@pytest.mark.parametrize(("part", "deep"), [("3039", 2), ("3298bp01", 3)])
def test_a_slope_has_studs_on_its_edge_only(part, deep, turn, tmp_path):
    """A slope 2 cells wide: its volume, the side of its studs, and a brick on either side."""
    text = f"1 4 0 0 0 {turn} {part}.dat\n"
    slope = loaded(tmp_path / "one.ldr", text).parts[0]
    assert slope.name == f"slope-2x{deep}-1"
    prism = 1 + (deep - 1) * (3 + 0.5) / 2 / 3
    volume = kilter.Assembly([slope], units="mm").geometry.volume[0]
    assert volume == pytest.approx(2 * prism * 8 * 8 * 9.6, rel=1e-9)  # [mm^3]
    # in its own frame the studs are at z = 0, the slope falls towards -z
    matrix = np.array(turn.split(), dtype=float).reshape(3, 3)
    for place, bonds in (((0, -24, 0), 2), ((0, -24, -20), 1)):
        x, y, z = matrix @ place
        above = f"{x:g} {y:g} {z:g} {turn}"
        found = loaded(tmp_path / "on.ldr", text + f"1 4 {above} 3004.dat\n")
        assert len(found.bonds) == bonds, place
        # beyond the studs nothing carries the brick
        assert kilter.check(found).stable == (bonds == 2)


def test_a_tile_holds_by_its_weight_only(tmp_path):
    """A 2x4 brick on a 2x2 tile: it stands with its middle over the tile, and tips beyond it."""
    text = "1 4 0 0 0 1 0 0 0 1 0 0 0 1 3068b.dat\n1 4 {x} -24 0 1 0 0 0 1 0 0 0 1 3001.dat\n"
    for x, verdict in ((0, "stable"), (40, "unstable")):
        found = loaded(tmp_path / "tile.ldr", text.format(x=x))
        assert found.names[:2] == ("tile-2x2-1", "2x4-2")
        assert len(found.bonds) == 1  # that of the tile with the baseplate
        assert kilter.check(found).verdict == verdict
    with pytest.raises(kilter.InputError, match="it is not a brick"):
        bricks_of(found)


def test_a_baseplate_of_the_file_is_what_is_held(tmp_path):
    text = LDR + "1 2 80 0 40 1 0 0 0 1 0 0 0 1 3867.dat\n"
    found = loaded(tmp_path / "on.ldr", text)
    assert [part.name for part in found.parts if part.grounded] == ["baseplate-4"]
    assert kilter.check(found).verdict == "stable"
    # the contact beside it does not hold the stair
    beside = text.replace("1 2 80 0 40", "1 2 800 0 40")
    assert kilter.check(loaded(tmp_path / "off.ldr", beside)).verdict == "unstable"


BAD = {
    "a.json": '{\n "1": {"x": 0, "y": 0, "z": 0, "brick_id": 99, "ori": 0}\n}',
    "b.json": '{\n "1": {"x": 0, "y": 0, "z": -1, "brick_id": 2, "ori": 0}\n}',
    "c.json": '{"1": {"x": 0, "y": 0, "z": 0, "brick_id": 2, "ori": 0},\n "2": 5}',
    "d.txt": "2x4 (0,0,0)\n1x1 (1,1,0)\n",
    "e.txt": "\n2x4 (0,0,-1)\n",
    "f.txt": "\n2x4 (0,0\n",
    "h.ldr": "\n1 4 0 0 0 1 0 0 0 1 0 0 0 1\n",
    "i.mpd": "1 4 0 0 0 1 0 0 0 1 0 0 0 1 3001.dat\nbrick\n",
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", BAD)
def test_a_bad_file_is_exit_2_and_names_the_line(name, tmp_path, capsys):
    (tmp_path / name).write_text(BAD[name])
    assert main(["check", str(tmp_path / name)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert name in error
    assert "line 2: " in error
    assert "; " in error  # the remedy


@pytest.mark.slow
def test_a_bad_file_is_exit_2_with_one_line(tmp_path, capsys):
    (tmp_path / "bad.txt").write_text("2x4 (0,0,0)\n9x9 (0,0,1)\n")
    assert main(["check", str(tmp_path / "bad.txt")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "line 2: a brick of 9x9 is unknown" in error
    (tmp_path / "a.txt").write_text(TEXT)
    assert main(["check", str(tmp_path / "a.txt"), "--brick-sides", "edge"]) == 2
    assert "the sides of bricks are 'edge'; use lower-edge" in capsys.readouterr().err
    assert main(["check", str(tmp_path / "a.txt"), "--stud-shear", "much"]) == 2
    assert "the shear of studs is 'much'; use unlimited" in capsys.readouterr().err
    assert main(["check", str(tmp_path / "a.txt"), "--stud-pull", "-1"]) == 2
    assert "pull of a stud is -1" in capsys.readouterr().err
    assert main(["check", str(tmp_path / "a.txt")]) == 0
