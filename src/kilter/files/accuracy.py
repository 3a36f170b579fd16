"""Estimate the error of the coordinates in a text file [length unit].

A file of decimals does not state their accuracy. The values themselves distinguish three kinds of
writers:

- A program that computes in float32 and prints every digit. Each value is exactly a float32, and
  at least one value is not a short decimal (0.2525 is printed as 0.25249999761581421). Its
  rounding is ``2^-24 x largest``. Values such as 0.5 or 0.125 are exact in both and prove nothing.
- A program that prints k decimals (``%.6f``). Every value is a multiple of 10^-k, and not
  all are multiples of 10^-(k-1). Its rounding is ``0.5 x 10^-k``. Below k = 5 the numbers are
  assumed exact (12.25 mm is 12.25 mm), above k = 9 they are full float64.
- A program that prints k digits and an exponent (``%e``, the usual ASCII STL). The same rule holds
  for the digits after the first: ``0.5 x 10^(e - k)``, e = exponent of the largest value.

All other values are float64, ``2^-53 x largest``. The estimate errs towards too small an error: a
file of a few round numbers looks exact although its writer rounded.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array

__all__ = ["SINGLE", "text_accuracy"]


SINGLE = 2.0**-24
"""Relative rounding error of float32 [-]."""
FEWEST, MOST = 5, 9
"""Numbers of decimals that count as rounded; fewer decimals are exact, more are float64."""
SAMPLE = 10_000
"""Largest number of values with an exponent that are examined; more take longer."""


def text_accuracy(values: ArrayLike, *, exponent: bool = False) -> Callable[[Array], float | None]:
    """Estimate how coarsely the numbers of a text file are rounded, from all its coordinates.

    Returns function from the coordinates of a mesh of the file to their largest error [length
    unit]; None for float64.

    Examples
    --------
    >>> import numpy as np
    >>> for values in ([0.25249999761581421, 1.0], [0.333333, 1], [0.5, 12.25], [1 / 3, 1]):
    ...     print(text_accuracy(values)(np.array(values)))
    5.960464477539063e-08
    5e-07
    None
    None
    """
    finite: Array = np.array(values, dtype=np.float64).reshape(-1)
    finite = finite[np.isfinite(finite)]
    with np.errstate(over="ignore"):
        single = bool((finite.astype(np.float32) == finite).all())
    if single and not _is_rounded(finite, MOST):
        return lambda coordinates: SINGLE * float(np.abs(coordinates).max(initial=0.0))
    step = _mantissa_step(finite) if exponent else _decimal_step(finite)
    return lambda coordinates: step


def _decimal_step(values: Array) -> float | None:
    """Half of the last printed decimal place; None if the values are exact decimals or float64."""
    if _is_rounded(values, FEWEST - 1):
        return None
    for k in range(FEWEST, MOST + 1):
        if _is_rounded(values, k):
            return float(0.5 * 10.0**-k)
    return None


def _mantissa_step(values: Array) -> float | None:
    """Half of the last printed digit of the largest number, for numbers like ``1.2346e+01``."""
    values = np.unique(values[values != 0])
    if not len(values):
        return None
    # the shortest digits that reproduce each number, for an evenly spread sample
    chosen = values[np.unique(np.linspace(0, len(values) - 1, SAMPLE).astype(int))]
    printed = [np.format_float_scientific(value, trim="-").split("e") for value in chosen]
    step = _decimal_step(np.array([float(mantissa) for mantissa, _ in printed]))
    return None if step is None else step * 10.0 ** max(int(power) for _, power in printed)


def _is_rounded(values: Array, k: int) -> bool:
    """Whether every value is a number of at most k decimal places, as nearly as float64 can be."""
    # a float64 above 2^53 / 10^k has no digits after the k-th place
    small = values[np.abs(values) < 2.0**53 / 10.0**k]
    return bool((np.round(small, k) == small).all())
