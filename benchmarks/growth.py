"""CPU seconds, memory and growth of each command with the number of parts, for five families.

    python benchmarks/growth.py                                  all cells; this takes hours
    python benchmarks/growth.py --family wall boxes --command check margin --sizes 30 100 300
    python benchmarks/growth.py --limit 20                       end a cell after 20 CPU seconds
    python benchmarks/growth.py --output growth.csv              also keep the cells in a file

The families are: a running-bond wall, boxes that stand apart on a table (friction 0.5), a pile of
boxes, bolted frames in STEP (`cad_frames.py`), and piles of objects on a table in MJCF (friction
1). `--friction` replaces the coefficient of the first three.

Each cell runs one command line in its own process. The seconds start after imports, which a run
with three parts and a first reading make, and exclude the reading of the file, which the row
`reading` has. For STEP
files the other rows contain the contacts. `peak` is the largest memory of the process. A cell over
its limit is printed as `>` with the limit. The exponent is the slope of the logarithms of seconds
and parts, by least squares over the cells of at least 0.1 s.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import functools
import gc
import importlib
import io
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

SIZES = (30, 100, 300, 1000, 3000)
LIMIT = 60.0
"""CPU seconds after which a cell is ended."""
SHORTEST = 0.1
"""Cells below this have no place in the fit of an exponent: fixed costs dominate them [s]."""
OVER, WRONG = "over the limit", "error"
WORDS: dict[str, tuple[str, ...]] = {
    "reading": (),
    "check": ("--json",),
    "contacts": ("--json",),
    "report": ("-o", "{out}.html"),
    "scene": ("--json",),
    "transport": ("--json",),
    "settle": ("--json",),
    "margin": ("--json",),
    "plan": ("--json",),
    "orient": ("--json",),
    "region": ("--json",),
    "place": ("--json", "--box", "{box}", "--mass", "1"),
}
"""Arguments of each command; `reading` only loads the file."""
BOXES = {"wall": "0.2x0.1x0.06", "boxes": "0.5x0.5x0.5", "pile": "1x1x1"}
BOXES |= {"frames": "60x40x20", "scene": "0.04x0.04x0.04"}
"""The box that `place` puts down in each family, in the units of its file."""


# families ---------------------------------------------------------------------------------


def write_wall(parts: int, friction: float | None, path: Path) -> Path:
    """Write a running-bond wall, without friction by default."""
    from kilter.scenes.walls import wall_of

    return write_model(wall_of(parts).with_friction(friction or 0.0), path)


def write_boxes(parts: int, friction: float | None, path: Path) -> Path:
    """Write boxes of random sizes that stand apart on a table; friction 0.5 by default."""
    from kilter.assembly import Assembly, Part
    from kilter.rigid import Pose
    from kilter.shape.primitives import Box

    random, side = np.random.default_rng(0), int(np.ceil(parts**0.5))
    sizes = random.uniform(0.3, 1.0, (parts, 3))
    free = [
        Part(f"box-{k}", Box(size), Pose([2.0 * (k % side), 2.0 * (k // side), size[2] / 2]))
        for k, size in enumerate(sizes)
    ]
    table = Part("table", Box([2.0 * side, 2.0 * side, 1]), Pose([side - 1, side - 1, -0.5]), True)
    return write_model(
        Assembly([table, *free], friction=0.5 if friction is None else friction), path
    )


def write_pile(parts: int, friction: float | None, path: Path) -> Path:
    """Write a pile of boxes, about three layers high, without friction by default."""
    from kilter.scenes.random_bricks import box_pile

    cells = max(6, round(1.1 * parts**0.5))
    return write_model(box_pile(parts, cells=cells, friction=friction or 0.0), path)


def write_frames(parts: int, friction: float | None, path: Path) -> Path:
    """Write bolted frames as STEP; three parts are boxes."""
    if parts < 10:
        return write_boxes(parts, friction, path)
    cad_frames = importlib.import_module("cad_frames")

    return cad_frames.write_frames(parts, 0, path.with_suffix(".step"))


def write_scene(parts: int, friction: float | None, path: Path) -> Path:
    """Write stacks of one to four boxes on a table as MJCF."""
    random, bodies = np.random.default_rng(0), ""
    side, stack = int(np.ceil((parts / 2) ** 0.5)), 0
    k = 0
    while k < parts:
        x, y, top = 0.2 * (stack % side), 0.2 * (stack // side), 0.0
        for size in random.uniform(0.02, 0.04, (min(int(random.integers(1, 5)), parts - k), 3)):
            bodies += f'<body name="object-{k}" pos="{x} {y} {top + size[2]}"><freejoint/>'
            bodies += f'<geom type="box" size="{size[0]} {size[1]} {size[2]}"/></body>\n'
            top, k = top + 2 * float(size[2]), k + 1
        stack += 1
    wide = 0.2 * side
    table = f'<geom name="table" type="box" size="{wide} {wide} 0.02" pos="0 0 -0.02"/>'
    path = path.with_suffix(".xml")
    path.write_text(f"<mujoco><worldbody>{table}{bodies}</worldbody></mujoco>", encoding="utf-8")
    return path


def write_model(assembly: Any, path: Path) -> Path:
    """Write an assembly as a kilter file."""
    import kilter

    path = path.with_suffix(".kilter.json")
    kilter.dump(assembly, path)
    return path


FAMILIES: dict[str, Callable[[int, float | None, Path], Path]] = {
    "wall": write_wall,
    "boxes": write_boxes,
    "pile": write_pile,
    "frames": write_frames,
    "scene": write_scene,
}


# a cell -----------------------------------------------------------------------------------


def words_of(command: str, family: str, path: Path) -> list[str]:
    """The command line of a cell."""
    own = [one.format(out=path, box=BOXES[family]) for one in WORDS[command]]
    held = ["--ground", "base"] if path.suffix == ".step" else []
    if held and command == "plan":  # as drawn, the nuts fall
        held += ["--assume", "fits"]
    return [command, str(path), "--quiet", *held, *own]


def run(words: list[str]) -> int:
    """Run a command line without its output; return its exit code."""
    from kilter.cli import main as run_kilter

    silent = io.StringIO()
    with contextlib.redirect_stdout(silent), contextlib.redirect_stderr(silent):
        code = run_kilter(words)
    if code == 2:
        raise SystemExit(silent.getvalue()[-2000:])
    return int(code or 0)


def measured(command: str, family: str, small: Path, path: Path, limit: float) -> dict[str, Any]:
    """CPU seconds of a cell after imports and without reading, its peak and its exit code."""
    import kilter

    held = {"ground": "base"} if path.suffix == ".step" else {}
    if path.suffix == ".step":
        importlib.import_module("OCP.STEPCAFControl")
    kilter.load(small)
    if command != "reading":
        run(words_of(command, family, small))
    kilter.load(path, **held)  # imports the readers of large files
    started = time.process_time()
    kilter.load(path, **held)
    read = time.process_time()
    if command == "reading":
        code, seconds = 0, read - started
    else:
        forget_shapes()  # a command reads its file once, and compares with no earlier reading
        end = int(read + (read - started) + limit) + 1
        resource.setrlimit(resource.RLIMIT_CPU, (end, end + 5))
        code = run(words_of(command, family, path))
        seconds = max(0.0, time.process_time() - read - (read - started))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return {"seconds": seconds, "peak": peak, "code": code}


def forget_shapes() -> None:
    """Clear what earlier readings keep of their shapes."""
    for kept in gc.get_objects():
        cached = isinstance(kept, functools._lru_cache_wrapper)
        if cached and kept.__module__.startswith("kilter.assembly"):
            kept.cache_clear()


def cell(command: str, family: str, small: Path, path: Path, limit: float) -> dict[str, Any]:
    """A cell in its own process: its figures, or why it has none."""
    words = [sys.executable, __file__, "--cell", command, family, str(small), str(path), str(limit)]
    threads = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(words, capture_output=True, text=True, env=threads, check=False)
    if done.returncode < 0:
        return {"seconds": limit, "peak": None, "code": OVER}
    if done.returncode:
        return {"seconds": None, "peak": None, "code": WRONG, "why": done.stderr.strip()[-300:]}
    return json.loads(done.stdout.strip().splitlines()[-1])


# tables -----------------------------------------------------------------------------------


def exponent(cells: Iterable[tuple[int, dict[str, Any]]]) -> float | None:
    """Slope of log seconds over log parts; none with fewer than two cells that count."""
    good = [
        (np.log(parts), np.log(row["seconds"]))
        for parts, row in cells
        if row["code"] not in (OVER, WRONG) and row["seconds"] >= SHORTEST
    ]
    return float(np.polyfit(*np.transpose(good), 1)[0]) if len(good) > 1 else None


def figure(row: dict[str, Any]) -> str:
    """The text of a cell: seconds, and in brackets its peak [GiB]."""
    if row["code"] == WRONG:
        return WRONG
    if row["code"] == OVER:
        return f"> {row['seconds']:.0f}"
    seconds = row["seconds"]
    return (
        f"{seconds:.2f} ({row['peak']:.2f})"
        if seconds < 10
        else f"{seconds:.0f} ({row['peak']:.2f})"
    )


def line(name: str, sizes: Sequence[int], row: dict[int, dict[str, Any]]) -> str:
    """A row of the table of a family."""
    slope = exponent(row.items())
    texts = [figure(row[size]) if size in row else "-" for size in sizes]
    return (
        f"{name:10}"
        + "".join(f"{text:>14}" for text in texts)
        + (f"{slope:>7.2f}" if slope is not None else f"{'-':>7}")
    )


def main() -> None:
    """Print the table of each family, row by row."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--family", nargs="+", choices=list(FAMILIES), default=list(FAMILIES))
    parser.add_argument("--command", nargs="+", choices=list(WORDS), default=list(WORDS))
    parser.add_argument("--sizes", nargs="+", type=int, default=list(SIZES))
    parser.add_argument("--limit", type=float, default=LIMIT, help="CPU seconds of a cell")
    parser.add_argument("--friction", type=float, help="of wall, boxes and pile [-]")
    parser.add_argument("--output", type=Path, help="add the cells to this CSV file")
    parser.add_argument("--cell", nargs=5, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.cell:
        command, family, small, path, limit = chosen.cell
        print(json.dumps(measured(command, family, Path(small), Path(path), float(limit))))
        return
    with tempfile.TemporaryDirectory() as folder:
        for family in chosen.family:
            table(family, chosen, Path(folder))


def table(family: str, chosen: argparse.Namespace, folder: Path) -> None:
    """Print the table of a family."""
    print(f"{family:10}" + "".join(f"{size:>14}" for size in chosen.sizes) + f"{'growth':>7}")
    write = FAMILIES[family]
    small = write(3, chosen.friction, folder / f"{family}-3")
    paths = {n: write(n, chosen.friction, folder / f"{family}-{n}") for n in chosen.sizes}
    for command in chosen.command:
        rows: dict[int, dict[str, Any]] = {}
        for size, path in paths.items():
            rows[size] = cell(command, family, small, path, chosen.limit)
            if chosen.output:
                keep(chosen.output, family, command, size, rows[size])
            if rows[size]["code"] == OVER:  # larger ones take longer
                rows |= {n: rows[size] for n in chosen.sizes if n > size}
                break
        print(line(command, chosen.sizes, rows), flush=True)
        for size, row in rows.items():
            if "why" in row:
                print(f"{'':10}{size}: {row['why']}", flush=True)


def keep(path: Path, family: str, command: str, size: int, row: dict[str, Any]) -> None:
    """Add a cell to a CSV file; the last row of a cell counts."""
    new = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        if new:
            writer.writerow(["family", "command", "parts", "seconds", "peak", "code"])
        numbers = [
            row[key] if row[key] is None else round(row[key], 4) for key in ("seconds", "peak")
        ]
        writer.writerow([family, command, size, *numbers, row["code"]])


if __name__ == "__main__":
    main()
