"""A solver's call ends at once when it is interrupted, and computes the same beside."""

from __future__ import annotations

import _thread
import math
import os
import signal
import threading
import time
from collections.abc import Iterator

import numpy as np
import pytest
from scipy.sparse import csc_array, random_array

from kilter.errors import SolverError
from kilter.solvers import clarabel, highs, interrupts
from kilter.solvers.interrupts import call_apart, run_aside
from kilter.solvers.problem import ConicProgram, LinearProgram


@pytest.fixture(autouse=True)
def heard() -> Iterator[None]:
    """A shell that starts this in the background leaves interruptions ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_what_it_raises_is_raised() -> None:
    def broken() -> None:
        raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        run_aside(broken, lambda: None)


def test_an_interruption_stops_the_call_and_goes_on() -> None:
    stopped = threading.Event()
    started = time.perf_counter()
    threading.Timer(0.2, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        run_aside(lambda: stopped.wait(30), stopped.set)
    assert stopped.is_set()
    assert time.perf_counter() - started < 10


def test_it_is_just_called_in_another_thread() -> None:
    where: list[threading.Thread] = []

    def ask() -> None:
        run_aside(lambda: where.append(threading.current_thread()), lambda: None)

    thread = threading.Thread(target=ask)
    thread.start()
    thread.join()
    assert where == [thread]


def test_what_is_raised_in_a_process_of_its_own_is_raised() -> None:
    with pytest.raises(ValueError, match="domain"):
        call_apart(math.sqrt, -1.0)


def test_a_process_that_breaks_down_is_a_solver_that_did() -> None:
    with pytest.raises(SolverError):
        call_apart(os._exit, 3)


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_an_interruption_ends_the_process_and_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    start = interrupts.start_process
    monkeypatch.setattr(
        interrupts, "start_process", lambda name: made.append(start(name)) or made[-1]
    )
    threading.Timer(0.5, os.kill, [os.getpid(), signal.SIGINT]).start()
    started = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        call_apart(time.sleep, 60)
    assert time.perf_counter() - started < 10
    [process] = made
    assert process.returncode == -signal.SIGKILL  # it was waited for: nothing is left of it


def large_program() -> LinearProgram:
    """A linear program on which the simplex takes several seconds."""
    random = np.random.default_rng(0)
    matrix = csc_array(random_array((1500, 3000), density=0.05, rng=random))
    one, many = np.ones(1500), np.ones(3000)
    cost = -random.random(3000)
    return LinearProgram(cost, matrix, -np.inf * one, one, 0 * many, np.inf * many)


def again_and_again(program: LinearProgram) -> None:
    for _ in range(100):
        highs.solve_linear(program, presolve=False)


@pytest.mark.slow
def test_the_simplex_is_interrupted() -> None:
    program = large_program()
    assert program.matrix.nnz > interrupts.LONG
    threading.Timer(0.5, _thread.interrupt_main).start()
    started = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        again_and_again(program)
    assert time.perf_counter() - started < 10


@pytest.mark.quick(1)
@pytest.mark.parametrize("beside", ["clarabel.LONG", "clarabel.DEAF", "highs.LONG"])
def test_it_is_the_same_beside(monkeypatch: pytest.MonkeyPatch, beside: str) -> None:
    linear = LinearProgram(
        -np.ones(2), csc_array([[1.0, 2.0]]), np.zeros(1), np.ones(1), np.zeros(2), np.ones(2)
    )
    conic = ConicProgram(
        csc_array(np.eye(2)), np.array([0.3, -2.0]), csc_array(-np.eye(2)),
        np.zeros(2), 0, 0, np.array([2]),
    )  # fmt: skip
    solved = (
        (lambda: clarabel.solve_conic(conic))
        if beside.startswith("clarabel")
        else (lambda: highs.solve_linear(linear))
    )
    before = solved()
    monkeypatch.setattr(f"kilter.solvers.{beside}", 0)
    after = solved()
    assert after.outcome == before.outcome == "optimal"
    assert (after.x == before.x).all()
    assert (after.multipliers == before.multipliers).all()


def test_a_solver_whose_process_breaks_down_failed(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise SolverError("a solver's process broke down", status="failed")

    monkeypatch.setattr(clarabel, "DEAF", 0)
    monkeypatch.setattr(clarabel, "call_apart", broken)
    one = ConicProgram(
        csc_array(np.eye(1)), -np.ones(1), csc_array(-np.eye(1)),
        np.zeros(1), 0, 1, np.empty(0, dtype=np.int64),
    )  # fmt: skip
    answer = clarabel.solve_conic(one)
    assert (answer.outcome, answer.found) == ("failed", False)


def test_a_kept_program_asks_for_an_interruption_once_however_often_it_is_solved(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    linear = LinearProgram(
        -np.ones(2), csc_array([[1.0, 2.0]]), np.zeros(1), np.ones(1), np.zeros(2), np.ones(2)
    )
    monkeypatch.setattr("kilter.solvers.highs.LONG", 0)
    kept = highs.KeptProgram(linear)
    for cost in (1.0, 2.0, 3.0):
        assert kept.solve(-cost * np.ones(2)).outcome == "optimal"
    assert len(kept._highs.cbSimplexInterrupt.callbacks) == 1
