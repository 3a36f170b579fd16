"""Contacts of exact edges and corners with curved faces, and beside curved faces.

The curve of an edge (`kilter.contact.common.edges`) touches a face at a point at which its
distance d from the face is least: n . t changes its sign from - to +, with the tangent t of the
curve and the normal n of the face. The material of the edge must lie in front of the tangent plane
of the face there; otherwise the nearest point lies inside a face beside the edge, and is another
contact. A corner touches a face if all its edges leave the face. Two curves that cross have the
normal of both tangents. A straight edge on a generator, or on a plane, touches along a line; a
round edge about the axis of the face touches along a circle.

These contacts have a single normal. At the following points the admissible motions are a union, or
the contact is not a point; they are listed as unresolved:

- a corner or edge that touches a face at an edge of that face; a corner on an edge or corner
- two edges that run along each other
- a curved edge that lies on a face along an arc that is no circle about the axis of the face
- an edge that passes through a face
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, across, cross, ratio
from kilter.assembly.surfaces import KINDS, SPHERE
from kilter.contact.common.edges import CurvePoints, EdgeCurves, face_distance
from kilter.contact.common.findings import FacePatches
from kilter.contact.contact_tolerances import (
    ARC_LEVEL,
    ARC_SLOPE,
    CONE_ANGLE,
    SEAM_ANGLE,
    SLOPE_ROUNDING,
    STRAIGHT_EDGE,
)
from kilter.contact.curved.contact_points import TURN, ring, slices
from kilter.contact.sharp.edges_on_curves import explained_points
from kilter.contact.sharp.edges_with_edges import (
    EdgeContact,
    EdgeSearch,
    EdgeTouching,
    corner_rays,
    is_corner,
)

_CircleKey = tuple[int, int, int, int, int, int]
"""Circle of contact: row of the pair, whether its edges belong to part a, surface and flat facet of
the face, and height and radius as multiples of a length."""

HALVINGS = 40
"""Largest number of steps that locate the point of an edge that is nearest to a face."""
ROOT_HALVINGS = 20
"""Bisection steps that locate the point at which an edge passes through a face."""


@dataclass(frozen=True, slots=True, eq=False)
class EdgeFacePairs(Rows):
    """Pairs of an exact edge of one part and an exact face of another part."""

    pair: Index
    """Row of the pair of parts, shape (n,)."""
    turned: Mask
    """True if the edge belongs to part a, shape (n,)."""
    edge: Index
    surface: Index
    facet: Index
    """The edge, shape (n,); the curved surface, or -1; the flat facet if `surface` is -1, else
    any facet."""


def edge_contacts_on_faces(
    face_patches: FacePatches, curves: EdgeCurves, pairs: EdgeFacePairs, reach: Array,
    found: EdgeTouching,
) -> None:  # fmt: skip
    """Add the contacts of edges and corners with faces to `found`.

    `pairs`: edges that come near faces; all exact. `reach`, shape (number of pairs of parts,):
    largest gap at which parts touch, or may touch [length unit].
    """
    if not len(pairs.pair):
        return
    state = EdgeSearch(face_patches.search, curves, reach, found)
    _edges_on_faces(face_patches, state, pairs)
    _corners_on_faces(state, pairs)


def _edges_on_faces(face_patches: FacePatches, state: EdgeSearch, pairs: EdgeFacePairs) -> None:
    """Contacts inside edges: the nearest points of curves, and lines."""
    curves, geometry, facets = state.curves, state.search.geometry, state.search.facets
    share = np.zeros(len(pairs.edge))
    begin, middle, end = (curves.points(pairs.edge, share + t) for t in (0.0, 0.5, 1.0))
    values = [
        face_distance(geometry, facets, pairs.surface, pairs.facet, x.at)
        for x in (begin, middle, end)
    ]
    distance = np.column_stack([value[0] for value in values])
    first, last = (
        np.einsum("ij,ij->i", x.along, value[1])
        for x, value in ((begin, values[0]), (end, values[2]))
    )
    p, q = curves.edges.ends(geometry, pairs.edge)
    length = np.linalg.norm(q - p, axis=1)
    reach = state.reach[pairs.pair]
    near = np.abs(distance).min(axis=1) <= reach + length
    steepest = np.maximum(np.abs(first), np.abs(last))
    limit = state.search.limits.gap[pairs.pair]
    along = (steepest <= ARC_LEVEL) & (np.abs(distance).max(axis=1) <= limit)
    bent = (np.abs(last - first) > ARC_SLOPE) & ~along
    nearest = np.flatnonzero(near & bent & (first < 0) & (last >= 0))
    _nearest_points(state, pairs.take(nearest))
    straight = np.linalg.norm(middle.at - (p + q) / 2, axis=1) <= STRAIGHT_EDGE * length
    straight &= np.linalg.norm(values[0][1] - values[2][1], axis=1) <= STRAIGHT_EDGE
    level = steepest <= np.sin(state.search.angle)
    level &= np.abs(distance).min(axis=1) <= reach
    for k in np.flatnonzero(straight & level):
        ends = (p[k], q[k]), (begin.left[k], begin.right[k])
        _line_on_face(state, pairs.take(np.array([k])), ends, middle.along[k], values[1][1][k])
    arcs = np.flatnonzero(level & ~straight & ~bent)
    _arcs_on_faces(state, pairs.take(arcs), (begin.take(arcs), middle.take(arcs), end.take(arcs)))
    pierces = (distance.min(axis=1) < -limit) & (distance.max(axis=1) > limit)
    _pierced_faces(face_patches, state, pairs.take(np.flatnonzero(pierces & (pairs.surface >= 0))))


def _arcs_on_faces(
    state: EdgeSearch, pairs: EdgeFacePairs, at: tuple[CurvePoints, CurvePoints, CurvePoints]
) -> None:
    """Contacts of curved edges that lie on faces: circles about a common axis.

    `at` are the beginnings, middles and ends of the edges. Other arcs, and edges that leave the
    face, are unresolved.
    """
    geometry, facets = state.search.geometry, state.search.facets
    values = [face_distance(geometry, facets, pairs.surface, pairs.facet, x.at) for x in at]
    in_front = np.all(
        [x.behind(-normal) for x, (_, normal) in zip(at, values, strict=True)], axis=0
    )
    circles: dict[_CircleKey, list[int]] = {}
    lines: dict[_CircleKey, tuple[Array, Array]] = {}
    covers_each = _covered_samples(state, pairs, at, [normal for _, normal in values])
    for k in np.flatnonzero(covers_each.any(axis=1)).tolist():
        pair, face = int(pairs.pair[k]), (int(pairs.surface[k]), int(pairs.facet[k]))
        covers = covers_each[k]
        axis = _common_axis(state, face, int(pairs.edge[k]))
        if axis is None or not covers.all() or not in_front[k]:
            # the middle first: an end may be a point at which the face ends
            chosen = 1 if covers[1] else int(covers.argmax())
            state.found.unresolved.append((pair, at[chosen].at[k]))
            continue
        points = np.array([x.at[k] for x in at]) - axis[0]
        height = points @ axis[1]
        radius = np.linalg.norm(points - np.outer(height, axis[1]), axis=1)
        limit = state.limit(pair)
        if np.ptp(height) > limit or np.ptp(radius) > limit:
            state.found.unresolved.append((pair, at[1].at[k]))
            continue
        place = round(height[1] / (4 * limit)), round(radius[1] / (4 * limit))
        key = pair, int(pairs.turned[k]), *face, *place
        circles.setdefault(key, []).append(k)
        lines[key] = axis
    for key, rows in circles.items():
        points = np.array([[x.at[k] for x in (at[0], at[2])] for k in rows])
        gaps = np.array([values[1][0][k] for k in rows])
        _circle(state, key, lines[key], points, gaps, values[1][1][rows[0]], at[1].at[rows[0]])


def _covered_samples(
    state: EdgeSearch, pairs: EdgeFacePairs, at: Sequence[CurvePoints], normals: list[Array]
) -> Mask:
    """Mask of the samples of edges to which the faces extend, shape (n, number of samples)."""
    result = np.zeros((len(pairs.edge), len(at)), dtype=bool)
    names = np.column_stack([pairs.pair, pairs.surface, pairs.facet])
    for name in np.unique(names, axis=0):
        rows = np.flatnonzero((names == name).all(axis=1))
        points = np.concatenate([x.at[rows] for x in at])
        outward = np.concatenate([normal[rows] for normal in normals])
        pair, surface, facet = (int(x) for x in name)
        covers = state.covers((surface, facet), points, outward, pair)
        result[rows] = covers.reshape(len(at), len(rows)).T
    return result


def _common_axis(state: EdgeSearch, face: tuple[int, int], edge: int) -> tuple[Array, Array] | None:
    """A point and the direction of the axis of an edge that is a circle about the axis of a face.

    None if the face or the faces beside the edge have no axis.
    """
    s, facets = state.search.geometry.surfaces, state.search.facets
    surface, facet = face
    if surface >= 0 and s.kind[surface] != SPHERE:
        return s.point[surface], s.axis[surface]
    sides = state.curves.edges.facet[edge]
    beside = facets.surface[sides]
    round_ = beside[(beside >= 0) & (s.kind[beside] != SPHERE)]
    flat = sides[beside < 0]
    direction = facets.normal[facet]
    if surface >= 0:
        if not len(round_) and not len(flat):
            return None
        direction = s.axis[round_[0]] if len(round_) else facets.normal[flat[0]]
        return s.point[surface], direction
    if not (beside >= 0).any():
        return None
    center = round_[0] if len(round_) else beside[beside >= 0][0]
    return s.point[center], direction


def _circle(
    state: EdgeSearch, key: _CircleKey, axis: tuple[Array, Array], ends: Array, gaps: Array,
    normal: Array, point: Array,
) -> None:  # fmt: skip
    """Add the contact along arcs of a circle.

    `ends`, shape (n, 2, 3): ends of the edges that make up the arcs. `gaps`, shape (n,): gaps at
    the middles of these edges [length unit].
    """
    pair, turned, surface = key[:3]
    sense = -1.0 if turned else 1.0
    origin, direction = axis
    offset = point - origin
    height = float(offset @ direction)
    away = offset - height * direction
    radius = float(np.linalg.norm(away))
    lean = float(normal @ away) / radius, float(normal @ direction)
    middle = radius - gaps.mean() / 2 * lean[0]
    center = origin + (height - gaps.mean() / 2 * lean[1]) * direction
    u, v = across(direction)
    angle = np.arctan2((ends - origin) @ v, (ends - origin) @ u)
    turn = np.remainder(angle[:, 1] - angle[:, 0] + np.pi, 2 * np.pi) - np.pi
    begin = np.where(turn >= 0, angle[:, 0], angle[:, 1])
    spots = ring(center, direction, middle, (sense * lean[0], sense * lean[1]),
                 _joined_arcs(begin, np.abs(turn)))  # fmt: skip
    if not state.is_near(pair, float(np.abs(gaps).min())):
        state.found.unresolved.append((pair, point))
        return
    s = state.search.geometry.surfaces
    kind = "edge-face" if surface < 0 else KINDS[s.kind[surface]]
    outer = spots.outer_points, spots.outer_normals
    contact = EdgeContact(pair, kind, spots.points, spots.normals, gaps, outer)
    state.found.add(contact, state.limit(pair))


def _joined_arcs(begin: Array, width: Array) -> list[tuple[float, float]]:
    """Union of arcs, as a list of (begin, width); successive arcs meet within `SEAM_ANGLE`."""
    order = np.argsort(np.remainder(begin, TURN))
    begin, width = np.remainder(begin, TURN)[order], width[order]
    arcs: list[list[float]] = []
    for start, length in zip(begin.tolist(), width.tolist(), strict=True):
        if arcs and start <= arcs[-1][1] + SEAM_ANGLE:
            arcs[-1][1] = max(arcs[-1][1], start + length)
        else:
            arcs.append([start, start + length])
    # an arc over the direction 0 is the last one, and the first may follow it
    if len(arcs) > 1 and arcs[0][0] + TURN <= arcs[-1][1] + SEAM_ANGLE:
        arcs[-1][1] = max(arcs[-1][1], arcs.pop(0)[1] + TURN)
    return [(start, min(end - start, TURN)) for start, end in arcs]


def _pierced_faces(face_patches: FacePatches, state: EdgeSearch, pairs: EdgeFacePairs) -> None:
    """Unresolved points at which edges pass through curved faces, inside of these faces.

    A single point of a pair of parts is enough: the pair is then open.
    """
    curves, geometry, facets = state.curves, state.search.geometry, state.search.facets
    ends = np.tile(np.linspace(0, 1, 3), (len(pairs.edge), 1))
    distance = np.column_stack(
        [
            face_distance(
                geometry, facets, pairs.surface, pairs.facet, curves.points(pairs.edge, t).at
            )[0]
            for t in ends.T
        ]
    )
    rows = np.arange(len(pairs.edge))
    low, high = ends[rows, distance.argmin(axis=1)], ends[rows, distance.argmax(axis=1)]
    for _ in range(ROOT_HALVINGS):
        share = (low + high) / 2
        x = curves.points(pairs.edge, share)
        inside, n = face_distance(geometry, facets, pairs.surface, pairs.facet, x.at)
        low, high = np.where(inside < 0, share, low), np.where(inside < 0, high, share)
    pierced: set[int] = set()
    for k in np.flatnonzero(~explained_points(face_patches, pairs.pair, x.at, state.reach)):
        pair, surface = int(pairs.pair[k]), int(pairs.surface[k])
        if pair in pierced or not state.covers((surface, 0), x.at[[k]], n[[k]], pair)[0]:
            continue
        part = int(state.search.pairs[pair][1 if pairs.turned[k] else 0])
        if not state.curves.at_edge(part, x.at[k], 2 * state.limit(pair)):
            state.found.unresolved.append((pair, x.at[k]))
            pierced.add(pair)


def _nearest_points(state: EdgeSearch, pairs: EdgeFacePairs) -> None:
    """Contacts at points of edges that are nearer to the face than their neighbours."""
    curves, geometry, facets = state.curves, state.search.geometry, state.search.facets
    share = _sign_changes(state, pairs)
    x = curves.points(pairs.edge, share)
    gap, n = face_distance(geometry, facets, pairs.surface, pairs.facet, x.at)
    in_front = x.behind(-n)
    for k in np.flatnonzero((np.abs(gap) <= state.reach[pairs.pair]) & in_front):
        one = (int(pairs.surface[k]), int(pairs.facet[k]))
        _add(state, int(pairs.pair[k]), bool(pairs.turned[k]), one, "edge-face", x.at[k], n[k],
             float(gap[k]))  # fmt: skip


def _sign_changes(state: EdgeSearch, pairs: EdgeFacePairs) -> Array:
    """Positions on edges at which they begin to leave their faces, in [0, 1], shape (n,).

    At the beginning n . t < 0, at the end n . t >= 0. Secant steps between the bounds of the root
    converge faster than bisection; a bound that stays twice counts half (the Illinois rule).
    """
    curves, geometry, facets = state.curves, state.search.geometry, state.search.facets

    def slopes(rows: Index, share: Array) -> Array:
        at = curves.points(pairs.edge[rows], share)
        _, n = face_distance(geometry, facets, pairs.surface[rows], pairs.facet[rows], at.at)
        slope: Array = np.einsum("ij,ij->i", at.along, n)
        return slope

    left = np.arange(len(pairs.edge))
    bounds = np.column_stack([np.zeros(len(left)), np.ones(len(left))])
    values = np.column_stack([slopes(left, bounds[:, k]) for k in (0, 1)])
    last = np.full(len(left), -1)
    for step in range(HALVINGS):
        (low, high), (below, above) = bounds[left].T, values[left].T
        share = (low + high) / 2
        if step % 3 != 2:  # a bisection now and then bounds the number of steps
            share = low - below * ratio(high - low, above - below)
        slope = slopes(left, share)
        side = np.where(slope < 0, 0, 1)
        again = side == last[left]
        values[left[again], 1 - side[again]] /= 2
        bounds[left, side], values[left, side], last[left] = share, slope, side
        width = bounds[left, 1] - bounds[left, 0]
        left = left[(width > 2.0**-HALVINGS) & (np.abs(slope) > SLOPE_ROUNDING)]
        if not len(left):
            break
    found: Array = bounds[np.arange(len(bounds)), np.maximum(last, 0)]
    return found


def _add(
    state: EdgeSearch, pair: int, turned: bool, face: tuple[int, int], kind: str, point: Array,
    normal: Array, gap: float,
) -> None:  # fmt: skip
    """Add the contact of a point with a face whose outward normal is given."""
    if not state.covers(face, point[None], normal[None], pair)[0]:
        return
    face_part = int(state.search.pairs[pair][1 if turned else 0])
    middle = point - gap / 2 * normal
    foot, most = point - gap * normal, 2 * state.limit(pair)
    if state.curves.at_edge(face_part, foot, most) or state.at_apex(face[0], foot, most):
        if state.is_near(pair, gap):
            state.found.unresolved.append((pair, middle))
        return
    if state.is_near(pair, gap):
        sense = -1.0 if turned else 1.0
        contact = EdgeContact(pair, kind, middle[None], sense * normal[None], np.array([gap]))
        state.found.add(contact, state.limit(pair))
    else:
        state.found.unresolved.append((pair, middle))


def _line_on_face(
    state: EdgeSearch, one: EdgeFacePairs, ends: tuple[tuple[Array, Array], tuple[Array, Array]],
    along: Array, normal: Array,
) -> None:  # fmt: skip
    """Contact of a straight edge that lies on a face: the ends of the common interval."""
    pair, turned = int(one.pair[0]), bool(one.turned[0])
    surface, facet = int(one.surface[0]), int(one.facet[0])
    (p, q), (left, right) = ends
    into = cross(left[None], along[None])[0], cross(along[None], right[None])[0]
    inward = (*into, sum(into) - left - right)
    if min(float(direction @ normal) for direction in inward) < -CONE_ANGLE:
        return
    triangles, sagitta = state.face(surface, facet)
    limit = state.limit(pair)
    spans = slices(triangles, (p, along, normal), sagitta + float(state.reach[pair]), limit)
    spans = np.clip(spans, 0.0, float((q - p) @ along))
    spans = spans[spans[:, 1] - spans[:, 0] > 2 * limit]
    face_part = int(state.search.pairs[pair][1 if turned else 0])
    for begin, end in spans:
        points = p + np.array([[begin], [end]]) * along
        rows = np.array([surface, surface]), np.array([facet, facet])
        gaps, _ = face_distance(state.search.geometry, state.search.facets, *rows, points)
        middle = points.mean(axis=0) - gaps.mean() * normal
        if state.curves.at_edge(face_part, middle, 2 * limit) or not state.is_near(
            pair, float(np.abs(gaps).min())
        ):
            state.found.unresolved.append((pair, middle))
            continue
        sense = -1.0 if turned else 1.0
        normals = np.tile(sense * normal, (2, 1))
        points = points - gaps[:, None] / 2 * normal
        state.found.add(EdgeContact(pair, "edge-face", points, normals, gaps), limit)


def _corners_on_faces(state: EdgeSearch, pairs: EdgeFacePairs) -> None:
    """Contacts of corners with faces."""
    curves, geometry = state.curves, state.search.geometry
    vertex = curves.edges.ends_of[pairs.edge]
    columns = (pairs.pair, pairs.turned.astype(np.int64), pairs.surface, pairs.facet)
    keys = np.column_stack([np.repeat(x, 2) for x in columns])
    flat = keys[:, 2] < 0
    names = np.column_stack([keys[:, :3], np.where(flat, keys[:, 3], -1), vertex.reshape(-1)])
    rows = np.unique(names, axis=0, return_index=True)[1]
    vertex, keys = vertex.reshape(-1)[rows], keys[rows]
    point = geometry.vertices[vertex]
    gap, normal = face_distance(geometry, state.search.facets, keys[:, 2], keys[:, 3], point)
    near = np.flatnonzero(np.abs(gap) <= state.reach[keys[:, 0]])
    vertex, keys = vertex[near], keys[near]
    point, gap, normal = point[near], gap[near], normal[near]
    owner, away, normals, unknown = corner_rays(curves, vertex)
    leaves = np.einsum("ij,ij->i", away, normal[owner])
    stays = np.bincount(owner[leaves < -CONE_ANGLE], minlength=len(vertex)) > 0
    outward = np.zeros((len(vertex), 3))
    np.add.at(outward, owner, normals)
    in_front = np.einsum("ij,ij->i", outward, normal) < 0
    corner = is_corner(owner, away, len(vertex))
    for k in np.flatnonzero(unknown | (corner & ~stays)):
        pair, turned, surface, facet = keys[k].tolist()
        if unknown[k] or not in_front[k]:
            if state.covers((surface, facet), point[k][None], normal[k][None], pair)[0]:
                state.found.unresolved.append((pair, point[k]))
            continue
        _add(state, pair, bool(turned), (surface, facet), "vertex-face", point[k], normal[k],
             float(gap[k]))  # fmt: skip
