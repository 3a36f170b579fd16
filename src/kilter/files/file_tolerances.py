"""Tolerances of files: what readers take for the same, for rigid, for a known surface.

    INTEGRAL < RIGID < SAME_FACE < VOLUME < RECOGNISED = SAME_ANGLE < DEFLECTION

What a surface integrates to is known best; then what files state (placements, equal faces);
a face is recognised before its triangles, which only lie within DEFLECTION of it.
"""

from __future__ import annotations

__all__ = [
    "ALONG",
    "COARSE",
    "COARSE_TURN",
    "CUT_AREA",
    "DEFLECTION",
    "HOLLOW",
    "INTEGRAL",
    "LEEWAY",
    "LOWEST_CORNERS",
    "PARALLEL",
    "RECOGNISED",
    "RIGID",
    "SAME_ANGLE",
    "SAME_FACE",
    "SEWN",
    "TURN",
    "VOLUME",
]

INTEGRAL = 1e-14
"""Relative error that OCCT is asked for: it sets the points of its Gauss rules. What comes out is
right to 1e-10 on rational B-splines (with 1e-9 here: to 2e-7), and to rounding on plain faces."""
RIGID = 1e-9
"""A placement that changes lengths by less than this fraction of them is taken for rigid."""
PARALLEL = 1e-9
"""Axes of the joints of a body that lie on each other within this angle are one [rad]."""
SAME_FACE = 1e-7
"""Faces that meet lie on one surface where its numbers agree to this, in sizes of the solid."""
VOLUME = 1e-6
"""Fraction of the volume that integrals over the faces may be wrong by."""
RECOGNISED = 1e-5
"""Points of a face may be this far from the surface it is taken for, in sizes of the face."""
LOWEST_CORNERS = 1e-4
"""Corners this fraction of the height above the lowest one are lowest too [-]."""
SAME_ANGLE = 1e-5
"""Faces that leave an edge within this angle lie on each other [rad]."""
DEFLECTION = 1e-3
"""Greatest distance of a triangle from its face, in sizes of the solid."""
TURN = 0.2
"""Angle that OCCT is asked for; neighbouring triangles of a round face turn by half of it [rad]."""
ALONG = 0.7
"""Cosine from which on a face of a block may be one side of an interface [-]."""
COARSE = 5e-3
"""The same where the mesher of OCCT cannot cut a face finely."""
COARSE_TURN = 0.5
"""Its angle [rad]."""
SEWN = 1e-5
"""Edges of a damaged solid this far apart are sewn together, in sizes of the solid."""
HOLLOW = 1e-3
"""Faces that are closed in thought enclose at least this fraction of their hull."""
CUT_AREA = 1e-9
"""Triangles fill an outline but for this fraction of its area."""
OFF_GRID = 1e-3
"""Bricks this fraction of a cell off the grid of the others stand on it [-]."""
LEEWAY = 2.0
"""Times the sagitta that triangles may be off, on average, from the faces they stand for."""
