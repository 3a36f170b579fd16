"""Thin cones are found where sampling finds nothing, in about a program a ray and a facet."""

import numpy as np
import pytest
from cones import KINDS, MORE, region_of, same_rays

import kilter
from kilter.assembly import Assembly, GivenContact
from kilter.scenes.pieces import block


@pytest.mark.quick(3)
@pytest.mark.parametrize("angle", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6])
def test_ever_thinner(angle: float) -> None:
    """A cube on four points whose normals lean by `angle` [rad] and meet in its middle."""
    leans = np.array([[1, 0], [0, 1], [-1, 0], [0, -1]]) * np.sin(angle)
    normals = np.column_stack([leans, np.full(4, np.cos(angle))])
    base = block("base", [-1, -1, -2], [1, 1, -1], grounded=True)
    cube = block("cube", [-0.5, -0.5, -0.5], [0.5, 0.5, 0.5])
    contacts = [GivenContact(("base", "cube"), [-0.5 * n], n) for n in normals]
    region = kilter.region(Assembly([base, cube], contacts=contacts, detect=False))
    assert region.kind == "cone"
    assert same_rays(region.rays, list(-normals), 1e-9)
    assert region.proved
    half = np.arcsin(np.tan(angle) / np.sqrt(2 + np.tan(angle) ** 2))
    assert region.half_angle_deg == pytest.approx(np.degrees(half), rel=1e-9 / angle)


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", [*KINDS, *MORE])
def test_few_programs(name: str) -> None:
    region = region_of(name)
    assert region.programs <= len(region.rays) + len(region.facets) + 12
