"""Tolerances of programs and of the checks of proofs, and the order between them.

All are relative [-] unless a unit is given. For verdicts on exact data:

    UNITS_IN_LAST_PLACE < EXCESS < TOLERANCE,   UNITS_IN_LAST_PLACE * RULED_OUT < TOLERANCE

Forces of more than RULED_OUT weights are no proof, and a motion rules out smaller forces, so forces
and a motion never both pass (`kilter.mechanics.clusters`). Rounding of such forces is smaller
than TOLERANCE of the weight of all parts. For Coulomb's law:

    WITNESS_SLIVER > WITNESS_POWER > WITNESS_EXACT > CONE_ROUNDING

No residual may exceed a small fraction of the gain of a motion, and none may be so large that
blocks for which only rest is possible come as near. For rounding of numbers near 1:

    ZERO_ENTRY < MIRROR < MIRROR_ROWS < AGREES <= TOLERANCE < NORMAL_ANGLE <= STILL
"""

from __future__ import annotations

# verdicts ----------------------------------------------------------------------------------

TOLERANCE = 1e-9
"""Largest imbalance of a part, over its weight, that counts as balance for exact data. A larger
value accepts forces that balance less exactly.
"""
UNITS_IN_LAST_PLACE = 4 * 2.0**-53
"""Rounding of the balance of a part, over the sum of the forces on it, for exact data: four units
in the last place. A larger value excuses more imbalance by large forces.
"""
EXCESS = 1e-11
"""Largest sum of such roundings beyond the tolerance, over the weight of a cluster, for exact data.
A larger value rejects slower motions of light parts that touch heavy parts.
"""
COARSE_EXCESS = 1.0
"""The same sum over the tolerance, for data coarser than float64. Inclined stacks of 30 cubes need
up to 0.5, of 100 cubes up to 3.7. A larger value rejects slower motions.
"""
EXCUSED = 1e-4
"""Largest such rounding of a part, over its weight, for exact data. Masses of ratios up to 1e12
need up to 1e-7. A larger value accepts steeper slides of parts far lighter than their cluster.
"""
COARSE_EXCUSED = 1e-2
"""The same for data coarser than float64."""
BLUR = 10.0
"""Tolerance of a part over the relative accuracy of its coordinates, for data coarser than float64.
A larger value accepts more imbalance of coarse data.
"""
RULED_OUT = 1e6
"""Largest sum of contact forces, over the weight of a cluster, that a proof by forces may have and
that a motion must exclude. A larger value demands more exact motions, since contacts that a motion
closes by rounding then count more."""
ASIDE = 1e-2
"""Least distance of a point from the vertical that gives a cluster its frame [largest radius]."""
SHIFT_DIGITS = 10
"""Decimal digits to which two clusters that are equal up to a shift must agree, relative to the
largest value of each kind [-]."""
OPENS_FAR = 1e6
"""Largest ratio of a part's motion to the least gap opening, in a motion that opens all contacts. A
larger value admits opening motions of nearly closed contacts."""
OPENS_MORE = 1e-3
"""Safety factor on the opening motion that is added to repair a violated one."""
STILL = 1e-6
"""A part or point slower than this fraction of the fastest counts as not moving or not sliding."""
LOCKED = 0.9
"""Depth of a squeeze in a cone above which the contact is locked; depths are 0 or 1, and their
rounding errors lie between. A larger value locks fewer parts.
"""
RIGID = 1e-6
"""Least singular value, over the largest, of rows that stop all motions between two parts. A larger
value merges fewer parts.
"""
POWER_ROUNDING = 1e-14
"""Rounding error of a power, over the sum of the absolute values of its terms [-]."""
FOLLOWS = 1e-8
"""Largest difference between the unit normal of a facet and the normal that its motion gives [-].
"""
AGREES = 1e-9
"""Numbers of a file and of a proof are equal if they differ by at most this fraction."""

# Coulomb's law -----------------------------------------------------------------------------

WITNESS_EXACT = 1e-8
"""Largest residual of a motion in the contact law, over |a| / |w|. A larger value accepts less
exact motions.
"""
WITNESS_SLIVER = 1e-3
"""Largest residual of a motion in the contact law, relative to its kinetic term |a|^2 / |w|^2. A
larger value accepts weaker motions."""
WITNESS_POWER = 1e-5
"""Least power of a motion, over |w|^2 of the moving parts. A larger value rejects weaker
motions.
"""
CONE_ROUNDING = 1e-14
"""Rounding error of a force at the boundary of its cone, over its size."""

# entries of matrices, and mirror images ------------------------------------------------------

ZERO_ENTRY = 1e-14
"""Entries of a scaled matrix below this value are rounding errors of an exact zero."""
ROUNDED_ENTRY = 1e-9
"""Entries of a scaled matrix below this value are dropped after all solvers failed. A larger value
changes the forces and motions that are proposed, never their check.
"""
MIRROR = 1e-12
"""Loads and inertia across a mirror plane below this fraction of the largest count as zero."""
MIRROR_ROWS = 1e-10
"""Largest difference of the entries of a row and of its mirror image."""
MIRROR_CELL = 1e-6
"""Size of the cells in which points over the radius of a part, and directions, are compared."""
NORMAL_ANGLE = 1e-6
"""A line is perpendicular to a normal up to this deviation from 90 degrees [rad]."""
SAME_AREA = 1e-6
"""Largest difference of the area of a patch and that of its convex hull, over the hull's."""
