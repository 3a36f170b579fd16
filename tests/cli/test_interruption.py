"""Ctrl-C and a request to end, at any moment: one line, code 130, soon, no file half written."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter.cli.interruption import GRACE, REPLACED, interruptible
from kilter.scenes import walls

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")

SOON = 3.0
"""Within a second on a machine that has nothing else to do [s]."""
LAST = r'kilter: interrupted( in the step "[^"]+")?(; known so far: it has \d+ parts.*)?'
"""Last line on the error stream."""
ANSWERED = (0, 1, 3, 4)
"""How commands end that had their answer before."""
DEAF = """
import sys, numpy, kilter.cli
def deaf(words):
    many = numpy.ones((5000, 5000))
    print("begun", flush=True)
    return (many @ many).size  # one step of Python, half a minute of one core
kilter.cli._run = deaf
sys.exit(kilter.cli.main())
"""


def ended(process: subprocess.Popen[str], number: signal.Signals) -> tuple[int, str, float]:
    """How a process ends that is sent a signal, what it says, and how long that took [s]."""
    started = time.perf_counter()
    process.send_signal(number)
    try:
        _, errors = process.communicate(timeout=60)
    finally:
        process.kill()
    return process.returncode, errors, time.perf_counter() - started


def begun(*command: str) -> subprocess.Popen[str]:
    pipe = subprocess.PIPE
    return subprocess.Popen([sys.executable, *command], stdout=pipe, stderr=pipe, text=True)


def listens(process: subprocess.Popen[str]) -> None:
    """Wait until the process has begun to listen; before, the system ends it by itself."""
    status = Path(f"/proc/{process.pid}/status")
    caught = 0
    while status.exists() and process.poll() is None and not caught >> signal.SIGTERM - 1 & 1:
        time.sleep(0.01)
        line = next(row for row in status.read_text().splitlines() if row.startswith("SigCgt"))
        caught = int(line.split()[1], 16)
    time.sleep(0.0 if caught else 1.0)


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_process_that_is_deaf_is_ended(number):
    process = begun("-c", DEAF)
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    code, errors, seconds = ended(process, number)
    assert (code, errors) == (130, "kilter: interrupted\n")
    assert seconds < SOON


LOST = """
import sys, time, kilter.cli
class Waits:
    def wait(self, *given):
        print("begun", flush=True)
        time.sleep(60)
    __set_name__ = wait
class WaitsAtItsEnd(Waits):
    __del__ = Waits.wait
def loads():
    sys.path.insert(0, sys.argv[1])
    import waits
def drops():
    WaitsAtItsEnd()
def makes_another():
    type("Owner", (), {"one": Waits()})
kilter.cli._run = lambda words: WHERE()
sys.exit(kilter.cli.main())
"""


@pytest.mark.quick(2)
@pytest.mark.parametrize("where", ["loads", "drops", "makes_another"])
def test_an_interruption_is_not_lost(where, tmp_path):
    """In a module being loaded, in what cannot pass it on, and where Python turns it."""
    (tmp_path / "waits.py").write_text("from __main__ import Waits\nWaits().wait()\n", "utf-8")
    process = begun("-c", LOST.replace("WHERE", where), str(tmp_path))
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    code, errors, seconds = ended(process, signal.SIGINT)
    assert (code, errors) == (130, "kilter: interrupted\n")
    assert seconds < SOON


PATIENT = """
import sys, time, kilter.cli
def patient(words):
    for _ in range(2):
        try:
            print("begun", flush=True)
            time.sleep(60)
        except KeyboardInterrupt:
            pass
kilter.cli._run = patient
sys.exit(kilter.cli.main())
"""


@pytest.mark.slow
def test_a_second_interruption_ends_what_went_on_after_the_first():
    process = begun("-c", PATIENT)
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    process.send_signal(signal.SIGINT)
    assert process.stdout.readline() == "begun\n"
    process.send_signal(signal.SIGINT)  # the same, told by a parent too
    time.sleep(1.5 * GRACE)
    assert process.poll() is None
    assert ended(process, signal.SIGINT)[:2] == (130, "kilter: interrupted\n")


@pytest.mark.slow
@pytest.mark.parametrize("command", ["check", "margin", "region", "orient", "plan"])
@pytest.mark.parametrize("seed", range(3))
def test_a_command_is_ended_at_any_moment(tmp_path, command, seed):
    random = np.random.default_rng([seed, len(command)])
    wall = walls.wall_of(600, friction=0.6).with_down([0.0, 0.02, -1.0])
    kilter.dump(wall, tmp_path / "wall.kilter.json")
    proof = ["--proof", str(tmp_path / "proof.json")]
    answer = proof if command in ("check", "margin", "region") else []
    process = begun("-m", "kilter", command, str(tmp_path / "wall.kilter.json"), *answer)
    listens(process)
    time.sleep(random.uniform(0.0, 2.5))
    number = signal.Signals(random.choice([signal.SIGINT, signal.SIGTERM]))
    code, errors, seconds = ended(process, number)
    assert seconds < SOON
    if code not in ANSWERED:
        assert code == 130
        assert re.fullmatch(LAST, errors.splitlines()[-1])
        left = {path.name for path in tmp_path.iterdir()}
        assert left == {"wall.kilter.json"}


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wall whose programs take seconds to set up, in which their solver hears nothing."""
    path = tmp_path_factory.mktemp("large") / "wall.kilter.json"
    kilter.dump(walls.wall_of(10_000, friction=0.6).with_down([0.0, 0.08, -1.0]), path)
    return path


@pytest.mark.slow
@pytest.mark.parametrize("command", ["region", "orient"])
@pytest.mark.parametrize("seed", range(2))
def test_a_large_program_is_ended_while_it_is_set_up(large, command, seed):
    process = begun("-m", "kilter", command, str(large))
    listens(process)
    time.sleep(np.random.default_rng([seed, len(command)]).uniform(2.0, 12.0))
    code, errors, seconds = ended(process, signal.SIGINT)
    assert code == 130
    assert re.fullmatch(LAST, errors.splitlines()[-1])
    assert seconds < SOON


SLOW_DISK = """
import os, sys, numpy, kilter.cli
from kilter.files import write_text
many = numpy.ones((5000, 5000))
def deaf(handle):
    print("begun", flush=True)
    many @ many  # as a disk that takes its time: one step of Python
os.fsync = deaf
kilter.cli._run = lambda words: write_text(sys.argv[1], "new")
sys.exit(kilter.cli.main())
"""


@pytest.mark.slow
def test_a_write_that_is_ended_leaves_nothing_beside(tmp_path):
    target = tmp_path / "a.json"
    target.write_text("old", "utf-8")
    process = begun("-c", SLOW_DISK, str(target))
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    assert ended(process, signal.SIGTERM)[:2] == (130, "kilter: interrupted\n")
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]
    assert target.read_text("utf-8") == "old"


def test_a_request_to_end_ends_the_tests_too():
    """`main` in a test keeps the handler of `conftest.py`, so a time limit is no failed test."""
    given = signal.getsignal(signal.SIGTERM)
    assert given not in REPLACED
    with interruptible(alone=False):
        assert signal.getsignal(signal.SIGTERM) is given
