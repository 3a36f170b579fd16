"""The same answer for the same assembly: copies that differ in what must not matter.

    python benchmarks/metamorphic.py             38 assemblies, 370 copies
    python benchmarks/metamorphic.py 10 20       10 assemblies, from the 20th on

Each copy is turned, mirrored, scaled by 1e-3 or 1e3, listed in another order, renamed, in
millimetres, with a part split into two joined halves, with a far held part, or moved by a thousand
sizes. Verdict, level, and the limits of `margin` (tilt, friction, load factor; relative to 1e-6)
must correspond, for the first four assemblies also the least acceleration of a carrier and the
largest along the push. The last assemblies are planar, or have bonds. Each difference is printed;
the exit code is 1 if there is any.
"""

from __future__ import annotations

import argparse
import collections
import dataclasses
import os
import sys
import time
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

for _pool in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_pool] = "1"  # before numpy

import numpy as np  # noqa: E402

TESTS = Path(__file__).resolve().parents[1] / "tests"
sys.path += [str(TESTS / "scenes")]

from random_friction import random_assembly  # noqa: E402
from transformations import has_box, mirrored, permuted, renamed, scaled, split  # noqa: E402

from kilter import margin  # noqa: E402
from kilter.analysis.load_limit import Limit  # noqa: E402
from kilter.analysis.transport.carried_set import CarriedSet, LeastAcceleration  # noqa: E402
from kilter.arrays import Array  # noqa: E402
from kilter.assembly import Assembly  # noqa: E402
from kilter.rigid import quaternion_to_matrix  # noqa: E402
from kilter.scenes import arches, mortar, paper, stacks, walls  # noqa: E402
from kilter.scenes.pieces import block, moved  # noqa: E402

AGREES = 1e-6
"""Largest relative difference of two limits; of a tilt in degrees over a right angle."""
NUMBERS = {"tilt_deg": 90.0, "friction": 0.0, "load_factor": 0.0}
"""Keys of the limits, each with the size below which a difference is absolute."""
CARRIED = 4
"""Number of assemblies whose limits of transport are compared."""
SMALL = 1e-3
"""Limits below this are compared absolutely."""


def bases() -> list[tuple[str, Callable[[], Assembly]]]:
    """Assemblies that hold, that fall and that are near a limit, with and without friction."""
    known: dict[str, Callable[[], Assembly]] = {
        "tower": lambda: stacks.tower(3),
        "staircase": stacks.staircase,
        "slope": lambda: stacks.block_on_slope(20.0, friction=0.5),
        "slope-falls": lambda: stacks.block_on_slope(30.0, friction=0.5),
        "diamond": lambda: stacks.diamond(3),
        "wall": lambda: walls.wall(3, 3, friction=0.6),
        "leaning-wall": lambda: walls.tilted_wall(4.0, courses=3, per_course=3),
        "opening": lambda: walls.wall_with_opening(4, 4, opening=(1, 2, 1, 2)),
        "figure-8": paper.figure_8,
        "figure-11": lambda: paper.figure_11("b"),
    }

    def in_space(seed: int) -> Assembly:
        return dataclasses.replace(random_assembly(seed)[1], planar=False)

    seeds = (seed for seed in range(1000) if random_assembly(seed)[0] in ("stack", "fence"))
    random = [(f"random-{seed}", lambda s=seed: in_space(s)) for seed in islice(seeds, 21)]
    kept: dict[str, Callable[[], Assembly]] = {
        "planar-arch": lambda: arches.arch(9, ratio=0.3, friction=0.6, planar=True),
        "corbel": mortar.corbel,
    }
    planar = (seed for seed in range(1000) if random_assembly(seed)[1].planar)
    flat = [(f"planar-{s}", lambda s=s: random_assembly(s)[1]) for s in islice(planar, 5)]
    return [*known.items(), *random, *kept.items(), *flat]


def size_of(assembly: Assembly) -> float:
    """Largest extent of an assembly [length unit]."""
    return float(np.ptp(assembly.geometry.vertices, axis=0).max())


def level_axis(assembly: Assembly, seed: int) -> Array:
    """A random direction across gravity, for the load factor."""
    along = [0, 1, 0] if assembly.planar else np.random.default_rng(seed).normal(size=3)
    aside = np.cross(assembly.down, along)
    return np.asarray(aside / np.linalg.norm(aside))


def with_far_part(assembly: Assembly, rng: np.random.Generator) -> Assembly:
    """A copy with a held block at 50 sizes from the others."""
    size = size_of(assembly)
    far = block("far", np.full(3, 50.0) * size, np.full(3, 51.0) * size, grounded=True)
    return dataclasses.replace(assembly, parts=[*assembly.parts, far])


def in_millimetres(assembly: Assembly, rng: np.random.Generator) -> Assembly:
    """A copy in another unit of length."""
    grown = scaled(assembly, 1000.0)
    parts = [
        part if part.given_mass is None else dataclasses.replace(part, mass=part.given_mass * 1e-9)
        for part in grown.parts
    ]
    return dataclasses.replace(grown, parts=parts, units="mm")


COPIES: dict[str, Callable[[Assembly, np.random.Generator], Assembly]] = {
    "scaled 1e-3": lambda a, rng: scaled(a, 1e-3),
    "scaled 1e3": lambda a, rng: scaled(a, 1e3),
    "permuted": lambda a, rng: permuted(a, rng.permutation(len(a.parts))),
    "renamed": lambda a, rng: renamed(a, lambda name: f"{name[::-1]}~"),
    "millimetres": in_millimetres,
    "far part": with_far_part,
    "moved": lambda a, rng: moved(a, shift=1e3 * size_of(a) * np.array([0.6, -0.48, 0.64])),
}


def copies_of(base: Assembly, push: Array, seed: int) -> Iterator[tuple[str, Assembly, Array]]:
    """Yield the name of each copy, the copy, and the direction of the push in it."""
    rng = np.random.default_rng(seed)
    quaternion = rng.normal(size=4) * ([1, 0, 1, 0] if base.planar else 1)
    quaternion /= np.linalg.norm(quaternion)
    yield "turned", moved(base, quaternion), quaternion_to_matrix(quaternion) @ push
    for name, make in COPIES.items():
        if not (base.bonds and name == "millimetres"):  # the strength of a bond is in newton
            yield name, make(base, rng), push
    if base.bonds or base.contacts:  # only parts are mirrored and split
        return
    yield "mirrored", mirrored(base), push * [-1, 1, 1]
    if has_box(base):
        yield "split", split(base), push


def answer_of(assembly: Assembly, push: Array) -> dict[str, Any]:
    """Verdict, level and limits of an assembly, as `margin` reports them."""
    found = margin(assembly, push=push, pushed=[])
    data = found.to_dict()
    keys = {key: data[key] for key in NUMBERS}
    return {"verdict": found.verdict, "level": found.check.level, **keys}


def carried_by(assembly: Assembly, push: Array) -> dict[str, Any]:
    """The least horizontal acceleration of a carrier, and the largest along the push [g]."""
    carried = CarriedSet(margin(assembly, pushed=[]).program)
    least, along = carried.least(), carried.along(push)
    return {
        "least": least.value if isinstance(least, LeastAcceleration) else least.why,
        "along": along.value if isinstance(along, Limit) else along.why,
    }


def differences(one: dict[str, Any], other: dict[str, Any]) -> list[str]:
    """Differences between two answers, in words."""
    return [
        f"{key} {old} became {other[key]}"
        for key, old in one.items()
        if not same(old, other[key], max(NUMBERS.get(key, 0.0), SMALL))
    ]


def same(old: Any, new: Any, least: float) -> bool:
    """Whether two values correspond: numbers, pairs of numbers, or words."""
    if isinstance(old, list) and isinstance(new, list):
        return all(same(a, b, least) for a, b in zip(old, new, strict=True))
    if isinstance(old, float) and isinstance(new, float):
        return old == new or abs(new - old) <= AGREES * max(abs(old), least)
    return bool(old == new)


def main() -> int:
    """Compare all copies; return 1 if an answer differs."""
    reader = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    reader.add_argument("count", type=int, nargs="?", default=38)
    reader.add_argument("first", type=int, nargs="?", default=0)
    words = reader.parse_args()
    counts: collections.Counter[str] = collections.Counter()
    pairs, started = 0, time.process_time()
    for k, (name, build) in enumerate(bases()[words.first : words.first + words.count]):
        base, seed = build(), words.first + k
        push = level_axis(base, seed)
        transported = seed < CARRIED

        def answers(assembly: Assembly, push: Array, more: bool = transported) -> dict[str, Any]:
            return answer_of(assembly, push) | (carried_by(assembly, push) if more else {})

        expected = answers(base, push)
        for copy, other, along in copies_of(base, push, seed):
            pairs += 1
            for difference in differences(expected, answers(other, along)):
                counts[copy] += 1
                print(f"{name}, {copy}: {difference}", flush=True)
    spent = time.process_time() - started
    print(f"{pairs} pairs, {counts.total()} differences, {spent:.0f} CPU s: {dict(counts)}")
    return int(counts.total() > 0)


if __name__ == "__main__":
    sys.exit(main())
