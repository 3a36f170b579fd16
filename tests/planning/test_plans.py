"""Plans: known answers, given sequences, and proofs that there is none."""

import csv
import io
import json
import math
from collections.abc import Callable
from functools import cache
from itertools import pairwise, permutations
from typing import Any

import numpy as np
import pytest
from read_proofs import Proof, proof_of, reasons, signed, written
from slopes import leaning

import kilter
from kilter import Assembly, Box, InputError, Order, Part, Pose, States, states
from kilter.analysis.planning.order.plan import MOST_SETS, find_unreachable, leads_nowhere
from kilter.analysis.planning.order.removal import Removal
from kilter.analysis.planning.order.search import OrderSearch
from kilter.analysis.planning.states.holds import bits_of, mask_of
from kilter.analysis.verification import verify_bundle
from kilter.files.packing.packing_lists import read_sequence
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block, floor, tube
from kilter.work import Work


def rechecked(order: Order) -> dict[str, Any]:
    """The proof of a plan, through JSON, judged again without any solver."""
    assembly = order.states.assembly
    answer = verify_bundle(assembly, kilter.contacts(assembly), written(order))
    assert answer.holds, answer.reasons
    return proof_of(order)


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
def test_most_parts_held_at_once(name, held):
    order = kilter.plan(scene(name))
    assert (order.verdict, order.holds_max) == ("found", held)
    assert order.held_steps <= 1
    rechecked(order)


def test_the_wedge_that_leaves_first_is_the_only_one_that_can():
    assert kilter.plan(scene("pit-wedges")).steps[-1].part == "wedge-3"


@pytest.mark.quick(1)
@pytest.mark.parametrize(("count", "ratio", "reached"), [(9, 0.3, 4), (20, 0.2, 8)])
@pytest.mark.slow
def test_an_arch_needs_one_part_held_and_that_is_proved(count, ratio, reached):
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
def test_fewest_held_steps_are_those_of_all_orders():
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
@pytest.mark.parametrize("rows", [2, 4])
def test_rows_of_a_wide_low_stack_are_laid_one_after_the_other(rows):
    count, thick = 8, 0.02  # a hundredth of the width is more than three rows
    slabs = [
        Part(f"{row}-{k}", Box(1, 1, thick), [k + row % 2 / 2, 0, (row + 0.5) * thick])
        for row in range(rows)
        for k in range(count)
    ]
    table = Part("table", Box(count + 1, 2, 1), [count / 2, 0, -0.5], grounded=True)
    order = kilter.plan(Assembly([table, *slabs]))
    laid = [int(step.part.split("-")[0]) for step in order.steps]
    assert laid == sorted(laid)


def test_an_arch_that_falls_when_it_is_finished_has_no_order():
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
def test_the_finished_assembly_is_a_state_of_its_plan(name, require):
    order = kilter.plan(scene(name), require=require)
    verdict = kilter.check(scene(name), require=require)
    assert order.found
    assert order.to_dict()["finished"] == {"verdict": verdict.verdict, "level": verdict.level}
    assert (order.level, order.holds) == ("equilibrium", False)


def test_a_way_of_two_pieces():
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


def test_precedence_is_kept_to():
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
def test_none_found_is_no_proof():
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
def test_parts_that_may_not_be_held():
    made = arch(9, ratio=0.3, friction=0.6)
    none = kilter.plan(made, kilter.PlanRules(never_hold="voussoir-*"))
    assert none.verdict == "impossible"
    rechecked(none)
    left = kilter.plan(made, kilter.PlanRules(never_hold=["voussoir-[0-3]"]))
    assert not {name for step in left.steps for name in step.held} & {f"voussoir-{k}"
                                                                    for k in range(4)}  # fmt: skip


@pytest.mark.slow
def test_out_of_effort_says_what_can_come_last():
    # less effort ends before the search with held parts, and more finds an order
    order = kilter.plan(arch(20, ratio=0.2, friction=0.6), effort=0.07)
    assert order.verdict == "none-found"
    assert not order.search.exhausted
    assert order.best
    assert "effort limit was reached" in order.to_dict()["sentence"]


@pytest.mark.slow
def test_an_interruption_gives_the_best_so_far(monkeypatch):
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
def test_the_table_of_steps_is_read_as_csv():
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


def test_a_plan_of_held_parts_needs_no_step():
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


def test_wrong_input():
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


@pytest.fixture(name="given")
def arch_states() -> States:
    return states(arch(9, ratio=0.3, friction=0.6))


def test_an_exhausted_budget_ends_the_growth_of_reachable_parts_without_a_proof(given):
    work = Work()
    _, falling = find_unreachable(given, work)
    assert len(falling) == 5
    assert work.spent > 0
    less = Work(work.spent / 3)
    assert find_unreachable(given, less)[1] == []
    assert less.spent < work.spent / 2


def searched(given: States, work: Work) -> OrderSearch:
    """A search for an order of the arch without hands, which does not exist."""
    held = given.assembly.geometry.grounded
    count = len(held)
    units = [1 << k for k in np.flatnonzero(~held).tolist()]
    search = OrderSearch(given, Removal(given.contacts), [0] * count, ~held, work, units)
    assert search.find(0) is None
    return search


def test_a_search_ends_within_the_removals_of_a_set_where_its_budget_ends(given):
    whole = searched(given, Work())
    assert whole.exhausted
    cut = searched(states(given.assembly), Work(1.0))
    assert not cut.exhausted
    assert cut.visited == 1
    assert cut.work.spent < whole.work.spent / 3


SLIDES = float(np.tan(np.radians(30.0)))
"""Friction with which what is not leaned on slides above 30 degrees [-]."""


def wrong(order: Order, change: Callable[[Proof], object] = lambda proof: None) -> str:
    """Why the proof does not hold once it is changed and signed anew."""
    proof = proof_of(order)
    change(proof)
    return reasons(order, signed(proof))


def from_both_sides(hold: int) -> Order:
    """An arch of nine of which left and right take turns: at most two must be held."""
    order = sorted(range(9), key=lambda k: min(k, 8 - k))
    chain = [(f"voussoir-{a}", f"voussoir-{b}") for a, b in pairwise(order)]
    return kilter.plan(arch(9, ratio=0.3, friction=0.6), kilter.PlanRules(before=chain, hold=hold))


@pytest.mark.slow
def test_an_arch_from_both_sides_needs_two():
    one = from_both_sides(1)
    assert (one.verdict, one.to_dict()["impossible"]["kind"]) == ("impossible", "exhaustion")
    assert not wrong(one)
    assert "with up to 1 part held no order exists" in one.to_dict()["sentence"]
    assert from_both_sides(2).verdict == "found"


@pytest.mark.parametrize(("degrees", "verdict"), [(29.9, "found"), (30.1, "impossible")])
def test_what_comes_first_slides_above_the_angle_of_friction(degrees, verdict):
    order = kilter.plan(leaning(degrees, SLIDES), kilter.PlanRules(before=[("A", "B")], hold=0))
    assert order.verdict == verdict
    assert not wrong(order)


def test_of_too_many_sets_nothing_is_said():
    most = MOST_SETS.bit_length() - 1
    assert leads_nowhere((1 << most) - 1, 0, lambda _, rest: rest != 0)
    assert not leads_nowhere((2 << most) - 1, 0, lambda _, rest: rest != 0)
    assert not leads_nowhere(0b11, 0, lambda _, rest: rest != 0b10)


@pytest.mark.parametrize("seed", range(20))
def test_chains_by_all_permutations(seed):
    count, whole = 5, 0b11111
    random = np.random.default_rng(seed)
    may = random.random(1 << count) < random.uniform(0.2, 0.7)
    may[0] = True
    chains = (
        all(may[whole & ~sum(1 << k for k in order[: n + 1])] for n in range(count))
        for order in permutations(range(count))
    )
    assert leads_nowhere(whole, 0, lambda _, rest: bool(may[rest])) != any(chains)


@pytest.mark.quick(1)
@pytest.mark.parametrize("change", ["left out", "free", "held more", "precedence", "turn"])
def test_a_proof_that_is_changed_is_refused(change):
    def changed(proof: Proof) -> None:
        if change == "left out":
            proof["proofs"].pop()
        elif change == "free":
            next(one for one in proof["proofs"] if one["about"] == "refused")["parts"] = []
        elif change == "held more":
            proof["rules"]["hold"] = 2
        elif change == "turn":
            proof["rules"]["turn"] = True
        else:
            proof["rules"]["precedence"] = []

    why = {
        "free": "other parts are free in the proof",
        "turn": "valid only if parts move one at a time",
    }
    assert why.get(change, "do not exclude every order") in wrong(from_both_sides(1), changed)


CUBES = [f"cube-{k}" for k in range(1, 6)]


@pytest.mark.slow
def test_the_order_of_a_plan_is_confirmed():
    made = arch(9, ratio=0.3, friction=0.6)
    plan = kilter.plan(made)
    order = kilter.plan(made, kilter.PlanRules(sequence=[step.parts for step in plan.steps]))
    assert [step.held for step in order.steps] == [step.held for step in plan.steps]
    assert (order.verdict, order.level) == ("found", plan.level)
    assert order.to_dict()["sentence"].startswith("It can be put together in this order, in 9")
    assert not reasons(order, proof_of(order))


def test_an_order_the_other_way_round_fails_at_each_step():
    """Cubes from the top: nothing to stand on, until the lowest is put under the others."""
    order = kilter.plan(scene("tower"), kilter.PlanRules(sequence=CUBES[::-1], hold=0))
    assert order.verdict == "fails"
    first, second, *_, last = order.steps
    assert first.fails == ("it touches no standing part",)
    assert second.fails == ("'cube-5' would fall before it is in place",)
    assert second.level is None
    assert "no free path was found along the directions that were tried" not in last.fails
    words = order.to_dict()["sentence"]
    assert words.startswith("This order fails at step 1, 'cube-5': it touches no standing part")
    assert words.endswith("4 further steps fail.")
    with pytest.raises(InputError, match="nothing is proved"):
        order.proof()


@pytest.mark.slow
def test_holds_that_are_needed_are_told():
    made = arch(9, ratio=0.3, friction=0.6)
    one_side = [f"voussoir-{k}" for k in range(9)]
    order = kilter.plan(made, kilter.PlanRules(sequence=one_side))
    assert (order.found, order.holds_max) == (True, 1)
    assert kilter.plan(made, kilter.PlanRules(sequence=one_side, hold=0)).verdict == "fails"


def test_a_step_without_a_way_proves_nothing():
    """A lid over a box before what comes into it."""
    walls = [
        block("west", [-1, -1, 0], [0, 2, 1]), block("east", [1, -1, 0], [2, 2, 1]),
        block("south", [0, -1, 0], [1, 0, 1]), block("north", [0, 1, 0], [1, 2, 1]),
    ]  # fmt: skip
    made = Assembly(
        [
            floor([-3, -3], [3, 3]),
            *(kilter.Part(p.name, p.shape, p.pose, grounded=True) for p in walls),
            kilter.Part("inside", kilter.Box([1, 1, 0.9]), Pose([0.5, 0.5, 0.45])),
            block("lid", [-1, -1, 1], [2, 2, 1.5]),
        ]
    )
    assert kilter.plan(made, kilter.PlanRules(sequence=["inside", "lid"])).found
    order = kilter.plan(made, kilter.PlanRules(sequence=["lid", "inside"]))
    assert [step.fails for step in order.steps] == [
        (), ("no free path was found along the directions that were tried",)
    ]  # fmt: skip
    assert (order.verdict, order.steps[1].direction) == ("none-found", None)
    assert order.to_dict()["steps"][1]["path"] == [[0.0, 0.0, 0.0]]
    assert "was not confirmed" in order.to_dict()["sentence"]


def test_parts_that_come_too_early():
    order = kilter.plan(
        scene("tower"), kilter.PlanRules(sequence=CUBES, before=[("cube-5", "cube-2")])
    )
    assert [step.part for step in order.steps if step.fails] == ["cube-5"]
    assert order.steps[-1].fails == ("it must come before 'cube-2'",)


def test_sequences_from_files(tmp_path):
    order = kilter.plan(scene("tower"), kilter.PlanRules(groups=["cube-[23]"]))
    wanted = [["cube-1"], ["cube-2", "cube-3"], ["cube-4"], ["cube-5"]]
    texts = {
        "a.csv": order.table(),
        "a.json": json.dumps(order.to_dict()),
        "b.json": json.dumps(["cube-1", ["cube-2", "cube-3"], "cube-4", "cube-5"]),
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
        assert read_sequence(tmp_path / name) == wanted
    (tmp_path / "a.txt").write_text("# upwards\ncube-1\n\n cube-2 \n")
    assert read_sequence(tmp_path / "a.txt") == [["cube-1"], ["cube-2"]]


@pytest.mark.parametrize(
    ("name", "text", "why"),
    [
        ("a.csv", "name,x\na,1\n", "no column 'part'"),
        ("a.json", "{}", "no sequence"),
        ("b.json", "[[1]]", "a step is"),
        ("c.json", "[", "not JSON"),
    ],
)
def test_files_that_are_no_sequence(tmp_path, name, text, why):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=why):
        read_sequence(tmp_path / name)


@pytest.mark.parametrize(
    ("sequence", "why"),
    [
        (["cube-1"], "leaves out 'cube-2'"),
        ([*CUBES, "cube-1"], "'cube-1' comes twice"),
        (["base", *CUBES], "'base' is grounded, so it stands from the start"),
        (["nobody"], "nobody"),
        ([], "leaves out"),
        ([[]], "a step of the sequence names no part"),
    ],
)
def test_sequences_that_make_no_sense(sequence, why):
    with pytest.raises(InputError, match=why):
        kilter.plan(scene("tower"), kilter.PlanRules(sequence=sequence))
