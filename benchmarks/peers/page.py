"""Writes the page of results (docs/contributing/benchmarks.md) and its plots from the rows."""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, pi
from pathlib import Path

import ask_compas_cra
import ask_mujoco
import ask_programs
import results
from closed_forms import CASES
from plot import Line, plotted
from tools import TOOLS, Row

__all__ = ["made", "write"]

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = DOCS / "contributing/benchmarks.md"
PLOT = "images/benchmarks-{}.svg"
TEMPLATE = Path(__file__).with_name("page.md")
RIGHT, WRONG, NONE = "right", "**wrong**", "no answer"
NEVER = {"time": "over the time", "memory": "over the memory"}
FASTER = 300
"""Number of bricks at which kilter and CRA are compared."""


def made(folder: Path = results.FOLDER) -> dict[str, str]:
    """Texts of the page and its plots, by path relative to docs."""
    files: dict[str, str] = {}
    sections, asked = [], set()
    for path in sorted(folder.glob("*.csv")):
        about, rows = results.read(path)
        asked |= {row.tool for row in rows}
        name = PLOT.format(path.stem)
        files[name] = plotted(lines(rows), "bricks", "seconds", f"Leaning walls: {path.stem}")
        sections.append(section(path.stem, about, rows, name))
    words = TEMPLATE.read_text(encoding="utf-8").format(
        tools="\n".join(f"| {t.name} | {t.words} |" for t in TOOLS.values() if t.name in asked),
        machines="\n\n".join(sections),
        sides=ask_programs.SIDES,
        short=1 - cos(pi / ask_programs.SIDES),
        long=1 / cos(pi / 8),
        pull=ask_compas_cra.PULL,
        step=ask_mujoco.STEP,
        time=ask_mujoco.SECONDS,
        moved=ask_mujoco.MOVED,
    )
    return {"contributing/benchmarks.md": words} | files


def write() -> None:
    """Write the page and its plots into the docs."""
    for name, text in made().items():
        (DOCS / name).write_text(text, encoding="utf-8")


def section(name: str, about: dict[str, str], rows: Sequence[Row], plot: str) -> str:
    """Section of the page with the results of a machine."""
    said = ", ".join(f"{key} {value}" for key, value in about.items())
    walls = [row for row in rows if row.family == "walls"]
    near = [row for row in rows if row.family != "walls"]
    return "\n\n".join(
        [
            f"## {name.replace('-', ' ').capitalize()}",
            f"Run with: {said}.",
            "### Leaning walls\n\nWalls of 200 x 100 x 60 mm bricks, friction 0.6, tilted out of"
            " their plane to half of the overturning angle: all stand."
            " Seconds, and MiB in brackets.",
            sizes(walls),
            f"![Seconds by bricks, both logarithmic](../{plot})",
            *compared(walls),
            "### Near the limit\n\nEach row is a case whose answer follows from a closed form.",
            counts(near),
            cases(near),
        ]
    )


def sizes(rows: Sequence[Row]) -> str:
    """Table of seconds and memory of each tool, with a row for each size."""
    tools = [name for name in TOOLS if any(row.tool == name for row in rows)]
    found = {(row.case, row.tool): row for row in rows}
    table = ["| bricks | " + " | ".join(tools) + " |", "|--:" * (len(tools) + 1) + "|"]
    for name in dict.fromkeys(row.case for row in rows):
        of = [found.get((name, tool)) for tool in tools]
        bricks = max(row.bricks for row in of if row)
        table.append(f"| {bricks:,} | " + " | ".join(figure(row) for row in of) + " |")
    return "\n".join(table)


def figure(row: Row | None) -> str:
    """Seconds and memory of a row, or the reason why they are missing."""
    if row is None:
        return ""
    if not row.answer or row.answer == row.truth:
        return f"{shown(row.seconds)} ({row.peak:.0f})"
    if row.answer in ("holds", "falls"):
        return f"**wrong** {shown(row.seconds)} ({row.peak:.0f})"
    return f"{NEVER.get(row.answer, row.answer)} {shown(row.seconds)}"


def shown(seconds: float) -> str:
    """Seconds with two digits."""
    if seconds >= 100:
        return f"{seconds:,.0f}"
    return f"{seconds:.2g}" if seconds >= 0.001 else f"{seconds:.4f}"


def compared(rows: Sequence[Row]) -> list[str]:
    """Sentences with the ratio of the times of CRA and kilter at the largest common wall."""
    said = []
    found = {(row.case, row.tool): row for row in rows}
    for tool in ("compas_cra CRA", "compas_cra CRA, tuned"):
        both = [
            (found[row.case, "kilter, equilibrium"], row)
            for row in rows
            if row.tool == tool and (row.case, "kilter, equilibrium") in found and row.seconds > 0
        ]
        if not both:
            continue
        mine, other = both[-1]
        ratio = other.seconds / max(mine.seconds, 1e-9)
        at_least = "more than " if other.answer in NEVER else ""
        said.append(
            f"At {mine.bricks} bricks, kilter decides equilibrium"
            f" {at_least}{ratio:,.0f} times faster than {tool}."
        )
    return [" ".join(said)] if said else []


def lines(rows: Sequence[Row]) -> list[Line]:
    """Lines of the plot: seconds over bricks for each tool, for the walls that it finished."""
    made = []
    for name in TOOLS:
        points = [
            (float(row.bricks), row.seconds)
            for row in rows
            if row.family == "walls" and row.tool == name and row.bricks and row.seconds > 0
        ]
        if points:
            made.append(Line(name, points))
    return made


def answering(rows: Sequence[Row]) -> list[str]:
    """Names of the tools that give answers."""
    return [name for name in TOOLS if any(row.tool == name and row.answer for row in rows)]


def judged(row: Row | None) -> str:
    """Word for the answer of a row: right, wrong or no answer."""
    if row is None:
        return ""
    if row.answer not in ("holds", "falls"):
        return NONE
    return RIGHT if row.answer == row.truth else WRONG


def counts(rows: Sequence[Row]) -> str:
    """Table of the numbers of right answers of each tool, by family."""
    tools = answering(rows)
    families = list(dict.fromkeys(row.family for row in rows))
    table = [
        "| tool | " + " | ".join(families) + " | wrong in all | no answer |",
        "|---|" + "--:|" * (len(families) + 2),
    ]
    for tool in tools:
        own = [row for row in rows if row.tool == tool]
        right = [
            f"{sum(judged(row) == RIGHT for row in own if row.family == family)}"
            f" of {sum(row.family == family for row in own)}"
            for family in families
        ]
        wrong, none = (sum(judged(row) == word for row in own) for word in (WRONG, NONE))
        table.append(f"| {tool} | " + " | ".join(right) + f" | {wrong} | {none} |")
    return "\n".join(table)


def cases(rows: Sequence[Row]) -> str:
    """Table of the answers of each tool for each case."""
    tools = answering(rows)
    found = {(row.case, row.tool): row for row in rows}
    table = [
        "| case | limit | truth | " + " | ".join(tools) + " |",
        "|---|---|---|" + "---|" * len(tools),
    ]
    for name in dict.fromkeys(row.case for row in rows):
        case = CASES[name]
        words = [judged(found.get((name, tool))) for tool in tools]
        truth = "holds" if case.holds else "falls"
        table.append(f"| {name} | {case.limit} | {truth} | " + " | ".join(words) + " |")
    return "\n".join(table)
