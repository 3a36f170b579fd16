"""Files that commands write: whole or as before, killed at any moment, without room or rights."""

import json
import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from forked import SAID, Commands

import kilter
from kilter.scenes import scene

pytestmark = pytest.mark.skipif(os.name != "posix", reason="processes of POSIX")

FILE, SLIDES, BRICKS = "tower.kilter.json", "slope.kilter.json", "stair.txt"
PACKED = "packed.csv"
WRITERS = {
    "proof.json": ["check", FILE, "--quiet", "--proof"],
    "check.json": ["check", FILE, "--quiet", "--json", "-o"],
    "check.txt": ["check", FILE, "--quiet", "-o"],
    "region.json": ["region", FILE, "--quiet", "--proof"],
    "margin.json": ["margin", FILE, "--quiet", "--proof"],
    "transport.json": ["transport", FILE, "--quiet", "--proof"],
    "orient.json": ["orient", FILE, "--quiet", "--json", "-o"],
    "contacts.json": ["contacts", FILE, "--quiet", "--json", "-o"],
    "improve.json": ["improve", BRICKS, "--quiet", "--write"],
    "hold.json": ["hold", FILE, "--quiet", "--json", "-o"],
    "plan.json": ["plan", FILE, "--quiet", "--json", "-o"],
    "plan.csv": ["plan", FILE, "--quiet", "-o"],
    "plan.html": ["plan", FILE, "--quiet", "-o"],
    "plan.glb": ["plan", FILE, "--quiet", "-o"],
    "report.html": ["report", FILE, "--quiet", "-o"],
    "place.json": ["place", FILE, "--quiet", "--json", "--box", ".5x.5x.5", "--mass", "1", "-o"],
    "scene.json": ["scene", FILE, "--quiet", "--json", "-o"],
    "settle.svg": ["settle", FILE, "--quiet", "-o"],
    "packed.json": ["check-plan", PACKED, "--quiet", "--json", "-o"],
    "draw.svg": ["draw", FILE, "--quiet", "-o"],
    "draw.png": ["draw", FILE, "--quiet", "-o"],
    "draw.glb": ["draw", SLIDES, "--quiet", "-o"],
    "choices.json": ["save", FILE, "--quiet", "--ground", "cube-1", "-o"],
    "example.kilter.json": ["example", "wall", "--force", "-o"],
}
"""Commands by the file that each writes."""
OLD = b"an answer of before\n"
OLD_CHOICES = b'{"kilter": 1, "file": "tower.kilter.json"}\n'
"""An earlier file of save, which replaces choices only."""
ENDS = {
    ".json": b"}\n",
    ".html": b"</html>",
    ".svg": b"</svg>",
    ".png": b"IEND\xaeB`\x82",
    ".csv": b"\n",
    ".txt": b"\n",
}
"""What a whole file ends with."""


@pytest.fixture(scope="module")
def commands() -> Iterator[Commands]:
    found = Commands()
    yield found
    found.end()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A tower of three cubes, a block that slides, two bricks: all is soon done."""
    kilter.dump(scene("tower"), tmp_path / FILE)
    kilter.dump(scene("slope"), tmp_path / SLIDES)
    (tmp_path / PACKED).write_text(
        "length,width,height,mass,x,y,z\n1,1,1,1,0,0,0\n", encoding="utf-8"
    )
    (tmp_path / BRICKS).write_text("4x2 (0,0,0)\n4x2 (2,0,1)\n", encoding="utf-8")
    return tmp_path


def old_content(name: str) -> bytes:
    """Content of the earlier file that a command replaces."""
    return OLD_CHOICES if name == "choices.json" else OLD


def whole(path: Path) -> bool:
    """It is there to its end."""
    data = path.read_bytes()
    if path.suffix == ".glb":
        return data[:4] == b"glTF" and int.from_bytes(data[8:12], "little") == len(data)
    if path.suffix == ".json":
        json.loads(data)
    return data.rstrip(b"\n").endswith(ENDS[path.suffix].rstrip(b"\n"))


def test_every_command_that_writes_is_here():
    from kilter.cli.commands import COMMANDS

    # batch: tests/cli/test_batch.py; mcp: tests/agents
    quiet = {"view", "verify", "batch", "doctor", "mcp"}
    assert {words[0] for words in WRITERS.values()} == set(COMMANDS) - quiet


@pytest.mark.slow
@pytest.mark.parametrize("name", WRITERS)
def test_a_command_that_is_killed_leaves_a_whole_file_or_the_old_one(
    name, commands, folder, request
):
    """At any of many moments, half of them near the end, where files are written."""
    kills = request.config.getoption("--kills")
    words, target, old = [*WRITERS[name], name], folder / name, old_content(name)
    took = min(commands.run(words, folder)[1] for _ in range(3))
    assert whole(target)
    rng, kept = np.random.default_rng(len(name)), 0
    for k in range(kills):
        before = k % 2 == 0
        target.write_bytes(old) if before else target.unlink(missing_ok=True)
        after = rng.uniform(0.0 if k % 4 < 2 else 0.6 * took, 1.1 * took)
        code, _ = commands.run(words, folder, after=after, number=signal.SIGKILL)
        kept += code == -signal.SIGKILL
        if target.exists() and (target.read_bytes() != old or not before):
            assert whole(target), f"killed after {after} s"
        else:
            assert target.exists() == before
            assert code == -signal.SIGKILL
    assert kept  # some of the moments came before the end; on a busy machine, where times vary, few


STEPS = """
import os, signal, sys
from kilter.files import write_bytes
left = int(sys.argv[2])
def counted(function):
    def called(*given, **named):
        global left
        left -= 1
        if left < 0:
            os.kill(os.getpid(), signal.SIGKILL)
        return function(*given, **named)
    return called
for name in ("open", "fdopen", "fsync", "chmod", "replace", "unlink", "umask"):
    setattr(os, name, counted(getattr(os, name)))
write_bytes(sys.argv[1], b"new" * 100_000)
"""


@pytest.mark.slow
@pytest.mark.parametrize("before", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_a_write_that_is_killed_at_any_of_its_steps(before, tmp_path):
    import sys

    target, ended, step = tmp_path / "a.json", -1, 0
    while ended != 0:
        target.write_bytes(OLD) if before else target.unlink(missing_ok=True)
        run = subprocess.run([sys.executable, "-c", STEPS, str(target), str(step)], timeout=60)
        ended, step = run.returncode, step + 1
        assert ended in (0, -signal.SIGKILL)
        data = target.read_bytes() if target.exists() else None
        assert data in ((OLD if before else None), b"new" * 100_000)
    assert step >= 5
    assert data == b"new" * 100_000


@pytest.mark.slow
@pytest.mark.parametrize("ignored", [False, True], ids=["heard", "inherited as ignored"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("name", WRITERS)
def test_a_command_that_is_asked_to_end_leaves_nothing_beside(
    name, number, ignored, commands, folder
):
    """One line and code 130, or its answer where it had it already."""
    words, target, old = [*WRITERS[name], name], folder / name, old_content(name)
    _, took = commands.run(words, folder)
    rng = np.random.default_rng([len(name), number])
    for _ in range(2):
        target.write_bytes(old)
        after = rng.uniform(0.2, 1.0) * took
        code, _ = commands.run(words, folder, after=after, number=number, ignored=ignored)
        said = (folder / SAID).read_text("utf-8")
        assert "Traceback" not in said
        assert {path.name for path in folder.iterdir()} == {
            FILE,
            SLIDES,
            BRICKS,
            PACKED,
            SAID,
            name,
        }
        if code == 130:
            assert "kilter: interrupted" in said.splitlines()[-1]  # a plan says what it knew so far
            assert target.read_bytes() == old or whole(target)
        elif code == -number:
            assert not ignored  # before it listened: the system ends it
        else:
            assert whole(target), (code, said)


@pytest.fixture(params=["full", "read-only"])
def no_room(request: pytest.FixtureRequest, folder: Path) -> Iterator[Path]:
    """A file system of its own, without room or rights, where one may be mounted."""
    place = folder / "disk"
    place.mkdir()
    try:
        mount = ["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", str(place)]
        subprocess.run(mount, check=True, capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("nothing may be mounted here")
    try:
        for name in WRITERS:
            (place / name).write_bytes(old_content(name))
        if request.param == "full":
            with open(place / "ballast", "wb", buffering=0) as ballast, suppress(OSError):
                while ballast.write(bytes(1024)):
                    pass
        else:
            subprocess.run(["mount", "-o", "remount,ro", str(place)], check=True)
        yield place
    finally:
        subprocess.run(["umount", "-l", str(place)], check=True)


@pytest.mark.slow
def test_without_room_or_rights_the_old_file_stays(no_room, commands):
    """One sentence that says why, and code 2."""
    before = {path.name: path.read_bytes() for path in no_room.iterdir()}
    for name, words in WRITERS.items():
        if words[0] == "save":
            continue  # choices lie in a folder above their file, which is on another disk
        code, _ = commands.run([*words, f"disk/{name}"], no_room.parent)
        said = (no_room.parent / SAID).read_text("utf-8")
        assert (code, said.count("\n")) == (2, 1), said
        assert said.startswith(f"kilter: disk/{name}: cannot be written: ")
        assert "No space left" in said or "Read-only file system" in said
    assert {path.name: path.read_bytes() for path in no_room.iterdir()} == before


@pytest.mark.slow
def test_a_file_that_goes_while_it_is_read_is_one_sentence(commands, folder):
    """Removed, cut, or replaced by a folder, at any moment: an answer, or what is missing."""
    import threading

    words, text = ["check", FILE, "--quiet"], (folder / FILE).read_bytes()
    _, took = commands.run(words, folder)
    rng = np.random.default_rng(0)
    for k in range(60):
        path = folder / FILE
        shutil.rmtree(path, ignore_errors=True)
        path.unlink(missing_ok=True) if path.is_file() else None
        path.write_bytes(text)

        def goes(path: Path = path, way: int = k % 3) -> None:
            if way == 1:
                os.truncate(path, len(text) // 2)
                return
            path.unlink()
            if way == 2:
                path.mkdir()

        timer = threading.Timer(rng.uniform(0, took), goes)
        timer.start()
        code, _ = commands.run(words, folder)
        timer.join()
        said = (folder / SAID).read_text("utf-8")
        assert code in (0, 2), said
        assert "Traceback" not in said
        if code == 2:
            assert said.count("\n") == 1
            assert said.startswith(f"kilter: {FILE}: ")
