"""The figures of the paper: F1, F4, F10, F11, F12, the case F11', and TR."""

import numpy as np
import pytest
from cones import X, Z, same_rays

import kilter
from kilter.scenes import paper

MICRO = np.radians(1e-6)
"""1e-6 degrees."""


@pytest.mark.quick(1)
@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize(
    ("angle", "mass_a", "mass_b", "from_down"),
    [(45, 1, 1, 45.0), (60, 1, 1, 60.0), (45, 1, 2, 63.43494882), (60, 1, 2, 73.89788625)],
)
def test_figures_11_and_12(
    angle: float, mass_a: float, mass_b: float, from_down: float, planar: bool
) -> None:
    assembly = paper.two_blocks_in_an_l(angle, mass_a=mass_a, mass_b=mass_b, planar=planar)
    region = kilter.region(assembly)
    assert region.kind == "ray"
    assert region.half_angle_deg == 0.0
    ray = region.rays[0]
    assert np.degrees(np.arctan2(-ray[0], -ray[2])) == pytest.approx(from_down, abs=1e-6)
    closed = paper.stable_direction(angle, mass_a, mass_b)
    assert np.linalg.norm(ray - closed) < MICRO


@pytest.mark.quick(1)
@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("stable", [False, True])
def test_the_l_leans_as_far_as_it_is_turned(stable: bool, planar: bool) -> None:
    region = kilter.region(paper.two_blocks_in_an_l(60.0, stable=stable, planar=planar))
    wanted = -Z if stable else np.array([-np.sin(np.pi / 3), 0, -0.5])
    assert np.linalg.norm(region.rays[0] - wanted) < MICRO


@pytest.mark.parametrize("planar", [False, True])
def test_figure_10_is_a_fan(planar: bool) -> None:
    region = kilter.region(paper.figure_10(planar=planar))
    assert region.kind == "fan"
    assert region.half_angle_deg == pytest.approx(45.0, abs=1e-9)
    assert same_rays(region.rays, [-X, -Z])


@pytest.mark.quick(1)
@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize(("mass_a", "mass_b"), [(1.0, 1.0), (1.0, 2.0), (2.0, 1.0)])
def test_the_trapped_wedge(mass_a: float, mass_b: float, planar: bool) -> None:
    region = kilter.region(paper.trapped_wedge(mass_a=mass_a, mass_b=mass_b, planar=planar))
    most = np.arctan(mass_a / mass_b)
    assert region.kind == "fan"
    assert region.half_angle_deg == pytest.approx(np.degrees(most) / 2, abs=1e-6)
    assert same_rays(region.rays, [-Z, np.array([-np.sin(most), 0, -np.cos(most)])], MICRO)


def test_the_loop_of_figure_9() -> None:
    assert kilter.region(paper.figure_9(planar=True)).kind == "plane"
