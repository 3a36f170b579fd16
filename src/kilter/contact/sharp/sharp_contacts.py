"""Contacts at edges and corners, and contacts that are not modelled: bounded, not guessed.

Where corners and edges of two parts meet (`meetings`), the spanning rule (`spanning`) either
gives normals, and the point is a contact, or it says that the allowed motions are a union:
then the point is degenerate, listed as unsupported, and bounded from both sides: without
it, and with a push along every extreme normal that separates the parts there.

- A corner in a facet, the two ends of an edge in one: the normal of the facet.
- Edges that cross: the normal of both.
- A corner or edge in a notch: one normal a facet.
- At the rim of a patch: the normal of the patch, which the patch already holds.
- Beside a curved face nothing is sharp; what touches one without a formula is listed and
  bounded by `kilter.contact.curved.unmodelled`.

For two convex parts a patch of planar contact is complete: nothing else is looked for.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask
from kilter.assembly.geometry import Geometry
from kilter.contact.broad import Boxes
from kilter.contact.contact_set import Degenerate, PossibleContacts, Unsupported
from kilter.contact.contact_tolerances import LOOSE_GAP, MEETS_EXACTLY, ONE_POINT
from kilter.contact.curved.rims import coaxial_clear, rims_clear
from kilter.contact.curved.unmodelled import (
    RoundContacts,
    beside_curved,
    no_round_contacts,
    round_contacts,
)
from kilter.contact.gaps import Rejected
from kilter.contact.patches import Patches
from kilter.contact.sharp.edge_contacts import edge_contacts
from kilter.contact.sharp.edges import Edges, find_edges
from kilter.contact.sharp.feature_pairs import EDGE, FACE, Meetings, PairBlock, meetings
from kilter.contact.sharp.normals import Clauses, Pushes, normals_of
from kilter.contact.touching import Touching, explained, on_patches

__all__ = ["NearContacts", "near_contacts"]


PAIRS = 20_000
"""Pairs looked at in one go, so that their candidates fit in memory."""


@dataclass(frozen=True, slots=True, eq=False)
class NearContacts:
    """Contacts at edges and corners; what is not modelled, and the forces it could bring.

    The first rows of `possible` are the normals of `degenerate`, in order.
    """

    patches: Patches
    degenerate: Degenerate
    unsupported: tuple[Unsupported, ...]
    possible: PossibleContacts


@dataclass(frozen=True, slots=True, eq=False)
class _Near:
    """What all steps need: the patches that were found, and edges of all parts looked at."""

    touching: Touching
    edges: Edges

    @property
    def geometry(self) -> Geometry:
        return self.touching.search.geometry

    @property
    def pairs(self) -> Index:
        return self.touching.search.pairs

    @property
    def gap(self) -> Array:
        return self.touching.search.limits.gap


def near_contacts(touching: Touching, rejected: Iterable[Rejected]) -> NearContacts:
    """Corner, edge and round contacts of the pairs that patches do not settle.

    `rejected`: faces that came near; of their pairs it is known already that they are open.
    """
    search = touching.search
    boxes, convex = search.boxes, search.facets.convex_part
    a, b = search.pairs.T
    settled = convex[a] & convex[b] & touching.has_patch
    reach = _reach(touching, rejected)
    rows = np.flatnonzero(_meet(boxes, a, b, search.limits.gap) & ~settled)
    beside = np.flatnonzero(_meet(boxes, a, b, reach) & ~settled)
    beside = beside[_round_parts(search.geometry)[search.pairs[beside]].any(axis=1)]
    patches, degenerate, rounds = Patches.none(), Degenerate.none(), no_round_contacts()
    either = np.union1d(rows, beside)
    if len(either):
        edges = find_edges(search.geometry, search.facets, np.unique(search.pairs[either]))
        near = _Near(touching, edges)
        met = _meetings(near, rows, search.limits.gap)
        met = met.take(np.flatnonzero(~touching.smooth.explains(met.pair, met.middle)))
        met = met.take(np.flatnonzero(~_beside_curved(near, met)))
        pushes, clauses = _normals(near, met)
        every = pushes
        pushes, clauses = _unexplained(met, pushes, clauses, touching)
        patches = edge_contacts(search, edges, met, pushes)
        degenerate = _degenerate(near, met, clauses, every)
        rounds = _rounds(near, beside, reach)
    return NearContacts(
        patches=patches,
        degenerate=degenerate,
        unsupported=(*_listed(degenerate, search.geometry), *rounds.unsupported),
        possible=PossibleContacts.join([degenerate.pushes(), rounds.possible]),
    )


def _meetings(near: _Near, rows: Index, tolerance: Array) -> Meetings:
    """Where corners and edges of the pairs `rows` meet; `tolerance` of all pairs."""
    search, boxes = near.touching.search, near.touching.search.boxes
    found: list[Meetings] = []
    for some in np.array_split(rows, max(1, len(rows) // PAIRS)):
        a, b = near.pairs[some].T
        limit = tolerance[some]
        low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - limit[:, None]
        high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + limit[:, None]
        found += meetings(PairBlock(search, near.edges, some, limit, low, high))
    return Meetings.join(found)


def _normals(near: _Near, met: Meetings) -> tuple[Pushes, Clauses]:
    """Normals and clauses of meetings."""
    geometry = near.geometry
    parts = near.pairs[met.pair]
    size, blur = geometry.size[parts].min(axis=1), geometry.accuracy[parts].sum(axis=1)
    apart = np.linalg.norm(met.at[:, 1] - met.at[:, 0], axis=1)
    one_place = apart <= MEETS_EXACTLY * size + 8 * blur
    return normals_of(geometry, near.touching.search.facets, near.edges, met, one_place)


def _round_parts(geometry: Geometry) -> Mask:
    """Parts with a curved surface."""
    found: Mask = np.diff(geometry.surfaces.start) > 0
    return found


def _beside_curved(near: _Near, met: Meetings) -> Mask:
    """Meetings beside a curved surface: triangles do not tell what is sharp there."""
    geometry = near.geometry
    parts = near.pairs[met.pair]
    slack = near.gap[met.pair] + 2 * geometry.slack[parts].max(axis=1, initial=0.0)
    beside = np.zeros(len(met), dtype=bool)
    some = np.flatnonzero(_round_parts(geometry)[parts].any(axis=1))
    beside[some] = beside_curved(geometry, parts[some], met.middle[some], slack[some])
    return beside


def _meet(boxes: Boxes, a: Index, b: Index, grow: Array) -> Mask:
    """Pairs of parts whose boxes come within a distance."""
    apart = np.maximum(
        boxes.part_low[a] - boxes.part_high[b], boxes.part_low[b] - boxes.part_high[a]
    )
    return np.asarray(apart.max(axis=1) <= grow)


def _reach(touching: Touching, rejected: Iterable[Rejected]) -> Array:
    """How near edges and free forms of each pair are to a round face where they might touch it.

    A pair of which no face touches or comes near is looked at as far as loose data would take
    it for touching.
    """
    limits, search = touching.search.limits, touching.search
    known = {tuple(sorted(one.parts)) for one in rejected}
    told = [tuple(sorted(pair)) in known for pair in search.pairs.tolist()] if known else False
    size = search.geometry.size[search.pairs].min(axis=1)
    loose = np.where(touching.has_patch | told, 0.0, LOOSE_GAP * size)
    return np.asarray(np.maximum(limits.closed, loose))


def _rounds(near: _Near, rows: Index, reach: Array) -> RoundContacts:
    """What touches beside or on curved faces of the pairs `rows`.

    Triangles lie off their surfaces by up to the slack: rims are looked for as far away.
    """
    if not len(rows):
        return no_round_contacts()
    geometry = near.geometry
    met = _meetings(near, rows, reach + geometry.slack[near.pairs].sum(axis=1))
    met = met.take(np.flatnonzero(_beside_curved(near, met) & ~_clear(near, met, reach)))
    met = met.take(np.flatnonzero(~_settled(near, met)))
    pushes, clauses = _unexplained(met, *_normals(near, met), near.touching)
    on_rim = np.concatenate([pushes.meeting, clauses.meeting])
    rims = met.pair[on_rim], met.middle[on_rim]
    return round_contacts(near.touching, near.edges, rows, rims, reach)


def _clear(near: _Near, met: Meetings, reach: Array) -> Mask:
    """Meetings with round rims that as a whole stay clear of a plane, or of a rim of one axis."""
    geometry, facets = near.geometry, near.touching.search.facets
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


def _settled(near: _Near, met: Meetings) -> Mask:
    """Meetings where patches of the pair, as wide as the triangles lie off, say what touches."""
    geometry = near.geometry
    held = np.zeros(len(met), dtype=bool)
    for pair in np.unique(met.pair).tolist():
        mine = np.flatnonzero(met.pair == pair)
        slack = float(near.gap[pair] + 2 * geometry.slack[near.pairs[pair]].max())
        held[mine] = explained(near.touching, pair, met.middle[mine], slack)
    return held


def _unexplained(
    met: Meetings, pushes: Pushes, clauses: Clauses, touching: Touching
) -> tuple[Pushes, Clauses]:
    """Without what a planar patch of the pair already holds."""
    at = pushes.meeting
    held = on_patches(touching, met.pair[at], met.middle[at], pushes.normal)
    pushes = pushes.take(np.flatnonzero(~held))
    at = clauses.meeting[clauses.owner]
    met_by = on_patches(touching, met.pair[at], met.middle[at], clauses.normal)
    fulfilled = np.zeros(len(clauses.meeting), dtype=bool)
    fulfilled[clauses.owner[met_by]] = True
    return pushes, clauses.take(np.flatnonzero(~fulfilled))


def _degenerate(near: _Near, met: Meetings, clauses: Clauses, every: Pushes) -> Degenerate:
    some = np.zeros(len(near.pairs), dtype=bool)
    some[met.pair[clauses.meeting]] = True
    held = every.take(np.flatnonzero(some[met.pair[every.meeting]]))
    order = np.argsort(met.pair[clauses.meeting], kind="stable")
    clauses = clauses.take(order)
    part_a, part_b = near.pairs[met.pair[clauses.meeting]].T
    return Degenerate(
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


def _listed(points: Degenerate, geometry: Geometry) -> list[Unsupported]:
    """One entry a pair: a vertex where all points are one, else an edge."""
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
    kinds = np.where(spread > ONE_POINT * size, "edge", "vertex").tolist()
    parts = zip(points.part_a[first].tolist(), points.part_b[first].tolist(), strict=True)
    return [
        Unsupported(pair, kind, (x, y, z))
        for pair, kind, (x, y, z) in zip(parts, kinds, middle.tolist(), strict=True)
    ]
