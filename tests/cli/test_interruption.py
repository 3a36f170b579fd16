"""Progress, time limits and interruptions."""

import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import fastjsonschema
import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.decision import cascade
from kilter.analysis.decision.judge import Judgement, judge
from kilter.analysis.load_limit import NoLimit
from kilter.analysis.margins import margin_steps
from kilter.analysis.margins.part_limits import PartClusters
from kilter.cli import main, output
from kilter.cli.interruption import GRACE, REPLACED, interruptible
from kilter.cli.output import Progress
from kilter.errors import TimeLimitReached
from kilter.mechanics.program import Program
from kilter.scenes import scene, stacks, walls
from kilter.tell.text import text_of
from kilter.work import Work, seconds_left, stop_after
from published import validator

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


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
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


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
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


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
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


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
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
        assert code == 130, errors
        assert re.fullmatch(LAST, errors.splitlines()[-1])
        left = {path.name for path in tmp_path.iterdir()}
        assert left == {"wall.kilter.json"}


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wall whose programs take seconds to set up, in which their solver hears nothing."""
    path = tmp_path_factory.mktemp("large") / "wall.kilter.json"
    kilter.dump(walls.wall_of(10_000, friction=0.6).with_down([0.0, 0.08, -1.0]), path)
    return path


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
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


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
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


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_request_to_end_ends_the_tests_too():
    """`main` in a test keeps the handler of `conftest.py`, so a time limit is no failed test."""
    given = signal.getsignal(signal.SIGTERM)
    assert given not in REPLACED
    with interruptible(alone=False):
        assert signal.getsignal(signal.SIGTERM) is given


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


SHARED = Path(__file__).parents[3] / "shared" / "data"
VAULT = SHARED / "compas_assembly" / "crossvault.json"
ROBOT = SHARED / "cax-if" / "as1-oc-214.stp"
IRIS = SHARED / "cad" / "iris_box.step"
CHAIR = SHARED / "brickgpt" / "chair.txt"
LIMIT = 2.0
LATEST = 3.5
"""Largest time of a whole command with a limit of 2 s [s], on a machine that is not busy."""
COMMANDS = [
    ["check"],
    ["hold"],
    ["margin"],
    ["orient"],
    ["region"],
    ["plan"],
    ["report", "-o", "answer.html"],
    ["draw", "-o", "answer.svg"],
    ["draw", "--what", "region", "-o", "answer.svg"],
    ["margin", "--improve"],
]
ASSEMBLIES = {
    "vault": [str(VAULT), "--friction", "0.84"],
    "vault-with-given-contacts": [str(VAULT), "--friction", "0.84", "--contacts", "file"],
    "solids": [str(ROBOT), "--ground", "plate", "--friction", "0.3"],
    "fastened-solids": [str(ROBOT), "--ground", "plate", "--fasten", "*bolt*", "*nut*"],
    "iris-box": [str(IRIS), "--floor", "--friction", "0.3"],
    "chair": [str(CHAIR)],
}
"""Arguments of large assemblies, whose answers take longer than the time limit."""


def test_a_solver_call_after_the_limit_raises():
    with stop_after(0.0), pytest.raises(TimeLimitReached):
        seconds_left(None)
    assert seconds_left(None) is None


def test_an_inner_limit_does_not_extend_an_outer_one():
    with stop_after(0.0), stop_after(100.0):
        assert Work(time_limit=100.0).late
        with pytest.raises(TimeLimitReached):
            seconds_left(None)


@pytest.mark.parametrize("analysis", [kilter.region, kilter.orient])
def test_all_directions_at_limit_zero_state_the_verdict_of_the_given_direction(analysis):
    with pytest.raises(TimeLimitReached) as caught:
        analysis(stacks.block_on_slope(10.0, friction=0.5), time_limit=0.0)
    assert caught.value.known == (
        "With gravity as given it is potentially stable, level equilibrium."
    )


def test_the_margin_at_limit_zero_names_the_limits_that_are_not_known():
    answer = kilter.margin(stacks.block_on_slope(10.0, friction=0.5), time_limit=0.0)
    assert answer.missing["tilt"] == answer.missing["friction"] == "time"
    assert any("because the time limit was reached" in text for text in answer.warnings)


@pytest.mark.slow
def test_a_solver_that_the_limit_cut_short_is_not_reported_as_failed(monkeypatch):
    late = {"now": False}

    def cut_short(groups: list[Program], **options: object) -> NoLimit:
        late["now"] = True
        return NoLimit("failed")

    monkeypatch.setattr(margin_steps, "find_group_friction", cut_short)
    slope = stacks.block_on_slope(10.0, friction=0.5)
    assert kilter.margin(slope, pushed=[]).missing["friction"] == "failed"
    monkeypatch.setattr(Work, "late", property(lambda work: late["now"]))
    late["now"] = False
    assert kilter.margin(slope, pushed=[], time_limit=100.0).missing["friction"] == "time"


def test_a_verdict_that_the_limit_ended_reports_the_known_facts(monkeypatch):
    def cut_short(program: Program, **options: Any) -> Judgement:
        judged = judge(program, **options)
        return judged if program.frictionless is program else replace(judged, stable=None)

    monkeypatch.setattr(cascade, "judge", cut_short)
    monkeypatch.setattr(Work, "cut", property(lambda work: True))
    slope = stacks.block_on_slope(10.0, friction=0.5)
    assert kilter.check(slope, time_limit=100.0).sentence == (
        "Undecided: the time limit was reached; known so far: 1 pair of parts touches, "
        "without friction the certain contacts do not hold it."
    )


def test_tries_that_the_time_limit_prevented_do_not_lack_effort(monkeypatch):
    late = {"now": False}

    def judged(program: Program, **options: Any) -> Judgement:
        judgement = judge(program, **options)
        late["now"] = program.frictionless is not program
        return judgement

    def is_late(work: Work) -> bool:
        work._clock.cut = work._clock.cut or late["now"]
        return late["now"]

    monkeypatch.setattr(cascade, "judge", judged)
    monkeypatch.setattr(Work, "late", property(is_late))
    slope = stacks.block_on_slope(10.0, friction=0.5)
    text = text_of(kilter.check(slope, time_limit=100.0).to_dict())
    assert "not tried for lack of time: a longer --time-limit" in text
    assert "effort: --effort" not in text


def test_an_undecided_verdict_without_a_motion_has_no_table_of_moving_parts():
    table = Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    sunk = Assembly([table, Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.45]))])
    answer = kilter.check(sunk).to_dict()
    assert answer["verdict"] == "undecided"
    assert "1 of 1 free parts move" in text_of(answer)
    for part in answer["parts"]:
        part["moves"] = False
    assert "free parts move" not in text_of(answer)


@pytest.mark.slow
def test_the_page_at_limit_zero_states_what_is_left_out():
    html = kilter.report(scene("arch"), time_limit=0.0).html
    assert "left out, because the time limit was reached" in html


@pytest.mark.parametrize("words", [["region"], ["orient"]])
def test_a_command_at_its_limit_answers_undecided(words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    kilter.dump(stacks.block_on_slope(10.0, friction=0.5), "slope.kilter.json")
    command = [*words, "slope.kilter.json", "--time-limit", "0"]
    assert main(command) == 4
    assert capsys.readouterr().out.startswith("Undecided: the time limit of 0 s was reached")
    assert main([*command, "--json"]) == 4
    answer = json.loads(capsys.readouterr().out)
    assert (answer["verdict"], answer["time_limit"]) == ("undecided", 0)
    validator("incomplete")(answer)
    for wrong in ({**answer, "unlisted": 1}, {**answer, "verdict": "stable"}):
        with pytest.raises(fastjsonschema.JsonSchemaValueException):
            validator("incomplete")(wrong)


@pytest.mark.slow
@pytest.mark.skipif(not VAULT.exists(), reason="the assemblies of others are not here")
@pytest.mark.parametrize(
    ("words", "name"),
    # half of all pairs: each command on three files
    [(words, name) for k, words in enumerate(COMMANDS) for name in list(ASSEMBLIES)[k % 2 :: 2]],
    ids=lambda given: given if isinstance(given, str) else " ".join(given[:3]),
)
def test_every_command_ends_in_time_with_an_answer(words, name, tmp_path):
    verb, *rest = words
    asked = [verb, *ASSEMBLIES[name], *rest, "--time-limit", str(LIMIT)]
    command = [sys.executable, "-m", "kilter", *asked]
    began = time.perf_counter()
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    seconds = time.perf_counter() - began
    if "does not support bonds" in ended.stderr:
        pytest.skip("the command has no answer for bonds")
    assert ended.returncode in (0, 1, 3, 4), ended.stderr
    assert ended.stdout or "answer." in ended.stderr
    if os.getloadavg()[0] < 1.5:  # another program on the machine takes time from this one
        assert seconds < LATEST


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("place tower.kilter.json --box 1x1x1 --mass 5 --time-limit {}", {"0": 4, "60": 0}),
        ("check-plan plan.csv --time-limit {}", {"0": 0, "60": 0}),
        ("contacts tower.kilter.json --time-limit {}", {"0": 0, "60": 0}),
    ],
)
def test_the_last_commands_have_a_time_limit(line, code, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("tower"), "tower.kilter.json")
    rows = "a,1,1,1,2,0,0,0\nb,1,1,1,2,0,0,1\n"
    Path("plan.csv").write_text(f"name,length,width,height,mass,x,y,z\n{rows}", encoding="utf-8")
    for limit, expected in code.items():
        assert main(line.format(limit).split()) == expected
        cut = capsys.readouterr().out.startswith("Undecided: the time limit")
        assert cut is (expected == 4)


def test_place_takes_a_time_limit_and_a_direction_of_gravity():
    box = kilter.box_to_place([1, 1, 1], 5.0)
    with pytest.raises(TimeLimitReached):
        kilter.place(scene("tower"), box, time_limit=0.0)
    turned = scene("tower").with_down([1, 0, 0])
    assert kilter.place(turned, box, down=[0, 0, -1], time_limit=60.0).stands


def test_an_interrupted_margin_prints_the_limits_that_are_known(tmp_path, monkeypatch, capsys):
    pushed: list[int] = []

    def interrupted(self: PartClusters, part: int) -> Any:
        pushed.append(part)
        if len(pushed) > 1:
            raise KeyboardInterrupt
        return NoLimit("failed")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(PartClusters, "push", interrupted)
    kilter.dump(stacks.tower(4, friction=0.5), "a.json")
    assert main(["margin", "a.json", "--pushes", "--loads"]) == 130
    told = capsys.readouterr()
    assert "tilt      14.0362 deg" in told.out
    assert len(pushed) == 2
    assert "because the command was interrupted: 'push of" in told.err
    assert "and 2 more" in told.err or "'load on" in told.err
    assert "kilter: interrupted" in told.err
    pushed.clear()
    with pytest.raises(KeyboardInterrupt):  # a loop in Python ends
        kilter.margin(stacks.tower(4, friction=0.5), pushes=True, effort=0)


@pytest.mark.slow
def test_progress_without_a_terminal_is_lines_in_growing_intervals(monkeypatch, capsys):
    monkeypatch.setattr(output, "EACH", 0.02)
    with Progress(quiet=False, lines=True) as progress:
        progress("pushes: 3 of 50")
        time.sleep(0.5)
    lines = capsys.readouterr().err.splitlines()
    assert all(re.fullmatch(r"kilter: pushes: 3 of 50 \.\.\. \(\d+ s so far\)", x) for x in lines)
    assert 2 <= len(lines) <= 12  # not one for each of the 25 updates
    for silent in (Progress(quiet=True, lines=True), Progress(quiet=False)):
        with silent as progress:
            progress("pushes")
            time.sleep(0.1)
    assert capsys.readouterr().err == ""
