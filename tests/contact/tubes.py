"""Pins for tubes with an exact bore."""

from kilter.assembly import Part
from kilter.rigid import Pose
from kilter.scenes.pieces import tube
from kilter.shape.primitives import Cylinder

__all__ = ["pin", "tube"]


def pin(name, radius, height, at=(0, 0, 0), **options):
    """A solid cylinder about z."""
    return Part(name, Cylinder(radius, height), Pose(at), **options)
