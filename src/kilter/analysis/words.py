"""Verdicts and motions in words."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

__all__ = ["SENTENCES", "motion_words"]

Array = NDArray[np.float64]

SENTENCES = {
    ("stable", False): "Stable: it cannot start to move, however slippery the parts.",
    ("stable", True): (
        "Stable within the accuracy of the data: it cannot start to move, however slippery "
        "the parts."
    ),
    ("unstable", False): "Unstable: no contact forces can hold it; here is how it starts to move.",
    ("unstable", True): (
        "Unstable beyond the accuracy of the data: no contact forces can hold it; here is how "
        "it starts to move."
    ),
}
"""Sentence for a verdict, and whether the data are coarser than float64."""

SMALL = 1e-3
"""A component below this part of a motion is left out of the words."""


def motion_words(acceleration: Array, relative: Array, down: Array) -> str:
    """How a part starts to move, from its accelerations.

    Parameters
    ----------
    acceleration : ndarray, shape (6,)
        Linear [m/s^2] and angular [rad/s^2].
    relative : ndarray, shape (2,)
        Linear, and radius x angular, over gravity [-].
    down : ndarray, shape (3,)

    Examples
    --------
    >>> down = np.array([0., 0, -1])
    >>> motion_words(np.array([0, 0, -9.81, 0, 0, 0]), np.array([1.0, 0]), down)
    'falls freely at 1 g'
    >>> motion_words(np.array([4.9, 0, 0, 0, 0, 0]), np.array([0.4995, 0]), down)
    'slides +x at 0.4995 g'
    >>> motion_words(np.zeros(6), np.zeros(2), down)
    'stays'
    """
    linear, angular = float(relative[0]), float(relative[1])
    if max(linear, angular) == 0.0:
        return "stays"
    words = []
    if linear > SMALL * angular:
        words.append(_translation(acceleration[:3], linear, down))
    if angular > SMALL * linear:
        speed = float(np.linalg.norm(acceleration[3:]))
        words.append(f"turns about {_direction(acceleration[3:])} at {speed:.4g} rad/s^2")
    return " and ".join(words)


def _translation(linear: Array, size: float, down: Array) -> str:
    direction = linear / np.linalg.norm(linear)
    fall = float(direction @ down)
    if fall > 1 - 1e-9:
        verb = "falls freely" if abs(size - 1) < 1e-9 else "drops"
        return f"{verb} at {size:.4g} g"
    if fall < -1 + 1e-9:
        return f"rises at {size:.4g} g"
    verb = "slides" if abs(fall) < 1e-9 else "moves"
    return f"{verb} {_direction(linear)} at {size:.4g} g"


def _direction(vector: Array) -> str:
    """An axis by name where the vector lies along it, else its unit vector."""
    unit = vector / np.linalg.norm(vector)
    axis = int(np.abs(unit).argmax())
    if abs(unit[axis]) > 1 - 1e-9:
        return ("+" if unit[axis] > 0 else "-") + "xyz"[axis]
    x, y, z = (round(float(c), 3) + 0.0 for c in unit)
    return f"({x:g}, {y:g}, {z:g})"
