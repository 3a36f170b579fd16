"""Extreme rays of a cone from its facets, and facets of a cone from its rays, in R^3.

    extreme rays      lines in which two planes meet, inside all of them
    facets            planes through two rays, with all other rays on a single side

Rays are known up to a width (`blur`): those that lie on a plane up to it are on it, planes that
hold the same rays are a single facet, fitted to all of them, and if a plane holds all rays
the cone is as thin as that plane.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from kilter.analysis.analysis_tolerances import NARROW, ON_PLANE, PARALLEL_PLANES, POINTED, SAME_RAY
from kilter.analysis.regions.polyhedral_cone import Cone, make_cone
from kilter.arrays import Array, Index, Mask, across, cross, unit_rows


def distinct(vectors: Array, apart: float = SAME_RAY) -> Array:
    """The first of each group of vectors that are equal within `apart`, shape (n, 3)."""
    kept: list[Array] = []
    for vector in vectors:
        if not kept or np.linalg.norm(np.array(kept) - vector, axis=1).min() > apart:
            kept.append(vector)
    return np.array(kept).reshape(-1, 3)


def extreme_rays(normals: Array) -> Array:
    """Unit extreme rays of the cone {n.g <= 0}, cut by the three coordinate planes.

    Arguments: `normals` (f, 3). Returns (v, 3).

    Examples
    --------
    >>> len(extreme_rays(np.empty((0, 3)))), len(extreme_rays(-np.eye(3)))
    (6, 3)
    """
    lines = _across_pairs(np.vstack([normals, np.eye(3)]), PARALLEL_PLANES)
    inside = (lines @ normals.T <= ON_PLANE).all(axis=1)
    return distinct(lines[inside])


def edges_of(normals: Array, rays: Array) -> Iterator[tuple[int, int, float]]:
    """Yield two neighbouring rays of a facet, by index, and half the angle between them [rad]."""
    for normal in normals:
        on = np.flatnonzero(np.abs(rays @ normal) <= 2 * SAME_RAY)
        if len(on) < 2:
            continue
        side = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        angle = np.arctan2(rays[on] @ np.cross(normal, side), rays[on] @ side)
        order = np.argsort(angle)
        following = np.roll(order, -1)
        for first, other in zip(order, following, strict=True):
            apart = (angle[other] - angle[first]) % (2 * np.pi)
            if apart <= np.pi / 2 + SAME_RAY:  # else what is between is not of the cone
                yield int(on[first]), int(on[other]), 0.5 * float(apart)


def cone_around(rays: Array, blur: float) -> Cone:
    """The cone of all nonnegative combinations of given rays, with its facets.

    Arguments: `rays` (r, 3): unit; `blur`: rays nearer to a plane than this lie on it, and nearer
    rays are the same ray [rad].

    Examples
    --------
    >>> cone_around(np.eye(3), 1e-9).kind, cone_around(np.empty((0, 3)), 1e-9).kind
    ('cone', 'none')
    >>> almost = [[1, 0, 0], [0.6, 0.8, 0], [0.8, 0.6, 1e-7]]
    >>> cone_around(np.array(almost), 1e-6).kind, cone_around(np.array(almost), 1e-9).kind
    ('fan', 'cone')
    """
    rays = distinct(rays, blur)
    basis = np.linalg.svd(np.vstack([rays, np.zeros((3, 3))]))[2] if len(rays) else np.eye(3)
    rank = 3 if len(rays) else 0
    while rank and np.abs(rays @ basis[rank - 1]).max() <= blur:
        rank -= 1
    normals, tight = np.empty((0, rank)), np.empty((0, len(rays)), dtype=bool)
    while rank:
        normals, tight = facets_of(unit_rows(rays @ basis[:rank].T), blur)
        flat = np.flatnonzero(tight.all(axis=1))
        if not len(flat):
            break
        # one plane holds all of them: its normal is an equation
        turn = np.linalg.svd(normals[flat[:1]])[2]
        basis = np.vstack([np.roll(turn, -1, axis=0) @ basis[:rank], basis[rank:]])
        rank -= 1
    cone = make_cone(basis[rank:], normals @ basis[:rank], rays, blur)
    return replace(cone, strict=True)


def facets_of(points: Array, blur: float) -> tuple[Array, Mask]:
    """Inward facet normals of the cone of unit points in R^D, and the points on each facet.

    D is 1, 2 or 3.

    Unit inward normals, shape (F, D), and which points lie on each, shape (F, n). Planes through
    the same points, within `blur`, are replaced by a plane that is fitted to these points. A plane
    whose points all lie on another plane is not a facet.
    """
    normals = _across_pairs(points, blur)
    products = normals @ points.T
    keep = products.min(axis=1) >= -blur
    tight = np.unique(np.abs(products[keep]) <= blur, axis=0)
    common = tight.astype(np.int64) @ tight.T.astype(np.int64)
    size = np.diag(common)
    within = (common == size[:, None]) & (size[None, :] > size[:, None])
    tight = tight[~within.any(axis=1)]
    fitted = [_fit(points, row) for row in tight]
    return np.array(fitted).reshape(-1, points.shape[1]), tight


def _across_pairs(points: Array, least: float) -> Array:
    """Unit normals, with both signs, of all planes through 0 and D - 1 of the points.

    Points closer than `least` give no plane.
    """
    dimension = points.shape[1]
    if dimension == 1:
        return np.array([[1.0], [-1.0]])
    if dimension == 2:
        normals = np.column_stack([-points[:, 1], points[:, 0]])
    else:
        i, j = np.triu_indices(len(points), 1)
        normals = cross(points[i], points[j])
    length = np.linalg.norm(normals, axis=1)
    normals = normals[length > least] / length[length > least, None]
    return np.vstack([normals, -normals])


def _fit(points: Array, tight: Mask) -> Array:
    """Inward normal of the plane through the points `tight`, fitted by least squares."""
    dimension = points.shape[1]
    chosen = np.vstack([points[tight], np.zeros((dimension, dimension))])
    normal: Array = np.linalg.svd(chosen)[2][-1]
    side = float((points @ normal).sum())
    return normal if side > 0 else -normal


# The pointed cone that known rays span in space: its extreme rays, and distances to it.


@dataclass(frozen=True, slots=True, eq=False)
class InnerHull:
    """A pointed cone in space by its extreme rays, in order around it."""

    rays: Array
    """Unit, shape (h, 3)."""
    number: Index
    """Index of each among the given rays, shape (h,)."""
    normals: Array
    """Unit inward normals of the planes through each ray and the next, shape (h, 3)."""

    def distances(self, directions: Array) -> Array:
        """Angle from each unit direction, shape (D, 3), to the cone [rad], shape (D,).

        Examples
        --------
        >>> hull = inner_hull(np.eye(3), np.ones(3) / np.sqrt(3))
        >>> np.degrees(hull.distances(np.array([[1, 1, 1], [0, 1, -1], [-1, 0, 1]]) / 2**0.5))
        array([ 0., 45., 45.])
        """
        if not len(directions):
            return np.zeros(0)
        following = np.roll(self.rays, -1, axis=0)
        inside = directions @ self.normals.T
        chords = np.linalg.norm(directions[:, None] - self.rays, axis=2)
        angle = 2 * np.arcsin(np.minimum(chords / 2, 1.0)).min(axis=1)
        beside = (
            (inside < 0)
            & (directions @ cross(self.normals, self.rays).T >= 0)
            & (directions @ cross(self.normals, following).T <= 0)
            & (directions @ (self.rays + following).T > 0)
        )
        arcs = np.where(beside, np.arcsin(np.clip(-inside, 0.0, 1.0)), np.inf).min(axis=1)
        nearest: Array = np.where((inside >= 0).all(axis=1), 0.0, np.minimum(angle, arcs))
        return nearest


def inner_hull(rays: Array, axis: Array) -> InnerHull | None:
    """The cone that rays span; None if it is no pointed cone with width about an axis.

    Arguments: `rays` (r, 3): unit; `axis` (3,): unit; all rays of a pointed cone may lie on its
    side.
    """
    from scipy.spatial import ConvexHull, QhullError

    if len(rays) < 3 or float((rays @ axis).min()) < POINTED:
        return None
    u, v = across(axis)
    flat = np.column_stack([rays @ u, rays @ v]) / (rays @ axis)[:, None]
    try:
        number = ConvexHull(flat).vertices.astype(np.int64)
    except QhullError:
        return None
    chosen = rays[number]
    normals = unit_rows(cross(chosen, np.roll(chosen, -1, axis=0)))
    middle = unit_rows(chosen.sum(axis=0))
    depth = normals @ middle
    normals = normals * np.sign(depth)[:, None]
    if float(np.abs(depth).min()) < NARROW:
        return None
    return InnerHull(chosen, number, normals)
