"""Each solver proves the same side, and a failing one is replaced."""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from judged import judged, program_of, sides
from scipy.optimize import linprog
from scipy.sparse import block_diag, csc_array
from transformations import tilted

import kilter
from kilter import Assembly, Bond, Box, Joint, Part, Pose
from kilter.analysis import load_limit
from kilter.analysis.analysis_tolerances import LIMIT_AGREES
from kilter.analysis.decision import judge as judging
from kilter.analysis.decision.judge import SIMPLEX_ROWS, SOLVERS, judge
from kilter.analysis.load_limit import LimitSides, find_limit, gravity_wrench
from kilter.contact import detect
from kilter.mechanics.balance_in_cones import load_share
from kilter.mechanics.forms import equilibrium, load_factor, scaled_problem
from kilter.mechanics.program import build_program
from kilter.scenes import arches, scene, stacks, walls
from kilter.scenes.pieces import moved
from kilter.solvers import clarabel, cone_interior_point, highs
from kilter.solvers.block_cholesky import BlockCholesky, NotPositive
from kilter.solvers.highs import Blocks, solve_blocks
from kilter.solvers.lorentz import Scaling, depth, divided, product, reach

BESIDE = (1e-2, 1e-4, 1e-5)
"""A limit and its proofs."""


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_block_on_a_slope_is_proved_by_each(friction):
    limit = float(np.degrees(np.arctan(friction)))
    above = program_of(stacks.block_on_slope(limit + 0.1, friction=friction))
    assert sides(above) == dict.fromkeys(SOLVERS, False)
    if friction:
        below = program_of(stacks.block_on_slope(limit - 0.1, friction=friction))
        assert sides(below) == dict.fromkeys(SOLVERS, True)


@pytest.mark.parametrize("planar", [False, True])
def test_an_arch_in_a_plane_and_in_space(planar):
    for friction, stands in ((0.05, False), (0.7, True)):
        program = program_of(arches.arch(9, friction=friction, planar=planar))
        assert sides(program) == dict.fromkeys(SOLVERS, stands)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_walls_and_arches_beside_their_limits(seed):
    random = np.random.default_rng(seed)
    friction = float(random.uniform(0.5, 0.9))
    assembly = (
        arches.arch(int(random.integers(5, 20)), friction=friction, planar=False)
        if seed % 2
        else walls.wall(*(int(k) for k in random.integers(2, 5, 2)), friction=friction)
    )
    program, turn = program_of(assembly), float(random.uniform(0, 2 * np.pi))
    aside = np.array([np.cos(turn), np.sin(turn), 0.0])
    limit = find_limit(program, gravity_wrench(program, aside))
    assert limit.value > 0
    for beside in BESIDE:
        for held in (True, False):
            if not held and beside * limit.value <= limit.gap * max(1.0, limit.value):
                continue  # which side that is, nothing has proved
            share = limit.value * (1 - beside if held else 1 + beside)
            turned = program.turned(program.down + share * aside)
            assert set(sides(turned).values()) <= {held, None}
            assert judge(turned).stable is held


def test_no_proof_of_one_is_asked_of_the_next(monkeypatch):
    program = program_of(walls.wall(5, 5, friction=0.6))
    assert judge(program).solvers[0].startswith("load factor in cones: kilter")
    monkeypatch.setattr(cone_interior_point, "iterates", lambda cones: iter(()))
    assert judge(program, solver="kilter").stable is None
    fallen_back = judge(program)
    assert fallen_back.stable
    assert "no proof" in fallen_back.solvers[0]
    assert "clarabel" in fallen_back.solvers[1]


def glued(pull: float, shear: float | str = "mu", friction: float = 0.0) -> Assembly:
    """A block of 981 N beside a wall, held by glue at its whole face."""
    wall = Part("wall", Box([1, 1, 1]), Pose((1.0, 0.0, 0.0)), grounded=True)
    block = Part("block", Box([1, 1, 1]), density=100.0)
    table = Part("table", Box([1, 1, 1]), Pose((0.0, 0.0, -1.0)), grounded=True)
    parts = [wall, block] if friction else [wall, block, table]
    bond = Bond(("wall", "block"), pull=pull, shear=shear)
    return Assembly(parts, friction=friction, bonds=[bond])


SCENES: dict[str, Callable[[], Assembly]] = {
    "arch": lambda: arches.arch(5, friction=0.7, planar=False),
    "falling arch": lambda: arches.arch(5, friction=0.05, planar=False),
    "block": lambda: stacks.block_on_slope(20.0, friction=0.5),
    "smooth tower": lambda: scene("tower").with_friction(0.0),
    "smooth figure": lambda: scene("paper-figure-8").with_friction(0.0),
    "glue without friction": lambda: glued(100.0),
    "strong glue": lambda: glued(1e4, 1e4, 0.5),
    "weak glue": lambda: glued(10.0, 10.0, 0.5),
    "mortar": lambda: scene("mortared-corbel"),
}


def failing(solve: Callable[..., Any]) -> Callable[..., Any]:
    """The solver, but each of its answers is marked as failed."""

    def failed(*problem: Any, **options: Any) -> Any:
        none = np.zeros(0)
        answer = solve(*problem, **options)
        return dataclasses.replace(answer, outcome="failed", x=none, multipliers=none)

    return failed


@pytest.mark.parametrize("name", sorted(SCENES))
def test_a_program_that_counts_as_large_is_decided_alike(name, monkeypatch):
    program = program_of(SCENES[name]())
    known = judge(program).stable
    monkeypatch.setattr(judging, "SIMPLEX_ROWS", 0)
    assert judge(program).stable is known
    monkeypatch.setattr(judging, "_by_equilibrium", lambda problem, work: iter(()))
    assert judge(program).stable is known


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", sorted(SCENES))
@pytest.mark.parametrize("simplex_rows", [0, 1000])
@pytest.mark.slow
def test_without_an_answer_of_a_solver_nothing_wrong_is_decided(name, simplex_rows, monkeypatch):
    program = program_of(SCENES[name]())
    known = judge(program).stable
    monkeypatch.setattr(judging, "SIMPLEX_ROWS", simplex_rows)
    monkeypatch.setattr(highs, "solve_linear", failing(highs.solve_linear))
    assert judge(program).stable in (known, None)
    monkeypatch.setattr(clarabel, "solve_conic", failing(clarabel.solve_conic))
    judgement = judge(program)
    assert judgement.stable in (known, None)
    assert judgement.solvers[0] == "least forces of bonds" or any(
        "failed" in word for word in judgement.solvers
    )


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", sorted(SCENES))
def test_no_solver_alone_proves_the_other_side(name):
    program = program_of(SCENES[name]())
    known = judge(program).stable
    assert set(sides(program).values()) <= {known, None}


@pytest.mark.parametrize("solver", [None, "clarabel"])
@pytest.mark.parametrize("name", ["arch", "falling arch", "block", "strong glue"])
def test_least_cohesion_decides_without_a_load_factor(name, solver, monkeypatch):
    program = program_of(SCENES[name]())
    known = judge(program).stable
    monkeypatch.setattr(judging, "_by_strength", lambda wide, work: judging._Candidate("none"))
    monkeypatch.setattr(judging, "_by_cones", lambda wide, work: judging._Candidate("none"))
    judgement = judge(program, solver=solver)
    assert judgement.stable is known
    assert judgement.solvers[-1].startswith("least cohesion")


def test_glue_without_friction_is_decided_without_its_least_forces(monkeypatch):
    program = program_of(glued(100.0))
    monkeypatch.setattr(judging, "SIMPLEX_ROWS", 0)
    zero = np.zeros(len(program.part_a))
    monkeypatch.setattr(judging, "least_forces", lambda problem: (zero, None))
    judgement = judge(program)
    assert judgement.stable
    assert judgement.solvers[1].startswith("total imbalance")


def test_a_friction_pyramid_that_is_too_large_is_not_tried(monkeypatch):
    program = program_of(SCENES["arch"]())
    monkeypatch.setattr(judging, "LARGEST_PYRAMID", 0)
    assert judge(program, solver="highs").stable is None


def test_if_every_solver_fails_the_answer_states_its_best_figures(monkeypatch):
    monkeypatch.setattr(judging, "_candidates", lambda *_: iter(()))
    verdict = kilter.check(SCENES["falling arch"]())
    assert verdict.verdict == "undecided"
    assert "numerical errors prevent a proof" in str(verdict.to_dict())


TURN = np.array([0.3, -0.5, 0.7, 0.4])


def large(assembly):
    program = build_program(assembly, detect.contacts(assembly))
    assert len(scaled_problem(program).right) > SIMPLEX_ROWS
    return program


@pytest.mark.slow
@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize(
    ("build", "verdict"),
    [
        (lambda: walls.wall(17, 17), "stable"),
        (lambda: walls.short_base(17, 17, held=8.0), "unstable"),
        (lambda: walls.hanging_brick(17, 17), "unstable"),
        (lambda: walls.wall(17, 17).with_down([0, 1e-6, -1]), "unstable"),
        (lambda: walls.wall(17, 17).with_down([1e-6, 0, -1]), "unstable"),
    ],
)
def test_large_walls_are_judged_either_way(build, verdict, turned):
    assembly = build()
    if turned:
        assembly = moved(assembly, TURN / np.linalg.norm(TURN), [10.0, -20.0, 5.0])
    assert judged(assembly).verdict == verdict


def test_a_large_program_goes_to_hipo_first():
    judgement = judge(large(walls.wall(17, 17)))
    assert judgement.stable
    assert judgement.solvers[0].startswith("equilibrium: hipo")


@pytest.mark.slow
def test_without_its_extra_package_another_solver_is_named_and_judged(monkeypatch):
    monkeypatch.setattr(highs, "hipo_available", lambda: False)
    judgement = judge(large(walls.wall(17, 17)))
    assert judgement.stable
    assert judgement.solvers[0].startswith("equilibrium: ipx")


def test_the_extra_package_that_hipo_needs_is_installed():
    assert highs.hipo_available()


def test_interior_point_and_simplex_give_the_same_load_factor():
    for build in (lambda: walls.wall(8, 8), lambda: walls.short_base(8, 8, held=4.0)):
        problem = scaled_problem(build_program(build(), detect.contacts(build())))
        factors = [
            highs.solve_linear(load_factor(problem), method=method).x[-1]
            for method in ("simplex", "interior")
        ]
        assert factors[0] == pytest.approx(factors[1], abs=1e-6)


def test_a_status_is_mapped_to_words():
    problem = scaled_problem(large(walls.short_base(17, 17, held=8.0)))
    answer = highs.solve_linear(equilibrium(problem), method="interior", forces_only=True)
    assert answer.outcome == "infeasible"


def random_blocks(seed: int, count: int) -> tuple[Blocks, list[np.ndarray]]:
    """Random equilibria; about half of them are solvable, and every seventh has no rows."""
    rng = np.random.default_rng(seed)
    matrices, sides = [], []
    for k in range(count):
        rows, columns = (
            (0, 3) if k % 7 == 6 else (int(rng.integers(2, 9)), int(rng.integers(3, 13)))
        )
        matrix = rng.normal(size=(rows, columns))
        inside = matrix @ rng.uniform(0.1, 1.0, columns)
        matrices.append(matrix)
        sides.append(inside if rng.random() < 0.5 else rng.normal(size=rows))
    start = [np.cumsum([0, *(m.shape[axis] for m in matrices)]) for axis in (0, 1)]
    two_sided = rng.random(start[1][-1]) < 0.1
    whole = csc_array(block_diag([m for m in matrices if m.size] or [np.zeros((0, 0))]))
    wide = csc_array((start[0][-1], start[1][-1])).tolil()
    kept = np.concatenate(
        [
            np.arange(a, b)
            for a, b, m in zip(start[1], start[1][1:], matrices, strict=False)
            if m.size
        ]
    )
    wide[:, kept] = whole.tolil()
    return Blocks(csc_array(wide), np.concatenate(sides), two_sided, *start), matrices


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.quick(1)
def test_each_block_has_the_answer_of_a_second_solver(seed):
    """A second solver decides each block; forces and multipliers are verified from the numbers."""
    blocks, matrices = random_blocks(seed, 40)
    which = np.flatnonzero(np.random.default_rng(seed).random(40) < 0.8)
    answers = solve_blocks(blocks, which)
    skipped = np.setdiff1d(np.arange(40), which)
    assert np.isnan(answers.factor[skipped]).all()
    outcomes = set()
    for k in which.tolist():
        rows, columns = (slice(*s[k : k + 2]) for s in (blocks.row_start, blocks.column_start))
        matrix, right = matrices[k], blocks.right[rows]
        free = blocks.two_sided[columns]
        bounds = [(None, None) if two else (0, None) for two in free]
        holds = (
            not len(right)
            or linprog(np.zeros(matrix.shape[1]), A_eq=matrix, b_eq=right, bounds=bounds).success
        )
        assert (answers.factor[k] > 0.5) == holds
        outcomes.add(holds)
        if holds:
            forces = answers.forces[columns]
            assert np.abs(matrix @ forces - right).max(initial=0.0) < 1e-7
            assert forces[~free].min(initial=0.0) > -1e-9
        else:
            y = answers.multipliers[rows]
            assert right @ y > 0
            assert (matrix.T @ y)[~free].max(initial=0.0) < 1e-7
            assert np.abs((matrix.T @ y)[free]).max(initial=0.0) < 1e-7
    assert outcomes == {True, False}


def program_of_point(assembly):
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
    program = program_of_point(dataclasses.replace(wall, joints=(hinge,)))
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
        assert proved(program_of_point(stacks.block_on_slope(angle, friction=0.5))) is (beside < 0)

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
        assert proved(program_of_point(tilted(assembly, [0, 1, 0], angle))) is stands

    @pytest.mark.parametrize("friction", [0.0, 0.6])
    def test_masses_of_any_contrast(self, friction):
        assembly = stacks.tower(8)
        if friction:
            assembly = assembly.with_friction(friction)
        program = program_of_point(assembly)
        for powers in ((0, 6), (6, 0)):
            mass = program.mass * 10.0 ** np.resize(powers, len(program.mass))
            assert proved(program.with_rows(mass=mass)) is True

    @pytest.mark.quick(2)
    @pytest.mark.parametrize("bricks", [7, 30])
    @pytest.mark.parametrize("planar", [False, True])
    def test_arches_either_way(self, bricks, planar, monkeypatch):
        for friction in (0.05, 0.7):
            program = program_of_point(arches.arch(bricks, friction=friction, planar=planar))
            assert proved(program) == by_others(program, monkeypatch)

    def test_a_part_that_nothing_touches_falls(self):
        assert proved(program_of_point(walls.hanging_brick(4, 4))) is False
        assert proved(program_of_point(walls.hanging_brick(4, 4).with_friction(0.6))) is False

    @pytest.mark.slow
    @pytest.mark.parametrize("angle", [0.0, 0.8, 1.6])
    def test_limits_as_clarabel_has_them(self, angle, monkeypatch):
        program = program_of_point(walls.wall(7, 8, friction=0.6))
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
        program = program_of_point(stacks.tower(140).with_friction(0.6))
        assert len(program.part_a) > load_limit.EXACT
        limit = find_limit(program, gravity_wrench(program, np.array([1.0, 0.0, 0.0])))
        assert limit.value == pytest.approx(1.0 / 140, rel=1e-6)

    @pytest.mark.slow
    def test_what_is_not_held_has_the_limit_that_it_had(self):
        # leaning too far: only shares that turn gravity back are held
        program = program_of_point(walls.wall(7, 8, friction=0.6)).turned(
            np.array([0.0, 0.9, -1.0])
        )
        aside = gravity_wrench(program, np.eye(3)[1])
        shared = load_limit.SharedCones(program)
        assert load_limit._by_own_cones(aside, 10.0, shared).forces is None
        limit = find_limit(program, aside)
        assert limit.value < 0

    def test_a_joint_pulls(self, monkeypatch):
        program = pinned_and_rough()
        assert proved(program) is by_others(program, monkeypatch) is True
        off = program.with_rows(gravity=np.array([0.0, 9.0, -1.0]))
        assert proved(off) is by_others(off, monkeypatch) is False

    def test_the_same_bits_every_time(self):
        program = program_of_point(walls.wall(5, 5, friction=0.6))
        first, second = judge(program), judge(program)
        assert np.array_equal(first.forces.forces, second.forces.forces)
        assert first.solvers[0].startswith("load factor in cones: kilter")
