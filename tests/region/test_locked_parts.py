"""Parts that a squeeze locks are merged, and the same directions are held, with the same proofs."""

from __future__ import annotations

import numpy as np
import pytest
from random_voronoi import random_voronoi

import kilter
from kilter import Assembly, Part, Prism
from kilter.analysis.decision.judge import judge
from kilter.mechanics.certificate import check_forces, check_motion
from kilter.mechanics.locked_parts import LockedParts, find_locked_parts
from kilter.mechanics.program import Program, build_program
from kilter.scenes import stacks
from sampled import sampled

CELLS, ROUGH = (8, 25), (0.5, 0.84, 1.0)


def program_of(assembly: Assembly) -> Program:
    """The program of an assembly with the contacts of its geometry."""
    return build_program(assembly, kilter.contacts(assembly))


def wedge_in_gap(slope: float, friction: float) -> Assembly:
    """A wedge between two held blocks whose faces have a slope (tangent) from the vertical."""
    low, high = 0.5, 0.5 + slope
    wedge = Prism([[-low, 0], [low, 0], [high, 1], [-high, 1]], 1.0)
    right = Prism([[low, 0], [2, 0], [2, 1], [high, 1]], 1.0)
    left = Prism([[-low, 0], [-high, 1], [-2, 1], [-2, 0]], 1.0)
    parts = [Part("left", left, grounded=True), Part("right", right, grounded=True)]
    return Assembly([*parts, Part("wedge", wedge)], friction=friction)


@pytest.mark.parametrize("slope", [0.2, 0.7])
def test_wedge_locks_if_its_slope_is_below_friction(slope: float) -> None:
    for factor, free in ((1.001, 0), (0.999, 1)):
        locked = find_locked_parts(program_of(wedge_in_gap(slope, factor * slope)))
        assert int(locked.program.free.sum()) == free


def test_a_block_on_a_table_is_not_locked() -> None:
    program = program_of(stacks.block_on_slope(0.0, friction=0.5))
    assert find_locked_parts(program).program is program


def directions_near(program: Program, random: np.random.Generator) -> np.ndarray:
    """Six directions near gravity and six on the whole sphere."""
    directions = random.normal(size=(12, 3))
    directions[:6] = program.down + 0.3 * directions[:6]
    unit: np.ndarray = directions / np.linalg.norm(directions, axis=1)[:, None]
    return unit


def lifted_holds(locked: LockedParts, down: np.ndarray) -> tuple[bool | None, bool]:
    """Verdict of the smaller program in a direction, and whether its proof holds for the whole."""
    whole, small = locked.whole.turned(down), locked.program
    if not small.free.any():
        none = np.zeros((len(small.part_a), 3))
        return True, check_forces(whole, *locked.forces(down, none[:, 0], none)).holds
    judged = judge(small.turned(down))
    if judged.stable:
        given = judged.forces
        assert given is not None
        return True, check_forces(whole, *locked.forces(down, given.forces, given.friction)).holds
    assert judged.motion is not None
    return judged.stable, check_motion(whole, locked.motion(judged.motion.motion)).holds


@pytest.mark.parametrize("seed", sampled(2, [22, 20, 1, 5, 8, 9, 13, 14, 16, 18, 19, 23, 26, 28]))
def test_the_same_directions_are_held_with_proofs_of_the_whole(seed: int) -> None:
    program = program_of(random_voronoi(seed, CELLS, ROUGH))
    locked = find_locked_parts(program)
    for down in directions_near(program, np.random.default_rng(seed)):
        stable, holds = lifted_holds(locked, down)
        assert holds
        assert stable == judge(program.turned(down)).stable
