"""A settled scene: the objects come to rest, and each state follows from the verified pose.

1. The engine of `kilter.settle` brings the objects to rest. Objects that are drawn twice stay as
   they are drawn.
2. The objects with a pose are judged on forces at closed points alone, cluster by cluster.
3. If some of these do not reach the required level, or if others have no pose, the scene is also
   judged on all contacts that kilter detects in the pose. The better state of each object counts.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from kilter.analysis.chosen_parts import chosen_parts
from kilter.analysis.scene_states.scene_report import SceneObject, SceneReport
from kilter.analysis.scene_states.survey import survey, worst_overlaps
from kilter.analysis.settled_pose.closing_motion import closed_up
from kilter.analysis.settled_pose.rest import RestResult
from kilter.analysis.settled_pose.rest_verification import closed_parts, parts_without_rest
from kilter.analysis.settled_pose.rigid_bodies import rigid_bodies
from kilter.analysis.settled_pose.settle import rest_of, way_of
from kilter.assembly import Assembly
from kilter.assembly.question import Question
from kilter.contact import ContactSet, detect
from kilter.contact.common.patches import SAME_BODY
from kilter.contact.kept_contacts import contacts_among
from kilter.tell.levels import holds, level_rank
from kilter.work import stop_after

LEAVES = "leaves the scene"
"""Motion of an object that comes to rest nowhere."""


def settled_scene(asked: Question) -> SceneReport:
    """The report about a scene after its objects have come to rest."""
    with stop_after(asked.seconds_left):
        drawn, asked = asked.assembly, asked.but(time_limit=None)
        contacts = detect.touching(asked)
        once = _drawn_once(drawn, contacts)
        if once is not drawn:
            contacts = contacts_among(contacts, once)
        bodies = rigid_bodies(once, ())
        rest = rest_of(bodies, contacts, reach=None, tell=asked.tell)
        asked.tell("states")
        rest, first = _judged(rest, asked)
        good = _resting(first)
        after = _in_poses(drawn, once, rest)
        free = [part.name for part in drawn if not part.grounded]
        second = None
        if not all(name in good and holds(good[name].level, asked.require) for name in free):
            second = survey(asked.but(assembly=after, contacts=detect.contacts(after)))
        return _report(drawn, after, rest, (good, first, second), asked)


def _drawn_once(assembly: Assembly, contacts: ContactSet) -> Assembly:
    """The assembly without the objects that lie in the place of an equal object."""
    worst = worst_overlaps(assembly, contacts.of(assembly))
    double = [k for k, overlap in worst.items() if overlap.why == SAME_BODY]
    if not double:
        return assembly
    return chosen_parts(assembly, np.setdiff1d(np.arange(len(assembly)), double), [])


def _in_poses(drawn: Assembly, once: Assembly, rest: RestResult) -> Assembly:
    """The drawn assembly with the poses of the engine; itself if no part moved."""
    if not rest.bodies.movements().any():
        return drawn
    if once is drawn:
        return replace(rest.bodies, drawn=drawn).assembly()
    poses = {part.name: part.pose for part in rest.bodies.assembly()}
    parts = [replace(part, pose=poses.get(part.name, part.pose)) for part in drawn]
    return replace(drawn, parts=parts)


def _judged(rest: RestResult, asked: Question) -> tuple[RestResult, SceneReport | None]:
    """The result of the engine and its states on closed points; closed up if more objects rest."""
    first = _on_closed_points(rest, asked)
    claimed = ~parts_without_rest(rest) & ~rest.bodies.drawn.geometry.grounded
    if len(_resting(first)) < claimed.sum():
        closed = closed_up(rest)
        again = None if closed is None else _on_closed_points(closed, asked)
        if closed is not None and len(_resting(again)) > len(_resting(first)):
            return closed, again
    return rest, first


def _resting(report: SceneReport | None) -> dict[str, SceneObject]:
    """The objects at rest, by name."""
    return {} if report is None else {e.name: e for e in report if e.state == "at-rest"}


def _on_closed_points(rest: RestResult, asked: Question) -> SceneReport | None:
    """The states of the objects with a pose, on forces at closed points alone.

    Overlapping objects are left out; None without points.
    """
    settled = rest.bodies.assembly()
    chosen = ~parts_without_rest(rest)
    if rest.points is None or settled.geometry.grounded[chosen].all():
        return None
    closed, detected = closed_parts(rest, settled, chosen, None, asked)
    while closed.fault:
        names = {closed.assembly.names[k] for k in closed.overlapping}
        now = np.array([part.name in names and not part.grounded for part in settled.parts])
        chosen &= ~now
        if not now.any() or settled.geometry.grounded[chosen].all():
            return None
        closed, detected = closed_parts(rest, settled, chosen, detected, asked)
    return survey(asked.but(assembly=closed.assembly, contacts=closed.contacts))


def _report(
    drawn: Assembly,
    after: Assembly,
    rest: RestResult,
    found: tuple[Mapping[str, SceneObject], SceneReport | None, SceneReport | None],
    asked: Question,
) -> SceneReport:
    """The report from the states on closed points and on all contacts."""
    good, first, second = found
    base = first if second is None else second
    assert base is not None
    bodies = rest.bodies
    ways = {
        name: way_of(rest.ways[body])
        for name, body in zip(bodies.drawn.names, bodies.of_part.tolist(), strict=True)
    }
    objects = []
    for name in drawn.names:
        entry = base[name]
        ours = good.get(name)
        if ours is not None and level_rank(ours.level) >= level_rank(entry.level):
            entry = ours
        if name in rest.leaves and entry.state != "at-rest":
            entry = replace(entry, state="falls", motion=LEAVES, gap=None, other=None, pose=None)
        objects.append(replace(entry, way=ways.get(name, ())))
    warnings = base.warnings
    if rest.why and rest.state != "at-rest":
        warnings = (*warnings, f"not all objects came to rest: {rest.why}")
    verdicts = [] if first is None else [v for v in first.verdicts if v.level is not None]
    for verdict in () if second is None else second.verdicts:
        if not {part.name for part in verdict.assembly if not part.grounded} <= good.keys():
            verdicts.append(verdict)
    return replace(
        base,
        objects=tuple(objects),
        clusters=len(verdicts),
        settled=True,
        warnings=warnings,
        seconds=time.perf_counter() - asked.begun,
        assembly=after,
        verdicts=tuple(verdicts),
        drawn=drawn,
    )
