"""The places that a motion leaves to a prism on tops: convex polygons, without cells of places.

The contact of a prism with the footprint F at the place x and a top T is the convex area

    K(x) = {p : A_T p <= b_T,  A_F (p - x) <= b_F}.

A motion opens the gap between prism and top at a rate g(p) that is affine in p. By duality of the
linear program in p, the least rate in K(x) is at least

    g(0) - l . b(x)    for each pair of edges with  A^T l = -grad g,  l >= 0,

which is affine in x. A motion excludes the place x if its power P(x), plus the weight W times the
least rate, is positive for each top: lifted by its most negative rate, the motion opens all gaps,
and its power is still positive. So the places that a motion leaves are a convex polygon for each
top,

    P(x) + W (g(0) - l . b(x)) <= 0    for all pairs of edges.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import shapely

from kilter.analysis.placing.placed_loads import PlacedLoads
from kilter.analysis.placing.polygon_sets import union
from kilter.analysis.placing.upright_prisms import Top
from kilter.arrays import Array
from kilter.contact.common.polygons import cut_convex
from kilter.mechanics.certificate import check_motion, needed_power
from kilter.mechanics.load_checks import shifted_weights
from kilter.mechanics.program import Program

__all__ = ["least_rates", "places_left"]

PARALLEL = 1e-12
"""Sine of the angle below which two edges are parallel [-]."""


def least_rates(
    top: tuple[Array, Array], part: tuple[Array, Array], constant: float, gradient: Array
) -> Array:
    """Affine functions of the place that bound the least rate in K(x) from below.

    Arguments: `gradient` (2,). Returns (m, 3): rows (c, s_1, s_2): the rate is at least c + s . x.
    The largest is the least rate.

    Examples
    --------
    The least first coordinate on the square [0, 2]^2 under [-1, 1]^2 + x is max(0, x_1 - 1):

    >>> from kilter.analysis.placing.upright_prisms import edges_of
    >>> square = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    >>> rows = least_rates(edges_of(square), edges_of(square - 1), 0.0, np.array([1.0, 0]))
    >>> np.unique(rows + 0.0, axis=0).tolist()
    [[-1.0, 1.0, 0.0], [0.0, 0.0, 0.0]]
    """
    if not gradient.any():
        return np.array([[constant, 0.0, 0.0]])
    normals, offsets = np.vstack([top[0], part[0]]), np.append(top[1], part[1])
    moves = np.arange(len(offsets)) >= len(top[1])
    first, second = np.triu_indices(len(offsets), 1)
    one, two = normals[first], normals[second]
    sine = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        a = (gradient[1] * two[:, 0] - gradient[0] * two[:, 1]) / sine
        b = (gradient[0] * one[:, 1] - gradient[1] * one[:, 0]) / sine
        # a multiplier that is negative by rounding alone belongs to a gradient along an edge
        least = -1e-13 * float(np.abs(gradient).max())
        chosen = (np.abs(sine) > PARALLEL) & (a >= least) & (b >= least)
    first, second = first[chosen], second[chosen]
    a, b = np.maximum(a[chosen], 0.0), np.maximum(b[chosen], 0.0)
    slope = (a * moves[first])[:, None] * normals[first]
    slope += (b * moves[second])[:, None] * normals[second]
    return np.column_stack([constant - a * offsets[first] - b * offsets[second], -slope])


def places_left(
    loads: PlacedLoads,
    tops: Iterable[Top],
    height: float,
    low: Array,
    high: Array,
    motion: Array,
) -> shapely.Geometry:
    """The places of a rectangle that a motion does not exclude, of a part without friction.

    Arguments: `height`: height of the underside of the part [length unit]; `low`, `high` (2,): the
    rectangle of centres [length unit]; `motion` (N + 1, 6): motion of all parts and of the added
    part, whose contacts are not yet known to open.
    """
    middle, half = (low + high) / 2, (high - low) / 2
    alone = loads.alone.program
    center = np.vstack([loads.program.center, [*middle, height + loads.part.below]])
    program = alone.with_rows(center=center)
    judged = check_motion(program, motion)
    if not judged.motion.any():
        return shapely.box(*low, *high)
    wrenches = loads.torques_of_part
    corners = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * half
    weights = shifted_weights(program, np.tensordot(corners, wrenches, axes=1))
    # the power that a proof needs grows with the load: convex in x, so the corners bound it
    needed = needed_power(program, judged, weights)
    slope = np.einsum("kij,ij->k", wrenches[:, program.free], judged.motion[program.free])
    power = np.array([judged.power - needed - slope @ middle, *slope])
    weight = loads.part.mass * loads.program.g
    constant, gradient = _rise(program, judged.motion, len(program.names) - 1)
    rectangle = middle + corners
    pieces = []
    for top in tops:
        under, along = _rise(program, judged.motion, top.part)
        rates = least_rates(top.edges, loads.part.edges, constant - under, gradient - along)
        ring = _without_positive(rectangle, power + weight * rates)
        # corners that are equal up to rounding are no corners of the hull
        pieces.append(shapely.convex_hull(shapely.multipoints(ring)))
    return union(pieces)


def _rise(program: Program, motion: Array, part: int) -> tuple[float, Array]:
    """Vertical velocity of a part at the point p: constant + gradient . p; 0 for a held part."""
    if not program.free[part]:
        return 0.0, np.zeros(2)
    gradient = np.array([-motion[part, 4], motion[part, 3]])
    return float(motion[part, 2] - gradient @ program.center[part, :2]), gradient


def _without_positive(ring: Array, rows: Array) -> Array:
    """Corners of the part of a convex polygon in which no affine function is positive."""
    values = rows[:, :1] + rows[:, 1:] @ ring.T
    if (values.min(axis=1) > 0).any():
        return np.empty((0, 2))
    for row in rows[values.max(axis=1) > 0]:
        ring = cut_convex(ring, -(row[0] + ring @ row[1:]))
        if len(ring) < 3:
            break
    return ring
