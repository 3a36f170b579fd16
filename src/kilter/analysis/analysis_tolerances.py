"""Numerical tolerances of margins, regions and plans, and how they depend on each other.

Accelerations are in units of g, everything else is relative [-].

    MOTION_GOOD < MOTION_ASKED < MOTION_ENOUGH < MOVES < STATED_MOST    motion, not rounding
    ZERO_MOTION < MOTION_GOOD
    ALONG < the angle of contacts                    faces along a path stop nothing
    RANK < LOCKS                                     a locked row is far from singular
    ENTERS, RANK, PRESSES >= mechanics' TOLERANCE    no result is finer than its judge
"""

from __future__ import annotations

__all__ = [
    "ALONG",
    "ENTERS",
    "LEAST_IS_OPTIMAL",
    "LOCKS",
    "MOTION_ASKED",
    "MOTION_ENOUGH",
    "MOTION_GOOD",
    "MOVES",
    "NO_DESCENT",
    "PRESSES",
    "RANK",
    "STATED_MOST",
    "ZERO_MOTION",
]

ALONG = 1e-7
"""Largest cosine between a path and the normal of a face that lies along the path [-]."""

MOVES = 1e-6
"""A part moves if its linear, or radius x angular, acceleration is above this [g]."""
MOTION_GOOD = 1e-10
"""Residual of Gauss's conditions that ends the search for a motion [g]."""
MOTION_ENOUGH = 1e-8
"""Residual that ends the search for a motion, if the assembly has many parts [g]."""
MOTION_ASKED = 3e-9
"""Tolerance passed to the solver for a motion of many parts; its rows are scaled differently [g].
"""
ZERO_MOTION = 1e-14
"""Accelerations below this are rounding of an exact zero [g]."""
NO_DESCENT = 1e-12
"""An optimum of the displacement program above minus this counts as 0 [fractions of the largest
cost]."""
LEAST_IS_OPTIMAL = 1e-6
"""Largest residual at which the shortest displacement counts as optimal, over the largest entry
[-]."""
RANK = 1e-9
"""Singular values below this fraction of the largest count as zero, for exact data."""
PRESSES = 1e-9
"""A patch whose normal force is below this fraction of the largest weight has no pressure centre.
"""
ENTERS = 1e-9
"""A motion of unit speed penetrates a contact if its gap opens at less than minus this [-]."""
STATED_MOST = 1e-2
"""An acceleration above this cannot come from the stated inaccuracy of a file [g]."""
LOCKS = 1e-4
"""Least opening at unit speed that the multipliers of a locked part must prove [-].

It exceeds the error of normals, so that a wedge that nearly slips out does not lock."""
