"""The page of a verdict: its words, numbers by hand, and safety."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import math
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, InputError, Load, Part, Pose, Prism
from kilter.analysis.everything import everything
from kilter.notebook import Shown, cell
from kilter.scenes import SCENES, scene
from kilter.scenes.pieces import block
from kilter.scenes.walls import wall_of
from kilter.show.packing import unpack
from kilter.show.page import render, workbench_page
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
def test_names_are_text_and_nothing_else(bad):
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
def test_signs_that_turn_text_about_or_control_it_are_replaced(bad):
    for sign in "\u202e\u2066\x00\u2028":
        assert sign not in bad
    names = data_of(bad)["parts"]["names"]
    assert names[4] == "\ufffdtxt.exe\ufffd"
    assert names[8] == "a\ufffdb\ufffdc\ufffdd\ufffde"
    assert len(names[9]) == 10_005
    assert data_of(bad)["title"] == "</title><script>x</script>"


def test_a_name_in_the_table_stands_apart_from_the_direction_of_its_line(bad):
    assert '<bdi class="name">שלום עולם</bdi>' in bad


@pytest.mark.slow
@pytest.mark.parametrize("live", [False, True])
def test_only_the_programs_of_the_page_may_run_and_nothing_may_be_asked_for(live):
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
def test_the_page_names_no_address():
    page = render(everything(scene("paper-figure-8")), "f8")
    found = set(re.findall(r"[a-z]+://[^\s\"'`<>)]+", page))
    # namespaces of elements, which are never requested
    assert found <= {"http://www.w3.org/1999/xhtml", "http://www.w3.org/2000/svg"}
    for tag, attrs in Tags(page).found:
        assert not {"src", "href", "srcset", "action", "data"} & set(attrs), tag


@pytest.mark.slow
def test_a_hundred_parts_take_less_than_a_megabyte_and_a_half():
    page = render(everything(wall_of(100)), "wall")
    assert len(page.encode()) < 1.5e6


@pytest.mark.slow
def test_the_page_is_the_same_each_time_but_for_the_seconds():
    first, second = (render(everything(scene("paper-figure-8")), "f8") for _ in range(2))
    seconds = re.compile(r"<dt>seconds</dt><dd>.*?</dd>")
    assert seconds.sub("", first) == seconds.sub("", second)


@pytest.mark.slow
@pytest.mark.parametrize("name", sampled(len(NAMES) // 3, NAMES))
def test_what_is_drawn_is_what_was_answered(name):
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
def test_forces_of_the_rays_balance_every_part(name):
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
def test_the_map_of_the_page_gives_z_of_the_program():
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
def test_what_is_left_out_is_said(monkeypatch):
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
def test_a_table_takes_no_room_in_the_first_view():
    """A held beam is shown up to 1.5 times the size of the free parts, a table is not."""
    block = Part("block", Box([2, 1, 1]), Pose([0, 0, 0.5]))
    on_table = data_of(render(everything(Assembly([block]).with_floor()), "block"))
    assert on_table["extent"] == pytest.approx([1.0, 0.5, 0.5])
    beam = Part("beam", Box([40, 1, 1]), Pose([0, 0, -0.5]), grounded=True)
    on_beam = data_of(render(everything(Assembly([block, beam])), "block"))
    assert on_beam["extent"] == pytest.approx([2.0, 0.5, 1.0])


def test_a_force_is_said_as_the_program_of_the_page_says_it():
    """`web/test` tests the page's function `force` with the same table."""
    table = json.loads((Path(__file__).parent / "forces.json").read_text(encoding="utf-8"))
    assert [force(newtons) for newtons, _ in table] == [words for _, words in table]


@pytest.mark.slow
def test_above_its_limit_the_region_is_left_out(monkeypatch):
    import kilter.analysis.everything as module

    monkeypatch.setattr(module, "REGION_PARTS", 3)
    answers = everything(scene("tower"))
    assert answers.region is None
    assert data_of(render(answers, "x"))["given"]["verdict"] == "stable"
    assert any("up to 3 free parts" in note for note in answers.notes)


@pytest.mark.slow
def test_a_map_that_needs_too_many_programs_is_left_out(monkeypatch):
    import kilter.analysis.everything as module

    monkeypatch.setattr(module, "MAP_PROGRAMS", 20)
    answers = everything(scene("corner-wedges"))
    assert answers.map is None
    assert any("more than 20 programs" in note for note in answers.notes)
    assert answers.region is not None


@pytest.mark.slow
def test_loads_leave_the_given_direction_alone():
    assembly = scene("tower")
    load = kilter.Load("cube-5", [1.0, 0, 0])
    loaded = Assembly(assembly.parts, loads=[load])
    answers = everything(loaded)
    assert answers.region is None
    assert "does not turn" in answers.notes[0] or "loads" in answers.notes[0]
    data = data_of(render(answers, "x"))
    assert data["region"] is None
    assert data["loads"][0]["force"] == [1.0, 0, 0]


def test_everything_held_is_a_page_too():
    frame = Assembly([Part("a", Box([1, 1, 1]), grounded=True)])
    assert data_of(render(everything(frame), "x"))["given"]["verdict"] == "stable"


@pytest.mark.slow
def test_nothing_touching_is_a_page_too():
    data = data_of(render(everything(scene("floating-block")), "x"))
    assert data["given"]["verdict"] == "unstable"


@pytest.mark.slow
def test_the_drawing_has_no_way_to_compute():
    source = Path(kilter.__file__).parent / "show"
    for path in source.glob("*.py"):
        text = path.read_text(encoding="utf-8")
        run = re.sub(r"if TYPE_CHECKING:\n(    .*\n|\n)+", "", text)
        assert not re.search(r"(from|import) kilter\.(analysis|solvers|mechanics)\b", run), path


G = 9.81
TABLE = block("table", [-3000, -1000, -1000], [0, 1000, 0], grounded=True)


class Cells(HTMLParser):
    """The terms of lists with their values, and the rows of tables, as text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.within = False
        self.feed(re.sub(r"<(script|style)\b.*?</\1>", "", page, flags=re.S))

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag in ("tr", "dt"):
            self.rows.append([])
        if tag in ("td", "th", "dt", "dd"):
            self.rows[-1].append("")
            self.within = True

    def handle_endtag(self, tag: str) -> None:
        self.within = self.within and tag not in ("td", "th", "dt", "dd")

    def handle_data(self, data: str) -> None:
        if self.within:
            self.rows[-1][-1] += data.strip()


def paged(assembly: Assembly) -> tuple[list[list[str]], dict]:
    """Rows of the text of a page, and its data."""
    page = render(everything(assembly, margins=True), "page")
    [data] = re.findall(r'<script id="data" type="application/json">(.*?)</script>', page, re.S)
    return Cells(page).rows, json.loads(data)


def row_of(rows: list[list[str]], *first: str, length: int) -> list[str]:
    [found] = [row for row in rows if row[: len(first)] == list(first) and len(row) == length]
    return found[len(first) :]


def numbers(text: str) -> list[float]:
    return [float(one) for one in re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?", text)]


@pytest.mark.slow
def test_a_beam_on_two_ridges():
    """Ridges at x = -1000 and 2000, and a beam of 100 kg with its centre at x = 300."""
    triangle = [[-100, -100], [100, -100], [0, 0]]
    left, right = (
        Part(name, Prism(triangle, 400.0), Pose([x, 0, 0]), grounded=True)
        for name, x in (("left", -1000), ("right", 2000))
    )
    beam = Part("beam", Box([5000, 200, 200]), [300, 0, 100], density=500.0)
    rows, data = paged(Assembly([left, right, beam], units="mm", friction=0.4))
    shares = {"left": 1700 / 3000, "right": 1300 / 3000}
    for name, x in (("left", -1000), ("right", 2000)):
        force, direction, at, _ = row_of(rows, name, "beam", length=6)
        assert force.endswith(" N")
        assert numbers(force) == [pytest.approx(shares[name] * 100 * G, rel=1e-3)]
        assert (numbers(direction), numbers(at)) == ([0, 0, 1], [x, 0, 0])
        words = row_of(rows, name, "beam", length=8)
        assert words == ["edge-face", "0", "0", "(0, 0, 1)", "0.4", "2"]
    state, _, mass, centre = row_of(rows, "beam", length=5)
    assert (state, mass, numbers(centre)) == ("stays", "100", [300, 0, 100])
    # the shortest push across the cone of friction, and the angle of friction
    push = numbers(row_of(rows, "weakest push", length=2)[0])
    angle = math.atan(0.4)
    assert push[0] == pytest.approx(100 * G * math.sin(angle), rel=1e-3)
    assert numbers(row_of(rows, "tilt", length=2)[0])[0] == pytest.approx(
        math.degrees(angle), rel=1e-5
    )
    assert numbers(row_of(rows, "mass", length=2)[0]) == [100]
    # forces of the picture, on the beam
    center = np.array(data["center"])
    given = data["given"]["forces"]
    points = unpack(given["points"]).reshape(-1, 3) + center
    forces = unpack(given["forces"]).reshape(-1, 3)
    for name, x in (("left", -1000), ("right", 2000)):
        here = np.abs(points[:, 0] - x) < 1
        assert forces[here].sum(axis=0) == pytest.approx([0, 0, shares[name] * 100 * G], abs=1e-3)
    assert unpack(data["parts"]["mass"])[2] == pytest.approx(100)
    # the box of the view: the beam, and the ridges below it
    assert data["extent"] == pytest.approx([2500, 200, 150])
    assert (data["gravity"], data["units"]) == (G, "mm")


@pytest.mark.slow
def test_a_cube_past_an_edge_and_a_load():
    """It turns about the edge 100 mm beside its centre: the motion is in mm/s^2, the load in N."""
    past = block("past", [-400, -500, 0], [600, 500, 1000], density=500.0)
    rows, data = paged(Assembly([TABLE, past], units="mm"))
    turn = G * 0.1 / (1 / 6 + 0.1**2)
    state, motion, mass, centre = row_of(rows, "past", length=5)
    assert (state, mass, numbers(centre)) == ("moves", "500", [100, 0, 500])
    assert numbers(motion)[3] == pytest.approx(turn, rel=1e-3)
    assert numbers(motion)[-1] == pytest.approx(0.1 * turn / G, rel=1e-2)
    drawn = unpack(data["given"]["motion"]).reshape(-1, 6)[1]
    assert drawn == pytest.approx([0, 0, -100 * turn, 0, turn, 0], rel=1e-6, abs=1e-6)
    assert data["given"]["z"] == pytest.approx(-500)
    assert data["given"]["instability"] == pytest.approx(math.sqrt(0.1 * turn / G))
    assert unpack(data["patches"]["area"]) == pytest.approx([400 * 1000])
    # the map: a shift of 1 mm down gains 500 kg mm for gravity of length 1
    vertices = unpack(data["map"]["vertices"]).reshape(-1, 3)
    assert (data["map"]["mass"], (vertices @ [0, 0, -1]).max()) == pytest.approx((500, 500))
    on = block("on", [-2000, -500, 0], [-1000, 500, 1000], density=500.0)
    load = Load("on", force=[0, 0, -70], point=[-1500, 0, 1000])
    _, data = paged(Assembly([TABLE, on], units="mm", loads=[load]))
    assert data["loads"][0]["force"] == [0, 0, -70]
    at = np.array(data["loads"][0]["point"]) + data["center"]
    assert at == pytest.approx([-1500, 0, 1000])
    forces = unpack(data["given"]["forces"]["forces"]).reshape(-1, 3)
    assert forces.sum(axis=0) == pytest.approx([0, 0, 500 * G + 70], rel=1e-6)


@pytest.mark.slow
def test_a_torque_needs_friction_although_its_resultant_is_none():
    """A slab is turned by 60 % of the torque of friction at its corners, 300 sqrt 2 mm away."""
    slab = Part("slab", Box([600, 600, 20]), [-1500, 0, 10], mass=10.0)
    torque = 0.6 * 0.5 * 10 * G * 300 * math.sqrt(2)
    load = Load("slab", force=[0, 0, 0], torque=[0, 0, torque])
    rows, data = paged(Assembly([TABLE, slab], units="mm", loads=[load], friction=0.5))
    forces = data["given"]["forces"]
    assert unpack(forces["use"]) == pytest.approx([0.6] * 4, abs=1e-4)
    assert unpack(forces["forces"]).reshape(-1, 3).sum(axis=0)[:2] == pytest.approx(0, abs=1e-3)
    assert numbers(row_of(rows, "table", "slab", length=6)[3]) == [60]


@pytest.mark.slow
def test_the_fall_of_a_ball_off_a_ball_loses_its_weight_times_its_height():
    below = Part("below", kilter.Sphere(300.0), grounded=True)
    above = Part("above", kilter.Sphere(100.0), [0, 0, 400], mass=2.0)
    _, data = paged(Assembly([below, above], units="mm"))
    fall = data["given"]["fall"]["places"]
    motions = unpack(fall["motions"]).reshape(len(unpack(fall["energies"])), -1, 6)
    down = motions[:, 0, 2]
    assert down[-1] < -1
    assert unpack(fall["energies"]) == pytest.approx(2 * G * down * 1e-3, rel=1e-5, abs=1e-9)
    # the balls stay apart
    apart = np.linalg.norm(motions[:, 0, :3] + [0, 0, 400], axis=1)
    assert apart.min() >= 400 - 1e-3


def page_in(shown: str) -> str:
    [text] = re.findall(r'srcdoc="([^"]*)"', shown)
    return html.unescape(text)


ANSWERS = [
    lambda: kilter.check(scene("tower")),
    lambda: kilter.region(scene("corner-wedges")),
    lambda: kilter.plan(scene("tower")),
]


@pytest.mark.slow
@pytest.mark.parametrize("ask", ANSWERS, ids=["verdict", "region", "plan"])
def test_a_cell_has_the_page_that_report_writes(ask):
    answer = ask()
    shown = answer.show(height=333, title='<"me">')
    assert isinstance(shown, Shown)
    subject = {
        kilter.Verdict: lambda: answer.assembly,
        kilter.Region: lambda: answer.assemblies[0],
        kilter.Order: lambda: answer,
    }[type(answer)]()
    frame = shown._repr_html_()
    assert _untimed(page_in(frame)) == _untimed(kilter.report(subject, title='<"me">').html)
    assert "height:333px" in frame
    assert frame.count("<iframe") == frame.count("</iframe>") == 1
    assert "allow-same-origin" not in frame


def _untimed(page: str) -> str:
    """Remove the times of the answer."""
    return re.sub(r"\d+(\.\d+)?(e-\d+)? ?m?s\b", "", page)


@pytest.mark.slow
def test_a_viewer_without_programs_gets_a_figure():
    pytest.importorskip("matplotlib")
    drawn = kilter.check(scene("tower")).show()._repr_svg_()
    assert drawn is not None
    assert "<svg" in drawn[:600]
    assert "<script" not in drawn
    none = kilter.plan(scene("tower"), kilter.PlanRules(hold=0))
    assert none.found or none.show()._repr_svg_() is None


@pytest.mark.slow
def test_what_cannot_be_shown_is_told():
    towers = [scene("tower"), scene("tower")]
    with pytest.raises(InputError, match=r"belongs to 2 assemblies, but a page shows one"):
        kilter.common_region(towers).show()
    with pytest.raises(InputError, match="the height is 'tall'; give a whole number of pixels"):
        cell(kilter.check(scene("tower")), height="tall")  # type: ignore[arg-type]


@pytest.mark.slow
def test_a_kernel_of_jupyter_shows_it():
    pytest.importorskip("ipykernel")
    pytest.importorskip("nbclient")
    import nbformat
    from nbclient import NotebookClient

    source = "import kilter\nkilter.check(kilter.example('tower')).show()"
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(source)])
    NotebookClient(notebook, kernel_name="python3", timeout=120).execute()
    [output] = notebook.cells[0].outputs
    assert output.output_type == "execute_result"
    assert "Stable" in page_in(output.data["text/html"])
    assert output.data["text/plain"].startswith("<Shown: <Verdict: stable")
    assert "<svg" in output.data["image/svg+xml"]
