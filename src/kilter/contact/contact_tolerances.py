"""Every tolerance of the detection of contacts, and how they stand to each other.

A name says what is compared: an angle [rad], a fraction of a size [-], or a multiple of
another tolerance [-]. Only the gap and the angle of two faces are for the user to choose
(`kilter.contact.gaps.Tolerance`); all others follow the data.

What must hold, and is tested in ``tests/contact/test_contact_tolerances.py``:

    angles between faces      PATCH_ANGLE < ANGLE < LOOSE_ANGLE < LOOKED_AT_ANGLE
    flatness and gaps         SAME_PLACE < FACET_FLATNESS < GAP < ONE_POINT < LOOSE_GAP
    multiples of the gap      1 < CLUSTER < LOOKED_AT_GAPS
    normals at edges          ANGLE <= CONE_ANGLE < NORMAL_SNAP < NORMAL_ANGLE
    edges that tilt           EDGE_STRAIGHTNESS = NORMAL_SNAP
    rounding below geometry   EXACT_ANGLE < LITERAL_ANGLE < CONE_ANGLE

The line of the normals is why they are what they are. Two faces that touch may be tilted by
`ANGLE`, and directions at an edge or corner count as lying in a plane up to `CONE_ANGLE`, so
one true normal is found from either side up to both of them apart: `NORMAL_SNAP` makes it
that of the facet, and normals are different from `NORMAL_ANGLE` on, above all of these.
"""

from __future__ import annotations

# when two flat faces touch -----------------------------------------------------------------

GAP = 1e-5
"""Gap tolerance, as a fraction of the size of the smaller part [-]."""
ANGLE = 1e-3
"""Angle tolerance between two faces [rad]."""
LOOSE_GAP = 1e-3
"""Gap tolerance for rough data, as a fraction of the size of the smaller part [-]."""
LOOSE_ANGLE = 2e-2
"""Angle tolerance for rough data [rad]."""
THICKNESS = 0.1
"""Gap and facet tolerances are at most this fraction of a part's thickness [-]."""
LOOKED_AT_GAPS = 100.0
"""Gaps up to this many tolerances are looked at: the histogram and the rejected pairs [-]."""
LOOKED_AT_ANGLE = 0.05
"""Angles up to this are looked at, and rounding explains no greater one [rad]."""
BOX_ROUNDING = 1e-9
"""Boxes in a tree are wider than they are by this fraction of the width of all [-]."""
CLUSTER = 3.0
"""Gaps within this factor of the tolerance, on both sides, are one cluster [-]."""

# facets and their overlaps -----------------------------------------------------------------

FACET_FLATNESS = 1e-6
"""A corner lies in the plane of a facet up to this fraction of the size of its part [-]."""
FACET_BEND = 1e-3
"""Largest angle between neighbours in one facet, besides what rounding explains [rad]."""
FACET_REFLEX = 0.01
"""A corner this fraction of the facet tolerance deep makes an outline not convex [-]."""
SAME_PLACE = 1e-9
"""Corners closer than this fraction of the size of a part are in one place [-]."""
ROUNDINGS = 4.0
"""Times the accuracy of one coordinate that a point computed from several may be off [-]."""
PATCH_ANGLE = 1e-4
"""Largest angle between pieces of one patch [rad]."""
SLIVER = 8.0
"""Overlaps narrower than this many roundings of the coordinates are none [-]."""
PATCH_CORNER = 1e-10
"""Corners of a patch closer than this fraction of its width are one [-]."""
OUTLINE_AREA = 1e-6
"""Two ways to overlay agree on the area to this fraction of the smaller outline [-]."""
OUTLINE_GRID = 1e-11
"""Grid of the second way, as a fraction of the size of the outlines [-]."""
HULL_SIDE = 1e-12
"""Points this far inside of a polygon, as a fraction of its area, cannot be corners [-]."""

# edges and corners ---------------------------------------------------------------------------

CONE_ANGLE = 1e-3
"""Directions count as lying in a plane, and edges as flat, up to this angle [rad]."""
RAY_ANGLE = 1e-3
"""Edges between the same two facets that leave a corner closer than this are one [rad]."""
EDGE_NEARLY_PARALLEL = 1e-3
"""Edges closer to parallel than this may be parallel in truth [rad]."""
EDGE_PARALLEL = 1e-9
"""Edges closer to parallel than this have no normal of their own [rad]."""
EXACT_ANGLE = 1e-9
"""Directions that are the same but for rounding differ by less than this [rad]."""
LITERAL_ANGLE = 1e-7
"""Slack where the coordinates are taken at their word [rad]."""
NORMAL_SNAP = 2e-3
"""A normal this close to that of a facet at the point is the facet's [rad]."""
NORMAL_ANGLE = 5e-3
"""Normals closer than this are one [rad]."""
EDGE_STRAIGHTNESS = 2e-3
"""Points of an edge, which may be tilted, leave its line by this fraction of its length [-]."""
CUT_COSINE = 1e-6
"""Cosines below this are zero where cones are cut by a plane [-]."""
VERTEX_ON_EDGE = 1e-7
"""A vertex this fraction of the size of its part from an edge splits it [-]."""
MEETS_EXACTLY = 1e-10
"""Features closer than this fraction of the size of a part meet exactly [-]."""
ONE_POINT = 4e-5
"""Degenerate points of a pair within this fraction of its size are one point [-]."""

# curved faces --------------------------------------------------------------------------------

INTERFERENCE = 0.1
"""A shaft may be thicker than its hole by this fraction of its radius, not by more [-]."""
PRESS_FIT = 0.02
"""A shaft that is thicker than its hole by more than this fraction of its radius is taken for a
thread: press fits are below, threads drawn at their outer radius above [-]."""
THREAD = 0.25
"""A thread drawn as a cylinder is thicker than its hole by up to this fraction of its radius:
M2 in the hole for its tap has .22 [-]."""
FIT_PLAY = 0.2
"""A shaft may be thinner than its hole by this fraction of its radius to be meant for it: holes
for screws of ISO 273, medium, are up to M2 in 2.4 [-]."""
WALL_RIM = 1e-9
"""A line meets a triangle up to this fraction of its sides beyond them [-]."""
COINCIDENT = 0.5
"""Parts that share more than this fraction of the volume of the smaller are refused [-]."""
SAME_SHAPE = 1e-6
"""Copies of a part differ in volume and inertia by less than this fraction [-]."""
INSIDE = 0.99
"""A part lies inside another where they share more than this fraction of it [-]."""
FIT_LENGTH = 1e-3
"""A fit shorter than this fraction of its radius is none [-]."""
SMOOTH_ANGLE = 0.02
"""Faces that meet at less than this pass smoothly into each other [rad]."""
FACETED_ANGLE = 0.35
"""The same for faces known by their triangles only [rad]."""
RIM_NORMAL = 1e-3
"""A line at the rim of a flat patch belongs to it where components of their normals differ
by less [-]."""
RIM_LEVEL = 1e-6
"""A face lies across an axis up to this angle [rad], a corner on a rim up to this fraction of
its radius [-]."""
FREE_PARALLEL = 1e-6
"""Edges of free faces closer to parallel than this are asked by their ends [rad]."""
NO_DIRECTION = 1e-12
"""Directions closer than this to one another have no direction across [rad]."""
GENERATOR_SINE = 1e-9
"""Sines below this count as this where generators cross: how fast a gap opens there [-]."""
APEX = 1e-9
"""A corner this fraction of a triangle's reach from the axis of a cone is the apex [-]."""
SEAM_ANGLE = 1e-7
"""Gaps of an arc up to this angle are closed [rad]."""
FULL_TURN = 1e-6
"""Arcs within this of a whole turn are one [rad]."""
LEAST_ARC = 1e-9
"""Arcs up to this length are none [rad]; steps of an arc are counted to it [-]."""
BAND_FILLED = 1e-6
"""A band is whole where its triangles cover it but for this fraction [-]."""
LEAN = 1e-9
"""Normals that lean on the axis less than this lie across it [-]."""
DIRECTION_CORNER = 1e-7
"""Corners of a cone of directions within this fraction of its width are one [-]."""
THROUGH_CENTER = 1e-9
"""A face of a hull closer to the centre than this passes through it [-]."""
ROUND_CONE = 1e-7
"""Directions on one circle keep one height over its plane to this [-]."""
LEAST_OVERLAP = 1e-12
"""Common parts of two triangles of less area are none, on the unit sphere or unrolled [-]."""
MEAN_NORMAL = 1e-9
"""Unit normals whose mean is shorter than this cancel each other [-]."""
EDGE_ON = 1e-3
"""Least depth that a point is taken for when it is projected through the centre [-]."""
BESIDE = 0.1
"""A curved patch reaches this fraction of its size beyond its points [-]."""
BESIDE_CIRCLE = 0.05
"""A circle of contact reaches this fraction of its size to its sides [-]."""
AXIS_ROUNDING = 1e-15
"""A component of a unit axis that is rounding [-]."""

# smooth faces of meshes ----------------------------------------------------------------------

SMOOTH_EDGE = 0.35
"""Triangles that meet at less than this are pieces of one smooth face [rad]."""
SMOOTH_BEND = 1e-3
"""Triangles that meet at more than this make a face bend [rad]."""
SMOOTH_DOUBT = 1e-5
"""A corner whose triangles bend by less than this lies in a plane [rad]."""
FIT_CUT = 1e-9
"""Singular values below this fraction of the largest fix nothing in a fit [-]."""
SMOOTH_FACING = 0.35
"""Normals of two smooth faces that face each other differ by less than this from opposed [rad]."""
SMOOTH_ASIDE = 0.05
"""A line along a fitted normal misses a face by up to this fraction of its length [-]."""
SMOOTH_GAP = 0.25
"""Smooth faces touch up to the gap tolerance and this fraction of both sagittas [-]."""
SMOOTH_UNSURE = 0.05
"""A point where the normals of both sides differ by twice this has no normal [rad]."""
SMOOTH_LEAST = 1e-4
"""Fitted normals are never known better than this [rad]."""
ONE_DIRECTION = 1e-5
"""Straight edges whose directions differ by less have one direction [rad]."""

# supports ------------------------------------------------------------------------------------

SUPPORT_BESIDE = 1e-3
"""A point that is said to be on a part lies off its box by at most this, over its size [-]."""
