"""States of an assembly: as `check`, open ones, pressed and carried ones."""

from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from random_friction import random_assembly
from random_turned import random_turned
from read_proofs import proof_of, reasons, signed

import kilter
from kilter import Assembly, InputError, Load, Mesh, Part, PlanRules, State, States
from kilter.analysis.planning.order.plan import SIDES, extreme_accelerations
from kilter.analysis.verification import verify_proof
from kilter.cli import main
from kilter.contact.kept_contacts import contacts_among
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.pieces import block
from kilter.scenes.stacks import block_on_slope


def irregular(seed: int) -> Assembly:
    """One of several families, turned at random, with and without friction."""
    family = seed % 4
    if family == 3:
        return random_assembly(seed)[1]
    return random_turned(("arch", "pile", "wedge")[family], seed)


def random_state(random: np.random.Generator, found: States) -> State:
    """Some parts present, some of these held; what is grounded mostly stays."""
    grounded = found.assembly.geometry.grounded
    present = (random.random(len(grounded)) < 0.8) | grounded
    return found.judge(present, present & (random.random(len(grounded)) < 0.25))


def rechecked(found: States, state: State) -> None:
    """The evidence of a state, judged again by those who know nothing of states."""
    if state.stable is None:
        return
    proof = found.proof(state)
    sub = found.sub_assembly(state)
    again = verify_proof(sub, kilter.contacts(sub), proof)
    assert again.holds, again.reasons
    assert (again.verdict == "unstable") == (state.stable is False)


def agree(seed: int, count: int) -> list[bool | None]:
    """Verdicts of random states, each held against `check` of the same parts."""
    random = np.random.default_rng(seed)
    found = kilter.states(irregular(seed))
    verdicts = []
    for _ in range(count):
        state = random_state(random, found)
        sub = found.sub_assembly(state)
        if not state.free.any():
            continue
        told = kilter.check(sub, require="equilibrium", effort=0)
        expected = None if told.verdict == "undecided" else told.stable
        assert state.stable == expected, (seed, state, told)
        rechecked(found, state)
        verdicts.append(state.stable)
    return verdicts


@pytest.mark.slow
def test_states_agree_with_check_on_both_sides():
    verdicts = [one for seed in range(4) for one in agree(seed, 3)]
    assert {True, False} <= set(verdicts)


def agree_under(seed: int, count: int) -> list[bool | None]:
    """Verdicts under random gravity and friction, each held against `check` of a new assembly."""
    random = np.random.default_rng(seed)
    found = kilter.states(irregular(seed))
    down, verdicts = found.assembly.down, []
    for k in range(count):
        turned = (down + 0.3 * random.normal(size=3)) * [1, not found.assembly.planar, 1]
        mu = None if k % 2 else float(random.uniform(0, 0.8))
        under = found.under(down=turned, friction=mu)
        state = random_state(random, under)
        if not state.free.any():
            continue
        names = np.array(found.assembly.names)
        held = names[state.present & ~state.free]
        assert found.of(names[state.present], held, down=turned, friction=mu) is state
        sub = found.assembly.without(names[~state.present].tolist()) if (
            not state.present.all()) else found.assembly  # fmt: skip
        sub = (sub.with_grounded(held.tolist()) if len(held) else sub).with_down(turned)
        touching = kilter.contacts(sub)
        touching = touching if mu is None else touching.with_friction(mu)
        told = kilter.check(sub, contacts=touching, require="equilibrium", effort=0)
        assert state.stable == (None if told.verdict == "undecided" else told.stable), (seed, k)
        verdicts.append(state.stable)
    return verdicts


@pytest.mark.slow
def test_states_under_other_gravity_and_friction_agree_with_check():
    verdicts = [one for seed in range(4) for one in agree_under(seed, 4)]
    assert {True, False} <= set(verdicts)


@pytest.mark.parametrize(("degrees", "stable"), [(21.7, True), (21.9, False)])
def test_a_direction_and_a_coefficient_are_asked_of_contacts_that_were_found_once(degrees, stable):
    """A block on a plane: tan 21.80 = .4."""
    found, angle = kilter.states(block_on_slope(0.0)), np.radians(degrees)
    down = [np.sin(angle), 0, -np.cos(angle)]
    assert found.of(down=down, friction=0.4).stable == stable
    assert found.of(down=down).stable is False
    assert found.of(friction=0.4).stable
    with pytest.raises(InputError, match="friction is -1"):
        found.of(friction=-1)
    with pytest.raises(InputError, match="down"):
        found.of(down=[0, 0, 0])


@pytest.mark.slow
def test_known_proofs_answer_for_other_states_and_hold_there():
    """Every state of an arch that lacks voussoirs at random: most need no program of their own."""
    found, random = kilter.states(arch(9, ratio=0.3, friction=0.6)), np.random.default_rng(0)
    for _ in range(120):
        state = random_state(random, found)
        evidence = state.forces or state.motion
        assert evidence is not None
        assert evidence.holds
        fresh: Any = States(found.assembly, found.contacts).judge(
            state.present, state.present & ~state.free
        )
        assert fresh.stable == state.stable
    assert found.counts["known"] > found.counts["programs"]


def test_work_is_counted_for_programs_and_far_less_for_known_proofs():
    found = kilter.states(scene("arch"))
    assert found.units == 0
    assert found.of().stable
    program = found.units
    assert program > 0
    assert found.of(held=["voussoir-1"]).stable
    assert (found.counts["programs"] + found.counts["cones"], found.counts["known"]) == (1, 1)
    assert 0 < found.units - program < program / 2


def test_evidence_speaks_of_the_rows_of_the_state_alone():
    found = kilter.states(scene("arch"))
    here = [name for name in found.assembly.names if name != "voussoir-10"]
    falls, held = found.of(here), found.of(here, held=["voussoir-9", "voussoir-11"])
    assert (falls.stable, held.stable) == (False, True)
    assert falls.motion is not None
    assert held.forces is not None
    gone = found.assembly.index_of("voussoir-10")
    assert not falls.motion.motion[gone].any()
    assert gone not in set(held.program.part_a) | set(held.program.part_b)
    assert check_motion(falls.program, falls.motion.motion).holds
    assert check_forces(held.program, held.forces.forces, held.forces.friction).holds
    assert set(falls.moving) <= set(here)


@pytest.mark.parametrize(("friction", "stable"), [(0.305, False), (0.32, True)])
def test_exact_cones_decide_what_a_pyramid_does_not(friction, stable):
    """A block on a slope of 17 degrees, tan 17 = .3057, that runs askew to the rays of a pyramid.

    Four rays hold cos 45 / cos 22.5 = .77 of mu there: neither coefficient holds it by them.
    """
    flat = block_on_slope(0.0, friction=friction)
    angle, way = np.radians(17), np.radians(22.5)
    down = [np.sin(angle) * np.cos(way), np.sin(angle) * np.sin(way), -np.cos(angle)]
    found = kilter.states(flat.with_down(down))
    assert found.of().stable == stable
    assert (found.counts["cones"], found.counts["paths"]) == (1 - stable, stable)
    pushed = replace(flat, loads=[Load("block", force=[1e-6, 0.0, 0.0])]).with_down(down)
    found = kilter.states(pushed)
    assert found.of().stable == stable
    assert (found.counts["cones"], found.counts["paths"]) == (1, 0)


@pytest.mark.slow
def test_holding_more_never_hurts_and_a_held_part_may_be_added():
    """F1 and F2 of planning, on random states of an arch."""
    found, random = kilter.states(arch(9, ratio=0.3, friction=0.6)), np.random.default_rng(1)
    held_more = 0
    for _ in range(60):
        state = random_state(random, found)
        free = np.flatnonzero(state.free)
        absent = np.flatnonzero(~state.present)
        held = state.present & ~state.free
        if not state.stable:
            continue
        if len(free):
            more = held.copy()
            more[random.choice(free)] = True
            assert found.judge(state.present, more).stable
            held_more += 1
        if len(absent):
            also = np.zeros(len(held), dtype=bool)
            also[random.choice(absent)] = True
            assert found.judge(state.present | also, held | also).stable
    assert held_more > 10


@pytest.mark.quick(1)
@pytest.mark.parametrize("name", ["tower", "three-cylinders", "box-pile", "bracket"])
def test_contacts_of_some_parts_are_those_found_of_them_alone(name):
    whole = scene(name)
    contacts, random = kilter.contacts(whole), np.random.default_rng(2)
    for _ in range(3):
        free = [part.name for part in whole if not part.grounded]
        gone = random.choice(free, size=max(1, len(free) // 3), replace=False)
        sub = whole.without(gone.tolist())
        taken, found = contacts_among(contacts, sub).to_dict(), kilter.contacts(sub).to_dict()
        for key in ("patches", "unsupported", "overlaps", "open_pairs", "fits", "joints"):
            assert taken[key] == found[key], key


def test_wrong_input():
    found = kilter.states(scene("tower"))
    with pytest.raises(InputError, match="no part is named"):
        found.of(["nobody"])
    with pytest.raises(InputError, match="held but not present"):
        found.of(["base"], held="cube-1")
    with pytest.raises(TypeError, match=r"use \.stable"):
        bool(found.of())


def test_what_falls_is_named_where_check_decided():
    verdict = kilter.check(scene("paper-figure-8"))
    program = verdict.program
    present = np.ones(len(program.names), dtype=bool)
    state = kilter.State(program.names, present, program.free, False, program, verdict=verdict)
    assert state.moving == verdict.moving == ["C2", "C3"]


def test_large_states_are_judged_in_cones_and_small_ones_by_the_kept_program():
    """A wall with friction and a held brick: all of it, then its lowest bricks alone."""
    found = kilter.states(scene("wall").with_friction(0.3))
    whole = np.ones(len(found.assembly), dtype=bool)
    free = np.flatnonzero(~found.assembly.geometry.grounded)
    held = ~whole
    held[free[0]] = True
    assert found.judge(whole, held).stable
    assert (found.counts["cones"], found.counts["programs"]) == (1, 0)
    low = whole.copy()
    low[free[12:]] = False
    assert found.judge(low, held).stable
    assert (found.counts["cones"], found.counts["programs"]) == (1, 1)


@pytest.mark.parametrize(("reach", "held"), [(1.39, True), (1.41, False)])
def test_forces_along_gravity_hold_a_beam_that_a_counterweight_keeps_down(reach, held):
    """A beam of 3 kg, its middle at x = reach beyond a pier that ends at x = 1, and a weight on it.

    The weight of 2 kg lies on the end above the pier, at x = reach - 1. The common centre of mass
    (3 reach + 2 (reach - 1)) / 5 = reach - .4 is on the pier up to reach = 1.4.
    """
    left = reach - 1.5
    pier = block("pier", (0, 0, 0), (1, 1, 1), grounded=True)
    beam = block("beam", (left, 0, 1), (left + 3, 1, 2), mass=3.0)
    weight = block("weight", (left, 0, 2), (left + 1, 1, 3), mass=2.0)
    found = kilter.states(Assembly([pier, beam, weight]))
    assert found.of().stable is held
    assert found.counts["paths"] == held
    assert found.of(["pier", "beam"]).stable is False


def test_a_state_of_a_layered_structure_is_held_by_forces_along_gravity_alone():
    """Every state of a running-bond wall from which the highest bricks are gone, by no program."""
    found = kilter.states(scene("wall"))
    grounded = found.assembly.geometry.grounded
    height = found.assembly.geometry.center[:, 2]
    for level in np.unique(height[~grounded].round(6)):
        state = found.judge(grounded | (height < level + 1e-3), np.zeros(len(grounded), dtype=bool))
        assert state.stable
        rechecked(found, state)
    assert found.counts["paths"] == found.counts["asked"] == 6
    assert not found.counts["programs"]
    assert not found.counts["cones"]


def test_forces_along_gravity_prove_nothing_that_falls():
    """A wall with an unsupported brick falls, and a slope holds up to the angle of friction."""
    falls = kilter.states(scene("wall-with-opening"))
    assert falls.of().stable is False
    assert not falls.counts["paths"]
    for friction, stable in ((0.57, False), (0.58, True)):  # tan 30 deg = 0.5774
        slope = kilter.states(block_on_slope(30.0, friction=friction))
        assert slope.of().stable is stable
        assert slope.counts["paths"] == stable


FACES = [[0, 1, 2, 3], [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]


def ringed_dome(count: int, elevations: tuple[float, ...]) -> Assembly:
    """Rings of `count` wedge-shaped stones, radii 4.5 and 5 m, joints in line, the lowest held."""
    turns, rises = np.linspace(0, 2 * np.pi, count + 1), np.radians(elevations)
    parts = []
    for ring, k in product(range(len(rises) - 1), range(count)):
        corners = [(turns[k + a], rises[ring + b]) for a, b in ((0, 0), (0, 1), (1, 1), (1, 0))]
        points = [
            [r * np.cos(e) * np.cos(t), r * np.cos(e) * np.sin(t), r * np.sin(e)]
            for r in (4.5, 5.0)
            for t, e in corners
        ]
        parts.append(Part(f"stone-{ring}-{k}", Mesh(points, FACES), grounded=ring == 0))
    return Assembly(parts, friction=0.7)


@pytest.fixture(scope="module")
def dome() -> States:
    return kilter.states(ringed_dome(6, (0, 24, 46, 66)))


@pytest.mark.slow
def test_a_state_that_hangs_on_edges_is_left_open_without_a_check(dome):
    """The upper ring with one stone of six in place, which tips in but for edges beside it."""
    names = [name for name in dome.assembly.names if name[:7] != "stone-2"] + ["stone-2-0"]
    state = dome.of(names)
    told = kilter.check(dome.sub_assembly(state), require="equilibrium", effort=0)
    assert told.verdict == "undecided"
    assert state.stable is None
    assert (dome.counts["open"], dome.counts["checks"]) == (1, 0)
    with pytest.raises(kilter.InputError):
        dome.proof(state)


@pytest.mark.slow
def test_verdicts_where_edges_meet_are_those_of_check(dome):
    random, verdicts = np.random.default_rng(0), set()
    grounded = dome.assembly.geometry.grounded
    for share in (0.2, 0.4, 0.6, 0.8, 0.9):
        present = (random.random(len(grounded)) < share) | grounded
        state = dome.judge(present, present & (random.random(len(grounded)) < 0.3))
        told = kilter.check(dome.sub_assembly(state), require="equilibrium", effort=0)
        assert state.stable == (None if told.verdict == "undecided" else told.stable)
        verdicts.add(state.stable)
    assert len(verdicts) > 1


@pytest.mark.slow
def test_a_search_among_open_states_ends_by_its_work():
    order = kilter.plan(ringed_dome(6, (0, 24, 46, 66)), effort=0.01)
    assert order.verdict == "none-found"
    assert order.states.counts["open"] > 0


REACH, OUT = 3.0, 2.25
"""The plank reaches from -3 to 3 over an edge at 1; the weight stands at 2.25, over the void."""


def plank(*, weight: float = 1.0) -> Assembly:
    """A plank of 10 kg over an edge, and a weight on its free end."""
    return Assembly(
        [
            block("table", [-4, -1, -1], [1, 1, 0], grounded=True),
            block("plank", [-REACH, -1, 0], [REACH, 1, 0.5], mass=10.0),
            block("weight", [OUT - 0.25, -0.25, 0.5], [OUT + 0.25, 0.25, 1], mass=weight),
        ]
    )


def tipping() -> float:
    """The force on the weight at which the plank tips about the edge [N]."""
    g = float(np.linalg.norm(plank().gravity))
    return (10.0 * g * 1.0) / (OUT - 1.0) - 1.0 * g


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_a_plank_tips_beyond_a_force(share):
    order = kilter.plan(
        plank(), kilter.PlanRules(press=share * tipping(), hold=0, directions=[[0, 0, 1]])
    )
    assert order.found == (share < 1)
    if order.found:
        assert not reasons(order, proof_of(order))


def test_a_hold_takes_what_the_plank_does_not():
    order = kilter.plan(plank(), kilter.PlanRules(press=1.01 * tipping(), directions=[[0, 0, 1]]))
    assert [step.held for step in order.steps] == [(), ("plank",)]
    proof = proof_of(order)
    assert not reasons(order, proof)
    [pressed] = [one for one in proof["proofs"] if one["about"] == "pressed" and one["step"] == 2]
    pressed["change"]["loads"][-1]["force"][2] *= 0.5
    assert "step 2: the proof has another pressing force" in reasons(order, proof)


@pytest.mark.slow
def test_a_proof_without_its_pressed_states_is_refused():
    order = kilter.plan(scene("tower"), kilter.PlanRules(press=5.0))
    proof = proof_of(order)
    assert not reasons(order, proof)
    proof["proofs"] = [one for one in proof["proofs"] if one["about"] != "pressed"]
    assert "not every step has a proof with the pressing force" in reasons(order, proof)


def test_a_sequence_says_where_it_cannot_be_pressed():
    order = kilter.plan(
        plank(),
        kilter.PlanRules(
            press=1.01 * tipping(), hold=0, directions=[[0, 0, 1]], sequence=["plank", "weight"]
        ),
    )
    assert [step.fails for step in order.steps] == [
        (), ("the standing parts do not withstand the pressing force",)
    ]  # fmt: skip


def test_no_force_is_none():
    assert all(step.pressed is None for step in kilter.plan(scene("tower")).steps)
    with pytest.raises(InputError, match="press"):
        kilter.plan(scene("tower"), kilter.PlanRules(press=-1.0))


G = 9.81
WIDTH, HEIGHT = 0.2, 0.8
"""The post alone tips at WIDTH / HEIGHT = 0.25 g."""


def stack(count: int = 3) -> Assembly:
    """A tower of cubes on a deck, which tips at g / count along an axis."""
    cubes = [block(f"cube-{k}", [0, 0, k], [1, 1, k + 1]) for k in range(count)]
    deck = block("deck", [-3, -3, -1], [4, 4, 0], grounded=True)
    return Assembly([deck, *cubes], friction=0.9)


def post_in_a_vice() -> Assembly:
    """A post that tips at 0.25 g along x alone, between two blocks that keep it upright."""
    return Assembly(
        [
            block("deck", [-2, -2, -1], [2, 2, 0], grounded=True),
            block("post", [-WIDTH / 2, -0.4, 0], [WIDTH / 2, 0.4, HEIGHT], mass=10.0),
            block("left", [-1, -0.4, 0], [-WIDTH / 2, 0.4, 0.6], mass=100.0),
            block("right", [WIDTH / 2, -0.4, 0], [1, 0.4, 0.6], mass=100.0),
        ],
        friction=0.9,
    )


@pytest.mark.quick(2)
@pytest.mark.parametrize("share", [0.999, 1.001])
def test_a_tower_carries_its_closed_form_as_a_vector(share):
    order = kilter.plan(stack(), PlanRules(carried=[share * G / 3, 0, 0], hold=0))
    assert order.verdict == ("found" if share < 1 else "impossible")
    proof = proof_of(order)
    assert not reasons(order, proof)
    if share > 1:
        assert "at a required acceleration" in order.to_dict()["sentence"]


def test_every_horizontal_direction_is_covered_by_the_corners():
    corners = extreme_accelerations(stack(), 2.0)
    angle = np.linspace(0, 2 * np.pi, 721)
    circle = 2.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    edges = np.roll(corners[:, :2], -1, axis=0) - corners[:, :2]
    outward = np.column_stack([edges[:, 1], -edges[:, 0]])
    outward *= np.sign(np.einsum("ij,ij->i", outward, corners[:, :2]))[:, None]
    reach = np.einsum("ij,ij->i", outward, corners[:, :2])
    assert (circle @ outward.T <= reach + 1e-12).all()
    assert len(corners) == SIDES


def test_a_post_is_held_until_its_blocks_stand():
    """Between its blocks the post carries 0.3 g, alone only 0.25 g, so it is held before."""
    assembly = post_in_a_vice()
    rules = {"before": [("post", "left"), ("post", "right")], "directions": [[0, 0, 1]]}
    still = kilter.plan(assembly, PlanRules(**rules))  # type: ignore[arg-type]
    assert still.holds_max == 0
    order = kilter.plan(assembly, PlanRules(carried=[0.3 * G, 0, 0], **rules))  # type: ignore[arg-type]
    assert order.found
    assert [step.held for step in order.steps[1:]] in ([("post",), ()], [("post",), ("post",)])
    proof = proof_of(order)
    assert not reasons(order, proof)
    assert any(entry["about"] == "not fewer" for entry in proof["proofs"])
    without = {**proof, "proofs": [e for e in proof["proofs"] if e["about"] != "carried"]}
    wrong = reasons(order, signed(without))
    assert "step 2 is not proved at every required acceleration" in wrong
    other = proof_of(order)
    other["rules"]["carried"] = [[0.4 * G, 0, 0]]
    wrong = reasons(order, signed(other))
    assert "at an acceleration that the rules do not require" in wrong


def test_the_command_states_what_is_carried(tmp_path, capsys):
    path, proof = tmp_path / "stack.kilter.json", tmp_path / "p.json"
    kilter.dump(stack(2), path)
    words = ["plan", str(path), "--carried", "0.4g,0,0", "--proof", str(proof)]
    assert main(words) == 0
    assert "(3.924, 0, 0) m/s^2" in capsys.readouterr().out
    assert main(["verify", str(path), str(proof)]) == 0
    assert main(["plan", str(path), "--carried", "0.6g,0,0"]) == 1


@pytest.mark.parametrize(
    ("value", "message"),
    [(-1.0, "carried"), ([0, 0, -G], "falls freely"), ([0, np.inf, 0], "finite")],
)
def test_wrong_accelerations_are_refused(value, message):
    with pytest.raises(InputError, match=message):
        kilter.plan(stack(), PlanRules(carried=value))  # type: ignore[arg-type]


def test_turns_are_not_combined_with_accelerations():
    with pytest.raises(InputError, match="turns cannot be combined"):
        PlanRules(carried=1.0, turn=True)
