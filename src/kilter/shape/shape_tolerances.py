"""Every tolerance of shapes and of what is recognised in meshes, and how they stand to each other.

A name says what is compared: an angle [rad], a fraction of a size [-], or a multiple of
another tolerance [-]. What must hold, and is tested in ``tests/test_shape_tolerances.py``:

    lengths over sizes        NO_AREA < PLANE_FLATNESS < WELD = SURFACE_FIT
    edges of prisms           a prism of 12 sides < STEEPEST_EDGE < a prism of 11
    angles                    LEAST_TURN < FACET_NORMAL < STEEPEST_EDGE
    multiples of a tolerance  PLANE_ROUNDINGS < EVIDENCE < GROWING

`EVIDENCE` lies above `PLANE_ROUNDINGS`, so that rounding alone never bends a plane into a
cylinder; a surface that still grows may be off by more (`GROWING`) than one that is judged.
"""

from __future__ import annotations

import numpy as np

# closed meshes and polygons ----------------------------------------------------------------

WELD = 1e-7
"""Vertices closer than this fraction of the size are one, where edges are open otherwise [-]."""
NO_AREA = 1e-14
"""Twice the area of a face that has none, as a fraction of its longest edge squared [-]."""
EDGE_END = 1e-9
"""A vertex this fraction of an edge from its end does not split it [-]."""
POLYGON_AREA = 1e-12
"""A polygon of less area, as a fraction of its size squared, is flat [-]."""
CUT_AREA = 1e-6
"""The triangles of a polygon have its area to this fraction [-]."""
WHOLE_TURN = 1e-6
"""The corners of a convex polygon turn by a whole turn to within this [rad]."""
GRAZING = 1e-6
"""Cosine below which a line along a normal is parallel to a triangle [-]."""

# which triangles are one facet ---------------------------------------------------------------

STEEPEST_EDGE = float(np.radians(30.5))
"""Facets that meet at more than this belong to different faces [rad]: a prism of 12 even sides
has 30 degrees, one of 11 has 32.7."""
PLANE_FLATNESS = 1e-9
"""Corners closer to a plane than this fraction of the size are on it, whatever their
accuracy [-]."""
PLANE_ROUNDINGS = 4.0
"""Times the accuracy of a coordinate that a corner may be off the plane of its neighbour [-]."""
NARROW = 10.0
"""Triangles narrower than this many tolerances have no direction of their own [-]."""

# which facets are one round face -------------------------------------------------------------

SURFACE_FIT = 1e-7
"""Corners are this close to a surface, as a fraction of the size of the region, whatever their
accuracy [-]."""
FACET_NORMAL = float(np.radians(25))
"""Between the normal of a facet and that of the surface at its middle [rad]."""
LEAST_TURN = float(np.radians(15))
"""Turn of a round region that goes on without an edge into another face [rad]."""
WIDEST_FACET = 4.0
"""Times the sagitta of most facets (three quarters of them) that one may have: twice as
wide [-]."""
EVIDENCE = 20.0
"""Times the tolerance by which a round region leaves its best plane [-]."""
GROWING = 30.0
"""Times the tolerance that corners may be off while a surface grows from a few facets [-]."""
ONE_STRIP = 1e-3
"""Facets of one strip differ in direction by less than this fraction of what strips do [-]."""

# fits ----------------------------------------------------------------------------------------

LARGEST_RATIO = 1e6
"""Radii above this many sizes of the points are taken for planes [-]."""
NARROWEST_CONE, WIDEST_CONE = 1e-4, np.pi / 2 - 1e-4
"""Half angles of cones; beyond them they are cylinders or planes [rad]."""
BEHIND_APEX = 1e-6
"""Points of a cone lie behind its apex by no more than this fraction of their size [-]."""
FIT_RANK = 1e-10
"""Singular values below this fraction of the largest fix nothing [-]."""
STEP_RANK = 1e-14
"""The same for the normal equations of a step [-]."""
