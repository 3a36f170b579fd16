"""Census of random assemblies with friction: levels, times and contradictions.

    python benchmarks/friction_census.py                200 assemblies at the default effort
    python benchmarks/friction_census.py 884 1          884 assemblies at effort 1
    python benchmarks/friction_census.py 2000 0.5 7     2,000 at effort 0.5, from seed 7 on
    python benchmarks/friction_census.py 884 -o FILE    append each answer to a file as a line of
                                                        JSON; answers in the file are kept

After each verdict the opposite is tried, too. For a proof, a motion is searched with other
lubricated patches. For a motion, a proof is tried. The command prints a table of levels and a
table of answers with times [CPU s], and the contradictions; the exit code is 1 if there are any:

    proved, and a motion obeys the law          a witness that breaks the law
    a witness, and a proof                      refuted, and a level above equilibrium
"""

from __future__ import annotations

import argparse
import collections
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

from kilter import Verdict, check
from kilter.friction.exclusion import prove_no_motion
from kilter.friction.motion_search import find_coulomb_motion

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from random_friction import random_assembly


def contradictions(verdict: Verdict, effort: float) -> list[str]:
    """Contradictions of a verdict that depends on friction."""
    wrong = []
    if verdict.verdict == "stable" and find_coulomb_motion(verdict.program, work=effort, seed=1):
        wrong.append("proved, and a motion obeys the law")
    if verdict.guarantee == "refuted":
        if verdict.level != "equilibrium":
            wrong.append("refuted, and a level above equilibrium")
        if not verdict.friction_answer.witness.law.holds:
            wrong.append("a witness that breaks the law")
        if prove_no_motion(verdict.program, work=effort / 2).proved:
            wrong.append("a witness, and a proof")
    return wrong


def asked(seed: int, effort: float) -> dict[str, Any]:
    """Family, level, answer, CPU seconds and contradictions of a random assembly."""
    family, assembly = random_assembly(seed)
    started = time.process_time()
    verdict = check(assembly, effort=effort)
    seconds = time.process_time() - started
    level = f"{verdict.level or 'none':<11} {verdict.verdict}"
    one = {"seed": seed, "family": family, "level": level, "seconds": seconds}
    if verdict.friction_answer is None:
        return one | {"answer": verdict.verdict, "wrong": []}
    passed, of = verdict.tries.passed, verdict.tries.of
    tries = "all" if passed == of else "some" if passed else "no"
    answer = f"{verdict.verdict:<19} {verdict.why or verdict.guarantee:<10}"
    answer += f" seat {verdict.seated:<10} {tries} tries passed"
    return one | {"answer": answer, "wrong": contradictions(verdict, effort)}


def known(file: Path | None) -> dict[int, dict[str, Any]]:
    """The answers in a file, by seed."""
    if file is None or not file.exists():
        return {}
    return {one["seed"]: one for one in map(json.loads, file.read_text().splitlines())}


def table(found: list[dict[str, Any]], by: str) -> None:
    """Print counts and times by level or by answer."""
    times = collections.defaultdict(list)
    for one in found:
        times[one[by]].append(one["seconds"])
    print(f"{'count':>6} {'mean':>7} {'median':>7} {'worst':>7}  {by}")
    for what, own in sorted(times.items()):
        mean, median, worst = np.mean(own), np.median(own), max(own)
        print(f"{len(own):>6} {mean:>7.2f} {median:>7.2f} {worst:>7.2f}  {what}")
    print()


def odd(one: dict[str, Any]) -> bool:
    """Whether tries and answer do not match: tries pass for a motion, or fail for a proof."""
    answer = one["answer"]
    refuted = answer.startswith("potentially-stable  refuted")
    return ("some tries" in answer and (refuted or answer.startswith("stable"))) or (
        "all tries" in answer and refuted
    )


def main() -> int:
    """Run the census; return 1 if there is a contradiction."""
    reader = argparse.ArgumentParser()
    reader.add_argument("count", type=int, nargs="?", default=200)
    reader.add_argument("effort", type=float, nargs="?", default=1.0)
    reader.add_argument("first", type=int, nargs="?", default=0)
    reader.add_argument("-o", dest="file", type=Path)
    words = reader.parse_args()
    before, found = known(words.file), []
    for seed in range(words.first, words.first + words.count):
        one = before.get(seed) or asked(seed, words.effort)
        found.append(one)
        if words.file is not None and seed not in before:
            with words.file.open("a") as out:
                out.write(json.dumps(one) + "\n")
    table(found, "level")
    table(found, "answer")
    look = [f"seed {one['seed']} ({one['family']}): {one['answer']}" for one in found if odd(one)]
    print("\n".join([f"{len(look)} worth a look", *look, ""]))
    wrong = [f"seed {one['seed']}: {word}" for one in found for word in one["wrong"]]
    print("\n".join([f"{len(wrong)} contradictions", *wrong]))
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
