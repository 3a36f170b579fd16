"""Parts at rest on level faces: as found, and the proof number by number."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, GivenContact, Part, Pose
from kilter.analysis.verdict.neutral import find_neutral
from kilter.arrays import Array
from kilter.mechanics.program import Program, build_program
from kilter.scenes import scene
from kilter.scenes.walls import wall_of
from kilter.second_order.answer.second_order_answer import SecondOrder
from kilter.second_order.parts.bearing import bearing_of, level_axes
from kilter.second_order.proofs import level_rest
from kilter.second_order.proofs.level_rest import (
    LevelRest,
    judge_level_rest,
    level_rows,
    rest_on_level,
    wrong_forces,
    wrong_motion,
)
from kilter.second_order.searches.level_rest_search import find_level_rest
from kilter.second_order.second_order_tolerances import ACROSS, BALANCED, DROPS

X, Y, Z = np.eye(3)
TILT = "its forces do not exclude a tilt of a part"
Point = tuple[str, str, Any, Any]
"""Part a, part b, the contact point, and the normal from a to b."""


def program_of(
    points: Sequence[Point], masses: Sequence[float], *, wide: float = 1.0, planar: bool = False
) -> Program:
    """Blocks "0", "1", ... on a base, all at the origin; only the points define the supports."""
    parts = [Part("base", Box(np.ones(3)), Pose([0, 0, -9]), grounded=True)]
    for k, mass in enumerate(masses):
        side = wide if k else 1.0
        parts.append(Part(str(k), Box([side, side, 1]), Pose([0, 0, 0]), mass=mass))
    given = [GivenContact((a, b), [at], n) for a, b, at, n in points]
    assembly = Assembly(parts, contacts=given, detect=False, planar=planar)
    return build_program(assembly, kilter.contacts(assembly)).frictionless


def on_feet(a: str, b: str, near: float, far: float, *, half: float = 0.4) -> list[Point]:
    """Two points at x = near, two at x = far, on both sides of y = 0."""
    return [(a, b, [x, y, 0.0], Z) for x in (near, far) for y in (half, -half)]


def stands(mass: float = 1.0, share: float = 0.5, *, foot: float = 1.0) -> tuple[Program, Array]:
    """A block whose far points carry a given share of its weight, with its forces."""
    program = program_of(on_feet("base", "0", foot * share, foot * (share - 1)), [mass])
    weight = float(program.weight[1])
    return program, np.repeat([(1 - share) * weight / 2, share * weight / 2], 2)


def shift(program: Program, by: Any = X) -> Array:
    """The motion of the first block."""
    motion = np.zeros((len(program.names), 6))
    motion[1, :3] = by
    return motion


def all_level(program: Program) -> np.ndarray:
    return np.ones(len(program.part_a), dtype=bool)


@pytest.mark.parametrize("mass", [1e-3, 1.0, 1e3])
def test_it_holds_as_it_is(mass: float) -> None:
    program, forces = stands(mass)
    proof = LevelRest(forces, shift(program))
    assert judge_level_rest(program, all_level(program), proof) == ""
    with pytest.raises(ValueError, match="read-only"):
        proof.forces[0] = 1.0


def test_numbers_are_of_the_parts_and_contacts() -> None:
    program, forces = stands()
    level, motion = all_level(program), shift(program)
    none = "its numbers do not match the parts and contacts"
    assert judge_level_rest(program, level, LevelRest(forces[:-1], motion)) == none
    assert judge_level_rest(program, level, LevelRest(forces, motion[:-1])) == none
    for bad in (np.nan, np.inf):
        for forged in (LevelRest(np.append(forces[:-1], bad), motion),
                       LevelRest(forces, shift(program, [1.0, bad, 0]))):  # fmt: skip
            assert judge_level_rest(program, level, forged) == "its numbers are not finite"


def test_no_force_pulls_and_what_is_not_level_carries_nothing() -> None:
    """A point that is listed twice could push as much as it pulls, and two walls could press."""
    program, forces = stands()
    twice = program.taking(np.append(np.arange(4), 0))
    pulls = np.append(forces, -1.0)
    pulls[0] += 1.0
    none = "a force acts at a face that is not horizontal"
    assert wrong_forces(twice, all_level(twice), pulls) == none
    assert wrong_forces(twice, all_level(twice), np.append(forces, 0.0)) == ""
    walls: list[Point] = [("base", "0", [0, 0, 0], sense * X) for sense in (1, -1)]
    between = program_of(on_feet("base", "0", 0.5, -0.5) + walls, [1.0])
    level = np.array([True] * 4 + [False] * 2)
    assert wrong_forces(between, level, np.append(forces, [0.0, 0.0])) == ""
    assert wrong_forces(between, level, np.append(forces, [1.0, 1.0])) == none


def test_forces_balance_to_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    program, forces = stands()
    for over, word in ((0.9, ""), (1.1, "its forces do not balance the load")):
        assert wrong_forces(program, all_level(program), forces * (1 + over * BALANCED)) == word
    monkeypatch.setattr(level_rest, "unbalanced", lambda *_: BALANCED)
    assert wrong_forces(program, all_level(program), forces) == ""


def test_what_carries_is_above_its_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """With far points that carry exactly the limit of a tenth, two points on a line are left."""
    program = program_of(on_feet("base", "0", 0.1, -1.0), [22 / 9.81])
    forces = np.array([10.0, 10.0, 1.0, 1.0])
    monkeypatch.setattr(level_rest, "CARRIES", 0.1)
    assert wrong_forces(program, all_level(program), forces) == TILT
    monkeypatch.setattr(level_rest, "CARRIES", 0.0999)
    assert wrong_forces(program, all_level(program), forces) == ""


def test_parts_do_not_bear_one_another_around() -> None:
    """Each of two blocks stands with half of its points on the other, and else on the ground."""
    points = on_feet("base", "0", 0.5, -0.5) + on_feet("base", "1", 0.5, -0.5)
    points += on_feet("0", "1", 0.5, -0.5) + on_feet("1", "0", 0.5, -0.5)
    program = program_of(points, [1.0, 1.0])
    forces = np.full(16, 9.81 / 4)
    around = "parts support each other in a ring"
    assert wrong_forces(program, all_level(program), forces) == around
    together = np.zeros(3, dtype=np.int64)
    assert rest_on_level(program, all_level(program), forces, together).tolist() == [False]
    forces[8:] = 0.0
    assert wrong_forces(program, all_level(program), forces) == ""
    assert rest_on_level(program, all_level(program), forces, together).tolist() == [True]


@pytest.mark.parametrize("mass", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(("share", "holds"), [(1e-7, True), (1e-8, False)])
def test_no_force_is_within_what_may_be_out_of_balance(
    mass: float, share: float, holds: bool
) -> None:
    """So it is beside a well-supported block. Both balance exactly."""
    program, forces = stands(mass, share)
    assert (wrong_forces(program, all_level(program), forces) == "") == holds
    beside = on_feet("base", "0", share, share - 1) + on_feet("base", "1", 0.5, -0.5)
    two = program_of(beside, [mass, mass])
    forces = np.append(forces, np.full(4, float(two.weight[2]) / 4))
    assert wrong_forces(two, all_level(two), forces) == ("" if holds else TILT)


@pytest.mark.parametrize("mass", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(("over", "holds"), [(1.1, True), (0.9, False)])
def test_points_that_bear_are_on_no_line(mass: float, over: float, holds: bool) -> None:
    """Two narrow pairs of points: the squared spread over the radius, times the share."""
    radius = np.sqrt(3) / 2
    trace = 1 + (0.4 / radius) ** 2
    half = over * radius * np.sqrt(1e-10 * trace)
    program = program_of(on_feet("base", "0", half, -half), [mass])
    forces = np.full(4, float(program.weight[1]) / 4)
    assert wrong_forces(program, all_level(program), forces) == ("" if holds else TILT)


@pytest.mark.parametrize("mass", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize(("lacks", "holds"), [(0.4, True), (0.6, False), (1.2, False)])
def test_what_a_wide_part_lacks_is_borne_by_the_narrow_one_below(
    mass: float, lacks: float, holds: bool
) -> None:
    """A slab of a hundred lengths on a post; the forces of both balance within tolerance.

    The exact correction takes the share `lacks` of the force of the far points of the post; if it
    takes more than all of it, slab and post tip.
    """
    slab, post = mass, mass * 1e-6
    wide = 140.0
    radius = float(np.sqrt(2 * 70**2 + 0.5**2))
    torque = 0.9 * BALANCED * radius  # over the weight of the slab
    share = torque / lacks
    points = on_feet("0", "1", 0.5, -0.5)
    near = share - torque  # of the centre, over the foot: where the far points bear what is left
    points += on_feet("base", "0", near, near - 1)
    program = program_of(points, [post, slab], wide=wide)
    load = float(program.weight[2])
    up = load / 4 * np.array([1 - torque * 2, 1 - torque * 2, 1 + torque * 2, 1 + torque * 2])
    own = float(program.weight[1])
    # of the post: its own weight and the slab's, which it is told to bear off its middle
    whole = own + load
    moment = load * torque  # towards the far points
    far = whole * near + moment
    down = np.repeat([(whole - far) / 2, far / 2], 2)
    forces = np.concatenate([up, down])
    assert level_rest.unbalanced(program, forces) == pytest.approx(0.9 * BALANCED, rel=1e-3)
    assert wrong_forces(program, all_level(program), forces) == ("" if holds else TILT)


def test_a_motion_is_a_level_shift_of_what_is_free() -> None:
    walls: list[Point] = [("base", "0", [0, 0, 0], X)]
    program = program_of(on_feet("base", "0", 0.5, -0.5) + walls, [1.0])
    level = np.array([True] * 4 + [False])
    assert wrong_motion(program, level, shift(program)) == ""
    held = shift(program)
    held[0, 1] = 1.0
    assert wrong_motion(program, level, held) == "its motion moves held parts"
    none = "its motion is not a horizontal shift of the parts"
    assert wrong_motion(program, level, np.zeros((2, 6))) == none
    turning = shift(program)
    turning[1, 5] = 1e-3
    assert wrong_motion(program, level, turning) == none


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("over", [0.9, 1.0, 1.1])
def test_a_motion_is_level_and_opens_to_the_limit(size: float, over: float) -> None:
    walls: list[Point] = [("base", "0", [0, 0, 0], X)]
    program = program_of(on_feet("base", "0", 0.5, -0.5) + walls, [1.0])
    level = np.array([True] * 4 + [False])
    up = shift(program, [size, 0, over * (ACROSS * size)])
    assert (wrong_motion(program, level, up) == "") == (over <= 1)
    along = shift(program, [over * (DROPS * size), size, 0])
    word = "" if over > 1 else "its motion does not open the other contacts"
    assert wrong_motion(program, level, along) == word


@pytest.mark.parametrize("lean", [0.5 * BALANCED, BALANCED])
def test_a_face_is_level_below_the_limit(lean: float) -> None:
    low = Part("low", Box([1, 1, 1]), Pose([0, 0, 0.5]), grounded=True)
    assembly = Assembly([low, Part("high", Box([1, 1, 1]), Pose([0, 0, 1.5]))])
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts).frictionless
    assert level_rows(program, contacts).all()
    program.normal.setflags(write=True)
    program.normal[:] = [lean, 0, 1]
    assert level_rows(program, contacts).all() == (lean < BALANCED)


def test_what_bears_what_is_counted_from_what_is_held() -> None:
    points = on_feet("base", "0", 0.5, -0.5) + on_feet("0", "1", 0.5, -0.5)
    points += on_feet("base", "2", 0.5, -0.5) + on_feet("1", "2", 0.5, -0.5)
    program = program_of(points, [1.0, 1.0, 1.0])
    bearing = bearing_of(program, all_level(program))
    assert bearing is not None
    assert bearing.depth.tolist() == [0, 1, 2, 3, 0]
    assert bearing.lower[:4].tolist() == [0] * 4
    assert bearing.upper[-4:].tolist() == [3] * 4


def test_a_ceiling_may_press_a_little() -> None:
    """The force of a block on a ceiling is no load: without this force it also stands."""
    roof: list[Point] = [("base", "0", [0, 0, 1], -Z)]
    program = program_of(on_feet("base", "0", 0.5, -0.5) + roof, [1.0])
    weight = float(program.weight[1])
    for press, word in ((0.1, ""), (0.9, ""), (1.1, TILT)):  # over the weight
        forces = np.append(np.full(4, (1 + press) * weight / 4), press * weight)
        assert wrong_forces(program, all_level(program), forces) == word


@pytest.mark.parametrize("side", [1.0, 10.0, 100.0])
def test_a_torque_is_borne_over_the_size_of_the_part(side: float) -> None:
    """A given torque about y moves the centre of the forces by the torque over the weight."""
    program = program_of(on_feet("base", "1", 0.5, -0.5) + on_feet("base", "0", 0.5, -0.5),
                         [1.0, 1.0], wide=side)  # fmt: skip
    weight = float(program.weight[2])
    applied = np.zeros((3, 6))
    applied[2, 4] = 0.3 * weight
    program = replace(program, applied=applied)
    forces = weight / 4 * np.repeat([1 + 0.6, 1 - 0.6, 1, 1], 2)
    assert wrong_forces(program, all_level(program), forces) == ""
    other = weight / 4 * np.repeat([1 - 0.6, 1 + 0.6, 1, 1], 2)
    none = "its forces do not balance the load"
    assert wrong_forces(program, all_level(program), other) == none


def test_in_the_plane_what_is_level_is_across_gravity() -> None:
    program = program_of(on_feet("base", "0", 0.5, -0.5), [1.0], planar=True)
    leaning = replace(program, gravity=np.array([0.6, 0, -0.8]))
    np.testing.assert_allclose(np.abs(level_axes(leaning)), [[0.8, 0, 0.6]], atol=1e-15)


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


@pytest.mark.quick(1)
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
