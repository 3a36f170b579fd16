"""Answers by other means: Gauss's accelerations by Baraff's dual, z by the dual of LP (9).

    forces f >= 0 that minimise 1/2 |M^-1/2 (J^T f + w)|^2;   a = M^-1 (J^T f + w)     (Baraff)
    -z = min over f >= 0 of |J^T f + w|_1                                              (LP duality)

The rows are built here from the labelled arrays of the program, point by point.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import linprog, lsq_linear

from kilter.mechanics.program import Program


def dense_rows(program: Program) -> np.ndarray:
    """J over all six freedoms of all parts, shape (K, 6 N); held parts have columns of zeros."""
    rows = np.zeros((len(program.part_a), len(program.names), 6))
    for k, (a, b) in enumerate(zip(program.part_a, program.part_b, strict=True)):
        for part, sign in ((int(a), -1.0), (int(b), 1.0)):
            if part >= 0 and program.free[part]:
                arm, n = program.point[k] - program.center[part], program.normal[k]
                if program.angular[k]:
                    rows[k, part, 3:] += sign * n
                else:
                    rows[k, part, :3] += sign * n
                    rows[k, part, 3:] += sign * np.cross(arm, n)
    if program.planar:
        rows[:, :, [1, 3, 5]] = 0.0
    return rows.reshape(len(rows), -1)


def mass_matrix(program: Program) -> np.ndarray:
    """Shape (N, 6, 6): masses, and inertia about the centres."""
    blocks = np.zeros((len(program.names), 6, 6))
    blocks[:, range(3), range(3)] = program.mass[:, None]
    blocks[:, 3:, 3:] = program.inertia
    return blocks


def kinetic(program: Program, motion: np.ndarray) -> float:
    """Kinetic a . M a of a motion of all parts, shape (N, 6), in the program's own lengths."""
    return float(np.einsum("ni,nij,nj->", motion, mass_matrix(program), motion))


def baraff(program: Program) -> np.ndarray:
    """Accelerations, shape (N, 6), in the program's lengths; gravity as given."""
    free = np.flatnonzero(program.free)
    freedoms = program.freedoms
    rows = dense_rows(program).reshape(len(program.part_a), -1, 6)[:, free][:, :, freedoms]
    blocks = mass_matrix(program)[free][:, freedoms][:, :, freedoms]
    root = np.linalg.cholesky(blocks)  # M = L L^T, so |L^-1 x| is the norm of M^-1
    load = program.load[free][:, freedoms]
    right = np.linalg.solve(root, load[..., None])[..., 0].reshape(-1)
    columns = np.linalg.solve(root, np.moveaxis(rows, 0, -1)).reshape(len(right), -1)
    columns = np.hstack([columns, -columns[:, program.two_sided]])
    size = max(float(np.linalg.norm(right)), 1e-300)
    length = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    columns = columns / length
    # not scipy.optimize.nnls: 1.17 gives forces that do not fit its own residual on two of these
    forces = lsq_linear(columns, -right / size, bounds=(0, np.inf), method="bvls", tol=1e-15).x
    gain = columns.T @ (right / size + columns @ forces)
    assert gain.min(initial=0.0) > -1e-11, "the oracle found no optimal forces"
    assert float(np.abs(gain * forces).max(initial=0.0)) < 1e-11
    left = (right + size * columns @ forces).reshape(len(free), -1)
    acceleration = np.zeros((len(program.names), 6))
    turned = np.linalg.solve(np.swapaxes(root, 1, 2), left[..., None])[..., 0]
    acceleration[np.ix_(free, freedoms)] = turned
    return acceleration


def z_by_duality(program: Program) -> float:
    """The z of LP (9) as the least 1-norm of what contact forces leave of the load."""
    free = np.flatnonzero(program.free)
    freedoms = program.freedoms
    rows = dense_rows(program).reshape(len(program.part_a), -1, 6)[:, free][:, :, freedoms]
    rows = rows.reshape(len(rows), -1)
    load = program.load[free][:, freedoms].reshape(-1) / float(np.linalg.norm(program.gravity))
    size = float(np.abs(load).max())
    count, width = rows.shape
    answer = linprog(
        np.concatenate([np.zeros(count), np.ones(2 * width)]),
        A_eq=np.hstack([rows.T, np.eye(width), -np.eye(width)]),
        b_eq=-load / size,
        bounds=[(None if two else 0, None) for two in program.two_sided] + [(0, None)] * 2 * width,
        method="highs-ds",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    assert answer.status == 0
    return -float(answer.fun) * size
