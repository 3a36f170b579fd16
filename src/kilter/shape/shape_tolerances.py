"""Tolerances of shapes and of the recognition of surfaces in meshes, and their order.

Each is an angle [rad], a fraction of a size [-], or a multiple of another tolerance [-]. The
following order is required; ``tests/test_values.py`` tests it:

    lengths over sizes        NO_AREA < PLANE_FLATNESS < WELD = SURFACE_FIT
    edges of prisms           a prism of 12 sides < STEEPEST_EDGE < a prism of 11
    angles                    LEAST_TURN < FACET_NORMAL < STEEPEST_EDGE
    multiples of a tolerance  PLANE_ROUNDINGS < EVIDENCE < GROWING

`EVIDENCE` is above `PLANE_ROUNDINGS`, so that rounding alone never turns a plane into a cylinder.
The tolerance of a growing surface (`GROWING`) is larger than that of the final test.
"""

from __future__ import annotations

import numpy as np

# closed meshes and polygons ----------------------------------------------------------------

WELD = 1e-7
"""Vertices closer than this are merged if edges are open otherwise [sizes of the mesh]. A larger
value closes larger gaps."""
NO_AREA = 1e-14
"""Twice the area up to which a triangle counts as degenerate [squares of its longest edge]."""
EDGE_END = 1e-9
"""Distance from the end of an edge within which a vertex does not split the edge [edge lengths]."""
POLYGON_AREA = 1e-12
"""Area up to which a polygon counts as flat [squares of its size]."""
COMMON_VOLUME = 1e-6
"""Common volume of two shells of a mesh up to which they do not overlap, and volume outside up to
which one contains the other [volumes of the smaller shell]."""
CUT_AREA = 1e-6
"""Largest difference between the area of a polygon and the total area of its triangles [area of the
polygon]."""
WHOLE_TURN = 1e-6
"""Largest difference of the total turn of a convex polygon from 360 degrees [rad]."""
GRAZING = 1e-6
"""Cosine between a surface normal and a triangle's normal below which the triangle covers no
point [-]."""

# which triangles are one facet ---------------------------------------------------------------

STEEPEST_EDGE = float(np.radians(30.5))
"""Largest angle between neighbouring facets of a round face [rad]: a prism with 12 equal sides has
30 degrees, with 11 sides 32.7."""
PLANE_FLATNESS = 1e-9
"""Distance up to which a corner is on a plane, independently of the accuracy [sizes]."""
PLANE_ROUNDINGS = 4.0
"""Largest distance of a corner from the plane of a neighbour [accuracies of a coordinate]."""
NARROW = 10.0
"""Height of a triangle up to which its normal is unreliable [tolerances]."""

# which facets are one round face -------------------------------------------------------------

SURFACE_FIT = 1e-7
"""Distance up to which a corner is on a surface, independently of the accuracy [sizes of the
region]. A larger value recognises more round faces."""
FACET_NORMAL = float(np.radians(25))
"""Largest angle between the normals of a facet and of the surface at its middle [rad]."""
LEAST_TURN = float(np.radians(15))
"""Least turn of a round surface that meets another face without an edge [rad]."""
WIDEST_FACET = 4.0
"""Largest sagitta of a facet [sagittas of the upper quartile of facets]: twice the width."""
EVIDENCE = 20.0
"""Least deviation of a round region from its best plane [tolerances]."""
GROWING = 30.0
"""Largest distance of corners from a surface while it grows from a few facets [tolerances]."""
ROUGHLY = 1.1
"""Factor of the tolerances of a first fit that only rules out hopeless starts [-]. A larger value
leaves more starts to the exact fit, and changes no result."""
ONE_STRIP = 1e-3
"""Largest difference in direction of facets of the same strip [differences between strips]."""

# fits ----------------------------------------------------------------------------------------

LARGEST_RATIO = 1e6
"""Largest radius of a fitted surface [sizes of the points]; a larger radius is a plane."""
NARROWEST_CONE, WIDEST_CONE = 1e-4, np.pi / 2 - 1e-4
"""Least and largest half angle of a cone [rad]; beyond them it is a cylinder or plane."""
BEHIND_APEX = 1e-6
"""Largest distance of a point of a cone behind its apex [sizes of the points]."""
FIT_RANK = 1e-10
"""Singular values of a fit below this count as zero [fractions of the largest]."""
STEP_RANK = 1e-14
"""Singular values of the normal equations of a step below this count as zero [fractions of the
largest]."""
