"""How a file lies: a word where an axis other than z seems to point up.

Along an axis the whole would stand, as one rigid body, if its centre of mass were above the
polygon of its lowest corners: seen from the centre, no two neighbours of them are half a turn
apart. A file that cannot stand along z, and can along another axis, was made with that one up.
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
"""Directions by the names that `up` may have."""
USUAL = ("y", "x", "-z", "-y", "-x")
"""What may point up where z does not, the usual first."""


def note_on_up(assembly: Assembly) -> list[str]:
    """A note where the assembly stands along another axis and not along z; else none.

    Examples
    --------
    >>> from kilter.assembly import Part
    >>> from kilter.shape.primitives import Prism
    >>> tip = Part("tip", Prism([[0, 0], [2, -2], [2, 2]], 1))
    >>> note_on_up(Assembly([tip]))[0][:58]
    'nothing stands under its centre of mass with z up, but wit'
    """
    try:
        geometry = assembly.geometry
    except InputError:
        return []  # said where the geometry is asked for
    middle = geometry.mass @ geometry.center / geometry.mass.sum()
    corners = geometry.vertices - middle
    if _stands(corners, "z"):
        return []
    found = next((axis for axis in USUAL if _stands(corners, axis)), None)
    if found is None:
        return []
    return [
        f"nothing stands under its centre of mass with z up, but with {found} up it does: "
        f"if the file is made so, give --up {found} (in Python up={found!r})"
    ]


def _stands(corners: Array, up: str) -> bool:
    """Corners from the centre of mass, shape (n, 3): is it above the lowest of them?"""
    axis = int(np.abs(UP[up]).argmax())
    heights = corners @ np.array(UP[up])
    lowest = heights <= heights.min() + LOWEST_CORNERS * float(np.ptp(heights))
    foot = np.delete(corners[lowest], axis, axis=1)
    angles = np.sort(np.arctan2(foot[:, 1], foot[:, 0]))
    gaps = np.diff(np.append(angles, angles[0] + 2 * np.pi))
    return bool(gaps.max() < np.pi - SAME_ANGLE)
