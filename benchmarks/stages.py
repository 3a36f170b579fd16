"""CPU time and peak memory of each stage, from a wall's file to its certificate.

    python benchmarks/stages.py                            1,000 and 10,000 bricks
    python benchmarks/stages.py 100000 --formats kilter    one format
    python benchmarks/stages.py 1000000 --until contacts   up to a stage
    python benchmarks/stages.py 10000 --friction 0.6       leaning wall with friction

The wall is a running bond, written as a kilter file of boxes and as meshes in COMPAS JSON, OBJ
and binary STL (a single triangle mesh that is split into its bodies). With friction, the wall
leans out of its plane by half of its limit; only kilter files contain friction and gravity. Each
row is a separate process; `peak` is its largest memory up to the end of the stage [GiB]. Imports
do not count. To compare two versions, set PYTHONPATH to each of them.
"""

from __future__ import annotations

import argparse
import importlib
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

IMPORTED = (
    "shapely",
    "scipy.sparse.csgraph",
    "scipy.sparse.linalg",
    "scipy.spatial",
    "kilter.files.own.models",
    "kilter.analysis.check",
    "kilter.solvers.highs",
)
FORMATS = {
    "kilter": "wall.kilter.json",
    "compas": "wall.json",
    "obj": "wall.obj",
    "stl": "wall.stl",
}
STAGES = ("read", "geometry", "contacts", "program", "solve", "certificate")
FACES = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
)
"""Faces of a box; corner k has the bits x = 1, y = 2, z = 4."""
LEAN = 0.5
"""Tangent of the tilt with friction, over that at which the wall overturns or slides [-]."""
CORNERS = np.array([[x - 0.5, y - 0.5, z - 0.5] for z in (0, 1) for y in (0, 1) for x in (0, 1)])


def leaning_wall(bricks: int, friction: float) -> Any:
    """A leaning wall of about `bricks` bricks that friction holds."""
    from kilter.scenes.walls import BRICK, tilted_wall

    courses = max(1, round(bricks**0.5))
    _, depth, height = BRICK
    slope = LEAN * min(depth / (height * courses), friction)
    tilt = math.degrees(math.atan(slope))
    return tilted_wall(tilt, friction=friction, courses=courses, per_course=round(bricks / courses))


def write(form: str, bricks: int, friction: float, path: Path) -> None:
    """Write the file of a wall of about `bricks` bricks in a format."""
    import kilter
    from kilter.scenes.walls import wall_of

    wall = leaning_wall(bricks, friction) if friction else wall_of(bricks)
    if form == "kilter":
        kilter.dump(wall, path)
        return
    sizes = np.array([part.shape.size for part in wall.parts])
    places = np.array([part.pose.position for part in wall.parts])
    corners = CORNERS * sizes[:, None] + places[:, None]
    if form == "stl":
        path.write_bytes(as_stl(corners))
    elif form == "obj":
        path.write_text("".join(as_obj(wall.names, corners)), encoding="utf-8")
    else:
        path.write_text(json.dumps(as_compas(wall, corners)), encoding="utf-8")


def as_stl(corners: np.ndarray) -> bytes:
    """Binary STL of all bricks; `corners`, shape (n, 8, 3)."""
    triangles = np.concatenate([FACES[:, [0, 1, 2]], FACES[:, [0, 2, 3]]])
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
    rows = np.zeros(len(corners) * len(triangles), kind)
    rows["corners"] = corners[:, triangles].reshape(-1, 3, 3)
    return bytes(80) + len(rows).to_bytes(4, "little") + rows.tobytes()


def as_obj(names: tuple[str, ...], corners: np.ndarray) -> list[str]:
    """Lines of an OBJ file of the bricks."""
    lines = []
    for k, (name, own) in enumerate(zip(names, corners.tolist(), strict=True)):
        lines.append(f"o {name}\n")
        lines += [f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in own]
        lines += ["f {} {} {} {}\n".format(*(8 * k + 1 + face)) for face in FACES]
    return lines


def as_compas(wall: Any, corners: np.ndarray) -> dict[str, Any]:
    """COMPAS assembly of the bricks, as JSON data."""
    faces = {str(k): face for k, face in enumerate(FACES.tolist())}
    nodes = {}
    for k, (part, own) in enumerate(zip(wall.parts, corners.tolist(), strict=True)):
        vertices = {str(i): dict(zip("xyz", xyz, strict=True)) for i, xyz in enumerate(own)}
        mesh = {"attributes": {"name": part.name}, "vertex": vertices, "face": faces}
        block = {"dtype": "compas_assembly.datastructures/Block", "data": mesh}
        nodes[str(k)] = {"is_support": part.grounded, "block": block}
    graph = {"dtype": "compas.datastructures/Graph", "data": {"node": nodes, "edge": {}}}
    return {"dtype": "compas_assembly.datastructures/Assembly", "data": {"graph": graph}}


def measured(path: Path, until: str) -> dict[str, Any]:
    """CPU seconds and peak memory of each stage, and the verdict, as a row."""
    for module in IMPORTED:
        importlib.import_module(module)
    import kilter
    from kilter.analysis.decision.judge import judge
    from kilter.contact import detect
    from kilter.mechanics.certificate import check_forces, check_motion
    from kilter.mechanics.program import build_program

    rows: list[dict[str, Any]] = []

    def timed(stage: str, work: Callable[[], Any]) -> Any:
        started = time.process_time()
        result = work()
        seconds = time.process_time() - started
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
        rows.append({"stage": stage, "cpu": seconds, "peak": peak})
        return result

    def all_of_it() -> str | None:
        assembly = timed("read", lambda: kilter.load(path))
        held = any(part.grounded for part in assembly.parts)
        assembly = assembly if held else assembly.with_grounded(assembly.names[0])
        timed("geometry", lambda: assembly.geometry)
        if until == "geometry":
            return None
        contacts = timed("contacts", lambda: detect.contacts(assembly))
        if until == "contacts":
            return None
        program = timed("program", lambda: build_program(assembly, contacts))
        if until == "program":
            return None
        judgement = timed("solve", lambda: judge(program))
        if judgement.stable:
            timed("certificate", lambda: check_forces(program, judgement.forces.forces))
        elif judgement.motion is not None:
            timed("certificate", lambda: check_motion(program, judgement.motion.motion))
        return {True: "stable", False: "unstable", None: "undecided"}[judgement.stable]

    verdict = all_of_it()
    return {
        "file": path.name,
        "megabytes": path.stat().st_size / 1e6,
        "verdict": verdict,
        "stages": rows,
    }


def main() -> None:
    """Run the benchmark with a separate process for each row."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("bricks", nargs="*", type=int, default=[1000, 10_000])
    parser.add_argument("--formats", nargs="*", choices=list(FORMATS))
    parser.add_argument("--friction", type=float, default=0.0, help="a leaning wall [-]")
    parser.add_argument("--until", choices=STAGES[1:], default=STAGES[-1])
    parser.add_argument("--json", action="store_true", help="one JSON object a row")
    parser.add_argument("--row", nargs=2, metavar=("FILE", "UNTIL"), help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.row:
        print(json.dumps(measured(Path(chosen.row[0]), chosen.row[1])))
        return
    if chosen.friction and chosen.formats not in (None, ["kilter"]):
        parser.error("only kilter files contain friction and gravity: use --formats kilter")
    formats = chosen.formats or (["kilter"] if chosen.friction else list(FORMATS))
    if not chosen.json:
        print(
            f"{'bricks':>8s} {'format':7s} {'MB':>7s}",
            *(f"{one:>16s}" for one in STAGES),
            "verdict",
        )
    with tempfile.TemporaryDirectory() as folder:
        for bricks in chosen.bricks:
            for form in formats:
                path = Path(folder) / FORMATS[form]
                write(form, bricks, chosen.friction, path)
                words = [sys.executable, __file__, "--row", str(path), chosen.until]
                one = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
                text = subprocess.run(words, check=True, stdout=subprocess.PIPE, text=True, env=one)
                row = {"bricks": bricks, "format": form} | json.loads(text.stdout)
                print(json.dumps(row) if chosen.json else row_text(row), flush=True)


def row_text(row: dict[str, Any]) -> str:
    """A row of the table: CPU seconds and, in brackets, peak memory [GiB]."""
    found = {one["stage"]: f"{one['cpu']:.2f} ({one['peak']:.2f})" for one in row["stages"]}
    head = f"{row['bricks']:8d} {row['format']:7s} {row['megabytes']:7.1f}"
    return " ".join([head, *(f"{found.get(one, '-'):>16s}" for one in STAGES), str(row["verdict"])])


if __name__ == "__main__":
    main()
