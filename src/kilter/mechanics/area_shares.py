"""Shares of the corners of flat patches in their area: what spreads over it, put at its corners.

Triangles from the mean of the corners to each side tile a convex area; a third of each goes to
each of its three corners, that of the mean to all alike. So the shares are not negative, sum to
the area and have its centroid: a stress that is the same all over the patch does at the corners
what it does on the area.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, across

__all__ = ["area_shares"]


def area_shares(points: Array, patch: Index, normal: Array) -> Array:
    """The area that each corner stands for [length unit^2], shape (K,).

    Parameters
    ----------
    points : ndarray, shape (K, 3)
        Corners of convex areas, those of one patch after each other, in any order.
    patch : ndarray of int, shape (K,)
        The patch of each, 0 to P - 1.
    normal : ndarray, shape (P, 3)
        Unit, of the planes of the patches.

    Examples
    --------
    >>> square = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [2, 2, 0]])
    >>> area_shares(square, np.zeros(4, dtype=int), np.array([[0.0, 0, 1]]))
    array([1., 1., 1., 1.])
    """
    count = np.bincount(patch, minlength=len(normal))
    mean = np.column_stack([np.bincount(patch, x, minlength=len(normal)) for x in points.T])
    arm = points - (mean / np.maximum(count, 1)[:, None])[patch]
    u, v = (along[patch] for along in across(normal))
    x, y = np.einsum("ij,ij->i", arm, u), np.einsum("ij,ij->i", arm, v)
    order = np.lexsort((np.arctan2(y, x), patch))
    start = np.cumsum(count) - count
    after = np.arange(len(points)) + 1
    ends = (start + count)[count > 0] - 1
    after[ends] = start[count > 0]
    x, y = x[order], y[order]
    third = np.maximum(x * y[after] - y * x[after], 0.0) / 6
    of_mean = np.bincount(patch, third, minlength=len(normal)) / np.maximum(count, 1)
    shares = third + of_mean[patch]
    np.add.at(shares, after, third)
    result = np.empty(len(points))
    result[order] = shares
    return result
