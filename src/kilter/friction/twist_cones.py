"""Cones of twists: how the directions in which a patch may slide are divided.

The twist of a patch, t in R^d (d = 1 in the plane, 2 at a point, 3 of a flat patch in space),
lies in one of 2^d orthants, or is 0. A cone is given by d unit generators, the columns of a
matrix; it is halved by the middle of two of them. Closed cones share their faces: every t
lies in at least one.
"""

from __future__ import annotations

from itertools import combinations, product

import numpy as np

from kilter.arrays import Array

__all__ = ["STICK", "Cone", "halves", "orthants", "sector", "widened", "width"]

Cone = Array
"""Generators as columns, shape (d, d); `STICK`, of size 0, for the twist 0."""

STICK: Cone = np.zeros((0, 0))
WIDEST = 0.9 * np.pi
"""A sector wider than this says nothing."""
STILL = 1e-9
"""A generator that moves a point less than this, relative to the others, leaves it at rest."""
ROUNDING = 1e-12
"""By how much cones and sectors are widened [rad]."""


def orthants(size: int) -> list[Cone]:
    """The 2^d cones between the axes."""
    return [np.diag(signs).astype(np.float64) for signs in product((1, -1), repeat=size)]


def width(cone: Cone) -> float:
    """The largest angle between two generators [rad]."""
    if cone.shape[1] < 2:
        return 0.0
    cosine = np.clip(cone.T @ cone, -1.0, 1.0)
    return float(np.arccos(cosine.min()))


def halves(cone: Cone) -> list[Cone]:
    """The two cones on both sides of the middle of the widest pair of generators."""
    pairs = list(combinations(range(cone.shape[1]), 2))
    i, j = min(pairs, key=lambda pair: float(cone[:, pair[0]] @ cone[:, pair[1]]))
    middle = cone[:, i] + cone[:, j]
    middle = middle / np.linalg.norm(middle)
    found = []
    for k in (i, j):
        half = cone.copy()
        half[:, k] = middle
        found.append(half)
    return found


def widened(cone: Cone) -> Cone:
    """A cone a little wider than this one, so that rounding leaves no gap between two."""
    middle = cone.mean(axis=1, keepdims=True)
    wider: Cone = cone + ROUNDING * (cone - middle)
    return wider


def sector(cone: Cone, lever: Array) -> tuple[Array, float] | None:
    """Middle and half width of the directions of ut = lever t for t in a cone, t not 0.

    None if ut may vanish or its directions span more than `WIDEST`.
    """
    moved = lever[:, : len(cone)] @ cone
    size = np.linalg.norm(moved, axis=0)
    if size.min() <= STILL * max(float(np.abs(lever).max()), 1e-300):
        return None
    unit = moved / size
    mean = unit.sum(axis=1)
    if np.linalg.norm(mean) <= STILL:
        return None
    along, across = unit.T @ mean, unit.T @ np.array([-mean[1], mean[0]])
    angle = np.arctan2(across, along)
    low, high = float(angle.min()), float(angle.max())
    if high - low > WIDEST:
        return None
    start = float(np.arctan2(mean[1], mean[0])) + (low + high) / 2
    return np.array([np.cos(start), np.sin(start)]), (high - low) / 2 + ROUNDING
