"""The parts are settled by a change of the choices: undone, saved and repeated as other changes."""

from __future__ import annotations

import json
import shlex
import urllib.request
from pathlib import Path
from typing import Any

import pytest
from driver import Message, Page

import kilter
from kilter import Assembly, Box, Joint, Load, Part, Pose
from kilter.cli import main
from kilter.scenes.walls import wall_of
from kilter.workbench.server import Workbench

DEPTH = 1e-3
"""Depth of each overlap, and height of each hanging part [m]."""


def sunken(**more: Any) -> Assembly:
    """A block sunk into the base, and a block sunk into this block."""
    base = Part("base", Box([6, 6, 1]), Pose([0, 0, -0.5]), grounded=True)
    low = Part("low", Box([1, 1, 1]), Pose([0, 0, 0.5 - DEPTH]))
    high = Part("high", Box([1, 1, 1]), Pose([0.2, 0, 1.5 - 2 * DEPTH]))
    return Assembly([base, low, high], friction=0.5, **more)


def opened(page: Page, folder: Path, assembly: Assembly, name: str) -> Message:
    """Open an assembly in the workbench; return its answer."""
    kilter.dump(assembly, folder / name)
    assert page.say(do="open", file=name)["ok"]
    return page.answer()


def settle(page: Page) -> Message:
    """Settle the parts, and wait for the complete answer, or for the refusal."""
    state = page.last["session"]["state"]
    assert page.say(do="settle")["ok"]
    ended = page.hear(
        lambda m: (m.get("is") == "session" and m["state"] > state) or m.get("is") == "tab"
    )
    return ended if ended["is"] == "tab" else page.answer()


def without_seconds(text: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads(text)
    del data["seconds"]
    return data


def exported(bench: Workbench) -> dict[str, Any]:
    """The answer of the present state, as the page downloads it."""
    address = f"http://127.0.0.1:{bench.port}/export/answer.json?token={bench.token}"
    with urllib.request.urlopen(address, timeout=60) as answer:
        return without_seconds(answer.read())


@pytest.mark.slow
def test_the_settled_state_is_saved_and_repeated_by_the_command(
    page: Page,
    bench: Workbench,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    drawn = opened(page, folder, sunken(), "sunken.kilter.json")
    assert drawn["check"]["verdict"] == "undecided"
    assert drawn["settle"]["parts"] == "2 overlapping pairs"
    assert drawn["settle"]["result"] == "at rest after moving 0.002 m, then stable"
    answer = settle(page)
    assert answer["check"]["verdict"] == "stable"
    assert answer["settle"] is None
    poses = page.last["session"]["choices"]["poses"]
    assert poses["low"]["position"] == pytest.approx([0, 0, 0.5], abs=1e-8)
    assert poses["high"]["position"] == pytest.approx([0.2, 0, 1.5], abs=1e-8)
    assert page.last["session"]["command_needs_save"]
    page.say(do="save")
    shown = exported(bench)
    monkeypatch.chdir(folder)
    capsys.readouterr()
    assert main([*shlex.split(page.last["session"]["command"])[1:], "--json"]) == 0
    assert without_seconds(capsys.readouterr().out) == shown
    assert main(["check", "sunken.kilter.json", "--settle", "--json"]) == 0
    settled = without_seconds(capsys.readouterr().out)
    same = ("verdict", "level", "guarantee", "contacts", "open_pairs", "down", "neutral")
    assert {key: settled[key] for key in same} == {key: shown[key] for key in same}
    assert settled["sentence"] == f"Settled by 0.002 m: {shown['sentence']}"


@pytest.mark.slow
def test_the_movement_is_undone_redone_restored_and_shown_by_a_second_page(
    page: Page, bench: Workbench, folder: Path
) -> None:
    drawn = opened(page, folder, sunken(), "twice.kilter.json")
    before = page.last["session"]["choices"]
    at_rest = settle(page)
    moved = page.last["session"]["choices"]
    other = Page(bench)
    other.hear(lambda m: m.get("is") == "answer")
    assert other.last["session"]["choices"] == moved
    assert other.last["answer"]["check"] == at_rest["check"]
    other.close()
    assert page.after(do="undo")["check"] == drawn["check"]
    assert page.last["session"]["choices"] == before
    assert page.after(do="redo")["check"] == at_rest["check"]
    assert page.last["session"]["choices"] == moved
    # the changes are kept in a file: the reopened file has them
    page.say(do="close")
    page.say(do="open", file="twice.kilter.json")
    assert page.answer()["check"] == at_rest["check"]
    assert page.last["session"]["choices"] == moved
    assert page.after(do="poses", poses=None)["check"] == drawn["check"]
    assert "poses" not in page.last["session"]["choices"]


@pytest.mark.slow
def test_a_load_of_the_choices_moves_with_its_part(page: Page, folder: Path) -> None:
    opened(page, folder, sunken(), "loaded.kilter.json")
    tip = [0.2, 0, 2 - 2 * DEPTH]
    page.after(do="load", part="high", force=[0, 0, -1], point=tip)
    page.after(do="load", part="high", force=[0, 0, -2])
    assert settle(page)["check"]["verdict"] == "stable"
    first, second = page.last["session"]["choices"]["loads"]
    assert first["point"] == pytest.approx([0.2, 0, 2], abs=1e-8)
    assert "point" not in second
    page.after(do="undo")
    assert page.last["session"]["choices"]["loads"][0]["point"] == tip


REFUSED = {
    "does not fit": (
        Assembly(
            [
                Part("left", Box([1, 1, 1]), Pose([-1, 0, 0.5]), grounded=True),
                Part("right", Box([1, 1, 1]), Pose([1, 0, 0.5]), grounded=True),
                Part("wedged", Box([1.001, 1, 1]), Pose([0, 0, 0.5])),
            ]
        ),
        "do not fit",
    ),
    "at rest": (
        sunken().with_poses({"low": Pose([0, 0, 0.5]), "high": Pose([0.2, 0, 1.5])}),
        "at rest as drawn",
    ),
    "load of the file": (
        sunken(loads=[Load("high", [0, 0, -1], point=[0.2, 0, 2 - 2 * DEPTH])]),
        "the loads of the file move",
    ),
    "joint of the file": (
        sunken(joints=[Joint(["low", "ground"], "prismatic", [0, 0, 0.5], [0, 0, 1])]),
        "the joints of the file move",
    ),
}  # fmt: skip


@pytest.mark.quick("does not fit")
@pytest.mark.parametrize("name", REFUSED)
def test_a_refusal_is_a_sentence_and_changes_nothing(name: str, page: Page, folder: Path) -> None:
    assembly, said = REFUSED[name]
    opened(page, folder, assembly, "refused.kilter.json")
    before = page.last["session"]["state"]
    reply = settle(page)
    assert (reply["is"], reply["name"]) == ("tab", "settle")
    assert said in reply["error"]
    assert page.last["session"]["state"] == before


@pytest.mark.slow
def test_another_change_and_a_stop_end_the_search(page: Page, folder: Path) -> None:
    wall = wall_of(300)
    lifted = {part.name: Pose(part.pose.position * [1, 1, 1 + DEPTH]) for part in wall.parts[1:]}
    opened(page, folder, wall.with_poses(lifted), "wall.kilter.json")
    assert page.say(do="settle")["ok"]
    page.hear(lambda m: m.get("is") == "progress" and m["what"] == "settle" and m["working"])
    assert page.say(do="stop")["ok"]
    stopped = page.hear(lambda m: m.get("is") == "tab")
    assert (stopped["name"], stopped["error"]) == ("settle", "the computation was stopped")
    assert page.say(do="settle")["ok"]
    assert page.after(do="friction", mu=0.6)["is"] == "answer"
    assert set(page.last["session"]["choices"]) == {"kilter", "file", "sha256", "friction"}


@pytest.mark.slow
def test_poses_do_not_fit_another_content_of_the_file(page: Page, folder: Path) -> None:
    opened(page, folder, sunken(), "changed.kilter.json")
    page.after(do="friction", mu=0.7)
    settle(page)
    wide = sunken().with_poses({"base": Pose([0, 0, -0.7])})
    kilter.dump(wide, folder / "changed.kilter.json")
    page.hear(lambda m: m.get("is") == "session" and "was read again" in m["message"])
    session = page.last["session"]
    assert session["message"].endswith(
        "these changes do not fit any more: settle: parts move by up to 0.002 m"
    )
    assert session["choices"]["friction"] == 0.7
    assert "poses" not in session["choices"]
