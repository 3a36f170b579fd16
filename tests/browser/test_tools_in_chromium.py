"""Tools of every page: views, measuring, names, search, tree, selection, legend, accessibility."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Load, Part, Pose
from kilter.scenes.arches import arch

pytestmark = pytest.mark.browser

AXE = Path(__file__).resolve().parents[2] / "web" / "node_modules" / "axe-core" / "axe.min.js"
TO_EYE = (
    "(() => { const s = window.kilter.stage; const v = s.camera.position.clone()"
    ".sub(s.controls.target).applyQuaternion(s.root.quaternion.clone().invert()).normalize();"
    " return v.toArray(); })()"
)
BOLTS = [f"bracket-assembly_{k}/nut-bolt-assembly_1/bolt" for k in (1, 2)]


def nested() -> Assembly:
    """Names as from CAD, a load, and a part that moves inside a closed box."""
    base = Part("frame/base", Box([9, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    bolts = [
        Part(name, Box([1, 1, 1]), Pose([2 * k, 0, 0.5])) for k, name in enumerate(BOLTS, start=1)
    ]
    return Assembly([base, *bolts], loads=[Load(BOLTS[0], [0, 0, -5.0])])


def boxed() -> Assembly:
    """A block that falls inside a closed box."""
    walls = [
        Part(f"wall-{k}", Box(size), Pose(at), grounded=True)
        for k, (size, at) in enumerate(
            [
                ([4, 0.2, 4], [0, -2, 0]),
                ([4, 0.2, 4], [0, 2, 0]),
                ([0.2, 4, 4], [-2, 0, 0]),
                ([0.2, 4, 4], [2, 0, 0]),
                ([4.2, 4.2, 0.2], [0, 0, 2.1]),
            ]
        )
    ]
    return Assembly([*walls, Part("block", Box([1, 1, 1]))])


def test_the_view_cube_and_keys_show_standard_views(opened):
    page = opened(nested())
    page.page.focus("#picture")
    root = 1 / np.sqrt(3)
    for key, direction in {
        "1": [0, -1, 0],
        "2": [0, 1, 0],
        "3": [-1, 0, 0],
        "4": [1, 0, 0],
        "5": [0, 0, 1],
        "6": [0, 0, -1],
        "7": [root, -root, root],
    }.items():
        page.page.keyboard.press(key)
        assert np.allclose(page.js(TO_EYE), direction, atol=2e-4), key
        # the name of the face that is seen is on the cube
        page.js("window.kilter.stage.render()")
        label = page.js(
            "[...document.querySelectorAll('#cube text')].filter("
            "e => e.getAttribute('display') === 'inline').map(e => e.textContent)"
        )
        assert len(label) == (3 if key == "7" else 1)
    page.page.select_option("#view", "top")
    assert np.allclose(page.js(TO_EYE), [0, 0, 1], atol=2e-4)
    assert page.js("window.kilter.stage.axes()[0][0]") == pytest.approx(1, abs=1e-3)
    page.page.click("#home")
    page.js("window.kilter.stage.render()")  # without waiting for the next picture
    box = page.page.locator("#cube").bounding_box()
    middle = "Front"
    place = page.js(
        "name => { const e = [...document.querySelectorAll('#cube text')].find("
        "e => e.textContent === name).getBoundingClientRect();"
        " return [e.left + e.width / 2, e.top + e.height / 2]; }",
        middle,
    )
    assert box["x"] < place[0] < box["x"] + box["width"]
    page.page.mouse.click(*place)
    assert np.allclose(page.js(TO_EYE), [0, -1, 0], atol=2e-4)


def spot(page: Any, part: int, point: list[float]) -> tuple[float, float]:
    """Position in the window of a point of a part, in the frame of its shape [px]."""
    x, y = page.js(
        "([k, p]) => { const s = window.kilter.stage; return s.onScreen(s.parts.carried(k, p)); }",
        [part, point],
    )
    box = page.page.locator("#picture").bounding_box()
    return box["x"] + x, box["y"] + y


def test_two_clicks_measure_and_the_result_is_copied(opened):
    page = opened(nested(), permissions=["clipboard-read", "clipboard-write"])
    page.page.click("#measure")
    assert "Click two points" in page.text("measured-words")
    assert not page.page.is_visible("#copy-measured")
    page.page.mouse.click(*spot(page, 1, [0.5, -0.5, 0.5]))
    page.page.mouse.click(*spot(page, 2, [0.5, -0.5, 0.5]))
    words = page.text("measured-words")
    assert "distance 2 m; dx 2, dy 0, dz 0 m" in words
    assert "corner of" in words
    assert page.page.is_visible("#gauge-key")
    page.page.click("#copy-measured")
    assert page.js("navigator.clipboard.readText()").startswith("distance 2 m")
    # two points in faces: the gap between parallel faces
    page.page.mouse.click(*spot(page, 1, [0.0, 0.0, 0.5]))
    page.page.mouse.click(*spot(page, 0, [0.0, -1.0, 0.5]))
    assert "parallel faces, 1 m apart" in page.text("measured-words")
    page.page.keyboard.press("Escape")
    assert not page.page.is_visible("#measured")
    # with keys alone: two selected parts
    page.page.focus("#picture")
    for key in ("n", "n", "Shift+N", "m"):
        page.page.keyboard.press(key)
    assert page.js("[...window.kilter.selection]") == [1, 2]
    assert "distance 2 m" in page.text("measured-words")


def test_names_are_short_and_copied_in_full(opened):
    page = opened(nested(), permissions=["clipboard-read", "clipboard-write"])
    button = page.page.locator("button.link[data-part='2']")
    tail = "bolt (2)"
    assert button.inner_text() == tail
    button.click()
    assert page.text("part-name") == tail
    page.page.click("#copy-name")
    assert page.js("navigator.clipboard.readText()") == BOLTS[1]
    assert page.text("copy-name") == "Copied"


def test_search_and_tree_select_hide_and_open_groups(opened):
    page = opened(nested())
    rows = page.page.locator("#tree [role=treeitem]")
    whole = rows.count()
    page.page.fill("#find", "*bolt")
    assert page.text("found") == "2 of 3"
    assert rows.count() == 2
    page.page.press("#find", "Enter")
    assert page.js("[...window.kilter.selection]") == [1, 2]
    assert page.text("part-name") == "2 parts"
    page.page.click("#isolate")
    assert page.js("[...window.kilter.stage.parts.visible]") == [0, 1, 1]
    page.page.click("#show-all")
    assert not page.page.is_visible("#show-all")
    page.page.fill("#find", "")
    assert rows.count() == whole
    assert "held" in rows.first.inner_text()
    rows.first.locator(".eye").click()
    assert page.js("[...window.kilter.stage.parts.visible]") == [0, 1, 1]
    # with keys: to the next row, select it, and add the row after it
    rows.first.focus()
    page.page.keyboard.press("v")
    assert page.js("[...window.kilter.stage.parts.visible]") == [1, 1, 1]
    for key in ("ArrowDown", "Enter", "ArrowDown", " "):
        page.page.keyboard.press(key)
    assert page.js("[...window.kilter.selection]") == [1, 2]
    assert [e.get_attribute("aria-selected") for e in rows.all()][-2:] == ["true", "true"]


def test_several_parts_are_selected_by_clicks_and_in_a_frame(opened):
    page = opened(nested())
    mouse, keyboard = page.page.mouse, page.page.keyboard
    mouse.click(*spot(page, 1, [0, 0, 0.5]))
    keyboard.down("Control")
    mouse.click(*spot(page, 2, [0, 0, 0.5]))
    keyboard.up("Control")
    assert page.js("[...window.kilter.selection]") == [1, 2]
    facts = page.text("part-facts")
    assert "2000 kg in total" in facts
    keyboard.press("Escape")
    before = page.js(TO_EYE)
    box = page.page.locator("#picture").bounding_box()
    keyboard.down("Shift")
    mouse.move(box["x"] + 20, box["y"] + 20)
    mouse.down()
    mouse.move(box["x"] + box["width"] - 20, box["y"] + box["height"] - 20, steps=3)
    assert page.page.is_visible("#frame")
    mouse.up()
    keyboard.up("Shift")
    assert page.js("[...window.kilter.selection].sort()") == [0, 1, 2]
    assert page.js(TO_EYE) == before


def test_a_hidden_moving_part_is_seen_at_first(opened):
    page = opened(boxed())
    assert page.js("window.kilter.movers()") == [5]
    assert page.page.is_visible("#faint-key")
    assert page.js("document.getElementById('see-through-of').value") == "rest"
    flags = "Array.from({length: 6}, (_, k) => window.kilter.stage.parts.data[16 * k + 15])"
    assert page.js(flags) == [1, 1, 1, 1, 1, 0]
    # a selected part is opaque, too
    page.js("window.kilter.select(2)")
    assert page.js(flags) == [1, 1, 0, 1, 1, 0]
    # opaque again, and hidden: the words say so
    page.slide("see-through", 0)
    assert page.js(flags) == [0] * 6
    page.js("window.kilter.select(5)")
    page.page.click("#hide")
    assert "(hidden in the picture)" in page.text("moving")


def test_a_moving_part_behind_another_is_seen_from_its_side(opened):
    wall = Part("wall", Box([6, 0.2, 6]), Pose([0, -1, 0]), grounded=True)
    far = Part("far", Box([6, 0.2, 6]), Pose([0, 1, 0]), grounded=True)
    page = opened(Assembly([wall, Part("block", Box([1, 1, 1])), far]))
    counts = page.js("[...window.kilter.stage.counted(() => true)]")
    assert counts[1] > 0
    # only gone marks have no legend
    assert page.page.is_visible("#motion-key")
    assert not page.page.is_visible("#load-key")


def test_the_plan_opens_at_its_first_step_and_offers_no_dead_control(opened, tmp_path):
    kilter.report(kilter.plan(arch(5, friction=0.7)), tmp_path / "plan.html")
    page = opened(tmp_path / "plan.html")
    assert page.text("step-title") == "Step 1 of 5"
    assert page.page.locator("main :disabled:visible").count() == 0


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("kind", ["report", "narrow", "plan"])
def test_axe_finds_no_serious_violation(kind, scheme, opened, tmp_path):
    if not AXE.is_file():
        pytest.skip("axe-core is not here: npm ci in web/")
    subject: Any = nested()
    if kind == "plan":
        subject = tmp_path / "plan.html"
        kilter.report(kilter.plan(arch(5, friction=0.7)), subject)
    width = 400 if kind == "narrow" else 1360
    page = opened(subject, color_scheme=scheme, viewport={"width": width, "height": 900})
    page.js("window.kilter.select(1)")
    assert violations(page.page) == []


def violations(page: Any) -> list[str]:
    """Serious and critical violations that axe-core finds, with the elements."""
    page.evaluate(AXE.read_text(encoding="utf-8") + "; undefined")
    found = page.evaluate("axe.run(document, {resultTypes: ['violations']})")["violations"]
    return [
        f"{one['id']}: {node['target']} {node['any'][0]['message'] if node['any'] else ''}"
        for one in found
        if one["impact"] in ("serious", "critical")
        for node in one["nodes"]
    ]
