"""Progress: the step at work, second by second, on a terminal alone."""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys
import time
from types import SimpleNamespace

import pytest

from kilter.cli import output
from kilter.cli.output import Progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Terminal:
    monkeypatch.setattr(output, "EACH", 0.01)
    there = Terminal()
    monkeypatch.setattr(output, "sys", SimpleNamespace(stderr=there))
    return there


def shown(terminal: Terminal, word: str) -> list[str]:
    """Wait until a step is shown twice; all lines until then."""
    deadline = time.monotonic() + 30
    while terminal.getvalue().count(word) < 2:
        assert time.monotonic() < deadline
        time.sleep(0.005)
    return terminal.getvalue().split("\r\x1b[K")


def test_each_step_is_named_again_and_again_and_wiped_away_at_the_end(terminal: Terminal) -> None:
    with Progress(quiet=False) as progress:
        for step in ("reading", "contacts"):
            progress(step)
            assert re.fullmatch(
                rf"kilter: {step} \.\.\. \(\d+ s so far\)", shown(terminal, step)[-1]
            )
    said = terminal.getvalue()
    assert said.endswith("\r\x1b[K")
    time.sleep(0.05)
    assert terminal.getvalue() == said


def test_what_ends_within_the_first_second_says_nothing(
    terminal: Terminal, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(output, "EACH", 60.0)
    with Progress(quiet=False) as progress:
        progress("reading")
    assert terminal.getvalue() == ""


def test_it_goes_on_after_it_is_done(terminal: Terminal) -> None:
    progress = Progress(quiet=False)
    progress("reading")
    progress.done()
    progress("page")
    shown(terminal, "page")
    progress.done()


@pytest.mark.parametrize("where", ["quiet", "no terminal"])
def test_nothing_is_said(where: str, terminal: Terminal, monkeypatch: pytest.MonkeyPatch) -> None:
    if where == "no terminal":
        monkeypatch.setattr(terminal, "isatty", lambda: False)
    with Progress(quiet=where == "quiet") as progress:
        progress("reading")
        time.sleep(0.05)
    assert terminal.getvalue() == ""


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="pipes of the shell")
@pytest.mark.parametrize("words", [["check", "--help"], ["example"]])
def test_a_reader_that_has_seen_enough_ends_it_well(words: list[str]) -> None:
    told, telling = os.pipe()
    os.close(told)
    done = subprocess.run(
        [sys.executable, "-m", "kilter", *words], stdout=telling, stderr=subprocess.PIPE
    )
    os.close(telling)
    assert (done.returncode, done.stderr) == (0, b"")
