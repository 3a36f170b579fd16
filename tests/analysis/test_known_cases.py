"""Closed forms without friction: stacks and overhangs, first accelerations, traps of others."""

import numpy as np
import pytest
from judged import judged
from transformations import tilted

from kilter.assembly import Assembly, GivenContact
from kilter.scenes import accelerations, stacks, traps
from kilter.scenes.pieces import block, floor, prism, turn
from kilter.scenes.transform import moved

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
@pytest.mark.parametrize("past", [1e-6, 1e-7, 1e-8])
@pytest.mark.parametrize("side", [-1, 1])
def test_turned_box_just_past_an_edge_is_answered_rightly(past, side):
    box = block("box", [side * past - 0.5, -0.5, 0], [side * past + 0.5, 0.5, 1])
    assembly = Assembly([floor([-3, -1], [0, 1]), box])
    turned = moved(assembly, turn([1, 2, 3], 77.0), [3.0, -2.0, 1.0])
    assert judged(turned).verdict == ("stable" if side < 0 else "unstable")


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
    assert verdict.words(part) == "falls freely at 1 g"
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
