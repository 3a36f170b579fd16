"""A small second engine: parts sink by translations alone, without friction.

In each round, a linear program moves the free parts as far along gravity as the gaps of the
candidate points allow, by at most a third of the reach. It uses `find_near_points` and
nothing else of the search for a pose at rest.
"""

import numpy as np
from scipy.optimize import linprog

from kilter import Assembly, Pose
from kilter.analysis.settled_pose.near_points import NearPoints, find_near_points

ROUNDS = 60
ASIDE = 1e-5
"""Price of a movement along an axis, over that of a movement along gravity [-]: parts do not sink
along a slope below it, so a part in a round hollow of radius r stays up to r ASIDE^2 / 2 too high.
"""
FINE = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
"""Tolerances of the program, in units of the reach and of the price [-]; 1e-7 by default."""


def sink(assembly: Assembly, reach: float) -> tuple[dict[str, np.ndarray], NearPoints]:
    """Shift of each free part until nothing sinks further, and the last candidate points."""
    free = np.flatnonzero(~assembly.geometry.grounded)
    column = np.full(len(assembly), -1)
    column[free] = np.arange(len(free))
    start = [part.pose.position for part in assembly.parts]
    down = assembly.down
    for _ in range(ROUNDS):
        points = find_near_points(assembly, reach, reach)
        if not len(points):
            break
        rates = np.zeros((len(points), len(free), 3))
        for part, sign in ((points.part_a, -1.0), (points.part_b, 1.0)):
            rows = np.flatnonzero(column[part] >= 0)
            rates[rows, column[part[rows]]] += sign * points.normal[rows]
        rows = rates.reshape(len(points), 3 * len(free))
        aside = ASIDE - np.tile(down, len(free))
        answer = linprog(
            np.concatenate([aside, aside + 2 * np.tile(down, len(free))]),
            A_ub=np.concatenate([-rows, rows], axis=1),
            b_ub=points.gap / reach,
            bounds=(0, 1 / 3),
            options=FINE,
        )
        assert answer.success, answer.message
        step = reach * (answer.x[: 3 * len(free)] - answer.x[3 * len(free) :]).reshape(-1, 3)
        for k, move in zip(free.tolist(), step, strict=True):
            part = assembly.parts[k]
            place = Pose(part.pose.position + move, part.pose.rotation)
            assembly = assembly.with_pose(part.name, place)
        if np.abs(step @ down).max() < 1e-12 * reach:
            break
    shift = {assembly.names[k]: assembly.parts[k].pose.position - start[k] for k in free.tolist()}
    return shift, points
