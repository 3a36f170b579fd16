"""Share of the area of a flat convex patch that each of its corners represents.

Triangles from the mean of the corners to each side tile the area. A third of each triangle
belongs to each of its three vertices, and the third of the mean is distributed equally over all
corners. So the shares are not negative, their sum is the area, and their centroid is that of the
area: point forces in these proportions are equivalent to a uniform stress on the patch.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array, Index, across


def area_shares(points: Array, patch: Index, normal: Array) -> Array:
    """Area of the patch that each of its corner points represents [length unit^2], shape (K,).

    Arguments: `points` (K, 3); `patch` (K,); `normal` (P, 3).

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
    next_corner = np.arange(len(points)) + 1
    ends = (start + count)[count > 0] - 1
    next_corner[ends] = start[count > 0]
    x, y = x[order], y[order]
    # the product is twice the area of a triangle, so a sixth of it is a third of the area
    triangle_third = np.maximum(x * y[next_corner] - y * x[next_corner], 0.0) / 6
    of_mean = np.bincount(patch, triangle_third, minlength=len(normal)) / np.maximum(count, 1)
    shares = triangle_third + of_mean[patch]
    np.add.at(shares, next_corner, triangle_third)
    result = np.empty(len(points))
    result[order] = shares
    return result
