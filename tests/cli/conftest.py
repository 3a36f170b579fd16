"""Fixture of the command line tests: it runs a command within the process of the test."""

import shlex
from typing import Any

import pytest

from kilter.cli import main


@pytest.fixture
def say(capsys: pytest.CaptureFixture[str]) -> Any:
    """Runs a command; returns its exit code, output and messages."""

    def run(line: str) -> tuple[int, str, str]:
        capsys.readouterr()
        code = main(shlex.split(line))
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return run
