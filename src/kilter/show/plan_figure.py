"""The steps of a plan as a sheet for print, with a small picture for each step.

Each picture shows the new part at a distance from its seat, with an arrow along its path. Parts
that are held by a hand have blue stripes and edges. The colours are those of the page.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.rigid import Pose
from kilter.show.canvas import INK, PAPER, label, legend, new_figure, title
from kilter.show.colours import assembly_colours
from kilter.show.figures import camera_of, draw_picture
from kilter.show.movement_scene import magnification
from kilter.show.overlay import GHOSTS, MOTION, draw_displaced
from kilter.show.painter import Camera
from kilter.show.shapes import place_shapes
from kilter.show.solids import GRIP, draw_parts
from kilter.tell.numbers import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


# Figure of small movements: the drawn assembly, and dashed outlines at magnified movements.


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
    picture = draw_picture(assembly, view)
    _, axes, camera, size, entries, _ = picture
    if movement.any():
        factor = magnification(movement, size)
        words = "at rest" if factor == 1.0 else f"at rest, movements x {number(factor)}"
        drawn = largest_movements(movement, GHOSTS)
        if np.count_nonzero(movement.any(axis=1)) > GHOSTS:
            words += f", of the {GHOSTS} parts that move most"
        entries += draw_displaced(axes, assembly, camera, factor * drawn, words)
    return picture.completed(assembly, sentence)


WIDTH = 7.0
"""Width of the sheet [inch]."""
HIGH = (0.4, 1.2)
"""Least and greatest height of a picture [its width]."""
ABOVE, BELOW = 0.78, 0.42
"""Height of the space for the sentence and for the legend [inch]."""
WORDS = 0.33
"""Height of the text below a picture [inch]."""
BACK = 1.5
"""Distance of the new part from its seat [its bounding radius]."""
MARGIN = 0.07
"""Margin around the assembly [its size]."""
REACH = 0.12
"""Distance beyond the free parts at which held parts are cut off [size of the free parts]."""


def draw_plan(
    assembly: Assembly,
    answer: Mapping[str, Any],
    *,
    view: tuple[float, float] | None = None,
) -> Figure:
    """Draw the steps of a plan in rows from left to right, with a picture for each step.

    Arguments: `view`: azimuth (to the right of -y) and elevation of the eye [deg], with gravity
    down.
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
    figure = new_figure(WIDTH, height)
    colours = assembly_colours(assembly, place_shapes(assembly).shape)
    present = set(answer["base"])
    entries: list[tuple[Any, str]] = []
    for k, step in enumerate(steps):
        row, column = divmod(k, columns)
        bottom = height - ABOVE - (row + 1) * tall + WORDS
        place = (column * wide / WIDTH, bottom / height, wide / WIDTH, high_picture / height)
        axes = figure.add_axes(place)
        axes.set_axis_off()
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", anchor="C")
        present |= set(step["parts"])
        entries = _draw_step(axes, assembly, camera, step, present, colours, float(max(high - low)))
        _write_words(axes, k, step)
    title(figure, answer["sentence"], "stable")
    legend(figure, _signs(entries, steps), columns=3)
    return figure


def _draw_step(
    axes: Axes,
    assembly: Assembly,
    camera: Camera,
    step: Mapping[str, Any],
    present: set[str],
    colours: Any,
    size: float,
) -> list[tuple[Any, str]]:
    """Draw a step: the present parts, the new part pulled away, and an arrow along its path.

    `size`: size of the picture [length unit]. Returns the legend entries of the parts.
    """
    index = assembly.index
    group = [index[name] for name in step["parts"]]
    shift, heading = _displacement_before(assembly, group, step)
    shown = [k for k, name in enumerate(assembly.names) if name in present]
    parts = [
        dataclasses.replace(part, pose=Pose(part.pose.position + shift, part.pose.rotation))
        if k in group
        else part
        for k, part in ((k, assembly[k]) for k in shown)
    ]
    drawn = dataclasses.replace(
        assembly,
        parts=parts,
        friction_pairs=(),
        loads=(),
        contacts=(),
        joints=(),
        bonds=(),
        straps=(),
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


def _displacement_before(
    assembly: Assembly, group: list[int], step: Mapping[str, Any]
) -> tuple[Array, Array]:
    """Displacement of the new parts before the last leg of their path, and its direction.

    The direction is a unit vector.

    `group` lists the indices of the parts. Both results have shape (3,).
    """
    away = np.array(step["path"][-2])
    whole = float(np.linalg.norm(away))
    far = min(BACK * float(assembly.geometry.radius[group].max()), 0.9 * whole)
    return far / whole * away, -away / whole


def _limits(
    assembly: Assembly, camera: Camera, steps: Sequence[Mapping[str, Any]]
) -> tuple[Array, Array]:
    """Lower left and upper right corner of every picture: free parts, also before insertion."""
    geometry, index = assembly.geometry, assembly.index
    corners = [geometry.vertices[~geometry.grounded[geometry.vertex_part]]]
    for step in steps:
        group = [index[name] for name in step["parts"]]
        shift, _ = _displacement_before(assembly, group, step)
        corners += [geometry.corners_of(k).reshape(-1, 3) + shift for k in group]
    flat, wanted = camera.flat(geometry.vertices), camera.flat(np.concatenate(corners))
    low, high = wanted.min(axis=0), wanted.max(axis=0)
    reach = REACH * float((high - low).max())
    low = np.minimum(low, np.maximum(flat.min(axis=0), low - reach))
    high = np.maximum(high, np.minimum(flat.max(axis=0), high + reach))
    room = MARGIN * float((high - low).max())
    return low - room, high + room


def _write_words(axes: Axes, k: int, step: Mapping[str, Any]) -> None:
    """Write the number of a step, its new parts and its held parts below the picture."""
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
    """Legend entries of a plan: parts held from the start, arrow, parts held by a hand."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    arrow = Line2D([0, 1], [0, 0], color=MOTION, linewidth=1.3, marker=">", markevery=[1])
    signs = [*((sign, "held from the start") for sign, _ in entries), (arrow, "is inserted")]
    if any(step["held"] for step in steps):
        sign = Patch(facecolor=PAPER, edgecolor=GRIP, hatch="/////", linewidth=0.8)
        signs.append((sign, "held by a hand"))
    return signs
