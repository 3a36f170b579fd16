"""Stacks of boxes are decided from the top down, without a program: proofs, sides, independence."""

import dataclasses

import numpy as np
import pytest

from kilter import Assembly, Box, Part, Pose, check_many
from kilter.analysis.many import verdicts as decided_together
from kilter.assembly.array_geometry import side_by_side
from kilter.contact import Tolerance, contacts
from kilter.contact.detect import contacts_side_by_side
from kilter.mechanics.certificate import ForceProof, check_forces
from kilter.mechanics.program import build_program
from kilter.mechanics.program_blocks import ProgramBlocks, program_blocks
from kilter.solvers.highs import solve_blocks

FLOOR = Part("floor", Box([20, 20, 1]), Pose([0, 0, -0.5]), grounded=True)


def stacks(seed: int, count: int = 6) -> Assembly:
    """Random boxes, each on the floor or on the box before."""
    random = np.random.default_rng(seed)
    parts, place, top = [FLOOR], np.zeros(2), 0.0
    for k in range(count):
        size = random.uniform(0.5, 1.5, 3)
        if random.random() < 0.4:
            place, top = np.array([4.0 * (k - 3), 0.0]), 0.0
        place = place + random.uniform(-0.35, 0.35, 2)
        parts.append(Part(f"box-{k}", Box(size), Pose([*place, top + size[2] / 2])))
        top += float(size[2])
    return Assembly(parts)


def turned(assembly: Assembly, seed: int) -> Assembly:
    """The assembly, rotated at random with its gravity."""
    turn = Pose((0, 0, 0), np.random.default_rng(seed).normal(size=4))
    parts = [
        dataclasses.replace(part, pose=Pose(turn.apply([part.pose.position])[0], turn.rotation))
        for part in assembly.parts
    ]
    return Assembly(parts, gravity=turn.apply([assembly.gravity])[0])


def bridge(shift: float, over: float = 0.0) -> Assembly:
    """A beam on two posts, off their middle by `over`, and a box off its middle by `shift`."""
    posts = [
        Part(f"post-{k}", Box([1, 1, 1]), Pose([x, 0, 0.5])) for k, x in enumerate((-2.0, 2.0))
    ]
    beam = Part("beam", Box([5, 1, 1]), Pose([over, 0, 1.5]))
    return Assembly(
        [FLOOR, *posts, beam, Part("top", Box([1, 1, 1]), Pose([over + shift, 0, 2.5]))]
    )


def blocks_of(assemblies: list[Assembly]) -> ProgramBlocks:
    """Programs of the assemblies, side by side."""
    apart = side_by_side(assemblies)
    return program_blocks(apart, contacts_side_by_side(apart, Tolerance()))


@pytest.mark.parametrize("turn", [False, True])
def test_the_side_is_that_of_the_program(turn):
    given = [stacks(seed) for seed in range(30)]
    given = [turned(one, k) for k, one in enumerate(given)] if turn else given
    blocks = blocks_of(given)
    stacked = blocks.stacked(np.ones(len(given), dtype=bool))
    solved = blocks.judged(solve_blocks(blocks.scaled, np.arange(len(given))))
    assert not (stacked.stable & ~solved.stable).any()
    assert not (stacked.unstable & ~solved.unstable).any()
    assert (stacked.stable | stacked.unstable).mean() > 0.9
    assert stacked.stable.any()
    assert stacked.unstable.any()


def test_a_beam_on_two_posts_tips_where_its_load_leaves_them():
    given = [bridge(0.0), bridge(1.9), bridge(-2.0, over=1.2), bridge(0.0, over=2.6)]
    stacked = blocks_of(given).stacked(np.ones(4, dtype=bool))
    assert stacked.stable.tolist() == [True, True, False, False]
    assert stacked.unstable.tolist() == [False, False, True, True]


def test_the_middle_of_an_edge_is_left_to_the_program():
    on_edge = Part("b", Box([1, 1, 1]), Pose([0.5, 0, 1.5]))
    given = [Assembly([FLOOR, Part("a", Box([1, 1, 1]), Pose([0, 0, 0.5])), on_edge])]
    stacked = blocks_of(given).stacked(np.ones(1, dtype=bool))
    assert not stacked.stable.any()
    assert not stacked.unstable.any()


def proofs_of(given: list[Assembly]) -> list[tuple[str, bytes]]:
    """Word and bytes of the proof of each assembly."""
    found = check_many(given, proofs=True)
    rows = []
    for k, word in enumerate(found.verdict.tolist()):
        kept = found.certificate(k)
        assert kept is not None
        assert kept[1].holds
        numbers = kept[1].forces if isinstance(kept[1], ForceProof) else kept[1].motion
        rows.append((word, numbers.tobytes()))
    return rows


def test_a_proof_depends_on_no_other_assembly():
    given = [stacks(seed) for seed in range(8)] + [bridge(0.3), bridge(1.9)]
    given += [turned(one, k) for k, one in enumerate(given[:3])]
    together = proofs_of(given)
    assert proofs_of(given[::-1]) == together[::-1]
    halves = proofs_of(given[:5]) + proofs_of(given[5:])
    assert halves == together
    assert [proofs_of([one])[0] for one in given[:4]] == together[:4]


def test_stacks_need_no_program(monkeypatch):
    def refused(*_: object) -> None:
        raise AssertionError("a program was solved")

    monkeypatch.setattr(decided_together, "solve_blocks", refused)
    given = [stacks(seed, 3) for seed in range(6)]
    assert set(check_many(given).verdict.tolist()) == {"stable", "unstable"}


def test_a_motion_also_overcomes_friction():
    """A box that tips moves no contact point along a face; a box on a slope slides."""
    rough = [stacks(seed).with_friction(0.5) for seed in range(8)]
    smooth = check_many([one.with_friction(0.0) for one in rough]).verdict.tolist()
    found = check_many(rough, proofs=True)
    assert found.verdict.tolist() == smooth
    assert set(smooth) == {"stable", "unstable"}
    for k in range(len(rough)):
        kept = found.certificate(k)
        assert kept is not None
        assert kept[1].holds
        assert isinstance(kept[1], ForceProof) or kept[0].mu.max() > 0
    slope = Pose((0, 0, 0), [np.cos(0.1), np.sin(0.1), 0, 0])
    parts = [FLOOR, Part("box", Box([1, 1, 1]), Pose([0, 0, 0.5]))]
    leaning = [
        dataclasses.replace(part, pose=Pose(slope.apply([part.pose.position])[0], slope.rotation))
        for part in parts
    ]
    apart = side_by_side([Assembly(leaning)] * 2)
    blocks = program_blocks(apart, contacts_side_by_side(apart, Tolerance()), np.array([0.1, 0.3]))
    motion = np.zeros((4, 6))
    motion[[1, 3], :3] = slope.apply([[0, -1, 0.15]])[0]
    none = np.zeros(len(blocks.whole.part_a))
    proofs = blocks.checked(none, motion, np.zeros(2, dtype=bool), np.ones(2, dtype=bool))
    # a motion overcomes friction if gaps open by mu times the slip
    assert proofs.unstable.tolist() == [True, False]


@pytest.mark.parametrize(("pinch", "holds"), [(0.2e6, True), (0.6e6, False)])
@pytest.mark.parametrize("heavy", [1.0, 1e6])
def test_the_criteria_of_forces_are_those_of_single_proofs(pinch, holds, heavy):
    """Two walls pinch a cube on a floor; the weight of another assembly plays no part."""
    walls = [
        Part("floor", Box([9, 9, 1]), Pose([0, 0, -0.5]), grounded=True),
        Part("left", Box([1, 1, 1]), Pose([-1, 0, 0.5]), grounded=True),
        Part("right", Box([1, 1, 1]), Pose([1, 0, 0.5]), grounded=True),
    ]
    pair = [
        Assembly([*walls, Part("cube", Box([1, 1, 1]), Pose([0, 0, 0.5]), mass=mass)])
        for mass in (1.0, heavy)
    ]
    blocks = blocks_of(pair)
    whole, owner = blocks.whole, blocks.row_owner
    forces = np.zeros(len(owner))
    weight = np.array([1.0, heavy]) * 9.81
    for k in range(2):
        level = (owner == k) & (np.abs(whole.normal[:, 2]) > 0.5)
        forces[level] = weight[k] / level.sum()
        for sense in (1, -1):
            side = (owner == k) & (sense * whole.normal[:, 0] > 0.5)
            forces[side] = pinch * weight[0] / side.sum()
    every = np.ones(2, dtype=bool)
    checked = blocks.checked(forces, np.zeros((len(blocks.owner), 6)), every, ~every)
    assert bool(checked.stable[0]) == holds
    single = build_program(pair[0], contacts(pair[0])).frictionless
    assert check_forces(single, forces[owner == 0]).holds == holds
