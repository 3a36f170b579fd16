"""The tab "What helps": its changes as choices that reach the limit stated, and as files."""

import json
import shlex
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from driver import Message, Page
from test_session import fetched

import kilter
from kilter import Assembly, Box, Load, Part
from kilter.cli import main
from kilter.files.own.choices import Choices
from kilter.scenes import scene

LIMIT = {"tilt": "tilt_deg", "friction": "friction", "strength": "bond"}
"""Key of a margin that has a limit, by the name of the limit."""


def stack(shift: float) -> Assembly:
    """Two cubes, the upper one shifted by a length [m]."""
    table = Part("table", Box(9, 9, 1), [0, 0, -0.5], grounded=True)
    low = Part("low", Box(1, 1, 1), [0, 0, 0.5])
    return Assembly([table, low, Part("high", Box(1, 1, 1), [shift, 0, 1.5])], friction=0.9)


def asked(page: Page, tab: str, **options: Any) -> Message:
    """The result of a tab."""
    page.say(do="ask", tab=tab, options=options)
    return page.hear(lambda message: message.get("is") == "tab")


def opened(page: Page, folder: Path, subject: Assembly | str) -> Message:
    """Open an assembly or an example, and compute what helps."""
    if isinstance(subject, str):
        assert main(["example", subject, "-o", str(folder / subject)]) == 0
        page.after(do="open", file=subject)
    else:
        kilter.dump(subject, folder / "file.kilter.json")
        page.after(do="open", file="file.kilter.json")
    return asked(page, "helps")


CASES = {
    "hold": scene("arch-with-held-ends"),
    "mass": scene("arch-with-held-ends"),
    "size": scene("arch-with-held-ends"),
    "friction": scene("slope-with-friction"),
    "move": stack(0.3),
    "remove": "crane.ldr",
    "add": "crane.ldr",
}
FILES = ("size", "add")
"""Kinds that choices cannot state."""


@pytest.mark.quick(1)
@pytest.mark.parametrize("kind", CASES)
def test_a_change_reaches_its_limit_as_a_choice_or_as_a_file(kind, page, bench, folder):
    tab = opened(page, folder, CASES[kind])
    assert tab["error"] == ""
    assert tab["command"].endswith(" --improve")
    listed = tab["data"]["improvements"]
    assert len(listed) == len(tab["changes"]) == tab["html"].count("data-make")
    k = next(k for k, change in enumerate(listed) if change["what"] == kind)
    action, promised = tab["changes"][k]["action"], listed[k]
    key = LIMIT[promised["of"]]
    assert (action is None) is (kind in FILES)
    if action is None:
        _, data = fetched(bench, f"/export/changed-{k}.kilter.json?token={bench.token}")
        (folder / "changed.kilter.json").write_bytes(data)
        found = kilter.margin(folder / "changed.kilter.json").to_dict()[key]
    else:
        before = page.last["session"]["choices"]
        assert page.after(**action)["check"]["verdict"] in (
            "stable",
            "settles",
            "potentially-stable",
        )
        found = asked(page, "margin")["data"][key]
        session = page.last["session"]
        assert session["changes"][-1]["label"] == promised["sentence"].rpartition(": ")[0]
        Choices.from_dict(session["choices"])
        page.after(do="undo")
        assert page.last["session"]["choices"] == before
    assert found == pytest.approx(promised["limit"], rel=1e-6)
    assert abs(promised["gain"]) > 1e-6


def test_the_picture_of_a_change_has_its_parts_movements_and_bodies(page, folder):
    tab = opened(page, folder, stack(0.3))
    seen = set()
    for change, drawn in zip(tab["data"]["improvements"], tab["changes"], strict=True):
        names = ["table", "low", "high"]
        assert [names[k] for k in drawn["parts"]] == list(change["parts"])
        moves = change["what"] == "move"
        assert len(drawn["pushes"]) == moves
        assert bool(drawn["ghost"]) is (change["what"] in ("move", "size"))
        seen.add(change["what"])
        if moves:
            along = [change["by"] * x for x in change["along"]]
            assert drawn["pushes"][0]["along"] == pytest.approx(along)
    assert {"move", "size", "hold"} <= seen


def test_a_falling_stack_is_made_to_stand(page, folder, capsys, monkeypatch):
    tab = opened(page, folder, stack(0.8))
    assert "Make it stand" in tab["html"]
    assert tab["changes"] == []
    tab = asked(page, "helps", allow=["move", "mass"], tilt=5)
    assert tab["command"].endswith("--make-stand --allow move,mass --tilt 5")
    [change] = tab["changes"]
    assert page.after(**change["action"])["check"]["verdict"] != "unstable"
    assert asked(page, "margin")["data"]["tilt_deg"] >= 5
    assert len(page.last["session"]["changes"]) == 1  # a single change, although two parts move
    tab = asked(page, "helps", allow=["move", "mass"], tilt=4)
    assert "No change is needed" in tab["html"]
    assert tab["changes"] == []
    page.after(do="undo")
    tab = asked(page, "helps", allow=["mass"], tilt=5)
    assert "No change was found" in tab["html"]


def test_the_saved_assembly_is_that_of_the_command(page, bench, folder, capsys, monkeypatch):
    opened(page, folder, stack(0.8))
    tab = asked(page, "helps", allow=["size"], tilt=5)
    _, saved = fetched(bench, f"/export/changed-0.kilter.json?token={bench.token}")
    monkeypatch.chdir(folder)
    words = shlex.split(tab["command"])[1:]
    main([*words, "--write", "written.kilter.json", "--json"])
    assert json.loads(capsys.readouterr().out)["made_stand"] == tab["data"]["made_stand"]
    written, changed = json.loads(Path("written.kilter.json").read_text()), json.loads(saved)
    assert changed["parts"] == written["parts"]
    assert kilter.check(Path("written.kilter.json")).stable
    for number in (1, 9999):
        code, refused = fetched(bench, f"/export/changed-{number}.kilter.json?token={bench.token}")
        assert (code, b"not known any more" in refused) == (409, True)
    page.after(do="friction", mu=0.7)  # the changes were about another state
    code, _ = fetched(bench, f"/export/changed-0.kilter.json?token={bench.token}")
    assert code == 409


def states(tab: Message, kind: str, *parts: str) -> bool:
    """Whether choices state each change of a kind of these parts."""
    [same] = {
        drawn["action"] is not None
        for change, drawn in zip(tab["data"]["improvements"], tab["changes"], strict=True)
        if (change["what"], change["parts"]) == (kind, list(parts))
    }
    return same


def test_choices_hold_no_part_with_a_load(page, folder):
    loads = [Load("high", [100, 0, 0])]
    tab = opened(page, folder, Assembly(stack(0.3).parts, friction=0.9, loads=loads))
    assert "no limit" in tab["html"]
    assert not states(tab, "hold", "high")
    assert states(tab, "move", "high")


def test_choices_move_no_part_that_its_rung_moves(page, folder):
    """The movement was tried from the pose at rest, which is not that of the file."""
    sunk = [
        part if part.name != "high" else replace(part, pose=[0.3, 0, 1.49])
        for part in stack(0.3).parts
    ]
    kilter.dump(Assembly(sunk, friction=0.9), folder / "sunk.kilter.json")
    page.after(do="open", file="sunk.kilter.json")
    page.after(do="assume", rung="play")
    tab = asked(page, "helps")
    assert not states(tab, "move", "high")
    assert states(tab, "hold", "high")
    assert "from a pose that is not the drawn one" in tab["html"]


def test_only_selected_parts_are_held_in_turn(page, folder):
    opened(page, folder, scene("arch"))
    tab = asked(page, "helps", parts=["voussoir-3"])
    assert tab["command"].endswith("--improve --part voussoir-3")
    held = [one["parts"] for one in tab["data"]["improvements"] if one["what"] == "hold"]
    assert held == [["voussoir-3"]]


@pytest.mark.parametrize(
    "options",
    [{"allow": 3}, {"allow": ["fly"]}, {"allow": []}, {"allow": ["move"], "tilt": "much"},
     {"allow": ["move"], "tilt": 90}, {"parts": ["none"]}, {"parts": [3]}],
)  # fmt: skip
def test_a_wrong_question_is_a_sentence(page, options):
    tab = asked(page, "helps", **options)
    assert tab["name"] == "helps"
    assert tab["error"]
