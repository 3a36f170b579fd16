"""Time of each stage of the first answer about arrays of bolted frames, written as STEP files.

    python benchmarks/cad_frames.py                 100, 300 and 1,000 solids
    python benchmarks/cad_frames.py --linked        all frames are connected by rails
    python benchmarks/cad_frames.py 1000 --profile  the functions that take most of the time

A frame has two columns with head plates, a beam on them, a deck on the beam, and four bolts, each
with two washers and a nut: 22 solids. Bolts have clearance in their holes, and nuts are drawn
without a thread. The frames are instances of one product in nested products; they are turned about
the vertical axis by random angles, some by quarter turns. All of them stand on one base plate.

Each row is a separate process. The columns are CPU seconds: `reading` by OCCT; `contacts`; `check`,
with its contacts; `answer`, the complete command with all that it tries, without the reading.
`growth` is the exponent of the answer's time between a row and the row above.
"""

from __future__ import annotations

import argparse
import contextlib
import cProfile
import io
import json
import math
import pstats
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "files"))

IN_FRAME = 22
"""Number of solids of a frame."""
IN_ROW = 8
"""Largest number of frames in a row."""
PITCH = 260.0
"""Distance of the middles of neighbouring frames [mm]."""
DECK = 5.0
"""Thickness of a deck [mm]."""
COLUMNS = ("reading", "contacts", "check", "answer")


def frame_tree(rng: np.random.Generator) -> tuple[list[tuple[str, Any, Any]], float]:
    """The product tree of a frame with random sizes, and its height; its foot is at 0 [mm]."""
    from cad_solids import box, cut, fuse, hexagon, placed, ring, rod, shift

    radius = float(rng.uniform(2.5, 4.0))
    hole = radius + float(rng.uniform(0.2, 0.6))
    span, tall = float(rng.uniform(120, 160)), float(rng.uniform(80, 120))
    thick, deep = float(rng.uniform(6, 10)), float(rng.uniform(16, 24))
    half = span / 2
    out = 22.0  # distance of a bolt from the middle of the column
    holes = [rod(hole, -1, 100, (x, y, 0)) for x in (-half, half) for y in (-out, out)]
    own = [rod(hole, -1, thick + 1, (0, y, 0)) for y in (-out, out)]
    column = box((-12, -12, 0), (12, 12, tall))
    plate = cut(box((-20, -34, 0), (20, 34, thick)), *own)
    beam = cut(box((-half - 20, -34, 0), (half + 20, 34, deep)), *holes)
    deck = box((-half + 30, -30, 0), (half - 30, 30, DECK))
    head, washer_height = 1.6 * radius, 1.5
    length = thick + deep + 2 * washer_height + head + 3.0
    bolt = fuse(hexagon(3.4 * radius, 0, head), rod(radius, -length, 0))
    nut = cut(hexagon(3.4 * radius, 0, head), rod(radius, -1, head + 1))
    washer = ring(hole, 2.2 * radius, 0, washer_height)
    below = -(thick + deep + washer_height)
    joint = [  # its origin is the upper face of the beam
        ("bolt", bolt, shift((0, 0, washer_height))),
        ("washer", washer, None),
        ("washer", washer, shift((0, 0, below))),
        ("nut", nut, shift((0, 0, below - head))),
    ]
    post = [("column", column, None), ("plate", plate, shift((0, 0, tall)))]
    top = tall + thick + deep
    tree = [
        *(("post", post, shift((x, 0, 0))) for x in (-half, half)),
        ("beam", beam, shift((0, 0, tall + thick))),
        ("deck", placed(deck, None), shift((0, 0, top))),
        *(("joint", joint, shift((x, y, top))) for x in (-half, half) for y in (-out, out)),
    ]
    return tree, top + DECK


def draw_frames(solids: int, seed: int, *, linked: bool) -> list[tuple[str, Any, Any]]:
    """The product tree of a base with about a number of solids in frames [mm].

    `linked`: whether the frames are upright and carry rails, so that all parts are connected.
    """
    from cad_solids import box, shift
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf

    rng = np.random.default_rng(seed)
    frame, top = frame_tree(rng)
    count = max(1, round((solids - 1) / IN_FRAME))
    rows: list[tuple[str, Any, Any]] = []
    for first in range(0, count, IN_ROW):
        row: list[tuple[str, Any, Any]] = []
        for k in range(min(IN_ROW, count - first)):
            turn = gp_Trsf()
            angle = rng.integers(4) * np.pi / 2 if rng.random() < 0.5 else rng.uniform(0, 2 * np.pi)
            angle = 0.0 if linked else angle
            turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), float(angle))
            row.append(("frame", frame, shift((PITCH * k, 0, 0)).Multiplied(turn)))
        if linked:
            length = PITCH * (len(row) - 1) + 40
            row.append(("rail", box((-20, -15, 0), (length - 20, 15, 12)), shift((0, 0, top))))
        rows.append(("row", row, shift((0, PITCH * len(rows), 0))))
    if linked and len(rows) > 1:
        girder = box((-15, -15, 0), (15, PITCH * (len(rows) - 1) + 15, 12))
        rows.append(("girder", girder, shift((0, 0, top + 12))))
        rows.append(("girder", girder, shift((40, 0, top + 12))))
    low = -PITCH / 2
    deep = PITCH * math.ceil(count / IN_ROW)
    base = box((low, low, -10), (PITCH * IN_ROW + low, deep + low, 0))
    return [("array", [("base", base, None), *rows], None)]


def write_frames(solids: int, seed: int, path: Path, *, linked: bool = False) -> Path:
    """Write an array of about a number of solids as a STEP file."""
    from step_maker import write_step

    return write_step(path, draw_frames(solids, seed, linked=linked))


# times ------------------------------------------------------------------------------------


def _cpu(who: int) -> float:
    """CPU time of this process, or of its children that have ended [s]."""
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def measured(path: Path, *, ground: str, profile: bool) -> dict[str, Any]:
    """CPU seconds of each stage of an answer about a file, the memory, and the answer.

    `ground`: the held part; empty: the parts stand on a floor.
    """
    import kilter
    from kilter.cli import main as run_kilter
    from kilter.files.cad.step_document import step_bodies

    seconds: dict[str, float] = {}

    def timed(stage: str, work: Callable[[], Any]) -> Any:
        started = time.process_time()
        result = work()
        seconds[stage] = time.process_time() - started
        return result

    def loaded() -> kilter.Assembly:
        assembly = kilter.load(path, ground=ground or None)
        return assembly if ground else assembly.with_floor()

    import OCP.STEPCAFControl  # noqa: F401  the time to load it does not count

    timed("reading", lambda: step_bodies(path, (), lambda stage, solid: None))
    started = time.process_time()
    assembly = loaded()
    load = time.process_time() - started
    timed("contacts", lambda: kilter.contacts(assembly))
    timed("check", lambda: kilter.check(loaded()))
    seconds["check"] -= load
    out, err = io.StringIO(), io.StringIO()
    profiler = cProfile.Profile()

    def ask() -> None:
        held = ["--ground", ground] if ground else ["--floor"]
        words = ["check", str(path), *held, "--json", "--quiet"]
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            run_kilter(words)

    timed("answer", (lambda: profiler.runcall(ask)) if profile else ask)
    if not out.getvalue():
        raise SystemExit(err.getvalue())
    if profile:
        for order in ("tottime", "cumtime"):
            pstats.Stats(profiler).sort_stats(order).print_stats(45)
    answer = json.loads(out.getvalue())
    return {
        "solids": len(assembly.parts),
        "verdict": answer["verdict"],
        "ladder": [(row["assume"], row["verdict"]) for row in answer["ladder"]],
        "seconds": seconds,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
    }


def main() -> None:
    """Run the benchmark with a separate process for each row."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("solids", type=int, nargs="*", default=[100, 300, 1000])
    parser.add_argument("--seed", type=int, default=0, help="seed of the sizes and the angles")
    parser.add_argument("--linked", action="store_true", help="connect all frames by rails")
    parser.add_argument("--profile", action="store_true", help="print the slowest functions")
    parser.add_argument("--file", help=argparse.SUPPRESS)
    parser.add_argument("--ground", default="base", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.file:
        print(
            json.dumps(measured(Path(options.file), ground=options.ground, profile=options.profile))
        )
        return
    print(f"{'solids':>6}" + "".join(f"{name:>10}" for name in COLUMNS) + f"{'growth':>8}  answer")
    last: tuple[int, float] | None = None
    with tempfile.TemporaryDirectory() as folder:
        for solids in options.solids:
            path = Path(folder) / f"{solids}.step"
            file = write_frames(solids, options.seed, path, linked=options.linked)
            words = [sys.executable, __file__, "--file", str(file)]
            words += ["--profile"] if options.profile else []
            done = subprocess.run(words, capture_output=True, text=True, check=False)
            if done.returncode:
                raise SystemExit(done.stderr)
            *shown, line = done.stdout.strip().splitlines()
            row = json.loads(line)
            times = [row["seconds"][name] for name in COLUMNS]
            growth = "-"
            if last is not None and row["solids"] != last[0]:
                growth = f"{math.log(times[-1] / last[1]) / math.log(row['solids'] / last[0]):.2f}"
            last = row["solids"], times[-1]
            print(
                f"{row['solids']:6}" + "".join(f"{t:10.2f}" for t in times) + f"{growth:>8}  "
                f"{row['verdict']}"
                + "".join(f"; {rung}: {verdict}" for rung, verdict in row["ladder"]),
                flush=True,
            )
            print("\n".join(shown), end="\n" if shown else "")


if __name__ == "__main__":
    main()
