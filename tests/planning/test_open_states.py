"""States that hang on edges where four stones meet: left open in little time, as `check` has it."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

import kilter
from kilter import Assembly, Mesh, Part
from kilter.analysis.planning.states.states import States

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
def test_a_state_that_hangs_on_edges_is_left_open_without_a_check(dome: States) -> None:
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
def test_verdicts_where_edges_meet_are_those_of_check(dome: States) -> None:
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
def test_a_search_among_open_states_ends_by_its_work() -> None:
    order = kilter.plan(ringed_dome(6, (0, 24, 46, 66)), effort=0.01)
    assert order.verdict == "none-found"
    assert order.states.counts["open"] > 0
