"""Limits of the load on the top of an item, on both sides of closed forms."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from kilter import InputError
from kilter.analysis.placing.check_plan import check_plan
from kilter.cli import main
from kilter.files.packing_lists import load_plan

HEADER = "name,length,width,height,mass,x,y,z,max_load/kg\n"
COLUMN = "a,1,1,1,9,0,0,0,{}\nb,1,1,1,2,0,0,1,\nc,1,1,1,3,0,0,2,\n"
BRIDGE = "a,1,1,1,9,0,0,0,{}\nb,1,1,1,9,2,0,0,\nc,3,1,1,4,0,0,1,\n"
NARROW = "a,0.02,1,1,9,0,0,0,{}\nb,0.02,1,1,9,2.98,0,0,\nc,3,1,1,4,0,0,1,\nd,0.1,1,1,6,0.7,0,2,\n"
NEAR = 1e-6


def written(folder: Path, rows: str, limit: object) -> Path:
    path = folder / "plan.csv"
    path.write_text(HEADER + rows.format(limit), encoding="utf-8")
    return path


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_boxes_in_a_column(tmp_path: Path, friction: float) -> None:
    """All of the weight above rests on the lowest top: 2 + 3 kg."""
    below = check_plan(written(tmp_path, COLUMN, 5 * (1 - NEAR)), friction=friction)
    assert below.overload is not None
    assert below.first is None
    assert (below.overload.item, below.overload.after) == ("a", 3)
    assert below.overload.load == pytest.approx(5, rel=1e-9)
    above = check_plan(written(tmp_path, COLUMN, 5 * (1 + NEAR)), friction=friction)
    assert above.overload is None
    assert above.items[0].top_load == pytest.approx(5, rel=1e-9)
    assert above.items[1].top_load is None


def test_a_bridge_on_two_wide_boxes(tmp_path: Path) -> None:
    """The lever rule with the force on 'a' at its outer end, x = 0, and on 'b' at its inner end.

    About x = 2: load 2 = 4 (2 - 1.5), so the least load is 1 kg, not half of the weight.
    """
    assert check_plan(written(tmp_path, BRIDGE, 1 - NEAR)).overload is not None
    assert check_plan(written(tmp_path, BRIDGE, 1 + NEAR)).overload is None


def test_a_loaded_bridge_on_two_narrow_boxes(tmp_path: Path) -> None:
    """Forces at x = 0 and x = 2.98: load 2.98 = 4 (2.98 - 1.5) + 6 (2.98 - 0.75)."""
    load = (4 * 1.48 + 6 * 2.23) / 2.98
    over = check_plan(written(tmp_path, NARROW, load * (1 - NEAR))).overload
    assert over is not None
    assert over.after == 4
    assert check_plan(written(tmp_path, NARROW, load * (1 + NEAR))).overload is None


def test_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = str(written(tmp_path, COLUMN, 4))
    assert main(["check-plan", path, "--quiet"]) == 1
    words = "Item 3, 'c', overloads 'a': its top must carry 5 kg, and its limit is 4 kg."
    assert words in " ".join(capsys.readouterr().out.split())
    assert main(["check-plan", path, "--json", "--quiet"]) == 1
    assert json.loads(capsys.readouterr().out)["overload"]["max_load"] == 4
    assert main(["check-plan", str(written(tmp_path, COLUMN, 6)), "--quiet"]) == 0


def test_an_invalid_limit(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="line 2: max_load is -1"):
        load_plan(written(tmp_path, COLUMN, -1))
    with pytest.raises(InputError, match="line 2: max_load is 'heavy'"):
        load_plan(written(tmp_path, COLUMN, "heavy"))
    path = tmp_path / "newton.csv"
    path.write_text(HEADER.replace("/kg", "/N") + COLUMN.format(1), encoding="utf-8")
    with pytest.raises(InputError, match="line 1: max_load in 'N'"):
        load_plan(path)
