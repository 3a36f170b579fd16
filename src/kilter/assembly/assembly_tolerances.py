"""Tolerances of assemblies: sizes that are read, and what counts as flat, level or the same.

    RESOLVED < UPRIGHT < SAME_SURFACE = PLANAR_AXIS = FLAT_PART = INSIDE_OUT < COPLANAR
             < BESIDE_SEAM = ACROSS = ON_GRID < CREASE < SMOOTH

all relative, or angles in rad.

None of them decides what touches: that is `kilter.contact.contact_tolerances`.
"""

from __future__ import annotations

__all__ = [
    "ACROSS",
    "BESIDE_SEAM",
    "COPLANAR",
    "CREASE",
    "FLAT_PART",
    "INSIDE_OUT",
    "LARGEST",
    "ON_GRID",
    "PLANAR_AXIS",
    "RESOLVED",
    "SAME_SURFACE",
    "SMOOTH",
    "UPRIGHT",
]

LARGEST = 1e30
"""Sizes of parts above this, or below its inverse, are refused: moments of inertia, fifth
powers of a size, must stay within float64 [length unit]."""
RESOLVED = 1e-14
"""A part smaller than this times the largest of its coordinates is refused: numbers, which have
sixteen digits, do not tell its corners apart [-]."""
FLAT_PART = 1e-9
"""A part of less volume than this times the cube of its reach is flat, and refused [-]."""
INSIDE_OUT = 1e-9
"""A second moment of matter below zero by more than this fraction of the largest is no rounding."""
PLANAR_AXIS = 1e-9
"""Sine of the angle up to which the axis of a joint lies along or across y [-]."""
SAME_SURFACE = 1e-9
"""Curved surfaces of one part that differ by less than this fraction of its size are one."""
COPLANAR = 1e-8
"""1 - cosine up to which neighbouring triangles lie in one plane [-]."""
SMOOTH = 0.6
"""Neighbouring triangles of a mesh that meet at less than this may stand for a curve [rad]."""
UPRIGHT = 1e-12
"""Sine of the angle up to which an axis is upright: a torus is lowest all around [-]."""
BESIDE_SEAM = 1e-6
"""A face reaches this fraction of its radius over its seams, an edge over its chord [-]."""
ACROSS = 1e-6
"""Cosine of the angle up to which the direction of a given feature is across the normal [-]."""
ON_GRID = 1e-6
"""How far a brick may be off its cells or turned, in cells and rad [-]."""
CREASE = 1e-3
"""Faces that meet at less than this have no edge: the seam of a fillet [rad]."""
SMALL_HOLES = 0.1
"""Holes whose closure has at most this fraction of the surface leave the volume believable [-]."""
