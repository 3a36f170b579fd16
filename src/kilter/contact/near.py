"""Contacts that are not modelled yet: edges, corners and round surfaces; bounded, not guessed.

Pairs of parts that come within tolerance but meet in a corner, an edge or a round face are
listed as unsupported. What they could do to a verdict is bounded from both sides: without
them, and with every force that they might bring (`PossibleContacts`).

- A corner of one part in a facet of the other pushes along the facet's normal, if the part
  with the corner lies in front of the facet there.
- Edges that cross push along the normal of both, if the parts lie on either side of it.
- Where two corners, or edges side by side, meet, the normals found in this way include the
  extreme ones of the cone of normals that separate the two parts, so that every force
  between them is a sum of these (Palmer's degenerate contacts; the paper, section 1.1).
- A sphere is pushed through its centre, the side of a cylinder across its axis.

For two convex parts a patch of planar contact is complete: nothing else is looked for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kilter.contact.broad import Boxes, facets_in, joins
from kilter.contact.contact_set import PossibleContacts, Unsupported, joined
from kilter.contact.curved import CurvedContacts
from kilter.contact.edges import Edges, find_edges, segment_distance
from kilter.contact.facets import Facets
from kilter.contact.patches import Patches
from kilter.contact.round import (
    RoundContacts,
    beside_curved,
    no_round_contacts,
    round_contacts,
)
from kilter.geometry import Geometry
from kilter.rigid import cross

__all__ = ["NearContacts", "Touching", "near_contacts"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]

PARALLEL = 1e-9
"""Edges closer to parallel than this have no normal of their own [rad]."""
IN_FRONT = 1e-3
"""A part counts as lying in front of a plane up to this angle [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class Touching:
    """Pairs of parts whose boxes meet: `pairs` (n, 2), gap `tolerance` (n,), their patches."""

    pairs: Index
    tolerance: Array
    patches: Patches
    curved: CurvedContacts

    @property
    def has_patch(self) -> Mask:
        """Whether each pair has a patch, flat or curved, shape (n,)."""
        found = np.zeros(len(self.pairs), dtype=bool)
        found[self.patches.pair] = True
        found[self.curved.pair] = True
        return found


@dataclass(frozen=True, slots=True, eq=False)
class NearContacts:
    """What touches but is not modelled, and the forces that it could bring."""

    unsupported: tuple[Unsupported, ...]
    possible: PossibleContacts


@dataclass(frozen=True, slots=True, eq=False)
class _Points:
    """Candidate points: row of the pair, position, normal from a to b, whether edges cross."""

    pair: Index
    point: Array
    normal: Array
    crossing: Mask

    def take(self, rows: Index) -> _Points:
        """The rows chosen."""
        return _Points(*(getattr(self, name)[rows] for name in self.__slots__))


@dataclass(frozen=True, slots=True, eq=False)
class _Block:
    """Some of the pairs, by row, and the box in which the parts of each may meet.

    `tolerance`: shape (n,); `low`, `high`: shape (n, 3), in the frame of the boxes;
    `edges`: of all their parts.
    """

    geometry: Geometry
    facets: Facets
    boxes: Boxes
    edges: Edges
    touching: Touching
    rows: Index
    tolerance: Array
    low: Array
    high: Array

    def near(self, part: Index) -> tuple[Index, Index]:
        """Flat facets of ``part[k]`` in box k: pairs (k, facet)."""
        owner, facet = facets_in(self.facets, self.boxes, part, self.low, self.high)
        flat = ~self.facets.curved[facet]
        return owner[flat], facet[flat]

    def near_edges(self, part: Index) -> tuple[Index, Index]:
        """Edges of ``part[k]`` in box k that bound a flat facet: pairs (k, edge)."""
        owner, edge = self.edges.inside(self.geometry, self.boxes, part, (self.low, self.high))
        flat = ~self.facets.curved[self.edges.facet[edge]].all(axis=1)
        return owner[flat], edge[flat]


def near_contacts(
    geometry: Geometry, facets: Facets, boxes: Boxes, touching: Touching
) -> NearContacts:
    """Corner, edge and round contacts of the pairs that planar patches do not settle."""
    a, b = touching.pairs.T
    settled = facets.convex_part[a] & facets.convex_part[b] & touching.has_patch
    grow = touching.tolerance[:, None]
    meets = (boxes.part_low[a] <= boxes.part_high[b] + grow).all(axis=1)
    meets &= (boxes.part_low[b] <= boxes.part_high[a] + grow).all(axis=1)
    rows = np.flatnonzero(meets & ~settled)
    edges = find_edges(geometry, facets, np.unique(touching.pairs[rows])) if len(rows) else None
    found = _sharp(geometry, facets, boxes, touching, rows, edges)
    sharp, rounds = _apart_from_curved(geometry, facets, boxes, touching, rows, edges, found)
    pair_a, pair_b = touching.pairs[sharp.pair].T
    one_sided = np.zeros(len(pair_a), dtype=bool)
    forces = PossibleContacts(
        pair_a, pair_b, sharp.point, sharp.normal, one_sided, np.zeros(len(pair_a))
    )
    return NearContacts(
        unsupported=(*_listed(touching, sharp), *rounds.unsupported),
        possible=joined(forces, rounds.possible),
    )


def _apart_from_curved(
    geometry: Geometry,
    facets: Facets,
    boxes: Boxes,
    touching: Touching,
    rows: Index,
    edges: Edges | None,
    found: _Points,
) -> tuple[_Points, RoundContacts]:
    """Candidates away from curved faces, and what touches beside or on curved faces."""
    round_part = np.diff(geometry.surfaces.start) > 0
    round_pair = round_part[touching.pairs].any(axis=1)
    parts = touching.pairs[found.pair]
    slack = touching.tolerance[found.pair] + 2 * geometry.slack[parts].max(axis=1, initial=0.0)
    beside = np.zeros(len(parts), dtype=bool)
    some = np.flatnonzero(round_pair[found.pair])
    beside[some] = beside_curved(geometry, parts[some], found.point[some], slack[some])
    sharp, rims = (found.take(np.flatnonzero(mask)) for mask in (~beside, beside))
    rows = rows[round_pair[rows]]
    if edges is None or not len(rows):
        return sharp, no_round_contacts()
    return sharp, round_contacts(
        geometry,
        facets,
        boxes,
        edges,
        touching.pairs,
        touching.tolerance,
        rows,
        (rims.pair, rims.point),
        touching.curved,
        touching.patches,
    )


def _sharp(
    geometry: Geometry,
    facets: Facets,
    boxes: Boxes,
    touching: Touching,
    rows: Index,
    edges: Edges | None,
) -> _Points:
    """Corner-face and edge-edge candidates of some pairs."""
    found = [_nothing()]
    if edges is not None:
        # pairs in blocks, so that the candidates of a block fit in memory
        for some in np.array_split(rows, max(1, len(rows) // 20_000)):
            a, b = touching.pairs[some].T
            tolerance = touching.tolerance[some] + geometry.slack[a] + geometry.slack[b]
            grow = tolerance[:, None]
            low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow
            high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow
            block = _Block(geometry, facets, boxes, edges, touching, some, tolerance, low, high)
            near_a, near_b = block.near(a), block.near(b)
            found.append(_corners(block, near_a, near_b, 1.0))
            found.append(_corners(block, near_b, near_a, -1.0))
            found.append(_crossings(block))
    return _unexplained(_together(found), touching)


def _nothing() -> _Points:
    return _Points(
        np.empty(0, np.int64), np.empty((0, 3)), np.empty((0, 3)), np.empty(0, dtype=bool)
    )


def _together(found: list[_Points]) -> _Points:
    return _Points(
        *(np.concatenate([getattr(f, name) for f in found]) for name in _Points.__slots__)
    )


def _corners(
    block: _Block,
    near_corner: tuple[Index, Index],
    near_facet: tuple[Index, Index],
    sign: float,
) -> _Points:
    """Corners of one part in facets of the other; `sign` 1 where the corner is part a's."""
    geometry, facets, rows = block.geometry, block.facets, block.rows
    owner, corner = _corners_of(block, near_corner)
    piece_owner, piece, piece_facet = _triangles_of(facets, near_facet)
    found = [_nothing()]
    at = geometry.vertices[corner] @ block.boxes.frame.T
    pieces = geometry.vertices[facets.corners[piece]] @ block.boxes.frame.T
    around = pieces.min(axis=1, initial=np.inf), pieces.max(axis=1, initial=-np.inf)
    for pair, x, y in joins(owner, (at, at), piece_owner, around, block.tolerance):
        vertex, triangle, facet = corner[x], piece[y], piece_facet[y]
        tolerance = block.tolerance[pair]
        p = geometry.vertices[vertex]
        normal = facets.normal[facet]
        off = np.einsum("ij,ij->i", p - facets.origin[facet], normal)
        near = np.flatnonzero(np.abs(off) <= tolerance)
        inside = _in_triangle(
            p[near] - off[near, None] * normal[near],
            geometry.vertices[facets.corners[triangle[near]]],
            normal[near],
            tolerance[near],
        )
        near = near[inside]
        if not len(near):
            continue
        names = np.column_stack([pair[near], vertex[near], facet[near]])
        near = near[np.unique(names, axis=0, return_index=True)[1]]
        near = near[block.edges.in_front(geometry, vertex[near], normal[near], IN_FRONT)]
        found.append(
            _Points(
                rows[pair[near]],
                p[near] - 0.5 * off[near, None] * normal[near],
                -sign * normal[near],
                np.zeros(len(near), dtype=bool),
            )
        )
    return _together(found)


def _corners_of(block: _Block, near: tuple[Index, Index]) -> tuple[Index, Index]:
    """Corners of the near facets inside the box of each pair: pairs (k, vertex)."""
    facets = block.facets
    owner, facet = near
    count = np.diff(facets.corner_start)[facet]
    k = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
    corner = facets.corners[np.repeat(facets.corner_start[facet], count) + k]
    owner = np.repeat(owner, count)
    turned = block.geometry.vertices[corner] @ block.boxes.frame.T
    inside = ((turned >= block.low[owner]) & (turned <= block.high[owner])).all(axis=1)
    both = np.unique(np.column_stack([owner[inside], corner[inside]]), axis=0)
    return both[:, 0], both[:, 1]


def _triangles_of(facets: Facets, near: tuple[Index, Index]) -> tuple[Index, Index, Index]:
    """Triangles, by position of their corners, of the near facets: (k, corners (n, 3), facet)."""
    owner, facet = near
    fan = facets.convex[facet]
    length = np.diff(facets.corner_start)[facet]
    count = np.where(fan, length - 2, length // 3)
    k = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
    fan, base = np.repeat(fan, count), np.repeat(facets.corner_start[facet], count)
    corners = np.column_stack(
        [np.where(fan, base, base + 3 * k)]
        + [np.where(fan, base + k + step, base + 3 * k + step) for step in (1, 2)]
    )
    return np.repeat(owner, count), corners, np.repeat(facet, count)


def _in_triangle(p: Array, triangle: Array, normal: Array, tolerance: Array) -> Mask:
    """Points of the plane within `tolerance` of the triangle."""
    inside = np.ones(len(p), dtype=bool)
    for k in range(3):
        start = triangle[:, k]
        along = triangle[:, (k + 1) % 3] - start
        length = np.maximum(np.linalg.norm(along, axis=1), np.finfo(float).tiny)
        side = np.einsum("ij,ij->i", cross(along, p - start), normal) / length
        inside &= side >= -tolerance
    return inside


def _crossings(block: _Block) -> _Points:
    """Edges of a that cross edges of b."""
    geometry, facets, edges = block.geometry, block.facets, block.edges
    a, b = block.touching.pairs[block.rows].T
    owner_a, edge_a = block.near_edges(a)
    owner_b, edge_b = block.near_edges(b)
    found = [_nothing()]
    box_a, box_b = (edges.boxes(geometry, block.boxes.frame, edge) for edge in (edge_a, edge_b))
    for pair, x, y in joins(owner_a, box_a, owner_b, box_b, block.tolerance):
        e, f = edge_a[x], edge_b[y]
        tolerance = block.tolerance[pair]
        first, second = edges.direction(geometry, e), edges.direction(geometry, f)
        normal = cross(first, second)
        sine = np.linalg.norm(normal, axis=1)
        rows = np.flatnonzero(sine > PARALLEL)
        distance, middle = segment_distance(
            *edges.ends(geometry, e[rows]), *edges.ends(geometry, f[rows])
        )
        near = distance <= tolerance[rows]
        rows, middle = rows[near], middle[near]
        normal = normal[rows] / sine[rows][:, None]
        for turn in (1.0, -1.0):
            fits = edges.behind(facets, geometry, e[rows], turn * normal, IN_FRONT)
            fits &= edges.behind(facets, geometry, f[rows], -turn * normal, IN_FRONT)
            k = np.flatnonzero(fits)
            crossing = np.ones(len(k), dtype=bool)
            pair_row = block.rows[pair[rows[k]]]
            found.append(_Points(pair_row, middle[k], turn * normal[k], crossing))
    return _together(found)


def _unexplained(points: _Points, touching: Touching) -> _Points:
    """Candidates that a planar patch of the pair does not already hold."""
    patches = touching.patches
    keep = np.ones(len(points.pair), dtype=bool)
    first = np.searchsorted(patches.pair, points.pair, side="left")
    last = np.searchsorted(patches.pair, points.pair, side="right")
    settled_by = np.zeros(len(patches.pair) + 1, dtype=np.int64)
    np.add.at(settled_by, first, 1)
    np.add.at(settled_by, last, -1)
    for patch in np.flatnonzero(np.cumsum(settled_by)[:-1]):
        rows = np.flatnonzero(keep & (first <= patch) & (patch < last))
        turn = np.linalg.norm(points.normal[rows] - patches.normal[patch], axis=1)
        corners = patches.points[patches.start[patch] : patches.start[patch + 1]]
        tolerance = 2 * touching.tolerance[patches.pair[patch]]
        inside, at_rim = _in_patch(points.point[rows], corners, patches.normal[patch], tolerance)
        # at the rim of a patch the normal of the patch is the only one; inside its hull but
        # off its pieces an edge may press on an edge all the same
        held = inside & ((turn <= 2 * IN_FRONT) | (points.crossing[rows] & at_rim))
        keep[rows[held]] = False
    return points.take(np.flatnonzero(keep))


def _in_patch(p: Array, corners: Array, normal: Array, tolerance: float) -> tuple[Mask, Mask]:
    """Which points, shape (n, 3), lie on a convex patch, and which at its rim."""
    level = np.abs((p - corners[0]) @ normal) <= tolerance
    along = np.roll(corners, -1, axis=0) - corners
    length = np.maximum(np.linalg.norm(along, axis=1), np.finfo(float).tiny)
    side = cross(along[None], p[:, None] - corners[None]) @ normal / length
    middle = corners.mean(axis=0)
    if float((cross(along, middle - corners) @ normal).sum()) < 0:
        side = -side  # the corners turn the other way
    inside: Mask = level & (side >= -tolerance).all(axis=1)
    at_rim: Mask = inside & (side <= tolerance).any(axis=1)
    return inside, at_rim


def _listed(touching: Touching, points: _Points) -> list[Unsupported]:
    """One entry a pair: a corner where all points are one, else an edge."""
    listed = []
    order = np.argsort(points.pair, kind="stable")
    starts = np.flatnonzero(np.diff(points.pair[order], prepend=-1))
    for group in np.split(order, starts[1:]):
        if not len(group):
            continue
        pair = points.pair[group[0]]
        a, b = (int(k) for k in touching.pairs[pair])
        spread = np.linalg.norm(points.point[group] - points.point[group[0]], axis=1).max()
        kind = "edge" if spread > 4 * touching.tolerance[pair] else "vertex"
        x, y, z = points.point[group].mean(axis=0).tolist()
        listed.append(Unsupported((a, b), kind, (x, y, z)))
    return listed
