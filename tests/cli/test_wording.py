"""Sentences that a user reads once: no paper, no contradiction, the reason with the answer."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

import kilter
from kilter import Assembly, Box, Cylinder, Part, Sphere
from kilter.tell.hold_words import hold_facts
from kilter.tell.packing_words import packing_sentence
from kilter.tell.scene_words import scene_sentence
from kilter.tell.tables import moving_table
from kilter.tell.text import text_of
from kilter.tell.transport_facts import transport_sentence
from kilter.tell.words import SENTENCES, verdict_sentence

ROOT = Path(__file__).resolve().parents[2]
TABLE = Part("table", Box(4, 4, 1), [0, 0, -0.5], grounded=True)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_headlines_name_no_paper() -> None:
    assert not [words for words in SENTENCES.values() if "paper" in words or "order" in words]
    verdict = kilter.check(kilter.example("paper-figure-9"))
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.state == "free"  # the blocks can circulate
    assert verdict.sentence == "Stable: it cannot start to move, even without friction."


READ_TWICE = (
    "at a lower level than required", "Stable within the accuracy", "beyond the accuracy of its",
    "whatever the open pairs do", "With its certain contacts", "computed without the open pairs",
    "another set may also be enough", "without forces at its open pairs, it holds",
    "has the level equilibrium", "can move freely without any change",
)  # fmt: skip


def test_no_sentence_has_the_words_that_were_read_twice() -> None:
    written = " ".join(
        " ".join(re.sub(r'"\s*f?"', "", path.read_text("utf-8")).split())
        for path in (ROOT / "src/kilter/tell").glob("*.py")
    )
    assert "as drawn it falls" in written
    assert not [words for words in READ_TWICE if words in written]


@pytest.mark.parametrize(
    ("verdict", "begins"),
    [
        ("stable", "Stable, up to the accuracy of its coordinates: it cannot"),
        ("unstable", "Unstable, by more than the accuracy of its coordinates: no contact"),
    ],
)
def test_the_accuracy_of_coordinates_follows_the_verdict(verdict: str, begins: str) -> None:
    assert verdict_sentence(verdict, coarse=True).startswith(begins)


@pytest.mark.parametrize(("mu", "phrase"), [(0.0, "without friction no"), (1.0, "no contact")])
def test_without_friction_is_said_only_of_files_without_friction(mu: float, phrase: str) -> None:
    hanging = Assembly([TABLE, Part("box", Box(1, 1, 1), [0, 0, 3])], friction=mu)
    assert kilter.check(hanging).sentence.startswith(f"Unstable: {phrase}")


def objects(*states: str, level: str | None = None) -> dict[str, Any]:
    entries = [{"state": state, "level": level} for state in states]
    return {"objects": entries, "require": "settles", "level": level}


@pytest.mark.parametrize(
    ("answer", "sentence"),
    [
        (objects("floats"), "The free object floats."),
        (objects("falls", "held"), "The free object falls."),
        (objects("open"), "The free object is open."),
        (objects("floats", "falls"), "0 of 2 free objects are at rest: 1 floats, 1 falls."),
        (
            objects("at-rest", "at-rest", level="equilibrium"),
            "All 2 free objects are at rest, but 2 do not reach the required level settles.",
        ),
    ],
)
def test_a_single_object_is_not_counted(answer: dict[str, Any], sentence: str) -> None:
    assert scene_sentence(answer) == sentence


def test_a_pile_at_a_lower_level_names_the_required_one() -> None:
    item = {"name": "crate", "verdict": "potentially-stable", "level": "equilibrium"}
    answer = {"first": None, "stands": False, "items": [item], "require": "settles"}
    assert packing_sentence(answer) == (
        "After item 1, 'crate', the pile stands only at the level equilibrium; the level settles "
        "is required."
    )


def test_the_reason_why_no_support_helps_is_a_motion_that_none_stops() -> None:
    motions = [
        {"moving": ["beam"], "stopped_by": ["prop-1"]},
        {"moving": ["lamp"], "stopped_by": []},
    ]
    answer = {
        "verdict": "impossible", "level": None, "base": ["floor"], "motions": motions,
        "straps": None, "cases": [], "judged": 2, "candidates": 2,
    }  # fmt: skip
    reasons = [words for term, words in hold_facts(answer) if term == "because"]
    assert reasons == ["'lamp' would move; stopped by no candidate"]
    assert len(hold_facts({**answer, "verdict": "held"})) == len(hold_facts(answer)) + 1


def test_a_table_without_a_row_is_not_printed() -> None:
    """A ball on a ball: balanced, and nothing starts by itself."""
    below = Part("below", Sphere(1), [0, 0, 1], grounded=True)
    answer = dict(kilter.check(Assembly([below, Part("ball", Sphere(0.5), [0, 0, 2.5])])).to_dict())
    assert answer["verdict"] == "balanced"
    assert not any(part["moves"] or part["slow_motion"] for part in answer["parts"])
    assert moving_table(answer) is None
    assert "the fastest" not in text_of(answer)


@pytest.mark.parametrize(
    ("pairs", "why"), [([], "a limit of the work was reached"), ([{}], "open pairs decide it")]
)
def test_open_pairs_are_blamed_only_if_there_are_any(pairs: list[Any], why: str) -> None:
    case = {"verdict": "undecided", "level": None, "factor": None, "motion": ""}
    answer = {
        "cases": [case], "code": "", "carried": None, "open_pairs": pairs,
    }  # fmt: skip
    assert transport_sentence(answer) == f"Undecided for this acceleration: {why}."


def test_held_parts_that_touch_each_other_are_no_warning(say: Any) -> None:
    box = Part("box", Box(1, 1, 1), [0, 0, 0.5])
    kilter.dump(Assembly([TABLE, box]), "a.kilter.json")
    assert say("check a.kilter.json --floor")[2] == ""
    apart = Part("sign", Box(1, 1, 1), [9, 0, 0.5], grounded=True)
    kilter.dump(Assembly([TABLE, box, apart]), "b.kilter.json")
    assert "is held, but touches nothing: 'sign'" in say("check b.kilter.json")[2]


@pytest.mark.parametrize(
    ("heights", "step"),
    [([0.5, 3], "scene a.kilter.json --settle"), ([3, 4], "scene a.kilter.json --settle"),
     ([0.5, 1.5], "hold a.kilter.json")],
    ids=["one floats", "a group floats", "one falls"],
)  # fmt: skip
def test_the_step_after_a_scene_that_floats_moves_it_to_rest(
    heights: list[float], step: str, say: Any
) -> None:
    boxes = [Part(f"b{k}", Box(1, 1, 1), [0.6 * k, 0, z]) for k, z in enumerate(heights)]
    kilter.dump(Assembly([TABLE, *boxes]), "a.kilter.json")
    code, out, _ = say("check a.kilter.json")
    assert code == 1
    assert f"next: kilter {step}\n" in out


def test_a_plan_that_is_written_as_a_page_prints_its_sentence(say: Any) -> None:
    kilter.dump(kilter.example("arch").without("voussoir-1?"), "a.kilter.json")
    sentence = kilter.plan("a.kilter.json", floor=True).sentence
    _, out, error = say("plan a.kilter.json --floor -o x.html --quiet")
    assert (out, error) == ("", "")
    _, _, error = say("plan a.kilter.json --floor -o x.html")
    assert " ".join(sentence.split()) in " ".join(error.split())


def test_a_layer_over_another_file_than_usd_is_refused(say: Any) -> None:
    kilter.dump(Assembly([TABLE, Part("box", Box(1, 1, 1), [0, 0, 0.501])]), "a.kilter.json")
    code, out, error = say("settle a.kilter.json -o rest.usda")
    assert (code, out) == (2, "")
    assert "a USD layer moves the objects of a USD file" in error
    assert "export it anew" not in error
    assert not Path("rest.usda").exists()


@pytest.mark.slow
@pytest.mark.parametrize(("shape", "exact"), [(Box(2, 2, 4), True), (Cylinder(1, 4), False)])
def test_a_push_over_a_round_edge_is_not_called_exact(shape: Any, exact: bool) -> None:
    """The tower tips at atan(1 / 2), over a circle, too. A push counts it as a polygon inside."""
    import math

    tower = Assembly([TABLE, Part("tower", shape, [0, 0, 2])], friction=2)
    margin = kilter.margin(tower)
    tips = math.degrees(math.atan(1 / 2))
    assert margin.exact is exact is margin.to_dict()["exact"]
    assert kilter.margin(tower, pushed=[]).exact
    assert margin.tilt_deg == pytest.approx(tips, abs=1e-6)


def test_a_packing_list_is_a_file_of_every_command(say: Any) -> None:
    Path("list.csv").write_text(
        "name,length,width,height,mass,x,y,z\na,1,1,1,5,0,0,0\nb,1,1,1,5,0,0,1\n", "utf-8"
    )
    answer = json.loads(say("check list.csv --floor --json")[1])
    assert [part["name"] for part in answer["parts"]][:2] == ["a", "b"]
    shown = say("check --help")[1].replace("│", " ")
    assert "a packing list (CSV)" in " ".join(shown.split())


def test_the_readme_counts_the_blocks_of_its_first_command() -> None:
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    example = kilter.load(ROOT / "examples/paper-figure-9.kilter.json")
    words = {2: "two", 3: "three", 4: "four", 5: "five"}
    free = sum(not part.grounded for part in example)
    assert re.search(rf"checks an example of {words[free]} free blocks", readme)


def test_a_stack_that_a_simulator_sank_is_not_proposed_to_be_joined(say: Any) -> None:
    """It topples: the upper cube hangs over the lower one by more than half of its width."""
    cube = Box(0.1, 0.1, 0.1)
    low, high = Part("low", cube, [0, 0, 0.0497]), Part("high", cube, [0.06, 0, 0.1492])
    table = Part("table", Box(1, 1, 0.1), [0, 0, -0.05], grounded=True)
    stack = Assembly([table, low, high], friction=0.5)
    kilter.dump(stack, "sunk.kilter.json")
    code, out, _ = say("check sunk.kilter.json")
    assert code == 4
    assert "next: kilter settle sunk.kilter.json" in out
    assert "--fasten" not in out
    assert kilter.check(stack).remedies == ()
