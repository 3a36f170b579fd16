"""The verdict on the pile of a packing plan after each item.

Boxes that lie on each other by level faces form a stack. Forces on level faces act only within a
stack, and other contacts only forbid motions. So a pile is stable, whatever its friction, if each
of its stacks has

    forces of equilibrium without friction, which fix the height and tilts of each box

(`kilter.second_order.proofs.level_rest`). An item changes only the stacks on which it lies: with it
they are a single stack, and only the forces of this stack are computed and verified again. A motion
that proves a fall is tried for the next items too, with each of them at rest. `kilter.check`
decides on the whole pile if neither is a proof.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from kilter.analysis.check import check
from kilter.analysis.decision.doubts import doubts_of
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly
from kilter.assembly.question import Question
from kilter.contact import ContactSet
from kilter.contact.detect import touching
from kilter.contact.fits.suggestions import coincident
from kilter.contact.kept_contacts import contacts_among
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.mechanics_tolerances import TOLERANCE
from kilter.mechanics.program import Program, build_program
from kilter.second_order.proofs.level_rest import level_rows
from kilter.second_order.searches.level_rest_search import resting_forces
from kilter.tell.levels import level_of


@dataclass(frozen=True, slots=True, eq=False)
class PlanState:
    """The verdict on the pile after an item."""

    word: str
    """The verdict."""
    level: str | None
    program: Callable[[], Program]
    """Returns the program against which the verdict is proved."""
    verdict: Verdict | None = None
    """The answer of `kilter.check`; None if forces of the stacks or a known motion are the
    proof."""


def plan_states(asked: Question, count: int) -> Iterator[PlanState]:
    """Yield the verdict on the pile after each item.

    The assembly has `count` boxes in the order of the plan, then the other parts.
    """
    whole, contacts, require = asked.assembly, touching(asked), asked.require
    stacks = (
        _Stacks(whole, contacts, count) if _has_stacks(whole, contacts, count, require) else None
    )
    for k in range(count):
        if stacks is not None and stacks.put(k):
            yield PlanState("stable", level_of("stable"), partial(stacks.program_after, k))
            continue
        if stacks is not None and stacks.falls_after(k):
            yield PlanState("unstable", level_of("unstable"), partial(getattr, stacks, "outer"))
            continue
        state, among = whole, contacts
        if k + 1 < count:
            state = whole.without(whole.names[k + 1 : count])
            among = contacts_among(contacts, state)
        verdict = check(asked.but(assembly=state, contacts=among, progress=None))
        if stacks is not None:
            stacks.keep_motion(k, verdict)
        yield PlanState(
            str(verdict.verdict), verdict.level, partial(getattr, verdict, "program"), verdict
        )


def _has_stacks(whole: Assembly, contacts: ContactSet, count: int, require: str) -> bool:
    """Whether forces of stacks may decide a pile: only boxes are free, and only flat faces touch.

    The level strict needs more than these forces, `check` rejects some overlaps, and coordinates of
    low accuracy may explain a motion.
    """
    others = whole.joints or whole.bonds or whole.straps or whole.loads
    return (
        require != "strict"
        and not others
        and not doubts_of(whole, contacts).stated.any()
        and all(part.grounded for part in whole.parts[count:])
        and bool((contacts.patch_kind == "plane").all())
        and not coincident(contacts)
    )


@dataclass(slots=True)
class _Stack:
    """Boxes of a stack, its rows of level contacts, and whether its forces are known."""

    boxes: list[int]
    rows: list[Index]
    rests: bool = False


class _Stacks:
    """The stacks of a growing pile."""

    def __init__(self, whole: Assembly, contacts: ContactSet, count: int) -> None:
        program = build_program(whole, contacts).frictionless
        self._program, self._count = program, count
        self._whole, self._contacts = whole, contacts
        self._motion: Array | None = None
        # tolerances of coarse coordinates depend on all contacts of a part, also on later ones
        self._exact = program.with_rows(tolerance=np.full(len(program.names), TOLERANCE))
        self._ends = _boxes_at(program)
        self._since = self._ends.max(axis=1, initial=-1)
        level = np.flatnonzero(level_rows(program, contacts) & (self._since >= 0))
        level = level[np.argsort(self._since[level], kind="stable")]
        self._new_rows = np.split(level, np.searchsorted(self._since[level], np.arange(1, count)))
        self._stack_of: dict[int, _Stack] = {}
        self._not_known = 0

    def put(self, k: int) -> bool:
        """Put down the next item, and return whether the forces of all stacks are known."""
        new = self._new_rows[k]
        neighbours = {int(j) for j in self._ends[new].ravel() if j not in (-1, k)}
        touched = {id(self._stack_of[j]): self._stack_of[j] for j in sorted(neighbours)}
        stack = _Stack([k], [new])
        for other in touched.values():
            stack.boxes += other.boxes
            stack.rows += other.rows
            self._not_known -= not other.rests
        stack.rests = self._rests(stack)
        self._not_known += not stack.rests
        self._stack_of.update(dict.fromkeys(stack.boxes, stack))
        return not self._not_known

    def _rests(self, stack: _Stack) -> bool:
        """Whether forces on the level contacts of a stack balance it and fix its boxes."""
        free = np.zeros(len(self._program.names), dtype=bool)
        free[stack.boxes] = True
        program = replace(self._exact, free=free).taking(np.concatenate(stack.rows))
        forces = resting_forces(program, np.ones(len(program.kind), dtype=bool))
        return forces is not None and check_forces(program, forces).holds

    def program_after(self, k: int) -> Program:
        """The program of the pile after item k, counted from 0, without friction."""
        return _up_to(self._program, self._since, k)

    def keep_motion(self, k: int, verdict: Verdict) -> None:
        """Keep the motion that proves a fall after item k, if there is one."""
        proof = verdict.judgement.motion
        if verdict.verdict == "unstable" and proof is not None:
            self._motion = np.zeros((len(self._program.names), 6))
            self._motion[[*range(k + 1), *range(self._count, len(self._motion))]] = proof.motion

    def falls_after(self, k: int) -> bool:
        """Whether the kept motion proves a fall after item k, against every possible contact."""
        if self._motion is None:
            return False
        outer = self.outer
        since = _boxes_at(outer).max(axis=1, initial=-1)
        return check_motion(_up_to(outer, since, k), self._motion).holds

    @cached_property
    def outer(self) -> Program:
        """The program of the finished pile with every possible contact."""
        return build_program(self._whole, self._contacts, possible=True)


def _boxes_at(program: Program) -> Index:
    """The free parts at both ends of each row, shape (K, 2); -1 for a held part."""
    box = np.append(np.where(program.free, np.arange(len(program.names)), -1), -1)
    return np.stack([box[program.part_a], box[program.part_b]], axis=1)


def _up_to(program: Program, since: Index, k: int) -> Program:
    """The program without the boxes after item k; `since`, shape (K,): last box at each row."""
    free: Mask = program.free & (np.arange(len(program.names)) <= k)
    return replace(program, free=free).taking(since <= k)
