"""Comparison of `kilter.plan` with a greedy planner that calls `kilter.check` for each state.

    python benchmarks/greedy_planner.py           scenes of kilter
    python benchmarks/greedy_planner.py PATH:BASE[:MU[:BOLT,NUT]...] ...
                                                  assemblies with base, friction and screws

The greedy planner starts from the complete assembly and removes parts without backtracking. The
next part must have a path, keep all other parts connected to the base, and leave a state that
`check` finds in equilibrium. Parts of the highest layer come first, then parts near the previous
one. If every part of a layer needs a hold, the first part is taken for which holding few moving
parts is enough. Paths are tested as in `plan`, so that only the states differ. Each line contains
CPU seconds without contact detection, steps, most held parts and held steps of both planners, and
whether the orders are equal.
"""

from __future__ import annotations

import itertools
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import kilter
from kilter.analysis.planning.order.removal import Removal, find_screws
from kilter.analysis.planning.states.holds import bits_of
from kilter.contact.kept_contacts import contacts_among
from kilter.scenes import scene
from kilter.scenes.arches import arch

Pairs = Sequence[tuple[str, str]]
LAYER = 0.01
"""Resolution of the heights that define layers [width of the assembly]."""
CASES: dict[str, Callable[[], kilter.Assembly]] = {
    "tower": lambda: scene("tower"),
    "wall": lambda: scene("wall"),
    "paper-figure-9": lambda: scene("paper-figure-9"),
    "arch of 9": lambda: arch(9, ratio=0.3, friction=0.6),
    "arch of 20": lambda: arch(20, ratio=0.2, friction=0.6),
    "laden-slab": lambda: scene("laden-slab"),
}


class Greedy:
    """Greedy planner that removes the parts of an assembly one after the other."""

    def __init__(
        self, assembly: kilter.Assembly, contacts: kilter.ContactSet, named: Pairs
    ) -> None:
        self.assembly, self.contacts = assembly, contacts
        self.removal = Removal(contacts, screws=find_screws(contacts, named))
        self.checks = 0
        geometry = assembly.geometry
        wide = float(np.ptp(geometry.center, axis=0).max())
        self.height = (geometry.center @ -assembly.down / wide / LAYER).round()
        self.touching = [set[int]() for _ in assembly]
        for a, b in contacts.patch_parts.tolist():
            self.touching[a].add(b)
            self.touching[b].add(a)

    def order(self, hold: int) -> list[tuple[int, list[str]]] | None:
        """Parts in the order of removal, each with the held parts; None if no part can leave."""
        present = np.ones(len(self.assembly), dtype=bool)
        found: list[tuple[int, list[str]]] = []
        while not (present == self.assembly.geometry.grounded).all():
            step = self.next(present, found[-1][0] if found else None, hold)
            if step is None:
                return None
            found.append(step)
            present[step[0]] = False
        return found

    def next(
        self, present: np.ndarray, last: int | None, hold: int
    ) -> tuple[int, list[str]] | None:
        """The next part to remove and the parts to hold; None if no part can leave."""
        center = self.assembly.geometry.center
        parts = [k for k in np.flatnonzero(present) if not self.assembly[int(k)].grounded]
        away = {k: 0.0 if last is None else np.linalg.norm(center[k] - center[last]) for k in parts}
        parts.sort(key=lambda k: (-self.height[k], round(away[k], 9)))
        for _, layer in itertools.groupby(parts, key=lambda k: self.height[k]):
            falling = []
            for part in map(int, layer):
                rest = present.copy()
                rest[part] = False
                if not self.connected(rest) or not self.way_out(part, present):
                    continue
                moving = self.moving(rest, [])
                if not moving:
                    return part, []
                falling.append((part, moving))
            for part, moving in falling:
                rest = present.copy()
                rest[part] = False
                for held in self.some(moving, hold):
                    if not self.moving(rest, held):
                        return part, held
        return None

    @staticmethod
    def some(moving: list[str], most: int) -> Iterator[list[str]]:
        """Yield the subsets of the moving parts with up to `most` parts, the smallest first."""
        for size in range(1, most + 1):
            yield from map(list, itertools.combinations(moving, size))

    def way_out(self, part: int, present: np.ndarray) -> bool:
        return self.removal.way_out(1 << part, bits_of(present)) is not None

    def connected(self, rest: np.ndarray) -> bool:
        """Whether every remaining part is connected to a held part."""
        there = set(np.flatnonzero(rest).tolist())
        seen = new = {k for k in there if self.assembly[k].grounded}
        while new:
            new = set().union(*(self.touching[k] for k in new)) & there - seen
            seen = seen | new
        return seen == there

    def moving(self, rest: np.ndarray, held: list[str]) -> list[str]:
        """Names of the parts that move according to `check`; empty in equilibrium."""
        self.checks += 1
        names = np.array(self.assembly.names)
        state = self.assembly.without(names[~rest].tolist())
        state = state.with_grounded(held) if held else state
        contacts = contacts_among(self.contacts, state)
        verdict = kilter.check(state, contacts=contacts, require="equilibrium", effort=0)
        return [] if verdict.stable else verdict.moving or ["undecided"]


def timed(work: Callable[[], Any]) -> tuple[Any, float]:
    started = time.process_time()
    return work(), time.process_time() - started


def compared(name: str, assembly: kilter.Assembly, screws: Pairs) -> str:
    """A line of the table for an assembly."""
    contacts = kilter.contacts(assembly)
    plan, first = timed(
        lambda: kilter.plan(assembly, kilter.PlanRules(screws=screws), contacts=contacts)
    )
    greedy = Greedy(assembly, contacts, screws)
    found, second = timed(
        lambda: next(filter(None, (greedy.order(hold) for hold in range(3))), None)
    )
    steps = [(step.part, len(step.held)) for step in plan.steps]
    other = [(assembly.names[part], len(held)) for part, held in reversed(found or [])]
    holds = [
        f"{max((n for _, n in one), default=0)} in {sum(n > 0 for _, n in one)}"
        for one in (steps, other)
    ]
    same = [part for part, _ in steps] == [part for part, _ in other]
    words = [name, len(steps), len(other), *holds, "yes" if same else "no"]
    cells = [*map(str, words), f"{first:.2f}", f"{second:.2f}", f"{second / first:.1f}"]
    return row([*cells, str(greedy.checks)])


def row(cells: list[str]) -> str:
    widths = (16, 6, 6, 8, 8, 6, 8, 8, 7, 7)
    return "".join(cell.ljust(width) for cell, width in zip(cells, widths, strict=True))


def read(word: str) -> tuple[str, kilter.Assembly, Pairs]:
    """Name, assembly and screws of a command-line argument."""
    path, base, *more = word.split(":")
    made = kilter.load(path, ground=[base], friction=float(more[0]) if more else None)
    pairs = (pair.split(",") for pair in more[1:])
    return Path(path).name, made, [(bolt, nut) for bolt, nut in pairs]


def main(given: list[str]) -> None:
    head = ["case", "steps", "", "held", "", "same", "plan s", "greedy s", "ratio", "checks"]
    print(row(head))
    made = map(read, given) if given else ((name, make(), ()) for name, make in CASES.items())
    for case in made:
        print(compared(*case), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
