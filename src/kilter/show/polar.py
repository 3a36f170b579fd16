"""Polar figure of the horizontal carrier accelerations under which an assembly stays in place."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.show.canvas import INK, PAPER, legend, new_figure, title
from kilter.tell.palette import ROLES
from kilter.tell.transport_facts import least_limit

if TYPE_CHECKING:
    from matplotlib.figure import Figure


# Figure of the speed factor along a path of the carrier, over time.


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


RINGS = 4
"""Approximate number of rings of equal acceleration."""
ROOM = 1.15
"""Radius of the figure, over the largest carried acceleration [-]."""


def draw_polar(answer: Mapping[str, Any]) -> Figure:
    """Draw the boundary of the carried horizontal accelerations, seen from above.

    Arguments: `answer`: data of an answer of `kilter.transport` (`to_dict()`) with the key `polar`.
    Raises `InputError` if matplotlib is not installed.
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    polar = answer["polar"]
    points, limited = np.array(polar["points"]), np.array(polar["limited"])
    finite = points[limited] if limited.any() else points
    radius = ROOM * max(float(np.linalg.norm(finite, axis=1).max()), 1e-9)
    figure = new_figure(7.0, 6.6)
    axes = figure.add_axes((0.1, 0.13, 0.86, 0.74))
    axes.set(xlim=(-radius, radius), ylim=(-radius, radius), aspect="equal")
    for ring in _rings(radius):
        around = np.linspace(0, 2 * np.pi, 181)
        axes.plot(ring * np.cos(around), ring * np.sin(around), color=GRID, linewidth=0.8)
    axes.fill(*points.T, color=FILL, alpha=0.45, linewidth=0)
    axes.plot(*np.vstack([points, points[:1]]).T, color=EDGE, linewidth=1.6)
    entries: list[tuple[Any, str]] = [
        (Patch(facecolor=FILL, edgecolor=EDGE), "carried: forces that hold it exist")
    ]
    least = least_limit(answer)
    if least is not None and least["g"] is not None:
        end = np.array(polar["axes"]) @ np.array(least["direction"]) * least["g"]
        axes.annotate(
            "",
            end,
            (0, 0),
            arrowprops={"arrowstyle": "-|>", "color": LIMIT, "linewidth": 1.8},
        )
        entries.append((Line2D([], [], color=LIMIT, linewidth=1.8), "least acceleration"))
    axes.plot(0, 0, "o", color=INK, markersize=3.5)
    for spine in axes.spines.values():
        spine.set_color(GRID)
    axes.set_facecolor(PAPER)
    axes.tick_params(colors=INK, labelsize=8)
    names = [_axis_name(axis) for axis in polar["axes"]]
    axes.set_xlabel(f"acceleration along {names[0]} [g]", fontsize=9, color=INK)
    axes.set_ylabel(f"acceleration along {names[1]} [g]", fontsize=9, color=INK)
    title(figure, answer["sentence"], "stable" if answer["verdict"] != "unstable" else "unstable")
    legend(figure, entries)
    return figure


def _rings(radius: float) -> list[float]:
    """Radii of the rings of the figure, at round numbers."""
    step = 10.0 ** np.floor(np.log10(radius / RINGS))
    for factor in (1.0, 2.0, 5.0, 10.0):
        if radius / (factor * step) <= RINGS:
            return list(np.arange(factor * step, radius, factor * step))
    return []


def _axis_name(axis: list[float]) -> str:
    """Name of the coordinate axis along a direction; for any other direction, its components."""
    largest = int(np.abs(axis).argmax())
    if abs(axis[largest]) > 1 - 1e-9:
        return ("" if axis[largest] > 0 else "-") + "xyz"[largest]
    return "(" + ", ".join(f"{value:.3g}" for value in axis) + ")"
