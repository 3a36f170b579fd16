"""Null spaces of matrices of contact rows, up to the rounding of their numbers."""

from __future__ import annotations

import numpy as np

from kilter.arrays import TINY, Array


def null_space(rows: Array, blur: float) -> Array:
    """Orthonormal basis, (n, d), of the vectors that a matrix (K, n) maps to 0 up to rounding.

    Singular values below `blur` times the largest count as zero.

    Examples
    --------
    >>> null_space(np.array([[1.0, 0, 0], [2, 0, 0]]), 1e-9).shape
    (3, 2)
    """
    count = rows.shape[1]
    if not len(rows) or not count:
        return np.eye(count)
    if len(rows) > count:
        rows = np.asarray(np.linalg.qr(rows, mode="r"))
    _, values, right = np.linalg.svd(rows)
    rank = int((values > blur * max(values.max(initial=0.0), TINY)).sum())
    return np.ascontiguousarray(right[rank:].T)
