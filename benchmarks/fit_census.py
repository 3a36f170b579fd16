"""Census of random assemblies that fit badly: a proof by forces or a proof by a motion for each.

    python benchmarks/fit_census.py               500 assemblies
    python benchmarks/fit_census.py 2000 500      2,000, from seed 500 on

The contacts have errors of 1e-9 to 1e-3, and the masses differ by up to a million. The command
prints the number of proofs of each kind by the number of solver runs, the CPU time [s], and the
seeds without a proof. The exit code is 1 if a proof is missing.
"""

from __future__ import annotations

import argparse
import collections
import sys
import time
from pathlib import Path

from kilter.analysis.decision.judge import judge

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from random_fits import random_fit

KINDS = {True: "forces", False: "motion", None: "no proof"}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("count", type=int, nargs="?", default=500)
    parser.add_argument("first", type=int, nargs="?", default=0)
    options = parser.parse_args()
    answers: collections.Counter[tuple[str, int]] = collections.Counter()
    without: list[int] = []
    seconds = 0.0
    for seed in range(options.first, options.first + options.count):
        program = random_fit(seed)
        started = time.process_time()
        judgement = judge(program)
        seconds += time.process_time() - started
        answers[KINDS[judgement.stable], len(judgement.solvers)] += 1
        if judgement.stable is None:
            without.append(seed)
    for (kind, runs), count in sorted(answers.items()):
        print(f"{kind:<9} after {runs} solver runs {count:6d}")
    print(f"{seconds:.1f} s; without a proof: {without or 'none'}")
    return 1 if without else 0


if __name__ == "__main__":
    sys.exit(main())
