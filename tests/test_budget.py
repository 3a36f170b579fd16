"""A budget ends, is shared out, and lets words through once a second."""

import time

import pytest

from kilter.budget import BETWEEN_WORDS, LEAST, Budget


def test_it_runs_out():
    budget = Budget(0.02)
    assert not budget.over
    time.sleep(0.03)
    assert budget.over
    assert budget.spent >= 0.02
    assert budget.left == LEAST  # a step that has begun may end


def test_without_seconds_it_never_ends():
    for budget in (Budget(), Budget().until(0.1), Budget().fraction_left(0.1)):
        assert not budget.over
        assert budget.left == float("inf")


def test_nothing_is_over_at_once():
    assert Budget(0.0).over
    assert Budget(-1.0).over
    assert Budget(0.0).fraction_left(0.5).over


def test_parts_count_from_the_start_or_from_now():
    budget = Budget(10.0)
    time.sleep(0.02)
    assert budget.until(0.001).over
    assert not budget.fraction_left(0.01).over
    assert budget.until(0.5).left == pytest.approx(5.0 - budget.spent, abs=0.01)
    assert budget.fraction_left(0.5).left == pytest.approx(budget.left / 2, abs=0.01)


def test_seconds_and_budgets_are_both_taken():
    budget = Budget(3.0)
    assert Budget.of(budget) is budget
    assert Budget.of(3).seconds == 3


def test_stages_are_always_said_and_progress_once_a_second(monkeypatch):
    now, words = [100.0], []
    monkeypatch.setattr("kilter.budget.perf_counter", lambda: now[0])
    budget = Budget(50.0, words.append)
    part = budget.fraction_left(0.5)
    budget.stage("begins")
    for k in range(30):
        now[0] += 0.1 * BETWEEN_WORDS
        (part if k % 2 else budget).tell(f"step {k}")
    assert words[0] == "begins"
    assert len(words) == 1 + 2  # 3 seconds, rounding may take one
