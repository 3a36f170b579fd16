"""Readability of the page: ball with friction, margins, narrow windows, print, scrolling."""

import re
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.regions import cone_cutting
from kilter.scenes import scene, stacks

pytestmark = pytest.mark.browser

TOLD = {"Potentially stable": 1, "Undecided": 0, "Unstable": -1}


def pedestals() -> Assembly:
    """A slab on two different blocks, without symmetry between directions."""
    base = Part("base", Box([6, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    left = Part("left", Box([1, 1.5, 1]), Pose([-1.5, 0.2, 0.5]))
    right = Part("right", Box([0.7, 1, 1]), Pose([1.5, -0.1, 0.5]))
    slab = Part("slab", Box([4.5, 1.2, 0.4]), Pose([0, 0, 1.2]))
    return Assembly([base, left, right, slab], friction=0.45)


def around(region: kilter.Region, count: int) -> np.ndarray:
    """Random directions over the sphere, and near both sides of the two boundaries."""
    rng = np.random.default_rng(5)
    over = rng.normal(size=(count // 4, 3))
    rays, middle = np.asarray(region.rays), np.asarray(region.center)
    near = rng.dirichlet(np.full(len(rays), 0.3), size=count - len(over)) @ rays
    near = near / np.linalg.norm(near, axis=1)[:, None] - middle
    # to the boundary along a great circle, then beyond it by up to the width of the gap
    near = near / np.linalg.norm(near, axis=1)[:, None]
    near = near - np.outer(near @ middle, middle)
    near = near / np.linalg.norm(near, axis=1)[:, None]
    facets = region.cone.facets
    edge = np.min(
        np.where(near @ facets.T < 0, (facets @ middle) / -(near @ facets.T).clip(None, -1e-12), 9),
        axis=1,
    )
    angle = np.arctan(edge) + rng.choice([-1, 1], len(near)) * 10 ** rng.uniform(-4, -1, len(near))
    return np.vstack([over, np.cos(angle)[:, None] * middle + np.sin(angle)[:, None] * near])


def told(page: Any, downs: np.ndarray) -> list[int]:
    words = page.js("downs => downs.map(d => window.kilter.ask(d).verdict)", downs.tolist())
    return [TOLD[word] for word in words]


def sides(region: kilter.Region, downs: np.ndarray) -> list[int]:
    """1 within the inner cone, -1 outside the outer cone, 0 between them."""
    blur = np.radians(region.to_dict()["accuracy_deg"])
    outside = ((downs / np.linalg.norm(downs, axis=1)[:, None]) @ region.facets.T < -blur).any(1)
    return [
        1 if held else -1 if out else 0
        for held, out in zip(region.contains(downs), outside, strict=True)
    ]


@pytest.mark.parametrize("programs", [600, 12])
@pytest.mark.parametrize("make", [lambda: stacks.block_on_slope(0.0, friction=0.5), pedestals])
def test_with_friction_the_ball_agrees_with_python_on_both_sides_of_both_cones(
    make, programs, opened, monkeypatch
):
    monkeypatch.setattr(cone_cutting, "PROGRAMS", programs)
    assembly = make()
    region = kilter.region(assembly)
    downs = around(region, 200)
    page = opened(assembly)
    found = told(page, downs)
    assert found == sides(region, downs)
    assert min(found.count(1), found.count(-1)) > 50
    assert (found.count(0) > 25) == (programs == 12)
    # and with an independent check of each direction
    contacts = kilter.contacts(assembly)
    for down, side in list(zip(downs, found, strict=True))[::9]:
        verdict = kilter.check(assembly.with_down(down), contacts=contacts, effort=0).verdict
        assert side == 0 or (verdict == "unstable") == (side < 0)


def test_in_a_plane_with_friction_the_ball_agrees_with_python(opened):
    region = kilter.region(scene("arch"))
    rng = np.random.default_rng(3)
    turn = np.radians(rng.uniform(-2.5, 2.5, 200) * region.half_angle_deg)
    downs = np.column_stack([np.sin(turn), 0 * turn, -np.cos(turn)])
    page = opened("arch")
    found = told(page, downs)
    assert found == [1 if held else -1 for held in region.contains(downs)]
    assert min(found.count(1), found.count(-1)) > 50


def test_the_gap_is_drawn_as_open_and_said(opened, monkeypatch):
    monkeypatch.setattr(cone_cutting, "PROGRAMS", 12)
    assembly = stacks.block_on_slope(0.0, friction=0.5)
    region = kilter.region(assembly)
    downs = around(region, 400)
    gap = [down for down, side in zip(downs, sides(region, downs), strict=True) if side == 0]
    page = opened(assembly)
    colour = page.js(
        "downs => { const b = window.kilter.ball; const s = getComputedStyle(b.canvas);"
        " const paint = b.painter(n => s.getPropertyValue('--' + n).trim(), 1e-6);"
        " return downs.map(d => paint(d).map(Math.round)); }",
        [list(down) for down in [*gap, region.center]],
    )
    named = page.js(
        "['undecided-fill', 'stable-fill'].map(n => {"
        " const t = getComputedStyle(document.body).getPropertyValue('--' + n).trim();"
        " return [1, 3, 5].map(k => parseInt(t.slice(k, k + 2), 16)); })"
    )
    assert [one for one in colour[:-1] if one != named[0]] == []
    assert colour[-1] == named[1]
    assert f"at most {region.gap_deg:.2g}° wide" in page.text("gap-words")
    assert "Inside the region forces that hold it exist" in page.text("question")
    assert not page.page.is_visible("#go-nearest")  # it stays already
    page.js("d => window.kilter.ask(d)", [0.2, 0.3, 1])
    page.page.click("#go-nearest")
    assert page.text("verdict") == "Potentially stable"


def test_margins_are_those_of_the_command(opened):
    tower = stacks.tower(3, friction=0.8)
    page = opened(tower)
    margin = kilter.margin(tower, pushes=True, effort=0)
    told_ = page.text("margins")
    assert f"{margin.tilt_deg:.6g} deg" in told_
    assert "no friction is needed" in told_
    weakest = min(margin.pushes, key=lambda push: push.limit.value)
    assert weakest.part in told_.split("weakest push")[1].split("what helps")[0]
    for one in margin.improvements:
        assert one.sentence in told_


def test_verdict_level_and_reason_are_said_once(opened):
    page = opened("arch")
    verdict = kilter.check(scene("arch"))
    whole = page.page.inner_text("body")
    reason = verdict.sentence.removeprefix("Stable: ")
    assert whole.lower().count(reason.lower()) == 1
    assert page.text("level") == "level: proved"
    assert not re.search(r"^(verdict|in words|level)$", whole, re.M)
    page.js("window.kilter.ask([0.01, 0, -1])")
    assert page.text("level") == ""


def test_given_and_recommended_are_one_where_they_coincide(opened):
    page = opened("arch")
    assert page.text("go-given") == "Given and recommended"
    assert not page.page.is_visible("#go-recommended")
    page = opened("paper-figure-11")
    assert page.text("go-given") == "Given"
    assert page.page.is_visible("#go-recommended")


def nested() -> Assembly:
    """Names as from CAD: paths with equal ends."""
    base = Part("frame/base", Box([9, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    bolts = [
        Part(
            f"bracket-assembly_{k}/nut-bolt-assembly_1/bolt", Box([1, 1, 1]), Pose([2 * k, 0, 0.5])
        )
        for k in (1, 2)
    ]
    return Assembly([base, *bolts])


def test_on_a_phone_rows_are_cards_and_names_are_tails(opened):
    page = opened(nested(), viewport={"width": 400, "height": 800})
    assert page.js("document.documentElement.scrollWidth") <= 400
    cell = page.page.locator("td[data-column='mass [kg]']").first
    assert cell.evaluate("e => getComputedStyle(e, '::before').content") == '"mass [kg]"'
    assert not page.page.locator("thead").first.is_visible()
    name = page.page.locator("button[data-part='2'] .name")
    assert name.inner_text() == "bolt (2)"
    assert name.get_attribute("title") == nested().names[2]
    boxes = page.js(
        "[...document.querySelectorAll('details[open] td')].map(e => e.getBoundingClientRect())"
        ".map(b => [b.left, b.right])"
    )
    assert min(left for left, _ in boxes) >= 0
    assert max(right for _, right in boxes) <= 400
    page.page.set_viewport_size({"width": 1200, "height": 800})
    assert page.page.locator("thead").first.is_visible()


def test_on_paper_are_picture_ball_and_tables_and_no_control(opened):
    page = opened("paper-figure-8", color_scheme="dark")
    page.js(
        "() => { const own = CanvasRenderingContext2D.prototype.fillText; window.written = [];"
        " CanvasRenderingContext2D.prototype.fillText = function (words, ...rest) {"
        " if (this.canvas.id === 'printed') window.written.push(words.slice(1, -1));"
        " return own.call(this, words, ...rest); }; }"
    )
    page.page.emulate_media(media="print")
    page.js("window.dispatchEvent(new Event('beforeprint'))")
    assert sorted(page.js("window.written")) == ["C1", "C2", "C3"]
    for name in ("#printed", "#ball", "#margins", "table", "#verdict"):
        assert page.page.locator(name).first.is_visible(), name
    controls = "button, select, input, .gravity, .hint"
    for one in page.page.locator(controls).all():
        assert not one.is_visible() or one.get_attribute("data-part")
    many = page.js(
        "(() => { const c = document.getElementById('printed');"
        " const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
        " let n = 0; for (let k = 3; k < d.length; k += 4) n += d[k] > 0; "
        " return n / d.length * 4; })()"
    )
    assert 0.05 < many < 0.9
    assert page.js("document.documentElement.dataset.theme") == "light"
    page.js("window.dispatchEvent(new Event('afterprint'))")
    assert page.js("document.documentElement.dataset.theme") is None
    plain = len(page.page.pdf())
    page.js("() => { document.getElementById('printed').style.display = 'none'; }")
    assert plain > len(page.page.pdf()) + 10_000  # the size of the picture


def test_a_closed_table_is_printed_and_closed_again(opened):
    page = opened("wall-with-opening")
    closed = "document.querySelectorAll('details:not([open])').length"
    many = page.js(closed)
    assert many > 0
    page.js("window.dispatchEvent(new Event('beforeprint'))")
    assert page.js(closed) == 0
    page.js("window.dispatchEvent(new Event('afterprint'))")
    assert page.js(closed) == many


def test_the_wheel_scrolls_the_page_unless_the_picture_has_the_focus(opened):
    page = opened("paper-figure-8")
    place = "window.kilter.stage.camera.position.length()"
    box = page.page.locator("#picture").bounding_box()
    x, y = box["x"] + 40, box["y"] + 40
    mouse = page.page.mouse
    mouse.move(x, y)
    near = page.js(place)
    mouse.wheel(0, 120)
    page.until("window.scrollY > 60")
    assert page.js(place) == pytest.approx(near)
    page.js("window.scrollTo(0, 0)")
    mouse.click(x, y)
    mouse.wheel(0, 120)
    page.until(f"Math.abs({place} - {near}) > 0.01 * {near}")
    assert page.js("window.scrollY") == 0
    page.page.focus("#ball")
    mouse.wheel(0, 120)
    page.until("window.scrollY > 60")


def test_every_colour_of_the_picture_and_of_the_ball_has_a_legend(opened):
    page = opened(stacks.block_on_slope(0.0, friction=0.5))
    page.js("window.kilter.select(1)")
    shown = {
        name
        for name in ("stable", "undecided", "ramp", "base", "picked", "force", "patch")
        if page.page.locator(f"i.{name}:visible").count()
    }
    assert shown == {"stable", "undecided", "ramp", "base", "picked", "force", "patch"}
    assert not page.page.locator("i.load").is_visible()
    page.page.keyboard.press("Escape")
    page.page.uncheck("#show-forces")
    assert not page.page.is_visible("#force-key")
    part = Part("block", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    loaded = Assembly([part], loads=[kilter.Load("block", [0, 0, -1.0])]).with_floor()
    assert opened(loaded).page.locator("i.load").is_visible()


def test_straps_are_drawn_at_rest_and_have_a_legend(opened):
    base = Part("base", Box([4, 2, 0.2]), Pose([0, 0, -0.1]), grounded=True)
    box = Part("box", Box([1, 1, 1]), Pose([0, 0, 0.5]))
    path = [
        ("base", [-2.0, 0, 0]),
        ("box", [-0.5, 0, 1.0]),
        ("box", [0.5, 0, 1.0]),
        ("base", [2.0, 0, 0]),
    ]
    page = opened(Assembly([base, box], straps=[kilter.Strap(path, tension=100.0)]))
    assert page.page.is_visible("#strap-key")
    counts = "window.kilter.stage.straps.group.children.map(one => one.count)"
    assert page.js(counts) == [3, 3]  # the segments, and their halo
    page.slide("explode", 0.5)
    assert page.js(counts) == []
    assert not page.page.is_visible("#strap-key")
