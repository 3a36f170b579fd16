"""Bounds of all motions and forces that a proof has not excluded yet, and cones of patch twists.

An *enclosure* holds bounds of every solution (a, f) that a step of a proof considers, with
|a| <= scale and w.a <= scale^2. Motions are in units of the scale, b = a / scale, forces in those
of `kilter.friction.reduced_law`. Contact modes narrow it: a point touches (u_n = 0) or carries no
force (f_n = 0); the twist of a patch is 0 or lies in a cone.

The twist t of a patch is the relative motion of its parts in the plane of contact, in R^d: d = 1 in
the plane, 2 at a single point, 3 at a flat patch in space (two speeds and a spin). It is 0, or lies
in one of the 2^d orthants. A *cone of twists* has d unit generators, the columns of a matrix; the
middle of two generators halves it. Closed cones share their faces, so every t lies in at least one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np

from kilter.arrays import TINY, Array
from kilter.friction.friction_tolerances import CONE_ROUNDING, POINT_AT_REST, WIDEST_SECTOR
from kilter.friction.reduced_law import ReducedLaw

TwistCone = Array
"""A cone of twists: its generators as columns, shape (d, d); `AT_REST` has none."""

AT_REST: TwistCone = np.zeros((0, 0))
"""The cone that contains only the twist 0: the patch sticks."""


@dataclass(frozen=True, slots=True, eq=False)
class Enclosure:
    """Bounds of all remaining solutions (motions and forces) of the contact law."""

    scale: float
    """|a| <= scale [-], and w.a <= scale^2."""
    un: Array
    fn: Array
    """Upper bounds of opening and normal force, which are at least 0, shape (K,)."""
    ut: Array
    """Upper bound of d_k, shape (G, m).ut, in space also of |ut|."""
    slip: Array
    """Upper bound of |ut|, shape (G,)."""
    rest: Array
    """Upper bound of g_k = mu N + d_k, shape (G, m).ft, in space also of mu N."""
    least: Array
    most: Array
    """Bounds of the sum N of the normal forces, shape (G,)."""
    tangents: Array
    """Points c at which tangents bound the ball of accelerations, shape (q, n)."""
    cones: tuple[TwistCone | None, ...]
    """None, or the cone that contains the twist."""
    cuts: bool
    """Whether rows may use the bounds of forces."""


@dataclass(frozen=True, slots=True, eq=False)
class LargestSpeeds:
    """Largest opening and sliding speeds of the contact points in motions of size |b| <= 1."""

    un: Array
    ut: Array
    slip: Array


def largest_speeds(law: ReducedLaw, directions: Array) -> LargestSpeeds:
    """Largest opening and sliding speed of each contact point over all motions of size 1.

    Arguments: `directions` (m, T): the d_k across a contact.
    """
    opening = np.sqrt(np.asarray(law.normal.multiply(law.normal).sum(axis=1)).ravel())
    rows = [law.tangent[k :: law.directions] for k in range(law.directions)]
    gram = np.array([[np.asarray(a.multiply(b).sum(axis=1)).ravel() for a in rows] for b in rows])
    slip = np.sqrt(np.linalg.eigvalsh(gram.transpose(2, 0, 1)).max(axis=1, initial=0.0))
    return LargestSpeeds(opening, np.tile(slip[:, None], len(directions)), slip)


def first_enclosure(
    law: ReducedLaw, fastest: LargestSpeeds, force: Array, tangents: int
) -> Enclosure:
    """Bounds of motions and forces before the first step of a proof.

    Arguments: `force` (K,): upper bounds of the normal forces.
    """
    sides = fastest.ut.shape[1]
    rough = law.group >= 0
    most: Array = np.bincount(law.group[rough], force[rough], minlength=len(law.mu)).astype(float)
    return Enclosure(
        scale=1.0,
        un=fastest.un,
        fn=force,
        ut=fastest.ut,
        slip=fastest.slip,
        rest=np.repeat(2 * law.mu * most, sides).reshape(len(most), sides),
        least=np.zeros(len(most)),
        most=most,
        tangents=np.vstack([law.load / 2, law.load, np.zeros((tangents - 2, len(law.load)))]),
        cones=(None,) * len(law.twist),
        cuts=False,
    )


def rescaled(fastest: LargestSpeeds, bounds: Enclosure, power: float) -> Enclosure:
    """Bounds after scaling to smaller motions, if the power is at most `power`."""
    scale = float(np.sqrt(bounds.scale * max(power, 0.0)))
    if not 0 < scale < bounds.scale:
        return bounds
    ratio = bounds.scale / scale
    return replace(
        bounds,
        scale=scale,
        un=np.minimum(bounds.un * ratio, fastest.un),
        ut=np.minimum(bounds.ut * ratio, fastest.ut),
        slip=np.minimum(bounds.slip * ratio, fastest.slip),
        tangents=bounds.tangents * ratio,
    )


def touching_at(bounds: Enclosure, point: int) -> Enclosure:
    """Bounds of the solutions in which a contact point stays closed: it sticks or slides."""
    un = bounds.un.copy()
    un[point] = 0.0
    return replace(bounds, un=un)


def open_at(bounds: Enclosure, point: int) -> Enclosure:
    """Bounds of the solutions in which a contact point is open: it carries no force."""
    fn = bounds.fn.copy()
    fn[point] = 0.0
    return replace(bounds, fn=fn)


def with_twist_in(law: ReducedLaw, bounds: Enclosure, patch: int, cone: TwistCone) -> Enclosure:
    """Bounds of the solutions in which the relative twist of a patch lies in a cone."""
    cones = tuple(cone if k == patch else old for k, old in enumerate(bounds.cones))
    ut, slip, rest = bounds.ut.copy(), bounds.slip.copy(), bounds.rest.copy()
    members = np.flatnonzero(law.patch == patch)
    if not cone.size:
        ut[members], slip[members] = 0.0, 0.0
    elif law.directions == 1:
        forward = 0 if cone[0, 0] > 0 else 1  # the directions are +1 and -1
        ut[members, 1 - forward] = 0.0
        slip[members] = ut[members, forward]
        rest[members, forward] = 0.0
    return replace(bounds, cones=cones, ut=ut, slip=slip, rest=rest)


def orthants(size: int) -> list[TwistCone]:
    """The 2^d orthants of R^d as cones of twists; together they cover all twists."""
    return [np.diag(signs).astype(np.float64) for signs in product((1, -1), repeat=size)]


def width(cone: TwistCone) -> float:
    """Largest angle between two generators of a cone [rad]; 0 for a single generator."""
    if cone.shape[1] < 2:
        return 0.0
    cosine = np.clip(cone.T @ cone, -1.0, 1.0)
    return float(np.arccos(cosine.min()))


def halves(cone: TwistCone) -> list[TwistCone]:
    """Divide a cone of twists in two at the middle of its two generators that are farthest apart.

    Examples
    --------
    >>> [half.round(3).tolist() for half in halves(np.eye(2))]
    [[[0.707, 0.0], [0.707, 1.0]], [[1.0, 0.707], [0.0, 0.707]]]
    """
    pairs = list(combinations(range(cone.shape[1]), 2))
    i, j = min(pairs, key=lambda pair: float(cone[:, pair[0]] @ cone[:, pair[1]]))
    middle = cone[:, i] + cone[:, j]
    middle = middle / np.linalg.norm(middle)
    cones = []
    for k in (i, j):
        half = cone.copy()
        half[:, k] = middle
        cones.append(half)
    return cones


def cases(law: ReducedLaw, bounds: Enclosure, point: int, patch: int) -> list[Enclosure]:
    """Divide the solutions within bounds into cases of a contact point or of a patch."""
    if point >= 0:
        return [touching_at(bounds, point), open_at(bounds, point)]
    cone = bounds.cones[patch]
    size = law.twist[patch].shape[0]
    cones = halves(cone) if cone is not None else [AT_REST, *orthants(size)]
    return [with_twist_in(law, bounds, patch, cone) for cone in cones]


def widened(cone: TwistCone) -> TwistCone:
    """A slightly wider cone of twists, so that rounding leaves no gap between neighbours."""
    middle = cone.mean(axis=1, keepdims=True)
    wider: TwistCone = cone + CONE_ROUNDING * (cone - middle)
    return wider


def sector(cone: TwistCone, lever: Array) -> tuple[Array, float] | None:
    """Sector of the sliding directions of a point, if the twist of its patch lies in a cone.

    Arguments: `cone` (d, d): not `AT_REST`; `lever` (2, 3): l of the point, ut = L t. Returns (2,):
    middle direction and half width [rad]. None if the point may be at rest, or if the directions
    span more than `WIDEST_SECTOR` of half a turn.
    """
    velocities = lever[:, : len(cone)] @ cone
    speeds = np.linalg.norm(velocities, axis=0)
    if speeds.min() <= POINT_AT_REST * max(float(np.abs(lever).max()), TINY):
        return None
    unit = velocities / speeds
    mean = unit.sum(axis=1)
    if np.linalg.norm(mean) <= POINT_AT_REST:
        return None
    along, across = unit.T @ mean, unit.T @ np.array([-mean[1], mean[0]])
    angle = np.arctan2(across, along)
    low, high = float(angle.min()), float(angle.max())
    if high - low > WIDEST_SECTOR * np.pi:
        return None
    start = float(np.arctan2(mean[1], mean[0])) + (low + high) / 2
    return np.array([np.cos(start), np.sin(start)]), (high - low) / 2 + CONE_ROUNDING
