"""Feature (face, edge or vertex) of each part at each contact point, and its curvature.

At a tangent offset u from the contact point, the surface of a part lies u . K u / 2 below its
tangent plane. K is its curvature, positive if the part is convex; u runs over the directions in
which the feature extends:

    FACE    the tangent plane          EDGE    a single direction (also the rim of a disc)
    VERTEX  no direction               OPEN    unknown: the contact is left open
"""

from __future__ import annotations

from dataclasses import dataclass

from kilter.arrays import Array, Index, Mask, Rows, columns, read_only

OPEN, VERTEX, EDGE, FACE = -1, 0, 1, 2
"""Kinds of features; a known kind is the number of its tangent directions."""
FEATURES = {"open": OPEN, "vertex": VERTEX, "edge": EDGE, "face": FACE}
"""Kinds of feature by name."""


@dataclass(frozen=True, slots=True, eq=False)
class Features(Rows):
    """Features (face, edge, vertex) of both parts at K contact rows, in arrays; world frame."""

    kind_a: Index
    kind_b: Index
    """Kind of the feature of part a and of part b, shape (K,)."""
    edge_a: Array = columns(3)
    edge_b: Array = columns(3)
    """Unit direction of an edge, or unit tangent of a rim, shape (K, 3); 0 for the other kinds."""
    curvature_a: Array = columns(3, 3)
    curvature_b: Array = columns(3, 3)
    """Symmetric tensor in the tangent plane [1/length unit], positive if the part is convex,
    shape (K, 3, 3). For a sphere it is the tangential projection over the radius; for an edge k
    e e^T, with k its curvature in the plane of the normal and e."""
    fibre: Array = columns(3)
    """Unit direction of a line of contact at points within it, else 0, shape (K, 3). The point
    of b stays at its place along the line, and the gap is minimised only across the line."""
    conformal: Mask = columns()
    """Points at which the surfaces fit each other, shape (K,): the point of b counts as a vertex
    on a."""
    axis_a: Array = columns(6)
    axis_b: Array = columns(6)
    """Stated axis of revolution, shape (K, 6): a point on it, then its unit direction; 0 if none
    is stated."""
    group: Index = columns()
    """Patch of the point, shape (K,); -1 for a row without a patch."""
    doubt_a: Array = columns()
    doubt_b: Array = columns()
    """Largest error of the curvature in any tangent direction [1/length unit], shape (K,); 0
    except for surfaces that were recognised in meshes."""
    flush: Mask = columns()
    """Corners at which two fitting faces end together, on an edge of both parts, shape (K,).
    Their slip decides which corner touches the other face (`gap_form.corner_slips`)."""

    def __post_init__(self) -> None:
        read_only(self)

    @property
    def doubted(self) -> bool:
        """True if a curvature is known only within bounds, as on a mesh."""
        return bool(self.doubt_a.any() or self.doubt_b.any())

    @property
    def open(self) -> Mask:
        """Mask of the rows at which a feature of either part is unknown, shape (K,)."""
        unknown: Mask = (self.kind_a == OPEN) | (self.kind_b == OPEN)
        return unknown
