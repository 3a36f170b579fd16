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

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, cross
from kilter.assembly.geometry import Geometry
from kilter.contact.broad import Boxes
from kilter.contact.contact_set import Degenerate, PossibleContacts, Unsupported
from kilter.contact.curved.curved_patches import CurvedContacts
from kilter.contact.curved.rims import coaxial_clear, rims_clear
from kilter.contact.curved.unmodelled import (
    RoundContacts,
    beside_curved,
    explained,
    no_round_contacts,
    round_contacts,
)
from kilter.contact.patches import Patches
from kilter.contact.planar.facets import Facets
from kilter.contact.sharp.edge_contacts import Touches, no_touches, touches
from kilter.contact.sharp.edges import Edges, find_edges, ragged
from kilter.contact.sharp.feature_pairs import EDGE, FACE, Block, Meetings, meetings, no_meetings
from kilter.contact.sharp.normals import SNAP, Clauses, Pushes, normals_of

__all__ = ["NearContacts", "Touching", "near_contacts"]


PAIRS = 20_000
"""Pairs looked at in one go, so that their candidates fit in memory."""
ONE_PLACE = 1e-10
"""Features closer than this part of the size of a part meet exactly."""


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
    """Contacts at edges and corners; what is not modelled, and the forces it could bring.

    The first rows of `possible` are the normals of `degenerate`, in order.
    """

    touches: Touches
    degenerate: Degenerate
    unsupported: tuple[Unsupported, ...]
    possible: PossibleContacts


@dataclass(frozen=True, slots=True, eq=False)
class _Scene:
    """What all steps need; `edges` of all parts that are looked at."""

    geometry: Geometry
    facets: Facets
    boxes: Boxes
    touching: Touching
    edges: Edges


def near_contacts(
    geometry: Geometry, facets: Facets, boxes: Boxes, touching: Touching
) -> NearContacts:
    """Corner, edge and round contacts of the pairs that patches do not settle."""
    a, b = touching.pairs.T
    settled = facets.convex_part[a] & facets.convex_part[b] & touching.has_patch
    grow = touching.tolerance[:, None]
    meets = (boxes.part_low[a] <= boxes.part_high[b] + grow).all(axis=1)
    meets &= (boxes.part_low[b] <= boxes.part_high[a] + grow).all(axis=1)
    rows = np.flatnonzero(meets & ~settled)
    made, degenerate, rounds = no_touches(), Degenerate.none(), no_round_contacts()
    if len(rows):
        scene = _Scene(
            geometry,
            facets,
            boxes,
            touching,
            find_edges(geometry, facets, np.unique(touching.pairs[rows])),
        )
        met = _meetings(scene, rows, touching.tolerance)
        met = met.take(np.flatnonzero(~_beside_curved(scene, met)))
        pushes, clauses = _normals(scene, met)
        every = pushes
        pushes, clauses = _unexplained(met, pushes, clauses, touching)
        made = touches(geometry, facets, scene.edges, met, pushes)
        degenerate = _degenerate(touching, met, clauses, every)
        rounds = _rounds(scene, rows)
    return NearContacts(
        touches=made,
        degenerate=degenerate,
        unsupported=(*_listed(degenerate, geometry), *rounds.unsupported),
        possible=PossibleContacts.join([degenerate.pushes(), rounds.possible]),
    )


def _meetings(scene: _Scene, rows: Index, tolerance: Array) -> Meetings:
    """Where corners and edges of the pairs `rows` meet; `tolerance` of all pairs."""
    geometry, boxes = scene.geometry, scene.boxes
    found = [no_meetings()]
    for some in np.array_split(rows, max(1, len(rows) // PAIRS)):
        a, b = scene.touching.pairs[some].T
        grow = tolerance[some][:, None]
        low = np.maximum(boxes.part_low[a], boxes.part_low[b]) - grow
        high = np.minimum(boxes.part_high[a], boxes.part_high[b]) + grow
        limit = tolerance[some]
        block = Block(geometry, scene.facets, boxes, scene.edges, some, a, b, limit, low, high)
        found += meetings(block)
    names = Meetings.__slots__
    return Meetings(*(np.concatenate([getattr(f, name) for f in found]) for name in names))


def _normals(scene: _Scene, met: Meetings) -> tuple[Pushes, Clauses]:
    """Normals and clauses of meetings."""
    geometry = scene.geometry
    parts = scene.touching.pairs[met.pair]
    size, blur = geometry.size[parts].min(axis=1), geometry.accuracy[parts].sum(axis=1)
    apart = np.linalg.norm(met.at[:, 1] - met.at[:, 0], axis=1)
    one_place = apart <= ONE_PLACE * size + 8 * blur
    return normals_of(geometry, scene.facets, scene.edges, met, one_place)


def _round_parts(geometry: Geometry) -> Mask:
    """Parts with a curved surface."""
    found: Mask = np.diff(geometry.surfaces.start) > 0
    return found


def _beside_curved(scene: _Scene, met: Meetings) -> Mask:
    """Meetings beside a curved surface: triangles do not tell what is sharp there."""
    geometry, touching = scene.geometry, scene.touching
    parts = touching.pairs[met.pair]
    slack = touching.tolerance[met.pair] + 2 * geometry.slack[parts].max(axis=1, initial=0.0)
    beside = np.zeros(len(met), dtype=bool)
    some = np.flatnonzero(_round_parts(geometry)[parts].any(axis=1))
    beside[some] = beside_curved(geometry, parts[some], met.middle[some], slack[some])
    return beside


def _rounds(scene: _Scene, rows: Index) -> RoundContacts:
    """What touches beside or on curved faces of the pairs `rows`.

    Triangles lie off their surfaces by up to the slack: rims are looked for as far away.
    """
    geometry, touching = scene.geometry, scene.touching
    rows = rows[_round_parts(geometry)[touching.pairs[rows]].any(axis=1)]
    if not len(rows):
        return no_round_contacts()
    met = _meetings(scene, rows, touching.tolerance + geometry.slack[touching.pairs].sum(axis=1))
    met = met.take(np.flatnonzero(_beside_curved(scene, met) & ~_clear(scene, met)))
    met = met.take(np.flatnonzero(~_settled(scene, met)))
    pushes, clauses = _unexplained(met, *_normals(scene, met), touching)
    on_rim = np.concatenate([pushes.meeting, clauses.meeting])
    return round_contacts(
        geometry,
        scene.facets,
        scene.boxes,
        scene.edges,
        touching.pairs,
        touching.tolerance,
        rows,
        (met.pair[on_rim], met.middle[on_rim]),
        touching.curved,
        touching.patches,
    )


def _clear(scene: _Scene, met: Meetings) -> Mask:
    """Meetings with round rims that as a whole stay clear of a plane, or of a rim of one axis."""
    geometry, facets = scene.geometry, scene.facets
    limit = scene.touching.tolerance[met.pair]
    clear = np.zeros(len(met), dtype=bool)
    ends = np.stack([met.feature, met.feature], axis=2)
    edge = met.kind == EDGE
    ends[edge] = scene.edges.ends_of[met.feature[edge]]
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


def _settled(scene: _Scene, met: Meetings) -> Mask:
    """Meetings where patches of the pair, as wide as the triangles lie off, say what touches."""
    geometry, touching = scene.geometry, scene.touching
    held = np.zeros(len(met), dtype=bool)
    for pair in np.unique(met.pair).tolist():
        mine = np.flatnonzero(met.pair == pair)
        slack = float(touching.tolerance[pair] + 2 * geometry.slack[touching.pairs[pair]].max())
        held[mine] = explained(
            geometry, touching.curved, touching.patches, pair, met.middle[mine], slack
        )
    return held


def _unexplained(
    met: Meetings, pushes: Pushes, clauses: Clauses, touching: Touching
) -> tuple[Pushes, Clauses]:
    """Without what a planar patch of the pair already holds."""
    held = _on_patches(met, pushes.meeting, pushes.normal, touching)
    pushes = pushes.take(np.flatnonzero(~held))
    met_by = _on_patches(met, clauses.meeting[clauses.owner], clauses.normal, touching)
    fulfilled = np.zeros(len(clauses.meeting), dtype=bool)
    fulfilled[clauses.owner[met_by]] = True
    return pushes, clauses.take(np.flatnonzero(~fulfilled))


def _on_patches(met: Meetings, rows: Index, normal: Array, touching: Touching) -> Mask:
    """Which points with a normal lie on a patch of their pair with that normal."""
    patches = touching.patches
    start = np.searchsorted(patches.pair, np.arange(len(touching.pairs) + 1))
    owner, patch = ragged(start, met.pair[rows])
    near = np.linalg.norm(patches.normal[patch] - normal[owner], axis=1) <= SNAP
    owner, patch = owner[near], patch[near]
    which, corner = ragged(patches.start, patch)
    following = corner + 1
    last = following == patches.start[patch + 1][which]
    following[last] = patches.start[patch][which[last]]
    tolerance = 2 * touching.tolerance[patches.pair[patch]]
    p = met.middle[rows[owner]]
    level = (p - patches.points[patches.start[patch]]) * patches.normal[patch]
    inside = np.abs(level.sum(axis=1)) <= tolerance + np.abs(patches.gap[patch]).max(axis=1)
    along = patches.points[following] - patches.points[corner]
    length = np.maximum(np.linalg.norm(along, axis=1), np.finfo(float).tiny)
    arm = cross(along, p[which] - patches.points[corner]) / length[:, None]
    side = np.einsum("ij,ij->i", arm, patches.normal[patch][which])
    # corners may turn either way: within the hull all sides have one sign
    outside = np.zeros((len(patch), 2), dtype=bool)
    for k, sign in enumerate((1.0, -1.0)):
        outside[which[sign * side < -tolerance[which]], k] = True
    held = np.zeros(len(rows), dtype=bool)
    held[owner[inside & ~outside.all(axis=1)]] = True
    return held


def _degenerate(touching: Touching, met: Meetings, clauses: Clauses, every: Pushes) -> Degenerate:
    some = np.zeros(len(touching.pairs), dtype=bool)
    some[met.pair[clauses.meeting]] = True
    held = every.take(np.flatnonzero(some[met.pair[every.meeting]]))
    order = np.argsort(met.pair[clauses.meeting], kind="stable")
    clauses = clauses.take(order)
    part_a, part_b = touching.pairs[met.pair[clauses.meeting]].T
    return Degenerate(
        part_a=part_a,
        part_b=part_b,
        points=met.middle[clauses.meeting],
        start=clauses.start,
        normals=clauses.normal,
        exact=clauses.exact,
        held_parts=touching.pairs[met.pair[held.meeting]],
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
    kinds = np.where(spread > LONG * size, "edge", "vertex").tolist()
    parts = zip(points.part_a[first].tolist(), points.part_b[first].tolist(), strict=True)
    return [
        Unsupported(pair, kind, (x, y, z))
        for pair, kind, (x, y, z) in zip(parts, kinds, middle.tolist(), strict=True)
    ]


LONG = 4e-5
"""Degenerate points of a pair further apart than this part of its size are an edge."""
