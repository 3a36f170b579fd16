"""Whether contact forces by Coulomb's law explain given accelerations from rest.

The mode of each contact point follows from the accelerations alone: it opens, slides or sticks.
Then the search finds forces that act only at points that stay closed, in Coulomb cones, and at
sliding points at their limit against the sliding:

    min |M a - w - J^T f|_M^-1     f_n >= 0,  |f_t| <= mu f_n;   f = f_n (n - mu u_t / |u_t|)

The rows are built point by point from the labelled arrays of the program, in space and without
joints. Nothing of `kilter.friction` is used.
"""

from __future__ import annotations

from typing import NamedTuple

import clarabel
import numpy as np
from scipy.sparse import csc_array

from kilter.arrays import Array, across
from kilter.mechanics.program import Program

RESTS = 1e-6
"""Speed of a contact point, over the fastest part, that counts as rest [-]."""
SHARE, ROUNDING = 1e-3, 1e-7
"""Largest unexplained share of the inertia forces, and in addition of the loads: the accuracy of
the solver [-]."""


class Explained(NamedTuple):
    """Unexplained share of the inertia forces, and penetration over the fastest speed [-]."""

    rest: float
    allowed: float
    enters: float

    @property
    def obeys(self) -> bool:
        """Whether the accelerations obey Coulomb's law at each contact."""
        return self.rest <= self.allowed and self.enters <= RESTS


def explained(program: Program, acceleration: Array) -> Explained:
    """Fit contact forces by Coulomb's law to accelerations [m/s^2, rad/s^2], shape (N, 6)."""
    speed = point_speeds(program, acceleration)
    straight, turning = np.linalg.norm(acceleration.reshape(-1, 2, 3), axis=2).T
    fastest = float(max(straight.max(), (turning * program.radius).max()))
    opening = np.einsum("ki,ki->k", speed, program.normal)
    columns, sizes = _force_columns(program, speed, opening, fastest)
    inertia = np.zeros_like(acceleration)
    inertia[:, :3] = program.mass[:, None] * acceleration[:, :3]
    inertia[:, 3:] = np.einsum("nij,nj->ni", program.inertia, acceleration[:, 3:])
    keep = np.zeros((len(program.names), 6), dtype=bool)
    keep[np.ix_(program.free, program.freedoms)] = True
    roots = inertia_roots(program)

    def scaled(six: Array) -> Array:
        return np.asarray((np.linalg.solve(roots, six[..., None])[..., 0])[keep])

    wanted = scaled(inertia - program.load)
    size, load = (float(np.linalg.norm(scaled(six))) for six in (inertia, program.load))
    if columns:
        matrix = np.column_stack([scaled(column) for column in columns])
        wanted = wanted - matrix @ fit_in_cones(matrix, wanted, sizes)
    enters = float(-opening.min(initial=0.0)) / fastest
    allowed = SHARE + ROUNDING * load / size
    return Explained(float(np.linalg.norm(wanted)) / size, allowed, enters)


def _force_columns(
    program: Program, speed: Array, opening: Array, fastest: float
) -> tuple[list[Array], list[int]]:
    """Wrenches of the forces that each closed point can exert: a ray, or the axes of a cone."""
    aside = speed - opening[:, None] * program.normal
    slip = np.linalg.norm(aside, axis=1)
    columns, sizes = [], []
    for k in np.flatnonzero(opening <= RESTS * fastest):
        n, mu = program.normal[k], program.mu[k]
        if slip[k] > RESTS * fastest or mu == 0:
            columns.append(wrench(program, k, n - mu * aside[k] / max(slip[k], 1e-300)))
            sizes.append(1)
        else:
            u, v = across(n[None])
            columns += [wrench(program, k, axis) for axis in (n, mu * u[0], mu * v[0])]
            sizes.append(3)
    return columns, sizes


def point_speeds(program: Program, motion: Array) -> Array:
    """Acceleration of part b relative to part a at each contact point, shape (K, 3)."""
    speeds = np.zeros((len(program.part_a), 3))
    for k, (a, b) in enumerate(zip(program.part_a, program.part_b, strict=True)):
        for part, sign in ((a, -1.0), (b, 1.0)):
            if part >= 0:
                arm = program.point[k] - program.center[part]
                speeds[k] += sign * (motion[part, :3] + np.cross(motion[part, 3:], arm))
    return speeds


def wrench(program: Program, k: int, force: Array) -> Array:
    """Wrench on all parts of a force on part b at contact point k, shape (N, 6)."""
    six = np.zeros((len(program.names), 6))
    for part, sign in ((program.part_a[k], -1.0), (program.part_b[k], 1.0)):
        if part >= 0:
            arm = program.point[k] - program.center[part]
            six[part] += sign * np.hstack([force, np.cross(arm, force)])
    return six


def inertia_roots(program: Program) -> Array:
    """Cholesky factors of the inertia of each part, shape (N, 6, 6)."""
    blocks = np.zeros((len(program.names), 6, 6))
    blocks[:, range(3), range(3)] = program.mass[:, None]
    blocks[:, 3:, 3:] = program.inertia
    blocks[~program.free] = np.eye(6)
    return np.linalg.cholesky(blocks)


def fit_in_cones(matrix: Array, wanted: Array, sizes: list[int]) -> Array:
    """Minimise |matrix f - wanted| over f in rays (size 1) and circular cones (size 3)."""
    length = float(np.linalg.norm(wanted))
    rows, count = matrix.shape
    scale = np.maximum(np.linalg.norm(matrix, axis=0), 1e-300)
    ends = np.cumsum(sizes)
    for start, end in zip(ends - sizes, ends, strict=True):
        scale[start:end] = scale[start:end].max()
    cones = np.hstack([-np.eye(count), np.zeros((count, 1))])
    top = np.r_[np.zeros(count), -1.0][None]
    body = np.hstack([-matrix / scale, np.zeros((rows, 1))])
    kinds = [clarabel.NonnegativeConeT(1) if size == 1 else clarabel.SecondOrderConeT(3)
             for size in sizes]  # fmt: skip
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-12
    solver = clarabel.DefaultSolver(
        csc_array((count + 1, count + 1)),
        np.r_[np.zeros(count), 1.0],
        csc_array(np.vstack([cones, top, body])),
        np.r_[np.zeros(count + 1), -wanted / length],
        [*kinds, clarabel.SecondOrderConeT(rows + 1)],
        settings,
    )
    answer = np.asarray(solver.solve().x)[:count]
    return answer / scale * length
