"""One thread for linear algebra while any call needs it, and what was before afterwards."""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Callable

import numpy as np
import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from kilter.threads import on_one_thread


def threads() -> set[int]:
    np.linalg.norm(np.ones(2))
    return {one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"}


@on_one_thread
def inner() -> set[int]:
    return threads()


@on_one_thread
def outer() -> tuple[set[int], set[int]]:
    return inner(), threads()


def test_a_call_within_another_leaves_the_one_thread_to_it() -> None:
    with threadpool_limits(limits=2):
        if threads() != {2}:
            pytest.skip("linear algebra here has one thread only")
        assert outer() == ({1}, {1})
        assert threads() == {2}


def test_threads_come_back_after_a_call_that_failed() -> None:
    @on_one_thread
    def fails() -> None:
        raise ZeroDivisionError

    with threadpool_limits(limits=2):
        before = threads()
        with pytest.raises(ZeroDivisionError):
            fails()
        assert threads() == before


def beside(act: Callable[[], None]) -> set[int]:
    """Run something while a call on another thread is inside; the threads that call has after."""
    begun, go_on = threading.Event(), threading.Event()
    found: list[set[int]] = []

    @on_one_thread
    def waits() -> None:
        begun.set()
        go_on.wait(60)
        found.append(threads())

    other = threading.Thread(target=waits)
    other.start()
    begun.wait(60)
    act()
    go_on.set()
    other.join()
    return found[0]


def test_a_call_that_ends_leaves_the_one_thread_to_a_call_beside_it() -> None:
    with threadpool_limits(limits=2):
        if threads() != {2}:
            pytest.skip("linear algebra here has one thread only")
        seen: list[set[int]] = []
        assert beside(lambda: seen.append(inner())) == {1}
        assert seen == [{1}]
        assert threads() == {2}


@pytest.mark.slow
@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork there")
@pytest.mark.filterwarnings("ignore:.*multi-threaded, use of fork")
def test_a_process_forked_beside_a_call_has_what_was_before_it() -> None:
    with threadpool_limits(limits=2):
        if threads() != {2}:
            pytest.skip("linear algebra here has one thread only")
        found: list[list[set[int]]] = []

        def forks() -> None:
            with multiprocessing.get_context("fork").Pool(1) as pool:
                found.append(pool.apply(lived))

        assert beside(forks) == {1}
        assert found == [[{2}, {1}, {2}]]


def lived() -> list[set[int]]:
    """Threads before, within and after a call."""
    return [threads(), inner(), threads()]
