"""Cones: what a part looks like from close by, at a face, an edge or a corner of it.

Each is the union of convex pieces, given by directions that span them: one half-space at a
face; at a convex edge a wedge, at a reflex edge two half-spaces; at a convex corner the
cone of its edges. Any other corner is cut by the planes of its facets, and the cells inside
are grown to convex pieces that are as large as these planes allow. All from the directions
of edges and normals of facets, none from samples of the surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, across, columns, cross, ragged, unit_rows
from kilter.assembly.geometry import Geometry
from kilter.contact.contact_tolerances import CONE_ANGLE, EXACT_ANGLE
from kilter.contact.planar.facets import Facets
from kilter.contact.sharp.edges import Edges, Rays
from kilter.contact.sharp.feature_pairs import CORNER, EDGE, FACE

__all__ = ["Cones", "Sectors", "convex_pieces", "find_cones", "inside", "spanned"]


WIDE = -0.8
"""Facets whose edges at a corner make an angle of a lesser cosine give a direction between."""
FLAT = 0.9
"""Corners whose normals all come so close to their mean (cosine) give a direction inwards."""

ASKEW = 0.381966
"""Share of the way between two directions: off the planes of symmetry of most parts."""


@dataclass(frozen=True, slots=True, eq=False)
class Cones:
    """Cones of n features, as convex pieces.

    Attributes
    ----------
    start : ndarray of int, shape (n + 1,)
        The pieces of feature k are ``start[k]`` to ``start[k + 1]``.
    ray_start, rays : ndarray, shape (P + 1,) and (R, 3)
        Unit directions that span each piece.
    facet_start, facets : ndarray of int, shape (n + 1,) and (F,)
        Facets that meet at each feature.
    """

    start: Index
    ray_start: Index
    rays: Array
    facet_start: Index
    facets: Index


@dataclass(frozen=True, slots=True, eq=False)
class Sectors:
    """Facets around a corner: outward normals, from one edge left about the normal to the next."""

    normal: Array
    first: Array
    last: Array

    @property
    def middle(self) -> Array:
        """The direction half-way, also of sectors wider than a half turn."""
        return unit_rows(cross(self.normal, self.first - self.last) + EXACT_ANGLE * self.first)


@dataclass(frozen=True, slots=True, eq=False)
class _Rays(Rows):
    """Directions: `owner` (feature), piece of it."""

    owner: Index
    piece: Index
    ray: Array = columns(3)


def find_cones(
    geometry: Geometry, facets: Facets, edges: Edges, kind: Index, feature: Index
) -> Cones:
    """The cones of features, shape (n,) each: see `Meetings`."""
    corner = np.flatnonzero(kind == CORNER)
    rays = edges.rays(geometry, feature[corner])
    # a corner between two edges is a point of an edge
    straight = np.bincount(rays.owner, minlength=len(corner)) == 2
    first = np.searchsorted(rays.owner, np.flatnonzero(straight))
    kind, feature = kind.copy(), feature.copy()
    kind[corner[straight]] = EDGE
    feature[corner[straight]] = rays.edge[first]
    blocks, beside = [], []
    for block, facet in (
        _faces(facets, np.flatnonzero(kind == FACE), feature),
        _edges(geometry, facets, edges, np.flatnonzero(kind == EDGE), feature),
        _corners(geometry, facets, edges, np.flatnonzero(kind == CORNER), feature),
    ):
        blocks.append(block)
        beside.append(facet)
    return _together(len(kind), blocks, beside)


def _together(count: int, blocks: list[_Rays], beside: list[Index]) -> Cones:
    rows = _Rays.join(blocks)
    rows = rows.take(np.lexsort((rows.piece, rows.owner)))
    owner, piece, ray = rows.owner, rows.piece, rows.ray
    fresh = np.ones(len(owner), dtype=bool)
    fresh[1:] = (np.diff(owner) != 0) | (np.diff(piece) != 0)
    facet = np.unique(np.concatenate(beside), axis=0)
    facet = facet[facet[:, 1] >= 0]
    return Cones(
        start=np.searchsorted(owner[fresh], np.arange(count + 1)),
        ray_start=np.append(np.flatnonzero(fresh), len(owner)),
        rays=ray,
        facet_start=np.searchsorted(facet[:, 0], np.arange(count + 1)),
        facets=facet[:, 1],
    )


def _rows(owner: Index, piece: int, directions: list[Array]) -> _Rays:
    count = len(directions)
    return _Rays(
        np.tile(owner, count), np.full(count * len(owner), piece), np.concatenate(directions)
    )


def _half_spaces(owner: Index, piece: int, normal: Array, along: Array) -> _Rays:
    side = cross(normal, along)
    return _rows(owner, piece, [along, -along, side, -side, -normal])


def _faces(facets: Facets, which: Index, feature: Index) -> tuple[_Rays, Index]:
    normal = facets.normal[feature[which]]
    rows = _half_spaces(which, 0, normal, across(normal)[0])
    return rows, np.column_stack([which, feature[which]])


def _edges(
    geometry: Geometry, facets: Facets, edges: Edges, which: Index, feature: Index
) -> tuple[_Rays, Index]:
    sides = edges.facet[feature[which]]
    beside = np.column_stack([np.repeat(which, 2), sides.reshape(-1)])
    sides = np.where(sides < 0, sides[:, ::-1], sides)  # open there: as if flat
    left, right = facets.normal[sides].transpose(1, 0, 2)
    along = edges.direction(geometry, feature[which])
    into_left, into_right = cross(left, along), -cross(right, along)
    reflex = np.einsum("ij,ij->i", into_left, right) > CONE_ANGLE
    inward = unit_rows(into_left + into_right - left - right)
    wedge, notch = np.flatnonzero(~reflex), np.flatnonzero(reflex)
    directions = [x[wedge] for x in (along, -along, into_left, into_right, inward)]
    blocks = [_rows(which[wedge], 0, directions)]
    for piece, normal in enumerate((left, right)):
        blocks.append(_half_spaces(which[notch], piece, normal[notch], along[notch]))
    return _Rays.join(blocks), beside


def _corners(
    geometry: Geometry, facets: Facets, edges: Edges, which: Index, feature: Index
) -> tuple[_Rays, Index]:
    rays = edges.rays(geometry, feature[which])
    beside = np.column_stack([which[rays.owner], rays.left])
    convex = facets.convex_part[geometry.vertex_part[feature[which]]]
    convex |= _bends_outwards(facets, rays, len(which))
    blocks = [_convex_corners(facets, rays, which, convex)]
    start = np.searchsorted(rays.owner, np.arange(len(which) + 1))
    for k in np.flatnonzero(~convex).tolist():
        mine = np.arange(start[k], start[k + 1])
        sectors = _sectors(facets, rays, mine)
        if len(sectors.normal) < len(mine):  # open there: the hull of its edges
            pieces = [rays.direction[mine]]
        else:
            pieces = convex_pieces(sectors)
        for number, directions in enumerate(pieces):
            full = np.full(len(directions), which[k])
            blocks.append(_Rays(full, np.full(len(directions), number), directions))
    return _Rays.join(blocks), beside


def _bends_outwards(facets: Facets, rays: Rays, count: int) -> Mask:
    """Corners all of whose edges lie behind all of their facets."""
    start = np.searchsorted(rays.owner, np.arange(count + 1))
    one, other = ragged(start, rays.owner)
    seen = rays.left[one] >= 0
    one, other = one[seen], other[seen]
    rise = np.einsum("ij,ij->i", facets.normal[rays.left[one]], rays.direction[other])
    convex = np.ones(count, dtype=bool)
    convex[rays.owner[one[rise > CONE_ANGLE]]] = False
    return convex


def _convex_corners(facets: Facets, rays: Rays, which: Index, convex: Mask) -> _Rays:
    mine = np.flatnonzero(convex[rays.owner])
    owner, direction = rays.owner[mine], rays.direction[mine]
    blocks = [_Rays(which[owner], np.zeros(len(mine), np.int64), direction)]
    # between edges that nearly run on: the side of a facet that they alone do not span
    count = len(facets.part) + 1
    key, wanted = owner * count + rays.left[mine], owner * count + rays.right[mine]
    order = np.argsort(wanted, kind="stable")
    if len(mine):
        at = order[np.minimum(np.searchsorted(wanted[order], key), len(order) - 1)]
        normal = facets.normal[rays.left[mine]]
        wide = np.einsum("ij,ij->i", direction, direction[at]) < WIDE
        wide &= (wanted[at] == key) & (rays.left[mine] >= 0)
        between = Sectors(normal[wide], direction[wide], direction[at][wide]).middle
        blocks.append(_Rays(which[owner[wide]], np.zeros(len(between), np.int64), between))
        total = np.zeros((len(which), 3))
        np.add.at(total, owner, normal)
        mean = unit_rows(total)
        lowest = np.ones(len(which))
        np.minimum.at(lowest, owner, np.einsum("ij,ij->i", normal, mean[owner]))
        flat = np.flatnonzero(convex & (lowest > FLAT))
        blocks.append(_Rays(which[flat], np.zeros(len(flat), np.int64), -mean[flat]))
    return _Rays.join(blocks)


def _sectors(facets: Facets, rays: Rays, mine: Index) -> Sectors:
    """The facets around one corner, from edge to edge."""
    normal, first, last = [], [], []
    for k in mine.tolist():
        following = [j for j in mine.tolist() if rays.right[j] == rays.left[k] >= 0]
        if len(following) == 1:
            normal.append(facets.normal[rays.left[k]])
            first.append(rays.direction[k])
            last.append(rays.direction[following[0]])
    return Sectors(*(np.array(x).reshape(-1, 3) for x in (normal, first, last)))


# corners that are not convex ------------------------------------------------------------


def convex_pieces(sectors: Sectors) -> list[Array]:
    """Convex cones whose union is the inside of the surface around a corner.

    Examples
    --------
    >>> x, y, z = np.eye(3)
    >>> notch = Sectors(np.array([z, x, y]), np.array([x, y, z]), np.array([y, z, x]))
    >>> len(convex_pieces(notch))  # all but an octant: three half-spaces
    3
    """
    planes = _distinct(sectors.normal)
    samples = _samples(planes)
    signs = np.sign(samples @ planes.T)
    signs, first = np.unique(signs, axis=0, return_index=True)
    held = inside(sectors, samples[first])
    wanted: dict[tuple[float, ...], Array] = {}
    for cell in np.flatnonzero(held):
        for order in (np.arange(len(planes)), np.arange(len(planes))[::-1]):
            kept = np.ones(len(planes), dtype=bool)
            for k in order:
                kept[k] = False
                same = (signs[:, kept] == signs[cell, kept]).all(axis=1)
                kept[k] = not held[same].all()
            outward = -signs[cell, kept, None] * planes[kept]
            wanted[tuple((signs[cell] * kept).tolist())] = outward
    return [spanned(outward) for outward in wanted.values()]


def _distinct(normals: Array) -> Array:
    """Normals of different planes, whichever their sense."""
    kept: list[Array] = []
    for normal in normals:
        if all(1 - abs(float(normal @ other)) > 0.5 * CONE_ANGLE**2 for other in kept):
            kept.append(normal)
    return np.array(kept)


def _samples(planes: Array) -> Array:
    """A direction in every cell that the planes cut space into."""
    count = len(planes)
    if count == 1:
        return np.concatenate([planes, -planes])
    i, j = np.triu_indices(count, 1)
    lines = unit_rows(cross(planes[i], planes[j]))
    found = []
    for line in np.concatenate([lines, -lines]):
        height = np.abs(planes @ line)
        through = np.flatnonzero(height <= CONE_ANGLE**1.5)
        step = 0.3 * height[height > CONE_ANGLE**1.5].min(initial=1.0)
        u, v = across(line)
        traces = cross(planes[through], np.tile(line, (len(through), 1)))
        angle = np.arctan2(traces @ v, traces @ u)
        angle = np.sort(np.concatenate([angle, angle + np.pi]) % (2 * np.pi))
        following = np.append(angle[1:], angle[0] + 2 * np.pi)
        angle = (1 - ASKEW) * angle + ASKEW * following
        found.append(line + step * (np.outer(np.cos(angle), u) + np.outer(np.sin(angle), v)))
    return np.concatenate(found)


def inside(sectors: Sectors, directions: Array) -> Mask:
    """Which directions, shape (n, 3), point into the part.

    Those to which the first facet on a straight way from there to the surface shows its
    back, by a majority of ways: one that passes through an edge says nothing.
    """
    targets = unit_rows(unit_rows(sectors.first + ASKEW * sectors.middle) + ASKEW * sectors.middle)
    votes = [_shows_its_back(sectors, directions, target) for target in targets]
    result: Mask = np.mean(votes, axis=0) > 0.5
    return result


def _shows_its_back(sectors: Sectors, directions: Array, target: Array) -> Mask:
    result = np.zeros(len(directions), dtype=bool)
    nearest = np.full(len(directions), np.inf)
    for normal, first, last, half in zip(
        sectors.normal, sectors.first, sectors.last, sectors.middle, strict=True
    ):
        here, there = directions @ normal, float(target @ normal)
        if np.abs(there) < EXACT_ANGLE:
            there = 0.0  # the facet that the way leads to, or one in its plane
        # beyond 1, and where the way runs along the plane, it does not meet the facet
        fall = here - there
        reached = (np.abs(fall) >= np.abs(here)) & (fall != 0)
        at = np.divide(here, fall, out=np.full(len(here), -1.0), where=reached)
        x = directions + at[:, None] * (target - directions)
        met = np.zeros(len(directions), dtype=bool)
        for one, other in ((first, half), (half, last)):
            met |= (np.cross(one, x) @ normal >= -EXACT_ANGLE) & (
                np.cross(x, other) @ normal >= -EXACT_ANGLE
            )
        met &= (at >= 0) & (at <= 1) & (at < nearest)
        nearest = np.where(met, at, nearest)
        result = np.where(met, here < 0, result)
    return result


def spanned(outward: Array) -> Array:
    """Directions that span the cone behind planes with these outward normals, shape (n, 3).

    Examples
    --------
    >>> sorted((spanned(np.eye(3)) + 0.0).tolist())
    [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]
    """
    i, j = np.triu_indices(len(outward), 1)
    lines = cross(outward[i], outward[j])
    lines = unit_rows(lines[np.linalg.norm(lines, axis=1) > EXACT_ANGLE])
    found = [lines, -lines]
    if np.linalg.matrix_rank(outward, tol=EXACT_ANGLE**0.5) < 3:
        flat = across(outward)[0] if not len(lines) else np.empty((0, 3))
        side = cross(np.repeat(np.vstack([lines, flat]), len(outward), axis=0),
                     np.tile(outward, (len(lines) + len(flat), 1)))  # fmt: skip
        side = unit_rows(side)
        found += [flat, -flat, side, -side, unit_rows(-outward.sum(axis=0))[None]]
    every = np.concatenate(found)
    every = every[(every @ outward.T <= EXACT_ANGLE**0.5).all(axis=1)]
    kept: list[Array] = []
    for ray in every:
        if all(float(np.linalg.norm(ray - other)) > EXACT_ANGLE**0.5 for other in kept):
            kept.append(ray)
    return np.array(kept).reshape(-1, 3)
