"""States of a packing plan that the forces of stacks decide equal those of `kilter.check`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest

import kilter
from kilter.analysis.placing import plan_states as states
from kilter.analysis.placing.check_plan import check_plan
from kilter.assembly.question import Question
from kilter.contact import contacts
from kilter.files.packing_lists import PackedBox, PackingPlan

STEP = 0.1
POST = kilter.Part("post", kilter.Box([0.5, 2, 0.2]), kilter.Pose([1.4, 1, 0.1]), grounded=True)
LOOSE = kilter.Part("loose", kilter.Box([0.2, 0.2, 0.2]), kilter.Pose([-2, 0, 0.1]), mass=1)
PIN = kilter.Part("pin", kilter.Cylinder(0.1, 1), kilter.Pose([-0.1, 0.2, 0.5]), grounded=True)
ARGUMENTS: list[dict[str, Any]] = [
    {},
    {"friction": 0.3},
    {"walls": (1.2, 1.2)},
    {"held": kilter.Assembly([POST])},
    {"held": kilter.Assembly([LOOSE])},
    {"held": kilter.Assembly([PIN])},
    {"pallet": (1.0, 1.0), "friction": 0.3, "require": "equilibrium"},
    {"require": "strict"},
]


def dropped(seed: int, count: int = 7) -> PackingPlan:
    """Boxes at the lowest of a few random places, on the highest box under them; some fall."""
    random = np.random.default_rng(seed)
    boxes: list[PackedBox] = []
    for k in range(count):
        sides = random.integers([2, 2, 1], [8, 8, 3])
        corners = random.integers(0, [12, 12] - sides[:2] + 1, size=(8, 2))
        places = [(_height_under(boxes, corner, sides), *corner.tolist()) for corner in corners]
        z, x, y = min(places)
        limit = float(random.choice([1, 20])) if seed % 2 and k % 3 == 0 else None
        length, width, height = (STEP * sides).tolist()
        mass, corner = float(random.choice([1, 5, 20])), (STEP * x, STEP * y, STEP * z)
        boxes.append(PackedBox(f"b{k}", (length, width, height), mass, corner, k + 1, limit))
    return PackingPlan(tuple(boxes), "m")


def _height_under(boxes: list[PackedBox], corner: Any, sides: Any) -> int:
    """Height of the highest box under a place [steps]."""
    height = 0
    for box in boxes:
        low, size = (np.rint(np.divide(x, STEP)).astype(int) for x in (box.corner, box.size))
        if (corner < (low + size)[:2]).all() and (corner + sides[:2] > low[:2]).all():
            height = max(height, int(low[2] + size[2]))
    return height


def grid(*counts: int) -> PackingPlan:
    """Boxes that touch their neighbours on all sides, layer by layer."""
    places = [(x, y, z) for z, y, x in np.ndindex(*reversed(counts))]
    return PackingPlan(
        tuple(
            PackedBox(f"b{k}", (0.3, 0.3, 0.2), 5, (0.3 * x, 0.3 * y, 0.2 * z), k + 1)
            for k, (x, y, z) in enumerate(places)
        ),
        "m",
    )


def data_of(plan: PackingPlan, arguments: dict[str, Any]) -> dict[str, Any]:
    return {**check_plan(plan, **arguments).to_dict(), "seconds": None}


def by_stacks(plan: PackingPlan) -> list[bool]:
    """Whether the stacks decide each state."""
    whole = plan.assembly().with_floor()
    found = states.plan_states(Question(assembly=whole, contacts=contacts(whole)), len(plan.boxes))
    return [state.verdict is None for state in found]


def compare(seeds: Iterable[int], monkeypatch: pytest.MonkeyPatch) -> None:
    cases = [(dropped(seed), ARGUMENTS[seed % len(ARGUMENTS)]) for seed in seeds]
    by_forces = [data_of(*case) for case in cases]
    monkeypatch.setattr(states, "_has_stacks", lambda *_: False)
    assert by_forces == [data_of(*case) for case in cases]
    assert {data["first"] is None for data in by_forces} == {True, False}


def test_stacks_and_checks_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    compare((1, 8), monkeypatch)


def test_a_tipping_box_ends_the_proofs_by_stacks() -> None:
    """The centre of 'c' lies beside 'a'; the later box 'd' is a counterweight on its other end."""
    base, size = PackedBox("a", (1, 1, 1), 9, (0, 0, 0), 1), (1.0, 1.0, 1.0)
    other = PackedBox("b", size, 1, (3, 0, 0), 2)
    tips = PackedBox("c", (2.2, 1, 1), 1, (0, 0, 1), 3)
    holds = PackedBox("d", size, 5, (0, 0, 2), 4)
    plan = PackingPlan((base, other, tips, holds), "m")
    assert by_stacks(plan) == [True, True, False, True]
    assert [item.verdict for item in check_plan(plan).items] == [
        *["stable"] * 2,
        "unstable",
        "stable",
    ]


def test_wrong_forces_of_a_stack_prove_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    plan = grid(1, 1, 3)
    assert by_stacks(plan) == [True] * 3
    right = states.resting_forces
    monkeypatch.setattr(states, "resting_forces", lambda *given: 1.001 * right(*given))
    assert by_stacks(plan) == [False] * 3


@pytest.mark.slow
def test_a_thousand_boxes_need_no_check(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_check(*_: object, **__: object) -> None:
        pytest.fail("an item was decided by a check of the whole pile")

    monkeypatch.setattr(states, "check", no_check)
    checked = check_plan(grid(10, 10, 10))
    assert checked.stands
    assert checked.level == "proved"
