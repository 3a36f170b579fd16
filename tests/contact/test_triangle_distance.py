"""Distances of points from triangles, compared with the distance from each triangle in turn."""

from __future__ import annotations

import numpy as np
import pytest

from kilter.arrays import Array
from kilter.contact.common.distances import TriangleTrees, surface_distance


def _scene(seed: int) -> tuple[Array, Array]:
    """Random points, and triangles whose sizes differ by a factor of up to 10,000."""
    rng = np.random.default_rng(seed)
    count, number = rng.integers(1, 60, 2)
    size = 10.0 ** rng.uniform(-4, 0, (number, 1, 1))
    triangles = rng.normal(size=(number, 3, 3)) * size + rng.normal(size=(number, 1, 3))
    return 2 * rng.normal(size=(count, 3)), triangles


def _least_by_sampling(point: Array, triangle: Array) -> float:
    """Distance of a point from a triangle by a search over its barycentric coordinates."""
    low, step = np.zeros(2), 1.0
    for _ in range(60):
        grid = low + step * np.stack(np.meshgrid(*[np.linspace(-1, 1, 9)] * 2), -1).reshape(-1, 2)
        grid = grid[(grid >= 0).all(axis=1) & (grid.sum(axis=1) <= 1)]
        places = triangle[0] + grid @ (triangle[1:] - triangle[0])
        off = np.linalg.norm(places - point, axis=1)
        low, step = grid[off.argmin()], step * 0.7
    return float(off.min())


@pytest.mark.quick(6)
@pytest.mark.parametrize("seed", range(20))
def test_the_nearest_of_all_triangles_counts(seed: int) -> None:
    points, triangles = _scene(seed)
    each = np.array([surface_distance(points, triangle[None]) for triangle in triangles])
    assert surface_distance(points, triangles) == pytest.approx(each.min(axis=0), rel=1e-14)


def test_the_distance_from_a_triangle_agrees_with_a_search_over_its_points() -> None:
    points, triangles = _scene(3)
    for point, triangle in zip(points[:12], triangles[:12], strict=False):
        exact = surface_distance(point[None], triangle[None])[0]
        assert exact == pytest.approx(_least_by_sampling(point, triangle), rel=1e-6)


@pytest.mark.parametrize("seed", range(20))
def test_points_within_a_distance_agree_with_the_distances(seed: int) -> None:
    points, triangles = _scene(seed)
    distance = surface_distance(points, triangles)
    for reach in np.quantile(distance, [0.0, 0.3, 0.8]).tolist():
        clear = np.abs(distance - reach) > 1e-12
        within = TriangleTrees(triangles).within(points, reach)
        assert (within == (distance <= reach))[clear].all()


def test_an_upper_bound_is_never_exceeded() -> None:
    points, triangles = _scene(5)
    bound = np.full(len(points), 0.1)
    distance = surface_distance(points, triangles, bound)
    assert distance == pytest.approx(np.minimum(surface_distance(points, triangles), 0.1))
