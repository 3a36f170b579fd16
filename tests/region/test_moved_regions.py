"""Turn, shift and scale carry the cone with them; float32 keeps its kind."""

import numpy as np
import pytest
from cones import BUILDERS, region_of, same_rays, same_span
from hypothesis import given, settings
from hypothesis import strategies as st
from transformations import as_single, scaled

import kilter
from kilter.rigid import quaternion_to_matrix
from kilter.scenes.transform import moved

SPATIAL = [name for name, build in BUILDERS.items() if not build().planar]
POSES = [([0.3, -0.5, 0.2, 0.7], [3, -2, 5]), ([0.9, 0.1, -0.4, 0.2], [0, 0, 0])]


@pytest.mark.slow
@given(
    name=st.sampled_from(SPATIAL),
    seed=st.integers(0, 10**6),
    factor=st.sampled_from([1e-3, 0.1, 1.0, 1e3]),
    distance=st.sampled_from([0.0, 1.0, 30.0]),
)
@settings(max_examples=15)
def test_rigid_motion_and_scale(name: str, seed: int, factor: float, distance: float) -> None:
    random = np.random.default_rng(seed)
    turn = random.normal(size=4)
    other = scaled(moved(BUILDERS[name](), turn, random.normal(size=3) * distance), factor)
    here, there = region_of(name), kilter.region(other)
    matrix = quaternion_to_matrix(turn)
    assert there.kind == here.kind
    assert there.proved
    assert same_rays(there.rays, list(here.rays @ matrix.T), 1e-8)
    assert same_span(there.lines, list(here.lines @ matrix.T), 1e-8)


@pytest.mark.quick(1)
@pytest.mark.parametrize("pose", [None, *range(len(POSES))])
@pytest.mark.parametrize("name", BUILDERS)
def test_float32_keeps_the_kind(name: str, pose: int | None) -> None:
    assembly = BUILDERS[name]()
    if pose is not None and not assembly.planar:
        assembly = moved(assembly, *POSES[pose])
    exact, rounded = kilter.region(assembly), kilter.region(as_single(assembly))
    assert rounded.kind == exact.kind
    blur = rounded.cone.blur
    assert blur < 2e-3
    assert same_span(rounded.lines, list(exact.lines), blur)
    warned = any("coordinates have limited accuracy" in text for text in rounded.warnings)
    assert warned == (name != "aside")  # which touches nothing
    # rays closer than the blur are one ray
    for ray in rounded.rays:
        assert np.linalg.norm(exact.rays - ray, axis=1).min() < 5 * blur


@pytest.mark.slow
@pytest.mark.parametrize("name", ["tower", "corner-wedges", "groove"])
def test_the_file_s_gravity_does_not_matter(name: str) -> None:
    assembly = BUILDERS[name]()
    region = kilter.region(assembly)
    for down in ([1, 2, 3], [0, 0, 1], [-1, 0, 1e-3]):
        other = kilter.region(assembly.with_down(down))
        assert other.kind == region.kind
        assert same_rays(other.rays, list(region.rays))
