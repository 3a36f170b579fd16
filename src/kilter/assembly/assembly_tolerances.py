"""Tolerances of assemblies: the range of sizes, and bounds for flat, upright or equal.

    RESOLVED < UPRIGHT = THIN_INERTIA < SAME_SURFACE = PLANAR_AXIS = FLAT_PART = INSIDE_OUT
             < COPLANAR < BESIDE_SEAM = ACROSS = ON_GRID < INERTIA_ROUNDING < CREASE < SMOOTH

All are relative, or angles in rad. None of them decides whether parts touch; these tolerances are
in `kilter.contact.contact_tolerances`.
"""

from __future__ import annotations

LARGEST = 1e30
"""Largest size of a part; the smallest is its inverse [length unit]. Moments of inertia, fifth
powers of a size, must stay within float64."""
RESOLVED = 1e-14
"""Least size of a part [fractions of its largest coordinate]: float64, with sixteen digits, does
not resolve the corners of a smaller part."""
FLAT_PART = 1e-9
"""A part with less volume than this is flat, and rejected [cubes of its reach]."""
INSIDE_OUT = 1e-9
"""Largest negative eigenvalue of a second moment that counts as rounding [fractions of the largest
eigenvalue]; below it the part is rejected."""
THIN_INERTIA = 1e-12
"""Least principal moment of inertia of a part [fractions of the largest]: a part without inertia
about an axis would turn about it infinitely fast."""
INERTIA_ROUNDING = 1e-4
"""Excess of the largest principal moment of inertia over the sum of the others that counts as
rounding [fractions of the sum]; files state moments of flat plates with five digits."""
PLANAR_AXIS = 1e-9
"""Largest sine of the angle between the axis of a joint and the y axis, or the x-z plane, that
counts as parallel [-]."""
SAME_SURFACE = 1e-9
"""Largest difference of two curved surfaces of a part that count as the same [sizes]. A larger
value merges more surfaces."""
COPLANAR = 1e-8
"""Largest 1 - cosine of the angle between neighbouring triangles in the same plane [-]."""
SMOOTH = 0.6
"""Largest angle between neighbouring triangles of a mesh that may represent a curved surface
[rad]."""
UPRIGHT = 1e-12
"""Largest sine of the angle between a torus axis and the vertical at which the torus is lowest all
around [-]."""
BESIDE_SEAM = 1e-6
"""Margin of a face beyond its seams [radii]; largest distance of a point of an edge from its two
faces [chord lengths]."""
ACROSS = 1e-6
"""Largest deviation of a given feature from the normal and from its axis of revolution [-]."""
ON_GRID = 1e-6
"""Largest offset of a brick from its cells [cells], and largest rotation [rad]."""
CREASE = 1e-3
"""Least angle between two faces with an edge [rad]; at a smaller angle they meet smoothly, as at
the seam of a fillet."""
SMALL_HOLES = 0.1
"""Largest area of the caps of holes at which the closed volume is plausible [fractions of the
surface]."""
STRAP_OFF_PART = 1e-2
"""Largest distance of a point of a strap from the bounding box of its part, relative to the size of
the part [-]. A larger value accepts points that are farther away."""
STRAP_THROUGH = 1e-3
"""Depth to which a strap may pass through a part, relative to its size [-]. A larger value accepts
straps that cut deeper."""
SAME_DOWN = 1e-12
"""Largest distance of two unit vectors that count as the same direction of gravity [-]."""
