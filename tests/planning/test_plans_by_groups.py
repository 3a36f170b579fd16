"""Groups of parts that do not touch: judged and taken apart one by one, as all together."""

from dataclasses import replace

import numpy as np
import pytest
from read_proofs import written

import kilter
from kilter import Assembly, Box, Cylinder, Order, Part, PlanRules, Pose, States
from kilter.analysis.decision import motion
from kilter.analysis.decision.judge import judge
from kilter.analysis.planning.order import sweeps
from kilter.analysis.planning.order.sweeps import Sweeps
from kilter.analysis.verification import verify_bundle
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.program import build_program
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block, floor, tube

UP = PlanRules(hold=0, directions=[[0, 0, 1]])


def cuboid(name: str, low: list[float], size: list[float]) -> Part:
    return block(name, low, np.add(low, size))


def beside(parts: Assembly, *, name: str, at: list[float], turn_deg: float = 0.0) -> list[Part]:
    """Copies of the parts of an assembly, which share their shapes, turned about z and shifted."""
    turn = Pose.from_euler([0, 0, np.radians(turn_deg)], at)
    return [replace(part, name=f"{name}/{part.name}", pose=turn @ part.pose) for part in parts]


def arches(*turns_deg: float, count: int = 9, friction: float = 0.6) -> Assembly:
    """Equal arches beside each other, each turned about the vertical."""
    one = arch(count, ratio=0.3, friction=friction)
    rows = enumerate(turns_deg)
    parts = [
        p for k, turn in rows for p in beside(one, name=f"{k}", at=[0, 40.0 * k, 0], turn_deg=turn)
    ]
    return replace(one, parts=parts, planar=False)


def rechecked(order: Order) -> None:
    assembly = order.states.assembly
    answer = verify_bundle(assembly, kilter.contacts(assembly), written(order))
    assert answer.holds, answer.reasons


def together(states: States) -> States:
    """States of the same assembly without groups."""
    whole = States(states.assembly, states.contacts)
    whole._groups = ()
    return whole


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_states_are_those_of_all_parts_together(seed):
    random = np.random.default_rng(seed)
    found = kilter.states(arches(0.0, 90.0, 33.0))
    assert len(found.groups) == 3
    whole, free = together(found), ~found.assembly.geometry.grounded
    verdicts = []
    for _ in range(25):
        present = (random.random(len(free)) < 0.95) | (~free & (random.random(len(free)) < 0.5))
        held = present & (random.random(len(free)) < 0.4)
        state, other = found.judge(present, held), whole.judge(present, held)
        assert state.stable == other.stable
        if state.forces is not None:
            again = check_forces(state.program, state.forces.forces, state.forces.friction)
            assert again.holds
            assert again.residual == pytest.approx(state.forces.residual, abs=1e-12)
        elif state.motion is not None:
            assert check_motion(state.program, state.motion.motion).holds
        verdicts.append(state.stable)
    assert {True, False} <= set(verdicts)


@pytest.mark.slow
def test_arches_are_built_one_after_the_other_and_copies_like_the_first():
    one = kilter.plan(arches(0.0))
    order = kilter.plan(arches(0.0, 90.0, 33.0))
    assert (order.verdict, order.holds_max) == ("found", one.holds_max)
    assert order.held_steps == 3 * one.held_steps
    assert order.search.states < one.search.states + 10  # copies need no search
    built = [step.part.split("/")[0] for step in order.steps]
    assert len([k for k in range(1, len(built)) if built[k] != built[k - 1]]) == 2
    assert all(name.startswith(step.part[:2]) for step in order.steps for name in step.held)
    rechecked(order)


@pytest.mark.slow
def test_all_parts_that_fall_alone_are_proved_in_each_group():
    none = kilter.plan(arches(0.0, 20.0), PlanRules(hold=0))
    assert (none.verdict, len(none.falling)) == ("impossible", 2 * 5)
    rechecked(none)


def test_a_group_with_more_weight_is_no_proof_for_its_copy():
    """The second group has the places of the first; its own masses let it fall."""
    plank, counter = Box([4, 1, 0.2]), Box([1, 1, 1])
    parts = [floor([-20, -20], [20, 20])]
    for k, density in enumerate((3000.0, 1500.0, 3000.0)):
        foot = Part(f"{k}/foot", Box([1, 1, 1]), Pose([0, 5.0 * k, 0.5]))
        beam = Part(f"{k}/beam", plank, Pose([1.4, 5.0 * k, 1.1]), density=1000)
        top = Part(f"{k}/top", counter, Pose([0, 5.0 * k, 1.7]), density=density)
        parts += [foot, beam, top]
    order = kilter.plan(Assembly(parts), PlanRules(hold=1))
    assert order.found
    rechecked(order)


def test_a_group_above_another_leaves_first_though_it_is_lower():
    """A tall group stands with its foot under the beam of a low group."""
    tall = [cuboid("foot", [0, 0, 0], [4, 2, 1]), cuboid("mast", [0, 0, 1], [1, 1, 9])]
    low = [cuboid("post", [5, 0, 0], [1, 1, 2]), cuboid("beam", [3, 0, 2], [5, 1, 1])]
    order = kilter.plan(Assembly([floor([-3, -3], [9, 5]), *tall, *low]), UP)
    assert [step.part for step in order.steps] == ["foot", "mast", "post", "beam"]
    rechecked(order)


@pytest.mark.slow
def test_groups_in_the_way_of_each_other_are_taken_apart_together():
    left = [cuboid("a1", [0, 0, 0], [4, 3, 1]), cuboid("a2", [0, 2, 1], [3, 1, 2])]
    left.append(cuboid("a3", [0, 2, 3], [6, 1, 1]))
    right = [cuboid("b1", [5, 0, 0], [4, 3, 2]), cuboid("b2", [3, 0, 2], [6, 1, 1])]
    made = Assembly([floor([-3, -3], [12, 6]), *left, *right])
    assert len(kilter.states(made).groups) == 2
    order = kilter.plan(made, UP)
    places = {step.part: k for k, step in enumerate(order.steps)}
    assert order.found
    assert places["a1"] < places["b2"]
    assert places["b1"] < places["a3"]
    rechecked(order)


@pytest.mark.slow
def test_each_group_carries_the_accelerations():
    """A post of 0.25 m and 1 m carries 0.25 g, and more between its blocks; two of them."""
    parts = [floor([-3, -3], [3, 20])]
    for k in range(2):
        y, wide = 10.0 * k, 0.125
        parts += [
            block(f"{k}/post", [-wide, y - 0.4, 0], [wide, y + 0.4, 1], mass=10.0),
            block(f"{k}/left", [-1, y - 0.4, 0], [-wide, y + 0.4, 0.6], mass=100.0),
            block(f"{k}/right", [wide, y - 0.4, 0], [1, y + 0.4, 0.6], mass=100.0),
        ]
    made = Assembly(parts, friction=0.9)
    before = [(f"{k}/post", f"{k}/{side}") for k in range(2) for side in ("left", "right")]
    rules = PlanRules(carried=[0.3 * 9.81, 0, 0], before=before, directions=[[0, 0, 1]])
    order = kilter.plan(made, rules)
    assert (order.verdict, order.holds_max) == ("found", 1)
    assert order.held_steps >= 2
    assert kilter.plan(made, replace(rules, carried=0.0)).held_steps == 0
    rechecked(order)


def test_precedence_across_groups_is_kept():
    parts = [floor([-3, -3], [12, 6]), cuboid("low", [0, 0, 0], [1, 1, 1])]
    parts.append(cuboid("high", [5, 0, 0], [1, 1, 3]))
    for first, second in (("low", "high"), ("high", "low")):
        order = kilter.plan(Assembly(parts), PlanRules(before=[(first, second)]))
        assert [step.part for step in order.steps] == [first, second]


# Collision tests.


def ring_on_pin(turn_deg: float, at: list[float], name: str, shapes: list[Part]) -> list[Part]:
    """A ring around a pin, which share their shapes with other copies."""
    turn = Pose.from_euler([0, 0, np.radians(turn_deg)], at)
    return [replace(part, name=f"{name}/{part.name}", pose=turn @ part.pose) for part in shapes]


def test_copies_of_a_collision_test_are_tested_once_in_their_own_directions():
    shapes = [
        Part("pin", Cylinder(1.0, 4.0), Pose([0, 0, 2])),
        tube("ring", 1.2, 2.0, 1.0, [0, 0, 2]),
    ]
    made = Assembly(
        [
            floor([-20, -20], [20, 20]),
            *ring_on_pin(0.0, [0, 0, 0], "first", shapes),
            *ring_on_pin(30.0, [8, 3, 0], "second", shapes),
        ]
    )
    found = Sweeps(kilter.contacts(made))
    first, second = made.index_of("first/ring"), made.index_of("second/ring")
    angle = np.radians(30.0)
    turned = (float(np.cos(angle)), float(np.sin(angle)), 0.0)
    for way, copy, blocked in [((1.0, 0.0, 0.0), turned, True), ((0.0, 0.0, 1.0),) * 2 + (False,)]:
        tests = found.tests
        assert found.pair_stops(first, first - 1, way) is blocked
        assert found.pair_stops(second, second - 1, copy) is blocked
        assert found.tests == tests + 1
    assert found.pair_stops(second, second - 1, (0.0, 0.0, 1.0), start=np.array([0.5, 0, -5]))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_the_largest_faces_decide_as_all_faces_do(monkeypatch, seed):
    random = np.random.default_rng(seed)
    parts = [
        Part(f"{k}", Cylinder(*random.uniform(0.3, 1.0, 2)), Pose(random.uniform(0, 4, 3)), k == 0)
        for k in range(5)
    ]
    contacts = kilter.contacts(Assembly(parts))
    ways = [(1.0, 0.0, 0.0), (0.0, 0.6, 0.8), (0.0, 0.0, 1.0)]
    asked = [(p, q, way) for p in range(5) for q in range(5) if p != q for way in ways]
    fast = [Sweeps(contacts).pair_stops(*one) for one in asked]
    monkeypatch.setattr(sweeps, "LARGEST", 10**9)
    assert [Sweeps(contacts).pair_stops(*one) for one in asked] == fast
    assert {True, False} == set(fast)


def test_a_leg_stops_where_any_pair_stops():
    made = arches(0.0)
    found, random = Sweeps(kilter.contacts(made)), np.random.default_rng(1)
    others, answers = np.arange(1, len(made.parts)), []
    for _ in range(60):
        part = int(random.integers(1, len(made.parts)))
        rest = others[others != part]
        way = tuple(np.eye(3)[random.integers(3)].tolist())
        more = {"distance": float(random.uniform(0.1, 3)), "start": random.uniform(-2, 2, 3)}
        expected = any(found.pair_stops(part, int(q), way, **more) for q in rest)
        assert found.leg_stops(part, rest, way, **more) == expected
        answers.append(expected)
    assert {True, False} == set(answers)


# Motions that stated inaccuracy may explain.


@pytest.mark.parametrize(
    ("beyond", "explained", "fast"),
    [(1e-5, True, False), (1e-3, True, False), (2.5e-3, False, False), (0.3, False, True)],
)
def test_a_proved_motion_changes_no_explanation(monkeypatch, beyond, explained, fast):
    """A cube whose centre is a distance beyond the edge of its support tips over."""
    made = Assembly([floor([-5, -5], [0, 5]), cuboid("cube", [beyond - 0.5, 0, 0], [1, 1, 1])])
    monkeypatch.setattr(motion, "stated_accuracy", lambda assembly: np.full(2, 1e-3))
    contacts = kilter.contacts(made)
    program = build_program(made, contacts)
    proof = judge(program).motion
    assert proof is not None
    assert proof.holds
    known = motion.explained_by_accuracy(made, contacts, program, proof.motion)
    assert known == motion.explained_by_accuracy(made, contacts, program)
    assert bool(known) is explained
    force, lever = np.full(2, 2e-3), np.full(2, 2e-3)
    assert motion._too_fast(program, proof.motion, force, lever) is fast
