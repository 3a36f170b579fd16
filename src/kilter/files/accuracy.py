"""How far the coordinates of a file may be from the truth [length unit].

A file of decimals does not say how they were made. Three makers are told apart by the values
themselves:

- A program that computes in float32 and prints every digit: each value is exactly a float32,
  and some is no short decimal (0.2525 comes out as 0.25249999761581421). Its rounding is
  ``2^-24 x largest``. Values such as 0.5 or 0.125 are exact in both and prove nothing.
- A program that prints k decimals (``%.6f``): every value is a multiple of 10^-k, and not
  all are multiples of 10^-(k-1). Its rounding is ``0.5 x 10^-k``. Below k = 5 the numbers are
  taken as meant (a part of 12.25 mm is 12.25 mm), above k = 9 as full float64.
- A program that prints k digits and an exponent (``%e``, the usual ASCII STL): likewise with
  digits after the first, ``0.5 x 10^(e - k)``, e = exponent of the largest value.

Anything else is float64, ``2^-53 x largest``. The estimate errs towards too fine: a file of
a few round numbers looks exact although its maker rounded.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from kilter.arrays import Array

__all__ = ["SINGLE", "text_accuracy"]


SINGLE = 2.0**-24
"""Relative rounding of float32."""
FEWEST, MOST = 5, 9
"""Decimals that are taken as rounding: fewer are meant, more are float64."""
SAMPLE = 10_000
"""Numbers with an exponent that are looked at."""


def text_accuracy(values: ArrayLike, *, exponent: bool = False) -> Callable[[Array], float | None]:
    """How accurate numbers read from text are, judged from all of a file together.

    Parameters
    ----------
    values : array_like
        Every coordinate of the file.
    exponent : bool
        The numbers were written with an exponent (``1.234568e+01``).

    Returns
    -------
    callable
        From the coordinates of one mesh to its accuracy [length unit]; None = float64.

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
    judged: Array = np.array(values, dtype=np.float64).reshape(-1)
    judged = judged[np.isfinite(judged)]
    with np.errstate(over="ignore"):
        single = bool((judged.astype(np.float32) == judged).all())
    if single and not _is_rounded(judged, MOST):
        return lambda own: SINGLE * float(np.abs(own).max(initial=0.0))
    step = _mantissa_step(judged) if exponent else _decimal_step(judged)
    return lambda own: step


def _decimal_step(values: Array) -> float | None:
    if _is_rounded(values, FEWEST - 1):
        return None
    for k in range(FEWEST, MOST + 1):
        if _is_rounded(values, k):
            return float(0.5 * 10.0**-k)
    return None


def _mantissa_step(values: Array) -> float | None:
    values = np.unique(values[values != 0])
    if not len(values):
        return None
    # the shortest digits that give the number, of a spread of them where there are many
    chosen = values[np.unique(np.linspace(0, len(values) - 1, SAMPLE).astype(int))]
    printed = [np.format_float_scientific(value, trim="-").split("e") for value in chosen]
    step = _decimal_step(np.array([float(mantissa) for mantissa, _ in printed]))
    return None if step is None else step * 10.0 ** max(int(power) for _, power in printed)


def _is_rounded(values: Array, k: int) -> bool:
    """Every value is the float64 nearest to a decimal of k places."""
    # past 2^53 / 10^k a float64 has no digits behind the k-th place to judge by
    judged = values[np.abs(values) < 2.0**53 / 10.0**k]
    return bool((np.round(judged, k) == judged).all())
