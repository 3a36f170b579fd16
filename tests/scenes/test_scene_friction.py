"""Scenes of arches and of parts held by friction."""

import numpy as np
import pytest
from scene_oracle import frictional, gauss, overlapping, stable, touching

from kilter.errors import InputError
from kilter.scenes import accelerations, arches, friction, rounds, stacks

HOLDS = 1e-8


class TestArches:
    @pytest.mark.slow
    @pytest.mark.parametrize(("sectors", "count", "least"), [
        (True, 20, 0.10746), (True, 40, 0.10746), (False, 20, 0.10735), (False, 40, 0.10743),
    ])  # fmt: skip
    def test_least_thickness(self, sectors, count, least):
        for off, holds in ((1e-5, True), (-1e-5, False)):
            assembly = arches.arch(count, ratio=least + off, friction=10, sectors=sectors)
            assert (frictional(assembly) < 1e-9) == holds

    @pytest.mark.quick(1)
    @pytest.mark.parametrize(("count", "sector", "straight"), [
        (7, 0.370010, 0.373612), (13, 0.358076, 0.358857), (28, 0.354686, 0.354868),
    ])  # fmt: skip
    def test_oppenheim_arch_load_factor(self, count, sector, straight):
        for sectors, factor in ((True, sector), (False, straight)):
            assembly = arches.oppenheim_arch(count, sectors=sectors)
            assert frictional(assembly, push=(1, 0, 0)) == pytest.approx(factor, abs=1e-6)

    @pytest.mark.slow
    @pytest.mark.parametrize(("ratio", "count", "sector", "straight"), [
        (0.15, 27, 0.145104, 0.145338), (0.2, 100, 0.283792, 0.283809),
    ])  # fmt: skip
    def test_semicircle_load_factor(self, ratio, count, sector, straight):
        for sectors, factor in ((True, sector), (False, straight)):
            assembly = arches.arch(count, ratio=ratio, friction=10, sectors=sectors)
            assert frictional(assembly, push=(1, 0, 0)) == pytest.approx(factor, abs=1e-6)

    @pytest.mark.quick(1)
    @pytest.mark.parametrize(
        ("count", "thickness"), [(12, 0.5), (12, 1), (12, 2), (20, 0.5), (20, 2), (6, 2)]
    )
    def test_thicker_is_safer(self, count, thickness):
        assembly = arches.arch_with_held_ends(count, thickness=thickness)
        assert frictional(assembly, sides=16) < HOLDS
        assert len(touching(assembly).pairs) == count - 1

    def test_sectors_weigh_half_a_ring(self):
        geometry = arches.arch(9, ratio=0.2, radius=1.0, sectors=True).geometry
        ring = np.pi / 2 * (1.1**2 - 0.9**2) * 1000
        assert geometry.mass[2:].sum() == pytest.approx(ring)
        height = (geometry.mass[2:] @ geometry.center[2:, 2]) / ring
        assert height == pytest.approx(2 / 3 * (1.1**3 - 0.9**3) * 1000 / ring)

    @pytest.mark.parametrize("span", [60, 157.5, 180])
    def test_springers_carry_and_do_not_overlap(self, span):
        assembly = arches.arch(6, span=span)
        assert overlapping(assembly) == []
        assert len(touching(assembly).pairs) == 7

    def test_refuses_more_than_a_semicircle(self):
        with pytest.raises(InputError, match="span 181"):
            arches.arch(5, span=181)


class TestHeldByFriction:
    @pytest.mark.quick(3)
    @pytest.mark.parametrize(("wall", "limit"), [(0.0, 51.3402), (0.3, 47.7263)])
    @pytest.mark.parametrize("planar", [True, False])
    def test_ladder(self, wall, limit, planar):
        for off, holds in ((0.01, True), (-0.01, False)):
            assembly = friction.ladder(limit + off, friction_wall=wall, planar=planar)
            assert (frictional(assembly) < HOLDS) == holds

    @pytest.mark.parametrize("mu", [0.3, 0.6])
    def test_bracket(self, mu):
        for factor, holds in ((1.02, True), (0.98, False)):
            assembly = friction.bracket(factor * 0.5 / mu, friction=mu)
            assert (frictional(assembly) < HOLDS) == holds

    @pytest.mark.parametrize(("count", "mu", "height"), [(4, 0.5, 0.25), (8, 0.9, 0.1)])
    def test_books(self, count, mu, height):
        weight, thickness = 9.81, 0.05
        least = max(count * weight / (2 * mu), count**2 * weight * thickness / (8 * height))
        for factor, holds in ((1.02, True), (0.98, False)):
            assembly = friction.books(count, force=factor * least, friction=mu, height=height)
            assert (frictional(assembly, sides=16) < HOLDS) == holds

    def test_squeezed_and_leaning_plates(self):
        assert frictional(friction.h_block(friction=0.01, planar=True)) < HOLDS
        limit = np.tan(np.radians(10))
        assert frictional(friction.a_block(10, friction=1.02 * limit, planar=True)) < HOLDS
        assert frictional(friction.a_block(10, friction=0.98 * limit, planar=True)) > 1e-3
        for planar in (True, False):
            assert stable(friction.v_block(planar=planar))

    @pytest.mark.parametrize(("slope", "mu", "limit"), [(30, 0.84, 47.961), (45, 0.5, 39.232)])
    def test_trough_statically(self, slope, mu, limit):
        for off, holds in ((-0.2, True), (0.2, False)):
            assembly = friction.trough(slope, tilt=limit + off, friction=mu)
            assert (frictional(assembly, sides=128) < HOLDS) == holds

    def test_none_overlap(self):
        for assembly in (
            friction.a_block(),
            friction.v_block(),
            friction.ladder(75),
            friction.bracket(0.2, height=0.5),
        ):
            assert overlapping(assembly) == []

    def test_refuses_plates_that_lean_too_far(self):
        with pytest.raises(InputError, match="half angle is 60"):
            friction.a_block(60)


def test_wedges_touch_along_the_slope_and_do_not_overlap():
    for angle in (15, 30, 60):
        assembly = accelerations.wedge_on_wedge(angle)
        assert touching(assembly).pairs == {(0, 1), (1, 2)}
        assert overlapping(assembly) == []


@pytest.mark.parametrize("angle", [15, 30, 60])
@pytest.mark.parametrize(("mass", "below"), [(1.0, 2.0), (3.0, 1.0)])
def test_wedges_start_with_the_closed_form_and_do_not_turn(angle, mass, below):
    sine, cosine = np.sin(np.radians(angle)), np.cos(np.radians(angle))
    start = mass * sine * cosine / (below + mass * sine**2)
    lower, upper = gauss(accelerations.wedge_on_wedge(angle, mass=mass, mass_below=below))
    assert np.allclose(lower, [-start, 0, 0, 0, 0, 0], atol=1e-5)
    assert np.allclose(upper[3:], 0, atol=1e-5)
    assert np.isclose((upper - lower)[:3] @ [sine, 0, cosine], 0, atol=1e-5)


def test_block_on_slope_starts_with_the_sine():
    (start,) = gauss(stacks.block_on_slope(20, azimuth=30))
    sine = np.sin(np.radians(20))
    assert np.isclose(np.linalg.norm(start[:3]), sine, atol=1e-6)
    assert np.allclose(start[3:], 0, atol=1e-6)


def test_round_parts_touch_their_neighbours():
    for assembly in (rounds.three_cylinders(), rounds.four_spheres()):
        centers = assembly.geometry.center[1:]
        apart = np.linalg.norm(centers[:, None] - centers, axis=-1)
        touching_pairs = np.isclose(apart, 2.0).sum() / 2
        assert touching_pairs == len(centers) * (len(centers) - 1) / 2
        assert np.isclose(centers[:-1, 2], 1.0).all()
