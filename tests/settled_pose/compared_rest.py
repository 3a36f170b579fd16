"""Compare the answer of `kilter.settle` with a known pose at rest."""

import numpy as np
from play_scenes import KnownRest

import kilter

CLOSE = 1e-6
"""Largest error of a position over the size of the assembly [-], and of an angle [rad]."""


def rest_error(known: KnownRest, answer: kilter.Settled, close: float = CLOSE) -> str:
    """Difference between an answer and the known pose at rest; empty if there is none."""
    if set(answer.leaves) != set(known.leaves):
        return f"{answer.state}: {answer.leaves} leave, known are {known.leaves} {answer.why}"
    state = "at-rest" if not known.leaves else "partly" if known.shift else "falls"
    if answer.state != state:
        return f"{answer.state} instead of {state}: {answer.why} {answer.parts}"
    vertices = known.assembly.geometry.vertices
    size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
    for name, shift in known.shift.items():
        movement = answer.movement[known.assembly.index[name]]
        error = float(np.linalg.norm(movement[:3] - shift))
        if error > close * size:
            return f"{name} moved by {movement[:3]}, known is {shift}: {error / size:.1e} of size"
        turn, angle = float(np.linalg.norm(movement[3:])), known.angle.get(name, 0.0)
        if abs(turn - angle) > close:
            return f"{name} turned by {turn:.3g} rad, known is {angle:.3g}"
    return ""
