"""Contacts of curved faces without a contact formula, and bounds on their forces.

Free forms, a torus in a groove of the same size, and edges and corners on curved faces of meshes
have no formula. Edges and corners of exact solids (`kilter.contact.sharp.edges_with_faces`,
`edges_with_edges`) may touch without a single normal. Such pairs are listed as unsupported.
A frictionless sphere is pushed through its centre, and the side of a cylinder across its axis;
every force and torque is possible for the other kinds. Rims of flat faces are given as inscribed
polygons; the circumscribed polygons bound the answer from the other side
(`kilter.contact.curved.rims`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from kilter.arrays import Array, Index, Mask, across, angle_between, extents, ragged
from kilter.assembly.geometry import Geometry
from kilter.assembly.surfaces import CYLINDER, FREE, SPHERE, Surfaces
from kilter.contact.common.broad import Boxes, joins
from kilter.contact.common.distances import near_triangles
from kilter.contact.common.edges import Edges
from kilter.contact.common.facets import Facets
from kilter.contact.common.findings import CurvedFindings, FacePatches, explained, triangles_on_flat
from kilter.contact.common.patches import PossibleContacts, UnsupportedContact
from kilter.contact.contact_tolerances import FACETED_ANGLE, SMOOTH_ANGLE
from kilter.contact.curved.rims import Force, possible_forces
from kilter.shape.covering import covered


def edges_near_faces(
    face_patches: FacePatches, edges: Edges, rows: Index, reach: Array, *, turn: bool
) -> tuple[Index, Index, Index]:
    """Sharp edges of part b (part a, if `turn`) that come near curved faces of the other part.

    `face_patches`, `edges`, `rows`, `reach`, `turn`: as in `edges_on_faces`.
    """
    search = face_patches.search
    geometry, facets, boxes = search.geometry, search.facets, search.boxes
    pairs = search.pairs
    s = geometry.surfaces
    a, b = pairs[rows].T[::-1] if turn else pairs[rows].T
    grow = reach[rows] + geometry.slack[b]
    owner, face = ragged(s.start, a)
    keep = (s.kind[face] != FREE) & (np.diff(s.triangle_start)[face] > 0)
    owner, face = owner[keep], face[keep]
    low, high = _face_boxes(geometry, boxes, face)
    margin = (grow + geometry.slack[a])[:, None]
    box = (
        np.maximum(boxes.part_low[a], boxes.part_low[b]) - margin,
        np.minimum(boxes.part_high[a], boxes.part_high[b]) + margin,
    )
    edge_owner, edge = edges.inside(boxes, b, box)
    sharp = _is_sharp(geometry, facets, edges, edge)
    edge_owner, edge = edge_owner[sharp], edge[sharp]
    edge_boxes = edges.boxes(boxes, edge)
    blocks = [(np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0, np.int64))]
    for k, x, y in joins(owner, (low, high), edge_owner, edge_boxes, margin[:, 0]):
        blocks.append((rows[k], face[x], edge[y]))
    pair, surface, chosen = (np.concatenate([block[k] for block in blocks]) for k in range(3))
    return pair, surface, chosen


def edges_on_faces(
    face_patches: FacePatches, edges: Edges, near: tuple[Index, Index, Index], reach: Array,
    *, turn: bool,
) -> tuple[Index, Array, Index]:  # fmt: skip
    """Points at which sharp edges of part b (part a, if `turn`) touch curved faces of the other.

    An edge is sharp if its two faces meet at an angle.

    `edges`: edges of all parts of the pairs. `reach`, shape (number of pairs,): largest gap at
    which they touch [length unit]. `turn`: true: the edges belong to part a. Returns `surfaces`,
    shape (m,): the curved faces.
    """
    search, curved = face_patches.search, face_patches.curved
    geometry, facets = search.geometry, search.facets
    s = geometry.surfaces
    pair, surface, edge = near
    b = search.pairs[pair, 0 if turn else 1]
    p, q = edges.ends(geometry, edge)
    limit = reach[pair] + geometry.slack[b] + s.doubt[surface]
    unexplained = np.flatnonzero(~_lies_on_patch(curved, pair, surface, s, p, q, limit))
    pair, surface, edge = pair[unexplained], surface[unexplained], edge[unexplained]
    p, q, limit = p[unexplained], q[unexplained], limit[unexplained]
    # an edge of a curved face is known more exactly than its chord: no slack is needed
    exact, middle = _true_middle(geometry, facets, edges, edge, p, q)
    limit = np.where(exact, reach[pair] + s.doubt[surface], limit)
    point, off = _nearest_on_edge(s, surface, (p, middle, q), limit)
    near_rows = np.flatnonzero(np.abs(off) <= limit)
    covers = _within_face(geometry, surface[near_rows], point[near_rows], limit[near_rows])
    near_rows = near_rows[covers]
    return pair[near_rows], point[near_rows], surface[near_rows]


def _face_boxes(geometry: Geometry, boxes: Boxes, face: Index) -> tuple[Array, Array]:
    """Bounding boxes of curved faces in the frame of the part boxes, with their sagitta as margin.

    The sagitta is the largest distance of the triangles from the true surface.
    """
    s = geometry.surfaces
    used, place = np.unique(face, return_inverse=True)
    low, high = np.empty((len(used), 3)), np.empty((len(used), 3))
    for k, row in enumerate(used.tolist()):
        points = boxes.turned[geometry.triangles[s.triangles_of(row)]]
        low[k] = points.min(axis=(0, 1)) - s.sagitta[row]
        high[k] = points.max(axis=(0, 1)) + s.sagitta[row]
    return low[place], high[place]


def _is_sharp(geometry: Geometry, facets: Facets, edges: Edges, edge: Index) -> Mask:
    """Mask of edges at which the exact surfaces of both faces meet at an angle."""
    s = geometry.surfaces
    left, right = edges.facet[edge].T
    middle = geometry.vertices[edges.ends_of[edge, 0]]
    normals, exact = [], np.ones(len(edge), dtype=bool)
    for facet in (left, right):
        surface = facets.surface[facet]
        free = (surface >= 0) & (s.kind[surface] == FREE) if len(s) else surface >= 0
        has_formula = (surface >= 0) & ~free
        normal = facets.normal[facet].copy()
        normal[has_formula] = s.outward(surface[has_formula], middle[has_formula])
        normals.append(normal)
        exact &= ~free
    bend = angle_between(*normals)
    open_edge = (left < 0) | (right < 0)
    inside_face = (facets.surface[left] == facets.surface[right]) & (facets.surface[left] >= 0)
    sharp: Mask = open_edge | (~inside_face & (bend > np.where(exact, SMOOTH_ANGLE, FACETED_ANGLE)))
    return sharp


def _lies_on_patch(
    curved: CurvedFindings, pair: Index, surface: Index, s: Surfaces, p: Array, q: Array,
    limit: Array,
) -> Mask:  # fmt: skip
    """Mask of edges whose two ends lie on a surface that already has a contact patch."""
    patches = curved.patches
    sides = [np.column_stack([patches.pair, side])[patches.area > 0] for side in curved.surface.T]
    patched = np.unique(np.concatenate(sides), axis=0)
    if not len(patched):
        return np.zeros(len(pair), dtype=bool)
    stride = len(s) + 1
    has_patch = np.isin(pair * stride + surface, patched[:, 0] * stride + patched[:, 1])
    on_surface: Mask = has_patch & (np.abs(s.distance(surface, p)) <= limit)
    return on_surface & (np.abs(s.distance(surface, q)) <= limit)


def _true_middle(
    geometry: Geometry, facets: Facets, edges: Edges, line: Index, p: Array, q: Array
) -> tuple[Mask, Array]:
    """Mask of edges without an inexact face, and the middle of each edge on its curved face.

    A straight edge counts as exact and keeps its middle. The middle of any other chord is moved
    onto the surface by three Newton steps in the plane of the rim.
    """
    s = geometry.surfaces
    middle, exact = (p + q) / 2, np.ones(len(line), dtype=bool)
    for facet in edges.facet[line].T:
        surface = facets.surface[facet]
        curved = np.flatnonzero((surface >= 0) & (facet >= 0))
        rows = curved[s.kind[surface[curved]] != FREE]
        exact[curved] &= (s.kind[surface[curved]] != FREE) & (s.doubt[surface[curved]] == 0)
        row = surface[rows]
        # the flat neighbour and the chord both lie in the plane of the rim
        _, _, out = s.polar(row, middle[rows])
        for _ in range(3):
            off = s.distance(row, middle[rows])
            steep = np.einsum("ij,ij->i", s.outward(row, middle[rows]), out)
            # a surface nearly along `out` has no root nearby: no step
            step = off / np.where(np.abs(steep) > SMOOTH_ANGLE, steep, np.inf)
            middle[rows] -= step[:, None] * out
    return exact, middle


def _nearest_on_edge(
    s: Surfaces, face: Index, edge: tuple[Array, Array, Array], limit: Array
) -> tuple[Array, Array]:
    """Point of each curved edge that is nearest to a face, and its signed distance from it.

    The distance along the edge is approximated by the parabola through its three values. If it
    changes its sign by more than `limit`, the edge passes through the face, and the distance is 0.
    """
    values = np.stack([s.distance(face, x) for x in edge], axis=1)
    order = np.argmin(values, axis=1)
    rows = np.arange(len(face))
    nearest, off = np.stack(edge, axis=1)[rows, order].copy(), values[rows, order].copy()
    f0, f1, f2 = values.T
    curvature = 2 * (f0 - 2 * f1 + f2)
    # the minimum of the parabola, if it opens upwards
    t = np.clip((3 * f0 - 4 * f1 + f2) / np.where(curvature > 0, 2 * curvature, np.inf), 0, 1)
    weight = np.stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)], axis=1)
    vertex_point = np.einsum("nk,nki->ni", weight, np.stack(edge, axis=1))
    vertex_distance = s.distance(face, vertex_point)
    better = (vertex_distance < off) & (curvature > 0)
    nearest[better], off[better] = vertex_point[better], vertex_distance[better]
    # the distance has a root inside the edge, which a minimum over three points may miss
    pierces = (values.min(axis=1) < -limit) & (values.max(axis=1) > limit)
    share = (f0 / np.where(f0 != f2, f0 - f2, 1.0)).clip(0, 1)
    nearest[pierces] = edge[0][pierces] + share[pierces, None] * (edge[2] - edge[0])[pierces]
    off[pierces] = 0.0
    return nearest, off


def _within_face(geometry: Geometry, face: Index, point: Array, limit: Array) -> Mask:
    """Mask of faces whose triangles extend to a given point of the surface."""
    s = geometry.surfaces
    covers = np.zeros(len(face), dtype=bool)
    normal = s.outward(face, point) if len(face) else point
    for row in np.unique(face).tolist():
        of_face = np.flatnonzero(face == row)
        grow = float(limit[of_face].max())
        triangles = geometry.vertices[geometry.triangles[s.triangles_of(row)]]
        reach = float(s.sagitta[row]) + grow
        covers[of_face] = covered(triangles, point[of_face], normal[of_face], reach, grow)
    return covers


NearFaces = tuple[Index, Index, Index]
"""Rows of pairs of parts, curved surfaces, and edges of the other part that come near them."""


@dataclass(frozen=True, slots=True, eq=False)
class RoundContacts:
    """Contacts at curved surfaces without a formula, a record for each pair, and their forces."""

    unsupported: tuple[UnsupportedContact, ...] = ()
    possible: PossibleContacts = field(default_factory=PossibleContacts.none)


BLOCK = 200_000
"""Number of pairs (point, surface) whose distances are computed at once."""


TRIANGLES = 20_000
"""Number of pairs of triangles that are compared at once; each takes about 2 kB."""


def beside_curved(geometry: Geometry, parts: Index, points: Array, slack: Array) -> Mask:
    """Mask of points, shape (n, 3), within `slack` of a curved surface of either part."""
    s = geometry.surfaces
    is_near = np.zeros(len(points), dtype=bool)
    for side in parts.T:
        # in blocks: a board has hundreds of holes, and thousands of points beside them
        last = np.cumsum(np.diff(s.start)[side])
        cuts = np.searchsorted(last, np.arange(BLOCK, last.max(initial=0), BLOCK))
        for rows in np.split(np.arange(len(side)), cuts):
            owner, row = ragged(s.start, side[rows])
            owner = rows[owner]
            off = np.abs(s.distance(row, points[owner]))
            near = (off <= slack[owner]) | (s.kind[row] == FREE)
            is_near[owner[near]] = True
    return is_near


def round_contacts(
    face_patches: FacePatches,
    edges: Edges,
    rows: Index,
    rims: tuple[Index, Array],
    on_faces: tuple[NearFaces, NearFaces],
    reach: Array,
) -> RoundContacts:
    """Contacts at curved surfaces of the pairs `rows` that no contact patch explains.

    `edges`: edges of all parts of these pairs. `rows`, shape (n,): pairs to search. `reach`, shape
    (number of pairs,): largest gap at which the parts touch, or may touch [length unit].
    """
    search, curved = face_patches.search, face_patches.curved
    geometry, pairs = search.geometry, search.pairs
    points_of_pair: dict[int, list[tuple[Array, int]]] = {}

    def add_points(pair: Index, point: Array, surface: Index) -> None:
        """Add points that lie on no contact patch of their pair to `points_of_pair`."""
        for k in np.flatnonzero(~explained_points(face_patches, pair, point, reach)):
            points_of_pair.setdefault(int(pair[k]), []).append((point[k], int(surface[k])))

    add_points(rims[0], rims[1], np.full(len(rims[0]), -1))
    for turn, near in zip((False, True), on_faces, strict=True):
        add_points(*edges_on_faces(face_patches, edges, near, reach, turn=turn))
    chosen = curved.unknown[np.isin(curved.unknown[:, 0], rows)]
    patched = np.column_stack([curved.patches.pair, curved.surface]).tolist()
    patched = {tuple(row) for row in patched}
    chosen = chosen[[tuple(row) not in patched for row in chosen.tolist()]]
    for pair in np.unique(chosen[:, 0]).tolist():
        # one point without a formula already lets any force act
        if any(surface < 0 for _, surface in points_of_pair.get(pair, ())):
            continue
        before = len(points_of_pair.get(pair, ()))
        faces = chosen[chosen[:, 0] == pair, 1:]
        for point in _close_triangles(face_patches, pair, faces, float(reach[pair])):
            add_points(np.full(len(point), pair), point, np.full(len(point), -1))
            if len(points_of_pair.get(pair, ())) > before:
                break
    return _round_contacts_of(geometry, pairs, points_of_pair)


def explained_points(face_patches: FacePatches, pair: Index, points: Array, reach: Array) -> Mask:
    """Mask of points on contact patches of their pairs, shape (n,).

    `reach` is the largest gap at which the parts of each pair may touch [length unit].
    """
    geometry, pairs = face_patches.search.geometry, face_patches.search.pairs
    pair = np.asarray(pair, dtype=np.int64)  # joined with an empty block it may be a float
    result = np.zeros(len(pair), dtype=bool)
    for name in np.unique(pair).tolist():
        of_pair = np.flatnonzero(pair == name)
        slack = float(reach[name] + 2 * geometry.slack[pairs[name]].max())
        result[of_pair] = explained(face_patches, name, points[of_pair], slack)
    return result | face_patches.smooth.explains(pair, points)


def _round_contacts_of(
    geometry: Geometry, pairs: Index, points_of_pair: dict[int, list[tuple[Array, int]]]
) -> RoundContacts:
    """Records of contacts without a formula, from the points and surfaces of each pair."""
    unsupported = []
    forces: list[Force] = []
    for pair in sorted(points_of_pair):
        if not points_of_pair[pair]:
            continue
        a, b = (int(k) for k in pairs[pair])
        point, _ = points_of_pair[pair][0]
        x, y, z = point.tolist()
        unsupported.append(UnsupportedContact((a, b), "curved", (x, y, z)))
        surfaces = {surface for _, surface in points_of_pair[pair]}
        if all(geometry.surfaces.kind[k] in (SPHERE, CYLINDER) for k in surfaces if k >= 0) and (
            min(surfaces) >= 0
        ):
            pair_forces = [force for k in sorted(surfaces) for force in _forces(geometry, k)]
        else:
            pair_forces = _any_wrench(point, float(geometry.radius[[a, b]].min()))
        forces.extend((a, b, force_point, normal) for force_point, normal in pair_forces)
    return RoundContacts(tuple(unsupported), possible_forces(forces, two_sided=True))


def _any_wrench(point: Array, arm: float) -> list[tuple[Array, Array]]:
    """Six forces, as (point, direction), that together produce any force and any torque."""
    x, y, z = np.eye(3)
    at_point = [(point, x), (point, y), (point, z)]
    return [*at_point, (point + arm * x, y), (point + arm * x, z), (point + arm * y, z)]


def _forces(geometry: Geometry, surface: int) -> list[tuple[Array, Array]]:
    """Forces (point, direction) that a frictionless sphere or cylinder can exert at a contact."""
    s = geometry.surfaces
    center, axis = s.point[surface], s.axis[surface]
    if s.kind[surface] == SPHERE:
        return [(center, direction) for direction in np.eye(3)]
    corners = geometry.vertices[geometry.triangles[s.triangles_of(surface)]].reshape(-1, 3)
    along = (corners - center) @ axis
    ends = (center + along.min() * axis, center + along.max() * axis)
    return [(end, d) for end in ends for d in across(axis)]


# faces without a formula: near triangles ---------------------------------------------------


def _close_triangles(
    face_patches: FacePatches, pair: int, faces: Index, tolerance: float
) -> Iterator[Array]:
    """Points, shape (n, 3), at which triangulated faces of a pair come within the tolerance.

    They come in blocks; points that a flat patch surely explains are left out. `faces`, shape (m,
    2): a surface of each part, or -1 for its flat triangles. The tolerance includes the sagittas,
    the distances of triangles from true surfaces.
    """
    geometry, parts = face_patches.search.geometry, face_patches.search.pairs[pair]
    s = geometry.surfaces
    sagitta, width = np.append(s.sagitta, 0.0), len(s) + 1
    sides, labels = [], []
    for part, wanted in zip(parts.tolist(), faces.T, strict=True):
        span = slice(*geometry.triangle_start[part : part + 2].tolist())
        label = np.maximum(geometry.triangle_surface[span], -1)
        chosen = np.isin(label, wanted)
        sides.append(geometry.vertices[geometry.triangles[span][chosen]])
        labels.append(label[chosen])
    boxes = [extents(side) for side in sides]
    owners = [np.zeros(len(side), dtype=np.int64) for side in sides]
    widest = tolerance + float(sagitta[faces].sum(axis=1).max())
    key = (faces + 1) @ [width, 1]
    # a point is at most half the widest gap from both of its triangles
    zone = tolerance + 2 * float(geometry.slack[parts].max()) - widest / 2
    on_patch = []
    for side, (low, high), (first, last) in zip(sides, boxes, boxes[::-1], strict=True):
        beside = low <= last.max(axis=0, initial=-np.inf) + widest
        beside &= high >= first.min(axis=0, initial=np.inf) - widest
        explains = beside.all(axis=1)
        explains[explains] = triangles_on_flat(face_patches, pair, side[explains], zone)
        on_patch.append(explains)
    for _, i, j in joins(owners[0], boxes[0], owners[1], boxes[1], np.array([widest])):
        on = np.column_stack([labels[0][i], labels[1][j]])
        kept = np.isin((on + 1) @ [width, 1], key) & ~(on_patch[0][i] | on_patch[1][j])
        kept = np.flatnonzero(kept)
        for few in np.array_split(kept, 1 + len(kept) // TRIANGLES):
            grow = tolerance + sagitta[on[few]].sum(axis=1)
            yield near_triangles(sides[0][i[few]], sides[1][j[few]], grow)
