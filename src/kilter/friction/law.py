"""The contact law in scaled unknowns: M is the identity, w a unit vector, points alike.

With M = L L^T part by part, x = L^T a / |w| and rows of J L^-T divided by the sigma of their
point (`kilter.mechanics.law_check.mobilities`), three a point along (n, u, v):

    x = w + H^T f,    speeds H x,    |w| = 1

Forces f are in units of |w| / sigma. A row that is two-sided (a joint) has only the first
of its three lines; the others are zero.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from kilter.arrays import TINY, Array, Index, Mask, cross
from kilter.friction.friction_tolerances import ZERO_ENTRY
from kilter.mechanics.law_check import mobilities
from kilter.mechanics.program import Program, tangents
from kilter.units import metres_per_unit

__all__ = ["CoulombLaw", "coulomb_law"]


@dataclass(frozen=True, slots=True, eq=False)
class CoulombLaw:
    """The scaled contact law of a program.

    Attributes
    ----------
    program : Program
    matrix : csr_array, shape (3 K, n)
        H; rows 3 k, 3 k + 1, 3 k + 2 along the normal and two tangents of row k.
    load : ndarray, shape (n,)
        w, of length 1 (0 where nothing pulls).
    basis : ndarray, shape (K, 3, 3)
        Unit vectors n, u, v of each row, world frame.
    mu : ndarray, shape (K,)
    tied : ndarray of bool, shape (K,)
        Rows that are equations.
    patch : ndarray of int, shape (K,)
        From 0; points of one patch share theirs.
    strength : float
        |w|, the root of w.M^-1 w.
    sigma : ndarray, shape (K,)
    root : ndarray, shape (F, d, d)
        L of each free part.
    """

    program: Program
    matrix: csr_array
    load: Array
    basis: Array
    mu: Array
    tied: Mask
    patch: Index
    strength: float
    sigma: Array
    root: Array

    def acceleration(self, columns: Array) -> Array:
        """Accelerations [m/s^2], [rad/s^2] of all parts, shape (N, 6), of scaled unknowns x."""
        per = self.root.shape[1]
        own = columns.reshape(-1, per, 1) * self.strength
        motion = np.asarray(np.linalg.solve(np.swapaxes(self.root, 1, 2), own), np.float64)
        full = self.program.full(motion.reshape(-1))
        full[:, 3:] /= metres_per_unit(self.program.units)
        return full

    def columns(self, acceleration: Array) -> Array:
        """Scaled unknowns x of accelerations [m/s^2], [rad/s^2] of all parts, shape (N, 6)."""
        own = acceleration.copy()
        own[:, 3:] *= metres_per_unit(self.program.units)
        own = own[self.program.free][:, self.program.freedoms]
        scaled: Array = np.einsum("nji,nj->ni", self.root, own).reshape(-1) / self.strength
        return scaled

    def forces(self, scaled: Array) -> Array:
        """Forces on part b [N], world frame, shape (K, 3), of scaled ones along (n, u, v)."""
        own = scaled * (self.strength / self.sigma)[:, None]
        world: Array = np.einsum("kij,ki->kj", self.basis, own)
        return world


def coulomb_law(program: Program) -> CoulombLaw:
    """The scaled contact law of a program."""
    per = len(program.freedoms)
    free = np.flatnonzero(program.free)
    mass = np.zeros((len(free), 6, 6))
    mass[:, range(3), range(3)] = program.mass[free][:, None]
    mass[:, 3:, 3:] = program.inertia[free]
    mass = mass[:, program.freedoms][:, :, program.freedoms]
    root = np.asarray(np.linalg.cholesky(mass), np.float64)
    load = program.load[free][:, program.freedoms]
    load = np.asarray(np.linalg.solve(root, load[..., None]), np.float64).reshape(-1)
    strength = float(np.linalg.norm(load))
    sigma = mobilities(program)
    basis = np.concatenate([program.normal[:, None], tangents(program.normal)], axis=1)
    if len(program.source):
        _, patch = np.unique(
            np.column_stack([program.kind, program.source, _alone(program)]),
            axis=0,
            return_inverse=True,
        )
    else:
        patch = np.empty(0, dtype=np.int64)
    return CoulombLaw(
        program=program,
        matrix=_lines(program, basis, sigma, root, per),
        load=load / max(strength, TINY),
        basis=basis,
        mu=np.where(program.two_sided, 0.0, program.mu),
        tied=program.two_sided,
        patch=patch.reshape(-1),
        strength=strength,
        sigma=sigma,
        root=root,
    )


def _alone(program: Program) -> Index:
    """A number of its own for every row without a source."""
    return np.where(program.source < 0, np.arange(len(program.source)), -1)


def _lines(program: Program, basis: Array, sigma: Array, root: Array, per: int) -> csr_array:
    """H, from the levers of each row on its two parts."""
    column = np.full(len(program.names) + 1, -1)
    column[:-1][program.free] = np.arange(len(root))
    data, rows, cols = [], [], []
    for part, sign in ((program.part_b, 1.0), (program.part_a, -1.0)):
        k = np.flatnonzero(column[part] >= 0)
        owner = column[part[k]]
        arm = (program.point[k] - program.center[part[k]])[:, None]
        turning = program.angular[k][:, None, None]
        direction = basis[k]
        moment = cross(np.broadcast_to(arm, direction.shape), direction)
        straight = np.where(turning, 0.0, direction)
        lever = np.concatenate([straight, np.where(turning, direction, moment)], axis=2)
        lever = lever[:, :, program.freedoms] * (sign / sigma[k])[:, None, None]
        lever = np.linalg.solve(root[owner], np.swapaxes(lever, 1, 2)).swapaxes(1, 2)
        lever[program.two_sided[k], 1:] = 0.0
        lever[np.abs(lever) < ZERO_ENTRY] = 0.0
        row = (3 * k[:, None] + np.arange(3))[:, :, None]
        col = (owner[:, None] * per + np.arange(per))[:, None, :]
        data.append(lever.reshape(-1))
        rows.append(np.broadcast_to(row, lever.shape).reshape(-1))
        cols.append(np.broadcast_to(col, lever.shape).reshape(-1))
    values = np.concatenate(data)
    used = values != 0
    places = (np.concatenate(rows)[used], np.concatenate(cols)[used])
    return csr_array((values[used], places), shape=(3 * len(program.part_a), per * len(root)))
