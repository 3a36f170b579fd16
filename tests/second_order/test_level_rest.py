"""Parts on level faces are free at any size, by a proof without forms of gaps."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

import kilter
from kilter import Assembly, Cylinder, Part, Pose
from kilter.analysis.verdict.neutral import find_neutral
from kilter.mechanics.program import Program, build_program
from kilter.scenes import scene
from kilter.scenes.walls import wall_of
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.proofs.level_rest import (
    LevelRest,
    judge_level_rest,
    level_rows,
)
from kilter.second_order.searches.level_rest_search import find_level_rest
from kilter.shape.primitives import Box


def posed(assembly: Assembly) -> tuple[Program, np.ndarray]:
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts).frictionless
    return program, level_rows(program, contacts)


def rest_of(assembly: Assembly) -> LevelRest | None:
    program, level = posed(assembly)
    return find_level_rest(program, level, None)


def answer(assembly: Assembly) -> SecondOrder:
    second = kilter.check(assembly).second_order_answer
    assert second is not None
    return second


def table(*parts: Part) -> Assembly:
    return Assembly([Part("base", Box([8, 8, 1]), Pose([0, 0, -0.5]), grounded=True), *parts])


@pytest.mark.parametrize("bricks", [1, 12, 105, 1000])
def test_a_wall_is_free_whatever_its_size(bricks: int) -> None:
    """Three motions for each brick, as many as the linear programs count."""
    wall = wall_of(bricks)
    second = answer(wall)
    free = len(wall.parts) - 1
    assert second.state == "free"
    assert (second.neutral, second.free, second.undecided) == (3 * free, 3 * free, 0)
    if free <= 20:
        counted = find_neutral(posed(wall)[0])
        assert counted is not None
        assert counted.two_sided + counted.one_sided == 3 * free


@pytest.mark.quick("diamond")
@pytest.mark.parametrize("name", ["harmonic-stack", "diamond", "pierced-wall"])
def test_where_loads_must_be_shared_a_program_shares_them(name: str) -> None:
    """A stack at its limit, held down by others over an opening; the counts of motions agree."""
    verdict = kilter.check(scene(name))
    second = verdict.second_order_answer
    assert second is not None
    counted = find_neutral(verdict.program)
    assert counted is not None
    assert second.state == "free"
    assert second.free == second.neutral == counted.two_sided + counted.one_sided


def stack(seed: int) -> Assembly:
    """Boxes on each other; the boxes above each box balance on it."""
    random = np.random.default_rng(seed)
    count = int(random.integers(2, 30))
    off = random.uniform(-0.45, 0.45, (count, 2)) / np.arange(count, 0, -1)[:, None]
    at = np.cumsum(off, axis=0)
    boxes = [Part(f"{k}", Box([1, 1, 0.2]), Pose([*at[k], 0.1 + 0.2 * k])) for k in range(count)]
    return table(*boxes)


@pytest.mark.parametrize("seed", range(8))
def test_a_stack_that_leans_is_free(seed: int) -> None:
    assembly = stack(seed)
    program, level = posed(assembly)
    proof = find_level_rest(program, level, None)
    assert proof is not None
    # the energy rises along every motion of height and tilt that keeps the contacts
    rows = program.jacobian().toarray()[proof.forces > 0]
    upright = np.tile([False, False, True, True, True, False], int(program.free.sum()))
    values = np.linalg.svd(rows[:, upright], compute_uv=False)
    assert values[-1] > 1e-6 * values[0]
    np.testing.assert_allclose(rows[:, ~upright], 0, atol=1e-12)


@pytest.mark.parametrize("seed", range(3))
def test_on_a_slope_there_is_no_such_rest(seed: int) -> None:
    program, level = posed(stack(seed).with_down([0.01, 0, -1]))
    assert not level.any()
    assert find_level_rest(program, level, None) is None


@pytest.mark.parametrize(("off", "holds"), [(0.499, True), (0.501, False)])
def test_the_middle_of_a_box_is_above_what_bears_it(off: float, holds: bool) -> None:
    assembly = table(
        Part("low", Box([1, 1, 1]), Pose([0, 0, 0.5])),
        Part("high", Box([1, 1, 1]), Pose([off, 0, 1.5])),
    )
    assert kilter.check(assembly).stable == holds
    assert (rest_of(assembly) is not None) == holds


def test_points_on_one_line_hold_no_tilt() -> None:
    """A board on a lying cylinder rests on a level line, which is no rest on faces."""
    round_ = Cylinder(0.5, 2)
    lying = Part("c", round_, Pose([0, 0, 0.5], [np.sqrt(0.5), np.sqrt(0.5), 0, 0]), grounded=True)
    board = Part("b", Box([1, 1, 0.1]), Pose([0, 0, 1.05]))
    assembly = Assembly([lying, board])
    assert rest_of(assembly) is None
    second = kilter.check(assembly).second_order_answer
    assert second is None or second.state != "free"


def test_between_walls_the_gaps_themselves_are_asked() -> None:
    """A box between two walls across x slides only along y."""
    held = [
        Part(name, Box([1, 4, 1]), Pose([x, 0, 0.5]), grounded=True)
        for name, x in (("left", -1), ("right", 1))
    ]
    assembly = table(*held, Part("b", Box([1, 1, 1]), Pose([0, 0, 0.5])))
    assert rest_of(assembly) is None
    second = answer(assembly)
    assert (second.state, second.neutral, second.free) == ("free", 1, 1)
    beside = table(held[0], Part("b", Box([1, 1, 1]), Pose([0, 0, 0.5])))
    second = answer(beside)
    assert (second.state, second.neutral, second.free) == ("free", 3, 3)


def test_the_motion_opens_every_joint_between_bricks() -> None:
    """Motions away from their middle separate the bricks of a wall, by their exact gaps."""
    wall = scene("wall", size=(4, 5))
    second = answer(wall)
    assert second.motion is not None
    apart = Assembly(
        [
            Part(part.name, part.shape, Pose(part.pose.position + 1e-3 * move[:3]),
                 grounded=part.grounded)
            for part, move in zip(wall.parts, second.motion, strict=True)
        ]
    )  # fmt: skip
    contacts = kilter.contacts(apart)
    program = build_program(apart, contacts)
    assert len(program.part_a)
    assert np.abs(program.normal[:, :2]).max() < 1e-9
    assert kilter.check(apart).stable


def test_in_the_plane_each_part_slides_along_one_line() -> None:
    assembly = scene("tower")
    flat = Assembly(assembly.parts, planar=True)
    second = answer(flat)
    count = sum(not part.grounded for part in flat.parts)
    assert (second.state, second.neutral, second.free) == ("free", count, count)


def test_a_changed_number_is_refused() -> None:
    program, level = posed(wall_of(12))
    proof = find_level_rest(program, level, None)
    assert proof is not None
    assert judge_level_rest(program, level, proof) == ""
    for k in np.flatnonzero(level):
        forces = proof.forces.copy()
        forces[k] *= 1 + 1e-6
        assert judge_level_rest(program, level, LevelRest(forces, proof.motion))
    steep = int(np.flatnonzero(~level)[0])
    forces = proof.forces.copy()
    forces[steep] = 1e-3
    assert "not horizontal" in judge_level_rest(program, level, LevelRest(forces, proof.motion))
    for column, by in ((0, 2.0), (2, 0.5), (3, 0.5), (4, 0.5), (5, 0.5)):
        motion = proof.motion.copy()
        motion[3, column] += by  # past its neighbour, or not level
        assert judge_level_rest(program, level, LevelRest(proof.forces, motion))
    for bad in (np.nan, np.inf, -1.0):
        forces = proof.forces.copy()
        forces[int(np.flatnonzero(level)[0])] = bad
        assert judge_level_rest(program, level, LevelRest(forces, proof.motion))


@pytest.mark.slow
def test_no_solver_is_loaded_to_judge_it() -> None:
    program = (
        "import sys, kilter\n"
        "from kilter.scenes.walls import wall_of\n"
        "wall = wall_of(12)\n"
        "proof = kilter.check(wall).proof()\n"
        "import json; json.dump(proof, sys.stdout)"
    )
    made = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True)
    judge = (
        "import sys, json, kilter\n"
        "from kilter.scenes.walls import wall_of\n"
        "found = kilter.verify(wall_of(12), json.load(sys.stdin))\n"
        "assert found.holds, found.reasons\n"
        "assert 'second order: free' in found.notes\n"
        "assert not {'highspy', 'clarabel'} & set(sys.modules), 'a solver was loaded'"
    )
    subprocess.run([sys.executable, "-c", judge], input=made.stdout, check=True)


@pytest.mark.parametrize("foot", [1.0, 0.5, 0.02])
@pytest.mark.parametrize("far", [0.6e-9, 2e-9, 2e-8, 1e-7])
def test_far_corners_within_rounding_bear_nothing_that_is_over_an_edge(
    foot: float, far: float
) -> None:
    """A box with its centre over an edge of its support falls: it is no rest on faces."""
    for off in (0.0, 1e-4):
        low = Part("low", Box([foot, 2, 1]), Pose([-foot / 2, 0, 0.5]), grounded=True)
        high = Part("high", Box([4, 1, 1]), Pose([-off * foot, 0, 1.5]))
        program, level = posed(Assembly([low, high]))
        weight, share = float(program.weight[1]), max(far, off)
        away = program.point[:, 0] < -foot / 2
        forces = np.where(away, share, 1 - share) * weight / 2
        motion = np.zeros((2, 6))
        motion[1, 0] = 1.0
        holds = judge_level_rest(program, level, LevelRest(forces, motion)) == ""
        assert holds == (off > 0)
        assert (find_level_rest(program, level, None) is None) == (off == 0)


@pytest.mark.parametrize("seed", range(4))
def test_what_a_part_bears_is_made_good_below(seed: int) -> None:
    """Forces of a leaning stack, each balanced up to rounding only."""
    program, level = posed(stack(seed))
    proof = find_level_rest(program, level, None)
    assert proof is not None
    random = np.random.default_rng(seed)
    for size, holds in ((1e-10, True), (1e-7, False)):
        off = proof.forces * (1 + size * random.uniform(-1, 1, len(level)))
        assert (judge_level_rest(program, level, LevelRest(off, proof.motion)) == "") == holds
