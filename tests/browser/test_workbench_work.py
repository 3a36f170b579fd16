"""The work in the workbench: keys, the bar beside a part, panels, help, the start page."""

import re

import pytest
from test_workbench_controls import two_open_pairs
from workbench_page import WorkbenchPage, loaded

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.scenes import scene
from kilter.workbench.history import remember_file

pytestmark = pytest.mark.browser

BAR = "#selected-bar"


def place_of(page: WorkbenchPage, name: str) -> tuple[float, float]:
    """Position of the middle of a part on the page [CSS px]."""
    box = page.page.locator("#picture").bounding_box()
    x, y = page.js(
        "name => { const k = window.kilter; k.stage.render(); const all = k.page.parts.full_names;"
        " return k.stage.onScreen(k.stage.parts.centre(all.indexOf(name))); }",
        name,
    )
    return box["x"] + x, box["y"] + y


def test_the_bar_beside_a_part_acts_on_it(user):
    page = user(loaded())
    page.page.mouse.click(*place_of(page, "side"))
    assert page.text("part-name") == "side"
    bar, part = page.page.locator("#selected-bar").bounding_box(), place_of(page, "side")
    assert abs(bar["x"] + bar["width"] / 2 - part[0]) < 250
    assert abs(bar["y"] + bar["height"] / 2 - part[1]) < 120
    page.click(f"{BAR} button:has-text('Hold')")
    assert page.choices()["held"] == ["side"]
    assert page.page.inner_text(f"{BAR} button >> nth=0") == "Release"
    page.press("Escape")
    # a right click selects a part and opens the bar at the pointer
    at = place_of(page, "high")
    page.page.mouse.click(*at, button="right")
    assert page.text("part-name") == "high"
    bar = page.page.locator(BAR).bounding_box()
    assert bar["x"] <= at[0] <= bar["x"] + bar["width"]
    # join with the part that is clicked next
    page.page.click(f"{BAR} button:has-text('Join with')")
    page.page.wait_for_timeout(50)
    page.after(lambda: page.choose("low"))
    assert page.choices()["joined"] == [["high", "low"]]
    page.choose("side")
    page.page.click(f"{BAR} button:has-text('Hide others')")
    assert sum(page.js("[...window.kilter.stage.parts.visible]")) == 1
    page.press("a")
    page.page.click(f"{BAR} button:has-text('Material')")
    assert page.js("document.activeElement.id") == "do-material"
    page.choose("side")
    page.press("h")
    page.choose("high").click(f"{BAR} button:has-text('Leave out')")
    assert page.choices()["left_out"] == ["high"]


def test_keys_work_without_a_click_on_the_picture(user):
    page = user(loaded())
    page.page.focus("#save")
    page.choose("side")
    page.after(lambda: page.press("h"))
    assert page.choices()["held"] == ["side"]
    page.after(lambda: page.press("Control+z"))
    assert "held" not in page.choices()
    page.choose("low", "high")
    page.after(lambda: page.press("j"))
    assert page.choices()["joined"] == [["low", "high"]]
    page.choose("side")
    page.after(lambda: page.press("x"))
    assert page.choices()["left_out"] == ["side"]
    far = "window.kilter.stage.camera.position.distanceTo(window.kilter.stage.controls.target)"
    before = page.js(far)
    page.choose("high")
    page.press("f")
    assert page.js(far) < 0.8 * before
    # a letter in a field is text
    page.page.fill("#find", "")
    page.page.focus("#find")
    page.press("h", "x")
    assert page.page.input_value("#find") == "hx"
    assert page.choices()["left_out"] == ["side"]


def test_the_part_under_the_pointer_is_marked(user):
    page = user(loaded())
    page.page.mouse.move(*place_of(page, "side"))
    page.until("window.kilter.stage.parts.hovered === 3")
    assert page.page.get_attribute("#picture", "title") == "side"
    page.page.mouse.move(2, 2)
    page.until("window.kilter.stage.parts.hovered === -1")


def test_the_help_lists_the_keys_and_leads_around(user):
    page = user(loaded())
    page.press("?")
    assert page.page.is_visible("#help")
    assert "hold or release" in page.page.inner_text("#help")
    with page.page.context.expect_page() as opened:
        page.page.click("#help a:has-text('straps')")
    assert opened.value.inner_text("body").startswith("WHICH STRAPS")
    opened.value.close()
    page.page.click("#help button:has-text('Close')")
    assert not page.page.is_visible("#help")
    page.page.click("#show-help")
    page.page.click("#help button:has-text('Show the tour')")
    seen = []
    for _ in range(5):
        seen.append(page.page.inner_text("#tour h2"))
        page.press("Enter")  # the button Next has the focus
    assert len(set(seen)) == 5
    assert not page.page.is_visible("#tour")


def test_panels_are_switched_and_their_edges_move(user):
    page = user(loaded(), viewport={"width": 1400, "height": 900})
    assert page.js(
        "document.documentElement.scrollHeight <= innerHeight"
    )  # a screen without a scroll bar
    for name in ("open-gravity", "open-forces", "open-display", "open-answer"):
        page.page.click(f"#{name}")
        assert page.page.is_visible(f"#{name.replace('open', 'panel')}")
        assert page.page.locator("aside .panel:visible").count() == 1
        page.press("ArrowRight")
    for name, key, grows in (("edge-left", "ArrowRight", 1), ("edge-right", "ArrowRight", -1)):
        edge = page.page.locator(f"#{name}")
        edge.focus()
        before = int(edge.get_attribute("aria-valuenow"))
        box = edge.bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.page.mouse.move(x, y)
        page.page.mouse.down()
        page.page.mouse.move(x + 40, y)
        page.page.mouse.up()
        assert int(edge.get_attribute("aria-valuenow")) == before + 40 * grows
        edge.press(key)
        assert int(edge.get_attribute("aria-valuenow")) == before + 64 * grows
    page.page.click("#tab-contacts")
    page.until("window.bench.tabs.results.has('contacts')")
    before = page.page.locator("#sheet").bounding_box()["height"]
    page.page.locator("#edge-sheet").press("ArrowUp")
    assert page.page.locator("#sheet").bounding_box()["height"] == pytest.approx(before + 24, abs=2)


def test_pairs_that_change_nothing_are_folded(user):
    page = user(two_open_pairs())
    decides = page.js("window.bench.answer.open.filter((pair) => pair.decides).length")
    assert page.page.locator("#open-pairs li").count() == decides
    base = Part("base", Box([6, 6, 1]), Pose([0, 0, -0.5]), grounded=True)
    block = Part("block", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    near = Part("near", Box([1, 1, 1]), Pose([1.0005, 0, 0.5]))
    page = user(Assembly([base, block, near]))
    assert page.text("verdict") == "Stable"
    assert page.page.locator("#open-pairs li").count() == 0
    assert page.text("open-answer") == "Answer"
    # a stable answer has no mark in the picture
    assert page.js("window.kilter.stage.open.group.children.length") == 0
    idle = page.page.locator("#idle-pairs summary")
    if idle.count():
        assert re.search(r"\(\d+\)", idle.inner_text())


def test_the_start_page_has_pictures_and_recent_files(user, folder):
    page = user(None)
    page.until("document.querySelectorAll('#featured svg').length === 6")
    page.click("#featured button >> nth=0")
    assert page.text("verdict") == "Stable"
    elsewhere = folder.parent / "elsewhere"
    elsewhere.mkdir(exist_ok=True)
    kilter.dump(scene("tower"), elsewhere / "far.kilter.json")
    remember_file(elsewhere / "far.kilter.json")
    page.page.reload()
    page.begin()
    page.page.click("#open-file")
    page.click("#recent button:has-text('far.kilter.json')")
    assert page.text("title") == "far.kilter.json"
    assert (
        page.js("a => window.bench.link.send(a)", {"do": "open", "recent": "/etc/passwd"})["ok"]
        is False
    )


def test_a_phone_that_is_turned_shows_the_whole_assembly(user):
    page = user("arch", viewport={"width": 400, "height": 800})
    inside = (
        "(() => { const k = window.kilter; k.stage.render(); const [w, h] = k.stage.size;"
        " return k.page.parts.names.every((_, i) => { const [x, y] = k.stage.onScreen("
        "k.stage.parts.centre(i)); return x > 0 && x < w && y > 0 && y < h; }); })()"
    )
    assert page.js(inside)
    for size in ({"width": 800, "height": 400}, {"width": 400, "height": 800}):
        page.page.set_viewport_size(size)
        page.page.wait_for_timeout(300)
        assert page.js(inside)
        assert page.js("document.documentElement.scrollWidth <= innerWidth")


def test_a_job_takes_at_most_twelve_clicks(user):
    """Friction, hold, join, tilt, margins, order, undo, save: the arch that is too thin."""
    page = user("paper-figure-8")
    clicks = 0

    def click(selector: str, *, changes: bool = False) -> None:
        nonlocal clicks
        clicks += 1
        # no panel is opened unasked
        act = lambda: page.page._page.click(selector)  # noqa: E731
        page.after(act) if changes else act()

    page.page.mouse.click(*place_of(page, "C3"))
    clicks += 1
    click(f"{BAR} button:has-text('Hold')", changes=True)
    assert page.text("verdict") == "Stable"
    click("#undo", changes=True)
    page.page.mouse.click(*place_of(page, "C2"))
    clicks += 1
    click(f"{BAR} button:has-text('Join with')")
    clicks += 1
    page.after(lambda: page.page.mouse.click(*place_of(page, "C3")))
    page.page.mouse.click(*place_of(page, "C2"))
    clicks += 1
    click(f"{BAR} button:has-text('Hold')", changes=True)
    assert page.text("verdict") == "Stable"
    click("#open-gravity")
    page.until("window.bench.tabs.results.has('orient')", 60)
    click("#tab-margin")
    page.until("window.bench.tabs.results.has('margin')", 60)
    click("#tab-plan")
    page.until("window.bench.tabs.results.has('plan')", 60)
    click("#save")
    page.until("!window.bench.session.dirty")
    assert clicks <= 12
