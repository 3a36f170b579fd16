"""Comparison of kilter with other programs: correctness, time and memory.

    pip install -e ".[peers]"
    python benchmarks/peers                            everything, into results/here.csv
    python benchmarks/peers --only walls -t kilter     selected cases or families, selected tools
    python benchmarks/peers --page                     the page, from the results

All answers have the same limit of CPU time; the median of three runs counts. Each wall runs in a
separate process on a single thread with a memory limit; the tools alternate wall by wall. The
small cases near limits share a process per tool. A case that ends the process gets its row, and
the remaining cases continue in a new process. Missing tools are left out with a message. Rows in
the file are kept and only missing rows are measured; `--again` measures all rows.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import page
import results
from closed_forms import CASES, Case
from tools import RUNS, TOOLS, Row, Tool, answered, spent, truth

LIMITS = {"seconds": 100.0, "gib": 8.0}
"""Limits of an answer [CPU s] and of the memory of a process [GiB]."""
QUIET = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
WAIT = 30.0
"""Wall-clock time allowed per CPU second, for a busy machine [-]."""
READY = 20.0
"""Time allowed for imports and preparation of a tool [CPU s]."""


def measured(cases: list[Case], tool: Tool, seconds: float, gib: float) -> list[Row]:
    """Rows of a process with limits; if it ends early, the last row contains the reason."""
    names = [case.name for case in cases]
    words = [sys.executable, str(Path(__file__).parent), "--seconds", str(seconds)]
    words += ["--row", tool.name, *names]
    patience = WAIT * (READY + RUNS * seconds * len(cases))

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (int(gib * 2**30),) * 2)

    before = spent()
    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as err:
        process = subprocess.Popen(
            words, stdout=out, stderr=err, preexec_fn=limit, env=os.environ | QUIET
        )
        try:
            code = process.wait(patience)
        except subprocess.TimeoutExpired:
            process.kill()
            code = process.wait()
        out.seek(0)
        err.seek(0)
        rows = [Row(**json.loads(line)) for line in out if line.startswith("{")]
        said = err.read().strip()
    if len(rows) == len(cases):
        return rows
    case, last = cases[len(rows)], (said.splitlines() or ["nothing said"])[-1]
    word, used = "crashed", spent() - before
    if "MemoryError" in said or "bad_alloc" in said:
        word = "memory"
    elif -code in (signal.SIGPROF, signal.SIGKILL):  # over the CPU limit, or killed after WAIT
        word, last = "time", ""
        used = seconds if -code == signal.SIGPROF else used
    blank = Row(case.family, case.name, tool.name, 0, 0, truth(case), word, used, 1, 0.0, last[:80])
    return [*rows, blank]


def too_large(case: Case, tool: Tool, rows: dict[tuple[str, str], Row]) -> bool:
    """Whether the tool exceeded its limits on a smaller wall."""
    walls = [other.name for other in CASES.values() if other.family == "walls"]
    if case.family != "walls":
        return False
    smaller = walls[: walls.index(case.name)]
    met = (rows.get((name, tool.name)) for name in smaller)
    return any(row is not None and row.answer in ("time", "memory") for row in met)


def main() -> None:
    """Run the requested measurements and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-o", type=Path, default=results.FOLDER / "here.csv")
    parser.add_argument("--only", nargs="*", default=[], help="families or cases")
    parser.add_argument("-t", "--tools", nargs="*", choices=list(TOOLS), default=list(TOOLS))
    parser.add_argument("--seconds", type=float, default=LIMITS["seconds"])
    parser.add_argument("--gib", type=float, default=LIMITS["gib"])
    parser.add_argument("--again", action="store_true", help="measure existing rows again")
    parser.add_argument("--page", action="store_true", help="write the page, run nothing")
    parser.add_argument("--row", nargs="+", metavar="TOOL CASE", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.row:
        tool, *names = chosen.row
        for name in names:
            row = answered(CASES[name], TOOLS[tool], chosen.seconds)
            print(json.dumps(row.to_dict()), flush=True)
        return
    if not chosen.page:
        run(chosen)
    page.write()


def run(chosen: argparse.Namespace) -> None:
    """Measure missing rows, and write the file after each process."""
    there = results.read(chosen.o)[1] if chosen.o.exists() else []
    rows = {(row.case, row.tool): row for row in there}
    tools = [TOOLS[name] for name in chosen.tools]
    for tool in tools:
        if not tool.installed:
            print(f"{tool.name}: {tool.package} is not installed, left out")
    for group in groups(set(chosen.only)):
        for tool in tools:
            left = [
                case
                for case in group
                if chosen.again or (case.name, tool.name) not in rows
                if tool.installed and not too_large(case, tool, rows)
            ]
            while left:
                found = measured(left, tool, chosen.seconds, chosen.gib)
                left = left[len(found) :]
                rows |= {(row.case, row.tool): row for row in found}
                print(*(told(row) for row in found), sep="\n", flush=True)
                keep(chosen.o, rows, chosen.seconds)


def groups(only: set[str]) -> Iterator[list[Case]]:
    """Yield groups of cases that share a process: each wall alone, all others by family."""
    chosen = [case for case in CASES.values() if not only or {case.name, case.family} & only]
    for family in dict.fromkeys(case.family for case in chosen):
        members = [case for case in chosen if case.family == family]
        yield from ([case] for case in members) if family == "walls" else [members]


def keep(path: Path, rows: dict[tuple[str, str], Row], seconds: float) -> None:
    """Write all rows to the file in the order of cases and tools, with the time limit."""
    order = {key: k for k, key in enumerate((case, tool) for case in CASES for tool in TOOLS)}
    known = [row for key, row in rows.items() if key in order]
    about = results.about() | {"limit": f"{seconds:g} s an answer"}
    results.write(path, about, sorted(known, key=lambda r: order[r.case, r.tool]))


def told(row: Row) -> str:
    """A row as a line of text."""
    return (
        f"{row.case:28s} {row.tool:22s} {row.truth:6s} {row.answer:8s}"
        f" {row.seconds:10.4f} s {row.peak:8.1f} MiB  {row.note}"
    )


if __name__ == "__main__":
    main()
