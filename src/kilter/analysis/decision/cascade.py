"""The decision on an assembly: its verdict, how strong the statement is, and by which proof.

Every command calls `decide`. Each of its steps ends with a certificate that is verified:

1. certain contacts without friction: forces of equilibrium prove *stable*, whatever the friction
   and whatever further contacts exist. More forces only help an equilibrium to exist, and
   without friction every solution of the contact law has a.M a <= w.a <= 0. Second order then
   separates *balanced* from stable;
2. certain contacts in Coulomb's cones: forces of equilibrium, then the levels of friction
   (`kilter.friction.answer`), also with the open pairs as ordinary contacts;
3. the outer bound: a motion that no force of an open pair can stop proves *unstable*;
4. the normals of degenerate points, by branches (`degenerate_branches`);
5. fitted normals, and the accuracy of coordinates that a file states;
6. the open pairs that decide (`open_question`): *undecided*, with a question.

Only this package reads the doubts about contacts (`kilter.analysis.decision.doubts`).
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from kilter.analysis.decision.degenerate_branches import decide_degenerate
from kilter.analysis.decision.doubts import doubts_of
from kilter.analysis.decision.judge import Judgement, judge
from kilter.analysis.decision.open_question import OpenQuestion, ask_open
from kilter.analysis.decision.ordinary_contacts import (
    EQUILIBRIUM,
    PROVED,
    SETTLES,
    OpenTrial,
    can_be_tried,
    try_ordinary,
)
from kilter.arrays import Index
from kilter.assembly import Assembly
from kilter.contact import ContactSet
from kilter.contact.detect import touching_words
from kilter.contact.open_pairs import rigid_groups, still_open
from kilter.errors import some
from kilter.mechanics.certificate import check_forces
from kilter.mechanics.clusters import clusters
from kilter.mechanics.program import Program, build_program
from kilter.tell.levels import REQUIRE, level_of
from kilter.work import Work

if TYPE_CHECKING:
    from kilter.arrays import Mask
    from kilter.friction.answer import FrictionAnswer
    from kilter.second_order.answer.second_order_answer import SecondOrder


# Decision on an assembly: verdict, verdict level and evidence, as every command reports them.


Word = Literal["stable", "settles", "potentially-stable", "balanced", "unstable", "undecided"]


@dataclass(frozen=True, slots=True, eq=False)
class Decision:
    """The verdict on an assembly with its evidence, as `decide` returns it."""

    verdict: Word
    program: Program
    """The program against which the certificate is proved."""
    judgement: Judgement
    """The proof: forces of equilibrium, or a motion."""
    friction: FrictionAnswer | None = None
    """The guarantee of friction; None if the verdict does not rest on friction."""
    second_order: SecondOrder | None = None
    """The answer of second order; None if no cluster rests without friction."""
    reasons: tuple[str, ...] = ()
    """Reasons why the verdict is undecided, in words."""
    question: OpenQuestion | None = None
    """The open pairs that decide an undecided verdict."""
    trial: OpenTrial | None = None
    """The level with the open pairs as ordinary contacts, if friction guarantees a level."""
    units: float = 0.0
    """Work of the solvers for this decision (`kilter.work`) [units]."""

    @property
    def level(self) -> str | None:
        """Verdict level that the assembly reaches, except "strict"; None if it does not hold."""
        return level_of(self.verdict)


# Statements about contacts with fitted normals, at smooth faces that are meshed differently.


def rests_on_fits(program: Program, assembly: Assembly) -> bool:
    """Whether any contact between separate rigid bodies has a fitted, uncertain normal."""
    return len(_fitted_patches(program, assembly)) > 0


def _fitted_patches(program: Program, assembly: Assembly) -> Index:
    """Indices, without repeats, of patches with fitted normals between separate rigid bodies."""
    group = rigid_groups(assembly)
    rows = np.flatnonzero(program.doubt)
    rows = rows[group[program.part_a[rows]] != group[program.part_b[rows]]]
    return np.unique(program.source[rows])


def why_fits_leave_it_open(
    assembly: Assembly, contacts: ContactSet, certain: Program, work: Work
) -> tuple[str, ...]:
    """Explain why contacts with fitted normals leave an assembly undecided; empty if they do not.

    The certain contacts alone do not hold it.

    Returns one sentence if forces of equilibrium exist with the fitted contacts; otherwise empty.
    """
    program = build_program(assembly, contacts, fitted=True)
    if len(program.kind) == len(certain.kind) or not judge(program, work=work).stable:
        return ()
    worst = float(contacts.patch_doubt.max(initial=0.0))
    return (
        "forces that hold it exist, but they use fitted normals of curved faces, which are "
        f"accurate only to {np.degrees(worst):.1g} deg; friction above {worst:.2g} would decide it",
    )


def fits_left_out(assembly: Assembly, contacts: ContactSet, certain: Program) -> list[str]:
    """Warnings that name the pairs whose contacts were left out because their normals are fitted.

    Arguments: `certain`: program of the certain contacts, by `build_program`, with or without
    friction. Returns the warning, or an empty list if no contact is left out.
    """
    if not contacts.patch_doubt.any():
        return []
    every = build_program(assembly, contacts, fitted=True)
    out = np.setdiff1d(_fitted_patches(every, assembly), _fitted_patches(certain, assembly))
    if not len(out):
        return []
    names, worst = assembly.names, float(contacts.patch_doubt[out].max())
    pairs = np.unique(contacts.patch_parts[out], axis=0).tolist()
    return [
        "left out: contacts of curved faces whose fitted normals are accurate only to "
        f"{np.degrees(worst):.1g} deg; with friction above {worst:.2g} they would count: "
        f"{some([f'{names[a]!r} and {names[b]!r}' for a, b in pairs])}"
    ]


WEAK = "no forces of the certain contacts hold it"
NEEDS_FRICTION = "without friction the certain contacts do not hold it"


def decide(
    assembly: Assembly,
    contacts: ContactSet,
    *,
    require: str = REQUIRE,
    work: Work | None = None,
    known: Judgement | None = None,
    second_order: bool = True,
    question: bool = True,
    level_only: bool = False,
) -> Decision:
    """Decide which verdict level an assembly with these contacts reaches, up to a required level.

    Parameters
    ----------
    assembly : Assembly
        At least one part is held.
    contacts : ContactSet
        The contacts of this assembly.
    require : {"equilibrium", "settles", "proved", "strict"}
        The level at which the decision may stop. At "equilibrium" the guarantee of friction is
        not examined.
    work : Work, optional
        Work that the guarantee of friction may take, and the time limit of every step.
    known : Judgement, optional
        Judgement of the certain contacts with friction, if it exists already. It is used
        instead of step 2.
    second_order : bool
        Whether second order separates balanced from stable.
    question : bool
        Whether the deciding open pairs of an undecided assembly are searched for.
    level_only : bool
        Whether the caller needs only the answer whether the level `require` is reached: questions
        of friction that cannot change it are left out, and the decision may have a lower level
        than a complete decision above or below `require`.

    Examples
    --------
    >>> from kilter.contact import contacts
    >>> from kilter.scenes import scene
    >>> tower = scene("tower")
    >>> decide(tower, contacts(tower)).verdict
    'stable'
    """
    work = Work() if work is None else work
    before = work.total
    decision = _first_order(assembly, contacts, require, work, known, question, level_only)
    if decision.verdict == "unstable":
        reason = doubts_of(assembly, contacts).explain_motion(decision.program)
        if reason:
            decision = dataclasses.replace(decision, verdict="undecided", reasons=(reason,))
    elif second_order and decision.verdict == "stable" and decision.friction is None:
        work.fact("equilibrium", "it is stable to first order")
        decision = with_second_order(decision, assembly, contacts, require, work)
    elif second_order and decision.verdict in ("stable", "settles"):
        decision = _beside_friction(decision, assembly, contacts, require, work)
    return dataclasses.replace(decision, units=work.total - before)


def _first_order(
    assembly: Assembly,
    contacts: ContactSet,
    require: str,
    work: Work,
    known: Judgement | None,
    question: bool,
    level_only: bool = False,
) -> Decision:
    """Decide an assembly by first-order motions, as if its coordinates were exact."""
    program = build_program(assembly, contacts)
    smooth = program.frictionless
    judgement = judge(smooth, work=work)
    # equilibrium without friction proves stability with friction and with the open pairs, too
    if judgement.stable:
        return Decision("stable", smooth, judgement)
    smooth_verdict = judgement.stable
    if program is not smooth:
        if known is None:
            work.stage("equilibrium with friction")
            known = judge(program, work=work)
        judgement = known
    if judgement.stable is None:
        slides = (NEEDS_FRICTION,) if smooth_verdict is False else ()
        reason = _late_reason(contacts, *slides) if work.cut else _best_figures(judgement)
        return Decision("undecided", program, judgement, reasons=(reason,))
    if judgement.stable:
        work.fact("equilibrium", "forces that hold it exist")
        return _with_friction(
            assembly, contacts, program, judgement, require, work, level_only=level_only
        )
    work.fact("equilibrium", WEAK)
    outer = build_program(assembly, contacts, possible=True)
    # no open contacts: the motion is already proved against every contact
    if len(outer.part_a) == len(program.part_a):
        return Decision("unstable", program, judgement)
    bound = judge(outer, work=work)
    if bound.stable is False:
        return Decision("unstable", outer, bound)
    sharp = decide_degenerate(assembly, contacts)
    if sharp.program is not None and sharp.judgement is not None:
        return Decision("unstable", sharp.program, sharp.judgement)
    fits = why_fits_leave_it_open(assembly, contacts, program, work)
    pairs = None
    # pairs that were not examined may touch after all, so joining them is no useful question
    if question and not contacts.unexamined:
        pairs = _deciding_pairs(assembly, contacts, program, require, work)
    explained = pairs is not None or (fits and not contacts.unexamined)
    unclear = () if explained else (_unclear_reason(contacts, bound, work),)
    reasons = (*unclear, *fits, *sharp.words)
    return Decision("undecided", program, judgement, reasons=reasons, question=pairs)


def _deciding_pairs(
    assembly: Assembly, contacts: ContactSet, program: Program, require: str, work: Work
) -> OpenQuestion | None:
    """Find the open pairs on which the verdict depends, and the verdict if their parts are joined.

    Open pairs are pairs of parts whose contact the geometry leaves uncertain. None: no such pairs.
    """
    work.stage("open pairs")

    def decide_joined(joined: Assembly) -> tuple[str, str | None]:
        decision = _first_order(joined, contacts, require, work, None, True)
        return decision.verdict, decision.level

    return ask_open(assembly, contacts, program, decide_joined, work=work)


def _with_friction(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    judgement: Judgement,
    require: str,
    work: Work,
    *,
    level_only: bool,
) -> Decision:
    """Decide how surely friction holds an assembly for which balancing forces exist."""
    # imported late, since the import of scipy.optimize is slow
    from kilter.friction.answer import ask_friction, not_asked

    if rests_on_fits(program, assembly):
        # normals in doubt cannot exclude other motions, so only equilibrium is reported
        answer = ask_friction(program, work=work.beside(0.0))
        answer = dataclasses.replace(answer, guarantee="open", tries=())
        return Decision("potentially-stable", program, judgement, answer)
    if require == "equilibrium" or program.has_limits:
        return Decision("potentially-stable", program, judgement, not_asked(program))
    left_open = still_open(contacts.open_pairs, assembly)
    if not can_be_tried(left_open):
        # the open pairs limit the level to equilibrium, whatever the certain contacts guarantee
        limited = OpenTrial(EQUILIBRIUM, 0)
        answer = not_asked(program)
        return Decision("potentially-stable", program, judgement, answer, trial=limited)
    enough = require if level_only else None
    answer, trial = ask_friction(program, work=work, enough=enough), None

    def level(other: Program) -> int:
        if judge(other.frictionless, work=work).stable:
            return PROVED
        beside = work.beside(work.allowed)
        return _friction_level(ask_friction(other, work=beside, enough=enough))

    # the guarantee must also hold if the open pairs touch, because they may do so
    if _friction_level(answer) > EQUILIBRIUM:
        trial = try_ordinary(assembly, contacts, level)
        if trial.level < PROVED and answer.guarantee == "proved":
            answer = dataclasses.replace(answer, guarantee="open")
        if trial.level < SETTLES:
            answer = dataclasses.replace(answer, tries=())
    return Decision(_word_of(answer), program, judgement, answer, trial=trial)


def _friction_level(friction: FrictionAnswer) -> int:
    """Strength of the statement about friction: EQUILIBRIUM < SETTLES < PROVED, as an integer."""
    if friction.guarantee == "proved":
        return PROVED
    return SETTLES if friction.settles else EQUILIBRIUM


def _word_of(friction: FrictionAnswer) -> Word:
    """The verdict word of an assembly that only friction can hold."""
    if friction.guarantee == "proved":
        return "stable"
    return "settles" if friction.settles else "potentially-stable"


def with_second_order(
    decision: Decision, assembly: Assembly, contacts: ContactSet, require: str, work: Work
) -> Decision:
    """Extend a decision that holds without friction by second order (curvature).

    Second order separates balanced from stable: does a small push make it fall? It is stable if
    second order proves it, if friction is proved to hold it, or if no open motion bends.
    """
    # imported late, since the import is slow
    from kilter.second_order.answer.whole import find_second_order, with_rolling

    proof = decision.judgement.forces
    forces = None if proof is None else proof.forces
    second = find_second_order(
        assembly, contacts, decision.program, forces, work=work, strict=require == "strict"
    )
    if second is None or second.state in ("minimum", "free"):
        return dataclasses.replace(decision, second_order=second)
    program = build_program(assembly, contacts)
    second = with_rolling(second, assembly, contacts, program)
    if second.state == "balanced" and not second.held_by_friction:
        return dataclasses.replace(decision, verdict="balanced", second_order=second)
    return _with_push(decision, assembly, contacts, second, among=second.left)


def _beside_friction(
    decision: Decision, assembly: Assembly, contacts: ContactSet, require: str, work: Work
) -> Decision:
    """Extend a decision that needs friction by second order for the clusters that do not need it.

    Clusters do not touch each other, so each keeps the answer that it has alone.
    """
    # imported late, since the import is slow
    from kilter.second_order.answer.whole import find_second_order, with_rolling

    program, proof, second = build_program(assembly, contacts), decision.judgement.forces, None
    if proof is None or len(program.kind) != len(proof.forces):  # fitted normals
        return _with_push(decision, assembly, contacts, None)
    smooth, forces, friction = program.frictionless, proof.forces.copy(), proof.friction.copy()
    resting = np.zeros(len(program.names), dtype=bool)
    parted = clusters(smooth)
    for cluster in parted if len(parted) > 1 else ():
        judged = judge(cluster.program, work=work)
        if judged.stable and judged.forces is not None:
            resting |= cluster.program.free
            forces[cluster.rows], friction[cluster.rows] = judged.forces.forces, 0.0
    proof = check_forces(program, forces, friction)
    if resting.any() and proof.holds:
        second = find_second_order(
            assembly, contacts, smooth, proof.forces, work=work, strict=require == "strict",
            resting=resting,
        )  # fmt: skip
    if second is None:
        return _with_push(decision, assembly, contacts, None)
    # its proof shows that these clusters do not need friction
    judgement = dataclasses.replace(decision.judgement, forces=proof)
    decision = dataclasses.replace(decision, judgement=judgement)
    second = with_rolling(second, assembly, contacts, program)
    if second.state == "balanced" and not second.held_by_friction:
        return dataclasses.replace(decision, verdict="balanced", second_order=second)
    return _with_push(decision, assembly, contacts, second, among=second.left)


def _with_push(
    decision: Decision,
    assembly: Assembly,
    contacts: ContactSet,
    second: SecondOrder | None,
    *,
    among: Mask | None = None,
) -> Decision:
    """Lower a decision if a small push may make round or jointed parts fall, as far as is known.

    Arguments: `among` (N,): parts that second order leaves open; by default all.
    """
    # imported late, since the import is slow
    from kilter.second_order.answer.pushed import pushed_answer
    from kilter.second_order.motions.small_push import small_push

    proof = decision.judgement.forces
    if proof is None:
        return dataclasses.replace(decision, second_order=second)
    program = build_program(assembly, contacts)
    if len(program.kind) != len(proof.forces):  # fitted normals have no certain friction
        program = decision.program
    push = small_push(
        assembly, contacts, program, proof.forces, curves=decision.friction is None, among=among
    )
    if push.state == "holds":
        return dataclasses.replace(decision, second_order=second)
    word: Word = "balanced" if push.state == "falls" else "potentially-stable"
    second = pushed_answer(decision.program, push, second)
    return dataclasses.replace(decision, verdict=word, second_order=second)


def _best_figures(judgement: Judgement) -> str:
    """Errors of the best forces and of the best motion, in words, if neither of them is a proof."""
    residual = judgement.forces.residual if judgement.forces else float("nan")
    motion = judgement.motion
    ratio = "no motion"
    if motion:
        ratio = f"the best motion gains {motion.power:.2g} W and violates {motion.violation:.2g}"
    return (
        f"numerical errors prevent a proof (the best forces leave an imbalance of {residual:.2g} "
        f"of a part's weight, {ratio})"
    )


def _late_reason(contacts: ContactSet, *known: str) -> str:
    """Reason of an answer that the time limit ended, with the facts that are known already."""
    left = len(contacts.open_pairs)
    opened = ("1 pair is open" if left == 1 else f"{left} pairs are open",) if left else ()
    facts = ", ".join((touching_words(contacts), *opened, *known))
    return f"the time limit was reached; known so far: {facts}"


def _unclear_reason(contacts: ContactSet, bound: Judgement, work: Work) -> str:
    """Reason why an assembly is undecided although no open pair decides its verdict.

    `bound` is the judgement with all possible contacts.
    """
    if work.cut or contacts.unexamined:
        return _late_reason(contacts, WEAK)
    if bound.stable is None:
        return f"with every possible contact, {_best_figures(bound)}"
    if contacts.open_pairs:
        return "the open pairs, together with possible contacts at round rims, could hold it"
    return "a polygon replaces a round face: the polygon could hold it, but the circle might not"
