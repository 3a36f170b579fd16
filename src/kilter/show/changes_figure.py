"""Figure of changes that help: arrows of movements, and beside them the changed assembly."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.show.canvas import INK, legend, new_figure, title
from kilter.show.colours import assembly_colours
from kilter.show.figures import NAMED, camera_of, picture_limits
from kilter.show.overlay import draw_arrows, draw_gravity, draw_names
from kilter.show.shapes import place_shapes
from kilter.show.solids import draw_parts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, HEIGHT = 9.0, 4.6
"""Size of the figure [inch]."""
PANEL = (0.45, 0.66)
"""Width and height of a picture [size of the figure]."""
ARROW = 0.12
"""Length of the longest arrow [size of the picture]."""
PLACES = {1: ((0.28, 0.16),), 2: ((0.07, 0.16), (0.53, 0.16))}
"""Lower left corners of one picture, and of two [size of the figure]."""


def draw_changes(
    given: Assembly,
    changed: Assembly | None,
    movements: Array,
    words: str,
    sentence: str,
    *,
    view: tuple[float, float] | None = None,
) -> Figure:
    """Draw an assembly with arrows of movements that help, and beside it a changed assembly.

    Arguments: `movements` (N, 3): gain per movement of each part, or per force; `words`: what the
    longest arrow means; `sentence`: the change; `view`: azimuth and elevation of the eye [deg].
    Raises `InputError` if matplotlib is not installed.
    """
    figure = new_figure(WIDTH, HEIGHT)
    camera = camera_of(given, view)
    low, high = picture_limits(given, camera, np.array(PANEL) * [WIDTH, HEIGHT])
    size = float((high - low).max())
    entries: list[tuple[Any, str]] = []
    panels = [(given, "as given"), *([] if changed is None else [(changed, "changed")])]
    known = assembly_colours(given, place_shapes(given).shape)
    for (assembly, caption), corner in zip(panels, PLACES[len(panels)], strict=True):
        axes = figure.add_axes((*corner, *PANEL))
        axes.set_axis_off()
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
        colours = assembly_colours(assembly, place_shapes(assembly).shape)
        for k, part in enumerate(assembly.parts):
            if part.name in given.index and not part.grounded:
                colours[k] = known[given.index[part.name]]
        signs, faces = draw_parts(axes, assembly, camera, size, colours=colours)
        entries = entries or list(signs)
        axes.text(0.5, -0.04, caption, transform=axes.transAxes, color=INK, ha="center", va="top")
        if len(assembly.parts) <= NAMED:
            draw_names(axes, assembly, faces)
        if assembly is given:
            draw_gravity(axes, camera)
            entries += draw_arrows(
                axes, camera, given.geometry.center, movements, ARROW * size, words
            )
            for arrow in axes.patches:
                arrow.set_clip_on(False)
    title(figure, sentence)
    legend(figure, entries)
    return figure
