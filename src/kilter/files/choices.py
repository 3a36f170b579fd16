"""What is chosen where a file or an object leaves it open."""

from __future__ import annotations

from dataclasses import dataclass

from kilter.assembly.bricks import StudRules

__all__ = ["Choices"]


@dataclass(frozen=True, slots=True)
class Choices:
    """The options of `kilter.load` that a format of its own kind asks for.

    Attributes
    ----------
    units : {"m", "cm", "mm", "in"} or None
        Where none are stated.
    contacts : {"file", "geometry"} or None
        Of COMPAS: whether interfaces are the contacts.
    keyframe : str or None
        Of MuJoCo: the name of the pose.
    base : {"fixed", "floating"} or None
        Of URDF: whether the root is held.
    studs : StudRules or None
        Of bricks: how their studs and sides hold each other.
    """

    units: str | None = None
    contacts: str | None = None
    keyframe: str | None = None
    base: str | None = None
    studs: StudRules | None = None
