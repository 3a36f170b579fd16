"""Kilter's own interior point: its parts against dense algebra, its proofs against other solvers.

Every answer is a proof that `check_forces` or `check_motion` has checked; the tests compare the
proved sides.
"""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from transformations import tilted

from kilter.analysis import load_limit
from kilter.analysis.decision import judge as judging
from kilter.analysis.decision.judge import judge
from kilter.analysis.limit_sides import LimitSides
from kilter.analysis.load_limit import find_limit, gravity_wrench
from kilter.analysis.turning_tolerances import LIMIT_AGREES
from kilter.assembly import Joint
from kilter.contact import detect
from kilter.mechanics.balance_in_cones import load_share
from kilter.mechanics.program import build_program
from kilter.scenes import arches, stacks, walls
from kilter.solvers.block_cholesky import BlockCholesky, NotPositive
from kilter.solvers.lorentz import Scaling, depth, divided, product, reach


def program_of(assembly):
    return build_program(assembly, detect.contacts(assembly))


def proved(program):
    """Verdict of kilter's own interior point alone; None without a proof."""
    return judge(program, solver="kilter").stable


def by_others(program, monkeypatch):
    """Verdict of HiGHS and Clarabel."""
    with monkeypatch.context() as without:
        without.setattr(judging, "_by_own_cones", lambda program, work: iter(()))
        return judge(program).stable


def pinned_and_rough():
    """Bricks with friction, two of them without, and a hinge: every kind of column."""
    wall = walls.wall(4, 3, friction=0.6)
    one, other = wall.parts[2].name, wall.parts[3].name
    hinge = Joint((one, other), "revolute", point=[0.0, 0.0, 1.0], axis=[0.0, 1.0, 0.0])
    program = program_of(dataclasses.replace(wall, joints=(hinge,)))
    return program.with_rows(mu=np.where(np.arange(len(program.mu)) % 5 == 0, 0.0, program.mu))


class TestFactors:
    @pytest.mark.quick(2)
    @pytest.mark.parametrize(("count", "width"), [(1, 6), (9, 3), (60, 6), (200, 3)])
    def test_solutions_are_those_of_the_dense_matrix(self, count, width):
        rng = np.random.default_rng(count)
        place = rng.uniform(size=(count, 3)) * [9.0, 3.0, 1.0]
        one, other = np.triu_indices(count, 1)
        near = np.linalg.norm(place[one] - place[other], axis=1) < 1.2
        # either end may come first
        swap = rng.random(int(near.sum())) < 0.5
        one, other = np.where(swap, other[near], one[near]), np.where(swap, one[near], other[near])
        links = rng.normal(size=(len(one), width, width))
        diagonal = np.tile(100.0 * np.eye(width), (count, 1, 1))
        dense = np.zeros((count, width, count, width))
        dense[np.arange(count), :, np.arange(count), :] = diagonal
        dense[one, :, other, :] = links
        dense[other, :, one, :] = links.transpose(0, 2, 1)
        factor = BlockCholesky(place, one, other, width)
        factor.factorise(diagonal, links)
        right = rng.normal(size=(count, width, 2))
        expected = np.linalg.solve(dense.reshape(count * width, -1), right.reshape(-1, 2))
        assert factor.solve(right).reshape(-1, 2) == pytest.approx(expected, abs=1e-12)

    def test_an_indefinite_matrix_is_refused(self):
        pair = BlockCholesky(np.eye(2, 3), np.array([0]), np.array([1]), 1)
        with pytest.raises(NotPositive):
            pair.factorise(np.ones((2, 1, 1)), np.full((1, 1, 1), 2.0))


class TestCones:
    @pytest.mark.parametrize("dimension", [1, 3])
    def test_scaling_and_products(self, dimension):
        rng = np.random.default_rng(dimension)
        x, s = rng.normal(size=(2, dimension, 50))
        for point in (x, s):
            point[0] = np.linalg.norm(point[1:], axis=0) + rng.uniform(0.01, 2.0, 50)
        scaling = Scaling.of(x, s)
        assert scaling.times(s) == pytest.approx(scaling.over(x))
        assert scaling.times(scaling.times(s)) == pytest.approx(scaling.twice(s))
        assert divided(x, product(x, s)) == pytest.approx(s)

    def test_reach_ends_on_the_cone(self):
        rng = np.random.default_rng(7)
        x, step = rng.normal(size=(2, 3, 40))
        x[0] = np.linalg.norm(x[1:], axis=0) + 1.0
        for k in range(40):
            far = reach(x[:, k : k + 1], step[:, k : k + 1])
            assert np.isinf(far) or depth(x[:, k] + far * step[:, k]) == pytest.approx(0, abs=1e-9)
            inside = x[:, k] + 0.999 * min(far, 1e6) * step[:, k]
            assert depth(inside) >= -1e-9


class TestColumns:
    def test_they_are_the_equilibrium_of_the_program(self):
        program = pinned_and_rough()
        balance = load_share(program)
        x = np.random.default_rng(1).normal(size=balance.cones.columns.shape[1:])
        along, aside = balance.decoded(x)
        wrench = program.wrenches(along, aside)[program.free]
        wrench[:, 3:] /= program.radius[program.free][:, None]
        wrench /= program.weight[program.free][:, None]
        alone = program.mu[balance.rows] <= 0  # their other columns are 0
        assert not balance.directions[1:, alone].any()
        assert balance.cones.balance(x) == pytest.approx(wrench, abs=1e-12)

    def test_openings_are_the_transpose_and_the_normal_matrix_is_the_product(self):
        cones = load_share(pinned_and_rough()).cones
        rng = np.random.default_rng(2)
        x, y = rng.normal(size=cones.columns.shape[1:]), rng.normal(size=cones.right.shape)
        assert (cones.balance(x) * y).sum() == pytest.approx((x * cones.openings(y)).sum())
        inside = rng.normal(size=(2, *x.shape))
        inside[:, 0] = np.linalg.norm(inside[:, 1:], axis=1) + 1.0
        scaling = Scaling.of(*inside)
        diagonal, links = cones.normal_matrix(scaling)
        cones.factor.factorise(diagonal + 1e-9 * np.eye(6), links)
        product_of_y = cones.balance(scaling.twice(cones.openings(y)))
        solved = cones.balance(scaling.twice(cones.openings(cones.factor.solve(product_of_y))))
        assert solved == pytest.approx(product_of_y, abs=1e-6 * np.abs(product_of_y).max())


class TestProofs:
    @pytest.mark.parametrize("beside", [-1e-2, -1e-4, 1e-4, 1e-2])
    def test_a_block_slips_at_its_angle_of_friction(self, beside):
        angle = float(np.degrees(np.arctan(0.5))) * (1 + beside)
        assert proved(program_of(stacks.block_on_slope(angle, friction=0.5))) is (beside < 0)

    @pytest.mark.parametrize("beside", [-1e-3, 1e-3])
    @pytest.mark.parametrize("friction", [0.0, 0.6])
    def test_a_tower_tips_at_its_edge(self, beside, friction):
        # 12 cubes: width over height
        assembly = stacks.tower(12)
        if friction:
            assembly = assembly.with_friction(friction)
        vertices = assembly.geometry.vertices[
            ~assembly.geometry.grounded[assembly.geometry.vertex_part]
        ]
        wide, _, high = np.ptp(vertices, axis=0)
        angle = float(np.degrees(np.arctan(wide / high))) * (1 + beside)
        stands = beside < 0 and friction > 0  # without friction it slides at once
        assert proved(program_of(tilted(assembly, [0, 1, 0], angle))) is stands

    @pytest.mark.parametrize("friction", [0.0, 0.6])
    def test_masses_of_any_contrast(self, friction):
        assembly = stacks.tower(8)
        if friction:
            assembly = assembly.with_friction(friction)
        program = program_of(assembly)
        for powers in ((0, 6), (6, 0)):
            mass = program.mass * 10.0 ** np.resize(powers, len(program.mass))
            assert proved(program.with_rows(mass=mass)) is True

    @pytest.mark.quick(2)
    @pytest.mark.parametrize("bricks", [7, 30])
    @pytest.mark.parametrize("planar", [False, True])
    def test_arches_either_way(self, bricks, planar, monkeypatch):
        for friction in (0.05, 0.7):
            program = program_of(arches.arch(bricks, friction=friction, planar=planar))
            assert proved(program) == by_others(program, monkeypatch)

    def test_a_part_that_nothing_touches_falls(self):
        assert proved(program_of(walls.hanging_brick(4, 4))) is False
        assert proved(program_of(walls.hanging_brick(4, 4).with_friction(0.6))) is False

    @pytest.mark.quick(1)
    @pytest.mark.parametrize("angle", [0.0, 0.8, 1.6])
    def test_limits_as_clarabel_has_them(self, angle, monkeypatch):
        program = program_of(walls.wall(7, 8, friction=0.6))
        wrench = gravity_wrench(program, np.array([np.cos(angle), np.sin(angle), 0.0]))
        own = find_limit(program, wrench)
        with monkeypatch.context() as without:
            without.setattr(load_limit, "_by_own_cones", lambda *question: LimitSides())
            other = find_limit(program, wrench)
        assert len(program.part_a) > load_limit.EXACT
        assert own.gap <= LIMIT_AGREES
        # what one proves to be held the other does not prove to be beyond
        assert own.value <= other.value + max(other.gap, 1e-9)
        assert other.value <= own.value + own.gap

    @pytest.mark.slow
    def test_a_tower_tilts_as_far_as_its_width_over_its_height(self):
        program = program_of(stacks.tower(140).with_friction(0.6))
        assert len(program.part_a) > load_limit.EXACT
        limit = find_limit(program, gravity_wrench(program, np.array([1.0, 0.0, 0.0])))
        assert limit.value == pytest.approx(1.0 / 140, rel=1e-6)

    @pytest.mark.slow
    def test_what_is_not_held_has_the_limit_that_it_had(self):
        # leaning too far: only shares that turn gravity back are held
        program = program_of(walls.wall(7, 8, friction=0.6)).turned(np.array([0.0, 0.9, -1.0]))
        aside = gravity_wrench(program, np.eye(3)[1])
        for shared in (None, load_limit.SharedCones(program)):
            assert load_limit._by_own_cones(program, aside, 10.0, shared).forces is None
        limit = find_limit(program, aside)
        assert limit.value < 0

    def test_a_joint_pulls(self, monkeypatch):
        program = pinned_and_rough()
        assert proved(program) is by_others(program, monkeypatch) is True
        off = program.with_rows(gravity=np.array([0.0, 9.0, -1.0]))
        assert proved(off) is by_others(off, monkeypatch) is False

    def test_the_same_bits_every_time(self):
        program = program_of(walls.wall(5, 5, friction=0.6))
        first, second = judge(program), judge(program)
        assert np.array_equal(first.forces.forces, second.forces.forces)
        assert first.solvers[0].startswith("load factor in cones: kilter")
