"""Pages that programs write, features and defaults, are as the tests and the code give them."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs"))

from build_defaults import PAGE as DEFAULTS
from build_defaults import page as defaults_page
from build_features import MISSING, PAGE, page, sections


def test_the_page_is_built_from_the_names_of_the_tests():
    assert PAGE.read_text(encoding="utf-8") == page()


def test_the_page_has_features_and_what_is_missing():
    rows = sections()
    assert len(rows[MISSING]) >= 4
    assert sum(map(len, rows.values())) >= 25


def test_the_page_of_defaults_has_those_of_the_code():
    assert DEFAULTS.read_text(encoding="utf-8") == defaults_page()
    assert "| `require` | `'settles'` |" in defaults_page()
