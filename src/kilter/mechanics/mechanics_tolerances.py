"""Every tolerance of programs and of the judges, and how they stand to one another.

All are relative [-] unless a unit is given. What a verdict says of exact data:

    NO_EXCUSE > TOLERANCE,   RULED_OUT * TOLERANCE < 1

a motion rules out forces of RULED_OUT weights, so that forces which leave TOLERANCE of a weight
unbalanced and a motion that moves the part never pass together; an imbalance of NO_EXCUSE of a
weight is none at all, however large the forces are. What obeys Coulomb's law:

    WITNESS_SLIVER > WITNESS_POWER > WITNESS_EXACT > CONE_ROUNDING

no residual may be more than a sliver of what a motion gains, and none so large that blocks which
can only rest come as near. What rounding leaves of numbers near 1:

    ZERO_ENTRY < MIRROR < MIRROR_ROWS < AGREES <= TOLERANCE < NORMAL_ANGLE <= STILL
"""

from __future__ import annotations

__all__ = [
    "AGREES",
    "BLUR",
    "COARSE_POWER",
    "CONE_ROUNDING",
    "FOLLOWS",
    "MIRROR",
    "MIRROR_CELL",
    "MIRROR_ROWS",
    "NORMAL_ANGLE",
    "NO_EXCUSE",
    "OPENS_FAR",
    "OPENS_MORE",
    "POWER_ROUNDING",
    "RULED_OUT",
    "SAME_AREA",
    "STILL",
    "TOLERANCE",
    "WITNESS_EXACT",
    "WITNESS_POWER",
    "WITNESS_SLIVER",
    "ZERO_ENTRY",
]

# verdicts ----------------------------------------------------------------------------------

TOLERANCE = 1e-9
"""Imbalance of a part over the forces on it up to which they balance, for exact data."""
BLUR = 10.0
"""The same over the accuracy of coordinates that are coarser than float64."""
RULED_OUT = 1e6
"""Contact forces, over the weight, that a motion must rule out."""
COARSE_POWER = 0.25
"""Fraction of the tolerance of coarse data that the power of a motion must exceed."""
OPENS_FAR = 1e6
"""A motion that opens every contact moves no part farther than this over its least opening."""
OPENS_MORE = 1e-3
"""Such a motion is added by this much more than what it is to mend."""
NO_EXCUSE = 0.01
"""Imbalance over the weight of a part that no contact force excuses."""
STILL = 1e-6
"""A part, or point, slower than this fraction of the fastest does not move, or slide."""
POWER_ROUNDING = 1e-14
"""What rounding leaves of a power, over the sum of the sizes of its terms [-]."""
FOLLOWS = 1e-8
"""The normal of a facet and that of its motion are one up to this [-]."""
AGREES = 1e-9
"""Numbers of a file and of a proof are the same up to this fraction of their size."""

# Coulomb's law -----------------------------------------------------------------------------

WITNESS_EXACT = 1e-8
"""Worst residual of a motion in the law, over |a| / |w|, with which it counts."""
WITNESS_SLIVER = 1e-3
"""Worst residual over |a|^2 / |w|^2 with which it counts."""
WITNESS_POWER = 1e-5
"""Least power of a motion over |w|^2 of the parts that move."""
CONE_ROUNDING = 1e-14
"""How far a force may leave its cone, over its size, by rounding alone."""

# entries of matrices, and mirror images ------------------------------------------------------

ZERO_ENTRY = 1e-14
"""Entries of a scaled matrix below this are rounding of an exact zero."""
MIRROR = 1e-12
"""Loads and inertia across a plane of reflection, over the largest, that count as none."""
MIRROR_ROWS = 1e-10
"""Entries of rows that differ by less are those of a mirror image."""
MIRROR_CELL = 1e-6
"""Places over the radius of a part, and directions, are compared in cells of this size."""
NORMAL_ANGLE = 1e-6
"""A line lies across a normal up to this angle [rad]."""
SAME_AREA = 1e-6
"""The hull of a patch and its area are one up to this fraction of it."""
