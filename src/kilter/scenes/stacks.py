"""Towers, overhangs and blocks on slopes.

Unit blocks are cubes of side 1. The held base has its top at z = 0. A slope of azimuth 0 descends
toward +x; the azimuth rotates it about +z.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from kilter.assembly import Assembly
from kilter.scenes.pieces import block, compose, floor, turn, turned_parts
from kilter.scenes.registry import listed


@listed("tower", "five cubes on a held cube", source="S2", answer="stable")
def tower(
    count: int = 5, *, tilt: float = 0.0, size: float = 1.0, friction: float = 0.0
) -> Assembly:
    """Case S2: a tower of free cubes on a held cube, with gravity leaning toward +x.

    The tower topples at tan(tilt) = 1 / count, if friction prevents sliding.

    Parameters
    ----------
    count : int
        Number of free cubes.
    tilt : float
        Angle of gravity [deg].
    size : float
        Side of the cubes [m].
    friction : float
        Friction coefficient [-].
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
    "four cubes, each shifted over the cube below, just inside the limit",
    source="S3",
    answer="stable",
)
def staircase(count: int = 4, *, offset: float | None = None) -> Assembly:
    """Case S3: free unit cubes on a held cube, each shifted along x over the cube below.

    The staircase is stable if and only if offset <= 1 / (count + 1).

    Arguments: `offset`: shift of each cube [m]; by default 0.98 of the limit.

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

    The block slides if tan(angle) > friction and tips if tan(angle) > width / height. Without
    friction its acceleration is g sin(angle).

    Parameters
    ----------
    angle, azimuth : float
        Angles [deg].
    width, height : float
        Size of the block along and across the slope [m]; its depth is 1.
    friction : float
        Friction coefficient [-].
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
    """Case S1: a block on a held slope, up to tan(angle) = min(friction, width / height)."""
    return block_on_slope(angle, width=width, height=height, friction=friction)


@listed(
    "harmonic-stack",
    "ten blocks that overhang an edge by 1.46 lengths, just balanced",
    source="O1",
    answer="stable",
)
def harmonic_stack(count: int = 10, *, scale: float = 1.0 - 1e-6) -> Assembly:
    """Case O1: `count` blocks 1 x 1 x 0.25, each shifted over the edge x = 0 of a held table.

    Block k from the top extends by scale / (2 k) beyond the block below. At scale 1 the stack is
    just balanced, with an overhang of half the harmonic number of `count`.

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
    """Case O2: a unit block over the edge of a table, and two unit blocks side by side on it.

    The blocks are just balanced. With a `shift` of 1e-3 in x they are not.
    """
    rows = [("lower", -0.5, 0), ("left", -1.0, 1), ("right", 0.0, 1)]
    blocks = [block(name, [x + shift, -0.5, z], [x + 1 + shift, 0.5, z + 1]) for name, x, z in rows]
    return Assembly([floor([-3, -1], [0, 1], name="table"), *blocks])


@listed(
    "inverted-triangle", "rows of 1, 2 and 3 blocks, not balanced", source="O3", answer="unstable"
)
def inverted_triangle(rows: int = 3) -> Assembly:
    """Case O3: rows of 1, 2, 3, ... unit blocks, bottom up, on a held table of width 1.

    The rows are balanced for 2 rows, but not for 3, 4 or 5.
    """
    return _rows_of_blocks(list(range(1, rows + 1)))


@listed("diamond", "a diamond of 16 blocks on a narrow table", source="O4", answer="stable")
def diamond(order: int = 4) -> Assembly:
    """Case O4: rows of 1, 2, ..., order, ..., 2, 1 unit blocks, bottom up, on a held table.

    The diamond is balanced for the orders 2, 3 and 4, but not for 5 or 6.
    """
    return _rows_of_blocks([*range(1, order + 1), *range(order - 1, 0, -1)])


def _rows_of_blocks(counts: list[int]) -> Assembly:
    """Rows of unit blocks centred on x = 0, on a table of width 1; `counts` bottom up."""
    blocks = [
        block(f"block-{row}-{k}", [k - n / 2, -0.5, row], [k + 1 - n / 2, 0.5, row + 1])
        for row, n in enumerate(counts)
        for k in range(n)
    ]
    return Assembly([floor([-0.5, -0.5], [0.5, 0.5], name="table"), *blocks])


def overhang(
    share: float = 0.45, *, size: float = 1.0, density: float | None = None, **assembly: Any
) -> Assembly:
    """Case W3: a cube on a held cube, shifted beyond its edge by a `share` of its length.

    The cube is stable up to a share of 0.5, whatever the size and the density.

    Arguments: `share`: overhang over length [-]; `size`: side of the cubes [length unit];
    `density`: density of both cubes [kg/m^3].
    """
    lower = block("base", [0, 0, -size], [size, size, 0], grounded=True, density=density)
    x = share * size
    upper = block("cube", [x, 0, 0], [x + size, size, size], density=density)
    return Assembly([lower, upper], **assembly)


def overhanging_cubes(share: float = 0.75) -> list[Assembly]:
    """Case W3 in all sizes and densities, from 1 mm to 1 km and from 1 to 2400 kg/m^3.

    Examples
    --------
    >>> len(overhanging_cubes(0.75))
    8
    """
    sizes, densities = (1e-3, 1e-2, 1.0, 1e3), (1.0, 2400.0)
    return [overhang(share, size=a, density=rho) for a in sizes for rho in densities]
