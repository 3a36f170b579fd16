"""A workbench whose process serves all tests of a module, and a page with Figure 8 opened anew."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from driver import Page

import kilter
from kilter.scenes import scene
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
    """The changes of an uploaded file are kept in the user's folder: each test has its own."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


@pytest.fixture
def page(bench: Workbench, folder: Path) -> Iterator[Page]:
    for path in folder.iterdir():
        path.unlink()
    kilter.dump(scene("paper-figure-8"), folder / "f8.kilter.json")
    link = Page(bench)
    assert link.say(do="open", file="f8.kilter.json")["ok"]
    link.answer()
    yield link
    link.close()
