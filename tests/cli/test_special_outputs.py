"""Outputs that are no regular file: devices, pipes and links stay what they are."""

from __future__ import annotations

import os
import stat
import threading
from pathlib import Path

import pytest

import kilter
from kilter.cli import main
from kilter.errors import InputError
from kilter.files.writing import write_bytes
from kilter.scenes import scene

pytestmark = pytest.mark.skipif(os.name != "posix", reason="devices, pipes and links of POSIX")
DATA = b"x" * 300_000
"""More than a pipe holds."""


@pytest.fixture
def tower(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    kilter.dump(scene("tower"), tmp_path / "tower.kilter.json")
    return tmp_path


def kind(path: str | Path) -> tuple[int, int]:
    """Kind and number of a file, which replacing it would change."""
    found = os.lstat(path)
    return stat.S_IFMT(found.st_mode), found.st_ino


def device(path: Path, minor: int) -> None:
    """A device of its own, like /dev/null (3) or /dev/full (7): the test must not harm those."""
    try:
        os.mknod(path, 0o666 | stat.S_IFCHR, os.makedev(1, minor))
        path.write_bytes(b"")
    except OSError:
        pytest.skip("no device can be made here")


@pytest.mark.parametrize("option", ["-o", "--proof"])
@pytest.mark.parametrize(("minor", "code"), [(3, 0), (7, 2)], ids=["null", "full"])
def test_a_device_is_written_into(
    option: str, minor: int, code: int, tower: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    device(tower / "device", minor)
    before = kind("device")
    assert main(["check", "tower.kilter.json", option, "device", "--quiet"]) == code
    assert kind("device") == before
    assert sorted(os.listdir()) == ["device", "tower.kilter.json"]
    if code:
        assert "device: cannot be written: No space left" in capsys.readouterr().err


def test_a_pipe_gets_all_data_and_stays(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(InputError, match=r"pipe: cannot be written: No such device"):
        write_bytes(pipe, DATA)  # without a reader it does not wait
    heard: list[bytes] = []
    keeper = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    reader = threading.Thread(target=lambda: heard.append(pipe.read_bytes()))
    reader.start()
    write_bytes(pipe, DATA)
    os.close(keeper)
    reader.join(20)
    assert b"".join(heard) == DATA
    assert stat.S_ISFIFO(os.lstat(pipe).st_mode)


def test_an_inherited_pipe_is_written_into() -> None:
    """As a shell gives it: `kilter check FILE -o >(program)`."""
    if not Path("/dev/fd").exists():
        pytest.skip("no /dev/fd here")
    out, into = os.pipe()
    write_bytes(f"/dev/fd/{into}", b"answer")
    os.close(into)
    with open(out, "rb") as stream:
        assert stream.read() == b"answer"


def test_a_link_stays_and_its_target_is_written(tower: Path) -> None:
    Path("link").symlink_to("made.json")
    Path("loop").symlink_to("loop")
    before = kind("link")
    assert main(["check", "tower.kilter.json", "--json", "-o", "link", "--quiet"]) == 0
    assert kind("link") == before
    assert Path("made.json").read_bytes().endswith(b"}\n")
    assert main(["check", "tower.kilter.json", "-o", "loop", "--quiet"]) == 2
    assert main(["check", "tower.kilter.json", "-o", "link", "--proof", "made.json"]) == 2


def test_a_name_that_is_too_long_is_a_sentence(
    tower: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    long = "x" * 4000
    for words in (["check", f"{long}.json"], ["check", f"{long}.step"], ["batch", long, "-o", "d"],
                  ["check", "tower.kilter.json", "-o", long]):  # fmt: skip
        assert main([*words, "--quiet"]) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1
        assert len(error) < 500
