"""Assemblies side by side: one geometry in arrays for many small questions.

Calls of numpy cost the same for ten parts as for a thousand, so hundreds of small assemblies are
asked as one whose parts never meet across. Each keeps its own gravity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, starts
from kilter.assembly.assembly import Assembly
from kilter.assembly.geometry import Geometry, build_geometry
from kilter.assembly.part import Part

__all__ = ["SideBySide", "join_geometry", "side_by_side"]


@dataclass(frozen=True, slots=True, eq=False)
class SideBySide:
    """M assemblies of one unit of length, all planar or none.

    Attributes
    ----------
    whole : Assembly
        All their parts, frictionless. Names repeat, and its gravity says nothing.
    start : ndarray of int, shape (M + 1,)
        The first part of each.
    gravity : ndarray, shape (M, 3)
        [m/s^2]
    """

    whole: Assembly
    start: Index
    gravity: Array

    def __len__(self) -> int:
        return len(self.gravity)

    @property
    def owner(self) -> Index:
        """The assembly of each part, shape (N,)."""
        return np.repeat(np.arange(len(self)), np.diff(self.start))


def side_by_side(assemblies: Sequence[Assembly]) -> SideBySide:
    """Assemblies without contacts, joints and loads of their own, side by side.

    Raises
    ------
    InputError
        If the geometry of a part is not usable.
    """
    parts = [part for one in assemblies for part in one.parts]
    units = assemblies[0].units
    return join_geometry(
        parts,
        build_geometry(parts, units),
        starts([len(one) for one in assemblies]),
        np.array([one.gravity for one in assemblies]),
        units=units,
        planar=assemblies[0].planar,
    )


def join_geometry(
    parts: Sequence[Part],
    geometry: Geometry,
    start: Index,
    gravity: Array,
    *,
    units: str = "m",
    planar: bool = False,
) -> SideBySide:
    """Assemblies side by side of parts whose geometry is known."""
    whole = object.__new__(Assembly)  # names repeat, which a new one refuses
    fields = {
        "parts": tuple(parts),
        "units": units,
        "gravity": gravity[0],
        "friction": 0.0,
        **dict.fromkeys(("friction_pairs", "loads", "contacts", "joints", "bonds", "notes"), ()),
        "planar": planar,
        "detect": True,
        "source": "",
        "geometry": geometry,
    }
    whole.__dict__.update(fields)
    return SideBySide(whole, start, gravity)
