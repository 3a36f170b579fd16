"""Figure of the places of the next part: a map from above."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from kilter.show.canvas import INK, PAPER, legend, new_figure, title
from kilter.tell.numbers import number
from kilter.tell.palette import GROUND, ROLES

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.path import Path as Outline

    from kilter.arrays import Array
    from kilter.assembly import Assembly


STANDS, FALLS, OPEN = (
    ROLES[name].light for name in ("stable-fill", "unstable-fill", "undecided-fill")
)
EDGE, LINE, PART = ROLES["edge"].light, ROLES["line"].light, ROLES["stable"].light
WIDTH = 7.0
"""Width of the figure [inch]."""
TALL = 1.15
"""Largest height of the picture, over its width [-]."""


def draw_places(
    answer: Mapping[str, Any], assembly: Assembly, footprint: Sequence[Sequence[float]]
) -> Figure:
    """Draw the places at which a part stands or falls, seen from above, and the best place.

    Arguments: `answer`: data of an answer of `kilter.place` without a given place (`to_dict()`);
    `footprint`: corners of the underside of the part relative to its centre [length unit]. Raises
    `InputError` if matplotlib is not installed.
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch, PathPatch, Polygon

    figure, axes = _axes(answer, assembly)
    for level in answer["levels"]:
        for name, colour in (("falls", FALLS), ("open", OPEN), ("stands", STANDS)):
            for polygon in level[name]:
                axes.add_patch(PathPatch(_outline(polygon), facecolor=colour, linewidth=0))
    for outline, held in _outlines(assembly, all_=True):
        colour = GROUND if held else EDGE
        axes.add_patch(Polygon(outline, fill=False, edgecolor=colour, linewidth=1.0))
    best = answer["best"]
    entries: list[tuple[Any, str]] = [
        (Patch(facecolor=STANDS), "centre here: stands, by forces"),
        (Patch(facecolor=FALLS), "falls, by a motion"),
        (Patch(facecolor=OPEN), "open"),
        (Line2D([], [], color=EDGE, linewidth=1.0), "parts from above"),
    ]
    if best is not None:
        middle = np.array([best["x"], best["y"]])
        around = np.array(footprint) + middle
        axes.add_patch(Polygon(around, fill=False, edgecolor=PART, linewidth=1.6, linestyle="--"))
        axes.plot(*middle, "+", color=PART, markersize=9, markeredgewidth=1.8)
        entries.append(
            (
                Line2D([], [], color=PART, linewidth=1.6, linestyle="--"),
                "the part at its best place",
            )
        )
    for level in answer["levels"]:
        _write_height(axes, level)
    title(figure, answer["sentence"], "stable" if best is not None else "unstable")
    legend(figure, entries, columns=3)
    return figure


def _axes(answer: Mapping[str, Any], assembly: Assembly) -> tuple[Figure, Any]:
    """An empty figure with axes around all places and parts."""
    rings = [
        np.array(ring)
        for level in answer["levels"]
        for name in ("stands", "falls", "open")
        for polygon in level[name]
        for ring in polygon[:1]
    ]
    corners = np.concatenate([*rings, *(outline for outline, _ in _outlines(assembly, all_=False))])
    low, high = corners.min(axis=0), corners.max(axis=0)
    size = high - low
    tall = float(np.clip(size[1] / max(size[0], 1e-300), 0.35, TALL))
    figure = new_figure(WIDTH, 0.86 * WIDTH * tall + 1.9)
    below = 1.0 / figure.get_figheight()
    axes = figure.add_axes((0.1, below, 0.86, 0.86 * WIDTH * tall / figure.get_figheight()))
    room = 0.03 * size
    axes.set(
        xlim=(low[0] - room[0], high[0] + room[0]),
        ylim=(low[1] - room[1], high[1] + room[1]),
        aspect="equal",
    )
    for spine in axes.spines.values():
        spine.set_color(LINE)
    axes.set_facecolor(PAPER)
    axes.tick_params(colors=INK, labelsize=8)
    axes.set_xlabel(f"x of the centre [{answer['units']}]", fontsize=9, color=INK)
    axes.set_ylabel(f"y [{answer['units']}]", fontsize=9, color=INK)
    return figure, axes


def _outlines(assembly: Assembly, *, all_: bool) -> Iterator[tuple[Array, bool]]:
    """Outline of each part from above, and whether it is held; without tables unless `all_`."""
    geometry = assembly.geometry
    for k, part in enumerate(assembly.parts):
        if part.table and not all_ and len(assembly.parts) > 1:
            continue
        hull = shapely.convex_hull(
            shapely.multipoints(geometry.vertices[geometry.vertex_part == k, :2])
        )
        yield shapely.get_coordinates(hull), bool(geometry.grounded[k])


def _outline(polygon: Sequence[Sequence[Sequence[float]]]) -> Outline:
    """Polygon with holes as a path of matplotlib."""
    from matplotlib.path import Path as Outline

    rings = [Outline(np.array(ring), closed=True) for ring in polygon]
    return Outline.make_compound_path(*rings)


def _write_height(axes: Any, level: Mapping[str, Any]) -> None:
    """Write the height of the centre of the part onto the largest polygon that stands."""
    pieces = [shapely.Polygon(outline, holes) for outline, *holes in level["stands"]]
    if not pieces:
        return
    inside = shapely.maximum_inscribed_circle(max(pieces, key=lambda piece: piece.area))
    x, y = shapely.get_coordinates(inside)[0]
    # beside the middle, where the cross of the best place may be
    axes.annotate(
        f"z {number(level['height'])}", (x, y), (0, 7), textcoords="offset points",
        fontsize=7, color=INK, ha="center", va="bottom",
    )  # fmt: skip
