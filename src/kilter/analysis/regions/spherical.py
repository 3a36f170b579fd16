"""Cones from both sides: extreme rays of {n.g <= 0}, and facets of sums of rays."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from kilter.arrays import Array

__all__ = ["cone_around", "edges_of", "extreme_rays"]


ON = 1e-9
"""A unit vector is on a plane up to this sine."""
SAME = 1e-7
"""Unit vectors nearer than this are the same."""
PARALLEL = 1e-9
"""Two planes with a smaller sine between them have no line in common."""


def _distinct(vectors: Array, apart: float = SAME) -> Array:
    """The first of each group of vectors that are the same."""
    kept: list[Array] = []
    for vector in vectors:
        if not kept or np.linalg.norm(np.array(kept) - vector, axis=1).min() > apart:
            kept.append(vector)
    return np.array(kept).reshape(-1, 3)


def extreme_rays(normals: Array) -> Array:
    """Unit rays in which the planes n.g = 0, x = 0, y = 0, z = 0 meet, and all n.g <= 0.

    Parameters
    ----------
    normals : ndarray, shape (f, 3)
        Outward, unit. The coordinate planes divide the cone, whatever its kind, into pieces
        with a tip.

    Returns
    -------
    ndarray, shape (v, 3)

    Examples
    --------
    >>> len(extreme_rays(np.empty((0, 3)))), len(extreme_rays(-np.eye(3)))
    (6, 3)
    """
    planes = np.vstack([normals, np.eye(3)])
    i, j = np.triu_indices(len(planes), 1)
    lines = np.cross(planes[i], planes[j])
    length = np.linalg.norm(lines, axis=1)
    lines = lines[length > PARALLEL] / length[length > PARALLEL][:, None]
    both = np.vstack([lines, -lines])
    inside = (both @ normals.T <= ON).all(axis=1)
    return _distinct(both[inside])


def edges_of(normals: Array, rays: Array) -> Iterator[tuple[int, int, float]]:
    """Neighbouring rays on each facet, by position, and half the angle between them [rad]."""
    for normal in normals:
        on = np.flatnonzero(np.abs(rays @ normal) <= 2 * SAME)
        if len(on) < 2:
            continue
        side = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
        angle = np.arctan2(rays[on] @ np.cross(normal, side), rays[on] @ side)
        order = np.argsort(angle)
        following = np.roll(order, -1)
        for one, other in zip(order, following, strict=True):
            apart = (angle[other] - angle[one]) % (2 * np.pi)
            if apart <= np.pi / 2 + SAME:  # else what is between is not of the cone
                yield int(on[one]), int(on[other]), 0.5 * float(apart)


def cone_around(rays: Array, blur: float) -> tuple[Array, Array]:
    """Equations and unit inward facets of all sums of some rays.

    Parameters
    ----------
    rays : ndarray, shape (r, 3)
        Unit.
    blur : float
        Rays nearer to a plane than this are on it [rad].

    Examples
    --------
    >>> equations, facets = cone_around(np.eye(3), 1e-9)
    >>> len(equations), (facets[facets.argmax(axis=1).argsort()] + 0.0).tolist()
    (0, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    """
    if not len(rays):
        return np.eye(3), np.empty((0, 3))
    _, size, basis = np.linalg.svd(np.vstack([rays, np.zeros((3, 3))]), full_matrices=False)
    rank = int((size > blur).sum())
    equations = basis[rank:]
    if rank == 1:
        alone = bool((rays @ rays[0] > 0).all())
        return equations, rays[:1] if alone else np.empty((0, 3))
    if rank == 2:
        candidates = np.cross(equations[0], rays)
    else:
        i, j = np.triu_indices(len(rays), 1)
        candidates = np.cross(rays[i], rays[j])
    length = np.linalg.norm(candidates, axis=1)
    candidates = candidates[length > PARALLEL] / length[length > PARALLEL][:, None]
    both = np.vstack([candidates, -candidates])
    facets = both[(both @ rays.T >= -blur).all(axis=1)]
    return equations, _distinct(facets, np.sqrt(blur))
