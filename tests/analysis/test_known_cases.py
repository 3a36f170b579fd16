"""Cases with known answers: blocks, stacks, walls and the figures of the paper."""

import dataclasses

import numpy as np
import pytest
from judged import judged
from transformations import tilted

from kilter import Assembly, GivenContact
from kilter.scenes import friction as accelerations
from kilter.scenes import paper, stacks, traps
from kilter.scenes.pieces import block, floor, prism

G = 9.81


# overhangs ------------------------------------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("count", [1, 2, 3, 5, 10, 20])
@pytest.mark.parametrize(("scale", "word"), [(1 - 1e-6, "stable"), (1 + 1e-4, "unstable")])
def test_o1_harmonic_stack_just_balances(count, scale, word):
    assembly = stacks.harmonic_stack(count, scale=scale)
    reach = float(assembly.parts[-1].pose.position[0]) + 0.5
    assert reach == pytest.approx(scale * sum(1 / k for k in range(1, count + 1)) / 2)
    assert judged(assembly).verdict == word


@pytest.mark.slow
def test_o2_three_blocks_balance_and_moved_by_a_thousandth_do_not():
    assert judged(stacks.three_block_overhang()).verdict == "balanced"
    assert judged(stacks.three_block_overhang(1e-3)).verdict == "unstable"


@pytest.mark.slow
@pytest.mark.parametrize(("rows", "word"), [(2, "balanced"), *((k, "unstable") for k in (3, 4, 5))])
def test_o3_inverted_triangle(rows, word):
    assert judged(stacks.inverted_triangle(rows)).verdict == word


@pytest.mark.quick(1)
@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
def test_o4_diamond(order):
    assert judged(stacks.diamond(order)).verdict == ("stable" if order < 5 else "unstable")


@pytest.mark.quick(2)
@pytest.mark.parametrize("count", [1, 2, 3, 4, 7])
@pytest.mark.parametrize("share", [0.98, 1 - 1e-6, 1 + 1e-6, 1.02])
def test_s3_staircase_stands_up_to_its_limit(count, share):
    verdict = judged(stacks.staircase(count, offset=share / (count + 1)))
    assert verdict.verdict == ("stable" if share < 1 else "unstable")


@pytest.mark.quick(1)
@pytest.mark.parametrize("count", [1, 3, 6])
@pytest.mark.parametrize("tilt", [0.01, 0.1, 5.0])
def test_s2_tower_without_friction_stands_upright_only(count, tilt):
    assert judged(stacks.tower(count)).verdict == "stable"
    verdict = judged(stacks.tower(count, tilt=tilt))
    assert verdict.verdict == "unstable"
    # all slide as one: no cube pushes another aside
    slide = [G * np.sin(np.radians(tilt)), 0, 0, 0, 0, 0]
    assert np.allclose(verdict.motion.acceleration[1:], slide, atol=1e-10)


@pytest.mark.quick(1)
@pytest.mark.parametrize("count", [1, 2, 4])
@pytest.mark.parametrize("off", [-0.01, 0.01])
def test_s2_body_that_cannot_slide_topples_at_one_over_its_height(count, off):
    # a foot that keeps it from sliding, given on its lower edge: tan(limit) = 1 / count
    body = block("body", [-0.5, -0.5, 0], [0.5, 0.5, count])
    feet = [[x, y, 0.0] for x in (-0.5, 0.5) for y in (-0.5, 0.5)]
    rest = GivenContact(("floor", "body"), feet, [0, 0, 1])
    stop = GivenContact(("body", "floor"), feet[2:], [1, 0, 0])
    angle = np.arctan(1 / count) + np.radians(off)
    down = [G * np.sin(angle), 0.0, -G * np.cos(angle)]
    parts = [floor([-2, -2], [2, 2]), body]
    verdict = judged(Assembly(parts, gravity=down, contacts=[rest, stop]))
    assert verdict.verdict == ("stable" if off < 0 else "unstable")


# accelerations --------------------------------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("angle", [0.5, 10.0, 30.0, 44.0])
@pytest.mark.parametrize("azimuth", [0.0, 22.5, 45.0, 200.0])
def test_s8_block_on_slope_starts_with_the_sine(angle, azimuth):
    verdict = judged(stacks.block_on_slope(angle, azimuth=azimuth))
    a, z = np.radians(angle), np.radians(azimuth)
    size = G * np.sin(a)
    way = [np.cos(a) * np.cos(z), np.cos(a) * np.sin(z), -np.sin(a)]
    assert np.allclose(verdict.motion.acceleration[1, :3], size * np.array(way), atol=1e-10)
    assert np.allclose(verdict.motion.acceleration[1, 3:], 0, atol=1e-9)
    assert verdict.motion.instability == pytest.approx(np.sin(a), abs=1e-10)


@pytest.mark.quick(1)
@pytest.mark.parametrize("angle", [15.0, 30.0, 45.0, 60.0])
@pytest.mark.parametrize(("m", "below"), [(1.0, 2.0), (3.0, 0.5), (1e-3, 10.0)])
@pytest.mark.parametrize("planar", [True, False])
def test_s8_wedge_on_wedge_starts_with_the_closed_form(angle, m, below, planar):
    verdict = judged(accelerations.wedge_on_wedge(angle, mass=m, mass_below=below, planar=planar))
    s, c = np.sin(np.radians(angle)), np.cos(np.radians(angle))
    aside = m * G * s * c / (below + m * s**2)
    a = verdict.motion.acceleration
    assert np.allclose(a[1], [-aside, 0, 0, 0, 0, 0], atol=1e-9)
    # the upper one falls by tan(angle) of the distance that they part
    assert a[2, 0] == pytest.approx(aside * below / m, abs=1e-9)
    assert a[2, 2] == pytest.approx(-(a[2, 0] - a[1, 0]) * s / c, abs=1e-9)


def test_box_past_an_edge_turns_about_it():
    # from x = -0.4 to 0.6 on a table that ends at x = 0
    box = block("box", [-0.4, -0.5, 0], [0.6, 0.5, 1], mass=1.0)
    verdict = judged(Assembly([floor([-3, -1], [0, 1]), box]))
    # without friction the edge holds only upwards: the centre falls straight down
    alpha = G * 0.1 / (1 / 6 + 0.1**2)
    a = verdict.motion.acceleration[1]
    assert np.allclose(a, [0, 0, -alpha * 0.1, 0, alpha, 0], atol=1e-10)


# near the limit -------------------------------------------------------------------------


@pytest.mark.quick(2)
@pytest.mark.parametrize("past", [1e-3, 1e-6, 1e-7, 1e-8])
@pytest.mark.parametrize("size", [0.01, 1.0, 100.0])
@pytest.mark.parametrize("side", [-1, 1])
def test_box_just_past_an_edge_is_answered_rightly(past, size, side):
    x = side * past * size
    box = block("box", [x - size / 2, 0, 0], [x + size / 2, size, size])
    table = block("table", [-3 * size, -size, -size], [0, 2 * size, 0], grounded=True)
    verdict = judged(Assembly([table, box]))
    assert verdict.verdict == ("stable" if side < 0 else "unstable")


@pytest.mark.quick(1)
@pytest.mark.parametrize("scale", [1 - 1e-7, 1 - 1e-8, 1 + 1e-7, 1 + 1e-8])
def test_staircase_is_answered_rightly_to_eight_digits(scale):
    verdict = judged(stacks.staircase(4, offset=scale / 5))
    assert verdict.verdict == ("stable" if scale < 1 else "unstable")


# friction, where it changes nothing -----------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("friction_", [0.3, 1.0, 1e9])
def test_friction_cannot_hold_what_touches_nothing(friction_):
    verdict = judged(traps.floating_block().with_friction(friction_))
    assert verdict.verdict == "unstable"
    assert verdict.moving == ["cube-2"]


def test_friction_cannot_hold_a_box_whose_weight_no_contact_reaches():
    # it hangs 60 % over the edge: contacts can only push up at one side of its weight
    box = block("box", [-0.4, -0.5, 0], [0.6, 0.5, 1])
    assembly = Assembly([floor([-3, -1], [0, 1]), box], friction=1.0)
    assert judged(assembly).verdict == "unstable"


# traps of others ------------------------------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("index", [0, 2, -1])
def test_w1_floating_block_falls_at_one_g_wherever_it_is_listed(index):
    verdict = judged(traps.floating_block(index))
    assert verdict.verdict == "unstable"
    part = 1 + index % 5
    assert verdict.moving == [f"cube-{index % 5}"]
    assert np.allclose(verdict.motion.acceleration[part], [0, 0, -G, 0, 0, 0], atol=1e-12)
    assert verdict.words(part) == "falls 1 m onto floor"
    assert (verdict[part].below, verdict[part].fall) == ("floor", 1.0)
    assert verdict.motion.instability == pytest.approx(np.sqrt(1 / 5))
    assert any("touches nothing" in text for text in verdict.warnings)


def test_w2_cube_that_overlaps_in_mid_air_is_undecided_and_named():
    verdict = judged(traps.penetrating_cube())
    assert verdict.verdict == "undecided"
    assert "it would hold if 'held' and 'cube'" in verdict.sentence
    assert verdict.motion.moves.tolist() == [False, True]  # as drawn it falls
    assert len(verdict.contact_set.overlaps) == 1
    assert verdict.contact_set.overlaps[0].volume == pytest.approx(0.1)
    text = next(text for text in verdict.warnings if "overlap" in text)
    assert "'held'" in text
    assert "'cube'" in text


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.45, 0.75])
def test_w3_overhang_at_every_size_and_density(share):
    for assembly in stacks.overhanging_cubes(share):
        assert judged(assembly).verdict == ("stable" if share < 0.5 else "unstable")


@pytest.mark.quick(2)
@pytest.mark.parametrize("units", ["m", "cm", "mm", "in"])
@pytest.mark.parametrize(("share", "word"), [(0.5 - 1e-6, "stable"), (0.5 + 1e-6, "unstable")])
def test_w3_overhang_at_its_limit_in_every_unit(units, share, word):
    assert judged(stacks.overhang(share, size=7.0, units=units)).verdict == word


@pytest.mark.slow
def test_w7_laden_slab_loses_no_patch():
    verdict = judged(traps.laden_slab())
    assert verdict.verdict == "stable"
    assert len(verdict.contact_set) == 125


@pytest.mark.slow
def test_w8_two_patches_of_one_plane_and_a_ring_have_the_right_area():
    bridge, ring = judged(traps.bridge_on_slab()), judged(traps.ring_on_slab())
    assert (bridge.verdict, ring.verdict) == ("stable", "stable")
    assert bridge.contact_set.patch_area.sum() == pytest.approx(2.0)
    assert ring.contact_set.patch_area.sum() == pytest.approx(12.0)
    assert len(bridge.contact_set) == len(ring.contact_set) == 1


@pytest.mark.slow
@pytest.mark.parametrize("offset", [1.499, 1.501])
def test_w8_hull_of_a_bridge_carries_up_to_its_ends(offset):
    # a bridge whose weight is moved along x: the hull of both feet reaches from -2 to 2
    polygon = [[-2, 0], [-1, 0], [-1, 1], [1, 1], [1, 0], [2, 0], [2, 2], [-2, 2]]
    for x, word in ((offset, "stable"), (2 - 1e-6, "stable"), (2 + 1e-6, "unstable")):
        bridge = prism("bridge", polygon, mass=1.0, center_of_mass=[x, 0, 1.5])
        assert judged(Assembly([floor([-3, -1], [3, 1]), bridge])).verdict == word


def test_w9_inward_base_is_turned_and_the_verdict_as_if_right():
    verdict = judged(traps.inward_base())
    assert verdict.verdict == "stable"
    assert any("pointed inwards" in text for text in verdict.warnings)
    assert judged(tilted(traps.inward_base(), [0, 1, 0], 1.0)).verdict == "unstable"


def test_everything_held_is_stable_with_a_warning():
    assembly = stacks.tower(2).with_grounded(["*"])
    verdict = judged(assembly)
    assert verdict.verdict == "stable"
    assert any("every part is held" in text for text in verdict.warnings)


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
