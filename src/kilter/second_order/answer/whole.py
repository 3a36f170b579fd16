"""What second order says of a whole assembly: of each of its clusters, joined.

1  what stands on level faces alone is free by proof (`level_rest`), at any size
2  forces that leave no motion neutral hold a cluster to first order: nothing to ask (`held`)
3  else, up to a number of parts, its gaps to second order (`one_cluster`)

An assembly is balanced where one of its clusters is, else open where one is, else free where one
is, else at a minimum.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact.contact_set import ContactSet
from kilter.mechanics.program import Program
from kilter.mechanics.rows import CONTACT
from kilter.second_order.answer.one_cluster import answer_alone
from kilter.second_order.answer.second_order_answer import (
    LATE,
    SPENT,
    SecondOrder,
    open_answer,
)
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.stationary import stationary
from kilter.second_order.motions.rolling import find_rolling, worst_rolling
from kilter.second_order.motions.sharp_points import sharp_points, with_sharp
from kilter.second_order.parts.clusters import Cluster, clusters, joined_state
from kilter.second_order.parts.rigid_groups import RigidGroups
from kilter.second_order.proofs.cluster_facts import ClusterFacts
from kilter.second_order.proofs.held import Held, judge_held
from kilter.second_order.proofs.level_rest import LevelRest, level_rows
from kilter.second_order.proofs.modelled import (
    OFF_CENTRE,
    loads_off_centre,
    why_beyond,
    why_unmodelled,
)
from kilter.second_order.searches.critical import find_critical
from kilter.second_order.searches.decide import Decision
from kilter.second_order.searches.held_search import find_held
from kilter.second_order.searches.level_rest_search import find_level_rest
from kilter.work import PER_EFFORT, Work

__all__ = ["MOST_IN_ALL", "MOST_PARTS", "find_second_order", "with_rolling"]

MOST_PARTS = 20
"""A cluster of up to this many free parts is asked for its second order, ..."""
MOST_IN_ALL = 120
"""... and clusters of up to this many together."""
MOST_STRICT = 60
"""Up to this many free parts in a cluster with level strict or a higher effort."""
WORK, LEAST_WORK = 1_250_000, 200_000
"""Most and least units of work for the gaps of an assembly at effort 1.

The most is for up to `FEW_ROWS` contact rows and `FEW_PARTS` free parts; with more the work falls
as one over their number. So second order stays below a fifth of each check of over a second.
"""
FEW_ROWS, FEW_PARTS = 100, 40
CLUSTER_WORK = 15_000
"""Units of a cluster before its first program: features, surfaces and free motions."""
STRICT_WORK = 10.0
"""Factor of the work with level strict."""
MOST_LEVEL = 10_000
"""Level faces are looked at for up to this many free parts."""
MOST_HELD = 250
"""Forces are asked whether they leave a motion neutral for up to this many free parts."""


def find_second_order(
    assembly: Assembly,
    contacts: ContactSet,
    program: Program,
    forces: Array | None = None,
    *,
    work: Work | None = None,
    strict: bool = False,
) -> SecondOrder | None:
    """What second order says of a place of equilibrium; None where no motion is neutral.

    Parameters
    ----------
    assembly : Assembly
    contacts : ContactSet
        Found in it.
    program : Program
        Of these contacts, without friction; forces of equilibrium are known to exist.
    forces : ndarray, shape (K,), optional
        Such forces [N].
    work : Work, optional
        Work of the check: second order takes a fixed amount for its effort, and keeps its time
        limit. Without, there is no limit.
    strict : bool
        Whether the check requires level strict, for which more work is done.
    """
    if not program.free.any():
        return None
    work = _share(work or Work(), program, strict=strict)
    if work.late:
        return open_answer(LATE, program)
    unmodelled = why_unmodelled(assembly, contacts)
    if unmodelled:
        return open_answer(unmodelled, program)
    groups = RigidGroups.of(assembly)
    program = with_sharp(program, contacts)
    whole = groups.merged(program, assembly)
    if not whole.free.any():
        return None
    if forces is not None:
        forces = np.append(forces, np.zeros(len(program.kind) - len(forces)))
        forces = forces[groups.between(program, assembly)] if groups.tied else forces
    search = _ClusterSearch(assembly, contacts, whole, forces, work)
    at_once = None if why_beyond(whole) else search.by_forces(whole, forces)
    if at_once is not None:
        return _of_parts(at_once, groups) if at_once.neutral else None
    found = tuple(search.answer(one) for one in clusters(whole))
    if all(one.state == "minimum" and not one.neutral for one in found):
        return None
    return _of_parts(_joined(found), groups)


def _share(work: Work, program: Program, *, strict: bool) -> Work:
    """The work that second order may take beside that of the first order."""
    few = min(FEW_ROWS / max(len(program.kind), 1), FEW_PARTS / int(program.free.sum()), 1.0)
    units = max(WORK * few, LEAST_WORK)
    return work.beside(units * (STRICT_WORK if strict else 1.0) * work.allowed / PER_EFFORT)


def _of_parts(found: SecondOrder, groups: RigidGroups) -> SecondOrder:
    """An answer of groups as one of their parts: what moves."""
    if not groups.tied:
        return found
    return replace(
        found,
        motion=None if found.motion is None else groups.spread(found.motion),
        moving=np.flatnonzero(np.isin(groups.first, found.moving)),
        clusters=tuple(_of_parts(one, groups) for one in found.clusters),
    )


def with_rolling(
    found: SecondOrder, assembly: Assembly, contacts: ContactSet, program: Program
) -> SecondOrder:
    """An answer that is balanced, with what friction makes of it.

    Parameters
    ----------
    found : SecondOrder
    assembly : Assembly
    contacts : ContactSet
    program : Program
        Of these contacts, with friction.
    """
    own = found.clusters or (found,)
    program = RigidGroups.of(assembly).merged(with_sharp(program, contacts), assembly)
    parted = clusters(program)
    if found.state != "balanced" or len(parted) != len(own) or not program.mu.any():
        return found
    features = features_of(program, contacts)
    asked = tuple(
        replace(one, rolling=find_rolling(part.program, features.take(part.rows)))
        if one.state == "balanced"
        else one
        for one, part in zip(own, parted, strict=True)
    )
    rolls = [one.rolling for one in asked if one.rolling is not None]
    state = worst_rolling(one.state for one in rolls)
    worst = next(one for one in rolls if one.state == state)
    return replace(found, rolling=worst, clusters=asked if found.clusters else ())


class _ClusterSearch:
    """What the clusters of an assembly share."""

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
        self.asked = 0
        self.off, self.slanted = loads_off_centre(assembly, program)

    def answer(self, cluster: Cluster) -> SecondOrder:
        """Of one cluster, where the whole has no answer at once."""
        program, count = cluster.program, int(cluster.program.free.sum())
        why = why_beyond(program)
        if why:
            return open_answer(why, program)
        if count < self.program.free.sum():
            forces = None if self.forces is None else self.forces[cluster.rows]
            found = self.by_forces(program, forces)
            if found is not None:
                return found
        most = MOST_PARTS if self.work.allowed <= WORK else MOST_STRICT
        if count > most:
            return open_answer(f"more than {most} free parts touch one another", program)
        self.asked += count
        if self.asked > MOST_IN_ALL:
            return open_answer(f"more than {MOST_IN_ALL} parts are to be looked at", program)
        found = None if self.work.over else self._alone(cluster)
        if found is None or (found.state == "open" and self.work.over):
            return open_answer(LATE if self.work.late else SPENT, program)
        return found

    def by_forces(self, program: Program, forces: Array | None) -> SecondOrder | None:
        """Steps 1 and 2 for a whole assembly or a cluster; None where they do not answer."""
        count = int(program.free.sum())
        if count <= MOST_LEVEL and not self.slanted[program.free].any():
            level, sharp = level_rows(program, self.contacts), sharp_points(program, self.contacts)
            rest = find_level_rest(program, level, forces, sharp, work=self.work)
            if rest is not None:
                return _on_level(program, rest)
        if count <= MOST_HELD and forces is not None:
            certain = program.kind == CONTACT
            held = find_held(program.taking(certain), forces[certain])
            if held is not None:
                return _without_neutral(program, held)
        return None

    def _alone(self, cluster: Cluster) -> SecondOrder:
        """By the gaps of its contacts, where forces do not leave it without neutral motions."""
        program = cluster.program
        certain = program.taking(program.kind == CONTACT)
        first = stationary(certain, np.zeros((len(certain.part_a), 12, 12)))
        critical = find_critical(first, work=self.work)
        if critical is not None and not critical.basis.shape[1]:
            held = Held(critical.forces * first.weight)
            if not judge_held(certain, held):
                return _without_neutral(program, held)
        if self.off[program.free].any():
            return open_answer(OFF_CENTRE, program)
        self.work.charge(CLUSTER_WORK)
        return answer_alone(self.facts.of_cluster(cluster), critical=critical, work=self.work)


def _on_level(program: Program, rest: LevelRest) -> SecondOrder:
    """Every part slides and turns freely on level faces."""
    parts = np.flatnonzero(program.free)
    free = len(parts) * (1 if program.planar else 3)
    decision = Decision("minimum", free, free, 0, 0, rest)
    return SecondOrder(
        "free", free, free, 0, 0, None, rest.motion, parts, "", decision, program=program
    )


def _without_neutral(program: Program, held: Held) -> SecondOrder:
    none = np.zeros(0, dtype=np.int64)
    decision = Decision("minimum", 0, 0, 0, 0, held)
    return SecondOrder("minimum", 0, 0, 0, 0, None, None, none, "", decision, program=program)


def _joined(found: tuple[SecondOrder, ...]) -> SecondOrder:
    """The answer of several clusters; that of one is its own."""
    if len(found) == 1:
        return found[0]
    state = joined_state(one.state for one in found)
    same = [one for one in found if one.state == state]
    first = max(same, key=lambda one: one.rate or 0.0) if state == "balanced" else same[0]
    motions = [one.motion for one in same if one.motion is not None]
    moving = np.sort(np.concatenate([one.moving for one in same]))
    return replace(
        first,
        neutral=sum(one.neutral for one in found),
        free=sum(one.free for one in found),
        blocked=sum(one.blocked for one in found),
        undecided=sum(one.undecided for one in found),
        rate=_rate(same),
        motion=np.sum(motions, axis=0) if motions else None,
        moving=moving,
        clusters=found,
    )


def _rate(same: list[SecondOrder]) -> float | None:
    """What falls fastest; of minima the slowest to swing, where all are known."""
    rates = [one.rate for one in same if one.blocked or one.state == "balanced"]
    known = [rate for rate in rates if rate is not None]
    if same[0].state == "balanced":
        return max(known, default=None)
    return min(known, default=None) if len(known) == len(rates) else None
