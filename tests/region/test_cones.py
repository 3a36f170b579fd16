"""Polyhedral cones by themselves: faces, axes, membership."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from kilter.analysis.regions.growth import Reach, grow
from kilter.analysis.regions.polyhedral_cone import Cone, make_cone, widest_axis

Array = np.ndarray


class RaysOracle:
    """The support of a cone that is given by its rays."""

    dimension = 3

    def __init__(self, rays: Array) -> None:
        self.rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
        self.asked = 0

    def support(self, direction: Array) -> Reach:
        self.asked += 1
        products = self.rays @ direction
        k = int(products.argmax())
        if products[k] <= 0:
            return Reach(0.0, np.zeros(3), np.zeros(0), np.zeros(0))
        return Reach(float(products[k]), self.rays[k], np.zeros(0), np.zeros(0))

    def focus(self, axis: Array) -> None:
        self.axis = axis


def cone_of(rays: Array) -> tuple[Cone, int]:
    oracle = RaysOracle(np.asarray(rays, dtype=float))
    grown = grow(oracle, np.array([0.0, 0.0, -1.0]), 1e-9, lambda: None)
    cone = make_cone(
        np.array([e for e, _, _ in grown.equations]),
        np.array([q for q, _ in grown.facets]),
        np.array([found.point for found in grown.points]),
        1e-9,
    )
    return cone, oracle.asked


@pytest.mark.slow
@given(st.integers(0, 10**6), st.integers(1, 12), st.sampled_from([0.01, 0.3, 1.0, 3.0]))
def test_a_cone_is_found_from_its_rays(seed: int, count: int, spread: float) -> None:
    random = np.random.default_rng(seed)
    axis = random.normal(size=3)
    axis /= np.linalg.norm(axis)
    rays = axis + spread * random.normal(size=(count, 3))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    cone, asked = cone_of(rays)
    assert cone.contains(rays).all()
    mixed = random.random((50, count)) @ rays
    assert cone.contains(mixed).all()
    for facet in cone.facets if count > 1 else ():
        assert (rays @ facet).min() == pytest.approx(0.0, abs=1e-8)
        outside = cone.rays[np.abs(cone.rays @ facet) < 1e-8].sum(axis=0) - 1e-3 * facet
        assert not cone.contains(outside)
    if cone.kind == "cone":
        assert asked <= len(cone.rays) + len(cone.facets) + 12


@pytest.mark.parametrize("tilt", [0.0, 1e-4, 1e-7])
def test_wide_fans_and_half_planes(tilt: float) -> None:
    rays = [[1.0, -tilt, 0], [-1.0, -tilt, 0], [0, -1.0, 0]]
    cone, _ = cone_of(rays)
    assert cone.kind == ("fan" if tilt else "half-plane")
    assert cone.half_angle_deg == pytest.approx(90 - np.degrees(tilt), abs=1e-9)


def test_rays_within_the_blur_are_one() -> None:
    cone, _ = cone_of([[0, 0, -1], [1e-10, 0, -1], [0, 1e-10, -1]])
    assert cone.kind == "ray"


@given(st.integers(0, 10**6), st.integers(1, 8))
def test_the_axis_has_the_widest_margin(seed: int, count: int) -> None:
    random = np.random.default_rng(seed)
    axis = random.normal(size=3)
    facets = random.normal(size=(count, 3))
    facets *= np.sign(facets @ axis)[:, None]
    facets /= np.linalg.norm(facets, axis=1, keepdims=True)
    best = widest_axis(facets)
    others = best + random.normal(size=(500, 3)) * 10.0 ** random.uniform(-6, 0, size=(500, 1))
    others /= np.linalg.norm(others, axis=1, keepdims=True)
    assert (facets @ best).min() >= (others @ facets.T).min(axis=1).max() - 1e-12


def test_shapes_of_directions() -> None:
    cone, _ = cone_of(-np.eye(3))
    assert cone.contains([-1, -1, -1]).shape == ()
    assert cone.contains(np.full((4, 5, 3), -1.0)).shape == (4, 5)
    with pytest.raises(ValueError, match="read-only"):
        cone.rays[0, 0] = 1.0
