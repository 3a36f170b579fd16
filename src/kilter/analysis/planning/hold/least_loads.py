"""Forces of an equilibrium in which hands and supports carry the least that suffices.

    min  sum of |F|^2 + |T/r|^2 over the hands, and of |F|^2 over the points of the supports,
    J^T f + hands + w = 0,  f in Coulomb's cones

A hand carries a force F and a torque T about the centre of mass of its part, whose radius is r. The
forces of a proof are any equilibrium, so in these a hand may carry what contacts could carry.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kilter.arrays import Array
from kilter.mechanics.certificate import ForceProof, check_forces
from kilter.mechanics.coulomb_cones import cone_problem, least_forces
from kilter.mechanics.program import Program
from kilter.mechanics.rows import ForceRows, fixing_rows

OUTSIDE = -1
"""Number of the ground among the parts of a program."""
OTHERS = 1e-8
"""Weight of the squares of all other forces, so that the solution is unique [-]."""
SMALL = 1e-6
"""Smaller loads of a hand are rounding [weight of its part]."""
LARGE = 10_000
"""Number of rows above which no least loads are searched: the search takes seconds."""


@dataclass(frozen=True, slots=True, eq=False)
class LeastLoads:
    """Forces of an equilibrium with least loads of hands and supports."""

    program: Program
    """The program with rows of the hands after its rows."""
    forces: ForceProof
    """Forces of these rows."""
    hands: Array
    """Force [N] of each hand on its part, and torque about its centre of mass [N x length unit],
    shape (h, 6)."""


def least_loads(
    program: Program, hands: list[int], supports: Array | None = None
) -> LeastLoads | None:
    """Search forces in which hands and supports carry least; None if they are no proof.

    Parameters
    ----------
    program : Program
        The parts in the hands are free.
    hands : list of int
        Indices of the parts in the hands.
    supports : ndarray, shape (K,), optional
        Push at each contact row of a support at which it carries nothing [N], as a vacuum is pulled
        by its pressure; NaN for other rows.

    Examples
    --------
    A hand holds a board of 2 kg, whose centre is .1 m beyond the edge of a table. The table carries
    nearly all of the weight:

    >>> import kilter
    >>> from kilter import Box, Part
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.program import build_program
    >>> table = Part("table", Box(1, 1, 1), [-0.5, 0, -0.5], grounded=True)
    >>> assembly = kilter.Assembly([table, Part("board", Box(1, 1, 0.1), [0.1, 0, 0.05], mass=2)])
    >>> found = least_loads(build_program(assembly, contacts(assembly)), [1])
    >>> (found.hands[0] + 0.0).round(3).tolist()
    [0.0, 0.0, 0.383, 0.0, -1.924, 0.0]
    """
    from kilter.solvers.clarabel import solve_conic

    count = len(program.part_a)
    idle = np.full(count, np.nan) if supports is None else supports
    counted = np.isfinite(idle)
    if count > LARGE or not (len(hands) or counted.any()):
        return None
    axes = np.eye(3)
    grips = [fixing_rows((OUTSIDE, k), program.center[k], axes, axes) for k in hands]
    whole = program.with_force_rows(ForceRows.join([program.force_rows, *grips]))
    wide = cone_problem(whole)
    carried = np.append(counted, np.ones(len(whole.part_a) - count, dtype=bool))
    across = np.tile(carried[wide.rough], wide.directions.shape[1])
    weights = np.where(np.append(carried, across), 1.0, OTHERS)
    wanted = whole.pull.copy()
    wanted[:count][counted] = idle[counted]
    answer = solve_conic(least_forces(wide, weights, wanted))
    if not answer.found:
        return None
    found = check_forces(whole, *wide.decoded(answer.x))
    loads = found.forces[count:].reshape(-1, 6)
    sizes = np.repeat(np.stack([np.ones(len(hands)), program.radius[hands]], axis=1), 3, axis=1)
    loads = np.where(np.abs(loads) <= SMALL * whole.weight[hands, None] * sizes, 0.0, loads)
    return LeastLoads(whole, found, loads) if found.holds else None
