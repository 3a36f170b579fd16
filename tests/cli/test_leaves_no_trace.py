"""`main` in a program of somebody else: what is the program's stays as it was."""

from __future__ import annotations

import gc
import locale
import logging
import os
import random
import signal
import sys
import threading
import warnings
from pathlib import Path

import numpy as np
import pytest
from threadpoolctl import threadpool_info

import kilter
import kilter.cli.output
import kilter.files
from kilter.cli import main
from kilter.scenes import scene

POSIX = pytest.mark.skipif(os.name != "posix", reason="signals and processes of POSIX")

COMMANDS = {
    "check": (["check", "tower.kilter.json", "--proof", "p.json"], 0),
    "check with friction": (["check", "wall.kilter.json", "--friction", "0.6", "--json"], 0),
    "contacts": (["contacts", "tower.kilter.json"], 0),
    "region": (["region", "tower.kilter.json"], 0),
    "margin": (["margin", "tower.kilter.json"], 0),
    "report": (["report", "tower.kilter.json", "-o", "tower.html"], 0),
    "draw": (["draw", "tower.kilter.json", "-o", "tower.svg"], 0),
    "verify": (["verify", "tower.kilter.json", "kept.json"], 0),
    "help": (["check", "--help"], 0),
    "wrong input": (["check", "no-such-file.json"], 2),
    "wrong usage": (["check", "tower.kilter.json", "--effort", "x"], 2),
}
QUICK = ("check", "contacts", "help", "wrong input", "wrong usage")


def handled(number: int, frame: object) -> None:
    """A signal, by a program that listens for itself."""


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("tower"), "tower.kilter.json")
    kilter.dump(scene("wall"), "wall.kilter.json")
    proof = kilter.check(scene("tower")).proof()
    kilter.files.write_text(Path("kept.json"), kilter.cli.output.as_json(proof))


def state() -> dict[str, object]:
    """What belongs to the whole process."""
    signals = [one for one in signal.Signals if one not in (signal.SIGKILL, signal.SIGSTOP)]
    return {
        "warnings": (list(warnings.filters), warnings.showwarning),
        "signals": {one.name: signal.getsignal(one) for one in signals},
        "wakeup": wakeup(),
        "environment": dict(os.environ),
        "numpy": (np.geterr(), np.geterrcall(), np.get_printoptions()),
        "random": (random.getstate(), str(np.random.get_state())),  # noqa: NPY002
        "streams": (sys.stdin, sys.stdout, sys.stderr, sys.displayhook, sys.excepthook),
        "path": list(sys.path),
        "arguments": list(sys.argv),
        "folder": os.getcwd(),
        "mask": mask(),
        "locale": locale.setlocale(locale.LC_ALL),
        "logging": (logging.root.level, list(logging.root.handlers)),
        "garbage": (gc.isenabled(), gc.get_threshold()),
        "threads": sorted(one.name for one in threading.enumerate()),
        "recursion": (sys.getrecursionlimit(), sys.getswitchinterval()),
        "trace": (sys.gettrace(), threading.excepthook),
        "linear algebra": {one["filepath"]: one["num_threads"] for one in threadpool_info()},
    }


def wakeup() -> int:
    """Where the interpreter tells of signals."""
    number = signal.set_wakeup_fd(-1)
    signal.set_wakeup_fd(number)
    return number


def mask() -> int:
    """What files that are made may not be."""
    now = os.umask(0o077)
    os.umask(now)
    return now


@pytest.mark.quick(1)
@POSIX
@pytest.mark.parametrize(
    "name", [one if one in QUICK else pytest.param(one, marks=pytest.mark.slow) for one in COMMANDS]
)
def test_a_command_changes_nothing_of_the_process(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words, code = COMMANDS[name]
    main(words)  # what is loaded once, is loaded
    before = signal.signal(signal.SIGINT, handled)
    try:
        with np.errstate(all="raise", under="ignore"), warnings.catch_warnings():
            warnings.simplefilter("error", ResourceWarning)
            was = state()
            assert main(words) == code, capsys.readouterr().err
            now = state()
    finally:
        signal.signal(signal.SIGINT, before)
    assert [key for key, value in was.items() if now[key] != value] == []


@POSIX
@pytest.mark.slow
def test_a_fault_changes_nothing_either(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["check", "tower.kilter.json"])

    def breaks(*given: object, **named: object) -> None:
        raise ZeroDivisionError("on purpose")

    monkeypatch.setattr("kilter.analysis.check.check", breaks)
    was = state()
    assert main(["check", "tower.kilter.json"]) == 70
    now = state()
    assert [key for key, value in was.items() if now[key] != value] == []


@POSIX
def test_a_command_in_a_thread_of_somebody_else(capsys: pytest.CaptureFixture[str]) -> None:
    """No signal can be set there, and none is."""
    main(["check", "tower.kilter.json"])
    was, codes = state(), []
    thread = threading.Thread(target=lambda: codes.append(main(["check", "tower.kilter.json"])))
    thread.start()
    thread.join()
    now = state()
    assert codes == [0]
    assert [key for key, value in was.items() if now[key] != value] == []
