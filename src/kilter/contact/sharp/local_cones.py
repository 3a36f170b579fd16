"""Cones of directions that point from a face, edge or corner into the material of its part.

Each cone is a union of convex pieces, given by directions that span them: a half-space at a face; a
wedge at a convex edge, two half-spaces at a reflex edge; at a convex corner the cone of its edges.
The neighbourhood of any other corner is cut by the planes of its facets, and the cells inside the
part are grown to convex pieces that are as large as these planes allow. All cones follow from the
directions of edges and normals of facets, without samples of the surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import (
    Array,
    Index,
    Mask,
    Rows,
    across,
    columns,
    cross,
    distinct_rows,
    group_sums,
    ragged,
    starts,
    unit_rows,
)
from kilter.assembly.geometry import Geometry
from kilter.contact.common.edges import Edges, Rays
from kilter.contact.common.facets import Facets
from kilter.contact.contact_tolerances import CONE_ANGLE, EXACT_ANGLE
from kilter.contact.sharp.feature_pairs import CORNER, EDGE, FACE
from kilter.work import stop_if_late

WIDE = -0.8
"""If the edges of a facet at a corner make an angle with a lesser cosine, a direction between them
is added [-]."""
FLAT = 0.9
"""If all normals at a corner have a larger cosine with their mean, a direction inwards is added
[-]."""

BATCH = 1_000_000
"""Ways of directions across facets that are followed at once; a larger value needs more memory."""
ASKEW = 0.381966
"""Fraction of the way between two directions [-]; avoids the planes of symmetry of most parts."""


@dataclass(frozen=True, slots=True, eq=False)
class Cones:
    """Cones of directions into the material at n features, divided into convex cones."""

    start: Index
    """The pieces of feature k are ``start[k]`` to ``start[k + 1]``, shape (n + 1,)."""
    ray_start: Index
    rays: Array
    """Unit directions that span each piece, shape (P + 1,)."""
    facet_start: Index
    facets: Index
    """Facets that meet at each feature, shape (n + 1,)."""


@dataclass(frozen=True, slots=True, eq=False)
class Sectors:
    """Facets around a corner, anticlockwise: their outward normals and their two edges there."""

    normal: Array
    first: Array
    last: Array

    @property
    def middle(self) -> Array:
        """Unit direction in the middle of each facet's sector, also if wider than a half turn."""
        return unit_rows(cross(self.normal, self.first - self.last) + EXACT_ANGLE * self.first)


@dataclass(frozen=True, slots=True, eq=False)
class _PieceRays(Rows):
    """Unit directions that span convex cones, each with the numbers of feature and cone."""

    owner: Index
    piece: Index
    ray: Array = columns(3)


def find_cones(
    geometry: Geometry, facets: Facets, edges: Edges, kind: Index, feature: Index
) -> Cones:
    """Cones of directions into the material at faces, edges and corners."""
    corner = np.flatnonzero(kind == CORNER)
    rays = edges.rays(geometry, feature[corner])
    # a corner with two edges lies inside a straight edge
    straight = np.bincount(rays.owner, minlength=len(corner)) == 2
    first = np.searchsorted(rays.owner, np.flatnonzero(straight))
    kind, feature = kind.copy(), feature.copy()
    kind[corner[straight]] = EDGE
    feature[corner[straight]] = rays.edge[first]
    blocks, beside = [], []
    for block, facet in (
        _face_cones(facets, np.flatnonzero(kind == FACE), feature),
        _edge_cones(geometry, facets, edges, np.flatnonzero(kind == EDGE), feature),
        _corner_cones(geometry, facets, edges, np.flatnonzero(kind == CORNER), feature),
    ):
        blocks.append(block)
        beside.append(facet)
    return _pack_cones(len(kind), blocks, beside)


def _pack_cones(count: int, blocks: list[_PieceRays], beside: list[Index]) -> Cones:
    """Combine blocks of directions, and lists of adjacent facets, into `Cones`."""
    rows = _PieceRays.join(blocks)
    rows = rows.take(np.lexsort((rows.piece, rows.owner)))
    owner, piece, ray = rows.owner, rows.piece, rows.ray
    is_new = np.ones(len(owner), dtype=bool)
    is_new[1:] = (np.diff(owner) != 0) | (np.diff(piece) != 0)
    facet = np.unique(np.concatenate(beside), axis=0)
    facet = facet[facet[:, 1] >= 0]
    return Cones(
        start=np.searchsorted(owner[is_new], np.arange(count + 1)),
        ray_start=np.append(np.flatnonzero(is_new), len(owner)),
        rays=ray,
        facet_start=np.searchsorted(facet[:, 0], np.arange(count + 1)),
        facets=facet[:, 1],
    )


def _piece_rays(owner: Index, piece: int, directions: list[Array]) -> _PieceRays:
    """Give each direction the numbers of its feature and of its convex cone."""
    count = len(directions)
    return _PieceRays(
        np.tile(owner, count), np.full(count * len(owner), piece), np.concatenate(directions)
    )


def _half_spaces(owner: Index, piece: int, normal: Array, along: Array) -> _PieceRays:
    """Directions that span the half-space behind each plane; `along` is a direction in it."""
    side = cross(normal, along)
    return _piece_rays(owner, piece, [along, -along, side, -side, -normal])


def _face_cones(facets: Facets, which: Index, feature: Index) -> tuple[_PieceRays, Index]:
    """Cones of directions into the material at faces, and the facets there."""
    normal = facets.normal[feature[which]]
    rows = _half_spaces(which, 0, normal, across(normal)[0])
    return rows, np.column_stack([which, feature[which]])


def _edge_cones(
    geometry: Geometry, facets: Facets, edges: Edges, which: Index, feature: Index
) -> tuple[_PieceRays, Index]:
    """Cones of directions into the material at edges, and the two facets of each."""
    sides = edges.facet[feature[which]]
    beside = np.column_stack([np.repeat(which, 2), sides.reshape(-1)])
    sides = np.where(sides < 0, sides[:, ::-1], sides)  # an open edge counts as flat
    left, right = facets.normal[sides].transpose(1, 0, 2)
    along = edges.direction(geometry, feature[which])
    into_left, into_right = cross(left, along), -cross(right, along)
    reflex = np.einsum("ij,ij->i", into_left, right) > CONE_ANGLE
    inward = unit_rows(into_left + into_right - left - right)
    wedge, notch = np.flatnonzero(~reflex), np.flatnonzero(reflex)
    directions = [x[wedge] for x in (along, -along, into_left, into_right, inward)]
    blocks = [_piece_rays(which[wedge], 0, directions)]
    for piece, normal in enumerate((left, right)):
        blocks.append(_half_spaces(which[notch], piece, normal[notch], along[notch]))
    return _PieceRays.join(blocks), beside


def _corner_cones(
    geometry: Geometry, facets: Facets, edges: Edges, which: Index, feature: Index
) -> tuple[_PieceRays, Index]:
    """Cones of directions into the material at corners, and the facets around them.

    Convex corners and corners of three facets are computed together, other corners in a loop. An
    open corner, with a facet missing, gets the cone of its edges.
    """
    rays = edges.rays(geometry, feature[which])
    beside = np.column_stack([which[rays.owner], rays.left])
    convex = facets.convex_part[geometry.vertex_part[feature[which]]]
    convex |= _bends_outwards(facets, rays, len(which))
    blocks = [_convex_corner_cones(facets, rays, which, convex)]
    start = np.searchsorted(rays.owner, np.arange(len(which) + 1))
    reflex, three = _three_facet_cones(
        facets, rays, which, start[:-1][~convex & (np.diff(start) == 3)]
    )
    blocks.append(reflex)
    rest = ~convex
    rest[three] = False
    for k in np.flatnonzero(rest).tolist():
        stop_if_late()
        corner_rays = np.arange(start[k], start[k + 1])
        sectors = _sectors_around(facets, rays, corner_rays)
        if len(sectors.normal) < len(corner_rays):  # open corner: a facet is missing
            pieces = [rays.direction[corner_rays]]
        else:
            pieces = convex_pieces(sectors)
        for piece, directions in enumerate(pieces):
            owners = np.full(len(directions), which[k])
            blocks.append(_PieceRays(owners, np.full(len(directions), piece), directions))
    return _PieceRays.join(blocks), beside


def _bends_outwards(facets: Facets, rays: Rays, count: int) -> Mask:
    """Mask of convex corners: all edges lie behind the planes of all their facets."""
    start = np.searchsorted(rays.owner, np.arange(count + 1))
    ray, other_ray = ragged(start, rays.owner)
    has_facet = rays.left[ray] >= 0
    ray, other_ray = ray[has_facet], other_ray[has_facet]
    rise = np.einsum("ij,ij->i", facets.normal[rays.left[ray]], rays.direction[other_ray])
    convex = np.ones(count, dtype=bool)
    convex[rays.owner[ray[rise > CONE_ANGLE]]] = False
    return convex


def _convex_corner_cones(facets: Facets, rays: Rays, which: Index, convex: Mask) -> _PieceRays:
    """Cones of directions into the material at convex corners, spanned by their edges."""
    rows = np.flatnonzero(convex[rays.owner])
    owner, direction = rays.owner[rows], rays.direction[rows]
    blocks = [_PieceRays(which[owner], np.zeros(len(rows), np.int64), direction)]
    # two nearly opposite edges do not span the side on which their facet lies: add its middle
    count = len(facets.part) + 1
    key, right_key = owner * count + rays.left[rows], owner * count + rays.right[rows]
    order = np.argsort(right_key, kind="stable")
    if len(rows):
        previous = order[np.minimum(np.searchsorted(right_key[order], key), len(order) - 1)]
        normal = facets.normal[rays.left[rows]]
        wide = np.einsum("ij,ij->i", direction, direction[previous]) < WIDE
        wide &= (right_key[previous] == key) & (rays.left[rows] >= 0)
        between = Sectors(normal[wide], direction[wide], direction[previous][wide]).middle
        blocks.append(_PieceRays(which[owner[wide]], np.zeros(len(between), np.int64), between))
        # at a nearly flat corner the edges do not span the inside: add the reverse of the normal
        mean = unit_rows(group_sums(owner, normal, len(which)))
        lowest = np.ones(len(which))
        np.minimum.at(lowest, owner, np.einsum("ij,ij->i", normal, mean[owner]))
        flat = np.flatnonzero(convex & (lowest > FLAT))
        blocks.append(_PieceRays(which[flat], np.zeros(len(flat), np.int64), -mean[flat]))
    return _PieceRays.join(blocks)


def _three_facet_cones(
    facets: Facets, rays: Rays, which: Index, first: Index
) -> tuple[_PieceRays, Index]:
    """Cones of directions into the material at corners of three facets, of which an edge is reflex.

    Each edge lies in two planes, before or behind the third. With a single edge behind, this edge
    is reflex, and the material lies behind the third plane and behind one of the two. With two
    edges behind, the other edge is convex, and the material lies behind both planes of this edge,
    or behind the third. With none behind, it lies behind any of the three planes.

    Arguments: `first` (m,): the first of the three rays of each corner. Returns the cones, and the
    corners (n,) that have them, as positions in `which`: those with three independent planes whose
    edges are reflex as stated.
    """
    ray = first[:, None] + np.arange(3)
    left, right = rays.left[ray], rays.right[ray]
    closed = (left >= 0).all(axis=1) & (np.sort(left, axis=1) == np.sort(right, axis=1)).all(axis=1)
    closed &= (np.diff(np.sort(left, axis=1), axis=1) > 0).all(axis=1)
    ray, left, right = ray[closed], left[closed], right[closed]
    third = left.sum(axis=1, keepdims=True) - left - right
    rise = np.einsum("nki,nki->nk", rays.direction[ray], facets.normal[third])
    behind = (rise < 0).sum(axis=1)
    into_left = cross(facets.normal[left], rays.direction[ray])
    reflex = np.einsum("nki,nki->nk", into_left, facets.normal[right]) > 0
    kept = (reflex == ((rise < 0) | (behind[:, None] == 0))).all(axis=1) & (behind < 3)
    kept &= np.abs(np.linalg.det(facets.normal[left])) > CONE_ANGLE
    ray, left, right, third, behind = (x[kept] for x in (ray, left, right, third, behind))
    owner = which[rays.owner[ray[:, 0]]]
    odd = np.where(behind == 1, rise[kept].argmin(axis=1), rise[kept].argmax(axis=1))
    rows = np.arange(len(owner))
    a, b, c = (facets.normal[side[rows, odd]] for side in (left, right, third))
    one, two, none = (behind == count for count in (1, 2, 0))
    blocks = [_wedges(owner[one], piece, side[one], c[one]) for piece, side in enumerate((a, b))]
    blocks.append(_wedges(owner[two], 1, a[two], b[two]))
    for piece, normal, some in ((0, c, two | none), (1, a, none), (2, b, none)):
        along = across(normal[some])[0]
        blocks.append(_half_spaces(owner[some], piece, normal[some], along))
    return _PieceRays.join(blocks), rays.owner[ray[:, 0]]


def _wedges(owner: Index, piece: int, first: Array, second: Array) -> _PieceRays:
    """Directions that span the wedge behind two planes, given by their outward normals."""
    along = unit_rows(cross(first, second))
    sides = [cross(first, along), cross(along, second)]
    return _piece_rays(owner, piece, [along, -along, *sides, unit_rows(-first - second)])


def _sectors_around(facets: Facets, rays: Rays, corner_rays: Index) -> Sectors:
    """Sectors of the facets around a corner; facets without a unique next edge are left out."""
    normal, first, last = [], [], []
    for k in corner_rays.tolist():
        following = [j for j in corner_rays.tolist() if rays.right[j] == rays.left[k] >= 0]
        if len(following) == 1:
            normal.append(facets.normal[rays.left[k]])
            first.append(rays.direction[k])
            last.append(rays.direction[following[0]])
    return Sectors(*(np.array(x).reshape(-1, 3) for x in (normal, first, last)))


# non-convex corners -----------------------------------------------------------------------


def convex_pieces(sectors: Sectors) -> list[Array]:
    """Convex cones whose union is the material around a corner.

    Examples
    --------
    >>> x, y, z = np.eye(3)
    >>> notch = Sectors(np.array([z, x, y]), np.array([x, y, z]), np.array([y, z, x]))
    >>> len(convex_pieces(notch))  # all but an octant: three half-spaces
    3
    """
    # each cell inside grows by dropping planes, in both orders, while all its cells are inside
    planes = _distinct_planes(sectors.normal)
    samples = _cell_samples(planes)
    signs = np.sign(samples @ planes.T)
    signs, cell_of = distinct_rows(signs)
    first = np.empty(len(signs), dtype=np.int64)
    first[cell_of[::-1]] = np.arange(len(samples))[::-1]
    is_inside = inside(sectors, samples[first])
    pieces: dict[tuple[float, ...], Array] = {}
    for cell in np.flatnonzero(is_inside):
        # the planes between the cell and each cell outside, by plane
        between = (signs[~is_inside] != signs[cell]).T
        count = between.sum(axis=0)
        for plane_order in (range(len(planes)), reversed(range(len(planes)))):
            kept, left = np.ones(len(planes), dtype=bool), count
            for k in plane_order:
                fewer = left - between[k]
                if fewer.all():  # another kept plane separates the cell from every cell outside
                    kept[k], left = False, fewer
            outward = -signs[cell, kept, None] * planes[kept]
            pieces[tuple((signs[cell] * kept).tolist())] = outward
    return [spanned(outward) for outward in pieces.values()]


def _distinct_planes(normals: Array) -> Array:
    """Unit normals of the distinct planes through a corner; opposite normals are the same plane."""
    kept: list[Array] = []
    for normal in normals:
        if all(1 - abs(float(normal @ kept_normal)) > 0.5 * CONE_ANGLE**2 for kept_normal in kept):
            kept.append(normal)
    return np.array(kept)


def _cell_samples(planes: Array) -> Array:
    """A unit direction in each region into which planes through the origin divide space."""
    count = len(planes)
    if count == 1:
        return np.concatenate([planes, -planes])
    i, j = np.triu_indices(count, 1)
    lines = unit_rows(cross(planes[i], planes[j]))
    lines = np.concatenate([lines, -lines])
    height = np.abs(lines @ planes.T)
    through = height <= CONE_ANGLE**1.5
    # a step off the line that crosses no other plane
    step = 0.3 * np.where(through, 1.0, height).min(axis=1)
    u, v = across(lines)
    width = through.sum(axis=1)
    start = starts(2 * width)
    samples = np.empty((start[-1], 3))
    for planes_through in np.unique(width):  # lines with equally many planes together
        rows = np.flatnonzero(width == planes_through)
        plane = np.nonzero(through[rows])[1].reshape(len(rows), planes_through)
        traces = cross(planes[plane], np.broadcast_to(lines[rows, None], (*plane.shape, 3)))
        angle = np.arctan2(
            np.einsum("nki,ni->nk", traces, v[rows]), np.einsum("nki,ni->nk", traces, u[rows])
        )
        angle = np.sort(np.concatenate([angle, angle + np.pi], axis=1) % (2 * np.pi), axis=1)
        following = np.append(angle[:, 1:], angle[:, :1] + 2 * np.pi, axis=1)
        angle = ((1 - ASKEW) * angle + ASKEW * following)[..., None]
        aside = np.cos(angle) * u[rows, None] + np.sin(angle) * v[rows, None]
        at = start[rows, None] + np.arange(2 * planes_through)
        samples[at] = lines[rows, None] + step[rows, None, None] * aside
    return samples


def inside(sectors: Sectors, directions: Array) -> Mask:
    """Mask of directions from a corner, shape (n, 3), that point into the material.

    A direction points inwards if the first facet on a straight way from it to the surface is
    crossed from behind. The majority of several ways decides, because a way through an edge is
    ambiguous.
    """
    targets = unit_rows(unit_rows(sectors.first + ASKEW * sectors.middle) + ASKEW * sectors.middle)
    count = len(sectors.normal)
    batches = -(-len(targets) * count * len(directions) // BATCH)
    votes = [
        _inside_by_ways(sectors, directions, some)
        for some in np.array_split(targets, min(batches, len(targets)))
    ]
    result: Mask = np.concatenate(votes).mean(axis=0) > 0.5
    return result


def _inside_by_ways(sectors: Sectors, directions: Array, targets: Array) -> Mask:
    """Mask of directions in the material, found from the first facet on the way to each target.

    Shape (t, n) for t targets and n directions.
    """
    normal, middle = sectors.normal, sectors.middle
    height, target_height = directions @ normal.T, targets @ normal.T
    # the target's own facet, or a facet in its plane
    target_height[np.abs(target_height) < EXACT_ANGLE] = 0.0
    # a way that runs along the plane, or ends before it, does not meet the facet
    fall = height - target_height[:, None]
    reached = (np.abs(fall) >= np.abs(height)) & (fall != 0)
    share = np.full(fall.shape, -1.0)
    np.divide(np.broadcast_to(height, fall.shape), fall, out=share, where=reached)
    meets = np.zeros(fall.shape, dtype=bool)
    # both halves of a sector turn by less than a half turn: inside is left of one side of the
    # half and right of the other
    for begin, end in ((sectors.first, middle), (middle, sectors.last)):
        within = np.ones(fall.shape, dtype=bool)
        for inwards in (cross(normal, begin), cross(end, normal)):
            from_side, to_side = directions @ inwards.T, targets @ inwards.T
            at_plane = from_side + share * (to_side[:, None] - from_side)
            within &= at_plane >= -EXACT_ANGLE
        meets |= within
    meets &= (share >= 0) & (share <= 1)
    share = np.where(meets, share, np.inf)
    first = share.argmin(axis=2)
    crossed = height[np.arange(len(directions)), first]
    meets_any = np.take_along_axis(meets, first[..., None], axis=2)[..., 0]
    result: Mask = meets_any & (crossed < 0)
    return result


def spanned(outward: Array) -> Array:
    """Directions that span the cone {d : d.n <= 0 for all given normals n}, shape (k, 3).

    Examples
    --------
    >>> sorted((spanned(np.eye(3)) + 0.0).tolist())
    [[-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]]
    """
    i, j = np.triu_indices(len(outward), 1)
    lines = cross(outward[i], outward[j])
    lines = unit_rows(lines[np.linalg.norm(lines, axis=1) > EXACT_ANGLE])
    blocks = [lines, -lines]
    # the cone contains a line or a plane: directions across it are needed in addition
    if np.linalg.matrix_rank(outward, tol=EXACT_ANGLE**0.5) < 3:
        in_plane = across(outward)[0] if not len(lines) else np.empty((0, 3))
        side = cross(np.repeat(np.vstack([lines, in_plane]), len(outward), axis=0),
                     np.tile(outward, (len(lines) + len(in_plane), 1)))  # fmt: skip
        side = unit_rows(side)
        blocks += [in_plane, -in_plane, side, -side, unit_rows(-outward.sum(axis=0))[None]]
    candidates = np.concatenate(blocks)
    candidates = candidates[(candidates @ outward.T <= EXACT_ANGLE**0.5).all(axis=1)]
    apart = np.linalg.norm(candidates[:, None] - candidates, axis=2) > EXACT_ANGLE**0.5
    kept: list[int] = []
    for ray in range(len(candidates)):
        if apart[ray, kept].all():
            kept.append(ray)
    spanning: Array = candidates[kept]
    return spanning
