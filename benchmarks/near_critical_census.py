"""Walls and arches beside their limits: which side kilter's own interior point proves, if any.

    python benchmarks/near_critical_census.py                200 assemblies, 10 tilts each
    python benchmarks/near_critical_census.py 1000 --seed 2

Gravity is turned to shares 1 - d and 1 + d of the tangent at which an assembly's forces end, as
`find_limit` proves it from both sides; d from 1e-2 to 1e-6. A row counts what its proofs say:
right, wrong (there must be none), and none, where HiGHS and Clarabel decide; `both`, where the
mechanism of the limit is a proof as well: a certificate allows 1e-9 of the forces. `steps` is the
mean, `judged` counts the verdicts of `judge`, which asks them, that are right.
"""

from __future__ import annotations

import argparse
from collections import Counter
from typing import Any

import numpy as np

BESIDE = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)


def near_critical(rng: np.random.Generator) -> Any:
    """A random wall or arch with friction."""
    from kilter.scenes import arches, walls

    friction = float(rng.uniform(0.2, 0.9))
    if rng.random() < 0.5:
        courses, bricks = (int(k) for k in rng.integers(2, 9, 2))
        return walls.wall(courses, bricks, friction=friction)
    return arches.arch(int(rng.integers(5, 40)), friction=friction, planar=False)


def own(program: Any) -> tuple[bool | None, int]:
    """What a proof of kilter's own interior point says, and its steps."""
    from kilter.mechanics.balance_in_cones import load_share
    from kilter.mechanics.certificate import check_forces, check_motion
    from kilter.solvers.cone_interior_point import iterates

    balance, steps = load_share(program), 0
    for step in iterates(balance.cones):
        steps = step.number
        x, y = step.balanced(), step.against()
        if x is not None and check_forces(program, *balance.decoded(x / step.share)).holds:
            return True, steps
        if y is not None and check_motion(program, balance.motion(-y)).holds:
            return False, steps
    return None, steps


def main() -> None:
    """Run the census."""
    from kilter.analysis.judge import judge
    from kilter.analysis.margins.load_limit import Limit, find_limit, gravity_wrench
    from kilter.contact import detect
    from kilter.mechanics.certificate import check_motion
    from kilter.mechanics.program import build_program

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("assemblies", nargs="?", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args()
    rng = np.random.default_rng(chosen.seed)
    found = {(beside, held): Counter() for beside in BESIDE for held in (True, False)}
    skipped = 0
    for _ in range(chosen.assemblies):
        assembly = near_critical(rng)
        angle = float(rng.uniform(0, 2 * np.pi))
        program = build_program(assembly, detect.contacts(assembly))
        aside = np.array([np.cos(angle), np.sin(angle), 0.0])
        limit = find_limit(program, gravity_wrench(program, aside))
        if not isinstance(limit, Limit) or not np.isfinite(limit.gap) or limit.value <= 0:
            skipped += 1
            continue
        for (beside, held), row in found.items():
            share = limit.value * (1 - beside if held else 1 + beside)
            if not held and beside * limit.value <= limit.gap * max(1.0, limit.value):
                row["unknown"] += 1  # which side that is, nothing has proved
                continue
            turned = program.turned(program.down + share * aside)
            says, steps = own(turned)
            word = "none" if says is None else "right" if says is held else "WRONG"
            if word == "WRONG" and not held and check_motion(turned, limit.mechanism.motion).holds:
                word = "both"
            row[word] += 1
            row["steps"] += steps
            row["judged"] += judge(turned).stable is held
    columns = ("right", "none", "both", "WRONG", "judged", "unknown")
    print(f"{'beside':>9} {'side':>6}", *(f"{name:>8}" for name in columns), f"{'steps':>6}")
    for (beside, held), row in found.items():
        tried = sum(row[name] for name in ("right", "none", "both", "WRONG"))
        counts = (f"{row[name]:>8}" for name in columns)
        side = "below" if held else "above"
        print(f"{beside:>9.0e} {side:>6}", *counts, f"{row['steps'] / max(tried, 1):>6.1f}")
    print(f"{skipped} assemblies without a limit")


if __name__ == "__main__":
    main()
