"""All ten kinds, each against its closed form and against directions judged one by one."""

import numpy as np
import pytest
from cones import KINDS, MORE, directions, disagreements, region_of, same_rays, same_span

import kilter
from kilter.analysis.regions.polyhedral_cone import KINDS as ALL_KINDS
from kilter.scenes import rails


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", KINDS)
def test_closed_form(name: str) -> None:
    kind, build, lines, rays = KINDS[name]
    region = kilter.region(build())
    assert region.kind == kind
    assert same_span(region.lines, lines)
    assert same_rays(region.rays, rays)
    assert region.proved
    assert region.dimension == 3 - len(region.equations)


def test_every_kind_is_produced() -> None:
    assert {entry[0] for entry in KINDS.values()} == set(ALL_KINDS.values())


@pytest.mark.slow
@pytest.mark.parametrize("name", [*KINDS, *MORE])
def test_directions_one_by_one(name: str) -> None:
    region = region_of(name)
    assert not disagreements(region, directions(region, 100))


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", [*KINDS, *MORE])
def test_the_answer_describes_itself(name: str) -> None:
    """Equations, facets, rays and lines of the JSON answer are one and the same cone."""
    answer = region_of(name).to_dict()
    lines, rays, equations, facets = (
        np.array(answer[key]).reshape(-1, 3) for key in ("lines", "rays", "equations", "facets")
    )
    for rows in (lines, rays, equations, facets):
        assert np.allclose(np.linalg.norm(rows, axis=1), 1.0, atol=1e-12)
    assert np.abs(equations @ np.vstack([lines, rays, facets]).T).max(initial=0.0) < 1e-8
    assert np.abs(lines @ np.vstack([rays, facets]).T).max(initial=0.0) < 1e-8
    assert (facets @ rays.T).min(initial=0.0) > -1e-8
    assert np.allclose(lines @ lines.T, np.eye(len(lines)))
    assert np.allclose(equations @ equations.T, np.eye(len(equations)))
    _center_and_angle(answer, facets)


def _center_and_angle(answer: dict, facets: np.ndarray) -> None:
    kind, half = answer["kind"], answer["half_angle_deg"]
    fixed = {"none": None, "ray": 0, "line": 0, "half-plane": 90, "half-space": 90}
    fixed |= {"plane": 180, "all": 180}
    if kind in fixed:
        assert half == fixed[kind]
    else:
        assert np.degrees(np.arcsin((facets @ answer["center"]).min())) == pytest.approx(half)
    assert (answer["center"] is None) == (kind in ("none", "line", "plane", "all"))


@pytest.mark.slow
def test_planar_kinds() -> None:
    wanted = {"": "none", "-z": "ray", "-x +x": "line", "-x -z": "fan"}
    wanted |= {"-x +x -z": "half-plane", "-x +x -z +z": "plane"}
    for sides, kind in wanted.items():
        region = kilter.region(rails.railed(sides, planar=True))
        assert region.kind == kind
        assert np.abs(region.equations[:, 1]).max() == 1.0  # y, always
        assert np.abs(region.rays[:, 1]).max(initial=0.0) == 0.0
        assert not disagreements(region, directions(region, 50))
