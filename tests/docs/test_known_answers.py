"""The page of known answers says what kilter finds today, of every case."""

import dataclasses
import importlib
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
from balance_cases import CASES, ROLLING

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = DOCS / "contributing/known-answers.md"
PICTURES = DOCS / "images" / "known"


def test_each_case_has_a_row():
    rows = re.findall(r"^\| (R?\d+b?) \| (.*?) \|", PAGE.read_text(encoding="utf-8"), flags=re.M)
    assert rows == [(case.number, case.title) for case in [*CASES, *ROLLING]]


@pytest.fixture
def drawing() -> Iterator[ModuleType]:
    """The script that draws; its plain names are free again afterwards."""
    before = set(sys.modules)
    sys.path.insert(0, str(DOCS))
    try:
        yield importlib.import_module("draw_known_answers")
    finally:
        sys.path.remove(str(DOCS))
        for name in set(sys.modules) - before:
            if Path(getattr(sys.modules[name], "__file__", None) or "/").parent == DOCS:
                del sys.modules[name]


def test_each_case_has_its_picture_as_its_scene_is_today(drawing):
    """``python docs/draw_known_answers.py`` draws them anew."""
    cases = [*CASES, *ROLLING]
    assert {path.stem for path in PICTURES.iterdir()} == {case.number for case in cases}
    text = PAGE.read_text(encoding="utf-8")
    for case in cases:
        name = f"{case.number}.svg"
        assert f"](../images/known/{name})" in text
        assert (PICTURES / name).read_text(encoding="utf-8") == drawing.drawn(case), name


def test_what_a_scene_changes_is_seen_in_its_picture(drawing):
    """A limit of another case moves its centre of mass, and the mark beside it."""
    [weeble] = [case for case in CASES if case.number == "09"]
    lower = dataclasses.replace(weeble, limit=0.7)
    assert drawing.drawn(lower) != drawing.drawn(weeble)


@pytest.mark.slow
def test_the_page_is_what_is_found_today():
    """``python docs/build_known_answers.py`` writes it anew."""
    source = (DOCS / "build_known_answers.py").read_text(encoding="utf-8")
    space: dict[str, object] = {"__name__": "written", "__file__": str(DOCS / "x.py")}
    exec(compile(source, "build_known_answers.py", "exec"), space)
    assert space["page"]() == PAGE.read_text(encoding="utf-8")  # type: ignore[operator]
