"""Towers, overhangs and blocks on slopes.

Unit blocks are cubes of side 1 unless said; the held base has its top at z = 0. A slope at
azimuth 0 descends toward +x; azimuths turn it about +z.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.assembly import Assembly
from kilter.scenes.pieces import block, compose, floor, turn, turned_parts
from kilter.scenes.registry import listed

__all__ = [
    "block_on_incline",
    "block_on_slope",
    "diamond",
    "harmonic_stack",
    "inverted_triangle",
    "overhang",
    "overhanging_cubes",
    "staircase",
    "three_block_overhang",
    "tower",
]


@listed("tower", "five cubes on a held one", source="S2", answer="stable")
def tower(
    count: int = 5, *, tilt: float = 0.0, size: float = 1.0, friction: float = 0.0
) -> Assembly:
    """Case S2: `count` free cubes on a held one, gravity leaning toward +x.

    Topples at tan(tilt) = 1 / count, if friction keeps it from sliding.

    Parameters
    ----------
    count : int
    tilt : float
        Of gravity [deg].
    size : float
        Side of the cubes [m].
    friction : float
        [-]
    """
    cubes = [
        block(
            "base" if k == 0 else f"cube-{k}",
            [-size / 2, -size / 2, (k - 1) * size],
            [size / 2, size / 2, k * size],
            grounded=k == 0,
        )
        for k in range(count + 1)
    ]
    angle = np.radians(tilt)
    down = [9.81 * np.sin(angle), 0.0, -9.81 * np.cos(angle)]
    return Assembly(cubes, gravity=down, friction=friction)


@listed(
    "staircase",
    "four cubes, each a little further out, just inside the limit",
    source="S3",
    answer="stable",
)
def staircase(count: int = 4, *, offset: float | None = None) -> Assembly:
    """Case S3: `count` free unit cubes, each `offset` further along x than the one below.

    The lowest stands on a held cube. Stable if and only if offset <= 1 / (count + 1).

    Parameters
    ----------
    count : int
    offset : float, optional
        0.98 of the limit by default [m].

    Examples
    --------
    >>> staircase(3, offset=0.25).parts[-1].pose.position
    array([0.75, 0. , 2.5 ])
    """
    step = 0.98 / (count + 1) if offset is None else offset
    return Assembly(
        [
            block(
                "base" if k == 0 else f"cube-{k}",
                [k * step - 0.5, -0.5, k - 1],
                [k * step + 0.5, 0.5, k],
                grounded=k == 0,
            )
            for k in range(count + 1)
        ]
    )


@listed(
    "slope-with-friction",
    "a block on a slope of 20 degrees, friction 0.5",
    source="S1",
    answer="stable",
    friction=0.5,
)
@listed(
    "slope", "a block on a slope of 20 degrees without friction", source="S8", answer="unstable"
)
def block_on_slope(
    angle: float = 20.0,
    *,
    azimuth: float = 0.0,
    width: float = 1.0,
    height: float = 1.0,
    friction: float = 0.0,
) -> Assembly:
    """Cases S1, S8, W4, W5: a block on a held slope that descends toward `azimuth`.

    It slides where tan(angle) > friction, tips where tan(angle) > width / height. Without
    friction it starts with g sin(angle).

    Parameters
    ----------
    angle, azimuth : float
        [deg]
    width, height : float
        Of the block along and across the slope [m]; its depth is 1.
    friction : float
        [-]
    """
    parts = [
        floor([-3 * width, -2], [3 * width, 2], name="slope"),
        block("block", [-width / 2, -0.5, 0], [width / 2, 0.5, height]),
    ]
    rotation = compose(turn([0, 0, 1], azimuth), turn([0, 1, 0], angle))
    return Assembly(turned_parts(parts, rotation), friction=friction)


def block_on_incline(
    width: float = 1.0, height: float = 1.0, angle: float = 20.0, friction: float = 0.0
) -> Assembly:
    """Case S1: critical tan(angle) = min(friction, width / height); see `block_on_slope`."""
    return block_on_slope(angle, width=width, height=height, friction=friction)


@listed(
    "harmonic-stack",
    "ten blocks that reach 1.46 lengths over an edge, just balanced",
    source="O1",
    answer="stable",
)
def harmonic_stack(count: int = 10, *, scale: float = 1.0 - 1e-6) -> Assembly:
    """Case O1: the harmonic stack over the edge x = 0 of a held table, blocks 1 x 1 x 0.25.

    Block k from the top reaches scale / (2 k) past the one below. At scale 1 it is just
    balanced, with an overhang of half the harmonic number of `count`.

    Examples
    --------
    >>> top = harmonic_stack(3, scale=1.0).parts[-1]
    >>> round(float(top.pose.position[0] + 0.5), 12)  # (1 + 1/2 + 1/3) / 2
    0.916666666667
    """
    height = 0.25
    parts = [floor([-3, -1], [0, 1], name="table")]
    reach = 0.0
    for k in range(count):
        reach += scale / (2 * (count - k))
        low, high = [reach - 1, -0.5, k * height], [reach, 0.5, (k + 1) * height]
        parts.append(block(f"block-{k + 1}", low, high))
    return Assembly(parts)


def three_block_overhang(shift: float = 0.0) -> Assembly:
    """Case O2: unit blocks [-.5, .5] on a table that ends at x = 0, [-1, 0] and [0, 1] on it.

    Just balanced; with all three moved by 1e-3 in x it is not.
    """
    rows = [("lower", -0.5, 0), ("left", -1.0, 1), ("right", 0.0, 1)]
    blocks = [block(name, [x + shift, -0.5, z], [x + 1 + shift, 0.5, z + 1]) for name, x, z in rows]
    return Assembly([floor([-3, -1], [0, 1], name="table"), *blocks])


@listed(
    "inverted-triangle", "rows of 1, 2 and 3 blocks, not balanced", source="O3", answer="unstable"
)
def inverted_triangle(rows: int = 3) -> Assembly:
    """Case O3: rows of 1, 2, 3, ... unit blocks on a held table as wide as the first.

    Balanced for 2 rows, not for 3, 4, 5.
    """
    return _rows_of_blocks(list(range(1, rows + 1)))


@listed("diamond", "a diamond of 16 blocks on one, balanced", source="O4", answer="stable")
def diamond(order: int = 4) -> Assembly:
    """Case O4: rows of 1, 2, ..., order, ..., 2, 1 unit blocks on a held table.

    Balanced for order 2, 3, 4, not for 5, 6.
    """
    return _rows_of_blocks([*range(1, order + 1), *range(order - 1, 0, -1)])


def _rows_of_blocks(counts: list[int]) -> Assembly:
    """Rows of unit blocks centred on x = 0, bottom up, on a table [-.5, .5]."""
    blocks = [
        block(f"block-{row}-{k}", [k - n / 2, -0.5, row], [k + 1 - n / 2, 0.5, row + 1])
        for row, n in enumerate(counts)
        for k in range(n)
    ]
    return Assembly([floor([-0.5, -0.5], [0.5, 0.5], name="table"), *blocks])


def overhang(
    share: float = 0.45, *, size: float = 1.0, density: float | None = None, **assembly: Any
) -> Assembly:
    """Case W3: a cube on a held cube, `share` of its length past the edge.

    Stable up to a share of 0.5, whatever the size and the density.

    Parameters
    ----------
    share : float
        [-]
    size : float
        Side of the cubes [length unit].
    density : float, optional
        Of both [kg/m^3].
    **assembly
        Further arguments of `Assembly`, such as `units`.
    """
    lower = block("base", [0, 0, -size], [size, size, 0], grounded=True, density=density)
    x = share * size
    upper = block("cube", [x, 0, 0], [x + size, size, size], density=density)
    return Assembly([lower, upper], **assembly)


def overhanging_cubes(share: float = 0.75) -> list[Assembly]:
    """Case W3 at every size and density of the case: 1 mm to 1 km, 1 and 2400 kg/m^3.

    Examples
    --------
    >>> len(overhanging_cubes(0.75))
    8
    """
    sizes, densities = (1e-3, 1e-2, 1.0, 1e3), (1.0, 2400.0)
    return [overhang(share, size=a, density=rho) for a in sizes for rho in densities]
