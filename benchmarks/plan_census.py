"""Census of plans of irregular assemblies: compares them with `check` and all permutations.

    python benchmarks/plan_census.py arch 40 -o plans.jsonl     seeds 0 to 39; continues a file
    python benchmarks/plan_census.py --table plans.jsonl

Families: arch, pile, wedge (`tests/scenes/random_turned.py`), and wall: few courses of bricks of
random widths, with gaps, on a random base. Each is planned with up to 0, 1 and 2 held parts, in a
separate process; more than a minute of CPU time is a fault. Then

- `check` judges the finished assembly, which the plan must find to hold or to fall, too;
- `verify_bundle` verifies every proof, read from its JSON text;
- `check` judges every state of an order, built separately with newly detected contacts;
- an order with K held parts must also exist with more held parts, with the same minimum;
- if the finished assembly holds and has up to `BRUTE` free parts, all permutations are tested, with
  `check` for every state and every set of held parts. No permutation may need fewer held parts than
  the order, and none may exist if the plan is impossible (independently of paths, unless parts
  lock) or was not found.
"""

from __future__ import annotations

import collections
import json
import resource
import signal
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from functools import cache
from itertools import combinations, pairwise, permutations
from pathlib import Path
from typing import Any

import numpy as np
from region_census import LIMIT, main

import kilter
from kilter.analysis.planning.order.removal import Removal
from kilter.analysis.planning.states.holds import bits_of, mask_of, members
from kilter.analysis.verification import verify_bundle
from kilter.arrays import connected
from kilter.contact.kept_contacts import contacts_among
from kilter.scenes.walls import wall_from_courses

sys.path.append(str(Path(__file__).resolve().parents[1] / "tests" / "scenes"))

from random_turned import random_turned

MOST = 2
"""Largest number of simultaneously held parts."""
BRUTE = 6
"""All permutations are tested for up to this many free parts."""

Tally = collections.Counter[str]
Cost = Callable[[int, int], int]
"""Number of held parts after a part has left a set; `MOST` + 1 for more, or if it cannot leave."""


def random_wall(seed: int) -> kilter.Assembly:
    """A wall of two to four courses of up to three bricks, with slightly leaning gravity."""
    random = np.random.default_rng(seed)
    courses = []
    for _ in range(int(random.integers(2, 5))):
        widths = random.uniform(0.5, 1.6, random.integers(1, 4))
        if len(widths) == 3 and random.random() < 0.5:
            widths[1] *= -0.6
        courses.append([-float(random.uniform(0.01, 0.5)), *widths.tolist()])
    size = random.uniform([0.15, 0.08, 0.05], [0.3, 0.2, 0.2])
    reach = sum(map(abs, courses[0])) * float(size[0] * random.uniform(0.8, 1.1))
    mu, lean = random.uniform([0.1, -0.05], [1.0, 0.05])
    made = wall_from_courses(courses, size=size.tolist(), base=(0.0, reach), friction=float(mu))
    return made.with_down([lean, 0.0, -1.0])


def answered(family: str, seed: int, directions: int) -> Any:
    """Yield the parts of a case's row."""

    def stop(*_: object) -> None:
        raise TimeoutError(f"more than {LIMIT:g} s of the processor")

    signal.signal(signal.SIGXCPU, stop)
    resource.setrlimit(resource.RLIMIT_CPU, (int(LIMIT), int(LIMIT) + 5))
    assembly = random_wall(seed) if family == "wall" else random_turned(family, seed)
    free = sum(not part.grounded for part in assembly)
    orders, cpu = [], []
    for hold in range(MOST + 1):
        used = time.process_time()
        orders.append(kilter.plan(assembly, kilter.PlanRules(hold=hold)))
        cpu.append(round(time.process_time() - used, 3))
    yield {"kind": kind_of(orders[-1]), "free": free, "cpu": cpu}
    tally: Tally = collections.Counter()
    finished, stable = orders[0].finished, stands(assembly)
    wrong = [*proofs_wrong(assembly, orders, tally), *holds_wrong(orders)]
    if stable is not (None if finished.verdict == "undecided" else finished.level is not None):
        wrong.append(f"finished: {finished.verdict}, but check says {stable}")
    for fewest in [one for one in orders if one.found][:1]:
        wrong += states_wrong(assembly, fewest, tally)
    if stable and free <= BRUTE:
        wrong += brute_wrong(assembly, orders, tally)
    yield {"tally": dict(tally), "wrong": wrong}


def kind_of(order: kilter.Order) -> str:
    """Verdict of an order with the number of held parts, or of an assembly that does not hold."""
    if order.finished.level is None:
        return f"finished: {order.finished.verdict}"
    return f"found, {order.holds_max} held" if order.found else order.verdict


def stands(assembly: kilter.Assembly, contacts: kilter.ContactSet | None = None) -> bool | None:
    """Whether equilibrium forces exist according to `check`; None if undecided."""
    verdict = kilter.check(assembly, contacts=contacts, require="equilibrium", effort=0)
    return None if verdict.verdict == "undecided" else verdict.stable


def built(assembly: kilter.Assembly, absent: Any, held: Any) -> kilter.Assembly:
    """A state as a separate assembly, given the names of absent and held parts."""
    rest = assembly.without(list(absent)) if len(absent) else assembly
    return rest.with_grounded(list(held)) if len(held) else rest


def proofs_wrong(assembly: kilter.Assembly, orders: Iterable[kilter.Order], tally: Tally) -> Any:
    """Yield the proofs that are not verified."""
    for hold, order in enumerate(orders):
        tally[f"{order.verdict} with {hold}"] += 1
        if order.verdict != "none-found":
            proof = json.loads(json.dumps(order.proof(), allow_nan=False))
            again = verify_bundle(assembly, kilter.contacts(assembly), proof)
            tally["proofs"] += 1
            if not again.holds:
                yield f"proof with {hold} held: {'; '.join(again.reasons)[:200]}"


def holds_wrong(orders: Sequence[kilter.Order]) -> Any:
    """Yield contradictions between the answers for increasing numbers of held parts."""
    for hold, (less, more) in enumerate(pairwise(orders)):
        if less.found and kind_of(more) != kind_of(less):
            yield f"{kind_of(less)}, but {kind_of(more)} with up to {hold + 1}"
        if more.verdict == "impossible" and less.verdict != "impossible":
            yield f"impossible with {hold + 1}, but {less.verdict} with {hold}"
    if any(order.found and order.holds_max > hold for hold, order in enumerate(orders)):
        yield "more held than may be"


def states_wrong(assembly: kilter.Assembly, order: kilter.Order, tally: Tally) -> Any:
    """Yield states of an order that `check` rejects, and parts that are not inserted once."""
    names, there = np.array(assembly.names), assembly.geometry.grounded.copy()
    for step in order.steps:
        present, new = step.state.present, np.isin(names, step.parts)
        if (present != there).any() or (present & new).any() or set(step.held) & set(names[~there]):
            yield f"{step}: other parts are there than were put in"
        there |= new
        if step.state.free.any():
            stable = stands(built(assembly, names[~present], step.held))
            tally["states" if stable is not None else "states open"] += 1
            if stable is False:
                yield f"{step}: falls by check"
    if not there.all():
        yield "parts are left out of the order"


def brute_wrong(assembly: kilter.Assembly, orders: Sequence[kilter.Order], tally: Tally) -> Any:
    """Yield contradictions between the answers and all permutations of the parts."""
    tally["by all orders"] += 1
    asked = Permuted(assembly)
    low, high = (asked.fewest(lambda *of, k=k: asked.cost(*of)[k]) for k in (0, 1))
    anyhow = asked.fewest(lambda part, there: asked.needs(there & ~(1 << part))[0])
    for hold, order in enumerate(orders):
        if order.found and not low <= order.holds_max <= high:
            yield f"{kind_of(order)}, by all orders {low} to {high}"
        if order.verdict == "none-found" and order.search.exhausted and high <= hold:
            yield f"none found with {hold}, by all orders {high} are enough"
        least = (MOST if low > MOST else -1) if order.locked else anyhow - 1
        if order.verdict == "impossible" and least < hold:
            yield f"impossible with {hold}, by all orders {anyhow}, along ways {low}"


class Permuted:
    """All permutations of an assembly's parts, with states judged by `check` and swept paths."""

    def __init__(self, assembly: kilter.Assembly) -> None:
        self.assembly, self.contacts = assembly, kilter.contacts(assembly)
        self.grounded = assembly.geometry.grounded
        self.removal = Removal(self.contacts)
        self.needs, self.cost = cache(self._needs), cache(self._cost)

    def fewest(self, cost: Cost) -> int:
        """Fewest simultaneously held parts over all permutations; `MOST` + 1 for more or none."""
        best = MOST + 1
        for order in permutations(np.flatnonzero(~self.grounded).tolist()):
            present, most = (1 << len(self.assembly)) - 1, 0
            for part in order:
                most = max(most, cost(part, present))
                if most >= best:
                    break
                present &= ~(1 << part)
            else:
                best = most
        return best

    def _cost(self, part: int, present: int) -> tuple[int, int]:
        """`_needs` after a part has left along a path of one or two segments."""
        out = any(self.removal.way_out(1 << part, present, legs=legs) for legs in (1, 2))
        return self.needs(present & ~(1 << part)) if out else (MOST + 1, MOST + 1)

    def _needs(self, present: int) -> tuple[int, int]:
        """Fewest held parts with which a set may hold, and with which `check` proves it to hold."""
        count, names = len(self.assembly), np.array(self.assembly.names)
        there = mask_of(present, count)
        pairs = self.contacts.patch_parts
        label = connected(count, *pairs[there[pairs].all(axis=1)].T)
        if not np.isin(label[there], label[self.grounded]).all():
            return MOST + 1, MOST + 1
        free, least = members(present & ~bits_of(self.grounded), count).tolist(), MOST + 1
        for size in range(min(MOST, len(free)) + 1):
            for held in combinations(free, size):
                state = built(self.assembly, names[~there], names[list(held)])
                among = contacts_among(self.contacts, state)
                stable = size == len(free) or stands(state, among)
                least = least if stable is False else min(least, size)
                if stable:
                    return least, size
        return least, MOST + 1


def table(rows: list[dict[str, Any]]) -> None:
    """Print the counts and longest times of each family."""
    for family in sorted({row["family"] for row in rows}):
        own = [row for row in rows if row["family"] == family]
        faults = [row for row in own if "fault" in row]
        wrong = [row for row in own if row.get("wrong")]
        kinds = collections.Counter(row.get("kind", "?") for row in own)
        tally: Tally = collections.Counter()
        for row in own:
            tally.update(row.get("tally", {}))
        worst, seed = max((max(row.get("cpu", [0.0])), row["seed"]) for row in own)
        print(
            f"{family}: {len(own)} assemblies, {len(faults)} faults, {len(wrong)} with"
            f" contradictions; {dict(sorted(kinds.items()))}; asked {dict(tally)};"
            f" worst {worst} CPU seconds (seed {seed})"
        )
        for row in faults + wrong:
            print(f"  seed {row['seed']}: {row.get('fault', row.get('wrong'))}")


if __name__ == "__main__":
    raise SystemExit(main(answered, table))
