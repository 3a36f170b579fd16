"""What all tests share: hypothesis without deadlines, since cores are shared; `--each-solver`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import settings

collect_ignore_glob = ["*conftest.py"]  # no doctests there, and their names are alike

settings.register_profile("kilter", deadline=None, derandomize=True, max_examples=20)
settings.load_profile("kilter")


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--each-solver FILE`: see `solvers_apart`."""
    parser.addoption("--each-solver", metavar="FILE", type=Path, help="ask each solver by itself")


@pytest.fixture(autouse=True)
def asked_of_each_solver(request: pytest.FixtureRequest) -> Iterator[None]:
    """Programs that the test has judged, asked of each solver, where that is asked for."""
    file = request.config.getoption("--each-solver")
    if file is None:
        yield
        return
    from solvers_apart import each_solver

    with each_solver(request.node.nodeid, file):
        yield
