"""Starting motions and displacements: their mechanics, their digits and their words."""

import dataclasses
from dataclasses import replace

import numpy as np
import pytest
from independent import baraff, dense_rows, kinetic, z_by_duality
from judged import judged, program_of, random_turn
from scipy.sparse import csr_array
from transformations import scaled, tilted

import kilter
from kilter import Assembly, Box, Joint, Load, Part, Pose, Strap, check
from kilter.analysis.decision.motion import find_motion, optimality
from kilter.analysis.verdict.displacement import find_displacement
from kilter.mechanics.forms import displacement
from kilter.mechanics.forms import scaled_problem as scaled_program
from kilter.mechanics.gauss import least_constraint, mirror_half
from kilter.scenes import arches, paper, scene, stacks, traps, walls, wedges
from kilter.scenes import random_bricks as packings
from kilter.scenes.pieces import block, floor, moved, turn
from kilter.scenes.stacks import block_on_slope
from kilter.solvers import clarabel
from kilter.solvers.block_cholesky import LinkedRows, NotPositive
from kilter.solvers.highs import solve_linear
from kilter.solvers.projection import solve_projection
from kilter.tell.text import text_of
from kilter.tell.words import motion_summary, motion_words
from kilter.units import METRES
from sampled import sampled

G = 9.81


def _turned(assembly, seed):
    return assembly.with_down(np.random.default_rng(seed).normal(size=3))


def random_assemblies():
    """Forty small assemblies, most of them unstable, by name."""
    made = {}
    for seed in range(16):
        made[f"pile-{seed}"] = packings.box_pile(4 + seed % 5, seed=seed, cells=4, level=False)
    for seed in range(10):
        wedge = wedges.corner_wedges(3 + seed % 4, seed=seed)
        made[f"wedges-{seed}"] = _turned(wedge, 100 + seed)
    for seed in range(6):
        made[f"leaning-pile-{seed}"] = _turned(packings.box_pile(5, seed=seed, cells=3), seed)
    made |= {
        "opening": walls.wall_with_opening(4, 4, opening=(1, 3, 1, 3)),
        "short-base": walls.short_base(3, 4, held=2.25),
        "hanging": walls.hanging_brick(4, 4),
        "tilted-wall": tilted(walls.wall(3, 3), [1, 1, 0], 7.0),
        "triangle": stacks.inverted_triangle(3),
        "figure-8": paper.figure_8(),
        "figure-1": paper.figure_1(planar=True),
        "wedge": scene("wedge-on-wedge"),
        "floating": traps.floating_block(),
    }
    return made


ASSEMBLIES = random_assemblies()
EACH = pytest.mark.parametrize("name", ASSEMBLIES)


@pytest.mark.quick(3)
@EACH
def test_accelerations_are_those_of_baraffs_forces(name):
    program = program_of(ASSEMBLIES[name])
    found = find_motion(program)
    expected = baraff(program)
    radius = np.repeat(program.radius[:, None], 6, axis=1)
    radius[:, :3] = 1.0
    assert np.abs((found.acceleration - expected) * radius).max() < 1e-9 * G


@pytest.mark.quick(3)
@EACH
def test_gravity_does_the_work_that_becomes_motion(name):
    program = program_of(ASSEMBLIES[name])
    found = find_motion(program)
    power = float((program.load * found.acceleration).sum())
    size = float(program.mass[program.free].sum()) * G**2
    assert power == pytest.approx(kinetic(program, found.acceleration), abs=1e-9 * size)
    assert np.sqrt(max(power, 0) / size) == pytest.approx(found.instability, abs=1e-9)
    assert 0 <= found.instability <= 1 + 1e-12
    assert dense_rows(program) @ found.acceleration.ravel() == pytest.approx(
        np.maximum(dense_rows(program) @ found.acceleration.ravel(), 0), abs=1e-8 * G
    )


@pytest.mark.quick(2)
@EACH
def test_z_is_the_least_imbalance_of_its_dual(name):
    program = program_of(ASSEMBLIES[name])
    z = find_displacement(program).z
    assert z == pytest.approx(z_by_duality(program), rel=1e-9, abs=1e-9 * program.mass.max())


@pytest.mark.quick(3)
@EACH
def test_least_displacement_is_feasible_and_optimal(name):
    program = program_of(ASSEMBLIES[name])
    found = find_displacement(program)
    dp = found.displacement
    assert np.abs(dp).max() <= 1 + 1e-9
    assert (dense_rows(program) @ dp.ravel()).min(initial=0.0) >= -1e-8
    work = float((program.load * dp).sum()) / G
    assert -work == pytest.approx(found.z, rel=1e-8, abs=1e-9)


@pytest.mark.quick(2)
@pytest.mark.parametrize("name", ["pile-1", "wedges-2", "figure-8", "opening", "triangle"])
def test_least_displacement_is_no_longer_than_any_other_optimum(name):
    program = program_of(ASSEMBLIES[name])
    found = find_displacement(program)
    lp = displacement(program)
    for method in ("simplex", "interior"):
        other = solve_linear(lp, method=method).x
        assert np.linalg.norm(found.displacement) <= np.linalg.norm(other) + 1e-6
        # 0 is projected on a convex set: the angle to every other optimum is not obtuse
        shift = program.full(other) - found.displacement
        assert float((found.displacement * shift).sum()) >= -1e-6


def test_z_counts_loads_over_the_size_of_gravity():
    parts = [floor([-2, -2], [2, 2]), block("box", [0, 0, 0], [1, 1, 1], mass=1.0)]
    verdict = judged(Assembly(parts, loads=[Load("box", force=[3 * G, 0, 0])]))
    assert verdict.displacement.z == pytest.approx(-3.0, rel=1e-9)
    assert verdict.to_dict()["instability"] is None


@pytest.mark.quick(3)
@pytest.mark.parametrize("units", ["m", "cm", "mm", "in"])
def test_accelerations_are_si_in_every_unit(units):
    # a box past an edge: m/s^2 and rad/s^2 of the same box told in other units
    u = METRES[units]
    table = block("table", np.array([-3, -1, -1]) / u, np.array([0, 1, 0]) / u, grounded=True)
    box = block("box", np.array([-0.4, -0.5, 0]) / u, np.array([0.6, 0.5, 1]) / u, density=500.0)
    verdict = judged(Assembly([table, box], units=units))
    alpha = G * 0.1 / (1 / 6 + 0.01)
    expected = [0, 0, -alpha * 0.1, 0, alpha, 0]
    assert np.allclose(verdict.motion.acceleration[1], expected, atol=1e-9)
    assert verdict.program.mass[1] == pytest.approx(500.0)


def test_figures_that_no_solver_finishes_are_left_out_and_the_verdict_stands(monkeypatch):
    from kilter import check, example
    from kilter.solvers import highs

    assembly = example("paper-figure-8")
    verdict = check(assembly)
    monkeypatch.setattr(highs, "FEW", 1)
    monkeypatch.setattr(highs, "MANY", 0)
    monkeypatch.setattr(highs, "INTERIOR_STEPS", 1)
    answer = verdict.to_dict()
    assert answer["verdict"] == "unstable"
    assert answer["z"] is None
    assert {part["displacement"] is None for part in answer["parts"]} == {True}
    assert any(
        "no solver finished the displacement program" in warning for warning in answer["warnings"]
    )


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
def test_a_motion_whose_projection_is_singular_is_found_by_the_other_method(monkeypatch):
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


def test_a_motion_of_few_parts_survives_a_conic_solver_that_fails(monkeypatch):
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


TABLE = block("table", [-5, -5, -1], [5, 5, 0], grounded=True)
ROUND = {
    "ball": (kilter.Part("ball", kilter.Sphere(0.5), [0, 0, 0.5]), 5 / 7),
    "roller": (
        kilter.Part(
            "roller", kilter.Cylinder(0.5, 1.0), kilter.Pose([0, 0, 0.5], turn([1, 0, 0], 90))
        ),
        2 / 3,
    ),
}


@pytest.mark.parametrize("name", ["ball", "roller"])
@pytest.mark.quick(1)
def test_a_round_part_on_a_rough_slope_rolls(name):
    """The centre accelerates by 5/7 of g sin for a ball, 2/3 for a cylinder."""
    part, share = ROUND[name]
    steep = np.arctan(1 / 3)
    down = [np.sin(steep), 0, -np.cos(steep)]
    assembly = kilter.Assembly([TABLE, part], friction=0.8).with_down(down)
    size = share * np.sin(steep)
    assert kilter.check(assembly).summary == f"{name} rolls down +x at {size:.4g} g"
    carried = kilter.transport(kilter.Assembly([TABLE, part], friction=0.8), polar=False)
    assert carried.to_dict()["limits"][0]["motion"][0]["words"] == "rolls"
    smooth = kilter.check(assembly.with_friction(0.0)).summary
    assert smooth == f"{name} slides down +x at {np.sin(steep):.4g} g"


def test_a_load_whose_strap_gives_way_slides_level():
    """The motion of the proof opens the sliding contact by mu times the slip; the words do not."""
    load = block("load", [0, 0, 0], [1, 1, 1])
    strap = Strap([("table", [0.5, 3, 0]), ("load", [0.5, 1, 1])], capacity=100.0)
    pushed = kilter.Assembly(
        [TABLE, load],
        friction=0.75,
        straps=[strap],
        loads=[Load("load", force=[0, -0.95 * 9810, 0])],
    )
    verdict = kilter.check(pushed)
    assert verdict.summary.startswith("load slides -y, ")
    assert any("is not modelled" in warning for warning in verdict.to_dict()["warnings"])


@pytest.mark.parametrize(("size", "words"), [(0.1, "12395"), (100.0, "12395"), (1e4, "12400")])
def test_points_of_axes_have_digits_relative_to_the_part(size, words):
    """A part of this size tips about its edge, far from the origin."""
    edge, spin = np.array([12395.0, 0.0, 50.0]), np.array([0.0, 6.0, 0.0])
    arm = np.array([size, 0.0, 0.0])
    linear = np.cross(spin, arm)
    relative = np.array([np.linalg.norm(linear), size * np.linalg.norm(spin)])
    told = motion_words(
        np.append(linear, spin), relative, np.array([0, 0, -1.0]), center=edge + arm, sizes=False
    )
    assert told.startswith(f"tips about +y through ({words}, 0, ")


@pytest.mark.parametrize("mu", [0.0, 0.2, 0.8])
def test_z_kappa_and_displacements_ignore_friction(mu):
    """A block on a slope of 30 degrees: kappa is sin 30 without friction, and z is -m sin 30."""
    slope = block_on_slope(30.0, friction=mu)
    answer = kilter.check(slope, measures=True).to_dict()
    mass = float(slope.geometry.mass[~slope.geometry.grounded].sum())
    assert answer["instability"] == pytest.approx(0.5, abs=1e-6)
    assert answer["z"] <= -0.5 * mass
    smooth = kilter.check(dataclasses.replace(slope, friction=0.0)).to_dict()
    assert answer["z"] == pytest.approx(smooth["z"], rel=1e-6)
    for part, other in zip(answer["parts"], smooth["parts"], strict=True):
        assert part["displacement"] == pytest.approx(other["displacement"], abs=1e-5)


def two_groups() -> Assembly:
    """A ball in a close box on a table, which stays open, and two boxes that hang in the air."""
    return Assembly(
        [
            Part("table", Box([4, 4, 1]), Pose([0, 0, -0.5]), grounded=True),
            Part("base", Box([1, 1, 1]), Pose([0, 0, 0.5])),
            Part("sunk", Box([0.5, 0.5, 0.5]), Pose([0, 0, 1.2])),  # 5 cm deep in the base
            Part("upper", Box([1, 1, 1]), Pose([0, 0, 6.0])),
            Part("lower", Box([1, 1, 1]), Pose([0, 0, 5.0])),
        ]
    )


def test_the_parts_of_the_proof_are_listed_first():
    verdict = kilter.check(two_groups())
    assert verdict.verdict == "unstable"
    proved = [verdict.program.names[k] for k in np.flatnonzero(verdict.moved_by_proof)]
    assert proved
    assert set(proved) <= {"upper", "lower"}  # joined to the base, "sunk" stays
    assert set(verdict.moving) == {"sunk", "upper", "lower"}
    text = text_of(verdict.to_dict())
    which = "the first moves" if len(proved) == 1 else "the first 2 move"
    assert (
        "3 of 4 free parts move if the open pairs carry no force; it is proved that "
        f"{which} in any case:"
    ) in text
    assert max(text.index(f"\n  {name}") for name in proved) < text.index("\n  sunk")


def test_the_sentence_states_that_no_open_pair_could_stop_it():
    assembly = two_groups()
    verdict = kilter.check(assembly)
    (pair,) = verdict.to_dict()["open_pairs"]
    assert "can hold it, not even with forces at its open pairs. Here is how" in verdict.sentence
    joined = kilter.check(assembly.with_joints([kilter.Joint(tuple(pair["parts"]))]))
    alone = kilter.check(assembly.without(["sunk"]))
    for other in (joined, alone):
        assert other.verdict == "unstable"
        assert "open pairs" not in other.sentence
    undecided = kilter.check(assembly.without(["upper", "lower"]))
    assert undecided.verdict == "undecided"


def test_a_group_that_touches_no_other_part_is_named():
    verdict = kilter.check(two_groups())
    assert "touch no other part: the group ('upper', 'lower')" in verdict.warnings


def test_a_group_with_a_held_part_or_a_joint_to_it_does_not_float():
    joined = two_groups().with_joints([kilter.Joint(("base", "lower"))])
    assert not any("touch no other part" in text for text in kilter.check(joined).warnings)


def test_without_a_motion_the_proof_moves_no_part():
    verdict = kilter.check(kilter.example("tower"))
    assert not np.any(verdict.moved_by_proof)
    assert not any(part["moved_by_proof"] for part in verdict.to_dict()["parts"])
