"""Results of the search for contacts of edges and corners at curved faces, and its shared input."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kilter.arrays import Array, Index, Mask, ragged, starts, unit_rows
from kilter.assembly.surfaces import CONE
from kilter.contact.contact_search import ContactSearch
from kilter.contact.contact_tolerances import CONE_ANGLE, LOOSE_GAP, MEAN_NORMAL
from kilter.contact.curved.exact_edges import EdgeCurves
from kilter.contact.curved.rims import possible_forces
from kilter.contact.gaps import APART, PENETRATES, RejectedPair
from kilter.contact.left_out import PossibleContacts
from kilter.contact.patches import Patches

__all__ = ["EdgeContact", "EdgeSearch", "EdgeTouching", "corner_rays", "is_corner"]


@dataclass(frozen=True, slots=True, eq=False)
class EdgeContact:
    """A contact of an edge or corner.

    Attributes
    ----------
    pair : int
        Row of the pair of parts.
    kind : str
        Kind of the patch.
    points, normals : ndarray, shape (n, 3)
        Contact points with unit normals from part a to part b.
    gaps : ndarray, shape (m,)
        Gaps at points of the contact [length unit].
    outer : (points, normals)
        Points and normals of forces that span a cone around the true one, shape (k, 3) each.
    """

    pair: int
    kind: str
    points: Array
    normals: Array
    gaps: Array
    outer: tuple[Array, Array] = (np.empty((0, 3)), np.empty((0, 3)))

    def repeats(self, other: EdgeContact, limit: float) -> bool:
        """Whether all points of this contact are points of another, with the same normals."""
        off = np.linalg.norm(self.points[:, None] - other.points, axis=2)
        nearest = off.argmin(axis=1)
        lean = np.abs(self.normals - other.normals[nearest]).max()
        return bool(off.min(axis=1).max() <= limit and lean <= CONE_ANGLE)


@dataclass(slots=True, eq=False)
class EdgeTouching:
    """Contacts of edges and corners that a search has found.

    Attributes
    ----------
    touching : list of EdgeContact
        Contacts with unit normals from part a to part b.
    near : list of (pair, gap)
        Least gaps that do not count as contact [length unit].
    unresolved : list of (pair, point)
        Points without a single normal.
    """

    touching: list[EdgeContact] = field(default_factory=list)
    near: list[tuple[int, float]] = field(default_factory=list)
    unresolved: list[tuple[int, Array]] = field(default_factory=list)

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
