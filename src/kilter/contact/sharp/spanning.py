"""Decide which normals a contact point has, from the material of both parts around it.

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
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across, ratio
from kilter.contact.contact_tolerances import CONE_ANGLE, CUT_COSINE, LITERAL_ANGLE, NORMAL_ANGLE
from kilter.contact.sharp.local_cones import spanned

__all__ = ["PointConstraints", "distinct", "resolve", "separating", "spans"]


BATCH = 2_000_000
"""Candidates compared at once; a larger value needs more memory."""


def separating(rays_a: Array, rays_b: Array) -> tuple[Array, Index, Mask]:
    """Extreme normals, from a to b, of the planes that separate two convex cones.

    Parameters
    ----------
    rays_a, rays_b : ndarray, shape (n, p, 3) and (n, q, 3)
        Unit directions that span the cones of n pairs.

    Returns
    -------
    normals : ndarray, shape (n, k, 3)
    count : ndarray of int, shape (n,)
        Number of normals of each pair; 0: the cones penetrate each other.
    exact : ndarray of bool, shape (n,)
        True if the literal directions, without tolerance, give the same normals.

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
    """Certain normals of a contact point, and sets of normals of which at least one applies.

    Attributes
    ----------
    accepted : ndarray, shape (k, 3)
        Unit normals along which every motion must open or keep the gap.
    clauses : list of ndarray, shape (m, 3) each
        A motion may close some normals of a set, but not all of them.
    """

    accepted: Array
    clauses: list[Array]


def resolve(pairs: list[tuple[Array, Array, Array]]) -> PointConstraints:
    """Find the certain normals of a contact point, and sets of which at least one normal applies.

    Parameters
    ----------
    pairs : list of (rays_a, rays_b, normals)
        Directions that span a piece of a and a piece of b, and their extreme separating normals.
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
