"""Ways of parts: swept, locked, and of several parts as one."""

import dataclasses

import numpy as np
import pytest
import shapely
from interlocked import hooked
from moved_solids import deepest, places_along, skin
from random_turned import random_turned
from read_proofs import proof_of, reasons
from scipy.optimize import linprog

import kilter
from kilter import Assembly, Box, InputError, Order, Part, Pose, states
from kilter.analysis.planning.order.locking import multipliers_of, opening, shuts
from kilter.analysis.planning.order.removal import Removal
from kilter.analysis.planning.order.search import blocked_together, units_of_groups
from kilter.analysis.planning.order.sweeps import Sweeps, _are_separated
from kilter.analysis.planning.states.holds import bits_of
from kilter.contact.common.distances import PartSolids
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block, floor, turned_parts


def sampled(
    solids: PartSolids, p: int, q: int, along: np.ndarray, count: int, enough: float
) -> float:
    """The greatest volume shared on the way until the parts are past each other."""
    low, high = solids.geometry.part_boxes
    reach = float(np.linalg.norm(np.maximum(high[p], high[q]) - np.minimum(low[p], low[q])))
    places = np.linspace(0.0, 2 * reach, count)[:, None] * along
    return deepest(solids, p, q, places, enough=enough)


def under_a_lip() -> Assembly:
    """A block under a lip: it comes out along x, then up."""
    walls = {"wall": [-0.5, 0.5, 1], "stop": [2.5, 0.5, 1]}
    sides = {"side": [1, -0.5, 1], "other": [1, 1.5, 1]}
    return Assembly(
        [
            floor([-3, -3], [5, 5]),
            Part("lip", Box([1, 3, 1]), Pose([0.5, 0.5, 1.5]), grounded=True),
            *(Part(k, Box([1, 3, 2]), Pose(at), grounded=True) for k, at in walls.items()),
            *(Part(k, Box([4, 1, 2]), Pose(at), grounded=True) for k, at in sides.items()),
            block("inside", [0, 0, 0], [1, 1, 1]),
        ]
    )


def held_against_samples(
    assembly: Assembly, seed: int, tries: int, count: int, *, blocked_only: bool = False
) -> list[bool]:
    contacts = kilter.contacts(assembly)
    sweeps, solids = Sweeps(contacts), PartSolids(assembly.geometry)
    random, answers = np.random.default_rng(seed), []
    size, grounded = assembly.geometry.size, assembly.geometry.grounded
    normals = np.vstack([contacts.patch_normal, -contacts.patch_normal, np.eye(3), -np.eye(3)])
    for _ in range(tries):
        p = int(random.choice(np.flatnonzero(~grounded)))
        q = int(random.choice([k for k in range(len(size)) if k != p]))
        d = (
            normals[random.integers(len(normals))]
            if random.random() < 0.7
            else random.normal(size=3)
        )
        d = d / np.linalg.norm(d)
        x, y, z = (float(one) for one in d)
        stopped = sweeps.pair_stops(p, q, (x, y, z))
        tolerance = sweeps.tolerance(p, q)
        least = min(size[p], size[q])
        if stopped:  # somewhere on the way it enters by more than rounding, maybe for a moment
            enough = tolerance**3
            volume = sampled(solids, p, q, d, count, enough)
            if volume <= enough:
                volume = sampled(solids, p, q, d, 40 * count, enough)
            assert volume > enough, (p, q, d)
        elif not blocked_only:  # nowhere does it enter by more than a skin of the tolerance
            assert sampled(solids, p, q, d, count, np.inf) <= skin(least, tolerance), (p, q, d)
        answers.append(stopped)
    return answers


@pytest.mark.slow
def test_paths_against_parts_moved_step_by_step():
    answers = []
    for k, assembly in enumerate(
        [scene("paper-figure-9"), arch(9, ratio=0.3), random_turned("pile", 1), scene("pit-wedges")]
    ):
        answers += held_against_samples(assembly, k, 25, 60)
    assert min(answers.count(True), answers.count(False)) > 15


def entered(order: Order, count: int) -> list[str]:
    """Steps whose parts, at so many places of their way, enter what stands beyond the tolerance.

    Of drawn cylinders, whose tolerance is wide, never by a hundredth of the smaller part either.
    """
    assembly = order.states.assembly
    sweeps, solids = Sweeps(order.states.contacts), PartSolids(assembly.geometry)
    size, found = assembly.geometry.size, []
    standing = {part.name for part in assembly if part.grounded}
    for step in order.steps:
        places = places_along(step.path, count)
        for moved in map(assembly.index_of, step.parts):
            for other in map(assembly.index_of, sorted(standing - {step.over})):
                small = min(solids.of(moved).volume(), solids.of(other).volume())
                within = skin(min(size[moved], size[other]), sweeps.tolerance(moved, other))
                most = min(within, small / 100)
                if deepest(solids, moved, other, places, enough=most) > most:
                    found.append(f"{assembly.names[moved]} into {assembly.names[other]}")
        standing.update(step.parts)
    return found


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["tower", "paper-figure-9", "pit-wedges", "arch", "two pieces"])
def test_every_place_of_every_way_of_a_plan_is_free(name):
    made = {
        "arch": lambda: arch(9, ratio=0.3, friction=0.6),
        "two pieces": under_a_lip,
    }.get(name, lambda: scene(name))()
    order = kilter.plan(made)
    assert order.found
    assert entered(order, 500) == []
    if name == "two pieces":  # past the corner that its way turns round, it would hit the lip
        [step] = order.steps
        path = step.path[:-1] - step.path[-2]  # the same way, without its last turn
        cut = dataclasses.replace(step, legs=step.legs[1:], path=path)
        assert entered(dataclasses.replace(order, steps=(cut,)), 500) == ["inside into lip"]


@pytest.mark.parametrize("gap", [-2e-5, 0.0, 2e-5])
def test_sliding_along_a_face_is_free_within_the_tolerance(gap):
    """Unit cubes side by side: 1e-5 of a size, or twice as deep as they are drawn."""
    beside = Part("b", Box([1, 1, 1]), Pose([1.5 + gap, 0.5, 0.5]))
    pair = Assembly([block("a", [0, 0, 0], [1, 1, 1]), beside])
    sweeps = Sweeps(kilter.contacts(pair))
    assert sweeps.tolerance(0, 1) == pytest.approx(max(1e-5 * np.sqrt(3), -2 * gap), rel=1e-6)
    assert not sweeps.pair_stops(0, 1, (0.0, 0.0, 1.0))
    assert sweeps.pair_stops(0, 1, (1.0, 0.0, 0.0))
    assert not sweeps.pair_stops(0, 1, (-1.0, 0.0, 0.0))


@pytest.mark.parametrize(("shift", "stops"), [(0.999, True), (0.9999999, False), (1.001, False)])
def test_an_overlap_counts_where_it_is_wider_than_the_tolerance(shift, stops):
    pair = Assembly(
        [block("a", [0, 0, 0], [1, 1, 1]), block("b", [shift, 0, 3], [shift + 1, 1, 4])]
    )
    assert Sweeps(kilter.contacts(pair)).pair_stops(0, 1, (0.0, 0.0, 1.0)) == stops


@pytest.mark.parametrize(("distance", "stops"), [(1.999, False), (2.001, True), (np.inf, True)])
def test_a_path_ends_where_it_ends(distance, stops):
    pair = Assembly([block("a", [0, 0, 0], [1, 1, 1]), block("b", [0, 0, 3], [1, 1, 4])])
    sweeps = Sweeps(kilter.contacts(pair))
    assert sweeps.pair_stops(0, 1, (0.0, 0.0, 1.0), distance=distance) == stops
    aside = np.array([1.5, 0.0, 0.0])
    assert not sweeps.pair_stops(0, 1, (0.0, 0.0, 1.0), distance=distance, start=aside)


def boxed(*, above: float = 1.0) -> Assembly:
    """A cube in a box whose lid is at a height."""
    walls = [
        block("west", [-1, -1, -1], [0, 2, 2]), block("east", [1, -1, -1], [2, 2, 2]),
        block("south", [0, -1, -1], [1, 0, 2]), block("north", [0, 1, -1], [1, 2, 2]),
        block("below", [0, 0, -1], [1, 1, 0]), block("above", [0, 0, above], [1, 1, 2]),
    ]  # fmt: skip
    held = [Part(p.name, p.shape, p.pose, grounded=True) for p in walls]
    return Assembly([*held, block("inside", [0, 0, 0], [1, 1, 1])])


@pytest.mark.parametrize("name", ["closed-frame", "boxed"])
def test_a_closed_box_locks(name):
    made = boxed() if name == "boxed" else scene(name)
    order = kilter.plan(made)
    assert (order.verdict, order.found) == ("impossible", False)
    answer = order.to_dict()
    assert answer["impossible"] == {
        "kind": "locking", "holds": None, "parts": [made.names[-1]], "motions": None
    }  # fmt: skip
    assert "cannot move" in answer["sentence"]
    assert not reasons(order, proof_of(order))


def test_a_lid_a_little_off_locks_nothing():
    order = kilter.plan(boxed(above=1.01))
    assert (order.verdict, order.locked) == ("none-found", ())


@pytest.mark.parametrize("change", ["zero", "fewer", "other"])
def test_other_multipliers_are_refused(change):
    order = kilter.plan(boxed())
    proof = proof_of(order)
    [entry] = proof["proofs"]
    values = entry["multipliers"]
    entry["multipliers"] = {
        "zero": [0.0 if k < 4 else one for k, one in enumerate(values)],
        "fewer": values[:-1],
        "other": [2.0 * values[0], *values[1:]],
    }[change]
    assert "the multipliers do not prove that" in reasons(order, proof)


def test_locked_wherever_it_is():
    moved = turned_parts(list(boxed()), [0.8, 0.36, -0.48, 0.0])
    assert kilter.plan(Assembly(moved)).verdict == "impossible"


@pytest.mark.slow
def test_multipliers_exist_where_no_motion_opens():
    """Against linear programs that seek a motion, on random rows."""
    random = np.random.default_rng(7)
    seen = set()
    for _ in range(60):
        rows = random.normal(size=(int(random.integers(7, 20)), 6))
        sides = np.zeros(len(rows))
        found = linprog(-rows.sum(axis=0), A_ub=-rows, b_ub=sides, bounds=[(-1, 1)] * 6)
        moves = found.fun < -1e-9
        seen.add(moves)
        multipliers = multipliers_of(rows)
        assert (multipliers is None) == moves
        if multipliers is not None:
            assert shuts(rows, multipliers)
            other = multipliers.copy()
            other[0] *= 2
            assert not shuts(rows, other)
    assert seen == {True, False}


def test_a_flat_cone_of_normals_locks_within_its_angle():
    """Rows that let y slip out but for a lean: they lock while the lean shows, in closed form."""
    axes = np.vstack([np.eye(6)[1:], -np.eye(6)[1:]])
    for lean, locks in ((1e-1, True), (1e-3, True), (1e-5, False), (0.0, False)):
        pair = np.array([[lean, 1, 0, 0, 0, 0], [-lean, 1, 0, 0, 0, 0]])
        assert (multipliers_of(np.vstack([axes, pair, -pair])) is not None) == locks


def test_rows_open_as_a_part_moves_away():
    made = states(boxed())
    program = made.of().program
    part = len(made.assembly) - 1
    rows = opening(program, part, np.ones(len(program.part_a), dtype=bool))
    away = program.normal * np.where(program.part_b == part, 1, -1)[:, None]
    assert np.allclose(rows[:, :3], away)


def rechecked(order: Order) -> None:
    assert not reasons(order, proof_of(order))


@pytest.mark.slow
def test_two_that_leave_only_as_one():
    made = hooked()
    alone = kilter.plan(made)
    assert alone.verdict == "impossible"
    order = kilter.plan(made, kilter.PlanRules(together=True))
    [step] = order.steps
    assert (step.parts, step.direction) == (("A", "B"), (0.0, -1.0, 0.0))
    assert order.to_dict()["steps"][0]["parts"] == ["A", "B"]
    rechecked(order)


@pytest.mark.slow
def test_with_the_ledges_off_each_leaves_alone():
    """Then nothing has to move as one, and nothing does."""
    order = kilter.plan(hooked(lid=False), kilter.PlanRules(together=True))
    assert sorted(step.parts for step in order.steps) == [("A",), ("B",)]


def test_sets_that_stop_one_another():
    """One least set along +y; upwards the ledges stop all."""
    made = hooked()
    contacts = kilter.contacts(made)
    units, base = units_of_groups(made, ()), bits_of(made.geometry.grounded)
    everything = bits_of(np.ones(len(made), dtype=bool))

    def found(direction: list[int]) -> list[int]:
        removal = Removal(contacts, directions=[direction])
        return [moved for moved, _ in blocked_together(removal, units, everything, base)]

    assert found([0, 1, 0]) == [sum(units)]
    assert found([0, 0, 1]) == found([0, -1, 0]) == found([1, 0, 0]) == []


def test_a_group_goes_in_as_one():
    order = kilter.plan(scene("tower"), kilter.PlanRules(groups=["cube-[23]"]))
    assert [step.parts for step in order.steps] == [
        ("cube-1",), ("cube-2", "cube-3"), ("cube-4",), ("cube-5",)
    ]  # fmt: skip
    assert order.steps[1].touches == ("cube-1",)
    rechecked(order)


def test_a_group_that_spans_a_part_cannot_close_round_it():
    """Cubes below and above one that is not of the group: no way for it, none for them."""
    order = kilter.plan(
        scene("tower"), kilter.PlanRules(groups=[["cube-2", "cube-4"]], directions=[[0, 0, 1]])
    )
    assert order.verdict == "none-found"


def test_groups_that_make_no_sense():
    tower = scene("tower")
    for groups, why in (
        (["nobody*"], "no part is named"),
        ([()], "a group names no part"),
        (["cube-[12]", "cube-[23]"], "'cube-2' is in two groups"),
        (["*"], "held from the start"),
    ):
        with pytest.raises(InputError, match=why):
            kilter.plan(tower, kilter.PlanRules(groups=groups))


def key_at_the_mouth() -> Assembly:
    """A slab on a bed, under a ledge on each side; a key stands before it, behind a sill."""
    walls = [
        block("west", [-1, 0, 0], [0, 5, 3]), block("east", [4, 0, 0], [5, 5, 3]),
        block("back", [-1, -1, 0], [5, 0, 3]), block("sill", [-1, 5, 0], [5, 6, 1]),
        block("ledge-w", [0, 0, 2], [1, 4, 3]), block("ledge-e", [3, 0, 2], [4, 4, 3]),
        block("bed", [0, 0, 0], [4, 4, 1]),
    ]  # fmt: skip
    return Assembly(
        [
            floor([-3, -3], [8, 8]),
            *(Part(p.name, p.shape, p.pose, grounded=True) for p in walls),
            block("slab", [0, 0, 1], [4, 4, 2]),
            block("key", [0, 4, 0], [4, 5, 2]),
        ]
    )


def test_the_key_leaves_first_and_upwards():
    order = kilter.plan(key_at_the_mouth())
    assert [(step.part, step.legs[0].direction) for step in order.steps] == [
        ("slab", (0.0, 1.0, 0.0)),
        ("key", (0.0, 0.0, 1.0)),
    ]
    rechecked(order)


def test_triangles_on_either_side_of_a_side_share_no_area():
    rng = np.random.default_rng(8)
    first, second = rng.random((2, 400, 3, 2)) + rng.random((2, 400, 1, 2))
    separated = _are_separated(first, second) | _are_separated(second, first)
    shared = shapely.area(shapely.intersection(shapely.polygons(first), shapely.polygons(second)))
    assert 50 < separated.sum() < 350
    assert np.array_equal(separated, shared == 0)
