"""Every tolerance of regions, orientations and margins, and how each relates to the others.

Four kinds, and none means another's:

- *rounding* of a number that is 0, or of two equal numbers;
- *widths*: how near to a boundary a direction counts as on it [rad];
- *agreements*: how near two sides of an enclosure come before the search ends;
- *steps*: distances beyond a boundary at which a proof is tried, the nearest first.

A width lies above rounding, an agreement above the tolerance of its solver,
and steps start below the agreement they serve.
"""

from __future__ import annotations

__all__ = [
    "ACROSS_GRAVITY",
    "AROUND_LIMIT",
    "BALANCED",
    "BEYOND_CONE",
    "BEYOND_FACET",
    "BEYOND_FAR",
    "BEYOND_LIMIT",
    "BLUR_OVER_TOLERANCE",
    "CONIC_SHARP",
    "ENTRY_ROUNDING",
    "FOLLOWING_AGREES",
    "GAP_DEG",
    "HULL_FINER",
    "HULL_ROUNDING",
    "KAPPA_GAP",
    "KAPPA_RESIDUAL",
    "LIMIT_AGREES",
    "MOVES",
    "MU_AGREES",
    "MU_BALANCED",
    "MU_CLOSE",
    "MU_NOTHING",
    "MU_SQUEEZED",
    "NEARLY",
    "NOT_HELD",
    "NO_DIRECTION",
    "NO_GAIN",
    "NO_LENGTH",
    "NO_PROJECTION",
    "NO_RISE",
    "NO_SHARE",
    "ON_PLANE",
    "OPPOSITE",
    "OPTIMAL",
    "OPTIMAL_FACE",
    "OUTSIDE_HULL",
    "PARALLEL_PLANES",
    "PROVED_APART",
    "PULLED_IN",
    "PUSH_AGREES",
    "RAY_BLUR",
    "SAME_ON_DIAMOND",
    "SAME_POINT",
    "SAME_RAY",
    "SIDES_APART",
    "SIDES_NEAR",
    "STEEPEST",
    "TILT_AGREES",
    "UNLIMITED",
    "WALK_STEP",
]

# --- what rounding leaves -------------------------------------------------------------------

ENTRY_ROUNDING = 1e-14
"""Entries of a scaled matrix below this are rounding of an exact zero [-]."""
HULL_ROUNDING = 1e-13
"""Of the largest coordinate: a point this far outside a facet of a hull is on it [-]."""
HULL_FINER = 0.1
"""How much finer a hull is kept than the agreement that is asked of it [-]."""
OPPOSITE = 1e-12
"""Unit vectors whose sum is this short are opposite [-]."""
ON_PLANE = 1e-9
"""A unit vector is on a plane up to this sine [-]."""
PARALLEL_PLANES = ON_PLANE
"""Planes with a smaller sine between them have no line in common [-]."""
ACROSS_GRAVITY = ON_PLANE
"""An axis is across gravity up to this cosine [-]."""
SAME_POINT = 1e-9
"""A unit point of a cone this near to a direction is that direction [rad]."""
SAME_ON_DIAMOND = 1e-9
"""Two points of the diamond |g|_1 = 1 this near are one; a slack up to this is none [-]."""
NO_LENGTH = 1e-9
"""A projection of a unit vector on lines, shorter than this, is none [-]."""
NO_RISE = 1e-9
"""A centre of mass that rises by less than this, over the size of its part, does not rise [-]."""

# --- widths ---------------------------------------------------------------------------------

BLUR_OVER_TOLERANCE = 10.0
"""Without friction directions this many tolerances of the data from the boundary are on it."""
SAME_RAY = 1e-7
"""Extreme rays nearer than this are one; a projection that moves less is inside [rad]."""
NO_PROJECTION = 1e-6
"""A projection of a unit vector by a conic program, shorter than this, is none [-]."""
RAY_BLUR = 1e-5
"""Rays with friction this near to one another, or to a facet, are on it: they are found to
1e-6 [rad]."""
NO_DIRECTION = 1e-3
"""Optima of a cone cut off at a length of about 1, shorter than this, are no direction [-]."""
MOVES = 1e-6
"""A part moves in a mechanism where it is faster than this fraction of the fastest [-]."""
NOT_HELD = -1e-7
"""A largest share of a load below this: it is not held as given [-]."""
NO_SHARE = 1e-12
"""A largest share of a load nearer to 0 than this is 0 [-]."""
MU_NOTHING = 1e-7
"""Coefficients of friction below this count as zero: any friction holds [-]."""
MU_SQUEEZED = (MU_NOTHING, 1e-6, 1e-5, 1e-4, 1e-3)
"""Coefficients for which forces of a squeeze are asked to hold, in turn [-]."""
NO_GAIN = 1e-6
"""Gains below this, in degrees or weights, are none."""
BALANCED = 1e-8
"""Imbalance over the weight of a part that forces which follow masses may leave [-]."""
UNLIMITED = 1e6
"""Shares of a load, or pushes over the weight of all parts, from here on are unlimited [-]."""
NEARLY = 1e-5
"""A share this near to the most that is looked at, relative to it, is the most [-]."""
STEEPEST = 1e6
"""Tangent of a turn that counts as a right angle [-]."""

# --- agreements -----------------------------------------------------------------------------

CONIC_SHARP = 1e-12
"""Asked of the conic solver where a motion proves a boundary as near as it is exact [-]."""
LIMIT_AGREES = 2e-7
"""Shares of a load proved to be held and not to be differ by this at most, over 1 and them [-]."""
PROVED_APART = 1e-5
"""Where the proofs of both sides are farther apart, the motion is mended [-]."""
SIDES_NEAR = 1e-4
"""Where the proofs of both sides of a large program are this near, it is left at that [-]."""
SIDES_APART = 1e-2
"""Where they differ by more after linear programs, a sharper conic one is asked [-]."""
OPTIMAL_FACE = 1e-10
"""Displacements count as optimal up to this, over the mass [length unit]."""
OPTIMAL = 1e-9
"""Two values of z that differ by less than this fraction of the mass are the same [-]."""
OUTSIDE_HULL = 2e-9
"""A reachable moment counts as outside a facet from here on, over the mass [length unit]."""
TILT_AGREES = 1e-9
"""Least tangents of a tilt from inside and outside differ by this fraction at most [-]."""
MU_AGREES = 1e-8
"""Least friction from both sides differs by this fraction at most [-]."""
MU_BALANCED = 1e-12
"""Imbalance, as a certificate has it, that forces of a least friction leave: rounding [-]."""
MU_CLOSE = 1e-6
"""So near, a coefficient that cannot be decided ends the search [-]."""
PUSH_AGREES = 1e-6
"""Least pushes from inside and outside differ by this fraction at most [-]."""
FOLLOWING_AGREES = 1e-3
"""The same for the tilt over intervals, with forces that follow masses [-]."""
KAPPA_RESIDUAL = 1e-7
"""Residual of a quadratic program that is small enough, in units of g [-]."""
KAPPA_GAP = 1e-6
"""Least instability kappa and its bound differ by no more [-]."""
GAP_DEG = 0.1
"""Inner and outer cone of a region with friction are this near, where not given [deg]."""

# --- steps ----------------------------------------------------------------------------------

WALK_STEP = 1e-5
"""The epsilon step of the published walk, on the diamond [-]."""
PULLED_IN = (0.0, 1e-8, 1e-7, 1e-6, RAY_BLUR)
"""A ray with friction is moved inwards by so much until forces prove it [rad]."""
BEYOND_FACET = (1e-9, 1e-8, 1e-7, 1e-6)
"""Beyond a facet with friction: where its motion is asked to prove it; else it is sought anew,
as a limit, from within [rad]."""
BEYOND_FAR = (*BEYOND_FACET, 1e-5, 1e-4, 1e-3)
"""The same for a motion that is exactly admissible, however little power it gains [rad]."""
BEYOND_CONE = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0)
"""Beyond a facet without friction: where a motion is asked to prove it [rad]."""
AROUND_LIMIT = (3e-9, 3e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3)
"""On either side of a limit, over 1 and it: where a proof of it is asked for [-]."""
BEYOND_LIMIT = (1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3)
"""Above a load limit, relative to it: where its mechanism is asked to prove it [-]."""
