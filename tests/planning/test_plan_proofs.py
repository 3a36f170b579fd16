"""Proofs of plans, and why a part is held."""

import json
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from read_proofs import Proof, proof_of, reasons, signed, written

import kilter
from kilter import Assembly, Box, Cylinder, InputError, Order, Part, Pose
from kilter.analysis.planning.order.explained import explain
from kilter.analysis.verification import verify_bundle
from kilter.mechanics.bundle_changes import restored
from kilter.mechanics.proof import digest_of
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block, floor, tube
from kilter.scenes.walls import wall

Change = Callable[[Proof], object]


def screwed() -> Assembly:
    """A post on a floor, and a ring round it."""
    post = Part("post", Cylinder(1, 4), Pose([0, 0, 2]))
    return Assembly([floor([-3, -3], [3, 3]), post, tube("ring", 1, 2, 1, [0, 0, 0.5])])


def row() -> Assembly:
    """Three blocks side by side on a floor."""
    blocks = [block(f"b{k}", [2 * k, 0, 0], [2 * k + 1, 1, 1]) for k in range(3)]
    return Assembly([floor([-1, -1], [6, 2]), *blocks])


@cache
def planned(name: str) -> Order:
    made: dict[str, Callable[[], Order]] = {
        "arch": lambda: kilter.plan(
            arch(5, ratio=0.3, friction=0.6), kilter.PlanRules(never_hold="voussoir-0")
        ),
        "no order": lambda: kilter.plan(arch(5, ratio=0.3, friction=0.6), kilter.PlanRules(hold=0)),
        "tower": lambda: kilter.plan(scene("tower")),
        "screw": lambda: kilter.plan(screwed(), kilter.PlanRules(screws=[("post", "ring")])),
        "row": lambda: kilter.plan(row(), kilter.PlanRules(before=[("b2", "b0")])),
    }
    return made[name]()


def judged(name: str, change: Change, *, anew: bool = True) -> str:
    """Why the proof of a plan does not hold once it is changed; empty where it holds."""
    order = planned(name)
    proof = proof_of(order)
    change(proof)
    return reasons(order, signed(proof) if anew else proof)


def entries(proof: Proof, about: str) -> list[Proof]:
    return [one for one in proof["proofs"] if one["about"] == about]


def exchange(proof: Proof, first: int, second: int) -> None:
    """Exchange two steps, each with its way and its part; the states stay as they were told."""
    steps = entries(proof, "step")
    one, other = steps[first], steps[second]
    for key in ("parts", "legs", "over"):
        one[key], other[key] = other[key], one[key]


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["arch", "no order", "tower", "screw", "row"])
def test_what_was_not_changed_holds(name):
    assert judged(name, lambda proof: None) == ""


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["arch", "tower", "screw", "row"])
def test_steps_exchanged_with_their_states_are_refused(name):
    """Whole entries exchanged: the states no longer follow one another."""

    def change(proof: Proof) -> None:
        where = [k for k, one in enumerate(proof["proofs"]) if one["about"] == "step"]
        a, b = where[0], where[-1]
        proof["proofs"][a], proof["proofs"][b] = proof["proofs"][b], proof["proofs"][a]

    assert "its state differs from the parts that stand before the step" in judged(name, change)


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("name", "steps", "why"),
    [
        ("tower", (1, 2), "'cube-3' touches no standing part"),
        ("screw", (0, 1), "the nut 'ring' is inserted before its bolt 'post'"),
        ("row", (0, 2), "'b0' is inserted before 'b2'"),
    ],
)
@pytest.mark.slow
def test_parts_exchanged_are_refused(name, steps, why):
    found = judged(name, lambda proof: exchange(proof, *steps))
    assert why in found
    assert "its state differs from the parts that stand before the step" in found


def held_step(proof: Proof) -> Proof:
    return next(one for one in entries(proof, "step") if one["change"]["held"])


def more_force(proof: Proof) -> None:
    entries(proof, "step")[-1]["proof"]["forces"][0][2] += 1e-3


def other_motion(proof: Proof) -> None:
    motion = entries(proof, "falls alone")[0]["proof"]["motion"]
    motion[next(iter(motion))][2] += 1e-3


def one_more_held(proof: Proof) -> None:
    held = entries(proof, "step")[-2]["change"]["held"]
    held += [one["parts"][0] for one in entries(proof, "step")[:-2] if one["parts"][0] not in held][
        :1
    ]


def falls_in_a_step(proof: Proof) -> None:
    entry = entries(proof, "falls alone")[0]
    entry.update(about="step", parts=[entry["part"]], legs=[], over=None)


CHANGES: list[tuple[str, str, Change]] = [
    ("arch", "its stated residual differs from that of its forces", more_force),
    ("no order", "its fastest part does not move by 1", other_motion),
    (
        "tower",
        "a part blocks the path",
        lambda p: entries(p, "step")[2].update(legs=[[[0.0, 0.0, -1.0], None]]),
    ),
    (
        "tower",
        "a part blocks the path",
        lambda p: entries(p, "step")[2].update(legs=[[[0.0, 0.0, 1.0], 4.0]]),
    ),
    ("tower", "a part blocks the path", lambda p: entries(p, "step")[2].update(legs=[])),
    ("arch", "1 parts are held, more than 0", lambda p: p["rules"].update(hold=0)),
    (
        "arch",
        "is held, but must not be held",
        lambda p: p["rules"].update(never_held=held_step(p)["change"]["held"]),
    ),
    (
        "row",
        "is inserted before 'b0'",
        lambda p: p["rules"]["precedence"].append([entries(p, "step")[1]["parts"][0], "b0"])
        or p["rules"]["precedence"].append(["b0", entries(p, "step")[1]["parts"][0]]),
    ),
    (
        "screw",
        "which is not its bolt or not in place",
        lambda p: entries(p, "step")[1].update(over=None),
    ),
    (
        "screw",
        "which is not its bolt or not in place",
        lambda p: entries(p, "step")[0].update(over="ring"),
    ),
    (
        "screw",
        "along the axis of its thread",
        lambda p: entries(p, "step")[1].update(legs=[[[0.0, 0.6, 0.8], None]]),
    ),
    ("arch", "fewer than 2 held parts may be enough", one_more_held),
    (
        "arch",
        "other parts are free in the proof",
        lambda p: entries(p, "not fewer")[0]["change"]["held"].pop(),
    ),
    ("arch", "the finished assembly has no proof", lambda p: p["proofs"].pop(0)),
    ("arch", "no step inserts", lambda p: p["proofs"].remove(entries(p, "step")[-1])),
    ("arch", "its proof gives the verdict unstable", falls_in_a_step),
    (
        "row",
        "'b1' does not move with its group",
        lambda p: p["rules"]["groups"].append(["b0", "b1"]),
    ),
    (
        "arch",
        "it changes more than which parts are present and which are held",
        lambda p: entries(p, "step")[0]["change"].update(mu=5.0),
    ),
    ("arch", "of the unknown kind 'else'", lambda p: entries(p, "step")[0].update(about="else")),
    ("no order", "is not proved to fall", lambda p: entries(p, "falls alone")[0]["change"].update(
        without=[])),
    ("no order", "is not proved to fall", lambda p: p["proofs"].pop()),
]  # fmt: skip


@pytest.mark.quick(2)
@pytest.mark.parametrize(
    ("name", "why", "change"), CHANGES, ids=[f"{one[0]}: {one[1]}" for one in CHANGES]
)
def test_a_change_is_refused(name, why, change):
    assert why in judged(name, change)


def test_a_number_that_is_changed_without_a_signature_is_refused():
    """A leg that is another, and free as well: only the digest knows."""

    def change(proof: Proof) -> None:
        entries(proof, "step")[0]["legs"] = [[[0.0, 0.6, 0.8], None]]

    assert judged("tower", change) == ""
    assert "digest does not match" in judged("tower", change, anew=False)


@pytest.mark.slow
def test_a_file_has_the_changes_of_a_state_and_not_the_state():
    """A wall of twice the length has twice the changes, and its states have four times the rows."""
    sizes = []
    for length in (4, 8):
        order = kilter.plan(wall(4, length))
        proof = written(order)
        assert verify_bundle(order.states.assembly, order.states.contacts, proof).holds
        states = [one["proof"] for one in restored(proof)["proofs"]]
        whole = [len(json.dumps(one)) for one in states]
        sizes.append((len(json.dumps(proof)), sum(whole)))
        assert all(one["digest"] == digest_of({**proof["common"], **one}) for one in states)
    assert sizes[1][0] < 2.4 * sizes[0][0]
    assert sizes[1][1] > 3 * sizes[0][1]


def changed_points(proof: Proof) -> list[dict[str, Any]]:
    """The changes of the contact points of the last step."""
    segments: list[dict[str, Any]] = entries(proof, "step")[-1]["proof"]["points"]["rows"]
    return segments


def first_kept(proof: Proof) -> list[int]:
    """A run of points that the last step keeps."""
    run: list[int] = next(one["kept"] for one in changed_points(proof) if "kept" in one)
    return run


def one_point_less(proof: Proof) -> None:
    first_kept(proof)[0] += 1


def more_points_than_there_are(proof: Proof) -> None:
    first_kept(proof)[1] += 1000


def points_kept_twice(proof: Proof) -> None:
    changed_points(proof).append({"kept": first_kept(proof)})


def no_whole_numbers(proof: Proof) -> None:
    first_kept(proof)[0] = True


def other_new_force(proof: Proof) -> None:
    segments = entries(proof, "step")[-1]["proof"]["forces"]["rows"]
    next(one["new"] for one in segments if "new" in one)[0][2] *= 1.01


def another_part_stands(proof: Proof) -> None:
    entries(proof, "step")[-1]["change"]["without"] = {"rows": [{"new": ["cube-1"]}]}


def nothing_before(proof: Proof) -> None:
    proof["proofs"][0]["proof"]["forces"] = {"rows": [{"kept": [0, 1]}]}


DAMAGED: list[tuple[str, Change]] = [
    ("the proof has 15 contact points, the file 16", one_point_less),
    ("do not fit the rows before them", more_points_than_there_are),
    ("do not fit the rows before them", points_kept_twice),
    ("do not fit the rows before them", no_whole_numbers),
    ("do not fit the rows before them", nothing_before),
    ("its stated residual differs from that of its forces", other_new_force),
    ("its state differs from the parts that stand before the step", another_part_stands),
]


@pytest.mark.parametrize(("why", "change"), DAMAGED, ids=[one[1].__name__ for one in DAMAGED])
def test_a_damaged_change_is_refused(why, change):
    """Whoever changes a file may sign it anew: each state is judged with all its rows."""
    order = planned("tower")
    proof = written(order)
    change(proof)
    try:
        found = reasons(order, signed(proof))
    except InputError as error:
        found = str(error)
    assert why in found


def test_neither_an_order_nor_an_impossibility_proves_nothing():
    def change(proof: Proof) -> None:
        proof["proofs"] = entries(proof, "whole")

    assert "neither an order" in judged("tower", change)


@pytest.mark.parametrize("key", ["parts", "legs", "change"])
def test_an_entry_without_its_form_is_wrong_input(key):
    with pytest.raises(InputError):
        judged("tower", lambda proof: entries(proof, "step")[0].pop(key))


@pytest.mark.slow
def test_no_solver_is_loaded(tmp_path):
    """The arch's file and proof, where neither solver can be imported."""
    order, proof, file = planned("arch"), tmp_path / "p.json", tmp_path / "arch.kilter.json"
    proof.write_text(json.dumps(order.proof()))
    kilter.dump(order.states.assembly, file)
    code = (
        "import sys; sys.modules['highspy'] = sys.modules['clarabel'] = None\n"
        "import kilter; print(kilter.verify(*sys.argv[1:]))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(file), str(proof)], capture_output=True, text=True
    )
    assert done.stdout == "<Verification: plan, holds>\n", done.stderr


@pytest.fixture(scope="module")
def built() -> Any:
    order = kilter.plan(arch(9, ratio=0.3, friction=0.6, planar=False))
    return order, explain(order)


@pytest.mark.slow
def test_hands_and_ground_carry_the_weight_of_what_stands(built):
    order, found = built
    assembly = order.states.assembly
    grounded, mass = assembly.geometry.grounded, assembly.geometry.mass
    for step, support in zip(order.steps, found.supports, strict=True):
        held = np.isin(assembly.names, step.held)
        free = step.state.present & ~grounded & ~held
        weight = float(mass[free | held].sum()) * assembly.gravity
        first, second = grounded[support.parts].T
        ground = support.forces[first].sum(axis=0) - support.forces[second].sum(axis=0)
        hands = sum((hand.force for hand in support.hands), np.zeros(3))
        assert np.linalg.norm(weight + ground + hands) < 1e-6 * np.linalg.norm(weight) + 1e-9


def test_a_hand_is_there_because_something_falls_without_it(built):
    order, found = built
    assert sum(len(support.hands) for support in found.supports) == order.held_steps > 0
    for step, support in zip(order.steps, found.supports, strict=True):
        assert tuple(hand.part for hand in support.hands) == step.held
        for hand in support.hands:
            present = [n for n, on in zip(step.state.names, step.state.present, strict=True) if on]
            without = order.states.of(present, [name for name in step.held if name != hand.part])
            assert without.stable is False
            assert hand.falls == tuple(without.moving) != ()


def test_a_hand_carries_the_least_that_keeps_a_plank_from_tipping():
    # it reaches out so far that it tips, until a weight stands on its other end
    table = Part("table", Box([4, 2, 1]), Pose([-2, 0, -0.5]), grounded=True)
    plank = Part("plank", Box([4, 2, 1]), Pose([1, 0, 0.5]))
    weight = Part("weight", Box([1, 2, 10]), Pose([-0.5, 0, 6]))
    order = kilter.plan(Assembly([table, plank, weight]))
    assert [step.part for step in order.steps] == ["plank", "weight"]
    [hand] = explain(order).supports[1].hands
    assert (hand.part, hand.falls) == ("plank", ("plank",))
    assert hand.least
    assert hand.torque is not None
    # the edge at a distance d carries W - F, the hand F and the torque (W - F) d, so that
    # F^2 + (W - F)^2 (d/r)^2 is least
    total, share = 8 * 1000 * 9.81, (1 / np.linalg.norm([2, 1, 0.5])) ** 2
    carried = total * share / (1 + share)
    assert np.allclose(hand.force, [0, 0, carried])
    assert np.allclose(hand.torque, [0, -(total - carried), 0], atol=1e-3)


def test_a_tower_is_put_up_from_below_and_nothing_else_is_asked():
    found = explain(kilter.plan(scene("tower")))
    pairs = {(one.before, one.after, one.why) for one in found.needs}
    cubes = [f"cube-{k}" for k in range(1, 6)]
    assert pairs == {(a, b, "way") for k, a in enumerate(cubes) for b in cubes[k + 1 :]}


@pytest.mark.slow
def test_what_was_asked_for_is_among_the_needs():
    order = kilter.plan(scene("wall"), kilter.PlanRules(before=[("brick-0-3", "brick-0-2")]))
    [asked] = [one for one in explain(order).needs if one.why == "asked"]
    assert (asked.before, asked.after) == ("brick-0-3", "brick-0-2")


def test_parts_that_move_as_one_stop_as_one():
    made = [block("plate", [0, 0, 0], [3, 2, 1]), block("knob", [1, 0.5, 1], [2, 1.5, 2])]
    lid = block("lid", [0, 0, 2], [3, 2, 3])
    whole = Assembly([floor([-1, -1], [4, 3]), *made, lid])
    order = kilter.plan(whole, kilter.PlanRules(groups=[["plate", "knob"]]))
    assert [step.parts for step in order.steps] == [("plate", "knob"), ("lid",)]
    [need] = explain(order).needs
    assert (need.before, need.after) == ("plate", "lid")
