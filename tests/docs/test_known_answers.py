"""The page of known answers says what kilter finds today, of every case."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from kilter.scenes.balance import CASES, ROLLING

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = DOCS / "known-answers.md"


def test_each_case_has_a_row() -> None:
    rows = re.findall(r"^\| (R?\d+b?) \| (.*?) \|", PAGE.read_text(encoding="utf-8"), flags=re.M)
    assert rows == [(case.number, case.title) for case in [*CASES, *ROLLING]]


@pytest.mark.slow
def test_the_page_is_what_is_found_today() -> None:
    """``python docs/build_known_answers.py`` writes it anew."""
    source = (DOCS / "build_known_answers.py").read_text(encoding="utf-8")
    space: dict[str, object] = {"__name__": "written", "__file__": str(DOCS / "x.py")}
    exec(compile(source, "build_known_answers.py", "exec"), space)
    assert space["page"]() == PAGE.read_text(encoding="utf-8")  # type: ignore[operator]
