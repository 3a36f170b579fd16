"""Fewest holds: those of enumeration, with motions that show that fewer are not enough."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from random_turned import random_turned

import kilter
from kilter import Assembly
from kilter.analysis.decision.judge import judge
from kilter.analysis.planning.states.holds import Holds
from kilter.analysis.planning.states.state import State
from kilter.analysis.planning.states.state_programs import build_state_programs
from kilter.analysis.planning.states.states import States
from kilter.analysis.smallest_set import least_hitting_set
from kilter.analysis.verification import verify_proof
from kilter.scenes import scene
from kilter.scenes.arches import arch
from kilter.scenes.stacks import staircase


def enumerated(found: States, present: np.ndarray) -> int | None:
    """The fewest holds by trying every set, each judged in exact cones by itself."""
    programs = build_state_programs(found.assembly, found.contacts)
    free = np.flatnonzero(programs.free & present)
    for size in range(len(free) + 1):
        for chosen in combinations(free, size):
            held = np.zeros(len(present), dtype=bool)
            held[list(chosen)] = True
            told = judge(programs.of(present, held)).stable
            if told is None:
                return None
            if told:
                return size
    raise AssertionError("all held, and it falls")


def small_assemblies() -> list[Assembly]:
    return [
        arch(7, ratio=0.3, friction=0.6),
        arch(6, ratio=0.2, friction=0.3),
        arch(7, ratio=0.3, friction=0.25),
        scene("paper-figure-9").with_friction(0.1),
        scene("pit-wedges"),
        staircase(5, offset=0.4),
        random_turned("arch", 1),
        random_turned("wedge", 2),
    ]


def shown(found: States, holds: Holds[State]) -> None:
    """That fewer are not enough: each motion judged anew, and no smaller set stops all."""
    for cut in holds.cuts:
        assert cut.state.stable is False
        assert not (cut.state.moves & ~cut.parts).any()
        sub = found.sub_assembly(cut.state)
        again = verify_proof(sub, kilter.contacts(sub), found.proof(cut.state))
        assert again.holds, again.reasons
        assert again.verdict == "unstable"
    sets = [set(np.flatnonzero(cut.parts)) for cut in holds.cuts]
    parts = sorted(set().union(*sets))
    if sets:
        for fewer in combinations(parts, min(holds.least - 1, len(parts))):
            assert any(not one & set(fewer) for one in sets)


def agree(count: int, *, verify: bool) -> list[int]:
    """Fewest holds of random states, each against enumeration."""
    random, sizes = np.random.default_rng(0), []
    all_states = [kilter.states(assembly) for assembly in small_assemblies()]
    while len(sizes) < count:
        found = all_states[int(random.integers(len(all_states)))]
        grounded = found.assembly.geometry.grounded
        present = (random.random(len(grounded)) < 0.7) | grounded
        expected = enumerated(found, present)
        if expected is None:
            continue
        names = [name for name, here in zip(found.assembly.names, present, strict=True) if here]
        holds = found.fewest_holds(names)
        assert holds.fewest
        assert holds.held is not None
        assert holds.state is not None
        assert holds.state.stable
        assert int(holds.held.sum()) == holds.least == expected
        if verify:
            shown(found, holds)
        if expected:
            less = found.fewest_holds(names, most=expected - 1)
            assert (less.held, less.least) == (None, expected)
        sizes.append(expected)
    return sizes


@pytest.mark.slow
def test_fewest_holds_are_those_of_enumeration() -> None:
    assert len(set(agree(8, verify=True))) > 1


@pytest.mark.parametrize(("friction", "sides", "most"), [(0.6, "one", 1), (0.6, "both", 2)])
def test_an_arch_built_from_one_side_or_both(friction: float, sides: str, most: int) -> None:
    """Most holds over the orders of `plan`'s known answers: 1 from one side, 2 from both."""
    count = 9
    found = kilter.states(arch(count, ratio=0.3, friction=friction))
    order = list(range(count))
    if sides == "both":
        order.sort(key=lambda k: min(k, count - 1 - k))
    needed = [
        found.fewest_holds(["springer*", *(f"voussoir-{k}" for k in order[:stand])]).least
        for stand in range(1, count + 1)
    ]
    assert max(needed) == most
    assert needed[-1] == 0


def test_parts_that_may_not_be_held() -> None:
    found = kilter.states(arch(9, ratio=0.3, friction=0.6))
    gap = [name for name in found.assembly.names if name != "voussoir-4"]
    free = found.fewest_holds(gap)
    assert free.least == 2
    cut = next(cut for cut in free.cuts)
    barred = {found.assembly.names[k] for k in np.flatnonzero(cut.parts)}
    others = [name for name in gap if name not in barred]
    none = found.fewest_holds(gap, among=others)
    assert none.parts is None
    assert any(set(none_cut.state.moving) <= barred for none_cut in none.cuts)


@pytest.mark.quick(24)
@pytest.mark.parametrize("seed", range(30))
def test_least_hitting_sets_by_brute_force(seed: int) -> None:
    random = np.random.default_rng(seed)
    sets = [int(random.integers(1, 2**8)) for _ in range(int(random.integers(1, 9)))]
    best = min((k for k in range(2**8) if all(k & one for one in sets)), key=int.bit_count)
    found = least_hitting_set(sets, 8)
    assert found is not None
    assert all(found & one for one in sets)
    assert found.bit_count() == best.bit_count()
    assert least_hitting_set(sets, best.bit_count() - 1) is None
