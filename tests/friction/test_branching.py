"""The core of branch and bound on intervals: the greatest value of a function."""

import math

import pytest

from kilter.friction.branching import CaseTree, Mode

LOW, HIGH = 0.0, 4.0


def tree(seen, *, closed=-math.inf):
    """Intervals (low, high), bounded by x sin x at their middle plus a slope of 5 over x."""

    def bound(interval, parent):
        low, high = interval
        middle = (low + high) / 2
        power = middle * math.sin(middle) + 5 * (high - low) / 2
        if parent is not None:
            assert parent[0][0] <= low < high <= parent[0][1]
            power = min(power, parent[1])
        seen.append(interval)
        return None if power <= closed else (interval, power)

    def divide(case):
        (low, high), _ = case
        middle = (low + high) / 2
        return [(low, middle), (middle, high)] if high - low > 1e-6 else []

    return CaseTree(bound, divide, lambda case: case[1])


def test_the_best_open_case_closes_in_on_the_greatest_value():
    seen = []
    one = tree(seen)
    list(one.explore((LOW, HIGH), enough=lambda case: case[0][1] - case[0][0] < 1e-5))
    (low, high), power = one.best
    assert low <= 2.02876 <= high  # tan x = -x
    assert power == pytest.approx(1.81971, abs=1e-3)
    assert one.nodes == len(seen) < 6000  # 2^19 without bounds
    assert len(one) > 1


def test_a_case_that_is_not_worth_dividing_is_dropped():
    one = CaseTree(lambda q, _: q, lambda case: [], lambda case: 1.0)
    assert list(one.explore("root")) == ["root"]
    assert one.best is None


def test_modes_differ():
    assert len({int(mode) for mode in Mode}) == 4
