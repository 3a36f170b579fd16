"""Census of load factors and pushes: compares `margin` with bisection of the verdict.

    python benchmarks/limit_census.py arch 40 -o limits.jsonl     seeds 0 to 39
    python benchmarks/limit_census.py bonded 40                   of `tests/scenes/random_bonded.py`

The assemblies are those of `region_census`, or "bonded". For each assembly that holds as given,
the load factor of a body force in a random direction and the largest push on a random part are
bisected with `judge` to `NEAR`, independently of `margin`. Then `kilter.check` computes the
verdict at both ends of the interval, with the loads in the assembly. The least push that is
resisted in every direction is tested in random directions. For bonded assemblies, the least
friction and the least share of the bond strength are bisected, too, whether the assembly holds or
not.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from region_census import run

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

NEAR = 1e-6
"""Accuracy of bisection, relative to the larger of 1 and the limit [-]."""
LARGEST = 1e3
"""A limit above this share counts as unlimited [-]."""
AROUND = 10
"""Number of random directions in which the least push is tested."""


def answered(family: str, seed: int, directions: int) -> Any:
    """Yield the parts of a case's row."""
    import numpy as np

    import kilter
    from kilter.analysis.decision.judge import judge
    from kilter.analysis.load_limit import gravity_wrench, with_more
    from kilter.analysis.margins.level_limits import find_push
    from kilter.mechanics.program import build_program

    assembly = made(family, seed)
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts)
    wrong = least_wrong(assembly, contacts) if assembly.bonds else []
    yield {"held": judge(program).stable is True, "wrong": wrong}
    if judge(program).stable is not True:
        return
    random = np.random.default_rng(seed)

    def direction() -> Any:
        along = random.normal(size=3) * ([1, 0, 1] if program.planar else [1, 1, 1])
        return along / np.linalg.norm(along)

    def pushed(along: Any) -> Any:
        wrench = np.zeros((len(program.names), 6))
        wrench[part, :3] = float(program.weight[program.free].sum()) * along
        return wrench

    along, aside = direction(), direction()
    part = int(random.choice(np.flatnonzero(program.free)))
    names = [program.names[part]]
    margin = kilter.margin(assembly, contacts=contacts, push=along, pushed=names, effort=0)
    greatest, push = (margin.load_limits or (None, None))[1], find_push(program, part, aside)
    found = {
        "load factor": (getattr(greatest, "value", np.nan), gravity_wrench(program, along)),
        "push": (getattr(getattr(push, "limit", None), "value", np.nan), pushed(aside)),
    }
    for what, (value, wrenches) in found.items():

        def held(share: float, wrenches: Any = wrenches) -> bool | None:
            return judge(with_more(program, wrenches, share)).stable

        low, high, undecided = bisected(held)
        yield {what: [value, low, high, undecided]}
        slack = NEAR * max(1.0, low)
        if not low - slack <= value <= high + slack:
            wrong.append(f"{what} {value}, bisected {low} to {high}")
        for share, holds in ((low, True), (high, False)):
            if np.isfinite(share):
                verdict = checked(assembly, contacts, share * wrenches)
                if verdict != "undecided" and (verdict != "unstable") is not holds:
                    wrong.append(f"{what} at {share}: check says {verdict}")
    for one in margin.pushes:
        share = min(one.lower / float(program.weight[program.free].sum()), LARGEST) * (1 - NEAR)
        for _ in range(AROUND):
            if judge(with_more(program, pushed(direction()), share)).stable is False:
                wrong.append(f"least push {one.lower} is not resisted")
    yield {"wrong": wrong}


def made(family: str, seed: int) -> Any:
    """Build the assembly of a family and a seed."""
    from random_bonded import random_bonded
    from random_turned import random_turned

    return random_bonded(seed).assembly if family == "bonded" else random_turned(family, seed)


def least_wrong(assembly: Any, contacts: Any) -> list[str]:
    """Contradictions between `margin` and bisection for the least friction and bond strength."""
    import kilter
    from kilter.analysis.decision.judge import judge

    margin = kilter.margin(assembly, contacts=contacts, pushed=[], effort=0)
    program = margin.program
    asked = {
        "friction": program.with_friction,
        "bond": program.with_strength,
    }
    wrong = []
    for what, changed in asked.items():

        def falls(share: float, changed: Callable[[float], Any] = changed) -> bool | None:
            stable = judge(changed(share)).stable
            return None if stable is None else not stable

        low, high, _ = bisected(falls)
        found = getattr(margin, f"{what}_limit")
        value = float("inf") if found is None else found.value
        slack = NEAR * max(1.0, low)
        if not low - slack <= value <= high + slack:
            wrong.append(f"{what} {value}, bisected {low} to {high}")
    return wrong


def checked(assembly: Any, contacts: Any, wrenches: Any) -> str:
    """Verdict of `check` for an assembly with additional forces, (N, 6), on its parts."""
    import dataclasses

    import kilter
    from kilter.assembly import Load

    forces = zip(assembly.parts, wrenches[:, :3], strict=True)
    loads = [Load(part.name, force=force) for part, force in forces if force.any()]
    loaded = dataclasses.replace(assembly, loads=[*assembly.loads, *loads])
    verdict: str = kilter.check(loaded, contacts=contacts, effort=0).verdict
    return verdict


def bisected(held: Callable[[float], bool | None]) -> tuple[float, float, int]:
    """Bisect the largest share that is held: lower bound, upper bound, undecided shares."""
    low, high, undecided = 0.0, NEAR, 0
    while True:
        answer = held(high)
        if answer is False:
            break
        low = high if answer else low
        undecided += answer is None
        if high >= LARGEST:
            return low, float("inf"), undecided
        high *= 4
    while high - low > NEAR / 2 * max(1.0, low):
        middle = 0.5 * (low + high)
        answer = held(middle)
        if answer is None:  # bisection cannot continue from an undecided share
            undecided += 1
            break
        low, high = (middle, high) if answer else (low, middle)
    return low, high, undecided


def main() -> int:
    """Run the census; return 1 if there is a fault or a contradiction."""
    parser = argparse.ArgumentParser()
    parser.add_argument("family")
    parser.add_argument("count", type=int)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("-o", default=None)
    given = parser.parse_args()
    rows = []
    for seed in range(given.first, given.first + given.count):
        rows.append(run(given.family, seed, 0, answered))
        if given.o:
            with open(given.o, "a") as file:
                file.write(json.dumps(rows[-1]) + "\n")
    held = [row for row in rows if row.get("held")]
    faults = [row for row in rows if "fault" in row]
    wrong = [row for row in rows if row.get("wrong")]
    open_ends = sum(bool(row[what][3]) for row in held for what in ("load factor", "push"))
    print(
        f"{given.family}: {len(rows)} assemblies, {len(held)} hold as given, {len(faults)} faults,"
        f" {len(wrong)} with contradictions, {open_ends} limits with an undecided share"
    )
    for row in faults + wrong:
        print(f"  seed {row['seed']}: {row.get('fault', row.get('wrong'))}")
    return int(bool(faults or wrong))


if __name__ == "__main__":
    raise SystemExit(main())
