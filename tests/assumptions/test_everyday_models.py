"""First answers to twelve everyday things, drawn right and with a mistake (`everyday_models`).

The test compares with `Expected` what a reader of the answer acts on: no rung holds that must not
hold, the lowest rung that holds, the parts that fall, and where loose bodies lie.
"""

import re
from pathlib import Path

import pytest

pytest.importorskip("OCP", reason="needs the extra kilter[step]")

from everyday_models import THINGS, Expected, Thing
from step_maker import write_step

import kilter
from kilter.cli import main

RUNGS = ("drawn", "play", "fits", "joined")
LONG_SEARCH = pytest.mark.xfail(
    reason="the search for the pose of a loose shaft exceeds the work of a row", strict=True
)
CASES = [
    pytest.param(
        thing,
        flawed,
        id=f"{thing.name}{' with a mistake' if flawed else ''}",
        marks=[LONG_SEARCH] if flawed and thing.name == "gearbox" else [],
    )
    for thing in THINGS
    for flawed in (False, True)
]


def written(thing: Thing, flawed: bool, folder: Path) -> Path:
    """The STEP file of a thing."""
    nodes = [(name, solid, None) for name, solid in thing.draw(flawed).items()]
    return write_step(folder / "thing.step", nodes)


def faults_of_rows(verdict: kilter.Verdict, known: Expected) -> list[str]:
    """Differences between the rows of an answer and the known falls."""
    faults = []
    rows = {row.assume: row for row in verdict.ladder if row.friction is None}
    first = RUNGS.index(known.holds) if known.holds else len(RUNGS)
    for place, rung in enumerate(RUNGS):
        row = rows[rung]
        if (row.level is not None) != (place >= first):
            faults.append(f"{rung}: {row.verdict} {row.level}, {row.falls} fall: {row.names}")
    highest = rows["joined"]
    if known.holds is None:
        most = len(known.falls | known.may_fall)
        if not len(known.falls) <= highest.falls <= most:
            faults.append(f"joined: {highest.falls} parts fall instead of {len(known.falls)}")
        if not set(highest.names) <= known.falls | known.may_fall:
            faults.append(f"joined: {highest.names} fall")
    if set(verdict.moving) != known.drawn:
        faults.append(f"drawn: {sorted(set(verdict.moving) ^ known.drawn)}")
    return faults


def faults_of_bodies(verdict: kilter.Verdict, known: Expected) -> list[str]:
    """Differences between the loose bodies of an answer and the known places below them."""
    faults = []
    loose = {body.name: body for body in verdict.bodies if not body.on_floor}
    if set(loose) != set(known.below):
        faults.append(f"loose bodies {sorted(set(loose) ^ set(known.below))}")
    for name in loose.keys() & known.below.keys():
        below, way = known.below[name]
        body = loose[name]
        right = way is None or body.fall == pytest.approx(way, abs=1e-4)
        if body.below not in below or not right:
            faults.append(f"{name} falls {body.fall} onto {body.below}, known: {way} {set(below)}")
    return faults


@pytest.mark.slow
@pytest.mark.parametrize(("thing", "flawed"), CASES)
def test_the_first_answer_names_the_rung_that_holds_and_what_falls(thing, flawed, tmp_path):
    known = thing.wrong if flawed else thing.right
    verdict = kilter.check(written(thing, flawed, tmp_path))
    assert (verdict.assume, tuple(verdict.assumed), verdict.stable) == ("drawn", ("floor",), False)
    assert faults_of_rows(verdict, known) + faults_of_bodies(verdict, known) == []


@pytest.mark.slow
@pytest.mark.parametrize(("thing", "flawed"), CASES)
def test_the_next_command_of_the_answer_asks_for_the_rung_that_holds(
    thing, flawed, tmp_path, capsys
):
    known = thing.wrong if flawed else thing.right
    path = written(thing, flawed, tmp_path)
    assert main(["check", str(path), "--quiet"]) in (1, 4)
    out = capsys.readouterr().out
    assert len(out.splitlines()) <= 30
    steps = re.findall(r"^next: kilter (.*)$", out, flags=re.M)
    if known.holds is None:
        assert not any("--assume" in step for step in steps)
        assert all(name in out for name in known.falls if len(known.falls) <= 5)
        return
    (step,) = steps
    assert step.split() == ["check", str(path), "--assume", known.holds]
    assert main([*step.split(), "--quiet"]) in (0, 3)
    sentence = capsys.readouterr().out.splitlines()[0]
    if known.holds == "joined":
        assert "if its touching parts are joined" in sentence
