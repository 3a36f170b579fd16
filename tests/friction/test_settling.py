"""Loosely placed parts: do they come to rest? Both sides of limits, and parts that jam."""

from __future__ import annotations

import numpy as np
import pytest
from held_or_not import cylinders, program, slope, thin_bracket
from random_friction import random_assembly

from kilter import check
from kilter.cli import main
from kilter.friction.elastic_forces import _DilatingSprings, elastic_forces
from kilter.friction.law import coulomb_law
from kilter.friction.settling import find_settling
from kilter.friction.springs import Springs, spring_system
from kilter.mechanics.law_check import check_balance
from kilter.scenes import arches, friction, stacks, walls
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
@pytest.mark.parametrize(
    ("name", "require", "code"),
    [
        ("tower", "proved", 0),
        ("trough", "settles", 0),
        ("trough", "proved", 3),
        ("squeezed-block", "settles", 3),
        ("squeezed-block", "equilibrium", 0),
        ("hanging-brick", "equilibrium", 1),
        ("trough", "strict", 3),
        ("tower", "sure", 2),
    ],
)
def test_the_exit_code_is_that_of_the_level_asked_for(name, require, code, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["example", name]) == 0
    file = f"{name}.kilter.json"
    assert main(["check", file, "--quiet", "--effort", "0", "--require", require]) == code


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
    monkeypatch.setattr("kilter.friction.elastic_forces.balanced_springs", lambda *_: None)
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
@pytest.mark.parametrize("planar", [False, True])
def test_an_arch_of_a_thousand_voussoirs_settles_at_the_default_effort(planar):
    verdict = check(arches.arch(1000, friction=0.6, planar=planar))
    assert (verdict.level, verdict.tries.passed) == ("settles", 8)


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
