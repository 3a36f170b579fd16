"""Least fraction of the strength of bonds and straps with which contact forces balance the parts.

    s = min s:  J^T f + w - (1 - s) c = 0,  f_n >= 0,  |f_t| <= mu f_n + s S      c: the clamps

c are the clamping wrenches of bonds and straps, S shear strengths. The pull of a strap with a
capacity LC is at most s LC. One conic program computes s. Its
feasible set has a nonempty interior for every s. If s is at most 1, its forces are within the
strength of the bonds. If s is above 1, its motion gains more power than the bonds absorb.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.coulomb_cones import ConeProblem, least_strength
from kilter.work import Work

__all__ = ["Strength", "find_strength"]


@dataclass(frozen=True, slots=True, eq=False)
class Strength:
    """The least fraction of bond strength that balances the parts, with forces and a motion.

    The forces and the motion are offered as proofs.
    """

    share: float
    """s, at least 0 [-]; infinite if no share suffices."""
    forces: Array
    friction: Array
    """Contact forces along and across the rows [N] that balance the parts at that share. Zero if
    the share is infinite."""
    motion: Array
    """Motion that starts if the strength falls below that share, shape (N, 6)."""
    word: str
    """Description of the solver run."""


def find_strength(wide: ConeProblem, *, work: Work | None = None) -> Strength | None:
    """Compute the least fraction of the strength of all bonds that balances the parts.

    None if the solver finds no solution.

    Returns None if the solver fails.

    Examples
    --------
    >>> from kilter import Assembly, Bond, Box, Part, Pose
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.coulomb_cones import cone_problem
    >>> from kilter.mechanics.program import build_program
    >>> wall = Part("wall", Box([1, 1, 1]), Pose([1, 0, 0]), grounded=True)
    >>> glue = Bond(("block", "wall"), pull=1e5, shear=9810 / 4)
    >>> glued = Assembly([wall, Part("block", Box([1, 1, 1]))], bonds=[glue])
    >>> found = find_strength(cone_problem(build_program(glued, contacts(glued))))
    >>> round(found.share, 6)  # four corners, the weight in the middle: all bear alike
    1.0
    """
    from kilter.solvers.clarabel import solve_conic

    program = wide.program
    unit = float(program.weight[program.free].sum()) / program.strength  # keeps s / unit near 1
    answer = solve_conic(least_strength(wide, unit), work=work)
    none = answer.proves_none
    if not (answer.found or none):
        return None
    problem = wide.problem
    x = np.zeros(problem.matrix.shape[1] + 1) if none else answer.x
    multipliers = answer.multipliers[: len(problem.right)]
    return Strength(
        np.inf if none else max(float(x[-1]), 0.0) * unit,
        *wide.decoded(x[:-1]),
        problem.motion(problem.over_weight(multipliers)),
        f"least strength: clarabel, {answer.iterations} iterations, {answer.outcome}",
    )
