"""Turn, shift and scale carry the cone with them; float32 keeps its kind."""

import numpy as np
import pytest
from cones import BUILDERS, same_span
from transformations import as_single

import kilter
from kilter.scenes.transform import moved

POSES = [([0.3, -0.5, 0.2, 0.7], [3, -2, 5]), ([0.9, 0.1, -0.4, 0.2], [0, 0, 0])]


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
