"""`kilter settle`: the exit code and the words of each state."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import kilter
from kilter import Assembly, Box, Part
from kilter.cli import main
from kilter.tell.next_step import next_step


def over_edge(overhang: float) -> Assembly:
    """A unit cube that overhangs the edge of a held block, drawn a little above it."""
    base = Part("base", Box(2, 2, 1), [-1, 0, -0.5], grounded=True)
    return Assembly([base, Part("cube", Box(1, 1, 1), [overhang - 0.5, 0, 0.501])], friction=0.5)


def in_slot(width: float) -> Assembly:
    """A block between two held walls that are 1 apart."""
    walls = [Part(f"wall-{x:+}", Box(1, 2, 2), [x, 0, 0], grounded=True) for x in (-1, 1)]
    floor = Part("floor", Box(3, 2, 1), [0, 0, -1.5], grounded=True)
    return Assembly([*walls, floor, Part("block", Box(width, 1, 1), [0, 0, -0.5])])


@pytest.mark.parametrize(
    ("assembly", "code", "state", "words"),
    [
        (over_edge(0.499), 0, "at-rest", "At rest"),
        (over_edge(0.501), 1, "falls", "falls"),
        (in_slot(1.001), 1, "does-not-fit", "do not fit"),
    ],
    ids=["at rest", "falls", "does not fit"],
)
def test_each_state_has_its_words_and_its_exit_code(
    assembly: Assembly,
    code: int,
    state: str,
    words: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    file = str(tmp_path / "a.kilter.json")
    kilter.dump(assembly, file)
    assert main(["settle", file, "--quiet"]) == code
    assert words in capsys.readouterr().out.splitlines()[0]
    assert main(["settle", file, "--quiet", "--json"]) == code
    assert json.loads(capsys.readouterr().out)["state"] == state


@pytest.mark.parametrize(
    ("options", "first"),
    [
        (["--gap 0.002", "--settle"], "--settle"),
        (["--loose", "--settle"], "--settle"),
        (["--fasten a b", "--settle"], "--fasten"),
        (["--gap 0.002"], "--gap"),
    ],
)
def test_moving_parts_is_a_smaller_assumption_than_a_wider_gap(
    options: list[str], first: str
) -> None:
    """The pose at rest is examined at the level of equilibrium, the other options completely."""
    found = [
        {"option": option, "level": "settles", "leads_to": "settles"}
        if option != "--settle"
        else {"option": option, "level": "equilibrium", "leads_to": "potentially-stable"}
        for option in options
    ]
    answer = {"certificate": [], "verdict": "undecided", "bonds": [], "remedies": found}
    assert next_step(answer, "wall").words[1] == first
