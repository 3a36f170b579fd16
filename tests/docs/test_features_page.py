"""The page of features is the one that the names of its tests give."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs"))

from build_features import MISSING, PAGE, page, sections


def test_the_page_is_built_from_the_names_of_the_tests() -> None:
    assert PAGE.read_text(encoding="utf-8") == page()


def test_the_page_has_features_and_what_is_missing() -> None:
    rows = sections()
    assert len(rows[MISSING]) >= 4
    assert sum(map(len, rows.values())) >= 25
