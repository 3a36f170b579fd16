"""Runs the commands and the Python blocks of a page, in the order of the page, in a fresh folder.

- A block of Python is run; later blocks of the page may use its names.
- In blocks of the languages in `SHELLS`, each line that begins with ``kilter`` or ``$ kilter`` is
  run. The lines below a line with ``$`` are the answer, and are compared; ``...`` leaves lines out.
- A block with a title, such as ``json title="straps.json"``, is written to this file.

``python tests/docs/page_runner.py`` runs every page and prints the numbers.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from kilter.cli import main

ROOT = Path(__file__).resolve().parents[2]
SHELLS = {"sh", "text", "console", "bash"}
SERVES = {"view", "mcp"}
"""Commands that do not end by themselves; `tests/show` and `tests/agents` run them."""
OTHERS = ("compas", "compas_assembly", "compas_dem")
"""Libraries that a page may be about and the tests do without."""
LEFT_OUT = "..."
FENCE = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```$', flags=re.S | re.M)


def pages() -> list[Path]:
    """README and the pages of the documentation; those for authors last."""
    found = sorted(
        (ROOT / "docs").rglob("*.md"), key=lambda path: ("contributing" in path.parts, path)
    )
    return [ROOT / "README.md", *found]


@dataclass
class Counts:
    """Commands, blocks and answers of a page."""

    commands: int = 0
    blocks: int = 0
    answers: int = 0
    missing: list[str] = field(default_factory=list)
    """Libraries that are not installed, so that a block was not run."""


def command_of(line: str) -> list[str]:
    """Words of a line that is a command; remarks after three spaces or ``#`` are left out."""
    text = re.split(r" {3,}|\s+# ", line.removeprefix("$ "))[0]
    words = shlex.split(text) if text.startswith("kilter ") else []
    return words[1:]


def is_shown(answer: list[str], shown: list[str]) -> bool:
    """Whether the shown lines are in an answer: from its beginning, and in order after ``...``."""
    at, free = 0, False
    for line in shown:
        if line.strip() == LEFT_OUT:
            free = True
            continue
        places = [k for k in range(at, len(answer)) if answer[k].rstrip() == line.rstrip()]
        if not places or (places[0] != at and not free):
            return False
        at, free = places[0] + 1, False
    return True


def run_page(page: Path) -> Counts:
    """Run a page in the present folder; an `AssertionError` has the first line that is wrong."""
    counts, names = Counts(), {"__name__": "page"}
    for language, title, block in FENCE.findall(page.read_text(encoding="utf-8")):
        if title:
            Path(title).write_text(block, encoding="utf-8")
        if language == "python":
            counts.blocks += 1
            try:
                exec(compile(block, str(page), "exec"), names)
            except ModuleNotFoundError as missing:
                if str(missing.name).partition(".")[0] not in OTHERS:
                    raise
                counts.missing.append(str(missing.name))
        elif language in SHELLS and not title:
            _run_shell(block.splitlines(), page, counts)
    return counts


def _run_shell(lines: list[str], page: Path, counts: Counts) -> None:
    """Run the commands of a block, and compare the answers that it shows."""
    starts = [k for k, line in enumerate(lines) if command_of(line)]
    for start, end in zip(starts, [*starts[1:], len(lines)], strict=False):
        words = command_of(lines[start])
        if words[0] in SERVES:
            continue
        counts.commands += 1
        out, error = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
            code = main(words)
        place = f"{page.name}: {lines[start]}"
        # every answer is one; wrong usage and faults are not
        assert code in (0, 1, 3, 4), f"{place}: {code} {error.getvalue()}"
        shown = [line for line in lines[start + 1 : end] if line.strip()]
        if lines[start].startswith("$ ") and shown:
            counts.answers += 1
            answer = [line for line in (out.getvalue() or error.getvalue()).splitlines() if line]
            assert is_shown(answer, shown), f"{place}\n" + "\n".join(answer)


def _all() -> int:
    """Run every page, each in a fresh folder; print its numbers, and return the exit code."""
    total, bad = Counts(), 0
    here = Path.cwd()
    chosen = [Path(name).resolve() for name in sys.argv[1:]] or pages()[1:]
    for page in chosen:
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                with contextlib.redirect_stdout(io.StringIO()):
                    counts = run_page(page)
            except BaseException as error:
                bad += 1
                sys.stdout.write(f"FAILED {type(error).__name__} {error}\n")
                counts = Counts()
            os.chdir(here)
        for name in ("commands", "blocks", "answers"):
            setattr(total, name, getattr(total, name) + getattr(counts, name))
        numbers = f"{counts.commands:4}{counts.blocks:4}{counts.answers:4}"
        sys.stdout.write(f"{numbers}  {page.relative_to(ROOT)} {' '.join(counts.missing)}\n")
        sys.stdout.flush()
    sys.stdout.write(
        f"{len(chosen)} pages, {total.commands} commands, {total.blocks} blocks of Python, "
        f"{total.answers} shown answers, {bad} failed\n"
    )
    return bad


if __name__ == "__main__":
    sys.exit(min(_all(), 1))
