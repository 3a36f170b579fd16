"""Sizes, LDraw part numbers and masses of bricks, plates and baseplates.

The libraries of StableLego and BrickGPT state the masses of some sizes. The masses of other sizes
are estimated by a fit to the stated masses, with a term for the top with its studs and a term for
the walls:

    m = top * cells + wall * perimeter * height

References
----------
StableLego (arXiv 2402.10711), ``lego_library.json``; BrickGPT, ``brick_library.json``;
LDraw parts library, numbers of "Brick", "Plate", "Baseplate".
"""

from __future__ import annotations

from functools import cache

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly.brick import BRICK_PLATES

__all__ = ["LDRAW", "STABLE_LEGO", "STATED", "brick_mass", "is_stated"]

STABLE_LEGO: dict[int, tuple[int, int, float]] = {
    1: (2, 2, 0.2),
    2: (2, 4, 0.00216),
    3: (2, 6, 0.00323),
    4: (1, 8, 0.00303),
    5: (1, 4, 0.00157),
    6: (1, 6, 0.00228),
    9: (1, 2, 0.00081),
    10: (1, 1, 0.00043),
    12: (2, 2, 0.00115),
}
"""Studs across, studs along and mass [kg] by the number in the library; number 1 is a weight."""
STATED = {(across, along): mass for k, (across, along, mass) in STABLE_LEGO.items() if k != 1}
"""Stated masses of bricks [kg], by size."""


def _sizes(plates: int, listed: str) -> dict[str, tuple[int, int, int]]:
    """Parse words ``number:acrossxalong`` to the size of each brick: studs, studs, plates."""
    sizes = {}
    for word in listed.split():
        number, size = word.split(":")
        across, along = map(int, size.split("x"))
        sizes[number] = (across, along, plates)
    return sizes


LDRAW: dict[str, tuple[int, int, int]] = {
    **_sizes(
        BRICK_PLATES,
        "3005:1x1 3004:1x2 3622:1x3 3010:1x4 3009:1x6 3008:1x8 6111:1x10 6112:1x12 2465:1x16 "
        "3003:2x2 3002:2x3 3001:2x4 2456:2x6 44237:2x6 3007:2x8 3006:2x10 4201:8x8 4202:4x12",
    ),
    **_sizes(
        1,
        "3024:1x1 3023:1x2 3623:1x3 3710:1x4 3666:1x6 3460:1x8 4477:1x10 60479:1x12 "
        "3022:2x2 3021:2x3 3020:2x4 3795:2x6 3034:2x8 3832:2x10 2445:2x12 91988:2x14 4282:2x16 "
        "11212:3x3 3031:4x4 3032:4x6 3035:4x8 3030:4x10 3029:4x12 "
        "3958:6x6 3036:6x8 3033:6x10 3028:6x12 3456:6x14 3027:6x16 3026:6x24 41539:8x8 92438:8x16",
    ),
    **_sizes(0, "3865:8x16 3867:16x16 3334:16x24 3857:16x32 3811:32x32 4186:48x48"),
}
"""Studs across, studs along and height in plates by LDraw part number; height 0 is a baseplate."""


@cache
def _fit() -> Array:
    """Fitted masses of a cell of the top, and of a wall one stud long and one brick high [kg]."""
    sizes = np.array(list(STATED))
    stated = np.array([*STATED.values()])
    masses: Array = np.linalg.lstsq(_terms(sizes, BRICK_PLATES), stated, rcond=None)[0]
    return masses


def _terms(sizes: Index, plates: Index | int) -> Array:
    """Terms of the mass estimate for brick sizes: cells, and perimeter times height, (n, 2)."""
    height = np.broadcast_to(plates, len(sizes)) / BRICK_PLATES
    return np.column_stack([sizes.prod(axis=1), 2 * sizes.sum(axis=1) * height])


def is_stated(across: int, along: int, plates: int) -> bool:
    """Whether a brick library states the mass of a brick size, so that it is not estimated."""
    return plates == BRICK_PLATES and (min(across, along), max(across, along)) in STATED


def brick_mass(across: int, along: int, plates: int = BRICK_PLATES) -> float:
    """Mass of a brick or plate of the given size, from a library or estimated [kg].

    Examples
    --------
    >>> brick_mass(4, 2)
    0.00216
    >>> f"{brick_mass(2, 3):.5f}, {brick_mass(2, 4, plates=1):.5f}"
    '0.00180, 0.00141'
    """
    if is_stated(across, along, plates):
        return STATED[min(across, along), max(across, along)]
    return float((_terms(np.array([[across, along]]), plates) @ _fit())[0])
