"""Options that only some file formats use."""

from __future__ import annotations

from dataclasses import dataclass

from kilter.assembly.bricks import StudRules
from kilter.files.objects.mujoco_snapshot import StateRows

BASES = ("fixed", "floating")
"""Values of the option `base`."""


@dataclass(frozen=True, slots=True)
class FormatOptions:
    """Options of `kilter.load` for specific file formats; None: the default."""

    units: str | None = None
    """One of "m", "cm", "mm", "in". Length unit, for formats that state none."""
    contacts: str | None = None
    """One of "file", "geometry". COMPAS: whether the interfaces of the file are the contacts."""
    keyframe: str | None = None
    """MuJoCo: name of the keyframe whose pose is used."""
    states: StateRows | None = None
    """MuJoCo: states in place of the pose of a keyframe; the first is that of the assembly."""
    model: str | None = None
    """LDraw: name of the model of the file that is built."""
    base: str | None = None
    """One of "fixed", "floating". URDF: whether the root link is held."""
    loose_robots: bool = False
    """MuJoCo: whether bodies that motors move are free."""
    keep_copies: bool = False
    """CAD and meshes: whether bodies that are in the file twice stay."""
    studs: StudRules | None = None
    """Bricks: strength of studs, and points at which sides push each other."""
