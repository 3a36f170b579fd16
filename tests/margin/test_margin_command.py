"""`kilter margin`: keys of its JSON, its words, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kilter
from kilter import Assembly, Box, Part, Sphere
from kilter.cli import main
from kilter.scenes import scene, stacks


@pytest.fixture
def tower(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    kilter.dump(stacks.tower(2, friction=0.6), "tower.json")
    return "tower.json"


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--part", "base"], "held"),
        (["--part", "cube-9"], "cube-9"),
        (["--push", "0", "0", "0"], "push"),
        (["--push", "nan", "0", "0"], "push"),
        (["--about", "0", "0", "1"], "not perpendicular to gravity"),
        (["--about", "0", "0", "0"], "axis"),
        (["--mass-range", "1.1", "0.9"], "empty"),
        (["--mass-range", "0", "1"], "mass range"),
        (["--mu-range", "1.2", "1.1"], "empty"),
        (["--mu-range", "-0.1", "1"], "mu range"),
        (["--com-range", "-0.1"], "com range"),
        (["--com-range", "inf"], "com range"),
        (["--normal-tilt", "-1"], "normal tilt"),
        (["--normal-tilt", "90"], "normal tilt"),
        (["--effort", "-1"], "--effort"),
    ],
)
def test_wrong_input_is_refused_in_one_line(tower, capsys, words, said):
    capsys.readouterr()
    assert main(["margin", tower, *words]) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert said in error


def test_a_tilt_about_an_axis_of_what_bears_loads_is_refused(tower, capsys):
    """They do not turn with gravity."""
    data = json.loads(Path(tower).read_text())
    data["loads"] = [{"part": "cube-1", "force": [1, 0, 0]}]
    Path(tower).write_text(json.dumps(data))
    assert main(["margin", tower, "--about", "0", "1", "0"]) == 2
    out, error = capsys.readouterr()
    assert (out, error.count("\n")) == ("", 1)
    assert "'cube-1'" in error
    assert "a tilt about an axis is not defined with loads" in error


@pytest.mark.parametrize("part", ["base", "nobody"])
def test_a_load_on_a_held_or_unknown_part_is_refused(tower, capsys, part):
    data = json.loads(Path(tower).read_text())
    data["loads"] = [{"part": part, "force": [1, 0, 0]}]
    Path(tower).write_text(json.dumps(data))
    assert main(["margin", tower]) == 2
    assert part in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "friction", "moved"),
    [
        ("tower", None, "without friction the least tilt or push in some directions moves it"),
        ("paper-figure-9", None, "without friction the least push in some directions moves it"),
        ("slope-with-friction", None, None),
        pytest.param("tower", "0.3", None, marks=pytest.mark.slow),
    ],
)
def test_an_assembly_without_reserve_is_reported_with_the_option_that_helps(
    tmp_path, monkeypatch, capsys, name, friction, moved
):
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene(name), "a.json")
    typed = [] if friction is None else ["--friction", friction]
    assert main(["margin", "a.json", *typed, "--quiet"]) == 0
    text = capsys.readouterr().out
    assert ("at its limit" in text) == (moved is not None)
    if moved is not None:
        assert f"{moved}; --friction MU states the friction of its contacts" in text
        assert "next: kilter margin a.json --friction 0.3\n" in text
        assert main(["margin", "a.json", "--friction", "0", "--quiet"]) == 0
        assert "next: kilter margin a.json --friction 0.3\n" in capsys.readouterr().out


def test_a_ball_with_friction_is_at_its_limit_without_that_option(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    table = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    ball = Part("ball", Sphere(0.5), [0, 0, 0.5])
    kilter.dump(Assembly([table, ball], friction=0.5), "a.json")
    assert main(["margin", "a.json", "--quiet"]) == 0
    text = capsys.readouterr().out
    assert "at its limit  the least tilt or push in some directions moves it" in text
    assert "--friction" not in text


@pytest.mark.parametrize(
    ("name", "option", "words"),
    [
        ("slope", {}, "LeastFriction(mu >= 0.363971, above 0.36397)"),
        ("tower", {}, "LeastFriction(none is needed)"),
        ("squeezed-block", {}, "LeastFriction(any mu above 0)"),
    ],
)
def test_the_least_friction_prints_as_one_short_line(name, option, words):
    margin = kilter.margin(scene(name), pushed=[], **option)
    assert str(margin.friction_limit) == repr(margin.friction_limit) == words


def test_every_limit_prints_as_one_short_line():
    margin = kilter.margin(
        stacks.block_on_slope(0.0, friction=0.5), push=[1, 0, 0], about=[0, 1, 0], loads=True
    )
    bonded = kilter.margin(scene("mortared-corbel"), pushed=[])
    nearest = kilter.margin(scene("slope"), pushed=[]).nearest
    limits = [margin.tilt, *margin.load_limits, *margin.pushes, *margin.loads, nearest]
    limits += [margin.friction_limit, bonded.bond_limit]
    assert all(len(repr(limit)) < 60 for limit in limits)
    assert repr(margin.tilt) == "TiltMargin(26.5651 deg)"  # arctan 1/2
    assert repr(margin.load_limits[1]) == "Limit(0.5)"
    assert repr(nearest) == "NearestHeld(20 deg away)"
