"""Survey of a scene: its clusters, and the state of each object by the rules of `kilter.scene`."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from kilter.analysis.check import CUT, check
from kilter.analysis.chosen_parts import chosen_parts
from kilter.analysis.decision.motion import falls_freely
from kilter.analysis.many.verdicts import DeferredVerdict, clusters_at_rest
from kilter.analysis.planning.order.sweeps import Sweeps
from kilter.analysis.scene_states.scene_graph import SceneGraph
from kilter.analysis.scene_states.scene_report import ObjectState, SceneObject, SceneReport
from kilter.analysis.settled_pose.straight_falls import falling_distance, touching_gap
from kilter.analysis.verdict.remarks import remarks
from kilter.analysis.verdict.verdict import Verdict
from kilter.arrays import Array, Index, Mask
from kilter.assembly import Assembly
from kilter.assembly.question import Question
from kilter.contact import ContactSet
from kilter.contact.common.patches import SAME_BODY, Overlap
from kilter.contact.kept_contacts import contacts_among, without_overlaps
from kilter.errors import InputError
from kilter.rigid import Pose
from kilter.tell.levels import REACHED, VerdictWord


def survey(asked: Question) -> SceneReport:
    """The report about a scene as it is; the question has its contacts."""
    assembly, contacts = asked.assembly, asked.contacts
    ends = None if asked.time_limit is None else asked.begun + asked.time_limit
    found = _Survey(assembly, contacts.of(assembly), asked.require, asked.effort, ends, asked.tell)
    found.judge()
    free = ~assembly.geometry.grounded
    objects = tuple(
        found.states[k] if is_free else found.entry(k, "held")
        for k, is_free in enumerate(free.tolist())
    )
    return SceneReport(
        objects=objects,
        require=asked.require,
        clusters=len(found.verdicts),
        gravity=assembly.gravity,
        friction=assembly.friction,
        units=assembly.units,
        warnings=(*_warnings(assembly, contacts), *((CUT,) if found.cut else ())),
        seconds=time.perf_counter() - asked.begun,
        assembly=assembly,
        contacts=contacts,
        verdicts=tuple(found.verdicts),
    )


def _warnings(assembly: Assembly, contacts: ContactSet) -> list[str]:
    """Warnings about the file and the geometry; overlaps are states of objects, not warnings."""
    quiet = replace(contacts, overlaps=(), open_pairs=())
    return remarks(assembly, quiet)


@dataclass(eq=False)
class _Survey:
    """The states of the objects of a scene while they are found."""

    assembly: Assembly
    contacts: ContactSet
    require: str
    effort: float
    ends: float | None
    tell: Callable[[str], None]
    states: dict[int, SceneObject] = field(default_factory=dict)
    verdicts: list[Verdict] = field(default_factory=list)
    cut: bool = False

    def __post_init__(self) -> None:
        self.graph = SceneGraph.of(self.assembly, self.contacts)
        self.sweeps = Sweeps(self.contacts)
        self.down: Array = self.assembly.down
        self.overlap = worst_overlaps(self.assembly, self.contacts)
        """The deepest overlap of each part that is the fault of one."""

    def entry(self, k: int, state: ObjectState, **more: Any) -> SceneObject:
        """A part with its state."""
        part = self.assembly.parts[k]
        geometry: Any = part.geometry or "as-drawn"
        units = self.assembly.units
        return SceneObject(name=part.name, state=state, geometry=geometry, units=units, **more)

    def judge(self) -> None:
        """Find the states of all free parts."""
        free = ~self.assembly.geometry.grounded
        for k, overlap in self.overlap.items():
            if overlap.why == SAME_BODY:
                self._overlapping(k)
        among = free.copy()
        among[list(self.states)] = False
        self.tell("floating objects")
        supported = self.graph.supported()
        loaded = np.zeros(len(free), dtype=bool)
        loaded[[self.assembly.index[load.part] for load in self.assembly.loads]] = True
        for cluster in self.graph.clusters(among, near=False):
            if not (supported[cluster].any() or loaded[cluster].any()):
                self._floating(cluster)
                among[cluster] = False
        clusters = self.graph.clusters(among, near=True)
        rests = self._at_rest_together(clusters)
        for number, cluster in enumerate(clusters, 1):
            if not rests[number - 1]:
                self.tell(f"cluster {number} of {len(clusters)}")
                self._judge_cluster(cluster)

    def _at_rest_together(self, clusters: list[Index]) -> Mask:
        """Give states to the clusters that are proved at once to be at rest; mask of them, (M,).

        The clusters must have flat faces and detected contacts only, and touch no part with a
        fault. Their full verdicts are computed at the first access.
        """
        rests = np.zeros(len(clusters), dtype=bool)
        if len(clusters) < FEWEST or self.require == "strict":
            return rests
        label = np.full(len(self.assembly), -1)
        for number, cluster in enumerate(clusters):
            label[cluster] = number
        label[np.isin(label, label[self._apart()])] = -1
        if not (label >= 0).any():
            return rests
        self.tell("clusters at rest")
        chosen, compact = np.unique(label[label >= 0], return_inverse=True)
        label[label >= 0] = compact
        rests[chosen] = clusters_at_rest(self.contacts, label)
        for k in np.flatnonzero(rests).tolist():
            self._at_rest(clusters[k], REACHED["stable"], ())
            known = {"verdict": VerdictWord.STABLE, "require": self.require}
            part_of_scene = partial(chosen_parts, self.assembly, self._with_beside(clusters[k]), [])
            self.verdicts.append(DeferredVerdict.of(known, part_of_scene, self._full_verdict))
        return rests

    def _apart(self) -> Index:
        """Free parts whose cluster is judged by itself: with joints, loads, round faces or faults.

        Parts that touch a part with a fault count, too.
        """
        assembly, geometry = self.assembly, self.assembly.geometry
        listed: list[Any] = [*assembly.joints, *assembly.bonds]
        listed += [*assembly.straps, *assembly.contacts]
        names = {name for entry in listed for name in entry.parts}
        names |= {load.part for load in assembly.loads}
        known = [assembly.index[name] for name in names if name in assembly.index]
        if self.states:
            faults = np.array([*self.states], dtype=np.int64)
            known += self.graph.beside(faults).tolist()
        odd = np.concatenate([geometry.surfaces.part, geometry.unknown.part, known]).astype(int)
        if assembly.planar:
            odd = np.arange(len(assembly))
        free: Index = odd[~geometry.grounded[odd]]
        return free

    def _full_verdict(self, sub: Assembly) -> Verdict:
        """The verdict of `check` about a cluster at rest."""
        contacts = contacts_among(self.contacts, sub)
        return check(sub, contacts=contacts, require=self.require, effort=self.effort)

    def _judge_cluster(self, cluster: Index) -> None:
        """Find the states of the parts of a cluster, and of what remains of it after faults."""
        waiting = [cluster]
        while waiting:
            members = waiting.pop()
            self._judge_members(members)
            left = np.zeros(len(self.assembly), dtype=bool)
            left[[k for k in members.tolist() if k not in self.states]] = True
            waiting += self.graph.clusters(left, near=True)

    def _judge_members(self, members: Index) -> None:
        """Find the states of at least some of the parts that are judged together."""
        limit = None if self.ends is None else self.ends - time.perf_counter()
        if limit is not None and limit <= 0:
            self.cut = True
            self._open(members, ())
            return
        sub, contacts, assumed = self._part_of_scene(members)
        names = tuple(self.assembly.names[k] for k in assumed)
        try:
            verdict = check(
                sub,
                contacts=contacts,
                require=self.require,
                effort=self.effort,
                time_limit=limit,
            )
        except InputError:
            if not self._overlapping_among(members):
                raise
            return
        self.verdicts.append(verdict)
        self.cut |= verdict.time_limit is not None
        if verdict.level is not None:
            self._at_rest(members, verdict.level, names)
        elif not self._falling(members, verdict, names):
            self._open(members, names)

    def _part_of_scene(self, members: Index) -> tuple[Assembly, ContactSet, list[int]]:
        """The members of a cluster with the parts beside them; also those that have a fault.

        Parts with a fault are held. Overlaps with them have no contact. A held part of the scene
        joins those that only a load supports.
        """
        chosen = self._with_beside(members)
        among = set(members.tolist())
        known = [k for k in chosen.tolist() if k in self.states and k not in among]
        sub = chosen_parts(self.assembly, chosen, known)
        if not sub.holds:
            held = np.flatnonzero(self.assembly.geometry.grounded)[:1]
            sub = chosen_parts(self.assembly, np.union1d(chosen, held), known)
        contacts = self.contacts
        if known:
            contacts = without_overlaps(contacts, known)
        return sub, contacts_among(contacts, sub), known

    def _with_beside(self, members: Index) -> Index:
        """The members of a cluster with the parts that touch them or are near, ascending."""
        return np.sort(np.concatenate([members, self.graph.beside(members)]))

    def _at_rest(self, members: Index, level: str, if_held: tuple[str, ...]) -> None:
        for k in members.tolist():
            if k in self.overlap:
                self._overlapping(k)
            else:
                self.states[k] = self.entry(k, "at-rest", level=level, if_held=if_held)

    def _overlapping(self, k: int) -> None:
        overlap, names = self.overlap[k], self.assembly.names
        other = overlap.ends[0] if overlap.ends[1] == k else overlap.ends[1]
        self.states[k] = self.entry(k, "overlaps", gap=-overlap.depth, other=names[other])

    def _overlapping_among(self, members: Index) -> bool:
        """Give the overlapping members their state; whether there are any."""
        faulty = [k for k in members.tolist() if k in self.overlap]
        for k in faulty:
            self._overlapping(k)
        return bool(faulty)

    def _floating(self, members: Index, if_held: tuple[str, ...] = ()) -> None:
        """Give a group of parts that touches nothing its height above the part below."""
        fall = falling_distance(self.assembly, self.sweeps, members, self.down)
        parts = self.assembly.parts
        for k in members.tolist():
            pose = parts[k].pose
            if k in self.overlap:
                self._overlapping(k)
            elif fall is None:
                self.states[k] = self.entry(k, "falls", motion="nothing is below it")
            else:
                other = parts[fall.other].name
                touching = touching_gap(self.assembly, self.contacts, fall)
                moved = Pose(pose.position + fall.distance * self.down, pose.rotation)
                found = {"gap": fall.distance, "other": other}
                if fall.distance <= touching:
                    # a round part that is sunk by less than its triangles show has no contact
                    state: ObjectState = "overlaps" if fall.distance < -touching else "open"
                    raised = moved if state == "overlaps" else None
                    self.states[k] = self.entry(k, state, pose=raised, **found)
                    continue
                self.states[k] = self.entry(k, "floats", pose=moved, if_held=if_held, **found)

    def _falling(self, members: Index, verdict: Verdict, if_held: tuple[str, ...]) -> bool:
        """Give states to the moving or overlapping parts of a cluster that does not hold.

        Returns False if no part of it has got a state.
        """
        index = verdict.assembly.index
        rows = np.array([index[self.assembly.names[k]] for k in members])
        motion = verdict.motion
        moves = motion.moves[rows]
        decided = verdict.verdict == "unstable"
        if not decided and self._overlapping_among(members):
            return True
        free_fall = moves & falls_freely(motion, self.assembly.gravity)[rows]
        drops = np.zeros(len(self.assembly), dtype=bool)
        drops[members[free_fall]] = True
        for group in self.graph.clusters(drops, near=False):
            self._floating(group, if_held)
        others = members[moves & ~free_fall]
        if not decided:
            self._open(others, if_held)
        for k in others.tolist() if decided else ():
            if k in self.overlap:
                self._overlapping(k)
            else:
                words = verdict.words(self.assembly.names[k]) or None
                self.states[k] = self.entry(k, "falls", motion=words, if_held=if_held)
        return bool(moves.any())

    def _open(self, members: Index, if_held: tuple[str, ...]) -> None:
        """Give parts the state open, with the nearest part whose contact is open."""
        names = self.assembly.names
        for k in members.tolist():
            if k in self.overlap:
                self._overlapping(k)
                continue
            pairs = [pair for pair in self.contacts.open_pairs if k in pair.ends]
            pair = min(pairs, key=lambda pair: abs(pair.gap or 0.0), default=None)
            other = gap = None
            if pair is not None:
                other = names[pair.ends[0] if pair.ends[1] == k else pair.ends[1]]
                gap = pair.gap
            self.states[k] = self.entry(k, "open", gap=gap, other=other, if_held=if_held)


def worst_overlaps(assembly: Assembly, contacts: ContactSet) -> dict[int, Overlap]:
    """The deepest overlap of each part to which an overlap is assigned."""
    left_open = {frozenset(pair.ends) for pair in contacts.open_pairs}
    worst: dict[int, Overlap] = {}
    overlaps = [pair for pair in contacts.overlaps if frozenset(pair.ends) in left_open]
    if not overlaps:
        return worst
    geometry = assembly.geometry
    low = np.minimum.reduceat(-geometry.vertices @ assembly.down, geometry.vertex_start[:-1])
    for overlap in overlaps:
        a, b = overlap.ends
        if geometry.grounded[a] or geometry.grounded[b]:
            k = b if geometry.grounded[a] else a
        elif abs(low[a] - low[b]) > overlap.depth * SAME_HEIGHT:
            k = a if low[a] > low[b] else b
        else:
            k = a if geometry.volume[a] < geometry.volume[b] else b
        if k not in worst or worst[k].depth < overlap.depth:
            worst[k] = overlap
    return worst


FEWEST = 4
"""Least number of clusters that are decided at once."""
SAME_HEIGHT = 1e-6
"""Difference of the lowest points of two equally high parts [depths of their overlap]."""
