"""Colours of parts: one hue for each shape, shades for its copies, grey for held parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kilter.show.shapes import brick_rgb
from kilter.tell.palette import GROUND, PALETTE, rgb

if TYPE_CHECKING:
    from kilter.assembly import Assembly


VIVID = (0.575, 0.88)
"""Largest saturation and brightness of a stated colour in a picture [-]."""
SHADES = (0.0, 0.10, -0.08, 0.05, -0.04, 0.13, -0.11)
"""Shares of white (positive) or black (negative) mixed into the colours of successive copies."""


def assembly_colours(assembly: Assembly, shape: ArrayLike) -> NDArray[np.uint8]:
    """Colours of the parts of an assembly, shape (N, 3), from 0 to 255; grey for held parts.

    `shape` (N,): index of the shape of each part. A brick or part with a stated colour keeps that
    colour, unless all parts state the same: many CAD programs colour each part grey.
    """
    colours = part_colours(shape, assembly.geometry.grounded)
    tells_apart = len({part.color for part in assembly.parts}) > 1
    for k, part in enumerate(assembly.parts):
        stated = brick_rgb(part.brick)
        if stated is None and part.color is not None and tells_apart:
            stated = rgb(part.color)
        if stated is not None:
            colours[k] = stated if part.brick is not None else softened(stated)
    return colours


def softened(colour: ArrayLike) -> NDArray[np.uint8]:
    """A stated colour with at most `VIVID` of its saturation and brightness, from 0 to 255.

    CAD programs state pure colours, which hide arrows and edges.

    Examples
    --------
    >>> softened([0, 255, 0]).tolist(), softened([120, 130, 140]).tolist()
    ([95, 224, 95], [120, 130, 140])
    """
    rgb_ = np.asarray(colour, dtype=np.float64) / 255
    bright = rgb_.max()
    if bright == 0:
        return np.asarray(colour, dtype=np.uint8)
    saturation = 1 - rgb_.min() / bright
    share = min(1.0, VIVID[0] / saturation) if saturation > 0 else 1.0
    soft = (bright - share * (bright - rgb_)) * min(1.0, VIVID[1] / bright)
    result: NDArray[np.uint8] = np.round(255 * (soft if saturation > VIVID[0] else rgb_)).astype(
        np.uint8
    )
    return result


def part_colours(shape: ArrayLike, grounded: ArrayLike) -> NDArray[np.uint8]:
    """Colours of parts, (N, 3), from 0 to 255: a hue per shape, a shade per copy, grey if held.

    With few free parts, each part has a hue of its own, whatever its shape.

    Examples
    --------
    >>> part_colours([0, 0, 1], [True, False, False])[0].tolist()
    [195, 200, 206]
    """
    shape, grounded = np.asarray(shape, dtype=np.int64), np.asarray(grounded, dtype=bool)
    free = np.flatnonzero(~grounded)
    hue = np.zeros(len(shape), dtype=np.int64)
    if len(free) <= len(PALETTE):
        hue[free] = np.arange(len(free))
        shade = np.zeros(len(shape))
    else:
        _, hue[free] = np.unique(shape[free], return_inverse=True)
        shade = np.array(SHADES)[np.arange(len(shape)) % len(SHADES)]
    table = np.array([rgb(text) for text in PALETTE], dtype=np.float64)
    colours = table[hue % len(PALETTE)]
    target = np.where(shade >= 0, 255.0, 0.0)[:, None]
    colours = colours + np.abs(shade)[:, None] * (target - colours)
    colours[grounded] = rgb(GROUND)
    result: NDArray[np.uint8] = np.round(colours).astype(np.uint8)
    return result
