"""Forces that nearly balance, made to balance to rounding: the nearest, as their cones measure.

    min sum (df_n / f_n)^2 + |df_t|^2 / (mu f_n)^2:   A (f + df) = b

What a certificate lets forces leave (1e-9 of the weights) a coefficient of friction that is tiny
may hang on. These leave 1e-15, and the friction that they use is enough: what changes, changes
by a share of what is there, so that contacts which hardly press stay as they are.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, diags_array

from kilter.arrays import TINY, Array
from kilter.mechanics.coulomb_cones import ConeProblem

__all__ = ["balanced_forces"]

REGULAR = 1e-14
"""Added to the diagonal of the equations, over its largest entry, and refined away."""
REFINED = 8
"""Steps of refinement at most."""
SLOWEST = 0.5
"""A step that leaves more than this of the imbalance is the last."""


def balanced_forces(wide: ConeProblem, forces: Array, friction: Array) -> tuple[Array, Array]:
    """The nearest forces along the rows and across them that balance, shapes (K,), (K, 3) [N].

    They may leave their cones by as much as they change, and balance no better than before
    where no forces on contacts that press can: judge them.

    Parameters
    ----------
    wide : ConeProblem
        With the friction that the forces use, or more.
    forces, friction : ndarray, shapes (K,), (K, 3)
        Along and across the rows [N].

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
    from scipy.sparse.linalg import splu  # takes its time

    problem, program, rough = wide.problem, wide.program, wide.rough
    across = np.einsum("rdi,ri->dr", wide.directions, friction[rough])
    x = np.concatenate([forces, across.ravel()]) / (problem.unit * problem.program.arm)
    size = np.where(program.two_sided, np.abs(x[: len(forces)]) + 1.0, np.abs(x[: len(forces)]))
    rubs = np.tile(program.mu[rough] * size[rough], len(across))
    weight = np.concatenate([size, rubs]) ** 2
    matrix = problem.matrix
    normal = csc_array(matrix @ diags_array(weight) @ matrix.T)
    most = float(normal.diagonal().max(initial=TINY))
    factor = splu(
        csc_array(normal + diags_array(np.full(normal.shape[0], REGULAR * most))),
        permc_spec="MMD_AT_PLUS_A",
        options={"SymmetricMode": True},
    )
    rest = problem.right - matrix @ x
    for _ in range(REFINED):
        nearer = x + weight * (matrix.T @ factor.solve(rest))
        left = problem.right - matrix @ nearer
        before, now = float(np.abs(rest).max(initial=0.0)), float(np.abs(left).max(initial=0.0))
        if not now < before:
            break
        x, rest = nearer, left
        if now > SLOWEST * before:
            break
    return wide.decoded(x)
