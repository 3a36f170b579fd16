"""Tolerances of results beside a verdict, and their relations.

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
"""Faces whose normal has no more than this along a path lie along it."""

MOVES = 1e-6
"""A part moves where its linear, or radius x angular, acceleration is above this [g]."""
MOTION_GOOD = 1e-10
"""Residual of Gauss's conditions that ends the search for a motion [g]."""
MOTION_ENOUGH = 1e-8
"""The same for programs of many parts [g]."""
MOTION_ASKED = 3e-9
"""Of the solver then, whose rows are of another scale [g]."""
ZERO_MOTION = 1e-14
"""Accelerations below this are rounding of an exact zero [g]."""
NO_DESCENT = 1e-12
"""Optima of LP (9) above minus this, over the largest cost, are 0."""
LEAST_IS_OPTIMAL = 1e-6
"""Residual over the largest displacement up to which the shortest one is optimal."""
RANK = 1e-9
"""Singular values below this fraction of the largest count as zero, for exact data."""
PRESSES = 1e-9
"""Normal forces below this fraction of the largest weight have no pressure centre."""
ENTERS = 1e-9
"""Openings below minus this, at unit speed, enter."""
STATED_MOST = 1e-2
"""Accelerations above this are no matter of the accuracy that a file states [g]."""
LOCKS = 1e-4
"""Least opening of a locked part at unit speed, as its multipliers bound it: more than normals are
off by, so that a wedge that nearly slips out does not lock."""
