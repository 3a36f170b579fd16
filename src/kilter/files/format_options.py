"""Options that only some file formats use."""

from __future__ import annotations

from dataclasses import dataclass

from kilter.assembly.bricks import StudRules

__all__ = ["BASES", "FormatOptions"]

BASES = ("fixed", "floating")
"""Values of the option `base`."""


@dataclass(frozen=True, slots=True)
class FormatOptions:
    """Options of `kilter.load` for specific file formats; None: the default.

    Attributes
    ----------
    units : {"m", "cm", "mm", "in"} or None
        Length unit, for formats that state none.
    contacts : {"file", "geometry"} or None
        COMPAS: whether the interfaces of the file are the contacts.
    keyframe : str or None
        MuJoCo: name of the keyframe whose pose is used.
    base : {"fixed", "floating"} or None
        URDF: whether the root link is held.
    studs : StudRules or None
        Bricks: strength of studs, and points at which sides push each other.
    """

    units: str | None = None
    contacts: str | None = None
    keyframe: str | None = None
    base: str | None = None
    studs: StudRules | None = None
