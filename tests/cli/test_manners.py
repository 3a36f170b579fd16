"""Manners of the command line: several names, guessed options, groups of commands, reports."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kilter
from kilter.cli import main
from kilter.cli.commands import COMMANDS, functions_of
from kilter.cli.declarations import Declared, declared_of
from kilter.cli.option_parser import with_values
from kilter.cli.overview import GROUPS, overview
from kilter.values.guesses import MEANT, WORDS, meant_word


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def options_of(command: str) -> dict[str, Declared]:
    """The options of a command, by each of their names."""
    [function] = functions_of(command)
    return {name: each for each in declared_of(function) for name in each.declaration.names}


def test_help_fits_a_screen_and_has_every_command_in_a_group() -> None:
    lines = overview().splitlines()
    assert len(lines) <= 24
    assert max(map(len, lines)) <= 80
    assert [line.split()[0] for line in lines if line[:1].strip() and "  " in line] == list(GROUPS)
    listed = [line[7:].split()[0] for line in lines[1:-1]]
    assert listed == list(COMMANDS)


@pytest.mark.parametrize("words", [[], ["--help"], ["-h"]])
def test_help_is_the_overview(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
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
def test_a_guessed_option_names_the_option_that_it_means(
    typed: str, meant: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", "a.json", typed, "x"]) == 2
    message = f"kilter: there is no option {typed}: use {meant}; see 'kilter check --help'\n"
    assert capsys.readouterr().err == message


def test_each_guess_means_an_option_that_exists_and_none_is_an_option_of_a_command() -> None:
    params = {name: set(options_of(name)) for name in COMMANDS}
    everywhere = set().union(*params.values())
    assert {f"--{name}" for name in WORDS} <= everywhere
    assert len(MEANT) == sum(map(len, WORDS.values()))
    assert meant_word("--hold", params["plan"]) is None or "--hold" in params["plan"]
    # a command suggests only options that it has
    assert meant_word("--mu", params["verify"]) is None


def test_several_names_after_one_option(capsys: pytest.CaptureFixture[str]) -> None:
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


def test_names_that_begin_like_numbers_and_a_name_that_is_missing(
    capsys: pytest.CaptureFixture[str],
) -> None:
    options = options_of("check")
    words = ["a.json", "--ground", "0", "1", "--floor", "--json"]
    apart = ["a.json", "--ground=0", "--ground=1", "--floor=lowest", "--json"]
    assert with_values(words, options) == apart
    assert with_values(["--ground"], options) == ["--ground"]
    assert main(["check", "a.json", "--ground"]) == 2
    assert "--ground needs NAME..." in capsys.readouterr().err


def test_a_written_answer_is_reported_with_its_path(capsys: pytest.CaptureFixture[str]) -> None:
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
def test_a_file_that_ends_like_json_gets_json(
    command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    kilter.dump(kilter.example("tower"), "tower.kilter.json")
    name, *more = command.split()
    main([name, *more, "tower.kilter.json", "-o", "x.json"])
    assert capsys.readouterr().out == ""
    assert json.loads(Path("x.json").read_text(encoding="utf-8"))


def test_an_example_prints_the_answer_of_check(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["example", "paper-figure-8"]) == 0
    path, sentence, step = capsys.readouterr().out.splitlines()
    assert path.startswith("paper-figure-8.kilter.json: ")
    assert sentence == kilter.check(kilter.load("paper-figure-8.kilter.json")).sentence
    assert step == "next: kilter check paper-figure-8.kilter.json"


def test_each_command_requires_one_level_or_states_the_reason() -> None:
    for name in COMMANDS:
        option = options_of(name).get("--require")
        if option is not None and option.default != "settles":
            assert "Other commands require settles" in option.declaration.help, name
            assert "because" in option.declaration.help
