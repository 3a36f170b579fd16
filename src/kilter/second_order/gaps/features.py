"""What touches at each contact point: face, edge or vertex of either part, and how it curves.

At tangent offset u from the contact point, the surface of a part lies u . K u / 2 below its
tangent plane, K its curvature, positive where it is convex; u runs over the directions in which
the feature extends:

    FACE    the tangent plane          EDGE    one direction (also the rim of a disc)
    VERTEX  none                       OPEN    not known: nothing is said of such a contact
"""

from __future__ import annotations

from dataclasses import dataclass

from kilter.arrays import Array, Index, Mask, Rows, columns, read_only

__all__ = ["EDGE", "FACE", "FEATURES", "OPEN", "VERTEX", "Features"]

OPEN, VERTEX, EDGE, FACE = -1, 0, 1, 2
"""Kinds of feature: how many tangent directions it has."""
FEATURES = {"open": OPEN, "vertex": VERTEX, "edge": EDGE, "face": FACE}
"""Their names."""


@dataclass(frozen=True, slots=True, eq=False)
class Features(Rows):
    """Features of K rows of a program, in their order; world frame, length unit of the assembly.

    Attributes
    ----------
    kind_a, kind_b : ndarray of int, shape (K,)
        `FACE`, `EDGE`, `VERTEX` or `OPEN`, of part a and of part b.
    edge_a, edge_b : ndarray, shape (K, 3)
        Unit direction of an edge, or the tangent of a rim; 0 of the other kinds.
    curvature_a, curvature_b : ndarray, shape (K, 3, 3)
        Symmetric, in the tangent plane [1/length unit], positive where the part is convex:
        of a sphere the projection across the normal over its radius; of an edge k e e^T with
        k its curvature in the plane of the normal and e.
    fibre : ndarray, shape (K, 3)
        Unit direction of a line of contact, at points within it: the material point of b
        stays along it, and only the way across is minimised over; else 0.
    doubt_a, doubt_b : ndarray, shape (K,)
        How far the curvature may be off in any tangent direction [1/length unit]: 0 but for
        surfaces that were recognised in meshes.
    conformal : ndarray of bool, shape (K,)
        The surfaces fit each other: the point of b is taken as a vertex on a.
    flush : ndarray of bool, shape (K,)
        Ends of what fits each other that lie on an edge of both parts: which of them touches
        the other there depends on how they slip (`kilter.second_order.gaps.gap_form.corner_slips`).
    axis_a, axis_b : ndarray, shape (K, 6)
        Of what is said to be of revolution about a line: a point on it and its unit direction;
        a direction of 0 where nothing is said.
    group : ndarray of int, shape (K,)
        The patch that the point belongs to; -1 of a row without.
    """

    kind_a: Index
    kind_b: Index
    edge_a: Array = columns(3)
    edge_b: Array = columns(3)
    curvature_a: Array = columns(3, 3)
    curvature_b: Array = columns(3, 3)
    fibre: Array = columns(3)
    conformal: Mask = columns()
    axis_a: Array = columns(6)
    axis_b: Array = columns(6)
    group: Index = columns()
    doubt_a: Array = columns()
    doubt_b: Array = columns()
    flush: Mask = columns()

    def __post_init__(self) -> None:
        read_only(self)

    @property
    def doubted(self) -> bool:
        """Whether a curvature is known to its doubt only."""
        return bool(self.doubt_a.any() or self.doubt_b.any())

    @property
    def open(self) -> Mask:
        """Rows of which a feature is not known, shape (K,)."""
        unknown: Mask = (self.kind_a == OPEN) | (self.kind_b == OPEN)
        return unknown
