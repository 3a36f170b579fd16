"""The loop that finds a convex set through an oracle, and its hull."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from kilter.analysis.regions.enclose import KnownSet, SupportPoint, nearest_face
from kilter.analysis.regions.growing_hull import GrowingHull

KINDS = ("scattered", "on a box", "on a sphere", "on a long box")


def points_of(kind: str, dimension: int, seed: int) -> np.ndarray:
    """Points whose hull has facets in general position, or many of them nearly in a plane."""
    random = np.random.default_rng(seed)
    points = random.normal(size=(40, dimension))
    if kind == "on a sphere":
        points /= np.linalg.norm(points, axis=1)[:, None]
    elif kind != "scattered":
        points /= np.abs(points).max(axis=1)[:, None]
        points *= 1 + 1e-8 * random.normal(size=(40, 1))
    if kind == "on a long box":
        points[:, 0] *= 1e6
    return points


@pytest.mark.quick(1)
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_the_hull_is_that_of_qhull(kind: str, dimension: int) -> None:
    for seed in range(10):
        points = points_of(kind, dimension, seed)
        hull, other = GrowingHull.of(points, 1e-10), ConvexHull(points)
        assert hull is not None
        nearest = -float(other.equations[:, -1].max())
        assert hull.offsets.min() == pytest.approx(nearest, rel=1e-7, abs=1e-9)
        beyond = (points @ hull.normals.T - hull.offsets).max()
        assert beyond <= 1e-9 * np.abs(points).max()


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_flat_points_have_no_hull(dimension: int) -> None:
    flat = np.zeros((5, dimension))
    flat[:, : dimension - 1] = np.random.default_rng(0).normal(size=(5, dimension - 1))
    assert GrowingHull.of(flat, 1e-9) is None
    assert GrowingHull.of(np.empty((0, dimension)), 1e-9) is None


def ellipsoid(axes: np.ndarray, failing: int = -1):
    """The oracle of an ellipsoid around 0; it fails at one question."""
    asked = [0]

    def oracle(direction: np.ndarray) -> SupportPoint | None:
        asked[0] += 1
        if asked[0] == failing + 1:
            return None
        point = direction / np.linalg.norm(direction / axes)
        normal = point / axes**2
        normal /= np.linalg.norm(normal)
        return SupportPoint(point, normal, float(normal @ point))

    return oracle


def axes_and_back(dimension: int) -> np.ndarray:
    return np.vstack([np.eye(dimension), -np.eye(dimension)])


@pytest.mark.parametrize("dimension", [1, 2, 3])
def test_the_nearest_boundary_from_both_sides(dimension: int) -> None:
    axes = np.array([1.5, 1.0, 4.0])[:dimension]
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(dimension, dimension)))[0]
    inside = ellipsoid(axes)

    def turned(direction: np.ndarray) -> SupportPoint:
        found = inside(turn.T @ direction)
        return SupportPoint(turn @ found.point, turn @ found.normal, found.reach)

    face = nearest_face(turned, axes_and_back(dimension), agree=1e-4, limit=500)
    least = axes.min()
    assert face.inner <= least + 1e-12
    assert face.outer >= least - 1e-12
    assert face.inner >= face.outer * (1 - 1e-4)
    assert not face.failed


@pytest.mark.parametrize("failing", [0, 3, 8])
def test_a_failed_answer_is_said_and_nothing_breaks(failing: int) -> None:
    oracle = ellipsoid(np.array([1.5, 1.0, 4.0]), failing)
    face = nearest_face(oracle, axes_and_back(3), agree=1e-4, limit=200)
    if failing == 0:
        assert face is None
    else:
        assert face.failed
        assert face.inner <= 1.0 + 1e-12 <= face.outer + 2e-12


def test_a_set_that_is_flat_has_its_boundary_at_0() -> None:
    def segment(direction: np.ndarray) -> SupportPoint:
        along = abs(float(direction[0])) > 1 - 1e-12
        if along:
            return SupportPoint(direction, direction, 1.0)
        return SupportPoint(np.zeros(2), np.array([0.0, np.sign(direction[1])]), 0.0)

    face = nearest_face(segment, axes_and_back(2), agree=1e-6, limit=50)
    assert (face.inner, face.outer) == (0.0, 0.0)


def test_a_difference_that_counts_as_none_ends_it_sooner() -> None:
    oracle = ellipsoid(np.array([1.5, 1.0, 4.0]))
    near, exact = (
        nearest_face(oracle, axes_and_back(3), agree=1e-6, limit=500, within=within)
        for within in (1e-2, 0.0)
    )
    assert near.asked < exact.asked
    assert near.outer - 1e-2 <= near.inner <= 1.0 + 1e-12 <= near.outer + 2e-12


def test_every_facet_of_a_polytope_is_settled() -> None:
    corners = np.random.default_rng(4).normal(size=(30, 3))

    def support(direction: np.ndarray) -> SupportPoint:
        far = int((corners @ direction).argmax())
        return SupportPoint(corners[far], direction, float(corners[far] @ direction))

    known = KnownSet(support, GrowingHull.of(corners[:8], 1e-12))
    while not known.hull.done.all():
        known.settle(int(known.hull.done.argmin()))
    assert len(known.hull.facets) == len(ConvexHull(corners).simplices)
