"""Words for users: one answer in every voice, manners, sentences read once, hostile names."""

import csv
import html
import io
import json
import re
from pathlib import Path
from typing import Any

import pytest

import kilter
import kilter.analysis.everything as module
from kilter import Box, Cylinder, Part, Pose, Sphere
from kilter.assembly import Assembly
from kilter.cli import main
from kilter.cli.commands import COMMANDS, functions_of
from kilter.cli.declarations import Declared, declared_of
from kilter.cli.option_parser import with_values
from kilter.cli.overview import GROUPS, overview
from kilter.errors import InputError, shell_words
from kilter.scenes import scene
from kilter.tell.check_facts import forces_phrase
from kilter.tell.csv_cells import RUNS, is_numeric, name_of_cell, safe_cell
from kilter.tell.facts import facts
from kilter.tell.html import html_of
from kilter.tell.place_words import packing_sentence
from kilter.tell.plan_words import hold_facts
from kilter.tell.region_facts import region_phrase
from kilter.tell.scene_words import scene_sentence
from kilter.tell.tables import moving_table
from kilter.tell.text import text_of
from kilter.tell.transport_facts import transport_sentence
from kilter.tell.words import SENTENCES, verdict_sentence
from kilter.values.guesses import MEANT, WORDS, meant_word


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["tower", "paper-figure-8", "slope-with-friction", "wall-with-lintel"]
)
def test_page_notebook_and_terminal_tell_the_same_facts(name, monkeypatch):
    monkeypatch.setattr(module, "MAP_PARTS", 0)  # its programs take most of the time
    assembly = scene(name)
    verdict = kilter.check(assembly, effort=0)
    answer = verdict.to_dict()
    told = [(term, words) for term, words in facts(answer) if term != "seconds"]
    page = kilter.report(assembly, effort=0).html
    on_page = [(html.unescape(a), html.unescape(b)) for a, b in terms(page)]
    shown = html.unescape(verdict._repr_html_())
    text = text_of(answer)
    listed = [one for one in told if one[0] != "level"]  # that is said above, in the banner
    assert [one for one in on_page if one in told] == listed
    if "level" in dict(told):
        assert f'"level":{json.dumps(dict(told)["level"])}' in page
    assert html.escape(verdict.sentence) in page
    for term, words in told:
        assert words in text, term
        assert words in shown, term
    assert verdict.sentence in text
    assert verdict.sentence in shown


def terms(page: str) -> list[tuple[str, str]]:
    """The terms of the list of a page that says what a verdict rests on."""
    lists = [part.partition("</dl>")[0] for part in page.split("<dl>")[1:]]
    [one] = [part for part in lists if "<dt>parts</dt>" in part]
    return re.findall(r"<dt>(.*?)</dt><dd>(.*?)</dd>", one)


@pytest.mark.slow
def test_the_greatest_force_is_one_number_everywhere(tmp_path, monkeypatch):
    arch = scene("arch")
    verdict = kilter.check(arch, effort=0)
    phrase = forces_phrase(verdict.to_dict()["forces"])
    assert phrase is not None
    number = re.match(r"up to ([\d.]+ kN) ", phrase)
    assert number is not None
    monkeypatch.setattr(module, "MAP_PARTS", 0)
    assert f'"force_words":"{phrase}"' in kilter.report(arch, effort=0).html
    pytest.importorskip("matplotlib")
    kilter.draw(verdict, tmp_path / "arch.svg")
    assert f"largest {number[1]}" in (tmp_path / "arch.svg").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_page_orients_as_orient_does_with_friction(monkeypatch):
    block = scene("slope-with-friction")
    answer = kilter.orient(block)
    monkeypatch.setattr(module, "MAP_PARTS", 0)
    page = html.unescape(kilter.report(block, effort=0).html)
    assert answer.sentence in page
    region = kilter.region(block).to_dict()
    assert region["friction"]
    words = region_phrase(region["kind"], region["half_angle_deg"], friction=True)
    assert f"<dt>stable directions</dt><dd>{words}</dd>" in page


def test_what_was_not_measured_is_not_told():
    shown = kilter.check(scene("trough"), effort=0)
    assert shown.to_dict()["instability"] is None
    assert "kappa" not in shown._repr_html_()


def test_names_are_harmless_in_every_voice():
    part = kilter.Part("<b>\x1b[31m\n", kilter.Box([1, 1, 1]), grounded=True)
    answer = kilter.check(Assembly([part])).to_dict()
    assert "\x1b" not in text_of(answer)
    assert "<b>" not in html_of(answer)
    assert "\x1b" not in html_of(answer)


def test_a_program_that_calls_main_keeps_its_warnings(capsys):
    import warnings

    before = list(warnings.filters)
    assert main(["--version"]) == 0
    assert warnings.filters == before


ROOT = Path(__file__).resolve().parents[2]
TABLE = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_headlines_name_no_paper():
    assert not [words for words in SENTENCES.values() if "paper" in words or "order" in words]
    verdict = kilter.check(kilter.example("paper-figure-9"))
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.state == "free"  # the blocks can circulate
    assert verdict.sentence == "Stable: it cannot start to move, even without friction."


READ_TWICE = (
    "at a lower level than required", "Stable within the accuracy", "beyond the accuracy of its",
    "whatever the open pairs do", "With its certain contacts", "computed without the open pairs",
    "another set may also be enough", "without forces at its open pairs, it holds",
    "has the level equilibrium", "can move freely without any change",
)  # fmt: skip


def test_no_sentence_has_the_words_that_were_read_twice():
    written = " ".join(
        " ".join(re.sub(r'"\s*f?"', "", path.read_text("utf-8")).split())
        for path in (ROOT / "src/kilter/tell").glob("*.py")
    )
    assert "as drawn it falls" in written
    assert not [words for words in READ_TWICE if words in written]


@pytest.mark.parametrize(
    ("verdict", "begins"),
    [
        ("stable", "Stable, up to the accuracy of its coordinates: it cannot"),
        ("unstable", "Unstable, by more than the accuracy of its coordinates: no contact"),
    ],
)
def test_the_accuracy_of_coordinates_follows_the_verdict(verdict, begins):
    assert verdict_sentence(verdict, coarse=True).startswith(begins)


@pytest.mark.parametrize(("mu", "phrase"), [(0.0, "without friction no"), (1.0, "no contact")])
def test_without_friction_is_said_only_of_files_without_friction(mu, phrase):
    hanging = Assembly([TABLE, Part("box", Box(1, 1, 1), [0, 0, 3])], friction=mu)
    assert kilter.check(hanging).sentence.startswith(f"Unstable: {phrase}")


def objects(*states: str, level: str | None = None) -> dict[str, Any]:
    entries = [{"state": state, "level": level} for state in states]
    return {"objects": entries, "require": "settles", "level": level}


@pytest.mark.parametrize(
    ("answer", "sentence"),
    [
        (objects("floats"), "The free object floats."),
        (objects("falls", "held"), "The free object falls."),
        (objects("open"), "The free object is open."),
        (objects("floats", "falls"), "0 of 2 free objects are at rest: 1 floats, 1 falls."),
        (
            objects("at-rest", "at-rest", level="equilibrium"),
            "All 2 free objects are at rest, but 2 do not reach the required level settles.",
        ),
    ],
)
def test_a_single_object_is_not_counted(answer, sentence):
    assert scene_sentence(answer) == sentence


def test_a_pile_at_a_lower_level_names_the_required_one():
    item = {"name": "crate", "verdict": "potentially-stable", "level": "equilibrium"}
    answer = {"first": None, "stands": False, "items": [item], "require": "settles"}
    assert packing_sentence(answer) == (
        "After item 1, 'crate', the pile stands only at the level equilibrium; the level settles "
        "is required."
    )


def test_the_reason_why_no_support_helps_is_a_motion_that_none_stops():
    motions = [
        {"moving": ["beam"], "stopped_by": ["prop-1"]},
        {"moving": ["lamp"], "stopped_by": []},
    ]
    answer = {
        "verdict": "impossible", "level": None, "base": ["floor"], "motions": motions,
        "straps": None, "cases": [], "judged": 2, "candidates": 2,
    }  # fmt: skip
    reasons = [words for term, words in hold_facts(answer) if term == "because"]
    assert reasons == ["'lamp' would move; stopped by no candidate"]
    assert len(hold_facts({**answer, "verdict": "held"})) == len(hold_facts(answer)) + 1


def test_a_table_without_a_row_is_not_printed():
    """A ball on a ball: balanced, and nothing starts by itself."""
    below = Part("below", Sphere(1), [0, 0, 1], grounded=True)
    answer = dict(kilter.check(Assembly([below, Part("ball", Sphere(0.5), [0, 0, 2.5])])).to_dict())
    assert answer["verdict"] == "balanced"
    assert not any(part["moves"] or part["slow_motion"] for part in answer["parts"])
    assert moving_table(answer) is None
    assert "the fastest" not in text_of(answer)


@pytest.mark.parametrize(
    ("pairs", "why"), [([], "a limit of the work was reached"), ([{}], "open pairs decide it")]
)
def test_open_pairs_are_blamed_only_if_there_are_any(pairs, why):
    case = {"verdict": "undecided", "level": None, "factor": None, "motion": ""}
    answer = {
        "cases": [case], "code": "", "carried": None, "open_pairs": pairs,
    }  # fmt: skip
    assert transport_sentence(answer) == f"Undecided for this acceleration: {why}."


def test_held_parts_that_touch_each_other_are_no_warning(say):
    box = Part("box", Box(1, 1, 1), [0, 0, 0.5])
    kilter.dump(Assembly([TABLE, box]), "a.kilter.json")
    assert say("check a.kilter.json --floor")[2] == ""
    apart = Part("sign", Box(1, 1, 1), [9, 0, 0.5], grounded=True)
    kilter.dump(Assembly([TABLE, box, apart]), "b.kilter.json")
    assert "is held, but touches nothing: 'sign'" in say("check b.kilter.json")[2]


@pytest.mark.parametrize(
    ("heights", "step"),
    [([0.5, 3], "scene a.kilter.json --settle"), ([3, 4], "scene a.kilter.json --settle"),
     ([0.5, 1.5], "hold a.kilter.json")],
    ids=["one floats", "a group floats", "one falls"],
)  # fmt: skip
def test_the_step_after_a_scene_that_floats_moves_it_to_rest(heights, step, say):
    boxes = [Part(f"b{k}", Box(1, 1, 1), [0.6 * k, 0, z]) for k, z in enumerate(heights)]
    kilter.dump(Assembly([TABLE, *boxes]), "a.kilter.json")
    code, out, _ = say("check a.kilter.json")
    assert code == 1
    assert f"next: kilter {step}\n" in out


def test_a_plan_that_is_written_as_a_page_prints_its_sentence(say):
    kilter.dump(kilter.example("arch").without("voussoir-1?"), "a.kilter.json")
    sentence = kilter.plan("a.kilter.json", floor=True).sentence
    _, out, error = say("plan a.kilter.json --floor -o x.html --quiet")
    assert (out, error) == ("", "")
    _, _, error = say("plan a.kilter.json --floor -o x.html")
    assert " ".join(sentence.split()) in " ".join(error.split())


def test_a_layer_over_another_file_than_usd_is_refused(say):
    kilter.dump(Assembly([TABLE, Part("box", Box(1, 1, 1), [0, 0, 0.501])]), "a.kilter.json")
    code, out, error = say("settle a.kilter.json -o rest.usda")
    assert (code, out) == (2, "")
    assert "a USD layer moves the objects of a USD file" in error
    assert "export it anew" not in error
    assert not Path("rest.usda").exists()


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "exact"), [(Box(2, 2, 4), True), (Cylinder(1, 4), False)])
def test_a_push_over_a_round_edge_is_not_called_exact(shape, exact):
    """The tower tips at atan(1 / 2), over a circle, too. A push counts it as a polygon inside."""
    import math

    tower = Assembly([TABLE, Part("tower", shape, [0, 0, 2])], friction=2)
    margin = kilter.margin(tower, pushes=True)
    tips = math.degrees(math.atan(1 / 2))
    assert margin.exact is exact is margin.to_dict()["exact"]
    assert kilter.margin(tower).exact
    assert margin.tilt_deg == pytest.approx(tips, abs=1e-6)


def test_a_packing_list_is_a_file_of_every_command(say):
    Path("list.csv").write_text(
        "name,length,width,height,mass,x,y,z\na,1,1,1,5,0,0,0\nb,1,1,1,5,0,0,1\n", "utf-8"
    )
    answer = json.loads(say("check list.csv --floor --json")[1])
    assert [part["name"] for part in answer["parts"]][:2] == ["a", "b"]
    shown = say("check --help")[1].replace("│", " ")
    assert "a packing list (CSV)" in " ".join(shown.split())


def test_the_readme_counts_the_blocks_of_its_first_command():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    example = kilter.load(ROOT / "examples/paper-figure-9.kilter.json")
    words = {2: "two", 3: "three", 4: "four", 5: "five"}
    free = sum(not part.grounded for part in example)
    assert re.search(rf"checks an example of {words[free]} free blocks", readme)


@pytest.mark.slow
def test_a_stack_that_a_simulator_sank_is_not_proposed_to_be_joined(say):
    """It topples: the upper cube hangs over the lower one by more than half of its width."""
    cube = Box(0.1, 0.1, 0.1)
    low, high = Part("low", cube, [0, 0, 0.0497]), Part("high", cube, [0.06, 0, 0.1492])
    table = Part("table", Box(1, 1, 0.1), [0, 0, -0.05], grounded=True)
    stack = Assembly([table, low, high], friction=0.5)
    kilter.dump(stack, "sunk.kilter.json")
    code, out, _ = say("check sunk.kilter.json")
    assert code == 4
    assert "next: kilter check sunk.kilter.json --assume play\n" in out
    assert "--fasten" not in out
    code, out, _ = say("check sunk.kilter.json --assume play")
    assert (code, out.split()[0]) == (1, "Unstable")
    assert "1 of 2 free parts move:\n  high  tips" in out


def options_of(command: str) -> dict[str, Declared]:
    """The options of a command, by each of their names."""
    [function] = functions_of(command)
    return {name: each for each in declared_of(function) for name in each.declaration.names}


def test_help_fits_a_screen_and_has_every_command_in_a_group():
    lines = overview().splitlines()
    assert len(lines) <= 24
    assert max(map(len, lines)) <= 80
    assert [line.split()[0] for line in lines if line[:1].strip() and "  " in line] == list(GROUPS)
    listed = [line[7:].split()[0] for line in lines[1:]]
    assert listed == list(COMMANDS)


@pytest.mark.parametrize("words", [[], ["--help"], ["-h"]])
def test_help_is_the_overview(words, capsys):
    assert main(words) == 0
    assert capsys.readouterr().out.strip() == overview().strip()


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        ("--mu", "--friction"),
        ("--held", "--ground"),
        ("--fixed", "--ground"),
        ("--hold", "--ground"),
        ("--gravity", "--down"),
        ("--exclude", "--without"),
        ("--timeout", "--time-limit"),
        ("--join", "--fasten"),
    ],
)
def test_a_guessed_option_names_the_option_that_it_means(typed, meant, capsys):
    assert main(["check", "a.json", typed, "x"]) == 2
    message = f"kilter: there is no option {typed}: use {meant}; see 'kilter check --help'\n"
    assert capsys.readouterr().err == message


def test_each_guess_means_an_option_that_exists_and_none_is_an_option_of_a_command():
    params = {name: set(options_of(name)) for name in COMMANDS}
    everywhere = set().union(*params.values())
    assert {f"--{name}" for name in WORDS} <= everywhere
    assert len(MEANT) == sum(map(len, WORDS.values()))
    assert meant_word("--hold", params["plan"]) is None or "--hold" in params["plan"]
    # a command suggests only options that it has
    assert meant_word("--mu", params["verify"]) is None


def test_several_names_after_one_option(capsys):
    kilter.dump(kilter.example("tower"), "tower.kilter.json")
    Path("cube-2").mkdir()
    for words in (
        ["tower.kilter.json", "--ground", "cube-1", "cube-3", "--json"],
        ["--json", "--ground", "cube-1", "cube-3", "tower.kilter.json"],
        ["--json", "--ground", "cube-1", "--ground", "cube-3", "tower.kilter.json"],
        ["--json", "--ground=cube-1", "--ground", "cube-3", "--", "tower.kilter.json"],
    ):
        assert main(["check", *words]) == 0
        answer = json.loads(capsys.readouterr().out)
        held = [part["name"] for part in answer["parts"] if part["grounded"]]
        assert held == ["base", "cube-1", "cube-3"]
    assert main(["check", "tower.kilter.json", "--without", "cube-5", "cube-4", "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["parts"]) == 4


def test_names_that_begin_like_numbers_and_a_name_that_is_missing(capsys):
    options = options_of("check")
    words = ["a.json", "--ground", "0", "1", "--floor", "--json"]
    apart = ["a.json", "--ground=0", "--ground=1", "--floor=lowest", "--json"]
    assert with_values(words, options) == apart
    assert with_values(["--ground"], options) == ["--ground"]
    assert main(["check", "a.json", "--ground"]) == 2
    assert "--ground needs NAME..." in capsys.readouterr().err


def test_a_written_answer_is_reported_with_its_path(capsys):
    kilter.dump(kilter.example("tower"), "tower.kilter.json")
    for words, content in (
        (["check", "--json"], "answer of check as JSON"),
        (["orient", "--json"], "answer of orient as JSON"),
        (["contacts"], "answer of contacts as text"),
    ):
        capsys.readouterr()
        main([words[0], "tower.kilter.json", *words[1:], "-o", "answer"])
        printed = capsys.readouterr()
        assert printed.out == ""
        assert printed.err == f"answer: {content}\n"
        main([words[0], "tower.kilter.json", *words[1:], "-o", "answer", "--quiet"])
        assert capsys.readouterr().err == ""


@pytest.mark.parametrize("command", ["check", "check tower.kilter.json", "contacts"])
def test_a_file_that_ends_like_json_gets_json(command, capsys):
    kilter.dump(kilter.example("tower"), "tower.kilter.json")
    name, *more = command.split()
    main([name, *more, "tower.kilter.json", "-o", "x.json"])
    assert capsys.readouterr().out == ""
    assert json.loads(Path("x.json").read_text(encoding="utf-8"))


def test_an_example_prints_the_answer_of_check(capsys):
    assert main(["example", "paper-figure-8"]) == 0
    path, sentence, step = capsys.readouterr().out.splitlines()
    assert path.startswith("paper-figure-8.kilter.json: ")
    assert sentence == kilter.check(kilter.load("paper-figure-8.kilter.json")).sentence
    assert step == "next: kilter check paper-figure-8.kilter.json"


def test_each_command_requires_one_level_or_states_the_reason():
    for name in COMMANDS:
        option = options_of(name).get("--require")
        if option is not None and option.default != "settles":
            assert "Other commands require settles" in option.declaration.help, name
            assert "because" in option.declaration.help


LONG = "n" * 70_000
NAMES = {
    "escape": "a\x1b[8mhidden\x1b]0;title\x07",
    "direction": "a\u202eb\u2066",
    "lines": "a\r\nb\tc\x00",
    "long": LONG,
    "formula": '=HYPERLINK("http://x")',
    "sum": "@SUM(A1)",
    "minus": "-2+cmd|' /C calc'!A0",
}
WIDEST = 1000
"""Largest width of a line with several names of 400 characters."""
WORDS_NAMES = [
    ["check"], ["check", "--verbose"], ["check", "--ground", "gone"], ["contacts", "--verbose"],
    ["hold"], ["plan"], ["orient"], ["margin"], ["region"], ["scene"], ["settle"], ["transport"],
    ["check", "--fasten", "a", "gone"], ["check", "--suggest-joints"],
]  # fmt: skip


def pile(name: str) -> Assembly:
    """A block on a block, and a block that falls."""
    return Assembly(
        [
            Part(f"{name}1", Box([1, 1, 1]), Pose([0, 0, 0.5]), grounded=True),
            Part(f"{name}2", Box([1, 1, 1]), Pose([0.2, 0, 1.5])),
            Part(f"{name}3", Box([1, 1, 1]), Pose([0.9, 0, 2.5])),
        ]
    )


@pytest.fixture
def file(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.chdir(tmp_path)
    kilter.dump(pile(NAMES[request.param]), tmp_path / "pile.kilter.json")
    return "pile.kilter.json"


@pytest.mark.slow
@pytest.mark.parametrize("file", ["escape", "direction", "lines", "long"], indirect=True)
def test_no_command_prints_a_hostile_name(file, capsys):
    for command, *words in WORDS_NAMES:
        assert main([command, file, *words]) in (0, 1, 2, 3, 4)
        printed = capsys.readouterr()
        for line in (printed.out + printed.err).split("\n"):
            assert line.isprintable(), (command, line)
            assert len(line) < WIDEST, (command, line)


@pytest.mark.parametrize("file", ["escape"], indirect=True)
def test_json_keeps_the_name_and_colours_are_those_of_kilter(file, capsys, monkeypatch):
    main(["check", file, "--json"])
    text = capsys.readouterr().out
    assert "\x1b" not in text
    assert json.loads(text)["parts"][0]["name"] == f"{NAMES['escape']}1"
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.delenv("NO_COLOR", raising=False)
    main(["check", file])
    text = capsys.readouterr().out
    assert text.startswith("\x1b[1;33m")
    assert text.count("\x1b") == 2


def test_an_error_cuts_quoted_names_and_no_sentence():
    sentence = "part 'a' lies on " + "very " * 30 + "long words, and the file's unit is 'm'"
    assert InputError(sentence).what == sentence
    error = InputError(
        f"there is no part {LONG!r}", part=LONG, file=f"/{LONG}", hint=f"not {LONG!r}"
    )
    assert len(str(error)) < 1000
    assert "nnn...nnn" in error.what


def test_a_copied_command_ends_no_word_early():
    """A backslash at the end of a word in double quotes would join it to the next word."""
    words = ["kilter", "check", "--fasten", "a b\\", "; touch hit #", "!x", "$(x)", "`x`"]
    shlex = pytest.importorskip("shlex")
    assert shlex.split(shell_words(words)) == words


# tables ---------------------------------------------------------------------------------------


def cells(text: str) -> list[str]:
    return [cell for row in csv.reader(io.StringIO(text)) for cell in row]


@pytest.mark.parametrize(
    "name", [*NAMES.values(), "'=a", "''@", "+1", "-1e5", "=", "\t=x", "'a", "1" * 60 + "x"]
)
def test_a_cell_runs_no_formula_and_keeps_the_name(name):
    cell = safe_cell(name)
    assert cell.isprintable()
    assert is_numeric(cell) or cell[0] not in "=+-@\t\r\n"
    if name.isprintable():
        assert name_of_cell(cell) == name


@pytest.mark.slow
@pytest.mark.parametrize("part", ["formula", "sum", "minus"])
def test_no_table_begins_a_cell_with_a_formula(part, tmp_path, monkeypatch):
    """The table of a plan can be read again, and a batch states the file of each row."""
    monkeypatch.chdir(tmp_path)
    name = "=cmd.kilter.json"
    kilter.dump(Assembly(list(pile(NAMES[part]))[:2]), name)
    assert main(["plan", name, "-o", "plan.csv", "--quiet"]) in (0, 3)
    assert main(["plan", name, "--sequence", "plan.csv", "--quiet"]) in (0, 3)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    Path("list.txt").write_text(f"{name}\n@gone.step\n")
    assert main(["batch", "list.txt", "-o", "rows", "--quiet"]) == 1
    assert main(["batch", "list.txt", "-o", "rows", "--quiet"]) == 1  # its rows are read
    for table in (Path("plan.csv"), *Path("rows").glob("*.csv")):
        read = cells(table.read_text())
        assert any(cell.startswith("'") for cell in read)
        assert [c for c in read if RUNS.match(c) and not is_numeric(c) and c[0] != "'"] == []


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["\ud800.step", "a\0b.step", "x" * 5000 + ".step"])
@pytest.mark.slow
def test_choices_about_a_name_that_the_system_rejects(name, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("c.json").write_text(json.dumps({"kilter": 1, "file": name}))
    assert main(["check", "c.json"]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert len(error) < 500
    assert main(["batch", ".", "-o", "rows", "--quiet"]) == 1


@pytest.mark.parametrize("text", ["[]", "5", '"a"', "[" * 100_000])
def test_a_batch_with_a_damaged_manifest_is_refused(text, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    Path("files").mkdir()
    kilter.dump(pile("a"), "files/a.kilter.json")
    Path("rows").mkdir()
    Path("rows", "batch.json").write_text(text)
    assert main(["batch", "files", "-o", "rows"]) == 2
    assert "has another batch" in capsys.readouterr().err
    assert sorted(path.name for path in Path("rows").iterdir()) == ["batch.json"]


def test_names_of_a_packing_plan_are_printed_without_control_characters(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    size = {f"{key}/mm": 100 for key in ("length", "width", "height")}
    item = {"article": "a\u202e\x1b[8m", "weight/kg": 1, **size}
    entries = [{"item": item, "flb_coordinates": [x, 0, 0], "orientation": 0} for x in (0, 300)]
    Path("plan.json").write_text(json.dumps({"order\u202e": entries}))
    for words in ([], ["--json"], ["-o", "out.txt"]):
        assert main(["check-plan", "plan.json", *words]) == 0
        printed = capsys.readouterr()
        assert (printed.out + printed.err).replace("\n", "").isprintable()
    assert "a\\u202e\\x1b[8m#1" in Path("out.txt").read_text()
