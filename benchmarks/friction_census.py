"""Random assemblies with friction: levels, times, and whether anything contradicts itself.

    python benchmarks/friction_census.py                200 assemblies at the usual effort
    python benchmarks/friction_census.py 884 1          as many, at an effort
    python benchmarks/friction_census.py 2000 0.5 7     the same, from seed 7 on

Each is judged; then the other side is asked too: of what is proved, a motion is looked for with
other lubricated patches; of what is refuted, a proof is tried. Prints a table of levels with
times [s], and what contradicts itself, which must be nothing:

    proved, and a motion obeys the law          a witness that breaks the law
    a witness, and a proof                      refuted, and a level above equilibrium
"""

from __future__ import annotations

import collections
import sys
import time

import numpy as np

from kilter import check
from kilter.friction.exclusion import prove_no_motion
from kilter.friction.motion_search import find_coulomb_motion
from kilter.scenes.random_friction import random_assembly


def contradictions(verdict: object, effort: float) -> list[str]:
    """What speaks against a verdict that rests on friction."""
    wrong = []
    if verdict.verdict == "stable" and find_coulomb_motion(verdict.program, work=effort, seed=1):
        wrong.append("proved, and a motion obeys the law")
    if verdict.guarantee == "refuted":
        if verdict.level != "equilibrium":
            wrong.append("refuted, and a level above equilibrium")
        if not verdict.friction.witness.law.holds:
            wrong.append("a witness that breaks the law")
        if prove_no_motion(verdict.program, work=effort / 2).proved:
            wrong.append("a witness, and a proof")
    return wrong


def asked(seed: int, effort: float) -> tuple[str, str, float, list[str]]:
    """Family, answer, seconds and contradictions of one random assembly."""
    family, assembly = random_assembly(seed)
    started = time.process_time()
    verdict = check(assembly, effort=effort)
    seconds = time.process_time() - started
    if verdict.friction is None:
        return family, verdict.verdict, seconds, []
    passed, of = verdict.tries
    tries = "all" if passed == of else "some" if passed else "no"
    answer = f"{verdict.verdict:<19} {verdict.why or verdict.guarantee:<10}"
    answer += f" seat {verdict.seated:<10} {tries} tries passed"
    return family, answer, seconds, contradictions(verdict, effort)


def main() -> int:
    """Ask them all; 1 where something contradicts itself."""
    words = sys.argv[1:]
    count = int(words[0]) if words else 200
    effort = float(words[1]) if len(words) > 1 else 1.0
    first = int(words[2]) if len(words) > 2 else 0
    times: dict[str, list[float]] = collections.defaultdict(list)
    odd, wrong = [], []
    for seed in range(first, first + count):
        family, answer, seconds, more = asked(seed, effort)
        times[answer].append(seconds)
        wrong += [f"seed {seed} ({family}): {word}" for word in more]
        if answer.startswith(("stable", "potentially-stable refuted")) and "some" in answer:
            odd.append(f"seed {seed} ({family}): {answer}")
        if answer.startswith("potentially-stable  refuted") and "all" in answer:
            odd.append(f"seed {seed} ({family}): {answer}")
    print(f"{'count':>6} {'mean':>7} {'worst':>7}  answer")
    for answer, own in sorted(times.items()):
        print(f"{len(own):>6} {np.mean(own):>7.2f} {max(own):>7.2f}  {answer}")
    print("\n".join(["", f"{len(odd)} worth a look", *odd]))
    print("\n".join(["", f"{len(wrong)} contradictions", *wrong]))
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
