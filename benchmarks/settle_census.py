"""Census of `kilter settle`: assemblies at rest, disturbed at random in all six freedoms.

    python benchmarks/settle_census.py 75 --only walls,arches

Each assembly is at rest as made. Every free part is then moved by up to a size between 1e-5 and
1e-2 of its own size, in all six freedoms, and `kilter.settle` looks for a pose at rest. The kinds
take turns in chunks of seeds; after each chunk a table of all cases until then is printed. A row
counts

    rest      poses at rest, of all assemblies
    false     poses reported at rest whose proof `kilter.verify` or a second program rejects
    lower     poses below the level of --require that the undisturbed assembly reaches
    moved     median and largest ratio of the largest movement to the largest shift applied
    CPU       median and longest time of `kilter.settle` [s]

and every failure is listed with its cause. The second program recomputes gaps and forces of convex
parts from their corners (`tests/settled_pose/independent_rest.py`).
"""

from __future__ import annotations

import argparse
import itertools
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

import kilter
from kilter import Assembly, Box, Cylinder, Joint, Part, Pose, Prism, Sphere
from kilter.analysis.settled_pose.rigid_bodies import rigid_bodies
from kilter.scenes.arches import arch
from kilter.scenes.walls import wall
from kilter.tell.levels import level_rank
from kilter.work import stop_after

ROOT = Path(__file__).resolve().parents[1]
sys.path += [str(ROOT / "tests" / "settled_pose"), str(ROOT / "tests" / "scenes")]
from independent_rest import balances, separation  # noqa: E402
from random_voronoi import random_voronoi  # noqa: E402

SMALL = 12
"""Largest number of parts that the second program examines."""
TABLE = Part("table", Box([8, 8, 1]), [0, 0, -0.5], grounded=True)


def walls(rng: np.random.Generator) -> Assembly:
    """Brick walls of random width and height."""
    made = wall(int(rng.integers(2, 5)), int(rng.integers(2, 5))).with_friction(0.6)
    return replace(made, planar=False)


def arches(rng: np.random.Generator) -> Assembly:
    """Semicircular arches."""
    return replace(arch(int(rng.integers(5, 14))).with_friction(0.6), planar=False)


def stacks(rng: np.random.Generator) -> Assembly:
    """Stacks of boxes of random size, each with its centre over the box below."""
    parts, height = [TABLE], 0.0
    for k in range(int(rng.integers(2, 7))):
        size = rng.uniform(0.6, 1.2, 3)
        at = [*rng.uniform(-0.1, 0.1, 2), height + size[2] / 2]
        parts.append(Part(f"box {k}", Box(size), at))
        height += size[2]
    return Assembly(parts, friction=0.5)


def voronoi(rng: np.random.Generator) -> Assembly:
    """Cells of a box around random points; the cells at its bottom are held."""
    while True:
        made = random_voronoi(int(rng.integers(1_000_000)), friction=(0.6,))
        if not made.geometry.grounded.all() and kilter.check(made, effort=0).level is not None:
            return made


def prisms(rng: np.random.Generator) -> Assembly:
    """Stacked prisms of the form of an L and of a U."""
    outlines = [
        [[0, 0], [2, 0], [2, 1], [1, 1], [1, 0.5], [0, 0.5]],
        [[0, 0], [2, 0], [2, 1], [1.5, 1], [1.5, 0.4], [0.5, 0.4], [0.5, 1], [0, 1]],
    ]
    outline = outlines[int(rng.integers(2))]
    low = Part("low", Prism(outline, 1.0), [-1, 0, 0])
    depth = 0.5 if len(outline) == 6 else 0.4
    cap = Part("cap", Box([0.9, 0.9, 1.0]), [-0.5 if len(outline) == 6 else 0.0, 0, depth + 0.5])
    return Assembly([TABLE, low, cap], friction=0.5)


def seats(rng: np.random.Generator) -> Assembly:
    """Balls on a trough of two boards."""
    radius = float(rng.uniform(0.3, 0.6))
    half = np.radians(45.0) / 2
    boards = [
        Part(name, Box([3, 3, 0.2]), Pose(
            [sign * (1.5 + 0.1) / np.sqrt(2), 0, (1.5 - 0.1) / np.sqrt(2)],
            [np.cos(half), 0, -sign * np.sin(half), 0]), grounded=True)
        for name, sign in (("left", -1.0), ("right", 1.0))
    ]  # fmt: skip
    ball = Part("ball", Sphere(radius), [0, 0, radius * np.sqrt(2)])
    return Assembly([*boards, ball], friction=0.4)


def logs(rng: np.random.Generator) -> Assembly:
    """A log between two held logs that lie apart."""
    radius, apart = 0.5, float(rng.uniform(1.02, 1.5))
    turn = [np.cos(np.pi / 4), np.sin(np.pi / 4), 0, 0]
    height = float(np.sqrt((2 * radius) ** 2 - (apart / 2) ** 2))
    places = [[-apart / 2, 0, radius], [apart / 2, 0, radius], [0, 0, radius + height]]
    return Assembly(
        [Part(f"log {k}", Cylinder(radius, 3), Pose(at, turn), grounded=k < 2)
         for k, at in enumerate(places)], friction=0.5,
    )  # fmt: skip


def cylinders(rng: np.random.Generator) -> Assembly:
    """Upright cylinders on each other."""
    parts, height = [TABLE], 0.0
    for k in range(int(rng.integers(1, 4))):
        radius, tall = float(rng.uniform(0.3, 0.6)), float(rng.uniform(0.4, 0.8))
        at = [*rng.uniform(-0.05, 0.05, 2), height + tall / 2]
        parts.append(Part(f"drum {k}", Cylinder(radius, tall), at))
        height += tall
    return Assembly(parts, friction=0.5)


def joined(rng: np.random.Generator) -> Assembly:
    """Flanges that are fastened to each other by a fixed joint, on a table."""
    parts = [TABLE, *(Part(f"flange {k}", Cylinder(0.6, 0.2), [0, 0, 0.1 + 0.2 * k])
                      for k in range(2))]  # fmt: skip
    return Assembly(parts, joints=[Joint(("flange 0", "flange 1"), "fixed")], friction=0.4)


FLAT: dict[str, Callable[[np.random.Generator], Assembly]] = {
    "walls": walls, "arches": arches, "stacks": stacks, "voronoi": voronoi,
}  # fmt: skip
OTHER: dict[str, Callable[[np.random.Generator], Assembly]] = {
    "prisms": prisms, "seats": seats, "logs": logs, "cylinders": cylinders, "joined": joined,
}  # fmt: skip


def disturbed(assembly: Assembly, rng: np.random.Generator) -> tuple[Assembly, float]:
    """The assembly with every free body moved at random, and the largest shift applied."""
    bodies = rigid_bodies(assembly, ())
    size = 10 ** rng.uniform(-5, -2)
    steps = size * rng.uniform(-1, 1, (len(bodies.mass), 6))
    steps[:, :3] *= bodies.size[:, None]
    steps[0] = 0.0
    return bodies.moved(steps).assembly(), float(np.linalg.norm(steps[:, :3], axis=1).max())


def rejected(answer: kilter.Settled, flat: bool) -> str:
    """Reason why a pose reported at rest is rejected; empty if it is confirmed."""
    result = kilter.verify(answer.assembly, answer.proof())
    if not result.holds:
        return f"verify: {result.reasons[0]}"
    if not flat or len(answer.assembly) > SMALL:
        return ""
    for a, b in itertools.combinations(range(len(answer.assembly)), 2):
        gap = separation(answer.assembly, a, b)
        if gap < -2 * answer.tolerance:
            return f"second program: overlap of {-gap:.3g}"
    short = balances(answer.assembly, 4 * answer.tolerance)
    return f"second program: imbalance {short:.1e}" if short > 1e-4 else ""


@dataclass(slots=True)
class Row:
    """Counts of the cases of a kind until now."""

    cases: int = 0
    rest: int = 0
    false: int = 0
    lower: int = 0
    ratios: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)

    def add(self, other: Row) -> None:
        """Include the cases of another row."""
        self.cases += other.cases
        self.rest += other.rest
        self.false += other.false
        self.lower += other.lower
        self.ratios += other.ratios
        self.seconds += other.seconds

    def __str__(self) -> str:
        share = 100 * self.rest / max(self.cases, 1)
        moved, took = (
            f"{np.median(each):.2f}, {max(each):.2f}" if each else "-"
            for each in (self.ratios, self.seconds)
        )
        return (
            f"{self.rest:4} of {self.cases:4} {share:6.1f} %  {self.false:5} {self.lower:5}  "
            f"{moved:12} {took:12}"
        )


def examine(
    kind: str, make: Callable[[np.random.Generator], Assembly], seed: int, flat: bool,
    limit: float, require: str, row: Row,
) -> str:  # fmt: skip
    """Settle a disturbed assembly and count it; the cause of a failure, else an empty string."""
    rng = np.random.default_rng([seed, len(kind)])
    row.cases += 1
    try:
        made = make(rng)
        level = kilter.check(made, require=require).level
        drawn, most = disturbed(made, rng)
        started = time.process_time()
        with stop_after(limit):
            answer = kilter.settle(drawn, require=require, nearest=True)
    except kilter.KilterError as error:
        return str(error)
    row.seconds.append(time.process_time() - started)
    if answer.state != "at-rest":
        return str(answer.to_dict()["sentence"])
    row.rest += 1
    row.ratios.append(float(answer.distance.max()) / most)
    why = rejected(answer, flat)
    row.false += bool(why)
    if level_rank(answer.level) < min(level_rank(level), level_rank(require)):
        row.lower += 1
        alone = None if answer.closed_verdict is None else answer.closed_verdict.level
        after = None if answer.settled_verdict is None else answer.settled_verdict.level
        as_made = len(kilter.contacts(made).points)
        points = 0 if answer.closed is None else len(answer.closed.contacts.points)
        why += (
            f" level {answer.level} (closed points {alone}, all contacts {after}), undisturbed "
            f"{level}: {points} closed points, {as_made} as made"
        )
    return why.strip()


def table(rows: dict[str, Row]) -> str:
    """Table of all kinds, with the sums of the flat kinds and of the others."""
    lines = [
        f"{'kind':10} {'rest':22}  {'false':>5} {'lower':>5}  {'moved':12} {'CPU [s]':12}",
        *(f"{kind:10} {row}" for kind, row in rows.items()),
    ]
    for name, kinds in (("flat", FLAT), ("others", OTHER)):
        total = Row()
        for kind in kinds:
            total.add(rows.get(kind, Row()))
        lines.append(f"{name:10} {total}")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("count", type=int, nargs="?", default=20, help="assemblies of each kind")
    parser.add_argument("--seconds", type=float, default=60.0, help="time limit of a search [s]")
    parser.add_argument("--require", default="settles", help="level to reach")
    parser.add_argument("--chunk", type=int, default=5, help="seeds of each kind between tables")
    parser.add_argument("--only", default="", help="kinds, with commas")
    options = parser.parse_args()
    chosen = {
        kind: make
        for kind, make in (FLAT | OTHER).items()
        if not options.only or kind in options.only.split(",")
    }
    rows = {kind: Row() for kind in chosen}
    for begin in range(0, options.count, options.chunk):
        for kind, make in chosen.items():
            for seed in range(begin, min(begin + options.chunk, options.count)):
                why = examine(
                    kind, make, seed, kind in FLAT, options.seconds, options.require, rows[kind]
                )
                if why:
                    print(f"  {kind} {seed}: {why}", flush=True)
        print(table(rows), flush=True)


if __name__ == "__main__":
    main()
