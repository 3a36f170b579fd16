"""The workbench shows on the stage what has a place: orders, limits, supports, directions, cuts."""

import io

import numpy as np
import pytest
from PIL import Image
from test_what_helps import stack
from test_workbench_controls import tab_agrees
from workbench_page import WorkbenchPage, loaded

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.check import check_equilibrium
from kilter.analysis.verdict.verdict import Verdict
from kilter.scenes import scene
from kilter.scenes.walls import wall_of

pytestmark = pytest.mark.browser

PRESENT = "[...window.kilter.stage.parts.present]"
MOVING = "[...window.kilter.stage.parts.moving]"
HANDS = "window.kilter.stage.hands.group.children.length > 0"


def opened_tab(page: WorkbenchPage, name: str) -> dict:
    """Open a tab, wait for its result, and return the data of its answer."""
    page.page.click(f"#tab-{name}")
    page.until(f"window.bench.tabs.results.has('{name}')", 60)
    return page.js("name => window.bench.tabs.results.get(name).data", name)


def test_the_film_of_an_order_is_on_the_stage(user):
    page = user("tower")
    steps = opened_tab(page, "plan")["steps"]
    strip = page.page.locator("#film-strip button")
    assert strip.count() == len(steps) == 5
    strip.nth(2).click()
    here = page.js(PRESENT)
    names = page.js("window.kilter.page.parts.full_names")
    expected = {"base", *(part for step in steps[:3] for part in step["parts"])}
    assert {name for name, shown in zip(names, here, strict=True) if shown} == expected
    assert strip.nth(2).get_attribute("aria-current") == "step"
    # the small pictures are painted
    page.until(
        "(() => { const c = document.querySelector('#film-strip canvas');"
        " return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some(Boolean); })()"
    )
    for label, step in (("Forward", "4"), ("Back", "3")):
        page.page.click(f"#sheet-controls button:has-text('{label}')")
        assert page.page.inner_text("#film-strip [aria-current] .step-number") == step
    page.page.click("#sheet-controls button:has-text('Play')")
    page.until(f"{PRESENT}.every(Boolean) && !window.bench.tabs.onStage.playing", 20)
    page.page.click("#tab-plan")  # closed: the answer again
    assert page.js("window.kilter.film") is None
    assert page.js(PRESENT) == [1] * len(names)


def test_the_motion_at_a_limit_is_on_the_stage(user):
    page = user("arch")
    assert sum(page.js(MOVING)) == 0
    margin = opened_tab(page, "margin")
    page.page.select_option("#limit-case", "0")
    names = page.js("window.kilter.page.parts.full_names")
    moves = [name for name, on in zip(names, page.js(MOVING), strict=True) if on]
    assert set(margin["tilt_limit"]["moves"]) <= set(moves)
    down = page.js("window.kilter.limit.down")
    assert down == pytest.approx(margin["tilt_down"])
    up = page.js(
        "(() => { const s = window.kilter.stage; s.render();"
        " const [a, b] = [[0, 0, 0], window.kilter.limit.down].map((p) => s.onScreen(p));"
        " return [b[0] - a[0], b[1] - a[1]]; })()"
    )
    assert abs(up[0]) < 0.02 * up[1]  # the assembly is turned: its gravity points down
    assert not page.js(HANDS)
    page.page.select_option("#limit-case", "1")
    assert page.js(HANDS)  # the push
    page.page.select_option("#limit-case", "")
    assert sum(page.js(MOVING)) == 0
    page.page.click("#tab-transport")
    page.page.click("#sheet-controls button:has-text('Limits of all axes')")
    page.until("window.bench.tabs.results.has('transport')", 60)
    page.page.select_option("#limit-case", "0")
    assert sum(page.js(MOVING)) > 5
    page.page.click("#tab-transport")
    assert sum(page.js(MOVING)) == 0


def test_supports_are_drawn_on_their_parts(user):
    page = user("paper-figure-8")
    found = opened_tab(page, "hold")["supports"]
    names = page.js("window.kilter.page.parts.full_names")
    gripped = page.js("[...window.kilter.stage.parts.gripped]")
    held = {name for name, on in zip(names, gripped, strict=True) if on}
    assert held == {one["part"] for one in found if one["kind"] == "grip"}
    page.page.click("#tab-hold")
    assert sum(page.js("[...window.kilter.stage.parts.gripped]")) == 0


GRIPPED = "[...window.kilter.stage.parts.gripped]"
GHOST = "window.kilter.stage.ghost.group.visible"


def of_helps(page: WorkbenchPage, label: str) -> dict:
    """Press a button of the tab "What helps", and return the data of the new answer."""
    page.page.click(f"#sheet-controls button:has-text('{label}')")
    page.until("!window.bench.tabs.asked.size && window.bench.tabs.results.has('helps')", 60)
    return page.js("window.bench.tabs.results.get('helps').data")


def test_a_change_that_helps_is_on_the_stage_and_becomes_a_choice(user, capsys, monkeypatch):
    page = user(stack(0.3))
    opened_tab(page, "helps")
    page.choose("low")
    assert of_helps(page, "Try to hold selected parts")["pushes"][0]["part"] == "low"
    page.choose()
    page.page.click("#sheet-controls button:has-text('Try to hold selected parts')")
    assert page.text("trouble-words").startswith("Select the parts")
    page.page.click("#end-trouble")
    listed = of_helps(page, "Try changes")["improvements"]
    assert tab_agrees(page, "helps", capsys, monkeypatch)["improvements"] == listed
    k = next(k for k, one in enumerate(listed) if (one["what"], one["parts"]) == ("move", ["high"]))
    row = page.page.locator("#sheet-body tr [data-change]").nth(k)
    row.click()
    assert row.get_attribute("aria-pressed") == "true"
    assert page.js(GRIPPED) == [0, 0, 1]
    assert page.js(HANDS)
    assert page.js(GHOST)
    assert "part after the change" in page.text("legend")
    away = page.js(
        "(() => { const { stage: { ghost, parts } } = window.kilter; ghost.faces.geometry"
        ".computeBoundingBox(); const { min, max } = ghost.faces.geometry.boundingBox;"
        " return parts.centre(2).map((c, i) => (min.toArray()[i] + max.toArray()[i]) / 2 - c); })()"
    )
    assert away == pytest.approx([listed[k]["by"] * x for x in listed[k]["along"]], abs=1e-6)
    # a mass has neither an arrow nor another place
    mass = next(k for k, one in enumerate(listed) if one["what"] == "mass")
    page.page.locator("#sheet-body [data-change]").nth(mass).click()
    assert row.get_attribute("aria-pressed") == "false"
    assert not page.js(HANDS)
    assert not page.js(GHOST)
    page.page.locator("#sheet-body [data-change]").nth(mass).click()  # the answer again
    assert page.js(GRIPPED) == [0, 0, 0]
    assert "part that is changed" not in page.text("legend")
    row.click()
    page.page.click("#tab-helps")  # closed
    assert (page.js(GRIPPED), page.js(GHOST)) == ([0, 0, 0], False)
    page.page.click("#tab-helps")
    assert page.page.locator("#sheet-body [data-make]").nth(k).inner_text() == "Apply"
    page.after(lambda: page.page.locator("#sheet-body [data-make]").nth(k).click())
    assert list(page.choices()["poses"]) == ["high"]
    page.page.click("#tab-margin")
    page.until("window.bench.tabs.results.has('margin')", 60)
    found = page.js("window.bench.tabs.results.get('margin').data.tilt_deg")
    assert found == pytest.approx(listed[k]["limit"], rel=1e-6)
    page.after(lambda: page.press("Control+z"))
    assert "poses" not in page.choices()


def test_a_falling_stack_is_made_to_stand(user, tmp_path):
    page = user(stack(0.8))
    opened_tab(page, "helps")
    assert "Make it stand" in page.text("sheet-body")
    page.page.fill("#stand-tilt", "much")
    stand = "#sheet-controls button:has-text('Make it stand')"
    page.page.click(stand)
    assert page.text("trouble-words").startswith("Give the tilt")
    page.page.fill("#stand-tilt", "5")
    for name in ("allow-move", "allow-mass"):
        page.page.uncheck(f"#{name}")
    page.page.click(stand)
    assert page.text("trouble-words").startswith("Allow a kind")
    page.page.click("#end-trouble")
    page.page.check("#allow-friction")
    assert not of_helps(page, "Make it stand")["made_stand"]["stands"]
    page.page.uncheck("#allow-friction")
    page.page.check("#allow-size")
    made = of_helps(page, "Make it stand")["made_stand"]
    assert page.text("tab-command").endswith("--make-stand --allow size --tilt 5")
    assert page.js(GHOST)  # a single change is shown at once
    with page.page.expect_download() as download:
        page.page.click("#sheet-body button:text-is('Save as a file')")
    assert download.value.suggested_filename == "file.changed.kilter.json"
    download.value.save_as(tmp_path / "changed.kilter.json")
    assert kilter.margin(tmp_path / "changed.kilter.json").tilt_deg == pytest.approx(
        made["tilt_deg"], abs=1e-6
    )
    page.page.check("#allow-move")
    page.page.uncheck("#allow-size")
    assert len(of_helps(page, "Make it stand")["made_stand"]["changes"]) == 2
    page.after(lambda: page.page.click("#sheet-body button:text-is('Apply')"))
    assert page.text("verdict") == "Stable"
    assert not page.js(GHOST)


def test_ranges_of_forces_are_those_of_python(user):
    page = user("arch")
    data = opened_tab(page, "forces")
    expected = kilter.check(scene("arch")).force_ranges()
    assert len(data["ranges"]) == len(expected) == 21
    for shown, one in zip(data["ranges"], expected, strict=True):
        assert shown["least"]["value"] == pytest.approx(one.least.value, rel=1e-9)
    page.page.click("#sheet-controls button:has-text('Between the two selected parts')")
    assert page.text("trouble-words").startswith("Select two parts")
    page.page.click("#end-trouble")
    page.choose("voussoir-3", "voussoir-4")
    page.page.click("#sheet-controls button:has-text('Between the two selected parts')")
    page.until("window.bench.tabs.results.get('forces')?.data.ranges.length === 1", 60)
    assert page.text("tab-command").endswith("--between voussoir-3 voussoir-4")
    page.page.click("#sheet-controls button:has-text('All pairs')")
    page.until("window.bench.tabs.results.get('forces')?.data.ranges.length === 21", 60)


def test_a_support_moves_by_typed_numbers_as_in_python(user):
    page = user("arch")
    places = "window.kilter.page.parts.names.map((_, k) => window.kilter.stage.parts.centre(k))"
    rest = np.array(page.js(places))
    page.page.click("#tab-supports")
    assert "Select a held part" in page.text("sheet-controls")
    page.choose("voussoir-3")
    assert not page.page.is_visible("#move-form")  # a free part is no support
    for name, way in (("springer-left", "-0.01 0 0"), ("springer-right", "0.01 0 0")):
        page.choose(name)
        page.page.fill("#do-move", way)
        page.page.press("#do-move", "Enter")
        page.until("window.bench.tabs.results.has('supports')", 60)
    data = page.js("window.bench.tabs.results.get('supports').data.movement")
    ways = {"springer-left": (-0.01, 0, 0), "springer-right": (0.01, 0, 0)}
    expected = kilter.check(scene("arch")).support_movement(ways)
    assert data["sentence"] == expected.sentence
    assert data["least_work"]["value"] == pytest.approx(expected.least_work.value, rel=1e-9)
    for shown, one in zip(data["opened"], expected.opened, strict=True):
        assert shown["hinge"] == pytest.approx(one.hinge)
    assert page.text("tab-command").endswith(
        "--move springer-left=-0.01,0,0 --move springer-right=0.01,0,0"
    )
    assert expected.sentence in page.text("sheet-body")
    # the picture shows the whole movement
    assert page.text("supports-words").startswith(expected.sentence)
    factor = float(page.text("supports-words").rsplit(" x ", 1)[1].rstrip("."))
    shift = np.array(page.js("[...window.kilter.movement.motion]")).reshape(-1, 6)
    assert shift == pytest.approx(factor * expected.motion, abs=1e-4)
    assert np.array(page.js(places)) - rest == pytest.approx(shift[:, :3], abs=1e-5)
    assert page.page.is_visible("#hinge-key")
    # a support that moves by nothing is taken back; then all of them
    page.page.fill("#do-move", "0 0 0")
    page.page.press("#do-move", "Enter")
    page.until("window.bench.tabs.results.has('supports')", 60)
    assert page.text("tab-command").endswith("--move springer-left=-0.01,0,0")
    page.page.click("#sheet-controls button:has-text('Move all back')")
    assert not page.page.is_visible("#supports")
    assert np.array(page.js(places)) == pytest.approx(rest, abs=1e-6)
    # a movement that is too large is a sentence
    page.page.fill("#do-move", "5 0 0")
    page.page.press("#do-move", "Enter")
    page.until("Boolean(window.bench.tabs.results.get('supports')?.error)", 60)
    assert "more than a tenth of the size" in page.text("sheet-error")


def equilibrium(assembly: Assembly) -> Verdict:
    """The verdict of level equilibrium, apart from the page."""
    return check_equilibrium(assembly, kilter.contacts(assembly))


def test_the_gravity_ball_is_coloured_and_judges_as_python_does(user):
    page = user("arch")
    page.page.click("#open-gravity")
    page.until("window.bench.tabs.results.has('orient')", 60)
    assert page.js("window.kilter.page.region !== null")
    rng = np.random.default_rng(7)
    held = {"Stable", "Settles", "Potentially stable"}
    for angle in rng.uniform(-20, 20, 20):
        if abs(abs(angle) - 8.494) < 0.5:
            continue  # at the limit of 8.494 deg
        down = [float(np.sin(np.radians(angle))), 0.0, -float(np.cos(np.radians(angle)))]
        shown = page.js("d => window.kilter.ask(d).verdict", down)
        expected = equilibrium(scene("arch").with_down(down)).level is not None
        assert (shown in held) == expected, angle


def test_a_typed_tilt_is_judged_as_python_judges_it(user):
    page = user(wall_of(80))  # too large for the map of all directions
    page.page.click("#open-gravity")
    page.page.fill("#tilt", "many")
    page.page.press("#tilt", "Enter")
    assert "angle in degrees" in page.text("trouble-words")
    page.page.click("#end-trouble")
    for angle, axis in ((3, "y"), (50, "y"), (2, "1 1 0")):
        page.page.fill("#tilt", f"{angle} {axis}")
        page.page.press("#tilt", "Enter")
        page.until("window.kilter.found.from === 'probed'", 60)
        verdict = equilibrium(wall_of(80).with_down(page.down()))
        assert (page.text("verdict") == "Unstable") == (verdict.level is None)
        away = np.degrees(np.arccos(-page.down()[2]))
        assert away == pytest.approx(angle, abs=1e-6)


def test_three_planes_cut_and_show_the_inside(user):
    shell = [
        Part(f"wall-{k}", Box(size), Pose(at), grounded=True)
        for k, (size, at) in enumerate((([4, 0.2, 4], [0, -2, 0]), ([0.2, 4, 4], [2, 0, 0])))
    ]
    inside = Part("block", Box([1, 1, 1]))
    page = user(Assembly([*shell, inside]))
    seen = lambda point: page.js("p => window.kilter.stage.parts.seen(2, p)", point)  # noqa: E731
    center = page.js("window.kilter.page.center")
    corner = [[s * 0.4 - c for s, c in zip(signs, center, strict=True)] for signs in CORNERS]
    assert all(map(seen, corner))
    sides = ("section-x-side", "section-y-side", "section-z-side")
    places = ("section-x", "section-y", "section-z")
    for count, (side, place) in enumerate(zip(sides, places, strict=True), start=1):
        page.page.select_option(f"#{side}", "+")
        page.slide(place, -center[count - 1] / page.js(RADIUS))
        kept = [signs for signs, at in zip(CORNERS, corner, strict=True) if seen(at)]
        assert kept == [s for s in CORNERS if all(s[i] < 0 for i in range(count))]
    # the face of the cut is filled: the middle of the block is its inside, striped
    page.page.select_option("#section-y-side", "-")
    page.js("window.kilter.stage.view([0, -1, 0])")
    page.js("window.kilter.stage.render()")
    assert page.js("window.kilter.stage.parts.cut.visible")


CORNERS = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
RADIUS = "window.kilter.page.radius"


def test_the_view_without_perspective_keeps_sizes_and_parallels(user):
    page = user("tower")
    spread = (
        "(() => { const s = window.kilter.stage; s.render(); const r = window.kilter.page.radius;"
        " const at = (p) => s.onScreen(p); const [near, far] = [-r, r].map((y) =>"
        " Math.hypot(...at([r, y, 0]).map((c, i) => c - at([-r, y, 0])[i])));"
        " return near / far; })()"
    )
    page.js("window.kilter.stage.view([0, -1, 0])")
    assert page.js(spread) > 1.2  # the near edge is longer
    page.page.click("#flat")
    assert page.js(spread) == pytest.approx(1, abs=0.02)
    page.page.click("#flat")
    assert page.js(spread) > 1.2


def test_pictures_and_films_are_downloaded(user):
    page = user("paper-figure-8")
    with page.page.expect_download() as download:
        page.page.select_option("#export", "picture.png")
    picture = Image.open(io.BytesIO(download.value.path().read_bytes()))
    assert picture.size[0] == 2 * page.js("window.kilter.stage.size[0]")
    assert len(picture.convert("RGB").resize((60, 40)).getcolors(2400)) > 20
    with page.page.expect_download(timeout=30_000) as download:
        page.page.select_option("#export", "film.webm")
    assert download.value.suggested_filename in ("film.webm", "film.mp4")
    assert download.value.path().stat().st_size > 5_000


def test_no_part_stays_transparent_after_the_verdict_has_changed(user):
    page = user(boxed())
    assert float(page.page.input_value("#see-through")) > 0
    page.choose("block").click("#do-hold")
    assert page.text("verdict") == "Stable"
    assert float(page.page.input_value("#see-through")) == 0


def boxed() -> Assembly:
    """A block that falls inside a box of six walls."""
    walls = []
    for axis in range(3):
        for sign in (-1, 1):
            size, at = [4.0] * 3, [0.0] * 3
            size[axis], at[axis] = 0.2, 2.0 * sign
            walls.append(Part(f"wall-{axis}{sign:+}", Box(size), Pose(at), grounded=True))
    return Assembly([*walls, Part("block", Box([1, 1, 1]))])


def test_a_change_of_the_file_states_both_verdicts_and_keeps_choices(user, folder):
    page = user(loaded())
    page.choose("side").click("#do-hold")
    base, low, high, side = loaded().parts
    far = Part("high", high.shape, Pose([0.9, 0, 1.5]))
    changed = Assembly([base, low, far, side], friction=0.5)
    page.after(lambda: kilter.dump(changed, folder / "file.kilter.json"))
    page.until("/was: .*Now: /.test(document.getElementById('message-words').textContent)")
    assert page.choices()["held"] == ["side"]
    assert page.text("verdict") == "Unstable"


def test_a_strap_is_placed_by_clicks(user, capsys, monkeypatch):
    page = user(loaded())
    page.page.click("#tab-transport")
    page.page.click("#sheet-controls button:has-text('Place a strap')")
    page.page.click("#sheet-controls button:has-text('Add the strap')")
    assert page.text("trouble-words").startswith("Click two or more points")
    page.page.click("#end-trouble")
    page.js("window.kilter.stage.view([1, -1, 1]); window.kilter.stage.render()")
    box = page.page.locator("#picture").bounding_box()
    where = (
        "([name, at]) => { const { stage, page } = window.kilter; stage.render();"
        " return stage.onScreen(at.map((c, k) => c - page.center[k])); }"
    )
    for name, at in (("base", [-1.5, -0.9, 0]), ("high", [0.2, -0.5, 1.6])):
        x, y = page.js(where, [name, at])
        page.page.mouse.click(box["x"] + x, box["y"] + y)
    assert page.js("window.kilter.page.straps.at(-1).length") == 2
    page.page.fill("#strap-tension", "1500")
    page.click("#sheet-controls button:has-text('Add the strap')")
    [strap] = page.choices()["straps"]
    assert strap["tension"] == 1500
    assert [name for name, _ in strap["path"]] == ["base", "high"]
    assert strap["path"][1][1] == pytest.approx([0.2, -0.5, 1.6], abs=0.02)
    page.command_agrees(capsys, monkeypatch)
    page.click("#joined button:has-text('Remove')")
    assert "straps" not in page.choices()
    page.page.click("#sheet-controls button:has-text('Place a strap')")
    page.page.click("#sheet-controls button:has-text('Cancel')")
    assert page.js("window.kilter.tool") is None
