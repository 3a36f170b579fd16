"""Every command reports the level of `check`: the cases in which commands contradicted each other.

Each test runs the named commands on a built-in scene of the same kind. The last tests use
assemblies of others, and are skipped without them.
"""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter import Assembly, Bond, Box, Part, Pose, Sphere
from kilter.cli import main
from kilter.scenes import SCENES, scene, stacks
from kilter.tell.text import text_of

SHARED = Path(__file__).parents[3] / "shared" / "data"
FIGURES = "paper-figure-1", "paper-figure-11", "paper-figure-12"
TWINS = [f"{name}-{twin}" for name in FIGURES for twin in ("turned", "in-space")]
"""Figures of the paper in the plane, which are stable, and in space, which are balanced."""
needs_shared = pytest.mark.skipif(
    not SHARED.exists(), reason="the assemblies of others are not here"
)


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    """Run a command on an assembly; returns the exit code and the answer as JSON data."""
    monkeypatch.chdir(tmp_path)

    def command(name: str, assembly: Assembly, *words: str) -> tuple[int, dict]:
        kilter.dump(assembly, "a.kilter.json")
        capsys.readouterr()
        code = main([name, "a.kilter.json", *words, "--json", "--quiet"])
        return code, json.loads(capsys.readouterr().out)

    return command


def sunk() -> Assembly:
    """A cube on a table that it enters by 5 cm; whether the table holds it is open."""
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    return Assembly([table, Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.45]))], friction=0.84)


def test_a_limit_states_its_level(run):
    _, margin = run("margin", scene("squeezed-block"))
    assert (margin["level"], margin["verdict"]) == ("equilibrium", "potentially-stable")
    assert "forces that hold it exist" in text_of(margin)
    _, region = run("region", scene("squeezed-block"))
    assert region["level"] == "equilibrium"
    assert "forces that hold it exist" in text_of(region)


def test_the_region_of_an_assembly_with_open_pairs_names_them(run):
    assert run("check", sunk())[0] == 4
    code, region = run("region", sunk())
    assert (code, region["kind"], region["pairs_decide"]) == (4, "none", True)
    assert region["if_joined"]["kind"] == "all"
    assert [pair["parts"] for pair in region["open_pairs"]] == [["table", "cube"]]
    assert "table" in text_of(region)


def test_the_margin_of_an_assembly_with_open_pairs_is_that_of_the_drawing(run):
    _, margin = run("margin", sunk())
    text = text_of(margin)
    assert "no friction coefficient is enough to hold it if its open pairs carry no force" in text
    assert [pair["parts"] for pair in margin["open_pairs"]] == [["table", "cube"]]


@pytest.mark.slow
def test_a_limit_beyond_which_an_open_pair_decides_has_the_verdict_of_check_outside():
    """A cube that a held pin enters: what happens beyond the friction angle depends on the pin."""
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    pin = Part("pin", Box([0.2, 0.2, 0.4]), Pose([0.5, 0.5, 0.2]), grounded=True)
    pinned = Assembly([table, pin, Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]))], friction=0.84)
    margin = kilter.margin(pinned)
    assert margin.tilt is not None
    assert margin.tilt.angle == pytest.approx(np.arctan(0.84))
    angle = margin.tilt.angle + 1e-4
    down = np.cos(angle) * pinned.down + np.sin(angle) * margin.tilt.toward
    assert margin.tilt_outside == "undecided" == kilter.check(pinned.with_down(down)).verdict
    answer = margin.to_dict()
    assert "direction of gravity at which open pairs decide" in text_of(answer)
    answer["open_pairs"] = []  # numerical errors may leave a direction undecided, too
    assert "direction of gravity that is not decided" in text_of(answer)


def listed_words(capsys: pytest.CaptureFixture[str]) -> dict[str, str]:
    """The verdict word of each example in the list that `kilter example` prints."""
    capsys.readouterr()
    assert main(["example"]) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    return {row[0]: row[1] for row in rows if row and row[0] in SCENES}


@pytest.mark.slow
@pytest.mark.parametrize("names", [TWINS, sorted(SCENES)], ids=["twins", "all"])
def test_the_list_of_examples_has_the_words_of_check(names, capsys):
    words = listed_words(capsys)
    assert {name: words[name] for name in names} == {
        name: kilter.check(scene(name)).verdict for name in names
    }
    assert [words[name] for name in TWINS] == ["stable", "balanced"] * (len(TWINS) // 2)


@pytest.mark.slow
def test_a_ball_on_a_ball_is_balanced_in_every_command(run):
    balls = Assembly(
        [
            Part("low", Sphere(1.0), grounded=True),
            Part("top", Sphere(0.5), Pose([0, 0, 1.5])),
        ]
    )
    verdict = kilter.check(balls)
    assert (verdict.verdict, verdict.stable, verdict.level) == ("balanced", False, "equilibrium")
    assert kilter.check(balls, require="equilibrium").stable
    assert kilter.check_many([balls]).verdict.tolist() == ["balanced"]
    code, answer = run("check", balls, "--proof", "p.json")
    assert (code, answer["why"], answer["first_order"]) == (3, "balanced", "stable")
    assert main(["verify", "a.kilter.json", "p.json"]) == 0
    assert run("plan", balls)[1]["finished"]["verdict"] == "balanced"
    code, oriented = run("orient", balls)
    assert (code, "balanced" in oriented["sentence"]) == (0, True)


def test_bonds_report_the_share_that_is_needed_not_that_of_one_equilibrium():
    top = Part("top", Box([1, 1, 1]), Pose([0, 0, 1]), grounded=True)
    hung = Assembly([top, Part("low", Box([1, 1, 1]))], bonds=[Bond(("low", "top"), pull=9810)])
    answer = kilter.check(hung).to_dict()
    assert answer["bonds_needed"]["share"] == pytest.approx(0.25, abs=1e-6)
    assert kilter.margin(hung).bond == pytest.approx(0.25, abs=1e-6)
    assert "0.25 times their strength is needed" in text_of(answer)


def as_drawing(assembly: Assembly) -> Assembly:
    """The assembly as if read from a CAD file, whose answer has a ladder."""
    return replace(assembly, source="drawing.step")


def test_without_friction_the_sentence_states_it_and_mu_is_a_row_of_the_ladder():
    steep, flat = scene("slope"), stacks.block_on_slope(10.0)
    assert kilter.check(steep).sentence.startswith("Unstable: without friction")
    for slope, holds in ((steep, False), (flat, True)):  # mu .3 is not enough at 20 deg
        row = kilter.check(as_drawing(slope)).ladder[-1]
        assert (row.friction, row.level is not None, row.falls) == (0.3, holds, not holds)
        assert kilter.check(slope, friction=0.3).stable == holds


def sunk_arm() -> Assembly:
    """A box 1 mm above a table, and an arm that enters a held post sideways by 1 mm."""
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    post = Part("post", Box([1, 1, 4]), Pose([3, 0, 2]), grounded=True)
    arm = Part("arm", Box([1, 1, 1]), Pose([3.999, 0, 2.5]))
    return Assembly([table, post, arm, Part("box", Box([1, 1, 1]), Pose([0, 0, 0.501]))])


def above_slope() -> Assembly:
    """A block 1 mm above a slope: it rests there with friction only."""
    *held, block = stacks.block_on_slope(10.0).parts
    lifted = np.add(block.pose.position, [0, 0, 1e-3])
    return Assembly([*held, replace(block, pose=Pose(lifted, block.pose.rotation))])


@pytest.mark.quick("sunk")
@pytest.mark.parametrize(
    "build",
    [sunk_arm, sunk, above_slope, lambda: scene("hanging-brick")],
    ids=["sunk arm", "sunk", "above slope", "brick"],
)
def test_each_row_of_a_ladder_has_the_answer_of_check_on_its_rung(build):
    drawn = as_drawing(build())
    rows = kilter.check(drawn).ladder
    assert [row.assume for row in rows[:4]] == ["drawn", "play", "fits", "joined"]
    for row in rows:
        typed = kilter.check(drawn, assume=row.assume, friction=row.friction)
        assert row.decided
        assert (row.level is None, row.falls) == (typed.level is None, len(typed.moving))
        assert row.verdict in (typed.verdict, "settles" if typed.stable else "")


@needs_shared
@pytest.mark.slow
def test_the_next_command_of_a_flange_has_the_verdict_of_its_row(capsys):
    pytest.importorskip("OCP")
    command = ["check", str(SHARED / "cad/flange_coupling.step"), "--floor", "--up", "y", "--json"]
    main(command)
    rows = {row["assume"]: row for row in json.loads(capsys.readouterr().out)["ladder"]}
    main([*command, "--assume", "fits"])
    typed = json.loads(capsys.readouterr().out)
    assert typed["verdict"] == "stable"
    assert (rows["fits"]["verdict"], rows["fits"]["level"]) == (typed["verdict"], typed["level"])
    main(["margin", *command[1:-1], "--assume", "fits", "--quiet"])
    text = capsys.readouterr().out
    assert "at its limit  without friction the least tilt" in text
    assert "--assume fits" in text
