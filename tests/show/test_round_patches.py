"""Round patches are drawn along the contact of round faces, closed or as an arc."""

from __future__ import annotations

import numpy as np

from kilter import Assembly, Cylinder, Part, Pose, contacts
from kilter.scenes import scene
from kilter.scenes.pieces import tube
from kilter.show.round_patches import _rings, round_patches


def arc(angles: np.ndarray, lean: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    """Points at radius 3 - height, with normals inclined to z."""
    around = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    up = np.array([0, 0, 1.0])
    return (3 - height) * around + height * up, np.cos(lean) * around + np.sin(lean) * up


def test_a_cone_has_its_circles_and_an_arc_ends_where_its_points_end() -> None:
    angles = np.radians([-40, 0, 40, 80])
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    low, high = arc(angles, 0.4, 0.0), arc(angles, 0.4, 1.0)
    points = np.vstack([low[0], high[0]]) @ turn.T + [5, 6, 7]
    rings = _rings(points, np.vstack([low[1], high[1]]) @ turn.T)
    assert len(rings) == 2
    sizes = []
    for ring in rings:
        back = (ring - [5, 6, 7]) @ turn
        size = np.hypot(back[:, 0], back[:, 1])
        assert np.allclose(size, 3 - back[:, 2])
        sizes.append(size[0])
        angle = np.degrees(np.arctan2(back[:, 1], back[:, 0]))
        assert np.allclose([angle.min(), angle.max()], [-40, 80])
    assert np.allclose(sorted(sizes), [2, 3])


def test_three_points_around_are_a_whole_circle_and_two_are_none() -> None:
    around = arc(np.radians([0, 120, 240]), 0.0, 0.0)
    [ring] = _rings(*around)
    assert np.allclose(ring[0], ring[-1])
    assert _rings(*arc(np.radians([0, 90]), 0.0, 0.0)) == []


def test_a_shaft_touches_its_bore_on_a_whole_cylinder() -> None:
    sleeve = tube("sleeve", 1.0, 2.0, 3.0, grounded=True)
    found = contacts(Assembly([sleeve, Part("shaft", Cylinder(1.0, 2.0), Pose([0, 0, 0.2]))]))
    assert found.patch_kind.tolist() == ["cylinder"]
    drawn = round_patches(found)
    assert np.allclose(np.hypot(*drawn.points[:, :2].T), 1.0)
    corners = drawn.points[drawn.triangles]
    area = np.linalg.norm(np.cross(*(corners[:, 1:] - corners[:, :1]).swapaxes(0, 1)), axis=1) / 2
    chord = 2 * len(drawn.triangles) / 2 * np.sin(np.pi / (len(drawn.triangles) / 2))
    assert np.isclose(area.sum(), chord * np.ptp(drawn.points[:, 2]))
    assert np.isclose(area.sum(), found.patch_area[0], rtol=2e-3)


def test_flat_patches_and_lines_of_contact_have_none() -> None:
    for name in ("tower", "three-cylinders"):
        assert len(round_patches(contacts(scene(name))).points) == 0
