"""Where no solver finishes the impending motion: every command says so, none ends as a fault."""

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

import kilter
from kilter.analysis.decision.motion import NO_MOTION
from kilter.cli import main
from kilter.scenes import scene, stacks
from kilter.tell.tables import NO_ACCELERATION
from kilter.tell.words import GAINS

SAID = "no solver finished the program of the impending motion"


@pytest.fixture(autouse=True)
def no_motion(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both methods fail at every program; judges and linear programs are as ever."""
    from kilter.solvers import clarabel
    from kilter.solvers.block_cholesky import NotPositive

    def none(program, **_):
        nothing = np.empty(0)
        return dataclasses.replace(
            clarabel.solve_conic(program), outcome="failed", x=nothing, multipliers=nothing
        )

    def singular(*_, **__):
        raise NotPositive

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(clarabel, "solve_quadratic", none)
    monkeypatch.setattr("kilter.analysis.decision.motion.solve_projection", singular)


def written(name: str, assembly: kilter.Assembly) -> str:
    kilter.dump(assembly, f"{name}.json")
    return f"{name}.json"


def answered(capsys: pytest.CaptureFixture[str], code: int, *words: str) -> str:
    capsys.readouterr()
    assert main([*words, "--quiet"]) == code
    out, error = capsys.readouterr()
    assert "fault" not in error
    return out


@pytest.mark.slow
def test_check_says_what_a_proof_has_moving_and_leaves_the_rest_open(capsys):
    file = written("short", scene("wedge-on-wedge"))
    answer = json.loads(answered(capsys, 1, "check", file, "--json"))
    assert answer["verdict"] == "unstable"
    assert answer["instability"] is None
    assert NO_MOTION in answer["warnings"]
    assert {part["acceleration"] for part in answer["parts"]} == {None}
    moving = [part for part in answer["parts"] if part["moves"]]
    assert moving
    assert all(part["motion"].endswith(GAINS) for part in moving)
    assert not any(part["moves"] for part in answer["parts"] if part["grounded"])
    out = answered(capsys, 1, "check", file)
    assert GAINS in out
    assert NO_ACCELERATION in out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("command", "assembly", "code"),
    [
        ("margin", lambda: stacks.block_on_slope(20.0), 1),
        ("region", lambda: scene("wedge-on-wedge"), 0),
        ("orient", lambda: scene("wedge-on-wedge"), 1),
        ("orient", lambda: stacks.block_on_slope(50.0, friction=0.5), 0),
        ("plan", lambda: scene("keystone"), 0),
        ("hold", lambda: stacks.block_on_slope(20.0), 0),
    ],
    ids=["margin", "region", "orient-none", "orient-friction", "plan", "hold"],
)
def test_no_command_ends_as_a_fault(capsys, command, assembly, code):
    file = written("given", assembly())
    assert answered(capsys, code, command, file)
    answer = json.loads(answered(capsys, code, command, file, "--json"))
    if command == "orient" and code == 1:
        assert answer["nearest"]["kappa"] is None
        assert answer["instability"] is None
        assert any(SAID in text for text in answer["warnings"])


def test_a_knife_edge_names_the_parts_that_its_proof_has_moving():
    words = [text for text in kilter.region(scene("keystone")).warnings if "knife edge" in text]
    assert words
    assert all("moves these parts: '" in text for text in words)


@pytest.mark.slow
def test_a_report_shows_no_motion_and_says_why(capsys):
    file = written("slope", stacks.block_on_slope(20.0))
    answered(capsys, 0, "report", file, "-o", "page.html")
    assert SAID in Path("page.html").read_text(encoding="utf-8")
