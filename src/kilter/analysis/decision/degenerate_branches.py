"""Degenerate points: decisions by branches, and by the paper's planar approximation.

The allowed motions at degenerate points are a union (`kilter.mechanics.degenerate`): a
convex cone for each choice of an extreme normal m at every point, v.m >= 0. The assembly
is stable iff no allowed motion has power w.dp > 0, so

- stable iff in no branch a motion has power: every allowed motion lies in a branch, and each
  branch is a program of its own with its own forces (Farkas);
- unstable iff a motion has power in some branch: a motion of a branch opens along a separating
  normal at every point and therefore enters no part to first order.

Both are exact to first order at points. Along a line of degenerate points (a ridge on a
ridge) the choice may change from point to point of the line, so a branch of its ends is only
an outer bound: good for "stable"; for "unstable" the motion is tested along the whole line,
and if it enters at a point, that point of the line is branched on too (which proves nothing for
"stable": the parts need not touch all along).

Branches are opened only if they are needed: a program without some of the points whose
motion enters nowhere, or that is stable, settles all branches below it. (The number of
branches is exponential in the worst case, as it must be: Palmer; the paper, section 1.1.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.analysis_tolerances import ENTERS
from kilter.analysis.decision.judge import Judgement, judge
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet, PossibleContacts
from kilter.mechanics.certificate import check_motion
from kilter.mechanics.degenerate import (
    MOST,
    allowed_program,
    between,
    openings,
    with_pushes,
    without_degenerate,
)
from kilter.mechanics.program import Program, build_program

__all__ = ["Degenerates", "decide_degenerate"]


PROGRAMS = 200
"""Programs solved before branching is given up."""


@dataclass(frozen=True, slots=True, eq=False)
class Degenerates:
    """Result of the branches of degenerate points.

    Attributes
    ----------
    branching : bool or None
        Stable by branching; None: not decided.
    approximation : bool or None
        Stable with the paper's planar approximation.
    program, judgement
        If a motion was found: the program against which it is proved, and its proof.
    programs : int
        How many were solved.
    """

    branching: bool | None
    approximation: bool | None
    program: Program | None = None
    judgement: Judgement | None = None
    programs: int = 0

    @property
    def words(self) -> list[str]:
        """The words about the points if the verdict stays undecided."""
        said = []
        if self.branching:
            said.append(
                "it is stable for every choice of normals at the edges and corners without a "
                "unique normal (by branching, without a proof file)"
            )
        if self.approximation is not None:
            word = "stable" if self.approximation else "unstable"
            said.append(f"with the paper's planar approximation it would be {word}")
        return said


def decide_degenerate(assembly: Assembly, contacts: ContactSet) -> Degenerates:
    """Both answers for an assembly that its degenerate points might hold.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.scenes.pieces import prism
    >>> ridge = prism("ridge", [[-1, -1], [1, -1], [0, 0]], 2.0, grounded=True)
    >>> top = prism("top", [[0, 0], [1, 1], [-1, 1]], 2.0)
    >>> assembly = Assembly([ridge, top])
    >>> answer = decide_degenerate(assembly, contacts(assembly))
    >>> answer.branching, answer.approximation
    (False, True)
    """
    points = contacts.degenerate
    if not len(points):
        return Degenerates(None, None)
    inner = build_program(assembly, contacts).frictionless
    approximation = judge(with_pushes(inner, contacts.approximate)).stable
    if len(points) > MOST or not points.exact.any():
        return Degenerates(None, approximation)
    branches = _Branches(assembly, contacts)
    outer = without_degenerate(assembly, contacts)
    answer = branches.search(outer)
    if answer is not False and len(outer.part_a) > len(inner.part_a):
        # more than contacts was counted: stability must not rest on that
        answer = branches.search(inner) or None
    return Degenerates(
        answer, approximation, branches.program, branches.judgement, branches.programs
    )


class _Branches:
    """A search of the branches; keeps the motion that it finds."""

    def __init__(self, assembly: Assembly, contacts: ContactSet) -> None:
        self.assembly = assembly
        self.contacts = contacts
        self.programs = 0
        self.inner = False
        self.program: Program | None = None
        self.judgement: Judgement | None = None
        points = contacts.degenerate
        pushes = points.pushes()
        self.clauses = [
            [pushes.take([row]) for row in range(int(points.start[k]), int(points.start[k + 1]))]
            for k in np.flatnonzero(points.exact).tolist()
        ]

    def search(self, base: Program) -> bool | None:
        """Whether every branch over a program is stable; None: not decided."""
        stack = [base]
        while stack:
            program = stack.pop()
            self.programs += 1
            if self.programs > PROGRAMS:
                return None
            judgement = judge(program)
            if judgement.stable:
                continue
            if judgement.stable is None or judgement.motion is None:
                return None
            motion = judgement.motion.motion
            entered = self._entered(program, motion)
            if entered is None:
                return self._kept(judgement, motion)
            stack += [with_pushes(program, push) for push in entered]
        return None if self.inner else True

    def _entered(self, program: Program, motion: Array) -> list[PossibleContacts] | None:
        """The pushes of the point that a motion enters most; None: it enters nowhere."""
        between_them = [
            [pushes.take([row]) for row in range(len(pushes))]
            for pushes in between(program, self.contacts, motion)
        ]
        clauses = self.clauses + between_them
        opening = [max(float(openings(program, p, motion)[0]) for p in c) for c in clauses]
        if min(opening, default=0.0) >= -ENTERS:
            return None
        worst = int(np.argmin(opening[: len(self.clauses)]))
        if opening[worst] >= -ENTERS:
            worst, self.inner = int(np.argmin(opening)), True
        return clauses[worst]

    def _kept(self, judgement: Judgement, motion: Array) -> bool | None:
        """False if the motion is allowed: then it is the proof."""
        program = allowed_program(self.assembly, self.contacts, motion)
        if program is None:
            return None
        proof = check_motion(program, motion)
        if not proof.holds:
            return None
        self.program = program
        self.judgement = Judgement(False, None, proof, judgement.solvers)
        return False
