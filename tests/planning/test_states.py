"""States of half-built assemblies: their verdicts are those of `check`, and carry proofs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from random_friction import random_assembly
from random_turned import random_turned

import kilter
from kilter import Assembly, InputError
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.states import States
from kilter.analysis.verification import verify_proof
from kilter.contact.kept_contacts import contacts_among
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.scenes import scene
from kilter.scenes.arches import arch
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
def test_states_agree_with_check_on_both_sides() -> None:
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
def test_states_under_other_gravity_and_friction_agree_with_check() -> None:
    verdicts = [one for seed in range(4) for one in agree_under(seed, 4)]
    assert {True, False} <= set(verdicts)


@pytest.mark.parametrize(("degrees", "stable"), [(21.7, True), (21.9, False)])
def test_a_direction_and_a_coefficient_are_asked_of_contacts_that_were_found_once(
    degrees: float, stable: bool
) -> None:
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
def test_known_proofs_answer_for_other_states_and_hold_there() -> None:
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


def test_work_is_counted_for_programs_and_far_less_for_known_proofs() -> None:
    found = kilter.states(scene("arch"))
    assert found.units == 0
    assert found.of().stable
    program = found.units
    assert program > 0
    assert found.of(held=["voussoir-1"]).stable
    assert (found.counts["programs"] + found.counts["cones"], found.counts["known"]) == (1, 1)
    assert 0 < found.units - program < program / 2


def test_evidence_speaks_of_the_rows_of_the_state_alone() -> None:
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
def test_exact_cones_decide_what_a_pyramid_does_not(friction: float, stable: bool) -> None:
    """A block on a slope of 17 degrees, tan 17 = .3057, that runs askew to the rays of a pyramid.

    Four rays hold cos 45 / cos 22.5 = .77 of mu there: neither coefficient holds it by them.
    """
    flat = block_on_slope(0.0, friction=friction)
    angle, way = np.radians(17), np.radians(22.5)
    down = [np.sin(angle) * np.cos(way), np.sin(angle) * np.sin(way), -np.cos(angle)]
    found = kilter.states(flat.with_down(down))
    assert found.of().stable == stable
    assert found.counts["cones"] == 1


@pytest.mark.slow
def test_holding_more_never_hurts_and_a_held_part_may_be_added() -> None:
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
def test_contacts_of_some_parts_are_those_found_of_them_alone(name: str) -> None:
    whole = scene(name)
    contacts, random = kilter.contacts(whole), np.random.default_rng(2)
    for _ in range(3):
        free = [part.name for part in whole if not part.grounded]
        gone = random.choice(free, size=max(1, len(free) // 3), replace=False)
        sub = whole.without(gone.tolist())
        taken, found = contacts_among(contacts, sub).to_dict(), kilter.contacts(sub).to_dict()
        for key in ("patches", "unsupported", "overlaps", "open_pairs", "fits", "joints"):
            assert taken[key] == found[key], key


def test_wrong_input() -> None:
    found = kilter.states(scene("tower"))
    with pytest.raises(InputError, match="no part is named"):
        found.of(["nobody"])
    with pytest.raises(InputError, match="held but not present"):
        found.of(["base"], held="cube-1")
    with pytest.raises(TypeError, match=r"use \.stable"):
        bool(found.of())


def test_what_falls_is_named_where_check_decided() -> None:
    verdict = kilter.check(scene("paper-figure-8"))
    program = verdict.program
    present = np.ones(len(program.names), dtype=bool)
    state = kilter.State(program.names, present, program.free, False, program, verdict=verdict)
    assert state.moving == verdict.moving == ["C2", "C3"]


def test_large_states_are_judged_in_cones_and_small_ones_by_the_kept_program() -> None:
    """A wall with friction: from nothing, then its lowest bricks, which no forces known hold."""
    found = kilter.states(scene("wall").with_friction(0.3))
    whole = np.ones(len(found.assembly), dtype=bool)
    assert found.judge(whole, ~whole).stable
    assert (found.counts["cones"], found.counts["programs"]) == (1, 0)
    low = whole.copy()
    low[np.flatnonzero(~found.assembly.geometry.grounded)[12:]] = False
    assert found.judge(low, ~whole).stable
    assert (found.counts["cones"], found.counts["programs"]) == (1, 1)
