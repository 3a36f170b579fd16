"""Movements of parts, and forces on them, along which a limit gains most: arrows of a figure."""

from __future__ import annotations

import numpy as np

from kilter.analysis.analysis_tolerances import NO_GAIN
from kilter.analysis.gradients.gradient import Gradient
from kilter.analysis.margins.tried_changes import moving_axes
from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.contact import ContactSet


def best_movements(assembly: Assembly, touching: ContactSet, gradient: Gradient) -> Array:
    """Gain of the limit per length in which each part moves along its contacts, shape (N, 3).

    The vector points where the limit gains most; it is 0 where no movement gains.
    """
    found = np.zeros((len(assembly.parts), 3))
    for k in np.flatnonzero(~assembly.geometry.grounded).tolist():
        axes = np.array(moving_axes(assembly, touching, k)).reshape(-1, 3)
        slopes = np.einsum("aj,js->as", axes, gradient.position[k])
        gains = _best_gains(slopes, gradient.of) * (not gradient.copied)
        least = NO_GAIN / float(assembly.geometry.size[k])
        found[k] = np.where(np.abs(gains) > least, gains, 0.0) @ axes
    return found


def best_forces(assembly: Assembly, gradient: Gradient) -> Array:
    """Gain of the limit per force on each part [1/N], shape (N, 3), as `best_movements`."""
    gains = _best_gains(gradient.load[:, :3], gradient.of)
    return np.where(assembly.geometry.grounded[:, None], 0.0, gains)


def _best_gains(slopes: Array, of: str) -> Array:
    """Gain toward the better side, with the sign of this side, of slopes to both sides (..., 2)."""
    sense = -1.0 if of == "friction" else 1.0
    up, down = sense * slopes[..., 1], -sense * slopes[..., 0]
    best = np.where(up >= down, np.maximum(up, 0.0), -np.maximum(down, 0.0))
    return np.where(np.isfinite(best), best, 0.0)
