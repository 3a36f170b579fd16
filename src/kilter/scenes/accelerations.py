"""Scenes without friction whose first accelerations are known in closed form."""

from __future__ import annotations

import numpy as np

from kilter.assembly import Assembly
from kilter.scenes.pieces import floor, prism
from kilter.scenes.registry import listed

__all__ = ["wedge_on_wedge"]


@listed(
    "wedge-on-wedge",
    "a wedge slides down a wedge that slides on the floor",
    source="S8",
    answer="unstable",
)
def wedge_on_wedge(
    angle: float = 30.0, *, mass: float = 1.0, mass_below: float = 2.0, planar: bool = False
) -> Assembly:
    """Build case S8: a wedge with a level top slides down a wedge that is free on a floor.

    There is no friction. The lower wedge descends toward +x and accelerates toward -x with

        m g sin c cos c / (M + m sin^2 c)

    Neither wedge rotates.

    Arguments: `angle`: slope c of the lower wedge [deg], 15 to 60; `mass`, `mass_below`: masses m
    of the upper and M of the lower wedge [kg].

    Examples
    --------
    >>> wedge_on_wedge().names
    ('floor', 'below', 'above')
    """
    rise = float(np.tan(np.radians(angle)))
    lower = [[0, 0], [6, 0], [0, 6 * rise]]
    a, b = 1.5, 3.0  # extent of the upper wedge along x
    upper = [[a, (6 - a) * rise], [b, (6 - b) * rise], [b, (6 - a) * rise]]
    return Assembly(
        [
            floor([-12, -2], [12, 2]),
            prism("below", lower, mass=mass_below),
            prism("above", upper, mass=mass),
        ],
        planar=planar,
    )
