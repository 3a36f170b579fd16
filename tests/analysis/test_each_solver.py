"""Each solver proves the same side; if a solver has no proof, the next is used."""

from __future__ import annotations

import numpy as np
import pytest
from judged import program_of, sides

from kilter.analysis.decision.judge import SOLVERS, judge
from kilter.analysis.load_limit import find_limit, gravity_wrench
from kilter.scenes import arches, stacks, walls
from kilter.solvers import cone_interior_point

BESIDE = (1e-2, 1e-4, 1e-5)
"""Of a limit."""


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_a_block_on_a_slope_is_proved_by_each(friction):
    limit = float(np.degrees(np.arctan(friction)))
    above = program_of(stacks.block_on_slope(limit + 0.1, friction=friction))
    assert sides(above) == dict.fromkeys(SOLVERS, False)
    if friction:
        below = program_of(stacks.block_on_slope(limit - 0.1, friction=friction))
        assert sides(below) == dict.fromkeys(SOLVERS, True)


@pytest.mark.parametrize("planar", [False, True])
def test_an_arch_in_a_plane_and_in_space(planar):
    for friction, stands in ((0.05, False), (0.7, True)):
        program = program_of(arches.arch(9, friction=friction, planar=planar))
        assert sides(program) == dict.fromkeys(SOLVERS, stands)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_walls_and_arches_beside_their_limits(seed):
    random = np.random.default_rng(seed)
    friction = float(random.uniform(0.5, 0.9))
    assembly = (
        arches.arch(int(random.integers(5, 20)), friction=friction, planar=False)
        if seed % 2
        else walls.wall(*(int(k) for k in random.integers(2, 5, 2)), friction=friction)
    )
    program, turn = program_of(assembly), float(random.uniform(0, 2 * np.pi))
    aside = np.array([np.cos(turn), np.sin(turn), 0.0])
    limit = find_limit(program, gravity_wrench(program, aside))
    assert limit.value > 0
    for beside in BESIDE:
        for held in (True, False):
            if not held and beside * limit.value <= limit.gap * max(1.0, limit.value):
                continue  # which side that is, nothing has proved
            share = limit.value * (1 - beside if held else 1 + beside)
            turned = program.turned(program.down + share * aside)
            assert set(sides(turned).values()) <= {held, None}
            assert judge(turned).stable is held


def test_no_proof_of_one_is_asked_of_the_next(monkeypatch):
    program = program_of(walls.wall(5, 5, friction=0.6))
    assert judge(program).solvers[0].startswith("load factor in cones: kilter")
    monkeypatch.setattr(cone_interior_point, "iterates", lambda cones: iter(()))
    assert judge(program, solver="kilter").stable is None
    fallen_back = judge(program)
    assert fallen_back.stable
    assert "no proof" in fallen_back.solvers[0]
    assert "clarabel" in fallen_back.solvers[1]
