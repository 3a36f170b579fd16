"""Figures of lines of thrust, and of assemblies after a movement of their supports."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array, Index
from kilter.show.canvas import INK, PAPER
from kilter.show.figures import draw_picture, show_whole, side_view
from kilter.show.movement_scene import hinges_of, movement_factor, movement_words
from kilter.show.overlay import (
    FORCE,
    GHOSTS,
    HALO,
    draw_arrows,
    draw_outlines,
)
from kilter.show.solids import moved_points
from kilter.tell.numbers import number
from kilter.tell.palette import ROLES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from kilter.analysis.support_movement import SupportMovement
    from kilter.assembly import Assembly


THRUST = ((FORCE, "o"), (ROLES["limit"].light, "s"))
"""Colour and mark of the line of least and of greatest thrust."""
FLAT = 1e-6
"""Largest share of a motion out of a plane, at which the figure shows this plane [-]."""


def draw_thrust(
    assembly: Assembly,
    span: Array,
    lines: Sequence[tuple[Array | None, str]],
    sentence: str,
    *,
    view: tuple[float, float] | None = None,
) -> Figure:
    """Draw the lines of least and of greatest thrust, or a single line, over the parts.

    Arguments: `span` (3,): horizontal direction between the supports; `lines`: points of each line,
    shape (n, 3), or None for a line that does not exist, and its words in the legend; `view`:
    azimuth and elevation of the eye [deg], by default across the span.
    """
    view = view or side_view(assembly, np.cross(assembly.down, span))
    picture = draw_picture(assembly, view)
    _, axes, camera, _, entries, _ = picture
    for (colour, mark), (points, words) in zip(THRUST, lines, strict=False):
        style: dict[str, Any] = {
            "color": colour, "marker": mark, "markersize": 5.0, "markeredgecolor": PAPER,
            "linewidth": 1.9, "zorder": 5,
        }  # fmt: skip
        x, y = np.empty((2, 0)) if points is None else camera.flat(points).T
        axes.plot(x, y, color=PAPER, linewidth=1.9 + HALO, zorder=4)
        (line,) = axes.plot(x, y, **style)
        entries.append((line, words))
    return picture.completed(assembly, sentence)


def draw_support_movement(
    assembly: Assembly,
    found: SupportMovement,
    supports: Sequence[tuple[int, Array]],
    *,
    view: tuple[float, float] | None = None,
) -> Figure:
    """Draw an assembly after a magnified movement of its supports, with hinges and the drawn pose.

    Arguments: `supports`: each moved support and a point of it, shape (3,); `view`: azimuth and
    elevation of the eye [deg], by default across a plane motion.
    """
    motion, hinges = found.motion, hinges_of(assembly, found)
    if view is None:
        across = _normal(assembly, motion)
        view = None if across is None else side_view(assembly, across)
    factor = movement_factor(assembly, motion)
    large = factor * motion
    picture = draw_picture(assembly, view, large)
    figure, axes, camera, _, entries, _ = picture
    drawn = set(axes.get_children())
    order = np.argsort(-np.linalg.norm(motion[:, :3], axis=1), kind="stable")
    parts: Index = order[motion[order].any(axis=1)][:GHOSTS]
    entries += draw_outlines(axes, assembly, camera, parts, "as drawn")
    show_whole(figure, axes, [each for each in axes.get_children() if each not in drawn])
    if supports:
        index, starts = zip(*supports, strict=True)
        ends = moved_points(assembly, motion, np.array(starts), np.array(index))
        ways = ends - np.array(starts)
        most = float(np.linalg.norm(ways, axis=1).max())
        words = f"movement of supports, longest {number(most, 3)} {assembly.units}"
        entries += draw_arrows(axes, camera, np.array(starts), ways, factor * most, words)
    if hinges:
        index, points = zip(*hinges, strict=True)
        x, y = camera.flat(moved_points(assembly, large, np.array(points), np.array(index))).T
        style: dict[str, Any] = {
            "linestyle": "none", "marker": "o", "markersize": 8.0, "color": INK,
            "markeredgecolor": PAPER, "markeredgewidth": 1.2, "zorder": 6,
        }  # fmt: skip
        (dots,) = axes.plot(x, y, **style)
        entries.append((dots, "hinge" if len(hinges) == 1 else f"{len(hinges)} hinges"))
    return picture.completed(assembly, f"{found.sentence} {movement_words(found, factor)}")


def _normal(assembly: Assembly, motion: Array) -> Array | None:
    """Horizontal axis across the plane of a motion, shape (3,); None if no plane contains it."""
    size = assembly.geometry.radius[:, None]
    down = assembly.down
    turns = motion[:, 3:] * size
    level = motion[:, :3] - motion[:, :3] @ down[:, None] * down
    largest = max(float(np.abs(motion[:, :3]).max()), float(np.abs(turns).max()))
    # the axis of the rotations, or else across the horizontal translations
    axes = np.append(turns, np.cross(down, level), axis=0)
    axis = axes[np.linalg.norm(axes, axis=1).argmax()]
    length = float(np.linalg.norm(axis))
    if length <= FLAT * largest:
        return None
    axis = axis / length
    within = turns - turns @ axis[:, None] * axis
    out = max(abs(float(axis @ down)) * largest, float(np.abs(motion[:, :3] @ axis).max()))
    return axis if max(out, float(np.abs(within).max())) <= FLAT * largest else None
