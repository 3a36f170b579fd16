"""Streams that are closed, full, or read by nobody: one sentence, and a code that says how."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import kilter
from kilter.scenes import scene

pytestmark = pytest.mark.skipif(not Path("/dev/full").exists(), reason="/dev/full of Linux")


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("streams")
    kilter.dump(scene("slope"), folder / "slope.kilter.json")
    (folder / "no.kilter.json").write_text('{"kilter": 1}', "utf-8")
    return folder


def ended(files: Path, words: str, redirect: str) -> tuple[int, str]:
    """Exit code and error stream of a command under a shell's redirection."""
    shell = f'cd "{files}" && exec "{sys.executable}" -m kilter {words} {redirect}'
    run = subprocess.run(["sh", "-c", shell], capture_output=True, text=True, timeout=60)
    return run.returncode, run.stderr


@pytest.mark.slow
@pytest.mark.parametrize(
    "words",
    [
        "check slope.kilter.json",
        pytest.param("check slope.kilter.json --json", marks=pytest.mark.slow),
        pytest.param("example", marks=pytest.mark.slow),
        pytest.param("--version", marks=pytest.mark.slow),
    ],
)
def test_a_full_output_is_one_sentence(files: Path, words: str) -> None:
    code, error = ended(files, words, "> /dev/full")
    assert code == 2
    assert error == (
        "kilter: the answer cannot be written: No space left on device; write to another place\n"
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "redirect",
    [
        ">&- 2>&- <&-",
        *(pytest.param(one, marks=pytest.mark.slow) for one in (">&-", "2>&-", "2> /dev/full")),
    ],
)
def test_the_code_says_it_where_a_stream_is_closed(files: Path, redirect: str) -> None:
    assert ended(files, "check slope.kilter.json", redirect)[0] == 1
    assert ended(files, "check no.kilter.json", redirect)[0] == 2


@pytest.mark.slow
def test_closed_streams_are_no_place_for_files(files: Path) -> None:
    """What is opened first gets the number of a closed stream, and what libraries print with it."""
    proof = files / "proof.json"
    assert ended(files, "check slope.kilter.json --proof proof.json", ">&- 2>&-")[0] == 1
    assert kilter.verify(files / "slope.kilter.json", proof).holds


@pytest.mark.slow
def test_nothing_comes_from_a_closed_input(files: Path) -> None:
    code, error = ended(files, "check -", "<&-")
    assert code == 2
    assert error.startswith("kilter: standard input: the file is empty")


@pytest.mark.slow
def test_a_pipe_that_nobody_reads_is_no_fault(files: Path) -> None:
    out, into = os.pipe()
    os.close(out)
    words = [sys.executable, "-m", "kilter", "contacts", str(files / "slope.kilter.json")]
    run = subprocess.run(words, stdout=into, stderr=subprocess.PIPE, text=True, timeout=60)
    os.close(into)
    assert (run.returncode, run.stderr) == (0, "")
