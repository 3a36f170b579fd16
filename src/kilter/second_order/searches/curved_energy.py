"""Search for equilibrium forces under which the energy has a positive second derivative.

Over the critical motions z = Z y with sides R y >= 0, and H(f) = sum of f_k H_k:

    max e:  Z^T (S - H(f)) Z - R^T N R >= e I,   J^T f + w = 0,  f >= 0,  N >= 0 entrywise

e > 0 proves a strict minimum: each z in C has -z.H(f) z >= e |y|^2 + (R y).N (R y). Without sides N
is left out. The multiplier X of the matrix shows the motions along which a proof fails.

With self-stress, s >= 0 with J^T s = 0 and -Z^T H(s) Z >= 0, these forces are unbounded. So
self-stress is found first: the motions that it blocks cost energy under f + t s for large t
(Finsler), and are removed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_array, csr_array

from kilter.arrays import Array
from kilter.second_order.gaps.stationary import Stationary
from kilter.second_order.proofs.minimum_proof import Faces, LockedTurns, judge_locked, shifts
from kilter.second_order.searches.counted_program import optimum
from kilter.second_order.searches.critical import Critical
from kilter.solvers.clarabel import solve_semidefinite
from kilter.solvers.problem import LinearProgram
from kilter.solvers.semidefinite import SemidefiniteProgram
from kilter.work import Work

MOST_FORCE = 1e4
"""Largest sum of the forces in a search, over the weight [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class CurvedEnergy:
    """Contact forces under which the least curvature of the energy is largest; unverified.

    `forces`, shape (K,), over the weight [-]; `sides`, shape (m, m): N; `motions`, shape (d, d): X.
    """

    forces: Array
    sides: Array
    motions: Array


def best_curvature(
    problem: Stationary, basis: Array, sides: Array, *, work: Work
) -> CurvedEnergy | None:
    """Contact forces that maximise the least curvature of the energy; None if unsolved.

    Arguments: `basis` (n, d): Z; `sides` (m, d): R.
    """
    count, size = len(problem.rows), len(sides)
    row, column = np.tril_indices(size)
    pairs = sides[row][:, :, None] * sides[column][:, None, :]
    pairs = (pairs + np.swapaxes(pairs, 1, 2)) / 2
    forms = np.concatenate([problem.restricted(basis), pairs, np.eye(basis.shape[1])[None]])
    unknowns = 1 + len(forms)
    balance = np.zeros((len(problem.load), unknowns))
    balance[:, 0], balance[:, 1 : 1 + count] = problem.load, problem.rows.T
    most = MOST_FORCE * max(1.0, float(np.abs(problem.load).sum()))
    solution = _solve(
        _independent(balance),
        np.vstack([_bounds_of_forces(problem, unknowns, most), np.eye(unknowns)[1 + count : -1]]),
        np.concatenate([[0.0], ~problem.two_sided, np.zeros(len(pairs)), [0.0]]),
        most,
        (np.concatenate([problem.spring_curvature(basis)[None], -forms]), np.eye(unknowns)[-1]),
        work,
    )
    if solution is None:
        return None
    point, motions = solution
    weights = np.zeros((size, size))
    weights[row, column] = np.maximum(point[1 + count : -1], 0.0)
    forces = problem.pushes(point[1 : 1 + count])
    return CurvedEnergy(forces, (weights + weights.T) / 2, motions)


def blocking_stress(problem: Stationary, basis: Array, *, work: Work) -> Array | None:
    """Self-stress that curves the energy upward most, shape (K,); None if there is none.

    s >= 0, sum s = 1, J^T s = 0, -Z^T H(s) Z >= 0.
    """
    count = len(problem.rows)
    if np.linalg.matrix_rank(problem.rows, tol=problem.blur) == count:
        return None
    forms = -problem.restricted(basis)
    unknowns = 1 + count
    balance = np.hstack([np.zeros((len(problem.load), 1)), problem.rows.T])
    gain = np.concatenate([[0.0], np.trace(forms, axis1=1, axis2=2)])
    total = np.concatenate([[0.0], ~problem.two_sided])
    positive = _bounds_of_forces(problem, unknowns, 1.0)
    bodies = np.concatenate([np.zeros_like(forms[:1]), forms])
    solution = _solve(_independent(balance), positive, total, 1.0, (bodies, gain), work)
    return None if solution is None else problem.pushes(solution[0][1:])


def _bounds_of_forces(problem: Stationary, unknowns: int, most: float) -> Array:
    """Rows B with B x >= 0 for forces x[1:]: contacts push, and a joint has at most `most` x[0]."""
    unit, joined = np.eye(unknowns), problem.two_sided
    forces = unit[1 : 1 + len(joined)]
    both = np.vstack([forces[joined], -forces[joined]]) / most
    return np.vstack([forces[~joined], unit[0] + both])


def _solve(
    balance: Array,
    positive: Array,
    total: Array,
    most: float,
    forms: tuple[Array, Array],
    work: Work,
) -> tuple[Array, Array] | None:
    """Solve a small semidefinite program: optimal x and multiplier; None if it fails.

    None if the solver fails, or the work is over.
    """
    if work.over:
        return None
    bodies, gain = forms
    order = bodies.shape[1]
    column, row = np.tril_indices(order)
    weight = np.where(row == column, 1.0, np.sqrt(2.0))
    square = (bodies[:, row, column] * weight).T
    within = -total
    within[0] = most
    answer = solve_semidefinite(
        SemidefiniteProgram(
            gain,
            csr_array(balance),
            csr_array(np.vstack([positive, within[None] / most])),
            csr_array((0, len(gain))),
            1,
            (csr_array(square),),
        ),
        work=work,
    )
    return None if answer is None else (answer.point, answer.squares[0])


def _independent(rows: Array) -> Array:
    """Linearly independent rows that have the same null space as the given rows."""
    left, values, _ = np.linalg.svd(rows, full_matrices=False)
    rank = int((values > 1e-10 * values.max(initial=1e-300)).sum())
    return np.asarray(left[:, :rank].T @ rows)


# Search for a self-stress that excludes every turn of parts on flat faces.


SHARES = (0.5, 0.1, 0.9, 0.01)
"""Shares of the self-stress that presses at all contacts, tried in turn; the rest excludes turns.
"""


def find_locked(
    problem: Stationary, faces: Faces, critical: Critical, *, work: Work
) -> LockedTurns | None:
    """Search for a proof that neutral motions are shifts or locked turns; None without one."""
    if not faces.flat.all() or not critical.carries.all() or problem.rows.shape[1] % 6:
        return None
    free, across = shifts(problem)
    if not free.shape[1] or not across.shape[1]:
        return None
    most, all_round = blocking_stress(problem, across, work=work), _pressing(problem, work)
    if most is None or all_round is None:
        return None
    for share in SHARES:
        proof = LockedTurns(critical.forces, (1 - share) * most + share * all_round)
        if not judge_locked(problem, faces, proof):
            return proof
    return None


def _pressing(problem: Stationary, work: Work) -> Array | None:
    """Self-stress that presses at every contact, shape (K,); None if there is none."""
    count, freedoms = problem.rows.shape
    x = optimum(
        LinearProgram(
            np.append(np.zeros(count), -1.0),
            csc_array(
                np.vstack(
                    [
                        np.hstack([problem.rows.T, np.zeros((freedoms, 1))]),
                        np.hstack([np.eye(count), -np.ones((count, 1))]),
                        np.append(np.ones(count), 0.0),
                    ]
                )
            ),
            np.concatenate([np.zeros(freedoms + count), [1.0]]),
            np.concatenate([np.zeros(freedoms), np.full(count, np.inf), [1.0]]),
            np.zeros(count + 1),
            np.full(count + 1, np.inf),
        ),
        work,
    )
    return None if x is None else x[:count]
