"""Held walls around the pile of a packing plan, such as those of a roll container."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array
from kilter.assembly import Part
from kilter.errors import InputError
from kilter.files.packing_lists import PackingPlan
from kilter.rigid import Pose
from kilter.shape.primitives import Box
from kilter.validate import finite

__all__ = ["THICK", "given_walls", "walls_around"]

WALL = "wall"
"""Beginning of the names of assumed walls."""
THICK = 0.1
"""Thickness of the base and of assumed walls [widths of the pile]."""


def walls_around(low: Array, high: Array, top: float) -> list[Part]:
    """Four held walls around the space between two corners, up to a height."""
    low, high = np.array(low), np.array([high[0], high[1], top])
    thick = THICK * float((high - low).max())
    walls = []
    for axis in (0, 1):
        for end, side in ((low, -1), (high, 1)):
            size = high - low + 2 * thick
            middle = (low + high) / 2
            size[axis] = thick
            middle[axis] = end[axis] + side * thick / 2
            name = f"{WALL} {'xy'[axis]}{'-+'[side > 0]}"
            walls.append(Part(name, Box(size), Pose(middle), grounded=True, density=1000.0))
    return walls


def given_walls(plan: PackingPlan, size: ArrayLike) -> list[Part]:
    """Held walls of a given inner size; an error if a box lies beyond them."""
    size = finite(size, (2,), "the walls")
    if not size.min() > 0:
        raise InputError(
            f"the walls are {size.tolist()}", hint="give an inner length and width above 0"
        )
    slack = BEYOND * float(size.max())
    for box in plan.boxes:
        if any(
            box.corner[k] < -slack or box.corner[k] + box.size[k] > size[k] + slack for k in (0, 1)
        ):
            word = "item" if plan.order else "line"
            raise InputError(
                f"{word} {box.line}: {box.name!r:.60} lies beyond the walls, which are "
                f"{size[0]:g} x {size[1]:g} {plan.units} inside",
                file=plan.source or None,
                hint="correct its place, or the size of the walls",
            )
    low, high = np.array([0.0, 0.0, plan.low[2]]), np.array([*size, plan.high[2]])
    return walls_around(low, high, float(plan.high[2]))


BEYOND = 1e-6
"""A box may lie beyond a wall by this fraction of the size of the walls [-]."""
