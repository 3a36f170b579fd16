"""The accuracy estimated from the values of a file."""

from __future__ import annotations

import numpy as np
import pytest

from kilter.files import load
from kilter.files.accuracy import text_accuracy

RNG = np.random.default_rng(3)
FULL = RNG.uniform(-20, 20, (50, 3))


def judged(values: np.ndarray, **options: bool) -> float | None:
    return text_accuracy(values, **options)(values)


def test_float32_printed_in_full() -> None:
    single = FULL.astype(np.float32).astype(np.float64)
    assert judged(single) == np.abs(single).max() * 2**-24


def test_the_largest_of_each_mesh_counts() -> None:
    single = FULL.astype(np.float32).astype(np.float64)
    assert text_accuracy(single)(single[:1]) == np.abs(single[0]).max() * 2**-24


@pytest.mark.parametrize("places", range(5, 10))
def test_decimals_that_were_rounded(places: int) -> None:
    assert judged(np.round(FULL, places)) == pytest.approx(0.5 * 10**-places)


@pytest.mark.parametrize("places", range(5))
def test_few_decimals_are_meant(places: int) -> None:
    assert judged(np.round(FULL, places)) is None


@pytest.mark.parametrize("places", [10, 12])
def test_many_decimals_are_float64(places: int) -> None:
    assert judged(np.round(FULL, places)) is None


def test_full_float64() -> None:
    assert judged(FULL) is None


def test_short_dyadic_numbers_prove_nothing() -> None:
    assert judged(np.array([0.5, 0.25, 12.125, 3])) is None


def test_one_number_that_is_no_float32_decides() -> None:
    single = FULL.astype(np.float32).astype(np.float64)
    single[7, 1] = 1 / 3
    assert judged(single) is None


@pytest.mark.parametrize("digits", [5, 6, 7])
def test_digits_behind_an_exponent(digits: int) -> None:
    printed = np.array([float(f"{x:.{digits}e}") for x in FULL.ravel() * 50])
    assert judged(printed, exponent=True) == pytest.approx(0.5 * 10.0 ** (2 - digits))


def test_a_few_round_numbers_behind_an_exponent_are_meant() -> None:
    assert judged(np.array([0.0, 1e3, 2.5e-4]), exponent=True) is None


@pytest.mark.parametrize("values", [[], [np.nan], [np.inf, 1], [1e300, -1e300], [5e-324]])
def test_odd_values_do_no_harm(values: list[float]) -> None:
    judged(np.array(values))
    judged(np.array(values), exponent=True)


def test_an_obj_of_float32_is_known_as_such(write, obj_box) -> None:
    single = np.float32(0.2525).item()
    assembly = load(write("a.obj", obj_box(2 * single)))
    assert assembly.geometry.accuracy == pytest.approx([single * 2**-24])
    assert assembly.geometry.single.all()


def test_an_obj_of_meant_numbers_is_exact(write, obj_box) -> None:
    assert not load(write("a.obj", obj_box(0.5))).geometry.single.any()
