"""The page of a plan in a real browser: playing, slider, and agreement with Python."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter.scenes import scene
from kilter.scenes.arches import arch

pytestmark = pytest.mark.browser

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
PARTS = "window.kilter.stage.parts"
SHOWN = f"Array.from({{length: {PARTS}.count}}, (_, k) => k).filter(k => {PARTS}.shown(k))"
PAINTED = "new Set([...document.querySelectorAll('#strip canvas')].map(c => c.toDataURL())).size"


@pytest.fixture(scope="module")
def built() -> kilter.Order:
    return kilter.plan(arch(9, ratio=0.3, friction=0.6, planar=False))


def page_of(order: kilter.Order, folder: Path) -> Path:
    kilter.report(order, folder / "plan.html")
    return folder / "plan.html"


def test_it_plays_from_the_base_to_the_whole(
    built: kilter.Order, opened: Callable, tmp_path: Path
) -> None:
    page = opened(page_of(built, tmp_path))
    assert page.text("when") == "step 1 of 9"
    assert len(page.js(SHOWN)) == 3  # the base of two parts, and the first part near its place
    page.page.select_option("#pace", "4")
    page.page.click("#play")
    page.until("window.kilter.time > 0 && window.kilter.time < 4")
    assert len(page.js(SHOWN)) < 8
    page.until("window.kilter.time > 4.5")
    assert page.text("play") == "Pause"
    page.until("document.getElementById('play').textContent === 'Play'", 60)
    assert page.text("when") == "assembled"
    assert len(page.js(SHOWN)) == 11


def test_scrubbing_shows_each_step_and_what_it_holds(
    built: kilter.Order, opened: Callable, tmp_path: Path
) -> None:
    page = opened(page_of(built, tmp_path))
    names = page.js("window.kilter.page.parts.names")
    base = built.to_dict()["base"]
    for k, step in enumerate(built.steps):
        page.slide("scrub", k + 0.3)
        assert page.text("step-name") == step.part
        shown = [names[j] for j in page.js(SHOWN)]
        assert set(shown) == {*base, *(one.part for one in built.steps[: k + 1])}
        gripped = [names[j] for j, on in enumerate(page.js(f"[...{PARTS}.gripped]")) if on]
        assert tuple(gripped) == step.held
        facts = page.page.inner_text("#step-facts")
        assert not step.held or "without it" in facts
        index = names.index(step.part)
        seat = np.array(
            page.js("k => [...window.kilter.page.parts.center.slice(3*k, 3*k+3)]", index)
        )
        away = np.array(page.js(f"k => {PARTS}.centre(k)", index)) - seat
        assert np.allclose(away / np.linalg.norm(away), -np.array(step.direction), atol=1e-5)
    page.slide("scrub", len(built.steps))
    page.page.check("#show-forces")
    page.slide("scrub", 5.5)
    assert "N" in page.text("force-label")


def test_the_strip_is_painted_clicked_and_walked_by_keys(
    built: kilter.Order, opened: Callable, tmp_path: Path
) -> None:
    page = opened(page_of(built, tmp_path))
    page.until(f"{PAINTED} >= 5")
    buttons = page.page.locator("#strip button")
    assert buttons.count() == len(built.steps)
    buttons.nth(3).click()
    assert page.text("step-title") == "Step 4 of 9"
    assert buttons.nth(3).get_attribute("aria-current") == "step"
    page.page.keyboard.press("ArrowRight")
    assert page.text("step-title") == "Step 5 of 9"
    page.page.keyboard.press("End")
    assert page.text("step-title") == "Step 9 of 9"
    page.until(f"{PAINTED} === 9")
    page.page.focus("#picture")
    page.page.keyboard.press(",")
    assert page.text("step-title") == "Step 8 of 9"
    page.page.keyboard.press(".")
    assert page.text("step-title") == "Step 9 of 9"
    page.page.keyboard.press(" ")
    page.until("Boolean(window.kilter.playing)")
    page.page.keyboard.press(" ")
    assert not page.js("window.kilter.playing")
    page.page.locator("#graph g[data-step='2']").click()
    assert page.text("step-title") == "Step 3 of 9"


def test_it_is_pulled_apart_with_a_line_from_each_part_to_its_seat(
    built: kilter.Order, opened: Callable, tmp_path: Path
) -> None:
    page = opened(page_of(built, tmp_path))
    lines = "window.kilter.stage.lines.geometry.attributes.position"
    assert not page.js("window.kilter.stage.lines.visible")
    before = page.drawn()
    page.page.focus("#picture")
    page.page.keyboard.press("End")
    page.slide("explode", 1)
    assert page.js(f"{lines}.count") == 2 * 9
    assert page.drawn() != before


@pytest.mark.parametrize("width", [400, 800])
def test_a_narrow_window_is_not_overrun(
    width: int, built: kilter.Order, opened: Callable, tmp_path: Path
) -> None:
    page = opened(page_of(built, tmp_path), viewport={"width": width, "height": 800})
    assert page.js("document.documentElement.scrollWidth") <= width


def test_every_picture_is_there_when_it_is_printed(
    built: kilter.Order, opened: Callable, tmp_path: Path
) -> None:
    page = opened(page_of(built, tmp_path), viewport={"width": 400, "height": 600})
    page.js("window.dispatchEvent(new Event('beforeprint'))")
    assert page.js(PAINTED) == 9
    page.page.emulate_media(media="print")
    assert not page.page.is_visible("#scrub")
    assert page.page.locator("#strip canvas").nth(8).is_visible()


def test_an_impossibility_has_no_film_and_shows_how_parts_fall(
    opened: Callable, tmp_path: Path
) -> None:
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6, planar=False), kilter.PlanRules(hold=0))
    page = opened(page_of(order, tmp_path))
    assert page.text("verdict") == "Impossible"
    assert not page.page.is_visible("#player")
    assert page.js(f"[...{PARTS}.moving].filter(Boolean).length") == 5
    assert page.js("window.kilter.stage.motion.group.children.length") > 0


def test_a_tower_without_webgl_still_says_its_steps(without_webgl: Any, tmp_path: Path) -> None:
    path = page_of(kilter.plan(scene("tower")), tmp_path)
    page = without_webgl
    page.goto(path.as_uri())
    assert "No picture" in page.inner_text("#no-picture")
    page.locator("#strip button").nth(2).click()
    assert page.inner_text("#step-name") == "cube-3"


def test_the_plan_of_the_dome_plays(opened: Callable, tmp_path: Path) -> None:
    if not (DATA / "learn2assemble").is_dir():
        pytest.skip("real data is not here: ../shared/data beside the checkout")
    dome = kilter.load(DATA / "learn2assemble" / "dome").with_grounded(["72"])
    order = kilter.plan(dome.with_friction(0.55))
    page = opened(page_of(order, tmp_path))
    assert page.page.locator("#strip button").count() == 72
    page.page.select_option("#pace", "4")
    page.page.click("#play")
    page.until("window.kilter.time > 3", 60)
    pictures = set()
    for k in (10, 40, 71):
        page.js("k => window.kilter.show(k)", k)
        assert page.text("when") == f"step {k + 1} of 72"
        assert len(page.js(SHOWN)) == k + 2
        pictures.add(page.drawn())
    assert len(pictures) == 3
