"""Tolerances of the package `friction`, and the order between them.

All are relative [-] unless a unit is given: accelerations in units of |w|, powers of |w|^2, forces
of |w| over the mobility of their point (`kilter.friction.law`). Those of a witness are in
`kilter.mechanics.mechanics_tolerances`. For motions:

    WITNESS_POWER > COARSEST_NO_POWER > NO_POWER > OBEYED

so that no assembly can be both refuted by a motion and proved to have none. For accuracy:

    WITNESS_EXACT > EXACTLY > SHARP > SOLVED

A conic program is solved to more digits than a witness needs, and Newton's method adds more. For
the mode of a point, which a force or speed decides only above these values:

    SLOW > CLEAR > SLACK > SOLVED,   CLEAR > CREEP

For rounding of numbers near 1: ZERO_ENTRY < CONE_ROUNDING < JOINT_RANK < FLAT.
"""

from __future__ import annotations

# the law, its rows and patches -------------------------------------------------------------------

ZERO_ENTRY = 1e-14
"""Entries of the scaled matrix below this value are rounding errors of an exact zero."""
JOINT_RANK = 1e-10
"""Singular values of the rows of joints below this fraction of the largest count as zero."""
FLAT = 1e-9
"""A patch is flat if its normals differ by less [rad], and its points deviate from a plane by less,
over the largest bounding radius of a part.
"""
SAME_PLACE = 1e-8
"""Coordinates over the size, and components of normals, that differ less are equal in the order of
rows; it exceeds the rounding of a copy that is turned, and of one that is far from the origin."""


# the proof that no motion can start --------------------------------------------------------------

NO_POWER = 1e-8
"""Power that counts as zero, over |w|^2 of the lightest part. It exceeds the rounding of the bound
of a case that cannot be divided (1.2e-9 of it at 18 parts), and is a thousandth of the least power
of a motion that counts as a proof (`kilter.mechanics.mechanics_tolerances.WITNESS_POWER`). A larger
value closes more cases."""
COARSEST_NO_POWER = 1e-6
"""Upper limit of the power that counts as zero for coarse data, over |w|^2 of the lightest part."""
OBEYED = 1e-9
"""A relaxed motion obeys the law if its gain by violating it is at most this fraction of its power;
a point that gains less, in units of |w|^2, is not divided.
"""
LARGEST_FORCE = 1000.0
"""Assumed bound of the force of a contact point, over the weight of all free parts, if no bound is
proved. A proof that needs it states so (`Exclusion.assumes`).
"""
NARROWEST_CONE = 1e-3
"""Cones of twists narrower than this are not halved [rad]."""
WIDEST_SECTOR = 0.9
"""Sliding sectors wider than this fraction of half a turn are not used as constraints."""
POINT_AT_REST = 1e-9
"""A twist that moves a point less than this, over the largest lever, leaves it at rest."""
CONE_ROUNDING = 1e-12
"""Widening of cones and sectors, so that rounding leaves no gap between two [rad]."""


# the search of a motion --------------------------------------------------------------------------

EXACTLY = 1e-9
"""Residual of the contact law at which a motion is exact, and the search ends."""
SHARP = 1e-11
"""Requested gap of the conic programs of De Saxce's iteration; x of an interior point is only
accurate to its root.
"""
NODE_GAP = 1e-8
"""Tolerance of the conic programs of contact modes, whose solutions are only first guesses."""
GONE = 1e-5
"""Size |x| below which a run of De Saxce's iteration counts as a state of rest."""
STEADY = 1e-7
"""Change of the sliding speeds, over |x|, at which De Saxce's iteration has converged."""


# from nearly to exactly --------------------------------------------------------------------------

CLEAR = 1e-4
"""Forces below this value count as zero in the first attempt; in the second, below `SLACK`."""
NEAR_ITS_CONE = 1e-4
"""Relative distance of a force to the boundary of its cone at which it counts as on the boundary. A
point that slides slower than this fraction of the fastest does not define a sliding direction.
"""
CREEP = 1e-7
"""Points that slide slower than this fraction of the fastest are also tried as sticking."""
SLOW = 0.03
"""Points that slide slower than this fraction of the fastest are, in a third attempt, tried as
sticking: near a limit the motion itself is little above the error of the solver. A larger value
tries more points so."""
SLACK = 1e-9
"""A speed or force that violates its mode by more than this changes the mode."""
SOFT_MODE = 1e-9
"""Regularisation of the equations of a mode, whose terms are near 1."""
SOLVED = 1e-14
"""Residual at which the equations of a mode are solved."""


# seating -----------------------------------------------------------------------------------------

BALANCED = 1e-9
"""Largest imbalance of a part, over its weight, of seated parts: equal to that of a verdict
(`kilter.mechanics.program.TOLERANCE`).
"""
GOAL = 1e-11
"""Imbalance of a part, over its weight, at which the search for a seat ends."""
ELASTIC_GAP = 1e-9
"""Requested gap of the forces of the least elastic energy."""
PRESSES = 1e-3
"""Points with a force below this fraction of the greatest do not define a deflection."""
SOFT_SQUEEZE = 1e-6
"""Regularisation of the least squares for the displacement of a random start."""
