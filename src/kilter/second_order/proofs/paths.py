"""Falling paths z(t) = t dp + t^2 d2 / 2 along which no gap closes and energy decreases.

    J_k dp >= 0, w.dp = 0;   J_k d2 + dp.H_k dp >= m for rows with J_k dp = 0;
    w.d2 - dp.S dp >= m,   m > 0

Then each gap is at least m t^2 / 2 + O(t^3), or opens to first order, and the energy is
-t^2 (w.d2 - dp.S dp) / 2, with the springs S: the configuration is no minimum. With rounded numbers
both statements hold only from some t on. A gap that opens to first order must not close again too
soon after that t. The gaps may close at first only by the rounding of the data: a configuration in
a shallow hollow is a minimum, however strongly the wall of the hollow curves.

Joints stay closed: J_k dp = 0 and J_k d2 + dp.H_k dp = 0 for their rows. The error that is left is
of third order.

Parts that are pressed between planes have no such path, because no motion opens both planes. There
a path may keep contacts: if both parts only shift along a plane of one of them, the gap stays
unchanged to all orders. `path_search` finds paths; this module judges them from the numbers of the
problem alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array, Mask
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.second_order_tolerances import (
    ACROSS,
    DROPS,
    KEEPS,
    LASTS,
    REACHES,
    SLIPS,
)

FARTHEST = REACHES[-1] * (1 + ACROSS)
"""Largest component of a second derivative d2, with an allowance for rounding [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Path:
    """A path of the parts in scaled unknowns, with figures that decide whether it falls."""

    first: Array
    second: Array
    """dp, of length 1, and d2, shape (n,)."""
    opens: float
    """Least second derivative of a gap that stays closed to first order."""
    power: float
    """w.d2 - dp.S dp."""
    slips: float
    """Largest of -J dp and |w.dp|."""
    lasts: float
    """Least t at which a gap that opens to first order closes again."""
    rounding: float
    slack: float
    """Rounding of the data in `opens` and `power`, and in `slips`."""
    one_form: bool
    """Whether no flush corner slips off its edge."""
    parts_joints: float = 0.0
    """Largest second derivative of the error of a joint."""

    @property
    def falls(self) -> bool:
        """True if the path proves that the configuration is no energy minimum."""
        least = min(self.opens, self.power)
        straight = float(np.linalg.norm(self.second)) <= FARTHEST * np.sqrt(len(self.second))
        begins = min(self.slack, SLIPS * least, self.lasts * least / (2 * LASTS))
        joined = self.parts_joints <= max(ACROSS, self.rounding)
        return joined and straight and least > max(DROPS, self.rounding) and self.slips <= begins


def judge_path(problem: Stationary, first: Array, second: Array) -> Path:
    """Make a path from its first and second derivative, and compute the figures that decide."""
    first_opens = problem.rows @ first
    second_opens = problem.rows @ second + problem.bends(first)
    joined = problem.two_sided
    kept, later = _kept(problem, first, second) | joined, first_opens <= DROPS
    closes = ~later & (second_opens < 0) & ~joined
    lasts = (2 * first_opens[closes] / -second_opens[closes]).min(initial=np.inf)
    slips = max(float(-first_opens.min(initial=0.0)), abs(float(problem.load @ first)))
    slips = max(slips, float(first_opens[joined].max(initial=0.0)))
    parted = float(np.abs(second_opens[joined]).max(initial=0.0))
    opens = second_opens[later & ~kept]
    least = float(opens.min()) if len(opens) else 1.0
    power = float(problem.load @ second) - problem.spring_cost(first)
    blurred = problem.blur * float(np.abs(second).max(initial=0.0))
    one_form = bool(problem.one_form(first[:, None]).all())
    slack = max(ACROSS, problem.blur)
    return Path(first, second, least, power, slips, float(lasts), blurred, slack, one_form, parted)


def _kept(problem: Stationary, first: Array, second: Array) -> Mask:
    """Mask of rows at planes whose gap the path keeps, because no part turns, shape (K,)."""
    path = np.column_stack([first, second])
    moved = np.abs(problem.rows @ path).max(axis=1, initial=0.0)
    turned = np.append(np.abs(path).max(axis=1), 0.0)[problem.columns[:, [3, 4, 5, 9, 10, 11]]]
    kept: Mask = problem.planes & (moved < KEEPS) & (turned.max(axis=1, initial=0.0) == 0)
    return kept
