"""Every command reports the level of `check`: the cases in which commands contradicted each other.

Each test runs the named commands on a built-in scene of the same kind. The last tests use
assemblies of others, and are skipped without them.
"""

import json
from collections.abc import Sequence
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter import Assembly, Bond, Box, Part, Pose, Sphere
from kilter.analysis.verdict import remedies
from kilter.analysis.decision.decision import Decision
from kilter.cli import main
from kilter.contact import Tolerance
from kilter.scenes import SCENES, arches, friction, scene, stacks
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


def result_is(typed: dict, remedy: dict) -> bool:
    """Whether the answer with typed options has the result that the line of a remedy states."""
    if remedy["leads_to"] is None:  # only forces of equilibrium were decided
        return typed["level"] is not None
    return typed["verdict"] == remedy["leads_to"]


def sunk() -> Assembly:
    """A cube on a table that it enters by 5 cm; whether the table holds it is open."""
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    return Assembly([table, Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.45]))], friction=0.84)


@pytest.mark.slow
def test_the_level_of_a_plan_is_at_most_that_of_the_finished_assembly(run) -> None:
    squeezed = scene("squeezed-block")
    assert run("check", squeezed)[0] == 3
    code, plan = run("plan", squeezed, "--require", "proved", "--proof", "p.json")
    assert (code, plan["level"], plan["finished"]["level"]) == (3, "equilibrium", "equilibrium")
    assert "of the finished assembly (equilibrium)" in text_of(plan)
    assert main(["verify", "a.kilter.json", "p.json"]) == 0


@pytest.mark.slow
def test_hold_finds_the_supports_that_raise_the_level(run) -> None:
    squeezed = scene("squeezed-block")
    code, fixture = run("hold", squeezed, "--require", "settles")
    assert (code, fixture["level"], len(fixture["supports"])) == (0, "proved", 1)
    code, alone = run("hold", squeezed, "--require", "equilibrium")
    assert (code, alone["level"], alone["supports"]) == (0, "equilibrium", [])


def test_a_limit_states_its_level(run) -> None:
    _, margin = run("margin", scene("squeezed-block"))
    assert (margin["level"], margin["verdict"]) == ("equilibrium", "potentially-stable")
    assert "forces that hold it exist" in text_of(margin)
    _, region = run("region", scene("squeezed-block"))
    assert region["level"] == "equilibrium"
    assert "forces that hold it exist" in text_of(region)


def test_the_region_of_an_assembly_with_open_pairs_names_them(run) -> None:
    assert run("check", sunk())[0] == 4
    code, region = run("region", sunk())
    assert (code, region["kind"], region["pairs_decide"]) == (4, "none", True)
    assert region["if_joined"]["kind"] == "all"
    assert [pair["parts"] for pair in region["open_pairs"]] == [["table", "cube"]]
    assert "table" in text_of(region)


def test_the_margin_of_an_assembly_with_open_pairs_is_that_of_the_drawing(run) -> None:
    _, margin = run("margin", sunk())
    text = text_of(margin)
    assert "no friction coefficient is enough to hold it if its open pairs carry no force" in text
    assert [pair["parts"] for pair in margin["open_pairs"]] == [["table", "cube"]]


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["slope-with-friction", "tower", "wall", "keystone"])
def test_the_word_outside_a_limit_is_the_verdict_of_check_there(name: str) -> None:
    assembly = scene(name)
    margin = kilter.margin(assembly)
    assert margin.tilt is not None
    angle = margin.tilt.angle + 1e-4
    down = np.cos(angle) * assembly.down + np.sin(angle) * margin.tilt.toward
    assert margin.tilt_outside == kilter.check(assembly.with_down(down)).first_order


@pytest.mark.slow
def test_a_limit_beyond_which_an_open_pair_decides_has_the_verdict_of_check_outside() -> None:
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


@pytest.mark.quick("twins")
@pytest.mark.parametrize("names", [TWINS, sorted(SCENES)], ids=["twins", "all"])
def test_the_list_of_examples_has_the_words_of_check(
    names: Sequence[str], capsys: pytest.CaptureFixture[str]
) -> None:
    words = listed_words(capsys)
    assert {name: words[name] for name in names} == {
        name: kilter.check(scene(name)).verdict for name in names
    }
    assert [words[name] for name in TWINS] == ["stable", "balanced"] * (len(TWINS) // 2)


def test_a_ball_on_a_ball_is_balanced_in_every_command(run) -> None:
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


@pytest.mark.slow
def test_a_cube_half_over_its_support_is_balanced_in_every_command(run) -> None:
    table = Part("table", Box([1, 1, 1]), Pose([0, 0, -0.5]), grounded=True)
    half = Assembly([table, Part("cube", Box([1, 1, 1]), Pose([0.5, 0, 0.5]))])
    inside = Assembly([table, Part("cube", Box([1, 1, 1]), Pose([0.4, 0, 0.5]))])
    for assembly, word in ((half, "balanced"), (inside, "stable")):
        assert kilter.check(assembly).verdict == word
        assert kilter.check_many([assembly, half, inside]).verdict.tolist() == [
            word,
            "balanced",
            "stable",
        ]
        assert run("plan", assembly)[1]["finished"]["verdict"] == word


@pytest.mark.slow
def test_the_page_and_the_notebook_of_a_balanced_assembly_have_its_word_and_sentence() -> None:
    balls = scene("paper-figure-1-in-space")
    verdict = kilter.check(balls)
    assert verdict.verdict == "balanced"
    page, cell = kilter.report(balls).html, unescape(verdict._repr_html_())
    assert verdict.sentence in cell
    assert verdict.sentence.split(":")[0].rstrip(".") in unescape(page)
    assert '"verdict":"balanced"' in page.replace('": "', '":"')


@pytest.mark.slow
def test_a_wedge_between_walls_keeps_its_level_in_plan_and_hold(run) -> None:
    squeezed = scene("squeezed-block")
    check = run("check", squeezed)
    code, plan = run("plan", squeezed)
    assert (check[0], check[1]["level"], code) == (3, "equilibrium", 0)  # plan asks equilibrium
    assert plan["level"] == plan["finished"]["level"] == "equilibrium"
    code, hold = run("hold", squeezed)
    assert hold["level"] != "equilibrium" or code == 3


def test_bonds_report_the_share_that_is_needed_not_that_of_one_equilibrium() -> None:
    top = Part("top", Box([1, 1, 1]), Pose([0, 0, 1]), grounded=True)
    hung = Assembly([top, Part("low", Box([1, 1, 1]))], bonds=[Bond(("low", "top"), pull=9810)])
    answer = kilter.check(hung).to_dict()
    assert answer["bonds_needed"]["share"] == pytest.approx(0.25, abs=1e-6)
    assert kilter.margin(hung).bond == pytest.approx(0.25, abs=1e-6)
    assert "0.25 times their strength is needed" in text_of(answer)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mortared-corbel", "eccentric-pier", "pier-in-wind"])
def test_the_bonds_of_a_scene_need_the_share_of_their_margin(name: str) -> None:
    share = kilter.check(scene(name)).to_dict()["bonds_needed"]["share"]
    assert 0 < share < 1
    assert share == pytest.approx(kilter.margin(scene(name)).bond, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("count", [100, 300])
def test_every_loose_try_of_an_arch_is_finished_or_reported_as_not_run(count: int) -> None:
    answer = kilter.check(arches.arch(count)).to_dict()
    text = text_of(answer)
    assert "0 of 8" not in text
    finished = answer["verdict"] in ("settles", "stable")
    assert finished or "not tried for lack of effort: --effort" in text


@pytest.mark.slow
def test_the_size_of_an_arch_does_not_decide_its_level_without_a_word() -> None:
    answer = kilter.check(arches.arch(1000), effort=0).to_dict()
    text = text_of(answer)
    assert "0 of 8" not in text
    finished = answer["verdict"] == "settles"
    assert finished or "not tried for lack of effort: --effort" in text


@pytest.mark.slow
def test_the_plan_of_an_assembly_that_falls_is_an_answer(run) -> None:
    code, plan = run("plan", scene("paper-figure-8"), "--proof", "p.json")
    assert (code, plan["found"], plan["impossible"]["kind"]) == (1, False, "falls")
    assert main(["verify", "a.kilter.json", "p.json"]) == 0


@pytest.mark.slow
def test_a_proof_for_bounded_forces_states_both_facts_in_one_sentence() -> None:
    tilted = friction.v_block(friction=0.84).with_down([0, 0.3, -1])
    verdict = kilter.check(tilted)
    assert verdict.sentence == (
        "Stable: with this friction no motion can start, whatever the initial contact forces are "
        "(contact forces up to 1000 times the weight)."
    )


def test_without_friction_the_sentence_states_it_and_mu_is_a_remedy() -> None:
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
        verdict.assembly, verdict.contacts, decision, require=require, work=Work(1e6)
    )
    return levels, [(remedy.leads_to, remedy.level) for remedy in found], sum(totals)


@pytest.mark.parametrize(("charge", "tries"), [(10.0, 3), (30e3, 2), (80e3, 1)])
def test_a_cheap_verdict_pays_only_for_equilibrium_forces(
    monkeypatch: pytest.MonkeyPatch, charge: float, tries: int
) -> None:
    levels, found, units = tried(monkeypatch, charge, 1e3, "settles")
    assert levels == ["equilibrium"] * tries
    assert found == [(None, "equilibrium")] * tries
    assert units <= remedies.LEAST_WORK


def test_a_costly_verdict_pays_for_the_required_level(monkeypatch: pytest.MonkeyPatch) -> None:
    levels, found, units = tried(monkeypatch, 0.0, 2e6, "settles")
    assert levels == [*["equilibrium"] * 3, "settles"]
    assert found == [("stable", "proved")]  # a larger change is not offered
    assert units <= 2e6


@pytest.mark.parametrize("ball", [False, True])
def test_a_remedy_that_holds_without_friction_has_the_verdict_of_check_whatever_its_work(
    monkeypatch: pytest.MonkeyPatch, ball: bool
) -> None:
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
def test_the_remedy_of_a_flange_has_the_verdict_of_its_own_check(
    capsys: pytest.CaptureFixture[str],
) -> None:
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


def test_a_guarantee_that_lacks_work_is_not_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    levels, found, _ = tried(monkeypatch, 0.3e6, 1.8e6, "settles")
    assert levels == [*["equilibrium"] * 3, *["settles"] * 3]
    assert found == [(None, "equilibrium")] * 3


def test_forces_decide_a_remedy_if_equilibrium_is_required(monkeypatch: pytest.MonkeyPatch) -> None:
    levels, found, _ = tried(monkeypatch, 0.0, 1e3, "equilibrium")
    assert levels == ["equilibrium"] * 3
    assert found == [("potentially-stable", "equilibrium")] * 3


@pytest.mark.quick("slot")
@pytest.mark.parametrize("name", ["slot", "paper-figure-4", "wall-with-opening", "hanging-brick"])
def test_the_remedies_of_a_scene_cost_no_more_work_than_its_verdict_or_the_least(
    monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
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


@needs_shared
@pytest.mark.slow
def test_the_vault_of_others_is_undecided_in_every_command(run) -> None:
    vault = kilter.load(SHARED / "compas_assembly" / "crossvault.json", friction=0.84)
    code, answer = run("check", vault)
    assert (code, answer["verdict"]) == (4, "undecided")
    for name in ("region", "orient"):
        code, _ = run(name, vault, "--time-limit", "5")
        assert code == 4


@pytest.mark.slow
@needs_shared
@pytest.mark.parametrize("name", ["H.json"])
def test_a_squeezed_block_of_others_keeps_its_level_in_a_plan(run, name: str) -> None:
    held = kilter.load(SHARED / "compas_cra" / name, friction=0.84, ground=["0", "1"])
    check, plan = run("check", held), run("plan", held, "--require", "proved")
    assert (check[0], plan[0]) == (3, 3)
    assert plan[1]["finished"]["level"] == check[1]["level"] == plan[1]["level"]


@pytest.mark.slow
@needs_shared
@pytest.mark.parametrize(("name", "proved"), [("iris_box", 1), ("one_plate", 2)])
def test_the_parts_that_the_proof_moves_are_listed_first(run, name: str, proved: int) -> None:
    pytest.importorskip("OCP")
    plates = kilter.load(SHARED / "cad" / f"{name}.step", floor=True)
    code, answer = run("check", plates)
    moved = [part["name"] for part in answer["parts"] if part["moved_by_proof"]]
    assert (code, len(moved)) == (1, proved)
    which = "the first moves" if proved == 1 else f"the first {proved} move"
    heading = f"it is proved that {which} in any case:\n"
    rows = text_of(answer).split(heading)[1].split("\n")
    listed = [row.split("  ")[1] for row in rows[:proved]]
    assert sorted(listed) == sorted(moved)


@needs_shared
@pytest.mark.slow
def test_a_heatsink_of_others_falls_without_friction_and_its_remedy_is_typed(run) -> None:
    pytest.importorskip("OCP")
    sink = kilter.load(SHARED / "cad" / "heatsink_2024.step", floor=True)
    code, answer = run("check", sink)
    assert code == 1
    assert "without friction" in answer["sentence"]
    assert answer["remedies"]
    for remedy in answer["remedies"]:
        typed = run("check", sink, *remedy["option"].split())[1]
        assert result_is(typed, remedy)


@needs_shared
@pytest.mark.parametrize("mu", [0.0, 0.84])
@pytest.mark.parametrize(
    ("name", "held"), [("type-a.json", ["0", "1"]), ("shelf-stable.json", ["0"])]
)
@pytest.mark.slow
def test_plan_and_hold_of_others_have_the_level_of_check(
    run, name: str, held: list[str], mu: float
) -> None:
    assembly = kilter.load(SHARED / "compas_cra" / name, friction=mu, ground=held)
    check, plan = run("check", assembly)[1], run("plan", assembly, "--require", "settles")[1]
    assert plan["finished"]["level"] == check["level"]
    assert plan["finished"]["verdict"] == check["verdict"]
    code, hold = run("hold", assembly, "--require", "settles")
    if code == 0 and not hold["supports"]:
        assert check["level"] in ("settles", "proved")


@pytest.mark.slow
@needs_shared
def test_the_bonds_of_external_weight_good() -> None:
    model = kilter.load(SHARED / "stablelego" / "external_weight_good.json")
    share = kilter.check(model).to_dict()["bonds_needed"]["share"]
    assert share == pytest.approx(kilter.margin(model).bond, rel=1e-6)
    assert share == pytest.approx(0.6413, abs=1e-4)


@needs_shared
@pytest.mark.slow
def test_the_bricks_of_others_need_the_share_of_their_margin() -> None:
    model = kilter.load(SHARED / "brickgpt" / "chair.txt")
    share = kilter.check(model).to_dict()["bonds_needed"]["share"]
    assert share == pytest.approx(kilter.margin(model).bond, rel=1e-6)


@needs_shared
@pytest.mark.slow
def test_a_printed_remedy_of_a_flange_has_the_result_that_it_states(run) -> None:
    pytest.importorskip("OCP")
    flange = kilter.load(SHARED / "cad" / "flange_coupling.step", floor=True, up="y")
    _, answer = run("check", flange)
    assert answer["remedies"]
    for remedy in answer["remedies"]:
        assert result_is(run("check", flange, *remedy["option"].split())[1], remedy)
