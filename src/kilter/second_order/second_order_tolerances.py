"""Tolerances of second order, relative [-] or angles [rad]; energies over weight times length.

CURVED, DROPS > FLAT > BALANCED        what curves is far from being flat, and that from rounding
ACROSS > BALANCED,   CARRIES = BALANCED
"""

from __future__ import annotations

__all__ = [
    "ACROSS",
    "AGREE",
    "APART",
    "BALANCED",
    "BEARS",
    "CARRIES",
    "CROSSING",
    "CURVED",
    "DROPS",
    "FLAT",
    "KEEPS",
    "LASTS",
    "LEVEL",
    "REACHES",
    "ROUND",
    "SLIPS",
    "SPLITS",
    "SPREAD",
]

# gaps ---------------------------------------------------------------------------------------

AGREE = 1e-6
"""Normals at a point are one, or in one plane, to this share of their squares."""

CROSSING = 1e-3
"""Edges that cross at less than this angle have no form of the gap [rad]."""

ROUND = 1e-6
"""Surfaces whose curvatures cancel to this share of themselves touch along more than a point."""

# minimum or not ------------------------------------------------------------------------------

CURVED = 2e-8
"""Least curvature of the energy, over the largest, that a proof must have."""
BALANCED = 1e-9
"""Imbalance of forces over the load."""
BEARS = 10.0
"""In a proof, a row carries where its force is this many times what may be out of balance."""
CARRIES = 1e-9
"""A row carries where its force is above this, over the largest."""
ACROSS = 1e-7
"""What a motion may open a row that it is to leave as it is."""
LEVEL = 1e-7
"""Curvature of the energy, over the largest, along a motion that is proved free."""
FLAT = 2e-9
"""Forms below this, over the largest, leave a motion flat."""
DROPS = 2e-8
"""Least opening and least power of the second derivative of a path of length 1."""
SLIPS = 1e-4
"""What a path enters to first order, over what it opens to second: it is open from there on."""
LASTS = 10.0
"""What a path opens to first order stays open for this many times as long as it takes to fall."""
REACHES = (1.0, 5.0, 30.0, 1000.0)
"""Bounds of a second derivative, in turn, where the motion has length 1: the nearest first. The
straighter a path, the farther it is what its derivatives say."""
KEEPS = 1e-12
"""What a path of length 1 opens a contact that it keeps: rounding."""
SPLITS = 250
"""Cones into which the critical motions are split at most."""
SPREAD = 1e-10
"""Points of touch are on no line: least eigenvalue of the sum of their (1, u, v), u and v over the
size of the part, each times itself."""
APART = 1e-12
"""What a configuration must be apart, over the length, and lower, over weight and length."""
