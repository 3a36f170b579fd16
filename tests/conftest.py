"""What all tests share: hypothesis without deadlines, since cores are shared; their options."""

import gc
import os
import signal
from collections.abc import Generator, Iterator
from contextlib import suppress
from pathlib import Path
from types import FrameType
from typing import Any

import pytest
from _pytest.doctest import DoctestModule
from hypothesis import settings

from published import judged_answers
from sampled import in_block, mark_rest_slow

collect_ignore_glob = ["*conftest.py"]  # no doctests there, and their names are alike

settings.register_profile("kilter", deadline=None, derandomize=True, max_examples=20)
settings.load_profile("kilter")


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--kills N`: see `tests/cli/test_writing.py`."""
    parser.addoption("--block", metavar="K/N", help="run the K-th of N blocks of the tests")
    parser.addoption("--kills", type=int, default=12, help="moments at which a writer is killed")


def pytest_configure() -> None:
    """Let SIGTERM, as `timeout` sends it, end the session also during a command.

    `kilter.cli.main` turns the signal into exit code 130 unless the program has a handler. So a
    session at its time limit went on, with a failure of the test whose command was interrupted.
    """

    def end(number: int, frame: FrameType | None) -> None:
        os._exit(128 + number)

    with suppress(ValueError):  # only the main thread may set handlers
        if signal.getsignal(signal.SIGTERM) == signal.SIG_DFL:
            signal.signal(signal.SIGTERM, end)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Collect tests without the garbage collector, which takes a quarter of that time.

    Objects of the collection live as long as the session: the collector skips them later, too.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.hookimpl(wrapper=True)
def pytest_collect_file(file_path: Path) -> Generator[None, list[Any], list[Any]]:
    """Search helpers alone for examples in docstrings: files of tests have none."""
    found = yield
    tests = file_path.name.startswith("test_")
    return [one for one in found if not (tests and isinstance(one, DoctestModule))]


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark cases slow before `-m` selects, and keep the tests of `--block`."""
    mark_rest_slow(items)
    block = config.getoption("--block")
    if block:
        items[:], others = in_block(items, block)
        config.hook.pytest_deselected(items=others)


@pytest.fixture(scope="session", autouse=True)
def answers_match_their_schemas() -> Iterator[None]:
    """Validate every answer of the tests by its published schema."""
    with judged_answers():
        yield
