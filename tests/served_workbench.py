"""Fixtures of all tests of the workbench: its folder, its server, and the user's own folder."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from kilter.workbench.server import Workbench


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("workbench")


@pytest.fixture(scope="module")
def bench(folder: Path) -> Iterator[Workbench]:
    with Workbench(None, folder=folder) as workbench:
        yield workbench


@pytest.fixture(autouse=True)
def no_earlier_session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The changes of a dropped file are kept in the user's folder: each test has its own."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
