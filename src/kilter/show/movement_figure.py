"""Figure of small movements: the drawn assembly, and dashed outlines at magnified movements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.show.canvas import legend, title
from kilter.show.figures import NAMED, draw_picture
from kilter.show.overlay import GHOSTS, draw_displaced, draw_gravity, draw_names
from kilter.tell.numbers import number

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_movement", "largest_movements", "magnification"]

SHARE = 0.12
"""Length of the farthest movement in the figure, over the size of the picture [-]."""
MOST_TURN = 0.5
"""Largest magnified rotation [rad]."""


def magnification(movement: Array, size: float) -> float:
    """Factor by which movements, shape (N, 6), are magnified in a picture of a size [length unit].

    It is 1, 2 or 5 times a power of ten, and at least 1.

    Examples
    --------
    >>> magnification(np.array([[0.001, 0, 0, 0, 0, 0]]), 1.0)
    100.0
    """
    shift = float(np.linalg.norm(movement[:, :3], axis=1).max(initial=0.0))
    turn = float(np.linalg.norm(movement[:, 3:], axis=1).max(initial=0.0))
    most = min(SHARE * size / max(shift, 1e-300), MOST_TURN / max(turn, 1e-300), 1e9)
    power = 10.0 ** np.floor(np.log10(max(most, 1.0)))
    steps = [step for step in (1.0, 2.0, 5.0) if step * power <= max(most, 1.0)]
    return float(steps[-1] * power)


def largest_movements(movement: Array, count: int) -> Array:
    """Movements of the parts that shift most, shape (N, 6); 0 for the other parts.

    Examples
    --------
    >>> largest_movements(np.diag([1.0, 3.0, 2.0, 0.0, 0.0, 0.0]), 2)[:, :3].max(axis=1)
    array([0., 3., 2., 0., 0., 0.])
    """
    shift = np.linalg.norm(movement[:, :3], axis=1)
    kept = np.zeros_like(movement)
    most = np.argsort(-shift, kind="stable")[:count]
    kept[most] = movement[most]
    return kept


def draw_movement(
    assembly: Assembly,
    movement: Array,
    sentence: str,
    *,
    view: tuple[float, float] | None = None,
) -> Figure:
    """Draw an assembly with dashed outlines of its parts after magnified movements.

    Of many moved parts, those that shift most have an outline.

    Arguments: `movement` (N, 6): shift of the centre of mass of each part [length unit], and its
    rotation vector [rad]; `view`: azimuth and elevation of the eye [deg]. Raises `InputError` if
    matplotlib is not installed.
    """
    figure, axes, camera, size, entries, faces = draw_picture(assembly, view)
    if movement.any():
        factor = magnification(movement, size)
        words = "at rest" if factor == 1.0 else f"at rest, movements x {number(factor)}"
        drawn = largest_movements(movement, GHOSTS)
        if np.count_nonzero(movement.any(axis=1)) > GHOSTS:
            words += f", of the {GHOSTS} parts that move most"
        entries += draw_displaced(axes, assembly, camera, factor * drawn, words)
    if len(assembly.parts) <= NAMED:
        draw_names(axes, assembly, faces)
    draw_gravity(axes, camera)
    title(figure, sentence)
    legend(figure, entries)
    return figure
