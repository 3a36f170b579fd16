"""The page of a map of places in a real browser: the part follows the pointer."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
import shapely

import kilter
from kilter.analysis.placing.place import box_to_place
from kilter.scenes import scene

pytestmark = pytest.mark.browser

WORDS = {"the box stands": "stands", "something falls": "falls", "open": "open"}


def test_the_part_follows_the_pointer(opened: Callable, tmp_path: Path) -> None:
    places = kilter.place(scene("tower"), box_to_place([0.5, 0.5, 0.5], 1.0))
    kilter.report(places, tmp_path / "map.html")
    page = opened(tmp_path / "map.html")
    assert page.text("place-state") == "move the pointer over the map"
    page.page.select_option("#view", "top")
    page.page.wait_for_timeout(500)
    box = page.page.locator("#picture").bounding_box()
    assert box is not None
    answers = set()
    for share in (0.0, 0.02, 0.05, 0.08, 0.11, 0.14, 0.17, 0.2):
        page.page.mouse.move(box["x"] + (0.5 + share) * box["width"], box["y"] + box["height"] / 2)
        page.page.wait_for_timeout(60)
        said = page.text("place-state")
        if not said.startswith("x "):
            continue
        where, words = said.split(": ")
        point = shapely.Point(*(float(each.split()[1]) for each in where.split(", ")))
        state = WORDS[words]
        answers.add(state)
        [level] = places.levels
        # the words have four digits of the place
        assert getattr(level, state).buffer(2e-3).contains(point), said
    assert answers >= {"stands", "falls"}
    assert page.js("window.kilter.stage.places.group.visible")
    page.js("window.kilter.turn([0, 1, 0])")
    assert not page.js("window.kilter.stage.places.group.visible")
    assert not page.faults
