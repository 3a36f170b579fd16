"""Newton correction of nearly balanced contact forces, so that only rounding errors remain.

    min sum (df_n / f_n)^2 + |df_t|^2 / (mu f_n)^2:   A (f + df) = b

A certificate accepts an imbalance of 1e-9 of the weights, and a tiny coefficient of friction may
depend on it. The corrected forces leave an imbalance of 1e-15, so the friction that they use is
sufficient. The correction is relative to the force at each contact, so contacts with small forces
keep small forces.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, diags_array

from kilter.arrays import TINY, Array
from kilter.mechanics.coulomb_cones import ConeProblem

__all__ = ["balanced_forces"]

REGULAR = 1e-14
"""Regularisation of the normal equations, relative to their largest diagonal entry; iterative
refinement removes its effect. A larger value is more robust on singular systems but needs more
refinement.
"""
REFINED = 8
"""Maximum number of refinement steps."""
SLOWEST = 0.5
"""Refinement ends if a step leaves more than this fraction of the previous imbalance [-]. A larger
value allows slower progress.
"""


def balanced_forces(cones: ConeProblem, forces: Array, friction: Array) -> tuple[Array, Array]:
    """Correct normal and friction forces to the nearest balanced forces, (K,) and (K, 3) [N].

    The result may leave the friction cones by as much as it changes, and it is not better balanced
    than the input if no forces on the pressed contacts balance. So check it with a certificate.

    Arguments: `forces`, `friction`: forces along and across the rows [N].

    Examples
    --------
    >>> from kilter.scenes import stacks
    >>> from kilter.contact import contacts
    >>> from kilter.mechanics.certificate import check_forces
    >>> from kilter.mechanics.coulomb_cones import cone_problem
    >>> from kilter.mechanics.program import build_program
    >>> block = stacks.block_on_slope(0.0, friction=0.5)
    >>> program = build_program(block, contacts(block))
    >>> near = np.full(4, program.weight[1] / 4) * (1 + 1e-6 * np.arange(4))
    >>> forces, friction = balanced_forces(cone_problem(program), near, np.zeros((4, 3)))
    >>> check_forces(program, near).residual > 1e-7
    True
    >>> check_forces(program, forces, friction).residual < 1e-14
    True
    """
    from scipy.sparse.linalg import splu  # slow to import

    problem, program, rough = cones.problem, cones.program, cones.rough
    tangential = np.einsum("rdi,ri->dr", cones.directions, friction[rough])
    x = np.concatenate([forces, tangential.ravel()]) / (problem.unit * problem.program.arm)
    # a two-sided row without force may take any: its weight must not vanish
    size = np.where(program.two_sided, np.abs(x[: len(forces)]) + 1.0, np.abs(x[: len(forces)]))
    friction_size = np.tile(program.mu[rough] * size[rough], len(tangential))
    weight = np.concatenate([size, friction_size]) ** 2
    matrix = problem.matrix
    normal = csc_array(matrix @ diags_array(weight) @ matrix.T)
    largest = float(normal.diagonal().max(initial=TINY))
    factor = splu(
        csc_array(normal + diags_array(np.full(normal.shape[0], REGULAR * largest))),
        permc_spec="MMD_AT_PLUS_A",
        options={"SymmetricMode": True},
    )
    residual = problem.right - matrix @ x
    for _ in range(REFINED):
        refined = x + weight * (matrix.T @ factor.solve(residual))
        new_residual = problem.right - matrix @ refined
        old_size, new_size = (
            float(np.abs(residual).max(initial=0.0)),
            float(np.abs(new_residual).max(initial=0.0)),
        )
        # refinement no longer helps: the system is singular, or rounding is reached
        if not new_size < old_size:
            break
        x, residual = refined, new_residual
        if new_size > SLOWEST * old_size:
            break
    return cones.decoded(x)
