"""Plans: known answers, proofs that are judged again, and what is refused."""

from __future__ import annotations

import csv
import io
import math
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from read_proofs import proof_of, reasons

import kilter
from kilter import Assembly, InputError, Order, Part, Pose
from kilter.analysis.planning.order.removal import Removal
from kilter.analysis.planning.states.part_sets import bits_of, mask_of
from kilter.analysis.verification import verify_bundle
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block, floor, tube

DATA = Path(__file__).resolve().parents[3] / "shared" / "data"


def rechecked(order: Order) -> dict[str, Any]:
    """The proof of a plan, through JSON, judged again without any solver."""
    proof = proof_of(order)
    assembly = order.states.assembly
    answer = verify_bundle(assembly, kilter.contacts(assembly), proof)
    assert answer.holds, answer.reasons
    return proof


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("name", "held"),
    [
        ("tower", 0),
        ("paper-figure-9", 1),
        ("pit-wedges", 1),
        ("diamond", 0),
        pytest.param("box-pile", 0, marks=pytest.mark.slow),
        pytest.param("wall", 0, marks=pytest.mark.slow),
        pytest.param("laden-slab", 0, marks=pytest.mark.slow),
    ],
)
def test_most_parts_held_at_once(name: str, held: int) -> None:
    order = kilter.plan(scene(name))
    assert (order.verdict, order.holds_max) == ("found", held)
    assert order.held_steps <= 1
    rechecked(order)


def test_the_wedge_that_leaves_first_is_the_only_one_that_can() -> None:
    assert kilter.plan(scene("pit-wedges")).steps[-1].part == "wedge-3"


@pytest.mark.quick(1)
@pytest.mark.parametrize(("count", "ratio", "reached"), [(9, 0.3, 4), (20, 0.2, 8)])
def test_an_arch_needs_one_part_held_and_that_is_proved(
    count: int, ratio: float, reached: int
) -> None:
    made = arch(count, ratio=ratio, friction=0.6)
    none = kilter.plan(made, kilter.PlanRules(hold=0))
    assert (none.verdict, none.found) == ("impossible", False)
    assert len(none.falling) == count - reached
    proof = rechecked(none)
    one = kilter.plan(made)
    assert (one.verdict, one.holds_max) == ("found", 1)
    assert one.held_steps >= count - reached - 1  # those that do not stand alone, less a keystone
    if count == 9:
        rechecked(one)
        proof["proofs"][0]["change"]["held"].pop()
        assert "is not proved to fall" in reasons(none, proof)


@pytest.mark.slow
def test_fewest_held_steps_are_those_of_all_orders() -> None:
    """Against every order of seven voussoirs, set by set."""
    made = arch(7, ratio=0.3, friction=0.6)
    order = kilter.plan(made, kilter.PlanRules(fewest="held-steps", hold=1))
    states = order.states
    removal = Removal(states.contacts)
    stones = [k for k, free in enumerate(~made.geometry.grounded) if free]
    neighbours = [set(removal.touching(1 << k, states.mask("*"), (0, 0, 1))[0]) for k in stones]
    base = bits_of(made.geometry.grounded)

    @cache
    def least(standing: int) -> float:
        """Held steps of the best order of a set."""
        if standing == base:
            return 0
        found = [math.inf]
        for stone, near in zip(stones, neighbours, strict=True):
            rest = standing & ~(1 << stone)
            if rest == standing or not any(rest >> other & 1 for other in near):
                continue
            if any(removal.way_out(1 << stone, standing, legs=legs) for legs in (1, 2)):
                held = states.holds_of(mask_of(rest, len(made)), states.mask("vou*"), most=1)
                if held.state is not None:
                    found.append(least(rest) + bool(held.parts))
        return min(found)

    assert order.held_steps == least(bits_of(states.mask("*")))
    worst = kilter.plan(
        made, kilter.PlanRules(before=[(f"voussoir-{k}", f"voussoir-{k + 1}") for k in range(6)])
    )
    assert worst.held_steps > order.held_steps


@pytest.mark.slow
def test_what_is_said_of_fewer() -> None:
    tower = kilter.plan(scene("tower"))
    assert (tower.fewest.least, tower.to_dict()["sentence"]) == (
        "always", "It can be put together in 5 steps, with nothing held."
    )  # fmt: skip
    made = arch(9, ratio=0.3, friction=0.6)
    assert kilter.plan(made).fewest.least == "always"
    words = kilter.plan(made, kilter.PlanRules(fewest="held-steps")).to_dict()["sentence"]
    assert words.endswith(
        "Along the directions that were tried no order has fewer steps with held parts."
    )


@pytest.mark.slow
def test_an_arch_that_falls_when_it_is_finished_has_no_order() -> None:
    falling = arch(20, ratio=0.2, friction=0.3)
    order = kilter.plan(falling)
    answer = order.to_dict()
    assert (order.found, order.verdict, order.holds) == (False, "impossible", False)
    assert answer["impossible"]["kind"] == "falls"
    assert "voussoir-0" in answer["impossible"]["parts"]
    assert answer["finished"] == {"verdict": "unstable", "level": None}
    assert kilter.verify(falling, order.proof()).holds
    assert not kilter.verify(falling.with_friction(0.9), order.proof()).holds


@pytest.mark.quick(1)
@pytest.mark.parametrize(
    ("name", "require"), [("squeezed-block", "settles"), ("squeezed-block", "proved")]
)
def test_the_finished_assembly_is_a_state_of_its_plan(name: str, require: str) -> None:
    order = kilter.plan(scene(name), require=require)
    verdict = kilter.check(scene(name), require=require)
    assert order.found
    assert order.to_dict()["finished"] == {"verdict": verdict.verdict, "level": verdict.level}
    assert (order.level, order.holds) == ("equilibrium", False)


def test_a_way_of_two_pieces() -> None:
    """Under a lip: along x, then up."""
    parts = [
        floor([-3, -3], [5, 5]),
        Part("lip", kilter.Box([1, 3, 1]), Pose([0.5, 0.5, 1.5]), grounded=True),
        Part("wall", kilter.Box([1, 3, 2]), Pose([-0.5, 0.5, 1]), grounded=True),
        Part("stop", kilter.Box([1, 3, 2]), Pose([2.5, 0.5, 1]), grounded=True),
        Part("side", kilter.Box([4, 1, 2]), Pose([1, -0.5, 1]), grounded=True),
        Part("other", kilter.Box([4, 1, 2]), Pose([1, 1.5, 1]), grounded=True),
        block("inside", [0, 0, 0], [1, 1, 1]),
    ]
    order = kilter.plan(Assembly(parts))
    [step] = order.steps
    assert [leg.direction for leg in step.legs] == [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]
    assert step.legs[0].length == 1.0
    assert step.path.tolist() == [[1, 0, 2 * 8], [1, 0, 0], [0, 0, 0]]  # twice the floor
    rechecked(order)


def test_precedence_is_kept_to() -> None:
    with pytest.raises(InputError, match="the precedence has a cycle"):
        kilter.plan(
            scene("tower"), kilter.PlanRules(before=[("cube-1", "cube-2"), ("cube-2", "cube-1")])
        )
    table = Assembly([floor([-3, -3], [3, 3]), *(block(f"b{k}", [k, 0, 0], [k + 0.5, 1, 1])
                                                for k in range(-2, 3))])  # fmt: skip
    for pair in (("b-2", "b2"), ("b2", "b-2")):
        order = [step.part for step in kilter.plan(table, kilter.PlanRules(before=[pair])).steps]
        assert order.index(pair[0]) < order.index(pair[1])


@pytest.mark.slow
def test_none_found_is_no_proof() -> None:
    """A peg in a closed round hole turns, so nothing locks it; nor does it leave."""
    held = [
        floor([-2, -2], [2, 2]),
        tube("round", 1.0, 2.0, 1.0, [0, 0, 0.5]),
        block("lid", [-2, -2, 1], [2, 2, 2]),
    ]
    walls = [Part(p.name, p.shape, p.pose, grounded=True) for p in held]
    peg = Part("peg", kilter.Cylinder(1.0, 1.0), Pose([0, 0, 0.5]))
    order = kilter.plan(Assembly([*walls, peg]))
    assert (order.verdict, order.search.exhausted, order.locked) == ("none-found", True, ())
    assert "does not prove that none exists" in order.to_dict()["sentence"]
    with pytest.raises(InputError, match="nothing is proved"):
        order.proof()
    assert kilter.plan(Assembly([*walls[:-1], peg])).found


@pytest.mark.slow
def test_parts_that_may_not_be_held() -> None:
    made = arch(9, ratio=0.3, friction=0.6)
    none = kilter.plan(made, kilter.PlanRules(never_hold="voussoir-*"))
    assert none.verdict == "impossible"
    rechecked(none)
    left = kilter.plan(made, kilter.PlanRules(never_hold=["voussoir-[0-3]"]))
    assert not {name for step in left.steps for name in step.held} & {f"voussoir-{k}"
                                                                    for k in range(4)}  # fmt: skip


@pytest.mark.slow
def test_out_of_effort_says_what_can_come_last() -> None:
    # less effort ends before the search with held parts, and more finds an order
    order = kilter.plan(arch(20, ratio=0.2, friction=0.6), effort=0.07)
    assert order.verdict == "none-found"
    assert not order.search.exhausted
    assert order.best
    assert "effort limit was reached" in order.to_dict()["sentence"]


@pytest.mark.slow
def test_an_interruption_gives_the_best_so_far(monkeypatch: pytest.MonkeyPatch) -> None:
    from kilter.analysis.planning.order.removal import Removal

    asked = 0
    way_out = Removal.way_out

    def interrupted(self: Removal, *given: Any, **named: Any) -> Any:
        nonlocal asked
        asked += 1
        if asked > 20:
            raise KeyboardInterrupt
        return way_out(self, *given, **named)

    monkeypatch.setattr(Removal, "way_out", interrupted)
    order = kilter.plan(scene("wall"))
    assert (order.interrupted, order.verdict) == (True, "none-found")
    assert order.best


@pytest.mark.slow
def test_the_table_of_steps_is_read_as_csv() -> None:
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6))
    rows = list(csv.DictReader(io.StringIO(order.table())))
    assert [row["part"] for row in rows] == [step.part for step in order.steps]
    assert {row["held"] for row in rows} > {""}
    answer = order.to_dict()
    assert answer["holds_max"] == 1
    assert [set(step) for step in answer["steps"]] == [
        {"parts", "direction", "path", "touches", "rubs", "held", "grips", "releases", "down",
         "verdict", "level", "fails", "over"}
    ] * 9  # fmt: skip


def test_a_plan_of_held_parts_needs_no_step() -> None:
    held = scene("tower").with_grounded("*")
    order = kilter.plan(held)
    answer = order.to_dict()
    assert (order.verdict, order.holds, answer["steps"]) == ("found", True, [])
    assert answer["warnings"] == ["every part is held: nothing can move"]
    assert answer["sentence"] == "Every part is held, so that no step is needed."
    assert kilter.verify(held, order.proof()).holds
    # the same file proves nothing about an assembly with a free part
    assert not kilter.verify(scene("tower"), order.proof()).holds
    verdict = kilter.check(held).to_dict()
    assert (verdict["verdict"], verdict["level"]) == ("stable", order.level)
    assert verdict["warnings"] == answer["warnings"]
    with pytest.raises(InputError, match="every part is held: there are no steps to show"):
        kilter.draw(order)
    assert kilter.report(order).verdict == "found"


def test_wrong_input() -> None:
    tower = scene("tower")
    with pytest.raises(InputError, match="no part is named"):
        kilter.plan(tower, kilter.PlanRules(before=[("cube-1", "nobody")]))
    with pytest.raises(InputError, match="hold is -1"):
        kilter.plan(tower, kilter.PlanRules(hold=-1))
    with pytest.raises(InputError, match="fewest is 'parts'"):
        kilter.plan(tower, kilter.PlanRules(fewest="parts"))
    with pytest.raises(InputError, match="a direction is 'up'"):
        kilter.plan(tower, kilter.PlanRules(directions=["up"]))
    with pytest.raises(InputError, match="no 'cube-2' surrounds the shaft"):
        kilter.plan(tower, kilter.PlanRules(screws=[("cube-1", "cube-2")]))
    with pytest.raises(InputError, match="held from the start"):
        kilter.plan(tower, kilter.PlanRules(before=[("cube-1", "base")]))


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="real assemblies are not here")
def test_nuts_come_after_their_bolts() -> None:
    pytest.importorskip("OCP")
    made = kilter.load(DATA / "cax-if" / "as1-oc-214.stp", ground=["plate"], friction=0.3)
    order = kilter.plan(made, kilter.PlanRules(screws=[("*bolt", "*nut"), ("rod", "nut_*")]))
    assert (order.verdict, order.holds_max) == ("found", 0)
    place = {step.part: k for k, step in enumerate(order.steps)}
    for bolt in [name for name in place if name.endswith("bolt")]:
        assert place[bolt] < place[bolt.removesuffix("bolt") + "nut"]
    assert place["rod"] < min(place["nut_1"], place["nut_2"])
    rechecked(order)
