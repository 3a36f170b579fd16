"""The least change after which an assembly stands: values by hand, and wrong input."""

import importlib.util
import math
import sys
from pathlib import Path

import pytest

import kilter
from kilter import Assembly, Box, Part
from kilter.cli import main
from kilter.errors import InputError
from kilter.scenes import stacks

FILE = Path(__file__).resolve().parents[2] / "benchmarks" / "stand_census.py"


def table() -> Part:
    return Part("table", Box(9, 9, 1), [0, 0, -0.5], grounded=True)


def overhang(**more: object) -> Assembly:
    parts = [
        Part("low", Box(1, 1, 1), [0, 0, 0.5], **more),
        Part("high", Box(1, 1, 1), [0.8, 0, 1.5]),
    ]
    return Assembly([table(), *parts], friction=0.7)


def made(assembly: Assembly, *allow: str, tilt: float = 5.0) -> object:
    return kilter.margin(assembly, make_stand=list(allow), stand_tilt_deg=tilt).made_stand


@pytest.mark.parametrize("tilt", [2.0, 5.0])
def test_the_least_movement_of_an_overhang(tilt):
    """The upper box rests within 1/2 less tan(tilt)/2 of the lower: the sum of both movements."""
    found = made(overhang(), "move", tilt=tilt)
    assert found.stands
    least = 0.8 - (0.5 - math.tan(math.radians(tilt)) / 2)
    assert sum(abs(change.by) for change in found.changes) == pytest.approx(least, rel=1e-4)
    again = kilter.margin(found.assembly)
    assert again.tilt_lower_deg >= tilt
    assert kilter.check(found.assembly).stable


def test_the_least_friction_on_a_slope():
    """A block on a slope of 20 degrees and a tilt of 2: mu = tan 22."""
    given = stacks.block_on_slope(20.0, friction=0.2)
    found = made(given, "friction", tilt=2.0)
    assert found.stands
    [change] = found.changes
    assert change.what == "friction"
    assert 0.2 + change.by == pytest.approx(math.tan(math.radians(22)), rel=1e-4)


def test_a_wider_foot():
    """The lower box grows to both sides: twice the missing overhang."""
    found = made(overhang(), "size", tilt=2.0)
    least = 2 * (0.8 - (0.5 - math.tan(math.radians(2)) / 2))
    assert [change.by for change in found.changes] == pytest.approx([least], rel=1e-3)


def test_masses_alone_do_not_make_an_overhang_stand():
    found = made(overhang(), "mass")
    assert not found.stands
    assert not found.changes


def test_an_assembly_that_stands_needs_no_change():
    given = Assembly([table(), Part("box", Box(1, 1, 1), [0, 0, 0.5])], friction=0.9)
    found = made(given, "move", "mass")
    assert found.stands
    assert found.change == 0
    assert not found.changes


@pytest.mark.parametrize(
    ("allow", "tilt", "words"),
    [
        (["turn"], 2.0, "'turn' is no kind of change"),
        ([], 2.0, "no kind of change"),
        (["move"], 95.0, "the tilt is 95 deg"),
    ],
)
def test_wrong_requests_are_errors(allow, tilt, words):
    with pytest.raises(InputError, match=words):
        made(overhang(), *allow, tilt=tilt)


def test_the_command_names_the_changes(tmp_path, capsys):
    path = tmp_path / "overhang.kilter.json"
    kilter.dump(overhang(), path)
    words = ["margin", str(path), "--quiet", "--make-stand"]
    assert main([*words, "--allow", "move", "--tilt", "5"]) == 1  # as given it falls
    out = capsys.readouterr().out
    assert "move 'low' by" in out
    assert "then it stands up to a tilt of 5" in out
    assert main([*words, "--allow", "turn"]) == 2
    assert "'turn' is no kind of change" in capsys.readouterr().err


@pytest.mark.slow
def test_falling_assemblies_of_all_families_stand(monkeypatch):
    """The first cases of benchmarks/stand_census.py."""
    spec = importlib.util.spec_from_file_location("stand_census", FILE)
    census = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(census)
    monkeypatch.setattr(sys, "argv", [str(FILE), "10"])
    assert census.main() == 0
