"""The steps of a plan as a sheet of small pictures, for print: one a step.

A part stands back from its seat along its way, an arrow before it; what a hand holds has blue
stripes and edges. Colours are those of the page.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.rigid import Pose
from kilter.show.canvas import INK, PAPER, blank, label, legend, title
from kilter.show.colours import assembly_colours
from kilter.show.figures import camera_of
from kilter.show.overlay import MOTION
from kilter.show.painter import Camera
from kilter.show.shapes import placed
from kilter.show.solids import GRIP, draw_parts

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from kilter.assembly import Assembly

__all__ = ["draw_plan"]

WIDTH = 7.0
"""Of the sheet [inch]."""
HIGH = (0.4, 1.2)
"""Of a picture, at least and at most [its width]."""
ABOVE, BELOW = 0.78, 0.42
"""For the sentence, for the legend [inch]."""
WORDS = 0.33
"""Below a picture [inch]."""
BACK = 1.5
"""How far from its seat a part stands [its bounding radius]."""
MARGIN = 0.07
"""Around the assembly [its size]."""
REACH = 0.12
"""Held parts are shown this much farther than the free ones reach [size of the free ones]."""


def draw_plan(
    assembly: Assembly,
    answer: Mapping[str, Any],
    *,
    view: tuple[float, float] | None = None,
) -> Figure:
    """A picture a step, from left to right.

    Parameters
    ----------
    assembly : Assembly
    answer : mapping
        Data of a plan that was found.
    view : (float, float), optional
        Azimuth (to the right of -y) and elevation of the eye [deg], with gravity down.
    """
    steps = answer["steps"]
    columns = min(len(steps), 3 if len(steps) <= 9 else 4 if len(steps) <= 16 else 6)
    rows = math.ceil(len(steps) / columns)
    wide = WIDTH / columns
    camera = camera_of(assembly, view)
    low, high = _limits(assembly, camera, steps)
    right, up = high - low
    high_picture = wide * float(np.clip(up / right, *HIGH))
    tall = high_picture + WORDS
    height = ABOVE + rows * tall + BELOW
    figure = blank(WIDTH, height)
    colours = assembly_colours(assembly, placed(assembly).shape)
    there = set(answer["base"])
    entries: list[tuple[Any, str]] = []
    for k, step in enumerate(steps):
        row, column = divmod(k, columns)
        bottom = height - ABOVE - (row + 1) * tall + WORDS
        place = (column * wide / WIDTH, bottom / height, wide / WIDTH, high_picture / height)
        axes = figure.add_axes(place)
        axes.set_axis_off()
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", anchor="C")
        there |= set(step["parts"])
        entries = _picture(axes, assembly, camera, step, there, colours, float(max(high - low)))
        _words(axes, k, step)
    title(figure, answer["sentence"], "stable")
    legend(figure, _signs(entries, steps), columns=3)
    return figure


def _picture(
    axes: Axes,
    assembly: Assembly,
    camera: Camera,
    step: Mapping[str, Any],
    there: set[str],
    colours: Any,
    size: float,
) -> list[tuple[Any, str]]:
    """What stands, the part on its way, and its arrow."""
    index = assembly.index
    group = [index[name] for name in step["parts"]]
    shift, heading = _before(assembly, group, step)
    shown = [k for k, name in enumerate(assembly.names) if name in there]
    parts = [
        dataclasses.replace(part, pose=Pose(part.pose.position + shift, part.pose.rotation))
        if k in group
        else part
        for k, part in ((k, assembly[k]) for k in shown)
    ]
    drawn = dataclasses.replace(
        assembly, parts=parts, friction_pairs=(), loads=(), contacts=(), joints=(), bonds=()
    )
    gripped = [row for row, k in enumerate(shown) if assembly.names[k] in step["held"]]
    entries, _ = draw_parts(
        axes, drawn, camera, 2.2 * size, colours=colours[shown], gripped=gripped, line_width=0.45
    )
    middle = assembly.geometry.center[group].mean(axis=0) + shift
    ends = camera.flat(np.array([middle, middle + 0.9 * float(shift @ -heading) * heading]))
    axes.annotate(
        "",
        ends[1],
        ends[0],
        arrowprops={
            "arrowstyle": "-|>",
            "color": MOTION,
            "lw": 1.3,
            "mutation_scale": 8,
            "shrinkA": 0,
            "shrinkB": 0,
        },
        zorder=5,
    )
    return entries


def _before(assembly: Assembly, group: list[int], step: Mapping[str, Any]) -> tuple[Array, Array]:
    """How far from its seat parts stand on the last piece of their way, and the way there."""
    away = np.array(step["path"][-2])
    whole = float(np.linalg.norm(away))
    far = min(BACK * float(assembly.geometry.radius[group].max()), 0.9 * whole)
    return far / whole * away, -away / whole


def _limits(
    assembly: Assembly, camera: Camera, steps: Sequence[Mapping[str, Any]]
) -> tuple[Array, Array]:
    """Corners of every picture on the page: the free parts, also before they are in."""
    geometry, index = assembly.geometry, assembly.index
    corners = [geometry.vertices[~geometry.grounded[geometry.vertex_part]]]
    for step in steps:
        group = [index[name] for name in step["parts"]]
        shift, _ = _before(assembly, group, step)
        corners += [geometry.corners_of(k).reshape(-1, 3) + shift for k in group]
    flat, wanted = camera.flat(geometry.vertices), camera.flat(np.concatenate(corners))
    low, high = wanted.min(axis=0), wanted.max(axis=0)
    reach = REACH * float((high - low).max())
    low = np.minimum(low, np.maximum(flat.min(axis=0), low - reach))
    high = np.maximum(high, np.minimum(flat.max(axis=0), high + reach))
    room = MARGIN * float((high - low).max())
    return low - room, high + room


def _words(axes: Axes, k: int, step: Mapping[str, Any]) -> None:
    """The number and the name below a picture, and what is held."""
    lines: list[tuple[str, Any, str]] = [
        (f"{k + 1}  {label(', '.join(step['parts']), 20)}", INK, "bold")
    ]
    if step["held"]:
        lines.append((f"hold {label(', '.join(step['held']), 20)}", GRIP, "normal"))
    for row, (words, colour, weight) in enumerate(lines):
        axes.annotate(
            words,
            (0.5, 0.0),
            xycoords="axes fraction",
            xytext=(0, -2 - 8.5 * row),
            textcoords="offset points",
            color=colour,
            fontsize=6.5,
            fontweight=weight,
            ha="center",
            va="top",
            parse_math=False,
        )


def _signs(entries: list[tuple[Any, str]], steps: list[Any]) -> list[tuple[Any, str]]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    arrow = Line2D([0, 1], [0, 0], color=MOTION, linewidth=1.3, marker=">", markevery=[1])
    signs = [*((sign, "held from the start") for sign, _ in entries), (arrow, "comes in")]
    if any(step["held"] for step in steps):
        sign = Patch(facecolor=PAPER, edgecolor=GRIP, hatch="/////", linewidth=0.8)
        signs.append((sign, "held by a hand"))
    return signs
