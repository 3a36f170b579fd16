"""Curved faces that touch in ways without a formula: listed, and bounded, not guessed.

An edge or corner on a curved face (a ball on the rim of a hole), a rim on a flat face, free
forms, tori beside tori: such pairs are listed as unsupported. A frictionless sphere is pushed
through its centre, the side of a cylinder across its axis; of others any force and torque is
thought possible. Rims of flat faces are given as inscribed polygons, whose circumscribed ones
bound the answer from the other side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kilter.contact.broad import Boxes, joins
from kilter.contact.contact_set import PossibleContacts, Unsupported
from kilter.contact.curved import CurvedContacts, on_flat
from kilter.contact.edges import Edges, segment_distance
from kilter.contact.facets import Facets
from kilter.contact.patches import Patches
from kilter.contact.trim import covered
from kilter.geometry import Geometry
from kilter.rigid import cross
from kilter.surfaces import CONE, CYLINDER, FREE, SPHERE, TORUS, Surfaces

__all__ = ["RoundContacts", "beside_curved", "explained", "in_patch", "no_round_contacts", "rim_contacts", "round_contacts"]

Array = NDArray[np.float64]
Index = NDArray[np.int64]
Mask = NDArray[np.bool_]
_Force = tuple[int, int, Array, Array]

SHARP = 0.02
"""Faces that meet at less than this pass smoothly into each other [rad]."""
FACETED = 0.35
"""The same for faces known by their triangles only [rad]."""
HALVINGS = 60
"""Steps of the search for the point of an edge nearest to a round face."""
LEVEL = 1e-6
"""A face counts as lying across an axis up to this angle [rad]."""


@dataclass(frozen=True, slots=True, eq=False)
class RoundContacts:
    """Pairs that touch at a curved surface, and the forces that they could bring."""

    unsupported: tuple[Unsupported, ...]
    possible: PossibleContacts


def no_round_contacts() -> RoundContacts:
    """Nothing."""
    return RoundContacts((), _possible([], two_sided=True))


def beside_curved(geometry: Geometry, parts: Index, points: Array, slack: Array) -> Mask:
    """Points, shape (n, 3), within `slack` of a curved surface of one of their parts (n, 2)."""
    s = geometry.surfaces
    found = np.zeros(len(points), dtype=bool)
    for side in parts.T:
        count = np.diff(s.start)[side]
        owner = np.repeat(np.arange(len(side)), count)
        row = np.arange(len(owner)) + np.repeat(s.start[side] - (np.cumsum(count) - count), count)
        off = np.abs(s.distance(row, points[owner]))
        near = (off <= slack[owner]) | (s.kind[row] == FREE)
        found[owner[near]] = True
    return found


# what a patch explains ----------------------------------------------------------------


def explained(
    geometry: Geometry,
    curved: CurvedContacts,
    patches: Patches,
    pair: int,
    points: Array,
    slack: float,
) -> Mask:
    """Points, shape (n, 3), where patches of the pair say what touches."""
    held = np.zeros(len(points), dtype=bool)
    first, last = np.searchsorted(curved.pair, [pair, pair + 1])
    for patch in range(int(first), int(last)):
        held |= _on_curved(geometry, curved, patch, points, slack)
    first, last = np.searchsorted(patches.pair, [pair, pair + 1])
    for patch in range(int(first), int(last)):
        corners = patches.points[patches.start[patch] : patches.start[patch + 1]]
        held |= on_flat(points, corners, patches.normal[patch], slack)
    return held


def in_patch(
    geometry: Geometry, curved: CurvedContacts, pair: int, points: Array, slack: float
) -> Mask:
    """Points, shape (n, 3), on a curved face that touches all over."""
    held = np.zeros(len(points), dtype=bool)
    first, last = np.searchsorted(curved.pair, [pair, pair + 1])
    for patch in range(int(first), int(last)):
        if curved.area[patch] > 0:
            held |= _on_curved(geometry, curved, patch, points, slack)
    return held


def _on_curved(
    geometry: Geometry, curved: CurvedContacts, patch: int, points: Array, slack: float
) -> Mask:
    corners = curved.points[curved.start[patch] : curved.start[patch + 1]]
    zone = max(float(curved.zone[patch]), slack)
    if curved.area[patch] > 0:
        rows = np.full(len(points), curved.surface[patch].max())
        size = float(np.ptp(corners, axis=0).max())
        low, high = corners.min(axis=0) - 0.1 * size, corners.max(axis=0) + 0.1 * size
        near: Mask = np.abs(geometry.surfaces.distance(rows, points)) <= slack
        return near & ((points >= low) & (points <= high)).all(axis=1)
    if len(corners) > 2:  # a circle
        zone += 0.05 * float(np.ptp(corners, axis=0).max())
    following = np.roll(corners, -1, axis=0)
    step = following - corners
    t = np.einsum("nki,ki->nk", points[:, None] - corners, step)
    t = np.clip(t / np.maximum((step**2).sum(axis=1), 1e-300), 0, 1)
    foot = corners + t[..., None] * step
    beside: Mask = np.linalg.norm(points[:, None] - foot, axis=2).min(axis=1) <= zone
    return beside


# what touches without a formula -------------------------------------------------------


def round_contacts(
    geometry: Geometry,
    facets: Facets,
    boxes: Boxes,
    edges: Edges,
    pairs: Index,
    tolerance: Array,
    rows: Index,
    rims: tuple[Index, Array],
    curved: CurvedContacts,
    patches: Patches,
) -> RoundContacts:
    """Which of the pairs `rows` touch at a curved surface without a patch that says how.

    Parameters
    ----------
    edges : Edges
        Of all parts of these pairs.
    rims : (pair, point)
        Where corners and edges beside curved faces touch the other part.
    """
    found: dict[int, list[tuple[Array, int]]] = {}

    def note(pair: Index, point: Array, surface: Index) -> None:
        for name in np.unique(pair).tolist():
            mine = np.flatnonzero(pair == name)
            both = pairs[name]
            slack = float(tolerance[name] + 2 * geometry.slack[both].max())
            free = ~explained(geometry, curved, patches, name, point[mine], slack)
            found.setdefault(name, []).extend(
                (point[k], int(surface[k])) for k in mine[free]
            )

    note(rims[0], rims[1], np.full(len(rims[0]), -1))
    for turn in (False, True):
        note(*_edges_on_faces(geometry, facets, boxes, edges, pairs, tolerance, rows, curved, turn))
    chosen = curved.unknown[np.isin(curved.unknown[:, 0], rows)]
    for pair, i, j in chosen.tolist():
        point = _free_touch(geometry, facets, pairs[pair], (i, j), float(tolerance[pair]))
        note(np.full(len(point), pair), point, np.full(len(point), -1))
    return _listed(geometry, pairs, found)


def _listed(
    geometry: Geometry, pairs: Index, found: dict[int, list[tuple[Array, int]]]
) -> RoundContacts:
    unsupported = []
    forces: list[_Force] = []
    for pair in sorted(found):
        if not found[pair]:
            continue
        a, b = (int(k) for k in pairs[pair])
        point, _ = found[pair][0]
        x, y, z = point.tolist()
        unsupported.append(Unsupported((a, b), "curved", (x, y, z)))
        surfaces = {surface for _, surface in found[pair]}
        if all(geometry.surfaces.kind[k] in (SPHERE, CYLINDER) for k in surfaces if k >= 0) and (
            min(surfaces) >= 0
        ):
            held = [force for k in sorted(surfaces) for force in _forces(geometry, k)]
        else:
            held = _any_wrench(point, float(geometry.radius[[a, b]].min()))
        forces.extend((a, b, at, normal) for at, normal in held)
    return RoundContacts(tuple(unsupported), _possible(forces, two_sided=True))


def _any_wrench(point: Array, arm: float) -> list[tuple[Array, Array]]:
    """Points and directions of forces that add up to any force and torque."""
    x, y, z = np.eye(3)
    at = [(point, x), (point, y), (point, z)]
    return [*at, (point + arm * x, y), (point + arm * x, z), (point + arm * y, z)]


def _possible(forces: list[_Force], *, two_sided: bool) -> PossibleContacts:
    count = len(forces)
    return PossibleContacts(
        part_a=np.array([a for a, _, _, _ in forces], dtype=np.int64),
        part_b=np.array([b for _, b, _, _ in forces], dtype=np.int64),
        points=np.array([point for _, _, point, _ in forces]).reshape(count, 3),
        normals=np.array([normal for _, _, _, normal in forces]).reshape(count, 3),
        two_sided=np.full(count, two_sided),
        mu=np.zeros(count),
    )


def _forces(geometry: Geometry, surface: int) -> list[tuple[Array, Array]]:
    """Points and directions of all forces that a sphere or cylinder can take, both senses."""
    s = geometry.surfaces
    center, axis = s.point[surface], s.axis[surface]
    if s.kind[surface] == SPHERE:
        return [(center, direction) for direction in np.eye(3)]
    u = cross(np.eye(3)[np.abs(axis).argmin()], axis)
    u /= np.linalg.norm(u)
    corners = geometry.vertices[geometry.triangles[s.triangles_of(surface)]].reshape(-1, 3)
    along = (corners - center) @ axis
    ends = (center + along.min() * axis, center + along.max() * axis)
    return [(end, d) for end in ends for d in (u, cross(axis, u))]


# edges on curved faces ----------------------------------------------------------------


def _edges_on_faces(
    geometry: Geometry,
    facets: Facets,
    boxes: Boxes,
    edges: Edges,
    pairs: Index,
    tolerance: Array,
    rows: Index,
    curved: CurvedContacts,
    turn: bool,
) -> tuple[Index, Array, Index]:
    """Where sharp edges of b (of a, if `turn`) touch curved faces of the other part."""
    s = geometry.surfaces
    a, b = pairs[rows].T[::-1] if turn else pairs[rows].T
    slack = geometry.slack[b]
    grow = tolerance[rows] + slack
    count = np.diff(s.start)[a]
    owner = np.repeat(np.arange(len(rows)), count)
    face = np.arange(len(owner)) + np.repeat(s.start[a] - (np.cumsum(count) - count), count)
    keep = (s.kind[face] != FREE) & (np.diff(s.triangle_start)[face] > 0)
    owner, face = owner[keep], face[keep]
    low, high = _face_boxes(geometry, boxes, face)
    margin = (grow + geometry.slack[a])[:, None]
    box = np.maximum(boxes.part_low[a], boxes.part_low[b]) - margin, np.minimum(
        boxes.part_high[a], boxes.part_high[b]
    ) + margin
    owner_e, edge = edges.inside(geometry, boxes, b, box)
    sharp = _sharp(geometry, facets, edges, edge)
    owner_e, edge = owner_e[sharp], edge[sharp]
    box_e = edges.boxes(geometry, boxes.frame, edge)
    found = [(np.empty(0, np.int64), np.empty((0, 3)), np.empty(0, np.int64))]
    for k, x, y in joins(owner, (low, high), owner_e, box_e, margin[:, 0]):
        surface, line = face[x], edge[y]
        p, q = edges.ends(geometry, line)
        limit = grow[k] + s.doubt[surface]
        there = ~_on_patch(curved, rows[k], surface, s, p, q, limit)
        k, surface, p, q, limit = k[there], surface[there], p[there], q[there], limit[there]
        point, off = _nearest(s, surface, p, q, limit)
        near = np.flatnonzero(np.abs(off) <= limit)
        near = near[_on_face(geometry, surface[near], point[near], limit[near])]
        found.append((rows[k[near]], point[near], surface[near]))
    pair, points, surfaces = (np.concatenate([f[k] for f in found]) for k in range(3))
    return pair, points, surfaces


def _face_boxes(geometry: Geometry, boxes: Boxes, face: Index) -> tuple[Array, Array]:
    s = geometry.surfaces
    used, place = np.unique(face, return_inverse=True)
    low, high = np.empty((len(used), 3)), np.empty((len(used), 3))
    for k, row in enumerate(used.tolist()):
        points = geometry.vertices[geometry.triangles[s.triangles_of(row)]] @ boxes.frame.T
        low[k] = points.min(axis=(0, 1)) - s.sagitta[row]
        high[k] = points.max(axis=(0, 1)) + s.sagitta[row]
    return low[place], high[place]


def _sharp(geometry: Geometry, facets: Facets, edges: Edges, edge: Index) -> Mask:
    """Edges at which two faces meet at an angle, as the exact surfaces tell it."""
    s = geometry.surfaces
    one, other = edges.facet[edge].T
    middle = geometry.vertices[edges.ends_of[edge, 0]]
    normals, exact = [], np.ones(len(edge), dtype=bool)
    for facet in (one, other):
        surface = facets.surface[facet]
        free = (surface >= 0) & (s.kind[surface] == FREE) if len(s) else surface >= 0
        known = (surface >= 0) & ~free
        normal = facets.normal[facet].copy()
        normal[known] = s.outward(surface[known], middle[known])
        normals.append(normal)
        exact &= ~free
    sine = np.linalg.norm(cross(*normals), axis=1)
    bend = np.arctan2(sine, np.einsum("ij,ij->i", *normals))
    alone = (one < 0) | (other < 0)
    inner = (facets.surface[one] == facets.surface[other]) & (facets.surface[one] >= 0)
    sharp: Mask = alone | (~inner & (bend > np.where(exact, SHARP, FACETED)))
    return sharp


def _on_patch(
    curved: CurvedContacts, pair: Index, surface: Index, s: Surfaces, p: Array, q: Array,
    limit: Array,
) -> Mask:  # fmt: skip
    """Edges both of whose ends lie on a surface that has a patch of contact in the pair."""
    area = curved.area > 0
    names = np.unique(
        np.concatenate([np.column_stack([curved.pair, side])[area] for side in curved.surface.T]),
        axis=0,
    )
    if not len(names):
        return np.zeros(len(pair), dtype=bool)
    big = len(s) + 1
    has = np.isin(pair * big + surface, names[:, 0] * big + names[:, 1])
    held: Mask = has & (np.abs(s.distance(surface, p)) <= limit)
    return held & (np.abs(s.distance(surface, q)) <= limit)


def _nearest(s: Surfaces, face: Index, p: Array, q: Array, limit: Array) -> tuple[Array, Array]:
    """Point of each edge that is nearest to a face, and its signed distance.

    The distance from a solid cylinder, sphere or cone is convex along an edge; to a hollow
    one an edge comes nearest at its ends.
    """
    at_p, at_q = s.distance(face, p), s.distance(face, q)
    best = np.where((at_p <= at_q)[:, None], p, q)
    off = np.minimum(at_p, at_q)
    length = np.linalg.norm(q - p, axis=1)
    inner = ~s.hollow[face] & ((at_p + at_q - length) / 2 <= limit)
    rows = np.flatnonzero(inner)
    torus = s.kind[face[rows]] == TORUS
    for part in range(8):
        some = rows if part == 0 else rows[torus]
        low = np.full(len(some), part / 8.0)
        high = np.where(s.kind[face[some]] == TORUS, (part + 1) / 8.0, 1.0)
        for _ in range(HALVINGS):
            third = (high - low) / 3
            one, other = (
                s.distance(face[some], p[some] + t[:, None] * (q[some] - p[some]))
                for t in (low + third, high - third)
            )
            left = one <= other
            low, high = np.where(left, low, low + third), np.where(left, high - third, high)
        point = p[some] + ((low + high) / 2)[:, None] * (q[some] - p[some])
        value = s.distance(face[some], point)
        better = value < off[some]
        best[some[better]], off[some[better]] = point[better], value[better]
    return best, off


def _on_face(geometry: Geometry, face: Index, point: Array, limit: Array) -> Mask:
    """Whether faces reach to points on their surfaces."""
    s = geometry.surfaces
    held = np.zeros(len(face), dtype=bool)
    normal = s.outward(face, point) if len(face) else point
    for row in np.unique(face).tolist():
        mine = np.flatnonzero(face == row)
        grow = float(limit[mine].max())
        triangles = geometry.vertices[geometry.triangles[s.triangles_of(row)]]
        reach = float(s.sagitta[row]) + grow
        held[mine] = covered(triangles, point[mine], normal[mine], reach, grow)
    return held


# free forms ---------------------------------------------------------------------------


def _free_touch(
    geometry: Geometry, facets: Facets, parts: Index, names: tuple[int, int], tolerance: float
) -> Array:
    """Points where triangles of two faces come within tolerance and both sagittas, (n, 3)."""
    s = geometry.surfaces
    sides = []
    for part, name in zip(parts.tolist(), names, strict=True):
        if name >= 0:
            chosen = s.triangles_of(name)
        else:
            span = np.arange(geometry.triangle_start[part], geometry.triangle_start[part + 1])
            chosen = span[geometry.triangle_surface[span] < 0]
        sides.append(geometry.vertices[geometry.triangles[chosen]])
    grow = tolerance + float(sum(s.sagitta[k] for k in names if k >= 0))
    boxes = [(side.min(axis=1), side.max(axis=1)) for side in sides]
    owners = [np.zeros(len(side), dtype=np.int64) for side in sides]
    found = [np.empty((0, 3))]
    for _, i, j in joins(owners[0], boxes[0], owners[1], boxes[1], np.array([grow])):
        off, point = _triangles_apart(sides[0][i], sides[1][j])
        found.append(point[off <= grow])
    return np.concatenate(found)


def _triangles_apart(one: Array, other: Array) -> tuple[Array, Array]:
    """Distance of triangles, shape (n, 3, 3), and a point between them; 0 where they cross."""
    off, best = np.full(len(one), np.inf), one[:, 0].copy()

    def better(value: Array, point: Array) -> None:
        use = value < off
        off[use], best[use] = value[use], point[use]

    for mine, its in ((one, other), (other, one)):
        normal = cross(its[:, 1] - its[:, 0], its[:, 2] - its[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        for k in range(3):
            p, q = mine[:, k], mine[:, (k + 1) % 3]
            for start, end in ((p, p), (p, q)):
                height = [np.einsum("ij,ij->i", x - its[:, 0], normal) for x in (start, end)]
                apart = height[0] - height[1]
                t = np.where(apart != 0, height[0] / np.where(apart != 0, apart, 1.0), 0.0)
                crossing = (t >= 0) & (t <= 1)
                at = start + np.where(crossing, t, 0.0)[:, None] * (end - start)
                up = np.einsum("ij,ij->i", at - its[:, 0], normal)
                foot = at - up[:, None] * normal
                inside = np.ones(len(at), dtype=bool)
                for m in range(3):
                    edge = its[:, (m + 1) % 3] - its[:, m]
                    inside &= np.einsum("ij,ij->i", cross(edge, foot - its[:, m]), normal) >= 0
                better(np.where(inside, np.abs(up), np.inf), (at + foot) / 2)
            for m in range(3):
                value, point = segment_distance(p, q, its[:, m], its[:, (m + 1) % 3])
                better(value, point)
    return off, best


# rims of flat faces -------------------------------------------------------------------


def rim_contacts(
    geometry: Geometry, parts: Index, normals: Array, start: Index, points: Array
) -> PossibleContacts:
    """Corners of the circumscribed polygon where a flat patch ends at the rim of a round face.

    Parameters
    ----------
    parts : ndarray of int, shape (P, 2)
        Parts of each patch, with their `normals` (P, 3) and `points` by `start`.
    """
    s = geometry.surfaces
    forces: list[_Force] = []
    round_part = np.diff(s.start) > 0
    for patch in np.flatnonzero(round_part[parts].any(axis=1)):
        a, b = (int(k) for k in parts[patch])
        corners = points[start[patch] : start[patch + 1]]
        for part in (a, b):
            for surface in range(int(s.start[part]), int(s.start[part + 1])):
                rim = _rim(s, surface, normals[patch], corners)
                if rim is None:
                    continue
                out, stretch = rim
                forces.extend(
                    (a, b, point + (stretch - 1) * away, normals[patch])
                    for point, away in zip(corners, out, strict=True)
                    if away.any()
                )
    return _possible(forces, two_sided=False)


def _rim(s: Surfaces, surface: int, normal: Array, corners: Array) -> tuple[Array, float] | None:
    """From the centre of the rim to corners on it (else 0), and how far the circle reaches."""
    kind, axis, center = int(s.kind[surface]), s.axis[surface], s.point[surface]
    if kind == SPHERE:
        axis = normal
    if kind == FREE or s.hollow[surface] or abs(float(axis @ normal)) < 1 - LEVEL:
        return None
    height = float((corners[0] - center) @ axis)
    radius = _radius_at(s, surface, height)
    if radius is None:
        return None
    out = corners - center
    out = out - np.outer(out @ axis, axis)
    sagitta = min(float(s.sagitta[surface]), radius / 2)
    off = radius - np.linalg.norm(out, axis=1)
    rim = (off <= sagitta + 1e-6 * radius) & (off >= -1e-6 * radius)
    if not rim.any() or sagitta <= 0:
        return None
    return np.where(rim[:, None], out, 0.0), radius / (radius - sagitta)


def _radius_at(s: Surfaces, surface: int, height: float) -> float | None:
    """Radius of the circle that a plane across the axis cuts out of a surface."""
    kind, radius = int(s.kind[surface]), float(s.radius[surface])
    if kind == CYLINDER:
        return radius
    if kind == CONE:
        cut = height * float(np.tan(s.half_angle[surface]))
    elif kind == SPHERE:
        cut = float(np.sqrt(max(radius**2 - height**2, 0.0)))
    else:
        tube = float(s.tube[surface])
        near = abs(height) <= tube * (1 + LEVEL)
        cut = radius + float(np.sqrt(max(tube**2 - height**2, 0.0))) if near else 0.0
    return cut if cut > 0 else None
