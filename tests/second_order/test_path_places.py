"""The fall of balanced assemblies: each configuration is apart and lower than the last."""

from __future__ import annotations

import numpy as np
import pytest
from places import case_of
from random_balances import disjoint, overlap, random_balance
from scipy.spatial.transform import Rotation
from test_figures_in_space import TURNED, least_gap

import kilter
from kilter import Assembly, Box, Cylinder, Part, Pose, Sphere
from kilter.arrays import Array
from kilter.scenes import scene
from kilter.second_order.answer.path_places import ALLOWED, PathPlaces, find_path_places
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.work import Work

LYING = Pose.of([[1, 0, 0], [0, 0, -1], [0, 1, 0]]).rotation
SURE = 1e-6
"""Gaps above this are beyond the rounding of the linear programs of the test [length unit]."""


def balls(scale: float = 1.0) -> Assembly:
    base = Part("base", Sphere(scale), grounded=True)
    return Assembly([base, Part("ball", Sphere(0.5 * scale), Pose([0, 0, 1.5 * scale]), mass=2.0)])


def logs() -> Assembly:
    base = Part("base", Cylinder(1.0, 3.0), Pose([0, 0, 0], LYING), grounded=True)
    return Assembly([base, Part("log", Cylinder(0.5, 2.0), Pose([0, 0, 1.5], LYING), mass=2.0)])


def path_of(assembly: Assembly, work: Work | None = None) -> tuple[SecondOrder, PathPlaces]:
    verdict = kilter.check(assembly)
    found = verdict.second_order_answer
    assert found is not None
    assert found.state == "balanced"
    path = find_path_places(verdict.assembly, found, work=work)
    assert path is not None
    assert (np.diff(path.energies) < 0).all()
    assert (np.diff(path.lengths) > 0).all()
    assert (path.apart > 0).all()
    return found, path


@pytest.mark.slow
@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e3])
def test_a_ball_slides_down_a_ball(scale: float) -> None:
    """Its centre stays on a sphere about the other centre: E = m g (R + r)(cos a - 1)."""
    _, path = path_of(balls(scale))
    centre = path.motions[:, 1, :3] / scale + np.array([0, 0, 1.5])
    angle = np.arctan2(np.linalg.norm(centre[:, :2], axis=1), centre[:, 2])
    weight = 2.0 * np.linalg.norm(balls().gravity)
    energy = path.energies / scale / weight
    assert np.degrees(angle[-1]) > 35
    np.testing.assert_allclose(np.linalg.norm(centre, axis=1), 1.5, atol=1e-4)
    np.testing.assert_allclose(energy, 1.5 * np.cos(angle) - 1.5, atol=1e-4)
    np.testing.assert_allclose(path.lengths[-1] / scale, 1.5 * angle[-1], rtol=0.02)
    assert np.abs(path.motions[:, 1, 3:]).max() < 1e-2  # nothing turns it


@pytest.mark.slow
def test_a_log_slides_down_a_log_until_it_leaves_it() -> None:
    _, path = path_of(logs())
    x, y, z = (path.motions[:, 1, :3] + np.array([0, 0, 1.5])).T
    on = z > 0.3
    assert not on.all()
    np.testing.assert_allclose(np.hypot(x, z)[on], 1.5, atol=3e-4)
    assert np.abs(y).max() < 0.05
    assert np.ptp(x[z < -0.1]) < 1e-3  # straight down beside it
    assert path.apart[-1] > 0.001


def corners(assembly: Assembly, part: int, motion: Array) -> Array:
    """The corners of a displaced part."""
    geometry = assembly.geometry
    points = np.unique(geometry.corners_of(part).reshape(-1, 3), axis=0) - geometry.center[part]
    return Rotation.from_rotvec(motion[3:]).apply(points) + geometry.center[part] + motion[:3]


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [TURNED[0], *(pytest.param(one, marks=pytest.mark.slow) for one in TURNED[1:])]
)
def test_blocks_of_the_figures_twist_and_sink(name: str) -> None:
    """They are apart from each triangle of the wall and from each other."""
    assembly = scene(name)
    found, path = path_of(assembly)
    program = found.program
    assert program is not None
    gaps = [least_gap(assembly, program, motion) for motion in path.motions[1:6]]
    np.testing.assert_allclose(gaps, path.apart[:5], rtol=1e-6, atol=1e-12)
    assert path.apart.max() < 1e-3  # they stay in contact, up to gaps too small to see
    held, (one, other) = int(np.flatnonzero(~program.free)[0]), np.flatnonzero(program.free)
    for motion in path.motions[-1:2:-6]:
        first, second = (corners(assembly, k, motion[k]) for k in (one, other))
        walls = assembly.geometry.corners_of(held)
        assert disjoint(first, 0.0, second, 0.0)
        assert all(disjoint(block, 0.0, wall, 0.0) for block in (first, second) for wall in walls)
    turns = np.linalg.norm(path.motions[-1, :, 3:], axis=1)[program.free]
    assert turns.min() > 0.7
    assert path.motions[-1, program.free, 2].sum() < -1.0


@pytest.mark.slow
def test_less_work_is_a_shorter_path_that_begins_the_same() -> None:
    _, whole = path_of(balls(), Work(ALLOWED))
    _, part = path_of(balls(), Work(ALLOWED / 100))
    count = len(part.motions)
    assert 2 < count < len(whole.motions)
    np.testing.assert_array_equal(part.motions, whole.motions[:count])


def test_there_is_none_of_what_is_at_rest_or_of_given_contacts() -> None:
    verdict = kilter.check(case_of("02").build(0.0))
    assert verdict.second_order_answer is not None
    assert verdict.second_order_answer.state == "balanced"
    assert find_path_places(verdict.assembly, verdict.second_order_answer) is None
    upright = kilter.check(scene("tower"))
    assert upright.second_order_answer is not None
    assert find_path_places(upright.assembly, upright.second_order_answer) is None


@pytest.mark.slow
def test_a_box_tips_over_the_edge_of_its_table() -> None:
    table = Part("table", Box([2, 2, 1]), grounded=True)
    assembly = Assembly([table, Part("box", Box([1, 0.8, 0.6]), Pose([1, 0, 0.8]))])
    _, path = path_of(assembly)
    x, _, z, _, turn, _ = path.motions[-1, 1]
    assert turn > 1
    assert x > 0.3
    assert z < -0.4
    assert not any(overlap(assembly, motion, outside=True) for motion in path.motions[3:])


@pytest.mark.slow
def test_balls_between_walls_fall_along_them() -> None:
    """No configuration opens a wall: their centres stay half way between, and they never turn."""
    walls = [Part(f"wall {x}", Box([1, 10, 10]), Pose([x, 0, 5]), grounded=True) for x in (-1, 1)]
    floor = Part("floor", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
    upright = [Part(f"ball {k}", Sphere(0.5), Pose([0, 0, 0.5 + k]), mass=1.0) for k in range(2)]
    _, path = path_of(Assembly([floor, *walls, *upright]))
    assert np.abs(path.motions[:, 3:, 0]).max() < 1e-12
    assert np.abs(path.motions[:, 3:, 3:]).max() < 1e-12
    low, high = path.motions[:, 3, :3], path.motions[:, 4, :3] + np.array([0, 0, 1.0])
    apart = np.linalg.norm(high - low, axis=1)
    assert apart.min() >= 1.0
    assert apart.max() < 1.002
    assert np.ptp(low[:, 2]) < 1e-3  # the lower one slides on the floor
    assert high[-1, 2] < 0.9
    energy = 9.81 * (path.motions[:, 3, 2] + path.motions[:, 4, 2])
    np.testing.assert_allclose(path.energies, energy, rtol=1e-9, atol=1e-12)


@pytest.mark.slow
def test_clusters_fall_at_once_each_as_it_does_alone() -> None:
    far = np.array([20.0, 0, 0])
    two = [
        Part("other base", Sphere(1.0), Pose(far), grounded=True),
        Part("other", Sphere(0.5), Pose([20, 0, 1.5]), mass=2.0),
    ]
    together = Assembly([*balls().parts, *two])
    found, path = path_of(together)
    assert len(found.clusters) == 2
    _, alone = path_of(balls())
    drop = path.motions[:, [1, 3], 2]
    assert drop[-1].max() < -0.2
    np.testing.assert_allclose(path.energies, drop.sum(axis=1) * 2.0 * 9.81, rtol=1e-6, atol=1e-9)
    centres = path.motions[:, [1, 3], :3] + np.array([0, 0, 1.5])
    np.testing.assert_allclose(np.linalg.norm(centres, axis=2), 1.5, atol=1e-4)
    np.testing.assert_allclose(drop[-1], alone.motions[-1, 1, 2], atol=0.1)


def followed(seed: int) -> float | None:
    """Length of the fall of a random assembly without overlaps [width of the part], or None."""
    assembly = random_balance(seed)
    verdict = kilter.check(assembly)
    second = verdict.second_order_answer
    if second is None or second.state != "balanced" or second.decision is None:
        return None  # some fall by rule, without a path
    found, path = path_of(assembly)
    assert found.program is not None
    for motion, apart in zip(path.motions[1:], path.apart, strict=True):
        if apart > SURE:
            assert not overlap(assembly, motion, outside=apart > 10 * SURE)
    far = np.linalg.norm(path.motions[-1, :, :3], axis=1) / found.program.radius
    return float(np.maximum(far, np.linalg.norm(path.motions[-1, :, 3:], axis=1)).max())


@pytest.mark.slow
@pytest.mark.parametrize("block", range(2))
def test_random_ones_fall_and_none_overlaps(block: int) -> None:
    far = [followed(seed) for seed in range(10 * block, 10 * block + 10)]
    falls = [one for one in far if one is not None]
    assert len(falls) >= 5
    assert min(falls) > 1
