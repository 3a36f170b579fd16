import numpy as np
import pytest
from scene_oracle import imbalance, least_motion, lp9, neutral, overlapping, stable, touching
from transformations import tilted

from kilter.errors import InputError
from kilter.scenes import paper

IN_PLANE_AND_IN_SPACE = pytest.mark.parametrize("planar", [True, False])


@IN_PLANE_AND_IN_SPACE
class TestFigures:
    def test_1_is_unstable_and_turned_by_45_degrees_stable(self, planar):
        assert lp9(paper.figure_1("a", planar=planar))[0] == pytest.approx(-1.0)
        turned = paper.figure_1("b", planar=planar)
        assert stable(turned)
        assert turned.gravity.tolist() == [0, 0, -9.81]
        assert np.allclose(turned.parts[0].pose.matrix[0], [np.sqrt(0.5), 0, -np.sqrt(0.5)])

    def test_1_c2_sinks_and_c3_gives_way_to_the_right(self, planar):
        dp = least_motion(paper.figure_1(planar=planar)).reshape(2, -1)
        up = 1 if planar else 2
        assert np.allclose(dp[:, [0, up]], [[0, -1], [1, 0]], atol=1e-6)

    @pytest.mark.quick(5)
    @pytest.mark.parametrize(("orientation", "z"), [(1, -5), (2, -2.5), (3, 0), (4, 0)])
    def test_4_z_rises_as_gravity_turns(self, planar, orientation, z):
        assert lp9(paper.figure_4(orientation, planar=planar))[0] == pytest.approx(z, abs=1e-9)

    @pytest.mark.quick(2)
    @pytest.mark.parametrize("angle", [45, 60, 75])
    def test_8_c2_sinks_by_1_and_c3_goes_aside_by_its_cotangent(self, planar, angle):
        assembly = paper.figure_8(angle, planar=planar)
        assert lp9(assembly)[0] == pytest.approx(-1.0)
        expected = np.zeros((2, 3 if planar else 6))
        expected[0, 1 if planar else 2] = -1
        expected[1, 0] = 1 / np.tan(np.radians(angle))
        assert np.allclose(least_motion(assembly), expected.ravel(), atol=1e-6)

    def test_8_has_three_contacts(self, planar):
        assert touching(paper.figure_8(planar=planar)).pairs == {(0, 1), (0, 2), (1, 2)}

    def test_9_is_stable_and_a_loop(self, planar):
        assembly = paper.figure_9(planar=planar)
        assert stable(assembly)
        assert lp9(assembly)[0] == pytest.approx(0.0, abs=1e-9)
        frame, loop = {(0, k) for k in range(1, 5)}, {(1, 2), (2, 3), (3, 4), (1, 4)}
        assert touching(assembly).pairs == frame | loop

    @pytest.mark.slow
    def test_10_is_stable_between_minus_x_and_minus_z_only(self, planar):
        assembly = paper.figure_10("a", planar=planar)
        assert not stable(assembly)
        assert stable(paper.figure_10("b", planar=planar))
        for lean in (0.0, 0.01, 30, 60, 89.99, 90.0):  # from -z toward -x
            assert stable(tilted(assembly.with_down([0, 0, -1]), [0, 1, 0], lean))
        for lean in (-0.01, 90.01):
            assert not stable(tilted(assembly.with_down([0, 0, -1]), [0, 1, 0], lean))

    @pytest.mark.quick(1)
    @pytest.mark.parametrize(
        ("figure", "leans"), [(paper.figure_11, 45.0), (paper.figure_12, 60.0)]
    )
    def test_11_and_12_are_stable_at_their_angle_only(self, planar, figure, leans):
        assembly = figure("a", planar=planar)
        assert not stable(assembly)
        assert stable(figure("b", planar=planar))
        assert stable(tilted(assembly, [0, 1, 0], leans))
        for off in (-0.01, 0.01):
            assert imbalance(tilted(assembly, [0, 1, 0], leans + off)) > 1e-5

    @pytest.mark.quick(1)
    @pytest.mark.parametrize("angle", [30, 45, 60])
    @pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0])
    def test_11_for_unequal_masses_and_other_chamfers(self, planar, angle, ratio):
        options = {"mass_b": ratio, "planar": planar}
        assembly = paper.two_blocks_in_an_l(angle, **options)
        assert stable(paper.two_blocks_in_an_l(angle, stable=True, **options))
        leans = np.degrees(np.arctan(ratio * np.tan(np.radians(angle))))
        assert stable(tilted(assembly, [0, 1, 0], leans))
        assert not stable(tilted(assembly, [0, 1, 0], leans + 0.01))
        assert not stable(tilted(assembly, [0, 1, 0], leans - 0.01))


def test_1_has_two_identical_blocks():
    geometry = paper.figure_1().geometry
    assert np.isclose(geometry.volume[1], geometry.volume[2], rtol=1e-14)
    assert np.allclose(geometry.center[1], geometry.center[2][[2, 1, 0]])


@pytest.mark.slow
def test_9_circulates_at_no_cost_and_moves_no_other_way_in_the_plane():
    assert neutral(paper.figure_9(planar=True)) == (1, 0)


def test_9_has_identical_blocks_of_exact_coordinates():
    geometry = paper.figure_9().geometry
    assert np.array_equal(geometry.vertices, geometry.vertices.round(1))
    assert np.allclose(geometry.volume[1:], 7.0)
    assert np.isclose(geometry.volume[0], 64 - 36)


@pytest.mark.parametrize(("angle", "from_down"), [(45, 63.435), (60, 73.898)])
def test_stable_direction_of_unequal_masses(angle, from_down):
    down = paper.stable_direction(angle, 1.0, 2.0)
    assert np.degrees(np.arccos(-down[2])) == pytest.approx(from_down, abs=1e-3)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0])
class TestTrappedWedge:
    @pytest.mark.quick(1)
    def test_holds_up_to_its_limits(self, ratio):
        limit = np.degrees(np.arctan(1 / ratio))
        for tilt in (0.0, 0.01, 10.0, limit / 2, limit - 0.01):
            assert stable(paper.trapped_wedge(tilt, mass_b=ratio))

    def test_fails_just_outside_them(self, ratio):
        limit = np.degrees(np.arctan(1 / ratio))
        for tilt in (-0.01, limit + 0.01):
            assert imbalance(paper.trapped_wedge(tilt, mass_b=ratio)) > 1e-5

    def test_holds_in_space_too(self, ratio):
        assert stable(paper.trapped_wedge(10.0, mass_b=ratio, planar=False))

    @pytest.mark.slow
    def test_moves_at_no_cost_when_level_and_not_at_all_when_tilted(self, ratio):
        two_sided, one_sided = neutral(paper.trapped_wedge(0.0, mass_b=ratio))
        assert two_sided == 0
        assert one_sided >= 1
        assert neutral(paper.trapped_wedge(10.0, mass_b=ratio)) == (0, 0)


def test_no_parts_overlap_at_other_parameters():
    for assembly in (
        *(paper.two_blocks_in_an_l(c) for c in (30, 60)),
        *(paper.figure_8(c) for c in (45, 75)),
        paper.figure_10("b"),
        paper.figure_12("b"),
    ):
        assert overlapping(assembly) == []


def test_refuses_what_the_figures_do_not_have():
    with pytest.raises(InputError, match="no orientation 5"):
        paper.figure_4(5)
    with pytest.raises(InputError, match="no orientation 'c'"):
        paper.figure_1("c")
