"""Many small assemblies: verdicts a second of `check_many`, each compared with that of `check`.

    python benchmarks/many.py                        10,000 of 5 to 20 boxes, without friction
    python benchmarks/many.py 1000 --compare 1000    so many, and so many compared (default 200)
    python benchmarks/many.py 1000 --piles           boxes on a grid: edges and corners meet
    python benchmarks/many.py 1000 --piles --turned  each turned at random with its gravity

They are given as arrays and as assemblies. Every proof is rechecked, by the program of its own
assembly and apart from the solver; a verdict that differs, or a proof that does not hold, is
printed, and the command ends with 1. Seconds are of the processor, on one core.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np

FEWEST, MOST = 5, 20
KEPT = 2000
"""Proofs that are kept at a time and rechecked: all are, in turn."""
SIDE = 4
"""Cells of the floor: piles are high enough that many of those put down anywhere fall."""
SHIFT = 0.3
"""How far a box hangs over the one below, at most, of the width of that [-]."""


def boxes(seed: int) -> Any:
    """Boxes of any sizes, each on the floor or somewhere on one of those before."""
    from kilter.assembly import Assembly, Part
    from kilter.rigid import Pose
    from kilter.shape.primitives import Box

    random = np.random.default_rng(seed)
    count = int(random.integers(FEWEST, MOST + 1))
    sizes, middles = random.uniform(0.5, 2.0, (count, 3)), np.zeros((count, 3))
    for k in range(count):
        middles[k, :2] = random.uniform(-8.0, 8.0, 2)
        if k and random.random() < 0.5:
            below = int(random.integers(k))
            shift = random.uniform(-SHIFT, SHIFT, 2)
            middles[k, :2] = middles[below, :2] + shift * sizes[below, :2]
        apart = np.abs(middles[:k, :2] - middles[k, :2])
        under = (apart < (sizes[:k, :2] + sizes[k, :2]) / 2).all(axis=1)
        tops = (middles[:k, 2] + sizes[:k, 2] / 2)[under]
        middles[k, 2] = tops.max(initial=0.0) + sizes[k, 2] / 2
    free = [Part(f"box-{k}", Box(sizes[k]), Pose(middles[k])) for k in range(count)]
    return Assembly([Part("floor", Box([40, 40, 1]), Pose([0, 0, -0.5]), grounded=True), *free])


def pile(seed: int) -> Any:
    """A pile of boxes on a grid, every second one put down on level ground only."""
    from kilter.scenes.packings import box_pile

    count = int(np.random.default_rng(seed).integers(FEWEST, MOST + 1))
    return box_pile(count, seed=seed, cells=SIDE, level=bool(seed % 2))


def turned(assembly: Any, seed: int) -> Any:
    """The assembly turned at random, gravity too."""
    from kilter.assembly import Assembly
    from kilter.rigid import Pose

    turn = Pose((0, 0, 0), np.random.default_rng(seed).normal(size=4))
    parts = [
        dataclasses.replace(part, pose=Pose(turn.apply([part.pose.position])[0], turn.rotation))
        for part in assembly.parts
    ]
    return Assembly(parts, gravity=turn.apply([assembly.gravity])[0])


def as_arrays(piles: list[Any]) -> Any:
    """The same as arrays of meshes."""
    from kilter import AssemblyArrays
    from kilter.arrays import starts
    from kilter.shape.primitives import surface

    parts = [part for one in piles for part in one.parts]
    surfaces = [surface(part.shape) for part in parts]
    first = starts([len(vertices) for vertices, _ in surfaces])
    return AssemblyArrays(
        np.concatenate([part.pose.apply(v) for part, (v, _) in zip(parts, surfaces, strict=True)]),
        np.concatenate([faces + k for (_, faces), k in zip(surfaces, first[:-1], strict=True)]),
        first,
        starts([len(faces) for _, faces in surfaces]),
        starts([len(one) for one in piles]),
        [part.grounded for part in parts],
        gravity=np.array([one.gravity for one in piles]),
    )


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    """The result, and seconds of the processor."""
    started = time.process_time()
    return work(), time.process_time() - started


def broken(found: Any) -> list[int]:
    """Verdicts whose proof, judged anew, does not hold."""
    wrong = []
    for k, word in enumerate(found.verdict.tolist()):
        kept = found.certificate(k)
        if word in ("undecided", "error"):
            continue
        if kept is None or not kept[1].holds:
            wrong.append(k)
    return wrong


def measured(name: str, given: Any, words: list[str]) -> int:
    """Print rate, proofs that do not hold, verdicts that differ; how many of the last two."""
    import kilter

    found, seconds = timed(lambda: kilter.check_many(given))
    print(f"{name:12} {len(found) / seconds:8,.0f} a second  {found!r}", flush=True)
    bad = []
    for first in range(0, len(found), KEPT):
        some = np.arange(first, min(first + KEPT, len(found)))
        few = given.among(some) if name == "arrays" else given[first : first + KEPT]
        bad += [first + k for k in broken(kilter.check_many(few, proofs=True))]
    print(f"{'':12} {len(found)} proofs rechecked, {len(bad)} do not hold {bad[:10]}", flush=True)
    other = np.flatnonzero(found.verdict[: len(words)] != np.array(words, dtype=str)).tolist()
    print(f"{'':12} {len(words)} compared with check, {len(other)} differ {other[:10]}", flush=True)
    return len(bad) + len(other)


def main() -> int:
    """Measure, compare, recheck."""
    import kilter

    parser = argparse.ArgumentParser()
    parser.add_argument("count", type=int, nargs="?", default=10_000)
    parser.add_argument("--compare", type=int, default=200)
    parser.add_argument("--piles", action="store_true")
    parser.add_argument("--turned", action="store_true")
    asked = parser.parse_args()
    piles = [(pile if asked.piles else boxes)(seed) for seed in range(asked.count)]
    if asked.turned:
        piles = [turned(one, seed) for seed, one in enumerate(piles)]
    arrays = as_arrays(piles)
    kilter.check_many(arrays.among(np.arange(min(50, len(arrays)))))  # imports
    words, seconds = timed(lambda: [kilter.check(one).verdict for one in piles[: asked.compare]])
    rate = len(words) / max(seconds, 1e-9)
    print(f"{'check':12} {rate:8,.0f} a second  {len(words)} of {len(piles)}", flush=True)
    given = {"arrays": arrays, "assemblies": piles}
    wrong = [measured(name, one, words) for name, one in given.items()]
    return 1 if any(wrong) else 0


if __name__ == "__main__":
    sys.exit(main())
