"""The broad phase against all pairs: nothing lost, nothing invented."""

from __future__ import annotations

import numpy as np
import pytest

import kilter
from kilter.contact.common import broad
from kilter.contact.common import facets as planar_facets
from kilter.contact.common.broad import make_boxes, part_pairs
from kilter.contact.common.distances import near_triangles, surface_distance
from kilter.contact.common.facets import find_facets
from kilter.errors import InputError


def crowd(rng, owners):
    """Boxes of some owners, of any size, anywhere."""
    count = int(rng.integers(1, 200))
    owner = np.sort(rng.integers(0, owners, count))
    low = rng.random((count, 3))
    return owner, low, low + rng.random((count, 3)) * rng.choice([0.0, 0.02, 0.4], (count, 1))


@pytest.mark.slow
@pytest.mark.parametrize("most", [0, 100, 10**9], ids=["trees", "both", "products"])
def test_joins_of_random_boxes_are_those_of_all_pairs(most, monkeypatch):
    rng = np.random.default_rng(7)
    monkeypatch.setattr(broad, "MANY", most)
    monkeypatch.setattr(broad, "TREE", 150)
    for _ in range(60):
        owners = int(rng.integers(1, 6))
        scale, shift = 10.0 ** rng.uniform(-6, 4), rng.normal(size=3) * 10.0 ** rng.uniform(-2, 6)
        sides = [crowd(rng, owners), crowd(rng, owners)]
        (one, low_a, high_a), (other, low_b, high_b) = (
            (owner, low * scale + shift, high * scale + shift) for owner, low, high in sides
        )
        margin = rng.random(owners) * scale * 0.02
        found = []
        for owner, x, y in broad.joins(one, (low_a, high_a), other, (low_b, high_b), margin):
            found += list(zip(owner.tolist(), x.tolist(), y.tolist(), strict=True))
        grow = margin[one][:, None]
        meets = one[:, None] == other
        meets &= ((low_a - grow)[:, None] <= high_b).all(axis=2)
        meets &= (low_b <= (high_a + grow)[:, None]).all(axis=2)
        x, y = np.nonzero(meets)
        expected = zip(one[x].tolist(), x.tolist(), y.tolist(), strict=True)
        assert sorted(found) == sorted(expected)


def sampled(triangle, rng, count=4000):
    """Points of a triangle, its corners and sides among them."""
    weights = rng.dirichlet([0.6, 0.6, 0.6], count)
    weights[:3] = np.eye(3)
    weights[3:300, 0] = 0.0
    weights /= weights.sum(axis=1)[:, None]
    return weights @ triangle


@pytest.mark.slow
def test_distance_from_a_surface_is_that_of_its_nearest_point():
    rng = np.random.default_rng(3)
    for _ in range(20):
        soup = rng.normal(size=(12, 3, 3)) * rng.choice([0.1, 1.0], (12, 1, 1))
        points = rng.normal(size=(30, 3)) * 2
        exact = surface_distance(points, soup)
        cloud = np.concatenate([sampled(triangle, rng) for triangle in soup])
        rough = np.linalg.norm(points[:, None] - cloud, axis=2).min(axis=1)
        assert (exact <= rough + 1e-12).all()
        assert (rough - exact <= 0.1).all()


@pytest.mark.slow
def test_triangles_that_come_near_are_those_whose_points_do():
    from scipy.spatial import cKDTree

    rng = np.random.default_rng(5)
    seen = {True: 0, False: 0}
    for _ in range(50):
        one, other = rng.normal(size=(2, 3, 3))
        other += rng.normal(size=3) * 1.5
        cloud = cKDTree(sampled(one, rng))
        least = float(cloud.query(sampled(other, rng))[0].min())
        for reach in (0.05, 0.3, 1.0):
            near = near_triangles(one[None], other[None], reach)
            if least <= reach:
                assert len(near) == 1
                off = surface_distance(near, one[None])[0], surface_distance(near, other[None])[0]
                assert max(off) <= reach / 2 + 1e-9
            elif least > reach + 0.1:
                assert len(near) == 0
            seen[bool(len(near))] += 1
    assert min(seen.values()) > 10


def piled(count: int, apart: float, floor: bool = False) -> kilter.Assembly:
    """Cubes in a row, on a floor that comes first."""
    parts = [
        kilter.Part(f"c{k}", kilter.Box([1, 1, 1]), kilter.Pose([k * apart, 0, 0.5]))
        for k in range(count)
    ]
    size = [2 * count * max(apart, 1), 3, 1]
    held = [kilter.Part("floor", kilter.Box(size), kilter.Pose([0, 0, -0.5]), grounded=True)]
    return kilter.Assembly([*(held if floor else []), *parts])


def pairs_of(assembly: kilter.Assembly) -> int:
    geometry = assembly.geometry
    boxes = make_boxes(geometry, find_facets(geometry))
    return len(part_pairs(boxes, geometry.grounded, np.zeros(len(assembly))))


@pytest.mark.slow
def test_parts_that_all_lie_in_one_another_are_refused() -> None:
    """Before their pairs are listed: a file of 1 MB could ask for all of the memory."""
    assert pairs_of(piled(1000, 0.0)) == 1000 * 999 // 2
    for count in (1002, 5000):
        with pytest.raises(InputError, match="overlap: too many"):
            pairs_of(piled(count, 0.0))


@pytest.mark.slow
def test_a_floor_under_many_parts_is_no_crowd() -> None:
    assert pairs_of(piled(20_000, 2.0, floor=True)) == 20_000


def test_sides_of_boxes_are_the_facets_that_their_triangles_give(monkeypatch):
    rng = np.random.default_rng(3)
    parts = [
        kilter.Part(
            f"box-{k}",
            kilter.Box(10.0 ** rng.uniform(-2, 2, 3)),
            kilter.Pose(rng.normal(size=3) * 10, rng.normal(size=4)),
            grounded=k == 0,
        )
        for k in range(30)
    ]
    geometry = kilter.Assembly(parts).geometry
    closed = find_facets(geometry)
    blocks = [planar_facets._convex_block(closed.part, closed.corners.reshape(-1, 4))]
    general = planar_facets._assemble_facets(geometry, blocks, geometry.is_box.copy())
    for name in planar_facets.Facets.__slots__:
        one, other = getattr(closed, name), getattr(general, name)
        assert one.dtype == other.dtype
        assert np.allclose(one, other, rtol=1e-12, atol=1e-12), name
    wedge = kilter.Part("wedge", kilter.Prism([(0, 0), (1, 0), (0, 1)], 1), [50, 0, 0])
    both = find_facets(kilter.Assembly([*parts, wedge]).geometry)
    assert np.array_equal(both.normal[:180], closed.normal)
    assert np.array_equal(both.origin[:180], closed.origin)
