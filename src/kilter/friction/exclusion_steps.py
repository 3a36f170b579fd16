"""The steps of a proof that no motion can start, with all that it takes to repeat them.

    moments   multipliers of products of the law          a bound of the power
    power     multipliers of the rows of the relaxation   a bound of the power
    shrink    the same of one quantity after another      bounds of forces and speeds
    cases     a tree: each case with its power steps, closed or divided further

`kilter.friction.exclusion_check` repeats them on the law of a program: each bound follows from
the multipliers, whoever found them. Multipliers of linear programs are mostly 0, and kept as
places and values.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kilter.arrays import Array, Index
from kilter.friction.moment_bound import MomentStep

__all__ = ["CaseStep", "ExclusionStep", "PowerStep", "Quantity", "ShrinkStep"]


@dataclass(frozen=True, slots=True, eq=False)
class PowerStep:
    """Multipliers of the rows of a linear program; at which motion its ball gets a tangent.

    Attributes
    ----------
    rows : ndarray of int
        Where they are not 0.
    values : ndarray
    tangent : ndarray, shape (n,), or None
    """

    rows: Index
    values: Array
    tangent: Array | None

    @classmethod
    def of(cls, multipliers: Array, tangent: Array | None) -> PowerStep:
        """A step of all its multipliers."""
        rows = np.flatnonzero(multipliers)
        return cls(rows, multipliers[rows], tangent)

    def over(self, count: int) -> Array:
        """The multipliers of so many rows."""
        multipliers = np.zeros(count)
        multipliers[self.rows] = self.values
        return multipliers


@dataclass(frozen=True, slots=True, eq=False)
class Quantity:
    """One bounded quantity: its number in the relaxation, and the multipliers."""

    number: int
    multipliers: PowerStep


@dataclass(frozen=True, slots=True, eq=False)
class ShrinkStep:
    """Bounds of quantities, one after the other over the same relaxation."""

    quantities: tuple[Quantity, ...]


@dataclass(slots=True, eq=False)
class CaseStep:
    """A case: bounds of its power, and where it is divided if they do not close it.

    Attributes
    ----------
    powers : list of PowerStep
    point, patch : int
        One of the two, or both -1 where it is closed.
    cases : list of CaseStep
    """

    powers: list[PowerStep] = field(default_factory=list)
    point: int = -1
    patch: int = -1
    cases: list[CaseStep] = field(default_factory=list)


ExclusionStep = MomentStep | PowerStep | ShrinkStep | CaseStep
