"""A workbench whose process serves all tests of a module, and a page with Figure 8 opened anew."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from driver import Page

import kilter
from kilter.scenes import scene
from kilter.workbench.server import Workbench
from served_workbench import bench, folder, no_earlier_session  # noqa: F401  fixtures


@pytest.fixture
def page(bench: Workbench, folder: Path) -> Iterator[Page]:
    link = Page(bench)
    link.say(do="close")  # else the changes of an open file are kept for the file that replaces it
    for path in folder.iterdir():
        path.unlink()
    kilter.dump(scene("paper-figure-8"), folder / "f8.kilter.json")
    assert link.say(do="open", file="f8.kilter.json")["ok"]
    link.answer()
    yield link
    link.close()
