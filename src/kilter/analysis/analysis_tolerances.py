"""Numerical tolerances of margins, regions and plans, and how they depend on each other.

Accelerations are in units of g, everything else is relative [-].

    MOTION_GOOD < MOTION_ASKED < MOTION_ENOUGH < MOVES < STATED_MOST    motion, not rounding
    ZERO_MOTION < MOTION_GOOD
    ALONG < the angle of contacts                    faces along a path stop nothing
    RANK < LOCKS                                     a locked row is far from singular
    ENTERS, RANK, PRESSES >= mechanics' TOLERANCE    no result is finer than its judge
"""

from __future__ import annotations

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


# Numerical tolerances of regions, orientations and margins, and how they depend on each other.


# --- what rounding leaves -------------------------------------------------------------------

ENTRY_ROUNDING = 1e-14
"""Entries of a scaled matrix below this are rounding of an exact zero [-]."""
HULL_ROUNDING = 1e-13
"""A point less than this outside a facet of a hull lies on it, over the largest coordinate [-]."""
HULL_FINER = 0.1
"""Merging distance of the points of a hull, as a fraction of the required agreement [-]."""
OPPOSITE = 1e-12
"""Two unit vectors are opposite if their sum is shorter than this [-]."""
ON_PLANE = 1e-9
"""A unit vector lies in a plane if its sine to the plane is below this [-]."""
PARALLEL_PLANES = ON_PLANE
"""Two planes are parallel if the sine of the angle between them is below this [-]."""
ACROSS_GRAVITY = ON_PLANE
"""An axis is perpendicular to gravity if its cosine to gravity is at most this [-]."""
SAME_POINT = 1e-9
"""A unit point of a cone counts as a direction if the angle between them is below this [rad]."""
SAME_ON_DIAMOND = 1e-9
"""Two points of the diamond |g|_1 = 1 closer than this are equal; a smaller slack is zero [-]."""
NO_LENGTH = 1e-9
"""A projection of a unit vector on lines that is shorter than this counts as zero [-]."""
NO_RISE = 1e-9
"""A centre of mass that rises by less than this, over the size of its part, does not rise [-]."""

# --- widths ---------------------------------------------------------------------------------

BLUR_OVER_TOLERANCE = 10.0
"""Distance from the boundary, in tolerances of the data, at which a direction lies on it [-].

Only for regions without friction."""
SAME_RAY = 1e-7
"""Extreme rays closer than this merge; a direction closer to the cone is inside [rad]."""
NO_PROJECTION = 1e-6
"""A projection by a conic program that is shorter than this counts as zero; unit vectors [-]."""
NARROW = 1e-3
"""Least distance of a direction from the boundary of the known cone, to search from it [rad]."""
POINTED = 0.02
"""Least cosine of all rays of a pointed cone to an axis; with a smaller one it may hold a line."""
WIDEST_ARC = 2.0
"""Longest arc on which a boundary of directions is searched [rad]."""
RAY_BLUR = 1e-5
"""Distance at which rays with friction merge, and at which a ray lies on a facet [rad].

Rays are computed to 1e-6."""
NO_DIRECTION = 1e-3
"""Least length of an optimum that is a direction, in a cone cut at a length of about 1 [-]."""
NOT_HELD = -1e-7
"""The assembly as given is not held if the largest share of a load is below this [-]."""
NO_SHARE = 1e-12
"""A largest share of a load closer to 0 than this counts as 0 [-]."""
MU_NOTHING = 1e-7
"""Coefficients of friction below this count as zero: any friction holds [-]."""
MU_SQUEEZED = (MU_NOTHING, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1)
"""Friction coefficients for which forces of a squeeze are tried, in this order [-]."""
NO_GAIN = 1e-6
"""A smaller gain counts as zero [deg, or weights]."""
BALANCED = 1e-8
"""Largest imbalance of forces that follow the masses, over the weight of the part [-]."""
PLAIN = 1e-5
"""Component of a recommended direction of gravity that is left out if the answer stays [rad]: it
comes from the search, and is below what a table can be levelled to."""
UNLIMITED = 1e6
"""A share of a load above this is unlimited [-]."""
HARDEST_PUSH = 1e5
"""A push over the weight of all parts above this is unlimited [-]."""
NEARLY = 1e-5
"""A share counts as the largest share of the search if it is closer to it; relative [-]."""
STEEPEST = 1e6
"""Tangent of a turn that counts as a right angle [-]."""

# --- agreements -----------------------------------------------------------------------------

CONIC_SHARP = 1e-12
"""Tolerance of the conic solver if its motion must prove a boundary at close distance [-]."""
SHARE_AGREES = 1e-5
"""Largest difference of the bounds of a boundary direction along an arc, over max(share, 1) [-]."""
RANGE_AGREES = 1e-8
"""Largest gap between both sides of an end of a range of forces [weight of the parts]."""
OPENS_BY_MOVING = 1e-6
"""Opening or slip of a contact that counts if supports move [largest movement of a support]."""
LIMIT_AGREES = 2e-7
"""Largest gap between the proved bounds of a share of a load, over max(share, 1) [-]."""
PROVED_APART = 1e-5
"""The motion is repaired if the proved bounds of a limit differ by more; relative [-]."""
SIDES_NEAR = 1e-4
"""The search for a limit of a large program ends at this relative difference of its bounds [-]."""
SIDES_APART = 1e-2
"""If the bounds differ by more after linear programs, a sharper conic program is solved [-]."""
OPTIMAL_FACE = 1e-10
"""Largest deviation of an optimal displacement, over the mass [length unit]."""
OPTIMAL = 1e-9
"""Two values of z are equal if they differ by less than this fraction of the mass [-]."""
OUTSIDE_HULL = 2e-9
"""A reachable moment is outside a facet if its distance over the mass is larger [length unit]."""
TILT_AGREES = 1e-9
"""Largest relative difference of the proved bounds of the tangent of a tilt [-]."""
MU_AGREES = 1e-8
"""Largest relative difference of the proved bounds of the least friction coefficient [-]."""
MU_BALANCED = 1e-12
"""Imbalance of the forces at the least friction that counts as rounding; as in certificates [-]."""
MU_CLOSE = 1e-6
"""Relative difference of the bounds of a friction coefficient below which a failure to prove a
coefficient ends the search [-]."""
PUSH_AGREES = 1e-6
"""Largest relative difference of the proved bounds of a least push [-]."""
FOLLOWING_AGREES = 1e-3
"""Largest relative difference of the bounds of a worst tilt, with forces that follow masses [-]."""
KAPPA_RESIDUAL = 1e-7
"""Largest accepted residual of a quadratic program, in units of g [-]."""
KAPPA_GAP = 1e-6
"""Largest difference between the least instability kappa and its proved bound [-]."""
GAP_DEG = 0.1
"""Default of the largest angle between inner and outer cone of a region with friction [deg]."""

# --- steps ----------------------------------------------------------------------------------

WALK_STEP = 1e-5
"""Step length epsilon of the published walk on the diamond |g|_1 = 1 [-]."""
PULLED_IN = (0.0, 1e-8, 1e-7, 1e-6, RAY_BLUR)
"""Angles by which a ray with friction moves inwards until forces prove it, in this order [rad]."""
BEYOND_FACET = (1e-8, 1e-7, 1e-6)
"""Distances beyond a facet with friction at which its motion is tested as a proof [rad].

If no test passes, the facet is computed again as a limit from inside."""
BEYOND_FAR = (*BEYOND_FACET, 1e-5, 1e-4, 1e-3)
"""Distances beyond a facet at which an exactly admissible motion is tested as a proof [rad]."""
BEYOND_CONE = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0)
"""Distances beyond a facet without friction at which a motion is tested as a proof [rad]."""
AROUND_LIMIT = (3e-9, 3e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3)
"""Distances on both sides of a limit at which proofs are tested, over max(limit, 1) [-]."""
BEYOND_LIMIT = (1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3)
"""Relative distances above a load limit at which its mechanism is tested as a proof [-]."""
CORNER = 1e-7
"""Largest distance of a contact point from a feature of a part on which it lies [size of the part].
A larger value takes points beside an edge for points of the edge."""
OUTLINE_ANGLE = 1e-6
"""Outlines of faces whose directions differ by less are parallel [rad]. A larger value takes
outlines that cross for outlines that coincide."""
LIMIT_REFINED = 1e-11
"""Largest residual of the conditions of an optimum, relative to weights and speeds [-]. A larger
value accepts derivatives of a limit with fewer digits."""
SAME_FORCE = 1e-7
"""Largest change of a derivative by other optimal forces or motions that counts as none [-]. A
larger value takes derivatives to both sides for equal."""
SAME_LIMIT = 1e-6
"""Directions whose limits differ by less, relative to them, have the same limit [-]. A larger value
takes a limit for non-smooth where it is smooth."""
LIMIT_SIGNS = 1e-7
"""Largest force outside of its cone, and speed at which a contact closes, in a refined limit,
relative to the largest [-]. A larger value accepts forces and motions that are not optimal.
"""
