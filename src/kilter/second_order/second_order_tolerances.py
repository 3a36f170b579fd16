"""Tolerances of second order: relative [-] or angles [rad]; energies over weight x length.

CURVED, DROPS > FLAT > BALANCED        curved is well above flat, and flat well above rounding
ACROSS > BALANCED,   CARRIES = BALANCED
"""

from __future__ import annotations

# gaps ---------------------------------------------------------------------------------------

AGREE = 1e-6
"""Normals at a point are equal, or coplanar, if their squared spread is below this [-]."""

CROSSING = 1e-3
"""Least angle between crossing edges for which the gap has a second derivative [rad]."""

ROUND = 1e-6
"""Surfaces touch in a point if the sum of their curvatures is above this, over the larger [-]."""

# minimum or not ------------------------------------------------------------------------------

CURVED = 2e-8
"""Least curvature of the energy in a proof, over the largest [-]; larger leaves more open."""
BALANCED = 1e-9
"""Largest imbalance of forces in a proof, over the load [-]."""
BEARS = 10.0
"""Multiple of the tolerated imbalance above which a force in a proof counts as a force [-]."""
BENDS = 1e-6
"""A motion of length 1 bends if the energy curves by more than this, over the forces [-]."""
CARRIES = 1e-9
"""Fraction of the largest force above which a row counts as carrying [-]."""
ACROSS = 1e-7
"""A row counts as unchanged by a motion if its gap opens by less than this [-]."""
LEVEL = 1e-7
"""Largest curvature of the energy along a free motion, over the largest of all [-]."""
FLAT = 2e-9
"""A motion has no curvature if all second derivatives of gaps along it are below this fraction [-].
"""
DROPS = 2e-8
"""Least opening and least power of the second derivative of a path of length 1 [-]."""
SLIPS = 1e-4
"""Largest first-order penetration of a path, over its second-order opening [-]."""
LASTS = 10.0
"""A gap that opens to first order must stay open for this many lengths of the fall [-]."""
REACHES = (1.0, 5.0, 30.0, 1000.0)
"""Bounds of the second derivative, tried in turn, for a motion of length 1 [-].

A straighter path stays closer to its derivatives, so the smallest bound comes first.
"""
KEEPS = 1e-12
"""Largest opening of a contact that a path of length 1 keeps closed [-]: rounding."""
SPLITS = 250
"""Largest number of cones into which the critical motions are split."""
SPREAD = 1e-10
"""Contact points are not collinear if the least eigenvalue of the sum of their outer products of
(1, u, v), u and v over the size of the part, is above this [-]."""
APART = 1e-12
"""Least separation over the length, and least loss of energy, of a lower configuration [-]."""
ROUNDED = 1e-8
"""Tolerance of parts above which their coordinates are rounded, as in single precision [-]."""
