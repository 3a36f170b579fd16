"""The array idioms of the house, each against its plainest form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

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


def test_cross_is_numpys() -> None:
    a, b = np.random.default_rng(1).normal(size=(2, 50, 3))
    assert np.allclose(cross(a, b), np.cross(a, b), rtol=0, atol=1e-15)


@pytest.mark.parametrize("shape", [(3,), (0, 3), (40, 3), (2, 5, 3)])
def test_across_makes_a_right_handed_frame(shape: tuple[int, ...]) -> None:
    n = unit_rows(np.random.default_rng(2).normal(size=shape))
    u, v = across(n)
    assert u.shape == v.shape == shape
    frame = np.stack([u, v, n], axis=-2)
    assert np.allclose(frame @ frame.swapaxes(-1, -2), np.eye(3), rtol=0, atol=1e-15)
    assert np.allclose(np.linalg.det(frame), 1.0, rtol=0, atol=1e-14)


@pytest.mark.parametrize("axis", [*np.eye(3), *-np.eye(3)])
def test_across_an_axis_has_no_rounding(axis: Array) -> None:
    u, v = across(axis)
    assert sorted(np.abs([*u, *v]).tolist()) == [0, 0, 0, 0, 1, 1]


def test_ratio_and_unit_rows_are_finite_where_nothing_is_divided() -> None:
    assert ratio(0.0, 0.0) == 0.0
    assert ratio([1.0, 3.0], 2.0).tolist() == [0.5, 1.5]
    rows = unit_rows(np.array([[3.0, 4.0], [0.0, 0.0]]))
    assert rows.tolist() == [[0.6, 0.8], [0.0, 0.0]]


@given(COUNTS)
def test_runs_are_what_loops_make_of_them(count: list[int]) -> None:
    owner, place = counted(count)
    plain = [(k, j) for k, n in enumerate(count) for j in range(n)]
    assert list(zip(owner.tolist(), place.tolist(), strict=True)) == plain
    assert starts(count).tolist() == [sum(count[:k]) for k in range(len(count) + 1)]


@given(COUNTS.filter(len), st.data())
def test_ragged_rows_are_the_slices_one_after_the_other(count: list[int], data: object) -> None:
    which = data.draw(st.lists(st.integers(0, len(count) - 1), max_size=6))  # type: ignore[attr-defined]
    start = starts(count)
    owner, row = ragged(start, np.array(which, dtype=np.int64))
    plain = [(k, r) for k, w in enumerate(which) for r in range(start[w], start[w + 1])]
    assert list(zip(owner.tolist(), row.tolist(), strict=True)) == plain


def test_rows_are_taken_and_joined_together() -> None:
    five = things(5)
    some = five.take(np.array([3, 1]))
    assert (some.size * 2).tolist() == some.pair[:, 0].tolist() == some.at[:, 0].tolist() == [3, 1]
    assert five.take(five.flat).pair[:, 0].tolist() == [0, 2, 4]
    both = Things.join([some, Things.none(), five])
    assert len(both) == 7
    assert both.pair[:, 1].tolist() == [3, 1, 0, 1, 2, 3, 4]


def test_no_rows_keep_their_shapes_and_types() -> None:
    for none in (Things.none(), Things.join([]), things(4).take([])):
        assert len(none) == 0
        assert (none.at.shape, none.pair.shape, none.size.shape) == ((0, 3), (0, 2), (0,))
        assert (none.pair.dtype, none.flat.dtype) == (np.int64, np.bool_)


def test_read_only_arrays_are_views_that_refuse() -> None:
    mine = np.zeros(3)
    held = Things(np.zeros((3, 3)), np.zeros((3, 2), dtype=np.int64), mine, mine > 0)
    read_only(held)
    with pytest.raises(ValueError, match="read-only"):
        held.size[0] = 1.0
    mine[0] = 1.0  # the array that was given stays its owner's


@given(st.lists(st.tuples(st.integers(0, 7), st.integers(0, 7)), max_size=12))
def test_connected_things_share_a_number(pairs: list[tuple[int, int]]) -> None:
    first, second = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    label = connected(8, first, second)
    plain = list(range(8))  # each pair gives all of one group the number of the other
    for a, b in pairs:
        plain = [plain[a] if number == plain[b] else number for number in plain]
    same = [[label[a] == label[b] for a in range(8)] for b in range(8)]
    assert same == [[plain[a] == plain[b] for a in range(8)] for b in range(8)]


@pytest.mark.parametrize("seed", range(3))
def test_few_and_many_pairs_are_numbered_alike(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
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
