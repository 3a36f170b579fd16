"""Stable orientations of wedges, arches, towers and walls: programs and CPU time by method.

    python benchmarks/orientation.py                 20, 50 and 100 parts
    python benchmarks/orientation.py 20 --kinds arches walls
    python benchmarks/orientation.py 50 --kinds wedges --no-walk      (the walk takes minutes)

`walk` is the paper's walk on all facets, `joint` solves an LP per facet, `cone` computes all
stable directions, `map` the polytope Q with V vertices and F facets. The map stops at a limit of
programs; "-" marks unknown V and F. Contacts are detected beforehand.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from typing import Any

from kilter.errors import SolverError

KINDS = ("wedges", "arches", "towers", "walls")


def build(kind: str, count: int) -> Any:
    """A scene of about `count` free parts."""
    from kilter.scenes import arches, stacks, walls, wedges

    if kind == "wedges":
        return wedges.corner_wedges(count)
    if kind == "arches":
        return arches.arch(count)
    return stacks.tower(count) if kind == "towers" else walls.wall_of(count)


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """Result and CPU seconds of a function; the result is None if it stopped at the limit."""
    started = time.process_time()
    try:
        result = work()
    except SolverError:
        result = None
    return result, time.process_time() - started


def measured(kind: str, count: int, limit: int, *, walking: bool) -> dict[str, Any]:
    """Number of programs and CPU seconds of each method, as a row."""
    from kilter.analysis.regions.stable_cone import stable_cone
    from kilter.analysis.turning.facet_program import joint
    from kilter.analysis.turning.stability_map import stability_map
    from kilter.analysis.turning.walk import walk
    from kilter.contact import detect
    from kilter.mechanics.program import build_program

    assembly = build(kind, count)
    program = build_program(assembly, detect.contacts(assembly))
    row: dict[str, Any] = {"kind": kind, "parts": int(program.free.sum())}
    row |= dict.fromkeys(("walk_programs", "walk_seconds", "failed", "restarts", "difference"))
    if walking:
        walked, row["walk_seconds"] = timed(lambda: walk(program, every=True))
        row |= {
            "walk_programs": walked.programs,
            "failed": walked.failed,
            "restarts": walked.restarts,
        }
    joined, row["joint_seconds"] = timed(lambda: joint(program, every=True))
    row["joint_programs"] = joined.programs
    row["z"] = joined.z
    if walking:
        row["difference"] = abs(walked.z - joined.z) / float(program.mass[program.free].sum())
    cone, row["cone_seconds"] = timed(lambda: stable_cone(program))
    row["cone_programs"] = cone.programs
    row["kind_of_region"] = cone.cone.kind
    found, row["map_seconds"] = timed(lambda: stability_map(program, limit=limit))
    row["map_programs"] = None if found is None else found.programs
    row["vertices"] = None if found is None else len(found.vertices)
    row["facets"] = None if found is None else len(found.normals)
    return row


def row_text(row: dict[str, Any]) -> str:
    """A row of the table."""

    def number(key: str, width: int, form: str = "") -> str:
        value = row[key]
        return f"{'-':>{width}}" if value is None else f"{value:{width}{form}}"

    return " ".join(
        [
            f"{row['kind']:7s} {row['parts']:5d} {row['kind_of_region']:10s}",
            f"{number('walk_programs', 6)} {number('walk_seconds', 8, '.3f')}",
            f"{number('failed', 6)} {row['joint_programs']:6d} {row['joint_seconds']:8.3f}",
            f"{number('difference', 9, '.1e')}",
            f"{row['cone_programs']:6d} {row['cone_seconds']:8.3f}",
            f"{number('vertices', 6)} {number('facets', 6)} {number('map_programs', 6)}",
            f"{row['map_seconds']:8.3f}",
        ]
    )


HEAD = (
    f"{'kind':7s} {'parts':>5s} {'region':10s} {'walk':>6s} {'seconds':>8s} {'failed':>6s} "
    f"{'joint':>6s} {'seconds':>8s} {'differ':>9s} {'cone':>6s} {'seconds':>8s} "
    f"{'V':>6s} {'F':>6s} {'map':>6s} {'seconds':>8s}"
)


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="*", type=int, default=[20, 50, 100])
    parser.add_argument("--kinds", nargs="*", choices=KINDS, default=list(KINDS))
    parser.add_argument(
        "--limit", type=int, default=2000, help="largest number of programs of the map"
    )
    parser.add_argument("--no-walk", action="store_true")
    parser.add_argument("--json", action="store_true", help="one JSON object a row")
    chosen = parser.parse_args()
    if not chosen.json:
        print(HEAD)
    for kind in chosen.kinds:
        for count in chosen.parts:
            row = measured(kind, count, chosen.limit, walking=not chosen.no_walk)
            print(json.dumps(row) if chosen.json else row_text(row), flush=True)


if __name__ == "__main__":
    main()
