"""The fall of a balanced assembly on its page: playing, slider, poses as in Python, energy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from balance_cases import CASES
from scipy.spatial.transform import Rotation
from test_motion_in_chromium import depths, moved

import kilter
from kilter import Assembly, Part, Pose, Sphere
from kilter.scenes import scene
from kilter.second_order.answer.path_places import find_path_places

pytestmark = pytest.mark.browser

NAME = "paper-figure-1-in-space"
ROWS = (
    "() => { const d = window.kilter.stage.parts.data; return Array.from({length:"
    " window.kilter.page.parts.names.length}, (_, k) => [...d.subarray(16 * k, 16 * k + 7)]); }"
)


def balls() -> Assembly:
    base = Part("base", Sphere(1.0), grounded=True)
    return Assembly([base, Part("ball", Sphere(0.5), Pose([0, 0, 1.5]), mass=2.0)])


def test_parts_are_drawn_at_the_places_of_the_path(opened: Callable) -> None:
    assembly = scene(NAME)
    verdict = kilter.check(assembly)
    assert verdict.second_order_answer is not None
    path = find_path_places(assembly, verdict.second_order_answer)
    assert path is not None
    page = opened(NAME)
    assert page.js("document.getElementById('fall').hidden") is False
    rest = np.array(page.js(ROWS))
    center, middles = page.js("window.kilter.page.center"), assembly.geometry.center
    for k in (0, len(path.lengths) // 2, len(path.lengths) - 1):
        page.slide("fall-at", path.lengths[k] / path.lengths[-1])
        places = np.array(page.js(ROWS))
        arms = rest[:, 4:7] + center - middles
        turns = Rotation.from_rotvec(path.motions[k, :, 3:])
        wanted = middles + path.motions[k, :, :3] + turns.apply(arms)
        places[:, 4:7] += center
        np.testing.assert_allclose(places[:, 4:7], wanted, atol=1e-5)
        assert max(depths(moved(assembly, places)).values(), default=0.0) < 1e-3
    assert page.text("fall-place").endswith("J")


def test_play_goes_to_the_end_and_the_mark_with_it(opened: Callable) -> None:
    page = opened(balls())
    mark = "document.querySelector('#fall-graph .mark').getAttribute('cx') * 1"
    before = page.js(mark)
    page.js("document.getElementById('fall-play').click()")
    assert page.js("document.getElementById('fall-play').textContent") == "Pause"
    page.until("window.kilter.fell === 1")
    assert page.js(mark) > before + 100
    assert page.js("document.getElementById('fall-play').textContent") == "Play"
    assert page.js("document.getElementById('fall-at').getAttribute('aria-valuetext')").endswith(
        "J"
    )
    assert "unless friction holds it" in page.js("document.getElementById('fall').textContent")
    # other directions of gravity have no path
    page.js("window.kilter.ask([0.3, 0, -1])")
    assert page.js("document.getElementById('fall').hidden") is True
    page.js("window.kilter.ask([0, 0, -1])")
    assert page.js("window.kilter.fell") == 0


def test_without_shapes_the_page_shows_how_it_begins(opened: Callable) -> None:
    page = opened(next(case for case in CASES if case.number == "02").build(0.0))
    assert page.js("document.getElementById('fall').hidden") is True
    assert page.js("document.getElementById('motion').disabled") is False
    assert page.js("document.getElementById('motion-label').textContent") == "start of the fall"
    before = np.array(page.js(ROWS))
    page.slide("motion", 1.0)
    assert np.abs(np.array(page.js(ROWS)) - before).max() > 1e-2


def test_what_is_no_more_than_stable_has_no_card(opened: Callable) -> None:
    page = opened("tower")
    assert page.js("document.getElementById('fall').hidden") is True
    assert page.js("document.getElementById('motion-row').hidden") is False
