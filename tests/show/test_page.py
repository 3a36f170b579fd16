"""The page: complete, offline, small, and safe against hostile names."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, Part, Pose
from kilter.analysis.everything import everything
from kilter.scenes import SCENES, scene
from kilter.scenes.walls import wall_of
from kilter.show.packing import unpack
from kilter.show.page import render
from kilter.show.workbench_page import workbench_page
from kilter.tell.numbers import force
from sampled import sampled

NAMES = [name for k in range(3) for name in list(SCENES)[k::3]]
"""Names of scenes; every third scene first."""

HOSTILE = [
    "</script><script>window.hit=1</script>",
    "<img src=x onerror=window.hit=1>",
    "\"'`><b onclick=alert(1)>&amp;&lt;",
    "\u202etxt.exe\u2066",
    "שלום עולם",
    "<!--<script>",
    "{{data}}{{program}}",
    "a\nb\tc\x00d\u2028e",
    "long " + "x" * 10_000,
    "__proto__",
]


def data_of(page: str) -> dict:
    found = re.search(r'<script id="data" type="application/json">(.*?)</script>', page, re.S)
    assert found is not None
    return json.loads(found[1])


class Tags(HTMLParser):
    """All elements with their attributes, and the text outside of scripts."""

    def __init__(self, page: str) -> None:
        super().__init__(convert_charrefs=True)
        self.found: list[tuple[str, dict]] = []
        self.text = ""
        self.inside = ""
        self.feed(page)
        self.close()

    def handle_starttag(self, tag: str, attrs: list) -> None:
        self.found.append((tag, dict(attrs)))
        self.inside = tag

    def handle_data(self, data: str) -> None:
        if self.inside not in ("script", "style"):
            self.text += data

    def handle_endtag(self, tag: str) -> None:
        self.inside = ""


def hostile() -> Assembly:
    base = Part("base", Box([40, 4, 1]), Pose([0, 0, -0.5]), grounded=True)
    cubes = [
        Part(name, Box([1, 1, 1]), Pose([2 * k - 10, 0, 0.5])) for k, name in enumerate(HOSTILE)
    ]
    return Assembly([base, *cubes])


@pytest.fixture(scope="module")
def bad() -> str:
    return render(
        everything(hostile()), "</title><script>x</script>", command="kilter report '<b>'"
    )


@pytest.mark.slow
def test_names_are_text_and_nothing_else(bad: str) -> None:
    plain = Tags(render(everything(scene("tower")), "tower"))
    tags = Tags(bad)
    kinds = lambda page: {tag for tag, _ in page.found}  # noqa: E731
    assert kinds(tags) <= kinds(plain) | {"ul", "li", "p", "h3"}
    scripts = [attrs for tag, attrs in tags.found if tag == "script"]
    assert scripts == [{"id": "data", "type": "application/json"}, {}]
    for tag, attrs in tags.found:
        assert not any(key.startswith("on") or key == "style" for key in attrs), (tag, attrs)
    assert HOSTILE[0] in tags.text
    assert HOSTILE[6] in tags.text
    assert "שלום עולם" in tags.text


@pytest.mark.slow
def test_signs_that_turn_text_about_or_control_it_are_replaced(bad: str) -> None:
    for sign in "\u202e\u2066\x00\u2028":
        assert sign not in bad
    names = data_of(bad)["parts"]["names"]
    assert names[4] == "\ufffdtxt.exe\ufffd"
    assert names[8] == "a\ufffdb\ufffdc\ufffdd\ufffde"
    assert len(names[9]) == 10_005
    assert data_of(bad)["title"] == "</title><script>x</script>"


def test_a_name_in_the_table_stands_apart_from_the_direction_of_its_line(bad: str) -> None:
    assert '<bdi class="name">שלום עולם</bdi>' in bad


@pytest.mark.slow
@pytest.mark.parametrize("live", [False, True])
def test_only_the_programs_of_the_page_may_run_and_nothing_may_be_asked_for(live: bool) -> None:
    page = workbench_page("t0") if live else render(everything(scene("tower")), "tower")
    policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', page)
    assert policy is not None
    rules = dict(rule.strip().split(" ", 1) for rule in policy[1].split(";"))
    assert rules["default-src"] == "'none'"
    assert rules.get("connect-src") == ("'self'" if live else None)
    programs = re.findall(r"<script>(.*?)</script>", page, re.S)
    digests = [
        f"'sha256-{base64.b64encode(hashlib.sha256(p.encode()).digest()).decode()}'"
        for p in programs
    ]
    assert rules["script-src"].split() == digests
    assert len(programs) == 1
    style = re.findall(r"<style>(.*?)</style>", page, re.S)
    digest = base64.b64encode(hashlib.sha256(style[0].encode()).digest()).decode()
    assert rules["style-src"] == f"'sha256-{digest}'"
    assert "unsafe" not in policy[1]


@pytest.mark.slow
def test_the_page_names_no_address() -> None:
    page = render(everything(scene("paper-figure-8")), "f8")
    found = set(re.findall(r"[a-z]+://[^\s\"'`<>)]+", page))
    # a namespace of elements, which is never requested
    assert found <= {"http://www.w3.org/1999/xhtml"}
    for tag, attrs in Tags(page).found:
        assert not {"src", "href", "srcset", "action", "data"} & set(attrs), tag


@pytest.mark.slow
def test_a_hundred_parts_take_less_than_a_megabyte_and_a_half() -> None:
    page = render(everything(wall_of(100)), "wall")
    assert len(page.encode()) < 1.5e6


@pytest.mark.slow
def test_the_page_is_the_same_each_time_but_for_the_seconds() -> None:
    first, second = (render(everything(scene("paper-figure-8")), "f8") for _ in range(2))
    seconds = re.compile(r"<dt>seconds</dt><dd>.*?</dd>")
    assert seconds.sub("", first) == seconds.sub("", second)


@pytest.mark.slow
@pytest.mark.parametrize("name", sampled(len(NAMES) // 3, NAMES))
def test_what_is_drawn_is_what_was_answered(name: str) -> None:
    assembly = scene(name)
    # without effort for a proof, so that the answer is fast
    answers = everything(assembly, effort=0)
    data = data_of(render(answers, name))
    verdict = kilter.check(assembly, contacts=answers.contacts, effort=0)
    assert data["given"]["verdict"] == verdict.verdict
    assert data["given"]["sentence"] == verdict.sentence
    assert unpack(data["given"]["moves"]).astype(bool).tolist() == verdict.motion.moves.tolist()
    center = np.array(data["center"])
    middle = unpack(data["parts"]["center"]).reshape(-1, 3) + center
    assert np.allclose(middle, assembly.geometry.center, atol=1e-5 * data["radius"])
    points = unpack(data["patches"]["points"]).reshape(-1, 3) + center
    assert np.allclose(points, answers.contacts.points, atol=1e-5 * data["radius"])
    if data["given"]["motion"] is not None:
        motion = unpack(data["given"]["motion"]).reshape(-1, 6)
        expected = verdict.motion.acceleration.copy()
        expected[:, :3] /= kilter.units.metres_per_unit(assembly.units)
        assert np.allclose(motion, expected, rtol=1e-5, atol=1e-7 * np.abs(expected).max())


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tower", "corner-wedges", "paper-figure-10", "closed-frame"])
def test_forces_of_the_rays_balance_every_part(name: str) -> None:
    assembly = scene(name)
    data = data_of(render(everything(assembly), name))
    rays, center = data["rays"], np.array(data["center"])
    count = len(rays["downs"])
    forces = unpack(rays["forces"]).reshape(count, -1, 3).astype(float)
    points = unpack(rays["points"]).reshape(-1, 3) + center
    parts = unpack(rays["parts"]).reshape(-1, 2)
    geometry = assembly.geometry
    size = np.linalg.norm(assembly.gravity)
    for k, down in enumerate(rays["downs"]):
        total = geometry.mass[:, None] * size * np.array(down)
        torque = np.zeros_like(total)
        for sign, side in ((1, 1), (-1, 0)):
            np.add.at(total, parts[:, side], sign * forces[k])
            arm = points - geometry.center[parts[:, side]]
            np.add.at(torque, parts[:, side], sign * np.cross(arm, forces[k]))
        free = ~geometry.grounded
        most = np.abs(forces[k]).max()
        assert np.abs(total[free]).max() < 1e-5 * most
        assert np.abs(torque[free]).max() < 1e-5 * most * data["radius"]


@pytest.mark.slow
def test_the_map_of_the_page_gives_z_of_the_program() -> None:
    from kilter.contact import detect

    assembly = scene("paper-figure-8")
    data = data_of(render(everything(assembly), "f8"))
    vertices = unpack(data["map"]["vertices"]).reshape(-1, 3)
    motions = unpack(data["map"]["motions"]).reshape(len(vertices), -1, 6)
    contacts = detect.contacts(assembly)
    rng = np.random.default_rng(3)
    for down in rng.normal(size=(30, 3)):
        down = down / np.linalg.norm(down)
        verdict = kilter.check(assembly.with_down(down), contacts=contacts)
        reach = vertices @ down
        best = int(reach.argmax())
        assert -reach[best] == pytest.approx(verdict.displacement.z, abs=1e-9)
        assert np.allclose(motions[best], verdict.displacement.displacement, atol=1e-5)


@pytest.mark.slow
def test_what_is_left_out_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    import kilter.analysis.everything as module

    monkeypatch.setattr(module, "MAP_PARTS", 3)
    monkeypatch.setattr(module, "NEAREST_PARTS", 3)
    answers = everything(scene("hanging-brick"))
    assert answers.map is None
    assert answers.recommended is None
    page = Tags(render(answers, "x")).text
    assert "the page computes the map for up to 3 free parts" in page
    assert "'kilter orient' has no such limit" in page


@pytest.mark.slow
def test_a_table_takes_no_room_in_the_first_view() -> None:
    """A held beam is shown up to 1.5 times the size of the free parts, a table is not."""
    block = Part("block", Box([2, 1, 1]), Pose([0, 0, 0.5]))
    on_table = data_of(render(everything(Assembly([block]).with_floor()), "block"))
    assert on_table["extent"] == pytest.approx([1.0, 0.5, 0.5])
    beam = Part("beam", Box([40, 1, 1]), Pose([0, 0, -0.5]), grounded=True)
    on_beam = data_of(render(everything(Assembly([block, beam])), "block"))
    assert on_beam["extent"] == pytest.approx([2.0, 0.5, 1.0])


def test_a_force_is_said_as_the_program_of_the_page_says_it() -> None:
    """`web/test` tests the page's function `force` with the same table."""
    table = json.loads((Path(__file__).parent / "forces.json").read_text(encoding="utf-8"))
    assert [force(newtons) for newtons, _ in table] == [words for _, words in table]


@pytest.mark.slow
def test_above_its_limit_the_region_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    import kilter.analysis.everything as module

    monkeypatch.setattr(module, "REGION_PARTS", 3)
    answers = everything(scene("tower"))
    assert answers.region is None
    assert data_of(render(answers, "x"))["given"]["verdict"] == "stable"
    assert any("up to 3 free parts" in note for note in answers.notes)


@pytest.mark.slow
def test_a_map_that_needs_too_many_programs_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    import kilter.analysis.everything as module

    monkeypatch.setattr(module, "MAP_PROGRAMS", 20)
    answers = everything(scene("corner-wedges"))
    assert answers.map is None
    assert any("more than 20 programs" in note for note in answers.notes)
    assert answers.region is not None


@pytest.mark.slow
def test_loads_leave_the_given_direction_alone() -> None:
    assembly = scene("tower")
    load = kilter.Load("cube-5", [1.0, 0, 0])
    loaded = Assembly(assembly.parts, loads=[load])
    answers = everything(loaded)
    assert answers.region is None
    assert "does not turn" in answers.notes[0] or "loads" in answers.notes[0]
    data = data_of(render(answers, "x"))
    assert data["region"] is None
    assert data["loads"][0]["force"] == [1.0, 0, 0]


def test_everything_held_is_a_page_too() -> None:
    frame = Assembly([Part("a", Box([1, 1, 1]), grounded=True)])
    assert data_of(render(everything(frame), "x"))["given"]["verdict"] == "stable"


@pytest.mark.slow
def test_nothing_touching_is_a_page_too() -> None:
    data = data_of(render(everything(scene("floating-block")), "x"))
    assert data["given"]["verdict"] == "unstable"


@pytest.mark.slow
def test_the_drawing_has_no_way_to_compute() -> None:
    source = Path(kilter.__file__).parent / "show"
    for path in source.glob("*.py"):
        text = path.read_text(encoding="utf-8")
        run = re.sub(r"if TYPE_CHECKING:\n(    .*\n|\n)+", "", text)
        assert not re.search(r"(from|import) kilter\.(analysis|solvers|mechanics)\b", run), path
