"""The command `view`: its address, first choices, end, and faults of its arguments."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import kilter
from kilter.cli import main
from kilter.scenes import scene
from kilter.workbench.server import folder_of

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
def test_ctrl_c_ends_it_well(tmp_path: Path, shell: str) -> None:
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
def test_a_killed_server_leaves_no_process(tmp_path: Path) -> None:
    kilter.dump(scene("tower"), tmp_path / "tower.kilter.json")
    with serving(tmp_path, "tower.kilter.json") as (process, _):
        workers = wait_for_child(process.pid)
        process.kill()
        process.wait()
        wait_until_gone(workers)


@pytest.mark.slow
def test_options_are_the_first_choices(tmp_path: Path) -> None:
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
def test_a_wrong_file_is_a_sentence_on_the_page(tmp_path: Path) -> None:
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
def test_a_wrong_argument_is_refused(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["view", *words]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.skipif(os.name != "posix", reason="links of POSIX")
def test_a_link_out_of_the_folder_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("sent", "own"):
        (tmp_path / name).mkdir()
    kilter.dump(scene("tower"), tmp_path / "own" / "tower.kilter.json")
    link = tmp_path / "sent" / "link.kilter.json"
    link.symlink_to(tmp_path / "own" / "tower.kilter.json")
    assert main(["view", str(link), "--no-browser"]) == 2
    assert "leads out of the opened folder" in capsys.readouterr().err
    assert os.listdir(tmp_path / "own") == ["tower.kilter.json"]


def test_the_opened_folder_is_that_of_the_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
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
def test_all_addresses_are_a_warning(tmp_path: Path, every: bool) -> None:
    words = ["--host", "0.0.0.0"] if every else []
    with serving(tmp_path, *words) as (process, url):
        with urllib.request.urlopen(url, timeout=20) as page:
            assert b"kilter" in page.read()
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=ENDS)
        assert ("warning: other computers can reach this page" in errors) == every


@pytest.mark.slow
def test_changes_that_cannot_be_kept_are_named_and_answered(tmp_path: Path) -> None:
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
