"""A small picture of an assembly as SVG text: its visible faces from back to front."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from kilter.show.colours import assembly_colours
from kilter.show.figures import camera_of
from kilter.show.painter import Polygon, back_to_front
from kilter.show.shapes import place_shapes
from kilter.show.solids import DARK, LIGHT, part_polygons
from kilter.tell.palette import ROLES

if TYPE_CHECKING:
    from kilter.arrays import Array
    from kilter.assembly import Assembly

SIDE = (200, 140)
"""Width and height of the picture [px]."""
MARGIN = 8
"""Margin around the assembly [px]."""


def thumbnail(assembly: Assembly) -> str:
    """Draw an assembly as an SVG element of `SIDE` pixels, with gravity down.

    Examples
    --------
    >>> from kilter.scenes import scene
    >>> thumbnail(scene("tower"))[:4]
    '<svg'
    """
    camera = camera_of(assembly, None)
    polygons = back_to_front(part_polygons(assembly), camera)
    colours = assembly_colours(assembly, place_shapes(assembly).shape).astype(np.float64)
    flat = [camera.flat(polygon.corners) for polygon in polygons]
    points = np.concatenate(flat)
    low, high = points.min(axis=0), points.max(axis=0)
    room = np.array(SIDE) - 2 * MARGIN
    scale = float((room / np.maximum(high - low, 1e-300)).min())
    middle = (low + high) / 2
    light = LIGHT / np.linalg.norm(LIGHT) @ np.stack([camera.right, -camera.towards, camera.up])
    lines = [
        _path((corners - middle) * scale * [1, -1] + np.array(SIDE) / 2, polygon, colours, light)
        for corners, polygon in zip(flat, polygons, strict=True)
    ]
    size = f'viewBox="0 0 {SIDE[0]} {SIDE[1]}" width="{SIDE[0]}" height="{SIDE[1]}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{"".join(lines)}</svg>'


def _path(corners: Array, polygon: Polygon, colours: Array, light: Array) -> str:
    """SVG of a face and of its drawn edges."""
    shade = DARK + (1 - DARK) * max(0.0, float(polygon.normal @ light))
    red, green, blue = np.round(colours[polygon.part] * shade).astype(int)
    points = [f"{x:.1f} {y:.1f}" for x, y in corners]
    fill = f"#{red:02x}{green:02x}{blue:02x}"
    face = f'<path d="M{"L".join(points)}Z" fill="{fill}" stroke="{fill}" stroke-width=".6"/>'
    after = points[1:] + points[:1]
    sides = [f"M{a}L{b}" for a, b, drawn in zip(points, after, polygon.drawn, strict=True) if drawn]
    if not sides:
        return face
    return face + f'<path d="{"".join(sides)}" stroke="{ROLES["edge"].light}" stroke-width=".8"/>'
