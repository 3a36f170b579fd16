"""Accelerations to 1e-9 g: against Baraff's forces, closed forms, and both own methods."""

from dataclasses import replace

import numpy as np
import pytest
from independent import baraff, kinetic
from judged import program_of, random_turn
from scipy.sparse import csr_array
from transformations import scaled, tilted

from kilter import check
from kilter.analysis.decision.motion import find_motion, optimality
from kilter.assembly import Assembly, Joint
from kilter.mechanics.forms import scaled_problem as scaled_program
from kilter.mechanics.gauss import least_constraint, mirror_half
from kilter.scenes import arches, packings, scene, stacks, walls, wedges
from kilter.scenes.pieces import block, floor
from kilter.scenes.transform import moved
from kilter.solvers import clarabel
from kilter.solvers.block_cholesky import NotPositive
from kilter.solvers.linked_rows import LinkedRows
from kilter.solvers.projection import solve_projection
from kilter.tell.words import motion_summary, motion_words
from sampled import sampled

G = 9.81


def drawn(number):
    """One of many random assemblies: packings, wedges, arches, stacks; some with joints."""
    random = np.random.default_rng(number)
    kind = number % 5
    if kind == 0:
        made = packings.box_pile(3 + number % 5, seed=number, cells=4, level=False)
    elif kind == 1:
        made = wedges.corner_wedges(2 + number % 4, seed=number)
    elif kind == 2:
        made = arches.arch(3 + number % 4, planar=False)
    elif kind == 3:
        made = stacks.tower(1 + number % 5)
    else:
        made = packings.box_pile(4, seed=number, cells=3)
    free = [part.name for part in made.parts if not part.grounded]
    if number % 7 == 0 and len(free) > 1:
        pair = tuple(str(name) for name in random.choice(free, 2, replace=False))
        made = Assembly(made.parts, gravity=made.gravity, joints=[Joint(pair)])
    return made if kind in (0,) else made.with_down(random.normal(size=3))


def both_ways(program, *, enough=0.0):
    """Accelerations over gravity by the interior point: of the whole problem and of the half."""
    problem = scaled_program(program)
    whole = least_constraint(problem)
    heaviest = program.mass[program.free].max() * np.linalg.norm(program.gravity)
    found = []
    for one in (whole, mirror_half(whole, problem)):
        if one is not None:
            answer = solve_projection(one.cone, enough=enough)
            motion = problem.motion(one.accelerations(answer.unknowns))
            forces = one.forces(answer.multipliers) * heaviest
            found.append((motion, optimality(program, motion, forces)))
    return found


def size_of(program, motion):
    """The largest linear, or radius x angular, component."""
    scale = np.ones_like(motion)
    scale[:, 3:] = program.radius[:, None]
    return float(np.abs(motion * scale).max())


@pytest.mark.quick(1)
@pytest.mark.parametrize("number", sampled(16, 200))
def test_both_ways_and_baraffs_forces_agree(number):
    program = program_of(drawn(number))
    found = find_motion(program)
    expected = baraff(program) / G
    assert found.residual < 1e-10
    assert size_of(program, found.acceleration / G - expected) < 1e-9
    for motion, residual in both_ways(program):
        assert residual < 1e-9
        assert size_of(program, motion - expected) < 1e-9
    power = float((program.load * found.acceleration).sum())
    whole = float(program.mass[program.free].sum()) * G**2
    assert power == pytest.approx(kinetic(program, found.acceleration), abs=1e-9 * whole)
    assert 0 <= found.instability <= 1


def test_half_is_taken_only_where_there_is_a_mirror():
    for made, expected in (
        (walls.wall(3, 3), True),
        (arches.arch(5, planar=False), True),
        (tilted(walls.wall(3, 3), [1, 0, 0], 5.0), False),  # leans out of its plane
        (tilted(walls.wall(3, 3), [0, 1, 0], 5.0), True),  # leans within it
        (packings.box_pile(5, seed=3, cells=4, level=False), False),
    ):
        problem = scaled_program(program_of(made))
        assert (mirror_half(least_constraint(problem), problem) is not None) == expected
    turn = random_turn(np.random.default_rng(2))
    problem = scaled_program(program_of(moved(walls.wall(3, 3), turn, [1.0, 2.0, 3.0])))
    assert mirror_half(least_constraint(problem), problem) is not None


def test_optimality_sees_a_wrong_motion_and_wrong_forces():
    program = program_of(scene("paper-figure-8"))
    problem = scaled_program(program)
    whole = least_constraint(problem)
    answer = solve_projection(whole.cone)
    motion = problem.motion(whole.accelerations(answer.unknowns))
    heaviest = program.mass[program.free].max() * G
    forces = whole.forces(answer.multipliers) * heaviest
    assert optimality(program, motion, forces) < 1e-12
    wrong = motion.copy()
    wrong[np.flatnonzero(program.free)[0], 2] += 1e-6
    assert optimality(program, wrong, forces) == pytest.approx(1e-6, rel=0.01)
    pushed = forces.copy()
    pushed[0] += 1e-3 * heaviest
    assert optimality(program, motion, pushed) > 1e-4


@pytest.mark.parametrize(
    ("ratio", "light_on_top"), [(1e6, True), (1e9, True), (1e12, True), (1e6, False), (1e9, False)]
)
def test_masses_far_apart_lose_no_digits_of_the_light(ratio, light_on_top):
    # a block past the edge of a held one tips, another lies on it; a heavy one presses the light
    # one with its weight, whose rounding is all that is left of the digits
    masses = (ratio, 1.0) if light_on_top else (1.0, ratio)
    parts = [
        floor([-2, -1], [0, 1]),
        block("low", [-0.4, -0.5, 0], [0.6, 0.5, 1], mass=masses[0]),
        block("high", [-0.3, -0.5, 1], [0.7, 0.5, 2], mass=masses[1]),
    ]
    program = program_of(Assembly(parts))
    found = find_motion(program)
    assert found.moves[1:].all()
    assert found.residual < (1e-9 if light_on_top else 1e-15 * ratio)


def test_words_of_a_box_past_an_edge():
    table = block("table", [-3, -1, -1], [0, 1, 0], grounded=True)
    box = block("box", [-0.4, -0.5, 0], [0.6, 0.5, 1])
    verdict = check(Assembly([table, box]))
    alpha = G * 0.1 / (1 / 6 + 0.01)
    # the only point of the line of rotation with no height of fall is over the edge, x = 0
    words = verdict.words(1)
    assert words.startswith("tips about +y through (0, 0, 0.5) at ")
    assert f"at {alpha:.4g} rad/s^2" in words
    assert words.endswith(f"its centre drops at {alpha * 0.1 / G:.4g} g")
    assert verdict.summary == f"box {words}"
    millimetres = Assembly([*(scaled(Assembly([table, box]), 1000.0)).parts], units="mm")
    other = check(millimetres).words(1)
    assert other.startswith("tips about +y through (0, 0, 500) at ")
    assert f"at {alpha:.4g} rad/s^2" in other


def test_words_follow_gravity_not_z():
    down = np.array([1.0, 0, 0])
    assert (
        motion_words(np.array([5.0, 0, 0, 0, 0, 0]), np.array([0.5, 0]), down) == "drops at 0.5 g"
    )
    assert motion_words(np.array([-5.0, 0, 0, 0, 0, 0]), np.array([0.5, 0]), down) == (
        "rises at 0.5 g"
    )
    assert motion_words(np.array([0, 0, -5.0, 0, 0, 0]), np.array([0.5, 0]), down) == (
        "slides -z at 0.5 g"
    )
    spin = np.array([0, 0, 0, 2.0, 0, 0])
    assert motion_words(spin, np.array([0, 0.5]), down) == "turns about +x at 2 rad/s^2"
    assert motion_words(np.roll(spin, 1), np.array([0, 0.5]), down) == "tips about +y at 2 rad/s^2"


def test_summary_names_the_fastest_first():
    verdict = check(scene("paper-figure-8"))
    assert verdict.summary == "C2 drops at 0.75 g and C3 slides +x at 0.433 g"
    assert motion_summary(["a rises at 1 g"], 1) == "a rises at 1 g"
    assert check(walls.wall(3, 3)).summary == "nothing moves"
    fall = check(walls.short_base(3, 4, held=2.25))
    assert fall.summary.endswith(f" and {len(fall.moving) - 2} more")


@pytest.mark.slow
def test_a_motion_whose_projection_is_singular_is_found_by_the_other_method(monkeypatch) -> None:
    program = program_of(scene("hanging-brick"))
    expected = find_motion(program)
    asked = []

    def singular(*_: object, **__: object) -> None:
        asked.append(True)
        raise NotPositive

    monkeypatch.setattr("kilter.analysis.decision.motion.SMALL", 0)
    monkeypatch.setattr("kilter.analysis.decision.motion.solve_projection", singular)
    found = find_motion(program)
    assert asked
    assert found.residual < 1e-6
    assert np.allclose(found.acceleration, expected.acceleration, atol=1e-6)


def test_a_motion_of_few_parts_survives_a_conic_solver_that_fails(monkeypatch) -> None:
    program = program_of(scene("paper-figure-8"))
    expected = find_motion(program)
    real = clarabel.solve_conic

    def failed(problem, **options):
        answer = real(problem, **options)
        return replace(answer, outcome="failed", x=np.empty(0), multipliers=np.empty(0))

    monkeypatch.setattr(clarabel, "solve_conic", failed)
    found = find_motion(program)
    assert found.residual < 1e-9
    assert np.allclose(found.acceleration, expected.acceleration, atol=1e-8)


@pytest.mark.parametrize("width", [1, 3, 6])
def test_rows_of_two_blocks_give_the_normal_matrix_of_all(width):
    random = np.random.default_rng(width)
    rows = np.zeros((60, 20, width))
    for row in rows[1:]:  # the first touches none, and of some both ends are one
        row[random.integers(20, size=2)] = random.normal(size=width)
    rows = rows.reshape(60, 20 * width)
    weights = 10 ** random.uniform(-6, 6, 60)
    linked = LinkedRows(csr_array(rows), width, random.normal(size=(20, 3)))
    right = random.normal(size=20 * width)
    expected = np.linalg.solve(np.eye(20 * width) + rows.T @ (weights[:, None] * rows), right)
    assert linked.factorised(weights)(right) == pytest.approx(expected, rel=1e-7, abs=1e-9)
