"""Normals that a contact point of edges and corners has: unique, or several possible.

K_A, K_B: the local cones of parts a and b at p (`local_cones`), whose interiors are disjoint. To
first order a velocity v of b relative to a at p makes the parts penetrate iff v is in

    D = int K_A - int K_B.

So n is a constraint v.n >= 0 of every motion iff D contains all of {v.n < 0}. With S_A the
directions of the plane n.d = 0 with material of a just below it, and S_B those with material of b
just above, this holds iff S_A - S_B is the whole plane: p is accepted with n.

For convex pieces P of K_A and Q of K_B, D is the union of the int P - int Q, and each of these is
{v.m < 0 for every m of N}, N = the extreme directions of the cone of normals that separate P from
Q. If N has a single m, it is a constraint. If N has several, v.m >= 0 must hold for at least one of
them: a clause. Clauses that the accepted constraints at p do not imply make p degenerate: a
velocity exists that meets all constraints and penetrates, and the allowed motions form a union
(Palmer; the paper, section 1.1).

A corner on a facet has the normal of the facet; two edges that cross have the normal of both. All
other points follow from the local cones of both parts (`local_cones`) and the spanning rule
above. A normal close to that of a facet at the point is replaced by the facet's normal.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kilter.arrays import Array, Index, Mask, Rows, across, cross, ragged, ratio, starts, unit_rows
from kilter.assembly.geometry import Geometry
from kilter.contact.common.edges import Edges
from kilter.contact.common.facets import Facets
from kilter.contact.contact_tolerances import (
    CONE_ANGLE,
    CUT_COSINE,
    EDGE_NEARLY_PARALLEL,
    LITERAL_ANGLE,
    NORMAL_ANGLE,
    NORMAL_SNAP,
)
from kilter.contact.sharp.feature_pairs import CORNER, EDGE, FACE, Meetings
from kilter.contact.sharp.local_cones import Cones, find_cones, spanned
from kilter.work import stop_if_late

BATCH = 2_000_000
"""Candidates compared at once; a larger value needs more memory."""


def separating(rays_a: Array, rays_b: Array) -> tuple[Array, Index, Mask]:
    """Extreme normals, from a to b, of the planes that separate two convex cones.

    `rays_a`, `rays_b`, shape (n, p, 3) and (n, q, 3): unit directions that span the cones of n
    pairs. Returns `count`, shape (n,): number of normals of each pair; 0: the cones penetrate each
    other.

    Examples
    --------
    >>> lower = np.array([[[1., 0, -1], [-1, 0, -1], [0, 1, 0], [0, -1, 0]]])
    >>> upper = np.array([[[0., 1, 1], [0, -1, 1], [1, 0, 0], [-1, 0, 0]]])
    >>> separating(lower, upper)[0] + 0.0  # ridges that cross
    array([[[0., 0., 1.]]])
    """
    normals = np.zeros((len(rays_a), 1, 3))
    count = np.zeros(len(rays_a), dtype=np.int64)
    exact = np.ones(len(rays_a), dtype=bool)
    total = rays_a.shape[1] + rays_b.shape[1]
    step = max(1, BATCH // total**3)
    for begin in range(0, len(rays_a), step):
        rows = np.arange(begin, min(begin + step, len(rays_a)))
        found_normals, found_count, is_exact = _separating_batch(rays_a[rows], rays_b[rows])
        if found_normals.shape[1] > normals.shape[1]:
            padding = np.zeros((len(normals), found_normals.shape[1] - normals.shape[1], 3))
            normals = np.concatenate([normals, padding], axis=1)
        normals[rows, : found_normals.shape[1]] = found_normals
        count[rows], exact[rows] = found_count, is_exact
    return normals, count, exact


def _separating_batch(rays_a: Array, rays_b: Array) -> tuple[Array, Index, Mask]:
    """Extreme normals of the planes that separate two cones, for a batch of pairs of cones."""
    ahead = np.concatenate(
        [-rays_a, rays_b], axis=1
    )  # a separating normal has a non-negative product with all of these
    i, j = np.triu_indices(ahead.shape[1], 1)
    lines = np.cross(ahead[:, i], ahead[:, j])
    sine = np.linalg.norm(lines, axis=2)
    lines = ratio(lines, sine[..., None])
    rise = np.einsum("nci,nki->nck", lines, ahead)
    lowest, highest = rise.min(axis=2), rise.max(axis=2)
    lines, sine = np.concatenate([lines, -lines], axis=1), np.concatenate([sine, sine], axis=1)
    lowest = np.concatenate([lowest, -highest], axis=1)
    loose = (lowest >= -CONE_ANGLE) & (sine > CONE_ANGLE)
    normals, count = _distinct_candidates(lines, loose, sine)
    # of several normals, each must also exist without the tolerance
    exact = np.ones(len(normals), dtype=bool)
    ambiguous = np.flatnonzero(count > 1)
    tight = ((lowest >= -LITERAL_ANGLE) & (sine > LITERAL_ANGLE))[ambiguous]
    for k in range(int(count.max(initial=0))):
        near = (
            np.linalg.norm(lines[ambiguous] - normals[ambiguous, k, None], axis=2) <= NORMAL_ANGLE
        )
        has_exact = (near & tight).any(axis=1)
        exact[ambiguous] &= has_exact | (k >= count[ambiguous])
    return normals, count, exact


def _distinct_candidates(candidates: Array, valid: Mask, weight: Array) -> tuple[Array, Index]:
    """Distinct valid normals; among nearly equal normals, the one with the greatest weight."""
    width = int(valid.sum(axis=1).max(initial=0))
    order = np.argsort(np.where(valid, -weight, np.inf), axis=1, kind="stable")[:, :width]
    candidates = np.take_along_axis(candidates, order[..., None], axis=1)
    left = np.take_along_axis(valid, order, axis=1)
    normals = np.zeros((len(candidates), 1, 3))
    count = np.zeros(len(candidates), dtype=np.int64)
    rows = np.arange(len(candidates))
    while left.any():
        has_left = left.any(axis=1)
        heaviest = candidates[rows, left.argmax(axis=1)]
        if count.max() == normals.shape[1]:
            normals = np.concatenate([normals, np.zeros((len(rows), 1, 3))], axis=1)
        normals[rows[has_left], count[has_left]] = heaviest[has_left]
        count[has_left] += 1
        left &= np.linalg.norm(candidates - heaviest[:, None], axis=2) > NORMAL_ANGLE
    return normals, count


# points at which parts have several convex pieces ----------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class PointConstraints:
    """Certain normals of a contact point, and sets of normals of which at least one applies."""

    accepted: Array
    """Unit normals along which every motion must open or keep the gap, shape (k, 3)."""
    clauses: list[Array]
    """A motion may close some normals of a set, but not all of them, shape (m, 3)."""


def resolve(pairs: list[tuple[Array, Array, Array]]) -> PointConstraints:
    """Find the certain normals of a contact point, and sets of which at least one normal applies.

    `pairs`: directions that span a piece of a and a piece of b, and their extreme separating
    normals.
    """
    sets = [normals for _, _, normals in pairs]
    accepted = distinct([n[0] for n in sets if len(n) == 1])
    clauses = [n for n in sets if len(n) > 1]
    # a normal of a clause is a constraint by itself if all pieces together span its plane
    for normal in distinct([n for clause in clauses for n in clause]):
        if not _contains(normal, accepted) and spans(normal, pairs):
            accepted = np.vstack([accepted, normal])
    kept: list[Array] = []
    for clause in sorted(clauses, key=len):
        if any(_contains(n, accepted) for n in clause) or _is_implied(clause, accepted):
            continue
        # a clause that contains a kept clause follows from it
        if not any(all(_contains(n, clause) for n in shorter) for shorter in kept):
            kept.append(clause)
    return PointConstraints(accepted, kept)


def distinct(normals: list[Array]) -> Array:
    """The unit normals without repeats, shape (k, 3)."""
    kept: list[Array] = []
    for normal in normals:
        if not any(
            float(np.linalg.norm(normal - kept_normal)) <= NORMAL_ANGLE for kept_normal in kept
        ):
            kept.append(normal)
    return np.array(kept).reshape(-1, 3)


def _contains(normal: Array, normals: Array) -> bool:
    return bool((np.linalg.norm(normals - normal, axis=1) <= NORMAL_ANGLE).any())


def _is_implied(clause: Array, accepted: Array) -> bool:
    """Whether the certain normals already exclude every motion that closes all normals of a set.

    That is each v with v.m < 0 for all m of the clause.
    """
    if not len(accepted):
        return False
    # all v that the accepted normals allow and that violate the clause, at least weakly
    allowed = spanned(np.vstack([clause, -accepted]))
    if not len(allowed):
        return True
    # the sum lies inside the cone: it violates all of the clause strictly, or no v does
    return bool((clause @ allowed.sum(axis=0)).max() > -CONE_ANGLE)


def spans(normal: Array, pairs: list[tuple[Array, Array, Array]]) -> bool:
    """Whether the two bodies' directions at a point span the plane across `normal`.

    These are S_A - S_B over all pairs of pieces, cut by the plane.

    The cones of all pairs of pieces count: S_A - S_B, cut by the plane.

    Examples
    --------
    >>> x, y, z = np.eye(3)
    >>> face, tip = np.array([x, -x, y, -y, -z]), np.array([x + z, y + z, z - x - y])
    >>> spans(z, [(face, tip, z[None])]), spans(z, [(-tip, tip, z[None])])
    (True, False)
    """
    axes = np.stack(across(normal), axis=1)
    arcs = []
    for rays_a, rays_b, _ in pairs:
        below, above = _in_plane_rays(rays_a, -normal), _in_plane_rays(rays_b, normal)
        if below is None or above is None:
            continue
        arc = _spanned_arc(np.vstack([below, -above]) @ axes)
        if arc is not None:
            arcs.append(arc)
    return _covers_circle(arcs)


def _in_plane_rays(rays: Array, side: Array) -> Array | None:
    """Directions that span the cut of a cone by a plane; None if the cone has none on that side.

    The plane has the normal `side`; None if the cone has no material on that side.
    """
    height = rays @ side
    if height.max() <= CUT_COSINE:
        return None
    level = rays[np.abs(height) <= CUT_COSINE]
    above, below = np.flatnonzero(height > CUT_COSINE), np.flatnonzero(height < -CUT_COSINE)
    # the plane meets the cone between rays on either side of it
    cut = (
        height[above][:, None, None] * rays[below][None]
        - height[below][None, :, None] * (rays[above][:, None])
    )
    return np.vstack([level, cut.reshape(-1, 3)])


def _spanned_arc(directions: Array) -> tuple[float, float] | None:
    """Smallest arc (begin, width) of angles that contains given plane directions [rad]; or None."""
    size = np.linalg.norm(directions, axis=1)
    directions = directions[size > CUT_COSINE]
    if not len(directions):
        return None
    angle = np.sort(np.arctan2(directions[:, 1], directions[:, 0]))
    gap = np.diff(np.append(angle, angle[0] + 2 * np.pi))
    widest = int(gap.argmax())
    # without a gap of a half turn, sums of the directions reach the whole plane
    if gap[widest] < np.pi - CUT_COSINE:
        return float(angle[0]), 2 * np.pi
    return float(angle[(widest + 1) % len(angle)]), float(2 * np.pi - gap[widest])


def _covers_circle(arcs: list[tuple[float, float]]) -> bool:
    """Whether the union of closed arcs (begin, width) is the whole circle."""
    ends = np.sort(np.array([x % (2 * np.pi) for a, w in arcs for x in (a, a + w)]))
    if not len(ends):
        return False
    following = np.append(ends[1:], ends[0] + 2 * np.pi)
    # between neighbouring ends the cover is constant: test the middles
    middle = ((ends + following) / 2)[following - ends > CUT_COSINE]
    return all(any((x - a) % (2 * np.pi) <= w for a, w in arcs) for x in middle.tolist())


@dataclass(frozen=True, slots=True, eq=False)
class Pushes(Rows):
    """Contact points of edges and corners that have a unique normal, from part a to part b.

    `of_facet`, shape (n, 2), is True if a facet of part a, or of part b, has the normal.
    """

    meeting: Index
    normal: Array
    of_facet: Mask


@dataclass(frozen=True, slots=True, eq=False)
class Clauses:
    """Degenerate contact points, at which several normals are possible.

    A motion is allowed if it does not close the gap along at least one normal of each point.
    """

    meeting: Index
    """Row of the meeting, shape (n,)."""
    start: Index
    normal: Array
    """Extreme normals of clause k, from a to b, shape (n + 1,): rows ``start[k]`` to ``start[k +
    1]``."""
    exact: Mask
    """True if the literal directions, without tolerance, give the same normals, shape (n,)."""

    def take(self, rows: Index) -> Clauses:
        """Copy with only the degenerate points of the given rows."""
        _, at = ragged(self.start, rows)
        start = starts(np.diff(self.start)[rows])
        return Clauses(self.meeting[rows], start, self.normal[at], self.exact[rows])

    @property
    def owner(self) -> Index:
        """Row of the degenerate point to which each normal belongs, shape (m,)."""
        return np.repeat(np.arange(len(self.meeting)), np.diff(self.start))


def normals_of(
    geometry: Geometry, facets: Facets, edges: Edges, meetings: Meetings, coincident: Mask
) -> tuple[Pushes, Clauses]:
    """Normals of contact points of edges and corners: unique, or several at degenerate points.

    `coincident`, shape (n,): true if the two points of a meeting coincide up to rounding.
    """
    on_face = (meetings.kind == FACE).any(axis=1)
    first, second = (
        np.where(meetings.kind[:, k] == EDGE, meetings.feature[:, k], 0) for k in (0, 1)
    )
    crossing = np.flatnonzero((meetings.kind == EDGE).all(axis=1))
    along = [edges.direction(geometry, rows[crossing]) for rows in (first, second)]
    crossing = crossing[np.linalg.norm(cross(*along), axis=1) > EDGE_NEARLY_PARALLEL]
    rest = ~on_face
    rest[crossing] = False
    cone_rows, cone_normals, clauses = _cone_normals(
        geometry, facets, edges, meetings, np.flatnonzero(rest)
    )
    clauses = replace(clauses, exact=clauses.exact & coincident[clauses.meeting])
    blocks = [
        _facet_normals(geometry, facets, edges, meetings, np.flatnonzero(on_face)),
        _crossing_normals(geometry, facets, edges, meetings, crossing),
        (cone_rows, cone_normals),
    ]
    rows, normals = (np.concatenate([f[k] for f in blocks]) for k in (0, 1))
    normals, of_facet = _snap_normals(facets, edges, meetings, rows, normals)
    owner = clauses.meeting[clauses.owner]
    snapped, _ = _snap_normals(facets, edges, meetings, owner, clauses.normal)
    clauses = Clauses(clauses.meeting, clauses.start, snapped, clauses.exact)
    return Pushes(rows, normals, of_facet), clauses


def _facet_normals(
    geometry: Geometry, facets: Facets, edges: Edges, meetings: Meetings, rows: Index
) -> tuple[Index, Array]:
    """Meetings of a corner or edge with a facet that it bends away from: rows and normals."""
    side = (meetings.kind[rows, 1] == FACE).astype(np.int64)
    normal = facets.normal[meetings.feature[rows, side]]
    feature = meetings.feature[rows, 1 - side]
    is_accepted = np.ones(len(rows), dtype=bool)
    corner = np.flatnonzero(meetings.kind[rows, 1 - side] == CORNER)
    corner_rays = edges.rays(geometry, feature[corner])
    rise = np.einsum("ij,ij->i", corner_rays.direction, normal[corner[corner_rays.owner]])
    is_accepted[corner[corner_rays.owner[rise < -CONE_ANGLE]]] = False
    edge = np.flatnonzero(meetings.kind[rows, 1 - side] == EDGE)
    is_accepted[edge] = edges.behind(facets, geometry, feature[edge], -normal[edge], CONE_ANGLE)
    sign = np.where(side == 0, 1.0, -1.0)[:, None]
    return rows[is_accepted], (sign * normal)[is_accepted]


def _crossing_normals(
    geometry: Geometry, facets: Facets, edges: Edges, meetings: Meetings, rows: Index
) -> tuple[Index, Array]:
    """Meetings of two convex edges that cross from opposite sides: rows and normals."""
    e, f = meetings.feature[rows].T
    normal = unit_rows(cross(edges.direction(geometry, e), edges.direction(geometry, f)))
    convex = ~edges.reflex(facets, geometry, e, CONE_ANGLE) & ~edges.reflex(
        facets, geometry, f, CONE_ANGLE
    )
    accepted_rows, accepted_normals = [], []
    for sign in (1.0, -1.0):
        is_accepted = convex & edges.behind(facets, geometry, e, sign * normal, CONE_ANGLE)
        is_accepted &= edges.behind(facets, geometry, f, -sign * normal, CONE_ANGLE)
        accepted_rows.append(rows[is_accepted])
        accepted_normals.append(sign * normal[is_accepted])
    return np.concatenate(accepted_rows), np.concatenate(accepted_normals)


def _snap_normals(
    facets: Facets, edges: Edges, meetings: Meetings, rows: Index, normals: Array
) -> tuple[Array, Mask]:
    """Replace normals by those of adjacent facets that nearly agree; also mask where these exist.

    Also returns whether a facet of part a, and of part b, has the normal, shape (n, 2).
    """
    of_facet = np.zeros((len(rows), 2), dtype=bool)
    result = normals.copy()
    nearest = np.full(len(rows), NORMAL_SNAP)
    for side, sign in ((0, 1.0), (1, -1.0)):
        kind, feature = meetings.kind[rows, side], meetings.feature[rows, side]
        owner, facet = _facets_at(edges, kind, feature)
        difference = np.linalg.norm(sign * facets.normal[facet] - normals[owner], axis=1)
        order = np.lexsort((difference, owner))
        first = order[np.unique(owner[order], return_index=True)[1]]
        first = first[difference[first] <= NORMAL_SNAP]
        of_facet[owner[first], side] = True
        first = first[difference[first] < nearest[owner[first]]]
        nearest[owner[first]] = difference[first]
        result[owner[first]] = sign * facets.normal[facet[first]]
    return result, of_facet


def _facets_at(edges: Edges, kind: Index, feature: Index) -> tuple[Index, Index]:
    """Facets beside each face, edge or corner, as pairs (row of the feature, facet)."""
    face, edge = np.flatnonzero(kind == FACE), np.flatnonzero(kind == EDGE)
    corner = np.flatnonzero(kind == CORNER)
    owner, row = ragged(edges.ray_start, feature[corner])
    sides = edges.facet[edges.ray_edge[row]]
    owners = [face, np.repeat(edge, 2), np.repeat(corner[owner], 2)]
    blocks = [feature[face], edges.facet[feature[edge]].reshape(-1), sides.reshape(-1)]
    all_owners, all_facets = np.concatenate(owners), np.concatenate(blocks)
    real = all_facets >= 0
    return all_owners[real], all_facets[real]


def _cone_normals(
    geometry: Geometry, facets: Facets, edges: Edges, meetings: Meetings, rows: Index
) -> tuple[Index, Array, Clauses]:
    """Unique normals with their rows, and degenerate points, from the local cones of both parts."""
    both = np.concatenate([meetings.kind[rows], meetings.feature[rows]], axis=1).reshape(-1, 2, 2)
    features = both.transpose(2, 0, 1).reshape(-1, 2)  # those of a, then those of b
    stride = int(features[:, 1].max(initial=0)) + 1
    key, feature_row = np.unique(features[:, 0] * stride + features[:, 1], return_inverse=True)
    cones = find_cones(geometry, facets, edges, key // stride, key % stride)
    cone_a, cone_b = feature_row[: len(rows)], feature_row[len(rows) :]
    # all combinations of the pieces of a and b
    owner_a, piece_a = ragged(cones.start, cone_a)
    again, piece_b = ragged(cones.start, cone_b[owner_a])
    owner, piece_a = owner_a[again], piece_a[again]
    normals, count, exact = _pieces_apart(cones, piece_a, piece_b)
    pieces = np.bincount(owner, minlength=len(rows))
    has_one_piece = pieces[owner] == 1
    single = np.flatnonzero(has_one_piece & (count == 1))
    several = np.flatnonzero(has_one_piece & (count > 1))
    accepted, accepted_normals = [owner[single]], [normals[single, 0]]
    inside = np.arange(normals.shape[1]) < count[several][:, None]
    clauses = [(owner[several], count[several], normals[several][inside], exact[several])]
    first = np.searchsorted(owner, np.arange(len(rows) + 1))
    for k in np.flatnonzero(pieces > 1).tolist():
        stop_if_late()
        pairs_of_pieces = [j for j in range(int(first[k]), int(first[k + 1])) if count[j]]
        result = resolve(
            [
                (_rays(cones, piece_a[j]), _rays(cones, piece_b[j]), normals[j, : count[j]])
                for j in pairs_of_pieces
            ]
        )
        accepted.append(np.full(len(result.accepted), k))
        accepted_normals.append(result.accepted)
        length = np.array([len(c) for c in result.clauses], dtype=np.int64)
        stacked = np.concatenate([np.empty((0, 3)), *result.clauses])
        is_exact = np.full(len(length), bool(exact[pairs_of_pieces].all()))
        clauses.append((np.full(len(length), k), length, stacked, is_exact))
    row, length, stacked, is_exact = (np.concatenate([c[i] for c in clauses]) for i in range(4))
    return (
        rows[np.concatenate(accepted)],
        np.concatenate(accepted_normals),
        Clauses(rows[row], starts(length), stacked, is_exact),
    )


def _rays(cones: Cones, piece: int) -> Array:
    """Unit directions that span the convex cone number `piece`."""
    return cones.rays[cones.ray_start[piece] : cones.ray_start[piece + 1]]


def _pieces_apart(cones: Cones, piece_a: Index, piece_b: Index) -> tuple[Array, Index, Mask]:
    """Normals that separate pairs of convex cones, in batches of equal shape."""
    length = np.diff(cones.ray_start)
    key = length[piece_a] * (int(length.max(initial=0)) + 1) + length[piece_b]
    count = np.zeros(len(piece_a), dtype=np.int64)
    exact = np.ones(len(piece_a), dtype=bool)
    normals = np.zeros((len(piece_a), 1, 3))
    for lengths in np.unique(key):
        rows = np.flatnonzero(key == lengths)
        rays = [
            cones.rays[cones.ray_start[piece][:, None] + np.arange(length[piece[0]])]
            for piece in (piece_a[rows], piece_b[rows])
        ]
        found_normals, count[rows], exact[rows] = separating(*rays)
        if found_normals.shape[1] > normals.shape[1]:
            padding = np.zeros((len(normals), found_normals.shape[1] - normals.shape[1], 3))
            normals = np.concatenate([normals, padding], axis=1)
        normals[rows, : found_normals.shape[1]] = found_normals
    return normals, count, exact
