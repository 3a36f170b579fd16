"""CPU time and memory of `check` for STEP files that are costly for their number of parts.

    python benchmarks/cad_crowded.py               all families
    python benchmarks/cad_crowded.py iris board    some of them
    python benchmarks/cad_crowded.py --write FOLDER    write the files, without measurements

Each family is drawn like files of others: an iris of equal leaves with pins that overlap and cross;
a keyboard whose board has hundreds of holes; a camera with circuit boards that are one solid
with all their chips and overlap the case; a robot on wheels; a box of small electronic parts.
The columns are CPU seconds as in `cad_frames.py`, and the largest memory.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "files"))

Tree = list[tuple[str, Any, Any]]
COLUMNS = ("reading", "contacts", "check", "answer")


def _pierced(low: tuple[float, float], high: tuple[float, float], span: tuple[float, float],
             holes: list[Any]) -> Any:  # fmt: skip
    """A plate between two heights with holes; `holes` are wires in the plane of height 0 [mm]."""
    from cad_solids import shift
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Vec
    from OCP.TopLoc import TopLoc_Location
    from OCP.TopoDS import TopoDS

    face = BRepBuilderAPI_MakeFace(_rectangle(low, high))
    for wire in holes:
        face.Add(TopoDS.Wire(wire.Reversed()))
    lifted = face.Face().Moved(TopLoc_Location(shift((0, 0, span[0]))))
    return BRepPrimAPI_MakePrism(lifted, gp_Vec(0, 0, span[1] - span[0])).Shape()


def _rectangle(low: tuple[float, float], high: tuple[float, float]) -> Any:
    """A rectangular wire in the plane of height 0."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakePolygon
    from OCP.gp import gp_Pnt

    outline = BRepBuilderAPI_MakePolygon()
    for x, y in (low, (high[0], low[1]), high, (low[0], high[1])):
        outline.Add(gp_Pnt(x, y, 0))
    outline.Close()
    return outline.Wire()


def _circle(x: float, y: float, radius: float) -> Any:
    """A circular wire in the plane of height 0."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeWire
    from OCP.gp import gp_Ax2, gp_Circ, gp_Dir, gp_Pnt

    frame = gp_Ax2(gp_Pnt(x, y, 0), gp_Dir(0, 0, 1))
    return BRepBuilderAPI_MakeWire(BRepBuilderAPI_MakeEdge(gp_Circ(frame, radius)).Edge()).Wire()


def _all_fused(solids: list[Any]) -> Any:
    """The union of the first solid and the others, which are apart from each other."""
    from cad_solids import fuse
    from step_maker import compound

    return fuse(solids[0], compound(solids[1:]))


def draw_iris(leaves: int = 10) -> Tree:
    """An iris: a base, equal leaves that cross, two pins a leaf, a driving ring, and a cover."""
    from cad_solids import box, cut, fuse, prism, ring, rod, shift
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf

    thick, radius, pin = 2.0, 40.0, 1.5
    blade = cut(ring(28.0, 46.0, 0.0, thick), box((-60, -60, -1), (60, 0, thick + 1)))
    blade = fuse(blade, rod(9.0, 0, thick, (37, 0, 0)), rod(9.0, 0, thick, (-37, 0, 0)))
    blade = cut(blade, rod(pin, -1, thick + 1, (37, 0, 0)), rod(pin, -1, thick + 1, (-37, 0, 0)))
    peg = rod(pin, -3.0, thick + 1.5, (0, 0, 0))
    turns = []
    for k in range(leaves):
        turn = gp_Trsf()
        turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), 2 * np.pi * k / leaves)
        turns.append(turn)
    tree: Tree = [("base", ring(20.0, 60.0, -6.0, 0.0), None)]
    for turn in turns:
        tree.append(("leaf", blade, turn.Multiplied(shift((12.0, 0, 0)))))
        for x in (37.0, -37.0):
            tree.append(("pin", peg, turn.Multiplied(shift((12.0 + x, 0, 0)))))
    drive = cut(ring(20.0, 60.0, thick, 6.0), *[box((10, -2, 0), (58, 2, 4)) for _ in range(1)])
    tree.append(("drive", drive, None))
    tree.append(("cover", cut(ring(18.0, 64.0, 6.0, 9.0), rod(3, 0, 20, (radius, 0, 0))), None))
    tree.append(("handle", prism([(58, 2), (80, 2), (80, 6), (58, 6)], -2, 2), None))
    return [("iris", tree, None)]


def draw_keyboard(columns: int = 11, rows: int = 7) -> Tree:
    """A keyboard: a case, a circuit board with holes, a plate, switches and diodes."""
    from cad_solids import box, cut, fuse, rod, shift

    pitch = 19.05
    width, deep = columns * pitch, rows * pitch
    keys = [((i + 0.5) * pitch, (j + 0.5) * pitch) for i in range(columns) for j in range(rows)]
    post, leg = 2.0, 0.75
    legs = ((-3.81, 2.54), (2.54, 5.08), (-5.08, 0.0), (5.08, 0.0))
    holes = [_circle(x, y, post) for x, y in keys]
    holes += [_circle(x + u, y + v, leg) for x, y in keys for u, v in legs]
    board = _pierced((0, 0), (width, deep), (0.0, 1.6), holes)
    windows = [_rectangle((x - 7, y - 7), (x + 7, y + 7)) for x, y in keys]
    plate = _pierced((0, 0), (width, deep), (5.1, 6.6), windows)
    switch = fuse(box((-6.9, -6.9, 1.6), (6.9, 6.9, 6.6)), box((-7.8, -7.8, 6.6), (7.8, 7.8, 11.6)))
    switch = fuse(switch, rod(post, -1.7, 1.6), rod(leg, -1.7, 1.6, (-3.81, 2.54, 0)))
    switch = fuse(switch, rod(leg, -1.7, 1.6, (2.54, 5.08, 0)))
    diode = _all_fused(
        [box((-1.8, -0.8, -1.2), (1.8, 0.8, -0.1)), box((-2.6, -0.4, -0.1), (2.6, 0.4, 0.0))]
    )
    case = cut(
        box((-4, -4, -8), (width + 4, deep + 4, 6)), box((-0.2, -0.2, -5), (width + 0.2, 999, 7))
    )
    studs = [rod(3.0, -5, 0, (x + pitch / 2, y + pitch / 2, 0)) for x, y in keys[:: len(keys) // 8]]
    tree: Tree = [("case", _all_fused([case, *studs]), None), ("board", board, None)]
    tree.append(("plate", plate, None))
    tree += [("switch", switch, shift((x, y, 0))) for x, y in keys]
    tree += [("diode", diode, shift((x + 6, y - 6.5, 0))) for x, y in keys]
    return [("keyboard", tree, None)]


def _populated(rng: np.random.Generator, size: tuple[float, float], chips: int) -> Any:
    """A circuit board with all its chips, pins and capacitors as one solid."""
    from cad_solids import box, rod

    width, deep = size
    places = rng.permutation(int(width // 3) * int(deep // 3))[:chips]
    holes = [_circle(x, y, 1.6) for x in (3, width - 3) for y in (3, deep - 3)]
    solids = [_pierced((0, 0), size, (0.0, 1.6), holes)]
    for place in places.tolist():
        x, y = 3.0 * (place % int(width // 3)), 3.0 * (place // int(width // 3))
        if min(x, width - x) < 8 and min(y, deep - y) < 8:
            continue
        side = int(rng.integers(2))
        tall = float(rng.uniform(0.5, 3.0))
        low, high = (1.6, 1.6 + tall) if side else (-tall, 0.0)
        if rng.random() < 0.3:
            solids.append(rod(float(rng.uniform(0.5, 1.3)), low, high, (x + 1.5, y + 1.5, 0)))
        else:
            wide, long = rng.uniform(0.8, 2.8, 2).tolist()
            solids.append(box((x, y, low), (x + wide, y + long, high)))
    return _all_fused(solids)


def draw_camera(chips: int = 220) -> Tree:
    """A camera: a case of two shells, a lens, a foot, and two populated boards that overlap it."""
    from cad_solids import box, cut, fuse, ring, rod, shift

    rng = np.random.default_rng(5)
    front = cut(
        box((0, 0, 0), (64, 64, 20)), box((2, 2, 2), (62, 62, 21)), rod(9, -1, 5, (32, 32, 0))
    )
    posts = [rod(3.0, 2, 8.2, (x, y, 0)) for x in (5, 59) for y in (5, 59)]
    front = fuse(front, *posts)
    back = cut(box((0, 0, 20), (64, 64, 34)), box((2, 2, 19), (62, 62, 32)))
    lens = fuse(ring(7.0, 9.0, -8.0, 2.0), ring(7.0, 12.0, -8.0, -0.5))
    foot = box((16, 16, -28), (48, 48, -8))
    sensor = _populated(rng, (61.0, 61.0), chips)
    main = _populated(rng, (61.5, 61.0), chips)
    return [
        (
            "camera",
            [
                ("front", front, None),
                ("back", back, None),
                ("lens", lens, shift((32, 32, 0))),
                ("foot", foot, None),
                ("sensor board", sensor, shift((1.5, 1.5, 8.0))),
                ("main board", main, shift((1.0, 1.5, 17.0))),
            ],
            None,
        )
    ]


def draw_robot() -> Tree:
    """A robot on four wheels: two plates on standoffs, motors with gears, screws, a battery."""
    from cad_solids import box, cut, eased, fuse, hexagon, ring, rod, shift, torus
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf

    rng = np.random.default_rng(1)
    sites = [(x, y) for x in (-60.0, 60.0) for y in (-40.0, 40.0)]
    screws = [(x, y) for x in (-50.0, 0.0, 50.0) for y in (-25.0, 25.0)]
    slots = [_rectangle((x, y), (x + 8, y + 3)) for x in range(-70, 70, 14) for y in (-12, 0, 9)]
    lower = _pierced((-80, -48), (80, 48), (0, 3), [_circle(x, y, 1.6) for x, y in screws] + slots)
    upper = _pierced((-80, -48), (80, 48), (33, 36), [_circle(x, y, 1.6) for x, y in screws])
    standoff = cut(hexagon(5.5, 3, 33), rod(1.5, 0, 40))
    screw = fuse(rod(1.5, 24.0, 36), ring(0.0001, 2.75, 36, 38.5), rod(2.75, 36, 38.5))
    under = fuse(rod(1.5, 0, 12.0), rod(2.75, -2.5, 0))
    tyre = cut(fuse(torus(27, 6, 0), ring(18, 31, -6, 6)), ring(31, 60, -20, 20))
    hub = fuse(ring(2.0, 18, -4, 4), ring(2.0, 5, 4, 12))
    motor = fuse(box((-10, -9, -30), (10, 9, 0)), rod(2.0, 0, 24), rod(5, 0, 1.5))
    tree: Tree = [("lower", lower, None), ("upper", upper, None)]
    for x, y in screws:
        tree += [("standoff", standoff, shift((x, y, 0))), ("screw", screw, shift((x, y, 0)))]
        tree.append(("under screw", under, shift((x, y, 0))))
    for x, y in sites:
        turn = gp_Trsf()
        side = -np.pi / 2 if y > 0 else np.pi / 2
        turn.SetRotation(gp_Ax1(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)), side)
        place = shift((x, y - np.sign(y) * 4, -9.0)).Multiplied(turn)
        tree.append(("motor", motor, place))
        tree.append(("hub", hub, place.Multiplied(shift((0, 0, 16)))))
        tree.append(("tyre", tyre, place.Multiplied(shift((0, 0, 16)))))
        tree += [
            ("grub", rod(1.5, 3, 20, (0, 0, 24), (1, 0, 0)), place),
            ("clamp", cut(ring(10, 14, -20, -12), box((-20, 9, -30), (20, 20, 0))), place),
        ]
    for k in range(14):
        x, y = -70 + 11 * k, float(rng.uniform(-8, 8))
        part = eased(box((x, y, 3), (x + 9, y + 12, 12)), rng, 1.0)
        tree.append(("module", part, None))
    for k in range(14):
        x = -70.0 + 10 * k
        tree.append(("pillar", fuse(rod(3, 36, 44, (x, 0, 0)), rod(1, 44, 50, (x, 0, 0))), None))
    return [("robot", tree, None)]


def draw_electronics(count: int = 47) -> Tree:
    """Small electronic parts on a board: round cans, chips with legs, headers that overlap it."""
    from cad_solids import box, fuse, rod, shift

    rng = np.random.default_rng(3)
    places = [(x, y) for x in range(8) for y in range(6)][: count - 1]
    holes = [_circle(8 * x + 4 + u, 8 * y + 4, 0.5) for x, y in places for u in (-1.27, 1.27)]
    tree: Tree = [("board", _pierced((0, 0), (64, 48), (0, 1.6), holes), None)]
    can = fuse(rod(3.0, 1.6, 8), rod(0.5, -2, 1.6, (-1.27, 0, 0)), rod(0.5, -2, 1.6, (1.27, 0, 0)))
    legs = [box((x, y, 1.2), (x + 0.5, y + 1.0, 2.5)) for x in (-2, -0.5, 1) for y in (-3.0, 2.0)]
    chip = _all_fused([box((-2.2, -2.2, 1.9), (2.2, 2.2, 3.5)), *legs])
    header = _all_fused(
        [box((-3.2, -1.2, 1.6), (3.2, 1.2, 4.1))]
        + [rod(0.32, -2.5, 9.0, (x, 0, 0)) for x in (-2.54, 0, 2.54)]
    )
    for x, y in places:
        shape = (can, chip, header)[int(rng.integers(3))]
        tree.append(("part", shape, shift((8 * x + 4, 8 * y + 4, 0))))
    return [("electronics", tree, None)]


FAMILIES: dict[str, Callable[[], Tree]] = {
    "iris": draw_iris,
    "keyboard": draw_keyboard,
    "camera": draw_camera,
    "robot": draw_robot,
    "electronics": draw_electronics,
}


def main() -> None:
    """Run the benchmark with a separate process for each family."""
    from step_maker import write_step

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("family", nargs="*", default=list(FAMILIES), help=", ".join(FAMILIES))
    parser.add_argument("--write", type=Path, help="write the files to a folder, and end")
    parser.add_argument("--profile", action="store_true", help="print the slowest functions")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.write or Path(temporary)
        files = [write_step(folder / f"{name}.step", FAMILIES[name]()) for name in options.family]
        if options.write:
            return
        print(f"{'':>12}{'parts':>6}" + "".join(f"{name:>10}" for name in COLUMNS) + "  memory")
        for file in files:
            script = Path(__file__).with_name("cad_frames.py")
            words = [sys.executable, str(script), "--file", str(file), "--ground", ""]
            words += ["--profile"] if options.profile else []
            done = subprocess.run(words, capture_output=True, text=True, check=False)
            if done.returncode:
                raise SystemExit(done.stderr)
            *shown, line = done.stdout.strip().splitlines()
            row = json.loads(line)
            times = "".join(f"{row['seconds'][name]:10.2f}" for name in COLUMNS)
            print(f"{file.stem:>12}{row['solids']:6}{times}{row['memory']:6.2f} GB", flush=True)
            print("\n".join(shown), end="\n" if shown else "")


if __name__ == "__main__":
    main()
