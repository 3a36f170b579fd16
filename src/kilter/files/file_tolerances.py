"""Tolerances of the file readers.

    INTEGRAL < RIGID < SAME_FACE < VOLUME < RECOGNISED = SAME_ANGLE < DEFLECTION

Integrals over exact surfaces have the smallest error. Numbers of the file (placements, equal
faces) come next. Recognised surfaces follow, and triangles, which lie within DEFLECTION of their
face, have the largest error.
"""

from __future__ import annotations

INTEGRAL = 1e-14
"""Relative error given to the Gauss integration of OCCT [-]; a larger value means fewer points.
The results are right to 1e-10 on rational B-splines (2e-7 with the value 1e-9), and to rounding on
planes."""
RIGID = 1e-9
"""Largest relative change of lengths by a placement that counts as rigid [-]."""
PARALLEL = 1e-9
"""Largest angle between two joint axes of a body that count as the same axis [rad]."""
SAME_DIRECTION = 1e-9
"""Largest distance of the unit vectors of `gravity` and against `up` in saved choices [-]."""
STRAIGHT_AXES = 1e-9
"""Largest cosine between axes of a placement that count as orthogonal, and largest relative
difference of their lengths that count as equal [-]. A smaller value replaces exact shapes by
meshes."""
FLAT_POLYGON = 1e-6
"""Largest distance of the corners of a flat polygon from its plane [largest coordinate]."""
JOINT_FRAMES = 1e-3
"""Largest distance of the two frames of a joint that count as one point [mm]; FreeCAD solves
assemblies to about 1e-7 mm."""
FOLDED = 1e-9
"""Largest 1 + cosine between the normals of two triangles that lie on each other [-]."""
SAME_UNIT = 1e-6
"""Largest relative difference of a stated length unit from a unit of kilter [-]."""
SAME_FACE = 1e-7
"""Largest difference of the numbers of two surfaces that count as the same [sizes of the solid].
A larger value merges more neighbouring faces."""
VOLUME = 1e-6
"""Relative error allowed for a volume that is integrated over the faces [-]."""
RECOGNISED = 1e-5
"""Largest distance of the points of a face from a recognised surface [sizes of the face].
A larger value recognises more faces as planes, cylinders and so on."""
SAME_ANGLE = 1e-5
"""Largest angle between two faces at an edge that count as lying on each other [rad]."""
DEFLECTION = 1e-3
"""Largest distance of a triangle from its face [sizes of the solid]; a larger value gives fewer
triangles."""
TURN = 0.2
"""Angular deflection given to OCCT [rad]; neighbouring triangles of a round face turn by half."""
ALONG = 0.7
"""Least cosine between the normals of a block's face and an interface on it [-]."""
COARSE = 5e-3
"""DEFLECTION of a second try, for solids that OCCT cannot triangulate finely [sizes]."""
COARSE_TURN = 0.5
"""TURN of the second try [rad]."""
SEWN = 1e-5
"""Edges of a damaged solid within this distance are sewn together [sizes of the solid]."""
HOLLOW = 1e-3
"""Least volume of an open shell after closing its holes, for a solid [fractions of its hull]."""
CUT_AREA = 1e-9
"""Area of an outline that its triangles may leave uncovered [fractions of the area]."""
DOUBLED = 0.5
"""Share of a round face that lies on another face of its solid, above which the solid is wrong."""
OTHER_SIDE = 1e-3
"""Error of the area of the other side of a face on a sphere [fractions of the sphere]."""
OFF_GRID = 1e-3
"""Bricks within this offset stand on the grid of the other bricks [cells]."""
LEEWAY = 2.0
"""Average distance allowed between triangles and their faces [times the sagitta]."""
