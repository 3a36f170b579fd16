"""Slow commands on files of others, and on scenes that are made here: CPU seconds and memory.

    python benchmarks/slow_rows.py                    all rows
    python benchmarks/slow_rows.py crossvault dome    the rows whose names contain a word
    python benchmarks/slow_rows.py --list             the names of the rows

Each row is a command in a process of its own, with a time limit. `cpu` counts the user time of the
command, `read` the user time of a process that only reads the file (for STEP files), and `beside`
their difference, which must not exceed the limit of the row. Rows of files that do not exist are
left out, with a note. Compare two revisions by alternating runs, and report ratios. The exit code
is 1 if a row exceeds its limit.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
DATA = ROOT.parent / "shared" / "data"
sys.path.append(str(ROOT / "tests" / "scenes"))

ASIDE = 10.0
"""Largest CPU time of a row beside reading [s]."""
PATIENCE = 10.0
"""Ratio of the wall time after which a row is ended to its limit; the machine may be busy [-]."""
THREADS = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


@dataclass(frozen=True)
class Row:
    """A command with its options, on a file or on an assembly that a function makes."""

    name: str
    file: Path | Callable[[], Any]
    words: tuple[str, ...]
    limit: float = ASIDE
    environment: dict[str, str] = field(default_factory=dict)


def _staggered_dome() -> Any:
    from staggered_dome import staggered_dome

    return staggered_dome()


def _staggered_rings() -> Any:
    from staggered_dome import staggered_dome

    return staggered_dome(1, rings=5, per_ring=14)


def _leaning_wall(bricks: int) -> Any:
    """A leaning wall of about so many bricks, as in the comparison with other tools."""
    sys.path.append(str(ROOT / "benchmarks" / "peers"))
    from closed_forms import leaning_wall

    courses = round(bricks**0.5)
    return leaning_wall(courses, round(bricks / courses), 0.5)


def _long_arch(blocks: int) -> Any:
    from kilter.scenes.arches import arch

    return arch(blocks, ratio=0.3, friction=0.6)


def _open_rows() -> Iterator[Row]:
    """Rows whose verdict depends on many open pairs."""
    vault = DATA / "compas_assembly" / "crossvault.json"
    friction = ("--friction", "0.84")
    for command in ("check", "hold", "margin", "orient", "region", "plan"):
        yield Row(f"crossvault {command}", vault, (command, *friction))
    yield Row("crossvault report", vault, ("report", *friction, "-o", "vault.html"))
    yield Row("crossvault plan, interfaces", vault, ("plan", *friction, "--contacts", "file"))
    yield Row("crossvault check, no effort", vault, ("check", *friction, "--effort", "0"))
    yield Row("staggered dome check", _staggered_dome, ("check",), 20.0)
    for command in ("hold", "margin", "orient", "region", "plan"):
        yield Row(f"staggered rings {command}", _staggered_rings, (command,))


def _friction_rows() -> Iterator[Row]:
    """Limits, regions and plans with friction."""
    faults = DATA / "faults"
    for name, command in (
        ("least-friction-does-not-end", "margin"),
        ("margin-takes-minutes", "margin"),
        ("region-with-friction-fails", "region"),
        ("region-with-friction-fails", "orient"),
    ):
        yield Row(f"{name} {command}", faults / f"{name}.kilter.json", (command,))
    dome = DATA / "learn2assemble" / "dome"
    held = ("--ground", "72", "--units", "m", "--friction", "0.55")
    for command in ("check", "margin", "hold", "plan"):
        yield Row(f"voussoir dome {command}", dome, (command, *held))
    for bricks in (300, 1000):
        yield Row(f"leaning wall of {bricks}", partial(_leaning_wall, bricks), ("check",))
        yield Row(f"arch of {bricks}", partial(_long_arch, bricks), ("check",))


def _step_rows() -> Iterator[Row]:
    """The contacts and the verdict of each STEP file."""
    for file in sorted(p for p in DATA.rglob("*") if p.suffix.lower() in (".stp", ".step")):
        yield Row(f"{file.stem} contacts", file, ("contacts",))
    as1 = DATA / "cax-if" / "as1-oc-214.stp"
    yield Row("as1-oc-214 fasten", as1, ("check", "--floor", "--fasten", "*bolt*", "*nut*"))


ROBOTS = (
    "pybullet_data/laikago/laikago.urdf",
    "pybullet_data/franka_panda/panda.urdf",
    "pybullet_data/kuka_iiwa/model.urdf",
    "robosuite/models/assets/robots/ur5e/robot.xml",
    "robosuite/models/assets/robots/panda/robot.xml",
    "robosuite/models/assets/robots/iiwa/robot.xml",
    "robosuite/models/assets/robots/kinova3/robot.xml",
    "robosuite/models/assets/robots/tiago/robot.xml",
    "gymnasium_robotics/envs/assets/hand/reach.xml",
)
"""Robot meshes of the packages pybullet, robosuite and gymnasium-robotics, below a search path."""


def _robot_rows() -> Iterator[Row]:
    """Robots of published packages: install one, or put its unpacked wheel on PYTHONPATH."""
    for name in ROBOTS:
        places = [Path(folder) / name for folder in sys.path]
        file = next((place for place in places if place.exists()), places[0])
        yield Row(f"robot {Path(name).parent.name}", file, ("check",))


ROWS: tuple[Callable[[], Iterator[Row]], ...] = (
    _open_rows,
    _friction_rows,
    _step_rows,
    _robot_rows,
)
"""Functions that yield rows."""


def measured(
    words: list[str], limit: float, environment: dict[str, str], folder: Path
) -> tuple[float, int, str]:
    """User time [s], peak memory [MB] and exit code of a process, or "limit" if it was ended.

    The process works in a folder, where it may write files.
    """
    process = subprocess.Popen(
        [sys.executable, *words],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        cwd=folder,
        env={**os.environ, **THREADS, **environment},
    )
    end, killed = time.monotonic() + limit, False
    while True:
        pid, status, usage = os.wait4(process.pid, os.WNOHANG)
        if pid:
            process.returncode = os.waitstatus_to_exitcode(status)
            code = "limit" if killed else str(process.returncode)
            return usage.ru_utime, usage.ru_maxrss // 1024, code
        if time.monotonic() > end:
            process.kill()
            killed = True
        time.sleep(0.02)


def run(row: Row, folder: Path) -> tuple[str, bool]:
    """The line of a row, and whether it keeps its limit."""
    if isinstance(row.file, Path):
        file = row.file
    else:
        from kilter import dump

        file = folder / "assembly.kilter.json"
        dump(row.file(), file)
    patience = PATIENCE * row.limit
    command, *options = row.words
    words = ["-m", "kilter", command, str(file), *options]
    cpu, memory, code = measured(words, patience, row.environment, folder)
    read = 0.0
    if file.suffix.lower() in (".stp", ".step"):
        script = "import sys, kilter; kilter.load(sys.argv[1])"
        read, _, _ = measured(["-c", script, str(file)], patience, row.environment, folder)
    beside = cpu - read
    keeps = code != "limit" and beside <= row.limit
    numbers = f"{cpu:8.2f} {read:8.2f} {beside:8.2f} {row.limit:6.0f} {memory:7d} {code:>6}"
    return f"{row.name:36} {numbers} {'' if keeps else ' over'}", keeps


def main() -> int:
    """Run the rows, and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("words", nargs="*", help="words of the names of the rows")
    parser.add_argument("--list", action="store_true", help="print the names of the rows")
    given = parser.parse_args()
    rows = [row for rows_of in ROWS for row in rows_of()]
    rows = [row for row in rows if not given.words or any(w in row.name for w in given.words)]
    if given.list:
        print("\n".join(row.name for row in rows))
        return 0
    print(f"{'row':36} {'cpu':>8} {'read':>8} {'beside':>8} {'limit':>6} {'MB':>7} {'exit':>6}")
    all_keep = True
    for row in rows:
        if isinstance(row.file, Path) and not row.file.exists():
            print(f"{row.name:36} (no such file)")
            continue
        with tempfile.TemporaryDirectory() as folder:
            line, keeps = run(row, Path(folder))
        print(line, flush=True)
        all_keep &= keeps
    return 0 if all_keep else 1


if __name__ == "__main__":
    sys.exit(main())
