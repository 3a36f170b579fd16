"""The workbench in Chromium: hostile folders, a forwarded port, places and views."""

import json
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from forwarding import Forwarding
from workbench_page import WorkbenchPage

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.placing.place import box_to_place
from kilter.scenes import scene
from kilter.workbench.history import autosave_path
from kilter.workbench.server import Workbench

STARTUP = "export EDITOR=vi\n"
COMMAND = "$(touch hit)"
"""A name that a shell would run, if it stood in its start file."""


@pytest.fixture
def startup(tmp_path: Path) -> Path:
    """A file that a shell runs at its start."""
    path = tmp_path / "profile"
    path.write_text(STARTUP)
    return path


def hostile() -> Assembly:
    base = Part("base", Box([2, 2, 1]), Pose([0, 0, -0.5]), grounded=True)
    return Assembly([base, Part(COMMAND, Box([1, 1, 1]), Pose([1.2, 0, 0.5]))])


@pytest.mark.browser
@pytest.mark.skipif(os.name != "posix", reason="links of POSIX")
def test_a_link_in_the_place_of_the_autosave_is_a_sentence(user, folder, startup):
    page = user(hostile())
    autosave_path(folder / "file.kilter.json").symlink_to(startup)
    (folder / "file.choices.kilter.json").symlink_to(startup.with_name("gone"))
    page.choose(COMMAND).click("#do-hold")
    page.until("!document.getElementById('message').hidden")
    words = page.text("message-words")
    assert "not kept beside the file" in words
    assert "is a link, which is not followed" in words
    page.page.click("#save")
    page.until("!document.getElementById('trouble').hidden")
    refused = "ile.choices.kilter.json: is a link, which is not followed: remove it"
    assert page.text("trouble-words").endswith(refused)
    assert startup.read_text() == STARTUP
    assert sorted(os.listdir(startup.parent)) == [startup.name, "state"]
    # without the links, the same clicks keep and save the choices
    autosave_path(folder / "file.kilter.json").unlink()
    (folder / "file.choices.kilter.json").unlink()
    page.click("#undo")
    page.choose(COMMAND).click("#do-hold")
    page.page.click("#save")
    page.until("!window.bench.session.dirty")
    saved = kilter.load(folder / "file.choices.kilter.json")
    assert [part.grounded for part in saved.parts] == [True, True]


@pytest.mark.browser
def test_a_mesh_outside_of_the_folder_names_the_folder_to_open(user, folder, tmp_path):
    page = user(None)
    (tmp_path / "mesh.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\n")
    (folder / "robot.urdf").write_text(
        '<robot name="r"><link name="a"><collision><geometry>'
        f'<mesh filename="file://{tmp_path / "mesh.obj"}"/></geometry></collision></link></robot>'
    )
    page.page.reload()
    page.begin().page.click("#listed button:has-text('robot.urdf')")
    page.until("!document.getElementById('trouble').hidden")
    above = os.path.commonpath([os.path.realpath(folder), os.path.realpath(tmp_path)])
    assert "outside of the opened folder" in page.text("trouble-words")
    assert f"--folder {above}" in page.text("trouble-words")


HUB = "hub.localhost"
"""A name that browsers look up on this machine; for the workbench it is a foreign name."""
PREFIX = "/user/x/proxy/8899"
WAYS = {
    "a forwarded port": ("localhost", {}, ()),
    "a notebook on this machine": ("127.0.0.1", {"prefix": PREFIX}, ()),
    "a hub": (HUB, {"prefix": PREFIX}, (HUB,)),
    "a proxy that replaces the host": (HUB, {"prefix": PREFIX, "host": "127.0.0.1:8899"}, (HUB,)),
}
"""Host name in the browser, options of the proxy, and host names that the workbench allows."""


@pytest.fixture
def through(
    chromium: Any, tmp_path: Path
) -> Iterator[Callable[..., tuple[WorkbenchPage, Forwarding]]]:
    """Function that opens Figure 8 through a forwarded port; it returns page and port."""
    kilter.dump(scene("paper-figure-8"), tmp_path / "f8.kilter.json")
    ends: list[Callable[[], Any]] = []

    def open_(
        host: str, options: dict[str, str], hosts: tuple[str, ...]
    ) -> tuple[WorkbenchPage, Forwarding]:
        bench = Workbench(tmp_path / "f8.kilter.json", hosts=hosts).__enter__()
        ends.append(lambda: bench.__exit__())
        port = Forwarding(bench.port, **options).__enter__()
        ends.append(lambda: port.__exit__())
        context = chromium.new_context(viewport={"width": 1360, "height": 900})
        ends.append(context.close)
        page = WorkbenchPage(context.new_page(), bench, tmp_path)
        page.page.goto(port.url(bench.url, host))
        return page, port

    yield open_
    for end in reversed(ends):
        end()


QUICK = ("a forwarded port", "a proxy that replaces the host")
"""Ways of which the others are combinations."""


@pytest.mark.browser
@pytest.mark.parametrize(
    "way", [way if way in QUICK else pytest.param(way, marks=pytest.mark.slow) for way in WAYS]
)
def test_a_user_acts_exports_drops_and_saves_through(way, through, tmp_path):
    page, port = through(*WAYS[way])
    page.until("Boolean(window.bench && window.bench.session && window.bench.session.file)")
    page.answered().choose("C3").click("#do-hold")
    held = scene("paper-figure-8").with_grounded(["C3"])
    with page.page.expect_download() as download:
        page.page.select_option("#export", "answer.json")
    download.value.save_as(tmp_path / "answer.json")
    assert json.loads((tmp_path / "answer.json").read_text())["verdict"] == (
        kilter.check(held).verdict
    )
    page.page.click("#save")
    page.until("!window.bench.session.dirty")
    saved = kilter.load(tmp_path / page.js("window.bench.session.saved"))
    assert [part.grounded for part in saved.parts] == [part.grounded for part in held.parts]
    # a file is sent and opened from the address without its last slash
    page.page.goto(page.page.url.replace("/?", "?"))
    page.until("Boolean(window.bench && window.bench.session && window.bench.session.file)")
    page.answered()
    page.page.click("#open-file")
    tower = tmp_path / "tower.kilter.json"
    kilter.dump(scene("tower"), tower)
    page.after(lambda: page.page.set_input_files("#files", tower))
    # the connection of the page returns through the same way
    page.js("window.bench.link.socket.close()")
    page.until("!document.getElementById('connection').hidden")
    page.until("document.getElementById('connection').hidden")
    assert page.text("title") == "tower.kilter.json"
    assert page.faults == []
    # every request was within the path of the proxy
    start = f":{port.port}{port.prefix}"
    assert all(start in url for url in page.asked if url.startswith("http"))
    assert all(path.startswith(port.prefix) for path in port.paths)


@pytest.mark.browser
def test_a_name_that_is_not_allowed_is_named_with_the_option(through):
    page, _ = through(HUB, {"prefix": PREFIX}, ())
    assert f"--host {HUB}" in page.page.inner_text("body")
    # a proxy that replaces the host hides the name: only the origin of the connection shows it
    page, _ = through(HUB, {"prefix": PREFIX, "host": "127.0.0.1:8899"}, ())
    page.until("!document.getElementById('connection').hidden")
    assert f"--host {HUB}" in page.text("connection")
    assert page.js("window.bench.session") is None


WORDS = {"the box stands": "stands", "something falls": "falls", "open": "open"}


@pytest.mark.browser
def test_the_part_follows_the_pointer(opened, tmp_path):
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


@pytest.mark.browser
@pytest.mark.parametrize(
    "name", ["paper-figure-8", "tower", "corner-wedges", "bracket", "trough", "closed-frame"]
)
def test_names_lie_on_their_own_parts_and_on_no_other(name, opened):
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


@pytest.mark.browser
@pytest.mark.parametrize("name", ["tower", "arch", "corner-wedges", "staircase"])
def test_all_stays_in_the_frame_pulled_apart_and_turned(name, opened):
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


@pytest.mark.browser
def test_the_reader_who_came_nearer_stays_so_much_nearer(opened):
    page = opened("tower")
    length = "window.kilter.stage.camera.position.length()"
    far = page.js(length)
    page.js("window.kilter.stage.orbit(0, 0, 0.5)")
    page.slide("explode", 1)
    apart = page.js(length)
    page.page.click("#home")
    assert apart == pytest.approx(0.5 * page.js(length), rel=1e-6)
    assert page.js(length) > 1.3 * far


@pytest.mark.browser
def test_the_knob_of_gravity_hides_no_axis(opened):
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
