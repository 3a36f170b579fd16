"""Bodies that a drawing contains twice: exact copies, and steps of a feature beside its result.

An export may write a body twice, or the steps of a feature (a pad without its pocket, a plate
without its boss) beside the result. One body of such a pair lies inside the other, and most of the
surface of the outer body is that of the inner body, too. A bolt in a block without a hole lies
inside it as well, but it reaches the surface of the block at most at its ends: it is no copy.
"""

from __future__ import annotations

import itertools

import numpy as np

from kilter.arrays import Array
from kilter.assembly import Assembly
from kilter.assembly.geometry import Geometry
from kilter.contact.common.distances import PartSolids, TriangleTrees
from kilter.contact.contact_tolerances import GAP, INSIDE, SAME_SURFACE
from kilter.contact.overlap import shared_body
from kilter.errors import InputError

SAMPLES = 400
"""Least number of points of a surface that are compared with another surface."""
MOST_SIDES = 40
"""Largest number of points along a side of a triangle."""


def copies(assembly: Assembly) -> dict[str, str]:
    """Names of the bodies that repeat another body of the drawing, each with that body.

    Of a pair the body with fewer triangles is the copy, since each feature adds faces; of equal
    bodies the later one is. A body that the file holds or joins is never a copy.

    Examples
    --------
    >>> from kilter import Box, Part
    >>> cubes = [Part("cube", Box(1, 1, 1)), Part("again", Box(1, 1, 1))]
    >>> copies(Assembly([*cubes, Part("bolt", Box(0.2, 0.2, 1))]))
    {'again': 'cube'}
    """
    try:
        geometry = assembly.geometry
    except InputError:
        return {}  # the check of the geometry will report the fault
    solids = PartSolids(geometry)
    found: dict[str, str] = {}
    faces = np.diff(geometry.triangle_start)
    named = {name for joint in assembly.joints for name in joint.parts}
    stated = [part.grounded or part.name in named for part in assembly.parts]
    for inner, outer in _candidates(geometry):
        rank = {part: (not stated[part], -faces[part], part) for part in (inner, outer)}
        kept, copy = sorted(rank, key=lambda part: rank[part])
        names = assembly.names[copy], assembly.names[kept]
        if names[0] not in found and not stated[copy] and _repeats(geometry, solids, inner, outer):
            found[names[0]] = names[1]
    return found


def _candidates(geometry: Geometry) -> list[tuple[int, int]]:
    """Pairs of bodies of which the first has its box in that of the second, and enough surface."""
    first = geometry.vertex_start[:-1]
    low = np.minimum.reduceat(geometry.vertices, first)
    high = np.maximum.reduceat(geometry.vertices, first)
    corners = geometry.vertices[geometry.triangles]
    area = np.add.reduceat(_areas(corners), geometry.triangle_start[:-1])
    margin = GAP * geometry.size[:, None] + geometry.slack[:, None]
    pairs = []
    for inner in range(len(area)):
        inside = ((low[inner] >= low - margin) & (high[inner] <= high + margin)).all(axis=1)
        inside &= (area[inner] >= SAME_SURFACE * area) & (
            geometry.volume[inner] <= geometry.volume * (1 + GAP)
        )
        pairs += [(inner, int(outer)) for outer in np.flatnonzero(inside) if outer != inner]
    known = set(pairs)
    # of two bodies of the same size, a single pair is enough
    return sorted(pair for pair in known if pair[::-1] not in known or pair[0] < pair[1])


def _repeats(geometry: Geometry, solids: PartSolids, inner: int, outer: int) -> bool:
    """Whether most of the outer surface is that of the inner body, and this body lies inside."""
    points, weights = _spread_points(geometry.corners_of(outer))
    both = [inner, outer]
    near = GAP * geometry.size[both].max() + geometry.slack[both].sum()
    near += geometry.accuracy[both].sum()
    on_inner = TriangleTrees(geometry.corners_of(inner)).within(points, near)
    if weights[on_inner].sum() <= SAME_SURFACE * weights.sum():
        return False
    body = shared_body(solids, inner, outer)
    return body is not None and body.volume > INSIDE * float(solids.of(inner).volume())


def _areas(corners: Array) -> Array:
    """Areas of triangles, shape (m,), from their corners (m, 3, 3)."""
    edges = corners[:, 1:] - corners[:, :1]
    areas: Array = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / 2
    return areas


def _spread_points(corners: Array) -> tuple[Array, Array]:
    """Points spread over triangles (m, 3, 3), shape (n, 3), and the area that each stands for."""
    areas = _areas(corners)
    sides = np.ceil(np.sqrt(SAMPLES * areas / areas.sum())).clip(1, MOST_SIDES).astype(int)
    points, weights = [], []
    for n in np.unique(sides).tolist():
        # middles of the n^2 equal triangles into which each triangle is divided
        steps = [(i, j) for i, j in itertools.product(range(n), repeat=2) if i + j < n]
        upright = [(3 * i + 1, 3 * j + 1) for i, j in steps]
        turned = [(3 * i + 2, 3 * j + 2) for i, j in steps if i + j < n - 1]
        share = np.array(upright + turned) / (3 * n)
        weight = np.column_stack([1 - share.sum(axis=1), share])
        rows = sides == n
        points.append(np.einsum("pk,tkx->tpx", weight, corners[rows]).reshape(-1, 3))
        weights.append(np.repeat(areas[rows] / n**2, n**2))
    return np.concatenate(points), np.concatenate(weights)
