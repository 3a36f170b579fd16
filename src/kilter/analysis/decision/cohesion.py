"""Least cohesion (tension that contacts need) with which contact forces balance the parts.

Its sign decides whether the contacts hold without cohesion.

    c(mu) = min c:  J^T f + w = 0,  |f_t| <= mu f_n + c w_i

One conic program computes c. Its feasible set has a nonempty interior for either sign of c.
Therefore its forces (c < 0) or its motion (c > 0) are accurate to rounding, as near to the limit
of stability as c differs from 0. The load factor, which is 0 or 1, is less accurate there. The
slope of c over mu estimates the coefficient at which c is 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.coulomb_cones import ConeProblem, cohesion_slope, least_cohesion
from kilter.work import Work


@dataclass(frozen=True, slots=True, eq=False)
class Cohesion:
    """The least cohesion with which contact forces balance, with these forces and a dual motion."""

    value: float
    """Cohesion over the weight of the lighter part at each contact [-], at least -1."""
    slope: float
    """Decrease of `value` per increase of every friction coefficient [-], at least 0."""
    forces: Array
    friction: Array
    """Contact forces along and across the rows [N]. They obey the friction cones if `value` is
    at most 0."""
    motion: Array
    """Motion in the dual cones, shape (N, 6). Its power is positive if `value` is positive."""
    word: str
    """Description of the solver run."""

    @property
    def rise(self) -> float:
        """Increase of every friction coefficient [-] after which forces balance without cohesion.

        The value is of first order; infinite if friction does not reduce the least cohesion.
        """
        return self.value / self.slope if self.slope > 0.0 else np.inf


def find_cohesion(wide: ConeProblem, *, work: Work | None = None) -> Cohesion | None:
    """Compute the least cohesion of contacts with which forces balance; None if unsolved.

    Returns None if no forces balance the parts with any cohesion, or if the solver fails.

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.coulomb_cones import cone_problem
    >>> from kilter.mechanics.program import build_program
    >>> def cohesion(degrees):
    ...     block = stacks.block_on_slope(degrees, friction=0.5)
    ...     return find_cohesion(cone_problem(build_program(block, contacts(block))))
    >>> cohesion(26.56).value < 0 < cohesion(26.57).value  # arctan .5 is 26.565 degrees
    True
    >>> round(0.5 + cohesion(20.0).rise, 9), round(float(np.tan(np.radians(20.0))), 9)
    (0.363970234, 0.363970234)
    """
    from kilter.solvers.clarabel import solve_conic

    answer = solve_conic(least_cohesion(wide), work=work)
    if not answer.found:
        return None
    problem = wide.problem
    multipliers = answer.multipliers[: len(problem.right)]
    return Cohesion(
        float(answer.x[-1]),
        cohesion_slope(wide, answer),
        *wide.decoded(answer.x[:-1]),
        problem.motion(problem.over_weight(multipliers)),
        f"least cohesion: clarabel, {answer.iterations} iterations, {answer.outcome}",
    )
