"""Random assemblies with friction: is there ever a proof and a witness for the same one?

    python benchmarks/friction_census.py             200 assemblies, 1 second each at most
    python benchmarks/friction_census.py 2000 0.5    2,000, half a second each at most
    python benchmarks/friction_census.py 2000 0.5 7  the same, from seed 7 on

Each is judged; then the other side is asked too: of what is proved, a motion is looked for and
the seat; of what is refuted, a proof is tried. Prints the count of every kind, and what
contradicts itself, which must be nothing.
"""

from __future__ import annotations

import collections
import sys

from kilter import check
from kilter.friction.exclusion import prove_no_motion
from kilter.friction.motion_search import find_coulomb_motion
from kilter.friction.seating import find_seating
from kilter.scenes.random_friction import random_assembly


def asked(seed: int, effort: float) -> tuple[str, str, list[str]]:
    """Family, answer and contradictions of one random assembly."""
    family, assembly = random_assembly(seed)
    verdict = check(assembly, effort=effort)
    wrong = []
    answer = verdict.verdict
    if verdict.friction is not None:
        answer += f", {verdict.guarantee}"
        if verdict.verdict == "stable":
            if not find_seating(verdict.program).holds:
                wrong.append("proved but not seated")
            found = find_coulomb_motion(verdict.program, work=effort, seed=1)
            if found is not None:
                wrong.append("proved, and a motion obeys the law")
        else:
            answer += ", seated" if verdict.seated else ", not seated"
        if verdict.guarantee == "refuted":
            law = verdict.friction.witness.law
            if not law.holds:
                wrong.append("a witness that breaks the law")
            if prove_no_motion(verdict.program, work=effort / 2).proved:
                wrong.append("a witness, and a proof")
    return family, answer, wrong


def main() -> int:
    """Ask them all; 1 where something contradicts itself."""
    words = sys.argv[1:]
    count = int(words[0]) if words else 200
    effort = float(words[1]) if len(words) > 1 else 1.0
    first = int(words[2]) if len(words) > 2 else 0
    answers: collections.Counter[str] = collections.Counter()
    contradictions = []
    for seed in range(first, first + count):
        family, answer, wrong = asked(seed, effort)
        answers[answer] += 1
        contradictions += [f"seed {seed} ({family}): {word}" for word in wrong]
    for answer, number in sorted(answers.items()):
        print(f"{number:>6}  {answer}")
    print(f"{len(contradictions)} contradictions")
    print("\n".join(contradictions))
    return int(bool(contradictions))


if __name__ == "__main__":
    sys.exit(main())
