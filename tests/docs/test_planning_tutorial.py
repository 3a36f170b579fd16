"""The STEP file of the examples is the one made here; the command that the tutorial shows of it."""

from __future__ import annotations

import json
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter.cli import main

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "clamp.step"


@pytest.fixture
def clamp(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A base, an arm with a hole on it, a bolt in the hole and a nut round the bolt."""
    pytest.importorskip("OCP", reason="needs the extra kilter[step]")
    monkeypatch.syspath_prepend(str(ROOT / "tests" / "files"))
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
    from step_maker import write_step

    def cylinder(radius: float, low: float, high: float) -> object:
        axis = gp_Ax2(gp_Pnt(0, 0, low), gp_Dir(0, 0, 1))
        return BRepPrimAPI_MakeCylinder(axis, radius, high - low).Shape()

    def box(low: tuple[float, ...], high: tuple[float, ...]) -> object:
        return BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape()

    shaft = cylinder(4, 0, 40)
    arm = BRepAlgoAPI_Cut(box((-10, -10, 0), (60, 10, 10)), shaft).Shape()
    nut = BRepAlgoAPI_Cut(cylinder(7, 10, 16), shaft).Shape()
    roots = [("base", box((-30, -30, -10), (70, 30, 0)), None), ("arm", arm, None)]
    return write_step(tmp_path / "clamp.step", [*roots, ("bolt", shaft, None), ("nut", nut, None)])


@pytest.mark.slow
def test_the_example_is_what_is_made_here(clamp: Path) -> None:
    made, kept = (kilter.load(path, ground="base") for path in (clamp, EXAMPLE))
    assert made.names == kept.names
    for name in ("volume", "center", "inertia"):
        assert np.array_equal(getattr(made.geometry, name), getattr(kept.geometry, name))
    assert kilter.check(kept).stable


@pytest.mark.slow
def test_the_command_of_the_page_puts_the_nut_over_its_bolt(
    clamp: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(clamp.parent)
    page = (ROOT / "docs" / "planning-tutorial.md").read_text(encoding="utf-8")
    [line] = re.findall(r"^kilter (plan examples/clamp\.step .*)$", page, flags=re.M)
    words = shlex.split(line)
    shutil.copytree(ROOT / "examples", clamp.parent / "examples")
    assert main(words) == 0, capsys.readouterr().err
    assert (clamp.parent / "clamp.html").stat().st_size > 1e5
    capsys.readouterr()
    assert main([*words[: words.index("-o")], "--json"]) == 0
    steps = json.loads(capsys.readouterr().out)["steps"]
    assert [step["parts"] for step in steps][-1] == ["nut"]
    assert (steps[-1]["over"], steps[-1]["direction"]) == ("bolt", [0, 0, -1])
    # without the word about the thread the nut is a ring that comes along any way that is free
    screws = words.index("--screws")
    assert main([*words[:screws], *words[screws + 3 : words.index("-o")], "--json"]) == 0
    assert all(step["over"] is None for step in json.loads(capsys.readouterr().out)["steps"])
