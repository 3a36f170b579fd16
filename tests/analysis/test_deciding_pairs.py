"""Open pairs that decide: the set holds, none can be left out, and the work is limited."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from random_voronoi import random_voronoi
from staggered_dome import staggered_dome

from kilter import Assembly
from kilter.analysis.decision import deciding_pairs
from kilter.analysis.decision.deciding_pairs import DecidingPairs, find_deciding
from kilter.analysis.decision.joining_wrenches import joining_wrenches
from kilter.analysis.decision.judge import judge
from kilter.arrays import Index, connected
from kilter.contact import ContactSet, contacts
from kilter.contact.open_pairs import OpenPair, rigid_groups
from kilter.mechanics.merged_parts import merge_parts
from kilter.mechanics.program import Program, build_program
from kilter.scenes.pieces import block


def joined(program: Program, group: Index, pairs: list[OpenPair]) -> bool | None:
    """Whether forces of equilibrium exist with these pairs joined, by a program of its own."""
    ends = np.array([pair.ends for pair in pairs], dtype=np.int64).reshape(-1, 2)
    same = np.argmax(group[:, None] == group[None], axis=1)
    first = np.concatenate([np.arange(len(group)), ends[:, 0]])
    label = connected(len(group), first, np.concatenate([same, ends[:, 1]]))
    bodies = np.unique(label, return_inverse=True)[1].reshape(-1)
    return judge(merge_parts(program, bodies)).stable


def opened(assembly: Assembly, seed: int) -> tuple[Program, Index, list[OpenPair]]:
    """The program without the contacts of random pairs, and these pairs as open pairs."""
    random = np.random.default_rng(seed)
    touching: ContactSet = contacts(assembly)
    pairs = np.unique(np.sort(touching.patch_parts, axis=1), axis=0)
    chosen = pairs[random.random(len(pairs)) < 0.6]
    kinds = random.choice(["overlap", "near", "clearance"], len(chosen))
    open_pairs = [
        OpenPair((int(a), int(b)), kind, gap=float(random.uniform(0, 1e-3)))
        for (a, b), kind in zip(chosen, kinds, strict=True)
    ]
    program = build_program(assembly, touching)
    ends = np.sort(np.column_stack([program.part_a, program.part_b]), axis=1)
    is_open = (ends[:, None] == chosen[None]).all(axis=2).any(axis=1)
    return program.taking(np.flatnonzero(~is_open)), rigid_groups(assembly), open_pairs


def asserted(program: Program, group: Index, answer: DecidingPairs) -> None:
    """The set holds, and if it is called irreducible, no pair can be left out."""
    pairs = list(answer.pairs)
    assert joined(program, group, pairs) is True
    if answer.irreducible:
        for k in range(len(pairs)):
            assert joined(program, group, pairs[:k] + pairs[k + 1 :]) is False


def asked(seed: int, most: int) -> None:
    """Compare the search on a random assembly with all subsets of its open pairs."""
    program, group, pairs = opened(random_voronoi(seed), seed)
    if judge(program).stable is not False:
        return
    answer = find_deciding(program, group, pairs)
    if answer is None:
        assert joined(program, group, pairs) is not True
        return
    asserted(program, group, answer)
    assert answer.irreducible
    if len(pairs) > most:
        return
    sizes = (
        size
        for size in range(len(pairs) + 1)
        if any(joined(program, group, list(some)) for some in combinations(pairs, size))
    )
    least = next(sizes)
    assert len(answer.pairs) >= least
    assert not answer.smallest or len(answer.pairs) == least


@pytest.mark.parametrize("most", [0, 12])
@pytest.mark.quick(1)
@pytest.mark.parametrize("block", range(6))
def test_random_sets_decide_and_agree_with_all_subsets(
    block: int, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(deciding_pairs, "MOST", most)
    for seed in range(10 * block, 10 * block + 10):
        asked(seed, 7)


@pytest.mark.quick(2)
@pytest.mark.parametrize("rows", [1, 2000, 10**6])
def test_a_search_that_stops_reports_a_set_that_holds(
    rows: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    assembly = staggered_dome(1, rings=5, per_ring=10)
    touching = contacts(assembly)
    assert {pair.kind for pair in touching.open_pairs} == {"overlap"}
    assert len(touching.open_pairs) == 2 * 4 * 10
    program, group = build_program(assembly, touching), rigid_groups(assembly)
    monkeypatch.setattr(deciding_pairs, "FREE_ROWS", rows)
    monkeypatch.setattr(deciding_pairs, "JUDGEMENTS", 0)
    answer = find_deciding(program, group, touching.open_pairs)
    assert answer is not None
    asserted(program, group, answer)
    assert answer.irreducible == (rows == 10**6)
    assert not answer.smallest


def test_the_least_wrench_of_a_single_pair_is_the_weight_and_its_torque() -> None:
    assembly = staggered_dome(2, rings=2, per_ring=8)
    group = rigid_groups(assembly)
    program = build_program(assembly, contacts(assembly)).taking(np.empty(0, np.int64))
    free = np.flatnonzero(program.free)
    # each free block hangs by a wrench at its held neighbour, whose mass is smaller or larger
    held = np.flatnonzero(~program.free)
    ends = np.column_stack([held[: len(free)], free])
    norms = joining_wrenches(program, ends)
    assert norms is not None
    smaller = np.where(program.radius[ends[:, 0]] <= program.radius[free], ends[:, 0], free)
    unit = np.exp(np.log(program.weight[free]).mean())
    arm = program.center[free] - program.center[smaller]
    torque = np.linalg.norm(np.cross(arm, [0.0, 0.0, -1.0]), axis=1) / program.radius[smaller]
    expected = program.weight[free] / unit * np.hypot(1.0, torque)
    assert norms == pytest.approx(expected, rel=1e-6)
    assert len(np.unique(group)) == len(free) + 1


@pytest.mark.slow
def test_a_dome_of_a_thousand_pairs_is_searched_within_its_work() -> None:
    assembly = staggered_dome(0)
    touching = contacts(assembly)
    assert len(touching.open_pairs) == 1008
    program, group = build_program(assembly, touching), rigid_groups(assembly)
    answer = find_deciding(program, group, touching.open_pairs)
    assert answer is not None
    assert joined(program, group, list(answer.pairs)) is True
    assert answer.programs < 300


@pytest.mark.parametrize(("play", "first"), [(0.01, "plate"), (0.5, "nut")])
def test_a_clearance_too_wide_for_a_fit_is_the_last_to_be_asked_about(play, first) -> None:
    """A screw that hangs between a plate with a hole and a nut of free-form threads, both held."""
    parts = [block(name, [3 * k, 0, 0], [3 * k + 1, 1, 1]) for k, name in enumerate("abc")]
    names = ("plate", "nut", "screw")
    held = [
        replace(part, name=n, grounded=n != "screw") for part, n in zip(parts, names, strict=True)
    ]
    assembly = Assembly(held)
    pairs = [OpenPair((0, 2), "clearance", gap=play), OpenPair((1, 2), "free-form", gap=0.0)]
    program = build_program(assembly, contacts(assembly))
    answer = find_deciding(program, rigid_groups(assembly), pairs)
    assert answer is not None
    assert answer.smallest
    assert [names[pair.ends[0]] for pair in answer.pairs] == [first]
