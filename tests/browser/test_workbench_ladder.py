"""The ladder of assumptions on the pages: its rung, its rows, and the bodies of joined parts."""

import json

import numpy as np
import pytest
from test_tools_in_chromium import AXE, violations
from workbench_page import DESK, FLOATS, GAP, desk_page

from kilter.assembly.assumption import RUNGS
from kilter.tell.palette import BODIES, ROLES, rgb

pytestmark = pytest.mark.browser

COLOUR = (
    "names => { const { page, stage } = window.kilter; return names.map((name) => {"
    " const k = page.parts.full_names.indexOf(name);"
    " return [...stage.parts.data.slice(16 * k + 8, 16 * k + 11)]; }); }"
)
HEIGHT = (
    "name => { const { parts, center } = window.kilter.page;"
    " const k = parts.full_names.indexOf(name);"
    " return parts.center[3 * k + 2] + center[2]; }"
)
SELECTED = "[...window.kilter.selection].map(k => window.kilter.page.parts.full_names[k])"
PRESSED = (
    "[...document.querySelectorAll('[data-rung][aria-pressed=true]')].map(b => b.dataset.rung)"
)
RECORD = (
    "(name) => { const { page, stage } = window.kilter; window.painted = [];"
    " const k = page.parts.full_names.indexOf(name), own = stage.parts.constructor.prototype;"
    " const { paint } = own; own.paint = function (colour) {"
    " window.painted.push([...colour.slice(3 * k, 3 * k + 3)].join()); paint.call(this, colour); };"
    " }"
)


def bytes_of(colour: str) -> list[float]:
    return [part / 255 for part in rgb(colour)]


def test_a_rung_is_chosen_by_click_by_row_and_by_key_as_one_change(
    user, folder, capsys, monkeypatch
):
    page = desk_page(user, folder, DESK)
    assert page.text("verdict") == "Unstable"
    assert page.js(PRESSED) == ["drawn"]
    rows = page.page.locator("#ladder button").all_inner_texts()
    assert [row.split()[0].strip("✓ ") or row.split()[1] for row in rows[:4]] == [*RUNGS]
    assert "3 parts fall: bracket, led-1" in rows[0]
    assert "1 part falls: bracket" in rows[1]
    # the rung that holds has a sign, and its name for readers of the screen says so
    assert page.text("rung-joined") == "✓ joined"
    assert page.page.get_attribute("#rung-joined", "aria-label") == "joined: stable"
    assert page.text("rung-drawn") == "drawn"
    drawn = page.command_agrees(capsys, monkeypatch)
    assert [row["assume"] for row in drawn["ladder"][:4]] == [*RUNGS]
    # by a click
    page.click("#rung-joined")
    assert page.choices()["assume"] == "joined"
    assert page.js(PRESSED) == ["joined"]
    assert page.text("verdict") == "Stable"
    assert "--assume joined" in page.text("command")
    assert page.command_agrees(capsys, monkeypatch)["assume"] == "joined"
    page.after(lambda: page.press("Control+z"))
    assert "assume" not in page.choices()
    assert page.js(PRESSED) == ["drawn"]
    # by keys: the parts are at rest on the board
    assert page.js(HEIGHT, "led-1") == pytest.approx(66 + GAP, abs=1e-4)
    page.page.focus("#banner")
    page.tab_to("#rung-play")
    page.after(lambda: page.press("Enter"))
    assert page.choices()["assume"] == "play"
    assert page.js("document.activeElement.id") == "rung-play"
    assert page.js(HEIGHT, "led-1") == pytest.approx(66, abs=1e-4)
    assert page.command_agrees(capsys, monkeypatch)["assume"] == "play"
    page.tab_to("#rung-fits")
    page.after(lambda: page.press(" "))
    assert page.command_agrees(capsys, monkeypatch)["assume"] == "fits"
    page.click("#rung-drawn")
    assert page.js(HEIGHT, "led-1") == pytest.approx(66 + GAP, abs=1e-4)
    # by a row with friction: still a single change
    page.click("#ladder button:has-text('friction 0.3')")
    choices = page.choices()
    assert (choices["assume"], choices["friction"]) == ("play", 0.3)
    page.after(lambda: page.press("Control+z"))
    assert "friction" not in page.choices()
    page.click("#ladder button:has-text('drawn')")
    assert page.js(HEIGHT, "led-1") == pytest.approx(66 + GAP, abs=1e-4)
    page.page.click("#save")
    page.until("!window.bench.session.dirty")
    assert json.loads((folder / "desk.kilter.json").read_text())["assume"] == "drawn"


def test_bodies_have_colours_and_loose_bodies_blink_once_and_are_selected(user, folder):
    page = desk_page(user, folder, DESK | FLOATS)
    assert page.page.locator("#loose-bodies li").count() == 3
    assert not page.page.is_visible("#body-key")
    own = page.js(COLOUR, ["board"])
    page.js(RECORD, "lost")
    page.click("#rung-joined")
    page.until("!window.kilter.blinking || !window.kilter.blinking.length")
    body, bracket, stand, lost = page.js(COLOUR, ["board", "bracket", "stand", "lost"])
    assert body == bracket == page.js(COLOUR, ["leg-1"])[0] != own[0]
    for colour in (body, stand, lost):
        assert np.abs(np.array([bytes_of(c) for c in BODIES]) - colour).max(axis=1).min() < 1e-6
    assert len({tuple(colour) for colour in (body, stand, lost)}) == 3
    warning = ",".join(str(part) for part in rgb(ROLES["unstable"].light))
    painted = page.js("window.painted")
    assert [each for k, each in enumerate(painted) if each != painted[k - 1]].count(warning) == 1
    assert page.page.is_visible("#body-key")
    # a click on the list selects, and brings the part nearer
    distance = "window.kilter.stage.camera.position.distanceTo(window.kilter.stage.controls.target)"
    before = page.js(distance)
    page.page.click("#loose-bodies li button:has-text('lost')")
    assert page.js(SELECTED) == ["lost"]
    assert page.js(distance) < before
    page.page.click("#loose-bodies button:has-text('Select all of them')")
    assert sorted(page.js(SELECTED)) == ["led-1", "led-2", "lost"]
    page.page.click("#bodies li button:has-text('board')")
    assert sorted(page.js(SELECTED)) == ["board", "bracket", "leg-1", "leg-2"]
    # the next answer has the same loose bodies: they do not blink again
    page.js("window.painted.length = 0")
    page.enter("friction-number", "0.5")
    assert warning not in page.js("window.painted")
    page.page.select_option("#colour-of", "own")
    assert page.js(COLOUR, ["board"]) == own
    page.click("#rung-drawn")
    assert page.js(COLOUR, ["board"]) == own


def test_nothing_blinks_for_users_who_want_less_motion(user, folder):
    page = desk_page(user, folder, DESK | FLOATS, reduced_motion="reduce")
    page.js(RECORD, "lost")
    page.click("#rung-joined")
    warning = ",".join(str(part) for part in rgb(ROLES["unstable"].light))
    assert page.js("window.painted")
    assert warning not in page.js("window.painted")


def test_the_exported_page_shows_ladder_and_bodies_without_a_control(user, folder, opened):
    page = desk_page(user, folder, DESK | FLOATS)
    page.click("#rung-joined")
    (folder / "out.html").write_bytes(page.exported("report.html"))
    offline = opened(folder / "out.html")
    assert offline.js("document.querySelectorAll('#rungs, #ladder button').length") == 0
    rows = offline.page.locator("#ladder li").all_inner_texts()
    assert len(rows) >= 4
    assert offline.js("document.querySelector('#ladder [aria-current]').innerText").startswith(
        "joined"
    )
    assert offline.page.is_visible("#body-key")
    offline.page.click("#loose-bodies li button:has-text('lost')")
    names = "[...window.kilter.selection].map(k => window.kilter.page.parts.names[k])"
    assert offline.js(names) == ["lost"]


def test_ladder_and_bodies_are_accessible_in_light_and_dark(user, folder):
    if not AXE.is_file():
        pytest.skip("axe-core is not here: npm ci in web/")
    page = desk_page(user, folder, DESK | FLOATS)
    page.click("#rung-joined")
    for scheme in ("light", "dark"):
        page.page.emulate_media(color_scheme=scheme)
        assert violations(page.page) == []
