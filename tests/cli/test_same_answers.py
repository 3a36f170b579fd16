"""A command, its function, its next step and its repeated numbers ask the same question."""

import json
import shlex
from collections.abc import Callable
from dataclasses import replace
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Bond, Box, Joint, Load, Part, PlanRules, Strap
from kilter.cli import main
from kilter.contact import Tolerance
from kilter.scenes import scene
from kilter.scenes.pieces import block, floor

SCENES = ("paper-figure-8", "paper-figure-11", "slope-with-friction", "wall-with-lintel", "pit")
VERBS = ("check", "contacts", "orient", "region", "margin")


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def said(capsys: pytest.CaptureFixture[str], *words: str) -> Any:
    capsys.readouterr()
    main([*words, "--json"])
    return json.loads(capsys.readouterr().out)


def timeless(answer: Any) -> Any:
    """An answer as JSON gives it back, without its times."""
    if isinstance(answer, dict):
        return {key: timeless(value) for key, value in answer.items() if key != "seconds"}
    return [timeless(value) for value in answer] if isinstance(answer, list | tuple) else answer


@pytest.mark.quick(1)
@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize("name", SCENES)
def test_command_and_function_agree(name, verb, capsys):
    kilter.dump(kilter.example(name), "a.json")
    answer = getattr(kilter, verb)(kilter.load("a.json")).to_dict()
    assert timeless(said(capsys, verb, "a.json")) == timeless(answer)


@pytest.mark.slow
def test_options_of_reading_are_those_of_load(capsys):
    kilter.dump(kilter.example("paper-figure-8"), "a.json")
    words = ["--without", "C3", "--down", "0.1", "0", "-1", "--friction", "0.3", "--floor", "-9"]
    answer = said(capsys, "check", "a.json", *words, "--proof", "p.json")
    assembly = kilter.load("a.json", without="C3", down=[0.1, 0, -1], friction=0.3, floor=-9)
    verdict = kilter.check(assembly)
    assert timeless(verdict.to_dict()) == timeless(answer)
    for given in ("a.json", assembly):
        assert timeless(said(capsys, "verify", "a.json", "p.json")) == timeless(
            kilter.verify(given, "p.json").to_dict()
        )


def test_the_list_of_examples(capsys):
    assert said(capsys, "example") == [entry.to_dict() for entry in kilter.example()]


G = 9.81
MU, MASS, PULL = 0.3, 500.0, 2000.0


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A box on a bed, and two straps that pull it forward: a weak one and a strong one."""
    monkeypatch.chdir(tmp_path)
    bed = floor([-5, -2], [5, 2], name="bed")
    parts = [bed, block("box", [-0.5, -0.5, 0], [0.5, 0.5, 1], mass=MASS)]
    kilter.dump(kilter.Assembly(parts, friction=MU), "lorry.json")
    path = [["bed", [4, 0, 0]], ["box", [0.5, 0, 1]]]
    straps = [{"path": path, "capacity": capacity} for capacity in (PULL / 10, 2 * PULL)]
    Path("both.json").write_text(json.dumps(straps))
    Path("weak.json").write_text(json.dumps(straps[:1]))


def answered(capsys: pytest.CaptureFixture[str], code: int, *words: str) -> str:
    capsys.readouterr()
    assert main([*words, "--quiet"]) == code
    return capsys.readouterr().out


def test_the_next_step_of_transport_keeps_the_acceleration(capsys):
    asked = ("lorry.json", "--straps", "weak.json", "--accelerate", ".5g", "0", "0")
    out = answered(capsys, 1, "transport", *asked)
    words = next_words(out)
    assert words[:4] == ["hold", "lorry.json", "--straps", "weak.json"]
    assert [float(x) for x in words[words.index("--accelerate") + 1 :][:3]] == [0.5 * G, 0, 0]
    assert "falls even with" in answered(capsys, 1, *words)


def next_words(out: str) -> list[str]:
    (line,) = (line for line in out.splitlines() if line.startswith("next: "))
    return shlex.split(line.removeprefix("next: kilter "))


@pytest.mark.parametrize("given", [[], ["--straps", "weak.json"]], ids=["none", "weak"])
def test_the_next_step_under_a_code_asks_for_straps_under_this_code(capsys, given):
    asked = ("--code", "en12195", "--forward", "-1", "0", "0")
    words = next_words(answered(capsys, 1, "transport", "lorry.json", *given, *asked))
    assert words[words.index("--straps") + 1] == (given or ["straps.json"])[-1]
    assert words[words.index("--code") + 1] == "en12195"
    assert [float(x) for x in words[words.index("--forward") + 1 :][:3]] == [-1, 0, 0]
    Path("straps.json").write_text(Path("both.json").read_text())
    out = answered(capsys, 1, *words)
    assert f"No set of {2 - len(given) // 2} candidate" in out
    assert "all 4 directions of en12195" in out


def test_the_next_step_beside_straps_of_the_file_asks_for_further_straps(capsys):
    """`hold` searches no supports beside straps, only further straps."""
    data = json.loads(Path("lorry.json").read_text())
    Path("tied.json").write_text(
        json.dumps({**data, "straps": json.loads(Path("weak.json").read_text())})
    )
    out = answered(capsys, 1, "transport", "tied.json", "--accelerate", "0.5g", "0", "0")
    Path("straps.json").write_text(Path("both.json").read_text())
    words = next_words(out)
    assert words[-2:] == ["--straps", "straps.json"]
    assert "1 strap" in answered(capsys, 0, *words)


def test_hold_names_the_straps_that_an_acceleration_needs(capsys):
    """One strap is needed where m (a - mu g) exceeds what friction and its pull resist."""
    still = json.loads(answered(capsys, 0, "hold", "lorry.json", "--straps", "both.json", "--json"))
    assert still["straps"] == []
    asked = ("lorry.json", "--straps", "both.json", "--accelerate", "0.5g", "0", "0")
    braking = json.loads(answered(capsys, 0, "hold", *asked, "--json"))
    (strap,) = braking["straps"]
    assert strap["candidate"] == 2
    assert "kilter plan" not in answered(capsys, 0, "hold", *asked)  # plan refuses straps
    along = np.array([3.5, 0, -1]) / np.linalg.norm([3.5, 0, -1])
    assert strap["pull"] * (along[0] - MU * along[2]) >= MASS * G * (0.5 - MU) * (1 - 1e-9)


@pytest.mark.quick(1)
@pytest.mark.parametrize("command", ["check", "margin", "hold"])
def test_an_acceleration_is_that_of_transport(capsys, command):
    """At 0.29 g friction of 0.3 holds, at 0.31 g it does not."""
    for share, falls in (("0.29g", False), ("0.31g", True)):
        asked = ("lorry.json", "--accelerate", share, "0", "0", "--json")
        carried = json.loads(answered(capsys, int(falls), "transport", *asked))["carried"]
        assert carried is not falls
        code = int(falls and command != "hold")
        data = json.loads(answered(capsys, code, command, *asked))
        if command == "hold":
            assert bool(data["supports"]) is falls


def test_masses_and_loads_are_read_and_proved(capsys):
    """A load of half the weight along the bed is more than friction holds; twice the mass holds."""
    load = f"box={0.5 * MASS * G},0,0"
    asked = ("lorry.json", "--load", load)
    answered(capsys, 1, "check", *asked)
    answered(capsys, 0, "check", *asked, "--mass", f"b?x={2 * MASS}", "--proof", "p.json")
    answered(capsys, 0, "verify", "lorry.json", "p.json")


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        (("--mass", "box"), 'write --mass "bolt*=0.2"'),
        (("--load", "box=1,2"), "write --load lid=0,0,-20"),
        (("--accelerate", "x", "0", "0"), "0.5g"),
        (("--accelerate", "0", "0", "-1g"), "another acceleration"),
        (("--mass", "bax=1"), "box"),
    ],
)
def test_a_wrong_value_names_the_right_form(capsys, words, hint):
    assert main(["check", "lorry.json", *words, "--quiet"]) == 2
    assert hint in " ".join(capsys.readouterr().err.split())


def test_saved_choices_keep_no_question(capsys):
    assert main(["save", "lorry.json", "--mass", "box=3", "-o", "x.kilter.json", "--quiet"]) == 2
    assert not Path("x.kilter.json").exists()


TABLE = block("table", [-50, -50, -10], [50, 50, 0], grounded=True)
OPEN = Assembly(
    [
        TABLE,
        block("sunk", [-40, -40, -2], [-20, -30, 8]),
        block("near", [0, 0, 0.01], [20, 30, 10]),
    ],
    units="mm",
)
"""A part that is sunk by 2 mm over 20 x 10, and a part that hangs by a hundredth."""
MORE = {"limits": [-0.5, 0.25], "friction": 70.0, "stiffness": 3.0, "rest": 0.125}
HINGE = Joint(("arm", "ground"), "revolute", point=[0, 0, 5], axis=[0, 1, 0], **MORE)
ARM = Part("arm", Box([10, 10, 10]), [0, 0, 5])
JOINED = Assembly([TABLE, ARM], units="mm", joints=[HINGE])


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    "verb", ["contacts", "check", "hold", "margin", "orient", "plan", "region", "transport"]
)
def test_open_pairs_have_the_depth_and_the_gap_of_the_drawing(verb):
    pairs = getattr(kilter, verb)(OPEN).to_dict()["open_pairs"]
    found = {tuple(one["parts"]): (one["gap"], one["depth"], one["volume"]) for one in pairs}
    assert found["table", "near"] == (pytest.approx(0.01), None, None)
    assert found["table", "sunk"] == (None, pytest.approx(2), pytest.approx(2 * 20 * 10))


@pytest.mark.quick(2)
@pytest.mark.parametrize("verb", ["contacts", "check", "margin", "orient", "region", "transport"])
def test_joints_have_the_limits_the_friction_and_the_spring_of_the_file(verb):
    """Regions and orientations leave out friction and springs, as their warnings state."""
    (entry,) = getattr(kilter, verb)(JOINED).to_dict()["joints"]
    kept = ("limits",) if verb in ("orient", "region") else tuple(MORE)
    assert {key: entry[key] for key in MORE if key in entry} == {key: MORE[key] for key in kept}


BASE = block("base", [-500, -500, -10], [500, 500, 0], grounded=True)
BOX = Part("box", Box([100, 200, 30]), [0, 0, 15], density=1234.0)
ADDED = Part("more", Box([10, 10, 10]), [200, 0, 5])
PLAIN = Assembly([BASE, BOX], units="mm", friction=0.5, gravity=[0, 0, -3.7])
BONDED = Assembly(
    [BASE, BOX, Part("top", Box([50, 50, 50]), [0, 0, 55], mass=0.3)],
    units="mm",
    bonds=[Bond(("base", "box"), pull=7.0, shear=3.0), Bond(("box", "top"), pull_per_area=0.02)],
)
ANCHORED = Strap([("ground", [400, 0, 15]), ("box", [50, 0, 15])], tension=12.5)
PUSH = Load("box", force=[-11, 0, 0])
STRAPPED = Assembly([BASE, BOX], units="mm", friction=0.5, straps=[ANCHORED])
CASES: dict[str, tuple[Callable[[], Any], dict[str, Any]]] = {
    "check": (
        lambda: kilter.check(
            PLAIN.with_parts([ADDED]), tolerance=Tolerance(gap=0.02, angle=0.01, clearance=0.3)
        ),
        {
            "gravity": [0, 0, -3.7], "down": [0, 0, -1],
            "density.given": [1234, 1234], "density.default": 1000, "tolerance.gap": 0.02,
            "tolerance.angle_deg": 0.5729577951308232, "tolerance.clearance": 0.3,
        },
    ),
    "check of bonds": (
        lambda: kilter.check(BONDED),
        {
            "bonds.0.pull": 7, "bonds.0.shear": 3, "bonds.1.pull_per_area": 0.02,
            "bonds.1.shear": None,
        },
    ),
    "check at an effort": (
        lambda: kilter.check(PLAIN, down=[0.2, 0, -1], effort=0.3, require="proved"),
        {"friction.effort": 0.3, "down": [0.19611613513818404, 0, -0.9805806756909202]},
    ),
    "margin": (lambda: kilter.margin(PLAIN, pushed=[]), {"down": [0, 0, -1]}),
    "plan": (
        lambda: kilter.plan(
            PLAIN, PlanRules(press=2.5, directions=[[0, 0, 1]], carried=[0.1, 0.2, 0])
        ),
        {
            "assumes.press": 2.5, "assumes.directions.0": [0, 0, 1],
            "assumes.carried": [0.1, 0.2, 0], "steps.0.down": [0, 0, -1],
        },
    ),
    "hold": (
        lambda: kilter.hold(replace(STRAPPED, straps=[], loads=[PUSH]), straps=[ANCHORED]),
        {"straps.0.tension": 12.5, "straps.0.candidate": 1},
    ),
    "settle": (lambda: kilter.settle(PLAIN, reach=2.25), {"reach": 2.25}),
    "place": (
        lambda: kilter.place(PLAIN, replace(BOX, name="next"), center_within=0.125, mass=[1, 2]),
        {"center_within": 0.125, "mass": [1, 2]},
    ),
    "transport": (
        lambda: kilter.transport(STRAPPED, polar=False),
        {"straps.0.tension": 12.5, "straps.0.capacity": None, "gravity": 9.81, "down": [0, 0, -1]},
    ),
    "transport under a code": (
        lambda: kilter.transport(PLAIN, code="en12195", forward=[0, 1, 0]),
        {"forward": [0, 1, 0], "cases.0.acceleration": [0, -0.8 * 3.7, 0]},
    ),
    "hold under a code": (
        lambda: kilter.hold(
            replace(STRAPPED, straps=[]), straps=[ANCHORED], code="en12195", forward=[-1, 0, 0]
        ),
        {"cases.0.acceleration": [0.8 * 9.81, 0, 0]},
    ),
    "collapse": (lambda: kilter.transport(PLAIN, collapse=True, fc=1.2), {"fc": 1.2}),
    "verify": (
        lambda: kilter.verify(PLAIN, kilter.check(PLAIN).proof()), {"gravity": [0, 0, -3.7]},
    ),
}  # fmt: skip


@pytest.mark.quick(3)
@pytest.mark.parametrize("name", CASES)
def test_a_number_of_the_question_is_repeated_as_asked(name):
    ask, expected = CASES[name]
    answer = ask().to_dict()
    for path, value in expected.items():
        steps = [int(step) if step.isdigit() else step for step in path.split(".")]
        found = reduce(lambda data, step: data[step], steps, answer)
        assert found == pytest.approx(value, abs=1e-15), path


LIMIT = float(np.degrees(np.arctan(0.2)))
NOTE = "the floor lies across the up direction of the file, (0, 0, 1), and turns with the parts"


def down(degrees: float) -> list[float]:
    """Gravity turned from -z towards +x."""
    return [float(np.sin(np.radians(degrees))), 0.0, -float(np.cos(np.radians(degrees)))]


def words(degrees: float) -> list[str]:
    return ["--down", *(f"{x:.17g}" for x in down(degrees))]


@pytest.fixture
def box(tmp_path: Path) -> str:
    path = tmp_path / "box.kilter.json"
    kilter.dump(
        kilter.Assembly([kilter.Part("b", kilter.Box(0.4, 1, 2), [0, 0, 1])], friction=0.9), path
    )
    return str(path)


@pytest.mark.slow
@pytest.mark.parametrize("floor", [["--floor"], ["--floor", "0"]], ids=["lowest", "height"])
@pytest.mark.parametrize("off", [-0.01, 0.01])
def test_check_falls_where_margin_region_and_orient_have_their_limit(
    box, floor, off, tmp_path, capsys
):
    degrees = LIMIT + off
    proof = tmp_path / "p.json"
    options = [*floor, *words(degrees)]
    code = main(["check", box, *options, "--proof", str(proof), "--json"])
    assert code == (1 if off > 0 else 0)
    assert any(NOTE in warning for warning in json.loads(capsys.readouterr().out)["warnings"])
    table = json.loads(proof.read_text())["parts"][1]
    assert table["center"][:2] == [0.0, 0.0]
    assert main(["verify", box, str(proof), "--quiet"]) == 0
    capsys.readouterr()
    main(["margin", box, *options, "--json"])
    assert json.loads(capsys.readouterr().out)["tilt_deg"] == pytest.approx(-off, abs=1e-6)


def test_region_and_orient_ask_about_the_same_floor(box):
    drawn = kilter.load(box, floor=True)
    turned = kilter.load(box, floor=True, down=down(5))
    for assembly in (drawn, turned):
        region = kilter.region(assembly)
        inside, outside = region.contains([down(LIMIT - 0.01), down(LIMIT + 0.01)])
        assert (inside, outside) == (True, False)
        assert kilter.orient(assembly).tilt_margin_deg == pytest.approx(LIMIT, abs=0.01)


def test_a_floor_without_another_direction_has_no_note(box):
    assert kilter.load(box, floor=True, down=[0, 0, -3]).notes == ()
    assert kilter.load(box, down=down(5)).notes == ()
    sideways = kilter.load(box, floor=True, up="x")
    assert np.allclose(sideways["floor"].pose.matrix[:, 2], [1, 0, 0])


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def written(name: str) -> str:
    kilter.dump(scene(name), f"{name}.json")
    return f"{name}.json"


def ask(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, dict]:
    capsys.readouterr()
    code = main([*words, "--json"])
    out, error = capsys.readouterr()
    assert error == ""
    return code, json.loads(out)


@pytest.mark.slow
def test_where_nothing_is_stable_the_nearest_is_given_with_what_moves(capsys):
    code, answer = ask(capsys, "orient", written("floating-block"))
    assert code == 1
    assert not answer["found"]
    assert set(answer["nearest"]) == {"diamond", "sphere", "kappa"}
    assert any(part["moves"] for part in answer["parts"])
    assert main(["orient", "floating-block.json", "--quiet"]) == 1
    assert "No orientation is stable" in capsys.readouterr().out


@pytest.mark.slow
def test_friction_that_can_hold_it_is_found_and_said_to_be_no_guarantee(capsys):
    code, answer = ask(capsys, "orient", written("arch"), "--method", "walk")
    assert (code, answer["verdict"], answer["method"]) == (0, "found", "walk")
    assert answer["sentence"].startswith("Forces that hold it exist")
    assert "kilter check --down" in answer["sentence"]


@pytest.mark.slow
def test_a_region_common_to_several_lies_in_each(capsys):
    files = [written("paper-figure-10"), written("paper-figure-11")]
    _, answer = ask(capsys, "region", *files, "--common")
    assert answer["kind"] == "ray"
    assert answer["rays"][0] == pytest.approx([-(0.5**0.5), 0, -(0.5**0.5)], abs=1e-9)


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["orient", "books.json"], "load"),
        (["region", "books.json"], "load"),
        (["region", "tower.json", "tower.json"], "--common"),
        (["orient", "tower.json", "--method", "guess"], "joint"),
        (["orient", "nope.json"], "no such file"),
        (["region"], "FILE"),
    ],
)
def test_wrong_usage(words, expected, capsys):
    written("books"), written("tower")
    assert main(words) == 2
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1
    assert expected in error
