"""Figure of the speed factor along a path of the carrier, over time."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.show.canvas import INK, PAPER, legend, new_figure, title
from kilter.tell.palette import ROLES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_path_profile"]

FILL, EDGE, LIMIT, GRID = (
    ROLES[name].light for name in ("stable-fill", "stable", "unstable", "line")
)
HIGHEST = 4.0
"""Upper end of the axis, over the least factor [-]. Larger factors at other times are cut off."""


def draw_path_profile(answer: Mapping[str, Any]) -> Figure:
    """Draw an upper bound of the speed factor at each sample of a path, and the least of them.

    Arguments: `answer`: data of an answer of `kilter.transport` (`to_dict()`) with a path of
    limited speed. Raises `InputError` if matplotlib is not installed.
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    path = answer["speed"]
    time, least = np.array(path["times"]), path["factor"]
    top = HIGHEST * max(least, 1.0)
    bounds = np.array([top if value is None else value for value in path["factors"]])
    figure = new_figure(8.0, 4.6)
    axes = figure.add_axes((0.09, 0.24, 0.88, 0.58))
    axes.set(xlim=(time[0], time[-1]), ylim=(0.0, min(top, 1.1 * float(bounds.max()))))
    axes.grid(color=GRID, linewidth=0.8)
    low = path["slowest"]
    axes.axhspan(low, least, color=FILL, alpha=0.45, linewidth=0)
    axes.plot(time, bounds, color=EDGE, linewidth=1.6)
    axes.axhline(1.0, color=INK, linewidth=1.0, linestyle=(0, (4, 3)))
    axes.plot([path["time"]], [least], "o", color=LIMIT, markersize=6, clip_on=False)
    for spine in axes.spines.values():
        spine.set_color(GRID)
    axes.set_facecolor(PAPER)
    axes.tick_params(colors=INK, labelsize=8)
    axes.set_xlabel("time in the file [s]", fontsize=9, color=INK)
    axes.set_ylabel("speed factor [-]", fontsize=9, color=INK)
    title(figure, answer["sentence"], "stable" if answer["carried"] else "unstable")
    entries: list[tuple[Any, str]] = [
        (Patch(facecolor=FILL, edgecolor=FILL), "carried over the whole path"),
        (Line2D([], [], color=EDGE, linewidth=1.6), "upper bound at each sample"),
        (Line2D([], [], color=INK, linewidth=1.0, linestyle=(0, (4, 3))), "speed of the file"),
        (Line2D([], [], color=LIMIT, marker="o", linestyle="none"), "a part moves first"),
    ]
    legend(figure, entries)
    return figure
