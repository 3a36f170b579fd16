"""Contacts of exact edges and corners with edges and corners, at curved faces.

Two curves that cross have the normal of both tangents; the material of each must lie on its side of
the plane with this normal. A corner on an edge or corner, the tip of a cone there, and edges that
run along each other have no single normal: their points are unresolved.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kilter.arrays import TINY, Array, Index, Mask, cross, lengths, ragged, starts, unit_rows
from kilter.assembly.surfaces import CONE
from kilter.contact.common.broad import joins
from kilter.contact.common.contact_search import ContactSearch
from kilter.contact.common.distances import segment_distance
from kilter.contact.common.edges import EdgeCurves
from kilter.contact.common.findings import FacePatches
from kilter.contact.common.gaps import APART, PENETRATES, RejectedPair
from kilter.contact.common.patches import Patches, PossibleContacts
from kilter.contact.contact_tolerances import (
    CONE_ANGLE,
    CURVE_END,
    EDGE_NEARLY_PARALLEL,
    EDGE_PARALLEL,
    LOOSE_GAP,
    MEAN_NORMAL,
)
from kilter.contact.curved.rims import cone_tips, possible_forces
from kilter.contact.sharp.edges_on_curves import explained_points


@dataclass(frozen=True, slots=True, eq=False)
class EdgeContact:
    """A contact of an edge or corner."""

    pair: int
    """Row of the pair of parts."""
    kind: str
    """Kind of the patch."""
    points: Array
    normals: Array
    """Contact points with unit normals from part a to part b, shape (n, 3)."""
    gaps: Array
    """Gaps at points of the contact [length unit], shape (m,)."""
    outer: tuple[Array, Array] = (np.empty((0, 3)), np.empty((0, 3)))
    """Points and normals of forces that span a cone around the true one, shape (k, 3) each."""

    def repeats(self, other: EdgeContact, limit: float) -> bool:
        """Whether all points of this contact are points of another, with the same normals."""
        off = np.linalg.norm(self.points[:, None] - other.points, axis=2)
        nearest = off.argmin(axis=1)
        lean = np.abs(self.normals - other.normals[nearest]).max()
        return bool(off.min(axis=1).max() <= limit and lean <= CONE_ANGLE)


@dataclass(slots=True, eq=False)
class EdgeTouching:
    """Contacts of edges and corners that a search has found."""

    touching: list[EdgeContact] = field(default_factory=list)
    """Contacts with unit normals from part a to part b."""
    near: list[tuple[int, float]] = field(default_factory=list)
    """Least gaps that do not count as contact [length unit]."""
    unresolved: list[tuple[int, Array]] = field(default_factory=list)
    """Points without a single normal."""

    def add(self, contact: EdgeContact, limit: float) -> None:
        """Add a contact, or a near feature if its gaps exceed `limit`."""
        gaps = contact.gaps
        if gaps.min() <= limit and gaps.max() >= -limit:
            self.touching.append(contact)
        else:
            self.near.append((contact.pair, float(gaps[np.abs(gaps).argmin()])))

    def possible(self, search: ContactSearch) -> PossibleContacts:
        """Outer forces of the contacts along circles, whose points lie inside the true cone."""
        return possible_forces(
            [
                (*search.pairs[contact.pair].tolist(), point, normal)
                for contact in self.touching
                for point, normal in zip(*contact.outer, strict=True)
            ],
            two_sided=False,
        )

    def rejected(self, search: ContactSearch) -> tuple[RejectedPair, ...]:
        """Records of the near features, the nearest of each pair."""
        nearest: dict[int, float] = {}
        for pair, gap in self.near:
            if abs(gap) < abs(nearest.get(pair, np.inf)):
                nearest[pair] = gap
        records = []
        for pair, gap in nearest.items():
            a, b = search.pairs[pair].tolist()
            records.append(RejectedPair((a, b), gap, 0.0, APART if gap > 0 else PENETRATES))
        return tuple(records)

    def patches(self, search: ContactSearch) -> Patches:
        """The contacts as patches, ordered by pair, each at most once."""
        geometry, kept = search.geometry, []
        seen: dict[int, list[EdgeContact]] = {}
        for contact in sorted(self.touching, key=lambda contact: -len(contact.points)):
            limit = float(search.limits.gap[contact.pair])
            others = seen.setdefault(contact.pair, [])
            if not any(contact.repeats(other, limit) for other in others):
                others.append(contact)
                kept.append(contact)
        if not kept:
            return Patches.none()
        kept.sort(key=lambda contact: contact.pair)
        pair = np.array([contact.pair for contact in kept], dtype=np.int64)
        parts = search.pairs[pair]
        mean = np.array([contact.normals.mean(axis=0) for contact in kept])
        first = np.array([contact.normals[0] for contact in kept])
        cancels = np.linalg.norm(mean, axis=1) <= MEAN_NORMAL
        return Patches(
            pair=pair,
            parts=parts,
            kind=np.array([contact.kind for contact in kept], dtype="<U11"),
            normal=np.where(cancels[:, None], first, unit_rows(mean)),
            area=np.zeros(len(kept)),
            gap=np.array([(contact.gaps.min(), contact.gaps.max()) for contact in kept]),
            accuracy=geometry.accuracy[parts].sum(axis=1) / geometry.size[parts].min(axis=1),
            doubt=np.zeros(len(kept)),
            mu=np.full(len(kept), np.nan),
            start=starts([len(contact.points) for contact in kept]),
            points=np.concatenate([contact.points for contact in kept]),
            normals=np.concatenate([contact.normals for contact in kept]),
        )


@dataclass(frozen=True, slots=True, eq=False)
class EdgeSearch:
    """Input of the search: the contact search, its curves, and the reach of each pair."""

    search: ContactSearch
    curves: EdgeCurves
    reach: Array
    found: EdgeTouching

    def limit(self, pair: int) -> float:
        """Gap tolerance of a pair [length unit]."""
        return float(self.search.limits.gap[pair])

    def is_near(self, pair: int, gap: float) -> bool:
        """Whether a gap counts as near: within the reach of the pair and the loose tolerance."""
        size = float(self.search.geometry.size[self.search.pairs[pair]].min())
        most = max(self.limit(pair), min(float(self.reach[pair]), LOOSE_GAP * size))
        return abs(gap) <= most

    def at_apex(self, surface: int, point: Array, most: float) -> bool:
        """Whether a point of a face lies within `most` of the apex of a cone [length unit]."""
        s = self.search.geometry.surfaces
        is_cone = surface >= 0 and s.kind[surface] == CONE
        return bool(is_cone and np.linalg.norm(point - s.point[surface]) <= most)

    def face(self, surface: int, facet: int) -> tuple[Array, float]:
        """Triangles of a face, and their largest distance from its surface [length unit]."""
        if surface < 0:
            return self.search.flat(facet), 0.0
        return self.search.face(surface), float(self.search.geometry.surfaces.sagitta[surface])

    def covers(self, face: tuple[int, int], points: Array, normals: Array, pair: int) -> Mask:
        """Mask of points, shape (n, 3), to which a face extends, up to the gap tolerance."""
        surface, facet = face
        triangles, sagitta = self.face(surface, facet)
        facets, s = self.search.facets, self.search.geometry.surfaces
        part = int(s.part[surface] if surface >= 0 else facets.part[facet])
        depth = sagitta + float(self.reach[pair])
        at = points, normals
        return self.curves.extends(part, face, at, triangles, depth, self.limit(pair))


def corner_rays(curves: EdgeCurves, vertex: Index) -> tuple[Index, Array, Array, Mask]:
    """Sharp edges at vertices: number of the vertex, tangent away from it, sum of both normals.

    The last array is a mask of vertices with an edge whose curve is unknown.
    """
    distinct, place = np.unique(vertex, return_inverse=True)
    rays = curves.edges.rays(curves.geometry, distinct)
    exact = curves.exact(rays.edge)
    unknown = np.bincount(rays.owner[~exact], minlength=len(distinct)) > 0
    owner, edge = rays.owner[exact], rays.edge[exact]
    sharp = curves.sharp(edge)
    owner, edge = owner[sharp], edge[sharp]
    at_start = curves.edges.ends_of[edge, 0] == distinct[owner]
    x = curves.points(edge, np.where(at_start, 0.0, 1.0))
    away = np.where(at_start[:, None], x.along, -x.along)
    # the rays of a vertex serve each of its repeats
    number, row = ragged(np.searchsorted(owner, np.arange(len(distinct) + 1)), place)
    return number, away[row], (x.left + x.right)[row], unknown[place]


def is_corner(owner: Index, away: Array, count: int) -> Mask:
    """Mask of vertices that are no inner points of a smooth curve, shape (count,)."""
    number = np.bincount(owner, minlength=count)
    total = np.zeros((count, 3))
    np.add.at(total, owner, away)
    smooth = (number == 2) & (np.linalg.norm(total, axis=1) <= CONE_ANGLE)
    result: Mask = ~smooth
    return result


CROSSING_STEPS = 12
"""Gauss-Newton steps that locate the nearest points of two curves."""


def edges_on_edges(
    search: ContactSearch, curves: EdgeCurves, blocks: tuple[Index, Index, Index], reach: Array,
    found: EdgeTouching,
) -> None:  # fmt: skip
    """Add the contacts of edges with edges to `found`.

    `reach`, shape (number of pairs of parts,): largest gap at which parts touch, or may touch
    [length unit].
    """
    pair, e, f = blocks
    if not len(pair):
        return
    state = EdgeSearch(search, curves, reach, found)
    t, u, crossing = _nearest_shares(curves, e, f)
    x, y = curves.points(e, t), curves.points(f, u)
    apart = y.at - x.at
    distance = lengths(apart)
    inside = (np.minimum(t, u) >= -CURVE_END) & (np.maximum(t, u) <= 1 + CURVE_END)
    k = np.flatnonzero(inside & crossing & (distance <= reach[pair]))
    normal = unit_rows(cross(x.along[k], y.along[k]))
    for row, n in zip(k, normal, strict=True):
        one = np.array([row])
        limit, number = state.limit(int(pair[row])), int(pair[row])
        if _at_corner(curves, e[one], x.at[row], limit) or _at_corner(
            curves, f[one], y.at[row], limit
        ):
            continue  # the corner is compared with the other edge apart
        for sense in (1.0, -1.0):
            direction = sense * n
            if x.take(one).behind(direction) & y.take(one).behind(-direction):
                gap = float(apart[row] @ direction)
                middle = (x.at[row] + y.at[row]) / 2
                if state.is_near(number, gap):
                    contact = EdgeContact(
                        number, "edge-edge", middle[None], direction[None], np.array([gap])
                    )
                    state.found.add(contact, limit)
                break
        else:
            if distance[row] <= limit:
                state.found.unresolved.append((number, x.at[row]))
    beside = np.flatnonzero(~crossing)
    _edges_beside(state, pair[beside], e[beside], f[beside])
    _corners_on_edges(state, pair, e, f)


def _nearest_shares(curves: EdgeCurves, e: Index, f: Index) -> tuple[Array, Array, Mask]:
    """Nearest points of two curves, as fractions of their chords, and a mask of crossing curves.

    Curves with parallel tangents have no single nearest point.
    """
    (p, q), (r, s) = (curves.edges.ends(curves.geometry, edge) for edge in (e, f))
    first, second = (p + q) / 2, (r + s) / 2
    k = _crossing_chords(q - p, s - r)
    _, first[k], second[k] = segment_distance(p[k], q[k], r[k], s[k])
    chord_e, chord_f = q - p, s - r
    t = np.einsum("ij,ij->i", first - p, chord_e) / np.einsum("ij,ij->i", chord_e, chord_e)
    u = np.einsum("ij,ij->i", second - r, chord_f) / np.einsum("ij,ij->i", chord_f, chord_f)
    crossing = np.ones(len(e), dtype=bool)
    rounding_e, rounding_f = curves.share_rounding(e), curves.share_rounding(f)
    moving = np.arange(len(e))
    for _ in range(CROSSING_STEPS):
        x, y = curves.points(e[moving], t[moving]), curves.points(f[moving], u[moving])
        apart = y.at - x.at
        c = np.einsum("ij,ij->i", x.along, y.along)
        square = 1 - c**2
        crossing[moving] = square > EDGE_NEARLY_PARALLEL**2
        a, b = (np.einsum("ij,ij->i", apart, z.along) for z in (x, y))
        safe = np.where(crossing[moving], square, np.inf)
        speed_e = np.einsum("ij,ij->i", x.along, chord_e[moving])
        speed_f = np.einsum("ij,ij->i", y.along, chord_f[moving])
        last_t, last_u = t[moving], u[moving]
        t[moving] = last_t + (a - c * b) / safe / np.maximum(speed_e, TINY)
        u[moving] = last_u + (c * a - b) / safe / np.maximum(speed_f, TINY)
        t[moving], u[moving] = np.clip(t[moving], -0.5, 1.5), np.clip(u[moving], -0.5, 1.5)
        moved = np.abs(t[moving] - last_t) > rounding_e[moving]
        moved |= np.abs(u[moving] - last_u) > rounding_f[moving]
        moving = moving[moved]
        if not len(moving):
            break
    return t, u, crossing


def _at_corner(curves: EdgeCurves, edge: Index, point: Array, limit: float) -> bool:
    """Whether a point of an edge lies within `limit` of a corner at its end."""
    ends = curves.edges.ends_of[edge[0]]
    near = lengths(curves.geometry.vertices[ends] - point) <= limit
    ends = ends[near]
    if not len(ends):
        return False
    owner, away, _, unknown = corner_rays(curves, ends)
    return bool((is_corner(owner, away, len(ends)) | unknown).any())


def _edges_beside(state: EdgeSearch, pair: Index, e: Index, f: Index) -> None:
    """Unresolved points of edges that run along each other within the gap tolerance."""
    if not len(pair):
        return
    curves = state.curves
    for first, second in ((e, f), (f, e)):
        for share in (0.0, 0.5, 1.0):
            point = curves.points(first, np.full(len(first), share)).at
            off = _distance_from_curve(curves, second, point)
            for k in np.flatnonzero(off <= state.reach[pair]):
                _add_degenerate(state, int(pair[k]), point[k], float(off[k]))


def tips_on_edges(
    search: ContactSearch, curves: EdgeCurves, rows: Index, reach: Array, found: EdgeTouching
) -> None:
    """Add the tips of cones on edges and corners of the other part to `found`: unresolved points.

    `search`, `curves`, `reach`, `found`: as in `edge_contacts_on_faces`. `rows`, shape (n,): pairs
    to search.
    """
    geometry = search.geometry
    tips = cone_tips(geometry)
    if not len(tips):
        return
    state = EdgeSearch(search, curves, reach, found)
    s = geometry.surfaces
    for pair in rows.tolist():
        parts = search.pairs[pair].tolist()
        for own, other in (parts, parts[::-1]):
            for tip in s.point[tips[s.part[tips] == own]]:
                near = curves.beside(other, tip, float(reach[pair] + geometry.slack[other]))
                off = curves.distances(near, tip)
                if len(off) and off.min() <= reach[pair]:
                    _add_degenerate(state, pair, tip, float(off.min()))


def _add_degenerate(state: EdgeSearch, pair: int, point: Array, gap: float) -> None:
    """Add a point without a single normal: unresolved if it touches, else near."""
    if gap > state.limit(pair) and state.is_near(pair, gap):
        state.found.near.append((pair, gap))
    else:
        state.found.unresolved.append((pair, point))


def _distance_from_curve(curves: EdgeCurves, edge: Index, point: Array) -> Array:
    """Distance of points from the curves of edges, up to their ends [length unit], shape (n,)."""
    nearest = curves.points(edge, curves.nearest_share(edge, point)).at
    distance: Array = lengths(point - nearest)
    return distance


def _corners_on_edges(state: EdgeSearch, pair: Index, e: Index, f: Index) -> None:
    """Unresolved points of corners on edges or corners, within the gap tolerance."""
    curves = state.curves
    for own, other in ((e, f), (f, e)):
        for end in (0, 1):
            vertex = curves.edges.ends_of[own, end]
            point = curves.geometry.vertices[vertex]
            off = _distance_from_curve(curves, other, point)
            k = np.flatnonzero(off <= state.reach[pair])
            owner, away, _, unknown = corner_rays(curves, vertex[k])
            corner = is_corner(owner, away, len(k)) | unknown
            for row in k[corner]:
                _add_degenerate(state, int(pair[row]), point[row], float(off[row]))


def near_edge_pairs(
    face_patches: FacePatches, curves: EdgeCurves, rows: Index, reach: Array
) -> tuple[Index, Index, Index]:
    """Pairs of exact sharp edges that come near: pair of parts, edge of a, edge of b, shape (n,).

    Edges that come near only on a contact patch of their pair are left out.
    """
    search = face_patches.search
    geometry, boxes, edges = search.geometry, search.boxes, curves.edges
    a, b = search.pairs[rows].T
    grow = reach[rows] + geometry.slack[a] + geometry.slack[b]
    box = (
        np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow[:, None],
        np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow[:, None],
    )
    sides = []
    for part in (a, b):
        owner, edge = edges.inside(boxes, part, box)
        used, place = np.unique(edge, return_inverse=True)
        keep = curves.exact(used)
        keep[keep] = curves.sharp(used[keep])
        sides.append((owner[keep[place]], edge[keep[place]]))
    empty = np.empty(0, dtype=np.int64)
    blocks = [(empty, empty, empty)]
    (owner_a, edge_a), (owner_b, edge_b) = sides
    for k, x, y in joins(
        owner_a, edges.boxes(boxes, edge_a), owner_b, edges.boxes(boxes, edge_b), grow
    ):
        e, f = edge_a[x], edge_b[y]
        distance, middle = _chord_distance(curves, e, f)
        slack = geometry.slack[a[k]] + geometry.slack[b[k]]
        near = np.flatnonzero(distance <= reach[rows[k]] + slack)
        near = near[~explained_points(face_patches, rows[k[near]], middle[near], reach)]
        blocks.append((rows[k[near]], e[near], f[near]))
    pair, e, f = (np.concatenate([block[k] for block in blocks]) for k in range(3))
    return pair, e, f


def _crossing_chords(first: Array, second: Array) -> Index:
    """Rows of vectors that are not parallel."""
    sine = lengths(cross(unit_rows(first), unit_rows(second)))
    return np.flatnonzero(sine > EDGE_PARALLEL)


def _chord_distance(curves: EdgeCurves, e: Index, f: Index) -> tuple[Array, Array]:
    """Distance of the chords of edges, shape (n,), and the point half-way, shape (n, 3)."""
    geometry, edges = curves.geometry, curves.edges
    (p, q), (r, s) = edges.ends(geometry, e), edges.ends(geometry, f)
    distance, middle = np.full(len(p), np.inf), (p + q) / 2
    k = _crossing_chords(q - p, s - r)
    distance[k], first, second = segment_distance(p[k], q[k], r[k], s[k])
    middle[k] = (first + second) / 2
    # parallel chords: the distances of the ends decide
    for point, start, end in ((p, r, s), (q, r, s), (r, p, q), (s, p, q)):
        along = end - start
        square = np.maximum(np.einsum("ij,ij->i", along, along), TINY)
        t = np.clip(np.einsum("ij,ij->i", point - start, along) / square, 0, 1)
        foot = start + t[:, None] * along
        apart = lengths(point - foot)
        nearer = apart < distance
        distance = np.where(nearer, apart, distance)
        middle = np.where(nearer[:, None], (point + foot) / 2, middle)
    return distance, middle
