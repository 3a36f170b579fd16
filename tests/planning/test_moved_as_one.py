"""Parts that move as one: groups that are named, and those that stop one another."""

from __future__ import annotations

import numpy as np
import pytest
from interlocked import hooked
from read_proofs import proof_of, reasons

import kilter
from kilter import Assembly, InputError, Order, Part
from kilter.analysis.planning.order.removal import Removal
from kilter.analysis.planning.order.together import blocked_together, units_of_groups
from kilter.analysis.planning.states.part_sets import bits_of
from kilter.scenes import scene
from kilter.scenes.pieces import block, floor


def rechecked(order: Order) -> None:
    assert not reasons(order, proof_of(order))


@pytest.mark.slow
def test_two_that_leave_only_as_one() -> None:
    made = hooked()
    alone = kilter.plan(made)
    assert alone.verdict == "impossible"
    order = kilter.plan(made, kilter.PlanRules(together=True))
    [step] = order.steps
    assert (step.parts, step.direction) == (("A", "B"), (0.0, -1.0, 0.0))
    assert order.to_dict()["steps"][0]["parts"] == ["A", "B"]
    rechecked(order)


@pytest.mark.slow
def test_with_the_ledges_off_each_leaves_alone() -> None:
    """Then nothing has to move as one, and nothing does."""
    order = kilter.plan(hooked(lid=False), kilter.PlanRules(together=True))
    assert sorted(step.parts for step in order.steps) == [("A",), ("B",)]


def test_sets_that_stop_one_another() -> None:
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


def test_a_group_goes_in_as_one() -> None:
    order = kilter.plan(scene("tower"), kilter.PlanRules(groups=["cube-[23]"]))
    assert [step.parts for step in order.steps] == [
        ("cube-1",), ("cube-2", "cube-3"), ("cube-4",), ("cube-5",)
    ]  # fmt: skip
    assert order.steps[1].touches == ("cube-1",)
    rechecked(order)


def test_a_group_that_spans_a_part_cannot_close_round_it() -> None:
    """Cubes below and above one that is not of the group: no way for it, none for them."""
    order = kilter.plan(
        scene("tower"), kilter.PlanRules(groups=[["cube-2", "cube-4"]], directions=[[0, 0, 1]])
    )
    assert order.verdict == "none-found"


def test_groups_that_make_no_sense() -> None:
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


def test_the_key_leaves_first_and_upwards() -> None:
    order = kilter.plan(key_at_the_mouth())
    assert [(step.part, step.legs[0].direction) for step in order.steps] == [
        ("slab", (0.0, 1.0, 0.0)),
        ("key", (0.0, 0.0, 1.0)),
    ]
    rechecked(order)
