"""Census of straps: compares the needed share of their strength with an independent program.

    python benchmarks/straps_census.py          200 random lashed loads
    python benchmarks/straps_census.py 20 --first 500
    python benchmarks/straps_census.py --direct   straps with a capacity (direct lashing)
    python benchmarks/straps_census.py --loops    also around corners of several boxes

Each load is a row or a stack of boxes under one to three straps with friction at their corners, in
an inclined gravity (`tests/scenes/lashings.py`). With `--direct` or `--loops`, up to eight straps
with a capacity hold them, and tensioned straps in some loads. `find_bond_factor` computes the least
common share of the tension and capacity of all straps. A linear program written for this comparison
(`lashings.py`) gives a bound on each side: friction in pyramids inside and around Coulomb's
cones. `kilter.check` must hold with `NEAR` more of the tension than the share and must not hold
with `NEAR` less. Exit code 1 if there is a contradiction.
"""

from __future__ import annotations

import argparse
import collections
import dataclasses
import math
import os
import sys
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from lashings import least_share, random_direct, random_lashing

import kilter
from kilter.analysis.decision.bond_factor import BondFactor, find_bond_factor
from kilter.contact import contacts
from kilter.mechanics.program import build_program

__all__ = ["judge_lashing"]

NEAR = 1e-3
"""Distance of the tensions of `check` from the share, relative to the larger of it and 0.01."""
AGREES = 1e-6
"""Rounding by which a share may lie outside the bounds of the other program [-]."""


def judge_lashing(assembly: kilter.Assembly) -> tuple[str, list[str]]:
    """Kind of a lashed load ("none", "no strap", "share", "failed"), and its contradictions."""
    if not assembly.straps:
        return "without straps", []
    touching = contacts(assembly)
    inside = least_share(assembly, around=False)
    around = least_share(assembly, around=True)
    factor = find_bond_factor(build_program(assembly, touching), touching)
    if not isinstance(factor, BondFactor):
        wrong = [] if math.isinf(inside) else [f"no share, but the program has {inside:.9g}"]
        return ("none" if factor.why == "none" else "failed"), wrong
    value, wrong = factor.value, []
    rounding = AGREES * max(1.0, abs(value))
    if value > inside + rounding or value < around - rounding:
        wrong.append(f"share {value:.9g} is not between {around:.9g} and {inside:.9g}")
    step = NEAR * max(value, 0.01)
    for share, holds in ((value + step, True), (value - step, False)):
        if share > 0:
            straps = [strap.with_strength(share) for strap in assembly.straps]
            other = dataclasses.replace(assembly, straps=straps)
            verdict = kilter.check(other, require="equilibrium")
            if (verdict.level is not None) != holds:
                wrong.append(f"check at share {share:.9g}: level {verdict.level}")
            elif not kilter.verify(other, verdict.proof()).holds:
                wrong.append(f"the proof at share {share:.9g} does not hold")
    return "share" if value else "no strap", wrong


def main() -> int:
    """Compare all loads; 1 if there is a contradiction."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", type=int, nargs="?", default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--direct", action="store_true", help="straps with a capacity")
    parser.add_argument("--loops", action="store_true", help="and around several corners")
    given = parser.parse_args()
    kinds: collections.Counter[str] = collections.Counter()
    contradictions = 0
    started = time.process_time()
    for seed in range(given.first, given.first + given.count):
        direct = given.direct or given.loops
        load = random_direct(seed, loops=given.loops) if direct else random_lashing(seed)
        kind, wrong = judge_lashing(load)
        kinds[kind] += 1
        contradictions += len(wrong)
        for reason in wrong:
            print(f"seed {seed}: {reason}")
    words = ", ".join(f"{kind} {count}" for kind, count in sorted(kinds.items()))
    print(f"{given.count} loads ({words}): {contradictions} contradictions, "
          f"{time.process_time() - started:.1f} CPU s")  # fmt: skip
    return int(contradictions > 0)


if __name__ == "__main__":
    sys.exit(main())
