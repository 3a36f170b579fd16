"""Least wrenches between the parts of open pairs that, with the contact forces, balance the parts.

    min sum_p c_p |u_p|:   A f + W u = b,   f in K          u_p = (F, T / rho) of pair p

The weighted sum of norms is least with few nonzero wrenches. The pairs with a wrench hold the
assembly if their parts are joined. The multipliers of the equations are the motion that these pairs
stop: it moves the parts of each of them by c_p, the largest admissible amount. The costs c_p grow
from 1 to 2 in the order of the pairs, so that the first pairs are preferred. A single conic program
replaces a judgement for each pair.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, hstack, vstack

from kilter.arrays import Array, Index, cross
from kilter.mechanics.coulomb_cones import ConeProblem, cone_problem
from kilter.mechanics.program import Program
from kilter.solvers.problem import ConicProgram
from kilter.work import Work

__all__ = ["joining_wrenches"]

COARSE = 1e-5
"""Requested gap of the conic program. It only proposes pairs, whose sets are judged afterwards; a
smaller gap takes up to five times as long and proposes the same pairs.
"""


def joining_wrenches(program: Program, ends: Index, *, work: Work | None = None) -> Array | None:
    """Size of the smallest wrench that each pair must transmit so that all parts balance.

    None if the solver fails.

    Arguments: `ends` (P, 2): the two parts of each pair. Returns (P,): in multiples of the typical
    weight of a part [-]; None if the solver found no optimum.
    """
    from kilter.solvers.clarabel import solve_conic

    wide = cone_problem(program)
    answer = solve_conic(_least_wrenches(wide, ends), tolerance=COARSE, work=work)
    if not answer.found:
        return None
    wrenches = answer.x[wide.problem.matrix.shape[1] :][: 6 * len(ends)]
    norms: Array = np.linalg.norm(wrenches.reshape(-1, 6), axis=1)
    return norms


def _least_wrenches(wide: ConeProblem, ends: Index) -> ConicProgram:
    """The conic program for the least joining wrenches; x = (f, u of each pair, |u| of each pair).

    f are the contact forces, u the wrench between the parts of a pair.
    """
    problem, count = wide.problem, len(ends)
    total = problem.matrix.shape[1]
    cone_matrix, positive, sizes = wide.cone_rows()
    size = total + 7 * count
    wrenches = _wrench_columns(wide, ends)
    balance, equal = wide.balance(wrenches, csc_array((wrenches.shape[0], count)))
    conic = hstack([-cone_matrix, csc_array((cone_matrix.shape[0], 7 * count))])
    # the cone of pair p: its norm, then its wrench
    norms = total + 6 * count + np.arange(count)[:, None]
    column = np.hstack([norms, total + np.arange(6 * count).reshape(-1, 6)]).reshape(-1)
    rows = np.arange(7 * count)
    norm_rows = csc_array((np.full(7 * count, -1.0), (rows, column)), shape=(7 * count, size))
    matrix = vstack([balance, conic, norm_rows], format="csc")
    bound = np.concatenate([problem.right, np.zeros(equal), wide.heads, np.zeros(7 * count)])
    cost = np.zeros(size)
    cost[total + 6 * count :] = 1.0 + np.arange(count) / count
    cones = np.concatenate([sizes, np.full(count, 7, dtype=sizes.dtype)])
    no_quadratic = csc_array((size, size))
    return ConicProgram(no_quadratic, cost, matrix, bound, balance.shape[0], positive, cones)


def _wrench_columns(wide: ConeProblem, ends: Index) -> csc_array:
    """Matrix W, shape (freedoms, 6 P), of a unit wrench of each pair on its second part.

    The wrench acts at the centre of the smaller part, whose radius is rho, in the frame of the
    scaled problem.
    """
    problem, program = wide.problem, wide.program
    free, per = program.free, len(program.freedoms)
    place = np.full(len(free), -1)
    place[free] = np.arange(int(free.sum()))
    a, b = ends.T
    smaller = np.where(program.radius[a] <= program.radius[b], a, b)
    rho = program.radius[smaller]
    row, column, value = [], [], []
    for part, sign in ((a, -1.0), (b, 1.0)):
        pairs = np.flatnonzero(place[part] >= 0)
        i = part[pairs]
        arm = (program.center[smaller[pairs]] - program.center[i]) @ problem.frame.T
        block = np.zeros((len(pairs), 6, 6))
        block[:, np.arange(6), np.arange(6)] = 1.0
        for axis in range(3):
            block[:, 3:, axis] = cross(arm, np.broadcast_to(np.eye(3)[axis], arm.shape))
        block[:, 3:, 3:] *= rho[pairs, None, None]
        block[:, 3:] /= program.radius[i, None, None]
        block *= (sign * problem.unit / program.weight[i])[:, None, None]
        block = block[:, program.freedoms]
        rows = place[i][:, None] * per + np.arange(per)
        columns = pairs[:, None] * 6 + np.arange(6)
        row.append(np.broadcast_to(rows[:, :, None], block.shape).reshape(-1))
        column.append(np.broadcast_to(columns[:, None, :], block.shape).reshape(-1))
        value.append(block.reshape(-1))
    shape = (problem.matrix.shape[0], 6 * len(ends))
    index = np.concatenate(row), np.concatenate(column)
    return csc_array((np.concatenate(value), index), shape=shape)
