"""Detect a file in which an axis other than z points up.

An assembly stands with an axis up if, as a rigid body, its centre of mass is above the support
polygon of its lowest corners: seen from the centre, neighbouring corners are less than half a turn
apart. A file that does not stand with z up, but does with another axis up, was made for that axis.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.errors import InputError
from kilter.files.file_tolerances import LOWEST_CORNERS, SAME_ANGLE

__all__ = ["UP", "note_on_up"]

UP: dict[str, tuple[float, float, float]] = {
    "x": (1.0, 0.0, 0.0),
    "y": (0.0, 1.0, 0.0),
    "z": (0.0, 0.0, 1.0),
    "-x": (-1.0, 0.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "-z": (0.0, 0.0, -1.0),
}
"""Unit vector of each value of the option `up`."""
USUAL = ("y", "x", "-z", "-y", "-x")
"""Values of `up` other than z in the order in which they are tried, the most usual first."""


def note_on_up(assembly: Assembly) -> list[str]:
    """A note if the assembly seems to lie on its side; else an empty list.

    It would stand with another axis up, but not with z.

    Examples
    --------
    >>> from kilter.assembly import Part
    >>> from kilter.shape.primitives import Prism
    >>> tip = Part("tip", Prism([[0, 0], [2, -2], [2, 2]], 1))
    >>> note_on_up(Assembly([tip]))[0][:58]
    'with z up the centre of mass is outside the support polygo'
    """
    try:
        geometry = assembly.geometry
    except InputError:
        return []  # the check of the geometry will report the fault
    middle = geometry.mass @ geometry.center / geometry.mass.sum()
    corners = geometry.vertices - middle
    if _stands(corners, "z"):
        return []
    better = next((axis for axis in USUAL if _stands(corners, axis)), None)
    if better is None:
        return []
    return [
        f"with z up the centre of mass is outside the support polygon, with {better} up inside: "
        f"if {better} points up in the file, give --up {better} (in Python up={better!r})"
    ]


def _stands(corners: Array, up: str) -> bool:
    """Whether the centre of mass is above the support polygon, with the axis `up` upwards.

    Arguments: `corners` (n, 3): positions relative to the centre of mass.
    """
    axis = int(np.abs(UP[up]).argmax())
    heights = corners @ np.array(UP[up])
    lowest = heights <= heights.min() + LOWEST_CORNERS * float(np.ptp(heights))
    foot = np.delete(corners[lowest], axis, axis=1)
    angles = np.sort(np.arctan2(foot[:, 1], foot[:, 0]))
    gaps = np.diff(np.append(angles, angles[0] + 2 * np.pi))
    return bool(gaps.max() < np.pi - SAME_ANGLE)
