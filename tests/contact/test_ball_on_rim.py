"""A ball on the round rim of a hole: the circle of contact, its limits, and the tilt it bears."""

from __future__ import annotations

import numpy as np
import pytest

from kilter import Assembly, Part, Pose, Sphere, check, contacts, margin
from kilter.scenes.pieces import tube, turn
from kilter.scenes.transform import moved


def seated(radius: float, hole: float, lift: float = 0.0, aside: float = 0.0) -> Assembly:
    """A ball over the hole of a held ring whose upper face is at z = 2."""
    seat = tube("seat", hole, 3 * radius, 4.0, grounded=True)
    top = float(seat.pose.position[2]) + 2.0
    height = top + np.sqrt(radius**2 - hole**2) + lift
    return Assembly([seat, Part("ball", Sphere(radius), Pose([aside, 0, height]))])


@pytest.mark.parametrize("seed", range(6))
def test_the_ball_touches_the_whole_rim_with_its_own_normals(seed: int) -> None:
    rng = np.random.default_rng(seed)
    radius = float(rng.uniform(0.5, 2.0))
    hole = radius * float(rng.uniform(0.2, 0.95))
    assembly = moved(seated(radius, hole), turn(rng.normal(size=3), 70.0), rng.normal(size=3))
    found = contacts(assembly)
    assert found.open_pairs == ()
    assert found.patch_kind.tolist() == ["sphere"]
    assert found.patch_gap == pytest.approx(0, abs=1e-12)
    center = np.array(assembly["ball"].pose.position)
    away = (found.points - center) / radius
    assert np.linalg.norm(away, axis=1) == pytest.approx(1.0)
    sense = 1.0 if found.patch_parts[0, 0] == 1 else -1.0
    assert sense * found.normals == pytest.approx(away, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_the_ball_stays_up_to_the_tilt_at_which_its_weight_passes_the_rim(seed: int) -> None:
    """Its weight passes through the rim at the angle whose sine is the ratio of the radii."""
    rng = np.random.default_rng(seed)
    radius = float(rng.uniform(0.5, 2.0))
    hole = radius * float(rng.uniform(0.2, 0.9))
    assembly = seated(radius, hole)
    limit = float(np.degrees(np.arcsin(hole / radius)))
    assert check(assembly).verdict == "stable"
    tilt = margin(assembly).tilt_deg
    assert 0.995 * limit <= tilt <= limit * (1 + 1e-9)
    for share, verdict in ((0.99, "stable"), (1.01, "unstable")):
        turn = np.radians(share * limit)
        turned = check(assembly, down=[float(np.sin(turn)), 0, -float(np.cos(turn))])
        assert turned.verdict == verdict


def test_a_ball_that_is_not_over_the_middle_of_the_hole_is_open() -> None:
    found = contacts(seated(1.0, 0.5, aside=0.01))
    assert not len(found)


def test_a_ball_above_or_in_the_rim_does_not_touch_it() -> None:
    assert not len(contacts(seated(1.0, 0.5, lift=0.01)))
    sunk = contacts(seated(1.0, 0.5, lift=-0.05))
    assert [pair.kind for pair in sunk.open_pairs] == ["overlap"]


def test_a_ball_under_a_ceiling_with_a_hole_falls() -> None:
    assert check(seated(1.0, 0.5), down=[0, 0, 1]).verdict == "unstable"
