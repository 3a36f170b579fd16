"""`kilter check --watch`: an answer after each change of the file, and what changed."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.cli import main
from kilter.cli.exit_codes import USAGE


def stacked(x: float) -> Assembly:
    """A block on a held base, its middle at x; it tips beyond .5."""
    base = Part("base", Box([1, 1, 1]), Pose([0, 0, -0.5]), grounded=True)
    return Assembly([base, Part("block", Box([1, 1, 1]), Pose([x, 0, 0.5]))], friction=0.5)


@pytest.mark.skipif(os.name != "posix", reason="an interruption of another process")
def test_each_change_is_answered_and_compared(tmp_path):
    path = tmp_path / "file.kilter.json"
    kilter.dump(stacked(0.4), path)
    command = [sys.executable, "-m", "kilter", "check", str(path), "--watch"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as run:
        assert run.stderr is not None
        assert run.stdout is not None

        def wait() -> None:
            for line in run.stderr:  # type: ignore[union-attr]
                if "watching" in line or "waiting for the next change" in line:
                    return
            raise AssertionError("the command ended")

        wait()
        kilter.dump(stacked(0.7), path)
        wait()
        path.write_text("{")
        wait()
        kilter.dump(stacked(0.3), path)
        wait()
        run.send_signal(signal.SIGINT)
        out = run.stdout.read()
        assert run.wait(20) == 0  # the code of the last answer: it holds
    assert "was: stable; now: unstable (block moves)" in out
    assert "was: unstable (block moves); now: stable" in out


@pytest.mark.parametrize("files", [["scene:tower"], ["missing.step"], ["-"]])
def test_a_file_is_needed(files, capsys):
    assert main(["check", *files, "--watch"]) == USAGE
    assert "--watch needs a file that exists" in capsys.readouterr().err


def test_a_single_file_is_watched(tmp_path, capsys):
    paths = [str(tmp_path / f"{k}.kilter.json") for k in range(2)]
    for path in paths:
        kilter.dump(stacked(0.2), Path(path))
    assert main(["check", *paths, "--watch"]) == USAGE
    assert "--watch" in capsys.readouterr().err
