"""Work ends where it was counted to end, is shared out, and knows of a time limit."""

from __future__ import annotations

import math

import pytest

from kilter.work import BETWEEN_WORDS, LEAST, PER_EFFORT, Work, units_of


def test_an_effort_is_so_many_units_and_each_further_one_ten_times_more():
    assert units_of(0) == 0.0
    assert units_of(1) == PER_EFFORT
    assert units_of(3) - units_of(2) == pytest.approx(10 * (units_of(2) - units_of(1)))
    assert units_of(1e6) == units_of(1e5)  # no more work, and no overflow
    assert Work.of(2).allowed == units_of(2)
    work = Work(5.0)
    assert Work.of(work) is work


def test_work_is_over_when_what_was_charged_reaches_it_and_not_before():
    work = Work(1000.0)
    work.charge(999.0)
    assert not work.over
    assert work.left == 1.0
    work.charge(1.0)
    assert work.over
    assert Work(0.0).over
    assert not Work().over


def test_shares_count_together():
    work = Work(1000.0)
    first = work.until(0.3)
    first.charge(300.0)
    assert first.over
    assert not work.over
    assert work.until(0.3).over
    rest = work.fraction_left(0.5)
    assert (rest.left, rest.spent) == (350.0, 0.0)
    rest.charge(350.0)
    assert rest.over
    assert work.spent == 650.0
    beside = work.beside(10.0)
    beside.charge(10.0)
    assert beside.over
    assert work.spent == 650.0
    assert Work(math.inf).until(0.0).over


def test_the_total_includes_separate_budgets_and_may_end_all_of_them():
    work = Work(1000.0)
    work.beside(10.0).charge(10.0)
    work.until(0.5).charge(5.0)
    assert (work.total, work.spent) == (15.0, 5.0)
    other = work.whole(100.0, 50.0)
    assert (other.allowed, other.total) == (50.0, 0.0)
    other.beside().charge(99.0)
    assert not other.late
    assert not other.over
    other.beside(1e9).charge(1.0)
    assert not other.cut  # nobody was stopped yet
    assert other.beside().late
    assert (other.cut, work.late, work.total) == (True, False, 15.0)


def test_steps_that_are_left_never_fall_to_none():
    work = Work(1000.0)
    few = work.steps(10**9, 10_000)
    assert 1 <= few < 10**9
    work.charge(1e9)
    assert work.steps(10**9, 10_000) == 1
    assert work.steps(7, 1) == 1
    assert Work().steps(7, 10_000) == 7


@pytest.mark.parametrize("charge", ["conic", "linear", "sparse"])
def test_a_larger_program_and_more_iterations_cost_more(charge):
    def cost(*given):
        work = Work()
        getattr(work, charge)(*given)
        return work.spent

    assert 0 < cost(10, 100) < cost(10, 1000)
    assert cost(10, 1000) < cost(20, 1000) or charge == "sparse"


def test_no_time_limit_reads_no_clock(monkeypatch):
    work = Work(10.0)
    monkeypatch.setattr("kilter.work.perf_counter", None)
    assert not work.over
    assert not work.late
    assert work.seconds is None


def test_a_time_limit_ends_it_with_work_left_and_is_remembered(monkeypatch):
    now = [0.0]
    monkeypatch.setattr("kilter.work.perf_counter", lambda: now[0])
    work = Work(1e9, time_limit=5.0)
    part = work.fraction_left(0.5)
    assert (work.seconds, work.over, work.cut) == (5.0, False, False)
    now[0] = 6.0
    assert not work.cut  # nobody was stopped yet
    assert part.over
    assert work.cut
    assert work.beside().late
    assert work.whole(1e9).late
    assert work.seconds == LEAST  # a step that has begun may end


def test_words_come_through_once_a_second_and_stages_always(monkeypatch):
    now, words = [0.0], []
    monkeypatch.setattr("kilter.work.perf_counter", lambda: now[0])
    work = Work(50.0, words.append)
    part = work.fraction_left(0.5)
    work.stage("begins")
    for k in range(16):
        now[0] += BETWEEN_WORDS / 4  # exact in binary
        (part if k % 2 else work).tell(f"step {k}")
    assert words[0] == "begins"
    assert len(words) == 5
