"""The view: names do not cover other parts, all parts are in view, the knob hides no axis."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

pytestmark = pytest.mark.browser

SPOTS = """() => {
    const box = document.getElementById("names").getBoundingClientRect();
    return [...window.kilter.names.tags].map(([part, {element}]) => {
        const r = element.getBoundingClientRect();
        const shown = getComputedStyle(element).visibility === "visible";
        const [x, y] = [box.left, box.top];
        return {part, shown, box: [r.left - x, r.top - y, r.right - x, r.bottom - y]};
    }); }"""
CORNERS = """() => {
    const stage = window.kilter.stage, page = window.kilter.page, found = [];
    stage.render();
    page.parts.names.forEach((_, k) => {
        const p = page.shapes[page.parts.shape[k]].positions;
        for (let i = 0; i < p.length; i += 3)
            found.push(stage.onScreen(stage.parts.carried(k, [...p.subarray(i, i + 3)])));
    });
    return {found, size: stage.size}; }"""


@pytest.mark.parametrize(
    "name", ["paper-figure-8", "tower", "corner-wedges", "bracket", "trough", "closed-frame"]
)
def test_names_lie_on_their_own_parts_and_on_no_other(name: str, opened: Callable) -> None:
    page = opened(name)
    for turn in (0.0, 0.7, 2.0):
        page.js("a => window.kilter.stage.orbit(a, 0)", turn)
        page.page.wait_for_timeout(500)
        spots = [one for one in page.js(SPOTS) if one["shown"]]
        assert spots
        for one in spots:
            left, top, right, bottom = one["box"]
            # tested pixel by pixel with the selection by mouse
            x = np.linspace(left, right, 12)
            y = np.linspace(top, bottom, 5)
            under = page.js(
                "([x, y]) => y.flatMap(v => x.map(u => window.kilter.stage.pick(u, v)))",
                [x.tolist(), y.tolist()],
            )
            assert set(under) <= {one["part"], -1}
            assert one["part"] in under
        for k, one in enumerate(spots):
            for other in spots[:k]:
                a, b = one["box"], other["box"]
                apart = a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
                assert apart, (one, other)


@pytest.mark.parametrize("name", ["tower", "arch", "corner-wedges", "staircase"])
def test_all_stays_in_the_frame_pulled_apart_and_turned(name: str, opened: Callable) -> None:
    page = opened(name)
    page.page.wait_for_timeout(100)
    start = page.js("window.kilter.stage.camera.position.length()")

    def inside() -> None:
        told = page.js(CORNERS)
        wide, high = told["size"]
        places = np.array(told["found"])
        assert (places > 0).all()
        assert (places < [wide, high]).all()

    inside()
    for apart in (0.3, 1.0):
        page.slide("explode", apart)
        inside()
    for down in ([1, 0, 0], [0.5, 0.5, -0.7], [0, 0, 1]):
        page.js("d => window.kilter.ask(d)", down)
        inside()
    page.slide("explode", 0)
    page.page.click("#go-given")
    page.page.wait_for_timeout(50)
    # turned there and back, the view is the same
    assert page.js("window.kilter.stage.camera.position.length()") == pytest.approx(start, rel=1e-6)


def test_the_reader_who_came_nearer_stays_so_much_nearer(opened: Callable) -> None:
    page = opened("tower")
    length = "window.kilter.stage.camera.position.length()"
    far = page.js(length)
    page.js("window.kilter.stage.orbit(0, 0, 0.5)")
    page.slide("explode", 1)
    apart = page.js(length)
    page.page.click("#home")
    assert apart == pytest.approx(0.5 * page.js(length), rel=1e-6)
    assert page.js(length) > 1.3 * far


def test_the_knob_of_gravity_hides_no_axis(opened: Callable) -> None:
    page = opened("corner-wedges")
    ask = """down => {
        const ball = window.kilter.ball, told = [];
        window.kilter.turn(down, {follow: true});
        const own = CanvasRenderingContext2D.prototype.fillText;
        CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
            told.push([text, x, y]); return own.call(this, text, x, y); };
        ball.draw();
        return new Promise(done => {
            const look = () => {
                if (ball.waiting) return setTimeout(look, 5);  // the frame is not painted yet
                CanvasRenderingContext2D.prototype.fillText = own;
                done({told, knob: ball.place(down), side: ball.frame().side});
            };
            look();
        }); }"""
    for axis in np.vstack([np.eye(3), -np.eye(3)]):
        found = page.js(ask, axis.tolist())
        names = [one for one in found["told"] if one[0][0] in "+\N{MINUS SIGN}"]
        assert names
        for _, x, y in names:
            if found["knob"]["front"]:
                gap = np.hypot(x - found["knob"]["x"], y - found["knob"]["y"])
                assert gap > 18  # half of the knob, half of a name
            assert min(x, y, found["side"] - x, found["side"] - y) > 5
