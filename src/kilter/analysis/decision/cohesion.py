"""The least cohesion with which contacts balance: a number whose sign says whether they hold.

    c(mu) = min c:  J^T f + w = 0,  |f_t| <= mu f_n + c w_i

by a conic program whose feasible set has an interior whatever the sign. So its forces if c < 0, and
its motion if c > 0, are accurate to rounding as close to a limit as c differs from 0. The load
factor, which is 0 or 1, is not. The slope of c predicts the mu at which c is 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.coulomb_cones import ConeProblem, cohesion_slope, least_cohesion
from kilter.work import Work

__all__ = ["Cohesion", "find_cohesion"]


@dataclass(frozen=True, slots=True, eq=False)
class Cohesion:
    """The least cohesion, and the proofs that its program offers.

    Attributes
    ----------
    value : float
        Over the weight of the lighter part at each contact [-], at least -1.
    slope : float
        By how much it falls with the friction of every contact, at least 0 [-].
    forces, friction : ndarray, shapes (K,), (K, 3)
        Along and across the rows [N]; in equilibrium if `value` is at most 0.
    motion : ndarray, shape (N, 6)
        In the dual cones; with power if `value` is above 0.
    word : str
        Name of the solver and of its outcome.
    """

    value: float
    slope: float
    forces: Array
    friction: Array
    motion: Array
    word: str

    @property
    def rise(self) -> float:
        """By how much every coefficient has to rise for a cohesion of 0, to first order."""
        return self.value / self.slope if self.slope > 0.0 else np.inf


def find_cohesion(wide: ConeProblem, *, work: Work | None = None) -> Cohesion | None:
    """The least cohesion of a program; None: no forces balance however contacts stick, or failed.

    Parameters
    ----------
    wide : ConeProblem
    work : Work, optional
        It is charged, and its time limit is kept.

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
