"""Contacts at edges and corners, and bounds on contacts that are not modelled.

Corners and edges of two parts meet at points (`feature_pairs`). For each point the spanning rule
(`normals`) either gives normals, and the point is a contact, or it finds that the allowed motions
form a union: then the point is degenerate. A degenerate point is listed as unsupported and bounded
from both sides: without it, and with a force along every extreme normal that separates the parts
there.

- A corner on a facet, or the two ends of an edge on a facet: the normal of the facet.
- Edges that cross: the normal of both.
- A corner or edge in a notch: a normal for each facet.
- At the rim of a patch: the normal of the patch, which the patch already has.
- Beside a curved face no edge is sharp; contacts there without a formula are listed and
  bounded by `kilter.contact.sharp.edges_on_curves`.

For two convex parts a patch of planar contact is complete: no other contact is searched for. The
contacts are patches without area. An edge on a facet is a single patch, with its two ends on that
facet as points; every other point is a patch of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import TINY, Array, Index, Labels, Mask, connected, ragged
from kilter.assembly.geometry import Geometry
from kilter.contact.common.broad import Boxes
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.edges import EdgeCurves, Edges, find_edges
from kilter.contact.common.findings import FacePatches, Findings, explained, is_settled, on_patches
from kilter.contact.common.patches import (
    DegeneratePoints,
    Patches,
    PossibleContacts,
    UnsupportedContact,
)
from kilter.contact.contact_tolerances import (
    CONE_ANGLE,
    EDGE_STRAIGHTNESS,
    LOOSE_GAP,
    MEETS_EXACTLY,
    NORMAL_ANGLE,
    ONE_POINT,
)
from kilter.contact.curved.rims import coaxial_clear, rims_clear
from kilter.contact.sharp.edges_on_curves import (
    NearFaces,
    RoundContacts,
    beside_curved,
    edges_near_faces,
    explained_points,
    round_contacts,
)
from kilter.contact.sharp.edges_with_edges import (
    EdgeTouching,
    edges_on_edges,
    near_edge_pairs,
    tips_on_edges,
)
from kilter.contact.sharp.edges_with_faces import EdgeFacePairs, edge_contacts_on_faces
from kilter.contact.sharp.feature_pairs import CORNER, EDGE, FACE, Meetings, PairBlock, meetings
from kilter.contact.sharp.normals import Clauses, Pushes, normals_of


def edge_contacts(
    search: ContactSearch, edges: Edges, meetings: Meetings, pushes: Pushes
) -> Patches:
    """Contact patches for the accepted contact points of edges and corners, ordered by pair.

    `accuracy` is that of the coordinates, relative to the size of the features that touch.
    """
    if not len(pushes.meeting):
        return Patches.none()
    pushes = pushes.take(np.argsort(meetings.pair[pushes.meeting], kind="stable"))
    label = _edge_labels(search, edges, meetings, pushes)
    point = meetings.middle[pushes.meeting]
    pushes_kept = _without_middle_points(point, label)
    pushes, label = pushes.take(pushes_kept), label[pushes_kept]
    order = np.argsort(label, kind="stable")
    pushes, label = pushes.take(order), label[order]
    row = pushes.meeting
    start = np.append(np.flatnonzero(np.diff(label, prepend=-1)), len(label))
    gap = np.einsum("ij,ij->i", meetings.at[row, 1] - meetings.at[row, 0], pushes.normal)
    first = start[:-1]
    gaps = [reduce.reduceat(gap, first) for reduce in (np.minimum, np.maximum)]
    point_accuracy = _relative_accuracy(search, edges, meetings, row)
    pair = meetings.pair[row[first]]
    return Patches(
        pair=pair,
        parts=search.pairs[pair],
        kind=_kinds(meetings, pushes, start),
        normal=pushes.normal[first],
        area=np.zeros(len(pair)),
        gap=np.column_stack(gaps),
        accuracy=np.maximum.reduceat(point_accuracy, first),
        doubt=np.zeros(len(pair)),
        mu=np.full(len(pair), np.nan),
        start=start,
        points=meetings.middle[row],
        normals=pushes.normal,
    )


def _kinds(meetings: Meetings, pushes: Pushes, start: Index) -> Labels:
    """Kind of each contact patch: "edge-edge", "vertex-face" or "edge-face"."""
    first = start[:-1]
    kind = meetings.kind[pushes.meeting[first]]
    crossing = (kind == EDGE).all(axis=1) | ~pushes.of_facet[first].any(axis=1)
    crossing &= ~(kind == FACE).any(axis=1)
    kinds: Labels = np.where(crossing, "edge-edge", "vertex-face").astype("<U11")
    kinds[np.diff(start) > 1] = "edge-face"
    return kinds


def _edge_labels(search: ContactSearch, edges: Edges, meetings: Meetings, pushes: Pushes) -> Index:
    """Number of each contact point; points of the same edge on the same facet share a number."""
    first, second = [], []
    for side in (0, 1):
        point, edge = _edges_at(edges, meetings, pushes, side)
        on_facet = pushes.of_facet[point, 1 - side]
        level = np.einsum("ij,ij->i", edges.direction(search.geometry, edge), pushes.normal[point])
        on_facet &= np.abs(level) <= CONE_ANGLE
        point, edge = point[on_facet], edge[on_facet]
        order = np.lexsort((edge, meetings.pair[pushes.meeting[point]]))
        point, edge = point[order], edge[order]
        p, q = point[:-1], point[1:]
        same = np.diff(edge) == 0
        same &= meetings.pair[pushes.meeting[p]] == meetings.pair[pushes.meeting[q]]
        same &= np.linalg.norm(pushes.normal[p] - pushes.normal[q], axis=1) <= NORMAL_ANGLE
        first.append(p[same])
        second.append(q[same])
    return connected(len(pushes), np.concatenate(first), np.concatenate(second))


def _edges_at(edges: Edges, meetings: Meetings, pushes: Pushes, side: int) -> tuple[Index, Index]:
    """Edges of part a (`side` 0) or b (1) through each contact point: pairs (point, edge)."""
    kind, feature = meetings.kind[pushes.meeting, side], meetings.feature[pushes.meeting, side]
    on_edge, corner = np.flatnonzero(kind == EDGE), np.flatnonzero(kind == CORNER)
    owner, row = ragged(edges.ray_start, feature[corner])
    points = np.concatenate([on_edge, corner[owner]])
    return points, np.concatenate([feature[on_edge], edges.ray_edge[row]])


def _without_middle_points(point: Array, label: Index) -> Index:
    """Rows of contact points that are not between two others on the same edge."""
    keep = np.ones(len(label), dtype=bool)
    count = np.bincount(label)
    for group in np.flatnonzero(count > 2):
        rows = np.flatnonzero(label == group)
        offset = point[rows] - point[rows[0]]
        span = offset[np.linalg.norm(offset, axis=1).argmax()]
        length = float(np.linalg.norm(span))
        share = offset @ span / max(length, TINY)
        off_line = offset - np.outer(share, span) / max(length, TINY)
        if np.abs(off_line).max() <= EDGE_STRAIGHTNESS * length:
            keep[rows] = False
            keep[rows[[share.argmin(), share.argmax()]]] = True
    return np.flatnonzero(keep)


def _relative_accuracy(
    search: ContactSearch, edges: Edges, meetings: Meetings, rows: Index
) -> Array:
    """Error of the coordinates divided by the size of the smallest touching edge or facet [-]."""
    geometry, facets = search.geometry, search.facets
    width = np.full(len(rows), np.inf)
    accuracy = np.zeros(len(rows))
    for side in (0, 1):
        kind, feature = meetings.kind[rows, side], meetings.feature[rows, side]
        face, edge = np.flatnonzero(kind == FACE), np.flatnonzero(kind == EDGE)
        corner = np.flatnonzero(kind == CORNER)
        face_width = facets.area[feature[face]] / facets.reach[feature[face]]
        width[face] = np.minimum(width[face], face_width)
        p, q = edges.ends(geometry, feature[edge])
        width[edge] = np.minimum(width[edge], np.linalg.norm(q - p, axis=1))
        part = np.empty(len(rows), dtype=np.int64)
        part[face] = facets.part[feature[face]]
        part[edge] = geometry.vertex_part[edges.ends_of[feature[edge], 0]]
        part[corner] = geometry.vertex_part[feature[corner]]
        width = np.minimum(width, geometry.size[part])
        accuracy += geometry.accuracy[part]
    result: Array = accuracy / width
    return result


PAIRS = 20_000
"""Pairs searched at once, so that their candidates fit in memory."""


@dataclass(frozen=True, slots=True, eq=False)
class _SharpSearch:
    """Input of the search for edge contacts: the patches so far, and the edges of the parts."""

    face_patches: FacePatches
    edges: Edges

    @property
    def geometry(self) -> Geometry:
        return self.face_patches.search.geometry

    @property
    def pairs(self) -> Index:
        return self.face_patches.search.pairs

    @property
    def gap(self) -> Array:
        return self.face_patches.search.limits.gap


def find_sharp(face_patches: FacePatches, *, unmodelled: bool = True) -> Findings:
    """Find contacts at corners, edges and round faces that the patches so far do not explain.

    `unmodelled`: whether contacts without a definite normal or without a formula are searched for
    beside the patches.
    """
    search, boxes = face_patches.search, face_patches.search.boxes
    a, b = search.pairs.T
    open_pairs = ~is_settled(face_patches)
    reach = _reach(face_patches)
    sharp_rows = np.flatnonzero(_boxes_meet(boxes, a, b, search.limits.gap) & open_pairs)
    round_rows = np.flatnonzero(_boxes_meet(boxes, a, b, reach) & open_pairs)
    round_rows = round_rows[_round_parts(search.geometry)[search.pairs[round_rows]].any(axis=1)]
    all_rows = np.union1d(sharp_rows, round_rows)
    if not len(all_rows):
        return Findings()
    edges = find_edges(search.geometry, search.facets, np.unique(search.pairs[all_rows]))
    near = _SharpSearch(face_patches, edges)
    candidates = _meetings(near, sharp_rows, search.limits.gap)
    candidates = candidates.take(
        np.flatnonzero(~face_patches.smooth.explains(candidates.pair, candidates.middle))
    )
    candidates = candidates.take(np.flatnonzero(~_beside_curved(near, candidates)))
    all_pushes, clauses = _normals(near, candidates)
    pushes, clauses = _without_explained(candidates, all_pushes, clauses, face_patches)
    patches = edge_contacts(search, edges, candidates, pushes)
    touching, left = _edges_on_round_faces(near, round_rows, reach)
    found = Findings(
        patches=Patches.join([patches, touching.patches(search)]).ordered(),
        rejected=touching.rejected(search),
    )
    if not unmodelled:
        return found
    degenerate = _degenerate_points(near, candidates, clauses, all_pushes)
    rounds = _round_contacts(near, round_rows, touching, left, reach)
    return replace(
        found,
        unsupported=(*_unsupported_of(degenerate, search.geometry), *rounds.unsupported),
        possible=rounds.possible,
        degenerate=degenerate,
    )


def _meetings(near: _SharpSearch, rows: Index, tolerance: Array) -> Meetings:
    """Points at which corners and edges come near the other part, for each pair and tolerance."""
    search, boxes = near.face_patches.search, near.face_patches.search.boxes
    blocks: list[Meetings] = []
    for block_rows in np.array_split(rows, max(1, len(rows) // PAIRS)):
        a, b = near.pairs[block_rows].T
        limit = tolerance[block_rows]
        low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - limit[:, None]
        high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + limit[:, None]
        blocks += meetings(PairBlock(search, near.edges, block_rows, limit, low, high))
    return Meetings.join(blocks)


def _normals(near: _SharpSearch, met: Meetings) -> tuple[Pushes, Clauses]:
    """Normals at meeting points of corners and edges: unique, or several at degenerate points."""
    geometry = near.geometry
    parts = near.pairs[met.pair]
    size, accuracy = geometry.size[parts].min(axis=1), geometry.accuracy[parts].sum(axis=1)
    distance = np.linalg.norm(met.at[:, 1] - met.at[:, 0], axis=1)
    coincident = distance <= MEETS_EXACTLY * size + 8 * accuracy
    return normals_of(geometry, near.face_patches.search.facets, near.edges, met, coincident)


def _round_parts(geometry: Geometry) -> Mask:
    """Mask of the parts that have a curved surface, shape (N,)."""
    has_surface: Mask = np.diff(geometry.surfaces.start) > 0
    return has_surface


def _beside_curved(near: _SharpSearch, met: Meetings) -> Mask:
    """Mask of meeting points at curved surfaces, where triangle edges may be no real edges."""
    geometry = near.geometry
    parts = near.pairs[met.pair]
    slack = near.gap[met.pair] + 2 * geometry.slack[parts].max(axis=1, initial=0.0)
    beside = np.zeros(len(met), dtype=bool)
    rows = np.flatnonzero(_round_parts(geometry)[parts].any(axis=1))
    beside[rows] = beside_curved(geometry, parts[rows], met.middle[rows], slack[rows])
    return beside


def _boxes_meet(boxes: Boxes, a: Index, b: Index, grow: Array) -> Mask:
    """Mask of pairs of parts whose boxes are at most `grow` apart."""
    apart = np.maximum(
        boxes.part_low[a] - boxes.part_high[b], boxes.part_low[b] - boxes.part_high[a]
    )
    return np.asarray(apart.max(axis=1) <= grow)


def _reach(face_patches: FacePatches) -> Array:
    """Largest gap at which edges and free-form faces of each pair may touch a round face.

    In the length unit, shape (number of pairs,).

    For a pair without touching or near faces it is the loose tolerance.
    """
    limits, search = face_patches.search.limits, face_patches.search
    rejected = [*face_patches.flat.rejected, *face_patches.curved.rejected]
    near = {tuple(sorted(faces.ends)) for faces in rejected}
    has_near = [tuple(sorted(pair)) in near for pair in search.pairs.tolist()] if near else False
    size = search.geometry.size[search.pairs].min(axis=1)
    loose = np.where(face_patches.has_patch | has_near, 0.0, LOOSE_GAP * size)
    return np.asarray(np.maximum(limits.closed, loose))


def _edges_on_round_faces(
    near: _SharpSearch, rows: Index, reach: Array
) -> tuple[EdgeTouching, tuple[Meetings, Sequence[NearFaces]]]:
    """Contacts of edges on or beside curved faces of the pairs `rows`, and features without.

    Edges between exact faces have contact formulas. Other edges are given by triangles, which lie
    off their surfaces by up to the slack: the second result has the meeting points and the edges
    near faces whose contacts have no formula.
    """
    touching = EdgeTouching()
    if not len(rows):
        return touching, (Meetings.join([]), ())
    geometry, face_patches = near.geometry, near.face_patches
    curves = EdgeCurves(geometry, face_patches.search.facets, near.edges)
    candidates = _meetings(near, rows, reach + geometry.slack[near.pairs].sum(axis=1))
    candidates = candidates.take(
        np.flatnonzero(_beside_curved(near, candidates) & ~_clear_rims(near, candidates, reach))
    )
    candidates = candidates.take(np.flatnonzero(~_explained_meetings(near, candidates)))
    exact = _exact_meetings(curves, candidates)
    on_faces = [
        edges_near_faces(face_patches, near.edges, rows, reach, turn=turn) for turn in (False, True)
    ]
    pairs, others = _edge_face_pairs(curves, candidates.take(np.flatnonzero(exact)), on_faces)
    pairs = pairs.take(np.flatnonzero(~_edges_explained(near, pairs.pair, pairs.edge, reach)))
    edge_contacts_on_faces(face_patches, curves, pairs, reach, touching)
    beside = near_edge_pairs(face_patches, curves, rows, reach)
    edges_on_edges(face_patches.search, curves, beside, reach, touching)
    tips_on_edges(face_patches.search, curves, rows, reach, touching)
    touching = _unexplained(face_patches, touching, reach)
    return touching, (candidates.take(np.flatnonzero(~exact)), others)


def _round_contacts(
    near: _SharpSearch,
    rows: Index,
    touching: EdgeTouching,
    left: tuple[Meetings, Sequence[NearFaces]],
    reach: Array,
) -> RoundContacts:
    """Contacts without a formula at curved faces of the pairs `rows`, searched within the slack.

    `touching`, `left`: the results of `_edges_on_round_faces`.
    """
    if not len(rows):
        return RoundContacts()
    face_patches, (candidates, others) = near.face_patches, left
    pushes, clauses = _without_explained(candidates, *_normals(near, candidates), face_patches)
    on_rim = np.concatenate([pushes.meeting, clauses.meeting])
    rims = (
        np.append(candidates.pair[on_rim], [pair for pair, _ in touching.unresolved]),
        np.concatenate(
            [candidates.middle[on_rim], *(point[None] for _, point in touching.unresolved)]
        ),
    )
    rounds = round_contacts(face_patches, near.edges, rows, rims, (others[0], others[1]), reach)
    possible = PossibleContacts.join([rounds.possible, touching.possible(face_patches.search)])
    return replace(rounds, possible=possible)


def _edges_explained(near: _SharpSearch, pair: Index, edge: Index, reach: Array) -> Mask:
    """Mask of edges whose ends and middle lie on contact patches of their pairs."""
    p, q = near.edges.ends(near.geometry, edge)
    result = np.ones(len(pair), dtype=bool)
    for point in (p, q, (p + q) / 2):
        rows = np.flatnonzero(result)
        result[rows] = explained_points(near.face_patches, pair[rows], point[rows], reach)
    return result


def _exact_meetings(curves: EdgeCurves, met: Meetings) -> Mask:
    """Mask of meeting points whose features are flat faces, exact edges, or corners of these."""
    edges = curves.edges
    exact = np.ones(len(met), dtype=bool)
    for side in (0, 1):
        kind, feature = met.kind[:, side], met.feature[:, side]
        on_edge, corner = np.flatnonzero(kind == EDGE), np.flatnonzero(kind == CORNER)
        exact[on_edge] &= curves.exact(feature[on_edge])
        rays = edges.rays(curves.geometry, feature[corner])
        unknown = rays.owner[~curves.exact(rays.edge)]
        exact[corner[unknown]] = False
    return exact


def _edge_face_pairs(
    curves: EdgeCurves, met: Meetings, on_faces: list[NearFaces]
) -> tuple[EdgeFacePairs, list[NearFaces]]:
    """Pairs of an exact edge and an exact face, and the edges near curved faces that are others.

    `met`: exact meeting points; those with a flat face are used, with all edges at a corner.
    """
    s, edges = curves.geometry.surfaces, curves.edges
    blocks, others = [], []
    for turned, (pair, surface, edge) in zip((False, True), on_faces, strict=True):
        known = curves.exact(edge) & (s.doubt[surface] == 0)
        k = np.flatnonzero(known)
        blocks.append(
            EdgeFacePairs(pair[k], np.full(len(k), turned), edge[k], surface[k], 0 * edge[k])
        )
        rest = np.flatnonzero(~known)
        others.append((pair[rest], surface[rest], edge[rest]))
    for turned, side in ((True, 0), (False, 1)):
        flat = met.kind[:, 1 - side] == FACE
        k = np.flatnonzero(flat & (met.kind[:, side] == EDGE))
        corner = np.flatnonzero(flat & (met.kind[:, side] == CORNER))
        rays = edges.rays(curves.geometry, met.feature[corner, side])
        row = np.append(k, corner[rays.owner])
        edge = np.append(met.feature[k, side], rays.edge)
        keep = curves.sharp(edge)
        row, edge = row[keep], edge[keep]
        names = np.column_stack([met.pair[row], edge, met.feature[row, 1 - side]])
        pair, edge, facet = np.unique(names, axis=0).T
        blocks.append(
            EdgeFacePairs(pair, np.full(len(pair), turned), edge, np.full(len(pair), -1), facet)
        )
    return EdgeFacePairs.join(blocks), others


def _unexplained(face_patches: FacePatches, touching: EdgeTouching, reach: Array) -> EdgeTouching:
    """The contacts and unresolved points of edges that lie on no contact patch of their pair.

    A pair with an unresolved point is open, and its near edges say no more.
    """
    touched = [
        contact
        for contact in touching.touching
        if not explained_points(
            face_patches, np.full(len(contact.points), contact.pair), contact.points, reach
        ).all()
    ]
    pair = np.array([row for row, _ in touching.unresolved], dtype=np.int64)
    points = np.array([point for _, point in touching.unresolved]).reshape(-1, 3)
    is_left = np.flatnonzero(~explained_points(face_patches, pair, points, reach))
    unresolved = [touching.unresolved[k] for k in is_left]
    open_pairs = set(pair[is_left].tolist())
    near = [(row, gap) for row, gap in touching.near if row not in open_pairs]
    return EdgeTouching(touched, near, unresolved)


def _clear_rims(near: _SharpSearch, met: Meetings, reach: Array) -> Mask:
    """Mask of meeting points on round rims that keep clear of the other part all around."""
    geometry, facets = near.geometry, near.face_patches.search.facets
    limit = reach[met.pair]
    clear = np.zeros(len(met), dtype=bool)
    ends = np.stack([met.feature, met.feature], axis=2)
    edge = met.kind == EDGE
    ends[edge] = near.edges.ends_of[met.feature[edge]]
    for side in (0, 1):
        rows = np.flatnonzero(met.kind[:, side] == FACE)
        facet = met.feature[rows, side]
        normal = facets.normal[facet]
        clear[rows] = True
        for vertex in ends[rows, 1 - side].T:
            off = np.einsum("ij,ij->i", geometry.vertices[vertex] - facets.origin[facet], normal)
            clear[rows] &= rims_clear(geometry, vertex, normal, off, limit[rows])
    rows = np.flatnonzero((met.kind != FACE).all(axis=1))
    clear[rows] = coaxial_clear(geometry, ends[rows], limit[rows])
    return clear


def _explained_meetings(near: _SharpSearch, met: Meetings) -> Mask:
    """Mask of meeting points that already lie on a contact patch of their pair."""
    geometry = near.geometry
    is_explained = np.zeros(len(met), dtype=bool)
    if not len(met):
        return is_explained
    middle = met.middle
    order = np.argsort(met.pair, kind="stable")
    names, first = np.unique(met.pair[order], return_index=True)
    for pair, of_pair in zip(names.tolist(), np.split(order, first[1:]), strict=True):
        slack = float(near.gap[pair] + 2 * geometry.slack[near.pairs[pair]].max())
        is_explained[of_pair] = explained(near.face_patches, pair, middle[of_pair], slack)
    return is_explained


def _without_explained(
    met: Meetings, pushes: Pushes, clauses: Clauses, face_patches: FacePatches
) -> tuple[Pushes, Clauses]:
    """Contact points and degenerate points that lie on no flat patch of their pair."""
    row = pushes.meeting
    on_patch = on_patches(face_patches, met.pair[row], met.middle[row], pushes.normal)
    pushes = pushes.take(np.flatnonzero(~on_patch))
    row = clauses.meeting[clauses.owner]
    normal_on_patch = on_patches(face_patches, met.pair[row], met.middle[row], clauses.normal)
    fulfilled = np.zeros(len(clauses.meeting), dtype=bool)
    fulfilled[clauses.owner[normal_on_patch]] = True
    return pushes, clauses.take(np.flatnonzero(~fulfilled))


def _degenerate_points(
    near: _SharpSearch, met: Meetings, clauses: Clauses, pushes: Pushes
) -> DegeneratePoints:
    """Points without a unique normal, and the points of the same pairs that have one."""
    has_clause = np.zeros(len(near.pairs), dtype=bool)
    has_clause[met.pair[clauses.meeting]] = True
    held = pushes.take(np.flatnonzero(has_clause[met.pair[pushes.meeting]]))
    order = np.argsort(met.pair[clauses.meeting], kind="stable")
    clauses = clauses.take(order)
    part_a, part_b = near.pairs[met.pair[clauses.meeting]].T
    return DegeneratePoints(
        part_a=part_a,
        part_b=part_b,
        points=met.middle[clauses.meeting],
        start=clauses.start,
        normals=clauses.normal,
        exact=clauses.exact,
        held_parts=near.pairs[met.pair[held.meeting]],
        held_points=met.middle[held.meeting],
        held_normals=held.normal,
    )


def _unsupported_of(points: DegeneratePoints, geometry: Geometry) -> list[UnsupportedContact]:
    """An `UnsupportedContact` for each pair: "vertex" if all its points coincide, else "edge"."""
    if not len(points):
        return []
    key = points.part_a * len(geometry.mass) + points.part_b
    first = np.flatnonzero(np.diff(key, prepend=-1))
    count = np.diff(np.append(first, len(key)))
    group = np.repeat(np.arange(len(first)), count)
    middle = np.add.reduceat(points.points, first) / count[:, None]
    apart = np.linalg.norm(points.points - points.points[first][group], axis=1)
    spread = np.maximum.reduceat(apart, first)
    size = np.minimum(geometry.size[points.part_a], geometry.size[points.part_b])[first]
    # points spread along a line: an edge; all points in the same place: a vertex
    kinds = np.where(spread > ONE_POINT * size, "edge", "vertex").tolist()
    parts = zip(points.part_a[first].tolist(), points.part_b[first].tolist(), strict=True)
    return [
        UnsupportedContact(pair, kind, (x, y, z))
        for pair, kind, (x, y, z) in zip(parts, kinds, middle.tolist(), strict=True)
    ]
