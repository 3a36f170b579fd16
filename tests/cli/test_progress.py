"""Progress: the step at work, second by second, on a terminal alone."""

import io
import os
import re
import subprocess
import sys
import time
from types import SimpleNamespace

import pytest

import kilter
from kilter.cli import main, output
from kilter.cli.output import Progress
from kilter.scenes import scene
from kilter.work import Work


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


def test_each_step_is_named_again_and_again_and_wiped_away_at_the_end(terminal):
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


def test_what_ends_within_the_first_second_says_nothing(terminal, monkeypatch):
    monkeypatch.setattr(output, "EACH", 60.0)
    with Progress(quiet=False) as progress:
        progress("reading")
    assert terminal.getvalue() == ""


def test_it_goes_on_after_it_is_done(terminal):
    progress = Progress(quiet=False)
    progress("reading")
    progress.done()
    progress("page")
    shown(terminal, "page")
    progress.done()


@pytest.mark.parametrize("where", ["quiet", "no terminal"])
def test_nothing_is_said(where, terminal, monkeypatch):
    if where == "no terminal":
        monkeypatch.setattr(terminal, "isatty", lambda: False)
    with Progress(quiet=where == "quiet") as progress:
        progress("reading")
        time.sleep(0.05)
    assert terminal.getvalue() == ""


@pytest.mark.slow
@pytest.mark.skipif(os.name != "posix", reason="pipes of the shell")
@pytest.mark.parametrize("words", [["check", "--help"], ["example"]])
def test_a_reader_that_has_seen_enough_ends_it_well(words):
    told, telling = os.pipe()
    os.close(told)
    done = subprocess.run(
        [sys.executable, "-m", "kilter", *words], stdout=telling, stderr=subprocess.PIPE
    )
    os.close(telling)
    assert (done.returncode, done.stderr) == (0, b"")


def test_an_interrupted_search_tells_the_step_and_the_facts_known_so_far(
    tmp_path, monkeypatch, capsys
):
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("arch"), tmp_path / "arch.kilter.json")
    monkeypatch.setattr("kilter.friction.answer.find_settling", interrupted)
    assert main(["check", "arch.kilter.json", "--friction", "0.8"]) == 130
    assembly = kilter.load(tmp_path / "arch.kilter.json")
    held = sum(part.grounded for part in assembly.parts)
    assert capsys.readouterr().err == (
        'kilter: interrupted in the step "putting it down loosely"; known so far: it has '
        f"{len(assembly)} parts, {held} of them held, {kilter.contacts(assembly).pairs} pairs of "
        "parts touch, forces that hold it exist\n"
    )


def test_a_later_fact_about_a_joined_assembly_does_not_replace_the_first():
    """The search for deciding pairs judges assemblies with joined parts."""
    kept: dict[str, str] = {}
    work = Work(facts=kept.setdefault)
    work.fact("equilibrium", "no forces of the certain contacts hold it")
    work.beside(1.0).fact("equilibrium", "forces that hold it exist")
    assert kept == {"equilibrium": "no forces of the certain contacts hold it"}


def test_search_of_contacts_and_of_an_order_state_how_much_they_examine(monkeypatch):
    monkeypatch.setattr("kilter.work.BETWEEN_WORDS", 0.0)
    said: list[str] = []
    kilter.plan(scene("tower"), progress=said.append)
    assert "contacts of near pairs: 5" in said
    assert any(word.startswith("order: sets of parts 1, judged states ") for word in said)
