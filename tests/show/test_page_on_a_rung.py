"""The answers of a page belong to the rung of the assembly: its poses, its joints, its ladder."""

from dataclasses import replace

import pytest

from kilter import Assembly, Box, Part, Pose
from kilter.analysis.everything import everything
from kilter.assembly.assumption import RUNGS
from kilter.show.ladder_card import NOT_DECIDED, build_ladder
from kilter.show.scene import build_scene
from kilter.tell.ladder_words import ladder_facts

GAP = 2e-4
"""Distance of the block from the plate [m], less than its play."""


def gap_stack(rung: str) -> Assembly:
    """A block that hangs above a held plate, and a handle glued to its side, on a rung."""
    plate = Part("plate", Box([0.2, 0.2, 0.02]), Pose([0, 0, -0.01]), grounded=True)
    block = Part("block", Box([0.06, 0.06, 0.06]), Pose([0, 0, 0.03 + GAP]))
    handle = Part("handle", Box([0.01, 0.02, 0.02]), Pose([0.035, 0, 0.03 + GAP]))
    return replace(Assembly([plate, block, handle]), reading={"assume": rung})


@pytest.mark.slow
@pytest.mark.parametrize(("rung", "height", "held"), [
    ("drawn", 0.03 + GAP, False), ("play", 0.03, False), ("joined", 0.03, True),
])  # fmt: skip
def test_a_page_shows_the_poses_of_its_rung(rung, height, held):
    answers = everything(gap_stack(rung))
    assert answers.given.check["assume"] == rung
    assert (answers.given.check["level"] is not None) == held
    assert answers.assembly.parts[1].pose.position[2] == pytest.approx(height, abs=1e-8)
    # the region belongs to the joints of the rung: without them, no direction holds the handle
    assert answers.region is not None
    assert (answers.region["kind"] != "none") == held
    given = build_scene(answers)["given"]["assumption"]
    assert given["assume"] == rung


def row(**changes):
    plain = {"assume": "play", "friction": None, "verdict": "unstable", "level": None}
    return {**plain, "falls": 1, "names": ["lid"], "decided": True, "why": None, **changes}


def test_rows_have_the_words_of_the_command_and_the_signs_of_their_levels():
    rows = [
        row(assume="drawn"),
        row(decided=False, verdict=None, falls=0, names=[]),
        row(assume="joined", verdict="stable", level="proved", falls=0, names=[]),
        row(friction=0.3, verdict="potentially-stable", level="equilibrium", falls=0, names=[]),
    ]
    answer = {"assume": "drawn", "ladder": rows, "bodies": []}
    shown = build_ladder(answer, gap_stack("drawn"))["rows"]
    words = [words for _, words in ladder_facts(answer)]
    assert [one["words"] for one in shown] == [words[0], NOT_DECIDED, *words[2:]]
    assert [one["name"] for one in shown] == ["drawn", "play", "joined", "friction 0.3"]
    assert [one["holds"] for one in shown] == [False, False, True, True]
    assert [one["assume"] for one in shown] == ["drawn", "play", "joined", "play"]
    assert {one["assume"] for one in shown} <= {*RUNGS}


def test_bodies_are_indices_and_loose_unless_they_stand():
    body = {"mass": 2.0, "tilt_deg": None, "nearest": None, "distance": None, "below": None}
    bodies = [
        {**body, "parts": ["block", "handle"], "name": "block", "on_floor": True, "fall": None},
        {**body, "parts": ["plate"], "name": "plate", "on_floor": False, "nearest": "block",
         "distance": GAP, "below": "block", "fall": GAP},
    ]  # fmt: skip
    answer = {"assume": "joined", "ladder": [], "bodies": bodies}
    shown = build_ladder(answer, gap_stack("drawn"))["bodies"]
    assert [one["parts"] for one in shown] == [[1, 2], [0]]
    assert [one["loose"] for one in shown] == [False, True]
    assert "0.0002 m above block" in shown[1]["words"]
