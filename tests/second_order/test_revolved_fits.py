"""Bodies that enclose each other and can only turn: their common surface of revolution."""

from __future__ import annotations

import numpy as np
import pytest

from kilter.arrays import Array
from kilter.second_order.gaps.fits import _revolved_surface
from kilter.second_order.gaps.touched_surfaces import LINE


def rings(rng: np.random.Generator, tilts: list[float], pitch: float = 0.0) -> tuple[Array, Array]:
    """Points and normals on rings about z, whose normals lean from the horizontal by `tilts`."""
    points, normals = [], []
    for k, tilt in enumerate(tilts):
        for angle in rng.uniform(0, 2 * np.pi, 3) + np.array([0, 2, 4]):
            away = np.array([np.cos(angle), np.sin(angle), 0.0])
            around = np.array([-np.sin(angle), np.cos(angle), 0.0])
            normal = np.cos(tilt) * away + np.sin(tilt) * np.array([0, 0, 1.0]) + pitch * around
            points.append((2.0 + 0.1 * k) * away + [0, 0, 0.5 * k])
            normals.append(normal / np.linalg.norm(normal))
    return np.array(points), np.array(normals)


@pytest.mark.parametrize("seed", range(4))
def test_the_axis_and_the_curvature_of_a_thread_of_rings(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    shift = rng.normal(size=3)
    tilts = [0.5, -0.5, 0.5]
    points, normals = rings(rng, tilts)
    found = _revolved_surface(points @ turn.T + shift, normals @ turn.T)
    assert found is not None
    kind, place, axis, curvature = found
    assert kind == LINE
    assert abs(axis @ turn[:, 2]) == pytest.approx(1.0, abs=1e-9)
    aside = (place - shift) - ((place - shift) @ axis) * axis
    assert np.abs(aside).max() < 1e-8
    # Meusnier: the circle of radius r bends by 1 / r, its normal curvature is cos(tilt) / r
    radius = np.repeat([2.0, 2.1, 2.2], 3)
    around = np.cross(axis, points @ turn.T + shift - place)
    around /= np.linalg.norm(around, axis=1)[:, None]
    bent = np.einsum("ki,kij,kj->k", around, curvature, around)
    assert bent == pytest.approx(np.cos(0.5) / radius, rel=1e-9)


@pytest.mark.parametrize(
    ("tilts", "pitch"),
    [
        pytest.param([0.0, 0.0], 0.0, id="cylinder: it slides, too"),
        pytest.param([0.5, -0.5, 0.5], 0.1, id="normals past the axis: nothing moves, or a screw"),
    ],
)
def test_other_surfaces_are_none(tilts: list[float], pitch: float) -> None:
    points, normals = rings(np.random.default_rng(0), tilts, pitch)
    assert _revolved_surface(points, normals) is None
