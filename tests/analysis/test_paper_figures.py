"""Figures 1, 4, 8 to 12 of the paper, answered by `check`."""

import dataclasses

import numpy as np
import pytest
from judged import judged
from transformations import tilted

from kilter.scenes import paper

IN_PLANE_AND_IN_SPACE = pytest.mark.parametrize("planar", [True, False])


@IN_PLANE_AND_IN_SPACE
def test_figure_1_c2_and_c3_start_at_half_a_g_each(planar):
    a = judged(paper.figure_1("a", planar=planar)).motion.acceleration
    assert np.allclose(a[1:, [0, 2]], [[0, -9.81 / 2], [9.81 / 2, 0]], atol=1e-10)
    assert np.allclose(a[1:, 3:], 0, atol=1e-10)


@pytest.mark.quick(1)
@IN_PLANE_AND_IN_SPACE
@pytest.mark.parametrize(("orientation", "z"), [(1, -5.0), (2, -2.5), (3, 0.0), (4, 0.0)])
def test_figure_4_z_rises_as_gravity_turns(planar, orientation, z):
    verdict = judged(paper.figure_4(orientation, planar=planar))
    assert verdict.displacement.z == pytest.approx(z, abs=1e-9)
    assert verdict.first_order == ("stable" if z == 0 else "unstable")


@IN_PLANE_AND_IN_SPACE
def test_figure_8_as_printed(planar):
    verdict = judged(paper.figure_8(planar=planar))
    assert verdict.verdict == "unstable"
    assert verdict.moving == ["C2", "C3"]
    dp = verdict.displacement.displacement
    assert round(float(dp[1, 2]), 3) == -1.0
    assert round(float(dp[2, 0]), 3) == 0.577


@pytest.mark.quick(1)
@IN_PLANE_AND_IN_SPACE
@pytest.mark.parametrize("angle", [45.0, 52.5, 60.0, 67.0, 75.0])
def test_figure_8_c3_goes_aside_by_the_cotangent(planar, angle):
    verdict = judged(paper.figure_8(angle, planar=planar))
    expected = np.zeros((3, 6))
    expected[1, 2] = -1.0
    expected[2, 0] = 1 / np.tan(np.radians(angle))
    assert np.allclose(verdict.displacement.displacement, expected, atol=1e-9)
    assert verdict.displacement.z == pytest.approx(-1.0, abs=1e-9)


@pytest.mark.quick(1)
@IN_PLANE_AND_IN_SPACE
@pytest.mark.parametrize("angle", [45.0, 60.0, 75.0])
def test_figure_8_starts_as_two_wedges_do(planar, angle):
    # C3 moves by cot(angle) of what C2 sinks: a_2 (m + m cot^2) = m g
    verdict = judged(paper.figure_8(angle, planar=planar))
    cot = 1 / np.tan(np.radians(angle))
    down = 9.81 / (1 + cot**2)
    a = verdict.motion.acceleration
    assert np.allclose(a[1:, [0, 2]], [[0, -down], [down * cot, 0]], atol=1e-10)


@IN_PLANE_AND_IN_SPACE
def test_figure_9_circulates_as_soon_as_one_block_is_heavier(planar):
    """All four go round at one speed: 0.001 kg drives 4.001 kg."""
    assembly = paper.figure_9(planar=planar)
    verdict = judged(
        dataclasses.replace(
            assembly,
            parts=[
                dataclasses.replace(part, mass=1.001 if part.name == "right" else 1.0)
                for part in assembly.parts
            ],
        )
    )
    assert verdict.verdict == "unstable"
    size = 9.81 * 0.001 / 4.001
    ways = {"right": [0, 0, -1], "bottom": [-1, 0, 0], "left": [0, 0, 1], "top": [1, 0, 0]}
    assert set(verdict.moving) == set(ways)
    for name, way in ways.items():
        found = verdict.motion.acceleration[verdict.assembly.index[name]]
        assert np.allclose(found[:3], size * np.array(way), atol=1e-9)


@pytest.mark.quick(1)
@pytest.mark.parametrize("degrees", [0.01, 1.0, 45.0, 90.0, 137.0, 180.0])
def test_figure_9_is_stable_whichever_way_gravity_points(degrees):
    turned = tilted(paper.figure_9(planar=True), [0, 1, 0], degrees)
    verdict = judged(turned)
    assert verdict.first_order == "stable"
    assert verdict.neutral.two_sided == 1


@pytest.mark.quick(1)
@IN_PLANE_AND_IN_SPACE
@pytest.mark.parametrize(
    ("lean", "word"),
    [
        (-0.01, "unstable"),
        (0.0, "stable"),
        (0.01, "stable"),
        (45.0, "stable"),
        (89.99, "stable"),
        (90.0, "stable"),
        (90.01, "unstable"),
    ],
)
def test_figure_10_is_stable_over_a_range(planar, lean, word):
    level = paper.figure_10("a", planar=planar).with_down([0, 0, -1])
    # exact at 90 degrees: cos(90) is not 0 in floating point
    assembly = level.with_down([-1, 0, 0]) if lean == 90 else tilted(level, [0, 1, 0], lean)
    assert judged(assembly).verdict == word


@pytest.mark.slow
@IN_PLANE_AND_IN_SPACE
@pytest.mark.parametrize(("figure", "leans"), [(paper.figure_11, 45), (paper.figure_12, 60)])
@pytest.mark.parametrize("off", [-0.01, 0.0, 0.01])
def test_figures_11_and_12_are_stable_at_their_angle_only(planar, figure, leans, off):
    assembly = tilted(figure("a", planar=planar), [0, 1, 0], leans + off)
    assert judged(assembly).first_order == ("stable" if off == 0 else "unstable")
    assert judged(figure("b", planar=planar)).first_order == "stable"


@pytest.mark.slow
@IN_PLANE_AND_IN_SPACE
@pytest.mark.parametrize(
    ("angle", "ratio", "leans"),
    [
        (45.0, 1.0, 45.0),
        (60.0, 1.0, 60.0),
        (45.0, 2.0, 63.435),
        (60.0, 2.0, 73.898),
        (45.0, 0.5, 26.565),
        (30.0, 1.0, 30.0),
    ],
)
def test_unequal_masses_lean_as_the_table_says(planar, angle, ratio, leans):
    exact = np.degrees(np.arctan(ratio * np.tan(np.radians(angle))))
    assert exact == pytest.approx(leans, abs=1e-3)
    assembly = paper.two_blocks_in_an_l(angle, mass_b=ratio, planar=planar)
    for off, word in ((-0.01, "unstable"), (0.0, "stable"), (0.01, "unstable")):
        assert judged(tilted(assembly, [0, 1, 0], exact + off)).first_order == word


RATIOS = pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0])


@pytest.mark.slow
@RATIOS
def test_trapped_wedge_holds_between_its_limits(ratio):
    limit = np.degrees(np.arctan(1 / ratio))
    for tilt in (0.0, 0.01, 10.0, limit / 2, limit - 0.01):
        assert judged(paper.trapped_wedge(tilt, mass_b=ratio)).first_order == "stable"


@pytest.mark.quick(1)
@RATIOS
def test_trapped_wedge_fails_just_outside_them(ratio):
    limit = np.degrees(np.arctan(1 / ratio))
    for tilt in (-0.01, limit + 0.01):
        assert judged(paper.trapped_wedge(tilt, mass_b=ratio)).verdict == "unstable"


@pytest.mark.slow
@RATIOS
def test_trapped_wedge_moves_at_no_cost_when_level_and_not_at_all_at_10_degrees(ratio):
    level = judged(paper.trapped_wedge(0.0, mass_b=ratio)).neutral
    assert level.two_sided == 0
    assert level.one_sided >= 1
    leaning = judged(paper.trapped_wedge(10.0, mass_b=ratio)).neutral
    assert (leaning.two_sided, leaning.one_sided) == (0, 0)
