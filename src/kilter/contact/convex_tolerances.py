"""Tolerances of distances, normals and contact points between convex pieces."""

CONVERGED = 1e-14
"""A distance is final if its square exceeds a lower bound by less than this fraction [-]."""
PARALLEL = 1e-9
"""Sine of the angle between two edges below which they are parallel [-]."""
TOUCHING = 1e-10
"""Cores nearer than this fraction of their size have no sure direction of nearest points [-]."""
EXACT = 1e-12
"""Rounding of a separation, over the size of a pair [-]."""
NEAR = 1e-4
"""Distance below which directions across edges are compared with the nearest points, over the size
of a pair [-]."""
OPPOSED = 1e-9
"""Length of the sum of two unit normals up to which they are opposed [-]."""
BESIDE = 1e-9
"""Distance beside a face at which a corner still lies over it, over the size of a pair [-]."""
SLOPE = 1e-6
"""A face counts as parallel to a direction if the cosine of their angle is below this [-]."""
TILT = 1e-5
"""Angle to the normal of a face up to which crossings of edges have this normal [rad]."""
INWARDS = 1e-3
"""Way from a corner towards the middle of its face to the place that is examined [-]."""
SUNK = 1e-6
"""Depth in another piece of the same part at which a point is no point of the surface, over the
size of the piece [-]."""
CLOSED = 1e-3
"""Points whose gap exceeds the least gap of their pair by less than this, over the size of the
pair, are reduced to the extreme points among each other [-]."""
STEP_BACK = 1e-3
"""Part of a gap by which a place beside its end is moved back [-]."""
SAME_POINT = 1e-8
"""Distance up to which two points are the same, over the size [-]."""
CONVEX_VOLUME = 1e-9
"""Largest difference between the volume of a convex mesh and that of its hull, relative [-]."""
SAME_PLANE = 1e-7
"""Largest angle between triangles of the same face [rad]."""
LEVEL = 1e-9
"""Sine of an angle to the axis of a cylinder below which a direction is along the axis [-]."""
INNER = 1e-6
"""Distance in front of a face at which another piece of the part covers it, over the size [-]."""
NO_AREA = 1e-12
"""Area of a triangle that counts as none, over the square of the size [-]."""
ON_PLANE = 1e-9
"""Distance from a plane up to which a corner lies on it, over the size [-]."""
ROUND = 0.005
"""Largest distance of the prism of a cylinder from its surface, over the radius [-]."""
