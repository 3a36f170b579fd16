"""Second-order answer for an assembly, combined from the answers for its clusters.

1  parts that rest on level faces alone are free, at any size (`level_rest`)
2  forces that leave no motion neutral hold a cluster to first order (`held`)
3  otherwise the gaps of the cluster decide, up to a number of parts (`one_cluster`)

An assembly is balanced if any of its clusters is, else open if any is, else free if any is, else at
a minimum.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.arrays import Array, Mask
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.clusters import Cluster, clusters
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT, OF_JOINTS, POSSIBLE
from kilter.second_order.answer.second_order_answer import (
    LATE,
    SPENT,
    SecondOrder,
    open_answer,
)
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.joint_forms import of_joints
from kilter.second_order.gaps.stationary import stationary
from kilter.second_order.motions.bending import bending_bodies, round_rows
from kilter.second_order.motions.rolling import rolling_of, worst_rolling
from kilter.second_order.motions.sharp_points import sharp_points, with_sharp
from kilter.second_order.parts.cluster_states import joined_state
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.proofs.cluster_facts import ClusterFacts
from kilter.second_order.proofs.level_rest import Held, LevelRest, judge_held, level_rows
from kilter.second_order.proofs.second_order_recheck import (
    OFF_CENTRE,
    loads_off_centre,
    unmodelled_pairs,
    why_beyond,
    why_unmodelled,
)
from kilter.second_order.searches.critical import find_critical
from kilter.second_order.searches.energy_decision import EnergyDecision
from kilter.second_order.searches.level_rest_search import find_held, find_level_rest
from kilter.work import PER_EFFORT, Work

NEEDS_FRICTION = "the curvature of the energy was not examined, because the proof needs friction"
"""Reason of an open answer for a cluster that forces without friction do not balance."""
MOST_PARTS = 20
"""Largest number of free parts in a cluster that is decided by second derivatives of gaps."""
MOST_STRICT = 60
"""Largest number of free parts in such a cluster at level strict or at higher effort."""
MOST_IN_ALL = 120
"""Largest number of free parts in all clusters that are decided by second derivatives of gaps."""
WORK, LEAST_WORK = 1_250_000, 200_000
"""Most and least units of work for second derivatives of gaps, at effort 1.

The most is for up to `FEW_ROWS` contact rows and `FEW_PARTS` free parts; with more the work is in
inverse proportion to their number. So second order takes less than a fifth of each check of over a
second.
"""
FEW_ROWS, FEW_PARTS = 100, 20
CLUSTER_WORK = 30_000
"""Units of work for a cluster before its first program: features, surfaces and free motions."""
STRICT_WORK = 10.0
"""Factor of the work if the check requires level strict [-]."""
MOST_LEVEL = 10_000
"""Largest number of free parts for which a rest on level faces is tried."""
MOST_HELD = 250
"""Largest number of free parts for which it is tested whether forces leave no neutral motion."""


def find_second_order(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    forces: Array | None = None,
    *,
    work: Work | None = None,
    strict: bool = False,
    resting: Mask | None = None,
) -> SecondOrder | None:
    """Second-order answer for an assembly in equilibrium; None if no motion is neutral.

    Arguments: `forces` (K,) [N]; `resting` (N,).
    """
    if not program.free.any():
        return None
    work = _share(work or Work(), program, strict=strict)
    if work.late:
        return open_answer(LATE, program)
    groups = RigidGroups.of(assembly)
    if len(contacts.degenerate):
        program = with_sharp(program, contacts)
    whole = groups.merged(program, assembly)
    if not whole.free.any():
        return None
    if forces is not None:
        forces = np.append(forces, np.zeros(len(program.kind) - len(forces)))
        forces = forces[groups.between(program, assembly)] if groups.tied else forces
    search = _ClusterSearch(assembly, contacts, whole, forces, work)
    beyond = why_beyond(whole, assembly) or search.unmodelled
    at_once = None if beyond or resting is not None else search.by_forces(whole, forces)
    # a proof that round or jointed parts are held is part of the proof of the verdict
    bends = bool(round_rows(whole, contacts).any())
    if at_once is not None:
        return _of_parts(at_once, groups) if at_once.neutral or bends else None
    answers = tuple(
        search.answer(cluster)
        if resting is None or resting[cluster.program.free].all()
        else open_answer(NEEDS_FRICTION, cluster.program)
        for cluster in clusters(whole)
    )
    held = all(answer.state == "minimum" and not answer.neutral for answer in answers)
    if held and not bends:
        return None
    return _of_parts(_join_answers(answers), groups)


def _share(work: Work, program: Program, *, strict: bool) -> Work:
    """Work that second order may take, separate from the work of the check."""
    few = min(FEW_ROWS / max(len(program.kind), 1), FEW_PARTS / int(program.free.sum()), 1.0)
    units = max(WORK * few, LEAST_WORK)
    return work.beside(units * (STRICT_WORK if strict else 1.0) * work.allowed / PER_EFFORT)


def _of_parts(answer: SecondOrder, groups: RigidGroups) -> SecondOrder:
    """Convert an answer about rigid groups to one about parts, with a motion for each part."""
    if not groups.tied:
        return answer
    return replace(
        answer,
        motion=None if answer.motion is None else groups.spread(answer.motion),
        moving=np.flatnonzero(np.isin(groups.first, answer.moving)),
        clusters=tuple(_of_parts(cluster, groups) for cluster in answer.clusters),
    )


def with_rolling(
    second_order: SecondOrder, assembly: Assembly, contacts: ContactSet, program: Program
) -> SecondOrder:
    """Add the result about rolling to a balanced answer; return other answers unchanged."""
    answers = second_order.clusters or (second_order,)
    program = RigidGroups.of(assembly).merged(with_sharp(program, contacts), assembly)
    parted = clusters(program)
    if second_order.state != "balanced" or len(parted) != len(answers) or not program.mu.any():
        return second_order
    features = features_of(program, contacts)
    answers = tuple(
        replace(answer, rolling=rolling_of(cluster, features, assembly, answer.names_alone))
        if answer.state == "balanced"
        else answer
        for answer, cluster in zip(answers, parted, strict=True)
    )
    rollings = [answer.rolling for answer in answers if answer.rolling is not None]
    state = worst_rolling(rolling.state for rolling in rollings)
    worst = next(rolling for rolling in rollings if rolling.state == state)
    return replace(second_order, rolling=worst, clusters=answers if second_order.clusters else ())


class _ClusterSearch:
    """Search for the answers of all clusters; they share geometry and a work limit."""

    def __init__(
        self,
        assembly: Assembly,
        contacts: ContactSet,
        program: Program,
        forces: Array | None,
        work: Work,
    ) -> None:
        self.assembly, self.contacts, self.program = assembly, contacts, program
        self.forces, self.work = forces, work
        self.facts = ClusterFacts(
            assembly, contacts, program, lambda: features_of(program, contacts, recognised=True)
        )
        self.parts_so_far = 0
        self.off, self.slanted = loads_off_centre(assembly, program)
        self.unmodelled = unmodelled_pairs(assembly, contacts)

    def answer(self, cluster: Cluster) -> SecondOrder:
        """Second-order answer for a cluster."""
        program, count = cluster.program, int(cluster.program.free.sum())
        why = why_unmodelled(self.assembly, self.unmodelled, program.free)
        why = why or why_beyond(program, self.assembly)
        if why:
            return open_answer(why, program)
        if count < self.program.free.sum():
            forces = None if self.forces is None else self.forces[cluster.rows]
            answer = self.by_forces(program, forces)
            if answer is not None:
                return answer
        fall = self._fall_of_rounds(cluster)
        if fall is not None:
            return fall
        most = MOST_PARTS if self.work.allowed <= WORK else MOST_STRICT
        if count > most:
            return open_answer(f"more than {most} free parts touch each other", program)
        self.parts_so_far += count
        if self.parts_so_far > MOST_IN_ALL:
            why = f"more than {MOST_IN_ALL} parts would need second derivatives of their gaps"
            return open_answer(why, program)
        answer = None if self.work.over else self._by_gaps(cluster)
        if answer is None or (answer.state == "open" and self.work.over):
            return open_answer(LATE if self.work.late else SPENT, program)
        return answer

    def _fall_of_rounds(self, cluster: Cluster) -> SecondOrder | None:
        """Fall of round or jointed parts alone, while all other parts are held; None without one.

        Held parts only take motions away, so it is a fall of the cluster, whatever stands beside.
        """
        program = cluster.program
        certain = np.isin(program.kind, (CONTACT, *OF_JOINTS))
        if self.forces is None or not round_rows(program, self.contacts).any():
            return None
        forces = self.forces[cluster.rows][certain]
        bending = bending_bodies(
            self.assembly, self.contacts, program.taking(certain), forces, curves=True
        ).bending
        if bending[program.free].all() or not bending.any():
            return None
        # imported late: level faces and held parts do not need these modules
        from kilter.second_order.answer.one_cluster import answer_alone

        facts = self.facts.of_cluster(cluster)
        falls = []
        for part in clusters(replace(program, free=bending)):
            few = part.program.free.sum() <= MOST_PARTS and not self.off[part.program.free].any()
            if few and not self.work.over:
                answer = answer_alone(facts.of_cluster(part), work=self.work)
                falls += [answer] if answer.state == "balanced" else []
        if not falls:
            return None
        steepest = max(falls, key=lambda fall: fall.rate or 0.0)
        motion = np.sum([fall.motion for fall in falls if fall.motion is not None], axis=0)
        moving = np.sort(np.concatenate([fall.moving for fall in falls]))
        return replace(steepest, motion=motion, moving=moving, alone=True)

    def by_forces(self, program: Program, forces: Array | None) -> SecondOrder | None:
        """Answer from contact forces alone, if parts rest on horizontal faces or are held."""
        count = int(program.free.sum())
        jointed = bool(of_joints(program).any())
        if count <= MOST_LEVEL and not (jointed or self.slanted[program.free].any()):
            level, sharp = level_rows(program, self.contacts), None
            if len(self.contacts.degenerate):
                sharp = sharp_points(program, self.contacts)
            rest = find_level_rest(program, level, forces, sharp, work=self.work)
            if rest is not None:
                return _on_level(program, rest)
        if count <= MOST_HELD and forces is not None:
            certain = program.kind != POSSIBLE
            held = find_held(program.taking(certain), forces[certain])
            if held is not None:
                return _without_neutral(program, held)
        return None

    def _by_gaps(self, cluster: Cluster) -> SecondOrder:
        """Answer for a cluster from first and second derivatives of its contact gaps."""
        program = cluster.program
        certain = program.taking(program.kind != POSSIBLE)
        first = stationary(certain, np.zeros((len(certain.part_a), 12, 12)))
        critical = find_critical(first, work=self.work)
        if critical is not None and not critical.basis.shape[1]:
            held = Held(critical.forces * first.weight * certain.arm)
            if not judge_held(certain, held):
                return _without_neutral(program, held)
        if self.off[program.free].any():
            return open_answer(OFF_CENTRE, program)
        self.work.charge(CLUSTER_WORK)
        # imported late: level faces and held parts do not need these modules
        from kilter.second_order.answer.one_cluster import answer_alone

        return answer_alone(self.facts.of_cluster(cluster), critical=critical, work=self.work)


def _on_level(program: Program, rest: LevelRest) -> SecondOrder:
    """Answer "free" for parts that can slide and turn on horizontal faces without energy."""
    parts = np.flatnonzero(program.free)
    free = len(parts) * (1 if program.planar else 3)
    decision = EnergyDecision("minimum", free, free, 0, 0, rest)
    return SecondOrder(
        "free", free, free, 0, 0, None, rest.motion, parts, "", decision, program=program
    )


def _without_neutral(program: Program, held: Held) -> SecondOrder:
    """Answer "minimum" for parts whose contact forces exclude every neutral motion."""
    none = np.zeros(0, dtype=np.int64)
    decision = EnergyDecision("minimum", 0, 0, 0, 0, held)
    return SecondOrder("minimum", 0, 0, 0, 0, None, None, none, "", decision, program=program)


def _join_answers(answers: tuple[SecondOrder, ...]) -> SecondOrder:
    """Answer for an assembly from the answers for its clusters."""
    if len(answers) == 1:
        return answers[0]
    state = joined_state(answer.state for answer in answers)
    same = [answer for answer in answers if answer.state == state]
    first = max(same, key=lambda answer: answer.rate or 0.0) if state == "balanced" else same[0]
    motions = [answer.motion for answer in same if answer.motion is not None]
    moving = np.sort(np.concatenate([answer.moving for answer in same]))
    return replace(
        first,
        neutral=sum(answer.neutral for answer in answers),
        free=sum(answer.free for answer in answers),
        blocked=sum(answer.blocked for answer in answers),
        undecided=sum(answer.undecided for answer in answers),
        rate=_rate(same),
        motion=np.sum(motions, axis=0) if motions else None,
        moving=moving,
        clusters=answers,
    )


def _rate(same: list[SecondOrder]) -> float | None:
    """Fastest growth rate of balanced clusters, or slowest oscillation of minima [1/s]; or None.

    None if the oscillation of a minimum is unknown.
    """
    rates = [answer.rate for answer in same if answer.blocked or answer.state == "balanced"]
    known = [rate for rate in rates if rate is not None]
    if same[0].state == "balanced":
        return max(known, default=None)
    return min(known, default=None) if len(known) == len(rates) else None
