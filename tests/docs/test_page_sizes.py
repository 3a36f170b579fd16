"""The sizes of pages that docs/report.md states are those of the pages."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import kilter
from kilter.scenes import scene
from kilter.scenes.walls import wall

PAGE = (Path(__file__).resolve().parents[2] / "docs/report.md").read_text(encoding="utf-8")


def stated(pattern: str) -> float:
    [number] = re.findall(pattern, PAGE)
    return float(number)


@pytest.mark.slow
def test_a_cell_has_at_least_the_stated_size() -> None:
    cell = kilter.check(scene("tower")).show()
    least = stated(r"stored in the\nnotebook \(([\d.]+) MB and more\)")
    assert least <= len(cell._repr_html_().encode()) / 1e6 < least + 0.1


@pytest.mark.slow
def test_a_page_of_ten_thousand_bricks_has_the_stated_size() -> None:
    page = kilter.report(wall(100, 100)).html
    size = stated(r"A page of 10,000 bricks has ([\d.]+) MB")
    assert len(page.encode()) / 1e6 == pytest.approx(size, rel=0.1)
