"""The spanning rule: which normals a point of contact has, and which points have no one normal.

K_A, K_B: the cones of parts a and b at p (`cones`), whose insides are apart. To first order
a velocity v of b relative to a at p makes them enter each other iff v is in

    D = int K_A - int K_B.

So n is a constraint v.n >= 0 of every motion iff D holds all of {v.n < 0}. With S_A the
directions of the plane n.d = 0 with material of a just below it, and S_B those with material
of b just above, that is so iff S_A - S_B is the whole plane: p is accepted with n.

For convex pieces P of K_A and Q of K_B, D is the union of the int P - int Q, and each of
these is {v.m < 0 for every m of N}, N = the extreme directions of the cone of normals that
separate P from Q. One such m: a constraint. Several: v.m >= 0 for at least one of them, a
clause. Clauses that the accepted constraints at p do not imply make p degenerate: a
velocity stays that meets all of these and penetrates, and the motions that are allowed are
a union (Palmer; the paper, section 1.1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Index, Mask, across, ratio
from kilter.contact.contact_tolerances import CONE_ANGLE, CUT_COSINE, LITERAL_ANGLE, NORMAL_ANGLE
from kilter.contact.sharp.local_cones import spanned

__all__ = ["Resolved", "distinct", "resolve", "separating", "spans"]


BATCH = 2_000_000
"""Candidates compared in one go."""


def separating(rays_a: Array, rays_b: Array) -> tuple[Array, Index, Mask]:
    """Extreme normals that separate convex cones, from a to b.

    Parameters
    ----------
    rays_a, rays_b : ndarray, shape (n, p, 3) and (n, q, 3)
        Directions that span the cones of n pairs.

    Returns
    -------
    normals : ndarray, shape (n, k, 3)
    count : ndarray of int, shape (n,)
        How many of them each pair has; none: the cones enter each other.
    exact : ndarray of bool, shape (n,)
        Whether they are the same where the directions are taken at their word.

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
        some, number, sure = _separating(rays_a[rows], rays_b[rows])
        if some.shape[1] > normals.shape[1]:
            more = np.zeros((len(normals), some.shape[1] - normals.shape[1], 3))
            normals = np.concatenate([normals, more], axis=1)
        normals[rows, : some.shape[1]] = some
        count[rows], exact[rows] = number, sure
    return normals, count, exact


def _separating(rays_a: Array, rays_b: Array) -> tuple[Array, Index, Mask]:
    ahead = np.concatenate([-rays_a, rays_b], axis=1)  # a normal has all of these ahead
    i, j = np.triu_indices(ahead.shape[1], 1)
    lines = np.cross(ahead[:, i], ahead[:, j])
    sine = np.linalg.norm(lines, axis=2)
    lines = ratio(lines, sine[..., None])
    rise = np.einsum("nci,nki->nck", lines, ahead)
    lowest, highest = rise.min(axis=2), rise.max(axis=2)
    lines, sine = np.concatenate([lines, -lines], axis=1), np.concatenate([sine, sine], axis=1)
    lowest = np.concatenate([lowest, -highest], axis=1)
    loose = (lowest >= -CONE_ANGLE) & (sine > CONE_ANGLE)
    normals, count = _clusters(lines, loose, sine)
    exact = np.ones(len(normals), dtype=bool)
    several = np.flatnonzero(count > 1)
    tight = ((lowest >= -LITERAL_ANGLE) & (sine > LITERAL_ANGLE))[several]
    for k in range(int(count.max(initial=0))):
        near = np.linalg.norm(lines[several] - normals[several, k, None], axis=2) <= NORMAL_ANGLE
        found = (near & tight).any(axis=1)
        exact[several] &= found | (k >= count[several])
    return normals, count, exact


def _clusters(candidates: Array, valid: Mask, weight: Array) -> tuple[Array, Index]:
    """The valid candidates that differ, the one of greatest weight of each group."""
    most = int(valid.sum(axis=1).max(initial=0))
    order = np.argsort(np.where(valid, -weight, np.inf), axis=1, kind="stable")[:, :most]
    candidates = np.take_along_axis(candidates, order[..., None], axis=1)
    left = np.take_along_axis(valid, order, axis=1)
    normals = np.zeros((len(candidates), 1, 3))
    count = np.zeros(len(candidates), dtype=np.int64)
    rows = np.arange(len(candidates))
    while left.any():
        some = left.any(axis=1)
        chosen = candidates[rows, left.argmax(axis=1)]
        if count.max() == normals.shape[1]:
            normals = np.concatenate([normals, np.zeros((len(rows), 1, 3))], axis=1)
        normals[rows[some], count[some]] = chosen[some]
        count[some] += 1
        left &= np.linalg.norm(candidates - chosen[:, None], axis=2) > NORMAL_ANGLE
    return normals, count


# points where parts have several convex pieces -------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Resolved:
    """Accepted normals, shape (k, 3), and clauses that they do not imply, shape (m, 3) each."""

    accepted: Array
    clauses: list[Array]


def resolve(pairs: list[tuple[Array, Array, Array]]) -> Resolved:
    """What holds at a point, from the pairs of pieces there.

    Parameters
    ----------
    pairs : list of (rays_a, rays_b, normals)
        Directions that span a piece of a and one of b, and their extreme separating normals.
    """
    sets = [normals for _, _, normals in pairs]
    accepted = distinct([n[0] for n in sets if len(n) == 1])
    clauses = [n for n in sets if len(n) > 1]
    for normal in distinct([n for clause in clauses for n in clause]):
        if not _among(normal, accepted) and spans(normal, pairs):
            accepted = np.vstack([accepted, normal])
    kept: list[Array] = []
    for clause in sorted(clauses, key=len):
        if any(_among(n, accepted) for n in clause) or _implied(clause, accepted):
            continue
        if not any(all(_among(n, clause) for n in other) for other in kept):
            kept.append(clause)
    return Resolved(accepted, kept)


def distinct(normals: list[Array]) -> Array:
    """The normals that differ, shape (k, 3)."""
    kept: list[Array] = []
    for normal in normals:
        if not any(float(np.linalg.norm(normal - other)) <= NORMAL_ANGLE for other in kept):
            kept.append(normal)
    return np.array(kept).reshape(-1, 3)


def _among(normal: Array, normals: Array) -> bool:
    return bool((np.linalg.norm(normals - normal, axis=1) <= NORMAL_ANGLE).any())


def _implied(clause: Array, accepted: Array) -> bool:
    """No v with v.m < 0 for all m of the clause and v.n >= 0 for all accepted n."""
    if not len(accepted):
        return False
    allowed = spanned(np.vstack([clause, -accepted]))
    if not len(allowed):
        return True
    return bool((clause @ allowed.sum(axis=0)).max() > -CONE_ANGLE)


def spans(normal: Array, pairs: list[tuple[Array, Array, Array]]) -> bool:
    """Whether S_A - S_B is the whole plane across `normal`, piece by piece.

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
        below, above = _trace(rays_a, -normal), _trace(rays_b, normal)
        if below is None or above is None:
            continue
        arc = _arc(np.vstack([below, -above]) @ axes)
        if arc is not None:
            arcs.append(arc)
    return _cover(arcs)


def _trace(rays: Array, side: Array) -> Array | None:
    """In-plane directions that span what the plane cuts from a cone with material on a side."""
    height = rays @ side
    if height.max() <= CUT_COSINE:
        return None
    level = rays[np.abs(height) <= CUT_COSINE]
    over, under = np.flatnonzero(height > CUT_COSINE), np.flatnonzero(height < -CUT_COSINE)
    cut = (
        height[over][:, None, None] * rays[under][None]
        - height[under][None, :, None] * (rays[over][:, None])
    )
    return np.vstack([level, cut.reshape(-1, 3)])


def _arc(directions: Array) -> tuple[float, float] | None:
    """The cone in the plane that directions span: first angle and width."""
    size = np.linalg.norm(directions, axis=1)
    directions = directions[size > CUT_COSINE]
    if not len(directions):
        return None
    angle = np.sort(np.arctan2(directions[:, 1], directions[:, 0]))
    gap = np.diff(np.append(angle, angle[0] + 2 * np.pi))
    widest = int(gap.argmax())
    if gap[widest] < np.pi - CUT_COSINE:
        return float(angle[0]), 2 * np.pi
    return float(angle[(widest + 1) % len(angle)]), float(2 * np.pi - gap[widest])


def _cover(arcs: list[tuple[float, float]]) -> bool:
    """Whether closed arcs cover the circle."""
    ends = np.sort(np.array([x % (2 * np.pi) for a, w in arcs for x in (a, a + w)]))
    if not len(ends):
        return False
    following = np.append(ends[1:], ends[0] + 2 * np.pi)
    middle = ((ends + following) / 2)[following - ends > CUT_COSINE]
    return all(any((x - a) % (2 * np.pi) <= w for a, w in arcs) for x in middle.tolist())
