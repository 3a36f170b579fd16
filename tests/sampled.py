"""Cases that always run and cases that only run with the slow tests.

`sampled` marks the cases of a parametrisation; the mark ``quick`` chooses among the cases of a
test (conftest applies it); `in_block` splits a long selection into blocks.
"""

import zlib
from collections.abc import Iterable, Sequence
from typing import Any

import pytest

SLOW_EXAMPLES = frozenset(
    {
        "kilter.analysis.everything.everything",
        "kilter.analysis.margins.margin.margin",
        "kilter.analysis.margins.part_limits.find_weakest_push",
        "kilter.analysis.margins.tilt.find_tilt_margin",
        "kilter.analysis.margins.uncertainty.find_uncertainty",
        "kilter.analysis.planning.hold.hold.hold",
        "kilter.analysis.regions.cone_cutting.friction_cone",
        "kilter.analysis.regions.region.region",
        "kilter.analysis.transport.transport.transport",
        "kilter.analysis.turning.orientation.orient",
        "kilter.friction.exclusion.prove_no_motion",
        "kilter.health.doctor",
        "kilter.notebook.cell",
        "kilter.publish.films.animate",
        "kilter.publish.offline_page.report",
    }
)
"""Functions whose docstring examples take over half a second: these examples are slow tests."""


def sampled(always: int, cases: Iterable[Any] | int) -> list[Any]:
    """The first `always` of the cases (a number: its range) as they are, the rest marked slow.

    A case that is a tuple has several arguments.
    """
    every = list(range(cases) if isinstance(cases, int) else cases)
    rest = [case if isinstance(case, tuple) else (case,) for case in every[always:]]
    return every[:always] + [pytest.param(*case, marks=pytest.mark.slow) for case in rest]


def mark_rest_slow(items: Iterable[pytest.Item]) -> None:
    """Mark each case slow that the ``quick`` mark of its test does not choose.

    ``@pytest.mark.quick(3)`` chooses three cases, evenly spaced; ``@pytest.mark.quick("wall")``
    chooses the case with this id; both may be given together.
    """
    tests: dict[tuple[int, str], list[pytest.Item]] = {}
    for item in items:
        if isinstance(item, pytest.DoctestItem) and item.name in SLOW_EXAMPLES:
            item.add_marker(pytest.mark.slow)
        if item.get_closest_marker("quick") and not item.get_closest_marker("slow"):
            name = getattr(item, "originalname", item.name)
            tests.setdefault((id(item.parent), name), []).append(item)
    for cases in tests.values():
        mark = cases[0].get_closest_marker("quick")
        assert mark is not None
        names = {given for given in mark.args if isinstance(given, str)}
        count = sum(given for given in mark.args if isinstance(given, int))
        spread = {k * len(cases) // count for k in range(count)}
        for index, case in enumerate(cases):
            if index not in spread and _case_id(case) not in names:
                case.add_marker(pytest.mark.slow)


def _case_id(item: pytest.Item) -> str:
    return item.name.partition("[")[2].removesuffix("]")


def in_block(items: Sequence[pytest.Item], block: str) -> tuple[list[pytest.Item], list[Any]]:
    """The tests of one block ("2/5": the second of five), and the other tests.

    The names decide, so that all workers and all runs split alike.
    """
    number, count = (int(text) for text in block.split("/"))
    parts: tuple[list[pytest.Item], list[Any]] = [], []
    for item in items:
        parts[zlib.crc32(item.nodeid.encode()) % count != number - 1].append(item)
    return parts
