"""Nearest nonnegative combination of vectors, with the distance that it really has.

`scipy.optimize.nnls` may state the residual 0 for weights that leave a large one, if the vectors
are dependent. So the distance is computed from the weights: it is never below the true distance.
"""

from __future__ import annotations

import numpy as np

from kilter.arrays import Array

AGREES = 1e-9
"""Largest difference between the stated and the true residual, over the size of the target [-]."""


def nonnegative(vectors: Array, target: Array) -> tuple[Array, float]:
    """Weights >= 0 of vectors, (n, d), whose sum is nearest to a target, (d,), and its distance.

    Examples
    --------
    >>> weights, distance = nonnegative(np.array([[1.0, 0.0], [1.0, 1.0]]), np.array([1.0, -2.0]))
    >>> weights.round(9).tolist(), round(distance, 9)
    ([1.0, 0.0], 2.0)
    """
    if not len(vectors):
        return np.zeros(0), float(np.linalg.norm(target))
    # imported late, since the import of scipy.optimize is slow
    from scipy.optimize import lsq_linear, nnls

    tries: list[Array] = []
    try:
        weights, stated = nnls(vectors.T, target)
        tries.append(weights)
    except RuntimeError:  # nnls reached its iteration limit
        stated = -1.0
    if not tries or abs(_distance(vectors, target, tries[0]) - stated) > AGREES * np.linalg.norm(
        target
    ):
        found = lsq_linear(vectors.T, target, (0.0, np.inf), method="bvls")
        tries.append(np.maximum(found.x, 0.0))
    best = min(tries, key=lambda weights: _distance(vectors, target, weights))
    return best, _distance(vectors, target, best)


def _distance(vectors: Array, target: Array, weights: Array) -> float:
    """Distance of a sum of weighted vectors from a target."""
    return float(np.linalg.norm(weights @ vectors - target))
