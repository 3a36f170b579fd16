"""A command and the function of its name give the same answer, but for the time it took."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import kilter
from kilter.cli import main

SCENES = ("paper-figure-8", "paper-figure-11", "slope-with-friction", "wall-with-lintel", "pit")
VERBS = ("check", "contacts", "orient", "region", "margin")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def said(capsys: pytest.CaptureFixture[str], *words: str) -> Any:
    capsys.readouterr()
    main([*words, "--json"])
    return json.loads(capsys.readouterr().out)


def timeless(answer: Any) -> Any:
    """An answer as JSON gives it back, without its times."""
    if isinstance(answer, dict):
        return {key: timeless(value) for key, value in answer.items() if key != "seconds"}
    return [timeless(value) for value in answer] if isinstance(answer, list | tuple) else answer


@pytest.mark.quick(1)
@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("name", SCENES)
def test_command_and_function_agree(
    name: str, verb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    kilter.dump(kilter.example(name), "a.json")
    answer = getattr(kilter, verb)(kilter.load("a.json")).to_dict()
    assert timeless(said(capsys, verb, "a.json")) == timeless(answer)


@pytest.mark.slow
def test_options_of_reading_are_those_of_load(capsys: pytest.CaptureFixture[str]) -> None:
    kilter.dump(kilter.example("paper-figure-8"), "a.json")
    words = ["--without", "C3", "--down", "0.1", "0", "-1", "--friction", "0.3", "--floor", "-9"]
    answer = said(capsys, "check", "a.json", *words, "--proof", "p.json")
    assembly = kilter.load("a.json", without="C3", down=[0.1, 0, -1], friction=0.3, floor=-9)
    verdict = kilter.check(assembly)
    assert timeless(verdict.to_dict()) == timeless(answer)
    for given in ("a.json", assembly):
        assert timeless(said(capsys, "verify", "a.json", "p.json")) == timeless(
            kilter.verify(given, "p.json").to_dict()
        )


def test_the_list_of_examples(capsys: pytest.CaptureFixture[str]) -> None:
    assert said(capsys, "example") == [entry.to_dict() for entry in kilter.example()]
