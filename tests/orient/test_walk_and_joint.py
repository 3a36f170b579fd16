"""Problem 2 on the paper's diamond: the walk, the joint program, the figures."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from turning import ALL, UNSTABLE, angle_from_down, program_of

from kilter import InputError, Load
from kilter.analysis.turning.facet_program import joint
from kilter.analysis.turning.virtual_work import VirtualWork, facets_of_diamond
from kilter.analysis.turning.walk import is_best, walk
from kilter.mechanics.certificate import check_motion
from kilter.scenes import paper, scene, stacks, wedges

METHODS = pytest.mark.parametrize("method", [walk, joint])
PLANAR = pytest.mark.parametrize("planar", [False, True])


def mass_of(program):
    return float(program.mass[program.free].sum())


# the paper's figures -----------------------------------------------------------------


@pytest.mark.quick(2)
@METHODS
@PLANAR
@pytest.mark.parametrize(
    ("chamfer", "mass_b", "expected"),
    [
        (45, 1, 45.0),
        (60, 1, 60.0),
        (45, 2, 63.43494882),
        (60, 2, 73.89788625),
        (45, 0.5, 26.56505118),
    ],
)
def test_two_blocks_in_an_l_stand_in_one_direction_to_a_millionth_of_a_degree(
    method, planar, chamfer, mass_b, expected
):
    program = program_of(paper.two_blocks_in_an_l(chamfer, mass_b=mass_b, planar=planar))
    best = method(program)
    assert best.z == pytest.approx(0.0, abs=1e-9 * mass_of(program))
    assert angle_from_down(best.gravity) == pytest.approx(expected, abs=1e-6)
    assert abs(best.gravity[1]) < 1e-8


# the two methods agree ---------------------------------------------------------------


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ALL)
def test_walk_and_joint_agree_on_every_facet(name):
    program = program_of(name)
    scale = mass_of(program)
    walked, joined = walk(program, every=True), joint(program, every=True)
    assert walked.z == pytest.approx(joined.z, abs=1e-8 * scale)
    for one, other in zip(walked.facets, joined.facets, strict=True):
        assert (one.signs == other.signs).all()
        assert one.optimal
        assert one.z == pytest.approx(other.z, abs=1e-8 * scale)
        assert (one.heights <= other.z + 1e-8 * scale).all()
    assert len(walked.facets) == (4 if program.planar else 8)
    assert (joined.z < -1e-6 * scale) == (name in UNSTABLE)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["arch", "inverted-triangle", "short-base-turned", "keystone"])
def test_the_directions_found_have_the_z_that_is_said(name):
    program = program_of(name)
    work, scale = VirtualWork(program), mass_of(program)
    for best in (walk(program, every=True), joint(program, every=True)):
        for facet in best.facets:
            assert np.abs(facet.gravity).sum() == pytest.approx(1.0, abs=1e-12)
            assert (facet.gravity * facet.signs >= 0).all()
            assert work.solve(facet.gravity).z * scale == pytest.approx(facet.z, abs=1e-8 * scale)


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", UNSTABLE)
def test_one_motion_a_facet_proves_that_no_direction_of_it_is_stable(name):
    program = program_of(name)
    for facet in joint(program, every=True).facets:
        for axis in np.flatnonzero(facet.signs):
            corner = facet.signs * (np.arange(3) == axis) * 9.81
            assert check_motion(program.with_rows(gravity=corner), facet.motion).holds


@pytest.mark.slow
def test_a_stop_of_the_published_rule_may_fail_the_test_and_is_counted():
    walked = walk(program_of(wedges.corner_wedges(6)), every=True)
    assert walked.failed > 0
    assert walked.restarts == walked.failed
    assert sum(walked.stops.values()) == 8 + walked.restarts
    assert walked.programs > 2 * walked.partitions - 1
    assert walked.published <= walked.z


def test_the_test_of_optimality_tells_the_best_from_the_rest():
    program = program_of("arch")
    work = VirtualWork(program)
    for facet in joint(program, every=True).facets:
        best = is_best(work.unit, facet.signs, facet.gravity, work.solve(facet.gravity).z)
        assert best.best
        corner = facet.signs * np.array([0.9, 0.0, 0.1])
        z = work.solve(corner).z
        if z < facet.z / mass_of(program) - 1e-6:
            worse = is_best(work.unit, facet.signs, corner, z)
            assert not worse.best
            rising = corner + 1e-4 * (worse.toward - corner)
            assert work.solve(rising).z > z


def test_it_stops_at_the_first_facet_with_z_0_unless_told():
    program = program_of(stacks.tower(3))
    assert len(joint(program).facets) == len(walk(program).facets) == 1
    assert len(joint(program, every=True).facets) == 8
    assert joint(program).programs == 1


# concavity, (12) to (16) -------------------------------------------------------------

WORKS = {name: VirtualWork(program_of(name)) for name in ("paper-figure-8", "arch-7", "wedges-4")}


@given(
    name=st.sampled_from(sorted(WORKS)),
    facet=st.integers(0, 7),
    one=st.tuples(*[st.floats(0, 1)] * 3),
    other=st.tuples(*[st.floats(0, 1)] * 3),
    share=st.floats(0, 1),
)
def test_z_is_concave_on_a_facet(name, facet, one, other, share):
    work = WORKS[name]
    signs = np.array([1 - 2 * (facet & 1), 1 - (facet & 2), 1 - (facet & 4) / 2])
    ends = []
    for point in (one, other):
        shares = np.array(point) * (np.isin(np.arange(3), work.unit.axes)) + 1e-300
        ends.append(signs * shares / shares.sum())
    between = share * ends[0] + (1 - share) * ends[1]
    z = [work.solve(g).z for g in (*ends, between)]
    assert z[2] >= share * z[0] + (1 - share) * z[1] - 1e-9
    assert max(z) <= 0.0


# degenerate input --------------------------------------------------------------------


@METHODS
def test_nothing_is_free(method):
    assembly = stacks.tower(2).with_grounded(["*"])
    assert method(program_of(assembly)).z == 0.0


@METHODS
def test_a_part_that_touches_nothing_falls_in_every_direction(method):
    program = program_of(scene("floating-block"))
    assert method(program).z == pytest.approx(-mass_of(program) / 5, rel=1e-9)


@METHODS
def test_loads_are_refused(method):
    import dataclasses

    assembly = dataclasses.replace(stacks.tower(2), loads=[Load("cube-1", [0, 0, -1])])
    with pytest.raises(InputError, match=r"cube-1.*does not turn"):
        method(program_of(assembly))


def test_a_planar_diamond_has_four_facets():
    assert len(facets_of_diamond(program_of("trapped-wedge"))) == 4
