"""Scenes of towers, overhangs, walls, piles and wedges."""

import time

import numpy as np
import pytest
from scene_oracle import frictional, imbalance, neutral, overlapping, stable, touching

from kilter.errors import InputError
from kilter.scenes import packings, stacks, traps, walls, wedges

HOLDS = 1e-8


class TestStacks:
    @pytest.mark.parametrize("count", [1, 3, 5])
    def test_tower_topples_at_one_over_its_count(self, count):
        limit = np.degrees(np.arctan(1 / count))
        assert frictional(stacks.tower(count, tilt=0.98 * limit, friction=2)) < HOLDS
        assert frictional(stacks.tower(count, tilt=1.02 * limit, friction=2)) > 1e-4

    @pytest.mark.parametrize("count", [1, 2, 5])
    def test_staircase_holds_to_one_over_count_plus_one(self, count):
        limit = 1 / (count + 1)
        assert stable(stacks.staircase(count, offset=0.98 * limit))
        assert not stable(stacks.staircase(count, offset=1.02 * limit))

    @pytest.mark.quick(2)
    @pytest.mark.parametrize("count", [1, 2, 5, 20])
    def test_harmonic_stack_is_balanced_at_scale_one(self, count):
        assert stable(stacks.harmonic_stack(count, scale=1 - 1e-6))
        assert not stable(stacks.harmonic_stack(count, scale=1 + 1e-4))
        top = stacks.harmonic_stack(count, scale=1).parts[-1]
        half_harmonic = sum(1 / k for k in range(1, count + 1)) / 2
        assert top.pose.position[0] + 0.5 == pytest.approx(half_harmonic, abs=1e-14)

    def test_three_blocks_are_balanced_until_moved(self):
        assert stable(stacks.three_block_overhang())
        assert not stable(stacks.three_block_overhang(1e-3))

    @pytest.mark.quick(2)
    @pytest.mark.parametrize(("rows", "holds"), [(2, True), (3, False), (4, False), (5, False)])
    def test_inverted_triangle(self, rows, holds):
        assert stable(stacks.inverted_triangle(rows)) == holds

    @pytest.mark.quick(1)
    @pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
    def test_diamond_holds_up_to_four(self, order):
        assert stable(stacks.diamond(order)) == (order <= 4)

    def test_overhang_at_every_size_and_density(self):
        for share, holds in ((0.45, True), (0.75, False)):
            for assembly in stacks.overhanging_cubes(share):
                size = float(assembly.geometry.size[0])
                found = touching(assembly, scale=size)
                assert found.pairs == {(0, 1)}
                reach = found.x[:, 0].max() - assembly.geometry.center[1, 0]
                assert (reach > 0) == holds
                if size == 1.0:
                    assert stable(assembly) == holds

    @pytest.mark.quick(3)
    @pytest.mark.parametrize("azimuth", [0, 22.5, 45, 200])
    def test_slope_slides_past_its_friction_whatever_its_direction(self, azimuth):
        holds = stacks.block_on_slope(26, azimuth=azimuth, friction=0.5)
        slides = stacks.block_on_slope(28, azimuth=azimuth, friction=0.5)
        assert frictional(holds, sides=64) < HOLDS
        assert frictional(slides, sides=64) > 1e-4

    def test_slender_block_tips_on_the_slope(self):
        limit = np.degrees(np.arctan(0.5))
        for factor, holds in ((0.98, True), (1.02, False)):
            assembly = stacks.block_on_incline(1.0, 2.0, factor * limit, 3.0)
            assert (frictional(assembly) < HOLDS) == holds


class TestWalls:
    @pytest.mark.quick(2)
    @pytest.mark.parametrize("build", [walls.wall, walls.stack_bond, walls.wall_with_lintel])
    @pytest.mark.parametrize("courses", [1, 2, 5])
    def test_whole_walls_are_stable(self, build, courses):
        assert stable(build(courses, 3) if build is not walls.wall_with_lintel else build(7, 7))

    @pytest.mark.slow
    @pytest.mark.parametrize("opening", [(2, 4, 1, 3), (2, 4, 2, 4), (3, 4, 0, 3), (2, 5, 1, 2)])
    def test_lintel_saves_what_falls_into_the_opening(self, opening):
        assert stable(walls.wall_with_lintel(5, 6, opening=opening))
        assert overlapping(walls.wall_with_lintel(5, 6, opening=opening)) == []
        wide = opening[1] - opening[0] > 1
        assert stable(walls.wall_with_opening(5, 6, opening=opening)) != wide

    @pytest.mark.slow
    def test_wall_on_short_base_and_hanging_brick_fall(self):
        assert not stable(walls.short_base())
        hung = walls.hanging_brick()
        assert not stable(hung)
        names = [hung.names[k] for k in falling(hung)]
        assert len(names) == 1
        rest = hung.without(names)
        assert stable(rest)

    @pytest.mark.parametrize(("courses", "per_course"), [(3, 4), (4, 3)])
    def test_wall_without_room_for_a_lintel_is_refused(self, courses, per_course):
        walls.hanging_brick(4, 4)
        with pytest.raises(InputError, match="no room for a lintel"):
            walls.hanging_brick(courses, per_course)

    @pytest.mark.slow
    def test_head_joints_may_be_open(self):
        closed, opened = walls.wall(3, 3), walls.wall(3, 3, gap=0.005)
        assert len(touching(closed).pairs) > len(touching(opened).pairs)
        assert stable(opened)

    def test_gap_that_eats_the_brick_is_refused(self):
        with pytest.raises(InputError, match="too large for a brick"):
            walls.wall(3, 3, gap=0.1)

    @pytest.mark.slow
    @pytest.mark.parametrize(("number", "blocks", "interfaces", "factor"), [
        (1, 33, 83, 0.64286), (2, 55, 141, 0.58000), (3, 46, 102, 0.40369),
        (4, 55, 116, 0.33195), (5, 61, 120, 0.23964), (6, 146, 345, 0.34782),
    ])  # fmt: skip
    def test_ferris_and_tin_loi_to_five_digits(self, number, blocks, interfaces, factor):
        assembly = walls.ferris_tin_loi(number)
        assert len(assembly.parts) - 1 == blocks
        assert len(touching(assembly).pairs) == interfaces
        assert frictional(assembly, push=(1, 0, 0)) == pytest.approx(factor, abs=6e-6)

    @pytest.mark.slow
    def test_tilted_wall_overturns_and_slides_at_its_angles(self):
        for friction, limit in ((0.6, 10.49), (0.15, 8.53)):
            for off, holds in ((-0.1, True), (0.1, False)):
                assembly = walls.tilted_wall(limit + off, friction=friction, per_course=2)
                assert (frictional(assembly, sides=16) < HOLDS) == holds

    def test_base_reaches_past_the_wall(self):
        base = walls.wall(2, 5).geometry.vertices[:8]
        assert np.allclose(np.ptp(base, axis=0), [1.2, 0.2, 0.06])

    @pytest.mark.parametrize("count", [1, 10, 1000])
    def test_wall_of_about_a_count(self, count):
        assert len(walls.wall_of(count).parts) - 1 == pytest.approx(count, rel=0.06)

    @pytest.mark.slow
    def test_large_walls_are_fast(self):
        start = time.process_time()
        walls.wall_of(10_000)
        assert time.process_time() - start < 1.5


def falling(assembly):
    """Free parts without a contact with a part vertically below."""
    found = touching(assembly)
    up = found.n[:, 2]
    carried = set(found.b[up > 0.5]) | set(found.a[up < -0.5])
    free = np.flatnonzero(~assembly.geometry.grounded)
    return [int(k) for k in free if k not in carried]


class TestPilesAndWedges:
    @pytest.mark.slow
    @pytest.mark.parametrize("seed", range(5))
    def test_level_piles_are_stable(self, seed):
        assembly = packings.box_pile(20, seed=seed)
        assert overlapping(assembly) == []
        assert stable(assembly)

    @pytest.mark.quick(1)
    @pytest.mark.parametrize("seed", range(3))
    def test_careless_piles_do_not_overlap(self, seed):
        assembly = packings.box_pile(20, seed=seed, level=False)
        assert overlapping(assembly) == []
        assert not stable(assembly)

    @pytest.mark.quick(3)
    @pytest.mark.parametrize("seed", range(4))
    @pytest.mark.parametrize("count", [1, 4, 9])
    def test_corner_wedges_fill_the_cube(self, seed, count):
        assembly = wedges.corner_wedges(count, seed=seed)
        assert assembly.geometry.volume[3:].sum() == pytest.approx(8.0, rel=1e-13)
        assert overlapping(assembly) == []
        assert len(assembly.parts) == count + 3

    def test_corner_boxes_are_stable(self):
        assert stable(wedges.corner_boxes(2))

    @pytest.mark.quick(2)
    @pytest.mark.parametrize("angle", [5, 15, 30])
    def test_keystone_is_stable(self, angle):
        assembly = wedges.keystone(angle)
        assert stable(assembly)
        assert overlapping(assembly) == []


class TestTraps:
    @pytest.mark.quick(2)
    @pytest.mark.parametrize("index", [0, 2, -1])
    def test_one_block_floats(self, index):
        assembly = traps.floating_block(index)
        assert imbalance(assembly) == pytest.approx(0.2)
        assert len(falling(assembly)) == 1

    def test_cube_penetrates_and_touches_nothing(self):
        assembly = traps.penetrating_cube()
        assert overlapping(assembly) == [("held", "cube")]
        assert touching(assembly).pairs == set()

    @pytest.mark.slow
    def test_slab_carries_125(self):
        assembly = traps.laden_slab()
        assert len(touching(assembly).pairs) == 125

    @pytest.mark.slow
    def test_two_patches_and_a_ring_have_their_areas(self):
        for build, volume in ((traps.bridge_on_slab, 6.0), (traps.ring_on_slab, 12.0)):
            assembly = build()
            assert assembly.geometry.volume[1] == pytest.approx(volume)
            assert stable(assembly)
            assert neutral(assembly) == (3, 0)  # slides in x and y, turns about z

    def test_inward_base_is_turned_with_a_warning(self):
        assembly = traps.inward_base()
        assert "pointed inwards" in assembly.geometry.warnings[0]
        assert stable(assembly)

    def test_no_such_cube(self):
        with pytest.raises(InputError, match="no cube 7"):
            traps.floating_block(7)
