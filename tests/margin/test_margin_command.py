"""The command `margin`, and what questions share."""

import json
from math import inf
from pathlib import Path

import numpy as np
import pytest
from margins import program_of
from staggered_dome import staggered_dome

import kilter
from kilter import Assembly, Box, Part, Pose, Sphere
from kilter.analysis.margins import margin_steps
from kilter.analysis.margins.least_friction import Failing, LeastFriction, find_least_friction
from kilter.analysis.planning.states import states as states_module
from kilter.analysis.regions import region as region_module
from kilter.cli import main
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.scenes import scene, stacks
from kilter.tell.text import text_of


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


@pytest.mark.quick(1)
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
    assert main(["margin", "a.json", "--pushes", *typed, "--quiet"]) == 0
    text = capsys.readouterr().out
    assert ("at its limit" in text) == (moved is not None)
    if moved is not None:
        assert f"{moved}; --friction MU states the friction of its contacts" in text
        assert "next: kilter margin a.json --pushes --friction 0.3\n" in text
        assert main(["margin", "a.json", "--pushes", "--friction", "0", "--quiet"]) == 0
        assert "next: kilter margin a.json --pushes --friction 0.3\n" in capsys.readouterr().out


def test_a_ball_with_friction_is_at_its_limit_without_that_option(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    table = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)
    ball = Part("ball", Sphere(0.5), [0, 0, 0.5])
    kilter.dump(Assembly([table, ball], friction=0.5), "a.json")
    assert main(["margin", "a.json", "--pushes", "--quiet"]) == 0
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


TANGENT = float(np.tan(np.radians(20.0)))
"""Least friction of a block on a slope of 20 deg."""


def sunk() -> Assembly:
    """A cube that overlaps its table by a twentieth of its size: this pair decides."""
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    return Assembly([table, Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.45]))])


@pytest.mark.parametrize("most", [1, 3])
def test_the_least_friction_of_a_short_search_lies_between_its_proofs(most):
    slope = program_of(stacks.block_on_slope(20.0))
    found = find_least_friction(slope, programs=most)
    assert isinstance(found, LeastFriction)
    assert found.lower < TANGENT <= found.value * (1 + 1e-9)
    held = slope.with_friction(found.value)
    assert check_forces(held, found.forces.forces, found.forces.friction).holds
    assert found.motion is not None
    assert check_motion(slope.with_friction(found.lower), found.motion.motion).holds
    assert found.programs == 4 + most


def test_a_known_coefficient_that_fails_is_where_the_search_begins():
    slope = program_of(stacks.block_on_slope(20.0))
    whole = find_least_friction(slope)
    assert isinstance(whole, LeastFriction)
    assert whole.motion is not None
    known = Failing(whole.lower, whole.motion)
    none = find_least_friction(slope, failing=known, programs=0)
    assert isinstance(none, LeastFriction)
    assert (none.lower, none.programs) == (whole.lower, 5)
    again = find_least_friction(slope, failing=known, programs=inf)
    assert isinstance(again, LeastFriction)
    assert again.value == pytest.approx(TANGENT, rel=1e-7)


def test_the_margin_of_a_large_drawing_that_falls_uses_the_motion_of_the_verdict(monkeypatch):
    slope = stacks.block_on_slope(20.0, friction=0.3)
    usual = kilter.margin(slope)
    monkeypatch.setattr(margin_steps, "LARGE", 0)

    def not_called(*arguments: object) -> None:
        raise AssertionError("the verdict has decided that no tilt margin exists")

    monkeypatch.setattr(margin_steps, "find_least_tilt", not_called)
    large = kilter.margin(slope)
    assert large.tilt_deg == usual.tilt_deg
    assert large.tilt_deg is not None
    assert large.friction is not None
    assert large.friction_limit.lower >= 0.3
    assert large.friction == pytest.approx(TANGENT, rel=1e-7)


def test_a_large_region_is_undecided_by_one_joined_direction(monkeypatch):
    whole = kilter.region(sunk())
    assert whole.if_joined is not None
    assert whole.pairs_decide
    monkeypatch.setattr(region_module, "LARGE", -1)
    large = kilter.region(sunk())
    assert (large.if_joined, large.joined_holds, large.pairs_decide) == (None, True, True)
    assert "forces that hold it exist for gravity as given" in text_of(large.to_dict())
    answer = kilter.orient(sunk())
    assert (answer.verdict, answer.nearest, answer.check) == ("undecided", None, None)
    assert "'table' and 'cube'" in answer.sentence
    assert "quaternion" in text_of(answer.to_dict())


def test_a_large_region_that_joined_pairs_do_not_hold_is_computed_in_full(monkeypatch):
    """Beside the sunk cube another cube falls freely, whatever is joined."""
    alone = Part("alone", Box([1, 1, 1]), Pose([0, 0, 3.0]))
    assembly = Assembly([*sunk().parts, alone])
    monkeypatch.setattr(region_module, "LARGE", -1)
    large = kilter.region(assembly)
    assert large.if_joined is not None
    assert not large.joined_holds
    assert not large.pairs_decide


def test_a_plan_asks_once_which_pairs_decide(monkeypatch):
    calls = []
    decide = states_module.decide

    def counted(*arguments: object, **options: object) -> object:
        calls.append(options["question"])
        return decide(*arguments, **options)

    monkeypatch.setattr(states_module, "decide", counted)
    order = kilter.plan(staggered_dome(2, rings=2, per_ring=8))
    assert calls == [True]
    assert order.verdict == "undecided"
    assert order.decision.question is not None
