"""Cases of which some always run and the others only with the slow tests."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest

__all__ = ["sampled"]


def sampled(always: int, cases: Iterable[Any] | int) -> list[Any]:
    """The first `always` of the cases (a number: its range) as they are, the rest marked slow.

    A case that is a tuple has several arguments.
    """
    every = list(range(cases) if isinstance(cases, int) else cases)
    rest = [one if isinstance(one, tuple) else (one,) for one in every[always:]]
    return every[:always] + [pytest.param(*one, marks=pytest.mark.slow) for one in rest]
