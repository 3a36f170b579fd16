"""The command view, its worker, its actions, and full disks."""

import asyncio
import contextlib
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from driver import Page

import kilter
from kilter import Assembly, Box, Part
from kilter.cli import main
from kilter.contact import Tolerance
from kilter.errors import InputError
from kilter.scenes import scene
from kilter.workbench import session, worker, worker_process
from kilter.workbench.actions import ACTIONS, apply
from kilter.workbench.answering import _relative_motion, tab_data
from kilter.workbench.history import Change, History
from kilter.workbench.live_assembly import OpenedParts, Prepared
from kilter.workbench.server import Workbench, folder_of
from kilter.workbench.worker_process import WorkerProcess

POSIX = pytest.mark.skipif(os.name != "posix", reason="signals are sent otherwise there")
ENDS = 30


@contextmanager
def serving(folder: Path, *words: str, shell: str = "") -> Iterator[tuple[subprocess.Popen, str]]:
    """A running `kilter view`, and the address that it prints."""
    command = [sys.executable, "-m", "kilter", "view", *words, "--no-browser"]
    if shell:
        command = ["sh", "-c", shell, *command]
    with subprocess.Popen(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout is not None
            yield process, process.stdout.readline().split()[0]
        finally:
            process.kill()


def children(pid: int) -> list[int]:
    """Processes whose parent is a process, on Linux."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == pid and fields[0] != "Z":
            found.append(int(stat.parent.name))
    return found


def wait_until_gone(pids: list[int]) -> None:
    end = time.monotonic() + ENDS
    while any(Path(f"/proc/{pid}").exists() for pid in pids):
        assert time.monotonic() < end, "a process is left"
        time.sleep(0.1)


def wait_for_child(pid: int) -> list[int]:
    end = time.monotonic() + ENDS
    while not (found := children(pid)):
        assert time.monotonic() < end, "no computing process"
        time.sleep(0.1)
    return found


@pytest.mark.slow
@POSIX
@pytest.mark.parametrize("shell", ["", 'trap \'\' INT; exec "$0" "$@"'])
def test_ctrl_c_ends_it_well(tmp_path, shell):
    """A script that starts it in the background makes it inherit SIGINT as ignored."""
    kilter.dump(scene("tower"), tmp_path / "tower.kilter.json")
    with serving(tmp_path, "tower.kilter.json", shell=shell) as (process, url):
        with urllib.request.urlopen(url, timeout=20) as page:
            assert b"kilter" in page.read()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=ENDS)
        assert (process.returncode, errors) == (0, "")


@pytest.mark.slow
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="looks at /proc")
def test_a_killed_server_leaves_no_process(tmp_path):
    kilter.dump(scene("tower"), tmp_path / "tower.kilter.json")
    with serving(tmp_path, "tower.kilter.json") as (process, _):
        workers = wait_for_child(process.pid)
        process.kill()
        process.wait()
        wait_until_gone(workers)


@pytest.mark.slow
def test_options_are_the_first_choices(tmp_path):
    from driver import Page

    kilter.dump(scene("paper-figure-8"), tmp_path / "f8.kilter.json")
    words = ("f8.kilter.json", "--ground", "C3", "--down", "0", "0.1", "-1")
    with serving(tmp_path, *words) as (_, url):
        page = Page(url)
        answer = page.opened()
        choices = page.last["session"]["choices"]
        assert choices["held"] == ["C3"]
        size = sum(x * x for x in choices["gravity"]) ** 0.5
        assert size == pytest.approx(9.81)
        page.close()
    file = tmp_path / "f8.kilter.json"
    expected = kilter.check(kilter.load(file, ground="C3", down=[0, 0.1, -1]))
    assert answer["check"]["verdict"] == expected.verdict


@pytest.mark.slow
def test_a_wrong_file_is_a_sentence_on_the_page(tmp_path):
    from driver import Page

    (tmp_path / "wrong.kilter.json").write_text(
        json.dumps({"kilter": 1, "parts": [{"name": "<b>"}]})
    )
    with serving(tmp_path, "wrong.kilter.json") as (_, url):
        page = Page(url)
        page.hear(lambda m: m.get("is") == "session" and "<b>" in m["message"])
        page.close()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["-"], "cannot watch"),
        (["x.json", "--port", "70000"], "--port is 70000"),
        (["gone.step"], "no such file"),
        (["x" * 300 + ".step"], "too long"),
        (["--folder", "gone"], "no such folder"),
        (["--host", "0.0.0.0/8"], "is no name of a host"),
        (["gone.step", "--ground", "a"], "no such file"),
    ],
)
def test_a_wrong_argument_is_refused(words, said, capsys):
    assert main(["view", *words]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.skipif(os.name != "posix", reason="links of POSIX")
def test_a_link_out_of_the_folder_is_refused(tmp_path, capsys):
    for name in ("sent", "own"):
        (tmp_path / name).mkdir()
    kilter.dump(scene("tower"), tmp_path / "own" / "tower.kilter.json")
    link = tmp_path / "sent" / "link.kilter.json"
    link.symlink_to(tmp_path / "own" / "tower.kilter.json")
    assert main(["view", str(link), "--no-browser"]) == 2
    assert "leads out of the opened folder" in capsys.readouterr().err
    assert os.listdir(tmp_path / "own") == ["tower.kilter.json"]


def test_the_opened_folder_is_that_of_the_file(tmp_path, monkeypatch):
    here = Path(os.path.realpath(tmp_path)) / "a" / "b"
    here.mkdir(parents=True)
    monkeypatch.chdir(here)
    shown = {"x.step": here, "../x.step": here.parent, ".": here.parent, "..": here.parent.parent}
    assert {name: folder_of(Path(name)) for name in shown} == shown
    assert folder_of(None) == here


@POSIX
@pytest.mark.slow
@POSIX
@pytest.mark.parametrize("every", [False, True])
def test_all_addresses_are_a_warning(tmp_path, every):
    words = ["--host", "0.0.0.0"] if every else []
    with serving(tmp_path, *words) as (process, url):
        with urllib.request.urlopen(url, timeout=20) as page:
            assert b"kilter" in page.read()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=ENDS)
        assert ("warning: other computers can reach this page" in errors) == every


@pytest.mark.slow
def test_changes_that_cannot_be_kept_are_named_and_answered(tmp_path):
    from driver import Page

    kilter.dump(scene("paper-figure-8"), tmp_path / "f8.kilter.json")
    # a folder in the place of the file: no user, root included, can write this file
    (tmp_path / ".f8.kilter.json.workbench.json").mkdir()
    with serving(tmp_path, "f8.kilter.json") as (_, url):
        page = Page(url)
        page.opened()
        page.after(do="hold", parts=["C3"], on=True)
        assert "not kept beside the file" in page.last["session"]["message"]
        page.close()


class DeafProcess:
    """A process that misses every signal."""

    pid = 1

    def __init__(self) -> None:
        self.signals: list[int] = []

    def send_signal(self, number: int) -> None:
        """Record a signal."""
        self.signals.append(number)


@pytest.mark.skipif(os.name != "posix", reason="other systems end the process at once")
def test_a_job_that_misses_the_signal_is_interrupted_again(monkeypatch):
    monkeypatch.setattr(worker_process, "AGAIN", 0.01)
    process: Any = DeafProcess()

    async def counts() -> tuple[int, int, int]:
        worker = WorkerProcess(lambda number, kind, data: None)
        worker._process, worker.running = process, 7
        worker.interrupt()
        await asyncio.sleep(0.1)
        during = len(process.signals)
        worker.running = 8  # the job has ended, and another runs
        await asyncio.sleep(0.05)
        after = len(process.signals)
        await asyncio.sleep(0.1)
        assert worker._timer is not None
        worker._timer.cancel()
        return during, after, len(process.signals)

    during, after, later = asyncio.run(counts())
    assert during >= 2
    assert after == later
    assert set(process.signals) == {signal.SIGINT}


@pytest.mark.parametrize(("interrupted", "kind"), [(True, "stopped"), (False, "fault")])
def test_an_error_in_place_of_the_interruption_counts_as_a_stop(interrupted, kind):
    """NumPy replaces an interruption that comes while it compares types by a TypeError."""
    interruption = worker._Interruption()

    class Jobs:
        """Jobs that fail after an interruption was lost."""

        def run(self, job: dict[str, Any], report: Any) -> None:
            """Do a job."""
            if interrupted:
                with contextlib.suppress(KeyboardInterrupt):
                    interruption.hear(signal.SIGINT, None)
            raise TypeError("types cannot be compared")

    for number in (1, 2):
        assert worker._run(Jobs(), number, {}, None, interruption)[:2] == (number, kind)
    interrupted = False  # the interruption of a job does not concern the next job
    assert worker._run(Jobs(), 3, {}, None, interruption)[1] == "fault"
    assert not interruption.working


BODIES = OpenedParts(
    ("plate", "rod", "nut_1", "nut_2"), frozenset({"rod"}), (2e-3, 1e-3, 1e-5, 0.0)
)
START = {"kilter": 1, "file": "a.step"}

EFFECTS = [
    ({"do": "hold", "parts": ["plate"], "on": True}, {"held": ["plate"]}),
    ({"do": "hold", "parts": ["nut_*"], "on": True}, {"held": ["nut_1", "nut_2"]}),
    ({"do": "floor", "on": True}, {"floor": True}),
    ({"do": "floor", "on": -2.5}, {"floor": -2.5}),
    ({"do": "leave_out", "parts": ["nut_1"], "on": True}, {"left_out": ["nut_1"]}),
    ({"do": "fasten", "parts": ["plate", "nut_1"], "on": True}, {"joined": [["plate", "nut_1"]]}),
    ({"do": "assume", "rung": "joined"}, {"assume": "joined"}),
    ({"do": "assume", "rung": "play", "mu": 0.3}, {"assume": "play", "friction": 0.3}),
    ({"do": "fasten_suggested", "on": True}, {"fasten_suggested": True}),
    ({"do": "fasten_overlaps", "on": True}, {"fasten_overlaps": True}),
    ({"do": "loose", "on": True}, {"loose": True}),
    (
        {"do": "pair", "pairs": [["plate", "rod"]], "as": "apart"},
        {"open_pairs": [{"parts": ["plate", "rod"], "as": "apart"}]},
    ),
    (
        {"do": "material", "parts": ["plate"], "density": 2700, "name": "aluminium"},
        {"materials": [{"parts": "plate", "density": 2700.0, "name": "aluminium"}]},
    ),
    (
        {"do": "mass", "part": "plate", "mass": 16},
        {"materials": [{"parts": "plate", "density": 8000.0}]},
    ),
    ({"do": "friction", "mu": 0.3}, {"friction": 0.3}),
    (
        {"do": "pair_friction", "parts": ["plate", "rod"], "mu": 0},
        {"friction_pairs": [{"parts": ["plate", "rod"], "mu": 0.0}]},
    ),
    (
        {"do": "joint", "parts": ["plate", "rod"], "kind": "fixed"},
        {"joints": [{"parts": ["plate", "rod"], "kind": "fixed"}]},
    ),
    (
        {"do": "bond", "parts": ["plate", "rod"], "pull": 5, "shear": "mu"},
        {"bonds": [{"parts": ["plate", "rod"], "pull": 5.0, "shear": "mu"}]},
    ),
    (
        {"do": "load", "part": "nut_1", "force": [0, 0, -5]},
        {"loads": [{"part": "nut_1", "force": [0.0, 0.0, -5.0]}]},
    ),
    (
        {"do": "strap", "path": [["rod", [0, 0, 1]], ["ground", [1, 0, 0]]], "tension": 800},
        {"straps": [{"path": [["rod", [0.0, 0, 1]], ["ground", [1.0, 0, 0]]], "tension": 800.0}]},
    ),
    (
        {"do": "poses", "poses": {"rod": {"position": [0, 0, 1], "rotation": [1, 0, 0, 0]}}},
        {"poses": {"rod": {"position": [0.0, 0.0, 1.0], "rotation": [1.0, 0.0, 0.0, 0.0]}}},
    ),
    (
        {
            "do": "improve",
            "label": "hold rod, less friction",
            "actions": [
                {"do": "hold", "parts": ["rod"], "on": True},
                {"do": "friction", "mu": 0.3},
            ],
        },
        {"held": ["rod"], "friction": 0.3},
    ),
    ({"do": "gravity", "up": "y"}, {"up": "y"}),
    ({"do": "gravity", "down": [0, 0, 2]}, {"gravity": [0.0, 0.0, 9.81]}),
    ({"do": "units", "value": "mm"}, {"units": "mm"}),
    ({"do": "density", "value": 7850}, {"density": 7850.0}),
    ({"do": "tolerance", "gap": 0.1}, {"tolerance": {"gap": 0.1}}),
    ({"do": "contacts", "value": "geometry"}, {"contacts": "geometry"}),
]


@pytest.mark.parametrize(("action", "keys"), EFFECTS, ids=lambda value: str(value.get("do", "")))
def test_an_action_changes_its_key(action, keys):
    new, label = apply(action, START, BODIES)
    assert new == {**START, **keys}
    assert label


def test_each_action_has_a_test():
    listed = {action["do"] for action, _ in EFFECTS}
    removing = {"joint_off", "bond_off", "load_off", "scale_loads", "strap_off"}
    assert listed | removing == set(ACTIONS)


@pytest.mark.parametrize(("key", "do"), [("joints", "joint"), ("bonds", "bond"), ("loads", "load")])
def test_an_entry_of_a_list_is_removed(key, do):
    [action] = [action for action, _ in EFFECTS if action["do"] == do]
    one, _ = apply(action, START, BODIES)
    two, _ = apply(action, one, BODIES)
    assert len(two[key]) == 2
    assert apply({"do": f"{do}_off", "index": 1}, two, BODIES)[0] == one
    with pytest.raises(InputError, match="there is no"):
        apply({"do": f"{do}_off", "index": 2}, two, BODIES)


def test_a_change_that_helps_contains_no_other():
    [one] = [action for action, _ in EFFECTS if action["do"] == "improve"]
    with pytest.raises(InputError, match="another change"):
        apply({**one, "actions": [one]}, START, BODIES)
    with pytest.raises(InputError, match="there is no part"):
        apply({**one, "actions": [{"do": "hold", "parts": ["none"], "on": True}]}, START, BODIES)


def test_loads_are_scaled():
    keys = {**START, "loads": [{"part": "nut_1", "force": [0, 0, -4], "torque": [1, 0, 0]}]}
    new, _ = apply({"do": "scale_loads", "factor": 2.5}, keys, BODIES)
    assert new["loads"] == [{"part": "nut_1", "force": [0, 0, -10], "torque": [2.5, 0, 0]}]


def test_a_release_takes_a_part_out_of_a_pattern():
    keys = {**START, "held": ["nut_*", "plate"]}
    new, _ = apply({"do": "hold", "parts": ["nut_2"], "on": False}, keys, BODIES)
    assert new["held"] == ["nut_1", "plate"]


WRONG = [
    ({"do": "fly"}, "unknown action"),
    ({"do": "hold", "parts": ["gone"], "on": True}, "there is no part gone"),
    ({"do": "hold", "parts": ["rod"], "on": False}, "the file itself holds rod"),
    ({"do": "leave_out", "parts": ["*"], "on": True}, "no part would be left"),
    ({"do": "fasten", "parts": ["plate", "plate"], "on": True}, "with itself"),
    ({"do": "fasten", "parts": ["plate", "gone"], "on": True}, "there is no part 'gone'"),
    ({"do": "fasten", "parts": ["plate", "rod"], "on": False}, "no single choice joins"),
    ({"do": "pair", "pairs": [["plate", "rod"]], "as": "glued"}, "a pair is 'glued'"),
    ({"do": "friction", "mu": -1}, "the friction coefficient is -1"),
    ({"do": "friction", "mu": "much"}, "give a number"),
    ({"do": "density", "value": 0}, "the density is 0"),
    ({"do": "mass", "part": "nut_2", "mass": 1}, "has no volume"),
    ({"do": "load", "part": "rod", "force": [1, 2]}, "has 2 numbers"),
    ({"do": "load", "part": "rod", "force": [1, 2, float("nan")]}, "the force is nan"),
    ({"do": "gravity", "down": [0, 0, 0]}, "is zero"),
    ({"do": "units", "value": "mile"}, "units"),
    ({"do": "hold"}, "a wrong value"),
    ({"do": "assume", "rung": "glued"}, "assume is .glued."),
    ({"do": "assume", "rung": "play", "mu": -1}, "the friction coefficient is -1"),
]


@pytest.mark.parametrize(("action", "said"), WRONG)
def test_a_wrong_action_is_refused_in_a_sentence(action, said):
    with pytest.raises(InputError, match=said):
        apply(action, START, BODIES)


def test_the_positions_of_a_dragged_slider_are_one_change():
    history = History(START, BODIES)
    for drag, values in (("1", (0.1, 0.2, 0.3)), ("2", (0.4, 0.5))):
        for mu in values:
            history.add({"do": "friction", "mu": mu, "live": drag})
    history.add({"do": "friction", "mu": 0.6})
    labels = [change.label for change in history.changes]
    assert labels == ["friction 0.3", "friction 0.5", "friction 0.6"]
    history.go(1)
    assert history.keys["friction"] == 0.3
    history.undo()
    assert history.keys == START


def test_a_revert_keeps_the_other_changes_of_the_same_key():
    history = History(START, BODIES)
    history.add({"do": "hold", "parts": ["plate"], "on": True})
    history.add({"do": "hold", "parts": ["nut_1"], "on": True})
    history.revert(0)
    assert history.keys["held"] == ["nut_1"]
    history.redo()
    assert history.keys["held"] == ["nut_1", "plate"]


def test_a_change_that_a_later_change_needs_is_not_reverted():
    history = History(START, BODIES)
    history.add({"do": "load", "part": "nut_1", "force": [0, 0, -5]})
    history.add({"do": "load_off", "index": 0})
    with pytest.raises(InputError, match="a later change needs"):
        history.revert(0)
    assert len(history.changes) == 2


@pytest.mark.parametrize("seed", range(6))
def test_undo_and_redo_are_inverse_and_the_file_keeps_them(seed):
    rng = random.Random(seed)
    history = History(START, BODIES)
    seen = [history.keys]
    for _ in range(30):
        action = rng.choice(EFFECTS)[0]
        try:
            history.add(action)
        except InputError:
            continue
        seen.append(history.keys)
    count = len(history.changes)
    assert count == len(seen) - 1
    for k in rng.sample(range(count + 1), 5):
        history.go(k)
        assert history.keys == seen[k]
        again = History.from_text(history.to_text().encode(), BODIES)
        assert again.keys == history.keys
        again.go(count)
        assert again.keys == seen[-1]


def test_a_damaged_file_of_changes_is_refused():
    for text in (b"", b"{}", b'{"kilter_workbench": 1}', b'{"kilter_workbench": 1, "base": {}}'):
        with pytest.raises(InputError):
            History.from_text(text, BODIES)


def test_a_change_has_a_label():
    assert Change({"do": "floor", "on": True}, "floor").label == "floor"


EMPTY_STEP = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A folder in a file system of 256 kB with Figure 8."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = shutil.which("mount")
    words = [mount or "", "-t", "tmpfs", "-o", "size=256k", "tmpfs", str(place)]
    if mount is None or subprocess.run(words, capture_output=True, check=False).returncode:
        pytest.skip("mounting a small file system is not allowed here")
    kilter.dump(scene("paper-figure-8"), place / "f8.kilter.json")
    yield place
    subprocess.run(["umount", "-l", str(place)], check=True)


def fill(place: Path) -> Path:
    """Fill a file system with a single file."""
    path = place / "filler"
    with path.open("wb", buffering=0) as file:
        try:
            while file.write(os.urandom(4096)):
                pass
        except OSError:
            return path
    return path


@pytest.mark.slow
def test_on_a_full_disk_no_choice_is_lost_and_a_sentence_states_it(small_disk):
    with Workbench(small_disk / "f8.kilter.json") as bench:
        page = Page(bench)
        page.opened()
        page.after(do="friction", mu=0.4)
        assert page.say(do="save")["saved"] == "f8.choices.kilter.json"
        saved = (small_disk / "f8.choices.kilter.json").read_bytes()
        filler = fill(small_disk)
        # the change is answered, though it cannot be kept beside the file
        held = page.after(do="hold", parts=["C3"], on=True)
        expected = kilter.check(scene("paper-figure-8").with_grounded(["C3"]).with_friction(0.4))
        assert held["check"]["verdict"] == expected.verdict
        assert "not kept beside the file" in page.last["session"]["message"]
        assert "No space left" in page.last["session"]["message"]
        reply = page.say(do="save")
        assert not reply["ok"]
        assert "No space left" in reply["error"]
        # neither the saved choices nor the session are damaged
        assert (small_disk / "f8.choices.kilter.json").read_bytes() == saved
        assert page.last["session"]["choices"]["held"] == ["C3"]
        assert page.last["session"]["dirty"]
        # with space again, the next change keeps all, and saving works
        filler.unlink()
        page.after(do="loose", on=True)
        assert page.last["session"]["message"] == ""
        assert page.say(do="save")["ok"]
        page.close()
    choices = json.loads((small_disk / "f8.choices.kilter.json").read_text())
    assert (choices["held"], choices["friction"]) == (["C3"], 0.4)
    with Workbench(small_disk / "f8.kilter.json") as bench:
        page = Page(bench)
        page.opened()
        assert len(page.last["session"]["changes"]) == 3
        page.close()


@pytest.mark.slow
def test_a_missing_extra_is_named_with_its_installation(page, bench, folder, monkeypatch):
    assert bench.session is not None
    monkeypatch.setattr(session, "find_spec", lambda name: None)
    page.after(do="hold", parts=["C3"], on=True)
    missing = page.last["session"]["missing"]
    assert any('pip install "kilter[step]"' in sentence for sentence in missing)
    assert any('pip install "kilter[figures]"' in sentence for sentence in missing)
    monkeypatch.undo()
    page.after(do="undo")
    present = {"OCP": "step", "matplotlib": "figures"}
    for module, extra in present.items():
        installed = session.find_spec(module) is not None
        named = any(f"kilter[{extra}]" in s for s in page.last["session"]["missing"])
        assert named != installed


@pytest.mark.slow
def test_a_step_file_without_the_extra_names_the_installation(folder, monkeypatch, tmp_path):
    """The processes that read files begin with a module that hides the STEP reader."""
    (tmp_path / "sitecustomize.py").write_text("import sys\nsys.modules['OCP'] = None\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    (folder / "part.step").write_text(EMPTY_STEP)
    with Workbench(None, folder=folder) as bench:
        page = Page(bench)
        reply = page.say(do="open", file="part.step")
        page.close()
    assert not reply["ok"]
    assert "kilter[step]" in f"{reply['error']} {reply['hint']}"


class _Text(HTMLParser):
    """The words of a page that a reader sees, without programs and styles."""

    def __init__(self) -> None:
        super().__init__()
        self.words: list[str] = []
        self._skipped = 0

    def handle_starttag(self, tag: str, attrs: object) -> None:
        self._skipped += tag in ("script", "style")

    def handle_endtag(self, tag: str) -> None:
        self._skipped -= tag in ("script", "style")

    def handle_data(self, data: str) -> None:
        if not self._skipped:
            self.words.append(data)


def words_of(html: str) -> str:
    """The visible words of HTML, separated by single spaces."""
    parser = _Text()
    parser.feed(html)
    return re.sub(r"\s+", " ", " ".join(parser.words)).strip()


@pytest.mark.slow
@pytest.mark.parametrize(
    "actions",
    [
        [{"do": "hold", "parts": ["C3"], "on": True}],
        [{"do": "friction", "mu": 0.4}, {"do": "load", "part": "C3", "force": [0, 0, -5]}],
        [{"do": "leave_out", "parts": ["C3"], "on": True}],
    ],
    ids=["held", "friction", "left out"],
)
def test_the_report_of_a_state_has_the_words_of_the_page(actions, page, folder, monkeypatch):
    for action in actions:
        page.after(**action)
    shown = page.last["answer"]
    saved = page.say(do="save")["saved"]
    monkeypatch.chdir(folder)
    assert main(["report", saved, "-o", "state.html", "--quiet"]) == 0
    text = (folder / "state.html").read_text(encoding="utf-8")
    script = re.search(r'<script id="data" type="application/json">(.*?)</script>', text)
    assert script is not None
    data = json.loads(script[1])
    for key in ("verdict", "sentence", "level", "words", "moves", "down"):
        assert data["given"][key] == shown["given"][key], key
    # each line of the answer in full stands in both pages
    offline, live = words_of(text), words_of(shown["html"])
    assert shown["given"]["sentence"] in live
    assert len(shown["facts"]) > 5
    for term, words in shown["facts"]:
        line = re.sub(r"\s+", " ", f"{term} {words}")
        assert line in live
        assert line in offline


@pytest.mark.parametrize("pair", ["ab", ["a"], [1, 2], {"a": 1}, 3])
def test_a_wrong_pair_of_a_range_is_a_sentence(pair):
    assembly = scene("tower")
    prepared = Prepared(assembly, kilter.contacts(assembly), Tolerance(), ())
    with pytest.raises(InputError, match="the pair is"):
        tab_data(
            "forces",
            prepared,
            START,
            {"between": pair},
            saved=None,
            center=np.zeros(3),
            progress=lambda words: None,
        )


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({}, "no support moves"),
        ({"moved": ["base"]}, "no support moves"),
        ({"moved": {"base": [0, 0, "down"]}}, "the movement is"),
        ({"moved": {"base": 1}}, "the movement is"),
        ({"moved": {"base": [0, 1]}}, "base"),
        ({"moved": {"cube-1": [0, 0, 0.001]}}, "'cube-1' is not held"),
    ],
)
def test_a_wrong_movement_of_a_support_is_a_sentence(options, said):
    assembly = scene("tower")
    prepared = Prepared(assembly, kilter.contacts(assembly), Tolerance(), ())
    with pytest.raises(InputError, match=said):
        tab_data(
            "supports",
            prepared,
            START,
            options,
            saved=None,
            center=np.zeros(3),
            progress=lambda words: None,
        )


def test_a_joint_may_decide_unless_a_known_motion_does_not_need_it():
    """Of a pair that falls as a single body a joint stops nothing; without a motion it may."""
    table = Part("table", Box([9, 9, 1]), [0, 0, -0.5], grounded=True)
    low = Part("low", Box([1, 1, 1]), [0, 0, 2.5])
    high = Part("high", Box([1, 1, 1]), [0, 0, 3.5])
    verdict = kilter.check(Assembly([table, low, high]))
    moves = _relative_motion(verdict)
    assert (moves("low", "high"), moves("low", "table")) == (False, True)
    may = kilter.check(scene("bracket"))
    assert may.verdict == "potentially-stable"
    assert _relative_motion(may)(*may.assembly.names[:2])
