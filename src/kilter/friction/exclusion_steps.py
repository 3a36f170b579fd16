"""Steps of a proof that no motion can start, with all data needed to repeat them.

    moments   multipliers of products of the law          a bound of the power
    power     multipliers of the rows of the relaxation   a bound of the power
    shrink    the same for one quantity after another     bounds of forces and speeds
    cases     a tree: each case with its power steps, closed or divided further

`kilter.friction.exclusion_check` repeats them on the law of a program: each bound follows from the
multipliers, whatever their origin. Multipliers of linear programs are mostly 0, so they are stored
as indices and values.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from kilter.arrays import Array, Index
from kilter.friction.moment_bound import MomentStep
from kilter.mechanics.proof_form import MalformedProof

__all__ = ["CaseStep", "ExclusionStep", "PowerStep", "Quantity", "ShrinkStep"]


@dataclass(frozen=True, slots=True, eq=False)
class PowerStep:
    """Row multipliers that bound the power in a linear program, and the next tangent point."""

    rows: Index
    """Rows with nonzero multipliers."""
    values: Array
    """Those multipliers."""
    tangent: Array | None
    """Motion at which the ball of motions gets a further tangent, shape (n,)."""

    @classmethod
    def of(cls, multipliers: Array, tangent: Array | None) -> PowerStep:
        """Make a `PowerStep` from the multipliers of all rows, without storing zeros."""
        rows = np.flatnonzero(multipliers)
        return cls(rows, multipliers[rows], tangent)

    def over(self, count: int) -> Array:
        """Multipliers of all `count` rows as a dense array, with zeros added.

        Raises `MalformedProof` if a row does not exist.
        """
        if self.rows.max(initial=-1) >= count:
            raise MalformedProof("a row does not exist")
        multipliers = np.zeros(count)
        multipliers[self.rows] = self.values
        return multipliers


@dataclass(frozen=True, slots=True, eq=False)
class Quantity:
    """A bounded quantity by its number, with the row multipliers that prove its new bound."""

    number: int
    multipliers: PowerStep


@dataclass(frozen=True, slots=True, eq=False)
class ShrinkStep:
    """New bounds of several quantities, proved one after the other."""

    quantities: tuple[Quantity, ...]


@dataclass(slots=True, eq=False)
class CaseStep:
    """A case of contact modes: proofs of its power bound, and subcases if it is divided."""

    powers: list[PowerStep] = field(default_factory=list)
    point: int = -1
    patch: int = -1
    """Index of the point or patch at which it is divided; both -1 if it is closed."""
    cases: list[CaseStep] = field(default_factory=list)
    """The cases that cover it."""


ExclusionStep = MomentStep | PowerStep | ShrinkStep | CaseStep
