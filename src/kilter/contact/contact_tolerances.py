"""Tolerances of the contact search, and the order between them.

A name states the compared quantity: an angle [rad], a fraction of a size [-], or a multiple of
another tolerance [-]. The user chooses only the gap and the angle of two faces
(`kilter.contact.common.gaps.Tolerance`); all others follow from the data.

This order must hold, and is tested in ``tests/contact/test_searches.py``:

    angles between faces      PATCH_ANGLE < ANGLE < LOOSE_ANGLE < LOOKED_AT_ANGLE
    flatness and gaps         SAME_PLACE < FACET_FLATNESS < GAP < ONE_POINT < LOOSE_GAP
    multiples of the gap      1 < CLUSTER < LOOKED_AT_GAPS
    normals at edges          ANGLE <= CONE_ANGLE < NORMAL_SNAP < NORMAL_ANGLE
    edges that tilt           EDGE_STRAIGHTNESS = NORMAL_SNAP
    rounding below geometry   EXACT_ANGLE < LITERAL_ANGLE < CONE_ANGLE

Reason for the order of the normals: two faces that touch may be tilted by `ANGLE`, and directions
at an edge or corner count as lying in a plane up to `CONE_ANGLE`. The same true normal, computed
from either part, may therefore differ by the sum of both. `NORMAL_SNAP` replaces such a normal by
that of the facet. Only normals that differ by more than `NORMAL_ANGLE`, which is larger than all of
these, count as different.
"""

from __future__ import annotations

# gaps and angles of two flat faces ---------------------------------------------------------

GAP = 1e-5
"""Largest gap between two touching faces, as a fraction of the size of the smaller part [-]; a
larger value closes wider gaps."""
ANGLE = 1e-3
"""Largest angle between two touching faces [rad]; a larger value accepts more tilt."""
LOOSE_GAP = 1e-3
"""Gap tolerance for rough data, as a fraction of the size of the smaller part [-]. Also the reach
of the search for near edges and corners."""
LOOSE_ANGLE = 2e-2
"""Angle tolerance for rough data [rad]."""
DECIDED = 1.01
"""Tolerance of the faces of a pair that a user says touch, in multiples of their gap or angle [-];
a larger value may add wider gaps of the same pair."""
THICKNESS = 0.1
"""Upper limit of gap and facet tolerances, as a fraction of the thickness of a part [-]. A larger
value lets thin plates touch through their own thickness."""
LOOKED_AT_GAPS = 100.0
"""Reach of the search in gap tolerances [-]. A larger value shows more near faces in the histogram
and the rejected pairs, and costs time."""
LOOKED_AT_SIZE = 0.01
"""Upper limit of this reach, as a fraction of the size of the smaller part, for gap tolerances as
wide as the play of a part [-]. A larger value compares faces all over both parts."""
LOOKED_AT_ANGLE = 0.05
"""Largest angle between two near faces that are compared [rad]; also the largest error of an angle
that rounding may explain."""
BOX_ROUNDING = 1e-9
"""Growth of boxes in a tree, as a fraction of the total width [-]; covers the rounding of their
coordinates."""
CLUSTER = 3.0
"""Gaps within this factor of the tolerance on both sides form a cluster, and cause a warning
[-]."""

# facets and their overlaps -----------------------------------------------------------------

FACET_FLATNESS = 1e-6
"""Largest distance of a facet's corner from its plane, as a fraction of the size of the part [-]. A
larger value joins more triangles to a facet."""
FACET_BEND = 1e-3
"""Largest angle between neighbouring triangles of a facet, in addition to rounding [rad]."""
FACET_REFLEX = 0.01
"""A corner deeper than this fraction of the facet tolerance makes an outline non-convex [-]."""
SAME_PLACE = 1e-9
"""Corners closer than this fraction of the size of a part coincide [-]."""
ROUNDINGS = 4.0
"""Rounding error of a computed point, in multiples of the accuracy of a coordinate [-]."""
PATCH_ANGLE = 1e-4
"""Largest angle between the normals of pieces that merge to a patch [rad]."""
SLIVER = 8.0
"""Overlaps narrower than this many roundings of the coordinates are dropped [-]."""
PATCH_CORNER = 1e-10
"""Corners of a patch closer than this fraction of its width merge [-]."""
OUTLINE_AREA = 1e-6
"""Largest accepted difference of two computations of an overlap area, as a fraction of the smaller
outline's area [-]."""
OUTLINE_GRID = 1e-11
"""Grid spacing of the second computation of an overlap, as a fraction of the size of the outlines
[-]."""

# edges and corners ---------------------------------------------------------------------------

CONE_ANGLE = 1e-3
"""Largest angle at which a direction lies in a plane, or an edge counts as flat [rad]."""
RAY_ANGLE = 1e-3
"""Edges between the same two facets at a corner merge if their angle is below this [rad]."""
EDGE_NEARLY_PARALLEL = 1e-3
"""Edges within this angle of parallel may be parallel in exact geometry [rad]."""
EDGE_PARALLEL = 1e-9
"""Edges within this angle of parallel have no cross product to serve as a normal [rad]."""
EXACT_ANGLE = 1e-9
"""Largest angle between directions that differ by rounding alone [rad]."""
LITERAL_ANGLE = 1e-7
"""Slack for tests with the literal coordinates, without a modelling tolerance [rad]."""
NORMAL_SNAP = 2e-3
"""A normal within this angle of a facet's normal at the point is replaced by it [rad]."""
NORMAL_ANGLE = 5e-3
"""Normals within this angle of each other count as the same normal [rad]."""
EDGE_STRAIGHTNESS = 2e-3
"""Largest distance of an edge's contact points from their line, as a fraction of its length [-];
the edge may be tilted by as much."""
CUT_COSINE = 1e-6
"""Cosines below this count as zero when a plane cuts a cone of directions [-]."""
VERTEX_ON_EDGE = 1e-7
"""A vertex within this fraction of the part's size of an edge splits the edge [-]."""
MEETS_EXACTLY = 1e-10
"""Features closer than this fraction of the size of a part meet without a gap [-]."""
ONE_POINT = 4e-5
"""Degenerate points of a pair within this fraction of its size are listed as a vertex, not as an
edge [-]."""

# curved faces --------------------------------------------------------------------------------

INTERFERENCE = 0.1
"""Largest radius of a shaft above that of its hole, as a fraction of the shaft radius [-]. A
thicker shaft does not belong to the hole."""
PRESS_FIT = 0.02
"""Largest interference of a press fit, as a fraction of the shaft radius [-]. A shaft with more
interference is a thread that is drawn at its outer radius."""
THREAD = 0.25
"""Largest interference of a thread that is drawn as a cylinder, as a fraction of its radius [-]: M2
in the hole for its tap has .22."""
FIT_PLAY = 0.2
"""Largest clearance of a shaft in its hole, as a fraction of the shaft radius [-]. The medium holes
of ISO 273 for screws reach .2: M2 in 2.4."""
WALL_RIM = 1e-9
"""A line meets a triangle up to this fraction of the sides beyond them [-]."""
DEEP = 0.02
"""Depth from which an overlap is neither a fit nor a thread [sizes of the smaller part]."""
COINCIDENT = 0.5
"""Parts that share more than this fraction of the volume of the smaller part are rejected [-]."""
SAME_SHAPE = 1e-6
"""Largest relative difference of volume, radius and inertia between copies of a part [-]."""
COPY_PLACE = 1e-6
"""Pairs of copies whose relative poses differ by less than this fraction of the gap tolerance share
the result of an overlap [-]."""
INSIDE = 0.99
"""A part lies inside another if they share more than this fraction of its volume [-]."""
SAME_SURFACE = 0.7
"""A body inside another is a copy of it if this share of the outer surface is its own [-]."""
FIT_LENGTH = 1e-3
"""Shortest fit, as a fraction of its radius [-]; shorter fits are dropped."""
SMOOTH_ANGLE = 0.02
"""Faces of exact solids that meet at a smaller angle pass smoothly into each other [rad]."""
FACETED_ANGLE = 0.35
"""Triangulated faces that meet at a smaller angle pass smoothly into each other [rad]."""
RIM_NORMAL = 1e-3
"""Largest difference in a component of two normals if a line of contact at the rim of a flat patch
belongs to that patch [-]."""
RIM_LEVEL = 1e-6
"""Largest tilt of a face that lies across an axis [rad], and largest distance of a corner from a
rim as a fraction of its radius [-]."""
FREE_PARALLEL = 1e-6
"""Edges of triangles within this angle of parallel are compared by their ends only [rad]."""
DISTANCE_ROUNDING = 1e-12
"""Relative error of a distance that the search for near triangles allows for [-]."""
NO_DIRECTION = 1e-12
"""Lower bound on squared sines and on ratios of lengths; directions closer than this have no
direction across both [-]."""
GENERATOR_SINE = 1e-9
"""Lower bound on the sine of the angle between crossing generators [-]; keeps the radius at which
the gap opens finite."""
APEX = 1e-9
"""A corner within this fraction of a triangle's reach from the axis is the apex of the cone [-]."""
SEAM_ANGLE = 1e-7
"""Gaps of an arc up to this angle are closed [rad]."""
FULL_TURN = 1e-6
"""An arc within this angle of 2 pi is a full circle [rad]."""
LEAST_ARC = 1e-9
"""Arcs up to this length are dropped [rad]; also the rounding slack of the number of steps along an
arc [-]."""
BAND_FILLED = 1e-6
"""Largest missing fraction of a band that its triangles cover completely [-]."""
LEAN = 1e-9
"""Largest axial component of a normal that lies across the axis [-]."""
DIRECTION_CORNER = 1e-7
"""Corners of a cone of directions within this fraction of its width merge [-]."""
THROUGH_CENTER = 1e-9
"""A face of a hull within this distance of the centre passes through it, for unit directions
[-]."""
ROUND_CONE = 1e-7
"""Largest difference in height of directions that form a circular cone [-]."""
LEAST_OVERLAP = 1e-12
"""Overlaps of two triangles with a smaller area, on the unit sphere or unrolled, are dropped
[-]."""
MEAN_NORMAL = 1e-9
"""Unit normals with a shorter mean cancel each other [-]."""
EDGE_ON = 1e-3
"""Lower bound on the depth of a point in the projection through the centre of a sphere [-]."""
BESIDE = 0.1
"""Width of the border around the points of a curved patch that belongs to the patch, as a fraction
of its size [-]."""
BESIDE_CIRCLE = 0.05
"""Width of the border around a circle of contact that belongs to it, as a fraction of its size
[-]."""
ARC_SLOPE = 1e-6
"""The slope of a curve over a face changes by more between the ends of an edge, unless the edge
lies along the face [-]."""
ARC_LEVEL = 1e-4
"""A curve within the gap tolerance of a face lies along it if its slope over the face is smaller
[-]."""
STRAIGHT_EDGE = 1e-9
"""Largest deviation of a straight edge from its chord, as a fraction of its length, and largest
change of the normal of a face along it [-]."""
CURVE_ROUNDING = 1e-14
"""Steps below this fraction of the coordinates end the search for a point of a curve [-]."""
CURVE_END = 1e-7
"""Largest distance of a nearest point beyond the end of an edge, as a fraction of its chord [-]."""
MIDDLE_OF_TUBE = 1e-6
"""A centre within this fraction of the tube's radius from the circle of a hollow torus has no
direction to its wall [-]."""
WIDEST_OPENING = 10.0
"""Largest radius at which the gap beside a torus opens, as a multiple of the size of the torus [-];
a larger value widens the zone that belongs to its contact."""
AXIS_ROUNDING = 1e-15
"""Components of a unit axis below this are rounding and are written as 0 [-]."""
SLOPE_ROUNDING = 1e-15
"""Cosine between an edge and the normal of a face that counts as zero [-]."""

# smooth faces of meshes ----------------------------------------------------------------------

SMOOTH_EDGE = 0.35
"""Triangles that meet at a smaller angle belong to the same smooth face [rad]."""
SMOOTH_BEND = 1e-3
"""Triangles that meet at a larger angle make a face count as bent [rad]."""
SMOOTH_DOUBT = 1e-5
"""A corner whose triangles bend by less lies in a plane, and its normal is exact [rad]."""
FIT_CUT = 1e-9
"""Singular values below this fraction of the largest are treated as zero in a fit [-]."""
FIT_REGULAR = 1e-5
"""Least diagonal entry of the triangular factor of a fit that is solved without singular values, as
a fraction of the largest entry [-]. A larger value sends more fits to singular values."""
SMOOTH_FACING = 0.35
"""Largest angle between a normal and the reverse of the opposite face's normal if two smooth faces
face each other [rad]."""
SMOOTH_ASIDE = 0.05
"""Largest miss of a face by a line along a fitted normal, as a fraction of the line's length
[-]."""
SMOOTH_GAP = 0.25
"""Extra gap between touching smooth faces, as a fraction of the sum of both sagittas [-]."""
SMOOTH_UNSURE = 0.05
"""If the normals of both sides differ by more than twice this, the point has no normal [rad]."""
SMOOTH_LEAST = 1e-4
"""Lower bound on the error of fitted normals [rad]."""
ONE_DIRECTION = 1e-5
"""Straight edges within this angle have the same direction [rad]."""

CURVATURE_STEP = 1e-3
"""Step of the second difference of a gap beside a torus, relative to the size of the torus [-]; a
larger value is less accurate, a smaller value is rounded more."""

# supports ------------------------------------------------------------------------------------

SUPPORT_BESIDE = 1e-3
"""Largest distance of a support's point from the box of its part, as a fraction of the part's size
[-]."""
SUNK = 1e-2
"""Depth of an overlap over the size of the smaller part, and its share of the volume, up to which
parts that are no exact solids are merely sunk: simulators let every contact sink [-]."""
WHOLE = 1e-9
"""A patch covers a facet if its area is smaller by at most this share [-]."""
STRAIGHT = 1e-9
"""An edge is straight if its height over its chord is below this share of the chord [-]."""
SAME_CORNER = 1e-9
"""A contact point within this share of the size of a part is a corner of this part [-]."""
