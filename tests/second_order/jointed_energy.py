"""Random linkages, rolling chains and round parts against the energy along their exact motions.

    python tests/second_order/jointed_energy.py              400 cases, counted by result
    python tests/second_order/jointed_energy.py 40 --first 7

The motions are closed by Newton's method on the exact joints, or rolled by equal arcs, or minimised
over exact gaps (`round_energy`). The command ends with 1 if a verdict of `check` is wrong, if its
proof does not hold, or if more than 5 % of the cases are open.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter

from random_linkages import random_linkage
from random_rolling import random_chain
from round_energy import RADII, compared

import kilter
from kilter import Assembly, Verdict
from kilter.arrays import Array

FLAT = 1e-5
"""Largest second derivative that counts as 0, over the largest or 1 [-]."""
MOST_OPEN = 0.05
"""Largest share of open cases [-]."""


def expected(curvatures: Array) -> str:
    """State by the exact second derivatives: balanced, free or minimum."""
    size = FLAT * max(1.0, float(abs(curvatures).max(initial=0.0)))
    if (curvatures < -size).any():
        return "balanced"
    return "free" if (curvatures < size).any() else "minimum"


def verified(assembly: Assembly) -> Verdict:
    verdict = kilter.check(assembly)
    assert kilter.verify(assembly, verdict.proof()).holds
    return verdict


def linkage(seed: int) -> str:
    """Result for a linkage: right, open or wrong."""
    made = random_linkage(seed)
    curvatures = made.curvatures()
    verdict = verified(made.assembly)
    found, wanted = verdict.second_order, expected(curvatures)
    if found is None:
        return "right" if not len(curvatures) else "wrong"
    word = "balanced" if wanted == "balanced" else "stable"
    if found.state == "open":
        return "open" if verdict.verdict in (word, "potentially-stable") else "wrong"
    return "right" if (found.state, verdict.verdict) == (wanted, word) else "wrong"


def chain(seed: int) -> str:
    """Result for a rolling chain with friction: right, open or wrong."""
    made = random_chain(seed)
    verdict, wanted = verified(made.assembly), expected(made.curvatures())
    if wanted == "balanced":
        return "right" if verdict.verdict in ("balanced", "potentially-stable") else "wrong"
    if verdict.verdict == "stable":
        return "right"
    rolling = verdict.second_order.rolling if verdict.second_order is not None else None
    return "wrong" if rolling is not None and rolling.state == "falls" else "open"


def rounds(seed: int) -> str:
    """Result for a round part in bowls, grooves and on balls: right or open, or an error."""
    return "open" if compared(seed, RADII[1:2]) == "open" else "right"


FAMILIES = {"linkages": linkage, "rolling chains": chain, "round parts": rounds}


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", type=int, nargs="?", default=400)
    parser.add_argument("--first", type=int, default=0)
    options = parser.parse_args(arguments)
    total: Counter[str] = Counter()
    shares = {"linkages": 0.4, "rolling chains": 0.4, "round parts": 0.2}
    for name, share in shares.items():
        seeds = range(options.first, options.first + round(share * options.count))
        results = {seed: FAMILIES[name](seed) for seed in seeds}
        counts = Counter(results.values())
        wrong = [seed for seed, result in results.items() if result == "wrong"]
        sys.stdout.write(f"{name}: {dict(counts)}{f', wrong: {wrong}' if wrong else ''}\n")
        sys.stdout.flush()
        total += counts
    sys.stdout.write(f"all: {dict(total)}\n")
    return int(total["wrong"] > 0 or total["open"] > MOST_OPEN * options.count)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
