"""True exclusions are proved, possible motions are not: the search and its bounds."""

import dataclasses
import math

import numpy as np
import pytest
from cases import cylinders, planar, program, slope, spheres
from modes_oracle import greatest_power, standing
from scipy.optimize import linprog
from scipy.sparse import csc_array
from witnessed import jointed, witnessed

from kilter.friction.branching import CaseTree, Mode
from kilter.friction.contraction import contract, power_bound, shrunk
from kilter.friction.enclosure import cases, rescaled
from kilter.friction.exclusion import prove_no_motion, start_proof
from kilter.friction.exclusion_cases import breach
from kilter.friction.force_bound import force_bound
from kilter.friction.friction_tolerances import NO_POWER
from kilter.friction.moment_bound import MomentStep, power_left
from kilter.friction.moment_forms import moment_forms
from kilter.friction.moment_products import law_products, monomials
from kilter.friction.moments import moment_program, moment_proof
from kilter.friction.opening_motion import opening_motion
from kilter.friction.reduced_law import reduced_law
from kilter.mechanics.rows import POSSIBLE
from kilter.scenes import arches, friction, stacks
from kilter.solvers.clarabel import solve_semidefinite
from kilter.solvers.highs import bounding
from kilter.solvers.problem import LinearProgram
from kilter.work import Work, units_of
from sampled import sampled

LADDER, LADDER_WALL = 1.25, (1 - 0.4 * 0.3) / 0.8  # tan of the least angle
LEAN = float(np.degrees(np.arctan(0.1)))  # of ten cubes, at their limit


def steep(tangent):
    return float(np.degrees(np.arctan(tangent)))


def asked(assembly, effort=3):
    return prove_no_motion(program(assembly), work=effort)


PROVED = {
    "slope, slides": lambda: slope(0.98, 0.5, 1.0),
    "slope, tips": lambda: slope(0.98, 0.8, 2.0),
    "slope in the plane": lambda: planar(slope(0.98, 0.5, 1.0)),
    "ladder": lambda: friction.ladder(steep(LADDER / 0.98)),
    "ladder, rough wall": lambda: friction.ladder(steep(LADDER_WALL / 0.98), friction_wall=0.3),
    "ladder in space": lambda: friction.ladder(steep(LADDER / 0.98), planar=False),
    "cylinders": lambda: cylinders(0.98),
    "ten cubes": lambda: planar(stacks.tower(10, tilt=0.98 * LEAN, friction=0.7)),
    "arch of 7": lambda: arches.arch(7),
    "arch of 12": lambda: arches.arch(12),
    "two cubes": lambda: stacks.tower(2, tilt=10.0, friction=0.5),
    "trough": lambda: friction.trough(tilt=20.0),
}

REFUTED = {
    "slope, slides": lambda: slope(1.02, 0.5, 1.0),
    "slope, tips": lambda: slope(1.02, 0.8, 2.0),
    "ladder": lambda: friction.ladder(steep(LADDER * 0.98)),
    "cylinders": lambda: cylinders(1.02),
    "spheres": lambda: spheres(1.02),
    "ten cubes": lambda: planar(stacks.tower(10, tilt=1.02 * LEAN, friction=0.7)),
    "thin arch": lambda: arches.arch(20, ratio=0.106),
    "H": lambda: friction.h_block(),
    "H in the plane": lambda: friction.h_block(planar=True),
    "A": lambda: friction.a_block(),
    "A in the plane": lambda: friction.a_block(planar=True),
    "bracket": lambda: friction.bracket(1.1 / 1.2),
    "trough past its limit": lambda: friction.trough(tilt=44.2),
    "trough, forces exist": lambda: friction.trough(tilt=47.0),
}


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", PROVED)
def test_proved(name):
    answer = asked(PROVED[name]())
    assert answer.proved
    assert answer.bound <= NO_POWER
    assert answer.assumes == ""
    assert answer.kind is not None


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", sampled(8, REFUTED))
def test_never_proved(name):
    answer = asked(REFUTED[name](), effort=1)
    assert not answer.proved
    assert answer.kind is None
    assert answer.bound > NO_POWER


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_against_all_modes_in_the_plane(seed):
    one = standing(seed, planar=True, parts=1 + seed % 2, points=3)
    power = greatest_power(one)
    assert power < 1e-9 or power > 1e-5
    assert prove_no_motion(one, work=2).proved == (power < 1e-9)


@pytest.mark.slow
def test_joined_parts_are_one():
    """Two cubes side by side on a slope; the joint carries the cube without friction."""
    cubes = program(stacks.tower(2, tilt=10.0, friction=0.5))
    top = cubes.part_b == 2
    slippery = cubes.with_rows(mu=np.where(top, 0.0, cubes.mu))
    assert not prove_no_motion(slippery, work=1).proved
    held = jointed(slippery, 1, 2, [0.0, 0.0, 1.0])
    assert prove_no_motion(held, work=2).proved


def test_refuses_what_is_not_modelled():
    cubes = program(stacks.tower(1, tilt=10.0, friction=0.5))
    answer = prove_no_motion(cubes.with_rows(kind=np.full(len(cubes.kind), POSSIBLE)))
    assert not answer.proved
    assert "not modelled" in answer.why


@pytest.mark.quick(2)
@pytest.mark.parametrize("ratio", [1.0, 1e-3, 1e-6])
def test_a_pebble_does_not_vanish(ratio):
    """The upper of two cubes, however light, slips if its friction is too low."""
    cubes = program(planar(stacks.tower(2, tilt=10.0, friction=0.5)))
    share = np.where(np.arange(3) == 2, ratio, 1.0)
    light = cubes.with_rows(mass=cubes.mass * share, inertia=cubes.inertia * share[:, None, None])
    assert ratio < 1e-3 or prove_no_motion(light).proved  # a lighter one may stay open
    smooth = light.with_rows(mu=np.where(light.part_b == 2, 0.17, light.mu))
    assert not prove_no_motion(smooth, work=1).proved  # tan 10 deg = 0.176


def test_nothing_to_move_is_proved():
    bare = program(stacks.tower(1, tilt=10.0, friction=0.5))
    nothing = bare.with_rows(gravity=np.zeros(3))
    assert prove_no_motion(nothing).proved


@pytest.mark.slow
def test_the_work_is_kept_to_and_comes_out_the_same_again():
    leaning = program(planar(stacks.tower(10, tilt=6.0, friction=0.7)))
    one, two = (prove_no_motion(leaning, work=0.2) for _ in range(2))
    assert not one.proved
    assert units_of(0.2) <= one.work <= 1.2 * units_of(0.2)
    assert (one.bound, one.nodes, one.programs) == (two.bound, two.nodes, two.programs)


@pytest.mark.slow
def test_cases_that_would_not_do_are_not_gone_through():
    """Ten cubes: moments leave much power, and few cases are affordable."""
    answer = prove_no_motion(program(stacks.tower(10, tilt=2.5, friction=0.5)), work=1)
    assert not answer.proved
    assert answer.work < 0.3 * units_of(1)
    assert answer.bound < 0.02


def test_a_time_limit_ends_it_at_once():
    words = []
    work = Work(time_limit=0.0, progress=words.append)
    answer = prove_no_motion(program(stacks.tower(6, tilt=3.0, friction=0.5)), work=work)
    assert not answer.proved
    assert work.cut
    assert answer.nodes <= 3


def test_says_what_it_assumes_where_parts_can_be_squeezed():
    """Any force may press a wedge into a V, so the proof names its assumed bound."""
    answer = asked(friction.v_block(friction=0.5, planar=True))
    assert answer.proved
    assert "1000 times the weight" in answer.assumes


def test_one_number_flips_it():
    assembly = planar(slope(0.98, 0.5, 1.0))
    one = program(assembly)
    assert prove_no_motion(one).proved
    assert not prove_no_motion(one.with_rows(mu=0.96 * one.mu)).proved


LOW, HIGH = 0.0, 4.0


def tree(seen, *, closed=-math.inf):
    """Intervals (low, high), bounded by x sin x at their middle plus a slope of 5 over x."""

    def bound(interval, parent):
        low, high = interval
        middle = (low + high) / 2
        power = middle * math.sin(middle) + 5 * (high - low) / 2
        if parent is not None:
            assert parent[0][0] <= low < high <= parent[0][1]
            power = min(power, parent[1])
        seen.append(interval)
        return None if power <= closed else (interval, power)

    def divide(case):
        (low, high), _ = case
        middle = (low + high) / 2
        return [(low, middle), (middle, high)] if high - low > 1e-6 else []

    return CaseTree(bound, divide, lambda case: case[1])


def test_the_best_open_case_closes_in_on_the_greatest_value():
    seen = []
    one = tree(seen)
    list(one.explore((LOW, HIGH), enough=lambda case: case[0][1] - case[0][0] < 1e-5))
    (low, high), power = one.best
    assert low <= 2.02876 <= high  # tan x = -x
    assert power == pytest.approx(1.81971, abs=1e-3)
    assert one.nodes == len(seen) < 6000  # 2^19 without bounds
    assert len(one) > 1


def test_a_case_that_is_not_worth_dividing_is_dropped():
    one = CaseTree(lambda q, _: q, lambda case: [], lambda case: 1.0)
    assert list(one.explore("root")) == ["root"]
    assert one.best is None


def test_modes_differ():
    assert len({int(mode) for mode in Mode}) == 4


def drawn(seed):
    """A feasible program with rows of all kinds, and its optimum."""
    rng = np.random.default_rng(seed)
    rows, columns = int(rng.integers(2, 9)), int(rng.integers(2, 9))
    matrix = rng.normal(size=(rows, columns)) * (rng.random((rows, columns)) < 0.7)
    inside = rng.uniform(-1, 1, columns)
    low, high = matrix @ inside - rng.random(rows), matrix @ inside + rng.random(rows)
    kind = rng.integers(0, 3, rows)
    low = np.where(kind == 0, matrix @ inside, np.where(kind == 1, -np.inf, low))
    high = np.where(kind == 0, matrix @ inside, np.where(kind == 2, np.inf, high))
    cost = rng.normal(size=columns)
    program = LinearProgram(
        cost, csc_array(matrix), low, high, -2 * np.ones(columns), 2 * np.ones(columns)
    )
    below, above = np.isfinite(low), np.isfinite(high)
    answer = linprog(
        cost, A_ub=np.vstack([matrix[above], -matrix[below]]),
        b_ub=np.concatenate([high[above], -low[below]]), bounds=(-2, 2),
    )  # fmt: skip
    return program, float(answer.fun), rng


@pytest.mark.quick(11)
@pytest.mark.parametrize("seed", range(20))
def test_bound_is_near_the_optimum_and_never_above(seed):
    program, optimum, rng = drawn(seed)
    solver = bounding()
    solver.load(program)
    answer = solver.solve()
    assert optimum - 1e-7 < answer.bound < optimum + 1e-9
    assert answer.objective == pytest.approx(optimum, abs=1e-7)
    for _ in range(20):  # whatever the multipliers are
        assert program.safe_bound(rng.normal(size=len(program.row_lower))) <= optimum + 1e-9
    turned = rng.normal(size=len(program.cost))
    again = solver.solve(turned)
    assert turned @ answer.x >= again.bound - 1e-9


def test_no_multipliers_no_bound():
    program, _, _ = drawn(0)
    assert program.safe_bound(np.empty(0)) == -np.inf
    assert program.safe_bound(np.full(len(program.row_lower), np.nan)) == -np.inf


ROUNDING = 1e-7


def point_of(attempt, found, scale):
    """The columns of the true solution (a, f)."""
    law, program = attempt.law, found.program
    at = attempt.relaxation.columns
    scaled = law.law
    size = np.linalg.norm(law.allowed.T @ scaled.load)
    b = law.allowed.T @ scaled.columns(found.motion) / size / scale
    pushes = np.einsum("kij,kj->ki", scaled.basis, found.forces)
    pushes /= scaled.strength * size * np.sqrt(program.mass[program.free].sum())
    x = np.zeros(attempt.relaxation.width)
    fn, rough = pushes[:, 0], np.flatnonzero(program.mu > 0)
    ft = pushes[rough, 1 : 1 + law.directions]
    if program.planar:  # the points of a patch share it
        fn_group = np.bincount(law.group[rough], fn[rough], minlength=len(law.mu))
        ft = np.bincount(law.group[rough], ft[:, 0], minlength=len(law.mu))[:, None]
    else:
        fn_group = fn[rough]
    ut = (law.tangent @ b).reshape(-1, law.directions)
    slip = np.linalg.norm(ut, axis=1)
    x[at["motion"]], x[at["one"]], x[at["square"]] = b, 1.0, b @ b
    x[at["fn"]], x[at["un"]], x[at["ft"]] = fn, law.normal @ b, ft.ravel()
    x[at["ut"]], x[at["slip"]], x[at["loss"]] = ut.ravel(), slip, fn_group * slip
    x[at["total"]] = fn_group
    x[at["rest"]] = (
        (law.mu * fn_group)[:, None].repeat(len(attempt.relaxation.directions), 1).ravel()
    )
    x[at["rest"]] += (ft @ attempt.relaxation.directions.T).ravel()
    for columns, rows in zip(attempt.relaxation.twist_columns, law.twist, strict=True):
        x[columns] = rows @ b
    return x


def outside(attempt, bounds, found):
    """The worst violation of a row or bound by the true solution."""
    x = point_of(attempt, found, bounds.scale)
    program = attempt.relaxation.program(bounds)
    rows = program.matrix @ x
    worst = [program.row_lower - rows, rows - program.row_upper]
    worst += [program.lower - x, x - program.upper]
    return max(float(one.max(initial=0.0)) for one in worst)


def begun(program):
    law, work = reduced_law(program), Work(units_of(2))
    return start_proof(law, 1e-9, opening_motion(law, work=work), work)


KINDS = {
    "plane": {"planar": True},
    "plane, patches": {"planar": True, "corners": 2},
    "points": {},
    "one part": {"parts": 1, "patches": 4},
    "edges": {"corners": 2},
    "faces": {"corners": 4, "patches": 2},
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_true_motions_are_contained_and_never_excluded(kind):
    tried = moved = 0
    for seed in range(9):
        found = witnessed(seed, **KINDS[kind])
        if found is None:
            continue
        attempt, bounds = begun(found.program)
        tried += 1
        assert outside(attempt, bounds, found) < ROUNDING
        bounds = dataclasses.replace(bounds, cuts=True)
        assert outside(attempt, bounds, found) < ROUNDING
        bounds, power, answer, _ = power_bound(attempt, bounds)
        bounds = rescaled(attempt.relaxation.fastest, bounds, power)
        assert outside(attempt, bounds, found) < ROUNDING
        tight = shrunk(attempt, bounds, answer)
        moved += bool((tight.un < 0.99 * bounds.un).any())
        assert outside(attempt, tight, found) < ROUNDING
        for _ in range(25):  # down the tree, always in a case that contains it
            tight, power, answer, _ = power_bound(attempt, tight)
            where = breach(attempt.law, attempt.relaxation, tight, answer.x)
            if where.largest <= 0.0:
                break
            kept = [
                case
                for case in cases(attempt.law, tight, where.point, where.patch)
                if outside(attempt, case, found) < ROUNDING
            ]
            assert kept
            tight = kept[0]
        else:
            power = np.inf
        assert not attempt.closed(tight, power)
    assert tried >= 4
    assert moved


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_never_a_proof_where_a_motion_is_built_in(kind):
    for seed in range(100, 112):
        found = witnessed(seed, **KINDS[kind])
        if found is not None:
            answer = prove_no_motion(found.program, work=0.5)
            assert not answer.proved
            assert answer.bound > 1e-9


@pytest.mark.slow
def test_contraction_keeps_the_motion():
    found = witnessed(3, planar=True, corners=2)
    attempt, bounds = begun(found.program)
    bounds, power = contract(attempt, dataclasses.replace(bounds, cuts=True))
    assert power > 1e-9
    assert outside(attempt, bounds, found) < ROUNDING


KINDS_MOMENTS = {
    "points": {},
    "one part": {"parts": 1, "patches": 4},
    "edges": {"corners": 2},
    "faces": {"corners": 4, "patches": 2},
}


def true_motion(law, found):
    """Motion, forces along the normals and across them, in the units of the law."""
    scaled, owner = law.law, found.program
    size = np.linalg.norm(law.allowed.T @ scaled.load)
    pushes = np.einsum("kij,kj->ki", scaled.basis, found.forces)
    pushes /= scaled.strength * size * np.sqrt(owner.mass[owner.free].sum())
    motion = law.allowed.T @ scaled.columns(found.motion) / size
    rough = law.rows[law.group >= 0]
    return motion, pushes[law.rows, 0], pushes[rough, 1 : 1 + law.directions]


def sums(forms, rows, values):
    products = rows.weight * values[rows.left] * values[rows.right]
    return np.bincount(rows.row, products, minlength=rows.count)


def known(seed, kind):
    found = witnessed(seed, **KINDS_MOMENTS[kind])
    if found is None:
        return None
    law = reduced_law(found.program)
    return law, *true_motion(law, found)


@pytest.mark.quick(1)
@pytest.mark.parametrize("kind", KINDS_MOMENTS)
def test_a_true_motion_satisfies_every_product(kind):
    tried = 0
    for seed in range(6):
        one = known(seed, kind)
        if one is None:
            continue
        law, motion, along, across = one
        tried += 1
        scale = float(np.linalg.norm(motion)) * 1.01
        forms = moment_forms(law, scale)
        slip = np.linalg.norm((law.tangent @ motion).reshape(-1, law.directions), axis=1)
        z = np.concatenate([[1.0], motion / scale, along, across.ravel(), slip / scale])
        values, place = forms.rows @ z, monomials(forms)
        rows = law_products(forms, place)
        size = 1e-7 * (1.0 + np.abs(values).max()) ** 2
        assert np.abs(sums(forms, rows.equal, values)).max() < size
        assert sums(forms, rows.positive, values).min() > -size
        cones = sums(forms, rows.cones, values).reshape(-1, 1 + law.directions)
        assert (np.linalg.norm(cones[:, 1:], axis=1) - cones[:, 0]).max() < size
    assert tried >= 3


@pytest.mark.slow
@pytest.mark.parametrize("kind", sampled(2, KINDS_MOMENTS))
def test_no_bound_falls_below_a_true_motion(kind):
    tried = 0
    for seed in range(6):
        one = known(seed, kind)
        if one is None:
            continue
        law, motion, along, _ = one
        work = Work(units_of(2))
        opening = opening_motion(law, work=work)
        if opening is None or not np.isfinite(force_bound(law, opening)):
            continue
        tried += 1
        assert along.sum() <= force_bound(law, opening) * (1 + 1e-7)
        answer = moment_proof(law, opening, 1e-9, work=work)
        assert answer.power >= (law.load @ motion) * (1 - 1e-7)
    assert tried >= 2


def test_any_multipliers_give_a_bound():
    """Randomly changed multipliers of a solver give worse bounds, but never too low."""
    law, motion, _, _ = next(filter(None, (known(seed, "one part") for seed in range(9))))
    work, rng = Work(), np.random.default_rng(0)
    forces = force_bound(law, opening_motion(law, work=work))
    found = solve_semidefinite(moment_program(moment_forms(law, 1.0), "pairs"), work=work)
    power = law.load @ motion
    for size in (0.0, 1e-6, 1e-3, 1.0):
        spoilt = [one + size * rng.normal(size=one.shape) for one in (
            found.equal, found.positive, found.cones)]  # fmt: skip
        squares = tuple(one + size * rng.normal(size=one.shape) for one in found.squares)
        equal, positive, cones = spoilt
        wrong = dataclasses.replace(
            found, equal=equal, positive=positive, cones=cones, squares=squares
        )
        step = MomentStep(1.0, "pairs", wrong)
        assert power_left(law, step, forces) >= power * (1 - 1e-7)


@pytest.mark.slow
def test_multipliers_that_do_not_fit_bound_nothing():
    law = reduced_law(program(stacks.block_on_slope(20.0, friction=0.5)))
    work = Work()
    opening = opening_motion(law, work=work)
    (step, *_) = moment_proof(law, opening, 1e-8, work=work).steps
    forces = force_bound(law, opening)
    assert power_left(law, step, forces) < 1e-6
    short = dataclasses.replace(step.multipliers, equal=step.multipliers.equal[1:])
    assert power_left(law, dataclasses.replace(step, multipliers=short), forces) == 1.0
    wrong = step.multipliers.positive.copy()
    wrong[0] = np.nan
    wrong = dataclasses.replace(step.multipliers, positive=wrong)
    assert power_left(law, dataclasses.replace(step, multipliers=wrong), forces) == 1.0
    assert power_left(law, step, np.inf) == 1.0


@pytest.mark.slow
@pytest.mark.parametrize(("tilt", "closed"), [(44.0, True), (44.15, False), (45.0, False)])
def test_trough_on_both_sides_of_its_limit(tilt, closed):
    law = reduced_law(program(friction.trough(30.0, tilt=tilt)))
    work = Work(units_of(2))
    answer = moment_proof(law, opening_motion(law, work=work), 1e-8, work=work)
    assert (answer.power <= 1e-8) == closed


def test_forces_of_parts_that_jam_have_no_bound():
    jammed = reduced_law(program(friction.h_block()))
    opening = opening_motion(jammed, work=Work())
    assert opening is None or not np.isfinite(force_bound(jammed, opening))
    free = reduced_law(program(stacks.tower(2, friction=0.5)))
    bound = force_bound(free, opening_motion(free, work=Work()))
    assert 1.0 <= bound < 10.0  # two of the same weight carry 1.5 of both
    assert force_bound(free, np.zeros(len(free.load))) == np.inf
