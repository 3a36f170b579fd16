"""Decide assemblies with contacts that have no unique normal, by trying every normal.

A planar approximation decides some further assemblies.

The set of allowed motions at degenerate points is a union of convex cones
(`kilter.mechanics.degenerate`). Each cone belongs to a *branch*: the choice of an extreme normal
m at every point, with v.m >= 0. The assembly is stable iff no allowed motion has power
w.dp > 0. Therefore it is

- stable iff no branch has a motion with power: every allowed motion lies in a branch, and each
  branch is a program with its own forces of equilibrium (Farkas);
- unstable iff a branch has a motion with power: it opens along a separating normal at every
  point, so it violates no contact to first order.

Both statements are exact to first order at points. Along a line of degenerate points (a ridge on
a ridge) the choice of normal may change from point to point. A branch of the two ends is then
only an outer bound, which suffices for "stable". For "unstable", the motion is verified along the
whole line. If it enters the other part at a point of the line, the search branches on that point,
too. After that it can no longer prove "stable", since the parts need not touch at that point.

The search begins without constraints at the degenerate points and adds a point only if a motion
violates it. If a program is stable, or its motion violates no point, all branches below it are
decided. The number of branches is exponential in the worst case, and no method can avoid this
(Palmer; section 1.1 of the paper).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.analysis.analysis_tolerances import ENTERS
from kilter.analysis.decision.judge import Judgement, judge
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact.common.patches import PossibleContacts
from kilter.contact.contact_set import ContactSet
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

PROGRAMS = 200
"""Largest number of programs that the search solves; after that it returns no decision."""
LARGE = 4000
"""Number of rows above which a branch is first judged by kilter's own interior point method."""


@dataclass(frozen=True, slots=True, eq=False)
class Degenerates:
    """Answer for an assembly with degenerate contact points, which have no unique normal."""

    branching: bool | None
    """Whether the assembly is stable, by branching; None if branching does not decide."""
    approximation: bool | None
    """Whether it is stable with the planar approximation; None if that does not decide."""
    program: Program | None = None
    judgement: Judgement | None = None
    """If branching finds a motion: the program against which it is proved, and the proof."""
    programs: int = 0
    """Number of programs solved."""

    @property
    def words(self) -> list[str]:
        """Sentences about degenerate contact points for an answer that stays undecided."""
        sentences = []
        if self.branching:
            sentences.append(
                "where edges and corners meet without a unique normal, every possible normal was "
                "tried: it is stable for all of them (no proof file can be written)"
            )
        if self.approximation is not None:
            word = "stable" if self.approximation else "unstable"
            sentences.append(f"with the paper's planar approximation it would be {word}")
        return sentences


def decide_degenerate(assembly: Assembly, contacts: ContactSet) -> Degenerates:
    """Decide an assembly, without friction, that forces at degenerate contact points might hold.

    Returns both answers are None if there are no degenerate points. `branching` is None if there
    are more than `kilter.mechanics.degenerate.MOST` points, or no exact points.

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
        # `outer` also has contacts that are not certain: a proof of stability must not use them
        answer = branches.search(inner) or None
    return Degenerates(
        answer, approximation, branches.program, branches.judgement, branches.programs
    )


def _judge_branch(program: Program) -> Judgement:
    """Judge a program without friction; a large one first by kilter's own interior point method.

    A branch only needs a yes or no, and a simplex on thousands of rows takes five times as long.
    """
    if len(program.part_a) > LARGE:
        judgement = judge(program, solver="kilter")
        if judgement.stable is not None:
            return judgement
    return judge(program)


class _Branches:
    """Depth-first search over the possible normals of degenerate contact points.

    It stores the motion that it proves.

    Each clause is a list of alternative pushes, one alternative for each extreme normal of an
    exact point. `inner` is set after a branch on an inner point of a line.
    """

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
        """Whether the assembly is stable for every choice of normals; None if undecided."""
        stack = [base]
        while stack:
            program = stack.pop()
            self.programs += 1
            if self.programs > PROGRAMS:
                return None
            judgement = _judge_branch(program)
            if judgement.stable:
                continue
            if judgement.stable is None or judgement.motion is None:
                return None
            motion = judgement.motion.motion
            entered = self._violated_clause(program, motion)
            if entered is None:
                return self._store_motion(judgement, motion)
            stack += [with_pushes(program, push) for push in entered]
        return None if self.inner else True

    def _violated_clause(self, program: Program, motion: Array) -> list[PossibleContacts] | None:
        """Possible contacts at the degenerate point that a motion violates most; or None."""
        inner_points = [
            [pushes.take([row]) for row in range(len(pushes))]
            for pushes in between(program, self.contacts, motion)
        ]
        clauses = self.clauses + inner_points
        # a point is open if the motion opens along any of its normals
        opening = [max(float(openings(program, p, motion)[0]) for p in c) for c in clauses]
        if min(opening, default=0.0) >= -ENTERS:
            return None
        worst = int(np.argmin(opening[: len(self.clauses)]))
        if opening[worst] >= -ENTERS:
            worst, self.inner = int(np.argmin(opening)), True
        return clauses[worst]

    def _store_motion(self, judgement: Judgement, motion: Array) -> bool | None:
        """Store a motion as the proof and return False; return None if it is no proof."""
        program = allowed_program(self.assembly, self.contacts, motion)
        if program is None:
            return None
        proof = check_motion(program, motion)
        if not proof.holds:
            return None
        self.program = program
        self.judgement = Judgement(False, None, proof, judgement.solvers)
        return False
