"""Census of motions with friction: does each motion that `check` shows obey Coulomb's law?

    python benchmarks/motion_census.py              300 unstable assemblies
    python benchmarks/motion_census.py 90 300       90 assemblies, from seed 300 on

The assemblies are arches, stacks on slopes and leaning walls beyond their limit: a third of them by
1e-4 to 1e-3, the others by up to 0.3 (`tests/scenes/beyond_limits.py`). A motion *obeys* if forces
at its closed contacts, inside Coulomb's cones and opposite to sliding, give mass times acceleration
(`tests/friction/coulomb_oracle.py`). The exit code is 1 if a motion does not, or if more than 2 %
of the answers say that no motion was found.
"""

from __future__ import annotations

import argparse
import collections
import os
import sys
import time
from pathlib import Path

for _pool in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_pool] = "1"  # before numpy, because CPU time counts all threads

import numpy as np  # noqa: E402

TESTS = Path(__file__).resolve().parents[1] / "tests"
sys.path += [str(TESTS / "scenes"), str(TESTS / "friction")]

from beyond_limits import NEAR, beyond_limit  # noqa: E402
from coulomb_oracle import explained  # noqa: E402

from kilter import check  # noqa: E402

OBEYS, NONE, WRONG = "obeys the law", "none found", "breaks the law"
MOST_NONE = 0.02
"""Largest share of answers without a motion."""


def main() -> int:
    """Run the census; return 1 if a motion breaks the law, or if too few are found."""
    reader = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    reader.add_argument("count", type=int, nargs="?", default=300)
    reader.add_argument("first", type=int, nargs="?", default=0)
    words = reader.parse_args()
    counts: collections.Counter[tuple[str, bool, str]] = collections.Counter()
    seconds = []
    for seed in range(words.first, words.first + words.count):
        case = beyond_limit(seed)
        verdict = check(case.assembly)
        if verdict.verdict != "unstable":
            print(f"seed {seed}: {case.family}, {case.distance:.1e} beyond: {verdict.verdict}")
        started = time.process_time()
        motion = verdict.motion
        seconds.append(time.process_time() - started)
        found = NONE
        if motion.known:
            judged = explained(verdict.modelled, motion.acceleration)
            found = OBEYS if judged.obeys else WRONG
            if not judged.obeys:
                print(f"seed {seed}: {case.family}, {case.distance:.1e} beyond: {judged}")
        counts[case.family, case.distance < NEAR[1], found] += 1
    print(f"{'family':<8} {'beyond':<8}", *(f"{word:>15}" for word in (OBEYS, NONE, WRONG)))
    for family, near in sorted({key[:2] for key in counts}):
        row = (f"{counts[family, near, word]:>15}" for word in (OBEYS, NONE, WRONG))
        print(f"{family:<8} {'near' if near else 'far':<8}", *row)
    of = {word: sum(n for key, n in counts.items() if key[2] == word) for word in (NONE, WRONG)}
    print(f"{words.count} assemblies, {of[WRONG]} wrong motions, {of[NONE]} without a motion")
    middle, worst = np.median(seconds), max(seconds)
    print(f"CPU time of a motion: median {middle:.2f} s, worst {worst:.2f} s")
    return int(of[WRONG] > 0 or of[NONE] > MOST_NONE * words.count)


if __name__ == "__main__":
    sys.exit(main())
