"""Points on faces: the pruned comparison with triangles equals the comparison with all of them."""

from __future__ import annotations

import numpy as np
import pytest

from kilter.shape.covering import FaceCover, covered
from kilter.shape.shape_tolerances import GRAZING


def covered_by_all(triangles, points, normals, reach, grow):
    """The definition: the line x + t n meets a triangle with sides moved outwards by `grow`."""
    result = np.zeros(len(points), dtype=bool)
    for k, (x, n) in enumerate(zip(points, normals, strict=True)):
        for corners in triangles:
            upright = np.cross(corners[1] - corners[0], corners[2] - corners[0])
            upright /= np.linalg.norm(upright)
            along = n @ upright
            if abs(along) < GRAZING:
                continue
            t = (corners[0] - x) @ upright / along
            foot = x + t * n
            inside = abs(t) <= reach + grow
            for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
                inward = np.cross(upright, end - start)
                inside &= (foot - start) @ inward / np.linalg.norm(inward) >= -grow
            result[k] |= inside
    return result


@pytest.mark.quick(1)
@pytest.mark.parametrize("grow", [0.0, 0.02, 0.3])
@pytest.mark.parametrize("flatness", [1.0, 0.02])
def test_pruned_triangles_cover_what_all_triangles_cover(flatness, grow):
    """Also for slivers, whose tips move outwards by many times `grow`."""
    rng = np.random.default_rng(7)
    triangles = rng.normal(size=(40, 3, 3)) * [1.0, flatness, 0.1]
    points = rng.normal(size=(200, 3)) * [1.5, 2 * flatness + grow, 0.1]
    normals = rng.normal(size=(200, 3)) * [0.2, 0.2, 1.0]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    expected = covered_by_all(triangles, points, normals, 0.5, grow)
    assert 0 < expected.sum() < len(points)
    # a point far away widens the box of all points, so that only the pairs are pruned
    far = np.vstack([points, [50.0, 0, 0], [-50.0, 0, 0]])
    lines = np.vstack([normals, np.eye(3)[[2, 2]]])
    assert covered(triangles, far, lines, 0.5, grow)[:-2].tolist() == expected.tolist()


def test_the_tip_of_a_sliver_moves_by_its_pointedness():
    """The sides of a right isosceles triangle moved by s move its sharp tips by s / sin(pi / 8)."""
    cover = FaceCover.of(np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]]))
    assert cover.pointed[0] >= 1 / np.sin(np.pi / 8)
    assert cover.pointed[0] == pytest.approx(np.sqrt(2) * (2 + np.sqrt(2)))
