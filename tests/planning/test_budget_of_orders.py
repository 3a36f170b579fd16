"""The search of an order ends where its budget ends, and then proves nothing."""

from __future__ import annotations

import numpy as np
import pytest

from kilter.analysis.planning.order.closure import find_unreachable
from kilter.analysis.planning.order.removal import Removal
from kilter.analysis.planning.order.search import OrderSearch
from kilter.analysis.planning.states.states import States, states
from kilter.scenes.arches import arch
from kilter.work import Work


@pytest.fixture(name="given")
def arch_states() -> States:
    return states(arch(9, ratio=0.3, friction=0.6))


def test_an_exhausted_budget_ends_the_growth_of_reachable_parts_without_a_proof(
    given: States,
) -> None:
    work = Work()
    _, falling = find_unreachable(given, work)
    assert len(falling) == 5
    assert work.spent > 0
    less = Work(work.spent / 3)
    assert find_unreachable(given, less)[1] == []
    assert less.spent < work.spent / 2


def searched(given: States, work: Work) -> OrderSearch:
    """A search for an order of the arch without hands, which does not exist."""
    held = given.assembly.geometry.grounded
    count = len(held)
    units = [1 << k for k in np.flatnonzero(~held).tolist()]
    search = OrderSearch(given, Removal(given.contacts), [0] * count, ~held, work, units)
    assert search.find(0) is None
    return search


def test_a_search_ends_within_the_removals_of_a_set_where_its_budget_ends(given: States) -> None:
    whole = searched(given, Work())
    assert whole.exhausted
    cut = searched(states(given.assembly), Work(1.0))
    assert not cut.exhausted
    assert cut.visited == 1
    assert cut.work.spent < whole.work.spent / 3
