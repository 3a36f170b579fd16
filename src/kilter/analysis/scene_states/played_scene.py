"""A scene on its rung of the ladder of assumptions: objects that are merely sunk come to rest.

Simulators let every contact sink. On the rung "play" an object whose way to its pose at rest is
within its play takes this pose (`kilter.analysis.assumptions`). The others stay as drawn, so that
their state is that of the file.
"""

from __future__ import annotations

from dataclasses import replace

from kilter.analysis.assumptions.assume import Assumed, assume
from kilter.analysis.assumptions.rungs import rung_of
from kilter.analysis.scene_states.scene_report import SceneReport
from kilter.analysis.scene_states.survey import survey
from kilter.analysis.settled_pose.settle import way_of
from kilter.assembly.assumption import DRAWN, PLAY
from kilter.assembly.question import Question


def played_scene(asked: Question) -> SceneReport:
    """The report about a scene on its rung; the question has its contacts."""
    rung = rung_of(asked, PLAY)
    drawn = survey(asked)
    if rung == DRAWN or (rung == PLAY and drawn.at_rest):
        return drawn
    found = assume(asked, rung, opens=False)
    if found.closed is None and not found.moved and not found.joints:
        return drawn
    report = _of_pose(asked, found)
    ways = found.ways
    objects = [replace(entry, way=way_of(ways.get(entry.name, ()))) for entry in report]
    return replace(report, objects=tuple(objects), assume=rung, drawn=asked.assembly,
                   assembly=found.assembly)  # fmt: skip


def _of_pose(asked: Question, found: Assumed) -> SceneReport:
    """The report about a pose, on its closed points if they prove that all objects rest."""
    if found.closed is not None:
        closed = found.closed.closed
        report = survey(asked.but(assembly=closed.assembly, contacts=closed.contacts))
        if report.at_rest:
            return report
    return survey(asked.but(assembly=found.assembly, contacts=found.contacts))
