"""Each number of each answer has a test with a second source, or is a convention of kilter."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "docs"))

import pytest
from build_second_sources import PAGE, ROOT, entries, matches, names_in, numeric_keys, page

KEYS = numeric_keys()
ROWS = entries()


def test_each_number_has_one_entry():
    named = {
        key: [row for row in ROWS if any(matches(p, key) for p in row["keys"])] for key in KEYS
    }
    assert [key for key, rows in named.items() if not rows] == []
    assert [key for key, rows in named.items() if len(rows) > 1] == []


def test_no_entry_has_a_key_that_no_answer_has():
    patterns = [pattern for row in ROWS for pattern in row["keys"]]
    assert len(patterns) == len(set(patterns))
    assert [p for p in patterns if not any(matches(p, key) for key in KEYS)] == []


def test_each_entry_names_a_test_that_exists_or_the_reason_of_a_convention():
    for row in ROWS:
        assert set(row) in ({"keys", "test", "by"}, {"keys", "why"}), row
        if "test" in row:
            path, _, name = row["test"].partition("::")
            assert name.startswith("test_")
            assert name in names_in(path), row["test"]


def test_the_page_is_built_from_the_table():
    assert PAGE.read_text(encoding="utf-8") == page()


@pytest.mark.parametrize(
    ("pattern", "key", "same"),
    [
        ("check.z", "check.z", True),
        ("*.z", "orient.z", True),
        ("*.z", "check.parts.z", False),
        ("margin.*.residual", "margin.tilt_limit.residual", True),
    ],
)
def test_a_star_stands_for_one_name(pattern, key, same):
    assert matches(pattern, key) is same


def test_the_numbers_of_schemas_are_found():
    assert {"check.parts.acceleration", "settle.seconds", "scene.counts.<name>"} <= set(KEYS)
    assert ROOT.joinpath("tests/second_sources.toml").is_file()
