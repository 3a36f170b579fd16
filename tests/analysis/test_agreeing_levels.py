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
from kilter.analysis.decision.cascade import Decision
from kilter.analysis.verdict import remedies
from kilter.cli import main
from kilter.contact import Tolerance
from kilter.scenes import SCENES, scene, stacks
from kilter.tell.text import text_of
from kilter.work import Work

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


def test_without_friction_the_sentence_states_it_and_mu_is_a_remedy():
    slope = scene("slope")
    verdict = kilter.check(slope)
    assert verdict.sentence.startswith("Unstable: without friction")
    assert verdict.remedies == ()  # mu .3 is not enough at 20 deg
    (remedy,) = kilter.check(stacks.block_on_slope(10.0)).remedies
    rough = kilter.check(stacks.block_on_slope(10.0, friction=0.3), require="equilibrium")
    assert (remedy.option, remedy.leads_to) == ("--friction 0.3", None)
    assert remedy.level == rough.level == "equilibrium"


def tried(
    monkeypatch: pytest.MonkeyPatch, charge: float, verdict_units: float, require: str
) -> tuple[list[str], list[tuple[str | None, str | None]], float]:
    """Levels of the tries of four friction coefficients, their results, and their work [units].

    Each try charges `charge` units to the tries of a verdict of `verdict_units` units.
    """
    levels: list[str] = []
    totals: list[float] = []
    decide = remedies.decide

    def charged(*arguments, require: str, work: Work, **options) -> Decision:
        levels.append(require)
        work.charge(charge)
        decision = decide(*arguments, require=require, work=work, **options)
        totals.append(work.total)
        return replace(decision, units=work.total)

    monkeypatch.setattr(remedies, "decide", charged)
    changes = [remedies._Change(friction=mu) for mu in (0.21, 0.22, 0.23, 0.24)]
    monkeypatch.setattr(remedies, "_changes", lambda *_: iter(changes))
    verdict = kilter.check(stacks.block_on_slope(10.0))
    decision = replace(verdict.decision, units=verdict_units)
    found = remedies.find_remedies(
        verdict.assembly, verdict.contact_set, decision, require=require, work=Work(1e6)
    )
    return levels, [(remedy.leads_to, remedy.level) for remedy in found], sum(totals)


@pytest.mark.parametrize(("charge", "tries"), [(10.0, 3), (30e3, 2), (80e3, 1)])
def test_a_cheap_verdict_pays_only_for_equilibrium_forces(monkeypatch, charge, tries):
    levels, found, units = tried(monkeypatch, charge, 1e3, "settles")
    assert levels == ["equilibrium"] * tries
    assert found == [(None, "equilibrium")] * tries
    assert units <= remedies.LEAST_WORK


def test_a_costly_verdict_pays_for_the_required_level(monkeypatch):
    levels, found, units = tried(monkeypatch, 0.0, 2e6, "settles")
    assert levels == [*["equilibrium"] * 3, "settles"]
    assert found == [("stable", "proved")]  # a larger change is not offered
    assert units <= 2e6


@pytest.mark.quick(1)
@pytest.mark.parametrize("ball", [False, True])
def test_a_remedy_that_holds_without_friction_has_the_verdict_of_check_whatever_its_work(
    monkeypatch, ball
):
    """A box on a held box is stable, a ball on a held ball balanced; each floats by 1e-3."""
    shapes = (Sphere(1.0), Sphere(0.5)) if ball else (Box(2, 2, 2), Box(1, 1, 1))
    parts = [Part("base", shapes[0], grounded=True), Part("top", shapes[1], [0, 0, 1.501])]
    monkeypatch.setattr(remedies, "_changes", lambda *_: iter([remedies._Change(gap=1.01e-3)]))
    monkeypatch.setattr(remedies, "LEAST_WORK", 50_000.0)
    decide, spent = remedies.decide, []

    def costly(*arguments, work: Work, **options) -> Decision:
        decision = decide(*arguments, work=work, **options)
        spent.append(decision.units)
        return replace(decision, units=1e9)

    monkeypatch.setattr(remedies, "decide", costly)
    floating = Assembly(parts)
    remedy = kilter.check(floating).remedies[0]
    typed = kilter.check(floating, tolerance=Tolerance(gap=1.01e-3))
    assert len(spent) == 1
    assert typed.verdict == ("balanced" if ball else "stable")
    assert (remedy.option, remedy.leads_to, remedy.level) == (
        "--gap 0.00101", typed.verdict, typed.level,
    )  # fmt: skip


@needs_shared
@pytest.mark.slow
def test_the_remedy_of_a_flange_has_the_verdict_of_its_own_check(capsys):
    pytest.importorskip("OCP")
    command = ["check", str(SHARED / "cad/flange_coupling.step"), "--floor", "--up", "y", "--json"]
    main(command)
    (remedy,) = json.loads(capsys.readouterr().out)["remedies"]
    assert remedy["option"] == "--fasten-suggested"
    main([*command, remedy["option"]])
    typed = json.loads(capsys.readouterr().out)
    assert typed["verdict"] == "stable"
    assert (remedy["leads_to"], remedy["level"]) == (typed["verdict"], typed["level"])
    main(["margin", *command[1:-1], remedy["option"], "--quiet"])
    text = capsys.readouterr().out
    assert "at its limit  without friction the least tilt or push" in text
    assert f"--floor {remedy['option']} --up y --friction 0.3\n" in text


def test_a_guarantee_that_lacks_work_is_not_reported(monkeypatch):
    levels, found, _ = tried(monkeypatch, 0.3e6, 1.8e6, "settles")
    assert levels == [*["equilibrium"] * 3, *["settles"] * 3]
    assert found == [(None, "equilibrium")] * 3


@pytest.mark.quick("slot")
@pytest.mark.parametrize("name", ["slot", "paper-figure-4", "wall-with-opening", "hanging-brick"])
def test_the_remedies_of_a_scene_cost_no_more_work_than_its_verdict_or_the_least(monkeypatch, name):
    decide, totals = remedies.decide, []

    def counted(*arguments, work: Work, **options) -> Decision:
        decision = decide(*arguments, work=work, **options)
        totals.append(work.total)
        return decision

    monkeypatch.setattr(remedies, "decide", counted)
    verdict = kilter.check(scene(name))
    assert verdict.remedies is not None
    assert totals
    assert 0 < sum(totals) <= max(verdict.decision.units, remedies.LEAST_WORK)
