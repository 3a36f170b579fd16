"""Drawing of the parts in a figure: opaque shaded faces, edges, stripes on held parts."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from kilter.arrays import Array, Index
from kilter.rigid import quaternion_to_matrix
from kilter.show.colours import assembly_colours
from kilter.show.painter import Camera, Polygon, back_to_front, visible_triangles
from kilter.show.shapes import place_shapes
from kilter.tell.palette import ROLES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from kilter.assembly import Assembly


Colour = str | tuple[str, float] | tuple[float, float, float, float]

LIGHT = np.array([0.22, -0.66, 0.72])
"""Direction towards the light: right on the page, away from the eye, up."""
DARK = 0.70
"""Brightness of a face that is turned away from the light [-]."""
EDGE: Colour = ROLES["edge"].light
STRIPE: Colour = (ROLES["hatch"].light, 0.9)
GRIP: Colour = ROLES["grip"].light
"""Colour of parts that a hand holds."""
STRIPES = 0.018
"""Distance between the stripes of held parts [size of the picture]."""
HELD = 400
"""Largest number of polygons of held parts for which stripes are drawn."""
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
    motion: Array | None = None,
) -> tuple[list[tuple[Any, str]], list[tuple[int, Array]]]:
    """Draw the parts of an assembly as solids; return legend entries and the drawn faces.

    Arguments: `size`: size of the picture [length unit]; `colours` (N, 3): colours of the parts,
    from 0 to 255; by default those of `assembly_colours`; `line_width`: width of edges [pt];
    `motion` (N, 6): small motion of the parts after which they are drawn (`moved_points`).
    Returns `entries`: legend entries; `faces`: drawn faces, the farthest first; corners on the
    page, shape (n, 2).
    """
    from matplotlib.collections import PolyCollection
    from matplotlib.patches import Patch

    ordered = back_to_front(part_polygons(assembly, motion), camera)
    grounded = np.array([part.grounded for part in assembly.parts])
    if colours is None:
        colours = assembly_colours(assembly, place_shapes(assembly).shape)
    base = colours / 255.0
    striped = int(sum(grounded[polygon.part] for polygon in ordered)) <= HELD
    light = LIGHT / np.linalg.norm(LIGHT) @ np.stack([camera.right, -camera.towards, camera.up])
    outlines: list[Array] = []
    looks: list[tuple[Colour, Colour, float]] = []  # fill, stroke and width of each outline

    def lines(pieces: Iterable[Array], colour: Colour, width: float) -> None:
        for ends in pieces:
            outlines.append(ends)
            looks.append((CLEAR, colour, width))

    # a polygon, then its edges, so that nearer polygons hide both
    for polygon in ordered:
        shade = DARK + (1.06 - DARK) * max(float(polygon.normal @ light), 0.0)
        red, green, blue = np.clip(base[polygon.part] * shade, 0.0, 1.0).tolist()
        colour = (red, green, blue, 1.0)
        flat = camera.flat(polygon.corners)
        outlines.append(flat)
        # an outline in the same colour closes the gaps between neighbouring polygons
        looks.append((colour, colour, 0.4))
        held = polygon.part in gripped
        if striped and grounded[polygon.part]:
            lines(_stripes(flat, STRIPES * size), STRIPE, 0.5)
        if held:
            lines(_stripes(flat, STRIPES * size), GRIP, 1.1 * line_width)
        ends = np.stack([flat, np.roll(flat, -1, axis=0)], axis=1)
        lines(ends[np.flatnonzero(polygon.drawn)], GRIP if held else EDGE, line_width)
    if outlines:
        fills, strokes, widths = zip(*looks, strict=True)
        closed = [np.vstack([p, p[:1]]) if len(p) > 2 else p for p in outlines]
        style: dict[str, Any] = {"capstyle": "round", "joinstyle": "round", "zorder": 1}
        style |= {"facecolors": fills, "edgecolors": strokes, "linewidths": widths}
        axes.add_collection(PolyCollection(closed, closed=False, **style))
    faces = [(polygon.part, camera.flat(polygon.corners)) for polygon in ordered]
    if not grounded.any():
        return [], faces
    hatch = "/////" if striped else None
    sign = Patch(facecolor=base[grounded][0], edgecolor=STRIPE, hatch=hatch, linewidth=0.6)
    return [(sign, "held")], faces


def moved_points(assembly: Assembly, motion: Array, points: Array, parts: Index | int) -> Array:
    """Points, shape (n, 3), of parts, (n,), after a small motion of the parts, shape (N, 6).

    The displacements are linear in the motion, so contacts that stay closed meet at any scale.
    """
    arms = points - assembly.geometry.center[parts]
    moved: Array = points + motion[parts, :3] + np.cross(motion[parts, 3:], arms)
    return moved


def part_polygons(assembly: Assembly, motion: Array | None = None) -> list[Polygon]:
    """The triangles of all parts as polygons in the world, after a small motion (N, 6) if given."""
    places = place_shapes(assembly)
    matrices = quaternion_to_matrix(places.rotation)
    polygons: list[Polygon] = []
    for k, chosen in enumerate(places.shape):
        shape = places.shapes[chosen]
        corners = shape.positions.astype(np.float64) @ matrices[k].T + places.position[k]
        if motion is not None:
            corners = moved_points(assembly, motion, corners, k)
        polygons += visible_triangles(corners, shape.triangles, shape.edges, k)
    return polygons


def _stripes(flat: Array, apart: float) -> list[Array]:
    """Slanted lines within a convex polygon of the page, aligned over the whole page.

    `flat`, shape (n, 2); `apart`: distance of the lines, up to the factor sqrt(2) of the slant.
    Returns the ends of each line, shape (2, 2).
    """
    height = flat @ np.array([1.0, -1.0]) / apart
    after, ahead = np.roll(flat, -1, axis=0), np.roll(height, -1)
    lines = []
    for level in range(int(np.ceil(height.min())), int(np.floor(height.max())) + 1):
        cut = (height - level) * (ahead - level) < 0
        if cut.sum() == 2:
            share = ((level - height[cut]) / (ahead[cut] - height[cut]))[:, None]
            lines.append(flat[cut] + share * (after[cut] - flat[cut]))
    return lines
