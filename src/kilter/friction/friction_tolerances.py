"""Every tolerance of the friction wing, and how they stand to one another.

All are relative [-] unless a unit is given: accelerations in units of |w|, powers of |w|^2,
forces of |w| over the mobility of their point (`kilter.friction.law`); those of a witness are in
`kilter.mechanics.mechanics_tolerances`. Four ladders, each
from the coarse to the fine; the tests hold the order.

What counts as a motion, and what as none:

    WITNESS_POWER > COARSEST_NO_POWER > NO_POWER > OBEYED

so that no assembly can be refuted by a motion and proved to have none. What is exact:

    CLOSE > WITNESS_SLIVER,   WITNESS_EXACT > EXACTLY > SHARP > SOLVED

a conic program is asked for more digits than a witness must show, Newton's method gives more
still. What a force or speed must exceed to decide the mode of a point:

    CLEAR > SLACK > SOLVED,   CLEAR > CREEP

and what rounding leaves, of numbers near 1: ZERO_ENTRY < CONE_ROUNDING < JOINT_RANK < FLAT.
"""

from __future__ import annotations

__all__ = [
    "BALANCED",
    "CLEAR",
    "CLOSE",
    "COARSEST_NO_POWER",
    "CONE_ROUNDING",
    "CREEP",
    "ELASTIC_GAP",
    "EXACTLY",
    "FLAT",
    "GOAL",
    "GONE",
    "JOINT_RANK",
    "LARGEST_FORCE",
    "NARROWEST_CONE",
    "NEAR_ITS_CONE",
    "NODE_GAP",
    "NO_POWER",
    "OBEYED",
    "POINT_AT_REST",
    "PRESSES",
    "SHARP",
    "SLACK",
    "SOFT_MODE",
    "SOFT_SQUEEZE",
    "SOLVED",
    "STEADY",
    "WIDEST_SECTOR",
    "ZERO_ENTRY",
]


# the law, its rows and patches -------------------------------------------------------------------

ZERO_ENTRY = 1e-14
"""Entries of the scaled matrix below this are rounding of an exact zero."""
JOINT_RANK = 1e-10
"""Singular values of the rows of joints below this fraction of the largest are zero."""
FLAT = 1e-9
"""A patch is flat if its normals differ by less [rad], and its points lie off one plane by
less, over the largest bounding radius of a part."""


# the proof that no motion can start --------------------------------------------------------------

NO_POWER = 1e-8
"""Power that counts as none, over |w|^2 of the lightest part: above what rounding leaves of the
bound of a case with nothing left to divide (1.2e-9 of it at 18 parts), and a thousandth of the
least that a witness must have (`kilter.mechanics.mechanics_tolerances.WITNESS_POWER`)."""
COARSEST_NO_POWER = 1e-6
"""However coarse the data, a power above this, over |w|^2 of the lightest part, is one."""
OBEYED = 1e-9
"""A relaxed motion obeys the law if it gains no more than this fraction of its power by
breaking it; a point that gains less, in units of |w|^2, is not worth branching on."""
LARGEST_FORCE = 1000.0
"""Largest force of a contact point that a proof thinks of, over the weight of all free parts.
A proof that needs this bound says so (`Exclusion.assumes`)."""
NARROWEST_CONE = 1e-3
"""A cone of twists that is narrower than this is not halved [rad]."""
WIDEST_SECTOR = 0.9
"""A sector of sliding wider than this fraction of half a turn says nothing."""
POINT_AT_REST = 1e-9
"""A twist that moves a point less than this, over the largest lever, leaves it at rest."""
CONE_ROUNDING = 1e-12
"""By how much cones and sectors are widened, so that rounding leaves no gap between two [rad]."""


# the search of a motion --------------------------------------------------------------------------

EXACTLY = 1e-9
"""Residual of the contact law at which a motion is exact, and the search ends."""
SHARP = 1e-11
"""Gap asked of the conic programs of De Saxce's iteration: an interior point's x is good to
the root of it only."""
NODE_GAP = 1e-8
"""Gap asked of the conic programs of contact modes, whose x is a first guess."""
CLOSE = 0.01
"""Residual of the nearest motion, over |a|^2 / |w|^2, beyond which it tells nothing."""
GONE = 1e-5
"""A start of De Saxce's iteration whose |x| falls below this has come to rest."""
STEADY = 1e-7
"""Change of the speeds of sliding, over |x|, at which De Saxce's iteration has converged."""


# from nearly to exactly --------------------------------------------------------------------------

CLEAR = 1e-4
"""Forces below this are taken for none at first; below `SLACK` in a second try."""
NEAR_ITS_CONE = 1e-4
"""How near a force is to the boundary of its cone, over its size, to be taken for on it; and
a point that slides slower does not tell a direction of sliding."""
CREEP = 1e-7
"""Points that slide slower than this may as well stick."""
SLACK = 1e-9
"""Speeds and forces on the wrong side of 0, or of the cone, by more than this change the mode."""
SOFT_MODE = 1e-9
"""Regularisation of the equations of a mode, whose terms are near 1."""
SOLVED = 1e-14
"""Residual at which the equations of a mode are solved."""


# seating -----------------------------------------------------------------------------------------

BALANCED = 1e-9
"""Largest imbalance of a part, over its weight, of parts that are seated: that of a verdict
(`kilter.mechanics.program.TOLERANCE`)."""
GOAL = 1e-11
"""Imbalance of a part, over its weight, at which the iteration ends."""
ELASTIC_GAP = 1e-9
"""Gap asked of the forces of the least elastic energy."""
PRESSES = 1e-3
"""A point with a force below this part of the greatest does not tell a deflection."""
SOFT_SQUEEZE = 1e-6
"""Regularisation of the least squares that find the displacement of a random start."""
