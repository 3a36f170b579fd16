"""Parts of the page in Chromium: cells, falls, motions, forces, plans, views."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from balance_cases import CASES
from scipy.spatial.transform import Rotation

import kilter
from kilter import Assembly, Bond, Box, Cylinder, Part, Pose, Sphere
from kilter.rigid import matrix_to_quaternion, quaternion_to_matrix
from kilter.scenes import SCENES, scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import tube
from kilter.second_order.answer.path_places import find_path_places
from kilter.show.shapes import place_shapes
from kilter.tell.palette import RAMP, rgb

ENTERS = 1e-3
"""Tolerated depth [size of the smaller part]."""


def moved(assembly: Assembly, places: np.ndarray) -> Assembly:
    """The assembly in the poses of the page: quaternion x, y, z, w and middle of each shape."""
    rest = place_shapes(assembly)
    parts = []
    for k, part in enumerate(assembly.parts):
        turn = quaternion_to_matrix(places[k, [3, 0, 1, 2]])
        turn = turn @ quaternion_to_matrix(rest.rotation[k]).T
        position = places[k, 4:7] + turn @ (part.pose.position - rest.position[k])
        rotation = matrix_to_quaternion(turn @ quaternion_to_matrix(part.pose.rotation))
        parts.append(dataclasses.replace(part, pose=Pose(position, rotation)))
    return Assembly(parts, units=assembly.units, gravity=assembly.gravity)


def depths(assembly: Assembly) -> dict[tuple[int, int], float]:
    """Depth of overlap of pairs of parts [size of the smaller part]."""
    size = assembly.geometry.size
    found = kilter.contacts(assembly).overlaps
    return {one.ends: one.depth / size[list(one.ends)].min() for one in found}


BLOCKED = ("paper-figure-3-vertices", "cad-export")
"""Scenes whose motion closes an open pair at once, so that the page cannot show it."""


@pytest.mark.browser
@pytest.mark.quick(
    "paper-figure-8", "paper-figure-12", "slope", "inverted-triangle", "wedge-on-wedge"
)
@pytest.mark.parametrize("name", SCENES)
def test_play_stops_before_parts_enter_each_other(name, opened):
    assembly = scene(name)
    if not kilter.check(assembly, effort=0).moving:
        pytest.skip("nothing moves")
    page = opened(name)
    rest = depths(assembly)
    rows = (
        "() => { const d = window.kilter.stage.parts.data; return Array.from({length:"
        " window.kilter.page.parts.names.length}, (_, k) => [...d.subarray(16 * k, 16 * k + 7)]); }"
    )
    before = np.array(page.js(rows))
    center = page.js("window.kilter.page.center")
    for share in (0.25, 0.5, 0.75, 1.0):
        page.slide("motion", share)
        places = np.array(page.js(rows))
        places[:, 4:7] += center
        for pair, depth in depths(moved(assembly, places)).items():
            assert depth <= rest.get(pair, 0.0) + ENTERS, (share, pair)
    blocked = "blocked" in page.text("motion-label")
    assert blocked == (name in BLOCKED)
    assert blocked or np.abs(np.array(page.js(rows)) - before).max() > 1e-3


@pytest.mark.browser
def test_what_is_asked_sees_parts_that_enter():
    """The test fails for a motion that does not stop."""
    assembly = scene("paper-figure-8")
    rest = place_shapes(assembly)
    places = np.column_stack([rest.rotation[:, [1, 2, 3, 0]], rest.position])
    assert not depths(moved(assembly, places))
    places[2, 6] -= 0.2
    assert max(depths(moved(assembly, places)).values()) > 10 * ENTERS


def _drawn(page: Any) -> Any:
    """The inner frame, once it has drawn; the browser replaces its first, empty frame."""
    for _ in range(900):
        for frame in page.frames[1:]:
            if frame.evaluate("Boolean(window.kilter && window.kilter.firstPicture)"):
                return frame
        page.wait_for_timeout(100)
    raise AssertionError("no picture")


@pytest.mark.browser
@pytest.mark.parametrize("kind", ["check", "region", "plan"])
def test_a_cell_opens_and_turns_without_a_network(chromium, tmp_path, kind):
    shown = getattr(kilter, kind)(scene("tower")).show(height=500)
    path = tmp_path / "cell.html"
    path.write_text(f"<!doctype html><body>{shown._repr_html_()}</body>", encoding="utf-8")
    page = chromium.new_page()
    page.context.set_offline(True)
    faults: list[str] = []
    asked: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("console", lambda said: faults.append(said.text) if said.type == "error" else None)
    page.on("request", lambda request: asked.append(request.url))
    page.goto(path.as_uri())
    frame = _drawn(page)
    assert frame.locator(".stage").first.is_visible()
    assert faults == []
    assert [url for url in asked if not url.startswith(("file:", "about:", "data:", "blob:"))] == []
    assert page.locator("iframe").bounding_box()["height"] == 500
    page.close()


NAME = "paper-figure-1-in-space"
ROWS = (
    "() => { const d = window.kilter.stage.parts.data; return Array.from({length:"
    " window.kilter.page.parts.names.length}, (_, k) => [...d.subarray(16 * k, 16 * k + 7)]); }"
)


def balls() -> Assembly:
    base = Part("base", Sphere(1.0), grounded=True)
    return Assembly([base, Part("ball", Sphere(0.5), Pose([0, 0, 1.5]), mass=2.0)])


@pytest.mark.browser
def test_parts_are_drawn_at_the_places_of_the_path(opened):
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


@pytest.mark.browser
def test_play_goes_to_the_end_and_the_mark_with_it(opened):
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


@pytest.mark.browser
def test_without_shapes_the_page_shows_how_it_begins(opened):
    page = opened(next(case for case in CASES if case.number == "02").build(0.0))
    assert page.js("document.getElementById('fall').hidden") is True
    assert page.js("document.getElementById('motion').disabled") is False
    assert page.js("document.getElementById('motion-label').textContent") == "start of the fall"
    before = np.array(page.js(ROWS))
    page.slide("motion", 1.0)
    assert np.abs(np.array(page.js(ROWS)) - before).max() > 1e-2


@pytest.mark.browser
def test_what_is_no_more_than_stable_has_no_card(opened):
    page = opened("tower")
    assert page.js("document.getElementById('fall').hidden") is True
    assert page.js("document.getElementById('motion-row').hidden") is False


BALANCED = [
    "tower",
    "wall",
    "arch",
    "arch-with-held-ends",
    "corner-wedges",
    "ladder",
    "bracket",
    "trough",
    "three-cylinders",
    "slope-with-friction",
    "laden-slab",
]
SHOWN = "window.kilter.shown"


@pytest.mark.browser
@pytest.mark.parametrize("name", BALANCED)
def test_the_shown_forces_balance_every_weight(name, opened):
    assembly = scene(name)
    page = opened(name)
    page.js("() => { const s = document.getElementById('show-forces'); s.checked || s.click(); }")
    geometry = assembly.geometry
    total = geometry.mass[:, None] * assembly.gravity
    for load in assembly.loads:
        total[assembly.index[load.part]] += load.force
    for one in page.js(SHOWN):
        total[one["part"]] += one["force"]
        total[one["other"]] -= one["force"]
    free = ~geometry.grounded
    weight = np.linalg.norm(assembly.gravity) * geometry.mass[free].max()
    assert np.abs(total[free]).max() < 1e-4 * weight


@pytest.mark.browser
@pytest.mark.parametrize("name", ["arch", "slope-with-friction", "three-cylinders"])
def test_resultants_are_those_of_python(name, opened):
    forces = kilter.check(scene(name)).forces
    page = opened(name)
    told = page.js(SHOWN)
    pressing = np.isfinite(forces.center).all(axis=1)
    assert len(told) == pressing.sum()
    sizes = sorted(np.linalg.norm(one["force"]) for one in told)
    expected = np.sort(np.linalg.norm(forces.resultant[pressing], axis=1))
    assert np.allclose(sizes, expected, rtol=1e-5)
    used = sorted(one["use"] for one in told if one["use"] is not None)
    assert np.allclose(
        used, np.sort(forces.utilisation[np.isfinite(forces.utilisation)]), atol=1e-4
    )
    middle = np.array(sorted([one["at"] for one in told])) + page.js("window.kilter.page.center")
    assert np.allclose(np.sort(middle, axis=0), np.sort(forces.center[pressing], axis=0), atol=1e-4)
    page.page.select_option("#force-mode", "point")
    assert len(page.js(SHOWN)) >= len(told)


@pytest.mark.browser
def test_forces_follow_what_is_hidden_isolated_and_cut(opened):
    page = opened("tower")
    assert len(page.js(SHOWN)) == 5
    page.js("window.kilter.select(3)")
    page.page.click("#isolate")
    # the isolated part shows all its contact forces, from below and from above
    alone = page.js(SHOWN)
    assert {one["part"] for one in alone} == {3}
    assert sum(one["force"][2] for one in alone) == pytest.approx(
        scene("tower").geometry.mass[3] * 9.81, rel=1e-5
    )
    page.page.click("#show-all")
    page.page.select_option("#section-z-side", "+")
    page.slide("section-z", 0)
    left = page.js(SHOWN)
    assert 0 < len(left) < 5
    assert all(one["at"][2] <= 1e-6 for one in left)
    page.slide("section-z", -1)
    assert page.js(SHOWN) == []


@pytest.mark.browser
def test_the_line_of_thrust_goes_through_the_arch(opened):
    page = opened("arch")
    rods = "window.kilter.stage.forces.group.children.map(one => one.count)"
    before = sum(page.js(rods))
    page.page.check("#show-thrust")
    held = scene("arch").geometry.grounded
    # a rod per voussoir, and its halo
    assert sum(page.js(rods)) - before == 2 * (~held).sum()


@pytest.mark.browser
def test_a_line_of_contact_is_a_line_without_beads(opened):
    page = opened("three-cylinders")
    counts = page.js(
        "window.kilter.stage.parts.patches.children.map(one => one.geometry.getIndex().count)"
    )
    assert counts[-2:] == [2 * 2 * 5, 0]  # five lines on both of their parts, no spots


@pytest.mark.browser
def test_a_round_contact_is_a_surface_with_rings_and_no_beads(opened):
    sleeve = tube("sleeve", 1.0, 2.0, 3.0, grounded=True)
    page = opened(Assembly([sleeve, Part("shaft", Cylinder(1.0, 5.0), Pose([0, 0, 0.2]))]))
    counts = page.js(
        "window.kilter.stage.parts.patches.children.map(one => one.geometry.getIndex().count)"
    )
    through, filled, rims, spots = counts
    assert through == filled > 100
    assert rims > 100
    assert spots == 0
    with_patch = page.drawn()
    page.page.uncheck("#show-contacts")
    assert page.drawn() != with_patch


@pytest.mark.browser
def test_parts_are_coloured_by_the_bond_that_they_use_most(opened):
    cubes = [Part(f"c{k}", Box([1, 1, 1]), Pose([0, 0, -k]), grounded=k == 0) for k in range(4)]
    bonds = [Bond((f"c{k + 1}", f"c{k}"), pull=9810.0) for k in range(3)]
    assembly = Assembly(cubes, bonds=bonds)
    page = opened(assembly)
    used = kilter.check(assembly).forces.bond_utilisation
    assert np.allclose(sorted(one["bond"] for one in page.js(SHOWN)), np.sort(used), atol=1e-5)
    assert page.js("document.getElementById('use-words').textContent") == "bond"
    data = "window.kilter.stage.parts.data"
    colour = f"Array.from({{length: 4}}, (_, k) => [...{data}.slice(16 * k + 8, 16 * k + 11)])"
    own = np.array(page.js(colour))
    choose = (
        "(of) => { const s = document.getElementById('colour-of'); s.value = of;"
        " s.dispatchEvent(new Event('change')); }"
    )
    page.page.evaluate(choose, "bond")
    assert page.js("document.getElementById('bond-key').innerText").endswith("9.81 kN per point")
    table = np.array([rgb(one) for one in RAMP]) / 255
    shares = [0, 0.75, 0.5, 0.25]  # held parts keep their colour
    painted = np.array(page.js(colour))
    for k in range(1, 4):
        at = shares[k] * (len(RAMP) - 1)
        expected = [np.interp(at, range(len(RAMP)), column) for column in table.T]
        assert np.allclose(painted[k], expected, atol=1 / 255)
    assert np.array_equal(painted[0], own[0])
    page.page.evaluate(choose, "own")
    assert np.array_equal(page.js(colour), own)


DATA = Path(__file__).resolve().parents[3] / "shared" / "data"
PARTS = "window.kilter.stage.parts"
PICTURED = f"Array.from({{length: {PARTS}.count}}, (_, k) => k).filter(k => {PARTS}.shown(k))"
PAINTED = "new Set([...document.querySelectorAll('#strip canvas')].map(c => c.toDataURL())).size"


@pytest.fixture(scope="module")
def built() -> kilter.Order:
    return kilter.plan(arch(9, ratio=0.3, friction=0.6, planar=False))


def page_of(order: kilter.Order, folder: Path) -> Path:
    kilter.report(order, folder / "plan.html")
    return folder / "plan.html"


@pytest.mark.browser
def test_it_plays_from_the_base_to_the_whole(built, opened, tmp_path):
    page = opened(page_of(built, tmp_path))
    assert page.text("when") == "step 1 of 9"
    assert len(page.js(PICTURED)) == 3  # the base of two parts, and the first part near its place
    page.page.select_option("#pace", "4")
    page.page.click("#play")
    page.until("window.kilter.time > 0 && window.kilter.time < 4")
    assert len(page.js(PICTURED)) < 8
    page.until("window.kilter.time > 4.5")
    assert page.text("play") == "Pause"
    page.until("document.getElementById('play').textContent === 'Play'", 60)
    assert page.text("when") == "assembled"
    assert len(page.js(PICTURED)) == 11


@pytest.mark.browser
def test_scrubbing_shows_each_step_and_what_it_holds(built, opened, tmp_path):
    page = opened(page_of(built, tmp_path))
    names = page.js("window.kilter.page.parts.names")
    base = built.to_dict()["base"]
    for k, step in enumerate(built.steps):
        page.slide("scrub", k + 0.3)
        assert page.text("step-name") == step.part
        shown = [names[j] for j in page.js(PICTURED)]
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


@pytest.mark.browser
def test_the_strip_is_painted_clicked_and_walked_by_keys(built, opened, tmp_path):
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


@pytest.mark.browser
def test_it_is_pulled_apart_with_a_line_from_each_part_to_its_seat(built, opened, tmp_path):
    page = opened(page_of(built, tmp_path))
    lines = "window.kilter.stage.lines.geometry.attributes.position"
    assert not page.js("window.kilter.stage.lines.visible")
    before = page.drawn()
    page.page.focus("#picture")
    page.page.keyboard.press("End")
    page.slide("explode", 1)
    assert page.js(f"{lines}.count") == 2 * 9
    assert page.drawn() != before


@pytest.mark.browser
@pytest.mark.parametrize("width", [400, 800])
def test_a_narrow_window_is_not_overrun(width, built, opened, tmp_path):
    page = opened(page_of(built, tmp_path), viewport={"width": width, "height": 800})
    assert page.js("document.documentElement.scrollWidth") <= width


@pytest.mark.browser
def test_every_picture_is_there_when_it_is_printed(built, opened, tmp_path):
    page = opened(page_of(built, tmp_path), viewport={"width": 400, "height": 600})
    page.js("window.dispatchEvent(new Event('beforeprint'))")
    assert page.js(PAINTED) == 9
    page.page.emulate_media(media="print")
    assert not page.page.is_visible("#scrub")
    assert page.page.locator("#strip canvas").nth(8).is_visible()


@pytest.mark.browser
def test_an_impossibility_has_no_film_and_shows_how_parts_fall(opened, tmp_path):
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6, planar=False), kilter.PlanRules(hold=0))
    page = opened(page_of(order, tmp_path))
    assert page.text("verdict") == "Impossible"
    assert not page.page.is_visible("#player")
    assert page.js(f"[...{PARTS}.moving].filter(Boolean).length") == 5
    assert page.js("window.kilter.stage.motion.group.children.length") > 0


@pytest.mark.browser
def test_a_tower_without_webgl_still_says_its_steps(without_webgl, tmp_path):
    path = page_of(kilter.plan(scene("tower")), tmp_path)
    page = without_webgl
    page.goto(path.as_uri())
    assert "No picture" in page.inner_text("#no-picture")
    page.locator("#strip button").nth(2).click()
    assert page.inner_text("#step-name") == "cube-3"


@pytest.mark.browser
def test_the_plan_of_the_dome_plays(opened, tmp_path):
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
        assert len(page.js(PICTURED)) == k + 2
        pictures.add(page.drawn())
    assert len(pictures) == 3


@pytest.mark.browser
def test_a_movement_of_supports_plays_with_its_hinges(opened, tmp_path):
    assembly, out = arch(10, ratio=0.15), tmp_path / "moved.html"
    moved = {"springer-right": (0.02, 0, 0)}
    kilter.report(assembly, out, moved=moved)
    found = kilter.check(assembly).support_movement(moved)
    page = opened(out)
    words = page.text("supports-words")
    assert words.startswith(found.sentence)
    factor = float(words.rsplit(" x ", 1)[1].rstrip("."))
    places = "window.kilter.page.parts.names.map((_, k) => window.kilter.stage.parts.centre(k))"
    rest = np.array(page.js(places))
    page.slide("supports-at", 1)
    shifts = np.array(page.js(places)) - rest
    assert shifts == pytest.approx(factor * found.motion[:, :3], abs=1e-5)
    assert np.linalg.norm(shifts, axis=1).max() > 0.03 * np.ptp(rest, axis=0).max()
    hinges = page.js("window.kilter.movement.hinges.map((hinge) => hinge.at)")
    center = np.array(page.js("window.kilter.page.center"))
    assert len(hinges) == len(found.opened) == 3
    for at, contact in zip(hinges, found.opened, strict=True):
        assert np.array(at) + center == pytest.approx(contact.hinge, abs=1e-6)
    balls = "window.kilter.stage.hinges.group.children.at(-1).count"
    assert page.js(balls) == 3
    assert page.page.is_visible("#hinge-key")
    # forces and contacts are those at rest
    assert not page.page.is_visible("#force-key")
    page.slide("supports-at", 0)
    assert np.array(page.js(places)) == pytest.approx(rest, abs=1e-6)
    page.page.click("#supports-play")
    assert page.text("supports-play") == "Pause"
    page.until("window.kilter.shifted === 1", 20)
    assert page.text("supports-play") == "Play"
    text = page.js("document.querySelector('.text').textContent")
    assert "Supports that move" in text
    assert "--move springer-right" not in text  # the command is that of the caller


@pytest.mark.browser
def test_a_page_without_a_movement_has_no_card_of_supports(opened):
    assert not opened("arch").page.is_visible("#supports")
