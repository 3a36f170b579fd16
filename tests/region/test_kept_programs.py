"""Programs that are kept and solved again, and interrupted solvers."""

import _thread
import math
import os
import signal
import threading
import time
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csc_array, random_array

from kilter import SolverError
from kilter.solvers import clarabel, highs
from kilter.solvers import clarabel as interrupts
from kilter.solvers.clarabel import call_apart, run_aside, solve_conic, solve_quadratic
from kilter.solvers.highs import KeptProgram, Warm, find_optimum, solve_linear
from kilter.solvers.problem import ConicProgram, LinearProgram, Solution, quadratic_program
from kilter.work import Work


def random_program(seed: int, rows: int = 15, columns: int = 30) -> LinearProgram:
    random = np.random.default_rng(seed)
    matrix = csc_array(random_array((rows, columns), density=0.3, rng=random, format="csc"))
    middle = matrix @ random.random(columns)
    return LinearProgram(
        random.normal(size=columns),
        matrix,
        middle - random.random(rows),
        middle + random.random(rows),
        np.zeros(columns),
        np.full(columns, 2.0),
    )


@pytest.mark.parametrize("seed", range(5))
def test_a_new_cost(seed):
    program = random_program(seed)
    kept = KeptProgram(program)
    random = np.random.default_rng(seed)
    for _ in range(10):
        cost = random.normal(size=len(program.cost))
        kept.change_cost(np.arange(len(cost)), cost)
        found = kept.solve()
        fresh = solve_linear(kept.program)
        assert found.holds
        assert found.objective == pytest.approx(fresh.objective, abs=1e-9)
    assert kept.solves == 10
    assert program.cost is not kept.program.cost


def test_new_bounds_and_entries():
    kept = KeptProgram(random_program(1))
    kept.solve()
    kept.change_bounds([0, 3], [0.5, 0.25], [0.5, 0.25])
    row = int(kept.program.matrix.indices[kept.program.matrix.indptr[2]])
    kept.change_row(row, [2], [0.125])
    found = kept.solve()
    assert found.x[[0, 3]].tolist() == [0.5, 0.25]
    assert kept.program.matrix[row, 2] == 0.125
    assert found.objective == pytest.approx(solve_linear(kept.program).objective, abs=1e-9)


def test_a_wrong_answer_is_solved_again(monkeypatch):
    """A warm answer that is not optimal, whatever its status said, is not given out."""
    kept = KeptProgram(random_program(2))
    right = kept.solve()
    run, told = KeptProgram._run_simplex, []

    def wrong_once(self: KeptProgram, strategy: Warm, steps: int, work: Work | None) -> Solution:
        found = run(self, strategy, steps, work)
        told.append(found.residual)
        if len(told) == 1:
            return replace(found, x=found.x + 1.0)
        return found

    monkeypatch.setattr(KeptProgram, "_run_simplex", wrong_once)
    again = kept.solve()
    assert len(told) == 2
    assert again.objective == pytest.approx(right.objective)


def test_the_gap_sees_what_is_wrong():
    kept = KeptProgram(random_program(3))
    found = kept.solve()
    worse = found.x.copy()
    inner = int(np.argmin(np.abs(worse - 1.0)))
    worse[inner] = 3.0  # beyond its bound
    assert not replace(found, x=worse).holds
    assert not replace(found, multipliers=found.multipliers * 1.01 + 0.01).holds
    assert not replace(found, x=found.x * np.nan).holds
    assert found.bound <= found.objective <= found.bound + 1e-7
    assert replace(found, multipliers=found.multipliers * 1.01).bound < found.bound


def line(low: float, high: float, *, cost: float = 1.0, end: float = 1.0) -> LinearProgram:
    """Low <= x <= high, 0 <= x <= end."""
    one = np.ones(1)
    return LinearProgram(
        cost * one, csc_array(one[None]), low * one, high * one, 0 * one, end * one
    )


def test_infeasible_and_unbounded_do_not_hold():
    none = KeptProgram(line(5, 6)).solve()
    assert not none.holds
    assert none.outcome == "infeasible"
    assert none.proves_none
    endless = KeptProgram(line(-np.inf, np.inf, cost=-1.0, end=np.inf)).solve()
    assert not endless.holds
    assert endless.outcome == "unbounded"
    assert not endless.proves_none


@pytest.mark.parametrize("end", [1.0, np.inf])
def test_that_there_is_none_is_rechecked_and_one_number_flips_it(end):
    pair = csc_array([[1.0, 1.0], [1.0, 1.0]])
    zero, two = np.zeros(2), np.ones(2)

    def between(low: float) -> LinearProgram:  # low <= x + y <= 1
        sides = np.array([low, -np.inf]), np.array([np.inf, 1.0])
        return LinearProgram(two, pair, *sides, zero, end * two)

    none = solve_linear(between(1.5), presolve=False)
    assert (none.outcome, none.proves_none) == ("infeasible", True)
    # the same ray says nothing of a program that has a point
    assert not replace(none, problem=between(0.5)).proves_none
    some = solve_linear(between(0.5), presolve=False)
    assert some.optimal
    assert not some.proves_none


def test_a_solver_that_is_stopped_says_failed_not_that_there_is_none(monkeypatch):
    from kilter.solvers import highs

    program = random_program(4)
    right = solve_linear(program)
    assert right.optimal
    monkeypatch.setattr(highs, "INTERIOR_STEPS", 1)
    stopped = solve_linear(program, method="interior")
    assert stopped.outcome == "failed"
    assert not stopped.proves_none
    monkeypatch.setattr(highs, "FEW", 1)
    monkeypatch.setattr(highs, "MANY", 0)
    assert solve_linear(program, presolve=False).outcome == "failed"
    assert find_optimum(program).outcome == "failed"
    with pytest.raises(SolverError, match="the figure"):
        find_optimum(program).required("the figure")
    assert not KeptProgram(program).solve().holds


def test_where_no_simplex_ends_the_interior_point_takes_over(monkeypatch):
    from kilter.solvers import highs

    program = random_program(4)
    right = solve_linear(program)
    monkeypatch.setattr(highs, "FEW", 1)
    monkeypatch.setattr(highs, "MANY", 0)
    kept = KeptProgram(program, goal="point")
    answer = kept.solve()
    assert answer.solver != "simplex"
    assert answer.optimal
    assert answer.objective == pytest.approx(right.objective, abs=1e-6)
    # there is no basis to go on from
    monkeypatch.undo()
    again = kept.solve(-program.cost)
    assert again.solver == "simplex"
    assert again.holds


def test_conic_answers_say_none_endless_or_a_point():
    def inside(low: float) -> Solution:  # low <= x <= 1, min x^2
        rows = csc_array([[1.0], [-1.0]])
        square = csc_array(2 * np.eye(1))
        return solve_quadratic(
            quadratic_program(square, np.zeros(1), rows, np.array([low, -1.0]), 0)
        )

    assert inside(0.5).x == pytest.approx([0.5])
    assert inside(0.5).holds
    none = inside(1.5)
    assert (none.outcome, none.found, none.proves_none) == ("infeasible", False, True)
    free = quadratic_program(csc_array((1, 1)), np.ones(1), csc_array([[-1.0]]), np.zeros(1), 0)
    endless = solve_conic(free)
    assert (endless.outcome, endless.found) == ("unbounded", False)


@pytest.fixture(autouse=True)
def heard() -> Iterator[None]:
    """A shell that starts this in the background leaves interruptions ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_what_it_raises_is_raised():
    def broken() -> None:
        raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        run_aside(broken, lambda: None)


@pytest.mark.slow
def test_an_interruption_stops_the_call_and_goes_on():
    stopped = threading.Event()
    started = time.perf_counter()
    threading.Timer(0.2, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        run_aside(lambda: stopped.wait(30), stopped.set)
    assert stopped.is_set()
    assert time.perf_counter() - started < 10


def test_it_is_just_called_in_another_thread():
    where: list[threading.Thread] = []

    def ask() -> None:
        run_aside(lambda: where.append(threading.current_thread()), lambda: None)

    thread = threading.Thread(target=ask)
    thread.start()
    thread.join()
    assert where == [thread]


@pytest.mark.slow
def test_what_is_raised_in_a_process_of_its_own_is_raised():
    with pytest.raises(ValueError, match="domain"):
        call_apart(math.sqrt, -1.0)


def test_a_process_that_breaks_down_is_a_solver_that_did():
    with pytest.raises(SolverError):
        call_apart(os._exit, 3)


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_an_interruption_ends_the_process_and_goes_on(monkeypatch):
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
def test_the_simplex_is_interrupted():
    program = large_program()
    assert program.matrix.nnz > interrupts.LONG
    threading.Timer(0.5, _thread.interrupt_main).start()
    started = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        again_and_again(program)
    assert time.perf_counter() - started < 10


@pytest.mark.quick(1)
@pytest.mark.parametrize("beside", ["clarabel.LONG", "clarabel.DEAF", "highs.LONG"])
def test_it_is_the_same_beside(monkeypatch, beside):
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


def test_a_solver_whose_process_breaks_down_failed(monkeypatch):
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


def test_a_kept_program_asks_for_an_interruption_once_however_often_it_is_solved(monkeypatch):
    linear = LinearProgram(
        -np.ones(2), csc_array([[1.0, 2.0]]), np.zeros(1), np.ones(1), np.zeros(2), np.ones(2)
    )
    monkeypatch.setattr("kilter.solvers.highs.LONG", 0)
    kept = highs.KeptProgram(linear)
    for cost in (1.0, 2.0, 3.0):
        assert kept.solve(-cost * np.ones(2)).outcome == "optimal"
    assert len(kept._highs.cbSimplexInterrupt.callbacks) == 1
