"""Load limits of large programs: a sharper conic program comes before the linear programs."""

import numpy as np
import pytest

from kilter.analysis import load_limit
from kilter.analysis.load_limit import Limit, LimitSides, NoLimit, SharedCones, find_limit
from kilter.arrays import Array
from kilter.contact import contacts
from kilter.mechanics.program import Program, build_program
from kilter.scenes import stacks


def limit_if_first_bounds_are_open(
    monkeypatch: pytest.MonkeyPatch, exact: int
) -> tuple[Limit | NoLimit, list[str]]:
    """The limit of a push on a block, and the programs that were solved after the first one."""
    solved, in_cones, linear = [], load_limit._in_cones, load_limit.limit_sides

    def conic(shared: SharedCones, wrench: Array, most: float, *sharp: float) -> load_limit._Conic:
        answer = in_cones(shared, wrench, most, *sharp)
        solved.extend(["conic"] * len(sharp))
        return answer if sharp else load_limit._Conic(LimitSides(), answer.across)

    def pyramids(program: Program, wrench: Array, most: float, across: list[Array]) -> LimitSides:
        solved.append("linear")
        return linear(program, wrench, most, across)

    monkeypatch.setattr(load_limit, "EXACT", exact)
    monkeypatch.setattr(load_limit, "_in_cones", conic)
    monkeypatch.setattr(load_limit, "limit_sides", pyramids)
    block = stacks.block_on_slope(0.0, friction=0.5)
    program = build_program(block, contacts(block))
    aside = np.zeros((2, 6))
    aside[1, 0] = program.weight[1]
    shared = SharedCones(program, far=True)  # no own interior point before
    return find_limit(program, aside, most=20.0, shared=shared), solved


@pytest.mark.parametrize(("exact", "solved"), [(1, ["conic"]), (500, ["linear"])])
def test_a_large_program_is_first_solved_sharply(exact, solved, monkeypatch):
    limit, programs = limit_if_first_bounds_are_open(monkeypatch, exact)
    assert limit.value == pytest.approx(0.5, abs=1e-9)
    assert programs == solved
