"""Straight paths: against parts that manifold3d moves step by step, and in closed form."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from interlocked import hooked
from moved_solids import deepest, places_along, skin
from random_turned import random_turned

import kilter
from kilter import Assembly, Box, Cylinder, Order, Part, Pose
from kilter.analysis.planning.order.removal import Leg
from kilter.analysis.planning.order.sweeps import Sweeps
from kilter.contact.common.distances import PartSolids
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block, floor, tube


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
def test_paths_against_parts_moved_step_by_step() -> None:
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
def test_every_place_of_every_way_of_a_plan_is_free(name: str) -> None:
    made = {
        "arch": lambda: arch(9, ratio=0.3, friction=0.6),
        "two pieces": under_a_lip,
    }.get(name, lambda: scene(name))()
    order = kilter.plan(made)
    assert order.found
    assert entered(order, 500) == []
    if name == "two pieces":  # past the corner that its way turns round, it would hit the lip
        [step] = order.steps
        cut = dataclasses.replace(step, legs=step.legs[1:])
        assert entered(dataclasses.replace(order, steps=(cut,)), 500) == ["inside into lip"]


def clamp() -> Assembly:
    """An arm on a base, a bolt through both, a nut on the arm."""
    bolt = Part("bolt", Cylinder(4, 40), Pose([0, 0, 20]))
    arm, nut = tube("arm", 4, 20, 10, [0, 0, 5]), tube("nut", 4, 7, 6, [0, 0, 13])
    return Assembly([floor([-30, -30], [30, 30]), bolt, arm, nut])


@pytest.mark.slow
def test_every_place_of_the_way_of_a_nut_is_free() -> None:
    order = kilter.plan(clamp(), kilter.PlanRules(screws=[("bolt", "nut")]))
    assert order.found
    assert order.steps[-1].over == "bolt"
    assert entered(order, 500) == []
    down = (Leg((0.0, 0.0, -1.0), np.inf),)  # the other way it would pass through the arm
    wrong = dataclasses.replace(order.steps[-1], legs=down)
    swapped = dataclasses.replace(order, steps=(*order.steps[:-1], wrong))
    assert "nut into arm" in entered(swapped, 500)


@pytest.mark.slow
def test_every_place_of_the_way_of_parts_that_move_as_one_is_free() -> None:
    stacked = kilter.plan(scene("tower"), kilter.PlanRules(groups=["cube-[23]"]))
    hooks = kilter.plan(hooked(), kilter.PlanRules(together=True))
    for order in (stacked, hooks):
        assert any(len(step.parts) > 1 for step in order.steps)
        assert entered(order, 500) == []
    [step] = hooks.steps  # one after the other, the second would pass through the first
    apart = tuple(dataclasses.replace(step, parts=(name,)) for name in step.parts)
    assert entered(dataclasses.replace(hooks, steps=apart), 500) == ["B into A"]


@pytest.mark.parametrize("gap", [-2e-5, 0.0, 2e-5])
def test_sliding_along_a_face_is_free_within_the_tolerance(gap: float) -> None:
    """Unit cubes side by side: 1e-5 of a size, or twice as deep as they are drawn."""
    beside = Part("b", Box([1, 1, 1]), Pose([1.5 + gap, 0.5, 0.5]))
    pair = Assembly([block("a", [0, 0, 0], [1, 1, 1]), beside])
    sweeps = Sweeps(kilter.contacts(pair))
    assert sweeps.tolerance(0, 1) == pytest.approx(max(1e-5 * np.sqrt(3), -2 * gap), rel=1e-6)
    assert not sweeps.pair_stops(0, 1, (0.0, 0.0, 1.0))
    assert sweeps.pair_stops(0, 1, (1.0, 0.0, 0.0))
    assert not sweeps.pair_stops(0, 1, (-1.0, 0.0, 0.0))


@pytest.mark.parametrize(("shift", "stops"), [(0.999, True), (0.9999999, False), (1.001, False)])
def test_an_overlap_counts_where_it_is_wider_than_the_tolerance(shift: float, stops: bool) -> None:
    pair = Assembly(
        [block("a", [0, 0, 0], [1, 1, 1]), block("b", [shift, 0, 3], [shift + 1, 1, 4])]
    )
    assert Sweeps(kilter.contacts(pair)).pair_stops(0, 1, (0.0, 0.0, 1.0)) == stops


@pytest.mark.parametrize(("distance", "stops"), [(1.999, False), (2.001, True), (np.inf, True)])
def test_a_path_ends_where_it_ends(distance: float, stops: bool) -> None:
    pair = Assembly([block("a", [0, 0, 0], [1, 1, 1]), block("b", [0, 0, 3], [1, 1, 4])])
    sweeps = Sweeps(kilter.contacts(pair))
    assert sweeps.pair_stops(0, 1, (0.0, 0.0, 1.0), distance=distance) == stops
    aside = np.array([1.5, 0.0, 0.0])
    assert not sweeps.pair_stops(0, 1, (0.0, 0.0, 1.0), distance=distance, start=aside)
