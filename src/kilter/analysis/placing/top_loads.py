"""The least load that the top of an item must carry, in all forces that balance a pile.

Forces of a pile are not unique. With the normal forces n on the top of an item, over all contact
forces f that balance the pile,

    load = min  sum n(f)   subject to   A f = b,  f in the cones.

No forces exist with a smaller load on this top, so an item whose limit is below it is overloaded.
With friction, pyramids around the cones contain them, so the load is a lower bound.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.coulomb_cones import pyramid
from kilter.mechanics.forms import equilibrium, scaled_problem
from kilter.mechanics.program import Program

__all__ = ["least_top_load"]

FLAT = 0.999
"""Least vertical component of the normal of a contact on a top [-]."""
SIDES = 16
"""Sides of the pyramid around each friction cone."""


def least_top_load(program: Program, name: str) -> float | None:
    """Compute the least sum of normal forces on the top of a part [N]; None if it is not proved.

    Examples
    --------
    >>> from kilter import Assembly, Box, Part, Pose, contacts
    >>> from kilter.mechanics.program import build_program
    >>> base = Part("base", Box([1, 1, 1]), grounded=True)
    >>> boxes = [Part(f"b{k}", Box([1, 1, 1]), Pose([0, 0, k]), mass=k) for k in (1, 2)]
    >>> pile = Assembly([base, *boxes])
    >>> program = build_program(pile, contacts(pile))
    >>> round(least_top_load(program, "b1") / program.g, 9)
    2.0
    >>> least_top_load(program, "b2")
    0.0
    """
    from kilter.solvers.highs import solve_linear

    top = _downward_on(program, program.names.index(name))
    if not top.any():
        return 0.0
    rays = pyramid(program, SIDES, outer=True)
    problem = scaled_problem(rays)
    normal_force = _of_rays(program, rays, top) * problem.forces(np.ones(len(rays.part_a)))
    answer = solve_linear(replace(equilibrium(problem), cost=normal_force / problem.unit))
    if not answer.holds:
        return None
    return max(answer.objective * problem.unit, 0.0)


def _downward_on(program: Program, k: int) -> Array:
    """1 for each contact row that presses on the top of a part, else 0; shape (K,)."""
    upward = program.normal[:, 2]
    top = ((program.part_a == k) & (upward > FLAT)) | ((program.part_b == k) & (upward < -FLAT))
    chosen: Array = (top & ~program.angular).astype(float)
    return chosen


def _of_rays(program: Program, rays: Program, top: Array) -> Array:
    """Normal component of a unit force along each row of the pyramids, on the chosen rows."""
    if rays is program:
        return top
    smooth, rough = np.flatnonzero(program.mu <= 0), program.rough
    sides = (len(rays.part_a) - len(smooth)) // len(rough)
    rows = np.concatenate([smooth, np.repeat(rough, sides)])
    along: Array = top[rows] * np.einsum("ij,ij->i", rays.normal, program.normal[rows])
    return along
