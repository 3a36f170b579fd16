"""Tolerances of the search for a pose at rest, and the order between them.

    SEARCH_CLOSED < COINCIDES < CLOSED < LEAST_REACH < REACH

A point that the search regards as closed must also count as closed in the independent verification.
"""

from __future__ import annotations

SEARCH_CLOSED = 1e-9
"""Gap that the search regards as closed, over the median size of the parts [-]; data whose
coordinates or faces are less exact have a larger gap."""
SEARCH_SHARE = 0.1
"""The same, over the gap that the verification regards as closed [-]: SEARCH_CLOSED over CLOSED."""
CLOSED = 1e-8
"""Gap that the verification regards as closed, and deepest accepted overlap, over the median size
of the parts [-]; a larger value accepts poses whose contacts are less closed."""
REACH = 1e-3
"""Least default reach of a search, over the median size of the parts [-]."""
LEAST_REACH = 1e-5
"""Least distance within which a step searches for points of parts that are not convex, over the
median size [-]."""
FACING = 0.06
"""Largest angle between the planes of two opposed faces [rad]; a larger value closes wider
wedges, and couples faces that lie aside."""
BALANCED = 1e-7
"""Force or torque on a part, over the mean weight, that counts as zero [-]."""
COINCIDES = 3e-9
"""A corner of an overlap within this fraction of the size of a part is a corner of that part [-].
It is below `CLOSED`: a corner farther beside the other face would not count as a closed point.
"""
INSIDE = 0.3
"""Least depth of a feature inside the other part, over its penetration along the normal [-]."""
BESIDE = 0.1
"""Distance from a point at which the material beside it is examined, over its penetration [-]."""
THINNEST = 1e-4
"""Least width of an overlap of faces that carries force, over the size of the smaller part [-]. The
detection of contacts does not count thinner strips as areas."""
LEVEL = 1e-5
"""Tilt of two faces above which they touch with an edge [rad]."""
NORMAL = 1e-3
"""Largest angle between the normal of a closed point and the directions in which the surfaces of
both parts face each other there [rad]; as large as the angle of touching faces."""
BETWEEN_FACES = 1e-9
"""Largest angle between the normal of a closed point and the cone between the faces of both parts
there [rad]; a larger value lets faces of a slope count as level."""
CROSSING = 0.02
"""Least sine of the angle between two edges whose crossing has a normal of its own [-]."""
