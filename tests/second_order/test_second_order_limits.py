"""Limits of second order by bisection: `benchmarks/second_order_limits.py`."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
from balance_cases import CASES, Case

FILE = Path(__file__).resolve().parents[2] / "benchmarks" / "second_order_limits.py"
LIMITED = [case for case in CASES if case.limit is not None]


@pytest.fixture(scope="module")
def limits() -> Iterator[ModuleType]:
    spec = importlib.util.spec_from_file_location("second_order_limits", FILE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules[spec.name]


@pytest.mark.slow
@pytest.mark.parametrize("case", LIMITED, ids=lambda case: case.number)
def test_a_limit_is_proved_from_both_sides(limits: ModuleType, case: Case) -> None:
    below, above = limits.found_limits(case)
    assert limits.right(below, above), (below, above)


def test_the_last_that_holds_is_found_from_either_side(limits: ModuleType) -> None:
    edge = 0.3217
    assert edge - limits.RESOLVED <= limits.last(lambda x: x <= edge, 0.0, 1.0) <= edge
    assert edge <= limits.last(lambda x: x >= edge, 1.0, 0.0) <= edge + limits.RESOLVED
    with pytest.raises(ValueError, match="does not hold"):
        limits.last(lambda x: x >= edge, 0.0, 1.0)
    assert not limits.right(1e-6, 2e-6)
    assert not limits.right(-2e-6, 1e-7)
    assert limits.right(-1e-7, 1e-7)
