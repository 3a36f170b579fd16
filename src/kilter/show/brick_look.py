"""Appearance of toy bricks: studs on top of their boxes, and their LDraw colours.

References
----------
LDraw parts library: ``stud.dat`` (radius 6, height 4 of a cell of 20 and a plate of 8),
``LDConfig.ldr``.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index
from kilter.assembly.brick import Brick
from kilter.shape.primitives import Box, surface

__all__ = ["brick_rgb", "studded_surface"]

RADIUS = 0.3
"""Radius of a stud [cell]."""
HEIGHT = 0.5
"""Height of a stud [plate]."""
SIDES = 16
"""Corners of the polygon of a stud; with fewer, its side edges would be drawn as creases."""
MOST = 2500
"""Largest number of bricks that are drawn with studs."""
DIRECT = 0x2000000
"""Colour codes from this value on contain red, green and blue directly."""

_LISTED = """
0:1b2a34 1:0055bf 2:257a3e 3:00838f 4:c91a09 5:c870a0 6:583927 7:9ba19d 8:6d6e5c 9:b4d2e3
10:4b9f4a 11:55a5af 12:f2705e 13:fc97ac 14:f2cd37 15:ffffff 17:c2dab8 18:fbe696 19:e4cd9e
20:c9cae2 22:81007b 23:2032b0 25:fe8a18 26:923978 27:bbe90b 28:958a73 29:e4adc8 30:ac78ba
31:e1d5ed 68:f3cf9b 69:cd6298 70:582a12 71:a0a5a9 72:6c6e68 73:5a93db 74:73dca1 77:fecccf
78:f6d7b3 84:cc702a 85:3f3691 86:7c503a 89:4c61db 92:d09168 100:febabd 110:4354a3 112:6874ca
115:c7d23c 118:b3d7d1 120:d9e4a7 125:f9ba61 151:e6e3e0 191:f8bb3d 212:86c1e1 216:b31004
226:fff03a 232:56bed6 272:0d325b 288:184632 308:352100 313:54a9c8 320:720e0f 321:1498d7
322:3ec2dd 323:bddcd8 326:dfeea5 330:9b9a5a 335:d67572 351:f785b1 353:ff6d77 366:fa9c1c
373:845e84 378:a0bcac 379:597184 450:b67b50 462:ffa70b 484:a95500 503:e6e3da
"""
COLORS = {int(k): int(v, 16) for k, v in (entry.split(":") for entry in _LISTED.split())}
"""Solid colours by LDraw code; red, green and blue in one number."""


def brick_rgb(brick: Brick | None) -> tuple[int, int, int] | None:
    """Red, green and blue of a brick, 0 to 255; None without a colour code or a solid colour.

    Examples
    --------
    >>> brick_rgb(Brick((2, 4), color=4)), brick_rgb(Brick((2, 4), color=0x200FF00))
    ((201, 26, 9), (0, 255, 0))
    """
    if brick is None or brick.color is None:
        return None
    code = brick.color
    value = code - DIRECT if DIRECT <= code < 2 * DIRECT else COLORS.get(code)
    return None if value is None else (value >> 16 & 255, value >> 8 & 255, value & 255)


def studded_surface(box: Box, brick: Brick) -> tuple[Array, Index]:
    """Surface of a brick as vertices and triangles: a box with a stud on each cell of its top.

    Returns the vertices, shape (n, 3), and the triangles, shape (m, 3).
    """
    vertices, triangles = surface(box)
    across, along = brick.cells
    if brick.studs > MOST:
        return vertices, triangles
    cell = box.size[:2] / (across, along)
    height = HEIGHT * box.size[2] / brick.plates
    angle = np.arange(SIDES) * (2 * np.pi / SIDES)
    ring = RADIUS * cell.min() * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    stud = np.concatenate([ring, ring + np.array([0, 0, height]), [[0, 0, height]]])
    k, following = np.arange(SIDES), np.roll(np.arange(SIDES), -1)
    faces = np.concatenate(
        [
            np.column_stack([k, following, following + SIDES]),
            np.column_stack([k, following + SIDES, k + SIDES]),
            np.column_stack([k + SIDES, following + SIDES, 0 * k + 2 * SIDES]),
        ]
    )
    x, y = (np.stack(np.meshgrid(range(across), range(along)), axis=-1).reshape(-1, 2) + 0.5).T
    foot = np.column_stack([x * cell[0], y * cell[1], 0 * x]) + box.size * (-0.5, -0.5, 0.5)
    first = len(vertices) + len(stud) * np.arange(len(foot))
    return (
        np.concatenate([vertices, (foot[:, None] + stud).reshape(-1, 3)]),
        np.concatenate([triangles, (first[:, None, None] + faces).reshape(-1, 3)]),
    )
