"""Census of walls and arches near their limits: which side each solver proves on its own.

    python benchmarks/near_critical_census.py                        200 assemblies, 10 tilts each
    python benchmarks/near_critical_census.py 1000 --seed 2
    python benchmarks/near_critical_census.py --solvers kilter       only this solver

`find_limit` proves the tangent of the tilt at the limit from both sides. Gravity is tilted by
1 - d and 1 + d of it, d from 1e-2 to 1e-6. A row counts the proofs of a solver: right, WRONG (the
exit code is then 1) and none, after which `judge` tries the next solver. `both` counts cases in
which the mechanism of the limit is a proof, too, because certificates tolerate 1e-9 of the forces.
The rows `judge` use all solvers in turn. `ms` is the mean CPU time.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections import Counter
from collections.abc import Iterator
from typing import Any

for _pool in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_pool] = "1"  # before numpy, because CPU time counts all threads

import numpy as np  # noqa: E402

BESIDE = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
WORDS = ("right", "none", "both", "WRONG")


def near_critical(rng: np.random.Generator) -> Any:
    """A random wall or arch with friction."""
    from kilter.scenes import arches, walls

    friction = float(rng.uniform(0.2, 0.9))
    if rng.random() < 0.5:
        courses, bricks = (int(k) for k in rng.integers(2, 9, 2))
        return walls.wall(courses, bricks, friction=friction)
    return arches.arch(int(rng.integers(5, 40)), friction=friction, planar=False)


def programs(assembly: Any, angle: float) -> Iterator[tuple[float, bool, Any, bool]]:
    """Yield relative distance from the limit, side, program, and whether a mechanism exists."""
    from kilter.analysis.load_limit import Limit, find_limit, gravity_wrench
    from kilter.contact import detect
    from kilter.mechanics.certificate import check_motion
    from kilter.mechanics.program import build_program

    program = build_program(assembly, detect.contacts(assembly))
    aside = np.array([np.cos(angle), np.sin(angle), 0.0])
    limit = find_limit(program, gravity_wrench(program, aside))
    if not isinstance(limit, Limit) or not np.isfinite(limit.gap) or limit.value <= 0:
        return
    for beside in BESIDE:
        for held in (True, False):
            if not held and beside * limit.value <= limit.gap * max(1.0, limit.value):
                continue  # within the gap between the proved bounds, the side is unknown
            share = limit.value * (1 - beside if held else 1 + beside)
            turned = program.turned(program.down + share * aside)
            falls = not held and check_motion(turned, limit.motion.motion).holds
            yield beside, held, turned, falls


def main() -> int:
    """Run the census; return 1 if a proof is wrong."""
    from kilter.analysis.decision.judge import SOLVERS, judge

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("assemblies", nargs="?", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--solvers", nargs="*", choices=SOLVERS, default=SOLVERS)
    chosen = parser.parse_args()
    rng = np.random.default_rng(chosen.seed)
    found: dict[Any, Counter[str]] = {}
    seconds: Counter[Any] = Counter()
    skipped = 0
    for _ in range(chosen.assemblies):
        asked = list(programs(near_critical(rng), float(rng.uniform(0, 2 * np.pi))))
        skipped += not asked
        for beside, held, program, falls in asked:
            for solver in (*chosen.solvers, None):
                started = time.process_time()
                says = judge(program, solver=solver).stable
                key = (solver or "judge", beside, held)
                seconds[key] += time.process_time() - started
                word = "none" if says is None else "right" if says is held else "WRONG"
                word = "both" if word == "WRONG" and falls else word
                found.setdefault(key, Counter())[word] += 1
    print(f"{'solver':9} {'beside':>8} {'side':>6}", *(f"{word:>7}" for word in (*WORDS, "ms")))
    for key in sorted(found, key=lambda k: (k[0], -k[1], k[2])):
        who, beside, held = key
        counts = (f"{found[key][word]:>7}" for word in WORDS)
        each = 1000 * seconds[key] / found[key].total()
        side = "below" if held else "above"
        print(f"{who:9} {beside:>8.0e} {side:>6}", *counts, f"{each:>7.1f}")
    asked = sum(one.total() for (who, *_), one in found.items() if who == "judge")
    wrong = sum(one["WRONG"] for one in found.values())
    print(f"{asked} programs, {wrong} wrong proofs, {skipped} assemblies without a limit")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
