"""One thread for linear algebra while any call needs it, and what was before afterwards."""

from __future__ import annotations

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
