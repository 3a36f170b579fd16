"""Every program of a run, solved by each solver separately: none may prove the other side.

    pytest --each-solver sides.csv tests/analysis tests/margin

records each program that a test has judged, asks each solver alone when the test is over, and fails
the test where one has a proof of the other side. The file gets a row a test: how many programs
there were, and of each solver how many it proved as `judge` does, how many it left open, which
`judge` asked another for or left open itself, and of how many both sides have a proof: within the
tolerance of a certificate about a limit there are forces that balance to it, and a motion too.
Forces that balance to rounding leave no room for that.
"""

from __future__ import annotations

import csv
import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from kilter.analysis.decision import judge as judging
from kilter.analysis.decision.judge import SOLVERS, Judgement, Solver, judge
from kilter.mechanics.program import ROW_FIELDS, Program

__all__ = ["each_solver", "recorded", "sides"]

LARGEST = 3000
"""Rows of a program above which it is not asked again: pyramids take minutes."""
COLUMNS = (
    "test",
    "programs",
    "larger",
    *(f"{who} {how}" for who in SOLVERS for how in ("proved", "open", "both")),
)
ROUNDING = 1e-12
"""Residual of forces [-], below which they balance but for rounding."""


def both_hold(one: Judgement, other: Judgement) -> bool:
    """Whether two judgements differ, and their forces balance to the tolerance, not to rounding."""
    holds, falls = (one, other) if one.stable else (other, one)
    if falls.stable is not False or not holds.stable:
        return False
    forces, motion = holds.forces, falls.motion
    if forces is None or motion is None or not (forces.holds and motion.holds):
        return False
    return forces.residual > ROUNDING


def sides(program: Program) -> dict[Solver, bool | None]:
    """Side that each solver proves by itself: stable, unstable, or none."""
    return {solver: judge(program, solver=solver).stable for solver in SOLVERS}


@contextmanager
def recorded() -> Iterator[dict[bytes, Program]]:
    """The programs that are judged meanwhile, each once; those of pyramids belong to others."""
    found: dict[bytes, Program] = {}
    rays: list[Program] = []
    candidates, pyramid = judging._candidates, judging.pyramid

    def kept(program: Program, *more: Any) -> Any:
        if not any(program is one for one in rays):
            found.setdefault(_key(program), program)
        return candidates(program, *more)

    def noted(*given: Any, **more: Any) -> Program:
        rays.append(pyramid(*given, **more))
        return rays[-1]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(judging, "_candidates", kept)
        patch.setattr(judging, "pyramid", noted)
        yield found


def _key(program: Program) -> bytes:
    """The same for programs that are the same question."""
    text = hashlib.sha256()
    for name in (
        *ROW_FIELDS,
        "free",
        "center",
        "mass",
        "radius",
        "gravity",
        "applied",
        "tolerance",
    ):
        text.update(getattr(program, name).tobytes())
    return text.digest()


@contextmanager
def each_solver(test: str, file: Path) -> Iterator[None]:
    """Asks each solver about the programs of a test, after it, and adds a row to a file."""
    with recorded() as programs:
        yield
    small = [one for one in programs.values() if len(one.part_a) <= LARGEST and one.free.any()]
    row: dict[str, Any] = dict.fromkeys(COLUMNS, 0)
    row |= {"test": test, "programs": len(small), "larger": len(programs) - len(small)}
    wrong = []
    for program in small:
        answers = {solver: judge(program, solver=solver) for solver in SOLVERS}
        # what `judge` leaves open one of them may prove, but no two of them both sides
        told = [judge(program), *answers.values()]
        known = next((one for one in told if one.stable is not None), told[0])
        for solver, found in answers.items():
            both = both_hold(known, found)
            row[f"{solver} {'both' if both else 'open' if found.stable is None else 'proved'}"] += 1
            if found.stable is not None and found.stable is not known.stable and not both:
                wrong.append((solver, found.stable, known.stable, program))
    if small:
        new = not file.exists()
        with file.open("a", newline="", encoding="utf-8") as stream:
            writer = csv.DictWriter(stream, COLUMNS, lineterminator="\n")
            if new:
                writer.writeheader()
            writer.writerow(row)
    assert not wrong
