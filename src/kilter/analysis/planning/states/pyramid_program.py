"""A linear program for the load factor of many states, which only changes its bounds.

    max lambda:  A f = lambda b,  f >= 0,  0 <= lambda <= 1          A = S J^T,  b = -S w

with each cone of friction replaced by rays on it, of the program of all parts. In a state the
columns of rows that it has not are fixed at 0, and the rows of parts that are not free have no
sides. So the matrix never changes, and the simplex goes on from its last basis.

Forces of the rays lie in Coulomb's cones, and so prove what they balance. A motion that the
pyramid does not hold may yet be held by the cones: it is offered, and judged by who asked.
"""

from __future__ import annotations

import numpy as np

from kilter.analysis.planning.states.state_programs import rows_of_state
from kilter.arrays import Array, Mask
from kilter.mechanics.coulomb_cones import pyramid, pyramid_forces
from kilter.mechanics.forms import load_factor, scaled_problem
from kilter.mechanics.program import Program
from kilter.work import Work

__all__ = ["PyramidProgram"]

SIDES = 4
"""Rays of each pyramid in space."""


class PyramidProgram:
    """The load factor of each state of an assembly, with friction pyramids in place of cones.

    - `solves`: number of programs that were solved.
    """

    def __init__(self, whole: Program) -> None:
        from kilter.solvers.highs import KeptProgram

        self._whole = whole
        self._rays = pyramid(whole, SIDES)
        self._problem = scaled_problem(self._rays)
        program = load_factor(self._problem)
        self._kept = KeptProgram(program, warm="dual", goal="point")
        self._lower, self._upper = program.lower[:-1], program.upper[:-1]
        self._free, self._present = whole.free.copy(), np.ones(len(whole.free), dtype=bool)
        self._on = np.ones(len(self._upper), dtype=bool)

    @property
    def solves(self) -> int:
        """Number of linear programs that were solved."""
        return self._kept.solves

    def far(self, present: Mask, free: Mask) -> int:
        """Number of parts whose presence or freedom differs from the state that was solved last."""
        return int(((present != self._present) | (free != self._free)).sum())

    def solve(
        self, present: Mask, free: Mask, *, work: Work | None = None
    ) -> tuple[Array, Array] | Array | None:
        """Solve a state: balancing forces (normal, tangential), or a motion; None if unsolved.

        Arguments: `present`, `free` (N,). Returns (K,).
        """
        self._change(present, free)
        answer = self._kept.solve(work=work)
        if not answer.found:
            return None
        factor = float(answer.x[-1])
        if factor > 0.5:
            forces = self._problem.forces(answer.x[:-1]) / factor
            return pyramid_forces(self._whole, self._rays, forces)
        if not len(answer.multipliers):
            return None
        motion = self._problem.motion(self._problem.over_weight(-answer.multipliers))
        return np.where(free[:, None], motion, 0.0)

    def _change(self, present: Mask, free: Mask) -> None:
        """Set the bounds of the linear program to those of a state."""
        on = rows_of_state(self._rays, present, free)
        columns = np.flatnonzero(on != self._on)
        if len(columns):
            lower = np.where(on[columns], self._lower[columns], 0.0)
            upper = np.where(on[columns], self._upper[columns], 0.0)
            self._kept.change_bounds(columns, lower, upper)
            self._on = on
        movable = np.flatnonzero(self._whole.free)
        changed = np.flatnonzero((free != self._free)[movable])
        if len(changed):
            per = len(self._whole.freedoms)
            rows = (changed[:, None] * per + np.arange(per)).reshape(-1)
            side = np.where(np.repeat(free[movable[changed]], per), 0.0, np.inf)
            self._kept.change_sides(rows, -side, side)
        self._present, self._free = present.copy(), free.copy()
