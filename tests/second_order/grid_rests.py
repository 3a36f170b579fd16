"""Parts on a grid: the state is independent of order and place, and agrees with a descent.

    python tests/second_order/grid_rests.py               200 assemblies, counted by state
    python tests/second_order/grid_rests.py 50 --first 1000 --boxes --seconds 30

For each assembly that is stable to first order the parts are listed backwards, and the whole is
turned, moved and scaled: decided states and their counts stay the same. Each proof is verified. A
descent of the energy (`rest_energy.py`) finds no place below a minimum or a free state. States that
are decided in only one order are counted and printed. The command ends with 1 if a rule is broken,
or if a check takes longer than `--seconds` of CPU.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter

from random_grids import elsewhere, random_grid
from rest_energy import contradicts, told

import kilter
from kilter import Assembly

Key = tuple[str, int, int]


def key_of(verdict: kilter.Verdict) -> Key:
    """State and counts; counts are 0 if no motion is neutral."""
    second = verdict.second_order
    if second is None:
        return (str(verdict.verdict), 0, 0)
    return (second.state, second.neutral, 0 if second.state == "balanced" else second.free)


def differs(one: Key, other: Key) -> str:
    """The contradiction between two answers, and the state that only one of them decides."""
    if one == other:
        return ""
    opens = "open" in (one[0], other[0])
    return "decided in one order alone" if opens else f"{one} is {other} elsewhere"


def looked_at(assembly: Assembly, seed: int) -> tuple[Key, list[str], list[str]]:
    """State and counts of an assembly, contradictions to them, and states that are left open."""
    verdict = kilter.check(assembly)
    key = key_of(verdict)
    if verdict.first_order != "stable":
        return key, [], []
    wrong, opens = [], []
    for other in (Assembly(assembly.parts[::-1]), elsewhere(assembly)):
        there = kilter.check(other)
        word = differs(key, key_of(there))
        (opens if word.startswith("decided") else wrong).extend([word] if word else [])
        wrong += kilter.verify(other, there.proof()).reasons
    second = verdict.second_order
    wrong += kilter.verify(assembly, verdict.proof()).reasons
    if second is not None and second.state == "open":
        opens.append(f"open, {second.why}")
    elif second is not None:
        against, _ = contradicts(assembly, second, seed)
        wrong += [against] if against else []
    return key, wrong, opens


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("count", type=int, nargs="?", default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--boxes", action="store_true", help="of boxes alone")
    parser.add_argument("--seconds", type=float, default=10.0)
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    wrongs, longest = 0, 0.0
    for seed in range(given.first, given.first + given.count):
        assembly = random_grid(seed, boxes=given.boxes)
        begun = time.process_time()
        kilter.check(assembly)
        took = time.process_time() - begun
        longest = max(longest, took)
        key, wrong, opens = looked_at(assembly, seed)
        wrong += [f"{took:.1f} s"] if took > given.seconds else []
        counts[key[0]] += 1
        for word in opens:
            told(f"{seed}: {word}")
        for word in wrong:
            told(f"{seed}: {key}, but {word}")
        wrongs += len(wrong)
    told(", ".join(f"{number} {state}" for state, number in sorted(counts.items())))
    told(f"longest check {longest:.2f} s of CPU, {wrongs} contradictions")
    return 1 if wrongs else 0


if __name__ == "__main__":
    sys.exit(main())
