"""Assemblies that settle or are seated, on both sides of limits."""

import dataclasses

import numpy as np
import pytest
from cases import program, random_block
from held_or_not import cylinders, equilibrium, slope, thin_bracket
from judged import random_turn
from random_friction import random_assembly
from transformations import permuted, split

from kilter import Joint, check
from kilter.friction.canonical import canonical
from kilter.friction.law import coulomb_law
from kilter.friction.seating import find_seating
from kilter.friction.settling import find_settling
from kilter.friction.spring_newton import _DilatingSprings, elastic_forces
from kilter.friction.springs import Springs, spring_system
from kilter.mechanics.certificate import part_sizes
from kilter.mechanics.law_check import check_balance
from kilter.mechanics.program import Program
from kilter.scenes import arches, friction, stacks, traps, walls, wedges
from kilter.scenes.pieces import moved
from kilter.scenes.stacks import tower
from kilter.solvers.block_cholesky import NotPositive
from kilter.tell.facts import facts
from kilter.work import Work


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("assembly", "settles"),
    [
        (slope(26.5), True),
        (slope(26.6), False),  # atan 0.5 = 26.565
        (friction.trough(30, tilt=44.10, friction=0.84), True),
        (friction.trough(30, tilt=44.15, friction=0.84), False),  # 44.126
        (friction.ladder(51.36), True),
        (friction.ladder(51.32), False),  # 51.3402
        (cylinders(0.2681, 0.0895), True),
        (cylinders(0.2678, 0.0895), False),  # 2 - sqrt 3 = 0.267949
        (friction.v_block(friction=0.5), True),
        (friction.books(4), True),
        (arches.arch(20, ratio=0.15, friction=0.7), True),
        (walls.wall(4, 4, friction=0.6), True),
    ],
)
def test_both_sides_of_a_limit(assembly, settles):
    found = find_settling(program(assembly))
    assert found.passed == (8 if settles else 0)
    assert found.ends == (("balance",) * 8 if settles else ("runs-away",) * 8)
    assert (found.runaway is None) == settles
    built = program(assembly)
    assert all(check_balance(built, one) <= 1e-9 for one in found.forces)


@pytest.mark.slow
@pytest.mark.parametrize(
    "assembly",
    [
        friction.bracket(),
        thin_bracket(1.1),
        friction.h_block(),
        friction.a_block(),
        friction.squeezed_row(4),
        friction.squeezed_row(5, thickness=0.3, height=0.4, friction=0.7),
    ],
    ids=["bracket", "thin bracket", "H", "A", "row", "flat arch"],
)
def test_what_only_jams_or_is_squeezed_does_not_settle(assembly):
    built = program(assembly)
    assert find_settling(built).ends == ("runs-away",) * 8
    verdict = check(assembly)
    assert (verdict.verdict, verdict.level) == ("potentially-stable", "equilibrium")
    assert not verdict.stable


@pytest.mark.slow
def test_tries_that_were_not_made_are_told_with_the_effort_that_makes_them():
    told = check(friction.trough(30, tilt=35.0, friction=0.84), effort=0).to_dict()
    assert dict(facts(told))["settles"] == "8 of 8 tries came to rest"
    told |= {"verdict": "potentially-stable", "level": "equilibrium", "why": "not-found"}
    told |= {"tries": {"passed": 3, "of": 4}, "holds": False}
    told["friction"]["settling"] = {"ends": ["balance"] * 3 + ["not-found"], "of": 8}
    words = dict(facts(told))
    assert words["settles"] == (
        "3 of 3 tries came to rest; 5 more were not finished for lack of effort: --effort 2"
    )
    assert words["level"].startswith("equilibrium: not every try was finished")


@pytest.mark.slow
def test_a_motion_keeps_the_level_at_equilibrium_though_every_try_came_to_rest():
    _, fence = random_assembly(594)
    verdict = check(fence)
    assert verdict.tries.to_dict() == {"passed": 8, "of": 8}
    assert (verdict.level, verdict.why, verdict.guarantee) == ("equilibrium", "refuted", "refuted")


@pytest.mark.slow
def test_work_that_runs_out_is_not_found_and_never_no():
    built = program(arches.arch(20, friction=0.6, planar=False))
    found = find_settling(built, work=Work(3e4))
    assert found.ends[-1] == "not-found"
    assert len(found.ends) < 8
    assert not found.settles
    assert not found.runs_away


@pytest.mark.slow
def test_the_same_tries_again_and_other_tries_of_another_seed():
    built = program(stacks.tower(3, tilt=5.0, friction=0.5))
    one, two, other = (find_settling(built, seed=seed) for seed in (0, 0, 100))
    assert all(np.array_equal(a, b) for a, b in zip(one.forces, two.forces, strict=True))
    assert not np.array_equal(one.forces[0], other.forces[0])


def test_forces_of_the_least_energy_balance_and_are_a_start():
    law = coulomb_law(program(arches.arch(9, friction=0.6, planar=False)))
    elastic = elastic_forces(law, work=Work())
    rest = law.load + law.matrix.T @ elastic.forces.reshape(-1)
    assert np.abs(rest).max() < 1e-7
    across = np.linalg.norm(elastic.forces[:, 1:], axis=1)
    assert (across <= law.mu * elastic.forces[:, 0] + 1e-7).all()


@pytest.mark.parametrize("wide", [False, True])
def test_the_newton_step_solves_the_system_written_out(wide, monkeypatch):
    law = coulomb_law(program(walls.wall(3, 3, friction=0.6)))
    if wide:
        monkeypatch.setattr("kilter.friction.spring_matrix.WIDEST_BAND", 0)
    rng = np.random.default_rng(3)
    springs = Springs(spring_system(law), rng.uniform(0.5, 2, len(law.mu)), rng.random(len(law.mu)))
    state = springs.at(rng.normal(size=len(law.load)))
    right, small = rng.normal(size=len(law.load)), 1e-6
    step = springs.newton(state, right, 0.3, Work())
    ahead = springs.at(state.x + small * step).rest - springs.at(state.x - small * step).rest
    assert 0.3 * step - ahead / (2 * small) == pytest.approx(right, abs=1e-5)


@pytest.mark.slow
def test_a_time_limit_says_so_and_exits_by_the_level():
    trough = friction.trough(30, tilt=35.0, friction=0.84)
    late = check(trough, time_limit=0.0)
    assert late.time_limit == 0.0
    assert any("time limit" in words for words in late.warnings)
    assert late.level in (None, "equilibrium")
    assert check(trough, effort=0).time_limit is None


@pytest.mark.slow
def test_measures_that_leave_friction_out_are_told_where_asked_for():
    trough = friction.trough(30, tilt=60.0, friction=0.3)
    plain, measured = (check(trough, measures=on).to_dict() for on in (False, True))
    assert plain["verdict"] == "unstable"
    assert plain["z"] is None
    assert plain["instability"] is None
    assert plain["parts"][1]["displacement"] is None
    assert measured["z"] < 0
    assert measured["instability"] > 0
    assert check(stacks.tower(2)).to_dict()["z"] == 0.0


@pytest.mark.parametrize("widest", [0, 1000])
def test_a_symmetric_newton_step_solves_the_system_without_the_pull_of_sliding(widest, monkeypatch):
    monkeypatch.setattr("kilter.friction.spring_matrix.DISSECTED", widest)
    law = coulomb_law(program(walls.wall(3, 3, friction=0.6)))
    rng = np.random.default_rng(3)
    springs = Springs(spring_system(law), np.ones(len(law.mu)), rng.random(len(law.mu)))
    state = springs.at(rng.normal(size=len(law.load)))
    right = rng.normal(size=len(law.load))
    slope = np.zeros((3 * len(law.mu), 3 * len(law.mu)))
    for k, (u, mu) in enumerate(zip(state.opening, law.mu, strict=True)):
        if u[0] >= 0:
            continue
        drag, limit = 0.7 * np.hypot(*u[1:]), -mu * u[0]
        along = u[1:] / np.hypot(*u[1:])
        stuck = 0.7 * np.eye(2)
        sliding = 0.7 * limit / drag * (np.eye(2) - np.outer(along, along))
        slope[3 * k, 3 * k] = 1.0
        slope[3 * k + 1 : 3 * k + 3, 3 * k + 1 : 3 * k + 3] = stuck if drag <= limit else sliding
    matrix = law.matrix.toarray()
    written_out = matrix.T @ slope @ matrix + 0.3 * np.eye(len(law.load))
    step = springs.newton(state, right, 0.3, Work(), exact=False)
    assert step == pytest.approx(np.linalg.solve(written_out, right), rel=1e-8, abs=1e-10)


def test_a_wall_of_a_size_that_symmetric_matrices_serve_settles_as_with_exact_matrices(monkeypatch):
    tilted = program(walls.tilted_wall(8.0, friction=0.6, courses=4, per_course=4))
    monkeypatch.setattr("kilter.friction.spring_newton.NARROW", 1000)
    exact = find_settling(tilted, tries=2)
    monkeypatch.setattr("kilter.friction.spring_matrix.SYMMETRIC", 1)
    rough = find_settling(tilted, tries=2)
    assert exact.passed == rough.passed == 2
    for forces, others in zip(exact.forces, rough.forces, strict=True):
        assert others == pytest.approx(forces, abs=1e-6 * np.abs(forces).max())


def test_inexact_newton_steps_end_in_the_balance_of_the_path_from_rest(monkeypatch):
    tilted = program(walls.tilted_wall(8.0, friction=0.6, courses=4, per_course=4))
    released = find_settling(tilted, tries=2)
    monkeypatch.setattr("kilter.friction.settling.balanced_springs", lambda *_: None)
    fallen = find_settling(tilted, tries=2)
    assert released.passed == fallen.passed == 2
    assert released.iterations < fallen.iterations
    for forces, others in zip(released.forces, fallen.forces, strict=True):
        assert others == pytest.approx(forces, abs=1e-6 * np.abs(forces).max())


def test_a_factor_that_rounding_makes_indefinite_is_made_stiffer(monkeypatch):
    """It was a fault of kilter, on a scene with parts of very different sizes."""
    tilted = program(walls.tilted_wall(8.0, friction=0.6, courses=4, per_course=4))
    exact = find_settling(tilted, tries=2)
    monkeypatch.setattr("kilter.friction.spring_newton.STIFFER", (-1e3,))
    with pytest.raises(NotPositive):
        find_settling(tilted, tries=2)
    monkeypatch.setattr("kilter.friction.spring_newton.STIFFER", (-1e3, 1e-5))
    found = find_settling(tilted, tries=2)
    assert found.passed == exact.passed == 2
    for forces, others in zip(found.forces, exact.forces, strict=True):
        assert others == pytest.approx(forces, abs=1e-6 * np.abs(forces).max())


def test_an_unsupported_part_is_not_released_from_closed_contacts(monkeypatch):
    # a call of it fails
    monkeypatch.setattr("kilter.friction.settling._SpringDescent._release", None)
    assert find_settling(program(friction.bracket()), tries=1).ends == ("runs-away",)
    with pytest.raises(TypeError):
        find_settling(program(friction.trough(30, tilt=35.0, friction=0.84)), tries=1)


def test_forces_of_the_least_energy_are_those_of_the_conic_solver(monkeypatch):
    law = coulomb_law(program(walls.tilted_wall(8.0, friction=0.6, courses=4, per_course=4)))
    newton = elastic_forces(law, work=Work())
    monkeypatch.setattr("kilter.friction.spring_newton.balanced_springs", lambda *_: None)
    conic = elastic_forces(law, work=Work())
    assert newton.forces == pytest.approx(conic.forces, abs=1e-4 * np.abs(conic.forces).max())
    assert newton.displacement == pytest.approx(
        conic.displacement, abs=1e-5 * np.abs(conic.displacement).max()
    )


@pytest.mark.parametrize("kind", [Springs, _DilatingSprings])
def test_slopes_are_the_derivatives_of_the_forces(kind):
    law = coulomb_law(program(walls.wall(2, 2, friction=0.6)))
    springs, rng = kind(spring_system(law), np.ones(len(law.mu))), np.random.default_rng(5)
    state = springs.at(rng.normal(size=len(law.load)))
    change, small = rng.normal(size=state.opening.shape), 1e-6
    ahead = springs.forces(state.opening + small * change)
    ahead -= springs.forces(state.opening - small * change)
    slopes = springs.slope_matrices(state, exact=True)[:-1]
    assert np.einsum("kij,kj->ki", slopes, change) == pytest.approx(-ahead / (2 * small), abs=1e-5)


@pytest.mark.slow
def test_a_leaning_wall_of_a_thousand_bricks_settles_at_the_default_effort():
    verdict = check(walls.tilted_wall(1.5, friction=0.6, courses=32, per_course=31))
    assert (verdict.level, verdict.tries.passed) == ("settles", 8)


def test_a_try_that_takes_most_of_the_work_of_all_is_the_last():
    tilted = program(walls.tilted_wall(8.0, friction=0.6, courses=4, per_course=4))
    whole = Work()
    assert find_settling(tilted, work=whole).settles
    short = Work(0.5 * whole.spent)
    stopped = find_settling(tilted, work=short)
    assert stopped.ends == ("not-found",)
    beforehand = Work()
    elastic_forces(coulomb_law(tilted), work=beforehand)
    assert short.spent < beforehand.spent + 0.15 * (whole.spent - beforehand.spent)


def in_cones_and_balanced(built, seating):
    """Check the forces by explicit formulas."""
    along = (built.normal * seating.forces).sum(axis=1)
    across = np.linalg.norm(seating.forces - along[:, None] * built.normal, axis=1)
    inside = (along >= 0) & (across <= built.mu * along * (1 + 1e-12) + 1e-12 * along.max())
    total = np.zeros((len(built.names), 6))
    for part, sign in ((built.part_b, 1.0), (built.part_a, -1.0)):
        torque = np.cross(built.point - built.center[part], seating.forces)
        np.add.at(total, part, sign * np.hstack([seating.forces, torque]))
    rest = part_sizes(built, total + built.load, per_radius=True)[built.free]
    return bool(inside.all() and (rest <= 1e-9 * built.weight[built.free]).all())


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("assembly", "seated"),
    [
        (slope(26.5), True),
        (slope(26.6), False),  # atan 0.5 = 26.565
        (friction.trough(30, tilt=44.10, friction=0.84), True),
        (friction.trough(30, tilt=44.15, friction=0.84), False),
        (friction.trough(60, tilt=59.2, friction=0.84), True),
        (friction.trough(60, tilt=59.3, friction=0.84), False),
        (thin_bracket(1.02), True),
        (thin_bracket(1.1), True),
        (thin_bracket(0.98), False),
        (friction.ladder(51.36, planar=False), True),
        (friction.ladder(51.32, planar=False), False),  # 51.3402
        (friction.ladder(51.36), True),
        (friction.ladder(51.32), False),
        (cylinders(0.2681, 0.0895), True),
        (cylinders(0.2678, 0.0895), False),  # 2 - sqrt 3 = 0.267949
        (cylinders(0.2681, 0.0892), False),  # (2 - sqrt 3) / 3 = 0.089316
    ],
)
def test_both_sides_of_a_limit_seating(assembly, seated):
    built = program(assembly)
    seating = find_seating(built)
    assert seating.holds == seated
    assert (seating.residual <= 1e-9) == seated
    assert (seating.runaway is None) == seated
    assert seating.seated == ("yes" if seated else "runs-away")
    assert in_cones_and_balanced(built, seating) == seated


@pytest.mark.slow
@pytest.mark.parametrize("pad", [0.1, 0.3])
def test_wide_pads_press_evenly_and_so_need_more(pad):
    """Elastic pads from z = h/2 to h/2 + p press in proportion to z: the bracket is higher."""
    ends = np.array([0.5, 0.5 + pad])
    least = 2 * (ends**2).sum() / ends.sum() * 0.5 / 0.6
    for factor, seated in ((1.02, True), (0.99, False)):
        built = program(friction.bracket(factor * least, friction=0.6, pad=pad))
        assert equilibrium(built)
        assert find_seating(built, starts=12).holds == seated


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    "assembly",
    [
        friction.h_block(),
        friction.h_block(planar=True),
        friction.a_block(),
        friction.squeezed_row(4),
        friction.squeezed_row(5, thickness=0.3, height=0.4, friction=0.7),
    ],
    ids=["H", "planar H", "A", "books", "flat arch"],
)
def test_held_by_squeeze_alone_is_not_seated(assembly):
    built = program(assembly)
    assert equilibrium(built)
    seating = find_seating(built)
    assert not seating.holds
    assert seating.starts == 6
    assert float((built.load * seating.runaway).sum()) > 0


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    "assembly",
    [
        friction.v_block(),
        friction.v_block(friction=0.5),
        stacks.tower(10),
        arches.arch(20, ratio=0.15, friction=0.7),
        arches.arch(20, ratio=0.11, friction=0.7),
        wedges.keystone(15, friction=0.1),
        walls.wall(6, 6, friction=0.6),
        walls.tilted_wall(5.0),
        friction.books(4),
    ],
    ids=["V", "V rough", "tower", "arch", "thin arch", "keystone", "wall", "tilted", "pressed"],
)
def test_what_rests_is_seated(assembly):
    built = program(assembly)
    seating = find_seating(built)
    assert seating.holds
    assert in_cones_and_balanced(built, seating)


@pytest.mark.slow
def test_seated_implies_equilibrium_for_blocks_at_random():
    rng = np.random.default_rng(5)
    counts = {True: 0, False: 0}
    for _ in range(20):
        assembly = random_block(rng, 3).with_down([rng.normal(), 0, -1])
        built = program(assembly)
        seated = find_seating(built).holds
        counts[seated] += 1
        assert equilibrium(built) or not seated
    assert min(counts.values()) >= 4


def test_a_joint_carries():
    floating = traps.floating_block(2)
    assert not find_seating(program(floating)).holds
    loose = [part.name for part in floating.parts if not part.grounded]
    tied = floating._replace(joints=[Joint(("ground", name)) for name in loose])
    seating = find_seating(program(tied))
    assert seating.holds
    assert seating.starts == 1


def test_one_force_flipped_does_not_balance():
    built = program(slope(20))
    seating = find_seating(built)
    assert check_balance(built, seating.forces) <= 1e-9
    most = np.abs(seating.forces).max()
    for k, axis in np.argwhere(np.abs(seating.forces) > 1e-3 * most):
        forces = seating.forces.copy()
        forces[k, axis] *= -1
        assert check_balance(built, forces) > 1e-3


def test_nothing_free_is_seated_and_no_work_leaves_one_start():
    held = friction.h_block().with_grounded(["*"])
    assert find_seating(program(held)).holds
    assert find_seating(program(friction.h_block()), work=0).starts == 1


BASES = {
    "tower": lambda: tower(3, tilt=10.0, friction=0.5),
    "stack": lambda: dataclasses.replace(random_assembly(47)[1], planar=False),
    "fence": lambda: dataclasses.replace(random_assembly(12)[1], planar=False),
}
COPIES = {
    "turned": lambda a, rng: moved(a, random_turn(rng), rng.normal(size=3)),
    "permuted": lambda a, rng: permuted(a, rng.permutation(len(a.parts))),
    "split": lambda a, rng: split(a),
}


def same(one: Program, other: Program) -> None:
    """All numbers that a proof refers to are equal up to rounding."""
    for key in ("part_a", "part_b", "source", "kind"):
        assert getattr(one, key).tolist() == getattr(other, key).tolist()
    for key in ("point", "normal", "mu", "gravity"):
        assert getattr(one, key) == pytest.approx(getattr(other, key), abs=1e-9)
    for key in ("mass", "center", "inertia"):
        mine, theirs = getattr(one, key)[one.free], getattr(other, key)[other.free]
        assert mine == pytest.approx(theirs, rel=1e-9, abs=1e-9 * np.abs(theirs).max())


@pytest.mark.parametrize("copy", [copy for copy in COPIES if copy != "split"])
@pytest.mark.parametrize("name", BASES)
def test_copies_have_the_same_program(name, copy):
    base = BASES[name]()
    expected = canonical(program(base))
    made = COPIES[copy](base, np.random.default_rng(3))
    assert not np.allclose(program(made).point[:4], program(base).point[:4])
    same(canonical(program(made)), expected)
    same(canonical(expected), expected)


def test_a_point_within_the_seam_of_two_joined_halves_counts_once():
    """The halves of a cube touch the slab below in 8 points, 4 of them on their seam."""
    base = tower(1)
    assert len(program(split(base)).part_a) == 8 + 4 + 6  # with the seam and the joint
    assert len(canonical(program(split(base))).part_a) == 6
    assert len(canonical(program(base)).part_a) == 4
