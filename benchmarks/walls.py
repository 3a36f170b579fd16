"""Time and memory of each stage for stable and unstable walls of 1,000 to 100,000 bricks.

    python benchmarks/walls.py                    1,000 and 10,000 bricks
    python benchmarks/walls.py 1000 10000 100000

`motion` computes the accelerations of an unstable wall; `residual` is their error in the
conditions of Gauss's principle [g]. Each row is a separate process, so that peak memory is
measured separately. `factor` is a sparse factorisation of the normal matrix J^T J (nested
dissection by the centres of the parts, SuperLU), the cost of an interior-point step, as a
reference for the machine. On a busy machine, compare only ratios within a run.
"""

from __future__ import annotations

import argparse
import importlib
import json
import resource
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

IMPORTED = (
    "shapely",
    "scipy.sparse.csgraph",
    "scipy.sparse.linalg",
    "scipy.spatial",
    "kilter.scenes.walls",
    "kilter.solvers.projection",
    "kilter.solvers.highs",
    "kilter.solvers.clarabel",
)
KINDS = ("stable", "unstable", "hanging")
STAGES = ("build", "geometry", "contacts", "program", "solve", "certificate", "motion", "factor")


def build(kind: str, bricks: int) -> Any:
    """A running-bond wall: complete, on a short base, or with an unsupported brick."""
    from kilter.scenes import walls

    if kind == "stable":
        return walls.wall_of(bricks)
    courses = max(4, round(float(np.sqrt(bricks))))
    per_course = max(4, round(bricks / courses))
    if kind == "unstable":
        return walls.short_base(courses, per_course, held=0.45 * per_course)
    return walls.hanging_brick(courses, per_course)


def measured(kind: str, bricks: int, *, factor: bool) -> dict[str, Any]:
    """Seconds of each stage, and the results, as a row."""
    for module in IMPORTED:  # imports do not count for a stage
        importlib.import_module(module)

    from kilter.analysis.decision.judge import judge
    from kilter.analysis.decision.motion import find_motion
    from kilter.contact import detect
    from kilter.mechanics.certificate import check_forces, check_motion
    from kilter.mechanics.program import build_program

    seconds: dict[str, float] = {}

    def timed(stage: str, work: Callable[[], Any]) -> Any:
        started = time.perf_counter()
        result = work()
        seconds[stage] = time.perf_counter() - started
        return result

    assembly = timed("build", lambda: build(kind, bricks))
    timed("geometry", lambda: assembly.geometry)
    contacts = timed("contacts", lambda: detect.contacts(assembly))
    program = timed("program", lambda: build_program(assembly, contacts))
    judgement = timed("solve", lambda: judge(program))
    if judgement.stable:
        timed("certificate", lambda: check_forces(program, judgement.forces.forces))
    elif judgement.motion is not None:
        timed("certificate", lambda: check_motion(program, judgement.motion.motion))
    residual = None
    if judgement.stable is False:
        residual = timed("motion", lambda: find_motion(program)).residual
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    if factor:
        timed("factor", lambda: factorise(program))
    return {
        "kind": kind,
        "bricks": len(assembly.parts) - 1,
        "patches": len(contacts),
        "verdict": {True: "stable", False: "unstable", None: "undecided"}[judgement.stable],
        "residual": residual,
        "peak_gib": peak,
        "seconds": seconds,
        "solvers": list(judgement.solvers),
    }


def factorise(program: Any) -> None:
    """Factorise J^T J once, with nested dissection by the centres of the parts."""
    from scipy.sparse import eye_array
    from scipy.sparse.linalg import splu

    jacobian = program.jacobian()
    normal = (jacobian.T @ jacobian).tocsr()
    normal = normal + 1e-9 * eye_array(normal.shape[0], format="csr")
    free = np.flatnonzero(program.free)
    order = np.concatenate(list(dissected(program, free)))
    rows = (order[:, None] * 6 + np.arange(6)).ravel()
    splu(
        normal[rows][:, rows].tocsc(),
        permc_spec="NATURAL",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )


def dissected(program: Any, free: np.ndarray) -> Iterator[np.ndarray]:
    """Nested dissection of the free parts: yields both halves, then their separator."""
    from scipy.sparse import csr_array

    number = np.full(len(program.names) + 1, -1)
    number[free] = np.arange(len(free))
    a, b = number[program.part_a], number[program.part_b]
    both = (a >= 0) & (b >= 0)
    ends = (np.concatenate([a[both], b[both]]), np.concatenate([b[both], a[both]]))
    graph = csr_array((np.ones(len(ends[0])), ends), shape=(len(free), len(free)))
    center = program.center[free]

    def halves(which: np.ndarray) -> Iterator[np.ndarray]:
        if len(which) <= 8:
            yield which
            return
        axis = int(np.argmax(np.ptp(center[which], axis=0)))
        order = which[np.argsort(center[which, axis], kind="stable")]
        left, right = order[: len(order) // 2], order[len(order) // 2 :]
        marked = np.zeros(len(free))
        marked[right] = 1.0
        touching = (graph[left] @ marked) > 0
        yield from halves(left[~touching])
        yield from halves(right)
        yield left[touching]

    return halves(np.arange(len(free)))


def main() -> None:
    """Run the benchmark with a separate process for each row."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bricks", nargs="*", type=int, default=[1000, 10_000])
    parser.add_argument("--kinds", nargs="*", choices=KINDS, default=list(KINDS))
    parser.add_argument("--no-factor", action="store_true", help="leave the yardstick out")
    parser.add_argument("--json", action="store_true", help="one JSON object a row")
    parser.add_argument("--row", nargs=2, metavar=("KIND", "BRICKS"), help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.row:
        print(json.dumps(measured(chosen.row[0], int(chosen.row[1]), factor=not chosen.no_factor)))
        return
    if not chosen.json:
        print(f"{'wall':9s} {'bricks':>7s} {'verdict':>9s}", end=" ")
        print(*(f"{stage:>11s}" for stage in STAGES), f"{'residual':>9s}", f"{'peak GiB':>9s}")
    for bricks in chosen.bricks:
        for kind in chosen.kinds:
            words = [sys.executable, __file__, "--row", kind, str(bricks)]
            words += ["--no-factor"] if chosen.no_factor else []
            text = subprocess.run(words, check=True, capture_output=True, text=True).stdout
            print(text.strip() if chosen.json else row_text(json.loads(text)), flush=True)


def row_text(row: dict[str, Any]) -> str:
    """A row of the table."""
    figures = [f"{row['seconds'].get(stage, float('nan')):11.4f}" for stage in STAGES]
    head = f"{row['kind']:9s} {row['bricks']:7d} {row['verdict']:>9s}"
    residual = "-" if row["residual"] is None else f"{row['residual']:.1e}"
    return " ".join([head, *figures, f"{residual:>9s}", f"{row['peak_gib']:9.2f}"])


if __name__ == "__main__":
    main()
