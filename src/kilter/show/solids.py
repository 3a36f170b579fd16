"""Parts on a page: shaded faces, edges, stripes on what is held; nothing seen through."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import Array
from kilter.rigid import quaternion_to_matrix
from kilter.show.colours import assembly_colours
from kilter.show.painter import Camera, Polygon, back_to_front, visible_triangles
from kilter.show.shapes import placed
from kilter.tell.palette import ROLES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from kilter.assembly import Assembly

__all__ = ["GRIP", "draw_parts"]

Colour = str | tuple[str, float] | tuple[float, float, float, float]

LIGHT = np.array([0.22, -0.66, 0.72])
"""Where the light comes from, on the page (right, away from the eye, up)."""
DARK = 0.70
"""Brightness of a face that the light does not meet [-]."""
EDGE: Colour = ROLES["edge"].light
STRIPE: Colour = (ROLES["hatch"].light, 0.9)
GRIP: Colour = ROLES["grip"].light
"""Of parts that a hand holds."""
STRIPES = 0.018
"""Between the stripes of held parts [size of the picture]."""
HELD = 400
"""Held polygons up to which they are striped."""
CLEAR: Colour = "none"


def draw_parts(
    axes: Axes,
    assembly: Assembly,
    camera: Camera,
    size: float,
    *,
    colours: NDArray[np.uint8] | None = None,
    gripped: Collection[int] = (),
    line_width: float = 0.8,
) -> tuple[list[tuple[Any, str]], list[tuple[int, Array]]]:
    """Draw the parts.

    Parameters
    ----------
    axes, assembly, camera
    size : float
        Of the picture [length unit].
    colours : ndarray, shape (N, 3), optional
        Of the parts, from 0 to 255; where not given, as every picture has them.
    gripped : collection of int
        Parts that a hand holds.
    line_width : float
        Of edges [pt].

    Returns
    -------
    entries : list of (sign, words)
        For the legend.
    faces : list of (part, corners)
        What was drawn, corners on the page of shape (n, 2), the farthest first.
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    ordered = back_to_front(_polygons(assembly), camera)
    grounded = np.array([part.grounded for part in assembly.parts])
    if colours is None:
        colours = assembly_colours(assembly, placed(assembly).shape)
    base = colours / 255.0
    striped = int(sum(grounded[polygon.part] for polygon in ordered)) <= HELD
    light = LIGHT / np.linalg.norm(LIGHT) @ np.stack([camera.right, -camera.towards, camera.up])
    outlines: list[Array] = []
    fills: list[Colour] = []
    strokes: list[Colour] = []
    widths: list[float] = []

    def line(ends: Array, colour: Colour, width: float) -> None:
        outlines.append(ends)
        fills.append(CLEAR)
        strokes.append(colour)
        widths.append(width)

    # a polygon, then its edges, so that what comes later hides both
    for polygon in ordered:
        shade = DARK + (1.06 - DARK) * max(float(polygon.normal @ light), 0.0)
        red, green, blue = np.clip(base[polygon.part] * shade, 0.0, 1.0).tolist()
        colour = (red, green, blue, 1.0)
        flat = camera.flat(polygon.corners)
        outlines.append(flat)
        fills.append(colour)
        # its own colour around it: no gaps between neighbours
        strokes.append(colour)
        widths.append(0.4)
        if striped and grounded[polygon.part]:
            for ends in _stripes(flat, STRIPES * size):
                line(ends, STRIPE, 0.5)
        held = polygon.part in gripped
        for ends in _stripes(flat, STRIPES * size) if held else []:
            line(ends, GRIP, 1.1 * line_width)
        after = np.roll(flat, -1, axis=0)
        for k in np.flatnonzero(polygon.drawn):
            line(np.array([flat[k], after[k]]), GRIP if held else EDGE, line_width)
    if outlines:
        style: dict[str, Any] = {"capstyle": "round", "joinstyle": "round", "zorder": 1}
        axes.add_collection(
            PolyCollection(
                _closed(outlines),
                closed=False,
                facecolors=fills,
                edgecolors=strokes,
                linewidths=widths,
                **style,
            )
        )
    faces = [(polygon.part, camera.flat(polygon.corners)) for polygon in ordered]
    if not grounded.any():
        return [], faces
    hatch = "/////" if striped else None
    sign = Patch(facecolor=base[grounded][0], edgecolor=STRIPE, hatch=hatch, linewidth=0.6)
    return [(sign, "held")], faces


def _closed(outlines: list[Array]) -> list[Array]:
    return [np.vstack([p, p[:1]]) if len(p) > 2 else p for p in outlines]


def _polygons(assembly: Assembly) -> list[Polygon]:
    places = placed(assembly)
    matrices = quaternion_to_matrix(places.rotation)
    polygons: list[Polygon] = []
    for k, chosen in enumerate(places.shape):
        shape = places.shapes[chosen]
        corners = shape.positions.astype(np.float64) @ matrices[k].T + places.position[k]
        polygons += visible_triangles(corners, shape.triangles, shape.edges, k)
    return polygons


def _stripes(flat: Array, apart: float) -> list[Array]:
    """Slanted lines within a convex polygon of the page, on one grid for the whole page."""
    height = flat @ np.array([1.0, -1.0]) / apart
    after, there = np.roll(flat, -1, axis=0), np.roll(height, -1)
    found = []
    for level in range(int(np.ceil(height.min())), int(np.floor(height.max())) + 1):
        cut = (height - level) * (there - level) < 0
        if cut.sum() == 2:
            share = ((level - height[cut]) / (there[cut] - height[cut]))[:, None]
            found.append(flat[cut] + share * (after[cut] - flat[cut]))
    return found
