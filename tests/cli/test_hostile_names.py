"""Names from files: no control character reaches the terminal, no name is printed at full length.

No cell of a table begins with a formula.
"""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.cli import main
from kilter.errors import InputError, shell_words
from kilter.tell.csv_cells import RUNS, is_numeric, name_of_cell, safe_cell

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
COMMANDS = [
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
def test_no_command_prints_a_hostile_name(file: str, capsys: pytest.CaptureFixture[str]) -> None:
    for command, *words in COMMANDS:
        assert main([command, file, *words]) in (0, 1, 2, 3, 4)
        printed = capsys.readouterr()
        for line in (printed.out + printed.err).split("\n"):
            assert line.isprintable(), (command, line)
            assert len(line) < WIDEST, (command, line)


@pytest.mark.parametrize("file", ["escape"], indirect=True)
def test_json_keeps_the_name_and_colours_are_those_of_kilter(
    file: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
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


def test_an_error_cuts_quoted_names_and_no_sentence() -> None:
    sentence = "part 'a' lies on " + "very " * 30 + "long words, and the file's unit is 'm'"
    assert InputError(sentence).what == sentence
    error = InputError(
        f"there is no part {LONG!r}", part=LONG, file=f"/{LONG}", hint=f"not {LONG!r}"
    )
    assert len(str(error)) < 1000
    assert "nnn...nnn" in error.what


def test_a_copied_command_ends_no_word_early() -> None:
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
def test_a_cell_runs_no_formula_and_keeps_the_name(name: str) -> None:
    cell = safe_cell(name)
    assert cell.isprintable()
    assert is_numeric(cell) or cell[0] not in "=+-@\t\r\n"
    if name.isprintable():
        assert name_of_cell(cell) == name


@pytest.mark.slow
@pytest.mark.parametrize("part", ["formula", "sum", "minus"])
def test_no_table_begins_a_cell_with_a_formula(
    part: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
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
def test_choices_about_a_name_that_the_system_rejects(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("c.json").write_text(json.dumps({"kilter": 1, "file": name}))
    assert main(["check", "c.json"]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert len(error) < 500
    assert main(["batch", ".", "-o", "rows", "--quiet"]) == 1


@pytest.mark.parametrize("text", ["[]", "5", '"a"', "[" * 100_000])
def test_a_batch_with_a_damaged_manifest_is_refused(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("files").mkdir()
    kilter.dump(pile("a"), "files/a.kilter.json")
    Path("rows").mkdir()
    Path("rows", "batch.json").write_text(text)
    assert main(["batch", "files", "-o", "rows"]) == 2
    assert "has another batch" in capsys.readouterr().err
    assert sorted(path.name for path in Path("rows").iterdir()) == ["batch.json"]


def test_names_of_a_packing_plan_are_printed_without_control_characters(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
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
