"""Arrays, work, and the nearest point of a cone."""

from __future__ import annotations  # the fields of Rows are read as text

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import nnls

from kilter.arrays import (
    Array,
    Index,
    Mask,
    Rows,
    across,
    angle_between,
    columns,
    connected,
    counted,
    cross,
    group_sums,
    ragged,
    ratio,
    read_only,
    starts,
    unit_rows,
)
from kilter.mechanics.nonnegative import nonnegative
from kilter.work import BETWEEN_WORDS, LEAST, PER_EFFORT, Work, units_of

COUNTS = st.lists(st.integers(0, 4), max_size=8)


@dataclass(frozen=True, slots=True, eq=False)
class Things(Rows):
    at: Array = columns(3)
    pair: Index = columns(2)
    size: Array
    flat: Mask


def things(n: int) -> Things:
    k = np.arange(n)
    return Things(np.outer(k, np.ones(3)), np.column_stack([k, k]), k / 2, k % 2 == 0)


def test_cross_is_numpys():
    a, b = np.random.default_rng(1).normal(size=(2, 50, 3))
    assert np.allclose(cross(a, b), np.cross(a, b), rtol=0, atol=1e-15)


@pytest.mark.parametrize("shape", [(3,), (0, 3), (40, 3), (2, 5, 3)])
def test_across_makes_a_right_handed_frame(shape):
    n = unit_rows(np.random.default_rng(2).normal(size=shape))
    u, v = across(n)
    assert u.shape == v.shape == shape
    frame = np.stack([u, v, n], axis=-2)
    assert np.allclose(frame @ frame.swapaxes(-1, -2), np.eye(3), rtol=0, atol=1e-15)
    assert np.allclose(np.linalg.det(frame), 1.0, rtol=0, atol=1e-14)


@pytest.mark.parametrize("axis", [*np.eye(3), *-np.eye(3)])
def test_across_an_axis_has_no_rounding(axis):
    u, v = across(axis)
    assert sorted(np.abs([*u, *v]).tolist()) == [0, 0, 0, 0, 1, 1]


def test_ratio_and_unit_rows_are_finite_where_nothing_is_divided():
    assert ratio(0.0, 0.0) == 0.0
    assert ratio([1.0, 3.0], 2.0).tolist() == [0.5, 1.5]
    rows = unit_rows(np.array([[3.0, 4.0], [0.0, 0.0]]))
    assert rows.tolist() == [[0.6, 0.8], [0.0, 0.0]]


@given(COUNTS)
def test_runs_are_what_loops_make_of_them(count):
    owner, place = counted(count)
    plain = [(k, j) for k, n in enumerate(count) for j in range(n)]
    assert list(zip(owner.tolist(), place.tolist(), strict=True)) == plain
    assert starts(count).tolist() == [sum(count[:k]) for k in range(len(count) + 1)]


@given(COUNTS.filter(len), st.data())
def test_ragged_rows_are_the_slices_one_after_the_other(count, data):
    which = data.draw(st.lists(st.integers(0, len(count) - 1), max_size=6))  # type: ignore[attr-defined]
    start = starts(count)
    owner, row = ragged(start, np.array(which, dtype=np.int64))
    plain = [(k, r) for k, w in enumerate(which) for r in range(start[w], start[w + 1])]
    assert list(zip(owner.tolist(), row.tolist(), strict=True)) == plain


def test_rows_are_taken_and_joined_together():
    five = things(5)
    some = five.take(np.array([3, 1]))
    assert (some.size * 2).tolist() == some.pair[:, 0].tolist() == some.at[:, 0].tolist() == [3, 1]
    assert five.take(five.flat).pair[:, 0].tolist() == [0, 2, 4]
    both = Things.join([some, Things.none(), five])
    assert len(both) == 7
    assert both.pair[:, 1].tolist() == [3, 1, 0, 1, 2, 3, 4]


def test_no_rows_keep_their_shapes_and_types():
    for none in (Things.none(), Things.join([]), things(4).take([])):
        assert len(none) == 0
        assert (none.at.shape, none.pair.shape, none.size.shape) == ((0, 3), (0, 2), (0,))
        assert (none.pair.dtype, none.flat.dtype) == (np.int64, np.bool_)


def test_read_only_arrays_are_views_that_refuse():
    mine = np.zeros(3)
    held = Things(np.zeros((3, 3)), np.zeros((3, 2), dtype=np.int64), mine, mine > 0)
    read_only(held)
    with pytest.raises(ValueError, match="read-only"):
        held.size[0] = 1.0
    mine[0] = 1.0  # the array that was given stays its owner's


@given(st.lists(st.tuples(st.integers(0, 7), st.integers(0, 7)), max_size=12))
def test_connected_things_share_a_number(pairs):
    first, second = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    label = connected(8, first, second)
    plain = list(range(8))  # each pair gives all of one group the number of the other
    for a, b in pairs:
        plain = [plain[a] if number == plain[b] else number for number in plain]
    same = [[label[a] == label[b] for a in range(8)] for b in range(8)]
    assert same == [[plain[a] == plain[b] for a in range(8)] for b in range(8)]


@pytest.mark.parametrize("seed", range(3))
def test_few_and_many_pairs_are_numbered_alike(seed, monkeypatch):
    rng = np.random.default_rng(seed)
    chain = rng.permutation(300)
    for first, second in [rng.integers(0, 300, (2, 250)), (chain[:-1], chain[1:])]:
        few = connected(300, first, second)
        with monkeypatch.context() as patch:
            patch.setattr("kilter.arrays.FEW", -1)
            assert few.tolist() == connected(300, first, second).tolist()


@pytest.mark.quick(2)
@pytest.mark.parametrize("shape", [(), (3,), (2, 3)])
@given(group=st.lists(st.integers(0, 4), max_size=8))
def test_group_sums_add_the_rows_of_each_group(shape, group):
    values = np.random.default_rng(0).normal(size=(len(group), *shape))
    expected = np.zeros((5, *shape))
    np.add.at(expected, np.array(group, dtype=np.int64), values)
    sums = group_sums(np.array(group, dtype=np.int64), values, 5)
    assert sums.dtype == np.float64
    assert np.array_equal(sums, expected)


@pytest.mark.parametrize("angle", [0.0, 1e-12, 0.5, np.pi / 2, 3.0, np.pi])
def test_angle_between_is_accurate_at_every_angle_and_length(angle):
    a, b = np.array([2.0, 0, 0]), 3 * np.array([np.cos(angle), np.sin(angle), 0])
    assert angle_between(a, b) == pytest.approx(angle, rel=1e-14, abs=1e-15)
    assert angle_between(np.tile(a, (2, 4, 1)), b).shape == (2, 4)


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


def test_the_distance_is_that_of_the_weights():
    """The nearest point is half of (0, -1, 1, 0); the residual that `nnls` states is shorter."""
    vectors = np.array([[0.0, -1, 1, 0], [0, -1, 1, 0], [0, -1, 1, 1]])
    target = np.array([2.0, -2, -1, 0])
    weights, distance = nonnegative(vectors, target)
    assert distance == pytest.approx(np.sqrt(9 - 1 / 2), rel=1e-12)
    assert weights @ vectors == pytest.approx([0, -0.5, 0.5, 0], abs=1e-12)
    assert nnls(vectors.T, target)[1] <= distance + 1e-12


@pytest.mark.parametrize("seed", range(3))
def test_no_vector_leads_nearer(seed):
    rng = np.random.default_rng(seed)
    for _ in range(30):
        vectors = rng.integers(-1, 2, size=rng.integers(2, [40, 8])).astype(float)
        vectors = np.vstack([vectors, -vectors[: len(vectors) // 2]])
        target = rng.integers(-2, 3, size=vectors.shape[1]).astype(float)
        weights, distance = nonnegative(vectors, target)
        left = target - weights @ vectors
        assert weights.min() >= 0
        assert np.linalg.norm(left) == pytest.approx(distance, abs=1e-12)
        assert (vectors @ left).max() <= 1e-7
