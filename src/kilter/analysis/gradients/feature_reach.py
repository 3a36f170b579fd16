"""The distance over which the same features of parts touch, to first order.

A corner of a contact polygon moves relative to the outlines that do not pass through it. Where it
reaches such an outline, the polygon gains or loses a corner, and derivatives change.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.gradients.contact_rates import Outlines
from kilter.analysis.gradients.limit_power import LimitPower, row_rates
from kilter.arrays import TINY, Array

NEAR = 1e-7
"""Corners nearer to an outline lie on it [size of the part]."""


def feature_reach(power: LimitPower, vertices: Array) -> float:
    """Largest parameter up to which the same features touch; infinite without a limit.

    Arguments: `vertices` (V, 3): rates of the vertices per unit of the parameter.
    """
    moved, _ = row_rates(power, vertices)
    steps = [_reach(power, outlines, moved, vertices) for outlines in power.rates.outlines]
    return min(steps, default=np.inf)


def _reach(power: LimitPower, outlines: Outlines, moved: Array, vertices: Array) -> float:
    """The same for the corners and outlines of a patch."""
    if not len(outlines.part):
        return np.inf
    geometry, program = power.geometry, power.solved.program
    ends = geometry.vertices[outlines.edge]
    along = ends[:, 1] - ends[:, 0]
    size = np.maximum(np.einsum("ij,ij->i", along, along), TINY)
    arm = program.point[outlines.rows][:, None] - ends[:, 0]
    share = np.einsum("kij,ij->ki", arm, along) / size
    rates = vertices[outlines.edge]
    speed = (1 - share)[:, :, None] * rates[:, 0] + share[:, :, None] * rates[:, 1]
    gap = -np.einsum("kij,ij->ki", arm, outlines.across)
    closing = np.einsum("kij,ij->ki", moved[outlines.rows][:, None] - speed, outlines.across)
    inside = gap > NEAR * geometry.size[outlines.part]
    steps = np.where(inside & (closing > 0), gap / np.maximum(closing, TINY), np.inf)
    return float(steps.min(initial=np.inf))
