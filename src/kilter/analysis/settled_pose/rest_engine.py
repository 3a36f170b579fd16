"""The engine that brings bodies to rest: hanging groups fall, then overlaps and gaps close."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from kilter.analysis.settled_pose.nearest_rest import find_nearest_rest
from kilter.analysis.settled_pose.rest import Rest, Step
from kilter.analysis.settled_pose.rigid_bodies import RigidBodies
from kilter.analysis.settled_pose.vertical_drop import drop_hanging
from kilter.contact import detect


def come_to_rest(bodies: RigidBodies, *, reach: float | None, tell: Callable[[str], None]) -> Rest:
    """Bring bodies to rest from their current poses.

    Arguments: `reach`: largest way of a part [length unit]; None: no limit.
    """
    tell("falls")
    fallen, _ = drop_hanging(bodies)
    contacts = detect.contacts(fallen.assembly())
    rest, _ = find_nearest_rest(fallen, contacts, reach=reach, tell=tell)
    if rest.state == "falls":
        rest = replace(rest, leaves=rest.parts)
    down = bodies.drawn.down
    ways = []
    for body in range(len(bodies.mass)):
        fell = float(np.linalg.norm(fallen.center[body] - bodies.center[body]))
        shift = rest.bodies.center[body] - fallen.center[body]
        turn = rest.bodies.rotation[body] @ fallen.rotation[body].T
        angle = float(np.degrees(np.arccos(np.clip((np.trace(turn) - 1) / 2, -1, 1))))
        steps = [Step("fell", fell, 0.0)] if fell > 0 else []
        if shift.any() and bodies.moves[body]:
            how = "fell" if shift @ down > 0.0 else "pushed-out"
            steps.append(Step(how, float(np.linalg.norm(shift)), angle))
        ways.append(tuple(steps))
    return replace(rest, ways=tuple(ways))
