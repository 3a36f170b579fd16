"""Contacts at edges and corners, flush faces, and planes between parts."""

import copy
import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import kilter
from kilter import Assembly, Box, ContactSet, Cylinder, Part, Pose, Prism, Sphere
from kilter.mechanics.program import Program, build_program
from kilter.mechanics.proof import digest_of
from kilter.mechanics.rows import CONTACT, POSSIBLE
from kilter.second_order.gaps.features_of import features_of
from kilter.second_order.gaps.stationary import problem_of
from kilter.second_order.motions.free_motions import scaled_columns
from kilter.second_order.motions.sharp_points import (
    SharpPoints,
    opens_points,
    sharp_points,
    with_sharp,
)
from kilter.second_order.parts.separation import least_separation
from kilter.second_order.proofs.minimum_proof import by_part, named_motion
from kilter.second_order.proofs.paths import judge_path
from kilter.second_order.searches.level_rest_search import enough_to_open
from kilter.second_order.searches.path_search import find_path

FLOOR = Part("floor", Box([40, 40, 1]), Pose([0, 0, -0.5]), grounded=True)


def boxes(nx: int, ny: int, nz: int, *, apart: float = 0.0) -> list[Part]:
    """Unit boxes in columns and rows at a distance `apart`."""
    return [
        Part(f"{i}-{j}-{k}", Box([1, 1, 1]), Pose([i * (1 + apart), j * (1 + apart), k + 0.5]))
        for k in range(nz)
        for i in range(nx)
        for j in range(ny)
    ]


def tray(nx: int, ny: int, nz: int) -> list[Part]:
    """Four walls around such boxes."""
    at = (nx - 1) / 2, (ny - 1) / 2
    sides = [((-1, at[1]), (1, ny)), ((nx, at[1]), (1, ny)), ((at[0], -1), (nx, 1)),
             ((at[0], ny), (nx, 1))]  # fmt: skip
    return [
        Part(f"wall {k}", Box([*size, nz]), Pose([*where, nz / 2]), grounded=True)
        for k, (where, size) in enumerate(sides)
    ]


@pytest.mark.parametrize("count", [(2, 2, 1), (2, 2, 2), (3, 1, 3), (3, 3, 3), (5, 4, 3)])
@pytest.mark.slow
def test_a_pallet_of_boxes_is_as_free_as_columns_that_stand_apart(count):
    """Each box slides and turns: three motions for each box, flush or not."""
    found = kilter.check(Assembly([FLOOR, *boxes(*count)]))
    second = found.second_order_answer
    alone = kilter.check(Assembly([FLOOR, *boxes(*count, apart=0.25)])).second_order_answer
    assert second is not None
    assert alone is not None
    free = 3 * int(np.prod(count))
    assert (second.state, second.neutral, second.free) == ("free", free, free)
    assert (alone.state, alone.neutral, alone.free) == ("free", free, free)
    assert kilter.verify(found.assembly, found.proof()).holds


@pytest.mark.parametrize("count", [(2, 2, 1), (3, 3, 1), (2, 2, 2), (5, 5, 2)])
def test_in_a_tray_that_they_fill_nothing_moves(count):
    held = kilter.check(Assembly([FLOOR, *tray(*count), *boxes(*count)]))
    assert held.second_order_answer is None
    assert kilter.verify(held.assembly, held.proof()).holds


@pytest.mark.quick(2)
@pytest.mark.parametrize("count", [(2, 2, 1), (3, 3, 1), (2, 2, 2), (3, 1, 1)])
@pytest.mark.parametrize(("gone", "each"), [([1], 1), ([0, 1], 1), ([2], 1), ([1, 3], 3)])
def test_without_a_wall_they_slide_towards_it(count, gone, each):
    """Along x or y; without two adjacent walls each box slides on its own."""
    walls = [wall for k, wall in enumerate(tray(*count)) if k not in gone]
    found = kilter.check(Assembly([FLOOR, *walls, *boxes(*count)]))
    second = found.second_order_answer
    assert second is not None
    free = each * int(np.prod(count))
    assert (second.state, second.neutral, second.free) == ("free", free, free)
    assert kilter.verify(found.assembly, found.proof()).holds


def diagonal() -> Assembly:
    """Two boxes on a floor that touch by an edge each, at x = y = 0."""
    one = Part("a", Box([1, 1, 1]), Pose([-0.5, -0.5, 0.5]))
    return Assembly([FLOOR, one, Part("b", Box([1, 1, 1]), Pose([0.5, 0.5, 0.5]))])


def damaged(proof: dict[str, Any], **changes: Any) -> dict[str, Any]:
    other = copy.deepcopy(proof)
    other["second_order"].update(changes)
    other["digest"] = digest_of(other)
    return other


@pytest.mark.parametrize(
    ("b", "holds"),
    [
        ([1, 1, 0], True), ([1, 0, 0], True), ([0, 1, 0], True), ([1, -1, 0], True),
        ([0, 0, 0], False), ([-1, 0, 0], False), ([-1, -1, 0], False), ([0, -1, 0], False),
    ],
)  # fmt: skip
def test_a_motion_opens_one_of_the_normals(b, holds):
    """A motion opens x or y; without either it opens none."""
    assembly = diagonal()
    proof = kilter.check(assembly).proof()
    assert kilter.verify(assembly, proof).holds
    motion = {"a": [0.0] * 6, "b": [*(1e-3 * np.array(b, float)), 0, 0, 0]}
    checked = kilter.verify(assembly, damaged(proof, motion=motion))
    assert checked.holds == holds


def test_no_force_of_a_proof_is_theirs():
    assembly = diagonal()
    proof = kilter.check(assembly).proof()
    forces = list(proof["second_order"]["level"])
    assert forces[8:] == [0.0] * 4
    forces[8] = 1e-12
    assert not kilter.verify(assembly, damaged(proof, level=forces)).holds
    assert not kilter.verify(assembly, damaged(proof, level=forces[:8])).holds
    full = Assembly([FLOOR, *tray(2, 2, 1), *boxes(2, 2, 1)])
    contacts = kilter.contacts(full)
    program = build_program(full, contacts).frictionless
    count = len(with_sharp(program, contacts).kind)
    assert count > len(program.kind)
    own = kilter.check(full).proof()
    for said in (np.ones(count), np.ones(len(program.kind))):
        entry = {"state": "minimum", "neutral": 0, "free": 0, "held": said.tolist()}
        own["second_order"] = entry
        own["digest"] = digest_of(own)
        assert not kilter.verify(full, own).holds


def program_of(assembly: Assembly) -> tuple[Program, ContactSet]:
    contacts = kilter.contacts(assembly)
    return with_sharp(build_program(assembly, contacts).frictionless, contacts), contacts


def test_points_that_are_so_by_and_large_are_opened_along_every_normal():
    program, contacts = program_of(diagonal())
    points = sharp_points(program, contacts)
    assert (points.pair[program.kind == CONTACT] == -1).all()
    own = program.kind == POSSIBLE
    assert len(set(points.pair[own].tolist())) == 1
    assert len(set(points.along[own].tolist())) == 2
    contacts.degenerate.exact.setflags(write=True)
    contacts.degenerate.exact[0] = False
    other = sharp_points(program, contacts)
    assert (other.pair[own] >= 0).sum() == (other.along[own] >= 0).sum() == 2
    contacts.degenerate.exact[:] = False
    assert (sharp_points(program, contacts).pair == -1).all()


def test_what_one_normal_opens_at_all_points_of_a_pair_is_opened():
    points = SharpPoints(
        pair=np.array([-1, -1, 0, 0, 0, 0, 0, 1, 1]),
        along=np.array([-1, -1, 0, 1, 0, 1, -1, 2, 3]),
    )
    with pytest.raises(ValueError, match="read-only"):
        points.pair[0] = 1
    opens = np.array([True, False, True, False, False, True, True, False, False])
    assert points.opened(opens).tolist() == opens.tolist()
    opens[3] = True
    assert points.opened(opens).tolist() == [1, 0, 1, 1, 1, 1, 1, 0, 0]
    opens[:] = False
    assert not points.opened(opens).any()
    opens[8] = True
    assert points.opened(opens).tolist() == [0, 0, 0, 0, 0, 0, 0, 1, 1]


def test_a_normal_counts_for_a_pair_where_each_of_its_points_has_it():
    """Corners on corners, edges on edges, and boxes that meet two others in this way."""
    off = Part("off", Box([1, 1, 1]), Pose([-0.5, 1.5, 2.5]))
    program, contacts = program_of(Assembly([FLOOR, *boxes(2, 2, 2), off]))
    rows = np.flatnonzero(program.kind == POSSIBLE)
    normal = program.normal.copy()
    normal[rows[0]] = [0.6, 0, 0.8]  # at one of its points a pair has another normal
    program = program.with_rows(normal=normal)
    points = sharp_points(program, contacts)
    point = np.full(len(program.kind), -1)
    point[rows] = contacts.possible.degenerate[program.source[rows]]
    by_pair: dict[frozenset[int], list[int]] = {}
    for row in rows.tolist():
        by_pair.setdefault(frozenset((program.part_a[row], program.part_b[row])), []).append(row)
    assert len(by_pair) == len(set(points.pair[rows].tolist()))
    kinds = set()
    for own in by_pair.values():
        assert len(set(points.pair[own].tolist())) == 1
        every = set(point[own].tolist())
        for row in own:
            alike = [k for k in own if np.allclose(program.normal[k], program.normal[row])]
            everywhere = set(point[alike].tolist()) == every
            assert (points.along[row] >= 0) == everywhere
            assert len(set(points.along[alike].tolist())) == 1
            kinds.add(everywhere)
    assert kinds == {True, False}
    counted = points.along[rows][points.along[rows] >= 0]
    normals = {(p, *np.round(n, 6)) for p, n, k in
               zip(points.pair[rows], program.normal[rows], points.along[rows], strict=True)
               if k >= 0}  # fmt: skip
    assert len(set(counted.tolist())) == len(normals)


def test_one_normal_of_each_pair_is_chosen():
    """A pair with three normals, a pair with a single normal, and rows without a common normal."""
    points = SharpPoints(
        pair=np.array([-1, 5, 5, 5, 5, 7, 8]),
        along=np.array([-1, 0, 1, 2, 0, 3, -1]),
    )
    every = np.ones(7, dtype=bool)
    chosen = [np.flatnonzero(rows).tolist() for rows in enough_to_open(points, every)]
    assert chosen == [[0, 1, 4, 5, 6], [0, 2, 5, 6], [0, 3, 5, 6]]
    some = every.copy()
    some[[0, 1, 3]] = False
    chosen = [np.flatnonzero(rows).tolist() for rows in enough_to_open(points, some)]
    assert chosen == [[4, 5, 6], [2, 5, 6]]
    assert [rows.any() for rows in enough_to_open(points, ~every)] == [False]


def test_a_box_between_two_corners_goes_between_them():
    """A motion away from both does not exist; a motion to a side of each does."""
    held = [
        Part(name, Box([1, 1, 1]), Pose([x, y, 0.5]), grounded=True)
        for name, x, y in (("a", 1, 1), ("b", -1, -1))
    ]
    assembly = Assembly([FLOOR, *held, Part("c", Box([1, 1, 1]), Pose([0, 0, 0.5]))])
    found = kilter.check(assembly)
    assert found.second_order_answer is not None
    assert (found.second_order_answer.state, found.second_order_answer.free) == ("free", 3)
    assert found.second_order_answer.motion is not None
    x, y = found.second_order_answer.motion[3, :2]
    assert x * y < 0
    assert kilter.verify(assembly, found.proof()).holds


def over_an_edge(*, beside: bool = True) -> list[Part]:
    """A board with its centre over the edge of a post, which meets another post with edges."""
    post = Part("post", Box([1, 2, 2]), Pose([0.5, 0, 1]))
    board = Part("board", Box([2, 2, 0.5]), Pose([1, 0, 2.25]))
    other = Part("other", Box([0.5, 1, 2]), Pose([0.75, -1.5, 1]))
    return [FLOOR, post, board, *([other] if beside else [])]


@pytest.mark.quick(1)
@pytest.mark.parametrize("opens_at_once", [True, False])
@pytest.mark.slow
def test_a_path_that_parts_them_later_is_refused(opens_at_once):
    """The board tips, while the other post moves along, or separates only to second order."""
    assembly = Assembly(over_an_edge())
    contacts = kilter.contacts(assembly)
    program = build_program(assembly, contacts).frictionless
    problem = problem_of(program, features_of(program, contacts))
    assert problem.scale is not None
    motion = np.zeros((1, 4, 6))
    motion[0, 2, [0, 4]] = 0.25, 1.0  # about the edge of the post
    tips = scaled_columns(program, problem, motion)[:, 0]
    motion[:] = 0.0
    motion[0, 3, 1] = -1.0
    away = scaled_columns(program, problem, motion)[:, 0]
    path = find_path(problem, tips + 0.5 * away if opens_at_once else tips)
    assert path is not None
    second = path.second if opens_at_once else path.second + away
    assert judge_path(problem, path.first, second).falls
    step = 0.002
    place = program.full((step * path.first + step**2 / 2 * second) * problem.scale)
    forged = damaged(
        kilter.check(assembly).proof(),
        first=by_part(program, problem, path.first),
        second=by_part(program, problem, second),
        configuration=named_motion(program, place),
    )
    checked = kilter.verify(assembly, forged)
    assert checked.holds == opens_at_once, checked.reasons
    if not opens_at_once:
        assert [*checked.reasons] == [
            "its second order: its path does not open edges and corners without a unique normal"
        ]


@pytest.mark.parametrize(
    ("away", "holds"),
    [([0, -1, 0], True), ([0, 1, 0], False), ([1, 0, 0], False), ([0, 0, 0], False)],
)
def test_the_post_goes_away_from_the_edge_of_the_board(away, holds):
    program, contacts = program_of(Assembly(over_an_edge()))
    motion = np.zeros((4, 6))
    motion[3, :3] = away
    assert opens_points(program, contacts, motion) == holds


def test_rows_are_of_such_points_of_what_moves():
    """Rims and held parts have no such rows; each free edge has two ends."""
    can = Part("can", Cylinder(0.5, 1), Pose([5, 5, 0.5]))
    at = {"a": [-0.5, -0.5], "b": [0.5, 0.5], "c": [1.5, -0.5], "d": [2.5, 0.5]}
    for held, ends in (("", 6), ("a", 6), ("ab", 4), ("ad", 6), ("abc", 2), ("abcd", 0)):
        boxes = [
            Part(k, Box([1, 1, 1]), Pose([*where, 0.5]), grounded=k in held)
            for k, where in at.items()
        ]
        assembly = Assembly([FLOOR, can, *boxes])
        contacts = kilter.contacts(assembly)
        program = build_program(assembly, contacts).frictionless
        assert (contacts.possible.degenerate < 0).any()
        assert len(with_sharp(program, contacts).kind) == len(program.kind) + 2 * ends


Build = Callable[..., list[Part]]
WIDTHS = (0.9, 1.0, 1.1)
"""Widths of the upper part, over that of the lower part [-]."""


def box_over_the_edge(width: float, off: float = 0.0) -> list[Part]:
    """A box with its centre at a given distance from the edge of the box below."""
    low = Part("low", Box([1, 1, 1]), Pose([0, 0, 0.5]), grounded=True)
    return [low, Part("high", Box([1, width, 1]), Pose([0.5 + off, 0, 1.5]))]


def leaning(width: float, off: float = 0.0) -> list[Part]:
    """A leaning block with its centre at a given distance from its own lower edge."""
    low = Part("low", Box([4, 1, 1]), Pose([0, 0, -0.5]), grounded=True)
    lean = Prism([(-1, 0), (0, 0), (1 + 2 * off, 1), (2 * off, 1)], width)
    return [low, Part("high", lean, Pose([0, 0, 0]))]


@pytest.mark.quick(3)
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("build", [box_over_the_edge, leaning])
@pytest.mark.parametrize("off", [1e-6, -1e-6])
def test_within_the_edge_it_slides_and_beyond_it_falls(build, width, off):
    for order in itertools.permutations(build(width, off)):
        verdict = kilter.check(Assembly(order))
        assert verdict.stable == (off < 0)
        second = verdict.second_order_answer
        assert off > 0 or (second is not None and second.state == "free")


WALLS = [
    Part("left", Box([1, 10, 10]), Pose([-1, 0, 5]), grounded=True),
    Part("right", Box([1, 10, 10]), Pose([1, 0, 5]), grounded=True),
]
ENDS = [
    Part("behind", Box([1, 1, 10]), Pose([0, -1, 5]), grounded=True),
    Part("before", Box([1, 1, 10]), Pose([0, 1, 5]), grounded=True),
]
FLOOR_PLANES = Part("floor", Box([10, 10, 1]), Pose([0, 0, -0.5]), grounded=True)
BALLS = [Part(f"ball {k}", Sphere(0.5), Pose([0, 0, 0.5 + k])) for k in range(2)]


@pytest.mark.slow
def test_balls_upright_between_two_walls_fall_along_them():
    assembly = Assembly([FLOOR_PLANES, *WALLS, *BALLS])
    found = kilter.check(assembly)
    second = found.second_order_answer
    assert second is not None
    assert second.state == "balanced"
    proof = found.proof()
    assert kilter.verify(assembly, proof).holds
    across = second.configuration
    assert across is not None
    assert np.abs(across.motion[4:, 0]).max() < 1e-15
    for axis, by in ((0, 1e-9), (0, -1e-9), (1, 1e-9)):  # into a wall, or off the path
        other = copy.deepcopy(proof)
        other["second_order"]["configuration"]["ball 1"][axis] += by
        other["digest"] = digest_of(other)
        assert not kilter.verify(assembly, other).holds, (axis, by)


@pytest.mark.slow
def test_balls_upright_in_a_square_tube_stay():
    assembly = Assembly([FLOOR_PLANES, *WALLS, *ENDS, *BALLS])
    found = kilter.check(assembly)
    second = found.second_order_answer
    assert second is not None
    assert (second.state, second.neutral, second.free) == ("minimum", 6, 6)
    assert kilter.verify(assembly, found.proof()).holds


@pytest.mark.parametrize(("shift", "apart"), [(0.0, 0.1), (1e-10, None), (-1e-10, None)])
def test_only_what_shifts_along_a_plane_counts_as_parted_by_it(shift, apart):
    assembly = Assembly([FLOOR_PLANES, *WALLS, BALLS[0]])
    program = build_program(assembly, kilter.contacts(assembly))
    motion = np.zeros((4, 6))
    motion[3, :3] = [shift, 0.3, 0.2]
    every = np.ones(len(program.normal), dtype=bool)
    found = least_separation(assembly, program, motion, beyond=0.1, planes=every)
    assert found == (pytest.approx(-1e-10, rel=1e-4) if apart is None else apart)
    without = least_separation(assembly, program, motion, beyond=0.1)
    assert without is not None
    assert without <= 0
