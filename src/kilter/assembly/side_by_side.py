"""SideBySide: many small assemblies as one, so that they are computed together.

A numpy call costs about the same for ten parts as for a thousand. Therefore hundreds of small
assemblies are joined into one assembly, and contacts between different assemblies are excluded.
Each assembly keeps its own gravity.
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
    """M independent assemblies as a single list of parts, all planar or none, in the same unit."""

    whole: Assembly
    """All parts, without friction. Names may repeat, and its gravity has no meaning."""
    start: Index
    """The first part of each assembly, followed by the number of parts, shape (M + 1,)."""
    gravity: Array
    """Acceleration of gravity of each assembly [m/s^2], shape (M, 3)."""

    def __len__(self) -> int:
        return len(self.gravity)

    @property
    def owner(self) -> Index:
        """Index of the assembly to which each part belongs, shape (N,)."""
        return np.repeat(np.arange(len(self)), np.diff(self.start))


def side_by_side(assemblies: Sequence[Assembly]) -> SideBySide:
    """Join independent assemblies without given contacts, joints or loads, to search them at once.

    Raises `InputError` if the geometry of a part is invalid.
    """
    parts = [part for assembly in assemblies for part in assembly.parts]
    units = assemblies[0].units
    return join_geometry(
        parts,
        build_geometry(parts, units),
        starts([len(assembly) for assembly in assemblies]),
        np.array([assembly.gravity for assembly in assemblies]),
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
    """Join independent assemblies whose geometry is already computed.

    Arguments: `start` (M + 1,): first part of each assembly, followed by the number of parts;
    `gravity` (M, 3): acceleration of gravity of each assembly [m/s^2].
    """
    whole = object.__new__(Assembly)  # the constructor would reject repeated names
    fields = {
        "parts": tuple(parts),
        "units": units,
        "gravity": gravity[0],
        "friction": 0.0,
        **dict.fromkeys(("friction_pairs", "loads", "contacts", "joints", "bonds", "straps"), ()),
        "notes": (),
        "planar": planar,
        "detect": True,
        "source": "",
        "geometry": geometry,
    }
    whole.__dict__.update(fields)
    return SideBySide(whole, start, gravity)
