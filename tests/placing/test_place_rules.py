"""Rules of packing programs beside kilter: `benchmarks/place_rules.py` and its table."""

from __future__ import annotations

import importlib.util
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "benchmarks" / "place_rules.py"
PAGE = ROOT / "docs" / "placing.md"
PICTURE = ROOT / "docs" / "images" / "place-rules.svg"


@pytest.fixture(scope="module")
def benchmark() -> Iterator[ModuleType]:
    spec = importlib.util.spec_from_file_location("place_rules", FILE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look up their module there
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


def counts_of_page(benchmark: ModuleType):
    """The counts in the table of the page."""
    text = PAGE.read_text(encoding="utf-8")
    counts = benchmark.RuleCounts()
    [(stands, total)] = re.findall(r"stands at ([\d,]+) of ([\d,]+) places", text)
    counts.stands = int(stands.replace(",", ""))
    counts.falls = int(total.replace(",", "")) - counts.stands
    for rule in benchmark.RULES:
        row = rf"^\| {re.escape(rule)} \| ([\d,]+) \| \d+ % \| ([\d,]+) \| \d+ % \|$"
        [(falls, rejected)] = re.findall(row, text, flags=re.M)
        counts.accepted_falls[rule] = int(falls.replace(",", ""))
        counts.rejected_stands[rule] = int(rejected.replace(",", ""))
    return counts


def test_rules_and_program_on_a_counterbalanced_plank(benchmark: ModuleType) -> None:
    """A load x beyond the edge stands up to W (L / 2 - e) / w = 0.16; LBCP ends at the edge."""
    block, plank = [0, 0, 0, 1, 1, 0.5], [0.3, 0, 0.5, 1, 1, 0.125]
    for beyond, stands, bearing in (
        (-0.01, True, True),
        (0.159, True, False),
        (0.161, False, False),
    ):
        load = [1 + beyond - 0.0005, 0.4995, 0.625, 0.001, 0.001, 0.125]
        boxes = np.array([block, plank, load])
        assert benchmark.balanced(boxes, np.array([5, 2, 2.5])) is stands
        answer = benchmark.answers(boxes, benchmark.load_bearing(boxes[:2]))
        assert answer["LBCP"] is bearing
        assert answer["full support"]


def test_the_table_and_picture_of_the_page_are_those_of_the_command(benchmark: ModuleType) -> None:
    counts = counts_of_page(benchmark)
    assert counts.stands + counts.falls <= 60 * benchmark.PLACES
    assert benchmark.table(counts) in PAGE.read_text(encoding="utf-8")
    assert benchmark.figure(counts) == PICTURE.read_text(encoding="utf-8")


def test_undecided_places_have_a_reason(benchmark: ModuleType) -> None:
    counts = benchmark.RuleCounts(undecided=2, gaps=[1.3e-4, 4e-4])
    assert benchmark.undecided_words(counts).startswith("2 places undecided (the pile holds only")
    assert "0.13 to 0.40 mm apart" in benchmark.undecided_words(counts)
    assert benchmark.undecided_words(benchmark.RuleCounts()) == "0 places undecided"
