"""Colours that colour-blind eyes can tell apart.

The hues are those of Okabe and Ito, paled so that arrows and edges stand out; verdicts have
their own colours and, always, a word and a sign besides.

References
----------
M. Okabe, K. Ito, Color universal design, 2008.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

__all__ = ["GROUND", "PALETTE", "part_colours"]

PALETTE = (
    "#7FB2D9",
    "#E8C268",
    "#7CC4A8",
    "#D9A3C0",
    "#A8C6E8",
    "#C9B38C",
    "#9FA8DA",
    "#B7D17A",
)
"""Of parts, in the order they are given out."""
GROUND = "#C3C8CE"
"""Of grounded parts."""
SHADES = (0.0, 0.10, -0.08, 0.05, -0.04, 0.13, -0.11)
"""Lighter (towards white) or darker: copies of one shape next to each other."""


def part_colours(shape: ArrayLike, grounded: ArrayLike) -> NDArray[np.uint8]:
    """A colour a part, shape (N, 3): a hue a shape, shades among copies, grey where held.

    Few parts have a hue each, whatever their shape.

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
    table = np.array([_rgb(text) for text in PALETTE], dtype=np.float64)
    colours = table[hue % len(PALETTE)]
    target = np.where(shade >= 0, 255.0, 0.0)[:, None]
    colours = colours + np.abs(shade)[:, None] * (target - colours)
    colours[grounded] = _rgb(GROUND)
    result: NDArray[np.uint8] = np.round(colours).astype(np.uint8)
    return result


def _rgb(text: str) -> tuple[int, ...]:
    return tuple(int(text[k : k + 2], 16) for k in (1, 3, 5))
