"""Distances from cones of vectors are those of their weights, also for dependent vectors."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import nnls

from kilter.mechanics.nonnegative import nonnegative


def test_the_distance_is_that_of_the_weights() -> None:
    """The nearest point is half of (0, -1, 1, 0); the residual that `nnls` states is shorter."""
    vectors = np.array([[0.0, -1, 1, 0], [0, -1, 1, 0], [0, -1, 1, 1]])
    target = np.array([2.0, -2, -1, 0])
    weights, distance = nonnegative(vectors, target)
    assert distance == pytest.approx(np.sqrt(9 - 1 / 2), rel=1e-12)
    assert weights @ vectors == pytest.approx([0, -0.5, 0.5, 0], abs=1e-12)
    assert nnls(vectors.T, target)[1] <= distance + 1e-12


@pytest.mark.parametrize("seed", range(3))
def test_no_vector_leads_nearer(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for _ in range(30):
        vectors = rng.integers(-1, 2, size=rng.integers(2, [40, 8])).astype(float)
        vectors = np.vstack([vectors, -vectors[: len(vectors) // 2]])
        target = rng.integers(-2, 3, size=vectors.shape[1]).astype(float)
        weights, distance = nonnegative(vectors, target)
        left = target - weights @ vectors
        assert weights.min() >= 0
        assert np.linalg.norm(left) == pytest.approx(distance, abs=1e-12)
        assert (vectors @ left).max() <= 1e-7
